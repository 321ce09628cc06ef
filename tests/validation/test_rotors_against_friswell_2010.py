"""Beam rotors against Friswell, Penny, Garvey & Lees 2010 (examples 5.9.1, 5.9.2, 5.9.5)."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest

from rotorsim.machine.branches import Verdict
from rotorsim.machine.machine import Machine
from rotorsim.machine.modes import modes
from rotorsim.machine.support import ConstantSupport
from rotorsim.model.shaft import Disc, Material, Section
from rotorsim.rotor import Beam, beam_rotor

DATA = Path(__file__).parents[1] / "data" / "friswell_2010_rotor_eigenvalues.csv"
ROWS = list(csv.DictReader(x for x in DATA.read_text().splitlines() if not x.startswith("#")))
STEEL = Material(211e9, 7810.0, shear_modulus=81.2e9)


def machine_of(row: dict) -> Machine:
    given = dict(re.findall(r"(\w+)=([\d.e]+)", row["bearings"]))
    stiffness = [float(given.get(name, given.get("k", 0.0))) for name in ("kx", "ky")]
    support = ConstantSupport(stiffness, float(given.get("c", 0.0)))
    discs = tuple(
        Disc.from_dimensions(at, outer, 0.07, 7810.0, 0.05)
        for at, outer in ((0.5, 0.28), (1, 0.35))
    )
    beam = Beam((Section(1.5, 0.05, elements=6),), discs, STEEL)
    return Machine.on_identical(beam_rotor(beam, [0.0, 1.5]), support)


@pytest.mark.parametrize("row", ROWS, ids=lambda r: f"{r['example']} {r['rpm']} {r['quantity']}")
def test_lateral_modes_within_one_unit_of_the_last_printed_digit(row):
    machine = machine_of(row)
    assert len(machine.rotor.nodes) == 7
    found = modes(machine, float(row["rpm"]) * np.pi / 30.0).oscillating()
    frequency = found.damped_frequency if "wd" in row["quantity"] else found.undamped_frequency
    order = np.argsort(found.undamped_frequency[0])[:6]
    values = frequency[0, order] / (2.0 * np.pi if "Hz" in row["quantity"] else 1.0)
    assert values == pytest.approx([float(row[f"m{i}"]) for i in range(1, 7)], abs=0.01)


def test_nothing_damps_the_first_example():
    found = modes(machine_of(ROWS[1]), 400.0)
    assert found.undamped.all()
    assert found.verdicts == (Verdict.UNDAMPED,)
    assert found.largest_growth_rate[0] == 0.0
    damped = modes(machine_of(ROWS[-1]), 400.0)
    assert not damped.undamped.any()
    assert damped.verdicts == (Verdict.STABLE,)
