"""The thermohydrodynamic fixed point: viscosity, pressure, flow and heat until they agree.

One iteration takes a temperature field (and both walls) through viscosity, Dowson's equation and
the energy equation to a new temperature field; Anderson acceleration mixes them. A `move` callback
may shift the journal between iterations, so that position and temperature converge together.

A film has converged when all of the following hold.

=============  =====================================================================================
force          the search's relative residual is below `force_tolerance`
temperature    in one iteration no log viscosity changes by `TOLERANCE`, no temperature by 1e-4 of
               the field's spread, and no wall's heat by 1e-3 of the dissipation
heat balance   it closes within `BALANCE_TOLERANCE` of the dissipation
rupture        few cells break the rupture condition (`_VIOLATIONS_ALLOWED`)
=============  =====================================================================================
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, Booleans
from ..model import InletModel
from .anderson import AndersonMixer
from .energy import EnergyProblem, WallTemperatures, march
from .growth import Growth
from .heat import (
    Heat,
    HeatBalance,
    dissipated_power,
    energy_problem,
    heat_balance,
    loss_per_degree,
)
from .inlets import inlet_temperatures
from .layers import layer_integrals
from .problem import FilmProblem, FilmState, film_state
from .walls import FilmContact, Walls, choose_walls

TOLERANCE = 1e-5
"""Largest change of log viscosity in one iteration at which the film counts as converged."""
_SPREAD_WEIGHT = 0.1
"""Weight of a temperature change relative to the field's spread, as one of log viscosity."""
_SMALLEST_SPREAD = 1e-2
"""[K]; temperatures closer together than this need not be known relative to their spread."""
BALANCE_TOLERANCE = 1e-3
"""Part of the dissipation that may be unaccounted for in a converged film."""
BALANCE_ROUNDING = 1e-9
"""Part of all heat that enters the film which is lost in rounding."""
_HEAT_WEIGHT = 0.01
"""Weight of heat on which film and walls disagree, relative to the dissipation."""
_MAX_ITERATIONS = 150
_FAR_RESIDUAL = 0.1
"""Change of log viscosity above which the cells' states are guessed anew."""
ROUGH_TOLERANCE = 0.02
"""Change of log viscosity and relative force residual at which the solution is known roughly."""
_STAGNATION = 6
"""Iterations over which the residual should at least halve."""
_FREEZE_AFTER = 12
"""Iterations from which a stagnating film's cells are kept full or ruptured, as they are."""
_VIOLATIONS_ALLOWED = 2e-3
"""Part of the cells that may break the rupture condition at the end because they were kept."""
_UNREACHABLE_STEPS = 8
"""Iterations that the search may lie at the end of its range before it is given up."""
_BEYOND_LIMITS_STEPS = 25
"""Iterations in a row that may lead beyond the temperature limits before the film is given up."""
_LOSS_EVERY = 6
"""Iterations from one estimate of the film's loss of heat to the next."""
_POSITION_WEIGHT = 30.0
"""[K]; a clearance's change of position counts like this change of the whole temperature field."""
_TEMPERATURE_LIMITS = (150.0, 650.0)
"""[K]; an iterate outside is pulled back, a converged field outside is out of range."""


@dataclass(frozen=True)
class ThermalFilm:
    """A converged (or last) iterate.

    state : Pressure and flow at the temperatures below.
    viscosity : (n, m, k) array [Pa s]
    inlet_temperature : (4, n, m) or (4, n, m, k) array [K]
    leaving_temperature : (2, n, m, k) array. Of the oil that leaves each cell along the film and
        the axis [K].
    cause : What has not converged; empty if `converged`.
    out_of_range : Whether the temperatures left `_TEMPERATURE_LIMITS`.
    residual : Last change of log viscosity, or what counts as much (see `_change`).
    """

    state: FilmState
    heat: Heat
    viscosity: Array
    energy: EnergyProblem
    walls: Walls
    inlet_temperature: Array
    leaving_temperature: Array
    balance: HeatBalance
    converged: bool
    cause: str
    out_of_range: bool
    iterations: int
    residual: float


class _Move(Protocol):
    """Search for the displacements at which the film carries its load."""

    unreachable: bool

    def __call__(self, state: FilmState) -> tuple[Array, float]:
        """Return the next displacements from the film's state, and the relative force residual."""
        ...

    def allowed(self, old: Array, new: Array, /) -> Array:
        """Pull a mixed step back to where a film can be."""
        ...

    def grown(self, problem: FilmProblem, /) -> None:
        """Take over the clearance of `problem`."""
        ...


