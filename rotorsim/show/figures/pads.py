"""Sections through tilting-pad bearings: pads as they stand, and their films."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from ...bearing.operating_point import FilmFields, OperatingPoint, PadResult
from ...errors import InputError
from ...film.geometry import pad_face
from ...model import Bearing, Pad
from ...rows import RPM, ZERO_CELSIUS, axis_title, in_shown_unit, number, with_unit
from .style import MEGA, model_label, new_axes

Array = NDArray[np.float64]
_DRAWN_CLEARANCE = 0.25
"""Clearance as drawn, in journal radii."""


def pad_sections(points: Sequence[OperatingPoint], bearing: Bearing, title: str = "") -> Figure:
    """Return sections at mid-plane, a row for each film: pressure, and temperature where it varies.

    Pads stand as they are tilted, the clearance drawn far too large; the load points down, the
    shaft turns counter-clockwise.

    points : With their fields.
    bearing : With pads, in the load frame.

    Raises InputError: A point was solved without its fields.
    """
    films = []
    for point in points:
        if point.fields is None:
            raise InputError("the operating point was solved without its fields", key="fields")
        films.append(point.fields)
    warm = [bool(np.ptp(film.temperature) > 1e-6) for film in films]
    columns = 2 if any(warm) else 1
    size = (5.2 * columns, 0.4 + 4.8 * len(films))
    figure, axes = new_axes(len(films), columns, size, title)
    top = in_shown_unit(max(float(film.pressure.max()) for film in films) * MEGA, "MPa")
    for row, point, film, heated in zip(axes, points, films, warm, strict=True):
        middle = int(np.abs(film.y).argmin())
        name = f"{model_label(point.thermal_model)}, {point.speed * RPM:.0f} rpm"
        pressure = in_shown_unit(film.pressure[:, middle] * MEGA, "MPa")
        shown = [(row[0], pressure, (0.0, top or 1.0), "viridis", axis_title("pressure", "MPa"))]
        if heated:
            mean = in_shown_unit(film.temperature[:, middle].mean(axis=1) - ZERO_CELSIUS, "°C")
            span = float(mean.min()), float(mean.max())
            shown.append((row[1], mean, span, "inferno", axis_title("mean across the film", "°C")))
        for ax in row[len(shown) :]:
            ax.set_axis_off()
        for ax, values, span, colours, label in shown:
            bearing_here = _Section(bearing, point, film)
            filled = bearing_here.draw(ax, values, span, colours)
            ax.set_title(f"{name}: {label}")
            figure.colorbar(filled, ax=ax, shrink=0.75, pad=0.02)
    return figure


class _Section:
    """Lengths in journal radii, drawn with y to the right and x down."""

    def __init__(self, bearing: Bearing, point: OperatingPoint, film: FilmFields) -> None:
        self.bearing, self.point, self.film = bearing, point, film
        self.scale = _DRAWN_CLEARANCE / point.radial_clearance
        size = point.eccentricity_ratio * _DRAWN_CLEARANCE
        self.centre = size * np.array([np.cos(point.attitude_angle), np.sin(point.attitude_angle)])

    def draw(
        self, ax: Axes, values: Array, span: tuple[float, float], colours: str
    ) -> PolyCollection:
        """Draw journal, pads and the film coloured by `values` (n,)."""
        turn = np.linspace(0.0, 2.0 * np.pi, 181)
        journal = self.centre + np.column_stack([np.cos(turn), np.sin(turn)])
        ax.add_patch(Polygon(_seen(journal), facecolor="#c8ccd2", edgecolor="0.3"))
        ax.plot(*_seen(self.centre), "k+", markersize=7)
        ax.plot(0.0, 0.0, "k.", markersize=3)
        quads, painted = [], []
        for place, pad in enumerate(self.bearing.pads):
            state = self.point.pads[place]
            self._draw_pad(ax, place, pad, state)
            edges, inside = self._cells(pad)
            outer, inner = self._face(pad, state, edges), self.centre + _unit(edges)
            corners = np.stack([inner[:-1], outer[:-1], outer[1:], inner[1:]], axis=1)
            quads += list(_seen(corners))
            painted += list(values[inside])
        film = PolyCollection(
            quads, array=np.array(painted), cmap=colours, edgecolors="face", linewidths=0.2
        )
        film.set_clim(*span)
        ax.add_collection(film)
        ax.annotate("load", (0.0, -0.85), (0.0, -0.35), ha="center",
                    arrowprops={"arrowstyle": "-|>", "color": "k"})  # fmt: skip
        reach = 1.7 + max(pad.thickness for pad in self.bearing.pads) / self.bearing.journal_radius
        ax.set(xlim=(-reach - 0.4, reach + 0.4), ylim=(-reach, reach), aspect="equal")
        ax.set_axis_off()
        return film

    def _cells(self, pad: Pad) -> tuple[Array, NDArray[np.intp]]:
        """Return angles between the cells of a pad (k + 1,), and the cells' places (k,)."""
        turned = (self.film.theta - pad.leading_edge) % (2.0 * np.pi)
        inside = np.flatnonzero(turned < pad.arc)
        inside = inside[np.argsort(turned[inside])]
        return np.linspace(pad.leading_edge, pad.trailing_edge, inside.size + 1), inside

    def _face(self, pad: Pad, state: PadResult, theta: Array) -> Array:
        face = pad_face(self.bearing, pad, theta, state.tilt, state.pivot_displacement)
        return (1.0 + self.scale * face)[:, None] * _unit(theta)

    def _draw_pad(self, ax: Axes, place: int, pad: Pad, state: PadResult) -> None:
        theta = np.linspace(pad.leading_edge, pad.trailing_edge, 41)
        back = 1.0 + _DRAWN_CLEARANCE + pad.thickness / self.bearing.journal_radius
        outline = np.concatenate([self._face(pad, state, theta), back * _unit(theta[::-1])])
        look: dict[str, Any] = {"facecolor": "#eceef1", "edgecolor": "0.3"}
        if state.unloaded:
            look |= {"facecolor": "none", "linestyle": "--"}
        ax.add_patch(Polygon(_seen(outline), **look))
        towards = _unit(np.array([pad.pivot_angle]))[0]
        ax.plot(*_seen(back * towards), "^", color="0.3", markersize=4)
        text = f"{place + 1}: {with_unit(state.load / 1e3, 'kN', 3)}\n"
        text += f"{number(state.tilt * 1e3, 3)} mrad"
        if state.unloaded:
            text = f"{place + 1}: unloaded"
        side = float(towards[1])
        beside = "center" if abs(side) < 0.3 else "left" if side > 0.0 else "right"
        away = 0.3 if beside == "center" else 0.1
        right, up = _seen((back + away) * towards)
        ax.text(float(right), float(up), text, ha=beside, va="center", fontsize=8)


def _unit(theta: Array) -> Array:
    return np.column_stack([np.cos(theta), np.sin(theta)])


def _seen(points: Array) -> Array:
    """Turn x, y to the picture's right and up: y to the right, x down."""
    return np.stack([points[..., 1], -points[..., 0]], axis=-1)


__all__ = ["pad_sections"]
