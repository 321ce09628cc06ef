"""One bearing with one thermal model, ready to be solved at any speed."""

from __future__ import annotations

from dataclasses import dataclass

from .bearing import Bearing
from .lubricant import Lubricant
from .operating import Target
from .settings import FilmSettings, ThermalSettings


@dataclass(frozen=True)
class Case:
    """Everything but the speed.

    Parameters
    ----------
    bearing : Bearing
        In the load frame (the scenario's load direction already turned to x).
    lubricant : Lubricant
    film : FilmSettings
    thermal : ThermalSettings
    target : EccentricityTarget or LoadTarget
    """

    bearing: Bearing
    lubricant: Lubricant
    film: FilmSettings
    thermal: ThermalSettings
    target: Target
