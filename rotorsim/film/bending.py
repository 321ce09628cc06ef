"""Pads that bend under the film's pressure: curved beams, built in at the pivot's line.

A unit radial load at the angle b from the pivot bends the side of the pad on which it stands. Its
moment, normal and shear force at the angle c are r sin(b - c), sin(b - c) and cos(b - c), r the
mid-thickness radius, so that (Castigliano) it moves the place a radially by

    f(a, b) = int_0^min(a,b) [(r^2/EI + 1/EA) sin(a - c) sin(b - c)
                              + cos(a - c) cos(b - c)/kGA] r dc,

k = 5/6, E the modulus of a beam: a pad that bends by micrometres is free to curve across, whatever
its width. The deflections under an even load and one that rises straight from the pivot are mixed
(Ritz) into shapes v of generalised displacements, positive outwards, each held by a spring of its
own: w = sum_k b_k v_k, b_k = int v_k q/k_k for a load q, as the film finds it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import eigh

from ..arrays import Array
from ..model import Pad

MODES = 2
"""Shapes on either side of the pivot: exact for loads that are straight along it."""
_POINTS = 80
"""Of the midpoint rule along one side."""
_SHEAR_AREA = 5.0 / 6.0


@dataclass(frozen=True)
class BendingModes:
    """Shapes in which a pad bends, unit root mean square over their side of the pivot.

    side : Angle from the pivot to the edge, negative for the leading one [rad].
    points, values : (n,), (modes, n) arrays. Distances from the pivot [rad] and the shapes there.
    loads : (modes, n) array. Under which they are the deflection [N/m/rad].
    stiffness : (modes,) array. Spring of each shape [N/m].
    """

    side: float
    points: Array
    values: Array
    loads: Array
    stiffness: Array
    section: tuple[float, float, float]

    def at(self, angle: Array) -> Array:
        """Return shapes at angles from the pivot [rad], (modes, ...); 0 on the other side."""
        away = np.maximum(angle * math.copysign(1.0, self.side), 0.0)
        kernel = _compliance(away[..., None], self.points, *self.section)
        weight = abs(self.side) / self.points.size
        return np.moveaxis(kernel @ (weight * self.loads).T, -1, 0)

    def mean(self, function: Array) -> Array:
        """Return the mean over the side of each shape times a function at the points, (modes,)."""
        return np.asarray(self.values @ function / self.points.size)


def _compliance(a: Array, b: Array, bent: float, sheared: float, radius: float) -> Array:
    """Return f(a, b) [m/N]; `bent`: r^2/EI + 1/EA, `sheared`: 1/kGA [1/N]."""
    upper, apart = np.minimum(a, b), np.abs(a - b)
    # sin sin and cos cos integrated from 0 to the nearer place
    difference = 0.5 * (np.sin(a + b) - np.sin(a + b - 2.0 * upper))
    along = upper * np.cos(apart)
    return 0.5 * radius * (bent * (along - difference) + sheared * (along + difference))


def pad_bending(pad: Pad, radius: float, length: float) -> tuple[BendingModes, BendingModes]:
    """Return how a pad around a journal of `radius` bends ahead of and behind its pivot [m]."""
    assert pad.youngs_modulus is not None
    middle, area = radius + 0.5 * pad.thickness, length * pad.thickness
    modulus, inertia = pad.youngs_modulus, area * pad.thickness**2 / 12.0
    bent = middle**2 / (modulus * inertia) + 1.0 / (modulus * area)
    sheared = 2.0 * (1.0 + pad.poisson_ratio) / (modulus * _SHEAR_AREA * area)
    section = bent, sheared, middle
    return _modes(-pad.offset * pad.arc, section), _modes((1.0 - pad.offset) * pad.arc, section)


@lru_cache(maxsize=64)
def _modes(side: float, section: tuple[float, float, float]) -> BendingModes:
    points = (np.arange(_POINTS) + 0.5) / _POINTS * abs(side)
    loads = np.polynomial.legendre.legvander(2.0 * points / abs(side) - 1.0, MODES - 1).T
    bent = loads @ _compliance(points[:, None], points, *section) * (abs(side) / _POINTS)
    stiffness, mixed = eigh(bent @ loads.T / _POINTS, bent @ bent.T / _POINTS)
    mixed *= np.sign(mixed.T @ bent[:, -1])
    return BendingModes(
        side, points, mixed.T @ bent, mixed.T @ loads, abs(side) * stiffness, section
    )
