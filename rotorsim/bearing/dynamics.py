"""Films whose forces depend on the frequency of the motion: coefficients, threshold.

A mass-conserving film stores oil in its ruptured sector, so that K and C are functions of the whirl
frequency nu: A(i nu) = K(nu) + i nu C(nu). A rigid rotor of mass M per bearing moves as exp(s t)
where det(M s^2 + A(s)) = 0. At the threshold s = i nu, and K(nu), C(nu) put into the closed form
(`rigid_threshold`) give nu back: that is the frequency at which such a point's coefficients are
stated, since with them the critical mass is that of the full dynamics.

Tilting pads have unknowns of their own (tilt, pivot displacement, pitch), with inertia:
A(s) = K + s C + s^2 M over journal and pads. Nothing but the film acts on the pads, so that the
journal feels A_JJ - A_JP A_PP^-1 A_PJ, again a function of the frequency. Their 2 x 2 coefficients
are stated at the shaft's frequency, as is usual; threshold and eigenvalues are those of the full
matrices.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag, eigvals

from ..arrays import Array, ComplexArray
from ..film.bending import pad_bending
from ..film.geometry import ROTATIONS, TRANSLATIONS, PadUnknowns, idle_pitches, pad_unknowns
from ..film.linearization import DynamicStiffness, linearize
from ..film.pad_frame import bending_springs
from ..film.solution import FilmSolution
from ..model import Bearing, PadInertia, pad_inertia
from ..model.settings import DeformationResponse
from ..status import Stability
from .operating_point import FrequencyCoefficients, FullCoefficients, condensed
from .whirl import (
    FrequencyScan,
    WhirlThreshold,
    rigid_threshold,
    routh_coefficients,
    threshold_misfit,
)

_DEFAULT_RATIO = 0.5
"""Whirl over shaft frequency at which coefficients are stated where there is no threshold."""
_NOTICEABLE = 0.01
"""Change of K + i nu C by stored oil, relative to it, from which on points warn."""
_PAD_RATIOS = np.geomspace(0.02, 20.0, 181)
"""Among which the threshold's whirl frequency ratio is sought with pads."""
_RATIO_TOLERANCE = 1e-9
_NOTHING = 1e-9
"""Change of the stiffness by stored oil, relative to it, that counts as none."""


