"""The thermohydrodynamic fixed point: viscosity, pressure, flow and heat until they agree.

One iteration takes a temperature field (and both walls) through viscosity, Dowson's equation and
the energy equation to a new temperature field; Anderson acceleration mixes them. A `move` callback
may shift the journal between iterations, so that position and temperature converge together.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..model import BushModel, InletModel, ShaftModel
from .anderson import AndersonMixer
from .bush import BushConduction
from .energy import EnergyProblem, march
from .heat import (
    dissipated_power,
    energy_problem,
    heat_to_bush,
    heat_to_shaft,
    inlet_temperatures,
    start_wall_temperatures,
    wall_temperatures,
)
from .layers import layer_integrals
from .problem import FilmProblem, film_state
from .state import FilmState

Array = NDArray[np.float64]
Position = tuple[float, float]

TOLERANCE = 1e-5
"""Largest change of log viscosity in one iteration at which the film counts as converged."""
MAX_ITERATIONS = 150
FAR_RESIDUAL = 0.1
"""Change of log viscosity above which the cells' states are guessed anew."""
ROUGH_TOLERANCE = 0.02
"""Change of log viscosity and relative force residual at which the solution is known roughly."""
HEAT_WEIGHT = 0.01
"""How heat astray, relative to the dissipation, counts against a change of log viscosity."""
STAGNATION = 6
"""Iterations over which the residual should at least halve."""
FREEZE_AFTER = 12
"""Iterations from which a stagnating film's cells are held full or ruptured, as they are."""
VIOLATIONS_ALLOWED = 2e-3
"""Part of the cells that may break the rupture condition at the end because they were held."""
UNREACHABLE_STEPS = 8
"""Iterations that the search may lie at the end of its range before it is given up."""
POSITION_WEIGHT = 30.0
"""[K]; a clearance's change of position counts like this change of the whole temperature field."""
TEMPERATURE_LIMITS = (150.0, 650.0)
"""[K]; an iterate outside is pulled back, a converged field outside is out of range."""


@dataclass(frozen=True)
class Heat:
    """Temperatures of the film and its walls.

    Attributes
    ----------
    temperature : (n, m, k) array
        [K]
    bush : (n, m) array
        Of the bore [K].
    shaft : float
        [K]
    """

    temperature: Array
    bush: Array
    shaft: float

    def packed(self, position: Position, clearance: float) -> Array:
        """All unknowns in one flat array, the position weighing as much as the whole field."""
        weight = self._weight(clearance)
        tail = [self.shaft, weight * position[0], weight * position[1]]
        return np.concatenate([self.temperature.ravel(), self.bush.ravel(), tail])

    def unpacked(self, packed: Array, clearance: float) -> tuple[Heat, Position]:
        """The reverse of `packed`, temperatures held within their limits."""
        films, bore = self.temperature.size, self.bush.size
        np.clip(packed[:-2], *TEMPERATURE_LIMITS, out=packed[:-2])
        heat = Heat(
            temperature=packed[:films].reshape(self.temperature.shape),
            bush=packed[films : films + bore].reshape(self.bush.shape),
            shaft=float(packed[-3]),
        )
        weight = self._weight(clearance)
        return heat, (float(packed[-2]) / weight, float(packed[-1]) / weight)

    def _weight(self, clearance: float) -> float:
        return POSITION_WEIGHT * math.sqrt(self.temperature.size) / clearance


@dataclass(frozen=True)
class ThermalFilm:
    """A converged (or last) iterate.

    Attributes
    ----------
    state : FilmState
        Pressure and flow at the temperatures below.
    heat : Heat
    viscosity : (n, m, k) array
        [Pa s]
    energy : EnergyProblem
    inlet_temperature : (4, n, m) array
        [K]
    leaving_temperature : (2, n, m, k) array
        Of the oil that leaves each cell along the film and the axis [K].
    converged : bool
    iterations : int
    residual : float
        Last change of log viscosity.
    history : tuple of float
        The residual of every iteration.
    """

    state: FilmState
    heat: Heat
    viscosity: Array
    energy: EnergyProblem
    inlet_temperature: Array
    leaving_temperature: Array
    converged: bool
    iterations: int
    residual: float
    history: tuple[float, ...]


