"""Results as tables for a terminal of 80 to 100 columns."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
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
from ..model import ThermalModel
from ..orbit.description import ORBIT_HEADS, ellipse_text, orbit_texts, whirl_range_text
from ..rows import QUANTITIES, RPM, number, shown, shown_unit
from ..study.inputs import input_rows
from ..study.stability import late_whirl, verdict_word
from .drawing import bearing_in_text
from .output import as_typed

if TYPE_CHECKING:
    from rich.console import RenderableType

    from ..bearing.operating_point import OperatingPoint
    from ..files.scenario import Scenario
    from ..study.main_job import Results
    from ..study.stability import StabilityCurve


_COLUMNS = (
    "speed", "eccentricity_ratio", "load", "min_film_thickness", "max_pressure",
    "max_temperature", "power_loss", "critical_mass",
)  # fmt: skip


_SMALL = QUANTITIES["radial_clearance"]
"""Unit of small lengths."""


def _head(symbol: str, unit: str) -> str:
    return f"{symbol} {shown_unit(unit)[0]}"


def grid(title: str, *columns: str, rows: Iterable[Iterable[RenderableType]] = ()) -> Table:
    """Return a table: the first column to the left, the others to the right.

    A column without a name holds remarks, which wrap; numbers do not.
    """
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
        justify = "right" if index and column else "left"
        table.add_column(column, justify=justify, no_wrap=bool(column))
    for row in rows:
        table.add_row(*row)
    return table


def points_tables(points: Sequence[OperatingPoint]) -> Iterator[Table]:
    """Return a table for each thermal model and clearance, a line for each speed."""
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
    """Return one operating point in full."""
    table = grid(f"{point_title(point)}" + (": converged" if point.converged else ""), "", "", "")
    for row in point_rows(point):
        table.add_row(*row)
    table.columns[2].justify = "left"
    for place, (name, first, second, unit) in enumerate(matrix_rows(point)):
        table.add_row(name, f"{first:>12}  {second:>12}", unit, end_section=place % 2 == 1)
    return table


def overview(scenario: Scenario, cases: Sequence[dict[str, Any]]) -> Iterator[RenderableType]:
    """Return the inputs, derived numbers at the highest speed, and the amount of work."""
    yield bearing_in_text(scenario.bearing)
    yield _inputs(scenario)
    numbers = ("sommerfeld", "reynolds", "taylor", "peclet", "nahme")
    yield grid(
        f"At {scenario.speeds[-1] * RPM:.0f} rpm", "model", _head("c", "µm"), _head("U", "m/s"),
        *map(str.capitalize, numbers), _head("dT adiab.", "K"),
        rows=[
            [case["thermal_model"].value, _SMALL.text(case["radial_clearance"]),
             shown(case["surface_speed"], "m/s"),
             *(number(case[f"{name}_number"]) for name in numbers),
             shown(case["adiabatic_temperature_rise"], "K", 3)]
            for case in cases
        ],
    )  # fmt: skip
    heated = [case for case in cases if case["thermal_model"] is ThermalModel.THD]
    if heated:
        yield _warm_table(heated)
    mesh, speeds = scenario.film.mesh, len(scenario.speeds)
    work = (
        f"{count} {what}{'s' * (count != 1)}"
        for count, what in ((len(cases), "case"), (speeds, "speed"), (len(cases) * speeds, "point"))
    )
    yield (
        f"{next(work)} x {next(work)} = {next(work)} on {mesh.circumferential} x {mesh.axial} x "
        f"{mesh.cross_film} cells (around, along, across)"
    )


def _warm_table(cases: Sequence[dict[str, Any]]) -> RenderableType:
    """Return the flow numbers with the viscosity at supply temperature and of the warm film."""
    heads = (_head("c", "µm"), _head("T", "°C"))
    rows = [
        [clearance, QUANTITIES["max_temperature"].text(case[temperature]),
         number(case[f"{state}viscosity"] * 1e3), number(case[f"{state}reynolds_number"]),
         number(case[f"{state}taylor_number"])]
        for case in cases
        for clearance, temperature, state in (
            (_SMALL.text(case["radial_clearance"]), "supply_temperature", ""),
            ("", "warm_temperature", "warm_"),
        )
    ]  # fmt: skip
    return grid(
        "Cold, and warm (estimated)",
        *heads,
        shown_unit("mPa s")[0],
        "Reynolds",
        "Taylor",
        rows=rows,
    )


def _inputs(scenario: Scenario) -> RenderableType:
    table = grid(scenario.title, "", "")
    table.columns[1].justify = "left"
    table.columns[1].no_wrap = False
    for rows in input_rows(scenario).values():
        for row in rows:
            table.add_row(row.label, row.with_unit)
        table.add_section()
    return table


_VERDICTS = {
    "always_stable": "stable at any mass",
    "always_unstable": "unstable at any mass",
    "reversed_threshold": "stable above",
    "": "not converged",
}
_THRESHOLD = ("critical_mass", "critical_mass_dimensionless", "whirl_frequency_ratio")


def curve_table(curve: StabilityCurve) -> Table:
    """Return one curve over speed.

    The critical mass is a rigid rotor's: beside another rotor it would not be that rotor's limit.
    With tilting pads the last column is the growth rate that their coefficients, reduced at the
    shaft's frequency, would give.
    """
    rigid = curve.eigenvalues is None or curve.mass is not None
    head = ["rpm", *(QUANTITIES[name].head for name in _THRESHOLD), "verdict"] if rigid else ["rpm"]
    if curve.eigenvalues is not None:
        head += ["growth 1/s", "whirl rpm"] if rigid else ["verdict", "growth 1/s", "whirl rpm"]
    synchronous = curve.growth_rate_synchronous
    if synchronous is not None:
        head.append("synchronous 1/s")
    table = grid(curve.title, *head)
    rates = curve.growth_rate
    for index, speed in enumerate(curve.speed):
        cells = [f"{speed * RPM:.0f}"]
        if rigid:
            cells += _threshold_cells(curve, index)
        if curve.eigenvalues is not None and rates is not None:
            slowest, rate = curve.eigenvalues[index, 0], float(rates[index])
            if not rigid:
                cells.append(verdict_word(rate) if math.isfinite(rate) else _VERDICTS[""])
            cells += [number(rate), number(abs(slowest.imag) * RPM)]
        if synchronous is not None:
            cells.append(number(float(synchronous[index])))
        table.add_row(*cells)
    return table


def _threshold_cells(curve: StabilityCurve, index: int) -> list[str]:
    """Return the critical mass, dimensionless too, whirl ratio, and what they say of the mass."""
    mass = curve.critical_mass[index]
    verdict = str(curve.stability[index])
    said = _VERDICTS.get(verdict)
    if verdict == "threshold" and curve.mass is not None:
        said = "stable" if curve.mass < mass else "unstable"
    values = (QUANTITIES[name].text(getattr(curve, name)[index]) for name in _THRESHOLD)
    return [*values, said or "stable below"]


def summary_table(curves: Sequence[StabilityCurve]) -> Table:
    """Return the threshold speeds of all curves."""
    rotor = curves[0].rotor if curves else ""
    title = rotor[:1].upper() + rotor[1:] or "Critical mass"
    table = grid(title, "bearing", _head("least M_crit", "kg"), "threshold speeds rpm")
    for curve in curves:
        known = curve.critical_mass[np.isfinite(curve.critical_mass)]
        table.add_row(curve.title, number(known.min() if known.size else None),
                      curve.thresholds_text)  # fmt: skip
    return table


def orbit_table(rows: Sequence[Mapping[str, Any]]) -> Table:
    """Return a table of orbits, a line each (`rotorsim.orbit.description.describe_orbit`)."""
    expected = any("eigenvalue_growth_rate" in row for row in rows)
    columns = ["model", "run", "speed", "turns", "eccentricity", "growth"]
    columns += ["expected", "outcome"] if expected else ["outcome"]
    by = " (expected: by the eigenvalues)" if expected else ""
    table = grid(f"Orbits{by}", *(ORBIT_HEADS[name] for name in columns))
    for row in rows:
        texts = orbit_texts(row)
        texts["run"] = texts["run"].removesuffix(" speed")
        texts["speed"] = texts["speed"].replace(" to ", "-")
        table.add_row(*(texts[name] for name in columns))
    return table


def orbit_details(rows: Sequence[Mapping[str, Any]]) -> list[Any]:
    """Return whirl, ellipse and least film of each run, and what its force takes for granted."""
    lengths = (_head(name, "µm") for name in ("swing", "ellipse", "h_min"))
    table = grid("What they come to", "model", "whirl ratio", *lengths)
    notes = []
    for row in rows:
        table.add_row(
            row["thermal_model"],
            number(row["whirl_frequency_ratio"]),
            _SMALL.text(row["amplitude"], 4),
            ellipse_text(row["whirl"] or row["synchronous"]),
            _SMALL.text(row["min_film"], 4),
        )
        if row["whirl_range"] is not None:
            notes.append(f"{row['thermal_model']}: {whirl_range_text(row['whirl_range'])}")
        notes += [f"{row['thermal_model']}: {row['message']}"] if row["message"] else []
    return [table, *notes]


_HEATED = ("load", "min_film_thickness", "max_pressure", "power_loss", "side_flow")
"""Results by which isothermal and THD are compared."""
_LEAST_WALL_SHARE = 0.005
"""Of the heat through the walls, from which on it is said."""


def closing(said: Mapping[str, Any], results: Results) -> Iterator[RenderableType]:
    """Return what was computed, what converged, headline results, where the files are."""
    from ..study.measured import deviation_rows, deviations

    curves = results.curves
    counts = ", ".join(f"{count} {status}" for status, count in said["counts"].items())
    points = f": {sum(said['counts'].values())} film points, {counts}"
    yield Text.assemble("\n", (said["title"], "bold"), points)
    if said["heating"]:
        # Of a rotor that is not rigid no critical mass speaks.
        rigid = not curves or not curves[0].rotor or curves[0].mass is not None
        yield _heating_table(said["heating"], rigid=rigid)
        lines = "\n".join(_walls_lines(said["heating"]))
        if lines:
            yield lines
    if curves:
        yield _verdict_table(curves)
    if said["orbits"]:
        yield orbit_table(said["orbits"])
        lines = "\n".join(late_whirl(said["orbits"], curves))
        if lines:
            yield lines
    if results.measured:
        head, rows = deviation_rows(deviations(results.table, results.measured))
        yield grid("Computed less measured", *head, rows=rows)
    if said.get("transient"):
        yield Text.assemble("\n", ("Thermal transient: ", "bold"), said["transient"]["verdict"])
    yield _files_table(said["files"])
    for path in said["files"].get("recording", []):
        yield f"Play it back: rotorsim view {as_typed(path)}"


def _heating_table(rows: Sequence[Mapping[str, Any]], *, rigid: bool = True) -> Table:
    """Return isothermal and THD at the highest speed, with what heating changes.

    Beside a rotor that is not rigid no critical mass is shown.
    """
    columns = (*_HEATED, "max_temperature", *(["critical_mass"] if rigid else []))
    heads = [QUANTITIES[name].head.replace("side flow", "flow") for name in columns]
    table = grid(f"At {rows[0]['speed'] * RPM:.0f} rpm", _head("c", "µm"), "model", *heads)
    for row in rows:
        models = _models(row)
        for place, model in enumerate(models):
            one = row[model]
            table.add_row(
                QUANTITIES["radial_clearance"].text(row["radial_clearance"]) if place == 0 else "",
                model,
                *(QUANTITIES[key].text(one[key], 4) for key in (*_HEATED, "max_temperature")),
                *([_critical_mass(one)] if rigid else []),
            )
        if {"isothermal", "thd"} <= set(models):
            cold, hot = row["isothermal"], row["thd"]
            changes = [_percent(cold[key], hot[key]) for key in (*_HEATED, "critical_mass")]
            table.add_row("", "by heating", *changes[:-1], "", *(changes[-1:] if rigid else []))
        table.add_section()
    return table


def _walls_lines(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Return the heat that leaves through bush and shaft instead of with the oil, if any."""
    for row in rows:
        for model in _models(row):
            share = row[model]["wall_heat_share"]
            if share is not None and math.isfinite(share) and abs(share) >= _LEAST_WALL_SHARE:
                yield (
                    f"Through bush and shaft go {100.0 * share:.0f} % of the heat ({model}, "
                    f"{QUANTITIES['radial_clearance'].said(row['radial_clearance'])})"
                )


