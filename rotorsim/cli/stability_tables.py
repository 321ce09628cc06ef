"""Stability and orbits as tables."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from .tables import RPM, grid, number

if TYPE_CHECKING:
    from rich.table import Table

    from ..pipeline import StabilityCurve

_VERDICTS = {
    "always_stable": "stable at any mass",
    "always_unstable": "unstable at any mass",
    "reversed_threshold": "stable above",
    "": "not converged",
}


def curve_title(curve: StabilityCurve) -> str:
    """``thd, c = 100 um``, and what else the table was stacked along."""
    extra = [
        f"{name} = {number(value)}"
        for name, value in curve.choices.items()
        if name not in ("thermal_model", "radial_clearance")
    ]
    clearance = f"c = {number(curve.choices['radial_clearance'] * 1e6)} um"
    return ", ".join([str(curve.choices["thermal_model"]), clearance, *extra])


def curve_table(curve: StabilityCurve) -> Table:
    """One curve over speed."""
    head = ["rpm", "M_crit kg", "M c w2/W", "whirl ratio", "verdict"]
    if curve.mass is not None:
        head += ["decay 1/s", "whirl rpm"]
    table = grid(curve_title(curve), *head)
    for index, speed in enumerate(curve.speed):
        mass = curve.critical_mass[index]
        verdict = str(curve.stability[index])
        said = _VERDICTS.get(verdict)
        if verdict == "threshold" and curve.mass is not None:
            said = "stable" if curve.mass < mass else "unstable"
        cells = [
            f"{speed * RPM:.0f}",
            number(mass),
            number(curve.critical_mass_dimensionless[index]),
            number(curve.whirl_frequency_ratio[index], 3),
            said or "stable below",
        ]
        if curve.eigenvalues is not None:
            slowest = curve.eigenvalues[index, 0]
            cells += [number(-slowest.real), number(abs(slowest.imag) * RPM)]
        table.add_row(*cells)
    return table


def summary_table(curves: Sequence[StabilityCurve]) -> Table:
    """Threshold speeds of all curves."""
    mass = curves[0].mass if curves else None
    title = "Critical mass" if mass is None else f"Rotor of {number(mass)} kg per bearing"
    table = grid(title, "bearing", "least M_crit kg", "threshold speeds rpm")
    for curve in curves:
        known = curve.critical_mass[~_nan(curve.critical_mass)]
        least = number(float(known.min())) if len(known) else "-"
        table.add_row(curve_title(curve), least, thresholds_text(curve))
    return table


def thresholds_text(curve: StabilityCurve) -> str:
    """Threshold speeds, or which verdict holds throughout."""
    if curve.threshold_speeds:
        return ", ".join(f"{speed * RPM:.0f}" for speed in curve.threshold_speeds)
    if curve.decay_rate is None:
        return "-"
    known = curve.decay_rate[~_nan(curve.decay_rate)]
    if not len(known):
        return "-"
    return "none: stable throughout" if known.min() > 0.0 else "none: unstable throughout"


def orbit_table(rows: Sequence[Mapping[str, Any]]) -> Table:
    """One line for each orbit (see `pipeline.summary.describe_orbit`)."""
    head = ["model", "run", "rpm", "turns", "max eps", "growth 1/s"]
    expected = any("eigenvalue_growth_rate" in row for row in rows)
    head += ["eigenvalue", "outcome"] if expected else ["outcome"]
    table = grid("Orbits", *head)
    for row in rows:
        first, last = (speed * RPM for speed in row["speed"])
        speeds = f"{last:.0f}" if math.isclose(first, last) else f"{first:.0f}-{last:.0f}"
        table.add_row(
            row["thermal_model"],
            row["kind"],
            speeds,
            number(row["revolutions"]),
            number(row["max_eccentricity_ratio"], 3),
            number(row["growth_rate"]),
            *([number(row.get("eigenvalue_growth_rate"))] if expected else []),
            row["status"].value.replace("_", " "),
        )
    return table


def _nan(values: Any) -> Any:
    import numpy as np

    return ~np.isfinite(values)
