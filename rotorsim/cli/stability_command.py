"""The command `stability`: thresholds, modes, maps and tolerances."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..arguments import ascending_values
from ..errors import InputError
from ..file_kinds import FileKind, kind_of, sentence
from .film_commands import computed_table
from .options import (
    OWN,
    ROTOR,
    BearingOption,
    FolderOption,
    MassOption,
    ModelOption,
    SchedulerOption,
    WorkersOption,
    cluster,
    file_or_shipped,
    given_table,
    option,
    positive,
    table_path,
)
from .output import DONE, INCOMPLETE, Output, film_progress

if TYPE_CHECKING:
    from ..bearing.table import CoefficientTable
    from ..files.machine import MachineFile
    from ..files.scenario import Scenario
    from ..model import MeshSize
    from ..model.machine import MachineTolerances
    from ..model.tolerances import ToleranceSettings
    from ..rotor import Rotor
    from ..study.planes import Plane


_MAP, _TOLERANCES = "Map over two inputs", "Tolerances"
_SHORT = {"clearance": "radial_clearance", "applied_load": "load"}
"""Other names of inputs, to those of a scenario's ``[tolerances]``."""


class _Axis(StrEnum):
    """Inputs that a stability map can go over."""

    SPEED = "speed"
    MASS = "mass"
    CLEARANCE = "clearance"
    LOAD = "load"
    SUPPLY_TEMPERATURE = "supply-temperature"


class _Mesh(StrEnum):
    """Mesh for analyses that solve many films."""

    SCENARIO = "scenario"
    COARSE = "coarse"


_AXES = {
    _Axis.SPEED: ("speed", "speed", "15000 rpm"),
    _Axis.MASS: ("mass", "mass", "900 kg"),
    _Axis.CLEARANCE: ("radial_clearance", "length", "100 um"),
    _Axis.LOAD: ("applied_load", "force", "10 kN"),
    _Axis.SUPPLY_TEMPERATURE: ("supply_temperature", "temperature", "40 degC"),
}
"""Dimension of the table, kind of quantity, example."""


def _held(axis: _Axis, default: str = OWN) -> Any:
    text = f'Hold it, e.g. "{_AXES[axis][2]}".'
    return option(f"--{axis.value}", _AXES[axis][1].upper(), text, default, _MAP)


def _axis(letter: str) -> Any:
    text = f"Map: {letter} axis, one of {', '.join(_Axis)}; of a machine left.clearance, say."
    return option(f"--{letter}", "INPUT", text, panel=_MAP, autocompletion=_inputs)


