"""Eigenvalues followed over speed (or any parameter) as continuous branches."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bearing.table import CoefficientTable
from ..errors import InputError
from .matrices import state_matrix

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
MatrixOf = Callable[[float], Array]

_SMOOTH_MAC = 0.9
_SMOOTH_CHANGE = 0.1


@dataclass(frozen=True, eq=False)
class Branches:
    """Eigenvalues of A(parameter), each column one continuous branch.

    Attributes
    ----------
    parameter : (n,) array
        Shaft speed [rad/s] unless said otherwise.
    eigenvalues : (n, k) complex array
        [rad/s]
    shapes : (n, k, m) complex array
        Displacements of each mode, of unit length.
    smooth : (n,) bool array
        False where the step from the point before stayed abrupt at the finest refinement (a
        pair of real eigenvalues met there, say): the labels may have been exchanged.
    """

    parameter: Array
    eigenvalues: ComplexArray
    shapes: ComplexArray
    smooth: NDArray[np.bool_]

    @property
    def damped_frequency(self) -> Array:
        """|Im lambda| [rad/s]."""
        return np.abs(self.eigenvalues.imag)

    @property
    def damping_ratio(self) -> Array:
        """-Re lambda/|lambda|."""
        size = np.abs(self.eigenvalues)
        return np.divide(-self.eigenvalues.real, size, out=np.zeros_like(size), where=size > 0.0)

    @property
    def log_decrement(self) -> Array:
        """-2 pi Re lambda/|Im lambda|; NaN for a mode that does not oscillate."""
        frequency = self.damped_frequency
        return np.where(
            frequency > 0.0,
            -2.0 * np.pi * self.eigenvalues.real / np.where(frequency > 0.0, frequency, 1.0),
            np.nan,
        )

    def whirl_direction(self, x: int = 0, y: int = 1) -> Array:
        """Sense of the orbit: 1 a forward circle, -1 a backward circle, 0 a straight line.

        Parameters
        ----------
        x, y : int
            The degrees of freedom whose orbit is meant.
        """
        a, b = self.shapes[..., x], self.shapes[..., y]
        area = -2.0 * np.imag(np.conj(a) * b) * np.sign(self.eigenvalues.imag)
        size = np.abs(a) ** 2 + np.abs(b) ** 2
        return np.divide(area, size, out=np.zeros_like(size), where=size > 0.0)

    def whirl_sense(self, planes: Sequence[tuple[int, int]] = ((0, 1),)) -> Array:
        """`whirl_direction` at the node where each mode moves most, (n, k).

        Parameters
        ----------
        planes : sequence of (int, int)
            Degrees of freedom x, y of the nodes.
        """
        size = np.stack([np.linalg.norm(self.shapes[..., list(p)], axis=-1) for p in planes])
        sense = np.stack([self.whirl_direction(x, y) for x, y in planes])
        return np.take_along_axis(sense, size.argmax(axis=0)[None], axis=0)[0]

    def lowest(self, count: int) -> Branches:
        """Keep `count` branches, those that reach the lowest frequencies."""
        keep = np.sort(np.argsort(self.damped_frequency.min(axis=0), kind="stable")[:count])
        return Branches(
            self.parameter, self.eigenvalues[:, keep], self.shapes[:, keep], self.smooth
        )

    def oscillating(self) -> Branches:
        """Keep one branch of each conjugate pair (Im >= 0 on the whole), as a Campbell diagram."""
        keep = np.flatnonzero(self.eigenvalues.imag.sum(axis=0) >= 0.0)
        keep = keep[self.eigenvalues.imag[:, keep].max(axis=0) > 0.0]
        return Branches(
            self.parameter, self.eigenvalues[:, keep], self.shapes[:, keep], self.smooth
        )

    def critical_speeds(self, order: float = 1.0) -> list[tuple[int, float]]:
        """Branch and speed [rad/s] where a damped frequency equals `order` times the speed."""
        found = []
        difference = self.damped_frequency - order * self.parameter[:, None]
        for branch in range(difference.shape[1]):
            d = difference[:, branch]
            for i in np.flatnonzero(np.sign(d[:-1]) * np.sign(d[1:]) < 0.0):
                t = d[i] / (d[i] - d[i + 1])
                speed = self.parameter[i] + t * (self.parameter[i + 1] - self.parameter[i])
                found.append((branch, float(speed)))
        return found


def track_modes(matrix: MatrixOf, parameter: ArrayLike, refinements: int = 10) -> Branches:
    """Follow the eigenvalues of a state matrix over a parameter.

    Parameters
    ----------
    matrix : callable
        Parameter to (2m, 2m) state matrix on displacements, then velocities.
    parameter : (n,) array
        Ascending; the result is given at these values.
    refinements : int
        How often a step may be halved until neighbouring modes are alike.

    Returns
    -------
    Branches
        First column: the mode least stable at the first value.

    Raises
    ------
    InputError
        The parameter does not ascend.

    Notes
    -----
    Modes at neighbouring values are paired by an optimal assignment (Jonker and Volgenant) on the
    change of eigenvalue plus 1 - MAC, the modal assurance criterion of the displacements. Sorting
    by frequency exchanges modes that cross; this does not. A step is accepted when every pair has
    MAC > 0.9 and changes by less than a tenth, otherwise halved.
    """
    values = np.atleast_1d(np.asarray(parameter, dtype=float))
    if values.ndim != 1 or not np.all(np.isfinite(values)) or np.any(np.diff(values) <= 0.0):
        raise InputError("must be finite and ascend", key="parameter", value=parameter)
    eigenvalues, shapes = _modes(matrix(float(values[0])))
    order = np.lexsort((-eigenvalues.imag, -np.round(eigenvalues.real, 9)))
    rows = [(eigenvalues[order], shapes[order])]
    smooth = [True]
    for low, high in pairwise(values):
        state, good = _advance(matrix, float(low), rows[-1], float(high), refinements)
        rows.append(state)
        smooth.append(good)
    return Branches(
        values,
        np.array([r[0] for r in rows]),
        np.array([r[1] for r in rows]),
        np.array(smooth),
    )


def _modes(a: Array) -> tuple[ComplexArray, ComplexArray]:
    eigenvalues, vectors = np.linalg.eig(a)
    shapes = vectors[: a.shape[0] // 2].T.astype(complex)
    return eigenvalues.astype(complex), shapes / np.linalg.norm(shapes, axis=1, keepdims=True)


def _advance(
    matrix: MatrixOf,
    low: float,
    state: tuple[ComplexArray, ComplexArray],
    high: float,
    depth: int,
) -> tuple[tuple[ComplexArray, ComplexArray], bool]:
    """Carry the labels from `low` to `high`, halving the step while modes change too much."""
    new = _modes(matrix(high))
    order, mac, change = _pair(state, new)
    good = bool(mac.min() > _SMOOTH_MAC and change.max() < _SMOOTH_CHANGE)
    if good or depth == 0:
        return (new[0][order], new[1][order]), good
    middle = 0.5 * (low + high)
    half, first = _advance(matrix, low, state, middle, depth - 1)
    end, second = _advance(matrix, middle, half, high, depth - 1)
    return end, first and second


def _pair(
    old: tuple[ComplexArray, ComplexArray], new: tuple[ComplexArray, ComplexArray]
) -> tuple[NDArray[np.intp], Array, Array]:
    from scipy.optimize import linear_sum_assignment

    mac = np.abs(old[1].conj() @ new[1].T) ** 2
    size = np.abs(old[0])[:, None] + np.abs(new[0])[None, :]
    change = 2.0 * np.abs(old[0][:, None] - new[0][None, :]) / np.where(size > 0.0, size, 1.0)
    row, column = linear_sum_assignment(change + 1.0 - mac)
    return column, mac[row, column], change[row, column]


def rigid_modes(
    table: CoefficientTable, mass: float, speed: ArrayLike | None = None, **choices: object
) -> Branches:
    """Modes of the rigid rotor over speed, coefficients interpolated in the table.

    Parameters
    ----------
    table : CoefficientTable
    mass : float
        Per bearing [kg].
    speed : array, optional
        [rad/s]; the tabulated speeds by default.
    **choices
        As for `CoefficientTable.select`.
    """
    curve = table.interpolator(**choices)
    return track_modes(
        lambda omega: state_matrix(*curve(omega), mass),
        table.speeds if speed is None else speed,
    )


@dataclass(frozen=True)
class ThresholdSpeed:
    """Where the rotor changes its verdict.

    Attributes
    ----------
    speed : float
        [rad/s]
    whirl_frequency : float
        Of the mode that crosses [rad/s]; 0 for a static divergence.
    whirl_frequency_ratio : float
    becomes_unstable : bool
        With rising speed; False: it becomes stable.
    """

    speed: float
    whirl_frequency: float
    whirl_frequency_ratio: float
    becomes_unstable: bool


def find_thresholds(matrix: MatrixOf, speeds: Sequence[float] | Array) -> list[ThresholdSpeed]:
    """Speeds at which the least stable eigenvalue crosses the imaginary axis.

    Parameters
    ----------
    matrix : callable
        Speed [rad/s] to state matrix; one with NaN marks a speed without coefficients.
    speeds : sequence of float
        Ascending; one crossing is found between two neighbours whose verdicts differ.

    Returns
    -------
    list of ThresholdSpeed
        Ascending, speed to a relative 1e-13. Empty: one verdict everywhere.
    """
    from scipy.optimize import brentq

    def leading(omega: float) -> complex:
        a = matrix(omega)
        if not np.all(np.isfinite(a)):
            return complex(np.nan, np.nan)
        values = np.linalg.eigvals(a)
        return complex(values[values.real.argmax()])

    grid = [float(s) for s in speeds]
    rates = [leading(s).real for s in grid]
    found = []
    tolerance: dict[str, Any] = {"xtol": 1e-13 * max(map(abs, grid)), "rtol": 1e-13}
    for i in range(len(grid) - 1):
        low, high = rates[i], rates[i + 1]
        if np.isnan(low) or np.isnan(high) or (low < 0.0) == (high < 0.0):
            continue
        root: Any = brentq(lambda s: leading(s).real, grid[i], grid[i + 1], **tolerance)
        speed = float(root)
        whirl = abs(leading(speed).imag)
        found.append(ThresholdSpeed(speed, whirl, whirl / speed, low < 0.0))
    return found


def threshold_speeds(
    table: CoefficientTable, mass: float, subdivisions: int = 8, **choices: object
) -> list[ThresholdSpeed]:
    """Threshold speeds of the rigid rotor on the interpolated table.

    Parameters
    ----------
    table : CoefficientTable
    mass : float
        Per bearing [kg].
    subdivisions : int
        Points looked at in every interval of the table.
    **choices
        As for `CoefficientTable.select`.

    Returns
    -------
    list of ThresholdSpeed
    """
    curve = table.interpolator(**choices)
    knots = table.speeds
    parts = np.arange(subdivisions) / subdivisions
    grid = np.append((knots[:-1, None] + np.diff(knots)[:, None] * parts).ravel(), knots[-1])
    return find_thresholds(lambda omega: state_matrix(*curve(omega, gaps="nan"), mass), grid)
