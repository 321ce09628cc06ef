"""Film thickness of a bore made of arcs, with the journal anywhere in it, tilted or not."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..model import Bearing
from .kernels import kernel

Array = NDArray[np.float64]


def bore_offset(bearing: Bearing, theta: Array) -> Array:
    """What the lobes' preload adds to the film thickness of a concentric bore [m].

    A lobe's centre of curvature is displaced by ``preload * c`` away from the point where it comes
    nearest, so h falls by ``preload * c * cos(theta - angle)``.

    Parameters
    ----------
    theta : array
        [rad], load frame.
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
class Thickness:
    """Film thickness [m] at cell centres and on faces, for one journal position.

    Attributes
    ----------
    center : (n, m) array
    west : (n, m) array
        On the first face of each cell, seen from inside it (lobes may step at a face).
    east : (n, m) array
        On its last face, seen from inside it.
    south, north : (n, m) arrays
        On its faces along the axis.
    """

    center: Array
    west: Array
    east: Array
    south: Array
    north: Array

    def minimum(self, cells: NDArray[np.bool_]) -> float:
        """Smallest thickness met on any face or centre of `cells` [m]."""
        parts = (self.center, self.west, self.east, self.south, self.north)
        return float(min(part[cells].min() for part in parts))


@dataclass(frozen=True)
class EvaluationPoints:
    """Where the film thickness is evaluated, and the bore there.

    Attributes
    ----------
    cos, sin : (3, n) arrays
        Of the angle at centres, west faces and east faces.
    bore : (3, n) array
        Clearance and lobes: the film thickness around a centred journal [m]. On a face shared by
        two lobes each cell sees its own.
    y, y_faces : (m,) and (m + 1,) arrays
        [m]
    tilt : tuple of float
        [rad]
    """

    cos: Array
    sin: Array
    bore: Array
    y: Array
    y_faces: Array
    tilt: tuple[float, float]


def evaluation_points(bearing: Bearing, theta_faces: Array, y_faces: Array) -> EvaluationPoints:
    """Return the evaluation points of a mesh."""
    inward = 1e-9 * np.diff(theta_faces)
    theta = np.stack(
        [0.5 * (theta_faces[1:] + theta_faces[:-1]), theta_faces[:-1], theta_faces[1:]]
    )
    inside = theta + np.stack([np.zeros_like(inward), inward, -inward])
    return EvaluationPoints(
        cos=np.cos(theta),
        sin=np.sin(theta),
        bore=bearing.radial_clearance + bore_offset(bearing, inside),
        y=0.5 * (y_faces[1:] + y_faces[:-1]),
        y_faces=y_faces,
        tilt=bearing.tilt,
    )


def film_thickness(at: EvaluationPoints, position: tuple[float, float]) -> Thickness:
    """Film thickness c - e_x cos(theta) - e_y sin(theta) + lobes, e following the tilt along y."""
    h = np.empty((5, at.cos.shape[1], at.y.size))
    _thickness(
        at.cos, at.sin, at.bore, at.y, at.y_faces, at.tilt[0], at.tilt[1], position[0],
        position[1], h,
    )  # fmt: skip
    return Thickness(center=h[0], west=h[1], east=h[2], south=h[3], north=h[4])


def thinnest_film(at: EvaluationPoints, position: tuple[float, float]) -> float:
    """Smallest film thickness on any face or centre [m]; not positive outside the bore."""
    ends = at.y_faces[[0, -1]][:, None, None]
    ex, ey = position[0] + at.tilt[0] * ends, position[1] + at.tilt[1] * ends
    return float((at.bore - ex * at.cos - ey * at.sin).min())


@kernel
def _thickness(cos, sin, bore, y, y_faces, tilt_x, tilt_y, ex, ey, h):
    n, m = cos.shape[1], y.size
    for i in range(n):
        for j in range(m):
            x_j, y_j = ex + tilt_x * y[j], ey + tilt_y * y[j]
            for face in range(3):
                h[face, i, j] = bore[face, i] - x_j * cos[face, i] - y_j * sin[face, i]
            for end in range(2):
                x_j, y_j = ex + tilt_x * y_faces[j + end], ey + tilt_y * y_faces[j + end]
                h[3 + end, i, j] = bore[0, i] - x_j * cos[0, i] - y_j * sin[0, i]
