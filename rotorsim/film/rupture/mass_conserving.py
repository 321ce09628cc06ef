"""Mass-conserving rupture (Jakobsson & Floberg 1957, Olsson 1965): pressure and liquid fraction.

Every cell either is full (liquid fraction 1, unknown pressure >= 0) or ruptured (pressure 0,
unknown liquid fraction <= 1); Couette flow carries the liquid fraction of the cell upstream. The
complementarity problem is solved by an active set, each step one banded system in the unknown that
the cell's state leaves open. The same matrix, at the solution, gives the perturbed pressures and
liquid fractions.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import get_lapack_funcs

from ...arrays import Array, Booleans
from ..banded import SingularFilmError, column_order
from ..kernels import kernel
from ..operator import FilmOperator
from .base import Factor, PressureSolution, Terms, with_fixed
from .bordered import BorderedFactor
from .reynolds import Reynolds
from .starvation import OilSupply

_MAX_STEPS = 200

_BAND_SOLVERS = {
    kind: get_lapack_funcs(("gbtrf", "gbtrs"), dtype=kind) for kind in (float, complex)
}


@dataclass(frozen=True)
class MixedFactor:
    """LU factors of the mixed system; `solve` gives pressures in full cells [Pa].

    In ruptured cells the solution is the liquid fraction (or its perturbation).

    matrix : array. Band matrix as LAPACK's gbtrf takes it, real or complex.
    width : Of the band on each side.
    order : (n,) int array. Columns of cells in the order of the band.
    scale : Pressure per unit of the unknown in full cells [Pa].
    full, film : (n, m) bool arrays. Full cells; cells outside the grooves.
    """

    matrix: NDArray[Any]
    width: int
    order: NDArray[np.int64]
    scale: float
    full: Booleans
    film: Booleans
    _factors: tuple[Any, Any] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        factorise, _ = self._solvers
        band, pivots, info = factorise(self.matrix, self.width, self.width)
        if info != 0:
            raise SingularFilmError(f"the ruptured film's matrix is singular (pivot {info})")
        object.__setattr__(self, "_factors", (band, pivots))

    @property
    def _solvers(self):
        return _BAND_SOLVERS[complex if np.iscomplexobj(self.matrix) else float]

    def with_stored_oil(self, rate: NDArray[Any]) -> tuple[MixedFactor, NDArray[Any]]:
        """Factor the system of a motion exp(s t), in which the ruptured cells store oil.

        The liquid fraction crosses a ruptured cell in tau, its volume over the flow through it, so
        that exp(-s tau) of what came in leaves. (All of the cell changing at once, 1 + s tau for
        exp(s tau), would spread out what is carried far.)

        rate : (n, m) complex array. s times the volume of each cell [m3/s].
        Returns MixedFactor:
        Returns (n, m) complex array: Weight of what is added to each cell's continuity: of sources
            spread over a ruptured cell, (exp(s tau) - 1)/(s tau).
        """
        matrix = self.matrix.astype(complex)
        n, m = self.full.shape
        flow = np.empty((n, m))
        flow[self.order] = np.real(self.matrix[2 * self.width]).reshape(n, m)
        moving = self.film & ~self.full & (flow > 0.0) & (rate != 0.0)
        delay = np.divide(rate, flow, out=np.zeros((n, m), dtype=complex), where=moving)
        weight = np.divide(np.expm1(delay), delay, out=np.ones_like(delay), where=moving)
        stored = np.where(moving, rate * weight, 0.0)
        matrix[2 * self.width] += stored[self.order].ravel()
        return replace(self, matrix=matrix), weight

    def solve(self, right: Array) -> NDArray[Any]:
        """Solve for (..., n, m) right-hand sides [m3/s]."""
        n, m = self.full.shape
        flat = np.asarray(right, dtype=float).reshape(-1, n, m)
        packed = flat[:, self.order, :].reshape(flat.shape[0], -1).T
        _, triangular = self._solvers
        band, pivots = self._factors
        solved, info = triangular(band, self.width, self.width, packed, pivots)
        if info != 0:
            raise SingularFilmError(f"band solve failed ({info})")
        result = np.zeros(flat.shape, dtype=solved.dtype)
        result[:, self.order, :] = solved.T.reshape(flat.shape[0], -1, m)
        result = np.where(self.full, result * self.scale, result)
        return result.reshape(np.shape(right))


@dataclass(frozen=True)
class MassConserving:
    """The ruptured film carries on what oil left the full film, and re-forms where it is filled.

    supply : None: openings are full.
    """

    supply: OilSupply | None = None

    conserves_mass: bool = field(default=True, init=False)
    conserves_oil: bool = field(default=True, init=False)

    def solve(self, operator: FilmOperator, terms: Terms) -> tuple[FilmOperator, PressureSolution]:
        """Solve for pressure and liquid fraction; see `RuptureCondition.solve`."""
        return _solve(operator, self.supply, terms)

    def squeezed_area(self, operator: FilmOperator, solution: PressureSolution) -> Array:
        """Return the area that oil fills [m2]: where the film is ruptured, only a part."""
        assert solution.liquid is not None
        return solution.liquid * operator.area

    def dynamic_factor(
        self, factor: Factor, rate: NDArray[Any]
    ) -> tuple[Factor, NDArray[Any] | None]:
        """Return the factor with the oil that the ruptured cells store and give back."""
        if isinstance(factor, BorderedFactor):  # openings store nothing
            film, weight = self.dynamic_factor(factor.film, rate)
            return factor.with_film(film), weight
        assert isinstance(factor, MixedFactor)
        return factor.with_stored_oil(rate)

    def refactor(self, operator: FilmOperator, solution: PressureSolution) -> Factor:
        """Factor the mixed system of `operator` in the state of `solution`."""
        shape = operator.area.shape
        factor, _ = _mixed_system(operator, solution.full, np.zeros(shape), np.ones(shape[0]))
        return factor


def _solve(
    operator: FilmOperator, supply: OilSupply | None, terms: Terms
) -> tuple[FilmOperator, PressureSolution]:
    """Return the pressure and liquid fraction of the operator's film.

    Returns FilmOperator: With the Couette flow scaled by the liquid fraction that it carries.
    Returns PressureSolution: Its `liquid` is the liquid fraction.
    """
    film, frozen = ~operator.fixed, terms.frozen
    if frozen is not None:
        full = frozen
    elif terms.start is None:
        _, guess = Reynolds().solve(operator, Terms(terms.squeeze))
        full = guess.full & film
    else:
        full = terms.start & film
    rate = np.zeros(film.shape) if terms.squeeze is None else terms.squeeze
    seen: set[bytes] = set()
    damped, converged, steps = False, False, 0
    fractions = np.ones(0 if supply is None else supply.flow.size)
    starved = np.zeros(fractions.size, dtype=bool)
    while True:
        filled = np.ones(film.shape[0]) if supply is None else supply.filled(starved)
        factor, right = _mixed_system(operator, full, rate, filled)
        changed = False
        if supply is None:
            unknown = factor.solve(right)
        else:
            factor, unknown, fractions = _supplied(supply, factor, right, operator, full, starved)
            lacking = np.where(starved, fractions <= 1.0 + 1e-12, fractions < 1.0 - 1e-9)
            changed = bool((lacking != starved).any())
            starved = lacking
        steps += 1
        update = np.where(full, unknown > 0.0, unknown > 1.0 + 1e-12) & film
        violations = int((update != full).sum())
        if (violations == 0 or frozen is not None) and not changed:
            converged = True
            break
        if steps >= _MAX_STEPS:
            break
        if frozen is not None:
            continue
        # A set seen before means a cycle: from then on only the worst cells change.
        key = np.packbits(update).tobytes() + np.packbits(starved).tobytes()
        damped = damped or key in seen
        seen.add(key)
        full = _worst_changes(full, update, unknown) if damped else update
    pressure = np.where(full, unknown, 0.0)
    liquid = np.where(full, 1.0, np.maximum(unknown, 0.0))
    liquid[operator.fixed] = 1.0
    pressure = with_fixed(operator, pressure)
    carried = _carried_fraction(operator, liquid)
    if supply is not None:
        fractions = np.minimum(fractions, 1.0)
        entering = supply.carried(fractions)[:, None]
        carried[0] = np.where(operator.interior[0], carried[0], entering)
    solution = PressureSolution(
        pressure=pressure,
        raw=pressure,
        full=full,
        factor=factor,
        steps=steps,
        converged=converged,
        liquid=liquid,
        violations=violations,
        inlet=None if supply is None else fractions,
    )
    return replace(operator, couette=operator.couette * carried), solution


def _supplied(
    supply: OilSupply,
    factor: MixedFactor,
    right: Array,
    operator: FilmOperator,
    full: Booleans,
    starved: Booleans,
) -> tuple[MixedFactor | BorderedFactor, Array, Array]:
    """Return factor, unknowns, and what each opening could fill of its pad's edge."""
    bordered: MixedFactor | BorderedFactor = factor
    found = np.zeros(0)
    if starved.any():
        bordered = supply.bordered(factor, operator, full, starved)
        unknown, found = supply.at_rest(bordered, right, operator, full, starved)
    else:
        unknown = factor.solve(right)
    demand, weights, rest = supply.balance(operator, full)
    fractions = (supply.flow + rest + np.tensordot(weights, unknown, axes=2)) / demand
    fractions[starved] = found
    return bordered, unknown, fractions


