"""Films whose forces depend on the frequency of the motion: coefficients, threshold, eigenvalues.

A mass-conserving film stores oil in its ruptured sector, so that K and C are functions of the whirl
frequency nu: A(i nu) = K(nu) + i nu C(nu). A rigid rotor of mass M per bearing moves as exp(s t)
where det(M s^2 + A(s)) = 0. At the threshold s = i nu, and K(nu), C(nu) put into the closed form
(`rigid_threshold`) give nu back: that is the frequency at which such a point's coefficients are
stated, since with them the critical mass is that of the full dynamics.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from ..film.geometry import ROTATIONS, TRANSLATIONS
from ..film.linearization import DynamicStiffness, linearize
from ..film.solution import FilmSolution
from ..status import Stability
from .operating_point import FrequencyCoefficients, FullCoefficients
from .whirl import rigid_threshold, routh_coefficients

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

DEFAULT_RATIO = 0.5
"""Whirl over shaft frequency at which coefficients are stated where there is no threshold."""
NOTICEABLE = 0.01
"""Change of K + i nu C by stored oil, relative to it, from which on points warn."""
_RATIOS = np.linspace(0.1, 1.3, 13)
"""Among which the threshold's whirl frequency ratio is sought."""
_RATIO_TOLERANCE = 1e-9
_NOTHING = 1e-9
"""Change of the stiffness by stored oil, relative to it, that counts as none."""
_NEWTON_STEPS = 30
_EIGENVALUE_TOLERANCE = 1e-10


@dataclass(frozen=True)
class FilmDynamics:
    """Dynamic stiffness A(s) of a bearing at its operating point, load frame.

    Call it with any complex s [1/s]: the film's forces of a motion q exp(s t) are -A(s) q.

    Parameters
    ----------
    turn : (q, q) array
        From the film's frame to the load frame.
    speed : float
        Of the shaft [rad/s].
    stiffness, damping : (q, q) arrays
        K [N/m] and C [N s/m] without stored oil, load frame.
    stored_oil : callable or None
        A(s) in the film's frame, less K + s C there; None where the film stores nothing.
    """

    turn: Array
    speed: float
    stiffness: Array
    damping: Array
    stored_oil: Callable[[complex], ComplexArray] | None = None

    def __call__(self, s: complex) -> ComplexArray:
        """Return A(s), (q, q) [N/m]."""
        law = self.stiffness + complex(s) * self.damping
        if self.stored_oil is None:
            return law
        return law + self.turn @ self.stored_oil(s) @ self.turn.T

    def stated_coefficients(self) -> tuple[Array, Array, float | None]:
        """Return K, C and the whirl frequency ratio at which they hold; None: at any."""
        if self.stored_oil is None:
            return self.stiffness, self.damping, None
        ratio = self.threshold_ratio() or DEFAULT_RATIO
        return *self.coefficients(ratio), ratio

    def coefficients(self, frequency_ratio: float) -> tuple[Array, Array]:
        """Return K [N/m] and C [N s/m] at a whirl frequency over shaft frequency above zero."""
        if self.stored_oil is None:
            return self.stiffness, self.damping
        frequency = frequency_ratio * self.speed
        stiffness = self(1j * frequency)
        return stiffness.real.copy(), stiffness.imag / frequency

    def threshold_ratio(self) -> float | None:
        """Return the whirl frequency ratio at the rigid rotor's threshold; None without one.

        Of several, that of the smallest critical mass.
        """
        values = [self._threshold_misfit(ratio) for ratio in _RATIOS]
        found: list[tuple[float, float]] = []
        for i in np.flatnonzero(np.diff(np.sign(values)) != 0):
            bracket = float(_RATIOS[i]), float(_RATIOS[i + 1])
            ratio = float(brentq(self._threshold_misfit, *bracket, xtol=_RATIO_TOLERANCE))  # type: ignore[arg-type]
            threshold = rigid_threshold(*self.coefficients(ratio), self.speed)
            if threshold.critical_mass is not None and threshold.stability is Stability.THRESHOLD:
                found.append((threshold.critical_mass, ratio))
        return min(found)[1] if found else None

    def _threshold_misfit(self, ratio: float) -> float:
        """det(K - K_e I) - nu^2 det C, relative to its size: zero at a threshold."""
        routh = routh_coefficients(*self.coefficients(ratio))
        squeezed = (ratio * self.speed) ** 2 * routh.det_damping
        return float((routh.det_shifted - squeezed) / (abs(routh.det_stiffness) + abs(squeezed)))


