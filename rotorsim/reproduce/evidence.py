"""Evidence: the comparisons that claims are made of, each a function of the results."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from .claim import Evidence
from .paper import CLEARANCES, TOP_RPM
from .results import ISOTHERMAL, LIQUID, THD, Array, PaperResults, Run, reduction

Evaluate = Callable[[PaperResults], Evidence]
ROUNDING = 1e-9
"""Relative: similar films differ by rounding."""
BOTH = (ISOTHERMAL, THD)


def share(outcomes: Iterable[bool | np.bool_], what: str, more: str = "") -> Evidence:
    """Part of `outcomes` that hold."""
    found = [bool(outcome) for outcome in outcomes]
    held = sum(found)
    text = f"holds in {held} of {len(found)} {what}"
    return Evidence(held / len(found), f"{text}; {more}" if more else text)


def reduced(
    name: str, clearance: float, rpm: float = TOP_RPM, friction: str = LIQUID
) -> Callable[[PaperResults], float]:
    """Reduction of `name` by heating [%]."""
    return lambda r: r.reduction(name, clearance, rpm, friction=friction)


def value(
    name: str,
    model: str,
    clearance: float,
    rpm: float = TOP_RPM,
    *,
    scale: float = 1.0,
    friction: str = LIQUID,
) -> Callable[[PaperResults], float]:
    """`name` at one point, times `scale`."""
    return lambda r: scale * r.at(name, model, clearance, rpm, friction=friction)


def growth(name: str, model: str, clearance: float, start: float) -> Callable[..., float]:
    """Ratio of the values at the top speed and at `start` rpm."""
    return lambda r: r.at(name, model, clearance) / r.at(name, model, clearance, start)


def rise(name: str, model: str, clearance: float, start: float, *, of_end: bool) -> Callable:
    """Growth from `start` rpm to the top speed in percent of the first or of the last value."""

    def percent(r: PaperResults) -> float:
        first, last = r.at(name, model, clearance, start), r.at(name, model, clearance)
        return 100.0 * (last - first) / (last if of_end else first)

    return percent


def curves(
    r: PaperResults, names: Sequence[str], models: Sequence[str]
) -> list[tuple[str, Array, Array]]:
    """``(name, speed in rpm, values)`` for every name, model and clearance."""
    runs = [Run(model, clearance) for model in models for clearance in CLEARANCES]
    return [(name, r.speeds(run), r.values(name, run)) for name in names for run in runs]


def rises(
    *names: str, models: Sequence[str] = BOTH, above: float = 0.0, sign: float = 1
) -> Evaluate:
    """Whether every step of every curve goes up (`sign` 1) or down (-1)."""

    def check(r: PaperResults) -> Evidence:
        steps: list[bool | np.bool_] = []
        for _, speed, values in curves(r, names, models):
            steps += list(sign * np.diff(values[speed >= above]) > 0.0)
        return share(steps, "steps between speeds")

    return check


def decelerates(*names: str, models: Sequence[str], sign: float = 1.0) -> Evaluate:
    """Whether the slope of every curve falls (`sign` 1) or rises (-1) from speed to speed."""

    def check(r: PaperResults) -> Evidence:
        steps: list[bool | np.bool_] = []
        for _, speed, values in curves(r, names, models):
            slope = np.diff(values) / np.diff(speed)
            steps += list(sign * np.diff(slope) < 0.0)
        return share(steps, "changes of slope")

    return check


def bend(*names: str, models: Sequence[str], clearance: float = CLEARANCES[0]) -> Evaluate:
    """Largest distance from the straight line through both ends, in percent of the range."""

    def check(r: PaperResults) -> Evidence:
        worst = [
            _distance_from_line(r.speeds(run), r.values(name, run))
            for name in names
            for run in (Run(model, clearance) for model in models)
        ]
        return Evidence(float(np.max(worst)))

    return check


def bends(*names: str, least: float) -> Evaluate:
    """Whether every THD curve leaves its straight line by more than `least` percent."""

    def check(r: PaperResults) -> Evidence:
        found = [_distance_from_line(x, y) for _, x, y in curves(r, names, (THD,))]
        return share([d > least for d in found], "curves", f"least {min(found):.2g} %")

    return check


def _distance_from_line(x: Array, y: Array) -> float:
    line = y[0] + (y[-1] - y[0]) * (x - x[0]) / (x[-1] - x[0])
    return float(100.0 * np.max(np.abs(y - line)) / np.max(np.abs(y)))


def spread(name: str, model: str) -> Evaluate:
    """Largest difference between any two speeds and clearances, in percent of the mean."""

    def check(r: PaperResults) -> Evidence:
        found = np.array([values for _, _, values in curves(r, (name,), (model,))])
        return Evidence(float(100.0 * np.ptp(found) / np.mean(found)))

    return check


def spread_over_speed(*names: str, model: str) -> Evaluate:
    """Largest difference between two speeds of one curve, in percent of its mean."""

    def check(r: PaperResults) -> Evidence:
        found = [np.ptp(v) / abs(np.mean(v)) for _, _, v in curves(r, names, (model,))]
        return Evidence(float(100.0 * np.max(found)))

    return check


def falls_with_clearance(*names: str, models: Sequence[str] = BOTH) -> Evaluate:
    """Whether the magnitude is larger for the smaller clearance, at every speed."""
    return ordered_by_clearance(*names, models=models, smaller_is_higher=True)


def ordered_by_clearance(
    *names: str,
    models: Sequence[str],
    smaller_is_higher: bool,
    lowest_rpm: float = 0.0,
    highest_rpm: float = TOP_RPM,
) -> Evaluate:
    """Whether magnitudes are ordered by clearance within a range of speeds."""

    def check(r: PaperResults) -> Evidence:
        outcomes: list[bool | np.bool_] = []
        for name in names:
            for model in models:
                rows = np.array([np.abs(r.values(name, Run(model, c))) for c in CLEARANCES])
                speed = r.speeds(Run(model, CLEARANCES[0]))
                chosen = (speed >= lowest_rpm) & (speed <= highest_rpm)
                difference = np.diff(rows[:, chosen], axis=0)
                outcomes += list((difference < 0.0 if smaller_is_higher else difference > 0.0).flat)
        return share(outcomes, "comparisons of neighbouring clearances")

    return check


def lowered_by_heat(*names: str) -> Evaluate:
    """Whether the THD magnitude lies below the isothermal one at every speed and clearance."""

    def check(r: PaperResults) -> Evidence:
        outcomes: list[bool | np.bool_] = []
        for (_, _, cold), (_, _, warm) in zip(
            curves(r, names, (ISOTHERMAL,)), curves(r, names, (THD,)), strict=True
        ):
            outcomes += list(np.abs(warm) < np.abs(cold))
        return share(outcomes, "points")

    return check


def effect_falls_with_clearance(*names: str) -> Evaluate:
    """Whether the reduction at the top speed is smaller for the larger clearance."""

    def check(r: PaperResults) -> Evidence:
        rows = np.array([[r.reduction(name, c) for c in CLEARANCES] for name in names])
        means = ", ".join(f"{mean:.1f}" for mean in rows.mean(axis=0))
        more = f"reductions {means} % at 100, 125, 150 um" + (
            " on average" if len(names) > 1 else ""
        )
        return share(list((np.diff(rows, axis=1) < 0.0).flat), "steps of clearance", more)

    return check


def effect_grows_with_speed(*names: str) -> Evaluate:
    """Whether the reduction at the top speed exceeds that at the lowest one."""

    def check(r: PaperResults) -> Evidence:
        pairs = [
            (r.reduction(name, c, 500.0), r.reduction(name, c))
            for name in names
            for c in CLEARANCES
        ]
        slow, fast = (max(abs(pair[i]) for pair in pairs) for i in (0, 1))
        more = f"at most {slow:.2g} % at 500 rpm, {fast:.2g} % at 15 000 rpm"
        return share([abs(low) < abs(high) for low, high in pairs], "cases", more)

    return check


def compare(
    test: Callable[[dict[str, Array]], NDArray[np.bool_]],
    names: Sequence[str],
    models: Sequence[str],
) -> Evaluate:
    """Whether `test` of the named values holds at every speed and clearance."""

    def check(r: PaperResults) -> Evidence:
        outcomes: list[bool | np.bool_] = []
        for model in models:
            for clearance in CLEARANCES:
                run = Run(model, clearance)
                values = {name: r.values(name, run) for name in names}
                outcomes += list(test(values))
        return share(outcomes, "points")

    return check


def reductions(r: PaperResults, names: Sequence[str], clearance: float) -> dict[str, float]:
    """Reduction of each name at the top speed [%]."""
    return {name: r.reduction(name, clearance) for name in names}


def extreme(
    names: Sequence[str], wanted: str, pick: Callable[..., str], among: Sequence[float] = CLEARANCES
) -> Evaluate:
    """Whether `wanted` has the largest (`pick` max) or smallest (min) reduction."""

    def check(r: PaperResults) -> Evidence:
        rows = [reductions(r, names, c) for c in among]
        found = [pick(row, key=row.__getitem__) for row in rows]
        more = f"it is {', '.join(dict.fromkeys(found))}"
        return share([name == wanted for name in found], "clearances", more)

    return check


def relative_gap(first: float, second: float) -> float:
    """`second` against `first` in percent, absolute."""
    return abs(reduction(first, second))
