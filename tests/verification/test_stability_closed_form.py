"""The closed form of the critical mass against the eigenvalues, over random coefficients."""

import numpy as np
import pytest
from closed_forms import flexible_critical_mass
from scipy.optimize import brentq

from rotorsim.bearing.whirl import (
    rigid_threshold,
    rigid_thresholds,
    routh_coefficients,
)
from rotorsim.errors import InputError
from rotorsim.machine.matrices import first_order, state_matrix
from rotorsim.status import Stability

SAMPLES = 20_000


def random_coefficients(kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients of many kinds: like a film, any sign at all, badly scaled, symmetric damping."""
    rng = np.random.default_rng(20240607)
    k = rng.standard_normal((SAMPLES, 2, 2))
    c = rng.standard_normal((SAMPLES, 2, 2))
    if kind == "film":
        k[:, 0, 0] = rng.uniform(1.0, 6.0, SAMPLES)
        k[:, 1, 1] = rng.uniform(1.0, 3.0, SAMPLES)
        k[:, 0, 1] = rng.uniform(2.0, 10.0, SAMPLES)
        k[:, 1, 0] = rng.uniform(-6.0, 1.0, SAMPLES)
        root = rng.standard_normal((SAMPLES, 2, 2))
        c = root @ root.transpose(0, 2, 1) + 0.5 * np.eye(2)
    elif kind == "scaled":
        k *= 10.0 ** rng.uniform(4, 10, (SAMPLES, 1, 1))
        c = c * 10.0 ** rng.uniform(1, 7, (SAMPLES, 1, 1))
    elif kind == "indefinite damping":
        c[:, 0, 0], c[:, 1, 1] = np.abs(c[:, 0, 0]), np.abs(c[:, 1, 1])
        c[:, 0, 1] = c[:, 1, 0] = 2.0 + np.abs(c[:, 0, 1])
        k[:, 0, 0], k[:, 1, 1] = 3.0 + np.abs(k[:, 0, 0]), 3.0 + np.abs(k[:, 1, 1])
    return k, c


KINDS = ["film", "any", "scaled", "indefinite damping"]


@pytest.mark.parametrize("kind", KINDS)
def test_a_pair_of_eigenvalues_crosses_at_the_critical_mass(kind):
    k, c = random_coefficients(kind)
    found = rigid_thresholds(k, c, 7.0)
    at = np.isfinite(found.critical_mass)
    assert at.sum() > 50
    mass, whirl = found.critical_mass[at], found.whirl_frequency[at]
    # In the time unit of the whirl, so that the eigenvalue in question is +-i.
    values = np.linalg.eigvals(
        state_matrix(
            k[at] / (mass * whirl**2)[:, None, None], c[at] / (mass * whirl)[:, None, None], 1.0
        )
    )
    scale = np.abs(values).max(axis=1)
    nearest = np.abs(values - 1j).min(axis=1) / scale
    # One in a thousand lies next to a double eigenvalue, where eigenvalues know half the digits.
    assert np.quantile(nearest, 0.99) < 1e-12
    assert nearest.max() < 1e-7
    assert np.allclose(found.whirl_frequency_ratio[at], whirl / 7.0, rtol=1e-15)


@pytest.mark.parametrize("kind", KINDS)
def test_verdicts_agree_with_eigenvalues_on_both_sides(kind):
    k, c = random_coefficients(kind)
    found = rigid_thresholds(k, c, 1.0)
    typical = np.abs(np.linalg.det(c)) / np.abs(np.trace(k, axis1=1, axis2=2))
    for factor in (1e-3, 0.2, 0.99, 1.01, 5.0, 1e3):
        mass = factor * np.where(np.isfinite(found.critical_mass), found.critical_mass, typical)
        values = np.linalg.eigvals(state_matrix(k, c, mass))
        rate = values.real.max(axis=1)
        clear = np.abs(rate) > 1e-9 * np.abs(values).max(axis=1)
        assert clear.mean() > 0.7
        stable = np.select(
            [found.stability == s for s in Stability],
            [factor < 1.0, True, False, factor > 1.0],
        ).astype(bool)
        assert np.array_equal(stable[clear], (rate < 0.0)[clear])
        assert np.array_equal(routh_coefficients(k, c).stable(mass)[clear], (rate < 0.0)[clear])


def test_critical_mass_agrees_with_a_root_search_on_eigenvalues():
    k, c = random_coefficients("film")
    found = rigid_thresholds(k, c, 1.0)
    rows = np.flatnonzero(found.stability == Stability.THRESHOLD)[:150]
    worst = 0.0
    for i in rows:
        ki, ci = k[i], c[i]

        def rate(log_mass, ki=ki, ci=ci):
            return np.linalg.eigvals(state_matrix(ki, ci, np.exp(log_mass))).real.max()

        expected = np.log(found.critical_mass[i])
        searched = brentq(rate, expected - 1.0, expected + 1.3, xtol=1e-15, rtol=1e-14)
        worst = max(worst, abs(np.expm1(searched - expected)))
    assert len(rows) == 150
    assert worst < 1e-10


def test_every_kind_of_verdict_occurs():
    seen = {
        str(v) for kind in KINDS for v in rigid_thresholds(*random_coefficients(kind), 1).stability
    }
    assert seen == {str(s) for s in Stability}


@pytest.mark.parametrize(
    ("stiffness", "damping", "expected"),
    [
        (np.eye(2), np.eye(2), Stability.ALWAYS_STABLE),
        (np.eye(2), np.zeros((2, 2)), Stability.ALWAYS_UNSTABLE),  # marginal: never decays
        (np.eye(2), -np.eye(2), Stability.ALWAYS_UNSTABLE),
        (np.diag([1.0, -1.0]), np.eye(2), Stability.ALWAYS_UNSTABLE),  # static divergence
        ([[1.0, 2.0], [2.0, 1.0]], np.eye(2), Stability.ALWAYS_UNSTABLE),  # det K < 0
        ([[0.0, 5.0], [-5.0, 0.0]], np.eye(2), Stability.ALWAYS_UNSTABLE),  # K_e = 0
        ([[1.0, 5.0], [-5.0, 1.0]], np.eye(2), Stability.THRESHOLD),
        (np.diag([1.0, 2.0]), [[1.0, 3.0], [3.0, 1.0]], Stability.REVERSED_THRESHOLD),
        (np.diag([1.0, 2.0]), np.diag([1.0, 0.0]), Stability.ALWAYS_UNSTABLE),  # one undamped
        (np.diag([1.0, 2.0]), [[1.0, 1.0], [1.0, 1.0]], Stability.ALWAYS_STABLE),  # det C = 0
    ],
)
def test_special_cases(stiffness, damping, expected):
    found = rigid_threshold(stiffness, damping, speed=10.0)
    assert found.stability is expected
    has_mass = expected in (Stability.THRESHOLD, Stability.REVERSED_THRESHOLD)
    assert (found.critical_mass is not None) == has_mass
    assert (found.whirl_frequency_ratio is not None) == has_mass


def test_dimensionless_mass_and_missing_coefficients():
    found = rigid_threshold([[1, 5], [-5, 1]], np.eye(2), 10.0, load=2.0, radial_clearance=0.5)
    assert found.critical_mass_dimensionless == pytest.approx(0.04 * 0.5 * 100.0 / 2.0, rel=1e-14)
    assert rigid_threshold([[1, 5], [-5, 1]], np.eye(2), 10.0).critical_mass_dimensionless is None
    k = np.stack([np.eye(2), np.full((2, 2), np.nan)])
    assert list(rigid_thresholds(k, np.eye(2), 1.0).stability) == ["always_stable", ""]
    with pytest.raises(InputError, match="stiffness"):
        rigid_threshold(k[1], np.eye(2), 1.0)
    with pytest.raises(InputError, match="speed"):
        rigid_threshold(k[0], np.eye(2), 0.0)


def jeffcott_matrix(k, c, disc_mass, shaft_stiffness):
    """Disc on a flexible shaft, massless journals: (disc x, y, journal x, y, disc vx, vy)."""
    eye, zero = np.eye(2), np.zeros((2, 2))
    ks = shaft_stiffness * eye
    return np.block(
        [
            [zero, zero, eye],
            [np.linalg.solve(c, ks), -np.linalg.solve(c, ks + k), zero],
            [-ks / disc_mass, ks / disc_mass, zero],
        ]
    )


def test_flexible_shaft_lowers_the_critical_mass_as_the_closed_form_says():
    k, c = np.array([[2.0, 5.0], [-3.0, 1.5]]), np.array([[4.0, 0.5], [0.5, 3.0]])
    rigid = rigid_threshold(k, c, 1.0)
    masses = flexible_critical_mass(k, c, np.array([np.inf, 1e9, 100.0, 10.0, 1.0, 0.1]))
    assert masses[0] == pytest.approx(rigid.critical_mass, rel=1e-14)
    assert np.all(np.diff(masses) < 0.0)
    for mass, ks in zip(masses[2:], (100.0, 10.0, 1.0, 0.1), strict=True):
        a = jeffcott_matrix(k, c, mass, ks)
        values = np.linalg.eigvals(a)
        assert np.abs(values - 1j * rigid.whirl_frequency).min() < 1e-11
        assert values.real.max() < 1e-11


def test_second_order_matrix_is_the_rigid_rotor():
    k, c = np.array([[2.0, 5.0], [-3.0, 1.5]]), np.array([[4.0, 0.5], [0.5, 3.0]])
    full = first_order(3.0 * np.eye(2), c, k)[0]
    assert np.allclose(full, state_matrix(k, c, 3.0), rtol=1e-15, atol=0.0)
    with pytest.raises(InputError, match="mass"):
        state_matrix(k, c, -1.0)


def test_rounding_errors_of_a_film_without_direct_stiffness_make_no_critical_mass():
    """Full Sommerfeld: K_xx = K_yy = 0 but for rounding, so that no mass is stable."""
    rng = np.random.default_rng(3)
    cross = np.array([[0.0, 1.0], [-1.0, 0.0]])
    stiffness = 5e8 * (cross + 1e-14 * rng.standard_normal((200, 2, 2)))
    damping = 1e6 * (np.eye(2) + 1e-14 * rng.standard_normal((200, 2, 2)))
    found = rigid_thresholds(stiffness, damping, 1000.0)
    assert set(found.stability.tolist()) == {"always_unstable"}
    assert np.isnan(found.critical_mass).all()
    assert not routh_coefficients(stiffness, damping).stable(1e-12).any()
    small = rigid_thresholds(5e8 * (cross + 1e-6 * np.eye(2)), 1e6 * np.eye(2), 1000.0)
    assert small.stability == "threshold"
