"""Orbits in the nonlinear film against eigenvalues, closed forms and the film solved at each step.

The part of ``make_validation.py`` that is about motion in time; run that.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import film_cases as cases
import numpy as np
from make_validation import percent, table, write

from rotorsim.bearing.solve import solve_case
from rotorsim.bearing.whirl import rigid_threshold
from rotorsim.film.layers import isoviscous_layers
from rotorsim.film.problem import film_problem, film_state
from rotorsim.model import Case, LoadTarget, MeshSize
from rotorsim.orbit import (
    Orbit,
    OrbitProblem,
    ShortBearingForce,
    SpeedSchedule,
    analyse,
    simulate,
    steady_part,
)
from rotorsim.orbit.analysis import growth_rate
from rotorsim.orbit.film_force import SolvedFilmForce, loaded_film, operating_film
from rotorsim.orbit.force_map import FilmMapForce, ForceMap
from rotorsim.orbit.forces import BearingForce, find_equilibrium, linearize_force
from rotorsim.orbit.kernels import short_bearing_impedance
from rotorsim.rotor import Rotor

SPEED, LOAD, MASS = 12000.0 * math.pi / 30.0, 1500.0, 135.0
RADIUS, CLEARANCE, VISCOSITY = 0.025, 50e-6, 0.02
PER_TURN = 32
DIRECT = "film solved at each step"


def bearing_case(mesh: tuple[int, int] = (156, 48), load: float = LOAD, **changes) -> Case:
    """Bearing of ``scenarios/orbit_limit_cycle.toml``."""
    options = {"inception": "free", "radius": RADIUS, "clearance": CLEARANCE} | changes
    return cases.isothermal_case(
        LoadTarget(load), length_to_diameter=0.5, mesh=mesh, viscosity=VISCOSITY, **options
    )


def whirl(force: BearingForce, mass: float, kick: float, turns: float, **changes) -> Orbit:
    """Let a rigid rotor go beside its place; `kick` over the clearance."""
    options = {"static_load": (LOAD, 0.0), "samples_per_revolution": PER_TURN} | changes
    return simulate(
        OrbitProblem(
            force,
            Rotor.rigid(mass),
            SpeedSchedule.constant(SPEED, turns),
            initial_displacement=(kick * CLEARANCE, 0.0),
            **options,
        )
    )


def compared(name: str, against: str, wanted: float, found: float) -> list[str]:
    """Row of the orbits' table."""
    return [name, against, f"{wanted:.5g}", f"{found:.5g}", percent(found, wanted)]


def force_map() -> None:
    """The force map against the film solved at the same place and velocity."""
    lines = []
    for eps in (0.03, 0.1, 0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.985, 0.99, 0.995):
        errors = [_map_errors(kind, eps) for kind in ("reynolds", "half_sommerfeld")]
        lines.append([f"{eps:g}", *(f"{100.0 * e.max():.3f}" for pair in errors for e in pair)])
    head = ("ε", "Reynolds %", "extrapolated %", "half-Sommerfeld %", "extrapolated %")
    write("force_map", table(head, lines))


def _map_errors(cavitation: str, eps: float) -> tuple[np.ndarray, np.ndarray]:
    """Differences from the film on one mesh, and from two extrapolated; over the force at rest."""
    place = (eps * CLEARANCE, 0.0)
    rng = np.random.default_rng(5)
    # up to that of whirl at half the shaft's speed, in all directions; at rest first
    size, angle = rng.uniform(0.0, 0.5, 40) * SPEED * place[0], rng.uniform(0.0, 2.0 * np.pi, 40)
    velocities = np.column_stack([size * np.cos(angle), size * np.sin(angle)])
    velocities[0] = 0.0
    fine, coarse = (
        _direct_forces(bearing_case(mesh, cavitation=cavitation), place, velocities)
        for mesh in ((288, 96), (144, 48))
    )
    mapped = loaded_film(bearing_case(cavitation=cavitation), SPEED).force
    found = np.array([mapped.force(*place, *velocity, SPEED) for velocity in velocities])
    load = np.hypot(*fine[0])
    exact = (4.0 * fine - coarse) / 3.0
    return np.hypot(*(found - fine).T) / load, np.hypot(*(found - exact).T) / load


def _direct_forces(film: Case, place: tuple[float, float], velocities: np.ndarray) -> np.ndarray:
    """Film solved at one place and several velocities, (n, 2)."""
    problem = film_problem(film, SPEED, film.bearing, place)
    layers = isoviscous_layers(problem.mesh.shape, VISCOSITY)
    return np.array(
        [film_state(problem, place, layers, velocity=tuple(v)).force for v in velocities]
    )


