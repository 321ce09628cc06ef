"""Eigenvalues with their accuracy: all of a state matrix, or the lowest of a large machine."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, ComplexArray
from .banded import BandForm
from .machine import Machine
from .matrices import first_order, static_following

_MatrixOf = Callable[[float], Array]
_ROUNDINGS = 10.0
"""Size of the error of an eigenvalue solver and of the matrices, in roundings of their norm."""
_DENSE = 48
"""Unknowns up to which all eigenvalues are computed."""
_BLOCK = 2
"""Vectors that the Krylov space grows by: two planes make double eigenvalues."""
_EXTRA = 10
"""Size of the Krylov space beyond five times the number of pairs that are wanted."""
_SHIFT = 1e-3
"""Of the elements' typical frequency: the least shift. That of the shortest element may be orders
above, and modes far below the shift have no digits."""
_CONVERGED = 1e-11
"""Relative residual of a Ritz value that counts as converged."""
_NEWTON_STEPS = 30
_FOLLOWED = 1e-12, 1e-8
"""Relative step of inverse iteration at which an eigenvalue is known, or as well as it can be."""
_SELF_ADJOINT = 1e-7
"""Relative residual below which a right eigenvector is the left one too."""


@dataclass(frozen=True, eq=False)
class Eigenmodes:
    """Modes at one parameter.

    values : (k,) complex array [rad/s]
    accuracy : (k,) array. Estimated bound of each eigenvalue's error [rad/s].
    shapes : (k, m) complex array. Displacements, of unit length.
    """

    values: ComplexArray
    accuracy: Array
    shapes: ComplexArray

    def taken(self, order: Any) -> Eigenmodes:
        """Return the modes of given indices."""
        return Eigenmodes(self.values[order], self.accuracy[order], self.shapes[order])

    @property
    def leading(self) -> complex:
        """Eigenvalue of largest real part among those damped or driven; 0 without any."""
        values = self.values[np.abs(self.values.real) > self.accuracy]
        return complex(values[values.real.argmax()]) if values.size else 0j


class Spectrum(Protocol):
    """Modes at any parameter; None where the matrices are not known."""

    def __call__(self, parameter: float, /) -> Eigenmodes | None:
        """Return the modes at one parameter."""
        ...


@dataclass(frozen=True)
class MatrixSpectrum:
    """All modes of a state matrix on displacements, then velocities."""

    matrix: _MatrixOf
    unknowns: int | None = None

    def __call__(self, parameter: float, /) -> Eigenmodes | None:
        """Return the modes at one parameter."""
        a = self.matrix(parameter)
        if not np.all(np.isfinite(a)):
            return None
        return all_eigenmodes(a, a.shape[0] // 2 if self.unknowns is None else self.unknowns)


@dataclass(frozen=True)
class MachineSpectrum:
    """Modes of a machine over speed: all of a small one, the lowest `count` pairs of a large."""

    machine: Machine
    count: int

    @cached_property
    def complete(self) -> bool:
        """Return whether it gives all modes; unknowns without mass and damping have none."""
        most = max(_DENSE, self.count)
        if self.machine.size <= most:
            return True
        rotor = self.machine.rotor
        acting = (rotor.mass != 0.0) | (rotor.damping != 0.0) | (rotor.gyroscopic != 0.0)
        moving = np.ones(self.machine.size, dtype=bool)
        moving[: rotor.size] = acting.any(axis=0)
        for place in self.machine.places:
            moving[place] = True
        return int(moving.sum()) <= most

    def __call__(self, speed: float, /) -> Eigenmodes | None:
        """Return the modes at one speed [rad/s]."""
        if self.complete:
            found = _every_mode(*self.machine.matrices(speed))
        else:
            found = _lowest_eigenmodes(self.machine, self.count, speed)
        if found is None or not self.machine.frequency_dependent:
            return found
        return _at_their_frequencies(self.machine, speed, found)

    def follow(
        self, speed: float, value: complex, shape: ComplexArray
    ) -> tuple[complex, ComplexArray] | None:
        """Return eigenvalue and shape (m,) to which inverse iteration leads from a mode nearby.

        None: a small machine, whose modes cost little, or no convergence.
        """
        if self.complete or self.machine.frequency_dependent or not self.machine.band_form.narrow:
            return None
        return _inverse_iteration(self.machine, speed, value, shape)


def _inverse_iteration(
    machine: Machine, speed: float, s: complex, x: ComplexArray
) -> tuple[complex, ComplexArray] | None:
    """Solve (s^2 M + s D + K) x = 0 from a guess (Ruhe 1973), at the cost of a few band solves."""
    from ._band_kernels import times

    form = machine.band_form
    mass, damping, stiffness = machine.banded(speed)
    last = np.inf
    for _ in range(_NEWTON_STEPS):
        ordered = np.empty((x.size, 1), dtype=complex)
        ordered[form.place, 0] = x
        rate = times(damping, ordered, False) + 2.0 * s * times(mass, ordered, False)
        band: NDArray[Any] = stiffness + s * damping + s * s * mass
        y = form.solve(band, rate[form.place, 0])
        along = np.vdot(x, y)
        if not (np.isfinite(along) and abs(along) > 0.0):
            return None
        step = np.vdot(x, x) / along
        s, x = complex(s - step), np.asarray(y / np.linalg.norm(y), dtype=complex)
        if abs(step) <= _FOLLOWED[0] * abs(s) or last <= abs(step) <= _FOLLOWED[1] * abs(s):
            return s, x
        last = abs(step)
    return None


def _every_mode(mass: Array, damping: Array, stiffness: Array) -> Eigenmodes | None:
    """Return all modes; unknowns without mass and damping follow the others statically."""
    if not (np.all(np.isfinite(stiffness)) and np.all(np.isfinite(damping))):
        return None
    acting = (mass != 0.0) | (damping != 0.0)
    idle = ~(acting.any(axis=0) | acting.any(axis=1))
    follow = static_following(stiffness, idle)
    if idle.any():
        # K may have cross terms: the idle rows vanish, so that only the others' rows are left.
        mass, damping, stiffness = (part[~idle] @ follow for part in (mass, damping, stiffness))
    found = all_eigenmodes(first_order(mass, damping, stiffness)[0], mass.shape[0])
    return replace(found, shapes=_of_unit_length(found.shapes @ follow.T)) if idle.any() else found


def all_eigenmodes(a: Array, unknowns: int) -> Eigenmodes:
    """Return all modes of one state matrix whose first states are `unknowns` displacements.

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


