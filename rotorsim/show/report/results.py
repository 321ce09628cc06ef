"""Tables of what came out."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...study.summary import describe_orbit
from ...study.wording import (
    RPM,
    ZERO_CELSIUS,
    critical_mass_text,
    curve_title,
    number,
    thresholds_text,
    verdict_at_top,
    wall_share_text,
)
from . import html

if TYPE_CHECKING:
    from ...bearing.operating_point import OperatingPoint
    from ...bearing.table import CoefficientTable
    from ...orbit import Orbit
    from ...study.stability import StabilityCurve

POINT_HEAD = (
    "rpm", "ε", "φ °", "load kN", "S", "h min µm", "p max MPa", "T max °C", "T mean °C",
    "T out °C", "friction N", "loss kW", "side flow L/min", "to walls %", "M crit kg", "status",
)  # fmt: skip
TOP_HEAD = (
    "ε", "φ °", "load kN", "h min µm", "p max MPa", "T max °C", "T out °C", "loss kW",
    "side flow L/min", "to walls %", "M crit kg", "status",
)  # fmt: skip
"""At the highest speed; the appendix has every number."""
COEFFICIENT_HEAD = (
    "rpm", "Kxx", "Kxy", "Kyx", "Kyy", "Cxx", "Cxy", "Cyx", "Cyy"
)  # fmt: skip


def point_row(point: OperatingPoint) -> list[str]:
    """One operating point under `POINT_HEAD`."""
    return [
        f"{point.speed * RPM:.0f}",
        number(point.eccentricity_ratio, 3),
        number(math.degrees(point.attitude_angle), 3),
        number(point.load / 1e3),
        number(point.sommerfeld_number),
        number(point.min_film_thickness * 1e6, 3),
        number(point.max_pressure / 1e6, 3),
        number(point.max_temperature - ZERO_CELSIUS, 3),
        number(point.mean_temperature - ZERO_CELSIUS, 3),
        number(
            None if point.outlet_temperature is None else point.outlet_temperature - ZERO_CELSIUS, 3
        ),
        number(point.friction_force),
        number(point.power_loss / 1e3),
        number(point.side_flow * 6e4),
        wall_share_text(point),
        critical_mass_text(point),
        point.status.value.replace("_", " "),
    ]


def top_points(points: Sequence[OperatingPoint]) -> str:
    """Operating points at the highest speed, one line for each thermal model and clearance."""
    top = max((point.speed for point in points), default=0.0)
    chosen = [POINT_HEAD.index(name) for name in TOP_HEAD]
    rows = []
    for point in points:
        if point.speed == top:
            cells = point_row(point)
            clearance = number(point.radial_clearance * 1e6)
            rows.append([point.thermal_model, clearance, *(cells[place] for place in chosen)])
    head = ("model", "c µm", *TOP_HEAD)
    return _wide(html.table(head, rows, f"At {top * RPM:.0f} rpm", texts=1)) if rows else ""


def all_points(points: Sequence[OperatingPoint]) -> str:
    """Every operating point, a table for each thermal model and clearance."""
    groups = itertools.groupby(points, lambda p: (p.thermal_model, p.radial_clearance))
    return "\n".join(
        _wide(html.table(POINT_HEAD, map(point_row, group), _title(*key), texts=0))
        for key, group in groups
    )


def coefficients(table: CoefficientTable) -> str:
    """K and C over speed, a table for each curve."""
    parts = []
    for index in np.ndindex(table.converged.shape[:-1]):
        chosen = [
            table.dataset[name].values[place]
            for name, place in zip(table.choices, index, strict=True)
        ]
        names = dict(zip(table.choices, chosen, strict=True))
        title = _title(str(names["thermal_model"]), float(names["radial_clearance"]))
        rows = _coefficient_rows(table, index)
        caption = f"{title}: K in MN/m, C in kN s/m"
        parts.append(_wide(html.table(COEFFICIENT_HEAD, rows, caption, texts=0)))
    return "\n".join(parts)


def _coefficient_rows(table: CoefficientTable, index: tuple[int, ...]) -> Iterator[list[str]]:
    stiffness, damping = table.stiffness[index] / 1e6, table.damping[index] / 1e3
    for speed, k, c in zip(table.speeds, stiffness, damping, strict=True):
        yield [f"{speed * RPM:.0f}", *(number(float(v)) for v in (*k.ravel(), *c.ravel()))]


def margins(curves: Sequence[StabilityCurve]) -> str:
    """Stability at the highest speed and how far from the border, bearing by bearing."""
    if not curves:
        return ""
    rotor, mass = curves[0].rotor, curves[0].mass
    top = curves[0].speed[-1] * RPM
    head = ["bearing", "M crit kg", "M c ω²/W", "whirl ratio"]
    if rotor:
        head += ["verdict", "threshold rpm", "growth 1/s", "log. decrement"]
    if mass is not None:
        head.append("mass margin")
    rows = [_margin_row(curve) for curve in curves]
    caption = f"At {top:.0f} rpm"
    if rotor:
        caption += f", {rotor}"
    return _wide(html.table(head, rows, caption, texts=1))


def _margin_row(curve: StabilityCurve) -> list[str]:
    critical = float(curve.critical_mass[-1])
    row = [
        curve_title(curve),
        number(critical) if math.isfinite(critical) else _verdict_words(curve),
        number(float(curve.critical_mass_dimensionless[-1])),
        number(float(curve.whirl_frequency_ratio[-1]), 3),
    ]
    if curve.growth_rate is None:
        return row
    row += [
        verdict_at_top(curve),
        thresholds_text(curve),
        number(float(curve.growth_rate[-1])),
        number(log_decrement(curve)),
    ]
    if curve.mass is not None:
        part = 100.0 * (1.0 - curve.mass / critical)
        row.append(f"{part:.1f} %" if math.isfinite(part) else "-")
    return row


def _verdict_words(curve: StabilityCurve) -> str:
    return str(curve.stability[-1]).replace("_", " ") or "-"


def log_decrement(curve: StabilityCurve) -> float | None:
    """Of the slowest mode at the highest speed, 2 pi a/omega_d; None where it does not swing."""
    if curve.eigenvalues is None:
        return None
    slowest = complex(curve.eigenvalues[-1, 0])
    if not math.isfinite(slowest.real) or abs(slowest.imag) <= 1e-9 * abs(slowest):
        return None
    return -2.0 * math.pi * slowest.real / abs(slowest.imag)


def orbits(several: Sequence[Orbit]) -> str:
    """One line for each orbit."""
    rows = []
    for orbit in several:
        said = describe_orbit(orbit)
        first, last = (speed * RPM for speed in said["speed"])
        speeds = f"{last:.0f}" if math.isclose(first, last) else f"{first:.0f} to {last:.0f}"
        rows.append(
            [
                said["thermal_model"],
                said["kind"],
                number(said["radial_clearance"] * 1e6),
                speeds,
                number(said["revolutions"]),
                number(said["max_eccentricity_ratio"], 3),
                number(said["growth_rate"]),
                said["status"].value.replace("_", " "),
            ]
        )
    head = ("model", "run", "c µm", "rpm", "turns", "max ε", "growth 1/s", "outcome")
    return html.table(head, rows, texts=2) if rows else ""


def _title(model: str, clearance: float) -> str:
    known = f", c = {number(clearance * 1e6)} µm" if math.isfinite(clearance) else ""
    return f"{model}{known}"


def _wide(table: str) -> str:
    return f'<div class="wide">{table}</div>'
