"""The commands check, stability and run on a machine file."""

from __future__ import annotations

from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..rows import RPM, heads, number, shown, with_unit
from ..study import machine_tables as tables
from .drawing import rotor_in_text
from .output import DONE, INCOMPLETE, Output, as_typed, film_progress, progress_bar
from .tables import grid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.table import Table

    from ..files.machine import MachineFile
    from ..orbit.motion import Motion
    from ..study.hot_spot import HotSpotStudy
    from ..study.machine import MachineResult


def check_machine(output: Output, path: Path) -> int:
    """Validate a machine file and say what would run."""
    from ..bearing.drawing import STANDARD_GRAVITY
    from ..files.machine import load_machine
    from ..study.machine import pinned_mesh_change

    loaded = load_machine(path)
    change = pinned_mesh_change(loaded)
    rotor, beam = loaded.rotor_with_unbalance(), loaded.rotor.beam
    speeds = loaded.operating.speeds
    names = loaded.support_names
    kinds = [
        [name, shown(entry.at * 1e3, "mm"), _kind(entry)]
        for name, entry in zip(names, loaded.support, strict=True)
    ]
    document = {
        "machine": path,
        "title": loaded.title,
        "length": beam.length,
        "mass": rotor.total_mass,
        "nodes": len(rotor.nodes),
        "mesh_change": change,
        "discs": len(beam.discs),
        "supports": [
            {"name": name, "at": entry.at, "kind": _kind(entry)}
            for name, entry in zip(names, loaded.support, strict=True)
        ],
        "speeds": list(speeds),
    }
    weight = rotor.total_mass * STANDARD_GRAVITY / 1e3
    rows = {
        "shaft": f"{with_unit(beam.length * 1e3, 'mm')}, {len(rotor.nodes)} nodes",
        "mesh, supports rigid":
            f"twice as many elements move the lowest frequencies by {number(100 * change, 2)} %",
        "mass of the rotor": f"{with_unit(rotor.total_mass, 'kg')} ({with_unit(weight, 'kN')})",
        "discs and added masses": str(len(beam.discs)),
        "speeds": f"{len(speeds)}, {speeds[0] * RPM:.0f} to {speeds[-1] * RPM:.0f} rpm",
    }  # fmt: skip
    supports = grid("Supports", *heads("name", "at mm", "kind"), rows=kinds)
    said = grid(loaded.title, "", "", rows=rows.items())
    output.results(document, lambda: [rotor_in_text(loaded), said, supports])
    _say_free(output, loaded)
    return DONE


def _say_free(output: Output, machine: MachineFile) -> None:
    from ..study.machine import free_motions

    free = free_motions(machine)
    if free:
        why = "no stiffness" if machine.support else "no [[support]]"
        output.warn(
            f"the rotor is free in {free} of the shaft's 4 rigid motions (two displacements, two "
            f"tilts): {why} holds it there"
        )


def _kind(entry: Any) -> str:
    if entry.ring is not None:
        return "floating ring" if entry.ring.turning else "semi-floating ring"
    given = entry.bearing or entry.coefficients or "constants"
    return (
        f"{given}{' on a pedestal' if entry.pedestal else ' in a damper' if entry.damper else ''}"
    )


def machine_stability(output: Output, path: Path, workers: int | None) -> int:
    """Show modes, critical speeds, thresholds and verdict of a machine."""
    from ..study.machine import stability_document

    results = _analysed(output, path, workers)
    spots = _hot_spots(output, results)
    output.results(
        stability_document(results) | _spot_part(spots),
        lambda: [*_stability_tables(results), *map(_grid, tables.spot_rows(spots))],
    )
    return _closing(output, results, spots)


def _hot_spots(output: Output, results: dict[str, MachineResult]) -> HotSpotStudy | None:
    from ..study.hot_spot import hot_spot_study

    try:
        return hot_spot_study(results[next(reversed(results))])
    except InputError as error:  # nothing else is lost by it
        output.warn(f"hot_spot: {error.message}")
        return None


def _spot_part(spots: HotSpotStudy | None) -> dict[str, Any]:
    from ..study.hot_spot import hot_spot_document

    return {} if spots is None else {"hot_spot": hot_spot_document(spots)}


