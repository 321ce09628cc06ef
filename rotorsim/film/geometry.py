"""Film thickness over the generalised displacements of the walls (see docs: theory).

The film thickness is h = h_0 + sum_q q s_q: what it is with every displacement zero (clearance,
lobes, misalignment), plus each displacement q times its shape s_q(theta, y) = dh/dq. The journal's
two translations have the shapes -cos(theta) and -sin(theta), its two rotations y sin(theta) and
-y cos(theta). On a pad with its pivot at theta_p, tilt has the shape -(R + t) sin(theta - theta_p),
the pivot's displacement cos(theta - theta_p) and pitch y cos(theta - theta_p). The force that the
film exerts along q is Q_q = int p s_q dA.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array, Booleans
from ..model import Bearing, Pad
from .bending import MODES, pad_bending

if TYPE_CHECKING:
    from .mesh import FilmMesh


TRANSLATIONS = ("x", "y")
ROTATIONS = ("theta_x", "theta_y")
"""About x and y, positive by the right hand; y is measured along the rotation vector."""
CENTER = 0
"""First index of fields (5, n, m): cell centre; then the west, east, south and north faces."""


def bore_offset(bearing: Bearing, theta: Array) -> Array:
    """Return what the lobes' preload adds to the film thickness of a concentric bore [m].

    A lobe's centre of curvature is displaced by ``preload * c`` away from the point where it comes
    nearest, so h falls by ``preload * c * cos(theta - angle)``.

    theta : array. [rad], load frame.
    """
    offset = np.zeros_like(theta)
    for arc in bearing.arcs:
        if arc.preload == 0.0:
            continue
        inside = (theta - arc.start) % (2.0 * math.pi) < arc.end - arc.start
        lobe = -arc.preload * bearing.radial_clearance * np.cos(theta - arc.preload_angle)
        offset = np.where(inside, lobe, offset)
    return offset


@dataclass(frozen=True)
class Displacements:
    """Generalised displacements of a film.

    shapes : (q, 5, n, m) array. dh/dq at the centre and on the west, east, south and north face of
        each cell, seen from inside the cell.
    scales : (q,) array. A change of each displacement that changes h by about the clearance.
    """

    names: tuple[str, ...]
    shapes: Array
    scales: Array

    def joined(self, others: Displacements) -> Displacements:
        """Return these displacements and, behind them, the `others`."""
        return Displacements(
            self.names + others.names,
            np.concatenate([self.shapes, others.shapes]),
            np.concatenate([self.scales, others.scales]),
        )


@dataclass(frozen=True)
class FilmGeometry:
    """Film thickness as a function of the displacements, on the cells of one mesh.

    rest : (5, n, m) array. h with all displacements zero [m], at the points of
        `Displacements.shapes`. Where the bore steps at a face, as between lobes, each cell sees its
        own side.
    land : (n, m) bool array. Cells with metal behind the film: outside the grooves.
    multiplicity : How many identical parts the mesh stands for.
    still : (n,) bool array or None. Columns whose film no displacement moves, as that of an
        unloaded pad.
    """

    rest: Array
    displacements: Displacements
    land: Booleans
    multiplicity: float
    still: Booleans | None = None

    def thickness(self, q: Array) -> Array:
        """Return the film thickness [m], (5, n, m), at the displacements `q`."""
        h = self.rest.copy()
        for value, shape in zip(q, self.displacements.shapes, strict=True):
            if value != 0.0:
                h += value * shape
        return h

    def thinnest(self, thickness: Array) -> float:
        """Return the smallest film thickness [m] on any face or centre of the lands."""
        return float(np.min(thickness, where=self.land, initial=np.inf))

    def thinnest_at(self, q: Array) -> float:
        """Return smallest film thickness [m] of the lands at `q`.

        Not positive where the walls touch.
        """
        return self.thinnest(self.thickness(q))

    def without(self, columns: Booleans, q: Array) -> FilmGeometry:
        """Return the geometry whose film in `columns` (n,) stays as it is at `q`, without force."""
        rest = self.rest.copy()
        rest[:, columns] = self.thickness(q)[:, columns]
        still = replace(self, rest=rest, still=columns)
        return replace(still, displacements=still.moving(self.displacements))

    def moving(self, displacements: Displacements) -> Displacements:
        """Return `displacements` as far as they move this film: not in the columns kept still."""
        if self.still is None:
            return displacements
        shapes = displacements.shapes.copy()
        shapes[:, :, self.still] = 0.0
        return replace(displacements, shapes=shapes)

    def forces(self, load: Array) -> Array:
        """Return generalised forces Q_q of the film, (q,), for the `load` p dA of each cell [N]."""
        return self.multiplicity * np.tensordot(self.displacements.shapes[:, CENTER], load, axes=2)


def film_geometry(bearing: Bearing, mesh: FilmMesh) -> FilmGeometry:
    """Return geometry of a film, displaced by the journal's translations and its pads."""
    inward = 1e-9 * np.diff(mesh.theta_faces)
    inside = _angles(mesh) + np.stack([np.zeros_like(inward), inward, -inward])
    if bearing.pads:
        bore, displacements = _pads_at_rest(bearing, mesh), _journal_and_pads(bearing, mesh)
    else:
        bore = bearing.radial_clearance + bore_offset(bearing, inside)
        displacements = _translations(bearing, mesh)
    rest = np.repeat(bore[[0, 1, 2, 0, 0]][:, :, None], mesh.shape[1], axis=2)
    if bearing.hollows:
        rest += _pocket_depth(bearing, mesh, inside[[0, 1, 2, 0, 0]][:, :, None])
    if not bearing.is_symmetric:
        slopes = np.array([-bearing.misalignment[1], bearing.misalignment[0]])
        rest += np.tensordot(slopes, rotations(bearing, mesh).shapes, axes=1)
    return FilmGeometry(rest, displacements, mesh.supply < 0, multiplicity=mesh.multiplicity)


