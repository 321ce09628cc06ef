"""Data of a figure for the pointer: places of its axes, their scales, the values in them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D

from ..figures.style import fields_of

_POINTS = 4000
"""Of all curves of a figure together."""
_CELLS = 60
"""Of a field, along each axis."""


def hover_data(drawn: Figure) -> str:
    """Return JSON for `figures.js`: of each plane of a drawn figure its place, scales and values.

    A plane has ``box`` (left, bottom, right, top in parts of the figure), ``x`` and ``y`` (lower,
    upper, whether logarithmic, name, unit), ``curves`` (name, colour, x, y, whether x ascends) and
    ``fields`` (name, unit, x, y, rows of values).
    """
    planes = [ax for ax in drawn.axes if _is_plane(ax)]
    names = _names(drawn)
    count = sum(len(ax.lines) for ax in planes)
    most = int(np.clip(_POINTS / max(count, 1), 20, 300))
    found = [
        {
            "box": [round(float(value), 5) for value in ax.get_position().extents],
            "x": [*_limits(ax.get_xlim()), ax.get_xscale() == "log", *_label(_along(ax, planes))],
            "y": [*_limits(ax.get_ylim()), ax.get_yscale() == "log", *_label(_across(ax, planes))],
            "curves": list(_curves(ax, names, most)),
            "fields": [
                [*_label(name), *(_plain(values[:: _step(values)]) for values in (x, y)),
                 [_plain(row[:: _step(x)]) for row in rows[:: _step(y)]]]
                for name, x, y, rows in fields_of(ax)
            ],
        }
        for ax in planes
    ]  # fmt: skip
    return json.dumps(found, ensure_ascii=False, separators=(",", ":")) if found else ""


def _is_plane(ax: Axes) -> bool:
    scales = {ax.get_xscale(), ax.get_yscale()} <= {"linear", "log"}
    return ax.name == "rectilinear" and ax.axison and scales and not hasattr(ax, "_colorbar")


def _curves(ax: Axes, names: dict[Any, str], most: int) -> Iterator[list[Any]]:
    for line in ax.lines:
        data = np.asarray(line.get_xydata(), dtype=float)
        # Lines across the whole axes are not in the data's coordinates.
        if len(data) and line.get_transform() == ax.transData:
            label = _text(str(line.get_label()))
            name = names.get(_look(line), "") if label.startswith("_") else label
            yield [name, to_hex(line.get_color()), *_thinned(data, most)]
    for dots in ax.collections:
        if isinstance(dots, PathCollection):
            colours: Any = dots.get_facecolor()
            data = np.ma.filled(np.ma.asarray(dots.get_offsets(), dtype=float), np.nan)
            label = _text(str(dots.get_label()))
            name = "" if label.startswith("_") else label
            colour = to_hex(colours[0] if len(colours) else "k")
            yield [name, colour, *_thinned(data, most)[:2], False]


def _thinned(data: np.ndarray, most: int) -> list[Any]:
    data = data[:: 1 + len(data) // most] if len(data) > most else data
    ascends = len(data) > 1 and bool((np.diff(data[:, 0]) > 0.0).all())
    return [_plain(data[:, 0]), _plain(data[:, 1]), ascends]


def _names(drawn: Figure) -> dict[Any, str]:
    """Return what the legends call the look of a line, where they call it one thing only."""
    found: dict[Any, set[str]] = {}
    for legend in drawn.findobj(Legend):
        for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=False):
            if isinstance(handle, Line2D):
                found.setdefault(_look(handle), set()).add(_text(text.get_text()))
    return {look: words.pop() for look, words in found.items() if len(words) == 1}


def _look(line: Line2D) -> tuple[Any, ...]:
    return to_hex(line.get_color()), line.get_linestyle(), line.get_marker(), line.get_linewidth()


def _limits(limits: tuple[float, float]) -> list[float]:
    return [float(value) for value in limits]


def _along(ax: Axes, planes: list[Axes]) -> str:
    """Return label of the horizontal axis, of the plane below it where that has it."""
    sides, limits = ax.get_position().intervalx, ax.get_xlim()
    alike = (
        one
        for one in planes
        if np.allclose(one.get_position().intervalx, sides, atol=0.02) and one.get_xlim() == limits
    )
    return next(filter(None, (one.get_xlabel() for one in (ax, *alike))), "")


def _across(ax: Axes, planes: list[Axes]) -> str:
    """Return label of the vertical axis: its title's, or that of the plane beside it."""
    title, heights = ax.get_title(), ax.get_position().intervaly
    if ax.get_ylabel() or (title.endswith("]") and "\n" not in title):
        return ax.get_ylabel() or title
    row = [one for one in planes if np.allclose(one.get_position().intervaly, heights, atol=0.02)]
    alike = (one.get_ylabel() for one in row if one.get_xlabel() == ax.get_xlabel())
    return next(filter(None, alike), "")


def _label(label: str) -> tuple[str, str]:
    """Return an axis' name and unit."""
    parts = re.fullmatch(r"(.*?)\s*\[(.*)\]", _text(label))
    return (parts[1], parts[2]) if parts else (_text(label), "")


def _text(label: str) -> str:
    """Return text without mathematical markup, in one line."""
    plain = re.sub(r"\$([^$]*)\$", lambda m: re.sub(r"\\mathrm|[{}\\]|_(?=\{)", "", m[1]), label)
    return " ".join(plain.split())


def _step(values: np.ndarray) -> int:
    return -(-values.size // _CELLS)


def _plain(values: np.ndarray) -> list[float | None]:
    return [float(f"{value:.5g}") if np.isfinite(value) else None for value in values]
