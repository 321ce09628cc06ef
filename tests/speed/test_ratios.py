"""Speed, as multiples of a fixed piece of numpy work, so that a slow machine does not matter.

The limits are about twice what was measured; they catch a change of algorithm, not a busy minute.
Both are processor times, the least of several runs taken in turn.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from rotorsim.bearing.solve import solve_case
from rotorsim.model import (
    Bearing,
    BushModel,
    Case,
    EccentricityTarget,
    ExponentialViscosity,
    FilmSettings,
    Groove,
    InletModel,
    LoadTarget,
    Lubricant,
    MeshSize,
    ShaftModel,
    ThermalModel,
    ThermalSettings,
)

OIL = Lubricant(ExponentialViscosity(0.0277, 313.15, 0.034), 860.0, 2000.0, 0.13)
SPEED = 1570.8


def work_unit() -> None:
    """About five milliseconds: exponentials and sums over an array as large as a film's."""
    field = np.linspace(0.0, 1.0, 90_000)
    for _ in range(12):
        field = np.exp(-field) + 1e-3 * field.sum()


def plain(model: str) -> Case:
    """Dal's case at the default mesh."""
    return Case(
        bearing=Bearing(0.05, 0.08, 1e-4),
        lubricant=OIL,
        film=FilmSettings(),
        thermal=ThermalSettings(model=ThermalModel(model)),
        target=EccentricityTarget(0.5),
    )


def grooved() -> Case:
    """Two grooves, a load, bush conduction: position and heat searched together."""
    quarter = math.pi / 2.0
    grooves = (Groove(quarter, 0.314), Groove(-quarter, 0.314))
    thermal = ThermalSettings(
        inlet=InletModel.MIXING, shaft=ShaftModel.INSULATED, bush=BushModel.CONDUCTION
    )
    case = replace(plain("thd"), thermal=thermal, target=LoadTarget(10e3))
    bearing = replace(case.bearing, grooves=grooves, bush_outer_radius=0.075)
    return replace(case, bearing=bearing, film=FilmSettings(mesh=MeshSize(166, 30, 20, 20)))


def least_ratio(action: Callable[[], object], rounds: int) -> float:
    """Least time of `action` over least time of the work unit."""
    action()
    mine, unit = math.inf, math.inf
    for _ in range(rounds):
        start = time.process_time()
        work_unit()
        middle = time.process_time()
        action()
        mine = min(mine, time.process_time() - middle)
        unit = min(unit, middle - start)
    return mine / unit


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "speed", "limit"),
    [
        pytest.param(plain("isothermal"), SPEED, 3.0, id="isothermal"),
        pytest.param(plain("thd"), SPEED, 30.0, id="thd"),
        pytest.param(grooved(), SPEED / 3.0, 60.0, id="grooved"),
    ],
)
def test_point_against_work_unit(benchmark, case, speed, limit):
    point, _ = solve_case(case, speed)
    assert point.converged, point.message
    benchmark.pedantic(solve_case, args=(case, speed), rounds=2)
    assert least_ratio(lambda: solve_case(case, speed), rounds=5) < limit


def test_iterations_do_not_grow_with_the_mesh():
    counts = []
    for factor in (1, 2, 4):
        mesh = MeshSize(48 * factor, 16 * factor, 8 * factor)
        case = replace(plain("thd"), film=FilmSettings(mesh=mesh))
        point, _ = solve_case(case, SPEED)
        assert point.converged
        counts.append(point.iterations)
    assert max(counts) <= min(counts) + 2
