"""Feedback from sensors to actuators at other nodes: LQR with a Kalman filter, PD, and their loops.

Designed on a reduced machine, judged on the whole one.
"""

from __future__ import annotations

import difflib
import itertools
import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array, ComplexArray
from ..errors import InputError
from ..model.machine import MOST_WAITING
from ..threads import on_one_blas_thread
from .reduction import probing_frequencies, response

if TYPE_CHECKING:
    import control


_MOST_STEPS = 1_000_000
"""Of a run in time of a linear machine."""
_LARGEST = 1.0
"""Displacement at which a run ends [m]."""


@dataclass(frozen=True, eq=False)
class OutputFeedback:
    """z' = A z + B y + W (f - u), u = C z + D y: forces u from sensors y, f after saturation.

    With a sample time the left side is the next z, and forces stay as they are between the samples.

    max_force : Of each actuator's axis [N].
    sample_time : [s]; 0: the controller is continuous.
    delay : From a sample to when its forces act, for computing and amplifiers [s].
    sensors, actuators : Signals' names, ``disc_displacement_x`` or ``disc_velocity_x`` and
        ``disc_force_x``, as `rotorsim.state_space` has them; empty: those of the system, in order.
    Raises InputError: Sizes do not fit, a delay has no sample time.
    """

    a: Array
    b: Array
    c: Array
    d: Array
    w: Array
    max_force: float = np.inf
    sample_time: float = 0.0
    delay: float = 0.0
    sensors: tuple[str, ...] = ()
    actuators: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        (m, p), n = self.d.shape, len(self.a)
        sizes = {"a": (n, n), "b": (n, p), "c": (m, n), "d": (m, p), "w": (n, m)}
        for key, size in sizes.items():
            part = getattr(self, key)
            if part.shape != size or not np.all(np.isfinite(part)):
                raise InputError(
                    f"must be {size[0]} x {size[1]} finite numbers: {m} forces, {p} sensors, "
                    f"{n} states", key=f"controller.{key}", value=part.shape,
                )  # fmt: skip
        if not self.max_force > 0.0:
            raise InputError("must be above 0 (N)", key="max_force", value=self.max_force)
        for key, value in (("sample_time", self.sample_time), ("delay", self.delay)):
            if not 0.0 <= value < np.inf:
                raise InputError("must be 0 or more (s)", key=key, value=value)
        if self.delay and not self.sample_time:
            raise InputError(
                "needs a sample_time; of a continuous controller put control.pade into it",
                key="delay", value=self.delay,
            )  # fmt: skip
        if self.delay > MOST_WAITING * self.sample_time:
            raise InputError(
                f"must be at most {MOST_WAITING} sample times", key="delay", value=self.delay
            )

    @classmethod
    def of(cls, controller: Any, max_force: float = np.inf, delay: float = 0.0) -> OutputFeedback:
        """Return the feedback of a system of python-control, from sensors [m] to forces [N].

        controller : StateSpace or TransferFunction, continuous or with a sample time ``dt``, its
            inputs and outputs named as `sensors` and `actuators`; two of each without names are x
            and y of a rotor's only node. The forces act with their own sign: a controller that
            pushes back has a negative gain.
        Raises InputError: It is no such system, its signals have no names, or it has no sample time
            of its own (``dt=True``).
        """
        import control

        if not isinstance(controller, control.StateSpace | control.TransferFunction):
            raise InputError(
                "must be a StateSpace or TransferFunction of python-control", key="controller",
                value=type(controller).__name__,
            )  # fmt: skip
        if controller.dt is True:
            raise InputError("must be a sample time in seconds", key="controller.dt", value=True)
        names = [list(controller.input_labels), list(controller.output_labels)]
        try:
            system: Any = control.ss(controller)
        except control.ControlMIMONotImplemented:
            raise InputError(
                "has several inputs or outputs as a transfer function: build it of state spaces, "
                "control.append(control.ss(x), control.ss(y))", key="controller",
            ) from None  # fmt: skip
        if names == [["u[0]", "u[1]"], ["y[0]", "y[1]"]]:
            names = [[f"{word}_{axis}" for axis in "xy"] for word in ("displacement", "force")]
        a, b, c, d = (np.asarray(part, dtype=float) for part in (
            system.A, system.B, system.C, system.D))  # fmt: skip
        return cls(
            a, b, c, d, np.zeros((len(a), len(c))), max_force, float(system.dt or 0.0), delay,
            *map(tuple, names),
        )  # fmt: skip

    def sampled(self, sample_time: float, delay: float = 0.0) -> OutputFeedback:
        """Return a continuous feedback as a digital one by the bilinear rule (Tustin's)."""
        from scipy.signal import cont2discrete

        if self.sample_time:
            raise InputError("is sampled already", key="controller", value=self.sample_time)
        if not 0.0 < sample_time < np.inf:
            raise InputError("must be above 0 (s)", key="sample_time", value=sample_time)
        both = np.hstack([self.b, self.w]), np.hstack([self.d, np.zeros((len(self.d),) * 2)])
        parts: Any = self.a, both[0], self.c, both[1]
        if len(self.a):
            parts = cont2discrete(parts, sample_time, "bilinear")
        a, b, c, d = parts[:4]
        p = self.d.shape[1]
        return replace(
            self, a=a, b=b[:, :p], c=c, d=d[:, :p], w=b[:, p:], sample_time=sample_time, delay=delay
        )

    def law(self, z: Array, y: Array) -> tuple[Array, Array]:
        """Return the forces after saturation, and the right side of the states' equation."""
        wanted = self.c @ z + self.d @ y
        force = np.clip(wanted, -self.max_force, self.max_force)
        return force, self.a @ z + self.b @ y + self.w @ (force - wanted)

    def plant(self, system: control.StateSpace) -> tuple[Array, Array, Array]:
        """Return the A, B, C of a system from these actuators to these sensors."""
        a, b, c = (np.asarray(part, dtype=float) for part in (system.A, system.B, system.C))
        if not self.sensors:
            return a, b, c
        rows, outputs, inputs = [], list(system.output_labels), list(system.input_labels)
        for name in self.sensors:
            place = name.replace("velocity_", "displacement_")
            if place not in outputs:
                raise unknown_signal("sensors", name, outputs)
            row = c[outputs.index(place)]
            rows.append(row if place == name else row @ a)
        for name in self.actuators:
            if name not in inputs:
                raise unknown_signal("actuators", name, inputs)
        return a, b[:, [inputs.index(name) for name in self.actuators]], np.array(rows)

    def closed_loop(self, system: control.StateSpace) -> tuple[Array, Array]:
        """Return the state matrix of machine and controller, and what f - u does to its states.

        Raises InputError: The controller is sampled; see `sampled_loop`.
        """
        if self.sample_time:
            raise InputError("is sampled: use sampled_loop or eigenvalues", key="controller")
        a, b, c = self.plant(system)
        matrix = np.block([[a + b @ self.d @ c, b @ self.c], [self.b @ c, self.a]])
        return matrix, np.vstack([b, self.w])

    def sampled_loop(self, system: control.StateSpace) -> Array:
        """Return the matrix from one sample to the next of machine, controller and delayed forces.

        Exact, by the matrix exponential.
        """
        a, b, c = self.plant(system)
        (n, m), size = b.shape, len(self.a)
        waiting, first = self.waiting
        (_, early), (late_a, late) = (
            held(a, b, t) for t in (first, self.sample_time - first)
        )  # fmt: skip
        whole = n + size + m * waiting
        step = np.zeros((whole, whole))
        now = np.hstack([self.d @ c, self.c, np.zeros((m, m * waiting))])
        step[:n, :n] = held(a, b, self.sample_time)[0]
        step[n : n + size, : n + size] = np.hstack([self.b @ c, self.a])
        if not waiting:
            step[:n] += late @ now
            return step
        # the forces before now, the newest first
        past = np.eye(whole)[n + size :]
        queue = np.vstack([now, past])
        step[:n] += late_a @ early @ queue[m * waiting :]
        step[:n] += late @ queue[m * (waiting - 1) : m * waiting]
        step[n + size :] = queue[: m * waiting]
        return step

    @property
    def waiting(self) -> tuple[int, float]:
        """Number of forces that have not acted at a sample, and how long the oldest waits [s]."""
        count = math.ceil(self.delay / self.sample_time - 1e-9)
        return count, max(self.delay - (count - 1) * self.sample_time, 0.0) if count else 0.0

    def eigenvalues(self, system: control.StateSpace) -> ComplexArray:
        """Return the eigenvalues of the closed loop [1/s], least stable first.

        Of a sampled one, log(mu)/sample_time of those from one sample to the next.
        """
        if self.sample_time:
            factors: Any = np.linalg.eigvals(self.sampled_loop(system)).astype(complex)
            values: Any = np.log(factors[np.abs(factors) > 1e-300]) / self.sample_time
        else:
            values = np.linalg.eigvals(self.closed_loop(system)[0]).astype(complex)
        return values[np.argsort(-values.real, kind="stable")]


