"""What the claims are judged by: each public function of this module is a measure.

``claims.csv`` names them, with their arguments, in the column ``measure``:
``reduction load clearance=125`` calls ``reduction(results, "load", clearance=125)``. A measure
returns a number in the claim's unit, or for a statement the share of comparisons that hold;
together with what lies behind it in words, or without.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .study import (
    CLEARANCES,
    DAMPING,
    FILM_SPEEDS,
    ISOTHERMAL,
    SPEEDS,
    STIFFNESS,
    THD,
    TOP_SPEED,
    WHOLE,
    Results,
)
from .study import reduction as _fall

_Array = NDArray[np.float64]
_BOTH = (ISOTHERMAL, THD)
_RPM = np.array(SPEEDS, dtype=float)


class NotComputedError(Exception):
    """A value that a verdict needs is not there: its point did not converge."""


class Evidence(NamedTuple):
    """What a claim is judged by: a number, and what lies behind it in words."""

    value: float
    detail: str = ""


def _known(values: ArrayLike) -> _Array:
    array = np.asarray(values, dtype=float)
    if np.isnan(array).any():
        raise NotComputedError
    return array


def _share(outcomes: ArrayLike, what: str, more: str = "") -> Evidence:
    found = np.asarray(outcomes, dtype=bool)
    text = f"holds in {found.sum()} of {found.size} {what}"
    return Evidence(float(found.mean()), f"{text}; {more}" if more else text)


def _models(model: str | None) -> tuple[str, ...]:
    return _BOTH if model is None else (model,)


def _curves(r: Results, names: tuple[str, ...], models: tuple[str, ...] = _BOTH) -> _Array:
    """Values over (name, thermal model, clearance, speed)."""
    picked = [r.curves[name].sel(setting="ambient", thermal_model=list(models)) for name in names]
    return _known([values.sel(clearance=list(CLEARANCES), rpm=list(SPEEDS)) for values in picked])


def _at(r: Results, name: str, model: str, clearance: int = 100, rpm: int = TOP_SPEED) -> float:
    return float(_known(r.value(name, model, clearance, rpm)))


def _over_clearances(r: Results, name: str, model: str, rpm: int = TOP_SPEED) -> _Array:
    return np.array([_at(r, name, model, clearance, rpm) for clearance in CLEARANCES])


def _reductions(r: Results, names: tuple[str, ...], rpm: int = TOP_SPEED) -> _Array:
    """Reductions by heating [%] over (name, clearance)."""
    cold, warm = (
        np.array([_over_clearances(r, name, model, rpm) for name in names]) for model in _BOTH
    )
    return 100.0 * (1.0 - warm / cold)


# Numbers at single points


def value(
    r: Results, name: str, model: str, clearance: int = 100, rpm: int = TOP_SPEED,
    friction: str = "liquid", scale: float = 1.0, offset: float = 0.0,
) -> float:  # fmt: skip
    """Return a quantity at one point, times `scale`, plus `offset`."""
    return scale * r.value(name, model, clearance, rpm, friction) + offset


def reduction(
    r: Results, name: str, clearance: int = 100, rpm: int = TOP_SPEED, friction: str = "liquid"
) -> float:
    """Return by how much heating lowers a quantity [%]."""
    return r.reduction(name, clearance, rpm, friction)


def growth(r: Results, name: str, model: str, since: int) -> float:
    """Return the ratio of the values at the top speed and at `since` rpm, c = 100 µm."""
    return r.value(name, model) / r.value(name, model, rpm=since)


def rise(
    r: Results, name: str, model: str, since: int, clearance: int = 100, of: str = "start"
) -> float:
    """Return the growth from `since` rpm to the top speed in percent of its start or end."""
    first, last = (r.value(name, model, clearance, rpm) for rpm in (since, TOP_SPEED))
    return 100.0 * (last - first) / (first if of == "start" else last)


def friction_coefficient(r: Results, part: float) -> float:
    """Return friction of the whole ruptured sector over `part` of the film force, isothermal."""
    friction = r.value("friction_force", ISOTHERMAL, friction=WHOLE)
    return friction / (part * r.value("load", ISOTHERMAL))


def widening(r: Results, name: str, model: str, friction: str) -> float:
    """Return by how much a quantity falls from 100 to 150 µm at the top speed [%]."""
    narrow, wide = (r.value(name, model, c, friction=friction) for c in (100, 150))
    return _fall(narrow, wide)


def ratio(r: Results, above: str, below: str, model: str) -> float:
    """Return the ratio of two coefficients, at the clearance where it is farthest from 1."""
    found = _over_clearances(r, above, model) / _over_clearances(r, below, model)
    return float(found[np.argmax(np.abs(found - 1.0))])


def largest_reduction(r: Results, *names: str) -> Evidence:
    """Return the largest reduction by heating over coefficients and clearances [%]."""
    found = _reductions(r, names)
    name, clearance = np.unravel_index(np.argmax(found), found.shape)
    return Evidence(float(found.max()), f"it is {names[name]} at {CLEARANCES[clearance]} µm")


def mesh_change(r: Results) -> float:
    """Return how far the THD film force on the paper's nodes is from the doubled mesh [%]."""
    double, printed = (
        float(r.variants["load"].sel(variant=key, thermal_model=THD))
        for key in ("mesh_double", "mesh_as_printed")
    )
    return abs(_fall(double, printed))


