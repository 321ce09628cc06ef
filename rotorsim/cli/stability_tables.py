"""Stability and orbits as tables."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..study.wording import RPM, VERDICTS, curve_title, number, thresholds_text, verdict_word
from .tables import grid

if TYPE_CHECKING:
    from rich.table import Table

    from ..study.stability import StabilityCurve


def curve_table(curve: StabilityCurve) -> Table:
    """One curve over speed.

    The critical mass is a rigid rotor's: beside another rotor it would not be that rotor's limit.
    """
    rigid = curve.eigenvalues is None or curve.mass is not None
    head = ["rpm", "M_crit kg", "M c w2/W", "whirl ratio", "verdict"] if rigid else ["rpm"]
    if curve.eigenvalues is not None:
        head += ["growth 1/s", "whirl rpm"] if rigid else ["verdict", "growth 1/s", "whirl rpm"]
    table = grid(curve_title(curve), *head)
    rates = curve.growth_rate
    for index, speed in enumerate(curve.speed):
        cells = [f"{speed * RPM:.0f}"]
        if rigid:
            cells += _threshold_cells(curve, index)
        if curve.eigenvalues is not None and rates is not None:
            slowest, rate = curve.eigenvalues[index, 0], float(rates[index])
            if not rigid:
                cells.append(verdict_word(rate) if math.isfinite(rate) else VERDICTS[""])
            cells += [number(rate), number(abs(slowest.imag) * RPM)]
        table.add_row(*cells)
    return table


def _threshold_cells(curve: StabilityCurve, index: int) -> list[str]:
    """Critical mass, dimensionless too, whirl ratio, and what they say of the mass."""
    mass = curve.critical_mass[index]
    verdict = str(curve.stability[index])
    said = VERDICTS.get(verdict)
    if verdict == "threshold" and curve.mass is not None:
        said = "stable" if curve.mass < mass else "unstable"
    return [
        number(mass),
        number(curve.critical_mass_dimensionless[index]),
        number(curve.whirl_frequency_ratio[index], 3),
        said or "stable below",
    ]


def summary_table(curves: Sequence[StabilityCurve]) -> Table:
    """Threshold speeds of all curves."""
    rotor = curves[0].rotor if curves else ""
    title = rotor[:1].upper() + rotor[1:] or "Critical mass"
    table = grid(title, "bearing", "least M_crit kg", "threshold speeds rpm")
    for curve in curves:
        known = curve.critical_mass[~_nan(curve.critical_mass)]
        least = number(float(known.min())) if len(known) else "-"
        table.add_row(curve_title(curve), least, thresholds_text(curve))
    return table


def orbit_table(rows: Sequence[Mapping[str, Any]]) -> Table:
    """One line for each orbit (see `pipeline.summary.describe_orbit`)."""
    head = ["model", "run", "rpm", "turns", "eps", "growth 1/s"]
    expected = any("eigenvalue_growth_rate" in row for row in rows)
    head += ["expected", "outcome"] if expected else ["outcome"]
    by = "; expected: by the eigenvalues" if expected else ""
    table = grid(f"Orbits (eps: the largest{by})", *head)
    for row in rows:
        first, last = (speed * RPM for speed in row["speed"])
        speeds = f"{last:.0f}" if math.isclose(first, last) else f"{first:.0f}-{last:.0f}"
        table.add_row(
            row["thermal_model"],
            row["kind"].removesuffix(" speed"),
            speeds,
            number(row["revolutions"]),
            number(row["max_eccentricity_ratio"], 3),
            number(row["growth_rate"]),
            *([number(row.get("eigenvalue_growth_rate"))] if expected else []),
            row["status"].value.replace("_", " "),
        )
    return table


def orbit_details(rows: Sequence[Mapping[str, Any]]) -> list[Any]:
    """What each run came to: whirl, ellipse, least film; and what its force takes for granted."""
    table = grid("What they come to", "model", "whirl ratio", "swing um", "ellipse um", "h_min um")
    notes = []
    for row in rows:
        table.add_row(
            row["thermal_model"],
            number(row["whirl_frequency_ratio"]),
            number(row["amplitude"] * 1e6),
            _ellipse_text(row["whirl"] or row["synchronous"]),
            number(row["min_film"] * 1e6),
        )
        found = row["whirl_range"]
        if found is not None:
            first, last, most = (
                f"{found[key] * RPM:.0f}"
                for key in ("first_speed", "last_speed", "strongest_speed")
            )
            size = f"{number(found['amplitude'] * 1e6, 3)} um"
            pitch = f"{found['frequency'] * RPM / 60.0:.1f} Hz"
            notes.append(
                f"{row['thermal_model']}: whirls from {first} to {last} rpm, most at {most} rpm: "
                f"{size} at {pitch}"
            )
        notes += [f"{row['thermal_model']}: {row['message']}"] if row["message"] else []
    return [table, *notes]


def _ellipse_text(ellipse: Mapping[str, Any] | None) -> str:
    if ellipse is None:
        return "-"
    axes = f"{number(ellipse['semi_major'] * 1e6, 3)} x {number(ellipse['semi_minor'] * 1e6, 3)}"
    return f"{axes} {ellipse['direction']}"


def _nan(values: Any) -> Any:
    import numpy as np

    return ~np.isfinite(values)
