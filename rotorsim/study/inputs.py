"""Inputs of a calculation, with units, for `rotorsim check` and the report."""

from __future__ import annotations

import dataclasses
import math
import tomllib
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from ..bearing.drawing import STANDARD_GRAVITY
from ..errors import RotorsimError
from ..model import BushModel, EccentricityTarget, LoadTarget, ShaftModel, ThermalModel
from ..model.restrictors import Capillary, Orifice, Pump
from ..rows import RPM, ZERO_CELSIUS, Row, number, with_unit

if TYPE_CHECKING:
    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario
    from ..model import Bearing, Groove, Pad


_Rows = list[Row]


def input_rows(scenario: Scenario) -> dict[str, _Rows]:
    """Return everything that the results rest on, defaults included, by topic."""
    return {
        "bearing": _bearing(scenario),
        "oil": _oil(scenario),
        "film": _film(scenario),
        "operation": _operation(scenario),
    }


def _supply(groove: Groove) -> str:
    """Return how a groove is fed."""
    pressure = with_unit(groove.supply_pressure / 1e3, "kPa")
    match groove.restrictor:
        case None:
            return pressure
        case Pump(rate):
            return f"pump of {with_unit(rate * 6e4, 'L/min')}"
        case Capillary(diameter, length):
            size = f"{_millimetres(diameter)} x {_millimetres(length)}"
            return f"{pressure} before a capillary {size}"
        case Orifice(diameter):
            return f"{pressure} before an orifice {_millimetres(diameter)}"
        case other:
            return f"{pressure} before a {other.kind}"


def _millimetres(value: float) -> str:
    return with_unit(value * 1e3, "mm")


def _micrometres(value: float) -> str:
    return with_unit(value * 1e6, "µm")


def _celsius(value: float) -> str:
    return with_unit(value - ZERO_CELSIUS, "°C")


def _degrees(value: float) -> str:
    return f"{number(math.degrees(value))}°"


def _bearing(scenario: Scenario) -> _Rows:
    bearing, clearances = scenario.bearing, scenario.radial_clearances
    rows = [
        Row("journal radius", _millimetres(bearing.journal_radius)),
        Row("length", _millimetres(bearing.length)),
        Row("length to diameter", number(bearing.length / bearing.diameter)),
        Row("radial clearance", ", ".join(map(_micrometres, clearances))),
        Row("diametral clearance", ", ".join(_millimetres(2.0 * c) for c in clearances)),
        Row("clearance over radius", ", ".join(_per_mille(bearing, scenario))),
    ]
    if bearing.bush_outer_radius is not None:
        rows.append(Row("bush outer radius", _millimetres(bearing.bush_outer_radius)))
    rows += [_pad(place, pad, bearing) for place, pad in enumerate(bearing.pads, start=1)]
    for place, groove in enumerate(() if bearing.pads else bearing.grooves, start=1):
        length = bearing.length if groove.length is None else groove.length
        rows.append(
            Row(
                f"groove {place}",
                f"at {_degrees(groove.center)}, {_degrees(groove.extent)} wide, "
                f"{_millimetres(length)} long, {_supply(groove)}",
            )
        )
    for place, arc in enumerate(bearing.arcs, start=1):
        rows.append(
            Row(
                f"lobe {place}",
                f"{_degrees(arc.start)} to {_degrees(arc.end)}, preload {number(arc.preload)}, "
                f"offset {number(arc.offset)}",
            )
        )
    for place, pocket in enumerate(bearing.pockets, start=1):
        low, high = pocket.reach(bearing.length)
        last = pocket.depth if pocket.depth_at_end is None else pocket.depth_at_end
        deep = dict.fromkeys((_micrometres(pocket.depth), _micrometres(last)))
        rows.append(
            Row(
                f"pocket {place}",
                f"{_degrees(pocket.start)} to {_degrees(pocket.end)}, {_millimetres(high - low)} "
                f"long, {' to '.join(deep)} deep",
            )
        )
    for place, texture in enumerate(bearing.textures, start=1):
        rows.append(
            Row(
                f"texture {place}",
                f"{_degrees(texture.start)} to {_degrees(texture.end)}, {texture.around} x "
                f"{texture.along} dimples, {_micrometres(texture.depth)} deep, on "
                f"{number(100.0 * texture.area_share)} % of the area",
            )
        )
    if bearing.compliance is not None:
        given = bearing.compliance
        rows.append(
            Row(
                "bore gives way",
                f"{given.kind}, {_millimetres(given.thickness)} thick, "
                f"{with_unit(given.youngs_modulus / 1e9, 'GPa')}",
            )
        )
    if not bearing.grooves and not bearing.arcs:
        rows.append(Row("bore", "plain, 360°"))
    if any(bearing.misalignment):
        rows.append(
            Row("tilt", ", ".join(f"{number(angle * 1e3)} mrad" for angle in bearing.misalignment))
        )
    if bearing.roughness:
        rows.append(Row("roughness", _micrometres(bearing.roughness)))
    return rows


