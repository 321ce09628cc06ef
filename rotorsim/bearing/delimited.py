"""Coefficients as CSV: how measured ones, or another program's, come in, and how tables go out.

The header names each column and its unit, in the same cell or in the row below::

    speed [rpm],kxx [N/m],kxy [N/m],kyx [N/m],kyy [N/m],cxx [N s/m],cxy [N s/m],...

Lines beginning with ``#`` are comments. Optional columns: ``thermal_model``, ``radial_clearance``,
``load``, ``status``; columns of another name are left out. Speeds ascend within each thermal model
and clearance, which all have the same ones; without a column of speeds the coefficients are
constant. A row whose status is not ``converged`` may hold ``nan``. Columns are separated by commas,
or by semicolons, tabs or bars, and then the decimals may be written with a comma. Columns in plain
text, separated by blanks, may have their header and units in comments.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arguments import file_path
from ..atomic import write_text
from ..errors import InputError, TableError
from ..status import SolveStatus
from ..units import parse_unit
from . import csv_cells
from .csv_cells import LONGEST_NAME, MASSES, Line, named
from .table_data import build, without_standstill
from .table_format import (
    ATTRIBUTES,
    COEFFICIENTS,
    CONSTANT,
    CONSTANT_SPEEDS,
    CONVENTIONS,
    DIMENSIONS,
    FASTEST,
    FULL_COEFFICIENTS,
    LARGEST,
    NOTES,
)

if TYPE_CHECKING:
    import xarray as xr

_KINDS = {
    "speed": "speed",
    "radial_clearance": "length",
    "load": "force",
    **{name: "stiffness" if name[0] == "k" else "damping" for name in COEFFICIENTS},
}
"""Columns of quantities, and the kind of each."""
_UNIT_EXAMPLES = {
    "speed": "rpm, rad/s, Hz",
    "length": "um, mm, mil",
    "force": "N, kN, lbf",
    "stiffness": "N/m, MN/m, lbf/in",
    "damping": "N s/m, kN s/m, lbf s/in",
}
_LARGEST = {"speed": FASTEST, "length": 1.0, "force": LARGEST, "stiffness": LARGEST}
_WHIRL = ("frequency", "whirl_frequency", "excitation_frequency", "frequency_ratio")
_TEXT = ("thermal_model", "status")
_NUMBER = re.compile(
    r"[+-]?(\d+(\.\d*)?|\.\d+)(e[+-]?\d+)?|[+-]?(nan|inf|infinity)", re.IGNORECASE | re.ASCII
)
_DIGITS = re.compile(r"[+-]?[\d.,]+(e[+-]?\d+)?", re.IGNORECASE | re.ASCII)
"""A number, or what somebody meant as one."""
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(,\d{3})+", re.ASCII)
_WRITTEN = "speed as written"
"""Of a row: the speed in the file's own unit, for messages."""
_FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""Beginnings of cells that a spreadsheet program would evaluate."""
_Row = dict[str, float | str]


@dataclass(frozen=True)
class _Column:
    """Content of a column: `name` is a key of `_KINDS`, one of `MASSES`, or one of `_TEXT`."""

    place: int
    name: str
    factor: float = 1.0


def read(path: str | Path) -> xr.Dataset:
    """Read a CSV table.

    Raises TableError: With the file, and the row and column where something is wrong.
    """
    source = file_path(path)
    lines, separator = csv_cells.cells(source, {"kxx", "cxx"}.issubset, whole=True)
    units, rows = _units_row(lines)
    if not rows:
        raise TableError("a header and at least one row are needed", source=source)
    columns, left_out = _columns(lines[0][1], units, rows, source)
    comma = separator != "," and _decimal_comma(rows, columns, source)
    width = len(lines[0][1])
    parsed = [
        (number, _row(cells, columns, width, comma, number, source)) for number, cells in rows
    ]
    notes = [f"columns left out: {', '.join(left_out)}"] if left_out else []
    return without_standstill(_arrange(parsed, source, notes), source)


def _units_row(lines: list[Line]) -> tuple[list[str] | None, list[Line]]:
    """Return the cells of the row of units, where there is one, and the rows below."""
    if len(lines) < 2:
        return None, []
    names = [named(cell)[0] for cell in lines[0][1]]
    cells = lines[1][1]
    known = [cell for name, cell in zip(names, cells, strict=False) if name in _KINDS]
    numbers = any(_NUMBER.fullmatch(cell) or _DIGITS.fullmatch(cell) for cell in known)
    stated = any(named(cell)[1] for cell in lines[0][1] if named(cell)[0] in COEFFICIENTS)
    if any(known) and not numbers and not stated:
        return [cell.strip("[]() ") for cell in cells], lines[2:]
    return None, lines[1:]


def _columns(
    header: list[str], units: list[str] | None, rows: list[Line], source: Path
) -> tuple[list[_Column], list[str]]:
    """Return the columns that count, and the names of those that are left out."""
    columns: list[_Column] = []
    left_out: list[str] = []
    for place, cell in enumerate(header):
        name, unit = named(cell)
        if not unit and units is not None and place < len(units):
            unit = units[place]
        if not unit and cell.strip().lower() == "rpm":
            unit = "rpm"
        if name in _KINDS:
            columns.append(_Column(place, name, _factor(name, unit, cell, source)))
        elif name in _TEXT or name in MASSES:
            columns.append(_Column(place, name))
        elif name in _WHIRL:
            raise TableError(
                "coefficients over whirl frequency are not read; where it is the shaft's speed, "
                "delete the column",
                source=source, key="header", value=_shown(cell),
            )  # fmt: skip
        elif any(place < len(cells) and cells[place] for _, cells in rows):
            left_out.append(cell[:LONGEST_NAME] or f"number {place + 1}")
    names = [column.name for column in columns]
    missing = [name for name in COEFFICIENTS if name not in names]
    if missing:
        known = ", ".join((*_KINDS, *_TEXT))
        unknown = f"; unknown column: {', '.join(left_out[:9])}; known are {known}"
        raise TableError(
            f"columns are missing: {', '.join(missing)}{unknown if left_out else ''}",
            source=source, key="header",
        )  # fmt: skip
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise TableError(f"columns occur twice: {', '.join(twice)}", source=source, key="header")
    return sorted(columns, key=lambda column: column.name != "speed"), left_out


def _factor(name: str, unit: str, cell: str, source: Path) -> float:
    """Return the SI value over the number in the file."""
    kind = _KINDS[name]
    try:
        return parse_unit(unit, kind)[1]
    except InputError as error:
        reason = f": {error.message}" if unit else ""
        raise TableError(
            f"column {name} needs a unit in brackets, or in the row below "
            f"({_UNIT_EXAMPLES[kind]} and others){reason}",
            source=source, key="header", value=_shown(cell if not unit or unit in cell else unit),
        ) from None  # fmt: skip


def _decimal_comma(rows: list[Line], columns: list[_Column], source: Path) -> bool:
    """Return whether decimals are written with a comma.

    In a file whose columns something else separates.

    Raises TableError: Commas stand only where thousands might be parted, or numbers have points as
        well.
    """
    places = [column.place for column in columns if column.name in _KINDS]
    with_comma = [
        (number, cells[place])
        for number, cells in rows
        for place in places
        if place < len(cells) and "," in cells[place]
    ]
    if not with_comma:
        return False
    number, cell = with_comma[0]
    if all(_THOUSANDS.fullmatch(cell) for _, cell in with_comma):
        raise TableError(
            "the comma may stand for decimals or between thousands; write decimals with a point",
            source=source, key=f"row {number}", value=_shown(cell),
        )  # fmt: skip
    for number, cells in rows:
        for place in places:
            if place < len(cells) and "." in cells[place]:
                raise TableError(
                    "decimals are written with a point here and with a comma elsewhere",
                    source=source, key=f"row {number}", value=_shown(cells[place]),
                )  # fmt: skip
    return True


def _row(
    cells: list[str], columns: list[_Column], width: int, comma: bool, number: int, source: Path
) -> _Row:
    """Return the values of a line [SI]; `width` is the number of cells in the header."""
    needed = max(column.place for column in columns) + 1
    more = any(cells[width:])
    if more or len(cells) < needed:
        raise TableError(
            f"has {len(cells)} fields, the header {width}"
            + ("; decimals are written with a point, not a comma" if more else ""),
            source=source,
            key=f"row {number}",
        )
    row: _Row = {"thermal_model": "given", "status": str(SolveStatus.CONVERGED)}
    for column in columns:
        if column.name in _TEXT:
            row[column.name] = _plain_text(cells[column.place])
    if row["status"] not in set(SolveStatus):
        raise TableError(
            f"must be one of {', '.join(SolveStatus)}",
            source=source, key=f"row {number}, column status", value=_shown(str(row["status"])),
        )  # fmt: skip
    for column in columns:
        if column.name not in _TEXT:
            cell = cells[column.place]
            key = f"row {number}, column {column.name}"
            if column.name in MASSES:
                _check_no_mass(cell.replace(",", ".") if comma else cell, key, source)
                continue
            value = _value(cell.replace(",", ".") if comma else cell, cell, key, source)
            row[column.name] = _checked(value * column.factor, row, column.name, cell, key, source)
            if column.name == "speed":
                row[_WRITTEN] = _shown(cell)
    return row


def _shown(cell: str) -> str:
    """Return the cell for a message."""
    return cell if len(cell) <= LONGEST_NAME else f"{cell[:LONGEST_NAME]}..."


def _value(text: str, cell: str, key: str, source: Path) -> float:
    if _NUMBER.fullmatch(text):
        return float(text)
    comma = "; write decimals with a point" if re.search(r"\d,\d", text) else ""
    raise TableError(f"not a number{comma}", source=source, key=key, value=_shown(cell))


def _checked(value: float, row: _Row, name: str, cell: str, key: str, source: Path) -> float:
    """Return a value [SI] that its column may hold."""
    unused = row["status"] != "converged" or row.get("speed") == 0.0
    excused = name not in ("speed", "radial_clearance") and unused
    if not (math.isfinite(value) or excused):
        raise TableError("must be finite", source=source, key=key, value=_shown(cell))
    if abs(value) > _LARGEST.get(_KINDS[name], LARGEST):
        raise TableError(
            "is beyond every sensible value", source=source, key=key, value=_shown(cell)
        )
    if name == "speed" and value < 0.0:
        raise TableError("must be above 0", source=source, key=key, value=_shown(cell))
    if name in ("radial_clearance", "load") and value <= 0.0:
        raise TableError("must be above 0", source=source, key=key, value=_shown(cell))
    return value


def _check_no_mass(text: str, key: str, source: Path) -> None:
    """Refuse added mass: of a number that is not 0, or of what is no number."""
    if text and _value(text, text, key, source) != 0.0:
        raise TableError(
            "added mass is not known here: K and C alone would give another verdict; take it into "
            "the rotor's mass and set it to 0",
            source=source, key=key, value=_shown(text),
        )  # fmt: skip


def _plain_text(cell: str) -> str:
    """Return text of a cell, without the apostrophe that `write` puts before a formula's sign."""
    return cell[1:] if cell[:1] == "'" and cell[1:].startswith(_FORMULA) else cell