def uniform_heat(problem: FilmProblem) -> Heat:
    """Return the film at supply temperature throughout, between its walls."""
    walls, shape = choose_walls(problem), problem.mesh.shape
    layers = problem.settings.mesh.cross_film
    film = np.full((*shape, layers), problem.thermal.supply_temperature)
    return Heat(film, walls.bush.start(shape), float(walls.shaft.start(())))


def solve_thermal_film(
    problem: FilmProblem,
    displacement: Array,
    *,
    initial: Heat | None = None,
    move: _Move | None = None,
    walls: Walls | None = None,
    full: Booleans | None = None,
    proceed: Callable[[FilmState], bool] | None = None,
    force_tolerance: float = 1e-7,
    tolerance: float = TOLERANCE,
    max_iterations: int = _MAX_ITERATIONS,
) -> ThermalFilm:
    """Iterate to the fixed point.

    displacement : (q,) array. Generalised displacements, film frame; the first guess if `move` is
        given.
    initial : A neighbouring solution.
    move : Gives the next displacements; called once an iteration.
    walls : By default the steady ones of the problem's settings.
    full : (n, m) bool array. The full cells, taken as given throughout.
    proceed : Called once, when both residuals fall below `ROUGH_TOLERANCE`. Return False to get the
        rough solution back (`converged` False), as for a mesh graded anew.
    tolerance : Of the change of log viscosity; the other tolerances stay.
    Returns: With `converged` False and a `cause` if `max_iterations` did not suffice.
    """
    heat = uniform_heat(problem) if initial is None else initial
    scales, walls = problem.geometry.displacements.scales, walls or choose_walls(problem)
    expansion, growth = problem.thermal.expansion, None
    if expansion is not None:
        growth = Growth(problem.cold, expansion)
        problem, displacement = _grown(growth, problem, displacement, heat, walls, move)
    mixer = AndersonMixer(heat.temperature.size + heat.bush.size + 1 + scales.size)
    progress, leaving = _Progress(kept=full, given=full is not None), None
    while True:
        step = _apply(problem, walls, displacement, heat, progress, leaving)
        leaving = step.leaving
        target, off = (displacement, 0.0) if move is None else move(step.state)
        changed = progress.record(step, unreachable=move is not None and move.unreachable)
        if changed:  # what the mixer remembers belongs to another map
            mixer.forget()
        stop = False
        if proceed is not None and max(step.residual, off) < ROUGH_TOLERANCE:
            stop, proceed = not proceed(step.state), None
        cause = _unsettled(step.residual, tolerance, off, force_tolerance)
        if growth is not None and growth.lagging:
            cause = "the clearance still changes"
        balance = None
        if not (cause or stop):
            balance = _balance(problem, walls, heat, step)
            cause = _unbalanced(balance) or progress.broken_rupture(step)
        if not cause or stop or progress.hopeless(max_iterations):
            return ThermalFilm(
                state=step.state, heat=heat, viscosity=step.viscosity, energy=step.energy,
                walls=walls, inlet_temperature=step.inlet, leaving_temperature=leaving,
                balance=balance or _balance(problem, walls, heat, step),
                cause=cause or "the position is known roughly only",
                converged=not (cause or stop), out_of_range=progress.out_of_range(heat),
                iterations=len(progress.history), residual=step.residual,
            )  # fmt: skip
        mixed = mixer.next(
            packed(heat, displacement / scales), packed(step.mapped, target / scales)
        )
        heat, relative = unpacked(mixed, heat, scales.size)
        if growth is not None:
            problem, displacement = _grown(growth, problem, displacement, heat, walls, move)
            if growth.lagging:
                mixer.forget()
            if move is not None:
                scales = problem.geometry.displacements.scales
        if move is not None:
            following = relative * scales
            allowed = move.allowed(displacement, following)
            if not np.array_equal(allowed, following):
                mixer.forget()
            displacement = allowed


def _grown(
    growth: Growth,
    problem: FilmProblem,
    displacement: Array,
    heat: Heat,
    walls: Walls,
    move: _Move | None,
) -> tuple[FilmProblem, Array]:
    """Return the problem and displacements in the clearance of `heat`.

    Where a search moves the journal, its eccentricity ratio stays: so it touches nothing.
    """
    hot = growth(problem, heat, walls)
    if move is not None:
        move.grown(hot)
        ratio = hot.geometry.displacements.scales / problem.geometry.displacements.scales
        displacement = displacement * ratio
    return hot, displacement


