"""Components of an orbit: frequencies, amplitudes and directions of whirl.

Samples are equally spaced in shaft angle, so a transform gives orders (multiples of the shaft's
frequency) at constant and at changing speed alike. Forward and backward whirl are the positive
and negative orders of z = x + i y.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ..arrays import Array, ComplexArray
from ..errors import InputError
from .orbit import Orbit

_HARMONICS = np.arange(-4, 5)
_MAX_REVOLUTIONS = 256
_LOCKED = 1e-3
"""Of a turn: how far a locked whirl may slip while it closes once."""


@dataclass(frozen=True)
class Spectrum:
    """Amplitudes by order.

    order : (m,) array. Frequency over the shaft's, from 0.
    frequency : (m,) array [rad/s], at the record's mean speed.
    forward, backward : (m,) arrays. Amplitudes of the circular parts [m].
    """

    order: Array
    frequency: Array
    forward: Array
    backward: Array


@dataclass(frozen=True)
class Cascade:
    """Spectra over a run-up, one row for each block of revolutions.

    time, speed : (k,) arrays. Block means [s, rad/s].
    order : (m,) array
    amplitude : (k, m) array. Forward and backward together: the ellipse's major half axis [m].
    frequency : (k, m) array [rad/s]
    """

    time: Array
    speed: Array
    order: Array
    amplitude: Array

    @property
    def frequency(self) -> Array:
        """Frequencies of every entry [rad/s], (k, m)."""
        return self.speed[:, None] * self.order


@dataclass(frozen=True)
class Ellipse:
    """The part of an orbit at one order: z = forward exp(i w t) + backward exp(-i w t).

    forward, backward : Circular parts [m], phases against the shaft's angle.
    center : (float, float). Mean position [m].
    """

    order: float
    forward: complex
    backward: complex
    center: tuple[float, float]

    @property
    def semi_major(self) -> float:
        """Half the longest diameter [m]."""
        return abs(self.forward) + abs(self.backward)

    @property
    def semi_minor(self) -> float:
        """Half the shortest diameter [m]; negative for backward whirl."""
        return abs(self.forward) - abs(self.backward)

    @property
    def inclination(self) -> float:
        """Angle of the major axis from x in the direction of rotation, -pi/2 to pi/2 [rad]."""
        angle = 0.5 * float(np.angle(self.forward) + np.angle(self.backward))
        return (angle + 0.5 * np.pi) % np.pi - 0.5 * np.pi

    @property
    def is_forward(self) -> bool:
        """Return whether it turns with the shaft."""
        return abs(self.forward) >= abs(self.backward)


def _window(orbit: Orbit) -> tuple[Array, ComplexArray, Array]:
    """Return the angles [rev], z [m] and normalised Hann weights."""
    n = orbit.t.size
    if n < 2 * orbit.samples_per_revolution:
        raise InputError("needs two revolutions or more", key="orbit.revolutions")
    weights = 1.0 - np.cos(2.0 * np.pi * (np.arange(n) + 0.5) / n)
    return orbit.revolutions, orbit.x + 1j * orbit.y, weights / n


def spectrum(orbit: Orbit) -> Spectrum:
    """Return the two-sided amplitude spectrum of the whole record, drift removed (Hann window).

    The drift is a straight line: in a run through the speeds the static position moves, which is no
    vibration of low frequency.
    """
    _, z, weights = _window(orbit)
    half = z.size // 2
    along = np.linspace(-1.0, 1.0, z.size)
    slope = np.sum(weights * along * z) / np.sum(weights * along**2)
    lines = np.fft.fft(weights * (z - np.sum(weights * z) - slope * along))
    order = np.arange(half) * orbit.samples_per_revolution / z.size
    forward, backward = np.abs(lines[:half]), np.abs(np.roll(lines[::-1], 1)[:half])
    return Spectrum(order, order * float(np.mean(orbit.speed)), forward, backward)


def cascade(orbit: Orbit, revolutions: int = 16, overlap: float = 0.5) -> Cascade:
    """Return the spectra of successive blocks.

    revolutions : In each block: orders are resolved to 1/revolutions.
    overlap : Of neighbouring blocks, 0 to below 1.
    """
    size = revolutions * orbit.samples_per_revolution
    hop = max(int(size * (1.0 - overlap)), 1)
    starts = range(0, orbit.t.size - size + 1, hop)
    if not starts:
        raise InputError(
            f"the record holds {orbit.t.size // orbit.samples_per_revolution} revolutions, "
            "fewer than one block",
            key="revolutions",
            value=revolutions,
        )
    blocks = [orbit.part(start, start + size) for start in starts]
    spectra = [spectrum(block) for block in blocks]
    return Cascade(
        time=np.array([float(np.mean(block.t)) for block in blocks]),
        speed=np.array([float(np.mean(block.speed)) for block in blocks]),
        order=spectra[0].order,
        amplitude=np.array([s.forward + s.backward for s in spectra]),
    )


def whirl_frequency_ratio(orbit: Orbit) -> float | None:
    """Return the order of the strongest motion that is no multiple of the shaft's frequency.

    Returns: Positive for forward whirl, negative for backward; None where nothing but the static
        position and harmonics of the shaft's frequency remains (below 1e-6 of the clearance).

    The mean and the shaft's first four harmonics are fitted and removed, then the maximum of the
    continuous windowed transform is located: far finer than the distance of the lines.
    """
    from scipy.optimize import minimize_scalar

    most = _MAX_REVOLUTIONS * orbit.samples_per_revolution
    turns, z, weights = _window(orbit.part(max(orbit.t.size - most, 0)))
    turns = turns - turns[0]
    root = np.sqrt(weights)[:, None]
    harmonics = np.exp(2j * np.pi * turns[:, None] * _HARMONICS)
    fit = np.linalg.lstsq(root * harmonics, root[:, 0] * z, rcond=None)[0]
    rest = weights * (z - harmonics @ fit)
    lines = np.abs(np.fft.fft(rest))
    orders = np.fft.fftfreq(z.size, 1.0 / orbit.samples_per_revolution)
    spacing = orbit.samples_per_revolution / z.size
    free = np.abs(orders - np.round(orders)) > 2.0 * spacing
    free &= np.abs(orders) < 0.5 * orbit.samples_per_revolution - 1.0
    strongest = int(np.argmax(np.where(free, lines, 0.0)))
    if not free.any() or lines[strongest] < 1e-6 * orbit.radial_clearance:
        return None

    def against(order: float) -> float:
        return -float(np.abs(np.sum(rest * np.exp(-2j * np.pi * order * turns))))

    near = orders[strongest]
    bounds = (near - spacing, near + spacing)
    found = minimize_scalar(
        against, bounds=bounds, method="bounded", options={"xatol": 1e-6 * spacing}
    )
    return float(found.x)


def locked_ratio(orbit: Orbit, longest: int = 8) -> Fraction | None:
    """Return the fraction of the shaft's frequency to which a whirl is locked, negative backwards.

    longest : Largest denominator.
    Returns: None where the strongest motion that is no multiple of the shaft's frequency keeps a
        frequency of its own, or is missing: in the first or second half of the run it is further
        than 1e-3/denominator from the fraction.
    """
    half, found = orbit.t.size // 2, []
    for part in (orbit.part(0, half), orbit.part(half)):
        ratio = whirl_frequency_ratio(part)
        nearest = Fraction(0) if ratio is None else Fraction(ratio).limit_denominator(longest)
        if ratio is None or abs(ratio - nearest) * nearest.denominator > _LOCKED:
            return None
        found.append(nearest)
    return found[0] if found[0] == found[1] and found[0].denominator > 1 else None


def orbit_ellipse(orbit: Orbit, order: float = 1.0) -> Ellipse:
    """Return ellipse at one order (1.

    Synchronous), by weighted least squares together with the mean.
    """
    if order <= 0.0:
        raise InputError("must be above 0", key="order", value=order)
    _, z, weights = _window(orbit)
    root = np.sqrt(weights)[:, None]
    basis = np.exp(1j * orbit.angle[:, None] * np.array([0.0, order, -order]))
    mean, forward, backward = np.linalg.lstsq(root * basis, root[:, 0] * z, rcond=None)[0]
    return Ellipse(order, complex(forward), complex(backward), (float(mean.real), float(mean.imag)))


def poincare_points(orbit: Orbit, phase: float = 0.0) -> Orbit:
    """Sample once per revolution, at the given shaft angle [rad] (to the nearest sample)."""
    step = orbit.samples_per_revolution
    index = np.round(orbit.revolutions * step).astype(int)
    wanted = round(phase / (2.0 * np.pi) * step) % step
    first = int((wanted - index[0]) % step) if index.size else 0
    return orbit.part(first, None, step)
