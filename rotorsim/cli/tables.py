"""Results as tables for a terminal of 80 to 100 columns."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from ..study.wording import RPM, ZERO_CELSIUS, critical_mass_text, number, wall_share_text

if TYPE_CHECKING:
    from ..bearing.operating_point import OperatingPoint


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
    for (model, clearance), group in itertools.groupby(
        points, lambda point: (point.thermal_model, point.radial_clearance)
    ):
        yield _points_table(list(group), f"{model}, c = {number(clearance * 1e6)} um")


def _points_table(points: Sequence[OperatingPoint], title: str) -> Table:
    table = grid(
        title,
        "rpm",
        "eps",
        "load kN",
        "h_min um",
        "p_max MPa",
        "T_max C",
        "loss kW",
        "M_crit kg",
        "status",
    )
    for point in points:
        table.add_row(
            f"{point.speed * RPM:.0f}",
            number(point.eccentricity_ratio, 3),
            number(point.load / 1e3),
            number(point.min_film_thickness * 1e6, 3),
            number(point.max_pressure / 1e6, 3),
            number(point.max_temperature - ZERO_CELSIUS, 3),
            number(point.power_loss / 1e3),
            critical_mass_text(point),
            status_text(point),
        )
    return table


def status_text(point: OperatingPoint) -> Text:
    """Status, coloured."""
    style = "green" if point.converged else "bold red"
    return Text("ok" if point.converged else point.status.value, style=style)


def point_table(point: OperatingPoint) -> Table:
    """One operating point in full."""
    title = (
        f"{point.thermal_model}, c = {number(point.radial_clearance * 1e6)} um, "
        f"{point.speed * RPM:.0f} rpm: {point.status.value}"
    )
    table = grid(title, "", "", "")
    for name, value, unit in _rows(point):
        table.add_row(name, value, unit)
    table.columns[2].justify = "left"
    for label, matrix, unit in (("K", point.stiffness, "N/m"), ("C", point.damping, "N s/m")):
        for (i, row), axis in zip(enumerate(matrix), "xy", strict=True):
            values = "  ".join(f"{value:12.5g}" for value in row)
            table.add_row(f"{label} {axis}x {axis}y", values, unit, end_section=i == 1)
    return table


def _rows(point: OperatingPoint) -> list[tuple[str, str, str]]:
    rows = [
        ("eccentricity ratio", number(point.eccentricity_ratio), ""),
        ("attitude angle", number(math.degrees(point.attitude_angle)), "deg"),
        ("load", number(point.load / 1e3), "kN"),
        ("Sommerfeld number", number(point.sommerfeld_number), ""),
        ("minimum film thickness", number(point.min_film_thickness * 1e6), "um"),
        ("maximum pressure", number(point.max_pressure / 1e6), "MPa"),
        ("maximum temperature", number(point.max_temperature - ZERO_CELSIUS), "degC"),
        ("mean temperature", number(point.mean_temperature - ZERO_CELSIUS), "degC"),
        *_temperature("shaft temperature", point.shaft_temperature),
        *_temperature("oil outlet temperature", point.outlet_temperature),
        ("friction force", number(point.friction_force), "N"),
        ("power loss", number(point.power_loss / 1e3), "kW"),
        ("side flow", number(point.side_flow * 6e4), "L/min"),
        ("critical mass per bearing", critical_mass_text(point), "kg"),
        ("whirl frequency ratio", number(point.whirl_frequency_ratio), ""),
        ("iterations", str(point.iterations), ""),
        ("residual", number(point.residual, 2), ""),
    ]
    if point.heat_imbalance is not None:
        rows.append(("heat through the walls", wall_share_text(point), "%"))
        rows.append(("heat imbalance", number(100.0 * point.heat_imbalance, 2), "%"))
    return rows


def _temperature(label: str, value: float | None) -> list[tuple[str, str, str]]:
    return [] if value is None else [(label, number(value - ZERO_CELSIUS), "degC")]
