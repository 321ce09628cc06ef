"""Design studies of a scenario: which entries vary, between what, how many designs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from ..errors import InputError
from .entries import Leaf, Number, check

MAX_SAMPLES = 1_000_000
_EXAMPLE = '{ "bearing.radial_clearance" = ["80 um", "120 um"], "operating.load" = [...] }'


@dataclass(frozen=True)
class Range:
    """An entry of a scenario that varies.

    name : Its key with its table, ``bearing.radial_clearance``.
    low, high : As files write them.
    logarithmic : Whether its logarithm is spread evenly.
    """

    name: str
    low: Any
    high: Any
    logarithmic: bool = False


class _RangesEntry(Leaf):
    """A table of keys, each with its two ends."""

    def read(self, value: object) -> tuple[Range, ...]:
        """Return the ranges."""
        if not isinstance(value, Mapping) or not value:
            raise InputError(f"must be a table of keys with their two ends: {_EXAMPLE}")
        return tuple(range_ for key, given in value.items() for range_ in _ranges(key, given))


def _ranges(name: str, given: Any) -> list[Range]:
    """Return ranges of one key, or those of a bare table's keys (a dotted key in TOML)."""
    if isinstance(given, Mapping) and "low" not in given and "high" not in given:
        return [r for key, inner in given.items() for r in _ranges(f"{name}.{key}", inner)]
    table = given
    if isinstance(given, list) and len(given) == 2:
        table = {"low": given[0], "high": given[1]}
    spacing = table.get("spacing", "linear") if isinstance(table, Mapping) else None
    if spacing not in ("linear", "logarithmic") or set(table) - {"spacing"} != {"low", "high"}:
        raise InputError(
            f"{name} must have two ends, [low, high] or {{ low = ..., high = ..., "
            'spacing = "linear" | "logarithmic" }'
        )
    return [Range(name, table["low"], table["high"], spacing == "logarithmic")]


@dataclass(frozen=True)
class StudySettings:
    """The scenario's ``[study]``.

    vary : One entry or more.
    samples : Designs drawn, a scrambled Sobol' sequence over all ranges.
    seed : The same seed draws the same designs; more samples go on with the sequence.
    """

    vary: Annotated[tuple[Range, ...], _RangesEntry()]
    samples: Annotated[int, Number(least=1, most=MAX_SAMPLES)] = 256
    seed: Annotated[int, Number(least=0, most=2**31)] = 0

    def __post_init__(self) -> None:
        check(self, "study")
