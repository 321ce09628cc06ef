"""Orbits sent to an open viewer piece by piece, while they are integrated."""

from __future__ import annotations

import socket
import subprocess
from collections.abc import Sequence
from contextlib import suppress
from types import TracebackType

import rerun as rr
import rerun.blueprint as rrb

from ...errors import InputError
from ...orbit import Orbit
from ...orbit.orbit import concatenate
from ..viewer import has_display, viewer_program
from .orbit_view import (
    DISPLACEMENT,
    ECCENTRICITY,
    WHIRL,
    log_orbit_piece,
    log_series,
    log_surroundings,
    orbit_view,
    series_view,
)
from .runs import TIME, Run, runs_of
from .write import APPLICATION

_PORT = 9876
"""Of the viewer; one that listens there already is used."""


class LiveView:
    """A running viewer to which pieces of orbits are sent.

    stream : Already connected (or writing to a file). Default: a viewer on this computer, started
        if none is open.
    Raises InputError: There is no display, or the installed rerun-sdk has no viewer.
    """

    def __init__(self, title: str, stream: rr.RecordingStream | None = None) -> None:
        self.title = title
        self.stream: rr.RecordingStream = stream or _viewer_stream()
        self.last: dict[str, Run] = {}

    def __enter__(self) -> LiveView:
        return self

    def __exit__(
        self,
        _kind: type[BaseException] | None,
        _error: BaseException | None,
        _trace: TracebackType | None,
    ) -> None:
        self.stream.flush()
        self.stream.disconnect()

    def show(self, piece: Orbit) -> None:
        """Send one piece of an orbit; pieces of one run follow each other in time."""
        if piece.t.size < 2:
            return
        (run,) = runs_of([piece])
        before = self.last.get(run.name)
        if before is None:
            log_surroundings(self.stream, run)
            self.last[run.name] = run
            self.stream.send_blueprint(self._layout(), make_active=True)
        else:
            # From the last sample on, so that the trail has no gaps.
            run = run._replace(orbit=concatenate([before.orbit.part(-1), piece]))
            self.last[run.name] = run
        log_orbit_piece(self.stream, run)
        log_series(self.stream, run)

    def _layout(self) -> rrb.Blueprint:
        runs: Sequence[Run] = list(self.last.values())
        plots = (DISPLACEMENT, ECCENTRICITY, WHIRL)
        return rrb.Blueprint(
            rrb.Horizontal(
                rrb.Horizontal(*[orbit_view(run) for run in runs]),
                rrb.Vertical(*[series_view(one, runs) for one in plots]),
                name=self.title,
            ),
            rrb.TimePanel(state="collapsed", timeline=TIME, play_state="following"),
            rrb.BlueprintPanel(state="collapsed"),
            rrb.SelectionPanel(state="collapsed"),
            auto_layout=False,
            auto_views=False,
        )


def _viewer_stream() -> rr.RecordingStream:
    if not _viewer_is_open():
        _start_viewer()
    stream = rr.RecordingStream(APPLICATION, send_properties=False)
    stream.connect_grpc(f"rerun+http://127.0.0.1:{_PORT}/proxy")
    return stream


def _viewer_is_open() -> bool:
    """Return whether something listens at the viewer's port.

    Here, or through a tunnel elsewhere.
    """
    with suppress(OSError), socket.create_connection(("127.0.0.1", _PORT), timeout=1.0):
        return True
    return False


def _start_viewer() -> None:
    if not has_display():
        raise InputError(
            "there is no display here (neither DISPLAY nor WAYLAND_DISPLAY is set) for a viewer; "
            "leave --live out and look at the recording on a computer with a screen, or forward "
            f"port {_PORT} from here to a viewer that is open there",
            key="--live",
        )
    program = viewer_program()
    if program is None:
        raise InputError("the rerun-sdk package has no viewer on this platform", key="--live")
    quiet = subprocess.DEVNULL
    subprocess.Popen(
        [str(program), "--bind", "127.0.0.1", "--port", str(_PORT)],
        stdin=quiet, stdout=quiet, stderr=quiet, start_new_session=True,
    )  # fmt: skip
