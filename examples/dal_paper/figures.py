"""The paper's figures, drawn from our results."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rotorsim.show.figures.style import SETTINGS

from .study import (
    AMBIENT,
    CLEARANCES,
    FILM_SPEEDS,
    ISOTHERMAL,
    THD,
    WALL_NAMES,
    WALL_SPEEDS,
    WHOLE,
    Results,
)

CAPTIONS = {
    "fig2": "Fig. 2: peak pressure and temperature against eccentricity ratio, c = 145 µm. The "
    "paper states no speed; two are drawn, with both kinds of wall.",
    "fig3": "Fig. 3: mid-plane pressure and temperature (hottest layer) from maximum film "
    "thickness in the direction of rotation, c = 100 µm; viscosity.",
    "fig4": "Fig. 4: peak pressure and temperature.",
    "fig5": "Fig. 5: film force, friction (whole: over the whole ruptured sector; otherwise over "
    "its oil) and power loss.",
    "fig6": "Fig. 6: stiffness in the load frame.",
    "fig7": "Fig. 7: damping in the load frame.",
    "fig8": "Fig. 8: critical mass, dimensionless and in kilograms, and whirl frequency ratio.",
    "walls": "Both readings of the walls, c = 100 µm.",
}
NAMES = {ISOTHERMAL: "isothermal", THD: "THD"}
SPEED = "shaft speed [rpm]"
ANGLE = "angle from maximum film thickness [deg]"
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#7F5F00")
DASHES: tuple[Any, ...] = ("-", (0, (5, 2)), ":")
MARKERS = ("o", "s", "^", "D", "v")
STYLE: Any = {k: v for k, v in SETTINGS.items() if not k.startswith(("legend.", "svg."))}


def draw(r: Results) -> dict[str, bytes]:
    """Return figures 2 to 8 and one of the walls as PNG, by the names of `CAPTIONS`."""
    with mpl.rc_context(STYLE):
        return {
            "fig2": _figure_2(r),
            "fig3": _figure_3(r),
            "fig4": _figure_4(r),
            "fig5": _figure_5(r),
            "fig6": _coefficients(r, "k", 1e-9, "GN/m"),
            "fig7": _coefficients(r, "c", 1e-6, "MN s/m"),
            "fig8": _figure_8(r),
            "walls": _walls(r),
        }


def _panels(count: int, columns: int) -> tuple[Figure, list[Axes]]:
    rows = math.ceil(count / columns)
    size = (min(10.4, 3.6 * columns), 3.1 * rows + 0.7)
    figure = Figure(figsize=size, layout="constrained")
    return figure, list(figure.subplots(rows, columns, squeeze=False).flat)


def _plot(ax: Axes, x: Any, y: Any, label: str, colour: int = 0, dashes: int = 0,
          marker: int | None = None, alpha: float = 1.0) -> None:  # fmt: skip
    ax.plot(
        x, y, label=label, color=COLOURS[colour], linestyle=DASHES[dashes], alpha=alpha,
        marker=None if marker is None else MARKERS[marker], markevery=max(1, len(x) // 9),
    )  # fmt: skip


def _finish(ax: Axes, title: str, x: str, y: str, tick: float | None = None) -> None:
    ax.set(title=title, xlabel=x, ylabel=y)
    if tick is not None:
        limits = ax.get_xlim()
        ax.set_xticks(np.arange(math.ceil(limits[0] / tick), limits[1] / tick) * tick)
        ax.set_xlim(limits)


def _printed(ax: Axes, *points: tuple[float, float]) -> None:
    """Mark numbers of the paper's text."""
    x, y = np.transpose(points)
    ax.plot(x, y, "x", color="k", markersize=8, markeredgewidth=2, label="printed in the paper")


def _png(figure: Figure, axes: Sequence[Axes]) -> bytes:
    """Return the figure with one legend below all of `axes`."""
    entries: dict[str, Any] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    columns = min(3, len(entries), int(figure.get_figwidth() * 10.0 / max(map(len, entries))))
    figure.legend(
        list(entries.values()), list(entries), loc="outside lower center",
        ncols=max(1, columns), fontsize=8, handlelength=3.2,
    )  # fmt: skip
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=90)
    return stream.getvalue()


def _over_speed(ax: Axes, r: Results, name: str, title: str, y: str, scale: float = 1.0,
                models: Sequence[str] = (ISOTHERMAL, THD)) -> None:  # fmt: skip
    """Draw one line for each model and clearance."""
    for model in models:
        thd = model == THD
        for place, clearance in enumerate(CLEARANCES):
            curve = r.curves[name].sel(setting=AMBIENT, thermal_model=model, clearance=clearance)
            label = f"{NAMES[model]}, c = {clearance} µm"
            _plot(ax, curve.rpm, scale * curve, label, int(thd), int(not thd), place,
                  1.0 - 0.25 * place)  # fmt: skip
    _finish(ax, title, SPEED, y, 5000.0)


def _figure_2(r: Results) -> bytes:
    figure, axes = _panels(2, 2)
    for walls in (AMBIENT, "conduction"):
        for rpm in r.validation.rpm.values:
            data = r.validation.sel(walls=walls, rpm=rpm)
            slow = int(rpm < 3000)
            style = (f"{rpm} rpm, {WALL_NAMES[walls]}", int(walls != AMBIENT), slow, slow)
            _plot(axes[0], data.eccentricity, 1e-6 * data["max_pressure"], *style)
            _plot(axes[1], data.eccentricity, data["temperature"], *style)
    _finish(axes[0], "a) peak pressure", "eccentricity ratio [-]", "peak pressure [MPa]")
    _finish(axes[1], "b) peak temperature", "eccentricity ratio [-]", "peak temperature [°C]")
    axes[0].set_yscale("log")
    return _png(figure, axes)


