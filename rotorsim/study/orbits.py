"""From a scenario and its table to simulated orbits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..arguments import refuse_path
from ..arrays import Array, Indices
from ..bearing.operating_point import OperatingPoint
from ..errors import InputError
from ..model import preferred_model
from ..model.orbit import OrbitForce, SpeedRamp
from .control import with_actuator

if TYPE_CHECKING:
    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario
    from ..film.solution import FilmSolution
    from ..model import Bearing, Case
    from ..model.orbit import OrbitSettings
    from ..orbit import LinearForce, Orbit, OrbitProblem, SpeedSchedule
    from ..orbit.film_force import LoadedFilm
    from ..rotor import Rotor


_UNPLACED = (
    "the table does not say where the journal stands: the motion is shown about the bearing's "
    "centre, and touch-down is not looked for"
)
_MAX_SAMPLES = 2_000_000
"""Of one orbit that are kept in memory: some 200 MB."""
_RUN_UP_SECONDS = 1.0
"""Of the run-up that is added to an orbit at one speed."""
_HOLD_SECONDS = 0.3
"""At its top speed after that, to show what the run-up has led to."""
_RUN_UP_REVOLUTIONS = 60
"""At the top speed, of the constant-speed orbit that is added to a run-up."""


def simulate_orbit(
    scenario: Scenario,
    table: CoefficientTable | None = None,
    *,
    thermal_model: str | None = None,
    schedule: SpeedSchedule | None = None,
    consume: Callable[[Orbit], None] | None = None,
) -> Orbit:
    """Integrate the scenario's orbit.

    Parameters
    ----------
    scenario : Scenario
        With ``[orbit]`` and ``[rotor]``.
    table : CoefficientTable, optional
        Of this scenario, or any other that covers its clearance and speeds. Default: it is
        computed. A nonlinear film (``force = "film"``) needs none.
    thermal_model : str, optional
        Default: ``thd`` where the scenario (or the table) has it.
    schedule : SpeedSchedule, optional
        In place of the scenario's speed.
    consume : callable, optional
        Called with each piece of some revolutions as soon as it is there.

    Returns
    -------
    Orbit
        How the run ended is its ``status``. Of a run of more than `_MAX_SAMPLES` samples the last
        ones are kept.

    Raises
    ------
    InputError
        The scenario has no orbit, or the table does not cover it.
    """
    from ..orbit import simulate

    refuse_path(scenario)
    settings, _ = orbit_settings(scenario)
    if table is None and settings.force is OrbitForce.LINEAR:
        from .sweep import tabulate

        table = tabulate(scenario)
    problem = _orbit_problem(scenario, table, thermal_model=thermal_model, schedule=schedule)
    keep = _MAX_SAMPLES // problem.samples_per_revolution
    orbit = simulate(problem, consume=consume, keep_revolutions=keep)
    if settings.actuator is None or not orbit.t.size:
        return orbit
    most = float(np.abs(orbit.actuator_force).max())
    return replace(orbit, message=f"{orbit.message}; largest actuator force {most:.4g} N")


def prepare_film(
    scenario: Scenario, model: str, progress: Callable[[int, int], None] | None = None
) -> None:
    """Solve the force map of a nonlinear film unless it is kept: the first run's longest part.

    model : Thermal model.
    progress : Called with rows done and rows in all, where there is something to do.
    """
    from ..orbit.film_force import prepare_map

    settings, _ = orbit_settings(scenario)
    if settings.force is OrbitForce.FILM:
        prepare_map(scenario.case(settings.radial_clearance, model), progress)


def _orbit_problem(
    scenario: Scenario,
    table: CoefficientTable | None = None,
    *,
    thermal_model: str | None = None,
    schedule: SpeedSchedule | None = None,
) -> OrbitProblem:
    """Put the scenario's orbit together (see `simulate_orbit`; linear force: with a table)."""
    from ..orbit import OrbitProblem

    settings, rotor = orbit_settings(scenario)
    schedule = schedule or scenario_schedule(settings)
    if settings.force is OrbitForce.LINEAR:
        if table is None:
            raise InputError(
                'needs a coefficient table: force is "linear"', source=scenario.source, key="orbit"
            )
        model = thermal_model or preferred_model(table.dataset["thermal_model"].values)
        force, bearing = _linear_force(scenario, table, model)
        # the coefficients hold about the loaded position, so that the load itself is left out
        load, carried = 0.0, _carried_load(table, model, settings, schedule.speeds[0])
        placed = _has_positions(table)
        note = "" if placed else _UNPLACED
    else:
        model = thermal_model or preferred_model(scenario.thermal_models)
        film, placed = _nonlinear_film(scenario, model, schedule.speeds), True
        force, bearing, load, note = film.force, film.bearing, film.load, film.note
        carried = load
    problem = OrbitProblem(
        force=force,
        rotor=rotor if settings.unbalance else replace(rotor, unbalance=0.0 * rotor.unbalance),
        schedule=schedule,
        static_load=(load if settings.static_load else 0.0, 0.0),
        initial_displacement=settings.initial_displacement,
        initial_velocity=settings.initial_velocity,
        loads=settings.loads,
        minimum_film=scenario.bearing.roughness,
        stop_at_contact=placed,
        samples_per_revolution=settings.samples_per_revolution,
        thermal_model=model,
        bearing=bearing,
        kind=settings.kind.value,
        note=note,
    )
    if settings.actuator is None:
        return problem
    return with_actuator(problem, settings.actuator, rotor.total_mass, carried)


