"""Heat conduction in the bush or a pad, in r, theta and y (Dal Eq. 16, its boundary conditions).

The operator is constant over a sweep and separable: eigenvectors around (theta) and along (y) leave
one tridiagonal system in r for each pair of modes. Solved once, they give the map from the heat
that the film sends into the bore to the bore's temperature: a number for each pair of modes.

A time step is the same operator: the heat stored adds to its diagonal, and what the solid held
before leaves a temperature at no flux, `rest`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.linalg import eigh

from ..arrays import Array


@dataclass(frozen=True)
class BushOperator:
    """Finite volumes of the bush or of one pad, diagonalised around and along.

    around : (n, n) array. Eigenvectors of the Laplacian around, orthonormal in its cell lengths.
    along : (m, m) array. Eigenvectors of the axial Laplacian with convection at the ends, likewise.
    lengths : tuple of arrays. Cell lengths d(theta) [rad] and dy [m].
    resistance : (n, m) array. Bore temperature above ambient per unit heat flux [m2 K/W], for each
        pair of modes.
    profile : (n, m, l) array. Temperature of the bush's cells per unit heat flux, for each pair of
        modes.
    radii : (l,) array. Of the cells' centres [m]; they are equally thick.
    rest : (n, m, l) array. Temperature of the cells above ambient at no flux, for each pair of
        modes [K]: 0 unless heat is stored.
    system : tuple of arrays. Diagonal (n, m, l) and links (l - 1,) of the systems in r.
    skin : Resistance from the first cells' centres to the bore [m2 K/W].
    """

    around: Array
    along: Array
    lengths: tuple[Array, Array]
    resistance: Array
    profile: Array
    radii: Array
    rest: Array
    system: tuple[Array, Array]
    skin: float

    def step(self, rate: float, held: Array) -> BushOperator:
        """Return the operator of the same solid over a time step.

        rate : Heat stored per volume and degree over the step [W/(m3 K)].
        held : (n, m, l) array. Modes of the temperature above ambient that the step begins from
            [K].
        """
        diagonal, links = self.system
        size = float(self.radii[1] - self.radii[0])
        stored = rate * self.radii * size
        source = np.zeros_like(diagonal)
        source[:, :, 0] = self.radii[0] - 0.5 * size
        profile = _through(diagonal + stored, links, source)
        rest = _through(diagonal + stored, links, stored * held)
        return replace(self, resistance=profile[:, :, 0] + self.skin, profile=profile, rest=rest)

    def bore_rise(self, flux: Array) -> Array:
        """Return the bore temperature above ambient [K], (n, m), for a heat flux into it [W/m2]."""
        return self._bore(self.resistance * self._modes(flux) + self.rest[:, :, 0])

    def field(self, flux: Array) -> Array:
        """Return the temperature above ambient of every cell [K], (n, m, l), for the same flux."""
        modes = self._modes(flux)[:, :, None] * self.profile + self.rest
        return self.of_modes(modes)

    def of_modes(self, modes: Array) -> Array:
        """Return the cells' temperature (n, m, l) of its modes (n, m, l)."""
        return np.einsum("ip,jq,pql->ijl", self.around, self.along, modes, optimize=True)

    def to_modes(self, field: Array) -> Array:
        """Reverse `of_modes`."""
        weighted = field * (self.lengths[0][:, None] * self.lengths[1])[:, :, None]
        return np.einsum("ip,jq,ijl->pql", self.around, self.along, weighted, optimize=True)

    def modes_under(self, bore_rise: Array) -> Array:
        """Return the cells' modes (n, m, l) with the bore at `bore_rise` above ambient, (n, m)."""
        flux = (self._modes(bore_rise) - self.rest[:, :, 0]) / self.resistance
        return flux[:, :, None] * self.profile + self.rest

    def body(self, bore_rise: Array) -> tuple[float, float]:
        """Return the solid's mean rise above ambient [K] and its mean dT/dr [K/m].

        The gradient is that of the straight line through the temperatures, which bends a beam.

        bore_rise : (n, m) array. Of the bore above ambient [K].
        """
        (mean, gradient), at_rest = self._body_weights
        first = float(np.sum(mean * bore_rise)) + at_rest[0]
        return first, float(np.sum(gradient * bore_rise)) + at_rest[1]

    @cached_property
    def _body_weights(self) -> tuple[tuple[Array, Array], tuple[float, float]]:
        """Return the share of each cell of the bore in `body`, (n, m) each, and of what rests."""
        r, (dtheta, dy) = self.radii, self.lengths
        around, along = dtheta @ self.around / dtheta.sum(), dy @ self.along / dy.sum()
        arm = r - r.mean()
        cells = dtheta[:, None] * dy
        weights, rests = [], []
        for through in (r / r.sum(), arm / (arm @ arm)):
            shares = around[:, None] * along
            per_bore = shares * (self.profile @ through) / self.resistance
            weights.append(cells * (self.around @ per_bore @ self.along.T))
            rest = shares * (self.rest @ through) - per_bore * self.rest[:, :, 0]
            rests.append(float(rest.sum()))
        return (weights[0], weights[1]), (rests[0], rests[1])

    def robin_rise(self, reference: Array, conductance: float) -> Array:
        """Return the bore temperature above ambient [K] under a Robin condition.

        The heat flux is conductance (reference - bore).
        """
        exchange = self.resistance * conductance
        modes = (exchange * self._modes(reference) + self.rest[:, :, 0]) / (1.0 + exchange)
        return self._bore(modes)

    def _modes(self, values: Array) -> Array:
        weighted = values * self.lengths[0][:, None] * self.lengths[1][None, :]
        return self.around.T @ weighted @ self.along

    def _bore(self, modes: Array) -> Array:
        return self.around @ modes @ self.along.T


