"""Results of a machine over its speeds: modes, thresholds, verdict, and what its mesh changes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array
from ..files.machine import MachineFile
from ..machine.branches import Modes, Verdict
from ..machine.machine import Machine, Mount
from ..machine.matrices import static_following
from ..machine.modes import known_speeds, machine_spectrum, modes
from ..machine.peaks import node_at
from ..machine.response import UnbalanceResponse, unbalance_response
from ..machine.statics import StaticEquilibrium
from ..machine.thresholds import (
    CriticalSpeed,
    ThresholdSpeed,
    critical_speeds,
    find_thresholds,
    subdivided,
)
from .machine_supports import SupportState

_MESH_MODES = 8
"""Modes whose change on twice the mesh is stated."""
_RIGID = 1e-13
"""Of the largest squared frequency: below, a free shaft's motion without bending."""
_INTERVALS = 60
"""Of speed, at least, at whose ends thresholds are looked for."""


@dataclass(frozen=True, eq=False)
class MachineResult:
    """A machine with one thermal model of its films.

    thermal_model : ``isothermal``, ``thd``, or ``given`` without films.
    speeds : (n,) array [rad/s]
    statics : One for each speed; empty where no support needs the static load.
    """

    description: MachineFile
    thermal_model: str
    speeds: Array
    machine: Machine
    supports: tuple[SupportState, ...]
    statics: tuple[StaticEquilibrium, ...] = ()

    def __repr__(self) -> str:
        return (
            f"<MachineResult: {self.description.title}; {self.thermal_model}, "
            f"{self.speeds.size} speeds, {'converged' if self.converged else 'not all converged'}>"
        )

    @property
    def converged(self) -> bool:
        """Return whether every film and every static equilibrium did."""
        points = [point for support in self.supports for point in support.points]
        return all(p.converged for p in points) and all(one.converged for one in self.statics)

    @cached_property
    def known(self) -> Array:
        """Longest run of the speeds [rad/s] at which all supports have coefficients."""
        return known_speeds(self.machine) if self.machine.speeds.size else self.speeds

    @cached_property
    def modes(self) -> Modes | None:
        """Branches over the known speeds; None without any."""
        return modes(self.machine, self.known) if self.known.size else None

    @cached_property
    def critical_speeds(self) -> list[CriticalSpeed]:
        """Synchronous crossings of the damped natural frequencies."""
        return [] if self.modes is None else critical_speeds(self.machine, self.modes)

    @cached_property
    def thresholds(self) -> list[ThresholdSpeed]:
        """Speeds at which the verdict changes."""
        if self.known.size < 2:
            return []
        grid = subdivided(self.known, math.ceil(_INTERVALS / (self.known.size - 1)))
        return find_thresholds(machine_spectrum(self.machine, self.known), grid)

    @property
    def verdict(self) -> Verdict | None:
        """At the highest known speed."""
        return None if self.modes is None else self.modes.verdicts[-1]

    @cached_property
    def mesh_change(self) -> tuple[tuple[float, float], ...]:
        """Damped frequency [rad/s] of each mode, and its relative change on twice the mesh.

        Of the lowest eight that oscillate, at the highest known speed.
        """
        if self.modes is None:
            return ()
        fine = self.description.rotor_with_unbalance(2)
        nodes = self.machine.rotor.nodes
        mounts = [
            Mount(node_at(fine, nodes[int(mount.node)].position), mount.support, mount.name)
            for mount in self.machine.mounts
        ]
        top = float(self.known[-1])
        here = modes(self.machine, top).oscillating().eigenvalues[0]
        finer = modes(Machine(fine, mounts), top).oscillating().eigenvalues[0]
        wanted = np.sort_complex(1j * here.imag)[:_MESH_MODES].imag
        found = []
        for frequency in wanted:
            value = here[np.abs(here.imag - frequency).argmin()]
            apart = float(np.abs(finer - value).min() / abs(value))
            found.append((float(frequency), apart))
        return tuple(found)

    @cached_property
    def unbalance_response(self) -> UnbalanceResponse | None:
        """Over the known speeds; None without unbalance or coefficients."""
        if not (np.any(self.machine.rotor.unbalance) and self.known.size):
            return None
        return unbalance_response(self.machine, self.known)


@dataclass(frozen=True, eq=False)
class _HeatedMode:
    """A mode that heating makes unstable at the highest speed.

    frequency : Damped, with heating [rad/s].
    isothermal_growth_rate, growth_rate : Without and with heating [1/s].
    """

    frequency: float
    isothermal_growth_rate: float
    growth_rate: float


def destabilised_by_heating(cold: MachineResult, hot: MachineResult) -> list[_HeatedMode]:
    """Return modes that grow with heating at the highest common speed and do not without.

    A mode's isothermal counterpart is the one of nearest shape (MAC) and frequency.
    """
    if cold.modes is None or hot.modes is None:
        return []
    common = np.intersect1d(cold.known, hot.known)
    if not common.size:
        return []
    top = float(common[-1])
    one, other = modes(cold.machine, top).oscillating(), modes(hot.machine, top).oscillating()
    found = []
    for k in range(other.eigenvalues.shape[1]):
        if other.undamped[0, k] or other.growth_rate[0, k] <= 0.0:
            continue
        size = one.shapes.shape[2]
        mac = np.abs(one.shapes[0].conj() @ other.shapes[0, k, :size]) ** 2
        apart = np.abs(one.eigenvalues[0].imag - other.eigenvalues[0, k].imag)
        twin = int(np.argmin(apart / abs(other.eigenvalues[0, k]) + 1.0 - mac))
        before = float(one.growth_rate[0, twin])
        if before <= 0.0 or one.undamped[0, twin]:
            after = float(other.growth_rate[0, k])
            found.append(_HeatedMode(float(other.damped_frequency[0, k]), before, after))
    return found


