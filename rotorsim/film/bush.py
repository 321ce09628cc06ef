"""Heat conduction in the bush or a pad, in r, theta and y (Dal Eq. 16, its boundary conditions).

The operator is constant over a sweep and separable: eigenvectors around (theta) and along (y) leave
one tridiagonal system in r for each pair of modes. Solved once, they give the map from the heat
that the film sends into the bore to the bore's temperature: a number for each pair of modes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BushOperator:
    """Finite volumes of the bush or of one pad, diagonalised around and along.

    Attributes
    ----------
    around : (n, n) array
        Eigenvectors of the Laplacian around, orthonormal in its cell lengths.
    along : (m, m) array
        Eigenvectors of the axial Laplacian with convection at the ends, likewise.
    lengths : tuple of arrays
        Cell lengths d(theta) [rad] and dy [m].
    resistance : (n, m) array
        Bore temperature above ambient per unit heat flux [m2 K/W], for each pair of modes.
    profile : (n, m, l) array
        Temperature of the bush's cells per unit heat flux, for each pair of modes.
    """

    around: Array
    along: Array
    lengths: tuple[Array, Array]
    resistance: Array
    profile: Array

    def bore_rise(self, flux: Array) -> Array:
        """Return the bore temperature above ambient [K], (n, m), for a heat flux into it [W/m2]."""
        return self._apply(self.resistance, flux)

    def field(self, flux: Array) -> Array:
        """Return the temperature above ambient of every cell [K], (n, m, l), for the same flux."""
        modes = self._modes(flux)[:, :, None] * self.profile
        return np.einsum("ip,jq,pql->ijl", self.around, self.along, modes, optimize=True)

    def robin_rise(self, reference: Array, conductance: float) -> Array:
        """Return the bore temperature above ambient [K] under a Robin condition.

        The heat flux is conductance (reference - bore).
        """
        exchange = self.resistance * conductance
        return self._apply(exchange / (1.0 + exchange), reference)

    def _modes(self, values: Array) -> Array:
        weighted = values * self.lengths[0][:, None] * self.lengths[1][None, :]
        return self.around.T @ weighted @ self.along

    def _apply(self, response: Array, values: Array) -> Array:
        return self.around @ (response * self._modes(values)) @ self.along.T


def bush_operator(
    theta_faces: Array,
    y_faces: Array,
    radii: tuple[float, float],
    layers: int,
    conductivity: float,
    *,
    outer_transfer: float,
    end_transfer: tuple[float, float],
    edge_transfer: float | None = None,
) -> BushOperator:
    """Build the operator of a ring, or of a pad.

    Parameters
    ----------
    theta_faces : (n + 1,) array
        [rad], one turn; or from edge to edge of a pad.
    y_faces : (m + 1,) array
        [m]
    radii : tuple of float
        Bore and outer radius [m].
    layers : int
        Cells through the bush.
    conductivity : float
        [W/(m K)]
    outer_transfer : float
        Heat transfer to the surroundings on the outer surface [W/(m2 K)].
    end_transfer : tuple of float
        On the first and the last end; 0 for a plane of symmetry.
    edge_transfer : float, optional
        On a pad's leading and trailing edge [W/(m2 K)], at its mean radius; None: a ring.
    """
    dtheta, dy = np.diff(theta_faces), np.diff(y_faces)
    if edge_transfer is None:
        around_values, around = _ring_modes(dtheta)
    else:
        edge = 0.5 * (radii[0] + radii[1]) * edge_transfer
        around_values, around = _open_modes(dtheta, conductivity, (edge, edge))
    along_values, along = _open_modes(dy, conductivity, end_transfer)
    r_faces = np.linspace(radii[0], radii[1], layers + 1)
    r, dr = 0.5 * (r_faces[1:] + r_faces[:-1]), np.diff(r_faces)
    links = conductivity * r_faces[1:-1] / (r[1:] - r[:-1])
    outside = 0.0
    if outer_transfer > 0.0:
        outside = radii[1] / (0.5 * dr[-1] / conductivity + 1.0 / outer_transfer)
    diagonal = np.zeros((around_values.size, along_values.size, layers))
    diagonal[:, :, :-1] += links
    diagonal[:, :, 1:] += links
    diagonal[:, :, -1] += outside
    diagonal += conductivity * (
        around_values[:, None, None] * dr / r + along_values[None, :, None] * r * dr
    )
    profile = _first_column(diagonal, links) * radii[0]
    # From the first cell's centre to the bore: the flux through half a cell.
    resistance = profile[:, :, 0] + 0.5 * dr[0] / conductivity
    return BushOperator(around, along, (dtheta, dy), resistance, profile)


def _ring_modes(dtheta: Array) -> tuple[Array, Array]:
    spacing = 0.5 * (dtheta + np.roll(dtheta, -1))
    n = dtheta.size
    matrix = np.zeros((n, n))
    for i in range(n):
        k = (i + 1) % n
        matrix[i, i] += 1.0 / spacing[i]
        matrix[k, k] += 1.0 / spacing[i]
        matrix[i, k] -= 1.0 / spacing[i]
        matrix[k, i] -= 1.0 / spacing[i]
    return _weighted_modes(matrix, dtheta)


def _open_modes(
    dy: Array, conductivity: float, end_transfer: tuple[float, float]
) -> tuple[Array, Array]:
    """Modes between two ends with convection."""
    m = dy.size
    matrix = np.zeros((m, m))
    for j in range(m - 1):
        link = 2.0 / (dy[j] + dy[j + 1])
        matrix[j, j] += link
        matrix[j + 1, j + 1] += link
        matrix[j, j + 1] -= link
        matrix[j + 1, j] -= link
    for j, transfer in ((0, end_transfer[0]), (m - 1, end_transfer[1])):
        if transfer > 0.0:
            matrix[j, j] += 1.0 / (0.5 * dy[j] + conductivity / transfer)
    return _weighted_modes(matrix, dy)


def _weighted_modes(matrix: Array, weights: Array) -> tuple[Array, Array]:
    """Return eigenvalues and vectors of matrix v = lambda diag(weights) v."""
    root = np.sqrt(weights)
    values, vectors = eigh(matrix / root[:, None] / root[None, :])
    return np.maximum(values, 0.0), vectors / root[:, None]


def _first_column(diagonal: Array, links: Array) -> Array:
    """Solve the tridiagonal systems with a unit source in the first cell, (n, m, l)."""
    layers = diagonal.shape[2]
    ratio = np.zeros_like(diagonal)
    pivot = diagonal[:, :, -1]
    for k in range(layers - 2, -1, -1):
        with np.errstate(divide="ignore"):
            ratio[:, :, k + 1] = links[k] / pivot
        pivot = diagonal[:, :, k] - links[k] * ratio[:, :, k + 1]
    # An insulated bush can take no net heat: its mean mode has no finite answer.
    tiny = 1e-12 * diagonal[:, :, 0]
    column = np.empty_like(diagonal)
    column[:, :, 0] = 1.0 / np.maximum(pivot, tiny)
    for k in range(1, layers):
        column[:, :, k] = ratio[:, :, k] * column[:, :, k - 1]
    return column


@lru_cache(maxsize=16)
def kept_operator(
    theta_faces: bytes,
    y_faces: bytes,
    radii: tuple[float, float],
    layers: int,
    conductivity: float,
    outer_transfer: float,
    end_transfer: tuple[float, float],
    edge_transfer: float | None = None,
) -> BushOperator:
    """Return `bush_operator` of hashable arguments, one of the last few if it is the same."""
    return bush_operator(
        np.frombuffer(theta_faces),
        np.frombuffer(y_faces),
        radii,
        layers,
        conductivity,
        outer_transfer=outer_transfer,
        end_transfer=end_transfer,
        edge_transfer=edge_transfer,
    )
