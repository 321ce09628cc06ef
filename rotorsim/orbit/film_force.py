"""The film's force at any position and velocity: from its map where one is exact, else solved."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import block_diag

from ..arrays import Array, Booleans, ComplexArray
from ..bearing.dynamics import pad_mass, pad_springs
from ..bearing.interpolation import Coefficients
from ..bearing.operating_point import condensed
from ..errors import InputError
from ..film.banded import NoFilmError, SingularFilmError
from ..film.compiled_force import FULL_SOMMERFELD, HALF_SOMMERFELD, REYNOLDS, packed_film
from ..film.flow_law import LaminarFlow
from ..film.geometry import film_geometry, rotation
from ..film.layers import LayerIntegrals
from ..film.linearization import linearize
from ..film.pad_solution import solve_pads
from ..film.problem import FilmProblem, FilmState, film_state
from ..film.rupture import FedFilm
from ..film.solution import FilmSolution, solve_film
from ..machine.control import StateFeedback
from ..machine.matrices import first_order
from ..model import (
    Bearing,
    Case,
    Cavitation,
    EccentricityTarget,
    FlowRegime,
    Inception,
    LoadTarget,
    ThermalModel,
)
from ..status import SolveStatus
from . import kernels
from .film_map import MAPPED, Progress, film_force_map
from .force_map import FilmMapForce
from .forces import BearingForce, CompiledForce

_FIELD_SPEEDS, _SLOWEST_FIELD = 7, 0.1
"""Of heated films of a run through the speeds, and the slowest over the highest."""
_THINNEST = 2e-3
"""Film over clearance up to which it is solved; closer trial steps are pulled back to it."""
_QUASI_STATIC = 1e-3
"""Inertia of a pad without any, over that of its geometry."""

_FIELDS = ("f0", "f2", "f2_axial", "g", "pressure_share", "shear_share")


def field_on(solution: FilmSolution, other: FilmSolution, values: Array) -> Array:
    """Return field (n, m, ...) of another speed's film on this one's mesh.

    At the same place of the bush.

    Both meshes have the same cells along the axis; around they may be graded and turned otherwise.
    """
    wanted = np.mod(solution.problem.mesh.theta + solution.frame, 2.0 * math.pi)
    known = np.mod(other.problem.mesh.theta + other.frame, 2.0 * math.pi)
    order = np.argsort(known)
    first, last = order[:1], order[-1:]
    angle = np.concatenate([known[last] - 2.0 * math.pi, known[order], known[first] + 2 * math.pi])
    rows = values[np.concatenate([last, order, first])]
    i = np.searchsorted(angle, wanted, side="right") - 1
    share = (wanted - angle[i]) / (angle[i + 1] - angle[i])
    share = share.reshape(-1, *[1] * (values.ndim - 1))
    return np.asarray((1.0 - share) * rows[i] + share * rows[i + 1])


def _layers_on(solution: FilmSolution, other: FilmSolution) -> LayerIntegrals:
    layers = other.state.layers
    return replace(layers, **{n: field_on(solution, other, getattr(layers, n)) for n in _FIELDS})


@dataclass(frozen=True)
class LoadedFilm:
    """A film force with the load that it carries.

    load : Static load along x [N].
    note : What the force takes for granted, for messages and labels.
    """

    force: BearingForce
    load: float
    bearing: Bearing
    note: str


@dataclass
class SolvedFilmForce:
    """The film solved at every call, from the full cells of the call before.

    problem : Mesh, slots and grooves; they stand still in the bush while the journal moves. Its
        speed is replaced by that of the call.
    layers : Viscosity across the film, frozen in space.
    others : The same of other speeds [rad/s], ascending: the viscosity of the moment lies between
        them.
    frame : Angle of the problem's x axis in the load frame [rad].
    bearing : In the load frame.
    rest : (q,) array. Displacements that leave a film everywhere, those of the operating point;
        problem's frame.

    Notes
    -----
    What is remembered between calls saves time and nothing else: the complementarity problem has
    one solution.
    """

    problem: FilmProblem
    layers: LayerIntegrals
    frame: float
    bearing: Bearing
    rest: Array
    name: str = "film"
    others: tuple[tuple[float, LayerIntegrals], ...] = ()
    _full: Booleans | None = field(default=None, init=False, repr=False)

    @property
    def radial_clearance(self) -> float:
        """Radial clearance [m]."""
        return self.bearing.radial_clearance

    @classmethod
    def of(cls, solution: FilmSolution, others: Sequence[FilmSolution] = ()) -> SolvedFilmForce:
        """Return the force of the solved film, its viscosity field and its clearance kept.

        others : The same film at other speeds, whose viscosity fields are kept as well.
        """
        fields = [(solution.problem.speed, solution.state.layers)]
        fields += [(one.problem.speed, _layers_on(solution, one)) for one in others]
        mesh = solution.problem.mesh
        # All pads move, those without load as well.
        geometry = film_geometry(solution.problem.bearing, mesh)
        # A moving journal may press the film in several places at once. The rule of one stretch of
        # film from each beginning is for a film at rest: here it would make the force jump.
        mesh = replace(mesh, region=np.full_like(mesh.region, -1))
        problem = replace(solution.problem, mesh=mesh, geometry=geometry)
        return (CompiledFilmForce if _compilable(problem) else cls)(
            problem=problem,
            layers=solution.state.layers,
            frame=solution.frame,
            bearing=solution.problem.bearing.turned(solution.frame),
            rest=solution.state.displacement,
            name="film" if solution.thermal is None else "film_frozen_viscosity",
            others=tuple(sorted(fields, key=lambda field: field[0])) if others else (),
        )

    def turned(self, angle: float) -> SolvedFilmForce:
        """Return the force in a frame from whose x axis the present one's lies at `angle` [rad]."""
        bearing = self.bearing.turned(angle)
        return replace(self, frame=self.frame + angle, bearing=bearing)

    def _layers(self, speed: float) -> LayerIntegrals:
        """Return viscosity field at a speed: linear between the known ones, held beyond them."""
        if not self.others:
            return self.layers
        speeds = [known for known, _ in self.others]
        i = int(np.clip(np.searchsorted(speeds, speed) - 1, 0, len(speeds) - 2))
        share = min(max((speed - speeds[i]) / (speeds[i + 1] - speeds[i]), 0.0), 1.0)
        low, high = self.others[i][1], self.others[i + 1][1]
        mixed = {n: (1.0 - share) * getattr(low, n) + share * getattr(high, n) for n in _FIELDS}
        return replace(low, **mixed)

    @property
    def pads(self) -> tuple[str, ...]:
        """Names of the displacements besides the journal's: tilts, pivots and pitches of pads."""
        return self.problem.geometry.displacements.names[2:]

    @cached_property
    def pad_mass(self) -> Array:
        """Mass matrix of the pads' displacements.

        Quasi-static pads, whose mass or inertia is given as 0, follow the film: they have so little
        that it shows nowhere, and an implicit method steps over it.
        """
        mass, pads = pad_mass(self.bearing), self.bearing.pads
        pads = tuple(replace(p, mass=None, tilt_inertia=None, pitch_inertia=None) for p in pads)
        light = _QUASI_STATIC * np.diag(pad_mass(replace(self.bearing, pads=pads)))
        return (mass + np.diag(np.where(np.diag(mass) == 0.0, light, 0.0)))[2:, 2:]

    @cached_property
    def scales(self) -> Array:
        """Return the size of each displacement that changes the film by about the clearance."""
        return self.problem.geometry.displacements.scales

    @cached_property
    def _turn(self) -> Array:
        """From the problem's frame to the load frame, (q, q)."""
        return np.asarray(block_diag(rotation(self.frame), np.eye(len(self.pads))))

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Return film force on the journal [N], pads at rest; ArithmeticError without a film."""
        pads = self.rest[2:]
        q, v = np.array([x, y, *pads]), np.array([vx, vy, *np.zeros(len(pads))])
        fx, fy = self.forces(q, v, speed)[:2]
        return float(fx), float(fy)

    def forces(self, q: Array, v: Array, speed: float) -> Array:
        """Return the generalised forces of film and pivots, (q,), on journal and pads, load frame.

        q, v : (q,) arrays. Displacements of journal and pads, and their rates.

        Raises ArithmeticError: The film cannot be solved.
        """
        return self._turn @ self.film(q, v, speed).force - self._pivots(q)[0]

    def linear(self, q: Array, v: Array, speed: float) -> tuple[Array, Array, Array]:
        """Return `forces`, and their K and C there."""
        state = self.film(q, v, speed)
        stiffness, damping = (self._turn @ part @ self._turn.T for part in linearize(state))
        held, tangent = self._pivots(q)
        return self._turn @ state.force - held, stiffness + np.diag(tangent), damping

    def synchronous(self, speed: float) -> Coefficients:
        """Return K and C of the journal whose pads move with it at the shaft's frequency.

        At rest.
        """
        rest = self._turn @ self.rest
        _, stiffness, damping = self.linear(rest, np.zeros_like(rest), speed)
        law = stiffness + 1j * speed * damping
        law[2:, 2:] -= speed**2 * self.pad_mass
        felt = condensed(law, 2)
        return Coefficients(np.real(felt), np.imag(felt) / speed, speed)

    def eigenvalues(self, mass: float, speed: float) -> ComplexArray:
        """Return those of a rigid rotor [kg] and the pads at rest [1/s], the least stable first."""
        rest = self._turn @ self.rest
        _, stiffness, damping = self.linear(rest, np.zeros_like(rest), speed)
        inertia = np.asarray(block_diag(mass * np.eye(2), self.pad_mass))
        values = np.linalg.eigvals(first_order(inertia, damping, stiffness)[0])
        return np.asarray(values[np.argsort(-np.real(values), kind="stable")], dtype=complex)

    def _pivots(self, q: Array) -> tuple[Array, Array]:
        """Return the forces of the pads' pivots and bending, and their stiffnesses."""
        return pad_springs(self.bearing, q)

    def film(self, q: Array, v: Array, speed: float) -> FilmState:
        """Return film at these displacements and rates, in the problem's frame.

        Errors as `forces`.
        """
        problem = self.problem
        if speed != problem.speed:
            problem = replace(problem, speed=speed)
        state = film_state(
            problem, self._within(self._turn.T @ q), self._layers(speed),
            velocity=self._turn.T @ v,
            start=self._full,
        )  # fmt: skip
        if not (state.solution.converged and np.all(np.isfinite(state.force))):
            self._full = None
            raise SingularFilmError("the rupture condition was not met in the steps allowed")
        self._full = state.solution.full
        return state

    def thinnest(self, q: Array) -> Array:
        """Return the smallest film thickness [m] at each row of `q`, (n, q), load frame."""
        thinnest = self.problem.geometry.thinnest_at
        return np.array([thinnest(self._turn.T @ row) for row in q])

    def _within(self, q: Array) -> Array:
        """Pull displacements at which the walls touch back towards those at rest."""
        geometry, least = self.problem.geometry, _THINNEST * self.radial_clearance
        h = geometry.thickness(q)
        if geometry.thinnest(h) >= least:
            return q
        # The film falls linearly from where it is at rest.
        rest = geometry.thickness(self.rest)
        thin = geometry.land & (h < least)
        share = np.clip((rest - least) / (rest - h), 0.0, 1.0)
        return self.rest + float(share[:, thin.any(axis=0)].min()) * (q - self.rest)


