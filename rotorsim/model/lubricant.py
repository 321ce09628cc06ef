"""The oil: viscosity laws and thermal properties."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass
from typing import Annotated, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..errors import InputError
from ..units import ZERO_CELSIUS
from .entries import Example, Leaf, Number, Quantity, Temperature, check

_LEAST_KINEMATIC = 0.35e-6
"""Below this [m2/s] the Walther law means nothing."""
SENSIBLE_VISCOSITY = (1e-7, 1e5)
"""Limits beyond which a law's viscosity [Pa s] shows that the law or a temperature is wrong."""
_TYPICAL = {"density": 860.0, "specific_heat": 2000.0, "thermal_conductivity": 0.13}
"""Of a mineral oil, SI: used where they do not enter (an isothermal film's forces)."""
_DynamicViscosity = Annotated[float, Quantity("dynamic viscosity")]
_Coefficient = Annotated[
    float, Quantity("temperature coefficient", "0.034 / delta_degC", "not_negative")
]
_Density = Annotated[float, Quantity("density", "860 kg/m^3")]
_SpecificHeat = Annotated[float, Quantity("specific heat")]
_Conductivity = Annotated[float, Quantity("thermal conductivity")]


@runtime_checkable
class ViscosityLaw(Protocol):
    """Dynamic viscosity as a function of temperature."""

    def viscosity(self, temperature: ArrayLike) -> Array:
        """Return the dynamic viscosity [Pa s] at `temperature` [K]."""
        ...

    def parameters(self) -> tuple[float, float, float, float]:
        """Return ``(kind, a, b, c)`` for the compiled kernels; see `film.viscosity`."""
        ...


@dataclass(frozen=True)
class ExponentialViscosity:
    """mu = mu_0 exp(-beta (T - T_0)) (Dal Eq. 15, corrected: beta is in 1/K).

    reference_viscosity : mu_0 [Pa s].
    reference_temperature : T_0 [K].
    temperature_coefficient : beta [1/K]; 0 for a constant viscosity.

    Examples
    --------
    >>> law = ExponentialViscosity(0.0277, 313.15, 0.034)
    >>> round(float(law.viscosity(333.15)), 6)
    0.014033
    """

    reference_viscosity: _DynamicViscosity
    reference_temperature: Temperature
    temperature_coefficient: _Coefficient = 0.0

    def __post_init__(self) -> None:
        check(self, "lubricant")

    def viscosity(self, temperature: ArrayLike) -> Array:
        """Return the dynamic viscosity [Pa s] at `temperature` [K]."""
        difference = np.asarray(temperature, dtype=float) - self.reference_temperature
        return self.reference_viscosity * np.exp(-self.temperature_coefficient * difference)

    def parameters(self) -> tuple[float, float, float, float]:
        """Return ``(0, mu_0, T_0, beta)``."""
        return (
            0.0,
            self.reference_viscosity,
            self.reference_temperature,
            self.temperature_coefficient,
        )


@dataclass(frozen=True)
class WaltherViscosity:
    """log10 log10(nu + 0.7) = A - B log10 T, nu in mm2/s, T in K (ASTM D341).

    intercept, slope : A and B of the law.
    density : [kg/m3]; dynamic viscosity is nu times this (constant) density.
    """

    intercept: float
    slope: float
    density: float

    @classmethod
    def from_points(
        cls, first: tuple[float, float], second: tuple[float, float], density: float
    ) -> WaltherViscosity:
        """Return the law through two points (temperature [K], dynamic viscosity [Pa s])."""
        (t1, mu1), (t2, mu2) = sorted((first, second))
        if not (t1 > 0 and t2 > t1 and mu1 > mu2 > 0 and density > 0):
            raise InputError(
                "needs two different temperatures, the viscosity falling from the colder to the "
                "hotter one, and a positive density",
                key="lubricant.viscosity",
                value=(first, second),
            )
        y1, y2 = (math.log10(math.log10(mu / density * 1e6 + 0.7)) for mu in (mu1, mu2))
        slope = (y1 - y2) / (math.log10(t2) - math.log10(t1))
        return cls(intercept=y1 + slope * math.log10(t1), slope=slope, density=density)

    @classmethod
    def from_iso_vg(
        cls, grade: float, density: float, viscosity_index: float = 100.0
    ) -> WaltherViscosity:
        """Return oil of an ISO 3448 grade.

        `grade` mm2/s at 40 degC, at 100 degC from the viscosity index.

        The value at 100 degC solves ISO 2909 / ASTM D2270 procedure A, VI = 100 (L - U)/(L - H),
        with L and H its quadratic fits in the kinematic viscosity at 100 degC.
        """
        nu100 = _kinematic_at_100(grade, viscosity_index)
        return cls.from_points(
            (40.0 + ZERO_CELSIUS, grade * 1e-6 * density),
            (100.0 + ZERO_CELSIUS, nu100 * 1e-6 * density),
            density,
        )

    def viscosity(self, temperature: ArrayLike) -> Array:
        """Return the dynamic viscosity [Pa s] at `temperature` [K]."""
        log_t = np.log10(np.asarray(temperature, dtype=float))
        nu = 10.0 ** (10.0 ** (self.intercept - self.slope * log_t)) - 0.7
        return nu * 1e-6 * self.density

    def parameters(self) -> tuple[float, float, float, float]:
        """Return ``(1, A, B, density)``."""
        return (1.0, self.intercept, self.slope, self.density)


