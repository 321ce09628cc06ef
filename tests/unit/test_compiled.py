"""Machine code on disk belongs to the sources that it was made from."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from linear_orbits import constant_coefficients

import rotorsim
from rotorsim.orbit import LinearForce, OrbitProblem, ShortBearingForce, SpeedSchedule, simulate
from rotorsim.orbit.march import march
from rotorsim.rotor import Rotor

PACKAGE = Path(rotorsim.__file__).parents[1]
SCENARIOS = Path(__file__).parents[2] / "scenarios"
CALLED = (
    "from rotorsim.compiled import compiled\nSCALE = 2.0\n@compiled()\ndef called(x): return {}\n"
)
CALLS = (
    "from called import SCALE, called\nfrom rotorsim.compiled import compiled\n"
    "@compiled({})\ndef calls(x): return called(x) * SCALE\n"
)
RUN = (
    "from calls import calls\nprint(calls(3.0), len(calls.stats.cache_hits), "
    "len(calls.stats.cache_misses))"
)


def run(folder: Path, code: str = RUN, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": f"{folder}{os.pathsep}{PACKAGE}", **environment},
        capture_output=True, text=True, check=True, cwd=folder,
    )  # fmt: skip


@pytest.fixture
def sources(tmp_path: Path) -> Path:
    (tmp_path / "called.py").write_text(CALLED.format("x + 1.0"))
    (tmp_path / "calls.py").write_text(CALLS.format(""))
    return tmp_path


@pytest.mark.slow
def test_the_cache_follows_what_is_called_and_its_constants(sources: Path):
    assert run(sources).stdout.split() == ["8.0", "0", "1"]
    assert run(sources, PYTHONHASHSEED="5").stdout.split() == ["8.0", "1", "0"]
    times = os.stat(sources / "called.py")
    for text, value in (
        (CALLED.format("x - 1.0"), "4.0"),
        (CALLED.format("x - 1.0").replace("2.0", "5.0"), "10.0"),
    ):
        # The same size and time: only the contents tell.
        (sources / "called.py").write_text(text)
        os.utime(sources / "called.py", ns=(times.st_atime_ns, times.st_mtime_ns))
        for entry in (sources / "__pycache__").glob("called.*.pyc"):
            entry.unlink()  # Python's own cache looks at time and size
        assert run(sources).stdout.split() == [value, "0", "1"]
    assert run(sources).stdout.split() == ["10.0", "1", "0"]


@pytest.mark.slow
def test_the_cache_follows_the_options(sources: Path):
    run(sources)
    (sources / "calls.py").write_text(CALLS.format("fastmath=True"))
    assert run(sources).stdout.split() == ["8.0", "0", "1"]


@pytest.mark.slow
def test_a_damaged_cache_counts_as_missing(sources: Path):
    run(sources)
    for entry in (sources / "__pycache__").glob("*.nb?"):
        data = bytearray(entry.read_bytes())
        data[len(data) // 2] ^= 4
        entry.write_bytes(data)
    assert run(sources).stdout.split() == ["8.0", "0", "1"]


@pytest.mark.slow
def test_without_a_folder_code_is_compiled_anew_and_that_is_said_once(sources: Path):
    """Files where folders should be stand for folders that nobody may write to."""
    (sources / "nowhere").touch()
    environment = {"NUMBA_CACHE_DIR": "", "HOME": str(sources / "nowhere"),
                   "XDG_CACHE_HOME": str(sources / "nowhere")}  # fmt: skip
    code = "import sys; sys.dont_write_bytecode = True\n" + RUN
    (sources / "__pycache__").touch()
    for _ in range(2):
        done = run(sources, code, **environment)
        assert done.stdout.split() == ["8.0", "0", "1"]
        assert done.stderr.count("compiled code cannot be kept here") == 1


def test_the_steps_of_a_motion_are_compiled_once():
    """For one type of each argument: read-only matrices would be another."""
    film = ShortBearingForce(viscosity=0.01, length=0.02, radius=0.02, radial_clearance=1e-4)
    linear = LinearForce(constant_coefficients(1e6 * np.eye(2), 1e3 * np.eye(2)), 1e-4)
    for force in (film, linear):
        for speeds in (SpeedSchedule.constant(100.0, 1.0), SpeedSchedule.ramp(100.0, 200.0, 0.1)):
            simulate(OrbitProblem(force, Rotor.rigid(1.0), speeds, static_load=(10.0, 0.0)))
    assert len(march.signatures) == 1, march.signatures


def test_what_is_kept_on_disk_is_known(sources: Path):
    code = (
        "from calls import calls\nfrom rotorsim.compiled import is_kept\n"
        "print(is_kept(calls)); calls(3.0); print(is_kept(calls))"
    )
    assert run(sources, code).stdout.split() == ["False", "True"]
    assert run(sources, code).stdout.split() == ["True", "True"]


@pytest.mark.slow
def test_the_main_job_compiles_ahead(tmp_path: Path):
    code = (
        "from rotorsim import load_scenario; from rotorsim.compiled import is_kept\n"
        "from rotorsim.machine.rates import _fill_rates; from rotorsim.orbit.march import march\n"
        "from rotorsim.study.main_job import compiled_ahead\n"
        f"with compiled_ahead(load_scenario({str(SCENARIOS / 'dal.toml')!r})):\n"
        "    print(is_kept(march))\n"
        "print(is_kept(march), is_kept(_fill_rates))"
    )
    answer = run(tmp_path, code, NUMBA_CACHE_DIR=str(tmp_path / "cache"))
    assert answer.stdout.split() == ["False", "True", "True"]
