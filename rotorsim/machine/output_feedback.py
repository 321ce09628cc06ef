"""Feedback from sensors to actuators at other nodes: LQR with a Kalman filter, PD, and their loops.

Designed on a reduced machine, judged on the whole one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..errors import InputError
from ..threads import on_one_blas_thread
from .reduction import probing_frequencies, response

if TYPE_CHECKING:
    import control


@dataclass(frozen=True, eq=False)
class OutputFeedback:
    """z' = A z + B y + W (f - u), u = C z + D y: forces u from sensors y, f after saturation.

    max_force : Of each actuator's axis [N].
    """

    a: Array
    b: Array
    c: Array
    d: Array
    w: Array
    max_force: float = np.inf

    def closed_loop(self, system: control.StateSpace) -> tuple[Array, Array]:
        """Return the state matrix of machine and controller, and what f - u does to its states."""
        a, b, c = (np.asarray(part, dtype=float) for part in (system.A, system.B, system.C))
        matrix = np.block([[a + b @ self.d @ c, b @ self.c], [self.b @ c, self.a]])
        return matrix, np.vstack([b, self.w])


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
    mode needs the other one), by trial over decades, then Nelder and Mead's simplex.
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
        )  # fmt: skip

    def growth(gains: Array) -> float:
        matrix, _ = made(gains).closed_loop(system)
        return float(np.linalg.eigvals(matrix).real.max())

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
    matrix, _ = feedback.closed_loop(system)
    frequencies = probing_frequencies(
        np.concatenate([np.linalg.eigvals(matrix), np.asarray(system.poles())])
    )
    plant = response(system.A, system.B, system.C)(frequencies)
    controller = response(feedback.a, feedback.b, feedback.c, feedback.d)(frequencies)
    loop = np.eye(system.ninputs) - controller @ plant
    return float(np.linalg.svd(loop, compute_uv=False).min())


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
    duration, step : [s]
    watched : (m, n) array. Further displacements from the state, for `LinearMotion.size`; by
        default the outputs.

    By the matrix exponential: exact as long as no actuator saturates; what saturation takes away is
    held over a step.
    """
    from scipy.linalg import expm

    a = np.asarray(system.A, dtype=float)
    matrix, push = (a, np.zeros((a.shape[0], 0))) if feedback is None else (
        feedback.closed_loop(system)
    )  # fmt: skip
    n, m = matrix.shape[0], push.shape[1]
    both = np.zeros((n + m, n + m))
    both[:n, :n], both[:n, n:] = matrix, push
    grown = expm(both * step)
    forward, held = grown[:n, :n], grown[:n, n:]
    count = int(np.ceil(duration / step))
    output = np.hstack([np.asarray(system.C, dtype=float), np.zeros((system.noutputs, n - len(a)))])
    if feedback is None:
        law = np.zeros((system.ninputs, n))
    else:
        law = np.hstack([feedback.d @ np.asarray(system.C, dtype=float), feedback.c])
    seen = output if watched is None else np.hstack([watched, np.zeros((len(watched), n - len(a)))])
    limit = np.inf if feedback is None else feedback.max_force
    state = np.concatenate([start, np.zeros(n - start.size)])
    displacement, force, size = [], [], []
    for _ in range(count + 1):
        wanted = law @ state
        acting = np.clip(wanted, -limit, limit)
        displacement.append(output @ state)
        force.append(acting)
        size.append(np.abs(seen @ state).max())
        if not np.isfinite(size[-1]) or size[-1] > 1e30:
            break
        state = forward @ state
        if m and not np.array_equal(acting, wanted):
            state = state + held @ (acting - wanted)
    t = step * np.arange(len(size), dtype=float)
    return LinearMotion(t, np.array(displacement), np.array(force), np.array(size))