def _inputs(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return the names that an axis of a map may have, scenario keys included, for completion."""
    names = [str(axis) for axis in _Axis]
    with suppress(Exception):  # no such file, or not yet TOML
        path = file_or_shipped(Path(ctx.args[0]))  # what is half typed is not taken apart yet
        names += _keys(tomllib.loads(path.read_text(encoding="utf-8")))
    return [name for name in names if name.startswith(incomplete)]


def _keys(inner: Any, name: str = "") -> Iterator[str]:
    """Give the dotted keys of all values that may be quantities."""
    if isinstance(inner, dict):
        for key, value in inner.items():
            yield from _keys(value, f"{name}.{key}".lstrip("."))
    elif isinstance(inner, list) and inner and isinstance(inner[0], dict):
        for place, value in enumerate(inner):
            yield from _keys(value, f"{name}[{place}]")
    elif not isinstance(inner, bool | list) and str(inner)[:1] in "-0123456789":
        yield name


def _axis_values(letter: str) -> Any:
    text = 'A list "2 kN, 5 kN", or start, stop and count "2 kN : 20 kN : 9".'
    return option(f"--{letter}-values", "VALUES", text, f"{OWN}, or about them", _MAP)


_Source = Annotated[
    Path,
    typer.Argument(
        metavar="TABLE-or-SCENARIO",
        help="Table (netCDF, CSV, ROSS), or scenario.",
        callback=file_or_shipped,
    ),
]
_ShaftStiffness = Annotated[
    str | None,
    option(
        "--shaft-stiffness", "STIFFNESS",
        'A flexible shaft: its stiffness per bearing, e.g. "200 MN/m"; --mass is the disc.',
        "rigid", ROTOR,
    ),
]  # fmt: skip
_RotorFile = Annotated[
    Path | None,
    option(
        "--rotor", "FILE",
        "Any rotor: matrices M, K, D (or C) and G in a .npz or .mat file (SI), without the "
        "bearings; bearing_nodes, dofs_per_node. Its x lies along the load; G times the speed adds "
        "to D for a shaft that turns from x to y; every bearing node gets the same film.",
        OWN, ROTOR,
    ),
]  # fmt: skip
_Nodes = Annotated[
    str | None,
    option(
        "--bearing-nodes", "LIST", 'Nodes that bearings carry, from 0, e.g. "1,7".', "the file's",
        ROTOR,
    ),
]  # fmt: skip
_Dofs = Annotated[
    int | None,
    option(
        "--dofs-per-node", "N", "Degrees of freedom of a node, x and y first.",
        "the file's, or 4", ROTOR,
    ),
]  # fmt: skip
_Modes = Annotated[
    int, option("--modes", "N", "Branches to follow, lowest first.", True, ROTOR, min=1, max=1000)
]
_X = Annotated[str | None, _axis("x")]
_Y = Annotated[str | None, _axis("y")]
_XValues = Annotated[str | None, _axis_values("x")]
_YValues = Annotated[str | None, _axis_values("y")]
_Speed = Annotated[str | None, _held(_Axis.SPEED, f"{OWN} highest")]
_Load = Annotated[str | None, _held(_Axis.LOAD)]
_Clearance = Annotated[str | None, _held(_Axis.CLEARANCE)]
_Supply = Annotated[str | None, _held(_Axis.SUPPLY_TEMPERATURE)]
_Cells = Annotated[
    int | None,
    option(
        "--cells", "N", "Of the map along each axis; 0: the values given.",
        "101, of a machine 25", _MAP, min=0, max=5000,
    ),
]  # fmt: skip
_Hold = Annotated[
    list[str] | None,
    option(
        "--hold", "NAME=VALUE",
        'Of a machine: hold a parameter, e.g. "left.load=5 kN"; may be repeated.', OWN, _MAP,
    ),
]  # fmt: skip
_MeshOption = Annotated[
    _Mesh, option("--mesh", None, "Coarse: many films in a short time.", True, _TOLERANCES)
]
_Tolerances = Annotated[
    bool,
    option(
        "--tolerances", None, "What the scenario's tolerances make of the threshold.",
        True, _TOLERANCES,
    ),
]  # fmt: skip
_Tolerance = Annotated[
    list[str] | None,
    option(
        "--tolerance", "NAME=SPREAD",
        'One more, e.g. "radial_clearance=5 um" or "viscosity=10 %"; may be repeated.',
        panel=_TOLERANCES,
    ),
]  # fmt: skip
_Samples = Annotated[
    int | None,
    option("--samples", "N", "Sets of inputs.", f"{OWN}, or 256", _TOLERANCES, min=8, max=100_000),
]
_Speeds = Annotated[
    str | None,
    option(
        "--speeds", "VALUES",
        'For constant coefficients: a list "3000 rpm, 6000 rpm", or start, stop and count.',
        "1000 rpm : 20000 rpm : 20",
    ),
]  # fmt: skip


def stability(
    output: Output,
    source: _Source,
    mass: MassOption = None,
    shaft_stiffness: _ShaftStiffness = None,
    rotor: _RotorFile = None,
    bearing_nodes: _Nodes = None,
    dofs_per_node: _Dofs = None,
    modes: _Modes = 8,
    x: _X = None,
    x_values: _XValues = None,
    y: _Y = None,
    y_values: _YValues = None,
    speed: _Speed = None,
    load: _Load = None,
    clearance: _Clearance = None,
    supply_temperature: _Supply = None,
    cells: _Cells = None,
    tolerances: _Tolerances = False,
    tolerance: _Tolerance = None,
    samples: _Samples = None,
    mesh: _MeshOption = _Mesh.SCENARIO,
    model: ModelOption = None,
    bearing: BearingOption = None,
    speeds: _Speeds = None,
    hold: _Hold = None,
    folder: FolderOption = None,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
) -> int:
    """Find where a rotor is stable: critical mass, modes over speed, thresholds, maps, tolerances.

    Example: rotorsim stability coefficients/dal.nc --mass "1200 kg"

    With --x and --y: a map over any two inputs; what a table does not hold is solved.
    rotorsim stability scenarios/elliptical.toml --x speed --y load -o maps

    Or over entries of the scenario's file:
    rotorsim stability pressure_dam --mass "400 kg" --x speed --y "bearing.pocket[0].depth"
    --y-values "50 um : 300 um : 6"

    With --tolerances or --tolerance: what tolerances do to the threshold.
    rotorsim stability scenarios/elliptical.toml --tolerance "radial_clearance=5 um"

    Both of a machine, over any of its parameters:
    rotorsim stability scenarios/machines/plain_rotor.toml --x speed --y left.clearance
    """
    from .machine_commands import is_machine, machine_stability

    work = _Work(output, source, model, mesh, cells, folder, workers, scheduler, bearing, speeds)
    own_rotor = {
        "--mass": mass, "--rotor": rotor, "--shaft-stiffness": shaft_stiffness,
        "--bearing-nodes": bearing_nodes, "--dofs-per-node": dofs_per_node,
    }  # fmt: skip
    mapped, spread = x is not None or y is not None, tolerances or tolerance or samples
    axes = {"--x": (x, x_values), "--y": (y, y_values)}
    if is_machine(source):
        for key, value in own_rotor.items():
            if value is not None:
                raise InputError(f"the rotor is that of the machine file {source}", key=key)
        for key, value in {
            "--load": load, "--clearance": clearance, "--supply-temperature": supply_temperature,
            "--bearing": bearing, "--speeds": speeds,
        }.items():  # fmt: skip
            if value is not None:
                raise InputError(
                    'of a machine say whose: --hold "left.clearance=80 um"', key=key, value=value
                )
        asked = [*(hold or ()), *([] if speed is None else [f"speed={speed}"])]
        if mapped:
            return _show_plane(work, *_machine_plane(work, axes, asked))
        if spread:
            return _show_machine_tolerances(work, asked, tolerance, samples)
        if asked or x_values or y_values or mesh is not _Mesh.SCENARIO:
            raise InputError("goes with a map (--x, --y) or with --tolerances", key="--hold")
        return machine_stability(output, source, workers)
    if hold:
        raise InputError("goes with a machine", key="--hold", value=hold[0])
    given = positive(mass, "mass", "--mass", "1200 kg")
    held = _held_values(
        {_Axis.SPEED: speed, _Axis.LOAD: load, _Axis.CLEARANCE: clearance,
         _Axis.SUPPLY_TEMPERATURE: supply_temperature}
    )  # fmt: skip
    if mapped:
        along = _axes(axes)
        if rotor is not None or shaft_stiffness is not None:
            raise InputError("maps are for a rigid rotor: give --mass", key="--rotor")
        held |= {} if given is None else {"mass": given}
        return _show_plane(work, *_plane(work, along, held))
    if x_values or y_values:
        raise InputError("goes with --x and --y", key="--x-values" if x_values else "--y-values")
    rotor_texts = (given, shaft_stiffness, rotor, bearing_nodes, dofs_per_node)
    if spread:
        return _show_tolerances(work, held, rotor_texts, tolerance, samples)
    if held or mesh is not _Mesh.SCENARIO:
        raise InputError(
            "goes with a map (--x, --y) or with --tolerances",
            key=next((f"--{a.value}" for a, (n, *_) in _AXES.items() if n in held), "--mesh"),
        )
    return _show_curves(work, rotor_texts, modes)


@dataclass(frozen=True)
class _Work:
    """Options that the analyses share."""

    output: Output
    source: Path
    model: str | None
    mesh: _Mesh
    cells: int | None
    folder: Path | None
    workers: int | None
    scheduler: str | None
    bearing: str | None
    speeds: str | None

    def table(self) -> CoefficientTable | None:
        """Return the table at the source; None where it is no table.

        Raises InputError: It is neither a table nor a scenario, or not as the options say.
        """
        from ..files.formats import is_table

        if is_table(self.source):
            table = given_table(self.output, self.source, self.bearing)
            if self.speeds is None:
                return table
            return table.with_speeds(_read_values(self.speeds, *_AXES[_Axis.SPEED][1:], "--speeds"))
        kind = kind_of(self.source)
        if kind not in (None, FileKind.SCENARIO):
            message = f"{sentence(kind)}; here a table or a scenario is needed"
            raise InputError(message, source=self.source)
        for key, text in (("--bearing", self.bearing), ("--speeds", self.speeds)):
            if text is not None:
                raise InputError("goes with a table", key=key, value=text)
        return None

    @property
    def models(self) -> list[str] | None:
        """The one thermal model that is asked for."""
        return None if self.model is None else [self.model]

    @property
    def mesh_size(self) -> MeshSize | None:
        """In place of the scenario's."""
        from ..study.changes import COARSE

        return COARSE if self.mesh is _Mesh.COARSE else None

    def finish(self, document: dict[str, Any], figures: Any, parts: Callable[[], list]) -> None:
        """Write the figures, print the document or the tables."""
        from ..show.job import save_figures

        if self.folder is not None:
            document.setdefault("files", []).extend(save_figures(figures, self.folder))
        self.output.results(document, parts)


def _axes(texts: dict[str, tuple[str | None, str | None]]) -> dict[str, list[float] | None]:
    """Return the values of both axes by dimension; None: left to the map."""
    found: dict[str, list[float] | None] = {}
    for key, (text, values) in texts.items():
        if text is None:
            raise InputError("a map needs both --x and --y", key=key)
        name, kind, example = _axis_named(text, key)
        if name in found:
            raise InputError("must differ from --x", key=key, value=text)
        found[name] = None
        if values is not None:
            found[name] = _read_values(values, kind, example, f"{key}-values", "." in name)
        elif "." in name:
            raise InputError(
                "is missing: an entry of the file needs values, a list or start : stop : count",
                key=f"{key}-values",
            )
    return found


def _show_plane(work: _Work, plane: Plane, title: str) -> int:
    from ..show.job import plane_figures
    from .stability_results import plane_document, plane_table

    document = {"map": plane_document(plane), "points": plane.solved_points}
    if work.folder is not None:
        from ..bearing.netcdf import write

        document["files"] = [write(plane.dataset, work.folder / f"{plane.file_name}.nc")]
    work.finish(document, plane_figures(plane, title), lambda: plane_table(plane))
    return _report_failed(work.output, plane.failed_points, plane.solved_points)


def _plane(
    work: _Work, axes: dict[str, list[float] | None], held: dict[str, float]
) -> tuple[Plane, str]:
    """Map of a scenario or a table, and its title."""
    from ..files.scenario import load_scenario
    from ..study.planes import plane_of_scenario, plane_of_table

    x, y = axes
    cells = 101 if work.cells is None else work.cells
    values = {name: found for name, found in axes.items() if found is not None}
    table = work.table()
    if table is not None:
        table = table if work.model is None else table.select(thermal_model=work.model)
        own = _scenario_of(work, table)
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
    work: _Work, axes: dict[str, tuple[str | None, str | None]], hold: list[str]
) -> tuple[Plane, str]:
    """Map of a machine, and its title."""
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
            _named_texts(hold, "--hold"), models=work.models, mesh=work.mesh_size,
            workers=work.workers, progress=progress, **options,
        )  # fmt: skip
    return plane, machine.title