def _bush_operator(
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

    theta_faces : (n + 1,) array [rad], one turn; or from edge to edge of a pad.
    y_faces : (m + 1,) array [m]
    radii : Bore and outer radius [m].
    layers : Cells through the bush.
    conductivity : [W/(m K)]
    outer_transfer : Heat transfer to the surroundings on the outer surface [W/(m2 K)].
    end_transfer : On the first and the last end; 0 for a plane of symmetry.
    edge_transfer : On a pad's leading and trailing edge [W/(m2 K)], at its mean radius; None: a
        ring.
    """
    dtheta, dy = np.diff(theta_faces), np.diff(y_faces)
    edge = None if edge_transfer is None else 0.5 * (radii[0] + radii[1]) * edge_transfer
    (around_values, around), (along_values, along) = _plane_modes(
        dtheta.tobytes(), dy.tobytes(), conductivity, end_transfer, edge
    )
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
    source = np.zeros_like(diagonal)
    source[:, :, 0] = radii[0]
    profile = _through(diagonal, links, source)
    # From the first cell's centre to the bore: the flux through half a cell.
    skin = 0.5 * float(dr[0]) / conductivity
    return BushOperator(
        around, along, (dtheta, dy), profile[:, :, 0] + skin, profile, r, np.zeros_like(profile),
        (diagonal, links), skin,
    )  # fmt: skip


@lru_cache(maxsize=16)
def _plane_modes(
    dtheta: bytes,
    dy: bytes,
    conductivity: float,
    end_transfer: tuple[float, float],
    edge: float | None,
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Return the eigenvalues and vectors around and along."""
    lengths = np.frombuffer(dtheta)
    around = (
        _ring_modes(lengths) if edge is None else _open_modes(lengths, conductivity, (edge, edge))
    )
    return around, _open_modes(np.frombuffer(dy), conductivity, end_transfer)


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
    """Return the modes between two ends with convection."""
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


def _through(diagonal: Array, links: Array, source: Array) -> Array:
    """Solve the tridiagonal systems through the solid for a source in its cells, (n, m, l)."""
    layers = diagonal.shape[2]
    ratio, column = np.zeros_like(diagonal), source.copy()
    pivot = diagonal[:, :, -1]
    for k in range(layers - 2, -1, -1):
        with np.errstate(divide="ignore"):
            ratio[:, :, k + 1] = links[k] / pivot
            column[:, :, k + 1] /= pivot
        pivot = diagonal[:, :, k] - links[k] * ratio[:, :, k + 1]
        column[:, :, k] += links[k] * column[:, :, k + 1]
    # An insulated bush can take no net heat: its mean mode has no finite answer.
    tiny = 1e-12 * diagonal[:, :, 0]
    column[:, :, 0] /= np.maximum(pivot, tiny)
    for k in range(1, layers):
        column[:, :, k] += ratio[:, :, k] * column[:, :, k - 1]
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
    """Return `_bush_operator` of hashable arguments, one of the last few if it is the same."""
    return _bush_operator(
        np.frombuffer(theta_faces),
        np.frombuffer(y_faces),
        radii,
        layers,
        conductivity,
        outer_transfer=outer_transfer,
        end_transfer=end_transfer,
        edge_transfer=edge_transfer,
    )
