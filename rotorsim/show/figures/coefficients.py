"""Stiffness, damping and the rigid rotor's threshold against speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from .style import MARKERS, MICRO, RPM, model_label, model_style, new_axes

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SpeedCurve:
    """Results over speed for one thermal model and clearance.

    Attributes
    ----------
    name : str
        Thermal model.
    radial_clearance : float
        [m]
    speed : (n,) array
        [rad/s]
    stiffness, damping : (n, 2, 2) arrays, optional
        [N/m], [N s/m]
    critical_mass : (n,) array, optional
        NaN where there is no threshold [kg].
    whirl_frequency_ratio : (n,) array, optional
        NaN where there is no threshold [-].
    """

    name: str
    radial_clearance: float
    speed: Array
    stiffness: Array | None = None
    damping: Array | None = None
    critical_mass: Array | None = None
    whirl_frequency_ratio: Array | None = None


def coefficients_over_speed(curves: Sequence[SpeedCurve], title: str = "") -> Figure:
    """The eight coefficients against speed: line style by model, marker by clearance."""
    figure, axes = new_axes(2, 4, (11.5, 5.2), title, sharex=True)
    for row, (symbol, unit) in enumerate((("K", "MN/m"), ("C", "kN s/m"))):
        for column, (i, j) in enumerate(((0, 0), (0, 1), (1, 0), (1, 1))):
            ax = axes[row, column]
            ax.set_title(rf"${symbol}_{{{'xy'[i]}{'xy'[j]}}}$ [{unit}]")
            ax.axhline(0.0, color="0.6", linewidth=0.6)
            for curve in curves:
                values = curve.stiffness if symbol == "K" else curve.damping
                if values is not None:
                    scale = 1e-6 if symbol == "K" else 1e-3
                    ax.plot(curve.speed * RPM, values[:, i, j] * scale, **_look(curve, curves))
    for ax in axes[1]:
        ax.set_xlabel("shaft speed [rpm]")
    _legend_below(figure, axes[0, 0])
    return figure


def thresholds_over_speed(
    curves: Sequence[SpeedCurve], rotor_mass: float | None = None, title: str = ""
) -> Figure:
    """Critical mass (logarithmic) and whirl frequency ratio against speed."""
    figure, axes = new_axes(1, 2, (9.0, 3.8), title)
    left, right = axes[0]
    for curve in curves:
        look = _look(curve, curves)
        if curve.critical_mass is not None:
            left.semilogy(curve.speed * RPM, curve.critical_mass, **look)
        if curve.whirl_frequency_ratio is not None:
            right.plot(curve.speed * RPM, curve.whirl_frequency_ratio, **look)
    if rotor_mass is not None:
        left.axhline(rotor_mass, color="k", linewidth=1.0)
        left.annotate(
            f"rotor {rotor_mass:.4g} kg",
            (0.98, rotor_mass),
            xycoords=("axes fraction", "data"),
            ha="right",
            va="bottom",
            fontsize=8,
        )
    left.set_ylabel("critical mass per bearing [kg]")
    right.set_ylabel("whirl frequency ratio [-]")
    right.set_ylim(0.0, 0.6)
    for ax in (left, right):
        ax.set_xlabel("shaft speed [rpm]")
    _legend_below(figure, left)
    return figure


def _look(curve: SpeedCurve, curves: Sequence[SpeedCurve]) -> dict[str, object]:
    clearances = sorted({c.radial_clearance for c in curves})
    number = clearances.index(curve.radial_clearance)
    label = f"{model_label(curve.name)}, c = {curve.radial_clearance * MICRO:.4g} µm"
    every = max(1, curve.speed.size // 8)
    # Narrower clearances darker: three clearances stay three lines in grey.
    opacity = 1.0 - 0.5 * number / max(len(clearances) - 1, 1)
    return {
        **model_style(curve.name),
        "marker": MARKERS[number % len(MARKERS)],
        "markevery": every,
        "alpha": opacity,
        "label": label,
    }


def _legend_below(figure: Figure, ax: Axes) -> None:
    handles, labels = ax.get_legend_handles_labels()
    if handles:
        figure.legend(handles, labels, loc="outside lower center", ncols=min(3, len(handles)))
