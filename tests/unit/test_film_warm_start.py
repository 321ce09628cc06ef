"""A neighbouring film's temperatures and full cells on another mesh."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from film_cases import split_grooves, thermal_case

from rotorsim.film.heat import Heat
from rotorsim.film.problem import film_problem
from rotorsim.film.solution import solve_film
from rotorsim.film.thd import TOLERANCE
from rotorsim.film.warm_start import WarmStart
from rotorsim.model import Bearing, LoadTarget, MeshSize
from rotorsim.status import SolveStatus

GROOVED = Bearing(0.05, 0.08, 100e-6, grooves=split_grooves())


def problem(mesh: MeshSize, position: tuple[float, float] = (0.0, 0.0)):
    case = thermal_case(0.5, bearing=GROOVED)
    case = dataclasses.replace(case, film=dataclasses.replace(case.film, mesh=mesh))
    return film_problem(case, 300.0, GROOVED, position)


def field(film) -> np.ndarray:
    """Smooth in each film, with a jump from one to the other, linear along and across."""
    mesh = film.mesh
    layers = film.settings.mesh.cross_film
    around = np.where(np.cos(mesh.theta) > 0.0, 300.0, 350.0) + 5.0 * np.sin(mesh.theta)
    across = (np.arange(layers) + 0.5) / layers
    return around[:, None, None] + 1e3 * mesh.y[:, None] + 10.0 * across


def warm(film) -> WarmStart:
    temperature = field(film)
    heat = Heat(temperature, temperature[:, :, 0], 320.0)
    return WarmStart((0.0, 0.0), heat, temperature[:, :, 0] > 330.0, film.mesh)


def test_temperatures_on_the_same_mesh_are_the_same_to_the_last_bit():
    film = problem(MeshSize(64, 16, 8, 4))
    again = problem(MeshSize(64, 16, 8, 4))
    known = warm(film)
    heat = known.heat_on(again)
    assert np.array_equal(heat.temperature, known.heat.temperature)
    assert np.array_equal(heat.bush, known.heat.bush)
    assert np.array_equal(known.full_on(again), known.full)


def test_each_film_between_grooves_keeps_its_own_temperatures():
    for position in ((40e-6, 20e-6), (-30e-6, 50e-6)):
        film = problem(MeshSize(160, 32, 16, 4), position)
        heat = warm(problem(MeshSize(80, 16, 8, 4))).heat_on(film)
        inside = film.mesh.region >= 0
        off = np.abs(heat.temperature - field(film))[inside][:, 1:-1, 1:-1]
        # a cell's length around, and no mean of 300 K and 350 K at the grooves
        assert off.max() < 5.0 * float(np.max(np.diff(film.mesh.theta_faces)))


def test_full_cells_follow_the_angle():
    film = problem(MeshSize(160, 32, 16, 4))
    full = warm(problem(MeshSize(80, 16, 8, 4))).full_on(film)
    wanted = field(film)[:, :, 0] > 330.0
    inside = film.mesh.region >= 0
    assert np.mean(full[inside] != wanted[inside]) < 0.02


@pytest.mark.slow
def test_a_film_found_from_a_coarser_mesh_is_that_found_without():
    case = thermal_case(LoadTarget(8e3), bearing=GROOVED, mesh=(96, 24, 10), inception="free")
    cold = solve_film(case, 400.0)
    position = (0.3 * math.cos(0.8), 0.3 * math.sin(0.8))
    elsewhere = solve_film(case, 400.0, initial=WarmStart(position))
    for solution in (cold, elsewhere):
        assert solution.status is SolveStatus.CONVERGED
    assert cold.iterations < elsewhere.iterations
    change = np.log(cold.thermal.viscosity / elsewhere.thermal.viscosity)
    assert np.abs(change[~cold.state.operator.fixed]).max() < 10.0 * TOLERANCE
    np.testing.assert_allclose(cold.state.displacement, elsewhere.state.displacement, rtol=1e-5)
