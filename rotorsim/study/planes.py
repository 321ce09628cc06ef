"""Stability over any two of speed, mass, clearance, load, and entries of a bearing's file."""

from __future__ import annotations

import dataclasses
import itertools
import math
import re
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array, Booleans
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
from ..rows import Quantity, quantity
from ..units import QUANTITIES as KINDS

if TYPE_CHECKING:
    import xarray as xr

    from ..bearing.table import CoefficientTable
    from ..files.machine import MachineFile
    from ..files.scenario import Scenario
    from .sweep import Progress


_FILM_DIMENSIONS = ("radial_clearance", "applied_load", "supply_temperature")
"""Dimensions for which the film must be solved again."""
_DIMENSIONS = ("speed", "mass", *_FILM_DIMENSIONS)
_OWN_AXES = {
    "operating.speed": "speed", "rotor.mass": "mass", "operating.load": "applied_load",
    "bearing.radial_clearance": "radial_clearance",
    "thermal.supply_temperature": "supply_temperature",
}  # fmt: skip
"""Entries that are dimensions of their own."""
_CELLS = 101
_SPEEDS = 12


@dataclass(frozen=True, eq=False)
class Plane:
    """Stability over two inputs (SI), the others held.

    x, y : Dimensions: two of `_DIMENSIONS`, or parameters of a machine.
    held : The others.
    dataset : xarray.Dataset. Over ``thermal_model``, x and y: ``growth_rate`` (largest real part
        [1/s]: stable below 0), ``verdict``, and more, see `StabilityMap` and
        `map_of_machine`.
    solved_points, failed_points : Films behind it, and how many of them did not converge.
    """

    x: str
    y: str
    held: Mapping[str, float]
    dataset: xr.Dataset
    solved_points: int
    failed_points: int

    @property
    def models(self) -> tuple[str, ...]:
        """Thermal models."""
        return tuple(str(name) for name in self.dataset["thermal_model"].values)

    @property
    def names(self) -> tuple[str, str]:
        """Of x and y as they are written: of a machine ``left.radial_clearance``."""
        x, y = (str(self.dataset[n].attrs.get("parameter", n)) for n in (self.x, self.y))
        return x, y

    @property
    def file_name(self) -> str:
        """Of its files, without a suffix."""
        return re.sub(r"[^\w.-]+", "_", f"map_{self.x}_{self.y}")

    @property
    def quantities(self) -> tuple[Quantity, Quantity]:
        """Quantities of x and y, as they are shown."""
        units = (self.dataset[n].attrs.get("units", "") for n in (self.x, self.y))
        first, second = map(quantity, self.names, units)
        return first, second

    def values(self, name: str, model: str) -> Array:
        """Return the variable of one thermal model, (n_x, n_y)."""
        part = self.dataset[name].sel(thermal_model=model)
        return part.transpose(self.x, self.y).values

    def growth(self, model: str) -> Array:
        """Return largest real part of the eigenvalues [1/s], above 0 where unstable, (n_x, n_y)."""
        return self.values("growth_rate", model)

    @property
    def destabilised_by_heating(self) -> Booleans | None:
        """True where only heating makes the rotor unstable, (n_x, n_y); None with one model."""
        if "destabilised_by_heating" not in self.dataset:
            return None
        found = self.dataset["destabilised_by_heating"].transpose(self.x, self.y)
        return np.asarray(found.values, dtype=bool)


def held_text(held: Mapping[str, float]) -> str:
    """Return ``1200 kg, c = 100 µm``: what a plane or a diagram holds."""
    return ", ".join(quantity(name).said(value) for name, value in held.items())


