"""Growth rates of rigid rotors by the million."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from .matrices import state_matrix

Array = NDArray[np.float64]

_BLOCK = 65536
"""Systems handed to the dense eigenvalue solver at once; bounds its memory."""


def eigenvalues(
    stiffness: ArrayLike, damping: ArrayLike, mass: ArrayLike
) -> NDArray[np.complex128]:
    """Eigenvalues of m x'' + C x' + K x = 0 [rad/s], shape (..., 4), in no particular order.

    Parameters are those of `state_matrix`. Entries that are not finite give NaN.
    """
    a = state_matrix(stiffness, damping, mass)
    good = np.isfinite(a).all(axis=(-2, -1))
    values = np.full(a.shape[:-1], np.nan, dtype=complex)
    if good.any():
        values[good] = np.linalg.eigvals(_balanced(a[good]))
    return values


def _balanced(a: Array) -> Array:
    """Measure time in units that give displacements and velocities like sizes (a similarity)."""
    tiny = np.finfo(float).tiny
    scale = np.sqrt(np.abs(a[..., 2:, :2]).max(axis=(-2, -1), keepdims=True) + tiny)
    result = a.copy()
    result[..., :2, 2:] *= scale
    result[..., 2:, :2] /= scale
    return result


def growth_rates(stiffness: ArrayLike, damping: ArrayLike, mass: ArrayLike) -> Array:
    """Largest real part of the four eigenvalues: positive where the rotor is unstable.

    stiffness, damping : (..., 2, 2) arrays [N/m], [N s/m]
    mass : [kg], broadcast against the leading dimensions.
    Returns: [1/s]; NaN where a coefficient is not finite.
    Raises InputError: A mass is not above zero.

    With M(s) the mean of the two diagonal entries of s^2 + (C s + K)/m, the characteristic
    polynomial is M(s)^2 - N(s), N a quadratic: the form from which Ferrari's method starts. It is
    solved in the time unit (m^2/|det K|)^(1/4), and Newton polishes each root in that same form,
    which keeps its digits when both modes are nearly alike. Where a root's estimated rounding error
    exceeds 1e-11, or the roots' sum or product is wrong, the dense eigenvalue solver takes over.

    Examples
    --------
    >>> growth_rates([[1.0, 5.0], [-5.0, 1.0]], np.eye(2), [0.02, 0.04, 0.08]).round(12) + 0.0
    array([-0.48473118,  0.        ,  0.62287624])
    """
    k, c = np.asarray(stiffness, dtype=float), np.asarray(damping, dtype=float)
    m = np.asarray(mass, dtype=float)
    lead = np.broadcast_shapes(k.shape[:-2], c.shape[:-2], m.shape)
    flat_k = np.broadcast_to(k, (*lead, 2, 2)).reshape(-1, 4)
    flat_c = np.broadcast_to(c, (*lead, 2, 2)).reshape(-1, 4)
    flat_m = np.ascontiguousarray(np.broadcast_to(m, lead).reshape(-1))
    _check_mass(flat_m)
    from ._quartic import fill_rates_pairwise

    rate = np.empty(flat_m.shape)
    fill_rates_pairwise(np.ascontiguousarray(flat_k), np.ascontiguousarray(flat_c), flat_m, rate)
    doubtful = np.flatnonzero(np.isnan(rate))
    _solve_densely(rate, doubtful, flat_k[doubtful], flat_c[doubtful], flat_m[doubtful])
    return rate.reshape(lead)


def growth_rate_map(stiffness: ArrayLike, damping: ArrayLike, mass: ArrayLike) -> Array:
    """Growth rates of every operating point with every mass, shape (..., n_mass) [1/s].

    stiffness, damping : (..., 2, 2) arrays [N/m], [N s/m]
    mass : (n_mass,) array [kg]
    """
    k, c = np.broadcast_arrays(np.asarray(stiffness, float), np.asarray(damping, float))
    m = np.ascontiguousarray(np.atleast_1d(np.asarray(mass, dtype=float)))
    _check_mass(m)
    from ._quartic import fill_rates

    flat_k = np.ascontiguousarray(k.reshape(-1, 4))
    flat_c = np.ascontiguousarray(c.reshape(-1, 4))
    rate = np.empty((flat_k.shape[0], m.size))
    fill_rates(flat_k, flat_c, m, rate)
    doubtful = np.flatnonzero(np.isnan(rate.ravel()))
    row, column = np.divmod(doubtful, m.size)
    finite = np.isfinite(flat_k[row]).all(axis=1) & np.isfinite(flat_c[row]).all(axis=1)
    doubtful, row, column = doubtful[finite], row[finite], column[finite]
    _solve_densely(rate.reshape(-1), doubtful, flat_k[row], flat_c[row], m[column])
    return rate.reshape(*k.shape[:-2], m.size)


def _check_mass(mass: Array) -> None:
    if not np.all((mass > 0.0) & np.isfinite(mass)):
        bad = mass[~((mass > 0.0) & np.isfinite(mass))][0]
        raise InputError("must be above 0 (kg)", key="mass", value=float(bad))


def _solve_densely(
    rate: Array, where: NDArray[np.intp], stiffness: Array, damping: Array, mass: Array
) -> None:
    for start in range(0, where.size, _BLOCK):
        part = slice(start, start + _BLOCK)
        values = eigenvalues(
            stiffness[part].reshape(-1, 2, 2), damping[part].reshape(-1, 2, 2), mass[part]
        )
        rate[where[part]] = values.real.max(axis=-1)