def _arrange(rows: list[tuple[int, _Row]], source: Path, notes: list[str]) -> xr.Dataset:
    """Group rows by thermal model and clearance, check the speeds, build the dataset."""
    groups: dict[tuple[str, float], list[tuple[int, _Row]]] = {}
    constant = "speed" not in rows[0][1]
    for number, row in rows:
        # NaN would make every row a group of its own.
        key = (str(row["thermal_model"]), float(row.get("radial_clearance", -1.0)))
        group = groups.setdefault(key, [])
        if group and constant:
            raise TableError(
                "several rows need a column of speeds", source=source, key=f"row {number}"
            )
        if group and float(row["speed"]) <= float(group[-1][1]["speed"]):
            raise TableError(
                f"speeds must ascend, and {group[-1][1][_WRITTEN]} stands before; sort the rows",
                source=source, key=f"row {number}, column speed", value=row[_WRITTEN],
            )  # fmt: skip
        group.append((number, row))
    if constant:
        groups = {
            key: [(number, {**row, "speed": speed}) for number, row in group
                  for speed in CONSTANT_SPEEDS]
            for key, group in groups.items()
        }  # fmt: skip
    models = list(dict.fromkeys(model for model, _ in groups))
    clearances = sorted({clearance for _, clearance in groups})
    speeds = [float(row["speed"]) for _, row in next(iter(groups.values()))]
    ordered = list(_ordered(groups, models, clearances, speeds, source))
    known_clearances = [np.nan] if clearances == [-1.0] else clearances
    shape = (len(models), len(clearances), len(speeds))
    names = [n for n in (*COEFFICIENTS, "load") if n in ordered[0]]
    variables = {n: np.array([float(r[n]) for r in ordered]).reshape(shape) for n in names}
    status = np.array([str(r["status"]) for r in ordered], dtype=object).reshape(shape)
    variables["status"] = status
    values = (models, known_clearances, speeds)
    coordinates: dict[str, Any] = dict(zip(DIMENSIONS, values, strict=True))
    attributes: dict[str, Any] = {"title": f"Coefficients from {source.name}"}
    if constant:
        attributes[CONSTANT] = 1
    if notes:
        attributes[NOTES] = "\n".join(notes)
    return build(coordinates, variables, attributes)


