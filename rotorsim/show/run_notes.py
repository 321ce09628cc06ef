"""The main job and its orbits in words, as Markdown for a recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..orbit import Orbit
from ..orbit.description import describe_orbit, run_names, run_title, whirl_range_text
from ..rows import QUANTITIES, RPM, shown, with_unit
from ..study.main_job import Results, summary
from ..study.stability import late_whirl

_MICRO = 1e6
_HEATING = ("load", "friction_force", "max_pressure", "max_temperature", "critical_mass")


def markdown_summary(results: Results) -> str:
    """Return the summary of the main job as Markdown, for the recording."""
    facts = summary(results, {})
    counted = ", ".join(f"{count} {status}" for status, count in facts["counts"].items())
    lines = [*_conclusion(facts), *([f"Film points: {counted}.", ""] if counted else [])]
    for text in late_whirl(facts["orbits"], results.curves):
        lines += [f"{text[0].upper()}{text[1:]}.", ""]
    for row in facts["heating"]:
        at = f"{row['speed'] * RPM:.0f} rpm"
        heads = " | ".join(("model", *(QUANTITIES[name].head for name in _HEATING)))
        clearance = QUANTITIES["radial_clearance"].said(row["radial_clearance"])
        lines += [f"## {clearance}, {at}", "", f"| {heads} |", f"|{' --- |' * (len(_HEATING) + 1)}"]
        for model in results.scenario.thermal_models:
            one = row.get(model.value)
            if one is not None:
                texts = [QUANTITIES[name].text(one[name], 4) for name in _HEATING]
                if one["critical_mass"] is None:
                    texts[-1] = one["stability"] or "-"
                lines.append(f"| {' | '.join((model.value, *texts))} |")
        lines.append("")
    return "\n".join([*lines, orbit_notes(results.orbits, results.orbit_rows)])


def _conclusion(facts: Mapping[str, Any]) -> list[str]:
    """Say what the orbits at constant speed show of heating; nothing without both models."""
    rates = {
        row["thermal_model"]: row
        for row in facts["orbits"]
        if row["kind"] == "constant speed" and row["growth_rate"] is not None
    }
    cold, hot = rates.get("isothermal"), rates.get("thd")
    if cold is None or hot is None:
        return []
    carried = facts["rotor_mass"]
    mass = "" if carried is None else f" with {with_unit(carried, 'kg')} per bearing"
    verdicts = [
        f"{'grows' if row['growth_rate'] > 0.0 else 'decays'} ({row['growth_rate']:+.3g} 1/s)"
        for row in (cold, hot)
    ]
    lines = [
        f"At **{hot['speed'][0] * RPM:.0f} rpm**{mass} the orbit **{verdicts[0]}** if heating is "
        f"neglected and **{verdicts[1]}** with it.",
        "",
    ]
    if cold["growth_rate"] < 0.0 < hot["growth_rate"]:
        lines += ["The rotor that an isothermal calculation calls stable is unstable.", ""]
    return lines


def orbit_notes(orbits: Sequence[Orbit], rows: Sequence[dict[str, Any]] | None = None) -> str:
    """Return what each run shows, how it ended, and what its film force takes for granted.

    As Markdown.

    `rows` are what `describe_orbit` says of the orbits, where that is known already.
    """
    rows = [describe_orbit(orbit) for orbit in orbits] if rows is None else rows
    lines: list[str] = []
    for orbit, name, row in zip(orbits, run_names(orbits), rows, strict=True):
        first, last = (round(speed * RPM) for speed in row["speed"])
        rpm = f"{first} rpm" if first == last else f"{first} to {last} rpm"
        lines.append(
            f"- **{run_title(name)}, {rpm}, {row['revolutions']:.4g} turns:"
            f" {orbit.status.value.replace('_', ' ')}**"
        )
        lines += [f"  - {fact}" for fact in _seen(row)]
        lines += [f"  - {orbit.message}"] if orbit.message else []
    return "\n".join(lines)


def _seen(row: Mapping[str, Any]) -> list[str]:
    """Return what an orbit shows in numbers, a line each."""
    facts = []
    if row["growth_rate"] is not None:
        word = "grow" if row["growth_rate"] > 0.0 else "decay"
        facts.append(f"small motions {word} at {row['growth_rate']:+.4g} 1/s")
    if row["whirl"] is not None:
        whirl = row["whirl"]
        facts.append(
            f"{whirl['direction']} whirl at {whirl['order']:.4f} of the shaft's speed, ellipse"
            f" {shown(whirl['semi_major'] * _MICRO, 'µm')} x "
            f"{with_unit(whirl['semi_minor'] * _MICRO, 'µm')}"
        )
    if row["whirl_range"] is not None:
        facts.append(whirl_range_text(row["whirl_range"]))
    facts.append(
        f"thinnest film {with_unit(row['min_film'] * _MICRO, 'µm')}, after "
        f"{row['min_film_time']:.4g} s"
    )
    return facts
