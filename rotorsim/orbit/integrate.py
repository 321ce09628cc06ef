"""Integration of the rotor on its film with SciPy, piece by piece."""

from __future__ import annotations

import itertools
import math
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from ..arrays import Array
from ..errors import InputError
from ..model.loads import BaseMotion, HarmonicForce
from .analysis import recognise
from .equations import (
    FilmSeries,
    Rates,
    Tangent,
    initial_state,
    load_on_rotor,
    pack_loads,
    right_hand_side,
)
from .film_force import SolvedFilmForce
from .forces import ActuatedFilm, LinearForce, find_equilibrium
from .orbit import Orbit, OrbitEvent, OrbitStatus, concatenate
from .problem import Method, OrbitProblem

_CHUNK_REVOLUTIONS = 32


@dataclass(frozen=True)
class _Solution:
    """One integrated piece: SciPy's status, and where the film broke down (t, x, y)."""

    t: Array
    y: Array
    status: int
    message: str = ""
    contact: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class _Run:
    """What stays the same from piece to piece."""

    problem: OrbitProblem
    equilibrium: tuple[float, float]
    rates: Rates
    film: FilmSeries
    tangent: Tangent | None
    tolerance: Array
    contact: Callable[[float, Array], float]


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
    pieces: deque[Orbit] = deque()
    dropped: OrbitEvent | None = None
    least = math.inf
    for piece in _simulate_pieces(problem):
        if consume is not None:
            consume(piece)
        pieces.append(piece)
        if keep_revolutions is None:
            continue
        while len(pieces) > 1 and _turns(pieces) - _turns([pieces[0]]) >= keep_revolutions:
            old = pieces.popleft()
            if old.t.size and old.min_film.min() < least:
                at = int(np.argmin(old.min_film))
                least = float(old.min_film[at])
                dropped = OrbitEvent(
                    "minimum_film", float(old.t[at]), float(old.x[at]), float(old.y[at])
                )
    orbit = concatenate(pieces)
    if dropped is not None:
        orbit = replace(orbit, events=(dropped, *orbit.events))
    if orbit.status is not OrbitStatus.COMPLETED or not problem.schedule.is_constant:
        return replace(orbit, message="; ".join(filter(None, (orbit.message, orbit.note))))
    found = recognise(orbit)
    message = "; ".join(filter(None, (found.message, orbit.note)))
    events = orbit.events
    if found.steady_from is not None:
        at = min(found.steady_from, orbit.t.size - 1)
        events += (
            OrbitEvent(
                found.status.value, float(orbit.t[at]), float(orbit.x[at]), float(orbit.y[at])
            ),
        )
    return replace(orbit, status=found.status, message=message, events=events)


def _turns(pieces: Iterable[Orbit]) -> float:
    """Return the revolutions that the pieces hold together."""
    return sum(p.t.size / p.samples_per_revolution for p in pieces)


def _simulate_pieces(
    problem: OrbitProblem, revolutions: int = _CHUNK_REVOLUTIONS
) -> Iterator[Orbit]:
    """Integrate piece by piece, so that a long run can be streamed, thinned or written out.

    revolutions : Of the shaft in each piece.
    Yields Orbit : Status ``running`` but for the last.
    """
    run, state = _prepare(problem)
    edges = _edges(problem, revolutions)
    samples = problem.samples_per_revolution
    # a run that ends on a sample keeps it, rounding or not
    count = math.floor(problem.schedule.revolutions * samples + 1e-9) + 1
    done = 0
    for piece, (start, stop) in enumerate(itertools.pairwise(edges)):
        last = piece == len(edges) - 2
        upto = count if last else _samples_before(problem, stop)
        angles = 2.0 * np.pi * np.arange(done, upto) / samples
        times = np.clip(problem.schedule.time_at(angles), start, stop)
        done = upto
        ends = times if times.size and times[-1] >= stop else np.append(times, stop)
        solution = _solve(run, state, (start, stop), ends)
        orbit = _piece(run, solution, angles)
        if orbit.status is not OrbitStatus.COMPLETED or last:
            yield orbit
            return
        yield replace(orbit, status=OrbitStatus.RUNNING)
        state = solution.y[:, -1]


