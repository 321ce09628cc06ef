"""A machine as its file describes it: what loads it, where it is watched, what is asked of it.

What carries the rotor is in `supports`.

Positions are measured from the left end of the shaft [m]. The machine's frame: x points down
(gravity), y is 90 degrees ahead of x in the direction of rotation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from ..errors import InputError
from ..units import parse_quantity
from .entries import Angle, Example, Leaf, Length, Number, Quantity, Speed
from .expansion import STEEL_EXPANSION, Coefficient
from .operating import MAX_COUNT, SpeedRange, ascending
from .orbit import Design
from .shaft import Place
from .tolerances import Distribution


@dataclass(frozen=True)
class UnbalanceEntry:
    """An unbalance at a place of the shaft.

    at : [m]
    amount : Mass times radius [kg m].
    grade : In place of `amount`: balance quality grade of the whole rotor at the highest speed, for
        example ``G2.5`` (ISO 21940-11), shared equally by the planes that name it.
    phase : Ahead of x at t = 0 [rad].
    """

    at: Annotated[Place, Example("620 mm")]
    amount: Annotated[float, Quantity("unbalance", "200 g*mm", "not_negative")] | None = None
    grade: str | None = None
    phase: Angle = 0.0

    def __post_init__(self) -> None:
        if (self.amount is None) == (self.grade is None):
            raise InputError('needs amount = "200 g*mm" or grade = "G2.5"', key="amount")
        if self.grade is not None:
            _ = self.velocity

    @property
    def velocity(self) -> float:
        """Eccentricity times speed that the grade allows [m/s]."""
        text = (self.grade or "").strip().upper().removeprefix("G").strip()
        try:
            value = float(text)
        except ValueError:
            value = -1.0
        if not 0.0 < value < 1e5:
            raise InputError(
                'must be a balance quality grade, for example "G2.5"', key="grade",
                value=self.grade,
            )  # fmt: skip
        return value * 1e-3


@dataclass(frozen=True)
class Probe:
    """A displacement probe.

    at : [m]
    angle : From x (down) in the direction of rotation [rad].
    """

    at: Annotated[Place, Example("90 mm")]
    name: str = ""
    angle: Angle = 0.0


class ForceEntry(Leaf):
    """A static force: ``[fx, fy]``, or a list of ``[speed, fx, fy]``."""

    def read(self, value: object) -> tuple[tuple[float, float, float], ...]:
        """Return rows of speed [rad/s], fx, fy [N]; one row at speed 0 holds at all speeds."""
        if isinstance(value, list) and value:
            if len(value) == 2 and all(isinstance(part, str) for part in value):
                x, y = (parse_quantity(part, "force", example="2 kN") for part in value)
                return ((0.0, x, y),)
            if all(isinstance(row, list) and len(row) == 3 for row in value):
                rows = tuple(
                    (
                        parse_quantity(speed, "speed", example="3000 rpm"),
                        parse_quantity(x, "force", example="2 kN"),
                        parse_quantity(y, "force", example="-1 kN"),
                    )
                    for speed, x, y in value
                )
                ascending(tuple(row[0] for row in rows), "force")
                return rows
        raise InputError(
            'must be a pair ["2 kN", "-1 kN"] along x and y, or a list of '
            '["3000 rpm", "2 kN", "-1 kN"]'
        )


@dataclass(frozen=True)
class StaticForce:
    """A static force on the shaft, of a gear mesh for example.

    at : [m]
    force : tuple of (speed, fx, fy) [rad/s, N, N]; linear between the speeds, constant beyond them.
    """

    at: Annotated[Place, Example("400 mm")]
    force: Annotated[
        tuple[tuple[float, float, float], ...], ForceEntry(), Example(["2 kN", "-1 kN"])
    ]
    name: str = ""


@dataclass(frozen=True)
class Clearance:
    """A close clearance that the response is checked against.

    at : [m]
    diametral : [m]
    """

    at: Annotated[Place, Example("650 mm")]
    diametral: Annotated[Length, Example("0.5 mm")]
    name: str = ""


@dataclass(frozen=True)
class MachineOperating:
    """Speeds of a machine.

    speed : tuple of float or SpeedRange. Ascending [rad/s]; a range becomes its values.
    continuous : (float, float) or None. The range of speeds that margins are judged for [rad/s].
    trip : [rad/s]
    vertical : A vertical shaft has no static load from its weight.
    """

    speed: tuple[Speed, ...] | SpeedRange
    continuous: tuple[Speed, Speed] | None = None
    trip: Speed | None = None
    vertical: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "speed", ascending(self.speed, "operating.speed"))
        if self.continuous is not None and not self.continuous[0] <= self.continuous[1]:
            raise InputError("the second speed must be the higher one", key="operating.continuous")

    @property
    def speeds(self) -> tuple[float, ...]:
        """Ascending [rad/s]."""
        return ascending(self.speed, "operating.speed")


@dataclass(frozen=True)
class Destabilising:
    """A destabilising cross stiffness k_xy = -k_yx = Q that is anticipated at a place.

    at : [m]
    anticipated : [N/m]
    """

    at: Annotated[Place, Example("700 mm")]
    anticipated: Annotated[float, Quantity("stiffness", "5 MN/m")]


@dataclass(frozen=True)
class LateralSettings:
    """Entries of a lateral analysis in the style of API 617 and 684 beyond the machine.

    Every number of it is an input; the edition is printed with the results.

    unbalance_factor : Times the residual unbalance; editions differ.
    """

    edition: str = "not stated"
    unbalance_factor: Annotated[float, Number(above=0.0, most=100.0)] = 4.0
    destabilising_stiffness: tuple[Destabilising, ...] = ()


@dataclass(frozen=True)
class HotSpotSettings:
    """Synchronous hot spots of a machine's journals (Morton effect).

    support : Names of supports on films; by default all of them.
    expansion, conductivity, specific_heat : Of the shaft [1/K, W/(m K), J/(kg K)].
    films : Speeds at which the films are solved for it, evenly over the machine's.
    """

    support: tuple[str, ...] = ()
    expansion: Coefficient = STEEL_EXPANSION
    conductivity: Annotated[float, Quantity("thermal conductivity", "45 W/(m*delta_degC)")] = 45.0
    specific_heat: Annotated[float, Quantity("specific heat", "460 J/(kg*delta_degC)")] = 460.0
    films: Annotated[int, Number(least=2, most=MAX_COUNT)] = 12


class _Unread(Leaf):
    """A value whose meaning depends on the parameter that it belongs to."""

    def read(self, value: object) -> Any:
        """Return the value as it stands."""
        return tuple(value) if isinstance(value, list) else value


_Unchecked = Annotated[Any, _Unread()]


@dataclass(frozen=True)
class MapEntry:
    """A map of stability over two parameters of the machine.

    x, y : Their names; see `rotorsim.files.parameters`.
    x_values, y_values : With units; or ``{ start, stop, count }``. By default a span about the
        file's value.
    hold : Values of other parameters, in place of the file's, by name.
    """

    x: Annotated[str, Example("speed")]
    y: Annotated[str, Example("left.radial_clearance")]
    x_values: _Unchecked = None
    y_values: _Unchecked = None
    hold: _Unchecked = None


@dataclass(frozen=True)
class MachineTolerances:
    """Tolerances of a machine's parameters.

    spread : By the parameter's name: ``"5 um"``, ``"10 %"``, or a table with its own distribution.
    distribution : Of every parameter that does not say otherwise.
    speed : At which stability is asked for [rad/s]; by default the highest continuous one, else the
        highest.
    samples, seed : See `rotorsim.model.tolerances.ToleranceSettings`.
    """

    spread: Annotated[Any, _Unread(), Example({"left.radial_clearance": "5 um"})]
    distribution: Distribution = Distribution.UNIFORM
    speed: Speed | None = None
    samples: Annotated[int, Number(least=8, most=MAX_COUNT)] = 64
    seed: Annotated[int, Number(least=0, most=2**31)] = 0


MOST_WAITING = 50
"""Sample times that a delay may last: each waiting force is a state of the sampled loop."""


@dataclass(frozen=True)
class MachineControl:
    """Active magnetic actuators and the sensors that they listen to.

    actuator, sensor : Places: lengths from the left end, or names of discs, supports, seals,
        probes. Each acts or measures along x and y. Sensors default to the actuators' places.
    design : ``lqr``: regulator and Kalman filter on the reduced machine; ``pd``: each sensor to the
        actuator of the same number.
    max_force : Saturation of each axis [N].
    speed : By default the highest [rad/s].
    displacement_scale : At the sensors, as bad as the full force [m].
    force_scale : What counts as a large force [N]; `max_force` where that is finite.
    noise : Of the sensors, for the Kalman filter: against a disturbance of `force_scale` [m].
    reduction_error : Of the reduced model: bound on the error of the receptance from actuators to
        sensors, as a share of its largest stable part; less where the feedback would drive what is
        left out.
    sample_time : Of a digital controller: the design by the bilinear rule, its forces held from
        sample to sample [s]. By default it is continuous.
    delay : From a sample to when its forces act [s].
    """

    actuator: Annotated[tuple[str, ...], Example(["250 mm"])]
    sensor: tuple[str, ...] = ()
    design: Design = Design.LQR
    max_force: Annotated[float, Quantity("force", "2 kN")] = math.inf
    speed: Speed | None = None
    displacement_scale: Annotated[float, Quantity("length", "20 um")] = 2e-5
    force_scale: Annotated[float, Quantity("force", "500 N")] | None = None
    noise: Annotated[float, Quantity("length", "1 um")] = 1e-6
    reduction_error: Annotated[float, Number(above=0.0, most=0.5)] = 1e-3
    sample_time: Annotated[float, Quantity("time", "100 us")] | None = None
    delay: Annotated[float, Quantity("time", "50 us", "not_negative")] = 0.0

    def __post_init__(self) -> None:
        if self.delay and self.sample_time is None:
            raise InputError('goes with a sample_time: "100 us", say', key="control.delay")
        if self.sample_time is not None and self.delay > MOST_WAITING * self.sample_time:
            raise InputError(
                f"must be at most {MOST_WAITING} sample times (s)",
                key="control.delay",
                value=self.delay,
            )

    def large_force(self) -> float:
        """Return what counts as a large force for the regulator [N].

        Raises InputError: Neither `force_scale` nor `max_force` says it.
        """
        large = self.max_force if self.force_scale is None else self.force_scale
        if math.isinf(large):
            raise InputError(
                'is missing, and no limit (max_force, --max-force "2 kN") stands for it: which '
                'force is large? "500 N" say', key="control.force_scale",
            )  # fmt: skip
        return large


def distinct_names(entries: Sequence[Any], word: str) -> tuple[str, ...]:
    """Return the names of entries, those without one numbered: ``support 2``.

    Raises InputError: Two have the same name.
    """
    names = tuple(entry.name or f"{word} {i}" for i, entry in enumerate(entries, start=1))
    for i, name in enumerate(names):
        if name in names[:i]:
            raise InputError("another one has the same name", key=f"{word}[{i}].name", value=name)
    return names
