"""Nonlinear whirl on the film's force map, side by side with the film solved at every step.

Run with: python benchmarks/orbit_map.py (about a minute; the map itself is solved anew).
"""

from __future__ import annotations

import math
import platform
import tempfile
import time
import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import scipy

from rotorsim.model import (
    Bearing,
    Case,
    ExponentialViscosity,
    FilmSettings,
    Inception,
    LoadTarget,
    Lubricant,
    MeshSize,
    ThermalModel,
    ThermalSettings,
)
from rotorsim.orbit import Orbit, OrbitProblem, SpeedSchedule, simulate
from rotorsim.orbit.film_force import SolvedFilmForce, loaded_film
from rotorsim.orbit.film_map import film_force_map
from rotorsim.orbit.forces import find_equilibrium
from rotorsim.rotor import Rotor

SPEED, LOAD, MASS = 12000.0 * math.pi / 30.0, 1500.0, 135.0
DIRECT_REVOLUTIONS = 20


def case() -> Case:
    """The bearing of scenarios/orbit_limit_cycle.toml on the default mesh."""
    return Case(
        Bearing(0.025, 0.025, 50e-6),
        Lubricant(ExponentialViscosity(0.02, 313.15, 0.0), 860.0, 2000.0, 0.13),
        FilmSettings(inception=Inception.FREE, mesh=MeshSize(156, 48)),
        ThermalSettings(model=ThermalModel.ISOTHERMAL),
        LoadTarget(LOAD),
    )


def solved_force() -> SolvedFilmForce:
    """The same film, solved at every call."""
    from rotorsim.film.solution import solve_film

    solution = solve_film(case(), SPEED)
    return SolvedFilmForce(solution.problem, solution.state.layers, solution.frame, case().bearing)


def timed(work: Callable[[], Orbit]) -> tuple[float, Orbit]:
    start = time.perf_counter()
    orbit = work()
    return time.perf_counter() - start, orbit


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        film_force_map(0.5, cache=Path(folder))
        solving = time.perf_counter() - start
        start = time.perf_counter()
        film = loaded_film(case(), SPEED, cache=Path(folder))
        reading = time.perf_counter() - start
    place = find_equilibrium(film.force, (LOAD, 0.0), SPEED)
    problem = OrbitProblem(
        film.force,
        Rotor.rigid(MASS),
        SpeedSchedule.constant(SPEED, DIRECT_REVOLUTIONS),
        static_load=(LOAD, 0.0),
        equilibrium=place,
        initial_displacement=(-15e-6, 0.0),
        samples_per_revolution=32,
        relative_tolerance=1e-6,
    )

    def run(revolutions: float, **changes: object) -> Orbit:
        schedule = SpeedSchedule.constant(SPEED, revolutions)
        return simulate(replace(problem, schedule=schedule, **changes))

    run(2)  # loads the compiled kernels
    direct = solved_force()
    direct.force(*place, 0.0, 0.0, SPEED)
    slow, reference = timed(lambda: run(DIRECT_REVOLUTIONS, force=direct))
    fast, mapped = min(
        (timed(lambda: run(DIRECT_REVOLUTIONS)) for _ in range(5)), key=lambda p: p[0]
    )
    apart = max(np.max(np.abs(mapped.x - reference.x)), np.max(np.abs(mapped.y - reference.y)))
    swing = 0.5 * float(np.ptp(reference.x))
    long, whirl = timed(lambda: run(1000))

    print(f"{platform.machine()}, numpy {np.__version__}, scipy {scipy.__version__}")
    print(f"map of L/D = 0.5: solved in {solving:.1f} s, read from the cache in {reading:.3f} s")
    print(f"{'film force':<28}{'revolutions':>12}{'time [s]':>10}{'rev/s':>9}{'ratio':>8}")
    rows = (
        ("solved at every step", DIRECT_REVOLUTIONS, slow),
        ("map", DIRECT_REVOLUTIONS, fast),
        ("map", 1000, long),
    )
    for name, revolutions, seconds in rows:
        rate = revolutions / seconds
        ratio = rate * slow / DIRECT_REVOLUTIONS
        print(f"{name:<28}{revolutions:>12}{seconds:>10.3f}{rate:>9.0f}{ratio:>8.0f}")
    print(f"paths after {DIRECT_REVOLUTIONS} revolutions apart by {apart / swing:.2%} of the whirl")
    print(f"1000 revolutions end as: {whirl.status.value}, {whirl.message}")
    for revolutions in (500, 1000, 2000):
        tracemalloc.start()
        simulate(
            replace(problem, schedule=SpeedSchedule.constant(SPEED, revolutions)),
            keep_revolutions=256,
        )
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        print(f"peak memory over {revolutions} revolutions, last 256 kept: {peak / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
