"""Restrictors before recesses: what they let through at a pressure drop."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Annotated, ClassVar

from .entries import Made, Number, Quantity, check

_Bore = Annotated[float, Quantity("length", "0.8 mm")]
_STRAIGHT = 1e-6
"""Pressure drop, relative to the supply pressure, below which an orifice's law is straightened."""


class Restrictor(ABC):
    """Resistance between a supply and a recess."""

    kind: ClassVar[str]

    @abstractmethod
    def flow(
        self, supply: float, recess: float, viscosity: float, density: float
    ) -> tuple[float, float]:
        """Return the flow into the recess [m3/s] and its change with the recess' pressure.

        supply, recess : Gauge pressures [Pa].
        viscosity, density : Of the oil supplied [Pa s], [kg/m3].
        """


@dataclass(frozen=True)
class Capillary(Restrictor):
    """A long tube, laminar: Q = pi d^4/(128 mu l) times the pressure drop.

    diameter, length : [m]
    """

    kind: ClassVar[str] = "capillary"
    diameter: _Bore
    length: Annotated[float, Quantity("length", "50 mm")]

    def __post_init__(self) -> None:
        check(self, "restrictor")

    def flow(
        self, supply: float, recess: float, viscosity: float, density: float
    ) -> tuple[float, float]:
        """See `Restrictor`."""
        del density
        slope = math.pi * self.diameter**4 / (128.0 * viscosity * self.length)
        return slope * (supply - recess), -slope


@dataclass(frozen=True)
class Orifice(Restrictor):
    """A sharp-edged hole: Q = C_d (pi d^2/4) sqrt(2 (pressure drop)/rho), either way.

    diameter : [m]
    discharge_coefficient : C_d.
    """

    kind: ClassVar[str] = "orifice"
    diameter: _Bore
    discharge_coefficient: Annotated[float, Number(above=0.0, most=1.0)] = 0.6

    def __post_init__(self) -> None:
        check(self, "restrictor")

    def flow(
        self, supply: float, recess: float, viscosity: float, density: float
    ) -> tuple[float, float]:
        """See `Restrictor`; straight very near to no flow, where the slope has no bound."""
        del viscosity
        area = self.discharge_coefficient * 0.25 * math.pi * self.diameter**2
        drop, least = supply - recess, _STRAIGHT * supply
        root = math.sqrt(abs(drop) + least)
        scale = area * math.sqrt(2.0 / density)
        return scale * drop / root, -scale * (1.0 / root - 0.5 * abs(drop) / root**3)


@dataclass(frozen=True)
class Pump(Restrictor):
    """A pump that gives the recess its flow at any pressure, as for jacking oil.

    rate : [m3/s]
    """

    kind: ClassVar[str] = "pump"
    rate: Annotated[float, Quantity("volume flow", "2 L/min")]

    def __post_init__(self) -> None:
        check(self, "restrictor")

    def flow(
        self, supply: float, recess: float, viscosity: float, density: float
    ) -> tuple[float, float]:
        """See `Restrictor`."""
        del supply, recess, viscosity, density
        return self.rate, 0.0


_RESTRICTORS: dict[str, type[Restrictor]] = {kind.kind: kind for kind in (Capillary, Orifice, Pump)}
"""Every kind of restrictor, by its name in a file."""
AnyRestrictor = Annotated[Restrictor, Made(_RESTRICTORS)]