def _solve(run: _Run, state: Array, span: tuple[float, float], times: Array) -> _Solution:
    """Integrate one piece; an integrator that gives up gives back what it has."""
    problem = run.problem
    failed = _Solution(np.zeros(0), np.zeros((state.size, 0)), -1)
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # SciPy says on stderr what the status says as well
        implicit: dict[str, Any] = (
            {} if problem.method is Method.DOP853 else {"jac": _jacobian(run)}
        )
        try:
            found = solve_ivp(
                run.rates,
                span,
                state,
                method=problem.method.value,
                t_eval=times,
                events=run.contact if problem.stop_at_contact else None,
                rtol=problem.tolerance,
                atol=run.tolerance,
                **implicit,
            )
        except InputError:
            raise
        except (ArithmeticError, ValueError, np.linalg.LinAlgError) as error:
            return replace(failed, message=f"{error}.")
    if found.status == 1:
        when, where = float(found.t_events[0][0]), found.y_events[0][0]
        return _Solution(found.t, found.y, 1, contact=(when, float(where[0]), float(where[1])))
    # the list is empty where the first step already fails
    y = found.y if len(found.t) else failed.y
    good = int(np.sum(np.all(np.isfinite(y), axis=0)))
    status = found.status if good == y.shape[1] else -1
    return _Solution(np.asarray(found.t)[:good], y[:, :good], status, str(found.message))


def _jacobian(run: _Run) -> Callable[[float, Array], Array]:
    """Return derivatives of the rates by differences, in steps that the film's stiffness shows in.

    The integrators' own steps follow the size of each state: that of a velocity at rest is so
    small that the force does not change beyond rounding. Newton's method then fails close to the
    bush, and the run crawls.
    """
    problem, size = run.problem, run.problem.rotor.mass.shape[0]
    least = np.full(run.tolerance.size, 1e-6)
    least[: 2 * size] *= problem.force.radial_clearance
    least[:size] *= 1e-2
    least[size : 2 * size] *= max(problem.schedule.speeds)

    def jacobian(t: float, state: Array) -> Array:
        rates = run.rates if run.tangent is None else run.tangent(t, state)
        before = np.array(rates(t, state))
        steps = least.copy()
        steps[2 * size :] *= np.maximum(np.abs(state[2 * size :]), 1.0)
        columns = []
        for index, step in enumerate(steps):
            moved = state.copy()
            moved[index] += step
            columns.append((rates(t, moved) - before) / (moved[index] - state[index]))
        return np.column_stack(columns)

    return jacobian


def _prepare(problem: OrbitProblem) -> tuple[_Run, Array]:
    speed = problem.schedule.speeds[0]
    force, rotor = problem.force, problem.rotor
    if problem.equilibrium is not None:
        equilibrium = problem.equilibrium
    elif isinstance(force, LinearForce):
        equilibrium = force.position(speed)
    elif isinstance(force, SolvedFilmForce) and force.pads:
        equilibrium = float(force.rest[0]), float(force.rest[1])
    else:
        equilibrium = find_equilibrium(force, problem.static_load, speed)
    state = initial_state(problem, equilibrium)
    clearance, least = force.radial_clearance, problem.minimum_film
    size = rotor.mass.shape[0]
    tolerance = np.full(state.size, 1e-3 * problem.tolerance * clearance)
    if isinstance(force, SolvedFilmForce) and force.pads:
        tolerance[size - len(force.pads) : size] *= force.scales[2:] / clearance
    tolerance[size : 2 * size] = tolerance[:size] * max(problem.schedule.speeds)

    plain = problem.bearing is None or (problem.bearing.is_plain and problem.bearing.is_symmetric)

    def contact(_t: float, s: Array) -> float:
        if plain:
            return clearance - least - math.hypot(s[0], s[1])
        return float(problem.film_at(s[None, :size])[0]) - least

    contact.terminal = True  # pyright: ignore[reportFunctionMemberAccess]
    contact.direction = -1.0  # pyright: ignore[reportFunctionMemberAccess]
    if problem.stop_at_contact and contact(0.0, state) <= 0.0:
        raise InputError(
            "the journal must start inside the clearance circle "
            f"(film above {least:g} m, clearance {clearance:g} m)",
            key="orbit.initial_displacement",
            value=problem.initial_displacement,
        )
    rates, film, tangent = right_hand_side(problem)
    return _Run(problem, equilibrium, rates, film, tangent, tolerance, contact), state


