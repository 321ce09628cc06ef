"""Bores that give way under the film's pressure: a soft layer, a thin bush, a diaphragm."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from ..errors import InputError
from .entries import Angle, Length, Made, Quantity, Stiffness, check
from .pads import FULL_TURN, POISSON_RATIO, YOUNGS_MODULUS, Extent, Modulus, Poisson

_Thin = Annotated[float, Quantity("length", "2 mm")]


@dataclass(frozen=True, kw_only=True)
class ElasticLayer:
    """A layer bonded to a rigid bush, thin against the film's length: each column for itself.

    w = p t (1 + nu)(1 - 2 nu)/((1 - nu) E): nothing moves sideways.
    """

    thickness: _Thin
    youngs_modulus: Modulus
    poisson_ratio: Poisson = POISSON_RATIO

    kind: ClassVar[str] = "layer"

    def __post_init__(self) -> None:
        check(self, "bearing.compliance")

    @property
    def deflection(self) -> float:
        """Deflection per pressure [m/Pa]."""
        nu = self.poisson_ratio
        share = (1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu)
        return self.thickness * share / self.youngs_modulus


@dataclass(frozen=True, kw_only=True)
class ThinBush:
    """A thin bush, bent as a ring, in a housing that holds it all round like many springs.

    stiffness : Of the housing: radial force summed over the bush's back, per radial growth [N/m].
        Sideways it gives way by the load over half of that.
    """

    thickness: _Thin
    stiffness: Stiffness
    youngs_modulus: Modulus = YOUNGS_MODULUS

    kind: ClassVar[str] = "ring"

    def __post_init__(self) -> None:
        check(self, "bearing.compliance")


@dataclass(frozen=True, kw_only=True)
class Diaphragm:
    """A part of the bore that is a thin shell over a cavity, free at its first edge.

    At its sides and its end it is built into the bush, which is rigid. In its middle it has the
    bearing's mid-plane.

    start, extent : Angles from the load line, in the direction of rotation [rad].
    width, width_at_end : Axial, at its start and its end, straight between [m].
    thickness : [m]
    """

    start: Angle
    extent: Extent
    width: Length
    width_at_end: Length | None = None
    thickness: _Thin
    youngs_modulus: Modulus = YOUNGS_MODULUS
    poisson_ratio: Poisson = POISSON_RATIO

    kind: ClassVar[str] = "diaphragm"

    def __post_init__(self) -> None:
        check(self, "bearing.compliance")
        if not self.extent < FULL_TURN:
            raise InputError(
                "must be below 360 deg", key="bearing.compliance.extent", value=self.extent
            )


_COMPLIANCES = {kind.kind: kind for kind in (ElasticLayer, ThinBush, Diaphragm)}
_Compliance = ElasticLayer | ThinBush | Diaphragm
AnyCompliance = Annotated[_Compliance, Made(_COMPLIANCES)]
