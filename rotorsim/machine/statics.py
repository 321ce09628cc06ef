"""Static equilibrium of a rotor on its supports: reactions, positions, deflection.

With two supports that carry load the reactions follow from statics alone. With more, the rotor's
stiffness, the elevations of the housings and each support's own law of force decide.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..bearing.drawing import STANDARD_GRAVITY
from ..errors import InputError
from ..rotor import Rotor

Law = Callable[[Array], tuple[Array, Array]]
"""Load (2,) [N] on a support to the journal's displacement (2,) [m] and its derivative
(2, 2) [m/N]."""
_MAX_STEPS = 60
_TOLERANCE = 1e-6
"""Of the reactions, relative to the load of the whole rotor; a heated film's force is known to some
1e-7 of its load."""


@dataclass(frozen=True, eq=False)
class StaticEquilibrium:
    """Static state of a rotor.

    nodes : Nodes of the supports.
    reactions : (n, 2) array. Load on each support along x and y [N].
    journal : (n, 2) array. Displacement of the journal in its housing [m].
    displacement : (size,) array. Of all unknowns of the rotor [m, rad].
    residual : What the reactions are off by, relative to the load of the whole rotor.
    """

    nodes: tuple[int, ...]
    reactions: Array
    journal: Array
    displacement: Array
    converged: bool
    residual: float


def weight(rotor: Rotor) -> Array:
    """Return the forces (size,) [N] of gravity along x."""
    return np.asarray(rotor.mass @ rotor.translation((STANDARD_GRAVITY, 0.0)), dtype=float)


def reactions_by_statics(rotor: Rotor, force: Array, nodes: Sequence[int]) -> Array:
    """Return the loads (2, 2) [N] on two supports.

    rotor : With positions of its nodes.
    force : (size,) array. Static forces and moments on the rotor's unknowns [N, N m].
    nodes : Nodes of the two supports.

    The rotor's rigid motions do no work: for each plane the two reactions balance the forces along
    a translation and a rotation, taken from the stiffness matrix' own rigid motions.
    """
    motions = _rigid_motions(rotor)
    at = np.array(
        [[motions[i][rotor.planes[node][a]] for node in nodes for a in (0, 1)] for i in range(4)]
    )
    return np.asarray(np.linalg.solve(at, motions @ force), dtype=float).reshape(2, 2)


def _rigid_motions(rotor: Rotor) -> Array:
    """Return displacements (4, size) of the rotor's free motions: two translations, two rotations.

    Raises InputError: The positions of the nodes are not known, or the rotor is not free without
        its supports.
    """
    positions = np.array([node.position for node in rotor.nodes])
    motions = np.zeros((4, rotor.size))
    for i, along in enumerate(((1.0, 0.0), (0.0, 1.0))):
        motions[i] = rotor.translation(along)
    if not np.all(np.isfinite(positions)):
        raise InputError("positions of the nodes are needed for static reactions", key="rotor")
    middle = positions - positions.mean()
    for node, first, z in zip(rotor.nodes, rotor.first_unknown, middle, strict=True):
        # Both signs of the slope occur: which one leaves the rotor free is found below.
        for i, (displacement, slope) in enumerate((("x", "theta_y"), ("y", "theta_x"))):
            motions[2 + i, first + node.unknowns.index(displacement)] = z
            if slope in node.unknowns:
                motions[2 + i, first + node.unknowns.index(slope)] = 1.0 if i == 0 else -1.0
    scale = float(np.abs(rotor.stiffness).max()) or 1.0
    for i in (2, 3):
        slopes = np.array([name.startswith("theta") for _, name in rotor.unknowns])
        turned = np.where(slopes, -motions[i], motions[i])
        if np.abs(rotor.stiffness @ turned).max() < np.abs(rotor.stiffness @ motions[i]).max():
            motions[i] = turned
        if np.abs(rotor.stiffness @ motions[i]).max() > 1e-6 * scale * np.abs(motions[i]).max():
            raise InputError(
                "is not free without its supports: reactions cannot be told", key="rotor.stiffness"
            )
    return motions


def static_equilibrium(
    rotor: Rotor,
    force: Array,
    nodes: Sequence[int],
    laws: Sequence[Law],
    elevations: Array,
    start: Array | None = None,
) -> StaticEquilibrium:
    """Return the equilibrium of a rotor on supports of any number.

    force : (size,) array. Static forces on its unknowns [N].
    nodes : Nodes of the supports that carry load.
    laws : One for each support: load (2,) [N] to displacement of the journal in the housing (2,)
        [m] and its derivative (2, 2) [m/N].
    elevations : (n, 2) array. Displacement of each housing along x and y [m]; upwards is -x.
    start : (n, 2) array. First guess of the loads [N].
    Raises InputError: Fewer than two supports carry load.

    Unknowns are the loads W. The rotor, held at the journals, gives loads R(u) = R0 - S u, u the
    journals' displacements; a support gives e(W). The residual W - R(e(W) + elevation) has the
    Jacobian I + S de/dW, and Newton's method is damped by halving.
    """
    count = len(nodes)
    if count < 2:
        raise InputError(
            f"{count or 'none'} of the supports carries load; a rotor with gravity or forces needs "
            "two or more (seals carry none)", key="support",
        )  # fmt: skip
    held = np.array([i for node in nodes for i in rotor.planes[node]])
    free = np.setdiff1d(np.arange(rotor.size), held)
    stiffness = rotor.stiffness
    inner = np.linalg.solve(
        stiffness[free[:, None], free],
        np.column_stack([stiffness[free[:, None], held], force[free]]),
    )
    condensed = stiffness[held[:, None], held] - stiffness[held[:, None], free] @ inner[:, :-1]
    fixed_loads = force[held] - stiffness[held[:, None], free] @ inner[:, -1]
    raised = np.asarray(elevations, dtype=float).ravel()
    total = float(np.abs(force[held]).sum() + np.abs(force[free]).sum()) or 1.0

    def answer(loads: Array) -> tuple[Array, Array, Array]:
        """Return the displacements in the housings, residual, Jacobian."""
        moved = [law(one) for law, one in zip(laws, loads.reshape(-1, 2), strict=True)]
        journal = np.concatenate([one[0] for one in moved])
        softness = np.zeros((2 * count, 2 * count))
        for i, (_, block) in enumerate(moved):
            softness[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = block
        off = loads - (fixed_loads - condensed @ (journal + raised))
        return journal, off, np.eye(2 * count) + condensed @ softness

    if count == 2:
        loads: Array = reactions_by_statics(rotor, force, nodes).ravel()
        journal, off, _ = answer(loads)
        off = np.zeros_like(off)
    else:
        loads = fixed_loads.copy() if start is None else np.asarray(start, dtype=float).ravel()
        journal, off, slope = answer(loads)
        for _ in range(_MAX_STEPS):
            if np.abs(off).max() < _TOLERANCE * total:
                break
            step = -np.linalg.solve(slope, off)
            share = 1.0
            while share > 1e-3:
                trial = answer(loads + share * step)
                if np.all(np.isfinite(trial[1])) and np.linalg.norm(trial[1]) < np.linalg.norm(off):
                    break
                share *= 0.5
            else:
                break
            loads = loads + share * step
            journal, off, slope = trial
    displacement = np.zeros(rotor.size)
    displacement[held] = journal + raised
    displacement[free] = inner[:, -1] - inner[:, :-1] @ displacement[held]
    residual = float(np.abs(off).max()) / total
    return StaticEquilibrium(
        nodes=tuple(nodes),
        reactions=np.asarray(loads, dtype=float).reshape(-1, 2),
        journal=journal.reshape(-1, 2),
        displacement=displacement,
        converged=residual < _TOLERANCE,
        residual=residual,
    )
