"""From a scenario to everything that is written: coefficients, map, orbits, figures, recording."""

from .orbits import orbit_problem, orbit_settings, simulate_orbit
from .recordings import record
from .stability import StabilityCurve, stability_curves

__all__ = [
    "StabilityCurve",
    "orbit_problem",
    "orbit_settings",
    "record",
    "simulate_orbit",
    "stability_curves",
]