def held(a: Array, b: Array, time: float) -> tuple[Array, Array]:
    """Return what a state, and forces held over a time [s], become at its end: exp(A t) and so on.

    By one exponential (Van Loan 1978).
    """
    from scipy.linalg import expm

    n, m = b.shape
    both = np.zeros((n + m, n + m))
    both[:n, :n], both[:n, n:] = a, b
    grown: Any = expm(both * time)
    return grown[:n, :n], grown[:n, n:]


def unknown_signal(key: str, name: str, known: list[str]) -> InputError:
    """Return the error for a controller's signal that a machine does not have."""
    near = ", ".join(difflib.get_close_matches(name, known, n=4, cutoff=0.0))
    return InputError(
        f"no such signal; the nearest are {near}", key=f"controller.{key}", value=name
    )


@on_one_blas_thread
def regulator(
    system: control.StateSpace, displacement_scale: float, force_scale: float, noise: float,
    max_force: float = np.inf,
) -> OutputFeedback:  # fmt: skip
    """Return the linear-quadratic regulator with a Kalman filter that knows the sensors only.

    system : Small: forces at the actuators to displacements at the sensors.
    displacement_scale, force_scale : As bad as each other [m], [N].
    noise : Of the sensors, against a disturbance of `force_scale` at the actuators [m].
    max_force : [N]; the filter knows of the saturation.
    Raises InputError: An unstable mode is not reached by the actuators or not seen by the sensors.
    """
    a, b, c = (np.asarray(part, dtype=float) for part in (system.A, system.B, system.C))
    # In units of the scales.
    b, c = b * force_scale, c / displacement_scale
    gain = _riccati(a, b, c.T @ c, np.eye(b.shape[1]), "not reached by these actuators")
    weight = (noise / displacement_scale) ** 2
    filtered = _riccati(
        a.T, c.T, b @ b.T, weight * np.eye(c.shape[0]), "not seen by these sensors"
    ).T
    inside = a - b @ gain - filtered @ c
    return OutputFeedback(
        inside, filtered / displacement_scale, -force_scale * gain,
        np.zeros((b.shape[1], c.shape[0])), b / force_scale, max_force,
        sensors=tuple(system.output_labels), actuators=tuple(system.input_labels),
    )  # fmt: skip


