"""Beam rotors against closed forms, orders of convergence, balances and reciprocity."""

import numpy as np
import pytest
from scipy.linalg import eigh, expm

from rotorsim.errors import InputError
from rotorsim.machine.machine import Machine
from rotorsim.machine.modes import modes
from rotorsim.machine.support import ConstantSupport
from rotorsim.machine.thresholds import critical_speeds, threshold_speeds
from rotorsim.model.shaft import Coupling, Disc, Material, Section
from rotorsim.rotor import Beam, Rotor, beam_rotor
from rotorsim.rotor.beam import _shear_coefficient, buckling_load
from rotorsim.threads import on_one_blas_thread

STEEL = Material(210e9, 7800.0)
LENGTH, DIAMETER = 1.2, 0.08
AREA, SECOND = np.pi * DIAMETER**2 / 4.0, np.pi * DIAMETER**4 / 64.0
BENDING, PER_LENGTH = STEEL.youngs_modulus * SECOND, STEEL.density * AREA
SHEAR = float(_shear_coefficient(0.0, 0.3)) * STEEL.shear * AREA


def uniform(elements: int = 8, **changes) -> Beam:
    return Beam((Section(LENGTH, DIAMETER, elements=elements),), material=STEEL, **changes)


@on_one_blas_thread
def supported_frequencies(beam: Beam, count: int = 3) -> np.ndarray:
    """In the plane of x, both ends held, without rotation [rad/s]."""
    rotor = beam_rotor(beam)
    plane = [i for i, (_, name) in enumerate(rotor.unknowns) if name in ("x", "theta_y")]
    free = np.ix_(*[[i for i in plane if i not in (0, rotor.size - 4)]] * 2)
    return np.sqrt(eigh(rotor.stiffness[free], rotor.mass[free], eigvals_only=True)[:count])


def exact_frequencies(shear: bool, tension: float = 0.0, count: int = 3) -> np.ndarray:
    """Rayleigh's or Timoshenko's beam on simple supports [rad/s]."""
    beta2 = (np.arange(1, count + 1) * np.pi / LENGTH) ** 2
    inertia = STEEL.density * SECOND
    if not shear:
        return np.sqrt((BENDING * beta2**2 + tension * beta2) / (PER_LENGTH + inertia * beta2))
    a = inertia * PER_LENGTH / SHEAR
    b = PER_LENGTH + beta2 * (inertia + PER_LENGTH * BENDING / SHEAR)
    c = BENDING * beta2**2
    return np.sqrt(2.0 * c / (b + np.sqrt(b**2 - 4.0 * a * c)))


@pytest.mark.parametrize(("shear", "order", "last"), [(False, 4.0, 1e-6), (True, 2.0, 2e-4)])
def test_uniform_beam_converges_to_the_closed_form_at_its_order(shear, order, last):
    exact = exact_frequencies(shear)
    error = np.array(
        [supported_frequencies(uniform(n, shear=shear)) / exact - 1.0 for n in (8, 16, 32)]
    )
    rate = np.log2(error[:-1] / error[1:])
    assert np.all(rate > order - 0.1)
    assert np.all(error[-1, 0] < last)


@pytest.mark.parametrize("share", [3.0, -0.5])
def test_axial_force_stiffens_or_softens(share):
    tension = share * np.pi**2 * BENDING / LENGTH**2
    found = supported_frequencies(uniform(32, shear=False, axial_force=tension))
    assert found == pytest.approx(exact_frequencies(False, tension), rel=1e-5)


def test_shear_coefficient_of_a_solid_shaft_and_of_a_thin_tube():
    assert _shear_coefficient(0.0, 0.3) == pytest.approx(6.0 * 1.3 / 8.8)
    assert _shear_coefficient(1.0, 0.3) == pytest.approx(2.0 * 1.3 / (4.0 + 0.9))


def test_a_cone_has_its_mass_and_the_frequencies_of_fine_steps():
    left, right = 0.06, 0.12
    cone = Section(LENGTH, left, 0.02, right, 0.02, elements=48)
    parts = 192
    middles = left + (right - left) * (np.arange(parts) + 0.5) / parts
    steps = tuple(Section(LENGTH / parts, float(d), 0.02, elements=1) for d in middles)
    beam, stepped = Beam((cone,), material=STEEL), Beam(steps, material=STEEL)
    volume = np.pi / 12.0 * LENGTH * (left**2 + left * right + right**2)
    volume -= np.pi / 4.0 * 0.02**2 * LENGTH
    assert beam_rotor(beam).total_mass == pytest.approx(7800.0 * volume, rel=1e-12)
    assert supported_frequencies(beam) == pytest.approx(supported_frequencies(stepped), rel=5e-4)


