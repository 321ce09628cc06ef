"""The force map: smooth, symmetric, and as exact as its grid."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from rotorsim.errors import InputError
from rotorsim.orbit import ShortBearingForce
from rotorsim.orbit.force_map import FilmMapForce, ForceMap
from rotorsim.orbit.kernels import short_bearing_impedance

SLENDERNESS = 0.25
SHORT = ForceMap.build(lambda eps, angle: short_bearing_impedance(eps, angle, SLENDERNESS))
CLOSED = ShortBearingForce(0.03, 0.025, 0.05, 1e-4)
MAPPED = FilmMapForce(SHORT, 0.03, 0.025, 0.05, 1e-4)


@pytest.mark.parametrize("eps", [0.0, 0.3, 0.9])
@pytest.mark.parametrize("angle", [0.0, 0.4, 1.6, 3.0, -1.5707, -2.5])
def test_closed_integrals_against_quadrature(eps, angle):
    def weight(t):
        return np.cos(t - angle) / (1.0 - eps * np.cos(t)) ** 3

    limits = (angle - np.pi / 2, angle + np.pi / 2)
    exact = [quad(lambda t, f=f: weight(t) * f(t), *limits, limit=200)[0] for f in (np.cos, np.sin)]
    found = short_bearing_impedance(eps, angle, np.sqrt(0.5))  # -2 (L/D)^2 = -1
    np.testing.assert_allclose(np.negative(found), exact, rtol=1e-8, atol=1e-9)


def test_map_equals_the_closed_form_to_half_a_permille_of_the_force():
    rng = np.random.default_rng(7)
    worst = 0.0
    for eps, angle in zip(
        0.95 * np.sqrt(rng.random(4000)), rng.uniform(-np.pi, np.pi, 4000), strict=True
    ):
        exact = np.array(short_bearing_impedance(eps, angle, SLENDERNESS))
        error = np.linalg.norm(np.array(SHORT.impedance(eps, angle)) - exact)
        worst = max(worst, float(error / np.linalg.norm(exact)))
    assert worst < 5e-4


@pytest.mark.parametrize("eps", [0.985, 0.99, 0.995, 0.999])
def test_map_near_the_bush_from_approaching_to_retreating(eps):
    """The force falls by up to five powers of ten between the two; the error by as many."""
    layer = np.sqrt(1.0 - eps**2) * np.linspace(-3.0, 3.0, 25)
    for angle in [*np.linspace(0.0, np.pi, 25), *(0.5 * np.pi + layer)]:
        exact = np.array(short_bearing_impedance(eps, angle, SLENDERNESS))
        error = np.linalg.norm(np.array(SHORT.impedance(eps, angle)) - exact)
        assert error < 3e-3 * np.linalg.norm(exact)


def test_past_the_last_row_the_force_grows_as_that_of_a_line_contact():
    last = np.array(SHORT.impedance(0.9995, 0.3))
    eps = 0.9999
    beyond = np.array(SHORT.impedance(eps, 0.3))
    growth = ((1.0 - 0.9995**2) / (1.0 - eps**2)) ** 1.5
    np.testing.assert_allclose(np.linalg.norm(beyond) / np.linalg.norm(last), growth, rtol=1e-2)


def test_map_converges_with_the_fourth_order():
    def worst(rows, columns):
        coarse = ForceMap.build(
            lambda eps, angle: short_bearing_impedance(eps, angle, SLENDERNESS),
            rows=rows,
            columns=columns,
            max_eccentricity_ratio=0.9,
        )
        points = [(e, a) for e in np.linspace(0.05, 0.8, 40) for a in np.linspace(0, 6.2, 50)]
        errors = []
        for e, a in points:
            exact = np.array(short_bearing_impedance(e, a, SLENDERNESS))
            errors.append(np.linalg.norm(coarse.impedance(e, a) - exact) / np.linalg.norm(exact))
        return max(errors)

    order = np.log2(worst(33, 96) / worst(65, 192))
    assert order == pytest.approx(4.0, abs=0.7)


def test_force_from_the_map_equals_the_closed_form_anywhere():
    rng = np.random.default_rng(3)
    for _ in range(300):
        x, y = rng.uniform(-6e-5, 6e-5, 2)
        vx, vy = rng.uniform(-0.1, 0.1, 2)
        exact = np.array(CLOSED.force(x, y, vx, vy, 800.0))
        np.testing.assert_allclose(
            MAPPED.force(x, y, vx, vy, 800.0), exact, atol=1e-3 * np.linalg.norm(exact)
        )


def test_force_is_smooth_through_the_centre():
    # a straight path through the centre: second differences stay those of a smooth function
    x = np.linspace(-2e-6, 2e-6, 401)
    force = np.array([MAPPED.force(s, 0.3 * s, 0.01, 0.0, 500.0) for s in x])
    second = np.abs(np.diff(force, 2, axis=0))
    assert second.max() < 20.0 * np.median(second, axis=0).max()
    assert second.max() < 1e-4 * np.ptp(force)


def test_whirl_at_half_speed_finds_no_film_force():
    # the film is at rest in the frame turning at half speed: the origin of half-speed whirl
    x, y, w = 3e-5, 1e-5, 900.0
    np.testing.assert_allclose(MAPPED.force(x, y, -0.5 * w * y, 0.5 * w * x, w), 0.0, atol=1e-9)
    np.testing.assert_allclose(CLOSED.force(x, y, -0.5 * w * y, 0.5 * w * x, w), 0.0, atol=1e-9)


def test_turning_the_whole_picture_turns_the_force():
    motion = np.array([[2e-5, 3e-5], [0.02, -0.01]])
    angle = 1.1
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    for force in (CLOSED, MAPPED):
        before = np.array(force.force(*motion.ravel(), 700.0))
        after = force.force(*(motion @ turn.T).ravel(), 700.0)
        np.testing.assert_allclose(after, turn @ before, rtol=1e-9)


def test_film_force_grows_without_bound_towards_the_wall():
    eps = np.array([0.97, 0.98, 0.99, 0.999])
    radial = np.array([SHORT.impedance(e, 0.0)[0] for e in eps])
    assert np.all(radial < 0.0)
    assert np.all(np.diff(radial) < 0.0)


def test_asymmetric_build_visits_the_whole_turn():
    seen = []

    def impedance(eps, angle):
        seen.append(angle)
        return short_bearing_impedance(eps, angle, SLENDERNESS)

    whole = ForceMap.build(impedance, rows=16, columns=32, symmetric=False)
    half = ForceMap.build(
        lambda e, a: short_bearing_impedance(e, a, SLENDERNESS), rows=16, columns=32
    )
    assert len(seen) == 16 * 32
    np.testing.assert_allclose(whole.coefficients, half.coefficients, atol=1e-10)


def test_progress_is_told_row_by_row():
    calls = []
    ForceMap.build(
        lambda e, a: short_bearing_impedance(e, a, SLENDERNESS),
        rows=16,
        columns=16,
        progress=lambda done, total: calls.append((done, total)),
    )
    assert calls == [(i + 1, 16) for i in range(16)]


@pytest.mark.parametrize(
    "options",
    [{"rows": 4}, {"columns": 33}, {"max_eccentricity_ratio": 1.0}, {"max_eccentricity_ratio": 0}],
)
def test_unusable_grids_are_refused(options):
    with pytest.raises(InputError):
        ForceMap.build(lambda e, a: short_bearing_impedance(e, a, SLENDERNESS), **options)


def test_a_film_that_fails_is_refused():
    with pytest.raises(InputError, match="finite"):
        ForceMap.build(lambda e, a: (float("nan"), 0.0))
