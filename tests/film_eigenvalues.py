"""Eigenvalues of a rigid rotor on a film whose forces depend on the frequency, by Newton's method.

A second method beside the thresholds of `rotorsim.bearing.dynamics`: zeros of det(M s^2 + A(s)).
"""

from contextlib import suppress

import numpy as np

from rotorsim.bearing.dynamics import _pad_eigenvalues
from rotorsim.bearing.whirl import _FINE

NEWTON_STEPS = 30
TOLERANCE = 1e-10


def least_damped(scan, mass, count=4):
    """Frequencies [rad/s] near which det(A - M nu^2) is smallest: first guesses of modes."""
    frequency = scan.speed * _FINE
    matrices = scan.curve(_FINE) - mass * frequency[:, None, None] ** 2 * np.eye(2)
    values = np.linalg.svd(matrices, compute_uv=False)
    off = values[:, 1] / values[:, 0]
    inner = np.flatnonzero((off[1:-1] < off[:-2]) & (off[1:-1] < off[2:])) + 1
    return frequency[inner[np.argsort(off[inner])][:count]]


def rigid_eigenvalues(dynamics, mass):
    """Of a rigid rotor of `mass` per bearing [kg], [1/s].

    A film that stores oil has more than the rotor: up to four of the least damped pairs are given.
    """
    if dynamics.stored_oil is None:
        return _pad_eigenvalues(dynamics, mass)
    if dynamics.has_pads:
        guesses = list(_pad_eigenvalues(dynamics, mass))
    else:
        guesses = [1j * nu for nu in least_damped(dynamics.oil_scan, mass)]
    inertia = np.zeros((len(dynamics.names), len(dynamics.names)))
    inertia[[0, 1], [0, 1]] = mass

    def law(s):
        return dynamics(s) + s * s * inertia

    found = []
    for guess in guesses:
        if guess.imag < 0.0:
            continue
        with suppress(ArithmeticError):
            root = refine_eigenvalue(law, guess, known=found)
            real = abs(root.imag) <= 1e-9 * abs(root)
            found += [complex(root.real)] if real else [root, root.conjugate()]
    if not found:
        raise ArithmeticError(f"no eigenvalue was found for {mass:.6g} kg")
    return np.array(found)


def refine_eigenvalue(law, guess, *, known=()):
    """s near `guess` at which the matrix `law(s)` is singular, other than those `known`.

    Newton's method on det(law(s)) divided by the product of (s - known).

    Raises ArithmeticError: It did not converge.
    """
    s = complex(guess)
    for _ in range(NEWTON_STEPS):
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
        if abs(1.0 / slope) <= TOLERANCE * abs(s):
            return s
    raise ArithmeticError(f"no eigenvalue was found near {guess:.6g} 1/s")
