"""Files of the wrong kind, on either side: what is read is recognised, what is kept is not lost."""

from __future__ import annotations

from pathlib import Path

import pytest
from command_line import CommandLine
from scenario_texts import BEARING, CONSTANT_OIL

import rotorsim as rs
from rotorsim.errors import InputError

SCENARIO = f"""\
{BEARING}
{CONSTANT_OIL}
[film]
mesh = {{ circumferential = 32, axial = 8 }}
[operating]
speed = ["6000 rpm", "9000 rpm"]
eccentricity_ratio = 0.5
[rotor]
mass = "1200 kg"
[orbit]
speed = "9000 rpm"
"""


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    path = tmp_path / "q.toml"
    path.write_text(SCENARIO, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("command", "file", "said"),
    [
        ("report", "q.toml", ".html"),
        ("report", "r.pdf", '"r.html"'),
        ("report", "r", ".html"),
        ("orbit", "q.toml", ".rrd"),
        ("orbit", "x.gif", '"x.rrd"'),
        ("table", "q.toml", ".nc"),
    ],
)
def test_outputs_are_named_as_what_they_are(command, file, said, here: CommandLine, scenario):
    done = here(command, "q.toml", "-o", file)
    assert done.returncode == 2
    assert done.stderr.startswith("error: --output: must end in")
    assert said in done.stderr
    assert f"(found: '{file}')" in done.stderr
    assert scenario.read_text(encoding="utf-8") == SCENARIO
    assert [entry.name for entry in scenario.parent.iterdir()] == ["q.toml"]


@pytest.mark.parametrize(("command", "suffix"), [("report", "html"), ("orbit", "rrd")])
def test_no_output_replaces_the_input_whatever_its_name(command, suffix, here, scenario):
    mine = scenario.rename(scenario.with_suffix(f".{suffix}"))
    done = here(command, mine.name, "-o", f"./{mine.name}")
    assert done.returncode == 2
    assert "--output: is the input itself" in done.stderr
    assert mine.read_text(encoding="utf-8") == SCENARIO


def test_a_recording_is_named_as_one(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"path: .*must end in \.rrd.*found: '.*m'") as caught:
        rs.record([], tmp_path / "m")
    assert "PosixPath" not in str(caught.value)
    assert not list(tmp_path.iterdir())
