"""The force of a film that is solved anew at each call, without leaving compiled code.

The same discretisation and rupture conditions as `rotorsim.film.rupture`, by the same kernels, for
what a journal in motion needs most: an aligned or misaligned journal in a rigid bore, laminar flow,
viscosity frozen in space. Orbits call it some hundred times a turn.

A film travels in two plain arrays (`packed_film`). The full cells of one call are where the next
one starts: that saves time and changes nothing, since the complementarity problem has one solution.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numba.np.numpy_support import carray

from ..arrays import Array
from ..compiled import address_of, call_address
from .banded import factor_cells, solve_cells
from .kernels import KERNEL, kernel
from .layers import LayerIntegrals
from .operator import assemble
from .problem import FilmProblem
from .rupture.reynolds import MAX_ACTIVE_SET_STEPS, active_set

REYNOLDS, HALF_SOMMERFELD, FULL_SOMMERFELD = 0, 1, 2
"""Rupture conditions that the kernel knows."""

_DIFFERENCE = 1e-6
"""Of a displacement over the clearance, for the derivative of the cells' continuity."""
_SHAPES, _INTERIOR, _PRESSURE, _SPACING = 5, 15, 19, 23
_FIXED, _AREA, _FULL, _FIELDS = 27, 28, 29, 30
"""Planes of a film's table; three to each viscosity field, from the last on."""
_CONDITION, _COS, _SIN, _LEAST, _REST_X, _REST_Y, _RADIUS, _SHARE = 0, 1, 2, 3, 4, 5, 6, 7
_CLEARANCE, _COUNT, _ADDRESS, _HEAD = 8, 9, 10, 11
"""Places of a film's numbers; from the last on the speeds of the viscosity fields."""


def packed_film(
    problem: FilmProblem,
    fields: Sequence[tuple[float, LayerIntegrals]],
    condition: int,
    frame: float,
    rest: Array,
    least: float,
) -> tuple[Array, Array]:
    """Return numbers (k,) and table (30 + 3 fields, n, m) of a film for `film_at`.

    fields : Speeds [rad/s], ascending, with the integrals across the film there; one field is taken
        at any speed.
    condition : `REYNOLDS`, `HALF_SOMMERFELD` or `FULL_SOMMERFELD`.
    frame : From the frame of the calls to that of the film [rad].
    rest : Position that leaves a film everywhere [m], film frame.
    least : Film thickness to which journals that come closer are pulled back [m].
    """
    topology, geometry, mesh = problem.topology, problem.geometry, problem.mesh
    shapes = geometry.displacements.shapes[:2].reshape(10, *mesh.shape)
    planes = [
        geometry.rest, shapes, topology.interior, topology.fixed_pressure, topology.spacing,
        topology.fixed[None], topology.area[None], ~topology.fixed[None],
    ]  # fmt: skip
    for _, layers in fields:
        planes.append(np.stack([layers.f2, layers.f2_axial, layers.g]))
    head = [
        condition, math.cos(frame), math.sin(frame), least, *rest[:2],
        problem.bearing.journal_radius, geometry.multiplicity, problem.bearing.radial_clearance,
        len(fields), address_of(_film_at, **KERNEL),
    ]  # fmt: skip
    speeds = [speed for speed, _ in fields]
    numbers = np.concatenate([head, speeds, topology.dx, topology.dy])
    return numbers, np.concatenate(planes).astype(float)


@kernel
def _thickness(x, y, table, h):
    """Return the film thickness at the points of the cells; the least of it on the lands."""
    _, n, m = h.shape
    least = np.inf
    for p in range(5):
        for i in range(n):
            for j in range(m):
                value = table[p, i, j]
                value += x * table[_SHAPES + p, i, j] + y * table[_SHAPES + 5 + p, i, j]
                h[p, i, j] = value
                if table[_FIXED, i, j] == 0.0 and value < least:
                    least = value
    return least


@kernel
def _pulled_back(x, y, numbers, table, h):
    """Return the position nearer to that at rest at which the walls keep apart."""
    least = numbers[_LEAST]
    if _thickness(x, y, table, h) >= least:
        return x, y
    x0, y0 = numbers[_REST_X], numbers[_REST_Y]
    rest = np.empty_like(h)
    _thickness(x0, y0, table, rest)
    share = 1.0
    _, n, m = h.shape
    for p in range(5):
        for i in range(n):
            for j in range(m):
                if table[_FIXED, i, j] == 0.0 and h[p, i, j] < least:
                    drop = rest[p, i, j] - h[p, i, j]
                    share = min(share, max((rest[p, i, j] - least) / drop, 0.0))
    x, y = x0 + share * (x - x0), y0 + share * (y - y0)
    _thickness(x, y, table, h)
    return x, y


