"""What is reported of tilting pads, one by one."""

from __future__ import annotations

from collections.abc import Collection

from ..film.geometry import CENTER
from ..film.pads import pad_frames
from ..film.solution import FilmSolution
from .operating_point import PadResult


def pad_results(solution: FilmSolution) -> tuple[PadResult, ...]:
    """Return tilt, load, pressure and temperature of every pad; empty for a fixed bearing."""
    problem, state, q = solution.problem, solution.state, solution.state.displacement
    if not problem.bearing.pads:
        return ()
    results = []
    load = state.solution.pressure * state.operator.area * problem.mesh.multiplicity
    for number, frame in enumerate(pad_frames(problem.bearing, problem.mesh)):
        unknowns, columns = frame.unknowns, frame.columns
        hottest = problem.thermal.supply_temperature
        if solution.thermal is not None:
            hottest = float(solution.thermal.heat.bush[columns].max())
        cosine = (1.0 - frame.sine[CENTER] ** 2) ** 0.5
        unloaded = number in solution.unloaded
        results.append(
            PadResult(
                tilt=float(q[unknowns.tilt]),
                pivot_displacement=float(q[unknowns.pivot]) if unknowns.pivot is not None else 0.0,
                pitch=float(q[unknowns.pitch]) if unknowns.pitch is not None else 0.0,
                load=0.0 if unloaded else float((load[columns] * cosine).sum()),
                max_pressure=float(state.solution.pressure[columns].max()),
                max_temperature=hottest,
                unloaded=unloaded,
            )
        )
    return tuple(results)


def unloaded_warnings(unloaded: Collection[int]) -> tuple[str, ...]:
    """Return a sentence that names the pads without load."""
    if not unloaded:
        return ()
    names = ", ".join(str(number + 1) for number in sorted(unloaded))
    pads = f"pad {names} is" if len(unloaded) == 1 else f"pads {names} are"
    return (
        f"{pads} unloaded: the film there cannot be balanced at positive pressure, and the pad "
        "floats or flutters; it is kept out of the equilibrium and the coefficients (preload or an "
        "offset pivot would load it)",
    )
