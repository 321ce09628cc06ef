"""Stiffness and damping: the discrete film linearised at its solution (Dal Eq. 6-7, corrected).

Every face's conductance goes with h^3 and its drag with h, so a displacement changes them by known
amounts; the perturbed pressures solve the very matrix of the film, on its full cells, with its
factor. The rupture boundary adds nothing to first order, since the pressure and its gradient
vanish there. K and C are therefore the exact derivatives of the discrete force.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .cavitation import PressureSolution
from .operator import FilmOperator

Array = NDArray[np.float64]


def film_force(operator: FilmOperator, pressure: Array, multiplicity: float) -> Array:
    """Force of the film on the journal [N], (2,): F = -int p n dA."""
    load = pressure * operator.area
    return -multiplicity * np.array(
        [np.sum(load * operator.cos[0]), np.sum(load * operator.sin[0])]
    )


def linearize(
    operator: FilmOperator,
    solution: PressureSolution,
    multiplicity: float,
) -> tuple[Array, Array]:
    """Stiffness [N/m] and damping [N s/m], (2, 2) each, in the film's frame, viscosity frozen."""
    # Where the film is ruptured only the oil in it is squeezed.
    squeezed = operator.area if solution.liquid is None else solution.liquid * operator.area
    right = np.stack(
        [
            displacement_source(operator, solution.raw, -operator.cos),
            displacement_source(operator, solution.raw, -operator.sin),
            operator.cos[0] * squeezed,
            operator.sin[0] * squeezed,
        ]
    )
    perturbed = solution.factor.solve(np.where(operator.held, 0.0, right))
    perturbed = np.where(solution.full, perturbed, 0.0) * operator.area
    normals = np.stack(
        [operator.cos[0] + 0.0 * operator.area, operator.sin[0] + 0.0 * operator.area]
    )
    # dF_i/dx_j = -int p_j n_i dA, and K = -dF/dx
    matrices = multiplicity * np.einsum("inm,jnm->ij", normals, perturbed)
    return matrices[:, :2].copy(), matrices[:, 2:].copy()


def displacement_source(operator: FilmOperator, pressure: Array, thickness_change: Array) -> Array:
    """What a change of thickness adds to each cell's continuity [m3/s per m].

    Parameters
    ----------
    thickness_change : (3, n, 1) array
        dh per unit displacement at centres, west faces and east faces.
    """
    change = np.stack(
        [
            np.broadcast_to(thickness_change[which], pressure.shape)
            for which in (1, 2, 0, 0)  # west, east, south, north
        ]
    )
    relative = change / operator.face_thickness
    difference = neighbour_pressure(operator, pressure) - pressure
    source = np.sum(3.0 * relative * operator.conductance * difference, axis=0)
    return source + relative[0] * operator.drag[0] - relative[1] * operator.drag[1]


def neighbour_pressure(operator: FilmOperator, pressure: Array) -> Array:
    """Pressure behind each face [Pa], (4, n, m)."""
    south, north = np.zeros_like(pressure), np.zeros_like(pressure)
    south[:, 1:], north[:, :-1] = pressure[:, :-1], pressure[:, 1:]
    inner = np.stack([np.roll(pressure, 1, axis=0), np.roll(pressure, -1, axis=0), south, north])
    return np.where(operator.linked, inner, operator.outer_pressure)