@dataclass(frozen=True)
class FilmDynamics:
    """Dynamic stiffness A(s) of a bearing at its operating point, load frame.

    Call it with any complex s [1/s]: the film's forces of a motion q exp(s t) are -A(s) q.

    turn : (q, q) array. From the film's frame to the load frame.
    speed : Of the shaft [rad/s].
    stiffness, damping : (q, q) arrays. K [N/m] and C [N s/m] without stored oil, load frame.
    stored_oil : A(s) in the film's frame, less K + s C there; None where the film stores nothing.
    mass : (q, q) array or None. Of the pads; None without.
    names : Of the displacements q.
    coupled : How many of them, the first ones, are the journal's.
    cause : Why A(s) is not K + s C.
    """

    turn: Array
    speed: float
    stiffness: Array
    damping: Array
    stored_oil: Callable[[complex], ComplexArray] | None = None
    mass: Array | None = None
    names: tuple[str, ...] = TRANSLATIONS
    coupled: int = 2
    cause: str = "oil stored in the ruptured film"

    def __call__(self, s: complex) -> ComplexArray:
        """Return A(s), (q, q) [N/m]."""
        law = self.stiffness + complex(s) * self.damping
        if self.mass is not None:
            law = law + s * s * self.mass
        if self.stored_oil is None:
            return law
        return law + self.turn @ self.stored_oil(s) @ self.turn.T

    def reduced(self, s: complex) -> ComplexArray:
        """Return what the journal feels of A(s) [N/m]: A_JJ - A_JP A_PP^-1 A_PJ."""
        return condensed(self(s), self.coupled)

    @property
    def has_pads(self) -> bool:
        """Return whether there are displacements besides the journal's."""
        return self.mass is not None

    def stated_coefficients(self) -> tuple[Array, Array, float | None]:
        """Return K, C of the journal and the whirl frequency ratio at which they hold."""
        if self.has_pads:
            return *self.coefficients(1.0), 1.0
        if self.stored_oil is None:
            return self.stiffness, self.damping, None
        ratio = self._oil_threshold[1] or _DEFAULT_RATIO
        return *self.coefficients(ratio), ratio

    @cached_property
    def oil_scan(self) -> FrequencyScan:
        """A(i nu) of a film that stores oil, over the whirl frequency."""
        return FrequencyScan.of(self.reduced, self.speed)

    @cached_property
    def _oil_threshold(self) -> tuple[Stability, float | None]:
        return self.oil_scan.threshold()

    def coefficients(self, frequency_ratio: float) -> tuple[Array, Array]:
        """Return the journal's K [N/m] and C [N s/m] at a whirl over shaft frequency above zero."""
        if self.stored_oil is None and not self.has_pads:
            return self.stiffness, self.damping
        frequency = frequency_ratio * self.speed
        stiffness = self.reduced(1j * frequency)
        return stiffness.real.copy(), stiffness.imag / frequency

    def all_coefficients(self, frequency_ratio: float) -> tuple[Array, Array]:
        """Return K and C over all displacements, the oil stored at that frequency included."""
        if self.stored_oil is None:
            return self.stiffness, self.damping
        frequency = frequency_ratio * self.speed
        stored = self.turn @ self.stored_oil(1j * frequency) @ self.turn.T
        return self.stiffness + stored.real, self.damping + stored.imag / frequency

    def threshold(self, *, load: float, radial_clearance: float) -> WhirlThreshold:
        """Return the verdict on a rigid rotor, with all of the film's and the pads' dynamics.

        load, radial_clearance : [N], [m]; for the dimensionless critical mass.
        """
        if not self.has_pads:
            stiffness, damping, _ = self.stated_coefficients()
            if self.stored_oil is None:
                return rigid_threshold(
                    stiffness, damping, self.speed, load=load, radial_clearance=radial_clearance
                )
            verdict, ratio = self._oil_threshold
            if ratio is None:
                return WhirlThreshold(verdict)
            whirl = ratio * self.speed
            mass = float(routh_coefficients(stiffness, damping).equivalent_stiffness) / whirl**2
            scale = radial_clearance * self.speed**2 / load
            return WhirlThreshold(verdict, mass, whirl, ratio, mass * scale)
        if not self.stiffness.any():
            # The last iterate of a film that vanished.
            return rigid_threshold(self.stiffness[:2, :2], self.damping[:2, :2], self.speed)
        crossings = self._crossings()
        # Without a crossing any mass tells: one that would resonate near the shaft's frequency.
        typical = float(np.abs(np.diag(self.stiffness)[:2]).max()) / self.speed**2
        below = 0.5 * crossings[0][0] if crossings else typical
        stable = bool(np.max(_pad_eigenvalues(self, below).real) < 0.0)
        if not crossings:
            verdict = Stability.ALWAYS_STABLE if stable else Stability.ALWAYS_UNSTABLE
            return WhirlThreshold(verdict)
        mass, ratio = crossings[0]
        if not stable:
            above = float(np.max(_pad_eigenvalues(self, 2.0 * mass).real))
            if len(crossings) > 1 or above >= 0.0:
                return WhirlThreshold(Stability.ALWAYS_UNSTABLE)
        frequency = ratio * self.speed
        return WhirlThreshold(
            Stability.THRESHOLD if stable else Stability.REVERSED_THRESHOLD,
            mass,
            frequency,
            ratio,
            mass * radial_clearance * self.speed**2 / load if load > 0.0 else None,
        )

    def _crossings(self) -> list[tuple[float, float]]:
        """Return masses at which an eigenvalue is i nu, ascending, and nu over the speed."""
        from scipy.optimize import brentq

        found: list[tuple[float, float]] = []
        values = self._threshold_misfits(_PAD_RATIOS)
        for i in np.flatnonzero(np.diff(np.sign(values)) * np.sign(values)[:-1]):
            bracket = float(_PAD_RATIOS[i]), float(_PAD_RATIOS[i + 1])
            ratio = float(brentq(self._threshold_misfit, *bracket, xtol=_RATIO_TOLERANCE))  # type: ignore[arg-type]
            loads = np.linalg.eigvals(self.reduced(1j * ratio * self.speed))
            real = loads[np.argmin(np.abs(loads.imag))]
            if real.real > 1e6 * abs(real.imag):
                found.append((float(real.real) / (ratio * self.speed) ** 2, ratio))
        return sorted(found)

    def _threshold_misfits(self, ratios: Array) -> Array:
        """Return `_threshold_misfit` of many ratios."""
        if self.stored_oil is not None or self.mass is None:
            return np.array([self._threshold_misfit(float(ratio)) for ratio in ratios])
        frequency = (ratios * self.speed)[:, None, None]
        law = self.stiffness + 1j * frequency * self.damping - frequency**2 * self.mass
        reduced = condensed(law, self.coupled)
        return threshold_misfit(reduced.real, reduced.imag / frequency, frequency[:, 0, 0])

    def _threshold_misfit(self, ratio: float) -> float:
        """Return det(K - K_e I) - nu^2 det C, relative to its size: zero at a threshold."""
        return float(threshold_misfit(*self.coefficients(ratio), np.asarray(ratio * self.speed)))


