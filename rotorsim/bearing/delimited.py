"""Tables as CSV: anyone's speed, K and C, units in the header.

A header names each column and its unit, for example::

    speed [rpm],kxx [N/m],kxy [N/m],kyx [N/m],kyy [N/m],cxx [N s/m],cxy [N s/m],...

Lines beginning with ``#`` are comments. Optional columns: ``thermal_model``, ``radial_clearance``,
``load``, ``status``. Speeds ascend within each thermal model and clearance, which all have the same
ones. A row whose status is not ``converged`` may hold ``nan``.
"""

from __future__ import annotations

import csv
import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..atomic import replacing
from ..errors import TableError
from ..file_kinds import HEAD, FileKind, recognise, sentence
from ..status import SolveStatus
from .table_data import COEFFICIENTS, CONVENTIONS, DIMENSIONS, build

if TYPE_CHECKING:
    import xarray as xr

_LBF, _INCH = 4.4482216152605, 0.0254  # exact by definition
_STIFFNESS = {
    "N/m": 1.0, "N/mm": 1e3, "N/um": 1e6, "kN/m": 1e3, "kN/mm": 1e6, "MN/m": 1e6, "GN/m": 1e9,
    "lbf/in": _LBF / _INCH,
}  # fmt: skip
_DAMPING = {
    unit: factor * scale
    for base, factor in (("N", 1.0), ("kN", 1e3), ("MN", 1e6))
    for length, scale in (("m", 1.0), ("mm", 1e3))
    for unit in (f"{base} s/{length}", f"{base}*s/{length}", f"{base}.s/{length}")
} | {"lbf s/in": _LBF / _INCH, "lbf*s/in": _LBF / _INCH}
_UNITS: dict[str, dict[str, float]] = {
    "speed": {"rad/s": 1.0, "rpm": math.pi / 30.0, "Hz": 2.0 * math.pi, "krpm": 1e3 * math.pi / 30},
    "radial_clearance": {"m": 1.0, "mm": 1e-3, "um": 1e-6, "mil": 2.54e-5, "in": _INCH},
    "load": {"N": 1.0, "kN": 1e3, "lbf": _LBF},
    **{name: _STIFFNESS if name[0] == "k" else _DAMPING for name in COEFFICIENTS},
}
_TEXT = ("thermal_model", "status")
_HEADER = re.compile(r"\s*([A-Za-z_]+)\s*(?:\[([^\]]*)\])?\s*")
_REQUIRED = ("speed", *COEFFICIENTS)
_SEPARATORS = {";": "semicolons", "\t": "tabs", "|": "bars"}
_WRITTEN = "speed as written"
"""Of a row: the speed in the file's own unit, for messages."""

Row = dict[str, float | str]


def read(path: str | Path) -> xr.Dataset:
    """Read a CSV table.

    Raises
    ------
    TableError
        With the file, and the row and column where something is wrong.
    """
    source = Path(path)
    lines = _text(source).splitlines()
    numbered = [
        (number, fields)
        for number, fields in enumerate(csv.reader(lines), start=1)
        if any(f.strip() for f in fields) and not fields[0].lstrip().startswith("#")
    ]
    if len(numbered) < 2:
        raise TableError("a header and at least one row are needed", source=source)
    columns = _parse_header(numbered[0][1], source)
    rows = [
        (number, _parse_row(fields, columns, number, source)) for number, fields in numbered[1:]
    ]
    return _arrange(rows, source)


def _text(source: Path) -> str:
    """Text of a file that is one, and no other kind of file."""
    try:
        data = source.read_bytes()
    except OSError as error:
        raise TableError(f"cannot be read: {error.strerror}", source=source) from error
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise TableError('is text in UTF-16; save it as UTF-8 ("CSV UTF-8")', source=source)
    kind = recognise(data[:HEAD])
    if kind not in (None, FileKind.CSV):
        raise TableError(f"{sentence(kind)}; here a CSV table is needed", source=source)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise TableError(
            f"must be text in UTF-8; byte 0x{data[error.start]:02x} in line {line} is not; save it "
            'as UTF-8 ("CSV UTF-8")',
            source=source,
        ) from error


def _check_separator(fields: list[str], source: Path) -> None:
    """Refuse a header whose columns something else than commas separates."""
    for separator, name in _SEPARATORS.items():
        if len(",".join(fields).split(separator)) >= len(_REQUIRED) > len(fields):
            raise TableError(
                f"the columns are separated by {name}; separate them by commas, with a point for "
                "the decimals",
                source=source,
                key="header",
            )


def _parse_header(fields: list[str], source: Path) -> list[tuple[str, float]]:
    """Name and factor to SI of every column; the factor of a text is 1."""
    _check_separator(fields, source)
    columns: list[tuple[str, float]] = []
    for field in fields:
        match = _HEADER.fullmatch(field)
        name, unit = (match[1].lower(), (match[2] or "").strip()) if match else (field, "")
        if name in _TEXT:
            columns.append((name, 1.0))
            continue
        if name not in _UNITS:
            raise TableError(
                f"unknown column; known are {', '.join((*_UNITS, *_TEXT))}",
                source=source, key="header", value=field,
            )  # fmt: skip
        if unit not in _UNITS[name]:
            raise TableError(
                f"column {name} needs a unit in brackets: {', '.join(_UNITS[name])}",
                source=source, key="header", value=field,
            )  # fmt: skip
        columns.append((name, _UNITS[name][unit]))
    names = [name for name, _ in columns]
    missing = [name for name in _REQUIRED if name not in names]
    if missing:
        raise TableError(f"columns are missing: {', '.join(missing)}", source=source, key="header")
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise TableError(f"columns occur twice: {', '.join(twice)}", source=source, key="header")
    return columns


