"""What the main job computed, shown: figures, recordings, and the summary in words."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..orbit import Orbit
from ..orbit.analysis import speed_cascade
from ..orbit.description import describe_orbit, run_names, run_title, whirl_range_text
from ..rows import QUANTITIES, RPM, shown, with_unit
from ..study.main_job import Announce, Attempts, Results, compute, summary
from ..study.orbits import film_at_rest, orbit_settings
from ..study.planes import Plane, held_text
from ..study.stability import late_whirl
from ..study.transient import Transient, transient_frames

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario
    from ..model import Bearing
    from ..study.control import ControlStudy
    from ..study.machine_control import MachineControlStudy
    from ..study.stability import Campbell
    from ..study.tolerances import ToleranceStudy
    from .recording import RecordingContents


_SURROUNDING_SPEEDS = 12
"""Of the table that is computed for an orbit's recording alone."""
_MICRO = 1e6


def write_results(
    results: Results, folder: Path, name: str, announce: Announce = lambda _text: None
) -> tuple[dict[str, list[Path]], list[str]]:
    """Write figures and recording.

    Returns files : dict: ``figures`` and ``recording``, each the paths that were written.
    Returns problems : list of str: What could not be written, and why.
    """
    attempt = Attempts(announce)

    def draw() -> list[Path]:
        return save_figures(figures(results), folder / "figures" / name, ("png",))

    def write() -> list[Path]:
        written = [_write_recording_of(results, folder / "logs" / f"{name}.rrd")]
        if results.transient is not None:
            path = folder / "logs" / f"{name}-transient.rrd"
            written.append(record_transient(results.transient, results.scenario, path))
        return written

    files = {"figures": attempt("figures", draw, []), "recording": attempt("recording", write, [])}
    return files, attempt.problems


def record_transient(transient: Transient, scenario: Scenario, path: Path) -> Path:
    """Write the recording of a thermal transient that kept its fields: film and solids in time."""
    from .recording import RecordingContents, write_recording

    bearing = scenario.bearing.turned(-scenario.load_direction)
    frames = transient_frames(transient, bearing)
    lines = [transient.verdict(), ""]
    small, hot = QUANTITIES["radial_clearance"], QUANTITIES["max_temperature"]
    for name, place in transient.moments().items():
        step = transient.steps[place]
        lines.append(
            f"- {name.replace('_', ' ')} after {step.time:.4g} s: clearance "
            f"{small.with_unit(transient.clearance[place])}, thinnest film "
            f"{small.with_unit(step.point.min_film_thickness)}, journal "
            f"{hot.with_unit(step.shaft_temperature)}, bush "
            f"{hot.with_unit(step.bush_temperature)}"
        )
    return write_recording(
        path, RecordingContents(scenario.title, "\n".join(lines), films=tuple(frames))
    )


def save_figures(
    named: Iterable[tuple[str, Figure]], folder: Path, formats: Sequence[str] = ("png", "svg")
) -> list[Path]:
    """Write named figures into `folder`."""
    from .figures import save_figure

    written: list[Path] = []
    for name, figure in named:
        written += save_figure(figure, folder / name, formats=formats)
        figure.clear()  # it refers to itself in circles: what it drew would stay for a while
    return written


def figures(results: Results) -> Iterator[tuple[str, Figure]]:
    """Give file names (without suffix) and figures of all that the results have."""
    from . import figures as plots

    title = results.scenario.title
    yield "coefficients", plots.coefficients_over_speed(results.table, title)
    yield "critical_mass", plots.thresholds_over_speed(results.curves, results.rotor_mass, title)
    planes = _map_planes(results)
    for plane in planes:
        clearance = float(plane["radial_clearance"])
        shown = QUANTITIES["radial_clearance"].said(clearance)
        figure = plots.stability_map(
            plane, marks=_marks(results, clearance), title=f"{title}\n{shown}"
        )
        micro = f"{clearance * _MICRO:.4g}um"
        yield f"stability_map_{micro}" if len(planes) > 1 else "stability_map", figure
    if results.measured:
        yield "measured", plots.measured_points(results.table, results.measured, title)
    if results.modes:
        yield "eigenvalues", plots.eigenvalue_plot(results.modes, title)
    if results.films:
        yield "film", plots.film_maps(results.films_at_top_speed, title)
        yield "film_profiles", plots.film_profiles(results.films_at_top_speed, title)
        if results.scenario.bearing.pads:
            films = results.films_at_top_speed
            bearing = _bearing_of(results, films[0].radial_clearance)
            yield "pads", plots.pad_sections(films, bearing, title)
    if results.transient is not None:
        yield "transient", plots.transient_plot(results.transient, title)
    if results.orbits:
        settings = results.scenario.orbit
        yield from orbit_figures(
            results.orbits, title, settings is not None and settings.steady_only
        )


