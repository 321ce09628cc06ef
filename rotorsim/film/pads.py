"""Equilibrium of journal and tilting pads.

Seen from its pivot, a pad is an arc of a plain bore around a journal at the eccentricity

    E_n = e_n + m c_p - xi,    E_t = e_t + (R + t) delta

(along the pivot's radius and across it), h = c_p - E_n cos(theta - theta_p) - E_t sin(theta -
theta_p). Its tilt is free, so E_t settles where the film's moment about the pivot vanishes. A pad
tilted so far back that its film diverges everywhere carries nothing and fulfils that trivially; the
root that carries load lies above it, and there the moment falls with the tilt. With E_n > 0 it is
bracketed: at E_t = 0 most pressure lies ahead of the pivot, where the trailing edge touches, behind
it (see `PadFrame.least_across` for a pivot ahead of the middle). With E_n <= 0 only a pivot behind
the middle has one, if any; a pad without one is unloaded.

The load of each pad is then a rising function of E_n alone, so that Newton's method for the
journal, kept off the pads, finds the one equilibrium; journal, tilts, pivots and pitches move
together, with the film's own stiffness for the Jacobian.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..arrays import Array, Booleans
from ..model import EccentricityTarget, Target
from ..model.operating import is_unloaded
from .banded import NoFilmError
from .equilibrium import pressure_force
from .geometry import CENTER
from .growth import hot_problem
from .layers import LayerIntegrals
from .linearization import stiffness_matrix
from .pad_frame import PadFrame, pad_frames
from .problem import FilmProblem, FilmState, film_state

_RETURNS = 3
"""Times that a pad may become unloaded and loaded again before its E_n may no longer cross zero."""
_FILM_KEPT = 0.35
"""Part of each pad's thinnest film that a step must leave."""
_LARGEST_STEP = 0.3
"""Of E_n and E_t, relative to the clearance."""
_THINNEST = 1e-4
"""Film thickness relative to the clearance at which the search gives up."""
_LEAST_ECCENTRICITY = 1e-8
"""E_n relative to the clearance above which a pad carries load wherever its pivot stands."""
_THERMAL_WEDGE = 0.15
"""Of E_t, relative to the clearance, below the least of an isothermal pad, where a root of a heated
one is looked for."""
_SLACK = 0.05
"""Stiffness of the journal over load per clearance, added while the forces are far off."""
_SETTLED = 0.005
"""Distance of the centre of pressure from the pivot, in pad angles, at which a tilt is known
roughly."""
_SAMPLES = 16
"""Tilts at which the root of a pad with E_n <= 0 is looked for."""


