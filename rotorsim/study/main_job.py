"""The main job after the table: stability, orbits, film fields."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from ..bearing.drawing import STANDARD_GRAVITY
from ..compiled import is_kept
from ..errors import InputError, RotorsimError, interruption
from ..model.orbit import OrbitForce, SpeedRamp
from ..orbit.description import describe_orbit
from . import orbits as orbit_steps
from .measured import Measured, deviations, deviations_document
from .orbits import FilmFrame, film_in_motion
from .stability import Campbell, StabilityCurve, campbell_curves, stability_curves
from .transient import Transient, simulate_transient

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..bearing.operating_point import OperatingPoint
    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario
    from ..machine.map import StabilityMap
    from ..orbit import Orbit
    from .stability import StabilityCurve


_Result = TypeVar("_Result")
Announce = Callable[[str], None]
_MAP_CELLS = 241
"""Along each axis of the stability map."""
_PAD_MAP_CELLS = 61
"""With tilting pads, whose eigenvalues have no closed form."""
_FILM_FRAMES = 12
"""Speeds at which the film's fields are kept for the recording."""


@dataclass(frozen=True)
class Results:
    """Everything the main job computed (SI); what failed is missing and named in `problems`.

    orbits : Each thermal model at constant speed, then each through the run-up.
    films : With their fields, in the orbit's clearance: for each thermal model, ascending in speed.
    film_motion : Along orbits on the nonlinear film, ascending in time.
    modes : Of the scenario's rotor over speed in the orbit's clearance, for each thermal model.
    problems : What went wrong, where, and what to do.
    measured : Points to draw over the curves.
    """

    scenario: Scenario
    table: CoefficientTable
    points: tuple[OperatingPoint, ...] = ()
    curves: tuple[StabilityCurve, ...] = ()
    chart: StabilityMap | None = None
    orbits: tuple[Orbit, ...] = ()
    films: tuple[OperatingPoint, ...] = ()
    film_motion: tuple[FilmFrame, ...] = ()
    modes: tuple[Campbell, ...] = ()
    transient: Transient | None = None
    problems: tuple[str, ...] = ()
    measured: tuple[Measured, ...] = ()

    @property
    def rotor_mass(self) -> float | None:
        """Per bearing [kg]; None without a rotor, or with one that is not rigid."""
        rotor = self.scenario.rotor
        return None if rotor is None else rotor.rigid_mass

    @cached_property
    def orbit_rows(self) -> list[dict[str, Any]]:
        """Return the description of each orbit (see `describe_orbit`)."""
        return [describe_orbit(orbit) for orbit in self.orbits]

    @property
    def films_at_top_speed(self) -> list[OperatingPoint]:
        """Film at the highest speed, of each thermal model."""
        return list({point.thermal_model: point for point in self.films}.values())


@dataclass
class Attempts:
    """Steps of which one may fail without costing the others."""

    announce: Announce
    problems: list[str] = field(default_factory=list)

    def __call__(self, label: str, step: Callable[[], _Result], instead: _Result) -> _Result:
        """Announce and do one step; note a failure and go on with `instead`."""
        self.announce(label)
        try:
            return step()
        except RotorsimError as error:
            self.problems.append(f"{label}: {error}")
        except Exception as error:
            if stop := interruption(error):
                raise stop from None
            # A fault in one step must not cost what the others computed.
            place = traceback.extract_tb(error.__traceback__)[-1]
            where = f"{Path(place.filename).name}:{place.lineno}"
            self.problems.append(f"{label}: {type(error).__name__}: {error} ({where})")
        return instead


@contextmanager
def compiled_ahead(scenario: Scenario) -> Iterator[None]:
    """Compile what orbits and maps call in another process, while the block computes films.

    Once for an installation: afterwards the machine code is on disk.
    """
    from ..orbit.march import march
    from .processes import processes

    if scenario.orbit is None or is_kept(march):
        yield
        return
    with processes(1) as pool:
        pool.submit(_compile_motion)
        yield


def _compile_motion() -> None:
    from ..machine.rates import growth_rate_map
    from ..orbit import OrbitProblem, ShortBearingForce, SpeedSchedule, simulate
    from ..rotor import Rotor

    growth_rate_map(np.eye(2), np.eye(2), [1.0])
    film = ShortBearingForce(viscosity=0.01, length=0.02, radius=0.02, radial_clearance=1e-4)
    schedule = SpeedSchedule.constant(100.0, 1.0)
    simulate(OrbitProblem(film, Rotor.rigid(1.0), schedule, static_load=(10.0, 0.0)))