def orbit_figures(
    orbits: Sequence[Orbit],
    title: str,
    steady_only: bool = False,
    lines: Sequence[Mapping[str, tuple[Array, Array]]] = (),
) -> Iterator[tuple[str, Figure]]:
    """Give names and figures: all orbits, and a cascade of each run through the speeds.

    lines : Of each orbit's cascade, see `spectrum_cascade`.
    """
    from . import figures as plots

    yield "orbits", plots.orbit_plot(orbits, title, steady_only)
    for k, (orbit, name) in enumerate(zip(orbits, run_names(orbits), strict=True)):
        rows = speed_cascade(orbit)
        if rows is not None:
            words, also = f"{title}\n{run_title(name)}", lines[k] if lines else None
            yield f"cascade_{name}", plots.spectrum_cascade(rows, words, lines=also)


def _map_planes(results: Results) -> list[xr.Dataset]:
    """Return stability maps over speed and mass, one for each clearance.

    None for a single speed.
    """
    if results.chart is None:
        return []
    dataset = results.chart.dataset
    if min(dataset.sizes["speed"], dataset.sizes["mass"]) < 2:
        return []
    return [
        dataset.isel(radial_clearance=place) for place in range(dataset.sizes["radial_clearance"])
    ]


def _bearing_of(results: Results, clearance: float) -> Bearing:
    """Return the scenario's bearing with one of its clearances [m], load frame."""
    return results.scenario.case(clearance, results.scenario.thermal_models[0]).bearing


def _marks(results: Results, clearance: float) -> dict[str, tuple[float, float]]:
    """Return the rotor on a map: at the verdicts' speed, the highest, and its orbits'."""
    mass, settings = results.rotor_mass, results.scenario.orbit
    if mass is None:
        return {}
    top = float(results.table.speeds[-1])
    marks = {f"highest speed, {top * RPM:.0f} rpm": (top, mass)}
    here = settings is not None and np.isclose(clearance, settings.radial_clearance, rtol=1e-6)
    steady = [float(orbit.speed[-1]) for orbit in results.orbits if orbit.constant_speed]
    if here and steady and not np.isclose(steady[0], top, rtol=1e-6):
        marks[f"orbit, {steady[0] * RPM:.0f} rpm"] = (steady[0], mass)
    return marks


def _write_recording_of(results: Results, path: Path) -> Path:
    """Write the whole recording: orbits, film, eigenvalues, map, summary."""
    from .recording import write_recording

    return write_recording(path, _recording_contents(results))


def _recording_contents(results: Results) -> RecordingContents:
    """Return everything that the recording shows."""
    from .recording import RecordingContents

    kinds = {orbit.kind for orbit in results.orbits}
    both = len({orbit.constant_speed for orbit in results.orbits}) > 1
    return RecordingContents(
        title=results.scenario.title,
        summary=_markdown_summary(results),
        # Runs at one speed and through the speeds beside each other are the whole job.
        kind=kinds.pop() if len(kinds) == 1 and not both else "",
        orbits=results.orbits,
        films=(
            *(film_at_rest(p, _bearing_of(results, p.radial_clearance)) for p in results.films),
            *results.film_motion,
        ),
        modes=results.modes,
        maps=tuple(_map_planes(results)),
        rotor_mass=results.rotor_mass,
    )


def record(orbits: Orbit | Iterable[Orbit], path: str | Path, *, title: str = "Orbits") -> Path:
    """Write orbits as a recording for the rerun viewer.

    Parameters
    ----------
    orbits : Orbit or iterable of Orbit
    path : str or Path
        Ends in ``.rrd``, usually ``logs/NAME.rrd``.
    title : str

    Returns
    -------
    Path
        The file written; `rotorsim.open_viewer` or ``rotorsim view`` opens it.
    """
    from .recording import RecordingContents, write_recording

    several = (orbits,) if isinstance(orbits, Orbit) else tuple(orbits)
    kind = several[0].kind if several else ""
    return write_recording(path, RecordingContents(title, _orbit_notes(several), kind, several))


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

    Returns Path: The file written.
    Returns list of str: What is missing in it, and why.
    """
    attempt = Attempts(announce)
    if table is None:
        table = attempt("coefficients", lambda: _surrounding_table(scenario, workers), None)
    if table is None:
        return record(orbits, path, title=scenario.title), attempt.problems
    results = compute(scenario, (), table, announce, orbits)
    return _write_recording_of(results, path), [*attempt.problems, *results.problems]


def _surrounding_table(scenario: Scenario, workers: int | None = None) -> CoefficientTable:
    """Return table of the orbit's clearance at up to `_SURROUNDING_SPEEDS` speeds."""
    from ..study.sweep import tabulate

    speeds, settings = scenario.speeds, orbit_settings(scenario)[0]
    count = min(speeds.size, _SURROUNDING_SPEEDS)
    chosen = np.unique(np.linspace(0, speeds.size - 1, count).round().astype(int))
    one = replace(
        scenario,
        radial_clearances=(settings.radial_clearance,),
        operating=replace(scenario.operating, speed=tuple(speeds[chosen].tolist())),
    )
    return tabulate(one, workers=workers)


