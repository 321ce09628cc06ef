"""Where to look for an equilibrium that Newton's method did not find, and whether there is one.

A film may carry nothing over part of the clearance (a mass-conserving film behind a groove at
ambient pressure runs dry wherever the bearing opens from the groove's edge on), and its force may
have kinks: Newton's method then has no direction to go, or circles. The force is looked up at
positions all over the clearance, on a coarse mesh; the search begins again from those whose force
comes nearest to the load. Whether the film carries the load anywhere is decided by the rim of the
positions that leave a film: where the unbalanced force, followed once round the rim, turns round
as often as not, no position inside need balance it (the degree of a map; see Ortega & Rheinboldt,
Iterative Solution of Nonlinear Equations, 1970, ch. 6).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..model import Case, EccentricityTarget, LoadTarget
from .banded import NoFilmError, SingularFilmError
from .equilibrium import CLEARANCE_KEPT
from .geometry import bore_offset, rotation
from .layers import isoviscous_layers
from .mesh import groove_edges, in_full_groove
from .problem import film_problem, film_state

Array = NDArray[np.float64]
_Position = tuple[float, float]

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
_JUMP = 0.95 * math.pi
"""Turn between the closest neighbours up to which a jump of the force counts as a turn."""
_RIM_POINTS = 1440
"""Angles at which the room for the journal is looked up."""


@dataclass(frozen=True)
class ForceField:
    """The isothermal film's force [N] at any position [m], on a coarse mesh; load frame.

    Attributes
    ----------
    case : Case
        On the coarse mesh.
    speed : float
        [rad/s]
    normals : (2, t) array
        Directions in which metal lies.
    room : (t,) array
        Film thickness there with the journal centred, at the end where it is thinner [m].
    """

    case: Case
    speed: float
    normals: Array
    room: Array

    @classmethod
    def of(cls, case: Case, speed: float) -> ForceField:
        """Force field of the case's bearing at `speed` [rad/s]."""
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
        turn = rotation(frame)
        x, y = turn.T @ position
        viscosity = float(self.case.lubricant.viscosity(self.case.thermal.supply_temperature))
        problem = film_problem(self.case, self.speed, bearing.turned(-frame), (float(x), float(y)))
        layers = isoviscous_layers(problem.mesh.shape, viscosity)
        with suppress(NoFilmError, SingularFilmError):
            state = film_state(problem, (x, y), layers)
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


def balances_somewhere(field: ForceField, load: float) -> bool | None:
    """Whether some position must balance `load` [N] along x; None where that remains open.

    True if the unbalanced force turns round along the rim of the clearance; False if it does not,
    though then two positions, one of them unstable, might balance it.
    """
    angles = [2.0 * math.pi * k / _ANGLES for k in range(_ANGLES + 1)]
    directions = [_unbalanced(field, angle, load) for angle in angles]
    directions[-1] = directions[0]
    total = 0.0
    for here, there, first, last in zip(
        angles[:-1], angles[1:], directions[:-1], directions[1:], strict=True
    ):
        turn = _turn_between(field, load, (here, first), (there, last), _RIM_SPLITS)
        if turn is None:
            return None
        total += turn
    return round(total / (2.0 * math.pi)) != 0


def _unbalanced(field: ForceField, angle: float, load: float) -> float | None:
    """Direction of film force plus load where the film is thinnest allowed, along `angle`."""
    reach = field.reach(angle, CLEARANCE_KEPT * field.case.bearing.radial_clearance)
    force = field.force((reach * math.cos(angle), reach * math.sin(angle)))
    return None if force is None else math.atan2(force[1], force[0] + load)


def _turn_between(
    field: ForceField,
    load: float,
    start: tuple[float, float | None],
    end: tuple[float, float | None],
    splits: int,
) -> float | None:
    """Turn of the unbalanced force from one angle of the rim to another [rad]."""
    (here, first), (there, last) = start, end
    if first is None or last is None:
        return None
    turn = math.remainder(last - first, 2.0 * math.pi)
    if abs(turn) <= _TURN:
        return turn
    if splits == 0:
        return turn if abs(turn) <= _JUMP else None
    middle = 0.5 * (here + there), _unbalanced(field, 0.5 * (here + there), load)
    parts = (
        _turn_between(field, load, start, middle, splits - 1),
        _turn_between(field, load, middle, end, splits - 1),
    )
    return None if parts[0] is None or parts[1] is None else parts[0] + parts[1]