def pinned_mesh_change(description: MachineFile) -> float:
    """Return largest relative change on twice the mesh of the lowest natural frequencies at rest.

    The shaft is held where its supports stand: before any film is solved.
    """
    from scipy.linalg import eigh

    lowest = []
    for refinement in (1, 2):
        rotor = description.rotor_with_unbalance(refinement)
        held = [k for one in description.support for k in rotor.planes[node_at(rotor, one.at)]]
        stiffness, mass = (
            np.delete(np.delete(matrix, held, axis=0), held, axis=1)
            for matrix in (rotor.stiffness, rotor.mass)
        )
        idle = np.logical_not(mass.any(axis=0))  # of a shaft without density
        stiffness = stiffness[~idle] @ static_following(stiffness, idle)
        squares: Any = eigh(stiffness, mass[~idle][:, ~idle], eigvals_only=True)
        elastic = squares[squares > _RIGID * squares.max(initial=0.0)]
        lowest.append(np.sqrt(elastic[:_MESH_MODES]))
    count = min(map(len, lowest))
    return float(np.abs(lowest[1][:count] / lowest[0][:count] - 1.0).max(initial=0.0))


def free_motions(description: MachineFile) -> int:
    """Return rigid motions of the shaft, of 4 (two displacements, two tilts).

    That no stiffness resists.

    Films and tables count as stiff in both directions.
    """
    held = [np.zeros((1, 4))]
    for entry in description.support:
        own = np.eye(2) if entry.stiffness is None else np.array(entry.stiffness)
        for stand in (entry.pedestal, entry.damper):
            if stand is not None and not np.any(stand.stiffness):
                own = np.zeros((2, 2))
        size = float(np.abs(own).max())
        z = entry.at / description.rotor.beam.length
        held.append(np.hstack([own, z * own]) / (size or 1.0))
    return 4 - int(np.linalg.matrix_rank(np.vstack(held), tol=1e-9))


def _modes_at(found: Modes, index: int) -> list[dict[str, Any]]:
    """Return modes at one speed as plain data, ascending in undamped frequency.

    One of each conjugate pair, and the real eigenvalues, whose frequency is 0.
    """
    values = found.eigenvalues[index]
    keep = np.flatnonzero(values.imag >= 0.0)
    keep = keep[np.argsort(np.abs(values[keep]), kind="stable")]
    whirl, decrement = found.whirl, found.logarithmic_decrement
    return [
        {
            "growth_rate": float(values[k].real),
            "damped_frequency": abs(float(values[k].imag)),
            "undamped_frequency": float(abs(values[k])),
            "logarithmic_decrement": float(decrement[index, k]) if values[k].imag > 0.0 else None,
            "whirl": str(whirl[index, k]),
            "undamped": bool(found.undamped[index, k]),
        }
        for k in keep
    ]


def stability_document(results: dict[str, MachineResult]) -> dict[str, Any]:
    """Return the stability of a machine as plain data (SI): the last thermal model's in front.

    ``thermal_models`` has each model's own; ``destabilised_by_heating`` the modes that only heating
    makes unstable.
    """
    rows = {name: _stability(result) for name, result in results.items()}
    last = next(reversed(rows))
    document = {**rows[last], "thermal_model": last}
    if len(rows) > 1:
        document["thermal_models"] = rows
        cold, hot = next(iter(results.values())), results[last]
        document["destabilised_by_heating"] = [
            vars(mode) for mode in destabilised_by_heating(cold, hot)
        ]
    return document


def _stability(result: MachineResult) -> dict[str, Any]:
    found = result.modes
    return {
        "speeds": result.known.tolist(),
        "modes": [] if found is None else [_modes_at(found, i) for i in range(result.known.size)],
        "critical_speeds": [
            {"speed": one.speed, "whirl": one.whirl, "damping_ratio": one.damping_ratio}
            for one in result.critical_speeds
        ],
        "thresholds": [
            {
                "speed": one.speed,
                "whirl_frequency_ratio": one.whirl_frequency_ratio,
                "becomes_unstable": one.becomes_unstable,
            }
            for one in result.thresholds
        ],
        "verdict": None if result.verdict is None else str(result.verdict),
        "mesh": {
            "nodes": len(result.machine.rotor.nodes),
            "changes": [
                {"damped_frequency": frequency, "relative_change": change}
                for frequency, change in result.mesh_change
            ],
        },
    }


def supports_document(result: MachineResult) -> list[dict[str, Any]]:
    """Return supports of a machine as plain data (SI): load and film at each speed."""
    return [
        {
            "name": state.name,
            "speeds": result.speeds.tolist(),
            "load": _or_none(np.hypot(*state.load.T)),
            "load_direction": _or_none(state.direction),
            "eccentricity_ratio": [point.eccentricity_ratio for point in state.points],
            "max_temperature": [point.max_temperature for point in state.points],
            "status": [point.status.value for point in state.points],
        }
        for state in result.supports
    ]


def _or_none(values: Sequence[float] | Array) -> list[float | None]:
    return [float(value) if math.isfinite(value) else None for value in values]
