"""A second method for the isoviscous film: bilinear finite elements, nothing shared with rotorsim.

Nodes (not cells), a weak form with the thickness taken exactly in the Gauss points, rupture by a
primal-dual active set over the nodes, a sparse LU, coefficients from the perturbed weak form.
Dimensionless: H = h/c, P = p c^2/(6 mu omega R^2), Y = y/R, time in 1/omega:

    d/dtheta(H^3 dP/dtheta) + d/dY(H^3 dP/dY) = dH/dtheta + 2 dH/dt
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.optimize import newton
from scipy.sparse.linalg import splu

GAUSS = 0.5 + 0.5 / math.sqrt(3.0) * np.array([-1.0, 1.0])


@dataclass(frozen=True)
class ElementFilm:
    """Results of the second method (load frame; x along the load)."""

    sommerfeld: float
    """F psi^2/(B D mu omega)."""
    attitude: float
    """[rad]"""
    side_flow: float
    """Q/(R^3 psi omega)."""
    peak: float
    """Largest nodal P."""
    stiffness: np.ndarray
    """K c/W."""
    damping: np.ndarray
    """C c omega/W."""

    def packed(self) -> np.ndarray:
        return np.concatenate(
            [
                [self.sommerfeld, self.attitude, self.side_flow, self.peak],
                self.stiffness.ravel(),
                self.damping.ravel(),
            ]
        )

    @classmethod
    def unpacked(cls, a: np.ndarray) -> ElementFilm:
        return cls(*a[:4].tolist(), a[4:8].reshape(2, 2), a[8:].reshape(2, 2))


def nodes_between(start: float, end: float, count: int, eccentricity: float, angle: float):
    """`count` elements, crowded where the film is thin."""
    fine = np.linspace(start, end, 4001)
    density = 0.3 + 1.0 / (1.0 - eccentricity * np.cos(fine - angle))
    total = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(fine))])
    nodes = np.interp(np.linspace(0.0, total[-1], count + 1), total, fine)
    nodes[0], nodes[-1] = start, end
    return nodes


def _solve(pads, eccentricity, angle, slenderness, axial):
    """Force, flow and matrices of films between p = 0 lines; `pads`: (start, end, elements)."""
    force, flow, peak = np.zeros(2), 0.0, 0.0
    k_sum, c_sum = np.zeros((2, 2)), np.zeros((2, 2))
    for start, end, count in pads:
        theta = nodes_between(start, end, count, eccentricity, angle)
        y = slenderness * (1.0 - (1.0 - np.linspace(0.0, 1.0, axial + 1)) ** 1.3)
        out = _solve_pad(theta, y, eccentricity, angle)
        force, flow, peak = force + out[0], flow + out[1], max(peak, out[2])
        k_sum, c_sum = k_sum + out[3], c_sum + out[4]
    return force, flow, peak, k_sum, c_sum


def _solve_pad(theta, y, eccentricity, angle):
    nt, ny = theta.size, y.size
    number = np.arange(nt * ny).reshape(nt, ny)
    corners = np.stack([number[:-1, :-1], number[1:, :-1], number[:-1, 1:], number[1:, 1:]], -1)
    corners = corners.reshape(-1, 4)
    dt = np.repeat(np.diff(theta), ny - 1)
    dy = np.tile(np.diff(y), nt - 1)
    t0 = np.repeat(theta[:-1], ny - 1)
    e = corners.shape[0]
    matrix = np.zeros((e, 4, 4))
    wedge, normals = np.zeros((e, 4)), np.zeros((2, e, 4))
    points = []
    for s in GAUSS:
        for r in GAUSS:
            shape = np.array([(1 - s) * (1 - r), s * (1 - r), (1 - s) * r, s * r])
            along = np.array([-(1 - r), 1 - r, -r, r])[None] / dt[:, None]
            across = np.array([-(1 - s), -s, 1 - s, s])[None] / dy[:, None]
            weight = 0.25 * dt * dy
            t = t0 + s * dt
            h = 1.0 - eccentricity * np.cos(t - angle)
            slope = eccentricity * np.sin(t - angle)
            stiff = along[:, :, None] * along[:, None, :] + across[:, :, None] * across[:, None, :]
            matrix += (weight * h**3)[:, None, None] * stiff
            wedge -= (weight * slope)[:, None] * shape
            normals += np.stack([np.cos(t), np.sin(t)])[:, :, None] * weight[:, None] * shape
            points.append((h, t, weight, shape, stiff))

    def gather(parts):
        return np.bincount(corners.ravel(), parts.ravel(), nt * ny)

    rows, columns = np.repeat(corners, 4, axis=1).ravel(), np.tile(corners, (1, 4)).ravel()
    big = sp.csr_matrix((matrix.ravel(), (rows, columns)), shape=(nt * ny, nt * ny))
    source = gather(wedge)
    free = np.ones((nt, ny), dtype=bool)
    free[[0, -1], :] = False
    free[:, -1] = False
    free = free.ravel()
    pressure, full, factor = _complementary(big, source, free)
    # perturbations: displacement and velocity along x and y
    p = pressure[corners]
    displaced = np.zeros((2, e, 4))
    for h, t, weight, shape, stiff in points:
        gradient = np.einsum("eab,eb->ea", stiff, p)
        for axis, (thinner, bend) in enumerate(((-np.cos(t), np.sin(t)), (-np.sin(t), -np.cos(t)))):
            displaced[axis] -= (weight * 3.0 * h**2 * thinner)[:, None] * gradient
            displaced[axis] -= (weight * bend)[:, None] * shape
    pull = np.stack([gather(normals[0]), gather(normals[1])])
    right = np.stack([gather(displaced[0]), gather(displaced[1]), 2.0 * pull[0], 2.0 * pull[1]])
    solved = np.zeros((4, nt * ny))
    if full.any():
        solved[:, full] = factor.solve(right[:, full].T).T
    matrices = 2.0 * pull @ solved.T
    reaction = source - big @ pressure
    # The end nodes' reactions are the oil that leaves there; ruptured lines give none.
    wet = full.reshape(nt, ny)[1:-1, -2]
    flow = float(reaction.reshape(nt, ny)[1:-1, -1][wet].sum())
    return -2.0 * pull @ pressure, flow, pressure.max(), matrices[:, :2], matrices[:, 2:]


def _complementary(matrix, source, free):
    full = free & (source > 0.0)
    scale = np.abs(source).max()
    for _ in range(100):
        pressure = np.zeros(source.size)
        inside = np.flatnonzero(full)
        if inside.size == 0:
            return pressure, full, None
        factor = splu(matrix[inside][:, inside].tocsc())
        pressure[inside] = factor.solve(source[inside])
        residual = source - matrix @ pressure
        after = np.where(full, pressure > 0.0, free & (residual > 1e-12 * scale))
        if (after == full).all():
            return pressure, full, factor
        full = after
    raise ArithmeticError("the active set did not settle")


def element_film(
    eccentricity: float, length_to_diameter: float, *, refine: int = 1, groove_extent: float = 0.0
) -> ElementFilm:
    """Full film from a slot at maximum thickness, or two arcs between grooves at +-90 degrees."""
    axial = 12 * refine
    if groove_extent == 0.0:
        pads = ((-math.pi, math.pi, 60 * refine),)
        found = _solve(pads, eccentricity, 0.0, length_to_diameter, axial)
        attitude = -math.atan2(-found[0][1], -found[0][0])
        turn = attitude
    else:
        edge = 0.5 * groove_extent
        pads = (
            (-0.5 * math.pi + edge, 0.5 * math.pi - edge, 40 * refine),
            (0.5 * math.pi + edge, 1.5 * math.pi - edge, 40 * refine),
        )

        def across(angle: float) -> float:
            force = _solve(pads, eccentricity, angle, length_to_diameter, axial)[0]
            return math.atan2(-force[1], -force[0])

        guess = math.acos(eccentricity)
        attitude = float(newton(across, guess, x1=guess - 0.1, tol=1e-7))
        found = _solve(pads, eccentricity, attitude, length_to_diameter, axial)
        turn = 0.0
    force, flow, peak, stiffness, damping = found
    rotation = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    size = float(np.hypot(*force))
    return ElementFilm(
        sommerfeld=3.0 * size / (2.0 * length_to_diameter),
        attitude=attitude,
        side_flow=flow,
        peak=float(peak),
        stiffness=rotation @ stiffness @ rotation.T / size,
        damping=rotation @ damping @ rotation.T / size,
    )


def extrapolated(
    eccentricity: float, length_to_diameter: float, *, refine: int = 2, groove_extent: float = 0.0
) -> tuple[ElementFilm, ElementFilm]:
    """Richardson's limit of two meshes (second order), and the finer mesh's own values."""
    coarse, fine = (
        element_film(eccentricity, length_to_diameter, refine=r, groove_extent=groove_extent)
        for r in (refine, 2 * refine)
    )
    limit = fine.packed() + (fine.packed() - coarse.packed()) / 3.0
    return ElementFilm.unpacked(limit), fine
