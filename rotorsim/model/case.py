"""One bearing with one thermal model, ready to be solved at any speed."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import InputError
from .bearing import Bearing
from .lubricant import Lubricant
from .operating import EccentricityTarget, LoadTarget, Target, is_unloaded
from .settings import Cavitation, FilmSettings, Inception, ThermalSettings


@dataclass(frozen=True)
class Case:
    """Everything but the speed.

    bearing : In the load frame (the scenario's load direction already turned to x).
    target : EccentricityTarget or LoadTarget
    """

    bearing: Bearing
    lubricant: Lubricant
    film: FilmSettings
    thermal: ThermalSettings
    target: Target

    def __post_init__(self) -> None:
        target, bearing = self.target, self.bearing
        key = "load" if isinstance(target, LoadTarget) else "eccentricity_ratio"
        said = ""
        beyond = isinstance(target, EccentricityTarget) and not target.eccentricity_ratio < 1.0
        if beyond and not bearing.pads:
            said = "must lie between 0 and 1, 1 excluded"
        if is_unloaded(target):
            said = _centred(bearing, self.film, key)
        if said:
            value = target.load if isinstance(target, LoadTarget) else target.eccentricity_ratio
            raise InputError(said, key=f"operating.{key}", value=value)


def _centred(bearing: Bearing, film: FilmSettings, key: str) -> str:
    """Why a film without load cannot be computed as asked, and what to write; or nothing."""
    if not (bearing.is_plain and bearing.is_symmetric):
        if key == "load":
            return ""
        return 'must be above 0 in a bore of this kind; without load, write load = "0 N"'
    if film.cavitation is Cavitation.FULL_SOMMERFELD and film.inception is Inception.FREE:
        return ""
    return (
        "must be above 0 with this film: around a centred journal in a plain bore it neither "
        "ruptures nor begins at one place, and where it did, stiffness would depend on the "
        'direction of the motion; write cavitation = "full_sommerfeld" and inception = "free" in '
        "[film], or eccentricity_ratio = 0.001 for the limit of a light load"
    )