def _pad(place: int, pad: Pad, bearing: Bearing) -> Row:
    return Row(
        f"pad {place}",
        f"pivot at {_degrees(pad.pivot_angle)} ({pad.pivot.kind}), {_degrees(pad.arc)} long, "
        f"offset {number(pad.offset)}, preload {number(bearing.preload_of(pad))}, "
        f"{_millimetres(pad.thickness)} thick",
    )


def _per_mille(bearing: Bearing, scenario: Scenario) -> list[str]:
    ratios = [c / bearing.journal_radius for c in scenario.radial_clearances]
    return [f"{number(1e3 * ratio)} ‰" for ratio in ratios]


def _oil(scenario: Scenario) -> _Rows:
    oil, supply = scenario.lubricant, scenario.thermal.supply_temperature
    temperatures = sorted({supply, 40.0 + ZERO_CELSIUS, 100.0 + ZERO_CELSIUS})
    low, high = oil.temperature_range
    rows = [
        Row(f"viscosity at {_celsius(t)}", with_unit(float(oil.viscosity(t)) * 1e3, "mPa s"))
        for t in temperatures
        if low <= t <= high
    ]
    return [
        *_grade(scenario),
        *rows,
        Row("density", with_unit(oil.density, "kg/m³")),
        Row("specific heat", with_unit(oil.specific_heat, "J/(kg K)")),
        Row("thermal conductivity", with_unit(oil.thermal_conductivity, "W/(m K)")),
    ]


def _grade(scenario: Scenario) -> _Rows:
    """Return the ISO VG grade of the scenario's text; the law that follows keeps none."""
    given = tomllib.loads(scenario.text).get("lubricant", {})
    if "iso_vg" not in given:
        return []
    index = given.get("viscosity_index")
    more = "" if index is None else f", viscosity index {number(index)}"
    return [Row("oil", f"ISO VG {number(given['iso_vg'])}{more}")]


def _film(scenario: Scenario) -> _Rows:
    film, thermal = scenario.film, scenario.thermal
    mesh = film.mesh
    rows = [
        Row("cavitation", film.cavitation.value.replace("_", " ")),
        Row("start of the film", film.inception.value.replace("_", " ")),
        Row(
            "cells around, along, across",
            f"{mesh.circumferential} × {mesh.axial} × {mesh.cross_film}",
        ),
        Row("thermal models", ", ".join(model.value for model in scenario.thermal_models)),
        Row("supply temperature", _celsius(thermal.supply_temperature)),
    ]
    if ThermalModel.THD not in scenario.thermal_models:
        return rows
    rows += [
        Row("ambient temperature", _celsius(thermal.ambient_temperature)),
        Row("oil at the inlet", thermal.inlet.value),
        Row("shaft", thermal.shaft.value.replace("_", " ")),
        Row("bush", thermal.bush.value),
        Row("friction of the ruptured film", film.ruptured_friction.value),
    ]
    if thermal.shaft_temperature is not None and thermal.shaft is not ShaftModel.AMBIENT:
        rows.append(Row("shaft temperature", _celsius(thermal.shaft_temperature)))
    growth = thermal.expansion
    if growth is not None:
        stiffness = getattr(growth.bush_fit, "stiffness", None)
        held = str(growth.bush_fit).replace("_", " ")
        if stiffness is not None:
            held = f"housing of {with_unit(stiffness / 1e6, 'MN/m')}"
        rows += [
            Row("expansion of shaft, bush", f"{growth.shaft:.3g}, {growth.bush:.3g} 1/K"),
            Row("clearances measured at", _celsius(growth.reference_temperature)),
            Row("fit of the bush", held),
        ]
    if thermal.bush is BushModel.CONDUCTION:
        rows += [
            Row("bush conductivity", with_unit(thermal.bush_conductivity, "W/(m K)")),
            Row("bush heat transfer", with_unit(thermal.bush_heat_transfer, "W/(m² K)")),
        ]
    return rows


