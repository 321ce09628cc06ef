"""Settings of the film and the heat: what is modelled, and how finely."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import pairwise
from typing import Annotated

from ..errors import InputError
from ..units import parse_quantity
from .entries import (
    NOT_IN_FILES,
    SEVERAL,
    Key,
    Leaf,
    Number,
    Quantity,
    Share,
    Temperature,
    check,
    nearest,
)
from .expansion import Expansion

_MAX_RATIOS = 64
"""Frequency ratios at which K and C are given besides."""
_MAX_CELLS = 20_000_000
"""Cells of the largest film or bush that is accepted."""


class Cavitation(StrEnum):
    """Behaviour of the film where it would pull (see docs: theory)."""

    FULL_SOMMERFELD = "full_sommerfeld"
    HALF_SOMMERFELD = "half_sommerfeld"
    REYNOLDS = "reynolds"
    JFO = "jfo"


class FlowRegime(StrEnum):
    """Flow regime of the film (see docs: theory)."""

    LAMINAR = "laminar"
    TURBULENT = "turbulent"
    """Reichardt's eddy viscosity across the film."""
    NG_PAN = "ng_pan"
    CONSTANTINESCU = "constantinescu"
    HIRS = "hirs"


class RoughnessPattern(StrEnum):
    """Direction of the asperities (Patir & Cheng)."""

    ISOTROPIC = "isotropic"
    LONGITUDINAL = "longitudinal"
    """Along the motion."""
    TRANSVERSE = "transverse"


@dataclass(frozen=True)
class SurfaceRoughness:
    """Roughness of both walls, for the flow factors of Patir & Cheng.

    journal, bush : Standard deviations of the heights [m].
    aspect : Length over width of a typical asperity where the pattern has a direction: 3, 6 or 9.
    """

    journal: Annotated[float, Quantity("length", "0.4 um", "not_negative")] = 0.0
    bush: Annotated[float, Quantity("length", "0.8 um", "not_negative")] = 0.0
    pattern: RoughnessPattern = RoughnessPattern.ISOTROPIC
    aspect: Annotated[float, Number(least=3.0, most=9.0)] = 6.0

    def __post_init__(self) -> None:
        check(self, "film.roughness")
        if self.aspect not in (3.0, 6.0, 9.0):
            raise InputError("must be 3, 6 or 9", key="film.roughness.aspect", value=self.aspect)

    @property
    def combined(self) -> float:
        """Standard deviation of both walls' heights together [m]."""
        return math.hypot(self.journal, self.bush)

    @property
    def gamma(self) -> float:
        """Length over width of a typical asperity, along the motion."""
        if self.pattern is RoughnessPattern.ISOTROPIC:
            return 1.0
        return self.aspect if self.pattern is RoughnessPattern.LONGITUDINAL else 1.0 / self.aspect


class Inception(StrEnum):
    """Place at which the film begins."""

    FREE = "free"
    """The complementarity problem decides."""
    MAX_FILM = "max_film"
    """p = 0 held at maximum thickness (a full-width slot there), or at the edge of a groove."""


class ThermalModel(StrEnum):
    """Film heating neglected, or solved for."""

    ISOTHERMAL = "isothermal"
    THD = "thd"


def preferred_model(models: Iterable[str]) -> str:
    """Return ``thd`` where it is among the models, or the first of them."""
    names = [str(model) for model in models]
    return "thd" if "thd" in names else names[0]


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


class _TransitionEntry(Leaf):
    """Two local Reynolds numbers, or Taylor's criterion."""

    def read(self, value: object) -> tuple[float, float] | str:
        return _checked_transition(value)


def _checked_transition(value: object) -> tuple[float, float] | str:
    """Return two local Reynolds numbers or "taylor"; InputError with what is allowed."""
    if value == "taylor":
        return "taylor"
    numbers = [
        float(number)
        for number in (value if isinstance(value, (list, tuple)) else ())
        if isinstance(number, (int, float)) and not isinstance(number, bool)
    ]
    if len(numbers) == 2 and (0.0 <= numbers[0] < numbers[1] < 1e9 or numbers == [0.0, 0.0]):
        return numbers[0], numbers[1]
    raise InputError(
        'must be "taylor" or two local Reynolds numbers that ascend, for example [500, 1000]; '
        "[0, 0] for a film turbulent throughout"
    )


class _ShaftEntry(Leaf):
    """A condition of the shaft, or its temperature."""

    kind = "temperature"

    def read(self, value: object) -> ShaftModel | float:
        names = [name for name in ShaftModel if name is not ShaftModel.GIVEN]
        if isinstance(value, str) and value in names:
            return ShaftModel(value)
        try:
            return parse_quantity(value, "temperature")
        except InputError as error:
            if isinstance(value, str) and any(sign.isdigit() for sign in value):
                raise  # meant as a temperature
            known = ", ".join(f'"{name}"' for name in names)
            raise InputError(
                f'must be one of {known}, or a temperature such as "60 degC"{nearest(value, names)}'
            ) from error


class ViscosityResponse(StrEnum):
    """Response of the viscosity to a displacement of the journal, for the stiffness."""

    FROZEN = "frozen"
    """Nothing: oil and walls need far longer than a turn to warm up."""
    FOLLOWING = "following"
    """It follows, as in a displacement so slow that the film stays in thermal equilibrium."""


class DeformationResponse(StrEnum):
    """Response of elastic pads or bush to the journal's motion, for K and C."""

    FOLLOWING = "following"
    """It bends with the pressure at once."""
    FROZEN = "frozen"
    """It keeps the shape of the equilibrium."""


