"""First positions for a film that carries nothing over part of the clearance.

A mass-conserving film behind a groove at ambient pressure runs dry wherever the bearing opens from
the groove's edge on: force and stiffness vanish there, and Newton's method has no direction to go.
The force is therefore looked up at positions all over the clearance, on a coarse mesh, and the
search for the equilibrium begins again from those whose force comes nearest to the load.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..model import Case, EccentricityTarget, LoadTarget
from .banded import NoFilmError, SingularFilmError
from .geometry import FilmGeometry
from .layers import isoviscous_layers
from .problem import film_problem, film_state

Array = NDArray[np.float64]
Position = tuple[float, float]

_COARSE = (72, 12)
_ANGLES = 24
_SHARES = (0.2, 0.45, 0.65, 0.8, 0.9, 0.96)
"""Of the way from the centre to the bore, along each angle."""
_TRIALS = 5
_DIRECTION_WEIGHT = 3.0
"""A force a third of a radian off the load line counts as much as one 2.7 times too large."""
_NOTHING = 1e-9
"""Force over load below which Newton's method has no direction to go."""


def first_positions(case: Case, speed: float) -> list[Position]:
    """Return positions [m] from which a search for the equilibrium may begin, the best one first.

    Empty where the film carries nothing at any position of the grid.

    Parameters
    ----------
    case : Case
        Its load or eccentricity ratio, and its isothermal film.
    speed : float
        [rad/s]
    """
    found: list[tuple[float, Position]] = []
    for position, force in _forces(case, speed):
        size = float(np.hypot(*force))
        misfit = _DIRECTION_WEIGHT * math.atan2(-force[1], -force[0])
        if isinstance(case.target, LoadTarget):
            if size < _NOTHING * case.target.load:
                continue
            misfit = math.hypot(misfit, math.log(size / case.target.load))
        if size > 0.0:
            found.append((abs(misfit), position))
    return [position for _, position in sorted(found)[:_TRIALS]]


def _forces(case: Case, speed: float) -> Iterator[tuple[Position, Array]]:
    """Yield positions in the clearance with the isothermal film's force there [N]."""
    mesh = case.film.mesh
    around, along = _COARSE
    coarse = replace(
        mesh,
        circumferential=min(mesh.circumferential, around),
        axial=min(mesh.axial, along),
    )
    case = replace(case, film=replace(case.film, mesh=coarse))
    viscosity = float(case.lubricant.viscosity(case.thermal.supply_temperature))
    for place in _places(case, film_problem(case, speed, case.bearing, (0.0, 0.0)).geometry):
        problem = film_problem(case, speed, case.bearing, place)
        layers = isoviscous_layers(problem.mesh.shape, viscosity)
        with suppress(NoFilmError, SingularFilmError):
            state = film_state(problem, place, layers)
            if state.solution.converged and np.all(np.isfinite(state.force)):
                yield place, state.force


def _places(case: Case, geometry: FilmGeometry) -> Iterator[Position]:
    bearing, target = case.bearing, case.target
    for angle in 2.0 * math.pi / _ANGLES * np.arange(_ANGLES):
        x, y = math.cos(angle), math.sin(angle)
        if isinstance(target, EccentricityTarget):
            size = target.eccentricity_ratio * bearing.radial_clearance
            yield size * x, size * y
            continue
        reach = bearing.radial_clearance
        while reach > 0.0 and geometry.thinnest_at(np.array([reach * x, reach * y])) < 0.0:
            reach -= 0.02 * bearing.radial_clearance
        for share in _SHARES:
            yield share * reach * x, share * reach * y
