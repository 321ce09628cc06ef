"""Motion of a whole machine in time: what is integrated, how, and what comes back."""

from __future__ import annotations

import itertools
import math
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from ..arrays import Array, Indices
from ..errors import InputError
from ..threads import on_one_blas_thread
from .controlled import Advance, Answer, Loop
from .kernels import shaft
from .march import DONE, TOUCHED, march, repeat
from .orbit import Orbit, OrbitEvent, OrbitStatus
from .problem import SpeedSchedule
from .system import Link, MotionSystem, Plain, derivatives, force_on

CHUNK_REVOLUTIONS = 32
"""Of the shaft in one piece of a run."""
_TOLERANCE = 1e-5
_SOLVED_TOLERANCE, _SOLVED_TOLERANCE_SCIPY = 1e-3, 1e-4
"""Tolerances of steps that solve a film, in compiled code and by SciPy. The film's cells change
from full to ruptured one by one, which no step sees to more digits; the compiled method's own
error is a tenth of its estimate."""
_STATIC_STEPS = 200
_FILM_ERRORS = (ArithmeticError, ValueError, np.linalg.LinAlgError)
"""Of a film that cannot be solved at a step."""


@dataclass(frozen=True)
class TorqueDrive:
    """A shaft that a torque drives: polar inertia times acceleration is the sum of torques.

    start : Speed at the beginning [rad/s].
    duration : [s]
    torque : [N m]; negative when it brakes.
    drag : Torque that retards, over the speed [N m s].
    inertia : Polar, of the whole rotor [kg m^2].
    """

    start: float
    duration: float
    torque: float
    drag: float
    inertia: float

    @property
    def speeds(self) -> tuple[float, float]:
        """Lowest and highest speed that the torque alone may lead to [rad/s]."""
        end = self.start + self.torque / self.inertia * self.duration
        if self.drag > 0.0:
            steady = self.torque / self.drag
            end = steady + (self.start - steady) * math.exp(
                -self.drag * self.duration / self.inertia
            )
        return min(self.start, max(end, 0.0)), max(self.start, end)


@dataclass(frozen=True)
class Station:
    """A place whose motion is looked at.

    places : (int, int). Of x and y among the displacements of the whole machine.
    position : From the left end [m].
    link : The film there, whose housing the motion is relative to.
    """

    name: str
    places: tuple[int, int]
    position: float = float("nan")
    link: int | None = None


@dataclass(frozen=True, eq=False)
class MotionProblem:
    """A machine, its speed, where it begins.

    start, velocity : (n,) arrays. Displacements [m] and velocities [m/s] of the system's unknowns
        at the beginning.
    equilibrium : (n,) array. Static position at the first speed [m].
    tolerance : Relative, of one step; None: 1e-5, with films that are solved 1e-3, and 1e-4 where
        SciPy integrates them (pads, turbulence, films that conserve mass).
    kind, thermal_model, note : Labels.
    reduction_error : Largest relative change of an eigenvalue by the reduction, up to the highest
        excitation.
    contact : Displacements (m, n) to the film (m,) that is left before the run ends [m]; None: that
        of round journals in round films.
    loop : The controller, see `rotorsim.orbit.controlled`.
    """

    system: MotionSystem
    drive: SpeedSchedule | TorqueDrive
    start: Array
    velocity: Array
    equilibrium: Array
    stations: tuple[Station, ...]
    samples_per_revolution: int = 64
    tolerance: float | None = None
    kind: str = ""
    thermal_model: str = ""
    note: str = ""
    reduction_error: float = 0.0
    forcing: tuple[float, ...] = ()
    contact: Callable[[Array], Array] | None = None
    loop: Loop | None = None

    def __getstate__(self) -> dict[str, Any]:
        # `plain` may hold addresses of compiled functions, which are good in this process only.
        return {name: value for name, value in self.__dict__.items() if name != "plain"}

    def film_left(self, q: Array) -> Array:
        """Return the film (m,) that is left at displacements (m, n) before the run ends [m]."""
        if self.contact is not None:
            return self.contact(q)
        left = np.full(len(q), math.inf)
        for link in self.system.links:
            if link.film:
                x, y = link.motion(q, 0.0 * q, np.zeros(len(q)))[:, :2].T
                room = link.force.radial_clearance - link.minimum_film
                left = np.minimum(left, room - np.hypot(x, y))
        return left

    @property
    def schedule(self) -> SpeedSchedule:
        """Prescribed speed; InputError where a torque drives."""
        if isinstance(self.drive, TorqueDrive):
            raise InputError("a torque drives this machine", key="orbit.drive")
        return self.drive

    @cached_property
    def plain(self) -> Plain:
        """Arrays for the compiled functions."""
        speeds = self.drive.speeds
        return self.system.plain(min(speeds), max(speeds))

    @property
    def drive_turns(self) -> float:
        """Turns of the shaft in the whole run; with a torque, at most."""
        if isinstance(self.drive, TorqueDrive):
            return max(self.drive.speeds) * self.drive.duration / (2.0 * math.pi)
        return self.drive.revolutions

    @property
    def relative_tolerance(self) -> float:
        """Tolerance in use."""
        if self.tolerance is not None:
            return self.tolerance
        if not self.system.compilable:
            return _SOLVED_TOLERANCE_SCIPY
        solved = any(link.generalised is not None for link in self.system.links)
        return _SOLVED_TOLERANCE if solved else _TOLERANCE