@kernel
def _layers_at(speed, numbers, table, fields):
    """Fill `fields` with F_2 around and along and G at a speed, linear between the known ones."""
    count = int(numbers[_COUNT])
    k, share = 0, 0.0
    if count > 1:
        while k < count - 2 and speed > numbers[_HEAD + k + 1]:
            k += 1
        low, high = numbers[_HEAD + k], numbers[_HEAD + k + 1]
        share = min(max((speed - low) / (high - low), 0.0), 1.0)
    for p in range(3):
        first = _FIELDS + 3 * k + p
        if share == 0.0:
            fields[p] = table[first]
        else:
            fields[p] = (1.0 - share) * table[first] + share * table[first + 3]


@kernel
def _continuity(h, fields, interior, numbers, table, surface, squeeze, work, source):
    """Assemble the faces into `work` and what flows into each cell at zero pressure."""
    _, n, m = h.shape
    count = int(numbers[_COUNT])
    dx = numbers[_HEAD + count : _HEAD + count + n]
    dy = numbers[_HEAD + count + n : _HEAD + count + n + m]
    conductance, face_thickness, couette = work[:4], work[4:8], work[8:10]
    assemble(
        h[1:], fields[0], fields[1], fields[2], interior, table[_SPACING : _SPACING + 4], dx, dy,
        surface, conductance, face_thickness, couette,
    )  # fmt: skip
    for i in range(n):
        for j in range(m):
            total = 0.0
            if table[_FIXED, i, j] == 0.0:
                total = couette[0, i, j] - couette[1, i, j] - squeeze[i, j] * table[_AREA, i, j]
                for face in range(4):
                    if not interior[face, i, j]:
                        total += conductance[face, i, j] * table[_PRESSURE + face, i, j]
            source[i, j] = total


@kernel
def _inflow(work, interior, source, pressure, full, out):
    """Return what flows into each full cell more than out of it."""
    n, m = pressure.shape
    for i in range(n):
        before = i - 1 if i > 0 else n - 1
        after = i + 1 if i < n - 1 else 0
        for j in range(m):
            total = 0.0
            if full[i, j]:
                total, here = source[i, j], pressure[i, j]
                for face in range(4):
                    there = 0.0
                    if interior[face, i, j]:
                        if face == 0:
                            there = pressure[before, j]
                        elif face == 1:
                            there = pressure[after, j]
                        elif face == 2:
                            there = pressure[i, j - 1]
                        else:
                            there = pressure[i, j + 1]
                    total += work[face, i, j] * (there - here)
            out[i, j] = total


@kernel
def _pressed(work, interior, source, numbers, table):
    """Solve the film under its rupture condition: what `active_set` returns."""
    allowed = table[_FIXED] == 0.0
    if numbers[_CONDITION] == REYNOLDS:
        start = allowed & (table[_FULL] != 0.0)
        return active_set(work[:4], interior, source, allowed, start, MAX_ACTIVE_SET_STEPS)
    band, order, pivot = factor_cells(work[:4], interior, allowed)
    pressure = np.zeros_like(source)
    if pivot == 0:
        pressure = solve_cells(band, order, allowed, source.reshape(1, *source.shape))[0]
    return pressure, allowed, band, order, 1, pivot


