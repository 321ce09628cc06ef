"""Distance of the journal to the bush, for any bore."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..film.geometry import bore_offset
from ..model import Bearing
from ..model.bearing import angle_between

_ANGLES = 720
_BLOCK = 4096
"""Positions looked at together: bounds the memory."""


def contact_boundary(bearing: Bearing, count: int = 361) -> Array:
    """Return the closed line of the journal's positions at which it touches the bush.

    bearing : In the frame of the line.
    count : Points on the line, the last one the first again.
    Returns (count, 2) array: At mid-plane [m]; the clearance circle of the plain, aligned bearing.
        Between tilting pads, which turn out of the way, the lines on which a pivot stands in the
        journal's.

    Examples
    --------
    >>> from rotorsim.model import Bearing
    >>> plain = Bearing(journal_radius=0.05, length=0.08, radial_clearance=1e-4)
    >>> round(float(np.hypot(*contact_boundary(plain).T).max()), 9)
    0.0001
    """
    phi = np.linspace(0.0, 2.0 * math.pi, count)
    ray = np.column_stack([np.cos(phi), np.sin(phi)])
    if bearing.is_plain and bearing.is_symmetric:
        return bearing.radial_clearance * ray
    if bearing.pads:
        normal, assembled = _pivots(bearing)
        towards = np.maximum(ray @ normal.T, 1e-9)
        reach = np.minimum((assembled / towards).min(axis=1), 2.0 * assembled.max())
        return reach[:, None] * ray
    theta = _land_angles(bearing)
    bore = bearing.radial_clearance + bore_offset(bearing, theta)
    normal = np.column_stack([np.cos(theta), np.sin(theta)])
    towards = ray @ normal.T
    reach = np.full(count, np.inf)
    for end in _ends(bearing):
        gap = bore - normal @ (np.asarray(bearing.misalignment) * end)
        # Along a ray each film falls linearly with the distance: the first to reach zero decides.
        with np.errstate(divide="ignore"):
            distance = np.where(towards > 0.0, gap / np.maximum(towards, 1e-12), np.inf)
        reach = np.minimum(reach, distance.min(axis=1))
    return reach[:, None] * ray


def _ends(bearing: Bearing) -> tuple[float, ...]:
    """Return the axial places at which a journal touches first [m]."""
    half = 0.5 * bearing.length
    return (0.0,) if bearing.is_symmetric else (-half, half)


def minimum_film(bearing: Bearing, x: Array, y: Array) -> Array:
    """Return the smallest film thickness [m] on the lands with the journal's centre at x, y [m].

    bearing : In the frame of x and y.
    x, y : (n,) arrays. At mid-plane [m].
    Returns (n,) array: Zero or less where they touch. c - e for the plain, aligned bearing; else
        the least over angles half a degree apart and over both ends of a tilted journal. Of tilting
        pads, that at their pivots, where these do not give way.
    """
    if bearing.is_plain and bearing.is_symmetric:
        return bearing.radial_clearance - np.hypot(x, y)
    if bearing.pads:
        normal, assembled = _pivots(bearing)
        return np.asarray((assembled - np.column_stack([x, y]) @ normal.T).min(axis=1))
    theta = _land_angles(bearing)
    bore = bearing.radial_clearance + bore_offset(bearing, theta)
    cos, sin = np.cos(theta), np.sin(theta)
    least = np.full(np.shape(x), np.inf)
    for end in _ends(bearing):
        ex, ey = x + bearing.misalignment[0] * end, y + bearing.misalignment[1] * end
        for start in range(0, least.size, _BLOCK):
            part = slice(start, start + _BLOCK)
            h = bore - np.multiply.outer(ex[part], cos) - np.multiply.outer(ey[part], sin)
            least[part] = np.minimum(least[part], h.min(axis=1))
    return least


def _pivots(bearing: Bearing) -> tuple[Array, Array]:
    """Return directions (p, 2) of the pivots, and assembled clearances there [m].

    Rigid ones, if any.
    """
    pads = [pad for pad in bearing.pads if pad.pivot.is_rigid] or bearing.pads
    angles = np.array([pad.pivot_angle for pad in pads])
    clearances = [(1.0 - bearing.preload_of(pad)) * bearing.clearance_of(pad) for pad in pads]
    return np.column_stack([np.cos(angles), np.sin(angles)]), np.array(clearances)


def _land_angles(bearing: Bearing) -> Array:
    """Return the angles [rad] that no full-length groove covers."""
    theta = 2.0 * math.pi * np.arange(_ANGLES) / _ANGLES
    land = np.ones(_ANGLES, dtype=bool)
    for groove in bearing.grooves:
        if bearing.spans_length(groove):
            land &= np.abs(angle_between(theta, groove.center)) > 0.5 * groove.extent
    return theta[land]
