"""Bearing geometry: a bore made of arcs, cut by axial grooves, or of tilting pads."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..errors import InputError
from .compliance import AnyCompliance, Diaphragm
from .entries import (
    NOT_IN_FILES,
    SEVERAL,
    Angle,
    Clearance,
    Example,
    Key,
    Length,
    Number,
    Quantity,
    Slope,
    Temperature,
    check,
)
from .pads import FULL_TURN, Pad, check_order, gaps
from .restrictors import AnyRestrictor, Pump


def angle_between(theta: ArrayLike, other: float) -> Array:
    """Return the angle from `other` to `theta`, the short way round: -pi to pi [rad]."""
    return (np.asarray(theta) - other + math.pi) % FULL_TURN - math.pi


def _require(condition: bool, message: str, key: str, value: object) -> None:
    if not condition:
        raise InputError(message, key=key, value=value)


_Preload = Annotated[
    float, Number(least=0.0, below=1.0, hint="it lies from 0 to below 1, for example 0.5")
]
_Offset = Annotated[float, Number(least=0.0, most=1.0, hint="it lies from 0 to 1, for example 0.5")]


class _BearingProfile(StrEnum):
    """Usual multi-lobe bores."""

    ELLIPTICAL = "elliptical"
    THREE_LOBE = "three_lobe"
    OFFSET_HALVES = "offset_halves"


class Feed(StrEnum):
    """Way of the oil to tilting pads, and what becomes of the hot oil that arrives with it."""

    FLOODED = "flooded"
    """The housing is full: hot oil and supply mix, and the films draw what they ask for."""
    LEADING_EDGE_GROOVE = "leading_edge_groove"
    """The supply enters first, on the pad's side; hot oil makes up the rest, on the journal's."""
    SPRAY_BAR = "spray_bar"
    """Jets meet the hot oil on the journal; what the film does not take is thrown off."""


@dataclass(frozen=True)
class Groove:
    """An axial supply groove, or a recess: an opening in the bore that is full of oil.

    center : Middle of the groove, angle from the load line [rad].
    extent : Circumferential extent [rad].
    length : Axial length [m], centred; None: the bearing's whole length.
    supply_pressure : Gauge pressure held in the groove; before its restrictor if it has one [Pa].
    restrictor : Between supply and groove; None: the supply's pressure stands in the groove.
    supply_temperature : Temperature of the oil supplied [K]; None: the scenario's supply
        temperature.
    sealed_ends : Whether plugs close the ends of a groove that runs the bearing's whole length. If
        not, oil leaks over `end_land` at each end, through the clearance; the groove's pressure
        holds.
    end_land : Axial length over which the pressure falls at an end that is not sealed [m]; None: 1
        % of the bearing's length.
    """

    center: Angle
    extent: Annotated[float, Quantity("angle", "20 deg")]
    length: Length | None = None
    supply_pressure: Annotated[float, Quantity("pressure", "70 kPa", "not_negative")] = 0.0
    supply_temperature: Temperature | None = None
    sealed_ends: bool = True
    end_land: Length | None = None
    restrictor: AnyRestrictor | None = None

    def __post_init__(self) -> None:
        check(self, "groove")
        self._check_restrictor()
        _require(
            self.extent < FULL_TURN, "must be above 0 and below 360 deg", "groove.extent",
            self.extent,
        )  # fmt: skip
        _require(
            self.sealed_ends or self.length is None,
            "a groove of part of the length ends inside the film, which seals it: leave this out, "
            "or leave out the length",
            "groove.sealed_ends",
            self.sealed_ends,
        )
        _require(
            self.end_land is None or not self.sealed_ends,
            "goes with sealed_ends = false",
            "groove.end_land",
            self.end_land,
        )

    def _check_restrictor(self) -> None:
        if self.restrictor is None:
            return
        pumped = isinstance(self.restrictor, Pump)
        _require(
            pumped == (self.supply_pressure == 0.0),
            "a pump gives its flow at any pressure: leave this out"
            if pumped
            else "must be above 0 before a restrictor",
            "groove.supply_pressure",
            self.supply_pressure,
        )
        _require(self.sealed_ends, "must be true behind a restrictor", "groove.sealed_ends", False)


@dataclass(frozen=True)
class Pocket:
    """A part of the bore that is deeper: pressure dam, relief track, Rayleigh step, taper, pocket.

    Where pockets overlap the deepest counts.

    start, end : Angles from the load line [rad], `end` ahead of `start`; a full turn at most.
    depth : At its start, in its middle plane [m].
    depth_at_end : At its end, straight between [m]; None: as at its start.
    length : Axial length [m]; None: the bearing's.
    at : Its middle plane, from the bearing's along the rotation vector [m].
    depth_at_edge : At its axial edges, straight from the middle plane [m]; None: no axial taper.
    """

    start: Annotated[Angle, Example("10 deg")]
    end: Angle
    depth: Annotated[float, Quantity("length", "60 um", "not_negative")]
    depth_at_end: Annotated[float | None, Quantity("length", "60 um", "not_negative")] = None
    length: Length | None = None
    at: Annotated[float, Quantity("length", "0 mm", "any")] = 0.0
    depth_at_edge: Annotated[float | None, Quantity("length", "60 um", "not_negative")] = None

    def __post_init__(self) -> None:
        check(self, "pocket")
        _require(
            1e-6 < self.end - self.start <= FULL_TURN + 1e-9,
            "a pocket must end after it starts and span at most 360 deg",
            "pocket.end",
            self.end,
        )

    @property
    def is_ring(self) -> bool:
        """Return whether it runs all the way round."""
        return self.end - self.start > FULL_TURN - 1e-6

    def reach(self, bearing_length: float) -> tuple[float, float]:
        """Return the axial edges [m], from the bearing's mid-plane."""
        half = 0.5 * (bearing_length if self.length is None else self.length)
        return max(self.at - half, -0.5 * bearing_length), min(self.at + half, 0.5 * bearing_length)

    def deepening(self, theta: Array, y: Array, bearing_length: float) -> Array:
        """Return the depth [m] at angles [rad] and axial places [m], 0 outside."""
        along = (theta - self.start) % FULL_TURN / (self.end - self.start)
        half = 0.5 * (bearing_length if self.length is None else self.length)
        aside = np.abs(y - self.at) / half
        last = self.depth if self.depth_at_end is None else self.depth_at_end
        depth = self.depth + (last - self.depth) * along
        if self.depth_at_edge is not None:
            depth = depth + (self.depth_at_edge - self.depth) * aside
        inside = ((along < 1.0) | self.is_ring) & (aside <= 1.0 + 1e-12)
        return np.where(inside, np.maximum(depth, 0.0), 0.0)


