"""A plane of two inputs, coloured by what is stable in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from ...errors import InputError
from ...text import caption
from .style import axes_or_new, figure_of, model_label, model_style

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PlaneAxis:
    """One axis of a plane: its label with the unit, and values in that unit."""

    label: str
    values: Array


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


def stability_plane(
    x: PlaneAxis,
    y: PlaneAxis,
    isothermal_growth: Array,
    heated_growth: Array | None = None,
    operating_point: tuple[float, float] | None = None,
    title: str = "",
    ax: Axes | None = None,
    border: str = "threshold",
) -> Figure:
    """Plane of any two inputs: stable, unstable, and what only heating makes unstable.

    Parameters
    ----------
    x, y : PlaneAxis
        With n and m values.
    isothermal_growth, heated_growth : (n, m) arrays
        Growth rates, positive where unstable, NaN where unknown [1/s]. With one of them only, the
        map knows stable and unstable.
    operating_point : (x, y), optional
        Marked by a star, in the axes' units.
    border : str
        Name of the line between stable and unstable.

    Raises
    ------
    InputError
        An axis has one value.
    """
    for axis in (x, y):
        if axis.values.size < 2:
            raise InputError("a map needs two values or more along each axis", key=axis.label)
    ax = axes_or_new(ax, (6.6, 4.9))
    # The least of two rates bends within a coarse cell: only on a fine grid do the regions meet.
    along, across = _finer(x.values), _finer(y.values)
    isothermal_growth = _bilinear(x.values, y.values, isothermal_growth, along, across)
    if heated_growth is not None:
        heated_growth = _bilinear(x.values, y.values, heated_growth, along, across)
    hot = isothermal_growth if heated_growth is None else heated_growth
    known = np.isfinite(isothermal_growth) & np.isfinite(hot)
    ax.set_facecolor("#bbbbbb")
    # A region is where the least of its (signed) growth rates is positive: smooth borders.
    signed = (
        np.minimum(-isothermal_growth, -hot),
        np.minimum(-isothermal_growth, hot),
        np.minimum(isothermal_growth, hot),
        np.minimum(isothermal_growth, -hot),
    )
    shown = []
    for region, level in zip(_REGIONS, signed, strict=True):
        if not np.any(level[known] > 0.0):
            continue
        values = np.ma.masked_invalid(level).T
        top = max(float(values.max()), 1e-30)
        filled = ax.contourf(along, across, values, [0.0, top], colors=[region.face])
        if region.hatch:
            filled.set_hatch(region.hatch)
            filled.set_edgecolor(region.edge)
            filled.set_linewidth(0.0)
        shown.append(Patch(fc=region.face, hatch=region.hatch, ec="#333333", label=region.label))
    shown += _borders(ax, along, across, isothermal_growth, heated_growth, border)
    if not known.all():
        shown.append(Patch(fc="#bbbbbb", ec="#333333", label="not computed"))
    if operating_point is not None:
        ax.plot(*operating_point, "*", color="k", mfc="w", ms=13, mew=1.2, zorder=5, clip_on=False)
        shown.append(
            Line2D([], [], ls="", marker="*", color="k", mfc="w", ms=11, label="operating point")
        )
    ax.set(xlabel=x.label, ylabel=y.label, title=caption(title))
    ax.grid(visible=False)
    figure = figure_of(ax)
    if len(figure.axes) == 1:
        # Two of the long labels side by side must fit the width.
        long = sum(len(str(handle.get_label())) > 30 for handle in shown) > 1
        size = 7.0 if long else None
        figure.legend(handles=shown, loc="outside lower center", ncols=2, fontsize=size)
    else:
        ax.legend(handles=shown, loc="upper right", fontsize=6.5)
    return figure


_FINE = 240
"""Intervals along an axis, about, on which the regions are drawn."""


def _finer(values: Array) -> Array:
    """Values with equal steps between every two, so that there are about `_FINE`."""
    steps = -(-_FINE // (values.size - 1))
    place = np.arange(steps * (values.size - 1) + 1) / steps
    return np.interp(place, np.arange(values.size), values)


def _bilinear(x: Array, y: Array, values: Array, along: Array, across: Array) -> Array:
    """`values` (n, m) between; NaN only within cells of which a corner is NaN."""
    for axis, (nodes, wanted) in enumerate(((x, along), (y, across))):
        low = np.clip(np.searchsorted(nodes, wanted, "right") - 1, 0, max(nodes.size - 2, 0))
        high = np.minimum(low + 1, nodes.size - 1)
        span = np.where(high > low, nodes[high] - nodes[low], 1.0)
        part = np.expand_dims((wanted - nodes[low]) / span, 1 - axis)
        first, second = values.take(low, axis), values.take(high, axis)
        # A node that is known stays so beside one that is not.
        mixed = np.where(part < 1.0, (1.0 - part) * first, 0.0)
        values = mixed + np.where(part > 0.0, part * second, 0.0)
    return values


def _borders(
    ax: Axes, x: Array, y: Array, isothermal: Array, heated: Array | None, name: str
) -> list[Line2D]:
    handles = []
    for model, growth in (("isothermal", isothermal), ("thd", heated)):
        if growth is None or not (np.nanmin(growth) < 0.0 < np.nanmax(growth)):
            continue
        dashes = model_style(model)["linestyle"]
        values = np.ma.masked_invalid(growth).T
        ax.contour(x, y, values, [0.0], colors="k", linestyles=[dashes], linewidths=1.3)
        handles.append(Line2D([], [], color="k", ls=dashes, label=f"{name}, {model_label(model)}"))
    return handles