def _carried_load(
    table: CoefficientTable, model: str, settings: OrbitSettings, speed: float
) -> float | None:
    """Return the static load of the table [N]; None where it does not say."""
    if settings.actuator is None:
        return None
    return curve_of(table, model, settings.radial_clearance).at(speed).load


def _linear_force(
    scenario: Scenario, table: CoefficientTable, model: str
) -> tuple[LinearForce, Bearing]:
    """Return the stiffness and damping of the table, about its static positions."""
    from ..orbit import LinearForce

    clearance = orbit_settings(scenario)[0].radial_clearance
    one = curve_of(table, model, clearance)
    if not one.converged.any():
        raise InputError("no point of the table converged", source=scenario.source, key="orbit")
    force = LinearForce(
        coefficients=one.interpolator(),
        radial_clearance=clearance,
        equilibrium=_static_position(one, clearance) if _has_positions(one) else (0.0, 0.0),
    )
    bearing = replace(scenario.bearing, radial_clearance=clearance)
    return force, bearing.turned(-scenario.load_direction)


def _nonlinear_film(scenario: Scenario, model: str, speeds: Sequence[float]) -> LoadedFilm:
    """Return nonlinear film of the orbit's bearing between speeds.

    Its operating point at the highest.

    With an eccentricity ratio in place of a load, the load is that which gives it at this speed.
    """
    from ..orbit.film_force import field_speeds, loaded_film

    case = scenario.case(orbit_settings(scenario)[0].radial_clearance, model)
    try:
        return loaded_film(case, max(speeds), other_speeds=field_speeds(speeds))
    except InputError as error:
        raise InputError(
            error.message, source=scenario.source, key=error.key, value=error.value
        ) from None


def orbit_settings(scenario: Scenario) -> tuple[OrbitSettings, Rotor]:
    """Return what to simulate, or an `InputError` that says what the scenario lacks."""
    if scenario.orbit is None or scenario.rotor is None:
        missing = "orbit" if scenario.orbit is None else "rotor"
        raise InputError(
            f"is missing: an orbit needs the tables [rotor] and [orbit]; add [{missing}]",
            source=scenario.source,
            key=missing,
        )
    return scenario.orbit, scenario.rotor


def scenario_schedule(settings: OrbitSettings) -> SpeedSchedule:
    """Return the shaft speed over time, as the scenario has it."""
    from ..orbit import SpeedSchedule

    if isinstance(settings.speed, SpeedRamp):
        ramp = settings.speed
        return SpeedSchedule.ramp(ramp.start, ramp.stop, ramp.duration, ramp.hold)
    return SpeedSchedule.constant(settings.speed, settings.revolutions or _RUN_UP_REVOLUTIONS)


def companion_schedule(settings: OrbitSettings, table: CoefficientTable) -> SpeedSchedule:
    """Return the other kind of run: up from the lowest speed, or constant at the ramp's end."""
    from ..orbit import SpeedSchedule

    if isinstance(settings.speed, SpeedRamp):
        return SpeedSchedule.constant(settings.speed.stop, _RUN_UP_REVOLUTIONS)
    lowest = float(table.speeds[0])
    if settings.speed <= lowest:
        return scenario_schedule(settings)
    return SpeedSchedule.ramp(lowest, settings.speed, _RUN_UP_SECONDS, _HOLD_SECONDS)


