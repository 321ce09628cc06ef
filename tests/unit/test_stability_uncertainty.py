"""Tolerances carried through to thresholds."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from rotorsim.errors import InputError
from rotorsim.stability.uncertainty import Tolerance, propagate, sample_inputs

INPUTS = {
    "clearance": Tolerance(100.0, 10.0),
    "viscosity": Tolerance(1.0, 0.1, "normal"),
    "idle": Tolerance(0.0, 1.0),
}


def linear(inputs):
    return {"critical_mass": 3.0 * inputs["clearance"] + 50.0 * inputs["viscosity"], "none": None}


@pytest.mark.parametrize("method", ["sobol", "latin_hypercube"])
def test_samples_follow_their_distributions(method):
    samples = sample_inputs(INPUTS, 1024, method, seed=4)
    assert len(samples) == 1024
    clearance = np.array([s["clearance"] for s in samples])
    viscosity = np.array([s["viscosity"] for s in samples])
    assert 90.0 <= clearance.min() < 90.1
    assert 109.9 < clearance.max() <= 110.0
    assert clearance.std() == pytest.approx(20.0 / np.sqrt(12.0), rel=0.01)
    assert viscosity.mean() == pytest.approx(1.0, abs=1e-3)
    assert viscosity.std() == pytest.approx(0.1, rel=0.01)
    assert np.abs(viscosity - 1.0).max() <= 0.4
    assert sample_inputs(INPUTS, 1024, method, seed=4) == samples
    assert sample_inputs(INPUTS, 1024, method, seed=5) != samples


def test_linear_function_has_known_shares_of_variance():
    found = propagate(linear, INPUTS, 4096, seed=1)
    variance = {"clearance": 9.0 * 400.0 / 12.0, "viscosity": 2500.0 * 0.01, "idle": 0.0}
    total = sum(variance.values())
    share = found.first_order_index("critical_mass")
    for name, value in variance.items():
        assert share[name] == pytest.approx(value / total, abs=0.01)
    assert next(iter(share)) == "clearance"
    rank = found.importance("critical_mass")
    assert next(iter(rank)) == "clearance"
    assert rank["clearance"] > 0.9
    assert abs(rank["idle"]) < 0.05
    assert found.quantile("critical_mass", 0.5) == pytest.approx(350.0, abs=0.2)


def test_probability_of_instability():
    found = propagate(linear, {"clearance": INPUTS["clearance"], "viscosity": Tolerance(1.0, 1e-9)},
                      1024)  # fmt: skip
    p, error = found.probability_below("critical_mass", 335.0)  # clearance below 95 of 90 ... 110
    assert p == pytest.approx(0.25, abs=0.002)
    assert error == pytest.approx(np.sqrt(0.25 * 0.75 / 1024), rel=0.05)
    none, error = found.probability_below("critical_mass", 0.0)
    assert none == 0.0
    assert error > 0.0
    assert found.probability_below("none", 1.0)[0] == 0.0
    assert np.isnan(found.quantile("none")).all()
    assert set(found.importance("none").values()) == {0.0}


def fragile(inputs):
    if inputs["clearance"] < 95.0:
        raise ValueError("too tight")
    return linear(inputs)


def test_one_failure_costs_one_sample_on_any_executor():
    with ThreadPoolExecutor(2) as pool:
        found = propagate(fragile, INPUTS, 256, mapper=pool.map)
    assert 50 < len(found.failures) < 78
    assert found.failures[0][1] == "ValueError: too tight"
    failed = [i for i, _ in found.failures]
    assert np.isnan(found.outputs["critical_mass"][failed]).all()
    assert np.isfinite(np.delete(found.outputs["critical_mass"], failed)).all()
    assert found.probability_below("critical_mass", 1e9)[0] == 1.0


def test_bad_requests():
    with pytest.raises(InputError, match="spread"):
        Tolerance(1.0, 0.0)
    with pytest.raises(InputError, match="uniform or normal"):
        Tolerance(1.0, 1.0, "beta")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="tolerances"):
        sample_inputs({}, 8)
    with pytest.raises(InputError, match="count"):
        sample_inputs(INPUTS, 1)
    with pytest.raises(InputError, match="there are critical_mass"):
        propagate(linear, INPUTS, 8).quantile("speed")
