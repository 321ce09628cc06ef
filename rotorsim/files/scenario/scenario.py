"""A scenario: what a file describes, as frozen model objects."""

from __future__ import annotations

import hashlib
import json
import math
import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from ...arguments import file_path, finite_number
from ...arrays import Array
from ...errors import InputError, ScenarioError
from ...model import Bearing, Case, FilmSettings, Lubricant, Target, ThermalModel, ThermalSettings
from ...model.entries import NOT_IN_FILES, Entry, Leaf, Made, Quantity, entries, marks_of, nearest
from ...model.lubricant import oil
from ...model.operating import Operating, StabilitySettings
from ...model.orbit import OrbitSettings
from ...model.pad_bearing import tilting_pad_bearing
from ...model.study import StudySettings
from ...model.tolerances import ToleranceSettings
from ...model.transient import TransientSettings
from ...rotor import Rotor
from ...shipped import shipped_scenarios
from ...text import printable
from ...units import QUANTITIES
from .consistency import settled, stand_by_load
from .document import parse_toml, read_text
from .reader import Reader, makers_of, tables_of

_MAX_TITLE = 500
_BEARINGS = Made({"bore": Bearing, "tilting_pad": tilting_pad_bearing})
"""Makers of ``[bearing]``, by its ``kind``."""
_ROTORS = Made({"rigid": Rotor.rigid, "jeffcott": Rotor.jeffcott})
"""Makers of ``[rotor]``, by its ``kind``."""


class TitleEntry(Leaf):
    """One line of text."""

    def read(self, value: object) -> str:
        """Return the text."""
        if not isinstance(value, str):
            raise InputError("must be text in quotes")
        if len(value) > _MAX_TITLE:
            raise InputError(f"must be at most {_MAX_TITLE} characters")
        if not value.isprintable():
            raise InputError(
                "must be one line of text without control characters such as tabs, line ends or "
                "escapes"
            )
        return value


