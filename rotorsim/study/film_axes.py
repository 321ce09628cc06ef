"""Films over clearance, load, supply temperature and entries of a scenario's file."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..errors import InputError
from ..model import LoadTarget, MeshSize, ThermalModel
from ..units import QUANTITIES as KINDS
from .changes import OTHERWISE, changed, with_mesh

if TYPE_CHECKING:
    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario
    from .sweep import Progress

FILM_DIMENSIONS = ("radial_clearance", "applied_load", "supply_temperature")
"""Dimensions for which the film must be solved again."""
DIMENSIONS = ("speed", "mass", *FILM_DIMENSIONS)
_OWN_AXES = {
    "operating.speed": "speed", "rotor.mass": "mass", "operating.load": "applied_load",
    "bearing.radial_clearance": "radial_clearance",
    "thermal.supply_temperature": "supply_temperature",
}  # fmt: skip
"""Entries that are dimensions of their own."""
_SPEEDS = 12
_UNITS = {"applied_load": "N", "supply_temperature": "K"}
"""Dimensions that a table gets beside its own, and their units."""


def entry_axis(scenario: Scenario, name: str, key: str) -> str:
    """Return an entry's name as the table's dimension is called."""
    from ..files.scenario.scenario import entry_kind

    try:
        written, _ = entry_kind(type(scenario), name)
    except InputError as error:
        known = ", ".join(DIMENSIONS)
        raise InputError(
            f"must be one of {known}, or an entry of the scenario's file; {error.message}",
            key=key, value=name,
        ) from None  # fmt: skip
    if written in _OWN_AXES:
        raise InputError(f"is called {_OWN_AXES[written]} here", key=key, value=name)
    return name


def film_values(
    scenario: Scenario, name: str, given: Sequence[float] | None, *, on_axis: bool
) -> list[float]:
    """Return values of a film dimension to solve."""
    if given is not None:
        found = [float(value) for value in given]
        if on_axis and len(found) < 2:
            raise InputError("an axis needs two values or more", key=name, value=found)
        return found
    if name not in FILM_DIMENSIONS:
        raise InputError("is missing: an entry of the file needs values along its axis", key=name)
    if name == "radial_clearance":
        own = list(scenario.radial_clearances)
        if not on_axis and len(own) > 1:
            listed = ", ".join(f"{value * 1e6:.4g} µm" for value in own)
            raise InputError(f"say which; the scenario has {listed}", key=name)
        middle = float(np.mean(own))
        return (
            own if len(own) > 2 or not on_axis else [middle * f for f in np.linspace(0.7, 1.4, 7)]
        )
    if name == "applied_load":
        if not isinstance(scenario.target, LoadTarget):
            raise InputError(
                "the scenario gives an eccentricity ratio and no load: say which loads", key=name
            )
        return [float(scenario.target.load * f) for f in np.geomspace(1.0 / 3.0, 3.0, 9)]
    supply = scenario.thermal.supply_temperature
    return [float(supply + d) for d in np.linspace(-20.0, 20.0, 7)]


def solved_speeds(own: Array, wanted: Array) -> list[float]:
    """Return speeds to solve: the file's own where they cover the wanted ones densely enough."""
    low, high = float(wanted[0]), float(wanted[-1])
    if not high > low:
        return [low]
    if np.array_equal(wanted, own):
        return [float(speed) for speed in own]
    inside = own[(own > low) & (own < high)]
    if own[0] <= low and own[-1] >= high and inside.size >= 3:
        return sorted({low, high, *(float(speed) for speed in inside)})
    return [float(speed) for speed in np.geomspace(low, high, _SPEEDS)]


def tabulate_over(
    scenario: Scenario,
    axes: Mapping[str, Sequence[float]],
    speeds: Sequence[float] | None = None,
    *,
    thermal_models: Sequence[ThermalModel | str] | None = None,
    mesh: MeshSize | None = None,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> CoefficientTable:
    """Solve the film over clearance, load, supply temperature and entries as well as speed.

    axes : ``radial_clearance`` [m], ``applied_load`` [N], ``supply_temperature`` [K], or entries of
        the scenario's file: ascending values (SI). What is missing keeps the scenario's.
    speeds : [rad/s]; the scenario's by default.
    thermal_models : The scenario's by default.
    mesh : In place of the scenario's.
    executor, workers, progress : As for `rotorsim.tabulate`.
    Returns: With ``applied_load`` and ``supply_temperature`` as further dimensions where given.
    Raises InputError: Unknown axis, values that do not ascend, a temperature at which the oil's law
        means nothing.
    """
    from ..bearing.table import CoefficientTable
    from .sweep import as_table, sweep_points

    units = _check_axes(axes, scenario)
    models = list(thermal_models or scenario.thermal_models)
    clearances = axes.get("radial_clearance", scenario.radial_clearances)
    extra = list(units)
    places = list(itertools.product(*(axes[name] for name in extra)))
    cases = []
    for place in places:
        given = dict(zip(extra, place, strict=True))
        entries = {name: given.pop(name) for name in extra if name not in _UNITS}
        other = scenario.replace(**OTHERWISE, **entries) if entries else scenario
        other = other if mesh is None else with_mesh(other, mesh)
        for model, clearance in itertools.product(models, clearances):
            case = other.case(other.radial_clearances[0], model)
            cases.append(changed(case, {"radial_clearance": clearance, **given}))
    wanted = [float(s) for s in (scenario.speeds if speeds is None else speeds)]
    points = sweep_points(cases, wanted, executor=executor, workers=workers, progress=progress)
    size = len(points) // len(places)
    own = scenario if mesh is None else with_mesh(scenario, mesh)
    tables = {
        place: as_table(points[first * size : (first + 1) * size], own)
        for first, place in enumerate(places)
    }
    for name in reversed(extra):
        tables = {
            place: CoefficientTable.stack(
                [tables[*place, value] for value in axes[name]],
                name,
                list(axes[name]),
                units[name],
            )
            for place in dict.fromkeys(key[:-1] for key in tables)
        }
    (table,) = tables.values()
    return table


def _check_axes(axes: Mapping[str, Sequence[float]], scenario: Scenario) -> dict[str, str]:
    """Return the units of the table's further dimensions."""
    from ..files.scenario.scenario import entry_kind

    units = {name: unit for name, unit in _UNITS.items() if name in axes}
    for name, values in axes.items():
        least = 0.0
        if name not in ("radial_clearance", *_UNITS):
            entry_axis(scenario, name, name)
            kind = entry_kind(type(scenario), name)[1]
            units[name], least = ("1" if kind is None else KINDS[kind].unit), -math.inf
        if not len(values) or any(not (math.isfinite(v) and v > least) for v in values):
            raise InputError("must be one or more numbers above 0", key=name, value=list(values))
        if any(after <= before for before, after in itertools.pairwise(values)):
            raise InputError("must ascend", key=name, value=list(values))
    return units
