"""The commands check, stability and run on a machine file."""

from __future__ import annotations

from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..rows import RPM, number
from ..study import machine_tables as tables
from .output import DONE, INCOMPLETE, Output, film_progress
from .tables import grid

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rich.table import Table

    from ..files.machine import MachineFile
    from ..study.machine import MachineResult
    from ..study.sensitivity import Sensitivity


def check_machine(output: Output, path: Path) -> int:
    """Validate a machine file and say what would run."""
    from ..bearing.drawing import STANDARD_GRAVITY
    from ..files.machine import load_machine

    loaded = load_machine(path)
    rotor, beam = loaded.rotor_with_unbalance(), loaded.rotor.beam
    speeds = loaded.operating.speeds
    names = loaded.support_names
    document = {
        "machine": path,
        "title": loaded.title,
        "length": beam.length,
        "mass": rotor.total_mass,
        "nodes": len(rotor.nodes),
        "discs": len(beam.discs),
        "supports": [
            {"name": name, "at": entry.at, "kind": _kind(entry)}
            for name, entry in zip(names, loaded.support, strict=True)
        ],
        "speeds": list(speeds),
    }
    output.document(document)
    if not (output.json or output.quiet):
        table = grid(loaded.title, "", "")
        table.add_row("shaft", f"{number(beam.length * 1e3)} mm, {len(rotor.nodes)} nodes")
        weight = rotor.total_mass * STANDARD_GRAVITY / 1e3
        table.add_row("mass of the rotor", f"{number(rotor.total_mass)} kg ({number(weight)} kN)")
        table.add_row("discs and added masses", str(len(beam.discs)))
        table.add_row(
            "speeds", f"{len(speeds)}, {speeds[0] * RPM:.0f} to {speeds[-1] * RPM:.0f} rpm"
        )
        supports = grid("Supports", "name", "at mm", "kind")
        for name, entry in zip(names, loaded.support, strict=True):
            supports.add_row(name, number(entry.at * 1e3), _kind(entry))
        output.show(table, supports)
    if not loaded.support:
        output.warn("the rotor is free: the file has no [[support]]")
    return DONE


def _kind(entry: Any) -> str:
    given = entry.bearing or entry.coefficients
    return f"{given}{' on a pedestal' if entry.pedestal else ''}" if given else "constants"


def machine_stability(output: Output, path: Path, workers: int | None) -> int:
    """Show modes, critical speeds, thresholds and verdict of a machine."""
    from ..study.machine import stability_document

    results = _analysed(output, path, workers)
    output.document(stability_document(results))
    if not (output.json or output.quiet):
        output.show(*_stability_tables(results))
    return _closing(output, results)


def run_machine(output: Output, path: Path, folder: Path, workers: int | None) -> int:
    """Do the whole job on a machine: films, modes, response, checks, maps, figures, recording."""
    from ..bearing.netcdf import write
    from ..show.job import plane_figures, save_figures
    from ..show.machine_job import write_machine_figures
    from ..show.recording.machine import write_machine_recording
    from ..study.lateral import lateral_document, lateral_study, response_document
    from ..study.machine import stability_document, supports_document
    from ..study.machine_map import map_of_entry
    from ..study.sensitivity import sensitivities
    from .stability_results import plane_document, plane_table

    results = _analysed(output, path, workers)
    last = results[next(reversed(results))]
    study = lateral_study(last)
    moving = sensitivities(last, workers)
    pictures = folder / "figures" / path.stem
    files: dict[str, Any] = {"figures": write_machine_figures(results, study, pictures)}
    planes = []
    for number_, entry in enumerate(last.description.map, start=1):
        output.note(f"map over {entry.x} and {entry.y}")
        plane = map_of_entry(last.description, entry, workers=workers)
        planes.append(plane)
        named = [(f"map_{number_}", one) for _, one in plane_figures(plane, last.description.title)]
        files["figures"] += save_figures(named, pictures)
        files.setdefault("maps", []).append(write(plane.dataset, pictures / f"map_{number_}.nc"))
    output.note("recording")
    files["recording"] = [write_machine_recording(results, folder / "logs" / f"{path.stem}.rrd")]
    output.document(
        stability_document(results)
        | {
            "sensitivities": [vars(one) for one in moving],
            "supports": supports_document(last),
            "unbalance_response": response_document(study, last.description.operating.continuous),
            "lateral": lateral_document(study),
            "maps": [plane_document(one) for one in planes],
            "files": files,
        }
    )
    if not (output.json or output.quiet):
        output.show(*map(_grid, tables.support_rows(results)), *_stability_tables(results))
        output.show(*map(_grid, (*tables.peak_rows(study), *tables.check_rows(study))))
        output.show(*_sensitivity_tables(moving))
        for plane in planes:
            output.show(*plane_table(plane))
        output.note(f"figures: {pictures}; recording: {files['recording'][0]}")
    for text in study.notes:
        output.warn(text)
    code = _closing(output, results)
    return INCOMPLETE if any(one.failed_points for one in planes) else code


