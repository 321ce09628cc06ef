"""Search for an equilibrium that Newton's method did not find, or for a proof that none exists.

A film may carry nothing over part of the clearance (a mass-conserving film behind a groove at
ambient pressure runs dry wherever the bearing opens from the groove's edge on), and its force may
have kinks: Newton's method then has no direction to go, or circles. The force is looked up at
positions all over the clearance, on a coarse mesh; the search begins again from those whose force
comes nearest to the load. Whether the film carries the load anywhere is decided by the rim of the
positions that leave a film: unless the unbalanced force, followed once round the rim, turns round,
no position inside need balance it (the degree of a map; see Ortega & Rheinboldt, Iterative Solution
of Nonlinear Equations, 1970, ch. 6). Where it turns, halving the region finds the place.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..arrays import Array
from ..model import Case, EccentricityTarget, LoadTarget
from .banded import NoFilmError, SingularFilmError
from .equilibrium import CLEARANCE_KEPT
from .geometry import bore_offset, rotation
from .mesh import groove_edges, in_full_groove
from .problem import FilmProblem, film_problem, film_state, supply_layers

_Position = tuple[float, float]
_Corner = tuple[float, float]
"""Share of the way to the bore, and angle [rad]."""

_COARSE = (72, 12)
_ANGLES = 24
_SHARES = (0.2, 0.45, 0.65, 0.8, 0.9, 0.96, 0.99)
"""Of the way from the centre to the bore, along each angle."""
_TRIALS = 5
_DIRECTION_WEIGHT = 3.0
"""A force a third of a radian off the load line counts as much as one 2.7 times too large."""
_NOTHING = 1e-9
"""Force over load below which Newton's method has no direction to go."""
_TURN = 0.5 * math.pi
"""Largest turn of the force between neighbours on the rim."""
_RIM_SPLITS = 7
"""Times that an angle between neighbours on the rim may be halved."""
_LEAST_PIECES = 4
"""Pieces of an edge along which the force is followed at first."""
_CENTRE = 1e-5
"""Share of the way to the bore that stands for the centre, where a film's beginning may jump."""
_CLOSEST = 1e-6
"""Shares, and angles [rad], down to which the clearance is halved."""
_NEAR = (0.03, 0.15)
"""Half sizes, in shares of the way to the bore, of the regions around a position known roughly."""
_ATTITUDES = 72
_HALVINGS = 30
_MOST_CELLS = 2_000_000
"""Cells of all the films that a search without Newton's method may solve: some 10 s."""
_RIM_POINTS = 1440
"""Angles at which the room for the journal is looked up."""


@dataclass(frozen=True)
class ForceField:
    """The isothermal film's force [N] at any position [m], on a coarse mesh; load frame.

    case : On the coarse mesh.
    speed : [rad/s]
    normals : (2, t) array. Directions in which metal lies.
    room : (t,) array. Film thickness there with the journal centred, at the end where it is thinner
        [m].
    mesh : Problem and angle of its frame from the load line [rad], taken at any position instead.
    """

    case: Case
    speed: float
    normals: Array
    room: Array
    mesh: tuple[FilmProblem, float] | None = None

    @classmethod
    def of(cls, case: Case, speed: float) -> ForceField:
        """Return the force field of the case's bearing at `speed` [rad/s]."""
        mesh, (around, along) = case.film.mesh, _COARSE
        coarse = replace(
            mesh,
            circumferential=min(mesh.circumferential, around),
            axial=min(mesh.axial, along),
        )
        bearing = case.bearing
        theta = np.linspace(0.0, 2.0 * math.pi, _RIM_POINTS, endpoint=False)
        edges = [edge for groove in bearing.grooves for edge in groove_edges(groove)]
        theta = np.append(theta[~in_full_groove(bearing, theta)], edges)
        normals = np.stack([np.cos(theta), np.sin(theta)])
        aside = np.abs(np.array(bearing.misalignment) @ normals) * 0.5 * bearing.length
        room = bearing.radial_clearance + bore_offset(bearing, theta) - aside
        return cls(replace(case, film=replace(case.film, mesh=coarse)), speed, normals, room)

    def force(self, position: _Position) -> Array | None:
        """Return the force at `position`; None where it cannot be solved for."""
        bearing = self.case.bearing
        frame = math.atan2(position[1], position[0]) if bearing.is_plain else 0.0
        frame = frame if self.mesh is None else self.mesh[1]
        turn = rotation(frame)
        x, y = turn.T @ position
        if self.mesh is None:
            own = bearing.turned(-frame)
            problem = film_problem(self.case, self.speed, own, (float(x), float(y)))
        else:
            problem = self.mesh[0]
        with suppress(NoFilmError, SingularFilmError):
            state = film_state(problem, (x, y), supply_layers(problem))
            if state.solution.converged and np.all(np.isfinite(state.force)):
                return turn @ state.force
        return None

    def reach(self, angle: float, least: float = 0.0) -> float:
        """Return how far from the centre a film of `least` [m] remains, in the direction `angle`.

        0 where not even the centre leaves one.
        """
        towards = np.array([math.cos(angle), math.sin(angle)]) @ self.normals
        near = towards > 1e-9
        return max(float(((self.room[near] - least) / towards[near]).min()), 0.0)