@dataclass(frozen=True)
class Texture:
    """Equal dimples in rows over a part of the bore, each a pocket that the mesh resolves.

    start, end : Angles from the load line [rad].
    depth : Of each dimple [m].
    around, along : Dimples around and along the axis.
    area_share : Part of the textured area that the dimples take, 0 to 1.
    length : Axial length of the textured part [m], centred; None: the bearing's.
    """

    start: Annotated[Angle, Example("10 deg")]
    end: Angle
    depth: Annotated[float, Quantity("length", "10 um")]
    around: Annotated[int, Number(least=1, most=200)]
    along: Annotated[int, Number(least=1, most=100)]
    area_share: Annotated[float, Number(above=0.0, below=1.0)] = 0.25
    length: Length | None = None

    def __post_init__(self) -> None:
        check(self, "texture")
        _require(
            1e-6 < self.end - self.start <= FULL_TURN + 1e-9,
            "a texture must end after it starts and span at most 360 deg",
            "texture.end",
            self.end,
        )

    def dimples(self, bearing_length: float) -> Iterator[Pocket]:
        """Return every dimple, in the middle of its own share of the area."""
        length = bearing_length if self.length is None else self.length
        pitch, row = (self.end - self.start) / self.around, length / self.along
        side = math.sqrt(self.area_share)
        for i in range(self.around):
            middle = self.start + (i + 0.5) * pitch
            half = 0.5 * side * pitch
            for j in range(self.along):
                at = (j + 0.5) * row - 0.5 * length
                yield Pocket(
                    middle - half, middle + half, self.depth, length=side * row,
                    at=at if abs(at) > 1e-9 * length else 0.0,
                )  # fmt: skip


