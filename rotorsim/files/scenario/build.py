"""From checked tables to the frozen model objects; what entries say together is checked here.

Every function raises `InputError` with the key; `scenario` adds the file and the value found.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...model import (
    Bearing,
    BushModel,
    EccentricityTarget,
    FilmSettings,
    LoadTarget,
    Lubricant,
    MeshSize,
    ShaftModel,
    Target,
    ThermalModel,
    ThermalSettings,
)
from ...rotor import Rotor
from .geometry import (
    bearing_arcs,
    bearing_grooves,
    check_arcs,
    check_eccentricity,
    check_grooves,
    check_tilt,
)
from .oil import varies_with_temperature
from .schema import (
    BearingTable,
    FilmTable,
    MassRangeTable,
    OperatingTable,
    ScenarioTables,
    SpeedRangeTable,
    ThermalTable,
)
from .settings import RotorKind, StabilitySettings
from .tolerances import KINDS, NORMAL_REACH, Distribution, Spread, ToleranceSettings

SENSIBLE_VISCOSITY = (1e-7, 1e5)
"""Of the oil at the temperatures given [Pa s]."""
_ROTOR_KEYS = {
    RotorKind.RIGID: {"mass": "1200 kg"},
    RotorKind.JEFFCOTT: {
        "disc_mass": "600 kg",
        "journal_mass": "60 kg",
        "shaft_stiffness": "100 MN/m",
    },
}
_OPTIONAL_ROTOR_KEYS = {RotorKind.RIGID: (), RotorKind.JEFFCOTT: ("disc_damping",)}
MAX_CELLS = 20_000_000
"""Cells of the largest film or bush that is accepted."""


def title(text: str) -> str:
    """Title, which must be one line of text."""
    if not text.isprintable():
        raise InputError(
            "must be one line of text without control characters such as tabs, line ends or "
            "escapes",
            key="title",
        )
    return text


def film_settings(table: FilmTable) -> FilmSettings:
    """Film model and mesh."""
    mesh = MeshSize(**table.mesh.model_dump(exclude_none=True))
    if mesh.circumferential * mesh.axial * max(mesh.cross_film, mesh.bush_radial) > MAX_CELLS:
        raise InputError(
            f"has more than {MAX_CELLS} cells; the default is 156 x 48 x 24 x 24",
            key="film.mesh",
        )
    return FilmSettings(
        table.cavitation,
        table.inception,
        mesh,
        table.ruptured_friction,
        table.viscosity_response,
        tuple(table.frequency_ratio),
        table.rotations,
    )


def clearances(table: BearingTable) -> tuple[float, ...]:
    """Radial clearances [m], each once."""
    for index, value in enumerate(table.radial_clearance):
        if any(math.isclose(value, other) for other in table.radial_clearance[:index]):
            raise InputError(
                "must hold each clearance once; remove the repeated one",
                key=f"bearing.radial_clearance[{index}]",
            )
    return tuple(table.radial_clearance)


def bearings(
    table: BearingTable, mesh: MeshSize, eccentricity_ratio: float | None
) -> tuple[Bearing, ...]:
    """Bearing with each of its clearances, in the frame in which it is drawn."""
    arcs, grooves = bearing_arcs(table), bearing_grooves(table)
    made = []
    for index, clearance in enumerate(clearances(table)):
        try:
            bearing = Bearing(
                journal_radius=table.journal_radius,
                length=table.length,
                radial_clearance=clearance,
                grooves=grooves,
                arcs=arcs,
                bush_outer_radius=table.bush_outer_radius,
                tilt=(table.tilt[0], table.tilt[1]),
                roughness=table.roughness,
            )
        except InputError as error:
            of_clearance = error.key == "bearing.radial_clearance"
            key = f"{error.key}[{index}]" if of_clearance else error.key
            raise InputError(error.message, key=key) from None
        if bearing.roughness >= clearance:
            raise InputError("must be below the radial clearance", key="bearing.roughness")
        check_tilt(bearing, eccentricity_ratio)
        made.append(bearing)
    check_grooves(made[0], mesh)
    check_arcs(made[0])
    check_eccentricity(made[0], eccentricity_ratio)
    return tuple(made)


def thermal_settings(tables: ScenarioTables, oil: Lubricant) -> ThermalSettings:
    """Thermal boundary conditions, with the first of the models."""
    table = tables.thermal
    if len(set(table.models)) != len(table.models):
        raise InputError("must hold each model once", key="thermal.models")
    heated = ThermalModel.THD in table.models
    ambient, supply = _temperatures(table, oil, heated=heated)
    _check_viscosities(tables, oil, supply)
    if heated and table.bush is BushModel.CONDUCTION:
        _check_conduction(tables)
    given = {}
    for name in ("bush_conductivity", "bush_heat_transfer"):
        if getattr(table, name) is not None:
            given[name] = getattr(table, name)
    shaft, shaft_temperature = ShaftModel.GIVEN, None
    if isinstance(table.shaft, ShaftModel):
        shaft = table.shaft
    else:
        shaft_temperature = table.shaft
    return ThermalSettings(
        model=table.models[0],
        ambient_temperature=ambient,
        supply_temperature=supply,
        inlet=table.inlet,
        shaft=shaft,
        bush=table.bush,
        hot_oil_carry_over=table.hot_oil_carry_over,
        shaft_temperature=shaft_temperature,
        **given,
    )


def _check_viscosities(tables: ScenarioTables, oil: Lubricant, supply: float) -> None:
    """Refuse temperatures of walls and supplied oil at which the oil's law means nothing."""
    found = {"thermal.supply_temperature": supply}
    if tables.thermal.ambient_temperature is not None:
        found = {"thermal.ambient_temperature": tables.thermal.ambient_temperature} | found
    if not isinstance(tables.thermal.shaft, ShaftModel):
        found["thermal.shaft"] = tables.thermal.shaft
    for index, groove in enumerate(tables.bearing.groove):
        if groove.supply_temperature is not None:
            found[f"bearing.groove[{index}].supply_temperature"] = groove.supply_temperature
    low, high = SENSIBLE_VISCOSITY
    for key, temperature in found.items():
        with np.errstate(all="ignore"):
            viscosity = float(oil.viscosity(temperature))
        if not low <= viscosity <= high:
            raise InputError(
                f"gives the oil a viscosity of {viscosity:.3g} Pa*s at {temperature:.6g} K, beyond "
                f"sense ({low:g} to {high:g} Pa*s): check this temperature and [lubricant]",
                key=key,
            )


