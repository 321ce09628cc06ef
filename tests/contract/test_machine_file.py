"""Machine files: what they describe, what is refused, statics, and the commands on them."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
from command_line import CommandLine, strict

from rotorsim.bearing.drawing import STANDARD_GRAVITY
from rotorsim.errors import InputError, ScenarioError
from rotorsim.files.machine import MachineFile, is_machine, load_machine
from rotorsim.machine.statics import static_equilibrium, weight
from rotorsim.study.machine import destabilised_by_heating
from rotorsim.study.machine_analysis import analyse_machine

DATA = Path(__file__).parents[1] / "data"
SHAFT = """
title = "test rotor"
[rotor]
kind = "beam"
[[rotor.section]]
length = "1 m"
outer_diameter = "60 mm"
[[rotor.disc]]
name = "wheel"
at = "0.5 m"
mass = "40 kg"
polar_inertia = "0.4 kg*m^2"
transverse_inertia = "0.25 kg*m^2"
[[rotor.unbalance]]
at = "0.5 m"
grade = "G2.5"
[operating]
speed = { start = "1000 rpm", stop = "9000 rpm", count = 5 }
"""
SPRINGS = """
[[support]]
at = "0 mm"
stiffness = ["20 MN/m", "15 MN/m"]
damping = "20 kN*s/m"
[[support]]
name = "right"
at = "1 m"
stiffness = "20 MN/m"
damping = "20 kN*s/m"
"""
FILM = """
[bearing]
journal_radius = "30 mm"
length = "30 mm"
radial_clearance = "60 um"
[lubricant]
viscosity = "0.02 Pa*s"
density = "860 kg/m^3"
specific_heat = "2000 J/(kg*delta_degC)"
thermal_conductivity = "0.13 W/(m*delta_degC)"
[film]
mesh = { circumferential = 48, axial = 8, cross_film = 8 }
[operating]
speed = "3000 rpm"
load = "1 kN"
"""


def machine(text: str) -> MachineFile:
    return MachineFile.from_text(text)


def test_grade_and_amount_of_unbalance():
    found = machine(SHAFT + SPRINGS)
    rotor = found.rotor_with_unbalance()
    top = 9000.0 * np.pi / 30.0
    assert np.abs(rotor.unbalance).sum() == pytest.approx(2.5e-3 / top * rotor.total_mass)
    assert found.support_names == ("support 1", "right")


@pytest.mark.parametrize(
    ("text", "key"),
    [
        (SHAFT + SPRINGS.replace('"1 m"', '"1.2 m"'), "support[1].at"),
        (SHAFT + SPRINGS.replace('at = "1 m"', 'at = "0 mm"'), "support[1].at"),
        (SHAFT.replace('at = "0.5 m"\nmass', 'at = "1.5 m"\nmass') + SPRINGS, "rotor.disc[0].at"),
        (SHAFT.replace('"0.4 kg*m^2"', '"-0.4 kg*m^2"') + SPRINGS, "rotor.disc[0].polar_inertia"),
        (SHAFT + '[[support]]\nat = "0 mm"\nbearing = "none.toml"\n', "support[0].bearing"),
        (SHAFT + '[[support]]\nat = "0 mm"\n', "support[0].bearing"),
        (SHAFT + '[[support]]\nat = "0 mm"\nstiffness = 3e6\n', "support[0].stiffness"),
        (SHAFT.replace("G2.5", "fine") + SPRINGS, "rotor.unbalance[0].grade"),
        (SHAFT.replace('"60 mm"', '"60 s"') + SPRINGS, "rotor.section[0].outer_diameter"),
        (SHAFT + SPRINGS + '[[probe]]\nat = "2 m"\n', "probe[0].at"),
        (SHAFT + SPRINGS.replace('= "20 MN/m"', '= "-20 MN/m"'), "support[1].stiffness"),
        (SHAFT + SPRINGS.replace('= "20 kN', '= "-20 kN'), "support[0].damping"),
        (SHAFT + SPRINGS + 'elevation = "150 mm"\n', "support[1].elevation"),
        (SHAFT.replace('"beam"', '"beam"\naxial_force = "-2 MN"') + SPRINGS, "rotor.axial_force"),
    ],
)
def test_bad_input_names_its_key(text, key):
    with pytest.raises(ScenarioError) as refused:
        machine(text)
    assert refused.value.key == key


def test_two_supports_share_the_weight_by_statics():
    text = SHAFT.replace('at = "0.5 m"\nmass', 'at = "0.25 m"\nmass')
    rotor = machine(text + SPRINGS).rotor_with_unbalance()
    law = [lambda load: (load / 2e7, np.eye(2) / 2e7)] * 2
    ends = [0, len(rotor.nodes) - 1]
    found = static_equilibrium(rotor, weight(rotor), ends, law, np.zeros((2, 2)))
    shaft = rotor.total_mass - 40.0
    expected = STANDARD_GRAVITY * np.array([shaft / 2.0 + 30.0, shaft / 2.0 + 10.0])
    assert found.reactions[:, 0] == pytest.approx(expected, rel=1e-9)
    assert np.abs(found.reactions[:, 1]).max() < 1e-9 * expected.sum()


def test_three_stiff_supports_take_the_loads_of_a_continuous_beam():
    """Two equal spans under uniform load: 3/8, 10/8 and 3/8 of the load of one span."""
    text = """
