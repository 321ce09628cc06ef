"""From a scenario and its table to simulated orbits."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from ..scenario.settings import OrbitForce, SpeedRamp

if TYPE_CHECKING:
    from ..model.rotor import RigidRotor
    from ..orbit import Orbit, OrbitProblem, SpeedSchedule
    from ..scenario import OrbitSettings, Scenario
    from ..table import CoefficientTable

RUN_UP_SECONDS = 1.0
"""Of the run-up that is added to an orbit at one speed."""
HOLD_SECONDS = 0.3
"""At its top speed after that, to show what the run-up has led to."""
RUN_UP_REVOLUTIONS = 60
"""At the top speed, of the constant-speed orbit that is added to a run-up."""


def simulate_orbit(
    scenario: Scenario, table: CoefficientTable | None = None, *, thermal_model: str | None = None
) -> Orbit:
    """Integrate the scenario's orbit.

    Parameters
    ----------
    scenario : Scenario
        With ``[orbit]`` and ``[rotor]``.
    table : CoefficientTable, optional
        Of this scenario, or any other that covers its clearance and speeds. Default: it is
        computed.
    thermal_model : str, optional
        Default: ``thd`` where the table has it.

    Returns
    -------
    Orbit
        How the run ended is its ``status``.

    Raises
    ------
    InputError
        The scenario has no orbit, or the table does not cover it.
    """
    from ..orbit import simulate

    if table is None:
        from ..sweep import tabulate

        table = tabulate(scenario)
    return simulate(orbit_problem(scenario, table, thermal_model=thermal_model))


def orbit_problem(
    scenario: Scenario,
    table: CoefficientTable,
    *,
    thermal_model: str | None = None,
    schedule: SpeedSchedule | None = None,
) -> OrbitProblem:
    """Put the scenario's orbit together; `schedule` replaces its speed (see `simulate_orbit`)."""
    from ..orbit import LinearForce, OrbitProblem, rigid_rotor

    settings, rotor = orbit_settings(scenario)
    if settings.force is not OrbitForce.LINEAR:
        raise InputError(
            'only "linear" can be simulated from a table',
            source=scenario.source,
            key="orbit.force",
            value=settings.force.value,
        )
    model = thermal_model or preferred_model(table)
    one = table.select(thermal_model=model, radial_clearance=settings.radial_clearance)
    force = LinearForce(
        coefficients=one.interpolator(),
        radial_clearance=settings.radial_clearance,
        equilibrium=static_position(one),
    )
    return OrbitProblem(
        force=force,
        rotor=rigid_rotor(rotor.mass, rotor.unbalance),
        schedule=schedule or scenario_schedule(settings),
        initial_displacement=settings.initial_displacement,
        initial_velocity=settings.initial_velocity,
        minimum_film=scenario.bearing.roughness,
        thermal_model=model,
    )


def orbit_settings(scenario: Scenario) -> tuple[OrbitSettings, RigidRotor]:
    """What to simulate, or an `InputError` that says what the scenario lacks."""
    if scenario.orbit is None or scenario.rotor is None:
        missing = "orbit" if scenario.orbit is None else "rotor"
        raise InputError(
            f"is missing: an orbit needs the tables [rotor] and [orbit]; add [{missing}]",
            source=scenario.source,
            key=missing,
        )
    return scenario.orbit, scenario.rotor


def scenario_schedule(settings: OrbitSettings) -> SpeedSchedule:
    """Shaft speed over time, as the scenario has it."""
    from ..orbit import SpeedSchedule

    if isinstance(settings.speed, SpeedRamp):
        ramp = settings.speed
        return SpeedSchedule.ramp(ramp.start, ramp.stop, ramp.duration)
    return SpeedSchedule.constant(settings.speed, settings.revolutions or RUN_UP_REVOLUTIONS)


def companion_schedule(settings: OrbitSettings, table: CoefficientTable) -> SpeedSchedule:
    """The other kind of run: up from the lowest speed, or constant at the ramp's end."""
    from ..orbit import SpeedSchedule

    if isinstance(settings.speed, SpeedRamp):
        return SpeedSchedule.constant(settings.speed.stop, RUN_UP_REVOLUTIONS)
    lowest = float(table.speeds[0])
    if settings.speed <= lowest:
        return scenario_schedule(settings)
    return SpeedSchedule.ramp(lowest, settings.speed, RUN_UP_SECONDS, HOLD_SECONDS)


def preferred_model(table: CoefficientTable) -> str:
    """``thd`` where the table has it, or its first thermal model."""
    models = [str(name) for name in table.dataset["thermal_model"].values]
    return "thd" if "thd" in models else models[0]


def static_position(one: CoefficientTable) -> Callable[[float], tuple[float, float]]:
    """Journal's static position over speed, from a table of one curve.

    Returns
    -------
    callable
        speed [rad/s] -> (x, y) [m] in the load frame; a monotone interpolant (PCHIP) through the
        converged points.
    """
    from scipy.interpolate import PchipInterpolator

    usable = one.converged.ravel()
    curve = one.dataset.squeeze(list(one.choices))
    eccentricity = curve["eccentricity_ratio"].values * float(curve["radial_clearance"])
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
