"""Solids that store heat: a lumped shaft's exponential, energy over time, end states, events."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from film_cases import DAL_OIL, thermal_case

import rotorsim as rs
from rotorsim.bearing.solve import solve_case
from rotorsim.bearing.transient import solve_transient
from rotorsim.errors import ScenarioError
from rotorsim.film.storage import HeatStorage, _carried
from rotorsim.model import Bearing, ExponentialViscosity, LoadTarget, Lubricant
from rotorsim.model.expansion import Expansion
from rotorsim.model.transient import ShaftMaterial, SolidMaterial
from rotorsim.study.transient import simulate_transient

SPEED, RADIUS, LENGTH, OUTER = 300.0, 0.05, 0.08, 0.075
BUSH = Bearing(RADIUS, LENGTH, 100e-6, bush_outer_radius=OUTER)
MESH = (32, 8, 8)
AMBIENT, TRANSFER, CONDUCTIVITY = 303.15, 80.0, 50.0
WARM = {
    "inlet": "mixing", "shaft": "insulated", "bush": "conduction",
    "bush_conductivity": CONDUCTIVITY, "bush_heat_transfer": TRANSFER,
    "ambient_temperature": AMBIENT, "supply_temperature": 313.15,
}  # fmt: skip
STEEL = HeatStorage(ShaftMaterial(), SolidMaterial())


def _lumped():
    """A shaft that conducts ideally in an oil that does not thin: dT/dt = (T_end - T)/tau."""
    oil = Lubricant(ExponentialViscosity(0.02, 313.15, 0.0), 860.0, 2000.0, 0.13)
    walls = {"bush": "ambient", "ambient_temperature": 313.15, "supply_temperature": 313.15}
    heats = []
    for temperature in (313.15, 333.15):
        case = thermal_case(bearing=BUSH, oil=oil, mesh=MESH, shaft=temperature, **walls)
        heats.append(solve_case(case, SPEED)[0].heat_balance.to_shaft)
    conductance = (heats[0] - heats[1]) / 20.0
    material = ShaftMaterial(conductivity=1e5)
    capacity = material.capacity * math.pi * RADIUS**2 * LENGTH
    case = thermal_case(bearing=BUSH, oil=oil, mesh=MESH, shaft="insulated", **walls)
    end = 313.15 + heats[0] / conductance
    return case, HeatStorage(material, SolidMaterial()), capacity / conductance, end


@pytest.mark.slow
def test_lumped_shaft_warms_with_its_time_constant_in_second_order():
    case, storage, tau, end = _lumped()
    errors = []
    for step in (0.05 * tau, 0.025 * tau):
        moments = list(
            solve_transient(lambda _: (case, SPEED), storage, 2.0 * tau, start=313.15, step=step)
        )
        exact = end - (end - 313.15) * np.exp(-np.array([m.time for m in moments]) / tau)
        found = np.array([m.shaft_temperature for m in moments])
        errors.append(float(np.abs(found - exact).max()) / (end - 313.15))
    assert errors[1] < 1e-3
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.3)
    adaptive = list(
        solve_transient(lambda _: (case, SPEED), storage, 2.0 * tau, start=313.15, tolerance=0.02)
    )
    exact = end - (end - 313.15) * np.exp(-np.array([m.time for m in adaptive]) / tau)
    found = np.array([m.shaft_temperature for m in adaptive])
    assert np.abs(found - exact).max() < 0.1


def _bush_loss(field: np.ndarray) -> float:
    """Heat that the bush gives to its surroundings [W], of a field over the half length."""
    n, m, layers = field.shape
    dr, dy, dtheta = (OUTER - RADIUS) / layers, 0.5 * LENGTH / m, 2.0 * math.pi / n
    r = RADIUS + (np.arange(layers) + 0.5) * dr
    around = (field[:, :, -1] - AMBIENT) / (0.5 * dr / CONDUCTIVITY + 1.0 / TRANSFER)
    ends = (field[:, -1] - AMBIENT) / (0.5 * dy / CONDUCTIVITY + 1.0 / TRANSFER)
    return 2.0 * float(np.sum(around) * OUTER * dtheta * dy + np.sum(ends * r) * dr * dtheta)


@pytest.mark.slow
def test_energy_over_time_and_the_steady_state_at_the_end():
    expansion = Expansion(shaft=14e-6)
    case = thermal_case(
        LoadTarget(8e3), bearing=BUSH, oil=DAL_OIL, mesh=MESH, expansion=expansion, **WARM
    )
    moments = list(
        solve_transient(lambda _: (case, SPEED), STEEL, 4000.0, start=293.15, tolerance=0.05)
    )
    assert all(moment.point.converged for moment in moments)
    last = moments[-1].point
    steady, _ = solve_case(case, SPEED)
    assert last.shaft_temperature == pytest.approx(steady.shaft_temperature, abs=0.1)
    assert last.max_temperature == pytest.approx(steady.max_temperature, abs=0.1)
    assert last.hot_radial_clearance == pytest.approx(steady.hot_radial_clearance, rel=1e-3)
    assert last.stiffness == pytest.approx(steady.stiffness, rel=0.01, abs=1e5)

    early = [moment for moment in moments if moment.time < 400.0]
    time = np.array([moment.time for moment in early])
    balances = [moment.point.heat_balance for moment in early]
    made = np.trapezoid([b.dissipation for b in balances], time)
    oil = np.trapezoid([b.enthalpy_out for b in balances], time)
    (field,) = early[-1].state.solids
    # cells of the mesh around are not of one size: the mean over theta is what counts
    faces = early[-1].state.faces[0]
    mean = np.einsum("i,ijl->jl", np.diff(faces), field) / (2.0 * math.pi)
    r = RADIUS + (np.arange(field.shape[2]) + 0.5) * (OUTER - RADIUS) / field.shape[2]
    bush_volume = math.pi * (OUTER**2 - RADIUS**2) * LENGTH
    in_bush = SolidMaterial().capacity * bush_volume * np.average(mean - 293.15, axis=1, weights=r)
    shaft = ShaftMaterial().capacity * math.pi * RADIUS**2 * LENGTH
    stored = float(in_bush.mean()) + shaft * (early[-1].shaft_temperature - 293.15)
    means = [
        np.einsum("i,ijl->jl", np.diff(m.state.faces[0]), m.state.solids[0]) / (2.0 * math.pi)
        for m in early
    ]
    lost = np.trapezoid([_bush_loss(one[None]) for one in means], time)
    assert stored > 0.03 * made
    assert oil + stored + lost == pytest.approx(made, rel=0.005)


def test_a_field_is_carried_to_another_mesh_by_its_harmonics():
    old = np.sort(np.concatenate([[0.0, 2.0 * math.pi], 2.0 * math.pi * np.arange(1, 60) / 60.3]))
    new = np.linspace(0.3, 0.3 + 2.0 * math.pi, 41)

    def means(faces):
        integral = 3.0 * faces + 2.0 * np.sin(faces) - 0.5 * np.cos(4.0 * faces)
        return (np.diff(integral) / np.diff(faces))[:, None, None]

    assert _carried(means(old), old, new) == pytest.approx(means(new), abs=1e-9)


TEXT = """
[bearing]
journal_radius = "50 mm"
length = "80 mm"
radial_clearance = "100 um"
bush_outer_radius = "75 mm"
[lubricant]
iso_vg = 32
density = "860 kg/m^3"
specific_heat = "2000 J/(kg*delta_degC)"
thermal_conductivity = "0.13 W/(m*delta_degC)"
[film]
mesh = { circumferential = 32, axial = 8, cross_film = 8, bush_radial = 4 }
[thermal]
models = "thd"
inlet = "mixing"
shaft = "insulated"
bush = "conduction"
ambient_temperature = "30 degC"
supply_temperature = "40 degC"
bush_conductivity = "50 W/(m*delta_degC)"
bush_heat_transfer = "80 W/(m^2*delta_degC)"
expansion = { bush_fit = { stiffness = "5 GN/m" } }
[operating]
speed = "3000 rpm"
load = "8 kN"
[rotor]
mass = "800 kg"
[transient]
duration = "60 s"
tolerance = "0.5 K"
"""


@pytest.mark.slow
def test_events_of_a_scenario():
    text = TEXT + (
        'start = "steady"\n'
        '[[transient.event]]\nat = "10 s"\nload = "12 kN"\n'
        '[[transient.event]]\nat = "20 s"\nover = "10 s"\nspeed = "6000 rpm"\n'
        '[[transient.event]]\nat = "40 s"\nsupply = false\n'
    )
    found = simulate_transient(rs.Scenario.from_text(text))
    assert found.converged
    assert found.time[-1] == 60.0
    steady = rs.solve(rs.Scenario.from_text(TEXT))
    first = found.points[0]
    assert first.shaft_temperature == pytest.approx(steady.shaft_temperature, abs=0.01)
    assert first.stiffness == pytest.approx(steady.stiffness, rel=0.01, abs=1e5)
    load, speed = found.values("load"), found.values("speed")
    at = found.time
    assert load[at < 10.0] == pytest.approx(8e3, rel=1e-5)
    assert load[at > 10.0] == pytest.approx(12e3, rel=1e-5)
    assert sorted(load[at == 10.0]) == pytest.approx([8e3, 12e3], rel=1e-5)
    ramp = (at >= 20.0) & (at <= 30.0)
    assert speed[ramp] == pytest.approx(np.pi * (100.0 + 10.0 * (at[ramp] - 20.0)), rel=1e-6)
    before = found.values("max_temperature")[at <= 40.0].max()
    assert found.values("max_temperature")[-1] > before + 10.0  # nothing cools the oil
    said = found.describe()
    worst = said["moments"]["least_film"]
    assert worst["min_film_thickness"] == pytest.approx(found.values("min_film_thickness").min())
    lost = found.points[int(np.flatnonzero(at == 40.0)[-1])]
    bearing = rs.Scenario.from_text(TEXT).bearing
    gap = 2.0 * np.pi * bearing.journal_radius * bearing.length * lost.running_clearance
    assert said["drained_in"] == pytest.approx(gap / lost.side_flow, rel=0.02)
    assert "run dry" in said["verdict"]


def test_what_a_transient_refuses():
    for change, key in (
        (('models = "thd"', 'models = "isothermal"'), "thermal.models"),
        (('load = "8 kN"', "eccentricity_ratio = 0.5"), "transient.event[0].load"),
        (('at = "10 s"', 'at = "100 s"'), "transient.event[0].at"),
    ):
        text = TEXT + '[[transient.event]]\nat = "10 s"\nload = "9 kN"\n'
        with pytest.raises(ScenarioError) as error:
            rs.Scenario.from_text(text.replace(*change))
        assert error.value.key == key
    with pytest.raises(ScenarioError):
        rs.Scenario.from_text(TEXT + 'initial_temperature = "20 degC"\nstart = "steady"\n')
    assert replace(ShaftMaterial(), length=0.1).capacity == 7850.0 * 460.0
