"""Eddy viscosity across the film: Reichardt's law of the wall in Dowson's integrals.

The film's resistance to shear is mu (1 + eps), eps = kappa [x - d tanh(x/d)], with the distance
from the nearer wall x = z sqrt(rho tau)/mu, the shear stress tau of the Couette flow and each
layer's own viscosity (Ng, ASLE Trans. 7, 1964; Elrod & Ng, J. Lubr. Technol. 89, 1967). A pressure
gradient changes tau along the motion, and with it eps: there its flow meets the tangent viscosity,
1/mu_t = d(du/dz)/d(tau) = (1 - d ln(1 + eps)/d ln(tau))/(mu (1 + eps)); across it mu (1 + eps).

In a layer of constant viscosity eps depends on z and s = h sqrt(rho tau)/mu alone: its moments
M_n(s) = int z^n/(1 + eps) dz are tabulated over ln(s), with their derivatives, for every layer of
the mesh. Those of the tangent viscosity are M_n + (1/2) dM_n/d ln(s). tau solves U = tau h F_0(tau)
in every column.

Laminar and turbulent fluidity are mixed, (1 - w)/mu + w/(mu (1 + eps)), with w rising from 0 to 1
over the transition. A bulk law scales the turbulent moments to its own k_x, k_y and shear. All
rates d/d ln(h) are exact at given viscosity.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from ..arrays import Array
from .kernels import kernel

KAPPA, SUBLAYER = 0.4, 10.7
"""Reichardt's kappa and d (Ng 1964)."""
TURBULENT_PRANDTL = 0.9
"""Eddy viscosity over eddy diffusivity of heat (Kays, J. Heat Transfer 116, 1994)."""
_LAST, _INTERVALS = 214.0, 4096
"""x up to which int x^n/(1 + eps) is summed; from there tanh(x/d) = 1 to rounding."""
_FIRST, _STEP, _NODES = math.log(0.02), 0.03, 668
"""Nodes of the layers' tables in ln(s)."""
_WALL_FIRST, _WALL_STEP, _WALL_NODES = math.log(1e-2), 0.125, (136, 136)
"""First node, step and nodes of the table of the walls' resistance in ln(x) and ln(a)."""
_TOLERANCE = 1e-11
"""Square of Newton's last change of ln(tau), about the relative error that is left."""
_MAX_STEPS = 60


@cache
def layer_tables(layers: int) -> Array:
    """Return the moments of the lower half's layers over ln(s), (half, nodes, 18).

    M_0, M_1, M_2 each with its first three derivatives d/d ln(s); then eps at the layer's lower
    end, middle and upper end, each with its first derivative.
    """
    s = np.exp(_FIRST + _STEP * np.arange(_NODES))[:, None]
    half = (layers + 1) // 2
    edges = np.arange(half + 1) / layers
    low, high = edges[:-1], edges[1:]
    inner = np.minimum(high, 0.5)
    table = np.empty((half, _NODES, 18))
    for n in range(3):
        found = _moment(s, low, inner, n)
        if layers % 2:  # the middle layer's upper half, from the upper wall
            parts = [_moment(s, low[-1:], inner[-1:], p) for p in range(n + 1)]
            signs = ((1.0,), (1.0, -1.0), (1.0, -2.0, 1.0))[n]
            found[:, :, -1:] += sum(sign * part for sign, part in zip(signs, parts, strict=True))
        table[:, :, 4 * n : 4 * n + 4] = found.transpose(2, 1, 0)
    for q, place in enumerate((low, 0.5 * (low + high), np.minimum(high, 1.0 - high))):
        x = s * place
        table[:, :, 12 + 2 * q] = _eddy(x).T
        table[:, :, 13 + 2 * q] = (x * KAPPA * np.tanh(x / SUBLAYER) ** 2).T
    return table


@cache
def wall_table() -> Array:
    """Return ln of the mean of 1/(1 + a eps) from a wall to x, over ln(x) and ln(a)."""
    place = np.exp(_WALL_FIRST + _WALL_STEP * np.arange(_WALL_NODES[0]))
    factor = np.exp(_WALL_FIRST + _WALL_STEP * np.arange(_WALL_NODES[1]))
    points, weights = np.polynomial.legendre.leggauss(8)
    low, width = place[:-1, None], np.diff(place)[:, None]
    eddy = _eddy(low + 0.5 * width * (1.0 + points))
    parts = 0.5 * width[:, :, None] * weights[:, None] / (1.0 + factor * eddy[:, :, None])
    # Below the first place there are no eddies.
    sums = np.concatenate([np.zeros((1, factor.size)), np.cumsum(parts.sum(axis=1), axis=0)])
    return np.asarray(np.log((place[0] + sums) / place[:, None]))


