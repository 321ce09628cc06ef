"""Figures of the stability analyses of the command line."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..rows import QUANTITIES, RPM
from ..study.planes import Plane, held_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..study.control import ControlStudy
    from ..study.stability import Campbell
    from ..study.tolerances import ToleranceStudy


def plane_figures(plane: Plane, title: str = "") -> Iterator[tuple[str, Figure]]:
    """Map of a plane: stable, unstable, and what only heating makes unstable."""
    from .figures import stability_map

    heading = "\n".join(text for text in (title, held_text(plane.held)) if text)
    name = f"map_{plane.x}_{plane.y}"
    yield name, stability_map(plane.dataset, plane.x, plane.y, title=heading)


def tolerance_figures(study: ToleranceStudy, title: str = "") -> Iterator[tuple[str, Figure]]:
    """Histograms of threshold speed and critical mass, and what matters."""
    from .figures import tolerance_histograms

    yield "tolerances", tolerance_histograms(study, title)


def campbell_figures(curves: Sequence[Campbell], title: str = "") -> Iterator[tuple[str, Figure]]:
    """One diagram for each clearance (and further dimension), all its thermal models in it."""
    from .figures import campbell_diagram

    groups: dict[tuple, list[Campbell]] = {}
    for curve in curves:
        key = tuple((n, v) for n, v in curve.choices.items() if n != "thermal_model")
        groups.setdefault(key, []).append(curve)
    for number, (key, group) in enumerate(groups.items(), start=1):
        held = held_text({n: v for n, v in key if n in QUANTITIES and np.isfinite(v)})
        heading = "\n".join(text for text in (title, held) if text)
        name = "campbell" if len(groups) == 1 else f"campbell_{number}"
        yield name, campbell_diagram(group, title=heading)


def control_figures(study: ControlStudy, title: str = "") -> Iterator[tuple[str, Figure]]:
    """Root locus over the loop gain, Bode diagram of the receptance, and the runs in time."""
    from ..machine.control import receptance
    from ..machine.spectrum import MatrixSpectrum
    from ..machine.tracking import track_modes
    from .figures import bode_plot, orbit_plot, root_locus

    system, gain = study.system, study.feedback.gain
    heading = f"{title}\n{study.speed * RPM:.0f} rpm, {study.mass:.4g} kg per bearing".strip()
    share = np.linspace(0.0, 1.5, 61)

    def closed_loop(factor: float) -> np.ndarray:
        return np.asarray(system.A) - factor * np.asarray(system.B) @ gain

    locus = track_modes(MatrixSpectrum(closed_loop), share)
    yield "root_locus", root_locus(locus, "share of the gain [-]", heading)
    frequency = np.geomspace(0.05 * study.speed, 4.0 * study.speed, 400)
    closed = study.feedback.closed_loop(system)
    responses = [
        ("film alone", receptance(system, frequency)[0, 0]),
        ("with actuator", receptance(closed, frequency)[0, 0]),
    ]
    yield "bode", bode_plot(frequency, responses, "receptance x per force x [m/N]", title=heading)
    runs = {"film alone": study.passive_orbit, "with actuator": study.controlled_orbit}
    known = {name: orbit for name, orbit in runs.items() if orbit is not None}
    if known:
        names = [f"{name}: {one.status.value.replace('_', ' ')}" for name, one in known.items()]
        yield "control_orbits", orbit_plot(list(known.values()), heading, names=names)
