"""Stiffness and damping: the discrete film linearised at its solution (Dal Eq. 6-7, corrected).

Every face's conductance goes with h^3 and its Couette flow with h, so a displacement changes them
by known amounts; the perturbed pressures solve the very matrix of the film, on its full cells, with
its factor. The rupture boundary adds nothing to first order, since the pressure and its gradient
vanish there. K and C are therefore the exact derivatives of the discrete force.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .cavitation import PressureSolution
from .kernels import kernel
from .operator import FilmOperator, neighbour

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
    velocities = np.stack([operator.cos[0] * squeezed, operator.sin[0] * squeezed])
    right = np.concatenate([displacement_sources(operator, solution.raw), velocities])
    right[:, operator.fixed] = 0.0
    matrices = _reaction(operator, solution, multiplicity, right)
    return matrices[:, :2].copy(), matrices[:, 2:].copy()


def stiffness_matrix(
    operator: FilmOperator, solution: PressureSolution, multiplicity: float
) -> Array:
    """Stiffness alone [N/m], (2, 2): the Jacobian of the force with its sign turned."""
    right = displacement_sources(operator, solution.raw)
    return _reaction(operator, solution, multiplicity, right)


def _reaction(
    operator: FilmOperator, solution: PressureSolution, multiplicity: float, right: Array
) -> Array:
    """-dF_i/dq_j = int p_j n_i dA for each right-hand side j, (2, sources)."""
    perturbed = solution.factor.solve(right)
    perturbed = np.where(solution.full, perturbed, 0.0) * operator.area
    around = perturbed.sum(axis=2)
    normals = np.stack([operator.cos[0, :, 0], operator.sin[0, :, 0]])
    return multiplicity * normals @ around.T


def displacement_sources(operator: FilmOperator, pressure: Array) -> Array:
    """What unit displacements along x and y add to each cell's continuity [m3/s per m], (2, n, m).

    Displaced along x the film changes by -cos(theta), along y by -sin(theta).
    """
    sources = np.zeros((2, *pressure.shape))
    _sources(
        operator.conductance, operator.interior, operator.fixed_pressure, operator.face_thickness,
        operator.couette, operator.fixed, operator.cos[:, :, 0], operator.sin[:, :, 0], pressure,
        sources,
    )  # fmt: skip
    return sources


@kernel
def _sources(
    conductance, interior, fixed_pressure, face_h, couette, fixed, cos, sin, pressure, sources
):
    n, m = pressure.shape
    for i in range(n):
        for j in range(m):
            if fixed[i, j]:
                continue
            for face in range(4):
                k, q = neighbour(face, i, j, n, m)
                station = face + 1 if face < 2 else 0
                beyond = pressure[k, q] if interior[face, i, j] else fixed_pressure[face, i, j]
                # conductance goes with h^3, Couette flow with h
                rate = 3.0 * conductance[face, i, j] * (beyond - pressure[i, j])
                if face == 0:
                    rate += couette[0, i, j]
                elif face == 1:
                    rate -= couette[1, i, j]
                rate /= face_h[face, i, j]
                sources[0, i, j] -= rate * cos[station, i]
                sources[1, i, j] -= rate * sin[station, i]
