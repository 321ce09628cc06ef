"""Figures of design studies: what a stable bearing costs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from ...rows import QUANTITIES
from .style import new_axes

if TYPE_CHECKING:
    import pandas as pd

    from ...study.designs import Study


def study_plot(study: Study) -> Figure:
    """Draw threshold speed, or critical mass without one, against power loss and temperature.

    Designs that are stable at all speeds stand at the upper edge; those of the front, which no
    other beats in all three, have a rim.
    """
    title = f"{study.title}\n{len(study.converged)} designs, {study.thermal_model}"
    figure, axes = new_axes(1, 2, (9.8, 4.4), title)
    left, right = axes.flat
    with_speed = bool(study.converged["threshold_speed"].notna().any())

    def height(designs: pd.DataFrame) -> np.ndarray:
        if not with_speed:
            return QUANTITIES["critical_mass"].shown(designs["critical_mass"].to_numpy())
        found = designs["threshold_speed"].clip(upper=study.speeds[-1]).to_numpy()
        return QUANTITIES["speed"].shown(found)

    for ax, across, colour in (
        (left, "power_loss", "max_temperature"), (right, "max_temperature", "power_loss")
    ):  # fmt: skip
        along, shade = QUANTITIES[across], QUANTITIES[colour]
        points = ax.scatter(
            along.shown(study.converged[across].to_numpy()), height(study.converged),
            c=shade.shown(study.converged[colour].to_numpy()), s=14, cmap="viridis",
        )  # fmt: skip
        ax.scatter(
            along.shown(study.front[across].to_numpy()), height(study.front), s=36,
            facecolors="none", edgecolors="tab:red", label="not beaten in speed, loss, heat",
        )  # fmt: skip
        figure.colorbar(points, ax=ax, label=shade.axis)
        ax.set_xlabel(along.axis)
        if with_speed:
            top = QUANTITIES["speed"].shown(study.speeds[-1])
            ax.axhline(top, color="0.6", linewidth=0.8, linestyle="--")
    left.set_ylabel(
        f"threshold speed [{QUANTITIES['speed'].unit}], dashed: stable throughout"
        if with_speed
        else QUANTITIES["critical_mass"].axis
    )
    left.legend(loc="best", fontsize="small")
    return figure
