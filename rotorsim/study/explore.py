"""Entries of a scenario varied by hand, and what a change comes to, quickly or in full."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from ..errors import InputError
from ..files.scenario import Scenario
from ..files.scenario.scenario import to_toml
from ..rows import RPM, ZERO_CELSIUS, shown_unit
from ..units import parse_quantity
from .changes import COARSE, with_mesh
from .points import solve
from .stability import StabilityCurve, stability_curves
from .sweep import as_table, sweep_points

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from ..bearing.operating_point import OperatingPoint
    from ..bearing.table import CoefficientTable

_T = TypeVar("_T")
_Path = tuple[str | int, ...]
"""Place of an entry in the scenario: table, key; for one of several tables also its number."""


@dataclass(frozen=True)
class _Unit:
    kind: str
    factor: float = 1.0
    offset: float = 0.0


_UNITS = {
    "µm": _Unit("length", 1e6),
    "mm": _Unit("length", 1e3),
    "rpm": _Unit("speed", RPM),
    "kN": _Unit("force", 1e-3),
    "°C": _Unit("temperature", 1.0, -ZERO_CELSIUS),
    "kg": _Unit("mass"),
    "mPa s": _Unit("dynamic viscosity", 1e3),
    "MN/m": _Unit("stiffness", 1e-6),
    "kPa": _Unit("pressure", 1e-3),
    "deg": _Unit("angle", 180.0 / math.pi),
}
_TYPED = {"µm": "um", "°C": "degC", "°F": "degF", "mPa s": "mPa*s", "klbf/in": "klbf/inch",
          "in": "inch"}  # fmt: skip
"""Spelling in files of units that are shown otherwise."""


@dataclass(frozen=True)
class Knob:
    """An entry of a scenario that is varied.

    path : Where it stands.
    base : Unit of `value`, `low` and `high`; empty for pure numbers.
    value, low, high : Now, and the ends of a slider.
    """

    path: _Path
    label: str
    base: str
    value: float
    low: float
    high: float

    def shown(self, value: float) -> float:
        """Return the value in the unit shown, see `rotorsim.rows.show_units`."""
        _, factor, offset = shown_unit(self.base)
        return value * factor + offset

    def taken(self, shown: float) -> float:
        """Return the value in `base` of a number in the unit shown."""
        _, factor, offset = shown_unit(self.base)
        return (shown - offset) / factor

    @property
    def unit(self) -> str:
        """Unit shown."""
        return shown_unit(self.base)[0]

    def written(self, value: float) -> str | float:
        """Return the entry of a file: the number as it was typed, with its unit."""
        number = float(f"{self.shown(value):.6g}")
        return f"{number!r} {_TYPED.get(self.unit, self.unit)}" if self.base else number


# Path ("*": each of several), label, unit, ends of the slider: factors of the value, or values.
_KNOBS: tuple[tuple[_Path, str, str, tuple[float, float], bool], ...] = (
    (("operating", "speed"), "Shaft speed", "rpm", (0.3, 1.5), True),
    (("operating", "load"), "Load per bearing", "kN", (0.1, 3.0), True),
    (("operating", "eccentricity_ratio"), "Eccentricity ratio", "", (0.05, 0.95), False),
    (("bearing", "radial_clearance"), "Radial clearance", "µm", (0.4, 2.5), True),
    (("bearing", "length"), "Length", "mm", (0.4, 2.0), True),
    (("bearing", "preload"), "Preload", "", (0.05, 0.8), False),
    (("bearing", "pads", "preload"), "Preload of the pads", "", (0.0, 0.7), False),
    (("bearing", "pads", "offset"), "Offset of the pivots", "", (0.4, 0.7), False),
    (("bearing", "pads", "arc"), "Arc of a pad", "deg", (0.6, 1.1), True),
    (("bearing", "groove", "*", "extent"), "Extent, groove", "deg", (0.3, 2.5), True),
    (("bearing", "groove", "*", "supply_pressure"), "Supply pressure, groove", "kPa",
     (0.0, 4.0), True),
    (("lubricant", "viscosity"), "Viscosity", "mPa s", (0.3, 3.0), True),
    (("thermal", "supply_temperature"), "Supply temperature", "°C", (20.0, 90.0), False),
    (("rotor", "mass"), "Rotor mass per bearing", "kg", (0.1, 4.0), True),
    (("rotor", "disc_mass"), "Disc per bearing", "kg", (0.1, 4.0), True),
    (("rotor", "shaft_stiffness"), "Shaft stiffness per bearing", "MN/m", (0.1, 5.0), True),
)  # fmt: skip


def knobs(scenario: Scenario) -> list[Knob]:
    """Return the entries of `scenario` that can be varied, with their present values.

    Of a list of clearances or speeds the first clearance and the highest speed are taken.
    """
    tables = tomllib.loads(scenario.text)
    # What a file may leave out, but every study asks for.
    tables.setdefault("thermal", {}).setdefault(
        "supply_temperature", f"{scenario.thermal.supply_temperature} K"
    )
    tables["operating"]["speed"] = f"{scenario.speeds[-1]} rad/s"
    tables["bearing"]["radial_clearance"] = f"{scenario.radial_clearances[0]} m"
    found = []
    for pattern, label, base, (low, high), relative in _KNOBS:
        for path, entry, number in _places(tables, pattern):
            value = _in_base(entry, base)
            ends = (low * value, high * value) if relative else (low, high)
            if value is None or not ends[0] < ends[1]:
                continue
            ends = (min(ends[0], value), max(ends[1], value))
            found.append(Knob(path, f"{label}{number}", base, value, *ends))
    return found


def _places(tables: Any, pattern: _Path) -> list[tuple[_Path, Any, str]]:
    """Return entries that a path with "*" names: path, value, number of several."""
    if "*" in pattern:
        star = pattern.index("*")
        inner = tables
        for part in pattern[:star]:
            inner = inner.get(part, {}) if isinstance(inner, dict) else {}
        several = len(inner) if isinstance(inner, list) else 0
        return [
            (path, value, f" {k + 1}" if several > 1 else "")
            for k in range(several)
            for path, value, _ in _places(tables, (*pattern[:star], k, *pattern[star + 1 :]))
        ]
    inner = tables
    for part in pattern:
        try:
            inner = inner[part]
        except (KeyError, IndexError, TypeError):
            return []
    return [(pattern, inner, "")]


def _in_base(entry: Any, base: str) -> float:
    if not base:
        return float(entry)
    unit = _UNITS[base]
    return parse_quantity(entry, unit.kind) * unit.factor + unit.offset


def varied(scenario: Scenario, values: Mapping[Knob, float]) -> Scenario:
    """Return `scenario` with entries at other values (in their `Knob.base`).

    One speed and one clearance remain.

    Raises InputError: A value is refused.
    """
    tables = tomllib.loads(scenario.text)
    for knob, value in values.items():
        inner: Any = tables
        for part in knob.path[:-1]:
            inner = inner[part] if isinstance(part, int) else inner.setdefault(part, {})
        inner[knob.path[-1]] = knob.written(value)
    for name in ("orbit", "stability", "tolerances"):
        # They name speeds and clearances of the scenario as it was.
        tables.pop(name, None)
    return Scenario.from_text(to_toml(tables), scenario.source)


def point_of(scenario: Scenario, fine: bool) -> tuple[OperatingPoint, list[StabilityCurve]]:
    """Solve the scenario's point, `fine` on its own mesh, otherwise on a coarse one.

    Returns point : Of the last thermal model, with its fields.
    Returns curves : Of the scenario's rotor at this speed, one for each thermal model.
    """

    def solved(chosen: Scenario) -> tuple[OperatingPoint, list[StabilityCurve]]:
        points = [solve(chosen, thermal_model=model) for model in scenario.thermal_models]
        table = as_table([replace(point, fields=None) for point in points], chosen)
        return points[-1], stability_curves(table, scenario.rotor)

    return _on_mesh(solved, scenario, fine)


def table_over_speed(scenario: Scenario, speeds: list[float], fine: bool) -> CoefficientTable:
    """Solve every thermal model of a scenario at `speeds` [rad/s] in this process."""

    def solved(chosen: Scenario) -> CoefficientTable:
        return as_table(sweep_points(list(chosen.cases()), speeds, workers=1), chosen)

    return _on_mesh(solved, scenario, fine)


def speeds_about(scenario: Scenario, count: int) -> list[float]:
    """Return speeds over the scenario's range; a fifth to 1.5 times of a single speed [rad/s]."""
    low, high = float(scenario.speeds[0]), float(scenario.speeds[-1])
    if high < 1.5 * low:
        low, high = 0.2 * high, 1.5 * high
    return [float(speed) for speed in np.linspace(low, high, count)]


def _on_mesh(solved: Callable[[Scenario], _T], scenario: Scenario, fine: bool) -> _T:
    mesh = scenario.film.mesh
    names = ("circumferential", "axial", "cross_film", "bush_radial")
    least = {name: min(getattr(mesh, name), getattr(COARSE, name)) for name in names}
    if not fine and least != {name: getattr(mesh, name) for name in names}:
        try:
            return solved(with_mesh(scenario, replace(mesh, **least)))
        except InputError:
            pass  # grooves or pads that need more cells
    return solved(scenario)
