"""Tilting-pad bearings as files describe them: what all pads share, and each pad's own."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from enum import StrEnum
from typing import Annotated, Any

from ..errors import InputError
from .bearing import Bearing, Feed, Groove
from .entries import (
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
from .pads import (
    FULL_TURN,
    Density,
    Extent,
    Inertia,
    Modulus,
    Pad,
    PadMass,
    PadPivot,
    PadPreload,
    PivotOffset,
    Poisson,
    Thickness,
    check_order,
    gaps,
)


class _PadLoad(StrEnum):
    """Direction of the load with respect to the pads."""

    BETWEEN_PADS = "between_pads"
    ON_PAD = "on_pad"


CARRY_OVER = {Feed.FLOODED: 1.0, Feed.LEADING_EDGE_GROOVE: 0.5, Feed.SPRAY_BAR: 0.5}
"""Part of the hot oil that reaches the next pad where neither `hot_oil_carry_over` nor
`supply_flow` is given, whose balance with what the film takes would tell.

Flooded gaps mix all of it in. Directed feeding keeps a part away; how much depends on its design,
and one half is no more than a middle: measured bearings should be given theirs.
"""


@dataclass(frozen=True)
class _PadEntry:
    """Entries of one pad in a file; None: as the others.

    pivot_angle : [rad]
    pitch_inertia : See `Pad`.
    radial_clearance : The pad's own machined clearance [m].
    """

    pivot_angle: Angle | None = None
    arc: Extent | None = None
    thickness: Thickness | None = None
    offset: PivotOffset | None = None
    preload: PadPreload | None = None
    assembled_clearance: Clearance | None = None
    radial_clearance: Clearance | None = None
    pivot: PadPivot | None = None
    density: Density | None = None
    mass: PadMass | None = None
    tilt_inertia: Inertia | None = None
    pitch_inertia: Inertia | None = None
    youngs_modulus: Modulus | None = None
    poisson_ratio: Poisson | None = None

    def __post_init__(self) -> None:
        check(self, "pads" if isinstance(self, _PadSet) else "pad")


@dataclass(frozen=True)
class _PadSet(_PadEntry):
    """Entries that all pads of a bearing share, and their number.

    load : Where the load points: then the first pivot stands half a pitch ahead of it, or in its
        line. In place of it, `pivot_angle` of the first pad.
    supply_pressure : In the openings between the pads, gauge [Pa].
    supply_temperature : Of the oil supplied [K].
    supply_flow : To all pads together, in equal parts [m3/s]; None: what the films ask for.
    """

    count: Annotated[int, Number(least=1, most=64)] | None = None
    load: _PadLoad | None = None
    feed: Feed = Feed.FLOODED
    supply_pressure: Annotated[float, Quantity("pressure", "20 kPa", "not_negative")] = 0.0
    supply_temperature: Temperature | None = None
    supply_flow: Annotated[float, Quantity("volume flow")] | None = None


def tilting_pad_bearing(
    journal_radius: Length,
    length: Annotated[Length, Example("80 mm")],
    radial_clearance: Annotated[Clearance, SEVERAL],
    pads: Annotated[_PadSet, Example("{ count = 5, arc = ... }")] = _PadSet(),
    pad: tuple[_PadEntry, ...] = (),
    misalignment: Annotated[tuple[Slope, Slope], Key("tilt")] = (0.0, 0.0),
    roughness: Annotated[float, Quantity("length", "1 um", "not_negative")] = 0.0,
) -> Bearing:
    """Return the bearing of a table ``[bearing]`` with ``kind = "tilting_pad"``.

    Angles count from the load where ``pads.load`` is given or neither it nor a pivot's angle.

    Raises InputError: Something is missing, given twice, or does not fit.
    """
    built = tuple(_pad(place, entry, pads) for place, entry in enumerate(_listed(pads, pad)))
    try:
        check_order(built)
    except InputError as error:
        where = "bearing.pads.arc" if not pad or pads.arc is not None else f"bearing.{error.key}"
        raise InputError(error.message, key=where) from None
    grooves = tuple(
        Groove(
            middle, extent, supply_pressure=pads.supply_pressure,
            supply_temperature=pads.supply_temperature,
        )
        for middle, extent in gaps(built)
    )  # fmt: skip
    if pads.supply_flow is not None and pads.supply_pressure > 0.0:
        raise InputError(
            "either supply_flow or supply_pressure: a flow finds its own pressure",
            key="bearing.pads.supply_flow",
        )
    return Bearing(
        journal_radius, length, radial_clearance, grooves, misalignment=misalignment,
        roughness=roughness, pads=built, feed=pads.feed, supply_flow=pads.supply_flow,
    )  # fmt: skip


def _listed(pads: _PadSet, own: tuple[_PadEntry, ...]) -> list[_PadEntry]:
    """Return the entries of the single pads, each with its pivot's angle."""
    if own and pads.count not in (None, len(own)):
        raise InputError(
            f"is {pads.count}, but there are {len(own)} [[bearing.pad]] tables; leave it out",
            key="bearing.pads.count", value=pads.count,
        )  # fmt: skip
    count = len(own) or pads.count
    if count is None:
        raise InputError(
            "is missing; write for example count = 5, or a [[bearing.pad]] table for each pad",
            key="bearing.pads.count",
        )
    listed = list(own) or [_PadEntry()] * count
    given = [entry.pivot_angle is not None for entry in listed]
    if any(given):
        if not all(given):
            place = given.index(False)
            raise InputError(
                "is missing; give it to every pad or to none",
                key=f"bearing.pad[{place}].pivot_angle",
            )
        if pads.load is not None or pads.pivot_angle is not None:
            raise InputError(
                "the pads have their own pivot_angle; remove this one",
                key="bearing.pads.load" if pads.load is not None else "bearing.pads.pivot_angle",
            )
        return listed
    if pads.load is not None and pads.pivot_angle is not None:
        raise InputError("either load or pivot_angle, not both", key="bearing.pads.load")
    pitch = FULL_TURN / count
    first = pads.pivot_angle
    if first is None:
        first = 0.0 if pads.load is _PadLoad.ON_PAD else 0.5 * pitch
    return [replace(entry, pivot_angle=first + k * pitch) for k, entry in enumerate(listed)]


