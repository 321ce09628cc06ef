"""The film's cells: around the bearing, along its axis, across the film.

Cells run around in the direction of rotation, i = 0..n-1, and along the axis, j = 0..m-1; a
symmetric bearing is solved on one half, mid-plane to end. Pressure and temperature live at cell
centres, fluxes on faces, so that oil and enthalpy are conserved cell by cell.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Booleans
from ..errors import InputError
from ..model import Bearing, FilmSettings, Groove, Inception
from ..model.bearing import angle_between
from .geometry import bore_offset

# Part of the cells that follows 1/h; the rest is spread evenly. 1/h is the density of Sommerfeld's
# variable, in which a thin film's pressure is as smooth as a thick one's.
_GRADED_SHARE = 0.5


@dataclass(frozen=True)
class FilmMesh:
    """Cells of the film, in the film frame (see `FilmProblem`).

    theta_faces : (n + 1,) array [rad]; one full turn.
    y_faces : (m + 1,) array [m]; from 0 (half) or -L/2 (full) to L/2.
    half : Only the half y >= 0 is solved; the other is its mirror image.
    supply : (n, m) int array
        -1 in the film, else the number of the groove that the cell belongs to.
    slot : (n,) bool array. True where p = 0 and fresh film begin at the cell's first face
        (``max_film``).
    region : (n,) int array. Number of the stretch of film a column belongs to; stretches end at
        slots, at joints of lobes and at grooves.
    radius : Journal radius [m].
    """

    theta_faces: Array
    y_faces: Array
    half: bool
    supply: NDArray[np.int64]
    slot: Booleans
    region: NDArray[np.int64]
    radius: float

    def whole(self, field: NDArray[Any]) -> NDArray[Any]:
        """Return field (n, m, ...) over the whole length.

        Of a mesh that may hold one half of it.
        """
        return np.concatenate([field[:, ::-1], field], axis=1) if self.half else field

    @property
    def whole_y(self) -> Array:
        """Axial cell centres over the whole length [m]."""
        return np.concatenate([-self.y[::-1], self.y]) if self.half else self.y

    @property
    def shape(self) -> tuple[int, int]:
        """(n, m)."""
        return self.theta_faces.size - 1, self.y_faces.size - 1

    @property
    def theta(self) -> Array:
        """Cell centres [rad]."""
        return 0.5 * (self.theta_faces[1:] + self.theta_faces[:-1])

    @property
    def y(self) -> Array:
        """Cell centres [m]."""
        return 0.5 * (self.y_faces[1:] + self.y_faces[:-1])

    @property
    def dx(self) -> Array:
        """Cell lengths around the journal [m]."""
        return self.radius * np.diff(self.theta_faces)

    @property
    def dy(self) -> Array:
        """Cell lengths along the axis [m]."""
        return np.diff(self.y_faces)

    @property
    def multiplicity(self) -> float:
        """Return the number of like parts the mesh stands for: 2 for a half film."""
        return 2.0 if self.half else 1.0


def build_mesh(bearing: Bearing, settings: FilmSettings, position: tuple[float, float]) -> FilmMesh:
    """Return mesh of `bearing` (in the film frame), graded for the journal at `position` [m]."""
    size = settings.mesh
    slots_at_max = bearing.is_plain and settings.inception is Inception.MAX_FILM
    if bearing.pads:
        theta_faces = _pad_faces(bearing, size.circumferential)
    else:
        start, breaks = _breakpoints(bearing)
        theta_faces = _theta_faces(bearing, position, start, breaks, size.circumferential)
    half = bearing.is_symmetric
    y_faces = (
        np.linspace(0.0, bearing.length / 2.0, size.axial // 2 + 1)
        if half
        else np.linspace(-bearing.length / 2.0, bearing.length / 2.0, size.axial + 1)
    )
    if bearing.hollows:
        y_faces = _axial_faces(bearing, y_faces)
    supply, y_faces = _supply_cells(bearing, theta_faces, y_faces)
    slot = np.zeros(theta_faces.size - 1, dtype=bool)
    slot[0] = slots_at_max
    return FilmMesh(
        theta_faces=theta_faces,
        y_faces=y_faces,
        half=half,
        supply=supply,
        slot=slot,
        region=_regions(supply, slot | _joints(bearing, theta_faces)),
        radius=bearing.journal_radius,
    )


def _edges(bearing: Bearing) -> list[float]:
    """Return the angles at which a groove or a lobe begins or ends [rad]; the grooves' first."""
    edges = [edge for groove in bearing.grooves for edge in groove_edges(groove)]
    rows = (e for p in bearing.hollows if not p.is_ring for e in (p.start, p.end))
    edges += dict.fromkeys(rows)
    return edges + [e for arc in bearing.arcs if arc.preload > 0.0 for e in (arc.start, arc.end)]


