"""Arguments and options of the commands, and what they mean: from words to what is computed."""

from __future__ import annotations

import logging
import math
import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryFile
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError
from ..shipped import shipped_file

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario
    from ..model import Case
    from .output import Output

OWN = "the scenario's"
ROTOR = "Rotor"
"""Default, and panel of the help, of several options."""
_PATIENCE = 8.0
"""Time after which a scheduler counts as dead, and the lack of workers is said [s]."""


def option(
    names: str,
    metavar: str | None,
    text: str,
    default: str | bool = False,
    panel: str | None = None,
    **more: Any,
) -> Any:
    """Return an option of typer from its names with blanks between, its help and its default."""
    return typer.Option(
        *names.split(), metavar=metavar, help=text, show_default=default, rich_help_panel=panel,
        **more,
    )  # fmt: skip


def file_or_shipped(path: Path) -> Path:
    """Return `path`; where there is no such file, the shipped scenario or table of that name."""
    return path if os.path.lexists(path) else shipped_file(str(path)) or path


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
BearingOption = Annotated[
    str | None,
    option("--bearing", "NAME", "Bearing in a file of ROSS that holds several: its tag."),
]
JsonOption = Annotated[
    bool, typer.Option("--json", help="Print the results as one JSON document on stdout (SI).")
]
QuietOption = Annotated[
    bool, typer.Option("--quiet", "-q", help="No progress, no tables; errors still show.")
]
UnitsOption = Annotated[
    str | None,
    option("--units", "SYSTEM", "Show results in si or us (mil, lbf, psi, degF); files stay SI.",
           "units in ~/.config/rotorsim/config.toml, else si"),
]  # fmt: skip
FreshOption = Annotated[
    bool,
    typer.Option("--fresh", help="Take no film points from earlier commands."),
]
FormatOption = Annotated[
    str | None, option("--format", "FORMATS", "Figures as png, svg, pdf; some, with commas.", "own")
]
WidthOption = Annotated[
    str | None,
    option("--width", "LENGTH", 'Width of each figure, e.g. "90 mm" for a column.', "as drawn"),
]
FontOption = Annotated[
    float | None, option("--font", "POINTS", "Size of the figures' text [pt].", "9")
]
OutputFolder = Annotated[Path, option("--output -o", "DIR", "Folder for what is written.", "here")]
WorkersOption = Annotated[
    int | None, option("--workers -w", "N", "Processes; 1: none extra.", "all cores")
]
SchedulerOption = Annotated[
    str | None,
    option(
        "--scheduler", "ADDRESS",
        "Dask scheduler to compute on, e.g. tcp://host:8786 (extra: cluster).",
    ),
]  # fmt: skip
ModelOption = Annotated[
    str | None, option("--model -m", "NAME", "Only this thermal model: isothermal or thd.", OWN)
]
ClearanceOption = Annotated[
    str | None,
    option(
        "--clearance -c", "LENGTH",
        'Only this radial clearance, e.g. "100 um"; `solve` takes any.', OWN,
    ),
]  # fmt: skip
LoadOption = Annotated[
    str | None,
    option(
        "--load", "FORCE", 'This static load in its place, e.g. "12 kN".',
        f"{OWN} load or eccentricity ratio",
    ),
]  # fmt: skip
SupplyTemperatureOption = Annotated[
    str | None,
    option(
        "--supply-temperature", "TEMPERATURE",
        'This temperature of the supplied oil, e.g. "45 degC".', OWN,
    ),
]  # fmt: skip
SpeedOption = Annotated[
    str | None, option("--speed -s", "SPEED", 'Only this speed, e.g. "15000 rpm".', OWN)
]
FolderOption = Annotated[
    Path | None, option("--output -o", "DIR", "Write figures (PNG, SVG) and maps (netCDF) here.")
]
MassOption = Annotated[
    str | None, option("--mass", "MASS", 'Rotor mass per bearing, e.g. "1200 kg".', OWN, ROTOR)
]


def positive(text: str | None, kind: str, key: str, example: str) -> float | None:
    """Return the value [SI] of the option `key`, above 0; None where it is not given."""
    from ..units import parse_quantity

    if text is None:
        return None
    value = parse_quantity(text, kind, key=key, example=example)
    if value <= 0.0:
        raise InputError("must be above 0", key=key, value=text)
    return value


def ask_figure_files(formats: str | None, width: str | None, font: float | None) -> None:
    """Write figures as the options say."""
    if formats is None and width is None and font is None:
        return
    from ..show.figures.style import FORMATS, FigureFiles, ask_figures

    chosen = tuple(part.strip().lower().lstrip(".") for part in (formats or "").split(",") if part)
    if formats is not None and (not chosen or any(one not in FORMATS for one in chosen)):
        raise InputError(
            f"must be some of {', '.join(FORMATS)}, with commas between", key="--format",
            value=formats,
        )  # fmt: skip
    metres = positive(width, "length", "--width", "90 mm")
    if metres is not None and not 0.02 <= metres <= 2.0:
        raise InputError("must lie from 20 mm to 2 m", key="--width", value=width)
    if font is not None and not 2.0 <= font <= 40.0:
        raise InputError("must lie from 2 to 40 points", key="--font", value=font)
    inches = None if metres is None else metres / 0.0254
    ask_figures(FigureFiles(chosen or None, inches, font))


