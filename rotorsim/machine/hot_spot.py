"""Synchronous hot spot (Morton effect): the loop of orbit, heat, bend and orbit (see docs: theory).

A journal that whirls once a revolution is warmer on one side: its surface temperature is
Re[T exp(-i phi)] in the turning frame. The shaft bends towards the warm side, the bend turns with
it and adds to the orbit. With T of every journal in one vector,

    capacity T' = heat (q0 + orbit T) - loss T

q0 being the orbits that the unbalance leaves without a bend. The loop's gains are the eigenvalues
of loss^-1 heat orbit: the temperatures grow without limit where a gain's real part exceeds 1, and
turn slowly round the journal as the imaginary part says (spiral vibration).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, ComplexArray
from .machine import Machine
from .response import forced_response

_WAVES = 4000
"""Points of the integral over axial waves."""
_LARGEST_WAVE = 400.0
"""Of wave number times radius or length, where the integrand has died out."""


@dataclass(frozen=True)
class Journal:
    """A stretch of a shaft that is warmed on one side, from its surface.

    at, length : Of its middle, and along the shaft [m].
    radius, bore : Outer and inner; no heat passes the bore, nor the surface beside the bearing [m].
    expansion : [1/K]
    conductivity : [W/(m K)]
    capacity : rho c [J/(m3 K)]
    """

    at: float
    length: float
    radius: float
    bore: float
    expansion: float
    conductivity: float
    capacity: float

    @property
    def _hollow(self) -> float:
        return (self.bore / self.radius) ** 2

    @property
    def resistance(self) -> float:
        """Mean surface temperature T over a uniform flux, first harmonics [m2 K/W].

        The flux enters within the bearing's length; the shaft goes on at both ends. From waves
        cos(k z) of Laplace's equation, whose radial part is I_1 (and K_1 with a bore).
        """
        wave = np.geomspace(1e-4, _LARGEST_WAVE, _WAVES) / min(self.radius, self.length)
        values = self._surface(wave) * (np.sin(0.5 * wave * self.length) / wave) ** 2
        longest = self._surface(wave[:1])[0] * 0.25 * self.length**2 * wave[0]
        integral = float(np.trapezoid(values * wave, np.log(wave)) + longest)
        return 4.0 / (np.pi * self.length) * integral

    def _surface(self, wave: Array) -> Array:
        """Return surface temperature over flux of a wave along the shaft [m2 K/W]."""
        from scipy.special import ive, kve

        x = wave * self.radius
        # Scaled functions: I by exp(-x), K by exp(x).
        own, slope = ive(1, x), 0.5 * (ive(0, x) + ive(2, x))
        if self.bore > 0.0:
            y = wave * self.bore
            inner = 0.5 * (ive(0, y) + ive(2, y))
            outer = 0.5 * (kve(0, y) + kve(2, y))  # -K_1'
            share = inner / outer * np.exp(2.0 * (y - x))
            own = own + share * kve(1, x)
            slope = slope - share * 0.5 * (kve(0, x) + kve(2, x))
        return own / (self.conductivity * wave * slope)

    @property
    def bend(self) -> float:
        """Angle by which the shaft bends over the mean surface temperature T [rad/K].

        A linear field bends by its first moment, wherever along the shaft the heat has gone: by
        alpha L q/k (1 + 3 b)/(1 - b^2) of a mean flux q, b = (bore/radius)^2.
        """
        b = self._hollow
        by_flux = self.expansion * self.length / self.conductivity * (1.0 + 3.0 * b) / (1.0 - b**2)
        return by_flux / self.resistance

    @property
    def heat_capacity(self) -> float:
        """Heat that T takes up per surface [J/(m2 K)]: of the field r + bore^2/r."""
        b = self._hollow
        radii = np.linspace(np.sqrt(b), 1.0, 201)
        field = (radii + b / np.where(radii > 0.0, radii, 1.0)) / (1.0 + b)
        return self.capacity * self.radius * float(np.trapezoid(field**2 * radii, radii))

    def bow(self, z: Array) -> tuple[Array, Array]:
        """Return displacement and slope of a free shaft bent by 1 rad over the journal, (n,)."""
        from_middle = z - self.at
        half = 0.5 * self.length
        inside = np.clip(from_middle, -half, half)
        beyond = np.abs(from_middle) - np.abs(inside)
        return 0.5 * (inside**2 / self.length + beyond), inside / self.length


@dataclass(frozen=True, eq=False)
class SpotFilms:
    """Films of the journals over speed, machine's frame.

    speed : (n,) array. Ascending [rad/s].
    heat : (n, b, 2) complex array. Flux into each journal by its motion along x and y, relative to
        the bearing [W/m^2 per m].
    loss : (n, b) complex array. Flux out of it by its own T, in the film [W/(m2 K)].
    """

    speed: Array
    heat: ComplexArray
    loss: ComplexArray

    def at(self, speed: Array) -> SpotFilms:
        """Return the films at speeds between (monotone cubic)."""
        if self.speed.size < 2:
            return self
        from scipy.interpolate import PchipInterpolator

        def between(values: ComplexArray) -> ComplexArray:
            real, imaginary = (
                PchipInterpolator(self.speed, part)(speed) for part in (values.real, values.imag)
            )
            return real + 1j * imaginary

        return SpotFilms(speed, between(self.heat), between(self.loss))


@dataclass(frozen=True, eq=False)
class SpotLoop:
    """The loop over speed.

    gain : (n, b) complex array. Eigenvalues of the loop, the largest real part first.
    growth_rate, frequency : (n,) arrays. Of the temperature that grows fastest [1/s], and how fast
        the hot spot moves round the journal, with the rotation where positive [rad/s].
    temperature : (n, b) complex array. T of each journal under the rotor's unbalance, settled: half
        the difference across it [K]; what it would settle to where it grows.
    motion : (n, b, 2) complex array. Of each journal then, along x and y [m].
    cold : (n, b, 2) complex array. The same without a bend.
    """

    speed: Array
    gain: ComplexArray
    growth_rate: Array
    frequency: Array
    temperature: ComplexArray
    motion: ComplexArray
    cold: ComplexArray


def spot_loop(
    machine: Machine, journals: Sequence[Journal], mounts: Sequence[int], films: SpotFilms
) -> SpotLoop:
    """Return the loop of some journals at the films' speeds.

    mounts : Number of the support of each journal, among the machine's.
    """
    speed, rotor, count = films.speed, machine.rotor, len(journals)
    force = np.zeros((count + 1, speed.size, machine.size), dtype=complex)
    for j, journal in enumerate(journals):
        force[j, :, : rotor.size] = rotor.stiffness @ _turning_bow(machine, journal) * journal.bend
    force[count, :, : rotor.size] = rotor.unbalance_force(speed)
    answers = np.stack([forced_response(machine, speed, one) for one in force])
    relative = np.stack([answers @ _relative(machine, number).T for number in mounts], axis=2)
    orbit, cold = relative[:count], relative[count]  # (b, n, b, 2), (n, b, 2)
    capacity = np.array([one.heat_capacity for one in journals])
    loss = films.loss + np.array([1.0 / one.resistance for one in journals])
    driven = np.einsum("nik,jnik->nij", films.heat, orbit)
    rates = (driven - loss[:, :, None] * np.eye(count)) / capacity[:, None]
    known = np.isfinite(rates).all(axis=(1, 2))
    gain = np.full((speed.size, count), np.nan + 0j)
    fastest = np.full(speed.size, np.nan + 0j)
    temperature = np.full((speed.size, count), np.nan + 0j)
    for n in np.flatnonzero(known):
        values = np.linalg.eigvals(driven[n] / loss[n][:, None])
        gain[n] = values[np.argsort(-np.real(values))]
        growing = np.linalg.eigvals(rates[n])
        fastest[n] = growing[np.argmax(np.real(growing))]
        source = np.einsum("ik,ik->i", films.heat[n], cold[n])
        temperature[n] = np.linalg.solve(np.diag(loss[n]) - driven[n], source)
    motion = cold + np.einsum("jnik,nj->nik", orbit, temperature)
    growth_rate, frequency = np.real(fastest), np.imag(fastest)
    return SpotLoop(speed, gain, growth_rate, frequency, temperature, motion, cold)


def _turning_bow(machine: Machine, journal: Journal) -> ComplexArray:
    """Return the free bow (rotor.size,) that T = 1 rad of bend gives, as Re[u exp(i Omega t)].

    The warm side is the convex one. At t = 0 it points along x, then turns towards y.
    """
    rotor = machine.rotor
    bow = np.zeros(rotor.size, dtype=complex)
    positions = np.array([node.position for node in rotor.nodes])
    displacement, slope = journal.bow(positions)
    for k, node in enumerate(rotor.nodes):
        first = int(rotor.first_unknown[k])
        parts = {
            "x": -displacement[k], "y": 1j * displacement[k],
            "theta_y": -slope[k], "theta_x": -1j * slope[k],
        }  # fmt: skip
        for name, value in parts.items():
            if name in node.unknowns:
                bow[first + node.unknowns.index(name)] = value
    return bow


def _relative(machine: Machine, number: int) -> Array:
    """Return the matrix (2, size) from the unknowns to the journal's motion in its bearing."""
    mount, place = machine.mounts[number], machine.places[number]
    found = np.zeros((2, machine.size))
    for axis, name in enumerate(("x", "y")):
        found[axis, place[mount.support.unknowns.index(name)]] = 1.0
        if f"housing_{name}" in mount.support.unknowns:
            found[axis, place[mount.support.unknowns.index(f"housing_{name}")]] = -1.0
    return found
