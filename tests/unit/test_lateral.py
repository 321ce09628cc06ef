"""Lateral analysis against closed forms: a Jeffcott rotor on one stiffness, numbers by hand."""

import math

import numpy as np
import pytest

from rotorsim.bearing.drawing import STANDARD_GRAVITY
from rotorsim.errors import InputError
from rotorsim.machine.critical_map import critical_speed_map, principal_stiffness
from rotorsim.machine.destabilising import decrement_curve
from rotorsim.machine.lateral import (
    _clearance_checks,
    _margin_check,
    _probe_check,
    _residual_unbalance,
    _scale_factor,
    _stability_checks,
    _vibration_limit,
    required_margin,
    separation_margin,
    unbalance_cases,
)
from rotorsim.machine.machine import Machine
from rotorsim.machine.modes import modes
from rotorsim.machine.peaks import Peak, _find_peaks, node_at, probe_responses, response_speeds
from rotorsim.machine.response import unbalance_response
from rotorsim.machine.statics import reactions_by_statics, weight
from rotorsim.machine.support import ConstantSupport, Pedestal
from rotorsim.machine.thresholds import critical_speeds
from rotorsim.model.machine import Clearance, Probe
from rotorsim.model.shaft import Disc, Section
from rotorsim.rotor import Beam, Rotor, beam_rotor, with_unbalance
from rotorsim.rows import RPM

M, K, EDITION = 50.0, 4e6, "an edition"
NATURAL = math.sqrt(K / M)


def jeffcott(ratio: float) -> Machine:
    """A mass on an isotropic spring and damper: the Jeffcott rotor's equations."""
    rotor = Rotor.rigid(M, unbalance=1e-4)
    return Machine(rotor, [(0, ConstantSupport(K, 2.0 * ratio * math.sqrt(K * M)))])


def exact(ratio: float):
    """Peak, half-power speeds of r^2/sqrt((1 - r^2)^2 + (2 ratio r)^2), r the speed ratio."""
    half = 1.0 - 2.0 * ratio**2
    top = half**-0.5  # r of the peak
    height = 1.0 / (2.0 * ratio * math.sqrt(1.0 - ratio**2))
    # r^4 = h^2/2 ((1 - r^2)^2 + 4 ratio^2 r^2) is quadratic in r^2.
    level = 0.5 * height**2
    roots = np.sort(np.roots([level - 1.0, -2.0 * level * half, level]).real)
    return top, height, np.sqrt(roots)


@pytest.mark.parametrize("ratio", [0.3, 0.05, 1e-3])
def test_amplification_factor_of_a_jeffcott_rotor(ratio):
    machine = jeffcott(ratio)
    found = modes(machine, np.linspace(0.2, 4.0, 40) * NATURAL)
    speeds = response_speeds(machine, 0.2 * NATURAL, 4.0 * NATURAL, found)
    response = unbalance_response(machine, speeds)

    def amplitude(speed):
        return float(abs(unbalance_response(machine, speed).probe(0, 0.4)[0]))

    (peak,) = _find_peaks(amplitude, speeds, np.abs(response.probe(0, 0.4)))
    top, height, (low, high) = exact(ratio)
    assert peak.speed == pytest.approx(top * NATURAL, rel=1e-6)
    assert peak.amplitude == pytest.approx(1e-4 / M * height, rel=1e-9)
    assert [peak.lower, peak.upper] == pytest.approx([low * NATURAL, high * NATURAL], rel=1e-7)
    assert peak.amplification_factor == pytest.approx(top / (high - low), rel=1e-4)
    if ratio < 0.01:
        assert peak.amplification_factor == pytest.approx(1.0 / (2.0 * ratio), rel=1e-4)


def test_a_peak_without_its_half_power_points_says_so():
    machine = jeffcott(0.3)
    speeds = np.linspace(0.9, 1.4, 100) * NATURAL
    response = unbalance_response(machine, speeds)

    def amplitude(speed):
        return float(abs(unbalance_response(machine, speed).probe(0, 0.0)[0]))

    (peak,) = _find_peaks(amplitude, speeds, np.abs(response.probe(0, 0.0)))
    assert peak.lower is None
    assert peak.upper is None
    assert peak.amplification_factor is None
    assert "above the peak within the speeds" in peak.note
    check = _margin_check(peak, "probe", (500.0, 600.0), EDITION)
    assert check.passed is None
    assert check.note == peak.note


