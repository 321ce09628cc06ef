"""Formats of tables, and from a file's name to its reader."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ..arguments import file_path
from ..atomic import replacing, write_text
from ..bearing.table import CoefficientTable
from ..bearing.table_format import ATTRIBUTES, COEFFICIENTS, CONVENTIONS, SCALARS
from ..errors import TableError
from ..file_kinds import SUFFIXES, FileKind, is_missing, kind_of, sentence
from ..rows import RPM
from . import ross
from .curves import Curve, curves

_WIDTH = 16


def _write_text(curve: Curve, path: Path) -> Path:
    """Write one curve; lines beginning with ``#`` say what the numbers mean."""
    names = ["rpm", *COEFFICIENTS]
    units = ["1/min", *["N/m"] * 4, *["N*s/m"] * 4]
    head = [
        *(line for fact in curve.facts for line in fact.splitlines()),
        *CONVENTIONS,
        "".join(f"{name:>{_WIDTH}}" for name in names)[2:],
        "".join(f"{unit:>{_WIDTH}}" for unit in units)[2:],
    ]
    values = np.column_stack(
        [curve.speed * RPM, curve.stiffness.reshape(-1, 4), curve.damping.reshape(-1, 4)]
    )
    rows = ["".join(f"{value:{_WIDTH}.8e}" for value in row) for row in values]
    write_text(path, "\n".join([*(f"# {line}" for line in head), *rows]) + "\n")
    return path


FORMATS = {
    "ross": "ross.toml",
    "ross2": "ross2.toml",
    "csv": "csv",
    "mat": "mat",
    "txt": "txt",
    "nc": "nc",
}
"""Names of the formats, and how their files end."""
_LOAD_FRAME_SUFFIXES = (".nc", ".csv", ".txt")
_SUFFIXES = (*_LOAD_FRAME_SUFFIXES, ".json")
_KINDS = {
    ".nc": (FileKind.NETCDF,),
    ".csv": (FileKind.CSV,),
    ".txt": (FileKind.CSV,),
    ".toml": (FileKind.ROSS,),
    ".json": (FileKind.ROSS, FileKind.JSON),
}
_NO_USE = "has no use: this format is in the load frame, only that of ROSS is not"
_ONE_CURVE: dict[str, Callable[..., Path]] = {
    "ross": ross.write,
    "ross2": partial(ross.write, version=2),
    "txt": _write_text,
}


def write_table(
    table: CoefficientTable,
    kind: str,
    folder: str | Path,
    name: str,
    *,
    load_direction: float | None = None,
) -> list[Path]:
    """Write a table in one format.

    kind : One of `FORMATS`. ``ross`` (ROSS 3), ``ross2`` (ROSS 2) and ``txt`` hold one bearing in a
        file: a table of several thermal models or clearances gives several files.
    folder : str or Path. Made if it is missing.
    name : Of the files, without suffix.
    load_direction : For ``ross`` and ``ross2``: where the static load points in the frame of ROSS
        [rad], from x towards y (with the rotation); by default along -y, the weight. The other
        formats are in the load frame.
    Returns: What was written.
    Raises TableError: No such format, nothing in the table converged, a CSV of a table with further
        dimensions, or a `load_direction` for another format than ``ross``.
    """
    if kind not in FORMATS:
        raise TableError(f"must be one of {', '.join(FORMATS)}", key="format", value=kind)
    if load_direction is not None and not kind.startswith("ross"):
        raise TableError(_NO_USE, key="load_direction", value=load_direction)
    where = Path(folder)
    where.mkdir(parents=True, exist_ok=True)
    if kind in _ONE_CURVE:
        write = _ONE_CURVE[kind]
        if load_direction is not None:
            write = partial(write, load_direction=load_direction)
        return [
            write(curve, where / f"{'_'.join(filter(None, (name, curve.name)))}.{FORMATS[kind]}")
            for curve in curves(table)
        ]
    path = where / f"{name}.{FORMATS[kind]}"
    if kind == "mat":
        return [_write_matlab(table, path)]
    return [table.to_csv(path) if kind == "csv" else table.save(path)]


def is_table(path: str | Path) -> bool:
    """Return whether a file is meant as a table: by its suffix, and a TOML file by its contents."""
    source = Path(path)
    suffix = source.suffix.lower()
    return suffix in _SUFFIXES or (suffix == ".toml" and ross.is_saved_by_ross(source))


