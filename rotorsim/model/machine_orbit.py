"""A machine in time: its speed, what acts on it, which force its films have."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

from ..errors import InputError
from .entries import (
    Clearance,
    Duration,
    Example,
    Frequency,
    Instant,
    Number,
    Pair,
    Quantity,
    Speed,
    check,
)
from .loads import BaseMotion, BaseShock, Forces, Phases
from .orbit import SpeedRamp
from .shaft import Diameter, Place


class MachineForce(StrEnum):
    """Force of a film of a machine in time."""

    LINEAR = "linear"
    """Stiffness and damping about the static position."""
    FILM = "film"
    """Nonlinear: from its map where one is exact, else solved at each step."""
    MAPPED = "mapped"
    """Nonlinear, from its map; a film that none holds is an error."""
    SHORT = "short"
    """Nonlinear: the short bearing's closed form (Ocvirk), of any plain bearing."""


@dataclass(frozen=True)
class TorqueSettings:
    """A torque that drives the shaft, in place of a prescribed speed.

    start : Speed at the beginning [rad/s].
    torque : [N m]; negative when it brakes.
    duration : [s]
    drag : Retarding torque over the speed [N m s].
    inertia : Polar, of all that turns [kg m^2]; by default the rotor's own.
    """

    start: Annotated[Speed, Example("1000 rpm")]
    torque: Annotated[float, Quantity("torque", "200 N*m", "any")]
    duration: Duration
    drag: Annotated[float, Quantity("rotational damping", "0.1 N*m*s", "not_negative")] = 0.0
    inertia: Annotated[float, Quantity("moment of inertia", "2 kg*m^2")] | None = None

    def __post_init__(self) -> None:
        check(self, "orbit.drive")


@dataclass(frozen=True)
class PlacedStep:
    """A force [N] on the shaft at a place from `start` until `stop` [s]."""

    at: Annotated[Place, Example("400 mm")]
    force: Forces
    start: Instant = 0.0
    stop: Duration = math.inf

    def __post_init__(self) -> None:
        check(self)
        if self.stop <= self.start:
            raise InputError("must be after start", key="stop")


@dataclass(frozen=True)
class PlacedHarmonic:
    """A force fx cos(W t + px), fy cos(W t + py) on the shaft at a place."""

    at: Annotated[Place, Example("400 mm")]
    force: Forces
    frequency: Frequency
    phase: Phases = (0.0, 0.0)
    start: Instant = 0.0
    stop: Duration = math.inf

    def __post_init__(self) -> None:
        PlacedStep.__post_init__(self)  # type: ignore[arg-type]


@dataclass(frozen=True)
class BladeLoss:
    """An unbalance that appears suddenly.

    at : [m]
    amount : Mass times radius [kg m].
    phase : Ahead of the shaft's mark [rad].
    start : [s]
    """

    at: Annotated[Place, Example("620 mm")]
    amount: Annotated[float, Quantity("unbalance", "2000 g*mm", "not_negative")]
    phase: Annotated[float, Quantity("angle", "0 deg", "any")] = 0.0
    start: Instant = 0.0


@dataclass(frozen=True)
class Rub:
    """A stop around the shaft that it may rub on.

    at : [m]
    clearance : Radial [m].
    stiffness, damping : Of the contact [N/m, N s/m].
    friction : Coefficient [-].
    diameter : Of the shaft there [m]; by default the section's.
    """

    at: Annotated[Place, Example("650 mm")]
    clearance: Annotated[Clearance, Example("0.3 mm")]
    stiffness: Annotated[float, Quantity("stiffness", "100 MN/m")]
    damping: Annotated[float, Quantity("damping", "1 kN*s/m", "not_negative")] = 0.0
    friction: Annotated[float, Number(least=0.0, most=2.0)] = 0.1
    diameter: Diameter | None = None


@dataclass(frozen=True)
class MachineOrbit:
    """Settings of a machine's simulation in time.

    speed : [rad/s]; by default the highest of the machine's speeds.
    drive : In place of `speed`.
    revolutions : How long at constant speed (60 by default).
    force : Of every film; a support's own ``force`` goes before it.
    thermal_model : Of the bearings; by default the last that they name.
    gravity, unbalance : Whether they act.
    initial_displacement, initial_velocity : Of the whole rotor from its static position [m, m/s].
    step, harmonic, blade_loss, rub : Any number of each.
    base_motion, base_shock : Or None.
    control : Whether the feedback of ``[control]`` acts.
    modes : Of the rotor between its kept places; by default as many as its eigenvalues need.
    relative_tolerance : Of one step.
    """

    speed: Speed | SpeedRamp | None = None
    drive: TorqueSettings | None = None
    revolutions: Annotated[int, Number(least=1, most=1_000_000)] | None = None
    force: MachineForce = MachineForce.LINEAR
    thermal_model: str | None = None
    gravity: bool = True
    unbalance: bool = True
    initial_displacement: Pair = (0.0, 0.0)
    initial_velocity: tuple[
        Annotated[float, Quantity("velocity", "5 mm/s", "any")],
        Annotated[float, Quantity("velocity", "5 mm/s", "any")],
    ] = (0.0, 0.0)
    step: tuple[PlacedStep, ...] = ()
    harmonic: tuple[PlacedHarmonic, ...] = ()
    blade_loss: tuple[BladeLoss, ...] = ()
    rub: tuple[Rub, ...] = ()
    base_motion: BaseMotion | None = None
    base_shock: BaseShock | None = None
    control: bool = False
    modes: Annotated[int, Number(least=0, most=10_000)] | None = None
    samples_per_revolution: Annotated[int, Number(least=16, most=4096)] = 64
    relative_tolerance: Annotated[float, Number(least=1e-12, most=1e-2)] | None = None

    def __post_init__(self) -> None:
        check(self, "orbit")
        if self.drive is not None and self.speed is not None:
            raise InputError("goes without drive: remove one of them", key="orbit.speed")
        if self.revolutions is not None and (
            self.drive is not None or isinstance(self.speed, SpeedRamp)
        ):
            raise InputError(
                "goes with one speed; a ramp or a drive ends after its duration: remove it",
                key="orbit.revolutions",
            )

    @property
    def placed(self) -> tuple[PlacedStep | PlacedHarmonic | BladeLoss | Rub, ...]:
        """Forces, stops and losses at places of the shaft."""
        return (*self.step, *self.harmonic, *self.blade_loss, *self.rub)
