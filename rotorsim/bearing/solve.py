"""From a case and a speed to an operating point: film, coefficients, verdict, warnings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from ..arguments import refuse_other
from ..arrays import Array
from ..errors import InputError
from ..film.banded import NoFilmError, SingularFilmError
from ..film.flow import FilmFlow, film_flow
from ..film.geometry import rotation
from ..film.heat import HeatBalance
from ..film.inlets import with_groove_oil
from ..film.linearization import following_stiffness
from ..film.losses import (
    friction_force,
    groove_pressures,
    journal_moment,
    peak,
    side_flow,
    supply_flow,
)
from ..film.pad_solution import solve_pads
from ..film.solution import FilmSolution, WallsOf, solve_film
from ..film.walls import choose_walls
from ..film.warm_start import WarmStart
from ..model import Bearing, Case, Cavitation, InletModel, LoadTarget, ViscosityResponse
from ..model.entries import Quantity
from ..model.operating import is_unloaded
from ..status import SolveStatus
from .checks import regime_warnings
from .dynamics import (
    film_dynamics,
    frequency_coefficients,
    full_coefficients,
    stored_oil_warnings,
    with_rotations,
)
from .operating_point import FilmFields, OperatingPoint, PadResult, failed_point
from .pads import lacking_pads, pad_results, supply_warnings, unloaded_warnings
from .whirl import rigid_threshold

_FOLLOWING = ViscosityResponse.FOLLOWING
_PRESSURE_LIMIT = 400e6
"""[Pa]; a load that needs more than this is out of the model's range."""
_WITH_NUMBERS = (SolveStatus.CONVERGED, SolveStatus.NOT_CONVERGED, SolveStatus.OUT_OF_RANGE)


def solve_case(
    case: Case, speed: float, *, initial: WarmStart | None = None, keep_fields: bool = False
) -> tuple[OperatingPoint, WarmStart | None]:
    """Solve `case` at `speed` [rad/s].

    Parameters
    ----------
    initial : WarmStart, optional
        What a neighbouring point returned; a first guess that saves time.
    keep_fields : bool
        Keep pressure, temperature and viscosity fields in the result.

    Returns
    -------
    OperatingPoint
        Its `status` says whether the numbers may be used.
    WarmStart or None
        For the next speed; None if this point did not converge.

    Raises
    ------
    InputError
        The speed is not positive, or the mesh cannot hold the geometry.
    """
    refuse_other(case, Case, "case", "a Case, as scenario.case() returns one")
    try:
        speed = Quantity("speed").check(speed, "speed")
    except InputError as error:
        raise InputError(error.message, key="speed", value=error.value or speed) from None
    try:
        solution = solved_film(case, speed, initial)
    except NoFilmError as error:
        return failed_point(case, speed, str(error), SolveStatus.NO_EQUILIBRIUM), None
    except SingularFilmError as error:
        return failed_point(case, speed, f"the film's equations cannot be solved: {error}"), None
    point = operating_point(case, speed, solution, keep_fields=keep_fields)
    usable = solution.status is SolveStatus.CONVERGED
    return point, solution.warm_start if usable else None


