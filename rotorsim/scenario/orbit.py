"""The orbit's settings, checked against the rest of the scenario."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .schema import OrbitTable, ScenarioTables, SpeedRampTable
from .settings import OrbitForce, OrbitSettings, SpeedRamp

DEFAULT_REVOLUTIONS = 60


def orbit_settings(
    tables: ScenarioTables, clearance_choices: tuple[float, ...], tabulated: NDArray[np.float64]
) -> OrbitSettings | None:
    """Read what to simulate in the time domain."""
    table = tables.orbit
    if table is None:
        return None
    if tables.rotor is None:
        raise InputError('is missing: an orbit needs a rotor; add mass = "1200 kg"', key="rotor")
    if table.force is OrbitForce.LINEAR:
        _check_orbit_speed(table, tabulated)
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
        speed, revolutions = SpeedRamp(ramp.start, ramp.stop, ramp.duration), None
    return OrbitSettings(
        radial_clearance=clearance,
        speed=speed,
        revolutions=revolutions,
        force=table.force,
        initial_displacement=(table.initial_displacement[0], table.initial_displacement[1]),
        initial_velocity=(table.initial_velocity[0], table.initial_velocity[1]),
    )


def _check_orbit_speed(table: OrbitTable, tabulated: NDArray[np.float64]) -> None:
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
            f"{farthest * 1e6:.4g} um",
            key="orbit.initial_displacement",
        )
