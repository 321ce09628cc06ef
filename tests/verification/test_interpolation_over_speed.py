"""Between the speeds of a machine's table: growth rates against films solved at those speeds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from machine_texts import AT_9000_RPM, BEARING, FILMS, OVERHUNG, WHEEL, flexible_rotor

import rotorsim as rs
from rotorsim.files.machine import MachineFile

RPM = np.pi / 30.0
SOLVED = np.linspace(3000.0, 9000.0, 17) * RPM


@pytest.fixture(scope="module")
def machine(tmp_path_factory) -> MachineFile:
    """Return a rotor that oil whirl makes unstable between 5000 and 6000 rpm."""
    folder = tmp_path_factory.mktemp("machine")
    (folder / "bearing.toml").write_text(BEARING.format(circumferential=32, axial=8))
    rotor = flexible_rotor(elements=1, discs=WHEEL + OVERHUNG)
    (folder / "rotor.toml").write_text(rotor + FILMS + AT_9000_RPM)
    return rs.load_machine(folder / "rotor.toml")


def growth(machine: MachineFile, table: np.ndarray, speeds: np.ndarray) -> np.ndarray:
    """Return the largest growth rate at speeds, of films that are solved at those of a table."""
    tabulated = replace(machine.operating, speed=tuple(float(one) for one in table))
    systems = rs.state_space(machine.with_parts(operating=tabulated), speed=speeds)
    return np.array([np.asarray(one.poles()).real.max() for one in systems])


@pytest.mark.slow
def test_growth_rates_between_the_speeds_of_a_table_converge(machine):
    exact = growth(machine, SOLVED, SOLVED)
    scale = np.abs(exact).max()
    assert exact[0] < 0.0 < exact[-1]
    errors = []
    for step in (8, 4, 2):
        between = slice(step // 2, None, step)
        found = growth(machine, SOLVED[::step], SOLVED[between])
        errors.append(np.abs(found - exact[between]).max() / scale)
    # measured: 2.7e-3, 8.5e-4, 2.0e-4 with steps of 3000, 1500 and 750 rpm, orders 1.7 and 2.1
    assert np.all(errors < np.array([3.2e-3, 1.05e-3, 2.5e-4]))
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all(orders > 1.5)
