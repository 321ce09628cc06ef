"""Figures of machines: what the results say is what is drawn, to scale and with units."""

import numpy as np
import pytest

from rotorsim import rows
from rotorsim.files.machine import load_machine
from rotorsim.machine.critical_map import critical_speed_map, principal_stiffness
from rotorsim.machine.peaks import node_at, probe_responses, response_speeds
from rotorsim.rows import RPM
from rotorsim.show import figures as plots
from rotorsim.study.machine_analysis import analyse_machine


@pytest.fixture(scope="module")
def friswell():
    return analyse_machine(load_machine("machines/friswell"))["given"]


def texts(axes):
    return [text.get_text() for text in axes.texts]


def test_the_drawing_is_to_scale():
    machine = load_machine("machines/compressor")
    (axes,) = plots.rotor_drawing(machine, machine.title).axes
    assert axes.get_aspect() == 1.0
    boxes = [patch.get_path().get_extents(patch.get_patch_transform()) for patch in axes.patches]
    ends = np.array([(box.x0, box.x1, box.y0, box.y1) for box in boxes])
    assert ends[:, 0].min() < 1.0
    assert ends[:, 1].max() == pytest.approx(760.0)  # the shaft's length in mm
    shaft = [e for e in ends if e[0] == pytest.approx(180.0) and e[1] == pytest.approx(520.0)]
    assert shaft[0][2:] == pytest.approx([-45.0, 45.0])  # 90 mm
    found = " ".join(texts(axes))
    for name in ("impeller", "coupling hub", "drive end", "impeller end X"):
        assert name in found
    names = [text.get_text() for text in axes.get_legend().get_texts()]
    assert {"bearing", "seal", "probe", "unbalance", "mass without stiffness"} <= set(names)


def test_the_drawing_follows_the_units_shown(monkeypatch):
    monkeypatch.setattr(rows, "_shown_in", ["us"])
    (axes,) = plots.rotor_drawing(load_machine("machines/compressor")).axes
    boxes = [patch.get_path().get_extents(patch.get_patch_transform()) for patch in axes.patches]
    assert max(box.x1 for box in boxes) == pytest.approx(760.0 / 25.4)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("from the left end [in]", "radius [in]")


def test_every_shipped_machine_can_be_drawn():
    for name in ("friswell", "nelson_mcvaugh", "train", "plain_rotor"):
        machine = load_machine(f"machines/{name}")
        assert len(plots.rotor_drawing(machine).axes[0].patches) >= len(machine.rotor.beam.sections)


def test_campbell_diagram_marks_critical_speeds_on_the_synchronous_line(friswell):
    figure = plots.machine_campbell(friswell.modes, friswell.critical_speeds, (300.0, 400.0))
    (axes,) = figure.axes
    marks = [line for line in axes.lines if line.get_marker() == "o"]
    places = np.array([np.ravel(line.get_xydata()) for line in marks])
    np.testing.assert_allclose(places[:, 0], places[:, 1])
    expected = [one.speed * RPM for one in friswell.critical_speeds]
    np.testing.assert_allclose(np.sort(places[:, 0]), expected)
    assert "rpm" in axes.get_xlabel()


def test_mode_shapes_are_of_unit_size_at_the_nodes(friswell):
    figure = plots.mode_shapes(friswell.machine.rotor, friswell.modes, 400.0, count=4)
    assert len(figure.axes) == 4
    for axes in figure.axes:
        centre = axes.lines[-2].get_data_3d()
        np.testing.assert_allclose(centre[0], np.linspace(0.0, 1500.0, 7))
        assert 0.9 < np.hypot(*centre[1:]).max() <= np.sqrt(2.0)
    assert "backward" in figure.axes[0].get_title()


def test_bode_plot_names_amplification_factors(friswell):
    found, machine = friswell.modes, friswell.machine
    speeds = response_speeds(machine, float(found.parameter[0]), float(found.parameter[-1]), found)
    probes = friswell.description.probe
    responses = probe_responses(machine, probes, speeds)
    upper, lower = plots.bode_at_probes(responses, (300.0, 400.0)).axes
    peak = responses[0].peaks[0]
    assert f"AF {peak.amplification_factor:.1f}" in " ".join(texts(upper))
    drawn = upper.lines[0].get_xydata()
    np.testing.assert_allclose(drawn[:, 1], responses[0].amplitude * 1e6)
    lag = lower.lines[0].get_ydata()
    assert np.all(np.abs(np.diff(lag)) < 90.0)


def test_critical_speed_chart_and_growth_rates(friswell):
    machine = friswell.machine
    nodes = [node_at(machine.rotor, z) for z in (0.0, 1.5)]
    chart = critical_speed_map(machine.rotor, nodes, np.geomspace(1e5, 1e9, 9))
    own = principal_stiffness(machine, friswell.speeds)
    (axes,) = plots.critical_speed_chart(chart, own, friswell.speeds, (300.0, 400.0)).axes
    np.testing.assert_allclose(axes.lines[0].get_ydata(), chart.speed[:, 0] * RPM)
    np.testing.assert_allclose(axes.lines[4].get_xdata(), 1e6)
    (growth,) = plots.growth_over_speed({"given": friswell.modes}).axes
    thick = [line for line in growth.lines if line.get_linewidth() > 2.0]
    assert len(thick) == 1
    assert np.all(thick[0].get_ydata() < 0.0)
    assert "1/s" in growth.get_ylabel()
