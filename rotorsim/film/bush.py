"""Heat conduction in the bush (Dal Eq. 16 and its boundary conditions)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .energy import EnergyProblem
from .problem import FilmProblem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BushConduction:
    """placeholder until conduction lands."""

    @classmethod
    def of(cls, problem: FilmProblem) -> BushConduction:
        raise NotImplementedError

    def respond(self, heat: Array, bore: Array, energy: EnergyProblem) -> Array:
        raise NotImplementedError