def _carried_fraction(operator: FilmOperator, liquid: Array) -> Array:
    """Return liquid fraction carried through the west and east faces, (2, n, m)."""
    west = np.where(operator.interior[0], np.roll(liquid, 1, axis=0), 1.0)
    return np.stack([west, liquid])


def _worst_changes(full: Booleans, update: Booleans, unknown: Array) -> Booleans:
    """Change only the cells that break their bound at least half as badly as the worst does."""
    wrong = update != full
    pressure_scale = max(float(np.abs(np.where(full, unknown, 0.0)).max()), 1e-300)
    size = np.where(full, -unknown / pressure_scale, unknown - 1.0)
    size = np.where(wrong, size, -np.inf)
    chosen = size >= 0.5 * size.max()
    return np.where(chosen, update, full)


def _mixed_system(
    operator: FilmOperator, full: Booleans, rate: Array, filled: Array
) -> tuple[MixedFactor, Array]:
    """Return factor and right-hand side.

    `filled` (n,) is the fraction that enters at open first faces.
    """
    everything = np.ones_like(full)
    order, folded = column_order(operator.interior, everything)
    m = full.shape[1]
    width = min(2 * m if folded else m, order.size * m - 1)
    total = operator.conductance.sum(axis=0)
    scale = float(np.mean(operator.couette)) / float(np.mean(total))
    band = np.zeros((3 * width + 1, order.size * m), order="F")
    position = np.empty(full.shape[0], dtype=np.int64)
    position[order] = np.arange(order.size)
    right = np.zeros(full.shape)
    _fill(
        operator.conductance, operator.interior, operator.fixed_pressure, operator.couette,
        operator.fixed, full, rate * operator.area, filled, order, position, width, scale, band,
        right,
    )  # fmt: skip
    return MixedFactor(band, width, order, scale, full, ~operator.fixed), right