def film_dynamics(
    solution: FilmSolution, turn: Array, *, following: Array | None = None, rotations: bool = False
) -> FilmDynamics:
    """Return the dynamic stiffness of a solved film.

    turn : (q, q) array. From the film's frame to the load frame.
    following : (q, q) array. Stiffness with the viscosity following slow displacements, film frame
        [N/m].
    rotations : Add the journal's rotations, theta_x and theta_y; `turn` turns them as well.
    """
    state, speed = solution.state, solution.problem.speed
    stiffness, damping = linearize(state, rotations=rotations)
    law = DynamicStiffness(state, rotations=rotations)

    def stored_oil(s: complex) -> ComplexArray:
        return law(s)[np.ix_(keep, keep)] - stiffness - s * damping

    names, keep = _moving(solution, rotations)
    stiffness, damping = stiffness[np.ix_(keep, keep)], damping[np.ix_(keep, keep)]
    stores = False
    follows = solution.problem.settings.deformation_response is DeformationResponse.FOLLOWING
    elastic = solution.problem.elastic is not None and follows
    if (solution.problem.rupture.conserves_mass or elastic) and np.isfinite(stiffness).all():
        changed = np.abs(stored_oil(1j * _DEFAULT_RATIO * speed)).max()
        stores = bool(changed > _NOTHING * np.abs(stiffness).max())
    held = stiffness if following is None else following[np.ix_(keep, keep)]
    mass = None
    if solution.problem.bearing.pads:
        turn = np.eye(len(keep))
        bearing, q = solution.problem.bearing, solution.state.displacement
        # The journal's rotations come last, and what turns with them.
        pitching = [_inertia(bearing, number).pitch for number in idle_pitches(bearing)]
        turning = np.diag([0.0, 0.0, *pitching])
        mass = np.asarray(block_diag(pad_mass(bearing), turning))[np.ix_(keep, keep)]
        pivots = block_diag(np.diag(pad_springs(bearing, q)[1]), 0.0 * turning)
        held = held + np.asarray(pivots)[np.ix_(keep, keep)]
    return FilmDynamics(
        turn=turn,
        speed=speed,
        stiffness=turn @ held @ turn.T,
        damping=turn @ damping @ turn.T,
        stored_oil=stored_oil if stores else None,
        mass=mass,
        names=names,
        coupled=4 if rotations else 2,
        cause="the bore gives way" if elastic else "oil stored in the ruptured film",
    )


def following_displacements(solution: FilmSolution, s: complex) -> ComplexArray:
    """Return displacements (q, 2) of a film with its journal moving along x or y as exp(s t).

    Film frame; pads follow freely.
    """
    _, keep = _moving(solution, rotations=False)
    law = film_dynamics(solution, np.eye(2))(s)
    found = np.zeros((solution.state.displacement.size, 2), dtype=complex)
    found[keep[:2]] = np.eye(2)
    if len(keep) > 2:
        found[keep[2:]] = -np.linalg.solve(law[2:, 2:], law[2:, :2])
    return found


