"""A machine over its speeds: static loads, each bearing at its own, modes, thresholds, verdict."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array
from ..bearing.interpolation import CoefficientInterpolator
from ..bearing.operating_point import OperatingPoint
from ..errors import InputError
from ..files.machine import MachineFile
from ..files.parameters import Variant
from ..files.scenario import Scenario
from ..film.geometry import rotation
from ..machine.branches import Modes, Verdict
from ..machine.machine import Machine, Mount
from ..machine.matrices import static_following
from ..machine.modes import known_speeds, machine_spectrum, modes
from ..machine.peaks import node_at
from ..machine.response import UnbalanceResponse, unbalance_response
from ..machine.statics import Law, StaticEquilibrium, static_equilibrium, weight
from ..machine.support import (
    ConstantSupport,
    MatrixTable,
    Pedestal,
    Support,
    TableSupport,
    Turned,
    cross_stiffness,
)
from ..machine.thresholds import (
    CriticalSpeed,
    ThresholdSpeed,
    critical_speeds,
    find_thresholds,
    subdivided,
)
from ..model import Case, LoadTarget, ThermalModel
from ..model.machine import Matrix, SealEntry, SupportEntry
from ..rotor import Rotor
from .planes import changed
from .rings import centred_damping, ring_law, ring_support
from .sweep import Progress, sweep_points

_GIVEN = "given"
"""Name of the thermal model of a machine without films."""
_MESH_MODES = 8
"""Modes whose change on twice the mesh is stated."""
_RIGID = 1e-13
"""Of the largest squared frequency: below, a free shaft's motion without bending."""
_INTERVALS = 60
"""Of speed, at least, at whose ends thresholds are looked for."""


@dataclass(frozen=True, eq=False)
class SupportState:
    """A support over the speeds.

    load : (n, 2) array. Static load along x and y of the machine [N]; NaN where it was not asked
        for.
    points : Of a film, one for each speed; empty for others.
    """

    name: str
    load: Array
    points: tuple[OperatingPoint, ...] = ()

    @property
    def direction(self) -> Array:
        """Angle of the load from x in the direction of rotation, (n,) [rad]."""
        return np.arctan2(self.load[:, 1], self.load[:, 0])


@dataclass(frozen=True, eq=False)
class MachineResult:
    """A machine with one thermal model of its films.

    thermal_model : ``isothermal``, ``thd``, or ``given`` without films.
    speeds : (n,) array [rad/s]
    statics : One for each speed; empty where no support needs the static load.
    """

    description: MachineFile
    thermal_model: str
    speeds: Array
    machine: Machine
    supports: tuple[SupportState, ...]
    statics: tuple[StaticEquilibrium, ...] = ()

    def __repr__(self) -> str:
        return (
            f"<MachineResult: {self.description.title}; {self.thermal_model}, "
            f"{self.speeds.size} speeds, {'converged' if self.converged else 'not all converged'}>"
        )

    @property
    def converged(self) -> bool:
        """Return whether every film and every static equilibrium did."""
        points = [point for support in self.supports for point in support.points]
        return all(p.converged for p in points) and all(one.converged for one in self.statics)

    @cached_property
    def known(self) -> Array:
        """Longest run of the speeds [rad/s] at which all supports have coefficients."""
        return known_speeds(self.machine) if self.machine.speeds.size else self.speeds

    @cached_property
    def modes(self) -> Modes | None:
        """Branches over the known speeds; None without any."""
        return modes(self.machine, self.known) if self.known.size else None

    @cached_property
    def critical_speeds(self) -> list[CriticalSpeed]:
        """Synchronous crossings of the damped natural frequencies."""
        return [] if self.modes is None else critical_speeds(self.machine, self.modes)

    @cached_property
    def thresholds(self) -> list[ThresholdSpeed]:
        """Speeds at which the verdict changes."""
        if self.known.size < 2:
            return []
        grid = subdivided(self.known, math.ceil(_INTERVALS / (self.known.size - 1)))
        return find_thresholds(machine_spectrum(self.machine, self.known), grid)

    @property
    def verdict(self) -> Verdict | None:
        """At the highest known speed."""
        return None if self.modes is None else self.modes.verdicts[-1]

    @cached_property
    def mesh_change(self) -> tuple[tuple[float, float], ...]:
        """Damped frequency [rad/s] of each mode, and its relative change on twice the mesh.

        Of the lowest eight that oscillate, at the highest known speed.
        """
        if self.modes is None:
            return ()
        fine = self.description.rotor_with_unbalance(2)
        nodes = self.machine.rotor.nodes
        mounts = [
            Mount(node_at(fine, nodes[int(mount.node)].position), mount.support, mount.name)
            for mount in self.machine.mounts
        ]
        top = float(self.known[-1])
        here = modes(self.machine, top).oscillating().eigenvalues[0]
        finer = modes(Machine(fine, mounts), top).oscillating().eigenvalues[0]
        wanted = np.sort_complex(1j * here.imag)[:_MESH_MODES].imag
        found = []
        for frequency in wanted:
            value = here[np.abs(here.imag - frequency).argmin()]
            apart = float(np.abs(finer - value).min() / abs(value))
            found.append((float(frequency), apart))
        return tuple(found)

    @cached_property
    def unbalance_response(self) -> UnbalanceResponse | None:
        """Over the known speeds; None without unbalance or coefficients."""
        if not (np.any(self.machine.rotor.unbalance) and self.known.size):
            return None
        return unbalance_response(self.machine, self.known)


