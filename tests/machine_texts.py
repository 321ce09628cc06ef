"""Text of the flexible rotor that tests of controllers, disturbances and tables share."""

from __future__ import annotations

WHEEL = """
[[rotor.disc]]
name = "wheel"
at = "0.5 m"
mass = "40 kg"
polar_inertia = "0.4 kg*m^2"
transverse_inertia = "0.25 kg*m^2"
"""
OVERHUNG = """
[[rotor.disc]]
name = "overhung"
at = "1.2 m"
mass = "10 kg"
polar_inertia = "0.1 kg*m^2"
transverse_inertia = "0.06 kg*m^2"
"""
UNSTABLE = 'internal_damping = "2e-5 s"'
"""Line of the rotor with which it is unstable at 9000 rpm on its springs."""
SPRINGS = """
[[support]]
at = "0 mm"
stiffness = ["20 MN/m", "15 MN/m"]
damping = "2 kN*s/m"
[[support]]
at = "1 m"
stiffness = "20 MN/m"
damping = "2 kN*s/m"
"""
FILMS = """
[[support]]
name = "left"
at = "0 mm"
bearing = "bearing.toml"
[[support]]
name = "right"
at = "1 m"
bearing = "bearing.toml"
"""
AT_9000_RPM = """
[operating]
speed = "9000 rpm"
"""
BEARING = """
[bearing]
journal_radius = "30 mm"
length = "30 mm"
radial_clearance = "60 um"
[lubricant]
viscosity = "0.02 Pa*s"
density = "860 kg/m^3"
specific_heat = "2000 J/(kg*delta_degC)"
thermal_conductivity = "0.13 W/(m*delta_degC)"
[film]
cavitation = "half_sommerfeld"
inception = "free"
mesh = {{ circumferential = {circumferential}, axial = {axial}, cross_film = 8 }}
[thermal]
models = "isothermal"
[operating]
speed = "9000 rpm"
load = "300 N"
"""
"""The file of `FILMS`."""


def flexible_rotor(rotor: str = "", elements: int | None = None, discs: str = WHEEL) -> str:
    """Return title and rotor of a machine file.

    rotor : Further lines of its table.
    elements : Of its section; None: as the program chooses.
    """
    mesh = "" if elements is None else f"elements = {elements}"
    return f"""
title = "flexible rotor"
[rotor]
kind = "beam"
{rotor}
[[rotor.section]]
length = "1.2 m"
outer_diameter = "60 mm"
{mesh}
{discs}
"""
