"""The film solver beside ROSS's, the same bearing and oil, in one run.

ROSS is not a dependency: give the Python of an environment that has it,

    python benchmarks/against_ross.py --ross PATH_TO_ITS_PYTHON

Two 18 degree grooves at the split, R = 50 mm, L = 80 mm, c = 100 µm, the oil of Dal's Table 1,
10 kN, 5000 rpm; 80 x 30 cells on each arc, 20 across the film and 20 through the bush. ROSS solves
a two-dimensional energy equation (averaged across the film for adiabatic walls), this program a
three-dimensional one, so the temperatures differ by what that averaging does; its laminar setting
and its zero-net-heat shaft are used. Each row is also solved on twice the mesh here, to show what
the mesh costs.
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

from rotorsim.bearing.operating_point import OperatingPoint
from rotorsim.bearing.solve import solve_case
from rotorsim.model import (
    Bearing,
    BushModel,
    Case,
    ExponentialViscosity,
    FilmSettings,
    Groove,
    Inception,
    InletModel,
    LoadTarget,
    Lubricant,
    MeshSize,
    ShaftModel,
    ThermalModel,
    ThermalSettings,
)

SPEED = 5000.0 * math.pi / 30.0
SWEEP = tuple(float(s) for s in np.linspace(2500.0, 15000.0, 10) * math.pi / 30.0)
CARRY_OVER = 0.8  # ROSS's default part of hot oil carried from groove to groove
MESH = MeshSize(circumferential=166, axial=30, cross_film=20, bush_radial=20)
FINE = MeshSize(circumferential=332, axial=60, cross_film=40, bush_radial=40)
ROWS = ("isothermal point", "THD point, adiabatic walls", "THD point, bush conduction")


def case(row: str, mesh: MeshSize = MESH) -> Case:
    """One row of the comparison."""
    degree = math.pi / 180.0
    grooves = (Groove(90 * degree, 18 * degree), Groove(270 * degree, 18 * degree))
    thermal = ThermalSettings(
        model=ThermalModel.ISOTHERMAL if "isothermal" in row else ThermalModel.THD,
        inlet=InletModel.MIXING,
        hot_oil_carry_over=CARRY_OVER,
        shaft=ShaftModel.INSULATED,
        bush=BushModel.CONDUCTION if "conduction" in row else BushModel.INSULATED,
    )
    return Case(
        bearing=Bearing(0.05, 0.08, 1e-4, grooves=grooves, bush_outer_radius=0.075),
        lubricant=Lubricant(ExponentialViscosity(0.0277, 313.15, 0.034), 860.0, 2000.0, 0.13),
        film=FilmSettings(inception=Inception.FREE, mesh=mesh),
        thermal=thermal,
        target=LoadTarget(10e3),
    )


def numbers(point: OperatingPoint) -> dict[str, float]:
    """What is printed of a point, in the load frame."""
    k, c = point.stiffness / 1e6, point.damping / 1e3
    return {
        "eps": point.eccentricity_ratio,
        "attitude": math.degrees(point.attitude_angle),
        "T_max": point.max_temperature - 273.15,
        "kxx": k[0, 0], "kxy": k[0, 1], "kyx": k[1, 0], "kyy": k[1, 1],
        "cxx": c[0, 0], "cxy": c[0, 1], "cyx": c[1, 0], "cyy": c[1, 1],
        "M_crit": point.critical_mass or math.nan,
    }  # fmt: skip


def timed(row: str, repeats: int) -> tuple[float, dict[str, float]]:
    """Median time [s] of a warm, cold-started point, and its numbers."""
    point, _ = solve_case(case(row), SPEED)
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        solve_case(case(row), SPEED)
        times.append(time.perf_counter() - start)
    return statistics.median(times), numbers(point)


def half_sweep(speeds: tuple[float, ...]) -> list[str]:
    """One worker's share of the sweep, warm-started along the speed."""
    warm, ends = None, []
    for speed in speeds:
        point, warm = solve_case(case(ROWS[2]), speed, initial=warm)
        ends.append(str(point.status))
    return ends


def sweep_time(repeats: int) -> float:
    """Ten thermal points with bush conduction on two processes [s], pool already running."""
    shares = (SWEEP[:5], SWEEP[5:])
    with ProcessPoolExecutor(2) as pool:
        list(pool.map(half_sweep, [s[:1] for s in shares]))
        times = []
        for _ in range(repeats):
            start = time.perf_counter()
            ends = [e for part in pool.map(half_sweep, shares) for e in part]
            times.append(time.perf_counter() - start)
            assert all(e == "converged" for e in ends), ends
    return statistics.median(times)


def ross_results(python: str) -> dict[str, dict[str, float]]:
    """Run the other side in its own environment."""
    script = Path(__file__).with_name("ross_side.py")
    done = subprocess.run([python, str(script)], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"ROSS failed:\n{done.stderr[-2000:]}")
    return json.loads(done.stdout.strip().splitlines()[-1])


def main() -> None:
    """Print both sides."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ross", help="python of an environment with ross-rotordynamics")
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    other = ross_results(options.ross) if options.ross else {}
    print(f"ROSS {other.get('version', 'not run')}\n")
    for row in ROWS:
        seconds, mine = timed(row, options.repeats)
        fine = numbers(solve_case(replace(case(row, FINE)), SPEED)[0])
        theirs = other.get(row)
        ratio = (
            f", ROSS {theirs['seconds']:.2f} s: {theirs['seconds'] / seconds:.0f} times"
            if theirs
            else ""
        )
        print(f"{row}: {seconds * 1e3:.1f} ms{ratio}")
        columns = ("rotorsim", "twice the mesh", "ROSS")
        print("  " + " " * 9 + "".join(f"{name:>15}" for name in columns))
        for key, value in mine.items():
            cells = [value, fine[key], theirs.get(key, math.nan) if theirs else math.nan]
            print(f"  {key:9}" + "".join(f"{cell:15.5g}" for cell in cells))
        print()
    seconds = sweep_time(min(options.repeats, 3))
    theirs = other.get("sweep")
    ratio = f", ROSS {theirs:.1f} s: {theirs / seconds:.0f} times" if theirs else ""
    print(f"10-speed THD sweep, bush conduction, two processes: {seconds:.2f} s{ratio}")


if __name__ == "__main__":
    main()
