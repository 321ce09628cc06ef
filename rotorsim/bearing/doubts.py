"""Doubts about coefficients from elsewhere: whether sign, axes or units are those meant here.

Everything is asked of all speeds together: a single odd point is no convention.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from .whirl import rigid_thresholds

if TYPE_CHECKING:
    from .table import CoefficientTable

_PLAUSIBLE_WHIRL = (0.1, 2.0)
"""Whirl frequency at the threshold over shaft speed; films of oil whirl at about one half."""
_PLAUSIBLE_MASS = (1e-2, 1e7)
"""Critical mass per bearing [kg]."""
_PLAUSIBLE_LOSS = (1e-2, 1e2)
"""Damping times shaft speed over stiffness, as sums of the magnitudes of all entries."""
_PLAUSIBLE_STIFFNESS = (1e-2, 1e3)
"""Stiffness times clearance over load, largest entry."""
_NOTICEABLE = 0.1
"""Of cross stiffness over all stiffness; below it, its sign may be anything."""
_CHECK = "check units and frame: "
_HERE = "here K = -dF/dx and C = -dF/dv, F the film's force on the journal"


def doubts(table: CoefficientTable) -> list[str]:
    """Return, a sentence each, what makes the coefficients look as if stated otherwise."""
    usable = table.converged
    if not usable.any():
        return []
    speed = np.broadcast_to(table.speeds, usable.shape)[usable]
    stiffness, damping = table.stiffness[usable], table.damping[usable]
    found = _signs(stiffness, damping)
    # What follows from coefficients of the wrong sign says nothing more.
    found = found or [*_axes(stiffness), *_units(stiffness, damping, speed, table)]
    return [_CHECK + words for words in found]


def _signs(stiffness: Array, damping: Array) -> list[str]:
    """Return the direct coefficients below zero at every speed."""
    below = {
        name: (direct < 0.0).all(axis=0)
        for name, direct in (
            ("stiffness", np.diagonal(stiffness, axis1=1, axis2=2)),
            ("damping", np.diagonal(damping, axis1=1, axis2=2)),
        )
    }
    both = [name for name, negative in below.items() if negative.all()]
    if both:
        signs = " and ".join({"stiffness": "K = +dF/dx", "damping": "C = +dF/dv"}[n] for n in both)
        return [
            f"direct {' and '.join(both)} below zero in both directions at every speed: no film "
            f"has that; is the sign that of {signs}, as in some handbooks? {_HERE}"
        ]
    if below["damping"].any():
        name = ("cxx", "cyy")[int(np.flatnonzero(below["damping"])[0])]
        return [f"{name} is below zero at every speed: is its sign right, or its column? {_HERE}"]
    return []


def _axes(stiffness: Array) -> list[str]:
    """Return the cross stiffness that drives the journal against the rotation at every speed."""
    drive = stiffness[:, 0, 1] - stiffness[:, 1, 0]
    if not np.all(drive < -_NOTICEABLE * np.linalg.norm(stiffness, axis=(1, 2))):
        return []
    return [
        "kxy - kyx is below zero at every speed, so the film drives the journal against the "
        "rotation; are kxy and kyx, or x and y, exchanged? y is 90 degrees ahead of x in the "
        "direction of rotation, and the first index is that of the force"
    ]


def _units(stiffness: Array, damping: Array, speed: Array, table: CoefficientTable) -> list[str]:
    """Return the quantities that are far from those of any film of oil at every speed."""
    thresholds = rigid_thresholds(stiffness, damping, speed)
    found = [
        ("whirl frequency ratio", thresholds.whirl_frequency_ratio, _PLAUSIBLE_WHIRL),
        ("critical mass per bearing [kg]", thresholds.critical_mass, _PLAUSIBLE_MASS),
    ]
    cross = np.abs(stiffness[:, 0, 1] - stiffness[:, 1, 0])
    if np.all(cross > _NOTICEABLE * np.linalg.norm(stiffness, axis=(1, 2))):
        loss = speed * np.abs(damping).sum(axis=(1, 2)) / np.abs(stiffness).sum(axis=(1, 2))
        found.append(("damping times speed over stiffness", loss, _PLAUSIBLE_LOSS))
    clearance = table.dataset["radial_clearance"]
    if "load" in table.dataset and np.all(np.isfinite(clearance.values)):
        scale = (clearance / table.dataset["load"]).transpose(*table.dataset["kxx"].dims)
        values = scale.values[table.converged] * np.abs(stiffness).max(axis=(1, 2))
        found.append(("stiffness times clearance over load", values, _PLAUSIBLE_STIFFNESS))
    return [
        f"the {words} is {known.min():.3g} to {known.max():.3g}, nowhere within {low:g} to "
        f"{high:g} as with films of oil; units stand in the header, x is along the load, and y 90 "
        "degrees ahead in the direction of rotation"
        for words, values, (low, high) in found
        for known in [values[np.isfinite(values)]]
        if known.size and np.all((known < low) | (known > high))
    ]
