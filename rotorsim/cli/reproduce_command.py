"""A paper, computed again claim by claim: reproduce."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .film_commands import report_points
from .inputs import check_folder, check_workers
from .options import OutputFolder, WorkersOption
from .output import Output

if TYPE_CHECKING:
    from rich.table import Table

    from ..reproduce import Assessment


class Paper(StrEnum):
    """Papers that can be reproduced."""

    DAL = "dal"


def reproduce(
    output: Output,
    paper: Annotated[Paper, typer.Argument(metavar="PAPER", help="The paper: dal.")],
    folder: OutputFolder = Path(),
    coarse: Annotated[
        bool, typer.Option("--coarse", help="Half the mesh: quicker, for a first look.")
    ] = False,
    docs: Annotated[
        Path | None,
        typer.Option(
            "--docs", metavar="DIR", help="Refresh the documentation page in this folder as well.",
            show_default=False,
        ),
    ] = None,
    workers: WorkersOption = None,
) -> int:  # fmt: skip
    """Recompute a paper's figures and tables; judge every claim. Writes PAPER.html and CSV files.

    Example: rotorsim reproduce dal --output reproduced
    """
    from ..reproduce import assess, compute, paper_study, write_docs, write_page
    from ..reproduce.paper import COARSE_MESH, PAPER_MESH
    from ..reproduce.writing import document
    from .progress import film_progress

    check_workers(workers)
    check_folder(folder)
    study = paper_study(COARSE_MESH if coarse else PAPER_MESH)
    output.note(f"{paper.value}: {study.size} film points")
    with film_progress(output, study.size) as progress:
        results = compute(study, workers=workers, progress=progress)
    assessment = assess(results)
    output.note("figures and page")
    files = write_page(results, assessment, folder)
    if docs is not None:
        files += write_docs(results, assessment, docs)
    output.document(document(results, assessment, files))
    if not (output.json or output.quiet):
        output.show(verdict_table(assessment), "\n".join(f"wrote {path}" for path in files))
    return report_points(output, results.points())


def verdict_table(assessment: Assessment) -> Table:
    """Verdicts by kind of comparison."""
    from rich.table import Table

    from ..reproduce.claim import Kind, Verdict

    table = Table("compared", *(verdict.value for verdict in Verdict))
    for kind in Kind:
        table.add_row(kind.value, *(str(number) for number in assessment.count(kind).values()))
    return table
