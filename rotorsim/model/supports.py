"""Supports and seals of a machine's file: bearings, pedestals, dampers, floating rings.

Positions are measured from the left end of the shaft [m]; x points down, y is 90 degrees ahead of x
in the direction of rotation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any

from ..errors import InputError
from ..units import parse_quantity
from .entries import Angle, Clearance, Displacement, Example, Leaf, Length, Mass, Quantity
from .machine_orbit import MachineForce
from .shaft import Place

Matrix = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True)
class MatrixEntry(Leaf):
    """A 2 x 2 matrix: one value for x and y, a pair, or two rows of two.

    quantity : Of its entries, a name in `rotorsim.units.QUANTITIES`.
    text : A valid one.
    any_sign : Whether one value, or a pair, may be negative; rows of two may.
    """

    quantity: str
    text: str
    any_sign: bool = False

    def read(self, value: object) -> Matrix:
        """Return the matrix [SI]."""
        if isinstance(value, str):
            one = self._direct(value)
            return (one, 0.0), (0.0, one)
        if isinstance(value, list) and len(value) == 2:
            if all(isinstance(part, str) for part in value):
                return (self._direct(value[0]), 0.0), (0.0, self._direct(value[1]))
            if all(isinstance(part, list) and len(part) == 2 for part in value):
                (xx, xy), (yx, yy) = ([self._number(one) for one in row] for row in value)
                return (xx, xy), (yx, yy)
        text = self.text
        raise InputError(
            f'must be one value "{text}", a pair ["{text}", "{text}"] for x and y, or two rows '
            f'[["{text}", "{text}"], ["{text}", "{text}"]]'
        )

    def _direct(self, text: object) -> float:
        number = self._number(text)
        if number < 0.0 and not self.any_sign:
            raise InputError(
                "must not be negative; where that is meant, write the whole matrix, two rows of two"
            )
        return number

    def _number(self, text: object) -> float:
        return parse_quantity(text, self.quantity, example=self.text)


_StiffnessMatrix = Annotated[Matrix, MatrixEntry("stiffness", "10 MN/m")]
_DampingMatrix = Annotated[Matrix, MatrixEntry("damping", "20 kN*s/m")]
_MassMatrix = Annotated[Matrix, MatrixEntry("mass", "5 kg")]


_AnyStiffness = Annotated[Matrix, MatrixEntry("stiffness", "10 MN/m", any_sign=True)]


@dataclass(frozen=True)
class Pedestal:
    """Springs and dampers under a bearing's housing.

    mass, stiffness, damping : (2, 2) tuples. Of the housing, and between it and the ground [kg,
        N/m, N s/m].
    """

    mass: _MassMatrix
    stiffness: _StiffnessMatrix
    damping: _DampingMatrix = ((0.0, 0.0), (0.0, 0.0))


_Viscosity = Annotated[float, Quantity("dynamic viscosity", "0.01 Pa*s")]


@dataclass(frozen=True)
class EndSeal:
    """A narrow gap at each end of a damper.

    clearance, length : Of the gap, radial and along the shaft [m].
    """

    clearance: Annotated[Clearance, Example("50 um")]
    length: Annotated[Length, Example("2 mm")]


@dataclass(frozen=True)
class Damper:
    """A squeeze-film damper: the bearing's outer ring, which does not turn, in a film of its own.

    diameter, length, radial_clearance : Of the film [m].
    viscosity : [Pa s]
    mass : Of what moves with the outer ring [kg].
    stiffness, damping : (2, 2) tuples or None. Of a centring spring, which is set so that the ring
        stands centred under the static load [N/m, N s/m]; without one the ring rests on the bottom
        of its housing.
    cavitating : Whether the film ruptures, or bears pressures of either sign.
    end_seal : None: the ends are open.
    """

    diameter: Annotated[Length, Example("100 mm")]
    length: Annotated[Length, Example("30 mm")]
    radial_clearance: Annotated[Clearance, Example("100 um")]
    viscosity: _Viscosity
    mass: Annotated[Mass, Example("2 kg")]
    stiffness: _StiffnessMatrix | None = None
    damping: _DampingMatrix | None = None
    cavitating: bool = True
    end_seal: EndSeal | None = None

    @property
    def leakage(self) -> float | None:
        """Conductance of the end seals, times 12 mu L/c^3 [-]; None: open ends."""
        seal = self.end_seal
        if seal is None:
            return None
        return (seal.clearance / self.radial_clearance) ** 3 * self.length / seal.length


@dataclass(frozen=True)
class FloatingRing:
    """A bearing of two films with a ring between them.

    inner_diameter, outer_diameter : Of the films [m].
    inner_length, outer_length, inner_clearance, outer_clearance : Of the films; clearances are
        radial [m].
    inner_viscosity, outer_viscosity : [Pa s]
    mass : Of the ring [kg].
    turning : Whether the ring turns with the films' friction (full-floating) or is held
        (semi-floating).
    """

    inner_diameter: Annotated[Length, Example("10 mm")]
    outer_diameter: Annotated[Length, Example("16 mm")]
    inner_length: Annotated[Length, Example("6 mm")]
    outer_length: Annotated[Length, Example("8 mm")]
    inner_clearance: Annotated[Clearance, Example("15 um")]
    outer_clearance: Annotated[Clearance, Example("35 um")]
    inner_viscosity: _Viscosity
    outer_viscosity: _Viscosity
    mass: Annotated[Mass, Example("10 g")]
    turning: bool = True

    def __post_init__(self) -> None:
        if self.outer_diameter <= self.inner_diameter:
            raise InputError("must be larger than inner_diameter", key="outer_diameter")

    @property
    def inertia(self) -> float:
        """Polar, of a ring of uniform thickness [kg m^2]."""
        return 0.125 * self.mass * (self.inner_diameter**2 + self.outer_diameter**2)

    @property
    def drags(self) -> tuple[float, float]:
        """Petroff's torque over the speed difference of both centred films [N m s]."""
        return tuple(
            0.25 * math.pi * viscosity * diameter**3 * length / clearance
            for viscosity, diameter, length, clearance in (
                (self.inner_viscosity, self.inner_diameter, self.inner_length,
                 self.inner_clearance),
                (self.outer_viscosity, self.outer_diameter, self.outer_length,
                 self.outer_clearance),
            )
        )  # type: ignore[return-value]  # fmt: skip


