"""Squeeze-film dampers and floating rings: their films, and their linear supports."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..bearing.drawing import STANDARD_GRAVITY
from ..errors import InputError
from ..machine.statics import Law
from ..machine.support import MatrixTable, Support
from ..model.supports import Damper, FloatingRing
from ..orbit.film_map import film_force_map
from ..orbit.force_map import FilmMapForce
from ..orbit.forces import BearingForce, ShortBearingForce, find_equilibrium, linearize_force

_SLOWEST = 1e-4
"""Of a ring, over the shaft's speed."""


def damper_force(damper: Damper, short: bool = False) -> BearingForce:
    """Return the squeeze film of a damper: the finite film's map, or the short one's closed form.

    Raises InputError: The closed form is asked for with end seals.
    """
    radius = 0.5 * damper.diameter
    if short:
        if damper.end_seal is not None:
            raise InputError(
                'the short film has open ends: with end_seal use force = "film"', key="damper"
            )
        return ShortBearingForce(
            damper.viscosity, damper.length, radius, damper.radial_clearance,
            ruptured=damper.cavitating,
        )  # fmt: skip
    rupture = "reynolds" if damper.cavitating else "full_sommerfeld"
    made = film_force_map(damper.length / damper.diameter, rupture, leakage=damper.leakage)
    return FilmMapForce(made, damper.viscosity, damper.length, radius, damper.radial_clearance)


def centred_damping(damper: Damper) -> float:
    """Return the damping [N s/m] of a damper in small circular motions about its centre.

    That of the short film with open ends, of the finite film with seals.
    """
    force = damper_force(damper, short=damper.end_seal is None)
    rate = 1e-3 * force.radial_clearance
    return -force.force(0.0, 0.0, 0.0, rate, 0.0)[1] / rate


def ring_films(ring: FloatingRing) -> tuple[ShortBearingForce, ShortBearingForce]:
    """Return the short films inside and outside of a ring."""
    return (
        ShortBearingForce(
            ring.inner_viscosity, ring.inner_length, 0.5 * ring.inner_diameter,
            ring.inner_clearance,
        ),
        ShortBearingForce(
            ring.outer_viscosity, ring.outer_length, 0.5 * ring.outer_diameter,
            ring.outer_clearance,
        ),
    )  # fmt: skip


@dataclass(frozen=True)
class _RingState:
    """Static state of a floating-ring bearing.

    ring_speed : [rad/s]
    journal, ring : (2,) arrays. Of the journal in the ring, and of the ring in the housing [m].
    """

    ring_speed: float
    journal: Array
    ring: Array


def ring_state(ring: FloatingRing, load: Array, speed: float) -> _RingState:
    """Return places of journal and ring under a load [N] at a speed [rad/s], and the ring's speed.

    The torques of both films on the ring balance: each film's shear, and its half of the couple of
    the eccentric force.

    Raises InputError: A film carries the load at no place.
    """
    from scipy.optimize import root_scalar

    inner, outer = ring_films(ring)
    drags = ring.drags
    under = np.asarray(load, dtype=float) + np.array([ring.mass * STANDARD_GRAVITY, 0.0])

    def places(turning: float) -> tuple[Array, Array]:
        journal = find_equilibrium(inner, (float(load[0]), float(load[1])), speed + turning)
        body = find_equilibrium(outer, (float(under[0]), float(under[1])), turning)
        return np.array(journal), np.array(body)

    def torque(turning: float) -> float:
        total = 0.0
        for place, weight, clearance, drag, rate, side in zip(
            places(turning), (load, under), (ring.inner_clearance, ring.outer_clearance), drags,
            (speed - turning, turning), (1.0, -1.0), strict=True,
        ):  # fmt: skip
            eps2 = float(place @ place) / clearance**2
            couple = -(place[0] * weight[1] - place[1] * weight[0])
            total += side * drag * rate / math.sqrt(1.0 - eps2) - 0.5 * couple
        return total

    if not ring.turning:
        raise InputError(
            "a held ring (turning = false) carries no static load: its outer film is a damper",
            key="ring.turning",
        )
    low, high = _SLOWEST * speed, (1.0 - _SLOWEST) * speed
    if torque(low) <= 0.0:
        raise InputError(
            f"the films' friction does not turn the ring under its load at {speed:g} rad/s",
            key="ring",
        )
    turning = float(root_scalar(torque, bracket=(low, high), xtol=1e-10 * speed).root)
    return _RingState(turning, *places(turning))


def ring_law(ring: FloatingRing, speed: float) -> Law:
    """Return the load to the journal's displacement and its derivative (see `machine.statics`)."""

    def at(load: Array) -> Array:
        state = ring_state(ring, load, speed)
        return state.journal + state.ring

    def law(load: Array) -> tuple[Array, Array]:
        step = 1e-4 * max(float(np.hypot(*load)), 1e-6)
        columns = [(at(load + d) - at(load - d)) / (2.0 * step) for d in step * np.eye(2)]
        return at(load), np.column_stack(columns)

    return law


def _slopes(force: BearingForce, place: Array, speed: float) -> tuple[Array, Array]:
    return linearize_force(force, float(place[0]), float(place[1]), speed)


def ring_support(ring: FloatingRing, speeds: Array, loads: Array) -> Support:
    """Return linear support of a floating-ring bearing, the ring with unknowns of its own.

    speeds : (n,) array. [rad/s]
    loads : (n, 2) array. Static loads along x and y [N].
    """
    inner, outer = ring_films(ring)
    matrices = np.zeros((2, speeds.size, 4, 4))
    for k, (speed, load) in enumerate(zip(speeds, loads, strict=True)):
        state = ring_state(ring, load, float(speed))
        one = _slopes(inner, state.journal, float(speed) + state.ring_speed)
        two = _slopes(outer, state.ring, state.ring_speed)
        relative = np.hstack([np.eye(2), -np.eye(2)])
        for kind in (0, 1):
            matrices[kind, k] = relative.T @ one[kind] @ relative
            matrices[kind, k, 2:, 2:] += two[kind]
    mass = np.zeros((speeds.size, 4, 4))
    mass[:, 2, 2] = mass[:, 3, 3] = ring.mass
    return MatrixTable(
        speeds, matrices[0], matrices[1], mass, unknowns=("x", "y", "ring_x", "ring_y"), coupled=2
    )
