"""The verdict on a rotor in words: at the highest speed, over the range, and where it changes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..bearing import description
from ..rows import RPM, number

if TYPE_CHECKING:
    from .stability import StabilityCurve

VERDICTS = {
    "always_stable": "stable at any mass",
    "always_unstable": "unstable at any mass",
    "reversed_threshold": "stable above",
    "": "not converged",
}


def curve_title(curve: StabilityCurve) -> str:
    """``thd, c = 100 µm``, and what else the table was stacked along."""
    extra = [
        f"{name} = {number(value)}"
        for name, value in curve.choices.items()
        if name not in ("thermal_model", "radial_clearance")
    ]
    choices = curve.choices
    return description.curve_title(choices["thermal_model"], choices["radial_clearance"], *extra)


def verdict_word(growth_rate: float) -> str:
    """``stable``, ``unstable`` or, where nothing damps or drives the rotor, ``undamped``."""
    return "unstable" if growth_rate > 0.0 else "stable" if growth_rate < 0.0 else "undamped"


def verdict_over_range(curve: StabilityCurve) -> str | None:
    """``stable throughout``, ``unstable throughout``, ``changes``.

    None without a rotor, and where a speed is not known.
    """
    if curve.threshold_speeds:
        return "changes"
    rates = [] if curve.growth_rate is None else [float(rate) for rate in curve.growth_rate]
    if not rates or not all(map(math.isfinite, rates)):
        return None
    words = {verdict_word(rate) for rate in rates}
    return f"{words.pop()} throughout" if len(words) == 1 else "changes"


def thresholds_text(curve: StabilityCurve) -> str:
    """Threshold speeds [rpm], or which verdict holds over which speeds."""
    if curve.threshold_speeds:
        return ", ".join(f"{speed * RPM:.0f}" for speed in curve.threshold_speeds)
    if curve.growth_rate is None:
        return "-"
    known = [
        (float(speed) * RPM, float(rate))
        for speed, rate in zip(curve.speed, curve.growth_rate, strict=True)
        if math.isfinite(rate)
    ]
    words = {verdict_word(rate) for _, rate in known}
    if len(words) != 1:
        return "-"
    word, (first, last) = words.pop(), (known[0][0], known[-1][0])
    if len(known) < len(curve.speed):
        return f"none: {word} at the {len(known)} of {len(curve.speed)} speeds known"
    return f"none: {word}, {first:.0f} to {last:.0f} rpm" if last > first else f"none: {word}"


def verdict_at(curve: StabilityCurve) -> str | None:
    """``stable``, ``unstable`` or ``undamped`` at the highest speed; None: not known."""
    if curve.growth_rate is None or math.isnan(curve.growth_rate[-1]):
        return None
    return verdict_word(float(curve.growth_rate[-1]))


def late_whirl(
    orbits: Iterable[Mapping[str, Any]], curves: Sequence[StabilityCurve]
) -> Iterator[str]:
    """Say why a run-up shows its whirl above the threshold speed, where it does.

    `orbits` as `rotorsim.orbit.description.describe_orbit` gives them.
    """
    for said in orbits:
        seen, model = said["whirl_range"], said["thermal_model"]
        for curve in curves:
            same = curve.choices["thermal_model"] == model and math.isclose(
                curve.choices["radial_clearance"], said["radial_clearance"], rel_tol=1e-6
            )
            if seen is None or not same or not curve.threshold_speeds:
                continue
            threshold, first = curve.threshold_speeds[0], seen["first_speed"]
            if said["speed"][1] > said["speed"][0] and threshold < first:
                yield (
                    f"threshold at {threshold * RPM:.0f} rpm ({model}), but the whirl is seen from "
                    f"{first * RPM:.0f} rpm on: beyond the threshold it needs time to grow, while "
                    "the speed goes on rising"
                )


def verdict_at_top(curve: StabilityCurve) -> str:
    """Whether the rotor is stable at the highest speed; a dash where that is not known."""
    return verdict_at(curve) or "-"
