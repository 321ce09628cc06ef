"""What is modelled and how finely: the film's and the heat's settings."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum

from ..errors import InputError


def _as_choice(settings: object, section: str, **fields: type[StrEnum]) -> None:
    """Turn plain strings into the enumerations' members, so that comparisons by identity hold."""
    for name, kind in fields.items():
        value = getattr(settings, name)
        try:
            object.__setattr__(settings, name, kind(value))
        except ValueError:
            allowed = ", ".join(kind)
            raise InputError(
                f"must be one of {allowed}", key=f"{section}.{name}", value=value
            ) from None


class Cavitation(StrEnum):
    """What happens where the film would pull (see docs: theory)."""

    FULL_SOMMERFELD = "full_sommerfeld"
    HALF_SOMMERFELD = "half_sommerfeld"
    REYNOLDS = "reynolds"
    JFO = "jfo"


class Inception(StrEnum):
    """Where the film begins."""

    FREE = "free"
    """The complementarity problem decides."""
    MAX_FILM = "max_film"
    """p = 0 held at maximum thickness (a full-width slot there), or at the edge of a groove."""


class ThermalModel(StrEnum):
    """Film heating neglected, or solved for."""

    ISOTHERMAL = "isothermal"
    THD = "thd"


class InletModel(StrEnum):
    """Temperature of the oil where the film begins."""

    FRESH = "fresh"
    MIXING = "mixing"
    PERIODIC = "periodic"


class BushModel(StrEnum):
    """Thermal condition of the bush's bore."""

    AMBIENT = "ambient"
    INSULATED = "insulated"
    CONDUCTION = "conduction"


class ShaftModel(StrEnum):
    """Thermal condition of the shaft's surface."""

    AMBIENT = "ambient"
    INSULATED = "insulated"
    """Isothermal at the temperature at which it takes no net heat from the film."""
    GIVEN = "given"


class ViscosityResponse(StrEnum):
    """What the viscosity does while the journal is displaced, for the stiffness."""

    FROZEN = "frozen"
    """Nothing: oil and walls need far longer than a turn to warm up."""
    FOLLOWING = "following"
    """It follows, as in a displacement so slow that the film stays in thermal equilibrium."""


class RupturedFriction(StrEnum):
    """Which part of the ruptured sector counts in the reported friction."""

    WHOLE = "whole"
    """All of it, as Raimondi & Boyd, Butenschoen and the paper count."""
    LIQUID = "liquid"
    """Only the liquid fraction: the part that heats the oil."""


@dataclass(frozen=True)
class MeshSize:
    """Cells around the bearing, along its whole length, across the film and through the bush."""

    circumferential: int = 156
    axial: int = 48
    cross_film: int = 24
    bush_radial: int = 24

    def __post_init__(self) -> None:
        lowest = {"circumferential": 16, "axial": 4, "cross_film": 4, "bush_radial": 2}
        for name, least in lowest.items():
            value = getattr(self, name)
            if not least <= value <= 4096:
                raise InputError(
                    f"must be a whole number from {least} to 4096",
                    key=f"film.mesh.{name}",
                    value=value,
                )
        if self.axial % 2:
            raise InputError("must be even", key="film.mesh.axial", value=self.axial)


@dataclass(frozen=True)
class FilmSettings:
    """Film model and mesh.

    Parameters
    ----------
    cavitation, inception, mesh, ruptured_friction, viscosity_response
    frequency_ratios : tuple of float
        Whirl over shaft frequencies, ascending, at which K and C are given besides.
    rotations : bool
        Give K and C over the journal's rotations as well.
    """

    cavitation: Cavitation = Cavitation.REYNOLDS
    inception: Inception = Inception.MAX_FILM
    mesh: MeshSize = field(default_factory=MeshSize)
    ruptured_friction: RupturedFriction = RupturedFriction.LIQUID
    viscosity_response: ViscosityResponse = ViscosityResponse.FROZEN
    frequency_ratios: tuple[float, ...] = ()
    rotations: bool = False

    def __post_init__(self) -> None:
        _as_choice(self, "film", cavitation=Cavitation, inception=Inception)
        _as_choice(self, "film", ruptured_friction=RupturedFriction)
        _as_choice(self, "film", viscosity_response=ViscosityResponse)
        ratios = self.frequency_ratios
        ascend = all(low < high for low, high in zip((0.0, *ratios), ratios, strict=False))
        if not (ascend and all(math.isfinite(ratio) for ratio in ratios)):
            raise InputError(
                "must be above 0 and ascend", key="film.frequency_ratio", value=list(ratios)
            )


@dataclass(frozen=True)
class ThermalSettings:
    """Thermal model and its boundary conditions.

    Parameters
    ----------
    model : ThermalModel
    ambient_temperature : float
        [K]; of the surroundings, and of walls that are ``ambient``.
    supply_temperature : float
        [K]; of the oil supplied, and of an isothermal film.
    inlet, shaft, bush
    shaft_temperature : float or None
        [K]; with ``shaft = given``.
    bush_conductivity : float
        [W/(m K)], with ``bush = conduction``.
    bush_heat_transfer : float
        Convection to the surroundings outside and at both ends [W/(m2 K)].
    hot_oil_carry_over : float
        With ``inlet = mixing``: part of the oil arriving at a groove that enters the next film, 0
        to 1; fresh oil replaces the rest.
    """

    model: ThermalModel = ThermalModel.THD
    ambient_temperature: float = 313.15
    supply_temperature: float = 313.15
    inlet: InletModel = InletModel.FRESH
    shaft: ShaftModel = ShaftModel.AMBIENT
    bush: BushModel = BushModel.AMBIENT
    shaft_temperature: float | None = None
    bush_conductivity: float = 250.0
    bush_heat_transfer: float = 80.0
    hot_oil_carry_over: float = 1.0

    def __post_init__(self) -> None:
        _as_choice(self, "thermal", model=ThermalModel, inlet=InletModel)
        _as_choice(self, "thermal", shaft=ShaftModel, bush=BushModel)
        if not 0.0 <= self.hot_oil_carry_over <= 1.0:
            raise InputError(
                "must be 0 to 1", key="thermal.hot_oil_carry_over", value=self.hot_oil_carry_over
            )
        for name in ("ambient_temperature", "supply_temperature", "bush_conductivity"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise InputError("must be above 0", key=f"thermal.{name}", value=value)
        if not (math.isfinite(self.bush_heat_transfer) and self.bush_heat_transfer >= 0.0):
            raise InputError(
                "must be 0 or more", key="thermal.bush_heat_transfer", value=self.bush_heat_transfer
            )
        if (self.shaft is ShaftModel.GIVEN) != (self.shaft_temperature is not None):
            raise InputError(
                "a shaft temperature goes with shaft = given",
                key="thermal.shaft",
                value=self.shaft_temperature,
            )
