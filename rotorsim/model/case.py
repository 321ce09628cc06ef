"""One bearing with one thermal model, ready to be solved at any speed."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import InputError
from .bearing import Bearing
from .lubricant import Lubricant
from .operating import EccentricityTarget, Target
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

    def __post_init__(self) -> None:
        target = self.target
        if not isinstance(target, EccentricityTarget) or self.bearing.pads:
            return
        if not target.eccentricity_ratio < 1.0:
            raise InputError(
                "must lie between 0 and 1, both excluded",
                key="operating.eccentricity_ratio",
                value=target.eccentricity_ratio,
            )
