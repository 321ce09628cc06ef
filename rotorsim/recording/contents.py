"""What a recording shows, as plain arrays: nothing here knows where they were computed.

Everything is SI in the load frame (x along the static load, y 90 degrees ahead of it in the
direction of rotation); units change only where a value is written.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorsim.errors import InputError
from rotorsim.operating_point import OperatingPoint

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
class EigenvaluePath:
    """Eigenvalues of the linear system over speed.

    Attributes
    ----------
    name : str
    speed : (n,) array
        Ascending [rad/s].
    eigenvalues : (n, k) complex array
        Each column one continuous branch [1/s].
    threshold_speed : float, optional
        [rad/s]; None where no branch crosses.
    whirl_frequency_ratio : float, optional
        At the threshold.
    """

    name: str
    speed: Array
    eigenvalues: NDArray[np.complex128]
    threshold_speed: float | None = None
    whirl_frequency_ratio: float | None = None

    def at(self, speed: Array | float) -> NDArray[np.complex128]:
        """Eigenvalues between the tabulated speeds, (..., k); held at both ends."""
        columns = np.moveaxis(self.eigenvalues, -1, 0)
        parts = [
            np.interp(speed, self.speed, column.real)
            + 1j * np.interp(speed, self.speed, column.imag)
            for column in columns
        ]
        return np.stack(parts, axis=-1)


class Verdict(IntEnum):
    """A cell of the stability map."""

    UNKNOWN = 0
    STABLE = 1
    HEATING_DESTABILISES = 2
    UNSTABLE = 3
    HEATING_STABILISES = 4

    @property
    def label(self) -> str:
        """For legends."""
        return VERDICT_LABELS[self]


VERDICT_LABELS = {
    Verdict.UNKNOWN: "not computed",
    Verdict.STABLE: "stable",
    Verdict.HEATING_DESTABILISES: "stable if heating is neglected, unstable with it",
    Verdict.UNSTABLE: "unstable",
    Verdict.HEATING_STABILISES: "unstable if heating is neglected, stable with it",
}


def classify(isothermal_decay: ArrayLike, heated_decay: ArrayLike) -> NDArray[np.uint8]:
    """Verdict of each cell from the two models' decay rates.

    Parameters
    ----------
    isothermal_decay, heated_decay : array_like
        Positive where the motion decays, negative where it grows, NaN where unknown [1/s].

    Returns
    -------
    array of uint8
        `Verdict` values, the broadcast shape of both.
    """
    cold, hot = np.broadcast_arrays(np.asarray(isothermal_decay), np.asarray(heated_decay))
    verdict = np.full(cold.shape, Verdict.UNKNOWN, dtype=np.uint8)
    verdict[(cold > 0) & (hot > 0)] = Verdict.STABLE
    verdict[(cold > 0) & (hot <= 0)] = Verdict.HEATING_DESTABILISES
    verdict[(cold <= 0) & (hot <= 0)] = Verdict.UNSTABLE
    verdict[(cold <= 0) & (hot > 0)] = Verdict.HEATING_STABILISES
    return verdict


@dataclass(frozen=True)
class MapPicture:
    """Stability verdict over speed and rotor mass.

    Attributes
    ----------
    title : str
    speed : (n,) array
        Ascending [rad/s].
    mass : (m,) array
        Ascending, per bearing [kg].
    verdict : (n, m) array of `Verdict` values
        See `classify`.
    rotor_mass : float, optional
        Mass of the simulated rotor [kg]: the moving point's height.
    isothermal_decay, heated_decay : (n, m) arrays, optional
        Decay rates behind the verdict, positive where stable, NaN where unknown [1/s]. With both
        the borders are drawn smooth, between the cells.
    """

    title: str
    speed: Array
    mass: Array
    verdict: NDArray[np.uint8]
    rotor_mass: float | None = None
    isothermal_decay: Array | None = None
    heated_decay: Array | None = None

    def verdict_at(self, speed: Array, mass: Array) -> NDArray[np.uint8]:
        """Verdict on a finer grid, (len(speed), len(mass))."""
        if self.isothermal_decay is None or self.heated_decay is None:
            return self.verdict[np.ix_(nearest(self.speed, speed), nearest(self.mass, mass))]
        cold = _bilinear(self.speed, self.mass, self.isothermal_decay, speed, mass)
        hot = _bilinear(self.speed, self.mass, self.heated_decay, speed, mass)
        return classify(cold, hot)


@dataclass(frozen=True)
class CascadePicture:
    """Spectra of a motion over shaft speed.

    Attributes
    ----------
    title : str
    speed : (n,) array
        Ascending [rad/s].
    frequency : (m,) array
        Ascending [rad/s].
    amplitude : (n, m) array
        [m]
    """

    title: str
    speed: Array
    frequency: Array
    amplitude: Array


@dataclass(frozen=True)
class SpectrumPicture:
    """Spectrum of a motion at constant speed.

    Attributes
    ----------
    name : str
        Of the track.
    speed : float
        Of the shaft [rad/s].
    frequency : (m,) array
        Ascending [rad/s].
    amplitude : (m,) array
        [m]
    """

    name: str
    speed: float
    frequency: Array
    amplitude: Array


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


def nearest(known: Array, wanted: Array) -> NDArray[np.intp]:
    """Index of the nearest of ascending values."""
    return np.searchsorted(0.5 * (known[1:] + known[:-1]), wanted)


def _bilinear(x: Array, y: Array, values: Array, new_x: Array, new_y: Array) -> Array:
    def split(known: Array, wanted: Array) -> tuple[NDArray[np.intp], Array]:
        low = np.clip(np.searchsorted(known, wanted, side="right") - 1, 0, known.size - 2)
        return low, np.clip((wanted - known[low]) / (known[low + 1] - known[low]), 0.0, 1.0)

    i, u = split(x, new_x)
    j, v = split(y, new_y)
    along = values[i] * (1.0 - u[:, None]) + values[i + 1] * u[:, None]
    return along[:, j] * (1.0 - v) + along[:, j + 1] * v


def _same_length(name: str, key: str, values: Array, time: Array) -> None:
    if len(values) != time.size:
        raise InputError(
            f"must have one value for each of the {time.size} times",
            key=f"{name}.{key}",
            value=len(values),
        )
