"""Names, units and limits of a coefficient table's variables, and the frame they are in."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    pass

TABLE_VERSION = 1
"""Format of the file; raised when older programs could misread it."""
COEFFICIENTS = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")
DIMENSIONS = ("thermal_model", "radial_clearance", "speed")
FREQUENCY = "frequency_ratio"
"""Dimension of the variables ``kxx_of_frequency`` ... ``cyy_of_frequency``, where given."""
LARGEST = 1e20
"""Of stiffness [N/m] and damping [N s/m]; beyond, their products would overflow."""
SLOWEST, FASTEST = 1e-6, 1e6
"""Shaft speeds [rad/s]."""
CONSTANT = "constant"
"""Attribute of a table whose coefficients hold at any speed, not at the tabulated ones only."""
CONSTANT_SPEEDS = tuple(1000.0 * (step + 1) * math.pi / 30.0 for step in range(20))
"""Speeds at which constant coefficients are tabulated unless others are wanted [rad/s]."""
NOTES = "notes"
"""Attribute with what a reader left out or took for granted, a line each."""
SIGNS = (
    "K_ij = -dF_i/dx_j [N/m], C_ij = -dF_i/dv_j [N s/m], F the film's force on the journal;",
    "first index: direction of the force, second: direction of the displacement or velocity.",
)
CONVENTIONS = (
    "Frame: x along the static load on the journal, y 90 degrees ahead of x in the direction of",
    "the shaft's rotation.",
    *SIGNS,
)
"""Lines that every file in the load frame carries."""
JOURNAL_UNKNOWNS = ("x", "y", "theta_x", "theta_y")


def _full_attributes(kind: str, i: str, j: str) -> tuple[str, str]:
    """Return the unit and description of one entry of the full K or C."""
    power = 1 + (i in JOURNAL_UNKNOWNS[2:]) + (j in JOURNAL_UNKNOWNS[2:])
    unit = {1: ("N m-1", "N s m-1"), 2: ("N", "N s"), 3: ("N m", "N m s")}[power][kind == "c"]
    words = "stiffness" if kind == "k" else "damping"
    return unit, f"{words} -dQ_{i}/d{j}{'' if kind == 'k' else '-dot'}, rotations included"


_SCALARS = {
    "eccentricity_ratio": (
        "1",
        "eccentricity over radial clearance, the hot one where it is known",
    ),
    "attitude_angle": ("rad", "angle from the load line to the journal centre, with rotation"),
    "load": ("N", "magnitude of the static load"),
    "sommerfeld_number": ("1", "Sommerfeld number mu N L D (R/c)^2/W"),
    "max_pressure": ("Pa", "maximum film pressure (gauge)"),
    "max_temperature": ("K", "maximum film temperature"),
    "mean_temperature": ("K", "mean film temperature"),
    "shaft_temperature": ("K", "temperature of the shaft's surface"),
    "hot_radial_clearance": ("m", "radial clearance when hot; NaN without thermal expansion"),
    "hot_preload": ("1", "mean preload of lobes or pads when hot"),
    "deflection": ("m", "largest elastic deflection of pads or bore; NaN where they are rigid"),
    "reynolds_number": ("1", "largest local Reynolds number rho U h/mu of the film"),
    "laminar_share": ("1", "part of the film's area that is laminar"),
    "transitional_share": ("1", "part of the film's area between laminar and turbulent"),
    "turbulent_share": ("1", "part of the film's area that is turbulent"),
    "heat_imbalance": ("1", "heat unaccounted for over the dissipation; NaN if isothermal"),
    "friction_force": ("N", "friction force on the shaft"),
    "power_loss": ("W", "friction power"),
    "side_flow": ("m3 s-1", "flow out of both ends"),
    "min_film_thickness": ("m", "minimum film thickness"),
    "critical_mass": ("kg", "critical mass per bearing; NaN without a threshold, see stability"),
    "critical_mass_dimensionless": ("1", "critical mass M c omega^2/W"),
    "whirl_frequency_ratio": ("1", "whirl frequency at the threshold over shaft frequency"),
    "coefficient_frequency_ratio": (
        "1",
        "whirl frequency over shaft frequency at which kxx ... cyy hold; NaN: at any",
    ),
    "residual": ("1", "last change of log viscosity, or relative force residual"),
}
_MATRICES = {
    f"{letter}{i}{j}": (unit, f"{word} -dF{i}/d{rate}{j}")
    for letter, word, unit, rate in (
        ("k", "stiffness", "N m-1", ""), ("c", "damping", "N s m-1", "v")
    )
    for i in "xy"
    for j in "xy"
}  # fmt: skip
ATTRIBUTES: dict[str, tuple[str, str]] = {
    "thermal_model": ("1", "thermal model of the film"),
    "radial_clearance": ("m", "radial clearance"),
    "speed": ("rad s-1", "shaft speed"),
    **{
        name: (unit, f"{words}, load frame (x along the static load)")
        for name, (unit, words) in _MATRICES.items()
    },
    FREQUENCY: ("1", "whirl frequency over shaft frequency"),
    **{
        f"{name}_of_frequency": (unit, f"{words} over the whirl frequency")
        for name, (unit, words) in _MATRICES.items()
    },
    **{
        f"{kind}_{i}_{j}": _full_attributes(kind, i, j)
        for kind in "kc"
        for i in JOURNAL_UNKNOWNS
        for j in JOURNAL_UNKNOWNS
    },
    "unknown": ("1", "degree of freedom of journal or pad whose force it is"),
    "other_unknown": ("1", "degree of freedom that moves"),
    "full_stiffness": ("1", "stiffness over journal and pads [N/m, N/rad, N m/rad]"),
    "full_damping": ("1", "damping over journal and pads [N s/m, N s/rad, N m s/rad]"),
    "full_mass": ("1", "mass of the pads [kg, kg m, kg m2]"),
    "critical_mass_synchronous": (
        "kg",
        "critical mass of kxx ... cyy alone, where the pads have motions of their own",
    ),
    "moment_x": ("N m", "moment of the film on the journal about x, through the mid-plane"),
    "moment_y": ("N m", "moment of the film on the journal about y, through the mid-plane"),
    **_SCALARS,
    "iterations": ("1", "iterations of the operating point"),
    "status": ("1", "how the solution ended; numbers count only where it is 'converged'"),
    "stability": ("1", "verdict on the rigid rotor's critical mass"),
    "cavitation": ("1", "cavitation model"),
}
"""CF units and long name of each variable."""
SCALARS = tuple(_SCALARS)
FULL_COEFFICIENTS = tuple(
    f"{kind}_{i}_{j}" for kind in "kc" for i in JOURNAL_UNKNOWNS for j in JOURNAL_UNKNOWNS
)
"""K and C over displacements and rotations, row by row: ``k_x_x`` ... ``c_theta_y_theta_y``."""
TEXTS = ("status", "stability", "cavitation")
UNKNOWNS = ("unknown", "other_unknown")
"""Dimensions of the matrices over journal and pads: force of the first, motion of the second."""
PAD_MATRICES = ("full_stiffness", "full_damping", "full_mass")


def cf_attributes(name: str) -> dict[str, str]:
    """Return ``units`` and ``long_name`` of a table's variable."""
    units, long_name = ATTRIBUTES[name]
    return {"units": units, "long_name": long_name}
