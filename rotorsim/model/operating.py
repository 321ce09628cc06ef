"""Operating conditions: speeds, and what fixes the journal's position."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

import numpy as np

from ..errors import InputError
from .entries import Angle, Example, Mass, Number, Quantity, Speed, check

MAX_COUNT = 100_000
_Eccentricity = Annotated[float, Number(least=0.0, hint="it lies between 0 and 1, for example 0.5")]
_Load = Annotated[float, Quantity("force", "10 kN", "not_negative")]
_Count = Annotated[int, Number(least=1, most=MAX_COUNT)]


@dataclass(frozen=True)
class EccentricityTarget:
    """The journal at a given eccentricity ratio; the load it carries is a result.

    Below 1 in a bore; between tilting pads it may be more. 0: the journal is centred.
    """

    eccentricity_ratio: Annotated[float, Number(least=0.0)]

    def __post_init__(self) -> None:
        check(self, "operating")


@dataclass(frozen=True)
class LoadTarget:
    """A given static load [N] along x; the position is searched. 0: no load, a vertical shaft."""

    load: _Load

    def __post_init__(self) -> None:
        check(self, "operating")


Target = EccentricityTarget | LoadTarget


def is_unloaded(target: Target) -> bool:
    """Return whether there is no static load, or no eccentricity to carry one."""
    given = target.load if isinstance(target, LoadTarget) else target.eccentricity_ratio
    return given == 0.0


@dataclass(frozen=True)
class _Range:
    """Values of equal distance, both ends included."""

    start: float
    stop: float
    count: int

    def __post_init__(self) -> None:
        check(self)
        if self.count == 1 and self.start != self.stop:
            raise InputError(
                "one value cannot span from start to stop; write count = 2 or more, or a single "
                "value",
                key="count",
            )
        if self.count > 1 and self.stop <= self.start:
            raise InputError("must be above start", key="stop")

    @property
    def values(self) -> tuple[float, ...]:
        """Ascending."""
        return tuple(np.linspace(self.start, self.stop, self.count).tolist())


@dataclass(frozen=True)
class SpeedRange(_Range):
    """Speeds [rad/s] of equal distance."""

    start: Annotated[Speed, Example("500 rpm")]
    stop: Annotated[Speed, Example("15000 rpm")]
    count: Annotated[_Count, Example(30)]


@dataclass(frozen=True)
class MassRange(_Range):
    """Masses [kg] of equal distance."""

    start: Annotated[Mass, Example("100 kg")]
    stop: Annotated[Mass, Example("3000 kg")]
    count: Annotated[_Count, Example(100)]


def ascending(given: tuple[float, ...] | _Range, key: str) -> tuple[float, ...]:
    """Return the values of a range or a list, which must ascend."""
    if isinstance(given, _Range):
        return given.values
    for index, (before, after) in enumerate(pairwise(given), start=1):
        if after <= before:
            raise InputError(
                "the list must ascend, each entry above the one before it; sort it and "
                "remove repetitions",
                key=f"{key}[{index}]",
            )
    return given


@dataclass(frozen=True)
class Operating:
    """Speeds and load of a scenario.

    speed : tuple of float or SpeedRange. Ascending [rad/s]; a range becomes its values.
    eccentricity_ratio, load : One of them; the load in N. 0: no static load, or the journal in the
        centre.
    load_direction : Angle of the load in the frame in which the bearing is given [rad].
    """

    speed: tuple[Speed, ...] | SpeedRange
    eccentricity_ratio: _Eccentricity | None = None
    load: _Load | None = None
    load_direction: Angle = 0.0

    def __post_init__(self) -> None:
        check(self, "operating")
        object.__setattr__(self, "speed", ascending(self.speed, "operating.speed"))
        if self.eccentricity_ratio is not None and self.load is not None:
            raise InputError(
                "either eccentricity_ratio or load fixes the journal, not both; remove one",
                key="operating.load",
            )
        if self.eccentricity_ratio is None and self.load is None:
            raise InputError(
                'needs eccentricity_ratio or load; write for example load = "10 kN"',
                key="operating",
            )

    @property
    def speeds(self) -> tuple[float, ...]:
        """Ascending [rad/s]."""
        return ascending(self.speed, "operating.speed")

    @property
    def target(self) -> Target:
        """Eccentricity ratio or load that fixes the journal."""
        if self.load is not None:
            return LoadTarget(self.load)
        assert self.eccentricity_ratio is not None
        return EccentricityTarget(self.eccentricity_ratio)


@dataclass(frozen=True)
class StabilitySettings:
    """The stability map's own axis.

    mass : tuple of float or MassRange. Rotor masses per bearing, ascending [kg].
    """

    mass: Annotated[tuple[Mass, ...] | MassRange, Example("1200 kg")]

    def __post_init__(self) -> None:
        check(self, "stability")
        object.__setattr__(self, "mass", ascending(self.mass, "stability.mass"))

    @property
    def masses(self) -> tuple[float, ...]:
        """Ascending [kg]."""
        return ascending(self.mass, "stability.mass")
