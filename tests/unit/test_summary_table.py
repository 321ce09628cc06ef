"""The closing table of a run: what is compared, and whose critical mass is shown."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from rotorsim.cli.tables import _heating_table, _walls_lines
from rotorsim.status import Stability


def model(**changes: object) -> dict[str, object]:
    return {
        "load": 18e3, "min_film_thickness": 68e-6, "max_pressure": 3.5e6, "power_loss": 14e3,
        "side_flow": 5.5e-5, "max_temperature": 318.15, "wall_heat_share": None,
        "critical_mass": None, "stability": Stability.ALWAYS_STABLE, **changes,
    }  # fmt: skip


ROWS = [
    {
        "radial_clearance": 90e-6,
        "speed": 628.3,
        "isothermal": model(),
        "thd": model(
            power_loss=7e3, max_temperature=372.15, wall_heat_share=0.78, critical_mass=2380.0
        ),
    }
]


def shown(**options: bool) -> str:
    console = Console(width=100, record=True, file=io.StringIO())
    console.print(_heating_table(ROWS, **options))
    return console.export_text()


def test_film_losses_flow_and_what_heating_makes_of_them():
    text = shown()
    for words in ("At 6000 rpm", "h_min µm", "68", "3.3", "-50.0 %", "99", "2380", "stable"):
        assert words in text


@pytest.mark.parametrize(("rigid", "there"), [(True, True), (False, False)])
def test_no_critical_mass_beside_a_rotor_that_is_not_rigid(rigid, there):
    assert ("M_crit" in shown(rigid=rigid)) == there


def test_the_part_of_the_heat_that_goes_through_the_walls():
    (line,) = _walls_lines(ROWS)
    assert line == "Through bush and shaft go 78 % of the heat (thd, c = 90 µm)"
    little = [{**ROWS[0], "thd": model(wall_heat_share=1e-7)}]
    assert list(_walls_lines(little)) == []
