"""Loads on a rotor besides film and unbalance, each given in the load frame."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

from ..errors import InputError
from .entries import Duration, Example, Frequency, Instant, Key, Leaf, Pair, Quantity, check, choice

_Force = Annotated[float, Quantity("force", "500 N", "any")]
Forces = Annotated[tuple[_Force, _Force], Example(["500 N", "0 N"])]
_Phase = Annotated[float, Quantity("angle", "90 deg", "any")]
Phases = tuple[_Phase, _Phase]
_Acceleration = Annotated[float, Quantity("acceleration", "10 m/s^2", "any")]


class _Place(StrEnum):
    """Places of a load on a rotor of one disc, in the order of its nodes."""

    JOURNAL = "journal"
    DISC = "disc"


class _PlaceEntry(Leaf):
    """A place by its name."""

    def read(self, value: object) -> int:
        return list(_Place).index(choice(_Place, value))


_Node = Annotated[int, Key("on"), _PlaceEntry()]


def _check_times(load: StepForce | HarmonicForce | BaseMotion) -> None:
    check(load)
    if load.stop <= load.start:
        raise InputError("must be after start", key="stop")


@dataclass(frozen=True)
class StepForce:
    """A force (fx, fy) [N] on a node from `start` until `stop` [s]."""

    force: Forces
    start: Instant = 0.0
    stop: Duration = math.inf
    node: _Node = 0

    def __post_init__(self) -> None:
        _check_times(self)


@dataclass(frozen=True)
class HarmonicForce:
    """A force fx cos(W t + px), fy cos(W t + py): forces [N], frequency W [rad/s], phases [rad]."""

    force: Forces
    frequency: Frequency
    phase: Phases = (0.0, 0.0)
    start: Instant = 0.0
    stop: Duration = math.inf
    node: _Node = 0

    def __post_init__(self) -> None:
        _check_times(self)


@dataclass(frozen=True)
class BaseMotion:
    """Harmonic motion of the bearing housing: displacement ax cos(W t + px), ay cos(W t + py).

    The orbit's coordinates stay those of the journal in its bearing; the rotor is loaded with
    minus its mass times the base's acceleration.

    displacement : Amplitudes [m].
    frequency : [rad/s]
    phase : [rad]
    """

    displacement: Annotated[Pair, Example(["10 um", "0 um"])]
    frequency: Frequency
    phase: Phases = (0.0, 0.0)
    start: Instant = 0.0
    stop: Duration = math.inf

    def __post_init__(self) -> None:
        _check_times(self)


@dataclass(frozen=True)
class BaseShock:
    """One half-sine pulse of base acceleration (ax, ay) [m/s2], `duration` long [s]."""

    acceleration: Annotated[tuple[_Acceleration, _Acceleration], Example(["10 m/s^2", "0 m/s^2"])]
    duration: Annotated[Duration, Example("11 ms")]
    start: Instant = 0.0

    def __post_init__(self) -> None:
        check(self)


Load = StepForce | HarmonicForce | BaseMotion | BaseShock
