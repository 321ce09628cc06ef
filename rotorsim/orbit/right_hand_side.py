"""From a problem to the functions and numbers that an integrator wants."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from . import kernels
from .forces import CompilableForce, CompiledForce
from .loads import StepForce, pack_loads
from .problem import OrbitProblem

Array = NDArray[np.float64]
Rates = Callable[[float, Array], Array]
FilmSeries = Callable[[Array], Array]


def static_load(problem: OrbitProblem) -> Array:
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
    if size > 2:
        free = rotor.stiffness[2:, 2:]
        pull = static_load(problem)[2:] - rotor.stiffness[2:, :2] @ state[:2]
        state[2:size] = np.linalg.lstsq(free, pull, rcond=None)[0]
    return state


def right_hand_side(problem: OrbitProblem) -> tuple[Rates, FilmSeries]:
    """State rates, and the film force along (n, 5) motion."""
    rotor, controller = problem.rotor, problem.controller
    shapes, times = pack_loads(problem.loads, rotor)
    if any(problem.static_load):
        still, always = pack_loads([StepForce((0.0, 0.0))], rotor)
        still[0, 0], always[0, 1] = static_load(problem), -math.inf
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

    def rates(t: float, s: Array) -> Array:
        speed = kernels.shaft(t, schedule)[1]
        vx, vy = float(s[size]), float(s[size + 1])
        fx, fy = force.force(float(s[0]), float(s[1]), vx, vy, speed)
        return kernels.motion_rates(t, s, fx, fy, *structure)

    def film(motion: Array) -> Array:
        return np.array([force.force(*row) for row in motion]).reshape(-1, 2)

    return rates, film


def _compiled_rates(form: CompiledForce, structure: tuple[Array, ...]) -> tuple[Rates, FilmSeries]:
    kind, numbers, table = form.kind, form.numbers, form.table
    evaluate = kernels.rates

    def rates(t: float, s: Array) -> Array:
        return evaluate(t, s, kind, numbers, table, *structure)

    def film(motion: Array) -> Array:
        return kernels.film_force_series(kind, motion, numbers, table)

    return rates, film
