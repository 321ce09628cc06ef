"""Growth rates: the compiled quartic against the dense eigenvalue solver."""

import time

import numpy as np
import pytest

from rotorsim.errors import InputError
from rotorsim.machine.matrices import state_matrix
from rotorsim.machine.rates import eigenvalues, growth_rate_map

N = 20_000


def coefficients(kind):
    rng = np.random.default_rng(7)
    k, c = rng.standard_normal((2, N, 2, 2))
    mass = np.exp(rng.uniform(-3.0, 3.0, N))
    if kind != "any":
        k[:, 0, 0], k[:, 1, 1] = rng.uniform(1, 6, N), rng.uniform(1, 3, N)
        k[:, 0, 1], k[:, 1, 0] = rng.uniform(2, 10, N), rng.uniform(-6, 1, N)
        c = c @ c.transpose(0, 2, 1) + 0.5 * np.eye(2)
    spread = np.exp(rng.uniform(-25.0, -1.0, N))[:, None, None]
    if kind == "SI":
        k, c, mass = k * 1e8, c * 1e5, mass * 300.0
    elif kind == "light":
        mass *= 1e-4
    elif kind == "heavy":
        mass *= 1e6
    elif kind == "nearly alike modes":
        k = np.eye(2) + spread * rng.standard_normal((N, 2, 2))
        c = 0.3 * np.eye(2) + spread * rng.standard_normal((N, 2, 2))
    elif kind == "symmetric":
        k = 0.5 * (k + k.transpose(0, 2, 1))
    elif kind == "isotropic":
        k = k[:, :1, :1] * np.eye(2)
        c = c[:, :1, :1] * np.eye(2)
    elif kind == "isotropic whirl":
        k = np.stack([k[:, 0, 0], k[:, 0, 1], -k[:, 0, 1], k[:, 0, 0]], -1).reshape(-1, 2, 2)
        c = c[:, :1, :1] * np.eye(2)
    elif kind == "uncoupled":
        k, c = k * np.eye(2), c * np.eye(2)
    return k, c, mass


def growth_rates(stiffness, damping, mass):
    """Of each system (n, 2, 2) with its own mass (n,)."""
    systems = zip(stiffness, damping, mass, strict=True)
    return np.array([growth_rate_map(k, c, m)[0] for k, c, m in systems])


KINDS = ["any", "film", "SI", "light", "heavy", "nearly alike modes", "symmetric", "isotropic",
         "isotropic whirl", "uncoupled"]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_same_values_as_the_dense_solver(kind):
    k, c, mass = coefficients(kind)
    reference = np.linalg.eigvals(state_matrix(k, c, mass))
    error = np.abs(growth_rates(k, c, mass) - reference.real.max(axis=1))
    assert (error / np.abs(reference).max(axis=1)).max() < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["film", "light", "nearly alike modes"])
def test_relative_to_the_eigenvalue_itself_in_extended_precision(kind):
    k, c, mass = (v[:3000].astype(np.longdouble) for v in coefficients(kind))
    s = eigenvalues(*(np.asarray(v, float) for v in (k, c, mass))).astype(np.clongdouble)
    (kxx, kxy, kyx, kyy), (cxx, cxy, cyx, cyy) = (v.reshape(-1, 4).T[..., None] for v in (k, c))
    m = mass[:, None]
    for _ in range(6):
        a, b = (m * s + cxx) * s + kxx, (m * s + cyy) * s + kyy
        p, q = cxy * s + kxy, cyx * s + kyx
        slope = (2 * m * s + cxx) * b + a * (2 * m * s + cyy) - cxy * q - p * cyx
        s = s - (a * b - p * q) / slope
    leading = s[np.arange(len(s)), s.real.argmax(axis=1)]
    error = np.abs(growth_rates(*(v[:3000] for v in coefficients(kind))) - leading.real)
    if np.finfo(np.longdouble).eps < 1e-18:
        assert (error / np.abs(leading)).max() < 1e-10


def test_double_eigenvalues():
    # Critically damped, all four equal; and a defective pair, known to half the digits.
    one = np.eye(2)
    assert growth_rate_map(one, 2.0 * one, 1.0) == pytest.approx(-1.0, abs=1e-7)
    assert growth_rate_map([[1, 1], [0, 1]], 0.2 * one, 1.0) == pytest.approx(-0.1, abs=1e-7)
    assert growth_rate_map([[1, 0], [0, 0]], one, 1.0) == pytest.approx(0.0, abs=1e-15)


def test_map_is_every_point_with_every_mass():
    k, c, mass = coefficients("film")
    k, c, mass = k[:6].reshape(2, 3, 2, 2), c[:6].reshape(2, 3, 2, 2), mass[:5]
    k[1, 2, 0, 1] = np.nan
    rates = growth_rate_map(k, c, mass)
    assert rates.shape == (2, 3, 5)
    assert np.isnan(rates[1, 2]).all()
    expected = np.stack([growth_rate_map(k, c, one)[..., 0] for one in mass], axis=-1)
    assert np.array_equal(rates, expected, equal_nan=True)
    assert np.isfinite(rates[:1]).all()


@pytest.mark.parametrize("mass", [0.0, -1.0, np.nan, np.inf])
def test_bad_mass(mass):
    with pytest.raises(InputError, match="mass"):
        growth_rate_map(np.eye(2), np.eye(2), [1.0, mass])


def test_seven_times_faster_than_the_dense_solver():
    k, c, _ = coefficients("film")
    k, c, mass = k[:200], c[:200], np.geomspace(0.1, 10.0, 100)
    stack = state_matrix(k[:, None], c[:, None], mass)

    def best(work):
        times = []
        for _ in range(5):
            start = time.perf_counter()
            work()
            times.append(time.perf_counter() - start)
        return min(times)

    growth_rate_map(k, c, mass)  # loads the compiled kernel
    ratio = best(lambda: np.linalg.eigvals(stack)) / best(lambda: growth_rate_map(k, c, mass))
    assert ratio > 7.0
