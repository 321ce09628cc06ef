"""Film forces on the journal, their static positions and their linearisation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from ..arrays import Array
from ..errors import InputError
from . import kernels

_CoefficientsBySpeed = Callable[[float], tuple[ArrayLike, ArrayLike]]
_PositionBySpeed = Callable[[float], tuple[float, float]]

_SPEED_INTERVALS = 512


@runtime_checkable
class BearingForce(Protocol):
    """The film's force on the journal at any position and velocity, in the load frame."""

    @property
    def radial_clearance(self) -> float:
        """Radial clearance [m]."""
        ...

    @property
    def name(self) -> str:
        """Name of the force model, for labels."""
        ...

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Return the force (fx, fy) [N] at x, y [m], vx, vy [m/s] and shaft speed [rad/s]."""
        ...


@runtime_checkable
class ActuatedFilm(BearingForce, Protocol):
    """A film with an actuator beside it: `force` is that of both."""

    def actuator_force(self, x: ArrayLike, y: ArrayLike, vx: ArrayLike, vy: ArrayLike) -> Array:
        """Return the force (n, 2) [N] of the actuator alone along (n,) positions and velocities."""
        ...


@dataclass(frozen=True)
class CompiledForce:
    """A force as the compiled right-hand side takes it (see `rotorsim.orbit.kernels`)."""

    kind: int
    numbers: Array
    table: Array

    def evaluate(
        self, x: float, y: float, vx: float, vy: float, speed: float
    ) -> tuple[float, float]:
        """Return the film force [N] at one point."""
        # whole numbers would be compiled for anew
        motion = (float(x), float(y), float(vx), float(vy), float(speed))
        return kernels.film_force(self.kind, *motion, self.numbers, self.table)


@runtime_checkable
class CompilableForce(BearingForce, Protocol):
    """A force with a compiled form: the integrator is then some ten times faster."""

    def compiled(self, lowest_speed: float, highest_speed: float) -> CompiledForce:
        """Return the compiled form, good between two speeds [rad/s]."""
        ...


@dataclass(frozen=True)
class LinearForce:
    """Static force - K (q - q0) - C v, with K, C and q0 looked up by speed (Dal Eq. 21).

    coefficients : speed [rad/s] -> (K, C), two (2, 2) arrays [N/m, N s/m]. It may raise outside its
        range.
    radial_clearance : [m]
    equilibrium : (float, float) or callable. The journal's static position (x0, y0) [m], or speed
        -> position.
    static_force : (float, float). The film's force at equilibrium [N]. Zero leaves the static load
        out on both sides; with (-W, 0) give the problem the static load (W, 0).

    Notes
    -----
    Over a range of speeds the function is sampled on a uniform grid once and a cubic spline
    through the samples is integrated; at one speed the values are taken as they are.
    """

    coefficients: _CoefficientsBySpeed
    radial_clearance: float
    equilibrium: tuple[float, float] | _PositionBySpeed = (0.0, 0.0)
    static_force: tuple[float, float] = (0.0, 0.0)
    name: str = "linear"

    def at(self, speed: float) -> Array:
        """Look up kxx kxy kyx kyy cxx cxy cyx cyy x0 y0 at one speed, (10,)."""
        stiffness, damping = self.coefficients(speed)
        position = self.equilibrium(speed) if callable(self.equilibrium) else self.equilibrium
        values = np.concatenate([np.ravel(stiffness), np.ravel(damping), np.ravel(position)])
        values = np.asarray(values, dtype=float)
        if values.shape != (10,) or not np.all(np.isfinite(values)):
            raise InputError(
                f"needs finite 2 x 2 stiffness and damping at {speed:g} rad/s",
                key="coefficients",
                value=values,
            )
        return values

    def position(self, speed: float) -> tuple[float, float]:
        """Return the equilibrium [m] at one speed."""
        x0, y0 = self.at(speed)[8:]
        return float(x0), float(y0)

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Return the film force [N]."""
        values = self.at(speed)
        away = np.array([x, y]) - values[8:]
        pull = values[:4].reshape(2, 2) @ away + values[4:8].reshape(2, 2) @ np.array([vx, vy])
        fx, fy = np.asarray(self.static_force) - pull
        return float(fx), float(fy)

    def compiled(self, lowest_speed: float, highest_speed: float) -> CompiledForce:
        """Return the spline over the speeds of the run."""
        if highest_speed == lowest_speed:
            table = np.zeros((1, 4, 10))
            table[0, 0] = self.at(lowest_speed)
            step = 1.0
        else:
            speeds = np.linspace(lowest_speed, highest_speed, _SPEED_INTERVALS + 1)
            values = np.array([self.at(float(speed)) for speed in speeds])
            step = float(speeds[1] - speeds[0])
            spline = CubicSpline(np.arange(speeds.size), values)
            table = np.ascontiguousarray(np.moveaxis(spline.c[::-1], 0, 1))
        numbers = np.array([lowest_speed, step, *self.static_force])
        return CompiledForce(kernels.LINEAR, numbers, table)


