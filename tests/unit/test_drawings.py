"""Machine files from other programs' drawings: rotors saved by ROSS, tables of sections."""

import json
from pathlib import Path

import numpy as np
import pytest

from rotorsim.errors import InputError
from rotorsim.files.machine import MachineFile
from rotorsim.files.shafts import machine_text
from rotorsim.machine.spectrum import all_eigenmodes
from rotorsim.study.machines import assembled

DATA = Path(__file__).parents[1] / "data"

SHEET = """\
Rotor of the pump
length,od,id,mass,ip,it
mm,in,mm,kg,kg*m^2,kg*m^2
100,2,0,,,
200,4,20,12.5,0.2,0.11
0,,,3,,
"""


def test_rotor_saved_by_ross_has_its_eigenvalues(tmp_path):
    # Two materials, hollow, discs, a table, cross-coupled constants, a seal (ROSS 3.1.0).
    text, tables = machine_text(DATA / "ross_rotor.json", "from ROSS")
    for name, table in tables.items():
        table.to_csv(tmp_path / name)
    machine = assembled(MachineFile.from_text(text, source=tmp_path / "machine.toml"))
    reference = json.loads((DATA / "ross_rotor_eigenvalues.json").read_text(encoding="utf-8"))
    for speed, pairs in reference.items():
        theirs = np.array([complex(*pair) for pair in pairs])
        own = all_eigenmodes(machine.state_matrix(float(speed)), machine.size).values
        assert max(np.abs(theirs - one).min() / abs(one) for one in own) < 1e-9


@pytest.mark.parametrize(("key", "value", "words"), [
    ("torque", 5.0, "torque.*nothing for it"), ("alpha", 1.0, "alpha.*nothing for it"),
    ("axial_force", 9.0, "same for all"), ("n", 40, "gap"),
])  # fmt: skip
def test_what_a_machine_file_cannot_hold_is_refused(tmp_path, key, value, words):
    saved = json.loads((DATA / "ross_rotor.json").read_text(encoding="utf-8"))
    saved["ShaftElement_Shaft Element 9"][key] = value
    path = tmp_path / "rotor.json"
    path.write_text(json.dumps(saved), encoding="utf-8")
    with pytest.raises(InputError, match=words):
        machine_text(path, "x")


def test_table_of_sections_with_units_in_a_row(tmp_path):
    path = tmp_path / "shaft.csv"
    path.write_text(SHEET, encoding="utf-8")
    text, tables = machine_text(path, "pump")
    assert not tables
    machine = MachineFile.from_text(text)
    beam = machine.rotor.beam
    assert beam.length == pytest.approx(0.3)
    assert [s.outer_diameter for s in beam.sections] == pytest.approx([0.0508, 0.1016])
    assert beam.sections[1].inner_diameter == pytest.approx(0.02)
    assert [(d.at, d.mass, d.polar_inertia) for d in beam.discs] == [
        pytest.approx((0.1, 12.5, 0.2)), pytest.approx((0.3, 3.0, 0.0)),
    ]  # fmt: skip
    assert len(machine.support) == 2


@pytest.mark.parametrize(("old", "new", "words"), [
    ("mm,in,mm,kg,kg*m^2,kg*m^2\n", "", "column length needs a unit"),
    ("200,4", "200,x", "row 5, column outer_diameter.*must be a number"),
    ("200,4", "0,4", "row 5.*above 0"), ("length,od", "span,od", "columns length"),
    ("mm,in,mm,kg", "mm,in,mm,N", "column mass"), ("it\nmm", "ip\nmm", "occurs twice"),
])  # fmt: skip
def test_bad_tables_of_sections_say_where(tmp_path, old, new, words):
    path = tmp_path / "shaft.csv"
    path.write_text(SHEET.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError, match=words):
        machine_text(path, "pump")