def _pocket_depth(bearing: Bearing, mesh: FilmMesh, theta: Array) -> Array:
    """Return the depth of the pockets [m], (5, n, m), each cell's faces seen from inside it."""
    y, inward = mesh.y, 1e-9 * np.diff(mesh.y_faces)
    along = np.stack([y, y, y, mesh.y_faces[:-1] + inward, mesh.y_faces[1:] - inward])[:, None]
    depth = np.zeros((5, *mesh.shape))
    for hollow in bearing.hollows:
        np.maximum(depth, hollow.deepening(theta, along, bearing.length), out=depth)
    return depth


@dataclass(frozen=True)
class PadUnknowns:
    """Places of one pad's displacements among all; None where its pivot does not have them."""

    tilt: int
    pivot: int | None
    pitch: int | None
    bends: tuple[int, ...] = ()

    @property
    def places(self) -> list[int]:
        """Places of all of them."""
        single = [place for place in (self.tilt, self.pivot, self.pitch) if place is not None]
        return [*single, *self.bends]


def pad_unknowns(bearing: Bearing) -> tuple[tuple[str, ...], tuple[PadUnknowns, ...]]:
    """Return the names of all displacements of a film between pads, and the places of each pad's.

    A flexible pivot adds its radial displacement, positive outwards. A ball lets the pad pitch,
    which a misaligned journal asks of it; aligned, pitch and the other displacements are apart. A
    pad that bends adds its shapes ahead of the pivot, then those behind it.
    """
    names: list[str] = [*TRANSLATIONS]
    places = []
    for number, pad in enumerate(bearing.pads, start=1):
        tilt = len(names)
        names.append(f"tilt_{number}")
        pivot = pitch = None
        if not pad.pivot.is_rigid:
            pivot = len(names)
            names.append(f"pivot_{number}")
        if pad.pivot.pitches and not bearing.is_symmetric:
            pitch = len(names)
            names.append(f"pitch_{number}")
        bends = tuple(range(len(names), len(names) + (2 * MODES if pad.youngs_modulus else 0)))
        names += [f"bend_{number}_{k + 1}" for k in range(len(bends))]
        places.append(PadUnknowns(tilt, pivot, pitch, bends))
    return tuple(names), tuple(places)


def pad_face(
    bearing: Bearing, pad: Pad, theta: Array, tilt: float = 0.0, pivot: float = 0.0
) -> Array:
    """Return the distance [m] of a pad's face from a centred journal's surface, at mid-plane.

    tilt, pivot : In the direction of rotation [rad]; outwards [m].
    """
    angle, clearance = theta - pad.pivot_angle, bearing.clearance_of(pad)
    face = clearance * (1.0 - bearing.preload_of(pad) * np.cos(angle))
    arm = bearing.journal_radius + pad.thickness
    return np.asarray(face - arm * tilt * np.sin(angle) + pivot * np.cos(angle))


def _pads_at_rest(bearing: Bearing, mesh: FilmMesh) -> Array:
    """Return H [m] of untilted pads around a centred journal, (3, n).

    Centres, west and east faces.
    """
    theta = _angles(mesh)
    h = np.full(theta.shape, bearing.radial_clearance)
    for number, pad in enumerate(bearing.pads):
        columns = mesh.region == number
        h[:, columns] = pad_face(bearing, pad, theta[:, columns])
    return h


