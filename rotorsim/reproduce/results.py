"""Everything computed for the paper, by the names under which the claims ask for it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..bearing.operating_point import FilmFields, OperatingPoint
from ..model import MeshSize
from ..model.lubricant import ZERO_CELSIUS
from .paper import CLEARANCES, RAD_PER_RPM, TOP_RPM, Walls

Array = NDArray[np.float64]
ISOTHERMAL = "isothermal"
THD = "thd"
LIQUID = "liquid"
WHOLE = "whole"
STIFFNESS = ("kxx", "kyy", "kxy", "kyx")
"""In the order of Table 2."""
DAMPING = ("cxx", "cyy", "cxy", "cyx")
"""In the order of Table 3."""


class NotComputed(Exception):
    """A value that a verdict needs is not there: its point did not converge."""


@dataclass(frozen=True)
class Run:
    """What one curve over speed is computed for."""

    thermal_model: str
    radial_clearance: float
    walls: Walls = Walls.AMBIENT
    friction: str = LIQUID


@dataclass(frozen=True)
class PaperResults:
    """All operating points, and the fields of Fig. 3.

    Attributes
    ----------
    mesh : MeshSize
    curves : mapping
        Points over ascending speed for each `Run`.
    validation : mapping
        Points over ascending eccentricity ratio for each (walls, rpm): Fig. 2.
    variants : mapping
        Isothermal and THD point (100 um, 15 000 rpm) for each key of `variants.VARIANTS`.
    films : mapping
        (thermal model, rpm) to the operating point with its fields, c = 100 um: Fig. 3.
    strict : bool
        Raise `NotComputed` where a value asked for is NaN, so that no verdict rests on one.
    """

    mesh: MeshSize
    curves: Mapping[Run, tuple[OperatingPoint, ...]]
    validation: Mapping[tuple[Walls, float], tuple[OperatingPoint, ...]] = field(
        default_factory=dict
    )
    variants: Mapping[str, tuple[OperatingPoint, OperatingPoint]] = field(default_factory=dict)
    films: Mapping[tuple[str, float], OperatingPoint] = field(default_factory=dict)
    strict: bool = False

    def points(self) -> list[OperatingPoint]:
        """Every point of the figures; the variants show their status in their table."""
        groups = (*self.curves.values(), *self.validation.values())
        return [point for group in groups for point in group] + list(self.films.values())

    def speeds(self, run: Run) -> Array:
        """Speeds of a curve [rpm]."""
        return np.array([point.speed for point in self.curves[run]]) / RAD_PER_RPM

    def values(self, name: str, run: Run) -> Array:
        """`name` over the speeds of a curve; see `quantity`."""
        return np.array([self._checked(point, name) for point in self.curves[run]])

    def _checked(self, point: OperatingPoint, name: str) -> float:
        value = quantity(point, name)
        if self.strict and math.isnan(value):
            raise NotComputed(name)
        return value

    def at(
        self,
        name: str,
        thermal_model: str,
        clearance: float,
        rpm: float = TOP_RPM,
        *,
        walls: Walls = Walls.AMBIENT,
        friction: str = LIQUID,
    ) -> float:
        """`name` at one point."""
        run = Run(thermal_model, clearance, walls, friction)
        index = int(np.argmin(np.abs(self.speeds(run) - rpm)))
        if abs(self.speeds(run)[index] - rpm) > 1.0:
            raise KeyError(f"{rpm} rpm was not computed for {run}")
        return self._checked(self.curves[run][index], name)

    def reduction(
        self,
        name: str,
        clearance: float,
        rpm: float = TOP_RPM,
        *,
        walls: Walls = Walls.AMBIENT,
        friction: str = LIQUID,
    ) -> float:
        """By how much heating lowers `name`, in percent of the isothermal value."""
        # An isothermal film knows no walls.
        cold = self.at(name, ISOTHERMAL, clearance, rpm, friction=friction)
        warm = self.at(name, THD, clearance, rpm, walls=walls, friction=friction)
        return reduction(cold, warm)

    def field(self, thermal_model: str, rpm: float) -> FilmFields:
        """Fields of a film at c = 100 um.

        Raises
        ------
        NotComputed
            The film did not converge.
        """
        point = self.films[thermal_model, rpm]
        if point.fields is None or not point.converged:
            raise NotComputed(f"{thermal_model} film at {rpm} rpm")
        return point.fields


def reduction(before: float, after: float) -> float:
    """Fall from `before` to `after` in percent; NaN where `before` is zero but for rounding."""
    if abs(before) <= 1e-9 * abs(after):
        return math.nan
    return 100.0 * (1.0 - after / before)


def quantity(point: OperatingPoint, name: str) -> float:
    """An attribute of a point, ``kxx`` ... ``cyy`` (load frame), or ``temperature`` [degC].

    NaN where the point has not converged, or where there is no such thing (a critical mass, say).
    """
    if not point.converged:
        return float("nan")
    if len(name) == 3 and name[0] in "kc" and set(name[1:]) <= set("xy"):
        matrix = point.stiffness if name[0] == "k" else point.damping
        return float(matrix["xy".index(name[1]), "xy".index(name[2])])
    if name == "temperature":
        return point.max_temperature - ZERO_CELSIUS
    value = getattr(point, name)
    return float("nan") if value is None else float(value)


__all__ = [
    "CLEARANCES",
    "DAMPING",
    "ISOTHERMAL",
    "LIQUID",
    "STIFFNESS",
    "THD",
    "WHOLE",
    "NotComputed",
    "PaperResults",
    "Run",
    "quantity",
    "reduction",
]
