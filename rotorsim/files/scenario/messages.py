"""What pydantic found wrong, told in the scenario's own terms."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any, NamedTuple, get_args

from pydantic import BaseModel, ValidationError

from ...errors import InputError, ScenarioError
from .fields import AS_LIST, AS_TABLE, nearest
from .schema import ScenarioTables

MAX_OTHERS = 10
MAX_VALUE = 120
_WHERE_OUTERMOST = "the file's top level"
_BY_TYPE = {
    "bool_type": "must be true or false, without quotes",
    "float_type": "must be a plain number, without quotes or unit",
    "int_type": "must be a whole number, without quotes",
    "int_from_float": "must be a whole number",
    "finite_number": "must be a finite number",
    "string_type": "must be text in quotes",
    "list_type": "must be a list in brackets",
    "tuple_type": 'must be a pair such as ["40 degC", "0.0277 Pa*s"]',
    "too_short": "must hold exactly {min_length} entries",
    "too_long": "must hold exactly {max_length} entries",
    "greater_than": "must be above {gt:g}",
    "greater_than_equal": "must be {ge:g} or more",
    "less_than": "must be below {lt:g}",
    "less_than_equal": "must be {le:g} or less",
    "string_too_long": "must be at most {max_length} characters",
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
        **dict.fromkeys(("length_to_diameter", "length_diameter_ratio", "width"), _LENGTH),
    },
    "": dict.fromkeys(("oil", "lubrication", "lube", "fluid"), _OIL),
    "operating": {"step": "write speed = { start, stop, count }"},
    "operating.speed": {"step": _COUNT},
    "stability.mass": {"step": _COUNT},
}
"""What users call entries, by table, and what the format calls them."""


class Finding(NamedTuple):
    """One thing wrong."""

    key: str
    message: str
    value: object
    rank: int


def scenario_error(error: ValidationError, raw: dict[str, Any], source: str) -> ScenarioError:
    """One readable error of all that pydantic found, the likeliest cause first."""
    found = [_finding(entry, raw) for entry in error.errors(include_url=False)]
    # A misspelt key also leaves the right one missing: name the misspelling first.
    first, *rest = sorted(found, key=lambda finding: finding.rank)
    others = [str(InputError(f.message, key=f.key, value=f.value)) for f in rest[:MAX_OTHERS]]
    if len(rest) > MAX_OTHERS:
        others.append(f"and {len(rest) - MAX_OTHERS} more")
    return ScenarioError(
        first.message, source=source, key=first.key, value=first.value, others=tuple(others)
    )


def _finding(entry: Any, raw: dict[str, Any]) -> Finding:
    path, value = as_written(entry["loc"], raw)
    kind = entry["type"]
    context = entry.get("ctx") or {}
    key = dotted(path)
    if kind == "extra_forbidden":
        return Finding(key, _unknown_key(path), shown(value), 0)
    if kind == "missing":
        return Finding(key, _missing_key(path), None, 2)
    if kind == "value_error" and isinstance(context.get("error"), InputError):
        return Finding(key, context["error"].message, shown(value), 1)
    if kind in ("model_type", "model_attributes_type"):
        name = ".".join(_names(path))
        message = f"must be a table: [{name}] with one line for each of its keys"
    elif kind in _BY_TYPE:
        message = _BY_TYPE[kind].format(**context)
    else:
        message = str(entry["msg"]).replace("Input should be", "must be")
    return Finding(key, message + _range_hint(path, kind), shown(value), 1)


def _range_hint(path: tuple[str | int, ...], kind: str) -> str:
    """Tell the allowed range whole when one bound is passed."""
    ranges = {
        "eccentricity_ratio": "it lies between 0 and 1, for example 0.5",
        "preload": "it lies from 0 to below 1, for example 0.5",
        "offset": "it lies from 0 to 1, for example 0.5",
        "iso_vg": "for example 32",
        "viscosity_index": "it lies from 0 to 100; give viscosity_points for other oils",
    }
    known = ranges.get(str(path[-1])) if path else None
    return f" ({known})" if known and kind != "extra_forbidden" else ""


def as_written(
    location: tuple[str | int, ...], entries: dict[str, Any]
) -> tuple[tuple[str | int, ...], object]:
    """Path as the file has it, and what stands there (None: nothing).

    One value may be written where a list can stand: its index is then dropped from the path.
    """
    path: list[str | int] = []
    here: Any = entries
    for part in location:
        if part in (AS_TABLE, AS_LIST) or (isinstance(part, int) and not isinstance(here, list)):
            continue
        path.append(part)
        here = _under(here, part)
    return tuple(path), here


def _under(entries: Any, part: str | int) -> Any:
    try:
        return entries[part]
    except (LookupError, TypeError):
        return None


def dotted(path: tuple[str | int, ...]) -> str:
    """``bearing.groove[1].center``."""
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else (f".{part}" if text else str(part))
    return text[:MAX_VALUE]


def location(key: str) -> tuple[str | int, ...]:
    """Parts of a dotted key, the inverse of `dotted`."""
    parts = key.replace("]", "").replace("[", ".").split(".")
    return tuple(int(part) if part.isdigit() else part for part in parts if part)


def shown(value: object) -> object:
    """Return the value, or a shortened text of one too large for a message."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):
        return "a value too large to show"
    return value if len(text) <= MAX_VALUE else f"{text[:MAX_VALUE]}..."


def _names(path: tuple[str | int, ...]) -> tuple[str, ...]:
    return tuple(part for part in path if isinstance(part, str))


@cache
def _tables() -> dict[tuple[str, ...], list[type[BaseModel]]]:
    """Every table of the format by its path, with the ways to write it."""
    tables: dict[tuple[str, ...], list[type[BaseModel]]] = {}

    def models_in(annotation: Any) -> Iterator[type[BaseModel]]:
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            yield annotation
        for part in get_args(annotation):
            yield from models_in(part)

    def visit(path: tuple[str, ...], model: type[BaseModel]) -> None:
        tables.setdefault(path, []).append(model)
        for name, field in model.model_fields.items():
            for inner in models_in(field.annotation):
                visit((*path, name), inner)

    visit((), ScenarioTables)
    return tables


def _keys_at(path: tuple[str, ...]) -> list[str]:
    return [name for model in _tables().get(path, []) for name in model.model_fields]


def _unknown_key(path: tuple[str | int, ...]) -> str:
    *parents, last = _names(path)
    known = _keys_at(tuple(parents))
    where = f"[{'.'.join(parents)}]" if parents else _WHERE_OUTERMOST
    said = _SAID_OTHERWISE.get(".".join(parents), {}).get(last)
    if said is not None:
        return f"is not a key of {where}; {said} (known: {', '.join(known)})"
    elsewhere = [table for table in _tables() if table and last in _keys_at(table)]
    advice = f"; it belongs into [{'.'.join(elsewhere[0])}]" if elsewhere else nearest(last, known)
    return f"is not a key of {where}{advice} (known: {', '.join(known)})"


def _missing_key(path: tuple[str | int, ...]) -> str:
    *parents, last = _names(path)
    for model in _tables().get(tuple(parents), []):
        field = model.model_fields.get(last)
        if field is not None and field.examples:
            example = field.examples[0]
            value = f'"{example}"' if isinstance(example, str) else str(example)
            return f"is missing; write for example {last} = {value}"
    return f"is missing; the file needs a table [{'.'.join(_names(path))}]"
