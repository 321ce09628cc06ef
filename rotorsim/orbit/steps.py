"""How a motion goes on from one time to the next: exactly, in compiled code, or by SciPy."""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np

from ..arrays import Array
from .controlled import Answer
from .kernels import shaft
from .march import DONE, TOUCHED, march, repeat
from .motion import MotionProblem, TorqueDrive
from .orbit import OrbitEvent, OrbitStatus
from .problem import SpeedSchedule
from .system import derivatives, force_on

FILM_ERRORS = (ArithmeticError, ValueError, np.linalg.LinAlgError)
"""Of a film that cannot be solved at a step."""


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


class Rosenbrock:
    """Compiled steps; see `rotorsim.orbit.march`."""

    def __init__(self, problem: MotionProblem, schedule: SpeedSchedule) -> None:
        self.problem: MotionProblem = problem
        self.knots: Array = schedule.knots
        self.step: float = 2.0 * np.pi / max(max(schedule.speeds), 1e-9) / 200.0

    def _march(self, q: Array, v: Array, start: float, stop: float, times: Array, step: float):
        problem = self.problem
        return march(
            q, v, float(start), float(stop), np.ascontiguousarray(times), self.knots,
            problem.plain, problem.system.scale, problem.relative_tolerance, step,
        )  # fmt: skip

    def __call__(self, q: Array, v: Array, start: float, stop: float, times: Array) -> Answer:
        """Integrate from `start` to `stop`; see `rotorsim.orbit.controlled.Advance`."""
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


class Exact:
    """Linear machine at one speed: its matrix exponential, loads as oscillators of their own."""

    def __init__(self, problem: MotionProblem, schedule: SpeedSchedule) -> None:
        self.problem: MotionProblem = problem
        self.speed: float = schedule.speeds[0]
        self.period: float = 2.0 * np.pi / self.speed / problem.samples_per_revolution
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
        """Integrate from `start` to `stop`; see `rotorsim.orbit.controlled.Advance`."""
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


class Scipy:
    """SciPy's LSODA, for films that are solved at each step and for shafts that a torque drives."""

    def __init__(self, problem: MotionProblem, schedule: SpeedSchedule | None) -> None:
        self.problem: MotionProblem = problem
        self.schedule: SpeedSchedule | None = schedule
        self.knots: Array = schedule.knots if schedule is not None else np.zeros((0, 4))
        system, n = problem.system, problem.system.size
        self.inverse: Array = np.asarray(np.linalg.inv(system.mass), dtype=float)
        top = max(max(problem.drive.speeds), 1.0)
        least = 1e-2 * problem.relative_tolerance * system.scale
        driven = [] if schedule is not None else [1e-9, 1e-9 * top]  # the shaft's angle and speed
        self.tolerance: Array = np.concatenate([least, top * least, driven])
        self.size: int = n

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
        """Integrate from `start` to `stop`; see `rotorsim.orbit.controlled.Advance`."""
        n = self.size
        ends = times if times.size and times[-1] >= stop else np.append(times, stop)
        try:
            found = self.solved(np.concatenate([q, v]), start, stop, ends)
        except FILM_ERRORS as error:
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
