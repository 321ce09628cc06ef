"""A machine's supports, seals and static loads, from the entries of its file."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..bearing.interpolation import CoefficientInterpolator
from ..bearing.operating_point import OperatingPoint
from ..files.machine import MachineFile
from ..film.geometry import rotation
from ..machine.machine import Mount
from ..machine.peaks import node_at
from ..machine.statics import weight
from ..machine.support import ConstantSupport, MatrixTable, Pedestal, Support, TableSupport, Turned
from ..model.supports import Matrix, SealEntry, SupportEntry
from ..rotor import Rotor
from .rings import centred_damping


@dataclass(frozen=True, eq=False)
class SupportState:
    """A support over the speeds.

    load : (n, 2) array. Static load along x and y of the machine [N]; NaN where it was not asked
        for.
    points : Of a film, one for each speed; empty for others.
    """

    name: str
    load: Array
    points: tuple[OperatingPoint, ...] = ()

    @property
    def direction(self) -> Array:
        """Angle of the load from x in the direction of rotation, (n,) [rad]."""
        return np.arctan2(self.load[:, 1], self.load[:, 0])


def fixed_support(entry: SupportEntry) -> Support:
    """Return support of constant stiffness in the machine's frame, pedestal or damper included."""
    support: Support = ConstantSupport(
        _matrix(entry.stiffness), _matrix(entry.damping), _matrix(entry.mass)
    )
    return on_its_stand(entry, Turned(support, entry.angle) if entry.angle else support)


def on_its_stand(entry: SupportEntry, support: Support) -> Support:
    """Put a bearing in its pedestal, or in its damper: small motions about the centre."""
    if entry.pedestal is not None:
        stand = entry.pedestal
        return Pedestal(support, stand.mass, stand.stiffness, stand.damping)
    if entry.damper is not None:
        damper = entry.damper
        damping = centred_damping(damper) * np.eye(2) + _matrix(damper.damping)
        return Pedestal(support, damper.mass, _matrix(damper.stiffness), damping)
    return support


def film_support(speeds: Array, state: SupportState, full: bool = True) -> Support:
    """Return coefficients of a film's points over speed, turned to the machine's frame.

    Without `full` those of pads are reduced at the shaft's frequency.
    """
    converged = np.array([point.converged for point in state.points])
    if full and converged.all() and all(point.pads for point in state.points):
        return MatrixTable.of_points(state.points, [float(angle) for angle in state.direction])
    columns = np.full((speeds.size, 9), np.nan)
    for k, (point, angle) in enumerate(zip(state.points, state.direction, strict=True)):
        if point.converged:
            turn = rotation(float(angle))
            columns[k, :4] = (turn @ point.stiffness @ turn.T).ravel()
            columns[k, 4:8] = (turn @ point.damping @ turn.T).ravel()
            columns[k, 8] = point.load
    return TableSupport(CoefficientInterpolator.from_columns(speeds, converged, columns))


def seal_mounts(description: MachineFile, rotor: Rotor) -> list[Mount]:
    """Return the seals at their nodes."""

    def support(entry: SealEntry, name: str) -> Support:
        if entry.coefficients is not None:
            return TableSupport(description.tables[name].interpolator(), carries_load=False)
        k, c, m = (_matrix(part) for part in (entry.stiffness, entry.damping, entry.mass))
        return ConstantSupport(k, c, m, carries_load=False)

    return [
        Mount(node_at(rotor, entry.at), support(entry, name), name)
        for entry, name in zip(description.seal, description.seal_names, strict=True)
    ]


def static_force(
    description: MachineFile, rotor: Rotor, speed: float, gravity: bool = True
) -> Array:
    """Return weight and static loads on the rotor's unknowns at a speed [N]."""
    force = np.zeros(rotor.size)
    if gravity and not description.operating.vertical:
        force += weight(rotor)
    for entry in description.load:
        rows = np.array(entry.force)
        for axis, place in enumerate(rotor.planes[node_at(rotor, entry.at)]):
            force[place] += np.interp(speed, rows[:, 0], rows[:, axis + 1])
    return force


def _matrix(given: Matrix | None) -> Array:
    return np.zeros((2, 2)) if given is None else np.array(given)
