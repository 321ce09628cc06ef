"""Tolerances carried through to thresholds."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from rotorsim.errors import InputError
from rotorsim.machine.uncertainty import SampleError, Tolerance, _sample_inputs, propagate

INPUTS = {
    "clearance": Tolerance(100.0, 10.0),
    "viscosity": Tolerance(1.0, 0.1, "normal"),
    "idle": Tolerance(0.0, 1.0),
}


def linear(inputs):
    return {"critical_mass": 3.0 * inputs["clearance"] + 50.0 * inputs["viscosity"], "none": None}


def test_samples_follow_their_distributions():
    samples = _sample_inputs(INPUTS, 1024, seed=4)
    assert len(samples) == 1024
    clearance = np.array([s["clearance"] for s in samples])
    viscosity = np.array([s["viscosity"] for s in samples])
    assert 90.0 <= clearance.min() < 90.1
    assert 109.9 < clearance.max() <= 110.0
    assert clearance.std() == pytest.approx(20.0 / np.sqrt(12.0), rel=0.01)
    assert viscosity.mean() == pytest.approx(1.0, abs=1e-3)
    assert viscosity.std() == pytest.approx(0.1, rel=0.01)
    assert np.abs(viscosity - 1.0).max() <= 0.4
    assert _sample_inputs(INPUTS, 1024, seed=4) == samples
    assert _sample_inputs(INPUTS, 1024, seed=5) != samples


@pytest.mark.parametrize(("count", "tolerance"), [(64, 0.03), (4096, 0.005)])
@pytest.mark.parametrize("seed", range(4))
def test_linear_function_has_known_shares_of_variance(count, tolerance, seed):
    found = propagate(linear, INPUTS, count, seed=seed)
    variance = {"clearance": 9.0 * 400.0 / 12.0, "viscosity": 2500.0 * 0.01, "idle": 0.0}
    total = sum(variance.values())
    share = found.first_order_index("critical_mass")
    for name, value in variance.items():
        assert share[name] == pytest.approx(value / total, abs=tolerance)
    assert next(iter(share)) == "clearance"
    assert found.explained_variance("critical_mass") == pytest.approx(1.0)
    rank = found.importance("critical_mass")
    assert next(iter(rank)) == "clearance"
    assert rank["clearance"] > 0.9
    assert abs(rank["idle"]) < (0.05 if count > 64 else 0.2)
    assert found.quantile("critical_mass", 0.5) == pytest.approx(350.0, abs=200.0 / count)


def bent(inputs):
    a, b, c = inputs["a"], inputs["b"], inputs["c"]
    return {"y": np.exp(0.8 * a) + 0.5 * b + 0.2 * a * b + 0.1 * c**2}


def test_bent_function_has_its_sobol_indices_from_64_samples():
    # Inputs uniform within -1 and 1, c normal: every part's variance in closed form.
    inputs = {
        "a": Tolerance(0.0, 1.0), "b": Tolerance(0.0, 1.0), "c": Tolerance(0.0, 1.0, "normal"),
        "idle": Tolerance(0.0, 1.0),
    }  # fmt: skip
    variance = {
        "a": np.sinh(1.6) / 1.6 - (np.sinh(0.8) / 0.8) ** 2,
        "b": 0.25 / 3.0,
        "c": 0.02,
        "idle": 0.0,
    }
    together = 0.04 / 9.0
    total = sum(variance.values()) + together
    every = [propagate(bent, inputs, 64, seed=seed) for seed in range(16)]
    shares = [found.first_order_index("y") for found in every]
    for name, value in variance.items():
        found = np.array([share[name] for share in shares])
        # No bias, and little scatter.
        assert found.mean() == pytest.approx(value / total, abs=0.01)
        assert found.std() < 0.05
    explained = np.mean([found.explained_variance("y") for found in every])
    assert explained == pytest.approx(1.0 - together / total, abs=0.01)


def test_too_few_samples_have_no_shares():
    many = {f"i{k}": Tolerance(0.0, 1.0) for k in range(8)}
    found = propagate(lambda s: {"y": s["i0"]}, many, 8)
    assert np.isnan(list(found.first_order_index("y").values())).all()
    assert np.isnan(found.explained_variance("y"))


def test_probability_of_instability():
    found = propagate(linear, {"clearance": INPUTS["clearance"], "viscosity": Tolerance(1.0, 1e-9)},
                      1024)  # fmt: skip
    p, error = found.probability_above("critical_mass", 365.0)  # clearance above 105 of 90 ... 110
    assert p == pytest.approx(0.25, abs=0.002)
    assert error == pytest.approx(np.sqrt(0.25 * 0.75 / 1024), rel=0.05)
    none, error = found.probability_above("critical_mass", 1e9)
    assert none == 0.0
    assert error > 0.0
    assert found.probability_above("none", 1.0)[0] == 0.0
    assert np.isnan(found.quantile("none")).all()
    assert set(found.importance("none").values()) == {0.0}


def fragile(inputs):
    if inputs["clearance"] < 95.0:
        raise ValueError("too tight")
    return linear(inputs)


def silent(inputs):
    if inputs["clearance"] < 95.0:
        raise SampleError("no film at 95 um")
    return linear(inputs)


def test_a_sample_without_a_result_is_said_in_its_own_words():
    assert propagate(silent, INPUTS, 16).failures[0][1] == "no film at 95 um"


def test_one_failure_costs_one_sample_on_any_executor():
    with ThreadPoolExecutor(2) as pool:
        found = propagate(fragile, INPUTS, 256, mapper=pool.map)
    assert 50 < len(found.failures) < 78
    assert found.failures[0][1] == "ValueError: too tight"
    failed = [i for i, _ in found.failures]
    assert np.isnan(found.outputs["critical_mass"][failed]).all()
    assert np.isfinite(np.delete(found.outputs["critical_mass"], failed)).all()
    assert found.probability_above("critical_mass", 0.0)[0] == 1.0


def test_bad_requests():
    with pytest.raises(InputError, match="spread"):
        Tolerance(1.0, 0.0)
    with pytest.raises(InputError, match="uniform or normal"):
        Tolerance(1.0, 1.0, "beta")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="tolerances"):
        _sample_inputs({}, 8)
    with pytest.raises(InputError, match="count"):
        _sample_inputs(INPUTS, 1)
    with pytest.raises(InputError, match="there are critical_mass"):
        propagate(linear, INPUTS, 8).quantile("speed")