def implied(_r: Results, number: float, less: float = 0.0) -> float:
    """Return what another statement of the paper gives: `number`, lowered by `less` percent."""
    return number * (1.0 - less / 100.0)


def printed_viscosity_fall(_r: Results, to: float) -> float:
    """Return the fall of viscosity from 40 degC to `to` by Eq. 15 as printed [%]."""
    return 100.0 * (1.0 - math.exp(-0.034 * (to / 40.0 - 1.0)))


# Shapes of curves over speed


def _steps_up(r: Results, names: tuple[str, ...], model: str | None, above: float) -> _Array:
    return np.diff(_curves(r, names, _models(model))[..., above <= _RPM], axis=-1)


def rises(r: Results, *names: str, model: str | None = None, above: float = 0.0) -> Evidence:
    """Return whether every step of every curve goes up, from `above` rpm on."""
    return _share(_steps_up(r, names, model, above) > 0.0, "steps between speeds")


def falls(r: Results, *names: str, model: str | None = None, above: float = 0.0) -> Evidence:
    """Return whether every step of every curve goes down, from `above` rpm on."""
    return _share(_steps_up(r, names, model, above) < 0.0, "steps between speeds")


def _slope_changes(r: Results, names: tuple[str, ...], model: str | None) -> _Array:
    slopes = np.diff(_curves(r, names, _models(model)), axis=-1) / np.diff(_RPM)
    return np.diff(slopes, axis=-1)


def decelerates(r: Results, *names: str, model: str | None = None) -> Evidence:
    """Return whether the slope of every curve falls from speed to speed."""
    return _share(_slope_changes(r, names, model) < 0.0, "changes of slope")


def accelerates(r: Results, *names: str, model: str | None = None) -> Evidence:
    """Return whether the slope of every curve rises from speed to speed."""
    return _share(_slope_changes(r, names, model) > 0.0, "changes of slope")


def _distance_from_line(values: _Array) -> _Array:
    """Return the largest distance from the straight line through both ends [% of the range]."""
    first, last = values[..., :1], values[..., -1:]
    line = first + (last - first) * (_RPM - _RPM[0]) / (_RPM[-1] - _RPM[0])
    return 100.0 * np.abs(values - line).max(axis=-1) / np.abs(values).max(axis=-1)


def bend(r: Results, *names: str, model: str) -> float:
    """Return the largest distance from a straight line at 100 µm [% of the range]."""
    return float(_distance_from_line(_curves(r, names, (model,))[:, :, 0]).max())


def bends(r: Results, *names: str, least: float) -> Evidence:
    """Return whether every THD curve leaves its straight line by more than `least` percent."""
    found = _distance_from_line(_curves(r, names, (THD,)))
    return _share(found > least, "curves", f"least {found.min():.2g} %")


def spread(r: Results, name: str, model: str) -> float:
    """Return the largest difference over speed and clearance [% of the mean]."""
    found = _curves(r, (name,), (model,))
    return float(100.0 * np.ptp(found) / found.mean())


def spread_over_speed(r: Results, *names: str, model: str) -> float:
    """Return the largest difference between two speeds of one curve [% of its mean]."""
    found = _curves(r, names, (model,))
    return float(100.0 * (np.ptp(found, axis=-1) / np.abs(found.mean(axis=-1))).max())


def spread_over_clearance(r: Results, name: str, model: str, below: float) -> float:
    """Return the largest difference between clearances, below a speed [% of the mean]."""
    found = _curves(r, (name,), (model,))[0, 0][:, below > _RPM]
    return float(100.0 * (np.ptp(found, axis=0) / found.mean(axis=0)).max())


