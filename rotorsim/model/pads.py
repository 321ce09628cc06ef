"""Tilting pads: geometry and inertia."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated

from ..errors import InputError
from .entries import Angle, Clearance, Made, Number, Quantity, check
from .pivots import PIVOTS, Pivot, RigidPivot

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
PadPivot = Annotated[Pivot, Made(PIVOTS)]
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
    """Inertia of `pad` around a journal of `radius` over a bearing's `length` [m]."""
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
    """Middle and extent [rad] of the opening before each pad."""
    result = []
    for number, pad in enumerate(pads):
        before = pads[number - 1].trailing_edge - (0.0 if number else FULL_TURN)
        result.append((0.5 * (before + pad.leading_edge), pad.leading_edge - before))
    return result
