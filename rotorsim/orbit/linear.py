"""The short way: a rigid rotor on stiffness and damping, plain numbers in, an orbit out."""

from __future__ import annotations

from ..rotor import Rotor
from .forces import CoefficientsBySpeed, LinearForce, PositionBySpeed
from .integrate import simulate
from .orbit import Orbit
from .problem import OrbitProblem
from .speed import SpeedSchedule


def simulate_linear(
    coefficients: CoefficientsBySpeed,
    mass: float,
    speed: float | SpeedSchedule,
    radial_clearance: float,
    *,
    revolutions: float = 60.0,
    unbalance: float = 0.0,
    equilibrium: tuple[float, float] | PositionBySpeed = (0.0, 0.0),
    initial_displacement: tuple[float, float] = (1e-6, 0.0),
    minimum_film: float = 0.0,
    thermal_model: str = "isothermal",
) -> Orbit:
    """Orbit of a rigid rotor with K and C looked up by speed (Dal Eq. 21, with unbalance).

    Parameters
    ----------
    coefficients : callable
        speed [rad/s] -> (K, C), (2, 2) arrays [N/m, N s/m]; see `constant_coefficients`.
    mass : float
        Per bearing [kg].
    speed : float or SpeedSchedule
        [rad/s]; a number is held for `revolutions`.
    radial_clearance : float
        [m]
    revolutions : float
        At constant speed.
    unbalance : float
        Per bearing [kg m].
    equilibrium : (float, float) or callable
        Static position [m], or speed -> position.
    initial_displacement : (float, float)
        From equilibrium [m].
    minimum_film : float
        Film thickness at which the run ends with ``touch_down`` [m].
    thermal_model : str
        Label.

    Examples
    --------
    >>> from rotorsim.orbit import constant_coefficients
    >>> still = constant_coefficients([[1e8, 0], [0, 1e8]], [[1e4, 0], [0, 1e4]])
    >>> orbit = simulate_linear(still, mass=100.0, speed=500.0, radial_clearance=1e-4)
    >>> orbit.status.value
    'settled'
    """
    schedule = speed
    if not isinstance(schedule, SpeedSchedule):
        schedule = SpeedSchedule.constant(float(schedule), revolutions)
    return simulate(
        OrbitProblem(
            LinearForce(coefficients, radial_clearance, equilibrium),
            Rotor.rigid(mass, unbalance),
            schedule,
            initial_displacement=initial_displacement,
            minimum_film=minimum_film,
            thermal_model=thermal_model,
        )
    )