@dataclass(frozen=True, eq=False)
class _HeatedMode:
    """A mode that heating makes unstable at the highest speed.

    frequency : Damped, with heating [rad/s].
    isothermal_growth_rate, growth_rate : Without and with heating [1/s].
    """

    frequency: float
    isothermal_growth_rate: float
    growth_rate: float


def destabilised_by_heating(cold: MachineResult, hot: MachineResult) -> list[_HeatedMode]:
    """Return modes that grow with heating at the highest common speed and do not without.

    A mode's isothermal counterpart is the one of nearest shape (MAC) and frequency.
    """
    if cold.modes is None or hot.modes is None:
        return []
    common = np.intersect1d(cold.known, hot.known)
    if not common.size:
        return []
    top = float(common[-1])
    one, other = modes(cold.machine, top).oscillating(), modes(hot.machine, top).oscillating()
    found = []
    for k in range(other.eigenvalues.shape[1]):
        if other.undamped[0, k] or other.growth_rate[0, k] <= 0.0:
            continue
        size = one.shapes.shape[2]
        mac = np.abs(one.shapes[0].conj() @ other.shapes[0, k, :size]) ** 2
        apart = np.abs(one.eigenvalues[0].imag - other.eigenvalues[0, k].imag)
        twin = int(np.argmin(apart / abs(other.eigenvalues[0, k]) + 1.0 - mac))
        before = float(one.growth_rate[0, twin])
        if before <= 0.0 or one.undamped[0, twin]:
            after = float(other.growth_rate[0, k])
            found.append(_HeatedMode(float(other.damped_frequency[0, k]), before, after))
    return found


def pinned_mesh_change(description: MachineFile) -> float:
    """Return largest relative change on twice the mesh of the lowest natural frequencies at rest.

    The shaft is held where its supports stand: before any film is solved.
    """
    from scipy.linalg import eigh

    lowest = []
    for refinement in (1, 2):
        rotor = description.rotor_with_unbalance(refinement)
        held = [k for one in description.support for k in rotor.planes[node_at(rotor, one.at)]]
        stiffness, mass = (
            np.delete(np.delete(matrix, held, axis=0), held, axis=1)
            for matrix in (rotor.stiffness, rotor.mass)
        )
        idle = np.logical_not(mass.any(axis=0))  # of a shaft without density
        stiffness = stiffness[~idle] @ static_following(stiffness, idle)
        squares: Any = eigh(stiffness, mass[~idle][:, ~idle], eigvals_only=True)
        elastic = squares[squares > _RIGID * squares.max(initial=0.0)]
        lowest.append(np.sqrt(elastic[:_MESH_MODES]))
    count = min(map(len, lowest))
    return float(np.abs(lowest[1][:count] / lowest[0][:count] - 1.0).max(initial=0.0))


