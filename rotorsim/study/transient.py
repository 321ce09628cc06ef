"""A scenario's thermal transient: temperatures, clearance, film and stability over time."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..bearing.operating_point import OperatingPoint, plain
from ..bearing.transient import TransientStep, solve_transient
from ..errors import InputError
from ..film.storage import HeatStorage
from ..machine.rates import eigenvalues
from ..model import Bearing, Case, LoadTarget, ThermalModel
from ..model.transient import TransientSettings, TransientStart
from ..rows import QUANTITIES, with_unit
from .orbits import FilmFrame, film_at_rest

if TYPE_CHECKING:
    from ..files.scenario import Scenario


_FRAMES = 60
"""Moments of which a recording shows the fields."""
_SAID = (
    "speed", "load", "eccentricity_ratio", "min_film_thickness", "max_pressure",
    "max_temperature", "power_loss", "side_flow",
)  # fmt: skip


@dataclass(frozen=True)
class Transient:
    """A thermal transient of a bearing.

    steps : Moments, ascending in time; two at a jump.
    rotor_mass : Per bearing, for the growth rates [kg]; None without a rotor.
    duration : Asked for [s]; the last moment lies before it where the film ended.
    drained_in : Time in which the gap would run dry after a loss of the supply if nothing came back
        [s]; None: the supply lasts.
    """

    steps: tuple[TransientStep, ...]
    rotor_mass: float | None
    duration: float
    drained_in: float | None = None

    @cached_property
    def time(self) -> Array:
        """Times of the moments [s]."""
        return np.array([step.time for step in self.steps])

    @property
    def points(self) -> list[OperatingPoint]:
        """Operating point of each moment."""
        return [step.point for step in self.steps]

    @property
    def converged(self) -> bool:
        """Return whether the film lasted to the end."""
        return self.points[-1].converged

    def values(self, name: str) -> Array:
        """Return a quantity of the points over time; NaN where it is not known."""
        found = [getattr(point, name) for point in self.points]
        return np.array([math.nan if value is None else value for value in found])

    @cached_property
    def shaft_temperature(self) -> Array:
        """Mean of the journal [K]."""
        return np.array([step.shaft_temperature for step in self.steps])

    @cached_property
    def bush_temperature(self) -> Array:
        """Mean of the bush or of the pads [K]."""
        return np.array([step.bush_temperature for step in self.steps])

    @cached_property
    def clearance(self) -> Array:
        """Radial clearance, hot where it is known [m]."""
        return np.array([point.running_clearance for point in self.points])

    @cached_property
    def growth_rate(self) -> Array:
        """Largest real part of the eigenvalues of a rigid rotor [1/s]; NaN without a rotor."""
        if self.rotor_mass is None:
            return np.full(len(self.steps), math.nan)
        stiffness, damping = (
            np.stack([getattr(point, name) for point in self.points])
            for name in ("stiffness", "damping")
        )
        return eigenvalues(stiffness, damping, self.rotor_mass).real.max(axis=-1)

    def moments(self) -> dict[str, int]:
        """Return places of the moments of least clearance, least film and least stability."""
        found = {
            "least_clearance": self.clearance,
            "least_film": self.values("min_film_thickness"),
            "least_stability": -self.growth_rate,
        }
        return {k: int(np.nanargmin(v)) for k, v in found.items() if np.isfinite(v).any()}

    def describe(self) -> dict[str, Any]:
        """Return what is said of the transient (SI, plain data): columns over time and moments."""
        last = self.points[-1]
        columns = {
            "time": self.time,
            "shaft_temperature": self.shaft_temperature,
            "bush_temperature": self.bush_temperature,
            "radial_clearance": self.clearance,
            "growth_rate": self.growth_rate,
            **{name: self.values(name) for name in _SAID},
            "stiffness": np.stack([point.stiffness for point in self.points]),
            "damping": np.stack([point.damping for point in self.points]),
        }
        moments = {
            name: {
                "time": self.steps[place].time,
                "radial_clearance": self.clearance[place],
                "min_film_thickness": self.points[place].min_film_thickness,
                "growth_rate": self.growth_rate[place],
            }
            for name, place in self.moments().items()
        }
        return plain(
            {
                "status": last.status,
                "message": last.message,
                "duration": self.duration,
                "rotor_mass": self.rotor_mass,
                "drained_in": self.drained_in,
                "verdict": self.verdict(),
                "moments": moments,
                **columns,
            }
        )

    def verdict(self) -> str:
        """Describe how the transient goes."""
        if self.drained_in is None:
            return self._course()
        return (
            f"{self._course()} Without supply the oil is taken to come back uncooled; if none came "
            f"back, the gap would run dry in about {self.drained_in:.2g} s."
        )

    def _course(self) -> str:
        if not self.converged:
            point = self.points[-1]
            reached = np.nanmax(self.values("max_temperature")) if len(self.steps) > 1 else math.nan
            hottest = QUANTITIES["max_temperature"]
            return (
                f"The film ends after {self.time[-1]:.4g} s of {self.duration:.4g} s (hottest "
                f"until then {hottest.with_unit(reached)}): {point.message}"
            )
        place = self.moments()["least_clearance"]
        said = (
            f"The clearance is least, {with_unit(self.clearance[place] * 1e6, 'µm')}, after "
            f"{self.time[place]:.4g} s, the film with "
            f"{with_unit(np.nanmin(self.values('min_film_thickness')) * 1e6, 'µm')} after "
            f"{self.time[self.moments()['least_film']]:.4g} s"
        )
        if self.rotor_mass is None:
            return f"{said}."
        growth = self.growth_rate
        unstable = self.time[growth > 0.0]
        worst = self.moments()["least_stability"]
        if not unstable.size:
            return (
                f"{said}. The rotor is stable throughout, least so after {self.time[worst]:.4g} s "
                f"({growth[worst]:+.4g} 1/s)."
            )
        end = "to the end" if growth[-1] > 0.0 else f"until {unstable[-1]:.4g} s"
        return (
            f"{said}. The rotor is unstable from {unstable[0]:.4g} s {end}, most so after "
            f"{self.time[worst]:.4g} s ({growth[worst]:+.4g} 1/s)."
        )


def transient_frames(transient: Transient, bearing: Bearing) -> list[FilmFrame]:
    """Return film and bore of a transient solved with its fields, moment by moment, for playback.

    The frames of the film have its mean temperature across, those of the bore the solid's surface.
    """
    frames = []
    moments = [step for step in transient.steps if step.point.fields is not None]
    chosen = np.unique(np.linspace(0, len(moments) - 1, _FRAMES).round().astype(int))
    for step in (moments[k] for k in chosen):
        film = film_at_rest(step.point, bearing)
        assert step.point.fields is not None
        bore = step.point.fields.bush_temperature
        solid = "pads" if bearing.pads else "bush"
        frames.append(replace(film, thermal_model="film", time=step.time))
        frames.append(
            replace(
                film, thermal_model=solid, temperature=bore, max_temperature=float(bore.max()),
                time=step.time,
            )
        )  # fmt: skip
    return frames


def simulate_transient(
    scenario: Scenario,
    *,
    keep_fields: bool = False,
    progress: Callable[[TransientStep], None] | None = None,
) -> Transient:
    """Solve the thermal transient of a scenario's ``[transient]``.

    keep_fields : Keep the film's fields of every moment.
    progress : Called with each moment found.

    Raises InputError: The scenario has none.
    """
    settings = scenario.transient
    if settings is None:
        raise InputError('is missing: write for example duration = "600 s"', key="transient")
    case = scenario.case(
        settings.radial_clearance or scenario.radial_clearances[0], ThermalModel.THD
    )
    start = settings.initial_temperature or case.thermal.ambient_temperature
    breaks = [t for event in settings.events for t in (event.at, event.at + event.over)]
    steps = []
    for step in solve_transient(
        _conditions_of(settings, case, settings.speed or float(scenario.speeds[-1])),
        HeatStorage(settings.shaft, settings.bush),
        settings.duration,
        start=None if settings.start is TransientStart.STEADY else start,
        breaks=breaks,
        tolerance=settings.tolerance,
        keep_fields=keep_fields,
    ):
        steps.append(step)
        if progress is not None:
            progress(step)
    mass = None if scenario.rotor is None else scenario.rotor.total_mass
    lost = next((event.at for event in settings.events if event.supply is False), None)
    drained = None if lost is None else _drained_in(steps, case.bearing, lost)
    return Transient(tuple(steps), mass, settings.duration, drained)


def _drained_in(steps: list[TransientStep], bearing: Bearing, lost: float) -> float | None:
    """Return the volume of the gap over the side flow at the loss of the supply [s]."""
    at_jump = [step.point for step in steps if step.time == lost and step.point.converged]
    if not at_jump or not at_jump[-1].side_flow > 0.0:
        return None
    after = at_jump[-1]
    covered = sum(pad.arc for pad in bearing.pads) if bearing.pads else 2.0 * math.pi
    gap = covered * bearing.journal_radius * bearing.length * after.running_clearance
    return float(gap / after.side_flow)


def _conditions_of(
    settings: TransientSettings, case: Case, speed: float
) -> Callable[[float], tuple[Case, float]]:
    """Return the case and the speed [rad/s] at any time; at an event that of before a jump."""
    names = ("supply_temperature", "ambient_temperature")
    first: dict[str, float] = {name: getattr(case.thermal, name) for name in names}
    first["speed"] = speed
    if isinstance(case.target, LoadTarget):
        first["load"] = case.target.load

    def at(time: float) -> tuple[Case, float]:
        now, supplied = dict(first), True
        for event in settings.events:
            if time < event.at or (time == event.at and event.over > 0.0):
                break
            done = 1.0 if event.over <= 0.0 else min((time - event.at) / event.over, 1.0)
            for name in first:
                asked = getattr(event, name)
                if asked is not None:
                    now[name] += done * (asked - now[name])
            supplied = supplied if event.supply is None else event.supply
        thermal = replace(case.thermal, supplied=supplied, **{n: now[n] for n in names})
        target = LoadTarget(now["load"]) if "load" in now else case.target
        bearing = case.bearing if supplied else _unfed(case)
        return replace(case, bearing=bearing, thermal=thermal, target=target), now["speed"]

    return at


def _unfed(case: Case) -> Any:
    """Return the bearing without pressure in its grooves, their own oil gone."""
    grooves = tuple(
        replace(groove, supply_pressure=0.0, supply_temperature=None, restrictor=None)
        for groove in case.bearing.grooves
    )
    return replace(case.bearing, grooves=grooves, profile=None, preload=None, offset=None)
