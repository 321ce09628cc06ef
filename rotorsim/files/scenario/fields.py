"""Field types of the scenario's tables: quantities with units, choices, one-or-more lists."""

from __future__ import annotations

import difflib
from enum import StrEnum
from typing import NamedTuple

from pydantic import BeforeValidator, PlainValidator

from ...errors import InputError
from ...units import parse_quantity

MAX_ENTRIES = 10_000
"""Entries of the longest list that is read."""
AS_TABLE, AS_LIST = "<table>", "<list>"
"""Tags of the two ways to write a range; they never show in messages."""


def _signed(text: object, kind: str, example: str | None, sign: str) -> float:
    value = parse_quantity(text, kind, example=example)
    if (sign == "positive" and value <= 0.0) or (sign == "not_negative" and value < 0.0):
        bound = "above 0" if sign == "positive" else "0 or more"
        shown = f', for example "{example}"' if example else ""
        raise InputError(f"must be {bound}{shown}", value=text)
    return value


def quantity(kind: str, example: str | None = None, sign: str = "positive") -> PlainValidator:
    """Text with a unit, read as an SI float; `sign` is positive, not_negative or any."""
    return PlainValidator(lambda text: _signed(text, kind, example, sign))


class Viscosity(NamedTuple):
    """A viscosity as it was written: dynamic [Pa s], or kinematic [m2/s]."""

    value: float
    is_kinematic: bool

    def dynamic(self, density: float) -> float:
        """Dynamic viscosity [Pa s] of an oil of that density [kg/m3]."""
        return self.value * density if self.is_kinematic else self.value


def _viscosity(text: object) -> Viscosity:
    try:
        return Viscosity(_signed(text, "kinematic viscosity", "32 cSt", "positive"), True)
    except InputError:
        return Viscosity(_signed(text, "dynamic viscosity", "0.0277 Pa*s", "positive"), False)


dynamic_or_kinematic: PlainValidator = PlainValidator(_viscosity)
"""Text with a unit of dynamic or kinematic viscosity."""


def nearest(word: object, known: list[str]) -> str:
    """``; did you mean "..."?``, or nothing."""
    close = difflib.get_close_matches(str(word)[:60], known, n=1, cutoff=0.5)
    return f'; did you mean "{close[0]}"?' if close else ""


def choice(enum: type[StrEnum]) -> PlainValidator:
    """One of an enumeration's texts."""
    known = [member.value for member in enum]
    allowed = ", ".join(f'"{name}"' for name in known)

    def read(text: object) -> StrEnum:
        if isinstance(text, str) and text in known:
            return enum(text)
        raise InputError(f"must be one of {allowed}{nearest(text, known)}", value=text)

    return PlainValidator(read)


def choice_or_temperature(enum: type[StrEnum], names: list[str]) -> PlainValidator:
    """One of some texts of an enumeration, or a temperature with its unit."""
    allowed = ", ".join(f'"{name}"' for name in names)

    def read(text: object) -> StrEnum | float:
        if isinstance(text, str) and text in names:
            return enum(text)
        try:
            return parse_quantity(text, "temperature")
        except InputError as error:
            if isinstance(text, str) and any(sign.isdigit() for sign in text):
                raise  # meant as a temperature
            raise InputError(
                f'must be one of {allowed}, or a temperature such as "60 degC"'
                f"{nearest(text, names)}",
                value=text,
            ) from error

    return PlainValidator(read)


def _listed(value: object) -> object:
    entries = value if isinstance(value, list) else [value]
    if not entries:
        raise InputError("must hold at least one entry, the list is empty", value=value)
    if len(entries) > MAX_ENTRIES:
        raise InputError(f"must hold at most {MAX_ENTRIES} entries, it has {len(entries)}")
    return entries


one_or_more: BeforeValidator = BeforeValidator(_listed)
"""One value, or a list of at least one."""
range_or_list: BeforeValidator = BeforeValidator(
    lambda value: value if isinstance(value, dict) else _listed(value)
)
"""A table ``{ start, stop, count }``, or one value, or a list."""


def written_as(value: object) -> str:
    """Tell which of the two ways to write a range was taken."""
    return AS_TABLE if isinstance(value, dict) else AS_LIST


def _as_tuple(value: object) -> object:
    return tuple(value) if isinstance(value, list) else value


as_tuple: BeforeValidator = BeforeValidator(_as_tuple)
"""TOML's arrays become tuples of a fixed length."""
