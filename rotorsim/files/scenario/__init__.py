"""Scenario files: TOML with units in, frozen model objects out, every error with file and key."""

from .scenario import Scenario, load_scenario
from .settings import OrbitForce, OrbitKind, OrbitSettings, RotorKind, SpeedRamp, StabilitySettings
from .tolerances import Distribution, Spread, ToleranceSettings

__all__ = [
    "Distribution",
    "OrbitForce",
    "OrbitKind",
    "OrbitSettings",
    "RotorKind",
    "Scenario",
    "SpeedRamp",
    "Spread",
    "StabilitySettings",
    "ToleranceSettings",
    "load_scenario",
]