def test_layers_add_up_and_a_loose_sleeve_has_mass_only():
    sleeve = {"at": 0.4, "layer": 2}
    solid = Beam((Section(LENGTH, 0.1),), material=STEEL)
    core = Section(LENGTH, 0.06)
    shell = Section(LENGTH, 0.1, 0.06, at=0.0, layer=2)
    both = Beam((core, shell), material=STEEL, shear=False)
    plain = Beam(solid.sections, material=STEEL, shear=False)
    assert supported_frequencies(both) == pytest.approx(supported_frequencies(plain), rel=1e-4)
    loose = Beam((core, Section(0.4, 0.1, 0.06, stiffness=False, **sleeve)), material=STEEL)
    tight = Beam((core, Section(0.4, 0.1, 0.06, **sleeve)), material=STEEL)
    assert beam_rotor(loose).total_mass == pytest.approx(beam_rotor(tight).total_mass)
    bare = supported_frequencies(Beam((core,), material=STEEL))
    assert supported_frequencies(loose)[0] < bare[0] < supported_frequencies(tight)[0]


def overhung(**changes) -> Beam:
    disc = Disc.from_dimensions(LENGTH, 0.4, 0.06, 7800.0, 0.08, name="disc")
    return uniform(8, discs=(disc,), **changes)


def machine_of(beam: Beam, support: ConstantSupport) -> Machine:
    return Machine.on_identical(beam_rotor(beam, [0.0, 0.75]), support)


def test_energy_of_the_undamped_rotor_is_conserved():
    machine = machine_of(overhung(), ConstantSupport([1e8, 6e7]))
    speed = 500.0
    mass, damping, stiffness = machine.matrices(speed)
    assert np.array_equal(damping, -damping.T)
    n = machine.size
    start = np.concatenate([1e-5 * np.cos(np.arange(n)), 1e-3 * np.sin(np.arange(n))])
    energies = []
    for t in (0.0, 0.01, 0.1):
        q, v = np.split(expm(t * machine.state_matrix(speed)) @ start, 2)
        energies.append(0.5 * (v @ mass @ v + q @ stiffness @ q))
    assert energies[1:] == pytest.approx([energies[0]] * 2, rel=1e-6)


def test_receptances_are_reciprocal_and_mirrored_by_the_sense_of_rotation():
    machine = machine_of(overhung(), ConstantSupport([1e8, 6e7], 2e4))
    for speed in (0.0, 700.0):
        ahead = np.linalg.inv(machine.dynamic_stiffness(900j, speed))
        back = np.linalg.inv(machine.dynamic_stiffness(900j, -speed))
        assert np.allclose(ahead, back.T, rtol=1e-7, atol=1e-9 * np.abs(ahead).max())


def test_shapes_are_orthogonal_and_gyroscopic_frequencies_do_not_depend_on_the_side():
    machine = machine_of(overhung(), ConstantSupport([1e8, 6e7]))
    found = modes(machine, 0.0).oscillating()
    lowest = np.argsort(found.undamped_frequency[0])[:6]
    vectors = found.shapes[0][lowest]
    product = np.abs(vectors.conj() @ machine.rotor.mass @ vectors.T)
    size = np.sqrt(np.outer(np.diag(product), np.diag(product)))
    assert np.all(np.abs(product / size - np.eye(6)) < 1e-8)
    other = machine_of(overhung(clockwise=False), ConstantSupport([1e8, 6e7]))
    one, two = (modes(m, 600.0).undamped_frequency for m in (machine, other))
    assert one == pytest.approx(two, rel=1e-9)


def test_internal_damping_drives_forward_whirl_from_the_forward_critical_speed_on():
    """A whirl at the shaft's own speed does not deform it, and is neither damped nor driven."""
    beam = overhung(internal_damping=1e-5)
    machine = machine_of(beam, ConstantSupport(1e9))
    speeds = np.linspace(100.0, 900.0, 9)
    found = modes(machine, speeds)
    critical = [c for c in critical_speeds(machine, found) if c.whirl == "forward"]
    assert len(critical) == 1
    before, after = (modes(machine, critical[0].speed * f) for f in (1.0 - 1e-3, 1.0 + 1e-3))
    assert before.verdicts == ("stable",)
    assert after.verdicts == ("unstable",)
    least = after.oscillating()
    assert least.whirl[0, least.least_stable[0]] == "forward"


def test_threshold_of_internal_against_external_damping():
    mass, stiffness, inner, outer = 12.0, 3e6, 80.0, 50.0
    eye, turn = np.eye(2), np.array([[0.0, 1.0], [-1.0, 0.0]])
    rotor = Rotor.from_matrices(
        mass * eye, stiffness * eye, (inner + outer) * eye, circulatory=inner * turn,
        unknowns_per_node=2,
    )  # fmt: skip
    wanted = np.sqrt(stiffness / mass) * (1.0 + outer / inner)
    below, above = (modes(Machine(rotor), wanted * f) for f in (1.0 - 1e-9, 1.0 + 1e-9))
    assert below.verdicts + above.verdicts == ("stable", "unstable")
    assert threshold_speeds(Machine(rotor)) == []  # no table, no range of speeds


