"""Pictures over a plane: the stability map with its moving operating point, spectrum cascades."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from .chart import HEIGHT, WIDTH, Chart, chart_bounds, log_labels, tick_text
from .colormaps import TEXT, colours
from .contents import OrbitTrack
from .pictures import CascadePicture, MapPicture, Verdict, nearest
from .timeline import RPM, distinct_speeds, speed_index, track_index

MICRO = 1e6
PIXELS = (720, 480)

VERDICT_COLOURS = {
    Verdict.UNKNOWN: (90, 90, 90),
    Verdict.STABLE: (49, 104, 142),
    Verdict.HEATING_DESTABILISES: (240, 200, 60),
    Verdict.UNSTABLE: (140, 35, 60),
    Verdict.HEATING_STABILISES: (90, 190, 150),
}


def map_entity(number: int) -> str:
    """Where the n-th map lives."""
    return f"map/{number}"


def log_map(
    stream: rr.RecordingStream, picture: MapPicture, number: int, tracks: Sequence[OrbitTrack]
) -> None:
    """Write one stability map with axes, legend and the moving operating point."""
    root = map_entity(number)
    chart = map_chart(picture)
    present = [verdict for verdict in Verdict if np.any(picture.verdict == verdict)]
    context = [(int(v), v.label, VERDICT_COLOURS[v]) for v in Verdict]
    stream.log(root, rr.AnnotationContext(context), static=True)
    pixels = verdict_pixels(picture)
    _log_picture(stream, f"{root}/verdict", rr.SegmentationImage(pixels, draw_order=-10.0))
    chart.log(stream, f"{root}/axes")
    _log_legend(stream, f"{root}/legend", present)
    _send_operating_point(stream, f"{root}/operating_point", chart, picture, tracks)


def map_view(picture: MapPicture, number: int) -> rrb.Spatial2DView:
    """View of one map."""
    return rrb.Spatial2DView(
        origin=f"/{map_entity(number)}",
        name=f"Stability map: {picture.title}",
        visual_bounds=chart_bounds(0.34),
    )


def map_chart(picture: MapPicture) -> Chart:
    """Axes of a map, in rpm and kg."""
    rpm = picture.speed * RPM
    return Chart(
        (float(rpm[0]), float(rpm[-1])),
        (float(picture.mass[0]), float(picture.mass[-1])),
        "shaft speed [rpm]",
        "rotor mass per bearing [kg]",
    )


def log_cascade(stream: rr.RecordingStream, picture: CascadePicture, number: int) -> None:
    """Write one spectrum cascade: logarithmic amplitude over speed and frequency."""
    root = f"cascade/{number}"
    hertz = picture.frequency / (2.0 * np.pi)
    rpm = picture.speed * RPM
    chart = Chart(
        (float(rpm[0]), float(rpm[-1])),
        (float(hertz[0]), float(hertz[-1])),
        "shaft speed [rpm]",
        "frequency [Hz]",
    )
    level = np.log10(np.maximum(raster(picture.amplitude, picture.speed, picture.frequency), 1e-12))
    high = float(level.max())
    paint = colours(level, high - 4.0, high, "inferno")[..., :3]
    _log_picture(stream, f"{root}/amplitude_um", rr.Image(paint, draw_order=-10.0))
    chart.log(stream, f"{root}/axes")
    for order, text in ((1.0, "1x"), (0.5, "0.5x")):
        reach = min(rpm[-1], 60.0 * hertz[-1] / order)
        line = np.array([rpm[0], reach])
        chart.log_line(
            stream, f"{root}/order_{text}", line, order * line / 60.0, (200, 200, 200), 0.5
        )
        place = chart.place(reach, order * reach / 60.0) + np.array([0.05, -0.02])
        log_labels(stream, f"{root}/order_label_{text}", [place], [text])
    peak = 10.0**high * MICRO
    notes = [f"brightest: {peak:.3g} µm", "a quarter of the colours darker: a tenth"]
    log_labels(stream, f"{root}/note", [[WIDTH / 2, 0.21], [WIDTH / 2, 0.31]], notes)


def cascade_view(picture: CascadePicture, number: int) -> rrb.Spatial2DView:
    """View of one cascade."""
    return rrb.Spatial2DView(
        origin=f"/cascade/{number}",
        name=f"Spectrum cascade: {picture.title}",
        visual_bounds=chart_bounds(0.2),
    )


def verdict_pixels(picture: MapPicture) -> NDArray[np.uint8]:
    """Verdict at each pixel; row 0 is the top."""
    speed = np.linspace(picture.speed[0], picture.speed[-1], PIXELS[0])
    mass = np.linspace(picture.mass[-1], picture.mass[0], PIXELS[1])
    return np.ascontiguousarray(picture.verdict_at(speed, mass).T)


def raster(
    values: NDArray[np.generic], x: NDArray[np.float64], y: NDArray[np.float64]
) -> NDArray[np.generic]:
    """Nearest value at each pixel of a picture with linear axes; row 0 is the top."""
    columns = nearest(x, np.linspace(x[0], x[-1], PIXELS[0]))
    rows = nearest(y, np.linspace(y[-1], y[0], PIXELS[1]))
    return np.ascontiguousarray(values[columns[None, :], rows[:, None]])


def _log_picture(
    stream: rr.RecordingStream, entity: str, image: rr.SegmentationImage | rr.Image
) -> None:
    place = rr.Transform3D(
        translation=[0.0, -HEIGHT, 0.0], scale=[WIDTH / PIXELS[0], HEIGHT / PIXELS[1], 1.0]
    )
    stream.log(entity, image, static=True)
    stream.log(entity, place, static=True)


def _log_legend(stream: rr.RecordingStream, entity: str, present: list[Verdict]) -> None:
    for number, verdict in enumerate(present):
        place = [WIDTH / 2.0, 0.2 + 0.1 * number]
        colour = tuple(min(255, int(0.75 * c + 70)) for c in VERDICT_COLOURS[verdict])
        text = f"■ {verdict.label}"
        log_labels(
            stream,
            f"{entity}/{verdict.name.lower()}",
            [place],
            [text],
            (colour[0], colour[1], colour[2]),
        )


def _send_operating_point(
    stream: rr.RecordingStream,
    entity: str,
    chart: Chart,
    picture: MapPicture,
    tracks: Sequence[OrbitTrack],
) -> None:
    if picture.rotor_mass is None:
        return
    dot = rr.Points2D.from_fields(
        radii=rr.Radius.ui_points(6.0), colors=(255, 255, 255), draw_order=60.0
    )
    words = rr.Points2D.from_fields(radii=0.0, colors=TEXT, draw_order=61.0, show_labels=True)
    mass = tick_text(float(f"{picture.rotor_mass:.4g}"))
    shown = distinct_speeds(tracks)
    places = [(f"{entity}/{t.name}", track_index(t, r), t.speed[r]) for t, r in shown]
    by_speed = f"{entity}/{shown[0][0].name}" if shown else entity
    places.append((by_speed, [speed_index(picture.speed)], picture.speed))
    for name, index, speed in places:
        stream.log(name, dot, static=True)
        stream.log(f"{name}/words", words, static=True)
        points = chart.place(speed * RPM, picture.rotor_mass)
        labels = [f"{tick_text(round(rpm))} rpm, {mass} kg" for rpm in speed * RPM]
        # Words below the first point and above a second one: they may pass each other. Near the
        # right border they stand to the left.
        above = len(shown) > 1 and name.endswith(f"/{shown[1][0].name}")
        beside = np.where(points[:, 0] > 0.8 * WIDTH, -0.2, 0.0)
        at = points + np.column_stack([beside, np.full(len(points), -0.14 if above else 0.0)])
        stream.send_columns(name, index, rr.Points2D.columns(positions=points))
        stream.send_columns(
            f"{name}/words", index, rr.Points2D.columns(positions=at, labels=labels)
        )
