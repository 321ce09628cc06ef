"""A general rotor given by its matrices, with bearings at some of its nodes."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..file_kinds import FileKind, kind_of, sentence
from .matrices import second_order_state_matrix

if TYPE_CHECKING:
    from ..bearing.interpolation import Coefficients

Array = NDArray[np.float64]

_SYMMETRY = 1e-8
_OWN_KINDS = (None, FileKind.NUMPY, FileKind.MATLAB)
_IN_FILE = {"mass": "M", "damping": "D or C", "gyroscopic": "G", "stiffness": "K"}
"""Names of the matrices in a file."""
_KNOWN = ("M", "D", "C", "G", "K", "bearing_nodes", "dofs_per_node")
_KNOWN_WORDS = "M, D or C (damping), G, K, bearing_nodes, dofs_per_node"


@dataclass(frozen=True, eq=False)
class GeneralRotor:
    """M q'' + (D + omega G) q' + K q = F with like bearings at `bearing_nodes`.

    Attributes
    ----------
    mass, damping, gyroscopic, stiffness : (n, n) arrays
        SI. The degrees of freedom are grouped by node: x, y first, then the node's others (for
        example two slopes). The gyroscopic matrix is multiplied by the shaft speed [rad/s].
    bearing_nodes : tuple of int
        Nodes that a bearing carries, from 0.
    dofs_per_node : int
        2 or more; 4 for beam elements.

    Raises
    ------
    InputError
        A matrix is not square, not of the mass matrix's size or not finite, the mass matrix is not
        symmetric and positive, the gyroscopic matrix not skew, or a node is out of range; the
        message names row and column.
    """

    mass: Array
    damping: Array
    gyroscopic: Array
    stiffness: Array
    bearing_nodes: tuple[int, ...]
    dofs_per_node: int = 4
    source: str | None = None

    def __post_init__(self) -> None:
        for name in ("mass", "damping", "gyroscopic", "stiffness"):
            value = np.array(getattr(self, name), dtype=float)
            value.setflags(write=False)
            object.__setattr__(self, name, value)
            self._check_square(name, value)
        self._check_mass()
        self._check_mirror("gyroscopic", self.gyroscopic, -1.0, "skew-symmetric")
        self._check_nodes()

    def _check_square(self, name: str, value: Array) -> None:
        if value.ndim != 2 or value.shape[0] != value.shape[1] or not value.size:
            raise InputError(
                "must be a square matrix", source=self.source, key=self._label(name),
                value=value.shape,
            )  # fmt: skip
        if value.shape != self.mass.shape:
            raise InputError(
                f"must have the mass matrix's size {self.mass.shape}",
                source=self.source, key=self._label(name), value=value.shape,
            )  # fmt: skip
        if not np.all(np.isfinite(value)):
            row, column = np.argwhere(~np.isfinite(value))[0]
            raise InputError(
                "must be finite", source=self.source,
                key=f"{self._label(name)}, row {row}, column {column}",
                value=float(value[row, column]),
            )  # fmt: skip

    def _label(self, name: str) -> str:
        """How a message calls a matrix: by the file's name for it where it is from a file."""
        return name if self.source is None else f"{_IN_FILE[name]} ({name})"

    def _check_mass(self) -> None:
        self._check_mirror("mass", self.mass, 1.0, "symmetric")
        smallest = np.linalg.eigvalsh(self.mass)[0]
        if not smallest > 0.0:
            raise InputError(
                "must be positive definite (smallest eigenvalue given)",
                source=self.source, key=self._label("mass"), value=float(smallest),
            )  # fmt: skip

    def _check_mirror(self, name: str, value: Array, sign: float, word: str) -> None:
        off = np.abs(value - sign * value.T)
        if off.max() > _SYMMETRY * max(np.abs(value).max(), np.finfo(float).tiny):
            row, column = np.unravel_index(int(off.argmax()), off.shape)
            raise InputError(
                f"must be {word}: entry ({column}, {row}) is {value[column, row]:.6g}",
                source=self.source, key=f"{self._label(name)}, row {row}, column {column}",
                value=float(value[row, column]),
            )  # fmt: skip

    def _check_nodes(self) -> None:
        n, per_node = self.mass.shape[0], self.dofs_per_node
        if per_node < 2 or n % per_node:
            raise InputError(
                f"must be 2 or more and divide the matrices' size {n}",
                source=self.source, key="dofs_per_node", value=per_node,
            )  # fmt: skip
        nodes = tuple(int(node) for node in self.bearing_nodes)
        object.__setattr__(self, "bearing_nodes", nodes)
        for position, node in enumerate(nodes):
            if not 0 <= node < n // per_node:
                raise InputError(
                    f"nodes go from 0 to {n // per_node - 1}",
                    source=self.source, key=f"bearing_nodes, column {position}", value=node,
                )  # fmt: skip
        if not nodes or len(set(nodes)) < len(nodes):
            raise InputError(
                "one or more different nodes are needed",
                source=self.source, key="bearing_nodes", value=nodes,
            )  # fmt: skip

    @property
    def whirl_planes(self) -> tuple[tuple[int, int], ...]:
        """The x and y of every node."""
        size, step = self.mass.shape[0], self.dofs_per_node
        return tuple((first, first + 1) for first in range(0, size, step))

    def state_matrix(self, coefficients: Coefficients) -> Array:
        """(2n, 2n) state matrix on (q, q') at the coefficients' speed."""
        stiffness = self.stiffness.copy()
        damping = self.damping + coefficients.speed * self.gyroscopic
        for node in self.bearing_nodes:
            place = slice(node * self.dofs_per_node, node * self.dofs_per_node + 2)
            stiffness[place, place] += coefficients.stiffness
            damping[place, place] += coefficients.damping
        return second_order_state_matrix(self.mass, damping, stiffness)


