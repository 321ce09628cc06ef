"""Cases, and points that cost nothing, for what moves operating points about."""

from __future__ import annotations

import dataclasses

import numpy as np

from rotorsim.bearing.operating_point import OperatingPoint, failed_point
from rotorsim.film.heat import HeatBalance
from rotorsim.model import (
    Bearing,
    Case,
    EccentricityTarget,
    ExponentialViscosity,
    FilmSettings,
    Lubricant,
    ThermalModel,
    ThermalSettings,
)
from rotorsim.status import SolveStatus, Stability

SPEEDS = [100.0 * (step + 1) for step in range(12)]


def make_case(clearance: float = 1e-4, model: ThermalModel = ThermalModel.THD) -> Case:
    return Case(
        bearing=Bearing(journal_radius=0.05, length=0.08, radial_clearance=clearance),
        lubricant=Lubricant(ExponentialViscosity(0.0277, 313.15, 0.034), 860.0, 2000.0, 0.13),
        film=FilmSettings(),
        thermal=ThermalSettings(model=model),
        target=EccentricityTarget(0.5),
    )


def fake_point(case: Case, speed: float, **changes: object) -> OperatingPoint:
    known = {
        "status": SolveStatus.CONVERGED,
        "message": "",
        "load": speed * case.bearing.radial_clearance,
        "stiffness": np.array([[1.0, 2.0], [3.0, speed]]),
        "stability": Stability.THRESHOLD,
        "critical_mass": 0.1 + 0.2,
        "warnings": ("one", "two"),
        "heat_balance": HeatBalance(1.0, 0.5, 0.25, 0.25),
    }
    return dataclasses.replace(failed_point(case, speed, ""), **{**known, **changes})


class FakeSolver:
    """Counts its calls and remembers what each started from."""

    def __init__(self, broken: tuple[float, ...] = ()) -> None:
        self.broken = broken
        self.calls: list[tuple[float, float, object]] = []

    def __call__(self, case, speed, *, initial=None):
        self.calls.append((case.bearing.radial_clearance, speed, initial))
        if speed in self.broken:
            raise ZeroDivisionError("no film")
        return fake_point(case, speed), speed


CASES = [make_case(1e-4), make_case(1.5e-4)]


def loads(points: list[OperatingPoint]) -> list[float]:
    return [point.load for point in points]
