"""Threshold speeds, at which a machine changes its verdict, and critical speeds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np

from ..arrays import Array
from ..threads import on_one_blas_thread
from .branches import Modes
from .machine import Machine
from .modes import machine_spectrum, modes
from .spectrum import Eigenmodes, MachineSpectrum, Spectrum

_SAME_MODE, _SAME_VALUE = 0.9, 0.3
"""Likeness of shape, and relative distance of the eigenvalue, by which a mode is itself."""
_OTHER_MODE = 0.1
"""Likeness of shapes below which an abrupt step leads from one mode to another."""
_MEETS = 1e-6
"""Of the speed: by how much a frequency may miss it at a critical speed."""
CRITICAL_DAMPING = 0.5**0.5
"""Damping ratio from which an unbalance response has no peak: no critical speed."""


@dataclass(frozen=True)
class ThresholdSpeed:
    """A speed at which the machine changes its verdict.

    speed : [rad/s]
    whirl_frequency : Of the mode that crosses [rad/s]; 0 for a static divergence.
    becomes_unstable : With rising speed; False: it becomes stable.
    """

    speed: float
    whirl_frequency: float
    whirl_frequency_ratio: float
    becomes_unstable: bool


@on_one_blas_thread
def find_thresholds(spectrum: Spectrum, speeds: Sequence[float] | Array) -> list[ThresholdSpeed]:
    """Return the speeds at which the least stable eigenvalue crosses the imaginary axis.

    spectrum : Modes at a speed [rad/s]; None marks one without coefficients.
    speeds : Ascending; one crossing is found between two neighbours whose verdicts differ.
    Returns: Ascending, speed to a relative 1e-13 or as far as the eigenvalues are accurate. Empty:
        one verdict everywhere.

    Modes whose real part is below their own accuracy are neither stable nor unstable, and count
    nowhere.
    """
    from scipy.optimize import brentq

    def rate(omega: float) -> float:
        return _leading(spectrum, omega).real

    points = [(float(s), rate(float(s))) for s in speeds]
    # At a point without any damped mode there is no verdict to change.
    points = [point for point in points if point[1] != 0.0]
    tolerance: dict[str, Any] = {
        "xtol": 1e-13 * max((p[0] for p in points), default=1.0), "rtol": 1e-13,
    }  # fmt: skip
    found = []
    for (first, low), (last, high) in pairwise(points):
        if not low * high < 0.0:
            continue
        root: Any = brentq(rate, first, last, **tolerance)
        found.append(_threshold(spectrum, float(root), (first, last), low < 0.0))
    return found


def _threshold(
    spectrum: Spectrum, root: float, interval: tuple[float, float], rising: bool
) -> ThresholdSpeed:
    """Return threshold near `root`, which the band of undamped modes may have shifted a little."""
    from scipy.optimize import brentq

    side = 1.0 if rising else -1.0
    distances = abs(root) * np.geomspace(1e-12, 1e-3, 10)
    ends = [np.clip([root - d, root + d], *interval) for d in distances]
    outer = (_leading(spectrum, float(end[1] if rising else end[0])) for end in ends)
    crossing = next((value for value in outer if value.real > 0.0), 0j)

    def nearest(omega: float) -> complex:
        found = spectrum(omega)
        values = np.array([np.nan]) if found is None else found.values
        return complex(values[np.abs(values - crossing).argmin()])

    for low, high in ends:
        if side * nearest(low).real < 0.0 < side * nearest(high).real:
            tolerance: dict[str, Any] = {"xtol": 1e-14 * root, "rtol": 1e-14}
            found: Any = brentq(lambda s: nearest(s).real, low, high, **tolerance)
            root = float(found)
            break
    whirl = abs(nearest(root).imag)
    return ThresholdSpeed(root, whirl, whirl / root, rising)


def _leading(spectrum: Spectrum, speed: float) -> complex:
    """Return eigenvalue of largest real part of the damped modes; 0 without any, NaN if unknown."""
    found = spectrum(speed)
    return complex(np.nan, np.nan) if found is None else found.leading


@on_one_blas_thread
def threshold_speeds(machine: Machine, subdivisions: int = 8) -> list[ThresholdSpeed]:
    """Return the threshold speeds of a machine on its supports' interpolated tables.

    subdivisions : Points looked at in every interval of the tables.
    """
    speeds = subdivided(machine.speeds, subdivisions)
    return find_thresholds(machine_spectrum(machine, speeds), speeds)


def subdivided(knots: Array, parts: int) -> Array:
    """Return every interval between ascending knots cut into `parts`."""
    if not knots.size:
        return knots
    cut = np.arange(parts) / parts
    return np.append((knots[:-1, None] + np.diff(knots)[:, None] * cut).ravel(), knots[-1])


@dataclass(frozen=True)
class CriticalSpeed:
    """A speed that equals a damped natural frequency.

    speed : [rad/s]
    whirl : ``forward``, ``backward`` or ``mixed``.
    branch : Of the modes that were searched.
    """

    speed: float
    whirl: str
    damping_ratio: float
    branch: int


@on_one_blas_thread
def critical_speeds(
    machine: Machine, found: Modes | None = None, order: float = 1.0
) -> list[CriticalSpeed]:
    """Return the speeds at which a mode's damped frequency is `order` times the speed, ascending.

    found : Of this machine over speed, as dense as branches should be followed.

    One of each conjugate pair; modes so much damped (ratio above 0.707) that an unbalance response
    has no peak are left out. Crossings are refined to 1e-10 on the supports' interpolated tables.
    """
    return list(_crossings(machine, modes(machine) if found is None else found, order))


@lru_cache(maxsize=2)
def _crossings(machine: Machine, found: Modes, order: float) -> tuple[CriticalSpeed, ...]:
    """Return the critical speeds; several analyses of the same modes ask for them."""
    branches = found.oscillating()
    at = machine_spectrum(machine, branches.parameter)
    result = []
    offset = branches.damped_frequency - order * branches.parameter[:, None]
    for i, k in np.argwhere(offset[:-1] * offset[1:] <= 0.0):
        if offset[i + 1, k] == 0.0 and i + 2 < offset.shape[0]:
            continue  # counted as the beginning of the next interval
        crossing = _refined_crossing(at, branches, int(i), int(k), order)
        if crossing is None:
            continue
        if 0.0 <= crossing.damping_ratio[0, 0] < CRITICAL_DAMPING or crossing.growth_rate[0, 0] > 0:
            one = replace(crossing, planes=machine.rotor.planes)
            speed, ratio = float(one.parameter[0]), float(one.damping_ratio[0, 0])
            result.append(CriticalSpeed(speed, str(one.whirl[0, 0]), ratio, int(k)))
    return tuple(sorted(result, key=lambda one: one.speed))


def _refined_crossing(
    at: MachineSpectrum, branches: Modes, i: int, k: int, order: float
) -> Modes | None:
    """Return the mode at the speed between points i and i + 1 where branch k crosses.

    None: it does not, but jumps from one mode to another. The one mode is followed; all of them are
    asked for at the end, and where it is lost.
    """
    from scipy.optimize import brentq

    low, high = (float(s) for s in branches.parameter[i : i + 2])
    ends = branches.eigenvalues[[i, i + 1], k], branches.shapes[[i, i + 1], k]
    if not branches.smooth[i + 1] and abs(np.vdot(*ends[1])) ** 2 < _OTHER_MODE:
        return None

    def guess(speed: float) -> tuple[complex, Any]:
        """Return eigenvalue and shares of both ends' shapes, straight between the ends."""
        t = (speed - low) / (high - low)
        return ends[0][0] + t * (ends[0][1] - ends[0][0]), np.array([1.0 - t, t])

    def mode(speed: float) -> Eigenmodes:
        """Return that mode between the two points: nearest in eigenvalue and shape."""
        state = at(speed)
        assert state is not None  # between two speeds at which it is known
        value, shares = guess(speed)
        mac = np.abs(state.shapes.conj() @ ends[1].T) ** 2 @ shares
        cost = np.abs(state.values - value) / abs(value) + 1.0 - mac
        return state.taken(np.array([cost.argmin()]))

    def followed(speed: float) -> float:
        value, shares = guess(speed)
        found = at.follow(speed, value, ends[1][int(shares.argmax())])
        if found is not None:
            mac = np.abs(ends[1].conj() @ found[1]) ** 2 @ shares
            if mac > _SAME_MODE and abs(found[0] - value) < _SAME_VALUE * abs(value):
                return float(abs(found[0].imag))
        return every(speed)

    def every(speed: float) -> float:
        return float(abs(mode(speed).values[0].imag))

    def offset(frequency: Callable[[float], float]) -> Callable[[float], float]:
        return lambda speed: frequency(speed) - order * speed

    tolerance: dict[str, Any] = {"xtol": 1e-12 * high, "rtol": 1e-12}
    for frequency in (followed, every):
        if offset(frequency)(low) * offset(frequency)(high) > 0.0:
            continue
        root: Any = brentq(offset(frequency), low, high, **tolerance)
        one = mode(float(root))
        if abs(abs(one.values[0].imag) - order * root) < _MEETS * high:
            break
    else:  # two modes stand under one name: neither of them meets the speed here
        return None
    return Modes(
        np.array([float(root)]), one.values[None], one.accuracy[None], one.shapes[None],
        np.array([True]),
    )  # fmt: skip
