"""Axes for the viewer's bare 2-D views: a frame, ticks and their numbers, a title for each axis.

A chart maps its data onto a box of `WIDTH` x `HEIGHT`. Both axes then fill the view whatever
their units; the viewer's own vertical axis points down, so that heights are negated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import ArrayLike, NDArray

from .colormaps import FAINT, LINE, TEXT

WIDTH, HEIGHT = 1.5, 1.0
Colour = tuple[int, int, int]


def nice_ticks(low: float, high: float, count: int = 5) -> NDArray[np.float64]:
    """Round numbers (1, 2 or 5 times a power of ten apart) inside [low, high]."""
    raw = max(high - low, 1e-300) / count
    power = 10.0 ** np.floor(np.log10(raw))
    step = power * next(factor for factor in (1.0, 2.0, 5.0, 10.0) if factor * power > 0.75 * raw)
    first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
    return np.arange(first, last + 0.5) * step


def tick_text(value: float) -> str:
    """Write a tick's number, thousands in groups."""
    return f"{value:,.6g}".replace(",", " ") if value else "0"


@dataclass(frozen=True)
class Chart:
    """Linear axes over a box; `x_label` and `y_label` name quantity and unit."""

    x_range: tuple[float, float]
    y_range: tuple[float, float]
    x_label: str
    y_label: str

    def place(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """View coordinates (..., 2) of data points."""
        u = (np.asarray(x, float) - self.x_range[0]) / (self.x_range[1] - self.x_range[0])
        v = (np.asarray(y, float) - self.y_range[0]) / (self.y_range[1] - self.y_range[0])
        return np.stack(np.broadcast_arrays(u * WIDTH, -v * HEIGHT), axis=-1)

    def inside(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.bool_]:
        """Whether data points are within the axes."""
        x, y = np.asarray(x, float), np.asarray(y, float)
        return (
            (x >= self.x_range[0])
            & (x <= self.x_range[1])
            & (y >= self.y_range[0])
            & (y <= self.y_range[1])
        )

    def log(self, stream: rr.RecordingStream, entity: str) -> None:
        """Write frame, ticks, numbers and titles under `entity`."""
        corners = [[0, 0], [WIDTH, 0], [WIDTH, -HEIGHT], [0, -HEIGHT], [0, 0]]
        x_ticks, y_ticks = nice_ticks(*self.x_range, 4), nice_ticks(*self.y_range, 4)
        marks = [
            *[[(px, 0.0), (px, 0.02)] for px in self.place(x_ticks, self.y_range[0])[:, 0]],
            *[[(0.0, py), (-0.02, py)] for py in self.place(self.x_range[0], y_ticks)[:, 1]],
        ]
        thin_line = rr.Radius.ui_points(0.6)
        stream.log(
            f"{entity}/frame",
            rr.LineStrips2D([corners, *marks], radii=thin_line, colors=LINE),
            static=True,
        )
        below = self.place(x_ticks, self.y_range[0]) + np.array([0.0, 0.03])
        beside = self.place(self.x_range[0], y_ticks) - np.array([0.09, 0.025])
        numbers = [tick_text(value) for value in (*x_ticks, *y_ticks)]
        log_labels(stream, f"{entity}/ticks", np.vstack([below, beside]), numbers)
        titles = np.array([[WIDTH / 2.0, 0.11], [0.3, -HEIGHT - 0.1]])
        log_labels(stream, f"{entity}/titles", titles, [self.x_label, self.y_label])

    def log_line(
        self,
        stream: rr.RecordingStream,
        entity: str,
        x: ArrayLike,
        y: ArrayLike,
        colour: Colour = FAINT,
        width: float = 1.0,
    ) -> None:
        """Write one static line through data points."""
        stream.log(
            entity,
            rr.LineStrips2D([self.place(x, y)], radii=rr.Radius.ui_points(width), colors=colour),
            static=True,
        )


def log_labels(
    stream: rr.RecordingStream,
    entity: str,
    places: ArrayLike,
    texts: list[str],
    colour: Colour = TEXT,
) -> None:
    """Write static texts, each just below its place."""
    stream.log(
        entity,
        rr.Points2D(places, labels=texts, show_labels=True, radii=0.0, colors=colour),
        static=True,
    )


def chart_bounds(extra_below: float = 0.0) -> rrb.VisualBounds2D:
    """View bounds that show a chart with its titles (and a legend of some height below)."""
    return rrb.VisualBounds2D(
        x_range=[-0.25, WIDTH + 0.2], y_range=[-HEIGHT - 0.14, 0.24 + extra_below]
    )