@dataclass(frozen=True)
class _Step:
    """Result of one temperature field: the film, and the next temperatures `mapped`."""

    state: FilmState
    viscosity: Array
    energy: EnergyProblem
    inlet: Array
    leaving: Array
    mapped: Heat
    residual: float


@dataclass
class _Progress:
    """Progress of the iteration, and its treatment of cells that find no state.

    A cell at the edge of the full film may have no state that agrees with its own heat: full, the
    film warms and it ruptures; ruptured, it cools and fills. The iteration then circles around a
    cell or two for ever. After a while the states are therefore kept; the solution is accepted if
    no more than a few cells break the rupture condition, which is the mesh's own uncertainty.
    """

    kept: Booleans | None
    """Full cells, while their states are kept."""
    given: bool
    """True where they are kept throughout, as the caller asked."""
    guess: Booleans | None = None
    """First guess of the full cells."""
    history: list[float] = field(default_factory=list)
    release: int = _FREEZE_AFTER
    stuck: int = 0
    beyond: int = 0
    loss: float = math.inf
    """Heat lost to oil and bush per degree of the film [W/K], where the shaft's answer needs it."""

    def record(self, step: _Step, *, unreachable: bool) -> bool:
        """Take notice of a step; return whether states are kept or released from now on."""
        full = step.state.solution.full
        self.history.append(step.residual)
        # While the heat still moves much, coarser meshes guess the full cells better than the past.
        self.guess = full if step.residual < _FAR_RESIDUAL else None
        self.stuck = self.stuck + 1 if unreachable else 0
        reach = _TEMPERATURE_LIMITS[1] - _TEMPERATURE_LIMITS[0]
        trapped = dissipated_power(step.energy) > reach * self.loss
        beyond = trapped or _beyond_limits(step.mapped.temperature)
        self.beyond = self.beyond + 1 if beyond else 0
        if self.kept is None:
            if len(self.history) >= self.release and full.any() and self._stagnates():
                self.kept = full
                return True
        elif step.residual < ROUGH_TOLERANCE and self.broken_rupture(step):
            return True
        return False

    def broken_rupture(self, step: _Step) -> str:
        """Describe how many cells break the rupture condition if too many; release their states."""
        broken, cells = step.state.solution.violations, step.state.solution.full.size
        if self.given or broken <= _VIOLATIONS_ALLOWED * cells:
            return ""
        self.kept, self.release = None, len(self.history) + _FREEZE_AFTER
        return f"{broken} of {cells} cells break the rupture condition"

    def hopeless(self, max_iterations: int) -> bool:
        """Return whether to give up."""
        lost = self.stuck >= _UNREACHABLE_STEPS or self.beyond >= _BEYOND_LIMITS_STEPS
        return lost or not np.isfinite(self.history[-1]) or len(self.history) >= max_iterations

    def out_of_range(self, heat: Heat) -> bool:
        """Return whether the film left the range of temperatures, for good."""
        return self.beyond >= _BEYOND_LIMITS_STEPS or _beyond_limits(heat.temperature)

    def _stagnates(self) -> bool:
        """Return whether the last iterations brought little against the best before them."""
        recent = self.history[-_STAGNATION:]
        return min(recent) > 0.5 * min(self.history[:-_STAGNATION])


def _beyond_limits(temperature: Array) -> bool:
    low, high = _TEMPERATURE_LIMITS
    return bool(temperature.min() <= low + 1.0 or temperature.max() >= high - 1.0)


