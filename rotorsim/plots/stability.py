"""Where the machine is stable: the map, the eigenvalues over speed, the Campbell diagram."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from .style import MARKERS, RPM, axes_or_new, figure_of, model_label, model_style

Array = NDArray[np.float64]


@dataclass(frozen=True)
class EigenvalueCurve:
    """Eigenvalues over speed, each column one continuous branch.

    Attributes
    ----------
    name : str
    speed : (n,) array
        [rad/s]
    eigenvalues : (n, k) complex array
        [1/s]
    """

    name: str
    speed: Array
    eigenvalues: NDArray[np.complex128]


@dataclass(frozen=True)
class _Region:
    label: str
    face: str
    hatch: str
    edge: str


# From light to dark in this order also without colour; hatching marks what heating changes.
_REGIONS = (
    _Region("stable", "#e8f1f8", "", "none"),
    _Region("stable if heating is neglected, unstable with it", "#f5b54a", "////", "#5a3800"),
    _Region("unstable", "#8c4a5f", "", "none"),
    _Region("unstable if heating is neglected, stable with it", "#7fc4a4", "\\\\\\\\", "#1d4d38"),
)


def stability_map(
    speed: Array,
    mass: Array,
    isothermal_decay: Array,
    heated_decay: Array | None = None,
    operating_point: tuple[float, float] | None = None,
    title: str = "",
    ax: Axes | None = None,
) -> Figure:
    """Speed-mass plane: stable, unstable, and what only heating makes unstable.

    Parameters
    ----------
    speed : (n,) array
        [rad/s]
    mass : (m,) array
        Per bearing [kg].
    isothermal_decay, heated_decay : (n, m) arrays
        Decay rates, positive where stable, NaN where unknown [1/s]. With one of them only, the
        map knows stable and unstable.
    operating_point : (speed, mass), optional
        Marked by a star [rad/s, kg].
    """
    ax = axes_or_new(ax, (6.6, 4.9))
    hot = isothermal_decay if heated_decay is None else heated_decay
    known = np.isfinite(isothermal_decay) & np.isfinite(hot)
    rpm = speed * RPM
    ax.set_facecolor("#bbbbbb")
    # A region is where the least of its (signed) decay rates is positive: smooth borders.
    signed = (
        np.minimum(isothermal_decay, hot),
        np.minimum(isothermal_decay, -hot),
        np.minimum(-isothermal_decay, -hot),
        np.minimum(-isothermal_decay, hot),
    )
    shown = []
    for region, level in zip(_REGIONS, signed, strict=True):
        if not np.any(level[known] > 0.0):
            continue
        values = np.ma.masked_invalid(level).T
        top = max(float(values.max()), 1e-30)
        filled = ax.contourf(rpm, mass, values, [0.0, top], colors=[region.face])
        if region.hatch:
            filled.set_hatch(region.hatch)
            filled.set_edgecolor(region.edge)
            filled.set_linewidth(0.0)
        shown.append(Patch(fc=region.face, hatch=region.hatch, ec="#333333", label=region.label))
    shown += _borders(ax, rpm, mass, isothermal_decay, heated_decay)
    if not known.all():
        shown.append(Patch(fc="#bbbbbb", ec="#333333", label="not computed"))
    if operating_point is not None:
        point = (operating_point[0] * RPM, operating_point[1])
        ax.plot(*point, "*", color="k", mfc="w", ms=13, mew=1.2, zorder=5, clip_on=False)
        shown.append(
            Line2D([], [], ls="", marker="*", color="k", mfc="w", ms=11, label="operating point")
        )
    ax.set(xlabel="shaft speed [rpm]", ylabel="rotor mass per bearing [kg]", title=title)
    ax.grid(visible=False)
    figure = figure_of(ax)
    if len(figure.axes) == 1:
        figure.legend(handles=shown, loc="outside lower center", ncols=2)
    else:
        ax.legend(handles=shown, loc="upper right", fontsize=6.5)
    return figure


def _borders(
    ax: Axes, rpm: Array, mass: Array, isothermal: Array, heated: Array | None
) -> list[Line2D]:
    handles = []
    for name, decay in (("isothermal", isothermal), ("thd", heated)):
        if decay is None or not (np.nanmin(decay) < 0.0 < np.nanmax(decay)):
            continue
        dashes = model_style(name)["linestyle"]
        ax.contour(
            rpm,
            mass,
            np.ma.masked_invalid(decay).T,
            [0.0],
            colors="k",
            linestyles=[dashes],
            linewidths=1.3,
        )
        handles.append(
            Line2D([], [], color="k", ls=dashes, label=f"critical mass, {model_label(name)}")
        )
    return handles


def eigenvalue_plot(
    curves: Sequence[EigenvalueCurve], title: str = "", ax: Axes | None = None
) -> Figure:
    """Upper half of the complex plane: branches over speed, markers at the last speed."""
    ax = axes_or_new(ax, (6.2, 4.6))
    every = [curve.eigenvalues[np.isfinite(curve.eigenvalues)] for curve in curves]
    highest = max(float(np.abs(values.imag).max(initial=1e-3)) for values in every)
    right = max(float(values.real.max(initial=0.0)) for values in every)
    ax.axvspan(0.0, max(1.4 * right, 0.12 * highest), color="#f2d7d9", zorder=0)
    ax.axvline(0.0, color="#8c1d2f", linewidth=1.0)
    ax.text(0.99, 0.97, "unstable", transform=ax.transAxes, ha="right", va="top", color="#8c1d2f")
    for number, curve in enumerate(curves):
        look = model_style(curve.name)
        for k, branch in enumerate(curve.eigenvalues.T):
            shown = branch.imag >= 0.0
            real = np.where(shown, branch.real, np.nan)
            imaginary = np.where(shown, branch.imag, np.nan)
            label = model_label(curve.name) if k == 0 else None
            ax.plot(real, imaginary, **look, label=label)
            ax.plot(real[-1], imaginary[-1], MARKERS[number], color=look["color"])
            ax.plot(real[:1], imaginary[:1], MARKERS[number], color=look["color"], mfc="w")
    left = max(min(float(values.real.min(initial=0.0)) for values in every), -highest)
    ax.set_xlim(1.08 * min(left, -0.2 * highest), max(1.4 * right, 0.12 * highest))
    ax.set_ylim(0.0, 1.08 * highest)
    low, high = curves[0].speed[0] * RPM, curves[0].speed[-1] * RPM
    ax.set(
        xlabel="real part: growth rate [1/s]",
        ylabel="imaginary part: damped frequency [rad/s]",
        title=title or f"eigenvalues from {low:.0f} rpm (open) to {high:.0f} rpm (filled)",
    )
    ax.legend(loc="upper left")
    return figure_of(ax)


def campbell_diagram(
    curves: Sequence[EigenvalueCurve],
    orders: Sequence[float] = (1.0, 0.5),
    title: str = "",
    ax: Axes | None = None,
) -> Figure:
    """Damped frequency against speed with lines of synchronous and half-frequency whirl.

    Where a branch grows (positive real part) it is drawn thick.
    """
    ax = axes_or_new(ax, (6.2, 4.4))
    grows = False
    for curve in curves:
        look = model_style(curve.name)
        hertz = np.where(curve.eigenvalues.imag > 0.0, curve.eigenvalues.imag, np.nan) / (2 * np.pi)
        rpm = curve.speed * RPM
        for k in range(hertz.shape[1]):
            label = model_label(curve.name) if k == 0 else None
            ax.plot(rpm, hertz[:, k], **look, label=label)
            unstable = np.where(curve.eigenvalues[:, k].real > 0.0, hertz[:, k], np.nan)
            grows = grows or bool(np.isfinite(unstable).any())
            ax.plot(rpm, unstable, color=look["color"], linewidth=4.5, alpha=0.45)
    ends = np.array([0.0, max(float(curve.speed[-1]) for curve in curves)])
    for order in orders:
        ax.plot(ends * RPM, order * ends / (2 * np.pi), color="0.35", linewidth=0.8)
        place = (ends[1] * RPM, order * ends[1] / (2 * np.pi))
        ax.annotate(f"{order:g}x", place, xytext=(3, -3), textcoords="offset points", fontsize=8)
    if grows:
        ax.plot([], [], color="0.4", linewidth=4.5, alpha=0.45, label="grows (unstable)")
    ax.set(xlabel="shaft speed [rpm]", ylabel="damped frequency [Hz]", title=title)
    ax.set_ylim(bottom=0.0)
    ax.legend(loc="upper left")
    return figure_of(ax)
