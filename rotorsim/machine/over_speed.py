"""Any rotor on the table's film over speed: Campbell branches and threshold speeds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bearing.interpolation import Coefficients
from ..bearing.table import CoefficientTable
from ..errors import InputError
from .jeffcott import jeffcott_matrices
from .matrices import state_matrix
from .modes import Branches, ThresholdSpeed, find_thresholds, track_modes

Array = NDArray[np.float64]


class RotorOnFilm(Protocol):
    """What a rotor must be able to say; `GeneralRotor` is one."""

    @property
    def whirl_planes(self) -> tuple[tuple[int, int], ...]:
        """Pairs of degrees of freedom x, y of one node each."""
        ...

    def state_matrix(self, coefficients: Coefficients) -> Array:
        """State matrix on displacements, then velocities, at the coefficients' speed."""
        ...


@dataclass(frozen=True)
class RigidShaft:
    """Rigid symmetric shaft on two like bearings (Dal Eq. 21); mass per bearing [kg]."""

    mass: float

    def __post_init__(self) -> None:
        _above_zero("mass", self.mass)

    @property
    def whirl_planes(self) -> tuple[tuple[int, int], ...]:
        """The journal's x, y."""
        return ((0, 1),)

    def state_matrix(self, coefficients: Coefficients) -> Array:
        """(4, 4) on x, y, vx, vy."""
        return state_matrix(coefficients.stiffness, coefficients.damping, self.mass)


@dataclass(frozen=True)
class JeffcottShaft:
    """Disc at mid-span of a flexible shaft on two like bearings, one half of it.

    Parameters
    ----------
    disc_mass, shaft_stiffness : float
        Per bearing [kg], [N/m].
    journal_mass, shaft_damping : float
        Per bearing [kg]; external damping at the disc [N s/m]. Both may be zero.
    """

    disc_mass: float
    shaft_stiffness: float
    journal_mass: float = 0.0
    shaft_damping: float = 0.0

    def __post_init__(self) -> None:
        _above_zero("disc_mass", self.disc_mass)
        _above_zero("shaft_stiffness", self.shaft_stiffness)
        for key in ("journal_mass", "shaft_damping"):
            if not (np.isfinite(getattr(self, key)) and getattr(self, key) >= 0.0):
                raise InputError("must be 0 or more", key=key, value=getattr(self, key))

    @property
    def whirl_planes(self) -> tuple[tuple[int, int], ...]:
        """The disc's x, y."""
        return ((0, 1),)

    def state_matrix(self, coefficients: Coefficients) -> Array:
        """(8, 8), or (6, 6) with massless journals; disc x, y first."""
        return jeffcott_matrices(
            coefficients.stiffness, coefficients.damping, self.disc_mass, self.shaft_stiffness,
            self.journal_mass, self.shaft_damping,
        )[0]  # fmt: skip


def _above_zero(key: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0.0):
        raise InputError("must be above 0", key=key, value=value)


def _check_order(table: object, rotor: object) -> None:
    """Refuse the two in each other's place, or a mass in place of a rotor."""
    if not isinstance(table, CoefficientTable):
        raise InputError(
            "must be a CoefficientTable, and the rotor comes after it", key="table",
            value=type(table).__name__,
        )  # fmt: skip
    if not hasattr(rotor, "state_matrix"):
        raise InputError(
            "must be a rotor: RigidShaft(mass), JeffcottShaft or GeneralRotor", key="rotor",
            value=type(rotor).__name__,
        )  # fmt: skip


def _matrix_of(
    table: CoefficientTable, rotor: RotorOnFilm, choices: dict[str, object]
) -> Callable[[float], Array]:
    """Speed [rad/s] to state matrix; NaN next to points that did not converge."""
    curve = table.interpolator(**choices)
    knots = table.speeds[curve.converged]
    if not knots.size:
        raise InputError("no point of the table converged", key="table")
    size = rotor.state_matrix(Coefficients(*curve(knots[0]), float(knots[0]))).shape[0]

    def matrix(omega: float) -> Array:
        stiffness, damping = curve(omega, gaps="nan")
        if not (np.all(np.isfinite(stiffness)) and np.all(np.isfinite(damping))):
            return np.full((size, size), np.nan)
        return rotor.state_matrix(Coefficients(stiffness, damping, omega))

    return matrix


def converged_speeds(table: CoefficientTable, **choices: object) -> Array:
    """Longest run of tabulated speeds [rad/s] without a point that did not converge."""
    curve = table.interpolator(**choices)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], curve.converged.astype(int), [0]])))
    runs = edges.reshape(-1, 2)
    if not runs.size:
        return np.zeros(0)
    start, stop = runs[np.argmax(runs[:, 1] - runs[:, 0])]
    return curve.speeds[start:stop]


def rotor_modes(
    table: CoefficientTable,
    rotor: RotorOnFilm,
    speed: ArrayLike | None = None,
    **choices: object,
) -> Branches:
    """Eigenvalue branches of a rotor over speed, coefficients interpolated in the table.

    Parameters
    ----------
    table : CoefficientTable
    rotor : RotorOnFilm
        `RigidShaft`, `JeffcottShaft` or `GeneralRotor`.
    speed : (n,) array, optional
        [rad/s]; by default the longest run of converged tabulated speeds.
    **choices
        As for `CoefficientTable.select`.
    """
    _check_order(table, rotor)
    wanted = converged_speeds(table, **choices) if speed is None else speed
    return track_modes(_matrix_of(table, rotor, choices), wanted)


def rotor_thresholds(
    table: CoefficientTable, rotor: RotorOnFilm, subdivisions: int = 8, **choices: object
) -> list[ThresholdSpeed]:
    """Threshold speeds of a rotor on the interpolated table, each with its whirl ratio.

    Parameters
    ----------
    table : CoefficientTable
    rotor : RotorOnFilm
    subdivisions : int
        Points looked at in every interval of the table.
    **choices
        As for `CoefficientTable.select`.

    Raises
    ------
    InputError
        Table and rotor stand in each other's place.
    """
    _check_order(table, rotor)
    knots = table.speeds
    parts = np.arange(subdivisions) / subdivisions
    grid = np.append((knots[:-1, None] + np.diff(knots)[:, None] * parts).ravel(), knots[-1])
    return find_thresholds(_matrix_of(table, rotor, choices), grid)
