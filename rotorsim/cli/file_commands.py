"""Commands around files: new, export, view."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from ..errors import InputError
from ..file_kinds import HEAD, KNOWN_SUFFIXES, FileKind, recognise, sentence
from ..shipped import shipped_scenarios
from .options import BearingOption, TableArgument, check_file, check_folder, given_table, option
from .output import DONE, Output, as_typed


class _Profile(StrEnum):
    """Bores that `new` can write."""

    PLAIN = "plain"
    GROOVED = "grooved"
    ELLIPTICAL = "elliptical"
    PRESSURE_DAM = "pressure_dam"
    TILTING_PAD = "tilting_pad"


class _ExportFormat(StrEnum):
    """Formats that `export` can write; `rotorsim.files.FORMATS` says how."""

    ROSS = "ross"
    ROSS2 = "ross2"
    CSV = "csv"
    MAT = "mat"
    TXT = "txt"
    NC = "nc"


_OPTION_OF = {
    "operating.load": "--load",
    "operating.eccentricity_ratio": "--eccentricity",
    "lubricant.iso_vg": "--iso-vg",
}
"""Options of `new` by the entries that they fill."""
_OTHER_SUFFIXES = {*(f".{end}" for end in ("md", "yaml", "yml", "ini", "cfg", "xml", "docx"))} | {
    *KNOWN_SUFFIXES
}
"""Endings that mean another kind of file (a name may hold dots: "pump 1.2")."""


def _shipped_names(incomplete: str) -> list[str]:
    """Shipped scenarios whose names begin so, for the shell's completion."""
    return [name for name in shipped_scenarios() if name.startswith(incomplete)]


class _NewRotor(StrEnum):
    """Rotors that `new` can write."""

    RIGID = "rigid"
    JEFFCOTT = "jeffcott"
    BEAM = "beam"


def _export_formats(text: str) -> list[_ExportFormat]:
    """Formats from words between commas, each once."""
    words = [word.strip().lower() for word in text.split(",")]
    known = ", ".join(_ExportFormat)
    if not all(word in set(_ExportFormat) for word in words):
        raise InputError(f"must be some of {known}, with commas between", key="--to", value=text)
    return [_ExportFormat(word) for word in dict.fromkeys(words)]


def _load_directions(
    text: str | None, table: Path, kinds: list[_ExportFormat]
) -> tuple[float | None, float | None]:
    """``--load-direction`` [rad] for reading `table` and for writing: whichever is ROSS's."""
    if text is None:
        return None, None
    from ..units import parse_quantity

    angle = parse_quantity(text, "angle", key="--load-direction", example="-90 deg")
    reads = table.suffix.lower() in (".toml", ".json")
    writes = not {_ExportFormat.ROSS, _ExportFormat.ROSS2}.isdisjoint(kinds)
    if not reads and not writes:
        message = "has no use: only the frame of ROSS is turned; give ross to --to"
        raise InputError(message, key="--load-direction", value=text)
    if reads and writes:
        message = "could be that of TABLE or of the new file, both of ROSS; first export --to nc"
        raise InputError(message, key="--load-direction", value=text)
    return (angle, None) if reads else (None, angle)


