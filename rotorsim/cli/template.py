"""The scenario that `rotorsim new` writes."""

from __future__ import annotations

_HEAD = """\
# A rotorsim scenario. Every value with a dimension is a text with its unit: "100 um", "4 mil",
# "40 degC", "2.9e-6 reyn". `rotorsim check` says what this file means.
title = "{title}"

[bearing]
journal_radius = "50 mm"            # half of the diameter
length = "80 mm"
radial_clearance = "100 um"         # half of the diametral one; a list: ["80 um", "100 um"]
roughness = "0.8 um"                # a thinner film is reported
"""
_GROOVES = """
# Supply grooves at the split. Angles are counted from the load line, with the rotation.
[[bearing.groove]]
center = "90 deg"
extent = "20 deg"
supply_pressure = "100 kPa"

[[bearing.groove]]
center = "270 deg"
extent = "20 deg"
supply_pressure = "100 kPa"
"""
_BORES = {
    "plain": "# A plain 360 degree bore; grooves are added with [[bearing.groove]].\n",
    "grooved": _GROOVES,
    "elliptical": """\
profile = "elliptical"              # or "three_lobe", "offset_halves"
preload = 0.5                       # 1 - (assembled clearance / lobe clearance)
"""
    + _GROOVES,
}
_OIL = """
[lubricant]
iso_vg = {iso_vg:g}                         # or two (temperature, viscosity) points:
# viscosity_points = [["40 degC", "0.0277 Pa*s"], ["100 degC", "0.0046 Pa*s"]]
density = "860 kg/m^3"
specific_heat = "2000 J/(kg*delta_degC)"
thermal_conductivity = "0.13 W/(m*delta_degC)"

[film]
cavitation = "reynolds"             # full_sommerfeld | half_sommerfeld | reynolds | jfo
inception = "max_film"              # where the film begins: free | max_film
mesh = {{ circumferential = 96, axial = 24, cross_film = 16 }}   # halve or double to see its effect

[thermal]
models = ["isothermal", "thd"]      # heating neglected, and solved for
# Where the heat goes decides film and losses. The oil carries it all here: a film on the hot side.
inlet = "mixing"                    # warm oil comes round; "fresh": every film begins with
                                    # supplied oil, colder; "periodic": nothing fresh, hotter
shaft = "insulated"                 # it takes no net heat (a long shaft); "ambient": held at
                                    # ambient temperature, far colder; or a measured temperature
bush = "insulated"                  # no heat; "conduction": through the bush into the air, the
                                    # most real (needs bearing.bush_outer_radius, bush_conductivity
                                    # and bush_heat_transfer); "ambient": held there, far colder
ambient_temperature = "40 degC"
supply_temperature = "40 degC"

[operating]
speed = {{ start = "1000 rpm", stop = "12000 rpm", count = 12 }}
"""
_LOAD = """\
load = "{load}"                      # or: eccentricity_ratio = 0.5
# load_direction = "0 deg"          # of the load, if angles are counted from elsewhere
"""
_ECCENTRICITY = """\
eccentricity_ratio = {eccentricity:g}            # or: load = "10 kN"
"""
_ROTOR = """
[rotor]
mass = "1000 kg"                    # per bearing
unbalance = "500 g*mm"

[orbit]
force = "linear"                    # linear (K and C) | film (nonlinear film force)
speed = "6000 rpm"                  # or { start = "3000 rpm", stop = "9000 rpm", duration = "2 s" }
revolutions = 60
initial_displacement = ["1 um", "0 um"]
"""


def scenario_text(title: str, profile: str, target: tuple[str, str | float], iso_vg: float) -> str:
    """TOML text of a new scenario.

    Parameters
    ----------
    title : str
    profile : str
        ``plain``, ``grooved`` or ``elliptical``.
    target : (str, value)
        ``("load", "10 kN")`` or ``("eccentricity", 0.5)``.
    iso_vg : float
        Grade of the oil.
    """
    kind, value = target
    # What a user typed goes into quotes in the file: nothing in it may end them.
    quoted = str(value).replace("\\", "").replace('"', "")
    held = _LOAD.format(load=quoted) if kind == "load" else _ECCENTRICITY.format(eccentricity=value)
    safe = "".join(letter for letter in title if letter.isprintable() and letter not in '"\\')
    return _HEAD.format(title=safe) + _BORES[profile] + _OIL.format(iso_vg=iso_vg) + held + _ROTOR
