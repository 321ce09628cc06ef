"""The film of one bearing at one speed: what stays put while position and heat change."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..model import (
    Bearing,
    Case,
    Cavitation,
    FilmSettings,
    Inception,
    Lubricant,
    ThermalModel,
    ThermalSettings,
)
from .banded import NoFilmError
from .cavitation import solve_pressure
from .geometry import EvaluationPoints, evaluation_points, film_thickness, thinnest_film
from .jfo import solve_jfo
from .layers import LayerIntegrals
from .linearized import film_force
from .mesh import FilmMesh, build_mesh
from .operator import FaceTopology, face_topology, film_operator
from .state import FilmState

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FilmProblem:
    """A film in the film frame: for a plain bearing x along the line of centres, else the load's.

    Attributes
    ----------
    bearing : Bearing
    lubricant : Lubricant
    settings : FilmSettings
    thermal : ThermalSettings
    speed : float
        [rad/s]
    mesh : FilmMesh
    topology : FaceTopology
    evaluation_points : EvaluationPoints
    """

    bearing: Bearing
    lubricant: Lubricant
    settings: FilmSettings
    thermal: ThermalSettings
    speed: float
    mesh: FilmMesh
    topology: FaceTopology
    evaluation_points: EvaluationPoints

    @property
    def surface_speed(self) -> float:
        """U = omega R [m/s]."""
        return self.speed * self.bearing.journal_radius

    @property
    def is_thermal(self) -> bool:
        """Whether the energy equation is solved."""
        return self.thermal.model is ThermalModel.THD

    @property
    def anchored(self) -> bool:
        """Whether a ruptured line stays ruptured up to the next inception."""
        return self.is_thermal or self.settings.inception is Inception.MAX_FILM


def film_problem(
    case: Case, speed: float, bearing: Bearing, position: tuple[float, float]
) -> FilmProblem:
    """Mesh and neighbourhoods of `bearing` (the case's, in the film frame) around `position`."""
    mesh = build_mesh(bearing, case.film, position)
    supply = np.array([groove.supply_pressure for groove in bearing.grooves] or [0.0])
    return FilmProblem(
        bearing=bearing,
        lubricant=case.lubricant,
        settings=case.film,
        thermal=case.thermal,
        speed=speed,
        mesh=mesh,
        topology=face_topology(mesh, supply),
        evaluation_points=evaluation_points(bearing, mesh.theta_faces, mesh.y_faces),
    )


def film_state(
    problem: FilmProblem,
    position: tuple[float, float],
    layers: LayerIntegrals,
    *,
    velocity: tuple[float, float] = (0.0, 0.0),
    start: NDArray[np.bool_] | None = None,
    frozen: NDArray[np.bool_] | None = None,
) -> FilmState:
    """Pressure and force with the journal at `position` [m], moving with `velocity` [m/s]."""
    mesh = problem.mesh
    thickness = film_thickness(problem.evaluation_points, position)
    if thinnest_film(problem.evaluation_points, position) <= 0.0:
        raise NoFilmError("the journal touches the bore: lobes and tilt leave less room than asked")
    operator = film_operator(problem.topology, thickness, layers, problem.surface_speed)
    squeeze = None
    if velocity != (0.0, 0.0):
        squeeze = -velocity[0] * operator.cos[0] - velocity[1] * operator.sin[0]
        squeeze = np.broadcast_to(squeeze, mesh.shape)
    if problem.settings.cavitation is Cavitation.JFO:
        operator, solution = solve_jfo(operator, squeeze=squeeze, start=start, frozen=frozen)
    else:
        solution = solve_pressure(
            operator,
            problem.settings.cavitation,
            squeeze=squeeze,
            start=start,
            region=mesh.region if problem.anchored else None,
            frozen=frozen,
        )
    force = film_force(operator, solution.pressure, mesh.multiplicity)
    return FilmState(position, thickness, operator, layers, solution, force)