def film_dynamics(
    solution: FilmSolution,
    turn: Array,
    *,
    following: Array | None = None,
    rotations: bool = False,
) -> FilmDynamics:
    """Return the dynamic stiffness of a solved film.

    Parameters
    ----------
    solution : FilmSolution
    turn : (q, q) array
        From the film's frame to the load frame.
    following : (q, q) array, optional
        Stiffness with the viscosity following slow displacements, film frame [N/m].
    rotations : bool
        Add the journal's rotations, theta_x and theta_y; `turn` turns them as well.
    """
    state, speed = solution.state, solution.problem.speed
    stiffness, damping = linearize(state, rotations=rotations)
    law = DynamicStiffness(state, rotations=rotations)

    def stored_oil(s: complex) -> ComplexArray:
        return law(s) - stiffness - s * damping

    stores = False
    if solution.problem.rupture.conserves_mass and np.isfinite(stiffness).all():
        changed = np.abs(stored_oil(1j * DEFAULT_RATIO * speed)).max()
        stores = bool(changed > _NOTHING * np.abs(stiffness).max())
    held = stiffness if following is None else following
    return FilmDynamics(
        turn,
        speed,
        turn @ held @ turn.T,
        turn @ damping @ turn.T,
        stored_oil if stores else None,
    )


def full_coefficients(
    solution: FilmSolution, turn: Array, frequency_ratio: float | None
) -> FullCoefficients:
    """Return K, C and M over the journal's displacements and rotations, load frame.

    Parameters
    ----------
    solution : FilmSolution
    turn : (2, 2) array
        From the film's frame to the load frame.
    frequency_ratio : float or None
        Whirl over shaft frequency at which they are wanted; None: they hold at any.
    """
    turn = np.asarray(np.kron(np.eye(2), turn), dtype=float)
    dynamics = film_dynamics(solution, turn, rotations=True)
    stiffness, damping = dynamics.coefficients(frequency_ratio or DEFAULT_RATIO)
    return FullCoefficients(TRANSLATIONS + ROTATIONS, stiffness, damping, np.zeros_like(stiffness))


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
    """Say at which frequency K and C hold, where the stored oil changes them noticeably."""
    if ratio is None:
        return ()
    with_oil = stiffness + 1j * ratio * dynamics.speed * damping
    without = dynamics.stiffness + 1j * ratio * dynamics.speed * dynamics.damping
    change = float(np.abs(with_oil - without).max() / np.abs(without).max())
    if change < NOTICEABLE:
        return ()
    return (
        "K and C depend on the whirl frequency (oil stored in the ruptured film): they are those "
        f"at {ratio:.3g} of the shaft's, where the critical mass is exact; for others give "
        "film.frequency_ratio",
    )


def rigid_eigenvalues(dynamics: FilmDynamics, mass: float) -> ComplexArray:
    """Return the least damped eigenvalues [1/s] of a rigid rotor of `mass` per bearing [kg].

    As many as the rotor has without stored oil: each begins at an eigenvalue with the coefficients
    at the threshold's whirl frequency and is then solved for with the full dynamics. (A film that
    stores oil has more, which decay faster.)

    Raises
    ------
    ArithmeticError
        An eigenvalue did not converge.
    """
    ratio = dynamics.threshold_ratio() or DEFAULT_RATIO
    stiffness, damping = dynamics.coefficients(ratio)
    size = len(stiffness)
    state = np.block([[np.zeros((size, size)), np.eye(size)], [-stiffness / mass, -damping / mass]])

    def law(s: complex) -> ComplexArray:
        return dynamics(s) + mass * s * s * np.eye(size)

    guesses = np.linalg.eigvals(state)
    found: list[complex] = []
    for guess in sorted(guesses[guesses.imag >= 0.0], key=lambda s: -s.real):
        root = refine_eigenvalue(law, guess, known=found)
        found += [root] if abs(root.imag) <= 1e-9 * abs(root) else [root, root.conjugate()]
    return np.array(found)


def refine_eigenvalue(
    law: Callable[[complex], ComplexArray], guess: complex, *, known: Sequence[complex] = ()
) -> complex:
    """Return s near `guess` at which the matrix `law(s)` is singular, other than those `known`.

    Newton's method on det(law(s)) divided by the product of (s - known).

    Raises
    ------
    ArithmeticError
        It did not converge.
    """
    s = complex(guess)
    for _ in range(_NEWTON_STEPS):
        difference = 1e-6 * max(abs(s), 1.0)
        matrix = law(s)
        try:
            slope = np.trace(np.linalg.solve(matrix, law(s + difference) - matrix)) / difference
        except np.linalg.LinAlgError:
            return s
        slope -= sum(1.0 / (s - other) for other in known if other != s)
        s -= 1.0 / slope
        if not np.isfinite(s):
            break
        if abs(1.0 / slope) <= _EIGENVALUE_TOLERANCE * abs(s):
            return s
    raise ArithmeticError(f"no eigenvalue was found near {guess:.6g} 1/s")
