"""Commands around files: new, export, view."""

from __future__ import annotations

import re
from contextlib import suppress
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
    OFFSET_HALVES = "offset_halves"
    THREE_LOBE = "three_lobe"
    HYBRID = "hybrid"
    PRESSURE_DAM = "pressure_dam"
    TILTING_PAD = "tilting_pad"


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
    """Return the shipped scenarios whose names begin so, for the shell's completion."""
    return [name for name in shipped_scenarios() if name.startswith(incomplete)]


class _NewRotor(StrEnum):
    """Rotors that `new` can write."""

    RIGID = "rigid"
    JEFFCOTT = "jeffcott"
    BEAM = "beam"


def _export_formats(text: str) -> list[str]:
    """Return the formats from words between commas, each once."""
    from ..files.formats import FORMATS

    words = [word.strip().lower() for word in text.split(",")]
    if not set(words) <= set(FORMATS):
        known = ", ".join(FORMATS)
        raise InputError(f"must be some of {known}, with commas between", key="--to", value=text)
    return list(dict.fromkeys(words))


def _load_directions(
    text: str | None, table: Path, kinds: list[str]
) -> tuple[float | None, float | None]:
    """Return ``--load-direction`` [rad] to read `table` and to write, whichever is ROSS's."""
    if text is None:
        return None, None
    from ..units import parse_quantity

    angle = parse_quantity(text, "angle", key="--load-direction", example="-90 deg")
    reads = table.suffix.lower() in (".toml", ".json")
    writes = not {"ross", "ross2"}.isdisjoint(kinds)
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
        bore = profile or _Profile.PLAIN
        text = _scenario_text(path.stem, bore, load, eccentricity, iso_vg, rotor)
    elif (profile, load, eccentricity, iso_vg) != (None,) * 4:
        raise InputError("has its own bore, load and oil: give no further choice", key="--example")
    else:
        shipped = shipped_scenarios()
        if example not in shipped:
            raise InputError(f"must be one of {', '.join(shipped)}", key="--example", value=example)
        text = shipped[example].read_text(encoding="utf-8")
    try:
        loaded = Scenario.from_text(text, source=path)
    except InputError as error:
        # The file is not there yet: what is wrong came from an option.
        if error.key not in _OPTION_OF:
            raise
        raise InputError(error.message, key=_OPTION_OF[error.key], value=error.value) from None
    write_text(path, text)
    output.document({"scenario": path, "title": loaded.title})
    return _say_next(output, path, f"{path} is")


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
    title = _safe(path.stem)
    write_text(bearing, _scenario_text(f"Bearing of {title}", profile, None, None, iso_vg))
    text = _template("machine").replace("{title}", title)
    write_text(path, text.replace("{bearing}", _unquoted(bearing.name)))
    loaded = load_machine(path)
    output.document({"machine": path, "bearing": bearing, "title": loaded.title})
    return _say_next(output, path, f"{path} and {bearing} are")


def _say_next(output: Output, path: Path, written: str) -> int:
    output.show(
        f"{written} written. Put your numbers in, then:\n"
        f"  rotorsim check {as_typed(path)}\n"
        f"  rotorsim run {as_typed(path)}"
    )
    return DONE


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
        kind: write_table(
            loaded, kind, where, name,
            load_direction=written_at if kind.startswith("ross") else None,
        )
        for kind in kinds
    }  # fmt: skip
    output.document({"files": files})
    output.show("\n".join(f"{kind}: {path}" for kind, paths in files.items() for path in paths))
    return DONE


def view(
    output: Output,
    recording: Annotated[Path, typer.Argument(metavar="RECORDING", help="logs/NAME.rrd")],
    web: Annotated[
        bool,
        option("--web", None, "Serve the web viewer to a browser of this machine, till Ctrl-C."),
    ] = False,
) -> int:
    """Open a recording in the rerun viewer.

    Without a display: rotorsim view --web logs/dal.rrd, and open the address it says; from another
    machine through a tunnel of both ports.

    Example: rotorsim view logs/dal.rrd
    """
    from ..show.viewer import open_viewer, served_viewer

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
    if web:
        with served_viewer(recording) as (address, process):
            output.document({"address": address})
            output.show(address)
            output.note("open this address in a browser; Ctrl-C ends it")
            with suppress(KeyboardInterrupt):
                process.wait()
        return DONE
    launch = open_viewer(recording)
    output.document({"started": launch.started, "message": launch.message})
    if launch.started:
        output.show(launch.message)
    else:
        output.warn(launch.message)
    return launch.exit_code


def _scenario_text(
    title: str, profile: _Profile, load: str | None, eccentricity: float | None,
    iso_vg: float | None, rotor: _NewRotor = _NewRotor.RIGID,
) -> str:  # fmt: skip
    """Return the TOML text of a new scenario."""
    if load is not None and eccentricity is not None:
        raise InputError("give a load or an eccentricity ratio, not both", key="--load")
    parts = re.split(r"^#: (\w+)\n", _template("scenario"), flags=re.MULTILINE)
    piece = dict(zip(parts[1::2], parts[2::2], strict=True))
    pads = profile is _Profile.TILTING_PAD
    bore = {
        _Profile.ELLIPTICAL: piece["elliptical"] + piece["grooved"],
        _Profile.OFFSET_HALVES: piece["offset_halves"] + piece["grooved"],
        _Profile.PRESSURE_DAM: piece["grooved"] + piece["pressure_dam"],
    }.get(profile, piece[profile.value])
    oil = piece["oil"].format(
        iso_vg=32.0 if iso_vg is None else iso_vg, around=150 if pads else 96,
        begins="" if pads else piece["film_begins"], bush=piece["pads" if pads else "bush"],
    )  # fmt: skip
    # What a user typed goes into quotes in the file: nothing in it may end them.
    held = piece["load"].format(load=_unquoted("10 kN" if load is None else load))
    if eccentricity is not None:
        held = piece["eccentricity"].format(eccentricity=eccentricity)
    head = piece["head"].format(title=_safe(title), kind='kind = "tilting_pad"\n' if pads else "")
    return head + bore + oil + held + piece["rotor"].replace("{rotor}", piece[rotor.value])


def _template(name: str) -> str:
    return (Path(__file__).parent / "templates" / f"{name}.toml").read_text(encoding="utf-8")


def _unquoted(text: str) -> str:
    return text.replace("\\", "").replace('"', "")


def _safe(title: str) -> str:
    return "".join(letter for letter in _unquoted(title) if letter.isprintable())
