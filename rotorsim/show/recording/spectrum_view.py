"""Spectrum of each motion at constant speed, the shaft's frequency and half of it marked."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from .chart import WIDTH, Chart, chart_bounds, log_labels
from .colormaps import LINE, model_colour
from .contents import model_label
from .pictures import SpectrumPicture

ENTITY = "spectrum"
MICRO = 1e6


def log_spectra(stream: rr.RecordingStream, pictures: Sequence[SpectrumPicture]) -> None:
    """Write axes, one line for each motion, and the shaft's orders."""
    chart = _chart(pictures)
    chart.log(stream, f"{ENTITY}/axes")
    for number, picture in enumerate(pictures):
        hertz, colour = picture.frequency / (2.0 * np.pi), model_colour(picture.name)
        shown = hertz <= chart.x_range[1]
        entity = f"{ENTITY}/{picture.name}"
        chart.log_line(
            stream, f"{entity}/amplitude_um", hertz[shown], picture.amplitude[shown] * MICRO,
            colour, 1.4,
        )  # fmt: skip
        peak = int(np.argmax(picture.amplitude))
        text = (
            f"{model_label(picture.name)}: {picture.amplitude[peak] * MICRO:.3g} µm at "
            f"{hertz[peak]:.4g} Hz, {picture.frequency[peak] / picture.speed:.3f}x"
        )
        place = [[WIDTH / 2.0, 0.21 + 0.1 * number]]
        log_labels(stream, f"{entity}/key", place, [text], colour)
    shaft = pictures[0].speed / (2.0 * np.pi)
    for order, text in ((1.0, "1x"), (0.5, "0.5x")):
        at = np.full(2, order * shaft)
        line = np.array(chart.y_range)
        chart.log_line(stream, f"{ENTITY}/order_{text}", at, line, LINE, 0.5)
        label = chart.place(order * shaft, chart.y_range[1]) + np.array([0.07, 0.01])
        log_labels(stream, f"{ENTITY}/order_label_{text}", [label], [text])


def spectrum_view(count: int) -> rrb.Spatial2DView:
    """View of that many spectra."""
    return rrb.Spatial2DView(
        origin=f"/{ENTITY}",
        name="Spectrum of the motion",
        visual_bounds=chart_bounds(0.1 * count),
    )


def _chart(pictures: Sequence[SpectrumPicture]) -> Chart:
    shaft = max(picture.speed for picture in pictures) / (2.0 * np.pi)
    highest = max(float(picture.amplitude.max()) for picture in pictures) * MICRO
    return Chart((0.0, 2.5 * shaft), (0.0, 1.25 * highest), "frequency [Hz]", "amplitude [µm]")
