"""Eigenvalues and shapes of a machine, over speed as continuous branches."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from .machine import Machine
from .matrices import eigenvalues_with_accuracy

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
MatrixOf = Callable[[float], Array]

FORWARD = 0.1
"""Ratio of areas, orbit to circle, above which a whirl counts as forward (or backward)."""
CRITICAL_DAMPING = 0.5**0.5
"""Damping ratio from which an unbalance response has no peak: no critical speed."""
_MOVING = 0.05
"""Share of the largest motion from which a node counts for the sense of whirl."""
_SAME_VALUE = 1e-6
"""Relative distance of eigenvalues that count as one multiple eigenvalue."""
_SMOOTH_MAC = 0.9
_SMOOTH_CHANGE = 0.1


class Verdict(StrEnum):
    """Stability of a machine at one speed."""

    STABLE = "stable"
    UNSTABLE = "unstable"
    UNDAMPED = "undamped"
    """No mode's real part is above its own accuracy: nothing damps or drives the machine."""


@dataclass(frozen=True, eq=False)
class Modes:
    """Eigenvalues of A(parameter), each column one continuous branch.

    Attributes
    ----------
    parameter : (n,) array
        Shaft speed [rad/s] unless said otherwise.
    eigenvalues : (n, k) complex array
        [rad/s]
    accuracy : (n, k) array
        Estimated bound of each eigenvalue's error [rad/s].
    shapes : (n, k, m) complex array
        Displacements of each mode, of unit length.
    smooth : (n,) bool array
        False where the step from the point before stayed abrupt at the finest refinement (a
        pair of real eigenvalues met there, say): the labels may have been exchanged.
    planes : tuple of (int, int)
        Unknowns x, y of the nodes.
    """

    parameter: Array
    eigenvalues: ComplexArray
    accuracy: Array
    shapes: ComplexArray
    smooth: NDArray[np.bool_]
    planes: tuple[tuple[int, int], ...] = ((0, 1),)

    @property
    def growth_rate(self) -> Array:
        """Re lambda [1/s], above 0 where the mode grows."""
        return self.eigenvalues.real

    @property
    def undamped(self) -> NDArray[np.bool_]:
        """Whether the real part is below its own accuracy: the mode neither grows nor decays."""
        return np.abs(self.eigenvalues.real) <= self.accuracy

    @property
    def largest_growth_rate(self) -> Array:
        """Growth rate of the least stable mode, those without damping left out, (n,) [1/s].

        0 where there are only such; NaN where the eigenvalues are not known.
        """
        damped = np.where(self.undamped, -np.inf, self.eigenvalues.real)
        largest = damped.max(axis=-1, initial=-np.inf)
        return np.where(np.isneginf(largest), 0.0, largest)

    @property
    def least_stable(self) -> NDArray[np.intp]:
        """Branch of largest growth rate, those without damping left out, (n,)."""
        return np.where(self.undamped, -np.inf, self.eigenvalues.real).argmax(axis=-1)

    @property
    def verdicts(self) -> tuple[Verdict, ...]:
        """Of each parameter; see `Verdict`."""
        names = {1.0: Verdict.UNSTABLE, -1.0: Verdict.STABLE, 0.0: Verdict.UNDAMPED}
        return tuple(names[float(sign)] for sign in np.sign(self.largest_growth_rate))

    @property
    def damped_frequency(self) -> Array:
        """|Im lambda| [rad/s]."""
        return np.abs(self.eigenvalues.imag)

    @property
    def undamped_frequency(self) -> Array:
        """|lambda| [rad/s]."""
        return np.abs(self.eigenvalues)

    @property
    def damping_ratio(self) -> Array:
        """-Re lambda/|lambda|."""
        size = np.abs(self.eigenvalues)
        return np.divide(-self.eigenvalues.real, size, out=np.zeros_like(size), where=size > 0.0)

    @property
    def logarithmic_decrement(self) -> Array:
        """-2 pi Re lambda/|Im lambda|; NaN for a mode that does not oscillate."""
        frequency = self.damped_frequency
        return np.where(
            frequency > 0.0,
            -2.0 * np.pi * self.eigenvalues.real / np.where(frequency > 0.0, frequency, 1.0),
            np.nan,
        )

    def whirl_direction(self, x: int = 0, y: int = 1) -> Array:
        """Sense of the orbit: 1 a forward circle, -1 a backward circle, 0 a straight line.

        Parameters
        ----------
        x, y : int
            The unknowns whose orbit is meant.
        """
        a, b = self.shapes[..., x], self.shapes[..., y]
        area = -2.0 * np.imag(np.conj(a) * b) * np.sign(self.eigenvalues.imag)
        size = np.abs(a) ** 2 + np.abs(b) ** 2
        return np.divide(area, size, out=np.zeros_like(size), where=size > 0.0)

    @property
    def whirl_sense(self) -> Array:
        """`whirl_direction` at the node where each mode moves most, (n, k)."""
        sense, size = self._orbits()
        return np.take_along_axis(sense, size.argmax(axis=-1)[..., None], axis=-1)[..., 0]

    @property
    def whirl(self) -> NDArray[np.str_]:
        """``forward``, ``backward``, ``mixed`` or ``none`` of each mode, (n, k).

        Mixed: forward at some nodes and backward at others, or straight lines. None: a mode that
        does not oscillate, or has no lateral motion.
        """
        sense, size = self._orbits()
        largest = size.max(axis=-1, keepdims=True)
        counts = size > _MOVING * largest
        forward = (counts & (sense > FORWARD)).any(axis=-1)
        backward = (counts & (sense < -FORWARD)).any(axis=-1)
        words = np.full(forward.shape, "mixed", dtype="U8")
        words[forward & ~backward] = "forward"
        words[backward & ~forward] = "backward"
        lateral = largest[..., 0] > 1e-6
        words[~lateral | (self.eigenvalues.imag == 0.0)] = "none"
        return words

    def _orbits(self) -> tuple[Array, Array]:
        """Sense and size of the motion of every node, (n, k, n_nodes)."""
        sense = np.stack([self.whirl_direction(x, y) for x, y in self.planes], axis=-1)
        size = [np.hypot(*np.abs(self.shapes[..., [x, y]]).T).T for x, y in self.planes]
        return sense, np.stack(size, axis=-1)

    def columns(self, keep: ArrayLike) -> Modes:
        """Some of the branches."""
        index = np.asarray(keep)
        return replace(
            self,
            eigenvalues=self.eigenvalues[:, index],
            accuracy=self.accuracy[:, index],
            shapes=self.shapes[:, index],
        )

    def lowest(self, count: int) -> Modes:
        """Keep `count` branches, those that reach the lowest frequencies."""
        return self.columns(
            np.sort(np.argsort(self.damped_frequency.min(axis=0), kind="stable")[:count])
        )

    def oscillating(self) -> Modes:
        """Keep one branch of each conjugate pair (Im >= 0 on the whole), as a Campbell diagram.

        A frequency below its own accuracy, a free direction's, is none.
        """
        imaginary = self.eigenvalues.imag
        swings = (imaginary - self.accuracy).max(axis=0) > 0.0
        return self.columns(np.flatnonzero((imaginary.sum(axis=0) >= 0.0) & swings))


