"""Operating points and coefficient tables as text: rows for terminal, report and notebooks."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..rows import (
    QUANTITIES,
    RPM,
    Row,
    facts_html,
    in_shown_unit,
    number,
    result_html,
    shown,
    shown_unit,
    table_html,
    with_unit,
)

if TYPE_CHECKING:
    from .operating_point import OperatingPoint
    from .table import CoefficientTable

_TURBULENT = ("reynolds_number", "laminar_share", "transitional_share", "turbulent_share")
"""Left out of a laminar point's rows."""
_POINT_ROWS = (
    "eccentricity_ratio", "attitude_angle", "load", "sommerfeld_number", "min_film_thickness",
    "max_pressure", "max_temperature", "mean_temperature", "shaft_temperature",
    "hot_radial_clearance", "hot_preload", "deflection", "outlet_temperature", "friction_force",
    "power_loss", "side_flow", "critical_mass", "whirl_frequency_ratio", "wall_heat_share",
    "heat_imbalance",
    *_TURBULENT,
)  # fmt: skip
"""Quantities of an operating point, in the order in which they are shown."""
_THERMAL = (
    "shaft_temperature",
    "hot_radial_clearance",
    "hot_preload",
    "deflection",
    "outlet_temperature",
    "wall_heat_share",
    "heat_imbalance",
)
"""Left out of a point's rows where they are not known."""
COEFFICIENT_HEAD = ("rpm", "Kxx", "Kxy", "Kyx", "Kyy", "Cxx", "Cxy", "Cyx", "Cyy")


def point_title(point: OperatingPoint) -> str:
    """Return ``thd, c = 100 µm, 15000 rpm``, and the status where it is not converged."""
    return curve_title(
        point.thermal_model,
        point.radial_clearance,
        f"{point.speed * RPM:.0f} rpm" + ("" if point.converged else f": {point_status(point)}"),
    )


def curve_title(thermal_model: str, radial_clearance: float, *more: str) -> str:
    """Return ``thd, c = 100 µm``, and what else is said; not an unknown clearance."""
    known = math.isfinite(radial_clearance)
    clearance = [QUANTITIES["radial_clearance"].said(radial_clearance)] if known else []
    return ", ".join([thermal_model, *clearance, *more])


def grouped_warnings(points: Sequence[OperatingPoint]) -> list[str]:
    """Return one line for each kind of warning.

    Its last wording, and at how many points from where on.

    Warnings that differ in their numbers alone are of one kind.
    """
    kinds: dict[str, list[tuple[OperatingPoint, str]]] = {}
    for point in points:
        for text in point.warnings:
            kinds.setdefault(re.sub(r"[\d.]+", "0", text), []).append((point, text))
    lines = []
    for found in kinds.values():
        (first, _), (last, text) = found[0], found[-1]
        where = point_title(first)
        if len(found) > 1:
            where = f"{len(found)} of {len(points)} points, from {where} to {point_title(last)}"
        lines.append(f"{text} (at {where})")
    return lines


def point_status(point: OperatingPoint) -> str:
    """Return the status in words."""
    return point.status.value.replace("_", " ")


def point_text(point: OperatingPoint, name: str, digits: int | None = None) -> str:
    """Return one of a point's `QUANTITIES` as text, in the unit shown; a dash if unknown."""
    if name == "wall_heat_share":
        heat = point.heat_balance
        known = heat is not None and math.isfinite(heat.wall_share)
        return str(round(100.0 * heat.wall_share)) if heat is not None and known else "-"
    if name == "critical_mass" and point.critical_mass is None:
        return {"always_stable": "stable", "always_unstable": "unstable"}.get(
            point.stability or "", "-"
        )
    return QUANTITIES[name].text(getattr(point, name), digits)


def point_line(point: OperatingPoint) -> str:
    """Return where a point is and what it comes to, in a line."""
    load = "no load known" if point.load is None else with_unit(point.load / 1e3, "kN")
    return (
        f"{point.thermal_model}, {point.speed * RPM:.0f} rpm, "
        f"{QUANTITIES['radial_clearance'].said(point.radial_clearance)}, "
        f"e/c {point.eccentricity_ratio:.3g}, {load}, {point.status.value}"
    )


