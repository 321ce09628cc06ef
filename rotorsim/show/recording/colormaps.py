"""Colours: perceptually uniform maps without a plotting library, and one colour per model."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

# Anchors at equal steps of viridis and inferno (van der Walt & Smith 2015, public domain, CC0);
# straight lines between them stay within five of 255 levels of the full tables.
_VIRIDIS = (
    "440154 481467 482576 453781 404688 39558c 33638d 2d718e 287d8e 238a8d 1f968b 20a386 29af7f"
    " 3dbc74 56c667 75d054 95d840 bade28 dde318 fde725"
)
_INFERNO = (
    "000004 08051d 180c3c 2f0a5b 450a69 5c126e 71196e 87216b 9b2964 b1325a c43c4e d74b3f e55c30"
    " f1711f f8870e fca108 fbba1f f6d543 f1ed71 fcffa4"
)

# Okabe & Ito: told apart under every common colour blindness.
MODEL_COLOURS = {
    "isothermal": (86, 180, 233),
    "thd": (230, 159, 0),
}
_OTHER_COLOURS = ((0, 158, 115), (204, 121, 167), (240, 228, 66), (213, 94, 0))

TEXT = (230, 230, 230)
LINE = (150, 150, 150)
FAINT = (80, 80, 80)
ALARM = (255, 80, 60)


def _anchors(text: str) -> NDArray[np.float64]:
    return np.array([[int(word[i : i + 2], 16) for i in (0, 2, 4)] for word in text.split()], float)


_TABLES = {"viridis": _anchors(_VIRIDIS), "inferno": _anchors(_INFERNO)}


def colours(values: ArrayLike, low: float, high: float, name: str = "viridis") -> NDArray[np.uint8]:
    """Colour each value.

    Parameters
    ----------
    values : array_like, any shape
    low, high : float
        Ends of the scale; values beyond take the end's colour, NaN is grey.
    name : {"viridis", "inferno"}

    Returns
    -------
    (..., 4) array of uint8
        Red, green, blue and full opacity.
    """
    table = _TABLES[name]
    values = np.asarray(values, dtype=float)
    span = high - low if high > low else 1.0
    place = np.clip((values - low) / span, 0.0, 1.0) * (len(table) - 1)
    known = np.isfinite(place)
    steps = np.arange(len(table))
    out = np.full((*values.shape, 4), 255, dtype=np.uint8)
    for channel in range(3):
        mixed = np.interp(np.where(known, place, 0.0), steps, table[:, channel])
        out[..., channel] = np.where(known, np.round(mixed), 128)
    return out


def model_colour(name: str) -> tuple[int, int, int]:
    """One colour for all that belongs to one model or run, the same in every view."""
    for model, colour in MODEL_COLOURS.items():
        if name == model or name.startswith(f"{model}_"):
            return colour
    return _OTHER_COLOURS[sum(name.encode()) % len(_OTHER_COLOURS)]