def _breakpoints(bearing: Bearing) -> tuple[float, list[float]]:
    """Return first angle of the mesh and all angles in one turn from it where a face must lie."""
    edges = _edges(bearing)
    if not edges:
        return -math.pi, [-math.pi, math.pi]
    # Begin behind the groove that lies nearest to pi from the load: there a film starts.
    start = edges[1] if bearing.grooves else edges[0]
    turn = 2.0 * math.pi
    inside = sorted({round((edge - start) % turn, 12) for edge in edges})
    inside = [a for a in inside if 1e-9 < a < turn - 1e-9]
    # Edges that two features share differ by rounding only: merge them.
    merged = [0.0]
    merged += [a for k, a in enumerate(inside) if k == 0 or a - inside[k - 1] > 1e-6]
    return start, [start + a for a in merged] + [start + turn]


def _theta_faces(
    bearing: Bearing, position: tuple[float, float], start: float, breaks: list[float], count: int
) -> Array:
    """Return the faces so that every break is one, cells shared out by the density of the mesh."""
    stretches = len(breaks) - 1
    if count < 2 * stretches:
        raise InputError(
            f"too coarse for this bearing's {stretches} arcs and grooves: at least {2 * stretches}",
            key="film.mesh.circumferential",
            value=count,
        )
    fine = np.linspace(start, start + 2.0 * math.pi, 4001)
    # Kept positive, so that the density stays finite.
    h = mid_thickness(bearing, fine, position)
    h = np.maximum(h, 1e-4 * bearing.radial_clearance)
    density = (1.0 - _GRADED_SHARE) / (2.0 * math.pi)
    density = density + _GRADED_SHARE / h / np.trapezoid(1.0 / h, fine)
    steps = 0.5 * (density[1:] + density[:-1]) * np.diff(fine)
    cumulative = np.concatenate([[0.0], np.cumsum(steps)])
    cumulative /= cumulative[-1]
    at_breaks = np.interp(breaks, fine, cumulative)
    shares = np.diff(at_breaks)
    counts = _share_out(_film_weight(bearing, breaks, shares), count)
    faces = [np.array([breaks[0]])]
    for k, cells in enumerate(counts):
        inner = at_breaks[k] + shares[k] * np.arange(1, cells + 1) / cells
        theta = np.interp(inner, cumulative, fine)
        theta[-1] = breaks[k + 1]
        faces.append(theta)
    return np.concatenate(faces)


