"""Checks of a lateral analysis in the style of API 617 and 684, as records.

Every number is an input of the analysis, or stands in the formula that each record quotes. The
edition is the one that the machine file names; the program does not verify the formulas against it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..model.machine import Clearance
from ..rows import RPM
from .destabilising import DecrementCurve
from .peaks import Peak, ProbeResponse, node_at
from .response import UnbalanceResponse

Array = NDArray[np.float64]

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
    """Required separation margin, as a share of the speed it is measured from.

    amplification : Amplification factor AF.
    below : Whether the critical speed lies below the range of speeds, else above it.
    """
    if amplification < _CRITICAL_AMPLIFICATION:
        return 0.0
    part = 17.0 * (1.0 - 1.0 / (amplification - 1.5))
    return (min(16.0, part) if below else min(26.0, 10.0 + part)) / 100.0


def separation_margin(speed: float, continuous: tuple[float, float]) -> float:
    """Actual separation margin of a critical speed, 0 within the range [rad/s]."""
    low, high = continuous
    if speed < low:
        return (low - speed) / low
    return max(0.0, (speed - high) / high)


def margin_check(peak: Peak, place: str, continuous: tuple[float, float], edition: str) -> Check:
    """Separation margin of one peak from the range of continuous speeds [rad/s]."""
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


def vibration_limit(speed: float) -> float:
    """Peak-to-peak limit at probes, min(25.4, 25.4 sqrt(12000/N)) um [m].

    speed : Maximum continuous speed [rad/s].
    """
    return _VIBRATION * min(1.0, math.sqrt(12000.0 / (speed * RPM)))


def probe_check(
    response: ProbeResponse, case: str, continuous: tuple[float, float], edition: str
) -> Check:
    """Largest peak-to-peak major axis of one probe within the range of speeds [rad/s]."""
    value = _largest(response.speed, 2.0 * response.major_axis, continuous)
    return _judged(
        "vibration at the probe", f"{response.name}, {case}", value, "<=",
        vibration_limit(continuous[1]), "m", "min(25.4, 25.4 sqrt(12000/N)) um peak to peak",
        edition,
    )  # fmt: skip


def scale_factor(
    responses: Sequence[ProbeResponse], continuous: tuple[float, float]
) -> float | None:
    """Factor from the computed response to the limit at the probes, held in 0.5 to 6."""
    values = [_largest(r.speed, 2.0 * r.major_axis, continuous) for r in responses]
    largest = max((v for v in values if v is not None), default=0.0)
    if largest <= 0.0:
        return None
    return float(np.clip(vibration_limit(continuous[1]) / largest, *_SCALES))


def clearance_checks(
    response: UnbalanceResponse, clearances: Sequence[Clearance], scale: float | None, case: str,
    top: float, edition: str,
) -> list[Check]:  # fmt: skip
    """Peak-to-peak response at close clearances, scaled, up to a speed.

    scale : From `scale_factor`.
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


def stability_checks(curve: DecrementCurve, edition: str) -> list[Check]:
    """Level I stability: decrement at Q_A, and Q0 over Q_A."""
    place = f"{curve.speed * RPM:.0f} rpm, Q_A = {curve.anticipated:.4g} N/m"
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
    """All checks of a machine.

    responses, whole : By the name of the unbalances: at the probes, and of all nodes.
    continuous : (float, float). Range of continuous speeds [rad/s].
    top : Highest speed of the clearance check, trip for example [rad/s].
    """
    checks = []
    for case, probes in responses.items():
        for probe in probes:
            where = f"{probe.name}, {case}"
            checks += [margin_check(p, where, continuous, edition) for p in probe.peaks]
            checks.append(probe_check(probe, case, continuous, edition))
    for case, response in whole.items():
        scale = scale_factor(responses[case], continuous)
        checks += clearance_checks(response, clearances, scale, case, top, edition)
    for curve in curves:
        checks += stability_checks(curve, edition)
    return checks


def _largest(speed: Array, values: Array, between: tuple[float, float]) -> float | None:
    """Largest known value between two speeds, their ends interpolated; None: none is known."""
    inside = (speed >= between[0]) & (speed <= between[1])
    known = np.isfinite(values)
    found = values[inside & known]
    if known.any():
        ends = [s for s in between if speed[known][0] <= s <= speed[known][-1]]
        found = np.append(found, np.interp(ends, speed[known], values[known]))
    return float(found.max()) if found.size else None
