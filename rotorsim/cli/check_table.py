"""What `rotorsim check` shows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..model import ThermalModel
from ..rows import RPM, ZERO_CELSIUS, number
from ..study.inputs import input_rows
from .tables import grid

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rich.console import RenderableType

    from ..files.scenario import Scenario


def overview(scenario: Scenario, cases: Sequence[dict[str, Any]]) -> Iterator[RenderableType]:
    """Inputs, derived numbers at the highest speed, and the amount of work."""
    yield _inputs(scenario)
    table = grid(
        f"At {scenario.speeds[-1] * RPM:.0f} rpm",
        "model",
        "c µm",
        "U m/s",
        "Sommerfeld",
        "Reynolds",
        "Taylor",
        "Peclet",
        "Nahme",
        "dT adiab. K",
    )
    for case in cases:
        keys = ("sommerfeld_number", "reynolds_number", "taylor_number", "peclet_number")
        table.add_row(
            case["thermal_model"].value,
            number(case["radial_clearance"] * 1e6),
            number(case["surface_speed"]),
            *(number(case[key]) for key in keys),
            number(case["nahme_number"]),
            number(case["adiabatic_temperature_rise"], 3),
        )
    yield table
    if any(_heated(case) for case in cases):
        yield _warm_table(cases)
    mesh, speeds, points = (
        scenario.film.mesh,
        len(scenario.speeds),
        len(cases) * len(scenario.speeds),
    )
    yield (
        f"{_count(len(cases), 'case')} x {_count(speeds, 'speed')} = {_count(points, 'point')} "
        f"on {mesh.circumferential} x {mesh.axial} x {mesh.cross_film} cells "
        "(around, along, across)"
    )


def _count(many: int, what: str) -> str:
    return f"{many} {what}" if many == 1 else f"{many} {what}s"


def _heated(case: dict[str, Any]) -> bool:
    return case["thermal_model"] is ThermalModel.THD


def _warm_table(cases: Sequence[dict[str, Any]]) -> RenderableType:
    """Flow numbers with the viscosity at supply temperature and in the estimated warm film."""
    table = grid("Cold, and warm (estimated)", "c µm", "T °C", "mPa s", "Reynolds", "Taylor")
    for case in filter(_heated, cases):
        clearance = number(case["radial_clearance"] * 1e6)
        table.add_row(
            clearance,
            number(case["supply_temperature"] - ZERO_CELSIUS, 3),
            number(case["viscosity"] * 1e3),
            number(case["reynolds_number"]),
            number(case["taylor_number"]),
        )
        table.add_row(
            "",
            number(case["warm_temperature"] - ZERO_CELSIUS, 3),
            number(case["warm_viscosity"] * 1e3),
            number(case["warm_reynolds_number"]),
            number(case["warm_taylor_number"]),
        )
    return table


def _inputs(scenario: Scenario) -> RenderableType:
    table = grid(scenario.title, "", "")
    table.columns[1].justify = "left"
    table.columns[1].no_wrap = False
    for rows in input_rows(scenario).values():
        for row in rows:
            table.add_row(row.label, row.with_unit)
        table.add_section()
    return table
