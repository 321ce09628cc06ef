"""Stability of a table's curves over speed, for one rotor."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..bearing.interpolation import Coefficients
from ..machine.modes import Branches, ThresholdSpeed
from ..machine.over_speed import (
    JeffcottShaft,
    RigidShaft,
    RotorOnFilm,
    rotor_modes,
    rotor_thresholds,
)
from ..model.rotor import JeffcottRotor, Rotor
from .wording import number

if TYPE_CHECKING:
    from ..bearing.table import CoefficientTable
    from ..machine.map import StabilityMap
    from ..machine.over_speed import RotorOnFilm


def rotor_on_film(rotor: Rotor | None) -> RotorOnFilm | None:
    """Rotor of a scenario for the linear analyses; None without one."""
    if rotor is None:
        return None
    if isinstance(rotor, JeffcottRotor):
        return JeffcottShaft(
            rotor.disc_mass, rotor.shaft_stiffness, rotor.journal_mass, rotor.disc_damping
        )
    return RigidShaft(rotor.mass)


def rotor_words(rotor: RotorOnFilm | None) -> str:
    """``rotor of 1200 kg per bearing``, ``Jeffcott rotor``; empty without one."""
    if rotor is None:
        return ""
    if isinstance(rotor, RigidShaft):
        return f"rotor of {number(rotor.mass)} kg per bearing"
    return "Jeffcott rotor" if isinstance(rotor, JeffcottShaft) else "rotor of your matrices"


Array = NDArray[np.float64]


@dataclass(frozen=True)
class StabilityCurve:
    """A rotor on one bearing with one thermal model, over the tabulated speeds (SI).

    Attributes
    ----------
    choices : dict
        ``thermal_model``, ``radial_clearance`` [m], and any further dimension of the table.
    speed : (n,) array
        [rad/s]
    stability : (n,) array of str
        Verdict on the critical mass; empty where the point did not converge.
    critical_mass, critical_mass_dimensionless, whirl_frequency_ratio : (n,) arrays
        Of a rigid rotor; NaN without a threshold.
    rotor : str
        In words; empty without a rotor.
    mass : float or None
        Per bearing, of a rigid rotor [kg].
    eigenvalues : (n, k) complex array or None
        Of the rotor [1/s], falling real part.
    threshold_speeds : tuple of float
        Speeds at which that rotor turns from stable to unstable or back [rad/s].
    """

    choices: dict[str, Any]
    speed: Array
    stability: NDArray[np.str_]
    critical_mass: Array
    critical_mass_dimensionless: Array
    whirl_frequency_ratio: Array
    rotor: str = ""
    mass: float | None = None
    eigenvalues: NDArray[np.complex128] | None = None
    threshold_speeds: tuple[float, ...] = ()

    @property
    def growth_rate(self) -> Array | None:
        """Largest real part of the eigenvalues, above 0 where unstable [1/s]; None: no rotor."""
        return None if self.eigenvalues is None else self.eigenvalues[:, 0].real


@dataclass(frozen=True)
class MapPlane:
    """Stability map of one clearance: growth rates over speed and mass.

    Attributes
    ----------
    radial_clearance : float
        [m]
    speed : (n,) array
        [rad/s]
    mass : (m,) array
        Per bearing [kg].
    isothermal_growth, heated_growth : (n, m) arrays
        Above 0 where unstable, NaN where unknown [1/s]. With one thermal model in the
        table both are its.
    """

    radial_clearance: float
    speed: Array
    mass: Array
    isothermal_growth: Array
    heated_growth: Array


def map_planes(chart: StabilityMap) -> list[MapPlane]:
    """Planes of a map, one for each clearance."""
    dataset = chart.dataset
    models = [str(model) for model in dataset["thermal_model"].values]
    cold = models.index("isothermal") if "isothermal" in models else 0
    hot = models.index("thd") if "thd" in models else len(models) - 1
    planes = []
    for place, clearance in enumerate(dataset["radial_clearance"].values):
        rate = dataset["growth_rate"].isel(radial_clearance=place)
        growth = rate.transpose("thermal_model", "speed", "mass").values
        planes.append(
            MapPlane(
                radial_clearance=float(clearance),
                speed=dataset["speed"].values,
                mass=dataset["mass"].values,
                isothermal_growth=growth[cold],
                heated_growth=growth[hot],
            )
        )
    return planes


def stability_curves(
    table: CoefficientTable, rotor: RotorOnFilm | float | None = None
) -> list[StabilityCurve]:
    """Curves of every thermal model and clearance in `table`.

    Parameters
    ----------
    table : CoefficientTable
    rotor : RotorOnFilm or float, optional
        A number is the mass of a rigid rotor per bearing [kg].
    """
    from ..machine.over_speed import RigidShaft

    if isinstance(rotor, (int, float)):
        rotor = RigidShaft(float(rotor))
    values = {name: table.dataset[name].values for name in table.choices}
    combinations = itertools.product(*(enumerate(column) for column in values.values()))
    curves = []
    for combination in combinations:
        index = tuple(place for place, _ in combination)
        choices = {
            name: value if isinstance(value, str) else float(value)
            for name, (_, value) in zip(values, combination, strict=True)
        }
        curves.append(_curve(table, index, choices, rotor))
    return curves


def _curve(
    table: CoefficientTable,
    index: tuple[int, ...],
    choices: dict[str, Any],
    rotor: RotorOnFilm | None,
) -> StabilityCurve:
    from ..bearing.whirl import rigid_thresholds
    from ..machine.over_speed import RigidShaft

    usable = table.converged[index]
    blank = np.where(usable, 1.0, np.nan)[:, None, None]
    stiffness, damping = table.stiffness[index] * blank, table.damping[index] * blank
    load = table.dataset["load"].values[index] if "load" in table.dataset else None
    found = rigid_thresholds(
        stiffness,
        damping,
        table.speeds,
        load=load,
        radial_clearance=choices["radial_clearance"],
    )
    return StabilityCurve(
        choices=choices,
        speed=table.speeds,
        stability=found.stability,
        critical_mass=found.critical_mass,
        critical_mass_dimensionless=found.critical_mass_dimensionless,
        whirl_frequency_ratio=found.whirl_frequency_ratio,
        rotor=rotor_words(rotor),
        mass=rotor.mass if isinstance(rotor, RigidShaft) else None,
        eigenvalues=(
            None if rotor is None else _eigenvalues(rotor, stiffness, damping, table.speeds)
        ),
        threshold_speeds=() if rotor is None else _thresholds(table, choices, rotor),
    )


def _eigenvalues(
    rotor: RotorOnFilm, stiffness: Array, damping: Array, speeds: Array
) -> NDArray[np.complex128]:
    """(n, k), each row by falling real part; NaN where K or C is."""
    from ..machine.over_speed import RigidShaft
    from ..machine.rates import eigenvalues

    values: NDArray[np.complex128]
    if isinstance(rotor, RigidShaft):
        values = eigenvalues(stiffness, damping, rotor.mass)
    else:
        rows = [
            np.linalg.eigvals(rotor.state_matrix(Coefficients(k, c, float(speed))))
            if np.all(np.isfinite(k)) and np.all(np.isfinite(c))
            else None
            for k, c, speed in zip(stiffness, damping, speeds, strict=True)
        ]
        size = max((row.size for row in rows if row is not None), default=0)
        gap = np.full(size, complex(np.nan, np.nan))
        values = np.array([gap if row is None else row for row in rows], dtype=complex)
    order = np.argsort(-values.real, axis=1, kind="stable")
    return np.take_along_axis(values, order, axis=1)


def _thresholds(
    table: CoefficientTable, choices: dict[str, Any], rotor: RotorOnFilm
) -> tuple[float, ...]:
    from ..machine.over_speed import converged_speeds, rotor_thresholds

    if converged_speeds(table, **choices).size < 2:
        return ()
    return tuple(one.speed for one in rotor_thresholds(table, rotor, **choices))


FORWARD = 0.1
"""Ratio of areas, orbit to circle, above which a whirl counts as forward (or backward)."""


@dataclass(frozen=True, eq=False)
class Campbell:
    """Modes of a rotor over speed on one curve of a table (SI).

    Attributes
    ----------
    choices : dict
        ``thermal_model``, ``radial_clearance`` [m], and any further dimension of the table.
    branches : Branches
        The oscillating ones of lowest frequency.
    sense : (n, k) array
        Of whirl: 1 a forward circle, -1 a backward one, 0 a straight line.
    growth : (n,) array
        Largest real part of all eigenvalues [1/s], non-oscillating ones included.
    thresholds : tuple of ThresholdSpeed
    """

    choices: dict[str, Any]
    branches: Branches
    sense: Array
    growth: Array
    thresholds: tuple[ThresholdSpeed, ...]

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON: every quantity over speed, branch by branch."""
        found = self.branches
        return {
            "speed": found.parameter,
            "growth_rate": self.growth,
            "branches": [
                {
                    "growth_rate": found.eigenvalues[:, k].real,
                    "damped_frequency": found.damped_frequency[:, k],
                    "damping_ratio": found.damping_ratio[:, k],
                    "log_decrement": found.log_decrement[:, k],
                    "whirl_direction": self.sense[:, k],
                    "whirl": [whirl_word(value) for value in self.sense[:, k]],
                }
                for k in range(found.eigenvalues.shape[1])
            ],
            "smooth": bool(found.smooth.all()),
        }