def compute(
    scenario: Scenario,
    points: Sequence[OperatingPoint],
    table: CoefficientTable,
    announce: Announce = lambda _text: None,
    orbits: Sequence[Orbit] | None = None,
) -> Results:
    """Do everything that follows from the table; nothing is written.

    With `orbits` those are taken for the scenario's, and none is simulated.
    """
    attempt = Attempts(announce)
    curves = attempt("critical mass", lambda: stability_curves(table, scenario.rotor), [])
    modes = attempt("eigenvalues", lambda: _modes_of(scenario, table), [])
    chart = attempt("stability map", lambda: map_of(scenario, table), None)
    films: list[OperatingPoint] = []
    motion: list[FilmFrame] = []
    if scenario.orbit is not None:
        settings, _ = orbit_steps.orbit_settings(scenario)
        if orbits is None:
            orbits = _simulated_orbits(scenario, table, attempt)
        films = attempt(
            "film fields", lambda: _film_points(scenario, settings.radial_clearance), []
        )
        if settings.force is OrbitForce.FILM:
            for orbit in orbits:
                label = f"film along the orbit, {orbit.thermal_model}"
                motion += attempt(label, lambda orbit=orbit: film_in_motion(scenario, orbit), [])
    orbits = orbits or ()
    transient = None
    if scenario.transient is not None:
        transient = attempt(
            "thermal transient", lambda: simulate_transient(scenario, keep_fields=True), None
        )
    return Results(
        scenario=scenario,
        table=table,
        points=tuple(points),
        curves=tuple(curves),
        chart=chart,
        orbits=tuple(orbits),
        films=tuple(films),
        film_motion=tuple(motion),
        modes=tuple(modes),
        transient=transient,
        problems=tuple(attempt.problems),
    )


def _simulated_orbits(
    scenario: Scenario, table: CoefficientTable, attempt: Attempts
) -> list[Orbit]:
    """Return the scenario's orbit with each thermal model, and on a linear film its companion."""
    settings, _ = orbit_steps.orbit_settings(scenario)
    ramped = isinstance(settings.speed, SpeedRamp)
    orbits: list[Orbit] = []
    # A nonlinear film is simulated as the scenario says and no further: it takes its time.
    # An actuator is designed for one speed: no run-up beside it.
    alone = settings.force is not OrbitForce.LINEAR or settings.actuator is not None
    for companion in (False,) if alone else (False, True):
        for model in scenario.thermal_models:
            kind = "changing" if ramped != companion else "constant"
            orbit = attempt(
                f"orbit at {kind} speed, {model.value}",
                lambda model=model, companion=companion: _one_orbit(
                    scenario, table, model.value, companion
                ),
                None,
            )
            orbits += [] if orbit is None else [orbit]
    return orbits


def _one_orbit(scenario: Scenario, table: CoefficientTable, model: str, companion: bool) -> Orbit:
    """Return the scenario's orbit with one thermal model, or its companion.

    See `companion_schedule`.
    """
    settings, _ = orbit_steps.orbit_settings(scenario)
    schedule = orbit_steps.companion_schedule(settings, table) if companion else None
    return orbit_steps.simulate_orbit(scenario, table, thermal_model=model, schedule=schedule)


def map_of(scenario: Scenario, table: CoefficientTable) -> StabilityMap:
    """Return the stability map over speed and the scenario's masses.

    Without masses in the scenario: up to three times that of its rotor; see `_usual_mass`.
    """
    from ..machine.map import stability_map

    settings = scenario.stability
    cells = _PAD_MAP_CELLS if "full_stiffness" in table.dataset else _MAP_CELLS
    speeds = np.linspace(table.speeds[0], table.speeds[-1], cells)
    speeds = speeds if len(table.speeds) > 1 else table.speeds
    if settings is not None:
        return stability_map(table, np.asarray(settings.masses), speeds)
    mass = np.linspace(0.05, 3.0, cells) * _usual_mass(scenario, table)
    return stability_map(table, mass, speeds)


def _usual_mass(scenario: Scenario, table: CoefficientTable) -> float:
    """Return the rotor's mass per bearing [kg]; without one that of its kind.

    That is the critical mass at the highest speed (the median of all), or, where no mass is
    critical, what weighs as much as the load.
    """
    from ..bearing.whirl import rigid_thresholds

    if scenario.rotor is not None:
        return scenario.rotor.total_mass
    top = rigid_thresholds(
        table.stiffness[..., -1, :, :], table.damping[..., -1, :, :], table.speeds[-1]
    )
    known = top.critical_mass[np.isfinite(top.critical_mass)]
    if not known.size and "load" in table.dataset:
        load = table.dataset["load"].values
        known = load[np.isfinite(load) & (load > 0.0)] / STANDARD_GRAVITY
    if not known.size:
        raise InputError("needs masses: no mass is critical here", key="stability.mass")
    return float(np.median(known))


