"""Checks of a bearing's geometry: clearances, grooves, arcs, and where the journal touches.

Every function raises `InputError` with the key.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ...errors import InputError
from ...model import Bearing, MeshSize
from ...model.bearing import FULL_TURN
from ...model.pad_bearing import farthest

if TYPE_CHECKING:
    from .scenario import Scenario


_TOLERANCE = 1e-9
"""Angle below which two edges are taken for one [rad]."""
_LEAST_CELLS = 2
"""Cells that a groove, or the land between two, must at least have."""


def check_bearings(scenario: Scenario) -> None:
    """Check the bearing with each of its clearances."""
    clearances, eccentricity = scenario.radial_clearances, scenario.operating.eccentricity_ratio
    for index, clearance in enumerate(clearances):
        key = f"bearing.radial_clearance[{index}]"
        if any(math.isclose(clearance, other) for other in clearances[:index]):
            raise InputError("must hold each clearance once; remove the repeated one", key=key)
        try:
            bearing = replace(scenario.bearing, radial_clearance=clearance)
        except InputError as error:
            of_clearance = error.key == "bearing.radial_clearance"
            raise InputError(error.message, key=key if of_clearance else error.key) from None
        if bearing.roughness >= clearance:
            raise InputError("must be below the radial clearance", key="bearing.roughness")
        if bearing.pads:
            _check_pads(bearing, eccentricity)
            continue
        _check_below_one(eccentricity)
        _check_tilt(bearing, eccentricity)
    if scenario.bearing.pads:
        return
    _check_grooves(scenario.bearing, scenario.film.mesh)
    _check_arcs(scenario.bearing)
    _check_eccentricity(scenario.bearing, eccentricity)


def listed_clearance(value: float | None, scenario: Scenario, key: str) -> float:
    """Return the clearance of the scenario's list that `value` is; the first for None or NaN."""
    choices = scenario.radial_clearances
    if value is None or math.isnan(value):
        return choices[0]
    for choice in choices:
        if math.isclose(choice, value):
            return choice
    allowed = ", ".join(f'"{choice * 1e6:g} um"' for choice in choices)
    raise InputError(f"must be one of bearing.radial_clearance ({allowed})", key=key)


def _check_grooves(bearing: Bearing, mesh: MeshSize) -> None:
    """Check that grooves are apart, with film between them, and have cells enough."""
    cell = FULL_TURN / mesh.circumferential
    covered = sum(groove.extent for groove in bearing.grooves)
    if covered >= FULL_TURN - _LEAST_CELLS * cell:
        raise InputError(
            f"leave no film: together they cover {math.degrees(covered):.4g} deg of 360 deg; "
            "make them smaller or fewer",
            key="bearing.groove",
        )
    for index, groove in enumerate(bearing.grooves):
        key = f"bearing.groove[{index}]"
        _check_cells(groove.extent, mesh, f"{key}.extent", "groove")
        least = _LEAST_CELLS * bearing.length / mesh.axial
        if groove.length is not None and groove.length < least * (1.0 - _TOLERANCE):
            needed = 2 * math.ceil(_LEAST_CELLS * bearing.length / groove.length / 2.0)
            raise InputError(
                f"the mesh is too coarse for this groove: film.mesh.axial must be {needed} or "
                f"more, or the groove at least {least * 1e3:.4g} mm long",
                key=f"{key}.length",
            )
    order = sorted(range(len(bearing.grooves)), key=lambda i: bearing.grooves[i].center % FULL_TURN)
    for here, there in pairwise([*order, order[0]] if len(order) > 1 else []):
        _check_land(bearing, here, there, mesh)


def _check_land(bearing: Bearing, here: int, there: int, mesh: MeshSize) -> None:
    first, second = bearing.grooves[here], bearing.grooves[there]
    ahead = (second.center - first.center) % FULL_TURN
    land = ahead - 0.5 * (first.extent + second.extent)
    key = f"bearing.groove[{max(here, there)}].center"
    if land < -_TOLERANCE:
        raise InputError(
            f"overlaps bearing.groove[{min(here, there)}] by {-math.degrees(land):.4g} deg; "
            "move them apart or make them smaller",
            key=key,
        )
    _check_cells(land, mesh, key, f"land next to bearing.groove[{min(here, there)}]")


def _check_cells(extent: float, mesh: MeshSize, key: str, name: str) -> None:
    cells = extent * mesh.circumferential / FULL_TURN
    if cells < _LEAST_CELLS - _TOLERANCE:
        needed = math.ceil(_LEAST_CELLS * FULL_TURN / extent) if extent > _TOLERANCE else 0
        cure = f"film.mesh.circumferential must be {needed} or more" if 0 < needed <= 4096 else ""
        raise InputError(
            f"the mesh is too coarse for this {name} ({math.degrees(extent):.4g} deg, "
            f"{cells:.2g} cells; at least {_LEAST_CELLS} are needed)"
            + (f": {cure}" if cure else ": make it larger"),
            key=key,
        )


