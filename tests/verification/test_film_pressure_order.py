"""Manufactured solutions of Dowson's equation: second order, viscosity varying in all directions.

The pressure p* is chosen; what its flow leaves in each cell (by Gauss's theorem, from first
derivatives alone) is handed to the solver as squeeze.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from film_cases import CLEARANCE, RADIUS, SPEED, VISCOSITY
from tolerances import ORDER

from rotorsim.film.geometry import film_geometry
from rotorsim.film.layers import layer_integrals
from rotorsim.film.mesh import build_mesh
from rotorsim.film.operator import face_topology, film_operator
from rotorsim.film.rupture import Terms, rupture_condition
from rotorsim.model import Bearing, Cavitation, FilmSettings, Inception, MeshSize

LENGTH = 0.08
SURFACE = SPEED * RADIUS
POSITION = (0.5 * CLEARANCE, 0.1 * CLEARANCE)
SCALE = 1e6
GAUSS = np.polynomial.legendre.leggauss(4)


class Manufactured:
    """p*, film thickness, and viscosity mu = mu0 m(theta, y)/(1 + a(theta) z)."""

    def __init__(self, inception: str, misalignment: tuple[float, float]) -> None:
        self.slot = inception == "max_film"
        self.misalignment = misalignment

    def pressure(self, t, y):
        wave, _ = self._wave(t)
        return SCALE * np.cos(math.pi * y / LENGTH) * wave * (1.0 + self._skew * y / LENGTH)

    def gradient(self, t, y):
        wave, slope = self._wave(t)
        arch = np.cos(math.pi * y / LENGTH)
        fall = -math.pi / LENGTH * np.sin(math.pi * y / LENGTH)
        skew = 1.0 + self._skew * y / LENGTH
        return (
            SCALE * arch * slope * skew / RADIUS,
            SCALE * wave * (fall * skew + arch * self._skew / LENGTH),
        )

    @property
    def _skew(self) -> float:
        """A half film is symmetric about its mid-plane."""
        return 0.3 if self.misalignment != (0.0, 0.0) else 0.0

    def _wave(self, t):
        if not self.slot:
            return 1 + 0.4 * np.cos(t) + 0.3 * np.sin(2 * t), -0.4 * np.sin(t) + 0.6 * np.cos(2 * t)
        lobe = 1.0 + np.cos(t)  # vanishes at the slot, at +-pi
        tail = 1.0 + 0.5 * np.sin(0.5 * t)
        return lobe * tail, -np.sin(t) * tail + lobe * 0.25 * np.cos(0.5 * t)

    def thickness(self, t, y):
        ex, ey = POSITION[0] + self.misalignment[0] * y, POSITION[1] + self.misalignment[1] * y
        return CLEARANCE - ex * np.cos(t) - ey * np.sin(t)

    def viscosity(self, t, y, z):
        return self._level(t, y) / (1.0 + self._bend(t) * z)

    def mobility(self, t, y):
        """F_2 and 1 - G, in closed form."""
        a = self._bend(t)
        g = (1 / 2 + a / 3) / (1 + a / 2)
        f2 = ((1 / 3 + a / 4) - g * (1 / 2 + a / 3)) / self._level(t, y)
        return f2, 1.0 - g

    @staticmethod
    def _level(t, y):
        return VISCOSITY * (1.0 + 0.3 * np.sin(t) * np.cos(2.0 * y / LENGTH))

    @staticmethod
    def _bend(t):
        return 0.8 + 0.4 * np.cos(t)

    def flux(self, t, y):
        """Volume flow per unit width around and along [m2/s]."""
        h, (f2, open_share) = self.thickness(t, y), self.mobility(t, y)
        px, py = self.gradient(t, y)
        return -(h**3) * f2 * px + SURFACE * h * open_share, -(h**3) * f2 * py


def left_over(exact: Manufactured, mesh) -> np.ndarray:
    """Net inflow of each cell [m3/s], by quadrature over its faces."""
    at, weight = 0.5 * (GAUSS[0] + 1.0), 0.5 * GAUSS[1]
    y = mesh.y_faces[:-1, None] + mesh.dy[:, None] * at  # (m, q)
    t = mesh.theta_faces[:-1, None] + np.diff(mesh.theta_faces)[:, None] * at  # (n, q)
    around = exact.flux(mesh.theta_faces[:, None, None], y[None])[0] @ weight * mesh.dy
    along = exact.flux(t[:, :, None], mesh.y_faces[None, None, :])[1]
    along = np.einsum("nqm,q->nm", along, weight) * mesh.dx[:, None]
    return around[:-1] - around[1:] + along[:, :-1] - along[:, 1:]


def solve(exact: Manufactured, level: int) -> float:
    """Largest error, relative to the largest pressure."""
    size = MeshSize(24 * 2**level, 8 * 2**level, 8 * 2**level, 4)
    settings = FilmSettings(
        inception=Inception.MAX_FILM if exact.slot else Inception.FREE, mesh=size
    )
    bearing = Bearing(RADIUS, LENGTH, CLEARANCE, misalignment=exact.misalignment)
    mesh = build_mesh(bearing, settings, POSITION)
    z = (np.arange(size.cross_film) + 0.5) / size.cross_film
    t, y = mesh.theta[:, None], mesh.y[None, :]
    viscosity = exact.viscosity(t[:, :, None], y[:, :, None], z)
    film = film_geometry(bearing, mesh).thickness(np.array(POSITION))
    topology = face_topology(mesh, np.zeros(1))
    operator = film_operator(topology, film, layer_integrals(viscosity), SURFACE)
    # continuity in a cell: inflow - squeeze*area = 0
    squeeze = left_over(exact, mesh) / operator.area
    condition = rupture_condition(Cavitation.FULL_SOMMERFELD)
    _, solved = condition.solve(operator, Terms(squeeze))
    wanted = exact.pressure(t, y)
    return float(np.abs(solved.pressure - wanted).max() / np.abs(wanted).max())


@pytest.mark.parametrize("inception", ["free", "max_film"])
@pytest.mark.parametrize("misalignment", [(0.0, 0.0), (1e-4, -2e-4)], ids=["half", "misaligned"])
def test_pressure_is_second_order(inception, misalignment):
    exact = Manufactured(inception, misalignment)
    errors = [solve(exact, level) for level in range(4)]
    order = math.log2(errors[-2] / errors[-1])
    assert order == pytest.approx(2.0, abs=ORDER)
    assert errors[-1] < 5e-4


def test_layer_integrals_are_second_order():
    """Against closed forms, for a viscosity that falls tenfold from one wall to the other."""
    a = 9.0
    g = (1 / 2 + a / 3) / (1 + a / 2)
    f2 = (1 / 3 + a / 4) - g * (1 / 2 + a / 3)
    errors = []
    for layers in (16, 32, 64):
        z = (np.arange(layers) + 0.5) / layers
        found = layer_integrals((1.0 / (1.0 + a * z)).reshape(1, 1, layers))
        assert found.f0[0, 0] == pytest.approx(1 + a / 2, rel=1e-12)  # exact for a line
        assert found.shear_share.sum() == pytest.approx(1.0 - found.g[0, 0], rel=1e-12)
        assert found.pressure_share.sum() == pytest.approx(-found.f2[0, 0], rel=1e-12)
        errors.append((abs(found.g[0, 0] - g), abs(found.f2[0, 0] - f2)))
    for coarse, fine in zip(errors[1], errors[2], strict=True):
        assert math.log2(coarse / fine) == pytest.approx(2.0, abs=ORDER)
    assert max(errors[-1]) < 1e-3


def test_layer_integrals_of_a_uniform_viscosity_are_reynolds_own():
    found = layer_integrals(np.full((1, 1, 7), VISCOSITY))
    assert found.f0[0, 0] == pytest.approx(1.0 / VISCOSITY, rel=1e-13)
    assert found.f2[0, 0] == pytest.approx(1.0 / (12.0 * VISCOSITY), rel=1e-12)
    assert found.g[0, 0] == pytest.approx(0.5, rel=1e-13)
