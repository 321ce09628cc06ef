"""The commands, put together."""

from __future__ import annotations

from typing import Annotated

import typer

from .. import __version__
from .control_command import control
from .explore_command import explore
from .file_commands import export, new, view
from .film_commands import check, report, run, solve, table
from .orbit_command import orbit
from .output import WRONG_INPUT, Output, guarded
from .stability_command import stability
from .study_command import study
from .transient_command import transient

app: typer.Typer = typer.Typer(
    name="rotorsim",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["--help", "-h"]},
    rich_markup_mode="rich",
)


def _version(wanted: bool) -> None:
    if wanted:
        print(f"rotorsim {__version__}")
        raise typer.Exit


@app.callback()
def root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Rotors on hydrodynamic bearings: from drawing and oil to a stability verdict.

    Exit codes: 0 done; 1 ran, but something did not converge (what and where is said, the rest is
    kept); 2 the input is wrong (file, key, value and what is allowed are said).

    Example: rotorsim run scenarios/dal.toml
    """


for command in (
    run,
    check,
    solve,
    table,
    stability,
    control,
    orbit,
    transient,
    study,
    report,
    explore,
    view,
    export,
    new,
):
    app.command()(guarded(command))


@app.command(
    hidden=True, context_settings={"ignore_unknown_options": True, "allow_extra_args": True}
)
def reproduce() -> None:
    """Name what replaced this command."""
    Output().complain("reproduce has left the program; the paper is now: python examples/dal_paper")
    raise typer.Exit(WRONG_INPUT)
