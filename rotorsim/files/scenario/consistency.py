"""Checks of a scenario's entries together, and what they say by being left out.

Every function raises `InputError` with the key; `scenario` adds the file and the value found.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import InputError
from ...model import BushModel, InletModel, Lubricant, ThermalModel, ThermalSettings
from ...model.lubricant import SENSIBLE_VISCOSITY
from ...model.pad_bearing import CARRY_OVER
from ...model.tolerances import NORMAL_REACH, Distribution
from .bearing_consistency import check_bearings, listed_clearance
from .orbit_consistency import settled_orbit

if TYPE_CHECKING:
    from .scenario import Scenario


_Tables = Mapping[str, Any]


def settled(scenario: Scenario, tables: _Tables) -> Scenario:
    """Return the scenario with what its entries leave open, or refuse what does not go together.

    tables : As the file has them: which entries are written.
    """
    scenario = _settled_pads(scenario, tables)
    check_bearings(scenario)
    thermal = _settled_thermal(scenario, tables)
    if scenario.tolerances is not None:
        _check_tolerances(scenario)
    orbit = scenario.orbit
    if orbit is not None:
        orbit = settled_orbit(orbit, scenario, tables["orbit"])
    if scenario.transient is not None:
        _check_transient(scenario)
    settled_scenario = replace(scenario, thermal=thermal, orbit=orbit)
    for _ in settled_scenario.cases():  # each checks itself
        pass
    return settled_scenario


def _settled_pads(scenario: Scenario, tables: _Tables) -> Scenario:
    """Turn pads that stand by the load to it; say how much hot oil their feed carries over."""
    bearing, thermal = scenario.bearing, scenario.thermal
    if not bearing.pads:
        return scenario
    table, heat = tables["bearing"], tables.get("thermal", {})
    if stand_by_load(table):
        bearing = bearing.turned(scenario.load_direction)
    if "inlet" not in heat:
        thermal = replace(thermal, inlet=InletModel.MIXING)
    if "hot_oil_carry_over" not in heat and thermal.inlet is InletModel.MIXING:
        kept = 1.0 if bearing.supply_flow is not None else CARRY_OVER[bearing.feed]
        thermal = replace(thermal, hot_oil_carry_over=kept)
    return replace(scenario, bearing=bearing, thermal=thermal)


def stand_by_load(table: Mapping[str, Any]) -> bool:
    """Return whether the pads of a table ``[bearing]`` stand by the load: no pivot has an angle."""
    pads = [table.get("pads", {}), *table.get("pad", [])]
    return not any("pivot_angle" in pad for pad in pads)


def _settled_thermal(scenario: Scenario, tables: _Tables) -> ThermalSettings:
    """Return the thermal settings with the temperatures that are left out."""
    given, oil, thermal = tables.get("thermal", {}), scenario.lubricant, scenario.thermal
    if len(set(scenario.thermal_models)) != len(scenario.thermal_models):
        raise InputError("must hold each model once", key="thermal.models")
    heated = ThermalModel.THD in scenario.thermal_models
    if heated:
        for name, example in _HEATED_OIL.items():
            _need(tables["lubricant"], "lubricant", name, example, "a thd model needs it")
        if "viscosity" in tables["lubricant"]:
            _need(
                tables["lubricant"], "lubricant", "viscosity_temperature_coefficient",
                "0.034 / delta_degC", "a thd model needs it (or give iso_vg)",
            )  # fmt: skip
        _need(given, "thermal", "ambient_temperature", "40 degC", "a thd model needs it")
    supply, ambient = (given.get(f"{name}_temperature") for name in ("supply", "ambient"))
    if supply is None and ambient is None:
        if oil.varies_with_temperature:
            reason = "this oil's viscosity needs it"
            _need(given, "thermal", "ambient_temperature", "40 degC", reason)
    elif supply is None:
        thermal = replace(thermal, supply_temperature=thermal.ambient_temperature)
    elif ambient is None:
        thermal = replace(thermal, ambient_temperature=thermal.supply_temperature)
    if heated and thermal.bush is BushModel.CONDUCTION:
        for table, name, example in _CONDUCTION[1 if scenario.bearing.pads else 0 :]:
            reason = 'thermal.bush = "conduction" needs it'
            _need(tables.get(table, {}), table, name, example, reason)
    _check_viscosities(scenario, thermal, ambient is not None)
    return thermal


_HEATED_OIL = {
    "density": "860 kg/m^3",
    "specific_heat": "2000 J/(kg*delta_degC)",
    "thermal_conductivity": "0.13 W/(m*delta_degC)",
}
_CONDUCTION = (
    ("bearing", "bush_outer_radius", "75 mm"),
    ("thermal", "bush_conductivity", "50 W/(m*delta_degC)"),
    ("thermal", "bush_heat_transfer", "80 W/(m^2*delta_degC)"),
)


def _need(given: _Tables, table: str, name: str, example: str, reason: str) -> None:
    if name not in given:
        raise InputError(
            f'is missing: {reason}; write for example {name} = "{example}"', key=f"{table}.{name}"
        )


def _check_viscosities(scenario: Scenario, thermal: ThermalSettings, has_ambient: bool) -> None:
    """Refuse temperatures of walls and supplied oil at which the oil's law means nothing."""
    found = {"thermal.ambient_temperature": thermal.ambient_temperature} if has_ambient else {}
    found["thermal.supply_temperature"] = thermal.supply_temperature
    if thermal.shaft_temperature is not None:
        found["thermal.shaft"] = thermal.shaft_temperature
    for index, groove in enumerate(scenario.bearing.grooves):
        if groove.supply_temperature is not None:
            found[f"bearing.groove[{index}].supply_temperature"] = groove.supply_temperature
    for key, temperature in found.items():
        _check_viscosity(scenario.lubricant, temperature, key)


