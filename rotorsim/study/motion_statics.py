"""Static positions of a machine in time: of its linear supports over speed, and of its films."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..arrays import Array, Indices
from ..errors import InputError
from ..film.geometry import rotation
from ..machine.machine import Machine
from ..machine.peaks import node_at
from ..orbit.film_force import SolvedFilmForce
from ..orbit.forces import StopForce, find_equilibrium
from ..orbit.run import static_position
from ..orbit.system import LinearBlock, MotionSystem
from .motion_supports import MotionParts
from .rings import ring_state


def linear_block(
    parts: MotionParts, linear: Machine, place: Indices, seals: dict[str, Array]
) -> LinearBlock | None:
    """Return linear supports about their static positions over speed, `seals` about theirs."""
    loads = [node_at(parts.rotor, entry.at) for entry in parts.machine.load]
    wanted = {int(i) for at in linear.places for i in at}
    wanted |= {i for node in loads for i in parts.rotor.planes[node]}
    if not wanted:
        return None
    unknowns = np.array(sorted(wanted))
    index = {int(i): k for k, i in enumerate(unknowns)}
    at = [np.array([index[int(i)] for i in places]) for places in linear.places]
    statics = _statics(parts)
    base = parts.static_force(parts.first)

    def law(speed: float) -> tuple[Array, Array, Array]:
        m = unknowns.size
        force, stiffness, damping = np.zeros(m), np.zeros((m, m)), np.zeros((m, m))
        change = parts.static_force(speed) - base
        rotor_places = unknowns[unknowns < parts.rotor.size]
        force[: rotor_places.size] += change[rotor_places]
        for mount, here, full in zip(linear.mounts, at, linear.places, strict=True):
            k, c, _ = mount.support.matrices(speed)
            if not np.all(np.isfinite(k)):
                raise InputError(
                    f"{mount.name} has no coefficients at {speed:g} rad/s", key="orbit.speed"
                )
            stiffness[here[:, None], here] += k
            damping[here[:, None], here] += c
            if mount.name in seals:
                force[here] += k @ seals[mount.name]
            elif statics is not None:
                reaction, position = statics(mount.name, speed)
                force[here[:2]] -= reaction
                rest = np.zeros(here.size)
                coupled = full < parts.rotor.size
                rest[coupled] = position[full[coupled]]
                force[here] += k @ rest
            else:
                entry = parts.machine.support[parts.machine.support_names.index(mount.name)]
                raised = np.zeros(here.size)
                raised[0] = -entry.elevation
                if entry.pedestal is not None:
                    raised[-2] = -entry.elevation
                force[here] += k @ raised
        return force, stiffness, damping

    return LinearBlock(place[unknowns], law)


def _statics(
    parts: MotionParts,
) -> Callable[[str, float], tuple[Array, Array]] | None:
    """Return reaction (2,) and displacement of the rotor (size,) over speed, where known."""
    if parts.result is None or not parts.result.statics:
        return None
    if not parts.settings.gravity:
        raise InputError(
            "goes with nonlinear films only: linear coefficients belong to the loaded position",
            key="orbit.gravity",
        )
    from scipy.interpolate import PchipInterpolator

    statics, speeds = parts.result.statics, parts.result.speeds
    loads = np.stack([one.reactions.ravel() for one in statics])
    # the result's rotor may have other nodes than this one, which has the orbit's as well
    moved = np.stack([_taken_over(parts, one.displacement) for one in statics])
    both = np.hstack([loads, moved])
    curve = PchipInterpolator(speeds, both) if len(speeds) > 1 else lambda _speed: both[0]
    names = parts.machine.support_names

    def at(name: str, speed: float) -> tuple[Array, Array]:
        values = np.asarray(curve(np.clip(speed, speeds[0], speeds[-1])))
        i = names.index(name)
        return values[2 * i : 2 * i + 2], values[2 * len(names) :]

    return at


def _taken_over(parts: MotionParts, displacement: Array) -> Array:
    assert parts.result is not None
    theirs = parts.result.machine.rotor
    if theirs.size == parts.rotor.size:
        return displacement
    moved = np.zeros(parts.rotor.size)
    for i, node in enumerate(parts.rotor.nodes):
        positions = np.array([one.position for one in theirs.nodes])
        near = int(np.argmin(np.abs(positions - node.position)))
        first, own = int(theirs.first_unknown[near]), int(parts.rotor.first_unknown[i])
        moved[own : own + 4] = displacement[first : first + 4]
    return moved


def rest_position(parts: MotionParts, system: MotionSystem) -> Array:
    """Return the static position at the first speed."""
    guess = np.zeros(system.size)
    if system.links and parts.reactions is not None:
        _hung(parts, system, guess)
    plain = system.plain(parts.first, parts.first)
    rest, off = static_position(system, plain, parts.first, guess)
    load = max(float(np.abs(system.constant).max()), 1e-9)
    if off > 1e-6 * load and system.links:
        raise InputError(
            f"no position within the clearances carries the static load at {parts.first:g} "
            "rad/s: raise the speed, or lower the load", key="orbit.speed", value=parts.first,
        )  # fmt: skip
    return rest


def _hung(parts: MotionParts, system: MotionSystem, guess: Array) -> None:
    """Guess the journals' places in `guess`: each film under its own load."""
    assert parts.reactions is not None
    names = parts.machine.support_names
    for link in system.links:
        if isinstance(link.force, StopForce) and link.turning == (0.0, 0.0):
            # a damper's ring without a spring lies on its stop
            load = parts.reactions[names.index(link.name.removesuffix(" stop"))]
            size = max(float(np.hypot(*load)), 1e-12)
            reach = link.force.radial_clearance + size / link.force.stiffness
            guess[list(link.inner)] = reach * load / size
    # a ring's own film first: the journal stands in the ring
    for link in sorted(system.links, key=lambda one: one.outer[0]):
        name = link.name.removesuffix(" ring").removesuffix(" damper")
        if name not in names or not link.film or link.turning == (0.0, 0.0):
            continue
        if isinstance(link.force, SolvedFilmForce):
            rest, turn = link.force.rest, rotation(link.force.frame)
            guess[list(link.inner)] = turn @ rest[:2] + np.array(link.offset)
            guess[list(link.pads)] = rest[2:]
            continue
        i, ring = names.index(name), 0.0
        load = parts.reactions[i]
        given = parts.machine.support[i].ring
        if given is not None and link.ring >= 0:
            ring = ring_state(given, load, parts.first).ring_speed
            guess[link.ring] = ring
        speed = link.turning[0] * parts.first + link.turning[1] * ring
        try:
            where = find_equilibrium(link.force, (float(load[0]), float(load[1])), speed)
        except InputError:
            continue
        for axis in (0, 1):
            under = guess[link.outer[axis]] if link.outer[axis] >= 0 else 0.0
            guess[link.inner[axis]] = where[axis] + under + link.offset[axis]
