"""From results to figures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..study.stability import map_planes
from .orbit_pictures import orbit_figures

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .figures import SpeedCurve
    from .main_job import Results

_FORMATS = ("png",)


def write_figures(results: Results, folder: Path) -> list[Path]:
    """Write every figure that the results have something for, as PNG."""
    from .figures import save_figure

    written: list[Path] = []
    for name, figure in figures(results):
        written += save_figure(figure, folder / name, formats=_FORMATS)
        figure.clear()  # it refers to itself in circles: what it drew would stay for a while
    return written


def figures(results: Results) -> Iterator[tuple[str, Figure]]:
    """Give file names (without suffix) and figures."""
    from . import figures as plots

    title = results.scenario.title
    curves = speed_curves(results)
    yield "coefficients", plots.coefficients_over_speed(curves, title)
    yield "critical_mass", plots.thresholds_over_speed(curves, results.rotor_mass, title)
    yield from _maps(results)
    yield from _eigenvalues(results)
    if results.films:
        pictures = [
            plots.FilmPicture(film.name, film.theta, film.y, film.pressure, film.temperature)
            for film in results.films_at_top_speed
        ]
        yield "film", plots.film_maps(pictures, title)
        yield "film_profiles", plots.film_profiles(pictures, title)
    if results.orbits:
        settings = results.scenario.orbit
        steady_only = settings is not None and settings.steady_only
        yield from orbit_figures(results.orbits, title, steady_only)


def speed_curves(results: Results) -> list[SpeedCurve]:
    """K, C and thresholds of every thermal model and clearance."""
    from .figures import SpeedCurve

    table = results.table
    shape = table.converged.shape[:-1]
    return [
        SpeedCurve(
            name=str(curve.choices["thermal_model"]),
            radial_clearance=curve.choices["radial_clearance"],
            speed=curve.speed,
            stiffness=table.stiffness[index],
            damping=table.damping[index],
            critical_mass=curve.critical_mass,
            whirl_frequency_ratio=curve.whirl_frequency_ratio,
        )
        for index, curve in zip(np.ndindex(shape), results.curves, strict=True)
    ]


def _maps(results: Results) -> Iterator[tuple[str, Figure]]:
    from .figures import stability_map

    if results.chart is None:
        return
    planes = map_planes(results.chart)
    settings = results.scenario.orbit
    for plane in planes:
        point = None
        if settings is not None and results.rotor_mass is not None:
            speed = float(results.orbits[0].speed[-1]) if results.orbits else None
            here = np.isclose(plane.radial_clearance, settings.radial_clearance, rtol=1e-6, atol=0)
            point = (speed, results.rotor_mass) if here and speed is not None else None
        micro = f"{plane.radial_clearance * 1e6:.4g}"
        figure = stability_map(
            plane.speed,
            plane.mass,
            plane.isothermal_growth,
            plane.heated_growth,
            operating_point=point,
            title=f"{results.scenario.title}\nc = {micro} µm",
        )
        yield f"stability_map_{micro}um" if len(planes) > 1 else "stability_map", figure


def _eigenvalues(results: Results) -> Iterator[tuple[str, Figure]]:
    from .figures import EigenvalueCurve, eigenvalue_plot

    shown: Sequence[EigenvalueCurve] = [
        EigenvalueCurve(path.name, path.speed, path.eigenvalues) for path in results.eigenvalues
    ]
    if shown:
        yield "eigenvalues", eigenvalue_plot(shown, results.scenario.title)
