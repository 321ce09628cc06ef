"""One look for all figures: told apart by line style as well as colour, readable in grey."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from ...atomic import replacing
from ...rows import RPM as RPM
from ...text import caption

MICRO = 1e6
MEGA = 1e-6

# Okabe & Ito colours of unlike lightness: blue is dark and orange is light in grey, too.
MODEL_STYLES: dict[str, dict[str, Any]] = {
    "isothermal": {"color": "#0072B2", "linestyle": (0, (5, 2))},
    "thd": {"color": "#D55E00", "linestyle": "-"},
}
_OTHER_STYLES: tuple[dict[str, Any], ...] = (
    {"color": "#009E73", "linestyle": "-."},
    {"color": "#CC79A7", "linestyle": ":"},
    {"color": "#000000", "linestyle": (0, (1, 1))},
)
MARKERS = ("o", "s", "^", "D", "v", "P")
SETTINGS: Any = {
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": True,
    "legend.framealpha": 0.9,
    "legend.fontsize": 8.0,
    "lines.linewidth": 1.5,
    "lines.markersize": 4.0,
    "svg.hashsalt": "rotorsim",
}


def model_style(name: str) -> dict[str, Any]:
    """Return colour and dashes of a thermal model, the same in every figure."""
    if name in MODEL_STYLES:
        return MODEL_STYLES[name]
    return _OTHER_STYLES[sum(name.encode()) % len(_OTHER_STYLES)]


def series_style(name: str, number: int) -> dict[str, Any]:
    """Return style of a thermal model, or the `number`-th for other series."""
    if name in MODEL_STYLES:
        return MODEL_STYLES[name]
    styles = (_OTHER_STYLES[2], MODEL_STYLES["thd"], *_OTHER_STYLES[:2])
    return styles[number % len(styles)]


def model_label(name: str) -> str:
    """Write a model's name for legends."""
    return {"thd": "THD"}.get(name, name)


def new_figure(width: float, height: float, title: str = "") -> Figure:
    """Return empty figure [inches], drawn without a screen and without pyplot's global state."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    if title:
        figure.suptitle(caption(title), fontsize=11)
    return figure


def new_axes(
    rows: int, columns: int, size: tuple[float, float], title: str = "", **options: Any
) -> tuple[Figure, np.ndarray]:
    """Return the figure with a grid of axes, (rows, columns), in the common style."""
    with mpl.rc_context(SETTINGS):
        figure = new_figure(*size, title)
        axes = figure.subplots(rows, columns, squeeze=False, **options)
    return figure, axes


def axes_or_new(ax: Axes | None, size: tuple[float, float]) -> Axes:
    """Give back `ax`, or the only axes of a new figure."""
    if ax is not None:
        return ax
    return new_axes(1, 1, size)[1][0, 0]


_fields: WeakKeyDictionary[Axes, list[tuple[str, Any, Any, Any]]] = WeakKeyDictionary()


def keep_field(ax: Axes, name: str, x: Any, y: Any, rows: Any) -> None:
    """Keep the values behind contours, which matplotlib forgets, for who points at them.

    name : With its unit in brackets, as an axis' label.
    rows : (y.size, x.size) array
    """
    _fields.setdefault(ax, []).append((name, x, y, rows))


def fields_of(ax: Axes) -> list[tuple[str, Any, Any, Any]]:
    """Return what was kept of the axes, as `keep_field` was given it."""
    return _fields.get(ax, [])


def figure_of(ax: Axes) -> Figure:
    """Return the figure that an axes belongs to."""
    figure = ax.get_figure(root=True)
    assert isinstance(figure, Figure)
    return figure


def mark_range(ax: Axes, continuous: tuple[float, float] | None) -> None:
    """Shade the range of continuous speeds [rad/s] along x."""
    if continuous is not None:
        low, high = (one * RPM for one in continuous)
        ax.axvspan(low, high, color="#009E73", alpha=0.10, zorder=0, label="continuous speeds")


@dataclass(frozen=True)
class FigureFiles:
    """Style, width and format of figure files where they differ from the usual.

    formats : Suffixes; None: as the command does.
    width : Of each figure [inch]; its height follows. None: as drawn.
    font : Size of ordinary text [pt]; None: as drawn.
    """

    formats: tuple[str, ...] | None = None
    width: float | None = None
    font: float | None = None


FORMATS = ("png", "svg", "pdf")
_asked = [FigureFiles()]


def ask_figures(files: FigureFiles) -> None:
    """Write figures like this from now on."""
    _asked[0] = files


def save_figure(
    figure: Figure, stem: str | Path, formats: Sequence[str] = ("png", "svg"), dpi: int = 150
) -> list[Path]:
    """Write a figure as STEM.png and STEM.svg, each whole or not at all; see `ask_figures`.

    stem : str or Path. File name without suffix; missing folders are made.
    dpi : Of pixel formats.
    """
    asked = _asked[0]
    if asked.width is not None:
        width, height = figure.get_size_inches()
        figure.set_size_inches(asked.width, height * asked.width / width)
    if asked.font is not None:
        ratio = asked.font / SETTINGS["font.size"]
        for text in figure.findobj(Text):
            text.set_fontsize(ratio * text.get_fontsize())
    written = []
    for suffix in asked.formats or formats:
        path = Path(f"{stem}.{suffix}")
        with replacing(path) as temporary:
            temporary.write_bytes(figure_bytes(figure, suffix, dpi))
        written.append(path)
    return written


def figure_bytes(figure: Figure, suffix: str = "svg", dpi: int = 150) -> bytes:
    """Give what a file of the figure would hold."""
    # Without the date, the same figure gives the same file.
    metadata = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(suffix)
    stream = io.BytesIO()
    with mpl.rc_context(SETTINGS):
        figure.savefig(stream, format=suffix, dpi=dpi, metadata=metadata)
    return stream.getvalue()
