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
    failed: int = 0,
) -> Figure:
    """Histograms of threshold speed and critical mass, and the inputs' importance.

    Parameters
    ----------
    threshold_speed : (n,) array
        [rad/s], NaN where none lies within the speeds looked at.
    critical_mass : (n,) array
        At the operating speed [kg], NaN without a threshold.
    importance : mapping of str to float
        Rank correlations with the growth rate at the operating speed.
    operating_speed, mass : float
        Marked [rad/s], [kg]; without a mass, a flexible rotor's is not.
    nominal : (threshold speed, critical mass)
        Without deviations, marked where not None.
    failed : int
        Further samples, without any result: they are in none of the arrays, and said.
    """
    if failed:
        title += f"\n{threshold_speed.size} samples; {failed} more did not converge"
    figure, axes = new_axes(1, 3, (9.6, 3.4), title.strip())
    speed, mass_axes, bars = axes[0]
    at = None if nominal[0] is None else nominal[0] * RPM
    mark = (operating_speed * RPM, "operating speed")
    _histogram(speed, threshold_speed * RPM, "threshold speed [rpm]", at, mark)
    _histogram(
        mass_axes, critical_mass, "critical mass at operating speed [kg]", nominal[1],
        None if mass is None else (mass, "rotor mass"),
    )  # fmt: skip
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
    bars.set(xlim=(-1.05, 1.05), xlabel="rank correlation with growth rate [-]")
    bars.grid(visible=False, axis="y")
    return figure


def _histogram(
    ax: Axes, values: Array, label: str, nominal: float | None, mark: tuple[float, str] | None
) -> None:
    known = values[np.isfinite(values)]
    name = label.split(" at ")[0].split(" [")[0]
    if not known.size:
        # An axis without a value would show numbers that nobody computed.
        ax.set_axis_off()
        where = "\nwithin the speeds looked at" if "speed [" in label else ""
        ax.text(
            0.5, 0.5, f"no sample has a {name}{where}", transform=ax.transAxes, ha="center",
            va="center",
        )  # fmt: skip
        return
    edges = np.histogram_bin_edges(known, "auto")
    share = np.full(known.size, 100.0 / values.size)
    ax.hist(known, edges.tolist(), weights=share, color="#c9d8e4", edgecolor="k", linewidth=0.7)
    missing = values.size - known.size
    if missing:
        ax.set_title(f"{100.0 * missing / values.size:.3g} % of samples have none")
    if mark is not None:
        ax.axvline(mark[0], color="#8c1d2f", linewidth=1.8, label=mark[1])
    if nominal is not None:
        ax.axvline(nominal, color="k", linewidth=1.3, linestyle="--", label="nominal")
    ax.margins(y=0.3)
    ax.set(xlabel=label, ylabel="share of samples [%]")
    if mark is not None or nominal is not None:
        ax.legend(loc="upper right")
