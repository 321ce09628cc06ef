"""Machines that are simulated in time by several tests."""

from __future__ import annotations

from rotorsim.files.machine import MachineFile

_TEXT = """
title = "Two discs"
[rotor]
kind = "beam"
internal_damping = "5e-6 s"
[[rotor.section]]
length = "1000 mm"
outer_diameter = "50 mm"
elements = {elements}
[[rotor.disc]]
name = "left disc"
at = "300 mm"
mass = "20 kg"
polar_inertia = "0.25 kg*m^2"
transverse_inertia = "0.15 kg*m^2"
[[rotor.disc]]
name = "right disc"
at = "700 mm"
mass = "20 kg"
polar_inertia = "0.25 kg*m^2"
transverse_inertia = "0.15 kg*m^2"
[[rotor.unbalance]]
at = "300 mm"
amount = "{unbalance}"
[[rotor.unbalance]]
at = "700 mm"
amount = "{unbalance}"
phase = "60 deg"
{supports}
[operating]
speed = {{ start = "1000 rpm", stop = "9000 rpm", count = 9 }}
{orbit}
"""

SPRINGS = """
[[support]]
name = "A"
at = "50 mm"
stiffness = [["20 MN/m", "2 MN/m"], ["-2 MN/m", "15 MN/m"]]
damping = "5 kN*s/m"
[[support]]
name = "B"
at = "950 mm"
stiffness = "20 MN/m"
damping = "5 kN*s/m"
pedestal = { mass = "50 kg", stiffness = "100 MN/m", damping = "10 kN*s/m" }
"""

FILMS = """
[[support]]
name = "A"
at = "50 mm"
bearing = "plain.toml"
[[support]]
name = "B"
at = "950 mm"
bearing = "plain.toml"
"""

PLAIN = """
[bearing]
journal_radius = "25 mm"
length = "20 mm"
radial_clearance = "50 um"
[lubricant]
viscosity = "0.02 Pa*s"
reference_temperature = "40 degC"
viscosity_temperature_coefficient = "0.03 / delta_degC"
density = "860 kg/m^3"
specific_heat = "2000 J/(kg*delta_degC)"
thermal_conductivity = "0.13 W/(m*delta_degC)"
[film]
inception = "free"
mesh = { circumferential = 64, axial = 16 }
[thermal]
models = ["isothermal"]
ambient_temperature = "40 degC"
[operating]
speed = "3000 rpm"
load = "300 N"
"""

PADS = (
    PLAIN.replace("[bearing]\n", '[bearing]\nkind = "tilting_pad"\n')
    .replace(
        "[lubricant]",
        '[bearing.pads]\ncount = 4\narc = "70 deg"\nthickness = "8 mm"\npreload = 0.2\n'
        'load = "between_pads"\n[lubricant]',
    )
    .replace("circumferential = 64, axial = 16", "circumferential = 64, axial = 8")
)


def two_discs(
    supports: str,
    orbit: str = "",
    *,
    folder=None,
    elements: int = 10,
    unbalance: str = "200 g*mm",
    bearing: str = PLAIN,
) -> MachineFile:
    """Machine of two discs; its bearing file is written to `folder`."""
    source = None
    if folder is not None:
        (folder / "plain.toml").write_text(bearing)
        source = folder / "machine.toml"
    text = _TEXT.format(elements=elements, supports=supports, orbit=orbit, unbalance=unbalance)
    return MachineFile.from_text(text, source=source)
