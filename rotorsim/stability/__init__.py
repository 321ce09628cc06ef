"""From K and C to verdicts: thresholds, maps, modes, control, tolerances.

Modules are imported when first used: the closed form needs numpy alone, python-control only the
state spaces and the control design.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .actuator import ActuatedForce
    from .control import (
        LoopMargins,
        StateFeedback,
        design_lqr,
        design_pd,
        locus_over_damping,
        locus_over_mass,
        loop_margins,
        proportional_derivative,
        receptance,
        step_response,
        unbalance_response,
    )
    from .map import (
        StabilityMap,
        stability_map,
    )
    from .matrices import (
        second_order_state_matrix,
        state_matrix,
    )
    from .modes import (
        Branches,
        ThresholdSpeed,
        find_thresholds,
        rigid_modes,
        threshold_speeds,
        track_modes,
    )
    from .over_speed import (
        JeffcottShaft,
        RigidShaft,
        RotorOnFilm,
        rotor_modes,
        rotor_thresholds,
    )
    from .rates import (
        decay_rate_map,
        decay_rates,
        eigenvalues,
    )
    from .rotor import (
        GeneralRotor,
        load_rotor,
    )
    from .statespace import (
        jeffcott_state_space,
        poles,
        rotor_state_space,
        state_space,
    )
    from .uncertainty import (
        Propagation,
        SampleError,
        Tolerance,
        propagate,
        sample_inputs,
    )
    from .whirl import (
        WhirlThreshold,
        WhirlThresholds,
        flexible_critical_mass,
        rigid_threshold,
        rigid_thresholds,
        routh_coefficients,
    )

_HOME = {
    "ActuatedForce": "actuator",
    "LoopMargins": "control",
    "StateFeedback": "control",
    "design_lqr": "control",
    "design_pd": "control",
    "locus_over_damping": "control",
    "locus_over_mass": "control",
    "loop_margins": "control",
    "proportional_derivative": "control",
    "receptance": "control",
    "step_response": "control",
    "unbalance_response": "control",
    "StabilityMap": "map",
    "stability_map": "map",
    "second_order_state_matrix": "matrices",
    "state_matrix": "matrices",
    "Branches": "modes",
    "ThresholdSpeed": "modes",
    "find_thresholds": "modes",
    "rigid_modes": "modes",
    "threshold_speeds": "modes",
    "track_modes": "modes",
    "JeffcottShaft": "over_speed",
    "RigidShaft": "over_speed",
    "RotorOnFilm": "over_speed",
    "rotor_modes": "over_speed",
    "rotor_thresholds": "over_speed",
    "decay_rate_map": "rates",
    "decay_rates": "rates",
    "eigenvalues": "rates",
    "GeneralRotor": "rotor",
    "load_rotor": "rotor",
    "jeffcott_state_space": "statespace",
    "poles": "statespace",
    "rotor_state_space": "statespace",
    "state_space": "statespace",
    "Propagation": "uncertainty",
    "SampleError": "uncertainty",
    "Tolerance": "uncertainty",
    "propagate": "uncertainty",
    "sample_inputs": "uncertainty",
    "WhirlThreshold": "whirl",
    "WhirlThresholds": "whirl",
    "flexible_critical_mass": "whirl",
    "rigid_threshold": "whirl",
    "rigid_thresholds": "whirl",
    "routh_coefficients": "whirl",
}

__all__ = [
    "ActuatedForce",
    "Branches",
    "GeneralRotor",
    "JeffcottShaft",
    "LoopMargins",
    "Propagation",
    "RigidShaft",
    "RotorOnFilm",
    "SampleError",
    "StabilityMap",
    "StateFeedback",
    "ThresholdSpeed",
    "Tolerance",
    "WhirlThreshold",
    "WhirlThresholds",
    "decay_rate_map",
    "decay_rates",
    "design_lqr",
    "design_pd",
    "eigenvalues",
    "find_thresholds",
    "flexible_critical_mass",
    "jeffcott_state_space",
    "load_rotor",
    "locus_over_damping",
    "locus_over_mass",
    "loop_margins",
    "poles",
    "propagate",
    "proportional_derivative",
    "receptance",
    "rigid_modes",
    "rigid_threshold",
    "rigid_thresholds",
    "rotor_modes",
    "rotor_state_space",
    "rotor_thresholds",
    "routh_coefficients",
    "sample_inputs",
    "second_order_state_matrix",
    "stability_map",
    "state_matrix",
    "state_space",
    "step_response",
    "threshold_speeds",
    "track_modes",
    "unbalance_response",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)
