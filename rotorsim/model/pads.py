"""Tilting pads: geometry, inertia, and the pivots that they rest on."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated, ClassVar

from ..errors import InputError
from .entries import Angle, Clearance, Length, Made, Number, Quantity, Stiffness, check

YOUNGS_MODULUS = 207e9
"""Steel [Pa]."""
POISSON_RATIO = 0.3
Modulus = Annotated[float, Quantity("modulus", "207 GPa")]
Poisson = Annotated[float, Number(least=0.0, below=0.5)]


class Pivot(ABC):
    """Support of a pad: force over deflection."""

    kind: ClassVar[str]
    pitches: ClassVar[bool] = False
    """The pad may turn about the tangent as well, as a ball lets it."""
    is_rigid: ClassVar[bool] = False

    @abstractmethod
    def force(self, deflection: float) -> float:
        """Return the force [N] at a `deflection` [m], outward; 0 where the pad has lifted off."""

    @abstractmethod
    def deflection(self, force: float) -> float:
        """Return the deflection [m] under a `force` [N] of 0 or more."""

    @abstractmethod
    def stiffness_at(self, deflection: float) -> float:
        """Return d(force)/d(deflection) [N/m]."""


@dataclass(frozen=True)
class RigidPivot(Pivot):
    """A pivot that does not give way."""

    kind = "rigid"
    is_rigid = True

    def force(self, deflection: float) -> float:
        """Return 0: a rigid pivot's force is a result of the equilibrium."""
        del deflection
        return 0.0

    def deflection(self, force: float) -> float:
        """Return 0."""
        del force
        return 0.0

    def stiffness_at(self, deflection: float) -> float:
        """Return infinity."""
        del deflection
        return math.inf


@dataclass(frozen=True)
class SpringPivot(Pivot):
    """A pivot of constant stiffness [N/m]."""

    stiffness: Stiffness

    kind = "stiffness"

    def __post_init__(self) -> None:
        check(self, "pivot")

    def force(self, deflection: float) -> float:
        """Return the stiffness times deflection; 0 where the pad has lifted off."""
        return self.stiffness * max(deflection, 0.0)

    def deflection(self, force: float) -> float:
        """Return the force over stiffness."""
        return force / self.stiffness

    def stiffness_at(self, deflection: float) -> float:
        """Return the stiffness."""
        del deflection
        return self.stiffness


@dataclass(frozen=True, kw_only=True)
class _ContactPivot(Pivot):
    """A pivot whose contact follows Hertz; both bodies of one material unless told otherwise.

    youngs_modulus, poisson_ratio : Of pad and housing [Pa], [-].
    housing_youngs_modulus, housing_poisson_ratio : Of the housing alone.
    """

    youngs_modulus: Modulus = YOUNGS_MODULUS
    poisson_ratio: Poisson = POISSON_RATIO
    housing_youngs_modulus: Modulus | None = None
    housing_poisson_ratio: Poisson | None = None

    def __post_init__(self) -> None:
        check(self, "pivot")

    @property
    def compliance(self) -> float:
        """(1 - nu^2)/E of both bodies together [1/Pa]."""
        first = (1.0 - self.poisson_ratio**2) / self.youngs_modulus
        modulus = self.housing_youngs_modulus or self.youngs_modulus
        ratio = self.housing_poisson_ratio
        second = (1.0 - (self.poisson_ratio if ratio is None else ratio) ** 2) / modulus
        return first + second


@dataclass(frozen=True, kw_only=True)
class _PointPivot(_ContactPivot):
    """Point contact: deflection^(3/2) = 3/4 force compliance/sqrt(relative radius)."""

    pitches = True

    @property
    def relative_radius(self) -> float:
        """1/(1/R_1 + 1/R_2) [m]."""
        raise NotImplementedError

    @property
    def _factor(self) -> float:
        return 4.0 / 3.0 * math.sqrt(self.relative_radius) / self.compliance

    def force(self, deflection: float) -> float:
        """Return Hertz' force; 0 where the pad has lifted off."""
        return self._factor * max(deflection, 0.0) ** 1.5

    def deflection(self, force: float) -> float:
        """Return Hertz' approach of the bodies."""
        return (max(force, 0.0) / self._factor) ** (2.0 / 3.0)

    def stiffness_at(self, deflection: float) -> float:
        """Return the tangent of Hertz' law."""
        return 1.5 * self._factor * math.sqrt(max(deflection, 0.0))


@dataclass(frozen=True, kw_only=True)
class SpherePivot(_PointPivot):
    """A sphere of `radius` [m] on a plate."""

    radius: Length

    kind = "sphere"

    @property
    def relative_radius(self) -> float:
        """The sphere's radius [m]."""
        return self.radius


