"""The orbit in the clearance circle: whole path, fading trail, journal, film force.

Coordinates are micrometres: x to the right, y upwards (negated for the viewer).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import ArrayLike, NDArray

from ...orbit.analysis import once_per_turn
from .colours import ALARM, FAINT, LINE, TEXT, model_colour
from .runs import REVOLUTIONS, SAMPLE_LIMIT, TIME, Run, log_labels, send_run, thin

MICRO = 1e6
_PATH_LIMIT = 6_000
_TRAIL_LIMIT = 50_000
TRAIL_REVOLUTIONS = 3.0
FORCE_LENGTH = 0.45
"""Arrow of the median force, in clearances; longer ones stop at twice that."""


def _orbit_entity(name: str) -> str:
    """Where a run's 2-D picture lives."""
    return f"orbit/{name}"


def _view_points(x: ArrayLike, y: ArrayLike) -> NDArray[np.float32]:
    """Micrometres in the viewer's axes, (n, 2)."""
    return np.stack([np.asarray(x) * MICRO, -np.asarray(y) * MICRO], axis=-1).astype(np.float32)


def log_orbit(stream: rr.RecordingStream, run: Run) -> None:
    """Write one run's orbit picture."""
    root = _orbit_entity(run.name)
    log_surroundings(stream, run)
    points = _view_points(run.orbit.x, run.orbit.y)
    colour = model_colour(run.name)
    stream.log(
        f"{root}/path_um",
        rr.LineStrips2D(
            [points[thin(len(points), _PATH_LIMIT)]],
            radii=rr.Radius.ui_points(0.5),
            colors=tuple(c // 2 for c in colour),
        ),
        static=True,
    )
    log_orbit_piece(stream, run)


def log_orbit_piece(stream: rr.RecordingStream, run: Run) -> None:
    """Write what moves: trail, journal, film force. `run` may be a part of a run."""
    root, points = _orbit_entity(run.name), _view_points(run.orbit.x, run.orbit.y)
    _send_trail(stream, f"{root}/trail_um", run, points)
    _send_journal(stream, f"{root}/journal_um", run, points)
    if np.any(run.force):
        _send_force(stream, f"{root}/film_force_N", run, points)


def zoom_reach(runs: Sequence[Run]) -> float:
    """Half-width [m] of the close-up that holds the smallest of these motions."""
    sizes = []
    for run in runs:
        x0, y0 = run.orbit.equilibrium
        sizes.append(float(np.hypot(run.orbit.x - x0, run.orbit.y - y0).max()))
    return max(1.3 * min(sizes), 1e-3 * runs[0].orbit.radial_clearance)


def orbit_view(run: Run, zoom: float | None = None) -> rrb.Spatial2DView:
    """View of one run with the trail of the last turns.

    zoom : Half-width of a close-up about the static position [m]; else the whole clearance circle.
    """
    root = _orbit_entity(run.name)
    reach = (1.32 * run.reach if zoom is None else zoom) * MICRO
    x0, y0 = (0.0, 0.0) if zoom is None else run.orbit.equilibrium
    centre = _view_points(x0, y0).astype(float)
    # The force's scale belongs to the whole circle.
    hidden = [] if zoom is None else [f"- /{root}/film_force_N"]
    title = "Orbit" if zoom is None else f"Close-up, {2.0 * reach:.2g} µm wide"
    turns = abs(run.orbit.revolutions[-1] - run.orbit.revolutions[0])
    seconds = float(run.orbit.t[-1] - run.orbit.t[0]) * min(
        1.0, TRAIL_REVOLUTIONS / max(turns, 1e-9)
    )
    now = rrb.TimeRangeBoundary.cursor_relative
    trail = rrb.VisibleTimeRanges(
        [
            rr.VisibleTimeRange(TIME, start=now(seconds=-seconds), end=now()),
            rr.VisibleTimeRange(
                REVOLUTIONS, start=now(seq=-round(1000 * TRAIL_REVOLUTIONS)), end=now()
            ),
        ]
    )
    return rrb.Spatial2DView(
        origin=f"/{root}",
        name=f"{title}: {run.heading}",
        visual_bounds=rrb.VisualBounds2D(
            x_range=[centre[0] - reach, centre[0] + reach],
            y_range=[centre[1] - reach, centre[1] + reach],
        ),
        contents=["$origin/**", *hidden],
        overrides={f"/{root}/trail_um": trail},
    )


def log_surroundings(stream: rr.RecordingStream, run: Run) -> None:
    """Write what stands still: contact line, axes, labels, static position, Poincare points."""
    root = _orbit_entity(run.name)
    reach = run.reach * MICRO
    line = _view_points(*run.orbit.boundary.T)
    arrow = reach * 1.1
    stream.log(
        f"{root}/clearance_um",
        rr.LineStrips2D([line], radii=rr.Radius.ui_points(1.2), colors=TEXT),
        static=True,
    )
    cross = [[[-reach, 0], [reach, 0]], [[0, -reach], [0, reach]]]
    stream.log(
        f"{root}/axes",
        rr.LineStrips2D(cross, radii=rr.Radius.ui_points(0.4), colors=FAINT),
        static=True,
    )
    arc = np.radians(np.linspace(35.0, 58.0, 24))
    turning = 1.12 * reach * np.stack([np.cos(arc), -np.sin(arc)], axis=-1)
    head = turning[-1] + 0.06 * reach * np.array([[0.95, -0.3], [0.0, 0.0], [0.25, 0.95]])
    stream.log(
        f"{root}/rotation",
        rr.LineStrips2D([turning, head], radii=rr.Radius.ui_points(1.0), colors=LINE),
        static=True,
    )
    log_labels(
        stream,
        f"{root}/labels",
        [[arrow, -0.04 * reach], [0, -1.2 * reach], [0, 1.06 * reach]],
        ["x, load", "y", f"journal touches, c = {run.orbit.radial_clearance * MICRO:.4g} µm"],
        LINE,
    )
    stream.log(
        f"{root}/equilibrium_um",
        rr.Points2D(
            [_view_points(*run.orbit.equilibrium)],
            radii=rr.Radius.ui_points(2.5),
            colors=LINE,
            draw_order=45.0,
        ),
        static=True,
    )
    points = once_per_turn(run.orbit)
    if points is not None:
        stream.log(
            f"{root}/once_per_turn_um",
            rr.Points2D(
                _view_points(*points.T),
                radii=rr.Radius.ui_points(1.3),
                colors=ALARM,
                draw_order=40.0,
            ),
            static=True,
        )


def _bright(colour: tuple[int, int, int]) -> tuple[int, int, int]:
    red, green, blue = (c + (255 - c) // 2 for c in colour)
    return red, green, blue


def _send_trail(
    stream: rr.RecordingStream, entity: str, run: Run, points: NDArray[np.float32]
) -> None:
    # One short segment per row: the view's time window joins the last turns into the trail.
    rows = thin(len(points), _TRAIL_LIMIT)
    stream.log(
        entity,
        rr.LineStrips2D.from_fields(
            radii=rr.Radius.ui_points(1.6), colors=_bright(model_colour(run.name))
        ),
        static=True,
    )

    def segments(part: NDArray[np.intp]) -> rr.ComponentColumnList:
        first = rows[np.maximum(np.searchsorted(rows, part) - 1, 0)]
        return rr.LineStrips2D.columns(strips=np.stack([points[first], points[part]], axis=1))

    send_run(stream, entity, run, rows, segments)


def _send_journal(
    stream: rr.RecordingStream, entity: str, run: Run, points: NDArray[np.float32]
) -> None:
    stream.log(
        entity,
        rr.Points2D.from_fields(
            radii=rr.Radius.ui_points(5.0), colors=(255, 255, 255), draw_order=50.0
        ),
        static=True,
    )
    rows = thin(len(points), SAMPLE_LIMIT)
    send_run(stream, entity, run, rows, lambda part: rr.Points2D.columns(positions=points[part]))


def _send_force(
    stream: rr.RecordingStream, entity: str, run: Run, points: NDArray[np.float32]
) -> None:
    force = run.force
    magnitude = np.hypot(*force.T)
    middle = max(float(np.median(magnitude)), 1e-12)
    # The middle of the record sets the scale: at touch-down the force grows without bound.
    scale = (
        FORCE_LENGTH * run.orbit.radial_clearance * MICRO / max(float(np.median(magnitude)), 1e-12)
    )
    stream.log(
        entity,
        rr.Arrows2D.from_fields(radii=rr.Radius.ui_points(1.2), colors=(0, 158, 115)),
        static=True,
    )
    rows = thin(len(points), _TRAIL_LIMIT)
    shown = force * np.minimum(1.0, 2.0 * middle / np.maximum(magnitude, 1e-12))[:, None]
    arrows = (shown * (scale, -scale)).astype(np.float32)

    def columns(part: NDArray[np.intp]) -> rr.ComponentColumnList:
        return rr.Arrows2D.columns(vectors=arrows[part], origins=points[part])

    send_run(stream, entity, run, rows, columns)
