"""Stability over any two of speed, mass, clearance, load, and entries of a bearing's file."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array, Booleans
from ..errors import InputError
from ..model import MeshSize
from ..rows import Quantity, quantity
from .film_axes import (
    DIMENSIONS,
    FILM_DIMENSIONS,
    entry_axis,
    film_values,
    solved_speeds,
    tabulate_over,
)

if TYPE_CHECKING:
    import xarray as xr

    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario
    from .sweep import Progress


_CELLS = 101


@dataclass(frozen=True, eq=False)
class Plane:
    """Stability over two inputs (SI), the others held.

    x, y : Dimensions: two of `DIMENSIONS`, or parameters of a machine.
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
        """Names of x and y as they are written: of a machine ``left.radial_clearance``."""
        x, y = (str(self.dataset[n].attrs.get("parameter", n)) for n in (self.x, self.y))
        return x, y

    @property
    def file_name(self) -> str:
        """Name of its files, without a suffix."""
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

    x, y : Two of `DIMENSIONS`, or entries of the scenario's file (``bearing.pocket[0].depth``).
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
        name: film_values(scenario, name, given.get(name), on_axis=name in (x, y))
        for name in (*FILM_DIMENSIONS, *entries)
        if name in (x, y) or name in given or name == "radial_clearance"
    }
    speeds = np.asarray(given.get("speed", scenario.speeds if "speed" in (x, y) else []))
    speeds = speeds if speeds.size else scenario.speeds[-1:]
    table = tabulate_over(
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
    kept = {name: float(dataset[name]) for name in DIMENSIONS if name in dataset.coords
            and name not in (x, y) and np.isfinite(float(dataset[name]))}  # fmt: skip
    return Plane(x, y, kept, dataset, size, failed)


def _check_plane(
    x: str, y: str, held: Mapping[str, float] | None, scenario: Scenario | None = None
) -> list[str]:
    """Return those of the axes that are entries of the scenario's file."""
    entries = []
    for key, name in (("x", x), ("y", y)):
        if name not in DIMENSIONS and scenario is not None:
            entries.append(entry_axis(scenario, name, key))
        elif name not in DIMENSIONS and "." not in name:  # a table may have such a dimension
            raise InputError(f"must be one of {', '.join(DIMENSIONS)}", key=key, value=name)
        if name in (held or {}):
            raise InputError("is an axis of the map and cannot be held as well", key=name)
    if x == y:
        raise InputError("must differ from x", key="y", value=y)
    return entries


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
