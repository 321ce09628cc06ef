"""A million-cell stability map against eigvals on a stack and python-control one by one.

Run: ``python benchmarks/stability_map.py``. The loops are timed on a sample and scaled up.
"""

from __future__ import annotations

import platform
import statistics
import time
from collections.abc import Callable

import control
import numpy as np

from rotorsim.machine.matrices import state_matrix
from rotorsim.machine.rates import growth_rate_map

POINTS, MASSES, SAMPLE, REPEATS = 1000, 1000, 2000, 5


def median_time(work: Callable[[], object]) -> float:
    times = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def coefficients() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Like a plain bearing's: 1000 speeds, masses around the threshold."""
    rng = np.random.default_rng(3)
    k = np.array([[2.2, 6.6], [-0.9, 3.0]]) * 1e8 * rng.uniform(0.5, 1.5, (POINTS, 2, 2))
    half = np.array([[2.6, 0.5], [-0.8, 1.5]]) * rng.uniform(0.5, 1.5, (POINTS, 2, 2))
    c = half @ half.transpose(0, 2, 1) * 1e5
    return k, c, np.geomspace(10.0, 1e4, MASSES)


def control_loop(systems: np.ndarray) -> np.ndarray:
    b, c, d = np.zeros((4, 2)), np.eye(2, 4), np.zeros((2, 2))
    b[2:] = np.eye(2)
    return np.array([control.ss(a, b, c, d).poles().real.max() for a in systems])


def main() -> None:
    k, c, mass = coefficients()
    cells = POINTS * MASSES
    start = time.perf_counter()
    growth_rate_map(k[:1], c[:1], mass[:1])
    first = time.perf_counter() - start
    mine = median_time(lambda: growth_rate_map(k, c, mass))
    rates = growth_rate_map(k, c, mass)

    stack = state_matrix(k[:, None], c[:, None], mass[::10])
    dense = median_time(lambda: np.linalg.eigvals(stack)) * 10.0
    values = np.linalg.eigvals(stack)
    error = np.abs(rates[:, ::10] - values.real.max(axis=-1)) / np.abs(values).max(axis=-1)

    pick = np.random.default_rng(1).choice(cells, SAMPLE, replace=False)
    sample = state_matrix(k[pick // MASSES], c[pick // MASSES], mass[pick % MASSES])
    loop = median_time(lambda: control_loop(sample)) * cells / SAMPLE
    loop_error = np.abs(control_loop(sample) - rates.ravel()[pick]) / np.abs(
        np.linalg.eigvals(sample)
    ).max(axis=-1)

    print(f"{platform.machine()}, numpy {np.__version__}, control {control.__version__}")
    print(f"{cells:,} cells; median of {REPEATS}; first call {first:.2f} s (loading the kernel)")
    print(f"{'method':<34}{'time [s]':>10}{'us/cell':>10}{'ratio':>8}{'difference':>12}")
    for name, seconds, difference in (
        ("rotorsim growth_rate_map", mine, 0.0),
        ("numpy.linalg.eigvals, stacked", dense, error.max()),
        ("loop over python-control poles", loop, loop_error.max()),
    ):
        print(
            f"{name:<34}{seconds:>10.3f}{seconds / cells * 1e6:>10.3f}{seconds / mine:>8.1f}"
            f"{difference:>12.1e}"
        )


if __name__ == "__main__":
    main()