def free_motions(description: MachineFile) -> int:
    """Return rigid motions of the shaft, of 4 (two displacements, two tilts).

    That no stiffness resists.

    Films and tables count as stiff in both directions.
    """
    held = [np.zeros((1, 4))]
    for entry in description.support:
        own = np.eye(2) if entry.stiffness is None else np.array(entry.stiffness)
        for stand in (entry.pedestal, entry.damper):
            if stand is not None and not np.any(stand.stiffness):
                own = np.zeros((2, 2))
        size = float(np.abs(own).max())
        z = entry.at / description.rotor.beam.length
        held.append(np.hstack([own, z * own]) / (size or 1.0))
    return 4 - int(np.linalg.matrix_rank(np.vstack(held), tol=1e-9))


def analyse_machine(
    description: MachineFile,
    models: Sequence[str] | None = None,
    *,
    workers: int | None = None,
    progress: Progress | None = None,
) -> dict[str, MachineResult]:
    """Solve a machine over its speeds with each thermal model of its bearings.

    Parameters
    ----------
    description : MachineFile
    models : sequence of str, optional
        Thermal models; by default those of the bearings' files.
    workers : int, optional
        Processes for the films; see `rotorsim.tabulate`.
    progress : callable, optional
        Called after each film point with points done, points in all, and the point.

    Returns
    -------
    dict of str to MachineResult
        By thermal model, ``isothermal`` first.

    Raises
    ------
    InputError
        The rotor needs static loads and has no two supports that carry them, or a support that
        carries load has no stiffness.
    """
    known = thermal_models(description)
    ordered = list(models or known)
    for name in ordered:
        if name not in known:
            raise InputError(f"must be one of {', '.join(known)}", key="thermal_model", value=name)
    rotor, speeds = description.rotor_with_unbalance(), list(description.operating.speeds)
    total = len(ordered) * len(description.bearings) * len(description.operating.speeds)
    done = 0

    def counted(_done: int, _total: int, point: OperatingPoint) -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, total, point)

    def sweep(cases: list[Case], speeds: list[float]) -> list[OperatingPoint]:
        nonlocal total
        total = len(cases) * len(speeds)
        return sweep_points(cases, speeds, workers=workers, progress=counted)

    variant = Variant(description)
    analyses = [MachineAnalysis(variant, rotor, name, speeds, sweep, counted) for name in ordered]
    solve_films_together(analyses, speeds, sweep)
    return {one.model: one.result() for one in analyses}


_Sweep = Callable[[list[Case], list[float]], list[OperatingPoint]]


def solve_films_together(
    analyses: Sequence[MachineAnalysis], speeds: list[float], sweep: _Sweep
) -> bool:
    """Solve the films of several analyses at once, equal ones once, and give them their points.

    False: the films of one depend on the speed's load or on each other; nothing was done.
    """
    wanted = [one.film_cases() for one in analyses]
    if any(cases is None for cases in wanted):
        return False
    every = list(dict.fromkeys(case for cases in wanted for case in cases or ()))
    found = sweep(every, speeds)
    points = {case: found[k * len(speeds) : (k + 1) * len(speeds)] for k, case in enumerate(every)}
    for one in analyses:
        one.sweep = lambda cases, _speeds: [point for case in cases for point in points[case]]
    return True


