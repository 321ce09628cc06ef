"""Eigenvalues in the complex plane, moving with speed; the threshold where a pair crosses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from .chart import HEIGHT, Chart, chart_bounds, log_labels, tick_text
from .colormaps import ALARM, model_colour
from .contents import OrbitTrack, model_label
from .pictures import EigenvaluePath
from .timeline import RPM, distinct_speeds, speed_index, track_index, tracks_of

ENTITY = "eigenvalues"


def log_eigenvalues(
    stream: rr.RecordingStream, paths: Sequence[EigenvaluePath], tracks: Sequence[OrbitTrack]
) -> None:
    """Write axes, branches, thresholds and the moving eigenvalues."""
    chart = eigenvalue_chart(paths)
    chart.log(stream, f"{ENTITY}/axes")
    if chart.x_range[0] < 0.0 < chart.x_range[1]:
        zero = np.zeros(2)
        chart.log_line(stream, f"{ENTITY}/stability_limit", zero, chart.y_range, ALARM, 1.2)
    for number, path in enumerate(paths):
        _log_branches(stream, chart, path)
        _log_threshold(stream, chart, path)
        _log_key(stream, path, number)
        _send_moving(stream, chart, path, tracks_of(tracks, path.name))


def eigenvalue_view() -> rrb.Spatial2DView:
    """View of the complex plane."""
    return rrb.Spatial2DView(
        origin=f"/{ENTITY}",
        name="Eigenvalues over speed: stable left of the red line",
        visual_bounds=chart_bounds(0.02),
    )


def eigenvalue_chart(paths: Sequence[EigenvaluePath]) -> Chart:
    """Axes that show the whirling pairs; overdamped real eigenvalues far left are cut off."""
    values = np.concatenate([path.eigenvalues.reshape(-1) for path in paths])
    values = values[np.isfinite(values)]
    top = max(float(np.abs(values.imag).max(initial=0.0)), 1e-3)
    right = max(1.4 * float(values.real.max(initial=0.0)), 0.12 * top)
    left = max(1.05 * float(values.real.min(initial=0.0)), -0.8 * top)
    return Chart(
        (min(left, -0.2 * top), right),
        (0.0, 1.3 * top),
        "real part: growth rate [1/s]",
        "imaginary part: whirl frequency [rad/s]",
    )


def _log_branches(stream: rr.RecordingStream, chart: Chart, path: EigenvaluePath) -> None:
    strips: list[NDArray[np.float64]] = []
    for branch in path.eigenvalues.T:
        shown = chart.inside(branch.real, branch.imag)
        for run in np.split(np.arange(shown.size), np.flatnonzero(np.diff(shown.astype(int))) + 1):
            if shown[run[0]] and run.size > 1:
                strips.append(chart.place(branch.real[run], branch.imag[run]))
    stream.log(
        f"{ENTITY}/{path.name}/branches_per_s",
        rr.LineStrips2D(strips, radii=rr.Radius.ui_points(0.9), colors=model_colour(path.name)),
        static=True,
    )


def _log_threshold(stream: rr.RecordingStream, chart: Chart, path: EigenvaluePath) -> None:
    if path.threshold_speed is None:
        return
    values = path.at(path.threshold_speed)
    crossing = values[values.imag >= 0.0]
    place = crossing[np.abs(crossing.real).argmin()]
    stream.log(
        f"{ENTITY}/{path.name}/threshold",
        rr.Points2D(
            [chart.place(place.real, place.imag)],
            radii=rr.Radius.ui_points(4.0),
            colors=ALARM,
            draw_order=40.0,
        ),
        static=True,
    )


def _log_key(stream: rr.RecordingStream, path: EigenvaluePath, number: int) -> None:
    text = model_label(path.name)
    if path.threshold_speed is None:
        text += ": no threshold in these speeds"
    else:
        text += f": threshold {tick_text(round(path.threshold_speed * RPM))} rpm"
    if path.whirl_frequency_ratio is not None:
        text += f", whirl ratio {path.whirl_frequency_ratio:.3f}"
    # Up on the left, where no branch of a lightly damped pair runs.
    place = [[0.58, -HEIGHT + 0.03 + 0.11 * number]]
    log_labels(stream, f"{ENTITY}/{path.name}/key", place, [text], model_colour(path.name))


def _send_moving(
    stream: rr.RecordingStream, chart: Chart, path: EigenvaluePath, tracks: Sequence[OrbitTrack]
) -> None:
    style = rr.Points2D.from_fields(radii=rr.Radius.ui_points(4.5), draw_order=60.0)
    shown = distinct_speeds(tracks)
    entities = [f"{ENTITY}/{path.name}/now_per_s/{track.name}" for track, _ in shown]
    by_speed = entities[0] if entities else f"{ENTITY}/{path.name}/now_per_s"
    stream.log(by_speed, style, static=True)
    _send_points(stream, by_speed, chart, [speed_index(path.speed)], path.eigenvalues)
    for entity, (track, rows) in zip(entities, shown, strict=True):
        stream.log(entity, style, static=True)
        _send_points(stream, entity, chart, track_index(track, rows), path.at(track.speed[rows]))


def _send_points(
    stream: rr.RecordingStream,
    entity: str,
    chart: Chart,
    index: list[rr.TimeColumn],
    values: NDArray[np.complex128],
) -> None:
    shown = chart.inside(values.real, values.imag)
    counts = shown.sum(axis=1)
    flat = values[shown]
    paint = np.where(flat.real[:, None] > 0.0, [*ALARM, 255], [255, 255, 255, 255]).astype(np.uint8)
    columns = rr.Points2D.columns(positions=chart.place(flat.real, flat.imag), colors=paint)
    stream.send_columns(entity, index, columns.partition(counts.tolist()))
