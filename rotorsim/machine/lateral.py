"""Checks of a lateral analysis in the style of API 617 and 684, as records.

Every number is an input of the analysis, or stands in the formula that each record quotes. The
edition is the one that the machine file names; the program does not verify the formulas against it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array, Booleans, ComplexArray
from ..bearing.drawing import STANDARD_GRAVITY
from ..model.machine import Clearance
from ..rotor import Rotor, with_unbalance
from ..rows import RPM, with_unit
from .branches import Modes
from .destabilising import DecrementCurve
from .machine import Machine
from .peaks import Peak, ProbeResponse, node_at
from .response import UnbalanceResponse
from .thresholds import critical_speeds

_CRITICAL_AMPLIFICATION = 2.5
"""Amplification factor from which a peak is a critical speed."""
_VIBRATION = 25.4e-6
"""[m]"""
_SCALES = (0.5, 6.0)
_SHARE = 0.75
_MARGIN_BELOW = "min(16, 17 (1 - 1/(AF - 1.5))) % of the minimum speed"
_MARGIN_ABOVE = "min(26, 10 + 17 (1 - 1/(AF - 1.5))) % of the maximum continuous speed"


@dataclass(frozen=True)
class Check:
    """One requirement and whether it is met.

    place : Probe, clearance or case that it is about.
    value, limit : SI; None: not known or not defined.
    comparison : ``<=`` or ``>=``: how the value must compare with the limit.
    unit : Of both, empty for a number.
    formula : Of the limit.
    edition : As the input names it.
    passed : None: it could not be judged, and `note` says why.
    """

    name: str
    place: str
    value: float | None
    limit: float | None
    comparison: str
    unit: str
    formula: str
    edition: str
    passed: bool | None
    note: str = ""


def _judged(
    name: str, place: str, value: float | None, comparison: str, limit: float | None, unit: str,
    formula: str, edition: str, note: str = "",
) -> Check:  # fmt: skip
    """Check whose verdict follows from the two numbers."""
    passed = None
    if value is not None and limit is not None and not (math.isnan(value) or math.isnan(limit)):
        passed = value <= limit if comparison == "<=" else value >= limit
    return Check(name, place, value, limit, comparison, unit, formula, edition, passed, note)


def required_margin(amplification: float, below: bool) -> float:
    """Return the required separation margin, as a share of the speed it is measured from.

    amplification : Amplification factor AF.
    below : Whether the critical speed lies below the range of speeds, else above it.
    """
    if amplification < _CRITICAL_AMPLIFICATION:
        return 0.0
    part = 17.0 * (1.0 - 1.0 / (amplification - 1.5))
    return (min(16.0, part) if below else min(26.0, 10.0 + part)) / 100.0


def separation_margin(speed: float, continuous: tuple[float, float]) -> float:
    """Return the actual separation margin of a critical speed, 0 within the range [rad/s]."""
    low, high = continuous
    if speed < low:
        return (low - speed) / low
    return max(0.0, (speed - high) / high)


def _margin_check(peak: Peak, place: str, continuous: tuple[float, float], edition: str) -> Check:
    """Return the separation margin of one peak from the range of continuous speeds [rad/s]."""
    factor = peak.amplification_factor
    low, high = continuous
    actual = separation_margin(peak.speed, continuous)
    where = f"{place}, peak at {peak.speed * RPM:.0f} rpm"
    name = "separation margin"
    if factor is None:
        return Check(name, where, actual, None, ">=", "", "", edition, None, peak.note)
    note = f"AF {factor:.2f}"
    if factor < _CRITICAL_AMPLIFICATION:
        formula = f"none for AF below {_CRITICAL_AMPLIFICATION:g}"
        return Check(name, where, actual, 0.0, ">=", "", formula, edition, True, note)
    if low <= peak.speed <= high:
        formula = f"no peak with AF of {_CRITICAL_AMPLIFICATION:g} or more within the range"
        return Check(name, where, 0.0, None, ">=", "", formula, edition, False, note)
    below = peak.speed < low
    formula = _MARGIN_BELOW if below else _MARGIN_ABOVE
    limit = required_margin(factor, below)
    return _judged(name, where, actual, ">=", limit, "", formula, edition, note)


def _vibration_limit(speed: float) -> float:
    """Return the peak-to-peak limit at probes, min(25.4, 25.4 sqrt(12000/N)) µm [m].

    speed : Maximum continuous speed [rad/s].
    """
    return _VIBRATION * min(1.0, math.sqrt(12000.0 / (speed * RPM)))


def _probe_check(
    response: ProbeResponse, case: str, continuous: tuple[float, float], edition: str
) -> Check:
    """Return largest peak-to-peak major axis of one probe within the range of speeds [rad/s]."""
    value = _largest(response.speed, 2.0 * response.major_axis, continuous)
    return _judged(
        "vibration at the probe", f"{response.name}, {case}", value, "<=",
        _vibration_limit(continuous[1]), "m", "min(25.4, 25.4 sqrt(12000/N)) µm peak to peak",
        edition,
    )  # fmt: skip


def _scale_factor(
    responses: Sequence[ProbeResponse], continuous: tuple[float, float]
) -> float | None:
    """Return the factor from the computed response to the limit at the probes, held in 0.5 to 6."""
    values = [_largest(r.speed, 2.0 * r.major_axis, continuous) for r in responses]
    largest = max((v for v in values if v is not None), default=0.0)
    if largest <= 0.0:
        return None
    return float(np.clip(_vibration_limit(continuous[1]) / largest, *_SCALES))


def _clearance_checks(
    response: UnbalanceResponse, clearances: Sequence[Clearance], scale: float | None, case: str,
    top: float, edition: str,
) -> list[Check]:  # fmt: skip
    """Return the peak-to-peak response at close clearances, scaled, up to a speed.

    scale : From `_scale_factor`.
    case : Name of the unbalances.
    top : Highest speed, trip for example [rad/s].
    """
    checks = []
    for number, one in enumerate(clearances, start=1):
        axis = 2.0 * response.major_axis(node_at(response.machine.rotor, one.at))
        largest = _largest(response.speed, axis, (0.0, top))
        value = None if largest is None or scale is None else scale * largest
        note = "no response at the probes" if scale is None else f"scale factor {scale:.3g}"
        place = f"{one.name or f'clearance {number}'}, {case}"
        checks.append(
            _judged(
                "close clearance", place, value, "<=", _SHARE * one.diametral, "m",
                "75 % of the diametral clearance; the response is scaled by the limit over the "
                "largest probe response, 0.5 to 6", edition, note,
            )
        )  # fmt: skip
    return checks


def _stability_checks(curve: DecrementCurve, edition: str) -> list[Check]:
    """Return the level I stability: decrement at Q_A, and Q0 over Q_A."""
    place = f"{curve.speed * RPM:.0f} rpm, Q_A = {with_unit(curve.anticipated * 1e-6, 'MN/m')}"
    decrement = _judged(
        "decrement at the anticipated Q", place, curve.anticipated_decrement, ">=", 0.1, "",
        "0.1", edition,
    )  # fmt: skip
    formula, name = "Q0/Q_A of 2 or more", "stiffness without decrement over the anticipated"
    if curve.threshold is None:
        note = "the machine stays stable with every destabilising stiffness looked at"
        return [decrement, Check(name, place, None, 2.0, ">=", "", formula, edition, True, note)]
    note = "" if curve.threshold > 0.0 else "unstable without any destabilising stiffness"
    ratio = curve.threshold / curve.anticipated
    return [decrement, _judged(name, place, ratio, ">=", 2.0, "", formula, edition, note)]


def lateral_checks(
    responses: Mapping[str, Sequence[ProbeResponse]],
    whole: Mapping[str, UnbalanceResponse],
    clearances: Sequence[Clearance],
    curves: Sequence[DecrementCurve],
    continuous: tuple[float, float],
    top: float,
    edition: str,
) -> list[Check]:
    """Return all checks of a machine.

    responses, whole : By the name of the unbalances: at the probes, and of all nodes.
    continuous : (float, float). Range of continuous speeds [rad/s].
    top : Highest speed of the clearance check, trip for example [rad/s].
    """
    checks = []
    for case, probes in responses.items():
        for probe in probes:
            where = f"{probe.name}, {case}"
            checks += [_margin_check(p, where, continuous, edition) for p in probe.peaks]
            checks.append(_probe_check(probe, case, continuous, edition))
    for case, response in whole.items():
        scale = _scale_factor(responses[case], continuous)
        checks += _clearance_checks(response, clearances, scale, case, top, edition)
    for curve in curves:
        checks += _stability_checks(curve, edition)
    return checks


def _largest(speed: Array, values: Array, between: tuple[float, float]) -> float | None:
    """Return the largest known value between two speeds, ends interpolated; None: none known."""
    inside = (speed >= between[0]) & (speed <= between[1])
    known = np.isfinite(values)
    found = values[inside & known]
    if known.any():
        ends = [s for s in between if speed[known][0] <= s <= speed[known][-1]]
        found = np.append(found, np.interp(ends, speed[known], values[known]))
    return float(found.max()) if found.size else None


_ANTINODE = 0.3
"""Of the largest deflection, from which a local maximum is excited."""
_OVERHUNG = 0.1
"""Of the rotor's mass, from which what lies beyond the last bearing is an overhung mass."""
_ALIKE = 0.9
"""MAC from which two modes (of the two planes, say) are excited by the same unbalance."""


