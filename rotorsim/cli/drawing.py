"""Bearings and rotors drawn in the terminal, to scale, in dots of Braille characters."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..arrays import Array
    from ..files.machine import MachineFile
    from ..model import Bearing

_DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
"""Bits of the dots of a Braille character, by row and column."""
_FILM = 0.16
"""Radial clearance of the drawing over the journal's radius."""


class _Canvas:
    """Characters of 2 x 4 dots, and texts over them; y upwards.

    The columns and rows are those of characters; a dot is as high as wide.
    """

    def __init__(self, low: tuple[float, float], high: tuple[float, float], columns: int) -> None:
        self.low, self.scale = low, (2 * columns - 1) / (high[0] - low[0])
        rows = math.ceil((self.scale * (high[1] - low[1]) + 1.0) / 4.0)
        self.bits = np.zeros((rows, columns), dtype=int)
        self.texts: list[tuple[int, int, str]] = []

    def _dot(self, x: Array, y: Array) -> tuple[Array, Array]:
        across = np.rint(self.scale * (np.asarray(x) - self.low[0])).astype(int)
        up = np.rint(self.scale * (np.asarray(y) - self.low[1])).astype(int)
        return across, 4 * self.bits.shape[0] - 1 - up

    def line(self, x: Iterable[float], y: Iterable[float]) -> None:
        """Draw a polygon through the points."""
        x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
        for k in range(x.size - 1):
            steps = int(2.0 * self.scale * np.hypot(x[k + 1] - x[k], y[k + 1] - y[k])) + 2
            part = np.linspace(0.0, 1.0, steps)
            across, down = self._dot(
                x[k] + part * (x[k + 1] - x[k]), y[k] + part * (y[k + 1] - y[k])
            )
            inside = (across >= 0) & (across < 2 * self.bits.shape[1])
            inside &= (down >= 0) & (down < 4 * self.bits.shape[0])
            for i, j in zip(down[inside], across[inside], strict=True):
                self.bits[i // 4, j // 2] |= _DOTS[i % 4][j % 2]

    def text(self, x: float, y: float, text: str) -> None:
        """Write a text with its middle there."""
        across, down = self._dot(np.array(x), np.array(y))
        self.texts.append((int(down) // 4, int(across) // 2 - (len(text) - 1) // 2, text))

    def __str__(self) -> str:
        rows = [[chr(0x2800 + bits) if bits else " " for bits in row] for row in self.bits]
        for row, column, text in self.texts:
            first = max(0, min(column, len(rows[row]) - len(text)))
            rows[row][first : first + len(text)] = text[: len(rows[row])]
        drawn = ["".join(row).rstrip() for row in rows]
        while drawn and not drawn[-1]:
            drawn.pop()
        while drawn and not drawn[0]:
            drawn.pop(0)
        return "\n".join(drawn)


def bearing_in_text(bearing: Bearing) -> str:
    """Return the cross-section of a bearing, load down, to scale but for the magnified film."""
    from ..film.mesh import groove_edges, mid_thickness  # loads compiled code

    radius = bearing.journal_radius
    pads = max((pad.thickness for pad in bearing.pads), default=0.0) / radius
    outside = 1.0 + _FILM * (4.4 if bearing.pockets else 2.4) + pads
    canvas = _Canvas((-outside - 0.6, -outside), (outside + 0.6, outside), 46)
    magnified = _FILM / bearing.radial_clearance

    def arc(radial: Array, angle: Array) -> None:
        canvas.line(radial * np.sin(angle), -radial * np.cos(angle))

    turn = np.linspace(0.0, 2.0 * math.pi, 181)
    arc(np.ones(181), turn)
    for number, pad in enumerate(bearing.pads, 1):
        angle = np.linspace(pad.leading_edge, pad.trailing_edge, 41)
        # A pad's face is an arc of its own clearance, its middle moved by the preload.
        clearance = bearing.clearance_of(pad)
        lowered = bearing.preload_of(pad) * clearance * np.cos(angle - pad.pivot_angle)
        face = 1.0 + magnified * (clearance - lowered)
        back = np.full(41, 1.0 + _FILM + pad.thickness / radius)
        arc(face, angle)
        arc(back, angle)
        for end in (0, -1):
            arc(np.array([face[end], back[end]]), angle[[end, end]])
        beyond = back[0] + 0.09
        canvas.text(
            beyond * math.sin(pad.pivot_angle), -beyond * math.cos(pad.pivot_angle), str(number)
        )
    if not bearing.pads:
        angle = np.linspace(0.0, 2.0 * math.pi, 721)
        arc(1.0 + magnified * mid_thickness(bearing, angle, (0.0, 0.0)), angle)
        for pocket in bearing.pockets:
            angle = np.linspace(pocket.start, pocket.end, 91)
            last = pocket.depth if pocket.depth_at_end is None else pocket.depth_at_end
            deepest = 2.0 * bearing.radial_clearance  # as drawn
            depth = np.minimum(np.linspace(pocket.depth, last, 91), deepest)
            bore = 1.0 + magnified * mid_thickness(bearing, angle, (0.0, 0.0))
            arc(bore + magnified * depth, angle)
            for end in (0, -1):
                arc(np.array([bore[end], bore[end] + magnified * depth[end]]), angle[[end, end]])
        for groove in bearing.grooves:
            ends = np.array(groove_edges(groove))
            edge = np.linspace(ends[0], ends[1], 31)
            arc(np.full(31, 1.0 + 2.2 * _FILM), edge)
            for end in ends:
                arc(np.array([1.0 + _FILM, 1.0 + 2.2 * _FILM]), np.array([end, end]))
    canvas.line([0.0, 0.0], [0.0, -0.6])
    canvas.line([-0.09, 0.0, 0.09], [-0.48, -0.6, -0.48])
    canvas.text(0.0, 0.12, "load")
    sweep = np.linspace(0.9, 2.2, 20)  # with the rotation: from down over the right
    arc(np.full(20, 0.72), sweep)
    tip = np.array([0.72 * math.sin(2.2), -0.72 * math.cos(2.2)])
    for way in (2.2 + 2.6, 2.2 + 3.7):
        canvas.line(
            [tip[0], tip[0] + 0.13 * math.cos(way)], [tip[1], tip[1] + 0.13 * math.sin(way)]
        )
    return str(canvas)


def rotor_in_text(machine: MachineFile) -> str:
    """Return the rotor of a machine from the side: sections and discs to scale, supports named."""
    beam = machine.rotor.beam
    discs = [(disc, *beam.disc_size(disc)) for disc in beam.discs if disc.has_size]
    top = max(section.outer_diameter for section in beam.sections) / 2.0
    top = max([top, *(size for _, size, _ in discs)])
    margin, step = 0.03 * beam.length, 2.0 * beam.length / 70.0
    canvas = _Canvas((-margin, -top - 2.5 * step), (beam.length + margin, top + step / 2.0), 74)
    for section in beam.sections:
        ends = np.array(beam.span(section))
        _, outer = beam.at(ends, section)
        canvas.line(
            [ends[0], ends[0], ends[1], ends[1], ends[0]],
            [-outer[0], outer[0], outer[1], -outer[1], -outer[0]],
        )
    for disc, size, width in discs:
        left, right = disc.at - width / 2.0, disc.at + width / 2.0
        shaft = beam.outer_radius(disc.at)
        for side in (-1.0, 1.0):
            canvas.line(
                [left, left, right, right], [side * shaft, side * size, side * size, side * shaft]
            )
    for name, entry in zip(machine.support_names, machine.support, strict=True):
        low = -beam.outer_radius(entry.at)
        canvas.line(
            [entry.at, entry.at - step / 2.0, entry.at + step / 2.0, entry.at],
            [low, low - step, low - step, low],
        )
        canvas.text(entry.at, low - 2.0 * step, name)
    return str(canvas)