@kernel
def _slopes(
    x, y, numbers, table, fields, interior, surface, squeeze, pressure, full, carrying, band, order,
    slopes,
):  # fmt: skip
    """Fill K and C: the pressures that unit displacements and velocities raise on the full cells.

    The faces are assembled at displaced positions, the pressures kept: what then flows in too much
    is what the matrix is solved for, as `rotorsim.film.linearization` does in closed form.
    """
    n, m = pressure.shape
    slopes[:] = 0.0
    if order.size == 0:
        return
    length = _DIFFERENCE * numbers[_CLEARANCE]
    h, work, source = np.empty((5, n, m)), np.empty((10, n, m)), np.empty((n, m))
    right, behind = np.empty((4, n, m)), np.empty((n, m))
    for d in range(2):
        for sign in (1.0, -1.0):
            step = sign * length
            _thickness(x + step if d == 0 else x, y + step if d == 1 else y, table, h)
            _continuity(h, fields, interior, numbers, table, surface, squeeze, work, source)
            _inflow(work, interior, source, pressure, full, right[d] if sign > 0.0 else behind)
        right[d] = (right[d] - behind) / (2.0 * length)
        right[2 + d] = -table[_SHAPES + 5 * d] * table[_AREA]
    raised, film = solve_cells(band, order, full, right), np.zeros((2, 2, 2))
    for k in range(4):
        for i in range(n):
            for j in range(m):
                if carrying[i, j]:
                    load = numbers[_SHARE] * raised[k, i, j] * table[_AREA, i, j]
                    film[k // 2, 0, k % 2] -= load * table[_SHAPES, i, j]
                    film[k // 2, 1, k % 2] -= load * table[_SHAPES + 5, i, j]
    cos, sin = numbers[_COS], numbers[_SIN]
    for k in range(2):
        a, b, c, d = film[k, 0, 0], film[k, 0, 1], film[k, 1, 0], film[k, 1, 1]
        # the turn on both sides
        e, f, g, w = cos * a - sin * c, cos * b - sin * d, sin * a + cos * c, sin * b + cos * d
        slopes[k, 0, 0], slopes[k, 0, 1] = cos * e - sin * f, sin * e + cos * f
        slopes[k, 1, 0], slopes[k, 1, 1] = cos * g - sin * w, sin * g + cos * w


@kernel
def film_at(
    x: float, y: float, vx: float, vy: float, speed: float, numbers: Array, table: Array,
    slopes: Array,
) -> tuple[float, float]:  # fmt: skip
    """Return the film's force on the journal [N]; NaN where it cannot be solved.

    x, y, vx, vy : Position [m] and velocity [m/s]; speed : Of the journal's surface over its radius
        [rad/s].
    numbers, table : See `packed_film`; the table's plane of full cells is written.
    slopes : (2, 2, 2) array: filled with K [N/m] and C [N s/m] there; (0, 2, 2): not asked for.
    """
    planes, n, m = table.shape
    wanted = slopes.shape[0]
    asked = np.array([x, y, vx, vy, speed, numbers.size, planes, n, m, wanted])
    found = np.empty(10)
    call_address(int(numbers[_ADDRESS]), asked.ctypes, numbers.ctypes, table.ctypes, found.ctypes)
    for k in range(wanted):
        for i in range(2):
            for j in range(2):
                slopes[k, i, j] = found[2 + 4 * k + 2 * i + j]
    return found[0], found[1]


def _film_at(asked, numbers, table, found):  # pragma: no cover - compiled
    """Solve the film; the arguments of `film_at` and its results, behind pointers."""
    asked, found = carray(asked, 10), carray(found, 10)
    x, y, vx, vy, speed = asked[0], asked[1], asked[2], asked[3], asked[4]
    n, m = int(asked[7]), int(asked[8])
    numbers = carray(numbers, int(asked[5]))
    table = carray(table, (int(asked[6]), n, m))
    slopes = found[2:].reshape(2, 2, 2)
    cos, sin = numbers[_COS], numbers[_SIN]
    x, y = cos * x + sin * y, cos * y - sin * x
    vx, vy = cos * vx + sin * vy, cos * vy - sin * vx
    h, fields = np.empty((5, n, m)), np.empty((3, n, m))
    x, y = _pulled_back(x, y, numbers, table, h)
    _layers_at(speed, numbers, table, fields)
    interior = np.empty((4, n, m), dtype=np.bool_)
    squeeze = np.empty((n, m))
    for i in range(n):
        for j in range(m):
            squeeze[i, j] = vx * table[_SHAPES, i, j] + vy * table[_SHAPES + 5, i, j]
            for face in range(4):
                interior[face, i, j] = table[_INTERIOR + face, i, j] != 0.0
    work, source = np.empty((10, n, m)), np.empty((n, m))
    surface = speed * numbers[_RADIUS]
    _continuity(h, fields, interior, numbers, table, surface, squeeze, work, source)
    pressure, full, band, order, _, pivot = _pressed(work, interior, source, numbers, table)
    if pivot != 0:
        table[_FULL] = 1.0 - table[_FIXED]
        found[:] = np.nan
        return
    fx, fy, carrying = 0.0, 0.0, full.copy()
    for i in range(n):
        for j in range(m):
            table[_FULL, i, j] = 1.0 if full[i, j] else 0.0
            p = pressure[i, j]
            if numbers[_CONDITION] == HALF_SOMMERFELD and p < 0.0:
                carrying[i, j] = False
                p = 0.0
            if table[_FIXED, i, j] != 0.0:
                p = table[_PRESSURE, i, j]
                pressure[i, j] = p
            load = p * table[_AREA, i, j]
            fx += load * table[_SHAPES, i, j]
            fy += load * table[_SHAPES + 5, i, j]
    share = numbers[_SHARE]
    if asked[9] > 0.0:
        _slopes(
            x, y, numbers, table, fields, interior, surface, squeeze, pressure, full, carrying,
            band, order, slopes,
        )  # fmt: skip
    found[0], found[1] = share * (cos * fx - sin * fy), share * (sin * fx + cos * fy)
