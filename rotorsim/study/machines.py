"""Questions to a machine file, answered directly: modes, unbalance response, state space.

Each takes a `Machine` as well. A machine file's bearings are solved over its speeds when first
asked, once for each file that was loaded.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import refuse_no_machine
from ..arrays import Array
from ..errors import InputError
from ..files.machine import MachineFile
from ..machine import control as rotor_control
from ..machine import modes as of_machine
from ..machine import response as to_unbalance
from ..machine.branches import Modes
from ..machine.machine import Machine
from ..machine.response import UnbalanceResponse
from .machine import MachineResult
from .machine_analysis import analyse_machine

if TYPE_CHECKING:
    import control

    from ..bearing.interpolation import Coefficients


@lru_cache(maxsize=8)
def machine_results(machine: MachineFile) -> dict[str, MachineResult]:
    """Return results of a machine file by thermal model, solved once."""
    return analyse_machine(machine)


def assembled(machine: MachineFile | Machine, thermal_model: str | None = None) -> Machine:
    """Return the machine with its films solved over the file's speeds.

    machine : MachineFile or Machine. A `Machine` is returned as it is.
    thermal_model : ``isothermal`` or ``thd``; by default the last one that the bearings' files
        name.
    Raises InputError: No bearing has that thermal model, or `machine` is neither of the two.
    """
    if isinstance(machine, Machine):
        return machine
    refuse_no_machine(machine)
    results = machine_results(machine)
    name = next(reversed(results)) if thermal_model is None else thermal_model
    if name not in results:
        raise InputError(
            f"must be one of {', '.join(results)}", key="thermal_model", value=thermal_model
        )
    return results[name].machine


def modes(
    machine: MachineFile | Machine,
    speed: ArrayLike | None = None,
    *,
    thermal_model: str | None = None,
) -> Modes:
    """Return modes of a machine at one speed, or over speed as continuous branches.

    Parameters
    ----------
    machine : MachineFile or Machine
    speed : float or (n,) array, optional
        Ascending [rad/s], within the file's speeds where it has films or tables; by default all.
    thermal_model : str, optional
        See `assembled`.
    """
    whole = assembled(machine, thermal_model)
    if speed is None and isinstance(machine, MachineFile) and not whole.speeds.size:
        speed = machine.operating.speeds
    return of_machine.modes(whole, speed)


def unbalance_response(
    machine: MachineFile | Machine,
    speed: ArrayLike | None = None,
    *,
    thermal_model: str | None = None,
) -> UnbalanceResponse:
    """Return the steady response of a machine to its unbalance; parameters as for `modes`."""
    whole = assembled(machine, thermal_model)
    if speed is None and isinstance(machine, MachineFile) and not whole.speeds.size:
        speed = machine.operating.speeds
    return to_unbalance.unbalance_response(whole, speed)


@overload
def state_space(
    plant: MachineFile | Machine | Coefficients, mass: float | None = None,
    speed: float | None = None, name: str = "rotor", *, disturbances: Sequence[str] = (),
    thermal_model: str | None = None,
) -> control.StateSpace: ...  # fmt: skip
@overload
def state_space(
    plant: MachineFile | Machine, mass: None = None, *, speed: Sequence[float] | Array,
    name: str = "rotor", disturbances: Sequence[str] = (), thermal_model: str | None = None,
) -> list[control.StateSpace]: ...  # fmt: skip
def state_space(
    plant: MachineFile | Machine | Coefficients,
    mass: float | None = None,
    speed: float | Sequence[float] | Array | None = None,
    name: str = "rotor",
    *,
    disturbances: Sequence[str] = (),
    thermal_model: str | None = None,
) -> control.StateSpace | list[control.StateSpace]:
    """Return the state space of a machine at one speed, or of a rigid rotor on one bearing's film.

    Parameters
    ----------
    plant : MachineFile, Machine or Coefficients
    speed : float or (n,) array, optional
        [rad/s], with a machine. Of several speeds: a list of systems of the same states, inputs and
        outputs, between which may be interpolated.
    mass, name, disturbances
        See `rotorsim.machine.control.state_space`.
    thermal_model : str, optional
        Of a machine file's bearings; see `assembled`.
    """
    whole = assembled(plant, thermal_model) if isinstance(plant, MachineFile) else plant
    if isinstance(speed, np.ndarray | list | tuple) and np.ndim(speed) == 1:
        if not isinstance(whole, Machine) or not len(speed):
            raise InputError("must be one or more speeds, of a machine", key="speed", value=speed)
        return [rotor_control.state_space(whole, mass, w, name, disturbances) for w in speed]
    at: Any = speed  # what is no number is refused there
    return rotor_control.state_space(whole, mass, at, name, disturbances)
