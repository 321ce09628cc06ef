"""Heat of the film: its equation, and the balance of what enters and leaves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..model import InletModel
from .energy import EnergyProblem, dissipation
from .flow import FilmFlow, film_flow
from .inlets import carriers, layer_flux, mixed
from .kernels import kernel
from .operator import WEST, neighbour
from .problem import FilmProblem, FilmState
from .walls import FilmContact, Walls


@dataclass(frozen=True)
class Heat:
    """Temperatures of the film and its walls.

    temperature : (n, m, k) array [K]
    bush : (n, m) array. Of the bore [K].
    shaft : [K]
    """

    temperature: Array
    bush: Array
    shaft: float


@dataclass(frozen=True)
class HeatBalance:
    """Heat flows that carry off the film's dissipation [W], of the whole bearing."""

    dissipation: float
    enthalpy_out: float
    to_bush: float
    to_shaft: float

    @property
    def remainder(self) -> float:
        """Heat that is not accounted for [W]."""
        return self.dissipation - self.enthalpy_out - self.to_bush - self.to_shaft

    @property
    def imbalance(self) -> float:
        """The remainder relative to the dissipation [-]."""
        return self.remainder / self.dissipation if self.dissipation else 0.0

    @property
    def wall_share(self) -> float:
        """(bush + shaft)/dissipation [-]: what the oil does not carry off."""
        return (self.to_bush + self.to_shaft) / self.dissipation if self.dissipation else 0.0

    @property
    def turnover(self) -> float:
        """All heat that enters the film, dissipated, with warm oil or from warm walls [W]."""
        others = (self.enthalpy_out, self.to_bush, self.to_shaft)
        return self.dissipation + sum(max(-power, 0.0) for power in others)


def energy_problem(problem: FilmProblem, state: FilmState) -> EnergyProblem:
    """Build the energy equation of the film `state`."""
    flow = film_flow(state)
    layers = state.layers.pressure_share.shape[2]
    oil = problem.lubricant
    conductance = (
        oil.thermal_conductivity
        * flow.liquid_fraction
        * state.operator.area
        / state.center_thickness
        * layers
        * ~state.operator.fixed
    )
    m = problem.mesh.shape[1]
    axial_order = np.arange(m)
    if not problem.mesh.half:
        axial_order = np.argsort(np.abs(problem.mesh.y), kind="stable")
    return EnergyProblem(
        flow=flow,
        layers=state.layers,
        heating=dissipation(
            state.operator, state.center_thickness, state.layers, flow, problem.surface_speed
        ),
        carry_over=_carry_over(problem, state, flow),
        conductance=conductance,
        heat_capacity=oil.density * oil.specific_heat,
        order=_march_order(problem, flow),
        axial_order=axial_order,
        fixed=state.operator.fixed,
        interior=state.operator.interior,
        dx=state.operator.dx,
        dy=state.operator.dy,
    )


def _carry_over(problem: FilmProblem, state: FilmState, flow: FilmFlow) -> Array:
    """Return the part of the oil entering each column that comes from the one before.

    Zero where new oil enters. A film that re-forms behind the inception of its own stretch goes on
    with the oil that the ruptured film brought, as far as that reaches: otherwise fresh oil would
    come and go with every cell that ruptures there, and no temperature field would satisfy it.
    """
    part = np.where(flow.inlet, 0.0, 1.0)
    if problem.thermal.inlet is InletModel.PERIODIC:
        return np.where(np.roll(state.operator.fixed, 1, axis=0), part, 1.0)
    if problem.mesh.slot.any() or problem.bearing.grooves:
        part = np.where(flow.inlet & state.operator.interior[WEST], 1.0, part)
    return part


def _march_order(problem: FilmProblem, flow: FilmFlow) -> NDArray[np.int64]:
    """Order the columns from the one where most lines take in new oil, with the rotation."""
    entering = flow.inlet.sum(axis=1)
    first = int(np.argmax(entering)) if entering.any() else 0
    n = problem.mesh.shape[0]
    return (first + np.arange(n)) % n