def _check_viscosity(oil: Lubricant, temperature: float, key: str) -> None:
    low, high = SENSIBLE_VISCOSITY
    with np.errstate(all="ignore"):
        viscosity = float(oil.viscosity(temperature))
    if not low <= viscosity <= high:
        raise InputError(
            f"gives the oil a viscosity of {viscosity:.3g} Pa*s at {temperature:.6g} K, beyond "
            f"sense ({low:g} to {high:g} Pa*s): check this temperature and [lubricant]",
            key=key,
        )


def _check_tolerances(scenario: Scenario) -> None:
    """Refuse spreads that leave nothing of the value they are about, or less."""
    settings, load = scenario.tolerances, scenario.operating.load
    assert settings is not None
    if settings.load is not None and load is None:
        raise InputError(
            "goes with operating.load; with an eccentricity ratio the load is a result",
            key="tolerances.load",
        )
    about = {
        "radial_clearance": ("bearing", min(scenario.radial_clearances), 1e6, "um"),
        "load": ("operating", load or math.inf, 1e-3, "kN"),
    }
    for name, spread in settings.spreads.items():
        normal = (spread.distribution or settings.distribution) is Distribution.NORMAL
        table, nominal, factor, unit = about.get(name, ("", math.inf, 1.0, ""))
        if spread.relative:  # of whatever it is a share
            nominal, factor, unit = 1.0, 100.0, "%"
        limit = nominal / (NORMAL_REACH if normal else 1.0)
        if spread.value < limit:
            continue
        of = "" if spread.relative else f" {table}.{name}, {nominal * factor:.6g} {unit}"
        raise InputError(
            f"must be below {limit * factor:.6g} {unit}: a normal distribution reaches four "
            f"standard deviations, and something must be left of{of or ' the value'}"
            if normal
            else f"must be below{of}: something must be left of it",
            key=f"tolerances.{name}",
        )


def _check_transient(scenario: Scenario) -> None:
    """Refuse a transient without heat, without a load to change, or of another clearance."""
    settings = scenario.transient
    assert settings is not None
    if ThermalModel.THD not in scenario.thermal_models:
        raise InputError('a [transient] needs "thd" among them', key="thermal.models")
    listed_clearance(settings.radial_clearance, scenario, "transient.radial_clearance")
    for number, event in enumerate(settings.events):
        if event.load is not None and scenario.operating.load is None:
            raise InputError(
                "goes with operating.load; with an eccentricity ratio the load is a result",
                key=f"transient.event[{number}].load",
            )
        if event.supply_temperature is not None:
            key = f"transient.event[{number}].supply_temperature"
            _check_viscosity(scenario.lubricant, event.supply_temperature, key)
