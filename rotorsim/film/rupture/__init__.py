"""Rupture conditions: what happens where the film would pull; each is one object.

`rupture_condition` chooses it by its name, once; whoever needs to know how a film ruptures asks the
object.
"""

from __future__ import annotations

from ...model import Cavitation
from .base import Factor, PressureSolution, RuptureCondition, Terms, solve_any
from .bordered import BorderedFactor, filled_cells
from .mass_conserving import MassConserving
from .recesses import FedFilm, Recesses
from .reynolds import Reynolds
from .sommerfeld import FullSommerfeld, HalfSommerfeld
from .starvation import OilSupply

_CONDITIONS: dict[Cavitation, RuptureCondition] = {
    Cavitation.FULL_SOMMERFELD: FullSommerfeld(),
    Cavitation.HALF_SOMMERFELD: HalfSommerfeld(),
    Cavitation.REYNOLDS: Reynolds(),
    Cavitation.JFO: MassConserving(),
}


def rupture_condition(name: Cavitation, supply: OilSupply | None = None) -> RuptureCondition:
    """Return the rupture condition of that name; under `supply` a film may begin starved."""
    if name is Cavitation.JFO and supply is not None:
        return MassConserving(supply)
    return _CONDITIONS[name]


__all__ = [
    "BorderedFactor", "Factor", "FedFilm", "OilSupply", "PressureSolution", "Recesses",
    "RuptureCondition", "Terms", "filled_cells", "rupture_condition", "solve_any",
]  # fmt: skip