def with_rotations(solution: FilmSolution, turn: Array) -> FilmDynamics:
    """Return the dynamics with the journal's rotations; `turn`, (2, 2), as in `film_dynamics`."""
    both = np.asarray(np.kron(np.eye(2), turn), dtype=float)
    return film_dynamics(solution, both, rotations=True)


def full_coefficients(dynamics: FilmDynamics, frequency_ratio: float | None) -> FullCoefficients:
    """Return K, C and M over journal and pads, load frame.

    frequency_ratio : Whirl over shaft frequency at which they are wanted; None: they hold at any.
    """
    stiffness, damping = dynamics.all_coefficients(frequency_ratio or _DEFAULT_RATIO)
    mass = np.zeros_like(stiffness) if dynamics.mass is None else dynamics.mass
    return FullCoefficients(dynamics.names, stiffness, damping, mass)


def _moving(solution: FilmSolution, rotations: bool) -> tuple[tuple[str, ...], list[int]]:
    """Return the names and places of the displacements: the journal's, then those of loaded pads.

    `linearize` gives the journal's rotations last, with the pitches that go with them.
    """
    bearing, unloaded = solution.problem.bearing, solution.unloaded
    names, pads = pad_unknowns(bearing)
    out = {place for number in unloaded for place in pads[number].places}
    if solution.problem.settings.deformation_response is DeformationResponse.FROZEN:
        out |= {place for pad in pads for place in pad.bends}
    keep = [place for place in range(2, len(names)) if place not in out]
    journal, places = TRANSLATIONS, [0, 1]
    if rotations:
        size, pitches = len(names), idle_pitches(bearing)
        names = (*names, *ROTATIONS, *(f"pitch_{number + 1}" for number in pitches))
        journal, places = TRANSLATIONS + ROTATIONS, [0, 1, size, size + 1]
        keep += [size + 2 + k for k, number in enumerate(pitches) if number not in unloaded]
    return (*journal, *(names[place] for place in keep)), places + keep


def pad_springs(bearing: Bearing, displacement: Array) -> tuple[Array, Array]:
    """Return forces by which pivots and bent pads resist their displacements, and stiffnesses."""
    force, stiffness = np.zeros((2, displacement.size))
    for pad, unknowns in zip(bearing.pads, pad_unknowns(bearing)[1], strict=True):
        if (place := unknowns.pivot) is not None:
            force[place] = pad.pivot.force(float(displacement[place]))
            stiffness[place] = pad.pivot.stiffness_at(float(displacement[place]))
        bends = list(unknowns.bends)
        stiffness[bends] = bending_springs(bearing, pad)
        force[bends] = stiffness[bends] * displacement[bends]
    return force, stiffness


def _inertia(bearing: Bearing, number: int) -> PadInertia:
    return pad_inertia(bearing.pads[number], bearing.journal_radius, bearing.length)


def pad_mass(bearing: Bearing) -> Array:
    """Return the mass matrix of the pads over journal and pads, (q, q) [kg, kg m, kg m2]."""
    names, places = pad_unknowns(bearing)
    mass = np.zeros((len(names), len(names)))
    for number, unknowns in enumerate(places):
        inertia = _inertia(bearing, number)
        tilt, pivot = unknowns.tilt, unknowns.pivot
        mass[tilt, tilt] = inertia.tilt
        if pivot is not None:
            mass[pivot, pivot] = inertia.mass
            # The centre of mass ahead of the pivot moves inwards as the pad tilts.
            mass[pivot, tilt] = mass[tilt, pivot] = -inertia.coupling
        if unknowns.pitch is not None:
            mass[unknowns.pitch, unknowns.pitch] = inertia.pitch
        if unknowns.bends:
            _add_bending_mass(mass, bearing, number, unknowns)
    return mass


def _add_bending_mass(mass: Array, bearing: Bearing, number: int, unknowns: PadUnknowns) -> None:
    """Add the mass of a pad's bending, and what couples it with its tilt and its pivot."""
    pad, first = bearing.pads[number], unknowns.bends[0]
    whole, arm = _inertia(bearing, number).mass, bearing.journal_radius + pad.thickness
    for side in pad_bending(pad, bearing.journal_radius, bearing.length):
        angle = np.copysign(side.points, side.side)
        own = whole * abs(side.side) / pad.arc
        places = list(range(first, first + len(side.values)))
        mass[places, places] = own
        coupled = [(unknowns.tilt, -arm * np.sin(angle)), (unknowns.pivot, np.cos(angle))]
        for place, shape in coupled:
            if place is not None:
                mass[places, place] = mass[place, places] = own * side.mean(shape)
        first += len(places)


