"""Equilibrium of the journal: position under a load, or attitude at an eccentricity ratio.

The linearised film is the Jacobian of the force, so position and temperature are found in one loop
(`solve_thermal_film`'s `move`). A plain bearing needs only the eccentricity ratio, sought in
xi = ln(eps/(1 - eps)), in which the logarithm of the load is nearly a straight line.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from .geometry import FilmGeometry
from .linearization import stiffness_matrix
from .problem import FilmProblem, FilmState

ECCENTRICITY_LIMITS = (1e-5, 0.9995)
"""Eccentricity ratios between which an equilibrium is sought."""
CLEARANCE_KEPT = 5e-4
"""Thinnest film, relative to the clearance, to which a step may take a journal."""
_SHORTEST_STEP = 1e-4
"""Part of a step below which none helps."""
_SAME_FORCE = 2e-3
"""Relative change of the forces up to which Newton's method keeps the stiffness."""


@dataclass
class PlainSearch:
    """Eccentricity ratio at which a plain film carries `load` [N]; positions along x."""

    load: float
    clearance: float
    unreachable: bool = False

    def __call__(self, state: FilmState) -> tuple[Array, float]:
        """Return Newton's next position, and how far the force is off, relative to the load."""
        eps = float(state.displacement[0]) / self.clearance
        xi = math.log(eps / (1.0 - eps))
        carried = float(np.hypot(*state.force))
        if not carried > 0.0:
            self.unreachable = eps >= ECCENTRICITY_LIMITS[1] * (1.0 - 1e-9)
            return self._at(xi + 1.0), 1.0
        stiffness = stiffness_matrix(state)
        # dW/de from dF = -K de and W = |F|
        growth = -float(state.force @ stiffness[:, 0]) / carried
        slope = max(growth * self.clearance * eps * (1.0 - eps) / carried, 0.3)
        off = carried / self.load - 1.0
        lowest, highest = ECCENTRICITY_LIMITS
        step = -math.log(carried / self.load) / slope
        # A film heated before it begins carries some load even around a centred journal.
        too_heavy = eps >= highest * (1.0 - 1e-9) and off < 0.0
        too_light = eps <= lowest * (1.0 + 1e-9) and off > 0.0
        self.unreachable = too_heavy or too_light
        return self._at(xi + max(-2.0, min(2.0, step))), abs(off)

    def allowed(self, old: Array, new: Array) -> Array:
        """Keep a mixed step within the clearance and near the old position."""
        lowest, highest = ECCENTRICITY_LIMITS
        left = self.clearance - float(old[0])
        size = min(max(float(new[0]), 0.5 * float(old[0])), self.clearance - 0.4 * left)
        size = min(max(size, lowest * self.clearance), highest * self.clearance)
        return np.array([size, 0.0])

    def grown(self, problem: FilmProblem) -> None:
        """Take over the clearance of `problem`."""
        self.clearance = problem.bearing.radial_clearance

    def _at(self, xi: float) -> Array:
        lowest, highest = ECCENTRICITY_LIMITS
        eps = min(max(1.0 / (1.0 + math.exp(-xi)), lowest), highest)
        return np.array([self.clearance * eps, 0.0])


@dataclass
class LoadSearch:
    """Displacements at which any film carries the generalised forces `load`: damped Newton."""

    load: Array
    """Forces on the displacements, (q,) [N]."""
    clearance: float
    geometry: FilmGeometry
    unreachable: bool = False
    _known: tuple[FilmState, Array] | None = None

    def __call__(self, state: FilmState) -> tuple[Array, float]:
        """Return Newton's next displacements, and the force's error over the load."""
        scales = self.geometry.displacements.scales / self.clearance
        missing = (state.force + self.load) * scales
        size = math.hypot(*(self.load * scales)) or pressure_force(state)
        off = math.hypot(*missing) / size
        stiffness = self._stiffness(state) * scales[:, None] * scales[None, :]
        step = scales * _newton_step(stiffness, missing, self.clearance)
        following = self.allowed(state.displacement, state.displacement + step)
        pinned = state.min_thickness <= 2.0 * CLEARANCE_KEPT * self.clearance
        self.unreachable = pinned and off > 1e-3
        return following, off

    def allowed(self, old: Array, new: Array) -> Array:
        """Shorten a step that goes too far.

        At most a fifth of the clearance, and never more than 0.6 of the film that is left.
        """
        step = new - old
        scales = self.geometry.displacements.scales / self.clearance
        length = math.hypot(*(step / scales))
        if length == 0.0:
            return new
        scale = min(1.0, 0.2 * self.clearance / length)
        floor = max(0.4 * self.geometry.thinnest_at(old), CLEARANCE_KEPT * self.clearance)
        while scale > 1e-4 and self.geometry.thinnest_at(old + scale * step) < floor:
            scale *= 0.7
        if scale <= 1e-4:
            return old
        return new if scale == 1.0 else old + scale * step

    def _stiffness(self, state: FilmState) -> Array:
        """Return the film's stiffness; that of the last film whose forces were nearly the same."""
        if self._known is not None and self._known[0].problem is state.problem:
            change = np.abs(state.force - self._known[0].force)
            if change.max() < _SAME_FORCE * np.abs(state.force).max():
                return self._known[1]
        self._known = state, stiffness_matrix(state)
        return self._known[1]

    def grown(self, problem: FilmProblem) -> None:
        """Take over the clearance of `problem`."""
        self.clearance, self.geometry = problem.bearing.radial_clearance, problem.geometry


