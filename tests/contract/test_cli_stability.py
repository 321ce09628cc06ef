"""The command `stability`: modes, maps and tolerances through the command line, and bad input."""

from __future__ import annotations

import json
import math
import subprocess
from pathlib import Path

import numpy as np
import pytest
from command_line import CommandLine, strict
from scenario_texts import BEARING, BOTH_MODELS, OIL

from rotorsim.bearing.whirl import rigid_threshold

DATA = Path(__file__).parents[1] / "data"
SCENARIO = f"""\
title = "small"
{BEARING}
{OIL}
[film]
mesh = {{ circumferential = 32, axial = 8, cross_film = 8 }}
{BOTH_MODELS}
[operating]
speed = {{ start = "6000 rpm", stop = "15000 rpm", count = 4 }}
load = "10 kN"
[rotor]
mass = "300 kg"
[tolerances]
radial_clearance = "8 um"
viscosity = "5 %"
samples = 8
"""
NAMES = [f"{a}{i}{j} [{u}]" for a, u in (("k", "N/m"), ("c", "N s/m")) for i in "xy" for j in "xy"]
ROW = [2e8, 6e8, -1e8, 3e8, 7e5, 1e5, 1e5, 3e5]


@pytest.fixture
def here(here: CommandLine, tmp_path: Path) -> CommandLine:
    """Call the command line beside small.toml."""
    (tmp_path / "small.toml").write_text(SCENARIO, encoding="utf-8")
    return here


def csv_text(speeds=(500.0, 700.0, 900.0), change=None):
    lines = [",".join(["speed [rad/s]", *NAMES])]
    for i, speed in enumerate(speeds):
        values = [speed, *ROW]
        values[2] += 4e5 * speed
        row = [repr(float(v)) for v in values]
        if change and change[0] == i:
            row[change[1]] = change[2]
        lines.append(",".join(row))
    return "\n".join(lines)


def shaft_arrays(**changes):
    reference = json.loads((DATA / "ross_campbell.json").read_text(encoding="utf-8"))
    arrays = {
        "M": np.array(reference["mass"]), "D": np.array(reference["damping"]),
        "G": np.array(reference["gyroscopic"]), "K": np.array(reference["stiffness"]),
        "bearing_nodes": np.array(reference["bearing_nodes"]), "dofs_per_node": np.array(4),
    }  # fmt: skip
    return {**arrays, **changes}


@pytest.mark.slow
def test_modes_over_speed_in_json(here, tmp_path):
    (tmp_path / "own.csv").write_text(csv_text())
    done = here("stability", "own.csv", "--mass", "900 kg", "--json")
    assert done.returncode == 0, done.stderr
    (curve,) = strict(done.stdout)["curves"]
    modes = curve["modes"]
    assert modes["speed"] == curve["speed"]
    for i in range(3):
        k = np.array(ROW[:4]).reshape(2, 2)
        k[0, 1] += 4e5 * curve["speed"][i]
        c = np.array(ROW[4:]).reshape(2, 2)
        a = np.block([[np.zeros((2, 2)), np.eye(2)], [-k / 900.0, -c / 900.0]])
        exact = np.linalg.eigvals(a)
        assert modes["growth_rate"][i] == pytest.approx(exact.real.max(), rel=1e-9)
        least = max(modes["branches"], key=lambda b: b["growth_rate"][i])
        value = exact[exact.real.argmax()]
        assert least["damped_frequency"][i] == pytest.approx(abs(value.imag), rel=1e-9)
        assert least["damping_ratio"][i] == pytest.approx(-value.real / abs(value), rel=1e-9)
        decrement = -2 * math.pi * value.real / abs(value.imag)
        assert least["logarithmic_decrement"][i] == pytest.approx(decrement, rel=1e-9)
        assert least["whirl"][i] == "forward"
    for threshold in curve["thresholds"]:
        assert threshold["whirl_frequency_ratio"] == pytest.approx(
            threshold["whirl_frequency"] / threshold["speed"]
        )


def test_modes_are_shown_with_their_whirl_and_threshold(here):
    done = here("stability", DATA / "ross_bearing.csv", "--mass", "300 kg", "-o", "figures")
    assert done.returncode == 0, done.stderr
    for word in ("log decrement", "damping ratio", "forward", "whirl ratio", "Threshold speeds"):
        assert word in done.stdout
    assert max(map(len, done.stdout.splitlines())) <= 100
    for kind in ("png", "svg"):
        assert Path(f"figures/campbell.{kind}").stat().st_size > 5000


