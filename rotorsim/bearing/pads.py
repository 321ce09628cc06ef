"""Results of tilting pads, one by one."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from ..arrays import Array
from ..film.bending import pad_bending
from ..film.geometry import CENTER, pad_unknowns
from ..film.inlets import entering_temperature
from ..film.pad_frame import pad_frames
from ..film.solution import FilmSolution
from ..model import Bearing, Cavitation, Feed
from .operating_point import PadResult


def pad_results(solution: FilmSolution) -> tuple[PadResult, ...]:
    """Return the tilt, load, pressure and temperature of every pad; empty for a fixed bearing."""
    problem, state, q = solution.problem, solution.state, solution.state.displacement
    if not problem.bearing.pads:
        return ()
    results, inlet, hot = [], state.solution.inlet, problem.thermal.expansion is not None
    load = state.solution.pressure * state.operator.area * problem.mesh.multiplicity
    for number, frame in enumerate(pad_frames(problem.bearing, problem.mesh)):
        unknowns, columns = frame.unknowns, frame.columns
        hottest = entering = problem.thermal.supply_temperature
        if (thermal := solution.thermal) is not None:
            hottest = float(thermal.heat.bush[columns].max())
            entering = entering_temperature(thermal.energy, thermal.inlet_temperature, columns)
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
                inlet_temperature=entering,
                inlet_fraction=1.0 if inlet is None else float(inlet[number]),
                unloaded=unloaded,
                hot_radial_clearance=frame.clearance if hot else None,
                hot_preload=frame.preload if hot else None,
                deflection=0.0 if unloaded else _deflection(problem.bearing, number, q),
            )
        )
    return tuple(results)


def _deflection(bearing: Bearing, number: int, q: Array) -> float:
    """Return the larger deflection [m] of a pad's two edges; 0 for a rigid pad."""
    pad, bends = bearing.pads[number], pad_unknowns(bearing)[1][number].bends
    if not bends:
        return 0.0
    sides = pad_bending(pad, bearing.journal_radius, bearing.length)
    edges = [side.at(np.array(side.side)) for side in sides]
    parts = np.split(q[list(bends)], len(sides))
    return max(float(shape @ part) for shape, part in zip(edges, parts, strict=True))


def unloaded_warnings(unloaded: Collection[int]) -> tuple[str, ...]:
    """Return a sentence that names the pads without load."""
    if not unloaded:
        return ()
    return (
        f"{_named(unloaded)} unloaded: the film there cannot be balanced at positive pressure, and "
        "the pad floats or flutters; it is kept out of the equilibrium and the coefficients "
        "(preload or an offset pivot would load it)",
    )


def supply_warnings(
    bearing: Bearing, cavitation: Cavitation, pads: Sequence[PadResult], demand: Sequence[float]
) -> tuple[str, ...]:
    """Return sentences on pads that get less oil than their films take.

    demand : Of each pad's opening [m3/s].
    """
    starved = [number for number, pad in enumerate(pads) if pad.inlet_fraction < 1.0]
    if starved:
        least = min(pads[number].inlet_fraction for number in starved)
        return (
            f"{_named(starved)} starved: the oil that is supplied and carried over fills down to "
            f"{100.0 * least:.0f} % of a leading edge, and the film begins behind it",
        )
    lacking = lacking_pads(bearing, cavitation, demand)
    if not lacking:
        return ()
    return (
        f"{_named(lacking)} given less oil than the film takes; only a mass-conserving film "
        '(film.cavitation = "jfo") can starve: this one makes what is missing',
    )


def lacking_pads(
    bearing: Bearing, cavitation: Cavitation, demand: Sequence[float]
) -> tuple[int, ...]:
    """Return pads that get less oil than their films' `demand` [m3/s], in a film that splits it."""
    flow = bearing.supply_flow
    if flow is None or bearing.feed is Feed.FLOODED or cavitation is Cavitation.JFO:
        return ()
    share = flow / len(bearing.pads)
    return tuple(k for k, needed in enumerate(demand) if needed > share * (1.0 + 1e-6))


def _named(numbers: Collection[int]) -> str:
    names = ", ".join(str(number + 1) for number in sorted(numbers))
    return f"pad {names} is" if len(numbers) == 1 else f"pads {names} are"
