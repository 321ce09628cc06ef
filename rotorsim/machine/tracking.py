"""Eigenvalues followed over speed (or any parameter) by the likeness of their modes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import ComplexArray
from ..errors import InputError
from ..threads import on_one_blas_thread
from .branches import Modes
from .spectrum import Eigenmodes, Spectrum

_SAME_VALUE = 1e-6
"""Relative distance of eigenvalues that count as one multiple eigenvalue."""
_SMOOTH_MAC = 0.9
_SMOOTH_CHANGE = 0.1
_NEVER = 1e6
"""Cost of continuing a branch that has been lost."""
_PATIENCE = 64, 8
"""Parameters looked up for halved steps, and more of them for each value that is wanted."""


@on_one_blas_thread
def track_modes(
    spectrum: Spectrum, parameter: ArrayLike, refinements: int = 10, wanted: int | None = None
) -> Modes:
    """Follow eigenvalues over a parameter.

    spectrum : Modes at any parameter.
    parameter : (n,) array. Ascending; the result is given at these values.
    refinements : How often a step may be halved until neighbouring modes are alike.
    wanted : Number of eigenvalues of lowest modulus that must be followed smoothly; all by default.
        More may be returned: those that `spectrum` gives throughout.
    Returns: First column: the mode least stable at the first value.
    Raises InputError: The parameter does not ascend, or the modes are not known somewhere.

    Modes at neighbouring values are paired by an optimal assignment (Jonker and Volgenant) on the
    change of eigenvalue plus 1 - MAC, the modal assurance criterion of the displacements. Sorting
    by frequency exchanges modes that cross; this does not. A step is accepted when every pair has
    MAC > 0.9 and changes by less than a tenth, otherwise halved.
    """
    values = np.atleast_1d(np.asarray(parameter, dtype=float))
    if values.ndim != 1 or not np.all(np.isfinite(values)) or np.any(np.diff(values) <= 0.0):
        raise InputError("must be finite and ascend", key="parameter", value=parameter)
    follow = _Follower(spectrum, wanted, _PATIENCE[0] + _PATIENCE[1] * values.size)
    first = follow.at(float(values[0]))
    order = np.lexsort((-first.values.imag, -np.round(first.values.real, 9)))
    rows = [first.taken(order)]
    smooth = [True]
    for low, high in pairwise(values):
        state, good = follow.advance(float(low), rows[-1], float(high), refinements)
        rows.append(state)
        smooth.append(good)
    found = Modes(
        values,
        np.array([r.values for r in rows]),
        np.array([r.accuracy for r in rows]),
        np.array([r.shapes for r in rows]),
        np.array(smooth),
    )
    throughout = np.isfinite(found.eigenvalues).all(axis=0)
    return found if throughout.all() else found.columns(np.flatnonzero(throughout))


@dataclass
class _Follower:
    """Carries the labels of modes from one parameter to the next.

    left : How many parameters may still be looked up.
    """

    spectrum: Spectrum
    wanted: int | None
    left: int

    def at(self, parameter: float) -> Eigenmodes:
        """Return the modes at one parameter."""
        self.left -= 1
        found = self.spectrum(parameter)
        if found is None:
            raise InputError("the modes are not known here", key="parameter", value=parameter)
        return found

    def advance(
        self, low: float, state: Eigenmodes, high: float, depth: int
    ) -> tuple[Eigenmodes, bool]:
        """Carry the labels from `low` to `high`, halving the step while modes change too much."""
        new, good = self._pair(state, self.at(high))
        if good or depth == 0 or self.left <= 0:
            return new, good
        middle = 0.5 * (low + high)
        half, first = self.advance(low, state, middle, depth - 1)
        end, second = self.advance(middle, half, high, depth - 1)
        return end, first and second

    def _pair(self, old: Eigenmodes, new: Eigenmodes) -> tuple[Eigenmodes, bool]:
        """Return new modes in the old order (NaN: lost), and whether all wanted are alike."""
        from scipy.optimize import linear_sum_assignment

        mac = np.abs(old.shapes.conj() @ new.shapes.T) ** 2
        size = np.abs(old.values)[:, None] + np.abs(new.values)[None, :]
        size = np.maximum(size, old.accuracy[:, None] + new.accuracy[None, :])
        change = 2.0 * np.abs(old.values[:, None] - new.values[None, :])
        change = change / np.where(size > 0.0, size, 1.0)
        cost = np.nan_to_num(change + 1.0 - mac, nan=_NEVER)
        row, column = linear_sum_assignment(cost)
        limit = max(self._reach(old), self._reach(new))
        inner = np.minimum(np.abs(old.values[row]), np.abs(new.values[column])) <= limit
        alike = np.array(
            [
                change[i, j] < _SMOOTH_CHANGE
                and (mac[i, j] > _SMOOTH_MAC or _likeness(old, i, new.shapes[j]) > _SMOOTH_MAC)
                for i, j in zip(row[inner], column[inner], strict=True)
            ]
        )
        lost = row[~np.isfinite(old.values[row])]
        count, width = old.values.size, new.shapes.shape[1]
        values = np.full(count, np.nan, dtype=complex)
        accuracy, shapes = np.full(count, np.nan), np.zeros((count, width), dtype=complex)
        values[row], accuracy[row], shapes[row] = (
            new.values[column], new.accuracy[column], new.shapes[column],
        )  # fmt: skip
        values[lost], accuracy[lost] = np.nan, np.nan
        return Eigenmodes(values, accuracy, shapes), bool(alike.all())

    def _reach(self, modes: Eigenmodes) -> float:
        """Return the modulus up to which modes must be followed smoothly."""
        size = np.sort(np.abs(modes.values[np.isfinite(modes.values)]))
        if self.wanted is None or size.size <= self.wanted:
            return np.inf
        return float(size[self.wanted - 1])


def _likeness(old: Eigenmodes, i: int, shape: ComplexArray) -> float:
    """Return the MAC of a shape and the space of the modes that share eigenvalue i.

    The shapes of a multiple eigenvalue (a free rotor, an isotropic one at rest) are any basis.
    """
    near = _SAME_VALUE * abs(old.values[i]) + old.accuracy[i]
    cluster = np.flatnonzero(np.abs(old.values - old.values[i]) <= near)
    if cluster.size == 1:
        return 0.0
    basis = np.linalg.qr(old.shapes[cluster].T)[0]
    return float(np.sum(np.abs(basis.conj().T @ shape) ** 2))
