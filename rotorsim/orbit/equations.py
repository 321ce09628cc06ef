"""Equations of motion of a rotor on its film: from a problem to the state's rates.

One compiled function for all, so that SciPy calls compiled code once per evaluation; numbers travel
in plain arrays, packed here and by `rotorsim.orbit.forces`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from ..arrays import Array
from ..compiled import compiled
from ..errors import InputError
from ..model.loads import BaseMotion, BaseShock, HarmonicForce, Load, StepForce
from ..rotor import Rotor
from .film_force import SolvedFilmForce
from .forces import CompilableForce, CompiledForce
from .kernels import film_force, film_force_series, shaft
from .problem import OrbitProblem

Rates = Callable[[float, Array], Array]
FilmSeries = Callable[[Array, Array], Array]
Tangent = Callable[[float, Array], Rates]

_CONSTANT, _HARMONIC, _HALF_SINE = 0.0, 1.0, 2.0
"""Time functions that the compiled equations know."""


def _static_load(problem: OrbitProblem) -> Array:
    """Share the static load out over the nodes as their masses, (n,)."""
    rotor = problem.rotor
    return rotor.mass @ rotor.translation(problem.static_load) / rotor.total_mass


def initial_state(problem: OrbitProblem, equilibrium: tuple[float, float]) -> Array:
    """Start of the run: nodes other than the journal hang where journal and load put them."""
    rotor, extra = problem.rotor, 0
    if problem.controller is not None:
        extra = problem.controller.a.shape[0]
    size = rotor.mass.shape[0]
    if problem.initial_state is not None:
        state = np.array(problem.initial_state, dtype=float)
        if state.shape != (2 * size + extra,):
            raise InputError(
                f"must have {2 * size + extra} entries",
                key="orbit.initial_state",
                value=state.shape,
            )
        return state
    state = np.zeros(2 * size + extra)
    state[:2] = np.asarray(equilibrium) + problem.initial_displacement
    state[size : size + 2] = problem.initial_velocity
    own = slice(2, size - len(problem.pads))
    if own.stop > 2:
        free = rotor.stiffness[own, own]
        pull = _static_load(problem)[own] - rotor.stiffness[own, :2] @ state[:2]
        state[own] = np.linalg.lstsq(free, pull, rcond=None)[0]
    if isinstance(problem.force, SolvedFilmForce):
        state[own.stop : size] = problem.force.rest[2:]
    return state


def right_hand_side(problem: OrbitProblem) -> tuple[Rates, FilmSeries, Tangent | None]:
    """Return state rates, and the film force on the journal along (n, 5) motion and states (n, k).

    Last the rates with the film's force linear about a state, where it knows its K and C.
    """
    rotor, controller = problem.rotor, problem.controller
    shapes, times = pack_loads(problem.loads, rotor)
    if any(problem.static_load):
        still, always = pack_loads([StepForce((0.0, 0.0))], rotor)
        still[0, 0], always[0, 1] = _static_load(problem), -math.inf
        shapes, times = np.concatenate([still, shapes]), np.concatenate([always, times])
    if controller is None:
        blocks: Array = np.zeros((0, 0))
        reference: Array = np.zeros(2)
    else:
        rows = [[controller.a, controller.b], [controller.c, controller.d]]
        blocks = np.asarray(np.block(rows), dtype=float)
        reference = np.asarray(controller.reference, dtype=float)
    inverse = np.linalg.inv(rotor.mass)
    matrices = [
        inverse, rotor.damping, rotor.stiffness, rotor.gyroscopic, rotor.circulatory,
    ]  # fmt: skip
    planes = [np.abs(rotor.unbalance), np.angle(rotor.unbalance), rotor.first_unknown]
    structure: tuple[Array, ...] = (
        np.asarray(np.stack(matrices), dtype=float),
        np.asarray(np.column_stack(planes), dtype=float),
        problem.schedule.knots,
        shapes,
        times,
        blocks,
        reference,
    )
    force = problem.force
    if isinstance(force, CompilableForce):
        speeds = problem.schedule.speeds
        return _compiled_rates(force.compiled(min(speeds), max(speeds)), structure)
    size, schedule = rotor.mass.shape[0], problem.schedule.knots

    def speed_at(t: float) -> float:
        return float(shaft(t, schedule)[1])

    if isinstance(force, SolvedFilmForce):
        moving = problem.moving

        def parts(s: Array) -> tuple[Array, Array]:
            return moving(s[..., :size]), moving(s[..., size : 2 * size])

        def rates(t: float, s: Array) -> Array:
            return _motion_rates(t, s, force.forces(*parts(s), speed_at(t)), *structure)

        def tangent(t: float, s: Array) -> Rates:
            here = parts(s)
            value, stiffness, damping = force.linear(*here, speed_at(t))

            def near(_t: float, s: Array) -> Array:
                dq, dv = (there - here for there, here in zip(parts(s), here, strict=True))
                return _motion_rates(t, s, value - stiffness @ dq - damping @ dv, *structure)

            return near

        def film(motion: Array, states: Array) -> Array:
            rows = zip(*parts(states), motion[:, 4], strict=True)
            found = [force.forces(q, v, float(speed))[:2] for q, v, speed in rows]
            return np.array(found).reshape(-1, 2)

        return rates, film, tangent

    def plain_rates(t: float, s: Array) -> Array:
        motion = float(s[0]), float(s[1]), float(s[size]), float(s[size + 1])
        return _motion_rates(t, s, np.array(force.force(*motion, speed_at(t))), *structure)

    def plain_film(motion: Array, _states: Array) -> Array:
        return np.array([force.force(*row) for row in motion]).reshape(-1, 2)

    return plain_rates, plain_film, None


def _compiled_rates(
    form: CompiledForce, structure: tuple[Array, ...]
) -> tuple[Rates, FilmSeries, None]:
    kind, numbers, table = form.kind, form.numbers, form.table

    def rates(t: float, s: Array) -> Array:
        return _compiled_state_rates(t, s, kind, numbers, table, *structure)

    def film(motion: Array, _states: Array) -> Array:
        return film_force_series(kind, motion, numbers, table)

    return rates, film, None


def pack_loads(loads: Sequence[Load], rotor: Rotor) -> tuple[Array, Array]:
    """Pack loads into arrays for the compiled right-hand side.

    Returns shapes : (k, 2, 2n) array: Amplitudes of the cosine and sine parts on every degree of
        freedom [N].
    Returns numbers : (k, 4) array: Kind, start, stop [s], frequency [rad/s].
    """
    size = rotor.mass.shape[0]
    shapes, numbers = np.zeros((len(loads), 2, size)), np.zeros((len(loads), 4))
    for shape, number, load in zip(shapes, numbers, loads, strict=True):
        match load:
            case StepForce():
                shape[0, _plane(load.node, rotor)] = load.force
                number[:] = _CONSTANT, load.start, load.stop, 0.0
            case HarmonicForce():
                shape[:, _plane(load.node, rotor)] = _cosine_and_sine(load.force, load.phase)
                number[:] = _HARMONIC, load.start, load.stop, load.frequency
            case BaseMotion():
                base = _cosine_and_sine(load.displacement, load.phase) * load.frequency**2
                shape[:] = [rotor.mass @ rotor.translation(part) for part in base]
                number[:] = _HARMONIC, load.start, load.stop, load.frequency
            case BaseShock():
                shape[0] = -rotor.mass @ rotor.translation(load.acceleration)
                stop = load.start + load.duration
                number[:] = _HALF_SINE, load.start, stop, math.pi / load.duration
    return shapes, numbers


def load_on_rotor(loads: Sequence[Load], rotor: Rotor, t: Array) -> Array:
    """Return the sum of the loads over all nodes (n, 2) [N] at times t (n,)."""
    shapes, numbers = pack_loads(loads, rotor)
    every = _load_series(np.asarray(t, dtype=float), shapes, numbers)
    return np.stack([every[:, rotor.first_unknown + axis].sum(axis=1) for axis in (0, 1)], axis=1)


def _plane(node: int, rotor: Rotor) -> slice:
    """Return the place of a node's x and y."""
    if not 0 <= node < len(rotor.nodes):
        raise InputError(
            f"must be from 0 to {len(rotor.nodes) - 1}", key="orbit.load.node", value=node
        )
    first = int(rotor.first_unknown[node])
    return slice(first, first + 2)


