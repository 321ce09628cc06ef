"""The sweep: every point once, in order, on any executor, whatever fails or is killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import textwrap
import time
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from sweep_cases import CASES, SPEEDS, FakeSolver, fake_point, loads, make_case

import rotorsim
from rotorsim.bearing.operating_point import (
    failed_point,
    point_from_dict,
    point_to_dict,
    strict_json,
)
from rotorsim.errors import InputError
from rotorsim.model import (
    ThermalModel,
)
from rotorsim.status import SolveStatus
from rotorsim.study.finished import Journal
from rotorsim.study.sweep import CHUNK, sweep_points

PACKAGE = Path(rotorsim.__file__).parents[1]
EXPECTED = [speed * case.bearing.radial_clearance for case in CASES for speed in SPEEDS]


@pytest.mark.parametrize("where", ["here", "threads"])
def test_points_come_back_case_by_case_in_order_of_speed(where):
    solver = FakeSolver()
    if where == "here":
        points = sweep_points(CASES, SPEEDS, workers=1, solve_case=solver)
    else:
        with ThreadPoolExecutor(3) as executor:
            points = sweep_points(CASES, SPEEDS, executor=executor, solve_case=solver)
    assert loads(points) == EXPECTED
    assert len(solver.calls) == len(EXPECTED)


def test_each_chunk_is_warm_started_along_the_speed():
    solver = FakeSolver()
    sweep_points(CASES[:1], SPEEDS, workers=1, solve_case=solver)
    started_from = [initial for _, _, initial in solver.calls]
    expected = [None if index % CHUNK == 0 else SPEEDS[index - 1] for index in range(len(SPEEDS))]
    assert started_from == expected


def test_a_failing_point_costs_itself_alone_and_the_next_starts_cold():
    solver = FakeSolver(broken=(SPEEDS[1],))
    points = sweep_points(CASES[:1], SPEEDS, workers=1, solve_case=solver)
    assert [point.status for point in points].count(SolveStatus.FAILED) == 1
    assert points[1].message == "ZeroDivisionError: no film"
    assert np.isnan(points[1].stiffness).all()
    assert solver.calls[2][2] is None
    assert points[2].converged


def test_progress_counts_every_point_once():
    seen = []
    sweep_points(
        CASES,
        SPEEDS,
        workers=1,
        solve_case=FakeSolver(),
        progress=lambda done, total, point: seen.append((done, total, point.speed)),
    )
    assert [done for done, _, _ in seen] == list(range(1, 25))
    assert {total for _, total, _ in seen} == {24}


class LosesWorkers(Executor):
    """Every second task is lost."""

    def __init__(self) -> None:
        self.count = 0

    def submit(self, fn, /, *args, **kwargs):
        self.count += 1
        future: Future = Future()
        if self.count % 2:
            future.set_result(fn(*args, **kwargs))
        else:
            future.set_exception(OSError("node gone"))
        return future


def test_a_foreign_executor_that_loses_tasks_yields_failed_points():
    points = sweep_points(CASES, SPEEDS, executor=LosesWorkers(), solve_case=FakeSolver())
    failed = [point for point in points if point.status is SolveStatus.FAILED]
    assert 0 < len(failed) < len(points)
    assert all("node gone" in point.message for point in failed)


@pytest.mark.parametrize("arguments", [{"workers": 0}, {"workers": 2, "executor": LosesWorkers()}])
def test_contradictory_arguments_are_refused(arguments):
    with pytest.raises(InputError):
        sweep_points(CASES, SPEEDS, solve_case=FakeSolver(), **arguments)


def test_an_interrupted_sweep_resumes_and_computes_nothing_twice(tmp_path):
    journal = tmp_path / "sweep.journal"
    first = FakeSolver()

    def interrupt(done, total, point):
        if done == 10:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep_points(CASES, SPEEDS, workers=1, solve_case=first, resume=journal, progress=interrupt)
    second = FakeSolver()
    points = sweep_points(CASES, SPEEDS, workers=1, solve_case=second, resume=journal)
    assert loads(points) == EXPECTED
    done_first, done_second = ({call[:2] for call in s.calls} for s in (first, second))
    assert len(done_first) == 10
    assert not done_first & done_second
    third = FakeSolver()
    sweep_points(CASES, SPEEDS, workers=1, solve_case=third, resume=journal)
    assert third.calls == []


def test_the_journal_is_not_used_for_another_case(tmp_path):
    journal = tmp_path / "sweep.journal"
    sweep_points(CASES[:1], SPEEDS, workers=1, solve_case=FakeSolver(), resume=journal)
    other = FakeSolver()
    cold = make_case(1e-4, ThermalModel.ISOTHERMAL)
    sweep_points([cold], SPEEDS, workers=1, solve_case=other, resume=journal)
    assert len(other.calls) == len(SPEEDS)


def test_an_interruption_inside_compiled_code_ends_the_sweep():
    def solver(case, speed, initial=None):
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt as stop:
            try:
                raise SystemError("returned a result with an exception set") from stop
            except SystemError as error:
                raise SystemError("once more") from error

    with pytest.raises(KeyboardInterrupt):
        sweep_points(CASES, SPEEDS, workers=1, solve_case=solver)


def test_failed_points_are_tried_again_on_resuming(tmp_path):
    journal = tmp_path / "sweep.journal"
    broken = FakeSolver(broken=(SPEEDS[3],))
    sweep_points(CASES[:1], SPEEDS, workers=1, solve_case=broken, resume=journal)
    healed = FakeSolver()
    points = sweep_points(CASES[:1], SPEEDS, workers=1, solve_case=healed, resume=journal)
    assert [call[1] for call in healed.calls] == [SPEEDS[3]]
    assert all(point.converged for point in points)


def test_journal_gives_back_the_same_point(tmp_path):
    point = fake_point(CASES[0], 1234.5678901234567, max_pressure=np.pi * 1e6)
    Journal(tmp_path / "j").add(CASES[0], [point])
    back = Journal(tmp_path / "j").find(CASES[0], point.speed)
    assert back is not None
    # repr, for NaN is not equal to itself; it prints every float in full.
    assert repr(back) == repr(point)


@pytest.mark.parametrize("cut", range(2, 400, 7))
def test_a_journal_cut_anywhere_keeps_its_whole_lines(tmp_path, cut):
    path = tmp_path / "j"
    journal = Journal(path)
    for speed in SPEEDS[:3]:
        journal.add(CASES[0], [fake_point(CASES[0], speed)])
    text = path.read_bytes()
    path.write_bytes(text[:-cut])
    kept = Journal(path)
    assert len(kept) == text[:-cut].count(b"\n") - 1
    kept.add(CASES[0], [fake_point(CASES[0], 9.0)])
    assert Journal(path).find(CASES[0], 9.0) is not None
    assert len(Journal(path)) == len(kept)


def test_a_journal_of_another_program_version_is_started_afresh(tmp_path):
    path = tmp_path / "j"
    Journal(path).add(CASES[0], [fake_point(CASES[0], 1.0)])
    lines = path.read_text().splitlines()
    lines[0] = json.dumps({**json.loads(lines[0]), "model": "another"})
    path.write_text("\n".join(lines) + "\n")
    assert len(Journal(path)) == 0


def test_a_file_that_is_no_journal_is_left_alone(tmp_path):
    path = tmp_path / "precious.txt"
    path.write_text("my results\n")
    with pytest.raises(InputError, match="not a rotorsim sweep journal"):
        Journal(path)
    assert path.read_text() == "my results\n"


def test_points_survive_the_way_through_json():
    point = fake_point(CASES[0], 100.0)
    assert repr(point_from_dict(json.loads(json.dumps(point_to_dict(point))))) == repr(point)


def test_strict_json_holds_no_nan():
    text = strict_json(point_to_dict(failed_point(CASES[0], 1.0, "why")))
    record = json.loads(text, parse_constant=lambda name: pytest.fail(name))
    assert record["load"] is None
    assert record["stiffness"] == [[None, None], [None, None]]
    assert record["status"] == "failed"


# The process pool: in a script of its own, without the guard that multiprocessing asks for, with a
# solver that its workers can import.
SOLVER = """
import os, sys, time
sys.path.insert(0, {tests!r})
from sweep_cases import CASES, SPEEDS, fake_point

