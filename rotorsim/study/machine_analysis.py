"""Solve a machine over its speeds: static loads, and each bearing's film at its own."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice
from typing import Any

import numpy as np

from ..arguments import refuse_no_machine
from ..arrays import Array
from ..bearing.operating_point import OperatingPoint
from ..errors import InputError
from ..files.machine import MachineFile
from ..files.parameters import Variant
from ..files.scenario import Scenario
from ..film.geometry import rotation
from ..machine.machine import Machine, Mount
from ..machine.peaks import node_at
from ..machine.statics import Law, StaticEquilibrium, static_equilibrium
from ..machine.support import Support, TableSupport, Turned, cross_stiffness
from ..model import Case, LoadTarget, ThermalModel
from ..model.supports import SupportEntry
from ..rotor import Rotor
from .changes import changed
from .machine import MachineResult
from .machine_supports import (
    SupportState,
    film_support,
    fixed_support,
    on_its_stand,
    seal_mounts,
    static_force,
)
from .rings import ring_law, ring_support
from .sweep import Progress, sweep_points

_GIVEN = "given"
"""Name of the thermal model of a machine without films."""


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
    refuse_no_machine(description)
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
_Points = dict[str, list[OperatingPoint]]
_Loaded = tuple[Array, _Points, list[StaticEquilibrium]]


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
    """Return thermal models of the bearings, ``isothermal`` first; ``given`` without films."""
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
        self.films: dict[str, int] = {
            name: i
            for i, name in enumerate(self.description.support_names)
            if name in self.description.bearings
        }
        """Places of the supports that are films, by name."""

    def result(self) -> MachineResult:
        """Return statics, films, supports."""
        names = self.description.support_names
        loads, points, statics = self._loads_and_points()
        states = tuple(
            SupportState(name, loads[:, i], tuple(points.get(name, ())))
            for i, name in enumerate(names)
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

    def _loads_and_points(self) -> _Loaded:
        """Return static loads (n_speed, n_supports, 2), the films' points, and the equilibria."""
        supports = self.description.support
        if not any(one.bearing or one.coefficients or one.ring for one in supports):
            return np.full((self.speeds.size, len(supports), 2), np.nan), {}, []
        return self._determinate() if len(supports) == 2 else self._indeterminate()

    def _equilibrium(
        self, speed: float, laws: Sequence[Law], start: Array | None = None
    ) -> StaticEquilibrium:
        raised = np.array([(-entry.elevation, 0.0) for entry in self.description.support])
        force = static_force(self.description, self.rotor, speed)
        return static_equilibrium(self.rotor, force, self.nodes, laws, raised, start)

    def determinate_loads(self) -> Array:
        """Return the static loads of two supports, (n, 2, 2) [N]."""
        laws = [_displaced(np.zeros(2))] * 2
        loads = np.array([self._equilibrium(one, laws).reactions for one in self.speeds.tolist()])
        self._replace_loads(loads)
        return loads

    def film_cases(self) -> list[Case] | None:
        """Return films that `result` asks its sweep for; None where they depend on each other."""
        if not self.films:
            return []
        if len(self.nodes) != 2:
            return None
        loads = self.determinate_loads()
        return self._cases(loads[0]) if _alike(loads) else None

    def _cases(self, loads: Array) -> list[Case]:
        return [self.case(i, loads[i]) for i in self.films.values()]

    def _determinate(self) -> _Loaded:
        """Find two supports' loads from statics, then sweep each film on its own."""
        loads = self.determinate_loads()
        speeds = self.speeds.tolist()
        points: _Points = {}
        if _alike(loads):
            found = iter(self.sweep(self._cases(loads[0]), speeds))
            points = {name: list(islice(found, len(speeds))) for name in self.films}
        else:
            for name, i in self.films.items():
                film = _Film(partial(self.case, i), self.progress)
                points[name] = list(map(film.point, loads[:, i], speeds))
        statics = [
            self._equilibrium(
                speed, [_displaced(self._journal(i, k, loads, points)) for i in (0, 1)]
            )
            for k, speed in enumerate(speeds)
        ]
        return loads, points, statics

    def _journal(self, i: int, k: int, loads: Array, points: _Points) -> Array:
        """Return the journal's displacement in its housing at speed k [m]; 0 where not known."""
        film = points.get(self.description.support_names[i])
        if film is not None:
            return _journal_of(film[k], loads[k, i]) if film[k].converged else np.zeros(2)
        try:
            return self._spring(i, float(self.speeds[k]))(loads[k, i])[0]
        except InputError:
            return np.zeros(2)

    def _indeterminate(self) -> _Loaded:
        """Solve rotor and films of more than two supports together, one speed after the other."""
        films = {i: _Film(partial(self.case, i), lambda *_: None) for i in self.films.values()}
        points: _Points = {name: [] for name in self.films}
        statics: list[StaticEquilibrium] = []
        start = None
        for speed in self.speeds.tolist():
            laws = [
                films[i].law(speed) if i in films else self._spring(i, speed)
                for i in range(len(self.nodes))
            ]
            one = self._equilibrium(speed, laws, start)
            start = one.reactions
            statics.append(one)
            for name, i in self.films.items():
                point = films[i].point(one.reactions[i], speed)
                points[name].append(point)
                self.progress(0, 0, point)
        return np.array([one.reactions for one in statics]), points, statics

    def _replace_loads(self, loads: Array) -> None:
        """Give the static loads the magnitudes that the variant asks for."""
        for i, name in enumerate(self.description.support_names):
            wanted = self.variant.films.get(name, {}).get("applied_load")
            if wanted is not None:
                size = np.hypot(*loads[:, i].T)
                if not size.all():
                    raise InputError("has no static load whose direction to keep", key=name)
                loads[:, i] *= wanted / size[:, None]

    def case(self, i: int, load: Array, scenario: Scenario | None = None) -> Case:
        """Return the film of support i under its load [N], in the load's frame.

        scenario : In place of the bearing's.
        """
        name = self.description.support_names[i]
        scenario = scenario or self.description.bearings[name]
        wanted = {str(model) for model in scenario.thermal_models}
        model = self.model if self.model in wanted else str(scenario.thermal_models[0])
        case = scenario.case(thermal_model=model)
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
        return on_its_stand(entry, support)


def film_cases(result: MachineResult) -> Callable[[int, int], Case]:
    """Return the film of support i at its load at speed number k, as a function of both."""
    analysis = MachineAnalysis(
        Variant(result.description), result.machine.rotor, result.thermal_model,
        result.speeds.tolist(), no_sweep,
    )  # fmt: skip
    return lambda i, k: analysis.case(i, result.supports[i].load[k])


def no_sweep(_cases: list[Case], _speeds: list[float]) -> list[OperatingPoint]:
    """Stand in for the sweep of an analysis that solves no film."""
    raise AssertionError


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
