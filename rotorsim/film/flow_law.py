"""Flow laws: what a column of oil conducts and how that changes with the film thickness.

Through a face of unit width flow -h^3 F_2 dp/ds and U h (1 - G). A law gives the integrals F_0, F_2
and 1 - G of each column, and how F_2 and 1 - G change with h where they do: in laminar flow they
do not. The faces' part of the change, h^3 and h, is here as well, so that whoever linearises the
film asks this module alone.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .layers import LayerIntegrals

Array = NDArray[np.float64]

POISEUILLE_POWER = 3
"""d ln(flow)/d ln(h) of the Poiseuille part of Dowson's equation at given F_2."""
COUETTE_POWER = 1
"""d ln(flow)/d ln(h) of the Couette part at given G."""


class FlowLaw(Protocol):
    """A law of flow across the film."""

    name: str

    def integrals(
        self, layers: LayerIntegrals, thickness: Array, surface_speed: float
    ) -> LayerIntegrals:
        """Integrals of every column under this law.

        Parameters
        ----------
        layers : LayerIntegrals
            Of laminar flow with the same viscosity.
        thickness : (n, m) array
            At cell centres [m].
        surface_speed : float
            [m/s]

        Returns
        -------
        LayerIntegrals
            With `LayerIntegrals.rates` where they change with the film thickness.
        """
        ...


class _LaminarFlow:
    """Integrals that do not depend on the film thickness."""

    name: str = "laminar"

    def integrals(
        self, layers: LayerIntegrals, thickness: Array, surface_speed: float
    ) -> LayerIntegrals:
        """Return `layers`, as they are."""
        del thickness, surface_speed
        return layers


_LAWS: dict[str, FlowLaw] = {law.name: law for law in (_LaminarFlow(),)}


def flow_law(name: str) -> FlowLaw:
    """Return the law of that name."""
    return _LAWS[name]
