"""From a machine file to its motion in time."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arguments import refuse_no_machine
from ..arrays import Array, ComplexArray, Indices
from ..errors import InputError
from ..files.machine import MachineFile
from ..machine.machine import Machine
from ..machine.matrices import base_force
from ..machine.output_feedback import OutputFeedback
from ..machine.peaks import node_at
from ..model.machine_orbit import MachineOrbit
from ..model.orbit import SpeedRamp
from ..orbit.controlled import closed_eigenvalues, signals_of, with_controller
from ..orbit.film_force import SolvedFilmForce
from ..orbit.motion import Motion, MotionProblem, Station
from ..orbit.run import simulate_motion
from ..orbit.system import GROUND, Harmonic, Link, MotionSystem, derivatives
from ..rotor.reduction import reduce_rotor
from .machine_control import designed_feedback
from .machine_supports import seal_mounts
from .motion_statics import linear_block, rest_position
from .motion_supports import MotionParts

if TYPE_CHECKING:
    from .machine import MachineResult


_MAX_SAMPLES = 1_000_000
_REDUCTION = 1e-4
"""Relative change of eigenvalues that a reduction may bring."""
_ROUNDING = 1e-6
"""Growth rate over frequency that an undamped mode may show."""
_SMALL = 48
"""Unknowns of a rotor that is not reduced."""
_MIN_MODES = 8


def simulate(
    machine: MachineFile,
    *,
    orbit: MachineOrbit | None = None,
    problem: MotionProblem | None = None,
    result: MachineResult | None = None,
    controller: Any = None,
    consume: Callable[[Motion], None] | None = None,
) -> Motion:
    """Integrate a machine's motion in time.

    Parameters
    ----------
    machine : MachineFile
        With ``[orbit]``.
    orbit : MachineOrbit, optional
        In place of the file's.
    problem : MotionProblem, optional
        From `motion_problem`, where it is there already.
    result : MachineResult, optional
        The machine's films over speed, where they are solved already.
    controller : OutputFeedback or system of python-control, optional
        From sensors to actuators at any nodes, about the static position at the first speed,
        continuous or sampled; signals are named as those of `rotorsim.state_space` (see
        `OutputFeedback.of`). By default that of the file's ``[control]`` where ``orbit.control`` is
        set.
    consume : callable, optional
        Called with each piece of some revolutions as soon as it is there.

    Returns
    -------
    Motion
        How the run ended is its ``status``; of a run of more than a million samples the last ones.

    Raises InputError: The file has no orbit, a film cannot have the force asked for, a speed lies
        outside its bearings' range, or a controller's signal is not there.
    """
    if problem is not None and controller is not None:
        raise InputError("is that of the problem: give it to motion_problem", key="controller")
    problem = problem or motion_problem(machine, orbit, result, controller)
    keep = _MAX_SAMPLES // problem.samples_per_revolution
    return simulate_motion(problem, consume=consume, keep_revolutions=keep)


def motion_problem(
    machine: MachineFile, orbit: MachineOrbit | None = None, result: MachineResult | None = None,
    controller: Any = None,
) -> MotionProblem:  # fmt: skip
    """Put a machine's motion together; see `simulate`."""
    refuse_no_machine(machine)
    settings = orbit or machine.orbit
    if settings is None:
        raise InputError(
            "is missing: a motion in time needs the table [orbit]", source=machine.source,
            key="orbit",
        )  # fmt: skip
    try:
        builder = _Builder(machine, settings, result)
        if controller is None and settings.control:
            controller = designed_feedback(machine, builder.first)
        elif controller is not None and not isinstance(controller, OutputFeedback):
            controller = OutputFeedback.of(controller)
        builder.controller = controller
        return builder.problem()
    except InputError as error:
        if error.source is not None:
            raise
        raise type(error)(
            error.message, source=machine.source, key=error.key, value=error.value
        ) from None


