"""Hydrodynamic journal bearings: from drawing and oil to a stability verdict.

Names are imported when first used, so that ``import rotorsim`` costs next to nothing.

Examples
--------
>>> import rotorsim as rs
>>> rs.SolveStatus.CONVERGED.value
'converged'
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .bearing.operating_point import FilmFields, OperatingPoint
    from .bearing.solve import solve_case
    from .bearing.table import CoefficientTable
    from .errors import InputError, OutOfRangeError, RotorsimError, ScenarioError, TableError
    from .files.machine import MachineFile, load_machine
    from .files.scenario import Scenario, load_scenario
    from .film.heat import HeatBalance
    from .machine.map import stability_map
    from .orbit import Orbit
    from .shipped import shipped_scenarios, shipped_tables
    from .show.job import record
    from .show.plot import plot
    from .show.viewer import open_viewer
    from .status import SolveStatus, Stability
    from .study.limit_cycles import forced_response, largest_disturbance, limit_cycles
    from .study.machine_analysis import analyse_machine
    from .study.machine_motion import simulate
    from .study.machines import modes, state_space, unbalance_response
    from .study.orbits import simulate_orbit
    from .study.points import solve
    from .study.sweep import tabulate

__version__ = "0.1.0"

__all__ = [
    "CoefficientTable",
    "FilmFields",
    "HeatBalance",
    "InputError",
    "MachineFile",
    "OperatingPoint",
    "Orbit",
    "OutOfRangeError",
    "RotorsimError",
    "Scenario",
    "ScenarioError",
    "SolveStatus",
    "Stability",
    "TableError",
    "__version__",
    "analyse_machine",
    "forced_response",
    "largest_disturbance",
    "limit_cycles",
    "load_machine",
    "load_scenario",
    "modes",
    "open_viewer",
    "plot",
    "record",
    "shipped_scenarios",
    "shipped_tables",
    "simulate",
    "simulate_orbit",
    "solve",
    "solve_case",
    "stability_map",
    "state_space",
    "tabulate",
    "unbalance_response",
]

_HOMES = {
    "bearing.operating_point": ("FilmFields", "OperatingPoint"),
    "bearing.solve": ("solve_case",),
    "study.points": ("solve",),
    "bearing.table": ("CoefficientTable",),
    "errors": ("InputError", "OutOfRangeError", "RotorsimError", "ScenarioError", "TableError"),
    "files.scenario": ("Scenario", "load_scenario"),
    "film.heat": ("HeatBalance",),
    "machine.map": ("stability_map",),
    "files.machine": ("MachineFile", "load_machine"),
    "orbit": ("Orbit",),
    "shipped": ("shipped_scenarios", "shipped_tables"),
    "show.job": ("record",),
    "show.plot": ("plot",),
    "show.viewer": ("open_viewer",),
    "status": ("SolveStatus", "Stability"),
    "study.limit_cycles": ("forced_response", "largest_disturbance", "limit_cycles"),
    "study.machine_analysis": ("analyse_machine",),
    "study.machine_motion": ("simulate",),
    "study.machines": ("modes", "state_space", "unbalance_response"),
    "study.orbits": ("simulate_orbit",),
    "study.sweep": ("tabulate",),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f".{_HOME_OF[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