def _named_texts(texts: Sequence[str] | None, key: str) -> dict[str, str]:
    """Return the values of ``NAME=VALUE`` texts by name."""
    found = {}
    for text in texts or ():
        name, sign, value = (part.strip() for part in text.partition("="))
        if not sign or not name or not value:
            raise InputError("must be NAME=VALUE", key=key, value=text)
        found[name] = value
    return found


def _show_machine_tolerances(
    work: _Work, hold: list[str], texts: list[str] | None, samples: int | None
) -> int:
    from ..files.machine import load_machine
    from ..files.parameters import held_values
    from ..model.machine import MachineTolerances

    machine = load_machine(work.source)
    held = held_values(machine, _named_texts(hold, "--hold"), "--hold")
    speeds = [value for one, value in held.items() if one.kind == "speed"]
    if len(held) > len(speeds):
        raise InputError("goes with a map; set it in the file", key="--hold", value=hold[0])
    own, given = machine.tolerances, _named_texts(texts, "--tolerance")
    spread = {**(own.spread if own else {}), **given}
    if not spread:
        raise InputError(
            'needs tolerances: --tolerance "left.clearance=5 um", or [tolerances] in the file',
            key="--tolerances",
        )
    settings = replace(own or MachineTolerances(spread), spread=spread)
    settings = replace(settings, samples=samples or settings.samples)
    return _show_study(work, machine, settings, operating_speed=speeds[0] if speeds else None)


