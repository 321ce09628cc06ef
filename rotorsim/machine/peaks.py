"""Unbalance response at probes: amplitude, phase, peaks and their amplification factors."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array
from ..errors import InputError
from ..model.machine import Probe
from ..rotor import Rotor
from .branches import Modes
from .machine import Machine
from .response import unbalance_response
from .thresholds import critical_speeds

_HALF_POWER = 0.5**0.5
"""Of the peak: where the amplification factor's speeds N_1 and N_2 are taken (API 684)."""
_POINTS = 400
"""Speeds of a response over its whole range, at least."""
_ABOUT_PEAK = np.concatenate([-np.geomspace(8.0, 0.125, 13), [0.0], np.geomspace(0.125, 8.0, 13)])
"""Further speeds near a critical speed, in units of its damping ratio times the speed."""
_LEAST_DAMPING = 1e-8
"""Damping ratio below which a critical speed is undamped: there the response is only rounding."""
_SAME_PLACE = 1e-6
"""Of the shaft's length."""


@dataclass(frozen=True)
class Peak:
    """A peak of the response over speed.

    speed : [rad/s]
    amplitude : [m]
    lower, upper : Speeds on both sides at which the amplitude is 0.707 of the peak's [rad/s]; None:
        there is none, and `note` says why.
    """

    speed: float
    amplitude: float
    lower: float | None
    upper: float | None
    note: str = ""

    @property
    def amplification_factor(self) -> float | None:
        """N_c/(N_2 - N_1); None without both half-power points, infinite without damping."""
        if self.lower is None or self.upper is None:
            return None
        width = self.upper - self.lower
        return self.speed / width if width > 0.0 else math.inf


@dataclass(frozen=True, eq=False)
class ProbeResponse:
    """Synchronous response at one probe.

    at : From the left end [m].
    angle : From x in the direction of rotation [rad].
    speed : (n,) array [rad/s]
    amplitude : (n,) array. Zero to peak, along the probe [m].
    phase : (n,) array. Lag behind the largest unbalance, 0 to 2 pi [rad]: at rest both pass the
        probe together.
    major_axis : (n,) array. Half the major axis of the node's orbit [m].
    peaks : Of `amplitude`, ascending in speed.
    """

    name: str
    at: float
    angle: float
    speed: Array
    amplitude: Array
    phase: Array
    major_axis: Array
    peaks: tuple[Peak, ...]


def node_at(rotor: Rotor, at: float) -> int:
    """Return the number of the node at a place [m].

    Raises InputError: The rotor has no node there.
    """
    positions = np.array([node.position for node in rotor.nodes])
    distance = np.abs(positions - at)
    if np.isnan(distance).all() or np.nanmin(distance) > _SAME_PLACE * np.nanmax(positions):
        raise InputError("the rotor has no node here", key="at", value=at)
    return int(np.nanargmin(distance))


def response_speeds(machine: Machine, low: float, high: float, found: Modes | None = None) -> Array:
    """Return the speeds (n,) [rad/s] for a response: even ones, and more near critical speeds.

    low, high : [rad/s]
    found : Of the machine over these speeds. Without them narrow peaks may lie between two speeds.
    """
    speeds = [np.linspace(low, high, _POINTS)]
    for one in [] if found is None else critical_speeds(machine, found):
        ratio = abs(one.damping_ratio)
        if ratio > _LEAST_DAMPING:
            speeds.append(one.speed * (1.0 + ratio * _ABOUT_PEAK))
    every = np.unique(np.concatenate(speeds))
    return every[(every >= low) & (every <= high)]


def probe_responses(
    machine: Machine, probes: Sequence[Probe], speeds: Array
) -> tuple[ProbeResponse, ...]:
    """Return the response to the rotor's unbalance at probes, with refined peaks.

    probes : Where the rotor has a node.
    speeds : (n,) array. Ascending [rad/s], for example from `response_speeds`.
    Raises InputError: The rotor has no unbalance, or no node at a probe.
    """
    nodes = [node_at(machine.rotor, probe.at) for probe in probes]
    response = unbalance_response(machine, speeds)
    heavy = machine.rotor.unbalance[np.abs(machine.rotor.unbalance).argmax()]
    found = []
    for number, (probe, node) in enumerate(zip(probes, nodes, strict=True), start=1):
        along = response.probe(node, probe.angle)
        lag = np.angle(heavy) - probe.angle - np.angle(along)
        found.append(
            ProbeResponse(
                probe.name or f"probe {number}", probe.at, probe.angle, speeds, np.abs(along),
                np.mod(lag, 2.0 * np.pi), response.major_axis(node),
                _find_peaks(_amplitude_along(machine, node, probe.angle), speeds, np.abs(along)),
            )
        )  # fmt: skip
    return tuple(found)


def _amplitude_along(machine: Machine, node: int, angle: float) -> Callable[[float], float]:
    """Return the amplitude [m] along a direction at a node as a function of speed [rad/s]."""

    def amplitude(speed: float) -> float:
        return float(abs(unbalance_response(machine, speed).probe(node, angle)[0]))

    return amplitude


def _find_peaks(
    amplitude: Callable[[float], float], speeds: Array, values: Array
) -> tuple[Peak, ...]:
    """Return the peaks of a response, each refined between its neighbours.

    amplitude : At any speed between the first and the last.
    speeds, values : (n,) arrays. Where it is known already, ascending; NaN where it is not known.
    """
    inner = (values[1:-1] > values[:-2]) & (values[1:-1] >= values[2:])
    return tuple(_peak(amplitude, speeds, values, int(i)) for i in np.flatnonzero(inner) + 1)


def _peak(amplitude: Callable[[float], float], speeds: Array, values: Array, i: int) -> Peak:
    from scipy.optimize import minimize_scalar

    # The inverse square is nearly a parabola, however sharp the peak.
    found = minimize_scalar(
        lambda s: amplitude(s) ** -2.0, bounds=(speeds[i - 1], speeds[i + 1]), method="bounded",
        options={"xatol": 1e-10 * speeds[i]},
    )  # fmt: skip
    top = Peak(float(found.x), float(found.fun) ** -0.5, None, None)
    if values[i] > top.amplitude:
        top = Peak(float(speeds[i]), float(values[i]), None, None)
    lower, below = _half_power(amplitude, speeds, values, top, -1)
    upper, above = _half_power(amplitude, speeds, values, top, 1)
    return replace(top, lower=lower, upper=upper, note="; ".join(n for n in (below, above) if n))


def _half_power(
    amplitude: Callable[[float], float], speeds: Array, values: Array, top: Peak, side: int
) -> tuple[float | None, str]:
    """Return the nearest speed on one side where the amplitude is 0.707 of the peak, or why not."""
    from scipy.optimize import brentq

    level = _HALF_POWER * top.amplitude
    where = "above" if side > 0 else "below"
    onwards = np.flatnonzero(side * (speeds - top.speed) > 0.0)[::side]
    near = top.speed
    for i in onwards:
        far, value = float(speeds[i]), float(values[i])
        if not math.isfinite(value):
            return None, f"the response is not known {where} the peak"
        if value <= level:
            root = brentq(lambda s: amplitude(s) - level, near, far, xtol=1e-11 * top.speed)
            return float(root), ""  # type: ignore[arg-type]
        if value > top.amplitude * (1.0 + 1e-9):
            return None, f"no half-power point {where} the peak: a larger peak is near"
        near = far
    return None, f"no half-power point {where} the peak within the speeds"