@dataclass(frozen=True, kw_only=True)
class SocketPivot(_PointPivot):
    """A ball in a socket [m], by Hertz: the radii must differ by more than the contact's."""

    ball_radius: Length
    socket_radius: Length

    kind = "ball_in_socket"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.socket_radius > self.ball_radius:
            raise InputError(
                f"must be above the ball's radius ({self.ball_radius * 1e3:g} mm)",
                key="pivot.socket_radius",
                value=self.socket_radius,
            )

    @property
    def relative_radius(self) -> float:
        """R_ball R_socket/(R_socket - R_ball) [m]."""
        difference = self.socket_radius - self.ball_radius
        return self.ball_radius * self.socket_radius / difference


@dataclass(frozen=True, kw_only=True)
class LinePivot(_ContactPivot):
    """A pad rocking on its back: line contact of two cylinders, the housing's hollow.

    pad_radius, housing_radius : Of the pad's back and of the housing's bore [m].
    length : Of the contact [m].

    Kirk & Reedy (1988), from Young's tables: with p = F/L, C the compliance and the contact's full
    width b^2 = 8/pi p C D_h D_p/(D_h - D_p),

        deflection = p C/pi [2/3 + ln(4 D_h D_p/b^2)],

    which for one material and nu = 0.3 is their 2 p (1 - nu^2)/(pi E)
    [2/3 + ln(4 E L (D_h - D_p)/(2.15^2 F))].
    """

    pad_radius: Length
    housing_radius: Length
    length: Length

    kind = "line"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.housing_radius > self.pad_radius:
            raise InputError(
                f"must be above the radius of the pad's back ({self.pad_radius * 1e3:g} mm)",
                key="pivot.housing_radius",
                value=self.housing_radius,
            )

    @property
    def _scale(self) -> float:
        """Force [N] at which the logarithm vanishes."""
        difference = 2.0 * (self.housing_radius - self.pad_radius)
        return math.pi / 2.0 * difference * self.length / self.compliance

    @property
    def _most(self) -> float:
        """Force [N] up to which the law is followed: above it the deflection would soon fall."""
        return 0.2 * self._scale

    def deflection(self, force: float) -> float:
        """Return the approach of both bodies."""
        if not force > 0.0:
            return 0.0
        force = min(force, self._most)
        return self._per_force(force) * force

    def force(self, deflection: float) -> float:
        """Return the force that belongs to a deflection; 0 where the pad has lifted off."""
        if not deflection > 0.0:
            return 0.0
        if deflection >= self.deflection(self._most):
            return self._most
        force = deflection / self._per_force(1e-6 * self._scale)
        for _ in range(60):
            new = min(deflection / self._per_force(force), self._most)
            if abs(new - force) <= 1e-15 * force:
                break
            force = new
        return force

    def stiffness_at(self, deflection: float) -> float:
        """Return the tangent of the law."""
        force = self.force(deflection)
        if not force > 0.0:
            return 0.0
        return 1.0 / (self._per_force(force) - self.compliance / (math.pi * self.length))

    def _per_force(self, force: float) -> float:
        logarithm = 2.0 / 3.0 + math.log(self._scale / force)
        return self.compliance / (math.pi * self.length) * logarithm


_PIVOTS: dict[str, type[Pivot]] = {
    kind.kind: kind for kind in (RigidPivot, SpringPivot, LinePivot, SpherePivot, SocketPivot)
}
"""Every kind of pivot, by its name in a file."""
FULL_TURN = 2.0 * math.pi
STEEL_DENSITY = 7850.0
"""[kg/m3]"""
Extent = Annotated[float, Quantity("angle", "60 deg")]
Thickness = Annotated[float, Quantity("length", "20 mm")]
PivotOffset = Annotated[
    float, Number(above=0.0, below=1.0, hint="0.5 is a pivot in the middle of the pad")
]
PadPreload = Annotated[
    float, Number(above=-1.0, below=1.0, hint="1 - assembled over machined clearance")
]
PadPivot = Annotated[Pivot, Made(_PIVOTS)]
Density = Annotated[float, Quantity("density", "7850 kg/m^3")]
PadMass = Annotated[float, Quantity("mass", "2 kg", "not_negative")]
Inertia = Annotated[float, Quantity("moment of inertia", "0.002 kg*m^2", "not_negative")]


