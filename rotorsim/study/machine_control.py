"""Actuators on a machine: designed on a reduced model, tried in time on the whole machine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array, ComplexArray
from ..errors import InputError
from ..files.machine import MachineFile
from ..files.parameters import place_named
from ..machine.control import state_space
from ..machine.machine import Machine
from ..machine.matrices import massive_unknowns
from ..machine.modes import modes
from ..machine.output_feedback import (
    LinearMotion,
    OutputFeedback,
    modulus_margin,
    pd_of_sensors,
    regulator,
    run_in_time,
)
from ..machine.peaks import node_at
from ..machine.reduction import Reduction, reduced
from ..machine.spectrum import all_eigenmodes
from ..model.machine import MachineControl
from ..model.orbit import Design

if TYPE_CHECKING:
    import control

_STEPS = 256
"""Of a revolution in time, at least."""
_LEAST_ERROR = 1e-8
"""Of a reduction, relative: until here it is refined where the whole machine is not held."""
_CORNER = 10.0
"""Frequency at which a PD's derivative ends, as a multiple of the shaft's speed."""


@dataclass(frozen=True, eq=False)
class MachineControlStudy:
    """Feedback of a machine's actuators and what it does (SI).

    speed, disturbance : [rad/s], [m]
    actuators, sensors : Places [m].
    system : The whole machine: forces at the actuators to displacements at the sensors, x and y of
        each.
    passive_eigenvalues, controlled_eigenvalues : complex arrays. Of the whole machine [1/s], least
        stable first; undamped ones without real part.
    unsampled_growth_rate : Of the machine with the design that the controller samples, were it
        continuous [1/s]; None where it is.
    margin : See `modulus_margin`.
    passive, controlled : Of the whole machine, from the shape of its least stable mode; None
        without a run.
    """

    speed: float
    disturbance: float
    design: Design
    actuators: tuple[float, ...]
    sensors: tuple[float, ...]
    system: control.StateSpace
    reduction: Reduction
    feedback: OutputFeedback
    passive_eigenvalues: ComplexArray
    controlled_eigenvalues: ComplexArray
    unsampled_growth_rate: float | None
    margin: float
    passive: LinearMotion | None
    controlled: LinearMotion | None

    @property
    def largest_force(self) -> float | None:
        """Largest force of one axis of an actuator in the run [N]."""
        return None if self.controlled is None else float(np.abs(self.controlled.force).max())

    @property
    def saturates(self) -> bool:
        """Return whether an actuator reached its limit in the run."""
        force = self.largest_force
        return force is not None and force >= (1.0 - 1e-9) * self.feedback.max_force

    @property
    def holds(self) -> bool:
        """Return whether the machine is stable and its run ends nearer to rest than it began."""
        stable = complex(self.controlled_eigenvalues[0]).real < 0.0
        if self.controlled is None or not stable:
            return stable
        late = self.controlled.size[3 * self.controlled.size.size // 4 :]
        return bool(np.isfinite(late).all() and late.max() < 0.5 * self.disturbance)


def study_machine_control(
    description: MachineFile,
    machine: Machine,
    settings: MachineControl,
    *,
    disturbance: float = 1e-6,
    revolutions: int = 60,
) -> MachineControlStudy:
    """Design a machine's feedback at one speed, and try it on the whole linear machine.

    machine : Its films solved, see `rotorsim.study.machines.assembled`.
    disturbance : Largest displacement at the start of the run in time [m].
    revolutions : Of that run; 0: none.

    Where a design on the reduced machine does not hold the whole one, whose other modes it drives,
    the reduction's error is lowered by tens.

    Raises InputError: A place is off the shaft, an unstable mode is out of reach, or nothing says
        which force is large.
    """
    places = {
        word: tuple(
            place_named(description, text, f"control.{word}[{i}]")
            for i, text in enumerate(getattr(settings, word))
        )
        for word in ("actuator", "sensor")
    }
    actuators, sensors = places["actuator"], places["sensor"] or places["actuator"]
    if not actuators:
        raise InputError('is missing: actuator = ["250 mm"]', key="control.actuator")
    speed = settings.speed or max(description.operating.speeds)
    inputs, outputs = (_unknowns(machine, one) for one in (actuators, sensors))
    if len(set(inputs)) < len(inputs):
        raise InputError("two actuators stand at one place", key="control.actuator")
    every = state_space(machine, speed=speed)
    system = every[outputs, inputs]
    share = settings.reduction_error
    while True:
        reduction = reduced(system, share)
        design = _designed(reduction.system, settings, speed)
        feedback = _sampled(design, settings)
        controlled = feedback.eigenvalues(system)
        growth = float(controlled[0].real)
        left_out = reduction.system.nstates < system.nstates
        if growth < 0.0 or not left_out or share < _LEAST_ERROR:
            break
        # What the reduced model leaves out is excited by the feedback: leave out less.
        share /= 10.0
    passive, unsampled = _least_stable_first(np.asarray(system.A)), None
    if feedback.sample_time:
        unsampled = float(design.eigenvalues(system)[0].real)
    else:
        controlled = _least_stable_first(feedback.closed_loop(system)[0])
    runs: list[LinearMotion | None] = [None, None]
    if revolutions:
        start = _start(machine, speed, disturbance)
        top = max(_STEPS * speed, 8.0 * _highest(reduction.system)) / (2.0 * math.pi)
        duration = revolutions * 2.0 * math.pi / speed
        watched = np.asarray(every.C, dtype=float)[_displacements(machine)]
        runs = [
            run_in_time(system, start, duration, 1.0 / top, one, watched)
            for one in (None, feedback)
        ]
    return MachineControlStudy(
        speed, disturbance, settings.design, actuators, sensors, system, reduction, feedback,
        passive, controlled, unsampled, modulus_margin(system, feedback), *runs,
    )  # fmt: skip


def designed_feedback(machine: MachineFile, speed: float) -> OutputFeedback:
    """Return the feedback of a file's ``[control]``.

    speed : Where it is designed, unless the table says [rad/s].
    Raises InputError: As `study_machine_control`; the table is missing, a film did not converge.
    """
    from .machines import assembled

    if machine.control is None:
        raise InputError('is missing: actuator = ["250 mm"], for orbit.control', key="control")
    settings = replace(machine.control, speed=machine.control.speed or speed)
    whole = machine.with_parts(operating=replace(machine.operating, speed=(settings.speed,)))
    return study_machine_control(whole, assembled(whole), settings, revolutions=0).feedback


def _designed(small: Any, settings: MachineControl, speed: float) -> OutputFeedback:
    """Return the continuous feedback of the reduced machine."""
    limit = settings.max_force
    if settings.design is Design.PD:
        return pd_of_sensors(small, _CORNER * speed, limit)
    large = settings.large_force()
    return regulator(small, settings.displacement_scale, large, settings.noise, limit)


def _sampled(design: OutputFeedback, settings: MachineControl) -> OutputFeedback:
    """Return a feedback sampled where the settings say so."""
    if settings.sample_time is None:
        return design
    return design.sampled(settings.sample_time, settings.delay)


def _unknowns(machine: Machine, places: Sequence[float]) -> list[int]:
    """Return numbers of the unknowns x and y at places."""
    rotor = machine.rotor
    return [k for at in places for k in rotor.planes[node_at(rotor, at)]]


def _displacements(machine: Machine) -> list[int]:
    return [k for pair in machine.rotor.planes for k in pair]


def _highest(system: Any) -> float:
    poles: Any = np.asarray(system.poles())
    return float(np.abs(poles.imag).max(initial=0.0))


def _start(machine: Machine, speed: float, disturbance: float) -> Array:
    """Return the state on the least stable mode's shape, its largest displacement `disturbance`."""
    found = modes(machine, speed)
    k = int(found.least_stable[0])
    value, shape = complex(found.eigenvalues[0, k]), found.shapes[0, k]
    planes = np.array(_displacements(machine))
    largest = shape[planes[np.abs(shape[planes]).argmax()]]
    shape = disturbance * shape / largest
    heavy = massive_unknowns(machine.matrices(speed)[0])
    return np.concatenate([shape.real, (value * shape).real[heavy]])


def _least_stable_first(matrix: Array) -> ComplexArray:
    """Return eigenvalues; a real part below its own accuracy is 0."""
    found = all_eigenmodes(matrix, matrix.shape[0] // 2)
    undamped = np.abs(found.values.real) <= found.accuracy
    values: Any = np.where(undamped, 1j * found.values.imag, found.values)
    return values[np.argsort(-values.real, kind="stable")]
