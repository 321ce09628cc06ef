"""Supports of a node of a rotor: films, tables, springs, pedestals, seals."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array, ComplexArray
from ..bearing.operating_point import kept_throughout
from ..bearing.table_format import PAD_MATRICES
from ..errors import InputError, OutOfRangeError

if TYPE_CHECKING:
    from ..bearing.interpolation import CoefficientInterpolator
    from ..bearing.operating_point import OperatingPoint
    from ..bearing.table import CoefficientTable

Matrices = tuple[Array, Array, Array]
_JOURNAL = ("x", "y", "theta_x", "theta_y")
"""Unknowns of a bearing that are its node's."""
_SPEED_TOLERANCE = 1e-9
"""Relative; two speeds nearer than this are the same one written in different units."""


class Support(ABC):
    """Linearised support of one node: K, C and M over its unknowns at any shaft speed.

    A further kind needs `matrices` only, and `speeds` where it knows a range of speeds.
    """

    unknowns: tuple[str, ...] = ("x", "y")
    """Names of the unknowns; the first `coupled` are the node's, the others the support's own."""
    coupled: int = 2
    carries_load: bool = True
    """It takes part in the static load; a seal does not."""
    frequency_dependent: bool = False
    """`dynamic_stiffness` is more than K + s C + s^2 M."""

    @property
    def speeds(self) -> Array:
        """Tabulated speeds (n,) [rad/s], between the first and last of which it is known.

        Empty: known at every speed.
        """
        return np.zeros(0)

    @abstractmethod
    def matrices(self, speed: ArrayLike) -> Matrices:
        """Return the stiffness, damping and mass, each speed.shape + (m, m) or (m, m) (SI).

        NaN marks a speed without coefficients, next to a point that did not converge.

        Raises OutOfRangeError: A speed [rad/s] lies outside `speeds`.
        """

    def dynamic_stiffness(self, s: complex, speed: float) -> ComplexArray:
        """Return force per displacement (m, m) [N/m] of a motion exp(s t) at a speed [rad/s]."""
        k, c, m = self.matrices(speed)
        return np.asarray(k + s * c + s * s * m, dtype=complex)

    def force(self, q: ArrayLike, v: ArrayLike, speed: float) -> Array:
        """Return force (m,) [N] at displacements and velocities (m,) from equilibrium."""
        k, c, _ = self.matrices(speed)
        return -(k @ np.asarray(q, dtype=float) + c @ np.asarray(v, dtype=float))


@dataclass(frozen=True, eq=False)
class ConstantSupport(Support):
    """Stiffness, damping and mass that do not change with speed.

    stiffness, damping, mass : array-like. (m, m) matrices, m values of the diagonal, or one value
        for x and y (SI).
    coupled : How many of them are the node's; None: all.
    """

    stiffness: ArrayLike
    damping: ArrayLike = 0.0
    mass: ArrayLike = 0.0
    unknowns: tuple[str, ...] = ("x", "y")
    coupled: int = -1
    carries_load: bool = True

    def __post_init__(self) -> None:
        for name in ("stiffness", "damping", "mass"):
            matrix = _square(getattr(self, name), len(self.unknowns), name)
            object.__setattr__(self, name, matrix)
        if self.coupled < 0:
            object.__setattr__(self, "coupled", len(self.unknowns))

    def matrices(self, speed: ArrayLike) -> Matrices:
        """Return K, C and M as given."""
        del speed
        return self.stiffness, self.damping, self.mass  # type: ignore[return-value]


def cross_stiffness(value: float) -> ConstantSupport:
    """Return the destabilising stiffness k_xy = -k_yx = `value` [N/m] of a seal or impeller.

    It drives forward whirl where it is above zero, and carries no load.
    """
    return ConstantSupport([[0.0, value], [-value, 0.0]], carries_load=False)


