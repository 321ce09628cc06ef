"""What a scenario can say of an orbit, and the shipped ones."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from rotorsim.errors import InputError, ScenarioError
from rotorsim.files.scenario import Scenario, load_scenario
from rotorsim.machine.matrices import state_matrix
from rotorsim.model.loads import BaseMotion, BaseShock, HarmonicForce, StepForce
from rotorsim.model.orbit import ActuatorSettings, Design, OrbitKind
from rotorsim.orbit import SpeedSchedule, analyse, orbit_ellipse
from rotorsim.orbit.description import describe_orbit
from rotorsim.orbit.film_force import SolvedFilmForce
from rotorsim.orbit.force_map import FilmMapForce
from rotorsim.orbit.integrate import _simulate_pieces
from rotorsim.orbit.orbit import OrbitStatus, concatenate
from rotorsim.rotor import Rotor
from rotorsim.study.orbits import _orbit_problem, simulate_orbit
from rotorsim.study.sweep import tabulate

SCENARIOS = Path(__file__).parents[2] / "scenarios"
SHIPPED = sorted(SCENARIOS.glob("orbit_*.toml"))
BASE = """
[bearing]
journal_radius = "25 mm"
length = "25 mm"
radial_clearance = "50 um"
[lubricant]
viscosity = "0.02 Pa*s"
[film]
inception = "free"
mesh = { circumferential = 64, axial = 16 }
[operating]
speed = ["6000 rpm", "12000 rpm"]
load = "800 N"
"""
RIGID = '[rotor]\nmass = "50 kg"\nunbalance = "500 g*mm"\n'
JEFFCOTT = (
    '[rotor]\nkind = "jeffcott"\ndisc_mass = "60 kg"\njournal_mass = "6 kg"\n'
    'shaft_stiffness = "9.6 MN/m"\ndisc_damping = "960 N*s/m"\nunbalance = "120 g*mm"\n'
)
RPM = np.pi / 30.0


def scenario(orbit: str, rotor: str = RIGID, base: str = BASE) -> Scenario:
    return Scenario.from_text(f'{base}{rotor}[orbit]\nforce = "film"\n{orbit}')


def constant(orbit: str, rotor: str = RIGID) -> Scenario:
    return scenario(f'speed = "9000 rpm"\n{orbit}', rotor)


@pytest.mark.parametrize(
    ("lines", "kind"),
    [
        ("", OrbitKind.UNBALANCE),
        ("unbalance = false", OrbitKind.FREE_DECAY),
        ('initial_displacement = ["1 um", "0 um"]', OrbitKind.UNBALANCE),
        ('step = { force = ["1 N", "0 N"] }', OrbitKind.STEP),
        ('harmonic = { force = ["1 N", "0 N"], frequency = "50 Hz" }', OrbitKind.HARMONIC),
        (
            'base_shock = { acceleration = ["9 m/s^2", "0 m/s^2"], duration = "5 ms" }',
            OrbitKind.BASE_MOTION,
        ),
    ],
)
def test_the_kind_follows_from_what_is_there(lines, kind):
    settings = constant(lines).orbit
    assert settings is not None
    assert settings.kind is kind


@pytest.mark.slow
def test_the_kind_of_a_ramp():
    for first, last, kind in ((6000, 9000, "run_up"), (9000, 6000, "coast_down")):
        ramp = f'{{ start = "{first} rpm", stop = "{last} rpm", duration = "2 s", hold = "1 s" }}'
        settings = scenario(f"speed = {ramp}\n").orbit
        assert settings is not None
        assert settings.kind == kind
        made = _orbit_problem(scenario(f'kind = "{kind}"\nspeed = {ramp}\n'))
        assert made.schedule == SpeedSchedule(
            (0.0, 2.0, 3.0), (first * RPM, last * RPM, last * RPM)
        )


@pytest.mark.slow
def test_unbalance_and_static_load_act_unless_switched_off():
    both = _orbit_problem(constant(""))
    assert both.rotor.unbalance.tolist() == [5e-4]
    assert both.static_load == (800.0, 0.0)
    free = 'kind = "free_decay"\ninitial_displacement = ["1 um", "0 um"]'
    assert _orbit_problem(constant(free)).rotor.unbalance.tolist() == [0.0]
    kept = _orbit_problem(constant(f"{free}\nunbalance = true"))
    assert kept.rotor.unbalance.tolist() == [5e-4]
    none = _orbit_problem(constant("static_load = false\nunbalance = false"))
    assert none.static_load == (0.0, 0.0)
    assert none.rotor.unbalance.tolist() == [0.0]


@pytest.mark.slow
def test_loads_reach_the_problem_in_si():
    lines = (
        'step = { force = ["1 kN", "-2 N"], start = "0.1 s", stop = "200 ms", on = "disc" }\n'
        'harmonic = { force = ["3 N", "4 N"], frequency = "50 Hz", phase = ["0 deg", "90 deg"] }\n'
        'base_motion = { displacement = ["10 um", "0 um"], frequency = "600 rpm" }\n'
        'base_shock = { acceleration = ["40 m/s^2", "0 m/s^2"], duration="6 ms", start="1 s" }\n'
    )
    step, wave, base, shock = _orbit_problem(constant(lines, JEFFCOTT)).loads
    assert step == StepForce((1000.0, -2.0), 0.1, 0.2, 1)
    assert isinstance(wave, HarmonicForce)
    assert wave.frequency == pytest.approx(100.0 * np.pi)
    assert wave.phase == pytest.approx((0.0, 0.5 * np.pi))
    assert isinstance(base, BaseMotion)
    assert base.frequency == pytest.approx(20.0 * np.pi)
    assert shock == BaseShock((40.0, 0.0), 0.006, 1.0)


@pytest.mark.slow
def test_jeffcott_rotor():
    read = constant("", JEFFCOTT).rotor
    assert read == Rotor.jeffcott(60.0, 9.6e6, 6.0, 960.0, 1.2e-4)
    assert read.total_mass == 66.0
    assert read.rigid_mass is None
    made = _orbit_problem(constant("", JEFFCOTT)).rotor
    assert [node.name for node in made.nodes] == ["journal", "disc"]
    assert made.unbalance.tolist() == [0.0, 1.2e-4]


WRONG = [
    ('kind = "free_decay"', RIGID, "orbit.initial_displacement", "would stay at rest"),
    ('kind = "step"', RIGID, "orbit.kind", "needs a step"),
    ('kind = "harmonic"', RIGID, "orbit.kind", "harmonic force"),
    ('kind = "base_motion"', RIGID, "orbit.kind", "motion of the base"),
    ('kind = "run_up"', RIGID, "orbit.kind", "rising speed"),
    ('kind = "coast_down"', RIGID, "orbit.kind", "falling speed"),
    ('kind = "unbalance"\nunbalance = false', RIGID, "orbit.kind", "needs an unbalance"),
    ('kind = "wobble"', RIGID, "orbit.kind", "run_up"),
    ('unbalance = "no"', RIGID, "orbit.unbalance", "true or false"),
    ("samples_per_revolution = 4", RIGID, "orbit.samples_per_revolution", "16 or more"),
    ('step = { force = ["1 N"] }', RIGID, "orbit.step.force", "exactly 2"),
    ('step = { start = "1 s" }', RIGID, "orbit.step.force", "missing"),
    (
        'step = { force = ["1 N", "0 N"], start = "1 s", stop = "1 s" }',
        RIGID,
        "orbit.step.stop",
        "after start",
    ),
    ('step = { force = ["1 N", "0 N"], on = "disc" }', RIGID, "orbit.step.on", "jeffcott"),
    ("", RIGID.replace("mass", "disc_mass"), "rotor.mass", "missing"),
    ("", JEFFCOTT + 'mass = "3 kg"\n', "rotor.mass", "does not go with"),
    ("", JEFFCOTT.replace('shaft_stiffness = "9.6 MN/m"', ""), "rotor.shaft_stiffness", "MN/m"),
]


@pytest.mark.parametrize(("lines", "rotor", "key", "words"), WRONG)
def test_what_does_not_fit_is_refused(lines, rotor, key, words):
    with pytest.raises(ScenarioError) as caught:
        constant(lines, rotor)
    assert caught.value.key == key
    assert words in str(caught.value)


def test_linear_coefficients_belong_to_the_loaded_position():
    text = f'{BASE}{RIGID}[orbit]\nspeed = "9000 rpm"\nstatic_load = false\n'
    with pytest.raises(ScenarioError, match="loaded position"):
        Scenario.from_text(text)
    with pytest.raises(InputError, match="coefficient table"):
        _orbit_problem(Scenario.from_text(text.replace("static_load = false\n", "")))


@pytest.mark.slow
def test_an_eccentricity_ratio_stands_for_the_load_that_gives_it():
    text = BASE.replace('load = "800 N"', "eccentricity_ratio = 0.4")
    for inception, force in (("free", FilmMapForce), ("max_film", SolvedFilmForce)):
        base = text.replace('"free"', f'"{inception}"')
        rotor = '[rotor]\nmass = "20 kg"\n'
        one = scenario('speed = "9000 rpm"\nrevolutions = 2\n', rotor, base)
        problem = _orbit_problem(one)
        assert isinstance(problem.force, force)
        orbit = simulate_orbit(one)
        assert orbit.eccentricity_ratio == pytest.approx(0.4, abs=1e-5)


@pytest.mark.slow
def test_the_harmonic_load_is_recognised_as_what_the_orbit_follows():
    lines = (
        "revolutions = 120\nunbalance = false\n"
        'harmonic = { force = ["200 N", "200 N"], frequency="40 Hz", phase=["0 deg", "-90 deg"] }'
    )
    orbit = simulate_orbit(constant(lines))
    assert orbit.status is OrbitStatus.PERIODIC
    assert "follows the load at 0.2667" in orbit.message
    said = describe_orbit(orbit)
    assert said["whirl_frequency_ratio"] == pytest.approx(40.0 / 150.0, rel=1e-4)
    assert said["whirl"]["semi_major"] > 3e-6
    assert said["growth_rate"] is None


@pytest.mark.slow
def test_description_of_an_unbalanced_orbit():
    orbit = simulate_orbit(constant("revolutions = 80"))
    said = describe_orbit(orbit)
    assert (said["status"], said["period"], said["orbit_kind"]) == ("periodic", 1, "unbalance")
    ellipse = orbit_ellipse(orbit.part(-40 * 64))
    assert said["synchronous"]["semi_major"] == pytest.approx(ellipse.semi_major, rel=1e-3)
    assert said["synchronous"]["direction"] == "forward"
    assert (
        said["min_film"]
        == orbit.min_film.min()
        == orbit.min_film[np.searchsorted(orbit.t, said["min_film_time"])]
    )
    assert said["note"] in orbit.message


@pytest.mark.slow
def test_oil_whip_locks_to_the_natural_frequency():
    orbit = simulate_orbit(load_scenario(SCENARIOS / "orbit_oil_whip.toml"))
    found = analyse(orbit).whirl_range
    assert found is not None
    # Past twice the natural frequency whirl grows out of what the unbalance leaves, and is seen at
    # 1304.6 rad/s whatever the tolerance from 1e-7 to 1e-9; coarser ones seed it earlier.
    assert found.first_speed == pytest.approx(1304.6, rel=0.005)
    assert found.last_speed > 4.0 * 400.0
    end = orbit.part(-40 * 64)
    from rotorsim.orbit.spectrum import whirl_frequency_ratio

    ratio = whirl_frequency_ratio(end)
    assert ratio is not None
    assert ratio < 0.3
    assert ratio * end.speed[0] == pytest.approx(400.0, rel=0.06)


@pytest.mark.slow
@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_orbits_say_what_is_seen_and_run(path):
    text = path.read_text(encoding="utf-8")
    assert text.startswith("# ")
    said = tomllib.loads(text)
    one = load_scenario(path)
    assert one.orbit is not None
    assert one.orbit.kind == said["orbit"]["kind"]
    for model in one.thermal_models:
        problem = _orbit_problem(one, thermal_model=model.value)
        pieces = _simulate_pieces(problem, 1)
        begin = concatenate([next(pieces)])
        assert begin.status is OrbitStatus.RUNNING
        assert begin.t.size == problem.samples_per_revolution
        assert np.all(begin.min_film > 0.0)


def test_an_orbit_of_every_kind_is_shipped():
    kinds = {load_scenario(path).orbit.kind for path in SHIPPED}  # type: ignore[union-attr]
    assert kinds == set(OrbitKind)


# -- actuator -------------------------------------------------------------------------------------

HEAVY = '[rotor]\nmass = "120 kg"\n'
START = 'speed = "12000 rpm"\ninitial_displacement = ["2 um", "0 um"]\n'


def actuated(lines: str, orbit: str = START, rotor: str = HEAVY, base: str = BASE) -> Scenario:
    return scenario(f"{orbit}[orbit.actuator]\n{lines}\n", rotor, base)


def test_an_actuator_is_read_in_si():
    read = actuated('design = "lqr"\nforce_limit = "1 kN"\ndisplacement_scale = "2 um"').orbit
    assert read is not None
    assert read.actuator == ActuatorSettings(Design.LQR, 1000.0, 2e-6)
    read = actuated('design = "pd"\nstiffness = "5 MN/m"\ndamping = "20 kN*s/m"').orbit
    assert read is not None
    assert read.actuator == ActuatorSettings(Design.PD, stiffness=5e6, damping=20e3)
    for lines in ("", "on = true"):
        read = actuated(lines).orbit
        assert read is not None
        assert read.actuator == ActuatorSettings()
    read = actuated('on = false\nforce_limit = "1 kN"').orbit
    assert read is not None
    assert read.actuator is None


RAMP = 'speed = { start = "6000 rpm", stop = "9000 rpm", duration = "1 s" }\n'
WRONG_ACTUATORS = [
    ('design = "pid"', START, HEAVY, BASE, "design", '"lqr", "pd"'),
    ('force_limit = "1 kg"', START, HEAVY, BASE, "force_limit", "force"),
    ('force_limit = "0 N"', START, HEAVY, BASE, "force_limit", "above 0"),
    ("gain = 3", START, HEAVY, BASE, "gain", "force_limit"),
    ('on = "yes"', START, HEAVY, BASE, "on", "true or false"),
    ('damping = "1 kN*s/m"', START, HEAVY, BASE, "damping", 'design = "pd"'),
    ('design="pd"\nforce_scale="1 N"', START, HEAVY, BASE, "force_scale", '"lqr"'),
    (
        'design = "pd"\ndamping = "1 kN*s/m"\ndecay_ratio = 0.1',
        START,
        HEAVY,
        BASE,
        "decay_ratio",
        "damping",
    ),
    ("", RAMP, HEAVY, BASE, "", "one speed, not a ramp"),
    ("", START, JEFFCOTT, BASE, "", "rigid"),
    ("", f"{START}static_load = false\n", HEAVY, BASE, "", "static load"),
]


@pytest.mark.parametrize(("lines", "orbit", "rotor", "base", "key", "words"), WRONG_ACTUATORS)
def test_an_actuator_that_does_not_fit_is_refused(lines, orbit, rotor, base, key, words):
    with pytest.raises(ScenarioError) as caught:
        actuated(lines, orbit, rotor, base)
    assert caught.value.key == f"orbit.actuator.{key}".rstrip(".")
    assert words in str(caught.value)


def test_an_actuator_goes_with_a_film_that_is_solved_at_every_step():
    base = BASE.replace('[film]\ninception = "free"', '[film]\ninception = "max_film"')
    held = simulate_orbit(actuated('force_limit = "5 N"', f"{START}revolutions = 1\n", base=base))
    assert "film solved at each step" in held.message
    assert np.abs(held.actuator_force).max() == pytest.approx(5.0)


@pytest.mark.slow
@pytest.mark.parametrize("design", ["lqr", "pd"])
def test_an_actuator_brings_to_rest_what_whirls_without_it(design):
    run = f"{START}revolutions = 60\n"
    lines = f'design = "{design}"\nforce_limit = "100 N"\n'
    free = simulate_orbit(actuated(f"{lines}on = false", run))
    held = simulate_orbit(actuated(lines, run))
    away = [np.hypot(o.x - o.equilibrium[0], o.y - o.equilibrium[1]) for o in (free, held)]
    last = slice(-10 * 64, None)
    assert away[0][last].max() > 2.0 * away[0][0]
    assert away[1][last].max() < 0.05 * away[1][0]
    assert held.equilibrium == pytest.approx(free.equilibrium, abs=1e-12)
    assert held.status is OrbitStatus.SETTLED
    assert "actuator limited to 100 N per axis; largest actuator force" in held.message


@pytest.mark.slow
def test_the_actuator_never_gives_more_than_its_limit():
    held = simulate_orbit(actuated('force_limit = "5 N"', f"{START}revolutions = 5\n"))
    assert held.message.endswith("largest actuator force 5 N")


def test_an_actuator_on_linear_coefficients_decays_as_its_closed_loop():
    speed = 12000.0 * RPM
    text = (
        f'{BASE}{HEAVY}[orbit]\nspeed = "12000 rpm"\nrevolutions = 30\n'
        'initial_displacement = ["0.5 um", "0 um"]\n'
        '[orbit.actuator]\ndesign = "pd"\nstiffness = "2 MN/m"\ndamping = "30 kN*s/m"\n'
    )
    one = Scenario.from_text(text)
    table = tabulate(one, workers=1)
    film = table.at(speed, thermal_model="isothermal", radial_clearance=50e-6)
    stiffness, damping = film.stiffness, film.damping
    held = simulate_orbit(one, table)
    passive = np.linalg.eigvals(state_matrix(stiffness, damping, 120.0)).real.max()
    k, c = stiffness + 2e6 * np.eye(2), damping + 3e4 * np.eye(2)
    # exact: the matrix exponential of the closed loop
    exact = expm(state_matrix(k, c, 120.0) * held.t[640]) @ [0.5e-6, 0.0, 0.0, 0.0]
    x0, y0 = held.equilibrium
    assert (held.x[640] - x0, held.y[640] - y0) == pytest.approx(exact[:2], abs=1e-5 * 0.5e-6)
    assert passive > 0.0 > np.linalg.eigvals(state_matrix(k, c, 120.0)).real.max()
