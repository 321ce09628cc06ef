"""The film at one journal position and one viscosity field."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .cavitation import PressureSolution
from .geometry import Thickness
from .layers import LayerIntegrals
from .operator import FilmOperator

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FilmState:
    """The film at one journal position and one viscosity field.

    Attributes
    ----------
    position : tuple of float
        Journal centre [m], film frame.
    thickness : Thickness
    operator : FilmOperator
    layers : LayerIntegrals
    solution : PressureSolution
    force : (2,) array
        Of the film on the journal [N], film frame.
    """

    position: tuple[float, float]
    thickness: Thickness
    operator: FilmOperator
    layers: LayerIntegrals
    solution: PressureSolution
    force: Array
