"""Synchronous hot spot (Morton effect) of a machine: its films' heat, and the loop over speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array, ComplexArray, Indices
from ..bearing.dynamics import following_displacements
from ..bearing.solve import solved_film
from ..errors import InputError
from ..files.machine import MachineFile
from ..film.geometry import rotation
from ..film.hot_spot import spot_heat
from ..film.solution import FilmSolution
from ..machine.hot_spot import Journal, SpotFilms, SpotLoop, spot_loop
from ..machine.peaks import response_speeds
from ..model import Case, ThermalModel
from ..status import SolveStatus
from .machine import MachineResult
from .machine_analysis import film_cases


@dataclass(frozen=True, eq=False)
class HotSpotStudy:
    """Hot spots of some journals of a machine over speed.

    names : Of their supports.
    journals : One for each.
    loop : At many speeds, the films' heat interpolated between those at which it is known.
    films : Where it is known.
    thresholds : Speeds at which the temperatures begin to grow, or cease to [rad/s]; ascending.
    """

    names: tuple[str, ...]
    journals: tuple[Journal, ...]
    loop: SpotLoop
    films: SpotFilms
    thresholds: tuple[float, ...]

    @property
    def stable(self) -> bool:
        """Return whether the temperatures settle at every speed."""
        return bool(np.nanmax(self.loop.growth_rate) < 0.0)

    @property
    def lag(self) -> Array:
        """Angle by which the hot spot lags the high spot of a circular orbit (n, b) [rad]."""
        return -np.angle(self._by_circle)

    @property
    def sensitivity(self) -> Array:
        """Temperature difference across a journal over its circular orbit's radius (n, b) [K/m]."""
        return 2.0 * np.abs(self._by_circle)

    @property
    def _by_circle(self) -> ComplexArray:
        resistance = np.array([journal.resistance for journal in self.journals])
        return self.films.heat @ np.array([1.0, -1j]) / (self.films.loss + 1.0 / resistance)


def hot_spot_study(result: MachineResult) -> HotSpotStudy | None:
    """Follow the hot spots that the machine's file asks for; None where it asks for none.

    Raises InputError: No support that is asked for has a heated film, or fewer than two of its
        speeds are known.
    """
    settings = result.description.hot_spot
    if settings is None:
        return None
    wanted = settings.support or tuple(result.description.bearings)
    chosen = [i for i, state in enumerate(result.supports) if state.name in wanted and state.points]
    heated = result.thermal_model == str(ThermalModel.THD)
    if not (chosen and heated):
        raise InputError(
            "needs heated films: a support with bearing = ... whose file has thermal.models = "
            '["thd"]', key="hot_spot",
        )  # fmt: skip
    case_of = film_cases(result)
    places = _spread(result, chosen, settings.films)
    if places.size < 2:
        raise InputError("needs two speeds at which all its films converged", key="hot_spot")
    found = [_heat_over_speed(result, case_of, i, places) for i in chosen]
    heat, loss = (np.stack(parts, axis=1) for parts in zip(*found, strict=True))
    films = SpotFilms(result.speeds[places], heat, loss)
    journals = tuple(_journal(result.description, i, case_of(i, int(places[-1]))) for i in chosen)
    low, high = float(films.speed[0]), float(films.speed[-1])
    speeds = response_speeds(result.machine, low, high, result.modes)
    loop = spot_loop(result.machine, journals, chosen, films.at(speeds))
    names = tuple(result.supports[i].name for i in chosen)
    return HotSpotStudy(names, journals, loop, films, _crossings(loop))


def _spread(result: MachineResult, chosen: list[int], count: int) -> Indices:
    """Return numbers of up to `count` speeds, evenly over those whose films all converged."""
    known = np.array([
        all(result.supports[i].points[k].converged for i in chosen)
        for k in range(result.speeds.size)
    ])  # fmt: skip
    places = np.flatnonzero(known)
    if places.size <= count:
        return places
    return places[np.unique(np.linspace(0, places.size - 1, count).round().astype(int))]


def _heat_over_speed(
    result: MachineResult, case_of: Callable[[int, int], Case], i: int, places: Indices
) -> tuple[ComplexArray, ComplexArray]:
    """Return a film's heat (n, 2) and loss (n,) over speed; see `SpotFilms`."""
    warm, heats, losses = None, [], []
    for k in places:
        solution = solved_film(case_of(i, int(k)), float(result.speeds[k]), warm)
        warm = solution.warm_start if solution.status is SolveStatus.CONVERGED else None
        heat, loss = _heat(solution, float(result.supports[i].direction[k]))
        heats.append(heat)
        losses.append(loss)
    return np.array(heats), np.array(losses)


def _heat(solution: FilmSolution, direction: float) -> tuple[ComplexArray, complex]:
    """Return heat (2,) and loss of a film whose load has a direction [rad], machine's frame."""
    assert solution.thermal is not None
    spot = spot_heat(solution.thermal)
    moved = following_displacements(solution, 1j * solution.problem.speed)
    angle = solution.frame + direction
    turned = spot.by_motion @ moved @ rotation(angle).T
    return turned * np.exp(1j * angle), -spot.by_temperature


def _journal(machine: MachineFile, i: int, case: Case) -> Journal:
    settings, entry, beam = machine.hot_spot, machine.support[i], machine.rotor.beam
    assert settings is not None
    bores = [
        float(beam.at(np.array([entry.at]), section)[0][0])
        for section in beam.sections
        if section.layer == 1 and beam.span(section)[0] <= entry.at <= beam.span(section)[1]
    ]
    return Journal(
        entry.at, case.bearing.length, case.bearing.journal_radius, min(bores, default=0.0),
        settings.expansion, settings.conductivity,
        beam.material.density * settings.specific_heat,
    )  # fmt: skip


def _crossings(loop: SpotLoop) -> tuple[float, ...]:
    """Return the speeds at which the growth rate changes its sign, between neighbours [rad/s]."""
    known = np.isfinite(loop.growth_rate)
    speed, rate = loop.speed[known], loop.growth_rate[known]
    at = np.flatnonzero(np.diff(np.sign(rate)))
    crossing = speed[at] - rate[at] * np.diff(speed)[at] / np.diff(rate)[at]
    return tuple(map(float, crossing))


def hot_spot_document(study: HotSpotStudy) -> dict[str, Any]:
    """Return hot spots as plain data (SI)."""
    loop = study.loop
    difference = 2.0 * np.abs(loop.temperature)
    return {
        "supports": list(study.names),
        "stable": study.stable,
        "thresholds": list(study.thresholds),
        "speeds": loop.speed.tolist(),
        "gain_real": loop.gain.real.tolist(),
        "gain_imaginary": loop.gain.imag.tolist(),
        "growth_rate": loop.growth_rate.tolist(),
        "spiral_frequency": loop.frequency.tolist(),
        "temperature_difference": difference.tolist(),
        "film_speeds": study.films.speed.tolist(),
        "lag": study.lag.tolist(),
        "temperature_difference_per_radius": study.sensitivity.tolist(),
        "time_constant": [one.heat_capacity * one.resistance for one in study.journals],
    }
