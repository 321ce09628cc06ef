"""Figures of the stability analyses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..rows import QUANTITIES, RPM
from ..study.planes import Plane, held_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..study.control import ControlStudy
    from ..study.stability import Campbell
    from ..study.tolerances import ToleranceStudy


def save_figures(
    figures: Iterator[tuple[str, Figure]], folder: Path, formats: Sequence[str] = ("png", "svg")
) -> list[Path]:
    """Write named figures into `folder`."""
    from .figures import save_figure

    return [
        path
        for name, figure in figures
        for path in save_figure(figure, folder / name, formats=formats)
    ]


def plane_figure(plane: Plane, title: str = "") -> Figure:
    """Map of a plane: stable, unstable, and what only heating makes unstable."""
    from .figures import PlaneAxis, stability_plane

    def axis(name: str) -> PlaneAxis:
        quantity = QUANTITIES[name]
        values = np.asarray(plane.dataset[name].values, dtype=float)
        return PlaneAxis(quantity.axis, values * quantity.factor + quantity.offset)

    models = plane.models
    cold = "isothermal" if "isothermal" in models else models[0]
    hot = "thd" if "thd" in models else models[-1]
    heading = "\n".join(text for text in (title, held_text(plane.held)) if text)
    heated = plane.growth(hot) if hot != cold else None
    return stability_plane(axis(plane.x), axis(plane.y), plane.growth(cold), heated, title=heading)


def campbell_figures(curves: Sequence[Campbell], title: str = "") -> Iterator[tuple[str, Figure]]:
    """One diagram for each clearance (and further dimension), all its thermal models in it."""
    from .figures import EigenvalueCurve, campbell_diagram

    groups: dict[tuple, list[Campbell]] = {}
    for curve in curves:
        key = tuple((n, v) for n, v in curve.choices.items() if n != "thermal_model")
        groups.setdefault(key, []).append(curve)
    for number, (key, group) in enumerate(groups.items(), start=1):
        shown = [
            EigenvalueCurve(
                str(curve.choices["thermal_model"]),
                curve.branches.parameter,
                curve.branches.eigenvalues,
                curve.branches.whirl_sense,
                [(one.speed, one.whirl_frequency) for one in curve.thresholds],
            )
            for curve in group
        ]
        held = held_text({name: value for name, value in key if np.isfinite(value)})
        heading = "\n".join(text for text in (title, held) if text)
        name = "campbell" if len(groups) == 1 else f"campbell_{number}"
        yield name, campbell_diagram(shown, title=heading)


def tolerance_figure(study: ToleranceStudy, title: str = "") -> Figure:
    """Histograms of threshold speed and critical mass, and what matters."""
    from .figures import tolerance_histograms

    outputs = study.samples.outputs
    mass = study.rotor.rigid_mass
    failed = [sample for sample, _ in study.samples.failures]
    return tolerance_histograms(
        np.delete(outputs["threshold_speed"], failed),
        np.delete(outputs["critical_mass"], failed),
        study.importance,
        study.operating_speed,
        mass,
        (study.nominal["threshold_speed"], study.nominal["critical_mass"]),
        title,
        len(failed),
    )


def control_figures(study: ControlStudy, title: str = "") -> Iterator[tuple[str, Figure]]:
    """Root locus over the loop gain, Bode diagram of the receptance, and the runs in time."""
    from ..machine.control import receptance
    from ..machine.spectrum import MatrixSpectrum
    from ..machine.tracking import track_modes
    from .figures import OrbitPicture, bode_plot, orbit_plot, root_locus

    system, gain = study.system, study.feedback.gain
    heading = f"{title}\n{study.speed * RPM:.0f} rpm, {study.mass:.4g} kg per bearing".strip()
    share = np.linspace(0.0, 1.5, 61)

    def closed_loop(factor: float) -> np.ndarray:
        return np.asarray(system.A) - factor * np.asarray(system.B) @ gain

    locus = track_modes(MatrixSpectrum(closed_loop), share)
    yield (
        "root_locus",
        root_locus(locus.parameter, locus.eigenvalues, "share of the gain [-]", heading),
    )
    frequency = np.geomspace(0.05 * study.speed, 4.0 * study.speed, 400)
    closed = study.feedback.closed_loop(system)
    responses = [
        ("film alone", receptance(system, frequency)[0, 0]),
        ("with actuator", receptance(closed, frequency)[0, 0]),
    ]
    yield "bode", bode_plot(frequency, responses, "receptance x per force x [m/N]", title=heading)
    runs = (("film alone", study.passive_orbit), ("with actuator", study.controlled_orbit))
    pictures = [
        OrbitPicture(
            name, f"{name}: {one.status.value.replace('_', ' ')}", one.x, one.y,
            one.radial_clearance, np.asarray(study.equilibrium),
        )
        for name, one in runs
        if one is not None
    ]  # fmt: skip
    if pictures:
        yield "control_orbits", orbit_plot(pictures, heading)