def _riccati(a: Array, b: Array, q: Array, r: Array, word: str) -> Array:
    """Return the gain R^-1 B' X of the stabilising solution."""
    from scipy.linalg import LinAlgError, solve_continuous_are

    try:
        x = solve_continuous_are(a, b, q, r)
        gain = np.asarray(np.linalg.solve(r, b.T @ x), dtype=float)
        stable = np.linalg.eigvals(a - b @ gain).real.max() < 0.0
    except (LinAlgError, ValueError):
        gain, stable = np.zeros(b.T.shape), False
    if not stable:
        raise InputError(f"an unstable mode is {word}", key="control")
    return gain


@on_one_blas_thread
def pd_of_sensors(
    system: control.StateSpace, corner: float, max_force: float = np.inf
) -> OutputFeedback:
    """Return the PD from each sensor to the actuator of the same number, of least growth rate.

    system : Small; as many forces as displacements.
    corner : Where the derivative ends: kp + kd s/(1 + s/corner) [rad/s].

    One pair of gains for x and y of every actuator, of either sign (a sensor beyond a node of the
    mode needs the other one), by trial over decades, then Nelder and Mead's simplex. Modes above
    the corner, which no such gain moves much, count where they lose half of their decay.
    """
    from scipy.optimize import minimize

    count = system.ninputs // 2
    if system.ninputs != system.noutputs:
        raise InputError(
            f"needs as many sensors as actuators, not {system.noutputs // 2} for {count}",
            key="control.sensor",
        )
    gain = np.linalg.svd(
        response(system.A, system.B, system.C)(probing_frequencies(system.poles())),
        compute_uv=False,
    ).max()
    unit = 1.0 / float(gain)

    def made(gains: Array) -> OutputFeedback:
        kp, kd = (np.repeat(part, 2) * unit for part in gains.reshape(2, count))
        rate = kd * corner
        eye = np.eye(2 * count)
        return OutputFeedback(
            -corner * eye, corner * eye, np.diag(rate), -np.diag(kp + rate),
            np.zeros((2 * count, 2 * count)), max_force,
            sensors=tuple(system.output_labels), actuators=tuple(system.input_labels),
        )  # fmt: skip

    own: Any = np.asarray(system.poles())
    least = 0.5 * min(own.real[np.abs(own.imag) > corner].max(initial=-np.inf), 0.0)

    def growth(gains: Array) -> float:
        values = np.linalg.eigvals(made(gains).closed_loop(system)[0])
        left_out = (np.abs(values.imag) > corner) & (values.real < least)
        return float((values.real if left_out.all() else values.real[~left_out]).max())

    size = np.concatenate([[0.0], np.geomspace(1e-3, 1e2, 16)])
    either = np.concatenate([-size[:0:-1], size])
    trials = np.array([(p, d) for p in either for d in either / _slow(system)])
    starts = trials[np.argsort([growth(np.repeat(one, count)) for one in trials])[:3]]
    options: dict[str, Any] = {"maxiter": 400 * count, "xatol": 1e-4, "fatol": 1e-6}
    scale = np.repeat([1.0, 1.0 / _slow(system)], count)
    best = min(
        (
            minimize(lambda g: growth(g * scale), np.repeat(one, count) / scale,
                     method="Nelder-Mead", options=options)
            for one in starts
        ),
        key=lambda found: found.fun,
    )  # fmt: skip
    return made(np.asarray(best.x) * scale)


