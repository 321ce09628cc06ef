"""Figures: the only part that imports matplotlib, and only when a figure is first asked for.

Every function takes plain arrays (SI) and gives a `matplotlib.figure.Figure`; `save_figure` writes
it as PNG and SVG.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .animation import MovingOrbit, animate_orbits, can_write_mp4
    from .coefficients import SpeedCurve, coefficients_over_speed, thresholds_over_speed
    from .film import FilmPicture, film_maps, film_profiles
    from .motion import OrbitPicture, bode_plot, orbit_plot, spectrum_cascade
    from .regions import PlaneAxis, stability_plane
    from .stability import (
        EigenvalueCurve,
        campbell_diagram,
        eigenvalue_plot,
        root_locus,
        stability_map,
    )
    from .style import figure_bytes, save_figure
    from .uncertainty import tolerance_histograms

_HOMES = {
    "EigenvalueCurve": "stability",
    "FilmPicture": "film",
    "MovingOrbit": "animation",
    "OrbitPicture": "motion",
    "PlaneAxis": "regions",
    "SpeedCurve": "coefficients",
    "animate_orbits": "animation",
    "bode_plot": "motion",
    "can_write_mp4": "animation",
    "campbell_diagram": "stability",
    "coefficients_over_speed": "coefficients",
    "eigenvalue_plot": "stability",
    "figure_bytes": "style",
    "film_maps": "film",
    "film_profiles": "film",
    "orbit_plot": "motion",
    "root_locus": "stability",
    "save_figure": "style",
    "spectrum_cascade": "motion",
    "stability_map": "stability",
    "stability_plane": "regions",
    "thresholds_over_speed": "coefficients",
    "tolerance_histograms": "uncertainty",
}

__all__ = [
    "EigenvalueCurve",
    "FilmPicture",
    "MovingOrbit",
    "OrbitPicture",
    "PlaneAxis",
    "SpeedCurve",
    "animate_orbits",
    "bode_plot",
    "campbell_diagram",
    "can_write_mp4",
    "coefficients_over_speed",
    "eigenvalue_plot",
    "figure_bytes",
    "film_maps",
    "film_profiles",
    "orbit_plot",
    "root_locus",
    "save_figure",
    "spectrum_cascade",
    "stability_map",
    "stability_plane",
    "thresholds_over_speed",
    "tolerance_histograms",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