def curve_of(table: CoefficientTable, model: str, clearance: float) -> CoefficientTable:
    """Return the curve of a thermal model and a clearance [m], which a table may not have."""
    known = table.dataset["radial_clearance"].values
    chosen = {} if np.isnan(known).all() else {"radial_clearance": clearance}
    return table.select(thermal_model=model, **chosen)


def _has_positions(table: CoefficientTable) -> bool:
    """Return whether the table says where the journal stands; one of another program need not."""
    return {"eccentricity_ratio", "attitude_angle"} <= set(table.dataset)


def _static_position(
    one: CoefficientTable, clearance: float
) -> Callable[[float], tuple[float, float]]:
    """Return journal's static position over speed, from a table of one curve with positions.

    one : With a converged point.
    clearance : Radial [m].
    Returns: speed [rad/s] -> (x, y) [m] in the load frame; a monotone interpolant (PCHIP) through
        the converged points.
    """
    from scipy.interpolate import PchipInterpolator

    usable = one.converged.ravel()
    curve = one.dataset.squeeze(list(one.choices))
    hot = curve["hot_radial_clearance"].values if "hot_radial_clearance" in curve else np.nan
    eccentricity = curve["eccentricity_ratio"].values * np.where(np.isnan(hot), clearance, hot)
    angle = curve["attitude_angle"].values
    places = np.column_stack([eccentricity * np.cos(angle), eccentricity * np.sin(angle)])[usable]
    if len(places) == 1:
        x, y = places[0]
        return lambda _speed: (float(x), float(y))
    through = PchipInterpolator(one.speeds[usable], places)

    def position(speed: float) -> tuple[float, float]:
        x, y = through(speed)
        return float(x), float(y)

    return position


_FRAMES_PER_REVOLUTION = 8
_FIRST_REVOLUTIONS, _LAST_REVOLUTIONS = 8, 32
"""At the run's beginning and end, shown in full."""
_BETWEEN = 64
"""Frames of what lies between, each at a whole turn of the shaft."""
_LARGEST_MESH = (156, 48, 24)
"""Finer films than this are shown on this mesh."""


@dataclass(frozen=True)
class FilmFrame:
    """Pressure and temperature of the film at one speed, or at one moment of a run.

    speed : [rad/s]
    theta : (n,) array. Cell centres, ascending within one turn [rad].
    y : (m,) array. Equidistant cell centres, -L/2 to L/2 [m].
    pressure : (n, m) array. Gauge [Pa].
    temperature : (n, m) array or None. Mean across the film [K]; None where it is uniform.
    max_temperature : Hottest place of the film, also across it [K].
    journal_radius, radial_clearance : [m]
    centre : (2,) array. Journal's centre [m].
    time : The moment in the run of this thermal model [s]; None: journal at rest.
    bearing : Of tilting pads, load frame.
    tilts, pivots : How its pads stand: tilts in the direction of rotation [rad], pivots outwards
        [m].
    """

    thermal_model: str
    speed: float
    theta: Array
    y: Array
    pressure: Array
    temperature: Array | None
    max_temperature: float | None
    journal_radius: float
    radial_clearance: float
    centre: Array
    time: float | None = None
    bearing: Bearing | None = None
    tilts: tuple[float, ...] = ()
    pivots: tuple[float, ...] = ()

    @property
    def length(self) -> float:
        """Length of the bearing [m]."""
        return float(self.y[-1] - self.y[0]) * self.y.size / (self.y.size - 1)


def film_at_rest(point: OperatingPoint, bearing: Bearing) -> FilmFrame:
    """Return the film of an operating point that kept its fields; its bearing in the load frame.

    Raises InputError: The point was solved without its fields.
    """
    if point.fields is None:
        raise InputError("the operating point was solved without its fields", key="fields")
    film, angle = point.fields, point.attitude_angle
    mean = film.temperature.mean(axis=2)
    warm = bool(np.ptp(mean) > 1e-6)
    return FilmFrame(
        thermal_model=point.thermal_model,
        speed=point.speed,
        theta=film.theta,
        y=film.y,
        pressure=film.pressure,
        temperature=mean if warm else None,
        max_temperature=point.max_temperature if warm else None,
        journal_radius=bearing.journal_radius,
        radial_clearance=point.running_clearance,
        centre=point.eccentricity_ratio
        * point.running_clearance
        * np.array([np.cos(angle), np.sin(angle)]),
        bearing=bearing if bearing.pads else None,
        tilts=tuple(pad.tilt for pad in point.pads),
        pivots=tuple(pad.pivot_displacement for pad in point.pads),
    )


