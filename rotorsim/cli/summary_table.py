"""The closing words of the main job."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..pipeline.wording import (
    RPM,
    ZERO_CELSIUS,
    curve_title,
    number,
    thresholds_text,
    verdict_at_top,
)
from .stability_tables import orbit_table
from .tables import grid

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table

    from ..pipeline import StabilityCurve

_COMPARED = ("load", "friction_force", "max_pressure")


def closing(said: Mapping[str, Any], curves: Sequence[StabilityCurve]) -> Iterator[RenderableType]:
    """What was computed, what converged, headline results, where the files are."""
    counts = ", ".join(f"{count} {status}" for status, count in said["counts"].items())
    yield f"\n[bold]{said['title']}[/bold]: {sum(said['counts'].values())} film points, {counts}"
    if said["heating"]:
        yield heating_table(said["heating"])
    if curves:
        yield threshold_table(curves)
    if said["orbits"]:
        yield orbit_table(said["orbits"])
    yield files_table(said["files"])
    for path in said["files"].get("recording", []):
        yield f"Play it back: rotorsim view {path}"


def heating_table(rows: Sequence[Mapping[str, Any]]) -> Table:
    """Isothermal and THD at the highest speed, with what heating takes away."""
    table = grid(
        f"At {rows[0]['speed'] * RPM:.0f} rpm",
        "c um",
        "model",
        "load N",
        "friction N",
        "p_max MPa",
        "T_max C",
        "M_crit kg",
    )
    for row in rows:
        models = [name for name in row if name not in ("radial_clearance", "speed")]
        for place, model in enumerate(models):
            one = row[model]
            table.add_row(
                number(row["radial_clearance"] * 1e6) if place == 0 else "",
                model,
                number(one["load"]),
                number(one["friction_force"]),
                number(one["max_pressure"] / 1e6),
                number(one["max_temperature"] - ZERO_CELSIUS),
                _mass(one),
            )
        if {"isothermal", "thd"} <= set(models):
            table.add_row("", "by heating", *_changes(row["isothermal"], row["thd"]))
        table.add_section()
    return table


def _mass(one: Mapping[str, Any]) -> str:
    if one["critical_mass"] is not None:
        return number(one["critical_mass"])
    return "-" if one["stability"] is None else one["stability"].value.replace("_", " ")


def _changes(cold: Mapping[str, Any], hot: Mapping[str, Any]) -> list[str]:
    texts = [_percent(cold[key], hot[key]) for key in _COMPARED]
    return [*texts, "", _percent(cold["critical_mass"], hot["critical_mass"])]


def _percent(cold: float | None, hot: float | None) -> str:
    if not cold or hot is None or not math.isfinite(hot / cold):
        return ""
    change = round(100.0 * (hot / cold - 1.0), 1)
    return f"{change:+.1f} %" if change else "0 %"


def threshold_table(curves: Sequence[StabilityCurve]) -> Table:
    """Whether the rotor is stable at the highest speed, and where that changes."""
    rotor = curves[0].rotor
    title = "Stability" + (f", {rotor}" if rotor else "")
    top = f"at {curves[0].speed[-1] * RPM:.0f} rpm"
    table = grid(title, "bearing", *([top] if rotor else []), "threshold rpm")
    for curve in curves:
        verdict = [verdict_at_top(curve)] if rotor else []
        table.add_row(curve_title(curve), *verdict, thresholds_text(curve))
    return table


def files_table(files: Mapping[str, Any]) -> Table:
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
