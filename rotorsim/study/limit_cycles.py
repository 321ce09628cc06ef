"""Periodic motions of a machine over speed, and how far it may be disturbed."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ..arguments import refuse_no_machine
from ..arrays import Array
from ..files.machine import MachineFile
from ..model.machine_orbit import MachineForce, MachineOrbit
from ..orbit.continuation import Branch, follow_forced, follow_limit_cycle
from ..orbit.motion import Motion, MotionProblem
from ..orbit.orbit import OrbitStatus
from ..orbit.run import simulate_motion
from .machine_motion import motion_problem


def limit_cycles(
    machine: MachineFile, orbit: MachineOrbit | None = None, points: int = 60
) -> Branch:
    """Follow the whirl that begins where a machine's static position becomes unstable, over speed.

    machine : Its films with closed forms or maps; unbalance is left out.
    orbit : In place of the file's.
    points : Of the branch, at most.

    Raises InputError: The static position is stable at all the machine's speeds, or a film has no
        closed form.
    """
    problem, speeds = _at_lowest_speed(machine, orbit)
    return follow_limit_cycle(problem.system, problem.equilibrium, speeds, points=points)


def branch_document(branch: Branch) -> dict[str, Any]:
    """Return the periodic motions over speed as plain data (SI)."""
    return {
        "threshold": branch.threshold,
        "supercritical": branch.supercritical,
        "folds": branch.folds.tolist(),
        "message": branch.message,
        "films": list(branch.names),
        "points": [
            {"speed": float(s), "frequency": float(f), "amplitude": a.tolist(),
             "min_film": float(h), "stable": bool(stable)}
            for s, f, a, h, stable in zip(
                branch.speed, branch.frequency, branch.amplitude, branch.least_film, branch.stable,
                strict=True,
            )
        ],
    }  # fmt: skip


def forced_response(
    machine: MachineFile,
    orbit: MachineOrbit | None = None,
    *,
    turns: int = 1,
    points: int = 120,
    start: Motion | None = None,
) -> Branch:
    """Follow the periodic response to a machine's unbalance over its speeds, folds included.

    Parameters are those of `limit_cycles`; `turns` of the shaft make one period. `start`, a run
    that has become periodic (`rs.simulate`), begins a branch elsewhere than at small motions: of
    a whirl that is locked to a fraction of the speed, say.
    """
    problem, speeds = _at_lowest_speed(machine, orbit)
    system, rest = problem.system, problem.equilibrium
    if start is not None:
        system, rest = start.problem.system, start.problem.equilibrium
    return follow_forced(system, rest, speeds, turns=turns, points=points, start=start)


def _at_lowest_speed(
    machine: MachineFile, orbit: MachineOrbit | None
) -> tuple[MotionProblem, tuple[float, float]]:
    refuse_no_machine(machine)
    speeds = machine.operating.speeds
    settings = orbit or machine.orbit or MachineOrbit(force=MachineForce.SHORT)
    # as fine as the highest speed needs, at rest where the lowest lets it
    top = motion_problem(machine, replace(settings, speed=max(speeds), drive=None))
    modes = top.system.size if settings.modes is None else settings.modes
    low = replace(settings, speed=min(speeds), drive=None, modes=modes)
    return motion_problem(machine, low), (min(speeds), max(speeds))


def largest_disturbance(
    machine: MachineFile,
    orbit: MachineOrbit | None = None,
    *,
    direction: tuple[float, float] = (1.0, 0.0),
    revolutions: int = 60,
    steps: int = 8,
) -> tuple[float, float]:
    """Return the largest shift of the rotor from its static position that it survives.

    machine, orbit : See `simulate`; at constant speed. Unbalance is left out.
    direction : (float, float). Of the shift along x and y.
    revolutions : After which the motion must be below half of what it was.
    steps : Halvings of the interval.

    Returns
    -------
    returns, leaves : float
        Largest shift that was seen to die out and smallest that was not [m]; infinity where all
        up to 0.9 of the smallest clearance do.
    """
    refuse_no_machine(machine)
    settings = orbit or machine.orbit or MachineOrbit()
    problem = motion_problem(machine, replace(settings, unbalance=False, revolutions=revolutions))
    unit = np.asarray(direction, dtype=float) / float(np.hypot(*direction))
    shape = _problem_shift(problem, unit)
    films = [link for link in problem.system.links if link.film]
    low, high = 0.0, 0.9 * min(link.force.radial_clearance for link in films)

    def settles(size: float) -> bool:
        start = problem.equilibrium + size * shape
        motion = simulate_motion(replace(problem, start=start))
        if motion.status is not OrbitStatus.COMPLETED:
            return False
        rest = problem.equilibrium
        away = np.abs(motion.q - rest)[:, np.abs(shape) > 0.0].max(axis=1)
        return bool(away[-away.size // 8 :].max() < 0.5 * size)

    if settles(high):
        return high, math.inf
    for _ in range(steps):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if settles(middle) else (low, middle)
    return low, high


def _problem_shift(problem: MotionProblem, along: Array) -> Array:
    """Return unknowns (n,) of a unit shift of the journals in their films."""
    shape = np.zeros(problem.system.size)
    for link in problem.system.links:
        if link.film:
            shape[list(link.inner)] = along
    return shape