def _lowest_eigenmodes(machine: Machine, count: int, speed: float) -> Eigenmodes | None:
    """Return lowest modes of a machine: 2 `count` or a few more, ascending in modulus.

    None: not known.

    machine : Unknowns without mass or damping are allowed.
    count : Pairs of eigenvalues.
    speed : [rad/s]

    Block Arnoldi on the inverse of the first-order pencil, shifted on the real axis to minus the
    speed, or a small part of the elements' typical frequency, so that a free rotor's zero
    eigenvalues are regular. Masses are scaled to 1 and time to the shift. A mode counts where its
    relative residual is below 1e-11; the space grows until enough do. The accuracy is that of the
    matrices' entries: with left eigenvector y, |y|' (|K| + |s| |D| + |s|^2 |M|) |x| roundings over
    |y' (2 s M + D) x|, plus that of the Ritz value: its residual, and roundings of the inverse's
    norm.
    """
    form = machine.band_form
    mass, damping, stiffness = machine.banded(speed)
    if not (np.all(np.isfinite(stiffness)) and np.all(np.isfinite(damping))):
        return None
    n, w = machine.size, form.width
    diagonal = np.abs(mass[w])
    heavy = diagonal > 0.0
    scale = 1.0 / np.sqrt(np.where(heavy, diagonal, 1.0))
    # A band's entry (w + i - j, j) belongs to row i.
    row = np.clip(np.arange(n) + np.arange(-w, w + 1)[:, None], 0, n - 1)
    both = scale[row] * scale
    stiff = np.abs(stiffness[w][heavy]) / diagonal[heavy]
    rate = max(abs(speed), _SHIFT * float(np.sqrt(np.median(stiff))))
    light = np.abs(stiffness[w]) + rate * np.abs(damping[w])
    scale = np.where(heavy, scale, rate / np.sqrt(np.where(light > 0.0, light, 1.0)))
    both = scale[row] * scale
    pencil = _Pencil(form, both * mass, both * damping / rate, both * stiffness / rate**2)
    most = 2 * n - _BLOCK
    krylov = _Krylov(pencil, most)
    size = min(5 * count + _EXTRA, most)
    while True:
        inverse, small, residual = krylov.ritz(size)
        good = residual < _CONVERGED
        if good.sum() >= 2 * count or size >= most:
            break
        size = min(size + max(_EXTRA // 2, size // 4), most)
    values: ComplexArray = np.asarray(1.0 / inverse - 1.0, dtype=complex)
    # Complete is what lies nearer to the shift than any eigenvalue not yet found.
    reach = np.abs(values[~good] + 1.0).min(initial=np.inf) - 1.0
    keep = np.flatnonzero(good)
    keep = keep[np.argsort(np.abs(values[keep]), kind="stable")]
    last = max(2 * count, int(np.sum(np.abs(values[keep]) <= reach)))
    if last < keep.size and np.isclose(values[keep[last]], values[keep[last - 1]].conj()):
        last += 1
    # The other half are their conjugates.
    keep = keep[:last]
    keep = keep[values[keep].imag >= 0.0]
    values, x = values[keep], krylov.vectors(small[:, keep])
    half = keep.size
    away = np.abs(values + 1.0)
    accuracy = pencil.accuracy(values, x) + _ROUNDINGS * residual[keep] * away
    accuracy += _ROUNDINGS * np.finfo(float).eps * krylov.norm * away**2
    shapes = _of_unit_length(x.T * scale)[:, form.place]
    order = np.concatenate([np.arange(half), np.flatnonzero(values.imag > 0.0)])
    values = np.asarray(rate * values[order], dtype=complex)
    shapes = shapes[order]
    for mirrored in (values[half:], shapes[half:]):
        np.conjugate(mirrored, out=mirrored)
    found = Eigenmodes(values, rate * accuracy[order], shapes)
    return found.taken(np.argsort(np.abs(values), kind="stable"))


@dataclass(frozen=True)
class _Pencil:
    """s^2 M + s D + K, its matrices in band form."""

    form: BandForm
    mass: Array
    damping: Array
    stiffness: Array

    def at(self, s: complex) -> NDArray[Any]:
        """Return the band at a number s."""
        return self.stiffness + s * self.damping + s * s * self.mass

    def accuracy(self, values: ComplexArray, x: ComplexArray) -> Array:
        """Return the bound of the error of eigenvalues with right eigenvectors x, in columns.

        The right eigenvector stands for the left one where it is one (modes that nothing damps),
        and where the bound does not matter because the real part is large.
        """
        from ._band_kernels import times

        m, d, k = self.mass, self.damping, self.stiffness
        size, moving = np.abs(values), np.abs(x)
        entries = times(np.abs(k), moving, False) + size * times(np.abs(d), moving, False)
        entries += size**2 * times(np.abs(m), moving, False)
        mx, dx = times(m, x, False), times(d, x, False)
        y = np.array(x)
        for i in np.flatnonzero(np.abs(values.real) < 1e-5 * size):
            s, vector = values[i].conj(), x[:, i : i + 1]
            adjoint = times(k, vector, True) + s * times(d, vector, True)
            adjoint += s * s * times(m, vector, True)
            if np.linalg.norm(adjoint) > _SELF_ADJOINT * np.linalg.norm(entries[:, i]):
                # One step of inverse iteration beside the eigenvalue.
                band, right = self.at(s * (1.0 + 1e-9)), mx[self.form.place, i]
                vector = self.form.solve(band, right, trans=1)
                y[self.form.place, i] = vector / np.linalg.norm(vector)
        rounding = _ROUNDINGS * np.finfo(float).eps * np.sum(np.abs(y) * entries, axis=0)
        tiny = np.finfo(float).tiny
        first = np.abs(np.sum(y.conj() * (2.0 * values * mx + dx), axis=0))
        second = np.abs(np.sum(y.conj() * mx, axis=0))
        # A double eigenvalue's error is the square root of the perturbation.
        return np.minimum(
            rounding / np.maximum(first, tiny), np.sqrt(rounding / np.maximum(second, tiny))
        )


class _Krylov:
    """Krylov space of the shifted inverse of [[0, 1], [-K, -D]] - s [[1, 0], [0, M]], s = -1."""

    def __init__(self, pencil: _Pencil, most: int) -> None:
        lu, pivots = pencil.form.factors(pencil.at(-1.0))
        near, far = pencil.mass - pencil.damping, -pencil.mass
        self.operator = lu.T, pivots, np.ascontiguousarray(near.T), np.ascontiguousarray(far.T)
        self.n = pencil.mass.shape[1]
        self.basis = np.zeros((most + _BLOCK, 2 * self.n))
        self.basis[:_BLOCK] = _start(2 * self.n)
        self.hessenberg = np.zeros((most + _BLOCK, most))
        self.size = 0

    @property
    def norm(self) -> float:
        """Norm of the inverse on the space."""
        return float(np.linalg.norm(self.hessenberg[: self.size, : self.size]))

    def ritz(self, size: int) -> tuple[ComplexArray, ComplexArray, Array]:
        """Return the eigenvalues of the inverse, vectors over the basis, and relative residuals."""
        from ._band_kernels import expand

        lu, pivots, near, far = self.operator
        expand(lu, pivots, near, far, self.basis, self.hessenberg, self.size, size)
        self.size = size
        inverse, small = np.linalg.eig(self.hessenberg[:size, :size])
        rest = self.hessenberg[size : size + _BLOCK, size - _BLOCK : size]
        residual = np.linalg.norm(rest @ small[-_BLOCK:], axis=0)
        there = np.abs(inverse) > np.finfo(float).eps * np.abs(inverse).max()
        inverse, small, residual = inverse[there], small[:, there], residual[there]
        return inverse.astype(complex), small, residual / np.abs(inverse)

    def vectors(self, small: ComplexArray) -> ComplexArray:
        """Return the displacements of vectors over the basis."""
        basis = self.basis[: self.size, : self.n].T
        return basis @ small.real + 1j * (basis @ small.imag)


@cache
def _start(size: int) -> Array:
    """Return the first orthonormal vectors of a Krylov space."""
    random = np.random.default_rng(0).standard_normal((size, _BLOCK))
    return np.asarray(np.linalg.qr(random)[0].T)


def _at_their_frequencies(machine: Machine, speed: float, start: Eigenmodes) -> Eigenmodes:
    """Return modes with the supports' laws over frequency.

    Each by Newton from that of the matrices.

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
