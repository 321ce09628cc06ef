"""Stability and orbits as tables."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..orbit.description import ORBIT_HEADS, ellipse_text, orbit_texts, whirl_range_text
from ..rows import QUANTITIES, RPM, number
from ..study.wording import VERDICTS, curve_title, thresholds_text, verdict_word
from .tables import grid

if TYPE_CHECKING:
    from rich.table import Table

    from ..study.stability import StabilityCurve


_THRESHOLD = ("critical_mass", "critical_mass_dimensionless", "whirl_frequency_ratio")


def curve_table(curve: StabilityCurve) -> Table:
    """One curve over speed.

    The critical mass is a rigid rotor's: beside another rotor it would not be that rotor's limit.
    With tilting pads the last column is the growth rate that their coefficients, reduced at the
    shaft's frequency, would give.
    """
    rigid = curve.eigenvalues is None or curve.mass is not None
    head = ["rpm", *(QUANTITIES[name].head for name in _THRESHOLD), "verdict"] if rigid else ["rpm"]
    if curve.eigenvalues is not None:
        head += ["growth 1/s", "whirl rpm"] if rigid else ["verdict", "growth 1/s", "whirl rpm"]
    synchronous = curve.growth_rate_synchronous
    if synchronous is not None:
        head.append("synchronous 1/s")
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
        if synchronous is not None:
            cells.append(number(float(synchronous[index])))
        table.add_row(*cells)
    return table


def _threshold_cells(curve: StabilityCurve, index: int) -> list[str]:
    """Critical mass, dimensionless too, whirl ratio, and what they say of the mass."""
    mass = curve.critical_mass[index]
    verdict = str(curve.stability[index])
    said = VERDICTS.get(verdict)
    if verdict == "threshold" and curve.mass is not None:
        said = "stable" if curve.mass < mass else "unstable"
    values = (QUANTITIES[name].text(getattr(curve, name)[index]) for name in _THRESHOLD)
    return [*values, said or "stable below"]


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
    """One line for each orbit (see `rotorsim.orbit.description.describe_orbit`)."""
    expected = any("eigenvalue_growth_rate" in row for row in rows)
    columns = ["model", "run", "speed", "turns", "eccentricity", "growth"]
    columns += ["expected", "outcome"] if expected else ["outcome"]
    by = " (expected: by the eigenvalues)" if expected else ""
    table = grid(f"Orbits{by}", *(ORBIT_HEADS[name] for name in columns))
    for row in rows:
        texts = orbit_texts(row)
        texts["run"] = texts["run"].removesuffix(" speed")
        texts["speed"] = texts["speed"].replace(" to ", "-")
        table.add_row(*(texts[name] for name in columns))
    return table


def orbit_details(rows: Sequence[Mapping[str, Any]]) -> list[Any]:
    """What each run came to: whirl, ellipse, least film; and what its force takes for granted."""
    table = grid("What they come to", "model", "whirl ratio", "swing µm", "ellipse µm", "h_min µm")
    notes = []
    for row in rows:
        table.add_row(
            row["thermal_model"],
            number(row["whirl_frequency_ratio"]),
            number(row["amplitude"] * 1e6),
            ellipse_text(row["whirl"] or row["synchronous"]),
            number(row["min_film"] * 1e6),
        )
        if row["whirl_range"] is not None:
            notes.append(f"{row['thermal_model']}: {whirl_range_text(row['whirl_range'])}")
        notes += [f"{row['thermal_model']}: {row['message']}"] if row["message"] else []
    return [table, *notes]


def _nan(values: Any) -> Any:
    import numpy as np

    return ~np.isfinite(values)