@dataclass
class FixedRatio:
    """Holds the journal of a plain film at an eccentricity ratio while the clearance changes."""

    eccentricity_ratio: float
    clearance: float
    unreachable: bool = False

    def __call__(self, state: FilmState) -> tuple[Array, float]:
        """Return that position."""
        del state
        return np.array([self.eccentricity_ratio * self.clearance, 0.0]), 0.0

    def allowed(self, _old: Array, _new: Array, /) -> Array:
        """Return that position."""
        return np.array([self.eccentricity_ratio * self.clearance, 0.0])

    def grown(self, problem: FilmProblem) -> None:
        """Take over the clearance of `problem`."""
        self.clearance = problem.bearing.radial_clearance


@dataclass
class Backtracking:
    """Shortens steps until the residual falls: Newton's method may circle at kinks of the force."""

    _best: float = math.inf
    _start: Array | None = None
    _target: Array | None = None
    _share: float = 1.0

    def __call__(self, old: Array, off: float, new: Array) -> Array | None:
        """Return where to go on from; None where no part of the best step reduces the residual."""
        if self._start is None or self._target is None or off < self._best:
            self._best, self._start, self._target, self._share = off, old, new, 1.0
            return new
        self._share *= 0.5
        if self._share < _SHORTEST_STEP:
            return None
        return self._start + self._share * (self._target - self._start)


@dataclass
class AttitudeSearch:
    """Attitude at a given eccentricity ratio: the film carries a load along a given line."""

    eccentricity_ratio: float
    clearance: float
    load_angle: float
    """Direction of the load in the film frame [rad]."""
    unreachable: bool = False
    _last: tuple[float, float] | None = None

    def __call__(self, state: FilmState) -> tuple[Array, float]:
        """Return Newton's next position, and the share of the force across the load line."""
        angle = math.atan2(state.displacement[1], state.displacement[0])
        size = float(np.hypot(*state.force))
        if not size > 0.0:
            return self.at(angle - 0.2), 1.0
        stiffness = stiffness_matrix(state)
        along = (
            self.eccentricity_ratio * self.clearance * np.array([-math.sin(angle), math.cos(angle)])
        )
        turn = -stiffness @ along  # dF/d(angle)
        carried = math.atan2(-state.force[1], -state.force[0])
        direction = math.remainder(carried - self.load_angle, 2.0 * math.pi)
        rate = (state.force[0] * turn[1] - state.force[1] * turn[0]) / size**2
        step = -direction / rate if abs(rate) > 1e-3 else -direction
        step = max(-0.4, min(0.4, step))
        if self._last is not None and direction * self._last[1] < 0.0:
            # The root lies between: a step that leads back to where it came from is cut short.
            back = self._last[0] - angle
            if step * back > 0.0 and abs(step) > 0.7 * abs(back):
                step = back * direction / (direction - self._last[1])
        self._last = (angle, direction)
        return self.at(angle + step), abs(direction)

    def allowed(self, _old: Array, new: Array, /) -> Array:
        """Stay at the given eccentricity."""
        return self.at(math.atan2(new[1], new[0]))

    def at(self, angle: float) -> Array:
        """Return the position at an attitude angle [rad]."""
        size = self.eccentricity_ratio * self.clearance
        return size * np.array([math.cos(angle), math.sin(angle)])

    def grown(self, problem: FilmProblem) -> None:
        """Take over the clearance of `problem`."""
        self.clearance = problem.bearing.radial_clearance


def pressure_force(state: FilmState) -> float:
    """Return the integral of |p| over the film [N]: the scale of forces where there is no load."""
    pressures = np.abs(state.solution.pressure) * state.operator.area
    return state.problem.geometry.multiplicity * float(np.sum(pressures)) or 1.0


def _newton_step(stiffness: Array, missing: Array, clearance: float) -> Array:
    """Return the step that makes up for the `missing` force; dF = -K dx."""
    try:
        step = np.linalg.solve(stiffness, missing)
    except np.linalg.LinAlgError:
        step = missing / max(float(np.abs(stiffness).max()), 1e-300)
    if not np.all(np.isfinite(step)):
        step = np.zeros_like(missing)
        step[0] = 0.1 * clearance
    return np.asarray(step, dtype=float)