def modes(machine: Machine, speed: ArrayLike | None = None) -> Modes:
    """Modes of a machine over speed, as continuous branches.

    Parameters
    ----------
    machine : Machine
    speed : float or (n,) array, optional
        Ascending [rad/s]; by default the longest run of tabulated speeds with coefficients.

    Returns
    -------
    Modes
        Its `parameter` is the speed. At one speed the branches ascend in undamped frequency.
    """
    speeds = known_speeds(machine) if speed is None else np.atleast_1d(np.asarray(speed, float))
    if not speeds.size:
        raise InputError("no point of the table converged", key="speed")
    found = track_modes(machine.state_matrix, speeds, unknowns=machine.size)
    planes = machine.rotor.planes
    if speeds.size == 1:
        found = found.columns(np.lexsort((-found.eigenvalues[0].imag, found.undamped_frequency[0])))
    return replace(found, planes=planes)


def known_speeds(machine: Machine) -> Array:
    """Longest run of tabulated speeds [rad/s] at which all supports have coefficients."""
    speeds = machine.speeds
    if not speeds.size:
        return speeds
    known = np.isfinite(machine.matrices(speeds)[2]).all(axis=(-2, -1))
    edges = np.flatnonzero(np.diff(np.concatenate([[0], known.astype(int), [0]])))
    runs = edges.reshape(-1, 2)
    if not runs.size:
        return np.zeros(0)
    start, stop = runs[np.argmax(runs[:, 1] - runs[:, 0])]
    return speeds[start:stop]


