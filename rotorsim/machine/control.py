"""Response and control of a rotor on its film: receptance, margins, LQR and PD, the actuator."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import finite_number, refuse_other
from ..arrays import Array, ComplexArray
from ..bearing.interpolation import Coefficients
from ..errors import InputError
from ..rotor import Rotor
from .machine import Machine
from .matrices import base_force, first_order, massive_unknowns, state_matrix
from .support import ConstantSupport

if TYPE_CHECKING:
    import control


_NO_GAIN = 1e9
"""Factors of a loop gain above this are no factors any more."""
_MOST_STATES = 12
"""Margins come from polynomials, whose coefficients overflow beyond."""


def receptance(system: control.StateSpace, frequency: ArrayLike) -> ComplexArray:
    """Return the displacement per force, shape (n_output, n_input, n_frequency) [m/N].

    system : From `state_space` and its like.
    frequency : (n,) array [rad/s]
    """
    omega = np.atleast_1d(np.asarray(frequency, dtype=float))
    response = np.asarray(system(1j * omega, squeeze=False))
    return response.astype(complex)


def _step_response(
    system: control.StateSpace, force: float, entry: int = 0, duration: float | None = None
) -> tuple[Array, Array]:
    """Return times [s], displacements (n_output, n) [m] after a force [N] sets in at one input."""
    import control

    response = control.step_response(system, T=duration, input=entry, squeeze=False)
    return np.asarray(response.time), force * np.asarray(response.outputs)[:, 0, :]


@dataclass(frozen=True, eq=False)
class StateFeedback:
    """Actuator force from the rotor's state, F = -gain state, limited per axis.

    gain : (m, n) array [N/m] for the displacements, [N s/m] for the velocities. For a rigid rotor
        (2, 4), on x, y, vx, vy; what acts in time (`ActuatedForce`) is of this kind.
    max_force : Saturation of each axis [N].
    """

    gain: Array
    max_force: float = np.inf

    def __post_init__(self) -> None:
        gain = np.array(self.gain, dtype=float)
        if gain.ndim != 2 or not 0 < gain.shape[0] < gain.shape[1] or not np.all(np.isfinite(gain)):
            raise InputError(
                "must be a matrix of finite numbers, forces by states (2 x 4 for a rigid rotor)",
                key="gain", value=gain,
            )  # fmt: skip
        if not self.max_force > 0.0:
            raise InputError("must be above 0 (N)", key="max_force", value=self.max_force)
        object.__setattr__(self, "gain", gain)

    def __call__(self, state: ArrayLike) -> Array:
        """Return the force [N] (..., m) at state (..., n), about the operating point."""
        force = -np.asarray(state, dtype=float) @ self.gain.T
        return np.clip(force, -self.max_force, self.max_force)

    def closed_loop(self, system: control.StateSpace) -> control.StateSpace:
        """Return the rotor with the unsaturated loop closed, same signals."""
        import control

        _check_sizes(system, self.gain)
        return control.StateSpace(
            system.A - system.B @ self.gain, system.B, system.C, system.D,
            states=system.state_labels,
            inputs=system.input_labels,
            outputs=system.output_labels,
            name=f"{system.name}_closed",
        )  # fmt: skip


def design_lqr(
    system: control.StateSpace,
    displacement_scale: float,
    force_scale: float,
    velocity_scale: float = np.inf,
    max_force: float = np.inf,
) -> StateFeedback:
    """Return the linear-quadratic regulator weighted by what counts as large (Bryson's rule).

    system : Its inputs are the actuator's forces, its outputs the displacements to be kept small:
        the rigid rotor of `state_space`, or some nodes of another rotor, for example
        ``state_space(machine, speed=...)[outputs, inputs]`` with the signals' names.
    displacement_scale, velocity_scale, force_scale : Acceptable displacement [m], velocity [m/s]
        and force [N].
    max_force : Saturation [N].
    Returns: On all states of `system`: of a rotor with many, an observer has to give them.
    Raises InputError: A scale is not above zero, every degree of freedom has an actuator, or no
        such regulator exists (these forces do not reach an unstable mode, or these outputs do not
        show it).
    """
    import control

    for key, value in (
        ("displacement_scale", displacement_scale),
        ("velocity_scale", velocity_scale),
        ("force_scale", force_scale),
    ):
        if not value > 0.0:
            raise InputError("must be above 0", key=key, value=value)
    if (system.nstates, system.ninputs) != (4, 2):
        return _design_lqr_of_outputs(
            system, displacement_scale, force_scale, velocity_scale, max_force
        )
    # In units of the scales, so that the Riccati equation is well conditioned.
    a, b = np.asarray(system.A), np.asarray(system.B)
    time = np.sqrt(np.abs(a[2:, :2]).max())
    to_scaled = np.diag([1.0, 1.0, 1.0 / time, 1.0 / time]) / displacement_scale
    from_scaled = np.linalg.inv(to_scaled)
    velocity = (displacement_scale * time / velocity_scale) ** 2
    gain, _, _ = control.lqr(
        to_scaled @ a @ from_scaled / time,
        to_scaled @ b * force_scale / time,
        np.diag([1.0, 1.0, velocity, velocity]),
        np.eye(2),
    )
    return StateFeedback(force_scale * np.asarray(gain) @ to_scaled, max_force)


def _design_lqr_of_outputs(
    system: control.StateSpace, displacement: float, force: float, velocity: float, limit: float
) -> StateFeedback:
    """Return the regulator of any rotor, weighted by its outputs and their rates."""
    import control

    a, b, c = (np.asarray(part) for part in (system.A, system.B, system.C))
    if 2 * system.ninputs >= system.nstates or not system.noutputs:
        raise InputError(
            f"has {system.ninputs} inputs and {system.nstates} states: pick the actuator's node, "
            'for example system[["disc_displacement_x", "disc_displacement_y"], ["disc_force_x", '
            '"disc_force_y"]]',
            key="system",
        )
    weight = c.T @ c / displacement**2
    if np.isfinite(velocity):
        if np.any(c @ b != 0.0):
            raise InputError(
                "needs outputs that a force does not move at once (no massless journals)",
                key="velocity_scale", value=velocity,
            )  # fmt: skip
        weight = weight + (c @ a).T @ (c @ a) / velocity**2
    try:
        gain, _, poles = control.lqr(a, b, weight, np.eye(system.ninputs) / force**2)
    except (np.linalg.LinAlgError, control.ControlArgument) as error:
        raise InputError(f"has no such regulator ({error})", key="system") from error
    if not np.all(np.real(poles) < 0.0):
        raise InputError("has no such regulator: an unstable mode is out of reach", key="system")
    return StateFeedback(np.asarray(gain), limit)


def _check_sizes(system: control.StateSpace, gain: Array) -> None:
    """Refuse a feedback that was made for another system."""
    wanted = (system.ninputs, system.nstates)
    if gain.shape != wanted:
        raise InputError(
            f"must have the system's size, forces by states {wanted}", key="gain", value=gain.shape
        )


def proportional_derivative(
    stiffness: float, damping: float, max_force: float = np.inf
) -> StateFeedback:
    """Return the decentralised PD: added stiffness [N/m] and damping [N s/m] on both axes."""
    return StateFeedback(np.hstack([stiffness * np.eye(2), damping * np.eye(2)]), max_force)


def design_pd(
    coefficients: Coefficients,
    mass: float,
    growth_rate: float,
    stiffness: float = 0.0,
    max_force: float = np.inf,
) -> StateFeedback:
    """Return the least derivative gain that brings every mode to `growth_rate` or less.

    mass : [kg]
    growth_rate : Wanted largest real part, zero or negative [1/s].
    stiffness : Proportional gain [N/m].
    max_force : [N]
    Raises InputError: No derivative gain reaches it: more damping makes the slow modes slower
        still.
    """
    if not growth_rate <= 0.0:
        raise InputError("must be 0 or below (1/s)", key="growth_rate", value=growth_rate)
    k = coefficients.stiffness + stiffness * np.eye(2)

    def rate(added: float) -> float:
        a = state_matrix(k, coefficients.damping + added * np.eye(2), mass)
        return float(np.linalg.eigvals(a).real.max())

    if rate(0.0) <= growth_rate:
        return proportional_derivative(stiffness, 0.0, max_force)
    unit = np.sqrt(mass * np.abs(k).max())
    trials = unit * np.geomspace(1e-6, 1e3, 400)
    good = np.flatnonzero([rate(d) <= growth_rate for d in trials])
    if not good.size:
        best = min(rate(d) for d in trials)
        raise InputError(
            f"no derivative gain reaches it; the best largest real part is {best:.4g} 1/s, "
            "a proportional gain may help",
            key="growth_rate",
            value=growth_rate,
        )
    high = float(trials[good[0]])
    low = float(trials[good[0] - 1]) if good[0] else 0.0
    while high - low > 1e-12 * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if rate(middle) <= growth_rate else (middle, high)
    return proportional_derivative(stiffness, high, max_force)


@dataclass(frozen=True)
class LoopMargins:
    """Margins of one axis' loop, the other axis' loop closed.

    gain_increase, gain_reduction : Factors (above 1 and below 1) by which the loop gain may change
        before it becomes unstable; infinity and 0 where it never does.
    phase_margin : Least phase change that makes it unstable [rad]; infinity without a gain
        crossover.
    modulus_margin : Least distance of the open loop's Nyquist curve from -1.
    stable : Of the closed loop; margins of an unstable loop say how far it is from being stable.
    """

    gain_increase: float
    gain_reduction: float
    phase_margin: float
    modulus_margin: float
    stable: bool


def loop_margins(system: control.StateSpace, feedback: StateFeedback, axis: int) -> LoopMargins:
    """Return the gain, phase and modulus margins of the loop at one input, `axis` (0: x, 1: y)."""
    import control

    _check_sizes(system, feedback.gain)
    if axis not in range(system.ninputs):
        known = "0 (x) or 1 (y)" if system.ninputs == 2 else f"from 0 to {system.ninputs - 1}"
        raise InputError(f"must be {known}", key="axis", value=axis)
    if system.nstates > _MOST_STATES:
        raise InputError(
            f"has {system.nstates} states, margins are found for at most {_MOST_STATES}: reduce it "
            "(rotorsim.machine.reduction.reduced), or look at the closed loop's poles",
            key="system",
        )
    other = np.array(feedback.gain)
    other[axis] = 0.0
    loop = control.StateSpace(
        system.A - system.B @ other,
        np.asarray(system.B)[:, [axis]],
        feedback.gain[[axis]],
        np.zeros((1, 1)),
    )
    gains, phases, distances, *_ = control.stability_margins(loop, returnall=True)
    gains = np.atleast_1d(np.asarray(gains, dtype=float))
    phases = np.atleast_1d(np.asarray(phases, dtype=float))
    distances = np.atleast_1d(np.asarray(distances, dtype=float))
    # A crossing at an infinite gain comes out as a very large one.
    above = gains[(gains > 1.0) & (gains < _NO_GAIN)]
    below = gains[(gains > 1.0 / _NO_GAIN) & (gains < 1.0)]
    closed = system.A - system.B @ feedback.gain
    return LoopMargins(
        gain_increase=float(above.min()) if above.size else np.inf,
        gain_reduction=float(below.max()) if below.size else 0.0,
        phase_margin=float(np.deg2rad(np.abs(phases).min())) if phases.size else np.inf,
        modulus_margin=float(distances.min()) if distances.size else 1.0,
        stable=bool(np.linalg.eigvals(closed).real.max() < 0.0),
    )


class _FilmForce(Protocol):
    """A film's force at any position and velocity, as `rotorsim.orbit` has them."""

    @property
    def radial_clearance(self) -> float:
        """Radial clearance [m]."""
        ...

    @property
    def name(self) -> str:
        """Name of the force model."""
        ...

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Return the force (fx, fy) [N] at x, y [m], vx, vy [m/s] and shaft speed [rad/s]."""
        ...


@dataclass(frozen=True, eq=False)
class ActuatedForce:
    """Film and collocated actuator: a force that `rotorsim.orbit.simulate` takes like a film's.

    film : Nonlinear film (or linear coefficients).
    feedback : Saturated at its ``max_force`` per axis.
    reference : (float, float). Position [m] about which the actuator acts: the equilibrium of the
        film alone, so that the actuator carries no static load.
    Raises InputError: The feedback is not one of the journal's state.
    """

    film: _FilmForce
    feedback: StateFeedback
    reference: tuple[float, float]

    def __post_init__(self) -> None:
        if self.feedback.gain.shape != (2, 4):
            raise InputError(
                "must be of the journal alone, 2 forces by x, y, vx, vy",
                key="feedback.gain", value=self.feedback.gain.shape,
            )  # fmt: skip

    @property
    def radial_clearance(self) -> float:
        """Radial clearance [m]."""
        return self.film.radial_clearance

    @property
    def name(self) -> str:
        """Name of the force model."""
        return f"{self.film.name} with actuator"

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Return the sum of both forces [N]."""
        fx, fy = self.film.force(x, y, vx, vy, speed)
        ax, ay = self.actuator_force(x, y, vx, vy)
        return fx + float(ax), fy + float(ay)

    def actuator_force(self, x: ArrayLike, y: ArrayLike, vx: ArrayLike, vy: ArrayLike) -> Array:
        """Return the force of the actuator alone (..., 2) [N], along an orbit for example."""
        x0, y0 = self.reference
        state = np.stack([np.subtract(x, x0), np.subtract(y, y0), vx, vy], axis=-1)
        return self.feedback(state)


def state_space(
    plant: Machine | Coefficients,
    mass: float | None = None,
    speed: float | None = None,
    name: str = "rotor",
    disturbances: Sequence[str] = (),
) -> control.StateSpace:
    """Return the state space of a machine at one speed, or of a rigid rotor on one bearing's film.

    Parameters
    ----------
    plant : Machine or Coefficients
    mass : float, optional
        Of the rigid rotor per bearing [kg], with `Coefficients` (Dal Eq. 21).
    speed : float, optional
        [rad/s], with a `Machine`.
    name : str
    disturbances : sequence of str
        Further inputs, behind the forces. ``unbalance``: ``unbalance_cos`` and ``unbalance_sin``,
        which are cos(Omega t) and sin(Omega t) of the speed when the rotor turns with its own
        unbalance [-]. ``base``: ``base_acceleration_x`` and ``base_acceleration_y`` of the
        foundation [m/s2]; the displacements are then relative to it.

    Returns
    -------
    control.StateSpace
        About equilibrium. States: displacements, then velocities of all unknowns with mass; inputs
        and outputs: force and displacement of every unknown of the rotor. The rigid rotor's are
        called ``x``, ``y``, ``vx``, ``vy``; ``force_x``, ``force_y``; ``displacement_x``,
        ``displacement_y``. Those of named nodes carry the name: ``disc_x``, ``disc_vx``,
        ``disc_force_x``, ``disc_displacement_x``.

    Raises
    ------
    InputError
        The plant is none of these, the mass or the speed is missing or no number, massless nodes
        are not damped, there is no such disturbance, or the rotor has no unbalance.
    """
    import control

    if not isinstance(plant, Machine):
        refuse_other(plant, Coefficients, "plant", "a MachineFile, a Machine or Coefficients")
        finite_number(mass, "mass", "kg")
        film = ConstantSupport(plant.stiffness, plant.damping)
        plant, speed = Machine(Rotor.rigid(float(mass or 0.0)), [(0, film)]), plant.speed
    finite_number(speed, "speed", "rad/s")
    matrices = plant.matrices(float(speed or 0.0))
    if not np.all(np.isfinite(matrices[2])):
        raise InputError("a support has no coefficients here", key="speed", value=speed)
    a, b = first_order(*matrices)
    n, heavy = plant.rotor.size, massive_unknowns(matrices[0])
    signals = [(signal_name(node), unknown) for node, unknown in plant.unknowns]

    def called(word: str, which: range | list[int]) -> list[str]:
        return ["".join((signals[i][0], word, signals[i][1])) for i in which]

    every = range(plant.size)
    driven, more = [np.eye(plant.size)[:, :n]], []
    for one in disturbances:
        if one not in _DISTURBANCES:
            raise InputError(
                f"must be of {', '.join(_DISTURBANCES)}", key="disturbances", value=one
            )
        driven.append(_disturbance(plant, one, float(speed or 0.0), matrices[0]))
        more += _DISTURBANCES[one]
    inputs = b @ np.hstack(driven)
    return control.StateSpace(
        a, inputs, np.eye(n, a.shape[0]), np.zeros((n, inputs.shape[1])),
        states=[*called("", every), *called("v", [int(i) for i in heavy])],
        inputs=[*called("force_", range(n)), *more],
        outputs=called("displacement_", range(n)),
        name=name,
    )  # fmt: skip


_DISTURBANCES = {
    "unbalance": ("unbalance_cos", "unbalance_sin"),
    "base": ("base_acceleration_x", "base_acceleration_y"),
}


def _disturbance(plant: Machine, kind: str, speed: float, mass: Array) -> Array:
    """Return the forces on all unknowns of both inputs of a disturbance, (n, 2)."""
    if kind == "unbalance":
        own = plant.rotor.unbalance_force(speed)
        if not own.any():
            raise InputError("the rotor has none", key="disturbances", value=kind)
        force = np.zeros((plant.size, 2))
        force[: plant.rotor.size] = np.column_stack([np.real(own), -np.imag(own)])
        return force
    return base_force(mass, plant.rotor.mass, plant.unknowns)


def signal_name(node: str) -> str:
    """Return the beginning of a node's signals, of letters, digits and underscores."""
    return re.sub(r"\W+", "_", node) + "_" if node else ""


@dataclass(frozen=True)
class Pole:
    """One eigenvalue in an engineer's terms.

    value : [rad/s]
    damped_frequency : [rad/s]
    """

    value: complex
    damped_frequency: float
    damping_ratio: float


def poles(system: control.StateSpace) -> list[Pole]:
    """Return the poles, least stable first."""
    values = sorted(np.asarray(system.poles(), dtype=complex), key=lambda s: -s.real)
    return [
        Pole(complex(s), abs(s.imag), float(-s.real / abs(s)) if s != 0.0 else 0.0) for s in values
    ]
