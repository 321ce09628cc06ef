"""Vertical machines: no static load, the journal in the centre or where no force acts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scenario_texts import BEARING, CONSTANT_OIL

import rotorsim as rs
from rotorsim.errors import InputError
from rotorsim.files.scenario import Scenario

FREE = 'inception = "free"\ncavitation = "{}"'
FULL = FREE.format("full_sommerfeld")


def scenario(target: str, film: str = FULL, bearing: str = "") -> Scenario:
    return Scenario.from_text(
        f"{BEARING}{bearing}\n{CONSTANT_OIL}\n[film]\n{film}\n"
        "mesh = { circumferential = 96, axial = 24 }\n"
        f'[operating]\nspeed = "3000 rpm"\n{target}\n'
    )


@pytest.mark.parametrize("target", ['load = "0 N"', "eccentricity_ratio = 0"])
def test_centred_plain_film_has_the_coefficients_of_theory(target: str) -> None:
    point = rs.solve(scenario(target))
    assert point.converged, point.message
    assert (point.eccentricity_ratio, point.load, point.attitude_angle) == (0.0, 0.0, 0.0)
    cross = point.damping[0, 0] * point.speed / 2.0  # the film turns at half the shaft's speed
    np.testing.assert_allclose(point.stiffness / cross, [[0, 1], [-1, 0]], atol=2e-4)
    np.testing.assert_allclose(point.damping / point.damping[0, 0], np.eye(2), atol=1e-9)
    # the shear of the gap: 2 pi mu R^2 L omega/c times R
    petroff = 2.0 * math.pi * 0.0277 * 0.05**2 * 0.08 * point.speed / 1e-4
    assert point.friction_force == pytest.approx(petroff, rel=1e-6)
    assert point.stability == "always_unstable"


def test_centred_film_is_the_limit_of_a_light_load() -> None:
    centred, light = (rs.solve(scenario(f"eccentricity_ratio = {e}")) for e in (0, 1e-4))
    np.testing.assert_allclose(
        centred.stiffness, light.stiffness, atol=2e-4 * abs(light.stiffness).max()
    )
    np.testing.assert_allclose(centred.damping, light.damping, atol=2e-4 * light.damping.max())


@pytest.mark.parametrize("profile", ["elliptical", "three_lobe", "offset_halves"])
def test_symmetric_lobes_hold_the_journal_in_the_centre(profile: str) -> None:
    bore = f'profile = "{profile}"\npreload = 0.5'
    point = rs.solve(scenario('load = "0 N"', FREE.format("reynolds"), bore))
    assert point.converged, point.message
    assert point.eccentricity_ratio < 1e-6
    assert point.load == 0.0
    light = rs.solve(scenario('load = "1 N"', FREE.format("reynolds"), bore))
    np.testing.assert_allclose(
        point.stiffness, light.stiffness, atol=2e-3 * abs(light.stiffness).max()
    )


def test_one_loaded_groove_pushes_the_journal_until_no_force_is_left() -> None:
    groove = '[[bearing.groove]]\ncenter = "0 deg"\nextent = "20 deg"\nlength = "40 mm"\n'
    groove += 'supply_pressure = "100 kPa"\n'
    point = rs.solve(scenario('load = "0 N"', FREE.format("reynolds"), groove))
    assert point.converged, point.message
    assert point.eccentricity_ratio > 0.0
    assert point.load == 0.0


@pytest.mark.parametrize("cavitation", ["reynolds", "half_sommerfeld", "jfo"])
def test_ruptured_centred_film_is_refused_with_what_to_write(cavitation: str) -> None:
    with pytest.raises(InputError, match=r"operating\.load: .*eccentricity_ratio = 0\.001"):
        scenario('load = "0 N"', FREE.format(cavitation))


def test_centre_of_a_lobed_bore_is_refused_with_what_to_write() -> None:
    with pytest.raises(InputError, match=r'operating\.eccentricity_ratio: .*load = "0 N"'):
        scenario("eccentricity_ratio = 0", FULL, 'profile = "elliptical"\npreload = 0.5')
