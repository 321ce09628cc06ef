"""Building tilting-pad bearings, for their tests."""

from __future__ import annotations

import math

from rotorsim.model import (
    Bearing,
    Case,
    Cavitation,
    EccentricityTarget,
    ExponentialViscosity,
    FilmSettings,
    Groove,
    LoadTarget,
    Lubricant,
    MeshSize,
    Pad,
    Pivot,
    RigidPivot,
    ThermalModel,
    ThermalSettings,
)
from rotorsim.model.pads import gaps

RADIUS, LENGTH, CLEARANCE, THICKNESS = 0.05, 0.04, 100e-6, 0.015
SPEED, VISCOSITY = 300.0, 0.02


def equal_pads(
    count: int = 5,
    *,
    first_deg: float = 36.0,
    arc_deg: float = 60.0,
    offset: float = 0.5,
    preload: float = 0.3,
    pivot: Pivot | None = None,
    thickness: float = THICKNESS,
    **inertia: float,
) -> tuple[Pad, ...]:
    """Pads all alike; the first pivot stands `first_deg` ahead of the load."""
    return tuple(
        Pad(
            math.radians(first_deg + k * 360.0 / count),
            math.radians(arc_deg),
            thickness,
            offset=offset,
            preload=preload,
            pivot=pivot or RigidPivot(),
            **inertia,
        )
        for k in range(count)
    )


MASSLESS = {"mass": 0.0, "tilt_inertia": 0.0, "pitch_inertia": 0.0}


def pad_case(
    pads: tuple[Pad, ...],
    target: float | LoadTarget,
    *,
    mesh: tuple[int, int] = (80, 12),
    cavitation: str = "reynolds",
    supply_pressure: float = 0.0,
    misalignment: tuple[float, float] = (0.0, 0.0),
    radius: float = RADIUS,
    length: float = LENGTH,
    clearance: float = CLEARANCE,
    viscosity: float = VISCOSITY,
    thinning: float = 0.0,
    thermal: ThermalSettings | None = None,
) -> Case:
    """Isoviscous bearing unless told otherwise; `target` is an eccentricity ratio or a load."""
    grooves = tuple(
        Groove(middle, extent, supply_pressure=supply_pressure) for middle, extent in gaps(pads)
    )
    return Case(
        bearing=Bearing(
            radius, length, clearance, pads=pads, grooves=grooves, misalignment=misalignment
        ),
        lubricant=Lubricant(ExponentialViscosity(viscosity, 313.15, thinning), 860.0, 2000.0, 0.13),
        film=FilmSettings(cavitation=Cavitation(cavitation), mesh=MeshSize(*mesh, 8, 4)),
        thermal=thermal or ThermalSettings(model=ThermalModel.ISOTHERMAL),
        target=EccentricityTarget(target) if isinstance(target, float) else target,
    )
