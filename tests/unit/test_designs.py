"""Design studies: what is drawn, kept, gone on with and refused."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from scenario_texts import BEARING, CONSTANT_OIL

from rotorsim.errors import InputError
from rotorsim.files.scenario import Scenario
from rotorsim.study.designs import _RESULTS, _undominated, run_study

FILM = '[film]\ninception = "free"\nmesh = { circumferential = 32, axial = 8 }\n'
OPERATING = """\
[operating]
speed = ["3000 rpm", "9000 rpm"]
load = "3 kN"
[rotor]
mass = "300 kg"
"""
VARY = '"bearing.radial_clearance" = ["80 um", "140 um"]\n"operating.load" = ["1 kN", "6 kN"]\n'


def scenario(vary: str = VARY, more: str = "samples = 12\n") -> Scenario:
    study = f"[study]\n{more}[study.vary]\n{vary}"
    return Scenario.from_text(f"{BEARING}{CONSTANT_OIL}{FILM}{OPERATING}{study}")


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return run_study(scenario(), tmp_path_factory.mktemp("study") / "whole.csv", workers=1)


def test_a_design_is_the_scenario_changed_by_hand(whole):
    import rotorsim as rs

    row = whole.designs.iloc[5]
    changes = {name: float(row[name]) for name in ("bearing.radial_clearance", "operating.load")}
    table = rs.tabulate(scenario().replace(**changes, study=None), workers=1)
    for name in ("power_loss", "max_pressure", "critical_mass"):
        assert row[name] == pytest.approx(float(table.dataset[name].values.ravel()[-1]), rel=1e-8)


def test_designs_lie_between_the_ends_and_fill_them(whole):
    clearance = whole.designs["bearing.radial_clearance"]
    assert len(whole.designs) == 12
    assert clearance.between(80e-6, 140e-6).all()
    assert (np.histogram(clearance, bins=4, range=(80e-6, 140e-6))[0] >= 2).all()
    assert list(whole.designs.columns[-len(_RESULTS) - 1 : -1]) == list(_RESULTS)


def test_what_was_cut_short_goes_on_to_the_same_designs(whole, tmp_path):
    path = tmp_path / "cut.csv"
    text = whole.path.read_text(encoding="utf-8")
    lines = text.splitlines(keepends=True)
    path.write_text("".join([*lines[:6], lines[6][:30]]), encoding="utf-8")
    again = run_study(scenario(), path, workers=1)
    assert again.solved == 8
    pd.testing.assert_frame_equal(again.designs, whole.designs)
    more = run_study(scenario(), path, samples=14, workers=1)
    assert more.solved == 2
    assert run_study(scenario(), path, workers=1).solved == 0


@pytest.mark.slow
def test_any_number_of_processes_gives_the_same(whole, tmp_path):
    other = run_study(scenario(), tmp_path / "two.csv", workers=2)
    pd.testing.assert_frame_equal(other.designs, whole.designs)


def test_another_study_is_not_mixed_in(whole, tmp_path):
    path = tmp_path / "other.csv"
    path.write_text(whole.path.read_text(encoding="utf-8"), encoding="utf-8")
    with pytest.raises(InputError, match="another study"):
        run_study(scenario(VARY.replace("140", "150")), path, workers=1)
    path.write_text("a,b\n1,2\n", encoding="utf-8")
    with pytest.raises(InputError, match="not the file of a study"):
        run_study(scenario(), path, workers=1)


def test_designs_without_a_result_keep_their_row(tmp_path):
    vary = '"operating.load" = { low = "1 kN", high = "1e9 N", spacing = "logarithmic" }\n'
    found = run_study(scenario(vary), tmp_path / "lost.csv", workers=1)
    lost = found.designs[found.designs["status"] != "converged"]
    assert 0 < len(lost) < 12
    assert lost["message"].str.len().min() > 20


@pytest.mark.parametrize(
    ("vary", "said"),
    [
        ('"bearing.clearence" = ["1 um", "2 um"]\n', "no entry"),
        ('"bearing.radial_clearance" = ["140 um", "80 um"]\n', "ascend"),
        ('"bearing.radial_clearance" = ["80 um"]\n', "two ends"),
        ('"bearing.radial_clearance" = ["80", "140"]\n', "unit"),
        ('"operating.load" = { low = "0 N", high = "5 kN", spacing = "logarithmic" }\n', "above 0"),
        ('"film.cavitation" = ["reynolds", "jfo"]\n', "plain numbers"),
        ("", "two ends"),
    ],
)
def test_ranges_out_of_place(vary, said, tmp_path):
    with pytest.raises(InputError, match=said):
        run_study(scenario(vary), tmp_path / "no.csv", workers=1)


def test_the_front_is_what_nothing_beats():
    goals = np.random.default_rng(1).random((200, 3))
    worse = (goals[:, None] <= goals[None]).all(2) & (goals[:, None] < goals[None]).any(2)
    assert np.array_equal(_undominated(goals), ~worse.any(axis=0))
