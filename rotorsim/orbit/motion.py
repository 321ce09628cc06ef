"""Motion of a whole machine in time: what is integrated, and what comes back."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array, Indices
from ..errors import InputError
from .controlled import Loop
from .orbit import Orbit, OrbitEvent, OrbitStatus
from .problem import SpeedSchedule
from .system import Link, MotionSystem, Plain

_TOLERANCE = 1e-5
_SOLVED_TOLERANCE, _SOLVED_TOLERANCE_SCIPY = 1e-3, 1e-4
"""Tolerances of steps that solve a film, in compiled code and by SciPy. The film's cells change
from full to ruptured one by one, which no step sees to more digits; the compiled method's own
error is a tenth of its estimate."""


SERIES = ("t", "speed", "angle", "q", "v")
"""What a motion holds for each sample."""


@dataclass(frozen=True)
class TorqueDrive:
    """A shaft that a torque drives: polar inertia times acceleration is the sum of torques.

    start : Speed at the beginning [rad/s].
    duration : [s]
    torque : [N m]; negative when it brakes.
    drag : Torque that retards, over the speed [N m s].
    inertia : Polar, of the whole rotor [kg m^2].
    """

    start: float
    duration: float
    torque: float
    drag: float
    inertia: float

    @property
    def speeds(self) -> tuple[float, float]:
        """Lowest and highest speed that the torque alone may lead to [rad/s]."""
        end = self.start + self.torque / self.inertia * self.duration
        if self.drag > 0.0:
            steady = self.torque / self.drag
            end = steady + (self.start - steady) * math.exp(
                -self.drag * self.duration / self.inertia
            )
        return min(self.start, max(end, 0.0)), max(self.start, end)


@dataclass(frozen=True)
class Station:
    """A place whose motion is looked at.

    places : (int, int). Of x and y among the displacements of the whole machine.
    position : From the left end [m].
    link : The film there, whose housing the motion is relative to.
    """

    name: str
    places: tuple[int, int]
    position: float = float("nan")
    link: int | None = None


@dataclass(frozen=True, eq=False)
class MotionProblem:
    """A machine, its speed, where it begins.

    start, velocity : (n,) arrays. Displacements [m] and velocities [m/s] of the system's unknowns
        at the beginning.
    equilibrium : (n,) array. Static position at the first speed [m].
    tolerance : Relative, of one step; None: 1e-5, with films that are solved 1e-3, and 1e-4 where
        SciPy integrates them (pads, turbulence, films that conserve mass).
    kind, thermal_model, note : Labels.
    reduction_error : Largest relative change of an eigenvalue by the reduction, up to the highest
        excitation.
    contact : Displacements (m, n) to the film (m,) that is left before the run ends [m]; None: that
        of round journals in round films.
    loop : The controller, see `rotorsim.orbit.controlled`.
    """

    system: MotionSystem
    drive: SpeedSchedule | TorqueDrive
    start: Array
    velocity: Array
    equilibrium: Array
    stations: tuple[Station, ...]
    samples_per_revolution: int = 64
    tolerance: float | None = None
    kind: str = ""
    thermal_model: str = ""
    note: str = ""
    reduction_error: float = 0.0
    forcing: tuple[float, ...] = ()
    contact: Callable[[Array], Array] | None = None
    loop: Loop | None = None

    def __getstate__(self) -> dict[str, Any]:
        # `plain` may hold addresses of compiled functions, which are good in this process only.
        return {name: value for name, value in self.__dict__.items() if name != "plain"}

    def film_left(self, q: Array) -> Array:
        """Return the film (m,) that is left at displacements (m, n) before the run ends [m]."""
        if self.contact is not None:
            return self.contact(q)
        left = np.full(len(q), math.inf)
        for link in self.system.links:
            if link.film:
                x, y = link.motion(q, 0.0 * q, np.zeros(len(q)))[:, :2].T
                room = link.force.radial_clearance - link.minimum_film
                left = np.minimum(left, room - np.hypot(x, y))
        return left

    @property
    def schedule(self) -> SpeedSchedule:
        """Prescribed speed; InputError where a torque drives."""
        if isinstance(self.drive, TorqueDrive):
            raise InputError("a torque drives this machine", key="orbit.drive")
        return self.drive

    @cached_property
    def plain(self) -> Plain:
        """Arrays for the compiled functions."""
        speeds = self.drive.speeds
        return self.system.plain(min(speeds), max(speeds))

    @property
    def drive_turns(self) -> float:
        """Turns of the shaft in the whole run; with a torque, at most."""
        if isinstance(self.drive, TorqueDrive):
            return max(self.drive.speeds) * self.drive.duration / (2.0 * math.pi)
        return self.drive.revolutions

    @property
    def relative_tolerance(self) -> float:
        """Tolerance in use."""
        if self.tolerance is not None:
            return self.tolerance
        if not self.system.compilable:
            return _SOLVED_TOLERANCE_SCIPY
        solved = any(link.generalised is not None for link in self.system.links)
        return _SOLVED_TOLERANCE if solved else _TOLERANCE


@dataclass(frozen=True, eq=False)
class Motion:
    """Samples of a machine's motion (SI, machine frame).

    t, speed, angle : (m,) arrays. [s], of the shaft [rad/s, rad]; the samples are equally spaced in
        the angle.
    q, v : (m, n) arrays. Unknowns of the system and their rates [m, m/s].
    """

    t: Array
    speed: Array
    angle: Array
    q: Array
    v: Array
    problem: MotionProblem
    status: OrbitStatus
    message: str = ""
    events: tuple[OrbitEvent, ...] = field(default=())

    def __repr__(self) -> str:
        end = f"{self.revolutions[-1]:.4g} turns in {self.t[-1]:.4g} s" if self.t.size else "empty"
        return (
            f"<Motion: {self.q.shape[1]} unknowns, {len(self.stations)} stations, {end}, "
            f"{self.status.value}>"
        )

    @property
    def stations(self) -> tuple[Station, ...]:
        """Places whose motion can be asked for by name."""
        return self.problem.stations

    @property
    def revolutions(self) -> Array:
        """Turns of the shaft at each sample [-]."""
        return self.angle / (2.0 * np.pi)

    def station(self, name: str) -> Station:
        """Return the station by its name.

        Raises InputError: There is none; the message lists them.
        """
        for one in self.stations:
            if one.name == name:
                return one
        known = ", ".join(one.name for one in self.stations)
        raise InputError(f"must be one of {known}", key="station", value=name)

    def stations_of(self, link: int) -> str:
        """Return the name of the station of a film."""
        return next(one.name for one in self.stations if one.link == link)

    def displacement(self, places: Sequence[int] | Indices) -> Array:
        """Return the displacements (m, k) of unknowns of the whole machine [m]."""
        rows = np.asarray(places, dtype=np.intp)
        system = self.problem.system
        return self.q @ system.basis[rows].T + system.offset[rows]

    def link_motion(self, link: Link) -> Array:
        """Return position, velocity, effective speed (m, 5) of the inner body in its housing."""
        return link.motion(self.q, self.v, self.speed)

    def link_force(self, link: Link) -> Array:
        """Return the force (m, 2) of a link on its inner body [N]."""
        return self.problem.system.link_forces(link, self.q, self.v, self.speed, self.problem.plain)

    @property
    def actuator_force(self) -> Array:
        """Return the forces (m, k) of a controller's actuators [N]; k = 0 without one."""
        loop = self.problem.loop
        return np.zeros((self.t.size, 0)) if loop is None else loop.forces(self.q, self.v)

    def orbit(self, name: str) -> Orbit:
        """Return the motion of one station for analysis, figures and recordings of an `Orbit`.

        In a film it is relative to the housing, with the film's force; elsewhere it is that of
        the shaft's centre, without a force, and boundary and least film are those of a circle
        around its rest, of the films' least clearance or of its own reach.
        """
        station, system = self.station(name), self.problem.system
        links = [link for link in system.links if link.film]
        clearance = min((one.force.radial_clearance for one in links), default=0.0)
        zero = np.zeros((self.t.size, 2))
        rows = list(station.places)
        if station.link is not None:
            link = system.links[station.link]
            clearance = link.force.radial_clearance
            motion, force = self.link_motion(link), self.link_force(link)
            rest = self.problem.equilibrium[None]
            home = link.motion(rest, 0.0 * rest, np.zeros(1))[0, :2]
        else:
            place = self.displacement(rows)
            velocity = self.v @ system.basis[rows].T
            motion, force = np.hstack([place, velocity]), zero
            home = system.basis[rows] @ self.problem.equilibrium + system.offset[rows]
            clearance = clearance or max(float(np.abs(place - home).max(initial=0.0)), 1e-9)
        turn = np.linspace(0.0, 2.0 * math.pi, 361)
        middle = np.zeros(2) if station.link is not None else home
        x, y, vx, vy = (np.ascontiguousarray(column) for column in motion[:, :4].T)
        return Orbit(
            t=self.t, x=x, y=y, vx=vx, vy=vy, speed=self.speed, angle=self.angle,
            fx=force[:, 0], fy=force[:, 1], load=zero, actuator_force=self._actuator_at(rows),
            displacements=motion[:, :2],
            min_film=clearance - np.hypot(x - middle[0], y - middle[1]),
            boundary=clearance * np.column_stack([np.cos(turn), np.sin(turn)]),
            samples_per_revolution=self.problem.samples_per_revolution,
            radial_clearance=clearance, equilibrium=(float(home[0]), float(home[1])),
            force_model=system.links[station.link].force.name if station.link is not None
            else ("linear" if system.linear else "free shaft"),
            thermal_model=self.problem.thermal_model, status=self.status, message=self.message,
            forced=bool(system.unbalance or system.loads), forcing=self.problem.forcing,
            kind=self.problem.kind, note=self.problem.note,
        )  # fmt: skip

    def _actuator_at(self, rows: Sequence[int]) -> Array:
        """Return the force (m, 2) of a controller on displacements x and y of a node [N]."""
        loop = self.problem.loop
        if loop is None:
            return np.zeros((self.t.size, 2))
        driven = np.array(loop.driven)
        return self.actuator_force @ (driven[:, None] == np.array(rows)).astype(float)

    def ring_speed(self, name: str) -> Array:
        """Return the speed (m,) of the floating ring of a support [rad/s].

        Raises InputError: It has no ring that turns; the message lists those that have.
        """
        rings = {one.name: one.ring for one in self.problem.system.links if one.ring >= 0}
        if name not in rings:
            known = ", ".join(rings) or "none of this machine"
            raise InputError(f"must have a ring that turns: {known}", key="support", value=name)
        return self.v[:, rings[name]]

    def part(self, first: int, last: int | None = None) -> Motion:
        """Return the samples first to last (excluded)."""
        chosen = slice(first, last)
        cut = {name: getattr(self, name)[chosen] for name in SERIES}
        return replace(self, **cut)


def rings_of(system: MotionSystem) -> Indices:
    """Return the unknowns that are angles of floating rings."""
    return np.array(sorted({one.ring for one in system.links if one.ring >= 0}), dtype=np.intp)
