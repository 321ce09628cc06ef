"""Results in words: short numbers, and verdicts that say over which speeds they hold."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rotorsim.rows import RPM, number
from rotorsim.study.stability import StabilityCurve


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (2000.0, 3, "2000"),
        (18000.0, 4, "18000"),
        (999999.0, 4, "999999"),
        (1.0e6, 4, "1.000e+06"),
        (9999.7, 4, "10000"),
        (99.96, 3, "100"),
        (123.456, 4, "123.5"),
        (0.001234, 3, "0.00123"),
        (-18000.4, 4, "-18000"),
        (math.nan, 4, "-"),
    ],
)
def test_numbers_have_no_exponent_between_a_thousandth_and_a_million(value, digits, text):
    assert number(value, digits) == text


def curve(rates: list[float] | None, thresholds: tuple[float, ...] = ()) -> StabilityCurve:
    speed = np.array([1000.0, 2000.0, 3000.0]) / RPM
    eigenvalues = None if rates is None else -np.array(rates)[:, None] + 100.0j
    return StabilityCurve(
        choices={}, speed=speed, stability=np.array(["threshold"] * 3),
        critical_mass=speed, critical_mass_dimensionless=speed, whirl_frequency_ratio=speed,
        eigenvalues=eigenvalues, threshold_speeds=thresholds,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("rates", "crossed", "text", "over", "top"),
    [
        ([3.0, 2.0, 1.0], (), "none: stable, 1000 to 3000 rpm", "stable throughout", "stable"),
        ([-3.0, -2.0, -1.0], (), "none: unstable, 1000 to 3000 rpm", "unstable throughout",
         "unstable"),
        ([3.0, 1.0, -1.0], (2500.0 / RPM,), "2500", "changes", "unstable"),
        ([3.0, math.nan, 1.0], (), "none: stable at the 2 of 3 speeds known", None, "stable"),
        ([3.0, 2.0, math.nan], (), "none: stable at the 2 of 3 speeds known", None, None),
        ([3.0, math.nan, -1.0], (), "-", None, "unstable"),
        (None, (), "-", None, None),
    ],
)  # fmt: skip
def test_verdicts(rates, crossed, text, over, top):
    one = curve(rates, crossed)
    assert one.thresholds_text == text
    assert one.verdict_over_range == over
    assert one.verdict == top