def _check_conduction(tables: ScenarioTables) -> None:
    reason = 'thermal.bush = "conduction"'
    if tables.bearing.bush_outer_radius is None:
        raise _missing("bearing.bush_outer_radius", "75 mm", reason)
    if tables.thermal.bush_conductivity is None:
        raise _missing("thermal.bush_conductivity", "50 W/(m*delta_degC)", reason)
    if tables.thermal.bush_heat_transfer is None:
        raise _missing("thermal.bush_heat_transfer", "80 W/(m^2*delta_degC)", reason)


def _temperatures(table: ThermalTable, oil: Lubricant, *, heated: bool) -> tuple[float, float]:
    """Ambient and supply temperature [K]."""
    ambient, supply = table.ambient_temperature, table.supply_temperature
    if ambient is None and heated:
        raise _missing("thermal.ambient_temperature", "40 degC", "a thd model")
    if ambient is None and supply is None:
        if varies_with_temperature(oil):
            raise _missing("thermal.ambient_temperature", "40 degC", "this oil's viscosity")
        supply = 313.15  # neither wall heat nor viscosity depends on it
    supply = ambient if supply is None else supply
    assert supply is not None
    return (supply if ambient is None else ambient), supply


def _missing(key: str, example: str, reason: str) -> InputError:
    name = key.rpartition(".")[2]
    return InputError(
        f'is missing: {reason} needs it; write for example {name} = "{example}"', key=key
    )


