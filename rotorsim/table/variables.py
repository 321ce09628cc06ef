"""What a table holds: names, units and descriptions (CF style), in one place."""

from __future__ import annotations

TABLE_VERSION = 1
"""Format of the file; raised when older programs could misread it."""

COEFFICIENTS = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")

DIMENSIONS = ("thermal_model", "radial_clearance", "speed")

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

ATTRIBUTES: dict[str, tuple[str, str]] = {
    "thermal_model": ("1", "thermal model of the film"),
    "radial_clearance": ("m", "radial clearance"),
    "speed": ("rad s-1", "shaft speed"),
    **{
        f"k{i}{j}": ("N m-1", f"stiffness -dF{i}/d{j}, load frame (x along the static load)")
        for i in "xy"
        for j in "xy"
    },
    **{
        f"c{i}{j}": ("N s m-1", f"damping -dF{i}/dv{j}, load frame (x along the static load)")
        for i in "xy"
        for j in "xy"
    },
    "eccentricity_ratio": ("1", "eccentricity over radial clearance"),
    "attitude_angle": ("rad", "angle from the load line to the journal centre, with rotation"),
    "load": ("N", "magnitude of the static load"),
    "sommerfeld_number": ("1", "Sommerfeld number mu N L D (R/c)^2/W"),
    "max_pressure": ("Pa", "maximum film pressure (gauge)"),
    "max_temperature": ("K", "maximum film temperature"),
    "mean_temperature": ("K", "mean film temperature"),
    "friction_force": ("N", "friction force on the shaft"),
    "power_loss": ("W", "friction power"),
    "side_flow": ("m3 s-1", "flow out of both ends"),
    "min_film_thickness": ("m", "minimum film thickness"),
    "critical_mass": ("kg", "critical mass per bearing; NaN without a threshold, see stability"),
    "critical_mass_dimensionless": ("1", "critical mass M c omega^2/W"),
    "whirl_frequency_ratio": ("1", "whirl frequency at the threshold over shaft frequency"),
    "residual": ("1", "last change of log viscosity, or relative force residual"),
    "iterations": ("1", "iterations of the operating point"),
    "status": ("1", "how the solution ended; numbers count only where it is 'converged'"),
    "stability": ("1", "verdict on the rigid rotor's critical mass"),
    "cavitation": ("1", "cavitation model"),
}

SCALARS = (
    "eccentricity_ratio",
    "attitude_angle",
    "load",
    "sommerfeld_number",
    "max_pressure",
    "max_temperature",
    "mean_temperature",
    "friction_force",
    "power_loss",
    "side_flow",
    "min_film_thickness",
    "critical_mass",
    "critical_mass_dimensionless",
    "whirl_frequency_ratio",
    "residual",
)

TEXTS = ("status", "stability", "cavitation")


def cf_attributes(name: str) -> dict[str, str]:
    """``units`` and ``long_name`` of a table's variable."""
    units, long_name = ATTRIBUTES[name]
    return {"units": units, "long_name": long_name}