_CONDITIONS = {
    Cavitation.REYNOLDS: REYNOLDS,
    Cavitation.HALF_SOMMERFELD: HALF_SOMMERFELD,
    Cavitation.FULL_SOMMERFELD: FULL_SOMMERFELD,
}


def _compilable(problem: FilmProblem) -> bool:
    """Return whether `film.compiled_force` knows all that this film does."""
    return (
        problem.settings.cavitation in _CONDITIONS
        and not isinstance(problem.rupture, FedFilm)
        and isinstance(problem.flow_law, LaminarFlow)
        and problem.elastic is None
        and not problem.bearing.pads
    )


@dataclass
class CompiledFilmForce(SolvedFilmForce):
    """A film that is solved at every call in compiled code, some twenty times faster."""

    def compiled(self, lowest_speed: float = 0.0, highest_speed: float = 0.0) -> CompiledForce:
        """Return the compiled form; good at any speed."""
        del lowest_speed, highest_speed
        numbers, table = packed_film(
            self.problem,
            self.others or [(self.problem.speed, self.layers)],
            _CONDITIONS[self.problem.settings.cavitation],
            self.frame,
            self.rest,
            _THINNEST * self.radial_clearance,
        )
        return CompiledForce(kernels.SOLVED, numbers, table)


@dataclass
class ActuatedSolvedFilm(SolvedFilmForce):
    """A film solved at every call, and an actuator on the journal that keeps it where it rests."""

    feedback: StateFeedback | None = None

    @classmethod
    def beside(cls, film: SolvedFilmForce, feedback: StateFeedback) -> ActuatedSolvedFilm:
        """Return the film with an actuator beside it."""
        own = {one.name: getattr(film, one.name) for one in fields(film) if one.init}
        return cls(**{**own, "name": f"{film.name} with actuator"}, feedback=feedback)

    def actuator_force(self, x: ArrayLike, y: ArrayLike, vx: ArrayLike, vy: ArrayLike) -> Array:
        """Return the force of the actuator alone (..., 2) [N]."""
        assert self.feedback is not None
        rest = self._turn @ self.rest
        return self.feedback(
            np.stack([np.subtract(x, rest[0]), np.subtract(y, rest[1]), vx, vy], axis=-1)
        )

    def forces(self, q: Array, v: Array, speed: float) -> Array:
        """Return the those of the film alone plus the actuator's force on the journal."""
        both = super().forces(q, v, speed)
        both[:2] += self.actuator_force(*q[:2], *v[:2])
        return both

    def linear(self, q: Array, v: Array, speed: float) -> tuple[Array, Array, Array]:
        """Return the those of film and actuator together; a saturated axis has no stiffness."""
        assert self.feedback is not None
        force, stiffness, damping = super().linear(q, v, speed)
        own = self.actuator_force(*q[:2], *v[:2])
        gain = self.feedback.gain * (np.abs(own) < self.feedback.max_force)[:, None]
        force[:2] += own
        stiffness[:2, :2] += gain[:, :2]
        damping[:2, :2] += gain[:, 2:]
        return force, stiffness, damping


