"""What can be typed after `rotorsim stability` and `rotorsim control`, and how it is read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import StrEnum
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError
from .options import file_or_shipped

if TYPE_CHECKING:
    from ..files.scenario import Scenario
    from ..model.tolerances import ToleranceSettings
    from ..rotor import Rotor

_ROTOR, _MAP, _TOLERANCES = "Rotor", "Map over two inputs", "Tolerances"


class Axis(StrEnum):
    """What a stability map can go over."""

    SPEED = "speed"
    MASS = "mass"
    CLEARANCE = "clearance"
    LOAD = "load"
    SUPPLY_TEMPERATURE = "supply-temperature"


class Mesh(StrEnum):
    """Mesh for analyses that solve many films."""

    SCENARIO = "scenario"
    COARSE = "coarse"


AXES = {
    Axis.SPEED: ("speed", "speed", "15000 rpm"),
    Axis.MASS: ("mass", "mass", "900 kg"),
    Axis.CLEARANCE: ("radial_clearance", "length", "100 um"),
    Axis.LOAD: ("applied_load", "force", "10 kN"),
    Axis.SUPPLY_TEMPERATURE: ("supply_temperature", "temperature", "40 degC"),
}
"""Dimension of the table, kind of quantity, example."""
_SHORT = {"clearance": "radial_clearance", "applied_load": "load"}
"""Other names of inputs, to those of a scenario's ``[tolerances]``."""
_MOST_VALUES = 1000

SourceArgument = Annotated[
    Path,
    typer.Argument(
        metavar="TABLE-or-SCENARIO",
        help="Table (netCDF, CSV, ROSS), or scenario.",
        callback=file_or_shipped,
    ),
]
MassOption = Annotated[
    str | None,
    typer.Option(
        "--mass",
        metavar="MASS",
        help='Rotor mass per bearing, e.g. "1200 kg".',
        show_default="the scenario's",
        rich_help_panel=_ROTOR,
    ),
]
ShaftStiffnessOption = Annotated[
    str | None,
    typer.Option(
        "--shaft-stiffness",
        metavar="STIFFNESS",
        help='A flexible shaft: its stiffness per bearing, e.g. "200 MN/m"; --mass is the disc.',
        show_default="rigid",
        rich_help_panel=_ROTOR,
    ),
]
RotorOption = Annotated[
    Path | None,
    typer.Option(
        "--rotor",
        metavar="FILE",
        help="Any rotor: matrices M, K, D (or C) and G in a .npz or .mat file (SI), without the "
        "bearings; bearing_nodes, dofs_per_node. Its x lies along the load; G times the speed adds "
        "to D for a shaft that turns from x to y; every bearing node gets the same film.",
        show_default="the scenario's",
        rich_help_panel=_ROTOR,
    ),
]
NodesOption = Annotated[
    str | None,
    typer.Option(
        "--bearing-nodes",
        metavar="LIST",
        help='Nodes that bearings carry, from 0, e.g. "1,7".',
        show_default="the file's",
        rich_help_panel=_ROTOR,
    ),
]
DofsOption = Annotated[
    int | None,
    typer.Option(
        "--dofs-per-node",
        metavar="N",
        help="Degrees of freedom of a node, x and y first.",
        show_default="the file's, or 4",
        rich_help_panel=_ROTOR,
    ),
]
ModesOption = Annotated[
    int,
    typer.Option(
        "--modes", metavar="N", help="Branches to follow, lowest first.", min=1, max=1000,
        rich_help_panel=_ROTOR,
    ),
]  # fmt: skip


def _axis_option(letter: str) -> object:
    return Annotated[
        str | None,
        typer.Option(
            f"--{letter}",
            metavar="INPUT",
            help=f"Map: {letter} axis, one of {', '.join(Axis)}.",
            show_default=False,
            rich_help_panel=_MAP,
        ),
    ]


def axis_named(text: str, key: str) -> Axis:
    """Axis by its name here, in a table or in a scenario: ``clearance``, ``radial_clearance``."""
    for axis, (dimension, *_) in AXES.items():
        if text.replace("_", "-") in (axis.value, dimension.replace("_", "-")):
            return axis
    raise InputError(f"must be one of {', '.join(Axis)}", key=key, value=text)


def _values_option(letter: str) -> object:
    return Annotated[
        str | None,
        typer.Option(
            f"--{letter}-values",
            metavar="VALUES",
            help='A list "2 kN, 5 kN", or start, stop and count "2 kN : 20 kN : 9".',
            show_default="the scenario's, or about them",
            rich_help_panel=_MAP,
        ),
    ]


XOption, YOption = _axis_option("x"), _axis_option("y")
XValuesOption, YValuesOption = _values_option("x"), _values_option("y")


def _held_option(axis: Axis, default: str) -> object:
    return Annotated[
        str | None,
        typer.Option(
            f"--{axis.value}",
            metavar=AXES[axis][1].upper(),
            help=f'Hold it, e.g. "{AXES[axis][2]}".',
            show_default=default,
            rich_help_panel=_MAP,
        ),
    ]


