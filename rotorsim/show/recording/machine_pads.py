"""Tilting pads of a machine in three dimensions: solids on their pivots, tilting in time."""

from __future__ import annotations

import numpy as np
import rerun as rr
from numpy.typing import ArrayLike, NDArray

from ...arrays import Array, Indices
from ...model import Pad
from .machine_view import ROOT, MachineRun, entity_name
from .runs import thin
from .surfaces import MILLI, grid_triangles

_ROWS = 64_000
"""Moments of all pads together."""
_AROUND = 24
_MOST = 0.5
"""Tilt as drawn [rad]."""
_BRONZE = (176, 141, 87)


def pad_motion(shown: MachineRun, name: str, pad: int, rows: Indices) -> tuple[Array, Array]:
    """Return how far a pad tilts [rad] and its pivot moves outwards [m] from rest, each (rows,)."""
    problem, found = shown.motion.problem, []
    for unknown in (f"tilt_{pad}", f"pivot_{pad}"):
        away = np.zeros(rows.size)
        if (name, unknown) in problem.system.names:
            row = problem.system.basis[problem.system.names.index((name, unknown))]
            away = (shown.motion.q[rows] - problem.equilibrium) @ row
        found.append(away)
    return found[0], found[1]


def log_pads(stream: rr.RecordingStream, shown: MachineRun) -> None:
    """Write the pads of all bearings, on their pivots, and their tilts as large as deflections."""
    count = sum(len(bearing.pads) for bearing in shown.padded.values())
    for name, bearing in shown.padded.items():
        at, radius = shown.motion.station(name).position, shown.face_radius(name)
        for k, pad in enumerate(bearing.pads, start=1):
            entity = f"{ROOT}/pads/{entity_name(name)}/{k}"
            vertices, normals, triangles = _solid(pad, radius, 0.5 * bearing.length, shown.side)
            stream.log(
                entity,
                rr.Mesh3D(
                    vertex_positions=vertices * MILLI, vertex_normals=normals,
                    triangle_indices=triangles, albedo_factor=_BRONZE,
                ),
                static=True,
            )  # fmt: skip
            rows = shown.rows[thin(shown.rows.size, _ROWS // count)]
            tilt, outwards = pad_motion(shown, name, k, rows)
            reach = radius + pad.thickness + shown.magnification * outwards
            where = np.outer(reach, _outwards(pad.pivot_angle, shown.side))
            where[:, 0] = at
            half = 0.5 * np.clip(shown.magnification * tilt, -_MOST, _MOST) * shown.side
            zero = np.zeros_like(half)
            turn = np.column_stack([np.sin(half), zero, zero, np.cos(half)])
            columns = rr.Transform3D.columns(
                translation=(where * MILLI).astype(np.float32), quaternion=turn.astype(np.float32)
            )
            stream.send_columns(entity, shown.index(rows), columns)


def _outwards(angle: ArrayLike, side: float) -> Array:
    """Return the directions (..., 3) from the centre: along the shaft, to the side, upwards."""
    return np.stack([np.multiply(0.0, angle), side * np.sin(angle), -np.cos(angle)], axis=-1)


def _solid(
    pad: Pad, radius: float, half: float, side: float
) -> tuple[Array, Array, NDArray[np.uint32]]:
    """Return vertices [m] about the pivot, normals and triangles of a pad.

    radius : Of its face [m].
    """
    angle = np.linspace(pad.leading_edge, pad.trailing_edge, _AROUND)
    out = _outwards(angle, side)
    along = np.column_stack([np.zeros(angle.size), side * np.cos(angle), np.sin(angle)])
    axis = np.array([1.0, 0.0, 0.0])
    corners = [  # face and back, each at both ends
        out * r + axis * z for r, z in (
            (radius, -half), (radius, half), (radius + pad.thickness, half),
            (radius + pad.thickness, -half),
        )
    ]  # fmt: skip
    walls = [(0, 1, -out), (1, 2, axis + 0.0 * out), (2, 3, out), (3, 0, -axis + 0.0 * out)]
    vertices, normals, triangles, first = [], [], [], 0
    for a, b, normal in walls:
        vertices.append(np.stack([corners[a], corners[b]], axis=1).reshape(-1, 3))
        normals.append(np.repeat(normal, 2, axis=0))
        triangles.append(first + grid_triangles(angle.size, 2))
        first += 2 * angle.size
    for end, sign in ((0, -1.0), (-1, 1.0)):
        vertices.append(np.array([corner[end] for corner in corners]))
        normals.append(np.repeat(sign * along[end : end + 1 or None], 4, axis=0))
        triangles.append(first + np.array([[0, 1, 2], [0, 2, 3]]))
        first += 4
    pivot = (radius + pad.thickness) * _outwards(pad.pivot_angle, side)
    return np.vstack(vertices) - pivot, np.vstack(normals), np.vstack(triangles).astype(np.uint32)