def _slow(system: control.StateSpace) -> float:
    """Return the frequency of the least stable mode, or of the slowest [rad/s]."""
    poles: Any = np.asarray(system.poles(), dtype=complex)
    frequency = abs(complex(poles[poles.real.argmax()]).imag)
    return frequency or float(np.abs(poles)[np.abs(poles) > 0.0].min())


@on_one_blas_thread
def modulus_margin(system: control.StateSpace, feedback: OutputFeedback) -> float:
    """Return least singular value of 1 + loop at the actuators over frequency.

    Distance to instability.

    Of simultaneous changes of all loops; it says nothing where the closed loop is unstable.
    """
    a, b, c = feedback.plant(system)
    period = feedback.sample_time
    frequencies: Any = probing_frequencies(
        np.concatenate([feedback.eigenvalues(system), np.asarray(system.poles())])
    )
    if period:
        # from the forces to the samples: z of the pulse transfer function in place of s
        frequencies = frequencies[frequencies < np.pi / period]
        waiting, first = feedback.waiting
        late_a, late = held(a, b, period - first)
        early = late_a @ held(a, b, first)[1]
        a = held(a, b, period)[0]
        z = np.exp(1j * frequencies * period)
        frequencies = z / 1j
        plant = response(a, late, c)(frequencies) * z[:, None, None] ** -max(waiting - 1, 0)
        if waiting:
            plant = plant + response(a, early, c)(frequencies) * z[:, None, None] ** -waiting
    else:
        plant = response(a, b, c)(frequencies)
    controller = response(feedback.a, feedback.b, feedback.c, feedback.d)(frequencies)
    loop = np.eye(system.ninputs) - controller @ plant
    return float(np.linalg.svd(loop, compute_uv=False).min())


def controlled_response(
    system: control.StateSpace, feedback: OutputFeedback, frequency: Array
) -> ComplexArray:
    """Return the displacement per force with the loop closed, (n, outputs, inputs) [m/N].

    frequency : (n,) array [rad/s]. Of a sampled feedback below half its sampling frequency, NaN
        beyond: hold and delay count, the aliases that they leave do not.
    """
    a, b, c = feedback.plant(system)
    period, at = feedback.sample_time, np.asarray(frequency, dtype=float)
    law = response(feedback.a, feedback.b, feedback.c, feedback.d)
    acting = law(at)
    if period:
        turn = 1j * at * period
        hold = (1.0 - np.exp(-turn)) / turn * np.exp(-1j * at * feedback.delay)
        known = np.where(at < np.pi / period, hold, np.nan)
        acting = law(np.exp(turn) / 1j) * known[:, None, None]
    plant = response(a, b, c)(at)
    every: Any = np.linalg.solve(np.eye(len(c)) - plant @ acting, plant)
    return every


