"""The command `stability`: thresholds, modes, maps and tolerances."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..file_kinds import FileKind, kind_of, sentence
from .film_commands import computed_table
from .inputs import cluster, given_table, table_path, wanted_mass
from .options import BearingOption, ModelOption, SchedulerOption, WorkersOption
from .output import DONE, INCOMPLETE, Output
from .stability_options import (
    AXES,
    Axis,
    CellsOption,
    DofsOption,
    FolderOption,
    HeldClearanceOption,
    HeldLoadOption,
    HeldSpeedOption,
    HeldSupplyOption,
    MassOption,
    Mesh,
    MeshOption,
    ModesOption,
    NodesOption,
    RotorOption,
    SamplesOption,
    ShaftStiffnessOption,
    SourceArgument,
    SpeedsOption,
    ToleranceOption,
    TolerancesOption,
    XOption,
    XValuesOption,
    YOption,
    YValuesOption,
    axis_named,
    axis_values,
    held_values,
    wanted_rotor,
    wanted_tolerances,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario
    from ..model import MeshSize
    from ..study.planes import Plane


def stability(
    output: Output,
    source: SourceArgument,
    mass: MassOption = None,
    shaft_stiffness: ShaftStiffnessOption = None,
    rotor: RotorOption = None,
    bearing_nodes: NodesOption = None,
    dofs_per_node: DofsOption = None,
    modes: ModesOption = 8,
    x: XOption = None,  # type: ignore[valid-type]
    x_values: XValuesOption = None,  # type: ignore[valid-type]
    y: YOption = None,  # type: ignore[valid-type]
    y_values: YValuesOption = None,  # type: ignore[valid-type]
    speed: HeldSpeedOption = None,  # type: ignore[valid-type]
    load: HeldLoadOption = None,  # type: ignore[valid-type]
    clearance: HeldClearanceOption = None,  # type: ignore[valid-type]
    supply_temperature: HeldSupplyOption = None,  # type: ignore[valid-type]
    cells: CellsOption = 101,
    tolerances: TolerancesOption = False,
    tolerance: ToleranceOption = None,
    samples: SamplesOption = None,
    mesh: MeshOption = Mesh.SCENARIO,
    model: ModelOption = None,
    bearing: BearingOption = None,
    speeds: SpeedsOption = None,
    folder: FolderOption = None,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
) -> int:
    """Where a rotor is stable: critical mass, modes over speed, thresholds, maps, tolerances.

    Example: rotorsim stability coefficients/dal.nc --mass "1200 kg"

    With --x and --y: a map over any two inputs; what a table does not hold is solved.
    rotorsim stability scenarios/elliptical.toml --x speed --y load -o maps

    With --tolerances or --tolerance: what tolerances do to the threshold.
    rotorsim stability scenarios/elliptical.toml --tolerance "radial_clearance=5 um"
    """
    from .machine_commands import is_machine, machine_stability

    if is_machine(source):
        own = {"--mass": mass, "--rotor": rotor, "--shaft-stiffness": shaft_stiffness}
        return machine_stability(output, source, own, workers)
    given = wanted_mass(mass)
    held = held_values(
        {Axis.SPEED: speed, Axis.LOAD: load, Axis.CLEARANCE: clearance,
         Axis.SUPPLY_TEMPERATURE: supply_temperature}
    )  # fmt: skip
    rotor_texts = (given, shaft_stiffness, rotor, bearing_nodes, dofs_per_node)
    if x is not None or y is not None:
        axes = _axes({"--x": (x, x_values), "--y": (y, y_values)})
        if rotor is not None or shaft_stiffness is not None:
            raise InputError("maps are for a rigid rotor: give --mass", key="--rotor")
        held |= {} if given is None else {"mass": given}
        work = _Work(output, model, mesh, cells, folder, workers, scheduler, bearing, speeds)
        return _show_map(work, source, axes, held)
    if x_values or y_values:
        raise InputError("goes with --x and --y", key="--x-values" if x_values else "--y-values")
    work = _Work(output, model, mesh, cells, folder, workers, scheduler, bearing, speeds)
    if tolerances or tolerance or samples:
        return _show_tolerances(work, source, held, rotor_texts, tolerance, samples)
    if held or mesh is not Mesh.SCENARIO:
        raise InputError(
            "goes with a map (--x, --y) or with --tolerances",
            key=next((f"--{a.value}" for a, (n, *_) in AXES.items() if n in held), "--mesh"),
        )
    return _show_curves(work, source, rotor_texts, modes)


class _Work:
    """What the three analyses share."""

    def __init__(
        self, output: Output, model: str | None, mesh: Mesh, cells: int, folder: Path | None,
        workers: int | None, scheduler: str | None, bearing: str | None, speeds: str | None,
    ) -> None:  # fmt: skip
        self.output, self.model, self.cells, self.folder = output, model, cells, folder
        self.workers, self.scheduler, self.mesh = workers, scheduler, mesh
        self.bearing, self.speeds = bearing, speeds

    def table(self, source: Path) -> CoefficientTable | None:
        """Table at `source`; None where it is no table.

        Raises InputError: It is neither a table nor a scenario, or not as the options say.
        """
        from ..files.formats import is_table

        if is_table(source):
            table = given_table(self.output, source, self.bearing)
            if self.speeds is None:
                return table
            return table.with_speeds(axis_values(self.speeds, Axis.SPEED, "--speeds"))
        kind = kind_of(source)
        if kind not in (None, FileKind.SCENARIO):
            message = f"{sentence(kind)}; here a table or a scenario is needed"
            raise InputError(message, source=source)
        for key, text in (("--bearing", self.bearing), ("--speeds", self.speeds)):
            if text is not None:
                raise InputError("goes with a table", key=key, value=text)
        return None

    @property
    def mesh_size(self) -> MeshSize | None:
        """In place of the scenario's."""
        from ..study.axes import COARSE

        return COARSE if self.mesh is Mesh.COARSE else None

    def finish(self, document: dict[str, Any], figures: Any, parts: Callable[[], list]) -> None:
        """Write the figures, print the document or the tables."""
        from ..show.job import save_figures

        if self.folder is not None:
            document.setdefault("files", []).extend(save_figures(figures, self.folder))
        self.output.document(document)
        if not (self.output.json or self.output.quiet):
            self.output.show(*parts())
            if self.folder is not None:
                self.output.show(*(str(path) for path in document["files"]))