def growth_rows(
    name: str, film: Case, load: float, factors: Iterable[float], mesh: tuple[int, int]
) -> list[list[str]]:
    """Small motions in time against the eigenvalues of the coefficients on `mesh`."""
    fine = replace(film, film=replace(film.film, mesh=MeshSize(*mesh, 8, 4)))
    point, _ = solve_case(fine, SPEED)
    force = loaded_film(film, SPEED).force
    rows = []
    for factor in factors:
        mass = factor * float(point.critical_mass or math.nan)
        below = [-point.stiffness / mass, -point.damping / mass]
        values = np.linalg.eigvals(np.block([[np.zeros((2, 2)), np.eye(2)], below]))
        exact = max(values[values.imag > 0.0], key=lambda v: v.real)
        orbit = whirl(
            force, mass, 1e-4, 12.0, relative_tolerance=1e-9, static_load=(load, 0.0),
            bearing=film.bearing,
        )  # fmt: skip
        growth = growth_rate(orbit)
        assert growth is not None
        what = f"{name}, {factor:g} of the critical mass"
        rows += [
            compared(f"{what}: growth rate 1/s", "eigenvalue", exact.real, growth.rate),
            compared("its frequency rad/s", "eigenvalue", exact.imag, growth.frequency),
        ]
    return rows


def last_turns(orbit: Orbit, turns: int) -> tuple[float, float]:
    """Amplitude over the clearance and whirl ratio of some turns, too few for a verdict."""
    late = orbit.part(-turns * orbit.samples_per_revolution - 1)
    phase = np.unwrap(np.angle(late.vx + 1j * late.vy))
    ratio = (phase[-1] - phase[0]) / (late.angle[-1] - late.angle[0])
    return 0.5 * float(np.ptp(late.x)) / orbit.radial_clearance, float(ratio)


def finite_cycle(cycle: Orbit, mapped: BearingForce) -> list[list[str]]:
    """From the map's cycle on, with the film solved at each step: it must stay there."""
    film = bearing_case()
    direct = SolvedFilmForce.of(film, operating_film(film, SPEED))
    end = np.array([cycle.x[-1], cycle.y[-1], cycle.vx[-1], cycle.vy[-1]])
    exact, found = (
        last_turns(
            whirl(force, MASS, 0.0, 40.0, initial_state=end, equilibrium=(0.0, 0.0)), 8
        )
        for force in (direct, mapped)
    )  # fmt: skip
    return [
        compared("limit cycle on the map: amplitude/c", DIRECT, exact[0], found[0]),
        compared("its whirl frequency ratio", DIRECT, exact[1], found[1]),
    ]


def short_cycle() -> list[list[str]]:
    """Ocvirk's film: a map of it against the closed form itself."""
    oil = (VISCOSITY, 0.5 * RADIUS, RADIUS, CLEARANCE)
    closed = ShortBearingForce(*oil)
    splined = FilmMapForce(ForceMap.build(lambda e, a: short_bearing_impedance(e, a, 0.25)), *oil)
    load = (300.0, 0.0)
    rest = find_equilibrium(closed, load, SPEED)
    mass = rigid_threshold(*linearize_force(closed, *rest, SPEED), SPEED).critical_mass
    results = []
    for force in (closed, splined):
        orbit = whirl(force, 1.05 * float(mass or math.nan), 0.3, 400.0, static_load=load)
        found = analyse(orbit)
        ratio = found.recognition and found.recognition.whirl_frequency_ratio
        results.append((found.amplitude / CLEARANCE, float(ratio or math.nan)))
    (size, ratio), (size_found, ratio_found) = results
    return [
        compared("short film's cycle on a map of it: amplitude/c", "closed form", size, size_found),
        compared("its whirl frequency ratio", "closed form", ratio, ratio_found),
    ]


def energy(cycle: Orbit) -> list[str]:
    """What the film takes from the whirl over whole cycles, over what it turns over."""
    late = steady_part(cycle)
    assert late is not None
    late = late.part(-96 * PER_TURN)
    power = late.fx * late.vx + late.fy * late.vy
    weights = 1.0 - np.cos(2.0 * np.pi * np.arange(late.t.size) / late.t.size)
    share = float(np.sum(weights * power) / np.sum(weights * np.abs(power)))
    return [
        "film's work over the limit cycle, of the work it turns over",
        "0",
        "0",
        f"{share:.0e}",
        "",
    ]


def orbits() -> None:
    """Orbits in the nonlinear film."""
    grooved = bearing_case((64, 16), 800.0, grooves=cases.split_grooves(), inception="max_film")
    mapped = loaded_film(bearing_case(), SPEED).force
    cycle = whirl(mapped, MASS, 0.4, 300.0)
    rows = [
        *growth_rows("map", bearing_case(), LOAD, (0.6, 1.5), (256, 96)),
        *growth_rows("two grooves, solved at each step", grooved, 800.0, (0.5,), (64, 16)),
        *finite_cycle(cycle, mapped),
        *short_cycle(),
        energy(cycle),
    ]
    write("orbits", table(("what", "against", "reference", "in time", "%"), rows, words=2))
