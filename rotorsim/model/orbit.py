"""Settings of simulations in time: speeds, forces, an actuator."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

from ..errors import InputError
from .entries import Clearance, Duration, Example, Number, Pair, Quantity, Speed, check
from .loads import BaseMotion, BaseShock, HarmonicForce, Load, StepForce


class OrbitForce(StrEnum):
    """Film force that an orbit is integrated with."""

    LINEAR = "linear"
    """K and C from the coefficient table."""
    FILM = "film"
    """Nonlinear film force."""


class OrbitKind(StrEnum):
    """Subject of an orbit."""

    FREE_DECAY = "free_decay"
    """Displaced and let go: no unbalance."""
    UNBALANCE = "unbalance"
    STEP = "step"
    HARMONIC = "harmonic"
    RUN_UP = "run_up"
    COAST_DOWN = "coast_down"
    BASE_MOTION = "base_motion"


class Design(StrEnum):
    """Design methods of an actuator's feedback."""

    LQR = "lqr"
    """Full state feedback, optimal for a weighting of displacement against force."""
    PD = "pd"
    """Each axis by itself: the least derivative gain that reaches the wanted growth rate."""


_Velocity = Annotated[float, Quantity("velocity", "5 mm/s", "any")]
_KEYS = {
    Design.LQR: ("displacement_scale", "force_scale"),
    Design.PD: ("stiffness", "damping", "decay_ratio"),
}


@dataclass(frozen=True)
class SpeedRamp:
    """Run-up or coast-down: speed [rad/s] changing linearly from start to stop.

    start, stop : [rad/s]
    duration : [s]
    hold : At the last speed after that [s].
    """

    start: Annotated[Speed, Example("3000 rpm")]
    stop: Annotated[Speed, Example("15000 rpm")]
    duration: Duration
    hold: Annotated[float, Quantity("time", "0.5 s", "not_negative")] = 0.0

    def __post_init__(self) -> None:
        check(self)

    @property
    def acceleration(self) -> float:
        """Angular acceleration [rad/s2], negative when coasting down."""
        return (self.stop - self.start) / self.duration


@dataclass(frozen=True)
class ActuatorSettings:
    """A magnetic actuator at the journal, about the equilibrium of the film alone.

    force_limit : Saturation of each axis [N].
    displacement_scale : LQR: a displacement as bad as `force_scale` [m]; None: a hundredth of the
        clearance.
    force_scale : LQR [N]; None: the limit, without one a tenth of the load.
    stiffness : PD: proportional gain [N/m].
    damping : PD: derivative gain [N s/m]; None: the least that reaches `decay_ratio`.
    decay_ratio : PD: minus the largest growth rate, over the shaft's speed; None: a fiftieth.
    on : Whether it acts.
    """

    design: Design = Design.LQR
    force_limit: Annotated[float, Quantity("force", "1 kN")] = math.inf
    displacement_scale: Annotated[float, Quantity("length", "0.5 um")] | None = None
    force_scale: Annotated[float, Quantity("force", "100 N")] | None = None
    stiffness: Annotated[float, Quantity("stiffness", "5 MN/m", "not_negative")] = 0.0
    damping: Annotated[float, Quantity("damping", "20 kN*s/m", "not_negative")] | None = None
    decay_ratio: Annotated[float, Number(least=0.0, most=1.0)] | None = None
    on: bool = True

    def __post_init__(self) -> None:
        check(self, "orbit.actuator")
        for design, keys in _KEYS.items():
            for key in keys:
                if design is not self.design and getattr(self, key) != getattr(type(self), key):
                    raise InputError(
                        f'goes with design = "{design.value}", not "{self.design.value}"',
                        key=f"orbit.actuator.{key}",
                    )
        if self.damping is not None and self.decay_ratio is not None:
            raise InputError(
                "goes without damping: it is what the damping is found from; remove one of them",
                key="orbit.actuator.decay_ratio",
            )


@dataclass(frozen=True)
class OrbitSettings:
    """Settings of a simulation in the time domain.

    speed : float or SpeedRamp [rad/s]
    radial_clearance : The one of the scenario's clearances that the orbit runs in [m]; by default
        the first.
    revolutions : How long, at constant speed (60 by default); None with a ramp, which has its own
        duration.
    initial_displacement : From the static equilibrium, load frame [m].
    initial_velocity : [m/s]
    kind : By default what the other settings make up.
    static_load, unbalance : Whether they act; by default the unbalance does unless the kind is
        ``free_decay``.
    step, harmonic, base_motion, base_shock : Loads, or None.
    steady_only : Figures leave the transient out.
    actuator : None: there is none, or it is switched off.
    """

    speed: Annotated[Speed, Example("15000 rpm")] | SpeedRamp
    radial_clearance: Clearance = math.nan
    revolutions: Annotated[int, Number(least=1, most=1_000_000)] | None = None
    force: OrbitForce = OrbitForce.LINEAR
    initial_displacement: Pair = (0.0, 0.0)
    initial_velocity: tuple[_Velocity, _Velocity] = (0.0, 0.0)
    kind: OrbitKind = OrbitKind.FREE_DECAY
    static_load: bool = True
    unbalance: bool = True
    step: StepForce | None = None
    harmonic: HarmonicForce | None = None
    base_motion: BaseMotion | None = None
    base_shock: BaseShock | None = None
    samples_per_revolution: Annotated[int, Number(least=16, most=4096)] = 64
    steady_only: bool = False
    actuator: ActuatorSettings | None = None

    def __post_init__(self) -> None:
        check(self, "orbit")
        if self.is_ramped and self.revolutions is not None:
            raise InputError(
                "goes with one speed; a ramp ends after its duration: remove it",
                key="orbit.revolutions",
            )
        if not self.static_load and self.force is OrbitForce.LINEAR:
            raise InputError(
                'goes with force = "film" only: linear coefficients belong to the loaded position',
                key="orbit.static_load",
            )

    @property
    def is_ramped(self) -> bool:
        """Return whether the speed changes."""
        return isinstance(self.speed, SpeedRamp)

    @property
    def loads(self) -> tuple[Load, ...]:
        """Loads besides film, static load and unbalance."""
        every = (self.step, self.harmonic, self.base_motion, self.base_shock)
        return tuple(load for load in every if load is not None)

    def kinds(self, unbalance: float) -> list[OrbitKind]:
        """Return every kind that the settings make up, the most telling first.

        unbalance : The rotor's [kg m].
        """
        found = []
        if isinstance(self.speed, SpeedRamp) and self.speed.stop != self.speed.start:
            rises = self.speed.stop > self.speed.start
            found.append(OrbitKind.RUN_UP if rises else OrbitKind.COAST_DOWN)
        if self.step is not None:
            found.append(OrbitKind.STEP)
        if self.harmonic is not None:
            found.append(OrbitKind.HARMONIC)
        if self.base_motion is not None or self.base_shock is not None:
            found.append(OrbitKind.BASE_MOTION)
        if unbalance > 0.0 and self.unbalance:
            found.append(OrbitKind.UNBALANCE)
        return [*found, OrbitKind.FREE_DECAY]