@dataclass(frozen=True)
class SupportEntry:
    """A bearing at a place of the shaft.

    at : [m]
    bearing : File of a bearing's scenario, relative to the machine's file.
    coefficients : File of a coefficient table, in the frame of its static load.
    coefficients_bearing : Which bearing of that file, where it holds several.
    stiffness, damping, mass : (2, 2) tuples or None. Constants, in the machine's frame turned by
        `angle`.
    elevation : Of the housing, upwards [m].
    angle : By which the bearing is turned in its housing [rad].
    damper : In series with the bearing, in place of a pedestal.
    ring : A floating-ring bearing, in place of the three above.
    force : Of its films in time; None: as [orbit] says.
    """

    at: Annotated[Place, Example("140 mm")]
    name: str = ""
    bearing: str | None = None
    coefficients: str | None = None
    coefficients_bearing: str | None = None
    stiffness: _StiffnessMatrix | None = None
    damping: _DampingMatrix | None = None
    mass: _MassMatrix | None = None
    elevation: Displacement = 0.0
    angle: Angle = 0.0
    pedestal: Pedestal | None = None
    damper: Damper | None = None
    ring: FloatingRing | None = None
    force: MachineForce | None = None

    def __post_init__(self) -> None:
        if self.pedestal is not None and self.damper is not None:
            raise InputError("goes without pedestal: remove one of them", key="damper")
        given = [
            key
            for key in ("bearing", "coefficients", "stiffness", "ring")
            if getattr(self, key) is not None
        ]
        if len(given) != 1:
            raise InputError(
                'needs one of bearing = "file.toml", coefficients = "file.csv", ring = {...} or '
                f"stiffness = ...{' (it has ' + ' and '.join(given) + ')' if given else ''}",
                key="bearing" if not given else given[1],
            )
        _check_companions(self, given[0])


def _check_companions(entry: Any, given: str) -> None:
    if given != "coefficients" and entry.coefficients_bearing is not None:
        raise InputError("goes with coefficients", key="coefficients_bearing")
    for key in ("damping", "mass"):
        if given != "stiffness" and getattr(entry, key) is not None:
            raise InputError(f"goes with stiffness, not with {given}", key=key)


@dataclass(frozen=True)
class SealEntry:
    """A seal or an impeller: acts on the motion, and carries no static load.

    at, name, coefficients, coefficients_bearing, stiffness, damping, mass : As for `SupportEntry`;
        a table is taken in the machine's frame.
    """

    at: Annotated[Place, Example("700 mm")]
    name: str = ""
    coefficients: str | None = None
    coefficients_bearing: str | None = None
    stiffness: _AnyStiffness | None = None
    damping: _DampingMatrix | None = None
    mass: _MassMatrix | None = None

    def __post_init__(self) -> None:
        given = [key for key in ("coefficients", "stiffness") if getattr(self, key) is not None]
        if len(given) == 2 or not (given or self.damping is not None or self.mass is not None):
            raise InputError(
                'needs one of coefficients = "file.csv" or stiffness = ...', key="coefficients"
            )
        _check_companions(self, given[0] if given else "stiffness")
