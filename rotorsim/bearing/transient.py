"""Shaft, bush and pads warming up and cooling down: the film quasi-steady between them.

Time steps follow the temperatures: what a polynomial through the moments before predicts must be
met within a tolerance, and steps end where conditions jump or bend.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..arrays import Array
from ..film.banded import NoFilmError, SingularFilmError
from ..film.solution import FilmSolution
from ..film.storage import HeatStep, HeatStorage, SolidState
from ..film.warm_start import WarmStart
from ..model import Case, ThermalModel
from ..status import SolveStatus
from .operating_point import OperatingPoint, failed_point
from .solve import operating_point, solved_film

_INSTANT = 1e-9
"""Length of the step that shows the film right after a jump, over the duration."""
_FIRST_STEP = 2e-4
"""First step after a jump, over the duration."""
_SHORTEST = 1e-7
"""Step over the duration at which the film is taken to have ended."""
_MISFIT = {1: 10.0, 2: 5.0, 3: 4.0}
"""Misfit allowed of the polynomial through one, two or three moments, over the tolerance.

Where three are known that is the step's local error: 2/9 of the misfit of a parabola for equal
steps (BDF2), less as they grow."""
_LARGEST_GROWTH = 2.0
_LARGEST_STEP = 0.1
"""Over the duration."""

_Conditions = Callable[[float], tuple[Case, float]]
"""Case and speed [rad/s] at a time [s]."""


@dataclass(frozen=True)
class TransientStep:
    """One moment of a transient.

    time : [s]
    point : Its film and coefficients, between solids of the temperatures of this moment.
    shaft_temperature : Mean of the journal [K].
    bush_temperature : Mean of the bush, or of all pads [K].
    """

    time: float
    point: OperatingPoint
    shaft_temperature: float
    bush_temperature: float
    state: SolidState


def solve_transient(
    conditions: _Conditions,
    storage: HeatStorage,
    duration: float,
    *,
    start: float | None,
    breaks: Sequence[float] = (),
    tolerance: float = 0.1,
    step: float | None = None,
    keep_fields: bool = False,
) -> Iterator[TransientStep]:
    """Give the moments of a transient one by one, the first at 0; the last may have failed.

    conditions : Just before a break it gives what held before it.
    duration : [s]
    start : Temperature of the solids at the beginning [K]; None: those of the steady state.
    breaks : Times at which conditions jump or bend [s].
    tolerance : Of the temperatures in one step [K].
    step : Constant time step [s], in place of the tolerance.
    keep_fields : Keep the fields of every point.
    """
    march = _March(conditions, storage, duration, tolerance, step, keep_fields)
    try:
        march.begin(start)
    except (NoFilmError, SingularFilmError) as error:
        yield march.failed(0.0, str(error))
        return
    times = sorted({0.0, *(t for t in breaks if 0.0 < t < duration), duration})
    for first, last in pairwise(times):
        for moment in march.stretch(first, last):
            yield moment
            if not moment.point.converged:
                return


class _March:
    """State of the march between its steps."""

    def __init__(
        self,
        conditions: _Conditions,
        storage: HeatStorage,
        duration: float,
        tolerance: float,
        step: float | None,
        keep_fields: bool,
    ) -> None:
        self.conditions, self.storage, self.duration = conditions, storage, duration
        self.tolerance, self.fixed, self.keep_fields = tolerance, step, keep_fields
        self.states: list[tuple[float, SolidState, float]] = []
        """Time, solids and film frame of up to three moments since the last jump."""
        self.warm: WarmStart | None = None

    def begin(self, start: float | None) -> None:
        """Find the solids' first temperatures."""
        case, speed = self.conditions(-1.0 if start is None else 0.0)
        if start is None:
            solution = solved_film(case, speed)
            if solution.thermal is None or solution.status is not SolveStatus.CONVERGED:
                raise NoFilmError(f"no steady state to start from: {solution.message}")
            state = self.storage.of_steady(solution.thermal, solution.frame)
            self.warm = solution.warm_start
        else:
            isothermal = replace(case, thermal=replace(case.thermal, supply_temperature=start))
            solution = solved_film(_isothermal(isothermal), speed)
            problem = replace(solution.problem, thermal=case.thermal)
            state = self.storage.uniform(problem, solution.frame, start)
        self.states = [(0.0, state, solution.frame)]

    def stretch(self, first: float, last: float) -> Iterator[TransientStep]:
        """March from one break to the next; the film right after it is the first moment."""
        _, state, frame = self.states[-1]
        self.states = [(first, state, frame)]
        instant = _INSTANT * self.duration
        moment = self._step(first, HeatStep(self.storage, state, 1.0 / instant, frame), first)
        yield replace(moment[0], state=state)
        if not moment[0].point.converged:
            return
        size = self.fixed or min(_FIRST_STEP * self.duration, last - first)
        time = first
        while time < last * (1.0 - 1e-12):
            left = last - time
            size = min(size, left) if left > 1.5 * size else (left if size >= left else 0.5 * left)
            size = min(size, left)
            found, error = self._advance(time, size)
            acceptable = self.fixed is not None or (found is not None and error <= 1.0)
            if not acceptable and size > _SHORTEST * self.duration:
                size *= 0.5 if found is None else max(0.2, 0.8 / math.sqrt(error))
                continue
            time += size
            if found is None:
                found = self._step(time, self._heat_step(size), time - 1e-9 * size)
            self._accept(time, found)
            yield found[0]
            if not found[0].point.converged:
                return
            if self.fixed is None:
                growth = 0.85 / max(error, 1e-6) ** (1.0 / 3.0)
                size = min(size * min(_LARGEST_GROWTH, growth), _LARGEST_STEP * self.duration)

    def _advance(
        self, time: float, size: float
    ) -> tuple[tuple[TransientStep, FilmSolution | None] | None, float]:
        """Try one step; its error over the tolerance. None where the film does not converge."""
        end = time + size
        found = self._step(end, self._heat_step(size), end - 1e-9 * size)
        if not found[0].point.converged:
            return None, math.inf
        known = np.array([moment for moment, _, _ in self.states])
        guess = _extrapolated(known, [state.over_radius for _, state, _ in self.states], end)
        off = float(np.abs(found[0].state.over_radius - guess).max())
        return found, off / (self.tolerance * _MISFIT[known.size])

    def _heat_step(self, size: float) -> HeatStep:
        """Return backward difference over `size`: of second order where two moments are known."""
        last, state, frame = self.states[-1]
        if len(self.states) == 1:
            return HeatStep(self.storage, state, 1.0 / size, frame)
        before, oldest, old_frame = self.states[-2]
        ratio = size / (last - before)
        whole = (1.0 + 2.0 * ratio) / (1.0 + ratio)
        held = state.combined(oldest, (1.0 + ratio) / whole)
        turned = frame + ratio * math.remainder(frame - old_frame, 2.0 * math.pi)
        return HeatStep(self.storage, held, whole / size, turned)

    def _step(
        self, time: float, step: HeatStep, at: float
    ) -> tuple[TransientStep, FilmSolution | None]:
        """Solve the film at one moment, with the conditions of the time `at`."""
        case, speed = self.conditions(at)
        try:
            solution = solved_film(case, speed, self.warm, step)
        except (NoFilmError, SingularFilmError) as error:
            return self.failed(time, str(error)), None
        point = operating_point(case, speed, solution, keep_fields=self.keep_fields)
        if solution.thermal is None:
            return self.failed(time, solution.message), None
        walls = solution.thermal.walls
        bodies = walls.bodies(solution.thermal.heat.bush)
        solids = bodies[: len(walls.pads)] if walls.pads else bodies
        moment = TransientStep(
            time, point, walls.shaft_body(solution.thermal.heat.shaft),
            float(solids[:, 0].mean()), step.end(solution),
        )  # fmt: skip
        if point.converged:
            self.warm = solution.warm_start
        return moment, solution

    def _accept(self, time: float, found: tuple[TransientStep, FilmSolution | None]) -> None:
        moment, solution = found
        if solution is not None:
            self.states = [*self.states[-2:], (time, moment.state, solution.frame)]

    def failed(self, time: float, message: str) -> TransientStep:
        """Return a moment without a film."""
        case, speed = self.conditions(time)
        point = failed_point(case, speed, message, SolveStatus.NO_EQUILIBRIUM)
        state = self.states[-1][1] if self.states else SolidState(np.full(1, math.nan))
        return TransientStep(time, point, math.nan, math.nan, state)


def _extrapolated(times: Array, values: list[Array], time: float) -> Array:
    """Return the polynomial through the `values` at `times`, at another time."""
    result = np.zeros_like(values[0])
    for k, value in enumerate(values):
        others = np.delete(times, k)
        result += float(np.prod((time - others) / (times[k] - others))) * value
    return result


def _isothermal(case: Case) -> Case:
    return replace(case, thermal=replace(case.thermal, model=ThermalModel.ISOTHERMAL))
