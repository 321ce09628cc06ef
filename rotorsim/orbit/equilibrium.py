"""Static position and linearisation of a film force known as a function."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root

from ..errors import InputError
from .forces import BearingForce

Array = NDArray[np.float64]


def find_equilibrium(
    force: BearingForce, load: tuple[float, float], speed: float
) -> tuple[float, float]:
    """Position (x, y) [m] where the film carries the static load [N] at a speed [rad/s].

    Raises
    ------
    InputError
        No position within the clearance carries the load.

    Notes
    -----
    Newton-Powell on p with position = c p/sqrt(1 + p.p), which cannot leave the clearance; started
    from several eccentricities.
    """
    clearance = force.radial_clearance
    weight = float(np.hypot(*load))
    if weight == 0.0:
        return 0.0, 0.0

    def position(p: Array) -> Array:
        return clearance * p / np.sqrt(1.0 + p @ p)

    def residual(p: Array) -> Array:
        x, y = position(p)
        return (np.array(force.force(x, y, 0.0, 0.0, speed)) + load) / weight

    along = np.asarray(load) / weight
    ahead = np.array([-along[1], along[0]])
    for eps in (0.5, 0.2, 0.8, 0.05, 0.95):
        attitude = np.arccos(eps)
        start = eps / np.sqrt(1.0 - eps**2) * (along * eps + ahead * np.sin(attitude))
        found = root(residual, start, method="hybr", options={"xtol": 1e-13})
        if np.max(np.abs(residual(found.x))) < 1e-8:
            x, y = position(found.x)
            return float(x), float(y)
    raise InputError(
        f"no position within the clearance carries this load at {speed:g} rad/s; "
        "lower the load or raise the speed",
        key="operating.load",
        value=weight,
    )


def linearize_force(
    force: BearingForce, x: float, y: float, speed: float, step: float = 1e-5
) -> tuple[Array, Array]:
    """K [N/m] and C [N s/m] by fourth-order central differences at a position at rest.

    Parameters
    ----------
    step : float
        Over the clearance (and over clearance times speed).
    """
    clearance = force.radial_clearance

    def column(direction: Array, size: float) -> Array:
        total = np.zeros(2)
        for weight, k in ((8.0, 1.0), (1.0, -2.0), (-8.0, -1.0), (-1.0, 2.0)):
            dx, dy, vx, vy = (float(d) for d in k * size * direction)
            total += weight * np.array(force.force(x + dx, y + dy, vx, vy, speed))
        return -total / (12.0 * size)

    lengths = np.array([1.0, 1.0, speed, speed]) * step * clearance
    columns = [column(np.eye(4)[i], lengths[i]) for i in range(4)]
    return np.column_stack(columns[:2]), np.column_stack(columns[2:])