def point_rows(point: OperatingPoint) -> list[Row]:
    """Return what a point comes to, row by row: equilibrium, film, heat, rigid rotor, solver."""
    rows = []
    for name in _POINT_ROWS:
        if name in _TURBULENT and not point.laminar_share < 1.0:
            continue
        digits = QUANTITIES[name].digits
        text = point_text(point, name, 4 if digits == 3 else digits)
        if text != "-" or name not in _THERMAL:
            unit = QUANTITIES[name].unit if text[-1:].isdigit() else ""
            rows.append(Row(QUANTITIES[name].label, text, unit))
    factor, unit = QUANTITIES["side_flow"].factor, QUANTITIES["side_flow"].unit
    for k, flow in enumerate(point.supply_flow, start=1):
        rows.append(Row(f"supply flow of groove {k}", number(flow * factor), unit))
    for k, pressure in enumerate(point.groove_pressure, start=1):
        rows.append(
            Row(f"pressure in groove {k}", shown(pressure / 1e6, "MPa"), shown_unit("MPa")[0])
        )
    if np.any(np.nan_to_num(point.moment)):
        rows.append(
            Row(
                "moments on the journal",
                ", ".join(shown(m, "N m") for m in point.moment),
                shown_unit("N m")[0],
            )
        )
    return [
        *rows,
        Row("iterations", str(point.iterations)),
        Row("residual", number(point.residual, 2)),
    ]


def matrix_rows(point: OperatingPoint) -> list[tuple[str, str, str, str]]:
    """Return K and C row by row: name, two values, unit."""
    return [
        (
            f"{letter} {axis}x {axis}y",
            f"{in_shown_unit(row[0], unit):.5g}",
            f"{in_shown_unit(row[1], unit):.5g}",
            shown_unit(unit)[0],
        )
        for letter, matrix, unit in (("K", point.stiffness, "N/m"), ("C", point.damping, "N s/m"))
        for axis, row in zip("xy", np.asarray(matrix), strict=True)
    ]


def point_html(point: OperatingPoint) -> str:
    """Return the operating point for notebooks."""
    return result_html(
        f"{point_title(point)}" + (": converged" if point.converged else ""),
        facts_html(point_rows(point)),
        table_html(("", "", "", ""), matrix_rows(point)),
        notes=(point.message, *point.warnings),
    )


def coefficient_tables(table: CoefficientTable) -> Iterator[tuple[str, list[list[str]]]]:
    """Yield for each curve of a table its title and the rows under `COEFFICIENT_HEAD`."""
    units = f"K in {shown_unit('MN/m')[0]}, C in {shown_unit('kN s/m')[0]}"
    for index in np.ndindex(table.converged.shape[:-1]):
        names = {
            name: table.dataset[name].values[place]
            for name, place in zip(table.choices, index, strict=True)
        }
        title = curve_title(str(names["thermal_model"]), float(names["radial_clearance"]))
        stiffness = in_shown_unit(table.stiffness[index] / 1e6, "MN/m")
        damping = in_shown_unit(table.damping[index] / 1e3, "kN s/m")
        yield (
            f"{title}: {units}",
            [
                [f"{speed * RPM:.0f}", *(number(float(v)) for v in (*k.ravel(), *c.ravel()))]
                for speed, k, c in zip(table.speeds, stiffness, damping, strict=True)
            ],
        )


def table_html_of(table: CoefficientTable) -> str:
    """Return a table for notebooks; of many speeds the lowest, middle and highest."""
    sizes = ", ".join(f"{table.dataset.sizes[name]} × {name}" for name in table.dataset["kxx"].dims)
    low, high = table.speeds[0] * RPM, table.speeds[-1] * RPM
    good, total, last = int(table.converged.sum()), table.converged.size, table.speeds.size - 1
    shown = table
    if last >= 12:
        shown = type(table)(table.dataset.isel(speed=[0, last // 2, last]))
    return result_html(
        str(table.dataset.attrs.get("title", "Coefficient table")),
        f"<p>{sizes}; {low:.0f} to {high:.0f} rpm; {good} of {total} points converged</p>",
        *(
            table_html(COEFFICIENT_HEAD, rows, title, texts=0)
            for title, rows in coefficient_tables(shown)
        ),
    )
