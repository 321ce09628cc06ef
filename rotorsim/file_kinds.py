"""Kinds of files, by first bytes and name; the command that takes each, and its contents.

Nothing here decides what can be read: the readers do, and ask here only for what to say of a file
that is not theirs.
"""

from __future__ import annotations

import os
import re
import stat
from enum import StrEnum
from pathlib import Path

from .errors import InputError

HEAD = 65_536
"""Bytes of a file that are looked at."""


class FileKind(StrEnum):
    """Kinds of files that users of rotorsim have at hand."""

    SCENARIO = "scenario"
    NETCDF = "netCDF"
    CSV = "CSV"
    ROSS = "ROSS"
    COLUMNS = "columns"
    RECORDING = "recording"
    NUMPY = "NumPy"
    MATLAB = "MATLAB"
    JOURNAL = "journal"
    PAGE = "page"
    PICTURE = "picture"
    SPREADSHEET = "spreadsheet"
    JSON = "JSON"


_TAKES_TABLES = "`rotorsim stability`, `rotorsim export` and `rotorsim orbit SCENARIO --table` take"
_SENTENCES = {
    FileKind.SCENARIO: (
        "is a scenario; `rotorsim table SCENARIO` makes a coefficient table from it, "
        "`rotorsim check`, `run`, `stability` and others take it as it is"
    ),
    FileKind.NETCDF: (
        "is a netCDF file (.nc), as coefficient tables are; " + _TAKES_TABLES + " such a table"
    ),
    FileKind.CSV: "is a CSV file (.csv); " + _TAKES_TABLES + " coefficients in CSV",
    FileKind.ROSS: "is a bearing that ROSS saved; " + _TAKES_TABLES + " it",
    FileKind.COLUMNS: (
        "is plain text (.txt) without columns of coefficients; " + _TAKES_TABLES + " such columns"
    ),
    FileKind.RECORDING: "is a recording (.rrd); `rotorsim view` takes it",
    FileKind.NUMPY: (
        "is a NumPy file (.npz); the matrices of a rotor in one go with "
        "`rotorsim stability TABLE --rotor FILE`"
    ),
    FileKind.MATLAB: (
        "is a MATLAB file (.mat); the matrices of a rotor in one go with "
        "`rotorsim stability TABLE --rotor FILE`; of a table that was exported, give the original"
    ),
    FileKind.JOURNAL: (
        "is the journal of a sweep that was interrupted; `rotorsim table SCENARIO` resumes it"
    ),
    FileKind.PAGE: "is a web page (.html) such as a report; a browser opens it, no command does",
    FileKind.PICTURE: "is a picture or a document, which no command takes",
    FileKind.SPREADSHEET: "is a spreadsheet; save its sheet as CSV (UTF-8, separated by commas)",
    FileKind.JSON: (
        "is a JSON file; the only ones read are bearings saved by ROSS; " + _TAKES_TABLES + " them"
    ),
}  # fmt: skip
_BY_FIRST_BYTES = (
    (b"\x89HDF\r\n\x1a\n", FileKind.NETCDF),
    (b"CDF\x01", FileKind.NETCDF),
    (b"CDF\x02", FileKind.NETCDF),
    (b"RRF", FileKind.RECORDING),
    (b'{"rotorsim_journal"', FileKind.JOURNAL),
    (b"MATLAB 5.0 MAT-file", FileKind.MATLAB),
    (b"\x93NUMPY", FileKind.NUMPY),
    (b"\x89PNG", FileKind.PICTURE),
    (b"GIF8", FileKind.PICTURE),
    (b"%PDF", FileKind.PICTURE),
    (b"\xd0\xcf\x11\xe0", FileKind.SPREADSHEET),
)
_BY_SUFFIX = {
    ".nc": FileKind.NETCDF,
    ".csv": FileKind.CSV,
    ".txt": FileKind.COLUMNS,
    ".rrd": FileKind.RECORDING,
    ".npz": FileKind.NUMPY,
    ".npy": FileKind.NUMPY,
    ".mat": FileKind.MATLAB,
    ".journal": FileKind.JOURNAL,
    ".html": FileKind.PAGE,
    ".htm": FileKind.PAGE,
    ".png": FileKind.PICTURE,
    ".svg": FileKind.PICTURE,
    ".gif": FileKind.PICTURE,
    ".mp4": FileKind.PICTURE,
    ".pdf": FileKind.PICTURE,
    ".json": FileKind.JSON,
}
KNOWN_SUFFIXES = frozenset(_BY_SUFFIX)
"""Endings of names that tell a kind other than a scenario."""
_SCENARIO_TABLE = re.compile(
    rb"^[ \t]*\[+(bearing|lubricant|operating)\b|^[ \t]*(bearing|lubricant|operating)\.", re.M
)
_BETWEEN_NAMES = re.compile(rb'[\s,;|"#()\[\]]+')
_TITLE_LINES = 50
"""Lines of a sheet that may stand before its header."""
_COEFFICIENT = re.compile(rb"^[ \t]*kxx[ \t]*=", re.M)


