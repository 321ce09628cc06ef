"""Tilting pads: K and C in all degrees of freedom, their reduction, their limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from film_eigenvalues import rigid_eigenvalues
from pad_cases import (
    CLEARANCE,
    LENGTH,
    MASSLESS,
    RADIUS,
    SPEED,
    THICKNESS,
    equal_pads,
    pad_case,
)
from scipy.integrate import solve_ivp
from tolerances import COEFFICIENT_DIFFERENCES, ROUNDING, SYMMETRY

from rotorsim.bearing.dynamics import film_dynamics
from rotorsim.bearing.solve import solve_case
from rotorsim.film.geometry import film_geometry, pad_unknowns
from rotorsim.film.linearization import linearize
from rotorsim.film.pad_solution import solve_pads
from rotorsim.film.problem import film_problem, film_state
from rotorsim.model import Arc, Bearing, LoadTarget, Pad, SpherePivot, SpringPivot, ThermalSettings
from rotorsim.status import SolveStatus, Stability

LOAD = LoadTarget(4000.0)


def _solved(case):
    solution = solve_pads(case, SPEED)
    assert solution.status is SolveStatus.CONVERGED, solution.message
    return solution


def _dynamics(case):
    return film_dynamics(_solved(case), np.eye(2))


@pytest.mark.parametrize("supply_pressure", [0.0, 8e4])
@pytest.mark.parametrize("offset", [0.5, 0.6])
def test_locked_pads_equal_the_lobed_bearing(supply_pressure: float, offset: float):
    case = pad_case(equal_pads(offset=offset), LOAD, supply_pressure=supply_pressure)
    padded = film_problem(case, SPEED, case.bearing, (0.0, 0.0))
    arcs = tuple(
        Arc(pad.leading_edge, pad.trailing_edge, pad.preload, pad.offset)
        for pad in case.bearing.pads
    )
    lobed_bearing = Bearing(RADIUS, LENGTH, CLEARANCE, grooves=case.bearing.grooves, arcs=arcs)
    lobed = replace(
        padded, bearing=lobed_bearing, geometry=film_geometry(lobed_bearing, padded.mesh)
    )
    solution = _solved(case)
    position = np.array([0.4, 0.15]) * CLEARANCE
    locked = np.concatenate([position, np.zeros(solution.state.displacement.size - 2)])
    ours = film_state(padded, locked, solution.state.layers)
    theirs = film_state(lobed, position, solution.state.layers)
    np.testing.assert_allclose(ours.force[:2], theirs.force, rtol=ROUNDING)
    for mine, others in zip(linearize(ours), linearize(theirs), strict=True):
        np.testing.assert_allclose(mine[:2, :2], others, rtol=0, atol=ROUNDING * others.max())


@pytest.mark.parametrize("first_deg", [0.0, 36.0], ids=["on pad", "between pads"])
@pytest.mark.parametrize("offset", [0.5, 0.6])
def test_a_symmetric_load_leaves_no_cross_terms(first_deg: float, offset: float):
    case = pad_case(equal_pads(first_deg=first_deg, offset=offset, **MASSLESS), LOAD)
    dynamics = _dynamics(case)
    for ratio in (0.25, 1.0, 3.0):
        for matrix in dynamics.coefficients(ratio):
            largest = np.abs(np.diag(matrix)).max()
            assert np.abs([matrix[0, 1], matrix[1, 0]]).max() < SYMMETRY * largest
    # The matrices over all degrees of freedom do not show it.
    assert abs(dynamics.stiffness[0, 1]) > 1e-2 * dynamics.stiffness[0, 0]


BEARINGS = {
    "rigid": pad_case(equal_pads(), LOAD),
    "rigid, fed": pad_case(equal_pads(offset=0.6), LOAD, supply_pressure=6e4),
    "springs": pad_case(equal_pads(pivot=SpringPivot(2e8)), LOAD),
    "balls, misaligned": pad_case(
        equal_pads(pivot=SpherePivot(radius=0.05)), LOAD, misalignment=(3e-4, -5e-4)
    ),
    "four on pad, off centre": pad_case(
        equal_pads(4, first_deg=7.0, arc_deg=72.0, offset=0.55, preload=0.2), LOAD
    ),
    "thermal": pad_case(
        equal_pads(4, first_deg=45.0, arc_deg=75.0),
        LOAD,
        mesh=(64, 8),
        thinning=0.03,
        thermal=ThermalSettings(
            inlet="mixing", shaft="insulated", bush="conduction", bush_conductivity=50.0
        ),
    ),
    "mass-conserving": pad_case(equal_pads(), LOAD, cavitation="jfo"),
}


@pytest.mark.parametrize("name", BEARINGS)
def test_coefficients_are_the_derivatives_of_the_forces(name: str):
    solution = _solved(BEARINGS[name])
    problem, state = solution.problem, solution.state
    scales = problem.geometry.displacements.scales
    full = state.solution.full

    def force(q, velocity):
        moved = film_state(problem, q, state.layers, velocity=velocity, start=full)
        np.testing.assert_array_equal(moved.solution.full, full)
        return moved.force

    step = 2e-6 * scales
    rest, q = np.zeros_like(scales), state.displacement
    motions = [(d, rest) for d in np.diag(step)] + [(rest, SPEED * d) for d in np.diag(step)]
    columns = [(force(q - move, -rate) - force(q + move, rate)) / 2.0 for move, rate in motions]
    weights = (scales / CLEARANCE)[:, None]
    stiffness, damping = linearize(state)
    size = len(scales)
    by_difference = np.stack(columns, axis=1) * weights / (2e-6 * CLEARANCE)
    for ours, theirs in (
        (stiffness * weights * weights.T, by_difference[:, :size]),
        (SPEED * damping * weights * weights.T, by_difference[:, size:]),
    ):
        for row, other in zip(ours, theirs, strict=True):
            # Each force by itself: a pad's are small beside the journal's.
            scale = max(np.abs(row).max(), 1e-3 * np.abs(ours).max())
            np.testing.assert_allclose(row, other, rtol=0, atol=COEFFICIENT_DIFFERENCES * scale)


def test_damping_is_symmetric_under_the_reynolds_condition():
    _, damping = linearize(_solved(BEARINGS["balls, misaligned"]).state)
    scales = _solved(BEARINGS["balls, misaligned"]).problem.geometry.displacements.scales
    scaled = damping * scales[:, None] * scales[None, :]
    np.testing.assert_allclose(scaled, scaled.T, rtol=0, atol=1e-9 * np.abs(scaled).max())


def test_stiff_pivots_approach_rigid_ones():
    rigid, _ = solve_case(pad_case(equal_pads(), LOAD), SPEED)
    errors = []
    for stiffness in (1e11, 1e13):
        flexible, _ = solve_case(pad_case(equal_pads(pivot=SpringPivot(stiffness)), LOAD), SPEED)
        errors.append(abs(flexible.stiffness[0, 0] / rigid.stiffness[0, 0] - 1.0))
        np.testing.assert_allclose(flexible.damping, rigid.damping, rtol=40 * 1e8 / stiffness,
                                   atol=1e-6 * rigid.damping.max())  # fmt: skip
    assert errors[0] < 0.01
    assert 60.0 < errors[0] / errors[1] < 140.0, "the error falls with the compliance"


def test_heavy_pads_approach_locked_ones():
    heavy = equal_pads(mass=1e3, tilt_inertia=1e5, pitch_inertia=1.0)
    dynamics = _dynamics(pad_case(heavy, LOAD))
    stiffness, damping = dynamics.coefficients(1.0)
    np.testing.assert_allclose(stiffness, dynamics.stiffness[:2, :2], rtol=1e-3)
    np.testing.assert_allclose(damping, dynamics.damping[:2, :2], rtol=1e-3)


def test_slow_whirl_gives_the_derivative_of_the_static_force():
    case = pad_case(equal_pads(preload=0.4, first_deg=20.0), LOAD, mesh=(120, 16))
    dynamics = _dynamics(case)
    stiffness = dynamics.reduced(1e-7j * SPEED).real
    step, forces = 1e-3, []
    for sign in (1.0, -1.0):
        moved = _solved(replace(case, target=LoadTarget(LOAD.load * (1.0 + sign * step))))
        forces.append(moved.state.displacement[:2])
    moved = (forces[0] - forces[1]) / (2.0 * step * LOAD.load)
    np.testing.assert_allclose(np.linalg.solve(stiffness, [1.0, 0.0]), moved, rtol=1e-4)


@pytest.mark.slow
def test_condensed_coefficients_match_pads_driven_in_time():
    """The journal moves on a small ellipse; film and pads follow by their own equations."""
    inertia = 2e-4
    pads = equal_pads(
        3, first_deg=10.0, arc_deg=90.0, mass=0.5, tilt_inertia=inertia, pitch_inertia=1e-3
    )
    case = pad_case(pads, LOAD, mesh=(48, 8))
    solution = _solved(case)
    problem, state = solution.problem, solution.state
    loaded = [u.tilt for k, u in enumerate(pad_unknowns(case.bearing)[1])
              if k not in solution.unloaded]  # fmt: skip
    nu, size = 0.7 * SPEED, 1e-4 * CLEARANCE
    motion = np.array([1.0, 0.5j])

    def journal(t):
        turn = np.exp(1j * nu * t)
        return size * (motion * turn).real, size * (1j * nu * motion * turn).real

    def film(t, angles, rates):
        q, v = state.displacement.copy(), np.zeros(len(state.displacement))
        place, velocity = journal(t)
        q[:2] += place
        v[:2] = velocity
        q[loaded] += angles
        v[loaded] = rates
        return film_state(problem, q, state.layers, velocity=v, start=state.solution.full).force

    count = len(loaded)
    arm = RADIUS + THICKNESS

    def right(t, y):
        angles, rates = y[:count] / arm, y[count:] / arm
        moment = film(t, angles, rates)[loaded] - state.force[loaded]
        return np.concatenate([y[count:], moment / inertia * arm])

    period = 2.0 * np.pi / nu
    run = solve_ivp(
        right, (0.0, 5.0 * period), np.zeros(2 * count), method="LSODA", rtol=1e-7,
        atol=1e-7 * size, t_eval=4.0 * period + period * np.arange(64) / 64,
    )  # fmt: skip
    forces = np.array(
        [film(t, y[:count] / arm, y[count:] / arm)[:2] for t, y in zip(run.t, run.y.T, strict=True)]
    )
    amplitude = 2.0 * np.mean(forces * np.exp(-1j * nu * run.t)[:, None], axis=0)
    dynamics = film_dynamics(solution, np.eye(2))
    expected = -dynamics.reduced(1j * nu) @ (size * motion)
    np.testing.assert_allclose(amplitude, expected, rtol=1e-3)


def test_critical_mass_of_the_full_system_is_where_an_eigenvalue_crosses():
    heavy = equal_pads(preload=0.1, mass=50.0, tilt_inertia=0.01, pitch_inertia=1.0)
    case = pad_case(heavy, LoadTarget(300.0))
    point, _ = solve_case(case, SPEED)
    assert point.stability is Stability.THRESHOLD
    assert point.critical_mass is not None
    dynamics = _dynamics(case)
    for factor, sign in ((0.999, -1.0), (1.001, 1.0)):
        growth = rigid_eigenvalues(dynamics, factor * point.critical_mass).real.max()
        assert np.sign(growth) == sign
    assert point.critical_mass_synchronous != pytest.approx(point.critical_mass, rel=1e-3)


def test_an_unloaded_pad_is_named_and_kept_out():
    point, _ = solve_case(pad_case(equal_pads(4, first_deg=45.0, preload=0.0), 0.5), SPEED)
    assert point.converged
    assert [pad.unloaded for pad in point.pads] == [False, True, True, False]
    assert point.pads[1].load == 0.0
    assert any("pads 2, 3 are unloaded" in warning for warning in point.warnings)
    assert point.coefficients_full is not None
    assert point.coefficients_full.names == ("x", "y", "tilt_1", "tilt_4")


def test_loads_of_the_pads_balance_the_load():
    pads = equal_pads(5, first_deg=17.0, pivot=SpringPivot(3e8))
    point, _ = solve_case(pad_case(pads, LOAD), SPEED)
    loads = np.array([pad.load for pad in point.pads])
    angles = np.array([pad.pivot_angle for pad in pads])
    carried = np.array([loads @ np.cos(angles), loads @ np.sin(angles)])
    np.testing.assert_allclose(carried, [LOAD.load, 0.0], rtol=0, atol=1e-8 * LOAD.load)
    deflections = np.array([pad.pivot_displacement for pad in point.pads])
    np.testing.assert_allclose(deflections * 3e8, loads, rtol=1e-7, atol=1e-6)


@pytest.mark.parametrize("share", [0.005, 0.1, 0.5, 0.9, 0.99])
@pytest.mark.parametrize("first_deg", [0.0, 36.0])
def test_eccentricities_from_nearly_none_to_nearly_touching(share: float, first_deg: float):
    pads: tuple[Pad, ...] = equal_pads(first_deg=first_deg, preload=0.4)
    reach = 0.6 / np.cos(np.radians(first_deg))
    # an oil thin enough for the pressure to stay within what bearings stand
    point, _ = solve_case(pad_case(pads, float(share * reach), viscosity=1e-4), SPEED)
    assert point.converged, point.message
    assert point.eccentricity_ratio == pytest.approx(share * reach)
    assert point.attitude_angle == pytest.approx(0.0, abs=1e-6)


def test_pads_on_balls_pitch_with_the_journal_s_rotations_when_it_is_in_line():
    """On half the mesh as on the whole one, on which a hair of misalignment puts the pads."""
    pads = equal_pads(preload=0.5, pivot=SpherePivot(radius=0.05))
    found = {}
    for slope in (0.0, 1e-10):
        case = pad_case(pads, LoadTarget(3000.0), misalignment=(slope, 0.0), mesh=(60, 12))
        solution = solve_pads(case, SPEED)
        dynamics = film_dynamics(solution, np.eye(solution.state.displacement.size), rotations=True)
        assert sum(name.startswith("pitch") for name in dynamics.names) == 5
        found[slope] = dynamics.reduced(0.5j * SPEED)
    scales = np.array([CLEARANCE] * 2 + [2.0 * CLEARANCE / LENGTH] * 2)
    weights = scales[:, None] * scales[None, :]
    wrong = np.abs((found[0.0] - found[1e-10]) * weights).max()
    assert wrong < 1e-5 * np.abs(found[0.0] * weights).max()
    locked = pad_case(equal_pads(preload=0.5, pivot=SpringPivot(1e12)), LoadTarget(3000.0))
    solution = solve_pads(locked, SPEED)
    stiff = film_dynamics(solution, np.eye(solution.state.displacement.size), rotations=True)
    assert abs(found[0.0][2, 2]) < 0.5 * abs(stiff.reduced(0.5j * SPEED)[2, 2])
