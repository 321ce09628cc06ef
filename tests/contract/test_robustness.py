"""What goes wrong outside: nonsense on the command line, damaged files, kills at any moment."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from command_line import CommandLine, strict
from scenario_texts import SMALL

import rotorsim
import rotorsim as rs

ROOT = Path(__file__).parents[2]
PACKAGE = Path(rotorsim.__file__).parents[1]
TINY = f"""\
title = "tiny"
{SMALL}revolutions = 4
initial_displacement = ["1 um", "0 um"]
"""


@pytest.fixture(scope="module")
def good_table(tmp_path_factory) -> Path:
    from rotorsim.files.scenario import Scenario
    from rotorsim.study.sweep import tabulate

    path = tmp_path_factory.mktemp("good") / "good.nc"
    return tabulate(Scenario.from_text(TINY), workers=1).save(path)


@pytest.fixture
def nonsense(here: CommandLine, tmp_path: Path, good_table: Path) -> CommandLine:
    """Call the command line within a folder of good and of useless files."""
    noise = np.random.default_rng(1).bytes(3000)
    for name in ("noise.toml", "noise.nc", "noise.csv", "noise.json", "noise.rrd"):
        (tmp_path / name).write_bytes(noise)
    for name in ("empty.toml", "empty.nc", "empty.csv", "empty.json", "empty.rrd", "file"):
        (tmp_path / name).touch()
    for name in ("folder.toml", "folder.nc", "folder.csv", "folder.json", "folder.rrd"):
        (tmp_path / name).mkdir()
    (tmp_path / "good.toml").write_text(TINY, encoding="utf-8")
    shutil.copy(good_table, tmp_path / "good.nc")
    return here


USELESS = ("noise", "empty", "folder", "missing")
READERS = [
    *((command, "toml") for command in ("run", "check", "solve", "table", "orbit", "report")),
    *(("stability", kind) for kind in ("toml", "nc", "csv", "json")),
    *(("export", kind) for kind in ("nc", "csv", "json")),
    ("view", "rrd"),
]


@pytest.mark.slow
@pytest.mark.parametrize(("command", "kind"), READERS)
@pytest.mark.parametrize("name", USELESS)
def test_useless_files_are_refused_by_name(command, kind, name, nonsense, tmp_path):
    before = sorted(os.listdir(tmp_path))
    options = ["--to", "csv"] if command == "export" else []
    done = nonsense(command, f"{name}.{kind}", *options, "--json")
    assert done.returncode == 2, done.stderr
    assert f"{name}.{kind}" in done.stderr
    assert "Traceback" not in done.stderr
    assert strict(done.stdout)["error"]["message"]
    assert sorted(os.listdir(tmp_path)) == before


@pytest.mark.parametrize(
    "words",
    [
        ("run", "good.toml", "--output", "file"),
        ("table", "good.toml", "--output", "file/x.nc"),
        ("table", "good.toml", "--output", "folder.nc"),
        ("table", "good.toml", "--output", "table.txt"),
        ("orbit", "good.toml", "--output", "folder.rrd"),
        ("report", "good.toml", "--output", "file/x.html"),
        ("report", "good.toml", "--output", "."),
        ("export", "good.nc", "--to", "csv", "--output", "file"),
        ("export", "good.nc", "--to", "nc"),
        ("export", "good.nc", "--to", "xlsx"),
        ("export", "good.nc", "--to", ""),
        ("export", "good.nc", "--to", "csv,mat", "--load-direction", "45 deg"),
        ("export", "good.nc", "--to", "ross", "--load-direction", "45"),
        ("orbit", "good.toml", "--table", "noise.nc"),
        ("orbit", "good.toml", "--table", "good.nc", "--model", "hot"),
        ("solve", "good.toml", "--speed", "-5 rpm"),
        ("solve", "good.toml", "--speed", "nan rpm"),
        ("solve", "good.toml", "--speed", "1e300 rpm"),
        ("solve", "good.toml", "--speed", "9**9**9 rpm"),
        ("solve", "good.toml", "--workers", "-1"),
        ("table", "good.toml", "--workers", "0"),
        ("stability", "good.nc", "--mass", "-1 kg"),
        ("stability", "good.nc", "--mass", "1e300 kg"),
        ("new", ""),
        ("new", ".."),
        ("new", "file/x"),
        ("new", "x.txt"),
        ("new", "x.nc"),
        ("new", "x", "--iso-vg", "0"),
        ("new", "x", "--iso-vg", "nan"),
        ("new", "x", "--eccentricity", "1"),
        ("new", "x", "--load", ""),
        ("new", "x", "--load", '"'),
        ("new", "x", "--example", "../x"),
        ("new", "x", "--example", "dal", "--load", "1 kN"),
    ],
)
def test_nonsense_is_refused_before_any_work(words, nonsense, tmp_path):
    before = sorted(os.listdir(tmp_path))
    done = nonsense(*words, "--json")
    assert done.returncode == 2, done.stderr
    assert done.stderr.splitlines()[-1].startswith("error: ")
    assert "Traceback" not in done.stderr
    assert strict(done.stdout)["error"]["message"]
    assert sorted(os.listdir(tmp_path)) == before


def test_shipped_scenarios_are_found_by_name(nonsense):
    done = nonsense("check", "quick", "--json")
    assert done.returncode == 0
    assert strict(done.stdout)["points"] == 10
    done = nonsense("check", "quikc")
    assert done.returncode == 2
    assert "quick" in done.stderr
    assert nonsense("new", "mine", "--example", "quick", "--quiet").returncode == 0
    shipped = (ROOT / "scenarios" / "quick.toml").read_text(encoding="utf-8")
    assert Path("mine.toml").read_text(encoding="utf-8") == shipped


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--load", "ten"), "error: --load: must be a force"),
        (("--load", "18 t"), "error: --load: "),
        (("--eccentricity", "1.5"), "error: --eccentricity: must be below 1"),
        (("--iso-vg", "3"), "error: --iso-vg: must be above 5"),
    ],
)
def test_new_names_the_option_and_no_file_that_is_not_there(words, said, nonsense):
    done = nonsense("new", "mine", *words)
    assert done.returncode == 2
    assert done.stderr.startswith(said)
    assert "mine" not in done.stderr


def test_new_suggests_commands_that_can_be_pasted(nonsense, tmp_path):
    (tmp_path / "my pump").mkdir()
    done = nonsense("new", "my pump/x 1.2")
    assert done.returncode == 0, done.stderr
    checked = next(line for line in done.stdout.splitlines() if "rotorsim check" in line)
    assert shlex.split(checked) == ["rotorsim", "check", "my pump/x 1.2.toml"]
    assert nonsense(*shlex.split(checked)[1:], "--quiet").returncode == 0
    done = nonsense("new", "x.txt")
    assert 'write for example "x.toml"' in done.stderr


def test_shipped_names_are_completed():
    from rotorsim.cli.file_commands import _shipped_names

    assert _shipped_names("orbit_s") == ["orbit_step", "orbit_subcritical"]
    assert "dal" in _shipped_names("")


def test_keys_of_a_scenario_are_completed():

    def completed(scenario: str, half: str) -> list[str]:
        """By the shell's own way: what the program answers to a half-typed command."""
        words = f"rotorsim stability {scenario} --x speed --y {half}"
        asked = {"_ROTORSIM_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": "6"}
        answer = subprocess.run(
            [sys.executable, "-m", "rotorsim"], env={**os.environ, **asked}, capture_output=True,
            text=True, timeout=60, check=False,
        )  # fmt: skip
        return answer.stdout.split()

    assert "bearing.pocket[0].depth" in completed("pressure_dam", "bearing.pocket[0].d")
    assert completed("no_such_file", "lo") == ["load"]