def run_machine(output: Output, path: Path, folder: Path, workers: int | None) -> int:
    """Do the whole job on a machine: films, modes, response, checks, maps, figures, recording."""
    from ..bearing.netcdf import write
    from ..show.job import save_figures
    from ..show.machine_job import write_machine_figures
    from ..show.recording.machine import write_machine_recording
    from ..show.study_figures import plane_figures
    from ..study.lateral import lateral_document, lateral_study, response_document
    from ..study.machine import stability_document, supports_document
    from ..study.machine_map import map_of_entry
    from ..study.sensitivity import sensitivities
    from .stability_results import plane_document, plane_table

    results = _analysed(output, path, workers)
    last = results[next(reversed(results))]
    motion, moved = None, {}
    if last.description.orbit is not None:
        from ..study.machine_motion import simulate
        from ..study.motion_results import motion_document

        output.note("motion in time")
        motion = simulate(last.description, result=last)
        moved = {"motion": motion_document(motion)}
    study, spots = lateral_study(last), _hot_spots(output, results)
    moving = sensitivities(last, workers)
    pictures = folder / "figures" / path.stem
    files: dict[str, Any] = {"figures": write_machine_figures(results, study, pictures, spots)}
    planes = []
    for number_, entry in enumerate(last.description.map, start=1):
        output.note(f"map over {entry.x} and {entry.y}")
        plane = map_of_entry(last.description, entry, workers=workers)
        planes.append(plane)
        named = [(f"map_{number_}", one) for _, one in plane_figures(plane, last.description.title)]
        files["figures"] += save_figures(named, pictures)
        files.setdefault("maps", []).append(write(plane.dataset, pictures / f"map_{number_}.nc"))
    if motion is not None:
        from ..show.machine_job import write_motion

        target = folder / "logs" / f"{path.stem}_motion.rrd"
        recorded, *more = write_motion(last.description, motion, target, pictures, result=last)
        files["motion"], files["figures"] = recorded, files["figures"] + more
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
        | _spot_part(spots)
        | moved
    )
    if not (output.json or output.quiet):
        output.show(*map(_grid, tables.support_rows(results)), *_stability_tables(results))
        output.show(*map(_grid, (*tables.peak_rows(study), *tables.check_rows(study))))
        output.show(*map(_grid, (*tables.spot_rows(spots), *tables.moving_rows(moving))))
        for plane in planes:
            output.show(*plane_table(plane))
        output.note(f"figures: {pictures}; recording: {files['recording'][0]}")
    for text in study.notes:
        output.warn(text)
    code = _closing(output, results, spots)
    return INCOMPLETE if any(one.failed_points for one in planes) else code


def machine_orbit(
    output: Output,
    path: Path,
    recording: Path | None,
    figures: bool,
    animations: list[str],
    steady: bool,
    model: str | None,
) -> int:
    """Simulate a machine in time, record it and say what its stations do."""
    from dataclasses import replace

    from ..files.machine import load_machine
    from ..show.machine_job import write_motion
    from ..study.machine_motion import motion_problem, simulate

    loaded = load_machine(path)
    settings = loaded.orbit
    if settings is not None and model is not None:
        settings = replace(settings, thermal_model=model)
    problem = motion_problem(loaded, settings)
    with progress_bar(output, "motion", problem.drive_turns) as progress:
        motion = simulate(
            loaded, problem=problem,
            consume=lambda piece: progress(float(piece.revolutions[-1])) if piece.t.size else None,
        )  # fmt: skip
    files = write_motion(
        loaded, motion, recording or Path("logs") / f"{path.stem}.rrd",
        Path("figures") / path.stem if figures or animations else None, animations, steady,
    )  # fmt: skip
    return _say_motion(output, motion, files)