@dataclass(frozen=True)
class Arc:
    """One lobe of a multi-lobe bore.

    The lobe's centre of curvature is displaced from the bearing's centre so that, with the journal
    centred, the film is thinnest, ``(1 - preload) * radial_clearance``, at the angle
    ``start + offset * (end - start)``.

    start, end : Ends of the lobe, angles from the load line [rad], ``end > start``.
    preload : 0 (concentric lobe) to below 1.
    offset : Where along the arc the lobe comes nearest, 0 to 1; 0.5 for a symmetric lobe.
    """

    start: Annotated[Angle, Example("-90 deg")]
    end: Angle
    preload: _Preload = 0.0
    offset: _Offset = 0.5

    def __post_init__(self) -> None:
        check(self, "arc")
        _require(
            0.0 < self.end - self.start <= FULL_TURN + 1e-12,
            "an arc must end after it starts and span at most 360 deg",
            "arc.end",
            self.end,
        )

    @property
    def preload_angle(self) -> float:
        """Angle at which the lobe comes nearest to a centred journal [rad]."""
        return self.start + self.offset * (self.end - self.start)


def _profile_arcs(
    profile: _BearingProfile, preload: float, offset: float | None
) -> tuple[Arc, ...]:
    """Return the arcs of a usual bore, angles from the load line.

    Two lobes are centred on the load line and opposite it, the split at 90 and 270 deg; three lobes
    with the first centred on the load line. `offset` is 0.5, for offset halves 1.0: each half
    comes nearest where it ends, in the direction of rotation.
    """
    lobes = 3 if profile is _BearingProfile.THREE_LOBE else 2
    usual = 1.0 if profile is _BearingProfile.OFFSET_HALVES else 0.5
    span = FULL_TURN / lobes
    return tuple(
        Arc(
            start=(lobe - 0.5) * span,
            end=(lobe + 0.5) * span,
            preload=preload,
            offset=usual if offset is None else offset,
        )
        for lobe in range(lobes)
    )