def thermal_models(description: MachineFile) -> list[str]:
    """Return thermal models of a machine's bearings, ``isothermal`` first.

    ``given`` without films.
    """
    names = {str(model) for one in description.bearings.values() for model in one.thermal_models}
    return [str(model) for model in ThermalModel if str(model) in names] or [_GIVEN]


class MachineAnalysis:
    """A machine, or a variant of it, with one thermal model.

    model : Thermal model.
    speeds : [rad/s]
    sweep : Operating points of cases at the speeds, case by case.
    progress : Called after each film that is solved otherwise.
    """

    def __init__(
        self, variant: Variant, rotor: Rotor, model: str, speeds: Sequence[float],
        sweep: _Sweep,
        progress: Progress = lambda *_: None,
    ) -> None:  # fmt: skip
        self.variant: Variant = variant
        self.rotor: Rotor = rotor
        self.model: str = model
        self.sweep: _Sweep = sweep
        self.progress: Progress = progress
        self.description: MachineFile = variant.machine
        self.speeds: Array = np.array(speeds)
        self.nodes: list[int] = [node_at(rotor, entry.at) for entry in self.description.support]

    def result(self) -> MachineResult:
        """Return statics, films, supports."""
        names = self.description.support_names
        loads, points, statics = self._loads_and_points()
        states = tuple(
            SupportState(name, loads[:, i], points.get(name, ())) for i, name in enumerate(names)
        )
        machine = self.assembled(states)
        return MachineResult(
            self.description, self.model, self.speeds, machine, states, tuple(statics)
        )

    def assembled(
        self, states: Sequence[SupportState], films: Mapping[str, Support] | None = None
    ) -> Machine:
        """Return the rotor on its supports; `films` stand in for those of the points, by name."""
        names = self.description.support_names
        mounts = [
            Mount(node, self._support(entry, state, (films or {}).get(name)), name)
            for node, entry, state, name in zip(
                self.nodes, self.description.support, states, names, strict=True
            )
        ]
        mounts += [
            *seal_mounts(self.description, self.rotor),
            *(
                Mount(node_at(self.rotor, at), cross_stiffness(q), f"Q at {at * 1e3:g} mm")
                for at, q in self.variant.cross_stiffness.items()
            ),
        ]
        return Machine(self.rotor, mounts)

    def _force(self, speed: float) -> Array:
        return static_force(self.description, self.rotor, speed)

    def _loads_and_points(
        self,
    ) -> tuple[Array, dict[str, tuple[OperatingPoint, ...]], list[StaticEquilibrium]]:
        """Return static loads (n_speed, n_supports, 2), the films' points, and the equilibria."""
        description, count = self.description, len(self.nodes)
        loads = np.full((self.speeds.size, count, 2), np.nan)
        placed = any(entry.coefficients or entry.ring for entry in description.support)
        if not (description.bearings or placed):
            return loads, {}, []
        if count == 2:
            return self._determinate()
        return self._indeterminate(loads)

    def determinate_loads(self) -> Array:
        """Return the static loads of two supports, (n, 2, 2) [N]."""
        loads = np.empty((self.speeds.size, 2, 2))
        raised, unmoved = self._elevations(), _displaced(np.zeros(2))
        for k, speed in enumerate(self.speeds):
            force, laws = self._force(float(speed)), [unmoved, unmoved]
            loads[k] = static_equilibrium(self.rotor, force, self.nodes, laws, raised).reactions
        self._replace_loads(loads)
        return loads

    def film_cases(self) -> list[Case] | None:
        """Return films that `result` will ask its sweep for.

        None where they depend on speed or films.
        """
        if not self.description.bearings:
            return []
        if len(self.nodes) != 2:
            return None
        loads = self.determinate_loads()
        return self._cases(loads[0]) if _alike(loads) else None

    def _cases(self, loads: Array) -> list[Case]:
        names = self.description.support_names
        return [
            self.case(i, self.description.bearings[name], loads[i])
            for i, name in enumerate(names)
            if name in self.description.bearings
        ]

    def _determinate(
        self,
    ) -> tuple[Array, dict[str, tuple[OperatingPoint, ...]], list[StaticEquilibrium]]:
        """Find two supports' loads from statics, then sweep each film on its own."""
        raised, loads = self._elevations(), self.determinate_loads()
        points: dict[str, tuple[OperatingPoint, ...]] = {}
        films = [
            (i, name, self.description.bearings[name])
            for i, name in enumerate(self.description.support_names)
            if name in self.description.bearings
        ]
        if _alike(loads):
            found = self.sweep(self._cases(loads[0]), self.speeds.tolist())
            size = self.speeds.size
            for k, (_, name, _) in enumerate(films):
                points[name] = tuple(found[k * size : (k + 1) * size])
        else:
            for i, name, scenario in films:
                film = _Film(lambda load, i=i, s=scenario: self.case(i, s, load), self.progress)
                points[name] = tuple(
                    film.point(load, float(speed))
                    for speed, load in zip(self.speeds, loads[:, i], strict=True)
                )
        statics = []
        for k, speed in enumerate(self.speeds):
            journals = [self._journal(i, k, loads, points) for i in (0, 1)]
            laws = [_displaced(journal) for journal in journals]
            statics.append(
                static_equilibrium(self.rotor, self._force(float(speed)), self.nodes, laws, raised)
            )
        return loads, points, statics

    def _journal(
        self, i: int, k: int, loads: Array, points: dict[str, tuple[OperatingPoint, ...]]
    ) -> Array:
        """Return displacement of a journal in its housing at speed k [m].

        0 where it is not known.
        """
        film = points.get(self.description.support_names[i])
        if film is not None:
            return _journal_of(film[k], loads[k, i]) if film[k].converged else np.zeros(2)
        try:
            return self._spring(i, float(self.speeds[k]))(loads[k, i])[0]
        except InputError:
            return np.zeros(2)

    def _indeterminate(
        self, loads: Array
    ) -> tuple[Array, dict[str, tuple[OperatingPoint, ...]], list[StaticEquilibrium]]:
        """Solve rotor and films of more than two supports together, one speed after the other."""
        names, raised = self.description.support_names, self._elevations()
        films: dict[int, _Film] = {}
        for i, name in enumerate(names):
            if name in self.description.bearings:
                scenario = self.description.bearings[name]
                films[i] = _Film(
                    lambda load, i=i, s=scenario: self.case(i, s, load), lambda *_: None
                )
        points: dict[str, list[OperatingPoint]] = {names[i]: [] for i in films}
        statics: list[StaticEquilibrium] = []
        start = None
        for k, speed in enumerate(self.speeds):
            laws = [
                films[i].law(float(speed)) if i in films else self._spring(i, float(speed))
                for i in range(len(names))
            ]
            one = static_equilibrium(
                self.rotor, self._force(speed), self.nodes, laws, raised, start
            )
            start = one.reactions
            statics.append(one)
            loads[k] = one.reactions
            for i, film in films.items():
                point = film.point(one.reactions[i], float(speed))
                points[names[i]].append(point)
                self.progress(0, 0, point)
        return loads, {name: tuple(found) for name, found in points.items()}, statics

    def _replace_loads(self, loads: Array) -> None:
        """Give the static loads the magnitudes that the variant asks for."""
        for i, name in enumerate(self.description.support_names):
            wanted = self.variant.films.get(name, {}).get("applied_load")
            if wanted is not None:
                size = np.hypot(*loads[:, i].T)
                if not size.all():
                    raise InputError("has no static load whose direction to keep", key=name)
                loads[:, i] *= wanted / size[:, None]

    def _elevations(self) -> Array:
        """Return displacements of the housings along x and y [m]; upwards is -x."""
        return np.array([(-entry.elevation, 0.0) for entry in self.description.support])

    def case(self, i: int, scenario: Scenario, load: Array) -> Case:
        """Return the film of support i under its load [N], in the load's frame."""
        wanted = {str(model) for model in scenario.thermal_models}
        model = self.model if self.model in wanted else str(scenario.thermal_models[0])
        case = scenario.case(thermal_model=model)
        name = self.description.support_names[i]
        changes = dict(self.variant.films.get(name, {}))
        changes.pop("applied_load", None)
        case = changed(case, changes)
        # Loads that differ by rounding alone are those of one film.
        turn = scenario.housing_turn + self.description.support[i].angle
        turn = round(turn - math.atan2(load[1], load[0]), 10)
        size = float(f"{np.hypot(*load):.10g}")
        return replace(case, bearing=case.bearing.turned(turn), target=LoadTarget(size))

    def _spring(self, i: int, speed: float) -> Law:
        """Return the law of a support that is no film: a spring at the static load."""
        entry = self.description.support[i]
        if entry.ring is not None:
            return ring_law(entry.ring, speed)
        if entry.stiffness is not None:
            own = np.array(entry.stiffness)
        else:
            table = self.description.tables[self.description.support_names[i]]
            own = table.interpolator()(speed, gaps="nan")[0]
        turn = rotation(entry.angle)
        matrix = turn @ own @ turn.T
        if not np.all(np.isfinite(matrix)) or np.linalg.cond(matrix) > 1e12:
            raise InputError(
                "is singular: with more than two supports each needs stiffness along x and y to "
                "share the static load", key=f"support[{i}].stiffness", value=own.tolist(),
            )  # fmt: skip
        softness = np.asarray(np.linalg.inv(matrix), dtype=float)
        return lambda load: (np.asarray(softness @ load, dtype=float), softness)

    def _support(self, entry: SupportEntry, state: SupportState, film: Support | None) -> Support:
        """Return the support in the machine's frame, pedestal included."""
        support: Support
        if entry.bearing is not None:
            support = film or film_support(self.speeds, state)
        elif entry.coefficients is not None:
            direction = state.direction[0] if np.all(np.isfinite(state.load)) else 0.0
            table = TableSupport(self.description.tables[state.name].interpolator())
            support = Turned(table, float(direction) + entry.angle)
        elif entry.ring is not None:
            support = ring_support(entry.ring, self.speeds, state.load)
        else:
            return fixed_support(entry)
        return _on_its_stand(entry, support)


