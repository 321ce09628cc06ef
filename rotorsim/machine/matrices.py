"""State matrices as plain arrays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, Booleans, Indices
from ..errors import InputError

_NOT_HELD = 1e14
"""Condition number of the stiffness from which an unknown counts as free."""
_SINGULAR = 1e12
"""Condition number from which the damping of massless unknowns counts as singular."""


def state_matrix(stiffness: ArrayLike, damping: ArrayLike, mass: ArrayLike) -> Array:
    """Return the state matrices of the rigid rotor m x'' + C x' + K x = 0 (Dal Eq. 21).

    stiffness, damping : (..., 2, 2) arrays [N/m], [N s/m]
    mass : Per bearing [kg], broadcast against the leading dimensions.
    Returns (..., 4, 4) array: Acting on (x, y, vx, vy).
    Raises InputError: A mass is not above zero.
    """
    k = np.asarray(stiffness, dtype=float)
    c = np.asarray(damping, dtype=float)
    m = np.asarray(mass, dtype=float)
    if not np.all(m > 0.0):
        raise InputError("must be above 0 (kg)", key="mass", value=mass)
    lead = np.broadcast_shapes(k.shape[:-2], c.shape[:-2], m.shape)
    a = np.zeros((*lead, 4, 4))
    a[..., 0, 2] = a[..., 1, 3] = 1.0
    a[..., 2:, :2] = -k / m[..., None, None]
    a[..., 2:, 2:] = -c / m[..., None, None]
    return a


def base_force(mass: Array, rotor_mass: Array, unknowns: Sequence[tuple[str, str]]) -> Array:
    """Return the forces (n, 2) of unit accelerations of the base along x and y [N/(m/s2)].

    mass : (n, n) array. Of everything, the rotor's unknowns first. What films and seals add to the
        rotor's own mass moves with it against the base, which does not drive it.
    unknowns : Node and name of each.
    """
    own, size = mass.copy(), len(rotor_mass)
    own[:size] = 0.0
    own[:size, :size] = rotor_mass
    moved = [
        [float(name.endswith(axis) and not name.startswith("theta")) for axis in "xy"]
        for _, name in unknowns
    ]
    return -own @ np.array(moved)


def massive_unknowns(mass: Array) -> Indices:
    """Return the indices of the unknowns with inertia, of (..., n, n) mass matrices."""
    return np.flatnonzero(np.any(mass != 0.0, axis=-1).reshape(-1, mass.shape[-1]).any(axis=0))


def static_following(stiffness: Array, idle: Booleans) -> Array:
    """Return the motion of all unknowns for unit motions of those that are not `idle`, (n, n - i).

    The idle ones have neither mass nor damping.
    Raises InputError: Nothing holds an idle unknown.
    """
    follow = np.eye(idle.size)[:, ~idle]
    if idle.any():
        own = stiffness[idle][:, idle]
        if np.linalg.cond(own) > _NOT_HELD:
            raise InputError(
                "singular: a node without mass, damping and stiffness is not held; give it a mass",
                key="stiffness",
            )
        follow[idle] = -np.linalg.solve(own, stiffness[idle][:, ~idle])
    return follow


def first_order(mass: ArrayLike, damping: ArrayLike, stiffness: ArrayLike) -> tuple[Array, Array]:
    """Return the state matrix and input matrix of M q'' + D q' + K q = f.

    mass, damping, stiffness : (..., n, n) arrays. Unknowns without mass, whose rows of M are zero,
        must be damped.
    Returns state_matrix : (..., n + m, n + m) array. Acting on all n displacements, then the
        velocities of the m unknowns with mass.
    Returns input_matrix : (..., n + m, n) array. For forces on each unknown.
    Raises InputError: The damping of the massless unknowns is singular: their motion is not
        determined.

    The rows b of massless unknowns read q_b' = D_bb^-1 (f_b - K_b q - D_ba v): states of first
    order. Where a matrix is not finite the result is not either.
    """
    m, d, k = np.broadcast_arrays(*(np.asarray(p, dtype=float) for p in (mass, damping, stiffness)))
    n = m.shape[-1]
    heavy = massive_unknowns(m)
    light = np.setdiff1d(np.arange(n), heavy)
    size = n + heavy.size
    a, b = np.zeros((*m.shape[:-2], size, size)), np.zeros((*m.shape[:-2], size, n))
    a[..., heavy, n + np.arange(heavy.size)] = 1.0
    known = np.asarray(np.isfinite(m + d + k).all(axis=(-2, -1)))
    # The damping's action on the massless unknowns' velocities, given by the other states.
    pull, push = np.concatenate([k, d[..., heavy]], axis=-1), np.broadcast_to(np.eye(n), k.shape)
    if light.size:
        own = np.where(known[..., None, None], d[..., light[:, None], light], np.eye(light.size))
        if np.any(np.linalg.cond(own) > _SINGULAR):
            raise InputError(
                "singular: massless nodes need damping in every direction; give a mass "
                "(journal_mass)", key="damping",
            )  # fmt: skip
        rate = np.linalg.solve(own, -pull[..., light, :])
        gain = np.linalg.solve(
            own, np.broadcast_to(np.eye(n)[light], (*own.shape[:-2], light.size, n))
        )
        a[..., light, :], b[..., light, :] = rate, gain
        pull = pull + d[..., light] @ rate
        push = push - d[..., light] @ gain
    inertia = m[..., heavy[:, None], heavy]
    inertia = np.where(known[..., None, None], inertia, np.eye(heavy.size))
    a[..., n:, :] = -np.linalg.solve(inertia, pull[..., heavy, :])
    b[..., n:, :] = np.linalg.solve(inertia, push[..., heavy, :])
    a[~known], b[~known] = np.nan, np.nan
    return a, b
