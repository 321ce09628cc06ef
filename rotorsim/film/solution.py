"""A film at its equilibrium: the search for the position around the isothermal or thermal film."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ..arrays import Array
from ..errors import InputError
from ..model import (
    Bearing,
    Case,
    Cavitation,
    EccentricityTarget,
    Inception,
    LoadTarget,
    MeshSize,
    ThermalModel,
)
from ..model.operating import is_unloaded
from ..status import SolveStatus
from .advice import NOT_FOUND, jump, nowhere, starved
from .banded import NoFilmError, SingularFilmError
from .equilibrium import (
    ECCENTRICITY_LIMITS,
    AttitudeSearch,
    Backtracking,
    FixedRatio,
    LoadSearch,
    PlainSearch,
)
from .first_position import ForceField, crossing, first_positions
from .heat import Heat
from .mesh import mid_thickness
from .problem import FilmProblem, FilmState, film_problem, film_state, supply_layers
from .rupture import rupture_condition
from .thd import (
    ROUGH_TOLERANCE,
    TOLERANCE,
    ThermalFilm,
    solve_thermal_film,
)
from .walls import Walls, choose_walls
from .warm_start import Position, WarmStart, pair, relative_displacement, turned

WallsOf = Callable[[FilmProblem], Walls]
"""Makes the walls of a heated film's problem."""
_Search = PlainSearch | LoadSearch | AttitudeSearch | FixedRatio

_FORCE_TOLERANCE = 1e-8
"""Relative force residual at which the position counts as found."""
_THERMAL_FORCE_TOLERANCE = 1e-6
"""The same of a heated film, whose viscosity is known to `TOLERANCE`."""
_MAX_POSITION_STEPS = 60
_PATIENCE = 12
"""Steps after which each must reduce the force residual."""
_CLOSING = 0.6
"""Hot over cold clearance below which a film that does not converge may seize."""
_FRAME_TOLERANCE = 1e-3
"""Angle [rad] between a misaligned plain film's frame and its line of centres."""
_JUMP = 0.02
"""Unbalanced force next to a place where it turns round, relative to the load, that is a jump."""
_MAX_MESHES = 8
"""Times that the mesh may be graded anew for the position found."""
_ROUGHLY = 1e-3
"""Relative change of force and viscosity at which a film on a coarser mesh is known."""
_COARSEST = (48, 8, 4)
"""Cells around, along and across of the coarsest mesh on which a film is found first."""


@dataclass(frozen=True)
class FilmSolution:
    """A film at its equilibrium, or the last iterate with the reason why it is not.

    thermal : None for an isothermal film.
    frame : Angle from the load line to the film frame's x axis [rad].
    unloaded : Pads whose film cannot be balanced at positive pressure, counted from 0.
    """

    problem: FilmProblem
    state: FilmState
    thermal: ThermalFilm | None
    frame: float
    status: SolveStatus
    message: str
    iterations: int
    residual: float
    unloaded: frozenset[int] = frozenset()

    @property
    def warm_start(self) -> WarmStart:
        """First guess for a neighbouring speed."""
        heat = self.thermal.heat if self.thermal is not None else None
        return WarmStart.of(self.state, heat, self.frame)


@dataclass(frozen=True)
class _Iterate:
    """Last iterate of an isothermal or thermal film."""

    state: FilmState
    thermal: ThermalFilm | None
    converged: bool
    iterations: int
    residual: float

    @property
    def heat(self) -> Heat | None:
        """Temperatures, if the film is thermal."""
        return self.thermal.heat if self.thermal is not None else None


def solve_film(
    case: Case,
    speed: float,
    *,
    initial: WarmStart | None = None,
    walls: WallsOf = choose_walls,
) -> FilmSolution:
    """Solve the film of `case` at `speed` [rad/s], at its eccentricity ratio or under its load.

    `walls` makes the walls of a heated film's problem; by default the steady ones.
    """
    if not _is_fed(case):
        return _unsolved(case, speed, SolveStatus.STARVED, starved(case.bearing))
    if initial is None and walls is choose_walls:
        initial = _on_coarser_mesh(case, speed)
        if initial is not None:
            with suppress(NoFilmError, SingularFilmError):
                solution = solve_film(case, speed, initial=initial)
                if solution.status is SolveStatus.CONVERGED:
                    return solution
            initial = None
    if case.bearing.is_plain and case.bearing.is_symmetric:
        return _solve_plain(case, speed, initial, walls)
    try:
        solution = _solve_general(case, speed, initial, walls)
    except NoFilmError as error:
        # At a given eccentricity other attitudes may leave more room.
        if isinstance(case.target, LoadTarget):
            raise
        solution = _unsolved(case, speed, SolveStatus.NO_EQUILIBRIUM, str(error))
    lost = (SolveStatus.STARVED, SolveStatus.NO_EQUILIBRIUM)
    if solution.thermal is None:
        lost = (*lost, SolveStatus.NOT_CONVERGED)
    if solution.status in lost:
        return _from_elsewhere(case, speed, solution, walls)
    return solution