def largest_at_top_speed(r: Results, name: str) -> Evidence:
    """Return whether a quantity is largest at the top speed and 100 µm."""
    found = _curves(r, (name,))[0]
    return _share(found.max(axis=(1, 2)) == found[:, 0, -1], "thermal models")


# Clearances, and one coefficient against another


def _steps_of_clearance(
    r: Results, names: tuple[str, ...], model: str | None, above: float, below: float
) -> _Array:
    chosen = (above < _RPM) & (below > _RPM)
    return np.diff(np.abs(_curves(r, names, _models(model))[..., chosen]), axis=-2)


def falls_with_clearance(
    r: Results, *names: str, model: str | None = None, above: float = 0.0, below: float = math.inf
) -> Evidence:
    """Return whether the magnitude falls with clearance at every speed between two limits."""
    steps = _steps_of_clearance(r, names, model, above, below)
    return _share(steps < 0.0, "comparisons of neighbouring clearances")


def rises_with_clearance(
    r: Results, *names: str, model: str | None = None, above: float = 0.0, below: float = math.inf
) -> Evidence:
    """Return whether the magnitude rises with clearance at every speed between two limits."""
    steps = _steps_of_clearance(r, names, model, above, below)
    return _share(steps > 0.0, "comparisons of neighbouring clearances")


def _temperatures(r: Results) -> tuple[_Array, str]:
    found = _over_clearances(r, "temperature", THD)
    return found, ", ".join(f"{t:.0f}" for t in found) + " degC at 100, 125, 150 µm"


def cooler_with_clearance(r: Results) -> Evidence:
    """Return whether the film is cooler in the wider clearance at the top speed."""
    found, more = _temperatures(r)
    return _share(np.diff(found) < 0.0, "steps of clearance", more)


def warmer_with_clearance(r: Results) -> Evidence:
    """Return whether the film is warmer in the wider clearance at the top speed."""
    found, more = _temperatures(r)
    return _share(np.diff(found) > 0.0, "steps of clearance", more)


def rise_grows_with_clearance(r: Results, name: str, model: str, since: int) -> Evidence:
    """Return whether the relative growth from `since` rpm rises with clearance."""
    found = _known([rise(r, name, model, since, clearance) for clearance in CLEARANCES])
    more = "computed " + ", ".join(f"{x:.1f} %" for x in found)
    return _share(np.diff(found) > 0.0, "steps of clearance", more)


def above(r: Results, *names: str, over: str, model: str | None = None) -> Evidence:
    """Return whether the lowest of `names` lies above the highest of `over` at every point."""
    high, low = (_curves(r, group, _models(model)) for group in (names, tuple(over.split(","))))
    return _share(high.min(axis=0) > low.max(axis=0), "points")


# What heating does


def lowered_by_heat(r: Results, *names: str) -> Evidence:
    """Return whether the THD magnitude lies below the isothermal one at every point."""
    found = np.abs(_curves(r, names))
    return _share(found[:, 1] < found[:, 0], "points")


def effect_falls_with_clearance(r: Results, *names: str) -> Evidence:
    """Return whether the reduction at the top speed is smaller for the larger clearance."""
    found = _reductions(r, names)
    means = ", ".join(f"{mean:.1f}" for mean in found.mean(axis=0))
    average = " on average" if len(names) > 1 else ""
    more = f"reductions {means} % at 100, 125, 150 µm{average}"
    return _share(np.diff(found, axis=1) < 0.0, "steps of clearance", more)


def effect_grows_with_speed(r: Results, *names: str) -> Evidence:
    """Return whether the reduction at the top speed exceeds that at the lowest one."""
    slow, fast = (np.abs(_reductions(r, names, rpm)) for rpm in (SPEEDS[0], TOP_SPEED))
    more = f"at most {slow.max():.2g} % at 500 rpm, {fast.max():.2g} % at 15 000 rpm"
    return _share(slow < fast, "cases", more)


def _extreme(
    r: Results, wanted: str, names: tuple[str, ...], pick: Callable[..., NDArray[np.intp]]
) -> Evidence:
    found = [names[i] for i in pick(_reductions(r, names), axis=0)]
    more = f"it is {', '.join(dict.fromkeys(found))}"
    return _share([name == wanted for name in found], "clearances", more)


def most_reduced(r: Results, wanted: str, *names: str) -> Evidence:
    """Return whether heating lowers `wanted` most among `names`."""
    return _extreme(r, wanted, names, np.argmax)


def least_reduced(r: Results, wanted: str, *names: str) -> Evidence:
    """Return whether heating lowers `wanted` least among `names`."""
    return _extreme(r, wanted, names, np.argmin)