def _show_tolerances(
    work: _Work, held: dict[str, float], rotor_texts: tuple, texts: list[str] | None,
    samples: int | None,
) -> int:  # fmt: skip
    scenario, _ = _source(work)
    if scenario is None:
        raise InputError(
            "films are solved, and this table does not say how: give the scenario in its place",
            key="--tolerances", source=work.source,
        )  # fmt: skip
    extra = [name for name in held if name not in ("speed", "radial_clearance")]
    if extra:
        raise InputError("goes with a map; set it in the scenario", key=extra[0])
    return _show_study(
        work, scenario, _wanted_tolerances(scenario, texts, samples),
        rotor=_wanted_rotor(scenario, *rotor_texts), operating_speed=held.get("speed"),
        radial_clearance=held.get("radial_clearance"),
    )  # fmt: skip


def _show_study(
    work: _Work, source: Scenario | MachineFile, settings: ToleranceSettings | MachineTolerances,
    **options: Any,
) -> int:  # fmt: skip
    from ..show.job import tolerance_figures
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


def _show_curves(work: _Work, rotor_texts: tuple, modes: int) -> int:
    from ..bearing.doubts import doubts
    from ..show.job import campbell_figures
    from ..study.stability import campbell_curves, stability_curves
    from .stability_results import branches_table, curve_row, modes_table, threshold_table
    from .tables import curve_table, summary_table

    output = work.output
    scenario, stored = _source(work)
    # Before films are solved: what is wrong with the rotor is said at once.
    rotor = _wanted_rotor(scenario, *rotor_texts)
    table = _solved(work, scenario) if stored is None else stored
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


