"""The two walls of the film, bush and shaft: their temperatures, and the heat they take.

One object per wall, chosen once by name (`choose_walls`). The film meets a wall through a
`FilmContact`; the wall answers with its next surface temperature, and with the heat it takes at a
given one. The walls below answer in steady state. A wall that stores heat is the same protocol: an
implicit time step is one more such object, made from the wall's state at the step's beginning and
the step's length, and the film's iteration does not see the difference.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..arrays import Array, Booleans
from ..errors import InputError
from ..model import BushModel, ShaftModel
from .bush import BushOperator, kept_operator
from .energy import EnergyProblem
from .problem import FilmProblem


@dataclass(frozen=True)
class FilmContact:
    """The film as one of its walls meets it.

    film : (n, m) array. Temperature of the layer next to the wall [K].
    conductance : (n, m) array. Between that layer and the wall [W/K].
    elsewhere : Heat that the film loses to oil and other wall per degree that it warms [W/K],
        estimated.
    """

    energy: EnergyProblem
    film: Array
    conductance: Array
    elsewhere: float = math.inf

    @classmethod
    def bush(cls, energy: EnergyProblem, temperature: Array) -> FilmContact:
        """Return the contact with the bush of a film at `temperature`, (n, m, k) [K]."""
        return cls(energy, temperature[:, :, 0], energy.wall_conductance(0))

    @classmethod
    def shaft(
        cls, energy: EnergyProblem, temperature: Array, elsewhere: float = math.inf
    ) -> FilmContact:
        """Return the contact with the shaft."""
        return cls(energy, temperature[:, :, -1], energy.wall_conductance(-1), elsewhere)

    @property
    def layers(self) -> int:
        """Layers across the film; the wall lies half a layer from the first centre."""
        return self.energy.layers.pressure_share.shape[2]

    @property
    def bulk(self) -> Array:
        """Conductance k A/h of the whole film's thickness, by the oil in it [W/K], (n, m)."""
        return self.energy.conductance / self.layers

    @property
    def area(self) -> Array:
        """Area of each cell [m2], (n, m)."""
        return self.energy.dx[:, None] * self.energy.dy

    def heat(self, wall: Array | float) -> Array:
        """Return the heat that each cell gives to a wall at temperature `wall` [W], (n, m)."""
        return self.conductance * (self.film - wall)


@dataclass(frozen=True)
class _Wall(ABC):
    """One wall of the film. The bush's temperature is (n, m), the shaft's a single one.

    first : First guess of the surface temperature, the truth where it is given [K].
    insulated : Whether no heat passes anywhere.
    floats : Whether one temperature answers the film's net heat: then `FilmContact.elsewhere`
        counts.
    """

    first: float
    insulated: ClassVar[bool] = False
    floats: ClassVar[bool] = False

    def start(self, shape: tuple[int, ...]) -> Array:
        """Return the surface temperature to begin with [K]."""
        return np.full(shape, self.first)

    def heat(self, temperature: Array | float, contact: FilmContact, /) -> Array:
        """Return the heat that the wall takes from each cell [W], (n, m)."""
        return contact.heat(temperature)

    @abstractmethod
    def respond(self, temperature: Array, contact: FilmContact, /) -> Array:
        """Return the surface temperature that answers the film, the old one given [K]."""

    def exchange(self, _contact: FilmContact, /) -> Array | float:
        """Return how the heat follows a change of the surface temperature [W/K], estimated."""
        return 0.0

    def bodies(self, temperature: Array, /) -> Array:
        """Return mean temperature [K] and dT/dr [K/m] of the solid, or of each pad, (solids, 2).

        Without a field of its own a solid has the mean temperature of its surface.
        """
        return np.array([[float(np.mean(temperature)), 0.0]])


@dataclass(frozen=True)
class _FixedWall(_Wall):
    """A wall at a given temperature, whatever heat it takes."""

    def respond(self, temperature: Array, _contact: FilmContact, /) -> Array:
        """Return the given temperature."""
        return temperature


@dataclass(frozen=True)
class _InsulatedWall(_Wall):
    """A wall that takes no heat anywhere and has the film's temperature."""

    insulated = True

    def heat(self, _temperature: Array | float, contact: FilmContact, /) -> Array:
        """Return zeros."""
        return np.zeros(contact.film.shape)

    def respond(self, _temperature: Array, contact: FilmContact, /) -> Array:
        """Return the film's temperature."""
        return contact.film.copy()


