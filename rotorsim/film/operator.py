"""Dowson's equation on the cells: every face's conductance and Couette flow (Dal Eq. 1, corrected).

Each cell's continuity reads, with the fluxes through its faces [m3/s],

    sum_f a_f (p_neighbour - p) + drag_west - drag_east - (dh/dt) area = 0,

a_f = h^3 F_2 (face length)/(spacing), couette = U h (1 - G) (face length). A face on a slot, a
groove or an end holds a known pressure half a cell away instead of a neighbour.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array, Booleans, Indices
from .flow_law import COUETTE_POWER, POISEUILLE_POWER
from .kernels import kernel
from .layers import LayerIntegrals
from .mesh import FilmMesh

WEST, EAST, SOUTH, NORTH = 0, 1, 2, 3
_STEP = 1e-6
"""Relative difference of the film thickness on both sides of a face that counts as a step."""


@dataclass(frozen=True)
class FilmOperator:
    """Faces of every cell, in the order west, east, south, north.

    conductance : (4, n, m) array. a_f [m3/(s Pa)], as seen from the cell.
    interior : (4, n, m) bool array. True where a film cell lies behind the face, False for a known
        pressure or a wall.
    fixed_pressure : (4, n, m) array. The known pressure behind an unlinked face [Pa].
    face_thickness : (4, n, m) array. h on the face [m].
    couette : (2, n, m) array. U h (1 - G) (face length) on the west and east faces [m3/s].
    spacing : (4, n, m) array. Distance over which the pressure difference acts, centre to centre or
        centre to face [m].
    fixed : (n, m) bool array. Cells of grooves: the pressure is `fixed_pressure[WEST]` there.
    area : (n, m) array [m2]
    dx, dy : (n,) and (m,) arrays. Cell lengths [m].
    steps : Faces at which the film thickness steps; None without any.
    """

    conductance: Array
    interior: Booleans
    fixed_pressure: Array
    face_thickness: Array
    couette: Array
    spacing: Array
    fixed: Booleans
    area: Array
    dx: Array
    dy: Array
    steps: StepFaces | None = None


@dataclass(frozen=True)
class StepFaces:
    """Faces between cells of different film thickness, once from either side.

    The flow through both half cells is the same: U h (1 - G) less h^3 F_2 times the gradient, with
    the pressure on the face between. That eliminates the face's pressure.

    at, beyond : (face, i, j) of the cell and of the one behind the face.
    own, other : Conductance of the half cells [m3/(s Pa)].
    own_couette, other_couette : U h (1 - G) (face length) of either side [m3/s]; 0 along the axis.
    """

    at: tuple[Indices, ...]
    beyond: tuple[Indices, ...]
    own: Array
    other: Array
    own_couette: Array
    other_couette: Array

    @property
    def share(self) -> Array:
        """Weight of the own side's flow: the other half cell's part of both conductances."""
        return self.other / (self.own + self.other)

    @property
    def conductance(self) -> Array:
        """Conductance of both half cells in a row [m3/(s Pa)]."""
        return self.own * self.share

    @property
    def couette(self) -> Array:
        """Flow without a pressure difference between the cells [m3/s]."""
        return self.own_couette * self.share + self.other_couette * (1.0 - self.share)

    def half_losses(self, full: Booleans) -> Array:
        """Return half the power that pressure on the face itself costs [W].

        Where both cells are full.

        What the Couette flows of both sides differ by flows off against both half cells.
        """
        power = 0.5 * (self.own_couette - self.other_couette) ** 2 / (self.own + self.other)
        return np.where(full[self.at[1:]] & full[self.beyond[1:]], power, 0.0)


@dataclass(frozen=True)
class FaceTopology:
    """Part of the operator that depends on the mesh and the supply only."""

    interior: Booleans
    fixed_pressure: Array
    spacing: Array
    fixed: Booleans
    area: Array
    dx: Array
    dy: Array

    def antisymmetric(self) -> FaceTopology:
        """Return the half film's faces with the pressure zero at the mid-plane."""
        spacing = self.spacing.copy()
        spacing[SOUTH, :, 0] = 0.5 * self.dy[0]
        return replace(self, spacing=spacing)