def _journal_and_pads(bearing: Bearing, mesh: FilmMesh) -> Displacements:
    """Return displacements of the journal, and tilt, pivot displacement and pitch of the pads."""
    names, places = pad_unknowns(bearing)
    journal = _translations(bearing, mesh)
    shapes = np.zeros((len(names), 5, *mesh.shape))
    scales = np.full(len(names), bearing.radial_clearance)
    shapes[:2] = journal.shapes
    y = mesh.y
    along = np.stack([y, y, y, mesh.y_faces[:-1], mesh.y_faces[1:]])[:, None, :]
    for number, (pad, own) in enumerate(zip(bearing.pads, places, strict=True)):
        columns = mesh.region == number
        angle = _angles(mesh)[[0, 1, 2, 0, 0]][:, columns, None] - pad.pivot_angle
        arm, clearance = bearing.journal_radius + pad.thickness, bearing.clearance_of(pad)
        shapes[own.tilt][:, columns] = -arm * np.sin(angle)
        scales[own.tilt] = clearance / arm
        if own.pivot is not None:
            shapes[own.pivot][:, columns] = np.cos(angle)
            scales[own.pivot] = clearance
        if own.pitch is not None:
            shapes[own.pitch][:, columns] = along * np.cos(angle)
            scales[own.pitch] = clearance / (0.5 * bearing.length)
        if own.bends:
            sides = pad_bending(pad, bearing.journal_radius, bearing.length)
            bent = np.concatenate([side.at(angle) for side in sides])
            shapes[np.ix_(own.bends, range(5), columns)] = bent
    return Displacements(names, shapes, scales)


def _translations(bearing: Bearing, mesh: FilmMesh) -> Displacements:
    """Return the displacements of the journal's centre along x and y [m]."""
    theta = _angles(mesh)
    around = np.stack([-np.cos(theta), -np.sin(theta)])[:, [0, 1, 2, 0, 0], :, None]
    shapes = np.ascontiguousarray(np.broadcast_to(around, (2, 5, *mesh.shape)))
    return Displacements(TRANSLATIONS, shapes, np.full(2, bearing.radial_clearance))


def rotations(bearing: Bearing, mesh: FilmMesh) -> Displacements:
    """Return the rotations of the journal about x and y [rad], through the bearing's mid-plane."""
    theta = _angles(mesh)
    around = np.stack([np.sin(theta), -np.cos(theta)])[:, [0, 1, 2, 0, 0], :, None]
    y = mesh.y
    along = np.stack([y, y, y, mesh.y_faces[:-1], mesh.y_faces[1:]])[:, None, :]
    scale = bearing.radial_clearance / (0.5 * bearing.length)
    return Displacements(ROTATIONS, around * along, np.full(2, scale))


def idle_pitches(bearing: Bearing) -> tuple[int, ...]:
    """Return pads, from 0, that pitch only where the journal turns out of line.

    Aligned, none does.
    """
    if not bearing.is_symmetric:
        return ()
    return tuple(number for number, pad in enumerate(bearing.pads) if pad.pivot.pitches)


def turnings(bearing: Bearing, mesh: FilmMesh) -> Displacements:
    """Return the rotations of the journal, and behind them the pitches of `idle_pitches`."""
    turned = rotations(bearing, mesh)
    y = mesh.y
    along = np.stack([y, y, y, mesh.y_faces[:-1], mesh.y_faces[1:]])[:, None, :]
    for number in idle_pitches(bearing):
        columns, pad = mesh.region == number, bearing.pads[number]
        shape = np.zeros((1, 5, *mesh.shape))
        angle = _angles(mesh)[[0, 1, 2, 0, 0]][:, columns, None] - pad.pivot_angle
        shape[0][:, columns] = along * np.cos(angle)
        scale = np.array([bearing.clearance_of(pad) / (0.5 * bearing.length)])
        turned = turned.joined(Displacements((f"pitch_{number + 1}",), shape, scale))
    return turned


def _angles(mesh: FilmMesh) -> Array:
    """Return the angles [rad] of centres, west faces and east faces, (3, n)."""
    return np.stack([mesh.theta, mesh.theta_faces[:-1], mesh.theta_faces[1:]])


def rotation(angle: float) -> Array:
    """Return the matrix (2, 2) from a frame turned by `angle` [rad] to the one it is turned in."""
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin], [sin, cos]])
