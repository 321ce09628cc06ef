"""Stability of a table's curves over speed, for one rotor."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..stability.map import StabilityMap
    from ..table import CoefficientTable

Array = NDArray[np.float64]
_SEARCH_POINTS = 2001
"""Between the lowest and the highest speed, among which crossings are looked for."""


@dataclass(frozen=True)
class StabilityCurve:
    """Rigid rotor on one bearing with one thermal model, over the tabulated speeds (SI).

    Attributes
    ----------
    choices : dict
        ``thermal_model``, ``radial_clearance`` [m], and any further dimension of the table.
    speed : (n,) array
        [rad/s]
    stability : (n,) array of str
        Verdict on the critical mass; empty where the point did not converge.
    critical_mass, critical_mass_dimensionless, whirl_frequency_ratio : (n,) arrays
        NaN without a threshold.
    mass : float or None
        Rotor mass per bearing [kg].
    eigenvalues : (n, 4) complex array or None
        Of that rotor [1/s], falling real part.
    threshold_speeds : tuple of float
        Speeds at which that rotor turns from stable to unstable or back [rad/s].
    """

    choices: dict[str, Any]
    speed: Array
    stability: NDArray[np.str_]
    critical_mass: Array
    critical_mass_dimensionless: Array
    whirl_frequency_ratio: Array
    mass: float | None = None
    eigenvalues: NDArray[np.complex128] | None = None
    threshold_speeds: tuple[float, ...] = ()

    @property
    def decay_rate(self) -> Array | None:
        """Of the slowest mode, above 0 where the motion dies out [1/s]; None without a rotor."""
        return None if self.eigenvalues is None else -self.eigenvalues[:, 0].real


@dataclass(frozen=True)
class MapPlane:
    """Stability map of one clearance: decay rates over speed and mass.

    Attributes
    ----------
    radial_clearance : float
        [m]
    speed : (n,) array
        [rad/s]
    mass : (m,) array
        Per bearing [kg].
    isothermal_decay, heated_decay : (n, m) arrays
        Above 0 where the motion dies out, NaN where unknown [1/s]. With one thermal model in the
        table both are its.
    """

    radial_clearance: float
    speed: Array
    mass: Array
    isothermal_decay: Array
    heated_decay: Array


def map_planes(chart: StabilityMap) -> list[MapPlane]:
    """Planes of a map, one for each clearance."""
    dataset = chart.dataset
    models = [str(model) for model in dataset["thermal_model"].values]
    cold = models.index("isothermal") if "isothermal" in models else 0
    hot = models.index("thd") if "thd" in models else len(models) - 1
    planes = []
    for place, clearance in enumerate(dataset["radial_clearance"].values):
        # The map's rate is the largest real part: of growth.
        rate = dataset["decay_rate"].isel(radial_clearance=place)
        decay = -rate.transpose("thermal_model", "speed", "mass").values
        planes.append(
            MapPlane(
                radial_clearance=float(clearance),
                speed=dataset["speed"].values,
                mass=dataset["mass"].values,
                isothermal_decay=decay[cold],
                heated_decay=decay[hot],
            )
        )
    return planes


def stability_curves(table: CoefficientTable, mass: float | None = None) -> list[StabilityCurve]:
    """Curves of every thermal model and clearance in `table`, for a rotor of `mass` per bearing."""
    values = {name: table.dataset[name].values for name in table.choices}
    combinations = itertools.product(*(enumerate(column) for column in values.values()))
    curves = []
    for combination in combinations:
        index = tuple(place for place, _ in combination)
        choices = {
            name: value if isinstance(value, str) else float(value)
            for name, (_, value) in zip(values, combination, strict=True)
        }
        curves.append(_curve(table, index, choices, mass))
    return curves


def _curve(
    table: CoefficientTable, index: tuple[int, ...], choices: dict[str, Any], mass: float | None
) -> StabilityCurve:
    from ..stability import rigid_thresholds

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
        mass=mass,
        eigenvalues=None if mass is None else _eigenvalues(stiffness, damping, mass),
        threshold_speeds=() if mass is None else _thresholds(table, choices, mass),
    )


def _eigenvalues(stiffness: Array, damping: Array, mass: float) -> NDArray[np.complex128]:
    """(n, 4), each row by falling real part; NaN where K or C is."""
    from ..stability.rates import eigenvalues

    values = eigenvalues(stiffness, damping, mass)
    order = np.argsort(-values.real, axis=1, kind="stable")
    return np.take_along_axis(values, order, axis=1)


def _thresholds(table: CoefficientTable, choices: dict[str, Any], mass: float) -> tuple[float, ...]:
    coefficients = table.interpolator(**choices)

    def growth(speed: Array) -> Array:
        stiffness, damping = coefficients(speed, gaps="nan")
        return _eigenvalues(stiffness, damping, mass)[:, 0].real

    return crossings(growth, *coefficients.bounds)


def crossings(function: Callable[[Array], Array], low: float, high: float) -> tuple[float, ...]:
    """Arguments between `low` and `high` at which a function of an array changes its sign.

    Crossings closer together than a two-thousandth of the range may be missed; where the function
    is NaN none are found.
    """
    if not high > low:
        return ()
    grid = np.linspace(low, high, _SEARCH_POINTS)
    values = function(grid)
    found = []
    for place in np.flatnonzero(values[:-1] * values[1:] < 0.0):
        left, right = grid[place], grid[place + 1]
        sign = np.sign(values[place])
        for _ in range(60):
            middle = 0.5 * (left + right)
            value = function(np.array([middle]))[0]
            left, right = (middle, right) if np.sign(value) == sign else (left, middle)
        found.append(float(0.5 * (left + right)))
    return tuple(found)
