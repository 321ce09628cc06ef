"""The command line as scripts and people meet it: exit codes, streams, JSON, bad input."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import numpy as np
import pytest
from command_line import strict
from scenario_texts import BEARING, BOTH_MODELS, OIL

ROOT = Path(__file__).parents[2]
QUICK = ROOT / "scenarios" / "quick.toml"
COMMANDS = (
    *("run", "check", "solve", "table", "stability", "orbit", "report", "view", "export", "new"),
    "control",
)
POINT_KEYS = (
    "status thermal_model cavitation speed radial_clearance eccentricity_ratio attitude_angle load "
    "sommerfeld_number max_pressure max_temperature mean_temperature friction_force power_loss "
    "side_flow min_film_thickness stiffness damping critical_mass critical_mass_dimensionless "
    "whirl_frequency_ratio stability iterations residual"
)
TINY = f"""\
title = "tiny"
{BEARING}
{OIL}
[film]
mesh = {{ circumferential = 32, axial = 8, cross_film = 8 }}
{BOTH_MODELS}shaft = "insulated"
bush = "insulated"
[operating]
speed = {{ start = "6000 rpm", stop = "15000 rpm", count = 4 }}
eccentricity_ratio = 0.5
[rotor]
mass = "1200 kg"
[orbit]
speed = "15000 rpm"
revolutions = 10
initial_displacement = ["1 um", "0 um"]
"""


def environment(**more: str) -> dict[str, str]:
    return {**os.environ, "COLUMNS": "100", "NO_COLOR": "1", **more}


def rotorsim(*arguments: object, cwd: Path) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-m", "rotorsim", *map(str, arguments)],
        cwd=cwd,
        env=environment(),
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=300,
    )


def flat(text: str) -> str:
    return " ".join(text.split())


@pytest.fixture
def tiny(tmp_path: Path) -> Path:
    path = tmp_path / "tiny.toml"
    path.write_text(TINY, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def tabulated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with tiny.toml and its table."""
    folder = tmp_path_factory.mktemp("tabulated")
    (folder / "tiny.toml").write_text(TINY, encoding="utf-8")
    done = rotorsim("table", "tiny.toml", "--quiet", cwd=folder)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    return folder


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_with_an_example_and_json(command, here):
    done = here(command, "--help")
    assert done.returncode == 0
    assert f"Example: rotorsim {command} " in flat(done.stdout)
    assert "--json" in done.stdout
    assert "--quiet" in done.stdout


def test_help_names_every_command_and_the_exit_codes(here):
    done = here("--help")
    assert done.returncode == 0
    assert all(re.search(rf"^│ {name} ", done.stdout, re.M) for name in COMMANDS)
    assert "Exit codes" in done.stdout


def test_help_and_import_stay_fast(tmp_path):
    """Heavy modules load when first used: which are loaded is the cause, and exact."""
    code = (
        "import sys; before = set(sys.modules)\n"
        "import rotorsim.cli.app\n"
        "print(*sorted({name.split('.')[0] for name in set(sys.modules) - before}))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment(), capture_output=True, text=True, check=True
    )
    heavy = {"numpy", "numba", "scipy", "xarray", "pint", "rerun", "matplotlib", "control"}
    assert not heavy & set(done.stdout.split())


def test_importing_the_package_loads_nothing_but_itself():
    code = "import sys, rotorsim; print('numpy' in sys.modules, 'typer' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment(), capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["False", "False"]


def test_a_removed_command_names_its_successor(here):
    done = here("reproduce", "dal", "--coarse", "--output", "out")
    assert done.returncode == 2
    assert "python examples/dal_paper" in done.stderr
    assert "reproduce" not in here("--help").stdout


def test_version(here):
    done = here("--version")
    assert re.fullmatch(r"rotorsim \d+\.\d+\.\d+\n", done.stdout)


