"""Stiffness with the temperature following the displacement, against equilibria at two loads."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from rotorsim.bearing.solve import solve_case
from rotorsim.model import (
    Bearing,
    Case,
    ExponentialViscosity,
    FilmSettings,
    Groove,
    LoadTarget,
    Lubricant,
    MeshSize,
    ThermalSettings,
    ViscosityResponse,
)

LOAD, SPEED, CLEARANCE = 10e3, 1500.0, 1e-4
QUARTER = math.pi / 2.0


def _case(load: float, response: ViscosityResponse) -> Case:
    grooves = tuple(Groove(center=side * QUARTER, extent=0.3) for side in (1.0, -1.0))
    return Case(
        bearing=Bearing(0.05, 0.08, CLEARANCE, grooves=grooves),
        lubricant=Lubricant(ExponentialViscosity(0.0277, 313.15, 0.034), 860.0, 2000.0, 0.13),
        film=FilmSettings(mesh=MeshSize(64, 12, 10, 4), viscosity_response=response),
        thermal=ThermalSettings(),
        target=LoadTarget(load),
    )


def _position(load: float) -> np.ndarray:
    point, _ = solve_case(_case(load, ViscosityResponse.FROZEN), SPEED)
    assert point.converged
    angle = point.attitude_angle
    return point.eccentricity_ratio * CLEARANCE * np.array([math.cos(angle), math.sin(angle)])


def test_following_stiffness_moves_the_journal_as_a_change_of_load_does():
    """Two equilibria differ by K^-1 times the difference of their loads, heat and all."""
    change = 4e-3 * LOAD
    moved = _position(LOAD + change / 2.0) - _position(LOAD - change / 2.0)
    point, _ = solve_case(_case(LOAD, ViscosityResponse.FOLLOWING), SPEED)
    frozen, _ = solve_case(_case(LOAD, ViscosityResponse.FROZEN), SPEED)
    wanted = np.linalg.solve(point.stiffness, [change, 0.0])
    without_heat = np.linalg.solve(frozen.stiffness, [change, 0.0])
    size = np.hypot(*moved)
    assert np.hypot(*(moved - wanted)) < 0.02 * size
    assert np.hypot(*(moved - without_heat)) > 0.04 * size  # the option matters


def test_following_changes_neither_equilibrium_nor_damping():
    point, _ = solve_case(_case(LOAD, ViscosityResponse.FOLLOWING), SPEED)
    frozen, _ = solve_case(_case(LOAD, ViscosityResponse.FROZEN), SPEED)
    assert point.load == pytest.approx(frozen.load, rel=1e-9)
    np.testing.assert_allclose(point.damping, frozen.damping, rtol=1e-9)


def test_isothermal_films_do_not_care():
    case = _case(LOAD, ViscosityResponse.FOLLOWING)
    case = replace(case, thermal=replace(case.thermal, model="isothermal"))
    point, _ = solve_case(case, SPEED)
    assert point.converged
