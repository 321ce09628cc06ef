"""Commands up to the coefficient table: check, solve, table."""

from __future__ import annotations

import dataclasses
from collections import Counter
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError, TableError
from ..status import SolveStatus
from .options import (
    ClearanceOption,
    LoadOption,
    ModelOption,
    OutputFolder,
    ScenarioArgument,
    SchedulerOption,
    SpeedOption,
    SupplyTemperatureOption,
    WorkersOption,
    asked_scenario,
    check_file,
    check_workers,
    cluster,
    file_or_shipped,
    journal_path,
    option,
    table_path,
    wanted_cases,
    wanted_speeds,
)
from .output import DONE, INCOMPLETE, Output, film_progress

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..bearing.operating_point import OperatingPoint
    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario
    from ..study.measured import Measured


_MANY = 4
"""Points from which on a list is shown instead of each in full."""


def check(output: Output, scenario: ScenarioArgument) -> int:
    """Validate a scenario; show what would run, derived numbers and warnings.

    Example: rotorsim check scenarios/dal.toml
    """
    from .machine_commands import check_machine, is_machine

    if is_machine(scenario):
        return check_machine(output, scenario)
    from ..bearing.checks import derived_numbers, regime_warnings
    from ..bearing.drawing import drawing_numbers, drawing_warnings, heating_warnings
    from ..files.scenario import load_scenario

    loaded = load_scenario(scenario)
    top = float(loaded.speeds[-1])
    mass = None if loaded.rotor is None else loaded.rotor.total_mass
    cases: list[dict[str, Any]] = []
    warnings: list[str] = []
    for case in loaded.cases():
        cases.append(
            {
                "thermal_model": case.thermal.model,
                "radial_clearance": case.bearing.radial_clearance,
                "speed": top,
                "supply_temperature": case.thermal.supply_temperature,
                **dataclasses.asdict(drawing_numbers(case, mass)),
                **dataclasses.asdict(derived_numbers(case, top)),
            }
        )
        said = (
            *drawing_warnings(case, mass),
            *regime_warnings(case, top),
            *heating_warnings(case, top),
        )
        warnings += [text for text in said if text not in warnings]
    output.document(
        {
            "scenario": scenario,
            "title": loaded.title,
            "sha256": loaded.sha256,
            "points": len(cases) * len(loaded.speeds),
            "speeds": loaded.speeds,
            "cases": cases,
            "warnings": warnings,
        }
    )
    if not (output.json or output.quiet):
        from .tables import overview

        output.show(*overview(loaded, cases))
    for text in warnings:
        output.warn(text)
    return DONE


def solve(
    output: Output,
    scenario: ScenarioArgument,
    speed: SpeedOption = None,
    clearance: ClearanceOption = None,
    model: ModelOption = None,
    load: LoadOption = None,
    supply_temperature: SupplyTemperatureOption = None,
    workers: WorkersOption = None,
) -> int:
    """Solve operating points: pressure, temperature, forces, K, C, stability.

    Example: rotorsim solve scenarios/dal.toml --speed "15000 rpm" --clearance "100 um" --json
    """
    from ..bearing.operating_point import point_to_dict
    from ..files.scenario import load_scenario
    from ..study.sweep import sweep_points

    loaded = load_scenario(scenario)
    loaded = asked_scenario(loaded, clearance, load, supply_temperature)
    cases = wanted_cases(loaded, model)
    speeds = wanted_speeds(loaded, speed)
    total = len(cases) * len(speeds)
    check_workers(workers)
    if workers is None and total < _MANY:
        workers = 1  # starting another process takes longer than the work
    with film_progress(output, total) as progress:
        points = sweep_points(cases, speeds, workers=workers, progress=progress)
    output.document({"points": [point_to_dict(point) for point in points]})
    if not (output.json or output.quiet):
        from .tables import point_table, points_tables

        if total < _MANY:
            output.show(*(point_table(point) for point in points))
        else:
            output.show(loaded.title, *points_tables(points))
    return _report_points(output, points)