class _Builder(MotionParts):
    """The equations of one machine with one [orbit]."""

    controller: OutputFeedback | None = None

    def problem(self) -> MotionProblem:
        """Return everything together; the reduction is refined until its error is small enough."""
        linear = self.linear_machine()
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
            name: np.pad(getattr(rotor, name), (0, total - size))
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
        names = self._names(linear)
        shaken = base_force(whole["mass"], rotor.mass, names)
        static = np.pad(self.static_force(self.first), (0, total - size))
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
            block=linear_block(self, linear, place, {}), loads=self._loads(basis, shaken),
            names=names,
            turned_offset=basis.T @ (whole["circulatory"] @ offset),
        )  # fmt: skip
        rest = rest_position(self, system)
        seals = seal_mounts(self.machine, rotor)
        if seals:
            with_seals = Machine(rotor, [*linear.mounts, *seals])
            at = {m.name: rest[place[p]] for m, p in zip(
                with_seals.mounts[len(linear.mounts):],
                with_seals.places[len(linear.mounts):], strict=True)}  # fmt: skip
            system = replace(system, block=linear_block(self, with_seals, place, at))
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
        problem = MotionProblem(
            system, self.drive, start, velocity, rest, self._stations(system),
            self.settings.samples_per_revolution, self.settings.relative_tolerance,
            self._label(), self.settings.thermal_model or "", self._note(), error,
            tuple(entry.frequency for entry in self.settings.harmonic),
        )  # fmt: skip
        if self.controller is None:
            return problem
        return with_controller(problem, self.controller, rest, system.names)

    def _kept(self, linear: Machine) -> list[int]:
        size = self.rotor.size
        kept = [int(i) for places in linear.places for i in places if i < size]
        kept += [i for link in self.links for i in link.inner if i < size]
        kept += [i for at, _, _ in self.springs for i in at if i < size]
        places = [entry.at for entry in (*self.settings.placed, *self.machine.load,
                                         *self.machine.seal)]  # fmt: skip
        nodes = [node_at(self.rotor, at) for at in places]
        nodes += [int(i) for i in np.flatnonzero(self.rotor.unbalance)]
        if self.controller is not None:
            kept += [i for i in signals_of(self.controller, self._names(linear)).places if i < size]
        return sorted({*kept, *(i for node in nodes for i in self.rotor.planes[node])})

    def _names(self, linear: Machine) -> tuple[tuple[str, str], ...]:
        own = ((name, unknown) for name, unknown, _ in self.own)
        return (*self.rotor.unknowns, *linear.unknowns[self.rotor.size :], *own)

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
            own = np.pad(self.rotor.unbalance_force(1.0), (0, total - self.rotor.size))
            found.append((-math.inf, basis.T @ own))
        for entry in self.settings.blade_loss:
            x, y = self.rotor.planes[node_at(self.rotor, entry.at)]
            amount = np.zeros(total, dtype=complex)
            turned = entry.amount * np.exp(1j * entry.phase)
            amount[x], amount[y] = turned, -1j * turned
            found.append((entry.start, basis.T @ amount))
        return tuple(found)

    def _loads(self, basis: Array, shaken: Array) -> tuple[Harmonic, ...]:
        settings, found = self.settings, []
        for entry in (*settings.step, *settings.harmonic):
            amplitude = np.zeros(basis.shape[0], dtype=complex)
            phase = np.array(getattr(entry, "phase", (0.0, 0.0)))
            places = list(self.rotor.planes[node_at(self.rotor, entry.at)])
            amplitude[places] = np.array(entry.force) * np.exp(1j * phase)
            frequency = getattr(entry, "frequency", 0.0)
            forces = np.asarray(basis.T @ amplitude, dtype=complex)
            found.append(Harmonic(forces, frequency, entry.start, entry.stop))
        if settings.base_motion is not None:
            base = settings.base_motion
            moved = np.array(base.displacement) * np.exp(1j * np.array(base.phase))
            force = -(base.frequency**2) * (shaken @ moved)
            forces = np.asarray(basis.T @ force, dtype=complex)
            found.append(Harmonic(forces, base.frequency, base.start, base.stop))
        if settings.base_shock is not None:
            shock = settings.base_shock
            frequency = math.pi / shock.duration
            turned = 1j * np.exp(-1j * frequency * shock.start)
            force = -(shaken @ np.array(shock.acceleration)) * turned
            found.append(
                Harmonic(basis.T @ force, frequency, shock.start, shock.start + shock.duration)
            )
        return tuple(found)

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

        def poles(m: Array, c: Array, k: Array, basis: Array) -> ComplexArray:
            n = len(m)
            matrix = np.zeros((2 * n, 2 * n))
            matrix[:n, n:] = np.eye(n)
            matrix[n:] = -np.linalg.solve(m, np.hstack([k, c]))
            if self.controller is None:
                return np.asarray(eigvals(matrix), dtype=complex)
            return closed_eigenvalues(self.controller, matrix, m, basis, system.names)

        exact = poles(whole["mass"], big_c, big_k, np.eye(len(big_k)))
        counts = np.abs(exact) <= reach
        if self.controller is not None:
            # it may drive any mode: what grows by more than rounding counts, however fast
            counts |= exact.real > _ROUNDING * np.abs(exact)
        exact = exact[counts]
        ours = poles(system.mass, c, k, system.basis)
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
        if self.controller is not None:
            shown = {place for one in found.values() for place in one.places}
            for i in signals_of(self.controller, system.names).driven:
                node = next((k for k, both in enumerate(rotor.planes) if i in both), None)
                if node is not None and i not in shown:
                    name, at = rotor.nodes[node].name, rotor.nodes[node].position
                    found[name] = Station(name, rotor.planes[node], at)
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


def _moved(link: Link, place: Indices) -> Link:
    """Return the link between the reduced unknowns."""

    def at(pair: tuple[int, int]) -> tuple[int, int]:
        return (int(place[pair[0]]), int(place[pair[1]])) if pair[0] >= 0 else GROUND

    ring = int(place[link.ring]) if link.ring >= 0 else -1
    pads = tuple(int(place[i]) for i in link.pads)
    return replace(link, inner=at(link.inner), outer=at(link.outer), ring=ring, pads=pads)