def _pad_eigenvalues(dynamics: FilmDynamics, mass: float) -> ComplexArray:
    """Return the finite eigenvalues [1/s] of a rigid rotor of `mass` per bearing [kg] and the pads.

    Without oil stored in the film. Massless unknowns leave infinite eigenvalues, which are dropped.
    """
    size = len(dynamics.names)
    inertia = np.zeros((size, size)) if dynamics.mass is None else dynamics.mass.copy()
    inertia[[0, 1], [0, 1]] += mass
    # In units of the stiffnesses and the shaft's frequency all entries are of order one.
    diagonal = np.abs(np.diag(dynamics.stiffness))
    scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, diagonal.max()))
    scaling, omega = scale[:, None] * scale[None, :], dynamics.speed
    k, c, m = (part * scaling for part in (dynamics.stiffness, dynamics.damping, inertia))
    eye, none = np.eye(size), np.zeros((size, size))
    left = np.block([[none, eye], [-k, -omega * c]])
    right = np.block([[eye, none], [none, omega**2 * m]])
    above, below = np.asarray(eigvals(left, right, homogeneous_eigvals=True))
    finite = np.abs(below) > 1e-10 * np.abs(above)
    return np.asarray(omega * above[finite] / below[finite], dtype=complex)


def rigid_growth_rates(dynamics: FilmDynamics, masses: Array) -> Array:
    """Return the largest growth rate [1/s] of rigid rotors [kg] on a film and its pads."""
    assert dynamics.mass is not None
    pads = dynamics.mass[2:, 2:]
    if pads.size and np.linalg.eigvalsh(pads)[0] <= 0.0:
        return np.array([_pad_eigenvalues(dynamics, float(m)).real.max() for m in masses])
    size, count = len(dynamics.names), len(masses)
    inertia = np.repeat(dynamics.mass[None], count, axis=0)
    inertia[:, [0, 1], [0, 1]] += masses[:, None]
    # Velocities in the unit of the shaft's speed; displacements scaled as the stiffnesses ask.
    scale = 1.0 / np.sqrt(np.abs(np.diag(dynamics.stiffness)))
    k, c = (part * np.outer(scale, scale) for part in (dynamics.stiffness, dynamics.damping))
    inverse = np.linalg.inv(inertia * np.outer(scale, scale)) / dynamics.speed
    states = np.zeros((count, 2 * size, 2 * size))
    states[:, :size, size:] = dynamics.speed * np.eye(size)
    states[:, size:, :size] = -inverse @ k
    states[:, size:, size:] = -inverse @ c * dynamics.speed
    return np.asarray(np.linalg.eigvals(states).real.max(axis=-1))


def frequency_coefficients(
    dynamics: FilmDynamics, ratios: Sequence[float]
) -> FrequencyCoefficients | None:
    """Return K and C at several whirl frequencies over the shaft's; None where none is asked."""
    if not ratios:
        return None
    stiffness, damping = zip(*(dynamics.coefficients(ratio) for ratio in ratios), strict=True)
    return FrequencyCoefficients(np.array(ratios), np.stack(stiffness), np.stack(damping))


def stored_oil_warnings(
    dynamics: FilmDynamics, stiffness: Array, damping: Array, ratio: float | None
) -> tuple[str, ...]:
    """Return at which frequency K and C hold, where stored oil changes them noticeably."""
    if ratio is None or dynamics.stored_oil is None:
        return ()
    with_oil = stiffness + 1j * ratio * dynamics.speed * damping
    without = replace(dynamics, stored_oil=None).reduced(1j * ratio * dynamics.speed)
    change = float(np.abs(with_oil - without).max() / np.abs(without).max())
    if change < _NOTICEABLE:
        return ()
    return (
        f"K and C depend on the whirl frequency ({dynamics.cause}): they are those "
        f"at {ratio:.3g} of the shaft's, where the critical mass is exact; for others give "
        "film.frequency_ratio",
    )