@kernel
def _fill(
    conductance,
    interior,
    fixed_pressure,
    couette,
    fixed,
    full,
    rate,
    filled,
    order,
    position,
    width,
    scale,
    band,
    right,
):
    """Return the rows: inflow into each cell with its sign turned, as right-hand sides are."""
    n, m = full.shape
    for c in range(order.size):
        i = order[c]
        before = i - 1 if i > 0 else n - 1
        after = i + 1 if i < n - 1 else 0
        for j in range(m):
            column = c * m + j
            middle = 2 * width
            if fixed[i, j]:
                band[middle, column] = 1.0
                continue
            # this cell's own unknown, in its own row and in its neighbours'
            if full[i, j]:
                total = 0.0
                for face in range(4):
                    total += conductance[face, i, j]
                band[middle, column] = total * scale
                for face in range(4):
                    if not interior[face, i, j]:
                        continue
                    if face == 0:
                        row = position[before] * m + j
                    elif face == 1:
                        row = position[after] * m + j
                    elif face == 2:
                        row = column - 1
                    else:
                        row = column + 1
                    band[middle + row - column, column] -= conductance[face, i, j] * scale
                right[i, j] -= couette[1, i, j] + rate[i, j]
                if interior[1, i, j]:
                    right[after, j] += couette[0, after, j]
            else:
                # A ring of ruptured cells that nothing feeds runs dry, rather than hold any oil.
                band[middle, column] = couette[1, i, j] * (1.0 + 1e-13) + rate[i, j]
                if interior[1, i, j]:
                    row = position[after] * m + j
                    band[middle + row - column, column] -= couette[0, after, j]
            if not interior[0, i, j]:
                right[i, j] += couette[0, i, j] * filled[i]
            for face in range(4):
                if not interior[face, i, j]:
                    right[i, j] += conductance[face, i, j] * (
                        fixed_pressure[face, i, j]
                        if full[i, j]
                        else max(fixed_pressure[face, i, j], 0.0)
                    )
