"""Films over load, supply temperature and clearance; tolerances carried through the film."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scenario_texts import BEARING, BOTH_MODELS, OIL

from rotorsim.bearing import solve as solver
from rotorsim.bearing.solve import solve_case
from rotorsim.bearing.whirl import rigid_threshold
from rotorsim.errors import InputError, ScenarioError
from rotorsim.files.scenario import Scenario
from rotorsim.machine.machine import Machine
from rotorsim.machine.map import stability_map
from rotorsim.machine.support import TableSupport
from rotorsim.machine.thresholds import threshold_speeds
from rotorsim.model import LoadTarget, MeshSize
from rotorsim.model.tolerances import ToleranceSettings, parse_spread
from rotorsim.rotor import Rotor
from rotorsim.show.figures import tolerance_histograms
from rotorsim.status import SolveStatus
from rotorsim.study.changes import changed, with_mesh
from rotorsim.study.film_axes import tabulate_over
from rotorsim.study.planes import plane_of_scenario
from rotorsim.study.tolerances import _FilmThreshold, _tolerances_of, study_tolerances

HEAD = f'title = "small"\n{BEARING}'
GROOVE = """\
[[bearing.groove]]
center = "90 deg"
extent = "20 deg"
supply_temperature = "50 degC"
"""
REST = f"""\
{OIL}
[film]
mesh = {{ circumferential = 40, axial = 8, cross_film = 8 }}
{BOTH_MODELS}
[operating]
speed = ["6000 rpm", "9000 rpm", "12000 rpm", "15000 rpm"]
load = "10 kN"
[rotor]
mass = "300 kg"
"""
PLAIN, TEXT = HEAD + REST, HEAD + GROOVE + REST
TOLERANCES = """
[tolerances]
radial_clearance = "8 um"
viscosity = "10 %"
load = { spread = "2 %", distribution = "normal" }
supply_temperature = "3 K"
samples = 32
"""


@pytest.fixture(scope="module")
def scenario():
    return Scenario.from_text(TEXT)


def test_inputs_change_what_they_name_and_nothing_else(scenario):
    case = scenario.case(thermal_model="thd")
    assert changed(case, {}) == case
    assert changed(case, {"radial_clearance": 9e-5}).bearing.radial_clearance == 9e-5
    assert changed(case, {"applied_load": 5e3}).target == LoadTarget(5e3)
    warm = changed(case, {"supply_temperature": 330.0})
    assert warm.thermal.supply_temperature == 330.0
    assert warm.thermal.ambient_temperature == case.thermal.ambient_temperature
    assert [g.supply_temperature for g in warm.bearing.grooves] == [None]
    thick = changed(case, {"viscosity": 1.2})
    for temperature in (300.0, 340.0):
        ratio = thick.lubricant.viscosity(temperature) / case.lubricant.viscosity(temperature)
        assert ratio == pytest.approx(1.2, rel=1e-12)
    assert thick.lubricant.density == case.lubricant.density
    for bad in ({"viscosity": 0.0}, {"speed": 1.0}, {"supply_temperature": 2000.0}):
        with pytest.raises(InputError):
            changed(case, bad)


def test_viscosity_of_a_grade_is_scaled_at_every_temperature():
    text = TEXT[: TEXT.index("viscosity =")] + "iso_vg = 46\n" + TEXT[TEXT.index("density") :]
    case = Scenario.from_text(text).case(thermal_model="thd")
    thin = changed(case, {"viscosity": 0.8}).lubricant
    for temperature in (300.0, 360.0):
        ratio = thin.viscosity(temperature) / case.lubricant.viscosity(temperature)
        assert ratio == pytest.approx(0.8, rel=1e-12)


@pytest.mark.slow
def test_table_over_load_and_temperature_holds_the_films_solved_one_by_one():
    scenario = Scenario.from_text(PLAIN)
    loads, temperatures = [6e3, 12e3], [308.15, 318.15]
    table = tabulate_over(
        scenario, {"applied_load": loads, "supply_temperature": temperatures}, [700.0, 1100.0],
        workers=1,
    )  # fmt: skip
    assert dict(table.dataset.sizes) == {
        "thermal_model": 2, "radial_clearance": 1, "applied_load": 2, "supply_temperature": 2,
        "speed": 2,
    }  # fmt: skip
    assert table.converged.all()
    for load in loads:
        for temperature in temperatures:
            case = changed(
                scenario.case(thermal_model="thd"),
                {"applied_load": load, "supply_temperature": temperature},
            )
            alone, _ = solve_case(case, 1100.0)
            found = table.at(
                1100.0, thermal_model="thd", applied_load=load, supply_temperature=temperature
            )
            assert np.allclose(found.stiffness, alone.stiffness, rtol=1e-4)
            assert found.load == pytest.approx(load, rel=1e-5)
    chart = stability_map(table, [300.0]).plane("applied_load", "supply_temperature", speed=1100.0)
    assert set(chart["verdict"].dims) == {"thermal_model", "applied_load", "supply_temperature"}
    assert set(chart["destabilised_by_heating"].dims) == {"applied_load", "supply_temperature"}


def test_clearance_may_be_any(scenario):
    table = tabulate_over(
        scenario, {"radial_clearance": [8e-5, 1.3e-4]}, [900.0],
        thermal_models=["isothermal"], mesh=MeshSize(36, 6, 6, 4), workers=1,
    )  # fmt: skip
    assert table.dataset["radial_clearance"].values.tolist() == [8e-5, 1.3e-4]
    assert "circumferential 36" in table.dataset.attrs["mesh"]
    assert set(table.dataset["kxx"].dims) == {"thermal_model", "radial_clearance", "speed"}


DAMS = (
    PLAIN
    + """
