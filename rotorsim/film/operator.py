"""Dowson's equation on the cells: conductances and drag of every face (Dal Eq. 1, corrected).

Each cell's continuity reads, with the fluxes through its faces [m3/s],

    sum_f a_f (p_neighbour - p) + drag_west - drag_east - (dh/dt) area = 0,

a_f = h^3 F_2 (face length)/(distance), drag = U h (1 - G) (face length). A face on a slot, a groove
or an end holds a known pressure half a cell away instead of a neighbour.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .geometry import Thickness
from .kernels import kernel
from .layers import LayerIntegrals
from .mesh import FilmMesh

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

WEST, EAST, SOUTH, NORTH = 0, 1, 2, 3


@dataclass(frozen=True)
class FilmOperator:
    """Faces of every cell, in the order west, east, south, north.

    Attributes
    ----------
    conductance : (4, n, m) array
        a_f [m3/(s Pa)], as seen from the cell.
    linked : (4, n, m) bool array
        True where a film cell lies behind the face, False for a known pressure or a wall.
    outer_pressure : (4, n, m) array
        The known pressure behind an unlinked face [Pa].
    face_thickness : (4, n, m) array
        h on the face [m].
    drag : (2, n, m) array
        U h (1 - G) (face length) on the west and east faces [m3/s].
    gap : (4, n, m) array
        Distance over which the pressure difference acts, centre to centre or centre to face [m].
    held : (n, m) bool array
        Cells of grooves: the pressure is `outer_pressure[WEST]` there.
    area : (n, m) array
        [m2]
    cos, sin : (3, n, 1) arrays
        Of the angle at centres, west faces and east faces.
    dx, dy : (n,) and (m,) arrays
        Cell lengths [m].
    """

    conductance: Array
    linked: Flags
    outer_pressure: Array
    face_thickness: Array
    drag: Array
    gap: Array
    held: Flags
    area: Array
    cos: Array
    sin: Array
    dx: Array
    dy: Array


@dataclass(frozen=True)
class FaceTopology:
    """What of the operator depends on the mesh and the supply only."""

    linked: Flags
    outer_pressure: Array
    gap: Array
    held: Flags
    area: Array
    cos: Array
    sin: Array
    dx: Array
    dy: Array


def face_topology(mesh: FilmMesh, supply_pressure: Array) -> FaceTopology:
    """Neighbours, distances and known pressures of every face.

    Parameters
    ----------
    supply_pressure : (grooves,) array
        [Pa]
    """
    n, m = mesh.shape
    held = mesh.supply >= 0
    pressure = np.zeros((n, m))
    pressure[held] = supply_pressure[mesh.supply[held]]
    linked = np.ones((4, n, m), dtype=bool)
    outer = np.zeros((4, n, m))
    linked[WEST, mesh.slot] = False
    linked[EAST, np.roll(mesh.slot, -1)] = False
    linked[SOUTH, :, 0] = False
    linked[NORTH, :, -1] = False
    # Behind a face towards a groove stands the groove's pressure, at the groove's edge.
    west_held, east_held = np.roll(held, 1, axis=0), np.roll(held, -1, axis=0)
    west_p, east_p = np.roll(pressure, 1, axis=0), np.roll(pressure, -1, axis=0)
    south_held, north_held = np.zeros_like(held), np.zeros_like(held)
    south_held[:, 1:], north_held[:, :-1] = held[:, :-1], held[:, 1:]
    south_p, north_p = np.zeros_like(pressure), np.zeros_like(pressure)
    south_p[:, 1:], north_p[:, :-1] = pressure[:, :-1], pressure[:, 1:]
    behind = (
        (WEST, west_held, west_p),
        (EAST, east_held, east_p),
        (SOUTH, south_held, south_p),
        (NORTH, north_held, north_p),
    )
    for face, blocked, value in behind:
        linked[face] &= ~blocked & ~held
        outer[face] = np.where(blocked, value, 0.0)
    outer[:, held] = pressure[held]
    dx, dy = mesh.dx, mesh.dy
    gap = np.empty((4, n, m))
    gap[WEST] = (0.5 * (dx + np.roll(dx, 1)))[:, None]
    gap[EAST] = (0.5 * (dx + np.roll(dx, -1)))[:, None]
    gap[SOUTH] = (0.5 * (dy + np.roll(dy, 1)))[None, :]
    gap[NORTH] = (0.5 * (dy + np.roll(dy, -1)))[None, :]
    half = np.stack(
        [np.broadcast_to(d, (n, m)) for d in (dx[:, None], dx[:, None], dy[None], dy[None])]
    )
    gap = np.where(linked, gap, 0.5 * half)
    # At an open end the pressure falls like a parabola over the length: with this distance the flow
    # out of the last half cell is exact for one (second order either way, a third of the error).
    half_length = float(mesh.y_faces[-1])
    gap[NORTH, :, -1] *= 1.0 - 0.25 * float(dy[-1]) / half_length
    gap[SOUTH, :, 0] *= 1.0 - 0.25 * float(dy[0]) / half_length
    if mesh.half:
        gap[SOUTH, :, 0] = np.inf  # the mid-plane: no flux, whatever lies behind
    angles = np.stack([mesh.theta, mesh.theta_faces[:-1], mesh.theta_faces[1:]])[:, :, None]
    return FaceTopology(
        linked=linked,
        outer_pressure=outer,
        gap=gap,
        held=held,
        area=dx[:, None] * dy[None, :],
        cos=np.cos(angles),
        sin=np.sin(angles),
        dx=dx,
        dy=dy,
    )


def film_operator(
    topology: FaceTopology, film: Thickness, layers: LayerIntegrals, surface_speed: float
) -> FilmOperator:
    """Conductances and drag for the film thickness and the viscosity integrals."""
    shape = topology.linked.shape
    conductance, thickness = np.empty(shape), np.empty(shape)
    drag = np.empty((2, *shape[1:]))
    _assemble(
        film.west, film.east, film.south, film.north, layers.f2, layers.g, topology.linked,
        topology.gap, topology.dx, topology.dy, surface_speed, conductance, thickness, drag,
    )  # fmt: skip
    return FilmOperator(
        conductance=conductance,
        linked=topology.linked,
        outer_pressure=topology.outer_pressure,
        face_thickness=thickness,
        drag=drag,
        gap=topology.gap,
        held=topology.held,
        area=topology.area,
        cos=topology.cos,
        sin=topology.sin,
        dx=topology.dx,
        dy=topology.dy,
    )


@kernel
def neighbour(face: int, i: int, j: int, n: int, m: int) -> tuple[int, int]:
    """Cell behind a face: round the bearing the film closes, along it the ends stand for it."""
    if face == 0:
        return (i - 1 if i > 0 else n - 1), j
    if face == 1:
        return (i + 1 if i < n - 1 else 0), j
    if face == 2:
        return i, max(j - 1, 0)
    return i, min(j + 1, m - 1)


@kernel
def _assemble(
    west, east, south, north, f2, g, linked, gap, dx, dy, surface_speed, conductance, thickness,
    drag,
):  # fmt: skip
    n, m = f2.shape
    for i in range(n):
        for j in range(m):
            for face in range(4):
                k, q = neighbour(face, i, j, n, m)
                width = dy[j] if face < 2 else dx[i]
                if face == 0:
                    h = west[i, j]
                    h = 0.5 * (h + east[k, j]) if linked[0, i, j] else h
                elif face == 1:
                    h = east[i, j]
                    h = 0.5 * (h + west[k, j]) if linked[1, i, j] else h
                elif face == 2:
                    h = south[i, j]
                else:
                    h = north[i, j]
                mobility, open_share = f2[i, j], 1.0 - g[i, j]
                if linked[face, i, j]:
                    mobility = 0.5 * (mobility + f2[k, q])
                    open_share = 0.5 * (open_share + 1.0 - g[k, q])
                thickness[face, i, j] = h
                conductance[face, i, j] = h**3 * mobility * width / gap[face, i, j]
                if face < 2:
                    drag[face, i, j] = surface_speed * h * open_share * width