@dataclass(frozen=True, eq=False)
class LinearMotion:
    """Motion of a machine at its sensors, and its actuators' forces.

    t : (n,) array [s]
    displacement : (n, outputs) array [m]
    force : (n, inputs) array [N]
    size : (n,) array. Largest displacement of any unknown of displacement given by `watched` [m].
    """

    t: Array
    displacement: Array
    force: Array
    size: Array


@on_one_blas_thread
def run_in_time(
    system: control.StateSpace, start: Array, duration: float, step: float,
    feedback: OutputFeedback | None = None, watched: Array | None = None,
) -> LinearMotion:  # fmt: skip
    """Integrate the whole machine, with its feedback or without, from a state.

    start : (n,) array
    duration, step : [s]; of a sampled feedback the steps are parts of its sample time.
    watched : (m, n) array. Further displacements from the state, for `LinearMotion.size`; by
        default the outputs.

    The run ends where it has grown to a metre: a linear one grows for ever, and shows no more.
    By the matrix exponential: exact with a sampled feedback, and as long as no actuator saturates;
    what saturation takes away is held over a step.

    Raises InputError: The run takes more steps or samples than there is patience for.
    """
    least = step if feedback is None else min(step, feedback.sample_time or step)
    if duration > _MOST_STEPS * least:
        raise InputError(
            f"takes {duration / least:.2g} steps of {least:.2g} s, at most {_MOST_STEPS} are "
            "taken: fewer revolutions, or a longer sample time", key="duration",
        )  # fmt: skip
    a, c = np.asarray(system.A, dtype=float), np.asarray(system.C, dtype=float)
    seen = c if watched is None else watched
    rows: list[tuple[float, Array, Array, float]] = []

    def shown(t: float, x: Array, force: Array) -> bool:
        """Keep a moment; say whether to go on."""
        size = float(np.abs(seen @ x).max())
        rows.append((t, c @ x, force, size))
        return np.isfinite(size) and size <= _LARGEST and t < duration

    if feedback is None:
        forward, none = held(a, np.zeros((len(a), 0)), step)[0], np.zeros(system.ninputs)
        x = start
        while shown(len(rows) * step, x, none):
            x = forward @ x
    elif feedback.sample_time:
        _run_sampled(feedback, system, start, step, shown)
    else:
        matrix, push = feedback.closed_loop(system)
        forward, pushed = held(matrix, push, step)
        outputs, n = feedback.plant(system)[2], len(a)
        state = np.concatenate([start, np.zeros(len(feedback.a))])
        while True:
            wanted = feedback.d @ (outputs @ state[:n]) + feedback.c @ state[n:]
            acting = np.clip(wanted, -feedback.max_force, feedback.max_force)
            if not shown(len(rows) * step, state[:n], acting):
                break
            state = forward @ state
            if not np.array_equal(acting, wanted):
                state = state + pushed @ (acting - wanted)
    t, displacement, force, size = (np.array(column) for column in zip(*rows, strict=True))
    return LinearMotion(t, displacement, force, size)


def _run_sampled(
    feedback: OutputFeedback, system: control.StateSpace, x: Array, step: float,
    shown: Callable[[float, Array, Array], bool],
) -> None:  # fmt: skip
    """Run through the parts of each sample time in which the forces stay as they are."""
    a, b, c = feedback.plant(system)
    waiting, first = feedback.waiting
    queue = deque([np.zeros(b.shape[1])] * (waiting - 1))
    parts = []
    for length in (first, feedback.sample_time - first):
        count = math.ceil(length / step - 1e-9)
        parts.append((length, count, *held(a, b, length / max(count, 1))))
    z, force = np.zeros(len(feedback.a)), np.zeros(b.shape[1])
    for k in itertools.count():
        acting, z = feedback.law(z, c @ x)
        queue.append(acting)
        since = k * feedback.sample_time
        for number, (length, count, forward, pushed) in enumerate(parts):
            if number:
                force = queue.popleft()
            for i in range(count):
                if not shown(since + i * length / count, x, force):
                    return
                x = forward @ x + pushed @ force
            since += length
