"""Plain arrays of numbers from .npz and .mat files, whatever these files claim to hold.

Sizes are known before anything is unpacked, nothing is unpickled, and the indices of sparse
matrices are checked before SciPy's compiled code follows them.
"""

from __future__ import annotations

import io
import math
import struct
import warnings
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..file_kinds import read_bytes

_LARGEST = 1e30
"""Magnitude of a number in SI; beyond, products of two would overflow before long."""
_MAX_BYTES = 200_000_000
_MAX_UNPACKED = 500_000_000
"""Of all arrays together, and of a sparse matrix as a full one [bytes]."""
_COMPRESSED = 15
"""Type of an element in MATLAB's format that holds another one, deflated."""
_MATLAB_HEADER = 128


class _Unsuited(Exception):
    """Why a file is not read, in words for its user."""


def read_arrays(source: Path) -> dict[str, NDArray[Any]]:
    """Arrays of a .npz or .mat file (up to version 7) by name, sparse ones as full matrices.

    Raises InputError: The file cannot be read, is damaged, holds something else than numbers, or
        arrays that are too large for a rotor.
    """
    data = read_bytes(source, _MAX_BYTES)
    suffix = source.suffix.lower()
    try:
        found = dict(_numpy_arrays(data) if suffix == ".npz" else _matlab_arrays(data))
        for name, array in found.items():
            if array.dtype.kind not in "biufc":
                raise _Unsuited(f"{name} holds no numbers")
            if array.dtype.kind in "fc" and bool(np.any(np.abs(array) > _LARGEST)):
                raise _Unsuited(f"{name} holds numbers beyond {_LARGEST:g}")
    except _Unsuited as reason:
        raise InputError(f"cannot be read: {reason}", source=source) from None
    except NotImplementedError:
        raise InputError(
            "cannot be read: save it in MATLAB with the option -v7", source=source
        ) from None
    except Exception:  # the readers raise a dozen kinds on damaged files
        raise InputError(
            f"cannot be read: no {suffix} file of plain arrays of numbers", source=source
        ) from None
    return found


def _numpy_arrays(data: bytes) -> Iterator[tuple[str, NDArray[Any]]]:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        entries = archive.infolist()
        _check_size(sum(entry.file_size for entry in entries))
        for entry in entries:
            # No more than this is unpacked, whatever is packed.
            with archive.open(entry) as stream:
                yield entry.filename.removesuffix(".npy"), _numpy_array(stream.read())


def _numpy_array(data: bytes) -> NDArray[Any]:
    """Array of a .npy file, without pickled objects."""
    stream = io.BytesIO(data)
    version = np.lib.format.read_magic(stream)
    read_header = {
        (1, 0): np.lib.format.read_array_header_1_0,
        (2, 0): np.lib.format.read_array_header_2_0,
    }[version]
    shape, by_columns, dtype = read_header(stream)
    if dtype.hasobject or math.prod(shape) * dtype.itemsize != len(data) - stream.tell():
        raise _Unsuited("an array is no plain numbers, or cut off")
    return np.frombuffer(data, dtype, offset=stream.tell()).reshape(
        shape, order="F" if by_columns else "C"
    )


def _matlab_arrays(data: bytes) -> Iterator[tuple[str, NDArray[Any]]]:
    from scipy.io import loadmat, whosmat

    _check_size(_inflated(data))
    with warnings.catch_warnings():
        # Whether sparse matrices come as SciPy's older kind or its newer one: both will do.
        warnings.simplefilter("ignore")
        _check_size(sum(16 * math.prod(shape) for _, shape, _ in whosmat(io.BytesIO(data))))
        found = loadmat(io.BytesIO(data))
    for name, value in found.items():
        if not name.startswith("__"):
            yield name, _full(value, name) if hasattr(value, "indptr") else np.asarray(value)


def _inflated(data: bytes) -> int:
    """Bytes of a MATLAB file when all of it is inflated; no more of it than one block at a time."""
    if not data.startswith(b"MATLAB 5.0"):
        return len(data)
    order = "<" if data[126:128] == b"IM" else ">"
    total, place = 0, _MATLAB_HEADER
    while place + 8 <= len(data):
        kind, size = struct.unpack(f"{order}II", data[place : place + 8])
        body = data[place + 8 : place + 8 + size]
        place += 8 + size
        total += size
        packed = zlib.decompressobj() if kind == _COMPRESSED else None
        while packed is not None and body and not packed.eof and total <= _MAX_UNPACKED:
            total += len(packed.decompress(body, 1_000_000))
            body = packed.unconsumed_tail
    return total


def _full(value: Any, name: str) -> NDArray[Any]:
    """Sparse matrix by columns as a full one, its indices checked first."""
    rows, columns = value.shape
    indices, starts = np.asarray(value.indices), np.asarray(value.indptr)
    good = (
        starts.shape == (columns + 1,)
        and starts[0] == 0
        and not np.any(np.diff(starts) < 0)
        and starts[-1] <= min(indices.size, value.data.size)
        and not np.any((indices < 0) | (indices >= rows))
    )
    if not good:
        raise _Unsuited(f"indices of the sparse matrix {name} lie outside of it")
    return value.toarray()


def _check_size(size: int) -> None:
    if size > _MAX_UNPACKED:
        raise _Unsuited(
            f"its arrays would take {size / 1e6:.0f} MB or more, at most "
            f"{_MAX_UNPACKED / 1e6:.0f} MB are read"
        )
