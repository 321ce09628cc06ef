"""Commands around files: new, export, view."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from ..errors import InputError
from .output import DONE, Output


class Profile(StrEnum):
    """Bores that `new` can write."""

    PLAIN = "plain"
    GROOVED = "grooved"
    ELLIPTICAL = "elliptical"


class ExportFormat(StrEnum):
    """Formats that `export` can write."""

    CSV = "csv"


def new(
    output: Output,
    name: Annotated[str, typer.Argument(help="Name of the scenario file.", show_default=False)],
    profile: Annotated[Profile, typer.Option("--profile", "-p", help="Shape of the bore.")] = (
        Profile.PLAIN
    ),
    load: Annotated[
        str | None,
        typer.Option("--load", help='Static load, e.g. "10 kN".', show_default="10 kN"),
    ] = None,
    eccentricity: Annotated[
        float | None,
        typer.Option("--eccentricity", help="Eccentricity ratio, instead of a load."),
    ] = None,
    iso_vg: Annotated[float, typer.Option("--iso-vg", help="Oil: ISO VG grade.")] = 32,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> int:
    """Write a commented scenario to start from.

    Example: rotorsim new pump --profile elliptical --load "10 kN" --iso-vg 46
    """
    from ..atomic import write_text
    from ..scenario import Scenario
    from .template import scenario_text

    if load is not None and eccentricity is not None:
        raise InputError("give a load or an eccentricity ratio, not both", key="--load")
    path = Path(name if name.endswith(".toml") else f"{name}.toml")
    if path.exists() and not force:
        raise InputError("exists; choose another name, or replace it with --force", source=path)
    target = ("load", load or "10 kN") if eccentricity is None else ("eccentricity", eccentricity)
    text = scenario_text(path.stem, profile.value, target, iso_vg)
    loaded = Scenario.from_text(text, source=path)
    write_text(path, text)
    output.document({"scenario": path, "title": loaded.title})
    output.show(
        f"{path} is written. Put your numbers in, then:",
        f"  rotorsim check {path}",
        f"  rotorsim run {path}",
    )
    return DONE


def export(
    output: Output,
    table: Annotated[Path, typer.Argument(metavar="TABLE", help="Coefficient table (netCDF).")],
    to: Annotated[
        list[ExportFormat], typer.Option("--to", help="Format; may be given more than once.")
    ],
    folder: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="DIR", help="Folder.", show_default="next to the table"
        ),
    ] = None,
) -> int:
    """Write a table for other programs.

    Example: rotorsim export coefficients/dal.nc --to csv
    """
    from ..table import CoefficientTable

    loaded = CoefficientTable.load(table)
    where = folder or table.parent
    written: dict[str, Path] = {}
    for kind in dict.fromkeys(to):
        path = where / f"{table.stem}.{kind.value}"
        path.parent.mkdir(parents=True, exist_ok=True)
        written[kind.value] = loaded.to_csv(path)
    output.document({"files": written})
    output.show(*(f"{kind}: {path}" for kind, path in written.items()))
    return DONE


def view(
    output: Output,
    recording: Annotated[Path, typer.Argument(metavar="RECORDING", help="logs/NAME.rrd")],
) -> int:
    """Open a recording in the rerun viewer.

    Example: rotorsim view logs/dal.rrd
    """
    from ..recording import open_viewer

    launch = open_viewer(recording)
    output.document({"started": launch.started, "message": launch.message})
    if launch.started:
        output.show(launch.message)
    else:
        output.warn(launch.message)
    return launch.exit_code
