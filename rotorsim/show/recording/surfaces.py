"""Shapes for the 3-D views, as arrays: vertices, triangles and colours. No viewer in here.

Lengths are millimetres. The axes are those of the load frame: x along the load, y 90 degrees
ahead, z along the shaft.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...arrays import Array
from ...film.geometry import pad_face
from ...study.orbits import FilmFrame

MILLI = 1e3
_AROUND, _ALONG = 96, 16
"""Display grid: cells around and along the bearing (the films' own grids may differ)."""
DRAWN_CLEARANCE = 0.22
"""Clearance as drawn, in journal radii."""
PRESSURE_HEIGHT = 0.55
"""Height of the largest pressure, in journal radii."""
_UNWRAPPED_STRETCH = 1.8
"""Heights of the rolled-out film are drawn larger by this."""


def display_grid(film: FilmFrame) -> tuple[Array, Array]:
    """Return the grid on which a film is shown, closed around the turn and at both ends.

    Returns (AROUND + 1,), (ALONG + 1,) arrays: Angles -pi to pi, the load line in the middle [rad];
        places -L/2 to L/2 [mm].
    """
    half = 0.5 * film.length * MILLI
    return np.linspace(-np.pi, np.pi, _AROUND + 1), np.linspace(-half, half, _ALONG + 1)


def on_display_grid(film: FilmFrame, values: Array, at_ends: float | None) -> Array:
    """Interpolate a film field (n, m) to the display grid.

    values : (n, m) array
    at_ends : Known value at both ends of the bearing (ambient pressure: 0); None holds the last
        cell's.
    Returns (AROUND + 1, ALONG + 1) array: First and last row are the same place.
    """
    angle, place = display_grid(film)
    turned = np.mod(film.theta + np.pi, 2.0 * np.pi) - np.pi
    order = np.argsort(turned)
    theta = turned[order]
    around = _linear(angle, theta, values[order], period=2.0 * np.pi)
    y, across = film.y * MILLI, around.T
    if at_ends is not None:
        border = np.full((1, across.shape[1]), at_ends)
        y = np.concatenate([place[:1], y, place[-1:]])
        across = np.concatenate([border, across, border])
    return _linear(place, y, across).T


def _linear(wanted: Array, known: Array, values: Array, period: float | None = None) -> Array:
    if period is not None:
        known = np.concatenate([known[-1:] - period, known, known[:1] + period])
        values = np.concatenate([values[-1:], values, values[:1]])
    upper = np.clip(np.searchsorted(known, wanted), 1, known.size - 1)
    lower = upper - 1
    weight = np.clip((wanted - known[lower]) / (known[upper] - known[lower]), 0.0, 1.0)[:, None]
    return (1.0 - weight) * values[lower] + weight * values[upper]


def bore_radius(journal_radius: float) -> float:
    """Return the radius of the bush as drawn [mm], from the journal's [m]."""
    return journal_radius * MILLI * (1.0 + DRAWN_CLEARANCE)


def _face_radius(film: FilmFrame, angle: Array) -> Array:
    """Return the radius [mm], as drawn, of the wall around the film at `angle` [rad].

    Of the bore; between pads of their faces as they stand, joined over the openings.
    """
    if film.bearing is None:
        return np.full(angle.shape, bore_radius(film.journal_radius))
    known, radii = [], []
    for pad, tilt, pivot in zip(film.bearing.pads, film.tilts, film.pivots, strict=True):
        inside = np.linspace(pad.leading_edge, pad.trailing_edge, 25)
        known.append(inside)
        radii.append(pad_face(film.bearing, pad, inside, tilt, pivot))
    face = np.interp(angle, np.concatenate(known), np.concatenate(radii), period=2.0 * np.pi)
    return MILLI * (film.journal_radius + exaggeration(film) * face)


def pad_outlines(film: FilmFrame) -> list[Array]:
    """Return lines around each pad at both ends, and along its four edges [mm], as drawn."""
    assert film.bearing is not None
    half, lines = 0.5 * film.length * MILLI, []
    for pad, tilt, pivot in zip(film.bearing.pads, film.tilts, film.pivots, strict=True):
        angle = np.linspace(pad.leading_edge, pad.trailing_edge, 21)
        face = exaggeration(film) * pad_face(film.bearing, pad, angle, tilt, pivot)
        moved = face - exaggeration(film) * pad_face(film.bearing, pad, angle)
        back = pad.thickness + DRAWN_CLEARANCE * film.journal_radius + moved
        radius = film.journal_radius + np.concatenate([face, back[::-1], face[:1]])
        around = np.concatenate([angle, angle[::-1], angle[:1]])
        ring = MILLI * radius[:, None] * np.column_stack([np.cos(around), np.sin(around)])
        ends = [np.column_stack([ring, np.full(len(ring), z)]) for z in (-half, half)]
        edges = [0, angle.size - 1, angle.size, -2]
        lines += [*ends, *(np.stack([end[place] for end in ends]) for place in edges)]
    return lines


def exaggeration(film: FilmFrame) -> float:
    """Return how many times larger than true the clearance is drawn."""
    return DRAWN_CLEARANCE * film.journal_radius / film.radial_clearance


def wrapped(film: FilmFrame, height: Array) -> Array:
    """Return the film round the bore: vertices (AROUND + 1)*(ALONG + 1) x 3.

    height : (AROUND + 1, ALONG + 1) array. Radial displacement in journal radii.
    """
    angle, place = display_grid(film)
    radius = _face_radius(film, angle)[:, None] + height * film.journal_radius * MILLI
    x = radius * np.cos(angle)[:, None]
    y = radius * np.sin(angle)[:, None]
    z = np.broadcast_to(place, x.shape)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3)


