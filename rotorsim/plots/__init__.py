"""Figures: the only part that imports matplotlib, and only when a figure is first asked for.

Every function takes plain arrays (SI) and gives a `matplotlib.figure.Figure`; `save_figure` writes
it as PNG and SVG.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .coefficients import SpeedCurve, coefficients_over_speed, thresholds_over_speed
    from .film import FilmPicture, film_maps, film_profiles
    from .motion import OrbitPicture, bode_plot, orbit_plot, spectrum_cascade
    from .stability import EigenvalueCurve, campbell_diagram, eigenvalue_plot, stability_map
    from .style import save_figure

_HOMES = {
    "EigenvalueCurve": "stability",
    "FilmPicture": "film",
    "OrbitPicture": "motion",
    "SpeedCurve": "coefficients",
    "bode_plot": "motion",
    "campbell_diagram": "stability",
    "coefficients_over_speed": "coefficients",
    "eigenvalue_plot": "stability",
    "film_maps": "film",
    "film_profiles": "film",
    "orbit_plot": "motion",
    "save_figure": "style",
    "spectrum_cascade": "motion",
    "stability_map": "stability",
    "thresholds_over_speed": "coefficients",
}

__all__ = [
    "EigenvalueCurve",
    "FilmPicture",
    "OrbitPicture",
    "SpeedCurve",
    "bode_plot",
    "campbell_diagram",
    "coefficients_over_speed",
    "eigenvalue_plot",
    "film_maps",
    "film_profiles",
    "orbit_plot",
    "save_figure",
    "spectrum_cascade",
    "stability_map",
    "thresholds_over_speed",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
