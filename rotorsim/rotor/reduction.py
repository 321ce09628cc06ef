"""Craig-Bampton reduction: chosen unknowns stay, the rest of the rotor becomes a few modes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Indices
from .rotor import Rotor


@dataclass(frozen=True, eq=False)
class _Reduction:
    """Displacements of a rotor from those kept and the amplitudes of fixed-interface modes.

    basis : (size, n) array. Column j < len(kept): the static shape of a unit displacement of that
        unknown; then the modes with all of them held, scaled to a largest displacement of 1.
    kept : (k,) array of int. The rotor's unknowns that are the first reduced ones.
    frequencies : (m,) array. Of all the modes with the kept unknowns held [rad/s]; the first n - k
        are in the basis.
    """

    basis: Array
    kept: Indices
    frequencies: Array


def reduce_rotor(rotor: Rotor, kept: Sequence[int], modes: int | None = None) -> _Reduction:
    """Reduce a rotor to its unknowns `kept` and a number of modes (Craig & Bampton 1968).

    kept : Unknowns that stay as they are.
    modes : By default all: the basis then spans every motion of the rotor.
    """
    held = np.array(sorted(set(kept)), dtype=np.intp)
    free = np.setdiff1d(np.arange(rotor.size), held)
    if modes is None:
        # nothing is gained by modes where all motions stay
        order = np.concatenate([held, free])
        return _Reduction(np.eye(rotor.size)[:, order], held, np.zeros(0))
    from scipy.linalg import eigh

    inner = rotor.stiffness[free[:, None], free]
    squares, shapes = eigh(0.5 * (inner + inner.T), rotor.mass[free[:, None], free])
    count = min(modes, free.size)
    basis = np.zeros((rotor.size, held.size + count))
    basis[held, np.arange(held.size)] = 1.0
    coupling = rotor.stiffness[free[:, None], held]
    basis[free, : held.size] = -np.linalg.lstsq(inner, coupling, rcond=None)[0]
    basis[free, held.size :] = shapes[:, :count]
    moved = [i for plane in rotor.planes for i in plane]
    size = np.abs(basis[moved, held.size :]).max(axis=0)
    basis[:, held.size :] /= np.where(size > 0.0, size, 1.0)
    return _Reduction(basis, held, np.sqrt(np.maximum(squares, 0.0)))