def _models(row: Mapping[str, Any]) -> list[str]:
    return [name for name in row if name not in ("radial_clearance", "speed")]


def _critical_mass(one: Mapping[str, Any]) -> str:
    if one["critical_mass"] is not None:
        return QUANTITIES["critical_mass"].text(one["critical_mass"])
    said = "" if one["stability"] is None else one["stability"].value
    return said.removeprefix("always_").replace("_", " ") or "-"


def _percent(cold: float | None, hot: float | None) -> str:
    if not cold or hot is None or not math.isfinite(hot / cold):
        return ""
    change = round(100.0 * (hot / cold - 1.0), 1)
    return f"{change:+.1f} %" if change else "0 %"


def _verdict_table(curves: Sequence[StabilityCurve]) -> Table:
    """Return whether the rotor is stable at the highest speed, and where that changes."""
    rotor = curves[0].rotor
    title = "Stability" + (f", {rotor}" if rotor else "")
    top = f"at {curves[0].speed[-1] * RPM:.0f} rpm"
    rows = [
        [curve.title, *([curve.verdict or "-"] if rotor else []), curve.thresholds_text]
        for curve in curves
    ]
    return grid(title, "bearing", *([top] if rotor else []), "threshold rpm", rows=rows)


def _files_table(files: Mapping[str, Any]) -> Table:
    """Return the files that were written."""
    table = grid("Files", "what", "where")
    table.columns[1].justify = "left"
    table.columns[1].overflow = "fold"
    for what, paths in files.items():
        if len(paths) > 1:
            table.add_row(what, f"{paths[0].parent} ({len(paths)} files)")
        elif paths:
            table.add_row(what, str(paths[0]))
    return table