def beam_machine(stiffness: float = 2e7, unbalance: float = 2e-4) -> Machine:
    beam = Beam((Section(1.2, 0.06),), (Disc(0.6, 30.0, 0.3, 0.16, "disc"),))
    rotor = with_unbalance(beam_rotor(beam, [0.1, 1.1, 0.3]), [(0.6, unbalance, 0.5)])
    support = ConstantSupport(stiffness, 3e4)
    return Machine(rotor, [(node_at(rotor, 0.1), support), (node_at(rotor, 1.1), support)])


def test_isotropic_machine_looks_the_same_at_every_probe():
    machine = beam_machine()
    speeds = response_speeds(machine, 20.0, 900.0, modes(machine, np.linspace(20.0, 900.0, 20)))
    probes = [Probe(0.3, "X", math.radians(135.0)), Probe(0.3, "Y", math.radians(225.0))]
    x, y = probe_responses(machine, probes, speeds)
    assert x.name == "X"
    np.testing.assert_allclose(x.amplitude, y.amplitude, rtol=1e-9)
    np.testing.assert_allclose(x.amplitude, x.major_axis, rtol=1e-9)
    lag = np.unwrap(x.phase)
    np.testing.assert_allclose(np.cos(x.phase - y.phase), 1.0, atol=1e-9)
    assert x.phase[0] == pytest.approx(0.0, abs=0.02)
    at_peak = float(np.interp(x.peaks[0].speed, speeds, lag))
    assert at_peak == pytest.approx(np.pi / 2.0, abs=0.15)
    assert lag[-1] > 2.5
    assert x.peaks[0].amplification_factor == pytest.approx(y.peaks[0].amplification_factor)


def test_no_node_at_a_place_is_refused():
    with pytest.raises(InputError, match="no node here"):
        node_at(beam_machine().rotor, 0.3111)


@pytest.mark.parametrize(
    ("factor", "below", "margin"),
    [(2.4, True, 0.0), (2.5, True, 0.0), (3.5, True, 0.085), (30.0, True, 0.16),
     (2.5, False, 0.10), (3.5, False, 0.185), (30.0, False, 0.26), (math.inf, False, 0.26)],
)  # fmt: skip
def test_required_margins_by_hand(factor, below, margin):
    assert required_margin(factor, below) == pytest.approx(margin)


def test_margins_of_peaks():
    assert separation_margin(90.0, (100.0, 200.0)) == pytest.approx(0.1)
    assert separation_margin(150.0, (100.0, 200.0)) == 0.0
    assert separation_margin(250.0, (100.0, 200.0)) == pytest.approx(0.25)
    for speed, factor, passed in [
        (90.0, 3.5, True), (92.0, 3.5, False), (90.0, 2.0, True), (150.0, 3.5, False),
        (150.0, 2.0, True), (240.0, 3.5, True), (236.0, 3.5, False),
    ]:  # fmt: skip
        half = 0.5 * speed / factor
        peak = Peak(speed, 1e-6, speed - half, speed + half)
        check = _margin_check(peak, "probe", (100.0, 200.0), EDITION)
        assert check.passed is passed, (speed, factor)
        assert check.edition == EDITION


def test_limits_by_hand():
    assert _residual_unbalance(100.0, 10000.0 / RPM) == pytest.approx(63.5e-6)
    assert _residual_unbalance(100.0, 50000.0 / RPM) == pytest.approx(25.4e-6)
    assert _vibration_limit(6000.0 / RPM) == pytest.approx(25.4e-6)
    assert _vibration_limit(48000.0 / RPM) == pytest.approx(12.7e-6)


def test_probe_and_clearance_checks_scale_with_the_unbalance():
    between = (200.0, 400.0)
    found = []
    for unbalance in (2e-5, 2e-3):
        machine = beam_machine(unbalance=unbalance)
        speeds = np.linspace(50.0, 500.0, 200)
        probes = probe_responses(machine, [Probe(0.3)], speeds)
        scale = _scale_factor(probes, between)
        response = unbalance_response(machine, speeds)
        place = [Clearance(0.6, 4e-4, "seal")]
        (check,) = _clearance_checks(response, place, scale, "mode 1", 450.0, EDITION)
        found.append((_probe_check(probes[0], "mode 1", between, EDITION), scale, check))
    (small, low, near), (large, high, far) = found
    assert large.value == pytest.approx(100.0 * small.value)
    assert (small.passed, large.passed) == (True, False)
    assert low == pytest.approx(min(6.0, small.limit / small.value))
    assert high == 0.5
    response = 2.0 * unbalance_response(machine, np.linspace(50.0, 450.0, 2000)).major_axis(
        node_at(machine.rotor, 0.6)
    )
    assert far.value == pytest.approx(0.5 * response.max(), rel=0.02)
    assert near.limit == pytest.approx(3e-4)
    assert far.passed is False


