"""Limit cycles and forced orbits of a machine over speed: stable and unstable branch, folds.

Harmonic balance: x = c_0 + sum of c_k cos(k w t) + s_k sin(k w t), the films' forces taken at equal
moments of a period (Cameron & Griffin 1989). The branch is followed by its arc length (Keller
1977), so that it may turn back at a fold. Stability follows from Floquet's multipliers of the whole
machine.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Booleans, ComplexArray, Indices
from ..compiled import compiled
from ..errors import InputError
from ..threads import on_one_blas_thread
from .motion import Motion, rings_of
from .run import static_position
from .system import MotionSystem, Plain, derivatives, force_on

_HARMONICS = 7
_MOMENTS = 64
_STEPS = 12
"""Of Newton's method at one point of a branch."""
_TOLERANCE = 1e-9
_FIRST = 0.02
"""Amplitude at which a branch begins, over the clearance."""
_FLOQUET_STEPS = 400


@dataclass(frozen=True, eq=False)
class Branch:
    """Periodic motions over speed, in the order in which the branch is followed.

    speed, frequency : (k,) arrays. [rad/s]
    amplitude : (k, m) array. Half the largest extent of each film's journal along x or y [m].
    least_film : (k,) array. Smallest film thickness in any of them [m].
    threshold : Speed at which the static position becomes unstable, where limit cycles begin
        [rad/s].
    names : Of the films.
    message : Why the branch ends.
    """

    speed: Array
    frequency: Array
    amplitude: Array
    least_film: Array
    stable: Booleans
    threshold: float | None
    names: tuple[str, ...]
    message: str

    @property
    def folds(self) -> Array:
        """Speeds at which the branch turns back [rad/s]."""
        steps = np.diff(self.speed)
        turns = np.flatnonzero(steps[1:] * steps[:-1] < 0.0) + 1
        found = []
        for i in turns:
            s = np.arange(3.0)
            a, b, _ = np.polyfit(s, self.speed[i - 1 : i + 2], 2)
            found.append(float(np.polyval([a, b, _], -0.5 * b / a)))
        return np.array(found)

    @property
    def supercritical(self) -> bool | None:
        """Return whether stable small cycles exist above the threshold; None without any cycles."""
        if self.threshold is None or self.speed.size < 2:
            return None
        return bool(self.speed[1] > self.threshold)


@compiled()
def _along(q: Array, v: Array, w: float, scale: Array, p: Plain) -> tuple[Array, Array, Array]:
    """Return the forces (m, n) and minus their derivatives (m, n, n) along (m, n) motion."""
    m, n = q.shape
    forces, stiffness, damping = np.empty((m, n)), np.empty((m, n, n)), np.empty((m, n, n))
    for i in range(m):
        forces[i] = force_on(0.0, q[i], v[i], 0.0, w, 0.0, p)
        stiffness[i], damping[i] = derivatives(q[i], v[i], w, scale, p)
    return forces, stiffness, damping


