"""Heat in time: how long, from where, and what changes on the way."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Annotated

from ..errors import InputError
from .entries import Clearance, Duration, Instant, Key, Length, Quantity, Speed, Temperature, check
from .pads import STEEL_DENSITY

_MAX_EVENTS = 100
_Load = Annotated[float, Quantity("force", "10 kN", "not_negative")]


class TransientStart(StrEnum):
    """Temperatures of the solids at the beginning."""

    COLD = "cold"
    """`initial_temperature` throughout."""
    STEADY = "steady"
    """Those of the steady state before the first event."""


@dataclass(frozen=True)
class SolidMaterial:
    """Heat capacity and conductivity of a solid.

    density : [kg/m3]
    specific_heat : [J/(kg K)]
    """

    density: Annotated[float, Quantity("density", "7850 kg/m^3")] = STEEL_DENSITY
    specific_heat: Annotated[float, Quantity("specific heat", "460 J/(kg*delta_degC)")] = 460.0

    def __post_init__(self) -> None:
        check(self, "transient")

    @property
    def capacity(self) -> float:
        """Heat per volume and degree [J/(m3 K)]."""
        return self.density * self.specific_heat


@dataclass(frozen=True)
class ShaftMaterial(SolidMaterial):
    """A shaft that conducts along its radius.

    conductivity : [W/(m K)]
    length : Of the shaft that the bearing heats [m]; None: the bearing's.
    """

    conductivity: Annotated[float, Quantity("thermal conductivity", "50 W/(m*delta_degC)")] = 50.0
    length: Length | None = None


@dataclass(frozen=True)
class TransientEvent:
    """Changes at one moment; what is left out stays as it is.

    at : [s]
    over : Time that the change takes, linearly [s]; 0: a step.
    speed : [rad/s]
    load : [N]
    supply_temperature, ambient_temperature : [K]
    supply : False: no oil is supplied any more; the oil in the bearing goes round uncooled.
    """

    at: Instant = 0.0
    over: Instant = 0.0
    speed: Speed | None = None
    load: _Load | None = None
    supply_temperature: Temperature | None = None
    ambient_temperature: Temperature | None = None
    supply: bool | None = None

    def __post_init__(self) -> None:
        check(self, "event")


@dataclass(frozen=True)
class TransientSettings:
    """A thermal transient of a bearing.

    duration : [s]
    initial_temperature : Of shaft and bush in a cold start [K]; None: ambient.
    speed : Before the first event [rad/s]; None: the scenario's highest.
    radial_clearance : One of the scenario's [m]; None: the first.
    bush : Of the bush or the pads.
    tolerance : Of the temperatures in one time step [K].
    """

    duration: Duration
    start: TransientStart = TransientStart.COLD
    initial_temperature: Temperature | None = None
    speed: Speed | None = None
    radial_clearance: Clearance | None = None
    events: Annotated[tuple[TransientEvent, ...], Key("event")] = ()
    shaft: ShaftMaterial = field(default_factory=ShaftMaterial)
    bush: SolidMaterial = field(default_factory=SolidMaterial)
    tolerance: Annotated[float, Quantity("temperature difference", "0.1 K")] = 0.1

    def __post_init__(self) -> None:
        check(self, "transient")
        if len(self.events) > _MAX_EVENTS:
            raise InputError(f"must hold at most {_MAX_EVENTS} events", key="transient.event")
        if self.start is TransientStart.STEADY and self.initial_temperature is not None:
            raise InputError('goes with start = "cold"', key="transient.initial_temperature")
        last = 0.0
        for number, event in enumerate(self.events):
            if event.at < last:
                raise InputError(
                    f"must not lie before the end of the event before it ({last:g} s)",
                    key=f"transient.event[{number}].at",
                )
            last = event.at + event.over
            if not event.at < self.duration:
                raise InputError(
                    f"must lie within transient.duration ({self.duration:g} s)",
                    key=f"transient.event[{number}].at",
                )
