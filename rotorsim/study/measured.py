"""Measured points beside computed curves.

A CSV file with a column ``speed`` and columns named like results, units in brackets in the header
or in the row below; an empty cell is a point that was not measured.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..arguments import file_path
from ..arrays import Array
from ..bearing import csv_cells
from ..bearing.description import curve_title
from ..bearing.table import CoefficientTable
from ..errors import InputError, TableError
from ..rows import Quantity, quantity
from ..units import QUANTITIES, parse_quantity

_KINDS: dict[str, str | None] = {
    "speed": "speed", "eccentricity_ratio": None, "attitude_angle": "angle", "load": "force",
    "min_film_thickness": "length", "max_pressure": "pressure", "max_temperature": "temperature",
    "mean_temperature": "temperature", "shaft_temperature": "temperature",
    "outlet_temperature": "temperature", "friction_force": "force", "power_loss": "power",
    "side_flow": "volume flow", "critical_mass": "mass", "whirl_frequency_ratio": None,
    **{f"k{i}{j}": "stiffness" for i in "xy" for j in "xy"},
    **{f"c{i}{j}": "damping" for i in "xy" for j in "xy"},
}  # fmt: skip
_OTHER_NAMES = {
    "rpm": "speed", "n": "speed", "e/c": "eccentricity_ratio", "eccentricity": "eccentricity_ratio",
    "tmax": "max_temperature", "t_max": "max_temperature", "temperature": "max_temperature",
    "pmax": "max_pressure", "p_max": "max_pressure", "pressure": "max_pressure",
    "h_min": "min_film_thickness", "loss": "power_loss", "flow": "side_flow",
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Measured:
    """Measured values of one result over speed (SI).

    speed, value : (n,) arrays.
    """

    name: str
    speed: Array
    value: Array


@dataclass(frozen=True, eq=False)
class _Deviation:
    """Deviation of a computed curve from measured points within its speeds.

    points : How many those are.
    mean, largest : Computed less measured, the mean and that of the largest modulus (SI).
    """

    name: str
    thermal_model: str
    radial_clearance: float
    points: int
    mean: float
    largest: float


def read_measured(path: str | Path) -> tuple[Measured, ...]:
    """Read measured points.

    Raises TableError: No column ``speed``, none that is called like a result, a cell that is no
        number with the column's unit.
    """
    source = file_path(path)
    lines, separator = csv_cells.cells(source, lambda names: "speed" in names, _OTHER_NAMES)
    if len(lines) < 2:
        raise TableError(
            f"needs a header with speed and some of {', '.join(list(_KINDS)[1:13])}, and a row",
            source=source,
        )
    heads = [csv_cells.named(cell, _OTHER_NAMES) for cell in lines[0][1]]
    heads = [
        (name, unit or ("rpm" if cell.lower() == "rpm" else ""))
        for (name, unit), cell in zip(heads, lines[0][1], strict=True)
    ]
    rows = lines[1:]
    if not any(_is_number(cell) for cell in rows[0][1]):  # a row of units
        heads = [
            (name, unit or cell.strip("[]() "))
            for (name, unit), cell in zip(heads, rows[0][1], strict=False)
        ]
        rows = rows[1:]
    columns = {
        name: np.array([_value(cells, place, name, unit, separator, number, source)
                        for number, cells in rows])
        for place, (name, unit) in enumerate(heads) if name in _KINDS
    }  # fmt: skip
    speed = columns.pop("speed")
    if not columns:
        raise TableError(
            f"no column is called like a result: {', '.join(list(_KINDS)[1:])}", source=source
        )
    known = np.isfinite(speed)
    return tuple(
        Measured(name, speed[chosen], values[chosen])
        for name, values in columns.items()
        if (chosen := known & np.isfinite(values)).any()
    )


def _is_number(text: str) -> bool:
    try:
        float(text.replace(",", "."))
    except ValueError:
        return False
    return True


def _value(
    cells: list[str], place: int, name: str, unit: str, separator: str, number: int, source: Path
) -> float:
    text = cells[place].strip() if place < len(cells) else ""
    if not text:
        return np.nan
    if separator != ",":
        text = text.replace(",", ".")
    kind = _KINDS[name]
    try:
        if kind is None:
            return float(text)
        return parse_quantity(f"{text} {unit}", kind)
    except (ValueError, InputError) as error:
        said = error.message if isinstance(error, InputError) else "must be a number"
        raise TableError(
            said, source=source, key=f"line {number}, column {name}", value=f"{text} {unit}".strip()
        ) from None


def curves(table: CoefficientTable, name: str) -> Iterator[tuple[str, float, Array]]:
    """Return thermal model, clearance [m] and values over the table's speeds of a result."""
    dataset = table.dataset
    if name not in dataset:
        return
    for model in dataset["thermal_model"].values:
        for clearance in dataset["radial_clearance"].values:
            part = dataset[name].sel(thermal_model=model, radial_clearance=clearance)
            yield str(model), float(clearance), np.asarray(part.values, dtype=float)


def deviations(table: CoefficientTable, measured: Sequence[Measured]) -> list[_Deviation]:
    """Compare measured points with every curve of the table, linear between its speeds."""
    found = []
    for one in measured:
        for model, clearance, values in curves(table, one.name):
            known = np.isfinite(values)
            if not known.any():
                continue
            speeds = table.speeds[known]
            within = (one.speed >= speeds[0] * (1 - 1e-6)) & (one.speed <= speeds[-1] * (1 + 1e-6))
            if not within.any():
                continue
            off = np.interp(one.speed[within], speeds, values[known]) - one.value[within]
            worst = float(off[np.argmax(np.abs(off))])
            found.append(
                _Deviation(one.name, model, clearance, int(within.sum()), float(off.mean()), worst)
            )
    return found


def deviations_document(found: list[_Deviation]) -> list[dict[str, Any]]:
    """Return deviations as plain data (SI)."""
    return [vars(one) for one in found]


def shown_as(name: str) -> Quantity:
    """Return how a measured result is shown."""
    kind = _KINDS[name]
    return quantity(name, "" if kind is None else QUANTITIES[kind].unit)


def deviation_rows(found: Sequence[_Deviation]) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return head and rows of a table of deviations, in the units shown."""
    head = ("result", "curve", "points", "mean", "largest", "")
    rows = []
    for one in found:
        kind = shown_as(one.name)
        rows.append((
            kind.label, curve_title(one.thermal_model, one.radial_clearance), str(one.points),
            *(f"{one_ * kind.factor:+.3g}" for one_ in (one.mean, one.largest)), kind.unit,
        ))  # fmt: skip
    return head, rows
