"""The orbit's settings, checked against the rest of the scenario."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...model import Bearing
from ...model.loads import BaseMotion, BaseShock, HarmonicForce, Load, StepForce
from .actuator import actuator_settings
from .schema import LoadTable, OrbitTable, ScenarioTables, SpeedRampTable
from .settings import OrbitForce, OrbitKind, OrbitSettings, RotorKind, SpeedRamp, Station

DEFAULT_REVOLUTIONS = 60


def orbit_settings(
    tables: ScenarioTables,
    bearing: Bearing,
    clearance_choices: tuple[float, ...],
    tabulated: NDArray[np.float64],
) -> OrbitSettings | None:
    """Read what to simulate in the time domain."""
    table = tables.orbit
    if table is None:
        return None
    if tables.rotor is None:
        raise InputError('is missing: an orbit needs a rotor; add mass = "1200 kg"', key="rotor")
    if table.force is OrbitForce.LINEAR:
        _check_linear(table, tabulated)
    clearance = _orbit_clearance(table, clearance_choices)
    _check_start(table, clearance, tables.operating.eccentricity_ratio)
    if not isinstance(table.speed, SpeedRampTable):
        speed, revolutions = table.speed, table.revolutions or DEFAULT_REVOLUTIONS
    elif table.revolutions is not None:
        raise InputError(
            "goes with one speed; a ramp ends after its duration: remove it",
            key="orbit.revolutions",
        )
    else:
        ramp = table.speed
        speed, revolutions = SpeedRamp(ramp.start, ramp.stop, ramp.duration, ramp.hold), None
    kind = _kind(table, tables.rotor.unbalance)
    unbalance = table.unbalance
    if unbalance is None:
        unbalance = table.kind is not OrbitKind.FREE_DECAY
    return OrbitSettings(
        radial_clearance=clearance,
        speed=speed,
        revolutions=revolutions,
        force=table.force,
        initial_displacement=(table.initial_displacement[0], table.initial_displacement[1]),
        initial_velocity=(table.initial_velocity[0], table.initial_velocity[1]),
        kind=kind,
        static_load=table.static_load,
        unbalance=unbalance,
        loads=tuple(_loads(table, tables.rotor.kind)),
        samples_per_revolution=table.samples_per_revolution,
        steady_only=table.steady_only,
        actuator=actuator_settings(tables, bearing),
    )


def _kind(table: OrbitTable, unbalance: float) -> OrbitKind:
    """Kind as written, if what it needs is there; else as the other keys have it."""
    found = _kinds(table, unbalance)
    if table.kind is None:
        return found[0]
    if table.kind is OrbitKind.FREE_DECAY:
        if not any((*table.initial_displacement, *table.initial_velocity)):
            raise InputError(
                "would stay at rest; write for example "
                'initial_displacement = ["1 um", "0 um"], which kind = "free_decay" needs',
                key="orbit.initial_displacement",
            )
        if found[0] in (OrbitKind.RUN_UP, OrbitKind.COAST_DOWN):
            raise InputError("needs one speed, not a ramp", key="orbit.kind")
        return table.kind
    if table.kind not in found:
        raise InputError(f"{_NEEDS[table.kind]}", key="orbit.kind")
    return table.kind


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


def _kinds(table: OrbitTable, unbalance: float) -> list[OrbitKind]:
    """Every kind that the other keys make up, the most telling first."""
    found = []
    if isinstance(table.speed, SpeedRampTable) and table.speed.stop != table.speed.start:
        rises = table.speed.stop > table.speed.start
        found.append(OrbitKind.RUN_UP if rises else OrbitKind.COAST_DOWN)
    if table.step is not None:
        found.append(OrbitKind.STEP)
    if table.harmonic is not None:
        found.append(OrbitKind.HARMONIC)
    if table.base_motion is not None or table.base_shock is not None:
        found.append(OrbitKind.BASE_MOTION)
    if unbalance > 0.0 and table.unbalance is not False:
        found.append(OrbitKind.UNBALANCE)
    return [*found, OrbitKind.FREE_DECAY]


def _loads(table: OrbitTable, rotor: RotorKind) -> list[Load]:
    loads: list[Load] = []
    if table.step is not None:
        step = table.step
        node = _node("step", step, rotor)
        loads.append(StepForce(_pair(step.force), step.start, _stop("step", step), node))
    if table.harmonic is not None:
        wave = table.harmonic
        loads.append(
            HarmonicForce(
                _pair(wave.force), wave.frequency, _pair(wave.phase), wave.start,
                _stop("harmonic", wave), _node("harmonic", wave, rotor),
            )
        )  # fmt: skip
    if table.base_motion is not None:
        base = table.base_motion
        stop = math.inf if base.stop is None else base.stop
        if stop <= base.start:
            raise InputError("must be after start", key="orbit.base_motion.stop")
        loads.append(
            BaseMotion(
                _pair(base.displacement), base.frequency, _pair(base.phase), base.start, stop
            )
        )
    if table.base_shock is not None:
        shock = table.base_shock
        loads.append(BaseShock(_pair(shock.acceleration), shock.duration, shock.start))
    return loads


def _node(name: str, load: LoadTable, rotor: RotorKind) -> int:
    if load.on is Station.JOURNAL:
        return 0
    if rotor is not RotorKind.JEFFCOTT:
        raise InputError(
            'only a rotor of kind = "jeffcott" has a disc apart from its journal',
            key=f"orbit.{name}.on",
        )
    return 1


def _stop(name: str, load: LoadTable) -> float:
    if load.stop is None:
        return math.inf
    if load.stop <= load.start:
        raise InputError("must be after start", key=f"orbit.{name}.stop")
    return load.stop


def _pair(values: list[float]) -> tuple[float, float]:
    return values[0], values[1]


def _check_linear(table: OrbitTable, tabulated: NDArray[np.float64]) -> None:
    if not table.static_load:
        raise InputError(
            'goes with force = "film" only: linear coefficients belong to the loaded position',
            key="orbit.static_load",
        )
    low, high = float(tabulated[0]), float(tabulated[-1])
    if isinstance(table.speed, SpeedRampTable):
        ends = {"orbit.speed.start": table.speed.start, "orbit.speed.stop": table.speed.stop}
    else:
        ends = {"orbit.speed": table.speed}
    for key, value in ends.items():
        if not low <= value <= high:
            rpm = 60.0 / (2.0 * math.pi)
            raise InputError(
                "must lie within operating.speed, where the coefficients are tabulated "
                f"({low * rpm:.6g} to {high * rpm:.6g} rpm)",
                key=key,
            )


def _orbit_clearance(table: OrbitTable, choices: tuple[float, ...]) -> float:
    if table.radial_clearance is None:
        return choices[0]
    for choice in choices:
        if math.isclose(choice, table.radial_clearance):
            return choice
    allowed = ", ".join(f'"{choice * 1e6:g} um"' for choice in choices)
    raise InputError(
        f"must be one of bearing.radial_clearance ({allowed})", key="orbit.radial_clearance"
    )


def _check_start(table: OrbitTable, clearance: float, eccentricity_ratio: float | None) -> None:
    """Refuse a start outside the clearance, wherever the equilibrium may be."""
    farthest = clearance * (1.0 + (1.0 if eccentricity_ratio is None else eccentricity_ratio))
    if math.hypot(*table.initial_displacement) >= farthest:
        raise InputError(
            "starts outside the clearance: from the equilibrium it must be less than "
            f"{farthest * 1e6:.4g} µm",
            key="orbit.initial_displacement",
        )
