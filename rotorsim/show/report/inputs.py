"""What went into the calculation, with units."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...model import BushModel, EccentricityTarget, ShaftModel, ThermalModel
from ...study.wording import RPM, ZERO_CELSIUS, number
from . import html

if TYPE_CHECKING:
    from ...files.scenario import Scenario
    from ...model import Bearing

Rows = list[tuple[str, str]]


def inputs(scenario: Scenario) -> str:
    """Everything that the results rest on, defaults included."""
    blocks = [_bearing(scenario), _oil(scenario), _film(scenario), _operation(scenario)]
    return f'<div class="columns">{"".join(html.facts(rows) for rows in blocks)}</div>'


def _millimetres(value: float) -> str:
    return f"{number(value * 1e3)} mm"


def _micrometres(value: float) -> str:
    return f"{number(value * 1e6)} µm"


def _celsius(value: float) -> str:
    return f"{number(value - ZERO_CELSIUS)} °C"


def _degrees(value: float) -> str:
    return f"{number(math.degrees(value))}°"


def _bearing(scenario: Scenario) -> Rows:
    bearing = scenario.bearing
    rows = [
        ("journal radius", _millimetres(bearing.journal_radius)),
        ("length", _millimetres(bearing.length)),
        ("length to diameter", number(bearing.length / bearing.diameter)),
        ("radial clearance", ", ".join(_micrometres(c) for c in scenario.radial_clearances)),
        ("clearance over radius", ", ".join(_per_mille(bearing, scenario))),
    ]
    if bearing.bush_outer_radius is not None:
        rows.append(("bush outer radius", _millimetres(bearing.bush_outer_radius)))
    for place, groove in enumerate(bearing.grooves, start=1):
        length = bearing.length if groove.length is None else groove.length
        rows.append(
            (
                f"groove {place}",
                f"at {_degrees(groove.center)}, {_degrees(groove.extent)} wide, "
                f"{_millimetres(length)} long, {number(groove.supply_pressure / 1e3)} kPa",
            )
        )
    for place, arc in enumerate(bearing.arcs, start=1):
        rows.append(
            (
                f"lobe {place}",
                f"{_degrees(arc.start)} to {_degrees(arc.end)}, preload {number(arc.preload)}, "
                f"offset {number(arc.offset)}",
            )
        )
    if not bearing.grooves and not bearing.arcs:
        rows.append(("bore", "plain, 360°"))
    if any(bearing.tilt):
        rows.append(("tilt", ", ".join(f"{number(angle * 1e3)} mrad" for angle in bearing.tilt)))
    if bearing.roughness:
        rows.append(("roughness", _micrometres(bearing.roughness)))
    return rows


def _per_mille(bearing: Bearing, scenario: Scenario) -> list[str]:
    ratios = [c / bearing.journal_radius for c in scenario.radial_clearances]
    return [f"{number(1e3 * ratio)} ‰" for ratio in ratios]


def _oil(scenario: Scenario) -> Rows:
    oil, supply = scenario.lubricant, scenario.thermal.supply_temperature
    temperatures = sorted({supply, 40.0 + ZERO_CELSIUS, 100.0 + ZERO_CELSIUS})
    low, high = oil.temperature_range
    rows = [
        (f"viscosity at {_celsius(t)}", f"{number(float(oil.viscosity(t)) * 1e3)} mPa s")
        for t in temperatures
        if low <= t <= high
    ]
    return [
        *_grade(scenario),
        *rows,
        ("density", f"{number(oil.density)} kg/m³"),
        ("specific heat", f"{number(oil.specific_heat)} J/(kg K)"),
        ("thermal conductivity", f"{number(oil.thermal_conductivity)} W/(m K)"),
    ]


def _grade(scenario: Scenario) -> Rows:
    """The ISO VG grade as the scenario's text has it: the law that follows from it keeps none."""
    given = tomllib.loads(scenario.text).get("lubricant", {})
    if "iso_vg" not in given:
        return []
    index = given.get("viscosity_index")
    more = "" if index is None else f", viscosity index {number(index)}"
    return [("oil", f"ISO VG {number(given['iso_vg'])}{more}")]


def _film(scenario: Scenario) -> Rows:
    film, thermal = scenario.film, scenario.thermal
    mesh = film.mesh
    rows = [
        ("cavitation", film.cavitation.value.replace("_", " ")),
        ("start of the film", film.inception.value.replace("_", " ")),
        (
            "cells around, along, across",
            f"{mesh.circumferential} × {mesh.axial} × {mesh.cross_film}",
        ),
        ("thermal models", ", ".join(model.value for model in scenario.thermal_models)),
        ("supply temperature", _celsius(thermal.supply_temperature)),
    ]
    if ThermalModel.THD not in scenario.thermal_models:
        return rows
    rows += [
        ("ambient temperature", _celsius(thermal.ambient_temperature)),
        ("oil at the inlet", thermal.inlet.value),
        ("shaft", thermal.shaft.value.replace("_", " ")),
        ("bush", thermal.bush.value),
        ("friction of the ruptured film", film.ruptured_friction.value),
    ]
    if thermal.shaft_temperature is not None and thermal.shaft is not ShaftModel.AMBIENT:
        rows.append(("shaft temperature", _celsius(thermal.shaft_temperature)))
    if thermal.bush is BushModel.CONDUCTION:
        rows += [
            ("bush conductivity", f"{number(thermal.bush_conductivity)} W/(m K)"),
            ("bush heat transfer", f"{number(thermal.bush_heat_transfer)} W/(m² K)"),
        ]
    return rows


def _operation(scenario: Scenario) -> Rows:
    speeds, target = scenario.speeds, scenario.target
    rows = [("speed", f"{speeds[0] * RPM:.0f} to {speeds[-1] * RPM:.0f} rpm, {len(speeds)} values")]
    if isinstance(target, EccentricityTarget):
        rows.append(("eccentricity ratio (given)", number(target.eccentricity_ratio)))
    else:
        rows.append(("static load (given)", f"{number(target.load / 1e3)} kN"))
        unit = target.load / (scenario.bearing.length * scenario.bearing.diameter)
        rows.append(("specific load W/(L D)", f"{number(unit / 1e6, 3)} MPa"))
    if scenario.load_direction:
        rows.append(("load direction", _degrees(scenario.load_direction)))
    rows += list(_rotor(scenario))
    return rows


def _rotor(scenario: Scenario) -> Iterator[tuple[str, str]]:
    rotor = scenario.rotor
    if rotor is None:
        return
    flexible = rotor.kind == "jeffcott"
    yield "rotor", "flexible (Jeffcott)" if flexible else "rigid"
    yield "rotor mass per bearing", f"{number(rotor.total_mass)} kg"
    yield "unbalance per bearing", f"{number(float(abs(rotor.unbalance).sum()) * 1e6)} g mm"
    if flexible:
        stiffness = rotor.parameters["shaft_stiffness"]
        yield "shaft stiffness per bearing", f"{number(stiffness / 1e6)} MN/m"
