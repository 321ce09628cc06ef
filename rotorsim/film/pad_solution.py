"""Films between tilting pads at their equilibrium, isothermal or thermal."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..model import Case
from ..status import SolveStatus
from .banded import NoFilmError
from .heat import Heat
from .layers import LayerIntegrals, isoviscous_layers, layer_integrals
from .pads import PadSearch
from .problem import FilmProblem, FilmState, film_problem, film_state
from .solution import FilmSolution, WarmStart
from .thd import ThermalFilm, solve_thermal_film, uniform_heat

Array = NDArray[np.float64]

FORCE_TOLERANCE = 1e-10
"""Of isothermal films: cross terms that vanish by symmetry are to vanish."""
THERMAL_FORCE_TOLERANCE = 1e-7
MAX_STEPS = 80
MAX_REVISIONS = 6
"""Times that the set of unloaded pads may be revised."""


@dataclass(frozen=True)
class _Cold:
    """Isothermal film: the last state, how far it is off, and how it ended."""

    state: FilmState
    off: float
    steps: int
    unreachable: bool

    @property
    def converged(self) -> bool:
        return self.off < FORCE_TOLERANCE and self.state.solution.converged


def solve_pads(case: Case, speed: float, *, initial: WarmStart | None = None) -> FilmSolution:
    """Solve the film of a tilting-pad bearing at `speed` [rad/s] and its equilibrium.

    Raises
    ------
    NoFilmError
        No pads stand in the load's way, or at the given eccentricity the journal touches one
        wherever it stands.
    """
    problem = film_problem(case, speed, case.bearing, (0.0, 0.0))
    search = PadSearch(problem, case.target)
    if not search.supports_load:
        raise NoFilmError(
            "the forces along the pivots cannot add up to the load's direction: a pivot must stand "
            "on either side of it, less than 180 deg apart, or in its line"
        )
    q, heat = search.first_guess(), None
    if initial is not None and initial.pads is not None and initial.pads.size == q.size - 2:
        q, heat = np.array([*initial.position, *initial.pads]), initial.heat
    if problem.is_thermal and heat is not None and heat.temperature.shape == _heat_shape(problem):
        thermal = _thermal(search, search.settle(q, _warm_layers(problem, heat)), heat)
        return _conclude(search, thermal.state, thermal, None)
    supply = float(case.lubricant.viscosity(case.thermal.supply_temperature))
    cold = _isothermal(search, q, isoviscous_layers(problem.mesh.shape, supply))
    if not problem.is_thermal or not cold.converged:
        return _conclude(search, cold.state, None, cold)
    thermal = _thermal(search, cold.state.displacement, uniform_heat(problem))
    return _conclude(search, thermal.state, thermal, cold)


def _heat_shape(problem: FilmProblem) -> tuple[int, int, int]:
    return (*problem.mesh.shape, problem.settings.mesh.cross_film)


def _warm_layers(problem: FilmProblem, heat: Heat) -> LayerIntegrals:
    return layer_integrals(problem.lubricant.law.viscosity(heat.temperature))


def _isothermal(search: PadSearch, q: Array, layers: LayerIntegrals) -> _Cold:
    q = search.settle(q, layers)
    full, best, stalled, revisions = None, np.inf, 0, 0
    step = 0
    while True:
        step += 1
        state = film_state(search.problem, q, layers, start=full)
        full = state.solution.full
        following, off = search(state)
        if len(search.unloaded) == len(search.frames):
            return _Cold(state, 1.0, step, True)
        if search.changed(q) and revisions < MAX_REVISIONS:
            revisions += 1
            q, full, best = search.settle(q, layers), None, np.inf
            continue
        if off < FORCE_TOLERANCE and search.needs_sampling(q) and revisions < MAX_REVISIONS:
            # Pads whose root only a search shows: once more, at the position found.
            revisions += 1
            before, settled = search.unloaded, search.settle(q, layers)
            if search.unloaded != before:
                q, full, best = settled, None, np.inf
                continue
        if off < FORCE_TOLERANCE or search.unreachable or step >= MAX_STEPS:
            return _Cold(state, off, step, search.unreachable)
        stalled = 0 if off < 0.8 * best else stalled + 1
        best = min(best, off)
        if stalled >= 4:
            following, full, stalled, best = search.settle(following, layers), None, 0, np.inf
        q = following


def _thermal(search: PadSearch, q: Array, heat: Heat) -> ThermalFilm:
    """Temperatures and equilibrium together, again where other pads turn out to be unloaded."""
    iterations, revisions = 0, 0
    while True:
        film = solve_thermal_film(
            search.problem, q, initial=heat, move=search, force_tolerance=THERMAL_FORCE_TOLERANCE
        )
        iterations, revisions = iterations + film.iterations, revisions + 1
        film = replace(film, iterations=iterations)
        before, q, heat = search.unloaded, film.state.displacement, film.heat
        sure = film.converged and not (search.changed(q) or search.needs_sampling(q))
        if sure or film.out_of_range or revisions == MAX_REVISIONS:
            return film
        q = search.settle(q, _warm_layers(search.whole, heat))
        if search.unloaded == before and film.converged:
            return film


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
    if len(search.unloaded) == len(search.frames):
        status = SolveStatus.NO_EQUILIBRIUM
        message = "no pad's film can be balanced at positive pressure: all pads are unloaded"
    elif thermal is not None and thermal.out_of_range:
        status = SolveStatus.OUT_OF_RANGE
        message = "the film's temperature left the range in which an oil's law means anything"
    elif unreachable:
        status = SolveStatus.NO_EQUILIBRIUM
        message = (
            "no journal position off the pads carries the load: the film carries "
            f"{float(np.hypot(*state.force[:2])):.4g} N at the last one tried; a heavier load "
            "needs more speed, viscosity or size"
        )
    elif not converged:
        status = SolveStatus.NOT_CONVERGED
        message = (
            f"stopped after {iterations} iterations: {cause}; the numbers are the last iterate"
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
        unloaded=search.unloaded,
    )
