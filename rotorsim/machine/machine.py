"""A rotor on its supports: matrices over speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, ComplexArray, Indices
from ..errors import InputError
from ..rotor import Rotor
from ..rotor.rotor import MATRICES
from .banded import BandForm
from .matrices import first_order
from .support import Matrices, Support, common_speeds


@dataclass(frozen=True, eq=False)
class Mount:
    """A support at a node.

    node : Number or name of the node.
    name : Of the support, in results.
    """

    node: int | str
    support: Support
    name: str = ""


@dataclass(frozen=True, eq=False)
class Machine:
    """A rotor on its supports.

    supports : sequence of Mount or (node, Support). Several may stand at one node.
    Raises InputError: A node does not exist, lacks an unknown that its support needs, or the tables
        of the supports have no speed in common.
    """

    rotor: Rotor
    supports: Sequence[Mount | tuple[int | str, Support]] = ()

    def __post_init__(self) -> None:
        if not isinstance(self.rotor, Rotor):
            raise InputError(
                "must be a Rotor: Rotor.rigid(mass), Rotor.jeffcott(...), load_rotor(file)",
                key="rotor", value=type(self.rotor).__name__,
            )  # fmt: skip
        mounts = []
        for number, one in enumerate(self.supports):
            mount = one if isinstance(one, Mount) else Mount(*one)
            name = mount.name or f"support {number + 1}"
            mounts.append(Mount(self.rotor.node(mount.node), mount.support, name))
        object.__setattr__(self, "supports", tuple(mounts))
        _ = self.places, self.speeds

    def __repr__(self) -> str:
        names = ", ".join(mount.name for mount in self.mounts) or "none"
        return f"<Machine: {self.rotor!r}; supports: {names}>"

    @classmethod
    def on_identical(cls, rotor: Rotor, support: Support) -> Machine:
        """Return the rotor with the same support at each of its `bearing_nodes`."""
        if not isinstance(rotor, Rotor):
            return cls(rotor)
        return cls(rotor, [(node, support) for node in rotor.bearing_nodes])

    @property
    def mounts(self) -> tuple[Mount, ...]:
        """The supports, their nodes as numbers."""
        return self.supports  # type: ignore[return-value]

    @cached_property
    def speeds(self) -> Array:
        """Tabulated speeds (n,) [rad/s] of the supports in their common range; may be empty."""
        return common_speeds([mount.support for mount in self.mounts])

    @cached_property
    def places(self) -> tuple[Indices, ...]:
        """Indices of each support's unknowns; its own ones follow the rotor's."""
        places, size = [], self.rotor.size
        for mount in self.mounts:
            support, node = mount.support, self.rotor.nodes[int(mount.node)]
            first = int(self.rotor.first_unknown[int(mount.node)])
            missing = [n for n in support.unknowns[: support.coupled] if n not in node.unknowns]
            if missing:
                raise InputError(
                    f"the node has no {', '.join(missing)}, which {mount.name} needs; it has "
                    f"{', '.join(node.unknowns)}", key="support.at", value=node.name or mount.node,
                )  # fmt: skip
            coupled = [
                first + node.unknowns.index(name) for name in support.unknowns[: support.coupled]
            ]
            own = len(support.unknowns) - support.coupled
            places.append(np.array([*coupled, *range(size, size + own)], dtype=np.intp))
            size += own
        return tuple(places)

    @property
    def unknowns(self) -> tuple[tuple[str, str], ...]:
        """Name of node or support and of unknown: the rotor's, then the supports' own."""
        own = [
            (mount.name, name)
            for mount in self.mounts
            for name in mount.support.unknowns[mount.support.coupled :]
        ]
        return (*self.rotor.unknowns, *own)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        own = (len(mount.support.unknowns) - mount.support.coupled for mount in self.mounts)
        return self.rotor.size + sum(own)

    @property
    def frequency_dependent(self) -> bool:
        """Return whether a support's law is given over frequency."""
        return any(mount.support.frequency_dependent for mount in self.mounts)

    def matrices(self, speed: ArrayLike) -> Matrices:
        """Return mass, damping and stiffness, each speed.shape + (n, n), gyroscopic terms included.

        speed : array. [rad/s]
        Raises OutOfRangeError: A speed lies outside a support's table.
        """
        omega = np.asarray(speed, dtype=float)
        rotor, n = self.rotor, self.rotor.size
        m, d, k = np.zeros((3, *omega.shape, self.size, self.size))
        turning = omega[..., None, None]
        m[..., :n, :n] = rotor.mass
        d[..., :n, :n] = rotor.damping + turning * rotor.gyroscopic
        k[..., :n, :n] = rotor.stiffness + turning * rotor.circulatory
        for mount, place in zip(self.mounts, self.places, strict=True):
            stiffness, damping, mass = mount.support.matrices(omega)
            block = (..., place[:, None], place)
            k[block] += stiffness
            d[block] += damping
            m[block] += mass
        return m, d, k

    @cached_property
    def band_form(self) -> BandForm:
        """Order of the unknowns in which the machine's matrices have a narrow band."""
        n, rotor = self.rotor.size, self.rotor
        pattern = np.zeros((self.size, self.size), dtype=bool)
        for name in MATRICES:
            pattern[:n, :n] |= getattr(rotor, name) != 0.0
        for place in self.places:
            pattern[place[:, None], place] = True
        return BandForm.of(pattern)

    @cached_property
    def _rotor_bands(self) -> dict[str, Array]:
        whole = np.zeros((self.size, self.size))
        bands, n = {}, self.rotor.size
        for name in MATRICES:
            whole[:n, :n] = getattr(self.rotor, name)
            bands[name] = self.band_form.pack(whole)
        return bands

    def banded(self, speed: ArrayLike) -> Matrices:
        """Return `matrices` in band form, each speed.shape + (2 width + 1, n)."""
        omega = np.asarray(speed, dtype=float)
        turning = omega[..., None, None]
        rotor, form = self._rotor_bands, self.band_form
        m = np.broadcast_to(rotor["mass"], (*omega.shape, *rotor["mass"].shape)).copy()
        d = rotor["damping"] + turning * rotor["gyroscopic"]
        k = rotor["stiffness"] + turning * rotor["circulatory"]
        for mount, place in zip(self.mounts, self.places, strict=True):
            stiffness, damping, mass = mount.support.matrices(omega)
            entry = (..., *form.entry(place[:, None], place))
            k[entry] += stiffness
            d[entry] += damping
            m[entry] += mass
        return m, d, k

    def state_matrix(self, speed: ArrayLike) -> Array:
        """Return state matrix on the displacements, then the velocities of the unknowns with mass.

        NaN at a speed without coefficients. Raises as `matrices` and `first_order` do.
        """
        return first_order(*self.matrices(speed))[0]

    def dynamic_stiffness(self, s: complex, speed: float) -> ComplexArray:
        """Return force per displacement (n, n) of a motion exp(s t), frequency laws included."""
        rotor, n = self.rotor, self.rotor.size
        z = np.zeros((self.size, self.size), dtype=complex)
        z[:n, :n] = (
            rotor.stiffness + speed * rotor.circulatory
            + s * (rotor.damping + speed * rotor.gyroscopic) + s * s * rotor.mass
        )  # fmt: skip
        for mount, place in zip(self.mounts, self.places, strict=True):
            z[place[:, None], place] += mount.support.dynamic_stiffness(s, speed)
        return z
