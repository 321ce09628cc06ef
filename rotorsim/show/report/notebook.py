"""Results in notebooks: what `_repr_html_` of the result classes gives."""

from __future__ import annotations

import base64
import math
from functools import singledispatch
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from ...bearing.operating_point import OperatingPoint
from ...bearing.table import CoefficientTable
from ...machine.map import StabilityMap
from ...orbit import Orbit
from ...study.stability import map_planes
from ...study.wording import RPM, ZERO_CELSIUS, critical_mass_text, number
from ..recordings import orbit_tracks
from . import html, results

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@singledispatch
def as_html(result: object) -> str:
    """Fragment of HTML with the most important of a result."""
    return f"<pre>{escape(repr(result))}</pre>"


@as_html.register
def _point(point: OperatingPoint) -> str:
    title = (
        f"{point.thermal_model}, c = {number(point.radial_clearance * 1e6)} µm, "
        f"{point.speed * RPM:.0f} rpm: {point.status.value}"
    )
    rows = [
        ("load", f"{number(point.load / 1e3)} kN"),
        ("eccentricity ratio", number(point.eccentricity_ratio)),
        ("attitude angle", f"{number(math.degrees(point.attitude_angle))}°"),
        ("Sommerfeld number", number(point.sommerfeld_number)),
        ("minimum film thickness", f"{number(point.min_film_thickness * 1e6)} µm"),
        ("maximum pressure", f"{number(point.max_pressure / 1e6)} MPa"),
        ("maximum temperature", f"{number(point.max_temperature - ZERO_CELSIUS)} °C"),
        ("power loss", f"{number(point.power_loss / 1e3)} kW"),
        ("side flow", f"{number(point.side_flow * 6e4)} L/min"),
        ("critical mass per bearing", f"{critical_mass_text(point)} kg"),
        ("whirl frequency ratio", number(point.whirl_frequency_ratio)),
    ]
    matrices = [
        [f"{letter} {axis}x, {axis}y", *(f"{value:.5g}" for value in row), unit]
        for letter, matrix, unit in (
            ("K", point.stiffness, "N/m"),
            ("C", point.damping, "N s/m"),
        )
        for axis, row in zip("xy", np.asarray(matrix), strict=True)
    ]
    notes = [note for note in (point.message, *point.warnings) if note]
    return "\n".join(
        [
            f"<div><strong>{escape(title)}</strong>",
            html.facts(rows),
            html.table(("", "", "", ""), matrices),
            html.listing(notes),
            "</div>",
        ]
    )


@as_html.register
def _table(table: CoefficientTable) -> str:
    sizes = ", ".join(f"{table.dataset.sizes[name]} × {name}" for name in table.dataset["kxx"].dims)
    low, high = table.speeds[0] * RPM, table.speeds[-1] * RPM
    good, total = int(table.converged.sum()), table.converged.size
    title = str(table.dataset.attrs.get("title", "Coefficient table"))
    return "\n".join(
        [
            f"<div><strong>{escape(title)}</strong>",
            html.paragraph(
                f"{sizes}; {low:.0f} to {high:.0f} rpm; {good} of {total} points converged"
            ),
            results.coefficients(table) if table.speeds.size <= 12 else _ends(table),
            "</div>",
        ]
    )


def _ends(table: CoefficientTable) -> str:
    """K and C at the lowest, the middle and the highest speed."""
    chosen = [0, table.speeds.size // 2, table.speeds.size - 1]
    return results.coefficients(CoefficientTable(table.dataset.isel(speed=chosen)))


@as_html.register
def _map(chart: StabilityMap) -> str:
    from ..figures import stability_map

    extra = [
        str(name)
        for name, size in chart.dataset.sizes.items()
        if name not in ("thermal_model", "radial_clearance", "speed", "mass") and size > 1
    ]
    if extra or min(chart.dataset.sizes["speed"], chart.dataset.sizes["mass"]) < 2:
        return f"<pre>{escape(repr(chart))}</pre>"
    drawn = [
        stability_map(
            plane.speed,
            plane.mass,
            plane.isothermal_growth,
            plane.heated_growth,
            title=f"c = {number(plane.radial_clearance * 1e6)} µm",
        )
        for plane in map_planes(chart)
    ]
    return f"<div>{''.join(map(_image, drawn))}</div>"


@as_html.register
def _orbit(orbit: Orbit) -> str:
    from ..figures import OrbitPicture, orbit_plot

    (track,) = orbit_tracks([orbit])
    picture = OrbitPicture(
        name=orbit.thermal_model,
        title=track.heading,
        x=orbit.x,
        y=orbit.y,
        radial_clearance=orbit.radial_clearance,
        equilibrium=np.asarray(orbit.equilibrium),
    )
    return f"<div>{results.orbits([orbit])}{_image(orbit_plot([picture]))}</div>"


def _image(drawn: Figure) -> str:
    from ..figures import figure_bytes

    coded = base64.b64encode(figure_bytes(drawn, "png", dpi=110)).decode("ascii")
    return f'<img alt="" src="data:image/png;base64,{coded}">'