def _source(work: _Work) -> tuple[Scenario | None, CoefficientTable | None]:
    """Return the scenario, or that of the table where it says; the table, if it is one."""
    from ..files.scenario import load_scenario

    table = work.table()
    return (load_scenario(work.source) if table is None else _scenario_of(work, table)), table


def _solved(work: _Work, scenario: Scenario | None) -> CoefficientTable:
    """Return the table of a scenario, solved."""
    assert scenario is not None
    path = table_path(work.source, Path())
    _, table = computed_table(work.output, scenario, path, work.workers, work.scheduler)
    work.output.note(f"the table is in {path}")
    return table


def _scenario_of(work: _Work, table: CoefficientTable) -> Scenario | None:
    """Return the scenario that a table was made from, where it says."""
    from ..files.scenario import Scenario

    text = table.dataset.attrs.get("scenario")
    if not text:
        return None
    try:
        return Scenario.from_text(str(text), source=work.source)
    except InputError as error:
        work.output.note(f"the table's scenario cannot be read here, so give --mass: {error}")
        return None


def _axis_named(text: str, key: str) -> tuple[str, str | None, str]:
    """Return dimension, kind and example of an axis, by its name here, in a table or a scenario."""
    from ..files.scenario import Scenario
    from ..files.scenario.scenario import entry_kind
    from ..units import QUANTITIES

    for axis, (dimension, *_) in _AXES.items():
        if text.replace("_", "-") in (axis.value, dimension.replace("_", "-")):
            return _AXES[axis]
    try:
        name, kind = entry_kind(Scenario, text)
    except InputError as error:
        raise InputError(
            f"must be one of {', '.join(_Axis)}, or an entry of the scenario's file "
            f"(bearing.pocket[0].depth); {error.message}", key=key, value=text,
        ) from None  # fmt: skip
    return name, kind, "0.5" if kind is None else QUANTITIES[kind].example


