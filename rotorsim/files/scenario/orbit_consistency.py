"""Checks of a scenario's orbit, and what it says by being left out.

Every function raises `InputError` with the key.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import InputError
from ...model.orbit import OrbitForce, OrbitKind, OrbitSettings, SpeedRamp
from ...rotor import Rotor
from .bearing_consistency import listed_clearance

if TYPE_CHECKING:
    from .scenario import Scenario

_DEFAULT_REVOLUTIONS = 60
_RPM = 30.0 / math.pi


def settled_orbit(
    orbit: OrbitSettings, scenario: Scenario, given: Mapping[str, Any]
) -> OrbitSettings:
    """Return the orbit with the clearance, duration, kind and actuator that are left out."""
    rotor = scenario.rotor
    if rotor is None:
        raise InputError('is missing: an orbit needs a rotor; add mass = "1200 kg"', key="rotor")
    if orbit.force is OrbitForce.LINEAR:
        _check_tabulated(orbit, scenario.operating.speeds)
    orbit = replace(
        orbit,
        radial_clearance=listed_clearance(
            orbit.radial_clearance, scenario, "orbit.radial_clearance"
        ),
        unbalance=orbit.unbalance
        if "unbalance" in given
        else not ("kind" in given and orbit.kind is OrbitKind.FREE_DECAY),
    )
    _check_start(orbit, scenario.operating.eccentricity_ratio)
    if not orbit.is_ramped and orbit.revolutions is None:
        orbit = replace(orbit, revolutions=_DEFAULT_REVOLUTIONS)
    _check_nodes(orbit, rotor)
    kinds = orbit.kinds(float(np.abs(rotor.unbalance).max()))
    if "kind" not in given:
        orbit = replace(orbit, kind=kinds[0])
    else:
        _check_kind(orbit, kinds)
    if orbit.actuator is not None:
        if orbit.actuator.on:
            _check_actuator(orbit, scenario)
        else:
            orbit = replace(orbit, actuator=None)
    return orbit


def _check_tabulated(orbit: OrbitSettings, tabulated: tuple[float, ...]) -> None:
    ends = {"orbit.speed": orbit.speed}
    if isinstance(orbit.speed, SpeedRamp):
        ends = {"orbit.speed.start": orbit.speed.start, "orbit.speed.stop": orbit.speed.stop}
    low, high = tabulated[0], tabulated[-1]
    for key, value in ends.items():
        assert isinstance(value, float)
        if not low <= value <= high:
            raise InputError(
                "must lie within operating.speed, where the coefficients are tabulated "
                f"({low * _RPM:.6g} to {high * _RPM:.6g} rpm)",
                key=key,
            )


def _check_start(orbit: OrbitSettings, eccentricity_ratio: float | None) -> None:
    """Refuse a start outside the clearance, wherever the equilibrium may be."""
    farthest = orbit.radial_clearance * (
        1.0 + (1.0 if eccentricity_ratio is None else eccentricity_ratio)
    )
    if math.hypot(*orbit.initial_displacement) >= farthest:
        raise InputError(
            "starts outside the clearance: from the equilibrium it must be less than "
            f"{farthest * 1e6:.4g} µm",
            key="orbit.initial_displacement",
        )


def _check_nodes(orbit: OrbitSettings, rotor: Rotor) -> None:
    for name, load in (("step", orbit.step), ("harmonic", orbit.harmonic)):
        if load is not None and load.node >= len(rotor.nodes):
            raise InputError(
                'only a rotor of kind = "jeffcott" has a disc apart from its journal',
                key=f"orbit.{name}.on",
            )


_NEEDS = {
    OrbitKind.UNBALANCE: 'needs an unbalance; add unbalance = "500 g*mm" to [rotor], and leave '
    "unbalance = false out of [orbit]",
    OrbitKind.STEP: 'needs a step; add step = { force = ["500 N", "0 N"], start = "0.1 s" }',
    OrbitKind.HARMONIC: "needs a harmonic force; add "
    'harmonic = { force = ["500 N", "0 N"], frequency = "50 Hz" }',
    OrbitKind.RUN_UP: "needs a rising speed such as "
    'speed = { start = "3000 rpm", stop = "15000 rpm", duration = "2 s" }',
    OrbitKind.COAST_DOWN: "needs a falling speed such as "
    'speed = { start = "15000 rpm", stop = "3000 rpm", duration = "2 s" }',
    OrbitKind.BASE_MOTION: "needs a motion of the base; add "
    'base_motion = { displacement = ["10 um", "0 um"], frequency = "50 Hz" }, or a base_shock',
}


def _check_kind(orbit: OrbitSettings, kinds: list[OrbitKind]) -> None:
    """Refuse a kind that lacks what it needs."""
    if orbit.kind is not OrbitKind.FREE_DECAY:
        if orbit.kind not in kinds:
            raise InputError(_NEEDS[orbit.kind], key="orbit.kind")
        return
    if not any((*orbit.initial_displacement, *orbit.initial_velocity)):
        raise InputError(
            "would stay at rest; write for example "
            'initial_displacement = ["1 um", "0 um"], which kind = "free_decay" needs',
            key="orbit.initial_displacement",
        )
    if kinds[0] in (OrbitKind.RUN_UP, OrbitKind.COAST_DOWN):
        raise InputError("needs one speed, not a ramp", key="orbit.kind")


def _check_actuator(orbit: OrbitSettings, scenario: Scenario) -> None:
    """Refuse what the feedback, designed about one equilibrium at one speed, does not fit."""
    rotor_kind = "" if scenario.rotor is None else scenario.rotor.kind
    for fits, message in (
        (
            not orbit.is_ramped,
            'needs one speed, not a ramp; write for example speed = "15000 rpm" in [orbit]',
        ),
        (rotor_kind == "rigid", 'needs a rotor of kind = "rigid"'),
        (
            orbit.static_load,
            "needs the static load, about whose equilibrium it acts; remove static_load",
        ),
    ):
        if not fits:
            raise InputError(message, key="orbit.actuator")
