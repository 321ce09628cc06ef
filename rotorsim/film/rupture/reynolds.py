"""Reynolds' (Swift-Stieber) rupture condition, a linear complementarity problem.

p >= 0, and where p = 0 the film may not be pushed: the primal-dual active set (a semi-smooth Newton
method: Hintermueller, Ito & Kunisch, SIAM J. Optim. 13, 2002) ends after finitely many steps, since
the matrix is an M-matrix.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import Array, Booleans, Indices
from ...threads import one_blas_thread
from ..banded import (
    FilmFactor,
    SingularFilmError,
    factor_cells,
    factor_operator,
    solve_cells,
)
from ..kernels import kernel
from ..operator import FilmOperator, neighbour
from .base import ConnectedFilm, PressureSolution, Terms, source_term, with_fixed

MAX_ACTIVE_SET_STEPS = 400
_PATIENCE = 3
"""Linear solves from a neighbouring film, before a coarser mesh is asked where the film is full."""
_COARSEST = 16
"""Cells around below which no coarser mesh is used for the first guess."""


class Reynolds(ConnectedFilm):
    """The film ruptures where both the pressure and its gradient vanish.

    Under `Terms.region` each line along the film keeps one full stretch per region besides those
    fed by a groove: a ruptured film then stays ruptured up to the next inception.
    Thermal films need it, since the derivative of F1/F0 could otherwise re-form film inside the
    ruptured sector.
    """

    conserves_oil: bool = True

    def solve(self, operator: FilmOperator, terms: Terms) -> tuple[FilmOperator, PressureSolution]:
        """Solve the complementarity problem; see `RuptureCondition.solve`."""
        source, region = source_term(operator, terms.squeeze), terms.region
        film = ~operator.fixed
        if terms.frozen is not None:
            return operator, _on_frozen_set(operator, source, terms.frozen)
        solution = _active_set(operator, source, film, terms.start)
        if region is None:
            return operator, solution
        allowed = film.copy()
        _one_stretch(solution.pressure, operator.fixed, operator.interior[0], region, allowed)
        if (solution.full & ~allowed).any():
            again = _active_set(operator, source, allowed, solution.full & allowed)
            return operator, replace(again, steps=solution.steps + again.steps)
        return operator, solution


def _coarse_guess(
    conductance: Array, interior: Booleans, fixed: Booleans, source: Array
) -> Booleans:
    """Return full cells of the same film on a mesh twice as coarse, itself begun on a coarser one.

    The active set moves by about a cell a step, so that without this the number of steps would grow
    with the mesh.
    """
    n, m = source.shape
    if n < 2 * _COARSEST or m < 4:
        return ~fixed
    coarse = _coarsened(conductance, interior, fixed, source)
    film = ~coarse[2]
    if not film.any():  # lands of one cell between grooves
        return ~fixed
    guess = _coarse_guess(*coarse) & film
    _, full, *_ = active_set(coarse[0], coarse[1], coarse[3], film, guess, MAX_ACTIVE_SET_STEPS)
    return full[_group(np.arange(n), n)][:, _group(np.arange(m), m)]


@kernel
def _group(i, n):
    """Return the pair of n cells that cell i belongs to; the last of an odd number are three."""
    return np.minimum(i // 2, n // 2 - 1)


@kernel
def _coarsened(conductance, interior, fixed, source):
    """Return the film's faces, fixed cells and sources on pairs of cells.

    Faces in a row carry together, over twice the distance.
    """
    n, m = source.shape
    rows, columns = n // 2, m // 2
    carried, joined = np.zeros((4, rows, columns)), np.ones((4, rows, columns), dtype=np.bool_)
    held, flow = np.zeros((rows, columns), dtype=np.bool_), np.zeros((rows, columns))
    for i in range(n):
        k = _group(i, n)
        for j in range(m):
            q = _group(j, m)
            flow[k, q] += source[i, j]
            held[k, q] = held[k, q] or fixed[i, j]
            for face in range(4):
                a, b = neighbour(face, i, j, n, m)
                at_end = (face == 2 and j == 0) or (face == 3 and j == m - 1)
                if at_end or _group(a, n) != k or _group(b, m) != q:
                    carried[face, k, q] += 0.5 * conductance[face, i, j]
                    joined[face, k, q] = joined[face, k, q] and interior[face, i, j]
    for k in range(rows):
        for q in range(columns):
            for face in range(4):
                a, b = neighbour(face, k, q, rows, columns)
                if held[k, q] or held[a, b]:
                    joined[face, k, q] = False
    return carried, joined, held, flow


def _active_set(
    operator: FilmOperator, source: Array, allowed: Booleans, start: Booleans | None
) -> PressureSolution:
    conductance, interior = operator.conductance, operator.interior
    with one_blas_thread():
        known = start is not None
        if start is None:
            start = _coarse_guess(conductance, interior, operator.fixed, source)
        patience = _PATIENCE if known else MAX_ACTIVE_SET_STEPS
        found = active_set(conductance, interior, source, allowed, start & allowed, patience)
        if found[-1] < 0 and known:  # far from the film that it started from
            start = _coarse_guess(conductance, interior, operator.fixed, source)
            found = active_set(
                conductance, interior, source, allowed, start & allowed, MAX_ACTIVE_SET_STEPS
            )
    pressure, full, band, order, steps, pivot = found
    if pivot > 0:
        raise SingularFilmError.at(pivot)
    factor = FilmFactor(band, order, full)
    if not full.any():
        # No cell is pushed: the whole film is ruptured, which is the solution.
        factor = factor_operator(operator, ~operator.fixed)
    pressure = with_fixed(operator, pressure)
    return PressureSolution(pressure, pressure, full, factor, steps, pivot == 0)


@kernel
def active_set(
    conductance: Array,
    interior: Booleans,
    source: Array,
    allowed: Booleans,
    start: Booleans,
    patience: int,
) -> tuple[Array, Booleans, Array, Indices, int, int]:
    """Find the cells that are full: p >= 0 there, and oil is drawn away from all others.

    start : Cells tried first; patience : Linear solves.
    Returns pressure and full cells, their factored band and its order, the linear solves, and 0;
    the bad pivot of a film without a solution; -1 where the cells did not settle.
    """
    n, m = source.shape
    full, update = np.empty((n, m), dtype=np.bool_), np.empty((n, m), dtype=np.bool_)
    pressure, right = np.zeros((n, m)), np.empty((1, n, m))
    scale, count, steps = 0.0, 0, 0
    for i in range(n):
        for j in range(m):
            scale = max(scale, abs(source[i, j]))
            right[0, i, j], full[i, j] = source[i, j], start[i, j]
            count += start[i, j]
    if count == 0:
        for i in range(n):
            for j in range(m):
                full[i, j] = allowed[i, j] and source[i, j] > 0.0
                count += full[i, j]
    band, order = np.empty((0, 1)), np.empty(0, dtype=np.int64)
    while count > 0 and steps < patience:
        band, order, pivot = factor_cells(conductance, interior, full)
        if pivot != 0:
            return pressure, full, band, order, steps, pivot
        pressure = solve_cells(band, order, full, right)[0]
        steps += 1
        changed = _update_set(
            conductance, interior, source, pressure, full, allowed, 1e-13 * scale, update
        )
        if changed == 0:
            return pressure, full, band, order, steps, 0
        count = 0
        for i in range(n):
            for j in range(m):
                full[i, j] = update[i, j]
                count += update[i, j]
    if count == 0:
        for i in range(n):
            for j in range(m):
                pressure[i, j] = 0.0
        return pressure, full, band, order, steps, 0
    return pressure, full, band, order, steps, -1


def _on_frozen_set(operator: FilmOperator, source: Array, full: Booleans) -> PressureSolution:
    factor = factor_operator(operator, full)
    pressure = factor.solve(source)
    update = np.empty_like(full)
    tolerance = 1e-13 * float(np.abs(source).max())
    violations = _update_set(
        operator.conductance, operator.interior, source, pressure, full, full, tolerance, update
    )
    raw = with_fixed(operator, pressure)
    return PressureSolution(raw, raw, full, factor, 1, True, violations=int(violations))


@kernel
def _update_set(conductance, interior, source, pressure, full, allowed, tolerance, update):
    """Guess the full cells anew; return how many changed."""
    n, m = full.shape
    changed = 0
    for i in range(n):
        before = i - 1 if i > 0 else n - 1
        after = i + 1 if i < n - 1 else 0
        for j in range(m):
            if full[i, j]:
                keep = pressure[i, j] > 0.0
            elif not allowed[i, j]:
                keep = False
            else:
                inflow = source[i, j]
                if interior[0, i, j]:
                    inflow += conductance[0, i, j] * pressure[before, j]
                if interior[1, i, j]:
                    inflow += conductance[1, i, j] * pressure[after, j]
                if interior[2, i, j]:
                    inflow += conductance[2, i, j] * pressure[i, j - 1]
                if interior[3, i, j]:
                    inflow += conductance[3, i, j] * pressure[i, j + 1]
                keep = inflow > tolerance
            update[i, j] = keep
            if keep != full[i, j]:
                changed += 1
    return changed


@kernel
def _one_stretch(pressure, fixed, joined, region, allowed):
    """Forbid, on each line and in each region, full stretches other than the one with the peak.

    A stretch that begins at a groove, or touches one under pressure, is fed by it and stays, and so
    does one that goes on into the next lobe.
    """
    n, m = pressure.shape
    first = 0
    for i in range(n):  # start where a region starts, so that none is cut by the array's end
        if region[i] != region[i - 1]:
            first = i
            break
    for j in range(m):
        offset = 0
        while offset < n:
            i0 = (first + offset) % n
            length = 1
            while offset + length < n and region[(first + offset + length) % n] == region[i0]:
                length += 1
            if region[i0] >= 0:
                _keep_peak(pressure, fixed, joined, allowed, first + offset, length, j)
            offset += length


@kernel
def _keep_peak(pressure, fixed, joined, allowed, start, length, j):
    n = pressure.shape[0]
    peak, at = 0.0, -1
    for s in range(length):
        i = (start + s) % n
        if not fixed[i, j] and pressure[i, j] > peak:
            peak, at = pressure[i, j], s
    if at < 0:
        return
    lower, upper = at, at
    while lower > 0 and pressure[(start + lower - 1) % n, j] > 0.0:
        lower -= 1
    while upper < length - 1 and pressure[(start + upper + 1) % n, j] > 0.0:
        upper += 1
    s = 0
    while s < length:
        i = (start + s) % n
        if pressure[i, j] <= 0.0 or (lower <= s <= upper):
            s += 1
            continue
        end, fed = s, False
        while end < length and pressure[(start + end) % n, j] > 0.0:
            fed = fed or fixed[(start + end) % n, j]
            end += 1
        before, behind = (start + s - 1) % n, (start + end) % n
        first, last = s == 0, end == length
        fed = fed or (first and joined[i, j] and pressure[before, j] > 0.0)
        fed = fed or (last and joined[behind, j] and pressure[behind, j] > 0.0)
        fed = fed or fixed[before, j]
        fed = fed or (fixed[behind, j] and pressure[behind, j] > 0.0)
        if not fed:
            for t in range(s, end):
                allowed[(start + t) % n, j] = False
        s = end