# ASTM D2270 table 1 / ISO 2909 annex: L = a Y^2 + b Y + c, H = d Y^2 + e Y + f, Y = nu at 100 degC.
_D2270 = (
    (2.0, 3.8, 1.14673, 1.7576, -0.109, 0.84155, 1.5521, -0.077),
    (3.8, 4.4, 3.38095, -15.4952, 33.196, 0.78571, 1.7929, -0.183),
    (4.4, 5.0, 2.5, -7.2143, 13.812, 0.82143, 1.5679, 0.119),
    (5.0, 6.4, 0.101, 16.635, -45.469, 0.04985, 9.1613, -18.557),
    (6.4, 7.0, 3.35714, -23.5643, 78.466, 0.22619, 7.7369, -16.656),
    (7.0, 7.7, 0.01191, 21.475, -72.870, 0.79762, -0.7321, 14.61),
    (7.7, 9.0, 0.41858, 16.1558, -56.040, 0.05794, 10.5156, -28.240),
    (9.0, 12.0, 0.88779, 7.5527, -16.6, 0.26665, 6.7015, -10.81),
    (12.0, 15.0, 0.76720, 10.7972, -38.18, 0.20073, 8.4658, -22.49),
    (15.0, 18.0, 0.97305, 5.3135, -2.2, 0.28889, 5.9741, -4.93),
    (18.0, 22.0, 0.97256, 5.25, -0.98, 0.24504, 7.4160, -16.73),
    (22.0, 28.0, 0.91413, 7.4759, -21.82, 0.20323, 9.1267, -34.23),
    (28.0, 40.0, 0.87031, 9.7157, -50.77, 0.18411, 10.1015, -46.75),
    (40.0, 55.0, 0.84703, 12.6752, -133.31, 0.17029, 11.4866, -80.62),
    (55.0, 70.0, 0.85921, 11.1009, -83.19, 0.17130, 11.3680, -76.94),
    (70.0, 1e9, 0.83531, 14.6731, -216.246, 0.16841, 11.8493, -96.947),
)


def _kinematic_at_100(nu40: float, viscosity_index: float) -> float:
    """Return kinematic viscosity at 100 degC [mm2/s] from `nu40` [mm2/s] and the index."""
    if not (nu40 > 5.0 and math.isfinite(nu40)):
        raise InputError("must be above 5 (mm2/s at 40 °C)", key="lubricant.iso_vg", value=nu40)
    if not 0.0 <= viscosity_index <= 100.0:
        raise InputError(
            "must be 0 to 100 (give two viscosity points for oils outside)",
            key="lubricant.viscosity_index",
            value=viscosity_index,
        )

    def excess(y: float) -> float:
        row = next(r for r in _D2270 if y < r[1])
        low = row[2] * y * y + row[3] * y + row[4]
        high = row[5] * y * y + row[6] * y + row[7]
        return low - viscosity_index / 100.0 * (low - high) - nu40

    lower, upper = 2.0, 70.0 + nu40
    for _ in range(200):
        middle = 0.5 * (lower + upper)
        lower, upper = (middle, upper) if excess(middle) < 0.0 else (lower, middle)
    return 0.5 * (lower + upper)


@dataclass(frozen=True)
class Lubricant:
    """An oil.

    density : [kg/m3]
    specific_heat : [J/(kg K)]
    thermal_conductivity : [W/(m K)]
    temperature_range : Temperatures [K] between which the oil's law is trusted; outside a warning
        is given.
    """

    law: ViscosityLaw
    density: _Density
    specific_heat: _SpecificHeat
    thermal_conductivity: _Conductivity
    temperature_range: tuple[float, float] = (ZERO_CELSIUS - 20.0, ZERO_CELSIUS + 150.0)

    def __post_init__(self) -> None:
        check(self, "lubricant")

    def viscosity(self, temperature: ArrayLike) -> Array:
        """Return the dynamic viscosity [Pa s] at `temperature` [K]."""
        return self.law.viscosity(temperature)

    @property
    def varies_with_temperature(self) -> bool:
        """Return whether the film's temperature matters to its viscosity."""
        law = self.law
        return not (isinstance(law, ExponentialViscosity) and law.temperature_coefficient == 0.0)


class Viscosity(NamedTuple):
    """A viscosity as it is written: dynamic [Pa s], or kinematic [m2/s]."""

    value: float
    is_kinematic: bool = False

    def dynamic(self, density: float) -> float:
        """Return the dynamic viscosity [Pa s] of an oil of that density [kg/m3]."""
        return self.value * density if self.is_kinematic else self.value


