"""Stiffness with the temperature following the displacement (quasi-static).

The field's habit is to freeze the viscosity while the journal moves, since oil and walls need far
longer than a turn to change their temperature. The other limit, a displacement so slow that the
film is always in thermal equilibrium, is what static load tests measure.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .problem import FilmProblem
from .thd import ThermalFilm, solve_thermal_film

Array = NDArray[np.float64]

RELATIVE_STEP = 2e-3
"""Displacement, relative to the thinnest film."""
STEP_TOLERANCE = 1e-9
"""Change of log viscosity at which a displaced film counts as converged."""


def following_stiffness(problem: FilmProblem, film: ThermalFilm) -> tuple[Array, bool]:
    """K_ij = -dF_i/dx_j [N/m], (2, 2), film frame, by central differences of converged films.

    The mesh stays where it is and every cell keeps its state (full or ruptured), as they do in the
    linearised film.

    Returns
    -------
    (2, 2) array
    bool
        Whether all four displaced films converged.
    """
    x, y = film.state.position
    step = RELATIVE_STEP * film.state.thickness.minimum(~film.state.operator.fixed)
    shifts = ((step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step))
    films = [
        solve_thermal_film(
            problem,
            (x + dx, y + dy),
            initial=replace(film.heat, temperature=film.heat.temperature.copy()),
            full=film.state.solution.full,
            tolerance=STEP_TOLERANCE,
        )
        for dx, dy in shifts
    ]
    forces = [displaced.state.force for displaced in films]
    columns = [(forces[1] - forces[0]) / (2.0 * step), (forces[3] - forces[2]) / (2.0 * step)]
    return np.stack(columns, axis=1), all(displaced.converged for displaced in films)
