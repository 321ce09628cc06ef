"""Tables on disk: netCDF 4, written in one stroke, refused when damaged."""

from __future__ import annotations

import gc
import hashlib
import io
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..arguments import file_path
from ..atomic import write_bytes
from ..errors import TableError
from ..file_kinds import HEAD, FileKind, is_missing, read_bytes, recognise, sentence
from .table_data import scenario_digest
from .table_format import TABLE_VERSION

if TYPE_CHECKING:
    import xarray as xr

_SEAL = b"\nrotorsim sha256 "
"""Mark before the checksum of all bytes before it; HDF5 ignores what follows its own end."""
_SEALED = len(_SEAL) + 64
"""Bytes at the end of a file that this program wrote."""
_MAX_BYTES = 500_000_000
_MAX_LOADED = 500_000_000
"""Arrays of a file in memory [bytes]; a small file can claim arrays of any size."""


def write(dataset: xr.Dataset, path: str | Path) -> Path:
    """Write `dataset`; an existing file is replaced only by a complete one.

    Raises TableError: The file cannot be written.

    The file is made in memory first: the HDF5 library crashes where a disk is full. Its last bytes
    are the SHA-256 of all others; every block of numbers has a checksum of HDF5 as well, which
    stays when another program writes the file anew.
    """
    target = Path(path)
    encoding: dict[str, dict[str, Any]] = {
        str(name): {"fletcher32": True, "chunksizes": variable.shape}
        for name, variable in dataset.variables.items()
        if variable.dtype.kind in "fi" and variable.size and variable.ndim
    }
    stream = io.BytesIO()
    try:
        dataset.to_netcdf(stream, engine="h5netcdf", format="NETCDF4", encoding=encoding)
        data = stream.getvalue()
        write_bytes(target, data + _SEAL + hashlib.sha256(data).hexdigest().encode())
    except OSError as error:
        raise TableError(f"cannot be written: {error.strerror or error}", source=target) from error
    return target


def read(path: str | Path) -> xr.Dataset:
    """Read a table's dataset into memory.

    Raises TableError: The file is missing, damaged, not a table, or of a newer format.
    """
    source = file_path(path)
    if is_missing(source):
        raise TableError("no such file; `rotorsim table SCENARIO` makes one", source=source)
    data = read_bytes(source, _MAX_BYTES, TableError)
    kind = recognise(data[:HEAD], source.suffix.lower())
    if kind not in (None, FileKind.NETCDF):
        reader = "; CoefficientTable.from_csv reads one" if kind is FileKind.CSV else ""
        raise TableError(f"{sentence(kind)}{reader}; here a netCDF table is needed", source=source)
    dataset = _loaded(_unsealed(data, source), source)
    _check_texts(dataset, source)
    _check_provenance(dataset, source)
    for variable in dataset.variables.values():
        variable.encoding = {}
    return dataset


def _unsealed(data: bytes, source: Path) -> bytes:
    """Check and cut off the checksum at the end; a file of another program has none."""
    end = data.rfind(_SEAL, -2 * _SEALED)
    if end < 0:
        return data
    body, stated = data[:end], data[end + len(_SEAL) :]
    if hashlib.sha256(body).hexdigest().encode() != stated:
        raise TableError(
            "its contents do not match its SHA-256: it is damaged, or was changed after it was "
            "written; make it again with `rotorsim table`",
            source=source,
        )
    return body


def _loaded(data: bytes, source: Path) -> xr.Dataset:
    failure, hook = "", sys.unraisablehook
    # h5netcdf's destructors complain aloud about files that could not be opened.
    sys.unraisablehook = lambda _: None
    try:
        return _opened(data)
    except _TooLarge as error:
        raise TableError(str(error), source=source) from None
    except Exception as error:  # the libraries raise a dozen kinds on damaged files
        failure = str(error) or type(error).__name__
    finally:
        if failure:
            gc.collect()
        sys.unraisablehook = hook
    raise TableError(
        f"not a readable netCDF file, it may be truncated or damaged ({failure[:200]}); "
        "make it again with `rotorsim table`",
        source=source,
    )


class _TooLarge(Exception):
    """Arrays that no table has."""


def _opened(data: bytes) -> xr.Dataset:
    """Return the dataset of a file's contents, loaded if it is not too large."""
    import xarray as xr

    with (
        warnings.catch_warnings(),
        # A file of tables has no dates; units that look like such are somebody else's.
        xr.open_dataset(io.BytesIO(data), engine="h5netcdf", decode_times=False) as opened,
    ):
        warnings.simplefilter("ignore")
        if opened.nbytes > _MAX_LOADED:
            raise _TooLarge(f"claims arrays of {opened.nbytes / 1e6:.0f} MB: no coefficient table")
        return opened.load()


def _check_texts(dataset: xr.Dataset, source: Path) -> None:
    """Refuse text that is no UTF-8; the readers let it pass."""
    texts = [*dataset.attrs.items()]
    texts += [(n, t) for n, v in dataset.variables.items() for t in v.attrs.values()]
    texts += [(n, t) for n, v in dataset.variables.items() if v.dtype == object
              for t in v.values.flat]  # fmt: skip
    for name, text in texts:
        try:
            str(text).encode()
        except UnicodeEncodeError:
            raise TableError(
                "holds text that is no UTF-8: the file is damaged", source=source,
                key=str(name).encode(errors="replace").decode(),
            ) from None  # fmt: skip


def _check_provenance(dataset: xr.Dataset, source: Path) -> None:
    if "decay_rate" in dataset:
        raise TableError(
            "decay_rate was the largest real part of the eigenvalues in maps and its negative in "
            "JSON; both are now growth_rate, positive when unstable: make this file again with "
            "`rotorsim stability`",
            source=source,
            key="decay_rate",
        )
    version = dataset.attrs.get("rotorsim_table_version")
    if version is None:
        raise TableError(
            "not a coefficient table: the attribute rotorsim_table_version is missing",
            source=source,
        )
    try:
        number = int(version)
    except (TypeError, ValueError, OverflowError):
        raise TableError(
            "must be a whole number", source=source, key="rotorsim_table_version",
            value=str(version)[:50],
        ) from None  # fmt: skip
    if number > TABLE_VERSION:
        raise TableError(
            f"written in table format {number}, this program reads up to {TABLE_VERSION}; "
            "use a newer rotorsim",
            source=source,
        )
    text, digest = dataset.attrs.get("scenario"), dataset.attrs.get("scenario_sha256")
    if not isinstance(text, str | None) or not isinstance(digest, str | None):
        raise TableError("must be text", source=source, key="scenario, scenario_sha256")
    if (text is None) != (digest is None) or (text is not None and scenario_digest(text) != digest):
        raise TableError(
            "the scenario's text does not match its SHA-256: the file was changed after it was "
            "written; make it again with `rotorsim table`",
            source=source,
            key="scenario_sha256",
        )
