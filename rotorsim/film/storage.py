"""Shaft, bush and pads that store heat: walls of the film over one implicit time step.

The film passes in milliseconds, the solids warm up in seconds to minutes: at each step the film is
quasi-steady between walls that store heat. The step is the second-order backward difference with
variable step (BDF2), the first one after a jump implicit Euler; both are a steady solid with heat
stored in proportion to its temperature (`rate`), about a temperature `held` from the steps before.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_banded

from ..arrays import Array
from ..model import ShaftModel
from ..model.transient import ShaftMaterial, SolidMaterial
from .bush import BushOperator
from .problem import FilmProblem
from .solution import FilmSolution
from .thd import ThermalFilm
from .walls import FilmContact, Walls, _ConductingBush, _ConductingPads, _Wall, choose_walls

_SHAFT_CELLS = 16
_HARMONICS = 16
"""Around a bush, by which its temperature is carried from one mesh to another."""


@dataclass(frozen=True)
class SolidState:
    """Temperatures of shaft and bush, or pads, at one moment.

    shaft : (cells,) array. From the axis outwards [K].
    solids : tuple of (n, m, l) arrays. Around, along, outwards: of the bush or of each pad [K];
        empty where they store nothing.
    faces : tuple of (n + 1,) arrays. Angles of their cells in the load frame [rad].
    """

    shaft: Array
    solids: tuple[Array, ...] = ()
    faces: tuple[Array, ...] = ()

    def combined(self, other: SolidState, own: float) -> SolidState:
        """Return `own` times this state plus the rest of the `other`."""
        solids = tuple(
            own * field + (1.0 - own) * _carried(before, old, new)
            for field, before, new, old in zip(
                self.solids, other.solids, self.faces, other.faces, strict=True
            )
        )
        return replace(self, shaft=own * self.shaft + (1.0 - own) * other.shaft, solids=solids)

    @property
    def over_radius(self) -> Array:
        """Mean temperatures around and along at every radius, of shaft and solids [K]."""
        means = [
            np.einsum("i,ijl->l", np.diff(faces) / (faces[-1] - faces[0]), field) / field.shape[1]
            for field, faces in zip(self.solids, self.faces, strict=True)
        ]
        return np.concatenate([self.shaft, *means])


@dataclass(frozen=True)
class HeatStorage:
    """Heat that the solids of a bearing store."""

    shaft: ShaftMaterial
    bush: SolidMaterial

    def uniform(self, problem: FilmProblem, frame: float, temperature: float) -> SolidState:
        """Return solids at one temperature [K]."""
        walls = choose_walls(problem)
        shapes = [(*op.resistance.shape, op.radii.size) for op in _operators(walls)]
        return SolidState(
            np.full(_SHAFT_CELLS, temperature),
            tuple(np.full(shape, temperature) for shape in shapes),
            _faces(problem, walls, frame),
        )

    def of_steady(self, film: ThermalFilm, frame: float) -> SolidState:
        """Return the solids of a steady film, `frame` its angle in the load frame [rad]."""
        return SolidState(
            np.full(_SHAFT_CELLS, film.heat.shaft),
            _fields(film, film.walls),
            _faces(film.state.problem, film.walls, frame),
        )


@dataclass(frozen=True)
class HeatStep:
    """The film's walls over one time step; call it with a film's problem.

    held : What the step begins from.
    rate : Of the backward difference: dT/dt = rate (T - held) [1/s].
    frame : Angle of a plain film's line of centres in the load frame, as far as known [rad]; other
        films are in the load frame.
    """

    storage: HeatStorage
    held: SolidState
    rate: float
    frame: float = 0.0

    def __call__(self, problem: FilmProblem) -> Walls:
        """Return walls that store heat in the place of those that the settings name."""
        steady = choose_walls(problem)
        shaft, bush = steady.shaft, steady.bush
        if problem.thermal.shaft is ShaftModel.INSULATED:
            shaft = _StoringShaft.of(problem, self)
        if self.held.solids:
            frame = self.frame if problem.bearing.is_plain else 0.0
            fields = [
                _carried(field, old, new)
                for field, old, new in zip(
                    self.held.solids, self.held.faces, _faces(problem, steady, frame), strict=True
                )
            ]
            rate = self.rate * self.storage.bush.capacity
            ambient = problem.thermal.ambient_temperature
            operators = tuple(
                operator.step(rate, operator.to_modes(field - ambient))
                for operator, field in zip(_operators(steady), fields, strict=True)
            )
            if isinstance(bush, _ConductingPads):
                bush = replace(bush, operators=operators)
            elif isinstance(bush, _ConductingBush):
                bush = replace(bush, operator=operators[0])
        return replace(steady, bush=bush, shaft=shaft)

    def end(self, solution: FilmSolution) -> SolidState:
        """Return the solids at the end of the step, whose film is `solution`."""
        film = solution.thermal
        assert film is not None
        problem = film.state.problem
        shaft = np.full(_SHAFT_CELLS, film.heat.shaft)
        if isinstance(film.walls.shaft, _StoringShaft):
            shaft = film.walls.shaft.profile(film.heat.shaft)
        frame = self.frame if problem.bearing.is_plain else 0.0
        return SolidState(shaft, _fields(film, film.walls), _faces(problem, film.walls, frame))


@dataclass(frozen=True)
class _StoringShaft(_Wall):
    """A shaft that stores heat, one temperature around and along, over a time step.

    per_watt : (cells,) array. Rise of its cells at the step's end per heat from the meshed part of
        the film [K/W].
    rest : (cells,) array. Temperature at the step's end without heat [K].
    skin : Resistance from the outermost cell's centre to the surface [K/W].
    """

    per_watt: Array
    rest: Array
    skin: float
    shares: Array
    """Of the cells in the volume."""
    floats = True

    @classmethod
    def of(cls, problem: FilmProblem, step: HeatStep) -> _StoringShaft:
        """Build the shaft of a film problem."""
        material, radius = step.storage.shaft, problem.bearing.journal_radius
        length = material.length or problem.bearing.length
        faces = np.linspace(0.0, radius, _SHAFT_CELLS + 1)
        volume = math.pi * np.diff(faces**2) * length
        size = faces[1]
        links = material.conductivity * 2.0 * math.pi * faces[1:-1] * length / size
        stored = step.rate * material.capacity * volume
        bands = np.zeros((3, _SHAFT_CELLS))
        bands[1] = stored
        bands[1, :-1] += links
        bands[1, 1:] += links
        bands[0, 1:] = bands[2, :-1] = -links
        heated = np.zeros(_SHAFT_CELLS)
        heated[-1] = problem.mesh.multiplicity
        answers = solve_banded((1, 1), bands, np.stack([heated, stored * step.held.shaft], axis=1))
        skin = 0.5 * size / (material.conductivity * 2.0 * math.pi * radius * length)
        return cls(
            float(answers[-1, 1]), answers[:, 0], answers[:, 1],
            skin * problem.mesh.multiplicity, volume / volume.sum(),
        )  # fmt: skip

    def _heat_under(self, surface: float) -> float:
        """Return the heat that it takes at that surface temperature, from the meshed part [W]."""
        return (surface - float(self.rest[-1])) / (float(self.per_watt[-1]) + self.skin)

    def profile(self, surface: float) -> Array:
        """Return the cells' temperatures [K]."""
        return self.rest + self.per_watt * self._heat_under(surface)

    def bodies(self, temperature: Array, /) -> Array:
        """Return the mean temperature."""
        return np.array([[float(self.shares @ self.profile(float(temperature))), 0.0]])

    def respond(self, temperature: Array, contact: FilmContact, /) -> Array:
        """Return the surface temperature at which film and shaft agree on the heat."""
        film = self.exchange(contact)
        own = 1.0 / (float(self.per_watt[-1]) + self.skin)
        missing = self.heat(temperature, contact).sum() - self._heat_under(float(temperature))
        return np.asarray(temperature + missing / (film + own))

    def exchange(self, contact: FilmContact, /) -> float:
        """Return how the film's heat follows the shaft, estimated."""
        into = float(8.0 * contact.bulk.sum())
        if not (into > 0.0 and contact.elsewhere > 0.0):
            return into
        return max(1.0 / (1.0 / into + 1.0 / contact.elsewhere), 0.05 * into)


