"""Parallel efficiency of a sweep of 200 thermal points: one worker against two.

    python benchmarks/parallel_sweep.py [--points 200]

The same scenario text with the given number of speeds is tabulated by one worker process and by
two, pools started and code compiled beforehand; efficiency is t_1/(2 t_2). The two tables must be
the same to the last bit.
"""

from __future__ import annotations

import argparse
import os
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import rotorsim as rs

SCENARIO = """
title = "Parallel sweep"
[bearing]
journal_radius = "50 mm"
length = "80 mm"
radial_clearance = "100 um"
[lubricant]
viscosity = "0.0277 Pa*s"
reference_temperature = "40 degC"
viscosity_temperature_coefficient = "0.034 / delta_degC"
density = "860 kg/m^3"
specific_heat = "2000 J/(kg*delta_degC)"
thermal_conductivity = "0.13 W/(m*delta_degC)"
[thermal]
models = ["thd"]
ambient_temperature = "40 degC"
[operating]
speed = {{ start = "{start} rpm", stop = "15000 rpm", count = {count} }}
eccentricity_ratio = 0.5
"""


def scenario(count: int, start: int = 500) -> rs.Scenario:
    """Scenario with `count` speeds."""
    return rs.Scenario.from_text(SCENARIO.format(start=start, count=count))


def timed(points: int, workers: int) -> tuple[float, np.ndarray]:
    """Seconds and the stiffnesses."""
    with TemporaryDirectory() as folder, ProcessPoolExecutor(workers) as pool:
        # no point is taken from an earlier table, not from that of the start either
        os.environ["ROTORSIM_CACHE"] = str(Path(folder) / "start")
        rs.tabulate(scenario(4 * workers), executor=pool)  # start the workers, load the code
        os.environ["ROTORSIM_CACHE"] = folder
        start = time.perf_counter()
        table = rs.tabulate(scenario(points), executor=pool)
        seconds = time.perf_counter() - start
    return seconds, table.stiffness


def main() -> None:
    """Print the efficiency."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=200)
    points = parser.parse_args().points
    one, stiffness = timed(points, 1)
    two, again = timed(points, 2)
    print(
        f"{points} points: one worker {one:.2f} s, two {two:.2f} s, efficiency {one / two / 2:.0%}"
    )
    print("same results to the last bit:", bool(np.array_equal(stiffness, again)))


if __name__ == "__main__":
    main()