_RENAMED = {"radial_clearance": "clearance"}
_EXAMPLES = {"arc": '"60 deg"', "thickness": '"20 mm"'}


def _pad(place: int, entry: _PadEntry, shared: _PadSet) -> Pad:
    given: dict[str, Any] = {}
    for field in fields(_PadEntry):
        value = getattr(entry, field.name)
        if value is None and field.name != "pivot_angle":
            value = getattr(shared, field.name)
        if value is not None:
            given[_RENAMED.get(field.name, field.name)] = value
    if entry.preload is not None and entry.assembled_clearance is None:
        given.pop("assembled_clearance", None)
    if entry.assembled_clearance is not None and entry.preload is None:
        given.pop("preload", None)
    for name, example in _EXAMPLES.items():
        if name not in given:
            raise InputError(
                f"is missing; write for example {name} = {example}", key=f"bearing.pads.{name}"
            )
    try:
        return Pad(**given)
    except InputError as error:
        name = (error.key or "pad").removeprefix("pad")
        where = f"bearing.pad[{place}]" if getattr(entry, name[1:], None) else "bearing.pads"
        raise InputError(error.message, key=where + name, value=error.value) from None


def farthest(bearing: Bearing) -> float:
    """Return largest distance from the centre that a journal between rigid pads can have [m]."""
    best = 0.0
    for step in range(720):
        angle = step * math.pi / 360.0
        rooms = [
            (1.0 - bearing.preload_of(pad))
            * bearing.clearance_of(pad)
            / math.cos(angle - pad.pivot_angle)
            for pad in bearing.pads
            if pad.pivot.is_rigid and math.cos(angle - pad.pivot_angle) > 1e-9
        ]
        best = max(best, min(rooms, default=math.inf))
    return best