@np.errstate(over="ignore", invalid="ignore", divide="ignore")  # they end as a status
def solved_film(
    case: Case, speed: float, initial: WarmStart | None = None, walls: WallsOf = choose_walls
) -> FilmSolution:
    """Solve from the first guess, and without it where that leads nowhere.

    `walls` as in `rotorsim.film.solution.solve_film`.

    Raises NoFilmError, SingularFilmError: There is no film.
    """
    solver = solve_pads if case.bearing.pads else solve_film
    if initial is not None:
        with suppress(NoFilmError, SingularFilmError):
            solution = solver(case, speed, initial=initial, walls=walls)
            if solution.status is SolveStatus.CONVERGED:
                return solution
    return solver(case, speed, walls=walls)


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def operating_point(
    case: Case, speed: float, solution: FilmSolution, *, keep_fields: bool = False
) -> OperatingPoint:
    """Return the results of a solved film, turned into the load frame."""
    problem, state = solution.problem, solution.state
    status, message = solution.status, solution.message
    following = None
    if solution.thermal is not None and case.film.viscosity_response is _FOLLOWING:
        following, settled = following_stiffness(solution.thermal)
        if not settled and status is SolveStatus.CONVERGED:
            status, message = SolveStatus.NOT_CONVERGED, "a displaced film did not converge"
    turn = rotation(solution.frame)
    hot = None if case.thermal.expansion is None else problem.bearing
    dynamics = film_dynamics(solution, turn, following=following)
    stiffness, damping, frequency_ratio = dynamics.stated_coefficients()
    center = turn @ state.displacement[:2]
    load = float(np.hypot(state.force[0], state.force[1]))
    if is_unloaded(case.target) and not case.bearing.pads:
        load = 0.0  # and not the residual
    clearance, radius = case.bearing.radial_clearance, case.bearing.journal_radius
    viscosity = float(case.lubricant.viscosity(case.thermal.supply_temperature))
    flow = _solved_flow(solution)
    fraction = flow.liquid_fraction
    friction = friction_force(state, fraction)
    hottest, mean = _temperatures(solution, fraction)
    thinnest, pads = _min_film_thickness(solution), pad_results(solution)
    demand = tuple(float(needed) for needed in supply_flow(state, flow))
    numbers: dict[str, float] = {
        "eccentricity_ratio": float(np.hypot(*center)) / problem.bearing.radial_clearance,
        "attitude_angle": math.atan2(center[1], center[0]),
        "load": load,
        "sommerfeld_number": _ratio(
            viscosity * speed / (2.0 * math.pi) * 2.0 * radius * case.bearing.length
            * (radius / clearance) ** 2, load,
        ),
        "max_pressure": peak(state.solution.pressure, problem.mesh.half),
        "max_temperature": hottest,
        "mean_temperature": mean,
        "friction_force": friction,
        "power_loss": friction * speed * radius,
        "side_flow": side_flow(state),
        "min_film_thickness": thinnest,
    }  # fmt: skip
    if status is SolveStatus.CONVERGED:
        status, message = _within_pressure(numbers["max_pressure"], case)
    finite = (
        all(math.isfinite(v) for k, v in numbers.items() if k != "sommerfeld_number")
        and np.isfinite(stiffness).all()
    )
    threshold = synchronous = None
    if finite and status in _WITH_NUMBERS:
        threshold = dynamics.threshold(load=load, radial_clearance=clearance)
        synchronous = rigid_threshold(
            stiffness, damping, speed, load=load, radial_clearance=clearance
        )
    elif not finite and status in _WITH_NUMBERS:
        status, message = SolveStatus.FAILED, message or "the solution is not finite"
    mean_viscosity = float(case.lubricant.viscosity(mean)) if math.isfinite(mean) else None
    heat = solution.thermal.balance if solution.thermal is not None else None
    return OperatingPoint(
        status=status,
        message=message,
        thermal_model=str(case.thermal.model),
        cavitation=str(case.film.cavitation),
        speed=speed,
        radial_clearance=clearance,
        **numbers,
        stiffness=stiffness,
        damping=damping,
        coefficient_frequency_ratio=frequency_ratio,
        frequency_coefficients=frequency_coefficients(dynamics, case.film.frequency_ratios),
        moment=turn @ journal_moment(state),
        supply_flow=demand,
        groove_pressure=groove_pressures(state),
        coefficients_full=(
            full_coefficients(
                with_rotations(solution, turn) if case.film.rotations else dynamics, frequency_ratio
            )
            if case.film.rotations or dynamics.has_pads
            else None
        ),
        critical_mass=threshold.critical_mass if threshold else None,
        critical_mass_dimensionless=threshold.critical_mass_dimensionless if threshold else None,
        critical_mass_synchronous=synchronous.critical_mass
        if synchronous and dynamics.has_pads
        else None,
        pads=pads,
        whirl_frequency_ratio=threshold.whirl_frequency_ratio if threshold else None,
        stability=threshold.stability if threshold else None,
        iterations=solution.iterations,
        residual=solution.residual,
        warnings=(
            *regime_warnings(
                case, speed, min_film_thickness=thinnest, max_temperature=hottest,
                mean_viscosity=mean_viscosity, heat_balance=heat,
            ),
            *stored_oil_warnings(dynamics, stiffness, damping, frequency_ratio),
            *unloaded_warnings(solution.unloaded),
            *supply_warnings(case.bearing, case.film.cavitation, pads, demand),
        ),
        heat_balance=heat,
        heat_imbalance=None if heat is None else heat.imbalance,
        shaft_temperature=_shaft_temperature(solution),
        hot_radial_clearance=None if hot is None else hot.radial_clearance,
        hot_preload=None if hot is None else _mean_preload(hot),
        deflection=_deflection(solution, pads),
        deformation_response=None
        if problem.elastic is None and not any(pad.youngs_modulus for pad in case.bearing.pads)
        else str(case.film.deformation_response),
        outlet_temperature=_outlet_temperature(case, numbers["side_flow"], heat, demand),
        **_flow_regimes(solution),
        fields=_fields(solution, fraction) if keep_fields else None,
    )  # fmt: skip


