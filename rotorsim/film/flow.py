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

from .geometry import Thickness
from .kernels import kernel
from .layers import LayerIntegrals
from .operator import FilmOperator

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
    """

    step: Array
    drive: Array
    drag: Array
    shared: Flags
    inlet: Flags
    flux: Array
    liquid_fraction: Array


def film_flow(
    operator: FilmOperator,
    film: Thickness,
    layers: LayerIntegrals,
    pressure: Array,
    full: Flags,
    surface_speed: float,
) -> FilmFlow:
    """Fluxes of the pressure `pressure`, whose continuity holds in the `full` cells."""
    shape = operator.linked.shape
    step, drive, flux = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    drag = np.zeros((2, *shape[1:]))
    shared = np.zeros(shape, dtype=bool)
    inlet = np.zeros(shape[1:], dtype=bool)
    fraction = np.ones(shape[1:])
    _trace(
        operator.conductance, operator.linked, operator.outer_pressure, operator.face_thickness,
        operator.drag, operator.gap, operator.held, film.center, layers.f2, layers.g, pressure,
        full, surface_speed, operator.dx, operator.dy, step, drive, drag, shared, inlet, flux,
        fraction,
    )  # fmt: skip
    return FilmFlow(step, drive, drag, shared, inlet, flux, fraction)


@kernel
def _trace(
    conductance, linked, outer, face_h, operator_drag, gap, held, h, f2, g, pressure, full, speed,
    dx, dy, steps, drive, drag, shared, inlet, flux, fraction,
):  # fmt: skip
    n, m = full.shape
    for i in range(n):  # pressure-driven part of every face
        before = i - 1 if i > 0 else n - 1
        after = i + 1 if i < n - 1 else 0
        for j in range(m):
            if held[i, j]:
                continue
            for face in range(4):
                sign = 1.0 if face == 1 or face == 3 else -1.0
                width = dy[j] if face < 2 else dx[i]
                if not linked[face, i, j]:
                    other = outer[face, i, j]
                elif face == 0:
                    other = pressure[before, j]
                elif face == 1:
                    other = pressure[after, j]
                elif face == 2:
                    other = pressure[i, j - 1]
                else:
                    other = pressure[i, j + 1]
                step = sign * (other - pressure[i, j])
                steps[face, i, j] = step
                shared[face, i, j] = linked[face, i, j]
                drive[face, i, j] = face_h[face, i, j] ** 3 * step * width / gap[face, i, j]
                flux[face, i, j] = -conductance[face, i, j] * step
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
