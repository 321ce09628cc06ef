"""The frame and signs of ROSS, in words for its files, and the turn from the load frame to it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..table.variables import SIGNS

ROSS_FRAME = (
    "Frame of ROSS: z along the shaft, the shaft turning from x to y, y up; the static load is",
    "the weight, along -y.",
    *SIGNS,
    "From rotorsim's load frame (x_l along the load, y_l 90 degrees ahead of it with the",
    "rotation): x = y_l, y = -x_l, so that kxx = k_yy, kxy = -k_yx, kyx = -k_xy, kyy = k_xx",
    "(on the right in the load frame), and the same for c. Where the load points elsewhere in your",
    "model, turn the coefficients to it first.",
)
_QUARTER_TURN = np.array([[0.0, 1.0], [-1.0, 0.0]])
"""(x, y) of ROSS from (x, y) of the load frame."""


def to_ross(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn (..., 2, 2) matrices from the load frame to the frame of ROSS, the load along -y.

    Examples
    --------
    >>> to_ross(np.array([[1.0, 2.0], [3.0, 4.0]])).tolist()
    [[4.0, -3.0], [-2.0, 1.0]]
    """
    return _QUARTER_TURN @ matrices @ _QUARTER_TURN.T


def from_ross(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Inverse of `to_ross`."""
    return _QUARTER_TURN.T @ matrices @ _QUARTER_TURN