class _Balance:
    """Residual of the harmonic balance at any speed."""

    def __init__(self, system: MotionSystem, harmonics: int, forced: int | None) -> None:
        if not (system.compilable and system.links):
            raise InputError(
                'needs films with closed forms or maps (force = "short" or "mapped")',
                key="orbit.force",
            )
        self.system, self.harmonics, self.forced = system, harmonics, forced
        touched = {
            i for link in system.links for i in (*link.inner, *link.outer, link.ring) if i >= 0
        }
        self.touched: Indices = np.array(sorted(touched), dtype=np.intp)
        # of a floating ring the speed is periodic, not the angle: its coefficients are the speed's
        self.rings = rings_of(system)
        self.held = np.arange(system.size)
        self.count = 2 * harmonics + 1
        turn = 2.0 * np.pi * np.arange(_MOMENTS) / _MOMENTS
        k = np.arange(1, harmonics + 1)
        waves = [np.ones((_MOMENTS, 1)), np.cos(turn[:, None] * k), np.sin(turn[:, None] * k)]
        self.basis = np.hstack(waves)
        self.rates = np.hstack([0.0 * waves[0], -k * waves[2], k * waves[1]])
        self.projection = np.linalg.pinv(self.basis)
        self._plain: tuple[float, Plain, Plain] | None = None

    def plains(self, speed: float) -> tuple[Plain, Plain]:
        """Return the arrays of the whole machine, and of its links alone."""
        if self._plain is None or self._plain[0] != speed:
            whole = self.system.plain(speed, speed)
            zero = np.zeros_like(whole.mass)
            off = np.full_like(whole.unbalance_start, math.inf)
            links = whole._replace(
                damping=zero, stiffness=zero, constant=0.0 * whole.constant, unbalance_start=off
            )
            self._plain = speed, whole, links
        return self._plain[1], self._plain[2]

    def units(self, clearance: float, speed: float) -> Array:
        """Return what each coefficient is measured in: the clearance, of rings the speed."""
        each = np.full((self.count, self.held.size), clearance)
        each[:, self.rings] = speed
        return each.ravel()

    def linear(self, speed: float, frequency: float) -> tuple[Array, Array]:
        """Return the matrix (h s, h s) and right side (h s,) of the linear machine."""
        whole, _ = self.plains(speed)
        s, h = self.held.size, self.harmonics
        matrix = np.zeros((self.count, s, self.count, s))
        right = np.zeros((self.count, s))
        turning = np.zeros(s, dtype=complex)
        for start, u in self.system.unbalance if self.forced else ():
            if start == -math.inf:
                turning += u * speed**2
        for k in range(h + 1):
            small: ComplexArray = (
                whole.stiffness - (k * frequency) ** 2 * whole.mass
                + 1j * k * frequency * whole.damping
            )  # fmt: skip
            turns = slice(None), self.rings
            small[turns] = whole.damping[turns] + 1j * k * frequency * whole.mass[turns]
            force: ComplexArray = turning if k == self.forced else np.zeros(s, dtype=complex)
            if k == 0:
                force = whole.constant.astype(complex)
            if k == 0:
                matrix[0, :, 0], right[0] = small.real, force.real
                continue
            # x = Re((c - i s) exp(i k w t))
            cos, sin = k, h + k
            matrix[cos, :, cos], matrix[cos, :, sin] = small.real, small.imag
            matrix[sin, :, cos], matrix[sin, :, sin] = -small.imag, small.real
            right[cos], right[sin] = force.real, -force.imag
        size = self.count * s
        return matrix.reshape(size, size), right.ravel()

    def motion(self, c: Array, frequency: float) -> tuple[Array, Array]:
        """Return positions and velocities (m, n) over a period."""
        return self._moved(c, frequency, self.basis, self.rates)

    def _moved(self, c: Array, frequency: float, basis: Array, rates: Array) -> tuple[Array, Array]:
        waves = c.reshape(self.count, -1)
        q, v = basis @ waves, frequency * (rates @ waves)
        q[:, self.rings], v[:, self.rings] = 0.0, q[:, self.rings]
        return q, v

    def residual(self, c: Array, frequency: float, speed: float) -> tuple[Array, Array, Array]:
        """Return the residual, its derivatives by the coefficients, and by the frequency."""
        _, links = self.plains(speed)
        matrix, right = self.linear(speed, frequency)
        q, v = self.motion(c, frequency)
        forces, stiffness, damping = _along(q, v, speed, self.system.scale, links)
        pull = (self.projection @ forces[:, self.held]).ravel()
        at = slice(None), self.touched[:, None], self.touched
        k, d, n = stiffness[at], damping[at], self.touched.size
        turns = np.searchsorted(self.touched, self.rings)
        k[..., turns], d[..., turns] = d[..., turns], 0.0
        both = (k.reshape(_MOMENTS, -1), self.basis), (frequency * d.reshape(_MOMENTS, -1),
                                                       self.rates)  # fmt: skip
        slope = np.zeros((self.count, self.count, n * n))
        for values, waves in both:
            slope += np.einsum("ht,tg,ti->hgi", self.projection, waves, values, optimize=True)
        by_c = matrix.reshape(self.count, self.held.size, self.count, self.held.size).copy()
        each = np.arange(self.count)
        place = (
            each[:, None, None, None], self.touched[:, None, None], each[:, None], self.touched
        )  # fmt: skip
        by_c[place] += np.moveaxis(slope.reshape(self.count, self.count, n, n), 2, 1)
        by_c = by_c.reshape(matrix.shape)
        step = 1e-6 * frequency
        more = self.linear(speed, frequency + step)[0] @ c - matrix @ c
        rates = self.rates @ c.reshape(self.count, -1)
        own = np.zeros((self.count, self.held.size))
        own[:, self.touched] = self.projection @ np.einsum("tij,tj->ti", d, rates[:, self.touched])
        return matrix @ c - right - pull, by_c, more / step + own.ravel()

    def films(self, c: Array, frequency: float) -> tuple[Array, float]:
        """Return the amplitude of each film's journal, and the smallest film [m]."""
        q, v = self.motion(c, frequency)
        sizes, least = [], math.inf
        for link in self.system.links:
            if link.film:
                path = link.motion(q, v, np.zeros(_MOMENTS))[:, :2]
                sizes.append(0.5 * float(np.ptp(path, axis=0).max()))
                reach = float(np.hypot(*path.T).max())
                least = min(least, link.force.radial_clearance - reach)
        return np.array(sizes), least

    def multipliers(self, c: Array, frequency: float, speed: float) -> ComplexArray:
        """Return Floquet's multipliers of the whole machine.

        The one nearest to 1 of a free cycle less.
        """
        whole, _ = self.plains(speed)
        n = self.system.size
        period = 2.0 * np.pi / frequency
        step = period / _FLOQUET_STEPS
        turn = 2.0 * np.pi * (np.arange(_FLOQUET_STEPS) + 0.5) / _FLOQUET_STEPS
        k = np.arange(1.0, self.harmonics + 1.0)
        angle = turn[:, None] * k
        basis = np.hstack([np.ones((turn.size, 1)), np.cos(angle), np.sin(angle)])
        rates = np.hstack([np.zeros((turn.size, 1)), -k * np.sin(angle), k * np.cos(angle)])
        q, v = self._moved(c, frequency, basis, rates)
        _, stiffness, damping = _along(q, v, speed, self.system.scale, whole)
        # implicit mid-point: an orthogonal motion keeps its size
        state = np.eye(2 * n)
        for i in range(turn.size):
            m, d, s = whole.mass, damping[i], stiffness[i]
            left = m + 0.5 * step * d + 0.25 * step**2 * s
            x, y = state[:n], state[n:]
            middle = np.linalg.solve(left, m @ y - 0.5 * step * (s @ x))
            state = np.concatenate([x + step * middle, 2.0 * middle - y])
        # nothing depends on a ring's angle
        state = np.delete(np.delete(state, self.rings, 0), self.rings, 1)
        values: ComplexArray = np.asarray(np.linalg.eigvals(state), dtype=complex)
        if self.forced is None:
            values = np.delete(values, np.argmin(np.abs(values - 1.0)))
        return values