def new(
    output: Output,
    name: Annotated[str, typer.Argument(help="Name of the scenario file.", show_default=False)],
    profile: Annotated[
        _Profile | None,
        typer.Option("--profile", "-p", help="Shape of the bore.", show_default="plain"),
    ] = None,
    rotor: Annotated[
        _NewRotor, typer.Option("--rotor", help="beam: a machine's file, its bearing's beside it.")
    ] = _NewRotor.RIGID,
    load: Annotated[
        str | None, typer.Option("--load", help='Static load, e.g. "10 kN".', show_default="10 kN")
    ] = None,
    eccentricity: Annotated[
        float | None, typer.Option("--eccentricity", help="Eccentricity ratio, instead of a load.")
    ] = None,
    iso_vg: Annotated[
        float | None,
        typer.Option("--iso-vg", metavar="GRADE", help="Oil: ISO VG grade.", show_default="32"),
    ] = None,
    example: Annotated[
        str | None,
        option(
            "--example",
            "NAME",
            "Start from a shipped scenario instead, e.g. dal.",
            True,
            autocompletion=_shipped_names,
        ),
    ] = None,
    source: Annotated[
        Path | None,
        option("--from", "FILE", "A machine from a rotor saved by ROSS, or a CSV of sections."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> int:
    """Write a commented scenario, or a machine, to start from.

    Example: rotorsim new pump --profile elliptical --load "10 kN" --iso-vg 46

    A rotor from its drawing on two bearings: rotorsim new compressor --rotor beam
    """
    from ..atomic import write_text
    from ..files.scenario import Scenario

    path = Path(name if name.endswith(".toml") else f"{name}.toml")
    if Path(name).suffix.lower() in _OTHER_SUFFIXES:
        raise InputError(
            f'a scenario ends in .toml; write for example "{Path(name).with_suffix(".toml")}", or '
            "leave the ending away",
            key="NAME",
            value=name,
        )
    if not path.name.removesuffix(".toml").strip("."):
        raise InputError("needs a name", key="NAME", value=name)
    if path.exists() and not force:
        raise InputError("exists; choose another name, or replace it with --force", source=path)
    check_file(path)
    if source is not None:
        if (profile, load, eccentricity, iso_vg, example) != (None,) * 5:
            raise InputError("describes the whole machine: give no further choice", key="--from")
        return _from_drawing(output, path, source)
    if rotor is _NewRotor.BEAM:
        if example is not None or load is not None or eccentricity is not None:
            key = "--example" if example else "--load" if load else "--eccentricity"
            raise InputError("goes without: a machine's loads follow from its rotor", key=key)
        return _new_machine(output, path, profile or _Profile.ELLIPTICAL, iso_vg, force)
    if rotor is _NewRotor.JEFFCOTT and example is not None:
        raise InputError("has its own rotor", key="--example")
    if example is None:
        text = _new_text(path.stem, profile or _Profile.PLAIN, load, eccentricity, iso_vg)
        if rotor is _NewRotor.JEFFCOTT:
            text = text.replace(_RIGID_ROTOR, _JEFFCOTT_ROTOR)
    elif (profile, load, eccentricity, iso_vg) == (None, None, None, None):
        text = _shipped_text(example)
    else:
        raise InputError("has its own bore, load and oil: give no further choice", key="--example")
    try:
        loaded = Scenario.from_text(text, source=path)
    except InputError as error:
        # The file is not there yet: what is wrong came from an option.
        if error.key not in _OPTION_OF:
            raise
        raise InputError(error.message, key=_OPTION_OF[error.key], value=error.value) from None
    write_text(path, text)
    output.document({"scenario": path, "title": loaded.title})
    output.show(
        f"{path} is written. Put your numbers in, then:\n"
        f"  rotorsim check {as_typed(path)}\n"
        f"  rotorsim run {as_typed(path)}"
    )
    return DONE


def _from_drawing(output: Output, path: Path, source: Path) -> int:
    """Write a machine file and its tables from another program's drawing."""
    from ..atomic import write_text
    from ..files.machine import MachineFile
    from ..files.shafts import machine_text

    text, tables = machine_text(source, path.stem)
    for name, table in tables.items():
        table.to_csv(path.with_name(f"{path.stem}_{name}"))
        text = text.replace(f'"{name}"', f'"{path.stem}_{name}"')
    machine = MachineFile.from_text(text, source=path)
    write_text(path, text)
    files = [path, *(path.with_name(f"{path.stem}_{name}") for name in tables)]
    output.document({"file": path, "tables": files[1:], "title": machine.title})
    output.note(f"written: {', '.join(map(str, files))}\nnext:\n  rotorsim check {as_typed(path)}")
    return DONE


def _new_text(
    title: str,
    profile: _Profile,
    load: str | None,
    eccentricity: float | None,
    iso_vg: float | None,
) -> str:

    if load is not None and eccentricity is not None:
        raise InputError("give a load or an eccentricity ratio, not both", key="--load")
    target = (
        ("load", "10 kN" if load is None else load)
        if eccentricity is None
        else ("eccentricity", eccentricity)
    )
    return _scenario_text(title, profile.value, target, 32.0 if iso_vg is None else iso_vg)


def _new_machine(
    output: Output, path: Path, profile: _Profile, iso_vg: float | None, force: bool
) -> int:
    """Write a machine's file and its bearing's."""
    from ..atomic import write_text
    from ..files.machine import load_machine

    bearing = path.with_name(f"{path.stem}_bearing.toml")
    if bearing.exists() and not force:
        raise InputError("exists; choose another name, or replace it with --force", source=bearing)
    check_file(bearing)
    safe = "".join(letter for letter in path.stem if letter.isprintable() and letter not in '"\\')
    write_text(bearing, _new_text(f"Bearing of {safe}", profile, None, None, iso_vg))
    text = _MACHINE.replace("{title}", safe)
    write_text(path, text.replace("{bearing}", bearing.name.replace("\\", "").replace('"', "")))
    loaded = load_machine(path)
    output.document({"machine": path, "bearing": bearing, "title": loaded.title})
    output.show(
        f"{path} and {bearing} are written. Put your numbers in, then:\n"
        f"  rotorsim check {as_typed(path)}\n"
        f"  rotorsim run {as_typed(path)}"
    )
    return DONE


def _shipped_text(name: str) -> str:
    shipped = shipped_scenarios()
    if name not in shipped:
        raise InputError(f"must be one of {', '.join(shipped)}", key="--example", value=name)
    return shipped[name].read_text(encoding="utf-8")


def export(
    output: Output,
    table: TableArgument,
    to: Annotated[
        str,
        option("--to", "FORMATS", "Some of ross, ross2, csv, mat, txt, nc, with commas between."),
    ],
    folder: Annotated[
        Path | None, option("--output -o", "DIR", "Folder.", "next to the table")
    ] = None,
    load_direction: Annotated[
        str | None,
        option(
            "--load-direction",
            "ANGLE",
            'Of the load in the frame of ROSS, from x towards y, e.g. "45 deg".',
            "-90 deg, the weight",
        ),
    ] = None,
    bearing: BearingOption = None,
) -> int:
    """Write a table for other programs, or (nc) another program's table for this one.

    ross: a bearing for ross.BearingElement.load of ROSS 3, ross2: of ROSS 2; csv and txt: columns
    of numbers; mat: MATLAB. Every file states its frame and signs.

    Example: rotorsim export coefficients/dal.nc --to ross,csv
    """
    from ..files.formats import FORMATS, write_table

    kinds = _export_formats(to)
    read_at, written_at = _load_directions(load_direction, table, kinds)
    loaded = given_table(output, table, bearing, read_at)
    name = table.stem.removesuffix(".ross").removesuffix(".ross2")
    where = folder or table.parent
    check_folder(where)
    for kind in kinds:
        if (where / f"{name}.{FORMATS[kind]}").resolve() == table.resolve():
            raise InputError(
                "would be replaced by itself; choose another folder with --output", source=table
            )
    files = {
        kind.value: write_table(
            loaded, kind.value, where, name,
            load_direction=written_at if kind.value.startswith("ross") else None,
        )
        for kind in kinds
    }  # fmt: skip
    output.document({"files": files})
    output.show("\n".join(f"{kind}: {path}" for kind, paths in files.items() for path in paths))
    return DONE


def view(
    output: Output,
    recording: Annotated[Path, typer.Argument(metavar="RECORDING", help="logs/NAME.rrd")],
) -> int:
    """Open a recording in the rerun viewer.

    Example: rotorsim view logs/dal.rrd
    """
    from ..show.viewer import open_viewer

    if str(recording).startswith("-"):  # the viewer would take it for an option
        recording = Path(".").absolute() / recording
    if recording.is_file():
        with recording.open("rb") as stream:
            head = stream.read(HEAD)
        if recognise(head) is not FileKind.RECORDING:
            kind = recognise(head, recording.suffix.lower())
            said = (
                "is no recording of rerun (.rrd)" if kind is FileKind.RECORDING else sentence(kind)
            )
            raise InputError(said or "is no recording of rerun (.rrd)", source=recording)
    launch = open_viewer(recording)
    output.document({"started": launch.started, "message": launch.message})
    if launch.started:
        output.show(launch.message)
    else:
        output.warn(launch.message)
    return launch.exit_code


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
    "pressure_dam": _GROOVES
    + """
# The dam: a pocket in the unloaded half that ends in a step; its pressure holds the journal down.
[[bearing.pocket]]
start = "100 deg"                   # behind the groove
end = "225 deg"
depth = "150 um"                    # depth_at_end: a taper
length = "60 mm"

# The relief track through the loaded half; without it the bearing carries more and whirls earlier.
[[bearing.pocket]]
start = "-80 deg"
end = "80 deg"
depth = "150 um"
length = "20 mm"
""",
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
flow = "laminar"                    # "turbulent" where rho U c/mu reaches some 500
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
_RIGID_ROTOR = 'mass = "1000 kg"                    # per bearing\n'
_JEFFCOTT_ROTOR = """\
kind = "jeffcott"                   # a disc on a massless shaft between two like bearings
disc_mass = "900 kg"                # half of the disc's
journal_mass = "50 kg"
shaft_stiffness = "400 MN/m"        # half of the shaft's
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


def _scenario_text(title: str, profile: str, target: tuple[str, str | float], iso_vg: float) -> str:
    """TOML text of a new scenario.

    profile : A member of `_Profile`.
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


_MACHINE = """\
# A machine: a rotor from its drawing on its bearings. `rotorsim check` says what this file means,
# `rotorsim run` does the whole job: bearings, modes, response, checks, figures, recording.
title = "{title}"

[rotor]
kind = "beam"                       # steel; youngs_modulus, density and poisson_ratio change it
rotation = "clockwise"              # seen from the left end
# internal_damping = "1e-5 s"       # rotating: above a critical speed it drives forward whirl

# Sections from the left end on; inner_diameter makes them hollow, outer_diameter_right a taper. A
# sleeve over them has at and layer = 2.
[[rotor.section]]
length = "200 mm"
outer_diameter = "100 mm"           # twice the bearing's journal_radius

[[rotor.section]]
length = "300 mm"
outer_diameter = "140 mm"

[[rotor.section]]
length = "500 mm"
outer_diameter = "180 mm"

[[rotor.section]]
length = "300 mm"
outer_diameter = "140 mm"

[[rotor.section]]
length = "200 mm"
outer_diameter = "100 mm"

[[rotor.disc]]                      # or its dimensions; mass alone: an added mass
name = "wheel"
at = "750 mm"                       # from the left end, like every place
mass = "400 kg"
polar_inertia = "20 kg*m^2"
transverse_inertia = "11 kg*m^2"

[[rotor.unbalance]]
at = "750 mm"
grade = "G2.5"                      # ISO 21940-11; or amount = "500 g*mm"

# Angles of a bearing count from x, down, in the direction of rotation; its own load and speeds are
# not used here. In place of bearing: coefficients = "theirs.csv", or stiffness and damping.
[[support]]
name = "left"
at = "100 mm"
bearing = "{bearing}"
# pedestal = { mass = "300 kg", stiffness = "500 MN/m", damping = "50 kN*s/m" }

[[support]]
name = "right"
at = "1400 mm"
bearing = "{bearing}"

# [[seal]]                          # a seal or impeller: acts on the motion, carries no load
# at = "600 mm"
# stiffness = [["1 MN/m", "0.5 MN/m"], ["-0.5 MN/m", "1 MN/m"]]
# damping = "1 kN*s/m"

[[probe]]
name = "left X"
at = "220 mm"
angle = "135 deg"

[[probe]]
name = "left Y"
at = "220 mm"
angle = "225 deg"

# [[clearance]]                     # checked against the response
# at = "600 mm"
# diametral = "0.5 mm"

[operating]
speed = { start = "2000 rpm", stop = "8000 rpm", count = 7 }
continuous = ["4000 rpm", "6000 rpm"]   # the range that margins are judged for
trip = "6600 rpm"

[lateral]
edition = "formulas of API 617, not compared with an edition"
destabilising_stiffness = [{ at = "750 mm", anticipated = "2 MN/m" }]

# A map of the least stable mode's growth rate, by rotorsim run; any two parameters of the machine.
# [[map]]
# x = "speed"
# y = "left.clearance"
# y_values = { start = "80 um", stop = "140 um", count = 5 }

# What tolerances do to the threshold: rotorsim stability --tolerances
# [tolerances]
# spread = { "left.clearance" = "10 um", "right.clearance" = "10 um", viscosity = "10 %" }

# A magnetic actuator and its sensor: rotorsim control
# [control]
# actuator = ["400 mm"]
# sensor = ["wheel"]
# max_force = "2 kN"
"""