def _moment(s: Array, low: Array, high: Array, n: int) -> Array:
    """Return the int z^n/(1 + eps(s z)) dz and its derivatives over ln(s), (4, nodes, layers).

    By parts: D M = [z^(n + 1) phi] - (n + 1) M, phi = 1/(1 + eps).
    """
    value = (_integral(s * high, n) - _integral(s * low, n)) / s ** (n + 1)
    found, ends = [value], np.zeros((3, *value.shape))
    for place, sign in ((high, 1.0), (low, -1.0)):
        x = s * place
        tanh = np.tanh(x / SUBLAYER)
        film, slope = 1.0 + _eddy(x), KAPPA * tanh**2
        bend = 2.0 * KAPPA * tanh * (1.0 - tanh**2) / SUBLAYER
        first = -x * slope / film**2
        second = -x * x * bend / film**2 + 2.0 * (x * slope) ** 2 / film**3
        ends += sign * place ** (n + 1) * np.stack([1.0 / film, first, first + second])
    for end in ends:
        found.append(end - (n + 1) * found[-1])
    return np.stack(found)


def _eddy(x: Array) -> Array:
    return KAPPA * (x - SUBLAYER * np.tanh(x / SUBLAYER))


@cache
def _sums() -> tuple[Array, Array]:
    """Return the equal steps of x and int_0^x t^n/(1 + eps) dt there, n = 0 to 2, (3, nodes)."""
    x = np.linspace(0.0, _LAST, _INTERVALS + 1)
    points, weights = np.polynomial.legendre.leggauss(8)
    inner = x[:-1, None] + 0.5 * x[1] * (1.0 + points)
    sums = np.zeros((3, x.size))
    for n in range(3):
        parts = 0.5 * x[1] * np.sum(weights * inner**n / (1.0 + _eddy(inner)), axis=1)
        sums[n, 1:] = np.cumsum(parts)
    return x, sums


def _integral(x: Array, n: int) -> Array:
    """Return int_0^x t^n/(1 + eps(t)) dt, closed where tanh(t/d) = 1."""
    from scipy.interpolate import CubicHermiteSpline

    nodes, sums = _sums()
    inside = np.minimum(x, _LAST)
    found = CubicHermiteSpline(nodes, sums[n], nodes**n / (1.0 + _eddy(nodes)))(inside)
    beyond, offset = np.maximum(x, _LAST), 1.0 - KAPPA * SUBLAYER
    gain = [np.log((KAPPA * beyond + offset) / (KAPPA * _LAST + offset)) / KAPPA]
    for power in (1, 2):
        rise = (beyond**power - _LAST**power) / power
        gain.append((rise - offset * gain[-1]) / KAPPA)
    return found + gain[n]


@kernel
def _weights(logarithm):
    """Return the node below ln(s) and the weights of both nodes' values and derivatives."""
    place = min(max((logarithm - _FIRST) / _STEP, 0.0), _NODES - 1.000001)
    i = int(place)
    t = place - i
    u = 1.0 - t
    return (
        i,
        (1.0 + 2.0 * t) * u * u,
        t * t * (3.0 - 2.0 * t),
        t * u * u * _STEP,
        -t * t * u * _STEP,
    )


@kernel
def _fluidity(table, viscosity, logarithms, logarithm):
    """Return F_0 of one column, and the same of the tangent viscosity; `logarithm`: ln(s mu)."""
    layers = viscosity.shape[0]
    f0, tangent = 0.0, 0.0
    for k in range(layers):
        rows = table[min(k, layers - 1 - k)]
        i, a, b, c, d = _weights(logarithm - logarithms[k])
        value = a * rows[i, 0] + b * rows[i + 1, 0] + c * rows[i, 1] + d * rows[i + 1, 1]
        rate = a * rows[i, 1] + b * rows[i + 1, 1] + c * rows[i, 2] + d * rows[i + 1, 2]
        f0 += value / viscosity[k]
        tangent += (value + 0.5 * rate) / viscosity[k]
    return f0, tangent


@kernel
def _stress(table, viscosity, logarithms, h, density, speed, guess):
    """Return shear stress of the Couette flow [Pa].

    U = tau h F_0(tau), by Newton's method in ln(tau).
    """
    stress = guess
    for _ in range(_MAX_STEPS):
        f0, tangent = _fluidity(
            table, viscosity, logarithms, math.log(h) + 0.5 * math.log(density * stress)
        )
        change = math.log(speed / (stress * h * f0)) * f0 / tangent
        stress *= math.exp(max(-2.0, min(2.0, change)))
        if change * change < _TOLERANCE:
            break
    return stress


