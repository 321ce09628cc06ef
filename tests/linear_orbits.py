"""Orbits of a rigid rotor on given stiffness and damping, in one call."""

from __future__ import annotations

from typing import Any

import numpy as np

from rotorsim.orbit import LinearForce, Orbit, OrbitProblem, SpeedSchedule, simulate
from rotorsim.rotor import Rotor


def constant_coefficients(stiffness, damping):
    """K [N/m] and C [N s/m] that do not change with speed, as `LinearForce` takes them."""
    k, c = np.asarray(stiffness, dtype=float), np.asarray(damping, dtype=float)
    return lambda _speed: (k, c)


def simulate_linear(
    coefficients,
    mass: float,
    speed: float | SpeedSchedule,
    radial_clearance: float,
    *,
    revolutions: float = 60.0,
    unbalance: float = 0.0,
    equilibrium=(0.0, 0.0),
    initial_displacement: tuple[float, float] = (1e-6, 0.0),
    **others: Any,
) -> Orbit:
    """Orbit of a rigid rotor (mass and unbalance per bearing) with K and C looked up by speed."""
    if not isinstance(speed, SpeedSchedule):
        speed = SpeedSchedule.constant(float(speed), revolutions)
    return simulate(
        OrbitProblem(
            LinearForce(coefficients, radial_clearance, equilibrium),
            Rotor.rigid(mass, unbalance),
            speed,
            initial_displacement=initial_displacement,
            **others,
        )
    )