def film_in_motion(scenario: Scenario, orbit: Orbit) -> list[FilmFrame]:
    """Return the film along an orbit on the nonlinear film, ascending in time.

    Pressure is solved for the journal's position and velocity; the temperature lies between those
    of operating points, as in the simulation. Moments at which no film is found are left out.
    """
    from ..film.geometry import pad_unknowns
    from ..orbit.film_force import SolvedFilmForce, field_speeds, operating_film, other_films

    case = _shown_case(
        scenario.case(orbit_settings(scenario)[0].radial_clearance, orbit.thermal_model)
    )
    top = float(np.abs(orbit.speed).max())
    solution, others = operating_film(case, top), []
    if solution.thermal is not None:
        load = float(np.hypot(*solution.state.force[:2]))
        others = other_films(case, load, field_speeds([float(np.abs(orbit.speed).min()), top]))
    force, mesh = SolvedFilmForce.of(solution, others), solution.problem.mesh
    fields = _temperatures(solution, others)
    places, rates = orbit.film_motion
    unknowns = pad_unknowns(case.bearing)[1]
    frames = []
    for row in _shown_samples(orbit):
        try:
            state = force.film(places[row], rates[row], float(orbit.speed[row]))
        except ArithmeticError:
            continue
        frames.append(
            FilmFrame(
                thermal_model=orbit.thermal_model,
                speed=float(orbit.speed[row]),
                theta=mesh.theta + solution.frame,
                y=mesh.whole_y,
                pressure=mesh.whole(state.solution.pressure),
                temperature=None if fields is None else fields(float(orbit.speed[row]))[0],
                max_temperature=None if fields is None else fields(float(orbit.speed[row]))[1],
                journal_radius=case.bearing.journal_radius,
                radial_clearance=force.radial_clearance,
                centre=np.array([orbit.x[row], orbit.y[row]]),
                time=float(orbit.t[row]),
                bearing=case.bearing if unknowns else None,
                tilts=tuple(float(places[row, own.tilt]) for own in unknowns),
                pivots=tuple(
                    0.0 if own.pivot is None else float(places[row, own.pivot]) for own in unknowns
                ),
            )
        )
    return frames


def _shown_samples(orbit: Orbit) -> Indices:
    """Return samples at which the film is shown: every move at both ends, few between."""
    turn = orbit.samples_per_revolution
    step = max(1, turn // _FRAMES_PER_REVOLUTION)
    every = np.arange(0, orbit.t.size, step)
    first, last = _FIRST_REVOLUTIONS * turn, orbit.t.size - _LAST_REVOLUTIONS * turn
    turns = np.arange(first, max(last, first), turn)
    few = turns[:: max(1, -(-turns.size // _BETWEEN))]
    return np.unique(np.concatenate([every[(every <= first) | (every >= last)], few]))


def _shown_case(case: Case) -> Case:
    mesh = case.film.mesh
    around, along, across = _LARGEST_MESH
    shown = replace(
        mesh,
        circumferential=min(mesh.circumferential, around),
        axial=min(mesh.axial, along),
        cross_film=min(mesh.cross_film, across),
    )
    return replace(case, film=replace(case.film, mesh=shown))


def _temperatures(
    solution: FilmSolution, others: Sequence[FilmSolution]
) -> Callable[[float], tuple[Array, float]] | None:
    """Return the speed [rad/s] to the mean across the film and the hottest place [K]."""
    from ..orbit.film_force import field_on

    if solution.thermal is None:
        return None
    films = sorted([*others, solution], key=lambda one: one.problem.speed)
    speeds = np.array([one.problem.speed for one in films])
    heats = [one.thermal.heat.temperature for one in films if one.thermal is not None]
    means = [
        solution.problem.mesh.whole(field_on(solution, one, heat.mean(axis=2)))
        for one, heat in zip(films, heats, strict=True)
    ]
    peaks = np.array([float(heat.max()) for heat in heats])

    def at(speed: float) -> tuple[Array, float]:
        i = int(np.clip(np.searchsorted(speeds, speed), 1, max(len(films) - 1, 1)))
        low, high = (i - 1, i) if len(films) > 1 else (0, 0)
        span = float(speeds[high] - speeds[low])
        share = min(max((speed - float(speeds[low])) / span, 0.0), 1.0) if span else 0.0
        hottest = float((1.0 - share) * peaks[low] + share * peaks[high])
        return (1.0 - share) * means[low] + share * means[high], hottest

    return at