@kernel
def _turbulent_weight(reynolds, lower, upper):
    """Return the weight of the turbulent fluidity, 0 to 1, and its rate d/d ln(Re)."""
    if upper <= 0.0:
        return 1.0, 0.0
    t = (reynolds - lower) / (upper - lower)
    if t <= 0.0 or t >= 1.0:
        return (0.0 if t <= 0.0 else 1.0), 0.0
    rate = 30.0 * t * t * (1.0 - t) ** 2 * reynolds / (upper - lower)
    return t * t * t * (10.0 - 15.0 * t + 6.0 * t * t), rate


@kernel
def _ratio(reynolds, base, factor, exponent, added):
    """Return k/base of a bulk law and its rate d ln/d ln(Re).

    `added`: base + factor Re^exponent; else the larger of both, with the corner rounded over a few
    per cent so that the coefficients do not jump.
    """
    power = factor * reynolds**exponent
    if added:
        return 1.0 + power / base, exponent * power / (base + power)
    width = 0.02
    beyond = math.log(power / base) / width if power > 0.0 else -1e9
    if beyond > 40.0:
        return power / base, exponent
    if beyond < -40.0:
        return 1.0, 0.0
    grown = math.exp(beyond)
    return math.exp(width * math.log1p(grown)), exponent * grown / (1.0 + grown)


