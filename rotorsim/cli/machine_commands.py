"""The commands check, stability and run on a machine file."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..rows import RPM, ZERO_CELSIUS, number
from .output import DONE, INCOMPLETE, Output, film_progress
from .tables import grid

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rich.table import Table

    from ..files.machine import MachineFile
    from ..study.lateral import LateralStudy
    from ..study.machine import MachineResult

_SHOWN_SPEEDS = 12
"""Rows of the tables over speed, at most."""


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
    """Do the whole job on a machine: films, modes, unbalance response, lateral checks, figures."""
    from ..show.machine_job import write_machine_figures
    from ..study.lateral import lateral_document, lateral_study, response_document
    from ..study.machine import stability_document, supports_document

    results = _analysed(output, path, workers)
    last = results[next(reversed(results))]
    study = lateral_study(last)
    pictures = folder / "figures" / path.stem
    files = write_machine_figures(results, study, pictures)
    output.document(
        stability_document(results)
        | {
            "supports": supports_document(last),
            "unbalance_response": response_document(study, last.description.operating.continuous),
            "lateral": lateral_document(study),
            "files": {"figures": files},
        }
    )
    if not (output.json or output.quiet):
        output.show(*_support_tables(results), *_stability_tables(results), *_lateral_tables(study))
        output.note(f"figures: {pictures}")
    for text in study.notes:
        output.warn(text)
    return _closing(output, results)


def _lateral_tables(study: LateralStudy) -> Iterator[Table]:
    for response in study.responses:
        head = ("rpm", "amplitude µm", "AF", "")
        table = grid(f"Unbalance response peaks at {response.name}", *head)
        for peak in response.peaks:
            factor = peak.amplification_factor
            table.add_row(
                f"{peak.speed * RPM:.0f}", number(peak.amplitude * 1e6),
                number(factor, 3) if factor is not None else "-", peak.note,
            )  # fmt: skip
        if table.row_count:
            yield table
    if study.checks:
        edition = study.checks[0].edition
        table = grid(f"Lateral checks ({edition})", "check", "value", "", "limit", "result")
        table.columns[0].no_wrap = False
        for check in study.checks:
            value, limit = (_shown(part, check.unit) for part in (check.value, check.limit))
            word = {True: "passed", False: "FAILED", None: "not judged"}[check.passed]
            table.add_row(f"{check.name}: {check.place}", value, check.comparison, limit, word)
        yield table


def _shown(value: float | None, unit: str) -> str:
    return f"{number(None if value is None else value * 1e6)} µm" if unit == "m" else number(value)


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


def _stability_tables(results: dict[str, MachineResult]) -> Iterator[Table]:
    for model, result in results.items():
        found = result.modes
        if found is None:
            continue
        suffix = "" if len(results) == 1 else f", {model}"
        head = ("rpm", "Hz", "f/rev", "log decrement", "growth 1/s", "whirl", "verdict")
        table = grid(f"Least stable mode{suffix}", *head)
        least, whirl, verdicts = found.least_stable, found.whirl, found.verdicts
        for i in _some(len(result.known)):
            k, speed = int(least[i]), float(result.known[i])
            frequency = float(found.damped_frequency[i, k])
            table.add_row(
                f"{speed * RPM:.0f}", number(frequency / (2.0 * math.pi)),
                number(frequency / speed, 3), number(float(found.logarithmic_decrement[i, k]), 3),
                number(float(found.growth_rate[i, k])), str(whirl[i, k]), str(verdicts[i]),
            )  # fmt: skip
        yield table
        table = grid(f"Critical and threshold speeds{suffix}", "rpm", "kind", "whirl", "")
        for one in result.critical_speeds:
            damping = f"damping ratio {number(one.damping_ratio, 3)}"
            table.add_row(f"{one.speed * RPM:.0f}", "critical speed", one.whirl, damping)
        for one in result.thresholds:
            above = "unstable above" if one.becomes_unstable else "stable above"
            ratio = f"whirl ratio {number(one.whirl_frequency_ratio, 3)}"
            table.add_row(f"{one.speed * RPM:.0f}", f"threshold, {above}", "", ratio)
        if table.row_count:
            yield table


def _support_tables(results: dict[str, MachineResult]) -> Iterator[Table]:
    for model, result in results.items():
        if not any(state.points for state in result.supports):
            continue
        suffix = "" if len(results) == 1 else f", {model}"
        head = ("rpm", "load kN", "direction deg", "e/c", "h min um", "T max degC", "status")
        for state in result.supports:
            if not state.points:
                continue
            table = grid(f"{state.name}{suffix}", *(text.replace("um", "µm") for text in head))
            for i in _some(len(state.points)):
                point = state.points[i]
                table.add_row(
                    f"{point.speed * RPM:.0f}",
                    number(float(np.hypot(*state.load[i])) / 1e3),
                    number(math.degrees(float(state.direction[i])), 3),
                    number(point.eccentricity_ratio), number(point.min_film_thickness * 1e6),
                    number(point.max_temperature - ZERO_CELSIUS), point.status.value,
                )  # fmt: skip
            yield table


def _some(count: int) -> list[int]:
    """Indices of at most so many rows, evenly spread, the first and last among them."""
    if count <= _SHOWN_SPEEDS:
        return list(range(count))
    return [round(i) for i in np.linspace(0, count - 1, _SHOWN_SPEEDS)]


def _closing(output: Output, results: dict[str, MachineResult]) -> int:
    """Say the verdict and what did not converge; return the exit code."""
    from ..study.machine import destabilised_by_heating

    code = DONE
    for model, result in results.items():
        for state in result.supports:
            for point in state.points:
                if not point.converged:
                    code = INCOMPLETE
                    output.warn(
                        f"{state.name}, {model}, {point.speed * RPM:.0f} rpm: "
                        f"{point.status.value}: {point.message}"
                    )
        for speed, one in zip(result.speeds, result.statics, strict=False):
            if not one.converged:
                code = INCOMPLETE
                output.warn(
                    f"static equilibrium at {speed * RPM:.0f} rpm stopped with a residual of "
                    f"{one.residual:.1e} of the load"
                )
        if result.verdict is not None and result.known.size:
            top = float(result.known[-1]) * RPM
            name = "" if len(results) == 1 else f"{model}: "
            output.note(f"{name}{result.verdict} at {top:.0f} rpm")
    if len(results) > 1:
        cold, hot = next(iter(results.values())), results[next(reversed(results))]
        for mode in destabilised_by_heating(cold, hot):
            output.note(
                f"only heating makes the mode of {number(mode.frequency / (2.0 * math.pi))} Hz "
                f"unstable: growth rate {number(mode.isothermal_growth_rate)} 1/s without, "
                f"{number(mode.growth_rate)} 1/s with it"
            )
    return code


def is_machine(path: Path) -> bool:
    """Whether the file at `path` describes a machine."""
    from ..files.machine import is_machine as described

    return described(path)
