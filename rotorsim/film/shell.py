"""A thin shell in the bore, free at its first edge: Ritz's method with cubic B-splines.

Donnell's shell with u along the arc x, v along the axis y and w outwards:

    membrane strains u_x + w/R, v_y, u_y + v_x; curvatures w_xx, w_yy, 2 w_xy.

A width W(x) that changes is stretched out: y = eta W/2, so that f_y = 2 f_eta/W and
f_x = f_xi - eta g f_eta with g = W'/W, and the edges at which the shell is built in are lines of
the splines.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.interpolate import BSpline
from scipy.sparse.linalg import splu

from ..arrays import Array
from ..model.compliance import Diaphragm
from .mesh import FilmMesh

_SPANS = 32, 16
"""Spans of the splines along the arc and the axis."""
_SAMPLES = 3
"""Points along each side of a film's cell that its pressure is spread over."""


@dataclass(frozen=True)
class _Line:
    """Cubic B-splines on an interval, for functions that vanish at built-in ends.

    built_in : Whether the first and the last end are.
    """

    first: float
    last: float
    spans: int
    built_in: tuple[bool, bool]

    def values(self, at: Array, derivative: int, slopes: bool) -> Array:
        """Return values of all functions, (points, functions).

        `slopes` vanish at built-in ends too.
        """
        inner = np.linspace(self.first, self.last, self.spans + 1)
        knots = np.concatenate([[self.first] * 3, inner, [self.last] * 3])
        functions = BSpline(knots, np.eye(knots.size - 4), 3)
        out = functions(at) if derivative == 0 else functions.derivative(derivative)(at)
        gone = 2 if slopes else 1
        first, last = (gone if end else 0 for end in self.built_in)
        return np.asarray(out[:, first : out.shape[1] - last])

    def rule(self) -> tuple[Array, Array]:
        """Return gauss points and weights over the interval."""
        point, weight = np.polynomial.legendre.leggauss(4)
        edges = np.linspace(self.first, self.last, self.spans + 1)
        half = 0.5 * np.diff(edges)[:, None]
        return (edges[:-1, None] + half * (1.0 + point)).ravel(), (half * weight).ravel()


def shell_compliance(shell: Diaphragm, mesh: FilmMesh) -> tuple[NDArray[np.intp], Array]:
    """Return the film's cells over the shell, flat indices (c,), and w per pressure [m/Pa], (c, c).

    On half a mesh with both halves loaded alike.
    """
    length = mesh.radius * shell.extent
    wide = shell.width
    narrow = wide if shell.width_at_end is None else shell.width_at_end
    around, across = (
        _Line(0.0, length, _SPANS[0], (False, True)),
        _Line(-1.0, 1.0, _SPANS[1], (True, True)),
    )
    stiffness, count = _stiffness(shell, mesh.radius, around, across, (wide, narrow))
    cells, load = _cell_means(shell, mesh, around, across, (wide, narrow), mirrored=False)
    both = load
    if mesh.half:
        both = load + _cell_means(shell, mesh, around, across, (wide, narrow), mirrored=True)[1]
    area = (mesh.dx[:, None] * mesh.dy).ravel()[cells]
    outwards = np.eye(stiffness.shape[0])[:, -count:]
    factor: Any = splu(stiffness)
    compliance = factor.solve(outwards)[-count:]
    return cells, load @ compliance @ (both.T * area)


