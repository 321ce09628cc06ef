"""Compiled right-hand side: film force, rotor, loads.

One function for all, so that SciPy calls compiled code once per evaluation; numbers travel in
plain arrays, packed by `rotorsim.orbit.forces`, `loads` and `integrate`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from .short_bearing import short_bearing_impedance

Array = NDArray[np.float64]

LINEAR, SHORT_BEARING, FORCE_MAP = 0, 1, 2
"""Force models the kernel knows."""


@compiled()
def linear_force(
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
    """Dimensionless film force (radial, tangential) from a bicubic B-spline.

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
    """Angular coordinate of the force map [rad]; see `rotorsim.orbit.force_map`."""
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
def squeeze_force(
    kind: int,
    x: float,
    y: float,
    vx: float,
    vy: float,
    speed: float,
    numbers: Array,
    table: Array,
) -> tuple[float, float]:
    """Isoviscous ruptured film at any position and velocity.

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
    else:
        radial, tangential = map_impedance(eps, angle, numbers[2:], table)
    scale = numbers[1] * squeeze
    return scale * (radial * nx - tangential * ny), scale * (radial * ny + tangential * nx)


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
    """Film force on the journal [N]."""
    if kind == LINEAR:
        return linear_force(x, y, vx, vy, speed, numbers, table)
    return squeeze_force(kind, x, y, vx, vy, speed, numbers, table)


@compiled()
def film_force_series(kind: int, motion: Array, numbers: Array, table: Array) -> Array:
    """Film force (n, 2) [N] along motion (n, 5): x, y, vx, vy, speed."""
    out = np.empty((motion.shape[0], 2))
    for i in range(motion.shape[0]):
        m = motion[i]
        out[i] = film_force(kind, m[0], m[1], m[2], m[3], m[4], numbers, table)
    return out


@compiled()
def shaft(t: float, schedule: Array) -> tuple[float, float, float]:
    """Angle, speed and acceleration of the shaft; rows: time, speed, angle, acceleration."""
    i = schedule.shape[0] - 2
    while i > 0 and t < schedule[i, 0]:
        i -= 1
    since = t - schedule[i, 0]
    a = schedule[i, 3]
    w = schedule[i, 1]
    return schedule[i, 2] + since * (w + 0.5 * a * since), w + a * since, a


@compiled()
def _add_loads(t: float, force: Array, shapes: Array, times: Array) -> None:
    for k in range(times.shape[0]):
        if times[k, 1] <= t < times[k, 2]:
            if times[k, 0] == 0.0:
                c, s = 1.0, 0.0
            elif times[k, 0] == 1.0:
                c, s = math.cos(times[k, 3] * t), math.sin(times[k, 3] * t)
            else:
                c, s = math.sin(times[k, 3] * (t - times[k, 1])), 0.0
            for i in range(force.size):
                force[i] += shapes[k, 0, i] * c + shapes[k, 1, i] * s


@compiled()
def load_series(t: Array, shapes: Array, times: Array) -> Array:
    """Loads on every degree of freedom (n, 2k) [N] at times t (n,); see `loads.pack_loads`."""
    out = np.zeros((t.size, shapes.shape[2]))
    for i in range(t.size):
        _add_loads(t[i], out[i], shapes, times)
    return out


@compiled()
def motion_rates(
    t: float,
    state: Array,
    fx: float,
    fy: float,
    rotor: Array,
    unbalance: Array,
    schedule: Array,
    shapes: Array,
    times: Array,
    controller: Array,
    reference: Array,
) -> Array:
    """State rates from a known film force on the journal.

    state: displacements, velocities, controller states; rotor: inverse mass, damping, stiffness,
    gyroscopic, circulatory matrix; unbalance: (n_nodes, 3) mass times radius, phase, place of x;
    shapes, times: see
    `loads.pack_loads`; controller: blocks [[A, B], [C, D]].
    """
    size = rotor.shape[1]
    rates = np.empty(state.size)
    force = np.zeros(size)
    phi, w, alpha = shaft(t, schedule)
    force[0], force[1] = fx, fy
    for k in range(unbalance.shape[0]):
        if unbalance[k, 0] != 0.0:
            c, s = math.cos(phi + unbalance[k, 1]), math.sin(phi + unbalance[k, 1])
            x = int(unbalance[k, 2])
            force[x] += unbalance[k, 0] * (w * w * c + alpha * s)
            force[x + 1] += unbalance[k, 0] * (w * w * s - alpha * c)
    _add_loads(t, force, shapes, times)
    extra = state.size - 2 * size
    if controller.shape[0] > 0:
        _add_control(state, force, rates, controller, reference, size, extra)
    for i in range(size):
        for j in range(size):
            force[i] -= (rotor[1, i, j] + w * rotor[3, i, j]) * state[size + j]
            force[i] -= (rotor[2, i, j] + w * rotor[4, i, j]) * state[j]
    for i in range(size):
        rates[i] = state[size + i]
        total = 0.0
        for j in range(size):
            total += rotor[0, i, j] * force[j]
        rates[size + i] = total
    return rates


@compiled()
def _add_control(
    state: Array,
    force: Array,
    rates: Array,
    controller: Array,
    reference: Array,
    size: int,
    extra: int,
) -> None:
    inputs = np.empty(extra + 4)
    inputs[:extra] = state[2 * size :]
    inputs[extra] = state[0] - reference[0]
    inputs[extra + 1] = state[1] - reference[1]
    inputs[extra + 2] = state[size]
    inputs[extra + 3] = state[size + 1]
    for i in range(extra + 2):
        total = 0.0
        for j in range(extra + 4):
            total += controller[i, j] * inputs[j]
        if i < extra:
            rates[2 * size + i] = total
        else:
            force[i - extra] += total


@compiled()
def rates(
    t: float,
    state: Array,
    kind: int,
    numbers: Array,
    table: Array,
    rotor: Array,
    unbalance: Array,
    schedule: Array,
    shapes: Array,
    times: Array,
    controller: Array,
    reference: Array,
) -> Array:
    """State rates with the film force of one of the compiled models."""
    size = rotor.shape[1]
    speed = shaft(t, schedule)[1]
    vx, vy = float(state[size]), float(state[size + 1])
    fx, fy = film_force(kind, state[0], state[1], vx, vy, speed, numbers, table)
    return motion_rates(
        t, state, fx, fy, rotor, unbalance, schedule, shapes, times, controller, reference
    )
