"""Morton effect: the film's heat against its motion in time, the shaft against closed forms."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from film_cases import split_grooves, thermal_case
from pad_cases import equal_pads, pad_case
from scipy.sparse import diags_array, kron
from scipy.sparse.linalg import spsolve

import rotorsim as rs
from rotorsim.bearing.dynamics import following_displacements
from rotorsim.errors import InputError
from rotorsim.film.energy import WallTemperatures, march
from rotorsim.film.geometry import CENTER
from rotorsim.film.heat import energy_problem
from rotorsim.film.hot_spot import spot_heat
from rotorsim.film.layers import layer_integrals
from rotorsim.film.pad_solution import solve_pads
from rotorsim.film.problem import film_state
from rotorsim.film.solution import solve_film
from rotorsim.machine.hot_spot import Journal, SpotFilms, _turning_bow, spot_loop
from rotorsim.machine.machine import Machine
from rotorsim.machine.peaks import node_at
from rotorsim.machine.response import forced_response
from rotorsim.machine.support import ConstantSupport
from rotorsim.model import Bearing, LoadTarget, ThermalSettings
from rotorsim.model.shaft import Disc, Section
from rotorsim.rotor import Beam, beam_rotor, with_unbalance
from rotorsim.study.hot_spot import hot_spot_document, hot_spot_study

SPEED = 800.0


def _film(kind):
    """Film, and the displacements of all its unknowns with the journal along x and y."""
    if kind == "pads":
        thermal = ThermalSettings(model="thd")
        case = pad_case(equal_pads(), LoadTarget(2000.0), thinning=0.03, thermal=thermal)
        solution = solve_pads(case, SPEED)
    else:
        bearing = Bearing(0.05, 0.06, 100e-6, grooves=split_grooves())
        case = thermal_case(LoadTarget(8000.0), bearing=bearing, cavitation=kind)
        mesh = replace(case.film.mesh, circumferential=36, axial=4, cross_film=8)
        solution = solve_film(replace(case, film=replace(case.film, mesh=mesh)), SPEED)
    assert solution.status == "converged", solution.message
    return solution.thermal, following_displacements(solution, 1j * SPEED)


def _in_time(film, motion, surface, steps, turns):
    """Heat in time, implicit Euler: the first harmonic that stands still on the journal."""
    state, problem, heat = film.state, film.state.problem, film.heat
    shapes = problem.geometry.displacements.shapes[:, CENTER]
    theta, area = problem.mesh.theta, float(np.sum(film.energy.dy)) * 2.0 * np.pi * 0.05
    step = 2.0 * np.pi / problem.speed / steps
    temperature, layers = heat.temperature.copy(), heat.temperature.shape[2]
    total = 0.0
    for number in range(1, steps * turns + 1):
        turn = np.exp(2j * np.pi * number / steps)
        q = state.displacement + np.real(motion * turn)
        v = np.real(1j * problem.speed * motion * turn)
        viscosity = np.asarray(problem.lubricant.law.viscosity(temperature))
        now = film_state(
            problem, q, layer_integrals(viscosity), velocity=v, frozen=state.solution.full
        )
        energy = energy_problem(problem, now)
        volume = now.center_thickness * now.operator.area * energy.flow.liquid_fraction
        storage = energy.heat_capacity * volume / layers / step * ~energy.fixed
        squeeze = np.tensordot(v, shapes, axes=1) * now.operator.area * now.solution.full
        wave = np.real(surface * np.exp(-1j * theta) * turn)
        shaft = heat.shaft + np.repeat(wave[:, None], temperature.shape[1], axis=1)
        walls = WallTemperatures(heat.bush, shaft, film.walls.bush.insulated)
        march(
            energy, viscosity, walls, film.inlet_temperature, temperature, passes=2,
            source=storage[:, :, None] * temperature, storage=storage,
            swelling=energy.heat_capacity * squeeze,
        )  # fmt: skip
        if number > steps * (turns - 1):
            passed = energy.wall_conductance(-1) * (temperature[:, :, -1] - shaft)
            total += 2.0 * np.sum(passed * np.exp(1j * theta)[:, None]) / turn / area / steps
    return total


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["reynolds", "jfo", "pads"])
def test_heat_of_a_film_equals_its_motion_in_time(kind):
    """Euler's steps are of first order: from two step lengths."""
    film, moved = _film(kind)
    linear = spot_heat(film)
    motions = [2e-7 * moved @ [1.0, -1j], 2e-7 * moved @ [1.0, 0.5], 0.0 * moved[:, 0]]
    for motion, surface in zip(motions, [0.0, 0.0, 0.05 + 0.02j], strict=True):
        wanted = linear.by_motion @ motion + linear.by_temperature * surface
        coarse, fine = (_in_time(film, motion, surface, steps, 4) for steps in (150, 300))
        found = 2.0 * fine - coarse
        assert abs(found - wanted) < 1e-3 * abs(wanted)


