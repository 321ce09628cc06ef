"""Thresholds against Ocvirk's closed form and Lund & Thomsen's tabulated coefficients."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from rotorsim.bearing.whirl import rigid_threshold, rigid_thresholds
from rotorsim.status import Stability

DATA = Path(__file__).parents[1] / "data"


def rows(name):
    lines = [line for line in (DATA / name).read_text().splitlines() if not line.startswith("#")]
    return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(lines)]


def ocvirk(eps):
    """K c/W and C c omega/W of the short bearing, half-Sommerfeld, load frame (Friswell et al.)."""
    e2 = eps * eps
    h0 = 1.0 / (math.pi**2 * (1.0 - e2) + 16.0 * e2) ** 1.5
    root = math.sqrt(1.0 - e2)
    auu = h0 * 4.0 * (math.pi**2 * (2.0 - e2) + 16.0 * e2)
    auv = h0 * math.pi * (math.pi**2 * (1.0 - e2) ** 2 - 16.0 * e2 * e2) / (eps * root)
    avu = -h0 * math.pi * (
        math.pi**2 * (1.0 - e2) * (1.0 + 2.0 * e2) + 32.0 * e2 * (1.0 + e2)
    ) / (eps * root)  # fmt: skip
    avv = h0 * 4.0 * (
        math.pi**2 * (1.0 + 2.0 * e2) + 32.0 * e2 * (1.0 + e2) / (1.0 - e2)
    )  # fmt: skip
    buu = h0 * 2.0 * math.pi * root * (math.pi**2 * (1.0 + 2.0 * e2) - 16.0 * e2) / eps
    buv = -h0 * 8.0 * (math.pi**2 * (1.0 + 2.0 * e2) - 16.0 * e2)
    bvv = h0 * 2.0 * math.pi * (math.pi**2 * (1.0 - e2) ** 2 + 48.0 * e2) / (eps * root)
    return np.array([[avv, -avu], [-auv, auu]]), np.array([[bvv, -buv], [-buv, buu]])


def test_against_ocvirk_short_bearing():
    table = rows("ocvirk_short_bearing.csv")
    assert len(table) == 29
    for row in table:
        k, c = ocvirk(row["eps"])
        listed_k = [[row["avv"], -row["avu"]], [-row["auv"], row["auu"]]]
        listed_c = [[row["bvv"], -row["buv"]], [-row["buv"], row["buu"]]]
        assert np.allclose(k, listed_k, rtol=3e-5, atol=1e-6), row["eps"]
        assert np.allclose(c, listed_c, rtol=3e-5, atol=1e-6), row["eps"]
        found = rigid_threshold(k, c, speed=1.0, load=1.0, radial_clearance=1.0)
        if math.isnan(row["mc"]):
            assert found.stability is Stability.ALWAYS_STABLE
            assert found.critical_mass is None
        else:
            assert found.whirl_frequency_ratio == pytest.approx(row["WFR"], abs=6e-6)
            # Seven figures in the pole at eps = 0.757 are as many as the file gives.
            assert found.critical_mass_dimensionless == pytest.approx(row["mc"], rel=2e-6)


def test_ocvirk_limit_of_small_eccentricity():
    eps = np.array([1e-2, 1e-3, 1e-4])
    k, c = (np.array(v) for v in zip(*(ocvirk(e) for e in eps), strict=True))
    found = rigid_thresholds(k, c, 1.0)
    ratio_error = found.whirl_frequency_ratio - 0.5
    mass_error = found.critical_mass - 24.0 / math.pi
    assert abs(ratio_error[-1]) < 1e-8
    assert abs(mass_error[-1]) < 1e-6
    # Both errors fall with the square of the eccentricity.
    assert np.log10(np.abs(ratio_error[0] / ratio_error[1])) == pytest.approx(2.0, abs=0.01)
    assert np.log10(np.abs(mass_error[0] / mass_error[1])) == pytest.approx(2.0, abs=0.01)


def test_against_lund_thomsen_1978_derived_thresholds():
    table = rows("lund_thomsen1978_two_axial_groove.csv")
    assert len(table) == 16
    for row in table:
        k = [[row["Kxx"], row["Kxy"]], [row["Kyx"], row["Kyy"]]]
        c = [[row["Bxx"], row["Bxy"]], [row["Byx"], row["Byy"]]]
        found = rigid_threshold(k, c, speed=1.0)
        if math.isnan(row["mc"]):
            assert found.stability is Stability.ALWAYS_STABLE
            assert found.critical_mass is None
        else:
            assert found.whirl_frequency_ratio == pytest.approx(row["WFR"], abs=5.1e-5)
            assert found.critical_mass == pytest.approx(row["mc"], abs=5.1e-5)
            assert math.sqrt(found.critical_mass) == pytest.approx(row["ws"], abs=5.1e-5)
