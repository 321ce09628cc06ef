"""What the claims about Fig. 3 ask of the film's fields: profiles around the bearing."""

from __future__ import annotations

import numpy as np

from ..model.lubricant import ZERO_CELSIUS
from .claim import Evidence
from .evidence import share
from .paper import TOP_RPM
from .results import ISOTHERMAL, THD, Array, PaperResults

FULL_TURN = 2.0 * np.pi


def profile(r: PaperResults, model: str, rpm: float) -> tuple[Array, Array, Array, Array]:
    """Mid-plane profiles over the paper's angle.

    Returns
    -------
    angle : (n,) array
        From maximum film thickness in the direction of rotation [deg], ascending: the paper's theta
        (its film is 1 + eps cos(theta - theta_a)).
    pressure : (n,) array
        [Pa]
    mean, hottest : (n,) arrays
        Temperature across the film [degC].
    """
    point, fields = r.films[model, rpm], r.field(model, rpm)
    angle = np.mod(fields.theta - point.attitude_angle - np.pi, FULL_TURN)
    order = np.argsort(angle)
    middle = fields.y.size // 2
    temperature = fields.temperature[order, middle] - ZERO_CELSIUS
    return (
        np.degrees(angle[order]),
        fields.pressure[order, middle],
        temperature.mean(axis=1),
        temperature.max(axis=1),
    )


def all_profiles(r: PaperResults, model: str) -> list[tuple[Array, Array, Array, Array]]:
    """Profiles of one thermal model over ascending speed."""
    return [profile(r, m, rpm) for m, rpm in sorted(r.films) if m == model]


def peak_angle(r: PaperResults) -> Evidence:
    """Angle of the highest pressure, the one farthest from minimum film thickness."""
    angles = [
        angle[int(np.argmax(pressure))]
        for model in (ISOTHERMAL, THD)
        for angle, pressure, _, _ in all_profiles(r, model)
    ]
    farthest = max(angles, key=lambda angle: abs(angle - 180.0))
    return Evidence(float(farthest), f"peaks lie at {min(angles):.0f} to {max(angles):.0f} deg")


def pressure_likeness(r: PaperResults) -> float:
    """Least correlation between any two pressure profiles."""
    rows = [p for model in (ISOTHERMAL, THD) for _, p, _, _ in all_profiles(r, model)]
    return float(np.corrcoef(rows).min())


def temperature_likeness(r: PaperResults) -> float:
    """Least correlation between temperature profiles of any two speeds."""
    return float(np.corrcoef([t for _, _, t, _ in all_profiles(r, THD)]).min())


def hot_side(r: PaperResults) -> Evidence:
    """Whether the film is hotter, on average and at its hottest, after minimum thickness."""
    outcomes, means = [], (0.0, 0.0)
    for angle, _, mean, hottest in all_profiles(r, THD):
        after = angle > 180.0
        means = (float(mean[~after].mean()), float(mean[after].mean()))
        outcomes += [means[1] > means[0], bool(angle[int(np.argmax(hottest))] > 180.0)]
    more = f"at the top speed {means[0]:.0f} degC before 180 deg, {means[1]:.0f} degC after it"
    return share(outcomes, "comparisons of mean and peak", more)


def hotter_with_speed(r: PaperResults) -> Evidence:
    """Whether the whole temperature profile rises with speed."""
    rows = np.array([mean for _, _, mean, _ in all_profiles(r, THD)])
    return share(list((np.diff(rows, axis=0) > 0.0).flat), "angles and steps of speed")


def pressure_with_speed(r: PaperResults) -> Evidence:
    """Whether the pressure around minimum film thickness rises with speed."""
    outcomes: list[bool | np.bool_] = []
    for model in (ISOTHERMAL, THD):
        rows = all_profiles(r, model)
        near = np.abs(rows[0][0] - 160.0) <= 30.0
        outcomes += list((np.diff([p[near] for _, p, _, _ in rows], axis=0) > 0.0).flat)
    return share(outcomes, "angles (130 to 190 deg) and steps of speed")


def gap_with_speed(r: PaperResults) -> Evidence:
    """Whether isothermal and THD peak pressure part with speed."""
    cold = np.array([p.max() for _, p, _, _ in all_profiles(r, ISOTHERMAL)])
    warm = np.array([p.max() for _, p, _, _ in all_profiles(r, THD)])
    return share(list(np.diff(cold - warm) > 0.0), "steps of speed")


def highest_mean_temperature(r: PaperResults) -> float:
    """Highest mean across the film at mid-plane, top speed [degC]."""
    return float(profile(r, THD, TOP_RPM)[2].max())
