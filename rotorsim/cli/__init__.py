"""The command line. See `rotorsim --help`."""

from __future__ import annotations

import os
import signal
import sys
import warnings
from types import FrameType
from typing import NoReturn

__all__ = ["Terminated", "main"]


class Terminated(KeyboardInterrupt):
    """The process was asked to end: temporary files go, as after an interruption by the user."""

    exit_code = 128 + signal.SIGTERM


def main() -> None:
    """Run the command line and end the process with its exit code."""
    _clean_up_when_terminated()
    # Before NumPy is loaded: on matrices of this size the threads of a BLAS only wait for each
    # other, at three times the processor time.
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    warnings.formatwarning = lambda message, *_args, **_kwargs: f"warning: {message}\n"
    try:
        from .app import app

        app(prog_name="rotorsim")
    except KeyboardInterrupt as stop:  # while libraries were loaded
        sys.stderr.write("interrupted: nothing was changed\n")
        sys.exit(getattr(stop, "exit_code", 128 + signal.SIGINT))


def _clean_up_when_terminated() -> None:
    """Answer the signals that end a process by an exception; where they are ignored, not at all."""

    def stop(number: int, _frame: FrameType | None) -> NoReturn:
        signal.signal(number, signal.SIG_DFL)  # whoever asks twice is obeyed at once
        raise Terminated

    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, stop)
