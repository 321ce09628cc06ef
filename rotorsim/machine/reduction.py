"""Smaller models of a machine: unstable modes kept exactly, the stable part by balanced truncation.

Source: Antoulas, Approximation of Large-Scale Dynamical Systems (2005), ch. 7: with the Hankel
singular values s_k of the stable part the error's H-infinity norm is at most twice the sum of those
left out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, ComplexArray
from ..errors import InputError
from ..threads import on_one_blas_thread

if TYPE_CHECKING:
    import control

_DECAYING = 1e-9
"""Of the largest eigenvalue: slower modes count as unstable and are kept."""
_ABOUT = np.concatenate([-np.geomspace(10.0, 0.1, 9), [0.0], np.geomspace(0.1, 10.0, 9)])
"""Frequencies about each mode, in units of its real part."""


@dataclass(frozen=True, eq=False)
class Reduction:
    """A reduced model and how far it may be off.

    system : Same inputs and outputs.
    kept_exactly : States of modes that do not decay.
    hankel : (n,) array. Hankel singular values of the stable part, falling [output/input].
    bound, error : H-infinity norm of the error: proven bound, and the largest found over frequency.
    scale : Largest gain of the stable part over frequency.
    """

    system: control.StateSpace
    kept_exactly: int
    hankel: Array
    bound: float
    error: float
    scale: float


@on_one_blas_thread
def reduced(system: control.StateSpace, error: float = 1e-3, order: int | None = None) -> Reduction:
    """Reduce a system by balanced truncation of its stable part.

    error : Bound on the H-infinity norm of the error, as a share of the stable part's own.
    order : Of the stable part, in place of `error`.
    Raises InputError: The system has no state that decays.
    """
    import control
    from scipy.linalg import schur, solve_continuous_lyapunov, solve_sylvester, svd

    a, b, c = (np.asarray(part, dtype=float) for part in (system.A, system.B, system.C))
    scale = _scales(a)
    a, b, c = a * scale / scale[:, None], b / scale[:, None], c * scale
    values = np.linalg.eigvals(a)
    slow = -_DECAYING * float(np.abs(values).max(initial=0.0))

    def decays(real: complex, _imaginary: float = 0.0) -> bool:
        return complex(real).real < slow

    parts: Any = schur(a, output="real", sort=decays)
    t, z, stable = parts
    if not stable:
        raise InputError("no mode decays: there is nothing to reduce", key="system")
    # Decoupled: with X from T11 X - X T22 = -T12 the stable part does not see the other.
    coupling = solve_sylvester(t[:stable, :stable], -t[stable:, stable:], -t[:stable, stable:])
    inputs, outputs = z.T @ b, c @ z
    own_in = inputs[:stable] - coupling @ inputs[stable:]
    other_out = outputs[:, :stable] @ coupling + outputs[:, stable:]
    own, own_out = t[:stable, :stable], outputs[:, :stable]
    reach = _root(solve_continuous_lyapunov(own, -own_in @ own_in.T))
    show = _root(solve_continuous_lyapunov(own.T, -own_out.T @ own_out))
    left, hankel, right = svd(show.T @ reach)
    floor = 1e-13 * float(hankel[0]) if hankel.size and hankel[0] else 1.0
    usable = max(int((hankel > floor).sum()), 1)
    if hankel[0] == 0.0:
        raise InputError("no stable mode is seen from these inputs and outputs", key="system")
    frequencies = probing_frequencies(values)
    stable_part = response(own, own_in, own_out)(frequencies)
    largest = _largest(stable_part)
    tail = 2.0 * np.append(np.cumsum(hankel[::-1])[::-1], 0.0)
    count = int(np.argmax(tail <= error * largest)) if order is None else order
    count = min(max(count, 0), usable)
    weight = hankel[:count] ** -0.5
    to_small = (weight[:, None] * left[:, :count].T) @ show.T
    from_small = reach @ right[:count].T * weight
    small, small_in, small_out = (
        to_small @ own @ from_small,
        to_small @ own_in,
        own_out @ from_small,
    )
    measured = _largest(stable_part - response(small, small_in, small_out)(frequencies))
    rest = t[stable:, stable:]
    size = count + rest.shape[0]
    matrix = np.zeros((size, size))
    matrix[:count, :count], matrix[count:, count:] = small, rest
    whole = control.StateSpace(
        matrix, np.vstack([small_in, inputs[stable:]]), np.hstack([small_out, other_out]),
        system.D, inputs=system.input_labels, outputs=system.output_labels,
        name=f"{system.name}_reduced",
    )  # fmt: skip
    return Reduction(whole, rest.shape[0], hankel, float(tail[count]), measured, largest)


def _scales(a: Array) -> Array:
    """Return the powers of two that bring rows and columns of a matrix to like sizes."""
    from scipy.linalg import matrix_balance

    return np.asarray(matrix_balance(a, permute=False, separate=True)[1][0], dtype=float)


def _root(gramian: Array) -> Array:
    """Return l with L L' = a symmetric matrix, what rounding makes negative left out."""
    values, vectors = np.linalg.eigh(0.5 * (gramian + gramian.T))
    return vectors * np.sqrt(np.maximum(values, 0.0))


def _largest(responses: ComplexArray) -> float:
    """Return the largest singular value over frequency."""
    if not min(responses.shape):
        return 0.0
    return float(np.linalg.svd(responses, compute_uv=False).max(initial=0.0))


def probing_frequencies(values: ArrayLike) -> Array:
    """Return frequencies at and about eigenvalues, between and beyond them, ascending [rad/s]."""
    poles: Any = np.asarray(values, dtype=complex)
    poles = poles[poles.imag >= 0.0]
    about = poles.imag[:, None] + np.abs(poles.real)[:, None] * _ABOUT
    sizes = np.abs(poles)[np.abs(poles) > 0.0]
    between = np.geomspace(0.01 * sizes.min(), 10.0 * sizes.max(), 400) if sizes.size else []
    every = np.concatenate([[0.0], about.ravel(), between])
    return np.unique(every[every >= 0.0])


def response(
    a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike | None = None
) -> Callable[[ArrayLike], ComplexArray]:
    """Return the frequency response (n, outputs, inputs) as a function of frequency (n,) [rad/s].

    A complex frequency asks for s = i frequency off the imaginary axis.

    By the eigenvectors, or by one solution for each frequency where they are nearly parallel.
    """
    a, b, c = (np.asarray(part, dtype=float) for part in (a, b, c))
    feed = np.zeros((c.shape[0], b.shape[1])) if d is None else np.asarray(d, dtype=float)
    values, vectors = np.linalg.eig(a) if a.size else (np.zeros(0), np.zeros((0, 0)))
    modal = bool(a.size) and float(np.linalg.cond(vectors)) < 1e8
    shown, driven = (c @ vectors, np.linalg.solve(vectors, b)) if modal else (c, b)

    def at(frequency: ArrayLike) -> Any:
        s: Any = 1j * np.atleast_1d(np.asarray(frequency))
        if not a.size:
            return np.broadcast_to(feed.astype(complex), (s.size, *feed.shape))
        if modal:
            return np.einsum("ok,nk,ki->noi", shown, 1.0 / (s[:, None] - values), driven) + feed
        eye = np.eye(a.shape[0])
        return np.array([c @ np.linalg.solve(one * eye - a, b) for one in s]) + feed

    return at
