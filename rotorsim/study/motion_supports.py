"""A machine's supports in time: drive, linear supports, and films, rings and dampers as links."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..errors import InputError
from ..files.machine import MachineFile
from ..machine.machine import Machine, Mount
from ..machine.peaks import node_at
from ..machine.statics import reactions_by_statics
from ..model import LoadTarget
from ..model.machine_orbit import MachineForce, MachineOrbit
from ..model.orbit import SpeedRamp
from ..orbit.film_force import SolvedFilmForce, can_be_mapped, field_speeds, loaded_film
from ..orbit.forces import BearingForce, ShortBearingForce, StopForce
from ..orbit.motion import TorqueDrive
from ..orbit.problem import SpeedSchedule
from ..orbit.system import GROUND, Link
from .machine_supports import fixed_support, static_force
from .rings import damper_force, ring_films

if TYPE_CHECKING:
    from ..model import Case
    from ..model.supports import Damper, SupportEntry
    from ..rotor import Rotor
    from .machine import MachineResult


_REVOLUTIONS = 60
_STOP = 0.98
"""Share of a damper's clearance at which a ring without a centring spring meets a stop."""


class MotionParts:
    """A machine with one [orbit], its supports sorted into linear ones and links."""

    def __init__(
        self, machine: MachineFile, settings: MachineOrbit, result: MachineResult | None
    ) -> None:
        self.machine: MachineFile = (
            machine if machine.orbit is settings else replace(machine, orbit=settings)
        )
        self.settings = settings
        self.rotor: Rotor = self.machine.rotor_with_unbalance()
        self.nodes: list[int] = [node_at(self.rotor, entry.at) for entry in machine.support]
        self.drive: SpeedSchedule | TorqueDrive = self._drive()
        self.first: float = self.drive.start if isinstance(self.drive, TorqueDrive) else (
            self.drive.speeds[0])  # fmt: skip
        self.top: float = max(self.drive.speeds)
        self.kinds: list[MachineForce] = [self._kind(i) for i in range(len(self.nodes))]
        self.result: MachineResult | None = self._result(result)
        self.reactions: Array | None = self._reactions()
        self.own: list[tuple[str, str, float]] = []
        """Unknowns beside the rotor's: whose, name, mass."""
        self.links: list[Link] = []
        self.springs: list[tuple[list[int], Array, Array]] = []
        self.preload: list[tuple[int, float]] = []
        self.inertias: list[tuple[list[int], Array]] = []

    def _drive(self) -> SpeedSchedule | TorqueDrive:
        settings, speeds = self.settings, self.machine.operating.speeds
        if settings.drive is not None:
            given = settings.drive
            inertia = given.inertia or _polar_inertia(self.machine)
            return TorqueDrive(given.start, given.duration, given.torque, given.drag, inertia)
        if isinstance(settings.speed, SpeedRamp):
            ramp = settings.speed
            return SpeedSchedule.ramp(ramp.start, ramp.stop, ramp.duration, ramp.hold)
        return SpeedSchedule.constant(
            settings.speed or max(speeds), settings.revolutions or _REVOLUTIONS
        )

    def _kind(self, i: int) -> MachineForce:
        entry = self.machine.support[i]
        if entry.ring is not None:
            return MachineForce.SHORT
        if entry.bearing is None:
            return MachineForce.LINEAR
        return entry.force or self.settings.force

    def _model(self, names: Sequence[str]) -> str:
        wanted = self.settings.thermal_model
        return wanted if wanted is not None and wanted in names else names[-1]

    def _result(self, known: MachineResult | None) -> MachineResult | None:
        """Return films over speed, where a support needs its coefficients or loads."""
        from .machines import machine_results

        entries = self.machine.support
        tables = [
            kind is MachineForce.LINEAR and (entry.bearing or entry.coefficients)
            for kind, entry in zip(self.kinds, entries, strict=True)
        ]
        solved = len(entries) > 2 and any(
            kind is MachineForce.FILM and not can_be_mapped(self._plain_case(i))
            for i, kind in enumerate(self.kinds)
        )
        if not (any(tables) or solved):
            return None
        if known is not None:
            return known
        results = machine_results(self.machine)
        return results[self._model(list(results))]

    def _reactions(self) -> Array | None:
        """Return the static loads (n, 2) on the supports at the first speed [N]."""
        if self.result is not None and self.result.statics:
            speeds = self.result.speeds
            loads = np.stack([one.reactions for one in self.result.statics])
            k = int(np.argmin(np.abs(speeds - self.first)))
            return loads[k]
        if len(self.nodes) == 2:
            return reactions_by_statics(self.rotor, self.static_force(self.first), self.nodes)
        return None

    def static_force(self, speed: float) -> Array:
        """Return weight and static loads at a speed [N]."""
        return static_force(self.machine, self.rotor, speed, self.settings.gravity)

    def _body(self, name: str, masses: dict[str, float]) -> list[int]:
        first = self.rotor.size + self.linear_own + len(self.own)
        self.own += [(name, unknown, mass) for unknown, mass in masses.items()]
        return list(range(first, first + len(masses)))

    def linear_machine(self) -> Machine:
        """Sort the supports into a linear machine, and links with bodies of their own."""
        machine, names = self.machine, self.machine.support_names
        mounts = []
        for i, name in enumerate(names):
            if self._is_linear(i):
                mounts.append(Mount(self.nodes[i], self._linear(i), name))
        linear = Machine(self.rotor, mounts)
        self.linear_own: int = linear.size - self.rotor.size
        self.linear_names: tuple[tuple[str, str], ...] = linear.unknowns[self.rotor.size :]
        for i, name in enumerate(names):
            entry = machine.support[i]
            if not self._is_linear(i):
                self._nonlinear(i, name, entry)
        for entry in self.settings.rub:
            at = self.rotor.planes[node_at(self.rotor, entry.at)]
            radius = 0.5 * (entry.diameter or _diameter(self.machine, entry.at))
            slip = 1e-3 * max(radius * self.top, 1e-3)
            stop = StopForce(entry.clearance, entry.stiffness, entry.damping, entry.friction,
                             radius, slip)  # fmt: skip
            self.links.append(Link(f"stop at {entry.at:g} m", stop, at, film=False))
        return linear

    def _is_linear(self, i: int) -> bool:
        entry = self.machine.support[i]
        if self.kinds[i] is not MachineForce.LINEAR:
            return False
        return entry.damper is None or (entry.force or self.settings.force) is MachineForce.LINEAR

    def _linear(self, i: int) -> Any:
        if self.result is not None:
            return self.result.machine.mounts[i].support
        return fixed_support(self.machine.support[i])

    def _nonlinear(self, i: int, name: str, entry: SupportEntry) -> None:
        journal = self.rotor.planes[self.nodes[i]]
        offset = (-entry.elevation, 0.0)
        if entry.ring is not None:
            self._ring(name, entry, journal, offset)
            return
        housing: tuple[int, int] = GROUND
        if entry.pedestal is not None:
            stand = entry.pedestal
            masses = np.array(stand.mass)
            x, y = self._body(name, {"housing_x": masses[0, 0], "housing_y": masses[1, 1]})
            housing = (x, y)
            self.springs.append(([x, y], np.array(stand.stiffness), np.array(stand.damping)))
            self._carry(i, housing)
        elif entry.damper is not None:
            housing = self._damper(i, name, entry, entry.damper)
        if self.kinds[i] is MachineForce.LINEAR:
            # a bearing of constant coefficients in its damper
            if entry.stiffness is None:
                raise InputError(
                    'goes with a bearing of nonlinear force: force = "short" or "film"',
                    key=f"support[{i}].damper",
                )
            inner = fixed_support(replace(entry, damper=None))
            k, c, _ = inner.matrices(self.first)
            relative = np.hstack([np.eye(2), -np.eye(2)])
            self.springs.append(
                ([*journal, *housing], relative.T @ k @ relative, relative.T @ c @ relative)
            )
            return
        force = self._film(i, self.kinds[i])
        pads: tuple[int, ...] = ()
        if isinstance(force, SolvedFilmForce) and force.pads:
            pads = tuple(self._body(name, dict.fromkeys(force.pads, 0.0)))
            self.inertias.append((list(pads), force.pad_mass))
        self.links.append(
            Link(name, force, journal, housing, offset=offset, pads=pads,
                 minimum_film=self.machine.bearings[name].bearing.roughness)
        )  # fmt: skip

    def _carry(self, i: int, body: tuple[int, int]) -> None:
        """Set the springs under a body so that it is not moved by the static load."""
        if self.reactions is not None:
            self.preload += [
                (place, -float(load)) for place, load in zip(body, self.reactions[i], strict=True)
            ]

    def _damper(self, i: int, name: str, entry: SupportEntry, damper: Damper) -> tuple[int, int]:
        x, y = self._body(name, {"damper_x": damper.mass, "damper_y": damper.mass})
        kind = entry.force or self.settings.force
        force = damper_force(damper, short=kind is MachineForce.SHORT)
        self.links.append(Link(f"{name} damper", force, (x, y), turning=(0.0, 0.0)))
        if damper.stiffness is not None:
            self.springs.append(
                ([x, y], np.array(damper.stiffness), np.array(damper.damping or np.zeros((2, 2))))
            )
            self._carry(i, (x, y))
            return x, y
        load = max(float(np.hypot(*self.reactions[i])) if self.reactions is not None else 0.0, 1.0)
        stiffness = load / (1e-3 * damper.radial_clearance)
        damping = 0.1 * math.sqrt(stiffness * damper.mass)
        stop = StopForce(_STOP * damper.radial_clearance, stiffness, damping, 0.0, 0.0, 1.0)
        self.links.append(Link(f"{name} stop", stop, (x, y), turning=(0.0, 0.0), film=False))
        return x, y

    def _ring(
        self, name: str, entry: SupportEntry, journal: tuple[int, int],
        offset: tuple[float, float],
    ) -> None:  # fmt: skip
        ring = entry.ring
        assert ring is not None
        masses = {"ring_x": ring.mass, "ring_y": ring.mass}
        places = self._body(name, masses | ({"ring_angle": ring.inertia} if ring.turning else {}))
        body, angle = (places[0], places[1]), places[2] if ring.turning else -1
        inner, outer = ring_films(ring)
        drags, share = ring.drags, 1.0 if ring.turning else 0.0
        self.links += [
            Link(name, inner, journal, body, (1.0, share), angle, 1.0, drags[0]),
            Link(f"{name} ring", outer, body, GROUND, (0.0, share), angle, -1.0, drags[1], offset),
        ]
        if self.settings.gravity and not self.machine.operating.vertical:
            from ..bearing.drawing import STANDARD_GRAVITY

            self.preload.append((body[0], ring.mass * STANDARD_GRAVITY))

    def _plain_case(self, i: int) -> Case:
        scenario = self.machine.bearings[self.machine.support_names[i]]
        return scenario.case(thermal_model=self._model([str(m) for m in scenario.thermal_models]))

    def _film(self, i: int, kind: MachineForce) -> BearingForce:
        """Return the nonlinear force of a bearing's film, in the machine's frame."""
        case, key = self._plain_case(i), f"support[{i}].force"
        bearing = case.bearing
        if kind is MachineForce.SHORT:
            if not (bearing.is_plain and bearing.is_symmetric):
                raise InputError(
                    'goes with a plain bearing without grooves; this one needs force = "film"',
                    key=key, value=kind.value,
                )  # fmt: skip
            viscosity = float(case.lubricant.viscosity(case.thermal.supply_temperature))
            return ShortBearingForce(
                viscosity, bearing.length, bearing.journal_radius, bearing.radial_clearance
            )
        if can_be_mapped(case):
            return loaded_film(replace(case, target=LoadTarget(1.0)), self.top).force
        if kind is MachineForce.MAPPED:
            raise InputError(
                "no map holds this film (a map is exact for plain, aligned, isothermal films that "
                'begin freely): use force = "film"', key=key, value=kind.value,
            )  # fmt: skip
        if self.reactions is None:
            raise InputError("needs the static load of its bearing", key=key)
        load = self.reactions[i]
        direction = math.atan2(load[1], load[0])
        scenario = self.machine.bearings[self.machine.support_names[i]]
        turn = scenario.load_direction + self.machine.support[i].angle - direction
        under = replace(
            case, bearing=bearing.turned(turn), target=LoadTarget(float(np.hypot(*load)))
        )
        speeds = self.drive.speeds
        made = loaded_film(under, max(speeds), other_speeds=field_speeds(speeds))
        assert isinstance(made.force, SolvedFilmForce)  # no map holds it
        return made.force.turned(direction)


def _polar_inertia(machine: MachineFile) -> float:
    beam = machine.rotor.beam
    total = sum(disc.polar_inertia for disc in beam.discs)
    place, weight_ = np.polynomial.legendre.leggauss(4)
    nodes = beam.mesh()
    for left, right in pairwise(nodes):
        z = left + 0.5 * (right - left) * (1.0 + place)
        total += (right - left) * float(weight_ @ beam.properties(z)[3])
    return total


def _diameter(machine: MachineFile, at: float) -> float:
    beam = machine.rotor.beam
    found = [
        2.0 * float(beam.at(np.array([at]), section)[1][0])
        for section in beam.sections
        if beam.span(section)[0] <= at <= beam.span(section)[1]
    ]
    return max(found)