def _apply(
    problem: FilmProblem,
    walls: Walls,
    displacement: Array,
    heat: Heat,
    progress: _Progress,
    leaving: Array | None,
) -> _Step:
    """Apply the fixed point's map once."""
    viscosity = problem.lubricant.law.viscosity(heat.temperature)
    layers = layer_integrals(viscosity)
    state = film_state(problem, displacement, layers, start=progress.guess, frozen=progress.kept)
    energy = energy_problem(problem, state)
    inlet = inlet_temperatures(problem, energy, heat.temperature)
    temperature = heat.temperature.copy()
    # A film that feeds itself is marched round several times; else the fixed point does the rest.
    passes = 3 if problem.thermal.inlet is InletModel.PERIODIC else 1
    bounds = WallTemperatures(heat.bush, heat.shaft, walls.bush.insulated)
    moved, leaving = march(
        energy, viscosity, bounds, inlet, temperature, passes=passes, leaving=leaving
    )
    if passes > 1:
        moved = float(np.abs(temperature - heat.temperature).max())
    if walls.shaft.floats and len(progress.history) % _LOSS_EVERY == 0:
        progress.loss = loss_per_degree(problem, energy, walls)
    bush = FilmContact.bush(energy, temperature)
    shaft = FilmContact.shaft(energy, temperature, progress.loss)
    mapped = Heat(
        temperature,
        walls.bush.respond(heat.bush, bush),
        float(walls.shaft.respond(np.array(heat.shaft), shaft)),
    )
    change = _change(problem, heat, mapped, moved)
    passed = float(np.sum(walls.bush.exchange(bush) * np.abs(mapped.bush - heat.bush)))
    passed += float(walls.shaft.exchange(shaft) * abs(mapped.shaft - heat.shaft))
    made = dissipated_power(energy)
    residual = max(change, _HEAT_WEIGHT * passed / made if made > 0.0 else 0.0)
    return _Step(state, viscosity, energy, inlet, leaving, mapped, residual)


def _change(problem: FilmProblem, heat: Heat, mapped: Heat, moved: float) -> float:
    """Return the largest change of log viscosity anywhere, as the oil thins fastest.

    `moved` is the film's largest change of temperature [K]. An oil that does not thin, or hardly
    warms, still has a temperature to settle: its change counts too, relative to the field's spread.
    """
    coldest, hottest = float(mapped.temperature.min()), float(mapped.temperature.max())
    change = max(
        moved, float(np.abs(mapped.bush - heat.bush).max()), abs(mapped.shaft - heat.shaft)
    )
    near = problem.lubricant.law.viscosity(np.array([coldest, coldest + 1e-3]))
    thinning = float(np.log(near[0] / near[1])) / 1e-3
    return change * max(thinning, _SPREAD_WEIGHT / max(hottest - coldest, _SMALLEST_SPREAD))


def _balance(problem: FilmProblem, walls: Walls, heat: Heat, step: _Step) -> HeatBalance:
    return heat_balance(problem, step.energy, heat, walls, step.inlet, step.leaving)


def _unsettled(residual: float, tolerance: float, off: float, force_tolerance: float) -> str:
    """Describe which of temperature and force is farther from settled; empty if both have."""
    if residual < tolerance and off < force_tolerance:
        return ""
    if residual / tolerance < off / force_tolerance:
        return f"the force is off by {off:.1e}, relative to the load"
    return f"the temperatures still change (log viscosity by {residual:.1e} an iteration)"


def _unbalanced(balance: HeatBalance) -> str:
    """Describe how much heat is unaccounted for; empty if that is within the tolerance."""
    allowed = BALANCE_TOLERANCE * balance.dissipation + BALANCE_ROUNDING * balance.turnover
    if abs(balance.remainder) <= allowed:
        return ""
    return f"{abs(balance.imbalance):.2%} of the dissipated heat is unaccounted for"


def packed(heat: Heat, relative: ArrayLike = ()) -> Array:
    """Return all unknowns in one flat array, a displacement weighing as much as the whole field.

    `relative`: displacements over their scales.
    """
    displacements = _displacement_weight(heat) * np.asarray(relative)
    return np.concatenate(
        [heat.temperature.ravel(), heat.bush.ravel(), [heat.shaft], displacements]
    )


def unpacked(flat: Array, like: Heat, count: int = 0) -> tuple[Heat, Array]:
    """Reverse `packed` for `count` displacements; temperatures are kept within their limits."""
    films, bore = like.temperature.size, like.bush.size
    np.clip(flat[: flat.size - count], *_TEMPERATURE_LIMITS, out=flat[: flat.size - count])
    heat = Heat(
        temperature=flat[:films].reshape(like.temperature.shape),
        bush=flat[films : films + bore].reshape(like.bush.shape),
        shaft=float(flat[films + bore]),
    )
    return heat, flat[flat.size - count :] / _displacement_weight(like)


def _displacement_weight(heat: Heat) -> float:
    return _POSITION_WEIGHT * math.sqrt(heat.temperature.size)