@dataclass(frozen=True)
class _UnbalancePlane:
    """An unbalance at one place.

    at : From the left end [m].
    amount : [kg m]
    phase : 0 or pi [rad].
    mass : W of the formula [kg].
    """

    at: float
    amount: float
    phase: float
    mass: float


@dataclass(frozen=True)
class _UnbalanceCase:
    """Unbalances that excite one mode.

    speed : At which the mode is critical, or the highest one where it is not [rad/s].
    """

    name: str
    speed: float
    planes: tuple[_UnbalancePlane, ...]

    def applied(self, machine: Machine) -> Machine:
        """Return the machine with these unbalances and no others."""
        bare = replace(machine.rotor, unbalance=np.zeros(len(machine.rotor.nodes), dtype=complex))
        planes = [(plane.at, plane.amount, plane.phase) for plane in self.planes]
        return replace(machine, rotor=with_unbalance(bare, planes))


def _residual_unbalance(mass: float, speed: float) -> float:
    """Return the residual unbalance U_r [kg m] of one plane: max(6350 W/N, 0.254 W) g mm.

    mass : Journal static load, or overhung mass, W [kg].
    speed : Maximum continuous speed [rad/s].
    """
    return max(6350.0 * mass / (speed * RPM), 0.254 * mass) * 1e-6


