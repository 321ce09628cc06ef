"""Films between tilting pads at their equilibrium, isothermal or thermal."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array
from ..model import Case, EccentricityTarget, LoadTarget
from ..status import SolveStatus
from .anderson import AndersonMixer
from .banded import NoFilmError, SingularFilmError
from .heat import Heat
from .layers import LayerIntegrals, layer_integrals
from .pads import PadSearch
from .problem import FilmProblem, FilmState, film_problem, film_state, supply_layers
from .solution import FilmSolution, WallsOf
from .thd import ThermalFilm, packed, solve_thermal_film, uniform_heat, unpacked
from .walls import choose_walls
from .warm_start import WarmStart

_FORCE_TOLERANCE = 1e-9
"""Of isothermal films: cross terms that vanish by symmetry are to vanish."""
_THERMAL_FORCE_TOLERANCE = 1e-7
_ROUGHLY = 1e-3
"""Of the film on a coarser mesh, where the next one begins."""
_MAX_STEPS = 80
_MAX_REVISIONS = 6
"""Times that the set of unloaded pads may be revised."""
_ATTITUDES = 24
"""Directions in which the journal is tried where Newton's method finds no attitude."""
_MAX_TURNS = 40
"""Times that position and temperatures are found in turn."""
_IN_TURN_TOLERANCE = 1e-5
"""Of the forces, relative to the load."""
_CLIMB = (0.1, 0.2, 0.4, 0.6, 0.8)
"""Parts of the load from which a film is approached that is not found at once."""
_LEAST_CELLS = 8
"""Cells along each pad of a mesh on which the equilibrium is found first."""
_MAX_RETRIES = 2
"""Times that a thermal film is solved which does not converge."""


@dataclass(frozen=True)
class _Cold:
    """Isothermal film: the last state, how far it is off, and how it ended."""

    state: FilmState
    off: float
    steps: int
    unreachable: bool
    tolerance: float = _FORCE_TOLERANCE

    @property
    def converged(self) -> bool:
        return self.off < self.tolerance and self.state.solution.converged


def solve_pads(
    case: Case,
    speed: float,
    *,
    initial: WarmStart | None = None,
    walls: WallsOf = choose_walls,
) -> FilmSolution:
    """Solve the film of a tilting-pad bearing at `speed` [rad/s] and its equilibrium.

    `walls` as in `solve_film`.

    Raises NoFilmError: No pads stand in the load's way, or at the given eccentricity the journal
        touches one wherever it stands.
    """
    found = _solve(case, speed, initial, walls)
    if found.status is not SolveStatus.NOT_CONVERGED or not isinstance(case.target, LoadTarget):
        return found
    if PadSearch(found.problem, case.target).give_way(found.state.displacement):
        return found
    near = None
    for part in _CLIMB:
        lighter = replace(case, target=LoadTarget(part * case.target.load))
        solution = _solve(lighter, speed, near, walls)
        if solution.status is SolveStatus.CONVERGED:
            near = solution.warm_start
    if near is None:
        return found
    climbed = _solve(case, speed, near, walls)
    return climbed if climbed.status is SolveStatus.CONVERGED else found


def _solve(case: Case, speed: float, initial: WarmStart | None, walls: WallsOf) -> FilmSolution:
    """Solve from a first guess; see `solve_pads`."""
    problem = film_problem(case, speed, case.bearing, (0.0, 0.0))
    search = PadSearch(problem, case.target)
    if not search.supports_load:
        raise NoFilmError(
            "the forces along the pivots cannot add up to the load's direction: a pivot must stand "
            "on either side of it, less than 180 deg apart, or in its line"
        )
    q, heat = search.first_guess(), None
    if initial is not None and initial.pads is not None and initial.pads.size == q.size - 2:
        relative = np.array([*initial.position, *initial.pads])
        q, heat = problem.bearing.radial_clearance * relative, initial.heat
    if problem.is_thermal and heat is not None and heat.temperature.shape == _heat_shape(problem):
        thermal = _thermal(search, search.settle(q, _warm_layers(problem, heat)), heat, walls)
        return _conclude(search, thermal.state, thermal, None)
    layers = supply_layers(problem)
    nearby, cold = _on_coarser_mesh(case, speed) if initial is None else None, None
    if nearby is not None:
        with suppress(NoFilmError, SingularFilmError):
            cold = _isothermal(search, search.as_found(*nearby), layers, settled=True)
    if cold is None or not cold.converged:
        search = PadSearch(problem, case.target)
        cold = _isothermal(search, q, layers)
    if isinstance(case.target, EccentricityTarget) and not cold.converged:
        cold = _by_attitude(search, layers) or replace(cold, unreachable=True)
    if not problem.is_thermal or not cold.converged:
        return _conclude(search, cold.state, None, cold)
    thermal = _thermal(search, cold.state.displacement, uniform_heat(problem), walls)
    if not (thermal.converged or thermal.out_of_range):
        return _in_turn(search, thermal, cold, walls)
    return _conclude(search, thermal.state, thermal, cold)


