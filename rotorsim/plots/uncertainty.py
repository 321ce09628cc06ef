"""What tolerances do to thresholds: distributions, and which input matters."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from .style import RPM, new_axes

Array = NDArray[np.float64]

_NAMES = {
    "radial_clearance": "clearance",
    "supply_temperature": "supply temperature",
}


def tolerance_histograms(
    threshold_speed: Array,
    critical_mass: Array,
    importance: Mapping[str, float],
    operating_speed: float,
    mass: float | None = None,
    nominal: tuple[float | None, float | None] = (None, None),
    title: str = "",
) -> Figure:
    """Histograms of threshold speed and critical mass, and the inputs' importance.

    Parameters
    ----------
    threshold_speed : (n,) array
        [rad/s], NaN where none lies within the speeds looked at.
    critical_mass : (n,) array
        At the operating speed [kg], NaN without a threshold.
    importance : mapping of str to float
        Rank correlations with the decay rate at the operating speed.
    operating_speed, mass : float
        Marked [rad/s], [kg]; without a mass, a flexible rotor's is not.
    nominal : (threshold speed, critical mass)
        Without deviations, marked where not None.
    """
    figure, axes = new_axes(1, 3, (9.6, 3.4), title)
    speed, mass_axes, bars = axes[0]
    _histogram(speed, threshold_speed * RPM, operating_speed * RPM, "operating speed",
               None if nominal[0] is None else nominal[0] * RPM)  # fmt: skip
    speed.set(xlabel="threshold speed [rpm]", ylabel="share of samples [%]")
    _histogram(mass_axes, critical_mass, mass, "rotor mass", nominal[1])
    mass_axes.set(xlabel="critical mass at operating speed [kg]")
    names = list(importance)[::-1]
    values = np.array([importance[name] for name in names])
    bars.barh(
        [_NAMES.get(name, name) for name in names],
        values,
        color="#c9d8e4",
        edgecolor="k",
        height=0.6,
    )
    bars.axvline(0.0, color="k", linewidth=0.8)
    bars.set(xlim=(-1.05, 1.05), xlabel="rank correlation with decay rate [-]")
    bars.grid(visible=False, axis="y")
    return figure


def _histogram(
    ax: Axes, values: Array, mark: float | None, name: str, nominal: float | None
) -> None:
    known = values[np.isfinite(values)]
    if known.size:
        edges = np.histogram_bin_edges(known, "auto")
        share = np.full(known.size, 100.0 / values.size)
        ax.hist(known, edges.tolist(), weights=share, color="#c9d8e4", edgecolor="k", linewidth=0.7)
    missing = values.size - known.size
    if missing:
        ax.set_title(f"{100.0 * missing / values.size:.3g} % of samples have none")
    if mark is not None:
        ax.axvline(mark, color="#8c1d2f", linewidth=1.8, label=name)
    if nominal is not None:
        ax.axvline(nominal, color="k", linewidth=1.3, linestyle="--", label="nominal")
    ax.margins(y=0.3)
    if mark is not None or nominal is not None:
        ax.legend(loc="upper right")
