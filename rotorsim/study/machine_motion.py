"""From a machine file to its motion in time."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array, Indices
from ..errors import InputError
from ..files.machine import MachineFile
from ..film.geometry import rotation
from ..machine.machine import Machine, Mount
from ..machine.peaks import node_at
from ..machine.statics import reactions_by_statics, weight
from ..model import LoadTarget
from ..model.machine_orbit import MachineForce, MachineOrbit
from ..model.orbit import SpeedRamp
from ..orbit.analysis import recognise
from ..orbit.continuation import Branch, follow_forced, follow_limit_cycle
from ..orbit.description import describe_orbit
from ..orbit.film_force import SolvedFilmForce, can_be_mapped, field_speeds, loaded_film
from ..orbit.film_map import squeezed_film
from ..orbit.force_map import FilmMapForce
from ..orbit.forces import (
    BearingForce,
    ShortBearingForce,
    StopForce,
    find_equilibrium,
)
from ..orbit.motion import (
    Motion,
    MotionProblem,
    Station,
    TorqueDrive,
    simulate_motion,
    static_position,
)
from ..orbit.orbit import Orbit, OrbitStatus
from ..orbit.problem import SpeedSchedule
from ..orbit.system import GROUND, Harmonic, LinearBlock, Link, MotionSystem, derivatives
from ..rotor.reduction import reduce_rotor
from .machine import fixed_support, seal_support
from .orbits import FilmFrame
from .rings import damper_force, ring_films, ring_state

if TYPE_CHECKING:
    from ..model import Case
    from ..model.machine import Damper, SupportEntry
    from .machine import MachineResult


_REVOLUTIONS = 60
_MAX_SAMPLES = 1_000_000
_REDUCTION = 1e-4
"""Relative change of eigenvalues that a reduction may bring."""
_SMALL = 48
"""Unknowns of a rotor that is not reduced."""
_MIN_MODES = 8
_SHOWN_TURNS, _SHOWN_FRAMES = 8, 40
"""Turns at the end whose films are shown eight times each, and moments over the whole run."""
_STOP = 0.98
"""Share of a damper's clearance at which a ring without a centring spring meets a stop."""


def simulate(
    machine: MachineFile,
    *,
    orbit: MachineOrbit | None = None,
    problem: MotionProblem | None = None,
    result: MachineResult | None = None,
    consume: Callable[[Motion], None] | None = None,
) -> Motion:
    """Integrate a machine's motion in time.

    machine : With ``[orbit]``.
    orbit : In place of the file's.
    problem : From `motion_problem`, where it is there already.
    result : The machine's films over speed, where they are solved already.
    consume : Called with each piece of some revolutions as soon as it is there.

    Returns
    -------
    Motion
        How the run ended is its ``status``; of a run of more than a million samples the last ones.

    Raises InputError: The file has no orbit, a film cannot have the force asked for, or a speed
        lies outside its bearings' range.
    """
    problem = problem or motion_problem(machine, orbit, result)
    keep = _MAX_SAMPLES // problem.samples_per_revolution
    return simulate_motion(problem, consume=consume, keep_revolutions=keep)


def motion_problem(
    machine: MachineFile, orbit: MachineOrbit | None = None, result: MachineResult | None = None
) -> MotionProblem:
    """Put a machine's motion together; see `simulate`."""
    if not isinstance(machine, MachineFile):
        raise InputError(
            "must be a machine: rotorsim.load_machine(file) reads one", key="machine",
            value=machine if isinstance(machine, str) else type(machine).__name__,
        )  # fmt: skip
    settings = orbit or machine.orbit
    if settings is None:
        raise InputError(
            "is missing: a motion in time needs the table [orbit]", source=machine.source,
            key="orbit",
        )  # fmt: skip
    try:
        return _Builder(machine, settings, result).problem()
    except InputError as error:
        if error.source is not None:
            raise
        raise type(error)(
            error.message, source=machine.source, key=error.key, value=error.value
        ) from None