@pytest.mark.slow
def test_a_general_rotor_from_npz_and_mat(here, tmp_path):
    import scipy.io

    reference = json.loads((DATA / "ross_campbell.json").read_text(encoding="utf-8"))
    np.savez(tmp_path / "r.npz", **shaft_arrays())
    scipy.io.savemat(tmp_path / "r.mat", shaft_arrays())
    found = []
    for name in ("r.npz", "r.mat"):
        done = here("stability", DATA / "ross_bearing.csv", "--rotor", name, "--json")
        assert done.returncode == 0, done.stderr
        found.append(strict(done.stdout)["curves"][0])
    assert found[0]["modes"] == found[1]["modes"]
    growth = [row[0][0] for row in found[0]["eigenvalues"]]
    assert growth == pytest.approx(found[0]["modes"]["growth_rate"], rel=1e-6)
    largest = [max(pair[0] for pair in row) for row in reference["eigenvalues"]]
    assert found[0]["modes"]["growth_rate"] == pytest.approx(largest, abs=0.05)
    (threshold,) = found[0]["thresholds"]
    assert found[0]["threshold_speeds"] == [threshold["speed"]]
    # Nodes beside the file: further in, the shaft overhangs and the threshold moves.
    done = here(
        "stability", DATA / "ross_bearing.csv", "--rotor", "r.npz", "--bearing-nodes", "2,6",
        "--json",
    )  # fmt: skip
    (moved,) = strict(done.stdout)["curves"][0]["thresholds"]
    assert moved["speed"] != pytest.approx(threshold["speed"], rel=0.01)


@pytest.mark.slow
def test_damping_called_c_gives_the_same_verdict(here):
    arrays = shaft_arrays(D=4e3 * np.eye(36))
    np.savez("d.npz", **arrays)
    arrays["C"] = arrays.pop("D")
    np.savez("c.npz", **arrays)
    np.savez("without.npz", **shaft_arrays())
    said = []
    for name in ("d.npz", "c.npz", "without.npz"):
        done = here("stability", DATA / "ross_bearing.csv", "--rotor", name, "--json")
        assert done.returncode == 0, done.stderr
        said.append(strict(done.stdout)["curves"][0])
    assert said[0] == said[1]
    assert said[0]["threshold_speeds"] != said[2]["threshold_speeds"]


@pytest.mark.slow
@pytest.mark.parametrize(
    "rotor", [("--rotor", "r.npz"), ("--mass", "200 kg", "--shaft-stiffness", "20 MN/m")]
)
def test_the_table_of_a_rotor_that_is_not_rigid_speaks_of_its_own_verdict(here, rotor):
    np.savez("r.npz", **shaft_arrays())
    done = here("stability", DATA / "ross_bearing.csv", *rotor)
    assert done.returncode == 0, done.stderr
    assert "M_crit" not in done.stdout
    assert "stable below" not in done.stdout
    rows = done.stdout.split("Least stable mode")[0].splitlines()
    found = [line.split() for line in rows if "stable" in line and line[0].isdigit()]
    assert {row[1] for row in found} == {"stable", "unstable"}
    assert all((row[1] == "stable") == (float(row[2]) < 0.0) for row in found)


def test_a_wrong_rotor_is_refused_before_films_are_solved(here, monkeypatch):
    from rotorsim.cli import stability_inputs

    def solved(*_):
        raise AssertionError("films were solved")

    monkeypatch.setattr(stability_inputs, "computed_table", solved)
    np.savez("r.npz", **shaft_arrays(Damping=np.eye(36)))
    done = here("stability", "small.toml", "--rotor", "r.npz", "--mass", "900 kg")
    refuse(done, ["--rotor", "--mass", "'r.npz'"])
    assert "PosixPath" not in done.stderr
    refuse(here("stability", "small.toml", "--rotor", "r.npz"), ["Damping", "D or C"])


def test_a_flexible_shaft_lowers_the_threshold(here):
    speeds = []
    for more in ((), ("--shaft-stiffness", "50 MN/m"), ("--shaft-stiffness", "20 MN/m")):
        done = here("stability", DATA / "ross_bearing.csv", "--mass", "200 kg", *more, "--json")
        assert done.returncode == 0, done.stderr
        (curve,) = strict(done.stdout)["curves"]
        speeds += curve["threshold_speeds"]
    assert speeds[0] > speeds[1] > speeds[2]