def face_topology(mesh: FilmMesh, supply_pressure: Array) -> FaceTopology:
    """Return the neighbours, distances and known pressures of every face.

    supply_pressure : (grooves,) array [Pa]
    """
    n, m = mesh.shape
    fixed = mesh.supply >= 0
    pressure = np.zeros((n, m))
    pressure[fixed] = supply_pressure[mesh.supply[fixed]]
    interior = np.ones((4, n, m), dtype=bool)
    fixed_pressure = np.zeros((4, n, m))
    interior[WEST, mesh.slot] = False
    interior[EAST, np.roll(mesh.slot, -1)] = False
    interior[SOUTH, :, 0] = False
    interior[NORTH, :, -1] = False
    # Behind a face towards a groove stands the groove's pressure, at the groove's edge.
    west_fixed, east_fixed = np.roll(fixed, 1, axis=0), np.roll(fixed, -1, axis=0)
    west_p, east_p = np.roll(pressure, 1, axis=0), np.roll(pressure, -1, axis=0)
    south_fixed, north_fixed = np.zeros_like(fixed), np.zeros_like(fixed)
    south_fixed[:, 1:], north_fixed[:, :-1] = fixed[:, :-1], fixed[:, 1:]
    south_p, north_p = np.zeros_like(pressure), np.zeros_like(pressure)
    south_p[:, 1:], north_p[:, :-1] = pressure[:, :-1], pressure[:, 1:]
    behind = (
        (WEST, west_fixed, west_p),
        (EAST, east_fixed, east_p),
        (SOUTH, south_fixed, south_p),
        (NORTH, north_fixed, north_p),
    )
    for face, blocked, value in behind:
        interior[face] &= ~blocked & ~fixed
        fixed_pressure[face] = np.where(blocked, value, 0.0)
    fixed_pressure[:, fixed] = pressure[fixed]
    dx, dy = mesh.dx, mesh.dy
    spacing = np.empty((4, n, m))
    spacing[WEST] = (0.5 * (dx + np.roll(dx, 1)))[:, None]
    spacing[EAST] = (0.5 * (dx + np.roll(dx, -1)))[:, None]
    spacing[SOUTH] = (0.5 * (dy + np.roll(dy, 1)))[None, :]
    spacing[NORTH] = (0.5 * (dy + np.roll(dy, -1)))[None, :]
    half = np.stack(
        [np.broadcast_to(d, (n, m)) for d in (dx[:, None], dx[:, None], dy[None], dy[None])]
    )
    spacing = np.where(interior, spacing, 0.5 * half)
    # At an open end the pressure falls like a parabola over the length: with this distance the flow
    # out of the last half cell is exact for one (second order either way, a third of the error).
    half_length = float(mesh.y_faces[-1])
    spacing[NORTH, :, -1] *= 1.0 - 0.25 * float(dy[-1]) / half_length
    spacing[SOUTH, :, 0] *= 1.0 - 0.25 * float(dy[0]) / half_length
    if mesh.half:
        spacing[SOUTH, :, 0] = np.inf  # the mid-plane: no flux, whatever lies behind
    return FaceTopology(
        interior=interior,
        fixed_pressure=fixed_pressure,
        spacing=spacing,
        fixed=fixed,
        area=dx[:, None] * dy[None, :],
        dx=dx,
        dy=dy,
    )


def film_operator(
    topology: FaceTopology, thickness: Array, layers: LayerIntegrals, surface_speed: float
) -> FilmOperator:
    """Return the conductances and Couette flow for the film thickness and the viscosity integrals.

    thickness : (5, n, m) array. At each cell's centre and on its west, east, south and north face,
        seen from inside [m].
    surface_speed : [m/s]
    """
    shape = topology.interior.shape
    conductance, face_thickness = np.empty(shape), np.empty(shape)
    couette = np.empty((2, *shape[1:]))
    stepped = assemble(
        thickness[1:], layers.f2, layers.f2_axial, layers.g, topology.interior, topology.spacing,
        topology.dx, topology.dy, surface_speed, conductance, face_thickness, couette,
    )  # fmt: skip
    steps = None
    if stepped:
        steps = _step_faces(topology, thickness[1:], layers, surface_speed)
    return FilmOperator(
        conductance=conductance,
        interior=topology.interior,
        fixed_pressure=topology.fixed_pressure,
        face_thickness=face_thickness,
        couette=couette,
        spacing=topology.spacing,
        fixed=topology.fixed,
        area=topology.area,
        dx=topology.dx,
        dy=topology.dy,
        steps=steps,
    )