def first_positions(field: ForceField) -> list[_Position]:
    """Return positions [m] from which a search for the equilibrium may begin, the best one first.

    Empty where the film carries nothing at any position of the grid.
    """
    target = field.case.target
    found: list[tuple[float, float, _Position]] = []
    for position in _places(field):
        force = field.force(position)
        size = 0.0 if force is None else float(np.hypot(*force))
        if force is None or not size > 0.0:
            continue
        misfit = missing = _DIRECTION_WEIGHT * math.atan2(-force[1], -force[0])
        if isinstance(target, LoadTarget):
            if size < _NOTHING * target.load:
                continue
            aside = math.log(size / target.load) if target.load > 0.0 else size
            misfit = math.hypot(misfit, aside)
            missing = math.hypot(force[0] + target.load, force[1])
        found.append((abs(misfit), abs(missing), position))
    nearest = sorted(found)[:_TRIALS]
    closest = sorted(found, key=lambda entry: entry[1])[:_TRIALS]
    return list(dict.fromkeys(entry[2] for entry in nearest + closest))


def _places(field: ForceField) -> Iterator[_Position]:
    target = field.case.target
    for angle in 2.0 * math.pi / _ANGLES * np.arange(_ANGLES):
        x, y = math.cos(angle), math.sin(angle)
        if isinstance(target, EccentricityTarget):
            size = target.eccentricity_ratio * field.case.bearing.radial_clearance
            yield size * x, size * y
            continue
        reach = field.reach(angle)
        for share in _SHARES:
            yield share * reach * x, share * reach * y


@dataclass(frozen=True)
class Crossing:
    """Place round which the unbalanced force turns: the equilibrium, or where the force jumps.

    position : [m], load frame.
    off : Unbalanced force next to it, relative to the load (radians at a given eccentricity): small
        at an equilibrium. NaN where the force could not be followed.
    """

    position: _Position
    off: float


def crossing(field: ForceField, near: _Position | None = None) -> Crossing | None:
    """Return where the film must balance the load, sought without Newton's method.

    `near` a position [m] first, if given.

    None where the unbalanced force does not turn round along the rim of the clearance (none of the
    attitudes at a given eccentricity brings it to the load line); two positions, one of them
    unstable, might balance the load even then.
    """
    if isinstance(field.case.target, EccentricityTarget):
        return _balanced_attitude(field, field.case.target)
    search = _TurningSearch(field)
    try:
        return search.narrowed(near)
    except NoFilmError:
        return Crossing(search.place(search.nearest(search.known)), math.nan)


def _balanced_attitude(field: ForceField, target: EccentricityTarget) -> Crossing | None:
    """Halve the stretch of attitudes in which the force passes the load line."""
    size = target.eccentricity_ratio * field.case.bearing.radial_clearance

    def place(angle: float) -> _Position:
        return size * math.cos(angle), size * math.sin(angle)

    def direction(angle: float) -> float:
        force = field.force(place(angle))
        return math.nan if force is None or not force.any() else math.atan2(-force[1], -force[0])

    angles = 2.0 * math.pi / _ATTITUDES * np.arange(_ATTITUDES + 1)
    found = [(float(angle), direction(float(angle))) for angle in angles]
    best = None
    for (low, first), (high, last) in pairwise(found):
        if not (first * last <= 0.0 and abs(first - last) < math.pi):
            continue
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            value = direction(middle)
            if value * first > 0.0:
                low, first = middle, value
            else:
                high, last = middle, value
        off = min(abs(first), abs(last))
        if best is None or off < best.off:
            best = Crossing(place(low if off == abs(first) else high), off)
    return best


