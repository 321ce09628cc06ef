"""The film's force at any position and velocity: from its map where one is exact, else solved."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..film.banded import NoFilmError, SingularFilmError
from ..film.layers import LayerIntegrals
from ..film.problem import FilmProblem, FilmState, film_state
from ..film.solution import FilmSolution, solve_film
from ..model import Bearing, Case, EccentricityTarget, Inception, LoadTarget, ThermalModel
from ..status import SolveStatus
from .clearance import minimum_film
from .film_map import MAPPED, Progress, film_force_map
from .force_map import FilmMapForce
from .forces import BearingForce

Array = NDArray[np.float64]

_THINNEST = 2e-3
"""Film over clearance up to which it is solved; closer trial steps are pulled back to it."""


@dataclass(frozen=True)
class LoadedFilm:
    """A film force with the load that it carries.

    Attributes
    ----------
    force : BearingForce
    load : float
        Static load along x [N].
    bearing : Bearing
    note : str
        What the force takes for granted, for messages and labels.
    """

    force: BearingForce
    load: float
    bearing: Bearing
    note: str


@dataclass
class SolvedFilmForce:
    """The film solved at every call, from the full cells of the call before.

    Parameters
    ----------
    problem : FilmProblem
        Mesh, slots and grooves; they stand still in the bush while the journal moves. Its speed is
        replaced by that of the call.
    layers : LayerIntegrals
        Viscosity across the film, frozen in space.
    frame : float
        Angle of the problem's x axis in the load frame [rad].
    bearing : Bearing
        In the load frame.
    name : str

    Notes
    -----
    What is remembered between calls saves time and nothing else: the complementarity problem has
    one solution.
    """

    problem: FilmProblem
    layers: LayerIntegrals
    frame: float
    bearing: Bearing
    name: str = "film"
    _full: NDArray[np.bool_] | None = field(default=None, init=False, repr=False)

    @property
    def radial_clearance(self) -> float:
        """Radial clearance [m]."""
        return self.bearing.radial_clearance

    @classmethod
    def of(cls, case: Case, solution: FilmSolution) -> SolvedFilmForce:
        """Force of the film that was solved for `case`, its viscosity field kept."""
        mesh = solution.problem.mesh
        # A moving journal may press the film in several places at once. The rule of one stretch of
        # film from each beginning is for a film at rest: here it would make the force jump.
        mesh = replace(mesh, region=np.full_like(mesh.region, -1))
        return cls(
            problem=replace(solution.problem, mesh=mesh),
            layers=solution.state.layers,
            frame=solution.frame,
            bearing=case.bearing,
            name="film" if solution.thermal is None else "film_frozen_viscosity",
        )

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Film force [N]; ArithmeticError where the film cannot be solved."""
        fx, fy = self.film(x, y, vx, vy, speed).force
        cos, sin = math.cos(self.frame), math.sin(self.frame)
        return float(fx * cos - fy * sin), float(fx * sin + fy * cos)

    def film(self, x: float, y: float, vx: float, vy: float, speed: float) -> FilmState:
        """Film with the journal there, in the problem's frame; ArithmeticError as `force`."""
        x, y = self._within(x, y)
        cos, sin = math.cos(self.frame), math.sin(self.frame)
        problem = self.problem
        if speed != problem.speed:
            problem = replace(problem, speed=speed)
        state = film_state(
            problem,
            (x * cos + y * sin, y * cos - x * sin),
            self.layers,
            velocity=(vx * cos + vy * sin, vy * cos - vx * sin),
            start=self._full,
        )
        if not (state.solution.converged and np.all(np.isfinite(state.force))):
            self._full = None
            raise SingularFilmError("the rupture condition was not met in the steps allowed")
        self._full = state.solution.full
        return state

    def _within(self, x: float, y: float) -> tuple[float, float]:
        """Pull a position that touches the bush back towards the centre."""
        least = _THINNEST * self.radial_clearance
        scale = 1.0
        # the film is concave in the position, and wide open at the centre
        for _ in range(60):
            place = np.array([x * scale]), np.array([y * scale])
            if float(minimum_film(self.bearing, *place)[0]) >= least:
                break
            scale *= 0.98 if scale > 0.9 else 0.9
        return x * scale, y * scale


