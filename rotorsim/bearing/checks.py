"""Derived numbers of an operating condition, and warnings where the model leaves its range."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..model import (
    BushModel,
    Case,
    FlowRegime,
    Inception,
    InletModel,
    LoadTarget,
    ShaftModel,
    ThermalModel,
)
from ..rows import QUANTITIES, with_unit

if TYPE_CHECKING:
    from ..film.heat import HeatBalance

HOTTEST = QUANTITIES["max_temperature"]
"""How temperatures are shown."""
TURBULENT_REYNOLDS = 1000.0
"""rho U c/mu above which a bearing film is expected to be turbulent (Constantinescu)."""
CRITICAL_TAYLOR = 41.2
"""Re sqrt(c/R) at which Taylor vortices set in between concentric cylinders (Taylor 1923)."""
_MOST_TO_HELD_WALLS = 0.5
"""Part of the friction's heat from which on walls held at ambient temperature decide the film."""
_NOTICEABLE_HEATING = 10.0
"""Of the hottest oil over the supply [K]; below it, where the heat goes matters little."""


@dataclass(frozen=True)
class DerivedNumbers:
    """Dimensionless and other derived numbers, at the supply temperature.

    surface_speed : U = omega R [m/s].
    viscosity : mu [Pa s].
    unit_load : W/(L D) [Pa]; None if the load is a result, or none.
    sommerfeld_number : S = mu N L D (R/c)^2/W, N in rev/s; None if the load is a result.
    reynolds_number : rho U c/mu.
    taylor_number : Re sqrt(c/R); vortices above 41.2.
    peclet_number : rho cp U c^2/(k R): heat carried along against heat conducted across the film.
    nahme_number : beta mu U^2/k, beta = -d ln(mu)/dT: how strongly heating thins the film.
    adiabatic_temperature_rise : Of the oil in one turn of a concentric film, nothing of it lost to
        the walls and the viscosity constant [K].
    warm_temperature : Estimated mean of the film, the viscosity following [K].
    warm_viscosity : At that temperature [Pa s].
    warm_reynolds_number, warm_taylor_number : With that viscosity.
    """

    surface_speed: float
    viscosity: float
    unit_load: float | None
    sommerfeld_number: float | None
    reynolds_number: float
    taylor_number: float
    peclet_number: float
    nahme_number: float
    adiabatic_temperature_rise: float
    warm_temperature: float
    warm_viscosity: float
    warm_reynolds_number: float
    warm_taylor_number: float


def _temperature_coefficient(case: Case, temperature: float) -> float:
    """Return -d ln(mu)/dT [1/K] of the case's oil at `temperature` [K], by a central difference."""
    step = 0.01
    low, high = (float(case.lubricant.viscosity(temperature + s)) for s in (-step, step))
    return math.log(low / high) / (2.0 * step)


def derived_numbers(case: Case, speed: float) -> DerivedNumbers:
    """Return the numbers that tell what kind of problem a case is.

    speed : [rad/s]

    The temperature rise follows from the shear power of the concentric film,
    mu U^2/c times 2 pi R L, warming its flow, rho cp U c L/2: 4 pi mu omega R^2/(rho cp c^2).
    The warm film's is the same with the viscosity in the middle of the turn. Its mean is taken half
    the rise above the supply where every turn begins with fresh oil, and the whole rise where warm
    oil comes round: within a few kelvin of what the solver finds without cooled walls.

    Examples
    --------
    >>> from rotorsim.model import *
    >>> oil = Lubricant(ExponentialViscosity(0.0277, 313.15, 0.034), 860.0, 2000.0, 0.13)
    >>> case = Case(
    ...     Bearing(0.05, 0.08, 1e-4), oil, FilmSettings(), ThermalSettings(), LoadTarget(20e3)
    ... )
    >>> numbers = derived_numbers(case, 1570.8)
    >>> round(numbers.reynolds_number, 1), round(numbers.taylor_number, 1)
    (243.8, 10.9)
    """
    bearing, oil = case.bearing, case.lubricant
    radius, clearance = bearing.journal_radius, bearing.radial_clearance
    temperature = case.thermal.supply_temperature
    mu, k = float(oil.viscosity(temperature)), oil.thermal_conductivity
    rho_cp = oil.density * oil.specific_heat
    u = speed * radius
    reynolds = oil.density * u * clearance / mu
    unit_load = sommerfeld = None
    if isinstance(case.target, LoadTarget) and case.target.load > 0.0:
        unit_load = case.target.load / (bearing.length * bearing.diameter)
        sommerfeld = mu * speed / (2.0 * math.pi) / unit_load * (radius / clearance) ** 2
    rise = 4.0 * math.pi * mu * u * radius / (rho_cp * clearance**2)
    warm = _warm_temperature(case, rise)
    warm_mu = float(oil.viscosity(warm))
    slimness = math.sqrt(clearance / radius)
    return DerivedNumbers(
        surface_speed=u,
        viscosity=mu,
        unit_load=unit_load,
        sommerfeld_number=sommerfeld,
        reynolds_number=reynolds,
        taylor_number=reynolds * slimness,
        peclet_number=rho_cp * u * clearance**2 / (k * radius),
        nahme_number=_temperature_coefficient(case, temperature) * mu * u**2 / k,
        adiabatic_temperature_rise=rise,
        warm_temperature=warm,
        warm_viscosity=warm_mu,
        warm_reynolds_number=reynolds * mu / warm_mu,
        warm_taylor_number=reynolds * mu / warm_mu * slimness,
    )


