"""Tables of scenario files that several tests build theirs from.

The bearing and the oil are those of the plain bearing in the shipped `dal.toml`. Tests replace
parts of these lines by others, and compare with the numbers in them.
"""

from __future__ import annotations

BEARING = """\
[bearing]
journal_radius = "50 mm"
length = "80 mm"
radial_clearance = "100 um"
"""
CONSTANT_OIL = """\
[lubricant]
viscosity = "0.0277 Pa*s"
"""
OIL = f"""\
{CONSTANT_OIL}reference_temperature = "40 degC"
viscosity_temperature_coefficient = "0.034 / delta_degC"
density = "860 kg/m^3"
specific_heat = "2000 J/(kg*delta_degC)"
thermal_conductivity = "0.13 W/(m*delta_degC)"
"""
BOTH_MODELS = """\
[thermal]
models = ["isothermal", "thd"]
ambient_temperature = "40 degC"
"""

SMALL = f"""\
{BEARING}
{CONSTANT_OIL}
[film]
mesh = {{ circumferential = 32, axial = 8 }}
[operating]
speed = ["6000 rpm", "9000 rpm"]
eccentricity_ratio = 0.5
[rotor]
mass = "1200 kg"
[orbit]
speed = "9000 rpm"
"""
"""A whole scenario, of a few short film solutions; more keys of its orbit may follow."""
