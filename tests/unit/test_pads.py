"""Pads, their inertia and their pivots."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pad_cases import SPEED, equal_pads, pad_case

from rotorsim.bearing.operating_point import point_from_dict, point_to_dict, strict_json
from rotorsim.bearing.solve import solve_case
from rotorsim.errors import InputError
from rotorsim.model import (
    Bearing,
    LinePivot,
    LoadTarget,
    Pad,
    SocketPivot,
    SpherePivot,
    SpringPivot,
    pad_inertia,
)
from rotorsim.status import SolveStatus


@pytest.mark.parametrize("offset", [0.3, 0.5, 0.65])
def test_inertia_of_an_annular_sector(offset: float):
    pad = Pad(0.7, math.radians(70.0), 0.02, offset=offset, density=7800.0)
    radius, length = 0.05, 0.06
    n = 400
    r = radius + 0.02 * (np.arange(n) + 0.5) / n
    phi = pad.arc * ((np.arange(n) + 0.5) / n - offset)
    y = length * ((np.arange(40) + 0.5) / 40 - 0.5)
    mass = 7800.0 * (r * 0.02 / n)[:, None] * (pad.arc / n) * length * np.ones(n)
    along, across = r[:, None] * np.cos(phi) - (radius + 0.02), r[:, None] * np.sin(phi)
    inertia = pad_inertia(pad, radius, length)
    assert inertia.mass == pytest.approx(mass.sum(), rel=1e-5)
    assert inertia.tilt == pytest.approx(np.sum(mass * (along**2 + across**2)), rel=1e-4)
    assert inertia.pitch == pytest.approx(
        np.sum(mass * along**2) + mass.sum() * np.mean(y**2), rel=1e-3
    )
    assert inertia.coupling == pytest.approx(np.sum(mass * across), rel=1e-4, abs=1e-7)


PIVOTS = {
    "stiffness": SpringPivot(3e8),
    "line": LinePivot(pad_radius=0.07, housing_radius=0.08, length=0.05),
    "sphere": SpherePivot(radius=0.05),
    "socket": SocketPivot(ball_radius=0.01, socket_radius=0.0105, housing_youngs_modulus=100e9),
}


@pytest.mark.parametrize("name", PIVOTS)
def test_pivots_force_and_deflection_agree(name: str):
    pivot = PIVOTS[name]
    for force in (1.0, 1e3, 2e4):
        deflection = pivot.deflection(force)
        assert pivot.force(deflection) == pytest.approx(force, rel=1e-10)
        slope = (pivot.force(deflection * 1.00001) - pivot.force(deflection * 0.99999)) / (
            2e-5 * deflection
        )
        assert pivot.stiffness_at(deflection) == pytest.approx(slope, rel=1e-6)
    assert pivot.force(-1e-6) == 0.0


def test_line_contact_is_kirk_and_reedys():
    force, length, housing, pad = 5000.0, 0.05, 0.16, 0.14
    pivot = LinePivot(pad_radius=pad / 2, housing_radius=housing / 2, length=length)
    modulus, ratio = 207e9, 0.3
    printed = (
        2.0 * force * (1.0 - ratio**2) / (math.pi * modulus * length)
        * (2.0 / 3.0 + math.log(4.0 * modulus * length * (housing - pad) / (2.15**2 * force)))
    )  # fmt: skip
    assert pivot.deflection(force) == pytest.approx(printed, rel=1e-3)


def test_sphere_on_plate_is_hertz():
    pivot = SpherePivot(radius=0.02, youngs_modulus=2e11, poisson_ratio=0.25)
    modulus = 2e11 / (2.0 * (1.0 - 0.25**2))
    expected = (9.0 * 1000.0**2 / (16.0 * modulus**2 * 0.02)) ** (1.0 / 3.0)
    assert pivot.deflection(1000.0) == pytest.approx(expected, rel=1e-12)


def test_pads_that_overlap_are_refused():
    with pytest.raises(InputError, match="follow one another"):
        Bearing(0.05, 0.04, 1e-4, pads=equal_pads(5, arc_deg=73.0))


def test_a_load_that_no_pivots_can_carry_is_told():
    pads = equal_pads(2, first_deg=70.0, arc_deg=100.0)
    point, _ = solve_case(pad_case(pads, LoadTarget(1000.0)), SPEED)
    assert point.status is SolveStatus.NO_EQUILIBRIUM
    assert "pivots" in point.message


def test_a_point_with_pads_survives_json():
    point, _ = solve_case(
        pad_case(equal_pads(pivot=SpringPivot(1e9)), LoadTarget(4000.0), mesh=(40, 8)), SPEED
    )
    import json

    again = point_from_dict(json.loads(strict_json(point_to_dict(point))))
    assert again.pads == point.pads
    assert again.coefficients_full is not None
    assert point.coefficients_full is not None
    assert again.coefficients_full.names == point.coefficients_full.names
    np.testing.assert_array_equal(again.coefficients_full.mass, point.coefficients_full.mass)