class PadSearch:
    """Newton's method for journal and pads; see `solve_thermal_film`.

    problem : With all its pads.
    target : Load along x, or eccentricity ratio.
    """

    def __init__(self, problem: FilmProblem, target: Target) -> None:
        self.whole: FilmProblem = problem
        self.problem: FilmProblem = problem
        """With the unloaded pads' films standing still."""
        self.target = target
        self.unreachable: bool = False
        self.held = False
        """True where the journal stays where it is and only the pads move."""
        self.unloaded: frozenset[int] = frozenset()
        self._returns: Counter[int] = Counter()
        """Times each pad has been unloaded before; from zero its load rises infinitely steep.
        """
        self._revived: frozenset[int] = frozenset()
        self._lost: frozenset[int] = frozenset()
        """Pads that are taken as loaded and have no film."""

    @cached_property
    def frames(self) -> tuple[PadFrame, ...]:
        """Frames of the pads."""
        return pad_frames(self.whole.bearing, self.whole.mesh)

    @cached_property
    def _weights(self) -> Array:
        """Return the factors from generalised forces to ones on the journal [1 or 1/m]."""
        displacements = self.whole.geometry.displacements
        return displacements.scales / self.whole.bearing.radial_clearance

    def first_guess(self) -> Array:
        """Return the displacements to begin with: the journal half-way to the pads, along the load.

        Raises NoFilmError: At the given eccentricity the journal touches a pad wherever it stands.
        """
        q = np.zeros(len(self._weights))
        if isinstance(self.target, EccentricityTarget):
            for angle in math.pi / 36.0 * np.array(sorted(range(-36, 37), key=abs)):
                place = self.at(float(angle))
                if place is not None:
                    return place
            raise NoFilmError("the journal touches a pad wherever it stands at this eccentricity")
        q[0] = 0.5 * min(self.reach(0.0), self.whole.bearing.radial_clearance)
        clearance, thinnest = self.whole.bearing.radial_clearance, self.whole.geometry.thinnest_at
        while thinnest(self._with_room(q)) <= 0.05 * clearance and q[0] > 1e-3 * clearance:
            q[0] *= 0.7
        if thinnest(q) <= 0.0:
            raise NoFilmError("the misaligned journal touches a pad even when it is centred")
        return q

    def at(self, angle: float) -> Array | None:
        """Return displacements with the journal at an eccentricity and `angle` [rad].

        None where it would touch a pad.
        """
        assert isinstance(self.target, EccentricityTarget)
        q = np.zeros(len(self._weights))
        size = self.target.eccentricity_ratio * self.whole.bearing.radial_clearance
        q[0], q[1] = size * math.cos(angle), size * math.sin(angle)
        if size >= self.reach(angle):
            return None
        return q if self.whole.geometry.thinnest_at(self._with_room(q)) > 0.0 else None

    def reach(self, angle: float) -> float:
        """Return how far the journal, moved along `angle`, gets until it touches a pad [m].

        Pads on flexible pivots give way and do not count.
        """
        distances = [math.inf]
        for frame in self.frames:
            towards = math.cos(angle - frame.pad.pivot_angle)
            if towards > 1e-9 and frame.unknowns.pivot is None:
                distances.append((1.0 - frame.preload) * frame.clearance / towards)
        return min(distances)

    def nearer(self, q: Array) -> Array | None:
        """Move half-way on to the pads along the load.

        For a journal that no pad carries where it is.
        """
        if isinstance(self.target, EccentricityTarget) or is_unloaded(self.target):
            return None
        q = q.copy()
        q[0] += 0.5 * (min(self.reach(0.0), q[0] + self.whole.bearing.radial_clearance) - q[0])
        return q if self.whole.geometry.thinnest_at(self._with_room(q)) > 0.0 else None

    def give_way(self, q: Array) -> str:
        """Name the pivot that gives way most, if by more than its pad's clearance."""
        moved = {
            number + 1: float(q[frame.unknowns.pivot]) / frame.clearance
            for number, frame in enumerate(self.frames)
            if frame.unknowns.pivot is not None
        }
        number = max(moved, key=lambda one: moved[one], default=0)
        if not moved or moved[number] < 1.0:
            return ""
        return (
            f" (pad {number}'s pivot gives way by {moved[number]:.3g} clearances: it is too soft)"
        )

    def _with_room(self, q: Array) -> Array:
        """Level the pads, and push flexible pivots back where the journal would touch."""
        for frame in self.frames:
            if frame.unknowns.pivot is not None:
                along = frame.eccentricity(q)[0] + q[frame.unknowns.pivot]
                q[frame.unknowns.pivot] = max(0.0, along - 0.9 * frame.clearance)
            q[frame.unknowns.tilt] = frame.level_tilt(q)
        return q

    def grown(self, problem: FilmProblem) -> None:
        """Take over the clearances of `problem`."""
        self.problem = problem
        self.whole = hot_problem(self.whole, problem.bearing)
        self.__dict__.pop("frames", None)

    # --- what Newton's method needs -------------------------------------------------------------

    def missing(self, state: FilmState) -> Array:
        """Return the generalised forces that are not in balance, (q,)."""
        missing = state.force.copy()
        if not isinstance(self.target, EccentricityTarget):
            missing[0] += self.target.load
        for number, frame in enumerate(self.frames):
            if number in self.unloaded:
                missing[frame.unknowns.places] = 0.0
                continue
            bends = list(frame.unknowns.bends)
            missing[bends] -= frame.springs * state.displacement[bends]
            if frame.unknowns.pivot is not None:
                place = frame.unknowns.pivot
                wanted, stiffness = self._pivot_under(state, frame)
                missing[place] = stiffness * (wanted - float(state.displacement[place]))
        return missing

    def _pivot_under(self, state: FilmState, frame: PadFrame) -> tuple[float, float]:
        """Return deflection and stiffness of a pad's pivot under the film's force.

        Newton's method takes the pivot's law at the film's force rather than at the deflection:
        a contact without load has no stiffness.
        """
        assert frame.unknowns.pivot is not None
        force = max(float(state.force[frame.unknowns.pivot]), 0.0)
        deflection = frame.pad.pivot.deflection(force)
        return deflection, frame.pad.pivot.stiffness_at(deflection)

    def stiffness(self, state: FilmState) -> Array:
        """Return the film, pivots and bent pads, (q, q); an unloaded pad's unknowns stand alone."""
        stiffness = stiffness_matrix(state)
        for number, frame in enumerate(self.frames):
            if number in self.unloaded:
                for place in frame.unknowns.places:
                    stiffness[place, place] = 1.0
                continue
            bends = list(frame.unknowns.bends)
            stiffness[bends, bends] += frame.springs
            if frame.unknowns.pivot is not None:
                place = frame.unknowns.pivot
                stiffness[place, place] += self._pivot_under(state, frame)[1]
        return stiffness

    def __call__(self, state: FilmState) -> tuple[Array, float]:
        """Return Newton's next displacements, and the forces' error over the load."""
        q, weights = state.displacement, self._weights
        missing = self.missing(state) * weights
        stiffness = self.stiffness(state) * weights[:, None] * weights[None, :]
        self._lost = self.without_film(state) - self.unloaded
        for number, frame in enumerate(self.frames):
            if number in self._lost:  # leave it to `allowed` to bring it back
                for place in frame.unknowns.places:
                    stiffness[place, :] = stiffness[:, place] = 0.0
                    stiffness[place, place] = 1.0
        carried = float(np.hypot(state.force[0], state.force[1]))
        if self.held:
            missing[:2], stiffness[:2], stiffness[:, :2] = 0.0, 0.0, 0.0
            stiffness[[0, 1], [0, 1]] = 1.0
            off = float(np.linalg.norm(missing)) / max(carried, 1e-9 * self._pressed(state))
            step = _solve(stiffness, missing)
        elif isinstance(self.target, EccentricityTarget):
            off = float(np.linalg.norm(missing[1:])) / max(carried, 1e-300)
            off = max(off, 1.0) if missing[0] >= 0.0 else off
            step = self._turn(q, missing, stiffness, _SLACK * min(off, 1.0) * carried)
        else:
            load = self.target.load or pressure_force(state)
            off = float(np.linalg.norm(missing)) / load
            # A journal on one pad alone has no stiffness across: let it slide, not leap.
            slack = _SLACK * min(off, 1.0) * load / self.whole.bearing.radial_clearance
            stiffness[[0, 1], [0, 1]] += slack
            step = _solve(stiffness, missing)
        following = self.allowed(q, q + weights * step)
        film = self.problem.geometry.thickness(q).min(axis=(0, 2))
        thin = min(film[frame.columns].min() / frame.clearance for frame in self.frames)
        self.unreachable = bool(thin < 2.0 * _THINNEST and off > 1e-3)
        return following, off

    def _pressed(self, state: FilmState) -> float:
        """Return sum of the pads' loads [N], to compare forces with where there is no load."""
        load = np.abs(state.solution.pressure * state.operator.area)
        pressed = float(load[self.whole.mesh.region >= 0].sum())
        return max(self.whole.mesh.multiplicity * pressed, 1e-300)

    def _turn(self, q: Array, missing: Array, stiffness: Array, slack: float) -> Array:
        """Return Newton's step that keeps the journal at its distance from the centre."""
        size = float(np.hypot(q[0], q[1]))
        across = np.array([-q[1], q[0]]) / size
        reduced = np.column_stack([stiffness[1:, :2] @ across, stiffness[1:, 2:]])
        reduced[0, 0] += slack / self.whole.bearing.radial_clearance * across[1]
        solved = _solve(reduced, missing[1:])
        turned = math.atan2(q[1], q[0]) + max(-0.3, min(0.3, float(solved[0]) / size))
        step = np.concatenate([size * np.array([math.cos(turned), math.sin(turned)]), solved[1:]])
        step[:2] -= q[:2]
        return step

    def without_film(self, state: FilmState) -> frozenset[int]:
        """Return the numbers of the pads without pressure."""
        return frozenset(k for k, f in enumerate(self.frames) if not self._carries(state, f))

    def _carries(self, state: FilmState, frame: PadFrame) -> bool:
        return bool(state.solution.pressure[frame.columns].max() > 0.0)

    def allowed(self, old: Array, new: Array, /) -> Array:
        """Shorten a step that goes too far, and keep each pad above its trivial root."""
        geometry, step = self.problem.geometry, new - old
        clearance = self.whole.bearing.radial_clearance
        loaded = [f for k, f in enumerate(self.frames) if k not in self.unloaded]
        scale = 1.0
        for number, frame in enumerate(self.frames):
            before, after = frame.eccentricity(old)[0], frame.eccentricity(new)[0]
            room = _LARGEST_STEP * max(frame.clearance, -before)
            if number in self.unloaded:
                room = 0.5 * (frame.clearance - before)
                after = max(after, before)
            elif self._returns[number] >= _RETURNS and before > 0.0 and after < before:
                room = min(room, 0.75 * before)
            scale = min(scale, max(room, 0.0) / max(abs(after - before), 1e-300))
        film = geometry.thickness(old)
        floors = [
            max(_FILM_KEPT * float(film[:, frame.columns].min()), _THINNEST * frame.clearance)
            for frame in loaded
        ]
        result = old
        while scale > 1e-6:
            result = self._above_trivial(old, old + scale * step)
            h = geometry.thickness(result)
            if all(
                float(h[:, frame.columns].min()) >= floor
                for frame, floor in zip(loaded, floors, strict=True)
            ):
                break
            scale *= 0.6
        else:
            return old
        if isinstance(self.target, EccentricityTarget) and scale < 1.0 and not self.held:
            size = self.target.eccentricity_ratio * clearance
            result[:2] *= size / float(np.hypot(result[0], result[1]))
        return result

    def _above_trivial(self, old: Array, new: Array) -> Array:
        """Keep E_t near, and of every pad with E_n > 0 where its film carries.

        Oil that thins on its way makes pressure in a film that diverges, too: a heated pad with its
        pivot ahead of the middle is brought back only where it has lost its film.
        """
        new = new.copy()
        for number, frame in enumerate(self.frames):
            if number in self.unloaded:
                continue
            along, across = frame.eccentricity(new)
            turned = across - frame.eccentricity(old)[1]
            if abs(turned) > _LARGEST_STEP * frame.clearance:
                excess = turned - math.copysign(_LARGEST_STEP * frame.clearance, turned)
                new[frame.unknowns.tilt] -= excess / frame.arm
                across -= excess
            if along <= 0.0 or self._skewed:
                continue
            least, before = frame.least_across(along), frame.eccentricity(old)[1]
            kept = least + max(0.3 * (before - least), 0.02 * along)
            wedged = self.whole.is_thermal and frame.pad.offset < 0.5
            if wedged and number in self._lost:
                kept = max(kept, before + 0.02 * along)
            elif wedged or across > least:
                continue
            new[frame.unknowns.tilt] += (kept - across) / frame.arm
        return new

    # --- tilts of pads far from their equilibrium -----------------------------------------------

    def settle(self, q: Array, layers: LayerIntegrals) -> Array:
        """Return `q` with every pad's tilt near its root at the journal's position.

        Decides which pads are unloaded, and lets their films stand still in `problem`.
        """
        q, guess = q.copy(), q
        brackets: dict[int, tuple[float, float]] = {}
        asked: list[int] = []
        for frame in self.frames:
            if frame.unknowns.pivot is not None:
                q[frame.unknowns.pivot] = max(q[frame.unknowns.pivot], 0.0)
        film = self.whole.geometry.thickness(q)
        for number, frame in enumerate(self.frames):
            limits = frame.tilt_limits(film, q)
            above = self._above(frame, q)
            if self._asks(frame, above):
                asked.append(number)
            elif above:
                least = frame.least_across(frame.eccentricity(q)[0])
                if self.whole.is_thermal and frame.pad.offset < 0.5:
                    least -= _THERMAL_WEDGE * frame.clearance
                brackets[number] = (
                    max(frame.level_tilt(q) + least / frame.arm, limits[0]),
                    limits[1],
                )
            q[frame.unknowns.tilt] = frame.idle_tilt(limits, q)
        full: Booleans | None = None
        if asked:
            found, full = self._sampled(q, asked, layers)
            brackets.update(found)
        q = self._bracketed(q, self._roots(brackets, guess), layers, full)
        self._keep_out(frozenset(range(len(self.frames))) - frozenset(brackets), q)
        return q

    def _roots(self, brackets: dict[int, tuple[float, float]], guess: Array) -> dict[int, _Root]:
        return {
            number: _Root(*bracket, guess=float(guess[self.frames[number].unknowns.tilt]))
            for number, bracket in brackets.items()
        }

    def as_found(self, q: Array, unloaded: frozenset[int]) -> Array:
        """Begin at the displacements and with the unloaded pads of another mesh; return `q`."""
        self._keep_out(unloaded, q)
        return q

    @property
    def _fed(self) -> bool:
        """Return whether grooves press on the pads' edges, so that each pad may have pressure."""
        return any(groove.supply_pressure > 0.0 for groove in self.whole.bearing.grooves)

    @property
    def _skewed(self) -> bool:
        """Return whether E_n and E_t, at the mid-plane, do not tell where a pad's root lies."""
        return self._fed or self._starves or not self.whole.bearing.is_symmetric

    @property
    def _starves(self) -> bool:
        """Return whether a pad's film may begin behind its leading edge."""
        bearing = self.whole.bearing
        return bearing.supply_flow is not None and self.whole.rupture.conserves_mass

    def _keep_out(self, unloaded: frozenset[int], q: Array) -> None:
        for number in self.unloaded - unloaded:
            self._returns[number] += 1
        self.unloaded = unloaded
        self.problem = self.whole
        if unloaded:
            columns = np.isin(self.whole.mesh.region, list(unloaded))
            geometry = self.whole.geometry.without(columns, q)
            self.problem = replace(self.whole, geometry=geometry)

    def _levers(self, state: FilmState) -> Array:
        """Return moment of each pad over (R + t) times its pressure's integral.

        NaN without pressure.
        """
        load = state.solution.pressure * state.operator.area
        levers = np.full(len(self.frames), np.nan)
        for number, frame in enumerate(self.frames):
            part = load[frame.columns]
            total = float(np.abs(part).sum())
            if total > 0.0:
                levers[number] = -float((part * frame.sine[CENTER]).sum()) / total
        return levers

    def _sampled(
        self, q: Array, asked: list[int], layers: LayerIntegrals
    ) -> tuple[dict[int, tuple[float, float]], Booleans | None]:
        """Bracket the uppermost root of each pad `asked` for, where its moment falls."""
        film = self.whole.geometry.thickness(q)
        limits = {n: self.frames[n].tilt_limits(film, q) for n in asked}
        shares = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
        levers, full = [], None
        for share in shares:
            for number in asked:
                low, high = limits[number]
                q[self.frames[number].unknowns.tilt] = low + share * (high - low)
            state = film_state(self.whole, q, layers, start=full)
            full = state.solution.full
            levers.append(self._levers(state))
        found: dict[int, tuple[float, float]] = {}
        for number in asked:
            frame, (low, high) = self.frames[number], limits[number]
            values = np.array([row[number] for row in levers])
            rising = np.flatnonzero(values > 0.0)
            if rising.size and rising[-1] + 1 < _SAMPLES:
                at = low + shares[[rising[-1], rising[-1] + 1]] * (high - low)
                found[number] = (float(at[0]), float(at[1]))
            elif rising.size:
                found[number] = (float(low + shares[-1] * (high - low)), high)
            else:
                q[frame.unknowns.tilt] = frame.idle_tilt((low, high), q)
        return found, full

    def _bracketed(
        self,
        q: Array,
        roots: dict[int, _Root],
        layers: LayerIntegrals,
        full: Booleans | None,
    ) -> Array:
        """Find all bracketed roots roughly, each pad by itself but in the same films (Illinois)."""
        for _ in range(40):
            for number, root in roots.items():
                q[self.frames[number].unknowns.tilt] = root.next
            state = film_state(self.whole, q, layers, start=full)
            full = state.solution.full
            levers = self._levers(state)
            for number, root in roots.items():
                root.record(float(levers[number]), _SETTLED * self.frames[number].pad.arc)
            if all(root.found for root in roots.values()):
                break
        return q

    def changed(self, q: Array) -> bool:
        """Return whether other pads than the ones taken as unloaded are so at `q`.

        As far as E_n tells.
        """
        for number, frame in enumerate(self.frames):
            above = self._above(frame, q)
            if above == (number in self.unloaded) and not self._asks(frame, above):
                return True
        return False

    def revived(self, q: Array, layers: LayerIntegrals) -> Array | None:
        """Look for roots of unloaded pads that only a search shows; None if there are none.

        Each pad is revived once: a film that balances at some positions of the journal only could
        come and go for ever.
        """
        asked = [
            number
            for number in sorted(self.unloaded - self._revived)
            if self._asks(self.frames[number], self._above(self.frames[number], q))
        ]
        if not asked:
            return None
        q, guess = q.copy(), q
        found, full = self._sampled(q, asked, layers)
        if not found:
            return None
        self._revived |= frozenset(found)
        q = self._bracketed(q, self._roots(found, guess), layers, full)
        self._keep_out(self.unloaded - frozenset(found), q)
        return q

    def _above(self, frame: PadFrame, q: Array) -> bool:
        return frame.eccentricity(q)[0] > _LEAST_ECCENTRICITY * frame.clearance

    def _asks(self, frame: PadFrame, above: bool) -> bool:
        return self._skewed or (not above and frame.pad.offset > 0.5)

    @property
    def supports_load(self) -> bool:
        """Return whether forces along the pivots of loaded pads can add up to what they must carry.

        That is the load less what the pressure in the openings carries.
        """
        if is_unloaded(self.target):
            return True
        problem = self.whole
        openings = np.where(problem.topology.fixed, problem.topology.area, 0.0)
        fed = problem.geometry.forces(problem.topology.fixed_pressure[0] * openings)[:2]
        if isinstance(self.target, EccentricityTarget):
            if np.abs(fed).max() > 0.0:
                return True
            direction = 0.0
        else:
            direction = math.atan2(fed[1], self.target.load + fed[0])
        loaded = [f for k, f in enumerate(self.frames) if k not in self.unloaded]
        angles = [math.remainder(f.pad.pivot_angle - direction, 2.0 * math.pi) for f in loaded]
        if any(abs(angle) < 1e-9 for angle in angles):
            return True
        ahead = [angle for angle in angles if 0.0 < angle < math.pi]
        behind = [angle for angle in angles if -math.pi < angle < 0.0]
        return bool(ahead and behind) and min(ahead) - max(behind) < math.pi - 1e-6