def fixed_support(entry: SupportEntry) -> Support:
    """Return support of constant stiffness in the machine's frame, pedestal or damper included."""
    support: Support = ConstantSupport(
        _matrix(entry.stiffness), _matrix(entry.damping), _matrix(entry.mass)
    )
    return _on_its_stand(entry, Turned(support, entry.angle) if entry.angle else support)


def _on_its_stand(entry: SupportEntry, support: Support) -> Support:
    """Put a bearing in its pedestal, or in its damper: small motions about the centre."""
    if entry.pedestal is not None:
        stand = entry.pedestal
        return Pedestal(support, stand.mass, stand.stiffness, stand.damping)
    if entry.damper is not None:
        damper = entry.damper
        damping = centred_damping(damper) * np.eye(2) + _matrix(damper.damping)
        return Pedestal(support, damper.mass, _matrix(damper.stiffness), damping)
    return support


def film_cases(result: MachineResult) -> Callable[[int, int], Case]:
    """Return the film of support i at its load at speed number k, as a function of both."""

    def no_sweep(_cases: list[Case], _speeds: list[float]) -> list[OperatingPoint]:
        return []

    analysis = MachineAnalysis(
        Variant(result.description), result.machine.rotor, result.thermal_model,
        result.speeds.tolist(),
        no_sweep,
    )  # fmt: skip

    def case(i: int, k: int) -> Case:
        state = result.supports[i]
        return analysis.case(i, result.description.bearings[state.name], state.load[k])

    return case


