"""The closing words of the main job."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rich.text import Text

from ..rows import QUANTITIES, RPM
from ..study.wording import curve_title, late_whirl, thresholds_text, verdict_at_top
from .output import as_typed
from .stability_tables import orbit_table
from .tables import grid

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table

    from ..study.stability import StabilityCurve

_COLUMNS = ("load", "min_film_thickness", "max_pressure", "power_loss", "side_flow")
"""What isothermal and THD are compared by."""
_LEAST_WALL_SHARE = 0.005
"""Of the heat through the walls, from which on it is said."""


def closing(said: Mapping[str, Any], curves: Sequence[StabilityCurve]) -> Iterator[RenderableType]:
    """What was computed, what converged, headline results, where the files are."""
    counts = ", ".join(f"{count} {status}" for status, count in said["counts"].items())
    points = f": {sum(said['counts'].values())} film points, {counts}"
    yield Text.assemble("\n", (said["title"], "bold"), points)
    if said["heating"]:
        yield heating_table(said["heating"], rigid=not curves or not _flexible(curves[0]))
        lines = "\n".join(walls_lines(said["heating"]))
        if lines:
            yield lines
    if curves:
        yield _threshold_table(curves)
    if said["orbits"]:
        yield orbit_table(said["orbits"])
        lines = "\n".join(late_whirl(said["orbits"], curves))
        if lines:
            yield lines
    yield _files_table(said["files"])
    for path in said["files"].get("recording", []):
        yield f"Play it back: rotorsim view {as_typed(path)}"


def _flexible(curve: StabilityCurve) -> bool:
    """Whether the rotor is not the rigid one of which a critical mass speaks."""
    return bool(curve.rotor) and curve.mass is None


def heating_table(rows: Sequence[Mapping[str, Any]], *, rigid: bool = True) -> Table:
    """Isothermal and THD at the highest speed, with what heating changes.

    Beside a rotor that is not rigid no critical mass is shown.
    """
    columns = (*_COLUMNS, "max_temperature", *(["critical_mass"] if rigid else []))
    heads = [QUANTITIES[name].head.replace("side flow", "flow") for name in columns]
    table = grid(f"At {rows[0]['speed'] * RPM:.0f} rpm", "c µm", "model", *heads)
    for row in rows:
        models = _models(row)
        for place, model in enumerate(models):
            one = row[model]
            table.add_row(
                QUANTITIES["radial_clearance"].text(row["radial_clearance"]) if place == 0 else "",
                model,
                *(QUANTITIES[key].text(one[key], 4) for key in (*_COLUMNS, "max_temperature")),
                *([_mass(one)] if rigid else []),
            )
        if {"isothermal", "thd"} <= set(models):
            table.add_row("", "by heating", *_changes(row["isothermal"], row["thd"], rigid=rigid))
        table.add_section()
    return table


def walls_lines(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """What leaves through bush and shaft instead of with the oil, where that is anything."""
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


def _mass(one: Mapping[str, Any]) -> str:
    if one["critical_mass"] is not None:
        return QUANTITIES["critical_mass"].text(one["critical_mass"])
    said = "" if one["stability"] is None else one["stability"].value
    return said.removeprefix("always_").replace("_", " ") or "-"


def _changes(cold: Mapping[str, Any], hot: Mapping[str, Any], *, rigid: bool) -> list[str]:
    texts = [_percent(cold[key], hot[key]) for key in _COLUMNS]
    mass = [_percent(cold["critical_mass"], hot["critical_mass"])] if rigid else []
    return [*texts, "", *mass]


def _percent(cold: float | None, hot: float | None) -> str:
    if not cold or hot is None or not math.isfinite(hot / cold):
        return ""
    change = round(100.0 * (hot / cold - 1.0), 1)
    return f"{change:+.1f} %" if change else "0 %"


def _threshold_table(curves: Sequence[StabilityCurve]) -> Table:
    """Whether the rotor is stable at the highest speed, and where that changes."""
    rotor = curves[0].rotor
    title = "Stability" + (f", {rotor}" if rotor else "")
    top = f"at {curves[0].speed[-1] * RPM:.0f} rpm"
    table = grid(title, "bearing", *([top] if rotor else []), "threshold rpm")
    for curve in curves:
        verdict = [verdict_at_top(curve)] if rotor else []
        table.add_row(curve_title(curve), *verdict, thresholds_text(curve))
    return table


def _files_table(files: Mapping[str, Any]) -> Table:
    """Where everything is."""
    table = grid("Files", "what", "where")
    table.columns[1].justify = "left"
    table.columns[1].overflow = "fold"
    for what, paths in files.items():
        if len(paths) > 1:
            table.add_row(what, f"{paths[0].parent} ({len(paths)} files)")
        elif paths:
            table.add_row(what, str(paths[0]))
    return table