def _on_coarser_mesh(case: Case, speed: float) -> WarmStart | None:
    """Return a heated film known roughly on a mesh half as fine; None where it is not found.

    Isothermal films are found in a few steps anyway.
    """
    mesh = case.film.mesh
    around, along = mesh.circumferential // 2, 2 * (mesh.axial // 4)
    enough = around >= _COARSEST[0] and along >= _COARSEST[1]
    if case.thermal.model is not ThermalModel.THD or not enough:
        return None
    across = max(mesh.cross_film // 2, _COARSEST[2])
    coarser = MeshSize(around, along, across, max(mesh.bush_radial // 2, 2))
    case = replace(case, film=replace(case.film, mesh=coarser))
    solve = _solve_plain if case.bearing.is_plain and case.bearing.is_symmetric else _solve_general
    with suppress(NoFilmError, SingularFilmError, InputError):
        solution = solve(case, speed, None, choose_walls, _ROUGHLY)
        if solution.status is SolveStatus.CONVERGED:
            return solution.warm_start
    return None


def _is_fed(case: Case) -> bool:
    """Return whether oil comes in anywhere.

    A film that conserves mass and loses oil at its ends must.
    """
    bearing = case.bearing
    begins = bearing.is_plain and case.film.inception is Inception.MAX_FILM
    conserves = rupture_condition(case.film.cavitation).conserves_mass
    return bool(not conserves or bearing.grooves or bearing.pads or begins)


def _unsolved(case: Case, speed: float, status: SolveStatus, message: str) -> FilmSolution:
    """Return the isothermal film of a journal somewhere, and why there is no other."""
    position = _first_position(case)
    problem = film_problem(case, speed, case.bearing, position)
    nearer = _inside(problem, None, position)
    state = film_state(problem, nearer, supply_layers(problem))
    return FilmSolution(problem, state, None, 0.0, status, message, 1, 0.0)


def _from_elsewhere(case: Case, speed: float, failed: FilmSolution, walls: WallsOf) -> FilmSolution:
    """Solve again from positions all over the clearance; `failed` if none leads to the load."""
    isothermal = replace(case, thermal=replace(case.thermal, model=ThermalModel.ISOTHERMAL))
    field = ForceField.of(case, speed)

    def heated(solution: FilmSolution) -> FilmSolution | None:
        if solution.status is not SolveStatus.CONVERGED or failed.thermal is None:
            return solution if solution.status is SolveStatus.CONVERGED else None
        return _solve_general(case, speed, solution.warm_start, walls)

    def solved(position: Position) -> FilmSolution | None:
        relative = _times(position, 1.0 / case.bearing.radial_clearance)
        with suppress(NoFilmError, SingularFilmError):
            return heated(_solve_general(isothermal, speed, WarmStart(relative), walls))
        return None

    positions = first_positions(field)
    if not positions:
        return failed
    for position in positions:
        if found := solved(position):
            return found
    place = crossing(field)
    if place is None:
        why = nowhere(case, float(np.hypot(*failed.state.force)))
        return replace(failed, status=SolveStatus.NO_EQUILIBRIUM, message=why)
    if found := solved(place.position):
        return found
    begins = case.bearing.is_plain and case.film.inception is Inception.MAX_FILM
    if place.off > _JUMP and begins:  # at an angle that follows the journal, not the mesh
        message = jump(case, place.position)
        return replace(failed, status=SolveStatus.NO_EQUILIBRIUM, message=message)
    # Kinks stand closer than a step of Newton's method, or the mesh, which follows the position,
    # moves them: keep the mesh of that very position, and come nearer on it first.
    frame = _frame_angle(case.bearing, place.position)
    local = turned(place.position, -frame)
    problem = film_problem(isothermal, speed, case.bearing.turned(-frame), local)
    nearer = crossing(replace(field, mesh=(problem, frame)), place.position)
    if nearer is None or nearer.off > _JUMP:
        message = jump(case, (nearer or place).position)
        return replace(failed, status=SolveStatus.NO_EQUILIBRIUM, message=message)
    search, start = _search(case, problem, frame), np.array(turned(nearer.position, -frame))
    film = _iterate(problem, start, search, None, walls)
    found = heated(_conclude(film, frame, search, film.iterations))
    return found or replace(failed, status=SolveStatus.NOT_CONVERGED, message=NOT_FOUND)


def _solve_plain(
    case: Case, speed: float, initial: WarmStart | None, walls: WallsOf, roughly: float = 0.0
) -> FilmSolution:
    """Solve a plain, aligned film, with x along the line of centres."""
    cold, target = case.bearing.radial_clearance, case.target
    if isinstance(target, EccentricityTarget) or is_unloaded(target):
        eps = target.eccentricity_ratio if isinstance(target, EccentricityTarget) else 0.0
        problem = film_problem(case, speed, case.bearing, (eps * cold, 0.0))
        clearance, held = problem.bearing.radial_clearance, None
        if problem.is_thermal and case.thermal.expansion is not None:
            held = FixedRatio(eps, clearance)
        start = np.array([eps * clearance, 0.0])
        film = _iterate(problem, start, held, initial, walls, roughly=roughly)
        return _conclude(film, _load_line(film.state), None, film.iterations)
    eps = math.hypot(*initial.position) if initial else 0.5
    warm, search, effort = initial, PlainSearch(target.load, cold), _Effort()
    while True:
        level = _graded_eccentricity(eps)
        problem = film_problem(case, speed, case.bearing, (level * cold, 0.0))
        search.unreachable = False
        search.grown(problem)
        displacement = np.array([eps * problem.bearing.radial_clearance, 0.0])
        if problem.is_thermal and warm is None:
            warm = _cold_start(problem, displacement, search)
            eps = min(warm.position[0], 0.9)
            continue
        film = _iterate(
            problem, displacement, search, warm, walls,
            lambda state, level=level: effort.proceed(
                _graded_eccentricity(float(relative_displacement(state)[0])) == level
            ),
            roughly,
        )  # fmt: skip
        eps = float(relative_displacement(film.state)[0])
        warm = WarmStart.of(film.state, film.heat)
        if effort.ends(film, lost=search.unreachable):
            return _conclude(film, _load_line(film.state), search, effort.iterations)


@dataclass
class _Effort:
    """Counts meshes and iterations; meshes follow the position while it is known roughly only."""

    settled: bool = False
    meshes: int = 0
    iterations: int = 0
    asked: int = 0

    def proceed(self, settled: bool) -> bool:
        """Return whether to iterate to the end on this mesh; `settled`: it suits the position."""
        self.meshes += 1
        self.settled = settled or self.meshes >= _MAX_MESHES
        return self.settled

    def ends(self, film: _Iterate, *, moved: bool = False, lost: bool = False) -> bool:
        """Return whether this solution is the last: its mesh is kept, or the search gave up.

        A position that is known roughly, for a mesh graded anew, says nothing about the search.
        """
        self.iterations += film.iterations
        nowhere = self.meshes == self.asked
        self.asked = self.meshes
        again = moved and self.settled and self.meshes < _MAX_MESHES
        return nowhere or (self.settled and (lost or not again))


def _cold_start(problem: FilmProblem, displacement: Array, search: _Search) -> WarmStart:
    """Return the isothermal film's position, at which a thermal search begins."""
    cold = _iterate_isothermal(problem, displacement, search, None, lambda _: False)
    if cold.state.solution.converged and cold.residual < ROUGH_TOLERANCE:
        displacement = cold.state.displacement
    relative = displacement / problem.bearing.radial_clearance
    return replace(WarmStart.of(cold.state, None), position=pair(relative))


def _graded_eccentricity(eps: float) -> float:
    """Round the eccentricity ratio to one of a few for which meshes are graded."""
    step = 0.25
    return 1.0 - math.exp(-step * round(-math.log(1.0 - eps) / step))


def _load_line(state: FilmState) -> float:
    """Return the angle from the load line, along which the film carries, to the film's x axis."""
    if not (state.force.any() and state.displacement[:2].any()):
        return 0.0
    return -math.atan2(-state.force[1], -state.force[0])


def _solve_general(
    case: Case, speed: float, initial: WarmStart | None, walls: WallsOf, roughly: float = 0.0
) -> FilmSolution:
    """Solve any other film, in the load frame; a misaligned plain one along its line of centres.

    Positions are over the clearance, cold or hot.
    """
    cold, position = case.bearing.radial_clearance, _first_position(case)
    if initial is not None:
        position = initial.position
    warm, effort = initial, _Effort()

    def own_mesh(bearing: Bearing, level: Position, state: FilmState) -> bool:
        place = _times(pair(relative_displacement(state)), cold)
        turn = _frame_angle(case.bearing, place)
        own = _graded_position(bearing, place) == level
        return effort.proceed(own and abs(turn) < 10.0 * _FRAME_TOLERANCE)

    while True:
        frame = _frame_angle(case.bearing, position)
        bearing = case.bearing.turned(-frame)
        local = turned(position, -frame)
        level = _graded_position(bearing, _times(local, cold))
        problem = film_problem(case, speed, bearing, level)
        search = _search(case, problem, frame)
        local = _inside(problem, search, _times(local, problem.bearing.radial_clearance))
        if problem.is_thermal and warm is None:
            warm = _cold_start(problem, np.array(local), search)
            position = turned(warm.position, frame)
            continue
        proceed = partial(own_mesh, bearing, level)
        film = _iterate(problem, np.array(local), search, warm, walls, proceed, roughly)
        local = pair(relative_displacement(film.state))
        position = turned(local, frame)
        warm = WarmStart.of(film.state, film.heat, frame)
        turn = _frame_angle(case.bearing, local)
        moved = abs(turn) > _FRAME_TOLERANCE
        if effort.ends(film, moved=moved, lost=search is not None and search.unreachable):
            return _conclude(film, frame, search, effort.iterations)


def _inside(problem: FilmProblem, search: _Search | None, position: Position) -> Position:
    """Return a first position that leaves a film everywhere, nearer to the centre if need be."""
    for share in (1.0, 0.7, 0.4, 0.0):
        nearer = (share * position[0], share * position[1])
        if problem.geometry.thinnest_at(np.array(nearer)) > 0.0:
            return nearer
        if isinstance(search, AttitudeSearch):
            raise NoFilmError(
                "the journal touches the bore at this eccentricity: lobes and misalignment leave "
                "less room"
            )
    raise NoFilmError("the misaligned journal touches the bore even when it is centred")


def _search(case: Case, problem: FilmProblem, frame: float) -> LoadSearch | AttitudeSearch:
    clearance = problem.bearing.radial_clearance
    if isinstance(case.target, EccentricityTarget):
        return AttitudeSearch(case.target.eccentricity_ratio, clearance, -frame)
    load = case.target.load * np.array([math.cos(frame), -math.sin(frame)])
    return LoadSearch(load, clearance, problem.geometry)


def _first_position(case: Case) -> Position:
    eps = 0.4
    if isinstance(case.target, EccentricityTarget):
        eps = case.target.eccentricity_ratio
    preload = max((arc.preload for arc in case.bearing.arcs), default=0.0)
    if isinstance(case.target, LoadTarget):
        eps *= 1.0 - preload
    return eps * math.cos(0.8), eps * math.sin(0.8)


def _frame_angle(bearing: Bearing, position: Position) -> float:
    """Return the film frame's angle: that of the line of centres for a plain bearing, else 0."""
    return math.atan2(position[1], position[0]) if bearing.is_plain else 0.0


def _graded_position(bearing: Bearing, position: Position) -> Position:
    """Round a position to a grid, as fine as the film is thin, for which meshes are graded."""
    thin = float(mid_thickness(bearing, np.linspace(0.0, 2.0 * math.pi, 361), position).min())
    relative = min(max(thin / bearing.radial_clearance, 1e-3), 1.0)
    grid = 2.0 ** math.floor(math.log2(relative / 2.0)) * bearing.radial_clearance
    return round(position[0] / grid) * grid, round(position[1] / grid) * grid


def _times(position: Position, factor: float) -> Position:
    return factor * position[0], factor * position[1]


def _iterate(
    problem: FilmProblem,
    displacement: Array,
    search: _Search | None,
    initial: WarmStart | None,
    walls: WallsOf,
    proceed: Callable[[FilmState], bool] | None = None,
    roughly: float = 0.0,
) -> _Iterate:
    """Iterate on one mesh, to the tolerances or to `roughly` where that is larger."""
    if not problem.is_thermal:
        tolerance = max(_FORCE_TOLERANCE, roughly)
        return _iterate_isothermal(problem, displacement, search, initial, proceed, tolerance)
    film = solve_thermal_film(
        problem,
        displacement,
        initial=initial.heat_on(problem) if initial else None,
        move=search,
        walls=walls(problem),
        force_tolerance=max(_THERMAL_FORCE_TOLERANCE, roughly),
        proceed=proceed,
        tolerance=max(TOLERANCE, roughly),
    )
    return _Iterate(film.state, film, film.converged, film.iterations, film.residual)


def _iterate_isothermal(
    problem: FilmProblem,
    displacement: Array,
    search: _Search | None,
    initial: WarmStart | None,
    proceed: Callable[[FilmState], bool] | None = None,
    tolerance: float = _FORCE_TOLERANCE,
) -> _Iterate:
    """Iterate the position of a film of the supply temperature's viscosity."""
    layers = supply_layers(problem)
    full = initial.full_on(problem) if initial else None
    off, step, stuck, backtracking = 0.0, 0, 0, Backtracking()
    while True:
        step += 1
        state = film_state(problem, displacement, layers, start=full)
        full = state.solution.full
        if search is None:
            return _Iterate(state, None, state.solution.converged, state.solution.steps, 0.0)
        following, off = search(state)
        stuck = stuck + 1 if search.unreachable else 0
        if proceed is not None and off < ROUGH_TOLERANCE:
            if not proceed(state):
                return _Iterate(state, None, False, step, off)
            proceed = None
        if off < tolerance or stuck >= 4 or step == _MAX_POSITION_STEPS:
            break
        if step >= _PATIENCE:
            following = backtracking(displacement, off, following)
        if following is None or np.array_equal(following, displacement):
            break
        displacement = following
    done = off < tolerance and state.solution.converged
    return _Iterate(state, None, done, step, off)


def _conclude(
    film: _Iterate, frame: float, search: _Search | None, iterations: int
) -> FilmSolution:
    """Map the last iterate to a `SolveStatus` with its message."""
    problem = film.state.problem
    status, message = SolveStatus.CONVERGED, ""
    solution = film.state.solution
    concentric = not film.state.displacement[:2].any() and problem.bearing.is_plain
    unruptured = problem.settings.cavitation is Cavitation.FULL_SOMMERFELD
    if concentric and unruptured:
        pass  # no pressure, and yet a film
    elif not solution.pressure.max() > 0.0 or not solution.full.any():
        status = SolveStatus.STARVED
        message = starved(problem.bearing)
    elif search is not None and search.unreachable and not film.converged:
        status = SolveStatus.NO_EQUILIBRIUM
        message = (
            "no journal position within the clearance carries the load (eccentricity ratios from "
            f"{ECCENTRICITY_LIMITS[0]:g} to {ECCENTRICITY_LIMITS[1]}): the film carries "
            f"{float(np.hypot(*film.state.force)):.4g} N at the last one tried; a heavier load "
            "needs more speed, viscosity or size, a lighter one less"
        )
    elif film.thermal is not None and film.thermal.out_of_range:
        status = SolveStatus.OUT_OF_RANGE
        message = "the film's temperature left the range in which an oil's law means anything"
    elif not film.converged:
        status = SolveStatus.NOT_CONVERGED
        cause = film.thermal.cause if film.thermal else f"the residual is {film.residual:.1e}"
        left = problem.bearing.radial_clearance / problem.cold.radial_clearance
        if left < _CLOSING:
            cause += f", and hot solids leave {left:.0%} of the clearance: it may seize"
        message = (
            f"stopped after {iterations} iterations: {cause}; the numbers are the last iterate. "
            'Try a neighbouring speed first, inception = "max_film", or a lower load'
        )
    return FilmSolution(
        problem=problem,
        state=film.state,
        thermal=film.thermal,
        frame=frame,
        status=status,
        message=message,
        iterations=iterations,
        residual=film.residual,
    )


__all__ = ["FilmSolution", "solve_film"]