def read_table(
    path: str | Path, *, load_direction: float | None = None, bearing: str | None = None
) -> CoefficientTable:
    """Read a table from netCDF (``.nc``), CSV (``.csv``, ``.txt``) or a bearing saved by ROSS.

    path : str or Path
    load_direction : For a bearing saved by ROSS: where the static load points in its frame [rad],
        from x towards y. By default what the file says ([rotorsim] load_direction, as `write_table`
        writes it), and if it says nothing along -y, the weight.
    bearing : Tag or table name of one bearing in a file of ROSS that holds several.
    Raises TableError: No such file, not readable as what its name says, several bearings and none
        chosen, or a `load_direction` for a table in the load frame or against what the file says.
    """
    source = file_path(path)
    suffix = source.suffix.lower()
    if is_missing(source):
        raise TableError("no such file; `rotorsim table SCENARIO` makes a table", source=source)
    if os.path.isdir(source):
        raise TableError("is a directory; give a table", source=source)
    _check_kind(source, suffix)
    if load_direction is not None and suffix in _LOAD_FRAME_SUFFIXES:
        raise TableError(_NO_USE, source=source, key="load_direction", value=load_direction)
    if bearing is not None and suffix in _LOAD_FRAME_SUFFIXES:
        message = "has no use: only files of ROSS hold several bearings"
        raise TableError(message, source=source, key="--bearing", value=bearing)
    if suffix == ".nc":
        return CoefficientTable.load(source)
    if suffix in (".csv", ".txt"):
        return CoefficientTable.from_csv(source)
    if suffix in (".toml", ".json"):
        return ross.read(source, load_direction, bearing)
    raise TableError(
        "a table's name ends in .nc (netCDF), .csv, .txt, or .toml or .json (ROSS)", source=source
    )


def _check_kind(source: Path, suffix: str) -> None:
    """Refuse a file whose contents, or name, are not those of a table."""
    kind = kind_of(source)
    if kind is None or kind in _KINDS.get(suffix, ()):
        return
    renamed = (
        "" if suffix == SUFFIXES.get(kind, suffix) else f"; its name must end in {SUFFIXES[kind]}"
    )
    raise TableError(f"{sentence(kind)}{renamed}; here a table is needed", source=source)


def _write_matlab(table: CoefficientTable, path: Path) -> Path:
    """Write everything: ``K(:,:,i,j,k)`` and ``C`` are 2 x 2 matrices.

    The indices after the first two are speed, clearance (and any further dimension), thermal model:
    the dimensions of the table, last to first. ``dimensions`` in the file lists them.
    """
    from scipy.io import savemat

    dataset = table.dataset
    order = [str(name) for name in dataset["kxx"].dims][::-1]
    contents: dict[str, Any] = {
        "conventions": "\n".join(CONVENTIONS),
        "title": str(dataset.attrs.get("title", "")),
        "dimensions": _cells(order),
        "K": _matrices(table.stiffness),
        "C": _matrices(table.damping),
        "status": _cells(dataset["status"].values.T),
    }
    for name in order:
        values = dataset[name].values
        contents[name] = values.astype(float) if values.dtype.kind in "fi" else _cells(values)
    scalars = [n for n in SCALARS if n in dataset.data_vars]
    contents |= {name: np.asarray(dataset[name].values, dtype=float).T for name in scalars}
    contents["units"] = {n: ATTRIBUTES[n][0] for n in [*order, *scalars] if n in ATTRIBUTES} | {
        letter: ATTRIBUTES[f"{letter.lower()}xx"][0] for letter in "KC"
    }
    contents["coefficient_names"] = _cells(COEFFICIENTS)
    with replacing(path) as temporary, temporary.open("wb") as stream:
        savemat(stream, contents, oned_as="row")
    return path


def _matrices(values: np.ndarray) -> np.ndarray:
    """Turn (..., speed, 2, 2) to (2, 2, speed, ...)."""
    return np.moveaxis(values, (-2, -1), (0, 1)).transpose(0, 1, *range(values.ndim - 1, 1, -1))


def _cells(texts: Any) -> np.ndarray:
    """Return the cell array of texts."""
    source = np.asarray(texts, dtype=object)
    cells = np.empty(source.shape, dtype=object)
    for index in np.ndindex(source.shape):
        cells[index] = str(source[index])
    return cells