def load_rotor(
    path: str | Path,
    bearing_nodes: Sequence[int] | None = None,
    dofs_per_node: int | None = None,
) -> GeneralRotor:
    """Read a rotor from .npz or .mat with M, D, G, K, ``bearing_nodes`` and ``dofs_per_node``.

    The damping matrix may be called C as well. D (or C) and G may be left out (zero),
    ``dofs_per_node`` too (4). An array of another name is refused: it might be one that counts.

    Parameters
    ----------
    path : str or Path
    bearing_nodes : sequence of int, optional
        In place of the file's, counted from 0.
    dofs_per_node : int, optional
        In place of the file's.

    Raises
    ------
    InputError
        The file cannot be read, or its matrices do not make a rotor.
    """
    source = Path(path)
    data = dict(_read(source))
    _check_names(data, source, bearing_nodes is not None)
    if bearing_nodes is not None:
        data["bearing_nodes"] = np.asarray(bearing_nodes)
    if dofs_per_node is not None:
        data["dofs_per_node"] = dofs_per_node
    if "C" in data:
        data["D"] = data.pop("C")
    try:
        mass = _matrix(data["M"])
        zero = np.zeros_like(mass)
        damping, gyroscopic, stiffness = (_matrix(data.get(name, zero)) for name in "DGK")
        nodes = np.atleast_1d(np.asarray(data["bearing_nodes"], dtype=float)).ravel()
        per_node = float(np.asarray(data.get("dofs_per_node", 4), dtype=float).ravel()[0])
    except (TypeError, ValueError, IndexError) as error:
        raise InputError(f"arrays must be real numbers ({error})", source=source) from error
    for key, values in (("bearing_nodes", nodes), ("dofs_per_node", np.array([per_node]))):
        for position, value in enumerate(values):
            if value != np.round(value):
                raise InputError(
                    "must be whole numbers", source=source, key=f"{key}, column {position}",
                    value=float(value),
                )  # fmt: skip
    return GeneralRotor(
        mass, damping, gyroscopic, stiffness,
        bearing_nodes=tuple(int(v) for v in nodes), dofs_per_node=int(per_node), source=str(source),
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


def _matrix(value: Any) -> Array:
    # MATLAB's sparse matrices come as such.
    return np.asarray(value.toarray() if hasattr(value, "toarray") else value, dtype=float)


def _read(source: Path) -> Mapping[str, Any]:
    if source.suffix not in (".npz", ".mat"):
        kind = kind_of(source)
        known = f"{sentence(kind)}; a rotor's file " if kind not in _OWN_KINDS else ""
        raise InputError(f"{known}must end in .npz or .mat", source=source)
    try:
        if source.suffix == ".npz":
            # No pickles: a file from elsewhere must not run code.
            with np.load(source, allow_pickle=False) as file:
                return {name: file[name] for name in file.files}
        from scipy.io import loadmat

        with warnings.catch_warnings():
            # Whether sparse matrices come as SciPy's older kind or its newer one: both will do.
            warnings.simplefilter("ignore", DeprecationWarning)
            found = loadmat(source)
        return {name: value for name, value in found.items() if not name.startswith("__")}
    except OSError as error:
        reason = error.strerror or "it is damaged, or no such file"
        raise InputError(f"cannot be read: {reason}", source=source) from error
    except NotImplementedError as error:
        raise InputError(
            "cannot be read: save it in MATLAB with the option -v7", source=source
        ) from error
    except Exception as error:  # the readers raise a dozen kinds on damaged files
        raise InputError(
            f"cannot be read: no {source.suffix} file of plain arrays of numbers", source=source
        ) from error
