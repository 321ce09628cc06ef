"""Undamped critical speed map: support stiffness against synchronous critical speeds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, ComplexArray
from ..errors import InputError
from ..rotor import Rotor
from .machine import Machine

_FORWARD = {"x": 1.0, "y": -1j, "theta_x": 1j, "theta_y": 1.0}
"""Unknowns of a forward circular motion r: y = -i x; theta_x = -dy/dz = i r', theta_y = r'."""


@dataclass(frozen=True, eq=False)
class CriticalSpeedMap:
    """Forward synchronous critical speeds of an undamped rotor on identical isotropic springs.

    stiffness : (n,) array. Of each support [N/m].
    speed : (n, k) array. Ascending [rad/s]; NaN where a disc's gyroscopic moment leaves fewer.
    """

    stiffness: Array
    speed: Array


def critical_speed_map(
    rotor: Rotor, nodes: Sequence[int], stiffness: ArrayLike, count: int = 4
) -> CriticalSpeedMap:
    """Return the forward synchronous critical speeds over the stiffness of all supports.

    rotor : Its damping and circulatory matrix are left out.
    nodes : Where a spring stands.
    stiffness : (n,) array. Of each spring, above 0 [N/m].
    count : Number of critical speeds.
    Raises InputError: A stiffness is not above 0, a node has unknowns other than displacements and
        rotations, or the springs do not hold the rotor.

    A forward circle r exp(i Omega t) meets (K + k - Omega^2 (M - P)) r = 0 with P = i G on it, a
    Hermitian problem in 1/Omega^2 with one solution for each positive eigenvalue.
    """
    from scipy.linalg import LinAlgError, eigh

    values = np.atleast_1d(np.asarray(stiffness, dtype=float))
    if not (np.all(np.isfinite(values)) and np.all(values > 0.0)):
        raise InputError("must be above 0 (N/m)", key="stiffness", value=stiffness)
    forward = _forward_motions(rotor)
    inertia = _condensed(forward, rotor.mass - 1j * rotor.gyroscopic)
    own = _condensed(forward, rotor.stiffness.astype(complex))
    springs = np.zeros((rotor.size, rotor.size), dtype=complex)
    for node in nodes:
        x, y = rotor.planes[node]
        springs[x, x] = springs[y, y] = 1.0
    springs = _condensed(forward, springs)
    speed = np.full((values.size, count), np.nan)
    for i, one in enumerate(values):
        try:
            squares = eigh(inertia, own + one * springs, eigvals_only=True)[::-1][:count]
        except LinAlgError:
            raise InputError("the springs do not hold the rotor", key="support") from None
        squares = squares[squares > 0.0]
        speed[i, : squares.size] = squares**-0.5
    return CriticalSpeedMap(values, speed)


def _forward_motions(rotor: Rotor) -> ComplexArray:
    """Return the motions (size, n) of all unknowns when the rotor whirls forward in circles."""
    columns: dict[tuple[int, bool], int] = {}
    entries = []
    for i, node in enumerate(rotor.nodes):
        for j, name in enumerate(node.unknowns):
            if name not in _FORWARD:
                raise InputError("is not known to a critical speed map", key="rotor", value=name)
            column = columns.setdefault((i, name.startswith("theta")), len(columns))
            entries.append((int(rotor.first_unknown[i]) + j, column, _FORWARD[name]))
    motions = np.zeros((rotor.size, len(columns)), dtype=complex)
    for row, column, value in entries:
        motions[row, column] = value
    return motions


def _condensed(motions: ComplexArray, matrix: ArrayLike) -> ComplexArray:
    projected = motions.conj().T @ np.asarray(matrix) @ motions
    return 0.5 * (projected + projected.conj().T)


def principal_stiffness(machine: Machine, speeds: ArrayLike) -> dict[str, Array]:
    """Return principal synchronous stiffnesses (n, 2) [N/m] of each load-carrying support, by name.

    speeds : (n,) array [rad/s]

    Eigenvalues of the symmetric part of Re Z(i Omega), after the support's own unknowns (pads,
    housing) are condensed; ascending.
    """
    omegas = np.atleast_1d(np.asarray(speeds, dtype=float))
    found = {}
    for mount in machine.mounts:
        support = mount.support
        if not support.carries_load:
            continue
        values = np.full((omegas.size, 2), np.nan)
        for i, omega in enumerate(omegas):
            z = support.dynamic_stiffness(1j * omega, float(omega))
            if not np.isfinite(z).all():
                continue
            n = support.coupled
            if z.shape[0] > n:
                z = z[:n, :n] - z[:n, n:] @ np.linalg.solve(z[n:, n:], z[n:, :n])
            axes = [support.unknowns.index(name) for name in ("x", "y")]
            real = z.real[np.ix_(axes, axes)]
            values[i] = np.linalg.eigvalsh(0.5 * (real + real.T))
        found[mount.name] = values
    return found
