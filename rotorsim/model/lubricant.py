"""The oil: viscosity laws and thermal properties."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError

ZERO_CELSIUS = 273.15


@runtime_checkable
class ViscosityLaw(Protocol):
    """Dynamic viscosity as a function of temperature."""

    def viscosity(self, temperature: ArrayLike) -> NDArray[np.float64]:
        """Dynamic viscosity [Pa s] at `temperature` [K]."""
        ...

    def parameters(self) -> tuple[float, float, float, float]:
        """``(kind, a, b, c)`` for the compiled kernels; see `film.viscosity`."""
        ...


@dataclass(frozen=True)
class ExponentialViscosity:
    """mu = mu_0 exp(-beta (T - T_0)) (Dal Eq. 15, corrected: beta is in 1/K).

    Parameters
    ----------
    reference_viscosity : float
        mu_0 [Pa s].
    reference_temperature : float
        T_0 [K].
    temperature_coefficient : float
        beta [1/K]; 0 for a constant viscosity.

    Examples
    --------
    >>> law = ExponentialViscosity(0.0277, 313.15, 0.034)
    >>> round(float(law.viscosity(333.15)), 6)
    0.014033
    """

    reference_viscosity: float
    reference_temperature: float
    temperature_coefficient: float = 0.0

    def __post_init__(self) -> None:
        for name in ("reference_viscosity", "reference_temperature"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise InputError("must be above 0", key=f"lubricant.{name}", value=value)
        if not (math.isfinite(self.temperature_coefficient) and self.temperature_coefficient >= 0):
            raise InputError(
                "must be 0 or more",
                key="lubricant.viscosity_temperature_coefficient",
                value=self.temperature_coefficient,
            )

    def viscosity(self, temperature: ArrayLike) -> NDArray[np.float64]:
        """Dynamic viscosity [Pa s] at `temperature` [K]."""
        difference = np.asarray(temperature, dtype=float) - self.reference_temperature
        return self.reference_viscosity * np.exp(-self.temperature_coefficient * difference)

    def parameters(self) -> tuple[float, float, float, float]:
        """``(0, mu_0, T_0, beta)``."""
        return (
            0.0,
            self.reference_viscosity,
            self.reference_temperature,
            self.temperature_coefficient,
        )


@dataclass(frozen=True)
class WaltherViscosity:
    """log10 log10(nu + 0.7) = A - B log10 T, nu in mm2/s, T in K (ASTM D341).

    Parameters
    ----------
    intercept, slope : float
        A and B of the law.
    density : float
        [kg/m3]; dynamic viscosity is nu times this (constant) density.
    """

    intercept: float
    slope: float
    density: float

    @classmethod
    def from_points(
        cls,
        first: tuple[float, float],
        second: tuple[float, float],
        density: float,
    ) -> WaltherViscosity:
        """Through two points (temperature [K], dynamic viscosity [Pa s])."""
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
        """Oil of an ISO 3448 grade: `grade` mm2/s at 40 degC, at 100 degC from the viscosity index.

        The value at 100 degC solves ISO 2909 / ASTM D2270 procedure A, VI = 100 (L - U)/(L - H),
        with L and H its quadratic fits in the kinematic viscosity at 100 degC.
        """
        nu100 = _kinematic_at_100(grade, viscosity_index)
        return cls.from_points(
            (40.0 + ZERO_CELSIUS, grade * 1e-6 * density),
            (100.0 + ZERO_CELSIUS, nu100 * 1e-6 * density),
            density,
        )

    def viscosity(self, temperature: ArrayLike) -> NDArray[np.float64]:
        """Dynamic viscosity [Pa s] at `temperature` [K]."""
        log_t = np.log10(np.asarray(temperature, dtype=float))
        nu = 10.0 ** (10.0 ** (self.intercept - self.slope * log_t)) - 0.7
        return nu * 1e-6 * self.density

    def parameters(self) -> tuple[float, float, float, float]:
        """``(1, A, B, density)``."""
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
    """Kinematic viscosity at 100 degC [mm2/s] of an oil of `nu40` mm2/s and the given index."""
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

    Parameters
    ----------
    law : ViscosityLaw
    density : float
        [kg/m3]
    specific_heat : float
        [J/(kg K)]
    thermal_conductivity : float
        [W/(m K)]
    temperature_range : tuple of float
        Temperatures [K] between which the oil's law is trusted; outside a warning is given.
    """

    law: ViscosityLaw
    density: float
    specific_heat: float
    thermal_conductivity: float
    temperature_range: tuple[float, float] = (ZERO_CELSIUS - 20.0, ZERO_CELSIUS + 150.0)

    def __post_init__(self) -> None:
        for name in ("density", "specific_heat", "thermal_conductivity"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise InputError("must be above 0", key=f"lubricant.{name}", value=value)

    def viscosity(self, temperature: ArrayLike) -> NDArray[np.float64]:
        """Dynamic viscosity [Pa s] at `temperature` [K]."""
        return self.law.viscosity(temperature)
