"""Commands from the table on: stability."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import InputError
from .film_commands import computed_table
from .inputs import table_path, wanted_mass
from .options import (
    SchedulerOption,
    WorkersOption,
    file_or_shipped,
)
from .output import DONE, INCOMPLETE, Output

if TYPE_CHECKING:
    from ..scenario import Scenario
    from ..table import CoefficientTable


def stability(
    output: Output,
    source: Annotated[
        Path,
        typer.Argument(
            metavar="TABLE-or-SCENARIO",
            help="Table (netCDF, CSV, ROSS), or scenario.",
            callback=file_or_shipped,
        ),
    ],
    mass: Annotated[
        str | None,
        typer.Option(
            "--mass",
            metavar="MASS",
            help='Rotor mass per bearing, e.g. "1200 kg".',
            show_default="the scenario's",
        ),
    ] = None,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
) -> int:
    """Critical mass, whirl ratio, eigenvalues and threshold speeds.

    Example: rotorsim stability coefficients/dal.nc --mass "1200 kg"
    """
    from ..pipeline.stability import stability_curves

    wanted = wanted_mass(mass)
    scenario, table = _table_of(output, source, workers, scheduler)
    if wanted is None and scenario is not None and scenario.rotor is not None:
        wanted = scenario.rotor.mass
    curves = stability_curves(table, wanted)
    output.document(
        {
            "mass": wanted,
            "curves": [
                {
                    **curve.choices,
                    **{
                        field.name: getattr(curve, field.name)
                        for field in dataclasses.fields(curve)
                        if field.name not in ("choices", "mass")
                    },
                    "decay_rate": curve.decay_rate,
                }
                for curve in curves
            ],
        }
    )
    if not (output.json or output.quiet):
        from .stability_tables import curve_table, summary_table

        output.show(*(curve_table(curve) for curve in curves))
        output.show(summary_table(curves))
    bad = int((~table.converged).sum())
    if bad:
        output.warn(f"{bad} of {table.converged.size} points of the table are not converged")
    return INCOMPLETE if bad else DONE


def _table_of(
    output: Output, source: Path, workers: int | None, scheduler: str | None
) -> tuple[Scenario | None, CoefficientTable]:
    """Table at `source`, with the scenario it was made from where that is known."""
    from ..interchange import is_table, read_table
    from ..scenario import Scenario, load_scenario

    if is_table(source):
        table = read_table(source)
        text = table.dataset.attrs.get("scenario")
        if not text:
            return None, table
        try:
            return Scenario.from_text(str(text), source=source), table
        except InputError as error:
            output.note(f"the table's scenario cannot be read here, so give --mass: {error}")
            return None, table
    scenario = load_scenario(source)
    path = table_path(source, Path())
    _, table = computed_table(output, scenario, path, workers, scheduler)
    output.note(f"the table is in {path}")
    return scenario, table
