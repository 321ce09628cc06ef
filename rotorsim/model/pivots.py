"""Pivots of tilting pads: how far they give way to the pad's load.

The contact laws are Hertz's, for the line contact with the approach of both bodies as Kirk & Reedy
(J. Vib. Acoust. Stress Reliab. Des. 110, 1988) give it. Rigid pivots have a line contact's freedom:
the pad tilts, it does not pitch.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Annotated, ClassVar

from ..errors import InputError
from .entries import Length, Number, Quantity, Stiffness, check

YOUNGS_MODULUS = 207e9
"""Steel [Pa]."""
POISSON_RATIO = 0.3
Modulus = Annotated[float, Quantity("modulus", "207 GPa")]
Poisson = Annotated[float, Number(least=0.0, below=0.5)]


class Pivot(ABC):
    """What a pad rests on: force over deflection."""

    kind: ClassVar[str]
    pitches: ClassVar[bool] = False
    """Whether the pad may turn about the tangent as well, as a ball lets it."""
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
        """Return stiffness times deflection; 0 where the pad has lifted off."""
        return self.stiffness * max(deflection, 0.0)

    def deflection(self, force: float) -> float:
        """Return force over stiffness."""
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


PIVOTS: dict[str, type[Pivot]] = {
    kind.kind: kind for kind in (RigidPivot, SpringPivot, LinePivot, SpherePivot, SocketPivot)
}
"""Every kind of pivot, by its name in a file."""
