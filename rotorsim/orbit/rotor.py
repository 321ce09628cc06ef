"""Rotors as the orbit sees them: a linear structure whose first station is the journal."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RotorModel:
    """M u'' + (D + w G) u' + S u = film force on station 0 + loads.

    Parameters
    ----------
    mass, damping, stiffness, gyroscopic : (2n, 2n) arrays
        Of n stations, degrees of freedom x0, y0, x1, y1, ... [kg, N s/m, N/m, kg]; station 0 is
        the journal.
    unbalance : (n,) array
        Mass times radius at each station [kg m].
    unbalance_phase : (n,) array
        Its angle ahead of the shaft's reference mark [rad].
    """

    mass: Array
    damping: Array
    stiffness: Array
    gyroscopic: Array
    unbalance: Array
    unbalance_phase: Array

    def __post_init__(self) -> None:
        size = self.mass.shape[0]
        for name in ("mass", "damping", "stiffness", "gyroscopic"):
            matrix = getattr(self, name)
            if matrix.shape != (size, size) or size % 2 or not np.all(np.isfinite(matrix)):
                raise InputError(
                    "must be a finite square matrix, two rows for each station",
                    key=f"rotor.{name}",
                    value=matrix.shape,
                )
        if self.unbalance.shape != (size // 2,) or self.unbalance_phase.shape != (size // 2,):
            raise InputError(
                "needs one value for each station", key="rotor.unbalance", value=self.unbalance
            )
        if np.linalg.eigvalsh(0.5 * (self.mass + self.mass.T))[0] <= 0.0:
            raise InputError("must be positive definite", key="rotor.mass", value=self.mass)

    @property
    def stations(self) -> int:
        """Number of stations."""
        return self.mass.shape[0] // 2


def rigid_rotor(mass: float, unbalance: float = 0.0, phase: float = 0.0) -> RotorModel:
    """Rigid symmetric shaft on two like bearings (Dal Eq. 21).

    Parameters
    ----------
    mass : float
        Per bearing [kg].
    unbalance : float
        Mass times radius, per bearing [kg m].
    phase : float
        Of the unbalance ahead of the shaft's mark [rad].
    """
    if not (np.isfinite(mass) and mass > 0.0):
        raise InputError("must be above 0", key="rotor.mass", value=mass)
    zero = np.zeros((2, 2))
    return RotorModel(
        mass * np.eye(2), zero, zero, zero, np.array([unbalance]), np.array([phase], dtype=float)
    )


def jeffcott_rotor(
    disk_mass: float,
    journal_mass: float,
    stiffness: float,
    damping: float = 0.0,
    unbalance: float = 0.0,
) -> RotorModel:
    """Jeffcott rotor on two like bearings, one half of it: journal, flexible shaft, disc.

    Parameters
    ----------
    disk_mass, journal_mass : float
        Per bearing [kg].
    stiffness : float
        Of the shaft, per bearing [N/m]: the rigidly supported natural frequency is
        sqrt(stiffness/disk_mass).
    damping : float
        External, on the disc, per bearing [N s/m].
    unbalance : float
        Of the disc, per bearing [kg m].
    """
    for name, value in (
        ("disk_mass", disk_mass),
        ("journal_mass", journal_mass),
        ("stiffness", stiffness),
    ):
        if not (np.isfinite(value) and value > 0.0):
            raise InputError("must be above 0", key=f"rotor.{name}", value=value)
    link = np.kron(np.array([[1.0, -1.0], [-1.0, 1.0]]), np.eye(2))
    spring = np.asarray(stiffness * link, dtype=float)
    return RotorModel(
        np.diag([journal_mass, journal_mass, disk_mass, disk_mass]),
        np.diag([0.0, 0.0, damping, damping]),
        spring,
        np.zeros((4, 4)),
        np.array([0.0, unbalance]),
        np.zeros(2),
    )