def _parse_row(
    fields: list[str], columns: list[tuple[str, float]], number: int, source: Path
) -> Row:
    if len(fields) != len(columns):
        more = len(fields) > len(columns)
        raise TableError(
            f"has {len(fields)} fields, the header {len(columns)}"
            + ("; decimals are written with a point, not a comma" if more else ""),
            source=source,
            key=f"row {number}",
        )
    row: Row = {"thermal_model": "given", "status": str(SolveStatus.CONVERGED)}
    texts = {n: f.strip() for (n, _), f in zip(columns, fields, strict=True) if n in _TEXT}
    row.update(texts)
    if row["status"] not in set(SolveStatus):
        raise TableError(
            f"must be one of {', '.join(SolveStatus)}",
            source=source, key=f"row {number}, column status", value=row["status"],
        )  # fmt: skip
    for (name, factor), field in zip(columns, fields, strict=True):
        if name in _TEXT:
            continue
        try:
            value = float(field)
        except ValueError:
            comma = "; write decimals with a point" if re.search(r"\d,\d", field) else ""
            raise TableError(
                f"not a number{comma}",
                source=source,
                key=f"row {number}, column {name}",
                value=field,
            ) from None
        excused = name not in ("speed", "radial_clearance") and row["status"] != "converged"
        if not (math.isfinite(value) or excused):
            raise TableError(
                "must be finite", source=source, key=f"row {number}, column {name}", value=field
            )
        if name in ("speed", "radial_clearance", "load") and value <= 0.0:
            raise TableError(
                "must be above 0", source=source, key=f"row {number}, column {name}", value=field
            )
        row[name] = value * factor
        if name == "speed":
            row[_WRITTEN] = field.strip()
    return row


def _arrange(rows: list[tuple[int, Row]], source: Path) -> xr.Dataset:
    """Group rows by thermal model and clearance, check the speeds, build the dataset."""
    groups: dict[tuple[str, float], list[tuple[int, Row]]] = {}
    for number, row in rows:
        # NaN would make every row a group of its own.
        key = (str(row["thermal_model"]), float(row.get("radial_clearance", -1.0)))
        group = groups.setdefault(key, [])
        if group and float(row["speed"]) <= float(group[-1][1]["speed"]):
            raise TableError(
                f"speeds must ascend, and {group[-1][1][_WRITTEN]} stands before; sort the rows",
                source=source, key=f"row {number}, column speed", value=row[_WRITTEN],
            )  # fmt: skip
        group.append((number, row))
    models = list(dict.fromkeys(model for model, _ in groups))
    clearances = sorted({clearance for _, clearance in groups})
    first = next(iter(groups.values()))
    speeds = [float(row["speed"]) for _, row in first]
    ordered: list[Row] = []
    for model in models:
        for clearance in clearances:
            group = groups.get((model, clearance), [])
            if [float(row["speed"]) for _, row in group] != speeds:
                where = f"row {group[0][0]}" if group else "rows"
                raise TableError(
                    f"thermal model {model}, clearance {clearance:.6g} m: every thermal model and "
                    "clearance needs the same speeds", source=source, key=f"{where}, column speed",
                )  # fmt: skip
            ordered += [row for _, row in group]
    known_clearances = [np.nan] if clearances == [-1.0] else clearances
    shape = (len(models), len(clearances), len(speeds))
    names = [n for n in (*COEFFICIENTS, "load") if n in ordered[0]]
    variables = {n: np.array([float(r[n]) for r in ordered]).reshape(shape) for n in names}
    status = np.array([str(r["status"]) for r in ordered], dtype=object).reshape(shape)
    variables["status"] = status
    values = (models, known_clearances, speeds)
    coordinates: dict[str, Any] = dict(zip(DIMENSIONS, values, strict=True))
    return build(coordinates, variables, {"title": f"Coefficients from {source.name}"})


def write(dataset: xr.Dataset, path: str | Path) -> Path:
    """Write the coefficients (SI) of every point.

    Raises
    ------
    TableError
        The table has further dimensions (select first), or the file cannot be written.
    """
    target = Path(path)
    dims = dataset["kxx"].dims
    single = dataset.squeeze([d for d in dims if d not in DIMENSIONS and dataset.sizes[d] == 1])
    if set(single["kxx"].dims) != set(DIMENSIONS):
        raise TableError(f"select one of each further dimension first: {dims}", source=target)
    names = [n for n in (*COEFFICIENTS, "load") if n in single]
    with_clearance = bool(np.all(np.isfinite(single["radial_clearance"].values)))
    header = ["thermal_model", *(["radial_clearance [m]"] if with_clearance else [])]
    header += ["speed [rad/s]", "status"]
    header += [f"{n} [{'N' if n == 'load' else 'N/m' if n[0] == 'k' else 'N s/m'}]" for n in names]
    try:
        with (
            replacing(target) as temporary,
            temporary.open("w", newline="", encoding="utf-8") as file,
        ):
            file.writelines(f"# {line}\n" for line in CONVENTIONS)
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(header)
            for index in np.ndindex(single["kxx"].shape):
                model, clearance, speed = (
                    single[d].values[i] for d, i in zip(DIMENSIONS, index, strict=True)
                )
                row = [model, *([repr(float(clearance))] if with_clearance else [])]
                row += [repr(float(speed)), single["status"].values[index]]
                writer.writerow(row + [repr(float(single[n].values[index])) for n in names])
    except OSError as error:
        raise TableError(f"cannot be written: {error.strerror}", source=target) from error
    return target