def test_reactions_of_a_slender_shaft_on_three_stiff_supports():
    length = 6.0
    beam = Beam((Section(length, 0.06, elements=40),), material=STEEL)
    rotor = beam_rotor(beam, [0.0, 3.0, 6.0])
    machine = Machine.on_identical(rotor, ConstantSupport(1e11))
    weight = 9.81 * rotor.mass @ rotor.translation((1.0, 0.0))
    deflection = np.linalg.solve(machine.matrices(0.0)[2], weight)
    reactions = np.array([1e11 * deflection[rotor.first_unknown[i]] for i in rotor.bearing_nodes])
    total = 9.81 * rotor.total_mass
    assert reactions.sum() == pytest.approx(total, rel=1e-6)
    assert reactions / (0.5 * total) == pytest.approx([3 / 8, 10 / 8, 3 / 8], rel=2e-3)


def test_default_mesh():
    beam = Beam((Section(0.5, 0.05), Section(0.7, 0.1)), material=STEEL)
    nodes = beam.mesh([0.33])
    assert nodes.size >= 21
    assert np.diff(nodes[nodes <= 0.5 + 1e-9]).max() <= 0.05 + 1e-12
    assert np.abs(nodes - 0.33).min() < 1e-12


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Beam(()), "needs a section"),
        (lambda: Beam((Section(1.0, 0.1),), (Disc(1.2, 5.0),)), "from 0 to 1 m"),
        (lambda: Beam((Section(1.0, 0.1), Section(1.0, 0.1, at=0.5))), "overlaps"),
        (lambda: Beam((Section(1.0, 0.1), Section(1.0, 0.1, at=1.5))), "leaves a gap"),
        (lambda: beam_rotor(uniform(), [2.0]), r"rotor.places: .*from 0 to 1.2 m"),
        (lambda: Section(0.5, 0.1, 0.2), "inner_diameter"),
        (lambda: Section(0.5, 0.1, layer=2), "needs its place"),
        (lambda: Disc(0.1, 1.0, polar_inertia=-1.0), r"rotor.disc.polar_inertia: must be 0"),
        (lambda: Material(shear_modulus=1e9), "does not fit"),
    ],
)
def test_bad_drawings_are_refused(make, words):
    with pytest.raises(InputError, match=words):
        make()


def test_rigid_bodies_on_a_coupling_swing_as_the_closed_form_has_it():
    # Two equal stiff halves, in one plane: they fold against the angular stiffness, and slide along
    # each other against the lateral one.
    half, mass, lateral, angular = 0.5, 40.0, 3e6, 2e4
    stiff = Material(2e15, mass / half / (np.pi / 4 * 0.09))
    section = Section(half, 0.3, elements=1, material=stiff)
    beam = Beam((section, section), shear=False, couplings=(Coupling(half, lateral, angular, 6.0),))
    rotor = beam_rotor(beam)
    assert rotor.total_mass == pytest.approx(2 * mass + 6.0)
    values = np.sqrt(np.maximum(eigh(rotor.stiffness, rotor.mass, eigvals_only=True), 0.0))[4:8]
    about_end = mass * (half**2 / 12 + 0.3**2 / 16)
    # Folding: centres move by v, ends at the cut by v + half/2 a, momentum of a half is zero.
    m, tip, arm = mass, 3.0, half / 2
    inertia = np.array([[m + tip, tip * arm], [tip * arm, about_end + tip * arm**2]])
    fold = eigh(np.diag([0.0, 1.0]) * 4 * angular / 2, inertia, eigvals_only=True)[-1]
    ends = np.array([1.0, arm])
    slide = eigh(2 * lateral * np.outer(ends, ends), inertia, eigvals_only=True)[-1]
    assert np.sort(values)[::2] == pytest.approx(np.sqrt(sorted([fold, slide])), rel=1e-6)


def test_a_stiff_coupling_is_a_whole_shaft():
    whole = supported_frequencies(uniform(8))
    cut = Coupling(0.45, 1e13, 1e12)
    assert supported_frequencies(uniform(8, couplings=(cut,))) == pytest.approx(whole, rel=2e-3)
    beam = Beam((Section(0.45, DIAMETER, elements=3), Section(0.75, DIAMETER, elements=5)),
                material=STEEL)  # fmt: skip
    same = supported_frequencies(beam)
    cut_there = Beam(beam.sections, material=STEEL, couplings=(cut,))
    assert supported_frequencies(cut_there) == pytest.approx(same, rel=1e-5)


