"""Every wrong entry is answered by one error that names file, key, value and remedy."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest
from scenario_texts import BEARING, BOTH_MODELS, OIL

from rotorsim.errors import ScenarioError
from rotorsim.files.scenario import Scenario, load_scenario

GOOD = f"""\
title = "test"
{BEARING}
{OIL}
[film]
mesh = {{ circumferential = 64, axial = 16, cross_film = 12 }}
{BOTH_MODELS}
[operating]
speed = {{ start = "500 rpm", stop = "15000 rpm", count = 30 }}
eccentricity_ratio = 0.5

[rotor]
mass = "1200 kg"

[orbit]
speed = "15000 rpm"
"""
RECESS = """
[[bearing.groove]]
center = "90 deg"
extent = "40 deg"
length = "20 mm"
supply_pressure = "2 MPa"
restrictor = { kind = "orifice", diameter = "0.5 m" }
"""
GROOVES = """
[[bearing.groove]]
center = "90 deg"
extent = "20 deg"

[[bearing.groove]]
center = "100 deg"
extent = "20 deg"
"""
ARCS = """
[[bearing.arc]]
start = "-90 deg"
end = "100 deg"

[[bearing.arc]]
start = "90 deg"
end = "270 deg"
"""


def write(folder: Path, old: str, new: str) -> Path:
    assert old in GOOD
    path = folder / "case.toml"
    path.write_text(GOOD.replace(old, new, 1), encoding="utf-8")
    return path


def refused(path: Path) -> str:
    begin = time.perf_counter()
    with pytest.raises(ScenarioError) as caught:
        load_scenario(path)
    assert time.perf_counter() - begin < 2.0
    message = str(caught.value)
    assert message.startswith(str(path)), "the file comes first"
    return message


def test_the_unchanged_text_is_good(tmp_path: Path) -> None:
    assert len(load_scenario(write(tmp_path, "test", "test")).speeds) == 30


CLEARANCE = 'radial_clearance = "100 um"'
SPEED = '{ start = "500 rpm", stop = "15000 rpm", count = 30 }'
ECCENTRICITY = "eccentricity_ratio = 0.5"
VISCOSITY = 'viscosity = "0.0277 Pa*s"'
MODELS = 'models = ["isothermal", "thd"]'
END = 'speed = "15000 rpm"\n'

# what is replaced, by what, key named, what else the message must say (value, remedy)
BAD = [
    # quantities
    (CLEARANCE, "radial_clearance = 1e-4", "bearing.radial_clearance", ["0.0001", '"100 um"']),
    (CLEARANCE, 'radial_clearance = "100 kg"', "bearing.radial_clearance", ["kg", '"100 um"']),
    (CLEARANCE, 'radial_clearance = "100"', "bearing.radial_clearance", ["'100'", '"100 um"']),
    (CLEARANCE, 'radial_clearance = "-100 um"', "bearing.radial_clearance", ["-100", "above 0"]),
    (CLEARANCE, 'radial_clearance = "0 um"', "bearing.radial_clearance", ["'0 um'", "above 0"]),
    (CLEARANCE, 'radial_clearance = "nan um"', "bearing.radial_clearance", ["nan", "finite"]),
    (CLEARANCE, "radial_clearance = nan", "bearing.radial_clearance", ["nan", '"100 um"']),
    (CLEARANCE, 'radial_clearance = "100 parsecs"', "bearing.radial_clearance", ["parsecs"]),
    (CLEARANCE, 'radial_clearance = "10 mm"', "bearing.radial_clearance", ["'10 mm'", "tenth"]),
    (CLEARANCE, "radial_clearance = []", "bearing.radial_clearance", ["[]", "at least one"]),
    (CLEARANCE, "radial_clearance = true", "bearing.radial_clearance", ["True", '"100 um"']),
    (CLEARANCE, "radial_clearance = 2020-01-01", "bearing.radial_clearance", ['"100 um"']),
    (
        CLEARANCE,
        'radial_clearance = ["100 um", "125 kg"]',
        "bearing.radial_clearance[1]",
        ["125 kg"],
    ),
    (
        CLEARANCE,
        'radial_clearance = ["100 um", "0.1 mm"]',
        "bearing.radial_clearance[1]",
        ["0.1 mm", "once"],
    ),
    (CLEARANCE, 'radial_clearance = "1e9**1e9 m"', "bearing.radial_clearance", ["1e9**1e9"]),
    ('length = "80 mm"', 'length = ["80 mm"]', "bearing.length", ["['80 mm']", '"50 mm"']),
    ('length = "80 mm"', 'length = { mm = "80" }', "bearing.length", ["{'mm'", '"50 mm"']),
    ('length = "80 mm"', "", "bearing.length", ["missing", 'length = "80 mm"']),
    (
        CLEARANCE,
        CLEARANCE + '\nbush_outer_radius = "40 mm"',
        "bearing.bush_outer_radius",
        ["40 mm"],
    ),
    (CLEARANCE, CLEARANCE + '\nroughness = "1 mm"', "bearing.roughness", ["1 mm", "below"]),
    (CLEARANCE, CLEARANCE + '\ntilt = ["1 mrad"]', "bearing.tilt", ["exactly 2"]),
    (CLEARANCE, CLEARANCE + '\ntilt = ["2 mm/m", "2 mm/m"]', "bearing.tilt", ["2 mm/m", "below"]),
    # names
    ("length =", "lenght =", "bearing.lenght", ["80 mm", '"length"']),
    ("[operating]", "[operatin]", "operatin", ['"operating"']),
    (CLEARANCE, CLEARANCE + '\nload = "1 kN"', "bearing.load", ["1 kN", "[operating]"]),
    ("journal_radius", "journal_diameter", "bearing.journal_diameter", ["journal_radius, half of"]),
    ("journal_radius", "diameter", "bearing.diameter", ["journal_radius, half of"]),
    (
        "radial_clearance",
        "diametral_clearance",
        "bearing.diametral_clearance",
        ["100 um", "radial_clearance, half of"],
    ),
    (
        'length = "80 mm"',
        "length_to_diameter = 0.8",
        "bearing.length_to_diameter",
        ["write length"],
    ),
    ("[lubricant]", "[oil]", "oil", ["[lubricant]"]),
    ("[lubricant]", "[lubrication]", "lubrication", ["[lubricant]"]),
    ("cross_film", "crossfilm", "film.mesh.crossfilm", ["12", '"cross_film"']),
    ('"thd"', '"tdh"', "thermal.models[1]", ["tdh", '"thd"']),
    ("[film]", '[film]\ncavitation = "reynold"', "film.cavitation", ["reynold", '"jfo"']),
    ("[film]", "[film]\ncavitation = 3", "film.cavitation", ["3", '"jfo"']),
    # plain numbers
    (ECCENTRICITY, "eccentricity_ratio = 1.2", "operating.eccentricity_ratio", ["1.2", "0 and 1"]),
    (ECCENTRICITY, "eccentricity_ratio = 0", "operating.eccentricity_ratio", ["0", "above 0"]),
    (ECCENTRICITY, "eccentricity_ratio = nan", "operating.eccentricity_ratio", ["nan", "finite"]),
    (
        ECCENTRICITY,
        'eccentricity_ratio = "0.5"',
        "operating.eccentricity_ratio",
        ["quotes"],
    ),
    ("[film]", "[film]\nfrequency_ratio = [1.0, 0.5]", "film.frequency_ratio", ["0.5", "ascend"]),
    ("[film]", "[film]\nfrequency_ratio = 0.0", "film.frequency_ratio", ["0.0", "above 0"]),
    ("axial = 16", "axial = 15", "film.mesh.axial", ["15", "even"]),
    ("axial = 16", "axial = 16.5", "film.mesh.axial", ["16.5", "whole number"]),
    ("axial = 16", "axial = 100000", "film.mesh.axial", ["100000", "4096"]),
    ("circumferential = 64", "circumferential = 4096, bush_radial = 4096", "film.mesh", ["cells"]),
    ('title = "test"', 'title = "a\\u001b[31m"', "title", ["\\x1b", "one line of text"]),
    ('title = "test"', 'title = "a\\u0000"', "title", ["\\x00", "control characters"]),
    # the target
    (ECCENTRICITY, "", "operating", ["eccentricity_ratio or load", 'load = "10 kN"']),
    (ECCENTRICITY, ECCENTRICITY + '\nload = "1 kN"', "operating.load", ["1 kN", "not both"]),
    (ECCENTRICITY, 'load = "0 N"', "operating.load", ["0 N", "above 0", '"full_sommerfeld"']),
    (ECCENTRICITY, 'load = "-1 N"', "operating.load", ["-1 N", "0 or more"]),
    (ECCENTRICITY, 'load = "100 kg"', "operating.load", ["100 kg", "kgf"]),
    # speeds
    (SPEED, '"0 rpm"', "operating.speed", ["0 rpm", "above 0"]),
    (SPEED, '"-5 rpm"', "operating.speed", ["-5 rpm", "above 0"]),
    (SPEED, '"50 1/s"', "operating.speed", ["50 1/s", "rpm"]),
    (SPEED, "3000", "operating.speed", ["3000", '"3000 rpm"']),
    (SPEED, "[]", "operating.speed", ["at least one"]),
    (SPEED, '["2000 rpm", "1000 rpm"]', "operating.speed[1]", ["1000 rpm", "ascend"]),
    (SPEED, '["1000 rpm", "1000 rpm"]', "operating.speed[1]", ["1000 rpm", "ascend"]),
    ("count = 30", "count = 0", "operating.speed.count", ["0", "1 or more"]),
    ("count = 30", "count = 1", "operating.speed.count", ["1", "2 or more"]),
    ("count = 30", "count = 1000001", "operating.speed.count", ["1000001", "100000"]),
    (", count = 30", "", "operating.speed.count", ["missing", "count = 30"]),
    ('stop = "15000 rpm"', 'stop = "100 rpm"', "operating.speed.stop", ["100 rpm", "above start"]),
    ("count = 30", "count = 30, step = 5", "operating.speed.step", ["5", "; write count"]),
    # the oil
    (VISCOSITY, "", "lubricant", ["exactly one", "iso_vg = 32"]),
    (VISCOSITY, VISCOSITY + "\niso_vg = 32", "lubricant.iso_vg", ["32", "exactly one"]),
    (VISCOSITY, 'viscosity = "-0.02 Pa*s"', "lubricant.viscosity", ["-0.02", "above 0"]),
    (VISCOSITY, 'viscosity = "0.02 Pa"', "lubricant.viscosity", ["0.02 Pa", '"0.0277 Pa*s"']),
    (VISCOSITY, "iso_vg = 32", "lubricant.reference_temperature", ["40 degC", "remove"]),
    ('reference_temperature = "40 degC"\n', "", "lubricant.reference_temperature", ["missing"]),
    (
        'viscosity_temperature_coefficient = "0.034 / delta_degC"',
        "",
        "lubricant.viscosity_temperature_coefficient",
        ["missing", "0.034 / delta_degC"],
    ),
    (
        'reference_temperature = "40 degC"',
        'reference_temperature = "40 delta_degC"',
        "lubricant.reference_temperature",
        ["difference", '"40 degC"'],
    ),
    ('specific_heat = "2000 J/(kg*delta_degC)"', "", "lubricant.specific_heat", ["missing"]),
    # the heat
    (MODELS, "models = []", "thermal.models", ["at least one"]),
    (MODELS, 'models = ["thd", "thd"]', "thermal.models", ["once"]),
    (MODELS, MODELS + '\nshaft = "warm"', "thermal.shaft", ["warm", '"insulated"', "60 degC"]),
    (MODELS, MODELS + '\nbush = "conduction"', "bearing.bush_outer_radius", ["missing", "75 mm"]),
    ('ambient_temperature = "40 degC"', "", "thermal.ambient_temperature", ["missing"]),
    (
        'ambient_temperature = "40 degC"',
        'ambient_temperature = "40 cel"',
        "thermal.ambient_temperature",
        ["40 cel", "degC"],
    ),
    (
        'ambient_temperature = "40 degC"',
        'ambient_temperature = "-300 degC"',
        "thermal.ambient_temperature",
        ["-300", "absolute zero"],
    ),
    # grooves and arcs
    (END, END + GROOVES, "bearing.groove[1].center", ["100 deg", "overlaps", "10 deg"]),
    (END, END + RECESS, "bearing.groove[0].restrictor.diameter", ["fit into", "0.5 m"]),
    (END, END + GROOVES.replace("100 deg", "111 deg"), "bearing.groove[1].center", ["too coarse"]),
    (END, END + GROOVES.replace("20 deg", "175 deg"), "bearing.groove", ["leave no film", "350"]),
    (END, END + GROOVES.replace("20 deg", "360 deg"), "bearing.groove[0].extent", ["360 deg"]),
    (END, END + GROOVES.replace("20 deg", "5 deg"), "bearing.groove[0].extent", ["5 deg", "144"]),
    (
        END,
        END + GROOVES.replace('"20 deg"', '"20 deg"\nlength = "90 mm"', 1),
        "bearing.groove[0].length",
        ["90 mm", "(80 mm)"],
    ),
    (
        END,
        END + GROOVES.replace("100 deg", "270 deg").replace('"20 deg"', '"20 deg"\nlength="4 mm"'),
        "bearing.groove[0].length",
        ["4 mm", "40 or more", "at least 10 mm long"],
    ),
    (END, END + ARCS, "bearing.arc[0].end", ["100 deg", "overlaps"]),
    (END, END + ARCS.replace('"100 deg"', '"80 deg"'), "bearing.arc[0].end", ["80 deg", "open"]),
    (END, END + ARCS.replace('"100 deg"', '"-91 deg"'), "bearing.arc[0].end", ["-91 deg", "after"]),
    (CLEARANCE, CLEARANCE + "\npreload = 0.5", "bearing.preload", ["0.5", "profile"]),
    (CLEARANCE, CLEARANCE + '\nprofile = "elliptical"', "bearing.preload", ["preload = 0.5"]),
    (
        CLEARANCE,
        CLEARANCE + '\nprofile = "elliptical"\npreload = 1.0',
        "bearing.preload",
        ["1.0", "below 1"],
    ),
    (CLEARANCE, CLEARANCE + '\nprofile = "oval"\npreload = 0.5', "bearing.profile", ["oval"]),
    # rotor, orbit, map
    ('mass = "1200 kg"', 'mass = "-1 kg"', "rotor.mass", ["-1 kg", "above 0"]),
    ('mass = "1200 kg"', 'mass = "1 kg"\nkind = "jelly"', "rotor.kind", ["jelly", "rigid"]),
    ('[rotor]\nmass = "1200 kg"', "", "rotor", ["missing", "orbit"]),
    (END, 'speed = "16000 rpm"\n', "orbit.speed", ["16000 rpm", "15000 rpm"]),
    (
        END,
        'speed = { start = "100 rpm", stop = "900 rpm", duration = "1 s" }\n',
        "orbit.speed.start",
        ["100 rpm", "500 to 15000"],
    ),
    (
        END,
        'speed = { start = "500 rpm", stop = "900 rpm", duration = "1 s" }\nrevolutions = 4\n',
        "orbit.revolutions",
        ["4", "remove"],
    ),
    (END, END + 'radial_clearance = "90 um"\n', "orbit.radial_clearance", ["90 um", '"100 um"']),
    (
        END,
        END + 'initial_displacement = ["151 um", "0 um"]\n',
        "orbit.initial_displacement",
        ["151 um", "outside the clearance"],
    ),
    (END, END + "revolutions = 1e9\n", "orbit.revolutions", ["1000000000.0", "whole number"]),
    (END, END + "[stability]\nmass = 3\n", "stability.mass", ["3", "1200 kg"]),
    (
        END,
        END + '[tolerances]\nradial_clearance = "100 um"\n',
        "tolerances.radial_clearance",
        ["'100 um'", "below bearing.radial_clearance, 100 um"],
    ),
    (
        END,
        END + '[tolerances]\nradial_clearance = "25.1 um"\ndistribution = "normal"\n',
        "tolerances.radial_clearance",
        ["25.1 um", "four standard deviations", "25 um"],
    ),
    (
        END,
        END + '[tolerances]\nviscosity = { spread = "30 %", distribution = "normal" }\n',
        "tolerances.viscosity",
        ["30 %", "25 %"],
    ),
    (END, END + '[stability]\nmass = ["2 kg", "1 kg"]\n', "stability.mass[1]", ["1 kg", "ascend"]),
]


@pytest.mark.parametrize(("old", "new", "key", "said"), BAD)
def test_bad_entry(tmp_path: Path, old: str, new: str, key: str, said: list[str]) -> None:
    path = write(tmp_path, old, new)
    first_line = refused(path).splitlines()[0]
    assert first_line.startswith(f"{path}: {key}: ")
    for word in said:
        assert word in first_line


def test_a_misspelt_key_comes_before_the_one_it_leaves_missing(tmp_path: Path) -> None:
    lines = refused(write(tmp_path, "journal_radius", "jurnal_radius")).splitlines()
    assert 'did you mean "journal_radius"' in lines[0]
    assert "also: bearing.journal_radius: is missing" in lines[1]


def test_further_errors_are_listed(tmp_path: Path) -> None:
    path = write(
        tmp_path, 'journal_radius = "50 mm"\nlength = "80 mm"', "journal_radius = 1\nlength = 2"
    )
    message = refused(path)
    assert message.count("\n") == 1
    assert "bearing.length: is a bare number" in message


def test_a_hundred_errors_stay_readable(tmp_path: Path) -> None:
    path = write(tmp_path, "[film]", "[film]\n" + "".join(f"k{i} = 1\n" for i in range(100)))
    message = refused(path)
    assert len(message.splitlines()) == 12
    assert message.endswith("and 89 more")


BAD_FILES = [
    (b"[bearing\n", "not valid TOML"),
    (b"[bearing]\nlength = 80 mm\n", "line 2"),
    (b"a = 1\na = 2\n", "not valid TOML"),
    (b"", "bearing"),
    (b"# \xff\n", "UTF-8"),
    (b"\n\n\xe9", "line 3"),
    (b"# " + b"x" * 1_000_000, "larger than"),
    (b"x = " + b"[" * 50_000, "nested too deeply"),
    (b"x = " + b"{a=" * 50_000, "nested too deeply"),
    (b"a." * 30_000 + b"a = 1", "nested too deeply"),
    (b"[" + b"a." * 30_000 + b"a]", "nested too deeply"),
    (b"x = " + b"9" * 10_000, "TOML"),
    (b"x = 0x" + b"f" * 100_000, "x"),
    (b"title = 0x" + b"f" * 100_000, "title"),
    (b"title = " + b"[" * 40 + b"1" + b"]" * 40, "title"),
    (b'title = "' + b"t" * 900_000 + b'"', "500 characters"),
    (b"bearing = 3\nlubricant = []\noperating = true\n", "[bearing]"),
    (b"[[bearing]]\nlength = 3\n", "bearing"),
]


@pytest.mark.parametrize(("content", "said"), BAD_FILES, ids=range(len(BAD_FILES)))
def test_bad_file(tmp_path: Path, content: bytes, said: str) -> None:
    path = tmp_path / "case.toml"
    path.write_bytes(content)
    message = refused(path)
    assert said in message
    assert len(message) < 4000


GROOVE = '[bearing.groove]\ncenter = "90 deg"\n'
NOT_TOML = [
    (GROOVE + GROOVE, "[[bearing.groove]], with double brackets"),
    (GROOVE + GROOVE.replace("[bearing.groove]", "[[bearing.groove]]"), "the first one as well"),
    ("[bearing]\n[bearing]\n", "[bearing] may stand once only"),
    ("a = 1\na = 2\n", "a may stand once only"),
    ("preload = 0,5\n", "with a point: 0.5"),
    ("length = 80,5 mm # long\n", 'with a point: "80.5 mm", in quotes'),
    ("length = 80 mm\n", 'in quotes: "80 mm"'),
    ('length = 80 mm"\n', 'in quotes: "80 mm"'),
    ("speed = { start = 500 rpm, count = 3 }\n", 'in quotes: "500 rpm"'),
    ('length = "80 mm\nload = 1\n', "closing quote is missing"),
    ("length = '80 mm", "closing quote is missing"),
    ("length = “80 mm”\n", "plain quotes"),
    ("steady_only = True\n", "true or false"),
    ("profile = elliptical\n", 'in quotes: "elliptical"'),
    ("preload =\n", "a value is missing"),
    ("preload = .5\n", "0.5"),
    ('length: "80 mm"\n', "equals sign"),
    ("[bearing\n", "close the bracket"),
    ('models = ["thd" "isothermal"]\n', "commas between"),
    ('speed = { start = "1 rpm",\n stop = "2 rpm" }\n', "braces"),
    ("a = 1 // one\n", "comments begin with #"),
]


@pytest.mark.parametrize(("content", "said"), NOT_TOML, ids=range(len(NOT_TOML)))
def test_what_is_not_toml_gets_advice_that_fits(tmp_path: Path, content: str, said: str) -> None:
    path = tmp_path / "case.toml"
    path.write_text(content, encoding="utf-8")
    message = refused(path)
    assert ": is not valid TOML: " in message
    assert said in message.partition("; ")[2]


def test_long_list_is_refused_quickly(tmp_path: Path) -> None:
    entries = ", ".join(['"1 foo"'] * 60_000)
    assert "10000 entries" in refused(write(tmp_path, SPEED, f"[{entries}]"))


@pytest.mark.parametrize(
    "entry", ["9 m**9**9**9", "1 ((((km^9)^9)^9)^9)^9", "1 " + "(" * 90, "m" * 10_000]
)
def test_unit_texts_that_could_blow_up(tmp_path: Path, entry: str) -> None:
    assert "bearing.length" in refused(write(tmp_path, '"80 mm"', f'"{entry}"'))


def test_missing_file_suggests_a_neighbour(tmp_path: Path) -> None:
    write(tmp_path, "test", "test")
    assert 'case.toml"' in refused(tmp_path / "cse.toml")


def test_a_neighbour_that_differs_in_case_alone_is_suggested_first(tmp_path: Path) -> None:
    for name in ("pump.toml", "pumpA.toml", "pumpb.toml", "pumpas.toml"):
        (tmp_path / name).write_text(GOOD, encoding="utf-8")
    if (tmp_path / "pumpa.toml").exists():
        pytest.skip("case is nothing to this file system")
    assert f'did you mean "{tmp_path / "pumpA.toml"}"' in refused(tmp_path / "pumpa.toml")


def test_missing_folder(tmp_path: Path) -> None:
    assert "no such file" in refused(tmp_path / "none" / "case.toml")


def test_directory(tmp_path: Path) -> None:
    assert "is a directory" in refused(tmp_path)


def test_pipe(tmp_path: Path) -> None:
    if not hasattr(os, "mkfifo"):
        pytest.skip("there are no named pipes here")
    os.mkfifo(tmp_path / "case.toml")
    assert "is no ordinary file" in refused(tmp_path / "case.toml")


def test_overlong_name(tmp_path: Path) -> None:
    assert "cannot be read" in refused(tmp_path / ("x" * 300 + ".toml"))


def test_folder_without_search_permission(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, stat = write(tmp_path, "test", "test"), Path.stat

    def denied(self: Path, **options: bool) -> os.stat_result:
        if tmp_path in self.parents:
            raise PermissionError(13, "Permission denied", str(self))
        return stat(self, **options)

    monkeypatch.setattr(Path, "stat", denied)
    assert "Permission denied" in refused(path)


def test_impossible_path() -> None:
    with pytest.raises(ScenarioError, match=r"read|no such"):
        load_scenario("a\0b.toml")


def test_text_without_a_file_is_named() -> None:
    with pytest.raises(ScenarioError, match=r"^scenario text: bearing: is missing"):
        Scenario.from_text("")
