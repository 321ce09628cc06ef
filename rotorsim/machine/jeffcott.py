"""Matrices of the symmetric flexible rotor: disc, massless shaft, two like bearings."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from .matrices import second_order_state_matrix

Array = NDArray[np.float64]


def jeffcott_matrices(
    stiffness: ArrayLike,
    damping: ArrayLike,
    disc_mass: float,
    shaft_stiffness: float,
    journal_mass: float = 0.0,
    shaft_damping: float = 0.0,
) -> tuple[Array, Array]:
    """State matrix and input matrix of one half of the rotor.

    Parameters
    ----------
    stiffness, damping : (2, 2) arrays
        Of one bearing [N/m], [N s/m].
    disc_mass, shaft_stiffness, journal_mass, shaft_damping : float
        Per bearing: half the disc [kg] and half the shaft's stiffness at mid-span [N/m]; the
        journal's own mass [kg] may be zero; external damping at the disc [N s/m].

    Returns
    -------
    state_matrix : (8, 8) array, or (6, 6) with massless journals
        On disc x, y, journal x, y [m], disc vx, vy and, with a journal mass, journal vx, vy [m/s].
    input_matrix : (8, 4) or (6, 4) array
        For forces on the disc and on the journal [N].

    Raises
    ------
    InputError
        A mass or stiffness is not above zero, or the damping matrix is singular with massless
        journals (their motion is then not determined).
    """
    for key, value in (("disc_mass", disc_mass), ("shaft_stiffness", shaft_stiffness)):
        if not (np.isfinite(value) and value > 0.0):
            raise InputError("must be above 0", key=key, value=value)
    for key, value in (("journal_mass", journal_mass), ("shaft_damping", shaft_damping)):
        if not (np.isfinite(value) and value >= 0.0):
            raise InputError("must be 0 or more", key=key, value=value)
    eye, zero = np.eye(2), np.zeros((2, 2))
    ks = shaft_stiffness * eye
    c = np.asarray(damping, dtype=float)
    springs = np.block([[ks, -ks], [-ks, ks + np.asarray(stiffness, dtype=float)]])
    if journal_mass > 0.0:
        masses = np.diag([disc_mass, disc_mass, journal_mass, journal_mass])
        dampers = np.block([[shaft_damping * eye, zero], [zero, c]])
        a = second_order_state_matrix(masses, dampers, springs)
        return a, np.vstack([np.zeros((4, 4)), np.linalg.inv(masses)])
    return _massless_journals(c, springs, disc_mass, shaft_damping)


def _massless_journals(
    damping: Array, springs: Array, disc_mass: float, shaft_damping: float
) -> tuple[Array, Array]:
    """Six states: the film alone, C q' = F - K q + k_s (disc - q), moves the journal."""
    if np.linalg.cond(damping) > 1e12:
        raise InputError(
            "singular: massless journals need damping in every direction; give a journal_mass",
            key="damping",
            value=damping.tolist(),
        )
    a, b = np.zeros((6, 6)), np.zeros((6, 4))
    a[:2, 4:] = np.eye(2)
    a[2:4, :4] = -np.linalg.solve(damping, springs[2:])
    a[4:, :4] = -springs[:2] / disc_mass
    a[4:, 4:] = -shaft_damping / disc_mass * np.eye(2)
    b[2:4, 2:] = np.linalg.inv(damping)
    b[4:, :2] = np.eye(2) / disc_mass
    return a, b
