"""Film pressure and temperature: maps of the rolled-out bearing, profiles at mid-plane."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator
from numpy.typing import NDArray

from ...model.lubricant import ZERO_CELSIUS
from .style import MEGA, model_label, model_style, new_axes

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FilmPicture:
    """What the film figures need of one solution.

    Attributes
    ----------
    name : str
        Thermal model.
    theta : (n,) array
        From the load line [rad].
    y : (m,) array
        Axial [m].
    pressure : (n, m) array
        [Pa]
    temperature : (n, m) array or None
        Mean across the film [K].
    """

    name: str
    theta: Array
    y: Array
    pressure: Array
    temperature: Array | None = None


def film_maps(films: Sequence[FilmPicture], title: str = "") -> Figure:
    """Contours over angle and axial position: one row per film, pressure and temperature.

    All films share one scale, so that colours may be compared.
    """
    warm = any(film.temperature is not None for film in films)
    size = (9.0 if warm else 5.0, 0.7 + 2.3 * len(films))
    figure, axes = new_axes(len(films), 2 if warm else 1, size, title, sharex=True, sharey=True)
    top = max(float(film.pressure.max()) for film in films) * MEGA
    heat = [f.temperature - ZERO_CELSIUS for f in films if f.temperature is not None]
    for row, film in zip(axes, films, strict=True):
        label = f"{model_label(film.name)}: pressure [MPa]"
        _contours(figure, row[0], film, film.pressure * MEGA, (0.0, top), "viridis", label)
        if not warm:
            continue
        if film.temperature is None:
            row[1].set_axis_off()
            row[1].text(0.5, 0.5, "uniform temperature", ha="center", transform=row[1].transAxes)
            continue
        span = (min(float(t.min()) for t in heat), max(float(t.max()) for t in heat))
        label = f"{model_label(film.name)}: mean temperature [°C]"
        _contours(figure, row[1], film, film.temperature - ZERO_CELSIUS, span, "inferno", label)
    for ax in axes[-1]:
        ax.set_xlabel("angle from the load line [deg]")
    for ax in axes[:, 0]:
        ax.set_ylabel("axial position [mm]")
    return figure


def film_profiles(films: Sequence[FilmPicture], title: str = "") -> Figure:
    """Pressure and temperature around the bearing at mid-plane, all films in one picture."""
    warm = any(film.temperature is not None for film in films)
    figure, axes = new_axes(1, 2 if warm else 1, (8.5 if warm else 4.6, 3.2), title)
    for film in films:
        middle = int(np.abs(film.y).argmin())
        angle, order = _angles(film.theta)
        look = {**model_style(film.name), "label": model_label(film.name)}
        axes[0, 0].plot(angle, film.pressure[order, middle] * MEGA, **look)
        if film.temperature is not None:
            axes[0, 1].plot(angle, film.temperature[order, middle] - ZERO_CELSIUS, **look)
    axes[0, 0].set_ylabel("mid-plane pressure [MPa]")
    if warm:
        axes[0, 1].set_ylabel("mid-plane mean temperature [°C]")
    for ax in axes[0]:
        ax.set_xlabel("angle from the load line [deg]")
        ax.xaxis.set_major_locator(MultipleLocator(90))
        ax.set_xlim(-180, 180)
        ax.legend()
    return figure


def _contours(
    figure: Figure,
    ax: Axes,
    film: FilmPicture,
    values: Array,
    span: tuple[float, float],
    colours: str,
    label: str,
) -> None:
    angle, order = _angles(film.theta)
    low, high = span[0], span[1] if span[1] > span[0] else span[0] + 1.0
    shown = np.clip(values[order].T, low, high)
    filled = ax.contourf(angle, film.y * 1e3, shown, np.linspace(low, high, 25), cmap=colours)
    # Lines carry the shape where the print has no colour.
    if np.ptp(shown) > 0.0:
        ax.contour(
            angle, film.y * 1e3, shown, np.linspace(low, high, 7)[1:-1], colors="w", linewidths=0.6
        )
    ax.grid(visible=False)
    ax.xaxis.set_major_locator(MultipleLocator(90))
    ax.set_title(label)
    bar = figure.colorbar(filled, ax=ax, pad=0.02)
    bar.locator = MaxNLocator(6)
    bar.update_ticks()


def _angles(theta: Array) -> tuple[Array, NDArray[np.intp]]:
    turned = np.degrees(np.mod(theta + np.pi, 2.0 * np.pi) - np.pi)
    order = np.argsort(turned)
    return turned[order], order
