"""What acts on a rotor besides film and unbalance, each given in the load frame."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class StepForce:
    """A force (fx, fy) [N] on a node from `start` until `stop` [s]."""

    force: tuple[float, float]
    start: float = 0.0
    stop: float = math.inf
    node: int = 0


@dataclass(frozen=True)
class HarmonicForce:
    """A force fx cos(W t + px), fy cos(W t + py): forces [N], frequency W [rad/s], phases [rad]."""

    force: tuple[float, float]
    frequency: float
    phase: tuple[float, float] = (0.0, 0.0)
    start: float = 0.0
    stop: float = math.inf
    node: int = 0


@dataclass(frozen=True)
class BaseMotion:
    """Harmonic motion of the bearing housing: displacement ax cos(W t + px), ay cos(W t + py).

    The orbit's coordinates stay those of the journal in its bearing; the rotor is loaded with
    minus its mass times the base's acceleration.

    Parameters
    ----------
    displacement : tuple of float
        Amplitudes [m].
    frequency : float
        [rad/s]
    phase : tuple of float
        [rad]
    """

    displacement: tuple[float, float]
    frequency: float
    phase: tuple[float, float] = (0.0, 0.0)
    start: float = 0.0
    stop: float = math.inf


@dataclass(frozen=True)
class BaseShock:
    """One half-sine pulse of base acceleration (ax, ay) [m/s2], `duration` long [s]."""

    acceleration: tuple[float, float]
    duration: float
    start: float = 0.0


Load = StepForce | HarmonicForce | BaseMotion | BaseShock