@dataclass(frozen=True, eq=False)
class TableSupport(Support):
    """One curve of a coefficient table: 2 x 2 stiffness and damping over speed.

    curve : From `CoefficientTable.interpolator`.
    mass : array-like. Added mass [kg], as for `ConstantSupport`.
    """

    curve: CoefficientInterpolator
    mass: ArrayLike = 0.0
    carries_load: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "mass", _square(self.mass, 2, "mass"))

    @property
    def speeds(self) -> Array:
        """Tabulated speeds [rad/s]."""
        return self.curve.speeds

    def matrices(self, speed: ArrayLike) -> Matrices:
        """Interpolate (monotone cubic); see `Support.matrices`."""
        stiffness, damping = self.curve(speed, gaps="nan")
        return stiffness, damping, self.mass  # type: ignore[return-value]


@dataclass(frozen=True, eq=False)
class MatrixTable(Support):
    """Matrices of any size over speed: a film with its pads, journal rotations, a seal.

    table_speeds : (n,) array. Ascending [rad/s].
    stiffness, damping, mass : (n, m, m) arrays. SI; `mass` may be left out.
    coupled : How many of the unknowns, the first ones, are the node's.
    """

    table_speeds: Array
    stiffness: Array
    damping: Array
    mass: Array | None = None
    unknowns: tuple[str, ...] = ("x", "y")
    coupled: int = 2
    carries_load: bool = True

    def __post_init__(self) -> None:
        speeds = np.atleast_1d(np.asarray(self.table_speeds, dtype=float))
        if speeds.ndim != 1 or not np.all(np.isfinite(speeds)) or np.any(np.diff(speeds) <= 0.0):
            raise InputError("must be finite and ascend", key="speeds", value=self.table_speeds)
        object.__setattr__(self, "table_speeds", speeds)
        shape = (speeds.size, len(self.unknowns), len(self.unknowns))
        for name in ("stiffness", "damping", "mass"):
            given = getattr(self, name)
            value = np.zeros(shape) if given is None else np.asarray(given, dtype=float)
            if value.shape != shape or not np.all(np.isfinite(value)):
                raise InputError(f"must be finite, of shape {shape}", key=name, value=value.shape)
            object.__setattr__(self, name, value)

    @classmethod
    def of_pads(cls, table: CoefficientTable, **choices: Any) -> MatrixTable:
        """Return the journal and the pads of a tilting-pad bearing's table.

        A pad that carries load at some of the speeds only is eliminated where it does, at the
        shaft's frequency; the others keep their unknowns.

        **choices : What `CoefficientTable.select` needs to leave one curve over speed.
        Raises InputError: The table has no pads, more than one curve, or a point that did not
            converge.
        """
        one = table.select(**choices).dataset
        if "full_stiffness" not in one:
            raise InputError("has no matrices over journal and pads", key="table")
        if one["kxx"].size != one["speed"].size:
            raise InputError("must be narrowed to one curve over speed", key="table")
        names = [str(name) for name in one["unknown"].values]
        shape = (one["speed"].size, len(names), len(names))
        matrices = [one[name].values.reshape(shape) for name in PAD_MATRICES]
        return cls._over(one["speed"].values, names, np.stack(matrices))

    @classmethod
    def of_points(cls, points: Sequence[OperatingPoint], angles: Sequence[float]) -> MatrixTable:
        """Return the same of operating points over speed, each turned by its angle [rad].

        The angle leads from the machine's x to the point's load.
        """
        fulls = [point.coefficients_full for point in points]
        names = list(dict.fromkeys(name for full in fulls if full for name in full.names))
        matrices = np.full((3, len(points), len(names), len(names)), np.nan)
        for place, (full, angle) in enumerate(zip(fulls, angles, strict=True)):
            if full is None:
                continue
            at = np.array([names.index(name) for name in full.names])
            turn = _turning(full.names, angle)
            for kind, matrix in enumerate((full.stiffness, full.damping, full.mass)):
                matrices[kind, place, at[:, None], at] = turn.T @ matrix @ turn
        return cls._over(np.array([point.speed for point in points]), names, matrices)

    @classmethod
    def _over(cls, speeds: Array, names: list[str], matrices: Array) -> MatrixTable:
        """Keep the unknowns that are there at all speeds; eliminate the others, synchronously."""
        if not np.isfinite(np.diagonal(matrices[0], axis1=1, axis2=2))[:, :2].all():
            raise InputError("holds points that did not converge", key="table")
        own, kept = kept_throughout(speeds, matrices)
        unknowns = tuple(names[place] for place in own)
        coupled = sum(name in _JOURNAL for name in unknowns)
        return cls(speeds, *kept, unknowns=unknowns, coupled=coupled)

    @property
    def speeds(self) -> Array:
        """Tabulated speeds [rad/s]."""
        return self.table_speeds

    @cached_property
    def _curve(self):
        from scipy.interpolate import PchipInterpolator

        parts = [np.asarray(part) for part in (self.stiffness, self.damping, self.mass)]
        stacked = np.stack(parts, axis=1)
        if self.table_speeds.size == 1:
            return lambda speed: np.broadcast_to(stacked[0], (*np.shape(speed), *stacked.shape[1:]))
        return PchipInterpolator(self.table_speeds, stacked, axis=0)

    def matrices(self, speed: ArrayLike) -> Matrices:
        """Interpolate each entry (monotone cubic)."""
        omega = np.asarray(speed, dtype=float)
        low, high = float(self.table_speeds[0]), float(self.table_speeds[-1])
        outside = (omega < low * (1.0 - _SPEED_TOLERANCE)) | (omega > high * (1 + _SPEED_TOLERANCE))
        if np.any(outside):
            raise OutOfRangeError(
                f"the table holds speeds from {low:.6g} to {high:.6g} rad/s", key="speed",
                value=float(omega[outside].flat[0]) if omega.ndim else float(omega),
            )  # fmt: skip
        values = np.asarray(self._curve(np.clip(omega, low, high)))
        return values[..., 0, :, :], values[..., 1, :, :], values[..., 2, :, :]