class _Builder:
    """One machine with one [orbit]."""

    def __init__(
        self, machine: MachineFile, settings: MachineOrbit, result: MachineResult | None
    ) -> None:
        self.machine = machine if machine.orbit is settings else replace(machine, orbit=settings)
        self.settings = settings
        self.rotor = self.machine.rotor_with_unbalance()
        self.nodes = [node_at(self.rotor, entry.at) for entry in machine.support]
        self.drive = self._drive()
        self.first = self.drive.start if isinstance(self.drive, TorqueDrive) else (
            self.drive.speeds[0])  # fmt: skip
        self.top = max(self.drive.speeds)
        self.kinds = [self._kind(i) for i in range(len(self.nodes))]
        self.result = self._result(result)
        self.reactions = self._reactions()
        self.own: list[tuple[str, str, float]] = []
        """Unknowns beside the rotor's: whose, name, mass."""
        self.links: list[Link] = []
        self.springs: list[tuple[list[int], Array, Array]] = []
        self.preload: list[tuple[int, float]] = []
        self.inertias: list[tuple[list[int], Array]] = []

    # what is asked for ------------------------------------------------------------------------

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
            return reactions_by_statics(self.rotor, self._static_force(self.first), self.nodes)
        return None

    def _static_force(self, speed: float) -> Array:
        force = np.zeros(self.rotor.size)
        if self.settings.gravity and not self.machine.operating.vertical:
            force += weight(self.rotor)
        for entry in self.machine.load:
            rows = np.array(entry.force)
            for axis, place in enumerate(self.rotor.planes[node_at(self.rotor, entry.at)]):
                force[place] += np.interp(speed, rows[:, 0], rows[:, axis + 1])
        return force

    # supports ---------------------------------------------------------------------------------

    def _body(self, name: str, masses: dict[str, float]) -> list[int]:
        first = self.rotor.size + self.linear_own + len(self.own)
        self.own += [(name, unknown, mass) for unknown, mass in masses.items()]
        return list(range(first, first + len(masses)))

    def _supports(self) -> Machine:
        """Sort the supports into a linear machine, and links with bodies of their own."""
        machine, names = self.machine, self.machine.support_names
        mounts = []
        for i, name in enumerate(names):
            if self._is_linear(i):
                mounts.append(Mount(self.nodes[i], self._linear(i), name))
        linear = Machine(self.rotor, mounts)
        self.linear_own = linear.size - self.rotor.size
        self.linear_names = linear.unknowns[self.rotor.size :]
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
        force, angle = self._film(i, self.kinds[i])
        pads: tuple[int, ...] = ()
        if isinstance(force, SolvedFilmForce) and force.pads:
            pads = tuple(self._body(name, dict.fromkeys(force.pads, 0.0)))
            self.inertias.append((list(pads), force.pad_mass))
        self.links.append(
            Link(name, force, journal, housing, offset=offset, angle=angle, pads=pads,
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

    def _film(self, i: int, kind: MachineForce) -> tuple[BearingForce, float]:
        """Return nonlinear force of a bearing's film, and the angle of its frame."""
        case, key = self._plain_case(i), f"support[{i}].force"
        bearing = case.bearing
        if kind is MachineForce.SHORT:
            if not (bearing.is_plain and bearing.is_symmetric):
                raise InputError(
                    'goes with a plain bearing without grooves; this one needs force = "film"',
                    key=key, value=kind.value,
                )  # fmt: skip
            viscosity = float(case.lubricant.viscosity(case.thermal.supply_temperature))
            force = ShortBearingForce(
                viscosity, bearing.length, bearing.journal_radius, bearing.radial_clearance
            )
            return force, 0.0
        if can_be_mapped(case):
            return loaded_film(replace(case, target=LoadTarget(1.0)), self.top).force, 0.0
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
        return made.force, direction

    # equations --------------------------------------------------------------------------------

    def problem(self) -> MotionProblem:
        """Return everything together; the reduction is refined until its error is small enough."""
        linear = self._supports()
        modes = self.settings.modes
        if modes is not None or self.rotor.size <= _SMALL:
            count = modes if self.rotor.size > _SMALL else None
            return self._assembled(linear, count)
        count = _MIN_MODES
        while True:
            found = self._assembled(linear, count)
            if found.reduction_error < _REDUCTION or count >= self.rotor.size:
                return found
            count *= 2

    def _assembled(self, linear: Machine, modes: int | None) -> MotionProblem:
        rotor, size = self.rotor, self.rotor.size
        total = size + self.linear_own + len(self.own)
        kept = self._kept(linear)
        reduction = reduce_rotor(rotor, kept, modes)
        width = reduction.basis.shape[1]
        extra = total - size
        basis = np.zeros((total, width + extra))
        basis[:size, :width] = reduction.basis
        basis[size:, width:] = np.eye(extra)
        # where a kept unknown of the whole machine stands among the reduced ones
        place = np.full(total, -1)
        place[reduction.kept] = np.arange(reduction.kept.size)
        if modes is None:
            place[:size] = np.argmax(reduction.basis != 0.0, axis=1)
        place[size:] = width + np.arange(extra)
        whole = {
            name: _padded(getattr(rotor, name), total)
            for name in ("mass", "damping", "gyroscopic", "stiffness", "circulatory")
        }
        for index, (_, _, mass) in enumerate(self.own):
            at = size + self.linear_own + index
            whole["mass"][at, at] += mass
        for at, inertia in self.inertias:
            whole["mass"][np.ix_(at, at)] += inertia
        for at, stiffness, damping in self.springs:
            whole["stiffness"][np.ix_(at, at)] += stiffness
            whole["damping"][np.ix_(at, at)] += damping
        for mount, at in zip(linear.mounts, linear.places, strict=True):
            whole["mass"][at[:, None], at] += mount.support.matrices(self.top)[2]
        static = _padded_vector(self._static_force(self.first), total)
        for at, force in self.preload:
            static[at] += force
        offset = np.zeros(total)
        inner = np.setdiff1d(np.arange(size), reduction.kept)
        if inner.size and modes is not None:
            held = inner[:, None], inner
            offset[inner] = np.linalg.lstsq(rotor.stiffness[held], static[inner], rcond=None)[0]
        matrices: dict[str, Any] = {n: basis.T @ matrix @ basis for n, matrix in whole.items()}
        constant = basis.T @ (static - whole["stiffness"] @ offset)
        links = tuple(_moved(link, place) for link in self.links)
        scale = self._scale(basis)
        system = MotionSystem(
            **matrices, constant=constant, scale=scale, basis=basis, offset=offset,
            unbalance=self._unbalance(basis, total), links=links,
            block=self._block(linear, place, {}), loads=self._loads(basis, whole["mass"]),
            names=(*rotor.unknowns, *linear.unknowns[size:], *((n, u) for n, u, _ in self.own)),
        )  # fmt: skip
        rest = self._rest(system)
        seals = self._seal_mounts()
        if seals:
            with_seals = Machine(rotor, [*linear.mounts, *seals])
            at = {m.name: rest[place[p]] for m, p in zip(
                with_seals.mounts[len(linear.mounts):],
                with_seals.places[len(linear.mounts):], strict=True)}  # fmt: skip
            system = replace(system, block=self._block(with_seals, place, at))
        start, velocity = rest.copy(), np.zeros_like(rest)
        for axis in (0, 1):
            at = place[rotor.first_unknown + axis]
            start[at[at >= 0]] += self.settings.initial_displacement[axis]
            velocity[at[at >= 0]] += self.settings.initial_velocity[axis]
        rings = [link.ring for link in system.links if link.ring >= 0]
        velocity[rings], start[rings] = rest[rings], 0.0
        rest = rest.copy()
        rest[rings] = 0.0
        error = 0.0
        if modes is not None and reduction.kept.size + modes < size:
            error = self._reduction_error(system, rest, velocity * 0.0, whole, place)
        return MotionProblem(
            system, self.drive, start, velocity, rest, self._stations(system),
            self.settings.samples_per_revolution, self.settings.relative_tolerance,
            self._label(), self.settings.thermal_model or "", self._note(), error,
            tuple(entry.frequency for entry in self.settings.harmonic),
        )  # fmt: skip

    def _kept(self, linear: Machine) -> list[int]:
        size = self.rotor.size
        kept = [int(i) for places in linear.places for i in places if i < size]
        kept += [i for link in self.links for i in link.inner if i < size]
        kept += [i for at, _, _ in self.springs for i in at if i < size]
        places = [entry.at for entry in (*self.settings.placed, *self.machine.load,
                                         *self.machine.seal)]  # fmt: skip
        nodes = [node_at(self.rotor, at) for at in places]
        nodes += [int(i) for i in np.flatnonzero(self.rotor.unbalance)]
        return sorted({*kept, *(i for node in nodes for i in self.rotor.planes[node])})

    def _scale(self, basis: Array) -> Array:
        films = [link.force.radial_clearance for link in self.links if link.film]
        length = min(films, default=1e-4)
        scale = np.full(basis.shape[1], length)
        for link in self.links:
            if link.pads and isinstance(link.force, SolvedFilmForce):
                first = basis.shape[1] - basis.shape[0]
                scale[first + np.array(link.pads)] = link.force.scales[2:]
            if link.ring >= 0:
                scale[basis.shape[1] - basis.shape[0] + link.ring] = 1.0
        return scale

    def _unbalance(self, basis: Array, total: int) -> tuple[tuple[float, Any], ...]:
        found = []
        if self.settings.unbalance and np.any(self.rotor.unbalance):
            own = _padded_vector(self.rotor.unbalance_force(1.0), total)
            found.append((-math.inf, basis.T @ own))
        for entry in self.settings.blade_loss:
            x, y = self.rotor.planes[node_at(self.rotor, entry.at)]
            amount = np.zeros(total, dtype=complex)
            turned = entry.amount * np.exp(1j * entry.phase)
            amount[x], amount[y] = turned, -1j * turned
            found.append((entry.start, basis.T @ amount))
        return tuple(found)

    def _loads(self, basis: Array, mass: Array) -> tuple[Harmonic, ...]:
        settings, found = self.settings, []
        for entry in (*settings.step, *settings.harmonic):
            amplitude = np.zeros(basis.shape[0], dtype=complex)
            phase = np.array(getattr(entry, "phase", (0.0, 0.0)))
            places = list(self.rotor.planes[node_at(self.rotor, entry.at)])
            amplitude[places] = np.array(entry.force) * np.exp(1j * phase)
            frequency = getattr(entry, "frequency", 0.0)
            forces = np.asarray(basis.T @ amplitude, dtype=complex)
            found.append(Harmonic(forces, frequency, entry.start, entry.stop))
        along = np.zeros((2, basis.shape[0]))
        for axis in (0, 1):
            along[axis, self.rotor.first_unknown + axis] = 1.0
            along[axis, self.rotor.size :] = [
                float(unknown.endswith("xy"[axis]) and not unknown.startswith("theta"))
                for _, unknown in self._own_names()
            ]
        if settings.base_motion is not None:
            base = settings.base_motion
            moved = np.array(base.displacement) * np.exp(1j * np.array(base.phase))
            force = base.frequency**2 * (mass @ (moved @ along))
            forces = np.asarray(basis.T @ force, dtype=complex)
            found.append(Harmonic(forces, base.frequency, base.start, base.stop))
        if settings.base_shock is not None:
            shock = settings.base_shock
            frequency = math.pi / shock.duration
            turned = 1j * np.exp(-1j * frequency * shock.start)
            force = mass @ (np.array(shock.acceleration) @ along) * turned
            found.append(
                Harmonic(basis.T @ force, frequency, shock.start, shock.start + shock.duration)
            )
        return tuple(found)

    def _own_names(self) -> list[tuple[str, str]]:
        return [*self.linear_names, *((name, unknown) for name, unknown, _ in self.own)]

    def _seal_mounts(self) -> list[Mount]:
        return [
            Mount(node_at(self.rotor, entry.at), seal_support(entry, self.machine, name), name)
            for entry, name in zip(self.machine.seal, self.machine.seal_names, strict=True)
        ]

    def _block(
        self, linear: Machine, place: Indices, seals: dict[str, Array]
    ) -> LinearBlock | None:
        """Return linear supports about their static positions over speed.

        Seals about where they rest.
        """
        loads = [node_at(self.rotor, entry.at) for entry in self.machine.load]
        wanted = {int(i) for at in linear.places for i in at}
        wanted |= {i for node in loads for i in self.rotor.planes[node]}
        if not wanted:
            return None
        unknowns = np.array(sorted(wanted))
        index = {int(i): k for k, i in enumerate(unknowns)}
        at = [np.array([index[int(i)] for i in places]) for places in linear.places]
        statics = self._statics()
        base = self._static_force(self.first)

        def law(speed: float) -> tuple[Array, Array, Array]:
            m = unknowns.size
            force, stiffness, damping = np.zeros(m), np.zeros((m, m)), np.zeros((m, m))
            change = self._static_force(speed) - base
            rotor_places = unknowns[unknowns < self.rotor.size]
            force[: rotor_places.size] += change[rotor_places]
            for mount, here, full in zip(linear.mounts, at, linear.places, strict=True):
                k, c, _ = mount.support.matrices(speed)
                if not np.all(np.isfinite(k)):
                    raise InputError(
                        f"{mount.name} has no coefficients at {speed:g} rad/s", key="orbit.speed"
                    )
                stiffness[here[:, None], here] += k
                damping[here[:, None], here] += c
                if mount.name in seals:
                    force[here] += k @ seals[mount.name]
                elif statics is not None:
                    reaction, position = statics(mount.name, speed)
                    force[here[:2]] -= reaction
                    rest = np.zeros(here.size)
                    coupled = full < self.rotor.size
                    rest[coupled] = position[full[coupled]]
                    force[here] += k @ rest
                else:
                    entry = self.machine.support[self.machine.support_names.index(mount.name)]
                    raised = np.zeros(here.size)
                    raised[0] = -entry.elevation
                    if entry.pedestal is not None:
                        raised[-2] = -entry.elevation
                    force[here] += k @ raised
            return force, stiffness, damping

        return LinearBlock(place[unknowns], law)

    def _statics(self) -> Callable[[str, float], tuple[Array, Array]] | None:
        """Return reaction (2,) and displacement of the rotor (size,) over speed.

        Where they are known.
        """
        if self.result is None or not self.result.statics:
            return None
        if not self.settings.gravity:
            raise InputError(
                "goes with nonlinear films only: linear coefficients belong to the loaded position",
                key="orbit.gravity",
            )
        from scipy.interpolate import PchipInterpolator

        statics, speeds = self.result.statics, self.result.speeds
        loads = np.stack([one.reactions.ravel() for one in statics])
        # the result's rotor may have other nodes than this one, which has the orbit's as well
        moved = np.stack([self._taken_over(one.displacement) for one in statics])
        both = np.hstack([loads, moved])
        curve = PchipInterpolator(speeds, both) if len(speeds) > 1 else lambda _speed: both[0]
        names = self.machine.support_names

        def at(name: str, speed: float) -> tuple[Array, Array]:
            values = np.asarray(curve(np.clip(speed, speeds[0], speeds[-1])))
            i = names.index(name)
            return values[2 * i : 2 * i + 2], values[2 * len(names) :]

        return at

    def _taken_over(self, displacement: Array) -> Array:
        assert self.result is not None
        theirs = self.result.machine.rotor
        if theirs.size == self.rotor.size:
            return displacement
        moved = np.zeros(self.rotor.size)
        for i, node in enumerate(self.rotor.nodes):
            positions = np.array([one.position for one in theirs.nodes])
            near = int(np.argmin(np.abs(positions - node.position)))
            first, own = int(theirs.first_unknown[near]), int(self.rotor.first_unknown[i])
            moved[own : own + 4] = displacement[first : first + 4]
        return moved

    def _rest(self, system: MotionSystem) -> Array:
        """Return the static position at the first speed."""
        guess = np.zeros(system.size)
        if system.links and self.reactions is not None:
            self._hung(system, guess)
        plain = system.plain(self.first, self.first)
        rest, off = static_position(system, plain, self.first, guess)
        load = max(float(np.abs(system.constant).max()), 1e-9)
        if off > 1e-6 * load and system.links:
            raise InputError(
                f"no position within the clearances carries the static load at {self.first:g} "
                "rad/s: raise the speed, or lower the load", key="orbit.speed", value=self.first,
            )  # fmt: skip
        return rest

    def _hung(self, system: MotionSystem, guess: Array) -> None:
        """Guess of the journals' places: each film under its own load."""
        assert self.reactions is not None
        names = self.machine.support_names
        for link in system.links:
            if isinstance(link.force, StopForce) and link.turning == (0.0, 0.0):
                # a damper's ring without a spring lies on its stop
                load = self.reactions[names.index(link.name.removesuffix(" stop"))]
                size = max(float(np.hypot(*load)), 1e-12)
                reach = link.force.radial_clearance + size / link.force.stiffness
                guess[list(link.inner)] = reach * load / size
        # a ring's own film first: the journal stands in the ring
        for link in sorted(system.links, key=lambda one: one.outer[0]):
            name = link.name.removesuffix(" ring").removesuffix(" damper")
            if name not in names or not link.film or link.turning == (0.0, 0.0):
                continue
            if isinstance(link.force, SolvedFilmForce):
                rest, turn = link.force.rest, rotation(link.angle + link.force.frame)
                guess[list(link.inner)] = turn @ rest[:2] + np.array(link.offset)
                guess[list(link.pads)] = rest[2:]
                continue
            i, ring = names.index(name), 0.0
            load = self.reactions[i]
            given = self.machine.support[i].ring
            if given is not None and link.ring >= 0:
                ring = ring_state(given, load, self.first).ring_speed
                guess[link.ring] = ring
            speed = link.turning[0] * self.first + link.turning[1] * ring
            try:
                where = find_equilibrium(link.force, (float(load[0]), float(load[1])), speed)
            except InputError:
                continue
            for axis in (0, 1):
                under = guess[link.outer[axis]] if link.outer[axis] >= 0 else 0.0
                guess[link.inner[axis]] = where[axis] + under + link.offset[axis]

    def _reduction_error(
        self, system: MotionSystem, rest: Array, still: Array, whole: dict[str, Array],
        place: Indices,
    ) -> float:  # fmt: skip
        """Return the largest relative change of an eigenvalue below the highest excitation."""
        from scipy.linalg import eigvals

        speed = self.top
        plain = system.plain(speed, speed)
        k, c = derivatives(rest, still, speed, system.scale, plain)
        own = {name: getattr(system, name) for name in whole}
        added_k = k - own["stiffness"] - speed * own["circulatory"]
        added_c = c - own["damping"] - speed * own["gyroscopic"]
        full = np.flatnonzero(place >= 0)
        at, here = ((one[:, None], one) for one in (full, place[full]))
        big_k = whole["stiffness"] + speed * whole["circulatory"]
        big_c = whole["damping"] + speed * whole["gyroscopic"]
        big_k[at] += added_k[here]
        big_c[at] += added_c[here]
        reach = max([speed, *(entry.frequency for entry in self.settings.harmonic)])

        def poles(m: Array, c: Array, k: Array) -> Array:
            n = len(m)
            matrix = np.zeros((2 * n, 2 * n))
            matrix[:n, n:] = np.eye(n)
            matrix[n:] = -np.linalg.solve(m, np.hstack([k, c]))
            return np.asarray(eigvals(matrix))

        exact = poles(whole["mass"], big_c, big_k)
        exact = exact[np.abs(exact) <= reach]
        ours = poles(system.mass, c, k)
        if not exact.size:
            return 0.0
        apart = np.abs(exact[:, None] - ours[None]).min(axis=1)
        return float((apart / np.maximum(np.abs(exact), 0.02 * reach)).max())

    def _stations(self, system: MotionSystem) -> tuple[Station, ...]:
        rotor, found = self.rotor, {}
        links = {link.name: k for k, link in enumerate(system.links) if link.film}
        for name, node in zip(self.machine.support_names, self.nodes, strict=True):
            position = rotor.nodes[node].position
            found[name] = Station(name, rotor.planes[node], position, links.get(name))
        for k, link in enumerate(system.links):
            if link.film and link.name not in found:
                inner = [int(np.argmax(system.basis[:, i])) for i in link.inner]
                found[link.name] = Station(link.name, (inner[0], inner[1]), link=k)
        beam = self.machine.rotor.beam
        for i, disc in enumerate(beam.discs, start=1):
            name, node = disc.name or f"disc {i}", node_at(rotor, disc.at)
            if name not in found:
                found[name] = Station(name, rotor.planes[node], disc.at)
        for i, probe in enumerate(self.machine.probe, start=1):
            name, node = probe.name or f"probe {i}", node_at(rotor, probe.at)
            if name not in found:
                found[name] = Station(name, rotor.planes[node], probe.at)
        return tuple(found.values())

    def _label(self) -> str:
        settings = self.settings
        if settings.blade_loss:
            return "blade_loss"
        if settings.drive is not None or isinstance(settings.speed, SpeedRamp):
            rises = self.first < self.top
            return "run_up" if rises else "coast_down"
        for kind in ("step", "harmonic", "rub"):
            if getattr(settings, kind):
                return kind
        if settings.base_motion is not None or settings.base_shock is not None:
            return "base_motion"
        return "unbalance" if np.any(self.rotor.unbalance) and settings.unbalance else "free_decay"

    def _note(self) -> str:
        names = self.machine.support_names
        said = {str(kind) for kind in self.kinds}
        if len(said) == 1:
            return f"{said.pop()} bearing forces"
        return "; ".join(f"{n}: {kind}" for n, kind in zip(names, self.kinds, strict=True))


def limit_cycles(
    machine: MachineFile, orbit: MachineOrbit | None = None, points: int = 60
) -> Branch:
    """Follow the whirl that begins where a machine's static position becomes unstable, over speed.

    machine : Its films with closed forms or maps; unbalance is left out.
    orbit : In place of the file's.
    points : Of the branch, at most.

    Raises InputError: The static position is stable at all the machine's speeds, or a film has no
        closed form.
    """
    problem, speeds = _at_lowest_speed(machine, orbit)
    return follow_limit_cycle(problem.system, problem.equilibrium, speeds, points=points)


def branch_document(branch: Branch) -> dict[str, Any]:
    """Return the periodic motions over speed as plain data (SI)."""
    return {
        "threshold": branch.threshold,
        "supercritical": branch.supercritical,
        "folds": branch.folds.tolist(),
        "message": branch.message,
        "films": list(branch.names),
        "points": [
            {"speed": float(s), "frequency": float(f), "amplitude": a.tolist(),
             "min_film": float(h), "stable": bool(stable)}
            for s, f, a, h, stable in zip(
                branch.speed, branch.frequency, branch.amplitude, branch.least_film, branch.stable,
                strict=True,
            )
        ],
    }  # fmt: skip


def forced_response(
    machine: MachineFile, orbit: MachineOrbit | None = None, *, turns: int = 1, points: int = 120
) -> Branch:
    """Follow the periodic response to a machine's unbalance over its speeds, folds included.

    Parameters are those of `limit_cycles`; `turns` of the shaft make one period.
    """
    problem, speeds = _at_lowest_speed(machine, orbit)
    return follow_forced(problem.system, problem.equilibrium, speeds, turns=turns, points=points)


def _at_lowest_speed(
    machine: MachineFile, orbit: MachineOrbit | None
) -> tuple[MotionProblem, tuple[float, float]]:
    speeds = machine.operating.speeds
    settings = orbit or machine.orbit or MachineOrbit(force=MachineForce.SHORT)
    # as fine as the highest speed needs, at rest where the lowest lets it
    top = motion_problem(machine, replace(settings, speed=max(speeds), drive=None))
    modes = top.system.size if settings.modes is None else settings.modes
    low = replace(settings, speed=min(speeds), drive=None, modes=modes)
    return motion_problem(machine, low), (min(speeds), max(speeds))


def largest_disturbance(
    machine: MachineFile,
    orbit: MachineOrbit | None = None,
    *,
    direction: tuple[float, float] = (1.0, 0.0),
    revolutions: int = 60,
    steps: int = 8,
) -> tuple[float, float]:
    """Return the largest shift of the rotor from its static position that it survives.

    machine, orbit : See `simulate`; at constant speed. Unbalance is left out.
    direction : (float, float). Of the shift along x and y.
    revolutions : After which the motion must be below half of what it was.
    steps : Halvings of the interval.

    Returns
    -------
    returns, leaves : float
        Largest shift that was seen to die out and smallest that was not [m]; infinity where all
        up to 0.9 of the smallest clearance do.
    """
    settings = orbit or machine.orbit or MachineOrbit()
    problem = motion_problem(machine, replace(settings, unbalance=False, revolutions=revolutions))
    unit = np.asarray(direction, dtype=float) / float(np.hypot(*direction))
    shape = problem_shift(problem, unit)
    films = [link for link in problem.system.links if link.film]
    low, high = 0.0, 0.9 * min(link.force.radial_clearance for link in films)

    def settles(size: float) -> bool:
        start = problem.equilibrium + size * shape
        motion = simulate_motion(replace(problem, start=start))
        if motion.status is not OrbitStatus.COMPLETED:
            return False
        rest = problem.equilibrium
        away = np.abs(motion.q - rest)[:, np.abs(shape) > 0.0].max(axis=1)
        return bool(away[-away.size // 8 :].max() < 0.5 * size)

    if settles(high):
        return high, math.inf
    for _ in range(steps):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if settles(middle) else (low, middle)
    return low, high


def problem_shift(problem: MotionProblem, along: Array) -> Array:
    """Return unknowns (n,) of a unit shift of the journals in their films."""
    shape = np.zeros(problem.system.size)
    for link in problem.system.links:
        if link.film:
            shape[list(link.inner)] = along
    return shape


def labelled(motion: Motion, name: str) -> Orbit:
    """Return the orbit of a station, which figures and recordings call by the station's name."""
    orbit = motion.orbit(name)
    if orbit.constant_speed and orbit.status is OrbitStatus.COMPLETED:
        found = recognise(orbit)
        orbit = replace(orbit, status=found.status, message=found.message)
    return replace(orbit, thermal_model="_".join(name.split()))


def motion_document(motion: Motion) -> dict[str, Any]:
    """Return motion of a machine as plain data (SI); its stations as `describe_orbit` has them."""
    problem = motion.problem
    rows = []
    for one in motion.stations:
        row = describe_orbit(labelled(motion, one.name))
        row["thermal_model"] = problem.thermal_model
        if one.link is None:
            # a free shaft has no clearance
            row |= dict.fromkeys(("max_eccentricity_ratio", "radial_clearance", "min_film"))
        position = one.position if math.isfinite(one.position) else None
        rows.append({"station": one.name, "position": position, "film": one.link is not None} | row)
    rings = {
        link.name: float(motion.v[-1, link.ring])
        for link in problem.system.links
        if link.ring >= 0 and link.side > 0.0 and motion.t.size
    }
    return {
        "kind": problem.kind,
        "speed": [float(motion.speed[0]), float(motion.speed[-1])],
        "duration": float(motion.t[-1]),
        "revolutions": float(motion.revolutions[-1]),
        "status": motion.status,
        "message": motion.message,
        "note": problem.note,
        "unknowns": problem.system.size,
        "reduction_error": problem.reduction_error,
        "ring_speeds": rings,
        "stations": rows,
    }


def films_in_motion(motion: Motion) -> list[FilmFrame]:
    """Return the pressure of each nonlinear film along the run, some moments of it.

    Of closed forms and maps the pressure is that of a film of the same length solved for the
    journal's position and velocity.
    """
    frames = []
    for k, link in enumerate(motion.problem.system.links):
        if link.film:
            name = motion.stations_of(k)
            frames += _film_frames(motion, link, "_".join(name.split()))
    return frames


def _film_frames(motion: Motion, link: Link, name: str) -> list[FilmFrame]:
    force = link.force
    turn, count = motion.problem.samples_per_revolution, motion.t.size
    last = np.arange(max(count - _SHOWN_TURNS * turn, 0), count, max(1, turn // 8))
    rows = np.unique(np.concatenate([np.linspace(0, count - 1, _SHOWN_FRAMES).astype(int), last]))
    path, frames = link.motion(motion.q[rows], motion.v[rows], motion.speed[rows]), []
    theta = 2.0 * np.pi * (np.arange(96) + 0.5) / 96
    for row, (x, y, vx, vy, speed) in zip(rows, path, strict=True):
        if isinstance(force, ShortBearingForce):
            half = 0.5 * force.length
            along = half * ((np.arange(16) + 0.5) / 8.0 - 1.0)
            h = force.radial_clearance - x * np.cos(theta) - y * np.sin(theta)
            rate = (0.5 * speed * y + vx) * np.cos(theta) + (vy - 0.5 * speed * x) * np.sin(theta)
            line = 6.0 * force.viscosity * rate / h**3
            pressure = np.maximum(line[:, None] * (half**2 - along[None] ** 2),
                                  0.0 if force.ruptured else -math.inf)  # fmt: skip
            radius = force.radius
        elif isinstance(force, FilmMapForce):
            solved = squeezed_film(force, x, y, vx + 0.5 * speed * y, vy - 0.5 * speed * x)
            if solved is None:
                continue
            theta, along, pressure = solved
            radius = force.radius
        elif isinstance(force, SolvedFilmForce):
            turn = np.eye(2 + len(link.pads))
            turn[:2, :2] = rotation(link.angle)
            own = turn.T @ np.array([x, y, *motion.q[row, list(link.pads)]])
            rate = turn.T @ np.array([vx, vy, *motion.v[row, list(link.pads)]])
            try:
                state = force.film(own, rate, float(speed))
            except ArithmeticError:
                continue
            mesh = state.problem.mesh
            theta = mesh.theta + force.frame + link.angle
            along, pressure = mesh.whole_y, mesh.whole(state.solution.pressure)
            radius = force.bearing.journal_radius
        else:
            return []
        frames.append(
            FilmFrame(
                thermal_model=name, speed=float(motion.speed[row]), theta=theta,
                y=np.asarray(along, dtype=float),
                pressure=pressure, temperature=None, max_temperature=None, journal_radius=radius,
                radial_clearance=force.radial_clearance, centre=np.array([x, y]),
                time=float(motion.t[row]),
            )
        )  # fmt: skip
    return frames


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


def _padded(matrix: Array, size: int) -> Array:
    out = np.zeros((size, size))
    out[: len(matrix), : len(matrix)] = matrix
    return out


def _padded_vector(vector: Any, size: int) -> Any:
    return np.concatenate([vector, np.zeros(size - len(vector), dtype=vector.dtype)])


def _moved(link: Link, place: Indices) -> Link:
    """Return the link between the reduced unknowns."""

    def at(pair: tuple[int, int]) -> tuple[int, int]:
        return (int(place[pair[0]]), int(place[pair[1]])) if pair[0] >= 0 else GROUND

    ring = int(place[link.ring]) if link.ring >= 0 else -1
    pads = tuple(int(place[i]) for i in link.pads)
    return replace(link, inner=at(link.inner), outer=at(link.outer), ring=ring, pads=pads)
