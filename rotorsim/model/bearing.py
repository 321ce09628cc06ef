"""Bearing geometry: a bore made of arcs, cut by axial grooves, or of tilting pads."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from .pads import FULL_TURN, Pad, check_order, gaps


def angle_between(theta: ArrayLike, other: float) -> NDArray[np.float64]:
    """Angle from `other` to `theta`, the short way round: -pi to pi [rad]."""
    return (np.asarray(theta) - other + math.pi) % FULL_TURN - math.pi


def _require(condition: bool, message: str, key: str, value: object) -> None:
    if not condition:
        raise InputError(message, key=key, value=value)


@dataclass(frozen=True)
class Groove:
    """An axial supply groove.

    Parameters
    ----------
    center : float
        Middle of the groove, angle from the load line [rad].
    extent : float
        Circumferential extent [rad].
    length : float or None
        Axial length [m], centred; None: the bearing's whole length.
    supply_pressure : float
        Gauge pressure held in the groove [Pa].
    supply_temperature : float or None
        Temperature of the oil supplied [K]; None: the scenario's supply temperature.
    sealed_ends : bool
        Whether plugs close the ends of a groove that runs the bearing's whole length. If not, oil
        leaks over `end_land` at each end, through the clearance; the groove's pressure holds.
    end_land : float or None
        Axial length over which the pressure falls at an end that is not sealed [m]; None: 1 % of
        the bearing's length.
    """

    center: float
    extent: float
    length: float | None = None
    supply_pressure: float = 0.0
    supply_temperature: float | None = None
    sealed_ends: bool = True
    end_land: float | None = None

    def __post_init__(self) -> None:
        _require(math.isfinite(self.center), "must be finite", "groove.center", self.center)
        _require(
            0.0 < self.extent < FULL_TURN,
            "must be above 0 and below 360 deg",
            "groove.extent",
            self.extent,
        )
        _require(
            self.length is None or self.length > 0.0,
            "must be above 0",
            "groove.length",
            self.length,
        )
        _require(
            math.isfinite(self.supply_pressure) and self.supply_pressure >= 0.0,
            "must be 0 or more (gauge pressure)",
            "groove.supply_pressure",
            self.supply_pressure,
        )
        _require(
            self.supply_temperature is None or self.supply_temperature > 0.0,
            "must be above absolute zero",
            "groove.supply_temperature",
            self.supply_temperature,
        )
        _require(
            self.sealed_ends or self.length is None,
            "a groove of part of the length ends inside the film, which seals it: leave this out, "
            "or leave out the length",
            "groove.sealed_ends",
            self.sealed_ends,
        )
        _require(
            self.end_land is None or (not self.sealed_ends and self.end_land > 0.0),
            "must be above 0, and goes with sealed_ends = false",
            "groove.end_land",
            self.end_land,
        )


@dataclass(frozen=True)
class Arc:
    """One lobe of a multi-lobe bore.

    The lobe's centre of curvature is displaced from the bearing's centre so that, with the journal
    centred, the film is thinnest, ``(1 - preload) * radial_clearance``, at the angle
    ``start + offset * (end - start)``.

    Parameters
    ----------
    start, end : float
        Ends of the lobe, angles from the load line [rad], ``end > start``.
    preload : float
        0 (concentric lobe) to below 1.
    offset : float
        Where along the arc the lobe comes nearest, 0 to 1; 0.5 for a symmetric lobe.
    """

    start: float
    end: float
    preload: float = 0.0
    offset: float = 0.5

    def __post_init__(self) -> None:
        _require(
            0.0 < self.end - self.start <= FULL_TURN + 1e-12,
            "an arc must end after it starts and span at most 360 deg",
            "arc.end",
            self.end,
        )
        _require(0.0 <= self.preload < 1.0, "must be 0 to below 1", "arc.preload", self.preload)
        _require(0.0 <= self.offset <= 1.0, "must be 0 to 1", "arc.offset", self.offset)

    @property
    def preload_angle(self) -> float:
        """Angle at which the lobe comes nearest to a centred journal [rad]."""
        return self.start + self.offset * (self.end - self.start)


@dataclass(frozen=True)
class Bearing:
    """A hydrodynamic journal bearing.

    Parameters
    ----------
    journal_radius, length, radial_clearance : float
        [m]. For a multi-lobe bore the clearance is the lobes' own (machined) clearance: lobe radius
        minus journal radius.
    grooves : tuple of Groove
    arcs : tuple of Arc
        Empty: one concentric 360 degree bore.
    bush_outer_radius : float or None
        [m]; needed for bush conduction only.
    tilt : tuple of float
        Misalignment: slope of the journal's axis against the bearing's in the x-y and y planes,
        d(e_x)/dy and d(e_y)/dy [rad], y axial from the mid-plane.
    roughness : float
        Combined surface roughness [m]; a film thinner than this is reported. 0: not checked.
    pads : tuple of Pad
        Tilting pads in place of a bore, in the direction of rotation. The openings between them are
        the grooves: one before each pad, at ambient pressure unless `grooves` gives them.
    """

    journal_radius: float
    length: float
    radial_clearance: float
    grooves: tuple[Groove, ...] = ()
    arcs: tuple[Arc, ...] = ()
    bush_outer_radius: float | None = None
    tilt: tuple[float, float] = (0.0, 0.0)
    roughness: float = 0.0
    pads: tuple[Pad, ...] = ()

    def __post_init__(self) -> None:
        self._place_pads()
        for name in ("journal_radius", "length", "radial_clearance"):
            value = getattr(self, name)
            _require(
                math.isfinite(value) and value > 0.0, "must be above 0", f"bearing.{name}", value
            )
        _require(
            self.radial_clearance < 0.1 * self.journal_radius,
            "must be small against the journal radius (below a tenth of it)",
            "bearing.radial_clearance",
            self.radial_clearance,
        )
        if self.bush_outer_radius is not None:
            _require(
                self.bush_outer_radius > self.journal_radius + self.radial_clearance,
                "must lie outside the bore",
                "bearing.bush_outer_radius",
                self.bush_outer_radius,
            )
        _require(
            math.isfinite(self.roughness) and self.roughness >= 0.0,
            "must be 0 or more",
            "bearing.roughness",
            self.roughness,
        )

    def _place_pads(self) -> None:
        if not self.pads:
            return
        _require(not self.arcs, "tilting pads stand in place of arcs", "bearing.arcs", self.arcs)
        check_order(self.pads)
        between = gaps(self.pads)
        if not self.grooves:
            grooves = tuple(Groove(middle, extent) for middle, extent in between)
            object.__setattr__(self, "grooves", grooves)
        fits = len(self.grooves) == len(between) and all(
            abs(groove.center - middle) < 1e-9 and abs(groove.extent - extent) < 1e-9
            for groove, (middle, extent) in zip(self.grooves, between, strict=True)
        )
        _require(
            fits and all(self.spans_length(groove) for groove in self.grooves),
            "with tilting pads the grooves are the openings before each pad, over the whole length",
            "bearing.grooves",
            len(self.grooves),
        )

    def clearance_of(self, pad: Pad) -> float:
        """Machined clearance of a pad [m]."""
        return self.radial_clearance if pad.clearance is None else pad.clearance

    @property
    def diameter(self) -> float:
        """Journal diameter [m]."""
        return 2.0 * self.journal_radius

    def spans_length(self, groove: Groove) -> bool:
        """Whether `groove` runs from end to end."""
        return groove.length is None or groove.length >= self.length * (1.0 - 1e-9)

    @property
    def is_plain(self) -> bool:
        """One concentric 360 degree bore without grooves: the same seen from every angle."""
        return not self.grooves and all(arc.preload == 0.0 for arc in self.arcs)

    @property
    def is_symmetric(self) -> bool:
        """Both axial halves are mirror images."""
        return self.tilt == (0.0, 0.0)

    def turned(self, angle: float) -> Bearing:
        """The same bearing with every feature moved ahead by `angle` [rad]."""
        if angle == 0.0:
            return self
        cos, sin = math.cos(angle), math.sin(angle)
        return replace(
            self,
            grooves=tuple(replace(g, center=g.center + angle) for g in self.grooves),
            arcs=tuple(replace(a, start=a.start + angle, end=a.end + angle) for a in self.arcs),
            pads=tuple(replace(p, pivot_angle=p.pivot_angle + angle) for p in self.pads),
            tilt=(
                self.tilt[0] * cos - self.tilt[1] * sin,
                self.tilt[0] * sin + self.tilt[1] * cos,
            ),
        )