@dataclass(frozen=True, eq=False)
class Motion:
    """Samples of a machine's motion (SI, machine frame).

    t, speed, angle : (m,) arrays. [s], of the shaft [rad/s, rad]; the samples are equally spaced in
        the angle.
    q, v : (m, n) arrays. Unknowns of the system and their rates [m, m/s].
    """

    t: Array
    speed: Array
    angle: Array
    q: Array
    v: Array
    problem: MotionProblem
    status: OrbitStatus
    message: str = ""
    events: tuple[OrbitEvent, ...] = field(default=())

    def __repr__(self) -> str:
        end = f"{self.revolutions[-1]:.4g} turns in {self.t[-1]:.4g} s" if self.t.size else "empty"
        return (
            f"<Motion: {self.q.shape[1]} unknowns, {len(self.stations)} stations, {end}, "
            f"{self.status.value}>"
        )

    @property
    def stations(self) -> tuple[Station, ...]:
        """Places whose motion can be asked for by name."""
        return self.problem.stations

    @property
    def revolutions(self) -> Array:
        """Turns of the shaft at each sample [-]."""
        return self.angle / (2.0 * np.pi)

    def station(self, name: str) -> Station:
        """Return the station by its name.

        Raises InputError: There is none; the message lists them.
        """
        for one in self.stations:
            if one.name == name:
                return one
        known = ", ".join(one.name for one in self.stations)
        raise InputError(f"must be one of {known}", key="station", value=name)

    def stations_of(self, link: int) -> str:
        """Return the name of the station of a film."""
        return next(one.name for one in self.stations if one.link == link)

    def displacement(self, places: Sequence[int] | Indices) -> Array:
        """Return the displacements (m, k) of unknowns of the whole machine [m]."""
        rows = np.asarray(places, dtype=np.intp)
        system = self.problem.system
        return self.q @ system.basis[rows].T + system.offset[rows]

    def link_motion(self, link: Link) -> Array:
        """Return position, velocity, effective speed (m, 5) of the inner body in its housing."""
        return link.motion(self.q, self.v, self.speed)

    def link_force(self, link: Link) -> Array:
        """Return the force (m, 2) of a link on its inner body [N]."""
        return self.problem.system.link_forces(link, self.q, self.v, self.speed, self.problem.plain)

    @property
    def actuator_force(self) -> Array:
        """Return the forces (m, k) of a controller's actuators [N]; k = 0 without one."""
        loop = self.problem.loop
        return np.zeros((self.t.size, 0)) if loop is None else loop.forces(self.q, self.v)

    def orbit(self, name: str) -> Orbit:
        """Return the motion of one station for analysis, figures and recordings of an `Orbit`.

        In a film it is relative to the housing, with the film's force; elsewhere it is that of
        the shaft's centre, without a force, and boundary and least film are those of a circle
        around its rest, of the films' least clearance or of its own reach.
        """
        station, system = self.station(name), self.problem.system
        links = [link for link in system.links if link.film]
        clearance = min((one.force.radial_clearance for one in links), default=0.0)
        zero = np.zeros((self.t.size, 2))
        rows = list(station.places)
        if station.link is not None:
            link = system.links[station.link]
            clearance = link.force.radial_clearance
            motion, force = self.link_motion(link), self.link_force(link)
            rest = self.problem.equilibrium[None]
            home = link.motion(rest, 0.0 * rest, np.zeros(1))[0, :2]
        else:
            place = self.displacement(rows)
            velocity = self.v @ system.basis[rows].T
            motion, force = np.hstack([place, velocity]), zero
            home = system.basis[rows] @ self.problem.equilibrium + system.offset[rows]
            clearance = clearance or max(float(np.abs(place - home).max(initial=0.0)), 1e-9)
        turn = np.linspace(0.0, 2.0 * math.pi, 361)
        middle = np.zeros(2) if station.link is not None else home
        x, y, vx, vy = (np.ascontiguousarray(column) for column in motion[:, :4].T)
        return Orbit(
            t=self.t, x=x, y=y, vx=vx, vy=vy, speed=self.speed, angle=self.angle,
            fx=force[:, 0], fy=force[:, 1], load=zero, actuator_force=self._actuator_at(rows),
            displacements=motion[:, :2],
            min_film=clearance - np.hypot(x - middle[0], y - middle[1]),
            boundary=clearance * np.column_stack([np.cos(turn), np.sin(turn)]),
            samples_per_revolution=self.problem.samples_per_revolution,
            radial_clearance=clearance, equilibrium=(float(home[0]), float(home[1])),
            force_model=system.links[station.link].force.name if station.link is not None
            else ("linear" if system.linear else "free shaft"),
            thermal_model=self.problem.thermal_model, status=self.status, message=self.message,
            forced=bool(system.unbalance or system.loads), forcing=self.problem.forcing,
            kind=self.problem.kind, note=self.problem.note,
        )  # fmt: skip

    def _actuator_at(self, rows: Sequence[int]) -> Array:
        """Return the force (m, 2) of a controller on displacements x and y of a node [N]."""
        loop = self.problem.loop
        if loop is None:
            return np.zeros((self.t.size, 2))
        driven = np.array(loop.driven)
        return self.actuator_force @ (driven[:, None] == np.array(rows)).astype(float)

    def ring_speed(self, name: str) -> Array:
        """Return the speed (m,) of the floating ring of a support [rad/s].

        Raises InputError: It has no ring that turns; the message lists those that have.
        """
        rings = {one.name: one.ring for one in self.problem.system.links if one.ring >= 0}
        if name not in rings:
            known = ", ".join(rings) or "none of this machine"
            raise InputError(f"must have a ring that turns: {known}", key="support", value=name)
        return self.v[:, rings[name]]

    def part(self, first: int, last: int | None = None) -> Motion:
        """Return the samples first to last (excluded)."""
        chosen = slice(first, last)
        cut = {name: getattr(self, name)[chosen] for name in _SERIES}
        return replace(self, **cut)


