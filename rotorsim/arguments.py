"""Arguments that are easily mistaken for one another, and lists of values."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from .errors import InputError

_MOST_VALUES = 1000
_HOW = {"rad/s": "; from rpm: rpm * 3.14159 / 30", "m": "; from um: um * 1e-6", "kg": ""}


def refuse_path(value: object, key: str = "scenario") -> None:
    """Refuse a file's name, and all but a `Scenario`, where one is needed.

    Raises InputError: `value` is a text, a path, or of another type.
    """
    if isinstance(value, (str, Path)):
        raise InputError(
            "must be a Scenario, not the name of its file: rotorsim.load_scenario(file) reads it",
            key=key,
            value=value,
        )
    if not hasattr(value, "cases"):
        raise InputError("must be a Scenario", key=key, value=type(value).__name__)


def refuse_no_machine(value: object) -> None:
    """Refuse all but a `MachineFile` where one is needed.

    Raises InputError: `value` is of another type.
    """
    if not hasattr(value, "bearings"):
        raise InputError(
            "must be a MachineFile: rotorsim.load_machine(file) reads it",
            key="machine",
            value=value if isinstance(value, str) else type(value).__name__,
        )


def refuse_other(value: object, kind: type | tuple[type, ...], key: str, hint: str) -> None:
    """Refuse what is not of a type; `hint` says what is meant, and where it comes from."""
    if not isinstance(value, kind):
        raise InputError(f"must be {hint}", key=key, value=type(value).__name__)


def file_path(value: object) -> Path:
    """Return the path of a file given by text or path; refuse None, open files and the like.

    Raises InputError: `value` is neither.
    """
    if not isinstance(value, (str, Path)):
        raise InputError("must be the name of a file", key="path", value=type(value).__name__)
    return Path(value)


def finite_number(value: Any, key: str, unit: str = "") -> float:
    """Return a finite number as a float; refuse text with a unit, None, arrays and the like.

    key : Name of the argument, for messages.
    unit : SI unit that is meant, for messages.
    Raises InputError: `value` is no number, or not finite.
    """
    try:
        if isinstance(value, (str, bytes, bool)) or getattr(value, "ndim", 0):
            raise TypeError
        number = float(value)
    except OverflowError:
        number = math.inf
    except (TypeError, ValueError):  # of Pint, xarray and others as well
        of_unit = f" in {unit}" if unit else ""
        raise InputError(
            f"must be a plain number{of_unit}, without quotes{_HOW.get(unit, '')}",
            key=key,
            value=value if isinstance(value, (str, bytes, bool)) else type(value).__name__,
        ) from None
    if not math.isfinite(number):
        raise InputError("must be a finite number", key=key, value=number)
    return number


def above_zero(prefix: str, **values: float) -> None:
    """Refuse values that are not finite and above zero; their keys are `prefix` and name."""
    for name, value in values.items():
        if not (math.isfinite(value) and value > 0.0):
            raise InputError("must be above 0", key=f"{prefix}.{name}", value=value)


def not_negative(prefix: str, **values: float) -> None:
    """Refuse values that are not finite or below zero, as `above_zero`."""
    for name, value in values.items():
        if not (math.isfinite(value) and value >= 0.0):
            raise InputError("must be 0 or more", key=f"{prefix}.{name}", value=value)


def ascending_values(
    given: object, read: Callable[[object], float], key: str, example: str
) -> list[float]:
    """Return ascending values: ``"a, b, c"``, ``"start : stop : count"``, or a list of texts.

    read : From a text to its value.
    """
    if isinstance(given, str):
        parts = [part.strip() for part in given.split(":")]
        if len(parts) == 3:
            first, last, count = parts
            if not (count.isascii() and count.isdigit() and 2 <= int(count) <= _MOST_VALUES):
                message = f"the count must be a whole number from 2 to {_MOST_VALUES}"
                raise InputError(message, key=key, value=given)
            import numpy as np

            values = np.linspace(read(first), read(last), int(count)).tolist()
        elif len(parts) == 1:
            values = [read(part.strip()) for part in given.split(",")]
        else:
            message = f'must be a list "{example}, ..." or "start : stop : count"'
            raise InputError(message, key=key, value=given)
    else:
        values = [read(part) for part in (given if isinstance(given, Sequence) else [given])]
    if len(values) > _MOST_VALUES or any(b <= a for a, b in pairwise(values)):
        raise InputError(f"must ascend, at most {_MOST_VALUES} values", key=key, value=given)
    return values
