"""Whether a coefficient table was computed for the bearing that a scenario describes."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

from ..errors import RotorsimError

if TYPE_CHECKING:
    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario

_ACCURACY_OR_CHOICE = {
    "bearing": {"radial_clearance", "roughness"},
    "film": {"mesh"},
    "thermal": {"model"},
}
"""What may differ: accuracy, limits, and what the table itself is asked for."""


def differences(scenario: Scenario, table: CoefficientTable) -> list[str]:
    """Name what differs between a scenario and the one that a table was computed from.

    Empty where nothing that matters does, or where the table does not say (one that came from
    another program).
    """
    facts = table.dataset.attrs
    text = facts.get("scenario")
    if not isinstance(text, str) or facts.get("scenario_sha256") == scenario.sha256:
        return []
    try:
        other = type(scenario).from_text(text)
    except RotorsimError:  # written by a version that knew other keys
        return []
    found = []
    for part in ("bearing", "film", "thermal"):
        skipped = _ACCURACY_OR_CHOICE[part]
        found += [
            f"{part}.{name}"
            for name in _changed(getattr(scenario, part), getattr(other, part))
            if name not in skipped
        ]
    if scenario.lubricant != other.lubricant:
        found.append("lubricant")
    if scenario.target != other.target:
        found.append("operating: load or eccentricity ratio")
    if scenario.load_direction != other.load_direction:
        found.append("operating.load_direction")
    return found


def _changed(one: Any, other: Any) -> list[str]:
    fields = [field.name for field in dataclasses.fields(one)]
    return [name for name in fields if getattr(one, name) != getattr(other, name)]
