"""The turbocharger in a run-up: ring speeds by Petroff, oil whirl of inner and outer films."""

from __future__ import annotations

import math

import numpy as np
import pytest

import rotorsim as rs
from rotorsim.orbit.orbit import OrbitStatus
from rotorsim.orbit.spectrum import cascade, whirl_frequency_ratio
from rotorsim.show.figures import spectrum_cascade

pytestmark = pytest.mark.slow

RPM = math.pi / 30.0


@pytest.fixture(scope="module")
def machine():
    return rs.load_machine("machines/turbocharger")


@pytest.fixture(scope="module")
def motion(machine):
    found = rs.simulate(machine)
    assert found.status is OrbitStatus.COMPLETED
    return found


def _near(motion, rpm: float) -> slice:
    """Return twenty turns about a speed."""
    now = int(np.searchsorted(motion.speed, rpm * RPM))
    return slice(now - 640, now + 640)


def test_rings_that_do_not_whirl_turn_by_the_friction_of_centred_films(motion) -> None:
    inner, outer = (
        2.0 * math.pi * viscosity * (0.5 * diameter) ** 3 * length / clearance
        for viscosity, diameter, length, clearance in (
            (0.008, 0.008, 0.0065, 20e-6), (0.009, 0.014, 0.007, 40e-6),
        )
    )  # fmt: skip
    petroff = inner / (inner + outer)
    # I dw/dt = inner (shaft - w) - outer w lags behind a steady run-up
    time = 0.125 * 0.006 * (0.008**2 + 0.014**2) / (inner + outer)
    rise = (motion.speed[-1] - motion.speed[0]) / motion.t[-1]
    calm = _near(motion, 112_000.0)
    expected = petroff * (motion.speed[calm] - rise * time)
    for name in ("compressor end", "turbine end"):
        assert motion.ring_speed(name)[calm] == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("rpm", [50_000.0, 60_000.0])
def test_journals_whirl_in_their_rings_below_half_the_mean_speed(motion, rpm) -> None:
    at = _near(motion, rpm)
    for name in ("compressor end", "turbine end"):
        orbit = motion.orbit(name).part(at.start, at.stop)
        half = 0.5 * (1.0 + motion.ring_speed(name)[at].mean() / motion.speed[at].mean())
        assert 0.85 * half < whirl_frequency_ratio(orbit) < half
        assert 0.4 < np.hypot(orbit.x, orbit.y).max() / orbit.radial_clearance < 0.8


@pytest.mark.parametrize("rpm", [130_000.0, 145_000.0])
def test_a_ring_whirls_in_its_housing_with_half_its_own_speed(motion, rpm) -> None:
    at = _near(motion, rpm)
    orbit = motion.orbit("turbine end ring").part(at.start, at.stop)
    half = 0.5 * motion.ring_speed("turbine end")[at].mean() / motion.speed[at].mean()
    assert whirl_frequency_ratio(orbit) == pytest.approx(half, rel=0.04)
    assert np.hypot(orbit.x, orbit.y).max() > 0.5 * orbit.radial_clearance
    # the other film there is calm
    inner = motion.orbit("turbine end").part(at.start, at.stop)
    assert np.hypot(inner.x, inner.y).max() < 0.5 * inner.radial_clearance


def test_half_speeds_are_drawn_over_the_cascade(motion) -> None:
    half = 0.5 * motion.ring_speed("turbine end")
    rows = cascade(motion.orbit("turbine end ring"), 32)
    axes = spectrum_cascade(rows, lines={"half of ring": (motion.speed, half)}).axes[0]
    (line,) = (one for one in axes.lines if one.get_label() == "half of ring")
    hertz, rpm = line.get_data()
    assert hertz[-1] == pytest.approx(np.interp(rpm[-1] * RPM, motion.speed, half) / 2.0 / math.pi)
    with pytest.raises(rs.InputError, match="turbine end"):
        motion.ring_speed("nut")