_SERIES = ("t", "speed", "angle", "q", "v")


def rings_of(system: MotionSystem) -> Indices:
    """Return the unknowns that are angles of floating rings."""
    return np.array(sorted({one.ring for one in system.links if one.ring >= 0}), dtype=np.intp)


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
    joined = {name: np.concatenate([getattr(one, name) for one in pieces]) for name in _SERIES}
    return replace(pieces[-1], **joined)


_Piece = TypeVar("_Piece", Orbit, "Motion")


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
        advance: Advance = _Exact(problem, schedule)
    elif problem.system.compilable:
        advance = _Rosenbrock(problem, schedule)
    else:
        advance = _Scipy(problem, schedule)
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


def _touched(problem: MotionProblem, t: float, q: Array) -> tuple[str, OrbitEvent]:
    """Describe where the surfaces touch, from time and displacements."""
    films = [one for one in problem.system.links if one.film]
    places = [one.motion(q[None], 0.0 * q[None], np.zeros(1))[0, :2] for one in films]
    left = [
        one.force.radial_clearance - math.hypot(*place)
        for one, place in zip(films, places, strict=True)
    ]
    k = int(np.argmin(left))
    event = OrbitEvent("touch_down", t, float(places[k][0]), float(places[k][1]))
    return f"{films[k].name}: the surfaces touch after {t:.6g} s", event


