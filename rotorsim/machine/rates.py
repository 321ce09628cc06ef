"""Growth rates of rigid rotors by the million, from quartics in closed form."""

from __future__ import annotations

import cmath
import math

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, ComplexArray, Indices
from ..compiled import compiled
from ..errors import InputError
from .matrices import state_matrix

_BLOCK = 65536
"""Systems handed to the dense eigenvalue solver at once; bounds its memory."""


def eigenvalues(stiffness: ArrayLike, damping: ArrayLike, mass: ArrayLike) -> ComplexArray:
    """Return eigenvalues of m x'' + C x' + K x = 0 [rad/s], shape (..., 4), in no particular order.

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


def growth_rate_map(stiffness: ArrayLike, damping: ArrayLike, mass: ArrayLike) -> Array:
    """Return the growth rates of every operating point with every mass, shape (..., n_mass) [1/s].

    The largest real part of the four eigenvalues: positive where the rotor is unstable, NaN where a
    coefficient is not finite.

    stiffness, damping : (..., 2, 2) arrays [N/m], [N s/m]
    mass : (n_mass,) array [kg]
    Raises InputError: A mass is not above zero.

    With M(s) the mean of the two diagonal entries of s^2 + (C s + K)/m, the characteristic
    polynomial is M(s)^2 - N(s), N a quadratic: the form from which Ferrari's method starts. It is
    solved in the time unit (m^2/|det K|)^(1/4), and Newton polishes each root in that same form,
    which keeps its digits when both modes are nearly alike. Where a root's estimated rounding error
    exceeds 1e-11, or the roots' sum or product is wrong, the dense eigenvalue solver takes over.

    Examples
    --------
    >>> growth_rate_map([[1.0, 5.0], [-5.0, 1.0]], np.eye(2), [0.02, 0.04, 0.08]).round(12) + 0.0
    array([-0.48473118,  0.        ,  0.62287624])
    """
    k, c = np.broadcast_arrays(np.asarray(stiffness, float), np.asarray(damping, float))
    m = np.ascontiguousarray(np.atleast_1d(np.asarray(mass, dtype=float)))
    good = (m > 0.0) & np.isfinite(m)
    if not good.all():
        raise InputError("must be above 0 (kg)", key="mass", value=float(m[~good][0]))

    flat_k = np.ascontiguousarray(k.reshape(-1, 4))
    flat_c = np.ascontiguousarray(c.reshape(-1, 4))
    rate = np.empty((flat_k.shape[0], m.size))
    _fill_rates(flat_k, flat_c, m, rate)
    doubtful = np.flatnonzero(np.isnan(rate.ravel()))
    row, column = np.divmod(doubtful, m.size)
    finite = np.isfinite(flat_k[row]).all(axis=1) & np.isfinite(flat_c[row]).all(axis=1)
    doubtful, row, column = doubtful[finite], row[finite], column[finite]
    _solve_densely(rate.reshape(-1), doubtful, flat_k[row], flat_c[row], m[column])
    return rate.reshape(*k.shape[:-2], m.size)


def _solve_densely(
    rate: Array, where: Indices, stiffness: Array, damping: Array, mass: Array
) -> None:
    for start in range(0, where.size, _BLOCK):
        part = slice(start, start + _BLOCK)
        values = eigenvalues(
            stiffness[part].reshape(-1, 2, 2), damping[part].reshape(-1, 2, 2), mass[part]
        )
        rate[where[part]] = values.real.max(axis=-1)


_EPS = 2.220446049250313e-16
_TRUST = 1e-11
"""Largest estimated relative error of a root that is passed on as good."""
_CHECK = 1e-10
"""Largest relative error of the roots' sum and product."""


@compiled(error_model="numpy")
def _largest_resolvent_root(c2: float, c1: float, c0: float) -> float:
    """Return the real root of y^3 + c2 y^2 + c1 y + c0 that is largest in magnitude, polished."""
    shift = c2 / 3.0
    q = c2 * c2 / 9.0 - c1 / 3.0
    r = (2.0 * c2 * c2 * c2 - 9.0 * c2 * c1 + 27.0 * c0) / 54.0
    if r * r < q * q * q:
        root_q = math.sqrt(q)
        angle = math.acos(max(-1.0, min(1.0, r / (q * root_q)))) / 3.0
        first = -2.0 * root_q * math.cos(angle) - shift
        last = -2.0 * root_q * math.cos(angle - 2.0943951023931953) - shift
        y = first if abs(first) > abs(last) else last
    else:
        a = -math.copysign(1.0, r) * (abs(r) + math.sqrt(r * r - q * q * q)) ** (1.0 / 3.0)
        y = a + (q / a if a != 0.0 else 0.0) - shift
    for _ in range(2):
        slope = (3.0 * y + 2.0 * c2) * y + c1
        if slope != 0.0:
            y -= (((y + c2) * y + c1) * y + c0) / slope
    return y


