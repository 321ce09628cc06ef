"""Frozen settings that a scenario holds beside the model objects (SI units)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

from ...model.loads import Load


class RotorKind(StrEnum):
    """Kinds of rotor that a scenario can describe."""

    RIGID = "rigid"
    JEFFCOTT = "jeffcott"


class OrbitForce(StrEnum):
    """Which film force an orbit is integrated with."""

    LINEAR = "linear"
    """K and C from the coefficient table."""
    FILM = "film"
    """Nonlinear film force."""


class OrbitKind(StrEnum):
    """What an orbit is about."""

    FREE_DECAY = "free_decay"
    """Displaced and let go: no unbalance."""
    UNBALANCE = "unbalance"
    STEP = "step"
    HARMONIC = "harmonic"
    RUN_UP = "run_up"
    COAST_DOWN = "coast_down"
    BASE_MOTION = "base_motion"


class Design(StrEnum):
    """How an actuator's feedback is found."""

    LQR = "lqr"
    """Full state feedback, optimal for a weighting of displacement against force."""
    PD = "pd"
    """Each axis by itself: the least derivative gain that reaches the wanted growth rate."""


class Station(StrEnum):
    """Where a load acts on the rotor."""

    JOURNAL = "journal"
    DISC = "disc"


class BearingProfile(StrEnum):
    """Shorthands for the usual multi-lobe bores."""

    ELLIPTICAL = "elliptical"
    THREE_LOBE = "three_lobe"
    OFFSET_HALVES = "offset_halves"


@dataclass(frozen=True)
class SpeedRamp:
    """Run-up or coast-down: speed [rad/s] changing linearly from start to stop.

    Parameters
    ----------
    start, stop : float
        [rad/s]
    duration : float
        [s]
    hold : float
        At the last speed after that [s].
    """

    start: float
    stop: float
    duration: float
    hold: float = 0.0

    @property
    def acceleration(self) -> float:
        """Angular acceleration [rad/s2], negative when coasting down."""
        return (self.stop - self.start) / self.duration


@dataclass(frozen=True)
class ActuatorSettings:
    """A magnetic actuator at the journal, about the equilibrium of the film alone.

    Parameters
    ----------
    design : Design
    force_limit : float
        Saturation of each axis [N].
    displacement_scale : float or None
        LQR: a displacement as bad as `force_scale` [m]; None: a hundredth of the clearance.
    force_scale : float or None
        LQR [N]; None: the limit, without one a tenth of the load.
    stiffness : float
        PD: proportional gain [N/m].
    damping : float or None
        PD: derivative gain [N s/m]; None: the least that reaches `decay_ratio`.
    decay_ratio : float or None
        PD: minus the largest growth rate, over the shaft's speed; None: a fiftieth.
    """

    design: Design = Design.LQR
    force_limit: float = math.inf
    displacement_scale: float | None = None
    force_scale: float | None = None
    stiffness: float = 0.0
    damping: float | None = None
    decay_ratio: float | None = None


@dataclass(frozen=True)
class OrbitSettings:
    """What to simulate in the time domain.

    Parameters
    ----------
    radial_clearance : float
        The one of the scenario's clearances that the orbit runs in [m].
    speed : float or SpeedRamp
        [rad/s]
    revolutions : int or None
        How long, at constant speed; None with a ramp, which has its own duration.
    force : OrbitForce
    initial_displacement : tuple of float
        From the static equilibrium, load frame [m].
    initial_velocity : tuple of float
        [m/s]
    kind : OrbitKind
    static_load, unbalance : bool
        Whether they act.
    loads : tuple of Load
        Steps, harmonic forces, motion of the base.
    samples_per_revolution : int
    steady_only : bool
        Figures leave the transient out.
    actuator : ActuatorSettings or None
        None: there is none, or it is switched off.
    """

    radial_clearance: float
    speed: float | SpeedRamp
    revolutions: int | None
    force: OrbitForce = OrbitForce.LINEAR
    initial_displacement: tuple[float, float] = (0.0, 0.0)
    initial_velocity: tuple[float, float] = (0.0, 0.0)
    kind: OrbitKind = OrbitKind.FREE_DECAY
    static_load: bool = True
    unbalance: bool = True
    loads: tuple[Load, ...] = ()
    samples_per_revolution: int = 64
    steady_only: bool = False
    actuator: ActuatorSettings | None = None


@dataclass(frozen=True)
class StabilitySettings:
    """The stability map's own axis.

    Parameters
    ----------
    mass : tuple of float
        Rotor masses per bearing, ascending [kg]; empty: left to the map.
    """

    mass: tuple[float, ...] = ()
