"""One class for every rotor: matrices over nodes, with what acts on it in its own plane."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arguments import above_zero, not_negative
from ..arrays import Array, ComplexArray, Indices
from ..errors import InputError
from ..model.entries import NEEDED, NOT_IN_FILES, Damping, Example, Mass, Stiffness, Unbalance

MATRICES = ("mass", "damping", "gyroscopic", "stiffness", "circulatory")
_SYMMETRY = 1e-8
"""Relative size of an asymmetry that counts as an error of the input."""
_FREE = 1e-6
"""Of the largest stiffness: a larger force after a translation means a support or a mix-up."""


@dataclass(frozen=True)
class Node:
    """A place on the rotor that has unknowns.

    name : Prefix of its signals (``journal_force_x``); empty for the only node of a rigid rotor.
    unknowns : ``x`` and ``y`` first; then ``theta_x`` = -dy/dz, ``theta_y`` = dx/dz, or others.
    position : From the left end of the shaft [m]; NaN where it is not known.
    """

    name: str = ""
    unknowns: tuple[str, ...] = ("x", "y")
    position: float = float("nan")


@dataclass(frozen=True, eq=False)
class Rotor:
    """M q'' + (D + Omega G) q' + (K + Omega H) q = f, without its supports.

    The constructors are `rigid`, `jeffcott` and `from_matrices` here, and
    `rotorsim.rotor.beam_rotor` for a shaft from its drawing.

    mass, damping, gyroscopic, stiffness, circulatory : (n, n) arrays. SI. The unknowns are grouped
        by node. The gyroscopic and the circulatory matrix (internal, rotating damping) are
        multiplied by the shaft speed [rad/s].
    unbalance : (n_nodes,) complex array. Mass times radius at each node, times exp(i phase), the
        phase ahead of the shaft's mark [kg m].
    bearing_nodes : Nodes, from 0, that identical bearings carry where a rotor meets a single
        bearing's table.
    kind : ``rigid``, ``jeffcott``, ``matrices`` or ``beam``.
    parameters : What the constructor was given, for reports (SI).
    source : File of the matrices.
    Raises InputError: A matrix is not real, square, finite or of the right size, the mass matrix is
        not symmetric or negative, the gyroscopic matrix not skew, or a node does not exist; the
        message names row and column.
    """

    mass: Array
    damping: Array
    gyroscopic: Array
    stiffness: Array
    circulatory: Array
    nodes: tuple[Node, ...]
    unbalance: ComplexArray
    bearing_nodes: tuple[int, ...] = (0,)
    kind: str = "matrices"
    parameters: Mapping[str, float] = field(default_factory=dict)
    source: str | None = None

    def __repr__(self) -> str:
        return f"<Rotor: {self.total_mass:.4g} kg, {len(self.nodes)} nodes, {self.size} unknowns>"

    def __post_init__(self) -> None:
        for name in MATRICES:
            value = _real(getattr(self, name), self._label(name), self.source)
            object.__setattr__(self, name, value)
        for name in MATRICES:
            self._check_square(name, getattr(self, name))
        self._check_mirror("mass", self.mass, 1.0, "symmetric")
        self._check_mirror("gyroscopic", self.gyroscopic, -1.0, "skew-symmetric")
        scale = max(float(np.abs(self.mass).max()), np.finfo(float).tiny)
        smallest = float(np.linalg.eigvalsh(self.mass)[0])
        if smallest < -_SYMMETRY * scale:
            raise InputError(
                "must be positive semi-definite (smallest eigenvalue given)",
                source=self.source, key=self._label("mass"), value=smallest,
            )  # fmt: skip
        unbalance = np.array(self.unbalance, dtype=complex)
        object.__setattr__(self, "unbalance", unbalance)
        self._check_nodes()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Rotor):
            return NotImplemented
        arrays = (*MATRICES, "unbalance")
        return (self.nodes, self.bearing_nodes, self.kind) == (
            other.nodes, other.bearing_nodes, other.kind,
        ) and all(np.array_equal(getattr(self, n), getattr(other, n)) for n in arrays)  # fmt: skip

    def _label(self, name: str) -> str:
        """Return how a message calls a matrix: as its file does, where it has one."""
        in_file = {
            "mass": "M", "damping": "D or C", "gyroscopic": "G", "stiffness": "K",
            "circulatory": "H",
        }  # fmt: skip
        return name if self.source is None else f"{in_file[name]} ({name})"

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
        count = sum(len(node.unknowns) for node in self.nodes)
        if count != self.size or any(node.unknowns[:2] != ("x", "y") for node in self.nodes):
            raise InputError(
                f"must have the matrices' {self.size} unknowns, x and y first at each node",
                source=self.source, key="nodes", value=count,
            )  # fmt: skip
        if self.unbalance.shape != (len(self.nodes),) or not np.all(np.isfinite(self.unbalance)):
            raise InputError(
                "needs one finite value for each node", source=self.source, key="unbalance",
                value=self.unbalance.shape,
            )  # fmt: skip
        for position, node in enumerate(self.bearing_nodes):
            if not 0 <= node < len(self.nodes):
                raise InputError(
                    f"nodes go from 0 to {len(self.nodes) - 1}",
                    source=self.source, key=f"bearing_nodes, column {position}", value=node,
                )  # fmt: skip
        if not self.bearing_nodes or len(set(self.bearing_nodes)) < len(self.bearing_nodes):
            raise InputError(
                "one or more different nodes are needed",
                source=self.source, key="bearing_nodes", value=self.bearing_nodes,
            )  # fmt: skip

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.mass.shape[0]

    @cached_property
    def first_unknown(self) -> Indices:
        """Index of each node's x, (n_nodes,); its y follows."""
        counts = [len(node.unknowns) for node in self.nodes]
        return np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.intp)

    @property
    def planes(self) -> tuple[tuple[int, int], ...]:
        """Indices of x and y of every node."""
        return tuple((int(i), int(i) + 1) for i in self.first_unknown)

    @property
    def unknowns(self) -> tuple[tuple[str, str], ...]:
        """Node's name and unknown's name, in the order of the matrices."""
        return tuple((node.name, unknown) for node in self.nodes for unknown in node.unknowns)

    def translation(self, along: Sequence[float]) -> Array:
        """Return displacements (n,) of a translation of the whole rotor by `along` (x, y) [m]."""
        result = np.zeros(self.size)
        result[self.first_unknown], result[self.first_unknown + 1] = along
        return result

    @property
    def total_mass(self) -> float:
        """Mass that a translation along x moves [kg]."""
        x = self.translation((1.0, 0.0))
        return float(x @ self.mass @ x)

    @property
    def rigid_mass(self) -> float | None:
        """Mass per bearing [kg] of a rigid rotor; None for others: no critical mass is theirs."""
        return self.parameters["mass"] if self.kind == "rigid" else None

    def node(self, place: int | str) -> int:
        """Return the number of a node given by its number or its name.

        Raises InputError: There is no such node; the message lists the names.
        """
        names = [node.name for node in self.nodes]
        if isinstance(place, str) and place in names:
            return names.index(place)
        if isinstance(place, (int, np.integer)) and 0 <= place < len(names):
            return int(place)
        known = ", ".join(name for name in names if name)
        known = f"; names are {known}" if known else ""
        raise InputError(f"nodes go from 0 to {len(names) - 1}{known}", key="node", value=place)

    def unbalance_force(self, speed: ArrayLike) -> ComplexArray:
        """Return complex amplitudes (..., n) [N] of the unbalance forces, f = Re(F exp(i Omega t)).

        speed : [rad/s]

        u Omega^2 (1, -i) at each node: the force turns from x to y.
        """
        force = np.zeros(self.size, dtype=complex)
        force[self.first_unknown] = self.unbalance
        force[self.first_unknown + 1] = -1j * self.unbalance
        return np.asarray(np.square(np.asarray(speed, dtype=float))[..., None] * force)

    def doubts(self) -> list[str]:
        """Return what makes given matrices look misordered, a sentence each.

        Without supports a rotor moves freely along x and along y: K times a translation vanishes.
        """
        found = []
        largest = float(np.abs(self.stiffness).max())
        for axis, along in (("x", (1.0, 0.0)), ("y", (0.0, 1.0))):
            force = np.abs(self.stiffness @ self.translation(along))
            if force.max() > _FREE * largest:
                row = int(force.argmax())
                found.append(
                    f"check the order of the unknowns: without bearings a rotor moves freely along "
                    f"{axis}, but K times (1 at every node's {axis}) is {force[row]:.3g} in row "
                    f"{row}, not 0; unknowns are grouped by node (x, y, then its others), and K is "
                    "without bearings (springs to ground have the same effect)"
                )
        return found

    @classmethod
    def rigid(
        cls, mass: Mass, unbalance: Unbalance = 0.0, phase: Annotated[float, NOT_IN_FILES] = 0.0
    ) -> Rotor:
        """Return the rigid symmetric shaft on two identical bearings, per bearing (Dal Eq. 21).

        mass : Per bearing [kg].
        unbalance : Mass times radius, per bearing [kg m].
        phase : Of the unbalance ahead of the shaft's mark [rad].
        """
        above_zero("rotor", mass=mass)
        zero = np.zeros((2, 2))
        return cls(
            mass * np.eye(2), zero, zero, zero, zero, (Node(),),
            unbalance=np.array([unbalance * np.exp(1j * phase)]),
            kind="rigid", parameters={"mass": mass, "unbalance": unbalance},
        )  # fmt: skip

    @classmethod
    def jeffcott(
        cls,
        disc_mass: Annotated[Mass, Example("600 kg")],
        shaft_stiffness: Annotated[Stiffness, Example("100 MN/m")],
        journal_mass: Annotated[Mass, Example("60 kg"), NEEDED] = 0.0,
        disc_damping: Damping = 0.0,
        unbalance: Unbalance = 0.0,
    ) -> Rotor:
        """Return disc at mid-span of a flexible shaft on two identical bearings, one half of it.

        The nodes are ``journal`` and ``disc``.

        disc_mass, shaft_stiffness : Per bearing: half the disc [kg] and half the shaft's stiffness
            at mid-span [N/m].
        journal_mass : What moves with one journal [kg]; may be zero.
        disc_damping : External, on the disc, per bearing [N s/m].
        unbalance : Of the disc, per bearing [kg m].
        """
        above_zero("rotor", disc_mass=disc_mass, shaft_stiffness=shaft_stiffness)
        not_negative(
            "rotor", journal_mass=journal_mass, disc_damping=disc_damping, unbalance=unbalance
        )
        eye, zero = np.eye(2), np.zeros((4, 4))
        return cls(
            _kron(np.diag([journal_mass, disc_mass]), eye),
            _kron(np.diag([0.0, disc_damping]), eye),
            zero,
            _kron(shaft_stiffness * np.array([[1.0, -1.0], [-1.0, 1.0]]), eye),
            zero,
            (Node("journal"), Node("disc")),
            unbalance=np.array([0.0, unbalance], dtype=complex),
            kind="jeffcott",
            parameters={
                "disc_mass": disc_mass, "journal_mass": journal_mass,
                "shaft_stiffness": shaft_stiffness, "disc_damping": disc_damping,
                "unbalance": unbalance,
            },
        )  # fmt: skip

    @classmethod
    def from_matrices(
        cls,
        mass: ArrayLike,
        stiffness: ArrayLike,
        damping: ArrayLike | None = None,
        gyroscopic: ArrayLike | None = None,
        circulatory: ArrayLike | None = None,
        *,
        bearing_nodes: Sequence[int] = (0,),
        unknowns_per_node: int = 4,
        source: str | None = None,
    ) -> Rotor:
        """Return the rotor of matrices made elsewhere, its unknowns grouped by node.

        mass, stiffness, damping, gyroscopic, circulatory : (n, n) arrays. See `Rotor`; what is left
            out is zero. The mass matrix must be positive definite.
        bearing_nodes : Nodes that a bearing carries, from 0.
        unknowns_per_node : 2 or more: x, y, then the node's others; 4 for beam elements.
        source : File of the matrices.
        """
        m = np.asarray(mass)
        zero = np.zeros(m.shape)
        parts = [zero if part is None else part for part in (damping, gyroscopic, circulatory)]
        count = m.shape[0] if m.ndim else 0
        if unknowns_per_node < 2 or count % unknowns_per_node:
            raise InputError(
                f"must be 2 or more and divide the matrices' size {count}",
                source=source, key="dofs_per_node", value=unknowns_per_node,
            )  # fmt: skip
        names = ("x", "y", *(f"q{i}" for i in range(2, unknowns_per_node)))
        nodes = tuple(Node(f"node{i}", names) for i in range(count // unknowns_per_node))
        rotor = cls(
            np.asarray(mass), np.asarray(parts[0]), np.asarray(parts[1]), np.asarray(stiffness),
            np.asarray(parts[2]), nodes, unbalance=np.zeros(len(nodes), dtype=complex),
            bearing_nodes=tuple(int(node) for node in bearing_nodes), source=source,
        )  # fmt: skip
        smallest = float(np.linalg.eigvalsh(rotor.mass)[0])
        if not smallest > 0.0:
            raise InputError(
                "must be positive definite (smallest eigenvalue given)",
                source=source, key=rotor._label("mass"), value=smallest,
            )  # fmt: skip
        return rotor


def _kron(first: Array, second: Array) -> Array:
    return np.asarray(np.kron(first, second), dtype=float)


def _real(value: ArrayLike, label: str, source: str | None) -> Array:
    """Return the real, read-only copy of a matrix; an imaginary part that is exactly zero goes."""
    array: NDArray[Any] = np.asarray(value)
    if np.iscomplexobj(array):
        imaginary = np.imag(array)
        if np.any(imaginary != 0.0):
            row, column = np.argwhere(imaginary != 0.0)[0]
            raise InputError(
                "must be real numbers: put viscous damping into D (a loss factor eta of a mode of "
                "frequency w is the damping eta K/w)",
                source=source, key=f"{label}, row {row}, column {column}",
                value=complex(array[row, column]),
            )  # fmt: skip
        array = np.real(array)
    result = np.array(array, dtype=float)
    result.setflags(write=False)
    return result