HeldSpeedOption = _held_option(Axis.SPEED, "the scenario's highest")
HeldLoadOption = _held_option(Axis.LOAD, "the scenario's")
HeldClearanceOption = _held_option(Axis.CLEARANCE, "the scenario's")
HeldSupplyOption = _held_option(Axis.SUPPLY_TEMPERATURE, "the scenario's")
CellsOption = Annotated[
    int,
    typer.Option(
        "--cells", metavar="N", help="Of the map along each axis; 0: the values given.",
        min=0, max=5000, rich_help_panel=_MAP,
    ),
]  # fmt: skip
MeshOption = Annotated[
    Mesh,
    typer.Option("--mesh", help="Coarse: many films in a short time.", rich_help_panel=_TOLERANCES),
]
TolerancesOption = Annotated[
    bool,
    typer.Option(
        "--tolerances",
        help="What the scenario's tolerances make of the threshold.",
        rich_help_panel=_TOLERANCES,
    ),
]
ToleranceOption = Annotated[
    list[str] | None,
    typer.Option(
        "--tolerance",
        metavar="NAME=SPREAD",
        help='One more, e.g. "radial_clearance=5 um" or "viscosity=10 %"; may be repeated.',
        show_default=False,
        rich_help_panel=_TOLERANCES,
    ),
]
SamplesOption = Annotated[
    int | None,
    typer.Option(
        "--samples", metavar="N", help="Sets of inputs.", show_default="the scenario's, or 256",
        min=8, max=100_000, rich_help_panel=_TOLERANCES,
    ),
]  # fmt: skip
SpeedsOption = Annotated[
    str | None,
    typer.Option(
        "--speeds",
        metavar="VALUES",
        help='For constant coefficients: a list "3000 rpm, 6000 rpm", or start, stop and count.',
        show_default="1000 rpm : 20000 rpm : 20",
    ),
]
FolderOption = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="DIR",
        help="Write figures (PNG, SVG) and maps (netCDF) here.",
        show_default=False,
    ),
]


def quantity(text: str, axis: Axis, key: str) -> float:
    """Value [SI] of an option that holds one of the axes' inputs."""
    from ..units import parse_quantity

    _, kind, example = AXES[axis]
    value = parse_quantity(text, kind, key=key, example=example)
    if value <= 0.0:
        raise InputError("must be above 0", key=key, value=text)
    return value


def axis_values(text: str, axis: Axis, key: str) -> list[float]:
    """Ascending values [SI] of ``--x-values`` and ``--y-values``."""
    parts = [part.strip() for part in text.split(":")]
    if len(parts) == 3:
        if not parts[2].isascii() or not parts[2].isdigit() or not 2 <= int(parts[2]) <= 1000:
            raise InputError(
                f"the count must be a whole number from 2 to {_MOST_VALUES}", key=key, value=text
            )
        first, last = (quantity(part, axis, key) for part in parts[:2])
        step = (last - first) / (int(parts[2]) - 1)
        values = [first + i * step for i in range(int(parts[2]) - 1)] + [last]
    elif len(parts) == 1:
        values = [quantity(part.strip(), axis, key) for part in text.split(",")]
    else:
        example = AXES[axis][2]
        raise InputError(
            f'must be a list "{example}, ..." or "start : stop : count"', key=key, value=text
        )
    if len(values) > _MOST_VALUES or any(b <= a for a, b in pairwise(values)):
        raise InputError(f"must ascend, at most {_MOST_VALUES} values", key=key, value=text)
    return values


def held_values(texts: Mapping[Axis, str | None]) -> dict[str, float]:
    """Values [SI] of the options that hold an input, by dimension."""
    return {
        AXES[axis][0]: quantity(text, axis, f"--{axis.value}")
        for axis, text in texts.items()
        if text is not None
    }


def wanted_rotor(
    scenario: Scenario | None,
    mass: float | None,
    shaft_stiffness: str | None,
    file: Path | None,
    nodes: str | None,
    dofs: int | None,
) -> Rotor | None:
    """Rotor of the options, else the scenario's; None without either."""
    from ..files.rotors import load_rotor
    from ..rotor import Rotor
    from ..units import parse_quantity

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
        key = "--shaft-stiffness"
        stiffness = parse_quantity(shaft_stiffness, "stiffness", key=key, example="200 MN/m")
        if stiffness <= 0.0:
            raise InputError("must be above 0", key=key, value=shaft_stiffness)
        return _jeffcott(None if scenario is None else scenario.rotor, mass, stiffness)
    if mass is not None:
        return Rotor.rigid(mass)
    return None if scenario is None else scenario.rotor


def _jeffcott(own: Rotor | None, mass: float | None, stiffness: float) -> Rotor:
    """Jeffcott rotor of the options: `mass` is the disc's, what is not given the scenario's."""
    from ..rotor import Rotor

    parts = {} if own is None else dict(own.parameters)
    if mass is None and own is None:
        raise InputError('needs the disc: --mass "900 kg"', key="--shaft-stiffness")
    if mass is not None or own is None or own.kind != "jeffcott":
        return Rotor.jeffcott(parts["mass"] if mass is None else mass, stiffness)
    return Rotor.jeffcott(**(parts | {"shaft_stiffness": stiffness}))


def _node_list(text: str | None) -> tuple[int, ...] | None:
    """Node numbers of ``--bearing-nodes``."""
    if text is None:
        return None
    words = [word.strip() for word in text.split(",")]
    if not all(word.isascii() and word.isdigit() and len(word) < 7 for word in words):
        raise InputError(
            'must be whole numbers from 0, such as "1,7"', key="--bearing-nodes", value=text
        )
    return tuple(int(word) for word in words)


def wanted_tolerances(
    scenario: Scenario, texts: Sequence[str] | None, samples: int | None
) -> ToleranceSettings:
    """The scenario's tolerances with those of the options."""
    from dataclasses import replace

    from ..model.tolerances import KINDS, ToleranceSettings, parse_spread

    found: dict[str, Any] = {}
    for text in texts or ():
        name, sign, value = (part.strip() for part in text.partition("="))
        name = name.replace("-", "_")
        name = _SHORT.get(name, name)
        if not sign or name not in KINDS:
            raise InputError(
                f"must be NAME=SPREAD, NAME one of {', '.join(KINDS)}",
                key="--tolerance",
                value=text,
            )
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