def test_stiffness_that_destabilises_a_jeffcott_rotor():
    ratio = 0.05
    damping = 2.0 * ratio * math.sqrt(K * M)
    # m s^2 + c s + k - i Q: s = i w crosses at w = sqrt(k/m), Q0 = c w.
    q0 = damping * NATURAL
    curve = decrement_curve(jeffcott(ratio), 2.0 * NATURAL, {0: 0.25 * q0})
    assert curve.threshold == pytest.approx(q0, rel=1e-9)
    quarter = np.roots([M, damping, K - 0.25j * q0])
    forward = quarter[quarter.imag > 0.0][0]
    expected = -2.0 * math.pi * forward.real / forward.imag
    assert curve.anticipated_decrement == pytest.approx(expected, rel=1e-9)
    least, ratio_check = _stability_checks(curve, EDITION)
    assert least.passed is True
    assert ratio_check.value == pytest.approx(4.0)
    assert ratio_check.passed is True
    assert np.all(np.diff(curve.decrement) < 0.0)
    near = decrement_curve(jeffcott(ratio), 2.0 * NATURAL, {0: 0.9 * q0})
    assert [check.passed for check in _stability_checks(near, EDITION)] == [False, False]


def test_a_machine_unstable_by_itself_has_no_stiffness_left():
    support = ConstantSupport([[K, 1e6], [-1e6, K]], 100.0)
    curve = decrement_curve(Machine(Rotor.rigid(M), [(0, support)]), 500.0, {0: 1e5})
    assert curve.threshold == 0.0
    assert [check.passed for check in _stability_checks(curve, EDITION)] == [False, False]


def test_the_curve_is_that_of_the_mode_that_is_driven():
    # The second mode of the shaft is damped less than the first and hardly driven by Q at the disc.
    machine = beam_machine()
    node = node_at(machine.rotor, 0.6)
    curve = decrement_curve(machine, 400.0, {node: 1e4})
    assert np.all(np.diff(curve.decrement) < 0.0)
    assert curve.decrement[-1] < 0.0 or curve.threshold > curve.stiffness[-1]
    first = modes(machine, 400.0).oscillating()
    forward = (first.whirl[0] == "forward") & (first.damping_ratio[0] < 0.7)
    lowest = first.damped_frequency[0][forward].min()
    assert curve.frequency[0] == pytest.approx(lowest, rel=1e-9)


@pytest.mark.slow
def test_shares_of_several_places_are_kept():
    machine = beam_machine()
    middle, end = node_at(machine.rotor, 0.6), node_at(machine.rotor, 0.3)
    alone = decrement_curve(machine, 400.0, {middle: 1e5})
    split = decrement_curve(machine, 400.0, {middle: 5e4, end: 5e4})
    # The nearer to the bearing, the less it drives.
    assert split.threshold > 1.2 * alone.threshold
    assert split.anticipated == alone.anticipated


def test_unbalance_is_placed_to_excite_each_mode():
    beam = Beam((Section(1.4, 0.08),), tuple(Disc(z, 25.0, 0.2, 0.11) for z in (0.45, 0.95)))
    rotor = beam_rotor(beam, [0.1, 1.3])
    nodes = [node_at(rotor, z) for z in (0.1, 1.3)]
    machine = Machine(rotor, [(node, ConstantSupport(5e7, 2e3)) for node in nodes])
    loads = reactions_by_statics(rotor, weight(rotor), nodes)[:, 0]
    assert loads.sum() == pytest.approx(rotor.total_mass * STANDARD_GRAVITY)
    found = modes(machine, np.linspace(10.0, 2500.0, 40))
    static = dict(zip(nodes, loads, strict=True))
    first, second = unbalance_cases(machine, found, static, 1000.0, 4.0)[:2]
    (plane,) = first.planes
    assert plane.at == pytest.approx(0.7, abs=0.05)
    assert plane.mass == pytest.approx(rotor.total_mass, rel=1e-6)
    assert plane.amount == pytest.approx(4.0 * _residual_unbalance(plane.mass, 1000.0))
    left, right = second.planes
    assert left.at + right.at == pytest.approx(1.4, abs=0.02)
    assert abs(left.phase - right.phase) == pytest.approx(np.pi)
    assert left.mass == pytest.approx(0.5 * rotor.total_mass, rel=1e-6)
    # In phase at midspan the second mode hardly answers; by its own case it does.
    probe = [Probe(0.45)]
    grid = second.speed * np.linspace(0.95, 1.05, 21)
    rigid = Machine(beam_rotor(beam, [0.1, 1.3, 0.45]), machine.mounts)
    own, other = (
        probe_responses(case.applied(rigid), probe, grid)[0].amplitude for case in (second, first)
    )
    assert own.max() > 20.0 * other.max() * sum(p.amount for p in second.planes) / plane.amount


