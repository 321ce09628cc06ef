"""Pads and bores that give way: beams, rings and shells against closed forms, films with them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from film_cases import reference_rows
from pad_cases import equal_pads, pad_case

from rotorsim.bearing.solve import solve_case, solved_film
from rotorsim.film import bending
from rotorsim.film.bending import pad_bending
from rotorsim.film.elastic import elastic_bore
from rotorsim.film.geometry import CENTER, pad_unknowns
from rotorsim.film.layers import isoviscous_layers
from rotorsim.film.problem import film_problem, film_state
from rotorsim.model import (
    Bearing,
    Case,
    EccentricityTarget,
    ExponentialViscosity,
    FilmSettings,
    Groove,
    LoadTarget,
    Lubricant,
    MeshSize,
    Pad,
    SpringPivot,
    ThermalSettings,
)
from rotorsim.model.compliance import Diaphragm, ElasticLayer, ThinBush
from rotorsim.model.restrictors import Orifice
from rotorsim.model.settings import DeformationResponse

STEEL = 207e9
SOFT = 5e9


# -- pads ----------------------------------------------------------------------------------------
def test_a_nearly_flat_pad_is_a_cantilever_on_either_side():
    """Even load q: w = q L^4/(8 EI) + q L^2/(2 kGA), at the edge; two shapes leave 0.3 %."""
    radius, length, thickness, offset = 50.0, 0.07, 0.02, 0.6
    pad = Pad(0.0, 0.1 / radius, thickness, offset=offset, youngs_modulus=STEEL)
    inertia, area = length * thickness**3 / 12.0, length * thickness
    shear = 5.0 / 6.0 * STEEL / 2.6 * area
    for side, part in zip(pad_bending(pad, radius, length), (offset, 1.0 - offset), strict=True):
        reach = 0.1 * part
        springs, middle = side.stiffness, radius + 0.5 * thickness
        loads = side.mean(np.ones_like(side.points)) * abs(side.side) * middle  # of 1 N/m
        edge = float(side.at(np.array(side.side)) @ (loads / springs))
        reach *= middle / radius
        expected = reach**4 / (8.0 * STEEL * inertia) + reach**2 / (2.0 * shear)
        assert edge == pytest.approx(expected, rel=4e-3)
        assert side.at(np.array(-side.side)) == pytest.approx(0.0)


def test_bending_converges_in_second_order(monkeypatch):
    pad = Pad(0.0, math.radians(75.0), 0.02, youngs_modulus=STEEL)
    found = []
    for points in (20, 40, 80):
        monkeypatch.setattr(bending, "_POINTS", points)
        bending._modes.cache_clear()
        found.append(pad_bending(pad, 0.05, 0.07)[1].stiffness[0])
    bending._modes.cache_clear()
    order = math.log2((found[0] - found[1]) / (found[1] - found[2]))
    assert order == pytest.approx(2.0, abs=0.1)


def test_pads_bend_as_their_own_film_asks():
    """Deflection by all of f(a, b) under the film's pressure, against the four shapes'."""
    pads = tuple(
        replace(pad, youngs_modulus=SOFT) for pad in equal_pads(4, first_deg=45.0, arc_deg=70.0)
    )
    case = pad_case(pads, LoadTarget(2e3))
    film = solved_film(case, 300.0)
    assert film.status == "converged"
    mesh, q, state = film.problem.mesh, film.state.displacement, film.state
    columns = mesh.region == 0
    bends = list(pad_unknowns(film.problem.bearing)[1][0].bends)
    shapes = film.problem.geometry.displacements.shapes[bends][:, CENTER][:, columns, 0]
    line = 2.0 * (state.solution.pressure * state.operator.area).sum(axis=1)[columns]
    angle = mesh.theta[columns] - pads[0].pivot_angle
    wanted = np.zeros(angle.size)
    for side in pad_bending(pads[0], 0.05, 0.04):
        own = angle * side.side > 0.0
        away = np.abs(angle[own])
        wanted[own] = bending._compliance(away[:, None], away, *side.section) @ line[own]
    bent = q[bends] @ shapes
    assert bent.max() > 2e-6
    np.testing.assert_allclose(bent, wanted, atol=0.01 * wanted.max())


@pytest.mark.slow
def test_stiff_pads_do_not_bend_and_frozen_ones_keep_their_shape():
    pivot = SpringPivot(3e8)
    rigid = pad_case(equal_pads(4, first_deg=45.0, arc_deg=70.0, pivot=pivot), LoadTarget(2e3))

    def elastic(modulus: float, response: str):
        pads = tuple(replace(pad, youngs_modulus=modulus) for pad in rigid.bearing.pads)
        return replace(
            rigid,
            bearing=replace(rigid.bearing, pads=pads),
            film=replace(rigid.film, deformation_response=DeformationResponse(response)),
        )

    plain, _ = solve_case(rigid, 300.0)
    stiff, _ = solve_case(elastic(9e12, "following"), 300.0)
    assert plain.deformation_response is None
    np.testing.assert_allclose(stiff.stiffness, plain.stiffness, rtol=0.0, atol=2e-3 * 1e8)
    following, _ = solve_case(elastic(SOFT, "following"), 300.0)
    frozen, _ = solve_case(elastic(SOFT, "frozen"), 300.0)
    assert (following.deformation_response, frozen.deformation_response) == ("following", "frozen")
    assert following.deflection == frozen.deflection == max(p.deflection for p in frozen.pads)
    assert frozen.coefficients_full.names == plain.coefficients_full.names
    assert len(following.coefficients_full.names) == len(plain.coefficients_full.names) + 16
    assert following.stiffness[0, 0] < 0.99 * frozen.stiffness[0, 0]
    assert following.damping[0, 0] < 0.95 * frozen.damping[0, 0]
    assert np.linalg.eigvalsh(following.coefficients_full.mass[2:, 2:])[0] > 0.0


# -- bores ---------------------------------------------------------------------------------------
def _bore(compliance, *, mesh=(80, 16), grooves=(), **settings) -> Case:
    return Case(
        bearing=Bearing(0.05, 0.06, 100e-6, compliance=compliance, grooves=grooves),
        lubricant=Lubricant(ExponentialViscosity(0.02, 313.15, 0.0), 860.0, 2000.0, 0.13),
        film=FilmSettings(inception="free", mesh=MeshSize(*mesh, 8, 4), **settings),
        thermal=ThermalSettings(model="isothermal"),
        target=EccentricityTarget(0.6),
    )


LAYER = ElasticLayer(thickness=2e-3, youngs_modulus=1e9, poisson_ratio=0.4)


RECESSES = tuple(
    Groove(
        math.radians(a),
        math.radians(60.0),
        length=0.04,
        supply_pressure=3e6,
        restrictor=Orifice(1e-3),
    )
    for a in (0.0, 90.0, 180.0, 270.0)
)


@pytest.mark.slow
@pytest.mark.parametrize("cavitation", ["half_sommerfeld", "reynolds", "jfo"])
@pytest.mark.parametrize(
    ("compliance", "grooves"),
    [
        (LAYER, ()), (ThinBush(thickness=3e-3, stiffness=3e9), ()),
        (ThinBush(thickness=3e-3, stiffness=3e9), RECESSES),
    ],
    ids=["layer", "ring", "recesses"],
)  # fmt: skip
def test_stiffness_with_the_shape_following_equals_differences(compliance, grooves, cavitation):
    case = _bore(compliance, grooves=grooves, cavitation=cavitation)
    film = solved_film(case, 300.0)
    slowly = replace(case, film=replace(case.film, frequency_ratios=(1e-4,)))
    dynamics_point, _ = solve_case(slowly, 300.0)
    slow = dynamics_point.frequency_coefficients.stiffness[0]
    problem, q, layers = film.problem, film.state.displacement, film.state.layers
    step, columns = 1e-8, []
    for axis in np.eye(2):
        ahead, behind = (film_state(problem, q + s * step * axis, layers).force for s in (1, -1))
        columns.append((behind - ahead) / (2.0 * step))
    turn = np.array(
        [
            [math.cos(film.frame), -math.sin(film.frame)],
            [math.sin(film.frame), math.cos(film.frame)],
        ]
    )
    differences = turn @ np.stack(columns, axis=1) @ turn.T
    np.testing.assert_allclose(slow, differences, atol=1e-4 * np.abs(differences).max())


def test_a_bore_deflects_by_its_own_pressure():
    film = solved_film(_bore(LAYER), 300.0)
    state = film.state
    expected = LAYER.deflection * state.solution.pressure
    np.testing.assert_allclose(state.deflection[CENTER], expected, atol=1e-14)
    assert LAYER.deflection == pytest.approx(2e-3 * 1.4 * 0.2 / 0.6 / 1e9)
    stiff = replace(LAYER, youngs_modulus=9e12)
    rigid, _ = solve_case(_bore(None), 300.0)
    nearly, _ = solve_case(_bore(stiff), 300.0)
    np.testing.assert_allclose(nearly.stiffness, rigid.stiffness, rtol=1e-3)
    assert nearly.deformation_response == "following"
    assert rigid.deflection is None


@pytest.mark.parametrize("wave", [0, 1, 2, 3, 5])
def test_a_ring_on_springs_bends_as_timoshenko_has_it(wave):
    bush = ThinBush(thickness=2e-3, stiffness=2e9)
    problem = film_problem(_bore(bush, mesh=(160, 8)), 300.0, _bore(bush).bearing, (0.0, 0.0))
    ring = elastic_bore(problem.bearing, problem.mesh)
    around = np.cos(wave * problem.mesh.theta)
    deflection = ring.compliance(np.tile(1e6 * around[:, None], (1, problem.mesh.shape[1])))
    radius, outer = 0.051, 0.052
    springs = 2e9 / (2.0 * math.pi * outer * 0.06) * outer / radius
    own = 207e9 * 2e-3**3 / 12.0 * (wave**2 - 1.0) ** 2 / radius**4
    if wave == 0:
        own = 207e9 * 2e-3 / radius**2
    expected = 1e6 * 0.05 / radius / (springs + own)
    np.testing.assert_allclose(deflection[:, 0], expected * around, atol=1e-3 * expected)


@pytest.mark.slow
def test_a_long_flat_shell_is_a_strip_built_in_on_both_sides():
    """w = p (b^2/4 - y^2)^2/(24 D) across its width b, far from its ends; none beyond them."""
    wide, thickness, radius = 0.02, 2e-3, 2.0
    shell = Diaphragm(start=-0.03, extent=0.06, width=wide, thickness=thickness)
    groove = Groove(math.pi, 2.0 * math.pi - 0.08)
    bearing = Bearing(radius, 0.022, 100e-6, (groove,), compliance=shell)
    case = replace(_bore(None, mesh=(120, 44)), bearing=bearing)
    mesh = film_problem(case, 300.0, bearing, (0.0, 0.0)).mesh
    deflection = elastic_bore(bearing, mesh).compliance(np.full(mesh.shape, 1e5))
    theta = (mesh.theta + math.pi) % (2.0 * math.pi) - math.pi
    middle, y = np.argmin(np.abs(theta)), mesh.y
    rigidity = STEEL * thickness**3 / 12.0 / (1.0 - 0.09)
    expected = 1e5 * np.maximum(0.25 * wide**2 - y**2, 0.0) ** 2 / (24.0 * rigidity)
    np.testing.assert_allclose(deflection[middle], expected, atol=0.01 * expected.max())
    beyond = (np.abs(theta) > 0.034) & (mesh.supply[:, 0] < 0)
    assert beyond.any()
    assert np.abs(deflection[beyond]).max() == 0.0


def _freund(mesh: tuple[int, int]):
    """Journal of 200 mm at an eccentricity ratio of 0.3 towards 180 deg."""
    shell = Diaphragm(
        start=0.0, extent=math.radians(132.0), width=0.128, width_at_end=0.015, thickness=1e-3,
        youngs_modulus=200e9,
    )  # fmt: skip
    case = _bore(shell)
    bearing = Bearing(0.1, 0.2, 150e-6, (Groove(0.0, 0.01),), compliance=shell)
    case = replace(case, bearing=bearing, film=replace(case.film, mesh=MeshSize(*mesh, 8, 4)))
    problem = film_problem(case, 280.0, bearing, (-45e-6, 0.0))
    layers = isoviscous_layers(problem.mesh.shape, 0.00929)
    return problem, film_state(problem, [-45e-6, 0.0], layers)


def test_diaphragm_of_freund():
    """His sides run together, from 128 mm at the free edge to 15 mm."""
    rows = reference_rows("freund1995_elastic_diaphragm.csv")
    problem, state = _freund((96, 24))
    assert state.solution.converged
    theta = np.degrees(problem.mesh.theta) % 360.0
    order = np.argsort(theta)
    at = [row["phi_deg"] for row in rows]
    pressure = np.interp(at, theta[order], state.solution.pressure[order, 0]) / 1e3
    known = np.array([row["p_kPa"] for row in rows])
    assert np.abs(pressure - known).mean() < 0.06 * known.max()
    known = np.array([row["w_um"] for row in rows])
    bent = np.interp(at, theta[order], state.deflection[CENTER][order, 0]) * 1e6
    off = np.abs(bent - known)[~np.isnan(known)]
    assert off.mean() < 0.07 * np.nanmax(known)
