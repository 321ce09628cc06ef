"""Orbit of one journal in time: its machine of one film, integrated piece by piece.

The equations, the compiled integrator and SciPy's are those of any machine
(`rotorsim.orbit.system`, `march`, `steps`, `run`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Array, ComplexArray
from ..errors import InputError
from ..model.loads import BaseMotion, BaseShock, HarmonicForce, Load, StepForce
from ..rotor import Rotor
from .analysis import recognise
from .controlled import with_controller
from .film_force import SolvedFilmForce
from .forces import ActuatedFilm, LinearForce, find_equilibrium
from .motion import Motion, MotionProblem
from .orbit import Orbit, OrbitEvent, OrbitStatus, concatenate
from .problem import OrbitProblem
from .run import CHUNK_REVOLUTIONS, last_pieces, pieces_of
from .system import Harmonic, Link, MotionSystem, translation_columns


def simulate(
    problem: OrbitProblem,
    *,
    consume: Callable[[Orbit], None] | None = None,
    keep_revolutions: int | None = None,
) -> Orbit:
    """Integrate one orbit to its end, touch-down or failure.

    consume : Called with each piece as soon as it is there: to show it, or to write it out.
    keep_revolutions : Keep the last so many revolutions only (to the next whole piece), so that
        memory does not grow with the run; the smallest film before them stays as an event
        ``minimum_film``.
    Returns: With ``status``: never an exception for what happens in the run.
    Raises InputError: Start outside the clearance, speeds outside the coefficients' range, or a
        static load that no position carries.
    """
    least: list[OrbitEvent] = []
    smallest = math.inf

    def drop(old: Orbit) -> None:
        nonlocal smallest
        if old.t.size and old.min_film.min() < smallest:
            at = int(np.argmin(old.min_film))
            smallest = float(old.min_film[at])
            least[:] = [_event("minimum_film", old, at)]

    pieces = last_pieces(
        _simulate_pieces(problem), problem.samples_per_revolution, consume, keep_revolutions, drop
    )
    orbit = concatenate(pieces)
    orbit = replace(orbit, events=(*least, *orbit.events))
    if orbit.status is not OrbitStatus.COMPLETED or not problem.schedule.is_constant:
        return replace(orbit, message="; ".join(filter(None, (orbit.message, orbit.note))))
    found = recognise(orbit)
    message = "; ".join(filter(None, (found.message, orbit.note)))
    events = orbit.events
    if found.steady_from is not None:
        at = min(found.steady_from, orbit.t.size - 1)
        events += (_event(found.status.value, orbit, at),)
    return replace(orbit, status=found.status, message=message, events=events)


def _event(name: str, orbit: Orbit, at: int) -> OrbitEvent:
    return OrbitEvent(name, float(orbit.t[at]), float(orbit.x[at]), float(orbit.y[at]))


def _simulate_pieces(
    problem: OrbitProblem, revolutions: int = CHUNK_REVOLUTIONS
) -> Iterator[Orbit]:
    """Integrate piece by piece: status ``running`` but for the last one."""
    equilibrium = _equilibrium(problem)
    motion = motion_problem(problem, equilibrium)
    for piece in pieces_of(motion, revolutions):
        film = piece.link_force(motion.system.links[0])
        yield _orbit(problem, piece, film, equilibrium)


def _equilibrium(problem: OrbitProblem) -> tuple[float, float]:
    """Return the position from which the start is measured [m]."""
    force, speed = problem.force, problem.schedule.speeds[0]
    if problem.equilibrium is not None:
        return problem.equilibrium
    if isinstance(force, LinearForce):
        return force.position(speed)
    if isinstance(force, SolvedFilmForce) and force.pads:
        return float(force.rest[0]), float(force.rest[1])
    return find_equilibrium(force, problem.static_load, speed)


def motion_problem(problem: OrbitProblem, equilibrium: tuple[float, float]) -> MotionProblem:
    """Put the rotor on its one film together as a machine in time.

    Raises InputError: The start is outside the clearance, or of a wrong size.
    """
    rotor, force, size = problem.rotor, problem.force, problem.rotor.size
    pads = tuple(range(size - len(problem.pads), size))
    places = [(int(x), int(x) + 1) for x in rotor.first_unknown]
    unbalance = translation_columns(size, places, [complex(u) for u in rotor.unbalance])
    scale = np.full(size, 0.1 * force.radial_clearance)
    if isinstance(force, SolvedFilmForce) and pads:
        scale[list(pads)] = 0.1 * force.scales[2:]
    bore, least = problem.bearing, problem.minimum_film
    circle = bore is None or (bore.is_plain and bore.is_symmetric)

    def film_left(q: Array) -> Array:
        return problem.film_at(q[:, :size]) - least

    stops = problem.stop_at_contact
    system = MotionSystem(
        rotor.mass, rotor.damping, rotor.gyroscopic, rotor.stiffness, rotor.circulatory,
        _static_load(problem), scale, np.eye(size), np.zeros(size),
        unbalance=((-math.inf, unbalance),) if unbalance.any() else (),
        links=(
            Link("film", force, (0, 1), pads=pads,
                 minimum_film=least if stops and circle else -math.inf),
        ),
        loads=_harmonics(problem.loads, rotor),
    )  # fmt: skip
    start, velocity = _start(problem, equilibrium)
    if stops and film_left(start[None])[0] <= 0.0:
        raise InputError(
            "the journal must start inside the clearance circle "
            f"(film above {least:g} m, clearance {force.radial_clearance:g} m)",
            key="orbit.initial_displacement",
            value=problem.initial_displacement,
        )
    motion = MotionProblem(
        system, problem.schedule, start, velocity, start, (), problem.samples_per_revolution,
        problem.tolerance, contact=film_left if stops and not circle else None,
    )  # fmt: skip
    if problem.controller is None:
        return motion
    still = replace(problem, initial_displacement=(0.0, 0.0), initial_state=None)
    return with_controller(
        motion, problem.controller, _start(still, equilibrium)[0], rotor.unknowns
    )


def _static_load(problem: OrbitProblem) -> Array:
    """Share the static load out over the nodes as their masses, (n,)."""
    rotor = problem.rotor
    return rotor.mass @ rotor.translation(problem.static_load) / rotor.total_mass


def _start(problem: OrbitProblem, equilibrium: tuple[float, float]) -> tuple[Array, Array]:
    """Return displacements and velocities (n,): nodes hang where journal and load put them."""
    rotor, size = problem.rotor, problem.rotor.size
    if problem.initial_state is not None:
        state = np.array(problem.initial_state, dtype=float)
        if state.shape != (2 * size,):
            raise InputError(
                f"must have {2 * size} entries", key="orbit.initial_state", value=state.shape
            )
        return state[:size], state[size:]
    q, v = np.zeros((2, size))
    q[:2] = np.asarray(equilibrium) + problem.initial_displacement
    v[:2] = problem.initial_velocity
    own = slice(2, size - len(problem.pads))
    if own.stop > 2:
        pull = _static_load(problem)[own] - rotor.stiffness[own, :2] @ q[:2]
        q[own] = np.linalg.lstsq(rotor.stiffness[own, own], pull, rcond=None)[0]
    if isinstance(problem.force, SolvedFilmForce):
        q[own.stop :] = problem.force.rest[2:]
    return q, v


def _harmonics(loads: Sequence[Load], rotor: Rotor) -> tuple[Harmonic, ...]:
    """Return the loads as forces that turn at one frequency each, on all unknowns [N]."""

    def at_node(node: int, force: ComplexArray) -> ComplexArray:
        if not 0 <= node < len(rotor.nodes):
            last = len(rotor.nodes) - 1
            raise InputError(f"must be from 0 to {last}", key="orbit.load.node", value=node)
        amplitude = np.zeros(rotor.size, dtype=complex)
        first = int(rotor.first_unknown[node])
        amplitude[first : first + 2] = force
        return amplitude

    def inertia(force: ComplexArray) -> ComplexArray:
        both = (rotor.translation((part[0], part[1])) for part in (force.real, force.imag))
        real, imaginary = (rotor.mass @ along for along in both)
        return real + 1j * imaginary

    def one(load: Load) -> Harmonic:
        match load:
            case StepForce():
                force = np.asarray(load.force, dtype=complex)
                return Harmonic(at_node(load.node, force), 0.0, load.start, load.stop)
            case HarmonicForce():
                force = np.asarray(load.force) * np.exp(1j * np.asarray(load.phase))
                return Harmonic(at_node(load.node, force), load.frequency, load.start, load.stop)
            case BaseMotion():
                base = np.asarray(load.displacement) * np.exp(1j * np.asarray(load.phase))
                base = np.asarray(base * load.frequency**2, dtype=complex)
                return Harmonic(inertia(base), load.frequency, load.start, load.stop)
            case BaseShock():
                # half a sine: sin w (t - start) = Re(-i exp(-i w start) exp(i w t))
                frequency = math.pi / load.duration
                turned = -1j * np.exp(-1j * frequency * load.start)
                force = inertia(-np.asarray(load.acceleration) * turned)
                return Harmonic(force, frequency, load.start, load.start + load.duration)

    return tuple(one(load) for load in loads)


def load_on_rotor(loads: Sequence[Load], rotor: Rotor, t: Array) -> Array:
    """Return the sum of the loads over all nodes (n, 2) [N] at times t (n,)."""
    total = np.zeros((np.size(t), 2))
    for load in _harmonics(loads, rotor):
        whole = np.array([load.amplitude[rotor.first_unknown + axis].sum() for axis in (0, 1)])
        acts = (load.start <= t) & (t < load.stop)
        total += np.real(np.exp(1j * load.frequency * t)[:, None] * whole) * acts[:, None]
    return total


def _orbit(
    problem: OrbitProblem, piece: Motion, film: Array, equilibrium: tuple[float, float]
) -> Orbit:
    """Return one piece's samples as an orbit; `film` is the force on the journal (m, 2) [N]."""
    size = problem.rotor.size
    q, v = piece.q[:, :size], piece.v[:, :size]
    x, y, vx, vy = (np.ascontiguousarray(one) for one in (q[:, 0], q[:, 1], v[:, 0], v[:, 1]))
    actuator = np.zeros_like(film)
    if isinstance(problem.force, ActuatedFilm):
        actuator = problem.force.actuator_force(x, y, vx, vy)
        film = film - actuator
    if problem.controller is not None:
        along = [[name.endswith(f"_{axis}") for axis in "xy"] for name in
                 problem.controller.actuators]  # fmt: skip
        actuator = actuator + piece.actuator_force @ np.array(along, dtype=float)
    message = piece.message
    if piece.status is OrbitStatus.TOUCH_DOWN:
        when = piece.events[0].time
        message = (
            f"film below {problem.minimum_film * 1e6:.3g} µm after {when:.6g} s "
            f"({problem.schedule.angle_at(when) / (2.0 * np.pi):.4g} revolutions)"
        )
        if isinstance(problem.force, LinearForce):
            message += "; linear coefficients hold for small motions only"
    elif piece.status is OrbitStatus.INTEGRATION_FAILED:
        message = f"{message.rstrip('.')}. Try a looser tolerance."
    return Orbit(
        t=piece.t, x=x, y=y, vx=vx, vy=vy, speed=piece.speed, angle=piece.angle,
        fx=film[:, 0], fy=film[:, 1], load=load_on_rotor(problem.loads, problem.rotor, piece.t),
        actuator_force=actuator, displacements=np.ascontiguousarray(q),
        min_film=problem.film_at(q), boundary=problem.boundary,
        samples_per_revolution=problem.samples_per_revolution,
        radial_clearance=problem.force.radial_clearance, equilibrium=equilibrium,
        force_model=problem.force.name, thermal_model=problem.thermal_model,
        status=piece.status, message=message, events=piece.events,
        forced=bool(np.any(problem.rotor.unbalance)) or bool(problem.loads),
        forcing=tuple(
            load.frequency for load in problem.loads if isinstance(load, HarmonicForce | BaseMotion)
        ),
        kind=problem.kind, note=problem.note,
        pad_velocity=np.ascontiguousarray(v[:, q.shape[1] - len(problem.pads) :]),
    )  # fmt: skip
