"""One bearing: stiffness, damping and thresholds against speed; pressure and temperature."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator, MultipleLocator
from numpy.typing import NDArray

from ...bearing.operating_point import FilmFields, OperatingPoint
from ...bearing.table import CoefficientTable
from ...errors import InputError
from ...model import Bearing
from ...rows import QUANTITIES, RPM, ZERO_CELSIUS, axis_title, in_shown_unit, number, shown_unit
from ...study.measured import Measured, curves, shown_as
from ...study.stability import StabilityCurve
from ...text import caption
from .style import (
    MARKERS,
    MEGA,
    axes_or_new,
    figure_of,
    keep_field,
    model_label,
    model_style,
    new_axes,
)

Array = NDArray[np.float64]


def coefficients_over_speed(table: CoefficientTable, title: str = "") -> Figure:
    """Return the eight coefficients against speed: line style by model, marker by clearance."""
    figure, axes = new_axes(2, 4, (11.5, 5.2), title, sharex=True)
    clearances = table.dataset["radial_clearance"].values.astype(float)
    for row, (symbol, unit) in enumerate((("K", "MN/m"), ("C", "kN s/m"))):
        values = table.stiffness / 1e6 if symbol == "K" else table.damping / 1e3
        values = in_shown_unit(values, unit)
        for column, (i, j) in enumerate(((0, 0), (0, 1), (1, 0), (1, 1))):
            ax = axes[row, column]
            ax.set_title(axis_title(rf"${symbol}_{{{'xy'[i]}{'xy'[j]}}}$", unit))
            ax.axhline(0.0, color="0.6", linewidth=0.6)
            for index in np.ndindex(values.shape[:-3]):
                names = dict(zip(table.choices, index, strict=True))
                model = str(table.dataset["thermal_model"].values[names["thermal_model"]])
                clearance = float(clearances[names["radial_clearance"]])
                look = _look(model, clearance, clearances, table.speeds.size)
                ax.plot(table.speeds * RPM, values[index][:, i, j], **look)
    for ax in axes[1]:
        ax.set_xlabel(QUANTITIES["speed"].axis)
    _legend_below(figure, axes[0, 0])
    return figure


def measured_points(
    table: CoefficientTable, measured: Sequence[Measured], title: str = ""
) -> Figure:
    """Draw measured points over the computed curves, a panel for each result."""
    columns = min(len(measured), 3)
    rows = -(-len(measured) // columns)
    figure, axes = new_axes(rows, columns, (3.9 * columns + 0.4, 3.0 * rows + 0.9), title)
    clearances = table.dataset["radial_clearance"].values.astype(float)
    for ax, one in zip(axes.flat, measured, strict=False):
        kind = shown_as(one.name)
        for model, clearance, values in curves(table, one.name):
            look = _look(model, clearance, clearances, table.speeds.size)
            ax.plot(table.speeds * RPM, kind.shown(values), **look)
        ax.plot(
            one.speed * RPM, kind.shown(one.value), "D", color="k", mfc="w", ms=5, zorder=5,
            label="measured",
        )  # fmt: skip
        ax.set(xlabel=QUANTITIES["speed"].axis, ylabel=kind.axis)
    for ax in list(axes.flat)[len(measured) :]:
        ax.set_visible(False)
    _legend_below(figure, axes[0, 0])
    return figure


def thresholds_over_speed(
    curves: Sequence[StabilityCurve], rotor_mass: float | None = None, title: str = ""
) -> Figure:
    """Return the critical mass (logarithmic) and whirl frequency ratio against speed."""
    figure, axes = new_axes(1, 2, (9.0, 3.8), title)
    left, right = axes[0]
    clearances = np.array([curve.choices["radial_clearance"] for curve in curves])
    for curve in curves:
        model, clearance = curve.choices["thermal_model"], curve.choices["radial_clearance"]
        look = _look(model, clearance, clearances, curve.speed.size)
        left.semilogy(curve.speed * RPM, curve.critical_mass, **look)
        right.plot(curve.speed * RPM, curve.whirl_frequency_ratio, **look)
    if rotor_mass is not None:
        left.axhline(rotor_mass, color="k", linewidth=1.0)
        left.annotate(
            f"rotor {QUANTITIES['mass'].said(rotor_mass)}",
            (0.98, rotor_mass),
            xycoords=("axes fraction", "data"),
            ha="right",
            va="bottom",
            fontsize=8,
        )
    left.set_ylabel(QUANTITIES["critical_mass"].axis)
    right.set_ylabel(QUANTITIES["whirl_frequency_ratio"].axis)
    right.set_ylim(0.0, 0.6)
    for ax in (left, right):
        ax.set_xlabel(QUANTITIES["speed"].axis)
    _legend_below(figure, left)
    return figure


def _look(model: str, clearance: float, clearances: Array, size: int) -> dict[str, object]:
    """Return the line of one curve: narrower clearances darker, so that they stay apart in grey."""
    known = np.unique(clearances)
    number = int(np.searchsorted(known, clearance))
    return {
        **model_style(model),
        "marker": MARKERS[number % len(MARKERS)],
        "markevery": max(1, size // 8),
        "alpha": 1.0 - 0.5 * number / max(known.size - 1, 1),
        "label": f"{model_label(model)}, {QUANTITIES['radial_clearance'].said(clearance)}",
    }


def _legend_below(figure: Figure, ax: Axes) -> None:
    handles, labels = ax.get_legend_handles_labels()
    if handles:
        figure.legend(handles, labels, loc="outside lower center", ncols=min(3, len(handles)))


def bearing_drawing(
    point: OperatingPoint, bearing: Bearing, title: str = "", ax: Axes | None = None
) -> Figure:
    """Return cross-section at mid-plane, load down.

    Journal where it is, oil in its temperature, pressure.

    Diameters are to scale among each other; the film is magnified by the factor that the picture
    names. Pressure is the shaded line outside the bore.

    bearing : In the load frame, as a `Case` has it.
    Raises InputError: The point was solved without its fields.
    """
    film, radius = _fields(point), bearing.journal_radius
    ax = axes_or_new(ax, (5.2, 4.6))
    middle = int(np.abs(film.y).argmin())
    attitude = point.attitude_angle
    eccentricity = point.running_clearance * point.eccentricity_ratio
    # From the bearing's centre, so that pockets and the ends of pads stay within the ring.
    depth = film.film_thickness[:, middle] + eccentricity * np.cos(film.theta - attitude)
    magnified = 0.26 * radius / float(depth.max())
    centre = magnified * eccentricity * np.array([np.cos(attitude), np.sin(attitude)])
    heat = _mean_temperature(film)
    colours = matplotlib.colormaps["inferno"]
    warm = None if heat is None else (float(heat.min()), float(heat.max()))
    top = max(float(film.pressure[:, middle].max()), 1e-30)

    def place(radial: Array, angle: Array) -> Array:
        """Return points of the picture, x (load) down and y to the right.

        From the journal's centre.
        """
        x, y = centre[0] + radial * np.cos(angle), centre[1] + radial * np.sin(angle)
        return np.column_stack([y, -x]) / radius

    for first, last in _lands(film.theta, bearing):
        angle, h = film.theta[first:last], magnified * film.film_thickness[first:last, middle]
        closed = last - first == film.theta.size
        if closed:
            angle, h = np.append(angle, angle[0] + 2 * np.pi), np.append(h, h[0])
        inner, outer = place(np.full(h.size, radius), angle), place(radius + h, angle)
        cells = np.stack([inner[:-1], inner[1:], outer[1:], outer[:-1]], axis=1)
        part = np.arange(first, first + len(cells)) % film.theta.size
        if heat is None:
            shades: Any = ["#9ec5de"] * len(cells)
        else:
            assert warm is not None
            level = (heat[part, middle] - warm[0]) / max(warm[1] - warm[0], 1e-9)
            shades = colours(0.15 + 0.8 * level)
        ax.add_collection(PolyCollection(list(cells), facecolors=shades, edgecolors="face", lw=0.3))
        ax.plot(*outer.T, color="k", lw=1.4)
        height = np.take(film.pressure[:, middle], np.arange(first, first + h.size), mode="wrap")
        # From the bearing's centre: a ring outside of every bore.
        way = np.column_stack([np.sin(angle), -np.cos(angle)])
        hill, foot = way * (1.32 + 0.4 * height / top)[:, None], 1.32 * way
        ax.add_patch(Polygon(np.vstack([foot, hill[::-1]]), fc="#0072B2", alpha=0.35, lw=0))
        ax.plot(*hill.T, color="#0072B2", lw=1.0)
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    ax.add_patch(Polygon(place(np.full(181, radius), turn), fc="#e4e4e4", ec="k", lw=1.2))
    _arrow(ax, place(np.array([0.0]), np.zeros(1))[0], (0.0, -0.55), "load")
    sweep = place(np.full(40, 0.72 * radius), np.linspace(2.6, 4.2, 40))
    ax.plot(*sweep.T, color="k", lw=1.0)
    head = {"arrowstyle": "-|>", "color": "k", "mutation_scale": 12}
    ax.annotate("", sweep[-1], sweep[-3], arrowprops=head)
    ax.plot([0.0], [0.0], "+", color="#777777", ms=9)
    ax.plot(*place(np.zeros(1), np.zeros(1)).T, "o", color="k", ms=3)
    label = f"film magnified {number(magnified, 2)} times; blue: pressure, at most "
    label += QUANTITIES["max_pressure"].with_unit(point.max_pressure, 3)
    if heat is not None and warm is not None:
        low, high = (number(value, 3) for value in warm)
        label += (
            f"\noil (mean across the film) {low} to {high} {shown_unit('°C')[0]}: dark to light"
        )
    ax.set_aspect("equal")
    ax.set(xlim=(-1.8, 1.8), ylim=(-1.85, 1.8), title=caption(title))
    ax.text(0.5, -0.01, label, transform=ax.transAxes, ha="center", va="top", fontsize=8)
    ax.set_axis_off()
    return figure_of(ax)


def _arrow(ax: Axes, start: Array, way: tuple[float, float], label: str) -> None:
    end = (start[0] + way[0], start[1] + way[1])
    ax.annotate("", end, tuple(start), arrowprops={"arrowstyle": "-|>", "lw": 1.5, "color": "k"})
    ax.text(end[0] + 0.05, end[1], label, fontsize=8, va="center")


def _lands(theta: Array, bearing: Bearing) -> list[tuple[int, int]]:
    """Return the first cell and the one past the last of each film: pads, lands between grooves."""
    if bearing.pads:
        # The mesh has cells between the pads too, as thick as the clearance there.
        edges = [(pad.leading_edge, pad.trailing_edge) for pad in bearing.pads]
        return [(int(first), int(last)) for first, last in np.searchsorted(theta, edges)]
    steps = np.diff(theta)
    gaps = [int(k) + 1 for k in np.flatnonzero(steps > 2.5 * np.median(steps))]
    return list(zip([0, *gaps], [*gaps, theta.size], strict=True))


def film_maps(points: Sequence[OperatingPoint], title: str = "") -> Figure:
    """Return contours over angle and axial position: one row per film, pressure and temperature.

    All films share one scale, so that colours may be compared.

    Raises InputError: A point was solved without its fields.
    """
    films = [_fields(point) for point in points]
    heat = [_mean_temperature(film) for film in films]
    known = [values for values in heat if values is not None]
    size = (9.0 if known else 5.0, 0.7 + 2.3 * len(films))
    figure, axes = new_axes(len(films), 2 if known else 1, size, title, sharex=True, sharey=True)
    top = max(float(_pressure(film).max()) for film in films)
    for row, point, film, warm in zip(axes, points, films, heat, strict=True):
        label = axis_title(f"{model_label(point.thermal_model)}: pressure", "MPa")
        _contours(figure, row[0], film, _pressure(film), (0.0, top), "viridis", label)
        _mark_turbulence(row[0], film)
        if not known:
            continue
        if warm is None:
            row[1].set_axis_off()
            row[1].text(0.5, 0.5, "uniform temperature", ha="center", transform=row[1].transAxes)
            continue
        span = (min(float(t.min()) for t in known), max(float(t.max()) for t in known))
        label = axis_title(f"{model_label(point.thermal_model)}: mean across the film", "°C")
        _contours(figure, row[1], film, warm, span, "inferno", label)
    for ax in axes[-1]:
        ax.set_xlabel("angle from the load line [deg]")
    for ax in axes[:, 0]:
        ax.set_ylabel(axis_title("axial position", "mm"))
    return figure


def film_profiles(
    points: Sequence[OperatingPoint], title: str = "", size: tuple[float, float] = (8.5, 3.2)
) -> Figure:
    """Return pressure and temperature around the bearing at mid-plane, all films in one picture.

    size : Width and height of the figure with both [inches]; pressure alone takes half the width.
    """
    films = [_fields(point) for point in points]
    heat = [_mean_temperature(film) for film in films]
    warm = any(values is not None for values in heat)
    width = size[0] if warm else 0.54 * size[0]
    figure, axes = new_axes(1, 2 if warm else 1, (width, size[1]), title)
    for point, film, temperature in zip(points, films, heat, strict=True):
        middle = int(np.abs(film.y).argmin())
        angle, order = _angles(film.theta)
        name = point.thermal_model
        look = {**model_style(name), "label": model_label(name)}
        axes[0, 0].plot(angle, _pressure(film)[order, middle], **look)
        if temperature is not None:
            axes[0, 1].plot(angle, temperature[order, middle], **look)
    axes[0, 0].set_ylabel(axis_title("mid-plane pressure", "MPa"))
    if warm:
        axes[0, 1].set_ylabel(axis_title("mid-plane, mean across the film", "°C"))
    for ax in axes[0]:
        ax.set_xlabel("angle from the load line [deg]")
        ax.xaxis.set_major_locator(MultipleLocator(90))
        ax.set_xlim(-180, 180)
        ax.legend()
    return figure


def _contours(
    figure: Figure,
    ax: Axes,
    film: FilmFields,
    values: Array,
    span: tuple[float, float],
    colours: str,
    label: str,
) -> None:
    angle, order = _angles(film.theta)
    low, high = span[0], span[1] if span[1] > span[0] else span[0] + 1.0
    shown = np.clip(values[order].T, low, high)
    along = in_shown_unit(film.y * 1e3, "mm")
    keep_field(ax, label, angle, along, values[order].T)
    filled = ax.contourf(angle, along, shown, np.linspace(low, high, 25), cmap=colours)
    # Lines carry the shape where the print has no colour.
    if np.ptp(shown) > 0.0:
        ax.contour(angle, along, shown, np.linspace(low, high, 7)[1:-1], colors="w", linewidths=0.6)
    ax.grid(visible=False)
    ax.xaxis.set_major_locator(MultipleLocator(90))
    ax.set_title(label)
    bar = figure.colorbar(filled, ax=ax, pad=0.02)
    bar.locator = MaxNLocator(6)
    bar.update_ticks()


def _mark_turbulence(ax: Axes, film: FilmFields) -> None:
    """Draw dots where the film is in transition, crosses where it is turbulent."""
    if not film.turbulence.max() > 0.0:
        return
    angle, order = _angles(film.theta)
    levels = [1e-9, 1.0 - 1e-9, 1.1]
    with rc_context({"hatch.color": "w", "hatch.linewidth": 0.4}):
        ax.contourf(
            angle,
            film.y * 1e3,
            film.turbulence[order].T,
            levels,
            colors="none",
            hatches=["..", "xx"],
        )
    ax.set_title(f"{ax.get_title()}; dots: transition, crosses: turbulent", fontsize=8)


def _angles(theta: Array) -> tuple[Array, NDArray[np.intp]]:
    turned = np.degrees(np.mod(theta + np.pi, 2.0 * np.pi) - np.pi)
    order = np.argsort(turned)
    return turned[order], order


def _pressure(film: FilmFields) -> Array:
    return np.asarray(in_shown_unit(film.pressure * MEGA, "MPa"))


def _mean_temperature(film: FilmFields) -> Array | None:
    """Return mean across the film, (n, m), in the unit shown.

    None where the film has one temperature.
    """
    mean = film.temperature.mean(axis=2) - ZERO_CELSIUS
    return np.asarray(in_shown_unit(mean, "°C")) if np.ptp(mean) > 1e-6 else None


def _fields(point: OperatingPoint) -> FilmFields:
    if point.fields is None:
        raise InputError("the operating point was solved without its fields", key="fields")
    return point.fields
