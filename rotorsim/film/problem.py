"""The film of one bearing at one speed, and its state at given displacements and viscosity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, Booleans
from ..model import (
    Bearing,
    Case,
    Feed,
    FilmSettings,
    Inception,
    Lubricant,
    ThermalModel,
    ThermalSettings,
)
from .banded import NoFilmError
from .elastic import ElasticBore, elastic_bore
from .flow_law import FlowLaw, flow_law
from .geometry import CENTER, FilmGeometry, film_geometry
from .growth import hot_clearances, with_clearances
from .layers import LayerIntegrals, isoviscous_layers
from .mesh import FilmMesh, build_mesh
from .operator import FaceTopology, FilmOperator, face_topology, film_operator
from .rupture import (
    FedFilm,
    OilSupply,
    PressureSolution,
    Recesses,
    RuptureCondition,
    Terms,
    rupture_condition,
)


@dataclass(frozen=True)
class FilmProblem:
    """A film in the film frame: for a plain bearing x along the line of centres, else the load's.

    speed : [rad/s]
    cold : The bearing at the reference temperature of its expansion; `bearing` is the hot one.
    elastic : How the bore gives way; None where it does not.
    """

    bearing: Bearing
    lubricant: Lubricant
    settings: FilmSettings
    thermal: ThermalSettings
    speed: float
    mesh: FilmMesh
    topology: FaceTopology
    geometry: FilmGeometry
    flow_law: FlowLaw
    rupture: RuptureCondition
    cold: Bearing
    elastic: ElasticBore | None = None

    @property
    def surface_speed(self) -> float:
        """U = omega R [m/s]."""
        return self.speed * self.bearing.journal_radius

    @property
    def is_thermal(self) -> bool:
        """Return whether the energy equation is solved."""
        return self.thermal.model is ThermalModel.THD

    @property
    def anchored(self) -> bool:
        """Return whether a ruptured line stays ruptured up to the next inception."""
        return self.is_thermal or self.settings.inception is Inception.MAX_FILM


@dataclass(frozen=True)
class FilmState:
    """The film at one vector of displacements and one viscosity field.

    displacement : (q,) array. Generalised displacements, in the order of
        `FilmGeometry.displacements`; film frame.
    thickness : (5, n, m) array. At each cell's centre and on its faces [m].
    operator : Its Couette flow is what the ruptured film carries.
    layers : Under the problem's flow law.
    force : (q,) array. Generalised forces of the film; the first two are those on the journal [N],
        film frame.
    deflection : (5, n, m) array or None. Of the bore under the pressure, at the same points as the
        thickness, which holds it [m].
    """

    problem: FilmProblem
    displacement: Array
    thickness: Array
    operator: FilmOperator
    layers: LayerIntegrals
    solution: PressureSolution
    force: Array
    deflection: Array | None = None

    @property
    def center_thickness(self) -> Array:
        """Film thickness at the cell centres [m], (n, m)."""
        return self.thickness[CENTER]

    @property
    def min_thickness(self) -> float:
        """Smallest film thickness over the lands [m]."""
        return self.problem.geometry.thinnest(self.thickness)


def film_problem(
    case: Case, speed: float, bearing: Bearing, position: tuple[float, float]
) -> FilmProblem:
    """Return mesh and neighbourhoods of the case's `bearing`, film frame, at `position`.

    With thermal expansion at supply temperature throughout.
    """
    mesh = build_mesh(bearing, case.film, position)
    cold, expansion = bearing, case.thermal.expansion
    if expansion is not None:
        supplied = case.thermal.supply_temperature
        solids = np.array([[supplied, 0.0]] * (len(cold.pads) + 1))
        bearing = with_clearances(cold, hot_clearances(cold, expansion, supplied, solids))
    supply = np.array([groove.supply_pressure for groove in bearing.grooves] or [0.0])
    return FilmProblem(
        bearing=bearing,
        lubricant=case.lubricant,
        settings=case.film,
        thermal=case.thermal,
        speed=speed,
        mesh=mesh,
        topology=face_topology(mesh, supply),
        geometry=film_geometry(bearing, mesh),
        flow_law=flow_law(case),
        rupture=_rupture(case, bearing, mesh),
        cold=cold,
        elastic=elastic_bore(bearing, mesh),
    )


def _rupture(case: Case, bearing: Bearing, mesh: FilmMesh) -> RuptureCondition:
    """Return the rupture condition of the case, with the recesses and the supply of the bearing."""
    condition = rupture_condition(case.film.cavitation, _oil_supply(bearing, mesh, case.thermal))
    if all(groove.restrictor is None for groove in bearing.grooves):
        return condition
    recesses = Recesses.of(bearing, mesh, case.lubricant, case.thermal.supply_temperature)
    return FedFilm(condition, recesses)


def _oil_supply(bearing: Bearing, mesh: FilmMesh, thermal: ThermalSettings) -> OilSupply | None:
    """Return the oil for the leading edges of pads that nothing but it can fill."""
    if bearing.supply_flow is None or bearing.feed is Feed.FLOODED:
        return None
    count = len(bearing.pads)
    flow = np.full(count, bearing.supply_flow / count / mesh.multiplicity)
    return OilSupply(flow, thermal.hot_oil_carry_over, mesh.supply[:, 0])


def supply_layers(problem: FilmProblem) -> LayerIntegrals:
    """Return the integrals of a film that has the supply's temperature throughout."""
    viscosity = float(problem.lubricant.viscosity(problem.thermal.supply_temperature))
    return isoviscous_layers(problem.mesh.shape, viscosity)