class _Rosenbrock:
    """Compiled steps; see `rotorsim.orbit.march`."""

    def __init__(self, problem: MotionProblem, schedule: SpeedSchedule) -> None:
        self.problem, self.knots = problem, schedule.knots
        self.step = 2.0 * np.pi / max(max(schedule.speeds), 1e-9) / 200.0

    def _march(self, q: Array, v: Array, start: float, stop: float, times: Array, step: float):
        problem = self.problem
        return march(
            q, v, float(start), float(stop), np.ascontiguousarray(times), self.knots,
            problem.plain, problem.system.scale, problem.relative_tolerance, step,
        )  # fmt: skip

    def __call__(self, q: Array, v: Array, start: float, stop: float, times: Array) -> Answer:
        problem, begin = self.problem, (q, v)
        qs, vs, count, status, end, q, v, self.step = self._march(
            q, v, start, stop, times, self.step
        )
        qs, vs = qs[:count], vs[:count]
        bad = status == TOUCHED
        if problem.contact is not None or bad:
            bad = bad or problem.film_left(np.vstack([qs, q])).min() <= 0.0
        if bad:
            fine = np.cumprod(problem.film_left(qs) > 0.0).sum() if count else 0
            first = (
                (start, *begin)
                if fine == 0
                else (float(times[fine - 1]), qs[fine - 1], vs[fine - 1])
            )
            last = end if fine == count else times[fine]
            when, q, v = self._contact(*first, float(last))
            message, event = _touched(problem, when, q)
            found = qs[:fine], vs[:fine]
            return found, OrbitStatus.TOUCH_DOWN, message, q, v, event
        if status != DONE:
            message = f"the steps became too short at {end:.6g} s"
            return (qs, vs), OrbitStatus.INTEGRATION_FAILED, message, q, v
        return (qs, vs), OrbitStatus.COMPLETED, "", q, v

    def _contact(self, t: float, q: Array, v: Array, stop: float) -> tuple[float, Array, Array]:
        """Halve the time between a state with film and one without down to where it ends."""
        none, last = np.zeros(0), (stop, q, v)
        slack = 1e-12 * max(stop, 1e-300)
        while stop - t > slack:
            middle = 0.5 * (t + stop)
            *_, end, q1, v1, _ = self._march(q, v, t, middle, none, middle - t)
            if end < middle or self.problem.film_left(q1[None])[0] <= 0.0:
                if end <= t:
                    break
                stop, last = end, (end, q1, v1)
            else:
                t, q, v = middle, q1, v1
        return last if last[0] > t else (t, q, v)


