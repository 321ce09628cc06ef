"""Volume fluxes through every face, and the liquid that a ruptured film still carries.

A flux is written as ``g a_k + c b_k`` layer by layer (see `film.layers`): g = h^3 dp/ds (face
length) drives, c = U h (face length) drags. A ruptured column passes on all that enters it as drag
alone: c is scaled so that the oil which left the full film is neither lost nor gained, and the
liquid fraction is what this oil fills of the gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .kernels import kernel
from .layers import LayerIntegrals
from .operator import FilmOperator, neighbour
from .state import FilmState

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class FilmFlow:
    """Faces in the order west, east, south, north, as seen from each cell.

    Attributes
    ----------
    step : (4, n, m) array
        Pressure difference across each face's gap, along +theta or +y [Pa].
    drive : (4, n, m) array
        g [N m]: h^3 times the pressure gradient times the face length, along +theta or +y.
    drag : (2, n, m) array
        c [m3/s] on west and east faces.
    shared : (4, n, m) bool array
        Layer shares are the mean of both cells behind the face; else the cell's own.
    inlet : (n, m) bool array
        Oil enters through the west face from a groove, a slot or a re-formed film's make-up, not
        from the cell before.
    flux : (4, n, m) array
        Volume fluxes [m3/s] along +theta or +y.
    liquid_fraction : (n, m) array
        1 in the full film.
    brought : (n, m) array
        Part of the oil in each cell that came in through an inlet. Where a film re-forms the
        rupture models without conservation of mass add what is missing; it must not reach a
        groove as hot oil.
    """

    step: Array
    drive: Array
    drag: Array
    shared: Flags
    inlet: Flags
    flux: Array
    liquid_fraction: Array
    brought: Array


def film_flow(state: FilmState, surface_speed: float) -> FilmFlow:
    """Fluxes of the film `state`."""
    operator, layers, solution = state.operator, state.layers, state.solution
    shape = operator.linked.shape
    step, drive, flux = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    drag = np.zeros((2, *shape[1:]))
    shared = np.zeros(shape, dtype=bool)
    inlet = np.zeros(shape[1:], dtype=bool)
    _pressure_part(
        operator.conductance, operator.linked, operator.outer_pressure, operator.face_thickness,
        operator.gap, operator.held, solution.full, solution.raw, operator.dx, operator.dy, step,
        drive, shared, flux,
    )  # fmt: skip
    if solution.liquid is not None:
        # The rupture model conserves oil by itself: drag carries its liquid fraction everywhere.
        film = ~operator.held
        drag = _drag_multiplier(operator, layers) * film
        flux[:2] += operator.drag * film
        inlet = ~operator.linked[0] & film
        everything = np.ones(shape[1:])
        return FilmFlow(step, drive, drag, shared, inlet, flux, solution.liquid, everything)
    fraction, brought = np.ones(shape[1:]), np.ones(shape[1:])
    _carry(
        operator.linked, operator.face_thickness, operator.drag, operator.held,
        state.thickness.center, layers.g, solution.full, surface_speed, operator.dy, drive, drag,
        shared, inlet, flux, fraction, brought,
    )  # fmt: skip
    return FilmFlow(step, drive, drag, shared, inlet, flux, fraction, brought)


def _drag_multiplier(operator: FilmOperator, layers: LayerIntegrals) -> Array:
    """Drag of the west and east faces over the shear shares that it is spread on: their c."""
    share = 1.0 - layers.g
    beside = np.stack([np.roll(share, 1, axis=0), np.roll(share, -1, axis=0)])
    return operator.drag / np.where(operator.linked[:2], 0.5 * (share + beside), share)


@kernel
def _pressure_part(
    conductance, linked, outer, face_h, gap, held, full, pressure, dx, dy, steps, drive, shared,
    flux,
):  # fmt: skip
    n, m = pressure.shape
    for i in range(n):  # pressure-driven part of every face
        for j in range(m):
            if held[i, j]:
                continue
            for face in range(4):
                sign = 1.0 if face == 1 or face == 3 else -1.0
                width = dy[j] if face < 2 else dx[i]
                k, q = neighbour(face, i, j, n, m)
                if not linked[face, i, j]:
                    inside = pressure[i, j] if full[i, j] else 0.0
                    step = sign * (outer[face, i, j] - inside)
                elif full[i, j] or full[k, q]:
                    step = sign * (pressure[k, q] - pressure[i, j])
                else:
                    step = 0.0
                steps[face, i, j] = step
                shared[face, i, j] = linked[face, i, j]
                drive[face, i, j] = face_h[face, i, j] ** 3 * step * width / gap[face, i, j]
                flux[face, i, j] = -conductance[face, i, j] * step


@kernel
def _carry(
    linked, face_h, operator_drag, held, h, g, full, speed, dy, drive, drag, shared, inlet, flux,
    fraction, brought,
):  # fmt: skip
    n, m = full.shape
    for j in range(m):
        start = 0
        for i in range(n):  # begin where what enters is known
            if full[i, j] or not linked[0, i, j]:
                start = i
                break
        for s in range(n):
            i = (start + s) % n
            if held[i, j]:
                continue
            before = i - 1 if i > 0 else n - 1
            carried = linked[0, i, j] and not full[before, j] and not held[before, j]
            if carried and not full[i, j] and s > 0:
                drive[0, i, j] = 0.0
                drag[0, i, j] = drag[1, before, j]
                flux[0, i, j] = flux[1, before, j]
                shared[0, i, j] = False  # the column before passes on its own profile
            else:
                inlet[i, j] = carried or not linked[0, i, j]
                drag[0, i, j] = speed * face_h[0, i, j] * dy[j]
                flux[0, i, j] += operator_drag[0, i, j]
            if linked[0, i, j] and s > 0:
                brought[i, j] = brought[before, j]
                if carried and full[i, j] and flux[0, i, j] > flux[1, before, j]:
                    brought[i, j] *= flux[1, before, j] / flux[0, i, j]
            if full[i, j]:
                drag[1, i, j] = speed * face_h[1, i, j] * dy[j]
                flux[1, i, j] += operator_drag[1, i, j]
                continue
            through = flux[0, i, j] + flux[2, i, j] - flux[3, i, j]
            through = max(through, 0.0)
            drive[1, i, j] = 0.0
            shared[1, i, j] = False
            flux[1, i, j] = through
            drag[1, i, j] = through / (1.0 - g[i, j])
            filled = speed * h[i, j] * (1.0 - g[i, j]) * dy[j]
            share = 0.5 * (through + flux[0, i, j]) / filled if filled > 0.0 else 1.0
            fraction[i, j] = min(max(share, 0.0), 1.0)