def threshold(
    system: MotionSystem, speeds: Array, guess: Array
) -> tuple[float, float, Array, ComplexArray] | None:
    """Return the first speed at which the static position becomes unstable.

    Returns speed, frequency : float: [rad/s]
    Returns position, shape : (n,) arrays: Static position [m] and the unstable mode there; or None:
        it stays stable.
    """

    def least_stable(speed: float, guess: Array) -> tuple[complex, Array, ComplexArray]:
        plain = system.plain(speed, speed)
        rest, _ = static_position(system, plain, speed, guess)
        q, v, n = rest.copy(), np.zeros_like(rest), system.size
        q[rings], v[rings] = 0.0, rest[rings]
        k, d = derivatives(q, v, speed, system.scale, plain)
        matrix = np.block([[np.zeros((n, n)), np.eye(n)], [-plain.inverse @ k, -plain.inverse @ d]])
        found = np.linalg.eig(matrix)
        values = np.asarray(found.eigenvalues, dtype=np.complex128)
        shapes = np.asarray(found.eigenvectors, dtype=np.complex128)
        growing = np.where(np.abs(values.imag) > 0.02 * speed, values.real, -np.inf)
        i = int(np.argmax(growing))
        shape = shapes[:n, i] if values[i].imag > 0.0 else shapes[:n, i].conj()
        return complex(values[i].real, abs(values[i].imag)), rest, shape

    rings, before = rings_of(system), None
    for speed in speeds:
        value, rest, _ = least_stable(float(speed), guess)
        if before is not None and before[1] < 0.0 <= value.real:
            low, high = before[0], float(speed)
            for _ in range(40):
                middle = 0.5 * (low + high)
                value, rest, _ = least_stable(middle, rest)
                low, high = (low, middle) if value.real >= 0.0 else (middle, high)
            value, rest, shape = least_stable(high, rest)
            return high, value.imag, rest, shape
        before, guess = (float(speed), value.real), rest
    return None


