"""Rotors given by their matrices in .npz and .mat files."""

from __future__ import annotations

import io
import math
import struct
import warnings
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arguments import file_path
from ..errors import InputError
from ..file_kinds import FileKind, kind_of, read_bytes, sentence
from ..rotor import Rotor

_OWN_KINDS = (None, FileKind.NUMPY, FileKind.MATLAB)
_MOST_NODES = 1e6
_LEAST_MASS = 1e-20
"""On the diagonal [kg, kg m^2]; below, accelerations would overflow."""
_KNOWN = ("M", "D", "C", "G", "K", "H", "bearing_nodes", "dofs_per_node")
_KNOWN_WORDS = "M, D or C (damping), G, K, H (circulatory), bearing_nodes, dofs_per_node"


def load_rotor(
    path: str | Path, bearing_nodes: Sequence[int] | None = None, dofs_per_node: int | None = None
) -> Rotor:
    """Read a rotor from .npz or .mat with M, D, G, K, H, ``bearing_nodes`` and ``dofs_per_node``.

    The damping matrix may be called C as well. D (or C), G and H may be left out (zero),
    ``dofs_per_node`` too (4). An array of another name is refused: it might be one that counts.

    path : str or Path
    bearing_nodes : In place of the file's, counted from 0.
    dofs_per_node : In place of the file's.
    Raises InputError: The file cannot be read, or its matrices do not make a rotor.
    """
    source = file_path(path)
    data = _read(source)
    _check_names(data, source, bearing_nodes is not None)
    if bearing_nodes is not None:
        data["bearing_nodes"] = np.asarray(bearing_nodes)
    if dofs_per_node is not None:
        data["dofs_per_node"] = np.asarray(dofs_per_node)
    if "C" in data:
        data["D"] = data.pop("C")
    try:
        given = {name: _matrix(data[name]) for name in "MDGKH" if name in data}
        nodes = np.atleast_1d(np.asarray(data["bearing_nodes"], dtype=float)).ravel()
        per_node = float(np.asarray(data.get("dofs_per_node", 4), dtype=float).ravel()[0])
    except (TypeError, ValueError, IndexError) as error:
        raise InputError(f"arrays must be real numbers ({error})", source=source) from error
    for key, values in (("bearing_nodes", nodes), ("dofs_per_node", np.array([per_node]))):
        for position, value in enumerate(values):
            if not abs(value) < _MOST_NODES or value != np.round(value):
                raise InputError(
                    "must be whole numbers", source=source, key=f"{key}, column {position}",
                    value=float(value),
                )  # fmt: skip
    smallest = np.abs(np.diagonal(np.atleast_2d(given["M"]))).min(initial=1.0)
    if 0.0 < smallest < _LEAST_MASS:
        raise InputError(
            f"is below every sensible mass ({_LEAST_MASS:g})", source=source, key="M",
            value=float(smallest),
        )  # fmt: skip
    return Rotor.from_matrices(
        given["M"], given["K"], given.get("D"), given.get("G"), given.get("H"),
        bearing_nodes=[int(v) for v in nodes], unknowns_per_node=int(per_node), source=str(source),
    )  # fmt: skip


def _check_names(data: Mapping[str, Any], source: Path, nodes_given: bool) -> None:
    """Refuse what is unknown, missing or there twice."""
    held = f"the file holds {', '.join(data) or 'nothing'}"
    unknown = [name for name in data if name not in _KNOWN]
    if unknown:
        raise InputError(
            f"no such array in a rotor; known are {_KNOWN_WORDS}; {held}",
            source=source, key=", ".join(unknown),
        )  # fmt: skip
    if "C" in data and "D" in data:
        raise InputError("both are damping: keep one", source=source, key="C, D")
    needed = ("M", "K") if nodes_given else ("M", "K", "bearing_nodes")
    missing = [name for name in needed if name not in data]
    if missing:
        nodes = (
            "; the nodes that bearings carry, from 0, may be given beside the file: "
            '--bearing-nodes "1,7", in Python bearing_nodes=(1, 7)'
        )
        hint = nodes if "bearing_nodes" in missing else ""
        raise InputError(f"arrays are missing: {', '.join(missing)}; {held}{hint}", source=source)


def _matrix(value: NDArray[Any]) -> NDArray[Any]:
    """Return the matrix of real or complex numbers."""
    return value if np.iscomplexobj(value) else value.astype(float)


def _read(source: Path) -> dict[str, NDArray[Any]]:
    if source.suffix.lower() not in (".npz", ".mat"):
        kind = kind_of(source)
        known = f"{sentence(kind)}; a rotor's file " if kind not in _OWN_KINDS else ""
        raise InputError(f"{known}must end in .npz or .mat", source=source)
    return _read_arrays(source)


_LARGEST = 1e30
"""Magnitude of a number in SI; beyond, products of two would overflow before long."""
_MAX_BYTES = 200_000_000
_MAX_UNPACKED = 500_000_000
"""Of all arrays together, and of a sparse matrix as a full one [bytes]."""
_COMPRESSED = 15
"""Type of an element in MATLAB's format that holds another one, deflated."""
_MATLAB_HEADER = 128


class _Unsuited(Exception):
    """Reason for which a file is not read, in words for its user."""


def _read_arrays(source: Path) -> dict[str, NDArray[Any]]:
    """Return arrays of a .npz or .mat file (up to version 7) by name, sparse ones as full matrices.

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
    """Return the array of a .npy file, without pickled objects."""
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
    """Return the bytes of a MATLAB file, all of it inflated block by block."""
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
    """Return the sparse matrix by columns as a full one, its indices checked first."""
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
