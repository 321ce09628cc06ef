"""Steady response of a machine to its unbalance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, ComplexArray
from ..errors import InputError
from ..threads import on_one_blas_thread
from .machine import Machine

_AT_ONCE = 64
"""Speeds whose matrices are held at once; bounds the memory."""


@dataclass(frozen=True, eq=False)
class UnbalanceResponse:
    """Synchronous motion q = Re(Q exp(i Omega t)) over speed.

    speed : (n,) array [rad/s]
    amplitude : (n, size) complex array. Q of every unknown of the machine [m, rad]; NaN where a
        support has no coefficients.
    """

    machine: Machine
    speed: Array
    amplitude: ComplexArray

    def at(self, node: int | str) -> ComplexArray:
        """Return the complex amplitudes (n, 2) of a node's x and y [m]."""
        first = int(self.machine.rotor.first_unknown[self.machine.rotor.node(node)])
        return self.amplitude[:, first : first + 2]

    def probe(self, node: int | str, angle: float) -> ComplexArray:
        """Return complex amplitude (n,) [m] along a direction `angle` [rad] from x towards y."""
        return self.at(node) @ np.array([np.cos(angle), np.sin(angle)])

    def major_axis(self, node: int | str) -> Array:
        """Return the half the major axis (n,) of a node's elliptical orbit [m]."""
        x, y = self.at(node).T
        return 0.5 * (np.abs(x + 1j * y) + np.abs(np.conj(x) + 1j * np.conj(y)))


@on_one_blas_thread
def unbalance_response(machine: Machine, speed: ArrayLike | None = None) -> UnbalanceResponse:
    """Return the steady response to the rotor's unbalance.

    Parameters
    ----------
    machine : Machine
    speed : (n,) array, optional
        [rad/s]; by default the supports' tabulated speeds.

    Raises
    ------
    InputError
        The rotor has no unbalance.

    Notes
    -----
    (K + i Omega D - Omega^2 M) Q = F with F = u Omega^2 (1, -i): the force turns from x to y.
    """
    if not np.any(machine.rotor.unbalance):
        raise InputError("is missing: the rotor has none", key="rotor.unbalance")
    omega = machine.speeds if speed is None else np.atleast_1d(np.asarray(speed, dtype=float))
    force = np.zeros((omega.size, machine.size), dtype=complex)
    force[:, : machine.rotor.size] = machine.rotor.unbalance_force(omega)
    amplitude = np.full((omega.size, machine.size), np.nan, dtype=complex)
    for start in range(0, omega.size, _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        amplitude[part] = forced_response(machine, omega[part], force[part])
    return UnbalanceResponse(machine, omega, amplitude)


def forced_response(machine: Machine, omega: Array, force: ComplexArray) -> ComplexArray:
    """Return the amplitudes (n, size) at speeds (n,) [rad/s] under synchronous forces (n, size).

    NaN where a support has no coefficients.
    """
    form = machine.band_form
    found = np.full(force.shape, np.nan, dtype=complex)
    if machine.frequency_dependent or not form.narrow:
        z = np.array([machine.dynamic_stiffness(1j * one, float(one)) for one in omega])
        known = np.isfinite(z).all(axis=(-2, -1))
        found[known] = np.linalg.solve(z[known], force[known][..., None])[..., 0]
        return found
    w = omega[:, None, None]
    mass, damping, stiffness = machine.banded(omega)
    z = stiffness - w**2 * mass + 1j * w * damping
    for i in np.flatnonzero(np.isfinite(z).all(axis=(-2, -1))):
        found[i] = form.solve(z[i], force[i])
    return found
