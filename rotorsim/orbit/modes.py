"""Growth rates and frequencies measured from an orbit, unbalance response or not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .orbit import Orbit

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
_SAMPLES_PER_REVOLUTION = 16
_DELAYS = 32
_COLUMNS = 2000
_RANK = 24
_NOISE = 1e-8
"""Singular values below this share of the largest are the integrator's, not the motion's."""


@dataclass(frozen=True)
class Modes:
    """Motion at constant speed as a sum of exponentials.

    eigenvalues : (k,) complex array. sigma + i Omega, Omega >= 0 [1/s, rad/s]; strongest first (by
        energy over the record).
    amplitudes : (k, 2) complex array. Of x and y at the record's start [m].
    synchronous : (k,) bool array. Steady response at 0, 1, 2 ... times the shaft's frequency:
        forced, not free.
    """

    eigenvalues: ComplexArray
    amplitudes: ComplexArray
    synchronous: NDArray[np.bool_]


@dataclass(frozen=True)
class Growth:
    """The free whirl that dominates a record.

    rate : [1/s], above 0 where it grows: the eigenvalue's real part.
    frequency : [rad/s]: its imaginary part; 0 for a motion that only creeps.
    whirl_frequency_ratio : Frequency over the shaft's.
    forward : Whether it turns with the shaft.
    """

    rate: float
    frequency: float
    whirl_frequency_ratio: float
    forward: bool

    @property
    def logarithmic_decrement(self) -> float:
        """-2 pi rate/frequency [-]; not finite without oscillation."""
        return -2.0 * np.pi * self.rate / self.frequency if self.frequency else float("nan")


def _fit_modes(orbit: Orbit) -> Modes:
    """Fit exponentials to x, y, vx, vy with a matrix pencil.

    Raises InputError: The speed varies, or there are too few samples.

    Delayed samples of all four signals make a Hankel matrix; after truncation to its significant
    singular values the one-sample shift has the eigenvalues exp(lambda dt) (Hua & Sarkar 1990).
    The static position and the steady unbalance response are modes of zero growth among the rest:
    nothing needs to be subtracted beforehand.
    """
    speed = float(orbit.speed[0]) if orbit.t.size else 0.0
    if not orbit.constant_speed:
        raise InputError("growth is measured at constant speed", key="orbit.speed")
    stride = max(orbit.samples_per_revolution // _SAMPLES_PER_REVOLUTION, 1)
    signals = np.stack([orbit.x, orbit.y, orbit.vx / speed, orbit.vy / speed])[:, ::stride]
    count = signals.shape[1]
    if count < 12:
        raise InputError(
            f"needs 12 samples or more after thinning to {_SAMPLES_PER_REVOLUTION} a revolution",
            key="orbit.revolutions",
            value=count,
        )
    step = float(orbit.t[stride] - orbit.t[0])
    poles: ComplexArray = np.log(_shift_eigenvalues(signals)).astype(np.complex128) / step
    poles = poles[poles.imag >= -1e-9 * speed]
    amplitudes, energy = _amplitudes(poles, signals[:2], step)
    order = np.argsort(-energy)
    order = order[energy[order] > _NOISE**2 * np.max(energy, initial=0.0)]
    poles, amplitudes = poles[order].astype(np.complex128), amplitudes[order]
    multiple = np.round(poles.imag / speed)
    synchronous = np.abs(poles - 1j * multiple * speed) < 1e-5 * speed
    return Modes(poles, amplitudes, synchronous)


def _shift_eigenvalues(signals: Array) -> ComplexArray:
    """exp(lambda dt) of everything significant in the signals (s, n)."""
    count = signals.shape[1]
    delays = min(_DELAYS, count // 3)
    starts = np.arange(0, count - delays, max((count - delays) // _COLUMNS, 1))
    rows = np.arange(delays)[:, None]
    now = signals[:, rows + starts].reshape(-1, starts.size)
    following = signals[:, rows + starts + 1].reshape(-1, starts.size)
    left, sigma, right = np.linalg.svd(now, full_matrices=False)
    if sigma[0] == 0.0:
        return np.zeros(0, dtype=complex)
    rank = int(min(np.sum(sigma > _NOISE * sigma[0]), _RANK))
    left, sigma, right = left[:, :rank], sigma[:rank], right[:rank]
    shift = left.T @ following @ right.T / sigma
    values = np.linalg.eigvals(shift).astype(complex)
    return values[np.abs(values) > 1e-12]


def _amplitudes(poles: ComplexArray, signals: Array, step: float) -> tuple[ComplexArray, Array]:
    """Least-squares amplitudes (k, 2) at the start, and the modes' energies (k,)."""
    times = step * np.arange(signals.shape[1])
    # growing modes are fitted from their end, so that no column overflows
    origin = np.where(poles.real > 0.0, times[-1], 0.0)
    basis = np.exp(poles * (times[:, None] - origin))
    oscillating = poles.imag > 0.0
    matrix = np.hstack([basis.real, -basis.imag[:, oscillating]])
    solution = np.linalg.lstsq(matrix, signals.T, rcond=None)[0]
    amplitudes = solution[: poles.size].astype(complex)
    amplitudes[oscillating] += 1j * solution[poles.size :]
    energy = np.sum(np.abs(basis) ** 2, axis=0) * np.sum(np.abs(amplitudes) ** 2, axis=1)
    return amplitudes * np.exp(-poles * origin)[:, None], energy


def growth_rate(orbit: Orbit) -> Growth | None:
    """Growth rate and frequency of the strongest free motion; None where there is none.

    For small motions they equal the real and imaginary part of the eigenvalue nearest to
    instability, also beneath an unbalance response.
    """
    modes = _fit_modes(orbit)
    free = np.flatnonzero(~modes.synchronous)
    if not free.size:
        return None
    value, (ax, ay) = modes.eigenvalues[free[0]], modes.amplitudes[free[0]]
    frequency = float(max(value.imag, 0.0))
    return Growth(
        rate=float(value.real),
        frequency=frequency,
        whirl_frequency_ratio=frequency / float(orbit.speed[0]),
        forward=bool(abs(ax + 1j * ay) >= abs(ax - 1j * ay)),
    )