def dissipated_power(energy: EnergyProblem) -> float:
    """Return the power that the film turns into heat, over the meshed part [W]."""
    # Summed over the layers: int (z - G)^2/mu = F_2, int (z - G)/mu = 0, int 1/mu = F_0.
    layers = energy.layers
    heating = energy.heating
    power = heating[0] * layers.f0 + heating[2] * layers.f2 + heating[3] * layers.f2_axial
    if layers.turbulent is not None:
        power += heating[1] * 0.5 * layers.f0 * (layers.g - layers.turbulent.g_tangent)
    return float(np.sum(power))


def heat_balance(
    problem: FilmProblem,
    energy: EnergyProblem,
    heat: Heat,
    walls: Walls,
    inlet_temperature: Array,
    leaving_temperature: Array,
) -> HeatBalance:
    """Return where the dissipated power goes, over both halves."""
    times, film = problem.mesh.multiplicity, heat.temperature
    enthalpy = _enthalpy_out(energy, film, inlet_temperature, leaving_temperature)
    to_bush = walls.bush.heat(heat.bush, FilmContact.bush(energy, film))
    to_shaft = walls.shaft.heat(heat.shaft, FilmContact.shaft(energy, film))
    return HeatBalance(
        dissipation=times * dissipated_power(energy),
        enthalpy_out=times * energy.heat_capacity * enthalpy,
        to_bush=times * float(to_bush.sum()),
        to_shaft=times * float(to_shaft.sum()),
    )


def loss_per_degree(problem: FilmProblem, energy: EnergyProblem, walls: Walls) -> float:
    """Return the heat that a film one degree warmer loses to oil and bush, estimated [W/K].

    Oil that comes round brings its heat back through the inlets.
    """
    n, m, layers = energy.layers.pressure_share.shape
    warmer = np.ones((n, m, layers))
    back = np.zeros((4, n, m))
    if problem.thermal.inlet is InletModel.MIXING:
        back = mixed(problem, energy, warmer, back)
    oil = _enthalpy_out(energy, warmer, back, np.stack([warmer, warmer]))
    to_bush = 0.0
    if not walls.bush.insulated:
        to_bush = 4.0 * float(energy.conductance.sum()) / layers
    return max(energy.heat_capacity * oil, 0.0) + to_bush


def _enthalpy_out(
    energy: EnergyProblem, temperature: Array, inlet_temperature: Array, leaving: Array
) -> float:
    """Return the enthalpy flow out of the film over rho c_p [m3 K/s].

    Through all faces behind which no film lies.
    """
    entering = inlet_temperature
    if entering.ndim == 3:
        entering = entering[:, :, :, None]
    return float(
        _carried_out(
            temperature, entering, leaving, energy.carry_over, energy.fixed, *carriers(energy)
        )
    )


@kernel
def _carried_out(
    temperature, entering, leaving, carry_over, fixed, poiseuille, couette, shared, interior,
    inlet, along, axial, shear,
):  # fmt: skip
    n, m, layers = temperature.shape
    layered, total = entering.shape[3] > 1, 0.0
    for face in range(4):
        outwards = -1.0 if face % 2 == 0 else 1.0
        for i in range(n):
            before, after = i - 1 if i > 0 else n - 1, i + 1 if i < n - 1 else 0
            for j in range(m):
                if face == 0:
                    open_ = inlet[i, j]
                else:
                    open_ = not interior[face, i, j] or (face == 1 and inlet[after, j])
                    open_ = open_ and not fixed[i, j]
                if not open_:
                    continue
                far_i, far_j = neighbour(face, i, j, n, m)
                for k in range(layers):
                    flux = outwards * layer_flux(
                        face, i, j, far_i, far_j, k, poiseuille, couette, shared, interior, inlet,
                        along, axial, shear,
                    )  # fmt: skip
                    if flux <= 0.0:
                        warmth = entering[face, i, j, k if layered else 0]
                        if face == 0:
                            part = carry_over[i, j]
                            warmth = part * leaving[0, before, j, k] + (1.0 - part) * warmth
                    elif face == 0:
                        warmth = temperature[i, j, k]
                    else:
                        warmth = leaving[face // 2, i, j, k]
                    total += flux * warmth
    return total
