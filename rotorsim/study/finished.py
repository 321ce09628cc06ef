"""Finished operating points, kept: in a sweep's journal, and from one command to the next."""

from __future__ import annotations

import functools
import hashlib
import json
import os
import sqlite3
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ..atomic import write_text
from ..bearing.operating_point import OperatingPoint, point_from_dict, point_to_dict
from ..errors import InputError
from ..file_kinds import is_missing, read_bytes
from ..model import Case
from ..status import SolveStatus

_FORMAT = 2
_MAX_BYTES = 2_000_000_000
_SUM = "sha256"
"""Key of a line's checksum, over all of its other entries."""
_MODEL_SOURCES = ("film", "model", "bearing", "compiled.py")


class Journal:
    """Append-only store of finished operating points.

    A line is written whole and flushed to the disk before the next group starts, so that a kill
    loses what is being computed and nothing else; a line that a kill cut short, or that does not
    match its checksum, is dropped when the journal is opened again. Points are found by everything
    that fixes them (the case and the speed), so that a scenario may gain speeds or change its rotor
    and still reuse them. A journal of another program version is started afresh.

    path : str or Path. Made with the first point.
    Raises InputError: If `path` is a file of another kind.
    """

    def __init__(self, path: str | Path) -> None:
        self.path: Path = Path(path)
        self._whole: str | None = None
        self._points = self._read()

    def __len__(self) -> int:
        return len(self._points)

    def find(self, case: Case, speed: float) -> OperatingPoint | None:
        """Return the finished point of `case` at `speed` [rad/s], if there is one."""
        return self._points.get((_case_digest(case), speed))

    def add(self, case: Case, points: Sequence[OperatingPoint]) -> None:
        """Add finished `points` of `case`; failed ones are left out, to be tried again."""
        finished = [point for point in points if point.status is not SolveStatus.FAILED]
        if not finished:
            return
        digest = _case_digest(case)
        if self._whole is not None:
            # Cuts off what a kill left half written, or the next line would join it.
            write_text(self.path, self._whole)
            self._whole = None
        with self.path.open("a", encoding="utf-8", newline="\n") as stream:
            stream.write(_line_of(digest, finished) + "\n")
            stream.flush()
            os.fsync(stream.fileno())
        self._points.update({(digest, point.speed): point for point in finished})

    def discard(self) -> None:
        """Remove the file: its points are kept elsewhere now."""
        self.path.unlink(missing_ok=True)

    def _read(self) -> dict[tuple[str, float], OperatingPoint]:
        header = {"rotorsim_journal": _FORMAT, "model": model_digest()}
        lines = self._lines()
        if lines and not lines[0].startswith('{"rotorsim_journal"'):
            raise InputError(
                "is not a rotorsim sweep journal; choose another name", source=self.path
            )
        points: dict[tuple[str, float], OperatingPoint] = {}
        kept = [json.dumps(header)]
        if lines and _parse(lines[0]) == header:
            for line in lines[1:]:
                group = _points_of(line)
                if group:
                    points.update(group)
                    kept.append(line)
        self._whole = "\n".join(kept) + "\n"
        return points

    def _lines(self) -> list[str]:
        if is_missing(self.path):
            return []
        return read_bytes(self.path, _MAX_BYTES).decode("utf-8", errors="replace").splitlines()


_LIMIT = 200_000_000
"""Bytes of the store, some 60 000 points; beyond it the older half goes."""
FRESH = "ROTORSIM_FRESH"
"""Environment variable: where it is set no point of an earlier command is taken."""
asked: Counter[str] = Counter()
"""Points that this process `wanted` from the store, and those `found` there."""


