"""The paper's bearing: its Table 1 and section 4 as model objects.

A. Dal, "Effects of the shaft speed on stiffness and damping coefficients of hydrodynamic
bearing-shaft system under variable viscosity". Where it leaves a choice, the choice has a name.
"""

from __future__ import annotations

import math
from dataclasses import replace
from enum import StrEnum

from ..model import (
    Bearing,
    BushModel,
    Case,
    EccentricityTarget,
    ExponentialViscosity,
    FilmSettings,
    Lubricant,
    MeshSize,
    RupturedFriction,
    ShaftModel,
    ThermalModel,
    ThermalSettings,
)
from ..model.lubricant import ZERO_CELSIUS

RAD_PER_RPM = math.pi / 30.0
AMBIENT = 40.0 + ZERO_CELSIUS
"""T_a [K], Table 1."""
CLEARANCES = (100e-6, 125e-6, 150e-6)
"""Section 4 [m]."""
ECCENTRICITY = 0.5
"""Section 4."""
SPEEDS_RPM = tuple(float(n) for n in range(500, 15001, 500))
TOP_RPM = 15000.0
VALIDATION_CLEARANCE = 145e-6
"""Fig. 2 [m]."""
PAPER_MESH = MeshSize(circumferential=156, axial=48, cross_film=24, bush_radial=24)
"""Its 48 x 156 x 24 nodes, the finer count around the bearing (see the sensitivity table)."""
LITERAL_MESH = MeshSize(circumferential=48, axial=156, cross_film=24, bush_radial=24)
"""Its node counts in the order printed: M circumferential, N axial, Z across."""
COARSE_MESH = MeshSize(circumferential=78, axial=24, cross_film=12, bush_radial=12)

BEARING = Bearing(
    journal_radius=50e-3, length=80e-3, radial_clearance=CLEARANCES[0], bush_outer_radius=75e-3
)
OIL = Lubricant(
    # Eq. 15: the printed eta is dimensionless; only 0.034 per kelvin can give the paper's results.
    law=ExponentialViscosity(0.0277, AMBIENT, 0.034),
    density=860.0,
    specific_heat=2000.0,
    thermal_conductivity=0.13,
)


class Walls(StrEnum):
    """Thermal condition of bush and shaft: what the paper leaves open, or says and did not do."""

    AMBIENT = "ambient"
    """Both surfaces at ambient temperature."""
    CONDUCTION = "conduction"
    """Bush conduction and convection with Table 1's numbers; shaft at ambient temperature."""
    CONDUCTION_SHAFT = "conduction_free_shaft"
    """The same bush; the shaft at the temperature at which it takes no net heat."""
    INSULATED = "insulated"
    """No heat through either wall: the oil carries all of it."""


_WALLS = {
    Walls.AMBIENT: (BushModel.AMBIENT, ShaftModel.AMBIENT),
    Walls.CONDUCTION: (BushModel.CONDUCTION, ShaftModel.AMBIENT),
    Walls.CONDUCTION_SHAFT: (BushModel.CONDUCTION, ShaftModel.INSULATED),
    Walls.INSULATED: (BushModel.INSULATED, ShaftModel.INSULATED),
}


def dal_case(
    radial_clearance: float,
    thermal_model: ThermalModel,
    *,
    walls: Walls = Walls.AMBIENT,
    mesh: MeshSize = PAPER_MESH,
    friction: RupturedFriction = RupturedFriction.LIQUID,
    eccentricity_ratio: float = ECCENTRICITY,
) -> Case:
    """The paper's bearing with one clearance [m] and thermal model.

    Reynolds rupture, p = 0 held at maximum thickness, fresh oil at ambient temperature there.
    """
    bush, shaft = _WALLS[walls]
    return Case(
        bearing=replace(BEARING, radial_clearance=radial_clearance),
        lubricant=OIL,
        film=FilmSettings(mesh=mesh, ruptured_friction=friction),
        thermal=ThermalSettings(
            model=thermal_model,
            ambient_temperature=AMBIENT,
            supply_temperature=AMBIENT,
            bush=bush,
            shaft=shaft,
            bush_conductivity=250.0,
            bush_heat_transfer=80.0,
        ),
        target=EccentricityTarget(eccentricity_ratio),
    )


def bush_cooling_area() -> float:
    """Surface of the bush that convection reaches: outside and both ends [m2]."""
    outer = BEARING.bush_outer_radius
    assert outer is not None
    inner = BEARING.journal_radius
    return 2.0 * math.pi * (outer * BEARING.length + outer**2 - inner**2)
