"""The eight coefficients of one bearing at one speed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError


@dataclass(frozen=True, eq=False)
class Coefficients:
    """Linearised film (SI, load frame).

    Attributes
    ----------
    stiffness : (2, 2) array
        K_ij = -dF_i/dx_j [N/m].
    damping : (2, 2) array
        C_ij = -dF_i/dv_j [N s/m].
    speed : float
        Of the shaft [rad/s].
    load : float or None
        Static load [N].
    radial_clearance : float or None
        [m]
    thermal_model : str or None

    Raises
    ------
    InputError
        A matrix is not 2 x 2 or not finite, or the speed is below zero.
    """

    stiffness: NDArray[np.float64]
    damping: NDArray[np.float64]
    speed: float
    load: float | None = None
    radial_clearance: float | None = None
    thermal_model: str | None = None

    def __post_init__(self) -> None:
        for name in ("stiffness", "damping"):
            value = np.array(getattr(self, name), dtype=float)
            if value.shape != (2, 2) or not np.all(np.isfinite(value)):
                raise InputError("must be a 2 x 2 matrix of finite numbers", key=name, value=value)
            value.setflags(write=False)
            object.__setattr__(self, name, value)
        if not (np.isfinite(self.speed) and self.speed >= 0.0):
            raise InputError("must be 0 or more (rad/s)", key="speed", value=self.speed)

    def dimensionless(self) -> Coefficients:
        """K c/W and C c omega/W, with unit load, clearance and speed.

        Raises
        ------
        InputError
            The load or the clearance is not known.

        Examples
        --------
        >>> film = Coefficients(2e8 * np.eye(2), 1e5 * np.eye(2), 1000.0, 1e4, 1e-4)
        >>> float(film.dimensionless().stiffness[0, 0]), float(film.dimensionless().damping[0, 0])
        (2.0, 1.0)
        """
        if self.load is None or self.radial_clearance is None:
            raise InputError("dimensionless coefficients need a load and a clearance", key="load")
        scale = self.radial_clearance / self.load
        return replace(
            self,
            stiffness=self.stiffness * scale,
            damping=self.damping * (scale * self.speed),
            speed=1.0,
            load=1.0,
            radial_clearance=1.0,
        )
