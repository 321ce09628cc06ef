"""Sources that displacements of the walls add to the continuity of each cell of a film."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from .flow_law import COUETTE_POWER, POISEUILLE_POWER
from .geometry import CENTER
from .kernels import kernel
from .operator import WEST, StepFaces, neighbour
from .rupture import BorderedFactor

if TYPE_CHECKING:
    from .problem import FilmState


def displacement_sources(state: FilmState, shapes: Array) -> Array:
    """Return what unit displacements add to each cell's continuity [m3/s per m], (q, n, m).

    In cells of grooves, to the balance of oil there (`BorderedFactor`).

    Parameters
    ----------
    state : FilmState
    shapes : (q, 5, n, m) array
        dh/dq, see `Displacements`.
    """
    operator, layers = state.operator, state.layers
    sources = np.zeros((len(shapes), *operator.area.shape))
    rates = np.empty((3, 0, 0)) if layers.rates is None else layers.rates
    factor = state.solution.factor
    returned = factor.returned if isinstance(factor, BorderedFactor) else np.empty((4, 0, 0))
    conductance, couette = operator.conductance, operator.couette
    if operator.steps is not None:
        conductance, couette = conductance.copy(), couette.copy()
        conductance[operator.steps.at] = 0.0
        along = operator.steps.at[0] < 2
        couette[tuple(index[along] for index in operator.steps.at)] = 0.0
        _add_step_sources(state, operator.steps, shapes, sources)
    _sources(
        conductance, operator.interior, operator.fixed_pressure, operator.face_thickness,
        couette, operator.fixed, state.solution.raw, np.ascontiguousarray(shapes), layers.f2,
        layers.f2_axial, layers.g, rates, state.center_thickness, returned, sources,
    )  # fmt: skip
    return sources


def _add_step_sources(state: FilmState, steps: StepFaces, shapes: Array, sources: Array) -> None:
    """Add what displacements change at steps, where either side has its own film thickness."""
    layers, along, pressure = state.layers, steps.at[0] < 2, state.solution.raw
    share, changes = steps.share, []
    for place in (steps.at, steps.beyond):
        at = place[1:]
        moved = shapes[:, 1 + place[0], at[0], at[1]] / state.thickness[1 + place[0], at[0], at[1]]
        conducted, drawn = POISEUILLE_POWER * moved, COUETTE_POWER * moved
        if layers.rates is not None:
            centre = shapes[:, CENTER, at[0], at[1]] / state.center_thickness[at]
            conducted = (
                conducted + np.where(along, layers.rates[0][at], layers.rates[1][at]) * centre
            )
            drawn = drawn + layers.rates[2][at] * centre
        changes.append((conducted, drawn))
    (own, own_drawn), (other, other_drawn) = changes
    driven = steps.conductance * (pressure[steps.beyond[1:]] - pressure[steps.at[1:]])
    change = share * steps.own_couette * own_drawn
    change = change + (1.0 - share) * steps.other_couette * other_drawn
    gain = (steps.own_couette - steps.other_couette) * share * (1.0 - share)
    change = change + gain * (other - own)
    # A ruptured film's Couette flow carries the liquid fraction.
    clipped = tuple(np.where(along, index, 0) for index in steps.at)
    carried = state.operator.couette[clipped] / np.where(along, steps.couette, 1.0)
    inward = np.where(steps.at[0] == WEST, 1.0, -1.0) * along * carried
    total = inward * change + driven * (share * own + (1.0 - share) * other)
    for d in range(len(shapes)):
        np.add.at(sources[d], steps.at[1:], total[d])


@kernel
def _sources(
    conductance, interior, fixed_pressure, face_h, couette, fixed, pressure, shapes, f2, f2_axial,
    g, rates, center_h, returned, sources,
):  # fmt: skip
    n, m = pressure.shape
    varying, bordered = rates.shape[1] > 0, returned.shape[1] > 0
    for i in range(n):
        for j in range(m):
            if fixed[i, j]:
                continue
            for face in range(4):
                k, q = neighbour(face, i, j, n, m)
                joined = interior[face, i, j]
                beyond = pressure[k, q] if joined else fixed_pressure[face, i, j]
                driven = conductance[face, i, j] * (beyond - pressure[i, j])
                carried = 0.0
                if face == 0:
                    carried = couette[0, i, j]
                elif face == 1:
                    carried = -couette[1, i, j]
                rate = (POISEUILLE_POWER * driven + COUETTE_POWER * carried) / face_h[face, i, j]
                for d in range(shapes.shape[0]):
                    change = shapes[d, 1 + face, i, j]
                    if joined:
                        change = 0.5 * (change + shapes[d, 1 + (face ^ 1), k, q])
                    sources[d, i, j] += rate * change
                    if bordered and not joined and returned[face, i, j] != 0.0:
                        sources[d, k, q] -= returned[face, i, j] * rate * change
                if not varying:
                    continue
                # What the flow law changes at both cells behind the face, in their shares.
                mobility = f2 if face < 2 else f2_axial
                law = 0 if face < 2 else 1
                weight, share = 1.0, 1.0
                if joined:
                    weight = mobility[i, j] / (mobility[i, j] + mobility[k, q])
                    share = (1.0 - g[i, j]) / (2.0 - g[i, j] - g[k, q])
                own = weight * driven * rates[law, i, j] + share * carried * rates[2, i, j]
                own /= center_h[i, j]
                other = 0.0
                if joined:
                    other = (1.0 - weight) * driven * rates[law, k, q]
                    other += (1.0 - share) * carried * rates[2, k, q]
                    other /= center_h[k, q]
                for d in range(shapes.shape[0]):
                    sources[d, i, j] += own * shapes[d, 0, i, j] + other * shapes[d, 0, k, q]
                    if bordered and not joined and returned[face, i, j] != 0.0:
                        sources[d, k, q] -= returned[face, i, j] * own * shapes[d, 0, i, j]