def spectrum(machine: Machine, speeds: Array) -> tuple[ComplexArray, Array]:
    """Eigenvalues and their accuracy (n, k) at speeds (n,), in no particular order.

    NaN where a support has no coefficients.
    """
    matrices = machine.state_matrix(speeds)
    values = np.full(matrices.shape[:-1], np.nan, dtype=complex)
    accuracy = np.full(values.shape, np.nan)
    for i in np.flatnonzero(np.isfinite(matrices).all(axis=(-2, -1))):
        values[i], _, accuracy[i] = eigenvalues_with_accuracy(matrices[i])
    return values, accuracy


def track_modes(
    matrix: MatrixOf, parameter: ArrayLike, refinements: int = 10, unknowns: int | None = None
) -> Modes:
    """Follow the eigenvalues of a state matrix over a parameter.

    Parameters
    ----------
    matrix : callable
        Parameter to state matrix on displacements, then velocities.
    parameter : (n,) array
        Ascending; the result is given at these values.
    refinements : int
        How often a step may be halved until neighbouring modes are alike.
    unknowns : int, optional
        Number of displacements; by default half the states.

    Returns
    -------
    Modes
        First column: the mode least stable at the first value.

    Raises
    ------
    InputError
        The parameter does not ascend.

    Notes
    -----
    Modes at neighbouring values are paired by an optimal assignment (Jonker and Volgenant) on the
    change of eigenvalue plus 1 - MAC, the modal assurance criterion of the displacements. Sorting
    by frequency exchanges modes that cross; this does not. A step is accepted when every pair has
    MAC > 0.9 and changes by less than a tenth, otherwise halved.
    """
    values = np.atleast_1d(np.asarray(parameter, dtype=float))
    if values.ndim != 1 or not np.all(np.isfinite(values)) or np.any(np.diff(values) <= 0.0):
        raise InputError("must be finite and ascend", key="parameter", value=parameter)
    at = _Spectrum(matrix, unknowns)
    first = at(float(values[0]))
    order = np.lexsort((-first.values.imag, -np.round(first.values.real, 9)))
    rows = [first.taken(order)]
    smooth = [True]
    for low, high in pairwise(values):
        state, good = _advance(at, float(low), rows[-1], float(high), refinements)
        rows.append(state)
        smooth.append(good)
    return Modes(
        values,
        np.array([r.values for r in rows]),
        np.array([r.accuracy for r in rows]),
        np.array([r.shapes for r in rows]),
        np.array(smooth),
    )


@dataclass(frozen=True, eq=False)
class _State:
    """Modes at one parameter: eigenvalues (k,), their accuracy (k,), shapes (k, m)."""

    values: ComplexArray
    accuracy: Array
    shapes: ComplexArray

    def taken(self, order: NDArray[np.intp]) -> _State:
        return _State(self.values[order], self.accuracy[order], self.shapes[order])


@dataclass(frozen=True)
class _Spectrum:
    """Modes of a state matrix at any parameter."""

    matrix: MatrixOf
    unknowns: int | None

    def __call__(self, parameter: float) -> _State:
        a = self.matrix(parameter)
        values, vectors, accuracy = eigenvalues_with_accuracy(a)
        count = a.shape[0] // 2 if self.unknowns is None else self.unknowns
        shapes = vectors[:count].T
        length = np.linalg.norm(shapes, axis=1, keepdims=True)
        return _State(values, accuracy, shapes / np.where(length > 0.0, length, 1.0))

    def leading(self, parameter: float) -> complex:
        """Eigenvalue of largest real part of the damped modes; 0 without any, NaN if unknown."""
        a = self.matrix(parameter)
        if not np.all(np.isfinite(a)):
            return complex(np.nan, np.nan)
        values, _, accuracy = eigenvalues_with_accuracy(a)
        values = values[np.abs(values.real) > accuracy]
        return complex(values[values.real.argmax()]) if values.size else 0j


