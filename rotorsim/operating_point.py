"""One operating point: what the film solver hands to everything that follows."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .status import SolveStatus, Stability

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FilmFields:
    """Fields of the film over the whole bearing, in the load frame.

    Attributes
    ----------
    theta : (n,) array
        Cell centres [rad], ascending within one turn from the film's first cell (they may pass
        2 pi); from the load line in the direction of rotation.
    y : (m,) array
        Cell centres [m], -L/2 to L/2.
    z : (k,) array
        Cell centres across the film, 0 (bush) to 1 (journal).
    film_thickness : (n, m) array
        [m]
    pressure : (n, m) array
        Gauge [Pa].
    liquid_fraction : (n, m) array
        1 in the full film, below 1 where it is ruptured.
    temperature : (n, m, k) array
        [K]
    viscosity : (n, m, k) array
        [Pa s]
    bush_temperature : (n, m) array
        Of the bore [K].
    shaft_temperature : float
        Of the journal's surface [K].
    """

    theta: Array
    y: Array
    z: Array
    film_thickness: Array
    pressure: Array
    liquid_fraction: Array
    temperature: Array
    viscosity: Array
    bush_temperature: Array
    shaft_temperature: float


@dataclass(frozen=True)
class HeatBalance:
    """Where the friction's power goes [W]; `imbalance` is the relative remainder."""

    dissipation: float
    enthalpy_out: float
    to_bush: float
    to_shaft: float

    @property
    def imbalance(self) -> float:
        """(dissipation - enthalpy - bush - shaft)/dissipation [-]."""
        rest = self.dissipation - self.enthalpy_out - self.to_bush - self.to_shaft
        return rest / self.dissipation if self.dissipation else 0.0

    @property
    def wall_share(self) -> float:
        """(bush + shaft)/dissipation [-]: what the oil does not carry off."""
        return (self.to_bush + self.to_shaft) / self.dissipation if self.dissipation else 0.0


@dataclass(frozen=True)
class OperatingPoint:
    """Static results, coefficients and the rigid rotor's verdict at one speed (SI, load frame).

    Attributes
    ----------
    status : SolveStatus
        Read it first; with anything but ``converged`` the numbers are the last iterate, or NaN.
    message : str
        What went wrong and what to try; empty when converged.
    thermal_model, cavitation : str
    speed : float
        [rad/s]
    radial_clearance : float
        [m]
    eccentricity_ratio : float
    attitude_angle : float
        From the load line to the journal's centre, in the direction of rotation [rad].
    load : float
        Magnitude [N].
    sommerfeld_number : float
        S = mu N L D (R/c)^2/W, N in rev/s, mu at supply temperature.
    max_pressure : float
        Gauge [Pa].
    max_temperature, mean_temperature : float
        Of the film [K].
    friction_force : float
        On the shaft [N].
    power_loss : float
        [W]
    side_flow : float
        Out of both ends [m3/s].
    min_film_thickness : float
        [m]
    stiffness, damping : (2, 2) arrays
        K_ij = -dF_i/dx_j [N/m], C_ij = -dF_i/dv_j [N s/m], F on the journal, load frame.
    critical_mass : float or None
        Per bearing [kg].
    critical_mass_dimensionless : float or None
        M c omega^2/W.
    whirl_frequency_ratio : float or None
    stability : Stability
    iterations : int
    residual : float
        Last change of log viscosity (THD), or relative force residual.
    warnings : tuple of str
        Where the model leaves its range.
    heat_balance : HeatBalance or None
        THD only.
    outlet_temperature : float or None
        Mean of the oil that leaves at both ends [K]: supply temperature plus the heat that the oil
        carries off over rho c_p times the side flow. THD with ``inlet = mixing`` only: otherwise
        warm oil also leaves where fresh oil replaces it.
    fields : FilmFields or None
    """

    status: SolveStatus
    message: str
    thermal_model: str
    cavitation: str
    speed: float
    radial_clearance: float
    eccentricity_ratio: float
    attitude_angle: float
    load: float
    sommerfeld_number: float
    max_pressure: float
    max_temperature: float
    mean_temperature: float
    friction_force: float
    power_loss: float
    side_flow: float
    min_film_thickness: float
    stiffness: Array
    damping: Array
    critical_mass: float | None
    critical_mass_dimensionless: float | None
    whirl_frequency_ratio: float | None
    stability: Stability | None
    iterations: int
    residual: float
    warnings: tuple[str, ...] = ()
    heat_balance: HeatBalance | None = None
    outlet_temperature: float | None = None
    fields: FilmFields | None = field(default=None, repr=False)

    @property
    def converged(self) -> bool:
        """Whether the numbers may be used."""
        return self.status is SolveStatus.CONVERGED

    def _repr_html_(self) -> str:
        from .display import as_html

        return as_html(self)
