"""The film's 3-D energy equation, marched with the flow (Dal Eq. 10, corrected).

Finite volumes on the layers of the film: every layer of a cell exchanges the very oil that the
pressure equation moves, so the flux across the film vanishes on both walls to rounding and enthalpy
is conserved. Convection along the film is second-order upwind, across it hybrid (central where
conduction governs); conduction acts across the film. One tridiagonal solve a cell, in the order of
the flow, solves everything in one pass where nothing flows back; a few passes where it does.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Booleans
from .flow import FilmFlow
from .kernels import kernel
from .layers import LayerIntegrals
from .operator import FilmOperator


@dataclass(frozen=True)
class WallTemperatures:
    """Both walls [K]; an insulated wall takes no heat at all.

    bush : (n, m) array
    shaft : float or (n, m) array
    """

    bush: NDArray[Any]
    shaft: float | NDArray[Any]
    bush_insulated: bool = False


@dataclass(frozen=True)
class EnergyProblem:
    """Everything in the energy equation but the temperature: linear in it.

    heating : (4, n, m) array. Multipliers of the parts of the dissipation of a layer (see
        `dissipation`).
    carry_over : (n, m) array. Part of the oil entering through the west face that comes from the
        column before; the rest has the inlet's temperature.
    conductance : (n, m) array. k (liquid area)/(h dz): between neighbouring layers [W/K].
    heat_capacity : rho c_p [J/(m3 K)].
    order : (n,) int array. Columns in the order of the march.
    axial_order : (m,) int array. From where the flow along the axis starts, outwards.
    fixed : (n, m) bool array
    interior : (4, n, m) bool array
    dx, dy : arrays. Cell lengths [m].
    """

    flow: FilmFlow
    layers: LayerIntegrals
    heating: Array
    carry_over: Array
    conductance: Array
    heat_capacity: float
    order: NDArray[np.int64]
    axial_order: NDArray[np.int64]
    fixed: Booleans
    interior: Booleans
    dx: Array
    dy: Array

    def wall_conductance(self, layer: int) -> Array:
        """Return conductance [W/K] from bush (layer 0) or shaft (-1) to the layer beside it."""
        turbulent = self.layers.turbulent
        eddies = 1.0 if turbulent is None else turbulent.conduction[:, :, layer]
        return 2.0 * self.conductance * eddies


def dissipation(
    operator: FilmOperator,
    thickness: Array,
    layers: LayerIntegrals,
    flow: FilmFlow,
    surface_speed: float,
) -> Array:
    """Return the multipliers of a layer's dissipation, per cell: (4, n, m).

    The shear stress is tau = h p' (z - G) + U/(h F_0) around and h p' (z - G) along the axis; the
    power in a layer, int h tau^2/mu dz over the cell, is thus

        D = s_0 int dz/mu + s_1 int (z - G)/mu dz + (s_2 + s_3) int (z - G)^2/mu dz

    with s_2 from the pressure gradient along the motion, s_3 from that along the axis. In a
    turbulent film, tau du/dz of the flow linearised about Couette flow: mu (1 + eps) stands under
    s_0 and s_3, the tangent viscosity mu_t with its own G under s_2, and under s_1 the mean of both
    fluidities.

    The squared gradients are taken face by face with the pressure equation's own differences and
    shared between the cells behind the face, so that the sum over the film equals the shaft's
    friction power exactly (discrete Green's identity).
    """
    heating = np.zeros((4, *operator.area.shape))
    _heating(
        operator.interior, operator.conductance, operator.face_thickness, operator.spacing,
        operator.fixed, operator.area, operator.dx, operator.dy, thickness, layers.f0,
        flow.step, flow.liquid_fraction, surface_speed, heating,
    )  # fmt: skip
    if operator.steps is not None:
        power, at = operator.steps.half_losses(flow.liquid_fraction >= 1.0), operator.steps.at[1:]
        np.add.at(heating[2], at, power / layers.f2[at])
    return heating


@kernel
def _heating(
    interior, conductance, face_h, spacing, fixed, area, dx, dy, h, f0, step, fraction, speed,
    heating,
):  # fmt: skip
    n, m = area.shape
    for i in range(n):
        for j in range(m):
            if fixed[i, j]:
                continue
            for face in range(4):
                if conductance[face, i, j] == 0.0:
                    continue
                share = 0.5 if interior[face, i, j] else 1.0
                width = dy[j] if face < 2 else dx[i]
                thickness, rise = face_h[face, i, j], step[face, i, j]
                # int over the face's reach of h^3 p'^2, and of h p'
                part = 2 if face < 2 else 3
                heating[part, i, j] += (
                    share * thickness**3 * rise * rise * width / spacing[face, i, j]
                )
                if face < 2:
                    heating[1, i, j] += 2.0 * speed * share * thickness * rise * width / f0[i, j]
            heating[0, i, j] = (
                fraction[i, j] * speed * speed * area[i, j] / (h[i, j] * f0[i, j] ** 2)
            )


def march(
    problem: EnergyProblem,
    viscosity: Array,
    walls: WallTemperatures,
    inlet_temperature: NDArray[Any],
    temperature: NDArray[Any],
    *,
    passes: int = 1,
    source: NDArray[Any] | None = None,
    storage: NDArray[Any] | None = None,
    swelling: Array | None = None,
    leaving: NDArray[Any] | None = None,
) -> tuple[float, NDArray[Any]]:
    """Solve for the temperature in place; real, or complex throughout for harmonic ones.

    viscosity : (n, m, k) array. [Pa s]
    inlet_temperature : (4, n, m) or (4, n, m, k) array. Of the oil that enters through a face
        behind which no film lies [K].
    temperature : (n, m, k) array. First guess, overwritten [K].
    passes : Sweeps; one is exact where nothing flows back.
    source : (n, m, k) array. Further heat [W].
    storage : (n, m) array. Heat that a layer takes up per degree [W/K]: i omega times its capacity
        where temperatures vary as exp(i omega t).
    swelling : (n, m) array. rho c_p times the rate at which the oil in a film grows [W/K].
    leaving : (2, n, m, k) array. What a march over a neighbouring field returned; needed where a
        cell is visited before the one upstream of it, overwritten.
    Returns float: The last pass's largest change [K].
    Returns (2, n, m, k) array: Temperature of the oil that leaves each layer along the film and
        along the axis [K].
    """
    change = 0.0
    if leaving is None:
        # Temperature of the oil that leaves each cell along the film and along the axis.
        leaving = np.stack([temperature, temperature])
    for _ in range(passes):
        change = _pass(
            problem, viscosity, walls, inlet_temperature, temperature, leaving, source, storage,
            swelling, np.empty((0, 0, 0), temperature.dtype),
        )  # fmt: skip
    return change, leaving


def missing_heat(
    problem: EnergyProblem,
    viscosity: Array,
    walls: WallTemperatures,
    inlet_temperature: Array,
    temperature: Array,
    swelling: Array,
) -> Array:
    """Return what each layer takes up at `temperature` [W], (n, m, k); 0 in a steady film.

    swelling : See `march`.
    """
    missing = np.zeros(temperature.shape)
    leaving = np.stack([temperature, temperature])
    for _ in range(2):  # the first one finds what leaves each cell
        _pass(
            problem, viscosity, walls, inlet_temperature, temperature, leaving, None, None,
            swelling, missing,
        )  # fmt: skip
    return missing


def _pass(
    problem: EnergyProblem, viscosity: Array, walls: WallTemperatures, inlet: NDArray[Any],
    temperature: NDArray[Any], leaving: NDArray[Any], source: NDArray[Any] | None,
    storage: NDArray[Any] | None, swelling: Array | None, missing: NDArray[Any],
) -> float:  # fmt: skip
    flow, layers, kind = problem.flow, problem.layers, temperature.dtype
    extra = np.zeros((1, 1, 1), kind) if source is None else source
    stored = np.empty((0, 0), kind) if storage is None else storage
    growing = np.empty((0, 0)) if swelling is None else swelling / temperature.shape[2]
    turbulent = layers.turbulent
    axial = layers.pressure_share if turbulent is None else turbulent.axial_share
    heat_share = np.empty((4, 0, 0, 0)) if turbulent is None else turbulent.heat_share
    conduction = np.empty((0, 0, 0)) if turbulent is None else turbulent.conduction
    if inlet.ndim == 3:
        inlet = inlet[:, :, :, None]
    shaft = np.full(walls.bush.shape, walls.shaft, kind)
    return _sweep(
        flow.poiseuille, flow.couette, flow.shared, flow.inlet, problem.carry_over,
        layers.pressure_share, axial, layers.shear_share, layers.g, viscosity, heat_share,
        conduction, problem.heating, problem.conductance, problem.heat_capacity, problem.order,
        problem.axial_order, problem.fixed, problem.interior, problem.dx, problem.dy, walls.bush,
        shaft, walls.bush_insulated, inlet, extra, stored, growing, missing, temperature, leaving,
    )  # fmt: skip


@kernel
def _sweep(
    poiseuille, couette, shared, inlet, carry_over, pressure_share, axial_share, shear_share, g,
    viscosity, heat_share, conduction, heating, conductance, heat_capacity, order, axial_order,
    fixed, interior, dx, dy, bush, shaft, bush_insulated, inlet_temperature, extra, stored,
    swelling, missing, temperature, leaving,
):  # fmt: skip
    n, m, layers = temperature.shape
    dz = 1.0 / layers
    lower, upper = np.empty(layers), np.empty(layers)
    diagonal, right = np.empty(layers, temperature.dtype), np.empty(layers, temperature.dtype)
    slope = np.empty(2 * layers, temperature.dtype)
    slope[0] = 0.0
    zero, largest = slope[0], 0.0  # of the temperature's kind, real or complex
    layered = 1 if inlet_temperature.shape[3] == layers else 0
    with_extra, with_stored = extra.shape[0] == n, stored.shape[0] == n
    growing, asked = swelling.shape[0] == n, missing.shape[0] == n
    turbulent = conduction.shape[0] == n
    for c in range(n):
        i = order[c]
        before = i - 1 if i > 0 else n - 1
        after = i + 1 if i < n - 1 else 0
        for s in range(m):
            j = axial_order[s]
            if fixed[i, j] or conductance[i, j] == 0.0:  # a groove, or no oil at all
                continue
            south, north = max(j - 1, 0), min(j + 1, m - 1)
            # Weights of the extrapolation from centre to the face downstream, where this cell and
            # the one upstream are joined.
            along_w, south_w, north_w = 0.0, 0.0, 0.0
            if interior[0, i, j] and not inlet[i, j]:
                along_w = dx[i] / (dx[i] + dx[before])
            if interior[2, i, j]:
                south_w = dy[j] / (dy[j] + dy[south])
            if interior[3, i, j]:
                north_w = dy[j] / (dy[j] + dy[north])
            g_w, g_e = poiseuille[0, i, j], poiseuille[1, i, j]
            g_s, g_n = poiseuille[2, i, j], poiseuille[3, i, j]
            c_w, c_e = couette[0, i, j], couette[1, i, j]
            passed_w = (not shared[0, i, j]) and interior[0, i, j]
            kz = conductance[i, j]
            rising = 0.0
            ratio = g[i, j]
            for k in range(layers):
                a_own, b_own = pressure_share[i, j, k], shear_share[i, j, k]
                if shared[0, i, j]:
                    q_w = 0.5 * (
                        g_w * (a_own + pressure_share[before, j, k])
                        + c_w * (b_own + shear_share[before, j, k])
                    )
                elif passed_w:
                    q_w = c_w * shear_share[before, j, k]
                else:
                    q_w = g_w * a_own + c_w * b_own
                if shared[1, i, j]:
                    q_e = 0.5 * (
                        g_e * (a_own + pressure_share[after, j, k])
                        + c_e * (b_own + shear_share[after, j, k])
                    )
                else:
                    q_e = g_e * a_own + c_e * b_own
                a_own = axial_share[i, j, k]
                q_s = g_s * a_own
                if shared[2, i, j]:
                    q_s = 0.5 * (q_s + g_s * axial_share[i, south, k])
                q_n = g_n * a_own
                if shared[3, i, j]:
                    q_n = 0.5 * (q_n + g_n * axial_share[i, north, k])
                q_w *= heat_capacity
                q_e *= heat_capacity
                q_s *= heat_capacity
                q_n *= heat_capacity
                center, rhs = zero, zero
                ahead, ahead_from = 0.0, zero
                aside, aside_from = 0.0, zero
                if q_w > 0.0:
                    center += q_w
                    part = carry_over[i, j]
                    if part > 0.0:
                        rhs += q_w * part * leaving[0, before, j, k]
                    if part < 1.0:
                        rhs += q_w * (1.0 - part) * inlet_temperature[0, i, j, k * layered]
                if q_e <= 0.0:
                    center -= q_e
                    if interior[1, i, j]:
                        rhs -= q_e * temperature[after, j, k]
                    else:
                        rhs -= q_e * inlet_temperature[1, i, j, k * layered]
                elif q_w > 0.0:
                    # The weight fades with what enters from upstream: no jump where flow turns.
                    ahead = along_w * min(1.0, q_w / q_e)
                    ahead_from = temperature[before, j, k]
                    center += q_e * ahead
                    rhs += q_e * ahead * ahead_from
                if q_s > 0.0:
                    center += q_s
                    if interior[2, i, j]:
                        rhs += q_s * leaving[1, i, south, k]
                    else:
                        rhs += q_s * inlet_temperature[2, i, j, k * layered]
                    if q_n > 0.0:
                        aside = south_w * min(1.0, q_s / q_n)
                        aside_from = temperature[i, south, k]
                        center += q_n * aside
                        rhs += q_n * aside * aside_from
                if q_n < 0.0:
                    center -= q_n
                    if interior[3, i, j]:
                        rhs -= q_n * leaving[1, i, north, k]
                    else:
                        rhs -= q_n * inlet_temperature[3, i, j, k * layered]
                    if q_s < 0.0:
                        aside = north_w * min(1.0, q_n / q_s)
                        aside_from = temperature[i, north, k]
                        center -= q_s * aside
                        rhs -= q_s * aside * aside_from
                # Kept until the column is solved: face value = T + w (T - T_from).
                leaving[0, i, j, k], slope[k] = ahead, ahead_from
                leaving[1, i, j, k], slope[layers + k] = aside, aside_from
                # dissipation in the layer
                k_low, k_high = kz, kz
                if turbulent:
                    k_low *= conduction[i, j, k]
                    k_high *= conduction[i, j, k + 1]
                    rhs += (
                        heating[0, i, j] * heat_share[0, i, j, k]
                        + heating[1, i, j] * heat_share[1, i, j, k]
                        + heating[2, i, j] * heat_share[2, i, j, k]
                        + heating[3, i, j] * heat_share[3, i, j, k]
                    )
                else:
                    fluidity = 1.0 / viscosity[i, j, k]
                    z0 = k * dz - ratio
                    z1 = z0 + dz
                    rhs += fluidity * (
                        (heating[2, i, j] + heating[3, i, j]) * (z1 * z1 * z1 - z0 * z0 * z0) / 3.0
                        + heating[1, i, j] * 0.5 * (z1 * z1 - z0 * z0)
                        + heating[0, i, j] * dz
                    )
                if with_extra:
                    rhs += extra[i, j, k]
                # across the film: rising is what enters from the layer below
                a_below = 0.0
                if k > 0:
                    a_below = max(rising, k_low + 0.5 * rising, 0.0)
                elif not bush_insulated:
                    center += 2.0 * k_low
                    rhs += 2.0 * k_low * bush[i, j]
                rising += q_w - q_e + q_s - q_n
                if growing:
                    rising -= swelling[i, j]
                if with_stored:
                    center += stored[i, j]
                a_above = 0.0
                if k < layers - 1:
                    a_above = max(-rising, k_high - 0.5 * rising, 0.0)
                else:
                    center += 2.0 * k_high
                    rhs += 2.0 * k_high * shaft[i, j]
                lower[k] = -a_below
                upper[k] = -a_above
                diagonal[k] = center + a_below + a_above
                right[k] = rhs
            if asked:
                for k in range(layers):
                    held = diagonal[k] * temperature[i, j, k]
                    if k > 0:
                        held += lower[k] * temperature[i, j, k - 1]
                    if k < layers - 1:
                        held += upper[k] * temperature[i, j, k + 1]
                    missing[i, j, k] = right[k] - held
                    for axis in range(2):
                        value = temperature[i, j, k]
                        weight = leaving[axis, i, j, k]
                        leaving[axis, i, j, k] = value + weight * (value - slope[axis * layers + k])
                continue
            # Thomas
            for k in range(1, layers):
                factor = lower[k] / diagonal[k - 1]
                diagonal[k] -= factor * upper[k - 1]
                right[k] -= factor * right[k - 1]
            value = 0.0
            for k in range(layers - 1, -1, -1):
                above = upper[k] * value if k < layers - 1 else 0.0
                value = (right[k] - above) / diagonal[k]
                largest = max(largest, abs(value - temperature[i, j, k]))
                temperature[i, j, k] = value
                weight = leaving[0, i, j, k]
                leaving[0, i, j, k] = value + weight * (value - slope[k])
                weight = leaving[1, i, j, k]
                leaving[1, i, j, k] = value + weight * (value - slope[layers + k])
    return largest