def film_state(
    problem: FilmProblem,
    displacement: ArrayLike,
    layers: LayerIntegrals,
    *,
    velocity: ArrayLike | None = None,
    start: Booleans | None = None,
    frozen: Booleans | None = None,
) -> FilmState:
    """Solve for pressure and forces at the displacements q.

    displacement : (q,) array. Film frame.
    layers : Of laminar flow with the film's viscosity, or of a film under the same law.
    velocity : (q,) array. Rates of the displacements [1/s]; at rest without.
    start, frozen : (n, m) bool arrays. See `RuptureCondition.solve`.
    Raises NoFilmError: The walls touch.
    """
    displacement = np.array(displacement, dtype=float)
    squeeze = None
    if velocity is not None and np.any(velocity):
        shapes = problem.geometry.displacements.shapes[:, CENTER]
        squeeze = np.tensordot(np.asarray(velocity, dtype=float), shapes, axes=1)
    region = problem.mesh.region if problem.anchored else None
    terms = Terms(squeeze, start, region, frozen)

    def film(deflection: Array | None) -> FilmState:
        return _film_state(problem, displacement, layers, terms, deflection)

    return film(None) if problem.elastic is None else problem.elastic.settle(film)


def _film_state(
    problem: FilmProblem,
    displacement: Array,
    layers: LayerIntegrals,
    terms: Terms,
    deflection: Array | None,
) -> FilmState:
    geometry = problem.geometry
    thickness = geometry.thickness(displacement)
    if deflection is not None:
        thickness += deflection
    if geometry.thinnest(thickness) <= 0.0:
        raise NoFilmError(
            "the journal touches the bore: lobes and misalignment leave less room than asked"
        )
    laminar = layers if layers.turbulent is None else layers.turbulent.laminar
    layers = problem.flow_law.integrals(laminar, thickness[CENTER], problem.surface_speed)
    operator = film_operator(problem.topology, thickness, layers, problem.surface_speed)
    operator, solution = problem.rupture.solve(operator, terms)
    force = geometry.forces(solution.pressure * operator.area)
    return FilmState(
        problem, displacement, thickness, operator, layers, solution, force, deflection
    )