def unwrapped(film: FilmFrame, height: Array) -> Array:
    """Return film rolled out: angle times radius along x, height along y, axial along z [mm]."""
    angle, place = display_grid(film)
    radius = film.journal_radius * MILLI
    x = np.broadcast_to(angle[:, None] * radius, height.shape)
    z = np.broadcast_to(place, height.shape)
    return np.stack([x, _UNWRAPPED_STRETCH * height * radius, z], axis=-1).reshape(-1, 3)


def grid_triangles(rows: int = _AROUND + 1, columns: int = _ALONG + 1) -> NDArray[np.uint32]:
    """Return two triangles for every cell of a (rows, columns) vertex grid."""
    first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1)
    a, b, c, d = first, first + 1, first + columns, first + columns + 1
    return np.concatenate([np.stack([a, c, b], -1), np.stack([b, c, d], -1)]).astype(np.uint32)


def cylinder(
    radius: float, half_length: float, sides: int = 72
) -> tuple[Array, NDArray[np.uint32], Array]:
    """Build a closed cylinder about z: vertices, triangles, vertex normals."""
    turn = np.linspace(0.0, 2.0 * np.pi, sides + 1)
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    parts, normals = [], []
    for z in (-half_length, half_length):
        parts.append(np.column_stack([radius * ring, np.full(sides + 1, z)]))
        normals.append(np.column_stack([ring, np.zeros(sides + 1)]))
    triangles: list[NDArray[np.integer]] = [grid_triangles(2, sides + 1)]
    for z, sign in ((-half_length, -1.0), (half_length, 1.0)):
        base = sum(len(part) for part in parts)
        parts.append(
            np.vstack([[0.0, 0.0, z], np.column_stack([radius * ring, np.full(sides + 1, z)])])
        )
        normals.append(np.tile([0.0, 0.0, sign], (sides + 2, 1)))
        around = np.arange(1, sides + 1)
        triangles.append(base + np.stack([np.zeros_like(around), around, around + 1], axis=-1))
    return np.vstack(parts), np.vstack(triangles).astype(np.uint32), np.vstack(normals)


def circle(radius: float, z: float, count: int = 121) -> Array:
    """Return points of a circle about z."""
    turn = np.linspace(0.0, 2.0 * np.pi, count)
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.full(count, z)])


def ribbon(low: ArrayLike, high: ArrayLike, across: ArrayLike, steps: int = 64) -> Array:
    """Return vertices of a colour bar.

    A strip from `low` to `high`, `across` wide, (2*steps, 3).
    """
    low, high, across = (np.asarray(v, float) for v in (low, high, across))
    along = low + np.linspace(0.0, 1.0, steps)[:, None] * (high - low)
    return np.stack([along, along + across], axis=1).reshape(-1, 3)
