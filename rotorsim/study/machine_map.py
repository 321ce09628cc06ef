"""Stability of a machine over any two of its parameters."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array, Indices
from ..errors import InputError
from ..files.machine import MachineFile
from ..files.parameters import PARAMETERS, Parameter, Variant, held_values, parameter
from ..machine.modes import machine_spectrum
from ..machine.support import MatrixTable, Support
from ..model import Case, MeshSize
from ..model.machine import MapEntry
from ..rotor import Rotor
from ..threads import on_one_blas_thread
from .changes import machine_with_mesh
from .film_axes import solved_speeds
from .machine import MachineResult
from .machine_analysis import MachineAnalysis, no_sweep, solve_films_together, thermal_models
from .machine_supports import SupportState, film_support
from .planes import Plane
from .processes import available_cores, map_on_processes
from .sweep import Progress, sweep_points

if TYPE_CHECKING:
    from ..bearing.operating_point import OperatingPoint

_CELLS = 25
_SPANS = {
    "radial_clearance": np.linspace(0.7, 1.4, 7),
    "viscosity": np.geomspace(0.5, 2.0, 7),
    "load": np.geomspace(0.4, 2.5, 7),
    "destabilising_stiffness": np.linspace(0.0, 5.0, 11),
}
"""Default values along an axis, as multiples of the file's."""
_KELVINS = np.linspace(-20.0, 20.0, 7)
_CHECKED = 5
"""Places along the other axis at which interpolation over a film's parameter is checked."""