@pytest.mark.slow
def test_solve_prints_every_key_of_the_contract_in_json(tiny, here):
    done = here("solve", tiny, "--json", "--speed", "12000 rpm")
    assert done.returncode == 0, done.stderr
    points = strict(done.stdout)["points"]
    assert [point["thermal_model"] for point in points] == ["isothermal", "thd"]
    keys = set(POINT_KEYS.split())
    for point in points:
        assert keys <= set(point)
        assert point["status"] == "converged"
        assert point["speed"] == pytest.approx(12000 * np.pi / 30)
        assert np.shape(point["stiffness"]) == np.shape(point["damping"]) == (2, 2)
    assert points[1]["max_temperature"] > points[0]["max_temperature"] + 20.0


def test_solve_shows_results_on_stdout_and_progress_on_stderr(tiny, here):
    done = here("solve", tiny, "-s", "12000 rpm", "-m", "isothermal")
    assert done.returncode == 0
    assert "load" in done.stdout
    assert "critical mass per bearing" in done.stdout
    assert "film points" in done.stderr
    assert "film points" not in done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("command", ["solve", "check"])
def test_quiet_is_silent(command, tiny, here):
    done = here(command, tiny, "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_check_says_what_would_run(tiny, tmp_path, here):
    done = here("check", tiny, "--json")
    said = strict(done.stdout)
    assert said["points"] == 8
    # rho U c/mu at 15 000 rpm
    reynolds = 860.0 * (15000 * np.pi / 30 * 0.05) * 100e-6 / 0.0277
    assert said["cases"][0]["reynolds_number"] == pytest.approx(reynolds)
    assert said["cases"][0]["clearance_ratio"] == pytest.approx(2e-3)
    assert os.listdir(tmp_path) == ["tiny.toml"]


def test_check_shows_the_drawing_and_warns_of_what_is_mistyped(tiny, here):
    said = flat(here("check", tiny).stdout)
    for text in (
        "journal radius 50 mm",
        "length 80 mm",
        "length to diameter 0.8",
        "diametral clearance 0.2 mm",
        "clearance over radius 2 ‰",
        "Cold, and warm",
    ):
        assert text in said
    diametral = TINY.replace('"100 um"', '"10 um"')
    tiny.write_text(diametral, encoding="utf-8")
    done = here("check", tiny)
    assert done.returncode == 0
    assert "warning: c/R 0.2 per mille is outside 0.3 to 5" in done.stderr


def test_cooled_walls_are_named_with_what_they_take(tiny, here):
    cooled = TINY.replace('"insulated"', '"ambient"')
    tiny.write_text(cooled, encoding="utf-8")
    done = here("solve", tiny, "-s", "5000 rpm", "-m", "thd")
    assert done.returncode == 0
    assert "warning: bush and shaft held at ambient temperature" in done.stderr
    assert re.search(r"heat through the walls +[5-9]\d +%", done.stdout)


@pytest.mark.slow
def test_table_is_written_with_its_scenario_and_no_journal_is_left(tabulated):
    import xarray

    folder = tabulated / "coefficients"
    assert os.listdir(folder) == ["tiny.nc"]
    with xarray.open_dataset(folder / "tiny.nc", engine="h5netcdf") as dataset:
        assert dataset.attrs["scenario"] == TINY
        assert dataset.sizes == {"thermal_model": 2, "radial_clearance": 1, "speed": 4}


@pytest.mark.slow
def test_stability_of_a_table(tabulated):
    done = rotorsim("stability", "coefficients/tiny.nc", "--json", cwd=tabulated)
    assert done.returncode == 0, done.stderr
    said = strict(done.stdout)
    assert said["mass"] == 1200.0
    for curve in said["curves"]:
        stable = np.array(curve["critical_mass"]) > 1200.0
        # The closed form and the eigenvalues must agree on the verdict.
        assert (np.array(curve["growth_rate"]) < 0.0).tolist() == stable.tolist()
    crossed = {curve["thermal_model"]: curve["threshold_speeds"] for curve in said["curves"]}
    assert crossed["isothermal"] == []
    assert len(crossed["thd"]) == 1


@pytest.mark.slow
def test_mass_on_the_command_line_overrides_the_scenario(tabulated):
    arguments = ("stability", "coefficients/tiny.nc", "--mass", "100 kg", "--json")
    said = strict(rotorsim(*arguments, cwd=tabulated).stdout)
    assert said["mass"] == 100.0
    assert all(max(curve["growth_rate"]) < 0.0 for curve in said["curves"])


@pytest.mark.slow
def test_orbit_grows_with_heating_and_decays_without_as_the_eigenvalues_say(tabulated):
    done = rotorsim("orbit", "tiny.toml", "-t", "coefficients/tiny.nc", "--json", cwd=tabulated)
    assert done.returncode == 0, done.stderr
    said = strict(done.stdout)
    assert (tabulated / said["recording"]).stat().st_size > 10_000
    curves = strict(rotorsim("stability", "coefficients/tiny.nc", "--json", cwd=tabulated).stdout)
    growth = {curve["thermal_model"]: curve["growth_rate"][-1] for curve in curves["curves"]}
    assert growth["isothermal"] < 0.0 < growth["thd"]
    for orbit in said["orbits"]:
        assert orbit["growth_rate"] == pytest.approx(growth[orbit["thermal_model"]], rel=0.01)


@pytest.mark.slow
def test_export_to_csv_reads_back_as_the_same_table(tabulated):
    done = rotorsim("export", "coefficients/tiny.nc", "--to", "csv", "--json", cwd=tabulated)
    assert done.returncode == 0, done.stderr
    (path,) = strict(done.stdout)["files"]["csv"]
    first, again = (
        strict(rotorsim("stability", name, "--mass", "900 kg", "--json", cwd=tabulated).stdout)
        for name in ("coefficients/tiny.nc", path)
    )
    for left, right in zip(first["curves"], again["curves"], strict=True):
        assert right["growth_rate"] == pytest.approx(left["growth_rate"], rel=1e-9)


@pytest.mark.parametrize(
    "options",
    [
        (),
        ("--profile", "grooved", "--load", "2000 lbf"),
        ("--profile", "elliptical", "--iso-vg", "46"),
        ("--profile", "offset_halves"),
        ("--profile", "three_lobe"),
        ("--profile", "hybrid"),
        ("--profile", "pressure_dam", "--load", "2 kN"),
        ("--eccentricity", "0.6"),
    ],
)
def test_new_writes_a_scenario_that_checks(options, tmp_path, here):
    done = here("new", "pump", *options)
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "pump.toml").read_text(encoding="utf-8")
    assert text.count("#") > 10
    heat = tomllib.loads(text)["thermal"]
    assert [heat[key] for key in ("inlet", "shaft", "bush")] == ["mixing", "insulated", "insulated"]
    assert ("eccentricity_ratio" in tomllib.loads(text)["operating"]) == (
        "--eccentricity" in options
    )
    assert here("check", "pump.toml").returncode == 0
    again = here("new", "pump", *options)
    assert again.returncode == 2
    assert "--force" in again.stderr
    assert (tmp_path / "pump.toml").read_text(encoding="utf-8") == text