def table_support(table: CoefficientTable, **choices: Any) -> Support:
    """Return one curve of a table: with its pads, where it has some and all points converged.

    **choices : What `CoefficientTable.select` needs to leave one curve over speed.
    """
    one = table.select(**choices)
    if "full_stiffness" in one.dataset and one.converged.all():
        return MatrixTable.of_pads(one)
    return TableSupport(one.interpolator())


class _Around(Support):
    """A support around another one, `inner`."""

    inner: Support

    def __post_init__(self) -> None:
        for name in ("unknowns", "coupled", "carries_load", "frequency_dependent"):
            object.__setattr__(self, name, getattr(self.inner, name))

    @property
    def speeds(self) -> Array:
        """Tabulated speeds of the inner support [rad/s]."""
        return self.inner.speeds


@dataclass(frozen=True, eq=False)
class Pedestal(_Around):
    """A support whose housing stands on springs: a pedestal in series.

    inner : Between the node and the housing; its own unknowns are measured from the housing.
    mass, stiffness, damping : array-like. Of the housing on its pedestal, along x and y, as for
        `ConstantSupport`.

    With T q the displacements relative to the housing, the inner matrices become T' K T, and the
    pedestal's are added on the housing's own x and y. A pad's inertia counts relative to the
    housing.
    """

    inner: Support
    mass: ArrayLike
    stiffness: ArrayLike
    damping: ArrayLike = 0.0

    def __post_init__(self) -> None:
        for name in ("mass", "stiffness", "damping"):
            object.__setattr__(self, name, _square(getattr(self, name), 2, name))
        super().__post_init__()
        unknowns = (*self.inner.unknowns, "housing_x", "housing_y")
        object.__setattr__(self, "unknowns", unknowns)

    @property
    def _relative(self) -> Array:
        """From the unknowns to those relative to the housing."""
        size = len(self.inner.unknowns)
        relative = np.eye(size, size + 2)
        for axis, column in (("x", size), ("y", size + 1)):
            relative[self.inner.unknowns.index(axis), column] = -1.0
        return relative

    def _in_series(self, inner: NDArray, own: NDArray) -> NDArray:
        relative = self._relative
        result = relative.T @ inner @ relative
        result[..., -2:, -2:] += own
        return result

    def matrices(self, speed: ArrayLike) -> Matrices:
        """Return the matrices of the node's, the inner support's and the housing's unknowns."""
        own = (self.stiffness, self.damping, self.mass)
        stiffness, damping, mass = (
            self._in_series(inner, np.asarray(part))
            for inner, part in zip(self.inner.matrices(speed), own, strict=True)
        )
        return stiffness, damping, mass

    def dynamic_stiffness(self, s: complex, speed: float) -> ComplexArray:
        """Return the force per displacement, the inner support's own law included."""
        own = np.asarray(self.stiffness) + s * np.asarray(self.damping)
        own = own + s * s * np.asarray(self.mass)
        return self._in_series(self.inner.dynamic_stiffness(s, speed), own)


