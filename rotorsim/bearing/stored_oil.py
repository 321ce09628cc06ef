"""Verdict on a rigid rotor whose film answers with a delay, from A(i nu) over the whirl frequency.

A film that stores oil feeds back what happened up to a turn ago. The rigid rotor then has more
eigenvalues than four, and a mass may lie between several thresholds. They are counted with
Mikhailov's criterion: along the positive imaginary axis the phase of det(M s^2 + A(s)), of fourth
degree and without poles on the right, grows by 2 pi, less pi for each eigenvalue with a positive
real part.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from ..status import Stability
from .whirl import routh_coefficients

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_RATIOS = np.linspace(0.0, 2.5, 51)
"""Whirl over shaft frequencies at which the film is solved; from the last on K and C are kept."""
_FINE = np.linspace(0.0, _RATIOS[-1], 5001)[1:]
_TOLERANCE = 1e-9


@dataclass(frozen=True)
class FrequencyScan:
    """A(i nu) of a bearing's journal over the whirl frequency, (2, 2).

    law : A(s) [N/m] at any s [1/s].
    speed : Of the shaft [rad/s].
    curve : A(i nu) at arrays of nu over the shaft's frequency, interpolated.
    """

    law: Callable[[complex], ComplexArray]
    speed: float
    curve: Callable[[Array], ComplexArray]

    @classmethod
    def of(cls, law: Callable[[complex], ComplexArray], speed: float) -> FrequencyScan:
        """Solve the film at the frequencies of the scan."""
        values = np.array([law(1j * ratio * speed) for ratio in _RATIOS])
        return cls(law, speed, CubicSpline(_RATIOS, values))

    def threshold(self) -> tuple[Stability, float | None]:
        """Return the verdict, and the whirl frequency ratio at the threshold if there is one."""
        crossings = self._crossings()
        masses = np.array([mass for mass, _ in crossings])
        if not masses.size:
            size = np.abs(np.linalg.det(self.curve(_FINE[:1])[0])) ** 0.5 / self.speed**2
            stable = self.unstable_eigenvalues(float(size)) == 0
            return (Stability.ALWAYS_STABLE if stable else Stability.ALWAYS_UNSTABLE), None
        between = np.sqrt(masses[1:] * masses[:-1])
        counts = [
            self.unstable_eigenvalues(float(mass))
            for mass in (0.5 * masses[0], *between, 2.0 * masses[-1])
        ]
        if counts[0] == 0:
            for (_, ratio), count in zip(crossings, counts[1:], strict=True):
                if count > 0:
                    return Stability.THRESHOLD, self._refined(ratio)
            return Stability.ALWAYS_STABLE, None
        if counts[-1] == 0:
            return Stability.REVERSED_THRESHOLD, self._refined(crossings[-1][1])
        return Stability.ALWAYS_UNSTABLE, None

    def unstable_eigenvalues(self, mass: float) -> int:
        """Count the eigenvalues with a positive real part of a rotor of `mass` per bearing [kg]."""
        last = self.curve(_RATIOS[-1:])[0]
        stiffness, damping = last.real, last.imag / (_RATIOS[-1] * self.speed)
        fastest = max(
            np.abs(damping).max() / mass, np.sqrt(np.abs(stiffness).max() / mass), self.speed
        )
        beyond = np.geomspace(_RATIOS[-1], 1e4 * fastest / self.speed, 4001)[1:]
        outer = stiffness + 1j * self.speed * beyond[:, None, None] * damping
        frequency = self.speed * np.concatenate([_FINE, beyond])
        film = np.concatenate([self.curve(_FINE), outer])
        film = film - mass * frequency[:, None, None] ** 2 * np.eye(2)
        film = np.concatenate([self.curve(_RATIOS[:1]), film])
        phase = np.unwrap(np.angle(np.linalg.det(film)))
        return round((2.0 * np.pi - (phase[-1] - phase[0])) / np.pi)

    def least_damped(self, mass: float, count: int = 4) -> Array:
        """Frequencies [rad/s] near which det(A - M nu^2) is smallest: first guesses of modes."""
        frequency = self.speed * _FINE
        matrices = self.curve(_FINE) - mass * frequency[:, None, None] ** 2 * np.eye(2)
        values = np.linalg.svd(matrices, compute_uv=False)
        off = values[:, 1] / values[:, 0]
        inner = np.flatnonzero((off[1:-1] < off[:-2]) & (off[1:-1] < off[2:])) + 1
        return frequency[inner[np.argsort(off[inner])][:count]]

    def _crossings(self) -> list[tuple[float, float]]:
        """Masses at which an eigenvalue is i nu, ascending, with nu over the shaft's frequency."""
        values = _misfit(self.curve(_FINE), self.speed * _FINE)
        found = []
        for i in np.flatnonzero(values[1:] * values[:-1] < 0.0):
            share = values[i] / (values[i] - values[i + 1])
            ratio = float(_FINE[i] + share * (_FINE[i + 1] - _FINE[i]))
            loads = np.linalg.eigvals(self.curve(np.array([ratio]))[0])
            real = loads[np.argmin(np.abs(loads.imag))]
            # A change of sign without a crossing: K_e passes through infinity.
            if real.real > 0.0 and abs(real.imag) < 1e-2 * real.real:
                found.append((float(real.real) / (ratio * self.speed) ** 2, ratio))
        return sorted(found)

    def _refined(self, ratio: float) -> float:
        """Threshold's ratio without the interpolation."""

        def off(value: float) -> float:
            return float(_misfit(self.law(1j * value * self.speed), value * self.speed))

        low, high = ratio - 0.01, ratio + 0.01
        if low <= 0.0 or off(low) * off(high) > 0.0:
            return ratio
        return float(brentq(off, low, high, xtol=_TOLERANCE))  # type: ignore[arg-type]


def _misfit(film: ComplexArray, frequency: Array | float) -> Array:
    """det(K - K_e I) - nu^2 det C, relative to its size: zero at a threshold."""
    nu = np.asarray(frequency)
    routh = routh_coefficients(film.real, film.imag / nu[..., None, None])
    squeezed = nu**2 * routh.det_damping
    return (routh.det_shifted - squeezed) / (np.abs(routh.det_stiffness) + np.abs(squeezed))