def _check_arcs(bearing: Bearing) -> None:
    """Check that arcs do not overlap, with nothing but a groove between two of them."""
    if not bearing.arcs:
        return
    order = sorted(range(len(bearing.arcs)), key=lambda i: bearing.arcs[i].start % FULL_TURN)
    for here, there in pairwise([*order, order[0]]):
        first, second = bearing.arcs[here], bearing.arcs[there]
        to_next = (second.start - first.start) % FULL_TURN
        if to_next < _TOLERANCE or to_next > FULL_TURN - _TOLERANCE:
            to_next = FULL_TURN if here == there else 0.0
        gap = to_next - (first.end - first.start)
        key = f"bearing.arc[{here}].end"
        if gap < -_TOLERANCE:
            raise InputError(
                f"overlaps bearing.arc[{there}] by {-math.degrees(gap):.4g} deg; end the one "
                "where the other starts",
                key=key,
            )
        if gap > _TOLERANCE and not _in_groove(bearing, first.end, gap):
            raise InputError(
                f"the bore is open for {math.degrees(gap):.4g} deg after this arc; let the next "
                "arc start here, or put a groove over the opening",
                key=key,
            )


def _in_groove(bearing: Bearing, start: float, extent: float) -> bool:
    """Return whether one full-length groove covers the opening."""
    for groove in bearing.grooves:
        if not bearing.spans_length(groove):
            continue
        from_edge = (start - (groove.center - 0.5 * groove.extent) + _TOLERANCE) % FULL_TURN
        if from_edge + extent <= groove.extent + 2.0 * _TOLERANCE:
            return True
    return False


def _check_tilt(bearing: Bearing, eccentricity_ratio: float | None) -> None:
    """Refuse a misalignment with which the journal touches the bore at one end for certain."""
    at_end = math.hypot(*bearing.misalignment) * 0.5 * bearing.length / bearing.radial_clearance
    if math.hypot(at_end, eccentricity_ratio or 0.0) >= 1.0:
        raise InputError(
            "the tilted journal touches the bore at the bearing's end: the tilt must stay below "
            f"{2e3 * bearing.radial_clearance / bearing.length:.4g} mrad, less what the "
            "eccentricity takes",
            key="bearing.tilt",
        )


def _reach(bearing: Bearing) -> float:
    """Return the largest eccentricity ratio within the lobes (1 for a plain bore)."""
    theta = np.linspace(0.0, FULL_TURN, 720, endpoint=False)
    bore = np.ones_like(theta)
    for arc in bearing.arcs:
        inside = (theta - arc.start) % FULL_TURN < arc.end - arc.start
        bore = np.where(inside, 1.0 - arc.preload * np.cos(theta - arc.preload_angle), bore)
    towards = np.cos(theta[:, None] - theta)  # direction of the journal, angle around the bore
    room = np.where(towards > 0.0, bore / np.where(towards > 0.0, towards, 1.0), np.inf)
    return float(room.min(axis=1).max())


def _check_below_one(eccentricity_ratio: float | None) -> None:
    """Refuse an eccentricity ratio of 1 and above, where a journal touches any bore."""
    if eccentricity_ratio is not None and not eccentricity_ratio < 1.0:
        raise InputError(
            "must be below 1 (it lies between 0 and 1, for example 0.5)",
            key="operating.eccentricity_ratio",
        )


def _check_pads(bearing: Bearing, eccentricity_ratio: float | None) -> None:
    """Refuse an eccentricity ratio at which the journal touches a pad wherever it stands."""
    if eccentricity_ratio is None:
        return
    limit = farthest(bearing) / bearing.radial_clearance
    if eccentricity_ratio >= limit:
        raise InputError(
            "the journal touches a pad in every direction: with these pads it must be below "
            f"{limit:.4g} (it counts in machined clearances)",
            key="operating.eccentricity_ratio",
        )


def _check_eccentricity(bearing: Bearing, eccentricity_ratio: float | None) -> None:
    """Refuse an eccentricity ratio at which the journal touches a lobe wherever it stands."""
    if eccentricity_ratio is None or all(arc.preload == 0.0 for arc in bearing.arcs):
        return
    limit = _reach(bearing)
    if eccentricity_ratio >= limit:
        raise InputError(
            "the journal touches a lobe in every direction: with these lobes it must be below "
            f"{limit:.4g} (it counts in lobe clearances)",
            key="operating.eccentricity_ratio",
        )