@dataclass(frozen=True)
class _IsothermalShaft(_Wall):
    """A shaft of one temperature that takes no net heat: it turns fast against its inertia."""

    floats = True

    def respond(self, temperature: Array, contact: FilmContact, /) -> Array:
        """Return the temperature at which the film's net heat would vanish."""
        conductance = self.exchange(contact)
        if not conductance > 0.0:  # a film that has run dry heats no shaft
            return temperature
        return temperature + self.heat(temperature, contact).sum() / conductance

    def exchange(self, contact: FilmContact, /) -> float:
        """Return how the net heat follows the shaft; only the convergence depends on it.

        Into the film, a developing film's few times k A/h, and from there elsewhere, in series. Not
        less than a part of the first, since a film that is not yet settled answers at once.
        """
        into = float(8.0 * contact.bulk.sum())
        if not (into > 0.0 and contact.elsewhere > 0.0):
            return into
        return max(1.0 / (1.0 / into + 1.0 / contact.elsewhere), 0.05 * into)


@dataclass(frozen=True)
class _ConductingBush(_Wall):
    """A bush that conducts the heat from its bore to surroundings at `ambient` [K].

    `nusselt` estimates how many times k A/h the film's heat follows the bore; only the convergence
    depends on it.
    """

    operator: BushOperator
    ambient: float
    nusselt: float

    @classmethod
    def of(cls, problem: FilmProblem) -> _ConductingBush:
        """Build the bush of a film problem; the operators of recent meshes are kept.

        Raises InputError: The bearing has no `bush_outer_radius`.
        """
        mesh, thermal, bearing = problem.mesh, problem.thermal, problem.bearing
        outer = bearing.bush_outer_radius
        if outer is None:
            raise InputError(
                "is missing: conduction in the bush needs it; give it in metres, for example "
                f"bush_outer_radius={1.5 * bearing.journal_radius:.3g}, or another bush model",
                key="bearing.bush_outer_radius",
            )
        transfer, oil = thermal.bush_heat_transfer, problem.lubricant
        capacity = oil.density * oil.specific_heat * problem.surface_speed
        peclet = capacity * bearing.radial_clearance**2 / bearing.journal_radius
        peclet /= oil.thermal_conductivity
        operator = kept_operator(
            mesh.theta_faces.tobytes(),
            mesh.y_faces.tobytes(),
            (bearing.journal_radius, outer),
            problem.settings.mesh.bush_radial,
            thermal.bush_conductivity,
            transfer,
            (0.0 if mesh.half else transfer, transfer),
        )
        # A thermal layer that grows along the bore (Leveque); conduction across the whole film.
        nusselt = max(3.0, 1.6 * peclet ** (1.0 / 3.0))
        return cls(thermal.supply_temperature, operator, thermal.ambient_temperature, nusselt)

    def respond(self, temperature: Array, contact: FilmContact, /) -> Array:
        """Return the bore's temperature that answers the film's heat at the old one."""
        flux = self.heat(temperature, contact) / contact.area
        conductance = float(self.exchange(contact).sum()) / float(contact.area.sum())
        return _conducted(self.operator, temperature, flux, conductance, self.ambient)

    def bodies(self, temperature: Array, /) -> Array:
        """Return the mean temperature and gradient of the bush."""
        mean, gradient = self.operator.body(temperature - self.ambient)
        return np.array([[self.ambient + mean, gradient]])

    def exchange(self, contact: FilmContact, /) -> Array:
        """Return `nusselt` times k A/h of every cell, at most what the first half layer passes."""
        return min(self.nusselt, 2.0 * contact.layers) * contact.bulk