def unbalance_cases(
    machine: Machine, found: Modes, loads: Mapping[int, float], speed: float, factor: float
) -> tuple[_UnbalanceCase, ...]:
    """Return the unbalances for every mode that is critical within the speeds of `found`.

    machine : With positions of its rotor's nodes.
    found : Of the machine over speed.
    loads : Static load on each bearing by its node [N].
    speed : Maximum continuous speed [rad/s].
    factor : Times the residual unbalance.

    Without any critical speed the lowest mode at the last speed is taken. Modes of like shape (of
    the two planes), or with the same unbalances, make one case.
    """
    branches = found.oscillating()
    chosen = [(one.speed, one.branch) for one in critical_speeds(machine, found)]
    if not chosen and branches.eigenvalues.shape[1]:
        last = branches.undamped_frequency[-1]
        chosen = [(float(branches.parameter[-1]), int(last.argmin()))]
    deflections: list[Array] = []
    cases = []
    for critical, branch in chosen:
        i = int(np.abs(branches.parameter - critical).argmin())
        line = _deflection(machine.rotor, branches.shapes[i, branch])
        if any(_mac(line, other) > _ALIKE for other in deflections):
            continue
        deflections.append(line)
        planes = _planes(machine.rotor, line, loads, speed, factor)
        if any(planes == case.planes for case in cases):
            continue
        cases.append(_UnbalanceCase(f"mode {len(cases) + 1}", critical, planes))
    return tuple(cases)


def _deflection(rotor: Rotor, shape: ComplexArray) -> Array:
    """Return a mode's deflection (n_nodes,) at its largest, in that plane."""
    motion = np.array([shape[[x, y]] for x, y in rotor.planes])
    largest = motion[np.abs(motion).max(axis=1).argmax()]
    return np.real(motion @ largest.conj()) / float(np.linalg.norm(largest))


def _mac(a: Array, b: Array) -> float:
    return float((a @ b) ** 2 / ((a @ a) * (b @ b)))


def _planes(
    rotor: Rotor, line: Array, loads: Mapping[int, float], speed: float, factor: float
) -> tuple[_UnbalancePlane, ...]:
    """Return planes at the antinodes, with the nearest journal loads or overhung mass."""
    at = np.array([node.position for node in rotor.nodes])
    supports = sorted(loads, key=lambda node: at[node])
    ends = at[supports[0]], at[supports[-1]]
    lumped = np.abs(rotor.mass @ rotor.translation((1.0, 0.0)))
    nodal = np.array([lumped[x] for x, _ in rotor.planes])
    outboard = float(nodal[at < ends[0]].sum()), float(nodal[at > ends[1]].sum())
    low = at[0] if outboard[0] > _OVERHUNG * rotor.total_mass else ends[0]
    high = at[-1] if outboard[1] > _OVERHUNG * rotor.total_mass else ends[1]
    found = _antinodes(line, (at >= low) & (at <= high))
    mass = dict.fromkeys(found, 0.0)
    for i in found:
        mass[i] += outboard[0] if at[i] < ends[0] else outboard[1] if at[i] > ends[1] else 0.0
    inboard = [i for i in found if ends[0] <= at[i] <= ends[1]]
    for node, load in loads.items():
        if inboard:
            nearest = min(inboard, key=lambda i: abs(at[i] - at[node]))
            mass[nearest] += abs(load) / STANDARD_GRAVITY
    sign = np.sign(line[max(found, key=lambda i: abs(line[i]))])
    return tuple(
        _UnbalancePlane(
            float(at[i]), factor * _residual_unbalance(mass[i], speed),
            0.0 if line[i] * sign > 0.0 else float(np.pi), mass[i],
        )
        for i in found if mass[i] > 0.0
    )  # fmt: skip


def _antinodes(line: Array, within: Booleans) -> list[int]:
    """Return the local maxima of the deflection's magnitude, ends included."""
    index = np.flatnonzero(within)
    size = np.abs(line[index])
    before, after = np.append(-np.inf, size[:-1]), np.append(size[1:], -np.inf)
    tops = (size > before) & (size >= after) & (size > _ANTINODE * size.max())
    return [int(i) for i in index[tops]]
