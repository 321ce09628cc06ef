"""What `rotorsim check` shows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..model import EccentricityTarget
from ..pipeline.wording import RPM, ZERO_CELSIUS, number
from .tables import grid

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rich.console import RenderableType

    from ..scenario import Scenario


def overview(scenario: Scenario, cases: Sequence[dict[str, Any]]) -> Iterator[RenderableType]:
    """Inputs, derived numbers at the highest speed, and the amount of work."""
    yield _inputs(scenario)
    table = grid(
        f"At {scenario.speeds[-1] * RPM:.0f} rpm",
        "model",
        "c um",
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
    mesh = scenario.film.mesh
    yield (
        f"{len(cases)} cases x {len(scenario.speeds)} speeds = {len(cases) * len(scenario.speeds)} "
        f"points on {mesh.circumferential} x {mesh.axial} x {mesh.cross_film} cells "
        "(around, along, across)"
    )


def _inputs(scenario: Scenario) -> RenderableType:
    bearing, oil = scenario.bearing, scenario.lubricant
    supply = scenario.thermal.supply_temperature
    target = scenario.target
    clearances = ", ".join(number(value * 1e6) for value in scenario.radial_clearances)
    table = grid(scenario.title, "", "")
    table.columns[1].justify = "left"
    table.add_row("journal radius", f"{number(bearing.journal_radius * 1e3)} mm")
    table.add_row("length", f"{number(bearing.length * 1e3)} mm")
    table.add_row("radial clearance", f"{clearances} um")
    table.add_row("grooves, arcs", f"{len(bearing.grooves)}, {len(bearing.arcs)}")
    viscosity = float(oil.viscosity(supply))
    table.add_row("viscosity", f"{number(viscosity)} Pa s at {number(supply - ZERO_CELSIUS)} degC")
    low, high = scenario.speeds[0] * RPM, scenario.speeds[-1] * RPM
    table.add_row("speed", f"{low:.0f} to {high:.0f} rpm, {len(scenario.speeds)} of them")
    if isinstance(target, EccentricityTarget):
        table.add_row("eccentricity ratio", number(target.eccentricity_ratio))
    else:
        table.add_row("load", f"{number(target.load)} N")
    models = ", ".join(model.value for model in scenario.thermal_models)
    table.add_row("thermal models", models)
    table.add_row("cavitation", scenario.film.cavitation.value)
    if scenario.rotor is not None:
        table.add_row("rotor mass per bearing", f"{number(scenario.rotor.mass)} kg")
    return table
