"""Coefficient files of people and other programs: what each must come to.

The inputs lie in ``tests/data/cases``; the numbers expected are independent of the reader: worked
by hand, given by ROSS 3.1, or those of the same coefficients in another form.
"""

from __future__ import annotations

import math
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from command_line import CommandLine, strict

from rotorsim.bearing.doubts import doubts
from rotorsim.bearing.table import CoefficientTable
from rotorsim.bearing.whirl import rigid_thresholds
from rotorsim.errors import OutOfRangeError, TableError
from rotorsim.files.formats import read_table, write_table

CASES = Path(__file__).parents[1] / "data" / "cases"
RPM = math.pi / 30.0
PUMP = CASES / "02-ross3-export-on-wrong-axis" / "pump.csv"


def case(name: str) -> Path:
    """File of a case, by its number and name."""
    (path,) = CASES.glob(f"{name[:2]}-*/{name[3:]}")
    return path


# ROSS: the axes speed and frequency


def test_ross3_bearings_over_speed_are_read():
    found = read_table(case("01/saved31_speed.toml"))
    # The same bearing as that of pump.csv, in the frame of ROSS.
    pump = CoefficientTable.from_csv(PUMP)
    assert found.speeds == pytest.approx(pump.speeds, rel=1e-15)
    assert np.array_equal(found.stiffness, pump.stiffness)
    assert np.array_equal(found.damping, pump.damping * [[1.0, 1.0], [1.0, 1.0]])
    assert found.notes == ()
    assert read_table(case("01/short_bearing.toml")).speeds.size == 3


def test_ross3_short_bearing_whirls_at_half_speed():
    """Nearly unloaded short bearing: Ocvirk's whirl ratio is 0.5."""
    table = read_table(case("01/short_bearing.toml"))
    last = table.at(table.speeds[-1])
    found = rigid_thresholds(last.stiffness, last.damping, last.speed)
    assert float(found.whirl_frequency_ratio) == pytest.approx(0.5, abs=0.01)
    assert doubts(table) == []


def test_renaming_speed_of_ross3_to_frequency_of_ross2_changes_nothing(tmp_path):
    text = case("01/short_bearing.toml").read_text(encoding="utf-8")
    path = tmp_path / "ross2.toml"
    path.write_text(text.replace("speed =", "frequency ="), encoding="utf-8")
    again, found = read_table(path), read_table(case("01/short_bearing.toml"))
    assert np.array_equal(again.stiffness, found.stiffness)
    assert again.notes == ("frequency is taken for the shaft's speed, as in ROSS 2",)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("01/added_mass.toml", "mxx: added mass is not known here"),
        ("03/saved31_grid.toml", "a table over speed and whirl frequency .ROSS 3."),
    ],
)
def test_what_ross3_saves_over_both_or_with_mass_is_refused(name, message, here: CommandLine):
    with pytest.raises(TableError, match=message):
        read_table(case(name))
    done = here("stability", case(name), "--mass", "500 kg")
    assert done.returncode == 2
    assert done.stderr.startswith("error: ")


def test_a_rotor_file_of_ross3_tells_its_version_once(tmp_path):
    bearing = case("09/zero.toml").read_text(encoding="utf-8").replace("0.0,", "100.0,")
    path = tmp_path / "rotor.toml"
    path.write_text(bearing, encoding="utf-8")
    assert read_table(path).speeds.tolist() == [100.0, 200.0]
    path.write_text(f'ross_version = "3.1.0"\n{bearing}', encoding="utf-8")
    (note,) = read_table(path).notes
    assert "is the frequency of the whirl (ROSS 3)" in note


def test_a_table_over_the_frequency_of_the_whirl_is_used_with_a_warning(here: CommandLine):
    done = here("stability", case("03/saved31_freq.toml"), "--mass", "500 kg", "-q")
    assert done.returncode == 0
    assert "warning: " in done.stderr
    assert "is the frequency of the whirl (ROSS 3)" in done.stderr


@pytest.mark.parametrize(
    ("kind", "axis", "other"), [("ross", "speed", "frequency"), ("ross2", "frequency", "speed")]
)
def test_an_export_names_the_axis_as_its_version_of_ross_does(kind, axis, other, tmp_path):
    """ROSS 3.1 and 2.3 were seen to load the files so: kind "speed", and refused by ROSS 2."""
    (path,) = write_table(CoefficientTable.from_csv(PUMP), kind, tmp_path, "pump")
    assert path.name == f"pump.{kind}.toml"
    (entry,) = tomllib.loads(path.read_text(encoding="utf-8")).values()
    assert entry[axis] == pytest.approx([3000.0 * RPM, 6000.0 * RPM], rel=1e-15)
    assert other not in entry
    assert ("interpolation" in entry) == (kind == "ross")
    assert np.array_equal(read_table(path).stiffness, CoefficientTable.from_csv(PUMP).stiffness)