def _operators(walls: Walls) -> tuple[BushOperator, ...]:
    if isinstance(walls.bush, _ConductingPads):
        return walls.bush.operators
    return (walls.bush.operator,) if isinstance(walls.bush, _ConductingBush) else ()


def _faces(problem: FilmProblem, walls: Walls, frame: float) -> tuple[Array, ...]:
    """Return the angles of the solids' cells in the load frame."""
    if not _operators(walls):
        return ()
    theta = problem.mesh.theta_faces
    if not walls.pads:
        return (theta + frame,)
    places = [np.flatnonzero(own) for own in walls.pads]
    return tuple(theta[own[0] : own[-1] + 2] for own in places)


def _fields(film: ThermalFilm, walls: Walls) -> tuple[Array, ...]:
    """Return the temperatures of bush or pads under a film [K]."""
    bore, ambient = film.heat.bush, film.state.problem.thermal.ambient_temperature
    columns = walls.pads or (np.ones(bore.shape[0], dtype=bool),)
    operators = _operators(walls)
    if not operators:
        return ()
    return tuple(
        ambient + operator.of_modes(operator.modes_under(bore[own] - ambient))
        for own, operator in zip(columns, operators, strict=True)
    )


def _carried(field: Array, old: Array, new: Array) -> Array:
    """Return a field around a bush, (n, m, l), on the cells of other faces.

    By its first harmonics, fitted to the cells' means: the mean stays what it is.
    """
    if old.size == new.size and np.allclose(old, new, rtol=0.0, atol=1e-12):
        return field
    count = min(_HARMONICS, (old.size - 2) // 4)
    means = np.linalg.lstsq(_means(old, count), field.reshape(field.shape[0], -1), rcond=None)[0]
    return (_means(new, count) @ means).reshape(-1, *field.shape[1:])


def _means(faces: Array, count: int) -> Array:
    """Return the means of 1, cos k theta, sin k theta over each cell, (n, 2 count + 1)."""
    columns, size = [np.ones(faces.size - 1)], np.diff(faces)
    for k in range(1, count + 1):
        columns.append(np.diff(np.sin(k * faces)) / (k * size))
        columns.append(-np.diff(np.cos(k * faces)) / (k * size))
    return np.stack(columns, axis=1)
