"""Motions and films of a recording, as plain arrays: nothing here knows where they were computed.

Everything is SI in the load frame (x along the static load, y 90 degrees ahead of it in the
direction of rotation); units change only where a value is written.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...bearing.operating_point import OperatingPoint
from ...errors import InputError
from .pictures import CascadePicture, EigenvaluePath, MapPicture, SpectrumPicture

Array = NDArray[np.float64]


TRACK_OPTIONS = ("force", "load", "actuator_force", "disc", "minimum_film")
"""Series that a track may have or not."""


@dataclass(frozen=True)
class OrbitTrack:
    """One simulated motion of the journal's centre.

    Attributes
    ----------
    name : str
        Short and unique in the recording, for example the thermal model ("isothermal", "thd").
    time : (n,) array
        Ascending [s].
    x, y : (n,) arrays
        Journal centre from the bearing's centre [m].
    angle : (n,) array
        The shaft has turned by this angle [rad].
    speed : (n,) array
        [rad/s]
    radial_clearance : float
        [m]
    equilibrium : (2,) array, optional
        Static position of the journal's centre [m].
    force : (n, 2) array, optional
        Film force on the journal [N].
    load : (n, 2) array, optional
        What varies in time on the rotor: steps, harmonics, the moving base [N].
    actuator_force : (n, 2) array, optional
        On the journal [N].
    disc : (n, 2) array, optional
        Motion of a flexible rotor's disc, from the bearing's centre [m].
    minimum_film : (n,) array, optional
        Film thickness where it is least [m]. Default: of the plain, aligned bearing.
    boundary : (m, 2) array, optional
        Closed line on which journal and bush touch [m]. Default: the clearance circle.
    once_per_turn : (k, 2) array, optional
        Positions at each whole turn of the shaft in the steady part (Poincare points) [m].
    title : str
        For people; the name where empty.
    """

    name: str
    time: Array
    x: Array
    y: Array
    angle: Array
    speed: Array
    radial_clearance: float
    equilibrium: Array | None = None
    force: Array | None = None
    load: Array | None = None
    actuator_force: Array | None = None
    disc: Array | None = None
    minimum_film: Array | None = None
    boundary: Array | None = None
    once_per_turn: Array | None = None
    title: str = ""

    def __post_init__(self) -> None:
        for key in ("x", "y", "angle", "speed"):
            _same_length(self.name, key, getattr(self, key), self.time)
        for key in TRACK_OPTIONS:
            if getattr(self, key) is not None:
                _same_length(self.name, key, getattr(self, key), self.time)
        if self.time.size < 2 or not np.all(np.diff(self.time) > 0.0):
            raise InputError(
                "a track needs two or more samples in ascending time", key=f"{self.name}.time"
            )

    @property
    def heading(self) -> str:
        """Title, or the name where there is none."""
        return self.title or model_label(self.name)

    @property
    def constant_speed(self) -> bool:
        """Whether the speed stays within a thousandth."""
        return bool(np.ptp(self.speed) <= 1e-3 * np.abs(self.speed).max())

    @property
    def revolutions(self) -> Array:
        """Turns of the shaft since the angle's zero [rev]."""
        return self.angle / (2.0 * np.pi)

    @property
    def eccentricity_ratio(self) -> Array:
        """Distance from the bearing's centre over the clearance [-]."""
        return np.hypot(self.x, self.y) / self.radial_clearance

    @property
    def thinnest_film(self) -> Array:
        """Film thickness where it is least [m]."""
        if self.minimum_film is not None:
            return self.minimum_film
        return self.radial_clearance - np.hypot(self.x, self.y)

    @property
    def contact_line(self) -> Array:
        """Closed line on which journal and bush touch [m]."""
        if self.boundary is not None:
            return self.boundary
        turn = np.linspace(0.0, 2.0 * np.pi, 181)
        return self.radial_clearance * np.column_stack([np.cos(turn), np.sin(turn)])

    @property
    def reach(self) -> float:
        """Farthest that the journal can go from the bearing's centre [m]."""
        return float(np.hypot(*self.contact_line.T).max())


@dataclass(frozen=True)
class FilmSurface:
    """Pressure and temperature of the film at one speed, or at one moment of a run.

    Attributes
    ----------
    name : str
        Thermal model; frames of one name form one animation.
    speed : float
        [rad/s]
    theta : (n,) array
        Cell centres, ascending within one turn [rad].
    y : (m,) array
        Equidistant cell centres, -L/2 to L/2 [m].
    pressure : (n, m) array
        Gauge [Pa].
    temperature : (n, m) array or None
        Mean across the film [K]; None where it is uniform.
    journal_radius, radial_clearance : float
        [m]
    centre : (2,) array
        Journal's centre [m].
    time : float, optional
        The moment in the run of the track of this name [s]; None: journal at rest.
    """

    name: str
    speed: float
    theta: Array
    y: Array
    pressure: Array
    temperature: Array | None
    journal_radius: float
    radial_clearance: float
    centre: Array
    time: float | None = None

    @property
    def length(self) -> float:
        """Of the bearing [m]."""
        return float(self.y[-1] - self.y[0]) * self.y.size / (self.y.size - 1)

    @classmethod
    def from_operating_point(cls, point: OperatingPoint, journal_radius: float) -> FilmSurface:
        """Take what is shown from a solved point; raises InputError where it kept no fields."""
        if point.fields is None:
            raise InputError("the operating point was solved without its fields", key="fields")
        film = point.fields
        eccentricity = point.eccentricity_ratio * point.radial_clearance
        direction = np.array([np.cos(point.attitude_angle), np.sin(point.attitude_angle)])
        mean = film.temperature.mean(axis=2)
        return cls(
            name=point.thermal_model,
            speed=point.speed,
            theta=film.theta,
            y=film.y,
            pressure=film.pressure,
            temperature=mean if np.ptp(mean) > 1e-6 else None,
            journal_radius=journal_radius,
            radial_clearance=point.radial_clearance,
            centre=eccentricity * direction,
        )


@dataclass(frozen=True)
class RecordingContents:
    """Everything that one recording shows; what is empty leaves its view out.

    `kind` is that of the scenario's orbit (``run_up``, ``step``, ...) and decides what the overview
    shows; empty: the whole job, from film to map.
    """

    title: str
    summary: str = ""
    kind: str = ""
    orbits: tuple[OrbitTrack, ...] = ()
    films: tuple[FilmSurface, ...] = ()
    eigenvalues: tuple[EigenvaluePath, ...] = ()
    maps: tuple[MapPicture, ...] = ()
    cascades: tuple[CascadePicture, ...] = ()
    spectra: tuple[SpectrumPicture, ...] = ()


def model_label(name: str) -> str:
    """Write a model's name for titles and legends."""
    return {"thd": "THD"}.get(name, name)


def _same_length(name: str, key: str, values: Array, time: Array) -> None:
    if len(values) != time.size:
        raise InputError(
            f"must have one value for each of the {time.size} times",
            key=f"{name}.{key}",
            value=len(values),
        )
