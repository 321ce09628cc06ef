"""Rotors given by their matrices in .npz and .mat files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arguments import file_path
from ..errors import InputError
from ..file_kinds import FileKind, kind_of, sentence
from ..rotor import Rotor
from .arrays import read_arrays

_OWN_KINDS = (None, FileKind.NUMPY, FileKind.MATLAB)
_MOST_NODES = 1e6
_LEAST_MASS = 1e-20
"""On the diagonal [kg, kg m^2]; below, accelerations would overflow."""
_KNOWN = ("M", "D", "C", "G", "K", "H", "bearing_nodes", "dofs_per_node")
_KNOWN_WORDS = "M, D or C (damping), G, K, H (circulatory), bearing_nodes, dofs_per_node"


def load_rotor(
    path: str | Path,
    bearing_nodes: Sequence[int] | None = None,
    dofs_per_node: int | None = None,
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
    """Matrix of real or complex numbers."""
    return value if np.iscomplexobj(value) else value.astype(float)


def _read(source: Path) -> dict[str, NDArray[Any]]:
    if source.suffix.lower() not in (".npz", ".mat"):
        kind = kind_of(source)
        known = f"{sentence(kind)}; a rotor's file " if kind not in _OWN_KINDS else ""
        raise InputError(f"{known}must end in .npz or .mat", source=source)
    return read_arrays(source)