def _cosine_and_sine(amplitude: tuple[float, float], phase: tuple[float, float]) -> Array:
    a, p = np.asarray(amplitude), np.asarray(phase)
    return np.stack([a * np.cos(p), -a * np.sin(p)])


@compiled()
def _add_loads(t: float, force: Array, shapes: Array, times: Array) -> None:
    for k in range(times.shape[0]):
        if times[k, 1] <= t < times[k, 2]:
            if times[k, 0] == _CONSTANT:
                c, s = 1.0, 0.0
            elif times[k, 0] == _HARMONIC:
                c, s = math.cos(times[k, 3] * t), math.sin(times[k, 3] * t)
            else:
                c, s = math.sin(times[k, 3] * (t - times[k, 1])), 0.0
            for i in range(force.size):
                force[i] += shapes[k, 0, i] * c + shapes[k, 1, i] * s


@compiled()
def _load_series(t: Array, shapes: Array, times: Array) -> Array:
    """Return the loads on every degree of freedom (n, 2k) [N] at times t (n,); see `pack_loads`."""
    out = np.zeros((t.size, shapes.shape[2]))
    for i in range(t.size):
        _add_loads(t[i], out[i], shapes, times)
    return out


@compiled()
def _motion_rates(
    t: float,
    state: Array,
    film: Array,
    rotor: Array,
    unbalance: Array,
    schedule: Array,
    shapes: Array,
    times: Array,
    controller: Array,
    reference: Array,
) -> Array:
    """Return the state rates from known forces of the film.

    film: on the journal's two unknowns, and on the last ones, those of pads;
    state: displacements, velocities, controller states; rotor: inverse mass, damping, stiffness,
    gyroscopic, circulatory matrix; unbalance: (n_nodes, 3) mass times radius, phase, place of x;
    shapes, times: see
    `pack_loads`; controller: blocks [[A, B], [C, D]].
    """
    size = rotor.shape[1]
    rates = np.empty(state.size)
    force = np.zeros(size)
    phi, w, alpha = shaft(t, schedule)
    force[:2] = film[:2]
    force[size + 2 - film.size :] += film[2:]
    for k in range(unbalance.shape[0]):
        if unbalance[k, 0] != 0.0:
            c, s = math.cos(phi + unbalance[k, 1]), math.sin(phi + unbalance[k, 1])
            x = int(unbalance[k, 2])
            force[x] += unbalance[k, 0] * (w * w * c + alpha * s)
            force[x + 1] += unbalance[k, 0] * (w * w * s - alpha * c)
    _add_loads(t, force, shapes, times)
    extra = state.size - 2 * size
    if controller.shape[0] > 0:
        _add_control(state, force, rates, controller, reference, size, extra)
    for i in range(size):
        for j in range(size):
            force[i] -= (rotor[1, i, j] + w * rotor[3, i, j]) * state[size + j]
            force[i] -= (rotor[2, i, j] + w * rotor[4, i, j]) * state[j]
    for i in range(size):
        rates[i] = state[size + i]
        total = 0.0
        for j in range(size):
            total += rotor[0, i, j] * force[j]
        rates[size + i] = total
    return rates