def _ordered(
    groups: dict[tuple[str, float], list[tuple[int, _Row]]],
    models: list[str],
    clearances: list[float],
    speeds: list[float],
    source: Path,
) -> Iterator[_Row]:
    """Return the rows model by model and clearance by clearance, all with the same speeds."""
    for model in models:
        for clearance in clearances:
            group = groups.get((model, clearance), [])
            if [float(row["speed"]) for _, row in group] != speeds:
                where = f"row {group[0][0]}" if group else "rows"
                raise TableError(
                    f"thermal model {model}, clearance {clearance:.6g} m: every thermal model and "
                    "clearance needs the same speeds", source=source, key=f"{where}, column speed",
                )  # fmt: skip
            yield from (row for _, row in group)


def write(dataset: xr.Dataset, path: str | Path) -> Path:
    """Write the coefficients (SI) of every point; constant ones once, without a speed.

    Raises TableError: The table has further dimensions (select first), or the file cannot be
        written.
    """
    target = Path(path)
    dims = dataset["kxx"].dims
    single = dataset.squeeze([d for d in dims if d not in DIMENSIONS and dataset.sizes[d] == 1])
    if set(single["kxx"].dims) != set(DIMENSIONS):
        raise TableError(f"select one of each further dimension first: {dims}", source=target)
    single = single.isel(speed=slice(0, 1)) if CONSTANT in dataset.attrs else single
    names = [n for n in (*COEFFICIENTS, "load") if n in single]
    with_clearance = bool(np.all(np.isfinite(single["radial_clearance"].values)))
    with_speed = CONSTANT not in dataset.attrs
    header = ["thermal_model", *(["radial_clearance [m]"] if with_clearance else [])]
    header += [*(["speed [rad/s]"] if with_speed else []), "status"]
    header += [f"{n} [{'N' if n == 'load' else 'N/m' if n[0] == 'k' else 'N s/m'}]" for n in names]
    full = [n for n in ("moment_x", "moment_y", *FULL_COEFFICIENTS) if n in single]
    if FULL_COEFFICIENTS[0] in full:
        names += full
        header += [f"{n} [{ATTRIBUTES[n][0].replace(' m-1', '/m')}]" for n in full]
    stream = io.StringIO()
    stream.writelines(f"# {line}\n" for line in CONVENTIONS)
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(header)
    for index in np.ndindex(single["kxx"].shape):
        model, clearance, speed = (
            single[d].values[i] for d, i in zip(DIMENSIONS, index, strict=True)
        )
        row = [_cell(str(model)), *([repr(float(clearance))] if with_clearance else [])]
        row += [*([repr(float(speed))] if with_speed else []), single["status"].values[index]]
        writer.writerow(row + [repr(float(single[n].values[index])) for n in names])
    try:
        write_text(target, stream.getvalue())
    except OSError as error:
        raise TableError(f"cannot be written: {error.strerror}", source=target) from error
    return target


def _cell(text: str) -> str:
    """Return the text as a cell that no spreadsheet program takes for a formula."""
    return f"'{text}" if text.startswith(_FORMULA) else text