class _Exact:
    """Linear machine at one speed: its matrix exponential, loads as oscillators of their own."""

    def __init__(self, problem: MotionProblem, schedule: SpeedSchedule) -> None:
        self.problem, self.speed = problem, schedule.speeds[0]
        self.period = 2.0 * np.pi / self.speed / problem.samples_per_revolution
        self.made: dict[bytes, tuple[Array, Array]] = {}

    def _generator(self, middle: float) -> tuple[Array, list[float]]:
        """Return matrix of motion and acting oscillators, and the oscillators' frequencies."""
        system, w = self.problem.system, self.speed
        n = system.size
        stiffness, damping = derivatives(np.zeros(n), np.zeros(n), w, system.scale,
                                         self.problem.plain)  # fmt: skip
        forces = [(0.0, self.problem.plain.constant.astype(complex))]
        turning = [u for start, u in system.unbalance if start <= middle]
        if turning:
            forces.append((w, np.asarray(w * w * np.sum(turning, axis=0), dtype=complex)))
        forces += [
            (load.frequency, load.amplitude)
            for load in system.loads
            if load.start <= middle < load.stop
        ]
        a = np.zeros((2 * n + 2 * len(forces),) * 2)
        inverse = np.linalg.inv(system.mass)
        a[:n, n : 2 * n] = np.eye(n)
        a[n : 2 * n, :n], a[n : 2 * n, n : 2 * n] = -inverse @ stiffness, -inverse @ damping
        for k, (frequency, amplitude) in enumerate(forces):
            cos = 2 * n + 2 * k
            a[n : 2 * n, cos], a[n : 2 * n, cos + 1] = (
                inverse @ np.real(amplitude), -inverse @ np.imag(amplitude)
            )  # fmt: skip
            a[cos, cos + 1], a[cos + 1, cos] = -frequency, frequency
        return a, [frequency for frequency, _ in forces]

    def __call__(self, q: Array, v: Array, start: float, stop: float, times: Array) -> Answer:
        from scipy.linalg import expm

        a, frequencies = self._generator(0.5 * (start + stop))
        n = q.size
        key = a.tobytes()
        if key not in self.made:
            self.made[key] = a, np.asarray(expm(a * self.period), dtype=float)
        step = self.made[key][1]

        def state(t: float, q: Array, v: Array) -> Array:
            turned = [part for f in frequencies for part in (math.cos(f * t), math.sin(f * t))]
            return np.concatenate([q, v, turned])

        if not times.size:
            end = expm(a * (stop - start)) @ state(start, q, v)
            return (np.zeros((0, n)), np.zeros((0, n))), OrbitStatus.COMPLETED, "", *_halves(end, n)
        first = state(start, q, v)
        if times[0] > start:
            first = expm(a * (times[0] - start)) @ first
        path = repeat(step, np.ascontiguousarray(first), times.size)
        left = stop - times[-1]
        if abs(left - self.period) < 1e-9 * self.period:
            end = step @ path[-1]
        else:
            end = path[-1] if left <= 0.0 else expm(a * left) @ path[-1]
        found = path[:, :n].copy(), path[:, n : 2 * n].copy()
        return found, OrbitStatus.COMPLETED, "", *_halves(end, n)


def _halves(state: Array, n: int) -> tuple[Array, Array]:
    return state[:n].copy(), state[n : 2 * n].copy()


