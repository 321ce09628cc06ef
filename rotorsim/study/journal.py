"""The sweep's journal: finished points, one flushed JSON line per group, readable after a kill."""

from __future__ import annotations

import functools
import hashlib
import json
import os
import socket
from collections.abc import Sequence
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

    def append(self, case: Case, points: Sequence[OperatingPoint]) -> None:
        """Add finished `points` of `case`; failed ones are left out, to be tried again."""
        finished = [point for point in points if point.status is not SolveStatus.FAILED]
        if not finished:
            return
        digest = _case_digest(case)
        line = {"case": digest, "points": [point_to_dict(point) for point in finished]}
        if self._whole is not None:
            # Cuts off what a kill left half written, or the next line would join it.
            write_text(self.path, self._whole)
            self._whole = None
        with self.path.open("a", encoding="utf-8", newline="\n") as stream:
            stream.write(json.dumps({**line, _SUM: _checksum(line)}) + "\n")
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
    """Fingerprint of everything in `case`: the model objects print all their values in full."""
    return hashlib.sha256(repr(case).encode()).hexdigest()[:24]


@functools.cache
def model_digest() -> str:
    """Fingerprint of the program that computes a point: its source files, read once.

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


def refuse_other_sources(wanted: str) -> None:
    """Refuse to compute for a program of another `model_digest`: its numbers might differ.

    Raises InputError: It is another one than this.
    """
    if wanted != model_digest():
        raise InputError(
            "a worker has other sources of rotorsim than this computer, so its results might "
            "differ; install the same there and start it anew",
            key="--scheduler", value=f"{socket.gethostname()}: {model_digest()}",
        )  # fmt: skip