def test_modes_excited_by_the_same_unbalance_make_one_case():
    beam = Beam((Section(0.6, 0.05),), (Disc(0.3, 40.0, 0.6, 0.3, "wheel"),))
    rotor = beam_rotor(beam, [0.0, 0.6])
    nodes = [node_at(rotor, z) for z in (0.0, 0.6)]
    # soft in one plane, stiff in the other: rigid on its supports there, bent between them here
    support = ConstantSupport(np.diag([4e6, 4e8]), 2e3 * np.eye(2))
    machine = Machine(rotor, [(node, support) for node in nodes])
    loads = reactions_by_statics(rotor, weight(rotor), nodes)[:, 0]
    found = modes(machine, np.linspace(10.0, 1500.0, 60))
    cases = unbalance_cases(machine, found, dict(zip(nodes, loads, strict=True)), 1200.0, 4.0)
    assert len(critical_speeds(machine, found)) > 1
    planes = [case.planes for case in cases]
    assert len(set(planes)) == len(planes)
    assert [case.name for case in cases] == [f"mode {k + 1}" for k in range(len(cases))]


def test_an_overhung_mode_takes_the_overhung_mass():
    beam = Beam((Section(1.0, 0.08),), (Disc(0.98, 60.0, 0.8, 0.5, "impeller"),))
    rotor = beam_rotor(beam, [0.1, 0.7])
    nodes = [node_at(rotor, z) for z in (0.1, 0.7)]
    machine = Machine(rotor, [(node, ConstantSupport(1e9, 2e3)) for node in nodes])
    loads = reactions_by_statics(rotor, weight(rotor), nodes)[:, 0]
    assert loads[0] < 0.0
    found = modes(machine, np.linspace(10.0, 1000.0, 30))
    case = unbalance_cases(machine, found, dict(zip(nodes, loads, strict=True)), 500.0, 1.0)[0]
    plane = max(case.planes, key=lambda one: one.amount)
    assert plane.at > 0.9
    assert 60.0 < plane.mass < 60.0 + 7830 * 0.3 * np.pi * 0.04**2 * 1.2


@pytest.mark.slow
def test_critical_speed_map_between_its_asymptotes():
    beam = Beam((Section(1.2, 0.05),), (Disc(0.6, 20.0, 0.1, 0.06),))
    rotor = beam_rotor(beam, [0.0, 1.2])
    nodes = [node_at(rotor, z) for z in (0.0, 1.2)]
    chart = critical_speed_map(rotor, nodes, np.geomspace(1e1, 1e12, 12), count=3)
    assert np.all(np.diff(chart.speed, axis=0) > 0.0)
    # Soft springs carry the rigid rotor.
    assert chart.speed[0, 0] == pytest.approx(math.sqrt(20.0 / rotor.total_mass), rel=1e-5)
    # Stiff ones: what the machine's own modes say.
    for i in (6, 11):
        machine = Machine(rotor, [(n, ConstantSupport(chart.stiffness[i])) for n in nodes])
        for speed in chart.speed[i]:
            found = modes(machine, float(speed))
            forward = found.whirl[0] == "forward"
            nearest = np.abs(found.damped_frequency[0][forward] - speed).min()
            assert nearest < 1e-7 * speed


def test_principal_stiffnesses():
    inner = ConstantSupport([[3e6, 2e6], [0.0, 5e6]])
    rotor = Rotor.rigid(10.0)
    alone = principal_stiffness(Machine(rotor, [(0, inner)]), [100.0, 200.0])["support 1"]
    expected = np.linalg.eigvalsh([[3e6, 1e6], [1e6, 5e6]])
    assert alone == pytest.approx(np.array([expected, expected]))
    series = Machine(rotor, [(0, Pedestal(ConstantSupport(3e6), 0.0, 6e6))])
    assert principal_stiffness(series, 0.0)["support 1"] == pytest.approx(np.full((1, 2), 2e6))