@dataclass(frozen=True, eq=False)
class Scenario:
    """A validated scenario (SI units).

    Attributes
    ----------
    bearing : Bearing
        With the first clearance, angles as given in the file (before the load is turned to x).
    lubricant : Lubricant
    operating : Operating
    title : str
    film : FilmSettings
    thermal : ThermalSettings
        With the first thermal model.
    rotor : Rotor or None
    orbit : OrbitSettings or None
    transient : TransientSettings or None
    stability : StabilitySettings or None
    tolerances : ToleranceSettings or None
    study : StudySettings or None
    radial_clearances : tuple of float
        [m]
    thermal_models : tuple of ThermalModel
    source : Path or None
        The file it came from.
    text : str
        The TOML text, lines ended by a line feed.
    """

    bearing: Annotated[Bearing, _BEARINGS]
    lubricant: Annotated[Lubricant, Made(oil)]
    operating: Operating
    title: Annotated[str, TitleEntry()] = ""
    film: FilmSettings = field(default_factory=FilmSettings)
    thermal: ThermalSettings = field(default_factory=ThermalSettings)
    rotor: Annotated[Rotor | None, _ROTORS] = None
    orbit: OrbitSettings | None = None
    transient: TransientSettings | None = None
    stability: StabilitySettings | None = None
    tolerances: ToleranceSettings | None = None
    study: StudySettings | None = None
    radial_clearances: Annotated[tuple[float, ...], NOT_IN_FILES] = ()
    thermal_models: Annotated[tuple[ThermalModel, ...], NOT_IN_FILES] = ()
    source: Annotated[Path | None, NOT_IN_FILES] = None
    text: Annotated[str, NOT_IN_FILES] = field(default="", repr=False)

    @property
    def sha256(self) -> str:
        """Hash of the text in UTF-8."""
        return hashlib.sha256(self.text.encode()).hexdigest()

    @property
    def load_direction(self) -> float:
        """Angle of the load in the frame in which the bearing is given [rad]."""
        return self.operating.load_direction

    @property
    def housing_turn(self) -> float:
        """Angle from the bearing as a case has it to the housing's frame, which machines count in.

        The load's direction [rad]; 0 where pads stand by the load, in whose place is a machine's x.
        """
        if self.bearing.pads and stand_by_load(tomllib.loads(self.text)["bearing"]):
            return 0.0
        return self.load_direction

    @property
    def speeds(self) -> Array:
        """Speeds (n,), ascending [rad/s], read-only."""
        speeds = np.array(self.operating.speeds)
        speeds.setflags(write=False)
        return speeds

    @property
    def target(self) -> Target:
        """Eccentricity ratio or load that fixes the journal."""
        return self.operating.target

    def __repr__(self) -> str:
        models = ", ".join(map(str, self.thermal_models))
        return f"<Scenario: {self.title}; {models}; {len(self.speeds)} speeds>"

    @classmethod
    def from_text(cls, text: str, source: str | Path | None = None) -> Scenario:
        """Read a scenario from TOML text.

        Parameters
        ----------
        text : str
        source : str or Path, optional
            Where the text came from, for messages.

        Raises
        ------
        ScenarioError
            With file, key, value and what is allowed.

        Examples
        --------
        >>> scenario = Scenario.from_text('''
        ... [bearing]
        ... journal_radius = "50 mm"
        ... length = "80 mm"
        ... radial_clearance = "4 mil"
        ... [lubricant]
        ... viscosity = "4e-6 reyn"
        ... [operating]
        ... speed = "3000 rpm"
        ... load = "10 kN"
        ... ''')
        >>> scenario.radial_clearances
        (0.0001016,)
        """
        path = None if source is None else Path(source)
        name = "scenario text" if path is None else str(path)
        tables = parse_toml(text, name)
        reader = Reader(tables, cls, name)
        arguments = reader.arguments()
        try:
            thermal = arguments.pop("thermal", ThermalSettings())
            models = reader.lists.get("thermal.models", (ThermalModel.ISOTHERMAL,))
            scenario = cls(
                **arguments,
                thermal=replace(thermal, model=models[0]),
                radial_clearances=reader.lists["bearing.radial_clearance"],
                thermal_models=models,
                source=path,
                text=text,
            )
            if not scenario.title:
                title = "untitled" if path is None else printable(path.stem)
                scenario = replace(scenario, title=title)
            return settled(scenario, tables)
        except InputError as error:
            raise reader.error(error) from None

    def replace(self, **changes: Any) -> Scenario:
        """Return the scenario with some entries changed, read and checked as a file is.

        Parameters
        ----------
        **changes
            New values by the entry's key: ``load=12e3``, ``radial_clearance=90e-6`` (or a list),
            ``supply_temperature=313.15``, ``speed=[900.0, 1200.0]``, ``thermal_model="thd"``. A key
            that several tables have is that of [operating], [bearing], [thermal], [lubricant],
            [film], [rotor], [orbit] or [stability], the first that has it; with its table it is
            written ``**{"orbit.speed": 900.0}``. Numbers are in SI, texts have units;
            None removes an entry or a table. A load takes the place of an eccentricity ratio, one
            description of the oil that of another.

        Raises
        ------
        InputError
            There is no such entry, or the changed scenario is refused.

        Examples
        --------
        >>> scenario = load_scenario("quick").replace(load="12 kN", radial_clearance=90e-6)
        >>> scenario.target, scenario.radial_clearances
        (LoadTarget(load=12000.0), (9e-05,))
        """
        text = _changed_text(self.text, type(self), changes)
        return type(self).from_text(text, self.source)

    def case(
        self,
        radial_clearance: float | None = None,
        thermal_model: ThermalModel | str | None = None,
    ) -> Case:
        """Return one bearing with one thermal model; what leaves no choice may be omitted.

        Parameters
        ----------
        radial_clearance : float, optional
            One of `radial_clearances` [m].
        thermal_model : ThermalModel or str, optional
            One of `thermal_models`.

        Raises
        ------
        ScenarioError
            Not in the scenario, or omitted where there is a choice.
        """
        clearance = self._clearance(radial_clearance)
        model = self._thermal_model(thermal_model)
        bearing = replace(self.bearing, radial_clearance=clearance)
        return Case(
            bearing=bearing.turned(-self.load_direction),
            lubricant=self.lubricant,
            film=self.film,
            thermal=replace(self.thermal, model=model),
            target=self.target,
        )

    def cases(self) -> Iterator[Case]:
        """Return every case: thermal model by thermal model, each with all clearances."""
        for model in self.thermal_models:
            for clearance in self.radial_clearances:
                yield self.case(clearance, model)

    def _clearance(self, wanted: float | None) -> float:
        if wanted is None and len(self.radial_clearances) == 1:
            return self.radial_clearances[0]
        if wanted is not None:
            finite_number(wanted, "radial_clearance", "m")
        for clearance in self.radial_clearances:
            if wanted is not None and math.isclose(clearance, wanted, rel_tol=1e-6):
                return clearance
        allowed, said = (
            ", ".join(f"{one * factor:g}" for one in self.radial_clearances) for factor in (1, 1e6)
        )
        raise ScenarioError(
            f"must be one of the clearances that the scenario lists: {allowed} m ({said} µm)",
            source=self.source,
            key="radial_clearance",
            value=wanted,
        )

    def _thermal_model(self, wanted: ThermalModel | str | None) -> ThermalModel:
        if wanted is None and len(self.thermal_models) == 1:
            return self.thermal_models[0]
        for model in self.thermal_models:
            if model == wanted:
                return model
        allowed = ", ".join(self.thermal_models)
        raise ScenarioError(
            f"must be one of the scenario's models: {allowed}",
            source=self.source,
            key="thermal_model",
            value=wanted,
        )


