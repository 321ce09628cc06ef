"""Thermal growth of journal, bush and pads, and how a housing holds the bush."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

from .entries import Quantity, Stiffness, Temperature, check
from .pads import POISSON_RATIO, YOUNGS_MODULUS, Modulus, Poisson

Coefficient = Annotated[
    float, Quantity("thermal expansion", "11.7e-6 / delta_degC", "not_negative")
]
STEEL_EXPANSION = 11.7e-6
"""[1/K]"""


class BushFit(StrEnum):
    """Supports of the bush's outer surface."""

    FREE = "free"
    RIGID_HOUSING = "rigid_housing"
    """It stays where it is at the reference temperature."""


@dataclass(frozen=True)
class HousingFit:
    """A housing that gives way.

    stiffness : Radial force on the bush's outer surface, summed over it, per radial growth [N/m].
    """

    stiffness: Stiffness

    def __post_init__(self) -> None:
        check(self, "thermal.expansion.bush_fit")


@dataclass(frozen=True)
class Expansion:
    """Thermal expansion; the clearances given are those at the reference temperature.

    shaft, bush : Coefficients of linear expansion [1/K]; with tilting pads the bush is the ring
        that holds the pivots, at ambient temperature.
    pads : Of tilting pads [1/K]; None: the bush's.
    reference_temperature : At which the clearances are measured [K].
    bush_fit : BushFit or HousingFit
    youngs_modulus, poisson_ratio : Of the bush [Pa], for a bush that is held.
    """

    shaft: Coefficient = STEEL_EXPANSION
    bush: Coefficient = STEEL_EXPANSION
    pads: Coefficient | None = None
    reference_temperature: Temperature = 293.15
    bush_fit: BushFit | HousingFit = BushFit.FREE
    youngs_modulus: Modulus = YOUNGS_MODULUS
    poisson_ratio: Poisson = POISSON_RATIO

    def __post_init__(self) -> None:
        check(self, "thermal.expansion")

    def journal_growth(self, radius: float, temperature: float) -> float:
        """Return the radial growth [m] of a journal of that mean temperature [K]."""
        return self.shaft * radius * (temperature - self.reference_temperature)

    def bore_growth(
        self, inner: float, outer: float | None, length: float, temperature: float
    ) -> float:
        """Return the radial growth [m] of a bore whose ring has that mean temperature [K].

        A ring in plane stress (Timoshenko & Goodier, Theory of Elasticity, secs. 28 and 150): free,
        its radii grow by alpha r T whatever T(r) is, T its mean over the area; the housing's
        pressure p gives way to alpha b T - p [(a2 + b2)/(b2 - a2) - nu] b/E.

        inner, outer, length : Of the ring [m]; a free ring needs no outer radius.
        """
        strain = self.bush * (temperature - self.reference_temperature)
        if self.bush_fit is BushFit.FREE or outer is None:
            return strain * inner
        square = outer**2 - inner**2
        own = outer / self.youngs_modulus
        own *= (inner**2 + outer**2) / square - self.poisson_ratio
        housing = 0.0
        if isinstance(self.bush_fit, HousingFit):
            housing = 2.0 * math.pi * outer * length / self.bush_fit.stiffness
        pressure = strain * outer / (own + housing)
        return strain * inner - pressure * 2.0 * inner * outer**2 / (self.youngs_modulus * square)

    def pad_growth(
        self, inner: float, thickness: float, temperature: float, gradient: float
    ) -> tuple[float, float]:
        """Return by how much a pad's machined and assembled clearance grow [m].

        The pad grows from its back, where the pivot stands, and opens under a temperature that
        falls outwards: a circle of radius r_m (1 - alpha r_m dT/dr) at mid-thickness, free of
        stress.

        inner, thickness : [m]
        temperature : Mean [K].
        gradient : dT/dr [K/m].
        """
        coefficient = self.bush if self.pads is None else self.pads
        strain = coefficient * (temperature - self.reference_temperature)
        opened = -coefficient * gradient * (inner + 0.5 * thickness) ** 2
        return strain * inner + opened, -strain * thickness

    def ring_growth(self, radius: float, temperature: float) -> float:
        """Return the radial growth [m] of the ring that holds the pivots, at `radius`."""
        if self.bush_fit is BushFit.RIGID_HOUSING:
            return 0.0
        return self.bush * radius * (temperature - self.reference_temperature)
