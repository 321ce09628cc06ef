"""State matrices as plain arrays: the form that maps, mode tracking and integrators use."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError

Array = NDArray[np.float64]


def state_matrix(stiffness: ArrayLike, damping: ArrayLike, mass: ArrayLike) -> Array:
    """State matrices of the rigid rotor m x'' + C x' + K x = 0 (Dal Eq. 21).

    Parameters
    ----------
    stiffness, damping : (..., 2, 2) arrays
        [N/m], [N s/m]
    mass : array
        Per bearing [kg], broadcast against the leading dimensions.

    Returns
    -------
    (..., 4, 4) array
        Acting on (x, y, vx, vy).

    Raises
    ------
    InputError
        A mass is not above zero.
    """
    k = np.asarray(stiffness, dtype=float)
    c = np.asarray(damping, dtype=float)
    m = np.asarray(mass, dtype=float)
    if not np.all(m > 0.0):
        raise InputError("must be above 0 (kg)", key="mass", value=mass)
    lead = np.broadcast_shapes(k.shape[:-2], c.shape[:-2], m.shape)
    a = np.zeros((*lead, 4, 4))
    a[..., 0, 2] = a[..., 1, 3] = 1.0
    a[..., 2:, :2] = -k / m[..., None, None]
    a[..., 2:, 2:] = -c / m[..., None, None]
    return a


def second_order_state_matrix(mass: ArrayLike, damping: ArrayLike, stiffness: ArrayLike) -> Array:
    """State matrix (2n, 2n) of M q'' + D q' + K q = 0 on (q, q'); M must be regular."""
    m = np.asarray(mass, dtype=float)
    n = m.shape[0]
    a = np.zeros((2 * n, 2 * n))
    a[:n, n:] = np.eye(n)
    a[n:] = -np.linalg.solve(m, np.hstack([np.asarray(stiffness), np.asarray(damping)]))
    return a