@compiled(error_model="numpy")
def _quadratic(p: complex, q: complex) -> tuple[complex, complex]:
    """Return the roots of s^2 + p s + q, the larger first, without cancellation."""
    half = 0.5 * p
    root = cmath.sqrt(half * half - q)
    if half.real * root.real + half.imag * root.imag < 0.0:
        root = -root
    large = -(half + root)
    return large, (q / large if large != 0.0 else 0.0 * large)


@compiled(error_model="numpy")
def _polish(
    x: float, y: float, alpha: float, beta: float, n2: float, n1: float, n0: float
) -> tuple[float, float, float]:
    """Return Newton on M(s)^2 - N(s) from s = x + i y.

    The root and an estimate of its relative error.

    Real arithmetic and the sum norm: half the time of complex division and hypot.
    """
    for _ in range(6):
        xx, yy = x * x - y * y, 2.0 * x * y
        mr, mi = xx + alpha * x + beta, yy + alpha * y
        dr, di = 2.0 * x + alpha, 2.0 * y
        nr, ni = n2 * xx + n1 * x + n0, n2 * yy + n1 * y
        fr, fi = mr * mr - mi * mi - nr, 2.0 * mr * mi - ni
        gr = 2.0 * (mr * dr - mi * di - n2 * x) - n1
        gi = 2.0 * (mr * di + mi * dr - n2 * y)
        slope2 = gr * gr + gi * gi
        if slope2 == 0.0:
            return x, y, 1.0
        inverse = 1.0 / slope2
        sr, si = (fr * gr + fi * gi) * inverse, (fi * gr - fr * gi) * inverse
        x -= sr
        y -= si
        a = abs(x) + abs(y)
        step = abs(sr) + abs(si)
        # Newton leaves step^2 |f''/(2 f')|, much more than step^2 next to a like root.
        d = abs(dr) + abs(di)
        m = abs(mr) + abs(mi)
        slope = math.sqrt(slope2)
        if step * step * (d * d + 2.0 * m + abs(n2)) <= 1e-13 * a * slope:
            rounding = m * ((a + abs(alpha)) * a + abs(beta))
            rounding += (abs(n2) * a + abs(n1)) * a + abs(n0)
            return x, y, 6.0 * _EPS * rounding / (slope * a)
    return x, y, 1.0


@compiled(error_model="numpy")
def _conjugate_factors(
    alpha: float, beta: float, n2: float, n1: float, n0: float,
    t: float, l1: float, l0: float, product: float,
) -> float:  # fmt: skip
    """Return the largest real part where M + t -+ i (l1 s + l0) are conjugate factors."""
    r1, r2 = _quadratic(complex(alpha, -l1), complex(beta + t, -l0))
    x1, y1, d1 = _polish(r1.real, r1.imag, alpha, beta, n2, n1, n0)
    x2, y2, d2 = _polish(r2.real, r2.imag, alpha, beta, n2, n1, n0)
    # Good approximations of four different roots: their sum and product must come out.
    size = abs(x1) + abs(y1) + abs(x2) + abs(y2)
    off = abs((x1 * x1 + y1 * y1) * (x2 * x2 + y2 * y2) - product)
    good = abs(x1 + x2 + alpha) <= _CHECK * size and off <= _CHECK * abs(product)
    return max(x1, x2) if good and max(d1, d2) <= _TRUST else math.nan


@compiled(error_model="numpy")
def _pair(
    p: float, q: float, alpha: float, beta: float, n2: float, n1: float, n0: float
) -> tuple[float, float, float, float]:
    """Return of one real factor's roots the larger real part, sum, product, relative error."""
    half = 0.5 * p
    discriminant = half * half - q
    if discriminant < 0.0:
        x, y, d = _polish(-half, math.sqrt(-discriminant), alpha, beta, n2, n1, n0)
        return x, 2.0 * x, x * x + y * y, d
    large = -(half + math.copysign(math.sqrt(discriminant), half))
    small = q / large if large != 0.0 else 0.0
    x1, _, d1 = _polish(large, 0.0, alpha, beta, n2, n1, n0)
    x2, _, d2 = _polish(small, 0.0, alpha, beta, n2, n1, n0)
    return max(x1, x2), x1 + x2, x1 * x2, max(d1, d2)