[rotor]
kind = "beam"
[[rotor.section]]
length = "4 m"
outer_diameter = "40 mm"
[operating]
speed = "1000 rpm"
[[support]]
at = "0 m"
stiffness = "1 MN/m"
[[support]]
at = "2 m"
stiffness = "1 MN/m"
[[support]]
at = "4 m"
stiffness = "1 MN/m"
"""
    rotor = machine(text).rotor_with_unbalance()
    nodes = [0, len(rotor.nodes) // 2, len(rotor.nodes) - 1]
    law = [lambda load: (load / 1e13, np.eye(2) / 1e13)] * 3
    found = static_equilibrium(rotor, weight(rotor), nodes, law, np.zeros((3, 2)))
    span = 0.5 * rotor.total_mass * STANDARD_GRAVITY
    # Shear adds some (d/l)^2 = 4e-4.
    expected = np.array([3.0, 10.0, 3.0]) / 8.0 * span
    assert found.reactions[:, 0] == pytest.approx(expected, rel=2e-3)
    assert found.converged
    raised = np.zeros((3, 2))
    raised[1, 0] = 1e-3  # the middle housing stands lower: downwards is +x
    lowered = static_equilibrium(rotor, weight(rotor), nodes, law, raised)
    bending = rotor.total_mass / 4.0 / 7830.0
    second = bending**2 / (4.0 * np.pi)
    stiffness = 48.0 * 207e9 * second / 4.0**3
    change = found.reactions[1, 0] - lowered.reactions[1, 0]
    assert change == pytest.approx(stiffness * 1e-3, rel=2e-3)


def test_a_rotor_with_loads_needs_two_supports():
    rotor = machine(SHAFT + SPRINGS).rotor_with_unbalance()
    law = [lambda load: (load, np.eye(2))]
    with pytest.raises(InputError, match="two or more"):
        static_equilibrium(rotor, weight(rotor), [0], law, np.zeros((1, 2)))


def test_films_carry_the_reactions_at_any_direction_of_the_load(tmp_path):
    """A pull to one side turns the film, its coefficients included, with the load."""
    (tmp_path / "film.toml").write_text(FILM, encoding="utf-8")
    supports = "".join(
        f'[[support]]\nname = "{name}"\nat = "{at}"\nbearing = "film.toml"\n'
        for name, at in (("left", "0 mm"), ("right", "1 m"))
    )
    down = tmp_path / "down.toml"
    down.write_text(SHAFT + supports, encoding="utf-8")
    (one,) = analyse_machine(load_machine(down), workers=1).values()
    total = one.machine.rotor.total_mass * STANDARD_GRAVITY
    side = tmp_path / "side.toml"
    pull = f'[[load]]\nat = "0.5 m"\nforce = ["0 N", "{total:.10g} N"]\n'
    vertical = SHAFT.replace("[operating]", "[operating]\nvertical = true")
    side.write_text(vertical + supports + pull, encoding="utf-8")
    (other,) = analyse_machine(load_machine(side), workers=1).values()
    assert one.converged
    assert other.converged
    assert np.hypot(*one.supports[0].load[0]) == pytest.approx(total / 2.0, rel=1e-6)
    assert np.degrees(other.supports[0].direction) == pytest.approx(90.0)
    # The rotor is isotropic: its eigenvalues do not depend on the direction of the load.
    assert one.modes is not None
    assert other.modes is not None
    values = [np.sort_complex(m.eigenvalues[-1])[-6:] for m in (one.modes, other.modes)]
    assert values[0] == pytest.approx(values[1], rel=1e-6)
    assert destabilised_by_heating(one, one) == []


def test_stability_and_check_know_a_machine_file(here: CommandLine, tmp_path):
    path = tmp_path / "rotor.toml"
    path.write_text(SHAFT + SPRINGS, encoding="utf-8")
    assert is_machine(path)
    done = here("check", path)
    assert done.returncode == 0
    assert "test rotor" in done.stdout
    done = here("stability", path, "--json")
    assert done.returncode == 0, done.stderr
    found = strict(done.stdout)
    assert found["verdict"] == "stable"
    assert len(found["modes"]) == len(found["speeds"]) == 5
    first = found["modes"][0][0]
    assert {"growth_rate", "damped_frequency", "undamped_frequency", "whirl"} <= set(first)
    frequencies = [mode["undamped_frequency"] for mode in found["modes"][0]]
    assert frequencies == sorted(frequencies)
    assert "NaN" not in json.dumps(found)
    done = here("stability", path, "--mass", "3 kg")
    assert done.returncode == 2
    assert "--mass" in done.stderr


@pytest.mark.slow
def test_run_tells_supports_response_and_checks(here: CommandLine, tmp_path):
    path = tmp_path / "rotor.toml"
    probes = '[[probe]]\nname = "DE"\nat = "0.1 m"\nangle = "45 deg"\n'
    text = (SHAFT + SPRINGS + probes).replace(
        "[operating]", '[operating]\ncontinuous = ["5000 rpm", "8000 rpm"]'
    )
    path.write_text(text, encoding="utf-8")
    done = here("run", path, "--json")
    assert done.returncode == 0, done.stderr
    found = strict(done.stdout)
    (probe,) = found["unbalance_response"]
    assert probe["probe"] == "DE"
    assert len(probe["amplitude"]) == len(probe["speeds"])
    assert max(probe["amplitude"]) > 0.0
    for peak in probe["peaks"]:
        assert {"amplification_factor", "separation_margin", "required_margin"} <= set(peak)
    assert [one["name"] for one in found["supports"]] == ["support 1", "right"]
    assert found["lateral"]["notes"]
    drawn = {name.rpartition("/")[2] for name in found["files"]["figures"]}
    assert {"rotor.png", "campbell.png", "unbalance_response.png"} <= drawn
    assert (tmp_path / "figures" / "rotor" / "rotor.png").stat().st_size > 5000


def test_python_answers_questions_to_a_machine_file(tmp_path):
    import rotorsim as rs

    path = tmp_path / "rotor.toml"
    path.write_text(SHAFT + SPRINGS, encoding="utf-8")
    machine = rs.load_machine(path)
    speed = 3000.0 * np.pi / 30.0
    found = rs.modes(machine, speed=speed)
    lowest = float(found.undamped_frequency[0, 0])
    system = rs.state_space(machine, speed=speed)
    assert np.abs(system.poles()).min() == pytest.approx(lowest, rel=1e-6)
    response = rs.unbalance_response(machine, speed=speed)
    wheel = response.at("wheel")
    assert np.abs(wheel).max() > 0.0
    with pytest.raises(InputError, match="load_machine"):
        rs.modes("rotor.toml")


def test_pads_stand_by_a_machine_s_x_whatever_load_their_own_file_has(tmp_path):
    """``on_pad`` counts from machine x, angles of pivots as a groove's."""
    pads = FILM.replace("[bearing]\n", '[bearing]\nkind = "tilting_pad"\n').replace(
        "[lubricant]",
        '[bearing.pads]\ncount = 4\narc = "70 deg"\nthickness = "12 mm"\npreload = 0.3\nPLACE\n'
        "[lubricant]",
    )
    found = {}
    for name, place, direction in (
        ("plain", 'load = "on_pad"', "0 deg"),
        ("own", 'load = "on_pad"', "30 deg"),
        ("angle", 'pivot_angle = "20 deg"', "30 deg"),
    ):
        text = pads.replace("PLACE", place) + f'load_direction = "{direction}"\n'
        (tmp_path / f"{name}.toml").write_text(text)
        supports = "".join(
            f'[[support]]\nname = "{at}"\nat = "{at}"\nbearing = "{name}.toml"\n'
            for at in ("0 m", "1 m")
        )
        file = tmp_path / f"machine_{name}.toml"
        shaft = SHAFT.replace("count = 5", "count = 2")
        file.write_text(shaft + supports)
        (one,) = analyse_machine(load_machine(file), workers=1).values()
        found[name] = one.supports[0].points[-1]
        assert found[name].converged
    loads = {name: [pad.load for pad in point.pads] for name, point in found.items()}
    np.testing.assert_allclose(loads["own"], loads["plain"], rtol=1e-9)
    # The load falls on machine x: on the first pad, or 20 degrees before it.
    assert loads["plain"][1] == pytest.approx(loads["plain"][3], rel=1e-6)
    assert loads["angle"][3] > 1.05 * loads["angle"][1]


