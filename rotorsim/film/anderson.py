"""Anderson acceleration of a fixed-point iteration x = g(x)."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from .kernels import kernel


class AndersonMixer:
    """Next iterate from the last few pairs (x, g(x)) (Walker & Ni, SIAM J. Numer. Anal. 49, 2011).

    The differences are kept in place and their products updated one row a step, so that a step
    costs about two passes over the history.

    size : Unknowns.
    depth : Pairs remembered.
    """

    def __init__(self, size: int, depth: int = 6) -> None:
        self._depth = depth
        self._changes = np.empty((depth, size))
        self._moves = np.empty((depth, size))
        self._gram = np.zeros((depth, depth))
        self._last_x = np.empty(size)
        self._last_residual = np.empty(size)
        self.forget()

    def forget(self) -> None:
        """Drop the history, as when the problem itself has moved."""
        self._filled = 0
        self._slot = 0
        self._started = False

    def next(self, x: Array, g: Array) -> Array:
        """Return the next x; `x` and `g` = g(x) are flat and are not changed."""
        if self._started:
            products, right = np.zeros(self._depth), np.zeros(self._depth)
            filled = min(self._filled + 1, self._depth)
            _remember(
                x, g, self._last_x, self._last_residual, self._changes, self._moves, self._slot,
                filled, products, right,
            )  # fmt: skip
            self._gram[self._slot, :] = products
            self._gram[:, self._slot] = products
            self._filled, self._slot = filled, (self._slot + 1) % self._depth
        else:
            self._last_x[:] = x
            self._last_residual[:] = g - x
            self._started = True
            return g.copy()
        weights = self._weights(right[: self._filled])
        if weights is None:
            self.forget()
            return g.copy()
        return _mix(g, self._moves, weights)

    def _weights(self, right: Array) -> Array | None:
        """Return the least-squares weights; None if the history is of no use."""
        gram = self._gram[: self._filled, : self._filled]
        scale = np.sqrt(np.diag(gram))
        if not np.all(scale > 0.0):
            return None
        scaled = gram / scale[:, None] / scale[None, :]
        # A little regularisation keeps nearly parallel histories from blowing up the mix.
        scaled[np.diag_indices_from(scaled)] += 1e-10
        try:
            weights = np.linalg.solve(scaled, right / scale) / scale
        except np.linalg.LinAlgError:
            return None
        if not np.all(np.isfinite(weights)) or np.abs(weights).sum() > 1e3:
            return None
        return weights


@kernel
def _remember(x, g, last_x, last_residual, changes, moves, slot, filled, products, right):
    """Store the newest differences; products of the new change, and of all with the residual."""
    size = x.size
    for p in range(size):
        residual = g[p] - x[p]
        change = residual - last_residual[p]
        changes[slot, p] = change
        moves[slot, p] = x[p] - last_x[p] + change
        last_x[p] = x[p]
        last_residual[p] = residual
    for q in range(filled):
        product, projection = 0.0, 0.0
        for p in range(size):
            product += changes[q, p] * changes[slot, p]
            projection += changes[q, p] * last_residual[p]
        products[q] = product
        right[q] = projection


@kernel
def _mix(g, moves, weights):
    mixed = g.copy()
    for q in range(weights.size):
        weight = weights[q]
        for p in range(g.size):
            mixed[p] -= weight * moves[q, p]
    return mixed
