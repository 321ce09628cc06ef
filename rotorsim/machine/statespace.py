"""Rotors on bearings as python-control state spaces with named signals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import control
import numpy as np

from ..arguments import check_number
from ..errors import InputError
from .jeffcott import jeffcott_matrices
from .matrices import state_matrix

if TYPE_CHECKING:
    from ..bearing.interpolation import Coefficients
    from .rotor import GeneralRotor


def state_space(coefficients: Coefficients, mass: float, name: str = "rotor") -> control.StateSpace:
    """Rigid rotor m x'' + C x' + K x = F on one bearing's film (Dal Eq. 21).

    Parameters
    ----------
    coefficients : Coefficients
    mass : float
        Per bearing [kg].
    name : str

    Returns
    -------
    control.StateSpace
        States ``x``, ``y`` [m], ``vx``, ``vy`` [m/s]; inputs ``force_x``, ``force_y`` [N] on the
        journal; outputs ``displacement_x``, ``displacement_y`` [m]. Load frame, about equilibrium.

    Raises
    ------
    InputError
        The mass is no number, or not above zero.
    """
    check_number(mass, "mass", "kg")
    _positive(mass, "mass")
    a = state_matrix(coefficients.stiffness, coefficients.damping, mass)
    b = np.zeros((4, 2))
    b[2:] = np.eye(2) / mass
    return control.StateSpace(
        a, b, np.eye(2, 4), np.zeros((2, 2)),
        states=["x", "y", "vx", "vy"],
        inputs=["force_x", "force_y"],
        outputs=["displacement_x", "displacement_y"],
        name=name,
    )  # fmt: skip


def jeffcott_state_space(
    coefficients: Coefficients,
    disc_mass: float,
    shaft_stiffness: float,
    journal_mass: float = 0.0,
    shaft_damping: float = 0.0,
    name: str = "jeffcott",
) -> control.StateSpace:
    """Symmetric flexible rotor: a disc at mid-span of a massless shaft on two like bearings.

    Parameters
    ----------
    coefficients : Coefficients
        Of one bearing.
    disc_mass, shaft_stiffness, journal_mass, shaft_damping : float
        Per bearing: half the disc [kg] and half the shaft's stiffness at mid-span [N/m]; the
        journal's own mass [kg] may be zero; external damping at the disc [N s/m].
    name : str

    Returns
    -------
    control.StateSpace
        States ``disc_x``, ``disc_y``, ``journal_x``, ``journal_y`` [m], ``disc_vx``, ``disc_vy``
        [m/s] and, with a journal mass, ``journal_vx``, ``journal_vy``; inputs ``disc_force_x`` ...
        ``journal_force_y`` [N]; outputs ``disc_displacement_x`` ... ``journal_displacement_y`` [m].

    Raises
    ------
    InputError
        A mass or stiffness is not above zero, or the damping matrix is singular with massless
        journals (their motion is then not determined).
    """
    a, b = jeffcott_matrices(
        coefficients.stiffness, coefficients.damping, disc_mass, shaft_stiffness, journal_mass,
        shaft_damping,
    )  # fmt: skip
    states = ["disc_x", "disc_y", "journal_x", "journal_y"]
    states += ["disc_vx", "disc_vy", "journal_vx", "journal_vy"][: a.shape[0] - 4]
    return control.StateSpace(
        a, b, np.eye(4, a.shape[0]), np.zeros((4, 4)),
        states=states,
        inputs=[f"{part}_force_{axis}" for part in ("disc", "journal") for axis in "xy"],
        outputs=[f"{part}_displacement_{axis}" for part in ("disc", "journal") for axis in "xy"],
        name=name,
    )  # fmt: skip


def rotor_state_space(
    rotor: GeneralRotor, coefficients: Coefficients, name: str = "rotor"
) -> control.StateSpace:
    """General rotor on like bearings at its bearing nodes; gyroscopic terms at the film's speed.

    States ``q0`` ... [m or rad] and ``v0`` ...; inputs ``force_0`` ...; outputs
    ``displacement_0`` ..., numbered like the rotor's degrees of freedom.
    """
    a = rotor.state_matrix(coefficients)
    n = rotor.mass.shape[0]
    b = np.vstack([np.zeros((n, n)), np.linalg.inv(rotor.mass)])
    return control.StateSpace(
        a, b, np.eye(n, 2 * n), np.zeros((n, n)),
        states=[f"{letter}{i}" for letter in "qv" for i in range(n)],
        inputs=[f"force_{i}" for i in range(n)],
        outputs=[f"displacement_{i}" for i in range(n)],
        name=name,
    )  # fmt: skip


@dataclass(frozen=True)
class Pole:
    """One eigenvalue in an engineer's terms.

    Attributes
    ----------
    value : complex
        [rad/s]
    damped_frequency : float
        [rad/s]
    damping_ratio : float
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


def _positive(value: float, key: str) -> None:
    if not (np.isfinite(value) and value > 0.0):
        raise InputError("must be above 0", key=key, value=value)
