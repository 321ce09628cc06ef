"""Bores that give way under pressure: film and shape found together (see docs: theory).

The deflection is linear in the pressure, w = L p. At given displacements of the journal the film's
state is the one that agrees with its own deflection: Newton's method for w - L p(w) = 0, whose
matrix I - L A^-1 B (A the film's matrix, B what a deflection adds to continuity) is met by GMRES
through its products alone. A motion of the journal changes the pressure by the solution of
(A - B L) p = source, the shape following at once; without L the shape is frozen.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..model import Bearing
from ..model.compliance import Diaphragm, ElasticLayer, ThinBush
from .banded import NoFilmError
from .geometry import CENTER
from .mesh import FilmMesh
from .rupture import Factor, filled_cells, solve_any
from .sources import displacement_sources

if TYPE_CHECKING:
    from .problem import FilmState

Field = NDArray[Any]
_TOLERANCE = 1e-11
"""Of the deflection, relative to the thinnest film."""
_LINEAR_TOLERANCE = 1e-10
_ACCEPTED = 1e-3
"""The same, where cells at the edge of the full film come and go."""
_SHARES = (0.25, 0.5, 0.75, 1.0)
_MAX_STEPS = 40
_LARGEST_STEP = 0.5
"""Part of the film's thickness by which one step may change it anywhere."""


@dataclass
class ElasticBore:
    """Compliance of a bore on one mesh.

    compliance : callable. From the pressure (n, m) [Pa] to the deflection, outwards (n, m) [m].
    last : (n, m) array. The deflection found last, where the next search begins.
    """

    mesh: FilmMesh
    compliance: Callable[[Field], Field]
    last: Array = field(init=False)

    def __post_init__(self) -> None:
        self.last = np.zeros(self.mesh.shape)

    def spread(self, deflection: Field) -> Field:
        """Return deflection at cell centres and faces, (5, n, m), straight between the centres."""
        mesh, w = self.mesh, deflection
        size = np.diff(mesh.theta_faces)[:, None]
        before, ahead = np.roll(size, 1, axis=0), np.roll(w, 1, axis=0)
        west = (ahead * size + w * before) / (size + before)
        first = w[:, :1] if mesh.half else _beyond(w[:, :2], mesh.dy[:2])
        between = (w[:, :-1] * mesh.dy[1:] + w[:, 1:] * mesh.dy[:-1]) / (mesh.dy[1:] + mesh.dy[:-1])
        last = _beyond(w[:, :-3:-1], mesh.dy[:-3:-1])
        south = np.concatenate([first, between], axis=1)
        north = np.concatenate([between, last], axis=1)
        return np.stack([w, west, np.roll(west, -1, axis=0), south, north])

    def settle(self, film: Callable[[Array], FilmState]) -> FilmState:
        """Return the film that agrees with its deflection, `film` giving it at any (5, n, m).

        From a rigid bore the compliance is raised by steps: of several shapes that agree, as at the
        free edge of a shell, this is the one that a bore takes as it is loaded.
        """
        state, off = None, 0.0
        if self.last.any():
            with suppress(NoFilmError):  # what was found last may belong to another position
                state, off = self._agreed(film(self.spread(self.last)), film, 1.0)
        if state is None or off > _ACCEPTED:
            state = film(np.zeros((5, *self.mesh.shape)))
            for share in _SHARES:
                state, off = self._agreed(state, film, share)
        self.last = _deflection(state)
        if off > _ACCEPTED:
            return replace(state, solution=replace(state.solution, converged=False))
        return state

    def _agreed(
        self, state: FilmState, film: Callable[[Array], FilmState], share: float
    ) -> tuple[FilmState, float]:
        """Solve by Newton's method with a part of the compliance.

        Returns the state, and its residual over the thinnest film.
        """
        tolerance = _TOLERANCE if share == 1.0 else _ACCEPTED
        missing, off = self._missing(state, share)
        for _ in range(_MAX_STEPS):
            if off <= tolerance:
                break
            step = self._newton(state, missing, share)
            most = float((np.abs(step) / state.center_thickness).max())
            step = step * min(1.0, _LARGEST_STEP / most)
            state = film(self.spread(_deflection(state) + step))
            missing, off = self._missing(state, share)
        return state, off

    def _missing(self, state: FilmState, share: float) -> tuple[Array, float]:
        """Return the deflection that the pressure asks for beyond the state's own.

        Returns also its largest value over the thinnest film.
        """
        missing = share * self.compliance(state.solution.pressure) - _deflection(state)
        return missing, float(np.abs(missing).max()) / state.min_thickness

    def _newton(self, state: FilmState, missing: Array, share: float) -> Array:
        factor = state.solution.factor
        answering = state.solution.carrying | filled_cells(factor)

        def product(flat: Array) -> Array:
            change = flat.reshape(missing.shape)
            pressure = factor.solve(displacement_sources(state, self.spread(change)[None]))[0]
            pressure = np.where(answering, pressure, 0.0)
            return (change - share * self.compliance(pressure)).ravel()

        return _solved(product, missing.ravel()).reshape(missing.shape)

    def followed(
        self,
        state: FilmState,
        factor: Factor,
        pressures: Field,
        rate: complex = 0.0,
        weight: Field | None = None,
    ) -> Field:
        """Return pressures (k, n, m) with the bore giving way to them, moving at `rate` times w.

        pressures : Those of a bore that keeps its shape.
        weight : (n, m) array. Of all that is added to continuity.
        """
        answering = state.solution.carrying | filled_cells(factor)

        def added(pressure: Field) -> Field:
            moved = self.spread(self.compliance(pressure))[None]
            total = displacement_sources(state, np.real(moved))[0].astype(pressure.dtype)
            if np.iscomplexobj(moved):
                total += 1j * displacement_sources(state, np.imag(moved))[0]
            if rate:
                total = total + rate * self.squeezing(state, pressure[None])[0]
            if weight is not None:
                total = total * weight
            return np.where(answering, solve_any(factor, total), 0.0)

        found = []
        for pressure in pressures:
            kind = complex if rate or np.iscomplexobj(pressure) else float

            def product(flat: Field, shape: tuple[int, ...] = pressure.shape) -> Field:
                one = flat.reshape(shape)
                return (one - added(one)).ravel()

            found.append(_solved(product, pressure.ravel().astype(kind)).reshape(pressure.shape))
        return np.stack(found)

    def squeezing(self, state: FilmState, pressures: Field) -> Field:
        """Return what a bore that gives way at the rates of its deflection adds to continuity."""
        area = state.problem.rupture.squeezed_area(state.operator, state.solution)
        open_ = state.operator.fixed & ~filled_cells(state.solution.factor)
        moving = np.where(open_, 0.0, -area)
        return np.stack([moving * self.compliance(one) for one in pressures])


