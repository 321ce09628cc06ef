"""The film under a journal in motion, for playback."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..study.orbits import orbit_settings

if TYPE_CHECKING:
    from ..files.scenario import Scenario
    from ..film.solution import FilmSolution
    from ..model import Case
    from ..orbit import Orbit
    from .recording import FilmSurface

FRAMES_PER_REVOLUTION = 8
FIRST_REVOLUTIONS, LAST_REVOLUTIONS = 8, 32
"""At the run's beginning and end, shown in full."""
BETWEEN = 64
"""Frames of what lies between, each at a whole turn of the shaft."""
LARGEST_MESH = (156, 48, 24)
"""Finer films than this are shown on this mesh."""


def film_in_motion(scenario: Scenario, orbit: Orbit) -> list[FilmSurface]:
    """Film along an orbit on the nonlinear film, ascending in time.

    Pressure is solved for the journal's position and velocity; the temperature is that of the
    operating point, as in the simulation. Moments at which no film is found are left out.
    """
    from ..orbit import SolvedFilmForce, operating_film
    from .recording import FilmSurface

    case = _shown_case(
        scenario.case(orbit_settings(scenario)[0].radial_clearance, orbit.thermal_model)
    )
    solution = operating_film(case, float(np.abs(orbit.speed).max()))
    force, mesh = SolvedFilmForce.of(case, solution), solution.problem.mesh
    temperature = _mean_temperature(solution)
    frames = []
    for row in shown_samples(orbit):
        motion = (orbit.x, orbit.y, orbit.vx, orbit.vy, orbit.speed)
        try:
            state = force.film(*(float(values[row]) for values in motion))
        except ArithmeticError:
            continue
        frames.append(
            FilmSurface(
                name=orbit.thermal_model,
                speed=float(orbit.speed[row]),
                theta=mesh.theta + solution.frame,
                y=mesh.whole_y,
                pressure=mesh.whole(state.solution.pressure),
                temperature=temperature,
                journal_radius=case.bearing.journal_radius,
                radial_clearance=case.bearing.radial_clearance,
                centre=np.array([orbit.x[row], orbit.y[row]]),
                time=float(orbit.t[row]),
            )
        )
    return frames


def shown_samples(orbit: Orbit) -> NDArray[np.intp]:
    """Samples at which the film is shown: every move at both ends of the run, few between."""
    turn = orbit.samples_per_revolution
    step = max(1, turn // FRAMES_PER_REVOLUTION)
    every = np.arange(0, orbit.t.size, step)
    first, last = FIRST_REVOLUTIONS * turn, orbit.t.size - LAST_REVOLUTIONS * turn
    turns = np.arange(first, max(last, first), turn)
    few = turns[:: max(1, -(-turns.size // BETWEEN))]
    return np.unique(np.concatenate([every[(every <= first) | (every >= last)], few]))


def _shown_case(case: Case) -> Case:
    mesh = case.film.mesh
    around, along, across = LARGEST_MESH
    shown = replace(
        mesh,
        circumferential=min(mesh.circumferential, around),
        axial=min(mesh.axial, along),
        cross_film=min(mesh.cross_film, across),
    )
    return replace(case, film=replace(case.film, mesh=shown))


def _mean_temperature(solution: FilmSolution) -> NDArray[np.float64] | None:
    if solution.thermal is None:
        return None
    mean = solution.thermal.heat.temperature.mean(axis=2)
    return solution.problem.mesh.whole(mean)
