"""Machines as python-control state spaces with named signals."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import control
import numpy as np

from ..arguments import finite_number
from ..errors import InputError
from ..rotor import Rotor
from .machine import Machine
from .matrices import first_order, massive_unknowns
from .support import ConstantSupport

if TYPE_CHECKING:
    from ..bearing.interpolation import Coefficients


def state_space(
    plant: Machine | Coefficients,
    mass: float | None = None,
    speed: float | None = None,
    name: str = "rotor",
) -> control.StateSpace:
    """State space of a machine at one speed, or of a rigid rotor on one bearing's film.

    Parameters
    ----------
    plant : Machine or Coefficients
    mass : float, optional
        Of the rigid rotor per bearing [kg], with `Coefficients` (Dal Eq. 21).
    speed : float, optional
        [rad/s], with a `Machine`.
    name : str

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
        The mass or the speed is missing or no number, or massless nodes are not damped.
    """
    if not isinstance(plant, Machine):
        finite_number(mass, "mass", "kg")
        film = ConstantSupport(plant.stiffness, plant.damping)
        plant, speed = Machine(Rotor.rigid(float(mass or 0.0)), [(0, film)]), plant.speed
    finite_number(speed, "speed", "rad/s")
    matrices = plant.matrices(float(speed or 0.0))
    if not np.all(np.isfinite(matrices[2])):
        raise InputError("a support has no coefficients here", key="speed", value=speed)
    a, b = first_order(*matrices)
    n, heavy = plant.rotor.size, massive_unknowns(matrices[0])
    signals = [(_signal_name(node), unknown) for node, unknown in plant.unknowns]

    def called(word: str, which: range | list[int]) -> list[str]:
        return ["".join((signals[i][0], word, signals[i][1])) for i in which]

    every = range(plant.size)
    return control.StateSpace(
        a, b[:, :n], np.eye(n, a.shape[0]), np.zeros((n, n)),
        states=[*called("", every), *called("v", [int(i) for i in heavy])],
        inputs=called("force_", range(n)),
        outputs=called("displacement_", range(n)),
        name=name,
    )  # fmt: skip


def _signal_name(node: str) -> str:
    """Prefix of a node's signals, of letters, digits and underscores."""
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
    """Poles, least stable first."""
    values = sorted(np.asarray(system.poles(), dtype=complex), key=lambda s: -s.real)
    return [
        Pole(complex(s), abs(s.imag), float(-s.real / abs(s)) if s != 0.0 else 0.0) for s in values
    ]