# ROSS: constant coefficients, speed 0, several bearings


def test_constant_coefficients_hold_at_any_speed(tmp_path):
    table = read_table(case("09/const.toml"))
    for speed in (1.0, 1234.5, 1e5):
        # y of ROSS is against the load, x of ROSS is y here.
        assert table.at(speed).stiffness.tolist() == [[8e5, 0.0], [0.0, 1e6]]
    for kind in ("ross", "ross2", "csv", "nc"):
        (path,) = write_table(table, kind, tmp_path, "again")
        again = read_table(path)
        assert again.constant
        assert np.array_equal(again.at(777.0).damping, table.at(1.0).damping)
    (entry,) = tomllib.loads((tmp_path / "again.ross.toml").read_text(encoding="utf-8")).values()
    assert {"speed", "frequency"}.isdisjoint(entry)
    with pytest.raises(OutOfRangeError):
        read_table(case("09/c3.toml")).at(301.0)


def test_constant_coefficients_on_the_command_line(here: CommandLine):
    """m x'' + c x' + k x = 0 by hand: x'' of 20 kg on 0.8 MN/m and 1 kN s/m."""
    done = here("stability", case("09/const.toml"), "--mass", "20 kg", "--json",
                "--speeds", "500 rpm : 1500 rpm : 3")  # fmt: skip
    assert done.returncode == 0, done.stderr
    (curve,) = strict(done.stdout)["curves"]
    assert curve["speed"] == pytest.approx([500.0 * RPM, 1000.0 * RPM, 1500.0 * RPM])
    assert curve["growth_rate"] == pytest.approx([-25.0] * 3)
    done = here("stability", case("09/c3.toml"), "--mass", "20 kg", "--speeds", "500 rpm")
    assert done.returncode == 2
    assert "the table has its own speeds" in done.stderr


@pytest.mark.parametrize("suffix", ["toml", "csv"])
def test_a_row_at_speed_zero_is_left_out_with_a_word(suffix, here: CommandLine, tmp_path):
    path = case("09/zero.toml")
    if suffix == "csv":
        text = case("07/ok.csv").read_text(encoding="utf-8").splitlines()
        path = tmp_path / "zero.csv"
        nothing = "0" + ",nan" * 8
        path.write_text("\n".join([text[0], nothing, *text[1:]]), encoding="utf-8")
    done = here("stability", path, "--mass", "20 kg", "--json")
    assert done.returncode == 0, done.stderr
    assert "the row at speed 0 is left out" in done.stderr
    assert min(strict(done.stdout)["curves"][0]["speed"]) > 100.0


def test_one_of_several_bearings_is_chosen_by_name(here: CommandLine, tmp_path):
    done = here("stability", case("11/two.toml"), "--mass", "20 kg")
    assert done.returncode == 2
    assert "a (node 0), b (node 6)" in done.stderr
    assert "--bearing" in done.stderr
    for name in ("b", "BearingElement_b"):
        done = here("stability", case("11/two.toml"), "--mass", "20 kg", "--bearing", name)
        assert done.returncode == 0, done.stderr
    done = here("export", case("11/two.toml"), "--to", "csv", "-o", tmp_path, "--bearing", "c")
    assert done.returncode == 2
    assert "no bearing has that name; the file holds a (node 0), b (node 6)" in done.stderr
    text = case("11/two.toml").read_text(encoding="utf-8")
    path = tmp_path / "unlike.toml"
    path.write_text(text.replace("kxx=[1e6,1e6]", "kxx=[3e6,3e6]", 1), encoding="utf-8")
    assert read_table(path, bearing="a").stiffness[0, 0, 0, 0, 0] == 3e6
    assert read_table(path, bearing="b").stiffness[0, 0, 0, 0, 0] == 1e6


# Signs, axes and units that are doubted

OK = case("07/ok.csv")


def threshold_rpm(path: Path) -> float:
    from rotorsim.machine.machine import Machine
    from rotorsim.machine.support import TableSupport
    from rotorsim.machine.thresholds import threshold_speeds
    from rotorsim.rotor import Rotor

    table = TableSupport(CoefficientTable.from_csv(path).interpolator())
    (found,) = threshold_speeds(Machine(Rotor.rigid(2000.0), [(0, table)]))
    return found.speed / RPM