def asked_scenario(
    scenario: Scenario, clearance: str | None, load: str | None, supply_temperature: str | None
) -> Scenario:
    """Return the scenario with what the options ask for, which it need not list."""
    from ..units import parse_quantity

    changes = {}
    for key, name, text, kind, example in (
        ("--clearance", "radial_clearance", clearance, "length", "100 um"),
        ("--load", "load", load, "force", "10 kN"),
        (
            "--supply-temperature", "supply_temperature", supply_temperature, "temperature",
            "40 degC",
        ),
    ):  # fmt: skip
        if text is not None:
            value = parse_quantity(text, kind, key=key, example=example)
            if value < 0.0 or (value == 0.0 and name != "load"):
                raise InputError(f'must be above 0, for example "{example}"', key=key, value=text)
            changes[name] = value
    if not changes:
        return scenario
    return scenario.replace(**changes, orbit=None, stability=None, tolerances=None)


def wanted_cases(scenario: Scenario, model: str | None) -> list[Case]:
    """Return the cases of `scenario` that the option ``--model`` leaves."""
    models = scenario.thermal_models if model is None else (model,)
    return [scenario.case(one, kind) for kind in models for one in scenario.radial_clearances]


def wanted_clearance(scenario: Scenario, text: str) -> float:
    """Return the clearance [m] of ``--clearance``, which the scenario must list."""
    from ..units import parse_quantity

    value = parse_quantity(text, "length", key="--clearance", example="100 um")
    listed = scenario.radial_clearances
    if not any(math.isclose(value, one, rel_tol=1e-6) for one in listed):
        allowed = ", ".join(f"{one * 1e6:g} um" for one in listed)
        raise InputError(
            f"must be one that the scenario lists in bearing.radial_clearance: {allowed}; "
            "add it there to run it",
            key="--clearance",
            value=text,
        )
    return value


def wanted_speeds(scenario: Scenario, speed: str | None) -> list[float]:
    """Return the scenario's speeds [rad/s], or the one of ``--speed`` (any, within it or not)."""
    value = positive(speed, "speed", "--speed", "15000 rpm")
    return [float(one) for one in scenario.speeds] if value is None else [value]


def check_workers(workers: int | None) -> None:
    """Refuse a number of processes below 1."""
    if workers is not None and workers < 1:
        raise InputError("must be 1 or more", key="--workers", value=workers)


def check_file(path: Path, suffix: str = "", source: Path | None = None) -> None:
    """Refuse, before any work is done, a file that could not or must not be written.

    path : What would be written.
    suffix : How its name must end, ``.nc`` for example.
    source : The input, which no output may replace.
    Raises InputError: It is a directory or a device, ends otherwise than in `suffix`, is the input
        itself, or its folder cannot be made or written to.
    """
    if path.is_dir() or not path.name:
        raise InputError("is a directory; give a file", key="--output", value=str(path))
    if path.suffix.lower() != suffix and suffix:
        example = path.with_suffix(suffix)
        raise InputError(
            f'must end in {suffix}; write for example "{example}"', key="--output", value=str(path)
        )
    if source is not None and path.exists() and source.exists() and path.samefile(source):
        raise InputError(
            "is the input itself and would be lost; give another file", key="--output",
            value=str(path),
        )  # fmt: skip
    if path.exists() and not path.is_file():
        raise InputError("is no ordinary file", key="--output", value=str(path))
    check_folder(path.parent)


def check_folder(folder: Path) -> None:
    """Refuse a folder that cannot be made or written to."""
    there = next(one for one in (folder, *folder.absolute().parents) if one.exists())
    try:
        # Permissions alone do not tell: try, where the first new entry would go.
        with TemporaryFile(dir=there):
            pass
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"cannot be written to: {there}: {reason}", key="--output", value=str(folder)
        ) from None


def given_table(
    output: Output, path: Path, bearing: str | None = None, load_direction: float | None = None
) -> CoefficientTable:
    """Return the table at `path`, and say what its reader left out or took for granted."""
    from ..files.formats import read_table

    table = read_table(path, bearing=bearing, load_direction=load_direction)
    for text in table.notes:
        output.warn(f"{path}: {text}")
    return table


@contextmanager
def cluster(address: str | None, output: Output) -> Iterator[Executor | None]:
    """Return the executor on the Dask scheduler at `address`; None where there is no address."""
    if address is None:
        yield None
        return
    try:
        client_class = import_module("distributed").Client
        import_module("dask").config.set({"distributed.comm.timeouts.connect": f"{_PATIENCE:g} s"})
    except ImportError:
        raise InputError(
            'needs the extra "cluster": python -m pip install "rotorsim[cluster]"',
            key="--scheduler",
        ) from None
    # What Dask says of lost connections, tracebacks included, is said in one line here.
    for name in tuple(logging.root.manager.loggerDict):
        if name.partition(".")[0] in ("distributed", "tornado", "asyncio"):
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        client = client_class(address, timeout=f"{_PATIENCE:g} s")
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f"no scheduler answers ({error})", key="--scheduler", value=address
        ) from None
    with client, _workers_awaited(client, address, output):
        yield client.get_executor()


@contextmanager
def _workers_awaited(client: Any, address: str, output: Output) -> Iterator[None]:
    """Print a note when the scheduler has no worker for some time; one may still come."""
    ended = threading.Event()

    def look() -> None:
        said = False
        while not ended.wait(_PATIENCE):
            missing = not client.scheduler_info().get("workers")
            if missing and not said:
                output.warn(f"{address} has no worker; one is started by: dask worker {address}")
            said = missing

    watch = threading.Thread(target=look, daemon=True)
    watch.start()
    try:
        yield
    finally:
        ended.set()
        watch.join(1.0)


def table_path(scenario: Path, folder: Path) -> Path:
    """Return ``coefficients/NAME.nc`` in `folder`."""
    return folder / "coefficients" / f"{scenario.stem}.nc"


def journal_path(table: Path) -> Path:
    """Return the journal of the sweep that makes `table`, next to it."""
    return table.with_name(table.name + ".journal")