def report_machine(output: Output, path: Path, page: Path, workers: int | None) -> int:
    """Write the report of a machine."""
    from ..show.report.machine import write_machine_report
    from ..study.lateral import lateral_study

    results = _analysed(output, path, workers)
    study = lateral_study(results[next(reversed(results))])
    output.note("report")
    written = write_machine_report(results, study, page)
    output.document({"report": written, "notes": list(study.notes)})
    output.show(f"{written} is written; open it in a browser")
    return _closing(output, results)


def _sensitivity_tables(moving: Sequence[Sensitivity]) -> Iterator[Table]:
    if not moving:
        return
    head = ("bearing or place", "parameter", "changed by", "threshold rpm", "growth 1/s")
    table = grid("What moves the stability threshold", *head)
    for one in moving:
        moved = one.threshold_change
        table.add_row(
            one.support, one.parameter.replace("_", " "), _change(one),
            "-" if moved is None else f"{moved * RPM:+.0f}", f"{one.growth_rate_change:+.3g}",
        )  # fmt: skip
    yield table


def _change(one: Sensitivity) -> str:
    if one.parameter == "supply_temperature":
        return f"{one.change:+g} K"
    if one.parameter == "destabilising_stiffness":
        return f"{one.change / 1e6:+.3g} MN/m"
    return f"{one.change:+g}" if one.parameter == "preload" else f"{one.change / one.value:+.0%}"


def _grid(rows: tables.Rows) -> Table:
    table = grid(rows.title, *rows.head)
    if rows.head[0] == "check":
        table.columns[0].no_wrap = False
    for row in rows.rows:
        table.add_row(*row)
    return table


def _stability_tables(results: dict[str, MachineResult]) -> list[Table]:
    rows = zip_longest(tables.least_stable_rows(results), tables.critical_rows(results))
    return [_grid(one) for pair in rows for one in pair if one is not None]


def _analysed(output: Output, path: Path, workers: int | None) -> dict[str, MachineResult]:
    from ..files.machine import load_machine

    return analysed(output, load_machine(path), workers)


def analysed(
    output: Output, loaded: MachineFile, workers: int | None, models: Sequence[str] | None = None
) -> dict[str, MachineResult]:
    """Machine solved with some of its thermal models, with progress."""
    from ..study.machine import analyse_machine, thermal_models

    models = models or thermal_models(loaded)
    total = len(models) * len(loaded.bearings) * len(loaded.operating.speeds)
    output.note(f"{loaded.title}: {total} film points" if total else loaded.title)
    with film_progress(output, total) as progress:
        return analyse_machine(loaded, models, workers=workers, progress=progress)


def _closing(output: Output, results: dict[str, MachineResult]) -> int:
    """Say the verdict and what did not converge; return the exit code."""
    failures = tables.failure_lines(results)
    for text in failures:
        output.warn(text)
    for text in (*tables.verdict_lines(results), *tables.heating_lines(results)):
        output.note(text)
    return INCOMPLETE if failures else DONE


def is_machine(path: Path) -> bool:
    """Whether the file at `path` describes a machine."""
    from ..files.machine import is_machine as described

    return described(path)
