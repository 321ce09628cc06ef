"""The report."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .film_commands import computed_table, report_points
from .inputs import check_file, table_path
from .options import ScenarioArgument, SchedulerOption, WorkersOption
from .output import INCOMPLETE, Output


def report(
    output: Output,
    scenario: ScenarioArgument,
    file: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="FILE", help="The page.", show_default="reports/NAME.html"
        ),
    ] = None,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
) -> int:
    """Write one HTML page to attach to a design review: inputs, warnings, results, margins.

    It holds its figures, needs no network and prints well. The table is kept in coefficients/.

    Example: rotorsim report scenarios/quick.toml -o quick.html
    """
    from ..files.scenario import load_scenario
    from ..show.report import write_report
    from ..study.main_job import compute

    loaded = load_scenario(scenario)
    page = file or Path("reports") / f"{scenario.stem}.html"
    check_file(page, ".html", scenario)
    table = table_path(scenario, Path())
    points, coefficients = computed_table(output, loaded, table, workers, scheduler)
    results = compute(loaded, points, coefficients, output.note)
    output.note("report")
    path = write_report(results, page)
    output.document({"report": path, "table": table, "problems": results.problems})
    output.show(f"{path} is written; open it in a browser")
    code = report_points(output, points)
    for problem in results.problems:
        output.complain(problem)
    return INCOMPLETE if results.problems else code
