"""A case, a scenario or a machine with some of its inputs replaced."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from ..errors import InputError
from ..model import (
    Bearing,
    Case,
    ExponentialViscosity,
    LoadTarget,
    Lubricant,
    MeshSize,
    WaltherViscosity,
)
from ..model.lubricant import SENSIBLE_VISCOSITY

if TYPE_CHECKING:
    from ..files.machine import MachineFile
    from ..files.scenario import Scenario

COARSE = MeshSize(circumferential=48, axial=12, cross_film=8, bush_radial=8)
"""Mesh for many solutions in a short time: critical masses within some per cent."""
OTHERWISE = {"orbit": None, "stability": None, "tolerances": None, "study": None}
"""Parts of a scenario that are not asked for where an entry varies."""


def _with_supply_temperature(case: Case, temperature: float) -> Case:
    """Return `case` with all oil, that of the grooves included, supplied at `temperature` [K]."""
    viscosity = float(case.lubricant.viscosity(temperature))
    low, high = SENSIBLE_VISCOSITY
    if not (math.isfinite(viscosity) and low <= viscosity <= high):
        raise InputError(
            f"gives the oil a viscosity of {viscosity:.3g} Pa*s",
            key="supply_temperature",
            value=temperature,
        )
    grooves = tuple(
        dataclasses.replace(groove, supply_temperature=None) for groove in case.bearing.grooves
    )
    bearing: Bearing = dataclasses.replace(case.bearing, grooves=grooves)
    thermal = dataclasses.replace(case.thermal, supply_temperature=temperature)
    return dataclasses.replace(case, bearing=bearing, thermal=thermal)


def _with_viscosity(case: Case, factor: float) -> Case:
    """Return `case` with an oil that is `factor` as viscous at every temperature."""
    if not (math.isfinite(factor) and factor > 0.0):
        raise InputError("must be above 0", key="viscosity", value=factor)
    oil: Lubricant = case.lubricant
    law = oil.law
    if isinstance(law, ExponentialViscosity):
        law = dataclasses.replace(law, reference_viscosity=law.reference_viscosity * factor)
    elif isinstance(law, WaltherViscosity):
        # The law's density does nothing but turn kinematic into dynamic viscosity.
        law = dataclasses.replace(law, density=law.density * factor)
    else:
        raise InputError("this oil's law cannot be scaled", key="viscosity")
    return dataclasses.replace(case, lubricant=dataclasses.replace(oil, law=law))


def with_mesh(scenario: Scenario, mesh: MeshSize) -> Scenario:
    """Return `scenario` on another mesh."""
    return dataclasses.replace(scenario, film=dataclasses.replace(scenario.film, mesh=mesh))


def machine_with_mesh(machine: MachineFile, mesh: MeshSize | None) -> MachineFile:
    """Return `machine` with its bearings on another mesh."""
    if mesh is None:
        return machine
    bearings = {name: with_mesh(one, mesh) for name, one in machine.bearings.items()}
    return machine.with_parts(bearings=bearings)


def changed(case: Case, values: Mapping[str, float]) -> Case:
    """Return `case` with some of its inputs replaced.

    values : ``radial_clearance`` [m], ``applied_load`` [N], ``supply_temperature`` [K],
        ``viscosity`` (a factor).
    """
    for name, value in values.items():
        match name:
            case "radial_clearance":
                bearing = dataclasses.replace(case.bearing, radial_clearance=value)
                case = dataclasses.replace(case, bearing=bearing)
            case "applied_load":
                case = dataclasses.replace(case, target=LoadTarget(value))
            case "supply_temperature":
                case = _with_supply_temperature(case, value)
            case "viscosity":
                case = _with_viscosity(case, value)
            case _:
                allowed = "radial_clearance, applied_load, supply_temperature, viscosity"
                raise InputError(f"must be one of {allowed}", key=name)
    return case
