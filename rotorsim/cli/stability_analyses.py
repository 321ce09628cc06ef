"""Analyses of `rotorsim stability`: maps, tolerances, modes over speed; tables, figures, files."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .options import cluster
from .output import DONE, INCOMPLETE, Output, film_progress
from .stability_inputs import (
    Work,
    named_texts,
    scenario_of,
    solved,
    source_of,
    wanted_rotor,
    wanted_tolerances,
)

if TYPE_CHECKING:
    from ..files.machine import MachineFile
    from ..files.scenario import Scenario
    from ..model.machine import MachineTolerances
    from ..model.tolerances import ToleranceSettings
    from ..study.planes import Plane


def _show_plane(work: Work, plane: Plane, title: str) -> int:
    from ..show.study_figures import plane_figures
    from .stability_results import plane_document, plane_table

    document = {"map": plane_document(plane), "points": plane.solved_points}
    if work.folder is not None:
        from ..bearing.netcdf import write

        document["files"] = [write(plane.dataset, work.folder / f"{plane.file_name}.nc")]
    work.finish(document, plane_figures(plane, title), lambda: plane_table(plane))
    return _report_failed(work.output, plane.failed_points, plane.solved_points)


def show_map(work: Work, axes: dict[str, list[float] | None], held: dict[str, float]) -> int:
    """Show the map of a scenario or a table over `axes`; return the exit code."""
    return _show_plane(work, *_plane(work, axes, held))


def show_machine_map(
    work: Work, axes: dict[str, tuple[str | None, str | None]], hold: list[str]
) -> int:
    """Show the map of a machine over `axes`; return the exit code."""
    return _show_plane(work, *_machine_plane(work, axes, hold))


def _plane(
    work: Work, axes: dict[str, list[float] | None], held: dict[str, float]
) -> tuple[Plane, str]:
    """Return the map of a scenario or a table, and its title."""
    from ..files.scenario import load_scenario
    from ..study.planes import plane_of_scenario, plane_of_table

    x, y = axes
    cells = 101 if work.cells is None else work.cells
    values = {name: found for name, found in axes.items() if found is not None}
    table = work.table()
    if table is not None:
        table = table if work.model is None else table.select(thermal_model=work.model)
        own = scenario_of(work, table)
        fixed = {**values, **{n: [v] for n, v in held.items() if n in ("speed", "mass")}}
        rotor = None if own is None else own.rotor
        if "mass" not in fixed and "mass" not in axes and rotor and rotor.rigid_mass:
            fixed["mass"] = [rotor.rigid_mass]
        plane = plane_of_table(table, x, y, fixed, held, cells=cells)
        return plane, str(table.dataset.attrs.get("title", work.source.stem))
    scenario = load_scenario(work.source)
    # The first report corrects the number.
    films = len(scenario.speeds) * len(scenario.thermal_models) * len(axes)
    with (
        cluster(work.scheduler, work.output) as executor,
        film_progress(work.output, films) as progress,
    ):
        plane = plane_of_scenario(
            scenario, x, y, values, held, thermal_models=work.models, mesh=work.mesh_size,
            cells=cells, executor=executor, workers=work.workers, progress=progress,
        )  # fmt: skip
    return plane, scenario.title


def _machine_plane(
    work: Work, axes: dict[str, tuple[str | None, str | None]], hold: list[str]
) -> tuple[Plane, str]:
    """Return the map of a machine, and its title."""
    from ..files.machine import load_machine
    from ..study.machine_map import map_of_machine

    machine = load_machine(work.source)
    for key, (name, _) in axes.items():
        if name is None:
            raise InputError("a map needs both --x and --y", key=key)
    options: dict[str, Any] = {} if work.cells is None else {"cells": work.cells}
    with film_progress(work.output, len(machine.operating.speeds)) as progress:
        plane = map_of_machine(
            machine, str(axes["--x"][0]), str(axes["--y"][0]),
            {key.strip("-"): values for key, (_, values) in axes.items()},
            named_texts(hold, "--hold"), models=work.models, mesh=work.mesh_size,
            workers=work.workers, progress=progress, **options,
        )  # fmt: skip
    return plane, machine.title


def show_machine_tolerances(
    work: Work, hold: list[str], texts: list[str] | None, samples: int | None
) -> int:
    """Show what tolerances do to the threshold of a machine; return the exit code."""
    from ..files.machine import load_machine
    from ..files.parameters import held_values
    from ..model.machine import MachineTolerances

    machine = load_machine(work.source)
    held = held_values(machine, named_texts(hold, "--hold"), "--hold")
    speeds = [value for one, value in held.items() if one.kind == "speed"]
    if len(held) > len(speeds):
        raise InputError("goes with a map; set it in the file", key="--hold", value=hold[0])
    own, given = machine.tolerances, named_texts(texts, "--tolerance")
    spread = {**(own.spread if own else {}), **given}
    if not spread:
        raise InputError(
            'needs tolerances: --tolerance "left.clearance=5 um", or [tolerances] in the file',
            key="--tolerances",
        )
    settings = replace(own or MachineTolerances(spread), spread=spread)
    settings = replace(settings, samples=samples or settings.samples)
    return _show_study(work, machine, settings, operating_speed=speeds[0] if speeds else None)


def show_tolerances(
    work: Work, held: dict[str, float], rotor_texts: tuple, texts: list[str] | None,
    samples: int | None,
) -> int:  # fmt: skip
    """Show what tolerances do to the threshold of a rotor on one bearing; return the exit code."""
    scenario, _ = source_of(work)
    if scenario is None:
        raise InputError(
            "films are solved, and this table does not say how: give the scenario in its place",
            key="--tolerances", source=work.source,
        )  # fmt: skip
    extra = [name for name in held if name not in ("speed", "radial_clearance")]
    if extra:
        raise InputError("goes with a map; set it in the scenario", key=extra[0])
    return _show_study(
        work, scenario, wanted_tolerances(scenario, texts, samples),
        rotor=wanted_rotor(scenario, *rotor_texts), operating_speed=held.get("speed"),
        radial_clearance=held.get("radial_clearance"),
    )  # fmt: skip


def _show_study(
    work: Work, source: Scenario | MachineFile, settings: ToleranceSettings | MachineTolerances,
    **options: Any,
) -> int:  # fmt: skip
    from ..show.study_figures import tolerance_figures
    from ..study.tolerances import study_tolerances
    from .stability_results import study_document, study_tables

    with (
        cluster(work.scheduler, work.output) as executor,
        film_progress(work.output, settings.samples, "samples") as progress,
    ):
        study = study_tolerances(
            source, settings, thermal_model=work.model, mesh=work.mesh_size, executor=executor,
            workers=None if executor is not None else work.workers, progress=progress, **options,
        )  # fmt: skip
    figures = tolerance_figures(study, source.title)
    work.finish(study_document(study), figures, lambda: study_tables(study))
    failed = study.samples.failures
    if failed:
        total = next(iter(study.samples.inputs.values())).size
        work.output.warn(f"{len(failed)} of {total} samples failed, the first: {failed[0][1]}")
    return INCOMPLETE if failed else DONE


def show_curves(work: Work, rotor_texts: tuple, modes: int) -> int:
    """Show modes over speed and thresholds; return the exit code."""
    from ..bearing.doubts import doubts
    from ..show.study_figures import campbell_figures
    from ..study.stability import campbell_curves, stability_curves
    from .stability_results import branches_table, curve_row, modes_table, threshold_table
    from .tables import curve_table, summary_table

    output = work.output
    scenario, stored = source_of(work)
    # Before films are solved: what is wrong with the rotor is said at once.
    rotor = wanted_rotor(scenario, *rotor_texts)
    table = solved(work, scenario) if stored is None else stored
    table = table if work.model is None else table.select(thermal_model=work.model)
    curves = stability_curves(table, rotor)
    found = campbell_curves(table, rotor, modes) if rotor is not None else [None] * len(curves)
    shown = [one for one in found if one is not None]
    document = {
        "mass": None if rotor is None else rotor.rigid_mass,
        "rotor": None if rotor is None else rotor.kind,
        "curves": [curve_row(*pair) for pair in zip(curves, found, strict=True)],
        "doubts": [
            *(doubts(table) if scenario is None else ()),  # coefficients from elsewhere
            *(rotor.doubts() if rotor is not None else ()),
        ],
    }

    def parts() -> list:
        tables: list[Any] = [curve_table(curve) for curve in curves]
        for curve, one in zip(curves, found, strict=True):
            if one is not None:
                tables += [modes_table(curve, one), branches_table(curve, one)]
        return [*tables, threshold_table(curves, shown) if shown else summary_table(curves)]

    title = str(table.dataset.attrs.get("title", "")) if scenario is None else scenario.title
    work.finish(document, campbell_figures(shown, title), parts)
    for text in document["doubts"]:
        output.warn(text)
    return _report_failed(output, int((~table.converged).sum()), table.converged.size)


def _report_failed(output: Output, bad: int, total: int) -> int:
    if bad:
        output.warn(f"{bad} of {total} points of the table are not converged")
    return INCOMPLETE if bad else DONE
