"""Results in words and short numbers, the same on the terminal, in the report and in notebooks."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from ..model.lubricant import ZERO_CELSIUS as ZERO_CELSIUS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..bearing.operating_point import OperatingPoint
    from .stability import StabilityCurve

RPM = 30.0 / math.pi
VERDICTS = {
    "always_stable": "stable at any mass",
    "always_unstable": "unstable at any mass",
    "reversed_threshold": "stable above",
    "": "not converged",
}


def number(value: float | None, digits: int = 4) -> str:
    """Short text of a number, below a million without an exponent; a dash where there is none.

    Examples
    --------
    >>> number(1234.5678), number(18000.0), number(2010.0, 3), number(7.0e6), number(None)
    ('1235', '18000', '2010', '7.000e+06', '-')
    """
    if value is None or not math.isfinite(value):
        return "-"
    if abs(value) >= 1e6:
        return f"{value:.{digits - 1}e}"
    return f"{value:.{digits}g}" if abs(value) < 10.0**digits - 0.5 else f"{value:.0f}"


def describe(point: OperatingPoint) -> str:
    """``thd 100 um 15000 rpm``, and the status where it is not converged."""
    text = (
        f"{point.thermal_model} {point.radial_clearance * 1e6:.4g} um {point.speed * RPM:.0f} rpm"
    )
    return text if point.converged else f"{text}: {point.status.value}"


def grouped_warnings(points: Sequence[OperatingPoint]) -> list[str]:
    """One line for each kind of warning: its last wording, and at how many points from where on.

    Warnings that differ in their numbers alone are of one kind.
    """
    kinds: dict[str, list[tuple[OperatingPoint, str]]] = {}
    for point in points:
        for text in point.warnings:
            kinds.setdefault(re.sub(r"[\d.]+", "0", text), []).append((point, text))
    lines = []
    for found in kinds.values():
        (first, _), (last, text) = found[0], found[-1]
        where = describe(first)
        if len(found) > 1:
            where = f"{len(found)} of {len(points)} points, from {where} to {describe(last)}"
        lines.append(f"{text} (at {where})")
    return lines


def wall_share_text(point: OperatingPoint) -> str:
    """Part of the heat that leaves through bush and shaft [%]; a dash without heating."""
    heat = point.heat_balance
    if heat is None or not math.isfinite(heat.wall_share):
        return "-"
    return str(round(100.0 * heat.wall_share))


def critical_mass_text(point: OperatingPoint) -> str:
    """Critical mass [kg], or the verdict where no mass is critical."""
    if point.critical_mass is None:
        return {"always_stable": "stable", "always_unstable": "unstable"}.get(
            point.stability or "", "-"
        )
    return number(point.critical_mass)


def curve_title(curve: StabilityCurve) -> str:
    """``thd, c = 100 um``, and what else the table was stacked along."""
    extra = [
        f"{name} = {number(value)}"
        for name, value in curve.choices.items()
        if name not in ("thermal_model", "radial_clearance")
    ]
    clearance = curve.choices["radial_clearance"]
    given = [f"c = {number(clearance * 1e6)} um"] if math.isfinite(clearance) else []
    return ", ".join([str(curve.choices["thermal_model"]), *given, *extra])


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


def verdict_at_top(curve: StabilityCurve) -> str:
    """Whether the rotor is stable at the highest speed; a dash where that is not known."""
    return verdict_at(curve) or "-"