# -- the shaft -----------------------------------------------------------------------------------
def _journal(bore=0.0, length=0.06, **changes):
    return replace(
        Journal(0.5, length, 0.05, bore, 11.7e-6, 45.0, 7850.0 * 460.0), **changes
    )  # fmt: skip


def _conduction(journal, cells=(60, 400)):
    """Laplace's equation for the first harmonic by finite volumes: mean T and bend of 1 W/m2."""
    n, m = cells
    r = np.linspace(journal.bore, journal.radius, n + 1)
    z = np.linspace(0.0, 0.5 * journal.length + 6.0 * journal.radius, m + 1)
    rc, dr, dz = 0.5 * (r[1:] + r[:-1]), r[1] - r[0], z[1] - z[0]
    radial = diags_array(
        [r[1:-1] / dr, -(np.r_[0.0, r[1:-1]] + np.r_[r[1:-1], 0.0]) / dr - dr / rc, r[1:-1] / dr],
        offsets=[-1, 0, 1],
    )
    ends = -np.r_[1.0, np.full(m - 2, 2.0), 1.0] / dz
    along = diags_array(
        [np.full(m - 1, 1.0 / dz), ends, np.full(m - 1, 1.0 / dz)], offsets=[-1, 0, 1]
    )
    operator = kron(radial, diags_array(np.full(m, dz))) + kron(diags_array(rc * dr), along)
    inside = np.clip((0.5 * journal.length - z[:-1]) / dz, 0.0, 1.0)
    source = np.zeros((n, m))
    source[-1] = -journal.radius * inside * dz / journal.conductivity
    field = spsolve(operator.tocsc(), source.ravel()).reshape(n, m)
    surface = field[-1] + 0.5 * dr * inside / journal.conductivity
    mean = float(np.sum(surface * inside) / inside.sum())
    moment = 2.0 * float(np.sum(field * (rc**2 * dr)[:, None] * dz))
    return mean, 4.0 * journal.expansion * moment / (journal.radius**4 - journal.bore**4)


@pytest.mark.parametrize("bore", [0.0, 0.03])
@pytest.mark.parametrize("length", [0.02, 0.15])
def test_a_journal_warmed_on_one_side(bore, length):
    journal = _journal(bore, length)
    temperature, bend = _conduction(journal)
    assert journal.resistance == pytest.approx(temperature, rel=0.02)
    assert journal.bend * journal.resistance == pytest.approx(bend, rel=0.01)


def test_a_long_journal_is_a_cylinder():
    """T = r q/k; the heat of a linear field; a bend of alpha T L/R."""
    journal = _journal(length=20.0)
    assert journal.resistance == pytest.approx(0.05 / 45.0, rel=3e-3)
    assert journal.heat_capacity == pytest.approx(0.25 * 7850.0 * 460.0 * 0.05, rel=1e-4)
    assert journal.bend == pytest.approx(11.7e-6 * 20.0 / 0.05, rel=3e-3)


def _overhung(journal, stiffness=1e12):
    beam = Beam((Section(1.0, 0.05),), (Disc(1.0, 40.0, 0.3, 0.2),))
    rotor = with_unbalance(beam_rotor(beam, [0.0, 0.7]), [(1.0, 1e-4, 0.0)])
    nodes = [node_at(rotor, at) for at in (0.0, 0.7)]
    support = ConstantSupport(stiffness * np.eye(2), 1e3 * np.eye(2))
    return Machine(rotor, [(node, support) for node in nodes]), replace(journal, at=0.7)


def test_an_overhung_shaft_bends_away_from_its_warm_side():
    """On stiff supports the free end moves by the bend times its length, against the warm side.

    Less what the bend's length of 60 mm leaves: the shaft is straight only beside it.
    """
    machine, journal = _overhung(_journal())
    rotor = machine.rotor
    bow = rotor.stiffness @ _turning_bow(machine, journal)
    answer = forced_response(machine, np.array([1e-3]), bow[None])[0]
    first = int(rotor.first_unknown[-1])
    wanted = 0.3 - 0.06 / 8.0 * (1.0 + 0.3 / 0.7)
    assert answer[first] == pytest.approx(-wanted, rel=1e-4)
    assert answer[first + 1] == pytest.approx(1j * wanted, rel=1e-4)