def load_scenario(path: str | Path) -> Scenario:
    """Read and validate a scenario file.

    Parameters
    ----------
    path : str or Path
        A file, or, where there is none of that name, the name of a shipped scenario (see
        `rotorsim.shipped_scenarios`), as on the command line.

    Raises
    ------
    ScenarioError
        The file cannot be read or an entry is wrong: file, key, value and what is allowed.

    Examples
    --------
    >>> load_scenario("quick").source.name
    'quick.toml'
    """
    file_path(path)
    shipped = shipped_scenarios().get(str(path))
    if shipped is not None and not Path(path).exists():
        path = shipped
    return Scenario.from_text(read_text(path), source=path)


_ORDER = ("operating", "bearing", "thermal", "lubricant", "film", "rotor", "orbit", "stability")
"""Tables in which a key without its table is looked for."""
_ALSO = {"thermal_model": "thermal.models", "model": "thermal.models", "mesh": "film.mesh"}
_INSTEAD: dict[tuple[str, ...], tuple[str, ...]] = {
    ("operating", "load"): ("eccentricity_ratio",),
    ("operating", "eccentricity_ratio"): ("load",),
    ("lubricant", "iso_vg"): (
        "viscosity", "viscosity_points", "reference_temperature",
        "viscosity_temperature_coefficient",
    ),
    ("lubricant", "viscosity"): ("iso_vg", "viscosity_index", "viscosity_points"),
    ("lubricant", "viscosity_points"): (
        "viscosity", "iso_vg", "viscosity_index", "reference_temperature",
        "viscosity_temperature_coefficient",
    ),
}  # fmt: skip
"""Entries that another one takes the place of."""


def _changed_text(text: str, root: Any, changes: Mapping[str, object]) -> str:
    """Return TOML text in which some entries are changed.

    text : Of a valid scenario.
    root : What the whole text describes.
    changes : New values by key; see `Scenario.replace`.
    Raises InputError: No such key, or nothing that a file could hold.
    """
    tables = tomllib.loads(text)
    for name, value in changes.items():
        path = _path(root, name)
        inner = tables
        for part in path[:-1]:
            inner = inner.setdefault(part, {})
            if isinstance(inner, list):
                inner = _one_of_several(inner, part, name)
        if value is None:
            inner.pop(path[-1], None)
            continue
        inner[path[-1]] = _written(value, _entry(root, path), name)
        for other in _INSTEAD.get(path, ()):
            if other not in (_path(root, given)[-1] for given in changes):
                inner.pop(other, None)
    return to_toml(tables)


