"""Texts for films without an equilibrium: why there is none, and what to try."""

from __future__ import annotations

import math

from ..model import Bearing, Case, Inception, LoadTarget
from .equilibrium import CLEARANCE_KEPT
from .warm_start import Position

NOT_FOUND = (
    "some journal position should carry the load, but it was found on a coarse mesh only: the "
    'force has a kink nearby, or the mesh is too coarse. Try inception = "free", a finer mesh, or '
    "another load"
)


def jump(case: Case, position: Position) -> str:
    """Describe where the force jumps across the load, and what to try."""
    eps = math.hypot(*position) / case.bearing.radial_clearance
    advice = "another load or a finer mesh"
    if case.film.inception is Inception.MAX_FILM:
        advice = f'inception = "free", {advice}'
    return (
        f"no journal position carries the load: near eccentricity ratio {eps:.3g} and attitude "
        f"{math.degrees(math.atan2(position[1], position[0])):.3g} deg the film's force jumps past "
        f"it, as a stretch of film forms or vanishes there. Try {advice}"
    )


def nowhere(case: Case, carried: float) -> str:
    """Describe why nothing balances the film, which `carried` so many newtons when last tried."""
    if isinstance(case.target, LoadTarget):
        return _no_position(case, carried)
    cause = "the film breaks off, or runs dry, at attitudes between. Give the load instead"
    if any(groove.supply_pressure > 0.0 for groove in case.bearing.grooves):
        cause = (
            "the pressure of the supply outweighs what the motion makes. Give the load instead, a "
            "lower supply pressure, or a higher speed"
        )
    return (
        "at no attitude does the film carry a load along the load line at this eccentricity "
        f"ratio: {cause}"
    )


def _no_position(case: Case, carried: float) -> str:
    thinnest = CLEARANCE_KEPT * case.bearing.radial_clearance
    return (
        "no journal position within the clearance carries the load: wherever the journal goes, it "
        f"comes within {thinnest * 1e6:.3g} µm of the bore before the film balances it (the film "
        f"carries {carried:.4g} N at the last position tried). A heavier load needs more speed, "
        "viscosity or size; a groove or a joint under the load line, misalignment, or film that is "
        'kept from forming again (inception = "max_film") leaves less'
    )


def starved(bearing: Bearing) -> str:
    """Describe that no film forms, and what to try."""
    advice = "A mass-conserving film needs a supply: a groove"
    if bearing.grooves:
        advice = (
            "The oil of the grooves does not fill the bearing anywhere behind them: move a groove "
            "further ahead of the load line, or raise its supply pressure"
        )
    elif bearing.is_plain:
        advice += ', or inception = "max_film"'
    return f"no film forms: the pressure is nowhere above zero. {advice}"
