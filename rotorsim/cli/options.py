"""Arguments and options that several commands share."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from ..shipped import shipped_file


def file_or_shipped(path: Path) -> Path:
    """`path`; or where there is no such file, the shipped scenario or table of that name."""
    return path if os.path.lexists(path) else shipped_file(str(path)) or path


BearingOption = Annotated[
    str | None,
    typer.Option(
        "--bearing",
        metavar="NAME",
        help="Bearing in a file of ROSS that holds several: its tag.",
        show_default=False,
    ),
]
ScenarioArgument = Annotated[
    Path,
    typer.Argument(
        metavar="SCENARIO",
        help="Scenario file (TOML), or the name of a shipped scenario, e.g. dal.",
        show_default=False,
        callback=file_or_shipped,
    ),
]
TableArgument = Annotated[
    Path,
    typer.Argument(
        metavar="TABLE", help="Table: netCDF, CSV, or a bearing saved by ROSS (TOML, JSON)."
    ),
]
JsonOption = Annotated[
    bool, typer.Option("--json", help="Print the results as one JSON document on stdout (SI).")
]
QuietOption = Annotated[
    bool, typer.Option("--quiet", "-q", help="No progress, no tables; errors still show.")
]
OutputFolder = Annotated[
    Path,
    typer.Option(
        "--output", "-o", metavar="DIR", help="Folder for what is written.", show_default="here"
    ),
]
WorkersOption = Annotated[
    int | None,
    typer.Option(
        "--workers", "-w", metavar="N", help="Processes; 1: none extra.", show_default="all cores"
    ),
]
SchedulerOption = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        metavar="ADDRESS",
        help="Dask scheduler to compute on, e.g. tcp://host:8786 (extra: cluster).",
        show_default=False,
    ),
]
ModelOption = Annotated[
    str | None,
    typer.Option(
        "--model",
        "-m",
        metavar="NAME",
        help="Only this thermal model: isothermal or thd.",
        show_default="the scenario's",
    ),
]
ClearanceOption = Annotated[
    str | None,
    typer.Option(
        "--clearance",
        "-c",
        metavar="LENGTH",
        help='Only this radial clearance, e.g. "100 um"; `solve` takes any.',
        show_default="the scenario's",
    ),
]
LoadOption = Annotated[
    str | None,
    typer.Option(
        "--load",
        "-w",
        metavar="FORCE",
        help='This static load in its place, e.g. "12 kN".',
        show_default="the scenario's load or eccentricity ratio",
    ),
]
SupplyTemperatureOption = Annotated[
    str | None,
    typer.Option(
        "--supply-temperature",
        metavar="TEMPERATURE",
        help='This temperature of the supplied oil, e.g. "45 degC".',
        show_default="the scenario's",
    ),
]
SpeedOption = Annotated[
    str | None,
    typer.Option(
        "--speed",
        "-s",
        metavar="SPEED",
        help='Only this speed, e.g. "15000 rpm".',
        show_default="the scenario's",
    ),
]
