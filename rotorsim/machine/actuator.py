"""An actuator beside the film: its saturated force, for simulations in time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError

if TYPE_CHECKING:
    from .control import StateFeedback

Array = NDArray[np.float64]


class _FilmForce(Protocol):
    """A film's force at any position and velocity, as `rotorsim.orbit` has them."""

    @property
    def radial_clearance(self) -> float:
        """Radial clearance [m]."""
        ...

    @property
    def name(self) -> str:
        """Of the force model."""
        ...

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Force (fx, fy) [N] at x, y [m], vx, vy [m/s] and shaft speed [rad/s]."""
        ...


@dataclass(frozen=True, eq=False)
class ActuatedForce:
    """Film and collocated actuator: a force that `rotorsim.orbit.simulate` takes like a film's.

    film : Nonlinear film (or linear coefficients).
    feedback : Saturated at its ``max_force`` per axis.
    reference : (float, float). Position [m] about which the actuator acts: the equilibrium of the
        film alone, so that the actuator carries no static load.
    Raises InputError: The feedback is not one of the journal's state.
    """

    film: _FilmForce
    feedback: StateFeedback
    reference: tuple[float, float]

    def __post_init__(self) -> None:
        if self.feedback.gain.shape != (2, 4):
            raise InputError(
                "must be of the journal alone, 2 forces by x, y, vx, vy",
                key="feedback.gain", value=self.feedback.gain.shape,
            )  # fmt: skip

    @property
    def radial_clearance(self) -> float:
        """Radial clearance [m]."""
        return self.film.radial_clearance

    @property
    def name(self) -> str:
        """Of the force model."""
        return f"{self.film.name} with actuator"

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Sum of both forces [N]."""
        fx, fy = self.film.force(x, y, vx, vy, speed)
        ax, ay = self.actuator_force(x, y, vx, vy)
        return fx + float(ax), fy + float(ay)

    def actuator_force(self, x: ArrayLike, y: ArrayLike, vx: ArrayLike, vy: ArrayLike) -> Array:
        """Force of the actuator alone (..., 2) [N], along an orbit for example."""
        x0, y0 = self.reference
        state = np.stack([np.subtract(x, x0), np.subtract(y, y0), vx, vy], axis=-1)
        return self.feedback(state)
