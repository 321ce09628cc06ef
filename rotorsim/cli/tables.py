"""Results as tables for a terminal of 80 to 100 columns."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from ..bearing.description import (
    curve_title,
    matrix_rows,
    point_rows,
    point_status,
    point_text,
    point_title,
)
from ..rows import QUANTITIES

if TYPE_CHECKING:
    from ..bearing.operating_point import OperatingPoint

_COLUMNS = (
    "speed", "eccentricity_ratio", "load", "min_film_thickness", "max_pressure",
    "max_temperature", "power_loss", "critical_mass",
)  # fmt: skip


def grid(title: str, *columns: str) -> Table:
    """Empty table: the first column to the left, the others to the right."""
    from rich import box

    table = Table(
        title=title,
        title_justify="left",
        title_style="bold",
        box=box.SIMPLE_HEAD,
        show_header=any(columns),
        show_edge=False,
        padding=(0, 1, 0, 0),
        pad_edge=False,
    )
    for index, column in enumerate(columns):
        table.add_column(column, justify="right" if index else "left", no_wrap=True)
    return table


def points_tables(points: Sequence[OperatingPoint]) -> Iterator[Table]:
    """One table for each thermal model and clearance, one line for each speed."""
    for curve, group in itertools.groupby(
        points, lambda point: (point.thermal_model, point.radial_clearance)
    ):
        table = grid(curve_title(*curve), *(QUANTITIES[name].head for name in _COLUMNS), "status")
        for point in group:
            style = "green" if point.converged else "bold red"
            status = Text("ok" if point.converged else point_status(point), style=style)
            table.add_row(*(point_text(point, name) for name in _COLUMNS), status)
        yield table


def point_table(point: OperatingPoint) -> Table:
    """One operating point in full."""
    table = grid(f"{point_title(point)}" + (": converged" if point.converged else ""), "", "", "")
    for row in point_rows(point):
        table.add_row(*row)
    table.columns[2].justify = "left"
    for number, (name, first, second, unit) in enumerate(matrix_rows(point)):
        table.add_row(name, f"{first:>12}  {second:>12}", unit, end_section=number % 2 == 1)
    return table
