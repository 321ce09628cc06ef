"""Loads on the rotor as the compiled right-hand side takes them, and feedback control."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..model.loads import BaseMotion, BaseShock, HarmonicForce, Load, StepForce
from ..rotor import Rotor
from . import kernels

Array = NDArray[np.float64]

CONSTANT, HARMONIC, HALF_SINE = 0.0, 1.0, 2.0
"""Time functions the compiled right-hand side knows."""


@dataclass(frozen=True)
class Controller:
    """Linear feedback of the journal's motion: an actuator's force on the journal.

    z' = A z + B s and force = C z + D s, s = (x - xr, y - yr, vx, vy).

    Parameters
    ----------
    a, b, c, d : arrays of shape (k, k), (k, 4), (2, k), (2, 4)
        k = 0 for plain state feedback.
    reference : tuple of float
        (xr, yr) [m].
    """

    a: Array
    b: Array
    c: Array
    d: Array
    reference: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        k = self.a.shape[0]
        for name, shape in (("a", (k, k)), ("b", (k, 4)), ("c", (2, k)), ("d", (2, 4))):
            if getattr(self, name).shape != shape:
                raise InputError(
                    f"must have the shape {shape}",
                    key=f"controller.{name}",
                    value=getattr(self, name).shape,
                )

    def force(self, state: Array, away: Array) -> Array:
        """Force (n, 2) [N] from controller states (n, k) and the journal's s (n, 4)."""
        return state @ self.c.T + away @ self.d.T

    @classmethod
    def state_feedback(cls, gain: Array, reference: tuple[float, float] = (0.0, 0.0)) -> Controller:
        """Force = -gain s, gain a (2, 4) array [N/m, N s/m]."""
        return cls(np.zeros((0, 0)), np.zeros((0, 4)), np.zeros((2, 0)), -gain, reference)


def pack_loads(loads: Sequence[Load], rotor: Rotor) -> tuple[Array, Array]:
    """Pack loads into arrays for the compiled right-hand side.

    Returns
    -------
    shapes : (k, 2, 2n) array
        Amplitudes of the cosine and sine parts on every degree of freedom [N].
    numbers : (k, 4) array
        Kind, start, stop [s], frequency [rad/s].
    """
    size = rotor.mass.shape[0]
    shapes, numbers = np.zeros((len(loads), 2, size)), np.zeros((len(loads), 4))
    for shape, number, load in zip(shapes, numbers, loads, strict=True):
        match load:
            case StepForce():
                shape[0, _plane(load.node, rotor)] = load.force
                number[:] = CONSTANT, load.start, load.stop, 0.0
            case HarmonicForce():
                shape[:, _plane(load.node, rotor)] = _cosine_and_sine(load.force, load.phase)
                number[:] = HARMONIC, load.start, load.stop, load.frequency
            case BaseMotion():
                base = _cosine_and_sine(load.displacement, load.phase) * load.frequency**2
                shape[:] = [rotor.mass @ rotor.translation(part) for part in base]
                number[:] = HARMONIC, load.start, load.stop, load.frequency
            case BaseShock():
                shape[0] = -rotor.mass @ rotor.translation(load.acceleration)
                stop = load.start + load.duration
                number[:] = HALF_SINE, load.start, stop, math.pi / load.duration
    return shapes, numbers


def load_on_rotor(loads: Sequence[Load], rotor: Rotor, t: Array) -> Array:
    """Sum of the loads over all nodes (n, 2) [N] at times t (n,)."""
    shapes, numbers = pack_loads(loads, rotor)
    every = kernels.load_series(np.asarray(t, dtype=float), shapes, numbers)
    return np.stack([every[:, rotor.first_unknown + axis].sum(axis=1) for axis in (0, 1)], axis=1)


def _plane(node: int, rotor: Rotor) -> slice:
    """Place of a node's x and y."""
    if not 0 <= node < len(rotor.nodes):
        raise InputError(
            f"must be from 0 to {len(rotor.nodes) - 1}", key="orbit.load.node", value=node
        )
    first = int(rotor.first_unknown[node])
    return slice(first, first + 2)


def _cosine_and_sine(amplitude: tuple[float, float], phase: tuple[float, float]) -> Array:
    a, p = np.asarray(amplitude), np.asarray(phase)
    return np.stack([a * np.cos(p), -a * np.sin(p)])


__all__ = [
    "BaseMotion",
    "BaseShock",
    "Controller",
    "HarmonicForce",
    "Load",
    "StepForce",
    "load_on_rotor",
    "pack_loads",
]