@dataclass(frozen=True)
class Bearing:
    """A hydrodynamic journal bearing.

    journal_radius, length, radial_clearance : [m]. For a multi-lobe bore the clearance is the
        lobes' own (machined) clearance: lobe radius minus journal radius.
    arcs : Empty: those of `profile`; without one, one concentric 360 degree bore.
    bush_outer_radius : [m]; needed for bush conduction only.
    misalignment : Slope of the journal's axis against the bearing's in the x-y and y planes,
        d(e_x)/dy and d(e_y)/dy [rad], y axial from the mid-plane.
    roughness : Combined surface roughness [m]; a film thinner than this is reported. 0: not
        checked.
    pads : Tilting pads in place of a bore, in the direction of rotation. The openings between them
        are the grooves: one before each pad, at ambient pressure unless `grooves` gives them.
    feed : Of tilting pads.
    supply_flow : Of oil to all tilting pads together, in equal parts [m3/s]; None: what the films
        ask for.
    compliance : How the bore gives way under the film's pressure; None: it keeps its shape.
    profile : Shorthand for the arcs of a usual bore, with its `preload` and `offset`.
    """

    journal_radius: Length
    length: Annotated[Length, Example("80 mm")]
    radial_clearance: Annotated[Clearance, SEVERAL]
    grooves: Annotated[tuple[Groove, ...], Key("groove")] = ()
    arcs: Annotated[tuple[Arc, ...], Key("arc")] = ()
    bush_outer_radius: Length | None = None
    misalignment: Annotated[tuple[Slope, Slope], Key("tilt")] = (0.0, 0.0)
    roughness: Annotated[float, Quantity("length", "1 um", "not_negative")] = 0.0
    pads: Annotated[tuple[Pad, ...], NOT_IN_FILES] = ()
    feed: Annotated[Feed, NOT_IN_FILES] = Feed.FLOODED
    supply_flow: Annotated[float | None, NOT_IN_FILES] = None
    pockets: Annotated[tuple[Pocket, ...], Key("pocket")] = ()
    textures: Annotated[tuple[Texture, ...], Key("texture")] = ()
    compliance: AnyCompliance | None = None
    profile: _BearingProfile | None = field(default=None, compare=False)
    preload: _Preload | None = field(default=None, compare=False)
    offset: _Offset | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        check(self, "bearing")
        self._place_pads()
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
        for groove in self.grooves:
            _require(
                groove.length is None or groove.length <= self.length * (1.0 + 1e-12),
                f"must not be longer than the bearing ({self.length * 1e3:g} mm)",
                f"bearing.groove[{self.grooves.index(groove)}].length",
                groove.length,
            )
            hole = getattr(groove.restrictor, "diameter", 0.0)
            recess = min(groove.length or self.length, groove.extent * self.journal_radius)
            _require(
                hole <= recess, f"must fit into its recess, {recess * 1e3:.3g} mm wide",
                f"bearing.groove[{self.grooves.index(groove)}].restrictor.diameter", hole,
            )  # fmt: skip
        for place, pocket in enumerate(self.pockets):
            low, high = pocket.reach(self.length)
            _require(
                high - low > 1e-6 * self.length,
                "lies beyond the bearing's ends",
                f"bearing.pocket[{place}].at",
                pocket.at,
            )
        _require(
            not (self.hollows and self.pads), "pockets are cut into a bore, not into tilting pads",
            "bearing.pocket", len(self.pockets),
        )  # fmt: skip
        object.__setattr__(self, "arcs", self._profiled())

    def _profiled(self) -> tuple[Arc, ...]:
        """Return the arcs as given, or of the profile."""
        if self.profile is None:
            for name in ("preload", "offset"):
                _require(
                    getattr(self, name) is None,
                    'goes with bearing.profile; add profile = "elliptical", or give it to '
                    "each [[bearing.arc]]",
                    f"bearing.{name}",
                    getattr(self, name),
                )
            return self.arcs
        if self.preload is None:
            raise InputError(
                "is missing; a profile needs it, for example preload = 0.5", key="bearing.preload"
            )
        arcs = _profile_arcs(self.profile, self.preload, self.offset)
        _require(
            self.arcs in ((), arcs), "either a profile or [[bearing.arc]] tables, not both",
            "bearing.profile", str(self.profile),
        )  # fmt: skip
        return arcs

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
        """Return the machined clearance of a pad [m]."""
        return self.radial_clearance if pad.clearance is None else pad.clearance

    def preload_of(self, pad: Pad) -> float:
        """Return 1 - (assembled clearance)/(machined clearance) of a pad."""
        if pad.assembled_clearance is None:
            return pad.preload
        return 1.0 - pad.assembled_clearance / self.clearance_of(pad)

    @property
    def diameter(self) -> float:
        """Journal diameter [m]."""
        return 2.0 * self.journal_radius

    def spans_length(self, groove: Groove) -> bool:
        """Return whether `groove` runs from end to end."""
        return groove.length is None or groove.length >= self.length * (1.0 - 1e-9)

    @property
    def hollows(self) -> tuple[Pocket, ...]:
        """Pockets and the dimples of all textures."""
        dimples = (d for texture in self.textures for d in texture.dimples(self.length))
        return (*self.pockets, *dimples)

    @property
    def is_plain(self) -> bool:
        """One concentric 360 degree bore without grooves: the same seen from every angle."""
        smooth = not (self.grooves or self.pockets or self.textures)
        smooth = smooth and not isinstance(self.compliance, Diaphragm)
        return smooth and all(arc.preload == 0.0 for arc in self.arcs)

    @property
    def is_symmetric(self) -> bool:
        """Both axial halves are mirror images."""
        return self.misalignment == (0.0, 0.0) and all(p.at == 0.0 for p in self.pockets)

    def turned(self, angle: float) -> Bearing:
        """Return the same bearing with every feature moved ahead by `angle` [rad]."""
        if angle == 0.0:
            return self
        cos, sin = math.cos(angle), math.sin(angle)
        return replace(
            self,
            profile=None,
            preload=None,
            offset=None,
            grooves=tuple(replace(g, center=g.center + angle) for g in self.grooves),
            arcs=tuple(replace(a, start=a.start + angle, end=a.end + angle) for a in self.arcs),
            pockets=tuple(
                replace(p, start=p.start + angle, end=p.end + angle) for p in self.pockets
            ),
            textures=tuple(
                replace(t, start=t.start + angle, end=t.end + angle) for t in self.textures
            ),
            pads=tuple(replace(p, pivot_angle=p.pivot_angle + angle) for p in self.pads),
            compliance=replace(self.compliance, start=self.compliance.start + angle)
            if isinstance(self.compliance, Diaphragm)
            else self.compliance,
            misalignment=(
                self.misalignment[0] * cos - self.misalignment[1] * sin,
                self.misalignment[0] * sin + self.misalignment[1] * cos,
            ),
        )