def points_with_fields(
    result: MachineResult, places: Sequence[int]
) -> dict[str, list[OperatingPoint]]:
    """Return converged films of a result, solved again with their fields, by the support's name.

    places : Which of the speeds, ascending.
    """
    from ..bearing.solve import solve_case

    case_of = film_cases(result)
    found: dict[str, list[OperatingPoint]] = {}
    for i, state in enumerate(result.supports):
        warm = None
        for k in places if state.points else ():
            case, speed = case_of(i, k), float(result.speeds[k])
            point, warm = solve_case(case, speed, initial=warm, keep_fields=True)
            warm = warm if point.converged else None
            if point.converged:
                found.setdefault(state.name, []).append(point)
    return found


def _alike(loads: Array) -> bool:
    """Return whether the static loads are the same at all speeds."""
    return bool(np.allclose(loads, loads[0], rtol=1e-12, atol=0.0))


class _Film:
    """A film under any load, each solution the first guess of the next."""

    def __init__(self, case: Callable[[Array], Case], progress: Progress) -> None:
        self.case, self.progress = case, progress
        self.warm: Any = None

    def point(self, load: Array, speed: float) -> OperatingPoint:
        """Return the operating point under a load [N]."""
        from ..bearing.solve import solve_case

        point, warm = solve_case(self.case(load), speed, initial=self.warm)
        self.warm = warm if point.converged else None
        self.progress(0, 0, point)
        return point

    def law(self, speed: float) -> Law:
        """Return the load to the journal's displacement and its derivative, machine frame."""

        def displacement(load: Array) -> tuple[Array, Array]:
            point = self.point(load, speed)
            if not point.converged:
                return np.full(2, np.nan), np.full((2, 2), np.nan)
            turn = rotation(math.atan2(load[1], load[0]))
            return _journal_of(point, load), turn @ np.linalg.inv(point.stiffness) @ turn.T

        return displacement