def target(table: OperatingTable) -> Target:
    """Eccentricity ratio or load; exactly one."""
    if table.eccentricity_ratio is not None and table.load is not None:
        raise InputError(
            "either eccentricity_ratio or load fixes the journal, not both; remove one",
            key="operating.load",
        )
    if table.eccentricity_ratio is not None:
        return EccentricityTarget(table.eccentricity_ratio)
    if table.load is not None:
        return LoadTarget(table.load)
    raise InputError(
        'needs eccentricity_ratio or load; write for example load = "10 kN"', key="operating"
    )


def speeds(table: OperatingTable) -> NDArray[np.float64]:
    """Speeds [rad/s], ascending, read-only."""
    values = ascending(table.speed, "operating.speed")
    values.setflags(write=False)
    return values


def ascending(
    entry: SpeedRangeTable | MassRangeTable | list[float], key: str
) -> NDArray[np.float64]:
    """Values of a range or a list, which must ascend."""
    if isinstance(entry, list):
        for index, (before, after) in enumerate(pairwise(entry), start=1):
            if after <= before:
                raise InputError(
                    "the list must ascend, each entry above the one before it; sort it and "
                    "remove repetitions",
                    key=f"{key}[{index}]",
                )
        return np.array(entry, dtype=float)
    if entry.count == 1 and entry.start != entry.stop:
        raise InputError(
            "one value cannot span from start to stop; write count = 2 or more, or a single value",
            key=f"{key}.count",
        )
    if entry.count > 1 and entry.stop <= entry.start:
        raise InputError("must be above start", key=f"{key}.stop")
    return np.linspace(entry.start, entry.stop, entry.count)


def rotor(tables: ScenarioTables) -> Rotor | None:
    """Rotor, by its kind; each kind has keys of its own."""
    table = tables.rotor
    if table is None:
        return None
    given = {
        name: value
        for name, value in table.model_dump(exclude={"kind", "unbalance"}).items()
        if value is not None
    }
    needed = _ROTOR_KEYS[table.kind]
    for name, example in needed.items():
        if name not in given:
            raise InputError(
                f'is missing; write for example {name} = "{example}"', key=f"rotor.{name}"
            )
    for name in given:
        if name not in needed and name not in _OPTIONAL_ROTOR_KEYS[table.kind]:
            raise InputError(
                f'does not go with kind = "{table.kind.value}" (its keys: {", ".join(needed)})',
                key=f"rotor.{name}",
            )
    made = Rotor.jeffcott if table.kind is RotorKind.JEFFCOTT else Rotor.rigid
    return made(**given, unbalance=table.unbalance)


def stability_settings(tables: ScenarioTables) -> StabilitySettings | None:
    """Axes of the stability map."""
    if tables.stability is None:
        return None
    return StabilitySettings(tuple(map(float, ascending(tables.stability.mass, "stability.mass"))))


def tolerance_settings(tables: ScenarioTables) -> ToleranceSettings | None:
    """Spreads of the inputs; at least one."""
    table = tables.tolerances
    if table is None:
        return None
    spreads = {name: spread for name in KINDS if (spread := getattr(table, name)) is not None}
    if not spreads:
        raise InputError(
            f"needs one input or more ({', '.join(KINDS)}); write for example "
            'radial_clearance = "5 um"',
            key="tolerances",
        )
    if "load" in spreads and tables.operating.load is None:
        raise InputError(
            "goes with operating.load; with an eccentricity ratio the load is a result",
            key="tolerances.load",
        )
    _check_reach(tables, spreads, table.distribution)
    return ToleranceSettings(spreads, table.distribution, table.samples, table.seed)


def _check_reach(
    tables: ScenarioTables, spreads: dict[str, Spread], distribution: Distribution
) -> None:
    """Refuse spreads that leave nothing of the value they are about, or less."""
    about = {
        "radial_clearance": ("bearing", min(tables.bearing.radial_clearance), 1e6, "um"),
        "load": ("operating", tables.operating.load or math.inf, 1e-3, "kN"),
    }
    for name, spread in spreads.items():
        normal = (spread.distribution or distribution) is Distribution.NORMAL
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