def _beyond(sides: Array) -> Array:
    """Return what stands on the other side of each face, (4, n, m)."""
    return np.stack(
        [
            np.roll(sides[EAST], 1, axis=0),
            np.roll(sides[WEST], -1, axis=0),
            np.roll(sides[NORTH], 1, axis=1),
            np.roll(sides[SOUTH], -1, axis=1),
        ]
    )


def _step_faces(
    topology: FaceTopology, sides: Array, layers: LayerIntegrals, surface_speed: float
) -> StepFaces:
    _, n, m = sides.shape
    behind = _beyond(sides)
    stepped = topology.interior & (np.abs(sides - behind) > _STEP * (sides + behind))
    at = np.nonzero(stepped)
    face, i, j = at
    k = (i + np.array([-1, 1, 0, 0])[face]) % n
    q = np.clip(j + np.array([0, 0, -1, 1])[face], 0, m - 1)
    along = face < 2
    width = np.where(along, topology.dy[j], topology.dx[i])

    def half(h: Array, row: Indices, column: Indices) -> tuple[Array, Array]:
        mobility = np.where(along, layers.f2[row, column], layers.f2_axial[row, column])
        reach = 0.5 * np.where(along, topology.dx[row], topology.dy[column])
        drawn = surface_speed * h * (1.0 - layers.g[row, column]) * width
        return h**POISEUILLE_POWER * mobility * width / reach, np.where(along, drawn, 0.0)

    own, own_couette = half(sides[at], i, j)
    other, other_couette = half(behind[at], k, q)
    return StepFaces(at, (face ^ 1, k, q), own, other, own_couette, other_couette)


@kernel
def neighbour(face: int, i: int, j: int, n: int, m: int) -> tuple[int, int]:
    """Return cell behind a face: round the bearing the film closes.

    Along it the ends stand for it.
    """
    if face == 0:
        return (i - 1 if i > 0 else n - 1), j
    if face == 1:
        return (i + 1 if i < n - 1 else 0), j
    if face == 2:
        return i, max(j - 1, 0)
    return i, min(j + 1, m - 1)


@kernel
def assemble(
    sides: Array, f2: Array, f2_axial: Array, g: Array, interior: Booleans, spacing: Array,
    dx: Array, dy: Array, surface_speed: float, conductance: Array, thickness: Array,
    couette: Array,
) -> bool:  # fmt: skip
    """Fill conductance, thickness and Couette flow of the faces; return whether the film steps.

    At a step the flow through both half cells is the same (see `StepFaces`), and the thickness of
    the face is that at which the mean F_2 of both sides conducts as much.
    """
    n, m = f2.shape
    stepped = False
    for i in range(n):
        for j in range(m):
            for face in range(4):
                joined = interior[face, i, j]
                if joined and face % 2 == 1:
                    continue  # the same face as seen from the cell behind it
                k, q = neighbour(face, i, j, n, m)
                along = face < 2
                width = dy[j] if along else dx[i]
                h = sides[face, i, j]
                mobility = f2[i, j] if along else f2_axial[i, j]
                drawn = h**COUETTE_POWER * (1.0 - g[i, j])
                conducted = 0.0
                if joined:
                    there = sides[face ^ 1, k, q]
                    beyond = f2[k, q] if along else f2_axial[k, q]
                    mean = 0.5 * (mobility + beyond)
                    if abs(h - there) > _STEP * (h + there):
                        stepped = True
                        own = h**POISEUILLE_POWER * mobility / (dx[i] if along else dy[j])
                        other = there**POISEUILLE_POWER * beyond / (dx[k] if along else dy[q])
                        share = other / (own + other)
                        drawn = share * drawn + (1.0 - share) * there * (1.0 - g[k, q])
                        conducted = 2.0 * own * share
                        h = (conducted * spacing[face, i, j] / mean) ** (1.0 / 3.0)
                    else:
                        h = 0.5 * (h + there)
                        drawn = h**COUETTE_POWER * 0.5 * (2.0 - g[i, j] - g[k, q])
                    mobility = mean
                if conducted == 0.0:
                    conducted = h**POISEUILLE_POWER * mobility / spacing[face, i, j]
                thickness[face, i, j], conductance[face, i, j] = h, conducted * width
                if along:
                    couette[face, i, j] = surface_speed * drawn * width
                if joined:
                    behind = face ^ 1
                    thickness[behind, k, q], conductance[behind, k, q] = h, conducted * width
                    if along:
                        couette[behind, k, q] = surface_speed * drawn * width
    return stepped