def map_of_machine(
    machine: MachineFile,
    x: str,
    y: str,
    values: Mapping[str, object] | None = None,
    held: Mapping[str, object] | None = None,
    *,
    models: Sequence[str] | None = None,
    mesh: MeshSize | None = None,
    cells: int = _CELLS,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Plane:
    """Return the growth rate of the least stable mode over two parameters of a machine.

    x, y : Names of parameters, see `rotorsim.files.parameters`: ``speed``,
        ``left.radial_clearance``.
    values : ``x`` and ``y``: values with units, or ``"start : stop : count"``; at those of a film's
        parameter the films are solved. By default a span about the file's value.
    held : Values with units of other parameters, by name; ``speed`` is by default the highest.
    models : Thermal models; by default those of the bearings' files.
    mesh : In place of the bearings' own.
    cells : Values along each axis, from its first to its last; 0: those given.
    workers, progress : As for `rotorsim.tabulate`.
    Returns: Its dataset has ``growth_rate`` [1/s], ``damped_frequency`` [rad/s] of that mode and
        ``verdict`` (1 stable, 0 unstable, 2 undamped, -1 unknown). Where films were solved at some
        values along an axis, the coefficients between are interpolated (monotone cubic, as over
        speed), the eigenvalues solved in every cell. Attribute ``interpolation_error`` [1/s]: the
        largest change of the growth rate at solved values that are left out, every second one: an
        upper bound, as the true spacing is half of that; NaN with fewer than five.
    Raises InputError: A name or a value is wrong, or the axes are alike.
    """
    axes = [parameter(machine, name, key) for key, name in (("x", x), ("y", y))]
    if axes[0] == axes[1]:
        raise InputError("must differ from x", key="y", value=y)
    fixed = held_values(machine, held or {}, "hold")
    for one in axes:
        if one in fixed:
            raise InputError("is an axis of the map and cannot be held as well", key=one.name)
    machine = machine_with_mesh(machine, mesh)
    base = Variant(machine)
    for one, value in fixed.items():
        base = one.applied(base, value)
    given = values or {}
    nodes = [_axis(one, machine, given.get(key), key) for key, one in zip("xy", axes, strict=True)]
    workers = workers or available_cores()
    job = _Job(base, axes, nodes, fixed, cells, workers, progress)
    datasets = {model: job.result(model) for model in models or thermal_models(machine)}
    return job.plane(datasets)


def map_of_entry(machine: MachineFile, entry: MapEntry, **options: object) -> Plane:
    """Return one ``[[map]]`` of a machine's file."""
    values = {"x": entry.x_values, "y": entry.y_values}
    return map_of_machine(machine, entry.x, entry.y, values, entry.hold, **options)  # type: ignore[arg-type]


def _axis(one: Parameter, machine: MachineFile, given: object, key: str) -> Array:
    """Return values along an axis, at least two."""
    if given is not None:
        found = np.array(one.values(given, f"{key}_values"))
        if found.size < 2:
            raise InputError("an axis needs two values or more", key=f"{key}_values", value=given)
        return found
    if one.kind == "speed":
        found = np.array(machine.operating.speeds)
        if found.size < 2:
            raise InputError("the file has one speed: say which", key=f"{key}_values")
        return found
    nominal = one.nominal(machine)
    if one.kind == "load":
        speeds = [max(machine.operating.speeds)]
        rotor, model = machine.rotor_with_unbalance(), thermal_models(machine)[0]
        analysis = MachineAnalysis(Variant(machine), rotor, model, speeds, no_sweep)
        place = machine.support_names.index(one.owner)
        nominal = float(np.hypot(*analysis.determinate_loads()[0, place]))
    if not nominal:
        example = PARAMETERS[one.kind].example
        raise InputError(
            f'needs values, "{example}, ..." say: the file gives none to go about, or several',
            key=f"{key}_values",
        )
    if one.kind == "supply_temperature":
        return nominal + _KELVINS
    return nominal * _SPANS.get(one.kind, np.geomspace(0.25, 4.0, 9))


def _solve_variants(
    variants: Sequence[Variant],
    model: str,
    speeds: Sequence[float],
    places: Sequence[float] = (),
    workers: int = 1,
    progress: Progress | None = None,
) -> list[MachineResult]:
    """Return films and supports of variants at some speeds.

    A film that several share is solved once.

    model : Thermal model.
    speeds : [rad/s]
    places : Where the rotor needs nodes besides those of the file [m].
    workers, progress : As for `rotorsim.tabulate`.
    """
    rotors = _Rotors(places)
    analyses = [
        MachineAnalysis(one, rotors(one.machine), model, speeds, no_sweep) for one in variants
    ]
    wanted = [float(speed) for speed in speeds]
    if not solve_films_together(
        analyses, wanted, partial(sweep_points, workers=workers, progress=progress)
    ):
        return map_on_processes(_SolvedVariant(model, tuple(speeds), rotors), variants, workers)
    return [one.result() for one in analyses]


@dataclass
class _Rotors:
    """Rotors with nodes at some places, each built once."""

    places: Sequence[float]
    last: tuple[object, Rotor] | None = None

    def __call__(self, machine: MachineFile) -> Rotor:
        if self.last is None or self.last[0] is not machine.rotor:
            self.last = machine.rotor, machine.rotor_with_unbalance(more=self.places)
        return self.last[1]


@dataclass(frozen=True)
class _SolvedVariant:
    """One variant whose films depend on each other, or on the speed's load."""

    model: str
    speeds: tuple[float, ...]
    rotors: _Rotors

    def __call__(self, variant: Variant) -> MachineResult:
        def sweep(cases: list[Case], speeds: list[float]) -> list[OperatingPoint]:
            return sweep_points(cases, speeds, workers=1)

        rotor = self.rotors(variant.machine)
        return MachineAnalysis(variant, rotor, self.model, self.speeds, sweep).result()


@dataclass(frozen=True, eq=False)
class _Job:
    """A map's axes, and how its films are solved.

    axes, nodes : Parameters, and their values as given.
    """

    base: Variant
    axes: list[Parameter]
    nodes: list[Array]
    held: Mapping[Parameter, float]
    cells: int
    workers: int
    progress: Progress | None

    @property
    def along(self) -> list[Array]:
        """Values of the map along both axes."""
        if not self.cells:
            return self.nodes
        return [np.linspace(one[0], one[-1], max(self.cells, 2)) for one in self.nodes]

    @property
    def speed_axis(self) -> int | None:
        """Number of the axis that is the speed."""
        kinds = [one.kind for one in self.axes]
        return kinds.index("speed") if "speed" in kinds else None

    @property
    def speed(self) -> float:
        """That is held [rad/s]."""
        wanted = [value for one, value in self.held.items() if one.kind == "speed"]
        return wanted[0] if wanted else max(self.base.machine.operating.speeds)

    @property
    def film_nodes(self) -> list[Array]:
        """Values along each axis at which films are solved; one where they do not depend on it."""
        return [
            nodes if one.films else nodes[:1]
            for one, nodes in zip(self.axes, self.nodes, strict=True)
        ]

    def variant(self, x: float, y: float) -> Variant:
        """Return the machine at a place of the map."""
        return self.axes[1].applied(self.axes[0].applied(self.base, x), y)

    def result(self, model: str) -> tuple[Array, Array, float, list[OperatingPoint]]:
        """Return growth rate and frequency (n_x, n_y), interpolation error, and the films."""
        own = np.array(self.base.machine.operating.speeds)
        speeds = [self.speed]
        if self.speed_axis is not None:
            speeds = solved_speeds(own, self.nodes[self.speed_axis])
        xs, ys = self.film_nodes
        places = [at for one in self.axes for at in one.places]
        places += list(self.base.cross_stiffness)
        results = _solve_variants(
            [self.variant(x, y) for x in xs for y in ys], model, speeds, places, self.workers,
            self.progress,
        )  # fmt: skip
        films = _Films(results, (xs.size, ys.size), np.array(speeds))
        along = self.along
        rows = _Rows(self, model, films.at(self, self.film_nodes, along), _Rotors(places), along)
        found = np.array(map_on_processes(rows, range(along[0].size), self.workers))
        error = self._interpolation_error(model, films, places)
        points = {id(p): p for one in results for state in one.supports for p in state.points}
        return found[..., 0], found[..., 1], error, list(points.values())

    def _interpolation_error(self, model: str, films: _Films, places: Sequence[float]) -> float:
        """Return largest change of the growth rate at values that are left out; NaN: not known."""
        changes = [math.nan]
        for axis, nodes in enumerate(self.film_nodes):
            if nodes.size < 5:
                continue
            kept = np.union1d(np.arange(0, nodes.size, 2), [nodes.size - 1])
            left = np.setdiff1d(np.arange(nodes.size), kept)
            other = self.nodes[1 - axis]
            chosen = np.unique(np.linspace(0, other.size - 1, _CHECKED).round().astype(int))
            along = [nodes[left], nodes[left]]
            along[1 - axis] = other[chosen]
            rates = []
            for which in (np.arange(nodes.size), kept):
                known = list(self.film_nodes)
                known[axis] = nodes[which]
                grid = films.at(self, known, along, (axis, which))
                rows = _Rows(self, model, grid, _Rotors(places), along)
                rates.append(np.array([rows(i) for i in range(along[0].size)])[..., 0])
            changes.append(float(np.nanmax(np.abs(rates[1] - rates[0]), initial=0.0)))
        return float(np.nanmax(changes)) if len(changes) > 1 else math.nan

    def plane(self, found: Mapping[str, tuple[Array, Array, float, list[OperatingPoint]]]) -> Plane:
        """Return results of all thermal models as one dataset."""
        import xarray as xr

        dims = [re.sub(r"\W+", "_", one.name) for one in self.axes]
        growth = np.array([one[0] for one in found.values()])
        verdict = np.select(
            [~np.isfinite(growth), growth < 0.0, growth > 0.0], [-1, 1, 0], 2
        ).astype(np.int8)
        over = ("thermal_model", *dims)
        dataset = xr.Dataset(
            {
                "growth_rate": (over, growth, {
                    "units": "s-1", "long_name": "growth rate of the least stable mode",
                    "interpolation_error": [one[2] for one in found.values()],
                }),
                "damped_frequency": (over, np.array([one[1] for one in found.values()]), {
                    "units": "rad s-1", "long_name": "damped frequency of the least stable mode",
                }),
                "verdict": (over, verdict, {
                    "units": "1", "flag_values": np.array([-1, 0, 1, 2], dtype=np.int8),
                    "flag_meanings": "unknown unstable stable undamped",
                }),
            },
            coords={"thermal_model": list(found)},
            attrs={"title": self.base.machine.title, "machine": self.base.machine.text},
        )  # fmt: skip
        for dim, one, values in zip(dims, self.axes, self.along, strict=True):
            dataset[dim] = (dim, values, {"parameter": one.name, "long_name": one.name})
        models = list(found)
        if {"isothermal", "thd"} <= set(models):
            cold, hot = (verdict[models.index(name)] for name in ("isothermal", "thd"))
            only = ((cold == 1) & (hot == 0)).astype(np.int8)
            dataset["destabilised_by_heating"] = (
                tuple(dims), only,
                {"long_name": "stable if heating is neglected, unstable with it", "units": "1"},
            )  # fmt: skip
        points = [point for one in found.values() for point in one[3]]
        held = {one.name: value for one, value in self.held.items()}
        if self.speed_axis is None:
            held["speed"] = self.speed
        failed = sum(not point.converged for point in points)
        return Plane(dims[0], dims[1], held, dataset, len(points), failed)


_Grid = list[tuple[tuple[str, ...], int, Array] | None]
"""Of each support that is a film: unknowns, how many are coupled, matrices (n_x, n_y, 3, m, m)."""


@dataclass(frozen=True, eq=False)
class _Films:
    """Films at the nodes of a map, and their matrices between.

    results : Over the nodes along x, then y.
    shape : (int, int)
    speeds : (n,) array
    """

    results: Sequence[MachineResult]
    shape: tuple[int, int]
    speeds: Array

    def at(
        self, job: _Job, nodes: Sequence[Array], along: Sequence[Array],
        kept: tuple[int, Indices] | None = None,
    ) -> tuple[_Grid, tuple[SupportState, ...]]:  # fmt: skip
        """Return matrices over the values `along`, from those at `nodes`, and the supports' loads.

        `kept`: an axis and the nodes along it that are used.
        """
        index = np.arange(len(self.results)).reshape(self.shape)
        if kept is not None:
            index = index.take(kept[1], axis=kept[0])
        wanted = np.array([job.speed]) if job.speed_axis is None else along[job.speed_axis]
        grid: _Grid = []
        for place, state in enumerate(self.results[0].supports):
            if not state.points:
                grid.append(None)
                continue
            states = [self.results[int(k)].supports[place] for k in index.ravel()]
            unknowns, coupled, values = _matrices(self.speeds, states, wanted)
            values = values.reshape(*index.shape, *values.shape[1:])
            # The speeds take the place of the axis that is theirs, which has one node.
            if job.speed_axis is None:
                values = values[:, :, 0]
            else:
                values = np.moveaxis(values, 2, job.speed_axis).squeeze(job.speed_axis + 1)
            for axis in (0, 1):
                if job.axes[axis].films:
                    values = _between(nodes[axis], values, along[axis], axis)
            shape = (along[0].size, along[1].size, *values.shape[2:])
            grid.append((unknowns, coupled, np.broadcast_to(values, shape)))
        loads = tuple(SupportState(one.name, one.load[-1:]) for one in self.results[0].supports)
        return grid, loads


def _matrices(
    speeds: Array, states: Sequence[SupportState], wanted: Array
) -> tuple[tuple[str, ...], int, Array]:
    """Return a film's K, C, M (n_state, n_speed, 3, m, m) at wanted speeds; NaN: not known."""
    supports = [film_support(speeds, state) for state in states]
    if len({one.unknowns for one in supports}) > 1:
        # Pads that carry load here and none there: all of them reduced at the shaft's frequency.
        supports = [film_support(speeds, state, full=False) for state in states]
    first = supports[0]
    size = len(first.unknowns)
    values = np.full((len(states), wanted.size, 3, size, size), np.nan)
    for k, one in enumerate(supports):
        for part, matrix in enumerate(one.matrices(wanted)):
            values[k, :, part] = matrix
    return first.unknowns, first.coupled, values


def _between(nodes: Array, values: Array, wanted: Array, axis: int) -> Array:
    """Return the monotone cubic between nodes along an axis; NaN where a neighbour is not known."""
    from scipy.interpolate import PchipInterpolator

    moved = np.moveaxis(values, axis, 0)
    result = np.full((wanted.size, *moved.shape[1:]), np.nan)
    for line in range(moved.shape[1]):
        known = np.isfinite(moved[:, line]).all(axis=(1, 2, 3))
        edges = np.flatnonzero(np.diff(np.concatenate([[0], known.astype(int), [0]])))
        for start, stop in edges.reshape(-1, 2):
            inside = (wanted >= nodes[start]) & (wanted <= nodes[stop - 1])
            if stop - start > 1:
                curve = PchipInterpolator(nodes[start:stop], moved[start:stop, line], axis=0)
                result[inside, line] = curve(wanted[inside])
            else:
                result[inside, line] = moved[start, line]
    return np.moveaxis(result, 0, axis)


@dataclass(frozen=True, eq=False)
class _Rows:
    """Growth rate and frequency of the least stable mode along y, for each x."""

    job: _Job
    model: str
    films: tuple[_Grid, tuple[SupportState, ...]]
    rotors: _Rotors
    along: Sequence[Array]

    def __call__(self, i: int) -> list[tuple[float, float]]:
        return [self._cell(i, j) for j in range(self.along[1].size)]

    def __getstate__(self) -> dict[str, Any]:
        return vars(self) | {"job": replace(self.job, progress=None)}

    @on_one_blas_thread
    def _cell(self, i: int, j: int) -> tuple[float, float]:
        place, (grid, states) = (self.along[0][i], self.along[1][j]), self.films
        axis = self.job.speed_axis
        speed = self.job.speed if axis is None else float(place[axis])
        variant = self.job.variant(*place)
        films: dict[str, Support] = {}
        for state, one in zip(states, grid, strict=True):
            if one is None:
                continue
            unknowns, coupled, values = one
            matrices = values[i, j]
            if not np.isfinite(matrices).all():
                return math.nan, math.nan
            films[state.name] = MatrixTable(
                np.array([speed]), *matrices[:, None], unknowns=unknowns, coupled=coupled
            )
        analysis = MachineAnalysis(
            variant, self.rotors(variant.machine), self.model, [speed], no_sweep
        )
        machine = analysis.assembled(states, films)
        found = machine_spectrum(machine, np.array([speed]))(speed)
        if found is None:
            return math.nan, math.nan
        return found.leading.real, abs(found.leading.imag)