def solve(case, speed, *, initial=None):
    with open({log!r}, "a") as stream:
        stream.write(f"{{os.getpid()}} {{case.bearing.radial_clearance}} {{speed}}\\n")
    time.sleep({pause})
    if speed in {deadly}:
        os._exit(7)
    return fake_point(case, speed), None
"""
SCRIPT = """
import solver_for_test as s
from rotorsim.study.sweep import sweep_points
points = sweep_points(s.CASES, s.SPEEDS, workers=2, solve_case=s.solve, resume={journal!r})
from rotorsim.bearing.operating_point import strict_json
print(strict_json([(point.speed, point.status, point.load) for point in points]))
"""


@pytest.fixture
def script(tmp_path):
    """Start the script with a given pause per point and speeds that kill their process."""

    def start(pause: float = 0.0, deadly: tuple[float, ...] = ()) -> subprocess.Popen:
        text = SOLVER.format(
            tests=str(Path(__file__).parents[1]),
            log=str(tmp_path / "calls"),
            pause=pause,
            deadly=deadly,
        )
        (tmp_path / "solver_for_test.py").write_text(textwrap.dedent(text))
        (tmp_path / "script.py").write_text(SCRIPT.format(journal=str(tmp_path / "journal")))
        return subprocess.Popen(
            [sys.executable, str(tmp_path / "script.py")],
            env={**os.environ, "PYTHONPATH": f"{tmp_path}{os.pathsep}{PACKAGE}"},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    return start


@pytest.mark.slow
def test_processes_serve_a_plain_script(script, tmp_path):
    process = script(pause=0.05)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    assert [row[2] for row in rows_of(out)] == EXPECTED
    pids = {line.split()[0] for line in (tmp_path / "calls").read_text().splitlines()}
    assert len(pids) == 2


@pytest.mark.slow
def test_a_point_that_kills_its_process_costs_itself_alone(script):
    process = script(deadly=(SPEEDS[2],))
    out, err = process.communicate(timeout=90)
    assert process.returncode == 0, err
    failed = [row for row in rows_of(out) if row[1] != "converged"]
    assert [row[0] for row in failed] == [SPEEDS[2], SPEEDS[2]]
    assert len(rows_of(out)) == len(EXPECTED)


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
@pytest.mark.parametrize("how", ["SIGKILL", "SIGINT"])
def test_killing_a_sweep_loses_no_finished_chunk_and_leaves_no_orphan(script, tmp_path, how):
    process = script(pause=0.1)
    journal, calls = tmp_path / "journal", tmp_path / "calls"
    wait_until(lambda: journal.exists() and journal.read_text().count("\n") >= 3)
    process.send_signal(getattr(signal, how))
    process.communicate(timeout=10)
    workers = {int(line.split()[0]) for line in calls.read_text().splitlines()}
    wait_until(lambda: not any(alive(pid) for pid in workers))
    finished = len(Journal(journal))
    assert finished >= CHUNK + len(SPEEDS) % CHUNK  # one of the two may be a curve's last, short
    calls.unlink()
    out, err = script().communicate(timeout=60)
    assert [row[2] for row in rows_of(out)] == EXPECTED, err
    assert len(calls.read_text().splitlines()) == len(EXPECTED) - finished


def rows_of(text: str) -> list[tuple[float, str, float]]:
    return [tuple(row) for row in json.loads(text)]


def wait_until(condition, seconds: float = 30.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


def alive(pid: int) -> bool:
    try:
        stat = Path(f"/proc/{pid}/stat").read_text()
    except FileNotFoundError:
        return False
    except OSError:
        return False
    return stat.rsplit(")", 1)[1].split()[0] != "Z"


# What may be damaged, or another program's


@pytest.mark.parametrize("old", ['"load": 0.01', '"speed": 100.0', '"status": "converged"'])
def test_a_changed_digit_in_the_journal_is_noticed(tmp_path, old):
    path = tmp_path / "j"
    for speed in SPEEDS[:2]:
        Journal(path).add(CASES[0], [fake_point(CASES[0], speed)])
    text = path.read_text()
    assert old in text
    new = {"0.01": "0.02", "100.0": "900.0", "converged": "diverging"}
    path.write_text(
        text.replace(old, next(old.replace(a, b) for a, b in new.items() if a in old), 1)
    )
    kept = Journal(path)
    assert len(kept) == 1
    assert kept.find(CASES[0], SPEEDS[1]) is not None


class Sends(Executor):
    """Sends work through pickle to a place where the sources have another digest."""

    def submit(self, fn, /, *args, **kwargs):
        future: Future = Future()
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("rotorsim.study.sweep.model_digest", lambda: "another")
            try:
                future.set_result(fn(*args, **kwargs))
            except Exception as error:
                future.set_exception(error)
        return future


def test_workers_with_other_sources_are_noticed():
    with pytest.raises(InputError, match="a worker has other sources of rotorsim"):
        sweep_points(CASES, SPEEDS, executor=Sends(), solve_case=FakeSolver())
