"""A machine in time: matrices of a (reduced) rotor, films and stops between its unknowns, loads.

M q'' + (D + w G) q' + (K + w H) q = constant forces + unbalance + loads + linear supports + links,
with the shaft's angle phi and speed w prescribed (`SpeedSchedule`) or following from a torque
(`TorqueDrive`). Torques act along the bent shaft's axis, so that the lateral equations know the
angular acceleration by the unbalance alone.

Everything travels in plain arrays (`_Plain`) to one compiled function of the forces, which all
integrators call.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from ..arrays import Array, ComplexArray, Indices
from ..compiled import compiled
from ..errors import InputError
from ..film.compiled_force import film_at
from .forces import BearingForce, CompilableForce
from .kernels import SOLVED, STOP, film_force

_SPEED_INTERVALS = 256
GROUND = (-1, -1)


@runtime_checkable
class GeneralisedForce(Protocol):
    """A solved film whose pads move as well (see `SolvedFilmForce`)."""

    def forces(self, q: Array, v: Array, speed: float) -> Array:
        """Return the forces (k,) on journal and pads."""
        ...

    def linear(self, q: Array, v: Array, speed: float) -> tuple[Array, Array, Array]:
        """Return `forces`, and stiffness and damping (k, k)."""
        ...


@dataclass(frozen=True, eq=False)
class Link:
    """A film or a stop between a body of the machine and its housing.

    force : On the inner body, from its position and velocity relative to the outer one.
    inner, outer : (int, int). Unknowns along x and y of both; `GROUND` for a housing that stands
        still.
    turning : (float, float). Speed that the force is asked for: this times the shaft's, plus this
        times the ring's. Of a film it is the sum of the speeds of its surfaces: (1, 0) for a
        journal in a housing, (0, 0) for a damper.
    ring : Unknown that is the angle of a floating ring; -1 without one.
    side : 1 where the ring is the outer surface, -1 where it is the inner one.
    drag : Friction torque of the centred film over the difference of the surfaces' speeds [N m s].
    offset : (float, float). Of the housing's centre [m].
    minimum_film : At which the run ends [m].
    film : False for a stop.
    pads : Unknowns that are the displacements of its pads.
    """

    name: str
    force: BearingForce
    inner: tuple[int, int]
    outer: tuple[int, int] = GROUND
    turning: tuple[float, float] = (1.0, 0.0)
    ring: int = -1
    side: float = 0.0
    drag: float = 0.0
    offset: tuple[float, float] = (0.0, 0.0)
    minimum_film: float = 0.0
    film: bool = True
    pads: tuple[int, ...] = ()

    @cached_property
    def compilable(self) -> bool:
        """Return whether the force has a compiled form."""
        return isinstance(self.force, CompilableForce)

    @cached_property
    def generalised(self) -> GeneralisedForce | None:
        """The force, if it is that of a solved film."""
        return self.force if isinstance(self.force, GeneralisedForce) else None

    def at(self, q: Array, v: Array, speed: float) -> tuple[float, ...]:
        """Return the position, velocity and speed that the force is asked for, of one state."""
        (i, j), (k, m) = self.inner, self.outer
        x, y, vx, vy = float(q[i]), float(q[j]), float(v[i]), float(v[j])
        if k >= 0:
            x, y, vx, vy = x - q[k], y - q[m], vx - v[k], vy - v[m]
        ring = float(v[self.ring]) if self.ring >= 0 else 0.0
        turning = self.turning[0] * speed + self.turning[1] * ring
        return x - self.offset[0], y - self.offset[1], vx, vy, turning

    def motion(self, q: Array, v: Array, speed: Array) -> Array:
        """Return position, velocity and speed (m, 5) that the force is asked for, along a run."""
        columns = []
        for values, offset in ((q, self.offset), (v, (0.0, 0.0))):
            for axis in (0, 1):
                outer = values[:, self.outer[axis]] if self.outer[axis] >= 0 else 0.0
                columns.append(values[:, self.inner[axis]] - outer - offset[axis])
        ring = v[:, self.ring] if self.ring >= 0 else 0.0
        columns.append(self.turning[0] * speed + self.turning[1] * ring)
        return np.column_stack(columns)


@dataclass(frozen=True, eq=False)
class LinearBlock:
    """Linear supports: force f(w) - K(w) q - C(w) v on a few unknowns.

    law : Speed [rad/s] to f (m,), K and C (m, m).
    """

    unknowns: Indices
    law: Callable[[float], tuple[Array, Array, Array]]

    def row(self, speed: float) -> Array:
        """Return K, C and f in one row, (2 m^2 + m,)."""
        force, stiffness, damping = self.law(speed)
        return np.concatenate([np.ravel(stiffness), np.ravel(damping), np.ravel(force)])


class Harmonic(NamedTuple):
    """A force Re(amplitude exp(i frequency t)) from `start` until `stop` [s]; (n,) amplitudes."""

    amplitude: ComplexArray
    frequency: float = 0.0
    start: float = -math.inf
    stop: float = math.inf


class Limited(NamedTuple):
    """Forces columns @ clip(rows @ (q, v) - offset), each between - limit and limit.

    rows, columns : (m, 2 n) and (n, m) arrays.
    """

    rows: Array
    offset: Array
    columns: Array
    limit: float


@dataclass(frozen=True, eq=False)
class MotionSystem:
    """Equations of motion.

    mass, damping, gyroscopic, stiffness, circulatory : (n, n) arrays. The mass matrix positive
        definite.
    constant : (n,) array. [N]
    unbalance : tuple of (float, (n,) complex array). From when it is there [s], and its mass times
        radius on each unknown [kg m]: the force is Re(u (w^2 - i w') exp(i phi)).
    scale : (n,) array. A displacement that counts as large, of each unknown: for tolerances [m].
    basis, offset : (k, n) and (k,) arrays. From the unknowns to the displacements of the whole
        machine.
    turned_offset : (n,) array, optional. Force over speed by which the circulatory matrix pulls
        back the shape `offset` [N s].
    """

    mass: Array
    damping: Array
    gyroscopic: Array
    stiffness: Array
    circulatory: Array
    constant: Array
    scale: Array
    basis: Array
    offset: Array
    unbalance: tuple[tuple[float, ComplexArray], ...] = ()
    links: tuple[Link, ...] = ()
    block: LinearBlock | None = None
    loads: tuple[Harmonic, ...] = ()
    limited: Limited | None = None
    names: tuple[tuple[str, str], ...] = field(default=(), repr=False)
    turned_offset: Array | None = None

    def __post_init__(self) -> None:
        least = np.linalg.eigvalsh(self.mass)[0]
        if not least > 0.0:
            raise InputError(
                "must be positive definite: in time every unknown needs a mass, those of pads and "
                "pedestals too", key="mass", value=float(least),
            )  # fmt: skip

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.mass.shape[0]

    @cached_property
    def linear(self) -> bool:
        """Return whether all forces are linear in the motion."""
        return not self.links and self.limited is None

    @cached_property
    def compilable(self) -> bool:
        """Return whether all links have a compiled form."""
        return all(link.compilable for link in self.links)

    def plain(self, lowest: float, highest: float) -> Plain:
        """Return the arrays for the compiled functions, good between two speeds [rad/s].

        Links without a compiled form are left out: their forces are added in Python.
        """
        links = [link for link in self.links if isinstance(link.force, CompilableForce)]
        numbers, tables, ints, floats = [np.zeros(1)], [np.zeros(1)], [], []
        for link in links:
            assert isinstance(link.force, CompilableForce)
            top = max(abs(link.turning[0]) + abs(link.turning[1]), 1e-300)
            form = link.force.compiled(lowest * min(top, 1.0), highest * max(top, 1.0))
            n0, t0 = sum(map(len, numbers)), sum(map(len, tables))
            numbers.append(np.asarray(form.numbers, dtype=float))
            tables.append(np.ravel(form.table))
            ints.append(
                [form.kind, *link.inner, *link.outer, link.ring, n0, numbers[-1].size, t0,
                 *form.table.shape]
            )  # fmt: skip
            clearance = link.force.radial_clearance if link.film else math.inf
            floats.append(
                [*link.turning, link.side, link.drag, *link.offset, clearance, link.minimum_film]
            )
        index, table, low, step = np.zeros(0, dtype=np.int64), np.zeros((1, 4, 0)), lowest, 1.0
        if self.block is not None:
            index = self.block.unknowns.astype(np.int64)
            if highest > lowest:
                speeds = np.linspace(lowest, highest, _SPEED_INTERVALS + 1)
                rows = np.array([self.block.row(float(speed)) for speed in speeds])
                step = float(speeds[1] - speeds[0])
                spline = CubicSpline(np.arange(speeds.size), rows)
                table = np.ascontiguousarray(np.moveaxis(spline.c[::-1], 0, 1))
        loads = self.loads
        empty = np.zeros((0, self.size))
        damping, stiffness, constant = self.damping, self.stiffness, self.constant
        gyroscopic, circulatory = self.gyroscopic, self.circulatory
        turned = np.zeros(self.size) if self.turned_offset is None else self.turned_offset
        if highest == lowest:
            # one matrix of each kind at one speed
            damping, stiffness = damping + lowest * gyroscopic, stiffness + lowest * circulatory
            gyroscopic, circulatory = empty, empty
            constant = constant - lowest * turned
            if self.block is not None:
                force, more_stiffness, more_damping = self.block.law(lowest)
                place, constant = np.ix_(index, index), constant.copy()
                constant[index] += force
                stiffness[place] += more_stiffness
                damping[place] += more_damping
                index = index[:0]
        limited = self.limited or Limited(
            np.zeros((0, 2 * self.size)), np.zeros(0), np.zeros((self.size, 0)), math.inf
        )
        real = [np.array([u.real for _, u in self.unbalance]).reshape(-1, self.size),
                np.array([u.imag for _, u in self.unbalance]).reshape(-1, self.size)]  # fmt: skip
        return Plain(
            mass=_array(self.mass), inverse=_array(np.linalg.inv(self.mass)),
            damping=_array(damping), gyroscopic=_array(gyroscopic), stiffness=_array(stiffness),
            circulatory=_array(circulatory), constant=_array(constant),
            turned_offset=_array(turned),
            unbalance_start=np.array([start for start, _ in self.unbalance], dtype=float),
            unbalance_real=real[0], unbalance_imag=real[1],
            load_times=np.array([[h.frequency, h.start, h.stop] for h in loads]).reshape(-1, 3),
            load_real=np.array([h.amplitude.real for h in loads]) if loads else empty,
            load_imag=np.array([h.amplitude.imag for h in loads]) if loads else empty,
            links=np.array(ints, dtype=np.int64).reshape(-1, 12),
            link_numbers=np.array(floats, dtype=float).reshape(-1, 8),
            numbers=np.concatenate(numbers), tables=np.concatenate(tables), block=index,
            block_table=table, block_low=low, block_step=step,
            limit_rows=_array(limited.rows), limit_offset=_array(limited.offset),
            limit_columns=_array(limited.columns), limit=float(limited.limit),
        )  # fmt: skip

    def solved(self, q: Array, v: Array, speed: float) -> Array:
        """Return the forces (n,) of the links that have no compiled form."""
        force = np.zeros(self.size)
        for link in self.links:
            if not link.compilable:
                pull = self._pull(link, q, v, speed)[0]
                for at, size in zip(*self._spread(link, pull), strict=True):
                    force[at] += size
        return force

    def solved_derivatives(self, q: Array, v: Array, speed: float) -> tuple[Array, Array]:
        """Return the stiffness and damping (n, n) of the links without a compiled form."""
        found = np.zeros((2, self.size, self.size))
        for link in self.links:
            if not link.compilable:
                spread = np.zeros((self.size, 2 + len(link.pads)))
                for column, unit in enumerate(np.eye(spread.shape[1])):
                    np.add.at(spread[:, column], *self._spread(link, unit))
                _, stiffness, damping = self._pull(link, q, v, speed, slopes=True)
                found += [spread @ part @ spread.T for part in (stiffness, damping)]
        return found[0], found[1]

    def link_forces(self, link: Link, q: Array, v: Array, speed: Array, plain: Plain) -> Array:
        """Return the force (m, 2) of a link on its inner body along (m, n) motion [N]."""
        if link.compilable:
            k = [one for one in self.links if one.compilable].index(link)
            return _link_forces(k, _array(q), _array(v), _array(speed), plain)
        rows = zip(q, v, speed, strict=True)
        pulls = [self._pull(link, a, b, float(w))[0][:2] for a, b, w in rows]
        return np.array(pulls).reshape(-1, 2)

    def _pull(
        self, link: Link, q: Array, v: Array, speed: float, slopes: bool = False
    ) -> tuple[Array, ...]:
        """Return forces of a solved link on body and pads.

        With `slopes` stiffness and damping too.
        """
        x, y, vx, vy, turning = link.at(q, v, speed)
        pads = list(link.pads)
        here, rate = np.array([x, y, *q[pads]]), np.array([vx, vy, *v[pads]])
        solved = link.generalised
        if solved is None:
            return self._differences(link.force, here, rate, float(turning), slopes)
        motion = here, rate, float(turning)
        return solved.linear(*motion) if slopes else (solved.forces(*motion),)

    @staticmethod
    def _differences(
        force: BearingForce, here: Array, rate: Array, speed: float, slopes: bool
    ) -> tuple[Array, ...]:
        both = np.concatenate([here, rate])
        x, y, vx, vy = map(float, both)
        before = np.array(force.force(x, y, vx, vy, speed))
        if not slopes:
            return (before,)
        columns, length = [], 1e-5 * force.radial_clearance
        for j in range(4):
            step = length if j < 2 else length * max(abs(speed), 1.0)
            moved = both.copy()
            moved[j] += step
            x, y, vx, vy = map(float, moved)
            columns.append((before - np.array(force.force(x, y, vx, vy, speed))) / step)
        return before, np.column_stack(columns[:2]), np.column_stack(columns[2:])

    @staticmethod
    def _spread(link: Link, pull: Array) -> tuple[list[int], list[float]]:
        """Return where the forces of a link act, and how large they are."""
        at, sizes = [*link.inner, *link.pads], [*pull]
        if link.outer[0] >= 0:
            at += link.outer
            sizes += [-pull[0], -pull[1]]
        return at, sizes

    def displacement(self, q: Array) -> Array:
        """Return the displacements (m, k) of the whole machine along (m, n) unknowns."""
        return q @ self.basis.T + self.offset


class Plain(NamedTuple):
    """A `MotionSystem` in arrays; see there, and `MotionSystem.plain` for links and block."""

    mass: Array
    inverse: Array
    damping: Array
    gyroscopic: Array
    stiffness: Array
    circulatory: Array
    constant: Array
    turned_offset: Array
    unbalance_start: Array
    unbalance_real: Array
    unbalance_imag: Array
    load_times: Array
    load_real: Array
    load_imag: Array
    links: NDArray[np.int64]
    link_numbers: Array
    numbers: Array
    tables: Array
    block: NDArray[np.int64]
    block_table: Array
    block_low: float
    block_step: float
    limit_rows: Array
    limit_offset: Array
    limit_columns: Array
    limit: float


def _array(values: NDArray[np.floating]) -> Array:
    # a read-only array would be another type: everything compiled anew for it
    return np.require(values, dtype=float, requirements=["C", "W"])


@compiled()
def _at(values: Array, index: int) -> float:
    return values[index] if index >= 0 else 0.0


@compiled()
def link_place(k: int, q: Array, v: Array, p: Plain) -> tuple[float, ...]:
    """Return the x, y, vx, vy of link k relative to its housing, and the speed of its ring."""
    links, f = p.links[k], p.link_numbers[k]
    x = _at(q, links[1]) - _at(q, links[3]) - f[4]
    y = _at(q, links[2]) - _at(q, links[4]) - f[5]
    vx = _at(v, links[1]) - _at(v, links[3])
    vy = _at(v, links[2]) - _at(v, links[4])
    return x, y, vx, vy, _at(v, links[5])


@compiled()
def _form(k: int, p: Plain) -> tuple[Array, Array]:
    """Return numbers and table of the force of link k, views of all links'."""
    links = p.links[k]
    count = links[9] * links[10] * links[11]
    table = p.tables[links[8] : links[8] + count].reshape((links[9], links[10], links[11]))
    return p.numbers[links[6] : links[6] + links[7]], table


@compiled()
def link_force(
    k: int, x: float, y: float, vx: float, vy: float, ring: float, w: float, p: Plain
) -> tuple[float, float, float]:
    """Return the force (x, y) of link k on its inner body, and its torque on the ring."""
    links, f = p.links[k], p.link_numbers[k]
    numbers, table = _form(k, p)
    fx, fy = film_force(links[0], x, y, vx, vy, f[0] * w + f[1] * ring, numbers, table)
    torque = 0.0
    if links[5] >= 0:
        eps2 = min((x * x + y * y) / (f[6] * f[6]), 1.0 - 1e-9)
        shear = f[3] * (f[0] * w - f[2] * ring) / math.sqrt(1.0 - eps2)
        # the two surfaces share the couple of the eccentric force
        torque = f[2] * shear - 0.5 * (x * fy - y * fx)
    return fx, fy, torque


@compiled()
def _link_forces(k: int, q: Array, v: Array, speed: Array, p: Plain) -> Array:
    """Return the force (m, 2) of link k on its inner body along (m, n) motion [N]."""
    out = np.empty((speed.size, 2))
    for i in range(speed.size):
        x, y, vx, vy, ring = link_place(k, q[i], v[i], p)
        out[i, 0], out[i, 1], _ = link_force(k, x, y, vx, vy, ring, speed[i], p)
    return out


@compiled()
def block_row(w: float, p: Plain) -> Array:
    """Return the stiffness, damping and force of the linear supports at speed w."""
    place = (w - p.block_low) / p.block_step
    index = min(max(int(place), 0), p.block_table.shape[0] - 1)
    s = place - index
    c = p.block_table[index]
    row = np.empty(c.shape[1])
    for i in range(row.size):
        row[i] = c[0, i] + s * (c[1, i] + s * (c[2, i] + s * c[3, i]))
    return row


@compiled()
def explicit_force(t: float, phi: float, w: float, alpha: float, p: Plain) -> Array:
    """Return the forces (n,) that do not depend on the motion: constant ones, unbalance, loads."""
    force = p.constant.copy()
    cos, sin = math.cos(phi), math.sin(phi)
    for k in range(p.unbalance_start.size):
        if t >= p.unbalance_start[k]:
            # Re(u (w^2 - i alpha) exp(i phi))
            a, b = w * w * cos + alpha * sin, w * w * sin - alpha * cos
            for i in range(force.size):
                force[i] += p.unbalance_real[k, i] * a - p.unbalance_imag[k, i] * b
    for k in range(p.load_times.shape[0]):
        if p.load_times[k, 1] <= t < p.load_times[k, 2]:
            a, b = math.cos(p.load_times[k, 0] * t), math.sin(p.load_times[k, 0] * t)
            for i in range(force.size):
                force[i] += p.load_real[k, i] * a - p.load_imag[k, i] * b
    return force


@compiled()
def force_on(t: float, q: Array, v: Array, phi: float, w: float, alpha: float, p: Plain) -> Array:
    """Return all forces (n,) but the inertia's: M q'' is this."""
    force = explicit_force(t, phi, w, alpha, p)
    turning = p.gyroscopic.shape[0] > 0
    for i in range(q.size):
        total = 0.0
        for j in range(q.size):
            total += p.damping[i, j] * v[j] + p.stiffness[i, j] * q[j]
        if turning:
            turned = p.turned_offset[i]
            for j in range(q.size):
                turned += p.gyroscopic[i, j] * v[j] + p.circulatory[i, j] * q[j]
            total += w * turned
        force[i] -= total
    m = p.block.size
    if m > 0:
        row = block_row(w, p)
        for i in range(m):
            total = row[2 * m * m + i]
            for j in range(m):
                total -= row[i * m + j] * q[p.block[j]] + row[(m + i) * m + j] * v[p.block[j]]
            force[p.block[i]] += total
    for k in range(p.links.shape[0]):
        x, y, vx, vy, ring = link_place(k, q, v, p)
        fx, fy, torque = link_force(k, x, y, vx, vy, ring, w, p)
        _add(force, p.links[k], fx, fy, torque)
    for k in range(p.limit_offset.size):
        given = min(max(limited_force(k, q, v, p), -p.limit), p.limit)
        for i in range(force.size):
            force[i] += p.limit_columns[i, k] * given
    return force


@compiled()
def limited_force(k: int, q: Array, v: Array, p: Plain) -> float:
    """Return what a limited force would be without its limit."""
    total = -p.limit_offset[k]
    for i in range(q.size):
        total += p.limit_rows[k, i] * q[i] + p.limit_rows[k, q.size + i] * v[i]
    return total


@compiled()
def _add(force: Array, link: NDArray[np.int64], fx: float, fy: float, torque: float) -> None:
    force[link[1]] += fx
    force[link[2]] += fy
    if link[3] >= 0:
        force[link[3]] -= fx
        force[link[4]] -= fy
    if link[5] >= 0:
        force[link[5]] += torque


@compiled()
def _slopes(k: int, q: Array, v: Array, w: float, scale: Array, p: Plain) -> Array:
    """Return minus the derivatives of a link's force and torque by x, y, vx, vy, ring speed."""
    link, f = p.links[k], p.link_numbers[k]
    place, moved = np.empty(5), np.empty(5)
    place[0], place[1], place[2], place[3], place[4] = link_place(k, q, v, p)
    slopes = np.zeros((3, 5))
    if link[0] == SOLVED and link[5] < 0:
        numbers, table = _form(k, p)
        film = np.empty((2, 2, 2))
        film_at(place[0], place[1], place[2], place[3], f[0] * w, numbers, table, film)
        for i in range(2):
            for j in range(4):
                slopes[i, j] = film[j // 2, i, j % 2]
        return slopes
    length = 1e-6 * max(scale[link[1]], abs(place[0]), abs(place[1]))
    per_second = max(abs(w), 1.0)
    for j in range(5):
        if j == 4 and link[5] < 0:
            continue
        # of a ring the speed moves the force as that of the shaft does
        step = length if j < 2 else (length * per_second if j < 4 else 1e-6 * per_second)
        for i in range(5):
            moved[i] = place[i]
        moved[j] = place[j] + step
        up = link_force(k, moved[0], moved[1], moved[2], moved[3], moved[4], w, p)
        moved[j] = place[j] - step
        low = link_force(k, moved[0], moved[1], moved[2], moved[3], moved[4], w, p)
        for i in range(3):
            slopes[i, j] = (low[i] - up[i]) / (2.0 * step)
    return slopes


@compiled()
def derivatives(q: Array, v: Array, w: float, scale: Array, p: Plain) -> tuple[Array, Array]:
    """Return stiffness and damping matrix (n, n) of all forces at a motion.

    Minus their derivatives.
    """
    stiffness, damping = p.stiffness.copy(), p.damping.copy()
    if p.gyroscopic.shape[0] > 0:
        for i in range(q.size):
            for j in range(q.size):
                stiffness[i, j] += w * p.circulatory[i, j]
                damping[i, j] += w * p.gyroscopic[i, j]
    m = p.block.size
    if m > 0:
        row = block_row(w, p)
        for i in range(m):
            for j in range(m):
                stiffness[p.block[i], p.block[j]] += row[i * m + j]
                damping[p.block[i], p.block[j]] += row[(m + i) * m + j]
    for k in range(p.limit_offset.size):
        if abs(limited_force(k, q, v, p)) < p.limit:
            for i in range(q.size):
                for j in range(q.size):
                    stiffness[i, j] -= p.limit_columns[i, k] * p.limit_rows[k, j]
                    damping[i, j] -= p.limit_columns[i, k] * p.limit_rows[k, q.size + j]
    for k in range(p.links.shape[0]):
        link, slopes = p.links[k], _slopes(k, q, v, w, scale, p)
        for j in range(5):
            if j == 4 and link[5] < 0:
                continue
            target = stiffness if j < 2 else damping
            for i in range(3):
                row_in = link[1 + i] if i < 2 else link[5]
                if row_in < 0:
                    continue
                row_out = link[3 + i] if i < 2 else -1
                column = link[1 + j % 2] if j < 4 else link[5]
                other = link[3 + j % 2] if j < 4 else -1
                target[row_in, column] += slopes[i, j]
                if row_out >= 0:
                    target[row_out, column] -= slopes[i, j]
                if other >= 0:
                    target[row_in, other] -= slopes[i, j]
                    if row_out >= 0:
                        target[row_out, other] += slopes[i, j]
    return stiffness, damping


@compiled()
def least_film(q: Array, v: Array, p: Plain) -> float:
    """Return the smallest of the links' films less what they may not fall below [m]."""
    least = math.inf
    for k in range(p.links.shape[0]):
        if p.links[k, 0] != STOP:
            x, y, _, _, _ = link_place(k, q, v, p)
            f = p.link_numbers[k]
            least = min(least, f[6] - f[7] - math.hypot(x, y))
    return least


def translation_columns(
    size: int, places: Sequence[tuple[int, int]], amounts: Sequence[complex]
) -> ComplexArray:
    """Return the turning forces (size,): amount (1, -i) on x and y of each place."""
    found = np.zeros(size, dtype=complex)
    for (x, y), amount in zip(places, amounts, strict=True):
        found[x] += amount
        found[y] -= 1j * amount
    return found
