"""The page with sliders."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import InputError
from .options import file_or_shipped
from .output import DONE, Output


def explore(
    output: Output,
    scenario: Annotated[
        Path,
        typer.Argument(
            metavar="SCENARIO",
            help="Where the sliders begin: a bearing's scenario, or the name of a shipped one.",
            callback=file_or_shipped,
        ),
    ] = Path("dal"),
    port: Annotated[int, typer.Option("--port", min=1024, max=65535, help="Of the page.")] = 8090,
    browser: Annotated[bool, typer.Option(help="Open the page in the browser.")] = True,
) -> int:
    """Open a local page: sliders for bearing, oil and rotor, results that follow them.

    The page is served to this machine alone until Ctrl-C. Needs the extra `explore`.

    Example: rotorsim explore scenarios/dal.toml
    """
    from ..files.scenario import load_scenario
    from ..rows import units_shown
    from ..show.explore import serve
    from .machine_commands import is_machine

    if is_machine(scenario):
        raise InputError(
            "describes a machine: explore its bearings one by one, by their own scenarios",
            source=str(scenario),
        )
    loaded = load_scenario(scenario)
    output.note(f"{loaded.title}: http://127.0.0.1:{port} (end with Ctrl-C)")
    serve(loaded, port=port, units=units_shown(), browser=browser)
    return DONE
