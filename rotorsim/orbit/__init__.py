"""Journal orbits in time: rotor, film force and loads, integrated with SciPy, and their analysis.

Everything is SI and in the load frame. `simulate(OrbitProblem(...))` gives an `Orbit`.
"""

from .analysis import analyse, steady_part
from .forces import CallableForce, LinearForce, ShortBearingForce
from .integrate import simulate
from .orbit import Orbit
from .problem import OrbitProblem, SpeedSchedule
from .spectrum import cascade, locked_ratio, orbit_ellipse, poincare_points, spectrum

__all__ = [
    "CallableForce",
    "LinearForce",
    "Orbit",
    "OrbitProblem",
    "ShortBearingForce",
    "SpeedSchedule",
    "analyse",
    "cascade",
    "locked_ratio",
    "orbit_ellipse",
    "poincare_points",
    "simulate",
    "spectrum",
    "steady_part",
]
