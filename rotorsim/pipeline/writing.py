"""Writing what the main job computed: recording and figures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from .figures import write_figures
from .main_job import Announce, Attempts, Results, summary
from .recordings import cascade_pictures, eigenvalue_path, orbit_tracks
from .stability import map_planes
from .wording import KELVIN, RPM

if TYPE_CHECKING:
    from ..recording import MapPicture, RecordingContents


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
    from ..recording import write_recording

    return write_recording(path, recording_contents(results))


def recording_contents(results: Results) -> RecordingContents:
    """Everything that the recording shows."""
    from ..recording import RecordingContents

    paths = [
        eigenvalue_path(curve, str(curve.choices["thermal_model"]))
        for curve in results.shown_curves
    ]
    return RecordingContents(
        title=results.scenario.title,
        summary=markdown_summary(results),
        orbits=tuple(orbit_tracks(results.orbits)),
        films=results.films,
        eigenvalues=tuple(path for path in paths if path is not None),
        maps=tuple(map_pictures(results)),
        cascades=tuple(cascade_pictures(results.orbits)),
    )


def map_pictures(results: Results) -> list[MapPicture]:
    """Stability map of each clearance: both thermal models in one picture."""
    from ..recording import MapPicture, classify

    if results.chart is None:
        return []
    return [
        MapPicture(
            title=f"c = {plane.radial_clearance * 1e6:.4g} um",
            speed=plane.speed,
            mass=plane.mass,
            verdict=classify(plane.isothermal_decay, plane.heated_decay),
            rotor_mass=results.rotor_mass,
            isothermal_decay=plane.isothermal_decay,
            heated_decay=plane.heated_decay,
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
    lines = [*conclusion(facts), f"Film points: {counted}.", ""]
    for row in facts["heating"]:
        lines += [
            f"## c = {row['radial_clearance'] * 1e6:.4g} um, {row['speed'] * RPM:.0f} rpm",
            "",
            "| model | load N | friction N | p max MPa | T max degC | critical mass kg |",
            "| --- | --- | --- | --- | --- | --- |",
        ]
        for model in results.scenario.thermal_models:
            one = row.get(model.value)
            if one is not None:
                mass = one["critical_mass"]
                critical = one["stability"] or "-" if mass is None else f"{mass:.4g}"
                lines.append(
                    f"| {model.value} | {one['load']:.4g} | {one['friction_force']:.4g} | "
                    f"{one['max_pressure'] / 1e6:.4g} | {one['max_temperature'] - KELVIN:.4g} | "
                    f"{critical} |"
                )
        lines.append("")
    for row in facts["orbits"]:
        grows = row["growth_rate"]
        rate = "" if grows is None else f", growth {grows:.4g} 1/s"
        lines.append(f"- Orbit {row['thermal_model']}, {row['kind']}: {row['status'].value}{rate}")
    return "\n".join(lines)
