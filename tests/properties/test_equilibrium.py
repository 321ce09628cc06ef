"""An equilibrium that exists is found, on random bearings; where none is found, there is none."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from film_cases import VISCOSITY, isothermal_case
from tolerances import FOUND_AGAIN

from rotorsim.film.layers import isoviscous_layers
from rotorsim.film.problem import film_problem, film_state
from rotorsim.film.solution import solve_film
from rotorsim.model import Arc, Case, Groove, LoadTarget
from rotorsim.status import SolveStatus

MESH = (60, 8)
RADIUS, CLEARANCE = 0.05, 100e-6
QUARTER, THIRD = 0.5 * math.pi, 2.0 * math.pi / 3.0


@dataclass(frozen=True)
class Known:
    """A bearing whose load is what its film carries at a known position."""

    case: Case
    speed: float
    position: np.ndarray
    """[m], load frame."""


def random_case(random: np.random.Generator) -> Case:
    """A bearing of any kind; its load is replaced."""
    kind = random.choice(["plain", "one", "two", "three", "partial", "lemon", "halves", "lobes"])
    length_to_diameter, turn = random.uniform(0.3, 1.5), random.uniform(-math.pi, math.pi)
    extent, supply = math.radians(random.uniform(5.0, 40.0)), float(random.choice([0.0, 5e4, 2e5]))
    count = {"plain": 0, "one": 1, "three": 3, "lobes": 3}.get(kind, 2)
    step, preload = 2.0 * math.pi / max(count, 1), random.uniform(0.05, 0.75)
    length = random.uniform(0.3, 0.8) * 2.0 * RADIUS * length_to_diameter
    grooves = tuple(
        Groove(turn + k * step, extent, length if kind == "partial" else None, supply)
        for k in range(count)
    )
    arcs = ()
    if kind in ("lemon", "halves", "lobes"):
        offset = 1.0 if kind == "halves" else 0.5
        arcs = tuple(
            Arc(turn + k * step, turn + (k + 1) * step, preload, offset) for k in range(count)
        )
    misalignment = (0.0, 0.0)
    if random.random() < 0.25:
        size = random.uniform(0.02, 0.6) * CLEARANCE * (1.0 - (preload if arcs else 0.0))
        size /= RADIUS * length_to_diameter
        angle = random.uniform(-math.pi, math.pi)
        misalignment = (size * math.cos(angle), size * math.sin(angle))
    cavitation = str(random.choice(["reynolds", "half_sommerfeld", "jfo"]))
    inception = "max_film" if (kind, cavitation) == ("plain", "jfo") else "free"
    return isothermal_case(
        length_to_diameter=length_to_diameter,
        mesh=MESH,
        cavitation=cavitation,
        inception=inception,
        grooves=grooves,
        arcs=arcs,
        misalignment=misalignment,
    )


def known_equilibrium(seed: int) -> Known | None:
    """Place the journal somewhere; the force there is the load. None where there is no force."""
    random = np.random.default_rng(seed)
    case, speed = random_case(random), float(random.uniform(50.0, 1500.0))
    while True:
        angle, size = random.uniform(-math.pi, math.pi), random.uniform(0.05, 1.0) * CLEARANCE
        # A plain film's frame turns with the journal.
        frame = angle if case.bearing.is_plain else 0.0
        place = size * np.array([math.cos(angle - frame), math.sin(angle - frame)])
        problem = film_problem(case, speed, case.bearing.turned(-frame), tuple(place))
        if problem.geometry.thinnest_at(place) > 0.03 * CLEARANCE:
            break
    state = film_state(problem, place, isoviscous_layers(problem.mesh.shape, VISCOSITY))
    load = float(np.hypot(*state.force))
    if not load > 0.0:
        return None
    line = math.atan2(-state.force[1], -state.force[0]) + frame
    case = replace(case, bearing=case.bearing.turned(-line), target=LoadTarget(load))
    position = size * np.array([math.cos(angle - line), math.sin(angle - line)])
    return Known(case, speed, position)


@pytest.mark.parametrize("seed", range(60))
def test_a_load_that_some_position_carries_is_found(seed):
    known = known_equilibrium(seed)
    if known is None:
        pytest.skip("the film carries nothing there")
    solution = solve_film(known.case, known.speed)
    assert solution.status is SolveStatus.CONVERGED, solution.message
    cos, sin = math.cos(solution.frame), math.sin(solution.frame)
    force = np.array([[cos, -sin], [sin, cos]]) @ solution.state.force
    assert isinstance(known.case.target, LoadTarget)
    load = known.case.target.load
    assert force == pytest.approx([-load, 0.0], abs=FOUND_AGAIN * load)


def test_most_loads_are_found_where_they_were_taken_from():
    """Films of one equilibrium, by far the most: up to the mesh, graded for another position."""
    found = []
    for seed in range(20):
        known = known_equilibrium(seed)
        if known is None:
            continue
        solution = solve_film(known.case, known.speed)
        cos, sin = math.cos(solution.frame), math.sin(solution.frame)
        place = np.array([[cos, -sin], [sin, cos]]) @ solution.state.displacement
        found.append(float(np.hypot(*(place - known.position))) < 0.05 * CLEARANCE)
    assert np.mean(found) > 0.9


def test_a_zero_step_at_the_solution_is_not_the_end_of_the_range():
    """Newton's step vanishes where the force is met exactly (a lemon bore, load across it)."""
    turn = math.radians(81.15364451255324)
    grooves = tuple(Groove(s * QUARTER - turn, math.radians(20.0), None, 50e3) for s in (1, -1))
    arcs = tuple(Arc(a - turn, a - turn + math.pi, 0.2082539037869895) for a in (-QUARTER, QUARTER))
    case = isothermal_case(
        LoadTarget(3395.303974220774),
        length_to_diameter=0.6,
        mesh=(120, 16),
        viscosity=0.0277,
        inception="free",
        grooves=grooves,
        arcs=arcs,
    )
    solution = solve_film(case, 200.0 * math.pi)
    assert solution.status is SolveStatus.CONVERGED, solution.message


