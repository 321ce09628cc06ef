"""A second method for films of any bore, loosely meshed: nodes and Gauss-Seidel sweeps, a scan of
all positions; nothing shared with rotorsim but the description of the bearing.

It answers whether some journal position carries a load, where rotorsim says that none does.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from numba import njit

from rotorsim.model import Case, LoadTarget

SHARES = (0.1, 0.3, 0.5, 0.65, 0.8, 0.9, 0.95, 0.98, 0.993, 0.998)


@njit(cache=True)
def _sweep(a, carried, held, p, liquid, kind, factor, sweeps, tolerance):
    """Relax p (n, m); kind 0 bears tension, 1 does not, 2 conserves the oil."""
    n, m = p.shape
    largest = 0.0
    for sweep in range(sweeps):
        change, scale = 0.0, 1e-30
        for i in range(n):
            west, east = (i - 1) % n, (i + 1) % n
            for j in range(1, m - 1):
                if held[i, j]:
                    continue
                inflow = carried[west, j] * (liquid[west, j] if kind == 2 else 1.0)
                inflow += a[0, west, j] * p[west, j] + a[0, i, j] * p[east, j]
                inflow += a[1, i, j - 1] * p[i, j - 1] + a[1, i, j] * p[i, j + 1]
                total = a[0, west, j] + a[0, i, j] + a[1, i, j - 1] + a[1, i, j]
                full = (inflow - carried[i, j]) / total
                new = p[i, j] + factor * (full - p[i, j])
                if kind > 0 and new < 0.0:
                    new = 0.0
                if kind == 2:
                    share = 1.0 if full > 0.0 else min(inflow / carried[i, j], 1.0)
                    new = new if full > 0.0 else 0.0
                    change = max(change, largest * abs(share - liquid[i, j]))
                    liquid[i, j] = share
                change = max(change, abs(new - p[i, j]))
                scale = max(scale, abs(new))
                p[i, j] = new
        largest = scale
        if sweep > 20 and change < tolerance * scale:
            return


def _one_stretch(p, bound, held):
    """Nodes behind the first film of a line, up to the next `bound` row: none forms there again.

    The film that is kept holds the line's highest pressure; one that begins at a `held` node, or
    touches one under pressure, is fed and stays.
    """
    gone = np.zeros(p.shape, dtype=bool)
    edges = [*np.flatnonzero(bound), *(np.flatnonzero(bound)[:1] + len(p))]
    for j, line in enumerate(p.T):
        for first, last in itertools.pairwise(edges):
            rows = [i % len(p) for i in range(first + 1, last)]
            films = [list(g) for wet, g in itertools.groupby(rows, (line > 0.0).item) if wet]
            best = max(films, key=lambda film: line[film].max(), default=None)
            for film in films:
                before, behind = film[0] - 1, (film[-1] + 1) % len(p)
                fed = held[before, j] or (held[behind, j] and p[behind, j] > 0.0)
                fed = fed or any(held[i, j] for i in film)
                if film is not best and not fed:
                    gone[film, j] = True
    return gone


class NodalFilm:
    """Force of an isoviscous film at any position; load frame."""

    def __init__(self, case: Case, speed: float, viscosity: float, shape=(96, 13)) -> None:
        self.case, self.speed, self.viscosity, self.shape = case, speed, viscosity, shape
        self.bearing, self.clearance = case.bearing, case.bearing.radial_clearance
        self.begins = self.bearing.is_plain and case.film.inception.value == "max_film"
        self.rupture = case.film.cavitation.value
        self.once = case.film.inception.value == "max_film" and self.rupture == "reynolds"
        """Whether a film that has ruptured stays so up to its next beginning."""

    def thickness(self, theta, y, x, z):
        h = np.full(theta.shape, self.clearance)
        for arc in self.bearing.arcs:
            inside = (theta - arc.start) % math.tau < arc.end - arc.start
            lobe = arc.preload * self.clearance * np.cos(theta - arc.preload_angle)
            h = np.where(inside, self.clearance - lobe, h)
        along, across = self.bearing.misalignment
        return (
            h[:, None]
            - (x + along * y) * np.cos(theta)[:, None]
            - (z + across * y) * np.sin(theta)[:, None]
        )

    def groove_pressure(self, theta, y):
        found = np.full((theta.size, y.size), np.nan)
        for groove in self.bearing.grooves:
            away = np.abs((theta - groove.center + math.pi) % math.tau - math.pi)
            inside = np.abs(y) <= 0.5 * (groove.length or self.bearing.length) + 1e-12
            found[(away < 0.5 * groove.extent + 1e-12)[:, None] & inside] = groove.supply_pressure
        return found

    def bounds(self, theta, held):
        """Rows at which a film may begin: full-length grooves, lobes, the thickest film."""
        found = held.all(axis=1)
        for arc in self.bearing.arcs:
            found[np.argmin(np.abs((theta - arc.start + math.pi) % math.tau - math.pi))] = True
        if self.begins or not found.any():
            found[0] = True
        return found

    def thinnest(self, x, z):
        """Least film over the lands [m]."""
        theta = np.linspace(0.0, math.tau, 720, endpoint=False)
        y = self.bearing.length * np.array([-0.5, 0.0, 0.5])
        land = np.isnan(self.groove_pressure(theta, y))
        return float(self.thickness(theta, y, x, z)[land].min())

    def reach(self, angle):
        """Distance from the centre to the bore [m]."""
        low, high = 0.0, 3.0 * self.clearance
        for _ in range(50):
            middle = 0.5 * (low + high)
            if self.thinnest(middle * math.cos(angle), middle * math.sin(angle)) > 0.0:
                low = middle
            else:
                high = middle
        return low

    def force(self, x, z, tolerance=1e-6):
        """Force on the journal [N], (2,)."""
        (n, m), length, radius = self.shape, self.bearing.length, self.bearing.journal_radius
        first = math.atan2(z, x) - math.pi if self.begins else -math.pi
        fine = first + np.linspace(0.0, math.tau, 2881)
        ends = length * np.array([-0.5, 0.0, 0.5])
        h = np.maximum(self.thickness(fine, ends, x, z).min(axis=1), 3e-3 * self.clearance)
        density = 0.4 / math.tau + 0.6 / h / np.trapezoid(1.0 / h, fine)
        place = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]))])
        theta = np.interp(np.arange(n) / n, place / place[-1], fine)
        for groove in self.bearing.grooves:
            for edge in (groove.center - 0.5 * groove.extent, groove.center + 0.5 * groove.extent):
                away = (theta - edge + math.pi) % math.tau - math.pi
                theta[np.argmin(np.abs(away))] -= away[np.argmin(np.abs(away))]
        theta = np.sort(theta)
        step = np.maximum(np.diff(theta, append=theta[0] + math.tau), 1e-9)
        y = np.linspace(-0.5 * length, 0.5 * length, m)
        dx, dy = radius * step, y[1] - y[0]
        least = 1e-5 * self.clearance
        face = np.maximum(self.thickness(theta + 0.5 * step, y, x, z), least)
        here = np.maximum(self.thickness(theta, y, x, z), least)
        width = 0.5 * (dx + np.roll(dx, 1))[:, None]
        a = np.zeros((2, n, m))
        a[0] = face**3 / (12.0 * self.viscosity) * dy / dx[:, None]
        a[1, :, :-1] = (0.5 * (here[:, 1:] + here[:, :-1])) ** 3 / (12.0 * self.viscosity)
        a[1] *= width / dy
        pressure = self.groove_pressure(theta, y)
        held = ~np.isnan(pressure)
        p = np.where(held, pressure, 0.0)
        p[:, [0, -1]] = 0.0
        if self.begins:
            held[0], p[0] = True, 0.0
        kind = {"reynolds": 1, "jfo": 2}.get(self.rupture, 0)
        carried = 0.5 * self.speed * radius * face * dy
        factor, sweeps = (1.0, 4000) if kind == 2 else (1.75, 8000)
        _sweep(a, carried, held, p, np.ones((n, m)), kind, factor, sweeps, tolerance)
        for _ in range(6 if self.once else 0):
            gone = _one_stretch(p, self.bounds(theta, held), held)
            if not gone.any():
                break
            held, p = held | gone, np.where(gone, 0.0, p)
            _sweep(a, carried, held, p, np.ones((n, m)), kind, factor, sweeps, tolerance)
        p = p if self.rupture == "full_sommerfeld" else np.maximum(p, 0.0)
        load = (p * width * dy).sum(axis=1)
        return -np.array([load @ np.cos(theta), load @ np.sin(theta)])

    def least_misfit(self) -> float:
        """Least unbalanced force over the load: of a scan, then of Newton's method from its best.

        At a given eccentricity: the least angle between the force and the load line [rad].
        """
        target = self.case.target
        angles = np.linspace(-math.pi, math.pi, 36, endpoint=False)
        if not isinstance(target, LoadTarget):
            size, found = target.eccentricity_ratio * self.clearance, [math.pi]
            for angle in angles:
                x, z = size * math.cos(angle), size * math.sin(angle)
                if self.thinnest(x, z) > 0.0:
                    force = self.force(x, z)
                    if force.any():
                        found.append(abs(math.atan2(-force[1], -force[0])))
            return min(found)
        load, scan = target.load, []
        for angle in angles:
            reach = self.reach(angle)
            for share in SHARES:
                q = share * reach * np.array([math.cos(angle), math.sin(angle)])
                scan.append((math.hypot(*(self.force(q[0], q[1], 3e-5) / load + [1.0, 0.0])), *q))
        return min(self._improved(np.array(q), load) for _, *q in sorted(scan)[:4])

    def _improved(self, q, load):
        def off(place):
            if self.thinnest(*place) < 5e-4 * self.clearance:
                return np.array([9.0, 9.0])
            return self.force(*place) / load + [1.0, 0.0]

        now = off(q)
        for _ in range(20):
            small = 1e-3 * min(self.clearance, self.thinnest(*q))
            slope = np.stack([(off(q + small * e) - now) / small for e in np.eye(2)], axis=1)
            step = -np.linalg.lstsq(slope, now, rcond=None)[0]
            step *= min(1.0, 0.2 * self.clearance / max(math.hypot(*step), 1e-300))
            for _ in range(8):
                after = off(q + step)
                if math.hypot(*after) < math.hypot(*now):
                    break
                step = 0.4 * step
            else:
                break
            q, now = q + step, after
        return math.hypot(*now)