def _axes(texts: dict[str, tuple[str | None, str | None]]) -> dict[str, list[float] | None]:
    """Values of both axes by dimension; None: left to the map."""
    found: dict[str, list[float] | None] = {}
    for option, (text, values) in texts.items():
        if text is None:
            raise InputError("a map needs both --x and --y", key=option)
        axis = axis_named(text, option)
        name = AXES[axis][0]
        if name in found:
            raise InputError("must differ from --x", key=option, value=axis.value)
        key = f"{option}-values"
        found[name] = None if values is None else axis_values(values, axis, key)
    return found


def _show_map(
    work: _Work, source: Path, axes: dict[str, list[float] | None], held: dict[str, float]
) -> int:
    from ..show.stability_figures import plane_figures
    from .stability_results import plane_document, plane_table

    plane, title = _plane(work, source, axes, held)
    document = {"map": plane_document(plane), "points": plane.solved_points}
    if work.folder is not None:
        from ..bearing.netcdf import write

        document["files"] = [write(plane.dataset, work.folder / f"map_{plane.x}_{plane.y}.nc")]
    work.finish(document, plane_figures(plane, title), lambda: plane_table(plane))
    return _report_failed(work.output, plane.failed_points, plane.solved_points)


def _plane(
    work: _Work, source: Path, axes: dict[str, list[float] | None], held: dict[str, float]
) -> tuple[Plane, str]:
    """The map and its title."""
    from ..files.scenario import load_scenario
    from ..study.planes import plane_of_scenario, plane_of_table
    from .progress import film_progress

    x, y = axes
    values = {name: found for name, found in axes.items() if found is not None}
    table = work.table(source)
    if table is not None:
        table = table if work.model is None else table.select(thermal_model=work.model)
        own = _scenario_of(work.output, source, table)
        fixed = {**values, **{n: [v] for n, v in held.items() if n in ("speed", "mass")}}
        rotor = None if own is None else own.rotor
        if "mass" not in fixed and "mass" not in axes and rotor and rotor.rigid_mass:
            fixed["mass"] = [rotor.rigid_mass]
        plane = plane_of_table(table, x, y, fixed, held, cells=work.cells)
        return plane, str(table.dataset.attrs.get("title", source.stem))
    scenario = load_scenario(source)
    with (
        cluster(work.scheduler, work.output) as executor,
        film_progress(work.output, _film_count(scenario, axes)) as progress,
    ):
        plane = plane_of_scenario(
            scenario, x, y, values, held,
            thermal_models=None if work.model is None else [work.model], mesh=work.mesh_size,
            cells=work.cells, executor=executor, workers=work.workers, progress=progress,
        )  # fmt: skip
    return plane, scenario.title