def test_modal_damping_rotates_and_gives_every_mode_its_ratio():
    rotor = beam_rotor(uniform(10, modal_damping=0.02))
    found = modes(Machine(rotor, [(0, ConstantSupport(0.0))]), 0.0, count=12).oscillating()
    bending = found.damped_frequency[0] > 10.0
    assert found.damping_ratio[0, bending] == pytest.approx(0.02, rel=1e-6)
    held = Machine.on_identical(beam_rotor(uniform(10, modal_damping=0.02)), ConstantSupport(1e12))
    first = float(modes(held, 0.0, count=4).oscillating().damped_frequency[0].min())
    assert modes(held, 0.9 * first).verdicts == ("stable",)
    assert modes(held, 1.3 * first).verdicts == ("unstable",)


def test_a_massless_shaft_with_a_disc_is_a_jeffcott_rotor():
    light = Material(210e9, 0.0)
    beam = Beam((Section(LENGTH, DIAMETER, elements=2),), (Disc(0.6, 50.0),), light, shear=False)
    machine = Machine.on_identical(beam_rotor(beam), ConstantSupport(1e13, 0.0))
    found = modes(machine, 100.0).oscillating()
    wanted = np.sqrt(48.0 * BENDING / LENGTH**3 / 50.0)
    assert found.damped_frequency[0] == pytest.approx([wanted, wanted], rel=1e-4)


@pytest.mark.parametrize("elements", [8, 40])
def test_a_shaft_without_density_makes_no_modes_of_its_own(elements: int):
    """What has no mass and no damping follows statically; rounding makes no modes of it."""
    spans = (Section(0.5 * LENGTH, DIAMETER, elements=elements),) * 2
    disc = Disc(0.4 * LENGTH, 50.0, 1.0, 0.6)
    supports = ConstantSupport(1e8, 0.0)
    light, heavy = (
        modes(
            Machine.on_identical(
                beam_rotor(Beam(spans, (disc,), Material(210e9, density))), supports
            ),
            [100.0, 500.0], count=6,
        )
        for density in (0.0, 1.0)
    )  # fmt: skip
    assert set(light.verdicts) == {"undamped"}
    assert light.undamped.all()
    first, second = (np.sort(one.oscillating().damped_frequency)[:, :4] for one in (light, heavy))
    assert first == pytest.approx(second, rel=1e-3)


@pytest.mark.parametrize("shear", [True, False])
@pytest.mark.parametrize("short", [1e-3, 1e-4])
def test_a_very_short_element_damps_nothing(short: float, shear: bool):
    """Its stiffness is ten orders above the shaft's, and its frequency six."""

    def beam(*middle: Section) -> Beam:
        half = Section(0.5, 0.05, elements=10)
        return Beam((half, *middle, half), (Disc(0.3, 10.0, 0.1, 0.06),), STEEL, shear=shear)

    speeds, supports = [0.0, 100.0, 500.0], ConstantSupport(1e7, 0.0)
    found, wanted = (
        modes(Machine.on_identical(beam_rotor(one), supports), speeds, count=6)
        for one in (beam(Section(short, 0.05, elements=1)), beam())
    )
    assert set(found.verdicts) == {"undamped"}
    first, second = (np.sort(one.oscillating().damped_frequency)[:, :6] for one in (found, wanted))
    assert first == pytest.approx(second, rel=4.0 * short + 1e-4)


def test_a_shaft_between_pins_buckles_at_eulers_load():
    beam = uniform(32, shear=False)
    euler = np.pi**2 * BENDING / LENGTH**2
    assert buckling_load(beam, (0.0, LENGTH)) == pytest.approx(euler, rel=1e-6)
    # a pin in the middle: two bays
    assert buckling_load(beam, (0.0, 0.5 * LENGTH, LENGTH)) == pytest.approx(4 * euler, rel=1e-5)
    assert buckling_load(beam, (0.0,)) == np.inf


@pytest.mark.slow
def test_critical_speeds_of_a_long_shaft_are_frequencies_at_their_speeds():
    """Far above its lowest modes, which then are not among those that are followed."""
    beam = Beam((Section(10.0, 0.064, elements=24),), (Disc(5.0, 40.0, 0.4, 0.25),), STEEL)
    machine = machine_of(beam, ConstantSupport(2e7, 2e4))
    found = critical_speeds(machine, modes(machine, np.linspace(100.0, 8000.0, 12)))
    assert len(found) > 20
    for one in found:
        frequencies = np.abs(np.linalg.eigvals(machine.state_matrix(one.speed)).imag)
        assert np.abs(frequencies - one.speed).min() < 1e-6 * one.speed
    forward = [one.speed for one in found if one.whirl == "forward"]
    assert np.diff(forward).min() > 1e-3