_HEATING = ("load", "friction_force", "max_pressure", "max_temperature", "critical_mass")


def _markdown_summary(results: Results) -> str:
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
    return "\n".join([*lines, _orbit_notes(results.orbits, results.orbit_rows)])


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


def _orbit_notes(orbits: Sequence[Orbit], rows: Sequence[dict[str, Any]] | None = None) -> str:
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


def plane_figures(plane: Plane, title: str = "") -> Iterator[tuple[str, Figure]]:
    """Return the map of a plane: stable, unstable, and what only heating makes unstable."""
    from .figures import stability_map

    heading = "\n".join(text for text in (title, held_text(plane.held)) if text)
    yield plane.file_name, stability_map(plane.dataset, plane.x, plane.y, title=heading)


def tolerance_figures(study: ToleranceStudy, title: str = "") -> Iterator[tuple[str, Figure]]:
    """Return histograms of threshold speed and critical mass, and what matters."""
    from .figures import tolerance_histograms

    yield "tolerances", tolerance_histograms(study, title)


def campbell_figures(curves: Sequence[Campbell], title: str = "") -> Iterator[tuple[str, Figure]]:
    """Return one diagram for each clearance (and further dimension).

    All its thermal models in it.
    """
    from .figures import campbell_diagram

    groups: dict[tuple, list[Campbell]] = {}
    for curve in curves:
        key = tuple((n, v) for n, v in curve.choices.items() if n != "thermal_model")
        groups.setdefault(key, []).append(curve)
    for number, (key, group) in enumerate(groups.items(), start=1):
        held = held_text({n: v for n, v in key if n in QUANTITIES and np.isfinite(v)})
        heading = "\n".join(text for text in (title, held) if text)
        name = "campbell" if len(groups) == 1 else f"campbell_{number}"
        yield name, campbell_diagram(group, title=heading)


def control_figures(study: ControlStudy, title: str = "") -> Iterator[tuple[str, Figure]]:
    """Return root locus, Bode diagram of the receptance, and the runs in time."""
    from ..machine.control import receptance
    from ..machine.spectrum import MatrixSpectrum
    from ..machine.tracking import track_modes
    from .figures import bode_plot, orbit_plot, root_locus

    system, gain = study.system, study.feedback.gain
    heading = (
        f"{title}\n{study.speed * RPM:.0f} rpm, {with_unit(study.mass, 'kg')} per bearing".strip()
    )
    share = np.linspace(0.0, 1.5, 61)

    def closed_loop(factor: float) -> np.ndarray:
        return np.asarray(system.A) - factor * np.asarray(system.B) @ gain

    locus = track_modes(MatrixSpectrum(closed_loop), share)
    yield "root_locus", root_locus(locus, "share of the gain [-]", heading)
    frequency = np.geomspace(0.05 * study.speed, 4.0 * study.speed, 400)
    closed = study.feedback.closed_loop(system)
    responses = [
        ("film alone", receptance(system, frequency)[0, 0]),
        ("with actuator", receptance(closed, frequency)[0, 0]),
    ]
    yield "bode", bode_plot(frequency, responses, "receptance x per force x [m/N]", title=heading)
    runs = {"film alone": study.passive_orbit, "with actuator": study.controlled_orbit}
    known = {name: orbit for name, orbit in runs.items() if orbit is not None}
    if known:
        names = [f"{name}: {one.status.value.replace('_', ' ')}" for name, one in known.items()]
        yield "control_orbits", orbit_plot(list(known.values()), heading, names=names)


def machine_control_figures(
    study: MachineControlStudy, title: str = ""
) -> Iterator[tuple[str, Figure]]:
    """Return the receptance from actuator to sensor, whole and reduced, and the runs in time."""
    from ..machine.reduction import response
    from .figures import bode_plot
    from .figures.machine import control_traces

    heading = f"{title}\n{study.speed * RPM:.0f} rpm, {study.design.name}".strip()
    frequency = np.geomspace(0.05 * study.speed, 6.0 * study.speed, 800)
    system, small = study.system, study.reduction.system
    closed, _ = study.feedback.closed_loop(system)
    more = closed.shape[0] - system.nstates
    inputs = np.vstack([system.B, np.zeros((more, system.ninputs))])
    outputs = np.hstack([system.C, np.zeros((system.noutputs, more))])
    responses = [
        ("whole machine", response(system.A, system.B, system.C)(frequency)[:, 0, 0]),
        (f"reduced to {small.nstates} states",
         response(small.A, small.B, small.C)(frequency)[:, 0, 0]),
        ("with control", response(closed, inputs, outputs)(frequency)[:, 0, 0]),
    ]  # fmt: skip
    yield "control_bode", bode_plot(frequency, responses, "x sensor/force x [m/N]", title=heading)
    if study.controlled is not None and study.passive is not None:
        yield "control_in_time", control_traces(study.passive, study.controlled, heading)
