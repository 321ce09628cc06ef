"""Compiled film forces on the journal: linear, short bearing, force map, film solved on its cells.

Numbers travel in plain arrays, packed by `rotorsim.orbit.forces`, `force_map` and `film_force`.

The short bearing with a ruptured film has a closed form. In the frame that turns at half the
shaft's speed an isoviscous film is squeezed and nothing else: with e the journal's eccentricity, v
its velocity and

    v_s = v - (w/2) k x e

Reynolds' equation reads div(h^3 grad p)/(12 mu) = -v_s . n(theta). The short film's pressure is
positive just where v_s . n > 0, so half-Sommerfeld and Reynolds conditions are the same film.
Ocvirk (1952); Childs, Moes & van Leeuwen (1977) for the pure-squeeze form.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..compiled import compiled
from ..film.compiled_force import film_at

LINEAR, SHORT_BEARING, FORCE_MAP, SHORT_FULL, STOP, SOLVED = 0, 1, 2, 3, 4, 5
"""Force models the kernel knows."""


@compiled()
def _squeeze_integrals(eccentricity_ratio: float, angle: float) -> tuple[float, float]:
    """Return integrals of cos(t - a) (cos t, sin t)/(1 - eps cos t)^3 over a - pi/2 to a + pi/2.

    Sommerfeld's substitution 1 - eps cos t = (1 - eps^2)/(1 + eps cos g) makes them elementary.

    eccentricity_ratio : Below 1.
    angle : From the eccentricity to the squeeze velocity, in the direction of rotation [rad].
    """
    eps = eccentricity_ratio
    root = math.sqrt(1.0 - eps * eps)
    ca, sa = math.cos(angle), math.sin(angle)
    # limits t = a -+ pi/2: cos t = +-sin a, sin t = -+cos a
    s1, c1 = -root * ca / (1.0 - eps * sa), (sa - eps) / (1.0 - eps * sa)
    s2, c2 = root * ca / (1.0 + eps * sa), (-sa - eps) / (1.0 + eps * sa)
    g1, g2 = math.atan2(s1, c1), math.atan2(s2, c2)
    span = g2 - g1
    if span <= 0.0:
        span += 2.0 * math.pi
    ds = s2 - s1
    dsc = s2 * c2 - s1 * c1
    cc = ((eps * eps + 0.5) * span + 2.0 * eps * ds + 0.5 * dsc) / root**5
    cs = (eps * (c1 - c2) + 0.5 * (s2 * s2 - s1 * s1)) / root**4
    ss = 0.5 * (span - dsc) / root**3
    return ca * cc + sa * cs, ca * cs + sa * ss


@compiled()
def short_bearing_impedance(
    eccentricity_ratio: float, angle: float, slenderness: float
) -> tuple[float, float]:
    """Return the dimensionless film force on the journal, radial and tangential.

    angle : From the eccentricity to the squeeze velocity [rad].
    slenderness : L/D [-].
    Returns radial, tangential : float: In units of 2 mu |v_s| L (R/c)^3, along the eccentricity and
        90 degrees ahead of it.
    """
    radial, tangential = _squeeze_integrals(eccentricity_ratio, angle)
    factor = -2.0 * slenderness * slenderness
    return factor * radial, factor * tangential


@compiled()
def _linear_force(
    x: float, y: float, vx: float, vy: float, speed: float, numbers: Array, table: Array
) -> tuple[float, float]:
    """Evaluate static force - K (q - q0) - C v with K, C, q0 splined over uniform speeds.

    numbers: lowest speed, step, static force (2); table: (interval, power, 10) coefficients of
    kxx kxy kyx kyy cxx cxy cyx cyy x0 y0.
    """
    place = (speed - numbers[0]) / numbers[1]
    index = min(max(int(place), 0), table.shape[0] - 1)
    s = place - index
    c = table[index]
    x0 = c[0, 8] + s * (c[1, 8] + s * (c[2, 8] + s * c[3, 8]))
    y0 = c[0, 9] + s * (c[1, 9] + s * (c[2, 9] + s * c[3, 9]))
    motion = (x - x0, y - y0, vx, vy)
    fx, fy = numbers[2], numbers[3]
    for j in range(4):
        column = 4 * (j // 2) + j % 2
        a = c[0, column] + s * (c[1, column] + s * (c[2, column] + s * c[3, column]))
        column += 2
        b = c[0, column] + s * (c[1, column] + s * (c[2, column] + s * c[3, column]))
        fx -= a * motion[j]
        fy -= b * motion[j]
    return fx, fy


@compiled()
def map_impedance(
    eccentricity_ratio: float, angle: float, numbers: Array, table: Array
) -> tuple[float, float]:
    """Return the dimensionless film force (radial, tangential) from a bicubic B-spline.

    numbers: first radial coordinate, its step, largest, force at the centre; table: (2, rows + 2,
    columns + 3) B-spline coefficients. Coordinates and what is splined: see
    `rotorsim.orbit.force_map`.
    """
    coordinate = math.atanh(eccentricity_ratio)
    thinness = 1.0 / math.cosh(coordinate)
    # past the last row the force grows as that of a film that touches along a line
    beyond = 1.0
    if coordinate > numbers[2]:
        coordinate = numbers[2]
        last = 1.0 / math.cosh(coordinate)
        beyond = (last / thinness) ** 3
        thinness = last
    place = (coordinate - numbers[0]) / numbers[1]
    row = min(max(int(place), 0), table.shape[1] - 4)
    u = place - row
    columns = table.shape[2] - 3
    place = (map_column(angle, thinness) / (2.0 * math.pi)) % 1.0 * columns
    column = min(int(place), columns - 1)
    v = place - column
    wu = _cubic_weights(u)
    wv = _cubic_weights(v)
    radial, tangential = 0.0, 0.0
    for i in range(4):
        for j in range(4):
            weight = wu[i] * wv[j]
            radial += weight * table[0, row + i, column + j]
            tangential += weight * table[1, row + i, column + j]
    scale = beyond * numbers[3] / thinness
    return math.sinh(radial) * scale, math.sinh(tangential) * scale


@compiled()
def map_column(angle: float, thinness: float) -> float:
    """Return the angular coordinate of the force map [rad]; see `rotorsim.orbit.force_map`."""
    cos, sin = math.cos(angle), math.sin(angle)
    return 0.5 * (math.atan2(sin, cos) + math.atan2(thinness * sin, cos))


@compiled()
def _cubic_weights(s: float) -> tuple[float, float, float, float]:
    r = 1.0 - s
    return (
        r * r * r / 6.0,
        (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0,
        (4.0 - 6.0 * r * r + 3.0 * r * r * r) / 6.0,
        s * s * s / 6.0,
    )


@compiled()
def _squeeze_force(
    kind: int,
    x: float,
    y: float,
    vx: float,
    vy: float,
    speed: float,
    numbers: Array,
    table: Array,
) -> tuple[float, float]:
    """Return the isoviscous ruptured film at any position and velocity.

    numbers: clearance [m], 2 mu L (R/c)^3 [N s/m], then L/D or the map's numbers.
    """
    sx, sy = vx + 0.5 * speed * y, vy - 0.5 * speed * x
    squeeze = math.hypot(sx, sy)
    if squeeze == 0.0:
        return 0.0, 0.0
    eccentricity = math.hypot(x, y)
    # trial steps may pass the wall before the event is found
    eps = min(eccentricity / numbers[0], 1.0 - 1e-9)
    if eccentricity > 0.0:
        nx, ny = x / eccentricity, y / eccentricity
    else:
        nx, ny = 1.0, 0.0
    angle = math.atan2(nx * sy - ny * sx, nx * sx + ny * sy)
    if kind == SHORT_BEARING:
        radial, tangential = short_bearing_impedance(eps, angle, numbers[2])
    elif kind == SHORT_FULL:
        # pressure of either sign all round: Ocvirk's film without rupture
        open_ = 1.0 - eps * eps
        factor = -2.0 * math.pi * numbers[2] * numbers[2] / open_**1.5
        radial = factor * (1.0 + 2.0 * eps * eps) / open_ * math.cos(angle)
        tangential = factor * math.sin(angle)
    else:
        radial, tangential = map_impedance(eps, angle, numbers[2:], table)
    scale = numbers[1] * squeeze
    return scale * (radial * nx - tangential * ny), scale * (radial * ny + tangential * nx)


@compiled()
def _stop_force(
    x: float, y: float, vx: float, vy: float, speed: float, numbers: Array
) -> tuple[float, float]:
    """Push the shaft back from a stop that it touches, and rub it.

    numbers: clearance [m], stiffness [N/m], damping [N s/m], friction coefficient [-], radius of
    the shaft [m], slip velocity below which the friction fades [m/s].
    """
    reach = math.hypot(x, y)
    if reach <= numbers[0]:
        return 0.0, 0.0
    nx, ny = x / reach, y / reach
    push = numbers[1] * (reach - numbers[0]) + numbers[2] * (vx * nx + vy * ny)
    push = max(push, 0.0)  # it does not stick
    slip = vy * nx - vx * ny + speed * numbers[4]
    rub = numbers[3] * push * math.tanh(slip / numbers[5])
    return -push * nx + rub * ny, -push * ny - rub * nx


@compiled()
def film_force(
    kind: int,
    x: float,
    y: float,
    vx: float,
    vy: float,
    speed: float,
    numbers: Array,
    table: Array,
) -> tuple[float, float]:
    """Return the film force on the journal [N]."""
    if kind == LINEAR:
        return _linear_force(x, y, vx, vy, speed, numbers, table)
    if kind == STOP:
        return _stop_force(x, y, vx, vy, speed, numbers)
    if kind == SOLVED:
        return film_at(x, y, vx, vy, speed, numbers, table, np.empty((0, 2, 2)))
    return _squeeze_force(kind, x, y, vx, vy, speed, numbers, table)


@compiled()
def shaft(t: float, knots: Array) -> tuple[float, float, float]:
    """Return angle, speed and acceleration of the shaft.

    Knots: time, speed, angle, acceleration.
    """
    i = knots.shape[0] - 2
    while i > 0 and t < knots[i, 0]:
        i -= 1
    since, w, a = t - knots[i, 0], knots[i, 1], knots[i, 3]
    return knots[i, 2] + since * (w + 0.5 * a * since), w + a * since, a
