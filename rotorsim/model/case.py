"""One bearing with one thermal model, ready to be solved at any speed."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import InputError
from .bearing import Bearing
from .expansion import BushFit, HousingFit
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
        _check_fit(bearing, self.thermal)
        if said:
            value = target.load if isinstance(target, LoadTarget) else target.eccentricity_ratio
            raise InputError(said, key=f"operating.{key}", value=value)


def _check_fit(bearing: Bearing, thermal: ThermalSettings) -> None:
    """Refuse a housing that holds a bush of unknown size, or a spring for a ring of pivots."""
    if thermal.expansion is None or thermal.expansion.bush_fit is BushFit.FREE:
        return
    if bearing.pads:
        if isinstance(thermal.expansion.bush_fit, HousingFit):
            raise InputError(
                'with tilting pads must be "free" or "rigid_housing": the ring that holds the '
                "pivots",
                key="thermal.expansion.bush_fit",
            )
    elif bearing.bush_outer_radius is None:
        raise InputError(
            "is missing: a bush that its housing holds needs it; write for example "
            f'bush_outer_radius = "{1.5e3 * bearing.journal_radius:g} mm"',
            key="bearing.bush_outer_radius",
        )


def _centred(bearing: Bearing, film: FilmSettings, key: str) -> str:
    """Return why a film without load cannot be computed as asked, and what to write; or nothing."""
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