def _within_pressure(max_pressure: float, case: Case) -> tuple[SolveStatus, str]:
    """Return whether rigid walls and constant viscosity mean anything at this pressure."""
    if max_pressure <= _PRESSURE_LIMIT:
        return SolveStatus.CONVERGED, ""
    advice = "reduce the eccentricity ratio, the speed or the viscosity"
    if isinstance(case.target, LoadTarget):
        advice = "reduce the load, or raise speed, viscosity or size"
    return SolveStatus.OUT_OF_RANGE, (
        f"the film reaches {max_pressure / 1e6:.0f} MPa, above {_PRESSURE_LIMIT / 1e6:.0f} MPa: "
        f"bearing and shaft would yield, and the oil thicken; {advice}"
    )


def _min_film_thickness(solution: FilmSolution) -> float:
    """Return the smallest film thickness [m], lands only."""
    bearing, state = solution.problem.bearing, solution.state
    if bearing.is_plain and bearing.is_symmetric and state.deflection is None:
        return bearing.radial_clearance - math.hypot(*state.displacement)
    return state.min_thickness


def _deflection(solution: FilmSolution, pads: Sequence[PadResult]) -> float | None:
    """Return the largest elastic deflection of pads or bore [m]; None where they are rigid."""
    if solution.state.deflection is not None:
        return float(np.abs(solution.state.deflection).max())
    if not any(pad.youngs_modulus for pad in solution.problem.bearing.pads):
        return None
    return max(pad.deflection for pad in pads)


def _mean_preload(bearing: Bearing) -> float:
    """Return the mean preload of pads or lobes; 0 for a plain bore."""
    preloads = [bearing.preload_of(pad) for pad in bearing.pads]
    preloads = preloads or [arc.preload for arc in bearing.arcs]
    return sum(preloads) / len(preloads) if preloads else 0.0


def _ratio(above: float, below: float) -> float:
    return above / below if below > 0.0 else math.inf


def _solved_flow(solution: FilmSolution) -> FilmFlow:
    """Return the fluxes and liquid fractions of a solved film."""
    if solution.thermal is not None:
        return solution.thermal.energy.flow
    return film_flow(solution.state)


def _temperatures(solution: FilmSolution, fraction: Array) -> tuple[float, float]:
    """Return the highest and mean temperature of the film's oil [K]."""
    state, thermal = solution.state, solution.thermal
    if thermal is None:
        supply = solution.problem.thermal.supply_temperature
        return supply, supply
    film = ~state.operator.fixed
    weight = (state.center_thickness * state.operator.area * fraction * film)[:, :, None]
    temperature = thermal.heat.temperature
    total = float(np.sum(weight)) * temperature.shape[2]
    mean = float(np.sum(weight * temperature)) / total if total > 0.0 else math.nan
    return float(temperature[film].max()), mean


def _shaft_temperature(solution: FilmSolution) -> float:
    """Return the temperature of the journal's surface [K]; of an isothermal film the supply's."""
    if solution.thermal is None:
        return solution.problem.thermal.supply_temperature
    return solution.thermal.heat.shaft


