"""Where the machine is stable: the map, the eigenvalues over speed, the Campbell diagram."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ...text import caption
from .regions import PlaneAxis, stability_plane
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
    sense : (n, k) array or None
        Sense of whirl: above 0 with the shaft, below 0 against it.
    thresholds : sequence of (speed, whirl frequency)
        Where the verdict changes [rad/s].
    """

    name: str
    speed: Array
    eigenvalues: NDArray[np.complex128]
    sense: Array | None = None
    thresholds: Sequence[tuple[float, float]] = ()


def stability_map(
    speed: Array,
    mass: Array,
    isothermal_growth: Array,
    heated_growth: Array | None = None,
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
    isothermal_growth, heated_growth : (n, m) arrays
        Growth rates, positive where unstable, NaN where unknown [1/s]. With one of them only, the
        map knows stable and unstable.
    operating_point : (speed, mass), optional
        Marked by a star [rad/s, kg].
    """
    return stability_plane(
        PlaneAxis("shaft speed [rpm]", speed * RPM),
        PlaneAxis("rotor mass per bearing [kg]", mass),
        isothermal_growth,
        heated_growth,
        None if operating_point is None else (operating_point[0] * RPM, operating_point[1]),
        title,
        ax,
        border="critical mass",
    )


def eigenvalue_plot(
    curves: Sequence[EigenvalueCurve], title: str = "", ax: Axes | None = None
) -> Figure:
    """Upper half of the complex plane: branches over speed, open at first, filled at last."""
    ax = axes_or_new(ax, (6.2, 4.6))
    every = [curve.eigenvalues[np.isfinite(curve.eigenvalues)] for curve in curves]
    highest = max(float(np.abs(values.imag).max(initial=1e-3)) for values in every)
    right = max(float(values.real.max(initial=0.0)) for values in every)
    ax.axvspan(0.0, max(1.4 * right, 0.12 * highest), color="#f2d7d9", zorder=0)
    ax.axvline(0.0, color="#8c1d2f", linewidth=1.0)
    ax.text(
        0.99, 0.97, "unstable", transform=ax.transAxes, ha="right", va="top", color="#8c1d2f",
        rotation=90,
    )  # fmt: skip
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
    for speed, face in ((low, "w"), (high, "k")):
        ax.plot([], [], MARKERS[0], color="k", mfc=face, ls="", label=f"at {speed:.0f} rpm")
    ax.set(
        xlabel="real part: growth rate [1/s]",
        ylabel="imaginary part: damped frequency [rad/s]",
        title=caption(title) or "eigenvalues over speed",
    )
    figure = figure_of(ax)
    if len(figure.axes) == 1:
        # Below: within the axes it would cover eigenvalues.
        figure.legend(loc="outside lower center", ncols=len(curves) + 2)
    else:
        ax.legend(loc="best")
    return figure


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
        for k in range(curve.eigenvalues.shape[1]):
            label = model_label(curve.name) if k == 0 else None
            speed, values = _with_crossings(curve.speed, curve.eigenvalues[:, k], curve.thresholds)
            hertz = np.where(values.imag > 0.0, values.imag, np.nan) / (2 * np.pi)
            ax.plot(speed * RPM, hertz, **look, label=label)
            unstable = np.where(values.real >= 0.0, hertz, np.nan)
            grows = grows or bool(np.isfinite(unstable).any())
            ax.plot(speed * RPM, unstable, color=look["color"], linewidth=4.5, alpha=0.45)
        hertz = np.where(curve.eigenvalues.imag > 0.0, curve.eigenvalues.imag, np.nan) / (2 * np.pi)
        _mark_whirl(ax, curve, curve.speed * RPM, hertz)
    ends = np.array([0.0, max(float(curve.speed[-1]) for curve in curves)])
    for order in orders:
        ax.plot(ends * RPM, order * ends / (2 * np.pi), color="0.35", linewidth=0.8)
        place = (ends[1] * RPM, order * ends[1] / (2 * np.pi))
        ax.annotate(f"{order:g}x", place, xytext=(3, -3), textcoords="offset points", fontsize=8)
    for marker, text, sign in _SENSES:
        if any(c.sense is not None and np.any(sign * c.sense > _CLEAR) for c in curves):
            ax.plot([], [], marker, color="k", mfc="w", ms=5, ls="", label=text)
    if any(curve.thresholds for curve in curves):
        ax.plot([], [], "x", color="k", ms=8, mew=2, ls="", label="threshold")
    if grows:
        ax.plot([], [], color="0.4", linewidth=4.5, alpha=0.45, label="grows (unstable)")
    ax.set(xlabel="shaft speed [rpm]", ylabel="damped frequency [Hz]", title=caption(title))
    ax.set_ylim(bottom=0.0)
    ax.legend(loc="upper left")
    return figure_of(ax)


def _with_crossings(
    speed: Array, branch: NDArray[np.complex128], thresholds: Sequence[tuple[float, float]]
) -> tuple[Array, NDArray[np.complex128]]:
    """A branch with points where it turns unstable or back: growth begins there, not at a knot.

    A threshold at about the branch's frequency is taken as it is; a branch that crosses elsewhere
    (another one is unstable already) is interpolated.
    """
    speeds: list[float] = []
    values: list[complex] = []
    for i, value in enumerate(branch):
        if i and branch[i - 1].real * value.real < 0.0:
            before = complex(branch[i - 1])
            t = before.real / (before.real - value.real)
            at = float(speed[i - 1] + t * (speed[i] - speed[i - 1]))
            whirl = before.imag + t * (complex(value).imag - before.imag)
            for place, frequency in thresholds:
                inside = speed[i - 1] <= place <= speed[i]
                if inside and abs(frequency - abs(whirl)) < 0.1 * abs(whirl):
                    at, whirl = place, frequency if whirl > 0.0 else -frequency
            speeds.append(at)
            values.append(complex(0.0, whirl))
        speeds.append(float(speed[i]))
        values.append(complex(value))
    return np.array(speeds), np.array(values)


_SENSES = (("^", "whirls forward", 1.0), ("v", "whirls backward", -1.0))
_CLEAR = 0.1
"""Ratio of areas, orbit to circle, above which an orbit has a sense."""


def _mark_whirl(ax: Axes, curve: EigenvalueCurve, rpm: Array, hertz: Array) -> None:
    """Triangles along the branches for the sense of whirl, crosses at the thresholds."""
    colour = model_style(curve.name)["color"]
    if curve.sense is not None:
        step = max(1, rpm.size // 8)
        shown = np.zeros(rpm.shape, dtype=bool)
        shown[step // 2 :: step] = True
        for marker, _, sign in _SENSES:
            for k in range(hertz.shape[1]):
                here = shown & (sign * curve.sense[:, k] > _CLEAR)
                ax.plot(rpm[here], hertz[here, k], marker, color=colour, mfc="w", ms=5)
    for speed, whirl in curve.thresholds:
        ax.plot(speed * RPM, whirl / (2 * np.pi), "x", color="k", ms=8, mew=2, zorder=6)


def root_locus(
    parameter: Array,
    eigenvalues: NDArray[np.complex128],
    quantity: str,
    title: str = "",
    ax: Axes | None = None,
) -> Figure:
    """Eigenvalues over a parameter: open at its first value, filled at its last, numbers between.

    Parameters
    ----------
    parameter : (n,) array
        In the unit that `quantity` names.
    eigenvalues : (n, k) complex array
        Each column one continuous branch [1/s].
    quantity : str
        The parameter with its unit, for example ``"mass per bearing [kg]"``.
    """
    ax = axes_or_new(ax, (6.2, 4.8))
    upper = eigenvalues.imag >= -1e-9 * np.abs(eigenvalues)
    values = np.asarray(np.where(upper, eigenvalues, np.nan), dtype=complex)
    known: NDArray[np.complex128] = values[np.isfinite(values)]
    highest = max(float(known.imag.max(initial=0.0)), 1e-3)
    low, high = _window(values, highest)
    ax.axvspan(0.0, high, color="#f2d7d9", zorder=0)
    ax.axvline(0.0, color="#8c1d2f", linewidth=1.0)
    ax.annotate(
        "unstable", (high, 0.0), xytext=(-4, 6), textcoords="offset points", ha="right",
        color="#8c1d2f", rotation=90,
    )  # fmt: skip
    for k, branch in enumerate(values.T):
        ax.plot(branch.real, branch.imag, color="#0072B2", zorder=2)
        for index, face in ((0, "w"), (-1, "#0072B2")):
            if np.isfinite(branch[index]):
                point = complex(branch[index])
                ax.plot(point.real, point.imag, "o", color="#0072B2", mfc=face, ms=5, zorder=3)
        _number_branch(ax, parameter, branch, (low, high), 0.06 * highest, k)
    first, last = f"{parameter[0]:.4g}", f"{parameter[-1]:.4g}"
    ax.set_xlim(low, high)
    ax.set_ylim(-0.02 * highest, 1.08 * highest)
    ax.set(
        xlabel="real part: growth rate [1/s]",
        ylabel="imaginary part: damped frequency [rad/s]",
        title=f"{caption(title)}\n{quantity} from {first} (open) to {last} (filled)".strip(),
    )
    return figure_of(ax)


def _window(values: NDArray[np.complex128], highest: float) -> tuple[float, float]:
    """Growth rates to show: those of the branch nearest to instability, well inside."""
    rates = np.where(np.isfinite(values), values.real, -np.inf)
    nearest = rates[:, int(np.argmax(rates.max(axis=0)))]
    nearest = nearest[np.isfinite(nearest)]
    left, right = min(float(nearest.min()), 0.0), max(float(nearest.max()), 0.0)
    width = max(right - left, 0.05 * highest)
    return left - 0.5 * width, right + 0.2 * width


def _number_branch(
    ax: Axes,
    parameter: Array,
    branch: NDArray[np.complex128],
    limits: tuple[float, float],
    spacing: float,
    k: int,
) -> None:
    """Write values of the parameter along a branch, and where it crosses into instability."""
    crossed = np.flatnonzero(np.sign(branch.real[:-1]) * np.sign(branch.real[1:]) < 0.0)
    for i in crossed:
        t = branch.real[i] / (branch.real[i] - branch.real[i + 1])
        value = parameter[i] + t * (parameter[i + 1] - parameter[i])
        height = branch.imag[i] + t * (branch.imag[i + 1] - branch.imag[i])
        ax.plot(0.0, height, "x", color="k", ms=8, mew=2, zorder=4)
        ax.annotate(
            f"{value:.4g}", (0.0, height), xytext=(7, 4), textcoords="offset points", fontsize=8,
            fontweight="bold",
        )  # fmt: skip
    last = None
    for i in range(1, parameter.size - 1):
        point = complex(branch[i])
        if not (np.isfinite(point) and limits[0] < point.real < limits[1]):
            continue
        near_crossing = crossed.size and abs(point.real) < spacing
        if near_crossing or (last is not None and abs(point - last) < 3.0 * spacing):
            continue
        if last is None and abs(point - branch[0]) < 2.0 * spacing:
            continue
        last = point
        ax.plot(point.real, point.imag, ".", color="#0072B2", ms=5)
        ax.annotate(
            f"{parameter[i]:.3g}", (point.real, point.imag), xytext=(4, 3 if k % 2 == 0 else -9),
            textcoords="offset points", fontsize=7, color="0.25",
        )  # fmt: skip
