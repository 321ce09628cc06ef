"""From a file's tables to the objects that they describe, by the objects' own annotations.

`rotorsim.model.entries` says what an annotation means. All that is wrong in a file is collected and
told at once, each with its key, its value and what is allowed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import is_dataclass
from enum import StrEnum
from functools import cache
from typing import Annotated, Any, NamedTuple, get_args, get_origin

from ...errors import InputError, ScenarioError
from ...model.entries import (
    SEVERAL,
    Entry,
    Leaf,
    Made,
    Number,
    Quantity,
    choice,
    entries,
    nearest,
    one_of,
    parts,
)

_Path = tuple[str | int, ...]
_MAX_ENTRIES = 10_000
"""Entries of the longest list that is read."""
_MAX_OTHERS = 10
_MAX_VALUE = 120
_FAILED: Any = object()
_PLAIN = {
    bool: "must be true or false, without quotes",
    float: "must be a plain number, without quotes or unit",
    int: "must be a whole number, without quotes",
    str: "must be text in quotes",
}
_HALF = "half of the diametral one"
_CLEARANCE = f"write radial_clearance, {_HALF}"
_RADIUS = "write journal_radius, half of the diameter"
_LENGTH = "write length, the bearing's own, with its unit"
_OIL = "the oil's table is [lubricant]"
_COUNT = "write count, the number of values, in place of a step"
_SAID_OTHERWISE = {
    "bearing": {
        **dict.fromkeys(("journal_diameter", "shaft_diameter", "diameter", "bore"), _RADIUS),
        **dict.fromkeys(
            ("diametral_clearance", "diametrical_clearance", "diameter_clearance"), _CLEARANCE
        ),
        "clearance": f"write radial_clearance ({_HALF})",
        **dict.fromkeys(
            ("recess", "recesses"), "write [[bearing.groove]] with a restrictor = { kind = ... }"
        ),
        **dict.fromkeys(("length_to_diameter", "length_diameter_ratio", "width"), _LENGTH),
    },
    "": dict.fromkeys(("oil", "lubrication", "lube", "fluid"), _OIL),
    "operating": {"step": "write speed = { start, stop, count }"},
    "operating.speed": {"step": _COUNT},
    "stability.mass": {"step": _COUNT},
}
"""Names that users give entries, by table, and those of the format."""


class _Finding(NamedTuple):
    """One thing wrong."""

    key: str
    message: str
    value: object
    rank: int


class Reader:
    """Reads the tables of one file.

    tables : The file's entries.
    root : What the whole file describes.
    source : Name of the file, for messages.
    """

    def __init__(self, tables: dict[str, Any], root: Callable[..., Any], source: str) -> None:
        self.tables = tables
        self.root = root
        self.source = source
        self.lists: dict[str, tuple[Any, ...]] = {}
        """Values of the entries of which a file may list several, by key."""
        self._found: list[_Finding] = []

    def arguments(self) -> dict[str, Any]:
        """Return the arguments of `root`.

        Raises ScenarioError: With all that is wrong, the likeliest cause first.
        """
        found = self._arguments(self.root, self.tables, ())
        if self._found:
            # A misspelt key also leaves the right one missing: name the misspelling first.
            first, *rest = sorted(self._found, key=lambda finding: finding.rank)
            others = [str(InputError(f.message, key=f.key, value=f.value)) for f in rest]
            if len(others) > _MAX_OTHERS:
                others[_MAX_OTHERS:] = [f"and {len(others) - _MAX_OTHERS} more"]
            raise ScenarioError(
                first.message, source=self.source, key=first.key, value=first.value,
                others=tuple(others),
            )  # fmt: skip
        return found

    def error(self, error: InputError) -> ScenarioError:
        """Return an error about entries that were read, with file and value."""
        path, value = _as_written(_location(error.key or ""), self.tables)
        return ScenarioError(
            error.message, source=self.source, key=_dotted(path), value=_shown(value)
        )

    def _fail(self, path: _Path, message: str, value: object = None, rank: int = 1) -> Any:
        self._found.append(_Finding(_dotted(path), message, _shown(value), rank))
        return _FAILED

    def _arguments(self, maker: Callable[..., Any], table: dict[str, Any], path: _Path) -> Any:
        known, read = entries(maker), {}
        for key, value in table.items():
            entry = known.get(key)
            if entry is None:
                self._fail((*path, key), self._unknown(key, path), value, rank=0)
            else:
                read[entry.name] = self._value(entry.hint, value, (*path, key))
        for key, entry in known.items():
            if entry.is_needed and key not in table:
                read[entry.name] = self._fail((*path, key), _missing(entry, path), rank=2)
        return read

    def _table(self, maker: Callable[..., Any], table: Any, path: _Path) -> Any:
        if not isinstance(table, dict):
            name = ".".join(_names(path))
            message = f"must be a table: [{name}] with one line for each of its keys"
            return self._fail(path, message, table)
        count = len(self._found)
        read = self._arguments(maker, table, path)
        if len(self._found) > count:
            return _FAILED
        try:
            return maker(**read)
        except InputError as error:
            where, value = _as_written(_within(path, error.key), self.tables)
            return self._fail(where, error.message, value)

    def _kind(self, made: Made, table: Any, path: _Path) -> Any:
        """Read a table that says its kind."""
        if not (isinstance(table, dict) and isinstance(made.by, dict)):
            return self._table(made.maker(), table, path)
        kinds = list(made.by)
        try:
            kind = one_of(kinds, table.get("kind", kinds[0]))
        except InputError as error:
            return self._fail((*path, "kind"), error.message, table["kind"])
        known = entries(made.maker(kind))
        rest = {key: value for key, value in table.items() if key != "kind"}
        needed = [key for key, entry in known.items() if entry.is_needed]
        alien = [key for key in rest if key not in known and key in _keys(made)]
        complete = all(key in rest for key in needed)
        for key in alien:
            value = rest.pop(key)
            if complete:
                message = f'does not go with kind = "{kind}" (its keys: {", ".join(needed)})'
                self._fail((*path, key), message, value)
        return self._table(made.maker(kind), rest, path)

    def _value(self, hint: Any, value: Any, path: _Path) -> Any:
        bare, marks, members = parts(hint)
        for mark in marks:
            if isinstance(mark, Made):
                return self._kind(mark, value, path)
            if isinstance(mark, (Leaf, Quantity)):
                if SEVERAL in marks:
                    return self._several(hint, value, path)
                return self._try(mark.read, value, path)
        if SEVERAL in marks:
            return self._several(hint, value, path)
        if members:
            return self._value(_member(members, value), value, path)
        if get_origin(bare) is tuple:
            return self._tuple(get_args(bare), value, path)
        if isinstance(bare, type) and issubclass(bare, StrEnum):
            return self._try(lambda text: choice(bare, text), value, path)
        if isinstance(bare, type) and is_dataclass(bare):
            return self._table(bare, value, path)
        numbers = [mark for mark in marks if isinstance(mark, Number)]
        return self._plain(bare, value, path, numbers)

    def _try(self, read: Callable[[Any], Any], value: Any, path: _Path) -> Any:
        try:
            return read(value)
        except InputError as error:
            return self._fail(path, error.message, value)

    def _plain(self, kind: Any, value: Any, path: _Path, numbers: list[Number]) -> Any:
        allowed = (int, float) if kind is float else (kind,)
        if not isinstance(value, allowed) or (isinstance(value, bool) and kind is not bool):
            return self._fail(path, _PLAIN[kind] + _hints(numbers), value)
        if kind is float:
            try:
                value = float(value)
            except OverflowError:
                value = math.inf
            if not math.isfinite(value):
                return self._fail(path, "must be a finite number" + _hints(numbers), value)
        for number in numbers:
            if self._try(lambda one, number=number: number.check(one), value, path) is _FAILED:
                return _FAILED
        return value

    def _listed(self, value: Any, path: _Path) -> Any:
        listed = value if isinstance(value, list) else [value]
        if not listed:
            return self._fail(path, "must hold at least one entry, the list is empty", value)
        if len(listed) > _MAX_ENTRIES:
            message = f"must hold at most {_MAX_ENTRIES} entries, it has {len(listed)}"
            return self._fail(path, message)
        return listed

    def _several(self, hint: Any, value: Any, path: _Path) -> Any:
        bare, marks, _ = parts(hint)
        one = bare
        for mark in marks:
            one = one if mark is SEVERAL else Annotated[one, mark]
        listed = self._listed(value, path)
        if listed is _FAILED:
            return _FAILED
        read = [self._value(one, entry, _place(path, i, value)) for i, entry in enumerate(listed)]
        self.lists[_dotted(path)] = tuple(read)
        return _FAILED if any(entry is _FAILED for entry in read) else read[0]

    def _tuple(self, inner: tuple[Any, ...], value: Any, path: _Path) -> Any:
        if inner[-1] is Ellipsis:
            listed = self._listed(value, path)
            inner = (inner[0],) * len(listed) if listed is not _FAILED else ()
        elif not isinstance(value, list):
            return self._fail(path, "must be a list in brackets", value)
        else:
            listed = value
            if len(listed) != len(inner):
                return self._fail(path, f"must hold exactly {len(inner)} entries", value)
        if listed is _FAILED:
            return _FAILED
        read = tuple(
            self._value(hint, entry, _place(path, index, value))
            for index, (hint, entry) in enumerate(zip(inner, listed, strict=True))
        )
        return _FAILED if any(entry is _FAILED for entry in read) else read

    def _unknown(self, key: str, path: _Path) -> str:
        names = _names(path)
        tables = tables_of(self.root)
        known = tables.get(names, ())
        where = f"[{'.'.join(names)}]" if names else "the file's top level"
        said = _SAID_OTHERWISE.get(".".join(names), {}).get(key)
        if said is not None:
            return f"is not a key of {where}; {said} (known: {', '.join(known)})"
        elsewhere = sorted((t for t, keys in tables.items() if t and key in keys), key=len)
        advice = (
            f"; it belongs into [{'.'.join(elsewhere[0])}]" if elsewhere else nearest(key, known)
        )
        return f"is not a key of {where}{advice} (known: {', '.join(known)})"


def _member(members: tuple[Any, ...], value: Any) -> Any:
    """Return the member of a union that a value is meant as: a table is a dataclass."""
    tables = [member for member in members if is_dataclass(parts(member)[0])]
    others = [member for member in members if member not in tables]
    return (tables if isinstance(value, dict) and tables else others)[0]


def _place(path: _Path, index: int, value: Any) -> _Path:
    """Return the path of an entry of a list; one value may stand for a list of one."""
    return (*path, index) if isinstance(value, list) else path


def _hints(numbers: list[Number]) -> str:
    return "".join(f" ({number.hint})" for number in numbers if number.hint)


def _missing(entry: Entry, path: _Path) -> str:
    if entry.example is None:
        return f"is missing; the file needs a table [{'.'.join((*_names(path), entry.key))}]"
    example = entry.example
    if isinstance(example, list) and isinstance(example[0], dict):
        inside = ", ".join(f'{key} = "{text}"' for key, text in example[0].items())
        name = ".".join((*_names(path), entry.key))
        return f"is missing; write for example [[{name}]] with {inside}"
    value = f'"{example}"' if isinstance(example, str) else str(example)
    return f"is missing; write for example {entry.key} = {value}"


def _keys(made: Made) -> list[str]:
    return list(dict.fromkeys(key for maker in made.makers for key in entries(maker)))


@cache
def makers_of(root: Callable[..., Any]) -> dict[tuple[str, ...], tuple[Callable[..., Any], ...]]:
    """Return every table that a file may hold, with what can be made of it."""
    found: dict[tuple[str, ...], tuple[Callable[..., Any], ...]] = {}

    def visit(path: tuple[str, ...], made: Made) -> None:
        found[path] = (*found.get(path, ()), *made.makers)
        for maker in made.makers:
            for key, entry in entries(maker).items():
                for inner in _made_in(entry.hint):
                    visit((*path, key), inner)

    visit((), Made(root))
    return found


def _made_in(hint: Any) -> Iterator[Made]:
    """Return tables that may stand for a value."""
    bare, marks, members = parts(hint)
    made = [mark for mark in marks if isinstance(mark, Made)]
    if made or any(isinstance(mark, Leaf) for mark in marks):
        yield from made
    elif is_dataclass(bare):
        yield Made(bare)
    else:
        for inner in members or get_args(bare):
            if inner is not Ellipsis:
                yield from _made_in(inner)


@cache
def tables_of(root: Callable[..., Any]) -> dict[tuple[str, ...], tuple[str, ...]]:
    """Return every table that a file may hold, with its keys."""
    tables = {}
    for path, makers in makers_of(root).items():
        keys = [key for maker in makers for key in entries(maker)]
        tables[path] = tuple(dict.fromkeys(["kind", *keys] if len(makers) > 1 else keys))
    return tables


def _as_written(path: _Path, tables: Any) -> tuple[_Path, Any]:
    """Return the path as the file has it, and what stands there (None: nothing).

    One value may be written where a list can stand: its index is then dropped from the path.
    """
    kept: list[str | int] = []
    for part in path:
        if isinstance(part, int) and not isinstance(tables, list):
            continue
        kept.append(part)
        tables = _under(tables, part)
    return tuple(kept), tables


def _under(tables: Any, part: str | int) -> Any:
    try:
        return tables[part]
    except (LookupError, TypeError):
        return None


def _dotted(path: _Path) -> str:
    """Return ``bearing.groove[1].center``."""
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else (f".{part}" if text else str(part))
    return text[:_MAX_VALUE]


def _location(key: str) -> _Path:
    """Return parts of a dotted key, the inverse of `_dotted`."""
    divided = key.replace("]", "").replace("[", ".").split(".")
    return tuple(int(part) if part.isdigit() else part for part in divided if part)


def _within(path: _Path, key: str | None) -> _Path:
    """Return the path of what an object, made of the table at `path`, complains of.

    It names a field of its own, or one from the top, such as ``bearing.groove[1].length``.
    """
    inner, names = _location(key or ""), _names(path)
    own = [part for part in inner if isinstance(part, str)]
    for count in range(len(names), 0, -1):
        if tuple(own[:count]) == names[-count:]:
            return (*path, *inner[count:])
    return (*path, *inner)


def _shown(value: object) -> object:
    """Return the value, or a shortened text of one too large for a message."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):
        return "a value too large to show"
    return value if len(text) <= _MAX_VALUE else f"{text[:_MAX_VALUE]}..."


def _names(path: _Path) -> tuple[str, ...]:
    return tuple(part for part in path if isinstance(part, str))
