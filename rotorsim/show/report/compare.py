"""Two results beside each other: what was put in otherwise, and what came of it."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Iterator
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from ...bearing.description import curve_title, point_text
from ...rows import QUANTITIES, RPM, heads, in_shown_unit, number, table_html
from ...study import machine_tables as tables
from ...study.inputs import input_rows
from . import html

if TYPE_CHECKING:
    from ...bearing.operating_point import OperatingPoint
    from ...study.machine import MachineResult
    from ...study.main_job import Results

_COMPARED = (
    "eccentricity_ratio", "load", "min_film_thickness", "max_pressure", "max_temperature",
    "power_loss", "side_flow", "critical_mass", "whirl_frequency_ratio",
)  # fmt: skip
_Row = tuple[str, str, str, str]


def comparison(found: Results, other: Results) -> str:
    """Return the section that compares a scenario's results with those of another one.

    At the highest speed of each; a curve is compared with the one of the same thermal model and
    place among the clearances.
    """
    mine, theirs = found.scenario, other.scenario
    inputs = [
        (one.label, f"{one.value} {one.unit}".strip(), f"{two.value} {two.unit}".strip())
        for topic, rows in input_rows(mine).items()
        for one, two in _paired(rows, input_rows(theirs)[topic])
        if one[1:] != two[1:]
    ]
    parts = [_inputs(inputs) or html.paragraph("Inputs: no difference.")]
    for (title, points), (_, others) in zip(_tops(found), _tops(other), strict=False):
        parts.append(_table(f"At {points.speed * RPM:.0f} rpm, {title}", _points(points, others)))
    rows = [
        row
        for one, two in zip(found.curves, other.curves, strict=False)
        for row in (
            (f"{one.title}: verdict", one.verdict or "-", two.verdict or "-", ""),
            (f"{one.title}: threshold rpm", one.thresholds_text, two.thresholds_text, ""),
        )
    ]
    parts.append(_table("Stability", rows))
    return html.section(f"Compared with {theirs.title}", *parts)


def machine_comparison(results: dict[str, MachineResult], others: dict[str, MachineResult]) -> str:
    """Return the section that compares a machine's results with those of another one."""
    mine, theirs = (next(iter(one.values())).description for one in (results, others))
    rows: list[_Row] = []
    for model in [name for name in results if name in others]:
        for (label, value, text), (_, second, said) in zip(
            _machine_rows(results[model]), _machine_rows(others[model]), strict=True
        ):
            rows.append((f"{model}: {label}", text, said, _change(value, second)))
    lines = difflib.unified_diff(
        theirs.text.splitlines(), mine.text.splitlines(), theirs.title, mine.title, lineterm="", n=1
    )
    changed = "\n".join(lines)
    said = f"<pre>{escape(changed)}</pre>" if changed else html.paragraph("The files are the same.")
    return html.section(f"Compared with {theirs.title}", _table("Stability", rows), said)


def _machine_rows(result: MachineResult) -> Iterator[tuple[str, float, str]]:
    lost = [one.speed * RPM for one in result.thresholds]
    yield "verdict at the highest speed", math.nan, str(result.verdict)
    yield "threshold rpm", lost[0] if lost else math.nan, ", ".join(f"{one:.0f}" for one in lost)
    modes = result.modes
    rate = math.nan if modes is None else float(
        modes.growth_rate[-1, int(tables.least_stable_below(modes)[-1])]
    )  # fmt: skip
    yield "growth rate at the highest speed 1/s", rate, number(rate)
    for state in result.supports:
        load = in_shown_unit(float(np.hypot(*state.load[-1])) / 1e3, "kN")
        yield heads(f"load on {state.name} kN")[0], load, number(load)


def _paired(mine: Iterable, theirs: Iterable) -> Iterator[tuple]:
    """Return rows of the same label, once each; a row that one side lacks beside a dash."""
    from ...rows import Row

    first, second = ({row.label: row for row in rows} for rows in (mine, theirs))
    for label in dict.fromkeys([*first, *second]):
        yield first.get(label, Row(label, "-")), second.get(label, Row(label, "-"))


def _tops(found: Results) -> Iterator[tuple[str, OperatingPoint]]:
    top = max((point.speed for point in found.points), default=0.0)
    for point in found.points:
        if point.speed == top:
            yield curve_title(point.thermal_model, point.radial_clearance), point


def _points(one: OperatingPoint, two: OperatingPoint) -> list[_Row]:
    rows = []
    for name in _COMPARED:
        texts = [point_text(point, name) for point in (one, two)]
        if texts != ["-", "-"]:
            values = [getattr(point, name, None) for point in (one, two)]
            first, second = (math.nan if value is None else float(value) for value in values)
            change = "" if name == "max_temperature" else _change(first, second)
            rows.append((QUANTITIES[name].axis, *texts, change))
    return rows


def _change(value: float, other: float) -> str:
    if not (math.isfinite(value) and math.isfinite(other) and other):
        return ""
    change = round(100.0 * (value / other - 1.0), 1)
    return f"{change:+.1f} %" if change else "same"


def _inputs(rows: list[tuple[str, str, str]]) -> str:
    head = ("input", "this", "other")
    return (
        f'<div class="wide">{table_html(head, rows, "Inputs that differ", texts=3)}</div>'
        if rows
        else ""
    )


def _table(title: str, rows: list[_Row]) -> str:
    head = ("", "this", "other", "change")
    return f'<div class="wide">{table_html(head, rows, title)}</div>' if rows else ""