@compiled()
def _add_control(
    state: Array,
    force: Array,
    rates: Array,
    controller: Array,
    reference: Array,
    size: int,
    extra: int,
) -> None:
    inputs = np.empty(extra + 4)
    inputs[:extra] = state[2 * size :]
    inputs[extra] = state[0] - reference[0]
    inputs[extra + 1] = state[1] - reference[1]
    inputs[extra + 2] = state[size]
    inputs[extra + 3] = state[size + 1]
    for i in range(extra + 2):
        total = 0.0
        for j in range(extra + 4):
            total += controller[i, j] * inputs[j]
        if i < extra:
            rates[2 * size + i] = total
        else:
            force[i - extra] += total


@compiled()
def _compiled_state_rates(
    t: float,
    state: Array,
    kind: int,
    numbers: Array,
    table: Array,
    rotor: Array,
    unbalance: Array,
    schedule: Array,
    shapes: Array,
    times: Array,
    controller: Array,
    reference: Array,
) -> Array:
    """Return the state rates with the film force of one of the compiled models."""
    size = rotor.shape[1]
    speed = shaft(t, schedule)[1]
    vx, vy = float(state[size]), float(state[size + 1])
    film = np.empty(2)
    film[0], film[1] = film_force(kind, state[0], state[1], vx, vy, speed, numbers, table)
    return _motion_rates(
        t, state, film, rotor, unbalance, schedule, shapes, times, controller, reference
    )
