"""Numbers of a bearing's drawing, and warnings where it is unlike bearings that run.

The limits are those of ordinary oil-lubricated bearings: beyond them a number is more often
mistyped (diameter for radius, diametral for radial clearance) than meant. They are warnings only;
docs/limits.md lists them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..model import Bearing, Case, FlowRegime, Groove, LoadTarget, ThermalModel
from ..model.bearing import angle_between
from ..rows import with_unit
from ..units import ZERO_CELSIUS
from .checks import CRITICAL_TAYLOR, HOTTEST, TURBULENT_REYNOLDS, DerivedNumbers, derived_numbers

STANDARD_GRAVITY = 9.80665
"""Standard acceleration of free fall [m/s2] (ISO 80000-3)."""
_CLEARANCE_RATIO = (0.3e-3, 5e-3)
"""c/R of bearings that run; DIN 31652-3 recommends 0.56 to 3.15 per mille."""
_UNIT_LOAD = (0.02e6, 5e6)
"""W/(L D) [Pa]: above, white metal creeps (DIN 31652-3); below, bearings whirl early."""
_WEIGHT_TO_LOAD = (0.2, 5.0)
"""M g/W: far from 1 the load is not the rotor's weight, which may be meant (a gearbox)."""
_LOADED_ZONE = math.radians(20.0)
"""A groove nearer to the load line than this lies where the film carries [rad]."""
_HOT = 150.0 + ZERO_CELSIUS
"""[K]: mineral oils and white metal do not last there."""
_GREAT_HEATING = 100.0
"""Adiabatic temperature rise in one turn [K] from which the film is not that of the drawing."""


@dataclass(frozen=True)
class _DrawingNumbers:
    """Numbers of a drawing, as engineers compare bearings.

    diameter : [m]
    diametral_clearance : [m]
    clearance_ratio : c/R.
    unit_load : W/(L D) [Pa]; None if the load is a result, or none.
    weight_to_load : Rotor's weight per bearing over the load; None without one of them.
    """

    diameter: float
    length_to_diameter: float
    diametral_clearance: float
    clearance_ratio: float
    unit_load: float | None
    weight_to_load: float | None


def drawing_numbers(case: Case, rotor_mass: float | None = None) -> _DrawingNumbers:
    """Return the numbers of a case's drawing.

    rotor_mass : Per bearing [kg].

    Examples
    --------
    >>> from rotorsim.model import *
    >>> oil = Lubricant(ExponentialViscosity(0.03, 313.15), 860.0, 2000.0, 0.13)
    >>> bearing = Bearing(0.06, 0.09, 90e-6)
    >>> case = Case(bearing, oil, FilmSettings(), ThermalSettings(), LoadTarget(18e3))
    >>> numbers = drawing_numbers(case, 1800.0)
    >>> round(numbers.clearance_ratio, 6), round(numbers.unit_load), numbers.length_to_diameter
    (0.0015, 1666667, 0.75)
    >>> round(numbers.weight_to_load, 3)
    0.981
    """
    bearing = case.bearing
    load = (case.target.load or None) if isinstance(case.target, LoadTarget) else None
    return _DrawingNumbers(
        diameter=bearing.diameter,
        length_to_diameter=bearing.length / bearing.diameter,
        diametral_clearance=2.0 * bearing.radial_clearance,
        clearance_ratio=bearing.radial_clearance / bearing.journal_radius,
        unit_load=None if load is None else load / (bearing.length * bearing.diameter),
        weight_to_load=(
            None if load is None or rotor_mass is None else rotor_mass * STANDARD_GRAVITY / load
        ),
    )


def drawing_warnings(case: Case, rotor_mass: float | None = None) -> tuple[str, ...]:
    """Return the sentences on what is unlike bearings that run; none if nothing is.

    rotor_mass : Per bearing [kg].
    """
    return (
        *_size_warnings(drawing_numbers(case, rotor_mass)),
        *_groove_warnings(case.bearing),
        *_hot_surroundings(case),
    )