def _operation(scenario: Scenario) -> _Rows:
    speeds, target = scenario.speeds, scenario.target
    many = f"{speeds[0] * RPM:.0f} to {speeds[-1] * RPM:.0f} rpm, {len(speeds)} values"
    rows = [Row("speed", many if len(speeds) > 1 else f"{speeds[0] * RPM:.0f} rpm")]
    if isinstance(target, EccentricityTarget):
        rows.append(Row("eccentricity ratio (given)", number(target.eccentricity_ratio)))
    else:
        rows.append(Row("static load (given)", with_unit(target.load / 1e3, "kN")))
    if isinstance(target, LoadTarget) and target.load > 0.0:
        unit = target.load / (scenario.bearing.length * scenario.bearing.diameter)
        rows.append(Row("specific load W/(L D)", with_unit(unit / 1e6, "MPa", 3)))
    if scenario.load_direction:
        rows.append(Row("load direction", _degrees(scenario.load_direction)))
    rows += list(_rotor(scenario))
    if scenario.rotor is not None and isinstance(target, LoadTarget) and target.load > 0.0:
        weight = scenario.rotor.total_mass * STANDARD_GRAVITY / target.load
        rows.append(Row("rotor's weight over load", number(weight, 3)))
    return rows


def _rotor(scenario: Scenario) -> Iterator[Row]:
    rotor = scenario.rotor
    if rotor is None:
        return
    flexible = rotor.kind == "jeffcott"
    yield Row("rotor", "flexible (Jeffcott)" if flexible else "rigid")
    yield Row("rotor mass per bearing", with_unit(rotor.total_mass, "kg"))
    yield Row("unbalance per bearing", with_unit(float(abs(rotor.unbalance).sum()) * 1e6, "g mm"))
    if flexible:
        stiffness = rotor.parameters["shaft_stiffness"]
        yield Row("shaft stiffness per bearing", with_unit(stiffness / 1e6, "MN/m"))


_ACCURACY_OR_CHOICE = {
    "bearing": {"radial_clearance", "roughness"},
    "film": {"mesh"},
    "thermal": {"model"},
}
"""Entries that may differ: accuracy, limits, and what the table itself is asked for."""


def differences(scenario: Scenario, table: CoefficientTable) -> list[str]:
    """Name what differs between a scenario and the one that a table was computed from.

    Empty where nothing that matters does, or where the table does not say (one that came from
    another program).
    """
    facts = table.dataset.attrs
    text = facts.get("scenario")
    if not isinstance(text, str) or facts.get("scenario_sha256") == scenario.sha256:
        return []
    try:
        other = type(scenario).from_text(text)
    except RotorsimError:  # written by a version that knew other keys
        return []
    found = []
    for part in ("bearing", "film", "thermal"):
        skipped = _ACCURACY_OR_CHOICE[part]
        found += [
            f"{part}.{name}"
            for name in _changed(getattr(scenario, part), getattr(other, part))
            if name not in skipped
        ]
    if scenario.lubricant != other.lubricant:
        found.append("lubricant")
    if scenario.target != other.target:
        found.append("operating: load or eccentricity ratio")
    if scenario.load_direction != other.load_direction:
        found.append("operating.load_direction")
    return found


def _changed(one: Any, other: Any) -> list[str]:
    fields = [field.name for field in dataclasses.fields(one)]
    return [name for name in fields if getattr(one, name) != getattr(other, name)]
