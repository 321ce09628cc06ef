"""Checks of a scenario's entries together, and what they say by being left out.

Every function raises `InputError` with the key; `scenario` adds the file and the value found.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import InputError
from ...model import (
    Bearing,
    BushModel,
    InletModel,
    Lubricant,
    MeshSize,
    ThermalModel,
    ThermalSettings,
)
from ...model.bearing import FULL_TURN
from ...model.orbit import OrbitForce, OrbitKind, OrbitSettings, SpeedRamp
from ...model.pad_bearing import CARRY_OVER, farthest
from ...model.tolerances import NORMAL_REACH, Distribution
from ...rotor import Rotor

if TYPE_CHECKING:
    from .scenario import Scenario


_Tables = Mapping[str, Any]
_SENSIBLE_VISCOSITY = (1e-7, 1e5)
"""Of the oil at the temperatures given [Pa s]."""
_DEFAULT_REVOLUTIONS = 60
_RPM = 30.0 / math.pi


def settled(scenario: Scenario, tables: _Tables) -> Scenario:
    """Return the scenario with what its entries leave open, or refuse what does not go together.

    tables : As the file has them: which entries are written.
    """
    scenario = _settled_pads(scenario, tables)
    _check_bearings(scenario)
    thermal = _settled_thermal(scenario, tables)
    if scenario.tolerances is not None:
        _check_tolerances(scenario)
    orbit = scenario.orbit
    if orbit is not None:
        orbit = _settled_orbit(orbit, scenario, tables["orbit"])
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


def _check_bearings(scenario: Scenario) -> None:
    """Check the bearing with each of its clearances."""
    clearances, eccentricity = scenario.radial_clearances, scenario.operating.eccentricity_ratio
    for index, clearance in enumerate(clearances):
        key = f"bearing.radial_clearance[{index}]"
        if any(math.isclose(clearance, other) for other in clearances[:index]):
            raise InputError("must hold each clearance once; remove the repeated one", key=key)
        try:
            bearing = replace(scenario.bearing, radial_clearance=clearance)
        except InputError as error:
            of_clearance = error.key == "bearing.radial_clearance"
            raise InputError(error.message, key=key if of_clearance else error.key) from None
        if bearing.roughness >= clearance:
            raise InputError("must be below the radial clearance", key="bearing.roughness")
        if bearing.pads:
            _check_pads(bearing, eccentricity)
            continue
        _check_below_one(eccentricity)
        _check_tilt(bearing, eccentricity)
    if scenario.bearing.pads:
        return
    _check_grooves(scenario.bearing, scenario.film.mesh)
    _check_arcs(scenario.bearing)
    _check_eccentricity(scenario.bearing, eccentricity)


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
    low, high = _SENSIBLE_VISCOSITY
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
    chosen = settings.radial_clearance
    if chosen is not None and not any(math.isclose(chosen, c) for c in scenario.radial_clearances):
        allowed = ", ".join(f'"{c * 1e6:g} um"' for c in scenario.radial_clearances)
        raise InputError(
            f"must be one of bearing.radial_clearance ({allowed})", key="transient.radial_clearance"
        )
    for number, event in enumerate(settings.events):
        if event.load is not None and scenario.operating.load is None:
            raise InputError(
                "goes with operating.load; with an eccentricity ratio the load is a result",
                key=f"transient.event[{number}].load",
            )
        if event.supply_temperature is not None:
            key = f"transient.event[{number}].supply_temperature"
            _check_viscosity(scenario.lubricant, event.supply_temperature, key)


def _settled_orbit(orbit: OrbitSettings, scenario: Scenario, given: _Tables) -> OrbitSettings:
    """Return the orbit with the clearance, duration, kind and actuator that are left out."""
    rotor = scenario.rotor
    if rotor is None:
        raise InputError('is missing: an orbit needs a rotor; add mass = "1200 kg"', key="rotor")
    if orbit.force is OrbitForce.LINEAR:
        _check_tabulated(orbit, scenario.operating.speeds)
    orbit = replace(
        orbit,
        radial_clearance=_orbit_clearance(orbit, scenario.radial_clearances),
        unbalance=orbit.unbalance
        if "unbalance" in given
        else not ("kind" in given and orbit.kind is OrbitKind.FREE_DECAY),
    )
    _check_start(orbit, scenario.operating.eccentricity_ratio)
    if not orbit.is_ramped and orbit.revolutions is None:
        orbit = replace(orbit, revolutions=_DEFAULT_REVOLUTIONS)
    _check_nodes(orbit, rotor)
    kinds = orbit.kinds(float(np.abs(rotor.unbalance).max()))
    if "kind" not in given:
        orbit = replace(orbit, kind=kinds[0])
    else:
        _check_kind(orbit, kinds)
    if orbit.actuator is not None:
        if orbit.actuator.on:
            _check_actuator(orbit, scenario)
        else:
            orbit = replace(orbit, actuator=None)
    return orbit


def _check_tabulated(orbit: OrbitSettings, tabulated: tuple[float, ...]) -> None:
    ends = {"orbit.speed": orbit.speed}
    if isinstance(orbit.speed, SpeedRamp):
        ends = {"orbit.speed.start": orbit.speed.start, "orbit.speed.stop": orbit.speed.stop}
    low, high = tabulated[0], tabulated[-1]
    for key, value in ends.items():
        assert isinstance(value, float)
        if not low <= value <= high:
            raise InputError(
                "must lie within operating.speed, where the coefficients are tabulated "
                f"({low * _RPM:.6g} to {high * _RPM:.6g} rpm)",
                key=key,
            )


def _orbit_clearance(orbit: OrbitSettings, choices: tuple[float, ...]) -> float:
    if math.isnan(orbit.radial_clearance):
        return choices[0]
    for choice in choices:
        if math.isclose(choice, orbit.radial_clearance):
            return choice
    allowed = ", ".join(f'"{choice * 1e6:g} um"' for choice in choices)
    raise InputError(
        f"must be one of bearing.radial_clearance ({allowed})", key="orbit.radial_clearance"
    )


def _check_start(orbit: OrbitSettings, eccentricity_ratio: float | None) -> None:
    """Refuse a start outside the clearance, wherever the equilibrium may be."""
    farthest = orbit.radial_clearance * (
        1.0 + (1.0 if eccentricity_ratio is None else eccentricity_ratio)
    )
    if math.hypot(*orbit.initial_displacement) >= farthest:
        raise InputError(
            "starts outside the clearance: from the equilibrium it must be less than "
            f"{farthest * 1e6:.4g} µm",
            key="orbit.initial_displacement",
        )


def _check_nodes(orbit: OrbitSettings, rotor: Rotor) -> None:
    for name, load in (("step", orbit.step), ("harmonic", orbit.harmonic)):
        if load is not None and load.node >= len(rotor.nodes):
            raise InputError(
                'only a rotor of kind = "jeffcott" has a disc apart from its journal',
                key=f"orbit.{name}.on",
            )


_NEEDS = {
    OrbitKind.UNBALANCE: 'needs an unbalance; add unbalance = "500 g*mm" to [rotor], and leave '
    "unbalance = false out of [orbit]",
    OrbitKind.STEP: 'needs a step; add step = { force = ["500 N", "0 N"], start = "0.1 s" }',
    OrbitKind.HARMONIC: "needs a harmonic force; add "
    'harmonic = { force = ["500 N", "0 N"], frequency = "50 Hz" }',
    OrbitKind.RUN_UP: "needs a rising speed such as "
    'speed = { start = "3000 rpm", stop = "15000 rpm", duration = "2 s" }',
    OrbitKind.COAST_DOWN: "needs a falling speed such as "
    'speed = { start = "15000 rpm", stop = "3000 rpm", duration = "2 s" }',
    OrbitKind.BASE_MOTION: "needs a motion of the base; add "
    'base_motion = { displacement = ["10 um", "0 um"], frequency = "50 Hz" }, or a base_shock',
}


def _check_kind(orbit: OrbitSettings, kinds: list[OrbitKind]) -> None:
    """Refuse a kind that lacks what it needs."""
    if orbit.kind is not OrbitKind.FREE_DECAY:
        if orbit.kind not in kinds:
            raise InputError(_NEEDS[orbit.kind], key="orbit.kind")
        return
    if not any((*orbit.initial_displacement, *orbit.initial_velocity)):
        raise InputError(
            "would stay at rest; write for example "
            'initial_displacement = ["1 um", "0 um"], which kind = "free_decay" needs',
            key="orbit.initial_displacement",
        )
    if kinds[0] in (OrbitKind.RUN_UP, OrbitKind.COAST_DOWN):
        raise InputError("needs one speed, not a ramp", key="orbit.kind")


def _check_actuator(orbit: OrbitSettings, scenario: Scenario) -> None:
    """Refuse what the feedback, designed about one equilibrium at one speed, does not fit."""
    rotor_kind = "" if scenario.rotor is None else scenario.rotor.kind
    for fits, message in (
        (
            not orbit.is_ramped,
            'needs one speed, not a ramp; write for example speed = "15000 rpm" in [orbit]',
        ),
        (rotor_kind == "rigid", 'needs a rotor of kind = "rigid"'),
        (
            orbit.static_load,
            "needs the static load, about whose equilibrium it acts; remove static_load",
        ),
    ):
        if not fits:
            raise InputError(message, key="orbit.actuator")


_TOLERANCE = 1e-9
"""Angle below which two edges are taken for one [rad]."""
_LEAST_CELLS = 2
"""Cells that a groove, or the land between two, must at least have."""


def _check_grooves(bearing: Bearing, mesh: MeshSize) -> None:
    """Check that grooves are apart, with film between them, and have cells enough."""
    cell = FULL_TURN / mesh.circumferential
    covered = sum(groove.extent for groove in bearing.grooves)
    if covered >= FULL_TURN - _LEAST_CELLS * cell:
        raise InputError(
            f"leave no film: together they cover {math.degrees(covered):.4g} deg of 360 deg; "
            "make them smaller or fewer",
            key="bearing.groove",
        )
    for index, groove in enumerate(bearing.grooves):
        key = f"bearing.groove[{index}]"
        _check_cells(groove.extent, mesh, f"{key}.extent", "groove")
        least = _LEAST_CELLS * bearing.length / mesh.axial
        if groove.length is not None and groove.length < least * (1.0 - _TOLERANCE):
            needed = 2 * math.ceil(_LEAST_CELLS * bearing.length / groove.length / 2.0)
            raise InputError(
                f"the mesh is too coarse for this groove: film.mesh.axial must be {needed} or "
                f"more, or the groove at least {least * 1e3:.4g} mm long",
                key=f"{key}.length",
            )
    order = sorted(range(len(bearing.grooves)), key=lambda i: bearing.grooves[i].center % FULL_TURN)
    for here, there in pairwise([*order, order[0]] if len(order) > 1 else []):
        _check_land(bearing, here, there, mesh)


def _check_land(bearing: Bearing, here: int, there: int, mesh: MeshSize) -> None:
    first, second = bearing.grooves[here], bearing.grooves[there]
    ahead = (second.center - first.center) % FULL_TURN
    land = ahead - 0.5 * (first.extent + second.extent)
    key = f"bearing.groove[{max(here, there)}].center"
    if land < -_TOLERANCE:
        raise InputError(
            f"overlaps bearing.groove[{min(here, there)}] by {-math.degrees(land):.4g} deg; "
            "move them apart or make them smaller",
            key=key,
        )
    _check_cells(land, mesh, key, f"land next to bearing.groove[{min(here, there)}]")


def _check_cells(extent: float, mesh: MeshSize, key: str, name: str) -> None:
    cells = extent * mesh.circumferential / FULL_TURN
    if cells < _LEAST_CELLS - _TOLERANCE:
        needed = math.ceil(_LEAST_CELLS * FULL_TURN / extent) if extent > _TOLERANCE else 0
        cure = f"film.mesh.circumferential must be {needed} or more" if 0 < needed <= 4096 else ""
        raise InputError(
            f"the mesh is too coarse for this {name} ({math.degrees(extent):.4g} deg, "
            f"{cells:.2g} cells; at least {_LEAST_CELLS} are needed)"
            + (f": {cure}" if cure else ": make it larger"),
            key=key,
        )


def _check_arcs(bearing: Bearing) -> None:
    """Check that arcs do not overlap, with nothing but a groove between two of them."""
    if not bearing.arcs:
        return
    order = sorted(range(len(bearing.arcs)), key=lambda i: bearing.arcs[i].start % FULL_TURN)
    for here, there in pairwise([*order, order[0]]):
        first, second = bearing.arcs[here], bearing.arcs[there]
        to_next = (second.start - first.start) % FULL_TURN
        if to_next < _TOLERANCE or to_next > FULL_TURN - _TOLERANCE:
            to_next = FULL_TURN if here == there else 0.0
        gap = to_next - (first.end - first.start)
        key = f"bearing.arc[{here}].end"
        if gap < -_TOLERANCE:
            raise InputError(
                f"overlaps bearing.arc[{there}] by {-math.degrees(gap):.4g} deg; end the one "
                "where the other starts",
                key=key,
            )
        if gap > _TOLERANCE and not _in_groove(bearing, first.end, gap):
            raise InputError(
                f"the bore is open for {math.degrees(gap):.4g} deg after this arc; let the next "
                "arc start here, or put a groove over the opening",
                key=key,
            )


def _in_groove(bearing: Bearing, start: float, extent: float) -> bool:
    """Return whether one full-length groove covers the opening."""
    for groove in bearing.grooves:
        if not bearing.spans_length(groove):
            continue
        from_edge = (start - (groove.center - 0.5 * groove.extent) + _TOLERANCE) % FULL_TURN
        if from_edge + extent <= groove.extent + 2.0 * _TOLERANCE:
            return True
    return False


def _check_tilt(bearing: Bearing, eccentricity_ratio: float | None) -> None:
    """Refuse a misalignment with which the journal touches the bore at one end for certain."""
    at_end = math.hypot(*bearing.misalignment) * 0.5 * bearing.length / bearing.radial_clearance
    if math.hypot(at_end, eccentricity_ratio or 0.0) >= 1.0:
        raise InputError(
            "the tilted journal touches the bore at the bearing's end: the tilt must stay below "
            f"{2e3 * bearing.radial_clearance / bearing.length:.4g} mrad, less what the "
            "eccentricity takes",
            key="bearing.tilt",
        )


def _reach(bearing: Bearing) -> float:
    """Return the largest eccentricity ratio within the lobes (1 for a plain bore)."""
    theta = np.linspace(0.0, FULL_TURN, 720, endpoint=False)
    bore = np.ones_like(theta)
    for arc in bearing.arcs:
        inside = (theta - arc.start) % FULL_TURN < arc.end - arc.start
        bore = np.where(inside, 1.0 - arc.preload * np.cos(theta - arc.preload_angle), bore)
    towards = np.cos(theta[:, None] - theta)  # direction of the journal, angle around the bore
    room = np.where(towards > 0.0, bore / np.where(towards > 0.0, towards, 1.0), np.inf)
    return float(room.min(axis=1).max())


def _check_below_one(eccentricity_ratio: float | None) -> None:
    """Refuse an eccentricity ratio of 1 and above, where a journal touches any bore."""
    if eccentricity_ratio is not None and not eccentricity_ratio < 1.0:
        raise InputError(
            "must be below 1 (it lies between 0 and 1, for example 0.5)",
            key="operating.eccentricity_ratio",
        )


def _check_pads(bearing: Bearing, eccentricity_ratio: float | None) -> None:
    """Refuse an eccentricity ratio at which the journal touches a pad wherever it stands."""
    if eccentricity_ratio is None:
        return
    limit = farthest(bearing) / bearing.radial_clearance
    if eccentricity_ratio >= limit:
        raise InputError(
            "the journal touches a pad in every direction: with these pads it must be below "
            f"{limit:.4g} (it counts in machined clearances)",
            key="operating.eccentricity_ratio",
        )


def _check_eccentricity(bearing: Bearing, eccentricity_ratio: float | None) -> None:
    """Refuse an eccentricity ratio at which the journal touches a lobe wherever it stands."""
    if eccentricity_ratio is None or all(arc.preload == 0.0 for arc in bearing.arcs):
        return
    limit = _reach(bearing)
    if eccentricity_ratio >= limit:
        raise InputError(
            "the journal touches a lobe in every direction: with these lobes it must be below "
            f"{limit:.4g} (it counts in lobe clearances)",
            key="operating.eccentricity_ratio",
        )