@kernel
def integrate(
    table: Array, walls: Array, viscosity: Array, thickness: Array, laminar_f0: Array,
    density: float, speed: float, lower: float, upper: float, bulk: Array, diffusion: float,
    stresses: Array,
    weight: Array, f0: Array, f2: Array, f2_axial: Array, g: Array, g_tangent: Array, rates: Array,
    pressure_share: Array, axial_share: Array, shear_share: Array, heat_share: Array,
    conduction: Array,
) -> None:  # fmt: skip
    """Fill all integrals of every column.

    table, walls : Of `layer_tables` and `wall_table`.
    viscosity : (n, m, k) array [Pa s]
    thickness, laminar_f0 : (n, m) arrays [m], [1/(Pa s)]
    bulk : (3, 4) array. Shear, k_x, k_y of a bulk law: base, factor, exponent, added (see
        `_ratio`); base 0 without.
    diffusion : c_p/(k Pr_t) [1/(Pa s)]; 0 where no heat is asked for: then the shares stay empty.
    stresses : (n, m) array. First guess of the shear stress [Pa], overwritten; 0 without one.
    weight, f0, f2, f2_axial, g, g_tangent : (n, m) arrays
    rates : (3, n, m) array. d ln/d ln h of f2, f2_axial and 1 - g.
    pressure_share, axial_share, shear_share : (n, m, k) arrays
    heat_share : (4, n, m, k) array. Integrals over each layer by which the dissipation is shared;
        see `film.energy.dissipation`.
    conduction : (n, m, k + 1) array. By how much the eddies multiply what layers (and walls)
        conduct to each other.
    """
    n, m, layers = viscosity.shape
    dz = 1.0 / layers
    heated = diffusion > 0.0
    # Moments 0 to 2 of every layer: Couette, along the motion (tangent), along the axis.
    moments = np.empty((layers, 3, 3))
    change = np.empty((3, 3))  # their d/d ln h, summed over the layers
    total, sums = np.empty((3, 3)), np.empty((3, 2))
    smooth, tangent = np.empty((layers, 3)), np.empty((layers, 3))
    straight, eddies = np.empty((layers, 3)), np.empty((layers, 3))
    logarithms, factor, grown = np.empty(layers), np.empty(3), np.empty(3)
    # Of the turbulent film: moments, tangent ones, their d/d ln(tau h^2); of the laminar film.
    first, second, third, plain = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    value, rate, bend = np.empty(3), np.empty(3), np.empty(3)
    own, own_rate = np.empty(3), np.empty(3)
    above = 1.0
    for k in range(layers):
        low, high = k * dz, (k + 1) * dz
        straight[k, 0] = dz
        straight[k, 1] = 0.5 * (high * high - low * low)
        straight[k, 2] = (high**3 - low**3) / 3.0
    for i in range(n):
        for j in range(m):
            h, laminar = thickness[i, j], laminar_f0[i, j]
            reynolds = density * speed * h * laminar if h > 0.0 else 0.0
            w, w_rate = _turbulent_weight(reynolds, lower, upper)
            if not h > 0.0:
                w = 0.0
            weight[i, j] = w
            mu = viscosity[i, j]
            total[:] = 0.0
            change[:] = 0.0
            first[:] = 0.0
            second[:] = 0.0
            third[:] = 0.0
            plain[:] = 0.0
            logarithm = 0.0
            if w > 0.0:
                for k in range(layers):
                    logarithms[k] = math.log(mu[k])
                guess = stresses[i, j]
                if not guess > 0.0:  # as far above the laminar film's as in the column before
                    guess = above * speed / (h * laminar)
                stresses[i, j] = _stress(table, mu, logarithms, h, density, speed, guess)
                above = stresses[i, j] * h * laminar / speed
                logarithm = math.log(h) + 0.5 * math.log(density * stresses[i, j])
            for k in range(layers):
                fluidity = 1.0 / mu[k]
                for q in range(3):
                    plain[q] += straight[k, q] * fluidity
                if w == 0.0:
                    continue
                mirrored = 2 * k >= layers
                rows = table[layers - 1 - k if mirrored else k]
                p, a, b, c, d = _weights(logarithm - logarithms[k])
                for q in range(3):
                    f = 4 * q
                    value[q] = (
                        a * rows[p, f] + b * rows[p + 1, f]
                        + c * rows[p, f + 1] + d * rows[p + 1, f + 1]
                    )  # fmt: skip
                    rate[q] = (
                        a * rows[p, f + 1] + b * rows[p + 1, f + 1]
                        + c * rows[p, f + 2] + d * rows[p + 1, f + 2]
                    )  # fmt: skip
                    bend[q] = (
                        a * rows[p, f + 2] + b * rows[p + 1, f + 2]
                        + c * rows[p, f + 3] + d * rows[p + 1, f + 3]
                    )  # fmt: skip
                    f = 12 + 2 * q
                    eddies[k, 2 - q if mirrored else q] = (
                        a * rows[p, f] + b * rows[p + 1, f]
                        + c * rows[p, f + 1] + d * rows[p + 1, f + 1]
                    )  # fmt: skip
                if mirrored:  # from distances to the upper wall to z
                    value[1], value[2] = value[0] - value[1], value[0] - 2.0 * value[1] + value[2]
                    rate[1], rate[2] = rate[0] - rate[1], rate[0] - 2.0 * rate[1] + rate[2]
                    bend[1], bend[2] = bend[0] - bend[1], bend[0] - 2.0 * bend[1] + bend[2]
                for q in range(3):
                    smooth[k, q] = value[q] * fluidity
                    tangent[k, q] = (value[q] + 0.5 * rate[q]) * fluidity
                    first[q] += smooth[k, q]
                    second[q] += tangent[k, q]
                    third[q] += (0.5 * rate[q] + 0.25 * bend[q]) * fluidity
            factor[:] = 1.0  # of a bulk law on the turbulent moments, and d ln/d ln h
            grown[:] = 0.0
            tau = 0.0
            if w > 0.0:
                tau = first[0] / second[0]  # d ln(tau h^2)/d ln(h)
                if bulk[0, 0] > 0.0:
                    # F_0, F_2 along and across, and their rates
                    own[0], own_rate[0] = first[0], tau * (second[0] - first[0]) / first[0]
                    c = second[1] / second[0]
                    own[1] = second[2] - c * second[1]
                    own_rate[1] = tau * (third[2] - 2.0 * c * third[1] + c * c * third[0]) / own[1]
                    c = first[1] / first[0]
                    own[2] = first[2] - c * first[1]
                    own_rate[2] = (
                        second[2] - first[2] - 2.0 * c * (second[1] - first[1])
                        + c * c * (second[0] - first[0])
                    ) * tau / own[2]  # fmt: skip
                    smooth_f2 = plain[2] - plain[1] * plain[1] / plain[0]
                    for q in range(3):
                        k_ratio, k_rate = _ratio(
                            reynolds, bulk[q, 0], bulk[q, 1], bulk[q, 2], bulk[q, 3] > 0.0
                        )
                        wanted = (plain[0] if q == 0 else smooth_f2) / k_ratio
                        factor[q] = wanted / own[q]
                        grown[q] = -k_rate - own_rate[q]
            for k in range(layers):
                fluidity = (1.0 - w) / mu[k]
                for q in range(3):
                    part = straight[k, q] * fluidity
                    moments[k, 0, q] = part
                    moments[k, 1, q] = part
                    moments[k, 2, q] = part
                    if w > 0.0:
                        moments[k, 0, q] += w * factor[0] * smooth[k, q]
                        moments[k, 1, q] += w * factor[1] * tangent[k, q]
                        moments[k, 2, q] += w * factor[2] * smooth[k, q]
                    for p in range(3):
                        total[p, q] += moments[k, p, q]
            if w > 0.0:
                for q in range(3):
                    for p in range(3):
                        of = second[q] if p == 1 else first[q]
                        along = third[q] if p == 1 else second[q] - first[q]
                        change[p, q] = w_rate * (factor[p] * of - plain[q])
                        change[p, q] += w * factor[p] * (tau * along + grown[p] * of)
            drag = total[0, 1] / total[0, 0]
            center = total[1, 1] / total[1, 0]
            across = total[2, 1] / total[2, 0]
            f0[i, j] = total[0, 0]
            g[i, j] = drag
            g_tangent[i, j] = center
            f2[i, j] = total[1, 2] - center * total[1, 1]
            f2_axial[i, j] = total[2, 2] - across * total[2, 1]
            rates[0, i, j] = (
                change[1, 2] - 2.0 * center * change[1, 1] + center * center * change[1, 0]
            ) / f2[i, j]
            rates[1, i, j] = (
                change[2, 2] - 2.0 * across * change[2, 1] + across * across * change[2, 0]
            ) / f2_axial[i, j]
            rates[2, i, j] = -(change[0, 1] - drag * change[0, 0]) / total[0, 0] / (1.0 - drag)
            if not heated:
                continue
            sums[:] = 0.0
            for k in range(layers):
                low, high = k * dz, (k + 1) * dz
                for p in range(3):
                    m0, m1, m2 = moments[k, p, 0], moments[k, p, 1], moments[k, p, 2]
                    inner = dz * sums[p, 0] + high * m0 - m1  # int of int 1/mu over the layer
                    if p == 0:
                        shear_share[i, j, k] = inner / total[0, 0]
                    else:
                        middle = center if p == 1 else across
                        share = dz * sums[p, 1] + high * m1 - m2 - middle * inner
                        square = m2 - 2.0 * middle * m1 + middle * middle * m0
                        if p == 1:
                            pressure_share[i, j, k] = share
                            heat_share[2, i, j, k] = square
                        else:
                            axial_share[i, j, k] = share
                            heat_share[3, i, j, k] = square
                    sums[p, 0] += m0
                    sums[p, 1] += m1
                heat_share[0, i, j, k] = moments[k, 0, 0]
                heat_share[1, i, j, k] = 0.5 * (
                    moments[k, 0, 1] - center * moments[k, 0, 0]
                    + moments[k, 1, 1] - center * moments[k, 1, 0]
                )  # fmt: skip
            _conduct(
                walls, eddies, mu, logarithms, logarithm, w * diffusion, conduction[i, j]
            )  # fmt: skip