class _Scipy:
    """SciPy's LSODA, for films that are solved at each step and for shafts that a torque drives."""

    def __init__(self, problem: MotionProblem, schedule: SpeedSchedule | None) -> None:
        self.problem, self.schedule = problem, schedule
        self.knots = schedule.knots if schedule is not None else np.zeros((0, 4))
        system, n = problem.system, problem.system.size
        self.inverse = np.linalg.inv(system.mass)
        top = max(max(problem.drive.speeds), 1.0)
        least = 1e-2 * problem.relative_tolerance * system.scale
        self.tolerance = np.concatenate([least, top * least])
        if schedule is None:
            self.tolerance = np.concatenate([self.tolerance, [1e-9, 1e-9 * top]])
        self.size = n

    def rates(self, t: float, s: Array) -> Array:
        """Return state rates: displacements, velocities; angle and speed where a torque drives."""
        n, problem, p = self.size, self.problem, self.problem.plain
        q, v = np.ascontiguousarray(s[:n]), np.ascontiguousarray(s[n : 2 * n])
        if self.schedule is not None:
            phi, w, alpha = shaft(t, self.knots)
            force = force_on(t, q, v, phi, w, alpha, p)
            if not problem.system.compilable:
                force = force + problem.system.solved(q, v, w)
            return np.concatenate([v, self.inverse @ force])
        drive = problem.drive
        assert isinstance(drive, TorqueDrive)
        phi, w = float(s[2 * n]), float(s[2 * n + 1])
        force = force_on(t, q, v, phi, w, 0.0, p)
        if not problem.system.compilable:
            force = force + problem.system.solved(q, v, w)
        # u (x'' sin - y'' cos) of the unbalance retards the shaft: the two accelerate together
        arm = np.zeros(n)
        for start, u in problem.system.unbalance:
            if t >= start:
                arm += u.real * math.sin(phi) + u.imag * math.cos(phi)
        free, coupled = self.inverse @ force, self.inverse @ arm
        torque = drive.torque - drive.drag * w + arm @ free
        alpha = torque / (drive.inertia - arm @ coupled)
        return np.concatenate([v, free + alpha * coupled, [w, alpha]])

    def jacobian(self, t: float, s: Array) -> Array:
        """Return derivatives of the rates at a prescribed speed.

        Films by differences, the rest as it is.

        LSODA's own would solve each film once for every unknown of the rotor.
        """
        assert self.schedule is not None
        n, system, w = self.size, self.problem.system, float(self.schedule.speed_at(t))
        q, v = np.ascontiguousarray(s[:n]), np.ascontiguousarray(s[n : 2 * n])
        stiffness, damping = derivatives(q, v, w, system.scale, self.problem.plain)
        more_stiffness, more_damping = system.solved_derivatives(q, v, w)
        found = np.zeros((2 * n, 2 * n))
        found[:n, n:] = np.eye(n)
        found[n:, :n] = -self.inverse @ (stiffness + more_stiffness)
        found[n:, n:] = -self.inverse @ (damping + more_damping)
        return found

    def solved(self, state: Array, start: float, stop: float, times: Array | None = None) -> Any:
        """Return SciPy's solution at times, or at any time (`sol`), up to where a film ends.

        Raises ArithmeticError, ValueError, LinAlgError: As the solution of a film.
        """
        from scipy.integrate import solve_ivp

        problem, n = self.problem, self.size

        def gap(_t: float, s: Array) -> float:
            return min(float(problem.film_left(s[None, :n])[0]), 1.0)

        gap.terminal = True  # pyright: ignore[reportFunctionMemberAccess]
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            return solve_ivp(
                self.rates, (start, stop), state, method="LSODA", t_eval=times,
                dense_output=times is None, events=gap, rtol=problem.relative_tolerance,
                atol=self.tolerance, jac=None if self.schedule is None else self.jacobian,
            )  # fmt: skip

    def ended(self, found: Any) -> tuple[OrbitStatus, str, *tuple[OrbitEvent, ...]]:
        """Return how a solution ended, with the event where a film did."""
        if found.status == 1:
            end = found.y_events[0][0]
            when = float(found.t_events[0][0])
            return OrbitStatus.TOUCH_DOWN, *_touched(self.problem, when, end[: self.size])
        if found.status < 0:
            return OrbitStatus.INTEGRATION_FAILED, str(found.message)
        return OrbitStatus.COMPLETED, ""

    def __call__(self, q: Array, v: Array, start: float, stop: float, times: Array) -> Answer:
        n = self.size
        ends = times if times.size and times[-1] >= stop else np.append(times, stop)
        try:
            found = self.solved(np.concatenate([q, v]), start, stop, ends)
        except _FILM_ERRORS as error:
            empty = np.zeros((0, n))
            return (empty, empty), OrbitStatus.INTEGRATION_FAILED, str(error), q, v
        y = found.y.T if len(found.t) else np.zeros((0, 2 * n))
        count = min(times.size, len(y))
        status, message, *events = self.ended(found)
        end = y[-1] if len(y) else np.concatenate([q, v])
        if events:
            end = found.y_events[0][0]
        both = y[:count, :n], y[:count, n:]
        return both, status, message, *_halves(end, n), *events


def _driven(problem: MotionProblem, drive: TorqueDrive) -> Iterator[Motion]:
    """Return the pieces of a run whose speed follows from a torque."""
    solver, n = _Scipy(problem, None), problem.system.size
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
            except _FILM_ERRORS as error:
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
