"""Tolerances of a scenario: spreads of clearance, viscosity, load and supply temperature."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from pydantic import PlainValidator

from ...errors import InputError
from ...units import parse_quantity
from .fields import nearest

_PERCENT = re.compile(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*%\s*", re.ASCII)
_MAX_PERCENT = 50.0
DEFAULT_SAMPLES = 256
NORMAL_REACH = 4.0
"""Standard deviations at which a normal distribution is cut off."""


class Distribution(StrEnum):
    """How values spread about the nominal one."""

    UNIFORM = "uniform"
    """Between nominal - spread and nominal + spread, all alike."""
    NORMAL = "normal"
    """The spread is the standard deviation; cut off at four of them."""


@dataclass(frozen=True)
class Spread:
    """Tolerance of one input.

    Parameters
    ----------
    value : float
        SI, or a share of the nominal value.
    relative : bool
        Which of the two.
    distribution : Distribution or None
        None: the section's.
    """

    value: float
    relative: bool
    distribution: Distribution | None = None

    def absolute(self, nominal: float) -> float:
        """Spread in the input's own unit."""
        return self.value * abs(nominal) if self.relative else self.value


@dataclass(frozen=True)
class ToleranceSettings:
    """The scenario's ``[tolerances]``.

    Parameters
    ----------
    spreads : mapping of str to Spread
        By input: ``radial_clearance``, ``viscosity``, ``load``, ``supply_temperature``.
    distribution : Distribution
        Of every input that does not say otherwise.
    samples : int
        Sets of inputs that are drawn.
    seed : int
        The same seed draws the same samples.
    """

    spreads: Mapping[str, Spread]
    distribution: Distribution = Distribution.UNIFORM
    samples: int = DEFAULT_SAMPLES
    seed: int = 0


KINDS: dict[str, tuple[str | None, str]] = {
    "radial_clearance": ("length", "5 um"),
    "viscosity": (None, "10 %"),
    "load": ("force", "500 N"),
    "supply_temperature": ("temperature difference", "3 K"),
}
"""Kind of quantity and an example for every input; None: a share of the nominal value only."""


def parse_spread(text: object, name: str) -> Spread:
    """Spread of the input `name`: text such as ``"5 um"`` or ``"5 %"``.

    A table ``{ spread = "5 um", distribution = "normal" }`` is read as well.

    Raises
    ------
    InputError
        What is allowed.
    """
    if isinstance(text, dict):
        return _from_table(text, name)
    kind, example = KINDS[name]
    match = _PERCENT.fullmatch(text) if isinstance(text, str) and len(text) < 40 else None
    if match is not None:
        percent = float(match[1])
        if name == "supply_temperature":
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


def _from_table(table: dict[object, object], name: str) -> Spread:
    unknown = [key for key in table if key not in ("spread", "distribution")]
    if unknown or "spread" not in table or isinstance(table["spread"], dict):
        raise InputError(
            f'must be {{ spread = "{KINDS[name][1]}", distribution = "normal" }}', value=table
        )
    spread = parse_spread(table["spread"], name)
    if "distribution" not in table:
        return spread
    given = table["distribution"]
    known = [member.value for member in Distribution]
    if given not in known:
        raise InputError(
            f"distribution must be one of {', '.join(known)}{nearest(given, known)}", value=given
        )
    return Spread(spread.value, spread.relative, Distribution(str(given)))


def spread_of(name: str) -> PlainValidator:
    """Field of the table ``[tolerances]``."""
    return PlainValidator(lambda text: parse_spread(text, name))