@dataclass(frozen=True)
class _ConductingPads(_Wall):
    """Pads that conduct to surroundings at `ambient` [K] behind, beside and before them.

    columns : tuple of (n,) bool arrays. Cells of each pad.
    """

    columns: tuple[Booleans, ...]
    operators: tuple[BushOperator, ...]
    ambient: float

    @classmethod
    def of(cls, problem: FilmProblem) -> _ConductingPads:
        """Build the pads of a film problem; the operators of recent meshes are kept."""
        mesh, thermal, bearing = problem.mesh, problem.thermal, problem.bearing
        transfer, columns, operators = thermal.bush_heat_transfer, [], []
        for number, pad in enumerate(bearing.pads):
            own = mesh.region == number
            first = int(np.flatnonzero(own)[0])
            faces = mesh.theta_faces[first : first + int(own.sum()) + 1]
            columns.append(own)
            operators.append(
                kept_operator(
                    np.round(faces - faces[0], 12).tobytes(),
                    mesh.y_faces.tobytes(),
                    (bearing.journal_radius, bearing.journal_radius + pad.thickness),
                    problem.settings.mesh.bush_radial,
                    thermal.bush_conductivity,
                    transfer,
                    (0.0 if mesh.half else transfer, transfer),
                    transfer,
                )
            )
        first_guess = thermal.supply_temperature
        return cls(first_guess, tuple(columns), tuple(operators), thermal.ambient_temperature)

    def respond(self, temperature: Array, contact: FilmContact, /) -> Array:
        """Return the pads' surface temperature that answers the film's heat at the old one."""
        flux, exchange = self.heat(temperature, contact) / contact.area, self.exchange(contact)
        result = temperature.copy()
        for own, operator in zip(self.columns, self.operators, strict=True):
            conductance = float(exchange[own].sum()) / float(contact.area[own].sum())
            result[own] = _conducted(
                operator, temperature[own], flux[own], conductance, self.ambient
            )
        return result

    def bodies(self, temperature: Array, /) -> Array:
        """Return the mean temperature and gradient of each pad."""
        values = [
            operator.body(temperature[own] - self.ambient)
            for own, operator in zip(self.columns, self.operators, strict=True)
        ]
        return np.array([[self.ambient, 0.0]]) + np.array(values)

    def exchange(self, contact: FilmContact, /) -> Array:
        """Return 2 k A/h of every cell."""
        return 2.0 * contact.bulk


def _conducted(
    operator: BushOperator, temperature: Array, flux: Array, conductance: float, ambient: float
) -> Array:
    """Return surface temperature [K] of a solid that answers the film's heat flux at the old one.

    The film is taken to answer a change of the surface with a uniform conductance (a Robin
    condition): handing over the flux itself would not converge, since the surroundings take far
    less heat per degree than the film brings.
    """
    if not conductance > 0.0:
        return temperature
    reference = temperature - ambient + flux / conductance
    return ambient + operator.robin_rise(reference, conductance)


def _conducting(problem: FilmProblem) -> _Wall:
    pads = problem.bearing.pads
    return _ConductingPads.of(problem) if pads else _ConductingBush.of(problem)


@dataclass(frozen=True)
class Walls:
    """Both walls of a film.

    pads : tuple of (n,) bool arrays. Cells of each pad; empty for a bore.
    ring : Temperature of what the pads stand in [K].
    """

    bush: _Wall
    shaft: _Wall
    pads: tuple[Booleans, ...] = ()
    ring: float = 0.0

    def bodies(self, bush: Array) -> Array:
        """Return mean temperature [K] and dT/dr [K/m] of bush, or of every pad and their ring."""
        if not self.pads:
            return self.bush.bodies(bush)
        if isinstance(self.bush, _ConductingPads):
            pads = self.bush.bodies(bush)
        else:
            pads = np.concatenate([self.bush.bodies(bush[own]) for own in self.pads])
        return np.concatenate([pads, [[self.ring, 0.0]]])

    def shaft_body(self, surface: float) -> float:
        """Return the mean temperature of the journal [K]."""
        return float(self.shaft.bodies(np.array(surface))[0, 0])


_BUSHES: dict[BushModel, Callable[[FilmProblem], _Wall]] = {
    BushModel.AMBIENT: lambda problem: _FixedWall(problem.thermal.ambient_temperature),
    BushModel.INSULATED: lambda problem: _InsulatedWall(problem.thermal.supply_temperature),
    BushModel.CONDUCTION: _conducting,
}
_SHAFTS: dict[ShaftModel, Callable[[FilmProblem], _Wall]] = {
    ShaftModel.AMBIENT: lambda problem: _FixedWall(problem.thermal.ambient_temperature),
    ShaftModel.INSULATED: lambda problem: _IsothermalShaft(problem.thermal.supply_temperature),
    ShaftModel.GIVEN: lambda problem: _FixedWall(problem.thermal.shaft_temperature or 0.0),
}


def choose_walls(problem: FilmProblem) -> Walls:
    """Return the walls that the problem's thermal settings name.

    Raises InputError: The bush conducts and the bearing has no `bush_outer_radius`.
    """
    thermal, region = problem.thermal, problem.mesh.region
    return Walls(
        _BUSHES[thermal.bush](problem),
        _SHAFTS[thermal.shaft](problem),
        tuple(region == number for number in range(len(problem.bearing.pads))),
        thermal.ambient_temperature,
    )
