"""Recordings for the rerun viewer: the only part that imports rerun, and only when it is used."""

from __future__ import annotations

from pathlib import Path

from .contents import FilmSurface, OrbitTrack, RecordingContents
from .pictures import CascadePicture, EigenvaluePath, MapPicture, SpectrumPicture, Verdict, classify
from .viewer import ANALYTICS_NOTE, ViewerLaunch, open_viewer

__all__ = [
    "ANALYTICS_NOTE",
    "CascadePicture",
    "EigenvaluePath",
    "FilmSurface",
    "MapPicture",
    "OrbitTrack",
    "RecordingContents",
    "SpectrumPicture",
    "Verdict",
    "ViewerLaunch",
    "classify",
    "open_viewer",
    "write_recording",
]


def write_recording(
    path: str | Path, contents: RecordingContents, *, page: str = "Overview"
) -> Path:
    """Write a recording; see `rotorsim.show.recording.write.write_recording`."""
    from .write import write_recording as write

    return write(path, contents, page=page)
