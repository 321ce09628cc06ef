"""A rotor on every curve of a table: branches over speed, thresholds, senses of whirl."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..stability.modes import Branches, ThresholdSpeed
from ..stability.over_speed import RotorOnFilm, rotor_modes, rotor_thresholds

if TYPE_CHECKING:
    from ..table import CoefficientTable

Array = NDArray[np.float64]

FORWARD = 0.1
"""Ratio of areas, orbit to circle, above which a whirl counts as forward (or backward)."""


@dataclass(frozen=True, eq=False)
class Campbell:
    """Modes of a rotor over speed on one curve of a table (SI).

    Attributes
    ----------
    choices : dict
        ``thermal_model``, ``radial_clearance`` [m], and any further dimension of the table.
    branches : Branches
        The oscillating ones of lowest frequency.
    sense : (n, k) array
        Of whirl: 1 a forward circle, -1 a backward one, 0 a straight line.
    growth : (n,) array
        Largest real part of all eigenvalues [1/s], non-oscillating ones included.
    thresholds : tuple of ThresholdSpeed
    """

    choices: dict[str, Any]
    branches: Branches
    sense: Array
    growth: Array
    thresholds: tuple[ThresholdSpeed, ...]

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON: every quantity over speed, branch by branch."""
        found = self.branches
        return {
            "speed": found.parameter,
            "growth_rate": self.growth,
            "branches": [
                {
                    "growth_rate": found.eigenvalues[:, k].real,
                    "damped_frequency": found.damped_frequency[:, k],
                    "damping_ratio": found.damping_ratio[:, k],
                    "log_decrement": found.log_decrement[:, k],
                    "whirl_direction": self.sense[:, k],
                    "whirl": [whirl_word(value) for value in self.sense[:, k]],
                }
                for k in range(found.eigenvalues.shape[1])
            ],
            "smooth": bool(found.smooth.all()),
        }


def whirl_word(sense: float) -> str:
    """``forward``, ``backward`` or ``straight``."""
    return "forward" if sense > FORWARD else "backward" if sense < -FORWARD else "straight"


def campbell_curves(table: CoefficientTable, rotor: RotorOnFilm, modes: int = 8) -> list[Campbell]:
    """Campbell data of `rotor` on every curve of `table`.

    Parameters
    ----------
    table : CoefficientTable
    rotor : RotorOnFilm
    modes : int
        Branches to keep, those of lowest frequency.

    Raises
    ------
    InputError
        A curve has no converged point.
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
        curves.append(_campbell(part, rotor, modes, choices))
    return curves


def _campbell(
    table: CoefficientTable, rotor: RotorOnFilm, modes: int, choices: dict[str, Any]
) -> Campbell:
    every = rotor_modes(table, rotor)
    branches = every.oscillating().lowest(modes)
    return Campbell(
        choices=choices,
        branches=branches,
        sense=branches.whirl_sense(rotor.whirl_planes),
        growth=every.eigenvalues.real.max(axis=1),
        thresholds=tuple(rotor_thresholds(table, rotor)),
    )
