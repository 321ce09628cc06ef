"""From K and C to verdicts: thresholds, maps, modes, control.

Modules are imported when first used: the closed form needs numpy alone, python-control only the
state spaces and the control design.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .matrices import second_order_state_matrix, state_matrix
    from .whirl import (
        WhirlThreshold,
        WhirlThresholds,
        flexible_critical_mass,
        rigid_threshold,
        rigid_thresholds,
        routh_coefficients,
    )

_HOME = {
    "WhirlThreshold": "whirl",
    "WhirlThresholds": "whirl",
    "flexible_critical_mass": "whirl",
    "rigid_threshold": "whirl",
    "rigid_thresholds": "whirl",
    "routh_coefficients": "whirl",
    "second_order_state_matrix": "matrices",
    "state_matrix": "matrices",
}

__all__ = [
    "WhirlThreshold",
    "WhirlThresholds",
    "flexible_critical_mass",
    "rigid_threshold",
    "rigid_thresholds",
    "routh_coefficients",
    "second_order_state_matrix",
    "state_matrix",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)
