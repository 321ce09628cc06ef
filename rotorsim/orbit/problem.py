"""One orbit to be simulated, ready to run."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..model import Bearing
from ..rotor import Rotor
from .clearance import contact_boundary, minimum_film
from .film_force import SolvedFilmForce
from .forces import BearingForce, LinearForce
from .loads import Controller, Load
from .speed import SpeedSchedule

Array = NDArray[np.float64]


class Method(StrEnum):
    """SciPy integrators.

    ``LSODA`` changes between Adams and BDF formulas as the film stiffens; it is the default.
    ``DOP853`` is explicit, of order 8, for smooth non-stiff runs and cross-checks; ``Radau`` is
    implicit, for very light journals close to the wall.
    """

    LSODA = "LSODA"
    DOP853 = "DOP853"
    RADAU = "Radau"


@dataclass(frozen=True)
class OrbitProblem:
    """Rotor, film force, loads, speed and start (SI, load frame).

    Parameters
    ----------
    force : BearingForce
    rotor : Rotor
        The film carries its first node; every node has x and y with mass.
    schedule : SpeedSchedule
    static_load : (float, float)
        Shared out over the nodes as their masses [N]; (0, 0) switches it off.
    initial_displacement : (float, float)
        Of the journal from `equilibrium` [m].
    initial_velocity : (float, float)
        Of the journal [m/s].
    equilibrium : (float, float) or None
        Where the start is measured from [m]; None: the force's own static position at the first
        speed.
    initial_state : array or None
        Displacements, velocities and controller states, in place of the three above.
    loads : tuple of Load
        Steps, harmonic forces, motion of the base.
    controller : Controller or None
        Actuator force on the journal.
    minimum_film : float
        Film thickness at which the run ends with ``touch_down`` [m] (the surfaces' roughness).
    stop_at_contact : bool
        With False a linear model runs on outside the clearance circle, where it means nothing;
        for tests of the model itself.
    samples_per_revolution : int
    thermal_model : str
        Label of the film behind the force.
    bearing : Bearing or None
        In the load frame; its lobes and tilt then decide the film thickness. None: a plain bearing
        of the force's clearance.
    kind, note : str
        Labels of the orbit.
    method : Method
    relative_tolerance : float or None
        Of one integration step; the absolute one is 1e-3 of it times the clearance. None: 1e-8
        with linear coefficients, whose growth is to be measured, 1e-7 with a nonlinear film, 1e-5
        with one that is solved at each step.
    """

    force: BearingForce
    rotor: Rotor
    schedule: SpeedSchedule
    static_load: tuple[float, float] = (0.0, 0.0)
    initial_displacement: tuple[float, float] = (0.0, 0.0)
    initial_velocity: tuple[float, float] = (0.0, 0.0)
    equilibrium: tuple[float, float] | None = None
    initial_state: Array | None = None
    loads: tuple[Load, ...] = ()
    controller: Controller | None = None
    minimum_film: float = 0.0
    stop_at_contact: bool = True
    samples_per_revolution: int = 64
    thermal_model: str = "isothermal"
    bearing: Bearing | None = None
    kind: str = ""
    note: str = ""
    method: Method = Method.LSODA
    relative_tolerance: float | None = None

    @property
    def tolerance(self) -> float:
        """Relative tolerance in use."""
        if self.relative_tolerance is not None:
            return self.relative_tolerance
        if isinstance(self.force, LinearForce):
            return 1e-8
        return 1e-5 if isinstance(self.force, SolvedFilmForce) else 1e-7

    def film_at(self, x: Array, y: Array) -> Array:
        """Smallest film thickness [m] with the journal at x, y [m]."""
        if self.bearing is None:
            return self.force.radial_clearance - np.hypot(x, y)
        return minimum_film(self.bearing, x, y)

    @property
    def boundary(self) -> Array:
        """Closed line (m, 2) of the positions where journal and bush touch [m]."""
        if self.bearing is None:
            turn = np.linspace(0.0, 2.0 * math.pi, 361)
            return self.force.radial_clearance * np.column_stack([np.cos(turn), np.sin(turn)])
        return contact_boundary(self.bearing)

    def __post_init__(self) -> None:
        clearance = self.force.radial_clearance
        if not (math.isfinite(clearance) and clearance > 0.0):
            raise InputError("must be above 0", key="bearing.radial_clearance", value=clearance)
        if self.rotor.bearing_nodes != (0,):
            raise InputError(
                "the film must carry the first node and no other", key="rotor.bearing_nodes",
                value=self.rotor.bearing_nodes,
            )  # fmt: skip
        if np.linalg.eigvalsh(self.rotor.mass)[0] <= 0.0:
            raise InputError(
                "must be positive definite: in time every node needs a mass, journals too",
                key="rotor.mass",
            )
        if not 0.0 <= self.minimum_film < clearance:
            raise InputError(
                f"must lie between 0 and the clearance of {clearance:g} m",
                key="orbit.minimum_film",
                value=self.minimum_film,
            )
        if self.samples_per_revolution < 4:
            raise InputError(
                "must be 4 or more",
                key="orbit.samples_per_revolution",
                value=self.samples_per_revolution,
            )
        if not 1e-13 <= self.tolerance <= 1e-2:
            raise InputError(
                "must lie between 1e-13 and 1e-2",
                key="orbit.relative_tolerance",
                value=self.relative_tolerance,
            )
