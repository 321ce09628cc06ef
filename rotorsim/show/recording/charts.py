"""Charts of a recording: what stands still is a figure, as one picture; what moves lies on it.

The views' coordinates are the picture's pixels.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from ...arrays import Array, Booleans, ComplexArray
from ...rows import QUANTITIES
from ...study.stability import Campbell
from ..figures.style import figure_bytes
from .runs import ALARM, Run, distinct_speeds, run_index, runs_named, speed_index, tick_text

if TYPE_CHECKING:
    import xarray as xr

_DPI = 200
_WIDTH, _LEGEND = 5.4, 6.8
"""Of the figure [inches], and of its legend's letters [points]."""
_DARK = (25, 25, 30)
"""Of what moves: the pictures are light."""


@dataclass(frozen=True)
class Chart:
    """Picture of a figure in a recording, and where data lie on it.

    entity, name : Where it lives in the recording, and what its view is called.
    figure : Its first axes carry the data.
    """

    entity: str
    name: str
    figure: Figure

    def __post_init__(self) -> None:
        # Smaller than on paper, so that its letters can be read in a pane of the viewer.
        width, height = self.figure.get_size_inches()
        self.figure.set_size_inches(_WIDTH, _WIDTH * height / width)
        for text in (text for legend in self.figure.legends for text in legend.get_texts()):
            text.set_fontsize(_LEGEND)
        self.figure.set_dpi(_DPI)
        self.figure.draw_without_rendering()

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [pixels]."""
        return float(self.figure.bbox.width), float(self.figure.bbox.height)

    @property
    def axes(self) -> Axes:
        """Axes of the data."""
        return self.figure.axes[0]

    def place(self, x: ArrayLike, y: ArrayLike) -> Array:
        """Return pixels (n, 2) of data points in the axes' units."""
        points = np.stack(np.broadcast_arrays(x, y), axis=-1).astype(float)
        pixels = self.axes.transData.transform(points.reshape(-1, 2)).reshape(points.shape)
        return np.stack([pixels[..., 0], self.size[1] - pixels[..., 1]], axis=-1)

    def inside(self, x: Array, y: Array) -> Booleans:
        """Return whether data points are within the axes."""
        (left, right), (low, high) = self.axes.get_xlim(), self.axes.get_ylim()
        return (x >= left) & (x <= right) & (y >= low) & (y <= high)

    def log(self, stream: rr.RecordingStream) -> None:
        """Write the picture."""
        png = figure_bytes(self.figure, "png", _DPI)
        picture = rr.EncodedImage(contents=png, media_type="image/png", draw_order=-10.0)
        stream.log(f"{self.entity}/picture", picture, static=True)

    @property
    def view(self) -> rrb.Spatial2DView:
        """View of the chart."""
        width, height = self.size
        bounds = rrb.VisualBounds2D(x_range=[0.0, width], y_range=[0.0, height])
        return rrb.Spatial2DView(origin=f"/{self.entity}", name=self.name, visual_bounds=bounds)


def map_chart(plane: xr.Dataset, number: int) -> Chart:
    """Return the chart of the n-th stability map over speed and mass."""
    from ..figures import stability_map

    words = "rigid rotor"
    if "radial_clearance" in plane.coords and np.isfinite(float(plane["radial_clearance"])):
        clearance = QUANTITIES["radial_clearance"].said(float(plane["radial_clearance"]))
        words = f"{words}, {clearance}"
    return Chart(f"map/{number}", f"Stability map: {words}", stability_map(plane, title=words))


def eigenvalue_chart(curves: Sequence[Campbell]) -> Chart:
    """Return the chart of the complex plane: eigenvalues over speed."""
    from ..figures import eigenvalue_plot

    name = "Eigenvalues over speed: stable left of the red line"
    return Chart("eigenvalues", name, eigenvalue_plot(curves))


def spectrum_chart(runs: Sequence[Run]) -> Chart | None:
    """Return the chart of the spectra of runs at constant speed; None where there is none."""
    from ..figures import spectrum_plot

    figure = spectrum_plot([run.orbit for run in runs])
    return None if figure is None else Chart("spectrum", "Spectrum of the motion", figure)


def cascade_charts(runs: Sequence[Run]) -> list[Chart]:
    """Return the chart of the cascade of each run through the speeds that is long enough."""
    from ...orbit.analysis import speed_cascade
    from ..figures import spectrum_cascade

    found = [(run, speed_cascade(run.orbit)) for run in runs]
    return [
        Chart(
            f"cascade/{number}",
            f"Spectrum cascade: {run.heading}",
            spectrum_cascade(cascade, run.heading),
        )
        for number, (run, cascade) in enumerate(pair for pair in found if pair[1] is not None)
        if cascade is not None
    ]


