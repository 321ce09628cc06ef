"""Orbits sent to an open viewer piece by piece, while they are integrated."""

from __future__ import annotations

import socket
import subprocess
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from types import TracebackType

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from ...errors import InputError
from . import series_view
from .contents import TRACK_OPTIONS, OrbitTrack
from .orbit_view import log_orbit_piece, log_surroundings, orbit_view
from .timeline import TIME
from .viewer import has_display, viewer_program
from .write import APPLICATION

PORT = 9876
"""Of the viewer; one that listens there already is used."""


class LiveView:
    """A running viewer to which pieces of orbits are sent.

    Parameters
    ----------
    title : str
    stream : rerun.RecordingStream, optional
        Already connected (or writing to a file). Default: a viewer on this computer, started if
        none is open.

    Raises
    ------
    InputError
        There is no display, or the installed rerun-sdk has no viewer.
    """

    def __init__(self, title: str, stream: rr.RecordingStream | None = None) -> None:
        self.title = title
        self.stream: rr.RecordingStream = stream or _viewer_stream()
        self.last: dict[str, OrbitTrack] = {}

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

    def show(self, piece: OrbitTrack) -> None:
        """Send one piece; pieces of one name follow each other in time."""
        before = self.last.get(piece.name)
        if before is None:
            log_surroundings(self.stream, piece)
            self.last[piece.name] = piece
            self.stream.send_blueprint(self._layout(), make_active=True)
        else:
            piece = _joined(before, piece)
            self.last[piece.name] = piece
        log_orbit_piece(self.stream, piece)
        series_view.log_series(self.stream, piece)

    def _layout(self) -> rrb.Blueprint:
        tracks: Sequence[OrbitTrack] = list(self.last.values())
        plots = (series_view.DISPLACEMENT, series_view.ECCENTRICITY, series_view.WHIRL)
        return rrb.Blueprint(
            rrb.Horizontal(
                rrb.Horizontal(*[orbit_view(track) for track in tracks]),
                rrb.Vertical(*[series_view.series_view(one, tracks) for one in plots]),
                name=self.title,
            ),
            rrb.TimePanel(state="collapsed", timeline=TIME, play_state="following"),
            rrb.BlueprintPanel(state="collapsed"),
            rrb.SelectionPanel(state="collapsed"),
            auto_layout=False,
            auto_views=False,
        )


def _joined(before: OrbitTrack, piece: OrbitTrack) -> OrbitTrack:
    """Put the last sample before in front of the piece, so that the trail has no gaps."""
    joined = {
        name: np.concatenate([getattr(before, name)[-1:], getattr(piece, name)])
        for name in ("time", "x", "y", "angle", "speed")
    }
    for name in TRACK_OPTIONS:
        last, new = getattr(before, name), getattr(piece, name)
        if new is not None:
            # What a run began without (a load, say) was zero until now.
            last = np.zeros_like(new[:1]) if last is None else last[-1:]
            joined[name] = np.concatenate([last, new])
    return replace(piece, **joined)


def _viewer_stream() -> rr.RecordingStream:
    if not _viewer_is_open():
        _start_viewer()
    stream = rr.RecordingStream(APPLICATION, send_properties=False)
    stream.connect_grpc(f"rerun+http://127.0.0.1:{PORT}/proxy")
    return stream


def _viewer_is_open() -> bool:
    """Whether something listens at the viewer's port: here, or through a tunnel elsewhere."""
    with suppress(OSError), socket.create_connection(("127.0.0.1", PORT), timeout=1.0):
        return True
    return False


def _start_viewer() -> None:
    if not has_display():
        raise InputError(
            "there is no display here (neither DISPLAY nor WAYLAND_DISPLAY is set) for a viewer; "
            "leave --live out and look at the recording on a computer with a screen, or forward "
            f"port {PORT} from here to a viewer that is open there",
            key="--live",
        )
    program = viewer_program()
    if program is None:
        raise InputError("the rerun-sdk package has no viewer on this platform", key="--live")
    quiet = subprocess.DEVNULL
    subprocess.Popen(
        [str(program), "--bind", "127.0.0.1", "--port", str(PORT)],
        stdin=quiet, stdout=quiet, stderr=quiet, start_new_session=True,
    )  # fmt: skip
