"""Tables over what changes the film itself: load, supply temperature, clearance, viscosity."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..model import (
    Bearing,
    Case,
    ExponentialViscosity,
    LoadTarget,
    Lubricant,
    MeshSize,
    ThermalModel,
    WaltherViscosity,
)

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario
    from .sweep import Progress

_UNITS = {"applied_load": "N", "supply_temperature": "K"}
"""Dimensions that a table gets beside its own, and their units."""

COARSE = MeshSize(circumferential=48, axial=12, cross_film=8, bush_radial=8)
"""Mesh for many solutions in a short time: critical masses within some per cent."""

_VISCOSITY_LIMITS = (1e-7, 1e5)


def _with_load(case: Case, load: float) -> Case:
    """`case` with the journal held by a load [N]."""
    return dataclasses.replace(case, target=LoadTarget(load))


def _with_clearance(case: Case, radial_clearance: float) -> Case:
    """`case` with another radial clearance [m]."""
    bearing = dataclasses.replace(case.bearing, radial_clearance=radial_clearance)
    return dataclasses.replace(case, bearing=bearing)


def _with_supply_temperature(case: Case, temperature: float) -> Case:
    """`case` with all oil, that of the grooves included, supplied at `temperature` [K]."""
    viscosity = float(case.lubricant.viscosity(temperature))
    low, high = _VISCOSITY_LIMITS
    if not (math.isfinite(viscosity) and low <= viscosity <= high):
        raise InputError(
            f"gives the oil a viscosity of {viscosity:.3g} Pa*s",
            key="supply_temperature",
            value=temperature,
        )
    grooves = tuple(
        dataclasses.replace(groove, supply_temperature=None) for groove in case.bearing.grooves
    )
    bearing: Bearing = dataclasses.replace(case.bearing, grooves=grooves)
    thermal = dataclasses.replace(case.thermal, supply_temperature=temperature)
    return dataclasses.replace(case, bearing=bearing, thermal=thermal)


def _with_viscosity(case: Case, factor: float) -> Case:
    """`case` with an oil that is `factor` as viscous at every temperature."""
    if not (math.isfinite(factor) and factor > 0.0):
        raise InputError("must be above 0", key="viscosity", value=factor)
    oil: Lubricant = case.lubricant
    law = oil.law
    if isinstance(law, ExponentialViscosity):
        law = dataclasses.replace(law, reference_viscosity=law.reference_viscosity * factor)
    elif isinstance(law, WaltherViscosity):
        # The law's density does nothing but turn kinematic into dynamic viscosity.
        law = dataclasses.replace(law, density=law.density * factor)
    else:
        raise InputError("this oil's law cannot be scaled", key="viscosity")
    return dataclasses.replace(case, lubricant=dataclasses.replace(oil, law=law))


def with_mesh(scenario: Scenario, mesh: MeshSize) -> Scenario:
    """`scenario` on another mesh."""
    return dataclasses.replace(scenario, film=dataclasses.replace(scenario.film, mesh=mesh))


_CHANGES = {
    "radial_clearance": _with_clearance,
    "applied_load": _with_load,
    "supply_temperature": _with_supply_temperature,
    "viscosity": _with_viscosity,
}


def changed(case: Case, values: Mapping[str, float]) -> Case:
    """`case` with some of its inputs replaced.

    values : ``radial_clearance`` [m], ``applied_load`` [N], ``supply_temperature`` [K],
        ``viscosity`` (a factor).
    """
    for name, value in values.items():
        if name not in _CHANGES:
            raise InputError(f"must be one of {', '.join(_CHANGES)}", key=name)
        case = _CHANGES[name](case, value)
    return case


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
    """Solve the film over clearance, load and supply temperature as well as speed.

    axes : ``radial_clearance`` [m], ``applied_load`` [N], ``supply_temperature`` [K]: ascending
        values. What is missing keeps the scenario's.
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

    _check_axes(axes)
    scenario = scenario if mesh is None else with_mesh(scenario, mesh)
    models = list(thermal_models or scenario.thermal_models)
    clearances = axes.get("radial_clearance", scenario.radial_clearances)
    extra = [name for name in _UNITS if name in axes]
    places = list(itertools.product(*(axes[name] for name in extra)))
    cases = []
    for place in places:
        for model, clearance in itertools.product(models, clearances):
            case = scenario.case(scenario.radial_clearances[0], model)
            given = {"radial_clearance": clearance, **dict(zip(extra, place, strict=True))}
            cases.append(changed(case, given))
    wanted = [float(s) for s in (scenario.speeds if speeds is None else speeds)]
    points = sweep_points(cases, wanted, executor=executor, workers=workers, progress=progress)
    size = len(points) // len(places)
    tables = {
        place: as_table(points[first * size : (first + 1) * size], scenario)
        for first, place in enumerate(places)
    }
    for name in reversed(extra):
        tables = {
            place: CoefficientTable.stack(
                [tables[*place, value] for value in axes[name]],
                name,
                list(axes[name]),
                _UNITS[name],
            )
            for place in dict.fromkeys(key[:-1] for key in tables)
        }
    (table,) = tables.values()
    return table


def _check_axes(axes: Mapping[str, Sequence[float]]) -> None:
    allowed: dict[str, Any] = {"radial_clearance": None, **_UNITS}
    for name, values in axes.items():
        if name not in allowed:
            raise InputError(f"must be one of {', '.join(allowed)}", key=name)
        if not len(values) or any(not (math.isfinite(v) and v > 0.0) for v in values):
            raise InputError("must be one or more numbers above 0", key=name, value=list(values))
        if any(after <= before for before, after in itertools.pairwise(values)):
            raise InputError("must ascend", key=name, value=list(values))
