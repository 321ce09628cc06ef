"""One operating point: what the film solver hands to everything that follows."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array, Booleans, ComplexArray, Indices
from ..model import Case, EccentricityTarget, LoadTarget
from ..status import SolveStatus, Stability

if TYPE_CHECKING:
    from ..film.heat import HeatBalance


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
    turbulence : (n, m) array
        0 where the film is laminar, 1 where it is turbulent, between in the transition.
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
    turbulence: Array


@dataclass(frozen=True)
class FrequencyCoefficients:
    """Stiffness and damping over the whirl frequency, load frame.

    frequency_ratio : (n,) array. Whirl frequency over shaft frequency, ascending.
    stiffness, damping : (n, 2, 2) arrays [N/m], [N s/m]
    """

    frequency_ratio: Array
    stiffness: Array
    damping: Array


@dataclass(frozen=True)
class FullCoefficients:
    """K, C and M over all degrees of freedom of a bearing, load frame.

    names : Degrees of freedom: x, y [m]; theta_x, theta_y, the journal's rotations about x and y
        through the bearing's mid-plane [rad]. Then of each loaded pad, counted from 1, tilt_1
        [rad], and where its pivot has them pivot_1 (outwards) [m] and pitch_1 [rad]; of a pad that
        bends bend_1_1 to bend_1_4 [m].
    stiffness, damping, mass : (q, q) arrays. K_ij = -dQ_i/dq_j, C_ij = -dQ_i/dq_j-dot, Q the film's
        forces [N] and moments [N m] on journal and pads, and the pivots' on the pads. The mass is
        the pads' own.
    """

    names: tuple[str, ...]
    stiffness: Array
    damping: Array
    mass: Array

    def reduced(self, s: complex) -> ComplexArray:
        """Return force per displacement of the journal moving as exp(s t), (2, 2) or (4, 4)."""
        law = self.stiffness + s * self.damping + s * s * self.mass
        return condensed(law, 4 if _ROTATION in self.names else 2)


_ROTATION = "theta_x"
"""Name of the journal's rotation about x; it is there with its fellow or not at all."""


def condensed(law: ComplexArray, kept: int) -> ComplexArray:
    """Eliminate all unknowns but the first `kept`, on which alone forces act."""
    if law.shape[-1] == kept:
        return law
    own = np.linalg.solve(law[..., kept:, kept:], law[..., kept:, :kept])
    return np.asarray(law[..., :kept, :kept] - law[..., :kept, kept:] @ own)


def kept_throughout(speeds: Array, matrices: Array) -> tuple[Indices, Array]:
    """Keep the unknowns that all points have; eliminate the others at the shaft's frequency.

    speeds : (n,) array [rad/s]
    matrices : (3, n, q, q) array. K, C and M of each point, NaN in the rows and columns of what it
        has not.

    Returns the places of the unknowns kept, (k,), and their matrices (3, n, k, k).
    """
    moving: Booleans = np.isfinite(np.diagonal(matrices[0], axis1=1, axis2=2))
    stays = np.asarray(moving.all(axis=0), dtype=bool)
    own = np.flatnonzero(stays)
    kept = matrices[:, :, own[:, None], own].copy()
    for place, speed in enumerate(speeds):
        gone = np.flatnonzero(np.asarray(moving[place] & ~stays, dtype=bool))
        if not gone.size:
            continue
        order = np.concatenate([own, gone])
        k, c, m = matrices[:, place, order[:, None], order]
        s = 1j * float(speed)
        law = k + s * c + s * s * m
        change = condensed(law, own.size) - law[: own.size, : own.size]
        kept[0, place] += change.real
        kept[1, place] += change.imag / float(speed)
    return own, kept