def test_a_clearance_is_answered_in_the_unit_of_drawings(nonsense):
    done = nonsense("control", "good.toml", "--clearance", "0.18 mm")
    assert done.returncode == 2
    assert done.stderr.startswith("error: --clearance: must be one that the scenario lists in")
    assert "bearing.radial_clearance: 100 um;" in done.stderr
    assert "(found: '0.18 mm')" in done.stderr


def tampered(path: Path, how: str) -> str:
    import h5py

    if how == "truncated":
        data = path.read_bytes()
        path.write_bytes(data[: len(data) // 2])
        return "truncated or damaged"
    with h5py.File(path, "r+") as file:
        if how == "newer":
            file.attrs["rotorsim_table_version"] = 99
            return "use a newer rotorsim"
        if how == "foreign":
            del file.attrs["rotorsim_table_version"]
            return "not a coefficient table"
        file.attrs["scenario"] = TINY.replace("1200 kg", "900 kg")
    return "does not match its SHA-256"


@pytest.mark.slow
@pytest.mark.parametrize("how", ["truncated", "newer", "foreign", "scenario changed"])
@pytest.mark.parametrize(
    "words",
    [
        ("stability", "good.nc"),
        ("export", "good.nc", "--to", "ross"),
        ("orbit", "good.toml", "-t", "good.nc"),
    ],
)
def test_damaged_and_newer_tables_are_refused_with_a_reason(how, words, nonsense):
    reason = tampered(Path("good.nc"), how)
    done = nonsense(*words)
    assert done.returncode == 2
    assert "good.nc" in done.stderr
    assert reason in done.stderr


KILLING = """
import json, os, random, signal, sys, time
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import ClassVar
from rotorsim.study.finished import Journal
from rotorsim.files.scenario import Scenario
from rotorsim.study.sweep import sweep_points, tabulate

scenario, journal = Scenario.from_text(Path(sys.argv[1]).read_text()), Path(sys.argv[2])
cases, speeds = list(scenario.cases()), [float(speed) for speed in scenario.speeds]
sweep_points(cases, speeds[:5], workers=1)  # what the children need is loaded and compiled now
start = time.perf_counter()
sweep_points(cases, speeds[:5], workers=1)
pace = (time.perf_counter() - start) / 5
dice, kills, told_in_all = random.Random(7), 0, set()
for _ in range(40):
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        def tell(done, total, point):
            os.write(writer, json.dumps(point.speed).encode() + b"\\n")
        sweep_points(cases, speeds, workers=1, progress=tell, resume=journal)
        os._exit(0)
    os.close(writer)
    time.sleep(dice.uniform(0.0, 60.0 * pace))
    os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    kills += os.WIFSIGNALED(status)
    told = b"".join(iter(lambda: os.read(reader, 65536), b""))
    os.close(reader)
    told_in_all |= {json.loads(line) for line in told.split(b"\\n")[:-1]}
    kept = Journal(journal)
    lost = [speed for speed in told_in_all if kept.find(cases[0], speed) is None]
    assert not lost, lost
    if kills == 20:
        break
few = sorted(told_in_all)[::10]
resumed = sweep_points(cases, few, workers=1, resume=journal)
fresh = sweep_points(cases, few, workers=1)
same = all(
    abs(a.stiffness / b.stiffness - 1.0).max() < 1e-4 for a, b in zip(resumed, fresh, strict=True)
)
print(json.dumps({"kills": kills, "told": len(told_in_all), "same": same}))
"""


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="POSIX processes")
def test_killing_a_sweep_twenty_times_loses_no_finished_point(tmp_path):
    scenario = tmp_path / "long.toml"
    speeds = 'speed = { start = "500 rpm", stop = "15000 rpm", count = 600 }'
    text = TINY.replace('speed = ["6000 rpm", "9000 rpm"]', speeds).replace(
        "eccentricity_ratio = 0.5", 'load = "10 kN"'
    )
    scenario.write_text(text.split("[orbit]")[0], encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", KILLING, scenario, tmp_path / "long.journal"],
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert said["kills"] == 20
    assert said["told"] >= 10  # the kills met a sweep at work
    assert said["same"]


QUICK = TINY.split("[rotor]")[0]
"""Two points of an isothermal film."""


def started(folder: Path, *words: str, **options) -> subprocess.Popen[str]:
    (folder / "quick.toml").write_text(QUICK, encoding="utf-8")
    return subprocess.Popen(
        [sys.executable, "-m", "rotorsim", *words], cwd=folder, text=True,
        stdout=options.pop("stdout", subprocess.PIPE), stderr=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": str(PACKAGE)}, **options,
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="Linux")
@pytest.mark.parametrize("words", [["check", "quick.toml", "--json"], ["check", "quick.toml"]])
def test_a_full_standard_output_is_said(words, tmp_path):
    with Path("/dev/full").open("w") as full:
        process = started(tmp_path, *words, stdout=full)
        _, said = process.communicate(timeout=60)
    assert process.returncode == 2
    assert said == "error: standard output: No space left on device\n"


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
@pytest.mark.parametrize(("name", "code"), [("SIGTERM", 143), ("SIGINT", 130)])
def test_a_process_that_is_asked_to_end_leaves_no_temporary_file(name, code, tmp_path):
    """Asked while a file is written: the writing waits for it."""
    (tmp_path / "slow.py").write_text(
        "import os, sys, time, rotorsim.atomic as atomic\n"
        "def flush(path):\n"
        "    print('writing', flush=True)\n"
        "    time.sleep(30)\n"
        "atomic._flush_to_disk = flush\n"
        "sys.argv = ['rotorsim', 'new', 'x']\n"
        "from rotorsim.cli import main\n"
        "main()\n"
    )
    process = subprocess.Popen(
        [sys.executable, "slow.py"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True, env={**os.environ, "PYTHONPATH": str(PACKAGE)},
    )  # fmt: skip
    assert process.stdout is not None
    assert process.stdout.readline() == "writing\n"
    process.send_signal(getattr(signal, name))
    _, said = process.communicate(timeout=20)
    assert (process.returncode, said) == (code, "interrupted: nothing was changed\n")
    assert sorted(os.listdir(tmp_path)) == ["slow.py"]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="POSIX")
@pytest.mark.parametrize("suffix", ["toml", "nc", "csv", "json", "npz", "mat", "rrd", "txt"])
def test_pipes_and_long_names_are_refused_at_once(suffix, nonsense, tmp_path):
    os.mkfifo(tmp_path / f"pipe.{suffix}")
    commands = {
        "toml": ["run", "check", "solve", "table", "orbit", "report", "stability", "control"],
        "rrd": ["view"],
    }.get(suffix, ["stability"])
    for name in (f"pipe.{suffix}", "n" * 300 + f".{suffix}"):
        for command in commands:
            done = nonsense(command, name)
            assert done.returncode == 2, (command, done.stderr)
            assert done.stderr.startswith(f"error: {name}: ")
        if suffix in ("npz", "mat"):
            done = nonsense("stability", "good.nc", "--rotor", name)
            assert done.returncode == 2
            assert name in done.stderr
        done = nonsense("export", name, "--to", "csv")
        assert done.returncode == 2


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="POSIX")
def test_a_file_size_limit_ends_with_a_message_and_the_old_table(good_table, tmp_path):
    shutil.copy(good_table, tmp_path / "good.nc")
    for form, name in (("nc", "out/good.nc"), ("mat", "out/good.mat")):
        limited = (
            "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))\n"
            "from rotorsim.cli import main\n"
            f"sys.argv = ['rotorsim', 'export', 'good.nc', '--to', '{form}', '-o', 'out']\n"
            "main()"
        )
        (tmp_path / "out").mkdir(exist_ok=True)
        (tmp_path / name).write_text("old")
        done = subprocess.run(
            [sys.executable, "-c", limited], cwd=tmp_path, capture_output=True, text=True,
            env={**os.environ, "PYTHONPATH": str(PACKAGE)}, timeout=60,
        )  # fmt: skip
        assert done.returncode == 2, done.stderr
        assert done.stderr.startswith(f"error: {name}: ")
        assert "File too large" in done.stderr
        assert (tmp_path / name).read_text() == "old"
    assert sorted(os.listdir(tmp_path / "out")) == ["good.mat", "good.nc"]


@pytest.mark.slow
def test_failed_points_cost_neither_the_journal_nor_an_older_table(
    here: CommandLine, tmp_path, monkeypatch
):
    """A point fails once: the good table stays, and the next run computes that point alone."""
    import rotorsim.bearing.solve as film

    (tmp_path / "quick.toml").write_text(QUICK, encoding="utf-8")
    table, journal = tmp_path / "coefficients/quick.nc", tmp_path / "coefficients/quick.nc.journal"
    whole, solved = film.solve_case, []

    def failing(case, speed, *, initial=None):
        solved.append(speed)
        if speed > 700.0 and len(solved) == 2:
            raise RuntimeError("worker gone")
        return whole(case, speed, initial=initial)

    monkeypatch.setattr(film, "solve_case", failing)
    words = ("table", "quick.toml", "--workers", "1", "--json")
    done = here(*words)  # no older table: what there is is written
    assert done.returncode == 1
    assert "1 points failed: the same command tries them again" in done.stderr
    assert journal.exists()
    assert strict(done.stdout)["counts"] == {"converged": 1, "failed": 1}
    done = here(*words)
    assert done.returncode == 0, done.stderr
    assert len(solved) == 3
    assert not journal.exists()
    good = table.read_bytes()
    solved.clear()
    done = here(*words)
    assert done.returncode == 1
    assert f"{Path('coefficients/quick.nc')} is left as it was" in done.stderr
    assert table.read_bytes() == good
    assert journal.exists()


@pytest.mark.slow
def test_a_table_that_agrees_is_left_as_it_is(here: CommandLine, tmp_path):
    """So that a run of a shipped scenario leaves the checkout clean."""
    scenario = tmp_path / "quick.toml"
    table = tmp_path / "coefficients/quick.nc"
    scenario.write_text(QUICK, encoding="utf-8")
    assert here("table", scenario).returncode == 0
    first = table.read_bytes()
    old = rs.CoefficientTable.load(table)
    for change, kept in ((1.0 + 1e-7, True), (1.0 + 1e-3, False)):
        moved = old.dataset.assign(kxy=old.dataset["kxy"] * change).assign_attrs(date="1999")
        rs.CoefficientTable(moved).save(table)
        done = here("table", scenario)
        assert ("holds these numbers already" in done.stderr) is kept
        assert (rs.CoefficientTable.load(table).dataset.attrs["date"] == "1999") is kept
    for key in ("mesh", "scenario"):
        other = rs.CoefficientTable(old.dataset.assign_attrs({key: "another"}))
        assert not old.agrees_with(other)
    assert not old.agrees_with(rs.CoefficientTable(old.dataset.drop_vars("moment_x")))
    scenario.write_text(QUICK + "\n# a comment\n", encoding="utf-8")
    assert "holds these" not in here("table", scenario).stderr
    assert table.read_bytes() != first


@pytest.fixture
def dask(monkeypatch):
    """Stand-ins for Dask's packages: a scheduler without workers, which one can lose."""
    import types

    class Client:
        workers: ClassVar[dict[str, str]] = {}

        def __init__(self, address, timeout):
            if address.endswith(":1"):
                raise OSError(f"Timed out trying to connect to {address} after {timeout}")

        def __enter__(self):
            return self

        def __exit__(self, *_):
            return None

        def scheduler_info(self):
            return {"workers": self.workers}

        def get_executor(self):
            return Lost()

    class Lost(Executor):
        def submit(self, fn, /, *args, **kwargs):
            time.sleep(0.3)
            future: Future = Future()
            future.cancel()
            future.set_running_or_notify_cancel()
            return future

    settings: dict[str, str] = {}
    fakes = {
        "distributed": types.SimpleNamespace(Client=Client),
        "dask": types.SimpleNamespace(config=types.SimpleNamespace(set=settings.update)),
    }
    for name, fake in fakes.items():
        monkeypatch.setitem(sys.modules, name, fake)
    monkeypatch.setattr("rotorsim.cli.options._PATIENCE", 0.1)


@pytest.mark.usefixtures("dask")
def test_schedulers_that_are_dead_lost_or_without_workers_are_told_apart(
    here: CommandLine, tmp_path
):
    (tmp_path / "quick.toml").write_text(QUICK, encoding="utf-8")
    done = here("table", "quick.toml", "--scheduler", "tcp://127.0.0.1:1")
    assert done.returncode == 2
    assert "error: --scheduler: no scheduler answers (Timed out" in done.stderr
    done = here("table", "quick.toml", "--scheduler", "tcp://127.0.0.1:2")
    assert done.returncode == 1
    assert "tcp://127.0.0.1:2 has no worker; one is started by: dask worker" in done.stderr
    assert "is the scheduler still there?" in done.stderr
