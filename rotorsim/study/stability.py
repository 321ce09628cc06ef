"""Stability of a table's curves over speed, for one rotor."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Booleans, ComplexArray
from ..bearing.description import curve_title
from ..machine.branches import Modes
from ..machine.machine import Machine
from ..machine.modes import eigenvalues_over_speed, known_speeds, modes
from ..machine.support import TableSupport, table_support
from ..machine.thresholds import ThresholdSpeed, threshold_speeds
from ..rotor import Rotor
from ..rows import RPM, number, with_unit

if TYPE_CHECKING:
    from ..bearing.table import CoefficientTable


def _rotor_words(rotor: Rotor | None) -> str:
    """Return ``rotor of 1200 kg per bearing``, ``Jeffcott rotor``; empty without one."""
    if rotor is None:
        return ""
    if rotor.rigid_mass is not None:
        return f"rotor of {with_unit(rotor.rigid_mass, 'kg')} per bearing"
    words = {"jeffcott": "Jeffcott rotor", "matrices": "rotor of your matrices"}
    return words.get(rotor.kind, "rotor")


def verdict_word(growth_rate: float) -> str:
    """Return ``stable``, ``unstable`` or, where nothing damps or drives the rotor, ``undamped``."""
    return "unstable" if growth_rate > 0.0 else "stable" if growth_rate < 0.0 else "undamped"


@dataclass(frozen=True)
class StabilityCurve:
    """A rotor on one bearing with one thermal model, over the tabulated speeds (SI).

    choices : ``thermal_model``, ``radial_clearance`` [m], and any further dimension of the table.
    speed : (n,) array [rad/s]
    stability : (n,) array of str. Verdict on the critical mass; empty where the point did not
        converge.
    critical_mass, critical_mass_dimensionless, whirl_frequency_ratio : (n,) arrays. Of a rigid
        rotor; NaN without a threshold.
    rotor : In words; empty without a rotor.
    mass : Per bearing, of a rigid rotor [kg].
    eigenvalues : (n, k) complex array or None. Of the rotor [1/s], falling real part, those without
        damping last.
    undamped : (n, k) bool array or None. Whether an eigenvalue's real part is below its own
        accuracy: neither stable nor unstable.
    threshold_speeds : Speeds at which that rotor turns from stable to unstable or back [rad/s].
    growth_rate_synchronous : (n,) array or None. What the coefficients reduced at the shaft's
        frequency would make of the growth rate [1/s]; None without tilting pads.
    threshold_speeds_synchronous : And of the threshold speeds [rad/s].
    """

    choices: dict[str, Any]
    speed: Array
    stability: NDArray[np.str_]
    critical_mass: Array
    critical_mass_dimensionless: Array
    whirl_frequency_ratio: Array
    rotor: str = ""
    mass: float | None = None
    eigenvalues: ComplexArray | None = None
    undamped: Booleans | None = None
    threshold_speeds: tuple[float, ...] = ()
    growth_rate_synchronous: Array | None = None
    threshold_speeds_synchronous: tuple[float, ...] = ()

    @property
    def growth_rate(self) -> Array | None:
        """Largest real part [1/s]: above 0 unstable, 0 with no mode damped; None: no rotor."""
        if self.eigenvalues is None:
            return None
        rate = self.eigenvalues[:, 0].real
        return rate if self.undamped is None else np.where(self.undamped[:, 0], 0.0, rate)

    @property
    def title(self) -> str:
        """``thd, c = 100 µm``, and what else the table was stacked along."""
        own = ("thermal_model", "radial_clearance")
        extra = [f"{k} = {number(v)}" for k, v in self.choices.items() if k not in own]
        return curve_title(*(self.choices[name] for name in own), *extra)

    @property
    def verdict(self) -> str | None:
        """``stable``, ``unstable`` or ``undamped`` at the highest speed; None: not known."""
        if self.growth_rate is None or np.isnan(self.growth_rate[-1]):
            return None
        return verdict_word(float(self.growth_rate[-1]))

    @property
    def verdict_over_range(self) -> str | None:
        """``stable throughout``, ``unstable throughout``, ``changes``.

        None without a rotor, and where a speed is not known.
        """
        if self.threshold_speeds:
            return "changes"
        if self.growth_rate is None or not np.isfinite(self.growth_rate).all():
            return None
        words = {verdict_word(float(rate)) for rate in self.growth_rate}
        return f"{words.pop()} throughout" if len(words) == 1 else "changes"

    @property
    def thresholds_text(self) -> str:
        """Threshold speeds [rpm], or which verdict holds over which speeds."""
        if self.threshold_speeds:
            return ", ".join(f"{speed * RPM:.0f}" for speed in self.threshold_speeds)
        if self.growth_rate is None:
            return "-"
        known = np.isfinite(self.growth_rate)
        words = {verdict_word(float(rate)) for rate in self.growth_rate[known]}
        if len(words) != 1:
            return "-"
        word, rpm = words.pop(), self.speed[known] * RPM
        if rpm.size < self.speed.size:
            return f"none: {word} at the {rpm.size} of {self.speed.size} speeds known"
        span = f", {rpm[0]:.0f} to {rpm[-1]:.0f} rpm" if rpm[-1] > rpm[0] else ""
        return f"none: {word}{span}"


def stability_curves(
    table: CoefficientTable, rotor: Rotor | float | None = None
) -> list[StabilityCurve]:
    """Return curves of every thermal model and clearance in `table`.

    rotor : Rotor or float. A number is the mass of a rigid rotor per bearing [kg].
    """
    if isinstance(rotor, (int, float)):
        rotor = Rotor.rigid(float(rotor))
    values = {name: table.dataset[name].values for name in table.choices}
    combinations = itertools.product(*(enumerate(column) for column in values.values()))
    curves = []
    for combination in combinations:
        index = tuple(place for place, _ in combination)
        choices = {
            name: value if isinstance(value, str) else float(value)
            for name, (_, value) in zip(values, combination, strict=True)
        }
        curves.append(_curve(table, index, choices, rotor))
    return curves


def _curve(
    table: CoefficientTable, index: tuple[int, ...], choices: dict[str, Any], rotor: Rotor | None
) -> StabilityCurve:
    from ..bearing.whirl import rigid_thresholds

    usable = table.converged[index]
    blank = np.where(usable, 1.0, np.nan)[:, None, None]
    stiffness, damping = table.stiffness[index] * blank, table.damping[index] * blank
    load = table.dataset["load"].values[index] if "load" in table.dataset else None
    found = rigid_thresholds(
        stiffness, damping, table.speeds, load=load, radial_clearance=choices["radial_clearance"]
    )
    verdict = {
        name: getattr(found, name)
        for name in (
            "stability", "critical_mass", "critical_mass_dimensionless", "whirl_frequency_ratio",
        )
    }  # fmt: skip
    has_pads = "full_stiffness" in table.dataset
    if has_pads:  # those of rotor and pads together
        verdict = {name: table.dataset[name].values[index] for name in verdict}
    eigenvalues, undamped, thresholds = None, None, ()
    synchronous, synchronous_thresholds = None, ()
    if rotor is not None and usable.any():
        machine = Machine.on_identical(rotor, table_support(table, **choices))
        eigenvalues, undamped = _eigenvalues(machine, table.speeds)
        thresholds = _thresholds(machine)
        if has_pads:
            reduced = TableSupport(table.interpolator(**choices))
            machine = Machine.on_identical(rotor, reduced)
            synchronous = _eigenvalues(machine, table.speeds)[0][:, 0].real
            synchronous_thresholds = _thresholds(machine)
    return StabilityCurve(
        choices=choices,
        speed=table.speeds,
        **verdict,
        rotor=_rotor_words(rotor),
        mass=None if rotor is None else rotor.rigid_mass,
        eigenvalues=eigenvalues,
        undamped=undamped,
        threshold_speeds=thresholds,
        growth_rate_synchronous=synchronous,
        threshold_speeds_synchronous=synchronous_thresholds,
    )


def _thresholds(machine: Machine) -> tuple[float, ...]:
    if known_speeds(machine).size < 2:
        return ()
    return tuple(one.speed for one in threshold_speeds(machine))


def _eigenvalues(machine: Machine, speeds: Array) -> tuple[ComplexArray, Booleans]:
    """Return eigenvalues (n, k), each row by falling real part, undamped ones last.

    Which those are.

    NaN where a support has no coefficients.
    """
    values, accuracy = eigenvalues_over_speed(machine, speeds)
    undamped = np.abs(values.real) <= accuracy
    order = np.lexsort((-values.real, undamped), axis=1)
    return np.take_along_axis(values, order, axis=1), np.take_along_axis(undamped, order, axis=1)


@dataclass(frozen=True, eq=False)
class Campbell:
    """Modes of a rotor over speed on one curve of a table (SI).

    choices : ``thermal_model``, ``radial_clearance`` [m], and any further dimension of the table.
    branches : The oscillating ones of lowest frequency, or all.
    growth : (n,) array. Largest real part of all eigenvalues [1/s], non-oscillating ones included,
        those without damping left out.
    """

    choices: dict[str, Any]
    branches: Modes
    growth: Array
    thresholds: tuple[ThresholdSpeed, ...]

    def as_dict(self) -> dict[str, Any]:
        """Return the plain data for JSON: every quantity over speed, branch by branch."""
        found = self.branches
        sense, whirl, undamped = found.whirl_sense, found.whirl, found.undamped
        return {
            "speed": found.parameter,
            "growth_rate": self.growth,
            "branches": [
                {
                    "growth_rate": found.eigenvalues[:, k].real,
                    "damped_frequency": found.damped_frequency[:, k],
                    "damping_ratio": found.damping_ratio[:, k],
                    "logarithmic_decrement": found.logarithmic_decrement[:, k],
                    "whirl_direction": sense[:, k],
                    "whirl": [str(word) for word in whirl[:, k]],
                    "undamped": undamped[:, k],
                }
                for k in range(found.eigenvalues.shape[1])
            ],
            "smooth": bool(found.smooth.all()),
        }


def campbell_curves(table: CoefficientTable, rotor: Rotor, count: int | None = 8) -> list[Campbell]:
    """Return campbell data of `rotor` on every curve of `table`.

    count : Oscillating branches to keep, those of lowest frequency; None: all branches, also those
        that do not oscillate.
    Raises InputError: A curve has no converged point.
    """
    values = {name: table.dataset[name].values for name in table.choices}
    curves = []
    for index in itertools.product(*(range(column.size) for column in values.values())):
        place = dict(zip(values, index, strict=True))
        part = type(table)(table.dataset.isel({n: slice(i, i + 1) for n, i in place.items()}))
        choices = {
            name: value if isinstance(value := values[name][i], str) else float(value)
            for name, i in place.items()
        }
        curves.append(_campbell(part, rotor, count, choices))
    return curves


def _campbell(
    table: CoefficientTable, rotor: Rotor, count: int | None, choices: dict[str, Any]
) -> Campbell:
    machine = Machine.on_identical(rotor, table_support(table))
    every = modes(machine)
    return Campbell(
        choices=choices,
        branches=every if count is None else every.oscillating().lowest(count),
        growth=every.largest_growth_rate,
        thresholds=tuple(threshold_speeds(machine)),
    )


def late_whirl(
    orbits: Iterable[Mapping[str, Any]], curves: Sequence[StabilityCurve]
) -> Iterator[str]:
    """Describe why a run-up shows its whirl above the threshold speed, where it does.

    `orbits` as `rotorsim.orbit.description.describe_orbit` gives them.
    """
    for said in orbits:
        seen, model = said["whirl_range"], said["thermal_model"]
        for curve in curves:
            same = curve.choices["thermal_model"] == model and math.isclose(
                curve.choices["radial_clearance"], said["radial_clearance"], rel_tol=1e-6
            )
            if seen is None or not same or not curve.threshold_speeds:
                continue
            threshold, first = curve.threshold_speeds[0], seen["first_speed"]
            if said["speed"][1] > said["speed"][0] and threshold < first:
                yield (
                    f"threshold at {threshold * RPM:.0f} rpm ({model}), but the whirl is seen from "
                    f"{first * RPM:.0f} rpm on: beyond the threshold it needs time to grow, while "
                    "the speed goes on rising"
                )