@dataclass(frozen=True)
class PadResult:
    """One tilting pad at its equilibrium.

    tilt : In the direction of rotation [rad].
    pivot_displacement : Outwards [m]; 0 for a rigid pivot.
    pitch : About the tangent at the pivot [rad].
    load : Force on the pivot [N].
    max_pressure : Gauge [Pa].
    max_temperature : Of the pad's surface [K]; isothermal: the supply's.
    inlet_temperature : Of the oil that enters its film [K].
    inlet_fraction : Part of its leading edge that is full of oil: below 1 the pad is starved.
    hot_radial_clearance, hot_preload : When hot, machined [m]; with thermal expansion only.
    deflection : By which the film's pressure bends an edge away from the journal, the larger [m].
    unloaded : Its film cannot be balanced at positive pressure: the pad floats or flutters. It is
        kept out of the equilibrium and the coefficients; its tilt is arbitrary.
    """

    tilt: float
    pivot_displacement: float
    pitch: float
    load: float
    max_pressure: float
    max_temperature: float
    inlet_temperature: float
    inlet_fraction: float
    unloaded: bool
    hot_radial_clearance: float | None = None
    hot_preload: float | None = None
    deflection: float = 0.0


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
        e over `running_clearance`.
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
        Out of both ends, those of grooves that are not sealed included [m3/s].
    min_film_thickness : float
        [m]
    stiffness, damping : (2, 2) arrays
        K_ij = -dF_i/dx_j [N/m], C_ij = -dF_i/dv_j [N s/m], F on the journal, load frame.
    coefficient_frequency_ratio : float or None
        Whirl frequency over shaft frequency at which they hold; None: at any. Oil stored in a
        mass-conserving film, or a bore that gives way, makes them depend on it: they are given at
        the threshold's whirl frequency, and at half the shaft's where there is no threshold.
    frequency_coefficients : FrequencyCoefficients or None
        Stiffness and damping at the ratios of ``film.frequency_ratio``.
    supply_flow : tuple of float
        Oil that each groove must be given [m3/s], in the order of the grooves: what leaves it less
        what arrives from the film before it.
    groove_pressure : tuple of float
        In each groove, gauge [Pa]; where restrictors feed them.
    moment : (2,) array
        M_x and M_y of the film on the journal about the bearing's mid-plane [N m]; 0 where both
        halves are alike.
    coefficients_full : FullCoefficients or None
        Tilting pads: K, C and M over journal and pads, of which `stiffness` and `damping` are the
        reduction at the shaft's frequency. Where asked for (``film.rotations``), also over the
        journal's rotations; with ``viscosity_response = following`` the rotations are still at
        frozen viscosity.
    pads : tuple of PadResult
        Empty without tilting pads.
    critical_mass : float or None
        Per bearing [kg]; with pads that of rotor and pads together.
    critical_mass_synchronous : float or None
        With pads, what `stiffness` and `damping` alone would give.
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
    heat_imbalance : float or None
        Heat unaccounted for, relative to the dissipation; THD only.
    shaft_temperature : float or None
        Of the journal's surface [K].
    hot_radial_clearance : float or None
        Clearance that the hot solids leave [m], `radial_clearance` being the cold one; with pads
        their mean machined one. With thermal expansion only.
    hot_preload : float or None
        1 - (assembled clearance)/(machined clearance) when hot, the mean of the pads or of the
        lobes.
    deflection : float or None
        Largest deflection of pads or bore under the film's pressure [m]; None where they are rigid.
    deformation_response : str or None
        ``following`` or ``frozen``: what that shape does in K and C; None where they are rigid.
    outlet_temperature : float or None
        Mean of the oil that leaves at both ends [K]: supply temperature plus the heat that the oil
        carries off over rho c_p times the side flow. THD with ``inlet = mixing`` only: otherwise
        warm oil also leaves where fresh oil replaces it.
    reynolds_number : float
        Largest local rho U h/mu, mu the mean 1/F_0 across the film, laminar.
    laminar_share, transitional_share, turbulent_share : float
        Parts of the film's area by its flow; (1, 0, 0) with ``film.flow = laminar``.
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
    heat_imbalance: float | None = None
    shaft_temperature: float | None = None
    hot_radial_clearance: float | None = None
    hot_preload: float | None = None
    deflection: float | None = None
    deformation_response: str | None = None
    outlet_temperature: float | None = None
    coefficient_frequency_ratio: float | None = None
    frequency_coefficients: FrequencyCoefficients | None = None
    supply_flow: tuple[float, ...] = ()
    groove_pressure: tuple[float, ...] = ()
    moment: Array = field(default_factory=lambda: np.full(2, math.nan))
    coefficients_full: FullCoefficients | None = None
    pads: tuple[PadResult, ...] = ()
    critical_mass_synchronous: float | None = None
    reynolds_number: float = math.nan
    laminar_share: float = math.nan
    transitional_share: float = math.nan
    turbulent_share: float = math.nan
    fields: FilmFields | None = field(default=None, repr=False)

    @property
    def converged(self) -> bool:
        """Return whether the numbers may be used."""
        return self.status is SolveStatus.CONVERGED

    @property
    def running_clearance(self) -> float:
        """Radial clearance in which the journal runs, hot where it is known [m]."""
        hot = self.hot_radial_clearance
        return self.radial_clearance if hot is None else hot

    def __repr__(self) -> str:
        from .description import point_line

        return f"<OperatingPoint: {point_line(self)}>"

    def _repr_html_(self) -> str:
        from .description import point_html

        return point_html(self)


