"""Conduction in the bush and in pads against exact three-dimensional solutions: second order.

T = [a I_n(s r) + b K_n(s r)] cos(n theta) cos(s y) solves Laplace's equation; s and b/a follow from
convection at the end and on the outer surface.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import iv, ivp, kv, kvp
from tolerances import ORDER

from rotorsim.film.bush import _bush_operator

RADII, LENGTH = (0.05, 0.075), 0.08


def _uneven(count: int) -> np.ndarray:
    even = np.linspace(-math.pi, math.pi, count + 1)
    return even + 0.3 * np.sin(even)


def solve(
    around: float, transfer: float, conductivity: float, level: int, edge: float | None = None
):
    """Largest errors of the bore and of the field, relative to the bore's largest value.

    `edge`: half the angle of a pad; `around` then fits convection at its edges.
    """
    half = 0.5 * LENGTH
    wave = brentq(
        lambda s: s * math.tan(s * half) - transfer / conductivity, 1e-9, 0.4999 * math.pi / half
    )
    r1, r2 = RADII
    biot = transfer / conductivity
    # k T' + h T = 0 outside fixes the share of K_n.
    share = -(wave * ivp(around, wave * r2) + biot * iv(around, wave * r2)) / (
        wave * kvp(around, wave * r2) + biot * kv(around, wave * r2)
    )

    def rise(r):
        return iv(around, wave * r) + share * kv(around, wave * r)

    slope = wave * (ivp(around, wave * r1) + share * kvp(around, wave * r1))
    theta_faces, layers = _uneven(16 * 2**level), 4 * 2**level
    if edge is not None:
        theta_faces = edge / math.pi * theta_faces
    y_faces = np.linspace(0.0, half, 4 * 2**level + 1)
    theta = 0.5 * (theta_faces[1:] + theta_faces[:-1])
    y = 0.5 * (y_faces[1:] + y_faces[:-1])
    pattern = np.cos(around * theta)[:, None] * np.cos(wave * y)
    operator = _bush_operator(
        theta_faces, y_faces, RADII, layers, conductivity,
        outer_transfer=transfer, end_transfer=(0.0, transfer),
        edge_transfer=None if edge is None else transfer,
    )  # fmt: skip
    flux = -conductivity * slope * pattern
    scale = abs(rise(r1))
    bore = np.abs(operator.bore_rise(flux) - rise(r1) * pattern).max() / scale
    faces = np.linspace(r1, r2, layers + 1)
    inside = rise(0.5 * (faces[1:] + faces[:-1]))
    field = np.abs(operator.field(flux) - pattern[:, :, None] * inside).max() / scale
    return bore, field


@pytest.mark.parametrize("around", [0, 1, 3])
@pytest.mark.parametrize(("transfer", "conductivity"), [(80.0, 250.0), (5000.0, 40.0)])
def test_bush_is_second_order(around, transfer, conductivity):
    errors = [solve(around, transfer, conductivity, level) for level in range(4)]
    for coarse, fine in zip(errors[-2], errors[-1], strict=True):
        assert math.log2(coarse / fine) == pytest.approx(2.0, abs=ORDER)
    assert max(errors[-1]) < 5e-3


@pytest.mark.parametrize(("transfer", "conductivity"), [(80.0, 250.0), (5000.0, 40.0)])
def test_pad_is_second_order(transfer, conductivity):
    edge = math.radians(30.0)
    at_edge = transfer * 0.5 * sum(RADII) / conductivity
    around = brentq(lambda n: n * math.tan(n * edge) - at_edge, 1e-9, 0.4999 * math.pi / edge)
    errors = [solve(around, transfer, conductivity, level, edge) for level in range(4)]
    for coarse, fine in zip(errors[-2], errors[-1], strict=True):
        assert math.log2(coarse / fine) == pytest.approx(2.0, abs=ORDER)
    assert max(errors[-1]) < 5e-3


def test_surroundings_take_what_the_film_gives():
    """A uniform flux, ends insulated: T = q r1 [ln(r2/r)/k + 1/(h r2)], the textbook's cylinder."""
    conductivity, transfer, flux = 40.0, 80.0, 1000.0
    operator = _bush_operator(
        _uneven(24), np.linspace(0.0, 0.04, 5), RADII, 64, conductivity,
        outer_transfer=transfer, end_transfer=(0.0, 0.0),
    )  # fmt: skip
    found = operator.bore_rise(np.full((24, 4), flux))
    r1, r2 = RADII
    wanted = flux * r1 * (math.log(r2 / r1) / conductivity + 1.0 / (transfer * r2))
    np.testing.assert_allclose(found, wanted, rtol=1e-5)


def test_robin_exchange_is_the_flux_it_implies():
    """The bore found from a reference temperature and a conductance answers its own flux."""
    rng = np.random.default_rng(3)
    operator = _bush_operator(
        _uneven(24), np.linspace(-0.04, 0.04, 9), RADII, 6, 250.0,
        outer_transfer=80.0, end_transfer=(80.0, 80.0),
    )  # fmt: skip
    reference, conductance = rng.uniform(0.0, 40.0, (24, 8)), 3000.0
    bore = operator.robin_rise(reference, conductance)
    flux = conductance * (reference - bore)
    np.testing.assert_allclose(operator.bore_rise(flux), bore, rtol=1e-9, atol=1e-9)
