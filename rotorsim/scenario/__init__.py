"""Scenario files: TOML with units in, frozen model objects out, every error with file and key."""

from .scenario import Scenario, load_scenario
from .settings import OrbitForce, OrbitSettings, RotorKind, SpeedRamp, StabilitySettings

__all__ = [
    "OrbitForce",
    "OrbitSettings",
    "RotorKind",
    "Scenario",
    "SpeedRamp",
    "StabilitySettings",
    "load_scenario",
]