@dataclass
class _Root:
    """Root of a falling function in a bracket, by the Illinois method."""

    low: float
    high: float
    guess: float
    at_low: float | None = None
    at_high: float | None = None
    found: bool = False
    side: int = 0

    def __post_init__(self) -> None:
        inside = self.low < self.guess < self.high
        self.next = self.guess if inside else self.low + 0.3 * (self.high - self.low)
        """Next position to look at."""

    def _choose(self) -> float:
        width = self.high - self.low
        if self.at_low is None or self.at_high is None:
            # From a bracket whose ends are known by their sign: nearer to the lower one, where the
            # roots of heavily loaded pads lie as well as those of lightly loaded ones.
            return self.low + (0.3 if self.at_low is None else 0.5) * width
        share = self.at_low / (self.at_low - self.at_high)
        return self.low + min(max(share, 0.02), 0.98) * width

    def record(self, value: float, tolerance: float) -> None:
        """Take notice of the value at `next`; NaN: below any root."""
        if self.found:
            return
        narrow = self.high - self.low <= 1e-12 * max(abs(self.high), abs(self.low))
        if abs(value) <= tolerance or narrow:
            self.found = True
        elif value > 0.0 or math.isnan(value):
            if self.side < 0 and self.at_high is not None:
                self.at_high *= 0.5
            self.low, self.at_low, self.side = self.next, value, -1
            if math.isnan(value):
                self.at_low = None
        else:
            if self.side > 0 and self.at_low is not None:
                self.at_low *= 0.5
            self.high, self.at_high, self.side = self.next, value, 1
        if not self.found:
            self.next = self._choose()


def _solve(matrix: Array, right: Array) -> Array:
    try:
        step = np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        step = np.linalg.lstsq(matrix, right, rcond=1e-12)[0]
    return np.where(np.isfinite(step), step, 0.0)