def can_be_mapped(case: Case) -> bool:
    """Whether eccentricity ratio and direction of squeeze alone decide this film (`film_map`)."""
    return (
        case.bearing.is_plain
        and case.bearing.is_symmetric
        and case.thermal.model is ThermalModel.ISOTHERMAL
        and case.film.cavitation in MAPPED
        and case.film.inception is Inception.FREE
    )


def prepare_map(case: Case, progress: Progress | None = None) -> None:
    """Solve the map that the film of `case` is taken from, unless it is kept already.

    Parameters
    ----------
    case : Case
    progress : callable, optional
        See `film_force_map`; not called where there is nothing to do.
    """
    if can_be_mapped(case):
        film_force_map(_length_to_diameter(case), case.film.cavitation, progress=progress)


def _length_to_diameter(case: Case) -> float:
    return case.bearing.length / case.bearing.diameter


def loaded_film(
    case: Case, speed: float, *, cache: Path | None = None, progress: Progress | None = None
) -> LoadedFilm:
    """Film force of a case, with its load.

    Parameters
    ----------
    case : Case
    speed : float
        Of the operating point [rad/s]: where the mesh is graded, where ``max_film`` holds its line
        p = 0, whose viscosity field a heated film keeps, and at which an eccentricity ratio is
        turned into a load.
    cache, progress
        See `film_force_map`.

    Raises
    ------
    InputError
        The operating point cannot be found.
    """
    if can_be_mapped(case):
        return _mapped(case, speed, cache, progress)
    solution = operating_film(case, speed)
    load = float(np.hypot(*solution.state.force))
    rpm = f"{speed * 30.0 / math.pi:.0f} rpm"
    notes = ["film solved at each step"]
    if solution.thermal is not None:
        notes.append(f"viscosity field of the operating point at {rpm}, frozen")
    if solution.problem.rupture.conserves_mass:
        notes.append(
            "liquid fraction as in a steady state: oil stored in the ruptured film left out"
        )
    if solution.problem.mesh.slot.any():
        notes.append(f"p = 0 held where the film is thickest at {rpm}")
    return LoadedFilm(SolvedFilmForce.of(case, solution), load, case.bearing, "; ".join(notes))


def _mapped(case: Case, speed: float, cache: Path | None, progress: Progress | None) -> LoadedFilm:
    bearing, ratio = case.bearing, _length_to_diameter(case)
    force = FilmMapForce(
        film_force_map(ratio, case.film.cavitation, cache=cache, progress=progress),
        float(case.lubricant.viscosity(case.thermal.supply_temperature)),
        bearing.length,
        bearing.journal_radius,
        bearing.radial_clearance,
    )
    note = f"film force from its map over eccentricity and squeeze direction, L/D = {ratio:.4g}"
    if force.force_map.note:
        note += f"; {force.force_map.note}"
    if isinstance(case.target, LoadTarget):
        return LoadedFilm(force, case.target.load, bearing, note)
    assert isinstance(case.target, EccentricityTarget)
    eccentricity = case.target.eccentricity_ratio * bearing.radial_clearance
    load = math.hypot(*force.force(eccentricity, 0.0, 0.0, 0.0, speed))
    return LoadedFilm(force, load, bearing, note)


def operating_film(case: Case, speed: float) -> FilmSolution:
    """Film at rest about which an orbit runs, at `speed` [rad/s]; InputError without one."""
    try:
        solution = solve_film(case, speed)
    except (NoFilmError, SingularFilmError) as error:
        raise InputError(
            f"the film of the orbit's operating point cannot be solved: {error}",
            key="orbit.speed",
            value=speed,
        ) from None
    if solution.status is not SolveStatus.CONVERGED:
        raise InputError(
            f"the orbit's operating point is {solution.status.value}: {solution.message}",
            key="orbit.speed",
            value=speed,
        )
    return solution