def test_the_loop_grows_where_its_gain_exceeds_one():
    machine, journal = _overhung(_journal(), stiffness=2e7)
    speed = np.linspace(100.0, 700.0, 601)
    heat = np.tile(np.array([[[4e9 - 1e9j, 1e9 + 4e9j]]]), (speed.size, 1, 1))
    films = SpotFilms(speed, heat, np.full((speed.size, 1), 5e3 + 0j))
    loop = spot_loop(machine, [journal], [1], films)
    grows = loop.growth_rate > 0.0
    np.testing.assert_array_equal(grows, loop.gain[:, 0].real > 1.0)
    assert 0 < grows.sum() < speed.size
    # By hand: the film's heat of the settled orbit is what film and shaft take away.
    taken = (5e3 + 1.0 / journal.resistance) * loop.temperature[:, 0]
    np.testing.assert_allclose(np.einsum("nk,nk->n", heat[:, 0], loop.motion[:, 0]), taken)
    assert np.abs(loop.motion - loop.cold).max() > 0.0


# -- machines ------------------------------------------------------------------------------------
MACHINE = """
[rotor]
kind = "beam"
[[rotor.section]]
length = "0.8 m"
outer_diameter = "60 mm"
[[rotor.disc]]
name = "wheel"
at = "0.8 m"
mass = "30 kg"
polar_inertia = "0.4 kg*m^2"
transverse_inertia = "0.25 kg*m^2"
[[rotor.unbalance]]
at = "0.8 m"
amount = "300 g*mm"
[[support]]
name = "left"
at = "100 mm"
stiffness = "50 MN/m"
damping = "50 kN*s/m"
[[support]]
name = "right"
at = "600 mm"
bearing = "film.toml"
[operating]
speed = { start = "4000 rpm", stop = "9000 rpm", count = 3 }
[hot_spot]
"""
FILM = """
[bearing]
journal_radius = "30 mm"
length = "30 mm"
radial_clearance = "60 um"
[lubricant]
iso_vg = 32
density = "860 kg/m^3"
specific_heat = "2000 J/(kg*delta_degC)"
thermal_conductivity = "0.13 W/(m*delta_degC)"
[film]
mesh = { circumferential = 48, axial = 6, cross_film = 8 }
[thermal]
models = ["thd"]
ambient_temperature = "40 degC"
[operating]
speed = "4000 rpm"
load = "500 N"
"""


def _machine(folder, text=MACHINE, film=FILM):
    (folder / "film.toml").write_text(film, encoding="utf-8")
    (folder / "machine.toml").write_text(text, encoding="utf-8")
    return rs.load_machine(folder / "machine.toml")


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    machine = _machine(tmp_path_factory.mktemp("hot_spot"))
    return hot_spot_study(rs.analyse_machine(machine, workers=1)["thd"])


def test_hot_spot_of_a_machine(study):
    """Some 0.1 to 1 K for each micrometre, behind the high spot by less than a quarter turn."""
    assert study.names == ("right",)
    assert 1e5 < study.sensitivity.min() < study.sensitivity.max() < 1e6
    assert 0.0 < study.lag.min() < study.lag.max() < 0.5 * np.pi
    assert np.isfinite(study.loop.gain).all()


def test_hot_spots_do_not_know_where_down_is(study, tmp_path):
    """The whole machine turned by a right angle: the same gains."""
    text = MACHINE.replace("[operating]\n", "[operating]\nvertical = true\n")
    text += '[[load]]\nat = "600 mm"\nforce = ["300 N", "400 N"]\n'
    turned = text.replace('["300 N", "400 N"]', '["-400 N", "300 N"]')
    gains = [
        hot_spot_study(rs.analyse_machine(_machine(tmp_path, one), workers=1)["thd"]).loop.gain
        for one in (text, turned)
    ]
    np.testing.assert_allclose(*gains, rtol=1e-5, atol=1e-7)


def test_document_of_hot_spots(study):
    document = hot_spot_document(study)
    assert document["stable"] is study.stable
    assert len(document["gain_real"]) == len(document["speeds"])


@pytest.mark.parametrize(
    ("text", "film", "said"),
    [
        (MACHINE + 'support = ["left"]\n', FILM, 'hot_spot.support[0]: must be one of "right"'),
        (MACHINE, FILM.replace('"thd"', '"isothermal"'), "hot_spot: needs a support with bearing"),
        (MACHINE + "films = 1\n", FILM, "hot_spot.films"),
    ],
)  # fmt: skip
def test_hot_spots_that_cannot_be(tmp_path, text, film, said):
    with pytest.raises(InputError, match=re.escape(said)):
        _machine(tmp_path, text, film)
