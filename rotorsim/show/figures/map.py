"""The stability map: over two inputs, what is stable and what only heating makes unstable."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from ...errors import InputError
from ...rows import quantity
from ...text import caption
from .style import axes_or_new, figure_of, keep_field, model_label, model_style

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]


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
_UNDAMPED = "#f4efdc"
_MARKS = ("*", "D", "s", "^")


def stability_map(
    chart: xr.Dataset,
    x: str = "speed",
    y: str = "mass",
    marks: Mapping[str, tuple[float, float]] | None = None,
    title: str = "",
    ax: Axes | None = None,
) -> Figure:
    """Return the plane of two inputs: stable, unstable, and what only heating makes unstable.

    Parameters
    ----------
    chart : xarray.Dataset
        ``growth_rate`` over ``thermal_model``, x and y, as `StabilityMap.plane` and
        `Plane.dataset` give it. With isothermal and THD there are regions
        that only heating changes; with one model, stable and unstable.
    x, y : str
        Dimensions, see `rotorsim.rows.quantity`; a machine's parameter stands in the attribute
        ``parameter`` of its coordinate.
    marks : mapping of str to (x, y), optional
        Points to mark (SI), by what the legend calls them: ``{"highest speed": (840.0, 300.0)}``.

    Raises
    ------
    InputError
        An axis has one value.
    """
    for name in (x, y):
        if chart.sizes[name] < 2:
            raise InputError("a map needs two values or more along each axis", key=name)
    models = [str(model) for model in chart["thermal_model"].values]
    cold = "isothermal" if "isothermal" in models else models[0]
    hot = "thd" if "thd" in models else models[-1]
    border = "critical mass" if "mass" in (x, y) else "threshold"
    ax = axes_or_new(ax, (6.6, 4.9))
    # The least of two rates bends within a coarse cell: only on a fine grid do the regions meet.
    along, across = (_finer(chart[name].values.astype(float)) for name in (x, y))
    rates = {
        model: _bilinear(chart, x, y, model, along, across) for model in dict.fromkeys((cold, hot))
    }
    first, second = rates[cold], rates[hot]
    known = np.isfinite(first) & np.isfinite(second)
    shown_as = [
        quantity(str(chart[name].attrs.get("parameter", name)), chart[name].attrs.get("units", ""))
        for name in (x, y)
    ]
    along, across = shown_as[0].shown(along), shown_as[1].shown(across)
    for model, rate in rates.items():
        keep_field(ax, f"growth rate, {model_label(model)} [1/s]", along, across, rate.T)
    ax.set_facecolor("#bbbbbb")
    # A region is where the least of its (signed) growth rates is positive: smooth borders.
    signed = (
        np.minimum(-first, -second),
        np.minimum(-first, second),
        np.minimum(first, second),
        np.minimum(first, -second),
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
    neither = (first == 0.0) & (second == 0.0)
    if neither.any():
        ax.contourf(along, across, neither.T.astype(float), [0.5, 1.5], colors=[_UNDAMPED])
        shown.append(Patch(fc=_UNDAMPED, ec="#333333", label="undamped"))
    shown += _borders(ax, along, across, rates, border)
    if not known.all():
        shown.append(Patch(fc="#bbbbbb", ec="#333333", label="not computed"))
    for sign, (label, point) in zip(_MARKS, (marks or {}).items(), strict=False):
        place = [q.shown(v) for q, v in zip(shown_as, point, strict=True)]
        look: dict[str, Any] = {"marker": sign, "color": "k", "mfc": "w", "ls": ""}
        ax.plot(*place, ms=13 if sign == "*" else 8, mew=1.2, zorder=5, clip_on=False, **look)
        shown.append(Line2D([], [], ms=9, label=label, **look))
    ax.set(xlabel=shown_as[0].axis, ylabel=shown_as[1].axis, title=caption(title))
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
    """Return values with equal steps between every two, so that there are about `_FINE`."""
    steps = -(-_FINE // (values.size - 1))
    place = np.arange(steps * (values.size - 1) + 1) / steps
    return np.interp(place, np.arange(values.size), values)


def _bilinear(chart: xr.Dataset, x: str, y: str, model: str, along: Array, across: Array) -> Array:
    """Return growth rates of one model between; NaN only within cells of which a corner is NaN."""
    values = chart["growth_rate"].sel(thermal_model=model).transpose(x, y).values
    for axis, (name, wanted) in enumerate(((x, along), (y, across))):
        nodes = chart[name].values
        low = np.clip(np.searchsorted(nodes, wanted, "right") - 1, 0, max(nodes.size - 2, 0))
        high = np.minimum(low + 1, nodes.size - 1)
        span = np.where(high > low, nodes[high] - nodes[low], 1.0)
        part = np.expand_dims((wanted - nodes[low]) / span, 1 - axis)
        first, second = values.take(low, axis), values.take(high, axis)
        # A node that is known stays so beside one that is not.
        mixed = np.where(part < 1.0, (1.0 - part) * first, 0.0)
        values = mixed + np.where(part > 0.0, part * second, 0.0)
    return values


def _borders(ax: Axes, x: Array, y: Array, rates: Mapping[str, Array], name: str) -> list[Line2D]:
    handles = []
    for model, growth in rates.items():
        if not (np.nanmin(growth) < 0.0 < np.nanmax(growth)):
            continue
        dashes = model_style(model)["linestyle"]
        values = np.ma.masked_invalid(growth).T
        ax.contour(x, y, values, [0.0], colors="k", linestyles=[dashes], linewidths=1.3)
        handles.append(Line2D([], [], color="k", ls=dashes, label=f"{name}, {model_label(model)}"))
    return handles