def _figure_3(r: Results) -> bytes:
    figure, axes = _panels(3, 3)
    for number, rpm in enumerate(FILM_SPEEDS):
        for model in (ISOTHERMAL, THD):
            angle, pressure, _, hottest = r.profile(model, rpm)
            style = (f"{NAMES[model]}, {rpm} rpm", number, int(model == ISOTHERMAL))
            _plot(axes[0], angle, 1e-6 * pressure, *style)
            if model == THD:
                _plot(axes[1], angle, hottest, *style)
    # The text gives two temperatures without their angle: marked where it says that it is hot.
    _printed(axes[1], (270.0, 45.0), (270.0, 90.0))
    _finish(axes[0], "a) pressure", ANGLE, "mid-plane pressure [MPa]", 90.0)
    _finish(axes[1], "b) temperature", ANGLE, "hottest layer [°C]", 90.0)
    celsius = np.linspace(40.0, 100.0, 61)
    used, printed = (np.exp(-0.034 * x) for x in (celsius - 40.0, celsius / 40.0 - 1.0))
    _plot(axes[2], celsius, 27.7 * used, "0.034 per kelvin (used)")
    _plot(axes[2], celsius, 27.7 * printed, "Eq. 15 as printed, degC", dashes=2)
    _finish(axes[2], "c) viscosity", "temperature [°C]", "viscosity [mPa s]")
    axes[2].set_ylim(bottom=0.0)
    axes[2].legend(fontsize=7)
    return _png(figure, axes[:2])


def _figure_4(r: Results) -> bytes:
    figure, axes = _panels(2, 2)
    _over_speed(axes[0], r, "max_pressure", "a) peak pressure", "peak pressure [MPa]", 1e-6)
    axes[0].set_ylim(bottom=0.0)
    _printed(axes[1], (15000.0, 72.0))
    _over_speed(axes[1], r, "temperature", "b) peak temperature", "peak temperature [°C]",
                models=(THD,))  # fmt: skip
    return _png(figure, axes)


def _figure_5(r: Results) -> bytes:
    figure, axes = _panels(3, 3)
    _over_speed(axes[0], r, "load", "a) film force", "film force [kN]", 1e-3)
    _printed(axes[0], (15000.0, 30.0), (15000.0, 20.0))
    for model in (ISOTHERMAL, THD):
        curve = r.curves["friction_force"].sel(setting=WHOLE, thermal_model=model, clearance=100)
        label = f"{NAMES[model]}, c = 100 µm, whole sector"
        _plot(axes[1], curve.rpm, curve, label, int(model == THD), 2)
    _over_speed(axes[1], r, "friction_force", "b) friction", "friction [N]")
    _printed(axes[1], (15000.0, 640.0), (15000.0, 640.0 * 0.55))
    _over_speed(axes[2], r, "power_loss", "c) power loss", "power loss [kW]", 1e-3)
    for ax in axes:
        ax.set_ylim(bottom=0.0)
    return _png(figure, axes)


def _coefficients(r: Results, letter: str, scale: float, unit: str) -> bytes:
    figure, axes = _panels(4, 2)
    for ax, order, pair in zip(axes, "abcd", ("xx", "xy", "yx", "yy"), strict=True):
        symbol = f"{letter}$_{{{pair}}}$"
        _over_speed(ax, r, letter + pair, f"{order}) {symbol}", f"{symbol} [{unit}]", scale)
    return _png(figure, axes)


def _figure_8(r: Results) -> bytes:
    figure, axes = _panels(3, 3)
    _over_speed(axes[0], r, "critical_mass_dimensionless", "a) critical mass", "M c ω²/W [-]")
    _over_speed(axes[1], r, "critical_mass", "a') the same in kg", "critical mass [kg]")
    _over_speed(axes[2], r, "whirl_frequency_ratio", "b) whirl", "whirl frequency ratio [-]")
    axes[1].set_yscale("log")
    return _png(figure, axes)


def _walls(r: Results) -> bytes:
    figure, axes = _panels(3, 3)
    for ax, name, title, y, scale in zip(
        axes,
        ("temperature", "load", "critical_mass"),
        ("peak temperature", "film force", "critical mass"),
        ("peak temperature [°C]", "film force [kN]", "critical mass [kg]"),
        (1.0, 1e-3, 1.0),
        strict=True,
    ):
        curves = r.curves[name].sel(clearance=100)
        cold = curves.sel(setting=AMBIENT, thermal_model=ISOTHERMAL)
        _plot(ax, cold.rpm, scale * cold, "isothermal", 0, 1, 0)
        for number, (walls, label) in enumerate(WALL_NAMES.items(), start=1):
            curve = curves.sel(setting=walls, thermal_model=THD)
            if walls != AMBIENT:
                curve = curve.sel(rpm=list(WALL_SPEEDS))
            _plot(ax, curve.rpm, scale * curve, label, number, 0, number)
        _finish(ax, title, SPEED, y, 5000.0)
    axes[2].set_yscale("log")
    return _png(figure, axes)