class _ViscosityEntry(Leaf):
    """Text with a unit of dynamic or kinematic viscosity."""

    kind = "dynamic viscosity"

    def read(self, value: object) -> Viscosity:
        try:
            return Viscosity(Quantity("dynamic viscosity", "0.0277 Pa*s").read(value))
        except InputError as refusal:
            with suppress(InputError):
                return Viscosity(Quantity("kinematic viscosity", "32 cSt").read(value), True)
            raise refusal from None


_Viscosity = Annotated[Viscosity, _ViscosityEntry()]
_Point = tuple[Temperature, _Viscosity]


def oil(
    *,
    viscosity: Annotated[_Viscosity | None, Example("0.0277 Pa*s")] = None,
    reference_temperature: Temperature | None = None,
    viscosity_temperature_coefficient: _Coefficient | None = None,
    iso_vg: Annotated[float, Number(above=5.0, most=5000.0, hint="for example 32")] | None = None,
    viscosity_index: Annotated[
        float,
        Number(
            least=0.0,
            most=100.0,
            hint="it lies from 0 to 100; give viscosity_points for other oils",
        ),
    ]
    | None = None,
    viscosity_points: tuple[_Point, _Point] | None = None,
    density: _Density | None = None,
    specific_heat: _SpecificHeat | None = None,
    thermal_conductivity: _Conductivity | None = None,
) -> Lubricant:
    """Make an oil from exactly one description of its viscosity.

    viscosity : With `reference_temperature` [K] and `viscosity_temperature_coefficient` [1/K] where
        it is not constant.
    iso_vg : ISO grade, with `viscosity_index` (100).
    viscosity_points : pair of (temperature [K], Viscosity). Two points of the Walther law.
    density, specific_heat, thermal_conductivity : Typical ones (`_TYPICAL`) by default, where the
        viscosity needs no density.
    Raises InputError: No description or two, or one that lacks something.
    """
    described = {"viscosity": viscosity, "iso_vg": iso_vg, "viscosity_points": viscosity_points}
    given = [name for name, value in described.items() if value is not None]
    if len(given) != 1:
        found = "none is given" if not given else f"given are {' and '.join(given)}"
        raise InputError(
            "needs exactly one description of the viscosity: viscosity (with "
            "reference_temperature and viscosity_temperature_coefficient), iso_vg or "
            f"viscosity_points; {found}; for example iso_vg = 32",
            key="lubricant" if not given else f"lubricant.{given[1]}",
        )
    companions = {
        "viscosity_index": (viscosity_index, "iso_vg"),
        "reference_temperature": (reference_temperature, "viscosity"),
        "viscosity_temperature_coefficient": (viscosity_temperature_coefficient, "viscosity"),
    }
    for name, (value, partner) in companions.items():
        if value is not None and partner != given[0]:
            raise InputError(
                f"goes with lubricant.{partner}, not with lubricant.{given[0]}; remove it",
                key=f"lubricant.{name}",
            )
    if viscosity is not None:
        law: ViscosityLaw = _exponential(
            viscosity, reference_temperature, viscosity_temperature_coefficient, density
        )
    else:
        known = _needed(density, "density", f"{given[0]} needs it", "860 kg/m^3")
        if iso_vg is not None:
            index = 100.0 if viscosity_index is None else viscosity_index
            law = WaltherViscosity.from_iso_vg(iso_vg, known, index)
        else:
            assert viscosity_points is not None
            law = _through(viscosity_points, known)
    return Lubricant(
        law,
        density=density or _TYPICAL["density"],
        specific_heat=specific_heat or _TYPICAL["specific_heat"],
        thermal_conductivity=thermal_conductivity or _TYPICAL["thermal_conductivity"],
    )


def _exponential(
    viscosity: Viscosity, reference: float | None, coefficient: float | None, density: float | None
) -> ExponentialViscosity:
    mu = viscosity.value
    if viscosity.is_kinematic:
        known = _needed(density, "density", "a kinematic viscosity needs it", "860 kg/m^3")
        mu = viscosity.dynamic(known)
    if coefficient:
        reference = _needed(
            reference, "reference_temperature", "the coefficient starts from it", "40 degC"
        )
    # a constant viscosity has no use of a reference
    return ExponentialViscosity(mu, reference or 313.15, coefficient or 0.0)


def _through(points: tuple[_Point, _Point], density: float) -> WaltherViscosity:
    first, second = ((temperature, mu.dynamic(density)) for temperature, mu in points)
    for index, (_, mu) in enumerate((first, second)):
        if mu / density < _LEAST_KINEMATIC:
            raise InputError(
                f"is too thin for the Walther law (kinematic viscosity {mu / density * 1e6:.3g} "
                f"mm2/s, at least {_LEAST_KINEMATIC * 1e6:g} is needed)",
                key=f"lubricant.viscosity_points[{index}]",
            )
    try:
        return WaltherViscosity.from_points(first, second, density)
    except InputError as error:
        raise InputError(error.message, key="lubricant.viscosity_points") from None


def _needed(value: float | None, name: str, reason: str, example: str) -> float:
    if value is None:
        raise InputError(
            f'is missing: {reason}; write for example {name} = "{example}"', key=f"lubricant.{name}"
        )
    return value