def test_the_table_with_the_right_signs_is_not_doubted():
    assert doubts(CoefficientTable.from_csv(OK)) == []
    assert threshold_rpm(OK) == pytest.approx(4539.0, abs=1.0)


def changed(tmp_path: Path, old: str, new: str) -> CoefficientTable:
    text = OK.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "changed.csv"
    path.write_text(text.replace(old, new), encoding="utf-8")
    return CoefficientTable.from_csv(path)


def with_factors(k: list[float], c: list[float]) -> CoefficientTable:
    """The right table with every coefficient times a factor."""
    dataset = CoefficientTable.from_csv(OK).dataset.copy()
    for letter, factors in (("k", k), ("c", c)):
        for name, factor in zip(("xx", "xy", "yx", "yy"), factors, strict=True):
            dataset[letter + name] = dataset[letter + name] * factor
    return CoefficientTable(dataset)


ONE, MINUS = [1.0] * 4, [-1.0] * 4


@pytest.mark.parametrize(
    ("k", "c", "said"),
    [
        (MINUS, MINUS, "direct stiffness and damping .*K = [+]dF/dx and C = [+]dF/dv"),
        (MINUS, ONE, "direct stiffness below zero .*K = [+]dF/dx,"),
        (ONE, MINUS, "direct damping below zero .*C = [+]dF/dv,"),
        (ONE, [1.0, 1.0, 1.0, -1.0], "cyy is below zero"),
        (ONE, [-1.0, 1.0, 1.0, 1.0], "cxx is below zero"),
        ([1.0, -1.0, -1.0, 1.0], ONE, "kxy - kyx is below zero"),
        *(([f] * 4, ONE, "whirl frequency ratio|damping times") for f in (1e3, 1e-3, 1e6, 1e-6)),
        *((ONE, [f] * 4, "whirl frequency ratio|damping times") for f in (1e3, 1e-3, 1e6, 1e-6)),
        *(([f] * 4, [f] * 4, "critical mass per bearing") for f in (1e6, 1e-6)),
    ],
)
def test_other_conventions_and_units_are_doubted(k, c, said):
    found = doubts(with_factors(k, c))
    assert found
    assert all(text.startswith("check units and frame: ") for text in found)
    assert any(re.search(said, text) for text in found), found


def test_axes_exchanged_are_doubted(tmp_path):
    names = "kxx [MN/m],kxy [MN/m],kyx [MN/m],kyy [MN/m]"
    (found,) = doubts(changed(tmp_path, names, "kyy [MN/m],kyx [MN/m],kxy [MN/m],kxx [MN/m]"))
    assert "are kxy and kyx, or x and y, exchanged" in found


def test_units_wrong_by_a_thousand_in_both_show_where_the_load_is_known(tmp_path):
    text = OK.read_text(encoding="utf-8").splitlines()
    head = f"radial_clearance [um],load [kN],{text[0]}"
    rows = [f"100,20,{row}" for row in text[1:]]
    path = tmp_path / "loaded.csv"
    path.write_text("\n".join([head, *rows]), encoding="utf-8")
    assert doubts(CoefficientTable.from_csv(path)) == []
    wrong = head.replace("MN/m", "kN/m").replace("kN s/m", "N s/m")
    path.write_text("\n".join([wrong, *rows]), encoding="utf-8")
    assert any("stiffness times clearance" in t for t in doubts(CoefficientTable.from_csv(path)))


@pytest.mark.parametrize("name", ["neg", "negC"])
def test_the_doubt_reaches_people_and_programs(name, here: CommandLine):
    done = here("stability", case(f"07/{name}.csv"), "--mass", "2000 kg", "--json")
    assert done.returncode == 0
    assert "warning: check units and frame: direct " in done.stderr
    assert "dF/dv" in strict(done.stdout)["doubts"][0]


def test_the_shipped_table_is_not_doubted():
    from rotorsim.shipped import shipped_tables

    assert doubts(CoefficientTable.load(shipped_tables()["dal"])) == []


# Sheets


