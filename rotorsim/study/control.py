"""A magnetic actuator beside the film: designed on its linearisation, tried on the film itself."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import ComplexArray
from ..bearing.interpolation import Coefficients
from ..bearing.whirl import WhirlThreshold, rigid_threshold
from ..errors import InputError
from ..model import Case
from ..model.orbit import ActuatorSettings, Design

if TYPE_CHECKING:
    import control

    from ..machine.control import LoopMargins, StateFeedback
    from ..orbit import Orbit, OrbitProblem
    from ..orbit.film_force import LoadedFilm
    from ..orbit.forces import BearingForce


@dataclass(frozen=True, eq=False)
class ControlStudy:
    """An actuator's feedback and what it does (SI).

    equilibrium : (float, float) [m]
    passive : Of the film alone.
    passive_eigenvalues, controlled_eigenvalues : Complex arrays [1/s], the least stable one first:
        four, and those of tilting pads.
    system : Rigid rotor on the linearised film; of pads at the shaft's frequency.
    margins : (LoopMargins, LoopMargins). Of the loops in x and in y.
    passive_orbit, controlled_orbit : On the nonlinear film, from the disturbance.
    largest_force : Of one axis of the actuator in that run [N].
    note : What the nonlinear film takes for granted.
    """

    speed: float
    mass: float
    load: float
    disturbance: float
    equilibrium: tuple[float, float]
    passive: WhirlThreshold
    passive_eigenvalues: ComplexArray
    controlled_eigenvalues: ComplexArray
    system: control.StateSpace
    feedback: StateFeedback
    margins: tuple[LoopMargins, LoopMargins]
    passive_orbit: Orbit | None
    controlled_orbit: Orbit | None
    largest_force: float | None
    note: str

    @property
    def saturates(self) -> bool:
        """Return whether the actuator reached its limit in the run in time."""
        force = self.largest_force
        return force is not None and force >= (1.0 - 1e-9) * self.feedback.max_force

    @property
    def holds(self) -> bool:
        """Return whether the closed loop is stable and the run in time comes nearer to rest.

        Without a run in time, the eigenvalues alone.
        """
        stable = complex(self.controlled_eigenvalues[0]).real < 0.0
        orbit = self.controlled_orbit
        if orbit is None or not stable:
            return stable
        if orbit.status.value in ("touch_down", "integration_failed"):
            return False
        late = slice(3 * orbit.t.size // 4, None)
        x0, y0 = self.equilibrium
        away = np.hypot(orbit.x[late] - x0, orbit.y[late] - y0)
        return bool(away.max() < 0.5 * self.disturbance)


def study_control(
    case: Case,
    speed: float,
    mass: float,
    settings: ActuatorSettings | None = None,
    *,
    disturbance: float | None = None,
    revolutions: int | None = None,
) -> ControlStudy:
    """Design the feedback at one speed and try it in time on the nonlinear film.

    case : One bearing with one thermal model.
    speed : [rad/s]
    mass : Rotor mass per bearing [kg].
    disturbance : Displacement from rest with which the run in time begins [m]; None: a fiftieth of
        the clearance.
    revolutions : Length of that run; 0: none; None: 100 with a film whose force has a compiled
        form, 20 with one that is solved at every step.
    Raises InputError: The design reaches its aim with no gain, or nothing carries the load.
    """
    from ..machine.control import loop_margins, state_space
    from ..orbit.film_force import ActuatedSolvedFilm, SolvedFilmForce, loaded_film
    from ..orbit.forces import CompilableForce

    film = loaded_film(case, speed)
    rest, linear = _at_rest(film.force, (film.load, 0.0), speed)
    system = state_space(linear, mass)
    clearance = case.bearing.radial_clearance
    feedback = _design_feedback(settings or ActuatorSettings(), linear, mass, clearance, film.load)
    disturbance = disturbance or 0.02 * clearance
    orbits: list[Orbit | None] = [None, None]
    largest = None
    if revolutions is None:
        revolutions = 100 if isinstance(film.force, CompilableForce) else 20
    if revolutions:
        orbits = [
            _run(force, film, rest, speed, mass, disturbance, revolutions)
            for force in (film.force, _actuated(film.force, feedback, rest))
        ]
        held = orbits[1]
        assert held is not None
        largest = float(np.abs(held.actuator_force).max())
    passive, controlled = _sorted(system.poles()), _sorted(feedback.closed_loop(system).poles())
    note = film.note
    if isinstance(film.force, SolvedFilmForce) and film.force.pads:
        note += "; designed on what the journal feels at the shaft's frequency"
        passive = film.force.eigenvalues(mass, speed)
        controlled = ActuatedSolvedFilm.beside(film.force, feedback).eigenvalues(mass, speed)
    return ControlStudy(
        speed=speed,
        mass=mass,
        load=film.load,
        disturbance=disturbance,
        equilibrium=rest,
        passive=rigid_threshold(linear.stiffness, linear.damping, speed),
        passive_eigenvalues=passive,
        controlled_eigenvalues=controlled,
        system=system,
        feedback=feedback,
        margins=(loop_margins(system, feedback, 0), loop_margins(system, feedback, 1)),
        passive_orbit=orbits[0],
        controlled_orbit=orbits[1],
        largest_force=largest,
        note=note,
    )


def _at_rest(
    film: BearingForce, load: tuple[float, float], speed: float
) -> tuple[tuple[float, float], Coefficients]:
    """Return where the journal rests [m], and what it feels there.

    Of pads at the shaft's frequency.
    """
    from ..orbit import LinearForce
    from ..orbit.film_force import SolvedFilmForce
    from ..orbit.forces import find_equilibrium, linearize_force

    if isinstance(film, SolvedFilmForce) and film.pads:
        return (float(film.rest[0]), float(film.rest[1])), film.synchronous(speed)
    rest = film.position(speed) if isinstance(film, LinearForce) else None
    rest = rest or find_equilibrium(film, load, speed)
    return rest, Coefficients(*linearize_force(film, *rest, speed), speed)


def _actuated(
    film: BearingForce, feedback: StateFeedback, rest: tuple[float, float]
) -> BearingForce:
    from ..machine.control import ActuatedForce
    from ..orbit.film_force import ActuatedSolvedFilm, SolvedFilmForce

    if isinstance(film, SolvedFilmForce):
        return ActuatedSolvedFilm.beside(film, feedback)
    return ActuatedForce(film, feedback, rest)


def _run(
    force: BearingForce, film: LoadedFilm, rest: tuple[float, float], speed: float, mass: float,
    disturbance: float, revolutions: int,
) -> Orbit:  # fmt: skip
    from ..orbit import OrbitProblem, SpeedSchedule, simulate
    from ..rotor import Rotor

    return simulate(
        OrbitProblem(
            force,
            Rotor.rigid(mass),
            SpeedSchedule.constant(speed, revolutions),
            static_load=(film.load, 0.0),
            equilibrium=rest,
            initial_displacement=(disturbance, 0.0),
            bearing=film.bearing if film.bearing.pads else None,
            minimum_film=film.bearing.roughness,
            samples_per_revolution=32,
        )
    )


def _sorted(values: NDArray) -> ComplexArray:
    found = np.asarray(values, dtype=complex)
    return found[np.argsort(np.real(-found), kind="stable")]


def _design_feedback(
    settings: ActuatorSettings,
    linear: Coefficients,
    mass: float,
    radial_clearance: float,
    load: float | None,
) -> StateFeedback:
    """Return feedback for a rigid rotor [kg] on its linearised film, at the coefficients' speed.

    mass, radial_clearance : Per bearing [kg], [m].
    load : The static one [N]: a tenth of it is the force that counts as large where none is given.
    Raises InputError: The design reaches its aim with no gain, or nothing says which force is
        large.
    """
    from ..machine.control import design_lqr, design_pd, proportional_derivative, state_space

    limit = settings.force_limit
    if settings.design is Design.LQR:
        large = settings.force_scale or (limit if math.isfinite(limit) else 0.1 * (load or 0.0))
        if not large > 0.0:
            raise InputError("is missing: the load is not known", key="orbit.actuator.force_scale")
        scale = settings.displacement_scale or 0.01 * radial_clearance
        return design_lqr(state_space(linear, mass), scale, large, max_force=limit)
    if settings.damping is not None:
        return proportional_derivative(settings.stiffness, settings.damping, limit)
    ratio = 0.02 if settings.decay_ratio is None else settings.decay_ratio
    return design_pd(linear, mass, -ratio * linear.speed, settings.stiffness, limit)


def with_actuator(
    problem: OrbitProblem, settings: ActuatorSettings, mass: float, load: float | None
) -> OrbitProblem:
    """Return the problem with an actuator beside its film, at constant speed.

    Raises InputError: The speed changes, or as `_design_feedback`.
    """
    if not problem.schedule.is_constant:
        raise InputError("needs one speed, not a ramp", key="orbit.actuator")
    film, speed = problem.force, problem.schedule.speeds[0]
    rest, linear = _at_rest(film, problem.static_load, speed)
    feedback = _design_feedback(settings, linear, mass, film.radial_clearance, load)
    limit = settings.force_limit
    limited = f"limited to {limit:g} N per axis" if math.isfinite(limit) else "without limit"
    return replace(
        problem,
        force=_actuated(film, feedback, rest),
        equilibrium=rest,
        # as accurate as with the film alone
        relative_tolerance=problem.tolerance,
        note="; ".join(filter(None, (problem.note, f"{settings.design.name} actuator {limited}"))),
    )