@dataclass(frozen=True)
class Pad:
    """A pad on its pivot, angles in the load frame.

    pivot_angle : [rad]
    arc : From the leading to the trailing edge [rad].
    thickness : From the pad's face to the pivot [m].
    offset : Where the pivot stands: 0 at the leading, 1 at the trailing edge, 0.5 centred.
    preload : 1 - (assembled clearance)/(machined clearance).
    clearance : Machined clearance, pad radius minus journal radius [m]; None: the bearing's
        `radial_clearance`.
    assembled_clearance : In place of the preload [m].
    density : Of the pad [kg/m3], for what follows where it is not given.
    mass : [kg]
    tilt_inertia, pitch_inertia : About the pivot's axis, and about the tangent at the pivot [kg
        m2].
    youngs_modulus, poisson_ratio : Of a pad that bends under the film's pressure [Pa]; without the
        modulus it does not.

    Mass and inertias that are not given are those of the annular sector between the journal's
    radius and that plus the thickness, over the bearing's length.
    """

    pivot_angle: Angle
    arc: Extent
    thickness: Thickness
    offset: PivotOffset = 0.5
    preload: PadPreload = 0.0
    clearance: Clearance | None = None
    assembled_clearance: Clearance | None = None
    pivot: PadPivot = field(default_factory=RigidPivot)
    density: Density = STEEL_DENSITY
    mass: PadMass | None = None
    tilt_inertia: Inertia | None = None
    pitch_inertia: Inertia | None = None
    youngs_modulus: Modulus | None = None
    poisson_ratio: Poisson = POISSON_RATIO

    def __post_init__(self) -> None:
        check(self, "pad")
        if not self.arc < FULL_TURN:
            raise InputError("must be below 360 deg", key="pad.arc", value=self.arc)
        if self.assembled_clearance is not None and self.preload != 0.0:
            raise InputError(
                "either preload or assembled_clearance, not both", key="pad.preload",
                value=self.preload,
            )  # fmt: skip

    @property
    def leading_edge(self) -> float:
        """Angle where the oil enters [rad]."""
        return self.pivot_angle - self.offset * self.arc

    @property
    def trailing_edge(self) -> float:
        """Angle where the oil leaves [rad]."""
        return self.leading_edge + self.arc


@dataclass(frozen=True)
class PadInertia:
    """Mass and inertias of a pad on its pivot.

    mass : [kg]
    tilt : About the pivot's axis [kg m2].
    pitch : About the tangent at the pivot [kg m2].
    coupling : Mass times the distance by which the centre of mass lies ahead of the pivot [kg m]: a
        radial acceleration of the pivot turns the pad.
    """

    mass: float
    tilt: float
    pitch: float
    coupling: float


def pad_inertia(pad: Pad, radius: float, length: float) -> PadInertia:
    """Return the inertia of `pad` around a journal of `radius` over a bearing's `length` [m]."""
    inner, outer = radius, radius + pad.thickness
    half = 0.5 * pad.arc
    ahead = (0.5 - pad.offset) * pad.arc  # from the pivot to the middle of the pad
    mass = pad.mass
    if mass is None:
        mass = pad.density * length * half * (outer**2 - inner**2)
    mean_radius = 2.0 / 3.0 * (outer**3 - inner**3) / (outer**2 - inner**2)
    mean_square = 0.5 * (outer**2 + inner**2)
    slimness = math.sin(half) / half
    center = mean_radius * slimness
    tilt = pad.tilt_inertia
    if tilt is None:
        # about the bearing's axis, moved to the pivot: <|r - r_p|^2>
        tilt = mass * (mean_square + outer**2 - 2.0 * outer * center * math.cos(ahead))
    pitch = pad.pitch_inertia
    if pitch is None:
        # <(r cos phi - r_p)^2 + y^2>, phi from the pivot
        double = 0.5 * (1.0 + math.sin(pad.arc) / pad.arc * math.cos(2.0 * ahead))
        along = mean_square * double - 2.0 * outer * center * math.cos(ahead) + outer**2
        pitch = mass * (along + length**2 / 12.0)
    return PadInertia(mass, tilt, pitch, coupling=mass * center * math.sin(ahead))


def check_order(pads: Sequence[Pad]) -> None:
    """Refuse pads that overlap, or do not follow one another in the direction of rotation."""
    for number, pad in enumerate(pads):
        last = number + 1 == len(pads)
        following = pads[(number + 1) % len(pads)].leading_edge + (FULL_TURN if last else 0.0)
        if not following > pad.trailing_edge + 1e-9:
            other = 1 if last else number + 2
            raise InputError(
                f"pad {number + 1} ends at {math.degrees(pad.trailing_edge):.4g} deg, pad {other} "
                f"begins at {math.degrees(following):.4g} deg: pads must follow one another in the "
                "direction of rotation and leave room for oil between them",
                key=f"pad[{number}].arc",
            )


def gaps(pads: Sequence[Pad]) -> list[tuple[float, float]]:
    """Return the middle and extent [rad] of the opening before each pad."""
    result = []
    for number, pad in enumerate(pads):
        before = pads[number - 1].trailing_edge - (0.0 if number else FULL_TURN)
        result.append((0.5 * (before + pad.leading_edge), pad.leading_edge - before))
    return result
