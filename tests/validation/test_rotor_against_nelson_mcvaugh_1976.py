"""The stepped rotor of Nelson & McVaugh 1976: synchronous critical speeds."""

from pathlib import Path

import numpy as np
import pytest

from rotorsim.machine.machine import Machine
from rotorsim.machine.modes import modes
from rotorsim.machine.support import ConstantSupport
from rotorsim.machine.thresholds import critical_speeds
from rotorsim.model.shaft import Disc, Material, Section
from rotorsim.rotor import Beam, beam_rotor

DATA = Path(__file__).parents[1] / "data" / "nelson_mcvaugh_1976_rotor.csv"
PUBLISHED = [15476.0, 17159.0, 46594.0, 49968.0, 64754.0, 96047.0]
"""Of the file's header [rpm]."""
RIGHT_END = 0.3556


def critical_rpm(shear: bool) -> list[float]:
    lines = [line for line in DATA.read_text().splitlines() if not line.startswith("#")]
    x, inner, outer = np.loadtxt(lines[1:], delimiter=",").T / 100.0
    lengths = np.diff(np.append(x, RIGHT_END))
    sections = tuple(
        Section(float(length), float(2.0 * r), float(2.0 * i))
        for length, i, r in zip(lengths, inner, outer, strict=True)
    )
    disc = Disc(0.0889, 1.401, 0.00203, 0.00136)
    beam = Beam(sections, (disc,), Material(2.078e11, 7806.0), shear=shear)
    rotor = beam_rotor(beam, [0.1651, 0.2870])
    machine = Machine.on_identical(rotor, ConstantSupport(4.378e7))
    found = modes(machine, np.linspace(500.0, 10300.0, 29))
    return [one.speed * 30.0 / np.pi for one in critical_speeds(machine, found)]


def test_critical_speeds_without_shear():
    assert critical_rpm(shear=False)[:6] == pytest.approx(PUBLISHED, rel=2e-3)


def test_shear_lowers_them():
    ratio = np.array(critical_rpm(shear=True)[:6]) / PUBLISHED
    assert np.all((ratio > 0.985) & (ratio < 0.997))
