"""Figures of a machine's whole job."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..machine.critical_map import critical_speed_map, principal_stiffness
from ..machine.peaks import node_at
from ..study.lateral import LateralStudy
from ..study.machine import MachineResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_STIFFNESS = np.geomspace(1e5, 1e10, 61)
"""Of the undamped critical speed map [N/m]."""


def write_machine_figures(
    results: Mapping[str, MachineResult], study: LateralStudy, folder: Path
) -> list[Path]:
    """Write every figure of a machine as PNG and SVG.

    results : By thermal model; modes and response are those of the last.
    """
    from .figures.style import save_figure

    return [
        path
        for name, figure in machine_figures(results, study)
        for path in save_figure(figure, folder / name)
    ]


def machine_figures(
    results: Mapping[str, MachineResult], study: LateralStudy
) -> Iterator[tuple[str, Figure]]:
    """Give names and figures of all that a machine's results have."""
    from .figures import machine as draw

    last = list(results.values())[-1]
    description, title = last.description, last.description.title
    continuous = description.operating.continuous
    yield "rotor", draw.rotor_drawing(description, title)
    found = {name: one.modes for name, one in results.items() if one.modes is not None}
    if last.modes is not None:
        if last.known.size > 1:
            campbell = draw.machine_campbell(last.modes, last.critical_speeds, continuous, title)
            yield "campbell", campbell
            thresholds = {name: results[name].thresholds for name in found}
            yield "growth_rate", draw.growth_over_speed(found, thresholds, title)
        top = float(last.known[-1])
        yield "mode_shapes", draw.mode_shapes(last.machine.rotor, last.modes, top, title=title)
    if study.responses:
        yield "unbalance_response", draw.bode_at_probes(study.responses, continuous, title)
    if study.decrement_curves:
        yield "destabilising", draw.decrement_over_stiffness(study.decrement_curves, title)
    if description.support and last.known.size:
        rotor = last.machine.rotor
        nodes = [node_at(rotor, entry.at) for entry in description.support]
        chart = critical_speed_map(rotor, nodes, _STIFFNESS)
        own = principal_stiffness(last.machine, last.known)
        map_figure = draw.critical_speed_chart(chart, own, last.known, continuous, title)
        yield "critical_speed_map", map_figure
