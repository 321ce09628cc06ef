"""What `rotorsim check` shows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..model import EccentricityTarget, ThermalModel
from ..study.wording import RPM, ZERO_CELSIUS, number
from .tables import grid

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rich.console import RenderableType

    from ..files.scenario import Scenario


def overview(scenario: Scenario, cases: Sequence[dict[str, Any]]) -> Iterator[RenderableType]:
    """Inputs, derived numbers at the highest speed, and the amount of work."""
    yield _inputs(scenario, cases)
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
    table = grid("Cold, and warm (estimated)", "c um", "T C", "mPa s", "Reynolds", "Taylor")
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


def _inputs(scenario: Scenario, cases: Sequence[dict[str, Any]]) -> RenderableType:
    table = grid(scenario.title, "", "")
    table.columns[1].justify = "left"
    for name, text in (*_drawing(scenario, cases), *_operation(scenario, cases[0])):
        table.add_row(name, text)
    return table


def _each(cases: Sequence[dict[str, Any]], key: str, factor: float) -> str:
    """Values of the cases, each once."""
    return ", ".join(dict.fromkeys(number(case[key] * factor) for case in cases))


def _drawing(scenario: Scenario, cases: Sequence[dict[str, Any]]) -> Iterator[tuple[str, str]]:
    bearing, one = scenario.bearing, cases[0]
    yield "diameter", f"{number(one['diameter'] * 1e3)} mm"
    ratio = number(one["length_to_diameter"], 3)
    yield "length", f"{number(bearing.length * 1e3)} mm, L/D {ratio}"
    yield "diametral clearance", f"{_each(cases, 'diametral_clearance', 1e3)} mm"
    ratios = _each(cases, "clearance_ratio", 1e3)
    yield "radial clearance", f"{_each(cases, 'radial_clearance', 1e6)} um, c/R {ratios} per mille"
    yield "grooves, arcs", f"{len(bearing.grooves)}, {len(bearing.arcs)}"


def _operation(scenario: Scenario, one: dict[str, Any]) -> Iterator[tuple[str, str]]:
    supply, target = scenario.thermal.supply_temperature, scenario.target
    viscosity = f"{number(one['viscosity'] * 1e3)} mPa s at {number(supply - ZERO_CELSIUS)} degC"
    yield "viscosity", viscosity
    low, high = scenario.speeds[0] * RPM, scenario.speeds[-1] * RPM
    many = f"{low:.0f} to {high:.0f} rpm, {len(scenario.speeds)} of them"
    yield "speed", many if len(scenario.speeds) > 1 else f"{high:.0f} rpm"
    if isinstance(target, EccentricityTarget):
        yield "eccentricity ratio", number(target.eccentricity_ratio)
    else:
        unit = number(one["unit_load"] / 1e6, 3)
        yield "load", f"{number(target.load / 1e3)} kN, W/(L D) {unit} MPa"
    yield "thermal models", ", ".join(model.value for model in scenario.thermal_models)
    if ThermalModel.THD in scenario.thermal_models:
        heat = scenario.thermal
        yield "oil, shaft, bush", f"{heat.inlet.value}, {heat.shaft.value}, {heat.bush.value}"
    yield "cavitation", scenario.film.cavitation.value
    if scenario.rotor is not None:
        ratio = one["weight_to_load"]
        weight = "" if ratio is None else f", weight {number(ratio, 3)} times the load"
        yield "rotor mass per bearing", f"{number(scenario.rotor.total_mass)} kg{weight}"
