"""Published rotors through their machine files: Friswell et al. 2010, Nelson & McVaugh 1976."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest

from rotorsim.files.machine import MachineFile
from rotorsim.machine.machine import Machine
from rotorsim.machine.modes import modes
from rotorsim.machine.peaks import node_at
from rotorsim.machine.support import ConstantSupport
from rotorsim.machine.thresholds import critical_speeds
from rotorsim.rows import RPM
from rotorsim.shipped import shipped_machines

DATA = Path(__file__).parents[1] / "data" / "friswell_2010_rotor_eigenvalues.csv"
ROWS = list(csv.DictReader(x for x in DATA.read_text().splitlines() if not x.startswith("#")))
NELSON = [15476.0, 17159.0, 46594.0, 49968.0, 64754.0, 96047.0]
"""Synchronous critical speeds [rpm]."""


def text_of(name: str) -> str:
    return shipped_machines()[f"machines/{name}"].read_text(encoding="utf-8")


def machine_of(text: str) -> tuple[MachineFile, Machine]:
    file = MachineFile.from_text(text)
    rotor = file.rotor_with_unbalance()
    supports = [
        (
            node_at(rotor, entry.at),
            ConstantSupport(
                np.array(entry.stiffness), 0.0 if entry.damping is None else entry.damping
            ),
        )
        for entry in file.support
    ]
    return file, Machine(rotor, supports)


def with_supports(text: str, bearings: str) -> str:
    """The machine's text with the supports of a row of the published table."""
    given = dict(re.findall(r"(\w+)=([\d.e]+)", bearings))
    kx, ky = (float(given.get(name, given.get("k", 0.0))) for name in ("kx", "ky"))
    text = text.replace('stiffness = "1 MN/m"', f'stiffness = ["{kx} N/m", "{ky} N/m"]')
    return text.replace('damping = "3 kN*s/m"', f'damping = "{given.get("c", 0.0)} N*s/m"')


@pytest.mark.parametrize("row", ROWS, ids=lambda r: f"{r['example']} {r['rpm']} {r['quantity']}")
def test_friswell_within_one_unit_of_the_last_printed_digit(row):
    file, machine = machine_of(with_supports(text_of("friswell"), row["bearings"]))
    assert file.rotor.beam.mesh().size == len(machine.rotor.nodes) == 7
    found = modes(machine, float(row["rpm"]) / RPM).oscillating()
    frequency = found.damped_frequency if "wd" in row["quantity"] else found.undamped_frequency
    order = np.argsort(found.undamped_frequency[0])[:6]
    values = frequency[0, order] / (2.0 * np.pi if "Hz" in row["quantity"] else 1.0)
    assert values == pytest.approx([float(row[f"m{i}"]) for i in range(1, 7)], abs=0.01)


def test_the_shipped_supports_are_those_of_example_5_9_5():
    _, machine = machine_of(text_of("friswell"))
    found = modes(machine, 4000.0 / RPM).oscillating()
    values = np.sort(found.undamped_frequency[0])[:5] / (2.0 * np.pi)
    assert values == pytest.approx([13.70, 14.09, 43.61, 52.18, 122.37], abs=0.01)


def test_nelson_mcvaugh_within_two_thousandths():
    file, machine = machine_of(text_of("nelson_mcvaugh"))
    found = modes(machine, np.array(file.operating.speeds))
    values = [one.speed * RPM for one in critical_speeds(machine, found)]
    assert values[:6] == pytest.approx(NELSON, rel=2e-3)
