"""The frame and signs of ROSS, in words for its files, and the turn from the load frame to it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..errors import TableError
from ..table.variables import SIGNS

WEIGHT = -0.5 * math.pi
"""Direction of the weight in the frame of ROSS [rad]: along -y."""

_WEIGHT_FRAME = (
    "Frame of ROSS: z along the shaft, the shaft turning from x to y, y up; the static load is",
    "the weight, along -y.",
    *SIGNS,
    "From rotorsim's load frame (x_l along the load, y_l 90 degrees ahead of it with the",
    "rotation): x = y_l, y = -x_l, so that kxx = k_yy, kxy = -k_yx, kyx = -k_xy, kyy = k_xx",
    "(on the right in the load frame), and the same for c. Where the load points elsewhere in your",
    "model, turn the coefficients to it first.",
)


def frame_of_ross(load_direction: float = WEIGHT) -> tuple[str, ...]:
    """Lines that say what coefficients in the frame of ROSS mean.

    Parameters
    ----------
    load_direction : float
        Where the static load points [rad], from x of ROSS towards its y.
    """
    degrees = in_degrees(load_direction)
    if degrees == in_degrees(WEIGHT):
        return _WEIGHT_FRAME
    return (
        "Frame of ROSS: z along the shaft, the shaft turning from x to y, y up; the static load",
        f"points {degrees:.13g} degrees from x towards y.",
        *SIGNS,
        "From rotorsim's load frame (x_l along the load, y_l 90 degrees ahead of it with the",
        "rotation): x = cos x_l - sin y_l, y = sin x_l + cos y_l, with cos and sin of",
        f"{degrees:.13g} degrees, so that",
        "kxx = cos^2 k_xx - sin cos (k_xy + k_yx) + sin^2 k_yy",
        "kxy = cos^2 k_xy + sin cos (k_xx - k_yy) - sin^2 k_yx",
        "kyx = cos^2 k_yx + sin cos (k_xx - k_yy) - sin^2 k_xy",
        "kyy = cos^2 k_yy + sin cos (k_xy + k_yx) + sin^2 k_xx",
        "(on the right in the load frame), and the same for c.",
    )


def in_degrees(load_direction: float) -> float:
    """Direction in degrees, from -180 to 180.

    Rounded to 1e-10, so that what a file says of it is what its numbers were turned by.

    Raises
    ------
    TableError
        Not finite.

    Examples
    --------
    >>> in_degrees(1.5 * math.pi)
    -90.0
    """
    if not math.isfinite(load_direction):
        raise TableError("must be a finite angle", key="load_direction", value=load_direction)
    return round(math.remainder(math.degrees(load_direction), 360.0), 10)


def to_ross(matrices: NDArray[np.float64], load_direction: float = WEIGHT) -> NDArray[np.float64]:
    """Turn (..., 2, 2) matrices from the load frame to the frame of ROSS.

    Parameters
    ----------
    matrices : (..., 2, 2) array
        Stiffness or damping.
    load_direction : float
        Where the static load points [rad], from x of ROSS towards its y.

    Examples
    --------
    >>> to_ross(np.array([[1.0, 2.0], [3.0, 4.0]])).tolist()
    [[4.0, -3.0], [-2.0, 1.0]]
    """
    turn = _turn(load_direction)
    return turn @ matrices @ turn.T


def from_ross(matrices: NDArray[np.float64], load_direction: float = WEIGHT) -> NDArray[np.float64]:
    """Inverse of `to_ross`."""
    turn = _turn(load_direction)
    return turn.T @ matrices @ turn


def _turn(load_direction: float) -> NDArray[np.float64]:
    """(2, 2): components in the frame of ROSS from those in the load frame."""
    degrees = in_degrees(load_direction)
    cosine, sine = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    if degrees % 90.0 == 0.0:  # numbers only change places and signs, to the last digit
        cosine, sine = round(cosine), round(sine)
    return np.array([[cosine, -sine], [sine, cosine]], dtype=float)
