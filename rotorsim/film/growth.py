"""The clearance that hot journal, bush and pads leave: the bearing as it grows with its heat.

A bore keeps its shape and its clearance changes; a tilting pad keeps its pivot, its machined and
its assembled clearance change. The rest of the film's solution meets a bearing like any other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..model import Bearing
from ..model.expansion import Expansion
from .banded import NoFilmError
from .geometry import film_geometry

if TYPE_CHECKING:
    from .heat import Heat
    from .problem import FilmProblem
    from .walls import Walls

_LARGEST_CHANGE = 1.4
"""Factor by which one iteration may change the clearance."""
_LEAST_CLEARANCE = 0.02
"""Clearance over the cold one, below which the journal is taken to seize."""
_CLOSED_STEPS = 12
"""Iterations in a row that may close the clearance before the film is given up."""


def hot_clearances(cold: Bearing, expansion: Expansion, shaft: float, bodies: Array) -> Array:
    """Return the clearances that hot solids leave [m], as `clearances` gives them.

    cold : At the reference temperature.
    shaft : Mean temperature of the journal [K].
    bodies : (solids, 2) array. Mean temperature [K] and dT/dr [K/m] of the bush, or of each pad;
        with pads the last row is the ring's that holds them.
    """
    journal = expansion.journal_growth(cold.journal_radius, shaft)
    if not cold.pads:
        bore = expansion.bore_growth(
            cold.journal_radius, cold.bush_outer_radius, cold.length, float(bodies[0, 0])
        )
        return clearances(cold) + bore - journal
    grown = np.full((len(cold.pads), 2), -journal)
    for pad, (mean, gradient), row in zip(cold.pads, bodies[:-1], grown, strict=True):
        row += expansion.pad_growth(cold.journal_radius, pad.thickness, mean, gradient)
        ring = cold.journal_radius + pad.thickness
        row[1] += expansion.ring_growth(ring, float(bodies[-1, 0]))
    return clearances(cold) + grown


def clearances(bearing: Bearing) -> Array:
    """Return the machined and assembled clearance of the bore, or of each pad [m], (solids, 2)."""
    machined, preload = [bearing.radial_clearance], [arc.preload for arc in bearing.arcs]
    preloads = [max(preload, default=0.0)]
    if bearing.pads:
        machined = [bearing.clearance_of(pad) for pad in bearing.pads]
        preloads = [bearing.preload_of(pad) for pad in bearing.pads]
    return np.stack([machined, machined * (1.0 - np.array(preloads))], axis=1)


def with_clearances(cold: Bearing, values: Array) -> Bearing:
    """Return the bearing with other `clearances`; lobes stay displaced as they are.

    Raises NoFilmError: Nothing is left of a clearance.
    """
    if values.min() <= 0.0:
        raise NoFilmError("the hot journal fills the clearance")
    machined, assembled = values[:, 0], values[:, 1]
    if not cold.pads:
        ratio = cold.radial_clearance / float(machined[0])
        arcs = tuple(replace(arc, preload=arc.preload * ratio) for arc in cold.arcs)
        return replace(
            cold, radial_clearance=float(machined[0]), arcs=arcs, profile=None, preload=None,
            offset=None,
        )  # fmt: skip
    pads = tuple(
        replace(pad, clearance=float(c), assembled_clearance=None, preload=float(1.0 - left / c))
        for pad, c, left in zip(cold.pads, machined, assembled, strict=True)
    )
    mean = cold.radial_clearance + float(np.mean(machined - clearances(cold)[:, 0]))
    return replace(cold, radial_clearance=mean, pads=pads)


def hot_problem(problem: FilmProblem, bearing: Bearing) -> FilmProblem:
    """Return the film of the same cells in the hot `bearing`."""
    old, new = problem.geometry, film_geometry(bearing, problem.mesh)
    if old.still is not None:  # pads that stand still keep their film
        new.rest[:, old.still] = old.rest[:, old.still]
        new = replace(new, still=old.still, displacements=old.moving(new.displacements))
    return replace(problem, bearing=bearing, geometry=new)


@dataclass
class Growth:
    """Follows the clearance through a thermal film's iteration, by limited steps.

    lagging : Whether the last film had another clearance than its temperatures ask for.
    """

    cold: Bearing
    expansion: Expansion
    lagging: bool = False
    _closed: int = 0

    def __call__(self, problem: FilmProblem, heat: Heat, walls: Walls) -> FilmProblem:
        """Return the film's problem at the temperatures of `heat`.

        Raises NoFilmError: The clearance stays closed.
        """
        old = clearances(problem.bearing)
        shaft, bodies = walls.shaft_body(heat.shaft), walls.bodies(heat.bush)
        new = hot_clearances(self.cold, self.expansion, shaft, bodies)
        closed = new.min() < _LEAST_CLEARANCE * self.cold.radial_clearance
        self._closed = self._closed + 1 if closed else 0
        if self._closed > _CLOSED_STEPS:
            raise NoFilmError(
                f"the journal, at {shaft - 273.15:.0f} degC, grows until no clearance is left: the "
                "bearing seizes; a larger cold clearance, cooler oil or less speed help"
            )
        change = np.where(new > old, _LARGEST_CHANGE - 1.0, 1.0 - 1.0 / _LARGEST_CHANGE) * old
        share = float(np.min(change / np.maximum(np.abs(new - old), 1e-30)))
        self.lagging = share < 1.0
        if self.lagging:
            new = old + share * (new - old)
        return hot_problem(problem, with_clearances(self.cold, new))
