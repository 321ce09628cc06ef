"""The mass-conserving film against a second method (`tests/film_mass_conserving.py`)."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rotorsim.film.solution import solve_film
from rotorsim.model import (
    Bearing,
    Case,
    Cavitation,
    ExponentialViscosity,
    FilmSettings,
    Groove,
    Inception,
    LoadTarget,
    Lubricant,
    MeshSize,
    ThermalModel,
    ThermalSettings,
)
from rotorsim.status import SolveStatus
from tests.film_mass_conserving import MassConservingFilm

RADIUS, CLEARANCE, VISCOSITY, SPEED = 0.05, 100e-6, 0.0277, 100.0 * math.pi
UNIT = 6.0 * VISCOSITY * SPEED * RADIUS**4 / CLEARANCE**2
"""Force of the second method's films [N]."""


def grooved(
    target, *, center: float, extent: float, supply: float = 0.0, share=None, mesh=(96, 16)
):
    """Mass-conserving film, L/D = 1, one groove (degrees, Pa)."""
    length = None if share is None else share * 2.0 * RADIUS
    groove = Groove(math.radians(center), math.radians(extent), length, supply)
    return Case(
        bearing=Bearing(RADIUS, 2.0 * RADIUS, CLEARANCE, grooves=(groove,)),
        lubricant=Lubricant(ExponentialViscosity(VISCOSITY, 313.15, 0.0), 860.0, 2000.0, 0.13),
        film=FilmSettings(Cavitation.JFO, Inception.FREE, MeshSize(*mesh)),
        thermal=ThermalSettings(model=ThermalModel.ISOTHERMAL),
        target=target,
    )


def second_method(*, center: float, extent: float, supply: float = 0.0, share: float = 1.0, **mesh):
    pressure = supply * CLEARANCE**2 / (6.0 * VISCOSITY * SPEED * RADIUS**2)
    return MassConservingFilm(
        1.0, math.radians(center), math.radians(extent), share, pressure, **mesh
    )


@pytest.mark.slow
def test_equilibrium_with_a_groove_ahead_of_the_load():
    solution = solve_film(grooved(LoadTarget(20e3), center=45.0, extent=20.0), SPEED)
    assert solution.status is SolveStatus.CONVERGED
    x, y = solution.state.displacement / CLEARANCE
    film = second_method(center=45.0, extent=20.0)
    bracket = math.radians(12.0), math.radians(32.0)
    eccentricity, attitude = film.equilibrium(
        20e3 / UNIT, angles=bracket, eccentricities=(0.6, 0.8)
    )
    assert math.hypot(x, y) == pytest.approx(eccentricity, rel=1e-3)
    assert math.atan2(y, x) == pytest.approx(attitude, abs=math.radians(0.05))


@pytest.mark.slow
@pytest.mark.parametrize("supply", [0.0, 100e3])
def test_equilibria_with_a_groove_anywhere_but_under_the_load(supply):
    """The position found carries the load in the second method as well."""
    for center in range(15, 360, 15):
        groove = {"center": center, "extent": 20.0, "supply": supply}
        solution = solve_film(grooved(LoadTarget(20e3), **groove), SPEED)
        assert solution.status is SolveStatus.CONVERGED, center
        # next to the load line the film is short and thin: equal cells need to be many
        around = 432 if center in (15, 345) else 144
        film = second_method(**groove, around=around, along=8)
        force = film.force(*solution.state.displacement / CLEARANCE)
        assert force * UNIT == pytest.approx([-20e3, 0.0], abs=0.03 * 20e3), center


@pytest.mark.slow
def test_no_equilibrium_with_a_groove_under_the_load():
    """No position is found, and the second method's force points beside the groove everywhere."""
    solution = solve_film(grooved(LoadTarget(20e3), center=0.0, extent=20.0), SPEED)
    assert solution.status is SolveStatus.NO_EQUILIBRIUM
    film = second_method(center=0.0, extent=20.0, along=6)
    for eccentricity in (0.3, 0.8, 0.95):
        for attitude in np.radians(np.arange(-90.0, 91.0, 15.0)):
            force = film.force(*(eccentricity * np.array([math.cos(attitude), math.sin(attitude)])))
            if math.hypot(*force) > 1e-6:
                assert abs(math.atan2(-force[1], -force[0])) > math.radians(10.0)
