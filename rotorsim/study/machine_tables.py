"""A machine's results as rows of text, for terminal and report alike."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Indices
from ..machine.branches import Modes
from ..rows import RPM, ZERO_CELSIUS, heads, number, shown, with_unit
from .hot_spot import HotSpotStudy
from .lateral import LateralStudy
from .machine import MachineResult, destabilised_by_heating
from .sensitivity import Sensitivity

_REACH = 3.0
"""Multiple of the highest speed up to which the least stable mode is shown."""
_SHOWN_SPEEDS = 12
"""Rows of the tables over speed, at most, where not all are wanted."""


_NO_SPIRAL = 1e-6
"""Below it a hot spot stands still [rad/s]."""


class Rows(NamedTuple):
    """A table: its title, the head of each column, the rows."""

    title: str
    head: tuple[str, ...]
    rows: list[tuple[str, ...]]


def _suffix(results: dict[str, MachineResult], model: str) -> str:
    return "" if len(results) == 1 else f", {model}"


def least_stable_rows(results: dict[str, MachineResult], every: bool = False) -> Iterator[Rows]:
    """Return the least stable mode over speed, a table for each thermal model."""
    head = ("rpm", "Hz", "f/rev", "log decrement", "growth 1/s", "whirl", "verdict")
    for model, result in results.items():
        found = result.modes
        if found is None:
            continue
        least, whirl, verdicts = least_stable_below(found), found.whirl, found.verdicts
        rows = []
        for i in _some(len(result.known), every):
            k, speed = int(least[i]), float(result.known[i])
            frequency = float(found.damped_frequency[i, k])
            rows.append((
                f"{speed * RPM:.0f}", number(frequency / (2.0 * math.pi)),
                number(frequency / speed, 3), number(float(found.logarithmic_decrement[i, k]), 3),
                number(float(found.growth_rate[i, k])), str(whirl[i, k]), str(verdicts[i]),
            ))  # fmt: skip
        reach = f" up to {number(_REACH * float(result.known[-1]) / (2.0 * math.pi), 3)} Hz"
        yield Rows(f"Least stable mode{reach}{_suffix(results, model)}", head, rows)


def least_stable_below(found: Modes) -> Indices:
    """Return branch of largest growth rate up to three times the highest speed, or unstable, (n,).

    Bending modes far above the speeds are hardly damped and hide those that films decide.
    """
    high = found.damped_frequency > _REACH * float(found.parameter[-1])
    left_out = found.undamped | (high & (found.growth_rate <= 0.0))
    left_out &= ~left_out.all(axis=1, keepdims=True)
    growth = np.where(left_out, -np.inf, found.growth_rate)
    return np.nan_to_num(growth, nan=-np.inf).argmax(axis=1)


def critical_rows(results: dict[str, MachineResult]) -> Iterator[Rows]:
    """Return the critical and threshold speeds, a table for each thermal model that has some."""
    for model, result in results.items():
        rows = [
            (f"{one.speed * RPM:.0f}", "critical speed", one.whirl,
             f"damping ratio {number(one.damping_ratio, 3)}")
            for one in result.critical_speeds
        ]  # fmt: skip
        rows += [
            (f"{one.speed * RPM:.0f}",
             f"threshold, {'unstable' if one.becomes_unstable else 'stable'} above", "",
             f"whirl ratio {number(one.whirl_frequency_ratio, 3)}")
            for one in result.thresholds
        ]  # fmt: skip
        if rows:
            title = f"Critical and threshold speeds{_suffix(results, model)}"
            yield Rows(title, ("rpm", "kind", "whirl", ""), rows)


def mode_rows(result: MachineResult, count: int = 10) -> Rows:
    """Return the lowest oscillating modes at the highest speed."""
    head = ("mode", "Hz", "f/rev", "log decrement", "damping ratio", "growth 1/s", "whirl")
    rows = []
    if result.modes is not None:
        found, top = result.modes.oscillating(), float(result.known[-1])
        whirl, undamped = found.whirl, found.undamped
        for place, k in enumerate(np.argsort(found.undamped_frequency[-1])[:count], start=1):
            frequency = float(found.damped_frequency[-1, k])
            growth = "undamped" if undamped[-1, k] else number(float(found.growth_rate[-1, k]))
            rows.append((
                str(place), number(frequency / (2.0 * math.pi)), number(frequency / top, 3),
                number(float(found.logarithmic_decrement[-1, k]), 3),
                number(float(found.damping_ratio[-1, k]), 3), growth, str(whirl[-1, k]),
            ))  # fmt: skip
    at = f" at {result.known[-1] * RPM:.0f} rpm" if result.known.size else ""
    return Rows(f"Modes{at}, {result.thermal_model}", head, rows)


def support_rows(results: dict[str, MachineResult], every: bool = False) -> Iterator[Rows]:
    """Return the load and film of each bearing over speed."""
    head = heads("rpm", "load kN", "direction deg", "e/c", "h min µm", "T max °C", "status")
    for model, result in results.items():
        for state in result.supports:
            if not state.points:
                continue
            rows = []
            for i in _some(len(state.points), every):
                point = state.points[i]
                rows.append((
                    f"{point.speed * RPM:.0f}",
                    shown(float(np.hypot(*state.load[i])) / 1e3, "kN"),
                    number(math.degrees(float(state.direction[i])), 3),
                    number(point.eccentricity_ratio), shown(point.min_film_thickness * 1e6, "µm"),
                    shown(point.max_temperature - ZERO_CELSIUS, "°C"), point.status.value,
                ))  # fmt: skip
            yield Rows(f"{state.name}{_suffix(results, model)}", head, rows)


def peak_rows(study: LateralStudy) -> Iterator[Rows]:
    """Return peaks of the unbalance response, a table for each probe that has some."""
    for response in study.responses:
        rows = []
        for peak in response.peaks:
            factor = peak.amplification_factor
            rows.append((
                f"{peak.speed * RPM:.0f}", shown(peak.amplitude * 1e6, "µm"),
                number(factor, 3) if factor is not None else "-", peak.note,
            ))  # fmt: skip
        if rows:
            title = f"Unbalance response peaks at {response.name}"
            yield Rows(title, heads("rpm", "amplitude µm", "AF", ""), rows)


def check_rows(study: LateralStudy) -> Iterator[Rows]:
    """Return the lateral checks with their limits; none without."""
    if not study.checks:
        return
    rows = []
    for check in study.checks:
        value, limit = (_shown(part, check.unit) for part in (check.value, check.limit))
        if check.passed is False and check.limit is None:
            limit = "no peak"
        word = {True: "passed", False: "FAILED", None: "not judged"}[check.passed]
        rows.append((f"{check.name}: {check.place}", value, check.comparison, limit, word))
    title = f"Lateral checks ({study.checks[0].edition})"
    yield Rows(title, ("check", "value", "", "limit", "result"), rows)


def _shown(value: float | None, unit: str) -> str:
    if unit != "m" or value is None:
        return number(value)
    return with_unit(value * 1e6, "µm")


def sensitivity_rows(study: LateralStudy) -> Iterator[Rows]:
    """Return the decrement against destabilising stiffness (level I)."""
    if not study.decrement_curves:
        return
    rows = [
        (f"{curve.speed * RPM:.0f}", shown(curve.anticipated / 1e6, "MN/m"),
         number(float(curve.decrement[0]), 3), number(curve.anticipated_decrement, 3),
         "above 10 000 Q_A" if curve.threshold is None else shown(curve.threshold / 1e6, "MN/m"),
         "-" if curve.threshold is None else number(curve.threshold / curve.anticipated, 3))
        for curve in study.decrement_curves
    ]  # fmt: skip
    head = heads("rpm", "Q_A MN/m", "decrement without", "decrement at Q_A", "Q0 MN/m", "Q0/Q_A")
    yield Rows("Sensitivity to destabilising stiffness", head, rows)


def heating_lines(results: dict[str, MachineResult]) -> list[str]:
    """Return modes that only heating makes unstable, a sentence each."""
    if len(results) < 2:
        return []
    cold, hot = next(iter(results.values())), results[next(reversed(results))]
    return [
        f"only heating makes the mode of {number(mode.frequency / (2.0 * math.pi))} Hz unstable: "
        f"growth rate {number(mode.isothermal_growth_rate)} 1/s without, "
        f"{number(mode.growth_rate)} 1/s with it"
        for mode in destabilised_by_heating(cold, hot)
    ]


def mesh_line(result: MachineResult) -> str:
    """Return what twice as many elements change."""
    changes = [change for _, change in result.mesh_change]
    said = f"mesh: {len(result.machine.rotor.nodes)} nodes"
    if not changes:
        return said
    return (
        f"{said}; twice as many elements move the lowest {len(changes)} modes at "
        f"{float(result.known[-1]) * RPM:.0f} rpm by {number(100.0 * max(changes), 2)} % at most"
    )


def moving_rows(moving: Sequence[Sensitivity]) -> Iterator[Rows]:
    """Return what each parameter does to the threshold speed; none without."""
    if not moving:
        return
    rows = [
        (one.support, one.parameter.replace("_", " "), _change(one),
         "-" if one.threshold_change is None else f"{round(one.threshold_change * RPM):+d}",
         f"{one.growth_rate_change:+.3g}")
        for one in moving
    ]  # fmt: skip
    head = ("bearing or place", "parameter", "changed by", "threshold rpm", "growth 1/s")
    yield Rows("What moves the stability threshold", head, rows)


def _change(one: Sensitivity) -> str:
    if one.parameter == "supply_temperature":
        return f"+{with_unit(one.change, 'K')}"
    if one.parameter == "destabilising_stiffness":
        return f"+{with_unit(one.change / 1e6, 'MN/m', 3)}"
    return f"{one.change:+g}" if one.parameter == "preload" else f"{one.change / one.value:+.0%}"


def failure_lines(results: dict[str, MachineResult]) -> list[str]:
    """Return what did not converge, a sentence each."""
    lines = []
    for model, result in results.items():
        lines += [
            f"{state.name}, {model}, {point.speed * RPM:.0f} rpm: {point.status.value}: "
            f"{point.message}"
            for state in result.supports
            for point in state.points
            if not point.converged
        ]
        lines += [
            f"static equilibrium at {speed * RPM:.0f} rpm stopped with a residual of "
            f"{one.residual:.1e} of the load"
            for speed, one in zip(result.speeds, result.statics, strict=False)
            if not one.converged
        ]
    return lines


def spot_rows(study: HotSpotStudy | None) -> Iterator[Rows]:
    """Return the loop of the hot spots over speed; none without."""
    if study is None:
        return
    loop, rows = study.loop, []
    names = [f"{name} ΔK" for name in study.names]
    head = heads("rpm", "real gain", "gain", "growth 1/s", "spiral s", *names)
    for i in _some(loop.speed.size, every=False):
        frequency = float(loop.frequency[i])
        rows.append((
            f"{loop.speed[i] * RPM:.0f}", number(float(loop.gain[i, 0].real), 3),
            number(abs(loop.gain[i, 0]), 3), number(float(loop.growth_rate[i]), 3),
            number(2.0 * math.pi / frequency, 3) if abs(frequency) > _NO_SPIRAL else "-",
            *(number(2.0 * abs(t), 3) for t in loop.temperature[i]),
        ))  # fmt: skip
    yield Rows("Synchronous hot spots", head, rows)


def spot_lines(study: HotSpotStudy | None) -> list[str]:
    """Return what the hot spots do, a sentence."""
    if study is None:
        return []
    loop = study.loop
    top = int(np.nanargmax(loop.gain[:, 0].real))
    most = f"{number(float(loop.gain[top, 0].real), 3)} at {loop.speed[top] * RPM:.0f} rpm"
    if study.stable:
        return [f"hot spots settle at all speeds: largest real gain {most}, limit 1"]
    at = ", ".join(f"{one * RPM:.0f}" for one in study.thresholds) or "no speed within the range"
    return [
        f"hot spots grow and the vibration spirals (Morton effect): largest real gain {most}, "
        f"limit 1; changes at {at} rpm"
    ]


def verdict_lines(results: dict[str, MachineResult]) -> list[str]:
    """Return the verdict at the highest speed, one for each thermal model."""
    return [
        f"{'' if len(results) == 1 else f'{model}: '}{result.verdict} at "
        f"{float(result.known[-1]) * RPM:.0f} rpm"
        for model, result in results.items()
        if result.verdict is not None
    ]


def _some(count: int, every: bool) -> Sequence[int]:
    """Return indices of at most so many rows, evenly spread, the first and last among them."""
    if every or count <= _SHOWN_SPEEDS:
        return range(count)
    return [round(i) for i in np.linspace(0, count - 1, _SHOWN_SPEEDS)]
