"""A motion in time with a controller of `rotorsim.machine.output_feedback`, continuous or sampled.

A continuous controller's states are the velocities of further unknowns of mass 1, and the held
forces of a sampled one are such velocities that nothing changes but the controller: all integrators
of a machine's motion take them as they take the machine.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.linalg import block_diag

from ..arrays import Array, ComplexArray
from ..machine.control import signal_name
from ..machine.output_feedback import OutputFeedback, unknown_signal
from ..machine.reduction import probing_frequencies, response
from .orbit import OrbitEvent, OrbitStatus
from .system import Limited

if TYPE_CHECKING:
    from .motion import MotionProblem

Answer = tuple[tuple[Array, Array], OrbitStatus, str, Array, Array, *tuple[OrbitEvent, ...]]
Advance = Callable[[Array, Array, float, float, Array], Answer]


@dataclass(frozen=True, eq=False)
class Loop:
    """A controller in a motion: what it measures, and where its forces are.

    rows : (p, 2 n) array. From unknowns and their rates to the sensors; `offset` (p,) is taken off.
    size : Unknowns without those of the controller.
    driven : Displacements of the whole machine, by number, that the actuators push.
    """

    feedback: OutputFeedback
    rows: Array
    offset: Array
    size: int
    driven: tuple[int, ...]

    def measured(self, q: Array, v: Array) -> Array:
        """Return what the sensors read (..., p), from (..., n) displacements and rates."""
        both = np.concatenate([q[..., : self.size], v[..., : self.size]], axis=-1)
        return both @ self.rows.T - self.offset

    def sampler(self) -> Sampler | None:
        """Return what measures and acts at the controller's samples; None: it is continuous."""
        return Sampler(self) if self.feedback.sample_time else None

    def forces(self, q: Array, v: Array) -> Array:
        """Return the actuators' forces (..., m) along a motion [N]."""
        inside = v[..., self.size :]
        if self.feedback.sample_time:
            return inside
        wanted = inside @ self.feedback.c.T + self.measured(q, v) @ self.feedback.d.T
        return np.clip(wanted, -self.feedback.max_force, self.feedback.max_force)


class Signals(NamedTuple):
    """Displacements of the whole machine, by number, that a controller measures and drives.

    rates : Whether it measures the velocity there.
    """

    measured: tuple[int, ...]
    rates: tuple[bool, ...]
    driven: tuple[int, ...]

    @property
    def places(self) -> set[int]:
        """Return the numbers of all of them."""
        return {*self.measured, *self.driven}

    def rows(self, basis: Array) -> Array:
        """Return what leads from unknowns and their rates to the sensors, (p, 2 n)."""
        seen = basis[list(self.measured)]
        still, rates = np.zeros_like(seen), np.array(self.rates)[:, None]
        return np.hstack([np.where(rates, still, seen), np.where(rates, seen, still)])


def signals_of(feedback: OutputFeedback, names: Sequence[tuple[str, str]]) -> Signals:
    """Return where a controller measures and acts.

    names : Node and unknown of each displacement of the whole machine.
    Raises InputError: A signal is not there.
    """
    known = {
        word: {f"{signal_name(node)}{word}_{unknown}": i for i, (node, unknown) in enumerate(names)}
        for word in ("displacement", "velocity", "force")
    }
    measured, rates = [], []
    for name in feedback.sensors:
        word = "velocity" if name in known["velocity"] else "displacement"
        if name not in known[word]:
            raise unknown_signal("sensors", name, [*known["displacement"]])
        measured.append(known[word][name])
        rates.append(word == "velocity")
    for name in feedback.actuators:
        if name not in known["force"]:
            raise unknown_signal("actuators", name, [*known["force"]])
    driven = (known["force"][name] for name in feedback.actuators)
    return Signals(tuple(measured), tuple(rates), tuple(driven))


def closed_eigenvalues(
    feedback: OutputFeedback, matrix: Array, mass: Array, basis: Array,
    names: Sequence[tuple[str, str]],
) -> ComplexArray:  # fmt: skip
    """Return the eigenvalues of a linear machine with a controller [1/s].

    matrix : (2 n, 2 n) array. Of the machine's displacements and rates.
    basis : (k, n) array. From its displacements to those of the whole machine.
    """
    import control

    signals = signals_of(feedback, names)
    acting = np.linalg.solve(mass, basis[list(signals.driven)].T)
    inputs = np.vstack([np.zeros_like(acting), acting])
    rows = signals.rows(basis)
    nothing = np.zeros((len(rows), inputs.shape[1]))
    system: Any = control.ss(matrix, inputs, rows, nothing, inputs=list(feedback.actuators))
    return replace(feedback, sensors=()).eigenvalues(system)


