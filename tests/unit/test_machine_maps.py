"""Maps and tolerances over a machine: the same numbers as the machine changed by hand."""

from __future__ import annotations

import numpy as np
import pytest

from rotorsim.errors import InputError
from rotorsim.files.machine import MachineFile, load_machine
from rotorsim.files.parameters import Variant, parameter
from rotorsim.machine.destabilising import decrement_curve
from rotorsim.machine.modes import modes
from rotorsim.machine.peaks import node_at
from rotorsim.model.machine import MachineTolerances
from rotorsim.study.machine_analysis import analyse_machine
from rotorsim.study.machine_map import map_of_machine
from rotorsim.study.tolerances import study_tolerances

RPM = np.pi / 30.0
FILM = """
[bearing]
journal_radius = "30 mm"
length = "30 mm"
radial_clearance = "{clearance}"
[lubricant]
viscosity = "0.02 Pa*s"
density = "860 kg/m^3"
specific_heat = "2000 J/(kg*delta_degC)"
thermal_conductivity = "0.13 W/(m*delta_degC)"
[film]
mesh = {{ circumferential = 32, axial = 6, cross_film = 6 }}
[operating]
speed = "3000 rpm"
load = "1 kN"
"""
ROTOR = """
title = "rotor"
[rotor]
kind = "beam"
{more}
[[rotor.section]]
length = "1 m"
outer_diameter = "60 mm"
[[rotor.disc]]
name = "wheel"
at = "0.4 m"
mass = "40 kg"
polar_inertia = "0.4 kg*m^2"
transverse_inertia = "0.25 kg*m^2"
[operating]
speed = {{ start = "2000 rpm", stop = "6000 rpm", count = 5 }}
"""
FILMS = """
[[support]]
name = "left"
at = "100 mm"
bearing = "left.toml"
pedestal = {{ mass = "30 kg", stiffness = "{stand}", damping = "2 kN*s/m" }}
[[support]]
name = "right"
at = "900 mm"
bearing = "right.toml"
"""
SPRINGS = """
[[support]]
name = "left"
at = "0 mm"
stiffness = ["20 MN/m", "15 MN/m"]
damping = "20 kN*s/m"
[[support]]
name = "right"
at = "1 m"
stiffness = "20 MN/m"
damping = "20 kN*s/m"
[lateral]
destabilising_stiffness = [{ at = "400 mm", anticipated = "ANTICIPATED" }]
"""


def on_films(folder, clearance="60 um", stand="200 MN/m", more=""):
    (folder / "left.toml").write_text(FILM.format(clearance=clearance))
    (folder / "right.toml").write_text(FILM.format(clearance="60 um"))
    path = folder / "machine.toml"
    path.write_text(ROTOR.format(more=more) + FILMS.format(stand=stand))
    return load_machine(path)


def on_springs(anticipated="1 MN/m"):
    return MachineFile.from_text(
        ROTOR.format(more="") + SPRINGS.replace("ANTICIPATED", anticipated)
    )


def growth_of(machine):
    (result,) = analyse_machine(machine, workers=1).values()
    return result.modes.largest_growth_rate


@pytest.mark.slow
def test_every_cell_is_the_machine_changed_by_hand(tmp_path):
    options = {"cells": 0, "workers": 1}
    values = {"y": ["50 um", "80 um"]}
    found = map_of_machine(on_films(tmp_path), "speed", "left.clearance", values, **options)
    assert (found.names, found.failed_points) == (("speed", "left.radial_clearance"), 0)
    # The film on the right is solved once for both clearances on the left.
    assert found.solved_points == 15
    for j, text in enumerate(values["y"]):
        expected = growth_of(on_films(tmp_path, clearance=text))
        assert found.growth("isothermal")[:, j] == pytest.approx(expected, rel=1e-6)

    values = {"x": ["100 MN/m", "300 MN/m"], "y": ["0 s", "1e-5 s"]}
    found = map_of_machine(
        on_films(tmp_path), "left.pedestal_stiffness", "internal_damping", values,
        {"speed": "5000 rpm"}, **options,
    )  # fmt: skip
    for i, j in np.ndindex(2, 2):
        more = f'internal_damping = "{values["y"][j]}"'
        machine = on_films(tmp_path, stand=values["x"][i], more=more)
        expected = growth_of(machine)[3]
        assert found.growth("isothermal")[i, j] == pytest.approx(expected, rel=1e-6)


@pytest.mark.slow
def test_interpolation_between_films_is_as_exact_as_it_says(tmp_path):
    machine = on_films(tmp_path)
    options = {"held": {"speed": "6000 rpm"}, "workers": 1}
    five = {"x": "45 um : 75 um : 5", "y": "0 MN/m, 2 MN/m"}
    axes = ("left.clearance", "wheel.destabilising_stiffness")
    coarse = map_of_machine(machine, *axes, five, cells=9, **options)
    nine = {**five, "x": "45 um : 75 um : 9"}
    solved = map_of_machine(machine, *axes, nine, cells=0, **options)
    stated = coarse.dataset["growth_rate"].attrs["interpolation_error"][0]
    ends = coarse.growth("isothermal")[:, [0, -1]]
    error = np.abs(ends - solved.growth("isothermal")).max()
    assert 0.0 < error < stated


