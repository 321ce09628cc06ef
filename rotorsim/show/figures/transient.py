"""A thermal transient over time."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from ...rows import QUANTITIES, axis_title, in_shown_unit, with_unit
from ...study.transient import Transient
from .style import RPM, new_axes


def transient_plot(transient: Transient, title: str = "") -> Figure:
    """Draw temperatures, clearance and film, speed and load, growth rate over time."""
    figure, axes = new_axes(2, 2, (9.6, 6.8), title)
    time, celsius = transient.time, QUANTITIES["max_temperature"]
    small = QUANTITIES["radial_clearance"]
    heat, gap, operation, growth = axes.flat
    solid = "pads" if transient.points[0].pads else "bush"
    for label, values in (
        ("hottest oil", transient.values("max_temperature")),
        ("journal, mean", transient.shaft_temperature),
        (f"{solid}, mean", transient.bush_temperature),
    ):
        heat.plot(time, celsius.shown(values), label=label)
    heat.set_ylabel(axis_title("temperature", "°C"))
    gap.plot(time, small.shown(transient.clearance), label="radial clearance")
    gap.plot(time, small.shown(transient.values("min_film_thickness")), label="minimum film")
    gap.set_ylabel(axis_title("thickness", "µm"))
    gap.set_ylim(bottom=0.0)
    operation.plot(time, transient.values("speed") * RPM, label="speed")
    operation.set_ylabel("speed [rpm]")
    operation.set_ylim(bottom=0.0)
    load = operation.twinx()
    load.plot(time, in_shown_unit(transient.values("load") * 1e-3, "kN"), "C1--", label="load")
    load.set_ylabel(axis_title("load", "kN"))
    load.set_ylim(bottom=0.0)
    if transient.rotor_mass is not None:
        growth.plot(
            time, transient.growth_rate, label=f"rotor of {with_unit(transient.rotor_mass, 'kg')}"
        )
        growth.axhline(0.0, color="0.5", linewidth=0.8)
        growth.set_ylabel("growth rate [1/s], unstable above 0")
    else:
        for place, name in ((0, "Kxx"), (3, "Kyy")):
            stiffness = np.stack([p.stiffness.ravel()[place] for p in transient.points])
            growth.plot(time, in_shown_unit(stiffness * 1e-6, "MN/m"), label=name)
        growth.set_ylabel(axis_title("stiffness", "MN/m"))
    for name, ax, marker in (
        ("least_clearance", gap, "v"), ("least_film", gap, "^"), ("least_stability", growth, "o"),
    ):  # fmt: skip
        place = transient.moments().get(name)
        if place is not None:
            line = ax.lines[1 if name == "least_film" else 0]
            at = float(time[place]), float(np.asarray(line.get_ydata())[place])
            ax.plot(*at, marker, color="0.2", label=f"{name.replace('_', ' ')}, {at[0]:.4g} s")
    for ax in axes.flat:
        ax.set_xlabel("time [s]")
        ax.legend(fontsize="small")
    return figure
