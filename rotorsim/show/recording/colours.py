"""Colours: Matplotlib's maps for values, and one colour for each run."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
from numpy.typing import ArrayLike, NDArray

# Okabe & Ito: told apart under every common colour blindness.
_MODEL_COLOURS = {"isothermal": (86, 180, 233), "thd": (230, 159, 0)}
_OTHER_COLOURS = ((0, 158, 115), (204, 121, 167), (240, 228, 66), (213, 94, 0))
TEXT = (230, 230, 230)
LINE = (150, 150, 150)
FAINT = (80, 80, 80)
ALARM = (255, 80, 60)


def colours(values: ArrayLike, low: float, high: float, name: str = "viridis") -> NDArray[np.uint8]:
    """Colour each value.

    values : array_like, any shape
    low, high : Ends of the scale; values beyond take the end's colour, NaN is grey.
    name : Of a Matplotlib colormap.
    Returns (..., 4) array of uint8: Red, green, blue and full opacity.
    """
    table = mpl.colormaps[name].with_extremes(bad="#808080")
    span = high - low if high > low else 1.0
    return table(np.ma.masked_invalid((np.asarray(values, dtype=float) - low) / span), bytes=True)


def model_colour(name: str) -> tuple[int, int, int]:
    """One colour for all that belongs to one model or run, the same in every view."""
    for model, colour in _MODEL_COLOURS.items():
        if name == model or name.startswith(f"{model}_"):
            return colour
    return _OTHER_COLOURS[sum(name.encode()) % len(_OTHER_COLOURS)]