@on_one_blas_thread
def follow_limit_cycle(
    system: MotionSystem,
    guess: Array,
    speeds: tuple[float, float],
    *,
    points: int = 60,
    harmonics: int = _HARMONICS,
) -> Branch:
    """Follow the limit cycle that begins where the static position becomes unstable.

    system : Its unbalance and loads are left out.
    guess : (n,) array. Static position at the lower speed [m].
    speeds : (float, float). Between which thresholds are looked for and the branch is followed
        [rad/s].
    points : Of the branch, at most.

    Raises InputError: The static position is stable throughout, or a film has no closed form.
    """
    balance = _Balance(system, harmonics, None)
    found = threshold(system, np.linspace(*speeds, 41), guess)
    if found is None:
        raise InputError(
            "the static position is stable between these speeds, or unstable at the lowest",
            key="operating.speed", value=speeds,
        )  # fmt: skip
    hopf, frequency, rest, shape = found
    held = balance.held
    clearance = min(link.force.radial_clearance for link in system.links if link.film)
    shape[balance.rings] *= 1j * frequency
    moved = np.delete(np.abs(shape), balance.rings).max()
    shape = shape / moved * _FIRST * clearance
    c, units = np.zeros((balance.count, held.size)), balance.units(clearance, hopf)
    c[0], c[1], c[1 + harmonics] = rest[held], np.real(shape), -np.imag(shape)
    start = np.concatenate([c.ravel() / units, [frequency / hopf, 1.0]])
    tangent = np.zeros_like(start)
    tangent[:-2] = c.ravel() / units
    tangent[: held.size] = 0.0
    return _follow(balance, start, tangent, hopf, clearance, speeds, points, hopf)


@on_one_blas_thread
def follow_forced(
    system: MotionSystem,
    guess: Array,
    speeds: tuple[float, float],
    *,
    turns: int = 1,
    points: int = 120,
    harmonics: int = _HARMONICS,
    start: Motion | None = None,
) -> Branch:
    """Follow the periodic response to unbalance over speed, folds included.

    turns : Of the shaft in one period: 2 for motions locked to half the shaft's frequency.
    start : A run of this system at one speed that has become periodic: the branch begins there,
        upwards, at folds back down; by default at the lower speed with small motions.

    Other parameters are those of `follow_limit_cycle`.
    """
    balance = _Balance(system, harmonics, turns)
    low = speeds[0] if start is None else float(start.speed[-1])
    rest, _ = static_position(system, system.plain(low, low), low, guess)
    clearance = min(link.force.radial_clearance for link in system.links if link.film)
    c = np.zeros((balance.count, balance.held.size))
    c[0] = rest[balance.held]
    if start is not None:
        last = start.part(-turns * start.problem.samples_per_revolution)
        angle = last.angle[:, None] / turns * np.arange(1, harmonics + 1)
        waves = np.hstack([np.ones((angle.shape[0], 1)), np.cos(angle), np.sin(angle)])
        moved = last.q.copy()
        moved[:, balance.rings] = last.v[:, balance.rings]
        c = np.linalg.lstsq(waves, moved, rcond=None)[0]
    first = np.concatenate([c.ravel() / balance.units(clearance, low), [1.0 / turns, 1.0]])
    tangent = np.zeros_like(first)
    tangent[-1] = 1.0
    return _follow(balance, first, tangent, low, clearance, speeds, points, None)


