"""One tilting pad seen from its pivot: its cells, its unknowns, and how far it may tilt."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Booleans
from ..model import Bearing, Pad
from .bending import pad_bending
from .geometry import PadUnknowns, pad_unknowns
from .mesh import FilmMesh


@dataclass(frozen=True)
class PadFrame:
    """One pad of a film: its cells, its unknowns, and how far it may tilt.

    clearance : Machined [m].
    arm : R + t [m].
    columns : (n,) bool array
    sine : (5, columns, 1) array. sin(theta - theta_p) at the points of `FilmGeometry.rest`.
    springs : (bends,) array. Stiffness of the shapes in which the pad bends [N/m].
    """

    pad: Pad
    clearance: float
    preload: float
    arm: float
    columns: Booleans
    unknowns: PadUnknowns
    sine: Array
    springs: Array

    def eccentricity(self, q: Array) -> tuple[float, float]:
        """Return the E_n and E_t at the mid-plane [m]."""
        cos, sin = math.cos(self.pad.pivot_angle), math.sin(self.pad.pivot_angle)
        along = q[0] * cos + q[1] * sin + self.preload * self.clearance
        if self.unknowns.pivot is not None:
            along -= q[self.unknowns.pivot]
        across = -q[0] * sin + q[1] * cos + self.arm * q[self.unknowns.tilt]
        return float(along), float(across)

    def level_tilt(self, q: Array) -> float:
        """Return the tilt [rad] at which E_t = 0."""
        return float(q[self.unknowns.tilt] - self.eccentricity(q)[1] / self.arm)

    def least_across(self, along: float) -> float:
        """Return the E_t [m] above which an isothermal pad with E_n = `along` > 0 has its root.

        The film of a pivot ahead of the middle may reach so far behind its thinnest place that the
        root lies at E_t < 0: then where the whole film would diverge.
        """
        return 0.0 if self.pad.offset >= 0.5 else -along * math.tan(self._half_beyond(along))

    def tilt_limits(self, thickness: Array, q: Array) -> tuple[float, float]:
        """Return the tilts [rad] at which leading and trailing edge would touch the journal at `q`.

        thickness : (5, columns, m) array [m]. Of the whole film there.
        """
        h = thickness[:, self.columns]
        with np.errstate(divide="ignore"):
            room = h / (self.arm * self.sine)
        ahead = np.where(self.sine < 0.0, room, -np.inf)
        behind = np.where(self.sine > 0.0, room, np.inf)
        tilt = float(q[self.unknowns.tilt])
        return tilt + float(ahead.max()), tilt + float(behind.min())

    def idle_tilt(self, limits: tuple[float, float], q: Array) -> float:
        """Return tilt [rad] at which the film diverges all over the pad.

        As far as there is room.
        """
        along = self.eccentricity(q)[0]
        edge = (1.0 if along <= 0.0 else -1.0) * self._half_beyond(along)
        low, high = limits
        wanted = self.level_tilt(q) + along * math.tan(edge) / self.arm
        return min(max(wanted, low + 0.05 * (high - low)), high - 0.05 * (high - low))

    def _half_beyond(self, along: float) -> float:
        """Return the angle from the pivot to the edge where the film would first converge [rad]."""
        pad = self.pad
        angle = (1.0 - pad.offset if along <= 0.0 else pad.offset) * pad.arc
        return min(angle, 0.45 * math.pi)


def bending_springs(bearing: Bearing, pad: Pad) -> Array:
    """Return stiffness of the shapes in which a pad bends [N/m].

    In the order of `PadUnknowns.bends`.
    """
    if pad.youngs_modulus is None:
        return np.zeros(0)
    sides = pad_bending(pad, bearing.journal_radius, bearing.length)
    return np.concatenate([side.stiffness for side in sides])


def pad_frames(bearing: Bearing, mesh: FilmMesh) -> tuple[PadFrame, ...]:
    """Return the frames of all pads of a film."""
    _, places = pad_unknowns(bearing)
    angles = np.stack([mesh.theta, mesh.theta_faces[:-1], mesh.theta_faces[1:]])[[0, 1, 2, 0, 0]]
    frames = []
    for number, (pad, unknowns) in enumerate(zip(bearing.pads, places, strict=True)):
        columns = mesh.region == number
        sine = np.sin(angles[:, columns] - pad.pivot_angle)[:, :, None]
        arm = bearing.journal_radius + pad.thickness
        frames.append(
            PadFrame(
                pad,
                bearing.clearance_of(pad),
                bearing.preload_of(pad),
                arm,
                columns,
                unknowns,
                sine,
                bending_springs(bearing, pad),
            )
        )
    return tuple(frames)