class Move(Protocol):
    """Search for the journal's position."""

    unreachable: bool

    def __call__(self, state: FilmState) -> tuple[Position, float]:
        """From the film's state to the next position and the relative force residual."""
        ...

    def allowed(self, old: Position, new: Position, /) -> Position:
        """Pull a mixed step back to where a film can be."""
        ...


def uniform_heat(problem: FilmProblem) -> Heat:
    """The film at supply temperature throughout."""
    n, m = problem.mesh.shape
    bush, shaft = start_wall_temperatures(problem.thermal, (n, m))
    layers = problem.settings.mesh.cross_film
    return Heat(np.full((n, m, layers), problem.thermal.supply_temperature), bush, shaft)


def solve_thermal_film(
    problem: FilmProblem,
    position: Position,
    *,
    initial: Heat | None = None,
    move: Move | None = None,
    held: NDArray[np.bool_] | None = None,
    proceed: Callable[[Position], bool] | None = None,
    force_tolerance: float = 1e-7,
    tolerance: float = TOLERANCE,
    max_iterations: int = MAX_ITERATIONS,
) -> ThermalFilm:
    """Iterate to the fixed point.

    Parameters
    ----------
    position : tuple of float
        Journal centre [m], film frame; the first guess if `move` is given.
    initial : Heat, optional
        A neighbouring solution.
    move : callable, optional
        Gives the next position; called once an iteration.
    held : (n, m) bool array, optional
        The full cells, taken as given throughout.
    proceed : callable, optional
        Asked once, when the solution is known roughly, whether to go on from this position; if
        not, the rough solution is returned, `converged` False.

    Notes
    -----
    A cell at the edge of the full film may have no state that agrees with its own heat: full, the
    film warms and it ruptures; ruptured, it cools and fills. The iteration then circles around a
    cell or two for ever. After a while the states are therefore held; the solution is accepted if
    no more than a few cells break the rupture condition, which is the mesh's own uncertainty.

    Returns
    -------
    ThermalFilm
        With ``converged`` False if `max_iterations` did not suffice.
    """
    heat = uniform_heat(problem) if initial is None else initial
    clearance = problem.bearing.radial_clearance
    mixer = AndersonMixer(heat.temperature.size + heat.bush.size + 3)
    release, stuck = FREEZE_AFTER, 0
    law, bush = problem.lubricant.law, _bush_of(problem)
    guess, frozen, leaving, history = None, held, None, []
    while True:
        viscosity = law.viscosity(heat.temperature)
        layers = layer_integrals(viscosity)
        state = film_state(problem, position, layers, start=guess, frozen=frozen)
        full = state.solution.full
        energy = energy_problem(problem, state)
        inlet = inlet_temperatures(problem, energy, heat.temperature)
        mapped, leaving = _through_energy(problem, energy, viscosity, heat, inlet, bush, leaving)
        residual = _change(problem, energy, mapped, heat)
        history.append(residual)
        # While the heat still moves much, coarser meshes guess the full cells better than the past.
        guess = full if residual < FAR_RESIDUAL else None
        target, off = (position, 0.0) if move is None else move(state)
        stuck = stuck + 1 if move is not None and move.unreachable else 0
        roughly = residual < ROUGH_TOLERANCE and off < ROUGH_TOLERANCE
        stop = False
        if proceed is not None and roughly:
            stop, proceed = not proceed(state.position), None
        done = residual < tolerance and off < force_tolerance and not stop
        if done and held is None and state.solution.violations > VIOLATIONS_ALLOWED * full.size:
            done, frozen, release = False, None, len(history) + FREEZE_AFTER
        elif frozen is None and len(history) >= release and _stagnates(history):
            frozen = full
        given_up = stuck >= UNREACHABLE_STEPS or not np.isfinite(residual)
        if done or stop or given_up or len(history) >= max_iterations:
            return ThermalFilm(
                state=state, heat=heat, viscosity=viscosity, energy=energy,
                inlet_temperature=inlet, leaving_temperature=leaving, converged=done,
                iterations=len(history), residual=residual, history=tuple(history),
            )  # fmt: skip
        mixed = mixer.next(heat.packed(position, clearance), mapped.packed(target, clearance))
        heat, following = heat.unpacked(mixed, clearance)
        if move is not None:
            allowed = move.allowed(position, following)
            if allowed != following:
                mixer.forget()
            position = allowed