def _follow(
    balance: _Balance, start: Array, tangent: Array, unit: float, clearance: float,
    speeds: tuple[float, float], points: int, hopf: float | None,
) -> Branch:  # fmt: skip
    """Predict along the tangent, correct across it; steps grow and shrink with Newton's work."""
    free, turns = balance.forced is None, float(balance.forced or 1)
    h = balance.harmonics
    s, units = balance.held.size, balance.units(clearance, unit)

    def answer(z: Array, reference: Array) -> tuple[Array, Array]:
        """Return scaled residual with the phase's condition, and its Jacobian but one row."""
        c, frequency, speed = z[:-2] * units, z[-2] * unit, z[-1] * unit
        off, by_c, by_w = balance.residual(c, frequency, speed)
        step = 1e-6 * speed
        more = balance.residual(c, frequency, speed + step)[0]
        force = float(np.abs(by_c * units).max()) * 1e-3
        rows = [np.column_stack([by_c * units, by_w * unit, (more - off) / step * unit]) / force]
        ends = [off / force]
        condition = np.zeros(z.size)
        if free:
            # as close in phase as can be to the cycle before
            waves = reference[:-2].reshape(-1, s)
            turned = np.zeros_like(waves)
            for k in range(1, h + 1):
                turned[k], turned[h + k] = k * waves[h + k], -k * waves[k]
            condition[:-2] = turned.ravel() / max(float(np.abs(turned).max()), 1e-12)
            ends.append(np.array([condition @ (z - reference)]))
        else:
            condition[-2], condition[-1] = 1.0, -1.0 / turns
            ends.append(np.array([z[-2] - z[-1] / turns]))
        rows.append(condition[None])
        return np.concatenate(ends), np.vstack(rows)

    def corrected(z: Array, tangent: Array, reference: Array) -> tuple[Array, Array, int] | None:
        predicted = z.copy()
        for step in range(_STEPS):
            off, jacobian = answer(z, reference)
            matrix = np.vstack([jacobian, tangent])
            right = np.append(off, tangent @ (z - predicted))
            if not np.all(np.isfinite(matrix)):
                return None
            ahead = np.zeros(right.size)
            ahead[-1] = 1.0
            try:
                change, new = np.linalg.solve(matrix, np.column_stack([right, ahead])).T
            except np.linalg.LinAlgError:
                return None
            z = z - change
            if balance.films(z[:-2] * units, z[-2] * unit)[1] <= 0.0:
                return None
            if np.abs(change).max() < 1e-7:
                return z, new / np.linalg.norm(new), step + 1
        return None

    tangent = tangent / np.linalg.norm(tangent)
    rows: list[tuple[float, float, Array, float, bool]] = []
    z, length, message = start, 0.05, "as many points as were asked for"
    point = corrected(z, tangent, start)
    if point is None:
        raise InputError("the first point of the branch was not found", key="operating.speed")
    z, tangent, _ = point
    while len(rows) < points:
        c, frequency, speed = z[:-2] * units, float(z[-2] * unit), float(z[-1] * unit)
        sizes, least = balance.films(c, frequency)
        growth = np.abs(balance.multipliers(c, frequency, speed))
        rows.append((speed, frequency, sizes, least, bool(growth.max() < 1.0 + 1e-6)))
        if not min(speeds) <= speed <= max(speeds):
            message = "the end of the speeds"
            break
        while True:
            found = corrected(z + length * tangent, tangent, z)
            if found is not None:
                break
            length *= 0.5
            if length < 1e-5:
                break
        if found is None:
            message = "the films nearly touch" if rows[-1][3] < 0.02 * clearance else (
                "the next point was not found")  # fmt: skip
            break
        if tangent @ found[1] < 0.0:
            found = found[0], -found[1], found[2]
        z, tangent = found[0], found[1]
        length = min(length * (1.5 if found[2] <= 4 else 0.8), 0.3)
    speed, frequency, sizes, least, stable = zip(*rows, strict=True)
    names = tuple(link.name for link in balance.system.links if link.film)
    return Branch(
        np.array(speed), np.array(frequency), np.array(sizes), np.array(least), np.array(stable),
        hopf, names, message,
    )  # fmt: skip
