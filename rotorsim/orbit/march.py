"""Compiled integrator for a `MotionSystem`: a stiffly accurate Rosenbrock method of order 4(3).

SciPy's implicit methods work on displacements and velocities as one vector and call Python at each
step: on a rotor of 40 unknowns on two films they are some ten times slower (docs/performance.md).
Here the displacements are eliminated from each stage, so that one matrix of the size of the
rotor's is factored in a step, and nothing leaves compiled code.

RODAS by Hairer & Wanner, Solving Ordinary Differential Equations II, section IV.7. Between the
steps a quintic through displacement, velocity and acceleration at both ends gives the samples.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..compiled import compiled
from .kernels import shaft
from .system import Plain, derivatives, force_on, least_film

DONE, TOUCHED, STUCK = 0, 1, 2

_GAMMA = 0.25
_A = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0],
        [1.544, 0.0, 0.0, 0.0, 0.0],
        [0.9466785280815826, 0.2557011698983284, 0.0, 0.0, 0.0],
        [3.314825187068521, 2.896124015972201, 0.9986419139977817, 0.0, 0.0],
        [1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 0.0],
        [1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0],
    ]
)
_C = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0],
        [-5.6688, 0.0, 0.0, 0.0, 0.0],
        [-2.430093356833875, -0.2063599157091915, 0.0, 0.0, 0.0],
        [-0.1073529058151375, -9.594562251023355, -20.47028614809616, 0.0, 0.0],
        [7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160, 0.0],
        [8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136,
         -6.058818238834054],
    ]
)  # fmt: skip
_TIME = np.array([0.0, 0.386, 0.21, 0.63, 1.0, 1.0])
_SLOPE = np.array([0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0])


@compiled()
def _factor(a: Array, order: NDArray[np.int64]) -> bool:
    """Factor `a` in place, rows interchanged; return False where it is singular."""
    n = a.shape[0]
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(a[i, k]) > abs(a[best, k]):
                best = i
        order[k] = best
        if not abs(a[best, k]) > 0.0:
            return False
        if best != k:
            for j in range(n):
                a[k, j], a[best, j] = a[best, j], a[k, j]
        inverse = 1.0 / a[k, k]
        for i in range(k + 1, n):
            ratio = a[i, k] * inverse
            if ratio != 0.0:
                a[i, k] = ratio
                for j in range(k + 1, n):
                    a[i, j] -= ratio * a[k, j]
    return True


@compiled()
def _solve(a: Array, order: NDArray[np.int64], b: Array) -> None:
    n = a.shape[0]
    for k in range(n):
        b[k], b[order[k]] = b[order[k]], b[k]
    for i in range(n):
        total = b[i]
        for j in range(i):
            total -= a[i, j] * b[j]
        b[i] = total
    for i in range(n - 1, -1, -1):
        total = b[i]
        for j in range(i + 1, n):
            total -= a[i, j] * b[j]
        b[i] = total / a[i, i]


@compiled()
def _product(matrix: Array, values: Array, out: Array) -> None:
    for i in range(out.size):
        total = 0.0
        for j in range(values.size):
            total += matrix[i, j] * values[j]
        out[i] = total


@compiled()
def _sample(s: float, h: float, q0: Array, v0: Array, a0: Array, q1: Array, v1: Array, a1: Array,
            q: Array, v: Array) -> None:  # fmt: skip
    """Interpolate by quintic Hermite polynomials at the share s of a step h."""
    s2, s3 = s * s, s * s * s
    for i in range(q.size):
        # remainder after the quadratic at the left end, fitted at the right one
        d0 = q1[i] - q0[i] - h * v0[i] - 0.5 * h * h * a0[i]
        d1 = h * (v1[i] - v0[i] - h * a0[i])
        d2 = h * h * (a1[i] - a0[i])
        c3 = 10.0 * d0 - 4.0 * d1 + 0.5 * d2
        c4 = -15.0 * d0 + 7.0 * d1 - d2
        c5 = 6.0 * d0 - 3.0 * d1 + 0.5 * d2
        q[i] = q0[i] + s * h * v0[i] + 0.5 * s2 * h * h * a0[i] + s3 * (c3 + s * (c4 + s * c5))
        v[i] = v0[i] + s * h * a0[i] + s2 * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)) / h


@compiled()
def march(
    q: Array, v: Array, start: float, stop: float, times: Array, knots: Array, p: Plain,
    scale: Array, tolerance: float, step: float,
) -> tuple[Array, Array, int, int, float, Array, Array, float]:  # fmt: skip
    """Integrate from `start` to `stop` and sample at `times` (m,).

    Returns positions, velocities : (m, n) arrays:
    Returns count : int: Samples that were reached.
    Returns status : int: `DONE`, `TOUCHED` or `STUCK`.
    Returns end, q, v : float and (n,) arrays: Where it stopped.
    Returns step : float: To go on with [s].
    """
    n = q.size
    out_q, out_v = np.empty((times.size, n)), np.empty((times.size, n))
    q, v, q1, v1 = q.copy(), v.copy(), np.empty(n), np.empty(n)
    t, done, h = start, 0, min(step, stop - start)
    phi, w, alpha = shaft(t, knots)
    f = force_on(t, q, v, phi, w, alpha, p)
    a, a1, rate, right = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    _product(p.inverse, f, a)
    uq, uv = np.empty((6, n)), np.empty((6, n))
    qs, vs, rq, rv = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    stiffness, damping, matrix = np.empty((n, n)), np.empty((n, n)), np.empty((n, n))
    order = np.empty(n, dtype=np.int64)
    slack = 1e-12 * max(abs(start), abs(stop))
    while done < times.size and times[done] <= t + slack:
        _sample(0.0, 1.0, q, v, a, q, v, a, out_q[done], out_v[done])
        done += 1
    least_step = 1e-13 * max(abs(stop), stop - start)
    fresh = True
    while t < stop - slack:
        if fresh:
            stiffness, damping = derivatives(q, v, w, scale, p)
            nudge = 1e-5 * h
            phi1, w1, alpha1 = shaft(t + nudge, knots)
            ahead = force_on(t + nudge, q, v, phi1, w1, alpha1, p)
            for i in range(n):
                rate[i] = (ahead[i] - f[i]) / nudge
        last = t + h >= stop - slack
        if last:
            step, h = h, stop - t
        share = _GAMMA * h
        for i in range(n):
            for j in range(n):
                matrix[i, j] = p.mass[i, j] / share + damping[i, j] + share * stiffness[i, j]
        error = math.inf
        if _factor(matrix, order):
            for stage in range(6):
                ti = t + _TIME[stage] * h
                phi, w, alpha = shaft(ti, knots)
                for i in range(n):
                    qs[i], vs[i], rq[i], rv[i] = q[i], v[i], 0.0, 0.0
                    for j in range(min(stage, 5)):
                        qs[i] += _A[stage, j] * uq[j, i]
                        vs[i] += _A[stage, j] * uv[j, i]
                        rq[i] += (_C[stage, j] / h) * uq[j, i]
                        rv[i] += (_C[stage, j] / h) * uv[j, i]
                    rq[i] += vs[i]
                force = f if stage == 0 else force_on(ti, qs, vs, phi, w, alpha, p)
                for i in range(n):
                    total = force[i] + _SLOPE[stage] * h * rate[i]
                    for j in range(n):
                        total += p.mass[i, j] * rv[j] - share * stiffness[i, j] * rq[j]
                    right[i] = total
                _solve(matrix, order, right)
                for i in range(n):
                    uv[stage, i] = right[i]
                    uq[stage, i] = share * (right[i] + rq[i])
            total = 0.0
            speed = max(abs(w), 1.0)
            for i in range(n):
                # the last stage's arguments, plus its own increment, are the new state
                q1[i], v1[i] = qs[i] + uq[5, i], vs[i] + uv[5, i]
                least = 1e-2 * scale[i]
                size = least + max(abs(q[i]), abs(q[i] + uq[0, i]))
                total += (uq[5, i] / (tolerance * size)) ** 2
                size = speed * least + max(abs(v[i]), abs(v[i] + uv[0, i]))
                total += (uv[5, i] / (tolerance * size)) ** 2
            error = math.sqrt(total / (2 * n))
        if not error <= 1.0:
            h *= max(0.2, 0.9 * error**-0.25) if math.isfinite(error) else 0.2
            fresh = False
            phi, w, alpha = shaft(t, knots)
            if h < least_step:
                touched = least_film(q, v, p) < 1e-3 * scale.max()
                return out_q, out_v, done, TOUCHED if touched else STUCK, t, q, v, h
            continue
        t1 = stop if last else t + h
        phi, w, alpha = shaft(t1, knots)
        f = force_on(t1, q1, v1, phi, w, alpha, p)
        _product(p.inverse, f, a1)
        while done < times.size and times[done] <= t1 + slack:
            s = min(max((times[done] - t) / h, 0.0), 1.0)
            _sample(s, h, q, v, a, q1, v1, a1, out_q[done], out_v[done])
            done += 1
        t, q, v, a, q1, v1, a1 = t1, q1, v1, a1, q, v, a
        fresh = True
        if least_film(q, v, p) <= 0.0:
            return out_q, out_v, done, TOUCHED, t, q, v, h
        if not last:
            h *= min(4.0, 0.9 * max(error, 1e-6) ** -0.25)
            step = h
    return out_q, out_v, done, DONE, t, q, v, step


@compiled()
def repeat(matrix: Array, state: Array, count: int) -> Array:
    """Return the states (count, n) after 0, 1, 2 ... applications of a matrix."""
    out = np.empty((count, state.size))
    for i in range(count):
        out[i] = state
        state = matrix @ state
    return out
