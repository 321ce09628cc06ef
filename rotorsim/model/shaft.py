"""A shaft as its drawing has it: sections, discs, materials."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from ..arguments import above_zero, not_negative
from ..errors import InputError
from .entries import Example, Length, Number, Quantity

Modulus = Annotated[float, Quantity("modulus", "207 GPa")]
Density = Annotated[float, Quantity("density", "7830 kg/m^3", "not_negative")]
Poisson = Annotated[float, Number(above=-1.0, most=0.5)]
Place = Annotated[float, Quantity("length", "140 mm", "not_negative")]
Diameter = Annotated[float, Quantity("length", "100 mm")]
Bore = Annotated[float, Quantity("length", "40 mm", "not_negative")]
DiscMass = Annotated[float, Quantity("mass", "35 kg")]
Inertia = Annotated[float, Quantity("moment of inertia", "0.55 kg*m^2", "not_negative")]


@dataclass(frozen=True)
class Material:
    """Elastic material of a shaft; the default is steel.

    youngs_modulus : [Pa]
    density : [kg/m^3]
    poisson_ratio : Ignored where `shear_modulus` is given, but for the shear coefficient.
    shear_modulus : [Pa]; None: from Young's modulus and Poisson's ratio.
    """

    youngs_modulus: Modulus = 207e9
    density: Density = 7830.0
    poisson_ratio: Poisson = 0.3
    shear_modulus: Modulus | None = None

    def __post_init__(self) -> None:
        above_zero("rotor", youngs_modulus=self.youngs_modulus)
        not_negative("rotor", density=self.density)
        if not -1.0 < self.poisson_ratio <= 0.5:
            raise InputError(
                "must lie above -1 and be at most 0.5", key="rotor.poisson_ratio",
                value=self.poisson_ratio,
            )  # fmt: skip
        if self.shear_modulus is not None:
            above_zero("rotor", shear_modulus=self.shear_modulus)
            ratio = self.youngs_modulus / (2.0 * self.shear_modulus) - 1.0
            if not -1.0 < ratio <= 0.5:
                raise InputError(
                    "does not fit Young's modulus: E/(2 G) - 1 must lie between -1 and 0.5",
                    key="rotor.shear_modulus", value=self.shear_modulus,
                )  # fmt: skip
            object.__setattr__(self, "poisson_ratio", ratio)

    @property
    def shear(self) -> float:
        """Shear modulus [Pa]."""
        if self.shear_modulus is not None:
            return self.shear_modulus
        return self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))


STEEL = Material()


@dataclass(frozen=True)
class Section:
    """A piece of shaft, a cylinder or a cone, solid or hollow.

    length, outer_diameter : [m]
    inner_diameter : [m]
    outer_diameter_right, inner_diameter_right : At the right end of a linear taper [m]; None: as at
        the left end.
    material : None: the rotor's.
    elements : Number of elements of equal length; None: by the mesh rule.
    at : Left end, from the left end of the shaft [m]; None: where the section before ends.
    layer : Sections of layers above 1 lie over (or in) those of layer 1, and need `at`.
    stiffness : With False the section has mass only (a sleeve that is not shrunk on).
    """

    length: Length
    outer_diameter: Diameter
    inner_diameter: Bore = 0.0
    outer_diameter_right: Diameter | None = None
    inner_diameter_right: Bore | None = None
    material: Material | None = None
    elements: Annotated[int, Number(least=1, most=1000)] | None = None
    at: Place | None = None
    layer: Annotated[int, Number(least=1, most=9)] = 1
    stiffness: bool = True

    def __post_init__(self) -> None:
        above_zero("rotor.section", length=self.length, outer_diameter=self.outer_diameter)
        not_negative("rotor.section", inner_diameter=self.inner_diameter)
        right = {"inner_diameter_right": self.inner_right, "outer_diameter_right": self.outer_right}
        not_negative("rotor.section", **right)
        inner, outer = self.inner_diameter, self.outer_diameter
        if not (inner < outer and self.inner_right < self.outer_right):
            raise InputError(
                "must be below the outer diameter", key="rotor.section.inner_diameter", value=inner
            )
        if self.elements is not None and self.elements < 1:
            raise InputError("must be 1 or more", key="rotor.section.elements", value=self.elements)
        if self.layer > 1 and self.at is None:
            raise InputError(
                "is missing: a section of a further layer needs its place", key="rotor.section.at"
            )

    @property
    def outer_right(self) -> float:
        """Outer diameter at the right end [m]."""
        right = self.outer_diameter_right
        return self.outer_diameter if right is None else right

    @property
    def inner_right(self) -> float:
        """Inner diameter at the right end [m]."""
        right = self.inner_diameter_right
        return self.inner_diameter if right is None else right


@dataclass(frozen=True)
class Coupling:
    """A flexible coupling: the shaft is cut at one place and its ends joined by springs.

    Half of its mass moves with either end; what stands at the place of the cut stands on the left
    end.

    at : [m]
    stiffness : Against a lateral offset of the two ends [N/m].
    angular_stiffness : Against an angle between them [N m/rad].
    mass : [kg]
    """

    at: Annotated[Place, Example("2.1 m")]
    stiffness: Annotated[float, Quantity("stiffness", "200 MN/m")]
    angular_stiffness: Annotated[float, Quantity("moment", "50 kN*m")]
    mass: Annotated[float, Quantity("mass", "20 kg", "not_negative")] = 0.0
    name: str = ""

    def __post_init__(self) -> None:
        above_zero("coupling", stiffness=self.stiffness, angular_stiffness=self.angular_stiffness)
        not_negative("coupling", mass=self.mass)


@dataclass(frozen=True)
class Disc:
    """A rigid disc, or an added mass, at one place of the shaft.

    at : From the left end of the shaft [m].
    mass : [kg]
    polar_inertia, transverse_inertia : About the disc's centre [kg m^2]; both zero for an added
        mass.
    """

    at: float
    mass: float
    polar_inertia: float = 0.0
    transverse_inertia: float = 0.0
    name: str = ""

    def __post_init__(self) -> None:
        not_negative(
            "rotor.disc", mass=self.mass, polar_inertia=self.polar_inertia,
            transverse_inertia=self.transverse_inertia,
        )  # fmt: skip

    @property
    def has_size(self) -> bool:
        """Return whether it is a disc that can be drawn, and no added mass."""
        return self.polar_inertia > 0.0 and self.mass > 0.0

    @classmethod
    def from_dimensions(
        cls,
        at: float,
        outer_diameter: float,
        width: float,
        density: float,
        inner_diameter: float = 0.0,
        name: str = "",
    ) -> Disc:
        """Return the disc of constant width [m, kg/m^3]."""
        above_zero("rotor.disc", outer_diameter=outer_diameter, width=width, density=density)
        if not 0.0 <= inner_diameter < outer_diameter:
            raise InputError(
                "must lie between 0 and the outer diameter", key="rotor.disc.inner_diameter",
                value=inner_diameter,
            )  # fmt: skip
        squares = outer_diameter**2 + inner_diameter**2
        mass = density * width * math.pi / 4.0 * (outer_diameter**2 - inner_diameter**2)
        polar = mass * squares / 8.0
        return cls(at, mass, polar, 0.5 * polar + mass * width**2 / 12.0, name)