_NESTED = ("heat_balance", "frequency_coefficients", "coefficients_full")


def point_to_dict(point: OperatingPoint) -> dict[str, Any]:
    """Return every scalar and coefficient of `point` (SI); the fields are left out.

    Returns: Keys are the attribute names of `OperatingPoint`; enumerations as their values, arrays
        as nested lists.
    """
    record: dict[str, Any] = {}
    for entry in dataclasses.fields(point):
        if entry.name == "fields":
            continue
        value = getattr(point, entry.name)
        if value is not None and entry.name in _NESTED:
            value = dataclasses.asdict(value)
        elif entry.name == "pads":
            value = [dataclasses.asdict(pad) for pad in point.pads]
        record[entry.name] = plain(value)
    return record


def point_from_dict(record: Mapping[str, Any]) -> OperatingPoint:
    """Return the inverse of `point_to_dict`.

    Raises KeyError, TypeError, ValueError: If `record` was not made by `point_to_dict`.
    """
    from ..film.heat import HeatBalance  # with its compiled kernels: not to be loaded for a table

    values = dict(record)
    values["status"] = SolveStatus(values["status"])
    values["stability"] = None if values["stability"] is None else Stability(values["stability"])
    for name in ("stiffness", "damping"):
        values[name] = np.array(values[name], dtype=float).reshape(2, 2)
    for name in ("warnings", "supply_flow", "groove_pressure"):
        values[name] = tuple(values.get(name, ()))
    if values["heat_balance"] is not None:
        values["heat_balance"] = HeatBalance(**values["heat_balance"])
    if values.get("frequency_coefficients") is not None:
        arrays = values["frequency_coefficients"].items()
        values["frequency_coefficients"] = FrequencyCoefficients(
            **{name: np.array(value, dtype=float) for name, value in arrays}
        )
    if "moment" in values:
        values["moment"] = np.array(values["moment"], dtype=float).reshape(2)
    if values.get("coefficients_full") is not None:
        full = dict(values["coefficients_full"])
        names = tuple(full.pop("names"))
        matrices = {name: np.array(value, dtype=float) for name, value in full.items()}
        values["coefficients_full"] = FullCoefficients(names, **matrices)
    values["pads"] = tuple(PadResult(**pad) for pad in values.get("pads", ()))
    return OperatingPoint(**values)


def failed_point(
    case: Case, speed: float, message: str, status: SolveStatus = SolveStatus.FAILED
) -> OperatingPoint:
    """Return the point without numbers: all that the case does not give is NaN."""
    nan, target = math.nan, case.target
    given = target.eccentricity_ratio if isinstance(target, EccentricityTarget) else nan
    return OperatingPoint(
        status=status,
        message=message,
        thermal_model=case.thermal.model.value,
        cavitation=case.film.cavitation.value,
        speed=speed,
        radial_clearance=case.bearing.radial_clearance,
        eccentricity_ratio=given,
        attitude_angle=nan,
        load=target.load if isinstance(target, LoadTarget) else nan,
        sommerfeld_number=nan,
        max_pressure=nan,
        max_temperature=nan,
        mean_temperature=nan,
        friction_force=nan,
        power_loss=nan,
        side_flow=nan,
        min_film_thickness=nan,
        stiffness=np.full((2, 2), nan),
        damping=np.full((2, 2), nan),
        critical_mass=None,
        critical_mass_dimensionless=None,
        whirl_frequency_ratio=None,
        stability=None,
        iterations=0,
        residual=nan,
    )


def plain(value: Any) -> Any:
    """Return `value` with numpy, enumerations, paths and tuples as JSON knows them."""
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, Mapping):
        return {str(plain(key)): plain(entry) for key, entry in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, complex):
        return [plain(value.real), plain(value.imag)]
    if isinstance(value, (list, tuple)):
        return [plain(entry) for entry in value]
    return str(value) if isinstance(value, Path) else value


def strict_json(value: Any, *, indent: int | None = 2) -> str:
    """Return the JSON text of `value`; NaN and infinities become null, dates text.

    Examples
    --------
    >>> strict_json({"a": (1.5, float("nan"))}, indent=None)
    '{"a": [1.5, null]}'
    """
    text = json.dumps(
        _finite(plain(value)), indent=indent, allow_nan=False, ensure_ascii=False, default=str
    )
    return text.encode("utf-8", "backslashreplace").decode()  # names of files may not be text


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _finite(entry) for key, entry in value.items()}
    return [_finite(entry) for entry in value] if isinstance(value, list) else value
