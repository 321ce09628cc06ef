"""Limits of values, written once as annotations of the fields of a dataclass.

``length: Annotated[float, Quantity("length", "80 mm")]`` says that Python code passes a number in
SI, above 0, and that a file holds a text with a unit of length. `check` holds a new object against
its annotations (in ``__post_init__``); `rotorsim.files.scenario.reader` reads a file's tables by
the same ones. The parameters of a function that makes an object may be annotated likewise.
"""

from __future__ import annotations

import dataclasses
import difflib
import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, ClassVar, TypeVar, Union, get_args, get_origin, get_type_hints

from ..arguments import finite_number
from ..errors import InputError
from ..units import QUANTITIES, parse_quantity

_Names = TypeVar("_Names", bound=StrEnum)


@dataclass(frozen=True)
class Number:
    """A plain number between bounds.

    above, least, below, most : Bounds; `least` and `most` are allowed themselves.
    hint : What a message says of the bounds.
    """

    above: float = -math.inf
    least: float = -math.inf
    below: float = math.inf
    most: float = math.inf
    hint: str = ""

    def check(self, value: float) -> None:
        """Refuse a value beyond the bounds."""
        for wrong, said in (
            (value <= self.above, f"above {self.above:g}"),
            (value < self.least, f"{self.least:g} or more"),
            (value >= self.below, f"below {self.below:g}"),
            (value > self.most, f"{self.most:g} or less"),
        ):
            if wrong:
                raise InputError(f"must be {said}" + (f" ({self.hint})" if self.hint else ""))


@dataclass(frozen=True)
class Quantity:
    """A number with a dimension.

    kind : Name in `rotorsim.units.QUANTITIES`.
    example : Valid text for messages; by default the kind's own.
    sign : ``positive``, ``not_negative`` or ``any``.
    """

    kind: str
    example: str | None = None
    sign: str = "positive"

    def read(self, text: object) -> float:
        """Return the SI value of a text with its unit."""
        value = parse_quantity(text, self.kind, example=self.example)
        self._check_sign(value, f', for example "{self.example}"' if self.example else "")
        return value

    def check(self, value: object, key: str) -> float:
        """Return `value` [SI] as a float if it may be one."""
        kind = QUANTITIES[self.kind]
        number = finite_number(value, key, kind.unit)
        self._check_sign(number, f" ({kind.unit})")
        if abs(number) > kind.largest:
            raise InputError(f"is beyond every sensible {kind.name} (in {kind.unit})")
        return number

    def _check_sign(self, value: float, end: str) -> None:
        if (self.sign == "positive" and value <= 0.0) or (
            self.sign == "not_negative" and value < 0.0
        ):
            raise InputError(
                f"must be {'above 0' if self.sign == 'positive' else '0 or more'}{end}"
            )


class Leaf:
    """An entry with a spelling of its own; subclasses read it from a file's value."""

    kind: ClassVar[str | None] = None
    """Kind of quantity of a plain number in SI, if it may be one."""

    def read(self, value: object) -> Any:
        """Return what `value` means.

        Raises InputError: With what is allowed.
        """
        raise NotImplementedError


@dataclass(frozen=True)
class Key:
    """Name of the entry in a file, where it is not that of the field."""

    name: str


@dataclass(frozen=True)
class Example:
    """Valid value for the message that a needed entry is missing."""

    value: object


@dataclass(frozen=True)
class Made:
    """A table that is read as the arguments of a function.

    by : callable or mapping. The function; or one for each ``kind = "..."`` of the table, the first
        by default.
    """

    by: Any

    def maker(self, kind: str | None = None) -> Callable[..., Any]:
        """Return the function for a kind."""
        if not isinstance(self.by, Mapping):
            return self.by
        return self.by[kind or next(iter(self.by))]

    @property
    def makers(self) -> tuple[Callable[..., Any], ...]:
        """Every function."""
        return tuple(self.by.values()) if isinstance(self.by, Mapping) else (self.by,)

    def __hash__(self) -> int:
        return id(self)


SEVERAL = Key("<several>")
"""Marks an entry of which a file may list several values, one calculation for each."""
NEEDED = Key("<needed>")
"""Marks a parameter whose default is not that of a file, which must give it."""
NOT_IN_FILES = Key("<none>")
"""Marks a field that no file sets."""
Length = Annotated[float, Quantity("length", "50 mm")]
Clearance = Annotated[float, Quantity("length", "100 um")]
Displacement = Annotated[float, Quantity("length", "1 um", "any")]
Angle = Annotated[float, Quantity("angle", "90 deg", "any")]
Slope = Annotated[float, Quantity("slope", "0.1 mm/m", "any")]
Temperature = Annotated[float, Quantity("temperature", "40 degC")]
Speed = Annotated[float, Quantity("speed", "3000 rpm")]
Frequency = Annotated[float, Quantity("speed", "50 Hz")]
Mass = Annotated[float, Quantity("mass", "1200 kg")]
Stiffness = Annotated[float, Quantity("stiffness", "10 MN/m")]
Damping = Annotated[float, Quantity("damping", "200 N*s/m", "not_negative")]
Unbalance = Annotated[float, Quantity("unbalance", "500 g*mm", "not_negative")]
Duration = Annotated[float, Quantity("time", "2 s")]
Instant = Annotated[float, Quantity("time", "0.1 s", "not_negative")]
Pair = tuple[Displacement, Displacement]
Share = Annotated[float, Number(least=0.0, most=1.0)]


