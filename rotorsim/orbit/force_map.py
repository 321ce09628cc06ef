"""The film's force at any position and velocity, from a map over two numbers.

An isoviscous ruptured film without supply pressure is a pure squeeze film in the frame that turns
at half the shaft's speed (see `rotorsim.orbit.kernels`). Reynolds and half-Sommerfeld
conditions are homogeneous of first degree in pressure, so the force is

    F = 2 mu |v_s| L (R/c)^3 W(eps, alpha)

with alpha the angle from the eccentricity to the squeeze velocity v_s: Childs, Moes & van Leeuwen,
J. Lubr. Technol. 99 (1977) 198, call W the impedance. It is solved once on a grid and splined.

Close to the bush the film that carries is as long as k = sqrt(1 - eps^2), and there the squeeze
velocity counts as (cos alpha, k sin alpha): between alpha = 80 and 100 degrees, say, the force then
changes from that of an approaching to that of a retreating journal, five powers of ten smaller.
Hence the grid is uniform in

    xi = atanh(eps),    gamma = (alpha + beta)/2,    beta = atan2(k sin alpha, cos alpha),

so that half of the columns lie in that layer, and what is splined is asinh(k W/W_0), W_0 the force
at the centre: of one relative accuracy over all sizes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import make_interp_spline

from ..arrays import Array
from ..errors import InputError
from . import kernels
from .forces import CompiledForce, squeeze_force_scale

_Impedance = Callable[[float, float], tuple[float, float]]
"""(eccentricity ratio, alpha [rad]) -> (radial, tangential) in units of 2 mu |v_s| L (R/c)^3."""
_MIRRORED_ROWS = 8


@dataclass(frozen=True)
class ForceMap:
    """Impedance on a uniform grid of xi and gamma, as a bicubic B-spline (C2).

    coefficients : (2, rows + 2, columns + 3) array. Of asinh(k W/W_0), radial and tangential.
    first, step, last : Of the radial coordinate xi; rows below 0 mirror the map through the centre,
        so that the force is smooth there.
    central : W_0, the impedance of the centred journal.
    note : What a user should know of how the map came about.
    """

    coefficients: Array
    first: float
    step: float
    last: float
    central: float
    note: str = field(default="", compare=False)

    @property
    def max_eccentricity_ratio(self) -> float:
        """Return the end of the solved grid; from there the force grows as (1 - eps^2)^(-3/2)."""
        return math.tanh(self.last)

    @property
    def numbers(self) -> Array:
        """Return the numbers the compiled kernel needs besides the coefficients, (4,)."""
        return np.array([self.first, self.step, self.last, self.central])

    def impedance(self, eccentricity_ratio: float, angle: float) -> tuple[float, float]:
        """Return the radial and tangential impedance at one point."""
        return kernels.map_impedance(
            float(eccentricity_ratio), float(angle), self.numbers, self.coefficients
        )

    @classmethod
    def build(
        cls,
        impedance: _Impedance,
        *,
        max_eccentricity_ratio: float = 0.9995,
        rows: int = 48,
        columns: int = 128,
        symmetric: bool = True,
        progress: Callable[[int, int], None] | None = None,
    ) -> ForceMap:
        """Solve the film on the grid and spline it.

        impedance : (eccentricity ratio, alpha) -> (radial, tangential), see `_Impedance`. With
            `symmetric` it is called for alpha from 0 to pi only, row by row, alpha ascending: a
            film solver may start each call from the one before.
        max_eccentricity_ratio : Of the last row.
        rows : From eps = 0 on, equally spaced in xi.
        columns : Over the whole turn, equally spaced in gamma; even.
        symmetric : Whether the bearing looks the same mirrored: plain, p = 0 at the ends and at
            inception.
        progress : Called with rows done and rows in all.
        Raises InputError: A grid that is too coarse, or a value that is not finite.
        """
        if not 0.0 < max_eccentricity_ratio < 1.0:
            raise InputError(
                "must lie between 0 and 1, both excluded",
                key="max_eccentricity_ratio",
                value=max_eccentricity_ratio,
            )
        if rows < 16 or columns < 16 or columns % 2:
            raise InputError(
                "needs 16 rows and columns or more, and columns even",
                key="rows, columns",
                value=(rows, columns),
            )
        radial = np.linspace(0.0, math.atanh(max_eccentricity_ratio), rows)
        values = np.empty((2, rows, columns))
        for i, place in enumerate(radial):
            values[:, i] = _row(impedance, math.tanh(place), columns, symmetric)
            if progress is not None:
                progress(i + 1, rows)
        if not np.all(np.isfinite(values)):
            raise InputError("the film force is not finite everywhere", key="impedance")
        central = float(np.hypot(*values[:, 0, 0]))
        values = np.arcsinh(values / np.cosh(radial)[:, None] / central)
        # the other side of the centre: W(-eps, alpha) = -W(eps, alpha + pi)
        across = -np.roll(values[:, _MIRRORED_ROWS:0:-1], columns // 2, axis=2)
        step = float(radial[1])
        return cls(
            _bicubic(np.concatenate([across, values], axis=1)),
            -_MIRRORED_ROWS * step,
            step,
            float(radial[-1]),
            central,
        )


@dataclass(frozen=True)
class FilmMapForce:
    """An isoviscous film's force from its map.

    force_map : Of the bearing's L/D and cavitation condition.
    viscosity : [Pa s]
    length, radius, radial_clearance : [m]
    """

    force_map: ForceMap
    viscosity: float
    length: float
    radius: float
    radial_clearance: float
    name: str = "film_map"

    def compiled(self, lowest_speed: float = 0.0, highest_speed: float = 0.0) -> CompiledForce:
        """Return the compiled form; good at any speed."""
        del lowest_speed, highest_speed
        scale = squeeze_force_scale(self.viscosity, self.length, self.radius, self.radial_clearance)
        numbers = np.array([self.radial_clearance, scale, *self.force_map.numbers])
        return CompiledForce(kernels.FORCE_MAP, numbers, self.force_map.coefficients)

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Return the film force [N]."""
        return self.compiled().evaluate(x, y, vx, vy, speed)


