"""Commands take finished points from each other, and never one of another question."""

from __future__ import annotations

import dataclasses
import itertools
import os
import re
import sqlite3
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import called
from scenario_texts import SMALL
from sweep_cases import CASES, SPEEDS, FakeSolver, fake_point, loads, make_case

from rotorsim.bearing.operating_point import point_to_dict
from rotorsim.errors import RotorsimError
from rotorsim.files.scenario import Scenario
from rotorsim.shipped import shipped_scenarios
from rotorsim.status import SolveStatus
from rotorsim.study import finished
from rotorsim.study.explore import to_toml
from rotorsim.study.finished import PointStore, store_path
from rotorsim.study.sweep import sweep_points

WITHOUT_A_SAY = ("title", "rotor.", "orbit.", "stability.", "tolerances.", "study.", "transient.")
"""Entries of a scenario that no film point depends on."""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("ROTORSIM_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("ROTORSIM_FRESH")
    return tmp_path / "cache"


@pytest.fixture
def solver(monkeypatch) -> FakeSolver:
    """In place of the film's solver, as the sweep takes it of its own accord."""
    fake = FakeSolver()
    monkeypatch.setattr("rotorsim.bearing.solve.solve_case", fake)
    return fake


def sweep(cases=CASES, speeds=SPEEDS) -> list[float]:
    return loads(sweep_points(cases, speeds, workers=1))


def test_a_finished_point_is_not_solved_again(solver, monkeypatch):
    first = sweep()
    assert len(solver.calls) == len(CASES) * len(SPEEDS)
    assert sweep() == first
    assert len(solver.calls) == len(CASES) * len(SPEEDS)
    more = sweep(speeds=[*SPEEDS, 5000.0])
    assert len(solver.calls) == len(CASES) * (len(SPEEDS) + 1)
    assert more[: len(SPEEDS)] == first[: len(SPEEDS)]
    monkeypatch.setenv("ROTORSIM_FRESH", "1")
    assert sweep() == first
    assert len(solver.calls) == len(CASES) * (2 * len(SPEEDS) + 1)


def test_a_point_comes_back_with_every_digit():
    point = fake_point(CASES[0], 0.1 + 0.2, load=1.0 / 3.0)
    with PointStore() as store:
        store.add(CASES[0], [point])
        found = store.find(CASES[0], 0.1 + 0.2)
        assert store.find(CASES[0], 0.3) is None
    assert found is not None
    assert repr(point_to_dict(found)) == repr(point_to_dict(point))


def test_what_did_not_converge_is_tried_again():
    point = fake_point(CASES[0], 1.0, status=SolveStatus.NOT_CONVERGED)
    with PointStore() as store:
        store.add(CASES[0], [point])
        assert store.find(CASES[0], 1.0) is None


def test_other_sources_find_nothing(solver, monkeypatch):
    sweep()
    monkeypatch.setattr(finished, "model_digest", lambda: "another program")
    sweep()
    assert len(solver.calls) == 2 * len(CASES) * len(SPEEDS)


def values(inner: Any, path: str = "case") -> Iterator[tuple[str, Any]]:
    """Every value within a case, with where it is."""
    if dataclasses.is_dataclass(inner):
        for entry in dataclasses.fields(inner):
            yield from values(getattr(inner, entry.name), f"{path}.{entry.name}")
    elif isinstance(inner, tuple):
        for place, one in enumerate(inner):
            yield from values(one, f"{path}.{place}")
    else:
        yield path, inner


def with_value(inner: Any, path: list[str], value: Any) -> Any:
    if not path:
        return value
    if isinstance(inner, tuple):
        place = int(path[0])
        changed = with_value(inner[place], path[1:], value)
        return (*inner[:place], changed, *inner[place + 1 :])
    # Unchecked: the digest shall differ whether or not the value makes sense.
    made = object.__new__(type(inner))
    for entry in dataclasses.fields(inner):
        object.__setattr__(made, entry.name, getattr(inner, entry.name))
    object.__setattr__(made, path[0], with_value(getattr(inner, path[0]), path[1:], value))
    return made


def another(value: Any) -> Any:
    if isinstance(value, Enum):
        return next((one for one in type(value) if one is not value), "another")
    if isinstance(value, bool):
        return not value
    if isinstance(value, float):
        return float(np.nextafter(value, np.inf))
    return value + 1 if isinstance(value, int) else "another"


@pytest.mark.parametrize("name", shipped_scenarios())
def test_each_value_of_a_case_has_its_say(name):
    scenario = Scenario.from_text(shipped_scenarios()[name].read_text(), None)
    case = next(iter(scenario.cases()))
    known = finished._key(case, 1.0)
    found = dict(values(case))
    assert len(found) > 30
    assert not [path for path, value in found.items() if isinstance(value, np.ndarray)]
    for path, value in found.items():
        changed = with_value(case, path.split(".")[1:], another(value))
        assert finished._key(changed, 1.0) != known, path


def entries(inner: Any, path: tuple = ()) -> Iterator[tuple[tuple, Any]]:
    if isinstance(inner, dict | list):
        pairs = inner.items() if isinstance(inner, dict) else enumerate(inner)
        for key, value in pairs:
            yield from entries(value, (*path, key))
    else:
        yield path, inner


def changed_entry(value: Any) -> Any:
    if isinstance(value, str):
        return re.sub(r"^-?[\d.]+(e-?\d+)?", lambda m: repr(float(m[0]) * 1.01 or 0.013), value)
    if isinstance(value, bool):
        return not value
    return value + 2 if isinstance(value, int) else value * 1.01


@pytest.mark.parametrize("name", shipped_scenarios())
def test_each_entry_of_a_scenario_has_its_say(name):
    text = shipped_scenarios()[name].read_text()

    def keys(text: str) -> set:
        scenario = Scenario.from_text(text, None)
        pairs = itertools.product(scenario.cases(), scenario.speeds)
        return {finished._key(case, speed) for case, speed in pairs}

    known, tried = keys(text), 0
    for path, value in entries(tomllib.loads(text)):
        name = ".".join(map(str, path))
        if name.startswith(WITHOUT_A_SAY) or (new := changed_entry(value)) == value:
            continue
        tables = tomllib.loads(text)
        inner: Any = tables
        for key in path[:-1]:
            inner = inner[key]
        inner[path[-1]] = new
        try:
            assert keys(to_toml(tables)) != known, name
        except RotorsimError:
            continue  # not a scenario any more
        tried += 1
    assert tried >= 10


def test_a_damaged_store_is_replaced(solver, folder):
    sweep()
    store_path().write_bytes(b"no database" * 1000)
    assert sweep() == sweep()
    sweep()
    assert len(solver.calls) == 3 * len(CASES) * len(SPEEDS)  # the second one found it gone
    assert [file.name for file in folder.iterdir()] == ["points.sqlite"]


def test_a_flipped_digit_is_not_believed(solver):
    sweep()
    with sqlite3.connect(store_path()) as file:
        file.execute("""UPDATE points SET line = replace(line, '"load": ', '"load": 1')""")
    file.close()
    before = len(solver.calls)
    sweep()
    assert len(solver.calls) == 2 * before


def test_a_folder_that_cannot_be_made_costs_nothing_else(solver, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("ROTORSIM_CACHE", str(tmp_path / "file" / "cache"))
    assert sweep() == sweep()


def test_a_store_that_another_process_holds_is_gone_without(solver, monkeypatch):
    first = sweep()
    holder = sqlite3.connect(store_path(), isolation_level=None)
    holder.execute("BEGIN EXCLUSIVE")
    assert sweep() == first
    holder.close()
    before = len(solver.calls)
    assert sweep() == first
    assert len(solver.calls) == before


def test_the_older_half_goes_when_the_store_is_full(monkeypatch):
    monkeypatch.setattr(finished, "_LIMIT", 300_000)
    case = make_case()
    with PointStore() as store:
        for speed in range(1000):
            store.add(case, [fake_point(case, float(speed))])
        assert store.find(case, 0.0) is None
        assert store.find(case, 999.0) is not None
    assert store_path().stat().st_size < 400_000


WRITER = """
import sys
from sweep_cases import fake_point, make_case
from rotorsim.study.finished import PointStore
case = make_case()
for speed in range(int(sys.argv[1]), 200, 2):
    with PointStore() as store:
        store.add(case, [fake_point(case, float(speed))])
"""


@pytest.mark.slow
def test_two_processes_write_at_once():
    paths = os.pathsep.join([str(Path(__file__).parent), *filter(None, sys.path)])
    environment = {**os.environ, "PYTHONPATH": paths}
    writers = [
        subprocess.Popen([sys.executable, "-c", WRITER, str(first)], env=environment)
        for first in (0, 1)
    ]
    assert [writer.wait(60) for writer in writers] == [0, 0]
    with PointStore() as store:
        assert all(store.find(make_case(), float(speed)) for speed in range(200))


def test_commands_say_what_they_reused(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("small.toml").write_text(SMALL)
    first = called(capsys, "table", "small.toml", "--workers", 1)
    assert first.returncode == 0, first.stderr
    assert "reused" not in first.stderr
    solved = called(capsys, "solve", "small.toml", "--json")
    assert "2 of 2 film points reused from" in solved.stderr
    assert str(store_path()) in solved.stderr.replace("\n", "")
    fresh = called(capsys, "solve", "small.toml", "--json", "--fresh", "--workers", 1)
    assert "reused" not in fresh.stderr
    assert "ROTORSIM_FRESH" not in os.environ
    speed = called(capsys, "solve", "small.toml", "--speed", "6000 rpm", "--load", "1 kN")
    assert "reused" not in speed.stderr