@pytest.mark.slow
def test_map_over_speed_and_load_is_solved_from_the_scenario(here):
    done = here(
        "stability", "small.toml", "--x", "speed", "--y", "load", "--y-values", "5 kN : 20 kN : 4",
        "--cells", "21", "--workers", "1", "--json", "-o", "maps",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    said = strict(done.stdout)
    found = said["map"]
    assert said["points"] == 4 * 4 * 2
    assert found["held"]["mass"] == 300.0
    assert len(found["x_values"]) == len(found["y_values"]) == 21
    assert found["y_values"][0] == 5000.0
    cold, hot = (np.array(found["models"][m]["verdict"]) for m in ("isothermal", "thd"))
    for model in ("isothermal", "thd"):
        one = found["models"][model]
        growth, margin = np.array(one["growth_rate"]), np.array(one["mass_margin"], dtype=float)
        assert np.array_equal(growth < 0.0, np.array(one["verdict"]) == 1)
        assert np.array_equal(margin > 0.0, np.array(one["verdict"]) == 1)
    heated = np.array(found["destabilised_by_heating"])
    assert heated.any()
    assert np.array_equal(heated, (cold == 1) & (hot == 0))
    # More load, more stable; more speed, less.
    assert hot[-1, -1] == 1
    assert hot[-1, 0] == 0
    assert {Path(name).suffix for name in said["files"]} == {".nc", ".png", ".svg"}
    assert all(Path(name).exists() for name in said["files"])


def test_map_over_an_entry_of_the_file(here):
    done = here(
        "stability", "small.toml", "--x", "speed", "--y", "bearing.length", "--y-values",
        "60 mm, 80 mm", "--cells", "5", "-m", "isothermal", "--workers", "1", "--json", "-o", "m",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    said = strict(done.stdout)
    assert said["map"]["y"] == "bearing.length"
    assert said["map"]["y_values"] == pytest.approx([0.06, 0.065, 0.07, 0.075, 0.08])
    assert all(Path(name).stem == "map_speed_bearing.length" for name in said["files"])
    missing = here("stability", "small.toml", "--x", "speed", "--y", "bearing.length")
    assert missing.returncode == 2
    assert "--y-values: is missing" in missing.stderr


def test_map_at_solved_points_is_what_solve_says(here):
    done = here(
        "stability", "small.toml", "--x", "load", "--y", "clearance", "--x-values", "8 kN, 12 kN",
        "--y-values", "90 um, 110 um", "--speed", "12000 rpm", "--cells", "0", "-m", "thd",
        "--workers", "1", "--json",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found = strict(done.stdout)["map"]
    text = SCENARIO.replace('"10 kN"', '"12 kN"').replace('"100 um"', '"90 um"')
    Path("one.toml").write_text(text.replace('["isothermal", "thd"]', '["thd"]'))
    (point,) = strict(here("solve", "one.toml", "--speed", "12000 rpm", "--json").stdout)["points"]
    exact = rigid_threshold(point["stiffness"], point["damping"], point["speed"]).critical_mass
    assert found["models"]["thd"]["critical_mass"][1][0] == pytest.approx(exact, rel=1e-3)


def test_map_of_a_table(here):
    done = here(
        "stability", DATA / "ross_bearing.csv", "--x", "speed", "--y", "mass", "--json",
        "--y-values", "100 kg : 500 kg : 30", "--cells", "31",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found = strict(done.stdout)["map"]
    assert found["destabilised_by_heating"] is None
    verdict = np.array(found["models"]["thd"]["verdict"])
    assert verdict[0].all()
    assert not verdict[-1, -1]
    assert (
        here("stability", DATA / "ross_bearing.csv", "--x", "speed", "--y", "mass").returncode == 0
    )


@pytest.mark.slow
def test_tolerances_of_the_scenario_and_of_the_command_line(here):
    done = here("stability", "small.toml", "--tolerances", "--workers", "1", "--json")
    assert done.returncode == 0, done.stderr
    said = strict(done.stdout)
    assert said["samples"] == 8
    assert set(said["inputs"]) == {"radial_clearance", "viscosity"}
    assert said["most_important_input"] == "radial_clearance"
    assert 0.0 <= said["probability_of_instability"] <= 1.0
    assert said["quantiles"]["threshold_speed"]["0.5"] > 0.0
    done = here(
        "stability", "small.toml", "--tolerance", "load=5 %", "--samples", "16", "--workers", "1",
        "--speed", "14000 rpm", "-o", "figures",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    for word in ("probability of instability at 14000 rpm", "16 samples", "rank correlation"):
        assert word in done.stdout
    assert Path("figures/tolerances.svg").exists()


@pytest.mark.slow
def test_inputs_go_by_both_of_their_names(here):
    found = []
    for x, y, spread in (
        ("clearance", "load", "radial_clearance=4 um"),
        ("radial_clearance", "applied_load", "clearance=4 um"),
    ):
        done = here(
            "stability", "small.toml", "--x", x, "--y", y, "--x-values", "90 um, 110 um",
            "--y-values", "8 kN, 12 kN", "--speed", "12000 rpm", "--cells", "0", "-m",
            "isothermal", "--workers", "1", "--json",
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        said = strict(done.stdout)["map"]
        done = here(
            "stability", "small.toml", "--tolerance", spread, "-m", "isothermal", "--workers", "1",
            "--json",
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        tolerances = strict(done.stdout)["tolerances"]
        assert tolerances["radial_clearance"]["spread"] == pytest.approx(4e-6)
        found.append((said, tolerances))
    assert found[0] == found[1]


@pytest.mark.slow
def test_a_table_brings_its_scenario_to_the_tolerances(here):
    solved = here("table", "small.toml", "--workers", "1", "-o", "small.nc", "-q")
    assert solved.returncode == 0, solved.stderr
    said = []
    for source in ("small.toml", "small.nc"):
        done = here("stability", source, "--tolerances", "-m", "isothermal", "--workers", "1",
                    "--json")  # fmt: skip
        assert done.returncode == 0, done.stderr
        said.append(strict(done.stdout))
    assert said[0] == said[1]


def refuse(done: subprocess.CompletedProcess, words: list[str]) -> None:
    assert done.returncode == 2, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    assert done.stderr.startswith("error: ")
    for word in words:
        assert word in done.stderr


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (csv_text(change=(1, 3, "nan")), ["own.csv", "row 3", "kyx", "nan"]),
        (csv_text(change=(2, 1, "inf")), ["row 4", "kxx", "inf"]),
        (csv_text(change=(0, 8, "x1")), ["row 2", "cyy", "x1"]),
        (csv_text(speeds=(500.0, 400.0, 900.0)), ["row 3", "column speed", "ascend"]),
        (csv_text(speeds=(500.0, 500.0)), ["row 3", "column speed", "ascend"]),
        (csv_text(speeds=(-5.0, 500.0)), ["row 2", "column speed", "above 0"]),
        (csv_text() + "\n1000.0,1.0", ["row 5", "2 fields"]),
        (csv_text().replace("kxy [N/m]", "kxy"), ["kxy", "unit"]),
        (csv_text().replace("kxy [N/m],", ""), ["kxy", "missing"]),
        ("", ["own.csv", "header"]),
    ],
)
def test_bad_tables_name_row_and_column(here, text, words):
    Path("own.csv").write_text(text)
    refuse(here("stability", "own.csv", "--mass", "900 kg"), words)


def with_entry(name, row, column, value):
    matrix = shaft_arrays()[name].astype(float)
    matrix[row, column] = value
    return {name: matrix}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"M": np.ones((36, 35))}, ["mass", "square"]),
        (with_entry("M", 2, 5, 123.0), ["mass", "row 2", "column 5", "symmetric"]),
        (with_entry("G", 1, 0, 9e9), ["gyroscopic", "row", "column", "skew"]),
        (with_entry("K", 3, 4, np.nan), ["stiffness", "row 3", "column 4", "nan"]),
        ({"K": np.eye(8)}, ["stiffness", "size"]),
        ({"M": -np.eye(36)}, ["mass", "positive"]),
        ({"bearing_nodes": np.array([1, 9])}, ["bearing_nodes", "column 1", "0 to 8", "9"]),
        ({"bearing_nodes": np.array([1, 1])}, ["bearing_nodes", "different"]),
        ({"bearing_nodes": np.array([1.5])}, ["bearing_nodes", "column 0", "1.5"]),
        ({"dofs_per_node": np.array(5)}, ["dofs_per_node", "5"]),
        ({"M": np.array([["a"]])}, ["r.npz", "numbers"]),
    ],
)
def test_bad_rotors_name_row_and_column(here, changes, words):
    np.savez("r.npz", **shaft_arrays(**changes))
    table = DATA / "ross_bearing.csv"
    refuse(here("stability", table, "--rotor", "r.npz"), words)


TABLE = str(DATA / "ross_bearing.csv")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((TABLE, "--rotor", "nowhere.npz"), ["nowhere.npz"]),
        ((TABLE, "--rotor", "small.toml"), ["small.toml", ".npz"]),
        ((TABLE, "--bearing-nodes", "1"), ["--bearing-nodes", "--rotor"]),
        ((TABLE, "--rotor", "x.npz", "--mass", "3 kg"), ["--rotor", "--mass"]),
        ((TABLE, "--shaft-stiffness", "20 MN/m"), ["--shaft-stiffness", "--mass"]),
        ((TABLE, "--mass", "9 kg", "--shaft-stiffness", "20"), ["--shaft-stiffness", "20"]),
        ((TABLE, "--x", "speed"), ["--y"]),
        ((TABLE, "--x", "speed", "--y", "speed"), ["--y", "differ"]),
        ((TABLE, "--x", "speed", "--y", "load", "--mass", "9 kg"), ["applied_load", "scenario"]),
        ((TABLE, "--x", "speed", "--y", "mass", "--mass", "9 kg"), ["mass", "held"]),
        ((TABLE, "--x", "speed", "--y", "mass", "--y-values", "9"), ["--y-values", "9"]),
        ((TABLE, "--x", "speed", "--y", "mass", "--y-values", "9 kg, 5 kg"), ["ascend"]),
        ((TABLE, "--x", "speed", "--y", "mass", "--y-values", "1 kg : 2 kg"), ["count"]),
        ((TABLE, "--x", "speed", "--y", "mass", "--y-values", "1 kg:2 kg:1"), ["count"]),
        ((TABLE, "--x", "speed", "--y", "mass", "--x-values", "1 rpm, 2 rpm"), ["speed", "209"]),
        ((TABLE, "--x-values", "1 rpm"), ["--x-values", "--x"]),
        ((TABLE, "--speed", "100 rpm"), ["--speed", "--x"]),
        ((TABLE, "--tolerances"), ["--tolerances", "give the scenario"]),
        ((TABLE, "--x", "radius", "--y", "mass"), ["--x", "radius", "clearance, load"]),
        (
            (TABLE, "--x", "clearance", "--y", "speed", "--mass", "9 kg"),
            ["radial_clearance", "one value", "scenario"],
        ),
        ((TABLE, "--x", "speed", "--y", "mass", "--x-values", "4000 rpm"), ["speed", "two values"]),
        (("small.toml", "--tolerance", "radius=1 %"), ["--tolerance", "radial_clearance"]),
        (("small.toml", "--tolerance", "viscosity=1 Pa*s"), ["viscosity", "10 %"]),
        (("small.toml", "--tolerances", "--model", "adiabatic"), ["adiabatic", "thd"]),
    ],
)
def test_bad_arguments(here, arguments, words):
    refuse(here("stability", *arguments), words)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("[N/m]", "[N/m]", ""),
        ("[N/m]", "[N/mm]", "whirl frequency ratio is"),
        ("[rad/s]", "[krpm]", "whirl frequency ratio is"),
        ("", "", "critical mass per bearing [kg] is"),
    ],
)
def test_coefficients_in_wrong_units_raise_a_doubt(old, new, said, here):
    text = csv_text().replace(old, new)
    if not old:  # a thousandth of everything, twice: the ratio of the whirl stays
        head, *rows = csv_text().splitlines()
        cells = [row.split(",") for row in rows]
        small = [[row[0], *(repr(float(v) * 1e-9) for v in row[1:])] for row in cells]
        text = "\n".join([head, *(",".join(row) for row in small)])
    Path("c.csv").write_text(text, encoding="utf-8")
    done = here("stability", "c.csv")
    assert done.returncode == 0, done.stderr
    if not said:
        assert "check units" not in done.stderr
        return
    assert "warning: check units and frame: the " + said in done.stderr
