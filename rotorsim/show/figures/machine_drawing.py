"""Drawing of a machine to scale."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from ...files.machine import MachineFile
from ...model.shaft import Disc, Section
from ...rotor import Beam
from ...rows import axis_title, quantity
from ...text import caption
from .style import axes_or_new, figure_of

_LENGTH = quantity("length", "m")
_SHAFT, _SLEEVE, _DISC, _SUPPORT, _SEAL = "#d9dde2", "#eef0f2", "#8fa3b5", "#D55E00", "#009E73"


def rotor_drawing(machine: MachineFile, title: str = "", ax: Axes | None = None) -> Figure:
    """Return rotor to scale: sections, discs, added masses, bearings, seals, probes, clearances."""
    beam = machine.rotor.beam
    ax = axes_or_new(ax, (8.2, 3.6))
    top = max(s.outer_diameter for s in beam.sections) / 2.0
    top = max([top, *(beam.disc_size(disc)[0] for disc in beam.discs if disc.has_size)])
    for disc in beam.discs:
        _draw_disc(ax, disc, beam, top)
    for section in sorted(beam.sections, key=lambda one: one.layer):
        _draw_section(ax, beam, section)
    ax.plot(
        np.array([-0.03, 1.03]) * beam.length * _LENGTH.factor, [0, 0], color="0.3", linewidth=0.7,
        linestyle=(0, (12, 3, 2, 3)),
    )  # fmt: skip
    size = 0.16 * top * _LENGTH.factor
    for name, entry in zip(machine.support_names, machine.support, strict=True):
        radius = beam.outer_radius(entry.at) * _LENGTH.factor
        x = entry.at * _LENGTH.factor
        for side in (-1.0, 1.0):
            tip = side * radius
            corners = [
                (x, tip),
                (x - size, tip + side * 2 * size),
                (x + size, tip + side * 2 * size),
            ]
            ax.add_patch(Polygon(corners, closed=True, fc="w", ec=_SUPPORT, lw=1.4, zorder=4))
        _label(ax, x, -radius - 2.2 * size, name, _SUPPORT, "top")
    for entry in machine.seal:
        radius, x = beam.outer_radius(entry.at) * _LENGTH.factor, entry.at * _LENGTH.factor
        ax.plot([x, x], [radius, radius + 2 * size], color=_SEAL, lw=3.0, zorder=4)
        ax.plot([x, x], [-radius, -radius - 2 * size], color=_SEAL, lw=3.0, zorder=4)
    for at in dict.fromkeys(entry.at for entry in machine.probe):
        x, radius = at * _LENGTH.factor, _outermost(beam, at) * _LENGTH.factor
        ax.annotate(
            "", (x, radius), (x, radius + 3.5 * size), zorder=5, annotation_clip=False,
            arrowprops={"arrowstyle": "-|>", "color": "#0072B2", "lw": 1.2},
        )  # fmt: skip
        ax.update_datalim([(x, radius + 5.0 * size)])
        named = [one.name for one in machine.probe if one.at == at and one.name]
        _label(ax, x, radius + 3.7 * size, "\n".join(named), "#0072B2", "bottom")
    for entry in machine.rotor.unbalance:
        ax.plot(entry.at * _LENGTH.factor, 0.0, "o", color="k", ms=4.5, zorder=6)
    _key(ax, machine)
    ax.set_aspect("equal", adjustable="datalim")
    ax.grid(visible=False)
    ax.set(xlabel=axis_title("from the left end", "mm"), ylabel=axis_title("radius", "mm"),
           title=caption(title))  # fmt: skip
    ax.margins(0.04, 0.22)
    return figure_of(ax)


def _draw_section(ax: Axes, beam: Beam, section: Section) -> None:
    left, right = beam.span(section)
    ends = np.array([left, right])
    inner, outer = (part * _LENGTH.factor for part in beam.at(ends, section))
    z = ends * _LENGTH.factor
    face = _SLEEVE if section.layer > 1 else _SHAFT
    hatch = "////" if not section.stiffness else None
    halves = (-1.0, 1.0) if inner.any() else (0.0,)
    for side in halves:
        low, high = (side * inner, side * outer) if side else (-outer, outer)
        corners = [(z[0], low[0]), (z[0], high[0]), (z[1], high[1]), (z[1], low[1])]
        ax.add_patch(
            Polygon(corners, closed=True, fc=face, ec="0.25", lw=0.8, hatch=hatch, zorder=3)
        )
    ax.update_datalim([(z[0], -outer.max()), (z[1], outer.max())])


def _draw_disc(ax: Axes, disc: Disc, beam: Beam, top: float) -> None:
    x = disc.at * _LENGTH.factor
    if disc.has_size:
        outer, width = beam.disc_size(disc)
        shaft = beam.outer_radius(disc.at)
        for low in (shaft, -outer):
            box = (x - 0.5 * width * _LENGTH.factor, low * _LENGTH.factor)
            height = (outer - shaft) * _LENGTH.factor
            ax.add_patch(
                Rectangle(box, width * _LENGTH.factor, height, fc=_DISC, ec="0.2", lw=0.8, zorder=2)
            )
        ax.update_datalim([(x, -1.15 * outer * _LENGTH.factor), (x, outer * _LENGTH.factor)])
        _label(ax, x, -1.03 * outer * _LENGTH.factor, disc.name, "0.2", "top")
    else:
        ax.plot(x, 0.0, "s", color=_DISC, mec="0.2", ms=8, ls="", zorder=6)
        _label(ax, x, -1.03 * top * _LENGTH.factor, disc.name, "0.2", "top")


def _outermost(beam: Beam, at: float) -> float:
    """Return the outer radius of the shaft and its discs at a place [m]."""
    found = beam.outer_radius(at)
    for disc in beam.discs:
        if disc.has_size:
            outer, width = beam.disc_size(disc)
            found = max(found, outer) if abs(at - disc.at) <= 0.5 * width else found
    return found


def _label(ax: Axes, x: float, y: float, text: str, color: str, vertical: str) -> None:
    if text:
        ax.text(x, y, caption(text), color=color, fontsize=7.5, ha="center", va=vertical, zorder=7)


def _key(ax: Axes, machine: MachineFile) -> None:
    """Draw the legend of what the file has, below the drawing."""
    ax.plot([], [], "^", mfc="w", mec=_SUPPORT, ms=8, ls="", label="bearing")
    if machine.seal:
        ax.plot([], [], color=_SEAL, lw=3.0, label="seal")
    if machine.probe:
        ax.plot([], [], marker="v", color="#0072B2", ls="", label="probe")
    if machine.rotor.unbalance:
        ax.plot([], [], "o", color="k", ms=4.5, ls="", label="unbalance")
    if any(not disc.polar_inertia for disc in machine.rotor.beam.discs):
        ax.plot([], [], "s", color=_DISC, mec="0.2", ms=8, ls="", label="added mass")
    if any(not section.stiffness for section in machine.rotor.beam.sections):
        ax.fill([], [], fc=_SLEEVE, ec="0.25", hatch="////", label="mass without stiffness")
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), ncols=6, frameon=False)