[[bearing.groove]]
center = "270 deg"
extent = "20 deg"
[[bearing.groove]]
center = "90 deg"
extent = "20 deg"
[[bearing.pocket]]
start = "100 deg"
end = "200 deg"
depth = "80 um"
length = "50 mm"
[[bearing.pocket]]
start = "-60 deg"
end = "60 deg"
depth = "50 um"
length = "10 mm"
"""
)


def test_one_of_a_list_is_named_by_its_number():
    scenario = Scenario.from_text(DAMS)
    found = scenario.replace(**{"bearing.pocket[1].depth": 4e-5}).bearing.pockets
    assert [pocket.depth for pocket in found] == [8e-5, 4e-5]
    for name in ("bearing.pocket.depth", "bearing.pocket[2].depth"):
        with pytest.raises(InputError, match=re.escape("say which, pocket[0] to pocket[1]")):
            scenario.replace(**{name: 4e-5})


def test_table_over_an_entry_holds_the_films_solved_one_by_one():
    scenario, depths = Scenario.from_text(DAMS), [4e-5, 1.2e-4]
    name, mesh = "bearing.pocket[0].depth", MeshSize(48, 12, 6, 4)
    table = tabulate_over(
        scenario, {name: depths}, [900.0], thermal_models=["isothermal"], mesh=mesh, workers=1
    )
    assert table.dataset["kxx"].dims[-2:] == (name, "speed")
    assert table.dataset[name].attrs["units"] == "m"
    for depth in depths:
        other = with_mesh(scenario.replace(**{name: depth}), mesh)
        alone, _ = solve_case(other.case(thermal_model="isothermal"), 900.0)
        found = table.at(900.0, **{name: depth})
        assert np.allclose(found.stiffness, alone.stiffness, rtol=1e-9)


@pytest.mark.parametrize(
    ("y", "values", "said"),
    [
        ("bearing.pocket[0].depth", None, "needs values"),
        ("bearing.radial_clearance", [1e-4, 2e-4], "is called radial_clearance here"),
        ("bearing.pocket.dept", [1e-4, 2e-4], "or an entry of the scenario's file"),
    ],
)
def test_bad_entries_as_axes(y, values, said):
    with pytest.raises(InputError, match=said):
        plane_of_scenario(
            Scenario.from_text(DAMS), "speed", y, {} if values is None else {y: values},
            {"mass": 100.0},
        )  # fmt: skip


@pytest.mark.parametrize(
    "axes", [{"speed": [1.0]}, {"applied_load": [2.0, 1.0]}, {"applied_load": []},
             {"applied_load": [-1.0]}],
)  # fmt: skip
def test_bad_axes(scenario, axes):
    with pytest.raises(InputError):
        tabulate_over(scenario, axes)


@pytest.mark.slow
def test_tolerances_become_a_distribution():
    scenario = Scenario.from_text(PLAIN + TOLERANCES)
    found = study_tolerances(scenario, operating_speed=1385.0, workers=1)
    outputs = found.samples.outputs
    assert found.thermal_model == "thd"
    assert found.samples.failures == ()
    assert all(column.size == 32 for column in found.samples.inputs.values())
    # Nominal values against the table's own way to a threshold.
    speeds = np.linspace(628.0, 1571.0, 9)
    table = tabulate_over(scenario, {}, speeds, thermal_models=["thd"], workers=1)
    machine = Machine.on_identical(Rotor.rigid(300.0), TableSupport(table.interpolator()))
    (nominal,) = threshold_speeds(machine)
    assert found.nominal["threshold_speed"] == pytest.approx(nominal.speed, rel=3e-3)
    point, _ = solve_case(scenario.case(thermal_model="thd"), 1385.0)
    assert found.nominal["critical_mass"] == pytest.approx(point.critical_mass, rel=1e-3)
    # A rotor is unstable where its mass is above the critical one, sample by sample.
    unstable = outputs["growth_rate"] > 0.0
    assert np.array_equal(unstable, outputs["critical_mass"] < 300.0)
    assert found.probability_of_instability == pytest.approx(unstable.mean())
    assert 0.0 < unstable.mean() < 1.0
    assert np.array_equal(unstable, outputs["threshold_speed"] < 1385.0)
    assert found.most_important == "radial_clearance"
    assert found.importance["radial_clearance"] > 0.5  # wider is worse


@pytest.mark.slow
@pytest.mark.parametrize("limit", [1.02e-4, 0.5e-4])
def test_films_that_do_not_converge_are_told_apart(monkeypatch, limit):
    def sometimes(case, speed, **options):
        point, warm = solve_case(case, speed, **options)
        if case.bearing.radial_clearance < limit:
            return point, warm
        return replace(point, status=SolveStatus.NOT_CONVERGED, message="limit reached"), warm

    monkeypatch.setattr(solver, "solve_case", sometimes)
    scenario = Scenario.from_text(PLAIN + TOLERANCES)
    words = "film at 6000 rpm did not converge (not converged: limit reached)"
    if limit < 1e-4:
        with pytest.raises(InputError, match=re.escape(f"without any deviation the {words}")):
            study_tolerances(scenario, thermal_model="isothermal", workers=1)
        return
    study = study_tolerances(scenario, thermal_model="isothermal", workers=1)
    failed = [number for number, _ in study.samples.failures]
    assert failed == list(np.flatnonzero(study.samples.inputs["radial_clearance"] >= limit))
    assert 0 < len(failed) < 32
    assert study.samples.failures[0][1] == f"the {words}"
    figure = tolerance_histograms(study, "pump")
    said = f"{32 - len(failed)} samples; {len(failed)} more did not converge"
    assert figure.get_suptitle() == f"pump\n{said}"
    # The histogram counts what was solved.
    assert "have none" not in figure.axes[1].get_title()
    assert sum(patch.get_height() for patch in figure.axes[1].patches) == pytest.approx(100.0)


def test_thresholds_of_a_sample_are_those_of_its_film():
    scenario = Scenario.from_text(PLAIN)
    case = scenario.case(thermal_model="thd")
    function = _FilmThreshold(case, Rotor.rigid(300.0), 1200.0, (700.0, 1000.0, 1300.0, 1600.0))
    sample = {
        "radial_clearance": 1.1e-4,
        "viscosity": 0.9,
        "load": 9e3,
        "supply_temperature": 315.0,
    }
    found = function(sample)
    same = changed(case, {"applied_load": 9e3, **{k: sample[k] for k in sample if k != "load"}})
    there, _ = solve_case(same, found["threshold_speed"])
    at = rigid_threshold(there.stiffness, there.damping, there.speed)
    assert at.critical_mass == pytest.approx(300.0, rel=2e-3)


def test_spreads_are_read_and_refused():
    scenario = Scenario.from_text(PLAIN + TOLERANCES)
    case = scenario.case(thermal_model="thd")
    found = _tolerances_of(case, scenario.tolerances)
    assert found["load"].kind == "normal"
    assert found["load"].spread == pytest.approx(200.0)
    assert found["viscosity"].nominal == 1.0
    assert found["supply_temperature"].spread == pytest.approx(3.0)
    # As --tolerance gives it; the scenario's own check comes before.
    wide = parse_spread({"spread": "30 %", "distribution": "normal"}, "radial_clearance")
    with pytest.raises(InputError, match="below zero"):
        _tolerances_of(case, ToleranceSettings(radial_clearance=wide))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"8 um"', '"8 kg"', ["tolerances.radial_clearance", "8 kg"]),
        ('"8 um"', '"0 um"', ["tolerances.radial_clearance", "above 0"]),
        ('"8 um"', '"80 %"', ["tolerances.radial_clearance", "50 %"]),
        ('"10 %"', '"1 Pa*s"', ["tolerances.viscosity", "10 %"]),
        ('"3 K"', '"3 %"', ["tolerances.supply_temperature", "3 K"]),
        ('"3 K"', '"3 degC"', ["tolerances.supply_temperature", "delta_degC"]),
        ('"normal"', '"gauss"', ["tolerances.load", '"uniform", "normal"']),
        ("samples = 32", "samples = 2", ["tolerances.samples", "8"]),
        ("samples", "sample", ["tolerances.sample", "samples"]),
        ("viscosity = ", "oil = ", ["tolerances.oil"]),
    ],
)  # fmt: skip
def test_bad_tolerances_name_key_and_value(old, new, words):
    assert old in TOLERANCES
    with pytest.raises(ScenarioError) as caught:
        Scenario.from_text(PLAIN + TOLERANCES.replace(old, new))
    for word in words:
        assert word in str(caught.value)


def test_load_tolerance_needs_a_load():
    text = PLAIN.replace('load = "10 kN"', "eccentricity_ratio = 0.5") + TOLERANCES
    with pytest.raises(ScenarioError, match=r"operating\.load"):
        Scenario.from_text(text)
    with pytest.raises(ScenarioError, match="one input or more"):
        Scenario.from_text(PLAIN + "[tolerances]\nsamples = 16\n")
