"""Tables of what came out."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ...bearing.description import (
    COEFFICIENT_HEAD,
    coefficient_tables,
    curve_title,
    point_status,
    point_text,
)
from ...orbit.description import ORBIT_HEADS, describe_orbit, orbit_texts
from ...rows import QUANTITIES, RPM, heads, number, shown, table_html
from ...study.measured import deviation_rows, deviations

if TYPE_CHECKING:
    from ...bearing.operating_point import OperatingPoint
    from ...bearing.table import CoefficientTable
    from ...orbit import Orbit
    from ...study.main_job import Results
    from ...study.stability import StabilityCurve

_POINT = (
    "speed", "eccentricity_ratio", "attitude_angle", "load", "sommerfeld_number",
    "min_film_thickness", "max_pressure", "max_temperature", "mean_temperature",
    "shaft_temperature", "hot_radial_clearance", "outlet_temperature", "friction_force",
    "power_loss", "side_flow", "wall_heat_share", "critical_mass",
)  # fmt: skip
_AT_TOP = (
    "radial_clearance", "eccentricity_ratio", "attitude_angle", "load", "min_film_thickness",
    "max_pressure", "max_temperature", "outlet_temperature", "power_loss", "side_flow",
    "wall_heat_share", "critical_mass",
)  # fmt: skip
"""At the highest speed; the appendix has every number."""


def top_points(points: Sequence[OperatingPoint]) -> str:
    """Return operating points at the highest speed.

    One line for each thermal model and clearance.
    """
    top = max((point.speed for point in points), default=0.0)
    rows = [
        [point.thermal_model, *(point_text(point, name) for name in _AT_TOP), point_status(point)]
        for point in points
        if point.speed == top
    ]
    head = ("model", *(QUANTITIES[name].head for name in _AT_TOP), "status")
    return _wide(table_html(head, rows, f"At {top * RPM:.0f} rpm")) if rows else ""


def all_points(points: Sequence[OperatingPoint]) -> str:
    """Return every operating point, a table for each thermal model and clearance."""
    head = (*(QUANTITIES[name].head for name in _POINT), "status")
    return "\n".join(
        _wide(
            table_html(
                head,
                [[*(point_text(one, name) for name in _POINT), point_status(one)] for one in group],
                curve_title(*curve),
                texts=0,
            )
        )
        for curve, group in itertools.groupby(
            points, lambda one: (one.thermal_model, one.radial_clearance)
        )
    )


def coefficients(table: CoefficientTable) -> str:
    """Return K and C over speed, a table for each curve."""
    return "\n".join(
        _wide(table_html(COEFFICIENT_HEAD, rows, title, texts=0))
        for title, rows in coefficient_tables(table)
    )


def margins(curves: Sequence[StabilityCurve]) -> str:
    """Return the stability at the highest speed and how far from the border, bearing by bearing."""
    if not curves:
        return ""
    rotor, mass = curves[0].rotor, curves[0].mass
    top = curves[0].speed[-1] * RPM
    head = ["bearing", *heads("M crit kg"), "M c ω²/W", "whirl ratio"]
    if rotor:
        head += ["verdict", "threshold rpm", "growth 1/s", "log. decrement"]
    if mass is not None:
        head.append("mass margin")
    if any(curve.growth_rate_synchronous is not None for curve in curves):
        head += ["synchronous: growth 1/s", "threshold rpm"]
    rows = [_margin_row(curve) for curve in curves]
    caption = f"At {top:.0f} rpm"
    if rotor:
        caption += f", {rotor}"
    return _wide(table_html(head, rows, caption))


def _margin_row(curve: StabilityCurve) -> list[str]:
    critical = float(curve.critical_mass[-1])
    row = [
        curve.title,
        shown(critical, "kg") if math.isfinite(critical) else _verdict_words(curve),
        number(float(curve.critical_mass_dimensionless[-1])),
        number(float(curve.whirl_frequency_ratio[-1]), 3),
    ]
    if curve.growth_rate is None:
        return row
    row += [
        curve.verdict or "-",
        curve.thresholds_text,
        number(float(curve.growth_rate[-1])),
        number(_log_decrement(curve)),
    ]
    if curve.mass is not None:
        part = 100.0 * (1.0 - curve.mass / critical)
        row.append(f"{part:.1f} %" if math.isfinite(part) else "-")
    if curve.growth_rate_synchronous is not None:
        row += [
            number(float(curve.growth_rate_synchronous[-1])),
            ", ".join(f"{one * RPM:.0f}" for one in curve.threshold_speeds_synchronous) or "none",
        ]
    return row


def _verdict_words(curve: StabilityCurve) -> str:
    return str(curve.stability[-1]).replace("_", " ") or "-"


def _log_decrement(curve: StabilityCurve) -> float | None:
    """Return 2 pi a/omega_d of the slowest mode at the highest speed; None without swing."""
    if curve.eigenvalues is None:
        return None
    slowest = complex(curve.eigenvalues[-1, 0])
    if not math.isfinite(slowest.real) or abs(slowest.imag) <= 1e-9 * abs(slowest):
        return None
    return -2.0 * math.pi * slowest.real / abs(slowest.imag)


def orbits(several: Sequence[Orbit]) -> str:
    """Return one line for each orbit."""
    columns = [name for name in ORBIT_HEADS if name != "expected"]
    rows = []
    for orbit in several:
        texts = orbit_texts(describe_orbit(orbit))
        rows.append([texts[name] for name in columns])
    head = [ORBIT_HEADS[name] for name in columns]
    return table_html(head, rows, texts=2) if rows else ""


def _wide(table: str) -> str:
    return f'<div class="wide">{table}</div>'


def measured(found: Results) -> str:
    """Return what the computed curves are off from the measured points; nothing without."""
    head, rows = deviation_rows(deviations(found.table, found.measured))
    return _wide(table_html(head, rows, "Computed less measured", texts=2)) if rows else ""
