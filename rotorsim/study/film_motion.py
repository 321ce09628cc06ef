"""The film at rest and under a journal in motion, frame by frame, for playback."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..bearing.operating_point import OperatingPoint
from ..errors import InputError
from .orbits import orbit_settings

if TYPE_CHECKING:
    from ..files.scenario import Scenario
    from ..film.solution import FilmSolution
    from ..model import Case
    from ..orbit import Orbit

Array = NDArray[np.float64]

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

    @property
    def length(self) -> float:
        """Of the bearing [m]."""
        return float(self.y[-1] - self.y[0]) * self.y.size / (self.y.size - 1)


def film_at_rest(point: OperatingPoint, journal_radius: float) -> FilmFrame:
    """Film of an operating point that kept its fields; `journal_radius` in m.

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
        journal_radius=journal_radius,
        radial_clearance=point.radial_clearance,
        centre=point.eccentricity_ratio
        * point.radial_clearance
        * np.array([np.cos(angle), np.sin(angle)]),
    )


def film_in_motion(scenario: Scenario, orbit: Orbit) -> list[FilmFrame]:
    """Film along an orbit on the nonlinear film, ascending in time.

    Pressure is solved for the journal's position and velocity; the temperature is that of the
    operating point, as in the simulation. Moments at which no film is found are left out.
    """
    from ..orbit.film_force import SolvedFilmForce, operating_film

    case = _shown_case(
        scenario.case(orbit_settings(scenario)[0].radial_clearance, orbit.thermal_model)
    )
    solution = operating_film(case, float(np.abs(orbit.speed).max()))
    force, mesh = SolvedFilmForce.of(case, solution), solution.problem.mesh
    temperature, hottest = _temperature(solution)
    frames = []
    for row in _shown_samples(orbit):
        motion = (orbit.x, orbit.y, orbit.vx, orbit.vy, orbit.speed)
        try:
            state = force.film(*(float(values[row]) for values in motion))
        except ArithmeticError:
            continue
        frames.append(
            FilmFrame(
                thermal_model=orbit.thermal_model,
                speed=float(orbit.speed[row]),
                theta=mesh.theta + solution.frame,
                y=mesh.whole_y,
                pressure=mesh.whole(state.solution.pressure),
                temperature=temperature,
                max_temperature=hottest,
                journal_radius=case.bearing.journal_radius,
                radial_clearance=case.bearing.radial_clearance,
                centre=np.array([orbit.x[row], orbit.y[row]]),
                time=float(orbit.t[row]),
            )
        )
    return frames


def _shown_samples(orbit: Orbit) -> NDArray[np.intp]:
    """Samples at which the film is shown: every move at both ends of the run, few between."""
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


def _temperature(solution: FilmSolution) -> tuple[Array | None, float | None]:
    """Mean across the film over the whole bearing, and the hottest place [K]."""
    if solution.thermal is None:
        return None, None
    field = solution.thermal.heat.temperature
    return solution.problem.mesh.whole(field.mean(axis=2)), float(field.max())
