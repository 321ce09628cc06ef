"""Rotors."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import InputError


@dataclass(frozen=True)
class RigidRotor:
    """A rigid symmetric shaft on two like bearings (Dal Eq. 21).

    Parameters
    ----------
    mass : float
        Per bearing [kg].
    unbalance : float
        Mass times radius, per bearing [kg m].
    """

    mass: float
    unbalance: float = 0.0

    def __post_init__(self) -> None:
        _above_zero(mass=self.mass)
        _not_negative(unbalance=self.unbalance)


@dataclass(frozen=True)
class JeffcottRotor:
    """A disc in the middle of a flexible shaft on two like bearings, one half of it.

    Parameters
    ----------
    disc_mass, journal_mass : float
        Per bearing: half the disc, and what moves with one journal [kg].
    shaft_stiffness : float
        Per bearing: half the shaft's [N/m].
    disc_damping : float
        External, on the disc, per bearing [N s/m].
    unbalance : float
        Of the disc, per bearing [kg m].
    """

    disc_mass: float
    journal_mass: float
    shaft_stiffness: float
    disc_damping: float = 0.0
    unbalance: float = 0.0

    def __post_init__(self) -> None:
        _above_zero(
            disc_mass=self.disc_mass,
            journal_mass=self.journal_mass,
            shaft_stiffness=self.shaft_stiffness,
        )
        _not_negative(disc_damping=self.disc_damping, unbalance=self.unbalance)

    @property
    def mass(self) -> float:
        """Disc and journal, per bearing [kg]."""
        return self.disc_mass + self.journal_mass

    @property
    def natural_frequency(self) -> float:
        """Of the disc on the shaft with its journals held [rad/s]."""
        return math.sqrt(self.shaft_stiffness / self.disc_mass)


Rotor = RigidRotor | JeffcottRotor


def rigid_mass(rotor: Rotor | None) -> float | None:
    """Mass per bearing [kg] of a rigid rotor; None for what a critical mass says nothing of."""
    return rotor.mass if isinstance(rotor, RigidRotor) else None


def _above_zero(**values: float) -> None:
    for name, value in values.items():
        if not (math.isfinite(value) and value > 0.0):
            raise InputError("must be above 0", key=f"rotor.{name}", value=value)


def _not_negative(**values: float) -> None:
    for name, value in values.items():
        if not (math.isfinite(value) and value >= 0.0):
            raise InputError("must be 0 or more", key=f"rotor.{name}", value=value)