def _row(impedance: _Impedance, eps: float, columns: int, symmetric: bool) -> Array:
    """Return the radial and tangential impedance over one turn, (2, columns)."""
    angles = _angles(eps, columns)
    if not symmetric:
        return np.array([impedance(eps, float(a)) for a in angles]).T
    half = np.array([impedance(eps, float(a)) for a in angles[: columns // 2 + 1]]).T
    mirrored = half[:, -2:0:-1] * np.array([[1.0], [-1.0]])
    return np.concatenate([half, mirrored], axis=1)


def _angles(eps: float, columns: int) -> Array:
    """Return the angles alpha of the columns, (columns,), from 0 to 2 pi."""
    thinness = math.sqrt((1.0 - eps) * (1.0 + eps))
    wanted = 2.0 * np.pi * np.arange(columns // 2 + 1) / columns
    low, high = np.zeros(wanted.size), np.full(wanted.size, np.pi)
    for _ in range(60):
        middle = 0.5 * (low + high)
        found = np.array([kernels.map_column(float(a), thinness) for a in middle])
        low, high = np.where(found < wanted, middle, low), np.where(found < wanted, high, middle)
    half = 0.5 * (low + high)
    half[0], half[-1] = 0.0, np.pi
    return np.concatenate([half, 2.0 * np.pi - half[-2:0:-1]])


def _bicubic(values: Array) -> Array:
    """Return uniform cubic B-spline coefficients through values (2, n, m), periodic along the last.

    Along the second axis the ends are not-a-knot: the first two and last two intervals share one
    cubic.
    """
    _, n, m = values.shape
    matrix = np.zeros((n + 2, n + 2))
    index = np.arange(n)
    for offset, weight in enumerate((1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0)):
        matrix[index, index + offset] = weight
    matrix[n, :5] = matrix[n + 1, -5:] = (1.0, -4.0, 6.0, -4.0, 1.0)
    sides = np.concatenate([values, np.zeros((2, 2, m))], axis=1)
    along = np.linalg.solve(matrix[None], sides)
    closed = np.concatenate([along, along[:, :, :1]], axis=2)
    turn = np.moveaxis(closed, 2, 0)
    spline = make_interp_spline(np.arange(m + 1), turn, k=3, bc_type="periodic")
    return np.ascontiguousarray(np.moveaxis(spline.c, 0, 2))
