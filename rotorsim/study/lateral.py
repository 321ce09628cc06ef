"""Lateral analysis of a machine: response at its probes, and the checks of an API-style report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..errors import InputError
from ..machine.destabilising import DecrementCurve, decrement_curve
from ..machine.lateral import (
    Check,
    lateral_checks,
    required_margin,
    separation_margin,
    unbalance_cases,
)
from ..machine.peaks import Peak, ProbeResponse, node_at, probe_responses, response_speeds
from ..machine.response import unbalance_response
from .machine import MachineResult


@dataclass(frozen=True, eq=False)
class LateralStudy:
    """Response and checks of a machine.

    responses : To the unbalances of the file.
    checks : Empty where the file gives no continuous speeds.
    decrement_curves : Over the destabilising stiffness, one for each place.
    notes : What could not be done, and why.
    """

    responses: tuple[ProbeResponse, ...] = ()
    checks: tuple[Check, ...] = ()
    decrement_curves: tuple[DecrementCurve, ...] = ()
    notes: tuple[str, ...] = ()


def lateral_study(result: MachineResult) -> LateralStudy:
    """Analyse a machine as its file asks for.

    The checks use the residual unbalance of the edition's formula, placed to excite each critical
    mode; the response at the probes is that to the unbalances of the file.
    """
    description, machine, found = result.description, result.machine, result.modes
    if found is None:
        return LateralStudy(notes=("no speed at which all supports have coefficients",))
    low, high = float(result.known[0]), float(result.known[-1])
    speeds = response_speeds(machine, low, high, found if result.known.size > 1 else None)
    notes: list[str] = []
    responses: tuple[ProbeResponse, ...] = ()
    if description.probe and np.any(machine.rotor.unbalance):
        responses = probe_responses(machine, description.probe, speeds)
    continuous = description.operating.continuous
    if continuous is None:
        return LateralStudy(responses, notes=tuple(notes))
    if not low <= continuous[1] <= high:
        notes.append("the continuous speeds lie outside the speeds that were analysed")
        return LateralStudy(responses, notes=tuple(notes))
    by_case: dict[str, tuple[ProbeResponse, ...]] = {}
    whole = {}
    loads = _loads(result)
    if loads and result.known.size > 1:
        factor = description.lateral.unbalance_factor
        for case in unbalance_cases(machine, found, loads, continuous[1], factor):
            loaded = case.applied(machine)
            by_case[case.name] = probe_responses(loaded, description.probe, speeds)
            whole[case.name] = unbalance_response(loaded, speeds)
    elif not loads:
        notes.append(
            "the checks of the response need the static load on two supports at least: it is known "
            "where a bearing is a film or a table"
        )
    curves = _curves(result, continuous[1], notes)
    checks = lateral_checks(
        by_case, whole, description.clearance, curves, continuous,
        description.operating.trip or continuous[1], description.lateral.edition,
    )  # fmt: skip
    return LateralStudy(responses, tuple(checks), tuple(curves), tuple(notes))


def _loads(result: MachineResult) -> dict[int, float]:
    """Return the static load on each support at the highest speed by its node [N]."""
    rotor = result.machine.rotor
    return {
        node_at(rotor, entry.at): float(np.hypot(*state.load[-1]))
        for entry, state in zip(result.description.support, result.supports, strict=True)
        if np.all(np.isfinite(state.load))
    }


def _curves(result: MachineResult, speed: float, notes: list[str]) -> list[DecrementCurve]:
    entries = result.description.lateral.destabilising_stiffness
    if not entries:
        return []
    rotor = result.machine.rotor
    anticipated: dict[int, float] = {}
    for entry in entries:
        node = node_at(rotor, entry.at)
        anticipated[node] = anticipated.get(node, 0.0) + entry.anticipated
    try:
        return [decrement_curve(result.machine, speed, anticipated)]
    except InputError as error:
        notes.append(f"sensitivity to destabilising stiffness: {error.message}")
        return []


def response_document(
    study: LateralStudy, continuous: tuple[float, float] | None
) -> list[dict[str, Any]]:
    """Return the response at the probes as plain data (SI).

    continuous : (float, float) or None. Range of continuous speeds that the margins of the peaks
        are measured from [rad/s].
    """
    return [
        {
            "probe": one.name,
            "at": one.at,
            "angle": one.angle,
            "speeds": one.speed.tolist(),
            "amplitude": one.amplitude.tolist(),
            "major_axis": one.major_axis.tolist(),
            "phase": one.phase.tolist(),
            "peaks": [
                {
                    "speed": peak.speed,
                    "amplitude": peak.amplitude,
                    "amplification_factor": peak.amplification_factor,
                    **_margins(peak, continuous),
                    "note": peak.note,
                }
                for peak in one.peaks
            ],
        }
        for one in study.responses
    ]


def _margins(peak: Peak, continuous: tuple[float, float] | None) -> dict[str, float | None]:
    """Return actual and required separation margin of a peak, over the range's nearer end."""
    factor = peak.amplification_factor
    if continuous is None:
        return {"separation_margin": None, "required_margin": None}
    needed = None if factor is None else required_margin(factor, peak.speed < continuous[0])
    actual = separation_margin(peak.speed, continuous)
    return {"separation_margin": actual, "required_margin": needed}


def lateral_document(study: LateralStudy) -> Mapping[str, Any]:
    """Return checks of the lateral analysis as plain data (SI), with the formula of each limit."""
    return {
        "checks": [asdict(check) for check in study.checks],
        "passed": all(check.passed is not False for check in study.checks),
        "destabilising_stiffness": [
            {
                "anticipated": curve.anticipated,
                "decrement_at_anticipated": curve.anticipated_decrement,
                "stiffness_without_decrement": curve.threshold,
            }
            for curve in study.decrement_curves
        ],
        "notes": list(study.notes),
    }
