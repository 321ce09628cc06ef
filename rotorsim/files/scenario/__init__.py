"""Scenario files: TOML with units in, frozen model objects out, every error with file and key."""

from .scenario import Scenario, load_scenario

__all__ = ["Scenario", "load_scenario"]
