"""Machine files from other drawings: tables of sections (CSV), and rotors that ROSS saved.

A table of sections has a column `length` and `outer_diameter`, units in the header or in the row
below, one row for each section from the left end on. Further columns: `inner_diameter`,
`outer_diameter_right`, `inner_diameter_right`, and `mass`, `polar_inertia`, `transverse_inertia` of
a disc at the left end of the section; a last row of length 0 holds that of the right end.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..bearing import csv_cells
from ..bearing.table import CoefficientTable
from ..errors import InputError, TableError
from ..units import parse_unit
from . import ross_rotor

_KINDS = {
    "length": "length", "outer_diameter": "length", "inner_diameter": "length",
    "outer_diameter_right": "length", "inner_diameter_right": "length", "mass": "mass",
    "polar_inertia": "moment of inertia", "transverse_inertia": "moment of inertia",
}  # fmt: skip
_UNITS = {"length": "m", "mass": "kg", "moment of inertia": "kg*m^2"}
_OTHER_NAMES = {
    "l": "length", "od": "outer_diameter", "id": "inner_diameter", "odl": "outer_diameter",
    "idl": "inner_diameter", "odr": "outer_diameter_right", "idr": "inner_diameter_right",
    "outer_diameter_left": "outer_diameter", "inner_diameter_left": "inner_diameter",
    "m": "mass", "ip": "polar_inertia", "it": "transverse_inertia", "id_disc": "transverse_inertia",
}  # fmt: skip
_DISC = ("mass", "polar_inertia", "transverse_inertia")
_SPEEDS = '{ start = "500 rpm", stop = "10000 rpm", count = 20 }   # the range of interest'


def machine_text(path: Path, title: str) -> tuple[str, Mapping[str, CoefficientTable]]:
    """Return TOML text of a machine from another drawing, and tables that it names by file.

    path : A rotor that ROSS saved (``.toml``, ``.json``), or a table of sections (``.csv``).
    Raises InputError: The file is neither, or holds what a machine file cannot.
    """
    if path.suffix.lower() in (".toml", ".json"):
        found = ross_rotor.read_rotor(path)
    elif path.suffix.lower() == ".csv":
        found = ross_rotor.Drawing(*_sections(path))
    else:
        raise InputError(
            "must be a rotor saved by ROSS (.toml, .json) or a table of sections (.csv)",
            key="--from", value=str(path),
        )  # fmt: skip
    return _text(found, title, path.name), found.tables


def _text(drawing: ross_rotor.Drawing, title: str, source: str) -> str:
    length = sum(section["length"] for section in drawing.sections if "layer" not in section)
    lines = [f"# From {json.dumps(source)}.", *(f"# {note}" for note in drawing.notes)]
    lines += [f"title = {json.dumps(title)}", "", "[rotor]", 'kind = "beam"']
    lines += _entries(drawing.rotor)
    for name, tables in (
        ("rotor.section", drawing.sections), ("rotor.disc", drawing.discs),
        ("support", drawing.supports), ("seal", drawing.seals), ("coupling", drawing.couplings),
    ):  # fmt: skip
        for table in tables:
            lines += ["", f"[[{name}]]", *_entries(table)]
    if not drawing.supports:
        lines += [
            "",
            "# The drawing has no bearings. Place them: bearing = 'file.toml' names a",
            "# bearing's scenario, coefficients = 'file.csv' a table.",
        ]  # fmt: skip
        for at in (0.0, length):
            lines += ["[[support]]", f'at = "{at!r} m"', 'stiffness = "100 MN/m"',
                      'damping = "10 kN*s/m"', ""]  # fmt: skip
    speeds = drawing.speeds
    given = (
        _SPEEDS
        if speeds is None
        else f'{{ start = "{speeds[0]!r} rad/s", stop = "{speeds[1]!r} rad/s", count = 20 }}'
    )
    return "\n".join([*lines, "", "[operating]", f"speed = {given}", ""])


def _entries(table: Mapping[str, object]) -> list[str]:
    """Return lines of a TOML table; numbers get the unit of their key."""
    units = ross_rotor.UNITS
    return [f"{key} = {_value(value, units.get(key, ''))}" for key, value in table.items()]


def _value(value: object, unit: str) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(_entries(value)) + " }"
    if isinstance(value, Sequence) and not isinstance(value, str):
        return "[" + ", ".join(_value(one, unit) for one in value) + "]"
    if isinstance(value, float) and unit:
        return json.dumps(f"{value!r} {unit}")
    return json.dumps(value)


def _sections(source: Path) -> tuple[list[dict[str, object]], list[dict[str, object]]]:
    """Return sections and discs of a table."""
    lines, _ = csv_cells.cells(source, lambda names: {"length", "outer_diameter"} <= set(names),
                               _OTHER_NAMES)  # fmt: skip
    if len(lines) < 2:
        raise TableError(
            "needs a header with the columns length and outer_diameter, and a row for each section",
            source=source,
        )
    named = [csv_cells.named(cell, _OTHER_NAMES) for cell in lines[0][1]]
    first = lines[1][1]
    known = [cell for (name, _), cell in zip(named, first, strict=False) if name in _KINDS and cell]
    in_row = bool(known) and all(_number(cell) is None for cell in known)
    units: dict[str, tuple[int, float]] = {}
    for place, (name, unit) in enumerate(named):
        if name not in _KINDS:
            continue
        stated = unit or (first[place].strip("[]() ") if in_row and place < len(first) else "")
        try:
            factor = parse_unit(stated, _KINDS[name])[1]
        except InputError as error:
            raise TableError(
                f"column {name} needs a unit in brackets, or in the row below"
                + (f": {error.message}" if stated else ""), source=source, key="header",
                value=stated or name,
            ) from None  # fmt: skip
        if name in units:
            raise TableError("occurs twice", source=source, key=f"column {name}")
        units[name] = place, factor
    sections: list[dict[str, object]] = []
    discs: list[dict[str, object]] = []
    at = 0.0
    rows = lines[2:] if in_row else lines[1:]
    for count, (number, cells) in enumerate(rows, start=1):
        row: dict[str, float] = {}
        for name, (place, factor) in units.items():
            text = cells[place] if place < len(cells) else ""
            value = _number(text) if text else 0.0
            if value is None or not value >= 0.0:
                raise TableError(
                    "must be a number, 0 or more", source=source,
                    key=f"row {number}, column {name}", value=text,
                )  # fmt: skip
            row[name] = value * factor
        if any(row.get(name) for name in _DISC):
            discs.append({"at": at, **{name: row.get(name, 0.0) for name in _DISC}})
        length = row["length"]
        if length == 0.0 and count == len(rows):
            break
        if not (length > 0.0 and row["outer_diameter"] > 0.0):
            raise TableError(
                "a section needs a length and an outer diameter above 0", source=source,
                key=f"row {number}",
            )  # fmt: skip
        sections.append({name: row[name] for name in _KINDS if name not in _DISC and row.get(name)})
        at += length
    if not sections:
        raise TableError("holds no section", source=source)
    return sections, discs


def _number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