def machine_limit_cycles(output: Output, path: Path) -> int:
    """Follow the whirl that begins at a machine's threshold speed, and draw it."""
    from ..files.machine import load_machine
    from ..show.figures.orbits import branch_plot
    from ..show.job import save_figures
    from ..study.limit_cycles import branch_document, limit_cycles

    loaded = load_machine(path)
    branch = limit_cycles(loaded)
    folder = Path("figures") / path.stem
    files = save_figures([("limit_cycles", branch_plot(branch, loaded.title))], folder)
    rows = [
        [f"{branch.speed[i] * RPM:.0f}", number(float(branch.frequency[i] / branch.speed[i]), 3),
         *(shown(float(size) * 1e6, "µm") for size in branch.amplitude[i]),
         "stable" if branch.stable[i] else "unstable"]
        for i in range(0, branch.speed.size, max(1, branch.speed.size // 12))
    ]  # fmt: skip
    names = heads(*(f"{name} µm" for name in branch.names))
    table = grid("Limit cycles", "rpm", "f/rev", *names, "", rows=rows)
    output.results(branch_document(branch) | {"figures": files}, lambda: [table, *map(str, files)])
    if branch.threshold is not None:
        kind = "supercritical" if branch.supercritical else "subcritical"
        output.note(f"{kind} from {branch.threshold * RPM:.0f} rpm; ends with {branch.message}")
    return DONE


def _say_motion(output: Output, motion: Motion, files: list[Path]) -> int:
    from ..study.motion_results import motion_document

    document = motion_document(motion)
    rows = [
        [row["station"], number(row["max_eccentricity_ratio"] if row["film"] else None, 3),
         shown(row["amplitude"] * 1e6, "µm"), number(row["whirl_frequency_ratio"], 3),
         row["status"].replace("_", " ")]
        for row in document["stations"]
    ]  # fmt: skip
    head = heads("station", "max e/c", "amplitude µm", "whirl ratio", "outcome")
    shown_tables = [grid(f"Motion: {document['note']}", *head, rows=rows)]
    if document["actuators"]:
        forces = [
            [one["signal"], number(one["largest_force"]), f"{number(100 * one['saturated'], 2)} %"]
            for one in document["actuators"]
        ]
        head = heads("actuator", "largest force N", "at its limit")
        shown_tables.append(grid("Control", *head, rows=forces))
    said = f"recorded in {files[0]}; look at it: rotorsim view {as_typed(files[0])}"
    output.results(
        document | {"recording": files[0], "figures": files[1:]},
        lambda: [*shown_tables, *map(str, files[1:]), said],
    )
    output.note(
        f"{document['unknowns']} unknowns; eigenvalues changed by the reduction: "
        f"{document['reduction_error']:.1e}"
    )
    if motion.message:
        output.warn(motion.message)
    return INCOMPLETE if motion.status.value == "integration_failed" else DONE


def report_machine(
    output: Output, path: Path, page: Path, workers: int | None, against: Path | None, pdf: bool
) -> int:
    """Write the report of a machine."""
    from ..show.report.machine import write_machine_report
    from ..show.report.pdf import write_pdf
    from ..study.lateral import lateral_study
    from ..study.sensitivity import sensitivities

    results = _analysed(output, path, workers)
    others = None if against is None else _analysed(output, against, workers)
    last = results[next(reversed(results))]
    study, moving = lateral_study(last), sensitivities(last, workers)
    spots = _hot_spots(output, results)
    output.note("report")
    written = write_machine_report(results, study, page, moving, spots=spots, against=others)
    printed = {"pdf": write_pdf(written)} if pdf else {}
    output.document({"report": written, "notes": list(study.notes)} | printed)
    output.show(f"{written} is written; open it in a browser")
    return _closing(output, results, spots)


def _grid(rows: tables.Rows) -> Table:
    table = grid(rows.title, *rows.head, rows=rows.rows)
    if rows.head[0] == "check":
        table.columns[0].no_wrap = False
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
    """Solve a machine with some of its thermal models, with progress."""
    from ..study.machine_analysis import analyse_machine, thermal_models

    models = models or thermal_models(loaded)
    total = len(models) * len(loaded.bearings) * len(loaded.operating.speeds)
    output.note(loaded.title)
    with film_progress(output, total) as progress:
        return analyse_machine(loaded, models, workers=workers, progress=progress)


def _closing(
    output: Output, results: dict[str, MachineResult], spots: HotSpotStudy | None = None
) -> int:
    """Print the verdict and what did not converge; return the exit code."""
    failures = tables.failure_lines(results)
    _say_free(output, results[next(reversed(results))].description)
    for text in failures:
        output.warn(text)
    said = [*tables.verdict_lines(results), *tables.heating_lines(results)]
    said += tables.spot_lines(spots)
    for text in (tables.mesh_line(results[next(reversed(results))]), *said):
        output.note(text)
    return INCOMPLETE if failures else DONE


def is_machine(path: Path) -> bool:
    """Return whether the file at `path` describes a machine."""
    from ..files.machine import is_machine as described

    return described(path)
