"""Anderson acceleration of a fixed-point iteration x = g(x)."""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class AndersonMixer:
    """Next iterate from the last few pairs (x, g(x)) (Walker & Ni, SIAM J. Numer. Anal. 49, 2011).

    Parameters
    ----------
    depth : int
        Pairs remembered.
    damping : float
        Share of g taken in a plain step, and in the mixed one.
    """

    def __init__(self, depth: int = 5, damping: float = 1.0) -> None:
        self._steps: deque[Array] = deque(maxlen=depth)
        self._changes: deque[Array] = deque(maxlen=depth)
        self._damping = damping
        self._last: tuple[Array, Array] | None = None

    def forget(self) -> None:
        """Drop the history, as when the problem itself has moved."""
        self._steps.clear()
        self._changes.clear()
        self._last = None

    def next(self, x: Array, g: Array) -> Array:
        """The next x; `x` and `g` = g(x) are flat and are not changed."""
        residual = g - x
        if self._last is not None:
            self._steps.append(x - self._last[0])
            self._changes.append(residual - self._last[1])
        self._last = (x, residual)
        if not self._changes:
            return x + self._damping * residual
        changes = np.stack(self._changes)
        gram = changes @ changes.T
        # A hair of regularisation keeps nearly parallel histories from blowing up the mix.
        gram[np.diag_indices_from(gram)] *= 1.0 + 1e-10
        try:
            weights = np.linalg.solve(gram, changes @ residual)
        except np.linalg.LinAlgError:
            self.forget()
            return x + self._damping * residual
        if not np.all(np.isfinite(weights)) or np.abs(weights).sum() > 1e3:
            self.forget()
            return x + self._damping * residual
        mixed = x + self._damping * residual
        for weight, step, change in zip(weights, self._steps, self._changes, strict=True):
            mixed -= weight * (step + self._damping * change)
        return mixed
