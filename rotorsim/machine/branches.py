"""Modes of a machine over speed as continuous branches, and what they say."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array, Booleans, ComplexArray, Indices

FORWARD = 0.1
"""Ratio of areas, orbit to circle, above which a whirl counts as forward (or backward)."""
_MOVING = 0.05
"""Share of the largest motion from which a node counts for the sense of whirl."""


class Verdict(StrEnum):
    """Stability of a machine at one speed."""

    STABLE = "stable"
    UNSTABLE = "unstable"
    UNDAMPED = "undamped"
    """No mode's real part is above its own accuracy: nothing damps or drives the machine."""


@dataclass(frozen=True, eq=False)
class Modes:
    """Eigenvalues of A(parameter), each column one continuous branch.

    parameter : (n,) array. Shaft speed [rad/s] unless said otherwise.
    eigenvalues : (n, k) complex array [rad/s]
    accuracy : (n, k) array. Estimated bound of each eigenvalue's error [rad/s].
    shapes : (n, k, m) complex array. Displacements of each mode, of unit length.
    smooth : (n,) bool array. False where the step from the point before stayed abrupt at the finest
        refinement (a pair of real eigenvalues met there, say): the labels may have been exchanged.
    planes : tuple of (int, int). Unknowns x, y of the nodes.
    """

    parameter: Array
    eigenvalues: ComplexArray
    accuracy: Array
    shapes: ComplexArray
    smooth: Booleans
    planes: tuple[tuple[int, int], ...] = ((0, 1),)

    def __repr__(self) -> str:
        count, branches = self.eigenvalues.shape
        ends = f"{self.parameter[0]:.4g} to {self.parameter[-1]:.4g} rad/s" if count else "none"
        return f"<Modes: {branches} branches at {count} speeds, {ends}>"

    @property
    def growth_rate(self) -> Array:
        """Re lambda [1/s], above 0 where the mode grows, 0 where it is `undamped`."""
        return np.where(self.undamped, 0.0, self.eigenvalues.real)

    @property
    def undamped(self) -> Booleans:
        """Return where the real part is below its own accuracy: neither growth nor decay."""
        return np.abs(self.eigenvalues.real) <= self.accuracy

    @property
    def largest_growth_rate(self) -> Array:
        """Growth rate of the least stable mode, those without damping left out, (n,) [1/s].

        0 where there are only such; NaN where the eigenvalues are not known.
        """
        damped = np.where(self.undamped, -np.inf, self.eigenvalues.real)
        largest = damped.max(axis=-1, initial=-np.inf)
        return np.where(np.isneginf(largest), 0.0, largest)

    @property
    def least_stable(self) -> Indices:
        """Branch of largest growth rate, those without damping left out, (n,)."""
        return np.where(self.undamped, -np.inf, self.eigenvalues.real).argmax(axis=-1)

    @property
    def verdicts(self) -> tuple[Verdict, ...]:
        """Verdict of each parameter."""
        names = {1.0: Verdict.UNSTABLE, -1.0: Verdict.STABLE, 0.0: Verdict.UNDAMPED}
        return tuple(names[float(sign)] for sign in np.sign(self.largest_growth_rate))

    @property
    def damped_frequency(self) -> Array:
        """|Im lambda| [rad/s]."""
        return np.abs(self.eigenvalues.imag)

    @property
    def undamped_frequency(self) -> Array:
        """|lambda| [rad/s]."""
        return np.abs(self.eigenvalues)

    @property
    def damping_ratio(self) -> Array:
        """-Re lambda/|lambda|, 0 where the mode is undamped."""
        size = np.abs(self.eigenvalues)
        return 0.0 - np.divide(self.growth_rate, size, out=np.zeros_like(size), where=size > 0.0)

    @property
    def logarithmic_decrement(self) -> Array:
        """-2 pi Re lambda/|Im lambda|; NaN for a mode that does not oscillate."""
        frequency = self.damped_frequency
        return np.where(
            frequency > 0.0,
            0.0 - 2.0 * np.pi * self.growth_rate / np.where(frequency > 0.0, frequency, 1.0),
            np.nan,
        )

    def whirl_direction(self, x: int = 0, y: int = 1) -> Array:
        """Return sense of the orbit: 1 a forward circle, -1 a backward circle, 0 a straight line.

        x, y : The unknowns whose orbit is meant.
        """
        a, b = self.shapes[..., x], self.shapes[..., y]
        area = -2.0 * np.imag(np.conj(a) * b) * np.sign(self.eigenvalues.imag)
        size = np.abs(a) ** 2 + np.abs(b) ** 2
        return np.divide(area, size, out=np.zeros_like(size), where=size > 0.0)

    @property
    def whirl_sense(self) -> Array:
        """`whirl_direction` at the node where each mode moves most, (n, k)."""
        sense, size = self._orbits()
        return np.take_along_axis(sense, size.argmax(axis=-1)[..., None], axis=-1)[..., 0]

    @property
    def whirl(self) -> NDArray[np.str_]:
        """``forward``, ``backward``, ``mixed`` or ``none`` of each mode, (n, k).

        Mixed: forward at some nodes and backward at others, or straight lines. None: a mode that
        does not oscillate, or has no lateral motion.
        """
        sense, size = self._orbits()
        largest = size.max(axis=-1, keepdims=True)
        counts = size > _MOVING * largest
        forward = (counts & (sense > FORWARD)).any(axis=-1)
        backward = (counts & (sense < -FORWARD)).any(axis=-1)
        words = np.full(forward.shape, "mixed", dtype="U8")
        words[forward & ~backward] = "forward"
        words[backward & ~forward] = "backward"
        lateral = largest[..., 0] > 1e-6
        words[~lateral | (self.eigenvalues.imag == 0.0)] = "none"
        return words

    def _orbits(self) -> tuple[Array, Array]:
        """Return the sense and size of the motion of every node, (n, k, n_nodes)."""
        sense = np.stack([self.whirl_direction(x, y) for x, y in self.planes], axis=-1)
        size = [np.hypot(*np.abs(self.shapes[..., [x, y]]).T).T for x, y in self.planes]
        return sense, np.stack(size, axis=-1)

    def columns(self, keep: ArrayLike) -> Modes:
        """Return the some of the branches."""
        index = np.asarray(keep)
        return replace(
            self,
            eigenvalues=self.eigenvalues[:, index],
            accuracy=self.accuracy[:, index],
            shapes=self.shapes[:, index],
        )

    def lowest(self, count: int) -> Modes:
        """Keep `count` branches, those that reach the lowest frequencies."""
        return self.columns(
            np.sort(np.argsort(self.damped_frequency.min(axis=0), kind="stable")[:count])
        )

    def oscillating(self) -> Modes:
        """Keep one branch of each conjugate pair (Im >= 0 on the whole), as a Campbell diagram.

        A frequency below its own accuracy, a free direction's, is none.
        """
        imaginary = self.eigenvalues.imag
        swings = (imaginary - self.accuracy).max(axis=0) > 0.0
        return self.columns(np.flatnonzero((imaginary.sum(axis=0) >= 0.0) & swings))