def _stiffness(
    shell: Diaphragm, radius: float, around: _Line, across: _Line, widths: tuple[float, float]
) -> tuple[Any, int]:
    """Return stiffness matrix over u, v and w, and how many of the unknowns, the last, are w's."""
    (x, along), (eta, aside) = around.rule(), across.rule()
    width = np.repeat(np.interp(x, [0.0, around.last], widths), eta.size)
    slope = (widths[1] - widths[0]) / around.last
    eta_at, g, scale = np.tile(eta, x.size), slope / width, 2.0 / width

    def part(dx: int, dy: int, slopes: bool) -> Any:
        return sparse.kron(
            around.values(x, dx, slopes), across.values(eta, dy, slopes), format="csr"
        )

    def weighted(*terms: tuple[Array | float, Any]) -> Any:
        return sum(sparse.diags(np.broadcast_to(f, width.shape)) @ m for f, m in terms)

    flat, steep = {}, {}
    for dx in range(3):
        for dy in range(3 - dx):
            steep[dx, dy] = part(dx, dy, True)
            if dx + dy < 2:
                flat[dx, dy] = part(dx, dy, False)
    f_x = weighted((1.0, flat[1, 0]), (-eta_at * g, flat[0, 1]))
    f_y = weighted((scale, flat[0, 1]))
    w_yy = weighted((scale**2, steep[0, 2]))
    w_xy = weighted(
        (scale, steep[1, 1]), (-scale * eta_at * g, steep[0, 2]), (-scale * g, steep[0, 1])
    )
    w_xx = weighted(
        (1.0, steep[2, 0]), (-2.0 * eta_at * g, steep[1, 1]),
        (2.0 * eta_at * g**2, steep[0, 1]), ((eta_at * g) ** 2, steep[0, 2]),
    )  # fmt: skip
    none, no_w = sparse.csr_matrix(f_x.shape), sparse.csr_matrix(w_xx.shape)
    weight = sparse.diags(np.kron(along, aside) * 0.5 * width)
    nu = shell.poisson_ratio
    stretching = shell.youngs_modulus * shell.thickness / (1.0 - nu**2)

    def energy(strains: Sequence[Any], modulus: float) -> Any:
        a, b, c = strains
        both = a.T @ weight @ b
        return modulus * (
            a.T @ weight @ a + b.T @ weight @ b + nu * (both + both.T)
            + 0.5 * (1.0 - nu) * (c.T @ weight @ c)
        )  # fmt: skip

    membrane = [
        sparse.hstack([f_x, none, steep[0, 0] / radius]),
        sparse.hstack([none, f_y, no_w]),
        sparse.hstack([f_y, f_x, no_w]),
    ]
    curvature = [sparse.hstack([none, none, one]) for one in (w_xx, w_yy, 2.0 * w_xy)]
    whole = energy(membrane, stretching)
    whole = whole + energy(curvature, stretching * shell.thickness**2 / 12.0)
    return sparse.csc_matrix(whole), int(w_xx.shape[1])


def _cell_means(
    shell: Diaphragm, mesh: FilmMesh, around: _Line, across: _Line, widths: tuple[float, float],
    mirrored: bool,
) -> tuple[NDArray[np.intp], Array]:  # fmt: skip
    """Return cells over the shell, and the mean of each function of w over each of them."""
    share = (np.arange(_SAMPLES) + 0.5) / _SAMPLES - 0.5
    theta = mesh.theta[:, None] + np.diff(mesh.theta_faces)[:, None] * share
    x = mesh.radius * ((theta - shell.start) % (2.0 * np.pi))
    y = (mesh.y[:, None] + mesh.dy[:, None] * share) * (-1.0 if mirrored else 1.0)
    m = mesh.shape[1]
    inside_x = x < around.last
    on_arc, on_width = np.flatnonzero(inside_x.any(axis=1)), np.arange(m)
    cells, means = [], []
    for i in on_arc:
        here = np.where(inside_x[i], x[i], around.last)
        values = around.values(here, 0, True)
        width = np.interp(here, [0.0, around.last], widths)
        mean = 0.0
        for k in range(_SAMPLES):
            eta = np.clip(2.0 * y.ravel() / width[k], -1.0, 1.0)
            beside = across.values(eta, 0, True).reshape(m, _SAMPLES, -1).mean(axis=1)
            mean = mean + (values[k][None, :, None] * beside[:, None, :]).reshape(m, -1) / _SAMPLES
        cells.append(i * m + on_width)
        means.append(mean)
    found = np.concatenate(cells) if cells else np.zeros(0, dtype=np.intp)
    rows = np.concatenate(means) if means else np.zeros((0, 0))
    return found, rows