def _stagnates(history: list[float]) -> bool:
    """Whether the last iterations brought little against the best before them."""
    recent = history[-STAGNATION:]
    return min(recent) > 0.5 * min(history[:-STAGNATION])


def _change(problem: FilmProblem, energy: EnergyProblem, mapped: Heat, heat: Heat) -> float:
    """Largest change of log viscosity anywhere, as the oil thins fastest; walls included.

    Where conduction across the film is strong against what flows, temperatures that hardly change
    still carry heat into walls that should take none: that counts too, relative to the dissipation.
    """
    bore, shaft = np.abs(mapped.bush - heat.bush), abs(mapped.shaft - heat.shaft)
    change = max(
        float(np.abs(mapped.temperature - heat.temperature).max()), float(bore.max()), shaft
    )
    coldest = float(mapped.temperature.min())
    near = problem.lubricant.law.viscosity(np.array([coldest, coldest + 1e-3]))
    thinning = max(float(np.log(near[0] / near[1])) / 1e-3, 1e-6)
    layers = energy.layers.pressure_share.shape[2]
    exchanged = shaft * _film_conductance(energy)
    if problem.thermal.bush is BushModel.CONDUCTION:
        exchanged += float(np.sum(2.0 * energy.conductance * bore)) / layers
    made = dissipated_power(energy)
    return max(change * thinning, HEAT_WEIGHT * exchanged / made if made > 0.0 else 0.0)


def _bush_of(problem: FilmProblem) -> BushConduction | None:
    if problem.thermal.bush is not BushModel.CONDUCTION:
        return None
    return BushConduction.of(problem)


def _through_energy(
    problem: FilmProblem,
    energy: EnergyProblem,
    viscosity: Array,
    heat: Heat,
    inlet: Array,
    bush: BushConduction | None,
    leaving: Array | None,
) -> tuple[Heat, Array]:
    """New temperatures of film, bore and shaft from the energy equation and the walls."""
    walls = wall_temperatures(problem.thermal, heat.bush, heat.shaft)
    temperature = heat.temperature.copy()
    # A film that feeds itself is marched round several times; else the fixed point does the rest.
    passes = 3 if problem.thermal.inlet is InletModel.PERIODIC else 1
    _, leaving = march(energy, viscosity, walls, inlet, temperature, passes=passes, leaving=leaving)
    shaft, bore = heat.shaft, heat.bush
    if problem.thermal.shaft is ShaftModel.INSULATED:
        conductance = _film_conductance(energy)
        if conductance > 0.0:  # a film that has run dry heats no shaft
            shaft += heat_to_shaft(energy, temperature, shaft) / conductance
    if problem.thermal.bush is BushModel.INSULATED:
        bore = temperature[:, :, 0].copy()
    elif bush is not None:
        bore = bush.respond(
            heat_to_bush(energy, temperature, walls), bore, energy, problem.topology.area
        )
    return Heat(temperature, bore, shaft), leaving


def _film_conductance(energy: EnergyProblem) -> float:
    """Conductance between the film's bulk and a wall, over the meshed part [W/K].

    A few times k area/h, a developing film's; only the speed of convergence depends on it.
    """
    layers = energy.layers.pressure_share.shape[2]
    return float(8.0 * energy.conductance.sum() / layers)