class RupturedFriction(StrEnum):
    """Part of the ruptured sector that counts in the reported friction."""

    WHOLE = "whole"
    """All of it, as Raimondi & Boyd, Butenschoen and the paper count."""
    LIQUID = "liquid"
    """Only the liquid fraction: the part that heats the oil."""


@dataclass(frozen=True)
class MeshSize:
    """Cells around the bearing, along its whole length, across the film and through the bush."""

    circumferential: Annotated[int, Number(least=16, most=4096)] = 156
    axial: Annotated[int, Number(least=4, most=4096)] = 48
    cross_film: Annotated[int, Number(least=4, most=4096)] = 24
    bush_radial: Annotated[int, Number(least=2, most=4096)] = 24

    def __post_init__(self) -> None:
        check(self, "film.mesh")
        if self.axial % 2:
            raise InputError("must be even", key="film.mesh.axial", value=self.axial)
        if self.circumferential * self.axial * max(self.cross_film, self.bush_radial) > _MAX_CELLS:
            raise InputError(
                f"has more than {_MAX_CELLS} cells; the default is 156 x 48 x 24 x 24",
                key="film.mesh",
            )


@dataclass(frozen=True)
class FilmSettings:
    """Film model and mesh.

    frequency_ratios : Whirl over shaft frequencies, ascending, at which K and C are given besides.
    rotations : Give K and C over the journal's rotations as well.
    transition : Local Reynolds numbers rho U h/mu up to which the film is laminar and from which
        it is turbulent, unless `flow` is laminar; (0, 0): turbulent throughout. ``taylor``: from
        41.2 sqrt(R/c), where vortices begin, to twice that.
    """

    cavitation: Cavitation = Cavitation.REYNOLDS
    inception: Inception = Inception.MAX_FILM
    mesh: MeshSize = field(default_factory=MeshSize)
    ruptured_friction: RupturedFriction = RupturedFriction.LIQUID
    viscosity_response: ViscosityResponse = ViscosityResponse.FROZEN
    deformation_response: DeformationResponse = DeformationResponse.FOLLOWING
    frequency_ratios: Annotated[
        tuple[Annotated[float, Number(above=0.0)], ...], Key("frequency_ratio")
    ] = ()
    rotations: bool = False
    flow: FlowRegime = FlowRegime.LAMINAR
    transition: Annotated[tuple[float, float] | str, _TransitionEntry()] = (500.0, 1000.0)
    roughness: SurfaceRoughness | None = None

    def __post_init__(self) -> None:
        check(self, "film")
        try:
            object.__setattr__(self, "transition", _checked_transition(self.transition))
        except InputError as error:
            raise InputError(error.message, key="film.transition", value=self.transition) from None
        ratios = self.frequency_ratios
        if len(ratios) > _MAX_RATIOS:
            raise InputError(f"must hold at most {_MAX_RATIOS} entries", key="film.frequency_ratio")
        if any(high <= low for low, high in pairwise(ratios)):
            raise InputError(
                "must be above 0 and ascend", key="film.frequency_ratio", value=list(ratios)
            )


@dataclass(frozen=True)
class ThermalSettings:
    """Thermal model and its boundary conditions.

    ambient_temperature : [K]; of the surroundings, and of walls that are ``ambient``.
    supply_temperature : [K]; of the oil supplied, and of an isothermal film.
    inlet, shaft, bush : A number in place of a `ShaftModel` is the shaft's temperature [K].
    shaft_temperature : [K]; with ``shaft = given``.
    bush_conductivity : [W/(m K)], with ``bush = conduction``.
    bush_heat_transfer : Convection to the surroundings outside and at both ends [W/(m2 K)].
    hot_oil_carry_over : With ``inlet = mixing``: part of the oil arriving at a groove that enters
        the next film, 0 to 1; fresh oil replaces the rest.
    expansion : Thermal growth of journal, bush and pads; None: the clearance stays as it is given.
    supplied : False: the supply is lost; where oil is missing, what has left comes back uncooled.
    """

    model: Annotated[ThermalModel, Key("models"), SEVERAL] = ThermalModel.THD
    ambient_temperature: Temperature = 313.15
    supply_temperature: Temperature = 313.15
    inlet: InletModel = InletModel.FRESH
    shaft: Annotated[ShaftModel, _ShaftEntry()] = ShaftModel.AMBIENT
    bush: BushModel = BushModel.AMBIENT
    shaft_temperature: Annotated[Temperature | None, NOT_IN_FILES] = None
    bush_conductivity: Annotated[float, Quantity("thermal conductivity")] = 250.0
    bush_heat_transfer: Annotated[
        float, Quantity("heat transfer coefficient", None, "not_negative")
    ] = 80.0
    hot_oil_carry_over: Share = 1.0
    expansion: Expansion | None = None
    supplied: Annotated[bool, NOT_IN_FILES] = True

    def __post_init__(self) -> None:
        if not isinstance(self.shaft, str):
            object.__setattr__(self, "shaft_temperature", self.shaft)
            object.__setattr__(self, "shaft", ShaftModel.GIVEN)
        check(self, "thermal")
        if (self.shaft is ShaftModel.GIVEN) != (self.shaft_temperature is not None):
            raise InputError(
                "a shaft temperature goes with shaft = given",
                key="thermal.shaft",
                value=self.shaft_temperature,
            )
