"""Film thickness of a bore made of arcs, with the journal anywhere in it, tilted or not."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..model import Bearing

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

    @property
    def minimum(self) -> float:
        """Smallest thickness met on any face or centre [m]."""
        parts = (self.center, self.west, self.east, self.south, self.north)
        return float(min(part.min() for part in parts))


def film_thickness(
    bearing: Bearing,
    theta_faces: Array,
    y_faces: Array,
    position: tuple[float, float],
) -> Thickness:
    """H = c - e_x cos(theta) - e_y sin(theta) + lobes, e following the journal's tilt along y."""
    theta = 0.5 * (theta_faces[1:] + theta_faces[:-1])
    y = 0.5 * (y_faces[1:] + y_faces[:-1])
    # Faces shared by two lobes belong to both: evaluate each lobe from just inside the cell.
    inward = 1e-9 * np.diff(theta_faces)

    def thickness(angle: Array, lobe_angle: Array, along: Array) -> Array:
        ex = position[0] + bearing.tilt[0] * along
        ey = position[1] + bearing.tilt[1] * along
        round_part = bearing.radial_clearance + bore_offset(bearing, lobe_angle)
        return round_part[:, None] - np.cos(angle)[:, None] * ex - np.sin(angle)[:, None] * ey

    return Thickness(
        center=thickness(theta, theta, y),
        west=thickness(theta_faces[:-1], theta_faces[:-1] + inward, y),
        east=thickness(theta_faces[1:], theta_faces[1:] - inward, y),
        south=thickness(theta, theta, y_faces[:-1]),
        north=thickness(theta, theta, y_faces[1:]),
    )
