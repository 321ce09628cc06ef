"""A motion from its static position to its end, touch-down or failure, piece by piece."""

from __future__ import annotations

import itertools
import math
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from ..arrays import Array
from ..threads import on_one_blas_thread
from .controlled import Advance
from .motion import SERIES, Motion, MotionProblem, TorqueDrive, rings_of
from .orbit import Orbit, OrbitStatus
from .problem import SpeedSchedule
from .steps import FILM_ERRORS, Exact, Rosenbrock, Scipy
from .system import MotionSystem, Plain, derivatives, force_on

CHUNK_REVOLUTIONS = 32
"""Of the shaft in one piece of a run."""
_STATIC_STEPS = 200


def static_position(
    system: MotionSystem, plain: Plain, speed: float, guess: Array
) -> tuple[Array, float]:
    """Return displacements (n,) at which the machine rests, and the force that is left over [N].

    Newton's method with the links' derivatives by differences, steps halved where films would
    touch; unbalance and varying loads do not act.
    """
    still = plain._replace(
        unbalance_start=np.full_like(plain.unbalance_start, math.inf),
        load_times=plain.load_times + np.array([0.0, math.inf, math.inf]),
    )
    rings = rings_of(system)

    def residual(z: Array) -> Array:
        q, v = z.copy(), np.zeros_like(z)
        q[rings], v[rings] = 0.0, z[rings]
        force = force_on(0.0, q, v, 0.0, speed, 0.0, still)
        return force + system.solved(q, v, speed)

    def inside(z: Array) -> bool:
        for link in system.links:
            if link.film:
                x, y = link.motion(z[None], np.zeros((1, z.size)), np.zeros(1))[0, :2]
                if math.hypot(x, y) >= 0.9995 * link.force.radial_clearance:
                    return False
        return True

    z, units = guess.copy(), system.scale.copy()
    units[rings] = speed
    off = residual(z)
    weight = max(float(np.abs(system.constant).max()), 1e-9)
    for _ in range(_STATIC_STEPS):
        if np.abs(off).max() < 1e-10 * weight:
            break
        q, v = z.copy(), np.zeros_like(z)
        q[rings], v[rings] = 0.0, z[rings]
        jacobian, damping = derivatives(q, v, speed, system.scale, still)
        jacobian[:, rings] = damping[:, rings]
        jacobian = jacobian + system.solved_derivatives(q, v, speed)[0]
        step = units * np.linalg.lstsq(jacobian * units, off, rcond=1e-14)[0]
        share = 1.0
        while share > 1e-4:
            trial = z + share * step
            if inside(trial):
                new = residual(trial)
                if np.linalg.norm(new) < np.linalg.norm(off):
                    break
            share *= 0.5
        else:
            break
        z, off = trial, new
    return z, float(np.abs(off).max())


@on_one_blas_thread
def simulate_motion(
    problem: MotionProblem,
    *,
    consume: Callable[[Motion], None] | None = None,
    keep_revolutions: int | None = None,
) -> Motion:
    """Integrate a machine's motion to its end, touch-down or failure.

    consume : Called with each piece of some revolutions as soon as it is there.
    keep_revolutions : Keep the last so many revolutions only.

    Returns: With ``status``: never an exception for what happens in the run.
    """
    pieces = last_pieces(
        pieces_of(problem), problem.samples_per_revolution, consume, keep_revolutions
    )
    joined = {name: np.concatenate([getattr(one, name) for one in pieces]) for name in SERIES}
    return replace(pieces[-1], **joined)


_Piece = TypeVar("_Piece", Orbit, Motion)


def last_pieces(
    pieces: Iterable[_Piece],
    samples_per_revolution: int,
    consume: Callable[[_Piece], None] | None,
    keep_revolutions: int | None,
    drop: Callable[[_Piece], None] | None = None,
) -> list[_Piece]:
    """Return the pieces that hold the last `keep_revolutions` (None: all).

    consume, drop : Called with each piece as it comes, and as it is left out.
    """
    kept: deque[_Piece] = deque()
    samples = 0
    for piece in pieces:
        if consume is not None:
            consume(piece)
        kept.append(piece)
        samples += piece.t.size
        while keep_revolutions is not None and len(kept) > 1:
            if samples - kept[0].t.size < keep_revolutions * samples_per_revolution:
                break
            old = kept.popleft()
            samples -= old.t.size
            if drop is not None:
                drop(old)
    return list(kept)