def test_journal_may_stand_in_the_opening_of_a_groove():
    """Offset halves loaded towards a groove: metal is 10 um away."""
    turn = math.radians(99.29662619690899)
    grooves = tuple(Groove(s * QUARTER - turn, math.radians(20.0), None, 50e3) for s in (1, -1))
    arcs = tuple(
        Arc(a - turn, a - turn + math.pi, 0.5537755391205104, 1.0) for a in (-QUARTER, QUARTER)
    )
    case = isothermal_case(
        LoadTarget(46055.571209578564),
        length_to_diameter=0.6,
        mesh=(120, 16),
        viscosity=0.0277,
        inception="free",
        grooves=grooves,
        arcs=arcs,
    )
    solution = solve_film(case, 200.0 * math.pi)
    assert solution.status is SolveStatus.CONVERGED, solution.message
    assert solution.state.min_thickness == pytest.approx(10.5e-6, abs=1e-6)


def test_a_misaligned_journal_touches_before_it_carries_a_heavy_load():
    """Along the rim of the clearance the film's force stays below the load everywhere."""
    case = isothermal_case(
        LoadTarget(40e3),
        mesh=MESH,
        inception="free",
        misalignment=(4e-4, 1e-4),
        length_to_diameter=0.8,
    )
    solution = solve_film(case, 50.0)
    assert solution.status is SolveStatus.NO_EQUILIBRIUM
    assert "comes within" in solution.message
    greatest = 0.0
    for angle in np.linspace(-math.pi, math.pi, 36, endpoint=False):
        for share in (0.5, 0.9, 0.99, 0.999):
            bearing = case.bearing.turned(-angle)
            ends = np.abs(np.array(bearing.misalignment)) * 0.5 * bearing.length
            place = np.array([share * (CLEARANCE - float(np.hypot(*ends))), 0.0])
            problem = film_problem(case, 50.0, bearing, tuple(place))
            layers = isoviscous_layers(problem.mesh.shape, VISCOSITY)
            greatest = max(greatest, float(np.hypot(*film_state(problem, place, layers).force)))
    assert greatest < 40e3
