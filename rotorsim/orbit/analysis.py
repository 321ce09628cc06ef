"""Analysis of an orbit: what its last part is, how small motions grow, how far it swings, whirl."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Booleans, ComplexArray
from ..errors import InputError
from .orbit import Orbit, OrbitStatus
from .spectrum import (
    Cascade,
    Ellipse,
    Spectrum,
    cascade,
    locked_ratio,
    orbit_ellipse,
    poincare_points,
    spectrum,
    whirl_frequency_ratio,
)

_SMALL_MOTION = 0.1
"""Distance from equilibrium over clearance up to which a growth rate is measured."""
WHIRLING = 0.05
"""Subsynchronous half axis over clearance that counts as whirl in a run through the speeds."""
_SUBSYNCHRONOUS = (0.15, 0.85)
_GROWTH_REVOLUTIONS = 4
_CASCADE_REVOLUTIONS = 16
_CASCADE_BLOCKS = (16, 32)
"""Revolutions behind one spectrum of a cascade that is shown: of a short and of a long run."""
_AT_REST = 1e-4
"""Motion over clearance that counts as none."""
_STEADY = 2e-3
"""Relative change of amplitude, and of mean position over amplitude, that counts as none."""
_RECOGNISED_REVOLUTIONS = 16
_BLOCK = 4
"""Revolutions in which amplitudes are taken to find where the steady part begins."""
_LONGEST_PERIOD = 8


@dataclass(frozen=True)
class Recognition:
    """Verdict on a run's last part.

    status : ``settled``, ``periodic``, ``limit_cycle``, ``quasi_periodic`` or ``completed``.
    steady_from : First sample of the steady part; None where there is none.
    period : Of a periodic orbit, in turns of the shaft.
    whirl_frequency_ratio : Of a steady whirl.
    """

    status: OrbitStatus
    message: str
    steady_from: int | None = None
    period: int | None = None
    whirl_frequency_ratio: float | None = None


def recognise(orbit: Orbit) -> Recognition:
    """Recognise what the second half of a run at constant speed has come to.

    Amplitudes (root mean square about the mean) of the third and the last quarter are compared:
    steady means equal to 0.2 %. A steady orbit is periodic if the points at one shaft angle repeat
    within 0.2 % of the amplitude after 1 to 8 turns; else it whirls at a frequency of its own.
    """
    size, per_turn = orbit.t.size, orbit.samples_per_revolution
    if size < _RECOGNISED_REVOLUTIONS * per_turn:
        return Recognition(OrbitStatus.COMPLETED, "too short to tell what it comes to")
    third, last = orbit.part(size // 2, 3 * size // 4), orbit.part(3 * size // 4)
    before, after = _swing(third), _swing(last)
    clearance = orbit.radial_clearance
    if after < _AT_REST * clearance and after <= max(before, 1e-8 * clearance):
        return Recognition(OrbitStatus.SETTLED, "at rest", steady_from=_rest_from(orbit))
    drift = abs(_middle(last)[0] - _middle(third)[0])
    period = _period(last, after) if orbit.forced else None
    if period is None and (abs(after - before) > _STEADY * after or drift > 5 * _STEADY * after):
        trend = "growing" if after > before else "decaying"
        return Recognition(OrbitStatus.COMPLETED, f"still {trend}")
    # At least what was found steady above.
    start = _steady_from(orbit, after, size // 2 if period is None else 3 * size // 4)
    if period is not None:
        turns = "turn" if period == 1 else "turns"
        message = f"repeats after {period} {turns} of the shaft"
        if (locked := locked_ratio(last)) is not None:
            message += f": whirl locked to {locked} of its speed"
        return Recognition(OrbitStatus.PERIODIC, message, start, period)
    ratio = whirl_frequency_ratio(last)
    if ratio is not None:
        # beneath a steady unbalance response a whirl may still be fading or growing
        earlier, later = (orbit_ellipse(p, abs(ratio)).semi_major for p in (third, last))
        if abs(later - earlier) > 0.01 * later:
            trend = "growing" if later > earlier else "decaying"
            return Recognition(OrbitStatus.COMPLETED, f"whirl at {ratio:.4f} still {trend}")
        if any(abs(abs(ratio) * orbit.speed[0] - load) < 1e-3 * load for load in orbit.forcing):
            message = f"follows the load at {abs(ratio):.4f} of shaft speed"
            return Recognition(OrbitStatus.PERIODIC, message, start, whirl_frequency_ratio=ratio)
    shaken = orbit.forced and orbit_ellipse(last).semi_major > 0.01 * after
    status = OrbitStatus.QUASI_PERIODIC if shaken else OrbitStatus.LIMIT_CYCLE
    message = "steady whirl" if ratio is None else f"steady whirl at {ratio:.4f} of shaft speed"
    return Recognition(status, message, start, whirl_frequency_ratio=ratio)


def steady_part(orbit: Orbit) -> Orbit | None:
    """Cut off the transient; None where the run has not become steady."""
    start = recognise(orbit).steady_from
    return None if start is None else orbit.part(start)


def once_per_turn(orbit: Orbit) -> Array | None:
    """Return positions at whole turns of the shaft in the steady part (Poincare points).

    Shape (k, 2) [m].

    None where the run does not end in a steady motion.
    """
    if orbit.status not in (
        OrbitStatus.PERIODIC, OrbitStatus.LIMIT_CYCLE, OrbitStatus.QUASI_PERIODIC,
    ):  # fmt: skip
        return None
    steady = steady_part(orbit)
    if steady is None or not steady.t.size:
        return None
    points = poincare_points(steady)
    return np.column_stack([points.x, points.y])


def _swing(orbit: Orbit) -> float:
    """Return the root mean square distance from the mean position [m]."""
    mean, z, weights = _middle(orbit)
    return float(np.sqrt(np.sum(weights * np.abs(z - mean) ** 2)))


def _middle(orbit: Orbit) -> tuple[complex, ComplexArray, Array]:
    """Return mean of z = x + i y, z, and the weights.

    Smooth, for windows hold no whole whirl cycles.
    """
    count = orbit.t.size
    weights = (1.0 - np.cos(2.0 * np.pi * (np.arange(count) + 0.5) / count)) / count
    z = orbit.x + 1j * orbit.y
    return complex(np.sum(weights * z)), z, weights


def _period(orbit: Orbit, amplitude: float) -> int | None:
    points = poincare_points(orbit)
    for turns in range(1, _LONGEST_PERIOD + 1):
        if points.t.size < 2 * turns + 1:
            return None
        # the first against the last of its kind as well: a slow drift is no repetition
        same_phase = (points.t.size - 1) // turns * turns
        gaps = np.hypot(points.x[turns:] - points.x[:-turns], points.y[turns:] - points.y[:-turns])
        whole = np.hypot(points.x[same_phase] - points.x[0], points.y[same_phase] - points.y[0])
        if max(float(np.max(gaps)), float(whole)) < _STEADY * amplitude:
            return turns
    return None


def _rest_from(orbit: Orbit) -> int:
    """Return the first sample after the last one that is away from the end position."""
    away = np.hypot(orbit.x - orbit.x[-1], orbit.y - orbit.y[-1])
    outside = np.flatnonzero(away > _AT_REST * orbit.radial_clearance)
    return int(outside[-1]) + 1 if outside.size else 0


def _steady_from(orbit: Orbit, amplitude: float, known: int) -> int:
    """Return first sample of the stretch before `known` whose blocks all have that amplitude.

    To 5 %.
    """
    block = _BLOCK * orbit.samples_per_revolution
    start = known
    while start >= block:
        swing = _swing(orbit.part(start - block, start))
        if abs(swing - amplitude) > 0.05 * amplitude:
            break
        start -= block
    return start


@dataclass(frozen=True)
class _WhirlRange:
    """Range of a run through the speeds in which it whirls below the shaft's frequency.

    first_speed, last_speed : Of the first and the last block of revolutions that whirls [rad/s].
    strongest_speed : Where the whirl is largest [rad/s].
    frequency : Of the whirl there [rad/s].
    amplitude : Its major half axis there [m].
    """

    first_speed: float
    last_speed: float
    strongest_speed: float
    frequency: float
    amplitude: float


@dataclass(frozen=True)
class OrbitAnalysis:
    """Measures of an orbit: size, frequencies, direction, clearance.

    recognition : None where the speed varies.
    growth : Of small motions at the start; None where there are too few of them.
    amplitude : Half the largest extent along x or y, of the steady part where there is one [m].
    whirl : Of a steady whirl, at its own frequency.
    synchronous : Of the steady part, at the shaft's frequency; None where there is none.
    min_film, min_film_time : Smallest film thickness and when [m, s].
    whirl_range : In a run through the speeds.
    """

    recognition: Recognition | None
    growth: Growth | None
    amplitude: float
    whirl: Ellipse | None
    synchronous: Ellipse | None
    min_film: float
    min_film_time: float
    whirl_range: _WhirlRange | None


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
        growth=_initial_growth(orbit) if orbit.constant_speed else None,
        amplitude=0.5 * float(max(np.ptp(steady.x), np.ptp(steady.y))),
        whirl=whirl,
        synchronous=synchronous,
        min_film=float(orbit.min_film[least]),
        min_film_time=float(orbit.t[least]),
        whirl_range=None if orbit.constant_speed else _whirl_range(orbit),
    )


def _initial_growth(orbit: Orbit) -> Growth | None:
    """Return the growth of the small motions with which a run begins, at constant speed.

    Linear coefficients know no large motions: the whole run counts. With a nonlinear film only the
    part counts that stays within `_SMALL_MOTION` of the equilibrium, and only without unbalance and
    loads.
    """
    part = orbit
    if orbit.force_model != "linear":
        if orbit.forced:
            return None  # what is forced cannot be told from what is free
        away = np.hypot(orbit.x - orbit.equilibrium[0], orbit.y - orbit.equilibrium[1])
        # A run that begins right at the limit counts, whatever the rounding of its equilibrium.
        large = np.flatnonzero(away > (1.0 + 1e-6) * _SMALL_MOTION * orbit.radial_clearance)
        part = orbit.part(0, int(large[0]) if large.size else None)
        if part.t.size < _GROWTH_REVOLUTIONS * orbit.samples_per_revolution:
            return None
    try:
        return growth_rate(part)
    except InputError:  # ended too early to measure anything
        return None


def steady_spectrum(orbit: Orbit) -> Spectrum | None:
    """Return spectrum of a run at constant speed.

    Of its steady part, of all of it where it has none.

    None for a run that comes to rest, through the speeds, or too short for a spectrum.
    """
    if not orbit.constant_speed or orbit.status is OrbitStatus.SETTLED or not orbit.t.size:
        return None
    try:
        return spectrum(steady_part(orbit) or orbit)
    except InputError:
        return None


def speed_cascade(orbit: Orbit) -> Cascade | None:
    """Return cascade of a run through the speeds.

    None at constant speed, or where it is too short.
    """
    if orbit.constant_speed or not orbit.t.size:
        return None
    short, long = _CASCADE_BLOCKS
    turns = abs(float(orbit.revolutions[-1] - orbit.revolutions[0]))
    try:
        rows = cascade(orbit, long if turns >= 10 * long else short)
    except InputError:
        return None
    return rows if np.ptp(rows.speed) > 0.0 else None


def _whirl_range(orbit: Orbit) -> _WhirlRange | None:
    """Return where a run through the speeds whirls; None where it nowhere does, or is too short."""
    try:
        rows = cascade(orbit, _CASCADE_REVOLUTIONS)
    except InputError:
        return None
    below = _subsynchronous(rows)
    amplitude = below.max(axis=1)
    whirls = np.flatnonzero(amplitude > WHIRLING * orbit.radial_clearance)
    if not whirls.size:
        return None
    top = int(np.argmax(amplitude))
    line = int(np.argmax(below[top]))
    return _WhirlRange(
        first_speed=float(rows.speed[whirls[0]]),
        last_speed=float(rows.speed[whirls[-1]]),
        strongest_speed=float(rows.speed[top]),
        frequency=float(rows.frequency[top, line]),
        amplitude=float(amplitude[top]),
    )


def _subsynchronous(rows: Cascade) -> np.ndarray:
    """Return the amplitudes of a cascade with all but the orders of whirl set to zero."""
    low, high = _SUBSYNCHRONOUS
    return np.where((rows.order > low) & (rows.order < high), rows.amplitude, 0.0)


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
    synchronous: Booleans


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
    """Return exp(lambda dt) of everything significant in the signals (s, n)."""
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
    """Return the least-squares amplitudes (k, 2) at the start, and the modes' energies (k,)."""
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
    """Return the growth rate and frequency of the strongest free motion; None where there is none.

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