BAD = {
    "missing key": ('length = "80 mm"\n', "", ["bearing.length", "missing"]),
    "wrong unit": ('"80 mm"', '"80 kg"', ["bearing.length", "80 kg", "length"]),
    "bare number": ('"80 mm"', "80", ["bearing.length", "80", "unit"]),
    "negative clearance": ('"100 um"', '"-100 um"', ["bearing.radial_clearance", "-100 um"]),
    "eccentricity": ("ratio = 0.5", "ratio = 1.2", ["operating.eccentricity_ratio", "1.2"]),
    "unknown key": ("length =", "lenght =", ["bearing.lenght", "length"]),
    "not TOML": ("[bearing]", "[bearing", ["tiny.toml", "line"]),
}


@pytest.mark.parametrize("fault", BAD)
@pytest.mark.parametrize("command", ["check", "run"])
def test_bad_scenarios_end_with_2_and_one_readable_message(fault, command, tiny, tmp_path, here):
    old, new, words = BAD[fault]
    assert old in TINY
    tiny.write_text(TINY.replace(old, new, 1), encoding="utf-8")
    done = here(command, tiny)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("error: ")
    assert "Traceback" not in done.stderr
    for word in ["tiny.toml", *words]:
        assert word in done.stderr
    assert os.listdir(tmp_path) == ["tiny.toml"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("check", "nowhere.toml"), ["nowhere.toml"]),
        (("check", "."), ["."]),
        (("solve", "tiny.toml", "--speed", "12000"), ["--speed", "12000", "rpm"]),
        (("solve", "tiny.toml", "--speed", "0 rpm"), ["--speed", "0 rpm"]),
        (("solve", "tiny.toml", "--clearance", "-77 um"), ["clearance", "100 um"]),
        (("solve", "tiny.toml", "--model", "adiabatic"), ["adiabatic", "isothermal", "thd"]),
        (("solve", "tiny.toml", "--workers", "0"), ["1 or more"]),
        (("table", "tiny.toml", "--scheduler", "nowhere"), ["--scheduler"]),
        (("stability", "tiny.nc"), ["tiny.nc"]),
        (("stability", "fake.nc"), ["fake.nc"]),
        (("stability", "fake.csv"), ["fake.csv"]),
        (("stability", "tiny.toml", "--mass", "1200"), ["--mass", "1200"]),
        (("orbit", "tiny.toml", "--table", "fake.nc"), ["fake.nc"]),
        (("view", "nowhere.rrd"), ["nowhere.rrd"]),
        (("export", "fake.nc", "--to", "csv"), ["fake.nc"]),
        (("new", "x", "--load", "10 kN", "--eccentricity", "0.5"), ["not both"]),
        (("new", "x", "--load", "ten"), ["load", "ten"]),
    ],
)
def test_bad_arguments_end_with_2_and_one_readable_message(arguments, words, tiny, tmp_path, here):
    (tmp_path / "fake.nc").write_text("no table")
    (tmp_path / "fake.csv").write_text("no,table\n1,2\n")
    done = here(*arguments, "--json")
    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr
    assert done.stderr.startswith("error: ")
    for word in words:
        assert word in done.stderr
    assert strict(done.stdout)["error"]["message"] in done.stderr


