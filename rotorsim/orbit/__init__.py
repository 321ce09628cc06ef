"""Journal orbits in time: rotor, film force and loads, integrated with SciPy, and their analysis.

Everything is SI and in the load frame. `simulate(OrbitProblem(...))` gives an `Orbit`;
`simulate_linear` is the short way with given stiffness and damping.
"""

from .analysis import (
    OrbitAnalysis,
    WhirlRange,
    analyse,
    initial_growth,
    speed_cascade,
    steady_spectrum,
    whirl_range,
)
from .clearance import contact_boundary, minimum_film
from .equilibrium import find_equilibrium, linearize_force
from .film_force import (
    LoadedFilm,
    SolvedFilmForce,
    can_be_mapped,
    loaded_film,
    operating_film,
    prepare_map,
)
from .film_map import cache_folder, film_force_map
from .force_map import FilmMapForce, ForceMap
from .forces import (
    BearingForce,
    CallableForce,
    LinearForce,
    ShortBearingForce,
    constant_coefficients,
)
from .integrate import simulate, simulate_pieces
from .linear import simulate_linear
from .loads import BaseMotion, BaseShock, Controller, HarmonicForce, StepForce
from .modes import Growth, Modes, fit_modes, growth_rate
from .orbit import Orbit, OrbitEvent, OrbitStatus, concatenate
from .problem import Method, OrbitProblem
from .recognition import Recognition, once_per_turn, recognise, steady_part
from .spectrum import (
    Cascade,
    Ellipse,
    Spectrum,
    cascade,
    orbit_ellipse,
    poincare_points,
    spectrum,
    whirl_frequency_ratio,
)
from .speed import SpeedSchedule

__all__ = [
    "BaseMotion",
    "BaseShock",
    "BearingForce",
    "CallableForce",
    "Cascade",
    "Controller",
    "Ellipse",
    "FilmMapForce",
    "ForceMap",
    "Growth",
    "HarmonicForce",
    "LinearForce",
    "LoadedFilm",
    "Method",
    "Modes",
    "Orbit",
    "OrbitAnalysis",
    "OrbitEvent",
    "OrbitProblem",
    "OrbitStatus",
    "Recognition",
    "ShortBearingForce",
    "SolvedFilmForce",
    "Spectrum",
    "SpeedSchedule",
    "StepForce",
    "WhirlRange",
    "analyse",
    "cache_folder",
    "can_be_mapped",
    "cascade",
    "concatenate",
    "constant_coefficients",
    "contact_boundary",
    "film_force_map",
    "find_equilibrium",
    "fit_modes",
    "growth_rate",
    "initial_growth",
    "linearize_force",
    "loaded_film",
    "minimum_film",
    "once_per_turn",
    "operating_film",
    "orbit_ellipse",
    "poincare_points",
    "prepare_map",
    "recognise",
    "simulate",
    "simulate_linear",
    "simulate_pieces",
    "spectrum",
    "speed_cascade",
    "steady_part",
    "steady_spectrum",
    "whirl_frequency_ratio",
    "whirl_range",
]