def send_operating_point(
    stream: rr.RecordingStream,
    chart: Chart,
    speeds: Array,
    rotor_mass: float | None,
    runs: Sequence[Run],
) -> None:
    """Write the rotor's point, which moves over the map with the speed, and its words."""
    if rotor_mass is None:
        return
    root = f"{chart.entity}/operating_point"
    dot = rr.Points2D.from_fields(radii=rr.Radius.ui_points(6.0), colors=_DARK, draw_order=60.0)
    words = rr.Points2D.from_fields(radii=0.0, colors=_DARK, draw_order=61.0, show_labels=True)
    mass = tick_text(float(f"{rotor_mass:.4g}"))
    shown = distinct_speeds(runs)
    places = [(f"{root}/{run.name}", run_index(run, r), run.orbit.speed[r]) for run, r in shown]
    by_speed = f"{root}/{shown[0][0].name}" if shown else root
    places.append((by_speed, [speed_index(speeds)], speeds))
    width, height = chart.size
    for name, index, speed in places:
        stream.log(name, dot, static=True)
        stream.log(f"{name}/words", words, static=True)
        rpm = QUANTITIES["speed"].shown(speed)
        points = chart.place(rpm, rotor_mass)
        labels = [f"{tick_text(round(one))} rpm, {mass} kg" for one in rpm]
        # Words below the first point and above a second one: they may pass each other. Near
        # a border they stand farther inside.
        above = len(shown) > 1 and name.endswith(f"/{shown[1][0].name}")
        beside = np.where(points[:, 0] > 0.8 * width, -0.17 * width, 0.0)
        beside = np.where(points[:, 0] < 0.25 * width, 0.13 * width, beside)
        at = points + np.column_stack([beside, np.full(len(points), -0.09 * height * above)])
        stream.send_columns(name, index, rr.Points2D.columns(positions=points))
        stream.send_columns(
            f"{name}/words", index, rr.Points2D.columns(positions=at, labels=labels)
        )


def send_speed_line(
    stream: rr.RecordingStream, chart: Chart, runs: Sequence[Run], upright: bool = True
) -> None:
    """Write a line at the present speed: upright where the speed [rpm] runs along x, else level."""
    shown = distinct_speeds(runs)[-1:]
    for run, rows in shown:
        entity = f"{chart.entity}/speed_now"
        style = rr.LineStrips2D.from_fields(
            radii=rr.Radius.ui_points(1.2), colors=ALARM, draw_order=60.0
        )
        stream.log(entity, style, static=True)
        rpm = QUANTITIES["speed"].shown(run.orbit.speed[rows])
        low, high = chart.axes.get_ylim() if upright else chart.axes.get_xlim()
        ends = [
            chart.place(rpm, np.full(rpm.shape, end)) if upright
            else chart.place(np.full(rpm.shape, end), rpm)
            for end in (low, high)
        ]  # fmt: skip
        strips = np.stack(ends, axis=1).astype(np.float32)
        stream.send_columns(entity, run_index(run, rows), rr.LineStrips2D.columns(strips=strips))


def send_eigenvalues(
    stream: rr.RecordingStream, chart: Chart, curves: Sequence[Campbell], runs: Sequence[Run]
) -> None:
    """Write the eigenvalues of each curve, which move with the speed; red where they grow."""
    style = rr.Points2D.from_fields(radii=rr.Radius.ui_points(4.5), draw_order=60.0)
    for curve in curves:
        model, branches = str(curve.choices["thermal_model"]), curve.branches
        shown = distinct_speeds(runs_named(runs, model))
        root = f"{chart.entity}/{model}/now_per_s"
        entities = [f"{root}/{run.name}" for run, _ in shown]
        by_speed = entities[0] if entities else root
        stream.log(by_speed, style, static=True)
        _send_points(
            stream, by_speed, chart, [speed_index(branches.parameter)], branches.eigenvalues
        )
        for entity, (run, rows) in zip(entities, shown, strict=True):
            stream.log(entity, style, static=True)
            values = _eigenvalues_at(curve, run.orbit.speed[rows])
            _send_points(stream, entity, chart, run_index(run, rows), values)


def _eigenvalues_at(curve: Campbell, speed: Array) -> ComplexArray:
    """Return eigenvalues between the tabulated speeds, (n, k) [1/s]; held at both ends."""
    known = curve.branches.parameter
    parts = [
        np.interp(speed, known, branch.real) + 1j * np.interp(speed, known, branch.imag)
        for branch in curve.branches.eigenvalues.T
    ]
    return np.stack(parts, axis=-1)


def _send_points(
    stream: rr.RecordingStream,
    entity: str,
    chart: Chart,
    index: list[rr.TimeColumn],
    values: ComplexArray,
) -> None:
    shown = chart.inside(values.real, values.imag)
    counts = shown.sum(axis=1)
    flat = values[shown]
    paint = np.where(flat.real[:, None] > 0.0, [*ALARM, 255], [*_DARK, 255]).astype(np.uint8)
    columns = rr.Points2D.columns(positions=chart.place(flat.real, flat.imag), colors=paint)
    stream.send_columns(entity, index, columns.partition(counts.tolist()))
