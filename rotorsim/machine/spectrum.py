"""Eigenvalues with their accuracy: all of a state matrix, or the lowest of a large machine."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .machine import Machine
from .matrices import first_order

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
_MatrixOf = Callable[[float], Array]

_ROUNDINGS = 10.0
"""Size of the error of an eigenvalue solver and of the matrices, in roundings of their norm."""
_DENSE = 48
"""Unknowns up to which all eigenvalues are computed."""
_BLOCK = 2
"""Vectors that the Krylov space grows by: two planes make double eigenvalues."""
_EXTRA = 24
"""Size of the Krylov space beyond twice the number of eigenvalues that are wanted."""
_SHIFT = 3e-4
"""Of the highest frequency: the least shift."""
_CONVERGED = 1e-11
"""Relative residual of a Ritz value that counts as converged."""
_NEWTON_STEPS = 30
_SELF_ADJOINT = 1e-7
"""Relative residual below which a right eigenvector is the left one too."""


@dataclass(frozen=True, eq=False)
class Eigenmodes:
    """Modes at one parameter.

    Attributes
    ----------
    values : (k,) complex array
        [rad/s]
    accuracy : (k,) array
        Estimated bound of each eigenvalue's error [rad/s].
    shapes : (k, m) complex array
        Displacements, of unit length.
    """

    values: ComplexArray
    accuracy: Array
    shapes: ComplexArray

    def taken(self, order: Any) -> Eigenmodes:
        """Modes of given indices."""
        return Eigenmodes(self.values[order], self.accuracy[order], self.shapes[order])

    @property
    def leading(self) -> complex:
        """Eigenvalue of largest real part among those damped or driven; 0 without any."""
        values = self.values[np.abs(self.values.real) > self.accuracy]
        return complex(values[values.real.argmax()]) if values.size else 0j


class Spectrum(Protocol):
    """Modes at any parameter; None where the matrices are not known."""

    def __call__(self, parameter: float, /) -> Eigenmodes | None:
        """Modes at one parameter."""
        ...


@dataclass(frozen=True)
class MatrixSpectrum:
    """All modes of a state matrix on displacements, then velocities."""

    matrix: _MatrixOf
    unknowns: int | None = None

    def __call__(self, parameter: float, /) -> Eigenmodes | None:
        """Modes at one parameter."""
        a = self.matrix(parameter)
        if not np.all(np.isfinite(a)):
            return None
        return all_eigenmodes(a, a.shape[0] // 2 if self.unknowns is None else self.unknowns)


@dataclass(frozen=True)
class MachineSpectrum:
    """Modes of a machine over speed: all of a small one, the lowest `count` pairs of a large."""

    machine: Machine
    count: int

    @property
    def complete(self) -> bool:
        """Whether it gives all modes."""
        return self.machine.size <= max(_DENSE, self.count)

    def __call__(self, speed: float, /) -> Eigenmodes | None:
        """Modes at one speed [rad/s]."""
        mass, damping, stiffness = self.machine.matrices(speed)
        if not (np.all(np.isfinite(stiffness)) and np.all(np.isfinite(damping))):
            return None
        if self.complete:
            found = all_eigenmodes(first_order(mass, damping, stiffness)[0], self.machine.size)
        else:
            found = lowest_eigenmodes(mass, damping, stiffness, self.count, abs(speed))
        if not self.machine.frequency_dependent:
            return found
        return _at_their_frequencies(self.machine, speed, found)


def all_eigenmodes(a: Array, unknowns: int) -> Eigenmodes:
    """All modes of one state matrix whose first states are `unknowns` displacements.

    Notes
    -----
    After balancing, the error of an eigenvalue is some roundings of the matrix' norm over the
    cosine between its left and its right eigenvector (Golub & Van Loan, Matrix Computations,
    7.2.2). A free direction is a double eigenvalue zero with one eigenvector: the computed cosine
    is then of the size of the square root of the rounding, and so is the accuracy.
    """
    from scipy.linalg import eig, matrix_balance

    balanced, (scale, _) = matrix_balance(a, permute=False, separate=True)
    found: Any = eig(balanced, left=True, right=True, check_finite=False)
    values, left, right = found
    cosine = np.abs(np.sum(left.conj() * right, axis=0))
    rounding = _ROUNDINGS * np.finfo(float).eps * np.linalg.norm(balanced)
    accuracy = rounding / np.maximum(cosine, np.finfo(float).eps)
    shapes = (scale[:, None] * right)[:unknowns].T
    return Eigenmodes(values.astype(complex), accuracy, _of_unit_length(shapes))


def lowest_eigenmodes(
    mass: Array,
    damping: Array,
    stiffness: Array,
    count: int,
    speed: float = 0.0,
) -> Eigenmodes:
    """Lowest modes of M q'' + D q' + K q = 0: 2 `count` or a few more, ascending in modulus.

    Parameters
    ----------
    mass, damping, stiffness : (n, n) arrays
        Unknowns without mass or damping are allowed.
    count : int
        Pairs of eigenvalues.
    speed : float
        About the frequency of interest [rad/s]; 0: none.

    Notes
    -----
    Block Arnoldi on the inverse of the first-order pencil, shifted on the real axis to minus the
    speed, or a small part of the highest frequency, so that a free rotor's zero eigenvalues are
    regular. Masses are scaled to 1 and time to the shift. A mode counts where its relative residual
    is below 1e-11; the space grows until enough do. The accuracy is that of the matrices' entries:
    with left eigenvector y, |y|' (|K| + |s| |D| + |s|^2 |M|) |x| roundings over |y' (2 s M + D) x|.
    """
    n = mass.shape[0]
    diagonal = np.abs(np.diag(mass))
    heavy = diagonal > 0.0
    scale = 1.0 / np.sqrt(np.where(heavy, diagonal, 1.0))
    scaled = (scale[:, None] * scale * stiffness)[heavy][:, heavy]
    highest = np.sqrt(np.linalg.norm(scaled))
    rate = max(speed, _SHIFT * float(highest))
    light = np.abs(np.diag(stiffness)) + rate * np.abs(np.diag(damping))
    scale = np.where(heavy, scale, rate / np.sqrt(np.where(light > 0.0, light, 1.0)))
    both = scale[:, None] * scale
    m, d, k = both * mass, both * damping / rate, both * stiffness / rate**2
    most = 2 * n - _BLOCK
    krylov = _Krylov(m, d, k, most)
    size = min(4 * count + _EXTRA, most)
    while True:
        values, vectors, residual = krylov.ritz(size)
        good = residual < _CONVERGED
        if good.sum() >= 2 * count or size >= most:
            break
        size = min(size + _EXTRA, most)
    # Complete is what lies nearer to the shift than any eigenvalue not yet found.
    reach = np.abs(values[~good] + 1.0).min(initial=np.inf) - 1.0
    keep = np.flatnonzero(good)
    keep = keep[np.argsort(np.abs(values[keep]), kind="stable")]
    last = max(2 * count, int(np.sum(np.abs(values[keep]) <= reach)))
    if last < keep.size and np.isclose(values[keep[last]], values[keep[last - 1]].conj()):
        last += 1
    keep = keep[:last]
    values, x = values[keep], vectors[:n, keep]
    accuracy = _accuracy(m, d, k, values, x)
    return Eigenmodes(rate * values, rate * accuracy, _of_unit_length((scale[:, None] * x).T))


class _Krylov:
    """Krylov space of the shifted inverse of [[0, 1], [-K, -D]] - s [[1, 0], [0, M]], s = -1."""

    def __init__(self, m: Array, d: Array, k: Array, most: int) -> None:
        from scipy.linalg import lu_factor

        self.m, self.slope = m, d - m
        self.factors = lu_factor(k - d + m, check_finite=False)
        start = np.random.default_rng(0).standard_normal((2 * m.shape[0], _BLOCK))
        self.basis = np.zeros((2 * m.shape[0], most + _BLOCK), order="F")
        self.basis[:, :_BLOCK] = np.linalg.qr(start)[0]
        self.hessenberg = np.zeros((most + _BLOCK, most))
        self.size = 0

    def _grow(self) -> None:
        """One more block: A V = V H, orthogonalised twice."""
        from scipy.linalg import lu_solve

        n, size = self.m.shape[0], self.size + _BLOCK
        last, basis = self.basis[:, self.size : size], self.basis[:, :size]
        force = self.m @ last[n:] + self.slope @ last[:n]
        q = -lu_solve(self.factors, force, check_finite=False)
        block = np.concatenate([q, last[:n] - q])
        column = basis.T @ block
        block -= basis @ column
        again = basis.T @ block
        block -= basis @ again
        new, rest = np.linalg.qr(block)
        self.basis[:, size : size + _BLOCK] = new
        self.hessenberg[:size, self.size : size] = column + again
        self.hessenberg[size : size + _BLOCK, self.size : size] = rest
        self.size = size

    def ritz(self, size: int) -> tuple[ComplexArray, ComplexArray, Array]:
        """Eigenvalues, vectors in columns, and relative residuals from a space of `size`."""
        while self.size < size:
            self._grow()
        size = self.size
        inverse, small = np.linalg.eig(self.hessenberg[:size, :size])
        rest = self.hessenberg[size : size + _BLOCK, size - _BLOCK : size]
        residual = np.linalg.norm(rest @ small[-_BLOCK:], axis=0)
        there = np.abs(inverse) > np.finfo(float).eps * np.abs(inverse).max()
        inverse, small, residual = inverse[there], small[:, there], residual[there]
        values = (1.0 / inverse - 1.0).astype(complex)
        return values, _times(self.basis[:, :size], small), residual / np.abs(inverse)


def _times(real: Array, vectors: ComplexArray) -> ComplexArray:
    """Real matrix times complex columns, without a complex copy of the matrix."""
    return real @ vectors.real + 1j * (real @ vectors.imag)


def _accuracy(m: Array, d: Array, k: Array, values: ComplexArray, x: ComplexArray) -> Array:
    """Bound of the error of eigenvalues with right eigenvectors x, in columns.

    The right eigenvector stands for the left one where it is one (modes that nothing damps), and
    where the bound does not matter because the real part is large.
    """
    size, moving = np.abs(values), np.abs(x)
    entries = np.abs(k) @ moving + size * (np.abs(d) @ moving) + size**2 * (np.abs(m) @ moving)
    mx, dx = _times(m, x), _times(d, x)
    y = np.array(x)
    for i in np.flatnonzero(np.abs(values.real) < 1e-5 * size):
        s, vector = values[i].conj(), x[:, i]
        adjoint = k.T @ vector + s * (d.T @ vector) + s * s * (m.T @ vector)
        if np.linalg.norm(adjoint) > _SELF_ADJOINT * np.linalg.norm(entries[:, i]):
            # One step of inverse iteration beside the eigenvalue.
            s = s * (1.0 + 1e-9)
            vector = np.linalg.solve((k + s * d + s * s * m).T, mx[:, i])
            y[:, i] = vector / np.linalg.norm(vector)
    rounding = _ROUNDINGS * np.finfo(float).eps * np.sum(np.abs(y) * entries, axis=0)
    tiny = np.finfo(float).tiny
    first = np.abs(np.sum(y.conj() * (2.0 * values * mx + dx), axis=0))
    second = np.abs(np.sum(y.conj() * mx, axis=0))
    # A double eigenvalue's error is the square root of the perturbation.
    return np.minimum(
        rounding / np.maximum(first, tiny), np.sqrt(rounding / np.maximum(second, tiny))
    )


def _at_their_frequencies(machine: Machine, speed: float, start: Eigenmodes) -> Eigenmodes:
    """Modes with the supports' laws over frequency, each by Newton from that of the matrices.

    A mode from which Newton does not converge is left out.
    """
    values, shapes = np.array(start.values), np.array(start.shapes)
    good = np.zeros(values.size, dtype=bool)
    for i, (s, x) in enumerate(zip(start.values, start.shapes, strict=True)):
        values[i], shapes[i], good[i] = _newton(machine, speed, complex(s), x)
    return Eigenmodes(values, start.accuracy, _of_unit_length(shapes)).taken(good)


def _newton(
    machine: Machine, speed: float, s: complex, x: ComplexArray
) -> tuple[complex, ComplexArray, bool]:
    """Solve Z(s) x = 0 with x of unit length along the start; and whether it converged."""
    n, direction = x.size, x.conj()
    border = np.zeros((n + 1, n + 1), dtype=complex)
    for _ in range(_NEWTON_STEPS):
        z = machine.dynamic_stiffness(s, speed)
        h = 1e-6 * max(abs(s), 1.0)
        ahead, behind = (machine.dynamic_stiffness(s + d, speed) for d in (h, -h))
        border[:n, :n], border[:n, n], border[n, :n] = (
            z,
            (ahead - behind) @ x / (2.0 * h),
            direction,
        )
        try:
            step = np.linalg.solve(border, np.append(-z @ x, 0.0))
        except np.linalg.LinAlgError:
            return s, x, False
        x, s = x + step[:n], s + step[n]
        if abs(step[n]) <= 1e-12 * max(abs(s), 1.0):
            return complex(s), x, True
    return s, x, False


def _of_unit_length(shapes: ComplexArray) -> ComplexArray:
    length = np.linalg.norm(shapes, axis=1, keepdims=True)
    return np.asarray(shapes / np.where(length > 0.0, length, 1.0), dtype=complex)
