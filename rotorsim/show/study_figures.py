"""Figures of stability maps, tolerances, modes over speed and control, with their files' names."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..rows import QUANTITIES, RPM, with_unit
from ..study.planes import Plane, held_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..study.control import ControlStudy
    from ..study.machine_control import MachineControlStudy
    from ..study.stability import Campbell
    from ..study.tolerances import ToleranceStudy


def plane_figures(plane: Plane, title: str = "") -> Iterator[tuple[str, Figure]]:
    """Return the map of a plane: stable, unstable, and what only heating makes unstable."""
    from .figures import stability_map

    heading = "\n".join(text for text in (title, held_text(plane.held)) if text)
    yield plane.file_name, stability_map(plane.dataset, plane.x, plane.y, title=heading)


def tolerance_figures(study: ToleranceStudy, title: str = "") -> Iterator[tuple[str, Figure]]:
    """Return histograms of threshold speed and critical mass, and what matters."""
    from .figures import tolerance_histograms

    yield "tolerances", tolerance_histograms(study, title)


def campbell_figures(curves: Sequence[Campbell], title: str = "") -> Iterator[tuple[str, Figure]]:
    """Return one diagram for each clearance (and further dimension).

    All its thermal models in it.
    """
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
    """Return root locus, Bode diagram of the receptance, and the runs in time."""
    from ..machine.control import receptance
    from ..machine.spectrum import MatrixSpectrum
    from ..machine.tracking import track_modes
    from .figures import bode_plot, orbit_plot, root_locus

    system, gain = study.system, study.feedback.gain
    heading = (
        f"{title}\n{study.speed * RPM:.0f} rpm, {with_unit(study.mass, 'kg')} per bearing".strip()
    )
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


def machine_control_figures(
    study: MachineControlStudy, title: str = ""
) -> Iterator[tuple[str, Figure]]:
    """Return the receptance from actuator to sensor, whole and reduced, and the runs in time."""
    from ..machine.output_feedback import controlled_response
    from ..machine.reduction import response
    from .figures import bode_plot
    from .figures.machine_response import control_traces

    heading = f"{title}\n{study.speed * RPM:.0f} rpm, {study.design.name}".strip()
    frequency = np.geomspace(0.05 * study.speed, 6.0 * study.speed, 800)
    system, small = study.system, study.reduction.system
    responses = [
        ("whole machine", response(system.A, system.B, system.C)(frequency)[:, 0, 0]),
        (f"reduced to {small.nstates} states",
         response(small.A, small.B, small.C)(frequency)[:, 0, 0]),
        ("with control", controlled_response(system, study.feedback, frequency)[:, 0, 0]),
    ]  # fmt: skip
    yield "control_bode", bode_plot(frequency, responses, "x sensor/force x [m/N]", title=heading)
    if study.controlled is not None and study.passive is not None:
        yield "control_in_time", control_traces(study.passive, study.controlled, heading)