def _read_values(
    text: str, kind: str | None, example: str, key: str, any_sign: bool = False
) -> list[float]:
    """Return the ascending values [SI] of ``--x-values`` and ``--y-values``."""
    from ..units import parse_quantity

    def value(word: object) -> float:
        if kind is not None:
            return parse_quantity(word, kind, key=key, example=example)
        try:
            return float(str(word))
        except ValueError:
            raise InputError("must be plain numbers", key=key, value=word) from None

    values = ascending_values(text, value, key, example)
    if values[0] <= 0.0 and not any_sign:
        raise InputError("must be above 0", key=key, value=text)
    return values


def _held_values(texts: Mapping[_Axis, str | None]) -> dict[str, float]:
    """Return the values [SI] of the options that hold an input, by dimension."""
    found = {
        _AXES[a][0]: positive(t, _AXES[a][1], f"--{a.value}", _AXES[a][2]) for a, t in texts.items()
    }
    return {name: value for name, value in found.items() if value is not None}


def _wanted_rotor(
    scenario: Scenario | None, mass: float | None, shaft_stiffness: str | None,
    file: Path | None, nodes: str | None, dofs: int | None,
) -> Rotor | None:  # fmt: skip
    """Return the rotor of the options, else the scenario's; None without either."""
    from ..files.rotors import load_rotor
    from ..rotor import Rotor

    if file is not None:
        if mass is not None or shaft_stiffness is not None:
            raise InputError(
                "goes without --mass and --shaft-stiffness", key="--rotor", value=str(file)
            )
        return load_rotor(file, _node_list(nodes), dofs)
    if nodes is not None or dofs is not None:
        key = "--bearing-nodes" if nodes is not None else "--dofs-per-node"
        raise InputError("goes with --rotor FILE", key=key)
    if shaft_stiffness is not None:
        stiffness = positive(shaft_stiffness, "stiffness", "--shaft-stiffness", "200 MN/m")
        assert stiffness is not None
        return _jeffcott(None if scenario is None else scenario.rotor, mass, stiffness)
    if mass is not None:
        return Rotor.rigid(mass)
    return None if scenario is None else scenario.rotor


def _jeffcott(own: Rotor | None, mass: float | None, stiffness: float) -> Rotor:
    """Return the Jeffcott rotor of the options, `mass` the disc's; the rest is the scenario's."""
    from ..rotor import Rotor

    parts = {} if own is None else dict(own.parameters)
    if mass is None and own is None:
        raise InputError('needs the disc: --mass "900 kg"', key="--shaft-stiffness")
    if mass is not None or own is None or own.kind != "jeffcott":
        return Rotor.jeffcott(parts["mass"] if mass is None else mass, stiffness)
    return Rotor.jeffcott(**(parts | {"shaft_stiffness": stiffness}))


def _node_list(text: str | None) -> tuple[int, ...] | None:
    """Return the node numbers of ``--bearing-nodes``."""
    if text is None:
        return None
    words = [word.strip() for word in text.split(",")]
    if not all(word.isascii() and word.isdigit() and len(word) < 7 for word in words):
        raise InputError(
            'must be whole numbers from 0, such as "1,7"', key="--bearing-nodes", value=text
        )
    return tuple(int(word) for word in words)


def _wanted_tolerances(
    scenario: Scenario, texts: Sequence[str] | None, samples: int | None
) -> ToleranceSettings:
    """Return the scenario's tolerances with those of the options."""
    from ..model.tolerances import KINDS, ToleranceSettings, parse_spread

    found: dict[str, Any] = {}
    for text in texts or ():
        name, sign, value = (part.strip() for part in text.partition("="))
        name = name.replace("-", "_")
        name = _SHORT.get(name, name)
        if not sign or name not in KINDS:
            known = f"must be NAME=SPREAD, NAME one of {', '.join(KINDS)}"
            raise InputError(known, key="--tolerance", value=text)
        try:
            found[name] = parse_spread(value, name)
        except InputError as error:
            raise InputError(error.message, key=f"--tolerance {name}", value=value) from None
    if not found and scenario.tolerances is None:
        raise InputError(
            'needs tolerances: --tolerance "radial_clearance=5 um", or a section [tolerances] in '
            "the scenario",
            key="--tolerances",
        )
    base = scenario.tolerances or ToleranceSettings(**found)
    return replace(base, **found, samples=samples or base.samples)