def test_unknown_options_end_with_2(here):
    done = here("solve", "--no-such-option")
    assert done.returncode == 2
    assert "Traceback" not in done.stderr


@pytest.mark.slow
def test_run_does_the_whole_job(tiny, tmp_path):
    done = rotorsim("run", tiny, "--output", "out", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    said = strict(done.stdout)
    assert said["counts"] == {"converged": 8}
    assert said["problems"] == []
    for paths in said["files"].values():
        assert paths
        assert all((tmp_path / path).stat().st_size > 0 for path in paths)
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "coefficients",
        "figures",
        "logs",
    }
    (heating,) = said["heating"]
    for model in ("isothermal", "thd"):
        one = heating[model]
        stable = one["critical_mass"] > 1200.0
        assert one["verdict"] == ("stable" if stable else "unstable")
        assert one["power_loss"] == pytest.approx(one["friction_force"] * 15000 * np.pi / 30 * 0.05)
        crossed = one["threshold_speeds"]
        assert (one["verdict_over_range"] == "changes") == bool(crossed)
        assert one["threshold_speed"] == (crossed[0] if crossed else None)
    kinds = [(orbit["thermal_model"], orbit["kind"]) for orbit in said["orbits"]]
    assert kinds == [
        ("isothermal", "constant speed"),
        ("thd", "constant speed"),
        ("isothermal", "run-up"),
        ("thd", "run-up"),
    ]
    for orbit in said["orbits"][:2]:
        assert orbit["growth_rate"] == pytest.approx(orbit["eigenvalue_growth_rate"], rel=0.01)


