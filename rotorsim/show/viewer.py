"""Opening a recording in the viewer that comes with the rerun-sdk wheel."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from ..arguments import file_path
from ..errors import InputError
from ..file_kinds import is_missing

_ANALYTICS_NOTE = (
    "The rerun viewer reports anonymous usage to its makers unless told not to:"
    " `rerun analytics disable` turns that off (it changes your rerun settings)."
)


@dataclass(frozen=True)
class ViewerLaunch:
    """Outcome of starting the viewer: a message for the user and the command's exit code."""

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
    recording = _existing(file_path(path))
    program = viewer_program()
    if program is None:
        return ViewerLaunch(False, "The rerun-sdk package has no viewer on this platform.", 1)
    if not has_display():
        message = (
            "There is no display here (neither DISPLAY nor WAYLAND_DISPLAY is set), so that no"
            f" window can open. `rotorsim view --web {recording}` serves it to a browser; or copy"
            f" it to a computer with a screen: `rotorsim view {recording.name}`."
        )
        return ViewerLaunch(False, message, 1)
    command = [str(program), str(recording), "--bind", "127.0.0.1", "--port", "auto"]
    quiet = subprocess.DEVNULL
    process = subprocess.Popen(
        command, stdin=quiet, stdout=quiet, stderr=quiet, start_new_session=True
    )
    return ViewerLaunch(True, f"Opened {recording}. {_ANALYTICS_NOTE}", 0, process.pid)


@contextmanager
def served_viewer(path: str | Path) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """Serve the web viewer with a recording to this machine's browsers, until the block ends.

    Yields its address and the process that serves.

    Raises
    ------
    InputError
        If there is no such file, or no viewer on this platform.
    """
    recording, program = _existing(path), viewer_program()
    if program is None:
        raise InputError("the rerun-sdk package has no viewer on this platform", key="--web")
    page, data = _free_ports(2)
    command = [
        str(program), str(recording), "--serve-web", "--bind", "127.0.0.1", "--port", str(data),
        "--web-viewer-port", str(page),
    ]  # fmt: skip
    quiet = subprocess.DEVNULL
    process = subprocess.Popen(command, stdin=quiet, stdout=quiet, stderr=quiet)
    try:
        source = quote(f"rerun+http://127.0.0.1:{data}/proxy", safe="")
        yield f"http://127.0.0.1:{page}/?url={source}", process
    finally:
        process.terminate()
        process.wait()


def _free_ports(count: int) -> list[int]:
    with ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [int(one.getsockname()[1]) for one in sockets]


def _existing(path: str | Path) -> Path:
    recording = Path(path)
    if not recording.is_file():
        what = "there is no such recording; `rotorsim run` writes one"
        raise InputError(what if is_missing(recording) else "is no recording", source=recording)
    return recording


def viewer_program() -> Path | None:
    """Return the path of the wheel's own viewer, or None where the wheel has none."""
    try:
        import rerun_cli
    except ImportError:
        return None
    folder = Path(str(rerun_cli.__file__)).parent
    program = folder / ("rerun.exe" if sys.platform == "win32" else "rerun")
    return program if program.is_file() else None


def has_display() -> bool:
    """Return whether a window can be opened."""
    if not sys.platform.startswith("linux"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