@kernel
def _wall_resistance(table, place, factor):
    """Return the mean of 1/(1 + a eps) from the wall to x; `place`: ln(x), `factor`: ln(a)."""
    u = min(max((place - _WALL_FIRST) / _WALL_STEP, 0.0), _WALL_NODES[0] - 1.000001)
    v = min(max((factor - _WALL_FIRST) / _WALL_STEP, 0.0), _WALL_NODES[1] - 1.000001)
    i, j = int(u), int(v)
    u, v = u - i, v - j
    return math.exp(
        (1.0 - u) * ((1.0 - v) * table[i, j] + v * table[i, j + 1])
        + u * ((1.0 - v) * table[i + 1, j] + v * table[i + 1, j + 1])
    )


@kernel
def _conduct(walls, eddies, viscosity, logarithms, logarithm, diffusion, conduction):
    """Return the conduction between neighbouring layers and to the walls over the laminar one.

    The resistance int dz/(1 + mu c_p eps/(k Pr_t)) from centre to centre, and from each wall to the
    first centre, where the conduction falls by orders of magnitude.
    """
    layers = viscosity.shape[0]
    conduction[:] = 1.0
    if diffusion == 0.0:
        return
    half = logarithm - math.log(2.0 * layers)
    for wall in range(2):
        k = 0 if wall == 0 else layers - 1
        factor = math.log(diffusion) + logarithms[k]
        conduction[k + wall] = 1.0 / _wall_resistance(walls, half - logarithms[k], factor)
    below = 0.0
    for k in range(layers):
        gain = diffusion * viscosity[k]
        low, middle = 1.0 + gain * eddies[k, 0], 1.0 + gain * eddies[k, 1]
        high, center = 1.0 + gain * eddies[k, 2], 1.0 / middle
        # Simpson's rule, the eddies linear in the half layer: exact to 0.2 % in the log layer.
        if k > 0:
            conduction[k] = 12.0 / (below + 1.0 / low + 8.0 / (low + middle) + center)
        below = center + 8.0 / (middle + high) + 1.0 / high