def _on_coarser_mesh(case: Case, speed: float) -> tuple[Array, frozenset[int]] | None:
    """Return displacements and unloaded pads of the isothermal film on a mesh half as fine.

    None where the mesh is coarse already, or that film does not converge.
    """
    mesh = case.film.mesh
    coarser = replace(mesh, circumferential=mesh.circumferential // 2, axial=2 * (mesh.axial // 4))
    if coarser.circumferential < _LEAST_CELLS * len(case.bearing.pads) or coarser.axial < 4:
        return None
    case = replace(case, film=replace(case.film, mesh=coarser))
    try:
        problem = film_problem(case, speed, case.bearing, (0.0, 0.0))
        search = PadSearch(problem, case.target)
        layers = supply_layers(problem)
        cold = _isothermal(search, search.first_guess(), layers, tolerance=_ROUGHLY)
    except (NoFilmError, SingularFilmError):
        return None
    return (cold.state.displacement, search.unloaded) if cold.converged else None


def _in_turn(
    search: PadSearch, thermal: ThermalFilm, cold: _Cold, walls: WallsOf
) -> FilmSolution:  # fmt: skip
    """Solve position and temperatures in turn, for soft pivots they do not settle together.

    `thermal` and `cold` are what was found before, for where this does not settle either.
    """
    q, heat = cold.state.displacement, uniform_heat(search.whole)
    mixer = AndersonMixer(packed(heat).size)
    for _ in range(_MAX_TURNS):
        layers = _warm_layers(search.whole, heat)
        found = _isothermal(search, q, layers)
        if isinstance(search.target, EccentricityTarget) and not found.converged:
            found = _by_attitude(search, layers) or replace(found, unreachable=True)
        if not found.converged:
            if found.unreachable:
                return _conclude(search, found.state, None, found)
            break
        q = found.state.displacement
        film = solve_thermal_film(search.problem, q, initial=heat, walls=walls(search.problem))
        if film.out_of_range:
            break
        if film.converged and search(film.state)[1] < _IN_TURN_TOLERANCE:
            return _conclude(search, film.state, film, cold)
        heat, _ = unpacked(mixer.next(packed(heat), packed(film.heat)), heat)
    return _conclude(search, thermal.state, thermal, cold)


def _heat_shape(problem: FilmProblem) -> tuple[int, int, int]:
    return (*problem.mesh.shape, problem.settings.mesh.cross_film)


def _warm_layers(problem: FilmProblem, heat: Heat) -> LayerIntegrals:
    return layer_integrals(problem.lubricant.law.viscosity(heat.temperature))


def _isothermal(
    search: PadSearch,
    q: Array,
    layers: LayerIntegrals,
    *,
    settled: bool = False,
    tolerance: float = _FORCE_TOLERANCE,
) -> _Cold:
    """Find the equilibrium from `q`; `settled`: with the pads as they stand there."""
    q = q if settled else search.settle(q, layers)
    full, best, stalled, revisions = None, np.inf, 0, 0
    step = 0
    while True:
        step += 1
        state = film_state(search.problem, q, layers, start=full)
        full = state.solution.full
        following, off = search(state)
        if len(search.unloaded) == len(search.frames):
            nearer = search.nearer(q)
            if nearer is None or step > _MAX_REVISIONS:
                return _Cold(state, 1.0, step, True)
            q, full = search.settle(nearer, layers), None
            continue
        if search.changed(q) and revisions < _MAX_REVISIONS:
            revisions += 1
            q, full, best = search.settle(q, layers), None, np.inf
            continue
        if off < tolerance:
            revived = search.revived(q, layers)
            if revived is not None:
                q, full, best = revived, None, np.inf
                continue
        if off < tolerance or search.unreachable or step >= _MAX_STEPS:
            return _Cold(state, off, step, search.unreachable, tolerance)
        stalled = 0 if off < 0.8 * best else stalled + 1
        best = min(best, off)
        if stalled >= 4:
            following, full, stalled, best = search.settle(following, layers), None, 0, np.inf
        q = following


def _by_attitude(search: PadSearch, layers: LayerIntegrals) -> _Cold | None:
    """Look all round for the attitude at which the force opposes the load; None without one."""
    from scipy.optimize import brentq

    def held_at(angle: float) -> _Cold | None:
        q = search.at(angle)
        if q is None:
            return None
        # A search remembers which pads came and went: each attitude begins without.
        held = PadSearch(search.whole, search.target)
        held.held = True
        try:
            return _isothermal(held, q, layers)
        except (NoFilmError, SingularFilmError):
            return None

    def misfit(angle: float) -> float:
        held = held_at(angle)
        return math.nan if held is None else math.atan2(-held.state.force[1], -held.state.force[0])

    angles = np.linspace(-math.pi, math.pi, _ATTITUDES + 1)
    values = [misfit(float(angle)) for angle in angles]
    for k in sorted(range(_ATTITUDES), key=lambda k: abs(angles[k])):
        low, high = values[k], values[k + 1]
        if not (low * high <= 0.0 and abs(low - high) < math.pi):
            continue
        bracket = float(angles[k]), float(angles[k + 1])
        held = held_at(float(brentq(misfit, *bracket, xtol=1e-4)))  # type: ignore[arg-type]
        if held is None:
            continue
        found = _isothermal(search, held.state.displacement, layers)
        if found.converged:
            return found
    return None


def _thermal(search: PadSearch, q: Array, heat: Heat, walls: WallsOf) -> ThermalFilm:
    """Solve temperatures and equilibrium together.

    Again where other pads turn out to be unloaded.
    """
    iterations, revisions = 0, 0
    while True:
        film = solve_thermal_film(
            search.problem, q, initial=heat, move=search, walls=walls(search.problem),
            force_tolerance=_THERMAL_FORCE_TOLERANCE,
        )  # fmt: skip
        iterations, revisions = iterations + film.iterations, revisions + 1
        film = replace(film, iterations=iterations)
        q, heat = film.state.displacement, film.heat
        layers = _warm_layers(search.whole, heat)
        settled = search.revived(q, layers) if film.converged else None
        if settled is None and film.converged and not search.changed(q):
            return film
        tired = revisions == (_MAX_REVISIONS if film.converged else _MAX_RETRIES)
        if tired or film.out_of_range:
            return film
        q = search.settle(q, layers) if settled is None else settled


def _conclude(
    search: PadSearch, state: FilmState, thermal: ThermalFilm | None, cold: _Cold | None
) -> FilmSolution:
    """Map the last iterate to a status."""
    converged, residual, cause, iterations, unreachable = True, 0.0, "", 0, False
    if cold is not None:
        converged, residual, iterations = cold.converged, cold.off, cold.steps
        cause, unreachable = f"the forces are off by {cold.off:.1e} of the load", cold.unreachable
    if thermal is not None:
        converged, residual, cause = thermal.converged, thermal.residual, thermal.cause
        iterations += thermal.iterations
    status, message = SolveStatus.CONVERGED, ""
    unloaded = search.unloaded | search.without_film(state)
    if len(search.unloaded if converged else unloaded) == len(search.frames):
        status = SolveStatus.NO_EQUILIBRIUM
        message = "no pad's film can be balanced at positive pressure: all pads are unloaded"
    elif thermal is not None and thermal.out_of_range:
        status = SolveStatus.OUT_OF_RANGE
        message = "the film's temperature left the range in which an oil's law means anything"
    elif unreachable:
        status = SolveStatus.NO_EQUILIBRIUM
        message = (
            "at no attitude with this eccentricity does the film's force point along the load"
            if isinstance(search.target, EccentricityTarget)
            else "no journal position off the pads carries the load: the film carries "
            f"{float(np.hypot(*state.force[:2])):.4g} N at the last one tried; a heavier load "
            "needs more speed, viscosity or size"
        )
    elif not converged and not search.supports_load:
        status = SolveStatus.NO_EQUILIBRIUM
        loaded = sorted(set(range(len(search.frames))) - search.unloaded)
        message = (
            f"of pads only {', '.join(str(number + 1) for number in loaded)} can be balanced at "
            "positive pressure, and the forces along their pivots cannot add up to the load's "
            "direction; the others float or flutter (preload or an offset pivot would load them)"
        )
    elif not converged:
        status = SolveStatus.NOT_CONVERGED
        message = (
            f"stopped after {iterations} iterations: {cause}{search.give_way(state.displacement)}; "
            "the numbers are the last iterate"
        )
    return FilmSolution(
        problem=search.problem,
        state=replace(state, problem=search.problem),
        thermal=thermal,
        frame=0.0,
        status=status,
        message=message,
        iterations=iterations,
        residual=residual,
        unloaded=unloaded,
    )