_NUMBER = re.compile(r"\[(\d+)\]")


def _one_of_several(several: list, part: str, name: str) -> dict[str, Any]:
    """Return the table of a list that a name like ``bearing.pocket[0].depth`` means."""
    asked = re.search(rf"\b{part}{_NUMBER.pattern}", name)
    number = int(asked[1]) if asked else 0
    if (asked is None and len(several) != 1) or number >= len(several):
        last = len(several) - 1
        raise InputError(
            f"is one of several: say which, {part}[0] to {part}[{last}], or give the whole list",
            key=name,
        )
    return several[number]


def _path(root: Any, name: str) -> tuple[str, ...]:
    """Return the table and key of a name, with or without its table, numbers in lists left out."""
    tables = tables_of(root)
    *table, key = _NUMBER.sub("", str(_ALSO.get(name, name))).split(".")
    if not table and key in tables[()]:
        return (key,)
    places = [tuple(table)] if table else [(one,) for one in _ORDER]
    for place in places:
        if key in tables.get(place, ()):
            return (*place, key)
    known = sorted({key for keys in tables.values() for key in keys})
    raise InputError(f"is no entry of a scenario{nearest(key, known)}", key=name)


def entry_kind(root: Any, name: str) -> tuple[str, str | None]:
    """Return the key of an entry with its table, and its kind of quantity (None: a plain number).

    Raises InputError: There is no such entry.
    """
    path = _path(root, name)
    entry = _entry(root, path)
    plain = ".".join(path)
    written = name if _NUMBER.search(name) else plain
    return written, None if entry is None else _kind(entry)


def _entry(root: Any, path: tuple[str, ...]) -> Entry | None:
    makers = makers_of(root)[path[:-1]]
    return next((entries(maker)[path[-1]] for maker in makers if path[-1] in entries(maker)), None)


def _written(value: Any, entry: Entry | None, name: str) -> Any:
    """Return a value as a file has it: numbers in SI with their unit."""
    if isinstance(value, (str, bool)):
        return str(value) if isinstance(value, str) else value
    if isinstance(value, Mapping):
        return {str(key): _written(one, entry, f"{name}.{key}") for key, one in value.items()}
    if isinstance(value, (list, tuple)) or (isinstance(value, np.ndarray) and value.ndim == 1):
        return [_written(one, entry, name) for one in value]
    kind = None if entry is None else _kind(entry)
    number = finite_number(value, name, "" if kind is None else QUANTITIES[kind].unit)
    if kind is not None:
        return f"{number!r} {QUANTITIES[kind].unit}"
    return int(number) if isinstance(value, (int, np.integer)) else number


def _kind(entry: Entry) -> str | None:
    """Return the kind of quantity of an entry."""
    marks = [mark for mark in marks_of(entry.hint) if isinstance(mark, (Quantity, Leaf))]
    return marks[0].kind if marks else None


def to_toml(tables: Mapping[str, Any]) -> str:
    """Return TOML text: one line for each entry."""
    lines = [_line(key, value) for key, value in tables.items() if not isinstance(value, dict)]
    for name, table in tables.items():
        if isinstance(table, dict):
            lines += ["", f"[{name}]", *(_line(key, one) for key, one in table.items())]
    return "\n".join([*lines, ""]).lstrip("\n")


def _line(key: str, value: Any) -> str:
    return f"{_key(key)} = {_toml(value)}"


def _key(name: str) -> str:
    """Return the key as TOML has it: in quotes where it holds a dot."""
    return json.dumps(name, ensure_ascii=False) if "." in name else name


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(_line(key, one) for key, one in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)
