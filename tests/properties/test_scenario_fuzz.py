"""Mutated scenario texts are read or refused; nothing else happens, and quickly."""

from __future__ import annotations

import time
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from rotorsim.bearing.checks import derived_numbers, regime_warnings
from rotorsim.errors import ScenarioError
from rotorsim.files.scenario import Scenario

TEXTS = [
    path.read_text(encoding="utf-8")
    for path in sorted((Path(__file__).parents[2] / "scenarios").glob("*.toml"))
]
EXTRA = """
[[bearing.arc]]
start = "-90 deg"
end = "90 deg"
preload = 0.5
[stability]
mass = { start = "1 kg", stop = "3 kg", count = 3 }
"""
VALUES = [
    "0",
    "-1",
    "1",
    "2",
    "0.5",
    "1e308",
    "nan",
    "-inf",
    "true",
    "[]",
    "{}",
    "[[]]",
    "1979-05-27",
    '""',
    '"0 m"',
    '"1e-300 m"',
    '"1e9**1e9 m"',
    '"1 mm"',
    '["1 mm", "2 mm"]',
    '"1e3 rpm"',
    '["2 rpm", "3 rpm"]',
    '{ start = "1 rpm", stop = "9 rpm", count = 3 }',
    '{ start = "1 rpm", stop = "9 rpm", duration = "3 s" }',
    '"1 degC"',
    '"1 K"',
    '"2000 degC"',
    '"5 cSt"',
    '"0 degC*m"',
    '"1 kN"',
    '"1 kg"',
    '"5 deg"',
    '"360 deg"',
    '"jfo"',
    '"thd"',
    '"free"',
    '"conduction"',
    '"three_lobe"',
    '[["40 degC", "3 cSt"], ["9 degC", "4 cSt"]]',
    "32",
    "9" * 30,
    "0x" + "f" * 400,
]


@st.composite
def mutated(draw: st.DrawFn) -> str:
    lines = (draw(st.sampled_from(TEXTS)) + draw(st.sampled_from(["", EXTRA]))).split("\n")
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, len(lines) - 1))
        kind = draw(st.sampled_from(["value", "value", "value", "drop", "copy", "swap", "noise"]))
        if kind == "value" and "=" in lines[at]:
            lines[at] = lines[at].split("=")[0] + "= " + draw(st.sampled_from(VALUES))
        elif kind == "drop":
            lines[at] = ""
        elif kind == "copy":
            lines.insert(at, draw(st.sampled_from(lines)))
        elif kind == "swap":
            other = draw(st.integers(0, len(lines) - 1))
            lines[at], lines[other] = lines[other], lines[at]
        elif kind == "noise":
            start = draw(st.integers(0, len(lines[at])))
            lines[at] = lines[at][:start] + draw(st.text(max_size=4)) + lines[at][start + 1 :]
    return "\n".join(lines)


def read(text: str) -> Scenario | None:
    begin = time.perf_counter()
    try:
        return Scenario.from_text(text, "fuzz.toml")
    except ScenarioError as error:
        message = str(error)
    finally:
        assert time.perf_counter() - begin < 2.0
    assert message.startswith("fuzz.toml: ")
    assert len(message) < 10_000
    return None


@given(mutated())
def test_a_mutated_scenario_is_read_or_refused(text: str) -> None:
    scenario = read(text)
    for case in () if scenario is None else scenario.cases():
        assert scenario is not None
        speed = float(scenario.speeds[-1])
        assert derived_numbers(case, speed).reynolds_number > 0.0
        regime_warnings(case, speed)


@given(st.text())
def test_any_text_is_read_or_refused(text: str) -> None:
    assert read(text) is None


def test_the_mutations_start_from_good_texts() -> None:
    assert all(read(text) is not None for text in TEXTS)
