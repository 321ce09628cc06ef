"""Charts of a recording as plain arrays: eigenvalues, stability maps, spectra (SI)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class EigenvaluePath:
    """Eigenvalues of the linear system over speed.

    Attributes
    ----------
    name : str
    speed : (n,) array
        Ascending [rad/s].
    eigenvalues : (n, k) complex array
        Each column one continuous branch [1/s].
    threshold_speed : float, optional
        [rad/s]; None where no branch crosses.
    whirl_frequency_ratio : float, optional
        At the threshold.
    """

    name: str
    speed: Array
    eigenvalues: NDArray[np.complex128]
    threshold_speed: float | None = None
    whirl_frequency_ratio: float | None = None

    def at(self, speed: Array | float) -> NDArray[np.complex128]:
        """Eigenvalues between the tabulated speeds, (..., k); held at both ends."""
        columns = np.moveaxis(self.eigenvalues, -1, 0)
        parts = [
            np.interp(speed, self.speed, column.real)
            + 1j * np.interp(speed, self.speed, column.imag)
            for column in columns
        ]
        return np.stack(parts, axis=-1)


class Verdict(IntEnum):
    """A cell of the stability map."""

    UNKNOWN = 0
    STABLE = 1
    HEATING_DESTABILISES = 2
    UNSTABLE = 3
    HEATING_STABILISES = 4

    @property
    def label(self) -> str:
        """For legends."""
        return VERDICT_LABELS[self]


VERDICT_LABELS = {
    Verdict.UNKNOWN: "not computed",
    Verdict.STABLE: "stable",
    Verdict.HEATING_DESTABILISES: "stable if heating is neglected, unstable with it",
    Verdict.UNSTABLE: "unstable",
    Verdict.HEATING_STABILISES: "unstable if heating is neglected, stable with it",
}


def classify(isothermal_growth: ArrayLike, heated_growth: ArrayLike) -> NDArray[np.uint8]:
    """Verdict of each cell from the two models' growth rates.

    Parameters
    ----------
    isothermal_growth, heated_growth : array_like
        Largest real parts: positive where unstable, NaN where unknown [1/s].

    Returns
    -------
    array of uint8
        `Verdict` values, the broadcast shape of both.
    """
    cold, hot = np.broadcast_arrays(np.asarray(isothermal_growth), np.asarray(heated_growth))
    verdict = np.full(cold.shape, Verdict.UNKNOWN, dtype=np.uint8)
    verdict[(cold < 0) & (hot < 0)] = Verdict.STABLE
    verdict[(cold < 0) & (hot >= 0)] = Verdict.HEATING_DESTABILISES
    verdict[(cold >= 0) & (hot >= 0)] = Verdict.UNSTABLE
    verdict[(cold >= 0) & (hot < 0)] = Verdict.HEATING_STABILISES
    return verdict


@dataclass(frozen=True)
class MapPicture:
    """Stability verdict over speed and rotor mass.

    Attributes
    ----------
    title : str
    speed : (n,) array
        Ascending [rad/s].
    mass : (m,) array
        Ascending, per bearing [kg].
    verdict : (n, m) array of `Verdict` values
        See `classify`.
    rotor_mass : float, optional
        Mass of the simulated rotor [kg]: the moving point's height.
    isothermal_growth, heated_growth : (n, m) arrays, optional
        Growth rates behind the verdict, positive where unstable, NaN where unknown [1/s]. With both
        the borders are drawn smooth, between the cells.
    """

    title: str
    speed: Array
    mass: Array
    verdict: NDArray[np.uint8]
    rotor_mass: float | None = None
    isothermal_growth: Array | None = None
    heated_growth: Array | None = None

    def verdict_at(self, speed: Array, mass: Array) -> NDArray[np.uint8]:
        """Verdict on a finer grid, (len(speed), len(mass))."""
        if self.isothermal_growth is None or self.heated_growth is None:
            return self.verdict[nearest(self.speed, speed)[:, None], nearest(self.mass, mass)]
        cold = _bilinear(self.speed, self.mass, self.isothermal_growth, speed, mass)
        hot = _bilinear(self.speed, self.mass, self.heated_growth, speed, mass)
        return classify(cold, hot)


@dataclass(frozen=True)
class CascadePicture:
    """Spectra of a motion over shaft speed.

    Attributes
    ----------
    title : str
    speed : (n,) array
        Ascending [rad/s].
    frequency : (m,) array
        Ascending [rad/s].
    amplitude : (n, m) array
        [m]
    """

    title: str
    speed: Array
    frequency: Array
    amplitude: Array


@dataclass(frozen=True)
class SpectrumPicture:
    """Spectrum of a motion at constant speed.

    Attributes
    ----------
    name : str
        Of the track.
    speed : float
        Of the shaft [rad/s].
    frequency : (m,) array
        Ascending [rad/s].
    amplitude : (m,) array
        [m]
    """

    name: str
    speed: float
    frequency: Array
    amplitude: Array


def nearest(known: Array, wanted: Array) -> NDArray[np.intp]:
    """Index of the nearest of ascending values."""
    return np.searchsorted(0.5 * (known[1:] + known[:-1]), wanted)


def _bilinear(x: Array, y: Array, values: Array, new_x: Array, new_y: Array) -> Array:
    def split(known: Array, wanted: Array) -> tuple[NDArray[np.intp], Array]:
        low = np.clip(np.searchsorted(known, wanted, side="right") - 1, 0, known.size - 2)
        return low, np.clip((wanted - known[low]) / (known[low + 1] - known[low]), 0.0, 1.0)

    i, u = split(x, new_x)
    j, v = split(y, new_y)
    along = values[i] * (1.0 - u[:, None]) + values[i + 1] * u[:, None]
    return along[:, j] * (1.0 - v) + along[:, j + 1] * v
