"""The journal's path: what an orbit simulation hands back."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from ..arrays import Array


class OrbitStatus(StrEnum):
    """End of a run, and kind of motion in its last part."""

    RUNNING = "running"
    """A piece of a run that goes on."""
    COMPLETED = "completed"
    """Ran to its end, still in transition (or too short to tell)."""
    SETTLED = "settled"
    """Ran to its end, at rest there."""
    PERIODIC = "periodic"
    """Ran to its end on a closed orbit locked to the shaft (its turns: see `recognise`), or to a
    harmonic load."""
    LIMIT_CYCLE = "limit_cycle"
    """Ran to its end whirling with steady amplitude at a frequency of its own."""
    QUASI_PERIODIC = "quasi_periodic"
    """Ran to its end with steady amplitude, whirl and shaft frequency side by side."""
    TOUCH_DOWN = "touch_down"
    """The film fell below the given minimum: the run stopped there."""
    INTEGRATION_FAILED = "integration_failed"
    """The integrator gave up; the samples up to there are good."""


@dataclass(frozen=True)
class OrbitEvent:
    """Something that happened: name, time [s], journal position [m].

    ``touch_down``; ``settled``, ``periodic``, ``limit_cycle`` or ``quasi_periodic`` where the
    steady part begins; ``minimum_film`` of what a long run did not keep.
    """

    name: str
    time: float
    x: float
    y: float


@dataclass(frozen=True)
class Orbit:
    """Samples of the journal's motion in its bearing, load frame, SI.

    Attributes
    ----------
    t : (n,) array
        [s]; the samples are equally spaced in shaft angle.
    x, y : (n,) arrays
        Journal centre from the bearing's centre [m].
    vx, vy : (n,) arrays
        [m/s]
    speed : (n,) array
        Of the shaft [rad/s].
    angle : (n,) array
        Of the shaft [rad]; revolutions are angle/(2 pi).
    fx, fy : (n,) arrays
        Film force on the journal [N].
    load : (n, 2) array
        What varies in time on the rotor: steps, harmonics, the moving base; summed over the
        nodes, without static load and unbalance [N].
    actuator_force : (n, 2) array
        On the journal [N]; zero without an actuator.
    displacements : (n, k) array
        Of all k unknowns of the rotor [m]; the first two columns are x and y. Behind them those
        of tilting pads on a nonlinear film [m, rad].
    pad_velocity : (n, p) array
        Rates of the pads' displacements, which are the last p of `displacements`.
    min_film : (n,) array
        Smallest film thickness [m]; c - e in a plain bearing.
    boundary : (m, 2) array
        Closed line of the positions where journal and bush touch, about `centre` [m]: the clearance
        circle of a plain bearing.
    samples_per_revolution : int
    radial_clearance : float
        [m]
    equilibrium : (float, float)
        Static position at the first speed [m].
    force_model, thermal_model : str
    status : OrbitStatus
    message : str
        What ended the run early, or what was recognised.
    events : tuple of OrbitEvent
    forced : bool
        Whether unbalance or a load varied in time; if not, a steady whirl is the film's own.
    forcing : tuple of float
        Frequencies of harmonic loads and motions of the base [rad/s].
    kind : str
        What was simulated, for labels: ``free_decay``, ``run_up``, ...; may be empty.
    note : str
        What the film force takes for granted (see `rotorsim.orbit.film_force`).
    """

    t: Array
    x: Array
    y: Array
    vx: Array
    vy: Array
    speed: Array
    angle: Array
    fx: Array
    fy: Array
    load: Array
    actuator_force: Array
    displacements: Array
    min_film: Array
    boundary: Array
    samples_per_revolution: int
    radial_clearance: float
    equilibrium: tuple[float, float]
    force_model: str
    thermal_model: str
    status: OrbitStatus
    message: str = ""
    events: tuple[OrbitEvent, ...] = ()
    forced: bool = True
    forcing: tuple[float, ...] = ()
    kind: str = ""
    note: str = ""
    pad_velocity: Array = field(default_factory=lambda: np.zeros((0, 0)))

    @property
    def has_film(self) -> bool:
        """Return whether a film's force acts here."""
        return bool(np.any(self.fx) or np.any(self.fy))

    @property
    def centre(self) -> tuple[float, float]:
        """Return the middle of the picture [m]: the bearing's, without film the static position."""
        return (0.0, 0.0) if self.has_film else self.equilibrium

    @property
    def revolutions(self) -> Array:
        """Turns of the shaft at each sample [-]."""
        return self.angle / (2.0 * np.pi)

    @property
    def film_motion(self) -> tuple[Array, Array]:
        """Displacements of journal and pads (n, 2 + p), and their rates."""
        pads = self.pad_velocity.shape[1]
        if not pads:
            return np.column_stack([self.x, self.y]), np.column_stack([self.vx, self.vy])
        return (
            np.column_stack([self.x, self.y, self.displacements[:, -pads:]]),
            np.column_stack([self.vx, self.vy, self.pad_velocity]),
        )

    @property
    def actuated(self) -> bool:
        """Return whether an actuator acts on the journal."""
        return bool(np.any(self.actuator_force))

    @property
    def constant_speed(self) -> bool:
        """Return whether the shaft turns at one speed throughout."""
        speed = self.speed
        return bool(speed.size == 0 or np.ptp(speed) <= 1e-9 * abs(speed[0]))

    @property
    def eccentricity(self) -> Array:
        """Distance from the bearing's centre [m]."""
        return np.hypot(self.x, self.y)

    @property
    def eccentricity_ratio(self) -> Array:
        """Eccentricity over radial clearance [-]."""
        return self.eccentricity / self.radial_clearance

    def __repr__(self) -> str:
        if not self.t.size:
            return f"<Orbit: {self.thermal_model} {self.kind}, no samples, {self.status.value}>"
        turns, top = self.angle[-1] / (2.0 * np.pi), self.speed[-1] * 30.0 / np.pi
        return (
            f"<Orbit: {self.thermal_model} {self.kind.replace('_', ' ')}, {turns:.4g} turns in "
            f"{self.t[-1]:.4g} s, {top:.0f} rpm at the end, largest e/c "
            f"{np.max(self.eccentricity_ratio):.3g}, {self.status.value}>"
        )

    def _repr_html_(self) -> str:
        from .description import orbit_html

        return orbit_html(self)

    def part(self, first: int, last: int | None = None, step: int = 1) -> Orbit:
        """Cut out samples first to last (excluded), every `step`-th, as an orbit of their own."""
        chosen = slice(first, last, step)
        return replace(
            self,
            samples_per_revolution=max(self.samples_per_revolution // step, 1),
            **{n: getattr(self, n)[chosen] for n in _SERIES},
        )


_SERIES = (
    "t", "x", "y", "vx", "vy", "speed", "angle", "fx", "fy", "load", "actuator_force",
    "displacements", "min_film", "pad_velocity",
)  # fmt: skip


def concatenate(pieces: Iterable[Orbit]) -> Orbit:
    """Join pieces of one run; status, message and events are the run's."""
    parts = list(pieces)
    joined = {n: np.concatenate([getattr(p, n) for p in parts]) for n in _SERIES}
    events = tuple(event for p in parts for event in p.events)
    return replace(parts[-1], equilibrium=parts[0].equilibrium, events=events, **joined)