@pytest.mark.slow
def test_run_shows_a_summary_that_fits_the_terminal(tiny, here):
    done = here("run", tiny)
    assert done.returncode == 0, done.stderr
    assert max(map(len, done.stdout.splitlines())) <= 100
    for words in ("8 film points, 8 converged", "by heating", "threshold rpm", "tiny.rrd"):
        assert words in done.stdout
    for column in ("h_min µm", "loss kW", "L/min", "M_crit kg"):
        assert column in done.stdout
    table = done.stdout.split("At 15000 rpm")[1].split("Stability")[0]
    assert max(map(len, table.splitlines())) <= 90


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_an_interruption_says_what_is_kept_and_the_next_run_resumes(tmp_path):
    path = tmp_path / "long.toml"
    text = TINY.replace("count = 4", "count = 400").replace("axial = 8", "axial = 16")
    path.write_text(text, encoding="utf-8")
    journal = tmp_path / "coefficients" / "long.nc.journal"
    process = subprocess.Popen(
        [sys.executable, "-m", "rotorsim", "table", str(path)],
        cwd=tmp_path,
        env=environment(),
        stderr=subprocess.PIPE,
        text=True,
    )
    end = time.monotonic() + 60
    while not (journal.exists() and journal.read_text().count("\n") > 2):
        assert process.poll() is None, process.stderr.read()
        assert time.monotonic() < end
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "Traceback" not in said
    assert re.search(r"interrupted: finished points are in .*long\.nc\.journal", said)
    # The same command goes on: shortened here to what is already there, it computes nothing.
    lines = journal.read_text().splitlines()
    speeds = [point["speed"] for point in json.loads(lines[1])["points"]]
    listed = ", ".join(f'"{speed!r} rad/s"' for speed in speeds)
    model = json.loads(lines[1])["points"][0]["thermal_model"]
    text = re.sub(r"speed = \{ start.*\}", f"speed = [{listed}]", text)
    text = text.replace('["isothermal", "thd"]', f'["{model}"]').replace(
        'speed = "15000 rpm"', f'speed = "{speeds[-1]!r} rad/s"'
    )
    path.write_text(text, encoding="utf-8")
    done = rotorsim("table", path, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "resuming: " in done.stderr
    assert not journal.exists()
    assert (tmp_path / "coefficients" / "long.nc").exists()


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="POSIX pipes")
def test_a_closed_pipe_is_no_error(tmp_path):
    command = f'"{sys.executable}" -m rotorsim check "{QUICK}" --json | head -n 1'
    done = subprocess.run(
        command, shell=True, cwd=tmp_path, env=environment(), capture_output=True, text=True
    )
    assert done.stdout == "{\n"
    assert done.stderr == ""


def test_warnings_that_differ_in_numbers_alone_are_told_once():
    import dataclasses

    from rotorsim.bearing.description import grouped_warnings
    from rotorsim.bearing.operating_point import failed_point
    from rotorsim.files.scenario import Scenario

    case = Scenario.from_text(TINY).case(thermal_model="thd")
    points = [
        dataclasses.replace(
            failed_point(case, 100.0 * number, ""),
            warnings=(f"Taylor number {number}.5 is above 41.2", "hot") if number < 5 else ("hot",),
        )
        for number in range(3, 7)
    ]
    lines = grouped_warnings(points)
    assert len(lines) == 2
    assert lines[0].startswith("Taylor number 4.5 is above 41.2 (at 2 of 4 points, from thd")
    assert lines[1].startswith("hot (at 4 of 4 points")


def test_no_command_gives_one_short_option_two_meanings():
    from typer.main import get_group

    from rotorsim.cli.app import app

    for name, command in get_group(app).commands.items():
        short = [flag for one in command.params for flag in one.opts if not flag.startswith("--")]
        assert len(short) == len(set(short)), name


def test_help_shows_words_in_square_brackets():
    from typer.testing import CliRunner

    from rotorsim.cli.app import app

    assert "[transient]" in CliRunner().invoke(app, ["transient", "--help"]).output


@pytest.mark.skipif(os.name == "nt", reason="POSIX terminals")
def test_a_narrow_terminal_cuts_no_number(tmp_path):
    import fcntl
    import pty
    import struct
    import termios

    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 40, 0, 0))
    with_terminal = {**environment(), "TERM": "xterm"}
    del with_terminal["COLUMNS"]
    process = subprocess.Popen(
        [sys.executable, "-m", "rotorsim", "check", str(QUICK)],
        cwd=tmp_path, env=with_terminal, stdout=theirs, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    os.close(theirs)
    said = b""
    # Linux reports the end of a terminal as an error.
    with contextlib.suppress(OSError):
        while part := os.read(ours, 65536):
            said += part
    os.close(ours)
    assert process.wait(30) == 0
    assert "Sommerfeld" in said.decode()
    assert "…" not in said.decode()
