"""Figures of a machine's whole job."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..machine.critical_map import critical_speed_map, principal_stiffness
from ..machine.peaks import node_at
from ..orbit.motion import Motion
from ..rows import RPM, heads, shown
from ..study.hot_spot import HotSpotStudy
from ..study.lateral import LateralStudy
from ..study.machine import MachineResult
from ..study.motion_results import films_in_motion, labelled, motion_document
from ..text import markdown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..files.machine import MachineFile

_STATION_SAMPLES = 80_000
"""Of all orbits in a recording together."""
_STIFFNESS = np.geomspace(1e5, 1e10, 61)
"""Of the undamped critical speed map [N/m]."""


def write_machine_figures(
    results: Mapping[str, MachineResult],
    study: LateralStudy,
    folder: Path,
    spots: HotSpotStudy | None = None,
) -> list[Path]:
    """Write every figure of a machine as PNG and SVG.

    results : By thermal model; modes and response are those of the last.
    """
    from .figures.style import save_figure

    return [
        path
        for name, figure in machine_figures(results, study, spots)
        for path in save_figure(figure, folder / name)
    ]


def machine_figures(
    results: Mapping[str, MachineResult], study: LateralStudy, spots: HotSpotStudy | None = None
) -> Iterator[tuple[str, Figure]]:
    """Give names and figures of all that a machine's results have."""
    from . import figures as draw
    from .figures.machine import decrement_over_stiffness
    from .figures.machine_response import hot_spot_loop

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
        yield "destabilising", decrement_over_stiffness(study.decrement_curves, title)
    if spots is not None:
        yield "hot_spot", hot_spot_loop(spots, title)
    if description.support and last.known.size:
        rotor = last.machine.rotor
        nodes = [node_at(rotor, entry.at) for entry in description.support]
        chart = critical_speed_map(rotor, nodes, _STIFFNESS)
        own = principal_stiffness(last.machine, last.known)
        map_figure = draw.critical_speed_chart(chart, own, last.known, continuous, title)
        yield "critical_speed_map", map_figure


def write_motion(
    machine: MachineFile,
    motion: Motion,
    recording: Path,
    folder: Path | None = None,
    animations: Sequence[str] = (),
    steady: bool = False,
    result: MachineResult | None = None,
) -> list[Path]:
    """Record a machine's motion; write figures and animations where a folder is given.

    result : Its linear analysis, for the natural frequencies over speed.

    Returns: The recording first.
    """
    from .figures.machine import machine_campbell
    from .figures.orbits import animate_machine
    from .job import orbit_figures, save_figures
    from .recording import RecordingContents, write_recording

    count = max(1, motion.t.size * len(motion.stations) // _STATION_SAMPLES)
    per_turn = motion.problem.samples_per_revolution
    # whole parts of a turn stay whole
    step = next(k for k in range(count, per_turn + count) if per_turn % k == 0 or k > per_turn)
    whole = [labelled(motion, one.name) for one in motion.stations]
    orbits = [one.part(0, None, step) if step > 1 else one for one in whole]
    campbell = None
    if result is not None and result.modes is not None and result.known.size > 1:
        campbell = machine_campbell(result.modes, result.critical_speeds)
    contents = RecordingContents(
        title=machine.title, summary=_motion_summary(motion), kind=motion.problem.kind,
        orbits=tuple(orbits), films=tuple(films_in_motion(motion)), machine=(machine, motion),
        campbell=campbell,
    )  # fmt: skip
    files = [write_recording(recording, contents)]
    if folder is not None:
        lines = [_half_speeds(motion, one.name) for one in motion.stations[:4]]
        drawn = orbit_figures(whole[:4], machine.title, steady, lines)
        files += save_figures(drawn, folder, ("png",))
    for suffix in animations:
        assert folder is not None
        target = folder / f"motion{suffix}"
        rotor = machine.rotor_with_unbalance()
        files.append(animate_machine(motion, rotor, target, machine.title, steady))
    return files


def _half_speeds(motion: Motion, station: str) -> dict[str, tuple[Array, Array]]:
    """Return what oil whirls with in a station's floating ring: half the mean speeds of a film."""
    if not any(one.name == station and one.ring >= 0 for one in motion.problem.system.links):
        return {}
    ring, speed = motion.ring_speed(station), motion.speed
    return {"half of shaft + ring": (speed, 0.5 * (speed + ring)), "half of ring": (
        speed, 0.5 * ring)}  # fmt: skip


def _motion_summary(motion: Motion) -> str:
    """Return the outcome in Markdown."""
    document = motion_document(motion)
    lines = [
        f"{document['kind'].replace('_', ' ')}, {document['speed'][0] * RPM:.0f} to "
        f"{document['speed'][1] * RPM:.0f} rpm, {document['revolutions']:.0f} turns, "
        f"{document['note']}.", "",
        f"| station | {heads('amplitude µm')[0]} | outcome |", "| --- | --- | --- |",
    ]  # fmt: skip
    lines += [
        f"| {markdown(row['station'])} | {shown(row['amplitude'] * 1e6, 'µm')} | "
        f"{row['status'].replace('_', ' ')} |"
        for row in document["stations"]
    ]
    return "\n".join(lines)
