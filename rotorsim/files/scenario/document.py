"""From a file to its TOML entries, refusing what is no scenario file."""

from __future__ import annotations

import difflib
import re
import tomllib
from pathlib import Path
from typing import Any

from ...errors import ScenarioError
from ...file_kinds import HEAD, FileKind, recognise, sentence
from ...shipped import shipped_scenarios

_MAX_BYTES = 1_000_000
_MAX_NESTING = 50


def read_text(path: str | Path) -> str:
    """Return text of a scenario file, lines ended by a line feed: its hash is the same everywhere.

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
            f"must be UTF-8 text; byte 0x{data[error.start]:02x} in line {line} is not", source=path
        ) from None


def _similar(path: Path) -> str:
    """Return files of nearly that name beside it."""
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
    """Return entries of a TOML text.

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
            f"is not valid TOML: {error}; {_advice(text, str(error))}", source=source
        ) from None


def _is_deep_key(line: str) -> bool:
    """Return whether a dotted key or header is so deep that reading takes quadratic time."""
    *keys, rest = line.split("=")
    if not keys and rest.lstrip().startswith("["):
        keys = [rest]
    return any(key.rpartition(",")[2].count(".") > _MAX_NESTING for key in keys)


_PLACE = re.compile(r"\(at line (\d+), column (\d+)\)")
_REPEATED = ("bearing.groove", "bearing.arc", "bearing.pocket", "bearing.texture")
_EXAMPLE = 'every entry reads like length = "80 mm"'
_NUMBER_BEFORE = re.compile(r"[+-]?\d[\d.]*(?:e[+-]?\d+)?\s*$", re.IGNORECASE)
_MAX_SHOWN = 60


def _advice(text: str, message: str) -> str:
    """Return advice on how to mend what ``tomllib`` complained of.

    text : The whole file.
    message : Of the exception, with line and column.

    Examples
    --------
    >>> _advice("eccentricity_ratio = 0,5", "Expected newline (at line 1, column 23)")
    'decimals are written with a point: 0.5'
    """
    place = _PLACE.search(message)
    lines = text.split("\n")  # as tomllib counts
    if place is None or not 1 <= int(place[1]) <= len(lines):
        return _of_the_end(text, message)
    line, column = lines[int(place[1]) - 1], int(place[2]) - 1
    if "Cannot" in message:
        return _of_repetition(line)
    if any(quote in line for quote in "“”„‘’"):
        return 'write plain quotes, "80 mm", not typographic ones'
    return (
        _of_number(line[:column], line[column:])
        or _of_value(line, line[column:].strip(), message)
        or _of_structure(message)
        or _EXAMPLE
    )


def _of_the_end(text: str, message: str) -> str:
    open_quote = message.startswith("Expected") or "Unterminated" in message
    if open_quote and any(line.count(quote) % 2 for line in text.splitlines() for quote in "\"'"):
        return f"a closing quote is missing: {_EXAMPLE}"
    return _of_structure(message) or _EXAMPLE


def _of_repetition(line: str) -> str:
    name = line.strip().strip("[]").split("]")[0].strip()[:_MAX_SHOWN]
    if name in _REPEATED:
        return f"each of several is headed [[{name}]], with double brackets, the first one as well"
    if line.lstrip().startswith("["):
        return f"the table [{name}] may stand once only: put its lines together"
    return f"{line.split('=')[0].strip()[:_MAX_SHOWN]} may stand once only in its table: remove one"


def _of_number(before: str, behind: str) -> str:
    """Return advice on decimal commas and on units without quotes."""
    number = _NUMBER_BEFORE.search(before)
    if number is None:
        return ""
    start = number[0].strip()
    comma = re.match(r",(\d+)\s*(.*)", behind)
    if comma is not None:
        unit = re.match(r"[A-Za-zµ°][^\s,#}\]\"']*", comma[2])
        value = f"{start}.{comma[1]}"
        whole = f'"{value} {unit[0]}", in quotes' if unit else value
        return f"decimals are written with a point: {whole[:_MAX_SHOWN]}"
    unit = re.match(r"\s*([A-Za-zµ°%][^\s,#}\]\"']*)", behind)
    if unit is not None:
        return f'a value with a unit stands in quotes: "{start} {unit[1][:_MAX_SHOWN]}"'
    return ""


def _of_value(line: str, behind: str, message: str) -> str:
    """Return advice on what stands, or fails to stand, for a value."""
    if message.startswith("Illegal character") and line.count('"') % 2:
        return f"a closing quote is missing: {_EXAMPLE}"
    if not message.startswith("Invalid value"):
        return ""
    word = re.match(r"[A-Za-zµ]\w*", behind)
    if word is not None and word[0].lower() in ("true", "false", "yes", "no", "on", "off"):
        return "write true or false, in small letters"
    if word is not None:
        return f'text stands in quotes: "{word[0][:_MAX_SHOWN]}"'
    if re.match(r"[+-]?\.\d", behind):
        return "write a digit before the decimal point, 0.5"
    return f"a value is missing: {_EXAMPLE}" if behind in ("", ",") else ""


def _of_structure(message: str) -> str:
    """Return advice on brackets, equals signs and lines."""
    if message.startswith("Expected '='"):
        return f"key and value have an equals sign between them: {_EXAMPLE}"
    if "end of a table declaration" in message or "end of an array declaration" in message:
        return "close the bracket: a table is headed like [bearing]"
    if "array" in message:
        return "a list has commas between its entries and ends in ]"
    if "inline table" in message or "for a key part" in message:
        return (
            'a table in braces stands on one line, as in { start = "500 rpm", '
            'stop = "15000 rpm", count = 30 }'
        )
    if "'\\'" in message or "escape" in message:
        return "a backslash within quotes is written twice"
    if "newline or end of document" in message:
        return f"one entry on each line, comments begin with #: {_EXAMPLE}"
    return ""
