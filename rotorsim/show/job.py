"""Figures and recordings of the main job and of orbits."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arguments import file_path, refuse_other
from ..arrays import Array
from ..orbit import Orbit
from ..orbit.analysis import speed_cascade
from ..orbit.description import run_names, run_title
from ..rows import QUANTITIES, RPM
from ..study.main_job import Announce, Attempts, Results, compute
from ..study.orbits import film_at_rest, orbit_settings
from ..study.transient import Transient, transient_frames
from .run_notes import markdown_summary, orbit_notes

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario
    from ..model import Bearing
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
        summary=markdown_summary(results),
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

    given: Any = (orbits,) if isinstance(orbits, Orbit) else orbits
    refuse_other(given, Iterable, "orbits", "an Orbit, or several")
    several = tuple(given)
    for one in several:
        refuse_other(one, Orbit, "orbits", "an Orbit, or several")
    path = file_path(path)
    kind = several[0].kind if several else ""
    return write_recording(path, RecordingContents(title, orbit_notes(several), kind, several))


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
