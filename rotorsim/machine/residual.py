"""Residual unbalance, placed to excite each mode (API 617 and 684)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..bearing.drawing import STANDARD_GRAVITY
from ..rotor import Rotor, with_unbalance
from ..rows import RPM
from .branches import Modes
from .machine import Machine
from .thresholds import critical_speeds

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_ANTINODE = 0.3
"""Of the largest deflection, from which a local maximum is excited."""
_OVERHUNG = 0.1
"""Of the rotor's mass, from which what lies beyond the last bearing is an overhung mass."""
_ALIKE = 0.9
"""MAC from which two modes (of the two planes, say) are excited by the same unbalance."""


@dataclass(frozen=True)
class UnbalancePlane:
    """An unbalance at one place.

    at : From the left end [m].
    amount : [kg m]
    phase : 0 or pi [rad].
    mass : W of the formula [kg].
    """

    at: float
    amount: float
    phase: float
    mass: float


@dataclass(frozen=True)
class UnbalanceCase:
    """Unbalances that excite one mode.

    speed : At which the mode is critical, or the highest one where it is not [rad/s].
    """

    name: str
    speed: float
    planes: tuple[UnbalancePlane, ...]

    def applied(self, machine: Machine) -> Machine:
        """Machine with these unbalances and no others."""
        bare = replace(machine.rotor, unbalance=np.zeros(len(machine.rotor.nodes), dtype=complex))
        planes = [(plane.at, plane.amount, plane.phase) for plane in self.planes]
        return replace(machine, rotor=with_unbalance(bare, planes))


def residual_unbalance(mass: float, speed: float) -> float:
    """Residual unbalance U_r [kg m] of one plane: max(6350 W/N, 0.254 W) g mm.

    mass : Journal static load, or overhung mass, W [kg].
    speed : Maximum continuous speed [rad/s].
    """
    return max(6350.0 * mass / (speed * RPM), 0.254 * mass) * 1e-6


def unbalance_cases(
    machine: Machine, found: Modes, loads: Mapping[int, float], speed: float, factor: float
) -> tuple[UnbalanceCase, ...]:
    """Unbalances for every mode that is critical within the speeds of `found`.

    machine : With positions of its rotor's nodes.
    found : Of the machine over speed.
    loads : Static load on each bearing by its node [N].
    speed : Maximum continuous speed [rad/s].
    factor : Times the residual unbalance.

    Without any critical speed the lowest mode at the last speed is taken. Modes of like shape (of
    the two planes) make one case.
    """
    branches = found.oscillating()
    chosen = [(one.speed, one.branch) for one in critical_speeds(machine, found)]
    if not chosen and branches.eigenvalues.shape[1]:
        last = branches.undamped_frequency[-1]
        chosen = [(float(branches.parameter[-1]), int(last.argmin()))]
    deflections: list[Array] = []
    cases = []
    for critical, branch in chosen:
        i = int(np.abs(branches.parameter - critical).argmin())
        line = deflection(machine.rotor, branches.shapes[i, branch])
        if any(_mac(line, other) > _ALIKE for other in deflections):
            continue
        deflections.append(line)
        planes = _planes(machine.rotor, line, loads, speed, factor)
        cases.append(UnbalanceCase(f"mode {len(cases) + 1}", critical, planes))
    return tuple(cases)


def deflection(rotor: Rotor, shape: ComplexArray) -> Array:
    """Deflection (n_nodes,) of a mode in the plane of its largest motion, at that instant."""
    motion = np.array([shape[[x, y]] for x, y in rotor.planes])
    largest = motion[np.abs(motion).max(axis=1).argmax()]
    return np.real(motion @ largest.conj()) / float(np.linalg.norm(largest))


def _mac(a: Array, b: Array) -> float:
    return float((a @ b) ** 2 / ((a @ a) * (b @ b)))


def _planes(
    rotor: Rotor, line: Array, loads: Mapping[int, float], speed: float, factor: float
) -> tuple[UnbalancePlane, ...]:
    """Planes at the antinodes, each with the journal loads nearest to it or its overhung mass."""
    at = np.array([node.position for node in rotor.nodes])
    supports = sorted(loads, key=lambda node: at[node])
    ends = at[supports[0]], at[supports[-1]]
    lumped = np.abs(rotor.mass @ rotor.translation((1.0, 0.0)))
    nodal = np.array([lumped[x] for x, _ in rotor.planes])
    outboard = float(nodal[at < ends[0]].sum()), float(nodal[at > ends[1]].sum())
    low = at[0] if outboard[0] > _OVERHUNG * rotor.total_mass else ends[0]
    high = at[-1] if outboard[1] > _OVERHUNG * rotor.total_mass else ends[1]
    found = _antinodes(line, (at >= low) & (at <= high))
    mass = dict.fromkeys(found, 0.0)
    for i in found:
        mass[i] += outboard[0] if at[i] < ends[0] else outboard[1] if at[i] > ends[1] else 0.0
    inboard = [i for i in found if ends[0] <= at[i] <= ends[1]]
    for node, load in loads.items():
        if inboard:
            nearest = min(inboard, key=lambda i: abs(at[i] - at[node]))
            mass[nearest] += abs(load) / STANDARD_GRAVITY
    sign = np.sign(line[max(found, key=lambda i: abs(line[i]))])
    return tuple(
        UnbalancePlane(
            float(at[i]), factor * residual_unbalance(mass[i], speed),
            0.0 if line[i] * sign > 0.0 else float(np.pi), mass[i],
        )
        for i in found if mass[i] > 0.0
    )  # fmt: skip


def _antinodes(line: Array, within: NDArray[np.bool_]) -> list[int]:
    """Local maxima of the deflection's magnitude, ends included."""
    index = np.flatnonzero(within)
    size = np.abs(line[index])
    before, after = np.append(-np.inf, size[:-1]), np.append(size[1:], -np.inf)
    tops = (size > before) & (size >= after) & (size > _ANTINODE * size.max())
    return [int(i) for i in index[tops]]
