"""Lines and cells of CSV files, however they are separated, from their header on."""

from __future__ import annotations

import codecs
import csv
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from ..errors import TableError
from ..file_kinds import HEAD, FileKind, read_bytes, recognise, sentence
from .table_format import COEFFICIENTS

_MAX_BYTES = 20_000_000
MASSES = ("mxx", "mxy", "myx", "myy")
_OTHER_NAMES = {"rpm": "speed", "rotor_speed": "speed", "shaft_speed": "speed"} | {
    f"{name[0]}_{name[1:]}": name for name in (*COEFFICIENTS, *MASSES)
}
_HEADER = re.compile(r"\s*([^\[\]()]*?)\s*(?:\[([^\]]*)\]|\(([^)]*)\))?\s*")
_SEPARATORS = (",", ";", "\t", "|")
_TITLE_LINES = 50
"""Lines of a sheet that may stand before its header."""
LONGEST_NAME = 100
"""Characters in a header's cell."""
Line = tuple[int, list[str]]
"""Number of a line in the file, and its cells."""


def cells(
    source: Path,
    is_header: Callable[[list[str]], bool],
    other_names: Mapping[str, str] = _OTHER_NAMES,
    whole: bool = False,
) -> tuple[list[Line], str]:
    """Return lines of a CSV table from its header on, cut into cells, and what separates them.

    whole : Give all lines where there is no header, and not none.
    """

    def header(line: Sequence[str]) -> bool:
        return is_header([named(cell, other_names)[0] for cell in line])

    lines, separator = _lines(_text(source), source, header)
    for place, (_, line) in enumerate(lines[:_TITLE_LINES]):
        if header(line):
            return lines[place:], separator
    return lines if whole else [], separator


def _text(source: Path) -> str:
    """Return the text of a file that is one, and no other kind of file."""
    data = read_bytes(source, _MAX_BYTES, TableError)
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        try:
            return data.decode("utf-16")
        except UnicodeDecodeError as error:
            raise TableError(f"is no text in UTF-16 ({error.reason})", source=source) from None
    kind = recognise(data[:HEAD])
    if kind not in (None, FileKind.CSV):
        raise TableError(f"{sentence(kind)}; here a CSV table is needed", source=source)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise TableError(
            f"must be text in UTF-8; byte 0x{data[error.start]:02x} in line {line} is not; save it "
            'as UTF-8 ("CSV UTF-8")',
            source=source,
        ) from None


def _lines(
    text: str, source: Path, header: Callable[[Sequence[str]], bool]
) -> tuple[list[Line], str]:
    """Return the lines that hold something and are no comments, and what separates their cells."""
    lines = text.splitlines()
    stated = re.match(r"sep=([,;|\t])$", lines[0].strip(" \"'")) if lines else None
    if stated:  # a line for spreadsheet programs
        lines[0] = ""
    separator = stated[1] if stated else _separator(lines, header)
    if not separator:
        lines, separator = _from_blanks(lines, header), ","
    try:
        found = [
            (number, [cell.strip() for cell in cells])
            for number, cells in enumerate(csv.reader(lines, delimiter=separator), start=1)
            if any(cell.strip() for cell in cells) and not cells[0].lstrip().startswith("#")
        ]
    except csv.Error as error:
        raise TableError(f"is no CSV table: {error}", source=source) from None
    return found, separator


def _separator(lines: Sequence[str], header: Callable[[Sequence[str]], bool]) -> str:
    """Return what separates the cells of the first line that makes a header; empty: blanks."""
    for line in lines[:_TITLE_LINES]:
        if line.strip() and not line.lstrip().startswith("#"):
            for separator in _SEPARATORS:
                if header(line.split(separator)):
                    return separator
    blanks = any(header(line.lstrip("# ").split()) for line in lines[:_TITLE_LINES])
    return "" if blanks else ","


def _from_blanks(lines: Sequence[str], header: Callable[[Sequence[str]], bool]) -> list[str]:
    """Put commas between columns of blanks, from the header on, which may be a comment."""
    place = next(k for k, line in enumerate(lines) if header(line.lstrip("# ").split()))
    above = [""] * place
    return above + [
        ",".join((line.lstrip("# ") if k < 2 else line).split())
        for k, line in enumerate(lines[place:])
    ]


def named(cell: str, other_names: Mapping[str, str] = _OTHER_NAMES) -> tuple[str, str]:
    """Return the name as this program calls it, and unit, of a header's cell."""
    match = _HEADER.fullmatch(cell) if len(cell) <= LONGEST_NAME else None
    if match is None:
        return cell.strip()[:LONGEST_NAME], ""
    name = re.sub(r"[\s_]+", "_", match[1].strip(" \"'").lower())
    unit = (match[2] or match[3] or "").strip()
    return other_names.get(name, name), unit