class PointStore:
    """Converged operating points of earlier commands: a SQLite file in the user's cache folder.

    Found by everything that fixes them: the program's sources, the case, the speed. Several
    processes may use it at once. What goes wrong with it costs time and nothing else: a folder that
    cannot be written keeps nothing, a damaged file is removed.
    """

    def __init__(self) -> None:
        self._file: sqlite3.Connection | None = None

    def __enter__(self) -> PointStore:
        with self._trying():
            path = store_path()
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = sqlite3.connect(path, timeout=2.0, isolation_level=None)
            # A power cut may damage the file: it is only a store.
            self._file.execute("PRAGMA synchronous = OFF")
            self._file.execute(
                "CREATE TABLE IF NOT EXISTS points (key TEXT PRIMARY KEY, line TEXT)"
            )
        return self

    def __exit__(self, *_error: object) -> None:
        if self._file is not None:
            self._file.close()

    def find(self, case: Case, speed: float) -> OperatingPoint | None:
        """Return the finished point of `case` at `speed` [rad/s], if there is one."""
        asked["wanted"] += 1
        row, digest = None, _case_digest(case)
        if self._file is not None and not os.environ.get(FRESH):
            with self._trying():
                row = self._file.execute(
                    "SELECT line FROM points WHERE key = ?", (_key(digest, speed),)
                ).fetchone()
        point = None if row is None else _points_of(row[0]).get((digest, speed))
        asked["found"] += point is not None
        return point

    def add(self, case: Case, points: Sequence[OperatingPoint]) -> None:
        """Add the converged ones of `points`; another start may bring the others to converge."""
        digest = _case_digest(case)
        rows = [
            (_key(digest, point.speed), _line_of(digest, [point]))
            for point in points
            if point.converged
        ]
        if self._file is not None and rows:
            with self._trying():
                _insert(self._file, rows)

    @contextmanager
    def _trying(self) -> Iterator[None]:
        """Run the body; go on without the file where it fails."""
        try:
            yield
        except (OSError, RuntimeError, sqlite3.Error) as error:
            if self._file is not None:
                self._file.close()
            self._file = None
            # Its subclasses say that the file is in use or may not be written, itself: damaged.
            if type(error) is sqlite3.DatabaseError:
                with suppress(OSError):
                    store_path().unlink()


def store_path() -> Path:
    """Return the file of the points that commands take from each other."""
    from ..orbit.film_map import cache_folder

    return cache_folder() / "points.sqlite"


def _insert(file: sqlite3.Connection, rows: Sequence[tuple[str, str]]) -> None:
    file.executemany("INSERT OR REPLACE INTO points VALUES (?, ?)", rows)
    pages, free, size = (
        file.execute(f"PRAGMA {name}").fetchone()[0]
        for name in ("page_count", "freelist_count", "page_size")
    )
    if (pages - free) * size > _LIMIT:
        file.execute(
            "DELETE FROM points WHERE rowid <= (SELECT rowid FROM points ORDER BY rowid "
            "LIMIT 1 OFFSET (SELECT count(*) / 2 FROM points))"
        )


def _key(case_digest: str, speed: float) -> str:
    return f"{model_digest()} {case_digest} {float(speed).hex()}"


def _line_of(case_digest: str, points: Sequence[OperatingPoint]) -> str:
    record = {"case": case_digest, "points": [point_to_dict(point) for point in points]}
    return json.dumps({**record, _SUM: _checksum(record)})


def _points_of(line: str) -> dict[tuple[str, float], OperatingPoint]:
    record = _parse(line)
    if record.pop(_SUM, None) != _checksum(record):
        return {}
    try:
        entries = [point_from_dict(entry) for entry in record["points"]]
        return {(record["case"], point.speed): point for point in entries}
    except (KeyError, TypeError, ValueError):
        return {}


def _checksum(record: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(record).encode()).hexdigest()[:24]


def _parse(line: str) -> dict[str, Any]:
    try:
        record = json.loads(line)
    except ValueError:
        return {}
    return record if isinstance(record, dict) else {}


def _case_digest(case: Case) -> str:
    """Return fingerprint of everything in `case`.

    The model objects print all their values in full.
    """
    return hashlib.sha256(repr(case).encode()).hexdigest()[:24]


@functools.cache
def model_digest() -> str:
    """Return the fingerprint of the program that computes a point: its source files, read once.

    Stricter than a version number, which a developer forgets to raise.
    """
    root = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for name in _MODEL_SOURCES:
        entry = root / name
        files = sorted(entry.rglob("*.py")) if entry.is_dir() else [entry]
        for file in files:
            digest.update(file.relative_to(root).as_posix().encode())
            digest.update(file.read_bytes())
    return digest.hexdigest()[:24]
