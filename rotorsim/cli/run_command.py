"""The main job: run."""

from __future__ import annotations

from pathlib import Path

from .film_commands import computed_table, report_points
from .inputs import table_path
from .options import OutputFolder, ScenarioArgument, SchedulerOption, WorkersOption
from .output import INCOMPLETE, Output


def run(
    output: Output,
    scenario: ScenarioArgument,
    folder: OutputFolder = Path(),
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
) -> int:
    """Do the whole job: coefficients, stability map, orbits, figures, recording, summary.

    Example: rotorsim run scenarios/dal.toml
    """
    from .machine_commands import is_machine, run_machine

    if is_machine(scenario):
        return run_machine(output, scenario, folder, workers)
    from ..files.scenario import load_scenario
    from ..show.job import write_results
    from ..study.main_job import compute, summary

    loaded = load_scenario(scenario)
    name = scenario.stem
    count = len(loaded.radial_clearances) * len(loaded.thermal_models) * len(loaded.speeds)
    output.note(f"{loaded.title}: {count} film points")
    if not _compiled_before():
        output.note("first run: the film kernels are compiled now, which can take a minute")
    path = table_path(scenario, folder)
    points, table = computed_table(output, loaded, path, workers, scheduler)
    results = compute(loaded, points, table, output.note)
    files, problems = write_results(results, folder, name, output.note)
    problems = [*results.problems, *problems]
    said = summary(results, {"coefficients": [path], **files}) | {"problems": problems}
    output.document(said)
    if not (output.json or output.quiet):
        from .summary_table import closing

        output.show(*closing(said, results.curves))
    code = report_points(output, points)
    for problem in problems:
        output.complain(problem)
    return INCOMPLETE if problems else code


def _compiled_before() -> bool:
    """Whether an earlier run left compiled code in the cache."""
    import os

    folder = Path(__file__).parents[1] / "film" / "__pycache__"
    return bool(os.environ.get("NUMBA_CACHE_DIR")) or any(folder.glob("*.nbi"))
