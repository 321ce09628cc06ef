"""Shaft speed over time: straight pieces, the angle integrated exactly."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SpeedSchedule:
    """Speed as straight pieces between knots.

    Parameters
    ----------
    times : tuple of float
        Knots [s], ascending, the first is 0; the last is the end of the run.
    speeds : tuple of float
        At the knots [rad/s], none negative.

    Raises
    ------
    InputError
        Knots out of order, a negative speed, or a piece without rotation.

    Examples
    --------
    >>> schedule = SpeedSchedule.ramp(0.0, 200.0, duration=2.0)
    >>> schedule.speed_at(1.0).item(), schedule.angle_at(2.0).item()
    (100.0, 200.0)
    """

    times: tuple[float, ...]
    speeds: tuple[float, ...]

    def __post_init__(self) -> None:
        knots = np.asarray(self.times, dtype=float)
        speeds = np.asarray(self.speeds, dtype=float)
        if knots.size < 2 or knots.size != speeds.size or knots[0] != 0.0:
            raise InputError(
                "needs two knots or more, one speed for each, the first at 0 s",
                key="orbit.speed",
                value=self.times,
            )
        if not (np.all(np.isfinite(knots)) and np.all(np.diff(knots) > 0.0)):
            raise InputError(
                "the duration must be finite and above 0", key="orbit.speed", value=self.times
            )
        if not (np.all(np.isfinite(speeds)) and np.all(speeds >= 0.0)):
            raise InputError("must be 0 or more", key="orbit.speed", value=self.speeds)
        if np.any(speeds[1:] + speeds[:-1] <= 0.0):
            raise InputError("the shaft must turn", key="orbit.speed", value=self.speeds)

    @classmethod
    def constant(cls, speed: float, revolutions: float) -> SpeedSchedule:
        """Hold one speed [rad/s] for a number of revolutions."""
        if not (math.isfinite(speed) and speed > 0.0):
            raise InputError("must be above 0", key="orbit.speed", value=speed)
        if not (math.isfinite(revolutions) and revolutions > 0.0):
            raise InputError("must be above 0", key="orbit.revolutions", value=revolutions)
        return cls((0.0, 2.0 * math.pi * revolutions / speed), (speed, speed))

    @classmethod
    def ramp(cls, start: float, stop: float, duration: float, hold: float = 0.0) -> SpeedSchedule:
        """Run up or coast down from `start` to `stop` [rad/s] in `duration`, then `hold` [s]."""
        if hold > 0.0:
            return cls((0.0, duration, duration + hold), (start, stop, stop))
        return cls((0.0, duration), (start, stop))

    @property
    def duration(self) -> float:
        """End of the run [s]."""
        return self.times[-1]

    @property
    def is_constant(self) -> bool:
        """Whether the speed never changes."""
        return len(set(self.speeds)) == 1

    @property
    def knots(self) -> Array:
        """(k, 4) array: time [s], speed [rad/s], angle [rad], acceleration after it [rad/s2]."""
        times, speeds = np.asarray(self.times), np.asarray(self.speeds)
        steps = np.diff(times)
        angles = np.concatenate([[0.0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * steps)])
        return np.column_stack([times, speeds, angles, np.append(np.diff(speeds) / steps, 0.0)])

    @property
    def revolutions(self) -> float:
        """Revolutions of the shaft over the whole run."""
        return float(self.knots[-1, 2] / (2.0 * math.pi))

    def _piece(self, t: Array) -> Array:
        last = len(self.times) - 2
        index = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, last)
        return self.knots[index]

    def speed_at(self, t: float | Array) -> Array:
        """Speed [rad/s] at time t [s]."""
        piece = self._piece(np.asarray(t, dtype=float))
        return piece[..., 1] + piece[..., 3] * (t - piece[..., 0])

    def angle_at(self, t: float | Array) -> Array:
        """Shaft angle [rad] at time t [s]."""
        piece = self._piece(np.asarray(t, dtype=float))
        since = t - piece[..., 0]
        return piece[..., 2] + since * (piece[..., 1] + 0.5 * piece[..., 3] * since)

    def time_at(self, angle: float | Array) -> Array:
        """Time [s] at which the shaft has turned by `angle` [rad]: the inverse of `angle_at`."""
        angle = np.asarray(angle, dtype=float)
        knots = self.knots
        index = np.searchsorted(knots[:, 2], angle, side="right") - 1
        piece = knots[np.clip(index, 0, len(knots) - 2)]
        turned = angle - piece[..., 2]
        # the stable root of w0 t + a t^2/2 = turned; it holds for a = 0 and for w0 = 0 as well
        root = np.sqrt(np.maximum(piece[..., 1] ** 2 + 2.0 * piece[..., 3] * turned, 0.0))
        total = piece[..., 1] + root
        since = np.divide(2.0 * turned, total, out=np.zeros_like(turned), where=total > 0.0)
        return piece[..., 0] + since