def can_be_mapped(case: Case) -> bool:
    """Return whether eccentricity ratio and direction of squeeze decide this film."""
    return (
        case.bearing.is_plain
        and case.bearing.is_symmetric
        and case.bearing.compliance is None
        and case.thermal.model is ThermalModel.ISOTHERMAL
        and case.thermal.expansion is None
        and case.film.cavitation in MAPPED
        and case.film.flow is FlowRegime.LAMINAR
        and case.film.roughness is None
        and case.film.inception is Inception.FREE
    )


def prepare_map(case: Case, progress: Progress | None = None) -> None:
    """Solve the map that the film of `case` is taken from, unless it is kept already.

    progress : See `film_force_map`; not called where there is nothing to do.
    """
    if can_be_mapped(case):
        film_force_map(_length_to_diameter(case), case.film.cavitation, progress=progress)


def _length_to_diameter(case: Case) -> float:
    return case.bearing.length / case.bearing.diameter


def loaded_film(
    case: Case,
    speed: float,
    *,
    other_speeds: Sequence[float] = (),
    cache: Path | None = None,
    progress: Progress | None = None,
) -> LoadedFilm:
    """Return the film force of a case, with its load.

    speed : Of the operating point [rad/s]: where the mesh is graded, where ``max_film`` holds its
        line p = 0, whose viscosity field a heated film keeps, and at which an eccentricity ratio is
        turned into a load.
    other_speeds : At which the viscosity field of a heated film is solved as well [rad/s]: that of
        the moment lies between them.
    cache, progress : See `film_force_map`.

    Raises InputError: The operating point cannot be found.
    """
    if can_be_mapped(case):
        return _mapped(case, speed, cache, progress)
    solution = operating_film(case, speed)
    load = float(np.hypot(*solution.state.force[:2]))
    rpm = f"{speed * 30.0 / math.pi:.0f} rpm"
    notes = ["film solved at each step"]
    if case.bearing.pads:
        massless = any(0.0 in (pad.mass, pad.tilt_inertia) for pad in case.bearing.pads)
        notes.append(f"all pads move, {'following the film' if massless else 'with their inertia'}")
    others = []
    if solution.thermal is not None:
        others = other_films(case, load, other_speeds)
        slowest = min((one.problem.speed for one in others), default=speed) * 30.0 / math.pi
        notes.append(
            f"viscosity field of the moment, from {len(others) + 1} operating points between "
            f"{slowest:.0f} rpm and {rpm}" if others
            else f"viscosity field of the operating point at {rpm}, frozen"
        )  # fmt: skip
    if solution.problem.rupture.conserves_mass:
        notes.append(
            "liquid fraction as in a steady state: oil stored in the ruptured film left out"
        )
    if solution.problem.mesh.slot.any():
        notes.append(f"p = 0 held where the film is thickest at {rpm}")
    force = SolvedFilmForce.of(solution, others)
    if case.bearing.pads and np.linalg.eigvalsh(force.pad_mass)[0] <= 0.0:
        raise InputError(
            "is too large for the pad's inertias, or these are too small: leave them out to have "
            "them from the geometry; 0 for all: pads that follow the film (quasi-static)",
            key="bearing.pads.mass",
        )
    return LoadedFilm(force, load, force.bearing, "; ".join(notes))


def other_films(case: Case, load: float, speeds: Sequence[float]) -> list[FilmSolution]:
    """Return films under the same load [N] at other speeds [rad/s].

    Those that cannot be solved lack.
    """
    found = []
    for speed in speeds:
        with suppress(InputError):
            found.append(operating_film(replace(case, target=LoadTarget(load)), float(speed)))
    return found


def field_speeds(speeds: Sequence[float]) -> list[float]:
    """Return the speeds [rad/s] below the highest at which heated films of a run are solved."""
    low, high = max(min(speeds), _SLOWEST_FIELD * max(speeds)), max(speeds)
    if low > (1.0 - 1e-6) * high:
        return []
    return np.linspace(low, high, _FIELD_SPEEDS)[:-1].tolist()


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
    """Return film at rest about which an orbit runs, at `speed` [rad/s]; InputError without one."""
    try:
        solution = (solve_pads if case.bearing.pads else solve_film)(case, speed)
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
