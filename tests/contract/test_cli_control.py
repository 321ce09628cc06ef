"""The command `control`: an actuator that holds the rotor, and one that is too weak."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from command_line import CommandLine, strict
from machine_texts import AT_9000_RPM, BEARING, FILMS, OVERHUNG, WHEEL, flexible_rotor

SCENARIO = """
title = "small"
[bearing]
journal_radius = "50 mm"
length = "50 mm"
radial_clearance = "100 um"
[lubricant]
viscosity = "0.0277 Pa*s"
[film]
inception = "free"
mesh = { circumferential = 48, axial = 8, cross_film = 8 }
[operating]
speed = ["6000 rpm", "9000 rpm"]
load = "3 kN"
[rotor]
mass = "450 kg"
"""


@pytest.fixture
def here(here: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> CommandLine:
    """Call the command line beside small.toml, with a film in closed form."""
    from rotorsim.orbit import ShortBearingForce, film_force
    from rotorsim.orbit.film_force import LoadedFilm

    def short(case, speed):
        del speed
        force = ShortBearingForce(0.0277, 0.05, 0.05, 1e-4)
        return LoadedFilm(force, 3000.0, case.bearing, "short bearing")

    # The finite film is solved or mapped for half a minute; the closed form will do here.
    monkeypatch.setattr(film_force, "loaded_film", short)
    (tmp_path / "small.toml").write_text(SCENARIO, encoding="utf-8")
    return here


@pytest.mark.slow
@pytest.mark.parametrize("design", ["lqr", "pd"])
def test_design_without_a_run_in_time(here, design):
    done = here("control", "small.toml", "--design", design, "--revolutions", "0", "--json")
    assert done.returncode == 0, done.stderr
    said = strict(done.stdout)
    assert said["passive"]["growth_rate"] > 0.0 > said["controlled"]["growth_rate"]
    assert said["critical_mass"] < said["mass"] == 450.0
    assert np.shape(said["gain"]) == (2, 4)
    assert said["controlled"]["status"] is None
    assert said["margins"]["x"]["stable"]


def test_a_machine_without_a_large_force_is_refused_before_its_films_are_solved(here):
    done = here("control", "machines/plain_rotor", "--actuator", "250 mm")
    assert done.returncode == 2, done.stdout + done.stderr
    assert "control.force_scale" in done.stderr
    assert "film points" not in done.stderr


@pytest.mark.slow
def test_a_machine_shows_the_modes_that_its_actuator_moves(here):
    Path("bearing.toml").write_text(BEARING.format(circumferential=32, axial=8))
    rotor = flexible_rotor(discs=WHEEL + OVERHUNG) + FILMS + AT_9000_RPM
    Path("rotor.toml").write_text(rotor)
    options = ("--actuator", "wheel", "--max-force", "2 kN", "--revolutions", "0")
    done = here("control", "rotor.toml", *options)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    controlled = next(i for i, line in enumerate(lines) if line.startswith("controlled"))
    slowest, low = (line.split() for line in lines[controlled : controlled + 2])
    assert float(slowest[2]) > 10_000.0  # a bending mode that nothing damps
    assert low[:4] == ["up", "to", "450", "Hz"]
    assert float(low[4]) < -10.0
    settings = f'{rotor}[control]\nactuator = ["wheel"]\nsample_time = '
    Path("rotor.toml").write_text(f'{settings}"0.1 ms"\n')
    sampled = here("control", "rotor.toml", *options)
    assert "up to" not in sampled.stdout
    Path("rotor.toml").write_text(f'{settings}"20 ms"\n')  # three turns of the shaft
    slow = here("control", "rotor.toml", *options)
    assert slow.returncode == 1, slow.stderr
    assert "but not before it is sampled" in " ".join(slow.stderr.split())


def test_bad_arguments(here):
    for arguments, words in (
        (("small.toml", "--max-force", "2"), ["--max-force", "2 kN"]),
        (("small.toml", "--max-force", "0 N"), ["--max-force", "above 0"]),
        (("small.toml", "--model", "thd"), ["thd", "isothermal"]),
        (("small.toml", "--speed", "9000"), ["--speed", "rpm"]),
        (("nowhere.toml",), ["nowhere.toml"]),
    ):
        done = here("control", *arguments)
        assert done.returncode == 2, done.stdout + done.stderr
        assert "Traceback" not in done.stderr
        for word in words:
            assert word in done.stderr


@pytest.mark.slow
def test_held_with_enough_force_and_lost_with_too_little(here):
    small = ("--disturbance", "0.2 um", "-o", "figures")
    done = here("control", "small.toml", "--max-force", "1 kN", *small)
    assert done.returncode == 0, done.stderr
    for word in ("passive", "settled", "Margins", "short bearing", "N, of 1000 N"):
        assert word in " ".join(done.stdout.split()), done.stdout
    assert "saturates" not in done.stdout
    for name in ("root_locus.png", "bode.svg", "control_orbits.png"):
        assert Path("figures", name).stat().st_size > 5000
    weak = here("control", "small.toml", "--max-force", "20 N", "--disturbance", "30 um", "--json")
    assert weak.returncode == 1
    said = strict(weak.stdout)
    assert not said["holds"]
    assert said["controlled"]["growth_rate"] < 0.0
    assert "settled" not in (said["controlled"]["status"], said["passive"]["status"])
    assert said["passive"]["max_eccentricity_ratio"] > 0.6
    assert said["largest_force"] == pytest.approx(20.0)
    assert said["saturates"] is True
    weak = here("control", "small.toml", "--max-force", "20 N", "--disturbance", "30 um")
    assert "the actuator saturates at 20 N; from 30 µm beside rest" in " ".join(weak.stdout.split())
    assert "does not hold the rotor" in weak.stderr