def pieces_of(problem: MotionProblem, revolutions: int = CHUNK_REVOLUTIONS) -> Iterator[Motion]:
    """Integrate piece by piece, of some revolutions each: status ``running`` but for the last."""
    if isinstance(problem.drive, TorqueDrive):
        yield from _driven(problem, problem.drive)
        return
    schedule = problem.drive
    samples = problem.samples_per_revolution
    edges = _edges(problem, schedule, revolutions)
    count = math.floor(schedule.revolutions * samples + 1e-9) + 1
    q, v, done = problem.start, problem.velocity, 0
    law = None if problem.loop is None else problem.loop.sampler()
    if problem.system.linear and schedule.is_constant and law is None:
        advance: Advance = Exact(problem, schedule)
    elif problem.system.compilable:
        advance = Rosenbrock(problem, schedule)
    else:
        advance = Scipy(problem, schedule)
    if law is not None:
        advance = law.stopping(advance)
    for start, stop in itertools.pairwise(edges):
        last = stop == edges[-1]
        turned = float(schedule.angle_at(stop)) / (2.0 * np.pi) * samples
        upto = count if last else math.ceil(turned - 1e-9)
        angles = 2.0 * np.pi * np.arange(done, upto) / samples
        times = np.clip(schedule.time_at(angles), start, stop)
        found, status, message, q, v, *events = advance(q, v, start, stop, times)
        reached = found[0].shape[0]
        done += reached
        ended = last or status is not OrbitStatus.COMPLETED
        yield Motion(
            times[:reached], schedule.speed_at(times[:reached]), angles[:reached], *found, problem,
            status if ended else OrbitStatus.RUNNING, message, tuple(events),
        )  # fmt: skip
        if ended:
            return


def _edges(problem: MotionProblem, schedule: SpeedSchedule, revolutions: int) -> list[float]:
    """Return where pieces end [s]: after some revolutions, and at corners of speed and loads."""
    turns = np.arange(0.0, schedule.revolutions, max(revolutions, 1))
    edges = {*schedule.time_at(2.0 * np.pi * turns).tolist(), *schedule.times}
    return _with_corners(problem, edges, schedule.duration)


def _with_corners(problem: MotionProblem, edges: Iterable[float], duration: float) -> list[float]:
    """Return edges [s] with the times at which unbalance and loads begin and end, to the last."""
    corners = {start for start, _ in problem.system.unbalance}
    corners |= {time for load in problem.system.loads for time in (load.start, load.stop)}
    ordered = sorted({*edges, duration, *(t for t in corners if 0.0 < t < duration)})
    kept = [ordered[0]]
    kept += [t for t in ordered[1:] if t - kept[-1] > 1e-9 * duration]
    kept[-1] = duration
    return kept


def _driven(problem: MotionProblem, drive: TorqueDrive) -> Iterator[Motion]:
    """Return the pieces of a run whose speed follows from a torque."""
    solver, n = Scipy(problem, None), problem.system.size
    span = 2.0 * np.pi * CHUNK_REVOLUTIONS / max(max(drive.speeds), 1e-9)
    edges = _with_corners(problem, np.arange(0.0, drive.duration, span).tolist(), drive.duration)
    state = np.concatenate([problem.start, problem.velocity, [0.0, drive.start]])
    law = None if problem.loop is None else problem.loop.sampler()
    done = 0
    for start, stop in itertools.pairwise(edges):
        rows, t = [(np.zeros(0), np.zeros((0, state.size)))], start
        while True:
            end = stop
            if law is not None:
                state[n : 2 * n] = law.act(t, state[:n], state[n : 2 * n])
                end = min(stop, law.due)
            try:
                found = solver.solved(state, t, end)
            except FILM_ERRORS as error:
                status, message, events = OrbitStatus.INTEGRATION_FAILED, str(error), []
                break
            rows.append(_at_equal_angles(found, done, problem.samples_per_revolution))
            done += rows[-1][0].size
            t, state = end, found.y[:, -1]
            status, message, *events = solver.ended(found)
            if status is not OrbitStatus.COMPLETED or t == stop:
                break
        last = status is not OrbitStatus.COMPLETED or stop == edges[-1]
        times, y = (np.concatenate(column) for column in zip(*rows, strict=True))
        angles = 2.0 * np.pi * np.arange(done - times.size, done) / problem.samples_per_revolution
        yield Motion(
            times, y[:, 2 * n + 1], angles, y[:, :n], y[:, n : 2 * n], problem,
            status if last else OrbitStatus.RUNNING, message, tuple(events),
        )  # fmt: skip
        if last:
            return


def _at_equal_angles(found: Any, done: int, per_turn: int) -> tuple[Array, Array]:
    """Return times (m,) and states (m, n) at the samples of a turn from number `done` on.

    found : Of SciPy; its last two states are the shaft's angle and speed.
    """
    turned = np.maximum.accumulate(found.y[-2])
    upto = math.floor(turned[-1] / (2.0 * np.pi) * per_turn + 1e-9) + 1
    angles = 2.0 * np.pi * np.arange(done, max(upto, done)) / per_turn
    if not angles.size:
        return angles, np.zeros((0, len(found.y)))
    times = np.interp(angles, turned, found.t)
    for _ in range(3):
        at = found.sol(times)
        times = times + (angles - at[-2]) / np.maximum(at[-1], 1e-9)
        times = np.clip(times, found.t[0], found.t[-1])
    return times, found.sol(times).T
