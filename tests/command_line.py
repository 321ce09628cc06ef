"""What the command line answers when it is called within the tests' own process."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from typing import Any

import pytest

CommandLine = Callable[..., subprocess.CompletedProcess[str]]
"""Takes the words after `rotorsim`: text, or what reads well as text (paths, numbers)."""


def called(capsys: pytest.CaptureFixture[str], *words: object) -> subprocess.CompletedProcess[str]:
    """Call the command line here rather than in a process of its own: quicker."""
    from rotorsim.cli.app import app

    arguments = [str(word) for word in words]
    with pytest.raises(SystemExit) as end:
        app(arguments, prog_name="rotorsim")
    code = end.value.code
    assert isinstance(code, int), f"ended with {code!r}, which is no exit code"
    said = capsys.readouterr()
    return subprocess.CompletedProcess(arguments, code, said.out, said.err)


def strict(text: str) -> dict[str, Any]:
    """One JSON document and nothing else, without NaN."""
    return json.loads(text, parse_constant=lambda name: pytest.fail(f"{name} in the JSON"))