def _flow_regimes(solution: FilmSolution) -> dict[str, float]:
    """Return the largest rho U h F_0, and the shares of the film's area by its flow."""
    state, film = solution.state, ~solution.state.operator.fixed
    turbulent = state.layers.turbulent
    laminar = state.layers if turbulent is None else turbulent.laminar
    local = state.center_thickness * laminar.f0 * solution.problem.surface_speed
    weight, area = _turbulence(solution)[film], state.operator.area[film]
    shares = [float(np.sum(area[part])) for part in (weight <= 0.0, weight >= 1.0)]
    still, grown = (share / float(area.sum()) for share in shares)
    return {
        "reynolds_number": solution.problem.lubricant.density * float(local[film].max()),
        "laminar_share": still,
        "transitional_share": max(1.0 - still - grown, 0.0),
        "turbulent_share": grown,
    }


def _turbulence(solution: FilmSolution) -> Array:
    """Return the weight of turbulent against laminar flow, (n, m)."""
    turbulent = solution.state.layers.turbulent
    return np.zeros(solution.problem.mesh.shape) if turbulent is None else turbulent.weight


def _outlet_temperature(
    case: Case, flow: float, heat: HeatBalance | None, demand: Sequence[float]
) -> float | None:
    """Return mean temperature of the oil that leaves at both ends [K]; None where it is not known.

    With a given supply, of all oil that leaves the housing.
    All heat that the oil carries off leaves with the side flow only where the oil that comes round
    mixes, whole, with what is supplied, and at one temperature.
    """
    thermal, oil = case.thermal, case.lubricant
    mixed = thermal.inlet is InletModel.MIXING and thermal.hot_oil_carry_over == 1.0
    if case.bearing.supply_flow is not None:
        flow = case.bearing.supply_flow
        lacking = lacking_pads(case.bearing, case.film.cavitation, demand)
        mixed = thermal.inlet is InletModel.MIXING and not lacking
    kept = case.film.cavitation in (Cavitation.REYNOLDS, Cavitation.JFO)
    single = all(
        groove.supply_temperature in (None, thermal.supply_temperature)
        for groove in case.bearing.grooves
    )
    if heat is None or not (mixed and kept and single and flow > 0.0):
        return None
    return thermal.supply_temperature + heat.enthalpy_out / (oil.density * oil.specific_heat * flow)


def _without_tension(solution: FilmSolution) -> Array:
    """Return pressure [Pa] without what a few cells, kept full at the end, hold below ambient."""
    pressure = solution.state.solution.pressure
    if solution.problem.settings.cavitation is Cavitation.FULL_SOMMERFELD:
        return pressure
    return np.where(solution.state.operator.fixed, pressure, np.maximum(pressure, 0.0))


def _fields(solution: FilmSolution, fraction: Array) -> FilmFields:
    """Return the fields over the whole length, angles in the load frame."""
    problem, state, thermal = solution.problem, solution.state, solution.thermal
    mesh, supply = problem.mesh, problem.thermal.supply_temperature
    layers = problem.settings.mesh.cross_film
    shape = (*mesh.shape, layers)
    if thermal is None:
        temperature = np.full(shape, supply)
        viscosity = np.full(shape, float(problem.lubricant.viscosity(supply)))
        bush = np.full(mesh.shape, supply)
    else:
        temperature = with_groove_oil(problem, thermal.heat.temperature, thermal.inlet_temperature)
        viscosity = np.where(
            (mesh.supply >= 0)[:, :, None],
            problem.lubricant.viscosity(temperature),
            thermal.viscosity,
        )
        bush = thermal.heat.bush

    whole = mesh.whole
    return FilmFields(
        theta=mesh.theta + solution.frame,
        y=mesh.whole_y,
        z=(np.arange(layers) + 0.5) / layers,
        film_thickness=whole(np.maximum(state.center_thickness, 0.0)),
        pressure=whole(_without_tension(solution)),
        liquid_fraction=whole(fraction),
        temperature=whole(temperature),
        viscosity=whole(viscosity),
        bush_temperature=whole(bush),
        shaft_temperature=_shaft_temperature(solution),
        turbulence=whole(_turbulence(solution)),
    )


__all__ = ["WarmStart", "operating_point", "solve_case"]
