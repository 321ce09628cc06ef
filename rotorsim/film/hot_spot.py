"""Heat that a film gives to one side of a journal which whirls once a revolution (Morton effect).

The same side of such a journal always meets the thin film. Everything of first order varies as
exp(i Omega t), with the journal's surface, whose temperature Re[T exp(-i phi)] turns with it. The
film's temperature tau therefore solves one complex, linear energy equation about the steady film:

    rho c_p (i Omega tau + u . grad tau) - d/dz (k dtau/dz) = what motion and viscosity change

tau is T exp(-i theta) on the journal and 0 on the bush, which is slow to follow. What motions
change is taken from the steady equation's own residual, by differences; the viscosity follows tau,
and moves pressure, flow and dissipation. Of the heat that reaches the journal, exp(-i theta) alone
stands still on it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, ComplexArray
from .energy import WallTemperatures, march, missing_heat
from .geometry import CENTER
from .heat import energy_problem
from .layers import layer_integrals
from .problem import FilmState, film_state
from .thd import ThermalFilm

_RELATIVE_STEP = 1e-3
"""Displacement in differences, relative to the thinnest film."""
_WARMING = 0.05
"""Largest change of temperature in differences over the viscosity [K]."""
_PASSES = 200
_MARCH_TOLERANCE = 1e-9
_TOLERANCE = 1e-4


@dataclass(frozen=True)
class SpotHeat:
    """First harmonic of the heat flux into the journal, standing still on it: Re[F exp(-i phi)].

    Averaged over the bearing's length and the whole turn, grooves included.

    by_motion : (q,) complex array. F of motions Re[q exp(i Omega t)], film frame [W/m^2 per m].
    by_temperature : F of a surface temperature Re[T exp(-i phi)], turning with the journal
        [W/(m^2 K)].
    """

    by_motion: ComplexArray
    by_temperature: complex


def spot_heat(film: ThermalFilm) -> SpotHeat:
    """Return how a steady film heats one side of its journal."""
    return _Harmonic(film).answer()


class _Harmonic:
    """The linear film about a steady one."""

    def __init__(self, film: ThermalFilm) -> None:
        self.film, self.state, self.problem = film, film.state, film.state.problem
        heat, energy = film.heat, film.energy
        self.walls = WallTemperatures(heat.bush, heat.shaft, film.walls.bush.insulated)
        self.shape = heat.temperature.shape
        layers = self.shape[2]
        volume = self.state.center_thickness * self.state.operator.area
        capacity = energy.heat_capacity * volume * energy.flow.liquid_fraction / layers
        self.storage = 1j * self.problem.speed * capacity * ~energy.fixed
        self.transport = replace(energy, heating=np.zeros_like(energy.heating))
        self.contact = energy.wall_conductance(-1)
        self.around = np.exp(1j * self.problem.mesh.theta)
        area = np.sum(self.problem.mesh.dy) * 2.0 * np.pi * self.problem.bearing.journal_radius
        self.area = float(area)

    def answer(self) -> SpotHeat:
        """Return the heat of every motion, and of a warm side of the journal."""
        warm = np.repeat(np.conj(self.around)[:, None], self.shape[1], axis=1)
        motions = [self._motion(number) for number in range(self.state.displacement.size)]
        cold = np.zeros_like(warm)
        by_motion = [self._heat(self._solve(source, cold), cold) + more for source, more in motions]
        nothing = np.zeros(self.shape, dtype=complex)
        by_temperature = self._heat(self._solve(nothing, warm), warm)
        return SpotHeat(np.array(by_motion), by_temperature)

    def _heat(self, tau: ComplexArray, surface: ComplexArray) -> complex:
        """Return F of temperatures tau (n, m, k) over a surface at `surface` (n, m)."""
        carried = self._thinned(tau)[1]  # a ruptured film fills otherwise
        return self._harmonic(self.contact * (tau[:, :, -1] - surface)) + carried

    def _harmonic(self, heat: NDArray) -> complex:
        """Return F of the heat (n, m) [W] that cells give to the journal."""
        return complex(self.around @ heat.sum(axis=1)) / self.area

    def _motion(self, number: int) -> tuple[ComplexArray, complex]:
        """Return the heat [W/m] that a motion adds to layers, and F by the film's conductance."""
        displacements = self.problem.geometry.displacements
        unit = np.zeros(displacements.scales.size)
        clearance = self.problem.bearing.radial_clearance
        unit[number] = displacements.scales[number] / clearance
        step = _RELATIVE_STEP * self.state.min_thickness * unit
        rate, factor = step * self.problem.speed, 1j * self.problem.speed
        still, carried = self._difference(
            [self._displaced(self.state.displacement + sign * step) for sign in (1.0, -1.0)],
            [None, None],
        )
        moving, carried_moving = self._difference(
            [self._displaced(self.state.displacement, sign * rate) for sign in (1.0, -1.0)],
            [rate, -rate],
        )
        by_rate = factor / rate[number]
        source = still / step[number] + by_rate * moving
        return source, carried / step[number] + by_rate * carried_moving

    def _displaced(self, q: Array, velocity: Array | None = None) -> FilmState:
        return film_state(
            self.problem, q, self.state.layers, velocity=velocity, frozen=self.state.solution.full
        )

    def _difference(
        self, states: Sequence[FilmState], rates: Sequence[Array | None], *, viscosities=None
    ) -> tuple[Array, complex]:
        """Return half of what two films take up more than each other, (n, m, k) [W], and F."""
        heat, found, carried = self.film.heat, [], []
        shapes = self.problem.geometry.displacements.shapes[:, CENTER]
        for k, (state, rate) in enumerate(zip(states, rates, strict=True)):
            energy = energy_problem(self.problem, state)
            growing = np.zeros(self.shape[:2])
            if rate is not None:
                squeeze = np.tensordot(rate, shapes, axes=1) * state.operator.area
                growing = energy.heat_capacity * squeeze * state.solution.full
            viscosity = self.film.viscosity if viscosities is None else viscosities[k]
            found.append(
                missing_heat(
                    energy, viscosity, self.walls, self.film.inlet_temperature, heat.temperature,
                    growing,
                )
            )  # fmt: skip
            passed = energy.wall_conductance(-1) * (heat.temperature[:, :, -1] - heat.shaft)
            carried.append(self._harmonic(passed))
        return 0.5 * (found[0] - found[1]), 0.5 * (carried[0] - carried[1])

    def _thinned(self, tau: ComplexArray) -> tuple[ComplexArray, complex]:
        """Return what layers take up more [W] where the oil is thinner by tau's warmth, and F."""
        (real, carried), (imaginary, turned) = map(self._thinned_by, (tau.real, tau.imag))
        return real + 1j * imaginary, carried + 1j * turned

    def _thinned_by(self, tau: Array) -> tuple[Array, complex]:
        most = float(np.abs(tau).max())
        if not most > 0.0:
            return np.zeros(self.shape), 0.0
        scale, law = _WARMING / most, self.problem.lubricant.law
        viscosities = [
            np.asarray(law.viscosity(self.film.heat.temperature + sign * scale * tau))
            for sign in (1.0, -1.0)
        ]
        states = [
            film_state(
                self.problem, self.state.displacement, layer_integrals(mu),
                frozen=self.state.solution.full,
            )
            for mu in viscosities
        ]  # fmt: skip
        change, carried = self._difference(states, [None, None], viscosities=viscosities)
        return change / scale, carried / scale

    def _transported(self, source: ComplexArray, surface: ComplexArray) -> ComplexArray:
        """Return tau (n, m, k) under a heat source and over a surface, the viscosity held."""
        n, m, _ = self.shape
        walls = WallTemperatures(np.zeros_like(surface), surface, self.walls.bush_insulated)
        inlet = np.zeros((4, n, m), dtype=complex)
        tau, leaving = np.zeros(self.shape, dtype=complex), None
        for _ in range(_PASSES):
            change, leaving = march(
                self.transport, self.film.viscosity, walls, inlet, tau, source=source,
                storage=self.storage, leaving=leaving,
            )  # fmt: skip
            if change <= _MARCH_TOLERANCE * np.abs(tau).max():
                break
        return tau

    def _solve(self, source: ComplexArray, surface: ComplexArray) -> ComplexArray:
        """Return tau (n, m, k) with the viscosity following it."""
        from scipy.sparse.linalg import LinearOperator, gmres

        first, cold = self._transported(source, surface), np.zeros_like(surface)

        def product(flat: ComplexArray) -> ComplexArray:
            tau = flat.reshape(self.shape)
            return (tau - self._transported(self._thinned(tau)[0], cold)).ravel()

        size = first.size
        operator = LinearOperator((size, size), matvec=product, dtype=complex)  # type: ignore[call-arg]
        found, _ = gmres(operator, first.ravel(), rtol=_TOLERANCE, restart=30, maxiter=2)
        return found.reshape(self.shape)