@dataclass(frozen=True, eq=False)
class Turned(_Around):
    """A support given in a frame that is turned by `angle` [rad] from x towards y."""

    inner: Support
    angle: float

    @property
    def _turn(self) -> Array:
        """From the machine's unknowns to the inner support's."""
        return _turning(self.unknowns, self.angle)

    def matrices(self, speed: ArrayLike) -> Matrices:
        """Return the matrices in the machine's frame."""
        turn = self._turn
        k, c, m = (turn.T @ part @ turn for part in self.inner.matrices(speed))
        return k, c, m

    def dynamic_stiffness(self, s: complex, speed: float) -> ComplexArray:
        """Return the force per displacement in the machine's frame."""
        return self._turn.T @ self.inner.dynamic_stiffness(s, speed) @ self._turn


def _turning(unknowns: Sequence[str], angle: float) -> Array:
    """Return the matrix from unknowns to those of a frame turned by `angle` [rad] (x to y)."""
    turn = np.eye(len(unknowns))
    c, s = np.cos(angle), np.sin(angle)
    for first, second in (("x", "y"), ("theta_x", "theta_y"), ("housing_x", "housing_y")):
        if first in unknowns:
            i, j = unknowns.index(first), unknowns.index(second)
            turn[i, i] = turn[j, j] = c
            turn[i, j], turn[j, i] = s, -s
    return turn


def _square(value: ArrayLike, size: int, name: str) -> Array:
    """Return (size, size) matrix from one number, a diagonal or a matrix."""
    array = np.asarray(value, dtype=float)
    if array.ndim == 0:
        array = np.full(size, float(array))
    if array.ndim == 1:
        array = np.diag(array)
    if array.shape != (size, size) or not np.all(np.isfinite(array)):
        raise InputError(
            f"must be a finite {size} x {size} matrix, or {size} values, or one", key=name,
            value=np.shape(value),
        )  # fmt: skip
    return array


def common_speeds(supports: Sequence[Support]) -> Array:
    """Return tabulated speeds (n,) [rad/s] of all supports, within the range that all of them know.

    Raises InputError: Their tables have no speed in common.
    """
    tables = [support.speeds for support in supports if support.speeds.size]
    if not tables:
        return np.zeros(0)
    low, high = max(float(t[0]) for t in tables), min(float(t[-1]) for t in tables)
    if low > high * (1.0 + _SPEED_TOLERANCE):
        raise InputError(
            f"the supports' tables have no speed in common: one begins at {low:.6g}, one ends at "
            f"{high:.6g} rad/s", key="speed",
        )  # fmt: skip
    every = np.unique(np.concatenate(tables))
    every = every[(every >= low) & (every <= high)]
    if len(tables) == 1:
        return every
    apart = np.diff(every, prepend=-np.inf) > _SPEED_TOLERANCE * np.abs(every)
    return every[apart]