def _pad_faces(bearing: Bearing, count: int) -> Array:
    """Return faces of `count` cells over the pads, an even number each, and of two in every gap."""
    pads = bearing.pads
    if count < 4 * len(pads):
        raise InputError(
            f"too coarse for {len(pads)} pads: at least {4 * len(pads)}",
            key="film.mesh.circumferential",
            value=count,
        )
    counts = _share_out(np.array([pad.arc for pad in pads]), count // 2)
    turn = 2.0 * math.pi
    faces = [np.array([pads[0].leading_edge])]
    for number, (pad, pairs) in enumerate(zip(pads, counts, strict=True)):
        on_pad = np.linspace(pad.leading_edge, pad.trailing_edge, 2 * pairs + 1)
        last = number + 1 == len(pads)
        following = pads[0].leading_edge + turn if last else pads[number + 1].leading_edge
        faces += [on_pad[1:], [0.5 * (pad.trailing_edge + following), following]]
    return np.concatenate(faces)


def mid_thickness(bearing: Bearing, theta: Array, position: tuple[float, float]) -> Array:
    """Return film thickness at mid-plane [m]; in full-length grooves not below that of the lands.

    A groove has no metal behind the film: the journal may stand deeper in its opening than it may
    anywhere else.
    """
    h = (
        bearing.radial_clearance
        - position[0] * np.cos(theta)
        - position[1] * np.sin(theta)
        + bore_offset(bearing, theta)
    )
    open_ = in_full_groove(bearing, theta)
    return np.where(open_, np.maximum(h, h[~open_].min()), h) if open_.any() else h


def groove_edges(groove: Groove) -> tuple[float, float]:
    """Return the angles at which a groove begins and ends [rad]."""
    return groove.center - groove.extent / 2.0, groove.center + groove.extent / 2.0


def in_full_groove(bearing: Bearing, theta: Array) -> Booleans:
    """Return whether each angle lies inside a full-length groove."""
    inside = np.zeros(theta.shape, dtype=bool)
    for groove in bearing.grooves:
        if bearing.spans_length(groove):
            inside |= np.abs(angle_between(theta, groove.center)) < groove.extent / 2.0
    return inside


def _film_weight(bearing: Bearing, breaks: list[float], shares: Array) -> Array:
    """Return the shares in which full-length grooves, where nothing is solved, weigh little."""
    weights = shares.copy()
    for k in range(len(breaks) - 1):
        middle = 0.5 * (breaks[k] + breaks[k + 1])
        number = _groove_at(bearing, middle)
        if number is not None and bearing.spans_length(bearing.grooves[number]):
            weights[k] *= 0.1
    return weights


def _share_out(weights: Array, count: int) -> list[int]:
    """Return whole numbers of at least 2, in proportion to `weights`, that add up to `count`."""
    spare = count - 2 * weights.size
    exact = np.maximum(weights / weights.sum() * count - 2.0, 0.0)
    exact *= spare / exact.sum() if exact.sum() > 0.0 else 0.0
    counts = np.floor(exact).astype(int)
    for k in np.argsort(counts - exact)[: spare - int(counts.sum())]:
        counts[k] += 1
    return [int(c) + 2 for c in counts]


def _groove_at(bearing: Bearing, theta: float) -> int | None:
    for number, groove in enumerate(bearing.grooves):
        if abs(angle_between(theta, groove.center)) < groove.extent / 2.0:
            return number
    return None


def _axial_faces(bearing: Bearing, y_faces: Array) -> Array:
    """Return as many axial faces, with one on every edge of a pocket or a groove."""
    first, last = float(y_faces[0]), float(y_faces[-1])
    edges = [edge for pocket in bearing.hollows for edge in pocket.reach(bearing.length)]
    edges += [s * g.length / 2.0 for g in bearing.grooves if g.length for s in (1.0, -1.0)]
    room = 1e-6 * bearing.length
    breaks = [first]
    for edge in sorted(edges):
        if breaks[-1] + room < edge < last - room:
            breaks.append(edge)
    breaks.append(last)
    needed, halves = 2 * (len(breaks) - 1), 2 if first == 0.0 else 1
    if y_faces.size - 1 < needed:
        raise InputError(
            f"too coarse for this bearing's pockets: at least {needed * halves}",
            key="film.mesh.axial",
            value=(y_faces.size - 1) * halves,
        )
    counts = _share_out(np.diff(breaks), y_faces.size - 1)
    parts = [
        np.linspace(a, b, cells + 1)[1:]
        for a, b, cells in zip(breaks[:-1], breaks[1:], counts, strict=True)
    ]
    return np.concatenate([[first], *parts])


def _supply_cells(
    bearing: Bearing, theta_faces: Array, y_faces: Array
) -> tuple[NDArray[np.int64], Array]:
    """Return each cell's groove, and the axial faces moved onto the ends of partial grooves."""
    y_faces = y_faces.copy()
    for groove in bearing.grooves:
        if groove.length is None or bearing.spans_length(groove):
            continue
        for end in (groove.length / 2.0, -groove.length / 2.0):
            if y_faces[0] < end < y_faces[-1]:
                nearest = 1 + int(np.argmin(np.abs(y_faces[1:-1] - end)))
                y_faces[nearest] = end
    middles = 0.5 * (theta_faces[1:] + theta_faces[:-1])
    y = 0.5 * (y_faces[1:] + y_faces[:-1])
    supply = np.full((middles.size, y.size), -1, dtype=np.int64)
    for number, groove in reversed(list(enumerate(bearing.grooves))):
        around = np.abs(angle_between(middles, groove.center)) < groove.extent / 2.0
        along = np.abs(y) < (groove.length or bearing.length) / 2.0
        supply[around[:, None] & along] = number
    return supply, y_faces


def _joints(bearing: Bearing, theta_faces: Array) -> Booleans:
    """Return the columns at whose first face a lobe or a groove begins or ends."""
    first = theta_faces[:-1]
    joint = np.zeros(first.size, dtype=bool)
    for edge in _edges(bearing):
        joint |= np.abs(angle_between(first, edge)) < 1e-6
    return joint


def _regions(supply: NDArray[np.int64], begins: Booleans) -> NDArray[np.int64]:
    """Return the stretches of film between slots, joints and grooves; -1 in full-length grooves."""
    blocked = np.asarray((supply >= 0).all(axis=1), dtype=bool)
    region = np.full(blocked.size, -1, dtype=np.int64)
    current = -1
    for i in range(blocked.size):
        if blocked[i]:
            continue
        if i == 0 or blocked[i - 1] or begins[i]:
            current += 1
        region[i] = current
    joined = not blocked[0] and not blocked[-1] and not begins[0]
    if joined and current > 0:
        region[region == current] = region[0]
    return region
