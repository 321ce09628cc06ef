"""Manufactured solutions of the energy march, with flows known in closed form.

Two films, both exact in the discrete fluxes: a long converging and diverging one (Sommerfeld's
flow, with oil moving across the film), and a concentric one with a harmonic pressure
(oil leaving along the axis).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from film_cases import CLEARANCE, RADIUS, SPEED, VISCOSITY
from tolerances import ORDER

from rotorsim.film.energy import EnergyProblem, WallTemperatures, march
from rotorsim.film.flow import FilmFlow
from rotorsim.film.layers import layer_integrals

LENGTH, SURFACE = 0.08, SPEED * RADIUS
CAPACITY, CONDUCTIVITY = 860.0 * 2000.0, 0.13
BASE, RISE = 313.15, 20.0


def exact_temperature(t, y, z):
    return BASE + RISE * (1.0 - z) * (1.0 + 1.5 * z) * _spread(t, y)[0]


def _spread(t, y):
    """Q(theta, y) and its derivatives by theta and y."""
    wave, along = np.sin(t + 0.4), np.cos(2.0 * y / LENGTH)
    slope = -2.0 / LENGTH * np.sin(2.0 * y / LENGTH)
    return (
        1.0 + 0.5 * wave * along,
        0.5 * np.cos(t + 0.4) * along + 0.0 * y,
        0.5 * wave * slope,
    )


def _gradients(t, y, z):
    """T_x, T_y, T_z, T_zz."""
    q, q_t, q_y = _spread(t, y)
    shape, bend = (1.0 - z) * (1.0 + 1.5 * z), 0.5 - 3.0 * z
    return (
        RISE * shape * q_t / RADIUS,
        RISE * shape * q_y,
        RISE * bend * q,
        RISE * -3.0 * q,
    )


@dataclass(frozen=True)
class LongFilm:
    """h = c (1 - eps cos theta), flow U h0/2 everywhere, no axial flow, no reverse flow."""

    eccentricity: float = 0.25

    def thickness(self, t):
        return CLEARANCE * (1.0 - self.eccentricity * np.cos(t))

    @property
    def _level(self):
        e2 = self.eccentricity**2
        return CLEARANCE * 2.0 * (1.0 - e2) / (2.0 + e2)

    def poiseuille(self, t, y):
        """h^3 dp/dx and h^3 dp/dy."""
        around = 6.0 * VISCOSITY * SURFACE * (self.thickness(t) - self._level)
        return around + 0.0 * y, 0.0 * t * y

    def velocity(self, t, y, z):
        """h u, h v and the flux across the film."""
        h = self.thickness(t)
        slope = CLEARANCE * self.eccentricity * np.sin(t) / RADIUS
        hu = SURFACE * (h * z + 3.0 * (h - self._level) * z * (z - 1.0))
        return hu, 0.0 * hu, -SURFACE * slope * (z**3 - z**2)


@dataclass(frozen=True)
class DrainingFilm:
    """Concentric, p = P (x^2 - y^2)/(2 R^2): oil enters at the slot and leaves at the end."""

    strength: float = 1.0e5

    def thickness(self, t):
        return CLEARANCE + 0.0 * t

    def poiseuille(self, t, y):
        scale = CLEARANCE**3 * self.strength / RADIUS**2
        return scale * RADIUS * t + 0.0 * y, -scale * y + 0.0 * t

    def velocity(self, t, y, z):
        around, along = self.poiseuille(t, y)
        shape = z * (z - 1.0) / (2.0 * VISCOSITY)
        return SURFACE * CLEARANCE * z + around * shape, along * shape, 0.0 * t * y * z


def build(film, level: int):
    """The march's problem, and everything that goes with it."""
    n, m, k = 24 * 2**level, 4 * 2**level, 8 * 2**level
    # Uneven on purpose.
    even = np.linspace(-math.pi, math.pi, n + 1)
    faces = even + 0.25 * np.sin(even)
    y_faces = 0.5 * LENGTH * np.linspace(0.0, 1.0, m + 1)
    t, y = 0.5 * (faces[1:] + faces[:-1]), 0.5 * (y_faces[1:] + y_faces[:-1])
    z = (np.arange(k) + 0.5) / k
    dx, dy = RADIUS * np.diff(faces), np.diff(y_faces)
    area = dx[:, None] * dy
    interior = np.ones((4, n, m), dtype=bool)
    interior[0, 0], interior[1, -1], interior[2, :, 0], interior[3, :, -1] = (False,) * 4
    poiseuille = np.empty((4, n, m))
    around = film.poiseuille(faces[:, None], y[None])[0] * dy
    along = film.poiseuille(t[:, None], y_faces[None])[1] * dx[:, None]
    poiseuille[0], poiseuille[1], poiseuille[2], poiseuille[3] = (
        around[:-1],
        around[1:],
        along[:, :-1],
        along[:, 1:],
    )
    h_faces = film.thickness(faces)[:, None]
    couette = SURFACE * np.stack([h_faces[:-1] * dy, h_faces[1:] * dy])
    inlet = np.zeros((n, m), dtype=bool)
    inlet[0] = True
    viscosity = np.full((n, m, k), VISCOSITY)
    flow = FilmFlow(
        step=np.zeros((4, n, m)), poiseuille=poiseuille, couette=couette, shared=interior,
        inlet=inlet,
        flux=np.zeros((4, n, m)), liquid_fraction=np.ones((n, m)), fresh_fraction=np.ones((n, m)),
    )  # fmt: skip
    problem = EnergyProblem(
        flow=flow, layers=layer_integrals(viscosity), heating=np.zeros((4, n, m)),
        carry_over=np.where(inlet, 0.0, 1.0),
        conductance=CONDUCTIVITY * area / film.thickness(t)[:, None] * k, heat_capacity=CAPACITY,
        order=np.arange(n), axial_order=np.arange(m), fixed=np.zeros((n, m), dtype=bool),
        interior=interior, dx=dx, dy=dy,
    )  # fmt: skip
    t, y = t[:, None, None], y[None, :, None]
    t_x, t_y, t_z, t_zz = _gradients(t, y, z)
    hu, hv, across = film.velocity(t, y, z)
    source = CAPACITY * (hu * t_x + hv * t_y + across * t_z)
    source = (source - CONDUCTIVITY / film.thickness(t) * t_zz) * area[:, :, None] / k
    entering = np.empty((4, n, m, k))
    entering[:] = exact_temperature(faces[:-1, None, None], y, z)
    walls = WallTemperatures(exact_temperature(t, y, 0.0)[:, :, 0], BASE)
    return problem, viscosity, walls, entering, source, exact_temperature(t, y, z)


