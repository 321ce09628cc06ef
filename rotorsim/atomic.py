"""Files that are either the old one or the new one, whatever happens in between."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Give a temporary path to write to; rename it to `path` when the block ends well.

    path : str or Path. Where the file is wanted; missing folders are made. What a symbolic link
        points to is replaced, not the link, and an existing file keeps its permissions.
    Yields Path : In the same folder and with the same suffix (some libraries choose the format by
        it).

    A rename within one folder is atomic on POSIX and on Windows. The data are flushed to the disk
    first, so that a power cut cannot leave the new name on an empty file. If the block raises, the
    temporary file is removed and `path` stays as it was.

    Examples
    --------
    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> with replacing(folder / "a.txt") as temporary:
    ...     _ = temporary.write_text("whole", encoding="utf-8")
    >>> [entry.name for entry in folder.iterdir()]
    ['a.txt']
    """
    target = Path(os.path.realpath(path))
    target.parent.mkdir(parents=True, exist_ok=True)
    temporary = target.with_name(f".{target.stem[:40]}.{secrets.token_hex(4)}.tmp{target.suffix}")
    try:
        yield temporary
        _flush_to_disk(temporary)
        if target.exists():
            shutil.copymode(target, temporary)
        temporary.replace(target)
    except OSError as error:
        if error.errno is None or error.filename not in (None, str(temporary)):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error  # not the temporary's name
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def write_bytes(path: str | Path, data: bytes) -> None:
    """Write `data` to `path`, whole or not at all."""
    with replacing(path) as temporary:
        temporary.write_bytes(data)


def write_text(path: str | Path, text: str) -> None:
    """Write `text` (UTF-8, line ends as given) to `path`, whole or not at all."""
    write_bytes(path, text.encode("utf-8"))


def _flush_to_disk(path: Path) -> None:
    # Opened for writing: Windows refuses to flush a read-only handle.
    with path.open("rb+") as stream:
        os.fsync(stream.fileno())
