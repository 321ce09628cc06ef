"""What is known of a neighbouring film: where the search for the next one begins.

A mesh follows the journal, and cells at a groove's edge may belong to the groove on the next one:
temperatures and full cells are therefore carried along angle and length from one mesh to another,
each stretch of film from its own cells.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Booleans, Indices
from .heat import Heat
from .mesh import FilmMesh
from .problem import FilmProblem, FilmState

Position = tuple[float, float]
"""Of the journal's centre, along x and y."""
_TURN = 2.0 * math.pi


@dataclass(frozen=True)
class WarmStart:
    """First guess for the next speed; picklable.

    position : Journal centre over the radial clearance, load frame.
    full : (n, m) bool array or None. Cells of full film.
    mesh : On which `heat` and `full` are known.
    pads : array or None. Displacements of tilting pads, after the journal's, over the radial
        clearance.
    """

    position: Position
    heat: Heat | None = None
    full: Booleans | None = None
    mesh: FilmMesh | None = None
    pads: Array | None = None

    @classmethod
    def of(cls, state: FilmState, heat: Heat | None, frame: float = 0.0) -> WarmStart:
        """Return what is known of a film whose frame stands at `frame` [rad] from the load line."""
        place, problem = relative_displacement(state), state.problem
        return cls(
            position=turned(pair(place), frame), heat=heat, full=state.solution.full,
            mesh=problem.mesh, pads=place[2:] if problem.bearing.pads else None,
        )  # fmt: skip

    def heat_on(self, problem: FilmProblem) -> Heat | None:
        """Return the temperatures on the mesh of `problem`; None without any."""
        heat, old, mesh = self.heat, self.mesh, problem.mesh
        if heat is None or old is None:
            return None
        if mesh is old:
            return heat
        layers = problem.settings.mesh.cross_film
        around, along = _around(mesh, old), _between(mesh.y, old.y)
        k = heat.temperature.shape[2]
        across = _between((np.arange(layers) + 0.5) / layers, (np.arange(k) + 0.5) / k)
        film = _taken(_taken(heat.temperature, around, 0), along, 1)
        bush = _taken(_taken(heat.bush, around, 0), along, 1)
        return Heat(np.ascontiguousarray(_taken(film, across, 2)), bush, heat.shaft)

    def full_on(self, problem: FilmProblem) -> Booleans | None:
        """Return the full cells on the mesh of `problem`; None where they are not known."""
        full, old, mesh = self.full, self.mesh, problem.mesh
        if full is None or old is None:
            return None
        (lower, upper, share), (south, north, along) = _around(mesh, old), _between(mesh.y, old.y)
        return full[np.where(share < 0.5, lower, upper)][:, np.where(along < 0.5, south, north)]


def relative_displacement(state: FilmState) -> Array:
    """Return the displacements over the (hot) radial clearance, (q,)."""
    return state.displacement / state.problem.bearing.radial_clearance


def pair(displacement: Array) -> Position:
    """Return the journal's position, the first two of its film's displacements."""
    return float(displacement[0]), float(displacement[1])


def turned(position: Position, angle: float) -> Position:
    """Return a position in a frame that stands back by `angle` [rad]."""
    cos, sin = math.cos(angle), math.sin(angle)
    return position[0] * cos - position[1] * sin, position[0] * sin + position[1] * cos


_Places = tuple[Indices, Indices, Array]
"""Neighbours of each place below and above, and its share of the way from one to the other."""


def _taken(field: NDArray[Any], places: _Places, axis: int) -> NDArray[Any]:
    """Interpolate along one axis."""
    lower, upper, share = places
    if np.array_equal(lower + share, np.arange(field.shape[axis])):
        return field
    below, above = np.take(field, lower, axis), np.take(field, upper, axis)
    return below + (above - below) * share.reshape((-1,) + (1,) * (field.ndim - 1 - axis))


def _between(new: Array, old: Array) -> _Places:
    """Return the places of `new` among `old`, both ascending; outside the nearest counts."""
    at = np.interp(new, old, np.arange(float(old.size)))
    lower = np.minimum(at.astype(np.int64), old.size - 1)
    return lower, np.minimum(lower + 1, old.size - 1), at - lower


def _around(mesh: FilmMesh, old: FilmMesh) -> _Places:
    """Return the places of the columns of `mesh` among those of `old`.

    Of the same stretch, if both meshes have the same ones.
    """
    n = mesh.theta.size
    lower, upper, share = np.zeros(n, np.int64), np.zeros(n, np.int64), np.zeros(n)
    numbers = np.unique(mesh.region)
    alike = np.array_equal(numbers, np.unique(old.region))
    for number in numbers:
        here = np.flatnonzero(mesh.region == number)
        there = np.flatnonzero(old.region == number) if alike else np.arange(old.theta.size)
        there = there[np.argsort(old.theta[there] % _TURN)]
        angles = old.theta[there] % _TURN
        after = np.searchsorted(angles, mesh.theta[here] % _TURN, side="right") % there.size
        before = (after - 1) % there.size
        gap = (angles[after] - angles[before]) % _TURN
        passed = (mesh.theta[here] - angles[before]) % _TURN
        lower[here], upper[here] = there[before], there[after]
        share[here] = np.divide(passed, gap, out=np.zeros(here.size), where=gap > 0.0)
    return lower, upper, share