def plane_of_scenario(
    scenario: Scenario,
    x: str,
    y: str,
    values: Mapping[str, Sequence[float]] | None = None,
    held: Mapping[str, float] | None = None,
    *,
    thermal_models: Sequence[str] | None = None,
    mesh: MeshSize | None = None,
    cells: int = _CELLS,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Plane:
    """Solve the film where the plane needs it, and map the stability in between.

    x, y : Two of `_DIMENSIONS`, or entries of the scenario's file (``bearing.pocket[0].depth``).
    values : Values along x and y, ascending (SI). For what changes the film these are solved; the
        map goes from the first to the last. The scenario's, or a span about them, by default; an
        entry's must be given.
    held : Values of the others; the scenario's by default, of the speed its highest.
    thermal_models : The scenario's by default.
    mesh : In place of the scenario's.
    cells : Values along each axis of the map; 0: those given, nothing interpolated but the speed.
    executor, workers, progress : As for `rotorsim.tabulate`.
    Raises InputError: Axes alike or unknown, or something left open.
    """
    entries = _check_plane(x, y, held, scenario)
    given = {**(values or {}), **{name: [value] for name, value in (held or {}).items()}}
    axes = {
        name: _film_values(scenario, name, given.get(name), on_axis=name in (x, y))
        for name in (*_FILM_DIMENSIONS, *entries)
        if name in (x, y) or name in given or name == "radial_clearance"
    }
    speeds = np.asarray(given.get("speed", scenario.speeds if "speed" in (x, y) else []))
    speeds = speeds if speeds.size else scenario.speeds[-1:]
    table = _tabulate_over(
        scenario, axes, solved_speeds(scenario.speeds, speeds), thermal_models=thermal_models,
        mesh=mesh, executor=executor, workers=workers, progress=progress,
    )  # fmt: skip
    own = None if scenario.rotor is None else scenario.rotor.rigid_mass
    mass = given.get("mass")
    if mass is None and own is not None:
        mass = _masses_about(own) if "mass" in (x, y) else [own]
    return plane_of_table(table, x, y, {"speed": speeds, "mass": mass}, cells=cells)


def plane_of_table(
    table: CoefficientTable,
    x: str,
    y: str,
    values: Mapping[str, Sequence[float] | Array | None],
    held: Mapping[str, float] | None = None,
    *,
    cells: int = _CELLS,
) -> Plane:
    """Map the stability over two inputs that a table holds.

    x, y : ``speed``, ``mass`` or a dimension of the table.
    values : ``speed`` [rad/s] (the tabulated ones by default) and ``mass`` [kg] (along an axis: up
        to three times the median critical mass at the highest speed by default).
    held : Where the table's other dimensions are held.
    cells : Values along each axis of the map; 0: those given.
    """
    from ..machine.map import stability_map

    _check_plane(x, y, held)
    for name in (x, y):
        if name not in ("speed", "mass") and name not in table.choices:
            raise InputError(
                "is not in this table; give the scenario, which can solve it", key=name
            )
    mass = values.get("mass")
    if mass is None and "mass" in (x, y):
        mass = _masses_about(_median_critical_mass(table))
    if mass is None:
        raise InputError('is missing: a verdict needs it; give for example "900 kg"', key="mass")
    chosen = {name: value for name, value in (held or {}).items() if name in table.choices}
    table = table.select(**chosen)
    for name in (x, y):
        if name in table.choices and table.dataset.sizes[name] < 2:
            raise InputError(
                "has one value in this table, which makes no axis; give the scenario in its place: "
                "it can be solved at others",
                key=name, value=float(table.dataset[name].values[0]),
            )  # fmt: skip
    size, failed = table.converged.size, int((~table.converged).sum())
    for name in (x, y):
        along = table.dataset[name].values if name in table.choices else ()
        if cells and len(along) > 1:
            table = table.refine(name, _spread(np.asarray(along), cells))
    speeds = values.get("speed")
    speeds = table.speeds if speeds is None else np.asarray(speeds, dtype=float)
    axes = {"speed": speeds, "mass": np.asarray(mass, dtype=float)}
    for name in axes:
        if name in (x, y) and cells and axes[name].size > 1:
            axes[name] = _spread(axes[name], cells)
    for name, along in axes.items():
        if name not in (x, y) and along.size != 1:
            raise InputError("has several values: say which", key=name)
        if name in (x, y) and along.size < 2:
            raise InputError("an axis needs two values or more", key=name, value=float(along[0]))
    chart = stability_map(table, axes["mass"], axes["speed"])
    dataset = chart.plane(x, y)
    kept = {name: float(dataset[name]) for name in _DIMENSIONS if name in dataset.coords
            and name not in (x, y) and np.isfinite(float(dataset[name]))}  # fmt: skip
    return Plane(x, y, kept, dataset, size, failed)


def _check_plane(
    x: str, y: str, held: Mapping[str, float] | None, scenario: Scenario | None = None
) -> list[str]:
    """Return those of the axes that are entries of the scenario's file."""
    entries = []
    for key, name in (("x", x), ("y", y)):
        if name not in _DIMENSIONS and scenario is not None:
            entries.append(_entry_axis(scenario, name, key))
        elif name not in _DIMENSIONS and "." not in name:  # a table may have such a dimension
            raise InputError(f"must be one of {', '.join(_DIMENSIONS)}", key=key, value=name)
        if name in (held or {}):
            raise InputError("is an axis of the map and cannot be held as well", key=name)
    if x == y:
        raise InputError("must differ from x", key="y", value=y)
    return entries


def _entry_axis(scenario: Scenario, name: str, key: str) -> str:
    """Return an entry's name as the table's dimension is called."""
    from ..files.scenario.scenario import entry_kind

    try:
        written, _ = entry_kind(type(scenario), name)
    except InputError as error:
        known = ", ".join(_DIMENSIONS)
        raise InputError(
            f"must be one of {known}, or an entry of the scenario's file; {error.message}",
            key=key, value=name,
        ) from None  # fmt: skip
    if written in _OWN_AXES:
        raise InputError(f"is called {_OWN_AXES[written]} here", key=key, value=name)
    return name


def _film_values(
    scenario: Scenario, name: str, given: Sequence[float] | None, *, on_axis: bool
) -> list[float]:
    """Return values of a film dimension to solve."""
    if given is not None:
        found = [float(value) for value in given]
        if on_axis and len(found) < 2:
            raise InputError("an axis needs two values or more", key=name, value=found)
        return found
    if name not in _FILM_DIMENSIONS:
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


def _masses_about(middle: float) -> Array:
    return np.linspace(0.05, 3.0, 60) * middle


def _median_critical_mass(table: CoefficientTable) -> float:
    """Return the median critical mass of every curve at the highest speed [kg]."""
    from ..bearing.whirl import rigid_thresholds

    found = rigid_thresholds(
        table.stiffness[..., -1, :, :], table.damping[..., -1, :, :], table.speeds[-1]
    ).critical_mass
    known = found[np.isfinite(found)]
    if not known.size:
        raise InputError("needs values: no mass is critical here", key="mass")
    return float(np.median(known))


def _spread(values: Array, cells: int) -> Array:
    """Return `cells` values from the first to the last."""
    return np.linspace(float(values[0]), float(values[-1]), cells)


_UNITS = {"applied_load": "N", "supply_temperature": "K"}
"""Dimensions that a table gets beside its own, and their units."""
COARSE = MeshSize(circumferential=48, axial=12, cross_film=8, bush_radial=8)
"""Mesh for many solutions in a short time: critical masses within some per cent."""
_VISCOSITY_LIMITS = (1e-7, 1e5)
OTHERWISE = {"orbit": None, "stability": None, "tolerances": None, "study": None}
"""Parts of a scenario that are not asked for where an entry varies."""


def _with_supply_temperature(case: Case, temperature: float) -> Case:
    """Return `case` with all oil, that of the grooves included, supplied at `temperature` [K]."""
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
    """Return `case` with an oil that is `factor` as viscous at every temperature."""
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
    """Return `scenario` on another mesh."""
    return dataclasses.replace(scenario, film=dataclasses.replace(scenario.film, mesh=mesh))


def machine_with_mesh(machine: MachineFile, mesh: MeshSize | None) -> MachineFile:
    """Return `machine` with its bearings on another mesh."""
    if mesh is None:
        return machine
    bearings = {name: with_mesh(one, mesh) for name, one in machine.bearings.items()}
    return machine.with_parts(bearings=bearings)


def changed(case: Case, values: Mapping[str, float]) -> Case:
    """Return `case` with some of its inputs replaced.

    values : ``radial_clearance`` [m], ``applied_load`` [N], ``supply_temperature`` [K],
        ``viscosity`` (a factor).
    """
    for name, value in values.items():
        match name:
            case "radial_clearance":
                bearing = dataclasses.replace(case.bearing, radial_clearance=value)
                case = dataclasses.replace(case, bearing=bearing)
            case "applied_load":
                case = dataclasses.replace(case, target=LoadTarget(value))
            case "supply_temperature":
                case = _with_supply_temperature(case, value)
            case "viscosity":
                case = _with_viscosity(case, value)
            case _:
                allowed = "radial_clearance, applied_load, supply_temperature, viscosity"
                raise InputError(f"must be one of {allowed}", key=name)
    return case


def _tabulate_over(
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
            _entry_axis(scenario, name, name)
            kind = entry_kind(type(scenario), name)[1]
            units[name], least = ("1" if kind is None else KINDS[kind].unit), -math.inf
        if not len(values) or any(not (math.isfinite(v) and v > least) for v in values):
            raise InputError("must be one or more numbers above 0", key=name, value=list(values))
        if any(after <= before for before, after in itertools.pairwise(values)):
            raise InputError("must ascend", key=name, value=list(values))
    return units