def _journal_of(point: OperatingPoint, load: Array) -> Array:
    """Return the displacement of the journal under a load [N] in the machine's frame [m]."""
    angle, size = point.attitude_angle, point.eccentricity_ratio * point.running_clearance
    place = size * np.array([math.cos(angle), math.sin(angle)])
    return np.asarray(rotation(math.atan2(load[1], load[0])) @ place, dtype=float)


def _displaced(journal: Array) -> Law:
    """Return the law of a support in which the journal stands at a known place."""
    return lambda _load: (journal, np.zeros((2, 2)))


def film_support(speeds: Array, state: SupportState, full: bool = True) -> Support:
    """Return coefficients of a film's points over speed, turned to the machine's frame.

    Without `full` those of pads are reduced at the shaft's frequency.
    """
    converged = np.array([point.converged for point in state.points])
    if full and converged.all() and all(point.pads for point in state.points):
        return MatrixTable.of_points(state.points, [float(angle) for angle in state.direction])
    columns = np.full((speeds.size, 9), np.nan)
    for k, (point, angle) in enumerate(zip(state.points, state.direction, strict=True)):
        if point.converged:
            turn = rotation(float(angle))
            columns[k, :4] = (turn @ point.stiffness @ turn.T).ravel()
            columns[k, 4:8] = (turn @ point.damping @ turn.T).ravel()
            columns[k, 8] = point.load
    return TableSupport(CoefficientInterpolator.from_columns(speeds, converged, columns))


def seal_mounts(description: MachineFile, rotor: Rotor) -> list[Mount]:
    """Return the seals at their nodes."""

    def support(entry: SealEntry, name: str) -> Support:
        if entry.coefficients is not None:
            return TableSupport(description.tables[name].interpolator(), carries_load=False)
        k, c, m = (_matrix(part) for part in (entry.stiffness, entry.damping, entry.mass))
        return ConstantSupport(k, c, m, carries_load=False)

    return [
        Mount(node_at(rotor, entry.at), support(entry, name), name)
        for entry, name in zip(description.seal, description.seal_names, strict=True)
    ]


