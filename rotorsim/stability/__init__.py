"""From K and C to verdicts: thresholds, maps, modes, control.

Modules are imported when first used: the closed form needs numpy alone, python-control only the
state spaces and the control design.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

_CONTENTS = {
    "map": ("StabilityMap", "stability_map"),
    "matrices": ("second_order_state_matrix", "state_matrix"),
    "rates": ("decay_rate_map", "decay_rates", "eigenvalues"),
    "rotor": ("GeneralRotor", "load_rotor"),
    "statespace": ("jeffcott_state_space", "poles", "rotor_state_space", "state_space"),
    "whirl": (
        "WhirlThreshold",
        "WhirlThresholds",
        "flexible_critical_mass",
        "rigid_threshold",
        "rigid_thresholds",
        "routh_coefficients",
    ),
}
_HOME = {name: module for module, names in _CONTENTS.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted(_HOME)