class _TurningSearch:
    """Halves the clearance, in angle and share of the way to the bore, where the force turns.

    The unbalanced force, followed round a region, turns as often as there are equilibria in it,
    counted with their sign (the degree of the map); of two halves one keeps a turn. This needs no
    derivative, passes kinks, and ends at the equilibrium or where the force jumps across the load.
    """

    def __init__(self, field: ForceField) -> None:
        target = field.case.target
        assert isinstance(target, LoadTarget)
        self.field, self.load = field, target.load
        self.least = CLEARANCE_KEPT * field.case.bearing.radial_clearance
        self.known: dict[_Corner, Array] = {}
        mesh = field.case.film.mesh
        cells = mesh.circumferential * mesh.axial
        self.most = _MOST_CELLS // (
            cells if field.mesh is None else math.prod(field.mesh[0].mesh.shape)
        )
        self.scale = target.load or max(
            float(np.hypot(*self.unbalanced((share, angle))))
            for share in (0.3, 0.9)
            for angle in (0.0, 2.0, 4.0)
        )

    def narrowed(self, near: _Position | None) -> Crossing | None:
        """Return the crossing, or None without one."""
        for low, high in self.regions(near):
            if round(self.turns(low, high)):
                break
        else:
            return self.jump_at_centre()
        while high[0] - low[0] > _CLOSEST or high[1] - low[1] > _CLOSEST:
            across = (high[1] - low[1]) / math.pi > high[0] - low[0]
            part = (low[1] + high[1]) / 2.0 if across else (low[0] + high[0]) / 2.0
            upper = (high[0], part) if across else (part, high[1])
            lower = (low[0], part) if across else (part, low[1])
            if round(self.turns(low, upper)):
                high = upper
            elif round(self.turns(lower, high)):
                low = lower
            else:
                break  # lost between the points that were looked at
        corners = [(share, angle) for share in (low[0], high[0]) for angle in (low[1], high[1])]
        best = self.nearest(corners)
        return Crossing(self.place(best), float(np.hypot(*self.unbalanced(best))) / self.scale)

    def nearest(self, corners: Iterable[_Corner]) -> _Corner:
        """Return the corner with the least unbalanced force; the centre without any."""
        least = {corner: float(np.hypot(*self.unbalanced(corner))) for corner in corners}
        return min(least, key=least.__getitem__, default=(0.0, 0.0))

    def regions(self, near: _Position | None) -> Iterator[tuple[_Corner, _Corner]]:
        """Return regions to look at, between two corners.

        Around a position, then the whole clearance.
        """
        if near is not None:
            angle = math.atan2(near[1], near[0])
            share = math.hypot(*near) / self.field.reach(angle, self.least)
            for size in _NEAR:
                low = max(share - size, _CENTRE), angle - 3.0 * size
                yield low, (min(share + size, 1.0), angle + 3.0 * size)
        yield (_CENTRE, 0.0), (1.0, 2.0 * math.pi)

    def jump_at_centre(self) -> Crossing | None:
        """Search where the film's beginning jumps as the journal passes the centre."""
        ring = [(_CENTRE, angle) for angle in np.linspace(0.0, 2.0 * math.pi, _ANGLES + 1).tolist()]
        if not round(sum(self.turn(*pair, _RIM_SPLITS) for pair in pairwise(ring)) / math.tau):
            return None
        off = min(float(np.hypot(*self.unbalanced(at))) for at in ring)
        return Crossing((0.0, 0.0), max(off / self.scale, 1.0))

    def place(self, at: _Corner) -> _Position:
        """Return the position [m] at a share of the way to the bore and an angle."""
        share, angle = at
        size = share * self.field.reach(angle, self.least)
        return size * math.cos(angle), size * math.sin(angle)

    def unbalanced(self, at: _Corner) -> Array:
        """Return the film force plus load [N]."""
        if at not in self.known:
            if len(self.known) >= self.most:
                raise NoFilmError("too many films for one search")
            force = self.field.force(self.place(at))
            if force is None:
                raise NoFilmError("the film's force is not known there")
            self.known[at] = force + np.array([self.load, 0.0])
        return self.known[at]

    def turns(self, low: _Corner, high: _Corner) -> float:
        """Return the turns of the unbalanced force round a region of shares and angles."""
        corners = [low, (high[0], low[1]), high, (low[0], high[1]), low]
        total = 0.0
        for start, end in pairwise(corners):
            span = abs(end[1] - start[1])
            pieces = max(_LEAST_PIECES, round(span * _ANGLES / (2.0 * math.pi)))
            shares = np.linspace(start[0], end[0], pieces + 1).tolist()
            angles = np.linspace(start[1], end[1], pieces + 1).tolist()
            for here, there in pairwise(zip(shares, angles, strict=True)):
                total += self.turn(here, there, _RIM_SPLITS)
        return total / (2.0 * math.pi)

    def turn(self, here: _Corner, there: _Corner, splits: int) -> float:
        """Return the turn of the unbalanced force from one point to another [rad]."""
        first, last = self.unbalanced(here), self.unbalanced(there)
        turn = math.atan2(first[0] * last[1] - first[1] * last[0], float(first @ last))
        if abs(turn) <= _TURN or splits == 0:
            return turn
        middle = (0.5 * (here[0] + there[0]), 0.5 * (here[1] + there[1]))
        return self.turn(here, middle, splits - 1) + self.turn(middle, there, splits - 1)
