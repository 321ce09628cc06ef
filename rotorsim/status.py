"""Status of a computation: a value that travels with the result."""

from __future__ import annotations

from enum import StrEnum


class SolveStatus(StrEnum):
    """End of an operating-point solution."""

    CONVERGED = "converged"
    NOT_CONVERGED = "not_converged"
    """The iteration limit was reached; the numbers are the last iterate."""
    NO_EQUILIBRIUM = "no_equilibrium"
    """No journal position carries the load within the clearance."""
    STARVED = "starved"
    """No film forms: the pressure is nowhere above the rupture pressure."""
    OUT_OF_RANGE = "out_of_range"
    """The iteration left the range in which the model means anything (temperature, viscosity)."""
    FAILED = "failed"
    """The solver stopped on an unexpected error; the message says which."""


class Stability(StrEnum):
    """Verdict of the rigid rotor's critical mass (Dal Eq. 22-24)."""

    THRESHOLD = "threshold"
    """Stable below the critical mass, unstable above it."""
    ALWAYS_STABLE = "always_stable"
    ALWAYS_UNSTABLE = "always_unstable"
    REVERSED_THRESHOLD = "reversed_threshold"
    """Unstable below the critical mass, stable above it: only with indefinite damping (det C < 0),
    which a user's own coefficients may have."""
