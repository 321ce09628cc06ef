"""Stability against destabilising cross stiffness (API 617 level I)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import InputError
from ..threads import on_one_blas_thread
from .branches import Modes
from .machine import Machine, Mount
from .modes import machine_spectrum
from .spectrum import Eigenmodes, MachineSpectrum
from .support import cross_stiffness
from .tracking import track_modes

_REACH = 10.0
"""Multiple of the anticipated stiffness up to which the decrement is followed (API 617)."""
_MOST = 1e4
"""Multiple up to which the stiffness without decrement is searched."""


@dataclass(frozen=True, eq=False)
class DecrementCurve:
    """Logarithmic decrement of the critical forward mode against destabilising stiffness.

    speed : [rad/s]
    anticipated : Q_A, the sum over the places [N/m].
    stiffness : (n,) array. Q, shared by the places as the anticipated ones are [N/m].
    decrement, frequency : (n,) arrays. Of the forward mode that becomes unstable first, or without
        any Q0 in reach of the one whose growth rate rises most; damped frequency [rad/s].
    threshold : Q0, where the machine becomes unstable [N/m]; 0: it is without any; None: not up to
        10 000 times the anticipated one.
    """

    speed: float
    anticipated: float
    stiffness: Array
    decrement: Array
    frequency: Array
    threshold: float | None

    @property
    def anticipated_decrement(self) -> float:
        """Decrement at Q_A."""
        return float(np.interp(self.anticipated, self.stiffness, self.decrement))


def _destabilised(machine: Machine, stiffness: Mapping[int, float]) -> Machine:
    """Return the machine with cross stiffnesses k_xy = -k_yx [N/m] at nodes."""
    more = [Mount(node, cross_stiffness(q), f"Q at node {node}") for node, q in stiffness.items()]
    return replace(machine, supports=[*machine.mounts, *more])


@dataclass(frozen=True)
class _OverStiffness:
    """Modes of the machine at one speed over the destabilising stiffness."""

    machine: Machine
    speed: float
    shares: Mapping[int, float]
    count: int

    def __call__(self, parameter: float, /) -> Eigenmodes | None:
        shares = {node: share * parameter for node, share in self.shares.items()}
        machine = _destabilised(self.machine, shares)
        return MachineSpectrum(machine, self.count)(self.speed)


@on_one_blas_thread
def decrement_curve(
    machine: Machine, speed: float, anticipated: Mapping[int, float], points: int = 21
) -> DecrementCurve:
    """Follow the decrement of the critical forward mode over destabilising stiffness.

    speed : [rad/s]
    anticipated : Q_A at each node [N/m].
    points : Of the curve, from 0 to ten times the anticipated stiffness or just beyond Q0.
    Raises InputError: The anticipated stiffness is not above 0, or the machine has no forward mode.
    """
    total = sum(anticipated.values())
    if not (math.isfinite(total) and total > 0.0 and min(anticipated.values()) >= 0.0):
        raise InputError(
            "must be above 0 (N/m)", key="lateral.destabilising_stiffness", value=total
        )
    shares = {node: q / total for node, q in anticipated.items()}
    count = machine_spectrum(machine, np.array([speed])).count
    spectrum = _OverStiffness(machine, speed, shares, count)
    threshold = _threshold(spectrum, total)
    reach = _REACH * total
    if threshold is not None:
        reach = max(min(reach, 1.2 * threshold), 1.2 * total)
    values = np.union1d(np.linspace(0.0, reach, points), [total, min(threshold or 0.0, reach)])
    branches = replace(track_modes(spectrum, values), planes=machine.rotor.planes).oscillating()
    branch = _critical_branch(branches, threshold)
    return DecrementCurve(
        speed, total, values, branches.logarithmic_decrement[:, branch],
        branches.damped_frequency[:, branch], threshold,
    )  # fmt: skip


def _critical_branch(branches: Modes, threshold: float | None) -> int:
    """Return the forward branch that is least stable at the threshold, else driven most."""
    growth, values = branches.growth_rate, branches.parameter
    if threshold is not None and threshold <= values[-1]:
        at = int(np.abs(values - threshold).argmin())
        rank = growth[at]
    else:
        at, rank = -1, growth[-1] - growth[0]
    rank = np.where(branches.whirl[at] == "forward", rank, -np.inf)
    if not np.isfinite(rank).any():
        raise InputError("the machine has no forward mode that oscillates", key="speed")
    return int(rank.argmax())


def _threshold(spectrum: _OverStiffness, first: float) -> float | None:
    """Return the stiffness at which the least stable mode's growth rate passes 0."""
    from scipy.optimize import brentq

    def growth(stiffness: float) -> float:
        found = spectrum(stiffness)
        if found is None:
            raise InputError("a support has no coefficients here", key="speed")
        return found.leading.real

    if growth(0.0) > 0.0:
        return 0.0
    low, high = 0.0, first
    while not growth(high) > 0.0:
        low, high = high, 2.0 * high
        if high > _MOST * first:
            return None
    options: dict[str, Any] = {"xtol": 1e-12 * high, "rtol": 1e-12}
    return float(brentq(growth, low, high, **options))  # type: ignore[arg-type]