def _actuator_force(problem: OrbitProblem, motion: Array, y: Array) -> Array:
    """Force of the actuator (n, 2) along (n, 5) motion, states y (k, n); zeros without one."""
    if isinstance(problem.force, ActuatedFilm):
        return problem.force.actuator_force(*motion[:, :4].T)
    if problem.controller is None:
        return np.zeros((len(motion), 2))
    size = problem.rotor.mass.shape[0]
    away = motion[:, :4] - np.array([*problem.controller.reference, 0.0, 0.0])
    return problem.controller.force(y[2 * size :].T, away)


def _edges(problem: OrbitProblem, revolutions: int) -> list[float]:
    """List where pieces end [s]: at whole revolutions and at corners of loads and speed."""
    schedule = problem.schedule
    turns = np.arange(0.0, schedule.revolutions, max(revolutions, 1))
    edges = {float(t) for t in schedule.time_at(2.0 * np.pi * turns)} | set(schedule.times)
    _, times = pack_loads(problem.loads, problem.rotor)
    edges |= {float(t) for t in times[:, 1:3].ravel() if 0.0 < t < schedule.duration}
    ordered = sorted(edges)
    least = 1e-9 * schedule.duration
    kept = [ordered[0]]
    kept += [t for t in ordered[1:] if t - kept[-1] > least]
    kept[-1] = schedule.duration
    return kept


def _samples_before(problem: OrbitProblem, t: float) -> int:
    """Count samples earlier than t (a sample on the edge belongs to the next piece)."""
    turns = problem.schedule.angle_at(t) / (2.0 * np.pi) * problem.samples_per_revolution
    return math.ceil(float(turns) - 1e-9)


def _piece(run: _Run, solution: _Solution, angles: Array) -> Orbit:
    """Return one piece's samples as an orbit."""
    problem = run.problem
    size = problem.rotor.mass.shape[0]
    count = min(angles.size, solution.t.size)
    t, y = solution.t[:count], solution.y[:, :count]
    speed = problem.schedule.speed_at(t)
    motion = np.column_stack([y[0], y[1], y[size], y[size + 1], speed])
    film = run.film(motion, y.T)
    actuator = _actuator_force(problem, motion, y)
    if isinstance(problem.force, ActuatedFilm):
        film = film - actuator
    status, message, events = OrbitStatus.COMPLETED, "", ()
    if solution.contact is not None:
        when, x, y_end = solution.contact
        status = OrbitStatus.TOUCH_DOWN
        message = (
            f"film below {problem.minimum_film * 1e6:.3g} µm after {when:.6g} s "
            f"({problem.schedule.angle_at(when) / (2.0 * np.pi):.4g} revolutions)"
        )
        if isinstance(problem.force, LinearForce):
            message += "; linear coefficients hold for small motions only"
        events = (OrbitEvent("touch_down", when, x, y_end),)
    elif solution.status < 0:
        status = OrbitStatus.INTEGRATION_FAILED
        message = f"{solution.message} Try another method, or a looser tolerance."
    return Orbit(
        t=t,
        x=y[0].copy(),
        y=y[1].copy(),
        vx=y[size].copy(),
        vy=y[size + 1].copy(),
        speed=speed,
        angle=angles[:count],
        fx=film[:, 0],
        fy=film[:, 1],
        load=load_on_rotor(problem.loads, problem.rotor, t),
        actuator_force=actuator,
        displacements=np.ascontiguousarray(y[:size].T),
        min_film=problem.film_at(y[:size].T),
        boundary=problem.boundary,
        samples_per_revolution=problem.samples_per_revolution,
        radial_clearance=problem.force.radial_clearance,
        equilibrium=run.equilibrium,
        force_model=problem.force.name,
        thermal_model=problem.thermal_model,
        status=status,
        message=message,
        events=events,
        forced=bool(np.any(problem.rotor.unbalance)) or bool(problem.loads),
        forcing=tuple(
            load.frequency for load in problem.loads if isinstance(load, HarmonicForce | BaseMotion)
        ),
        kind=problem.kind,
        note=problem.note,
        pad_velocity=np.ascontiguousarray(y[2 * size - len(problem.pads) : 2 * size].T),
    )