def static_force(
    description: MachineFile, rotor: Rotor, speed: float, gravity: bool = True
) -> Array:
    """Return weight and static loads on the rotor's unknowns at a speed [N]."""
    force = np.zeros(rotor.size)
    if gravity and not description.operating.vertical:
        force += weight(rotor)
    for entry in description.load:
        rows = np.array(entry.force)
        for axis, place in enumerate(rotor.planes[node_at(rotor, entry.at)]):
            force[place] += np.interp(speed, rows[:, 0], rows[:, axis + 1])
    return force


def _matrix(given: Matrix | None) -> Array:
    return np.zeros((2, 2)) if given is None else np.array(given)


def _modes_at(found: Modes, index: int) -> list[dict[str, Any]]:
    """Return modes at one speed as plain data, ascending in undamped frequency.

    One of each conjugate pair, and the real eigenvalues, whose frequency is 0.
    """
    values = found.eigenvalues[index]
    keep = np.flatnonzero(values.imag >= 0.0)
    keep = keep[np.argsort(np.abs(values[keep]), kind="stable")]
    whirl, decrement = found.whirl, found.logarithmic_decrement
    return [
        {
            "growth_rate": float(values[k].real),
            "damped_frequency": abs(float(values[k].imag)),
            "undamped_frequency": float(abs(values[k])),
            "logarithmic_decrement": float(decrement[index, k]) if values[k].imag > 0.0 else None,
            "whirl": str(whirl[index, k]),
            "undamped": bool(found.undamped[index, k]),
        }
        for k in keep
    ]


def stability_document(results: dict[str, MachineResult]) -> dict[str, Any]:
    """Return the stability of a machine as plain data (SI): the last thermal model's in front.

    ``thermal_models`` has each model's own; ``destabilised_by_heating`` the modes that only heating
    makes unstable.
    """
    rows = {name: _stability(result) for name, result in results.items()}
    last = next(reversed(rows))
    document = {**rows[last], "thermal_model": last}
    if len(rows) > 1:
        document["thermal_models"] = rows
        cold, hot = next(iter(results.values())), results[last]
        document["destabilised_by_heating"] = [
            vars(mode) for mode in destabilised_by_heating(cold, hot)
        ]
    return document


def _stability(result: MachineResult) -> dict[str, Any]:
    found = result.modes
    return {
        "speeds": result.known.tolist(),
        "modes": [] if found is None else [_modes_at(found, i) for i in range(result.known.size)],
        "critical_speeds": [
            {"speed": one.speed, "whirl": one.whirl, "damping_ratio": one.damping_ratio}
            for one in result.critical_speeds
        ],
        "thresholds": [
            {
                "speed": one.speed,
                "whirl_frequency_ratio": one.whirl_frequency_ratio,
                "becomes_unstable": one.becomes_unstable,
            }
            for one in result.thresholds
        ],
        "verdict": None if result.verdict is None else str(result.verdict),
        "mesh": {
            "nodes": len(result.machine.rotor.nodes),
            "changes": [
                {"damped_frequency": frequency, "relative_change": change}
                for frequency, change in result.mesh_change
            ],
        },
    }


def supports_document(result: MachineResult) -> list[dict[str, Any]]:
    """Return supports of a machine as plain data (SI): load and film at each speed."""
    return [
        {
            "name": state.name,
            "speeds": result.speeds.tolist(),
            "load": _or_none(np.hypot(*state.load.T)),
            "load_direction": _or_none(state.direction),
            "eccentricity_ratio": [point.eccentricity_ratio for point in state.points],
            "max_temperature": [point.max_temperature for point in state.points],
            "status": [point.status.value for point in state.points],
        }
        for state in result.supports
    ]


def _or_none(values: Sequence[float] | Array) -> list[float | None]:
    return [float(value) if math.isfinite(value) else None for value in values]