@dataclass(frozen=True)
class Entry:
    """One parameter of a dataclass or of a function, and the entry of a file that sets it."""

    name: str
    key: str
    hint: Any
    default: Any
    example: object

    @property
    def is_needed(self) -> bool:
        """Return whether there is no default."""
        return self.default is inspect.Parameter.empty


@cache
def entries(maker: Callable[..., Any]) -> dict[str, Entry]:
    """Return what a dataclass or a function is made from, by the key in a file."""
    found = {}
    hints = get_type_hints(maker, include_extras=True)
    for name, parameter in inspect.signature(maker).parameters.items():
        marks = marks_of(hints[name])
        if NOT_IN_FILES in marks:
            continue
        keys = [
            mark.name for mark in marks if isinstance(mark, Key) and not mark.name.startswith("<")
        ]
        examples = [mark.value for mark in marks if isinstance(mark, Example)]
        examples += [mark.example for mark in marks if isinstance(mark, Quantity)]
        entry = Entry(
            name, keys[0] if keys else name, hints[name],
            inspect.Parameter.empty if NEEDED in marks else parameter.default,
            examples[0] if examples else None,
        )  # fmt: skip
        found[entry.key] = entry
    return found


def marks_of(hint: Any) -> tuple[Any, ...]:
    """Return all that `Annotated` adds to a hint, its arguments and theirs."""
    inner = () if get_origin(hint) is None else get_args(hint)[: 1 if _marks(hint) else None]
    return (*_marks(hint), *(mark for part in inner for mark in marks_of(part)))


def _marks(hint: Any) -> tuple[Any, ...]:
    return get_args(hint)[1:] if get_origin(hint) is Annotated else ()


def parts(hint: Any) -> tuple[Any, tuple[Any, ...], tuple[Any, ...]]:
    """Return the bare type of a hint, what `Annotated` adds to it, and the members of a union.

    ``None`` is no member: what may be left out has it as its default.
    """
    marks = _marks(hint)
    bare = get_args(hint)[0] if marks else hint
    if get_origin(bare) in (Union, UnionType):
        members = tuple(member for member in get_args(bare) if member is not NoneType)
        if len(members) == 1:
            inner, more, _ = parts(members[0])
            return inner, (*marks, *more), ()
        return bare, marks, members
    return bare, marks, ()


def check(described: Any, section: str = "") -> None:
    """Hold the fields of a frozen dataclass against their annotations, in ``__post_init__``.

    Numbers become floats, names the members of their enumerations, lists tuples. What equals its
    default is left as it is.

    Raises InputError: With the field, after `section` and a point.
    """
    hints = _hints(type(described))
    for field in dataclasses.fields(described):
        value = getattr(described, field.name)
        if value is field.default or field.name not in hints:
            continue
        key = f"{section}.{field.name}" if section else field.name
        try:
            checked = _checked(hints[field.name], value, key)
        except InputError as error:
            raise InputError(error.message, key=error.key or key, value=_brief(value)) from None
        if checked is not value:
            object.__setattr__(described, field.name, checked)


_hints = cache(lambda made: get_type_hints(made, include_extras=True))


def _brief(value: object) -> object:
    return value if isinstance(value, (bool, int, float, str)) else type(value).__name__


def _checked(hint: Any, value: Any, key: str) -> Any:
    bare, marks, members = parts(hint)
    if members:
        return _member(members, value, key)
    quantity = next((mark for mark in marks if isinstance(mark, Quantity)), None)
    if quantity is not None:
        return quantity.check(value, key)
    if get_origin(bare) is tuple:
        return _checked_tuple(get_args(bare), value, key)
    if bare is float or bare is int:
        number = finite_number(value, key)
        if bare is int and number != int(number):
            raise InputError("must be a whole number")
        for mark in marks:
            if isinstance(mark, Number):
                mark.check(number)
        return bare(number)
    if isinstance(bare, type) and issubclass(bare, StrEnum):
        return choice(bare, value)
    if bare is bool and not isinstance(value, bool):
        raise InputError("must be True or False")
    if isinstance(bare, type) and not isinstance(value, bare):
        raise InputError(f"must be of type {bare.__name__}")
    return value


def _member(members: tuple[Any, ...], value: Any, key: str) -> Any:
    for member in members:
        bare, _, _ = parts(member)
        if isinstance(bare, type) and isinstance(value, bare) and bare is not float:
            return value
    error = None
    for member in members:
        try:
            return _checked(member, value, key)
        except InputError as wrong:
            error = error or wrong
    assert error is not None
    raise error


def _checked_tuple(inner: tuple[Any, ...], value: Any, key: str) -> tuple[Any, ...]:
    if not isinstance(value, (tuple, list)):
        raise InputError("must be a tuple")
    if inner[-1] is Ellipsis:
        inner = (inner[0],) * len(value)
    if len(inner) != len(value):
        raise InputError(f"must hold exactly {len(inner)} entries")
    checked = tuple(_checked(hint, one, key) for hint, one in zip(inner, value, strict=True))
    return value if isinstance(value, tuple) and checked == value else checked


def choice(names: type[_Names], value: object) -> _Names:
    """Return the member of an enumeration that is named."""
    return names(one_of(list(names), value))


def one_of(names: Sequence[str], value: object) -> str:
    """Return `value` if it is one of some names."""
    if isinstance(value, str) and value in names:
        return value
    known = ", ".join(f'"{name}"' for name in names)
    raise InputError(f"must be one of {known}{nearest(value, names)}")


def nearest(word: object, known: Sequence[str]) -> str:
    """Return ``; did you mean "..."?``, or nothing."""
    close = difflib.get_close_matches(str(word)[:60], known, n=1, cutoff=0.5)
    return f'; did you mean "{close[0]}"?' if close else ""