@pytest.mark.slow
def test_the_border_over_destabilising_stiffness_is_the_stiffness_without_decrement():
    machine, speed = on_springs(), 5000.0 * RPM
    whole = analyse_machine(machine)["given"].machine
    limit = decrement_curve(whole, speed, {node_at(whole.rotor, 0.4): 1e6}).threshold
    values = {"y": [f"{0.999 * limit} N/m", f"{1.001 * limit} N/m"]}
    found = map_of_machine(
        machine, "speed", "destabilising_stiffness", {**values, "x": ["4000 rpm", "5000 rpm"]},
        cells=0, workers=1,
    )  # fmt: skip
    low, high = found.growth("given")[1]
    assert low < 0.0 < high
    # A tolerance about that value makes the machine unstable in half of the cases.
    settings = MachineTolerances({"destabilising_stiffness": "20 %"}, speed=speed, samples=64)
    study = study_tolerances(on_springs(f"{limit} N/m"), settings, workers=1)
    assert study.probability_of_instability == pytest.approx(0.5, abs=0.02)
    assert study.importance["destabilising_stiffness"] == pytest.approx(1.0, abs=1e-3)


def test_load_and_elevation_of_a_bearing(tmp_path):
    machine = on_films(tmp_path)
    wanted = parameter(machine, "left.load", "x").applied(Variant(machine), 3000.0)
    found = map_of_machine(
        machine, "left.load", "right.viscosity", {"x": ["1 kN", "3 kN"], "y": ["0.5", "2"]},
        cells=0, workers=1,
    )  # fmt: skip
    assert wanted.films == {"left": {"applied_load": 3000.0}}
    assert np.unique(found.growth("isothermal")).size == 4
    raised = parameter(machine, "left.elevation", "x").applied(Variant(machine), 1e-4)
    assert raised.machine.support[0].elevation == 1e-4


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("left.clearanc", "did you mean"),
        ("clearance", "no support has a bearing"),
        ("wheel.clearance", "no support has a bearing"),
        ("left.internal_damping", "whole machine"),
        ("middle.elevation", '"left.elevation", "right.elevation"'),
        ("left.pedestal_mass", "no support has a pedestal"),
        ("5 m.destabilising_stiffness", "must lie on the shaft"),
        ("nowhere.destabilising_stiffness", 'a name: "left", "right", "wheel"'),
        ("", "must be one of speed"),
        ("left.load", "no support has a bearing"),
        ("rotor.mass", '"wheel.mass"'),
    ],
)
def test_names_that_mean_nothing(name, said):
    with pytest.raises(InputError, match=said.replace(".", r"\.")):
        parameter(on_springs(), name, "x")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"y": "speed"}, "must differ"),
        ({"values": {"y": "1 MN/m"}}, "two values"),
        ({"values": {"y": "3 MN/m : 1 MN/m : 5"}}, "ascend"),
        ({"values": {"y": "1 MN/m : 3 MN/m : 1e9"}}, "whole number"),
        ({"values": {"y": ["1 um", "2 um"]}}, "stiffness"),
        ({"held": {"speed": "3000 rpm"}}, "cannot be held"),
        ({"y": "left.elevation"}, "needs values"),
    ],
)
def test_axes_that_are_refused(options, said):
    options = {"y": "destabilising_stiffness", "workers": 1} | options
    with pytest.raises(InputError, match=said):
        map_of_machine(on_springs(), "speed", **options)


def test_what_a_machine_file_asks_for_is_checked_when_it_is_read():
    text = ROTOR.format(more="") + SPRINGS.replace("ANTICIPATED", "1 MN/m")
    for more, key in (
        ('[[map]]\nx = "speed"\ny = "left.load"', "map[0].y"),
        ('[[map]]\nx = "speed"\ny = "wheel.mass"\ny_values = ["3 N", "4 N"]', "map[0].y_values"),
        ('[tolerances]\nspread = { "left.damping" = "5 um" }', "tolerances.spread.left.damping"),
        ("[tolerances]\nspread = {}", "tolerances.spread"),
        ('[control]\nactuator = ["7 m"]', "control.actuator[0]"),
    ):
        with pytest.raises(InputError) as caught:
            MachineFile.from_text(f"{text}\n{more}\n")
        assert caught.value.key == key


def test_the_speed_of_a_map_may_lie_between_those_that_were_solved(tmp_path):
    machine = on_films(tmp_path)
    values = {"x": "2500 rpm : 5500 rpm : 3", "y": ["0 MN/m", "1 MN/m"]}
    found = map_of_machine(
        machine, "speed", "wheel.destabilising_stiffness", values, cells=5, workers=1
    )
    whole = analyse_machine(machine, workers=1)["isothermal"].machine
    at = modes(whole, 4000.0 * RPM).largest_growth_rate[0]
    assert found.growth("isothermal")[2, 0] == pytest.approx(at, rel=1e-6)