def table(
    output: Output,
    scenario: ScenarioArgument,
    file: Annotated[
        Path | None, option("--output -o", "FILE", "The table.", "coefficients/NAME.nc")
    ] = None,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
) -> int:
    """Compute the speed-indexed coefficient table (netCDF). Interrupted, it resumes.

    Example: rotorsim table scenarios/dal.toml -o coefficients/dal.nc
    """
    from ..bearing.operating_point import point_to_dict
    from ..files.scenario import load_scenario

    loaded = load_scenario(scenario)
    path = file or table_path(scenario, Path())
    points, _ = computed_table(output, loaded, path, workers, scheduler)
    counts = Counter(point.status.value for point in points)
    output.document(
        {"table": path, "counts": counts, "points": [point_to_dict(point) for point in points]}
    )
    said = ", ".join(f"{count} {status}" for status, count in counts.items())
    output.show(f"{len(points)} points ({said}) in {path}")
    return _report_points(output, points)


def computed_table(
    output: Output,
    scenario: Scenario,
    path: Path,
    workers: int | None = None,
    scheduler: str | None = None,
) -> tuple[list[OperatingPoint], CoefficientTable]:
    """Return the points and table of `scenario`, saved to `path`; a journal next to it until then.

    A table there that agrees is left as it is. While points have failed the journal stays, to be
    resumed from, and so does an older table without such points.
    """
    from ..study.finished import Journal
    from ..study.sweep import as_table, sweep_points

    check_workers(workers)
    check_file(path, ".nc", scenario.source)
    journal = journal_path(path)
    cases = list(scenario.cases())
    before = len(Journal(journal))
    if before:
        output.note(f"resuming: {before} points are in {journal}")
    with (
        cluster(scheduler, output) as executor,
        film_progress(output, len(cases) * len(scenario.speeds)) as progress,
    ):
        output.kept.append(f"finished points are in {journal}; the same command resumes there")
        points = sweep_points(
            cases,
            [float(speed) for speed in scenario.speeds],
            executor=executor,
            workers=workers,
            progress=progress,
            resume=journal,
        )
    made = as_table(points, scenario)
    failed = sum(point.status is SolveStatus.FAILED for point in points)
    old = _table_at(path)
    if failed and old is not None and not (old.dataset["status"] == str(SolveStatus.FAILED)).any():
        output.warn(
            f"{failed} points failed: {path} is left as it was, and the same command tries them "
            f"again; the others are kept in {journal}"
        )
        return points, made
    if old is not None and made.agrees_with(old):
        output.note(f"{path} holds these numbers already and is left as it was")
    else:
        made.save(path)
    if failed:
        output.warn(f"{failed} points failed: the same command tries them again")
    else:
        journal.unlink(missing_ok=True)
    output.kept[-1] = f"the table is in {path}"
    return points, made


def _table_at(path: Path) -> CoefficientTable | None:
    """Return the table there, if a usable one is."""
    from ..bearing.table import CoefficientTable

    with suppress(TableError):
        return CoefficientTable.load(path)
    return None


def _report_points(output: Output, points: Sequence[OperatingPoint]) -> int:
    """Report what did not converge and what left the model's range; return the exit code."""
    from ..bearing.description import grouped_warnings, point_title

    bad = [point for point in points if not point.converged]
    for point in bad[:5]:
        output.warn(f"{point_title(point)}: {point.message}")
    if len(bad) > 5:
        output.warn(f"and {len(bad) - 5} more points that are not converged")
    for text in grouped_warnings(points):
        output.warn(text)
    return INCOMPLETE if bad else DONE


_MeasuredOption = Annotated[
    Path | None,
    option("--measured", "FILE", "CSV of measured points, drawn over the curves.", "none"),
]


