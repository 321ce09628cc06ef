"""Files of the wrong kind, on either side: what is read is recognised, what is kept is not lost."""

from __future__ import annotations

from pathlib import Path

import pytest
from command_line import CommandLine
from scenario_texts import SMALL

import rotorsim as rs
from rotorsim.errors import InputError, TableError


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    path = tmp_path / "q.toml"
    path.write_text(SMALL, encoding="utf-8")
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
    assert scenario.read_text(encoding="utf-8") == SMALL
    assert [entry.name for entry in scenario.parent.iterdir()] == ["q.toml"]


@pytest.mark.parametrize(("command", "suffix"), [("report", "html"), ("orbit", "rrd")])
def test_no_output_replaces_the_input_whatever_its_name(command, suffix, here, scenario):
    mine = scenario.rename(scenario.with_suffix(f".{suffix}"))
    done = here(command, mine.name, "-o", f"./{mine.name}")
    assert done.returncode == 2
    assert "--output: is the input itself" in done.stderr
    assert mine.read_text(encoding="utf-8") == SMALL


def test_a_recording_is_named_as_one(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"path: .*must end in \.rrd.*found: '.*m'") as caught:
        rs.record([], tmp_path / "m")
    assert "PosixPath" not in str(caught.value)
    assert not list(tmp_path.iterdir())


WRONG = [
    # command, the file's name, what it is called
    ("run", "x.nc", "coefficient tables"),
    ("report", "x.nc", "coefficient tables"),
    ("check", "x.rrd", "`rotorsim view` takes it"),
    ("stability", "rotor.npz", "--rotor FILE"),
    ("stability", "rotor.mat", "--rotor FILE"),
    ("stability", "x.rrd", "`rotorsim view` takes it"),
    ("stability", "c.txt", "plain text"),
    ("stability", "x.html", "browser"),
    ("stability", "x.nc.journal", "`rotorsim table SCENARIO` resumes it"),
    ("control", "c.csv", "`rotorsim stability`, `rotorsim export`"),
    ("control", "bearing.toml", "bearing that ROSS saved"),
    ("solve", "disguised.toml", "coefficient tables"),
    ("export", "q.toml", "`rotorsim table SCENARIO` makes a coefficient table"),
    ("export", "disguised.csv", "its name must end in .nc"),
    ("export", "sheet.csv", "save its sheet as CSV"),
    ("export", "x.rrd", "`rotorsim view` takes it"),
    ("orbit", "q.toml", "`rotorsim table SCENARIO` makes a coefficient table"),
    ("view", "x.nc", "coefficient tables"),
    ("view", "q.toml", "is a scenario"),
    ("view", "noise.rrd", "is no recording"),
]
CSV = "speed [rpm],kxx [N/m],kxy [N/m],kyx [N/m],kyy [N/m],cxx [N s/m],cxy [N s/m],cyx [N s/m],"
CSV += "cyy [N s/m]\n3000,1e8,1e7,-1e7,1e8,1e5,0,0,1e5\n6000,1e8,1e7,-1e7,1e8,1e5,0,0,1e5\n"


@pytest.fixture
def files(scenario: Path) -> Path:
    """One file of every kind, small or large."""
    folder = scenario.parent
    netcdf = b"\x89HDF\r\n\x1a\n" + bytes(100)
    contents = {
        "x.nc": netcdf,
        "disguised.toml": netcdf,
        "disguised.csv": netcdf,
        "x.rrd": b"RRF2" + bytes(1_100_000),
        "noise.rrd": bytes(range(255, 0, -1)),
        "rotor.npz": b"PK\x03\x04" + bytes(100),
        "rotor.mat": b"MATLAB 5.0 MAT-file, Platform: posix",
        "sheet.csv": b"PK\x03\x04" + bytes(100),
        "c.txt": b"# rpm kxx kxy\n 3000 1e8 1e7\n",
        "c.csv": b"# comment\n" + CSV.encode(),
        "x.html": b"<!DOCTYPE html><html></html>",
        "x.nc.journal": b'{"rotorsim_journal": 1}\n',
        "bearing.toml": b"[BearingElement_x]\nfrequency = [1.0]\nkxx = [1e8]\ncxx = [1e5]\n",
    }
    for name, content in contents.items():
        (folder / name).write_bytes(content)
    return folder


@pytest.mark.parametrize(("command", "name", "said"), WRONG)
def test_a_file_of_another_kind_is_recognised(command, name, said, here: CommandLine, files: Path):
    before = sorted(entry.name for entry in files.iterdir())
    words = {"export": [name, "--to", "mat"], "orbit": ["q.toml", "--table", name]}
    done = here(command, *words.get(command, [name]))
    assert done.returncode == 2
    assert done.stderr.startswith(f"error: {name}: is ")
    assert said in done.stderr
    assert sorted(entry.name for entry in files.iterdir()) == before


@pytest.mark.parametrize(
    ("name", "said"),
    [("x.rrd", "is a recording"), ("q.toml", "is a scenario"), ("noise.x", "must end in .npz")],
)
def test_a_rotor_is_read_from_matrices(name: str, said: str, here: CommandLine, files: Path):
    (files / "noise.x").write_bytes(b"x")
    done = here("stability", "c.csv", "--rotor", name)
    assert done.returncode == 2
    assert done.stderr.startswith(f"error: {name}: ")
    assert said in done.stderr
    assert "must end in .npz or .mat" in done.stderr


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("q.toml", "is a scenario"),
        ("c.csv", "CoefficientTable.from_csv"),
        ("x.rrd", "is a recording"),
        ("bearing.toml", "ROSS saved"),
    ],
)
def test_a_table_is_loaded_from_a_table(name: str, said: str, files: Path) -> None:
    with pytest.raises(TableError) as caught:
        rs.CoefficientTable.load(files / name)
    assert str(caught.value).startswith(f"{files / name}: ")
    assert said in str(caught.value)


def test_a_recording_may_begin_with_a_dash(here: CommandLine, files: Path, monkeypatch):
    from types import SimpleNamespace

    opened = []
    launch = SimpleNamespace(started=True, message="", exit_code=0)
    monkeypatch.setattr(
        "rotorsim.show.viewer.open_viewer", lambda path: opened.append(path) or launch
    )
    (files / "x.rrd").rename(files / "-x.rrd")
    assert here("view", "--", "-x.rrd").returncode == 0
    assert opened == [files / "-x.rrd"]


@pytest.mark.parametrize("value", [None, {}, 5, b"x.nc", ["x.nc"]])
def test_what_is_no_name_of_a_file_is_refused(value) -> None:
    from rotorsim.files.formats import read_table
    from rotorsim.files.rotors import load_rotor

    for read in (read_table, load_rotor, rs.CoefficientTable.load, rs.CoefficientTable.from_csv):
        with pytest.raises(InputError, match="path: must be the name of a file"):
            read(value)


def test_a_scenario_may_be_called_anything(scenario: Path) -> None:
    for suffix in (".txt", ".csv", ".nc", ""):
        scenario = scenario.rename(scenario.with_suffix(suffix))
        assert len(rs.load_scenario(scenario).speeds) == 2
