"""Figures of results: every function takes results (SI) and gives a `matplotlib.figure.Figure`.

Matplotlib is imported with this package: import it where a figure is drawn. `save_figure` writes
PNG and SVG.
"""

from .bearing import (
    coefficients_over_speed,
    film_maps,
    film_profiles,
    measured_points,
    thresholds_over_speed,
)
from .machine import (
    critical_speed_chart,
    growth_over_speed,
    machine_campbell,
    mode_shape,
    mode_shapes,
)
from .machine_drawing import rotor_drawing
from .machine_response import bode_at_probes
from .map import stability_map
from .orbits import (
    animate_orbits,
    bode_plot,
    can_write_mp4,
    orbit_plot,
    spectrum_cascade,
    spectrum_plot,
)
from .pads import pad_sections
from .stability import campbell_diagram, eigenvalue_plot, root_locus, tolerance_histograms
from .study import study_plot
from .style import figure_bytes, save_figure
from .transient import transient_plot

__all__ = [
    "animate_orbits",
    "bode_at_probes",
    "bode_plot",
    "campbell_diagram",
    "can_write_mp4",
    "coefficients_over_speed",
    "critical_speed_chart",
    "eigenvalue_plot",
    "figure_bytes",
    "film_maps",
    "film_profiles",
    "growth_over_speed",
    "machine_campbell",
    "measured_points",
    "mode_shape",
    "mode_shapes",
    "orbit_plot",
    "pad_sections",
    "root_locus",
    "rotor_drawing",
    "save_figure",
    "spectrum_cascade",
    "spectrum_plot",
    "stability_map",
    "study_plot",
    "thresholds_over_speed",
    "tolerance_histograms",
    "transient_plot",
]
