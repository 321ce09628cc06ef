"""Panels of curves with a paper's printed numbers marked in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from .style import MARKERS, new_axes

Array = NDArray[np.float64]
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#7F5F00")
DASHES = ("-", (0, (5, 2)), ":", "-.")
MARKS = 9
"""Markers along a curve."""


@dataclass(frozen=True)
class Line:
    """One curve.

    Attributes
    ----------
    x, y : (n,) arrays
    label : str
        Empty: not in the legend.
    colour, dashes, marker : int
        Places in the palette, the dashes and the markers; marker -1: none.
    strength : float
        1 full, 0 invisible.
    """

    x: Array
    y: Array
    label: str
    colour: int = 0
    dashes: int = 0
    marker: int = -1
    strength: float = 1.0


@dataclass(frozen=True)
class Panel:
    """One pair of axes.

    Attributes
    ----------
    title, xlabel, ylabel : str
    lines : sequence of Line
    printed : sequence of (x, y)
        Numbers that the paper prints, drawn as crosses.
    from_zero : bool
        Let the vertical axis begin at zero.
    tick : float or None
        Distance of the ticks along x.
    logarithmic : bool
        Vertical axis.
    own_legend : bool
        Inside the axes; otherwise the lines are in the legend below all panels.
    """

    title: str
    xlabel: str
    ylabel: str
    lines: Sequence[Line]
    printed: Sequence[tuple[float, float]] = ()
    from_zero: bool = False
    tick: float | None = None
    logarithmic: bool = False
    own_legend: bool = False


def panels(content: Sequence[Panel], columns: int, title: str = "") -> Figure:
    """Figure of panels, row by row, one legend below for all of them."""
    rows = -(-len(content) // columns)
    width = min(10.4, 3.6 * columns)
    figure, axes = new_axes(rows, columns, (width, 3.1 * rows + 0.7), title)
    entries: dict[str, object] = {}
    for ax, panel in zip(axes.flat, content, strict=False):
        _draw(ax, panel)
        handles, labels = ax.get_legend_handles_labels()
        if panel.own_legend:
            ax.legend(fontsize=7)
            continue
        for label, handle in zip(labels, handles, strict=True):
            entries.setdefault(label, handle)
    for ax in list(axes.flat)[len(content) :]:
        ax.set_axis_off()
    if entries:
        names = list(entries)
        figure.legend(
            [entries[name] for name in names],  # pyright: ignore[reportArgumentType]
            names,
            loc="outside lower center",
            ncols=max(1, min(3, len(names), int(width * 10.0 / max(map(len, names))))),
            fontsize=8,
            handlelength=3.2,
        )
    return figure


def _draw(ax, panel: Panel) -> None:
    for line in panel.lines:
        ax.plot(
            line.x,
            line.y,
            color=PALETTE[line.colour % len(PALETTE)],
            linestyle=DASHES[line.dashes % len(DASHES)],
            marker=None if line.marker < 0 else MARKERS[line.marker % len(MARKERS)],
            markevery=max(1, line.x.size // MARKS),
            alpha=line.strength,
            label=line.label or None,
        )
    if panel.printed:
        x, y = np.transpose(panel.printed)
        ax.plot(x, y, "x", color="k", markersize=8, markeredgewidth=2, label="printed in the paper")
    ax.set(title=panel.title, xlabel=panel.xlabel, ylabel=panel.ylabel)
    if panel.logarithmic:
        ax.set_yscale("log")
    elif panel.from_zero:
        ax.set_ylim(bottom=0.0)
    if panel.tick is not None:
        low, high = ax.get_xlim()
        ax.set_xticks(np.arange(np.ceil(low / panel.tick), high / panel.tick) * panel.tick)
        ax.set_xlim(low, high)
