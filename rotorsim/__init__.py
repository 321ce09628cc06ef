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
    from .errors import InputError, OutOfRangeError, RotorsimError, ScenarioError, TableError
    from .operating_point import FilmFields, HeatBalance, OperatingPoint
    from .orbit import Orbit
    from .pipeline import record, simulate_orbit
    from .recording import open_viewer
    from .scenario import Scenario, load_scenario
    from .shipped import shipped_scenarios, shipped_tables
    from .solver import solve, solve_case
    from .stability import stability_map, state_space
    from .status import SolveStatus, Stability
    from .sweep import tabulate
    from .table import CoefficientTable

__version__ = "0.1.0"

__all__ = [
    "CoefficientTable",
    "FilmFields",
    "HeatBalance",
    "InputError",
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
    "load_scenario",
    "open_viewer",
    "record",
    "shipped_scenarios",
    "shipped_tables",
    "simulate_orbit",
    "solve",
    "solve_case",
    "stability_map",
    "state_space",
    "tabulate",
]

_HOMES = {
    "errors": ("InputError", "OutOfRangeError", "RotorsimError", "ScenarioError", "TableError"),
    "operating_point": ("FilmFields", "HeatBalance", "OperatingPoint"),
    "orbit": ("Orbit",),
    "pipeline": ("record", "simulate_orbit"),
    "recording": ("open_viewer",),
    "scenario": ("Scenario", "load_scenario"),
    "shipped": ("shipped_scenarios", "shipped_tables"),
    "solver": ("solve", "solve_case"),
    "stability": ("stability_map", "state_space"),
    "status": ("SolveStatus", "Stability"),
    "sweep": ("tabulate",),
    "table": ("CoefficientTable",),
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