def with_controller(
    problem: MotionProblem,
    feedback: OutputFeedback,
    rest: Array,
    names: Sequence[tuple[str, str]],
) -> MotionProblem:
    """Return the motion with a controller that measures from a rest position.

    rest : (n,) array. Displacements at which the sensors read 0, so that no static load is carried.
    names : Node and unknown of each displacement of the whole machine, which signals are named by.
    Raises InputError: A signal is not there.
    """
    system, n = problem.system, problem.system.size
    dt, signals = feedback.sample_time, signals_of(feedback, names)
    acting = system.basis[list(signals.driven)].T
    rows = signals.rows(system.basis)
    loop = Loop(feedback, rows, rows[:, :n] @ rest, n, signals.driven)
    more = len(feedback.actuators) if dt else len(feedback.a)
    a, b, c, d, w = feedback.a, feedback.b, feedback.c, feedback.d, feedback.w
    wider: dict[str, Any] = {
        name: block_diag(getattr(system, name), part)
        for name, part in (
            ("mass", np.eye(more)),
            ("damping", np.zeros((more, more)) if dt else w @ c - a),
            *((name, np.zeros((more, more)))
              for name in ("gyroscopic", "stiffness", "circulatory")),
        )
    }  # fmt: skip
    scale, constant = np.ones(more), np.zeros(more)
    if dt:
        wider["damping"][:n, n:] = -acting
    else:
        felt = b - w @ d
        wider["stiffness"][n:, :n] = -felt @ loop.rows[:, :n]
        wider["damping"][n:, :n] = -felt @ loop.rows[:, n:]
        constant = -felt @ loop.offset
        seen = d @ loop.rows
        wider["limited"] = Limited(
            np.hstack([seen[:, :n], np.zeros((len(d), more)), seen[:, n:], c]), d @ loop.offset,
            np.vstack([acting, w]), feedback.max_force,
        )  # fmt: skip
        scale = _sizes(feedback, float(system.scale.min()), max(problem.drive.speeds))
    none = np.zeros(more)
    system = replace(
        system, **wider, constant=np.concatenate([system.constant, constant]),
        scale=np.concatenate([system.scale, scale]),
        basis=np.hstack([system.basis, np.zeros((len(system.basis), more))]),
        unbalance=tuple((t, np.concatenate([u, none])) for t, u in system.unbalance),
        turned_offset=None if system.turned_offset is None
        else np.concatenate([system.turned_offset, none]),
        loads=tuple(
            load._replace(amplitude=np.concatenate([load.amplitude, none]))
            for load in system.loads
        ),
    )  # fmt: skip
    start, velocity, equilibrium = (
        np.concatenate([part, none])
        for part in (problem.start, problem.velocity, problem.equilibrium)
    )
    note = "; ".join(filter(None, (problem.note, _words(feedback))))
    return replace(
        problem, system=system, start=start, velocity=velocity, equilibrium=equilibrium, note=note,
        loop=loop,
    )  # fmt: skip


def _sizes(feedback: OutputFeedback, length: float, speed: float) -> Array:
    """Return the displacement of a controller's unknown that counts as large, for tolerances.

    Of a motion of a length at the frequencies of the controller and the shaft.
    """
    if not len(feedback.a):
        return np.zeros(0)
    frequencies = np.append(probing_frequencies(np.linalg.eigvals(feedback.a)), speed)
    frequencies = frequencies[(frequencies > 0.01 * speed) & (frequencies < 10.0 * speed)]
    states = response(feedback.a, feedback.b, np.eye(len(feedback.a)))(frequencies)
    sizes = np.abs(states).sum(axis=2).max(axis=0) * length / speed
    return np.maximum(sizes, 1e-6 * sizes.max(initial=1e-300))


def _words(feedback: OutputFeedback) -> str:
    limit = feedback.max_force
    said = [f"controller of {len(feedback.a)} states"]
    if feedback.sample_time:
        said.append(f"sampled each {feedback.sample_time * 1e6:.4g} µs")
        if feedback.delay:
            said.append(f"delayed by {feedback.delay * 1e6:.4g} µs")
    if math.isfinite(limit):
        said.append(f"limited to {limit:g} N per axis")
    return " ".join(said)


class Sampler:
    """A sampled controller in a run: its states, and the forces that wait to act."""

    def __init__(self, loop: Loop) -> None:
        self.loop: Loop = loop
        self.state: Array = np.zeros(len(loop.feedback.a))
        self.count: int = 0
        self.waiting: deque[tuple[float, Array]] = deque()

    @property
    def due(self) -> float:
        """When it measures or its forces change next [s]."""
        sample = self.count * self.loop.feedback.sample_time
        return min(sample, self.waiting[0][0]) if self.waiting else sample

    def act(self, now: float, q: Array, v: Array) -> Array:
        """Measure and set the forces, whatever is due until now; return the rates with them."""
        feedback, v = self.loop.feedback, v.copy()
        now += self.slack
        while self.due <= now:
            sample = self.count * feedback.sample_time
            if self.waiting and self.waiting[0][0] <= min(sample, now):
                v[self.loop.size :] = self.waiting.popleft()[1]
                continue
            force, self.state = feedback.law(self.state, self.loop.measured(q, v))
            self.waiting.append((sample + feedback.delay, force))
            self.count += 1
        return v

    @property
    def slack(self) -> float:
        """Rounding of times [s]."""
        return 1e-9 * self.loop.feedback.sample_time

    def stopping(self, advance: Advance) -> Advance:
        """Return an integrator that stops where the controller measures and its forces change."""

        def integrate(q: Array, v: Array, t: float, stop: float, times: Array) -> Answer:
            done, found = 0, []
            while True:
                v = self.act(t, q, v)
                end = min(stop, self.due)
                # what lies on a sample by rounding sees the forces after it
                upto = len(times) if end == stop else int(np.searchsorted(times, end - self.slack))
                wanted = np.maximum(times[done:upto], t)
                (qs, vs), status, message, q, v, *events = advance(q, v, t, end, wanted)
                found.append((qs, vs))
                done, t = upto, end
                if status is not OrbitStatus.COMPLETED or end == stop:
                    qs, vs = (np.concatenate(column) for column in zip(*found, strict=True))
                    return (qs, vs), status, message, q, v, *events

        return integrate
