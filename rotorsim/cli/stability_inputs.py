"""Options of `rotorsim stability` made into what is computed: table, rotor, axes, tolerances."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..arguments import ascending_values
from ..errors import InputError
from ..file_kinds import FileKind, kind_of, sentence
from .film_commands import computed_table
from .options import given_table, positive, table_path
from .output import Output

if TYPE_CHECKING:
    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario
    from ..model import MeshSize
    from ..model.tolerances import ToleranceSettings
    from ..rotor import Rotor

_SHORT = {"clearance": "radial_clearance", "applied_load": "load"}
"""Other names of inputs, to those of a scenario's ``[tolerances]``."""


class Axis(StrEnum):
    """Inputs that a stability map can go over."""

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


@dataclass(frozen=True)
class Work:
    """Options that the analyses share."""

    output: Output
    source: Path
    model: str | None
    mesh: Mesh
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
            return table.with_speeds(read_values(self.speeds, *AXES[Axis.SPEED][1:], "--speeds"))
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

        return COARSE if self.mesh is Mesh.COARSE else None

    def finish(self, document: dict[str, Any], figures: Any, parts: Callable[[], list]) -> None:
        """Write the figures, print the document or the tables."""
        from ..show.job import save_figures

        if self.folder is not None:
            document.setdefault("files", []).extend(save_figures(figures, self.folder))
        self.output.results(document, parts)


def source_of(work: Work) -> tuple[Scenario | None, CoefficientTable | None]:
    """Return the scenario, or that of the table where it says; the table, if it is one."""
    from ..files.scenario import load_scenario

    table = work.table()
    return (load_scenario(work.source) if table is None else scenario_of(work, table)), table


def solved(work: Work, scenario: Scenario | None) -> CoefficientTable:
    """Return the table of a scenario, solved."""
    assert scenario is not None
    path = table_path(work.source, Path())
    _, table = computed_table(work.output, scenario, path, work.workers, work.scheduler)
    work.output.note(f"the table is in {path}")
    return table


def scenario_of(work: Work, table: CoefficientTable) -> Scenario | None:
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


def axes_of(texts: dict[str, tuple[str | None, str | None]]) -> dict[str, list[float] | None]:
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
            found[name] = read_values(values, kind, example, f"{key}-values", "." in name)
        elif "." in name:
            raise InputError(
                "is missing: an entry of the file needs values, a list or start : stop : count",
                key=f"{key}-values",
            )
    return found


def named_texts(texts: Sequence[str] | None, key: str) -> dict[str, str]:
    """Return the values of ``NAME=VALUE`` texts by name."""
    found = {}
    for text in texts or ():
        name, sign, value = (part.strip() for part in text.partition("="))
        if not sign or not name or not value:
            raise InputError("must be NAME=VALUE", key=key, value=text)
        found[name] = value
    return found


def _axis_named(text: str, key: str) -> tuple[str, str | None, str]:
    """Return dimension, kind and example of an axis, by its name here, in a table or a scenario."""
    from ..files.scenario import Scenario
    from ..files.scenario.scenario import entry_kind
    from ..units import QUANTITIES

    for axis, (dimension, *_) in AXES.items():
        if text.replace("_", "-") in (axis.value, dimension.replace("_", "-")):
            return AXES[axis]
    try:
        name, kind = entry_kind(Scenario, text)
    except InputError as error:
        raise InputError(
            f"must be one of {', '.join(Axis)}, or an entry of the scenario's file "
            f"(bearing.pocket[0].depth); {error.message}", key=key, value=text,
        ) from None  # fmt: skip
    return name, kind, "0.5" if kind is None else QUANTITIES[kind].example


def read_values(
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


def held_values(texts: Mapping[Axis, str | None]) -> dict[str, float]:
    """Return the values [SI] of the options that hold an input, by dimension."""
    found = {
        AXES[a][0]: positive(t, AXES[a][1], f"--{a.value}", AXES[a][2]) for a, t in texts.items()
    }
    return {name: value for name, value in found.items() if value is not None}


def wanted_rotor(
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


def wanted_tolerances(
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
