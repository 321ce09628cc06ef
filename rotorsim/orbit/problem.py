"""One run in time, ready to be integrated: rotor, film force, loads, speed, start."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag

from ..arrays import Array
from ..errors import InputError
from ..machine.output_feedback import OutputFeedback
from ..model import Bearing
from ..model.loads import Load
from ..rotor import Rotor
from ..rotor.rotor import MATRICES
from .clearance import contact_boundary, minimum_film
from .film_force import SolvedFilmForce
from .forces import BearingForce, LinearForce


@dataclass(frozen=True)
class SpeedSchedule:
    """Speed as straight pieces between knots.

    times : Knots [s], ascending, the first is 0; the last is the end of the run.
    speeds : At the knots [rad/s], none negative.
    Raises InputError: Knots out of order, a negative speed, or a piece without rotation.

    Examples
    --------
    >>> schedule = SpeedSchedule.ramp(0.0, 200.0, duration=2.0)
    >>> schedule.speed_at(1.0).item(), schedule.angle_at(2.0).item()
    (100.0, 200.0)
    """

    times: tuple[float, ...]
    speeds: tuple[float, ...]

    def __post_init__(self) -> None:
        knots = np.asarray(self.times, dtype=float)
        speeds = np.asarray(self.speeds, dtype=float)
        if knots.size < 2 or knots.size != speeds.size or knots[0] != 0.0:
            raise InputError(
                "needs two knots or more, one speed for each, the first at 0 s",
                key="orbit.speed",
                value=self.times,
            )
        if not (np.all(np.isfinite(knots)) and np.all(np.diff(knots) > 0.0)):
            raise InputError(
                "the duration must be finite and above 0", key="orbit.speed", value=self.times
            )
        if not (np.all(np.isfinite(speeds)) and np.all(speeds >= 0.0)):
            raise InputError("must be 0 or more", key="orbit.speed", value=self.speeds)
        if np.any(speeds[1:] + speeds[:-1] <= 0.0):
            raise InputError("the shaft must turn", key="orbit.speed", value=self.speeds)

    @classmethod
    def constant(cls, speed: float, revolutions: float) -> SpeedSchedule:
        """Hold one speed [rad/s] for a number of revolutions."""
        if not (math.isfinite(speed) and speed > 0.0):
            raise InputError("must be above 0", key="orbit.speed", value=speed)
        if not (math.isfinite(revolutions) and revolutions > 0.0):
            raise InputError("must be above 0", key="orbit.revolutions", value=revolutions)
        return cls((0.0, 2.0 * math.pi * revolutions / speed), (speed, speed))

    @classmethod
    def ramp(cls, start: float, stop: float, duration: float, hold: float = 0.0) -> SpeedSchedule:
        """Run up or coast down from `start` to `stop` [rad/s] in `duration`, then `hold` [s]."""
        if hold > 0.0:
            return cls((0.0, duration, duration + hold), (start, stop, stop))
        return cls((0.0, duration), (start, stop))

    @property
    def duration(self) -> float:
        """End of the run [s]."""
        return self.times[-1]

    @property
    def is_constant(self) -> bool:
        """Return whether the speed never changes."""
        return len(set(self.speeds)) == 1

    @property
    def knots(self) -> Array:
        """(k, 4) array: time [s], speed [rad/s], angle [rad], acceleration after it [rad/s2]."""
        times, speeds = np.asarray(self.times), np.asarray(self.speeds)
        steps = np.diff(times)
        angles = np.concatenate([[0.0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * steps)])
        return np.column_stack([times, speeds, angles, np.append(np.diff(speeds) / steps, 0.0)])

    @property
    def revolutions(self) -> float:
        """Revolutions of the shaft over the whole run."""
        return float(self.knots[-1, 2] / (2.0 * math.pi))

    def _piece(self, t: Array) -> Array:
        last = len(self.times) - 2
        index = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, last)
        return self.knots[index]

    def speed_at(self, t: float | Array) -> Array:
        """Return the speed [rad/s] at time t [s]."""
        piece = self._piece(np.asarray(t, dtype=float))
        return piece[..., 1] + piece[..., 3] * (t - piece[..., 0])

    def angle_at(self, t: float | Array) -> Array:
        """Return the shaft angle [rad] at time t [s]."""
        piece = self._piece(np.asarray(t, dtype=float))
        since = t - piece[..., 0]
        return piece[..., 2] + since * (piece[..., 1] + 0.5 * piece[..., 3] * since)

    def time_at(self, angle: float | Array) -> Array:
        """Return time [s] at which the shaft has turned by `angle` [rad].

        The inverse of `angle_at`.
        """
        angle = np.asarray(angle, dtype=float)
        knots = self.knots
        index = np.searchsorted(knots[:, 2], angle, side="right") - 1
        piece = knots[np.clip(index, 0, len(knots) - 2)]
        turned = angle - piece[..., 2]
        # the stable root of w0 t + a t^2/2 = turned; it holds for a = 0 and for w0 = 0 as well
        root = np.sqrt(np.maximum(piece[..., 1] ** 2 + 2.0 * piece[..., 3] * turned, 0.0))
        total = piece[..., 1] + root
        since = np.divide(2.0 * turned, total, out=np.zeros_like(turned), where=total > 0.0)
        return piece[..., 0] + since


@dataclass(frozen=True)
class OrbitProblem:
    """Rotor, film force, loads, speed and start (SI, load frame).

    rotor : The film carries its first node; every node has x and y with mass. Tilting pads on a
        film that is solved become its last unknowns.
    static_load : (float, float). Shared out over the nodes as their masses [N]; (0, 0) switches it
        off.
    initial_displacement : (float, float). Of the journal from `equilibrium` [m].
    initial_velocity : (float, float). Of the journal [m/s].
    equilibrium : (float, float) or None. Where the start is measured from [m]; None: the force's
        own static position at the first speed.
    initial_state : Displacements and velocities, in place of the three above.
    loads : Steps, harmonic forces, motion of the base.
    minimum_film : Film thickness at which the run ends with ``touch_down`` [m] (the surfaces'
        roughness).
    stop_at_contact : With False a linear model runs on outside the clearance circle, where it means
        nothing; for tests of the model itself.
    thermal_model : Label of the film behind the force.
    bearing : In the load frame; its lobes and tilt then decide the film thickness. None: a plain
        bearing of the force's clearance.
    kind, note : Labels of the orbit.
    relative_tolerance : Of one integration step; the absolute one is 1e-3 of it times the
        clearance. None: 1e-8 with linear coefficients, whose growth is to be measured, 1e-7 with a
        nonlinear film, 1e-5 with one that is solved at each step.
    controller : From displacements about the rest position to forces on the rotor's nodes,
        continuous or sampled; see `rotorsim.machine.output_feedback.OutputFeedback`.
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
    minimum_film: float = 0.0
    stop_at_contact: bool = True
    samples_per_revolution: int = 64
    thermal_model: str = "isothermal"
    bearing: Bearing | None = None
    kind: str = ""
    note: str = ""
    relative_tolerance: float | None = None
    controller: OutputFeedback | None = None

    @property
    def tolerance(self) -> float:
        """Relative tolerance in use."""
        if self.relative_tolerance is not None:
            return self.relative_tolerance
        if isinstance(self.force, LinearForce):
            return 1e-8
        return 1e-5 if isinstance(self.force, SolvedFilmForce) else 1e-7

    @property
    def pads(self) -> tuple[str, ...]:
        """Names of the pads' displacements that are integrated: the rotor's last unknowns."""
        return self.force.pads if isinstance(self.force, SolvedFilmForce) else ()

    def moving(self, motion: Array) -> Array:
        """Return the columns of the rotor's displacements or rates (..., n) that move the film."""
        first = motion.shape[-1] - len(self.pads)
        return np.concatenate([motion[..., :2], motion[..., first:]], axis=-1)

    def film_at(self, displacements: Array) -> Array:
        """Return the smallest film thickness [m] at displacements (..., n) of the rotor [m]."""
        if isinstance(self.force, SolvedFilmForce) and self.pads:
            return self.force.thinnest(self.moving(displacements))
        x, y = displacements[:, 0], displacements[:, 1]
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
        if isinstance(self.force, SolvedFilmForce) and self.pads:
            object.__setattr__(self, "rotor", _with_pads(self.rotor, self.force))
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


def _with_pads(rotor: Rotor, force: SolvedFilmForce) -> Rotor:
    """Put the pads' displacements behind the unknowns of the rotor's last node."""
    last = rotor.nodes[-1]
    if last.unknowns[-len(force.pads) :] == force.pads:
        return rotor
    none = np.zeros((len(force.pads), len(force.pads)))
    return replace(
        rotor,
        mass=np.asarray(block_diag(rotor.mass, force.pad_mass)),
        **{name: np.asarray(block_diag(getattr(rotor, name), none)) for name in MATRICES[1:]},
        nodes=(*rotor.nodes[:-1], replace(last, unknowns=(*last.unknowns, *force.pads))),
    )
