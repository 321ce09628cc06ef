"""Time of a thermal point against its unknowns, and against passes over its arrays.

    python benchmarks/scaling.py [--plot FILE.png] [--finest 8]

Cold starts at Dal's case (c = 100 µm, 15 000 rpm), meshes from 24 x 78 x 12 up by factors of two in
every direction. Prints iterations, seconds, the exponent of time against unknowns between meshes
and overall, and for the pressure solve, the energy march and the bush solve how many times the time
of one pass (read and write) over the arrays that they touch each takes.
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from rotorsim.film.banded import factor_operator
from rotorsim.film.bush import _bush_operator
from rotorsim.film.energy import WallTemperatures, march
from rotorsim.film.heat import energy_problem
from rotorsim.film.solution import FilmSolution, solve_film
from rotorsim.model import (
    Bearing,
    Case,
    EccentricityTarget,
    ExponentialViscosity,
    FilmSettings,
    Lubricant,
    MeshSize,
    ThermalSettings,
)

SPEED = 15000.0 * math.pi / 30.0


def case(factor: float) -> Case:
    """Dal's bearing on 78 x 24 x 12 cells times `factor` in every direction."""
    mesh = MeshSize(
        int(78 * factor), int(24 * factor), int(12 * min(factor, 4)), int(12 * min(factor, 4))
    )
    return Case(
        bearing=Bearing(0.05, 0.08, 1e-4),
        lubricant=Lubricant(ExponentialViscosity(0.0277, 313.15, 0.034), 860.0, 2000.0, 0.13),
        film=FilmSettings(mesh=mesh),
        thermal=ThermalSettings(),
        target=EccentricityTarget(0.5),
    )


def median_time(action: Callable[[], object], repeats: int) -> float:
    """Median seconds of `repeats` calls."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def pass_time(size: int, repeats: int = 5) -> float:
    """Seconds to read one array of `size` numbers and write another."""
    source, target = np.ones(size), np.empty(size)
    return median_time(lambda: np.copyto(target, source), repeats)


def parts(solution: FilmSolution, repeats: int) -> dict[str, tuple[float, float]]:
    """Seconds of the three solves at the solution, and of a pass over what each touches."""
    problem, state, thermal = solution.problem, solution.state, solution.thermal
    assert thermal is not None
    n, m = problem.mesh.shape
    k = problem.settings.mesh.cross_film
    energy = energy_problem(problem, state)
    walls = WallTemperatures(thermal.heat.bush, thermal.heat.shaft)
    field = thermal.heat.temperature.copy()
    right = np.ones((n, m))

    def pressure() -> object:
        return factor_operator(state.operator, state.solution.full).solve(right)

    def heat() -> object:
        return march(energy, thermal.viscosity, walls, thermal.inlet_temperature, field,
                     leaving=thermal.leaving_temperature)  # fmt: skip

    bush = _bush_operator(
        problem.mesh.theta_faces, problem.mesh.y_faces, (0.05, 0.075), k, 250.0,
        outer_transfer=80.0, end_transfer=(0.0, 80.0),
    )  # fmt: skip
    columns = int(state.solution.full.any(axis=1).sum())
    return {
        # the band that Cholesky's method reads and writes
        "pressure": (median_time(pressure, repeats), pass_time(columns * m * (m + 1))),
        # two shares, viscosity, temperature and two leaving temperatures
        "march": (median_time(heat, repeats), pass_time(6 * n * m * k)),
        # two square matrices of modes, and the fields between them
        "bush": (
            median_time(lambda: bush.robin_rise(right, 1e3), repeats),
            pass_time(2 * n * n + 2 * m * m + 6 * n * m),
        ),
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plot", type=Path)
    parser.add_argument("--finest", type=int, default=8)
    options = parser.parse_args()
    factors = [f for f in (1, 2, 4, 8) if f <= options.finest]
    unknowns, seconds = [], []
    solve_film(case(1), SPEED)
    print("cells (whole film)    unknowns  iterations   seconds  exponent   force N")
    rows = []
    for factor in factors:
        repeats = 5 if factor <= 2 else 2 if factor == 4 else 1
        size = case(factor).film.mesh
        solution = solve_film(case(factor), SPEED)
        taken = median_time(lambda f=factor: solve_film(case(f), SPEED), repeats)
        unknowns.append(size.circumferential * size.axial // 2 * size.cross_film)
        seconds.append(taken)
        exponent = math.nan
        if len(seconds) > 1:
            exponent = math.log(seconds[-1] / seconds[-2]) / math.log(unknowns[-1] / unknowns[-2])
        name = f"{size.axial} x {size.circumferential} x {size.cross_film}"
        force = float(np.hypot(*solution.state.force))
        print(f"{name:18}{unknowns[-1]:12d}{solution.iterations:12d}{taken:10.3f}"
              f"{exponent:10.2f}{force:10.1f}", flush=True)  # fmt: skip
        rows.append((name, parts(solution, max(repeats, 3))))
    overall = math.log(seconds[-1] / seconds[0]) / math.log(unknowns[-1] / unknowns[0])
    print(f"overall exponent {overall:.3f}\n")
    print("times of one pass over the arrays touched")
    for name, found in rows:
        cells = [f"{part} {t * 1e3:.3g} ms = {t / p:.1f} passes" for part, (t, p) in found.items()]
        print(f"{name:18}" + ",  ".join(cells))
    if options.plot:
        plot(options.plot, unknowns, seconds, overall)


def plot(path: Path, unknowns: list[int], seconds: list[float], overall: float) -> None:
    """Time against unknowns."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.5, 3.6), layout="constrained")
    axes = figure.subplots()
    axes.loglog(unknowns, seconds, "ko-", label=f"cold THD point, exponent {overall:.2f}")
    line = [seconds[0] * (u / unknowns[0]) ** 1.1 for u in unknowns]
    axes.loglog(unknowns, line, "k--", lw=0.8, label="exponent 1.1")
    axes.set_xlabel("film temperatures solved for")
    axes.set_ylabel("time [s]")
    axes.legend()
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main()