def run(
    output: Output,
    scenario: ScenarioArgument,
    folder: OutputFolder = Path(),
    measured: _MeasuredOption = None,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
) -> int:
    """Do the whole job: coefficients, stability map, orbits, figures, recording, summary.

    Example: rotorsim run scenarios/dal.toml
    """
    from .machine_commands import is_machine, run_machine

    if is_machine(scenario):
        _not_of_machines(measured)
        return run_machine(output, scenario, folder, workers)
    from ..compiled import is_kept
    from ..files.scenario import load_scenario
    from ..film.rupture.reynolds import active_set
    from ..show.job import write_results
    from ..study.main_job import compiled_ahead, compute, summary

    loaded, seen = load_scenario(scenario), _measured(measured)
    name = scenario.stem
    count = len(loaded.radial_clearances) * len(loaded.thermal_models) * len(loaded.speeds)
    output.note(f"{loaded.title}: {count} film points")
    if not is_kept(active_set):
        output.note("first run: numerical code is compiled now, which can take a minute")
    path = table_path(scenario, folder)
    with compiled_ahead(loaded):
        points, table = computed_table(output, loaded, path, workers, scheduler)
    results = replace(compute(loaded, points, table, output.note), measured=seen)
    files, problems = write_results(results, folder, name, output.note)
    problems = [*results.problems, *problems]
    said = summary(results, {"coefficients": [path], **files}) | {"problems": problems}
    output.document(said)
    if not (output.json or output.quiet):
        from .tables import closing

        output.show(*closing(said, results))
    code = _report_points(output, points)
    for problem in problems:
        output.complain(problem)
    return INCOMPLETE if problems else code


def _measured(path: Path | None) -> tuple[Measured, ...]:
    from ..study.measured import read_measured

    return () if path is None else read_measured(path)


def _not_of_machines(path: Path | None) -> None:
    if path is not None:
        raise InputError("goes with a bearing's scenario", key="--measured", value=path)


def report(
    output: Output,
    scenario: ScenarioArgument,
    file: Annotated[
        Path | None, option("--output -o", "FILE", "The page.", "reports/NAME.html")
    ] = None,
    against: Annotated[
        Path | None,
        option(
            "--against",
            "SCENARIO",
            "Compare with another one of its kind.",
            "none",
            callback=lambda path: path and file_or_shipped(path),
        ),
    ] = None,
    pdf: Annotated[
        bool, typer.Option("--pdf", help="Print it as PDF too (needs Chromium, Chrome or Edge).")
    ] = False,
    measured: _MeasuredOption = None,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
) -> int:
    """Write one HTML page to attach to a design review: inputs, warnings, results, margins.

    It holds its figures, needs no network and prints well. The table is kept in coefficients/.

    Example: rotorsim report scenarios/quick.toml -o quick.html
    """
    from .machine_commands import is_machine, report_machine

    page = file or Path("reports") / f"{scenario.stem}.html"
    check_file(page, ".html", scenario)
    if pdf:
        from ..show.report.pdf import browser

        browser()
    if against is not None and is_machine(against) != is_machine(scenario):
        raise InputError(
            "must be of the same kind: a machine's file, or a bearing's", key="--against",
            value=against,
        )  # fmt: skip
    if is_machine(scenario):
        _not_of_machines(measured)
        return report_machine(output, scenario, page, workers, against, pdf)
    from ..files.scenario import load_scenario
    from ..show.report import write_report
    from ..show.report.pdf import write_pdf
    from ..study.main_job import compute

    loaded, seen = load_scenario(scenario), _measured(measured)
    table = table_path(scenario, Path())
    points, coefficients = computed_table(output, loaded, table, workers, scheduler)
    results = replace(compute(loaded, points, coefficients, output.note), measured=seen)
    other = None
    if against is not None:
        second = load_scenario(against)
        output.note(f"compared with {second.title}")
        found = computed_table(output, second, table_path(against, Path()), workers, scheduler)
        other = compute(second.replace(orbit=None), *found, output.note)
    output.note("report")
    path = write_report(results, page, other)
    printed = {"pdf": write_pdf(path)} if pdf else {}
    output.document({"report": path, "table": table, "problems": results.problems} | printed)
    output.show(f"{path} is written; open it in a browser")
    code = _report_points(output, points)
    for problem in results.problems:
        output.complain(problem)
    return INCOMPLETE if results.problems else code
