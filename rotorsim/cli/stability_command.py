"""The command `stability`: thresholds, modes, maps and tolerances."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import InputError
from .options import (
    OWN,
    ROTOR,
    BearingOption,
    FolderOption,
    MassOption,
    ModelOption,
    SchedulerOption,
    WorkersOption,
    file_or_shipped,
    option,
    positive,
)
from .output import Output
from .stability_inputs import AXES, Axis, Mesh, Work, axes_of, held_values

_MAP, _TOLERANCES = "Map over two inputs", "Tolerances"


def _held(axis: Axis, default: str = OWN) -> Any:
    text = f'Hold it, e.g. "{AXES[axis][2]}".'
    return option(f"--{axis.value}", AXES[axis][1].upper(), text, default, _MAP)


def _axis(letter: str) -> Any:
    text = f"Map: {letter} axis, one of {', '.join(Axis)}; of a machine left.clearance, say."
    return option(f"--{letter}", "INPUT", text, panel=_MAP, autocompletion=_inputs)


def _inputs(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return the names that an axis of a map may have, scenario keys included, for completion."""
    names = [str(axis) for axis in Axis]
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
_Speed = Annotated[str | None, _held(Axis.SPEED, f"{OWN} highest")]
_Load = Annotated[str | None, _held(Axis.LOAD)]
_Clearance = Annotated[str | None, _held(Axis.CLEARANCE)]
_Supply = Annotated[str | None, _held(Axis.SUPPLY_TEMPERATURE)]
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
    Mesh, option("--mesh", None, "Coarse: many films in a short time.", True, _TOLERANCES)
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
    mesh: _MeshOption = Mesh.SCENARIO,
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
    from .stability_analyses import (
        show_curves,
        show_machine_map,
        show_machine_tolerances,
        show_map,
        show_tolerances,
    )

    work = Work(output, source, model, mesh, cells, folder, workers, scheduler, bearing, speeds)
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
            return show_machine_map(work, axes, asked)
        if spread:
            return show_machine_tolerances(work, asked, tolerance, samples)
        if asked or x_values or y_values or mesh is not Mesh.SCENARIO:
            raise InputError("goes with a map (--x, --y) or with --tolerances", key="--hold")
        return machine_stability(output, source, workers)
    if hold:
        raise InputError("goes with a machine", key="--hold", value=hold[0])
    given = positive(mass, "mass", "--mass", "1200 kg")
    held = held_values(
        {Axis.SPEED: speed, Axis.LOAD: load, Axis.CLEARANCE: clearance,
         Axis.SUPPLY_TEMPERATURE: supply_temperature}
    )  # fmt: skip
    if mapped:
        along = axes_of(axes)
        if rotor is not None or shaft_stiffness is not None:
            raise InputError("maps are for a rigid rotor: give --mass", key="--rotor")
        held |= {} if given is None else {"mass": given}
        return show_map(work, along, held)
    if x_values or y_values:
        raise InputError("goes with --x and --y", key="--x-values" if x_values else "--y-values")
    rotor_texts = (given, shaft_stiffness, rotor, bearing_nodes, dofs_per_node)
    if spread:
        return show_tolerances(work, held, rotor_texts, tolerance, samples)
    if held or mesh is not Mesh.SCENARIO:
        raise InputError(
            "goes with a map (--x, --y) or with --tolerances",
            key=next((f"--{a.value}" for a, (n, *_) in AXES.items() if n in held), "--mesh"),
        )
    return show_curves(work, rotor_texts, modes)