def whirl_word(sense: float) -> str:
    """``forward``, ``backward`` or ``straight``."""
    return "forward" if sense > FORWARD else "backward" if sense < -FORWARD else "straight"


def campbell_curves(table: CoefficientTable, rotor: RotorOnFilm, modes: int = 8) -> list[Campbell]:
    """Campbell data of `rotor` on every curve of `table`.

    Parameters
    ----------
    table : CoefficientTable
    rotor : RotorOnFilm
    modes : int
        Branches to keep, those of lowest frequency.

    Raises
    ------
    InputError
        A curve has no converged point.
    """
    values = {name: table.dataset[name].values for name in table.choices}
    curves = []
    for index in itertools.product(*(range(column.size) for column in values.values())):
        place = dict(zip(values, index, strict=True))
        part = type(table)(table.dataset.isel({n: slice(i, i + 1) for n, i in place.items()}))
        choices = {
            name: value if isinstance(value := values[name][i], str) else float(value)
            for name, i in place.items()
        }
        curves.append(_campbell(part, rotor, modes, choices))
    return curves


def _campbell(
    table: CoefficientTable, rotor: RotorOnFilm, modes: int, choices: dict[str, Any]
) -> Campbell:
    every = rotor_modes(table, rotor)
    branches = every.oscillating().lowest(modes)
    return Campbell(
        choices=choices,
        branches=branches,
        sense=branches.whirl_sense(rotor.whirl_planes),
        growth=every.eigenvalues.real.max(axis=1),
        thresholds=tuple(rotor_thresholds(table, rotor)),
    )