@compiled(error_model="numpy")
def _real_factors(
    alpha: float, beta: float, n2: float, n1: float, n0: float,
    t: float, l1: float, l0: float, product: float, linear: float,
) -> float:  # fmt: skip
    """Return the largest real part where the factors M + t -+ (l1 s + l0) are real."""
    p1, q1, p2, q2 = alpha - l1, beta + t - l0, alpha + l1, beta + t + l0
    if abs(q1) > abs(q2):
        p1, q1, p2, q2 = p2, q2, p1, q1
    if abs(q1) < 0.1 * abs(q2):
        # The small factor's coefficients, lost in the differences, follow from the large one's.
        q1 = product / q2
        p1 = (linear - p2 * q1) / q2
    x1, sum1, product1, d1 = _pair(p1, q1, alpha, beta, n2, n1, n0)
    x2, sum2, product2, d2 = _pair(p2, q2, alpha, beta, n2, n1, n0)
    size = abs(sum1) + abs(sum2) + math.sqrt(abs(product1)) + math.sqrt(abs(product2))
    good = abs(sum1 + sum2 + 2.0 * alpha) <= _CHECK * size
    good = good and abs(product1 * product2 - product) <= _CHECK * abs(product)
    return max(x1, x2) if good and max(d1, d2) <= _TRUST else math.nan


@compiled(error_model="numpy")
def _largest_real_part(
    alpha: float, beta: float, n2: float, n1: float, n0: float, product: float, linear: float
) -> float:
    """Return the largest real part of the zeros of (s^2 + alpha s + beta)^2 - (n2 s^2 + n1 s + n0).

    `product` and `linear` are the constant and the linear coefficient of the expanded quartic,
    known without cancellation. NaN where the roots are not to be trusted.
    """
    # Ferrari: with y = n2 + 2 t, N + 2 t M + t^2 is a perfect square (l1 s + l0)^2 where its
    # discriminant vanishes. The y of largest magnitude makes the factors most different.
    e = n1 - alpha * n2
    h = 0.5 * n2
    y = _largest_resolvent_root(
        4.0 * (beta - h) - alpha * alpha, 4.0 * (n0 - n2 * beta + h * h) - 2.0 * alpha * e, -e * e
    )
    t = 0.5 * (y - n2)
    u = e + alpha * y
    w = n0 + 2.0 * t * beta + t * t
    # y and w are the squares of l1 and l0: of one sign, but for rounding; u is 2 l1 l0.
    if abs(y) * max(1.0, abs(beta)) >= abs(w):
        negative = y < 0.0
        l1 = math.sqrt(abs(y))
        l0 = 0.5 * u / l1 if l1 != 0.0 else 0.0
    else:
        negative = w < 0.0
        l0 = math.sqrt(abs(w))
        l1 = 0.5 * u / l0
    if negative:
        # (i l1)(i l0) = -l1 l0.
        if abs(y) * max(1.0, abs(beta)) >= abs(w):
            l0 = -l0
        else:
            l1 = -l1
        return _conjugate_factors(alpha, beta, n2, n1, n0, t, l1, l0, product)
    return _real_factors(alpha, beta, n2, n1, n0, t, l1, l0, product, linear)


@compiled(error_model="numpy")
def _fill_row(k: np.ndarray, c: np.ndarray, mass: np.ndarray, rate: np.ndarray) -> None:
    """Fill in growth rates of one operating point, (4,) stiffness and damping, with every mass."""
    # The differences are formed before anything is scaled, so that nearly like modes stay exact.
    dc, dk = 0.5 * (c[0] - c[3]), 0.5 * (k[0] - k[3])
    n2 = dc * dc + c[1] * c[2]
    n1 = 2.0 * dc * dk + c[1] * k[2] + c[2] * k[1]
    n0 = dk * dk + k[1] * k[2]
    alpha, beta = 0.5 * (c[0] + c[3]), 0.5 * (k[0] + k[3])
    det = k[0] * k[3] - k[1] * k[2]
    linear = k[0] * c[3] + k[3] * c[0] - k[1] * c[2] - k[2] * c[1]
    alike = n2 == 0.0 and n1 == 0.0 and n0 == 0.0
    root = math.sqrt(abs(det))
    if not (root > 0.0 and math.isfinite(root + linear + n2 + n1)):
        rate[:] = math.nan
        return
    per_root = 1.0 / root
    beta *= per_root
    n0 *= per_root * per_root
    sign = math.copysign(1.0, det)
    for j in range(mass.shape[0]):
        # Time in units of the roots' geometric mean: (|det K|/m^2)^(1/4).
        scale = math.sqrt(root / mass[j])
        a = 1.0 / (mass[j] * scale)
        b = a * per_root
        if alike:
            x, y = _quadratic(complex(alpha * a, 0.0), complex(beta, 0.0))
            rate[j] = scale * max(x.real, y.real)
        else:
            rate[j] = scale * _largest_real_part(
                alpha * a, beta, n2 * a * a, n1 * b, n0, sign, linear * b
            )


@compiled(error_model="numpy")
def _fill_rates(
    stiffness: np.ndarray, damping: np.ndarray, mass: np.ndarray, rate: np.ndarray
) -> None:
    """Write growth rates of (P, 4) stiffness and damping x (Q,) masses to `rate` (P, Q)."""
    for i in range(stiffness.shape[0]):
        _fill_row(stiffness[i], damping[i], mass, rate[i])