def _beyond(values: Field, sizes: Array) -> Field:
    """Return value (n, 1) at the outer face of the first of two cells.

    Straight on from their centres.
    """
    slope = (values[:, :1] - values[:, 1:2]) / (0.5 * (sizes[0] + sizes[1]))
    return np.asarray(values[:, :1] + 0.5 * sizes[0] * slope)


def _deflection(state: FilmState) -> Array:
    assert state.deflection is not None
    return np.asarray(state.deflection[CENTER])


def _solved(product: Callable[[Field], Field], right: Field) -> Field:
    from scipy.sparse.linalg import LinearOperator, gmres

    linear: Any = LinearOperator
    operator = linear((right.size, right.size), matvec=product, dtype=right.dtype)
    return np.asarray(gmres(operator, right, rtol=_LINEAR_TOLERANCE, restart=80, maxiter=3)[0])


def elastic_bore(bearing: Bearing, mesh: FilmMesh) -> ElasticBore | None:
    """Return how the bearing's bore gives way; None where it does not."""
    given = bearing.compliance
    if isinstance(given, ElasticLayer):
        return ElasticBore(mesh, lambda pressure: given.deflection * pressure)
    if isinstance(given, ThinBush):
        around, along = _ring(given, bearing, mesh), mesh.dy / mesh.dy.sum()
        shape = (1, mesh.shape[1])
        return ElasticBore(mesh, lambda p: np.tile((around @ (p @ along))[:, None], shape))
    if isinstance(given, Diaphragm):
        from .shell import shell_compliance

        cells, matrix = shell_compliance(given, mesh)

        def bent(pressure: Field) -> Field:
            result = np.zeros(pressure.shape, dtype=pressure.dtype)
            result.ravel()[cells] = matrix @ pressure.ravel()[cells]
            return result

        return ElasticBore(mesh, bent)
    return None


def _ring(bush: ThinBush, bearing: Bearing, mesh: FilmMesh) -> Array:
    """Return the deflection of a thin ring on springs per pressure around it [m/Pa], (n, n).

    Its wave n times around costs EI (n^2 - 1)^2/r^4 (it bends without stretching), the even one
    EA/r^2, besides the springs; r is the radius of its middle.
    """
    radius = mesh.radius + 0.5 * bush.thickness
    outer = mesh.radius + bush.thickness
    springs = bush.stiffness / (2.0 * np.pi * outer * bearing.length) * outer / radius
    waves = np.arange(mesh.shape[0] // 2)
    bending = bush.youngs_modulus * bush.thickness**3 / 12.0 / radius**4
    stiffness = springs + bending * (waves**2 - 1.0) ** 2
    stiffness[0] = springs + bush.youngs_modulus * bush.thickness / radius**2
    share = np.where(waves == 0, 0.5, 1.0) / np.pi * (mesh.radius / radius) / stiffness
    apart = mesh.theta[:, None] - mesh.theta
    spread = np.tensordot(share, np.cos(waves[:, None, None] * apart), axes=1)
    return np.asarray(spread * np.diff(mesh.theta_faces))