def heating_warnings(case: Case, speed: float) -> tuple[str, ...]:
    """Return the sentences on what heating is estimated to do; none for an isothermal case.

    speed : [rad/s]
    """
    if case.thermal.model is not ThermalModel.THD:
        return ()
    numbers, found = derived_numbers(case, speed), []
    rise = numbers.adiabatic_temperature_rise
    if rise > _GREAT_HEATING:
        found.append(
            f"adiabatic temperature rise {with_unit(rise, 'K', 3)} is above "
            f"{with_unit(_GREAT_HEATING, 'K', 3)}: this oil heats "
            "itself thin at once; check viscosity, clearance and speed"
        )
    laminar = case.film.flow is FlowRegime.LAMINAR
    return (*found, *(_warm_flow(numbers) if laminar else ()))


def _warm_flow(numbers: DerivedNumbers) -> list[str]:
    """Return limits that only the estimated warm film exceeds."""
    at = f"with the estimated warm viscosity ({HOTTEST.with_unit(numbers.warm_temperature, 3)})"
    return [
        f"{name} number {warm:.4g} {at} is above {limit:g}: the film may be {what} when hot"
        for name, cold, warm, limit, what in (
            (
                "Reynolds", numbers.reynolds_number, numbers.warm_reynolds_number,
                TURBULENT_REYNOLDS, "turbulent",
            ),
            (
                "Taylor", numbers.taylor_number, numbers.warm_taylor_number,
                CRITICAL_TAYLOR, "full of vortices",
            ),
        )
        if cold <= limit < warm
    ]  # fmt: skip


def _size_warnings(numbers: _DrawingNumbers) -> list[str]:
    found = []
    low, high = _CLEARANCE_RATIO
    if not low <= numbers.clearance_ratio <= high:
        found.append(
            f"c/R {numbers.clearance_ratio * 1e3:.3g} per mille is outside {low * 1e3:g} to "
            f"{high * 1e3:g}: check that radius and radial clearance are halves of diameter and "
            "diametral clearance, and their units"
        )
    unit = numbers.unit_load
    if unit is not None and not _UNIT_LOAD[0] <= unit <= _UNIT_LOAD[1]:
        word = "above" if unit > _UNIT_LOAD[1] else "below"
        limit = _UNIT_LOAD[1] if unit > _UNIT_LOAD[1] else _UNIT_LOAD[0]
        found.append(
            f"specific load W/(L D) {with_unit(unit / 1e6, 'MPa', 3)} is {word} "
            f"{with_unit(limit / 1e6, 'MPa')}: check the load per bearing and the dimensions"
        )
    ratio = numbers.weight_to_load
    if ratio is not None and not _WEIGHT_TO_LOAD[0] <= ratio <= _WEIGHT_TO_LOAD[1]:
        found.append(
            f"the rotor's weight is {ratio:.3g} times the load: check that both are per bearing, "
            "unless the load is not the weight"
        )
    return found


def _groove_warnings(bearing: Bearing) -> list[str]:
    found: list[str] = []
    if bearing.pads:  # the openings between them are made by the pads
        return found
    for groove in bearing.grooves:
        if groove.restrictor is not None:  # a recess carries
            continue
        place = f"groove at {math.degrees(groove.center) % 360.0:.4g} deg from the load line"
        if _in_loaded_zone(groove):
            found.append(
                f"{place} lies on the load: the film cannot carry there; angles are counted from "
                "the load line (operating.load_direction)"
            )
        if groove.supply_pressure == 0.0:
            found.append(
                f"{place} has no supply_pressure: it is open to the surroundings, and the film "
                "takes from it what it asks for"
            )
    return found


def _in_loaded_zone(groove: Groove) -> bool:
    return abs(float(angle_between(groove.center, 0.0))) < 0.5 * groove.extent + _LOADED_ZONE


def _hot_surroundings(case: Case) -> list[str]:
    # The scenario's supply temperature is held against the oil's range (`regime_warnings`).
    temperatures = {"ambient temperature": case.thermal.ambient_temperature}
    for place, groove in enumerate(case.bearing.grooves, start=1):
        if groove.supply_temperature is not None:
            temperatures[f"supply temperature of groove {place}"] = groove.supply_temperature
    return [
        f"{name} {HOTTEST.with_unit(value, 3)} is above "
        f"{HOTTEST.with_unit(_HOT, 3)}: check its unit"
        for name, value in temperatures.items()
        if value > _HOT
    ]
