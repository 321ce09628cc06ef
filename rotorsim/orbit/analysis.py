"""What an orbit shows, in numbers: how it ends, how it grows, how far it swings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from .modes import Growth, growth_rate
from .orbit import Orbit, OrbitStatus
from .recognition import Recognition, recognise, steady_part
from .spectrum import Cascade, Ellipse, Spectrum, cascade, orbit_ellipse, spectrum

SMALL_MOTION = 0.1
"""Distance from equilibrium over clearance up to which a growth rate is measured."""
WHIRLING = 0.05
"""Subsynchronous half axis over clearance that counts as whirl in a run through the speeds."""
_SUBSYNCHRONOUS = (0.15, 0.85)
_LEAST_REVOLUTIONS = 4
_CASCADE_REVOLUTIONS = 16
_CASCADE_BLOCKS = (16, 32)
"""Revolutions behind one spectrum of a cascade that is shown: of a short and of a long run."""


@dataclass(frozen=True)
class WhirlRange:
    """Where a run through the speeds whirls below the shaft's frequency.

    Attributes
    ----------
    first_speed, last_speed : float
        Of the first and the last block of revolutions that whirls [rad/s].
    strongest_speed : float
        Where the whirl is largest [rad/s].
    frequency : float
        Of the whirl there [rad/s].
    amplitude : float
        Its major half axis there [m].
    """

    first_speed: float
    last_speed: float
    strongest_speed: float
    frequency: float
    amplitude: float


@dataclass(frozen=True)
class OrbitAnalysis:
    """What an orbit shows.

    Attributes
    ----------
    recognition : Recognition or None
        None where the speed varies.
    growth : Growth or None
        Of small motions at the start; None where there are too few of them.
    amplitude : float
        Half the largest extent along x or y, of the steady part where there is one [m].
    whirl : Ellipse or None
        Of a steady whirl, at its own frequency.
    synchronous : Ellipse or None
        Of the steady part, at the shaft's frequency; None where there is none.
    min_film, min_film_time : float
        Smallest film thickness and when [m, s].
    whirl_range : WhirlRange or None
        In a run through the speeds.
    """

    recognition: Recognition | None
    growth: Growth | None
    amplitude: float
    whirl: Ellipse | None
    synchronous: Ellipse | None
    min_film: float
    min_film_time: float
    whirl_range: WhirlRange | None


def analyse(orbit: Orbit) -> OrbitAnalysis:
    """Analyse one run."""
    found = recognise(orbit) if orbit.constant_speed else None
    steady = orbit if found is None or found.steady_from is None else orbit.part(found.steady_from)
    whirl = synchronous = None
    if found is not None and found.steady_from is not None:
        steady = steady if steady.t.size > 2 else orbit.part(-3)
        if found.whirl_frequency_ratio:
            whirl = orbit_ellipse(steady, abs(found.whirl_frequency_ratio))
        if orbit.forced and found.status is not OrbitStatus.SETTLED:
            synchronous = orbit_ellipse(steady)
    least = int(np.argmin(orbit.min_film))
    return OrbitAnalysis(
        recognition=found,
        growth=initial_growth(orbit) if orbit.constant_speed else None,
        amplitude=0.5 * float(max(np.ptp(steady.x), np.ptp(steady.y))),
        whirl=whirl,
        synchronous=synchronous,
        min_film=float(orbit.min_film[least]),
        min_film_time=float(orbit.t[least]),
        whirl_range=None if orbit.constant_speed else whirl_range(orbit),
    )


def initial_growth(orbit: Orbit) -> Growth | None:
    """Growth of the small motions with which a run begins, at constant speed.

    Linear coefficients know no large motions: the whole run counts. With a nonlinear film only the
    part counts that stays within `SMALL_MOTION` of the equilibrium, and only without unbalance and
    loads.
    """
    part = orbit
    if orbit.force_model != "linear":
        if orbit.forced:
            return None  # what is forced cannot be told from what is free
        away = np.hypot(orbit.x - orbit.equilibrium[0], orbit.y - orbit.equilibrium[1])
        # A run that begins right at the limit counts, whatever the rounding of its equilibrium.
        large = np.flatnonzero(away > (1.0 + 1e-6) * SMALL_MOTION * orbit.radial_clearance)
        part = orbit.part(0, int(large[0]) if large.size else None)
        if part.t.size < _LEAST_REVOLUTIONS * orbit.samples_per_revolution:
            return None
    try:
        return growth_rate(part)
    except InputError:  # ended too early to measure anything
        return None


def steady_spectrum(orbit: Orbit) -> Spectrum | None:
    """Spectrum of a run at constant speed: of its steady part, of all of it where it has none.

    None for a run that comes to rest, through the speeds, or too short for a spectrum.
    """
    if not orbit.constant_speed or orbit.status is OrbitStatus.SETTLED or not orbit.t.size:
        return None
    try:
        return spectrum(steady_part(orbit) or orbit)
    except InputError:
        return None


def speed_cascade(orbit: Orbit) -> Cascade | None:
    """Cascade of a run through the speeds; None at constant speed, or where it is too short."""
    if orbit.constant_speed or not orbit.t.size:
        return None
    short, long = _CASCADE_BLOCKS
    turns = abs(float(orbit.revolutions[-1] - orbit.revolutions[0]))
    try:
        rows = cascade(orbit, long if turns >= 10 * long else short)
    except InputError:
        return None
    return rows if np.ptp(rows.speed) > 0.0 else None


def whirl_range(orbit: Orbit) -> WhirlRange | None:
    """Where a run through the speeds whirls; None where it nowhere does, or is too short."""
    try:
        rows = cascade(orbit, _CASCADE_REVOLUTIONS)
    except InputError:
        return None
    below = subsynchronous(rows)
    amplitude = below.max(axis=1)
    whirls = np.flatnonzero(amplitude > WHIRLING * orbit.radial_clearance)
    if not whirls.size:
        return None
    top = int(np.argmax(amplitude))
    line = int(np.argmax(below[top]))
    return WhirlRange(
        first_speed=float(rows.speed[whirls[0]]),
        last_speed=float(rows.speed[whirls[-1]]),
        strongest_speed=float(rows.speed[top]),
        frequency=float(rows.frequency[top, line]),
        amplitude=float(amplitude[top]),
    )


def subsynchronous(rows: Cascade) -> np.ndarray:
    """Amplitudes of a cascade with all but the orders of whirl set to zero."""
    low, high = _SUBSYNCHRONOUS
    return np.where((rows.order > low) & (rows.order < high), rows.amplitude, 0.0)
