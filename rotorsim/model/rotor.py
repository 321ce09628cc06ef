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
        if not (math.isfinite(self.mass) and self.mass > 0.0):
            raise InputError("must be above 0", key="rotor.mass", value=self.mass)
        if not (math.isfinite(self.unbalance) and self.unbalance >= 0.0):
            raise InputError("must be 0 or more", key="rotor.unbalance", value=self.unbalance)