def test_one_bearing_of_several_in_a_file_is_named_by_a_key(here: CommandLine, tmp_path):
    ross = DATA / "cases" / "11-several-bearings" / "two.toml"
    (tmp_path / "two.toml").write_text(ross.read_text(encoding="utf-8"), encoding="utf-8")
    carried = '[[support]]\nat = "{}"\ncoefficients = "two.toml"\n{}'
    places = ("0 mm", "1 m")

    def written(named: str) -> str:
        text = SHAFT + "\n".join(carried.format(place, named) for place in places)
        (tmp_path / "machine.toml").write_text(text, encoding="utf-8")
        return "machine.toml"

    done = here("check", written(""))
    assert done.returncode == 2
    assert 'choose one with coefficients_bearing = "NAME"' in done.stderr
    assert "--bearing" not in done.stderr
    done = here("check", written('coefficients_bearing = "nobody"'))
    assert done.returncode == 2
    assert "support[0].coefficients_bearing" in done.stderr
    assert "no bearing has that name" in done.stderr
    found = here("check", written('coefficients_bearing = "b"'))
    assert found.returncode == 0, found.stderr
    springs = SHAFT + SPRINGS.replace("stiffness", 'coefficients_bearing = "b"\nstiffness')
    with pytest.raises(InputError, match="goes with coefficients"):
        MachineFile.from_text(springs)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="POSIX")
def test_a_pipe_is_no_bearing(tmp_path):
    os.mkfifo(tmp_path / "pipe.toml")
    for key in ("bearing", "coefficients"):
        text = SHAFT + f'[[support]]\nat = "0 mm"\n{key} = "pipe.toml"\n'
        (tmp_path / "machine.toml").write_text(text, encoding="utf-8")
        with pytest.raises(InputError, match="is no ordinary file"):
            analyse_machine(load_machine(tmp_path / "machine.toml"))