def squeeze_force_scale(viscosity: float, length: float, radius: float, clearance: float) -> float:
    """Return 2 mu L (R/c)^3 [N s/m]: the unit of film force per squeeze velocity."""
    return 2.0 * viscosity * length * (radius / clearance) ** 3


@dataclass(frozen=True)
class ShortBearingForce:
    """Ocvirk's short film in closed form, at any position and velocity.

    viscosity : [Pa s]
    length, radius, radial_clearance : [m]
    ruptured : Whether the pressure stays above zero, or has either sign.
    """

    viscosity: float
    length: float
    radius: float
    radial_clearance: float
    name: str = "short_bearing"
    ruptured: bool = True

    def compiled(self, lowest_speed: float = 0.0, highest_speed: float = 0.0) -> CompiledForce:
        """Return the compiled form; good at any speed."""
        del lowest_speed, highest_speed
        scale = squeeze_force_scale(self.viscosity, self.length, self.radius, self.radial_clearance)
        numbers = np.array([self.radial_clearance, scale, self.length / (2.0 * self.radius)])
        kind = kernels.SHORT_BEARING if self.ruptured else kernels.SHORT_FULL
        return CompiledForce(kind, numbers, np.zeros((1, 1, 1)))

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Return the film force [N]."""
        return self.compiled().evaluate(x, y, vx, vy, speed)


@dataclass(frozen=True)
class StopForce:
    """A stop around the shaft: linear contact, and dry friction.

    radial_clearance : [m]
    stiffness, damping : Of the contact [N/m, N s/m].
    friction : Coefficient [-].
    radius : Of the shaft [m].
    slip : Sliding velocity below which the friction fades [m/s].
    """

    radial_clearance: float
    stiffness: float
    damping: float
    friction: float
    radius: float
    slip: float
    name: str = "stop"

    def compiled(self, lowest_speed: float = 0.0, highest_speed: float = 0.0) -> CompiledForce:
        """Return the compiled form; good at any speed."""
        del lowest_speed, highest_speed
        numbers = np.array(
            [self.radial_clearance, self.stiffness, self.damping, self.friction, self.radius,
             self.slip]
        )  # fmt: skip
        return CompiledForce(kernels.STOP, numbers, np.zeros((1, 1, 1)))

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Return the force on the shaft [N]; `speed` is the shaft's."""
        return self.compiled().evaluate(x, y, vx, vy, speed)


@dataclass(frozen=True)
class CallableForce:
    """Any function (x, y, vx, vy, speed) -> (fx, fy): a film solved at each call, say."""

    function: Callable[[float, float, float, float, float], tuple[float, float]]
    radial_clearance: float
    name: str = "film"

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Return the film force [N]."""
        return self.function(x, y, vx, vy, speed)


def find_equilibrium(
    force: BearingForce, load: tuple[float, float], speed: float
) -> tuple[float, float]:
    """Return the position (x, y) [m] where the film carries the static load [N] at a speed [rad/s].

    Raises InputError: No position within the clearance carries the load.

    Notes
    -----
    Newton-Powell on p with position = c p/sqrt(1 + p.p), which cannot leave the clearance; started
    from several eccentricities.
    """
    from scipy.optimize import root

    clearance = force.radial_clearance
    weight = float(np.hypot(*load))
    if weight == 0.0:
        return 0.0, 0.0

    def position(p: Array) -> Array:
        return clearance * p / np.sqrt(1.0 + p @ p)

    def residual(p: Array) -> Array:
        x, y = position(p)
        return (np.array(force.force(x, y, 0.0, 0.0, speed)) + load) / weight

    along = np.asarray(load) / weight
    ahead = np.array([-along[1], along[0]])
    for eps in (0.5, 0.2, 0.8, 0.05, 0.95):
        attitude = np.arccos(eps)
        start = eps / np.sqrt(1.0 - eps**2) * (along * eps + ahead * np.sin(attitude))
        found = root(residual, start, method="hybr", options={"xtol": 1e-13})
        if np.max(np.abs(residual(found.x))) < 1e-8:
            x, y = position(found.x)
            return float(x), float(y)
    raise InputError(
        f"no position within the clearance carries this load at {speed:g} rad/s; "
        "lower the load or raise the speed",
        key="operating.load",
        value=weight,
    )


def linearize_force(
    force: BearingForce, x: float, y: float, speed: float, step: float = 1e-5
) -> tuple[Array, Array]:
    """Return K [N/m] and C [N s/m] by fourth-order central differences at a position at rest.

    step : Over the clearance (and over clearance times speed).
    """
    clearance = force.radial_clearance

    def column(direction: Array, size: float) -> Array:
        total = np.zeros(2)
        for weight, k in ((8.0, 1.0), (1.0, -2.0), (-8.0, -1.0), (-1.0, 2.0)):
            dx, dy, vx, vy = (float(d) for d in k * size * direction)
            total += weight * np.array(force.force(x + dx, y + dy, vx, vy, speed))
        return -total / (12.0 * size)

    lengths = np.array([1.0, 1.0, speed, speed]) * step * clearance
    columns = [column(np.eye(4)[i], lengths[i]) for i in range(4)]
    return np.column_stack(columns[:2]), np.column_stack(columns[2:])