def _modes_of(scenario: Scenario, table: CoefficientTable) -> list[Campbell]:
    """Return all modes of the scenario's rotor over speed, for each thermal model of the table.

    In the orbit's clearance; without an orbit in the first one.
    """
    rotor, settings = scenario.rotor, scenario.orbit
    if rotor is None:
        return []
    clearance = settings.radial_clearance if settings else scenario.radial_clearances[0]
    found = []
    for model in (str(name) for name in table.dataset["thermal_model"].values):
        one = orbit_steps.curve_of(table, model, clearance)
        if one.converged.any():
            found += campbell_curves(one, rotor, count=None)
    return [curve for curve in found if curve.branches.parameter.size > 1]


def _film_points(scenario: Scenario, clearance: float) -> list[OperatingPoint]:
    """Return films over the speeds with their fields, for each thermal model.

    Each starts the next.
    """
    from ..bearing.solve import solve_case

    count = min(len(scenario.speeds), _FILM_FRAMES)
    chosen = np.unique(np.linspace(0, len(scenario.speeds) - 1, count).round().astype(int))
    found = []
    for model in scenario.thermal_models:
        case, warm = scenario.case(clearance, model), None
        for speed in scenario.speeds[chosen]:
            point, warm = solve_case(case, float(speed), initial=warm, keep_fields=True)
            if point.converged:
                found.append(point)
            else:
                warm = None
    return found


def summary(results: Results, files: dict[str, Any]) -> dict[str, Any]:
    """Return the closing words as plain data: counts, heating's effect, orbits, files, problems."""
    counts: dict[str, int] = {}
    for point in results.points:
        counts[point.status.value] = counts.get(point.status.value, 0) + 1
    mass = results.rotor_mass
    settings = results.scenario.orbit
    passive = settings is None or settings.actuator is None
    rows = []
    for orbit, described in zip(results.orbits, results.orbit_rows, strict=True):
        row = dict(described)
        # the eigenvalues are those of the film alone
        if row["kind"] == "constant speed" and mass is not None and passive:
            row["eigenvalue_growth_rate"] = _expected_growth(results.table, orbit, mass)
        rows.append(row)
    return {
        "title": results.scenario.title,
        "counts": counts,
        "rotor_mass": mass,
        "heating": _heating_effect(results.points, results.curves),
        "orbits": rows,
        "measured": deviations_document(deviations(results.table, results.measured)),
        "transient": None if results.transient is None else results.transient.describe(),
        "files": files,
        "problems": list(results.problems),
    }


def _expected_growth(table: CoefficientTable, orbit: Orbit, mass: float) -> float | None:
    """Return the growth rate that the eigenvalues give for the orbit's last speed [1/s]."""
    from ..errors import InputError
    from ..machine.rates import eigenvalues
    from .orbits import curve_of

    try:
        one = curve_of(table, orbit.thermal_model, orbit.radial_clearance)
        film = one.at(float(orbit.speed[-1]))
    except InputError:
        return None
    return float(eigenvalues(film.stiffness, film.damping, mass).real.max())


def _heating_effect(
    points: Sequence[OperatingPoint], curves: Sequence[StabilityCurve]
) -> list[dict[str, Any]]:
    """Return isothermal against THD at the highest speed, clearance by clearance.

    Returns: ``radial_clearance``, ``speed``, and for each model's name what the film carries and
        costs there, the critical mass, and of the scenario's rotor its ``verdict`` (``stable``,
        ``unstable`` or None), ``verdict_over_range`` (``stable throughout``, ``unstable
        throughout``, ``changes`` or None) and ``threshold_speeds``; ``threshold_speed`` is the
        first of them.
    """
    top = max((point.speed for point in points), default=0.0)
    known = {
        (curve.choices["thermal_model"], curve.choices["radial_clearance"]): curve
        for curve in curves
    }
    rows: dict[float, dict[str, Any]] = {}
    for point in points:
        if point.speed != top:
            continue
        row = rows.setdefault(
            point.radial_clearance, {"radial_clearance": point.radial_clearance, "speed": top}
        )
        curve = known.get((point.thermal_model, point.radial_clearance))
        found = () if curve is None else curve.threshold_speeds
        heat = point.heat_balance
        row[point.thermal_model] = {
            "status": point.status,
            "load": point.load,
            "friction_force": point.friction_force,
            "power_loss": point.power_loss,
            "side_flow": point.side_flow,
            "max_pressure": point.max_pressure,
            "max_temperature": point.max_temperature,
            "outlet_temperature": point.outlet_temperature,
            "wall_heat_share": None if heat is None else heat.wall_share,
            "min_film_thickness": point.min_film_thickness,
            "critical_mass": point.critical_mass,
            "stability": point.stability,
            "verdict": None if curve is None else curve.verdict,
            "verdict_over_range": None if curve is None else curve.verdict_over_range,
            "threshold_speeds": list(found),
            "threshold_speed": found[0] if found else None,
        }
    return list(rows.values())
