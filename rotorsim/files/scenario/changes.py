"""A scenario's text with some entries changed."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...arguments import finite_number
from ...errors import InputError
from ...model.entries import Entry, Leaf, Quantity, entries, marks_of, nearest
from ...units import QUANTITIES
from .reader import makers_of, tables_of

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


def changed_text(text: str, root: Any, changes: Mapping[str, object]) -> str:
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
            if not isinstance(inner, dict):
                raise InputError("is one of several; give the whole list", key=name)
        if value is None:
            inner.pop(path[-1], None)
            continue
        inner[path[-1]] = _written(value, _entry(root, path), name)
        for other in _INSTEAD.get(path, ()):
            if other not in (_path(root, given)[-1] for given in changes):
                inner.pop(other, None)
    return to_toml(tables)


def _path(root: Any, name: str) -> tuple[str, ...]:
    """Table and key of a name, with or without its table."""
    tables = tables_of(root)
    *table, key = str(_ALSO.get(name, name)).split(".")
    if not table and key in tables[()]:
        return (key,)
    places = [tuple(table)] if table else [(one,) for one in _ORDER]
    for place in places:
        if key in tables.get(place, ()):
            return (*place, key)
    known = sorted({key for keys in tables.values() for key in keys})
    raise InputError(f"is no entry of a scenario{nearest(key, known)}", key=name)


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
    """Kind of quantity of an entry."""
    marks = [mark for mark in marks_of(entry.hint) if isinstance(mark, (Quantity, Leaf))]
    return marks[0].kind if marks else None


def to_toml(tables: Mapping[str, Any]) -> str:
    """Return TOML text: one line for each entry."""
    lines = [
        f"{key} = {_toml(value)}" for key, value in tables.items() if not isinstance(value, dict)
    ]
    for name, table in tables.items():
        if isinstance(table, dict):
            lines += ["", f"[{name}]", *(f"{key} = {_toml(one)}" for key, one in table.items())]
    return "\n".join([*lines, ""]).lstrip("\n")


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_toml(one)}" for key, one in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)