def _warm_temperature(case: Case, cold_rise: float) -> float:
    """Return the mean of the film from r = cold_rise mu(T_s + r/2)/mu(T_s), r by bisection [K]."""
    supply, oil = case.thermal.supply_temperature, case.lubricant
    cold = float(oil.viscosity(supply))
    low, high = 0.0, cold_rise
    for _ in range(50):
        middle = 0.5 * (low + high)
        if middle < cold_rise * float(oil.viscosity(supply + 0.5 * middle)) / cold:
            low = middle
        else:
            high = middle
    return supply + (0.5 * low if case.thermal.inlet is InletModel.FRESH else low)


def regime_warnings(
    case: Case,
    speed: float,
    *,
    min_film_thickness: float | None = None,
    max_temperature: float | None = None,
    mean_viscosity: float | None = None,
    heat_balance: HeatBalance | None = None,
) -> tuple[str, ...]:
    """Return the sentences on where the model leaves its range; none if it does not.

    speed : [rad/s]
    min_film_thickness : Of the solution [m]; held against the bearing's roughness.
    max_temperature : Of the solution [K]; held against the oil's range.
    mean_viscosity : Of the solution [Pa s]: a hot film is thinner, and so its Reynolds number
        larger, than at the supply temperature.
    heat_balance : Of the solution; its part that goes into walls held at ambient temperature.
    """
    numbers = derived_numbers(case, speed)
    thinning = 1.0 if mean_viscosity is None else numbers.viscosity / mean_viscosity
    found = [
        *_flow_warnings(case, numbers.reynolds_number * thinning, numbers.taylor_number * thinning),
        *_temperature_warnings(case, max_temperature),
        *_held_walls(case, max_temperature, heat_balance),
    ]
    roughness = case.bearing.roughness
    if min_film_thickness is not None and min_film_thickness < roughness:
        found.append(
            f"minimum film {with_unit(min_film_thickness * 1e6, 'µm', 3)} is below the roughness "
            f"{with_unit(roughness * 1e6, 'µm', 3)}: the surfaces touch"
        )
    anchored = case.film.inception is Inception.MAX_FILM or case.bearing.grooves
    if case.thermal.model is ThermalModel.THD and not anchored:
        found.append(
            "a thermal film that may begin anywhere need not settle: anchor it with "
            'inception = "max_film" or a groove'
        )
    return tuple(found)


def _flow_warnings(case: Case, reynolds: float, taylor: float) -> list[str]:
    """Return what a laminar film leaves out; nothing of a film whose flow law knows turbulence."""
    found: list[str] = []
    if case.film.flow is not FlowRegime.LAMINAR:
        return found
    if reynolds > TURBULENT_REYNOLDS:
        found.append(
            f"Reynolds number {reynolds:.0f} is above {TURBULENT_REYNOLDS:.0f}: the film is "
            "turbulent, the laminar model underestimates friction and stiffness; write "
            'film.flow = "turbulent"'
        )
    if taylor > CRITICAL_TAYLOR:
        found.append(
            f"Taylor number {taylor:.1f} is above {CRITICAL_TAYLOR}: vortices are expected, the "
            'laminar model underestimates friction; write film.flow = "turbulent"'
        )
    return found


def _temperature_warnings(case: Case, max_temperature: float | None) -> list[str]:
    low, high = case.lubricant.temperature_range
    found = []
    for name, value in (
        ("supply temperature", case.thermal.supply_temperature),
        ("maximum temperature", max_temperature),
    ):
        if value is not None and not low <= value <= high:
            found.append(
                f"{name} {HOTTEST.with_unit(value)} is outside the oil's range "
                f"({HOTTEST.text(low)} to {HOTTEST.with_unit(high, 3)})"
            )
    return found


def _held_walls(case: Case, max_temperature: float | None, heat: HeatBalance | None) -> list[str]:
    """Return the walls that stay cold whatever they take, and take most of the heat."""
    if heat is None or max_temperature is None or not heat.dissipation > 0.0:
        return []
    if not max_temperature - case.thermal.supply_temperature > _NOTICEABLE_HEATING:
        return []
    held = {
        "bush": heat.to_bush if case.thermal.bush is BushModel.AMBIENT else 0.0,
        "shaft": heat.to_shaft if case.thermal.shaft is ShaftModel.AMBIENT else 0.0,
    }
    part = sum(held.values()) / heat.dissipation
    if not part > _MOST_TO_HELD_WALLS:
        return []
    walls = " and ".join(name for name, power in held.items() if power > 0.0)
    ambient = HOTTEST.with_unit(case.thermal.ambient_temperature, 3)
    return [
        f"{walls} held at ambient temperature, {ambient}, take {100.0 * part:.0f} % of the heat: "
        "the film's temperature is on the low side, its thickness and losses on the high side"
    ]
