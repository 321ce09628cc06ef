"""A second method for the mass-conserving film, at rest and in time; nothing shared with rotorsim.

Jakobsson, Floberg & Olsson's condition as a complementarity problem in pressure and void fraction
phi = 1 - (liquid fraction), solved by Newton's method on the Fischer-Burmeister function with a
sparse LU (Woloszynski, Podsiadlo & Stachowiak, Tribol. Lett. 58, 2015, 18) on equal cells, whose
pressure stands at the groove's edge half a cell away from the first centre.
Dimensionless: H = h/c, P = p c^2/(6 mu omega R^2), Y = y/R, T = omega t:

    d/dtheta(H^3 dP/dtheta) + d/dY(H^3 dP/dY) = d[(1 - phi) H]/dtheta + 2 d[(1 - phi) H]/dT
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from scipy.optimize import root_scalar
from scipy.sparse.linalg import splu


@dataclass
class MassConservingFilm:
    """A plain bearing with one axial groove, cut at its mid-plane.

    Angles count from the load line (x) in the direction of rotation.
    """

    length_to_diameter: float
    groove_center: float
    """[rad]"""
    groove_extent: float
    """[rad]; the groove's cells are those whose centres lie in it."""
    groove_share: float = 1.0
    """Groove's length over the bearing's."""
    supply: float = 0.0
    """P in the groove."""
    around: int = 144
    along: int = 10
    """Cells from the mid-plane to the end."""
    pressure: np.ndarray = field(init=False)
    void: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        n, m = self.around, self.along
        self.dt, self.dy = 2.0 * math.pi / n, self.length_to_diameter / m
        self.theta = self.groove_center + self.dt * (np.arange(n) + 0.5)
        y = self.dy * (np.arange(m) + 0.5)
        away = np.abs(
            np.remainder(self.theta - self.groove_center + math.pi, 2 * math.pi) - math.pi
        )
        inside = away < 0.5 * self.groove_extent
        self.groove = inside[:, None] & (y < self.groove_share * self.length_to_diameter)[None]
        self.pressure = np.where(self.groove, self.supply, 0.0)
        self.void = np.zeros((n, m))
        self.cell = np.arange(n * m).reshape(n, m)
        self.weights = 2.0 * self.dt * self.dy  # both halves

    def thickness(self, theta, x, y):
        return 1.0 - x * np.cos(theta) - y * np.sin(theta)

    def _matrices(self, x, y):
        """Poiseuille flow into each cell per pressure, Couette flow into it per liquid fraction."""
        n, m, cell = self.around, self.along, self.cell
        face = self.thickness(self.theta + 0.5 * self.dt, x, y)  # between i and i + 1
        here, behind = cell.ravel(), np.roll(cell, -1, axis=0).ravel()
        edge = np.where(self.groove != np.roll(self.groove, -1, axis=0), 2.0, 1.0).ravel()
        across = edge * np.repeat(face**3 * self.dy / self.dt, m)
        a = sp.coo_matrix((across, (here, behind)), (n * m, n * m))
        a = a + a.T
        edge = np.where(self.groove[:, :-1] != self.groove[:, 1:], 2.0, 1.0)
        axial = edge * (self.thickness(self.theta, x, y) ** 3 * self.dt / self.dy)[:, None]
        left, right = cell[:, :-1].ravel(), cell[:, 1:].ravel()
        b = sp.coo_matrix((axial.ravel(), (left, right)), (n * m, n * m))
        a = a + b + b.T
        total = np.asarray(a.sum(axis=1)).ravel().reshape(n, m)
        total[:, -1] += 2.0 * self.thickness(self.theta, x, y) ** 3 * self.dt / self.dy
        poiseuille = a - sp.diags(total.ravel())
        carried = np.repeat(face * self.dy, m)
        couette = sp.coo_matrix((carried, (behind, here)), (n * m, n * m)) - sp.diags(carried)
        return poiseuille.tocsr(), couette.tocsr()

    def solve(self, x, y, *, before=None, step=None):
        """Pressure with the journal at (x, y); with `before`, `step` one implicit step in time.

        `before`: stored oil (1 - phi) H of the step before, (n, m).
        """
        poiseuille, couette = self._matrices(x, y)
        size = self.cell.size
        h = np.repeat(self.thickness(self.theta, x, y), self.along)
        store = np.zeros(size)
        source = couette @ np.ones(size)
        if step is not None and before is not None:
            store = 2.0 * h * self.dt * self.dy / step
            source += 2.0 * before.ravel() * self.dt * self.dy / step - store
        flow = couette - sp.diags(store)
        held = self.groove.ravel()
        free = np.flatnonzero(~held)
        p = self.pressure.ravel().copy()
        phi = np.where(held, 0.0, self.void.ravel())
        p[held] = self.supply
        a, b = poiseuille[free], sp.csr_array(flow)[free]
        a_free, b_free = sp.csr_array(a)[:, free], sp.csr_array(b)[:, free]
        scale = np.abs(source).max()
        pressures = max(np.abs(p).max(), 1.0)
        off = math.inf
        for _ in range(400):
            balance = (a @ p - b @ phi + source[free]) / scale
            q, v = p[free] / pressures, phi[free]
            root = np.sqrt(q * q + v * v + 1e-30)
            bound = q + v - root
            off = max(np.abs(balance).max(), np.abs(bound).max())
            if off < 1e-11:
                break
            matrix = sp.bmat(
                [
                    [a_free * (pressures / scale), -b_free / scale],
                    [sp.diags(1.0 - q / root), sp.diags(1.0 - v / root)],
                ],
                format="csc",
            )
            change = splu(matrix).solve(-np.concatenate([balance, bound]))
            p[free] += change[: free.size] * pressures
            phi[free] += change[free.size :]
        else:
            raise ArithmeticError(f"no solution at {x:g}, {y:g}: {off:.1e}")
        self.pressure, self.void = p.reshape(self.groove.shape), phi.reshape(self.groove.shape)
        return self.pressure

    def stored(self, x, y):
        return (1.0 - self.void) * self.thickness(self.theta, x, y)[:, None]

    def force(self, x, y, **step):
        """Force on the journal over 6 mu omega R^4/c^2, (2,)."""
        p = self.solve(x, y, **step).sum(axis=1) * self.weights
        return -np.array([p @ np.cos(self.theta), p @ np.sin(self.theta)])

    def dynamic_stiffness(self, x, y, frequency):
        """-dF/dq of a motion exp(i nu T) about the film last solved at (x, y), (2, 2) complex.

        `frequency`: nu over the shaft's. The discrete equations by differences of the matrices.
        """
        pressure, void, area = self.pressure.ravel(), self.void.ravel(), self.dt * self.dy
        free, full = np.flatnonzero(~self.groove.ravel()), self.pressure.ravel() > self.void.ravel()
        sources = []
        for direction in np.eye(2) * 1e-6:
            ahead, behind = (
                self._matrices(x + direction[0], y + direction[1]),
                self._matrices(x - direction[0], y - direction[1]),
            )
            flow = (ahead[0] - behind[0]) @ pressure + (ahead[1] - behind[1]) @ (1.0 - void)
            thinner = self.thickness(self.theta, *(direction * 1e6)) - 1.0
            stored = 2j * frequency * area * (1.0 - void) * np.repeat(thinner, self.along)
            sources.append(flow / 2e-6 - stored)
        poiseuille, couette = self._matrices(x, y)
        h = np.repeat(self.thickness(self.theta, x, y), self.along)
        content = sp.diags(2j * frequency * area * h) - couette  # per void fraction
        matrix = poiseuille @ sp.diags(full * 1.0) + content @ sp.diags(~full * 1.0)
        unknown = np.zeros((full.size, 2), dtype=complex)
        inner = sp.csc_array(sp.csr_array(matrix)[free][:, free])
        unknown[free] = splu(inner).solve(-np.array(sources).T[free])
        change = np.where(full[:, None], unknown, 0.0).reshape(*self.groove.shape, 2).sum(axis=1)
        normals = np.stack([np.cos(self.theta), np.sin(self.theta)])
        return self.weights * normals @ change

    def equilibrium(self, load, *, angles, eccentricities=(0.05, 0.99)):
        """Eccentricity ratio and attitude that carry `load` along x, by nested bisection.

        `angles`: attitudes [rad] between which the force's direction changes sign.
        """

        def attitude(eps):
            def across(angle):
                return float(self.force(eps * math.cos(angle), eps * math.sin(angle))[1])

            return root_scalar(across, bracket=angles, xtol=1e-9).root

        def missing(eps):
            angle = attitude(eps)
            return math.log(-self.force(eps * math.cos(angle), eps * math.sin(angle))[0] / load)

        eps = root_scalar(missing, bracket=eccentricities, xtol=1e-7).root
        return eps, attitude(eps)