def solve(film, level: int, passes: int = 1) -> tuple[float, float]:
    """Mean error everywhere and largest error a quarter turn behind the inlet, relative."""
    problem, viscosity, walls, entering, source, wanted = build(film, level)
    found = np.full_like(wanted, BASE)
    march(problem, viscosity, walls, entering, found, passes=passes, source=source)
    error = np.abs(found - wanted) / RISE
    behind = slice(wanted.shape[0] // 4, None)
    return float(error.mean()), float(error[behind].max())


@pytest.mark.parametrize("film", [LongFilm(), DrainingFilm()], ids=["long", "draining"])
def test_march_is_second_order(film):
    """Beyond the first cell, whose outflow is first order and whose error is not carried on."""
    errors = [solve(film, level) for level in range(4)]
    for coarse, fine in zip(errors[-2], errors[-1], strict=True):
        assert math.log2(coarse / fine) == pytest.approx(2.0, abs=ORDER)
    assert errors[-1][0] < 2e-4
    assert errors[-1][1] < 1e-3


@pytest.mark.parametrize("film", [LongFilm(), DrainingFilm()], ids=["long", "draining"])
def test_one_pass_is_exact_where_nothing_flows_back(film):
    problem, viscosity, walls, entering, source, wanted = build(film, 1)
    found = np.full_like(wanted, BASE)
    _, leaving = march(problem, viscosity, walls, entering, found, passes=1, source=source)
    change, _ = march(
        problem, viscosity, walls, entering, found, passes=1, source=source, leaving=leaving
    )
    assert change < 1e-9 * RISE


def test_uniform_temperature_stays_uniform():
    """Oil entering at the walls' temperature without dissipation or source: nothing happens."""
    for film in (LongFilm(), DrainingFilm()):
        problem, viscosity, walls, entering, _, wanted = build(film, 1)
        same = WallTemperatures(np.full_like(walls.bush, BASE), BASE)
        found = np.full_like(wanted, BASE + 5.0)
        march(problem, viscosity, same, np.full_like(entering, BASE), found)
        np.testing.assert_allclose(found, BASE, atol=1e-8)
