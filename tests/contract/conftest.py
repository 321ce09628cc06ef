"""The command line, called in a temporary folder."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pytest
from command_line import CommandLine, called


@pytest.fixture
def here(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> CommandLine:
    """Call the command line in the test's folder, on a terminal 100 columns wide."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    return partial(called, capsys)
