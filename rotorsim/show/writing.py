"""Writing what the main job computed: recording and figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..rows import RPM, ZERO_CELSIUS
from ..study.orbits import orbit_settings
from ..study.stability import map_planes
from .job_figures import write_figures
from .main_job import Announce, Attempts, Results, compute, summary
from .recordings import cascade_pictures, orbit_notes, orbit_tracks, record, spectrum_pictures

if TYPE_CHECKING:
    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario
    from ..orbit import Orbit
    from .recording import MapPicture, RecordingContents

SURROUNDING_SPEEDS = 12
"""Of the table that is computed for an orbit's recording alone."""


def write_results(
    results: Results, folder: Path, name: str, announce: Announce = lambda _text: None
) -> tuple[dict[str, list[Path]], list[str]]:
    """Write figures and recording.

    Returns
    -------
    files : dict
        ``figures`` and ``recording``, each the paths that were written.
    problems : list of str
        What could not be written, and why.
    """
    attempt = Attempts(announce)
    figures: list[Path] = attempt(
        "figures", lambda: write_figures(results, folder / "figures" / name), []
    )
    recording: list[Path] = attempt(
        "recording", lambda: [write_recording_of(results, folder / "logs" / f"{name}.rrd")], []
    )
    return {"figures": figures, "recording": recording}, attempt.problems


def write_recording_of(results: Results, path: Path) -> Path:
    """Write the whole recording: orbits, film, eigenvalues, map, summary."""
    from .recording import write_recording

    return write_recording(path, recording_contents(results))


def recording_contents(results: Results) -> RecordingContents:
    """Everything that the recording shows."""
    from .recording import RecordingContents

    kinds = {orbit.kind for orbit in results.orbits}
    both = len({orbit.constant_speed for orbit in results.orbits}) > 1
    return RecordingContents(
        title=results.scenario.title,
        summary=markdown_summary(results),
        # Runs at one speed and through the speeds beside each other are the whole job.
        kind=kinds.pop() if len(kinds) == 1 and not both else "",
        orbits=tuple(orbit_tracks(results.orbits)),
        films=results.films,
        eigenvalues=results.eigenvalues,
        maps=tuple(map_pictures(results)),
        cascades=tuple(cascade_pictures(results.orbits)),
        spectra=tuple(spectrum_pictures(results.orbits)),
    )


def record_scenario(
    scenario: Scenario,
    orbits: Sequence[Orbit],
    path: Path,
    *,
    table: CoefficientTable | None = None,
    announce: Announce = lambda _text: None,
    workers: int | None = None,
) -> tuple[Path, list[str]]:
    """Write orbits with what surrounds them: film, eigenvalues, stability map.

    Without `table` one of the orbit's clearance is computed at some of the scenario's speeds.

    Returns
    -------
    Path
        The file written.
    list of str
        What is missing in it, and why.
    """
    attempt = Attempts(announce)
    if table is None:
        table = attempt("coefficients", lambda: surrounding_table(scenario, workers), None)
    if table is None:
        return record(orbits, path, title=scenario.title), attempt.problems
    results = compute(scenario, (), table, announce, orbits)
    return write_recording_of(results, path), [*attempt.problems, *results.problems]


def surrounding_table(scenario: Scenario, workers: int | None = None) -> CoefficientTable:
    """Table of the orbit's clearance at up to `SURROUNDING_SPEEDS` of the scenario's speeds."""
    from ..study.sweep import tabulate

    speeds, settings = scenario.speeds, orbit_settings(scenario)[0]
    count = min(speeds.size, SURROUNDING_SPEEDS)
    chosen = np.unique(np.linspace(0, speeds.size - 1, count).round().astype(int))
    one = replace(
        scenario,
        radial_clearances=(settings.radial_clearance,),
        operating=replace(scenario.operating, speed=tuple(speeds[chosen].tolist())),
    )
    return tabulate(one, workers=workers)


def map_pictures(results: Results) -> list[MapPicture]:
    """Stability map of each clearance: both thermal models in one picture."""
    from .recording import MapPicture, classify

    if results.chart is None:
        return []
    return [
        MapPicture(
            title=f"rigid rotor, c = {plane.radial_clearance * 1e6:.4g} µm",
            speed=plane.speed,
            mass=plane.mass,
            verdict=classify(plane.isothermal_growth, plane.heated_growth),
            rotor_mass=results.rotor_mass,
            isothermal_growth=plane.isothermal_growth,
            heated_growth=plane.heated_growth,
        )
        for plane in map_planes(results.chart)
    ]


def conclusion(facts: dict[str, Any]) -> list[str]:
    """Say what the orbits at constant speed show of heating; nothing without both models."""
    rates = {
        row["thermal_model"]: row
        for row in facts["orbits"]
        if row["kind"] == "constant speed" and row["growth_rate"] is not None
    }
    cold, hot = rates.get("isothermal"), rates.get("thd")
    if cold is None or hot is None:
        return []
    mass = "" if facts["rotor_mass"] is None else f" with {facts['rotor_mass']:.4g} kg per bearing"
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


def markdown_summary(results: Results) -> str:
    """The closing words as Markdown, for the recording."""
    facts = summary(results, {})
    counted = ", ".join(f"{count} {status}" for status, count in facts["counts"].items())
    lines = [*conclusion(facts), *([f"Film points: {counted}.", ""] if counted else [])]
    for row in facts["heating"]:
        lines += [
            f"## c = {row['radial_clearance'] * 1e6:.4g} µm, {row['speed'] * RPM:.0f} rpm",
            "",
            "| model | load N | friction N | p max MPa | T max °C | critical mass kg |",
            "| --- | --- | --- | --- | --- | --- |",
        ]
        for model in results.scenario.thermal_models:
            one = row.get(model.value)
            if one is not None:
                mass = one["critical_mass"]
                critical = one["stability"] or "-" if mass is None else f"{mass:.4g}"
                hottest = one["max_temperature"] - ZERO_CELSIUS
                lines.append(
                    f"| {model.value} | {one['load']:.4g} | {one['friction_force']:.4g} | "
                    f"{one['max_pressure'] / 1e6:.4g} | {hottest:.4g} | "
                    f"{critical} |"
                )
        lines.append("")
    return "\n".join([*lines, orbit_notes(results.orbits, results.orbit_rows)])
