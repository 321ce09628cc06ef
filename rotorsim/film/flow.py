"""Volume fluxes through every face, and the liquid that a ruptured film still carries.

A flux is written as ``g a_k + c b_k`` layer by layer (see `film.layers`): g = h^3 dp/ds (face
length) multiplies the Poiseuille part, c = U h (face length) the Couette part. A ruptured column
passes on all that enters it as Couette flow alone: c is scaled so that the oil which left the full
film is neither lost nor gained, and the liquid fraction is what this oil fills of the film.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Booleans
from .kernels import kernel
from .layers import LayerIntegrals
from .operator import FilmOperator, neighbour
from .problem import FilmState


@dataclass(frozen=True)
class FilmFlow:
    """Faces in the order west, east, south, north, as seen from each cell.

    step : (4, n, m) array. Pressure difference across each face's spacing, along +theta or +y [Pa].
    poiseuille : (4, n, m) array. g [N m]: h^3 times the pressure gradient times the face length,
        along +theta or +y.
    couette : (2, n, m) array. c [m3/s] on west and east faces.
    shared : (4, n, m) bool array. Layer shares are the mean of both cells behind the face; else the
        cell's own.
    inlet : (n, m) bool array. Oil enters through the west face from a groove, a slot or a re-formed
        film's make-up, not from the cell before.
    flux : (4, n, m) array. Volume fluxes [m3/s] along +theta or +y.
    liquid_fraction : (n, m) array. 1 in the full film.
    fresh_fraction : (n, m) array. Part of the oil in each cell that came in through an inlet. Where
        a film re-forms the rupture models without conservation of mass add what is missing; it must
        not reach a groove as hot oil.
    """

    step: Array
    poiseuille: Array
    couette: Array
    shared: Booleans
    inlet: Booleans
    flux: Array
    liquid_fraction: Array
    fresh_fraction: Array


def film_flow(state: FilmState) -> FilmFlow:
    """Return the fluxes through every face of the film `state`."""
    surface_speed = state.problem.surface_speed
    operator, layers, solution = state.operator, state.layers, state.solution
    shape = operator.interior.shape
    step, poiseuille, flux = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    couette = np.zeros((2, *shape[1:]))
    shared = np.zeros(shape, dtype=bool)
    inlet = np.zeros(shape[1:], dtype=bool)
    _pressure_part(
        operator.conductance, operator.interior, operator.fixed_pressure, operator.face_thickness,
        operator.spacing, operator.fixed, solution.full, solution.raw, operator.dx, operator.dy,
        step, poiseuille, shared, flux,
    )  # fmt: skip
    if state.problem.rupture.conserves_mass:
        # Its Couette flow carries the liquid fraction.
        assert solution.liquid is not None
        film = ~operator.fixed
        couette = _couette_multiplier(operator, layers) * film
        flux[:2] += operator.couette * film
        inlet = ~operator.interior[0] & film
        everything = np.ones(shape[1:])
        return FilmFlow(step, poiseuille, couette, shared, inlet, flux, solution.liquid, everything)
    fraction, fresh_fraction = np.ones(shape[1:]), np.ones(shape[1:])
    _carry(
        operator.interior, operator.couette, operator.fixed,
        state.center_thickness, layers.g, solution.full, surface_speed, operator.dy,
        poiseuille, couette, shared, inlet, flux, fraction, fresh_fraction,
    )  # fmt: skip
    return FilmFlow(step, poiseuille, couette, shared, inlet, flux, fraction, fresh_fraction)


def _couette_multiplier(operator: FilmOperator, layers: LayerIntegrals) -> Array:
    """Return drag of the west and east faces over the shear shares that it is spread on.

    Their c.
    """
    share = 1.0 - layers.g
    beside = np.stack([np.roll(share, 1, axis=0), np.roll(share, -1, axis=0)])
    return operator.couette / np.where(operator.interior[:2], 0.5 * (share + beside), share)


@kernel
def _pressure_part(
    conductance, interior, fixed_pressure, face_h, spacing, fixed, full, pressure, dx, dy, steps,
    poiseuille, shared, flux,
):  # fmt: skip
    n, m = pressure.shape
    for i in range(n):  # pressure-driven part of every face
        for j in range(m):
            if fixed[i, j]:
                continue
            for face in range(4):
                sign = 1.0 if face == 1 or face == 3 else -1.0
                width = dy[j] if face < 2 else dx[i]
                k, q = neighbour(face, i, j, n, m)
                if not interior[face, i, j]:
                    inside = pressure[i, j] if full[i, j] else 0.0
                    step = sign * (fixed_pressure[face, i, j] - inside)
                elif full[i, j] or full[k, q]:
                    step = sign * (pressure[k, q] - pressure[i, j])
                else:
                    step = 0.0
                steps[face, i, j] = step
                shared[face, i, j] = interior[face, i, j]
                poiseuille[face, i, j] = (
                    face_h[face, i, j] ** 3 * step * width / spacing[face, i, j]
                )
                flux[face, i, j] = -conductance[face, i, j] * step


@kernel
def _carry(
    interior, operator_couette, fixed, h, g, full, speed, dy, poiseuille, couette, shared,
    inlet, flux, fraction, fresh_fraction,
):  # fmt: skip
    n, m = full.shape
    for j in range(m):
        start = 0
        for i in range(n):  # begin where what enters is known
            if full[i, j] or not interior[0, i, j]:
                start = i
                break
        for s in range(n):
            i = (start + s) % n
            if fixed[i, j]:
                continue
            before = i - 1 if i > 0 else n - 1
            carried = interior[0, i, j] and not full[before, j] and not fixed[before, j]
            if carried and not full[i, j] and s > 0:
                poiseuille[0, i, j] = 0.0
                couette[0, i, j] = couette[1, before, j]
                flux[0, i, j] = flux[1, before, j]
                shared[0, i, j] = False  # the column before passes on its own profile
            else:
                inlet[i, j] = carried or not interior[0, i, j]
                open_share = 1.0 - g[i, j]
                if interior[0, i, j]:
                    open_share = 0.5 * (open_share + 1.0 - g[before, j])
                couette[0, i, j] = operator_couette[0, i, j] / open_share
                flux[0, i, j] += operator_couette[0, i, j]
            if interior[0, i, j] and s > 0:
                fresh_fraction[i, j] = fresh_fraction[before, j]
                if carried and full[i, j] and flux[0, i, j] > flux[1, before, j]:
                    fresh_fraction[i, j] *= flux[1, before, j] / flux[0, i, j]
            if full[i, j]:
                open_share = 1.0 - g[i, j]
                if interior[1, i, j]:
                    open_share = 0.5 * (open_share + 1.0 - g[i + 1 if i < n - 1 else 0, j])
                couette[1, i, j] = operator_couette[1, i, j] / open_share
                flux[1, i, j] += operator_couette[1, i, j]
                continue
            through = flux[0, i, j] + flux[2, i, j] - flux[3, i, j]
            through = max(through, 0.0)
            poiseuille[1, i, j] = 0.0
            shared[1, i, j] = False
            flux[1, i, j] = through
            couette[1, i, j] = through / (1.0 - g[i, j])
            filled = speed * h[i, j] * (1.0 - g[i, j]) * dy[j]
            share = 0.5 * (through + flux[0, i, j]) / filled if filled > 0.0 else 1.0
            fraction[i, j] = min(max(share, 0.0), 1.0)