def test_a_sheet_with_names_and_units_in_two_rows(here: CommandLine):
    """100 kg on 80 000 lb/in and 600 lb s/in, by hand: overdamped, slowest root -156.7 1/s."""
    table = CoefficientTable.from_csv(case("08/table.csv"))
    pound_per_inch = 4.4482216152605 / 0.0254
    assert table.stiffness[0, 0, 0] == pytest.approx(8e4 * pound_per_inch * np.eye(2), rel=1e-12)
    assert table.damping[0, 0, 1] == pytest.approx(850.0 * pound_per_inch * np.eye(2), rel=1e-12)
    half, square = 300.0 * pound_per_inch / 100.0, 8e4 * pound_per_inch / 100.0
    done = here("stability", case("08/table.csv"), "--mass", "100 kg", "--json")
    growth = strict(done.stdout)["curves"][0]["growth_rate"]
    assert growth[0] == pytest.approx(-half + math.sqrt(half**2 - square), rel=1e-9)


SHEET = case("08/table.csv").read_text(encoding="utf-8").splitlines()


@pytest.mark.parametrize(
    "lines",
    [
        ["3x plain bearing", "", *SHEET],  # title lines
        [SHEET[0].replace("Speed", "RPM"), *SHEET[1:]],
        [SHEET[0].replace("Speed", "RPM"), SHEET[1].replace("rpm", "1/min", 1), *SHEET[2:]],
        [f"{SHEET[0]},Remark,,", f"{SHEET[1]},-,,", *(f"{row},tested,," for row in SHEET[2:])],
        [SHEET[0].replace("K", "K_").replace("C", "c_"), *SHEET[1:]],
        [line.replace(",", ";") for line in SHEET],
        [line.replace(",", "\t") for line in SHEET],
        [SHEET[0], "(" + SHEET[1].replace(",", "),(") + ")", *SHEET[2:]],
    ],
)
def test_sheets_are_written_in_many_ways(lines, tmp_path):
    path = tmp_path / "sheet.csv"
    path.write_text("\r\n".join(lines), encoding="utf-8-sig")
    found, known = CoefficientTable.from_csv(path), CoefficientTable.from_csv(case("08/table.csv"))
    assert found.speeds == pytest.approx(known.speeds, rel=1e-14)
    assert np.array_equal(found.stiffness, known.stiffness)
    assert found.notes == (("columns left out: Remark",) if "Remark" in lines[0] else ())


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "600,0,0,600,0,0,0,0",
            "600,0,0,600,2,0,0,0",
            "row 3, column mxx: added mass is not known",
        ),
        ("Mxx", "Frequency", "whirl frequency are not read"),
        ("lb/in,lb/in", "lb/in,lb", "column kxy needs a unit"),
        ("lb-s/in", "lb/in", "column cxx needs a unit"),
        ("Kyy", "K22", "columns are missing: kyy; unknown column: K22"),
        ("80000", "8" * 140_000, "is no CSV table: field larger"),
        ("80000", "1e308", "must be finite|is beyond every sensible value"),
        ("3000,", "3\x00,", "not a number|NUL"),
    ],
)
def test_sheets_with_what_is_not_known_are_refused(old, new, message, tmp_path):
    path = tmp_path / "sheet.csv"
    text = "\n".join(SHEET).replace(old, new, 1 if new != "lb/in" else -1)
    path.write_text(text, encoding="utf-8")
    with pytest.raises(TableError, match=message) as caught:
        CoefficientTable.from_csv(path)
    assert len(str(caught.value)) < 1000


def test_no_cell_of_an_export_is_a_formula(tmp_path):
    text = case("07/ok.csv").read_text(encoding="utf-8").splitlines()
    path = tmp_path / "sheet.csv"
    rows = [f'{row},"\'=HYPERLINK(1)"' for row in text[1:]]
    path.write_text("\n".join([f"{text[0]},thermal_model", *rows]), encoding="utf-8")
    table = CoefficientTable.from_csv(path)
    assert table.dataset["thermal_model"].values.tolist() == ["=HYPERLINK(1)"]
    (out,) = write_table(table, "csv", tmp_path, "out")
    assert "\n'=HYPERLINK(1)," in out.read_text(encoding="utf-8")
    again = read_table(out)
    assert again.dataset["thermal_model"].values.tolist() == ["=HYPERLINK(1)"]


# How messages end


@pytest.mark.parametrize("name", ["six.npz", "sheet.xlsx"])
def test_a_message_ends_with_what_the_command_takes(name, here: CommandLine):
    for options in ([], ["--x", "speed", "--y", "mass"]):
        done = here("stability", case(f"12/{name}"), *options)
        assert done.returncode == 2
        assert done.stderr.strip().endswith("; here a table or a scenario is needed")
