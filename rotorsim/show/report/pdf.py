"""A report as PDF, printed by a browser."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from ...errors import InputError, RotorsimError

_BROWSERS = (
    "chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "msedge",
    "microsoft-edge",
)  # fmt: skip
_SECONDS = 120


def browser() -> str:
    """Return the program of a browser that prints pages.

    Raises InputError: There is none.
    """
    for name in _BROWSERS:
        found = shutil.which(name)
        if found:
            return found
    raise InputError(
        "needs a browser (Chromium, Chrome or Edge); without one, open the page and print it",
        key="--pdf",
    )


def write_pdf(page: Path) -> Path:
    """Print a page of HTML beside it, as PDF.

    Raises InputError: There is no browser.
    Raises RotorsimError: The browser did not print it.
    """
    target = page.with_suffix(".pdf")
    with tempfile.TemporaryDirectory() as profile:
        part = Path(profile) / "page.pdf"
        command = [
            browser(), "--headless", "--disable-gpu", "--no-pdf-header-footer",
            f"--user-data-dir={profile}", f"--print-to-pdf={part}", page.resolve().as_uri(),
        ]  # fmt: skip
        if hasattr(os, "geteuid") and os.geteuid() == 0:
            command.insert(1, "--no-sandbox")  # its sandbox refuses this user
        try:
            done = subprocess.run(command, capture_output=True, timeout=_SECONDS, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise RotorsimError(f"the browser did not print {page}: {error}") from error
        if done.returncode or not part.exists():
            said = done.stderr.decode(errors="replace").strip().splitlines()
            raise RotorsimError(f"the browser did not print {page}: {said[-1] if said else ''}")
        shutil.move(part, target)
    return target