def is_missing(path: str | Path) -> bool:
    """Return whether there is nothing of that name; False where that cannot be told."""
    try:
        os.lstat(path)
    except (FileNotFoundError, NotADirectoryError):
        return True
    except (OSError, ValueError):
        return False
    return False


def read_bytes(path: str | Path, most: int, error: type[InputError] = InputError) -> bytes:
    """Return the contents of an ordinary file.

    path : str or Path
    most : Size of the largest file that is read [bytes].
    error : Of what is raised.
    Raises InputError: There is no such file, it is a folder, a pipe or a device, is larger than
        `most`, or cannot be read.

    A pipe is refused before it is opened, which could wait for ever.
    """
    source = Path(path)
    try:
        found = source.stat()
        if stat.S_ISDIR(found.st_mode):
            raise error("is a directory; give a file", source=source)
        if not stat.S_ISREG(found.st_mode):
            raise error("is no ordinary file; save its contents to one", source=source)
        if found.st_size > most:
            raise error(
                f"is too large: {found.st_size / 1e6:.0f} MB, at most {most / 1e6:.0f} MB are read",
                source=source,
            )
        with source.open("rb") as stream:
            return stream.read(most)
    except FileNotFoundError:
        raise error("no such file", source=source) from None
    except OSError as problem:
        raise error(f"cannot be read: {problem.strerror or problem}", source=source) from None
    except InputError:  # also a ValueError
        raise
    except ValueError as problem:  # a name that no file can have
        raise error(f"cannot be read: {problem}", source=source) from None


def kind_of(path: str | Path) -> FileKind | None:
    """Return the kind of a file by its contents, else by its name; None where neither tells."""
    try:
        if not os.path.isfile(path):  # opening a pipe would wait for who writes to it
            return None
        with Path(path).open("rb") as file:
            head = file.read(HEAD)
    except (OSError, ValueError):
        return None
    return recognise(head, Path(path).suffix.lower())


def recognise(head: bytes, suffix: str = "") -> FileKind | None:
    """Return the kind of a file that begins with `head` and whose name ends in `suffix`.

    Examples
    --------
    >>> recognise(b"RRF2...", ".toml").value
    'recording'
    >>> recognise(b"anything", ".toml") is None
    True
    """
    for first, kind in _BY_FIRST_BYTES:
        if head.startswith(first):
            return kind
    if head.startswith(b"PK\x03\x04"):
        return FileKind.NUMPY if suffix == ".npz" else FileKind.SPREADSHEET
    text = head.removeprefix(b"\xef\xbb\xbf").lstrip()
    if text[:15].lower().startswith((b"<!doctype html", b"<html")):
        return FileKind.PAGE
    if text[:200].startswith((b"<?xml", b"<svg")):
        return FileKind.PICTURE
    if _SCENARIO_TABLE.search(text):
        return FileKind.SCENARIO
    if _COEFFICIENT.search(text) or (text.startswith(b"{") and b'"kxx"' in text):
        return FileKind.ROSS
    if _is_csv_of_coefficients(text):
        return FileKind.CSV
    return _BY_SUFFIX.get(suffix)


def _is_csv_of_coefficients(text: bytes) -> bool:
    """Return whether one of the first lines names the columns of a coefficient table."""
    lines = text.lower().replace(b"_", b"").splitlines()[:_TITLE_LINES]
    return any({b"kxx", b"cxx"} <= set(_BETWEEN_NAMES.split(line)) for line in lines)


SUFFIXES = {
    FileKind.SCENARIO: ".toml",
    FileKind.NETCDF: ".nc",
    FileKind.CSV: ".csv",
    FileKind.ROSS: ".toml",
}
"""Endings of the files that are taken by name."""


def sentence(kind: FileKind | None) -> str:
    """Return what a file of that kind is and which command takes it; empty for None.

    Examples
    --------
    >>> sentence(FileKind.RECORDING)
    'is a recording (.rrd); `rotorsim view` takes it'
    """
    return "" if kind is None else _SENTENCES[kind]
