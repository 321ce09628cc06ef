"""From a file to its TOML entries, refusing what is no scenario file."""

from __future__ import annotations

import difflib
import tomllib
from pathlib import Path
from typing import Any

from ...errors import ScenarioError
from ...file_kinds import HEAD, FileKind, recognise, sentence
from ...shipped import shipped_scenarios
from .toml_advice import advice

_MAX_BYTES = 1_000_000
_MAX_NESTING = 50


def read_text(path: str | Path) -> str:
    """Text of a scenario file, lines ended by a line feed: its hash is the same everywhere.

    Raises ScenarioError: No such file, not a file, a file of another kind, too large, not UTF-8,
        not readable.
    """
    path = Path(path)
    try:
        if path.is_dir():
            raise ScenarioError("is a directory; give a scenario file (.toml)", source=path)
        if path.exists() and not path.is_file():
            raise ScenarioError("is no ordinary file", source=path)
        if not path.is_file():
            raise ScenarioError(f"no such file{_similar(path)}", source=path)
        with path.open("rb") as file:
            data = file.read(_MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, ScenarioError):
            raise
        raise ScenarioError(f"cannot be read: {error}", source=path) from None
    kind = recognise(data[:HEAD], path.suffix.lower())
    if kind not in (None, FileKind.SCENARIO):
        raise ScenarioError(f"{sentence(kind)}; here a scenario is needed", source=path)
    if len(data) > _MAX_BYTES:
        raise ScenarioError(f"is larger than {_MAX_BYTES} bytes: no scenario file", source=path)
    try:
        return data.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise ScenarioError(
            f"must be UTF-8 text; byte 0x{data[error.start]:02x} in line {line} is not",
            source=path,
        ) from None


def _similar(path: Path) -> str:
    """Files of nearly that name beside it."""
    if not path.parent.is_dir():
        return f"; nor is there a directory {path.parent}"
    names = [entry.name for entry in path.parent.glob("*.toml") if entry.name != path.name]
    same = path.name.casefold()

    def likeness(name: str) -> float:
        return difflib.SequenceMatcher(None, same, name.casefold()).ratio()

    nearest = max(sorted(names), key=likeness, default="")
    if likeness(nearest) >= 0.5:
        return f'; did you mean "{path.parent / nearest}"?'
    shipped = ", ".join(shipped_scenarios())
    return "" if path.suffix or not shipped else f"; the shipped scenarios are {shipped}"


def parse_toml(text: str, source: str) -> dict[str, Any]:
    """Entries of a TOML text.

    Raises ScenarioError: Not TOML, with the line; or nested beyond sense.
    """
    if len(text) > _MAX_BYTES:
        raise ScenarioError(f"is larger than {_MAX_BYTES} characters", source=source)
    if any(_is_deep_key(line) for line in text.splitlines()):
        raise ScenarioError("is nested too deeply to be a scenario", source=source)
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ScenarioError("is nested too deeply to be a scenario", source=source) from None
    except ValueError as error:  # TOMLDecodeError, or a number of too many digits
        raise ScenarioError(
            f"is not valid TOML: {error}; {advice(text, str(error))}", source=source
        ) from None


def _is_deep_key(line: str) -> bool:
    """Whether a dotted key or header is absurdly deep (reading such takes quadratic time)."""
    *keys, rest = line.split("=")
    if not keys and rest.lstrip().startswith("["):
        keys = [rest]
    return any(key.rpartition(",")[2].count(".") > _MAX_NESTING for key in keys)
