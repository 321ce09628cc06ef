"""Sensitivity of a machine's stability threshold to the parameters of its bearings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array, ComplexArray
from ..errors import InputError
from ..files.parameters import Variant
from ..files.scenario import Scenario
from ..machine.machine import Machine
from ..machine.modes import machine_spectrum
from ..machine.peaks import node_at
from ..machine.support import Pedestal, Support, cross_stiffness
from ..model import Case
from ..threads import on_one_blas_thread
from .machine import MachineResult
from .machine_analysis import MachineAnalysis
from .machine_supports import SupportState, film_support
from .sweep import sweep_points

_SHARE, _KELVIN, _PRELOAD = 0.1, 5.0, 0.1
"""Changes that are compared: of clearance, load, length, stiffness; temperature; preload."""
_STEP = 0.5
"""Of that change, to both sides of the nominal value: less shows single cells rupture."""


@dataclass(frozen=True)
class Sensitivity:
    """Effect of a parameter on the mode that becomes unstable, all others held.

    support : Name of the bearing; of the place, for a destabilising stiffness.
    value : Nominal one (SI).
    change : That `threshold_change` and `growth_rate_change` belong to, in proportion (SI).
    growth_rate_change : Of the mode at the threshold speed, else at the highest speed [1/s].
    threshold_change : Of the threshold speed [rad/s]; None: the machine has none.
    """

    support: str
    parameter: str
    value: float
    change: float
    growth_rate_change: float
    threshold_change: float | None


@on_one_blas_thread
def sensitivities(result: MachineResult, workers: int | None = None) -> list[Sensitivity]:
    """Return sensitivities of the first threshold speed, the largest effect first.

    Notes
    -----
    With Z(s) = K + s D + s^2 M, right and left eigenvectors x, y of the mode at the threshold, a
    parameter moves the eigenvalue by -y' dZ x/(y' Z'(s) x) and the threshold speed by minus the
    real part of that over the growth rate's slope over speed (film coefficients included). dZ is
    the central difference of films solved anew at the threshold speed, at their present loads:
    what a bearing takes over from others in a statically indeterminate machine is left out.
    """
    mode = _critical_mode(result)
    if mode is None:
        return []
    found = [*_of_films(result, mode, workers), *_of_cross_stiffness(result, mode)]
    return sorted(found, key=lambda one: -abs(one.growth_rate_change))


@dataclass(frozen=True)
class _Mode:
    """The mode that becomes unstable, or is least stable at the highest speed."""

    machine: Machine
    speed: float
    value: complex
    right: ComplexArray
    left: ComplexArray
    slope: float | None

    def effects(self, change: ComplexArray, places: Any) -> tuple[float, float | None]:
        """Return changes of growth rate and threshold by a change of Z at some unknowns."""
        mass, damping, _ = self.machine.matrices(self.speed)
        weight = self.left.conj() @ (2.0 * self.value * mass + damping) @ self.right
        moved = -(self.left[places].conj() @ change @ self.right[places]) / weight
        rate = float(moved.real)
        return rate, None if self.slope is None else -rate / self.slope


def _critical_mode(result: MachineResult) -> _Mode | None:
    machine, known = result.machine, result.known
    if not known.size or machine.frequency_dependent:
        return None
    threshold = next((one for one in result.thresholds if one.becomes_unstable), None)
    speed = float(known[-1]) if threshold is None else threshold.speed
    spectrum = machine_spectrum(machine, known)
    here = spectrum(speed)
    if here is None:
        return None
    wanted = here.leading if threshold is None else 1j * threshold.whirl_frequency
    if wanted == 0.0:
        return None
    at = int(np.abs(here.values - wanted).argmin())
    value, right = complex(here.values[at]), here.shapes[at]
    mass, damping, stiffness = machine.matrices(speed)
    beside = value * (1.0 + 1e-9)
    z = stiffness + beside * damping + beside**2 * mass
    left = np.linalg.solve(z.conj().T, right)
    slope = None
    if threshold is not None:
        step, rates = 1e-4 * speed, []
        for other in (speed - step, speed + step):
            state = spectrum(float(np.clip(other, known[0], known[-1])))
            assert state is not None  # between speeds at which it is known
            rates.append(float(state.values[np.abs(state.values - value).argmin()].real))
        slope = (rates[1] - rates[0]) / (2.0 * step)
    return _Mode(
        machine, speed, value, right, np.asarray(left / np.linalg.norm(left), dtype=complex), slope
    )


def _of_films(result: MachineResult, mode: _Mode, workers: int | None) -> list[Sensitivity]:
    description = result.description
    analysis = MachineAnalysis(
        Variant(description), result.machine.rotor, result.thermal_model, result.speeds.tolist(),
        sweep_points,
    )  # fmt: skip
    jobs: list[tuple[int, str, float, float]] = []
    cases: list[Case] = []
    for i, (name, state) in enumerate(zip(description.support_names, result.supports, strict=True)):
        scenario = description.bearings.get(name)
        if scenario is None or not state.points:
            continue
        load = np.array([np.interp(mode.speed, result.speeds, part) for part in state.load.T])

        def case(
            changes: dict[str, float],
            share: float = 1.0,
            i: int = i,
            load: Array = load,
            scenario: Scenario = scenario,
        ) -> Case:
            changed = scenario.replace(**changes) if changes else scenario
            return analysis.case(i, share * load, changed)

        nominal = case({})
        bearing = nominal.bearing
        values: dict[str, tuple[float | None, float]] = {
            "radial_clearance": (bearing.radial_clearance, _SHARE * bearing.radial_clearance),
            "length": (bearing.length, _SHARE * bearing.length),
            "supply_temperature": (nominal.thermal.supply_temperature, _KELVIN),
            "preload": (getattr(bearing, "preload", None), _PRELOAD),
        }
        for parameter, (value, change) in values.items():
            if value is None:
                continue
            try:
                both = [case({parameter: value + s * _STEP * change}) for s in (-1.0, 1.0)]
            except InputError:
                continue  # beyond what the bearing allows
            jobs.append((i, parameter, value, change))
            cases += both
        size = float(np.hypot(*load))
        jobs.append((i, "load", size, _SHARE * size))
        cases += [case({}, 1.0 + s * _STEP * _SHARE) for s in (-1.0, 1.0)]
    distinct = list(dict.fromkeys(cases))
    found_points = sweep_points(distinct, [mode.speed], workers=workers)
    solved = dict(zip(distinct, found_points, strict=True))
    points = [solved[one] for one in cases]
    found = []
    for k, (i, parameter, value, change) in enumerate(jobs):
        pair = points[2 * k : 2 * k + 2]
        if not all(point.converged for point in pair):
            continue
        stand, state = description.support[i].pedestal, result.supports[i]
        load = np.array([np.interp(mode.speed, result.speeds, part) for part in state.load.T])
        laws: list[Support] = [
            film_support(np.array([mode.speed]), SupportState(state.name, load[None], (point,)))
            for point in pair
        ]
        if stand is not None:
            laws = [Pedestal(law, stand.mass, stand.stiffness, stand.damping) for law in laws]
        place = mode.machine.places[i]
        if any(len(law.unknowns) != place.size for law in laws):
            continue  # a pad gains or loses its load
        low, high = (law.dynamic_stiffness(mode.value, mode.speed) for law in laws)
        rate, threshold = mode.effects((high - low) / (2.0 * _STEP), place)
        found.append(Sensitivity(state.name, parameter, value, change, rate, threshold))
    return found


def _of_cross_stiffness(result: MachineResult, mode: _Mode) -> list[Sensitivity]:
    """Return the sensitivity to destabilising stiffness at the places that the file names."""
    rotor, found = result.machine.rotor, []
    for entry in result.description.lateral.destabilising_stiffness:
        node = node_at(rotor, entry.at)
        change = cross_stiffness(_SHARE * entry.anticipated).dynamic_stiffness(mode.value, 0.0)
        rate, threshold = mode.effects(change, list(rotor.planes[node]))
        disc = next(
            (one for one in result.description.rotor.beam.discs if one.at == entry.at), None
        )
        place = (disc.name if disc else "") or f"at {entry.at * 1e3:g} mm"
        found.append(
            Sensitivity(place, "destabilising_stiffness", 0.0, _SHARE * entry.anticipated, rate,
                        threshold)
        )  # fmt: skip
    return found