def _advance(
    at: _Spectrum, low: float, state: _State, high: float, depth: int
) -> tuple[_State, bool]:
    """Carry the labels from `low` to `high`, halving the step while modes change too much."""
    new = at(high)
    order, mac, change = _pair(state, new)
    good = bool(mac.min() > _SMOOTH_MAC and change.max() < _SMOOTH_CHANGE)
    if good or depth == 0:
        return new.taken(order), good
    middle = 0.5 * (low + high)
    half, first = _advance(at, low, state, middle, depth - 1)
    end, second = _advance(at, middle, half, high, depth - 1)
    return end, first and second


def _pair(old: _State, new: _State) -> tuple[NDArray[np.intp], Array, Array]:
    from scipy.optimize import linear_sum_assignment

    mac = np.abs(old.shapes.conj() @ new.shapes.T) ** 2
    size = np.abs(old.values)[:, None] + np.abs(new.values)[None, :]
    size = np.maximum(size, old.accuracy[:, None] + new.accuracy[None, :])
    change = 2.0 * np.abs(old.values[:, None] - new.values[None, :])
    change = change / np.where(size > 0.0, size, 1.0)
    row, column = linear_sum_assignment(change + 1.0 - mac)
    alike = np.array([_likeness(old, i, new.shapes[j]) for i, j in zip(row, column, strict=True)])
    return column, np.maximum(mac[row, column], alike), change[row, column]


def _likeness(old: _State, i: int, shape: ComplexArray) -> float:
    """MAC of a shape and the space of the modes that share eigenvalue i.

    The shapes of a multiple eigenvalue (a free rotor, an isotropic one at rest) are any basis.
    """
    near = _SAME_VALUE * abs(old.values[i]) + old.accuracy[i]
    cluster = np.flatnonzero(np.abs(old.values - old.values[i]) <= near)
    if cluster.size == 1:
        return 0.0
    basis = np.linalg.qr(old.shapes[cluster].T)[0]
    return float(np.sum(np.abs(basis.conj().T @ shape) ** 2))


@dataclass(frozen=True)
class ThresholdSpeed:
    """Where the machine changes its verdict.

    Attributes
    ----------
    speed : float
        [rad/s]
    whirl_frequency : float
        Of the mode that crosses [rad/s]; 0 for a static divergence.
    whirl_frequency_ratio : float
    becomes_unstable : bool
        With rising speed; False: it becomes stable.
    """

    speed: float
    whirl_frequency: float
    whirl_frequency_ratio: float
    becomes_unstable: bool


def find_thresholds(matrix: MatrixOf, speeds: Sequence[float] | Array) -> list[ThresholdSpeed]:
    """Speeds at which the least stable eigenvalue crosses the imaginary axis.

    Parameters
    ----------
    matrix : callable
        Speed [rad/s] to state matrix; one with NaN marks a speed without coefficients.
    speeds : sequence of float
        Ascending; one crossing is found between two neighbours whose verdicts differ.

    Returns
    -------
    list of ThresholdSpeed
        Ascending, speed to a relative 1e-13 or as far as the eigenvalues are accurate. Empty: one
        verdict everywhere.

    Notes
    -----
    Modes whose real part is below their own accuracy are neither stable nor unstable, and count
    nowhere.
    """
    from scipy.optimize import brentq

    spectrum = _Spectrum(matrix, None)

    def rate(omega: float) -> float:
        return spectrum.leading(omega).real

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
    spectrum: _Spectrum, root: float, interval: tuple[float, float], rising: bool
) -> ThresholdSpeed:
    """Threshold near `root`, which the band of undamped modes may have shifted a little."""
    from scipy.optimize import brentq

    side = 1.0 if rising else -1.0
    distances = abs(root) * np.geomspace(1e-12, 1e-3, 10)
    ends = [np.clip([root - d, root + d], *interval) for d in distances]
    outer = (spectrum.leading(float(end[1] if rising else end[0])) for end in ends)
    crossing = next((value for value in outer if value.real > 0.0), 0j)

    def nearest(omega: float) -> complex:
        values = spectrum(omega).values
        return complex(values[np.abs(values - crossing).argmin()])

    for low, high in ends:
        if side * nearest(low).real < 0.0 < side * nearest(high).real:
            tolerance: dict[str, Any] = {"xtol": 1e-14 * root, "rtol": 1e-14}
            found: Any = brentq(lambda s: nearest(s).real, low, high, **tolerance)
            root = float(found)
            break
    whirl = abs(nearest(root).imag)
    return ThresholdSpeed(root, whirl, whirl / root, rising)