def _film_count(scenario: Scenario, axes: dict[str, list[float] | None]) -> int:
    """Some number for the progress bar before the first report corrects it."""
    return len(scenario.speeds) * len(scenario.thermal_models) * len(axes)


def _show_tolerances(
    work: _Work,
    source: Path,
    held: dict[str, float],
    rotor_texts: tuple,
    texts: list[str] | None,
    samples: int | None,
) -> int:
    from ..show.stability_figures import tolerance_figures
    from ..study.tolerances import study_tolerances
    from .stability_results import study_document, study_tables

    scenario, _ = _source(work, source)
    if scenario is None:
        raise InputError(
            "films are solved, and this table does not say how: give the scenario in its place",
            key="--tolerances", source=source,
        )  # fmt: skip
    extra = [name for name in held if name not in ("speed", "radial_clearance")]
    if extra:
        raise InputError("goes with a map; set it in the scenario", key=extra[0])
    with (
        cluster(work.scheduler, work.output) as executor,
        _sample_progress(work.output) as progress,
    ):
        study = study_tolerances(
            scenario,
            wanted_tolerances(scenario, texts, samples),
            rotor=wanted_rotor(scenario, *rotor_texts),
            operating_speed=held.get("speed"),
            radial_clearance=held.get("radial_clearance"),
            thermal_model=work.model,
            mesh=work.mesh_size,
            executor=executor,
            workers=None if executor is not None else work.workers,
            progress=progress,
        )
    figures = tolerance_figures(study, scenario.title)
    work.finish(study_document(study), figures, lambda: study_tables(study))
    failed = study.samples.failures
    if failed:
        total = next(iter(study.samples.inputs.values())).size
        work.output.warn(f"{len(failed)} of {total} samples failed, the first: {failed[0][1]}")
    return INCOMPLETE if failed else DONE


@contextmanager
def _sample_progress(output: Output) -> Iterator[Callable[[int, int], None] | None]:
    """Say from time to time how many samples are done."""
    import time

    if output.quiet:
        yield None
        return
    last = time.monotonic()

    def report(done: int, total: int) -> None:
        nonlocal last
        if time.monotonic() - last > 5.0:
            last = time.monotonic()
            output.note(f"samples {done}/{total}")

    yield report


def _show_curves(work: _Work, source: Path, rotor_texts: tuple, modes: int) -> int:
    from ..bearing.doubts import doubts
    from ..show.stability_figures import campbell_figures
    from ..study.stability import campbell_curves, stability_curves
    from .stability_results import branches_table, curve_row, modes_table, threshold_table
    from .stability_tables import curve_table, summary_table

    output = work.output
    scenario, stored = _source(work, source)
    # Before films are solved: what is wrong with the rotor is said at once.
    rotor = wanted_rotor(scenario, *rotor_texts)
    table = _solved(work, source, scenario) if stored is None else stored
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

    work.finish(document, campbell_figures(shown, _title(scenario, table)), parts)
    for text in document["doubts"]:
        output.warn(text)
    return _report_failed(output, int((~table.converged).sum()), table.converged.size)


def _title(scenario: Scenario | None, table: CoefficientTable) -> str:
    return scenario.title if scenario is not None else str(table.dataset.attrs.get("title", ""))


def _report_failed(output: Output, bad: int, total: int) -> int:
    if bad:
        output.warn(f"{bad} of {total} points of the table are not converged")
    return INCOMPLETE if bad else DONE


def _source(work: _Work, source: Path) -> tuple[Scenario | None, CoefficientTable | None]:
    """Scenario at `source`, or of the table there where it says; the table, if it is one."""
    from ..files.scenario import load_scenario

    table = work.table(source)
    if table is None:
        return load_scenario(source), None
    return _scenario_of(work.output, source, table), table


def _solved(work: _Work, source: Path, scenario: Scenario | None) -> CoefficientTable:
    """Table of a scenario, solved."""
    assert scenario is not None
    path = table_path(source, Path())
    _, table = computed_table(work.output, scenario, path, work.workers, work.scheduler)
    work.output.note(f"the table is in {path}")
    return table


def _scenario_of(output: Output, source: Path, table: CoefficientTable) -> Scenario | None:
    """Scenario that a table was made from, where it says."""
    from ..files.scenario import Scenario

    text = table.dataset.attrs.get("scenario")
    if not text:
        return None
    try:
        return Scenario.from_text(str(text), source=source)
    except InputError as error:
        output.note(f"the table's scenario cannot be read here, so give --mass: {error}")
        return None