def cross_damping_most_reduced(r: Results) -> Evidence:
    """Return whether heating lowers each cross damping more than each direct one, 100 µm."""
    fall: dict[str, float] = dict(zip(DAMPING, _reductions(r, DAMPING)[:, 0], strict=True))
    pairs = [(cross, direct) for cross in ("cxy", "cyx") for direct in ("cxx", "cyy")]
    more = ", ".join(f"{name} {x:.1f} %" for name, x in fall.items())
    return _share([fall[a] > fall[b] for a, b in pairs], "comparisons", more)


def stiffness_reductions_differ(r: Results) -> Evidence:
    """Return whether reductions of different stiffnesses, and of one over clearance, differ."""
    found = _reductions(r, STIFFNESS)
    gaps = np.diff(np.sort(found, axis=0), axis=0)
    ends = np.abs(found[:, 0] - found[:, -1])
    return _share(np.append(gaps, ends) > 1.0, "neighbouring reductions")


def window_of_mass(r: Results) -> Evidence:
    """Return whether some rotor is stable without heating and unstable with it, top speed."""
    low, high = (_over_clearances(r, "critical_mass", model) for model in (THD, ISOTHERMAL))
    text = ", ".join(f"{a:.0f} to {b:.0f} kg" for a, b in zip(low, high, strict=True))
    more = f"at 15 000 rpm rotors of {text} per bearing (100, 125, 150 µm)"
    return _share(low < high, "clearances", more)


# Profiles around the film (Fig. 3)


def _profiles(r: Results, *models: str) -> Iterator[tuple[_Array, ...]]:
    for model in models:
        for rpm in FILM_SPEEDS:
            profile = r.profile(model, rpm)
            _known(profile)
            yield profile


def peak_angle(r: Results) -> Evidence:
    """Return the angle of the highest pressure that is farthest from minimum film thickness."""
    angles = np.array([angle[np.argmax(p)] for angle, p, _, _ in _profiles(r, *_BOTH)])
    farthest = angles[np.argmax(np.abs(angles - 180.0))]
    return Evidence(float(farthest), f"peaks lie at {angles.min():.0f} to {angles.max():.0f} deg")


def pressure_likeness(r: Results) -> float:
    """Return the least correlation between any two pressure profiles."""
    return float(np.corrcoef([p for _, p, _, _ in _profiles(r, *_BOTH)]).min())


def temperature_likeness(r: Results) -> float:
    """Return the least correlation between the temperature profiles of any two speeds."""
    return float(np.corrcoef([mean for _, _, mean, _ in _profiles(r, THD)]).min())


def hot_after_minimum(r: Results) -> Evidence:
    """Return whether mean and hottest temperature are higher after minimum film thickness."""
    outcomes: list[bool] = []
    before = behind = math.nan
    for angle, _, mean, hottest in _profiles(r, THD):
        after = angle > 180.0
        before, behind = mean[~after].mean(), mean[after].mean()
        outcomes += [behind > before, angle[np.argmax(hottest)] > 180.0]
    more = f"at the top speed {before:.0f} degC before 180 deg, {behind:.0f} degC after it"
    return _share(outcomes, "comparisons of mean and peak", more)


def temperature_profile_rises(r: Results) -> Evidence:
    """Return whether the temperature profile rises with speed at every angle."""
    rows = [mean for _, _, mean, _ in _profiles(r, THD)]
    return _share(np.diff(rows, axis=0) > 0.0, "angles and steps of speed")


def pressure_profile_rises(r: Results) -> Evidence:
    """Return whether the pressure around minimum film thickness rises with speed."""
    outcomes = []
    for model in _BOTH:
        rows = list(_profiles(r, model))
        near = np.abs(rows[0][0] - 160.0) <= 30.0
        outcomes.append(np.diff([p[near] for _, p, _, _ in rows], axis=0) > 0.0)
    return _share(np.concatenate(outcomes, axis=1), "angles (130 to 190 deg) and steps of speed")


def peak_difference_grows(r: Results) -> Evidence:
    """Return whether isothermal and THD peak pressure part with speed."""
    cold, warm = (np.array([p.max() for _, p, _, _ in _profiles(r, m)]) for m in _BOTH)
    return _share(np.diff(cold - warm) > 0.0, "steps of speed")


def highest_mean_temperature(r: Results) -> float:
    """Return the highest mean across the film at mid-plane, 100 µm, top speed [degC]."""
    return float(r.profile(THD, TOP_SPEED)[2].max())
