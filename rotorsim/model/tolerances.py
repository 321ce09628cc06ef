"""Tolerances of a scenario: spreads of clearance, viscosity, load and supply temperature."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

from ..errors import InputError
from ..units import parse_quantity
from .entries import Leaf, Number, check, choice
from .operating import MAX_COUNT

_PERCENT = re.compile(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*%\s*", re.ASCII)
_MAX_PERCENT = 50.0
_DEFAULT_SAMPLES = 256
NORMAL_REACH = 4.0
"""Standard deviations at which a normal distribution is cut off."""


class Distribution(StrEnum):
    """Distribution of values about the nominal one."""

    UNIFORM = "uniform"
    """Between nominal - spread and nominal + spread, all alike."""
    NORMAL = "normal"
    """The spread is the standard deviation; cut off at four of them."""


@dataclass(frozen=True)
class Spread:
    """Tolerance of one input.

    value : SI, or a share of the nominal value.
    relative : Which of the two.
    distribution : None: the section's.
    """

    value: float
    relative: bool
    distribution: Distribution | None = None

    def absolute(self, nominal: float) -> float:
        """Return the spread in the input's own unit."""
        return self.value * abs(nominal) if self.relative else self.value


KINDS: dict[str, tuple[str | None, str]] = {
    "radial_clearance": ("length", "5 um"),
    "viscosity": (None, "10 %"),
    "load": ("force", "500 N"),
    "supply_temperature": ("temperature difference", "3 K"),
}
"""Kind of quantity and an example for every input; None: a share of the nominal value only."""


def parse_spread(
    text: object, name: str, known: Mapping[str, tuple[str | None, str]] = KINDS
) -> Spread:
    """Return the spread of the input `name`: text such as ``"5 um"`` or ``"5 %"``.

    A table ``{ spread = "5 um", distribution = "normal" }`` is read as well. `known` has the
    kind of quantity and an example by the inputs' names.

    Raises InputError: What is allowed.
    """
    if isinstance(text, dict):
        return _from_table(text, name, known)
    kind, example = known[name]
    match = _PERCENT.fullmatch(text) if isinstance(text, str) and len(text) < 40 else None
    if match is not None:
        percent = float(match[1])
        if kind == "temperature difference":
            raise InputError('must be a difference such as "3 K", not a share', value=text)
        if not 0.0 < percent <= _MAX_PERCENT:
            raise InputError(f"must be above 0 and at most {_MAX_PERCENT:g} %", value=text)
        return Spread(percent / 100.0, relative=True)
    if kind is None:
        raise InputError(f'must be a share of the nominal value such as "{example}"', value=text)
    value = parse_quantity(text, kind, example=example)
    if not (math.isfinite(value) and value > 0.0):
        raise InputError(f'must be above 0, for example "{example}"', value=text)
    return Spread(value, relative=False)


def _from_table(
    table: dict[object, object], name: str, known: Mapping[str, tuple[str | None, str]]
) -> Spread:
    unknown = [key for key in table if key not in ("spread", "distribution")]
    if unknown or "spread" not in table or isinstance(table["spread"], dict):
        raise InputError(
            f'must be {{ spread = "{known[name][1]}", distribution = "normal" }}', value=table
        )
    spread = parse_spread(table["spread"], name, known)
    if "distribution" not in table:
        return spread
    try:
        named = choice(Distribution, table["distribution"])
    except InputError as error:
        raise InputError(f"distribution {error.message}") from None
    return Spread(spread.value, spread.relative, Distribution(named))


@dataclass(frozen=True)
class _SpreadEntry(Leaf):
    """A spread, by the rules of the input `name`."""

    name: str

    def read(self, value: object) -> Spread:
        """Return the spread."""
        return parse_spread(value, self.name)


@dataclass(frozen=True)
class ToleranceSettings:
    """The scenario's ``[tolerances]``: one input or more.

    radial_clearance, viscosity, load, supply_temperature : About the nominal values.
    distribution : Of every input that does not say otherwise.
    samples : Sets of inputs that are drawn.
    seed : The same seed draws the same samples.
    """

    radial_clearance: Annotated[Spread | None, _SpreadEntry("radial_clearance")] = None
    viscosity: Annotated[Spread | None, _SpreadEntry("viscosity")] = None
    load: Annotated[Spread | None, _SpreadEntry("load")] = None
    supply_temperature: Annotated[Spread | None, _SpreadEntry("supply_temperature")] = None
    distribution: Distribution = Distribution.UNIFORM
    samples: Annotated[int, Number(least=8, most=MAX_COUNT)] = _DEFAULT_SAMPLES
    seed: Annotated[int, Number(least=0, most=2**31)] = 0

    def __post_init__(self) -> None:
        check(self, "tolerances")
        if not self.spreads:
            raise InputError(
                f"needs one input or more ({', '.join(KINDS)}); write for example "
                'radial_clearance = "5 um"',
                key="tolerances",
            )

    @property
    def spreads(self) -> dict[str, Spread]:
        """Spread of every input that has one."""
        return {name: spread for name in KINDS if (spread := getattr(self, name)) is not None}
