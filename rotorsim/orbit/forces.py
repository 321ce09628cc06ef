"""Film forces on the journal: linear coefficients, nonlinear films, any function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from ..errors import InputError
from . import kernels

Array = NDArray[np.float64]
CoefficientsBySpeed = Callable[[float], tuple[ArrayLike, ArrayLike]]
PositionBySpeed = Callable[[float], tuple[float, float]]

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
        """Of the force model, for labels."""
        ...

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Force (fx, fy) [N] at x, y [m], vx, vy [m/s] and shaft speed [rad/s]."""
        ...


@runtime_checkable
class ActuatedFilm(BearingForce, Protocol):
    """A film with an actuator beside it: `force` is that of both."""

    def actuator_force(self, x: ArrayLike, y: ArrayLike, vx: ArrayLike, vy: ArrayLike) -> Array:
        """Force (n, 2) [N] of the actuator alone along (n,) positions and velocities."""
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
        """Film force [N] at one point."""
        # whole numbers would be compiled for anew
        motion = (float(x), float(y), float(vx), float(vy), float(speed))
        return kernels.film_force(self.kind, *motion, self.numbers, self.table)


@runtime_checkable
class CompilableForce(BearingForce, Protocol):
    """A force with a compiled form: the integrator is then some ten times faster."""

    def compiled(self, lowest_speed: float, highest_speed: float) -> CompiledForce:
        """Compiled form, good between two speeds [rad/s]."""
        ...


def constant_coefficients(stiffness: ArrayLike, damping: ArrayLike) -> CoefficientsBySpeed:
    """K and C that do not change with speed, as the function `LinearForce` takes.

    Parameters
    ----------
    stiffness, damping : (2, 2) array-like
        [N/m, N s/m]
    """
    k, c = np.asarray(stiffness, dtype=float), np.asarray(damping, dtype=float)
    for name, matrix in (("stiffness", k), ("damping", c)):
        if matrix.shape != (2, 2) or not np.all(np.isfinite(matrix)):
            raise InputError("must be a finite 2 x 2 matrix", key=name, value=matrix)
    return lambda _speed: (k, c)


@dataclass(frozen=True)
class LinearForce:
    """Static force - K (q - q0) - C v, with K, C and q0 looked up by speed (Dal Eq. 21).

    Parameters
    ----------
    coefficients : callable
        speed [rad/s] -> (K, C), two (2, 2) arrays [N/m, N s/m]. It may raise outside its range.
    radial_clearance : float
        [m]
    equilibrium : (float, float) or callable
        The journal's static position (x0, y0) [m], or speed -> position.
    static_force : (float, float)
        The film's force at equilibrium [N]. Zero leaves the static load out on both sides; with
        (-W, 0) give the problem the static load (W, 0).
    name : str

    Notes
    -----
    Over a range of speeds the function is sampled on a uniform grid once and a cubic spline
    through the samples is integrated; at one speed the values are taken as they are.
    """

    coefficients: CoefficientsBySpeed
    radial_clearance: float
    equilibrium: tuple[float, float] | PositionBySpeed = (0.0, 0.0)
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
        """Equilibrium [m] at one speed."""
        x0, y0 = self.at(speed)[8:]
        return float(x0), float(y0)

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Film force [N]."""
        values = self.at(speed)
        away = np.array([x, y]) - values[8:]
        pull = values[:4].reshape(2, 2) @ away + values[4:8].reshape(2, 2) @ np.array([vx, vy])
        fx, fy = np.asarray(self.static_force) - pull
        return float(fx), float(fy)

    def compiled(self, lowest_speed: float, highest_speed: float) -> CompiledForce:
        """Spline over the speeds of the run."""
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
    """2 mu L (R/c)^3 [N s/m]: the unit of film force per squeeze velocity."""
    return 2.0 * viscosity * length * (radius / clearance) ** 3


@dataclass(frozen=True)
class ShortBearingForce:
    """Ocvirk's ruptured short film in closed form, at any position and velocity.

    Parameters
    ----------
    viscosity : float
        [Pa s]
    length, radius, radial_clearance : float
        [m]
    """

    viscosity: float
    length: float
    radius: float
    radial_clearance: float
    name: str = "short_bearing"

    def compiled(self, lowest_speed: float = 0.0, highest_speed: float = 0.0) -> CompiledForce:
        """Compiled form; good at any speed."""
        del lowest_speed, highest_speed
        scale = squeeze_force_scale(self.viscosity, self.length, self.radius, self.radial_clearance)
        numbers = np.array([self.radial_clearance, scale, self.length / (2.0 * self.radius)])
        return CompiledForce(kernels.SHORT_BEARING, numbers, np.zeros((1, 1, 1)))

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Film force [N]."""
        return self.compiled().evaluate(x, y, vx, vy, speed)


@dataclass(frozen=True)
class CallableForce:
    """Any function (x, y, vx, vy, speed) -> (fx, fy): a film solved at each call, say."""

    function: Callable[[float, float, float, float, float], tuple[float, float]]
    radial_clearance: float
    name: str = "film"

    def force(self, x: float, y: float, vx: float, vy: float, speed: float) -> tuple[float, float]:
        """Film force [N]."""
        return self.function(x, y, vx, vy, speed)