def threshold_speeds(machine: Machine, subdivisions: int = 8) -> list[ThresholdSpeed]:
    """Threshold speeds of a machine on its supports' interpolated tables.

    Parameters
    ----------
    machine : Machine
    subdivisions : int
        Points looked at in every interval of the tables.
    """
    return find_thresholds(machine.state_matrix, subdivided(machine.speeds, subdivisions))


def subdivided(knots: Array, parts: int) -> Array:
    """Every interval between ascending knots cut into `parts`."""
    if not knots.size:
        return knots
    cut = np.arange(parts) / parts
    return np.append((knots[:-1, None] + np.diff(knots)[:, None] * cut).ravel(), knots[-1])


@dataclass(frozen=True)
class CriticalSpeed:
    """Where a damped natural frequency equals the shaft speed.

    Attributes
    ----------
    speed : float
        [rad/s]
    whirl : str
        ``forward``, ``backward`` or ``mixed``.
    damping_ratio : float
    branch : int
        Of the modes that were searched.
    """

    speed: float
    whirl: str
    damping_ratio: float
    branch: int


def critical_speeds(
    machine: Machine, found: Modes | None = None, order: float = 1.0
) -> list[CriticalSpeed]:
    """Speeds at which a mode's damped frequency is `order` times the speed, ascending.

    Parameters
    ----------
    machine : Machine
    found : Modes, optional
        Of this machine over speed, as dense as branches should be followed.
    order : float

    Notes
    -----
    One of each conjugate pair; modes so much damped (ratio above 0.707) that an unbalance response
    has no peak are left out. Crossings are refined to 1e-10 on the supports' interpolated tables.
    """
    branches = (modes(machine) if found is None else found).oscillating()
    at = _Spectrum(machine.state_matrix, machine.size)
    result = []
    offset = branches.damped_frequency - order * branches.parameter[:, None]
    for i, k in np.argwhere(offset[:-1] * offset[1:] <= 0.0):
        if offset[i + 1, k] == 0.0 and i + 2 < offset.shape[0]:
            continue  # counted as the beginning of the next interval
        crossing = _refined_crossing(at, branches, int(i), int(k), order)
        if 0.0 <= crossing.damping_ratio[0, 0] < CRITICAL_DAMPING or crossing.growth_rate[0, 0] > 0:
            one = replace(crossing, planes=machine.rotor.planes)
            speed, ratio = float(one.parameter[0]), float(one.damping_ratio[0, 0])
            result.append(CriticalSpeed(speed, str(one.whirl[0, 0]), ratio, int(k)))
    return sorted(result, key=lambda one: one.speed)


def _refined_crossing(at: _Spectrum, branches: Modes, i: int, k: int, order: float) -> Modes:
    """Mode at the speed between points i and i + 1 where branch k crosses."""
    from scipy.optimize import brentq

    low, high = (float(s) for s in branches.parameter[i : i + 2])
    ends = branches.eigenvalues[[i, i + 1], k], branches.shapes[[i, i + 1], k]

    def mode(speed: float) -> _State:
        """That mode between the two points: nearest in eigenvalue and shape."""
        t = (speed - low) / (high - low)
        state = at(speed)
        value = ends[0][0] + t * (ends[0][1] - ends[0][0])
        mac = np.abs(state.shapes.conj() @ ends[1].T) ** 2 @ np.array([1.0 - t, t])
        cost = np.abs(state.values - value) / abs(value) + 1.0 - mac
        return state.taken(np.array([cost.argmin()]))

    tolerance: dict[str, Any] = {"xtol": 1e-12 * high, "rtol": 1e-12}
    root: Any = brentq(lambda s: abs(mode(s).values[0].imag) - order * s, low, high, **tolerance)
    one = mode(float(root))
    return Modes(
        np.array([float(root)]), one.values[None], one.accuracy[None], one.shapes[None],
        np.array([True]),
    )  # fmt: skip
