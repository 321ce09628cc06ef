"""The scenario that `rotorsim new` writes."""

from __future__ import annotations

_HEAD = """\
# A rotorsim scenario. Every value with a dimension is a text with its unit: "100 um", "4 mil",
# "40 degC", "2.9e-6 reyn". `rotorsim check` says what this file means.
title = "{title}"

[bearing]
{kind}journal_radius = "50 mm"            # half of the diameter
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
    "tilting_pad": """
# The clearance above is the machined one: pad radius less journal radius. Pads all alike; pads of
# their own are written one by one as [[bearing.pad]] with pivot_angle and what differs.
[bearing.pads]
count = 5
arc = "58 deg"
thickness = "18 mm"                 # from the pad's face to its pivot; mass and inertia follow
offset = 0.5                        # of the pivot along the arc; 0.6: nearer to the trailing edge
preload = 0.3                       # 1 - assembled over machined clearance
load = "between_pads"               # or "on_pad"; or pivot_angle, that of the first pad
pivot = { kind = "rigid" }          # stiffness | line | sphere | ball_in_socket: they give way
feed = "flooded"                    # leading_edge_groove | spray_bar: less hot oil is carried over
""",
}
_FILM_BEGINS = 'inception = "max_film"              # where the film begins: free | max_film\n'
_OIL = """
[lubricant]
iso_vg = {iso_vg:g}                         # or two (temperature, viscosity) points:
# viscosity_points = [["40 degC", "0.0277 Pa*s"], ["100 degC", "0.0046 Pa*s"]]
density = "860 kg/m^3"
specific_heat = "2000 J/(kg*delta_degC)"
thermal_conductivity = "0.13 W/(m*delta_degC)"

[film]
cavitation = "reynolds"             # full_sommerfeld | half_sommerfeld | reynolds | jfo
{begins}mesh = {{ circumferential = {around}, axial = 24, cross_film = 16 }}  # try half, and double

[thermal]
models = ["isothermal", "thd"]      # heating neglected, and solved for
# Where the heat goes decides film and losses. The oil carries it all here: a film on the hot side.
inlet = "mixing"                    # warm oil comes round; "fresh": every film begins with
                                    # supplied oil, colder; "periodic": nothing fresh, hotter
shaft = "insulated"                 # it takes no net heat (a long shaft); "ambient": held at
                                    # ambient temperature, far colder; or a measured temperature
{bush}ambient_temperature = "40 degC"
supply_temperature = "40 degC"

[operating]
speed = {{ start = "1000 rpm", stop = "12000 rpm", count = 12 }}
"""
_BUSH = """\
bush = "insulated"                  # no heat; "conduction": through the bush into the air, the
                                    # most real (needs bearing.bush_outer_radius, bush_conductivity
                                    # and bush_heat_transfer); "ambient": held there, far colder
"""
_PADS = """\
bush = "conduction"                 # through each pad into the oil around it; or "insulated"
bush_conductivity = "50 W/(m*delta_degC)"
bush_heat_transfer = "100 W/(m^2*delta_degC)"
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

    profile : ``plain``, ``grooved``, ``elliptical`` or ``tilting_pad``.
    target : (str, value). ``("load", "10 kN")`` or ``("eccentricity", 0.5)``.
    iso_vg : Grade of the oil.
    """
    kind, value = target
    # What a user typed goes into quotes in the file: nothing in it may end them.
    quoted = str(value).replace("\\", "").replace('"', "")
    held = _LOAD.format(load=quoted) if kind == "load" else _ECCENTRICITY.format(eccentricity=value)
    safe = "".join(letter for letter in title if letter.isprintable() and letter not in '"\\')
    pads = profile == "tilting_pad"
    head = _HEAD.format(title=safe, kind='kind = "tilting_pad"\n' if pads else "")
    oil = _OIL.format(
        iso_vg=iso_vg, around=150 if pads else 96, begins="" if pads else _FILM_BEGINS,
        bush=_PADS if pads else _BUSH,
    )  # fmt: skip
    return head + _BORES[profile] + oil + held + _ROTOR
