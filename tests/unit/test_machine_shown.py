"""A machine's report and recording hold what they should; what `new` writes can be run."""

from __future__ import annotations

import re

import numpy as np
import pytest
from command_line import called

from rotorsim import rows
from rotorsim.files.machine import MachineFile, load_machine
from rotorsim.study.lateral import lateral_study
from rotorsim.study.machine_analysis import analyse_machine

TEXT = """
title = "Rotor <&> one"
[rotor]
kind = "beam"
internal_damping = "5e-5 s"
[[rotor.section]]
length = "1.2 m"
outer_diameter = "60 mm"
[[rotor.disc]]
name = "wheel"
at = "0.5 m"
mass = "40 kg"
polar_inertia = "0.4 kg*m^2"
transverse_inertia = "0.25 kg*m^2"
[[rotor.unbalance]]
at = "500 mm"
grade = "G2.5"
[[support]]
name = "left"
at = "0 mm"
stiffness = ["20 MN/m", "15 MN/m"]
damping = "2 kN*s/m"
[[support]]
name = "right"
at = "1 m"
stiffness = "20 MN/m"
damping = "2 kN*s/m"
[[probe]]
name = "px"
at = "200 mm"
angle = "135 deg"
[operating]
speed = { start = "1000 rpm", stop = "9000 rpm", count = 9 }
continuous = ["5000 rpm", "6000 rpm"]
[lateral]
destabilising_stiffness = [{ at = "500 mm", anticipated = "0.05 MN/m" }]
"""


@pytest.fixture(scope="module")
def results():
    return analyse_machine(MachineFile.from_text(TEXT), workers=1)


@pytest.mark.slow
def test_the_report_says_what_was_found(results, tmp_path):
    from rotorsim.show.report.machine import write_machine_report

    study = lateral_study(results["given"])
    page = write_machine_report(results, study, tmp_path / "one.html").read_text()
    assert "<title>Rotor &lt;&amp;&gt; one</title>" in page
    for head in (
        "Rotor", "Bearings at their load", "Stability over speed", "Modes", "Critical speeds",
        "Unbalance response and margins", "What was computed",
    ):  # fmt: skip
        assert f"<h2>{head}</h2>" in page
    threshold = results["given"].thresholds[0].speed * 30.0 / np.pi
    assert f"Unstable from {threshold:.0f} rpm" in page
    assert page.count("<figure>") == 7
    assert "20 / 0 / 0 / 15" in page
    assert 'src="http' not in page


def test_the_recording_moves_the_modes_and_the_speed(results, tmp_path):
    from rerun.chunk import RrdReader

    from rotorsim.show.recording.machine import write_machine_recording

    path = write_machine_recording(results, tmp_path / "one.rrd")
    reader = RrdReader(path)
    entities = {str(one) for one in reader.store().schema().entity_paths()}
    for wanted in ("/rotor/shaft_mm", "/rotor/probes", "/modes/1/rotor_mm", "/campbell/now/line"):
        assert wanted in entities
    assert len(reader.blueprints()) == 1


def test_new_writes_a_machine_that_is_understood(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert called(capsys, "new", "fan", "--rotor", "beam").returncode == 0
    machine = load_machine(tmp_path / "fan.toml")
    assert list(machine.bearings) == ["left", "right"]
    assert called(capsys, "check", "fan.toml").returncode == 0
    # What stands there as a comment is valid as well.
    text = (tmp_path / "fan.toml").read_text()
    keys = re.sub(r"^# (?=\[|[a-z_]+ = )", "", text, flags=re.MULTILINE)
    assert keys.count("[[seal]]") == 1
    full = MachineFile.from_text(keys, source=tmp_path / "fan.toml")
    assert full.map
    assert full.tolerances is not None
    assert full.control is not None
    again = called(capsys, "new", "fan", "--rotor", "beam")
    assert (again.returncode, "exists" in again.stderr) == (2, True)
    assert called(capsys, "new", "two", "--rotor", "jeffcott").returncode == 0
    assert called(capsys, "check", "two.toml").returncode == 0


def test_heads_and_cells_follow_the_units_shown(monkeypatch):
    monkeypatch.setattr(rows, "_shown_in", ["us"])
    assert rows.heads("rpm", "load kN", "Q_A MN/m", "name") == (
        "rpm", "load lbf", "Q_A klbf/in", "name"
    )  # fmt: skip
    assert rows.shown(25.4, "µm") == "1"
    assert rows.shown(None, "µm") == "-"
