"""Opening a recording in the viewer that comes with the rerun-sdk wheel."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from ..errors import InputError
from ..file_kinds import is_missing

_ANALYTICS_NOTE = (
    "The rerun viewer reports anonymous usage to its makers unless told not to:"
    " `rerun analytics disable` turns that off (it changes your rerun settings)."
)


@dataclass(frozen=True)
class ViewerLaunch:
    """Whether the viewer was started, what to tell the user, and the command's exit code."""

    started: bool
    message: str
    exit_code: int
    process_id: int | None = None


def open_viewer(path: str | Path) -> ViewerLaunch:
    """Start the native viewer on a recording; it goes on running by itself.

    Parameters
    ----------
    path : str or Path
        An .rrd file.

    Returns
    -------
    ViewerLaunch
        Exit code 0 when started, 1 when there is no display or no viewer.

    Raises
    ------
    InputError
        If there is no such file.
    """
    recording = Path(path)
    if not recording.is_file():
        what = "there is no such recording; `rotorsim run` writes one"
        raise InputError(what if is_missing(recording) else "is no recording", source=recording)
    program = viewer_program()
    if program is None:
        return ViewerLaunch(False, "The rerun-sdk package has no viewer on this platform.", 1)
    if not has_display():
        message = (
            "There is no display here (neither DISPLAY nor WAYLAND_DISPLAY is set), so that no"
            f" window can open. Copy {recording} to a computer with a screen and open it there"
            f" with `rotorsim view {recording.name}` or `rerun {recording.name}`."
        )
        return ViewerLaunch(False, message, 1)
    command = [str(program), str(recording), "--bind", "127.0.0.1", "--port", "auto"]
    quiet = subprocess.DEVNULL
    process = subprocess.Popen(
        command, stdin=quiet, stdout=quiet, stderr=quiet, start_new_session=True
    )
    return ViewerLaunch(True, f"Opened {recording}. {_ANALYTICS_NOTE}", 0, process.pid)


def viewer_program() -> Path | None:
    """Path of the wheel's own viewer, or None where the wheel has none."""
    try:
        import rerun_cli
    except ImportError:
        return None
    folder = Path(str(rerun_cli.__file__)).parent
    program = folder / ("rerun.exe" if sys.platform == "win32" else "rerun")
    return program if program.is_file() else None


def has_display() -> bool:
    """Whether a window can be opened."""
    if not sys.platform.startswith("linux"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
