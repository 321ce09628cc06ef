"""The unit edge: text with a unit becomes an SI number here, and nowhere else.

Pint knows the units; this module decides what text it is shown. A value is one decimal number
followed by a short product of unit names with small whole powers, so that no input can evaluate
anything or take long.
"""

from __future__ import annotations

import math
import re
import tokenize
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import TYPE_CHECKING

from .errors import InputError
from .unit_spellings import as_force, readings

if TYPE_CHECKING:
    import pint

_MAX_TEXT = 100
"""Characters in the longest text that is looked at."""


@dataclass(frozen=True)
class _Kind:
    """A kind of physical quantity.

    name : As a message calls it, for example ``length``.
    unit : SI unit in which values leave this module.
    example : A valid text.
    smallest, largest : Magnitudes [SI] outside of which a value other than 0 is taken for a slip of
        the unit.
    """

    name: str
    unit: str
    example: str
    smallest: float
    largest: float


_KINDS = (
    _Kind("length", "m", "100 um", 1e-12, 1e3),
    _Kind("temperature", "K", "40 degC", 1.0, 3e3),
    _Kind("temperature difference", "K", "3 K", 1e-9, 1e3),
    _Kind("angle", "rad", "90 deg", 1e-12, 1e3),
    _Kind("slope", "m/m", "0.1 mm/m", 1e-12, 1.0),
    _Kind("speed", "rad/s", "3000 rpm", 1e-9, 1e6),
    _Kind("velocity", "m/s", "5 mm/s", 1e-15, 1e4),
    _Kind("time", "s", "2 s", 1e-9, 1e6),
    _Kind("mass", "kg", "1200 kg", 1e-9, 1e9),
    _Kind("moment of inertia", "kg*m^2", "0.55 kg*m^2", 1e-12, 1e9),
    _Kind("force", "N", "10 kN", 1e-9, 1e12),
    _Kind("stiffness", "N/m", "10 MN/m", 1e-9, 1e15),
    _Kind("damping", "N*s/m", "200 N*s/m", 1e-9, 1e12),
    _Kind("power", "W", "20 kW", 1e-9, 1e12),
    _Kind("torque", "N*m", "200 N*m", 1e-12, 1e12),
    _Kind("rotational damping", "N*m*s", "0.1 N*m*s", 1e-15, 1e12),
    _Kind("acceleration", "m/s^2", "10 m/s^2", 1e-9, 1e6),
    _Kind("pressure", "Pa", "70 kPa", 1e-6, 1e11),
    _Kind("modulus", "Pa", "207 GPa", 1e3, 1e13),
    _Kind("unbalance", "kg*m", "500 g*mm", 1e-15, 1e6),
    _Kind("dynamic viscosity", "Pa*s", "0.0277 Pa*s", 1e-8, 1e6),
    _Kind("kinematic viscosity", "m^2/s", "32 cSt", 1e-10, 1e3),
    _Kind("temperature coefficient", "1/K", "0.034 / delta_degC", 1e-9, 1e1),
    _Kind("thermal expansion", "1/K", "11.7e-6 / delta_degC", 1e-10, 1e-2),
    _Kind("density", "kg/m^3", "860 kg/m^3", 1e-3, 1e5),
    _Kind("specific heat", "J/(kg*K)", "2000 J/(kg*delta_degC)", 1e-1, 1e6),
    _Kind("thermal conductivity", "W/(m*K)", "0.13 W/(m*delta_degC)", 1e-5, 1e5),
    _Kind("volume flow", "m^3/s", "20 L/min", 1e-12, 1e2),
    _Kind("heat transfer coefficient", "W/(m^2*K)", "80 W/(m^2*delta_degC)", 1e-6, 1e8),
)
QUANTITIES = {kind.name: kind for kind in _KINDS}
"""Every kind of quantity, by name."""

_COMMON = {
    "length": {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6},
    "temperature": {"K": 1.0, "degC": 1.0},
    "temperature difference": {"K": 1.0, "delta_degC": 1.0},
    "angle": {"deg": math.pi / 180.0, "rad": 1.0},
    "slope": {"mm/m": 1e-3},
    "speed": {"rpm": math.pi / 30.0, "rad/s": 1.0, "Hz": 2.0 * math.pi},
    "velocity": {"m/s": 1.0, "mm/s": 1e-3},
    "time": {"s": 1.0, "ms": 1e-3},
    "mass": {"kg": 1.0, "g": 1e-3},
    "moment of inertia": {"kg*m^2": 1.0, "kg*mm^2": 1e-6},
    "force": {"N": 1.0, "kN": 1e3},
    "stiffness": {"N/m": 1.0, "kN/m": 1e3, "MN/m": 1e6, "GN/m": 1e9},
    "damping": {"N*s/m": 1.0, "kN*s/m": 1e3},
    "power": {"W": 1.0, "kW": 1e3},
    "torque": {"N*m": 1.0, "kN*m": 1e3},
    "acceleration": {"m/s^2": 1.0},
    "pressure": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "bar": 1e5},
    "modulus": {"GPa": 1e9},
    "unbalance": {"kg*m": 1.0, "kg*mm": 1e-3, "g*mm": 1e-6},
    "dynamic viscosity": {"Pa*s": 1.0, "mPa*s": 1e-3},
    "kinematic viscosity": {"m^2/s": 1.0, "mm^2/s": 1e-6, "cSt": 1e-6},
    "temperature coefficient": {"/ delta_degC": 1.0},
    "thermal expansion": {"/ delta_degC": 1.0},
    "density": {"kg/m^3": 1.0},
    "specific heat": {"J/(kg*delta_degC)": 1.0},
    "thermal conductivity": {"W/(m*delta_degC)": 1.0},
    "volume flow": {"m^3/s": 1.0},
    "heat transfer coefficient": {"W/(m^2*delta_degC)": 1.0},
}
"""Factors of the usual units, by kind: a file that writes no others needs no Pint, whose import and
registry take a third of a second."""
ZERO_CELSIUS = 273.15

_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?)(?![\d.,_])\s*", re.ASCII)
_COMMA = re.compile(r"\s*[+-]?\d+,\d", re.ASCII)
_TOKEN = re.compile(r"[A-Za-z_][A-Za-z0-9_]*|[*/^()]|[+-]?[0-9]+")
_HINTS = {
    ("kg", "force"): 'that is a mass; write "N" or "kgf"',
    ("t", "force"): "that is a mass; its weight is 9.81 kN for each tonne",
    ("tonne", "force"): "that is a mass; its weight is 9.81 kN for each tonne",
    ("g", "force"): 'that is a mass; write "N"',
    ("kHz", "speed"): 'write "Hz" or "rpm"',
}
_GAUGE = re.compile(
    r"\s*(?P<unit>m?bar|[kM]?Pa|psi|atm)[\s_(]*(?P<zero>g|gauge|a|abs|absolute)\)?\s*",
    re.IGNORECASE,
)
"""A unit of pressure with the zero that it counts from."""


def parse_quantity(
    text: object,
    kind: str,
    *,
    example: str | None = None,
    key: str | None = None,
    source: str | None = None,
) -> float:
    """Read one number with its unit.

    text : Should be text such as ``"100 um"``; anything else is refused with advice.
    kind : What it must be: a name in `QUANTITIES`.
    example : Valid text to show in messages; by default the kind's own.
    key, source : Where the value stands, for messages.
    Returns: In the kind's SI unit; temperatures in K.
    Raises InputError: Not a finite number with a unit of that kind.

    A temperature has an offset ("40 degC" is 313.15 K), a temperature difference has none: in
    products and quotients degC means the difference ("J/(kg*degC)"). "mil" is a thousandth of an
    inch, "Hz" counts revolutions, "reyn" is lbf s/in^2, "lb" is the mass or the force that the kind
    of quantity needs. Other spellings: `rotorsim.unit_spellings`.

    Examples
    --------
    >>> parse_quantity("100 um", "length")
    0.0001
    >>> parse_quantity("104 degF", "temperature")
    313.15
    >>> round(parse_quantity("2.9e-6 reyn", "dynamic viscosity"), 6)
    0.019995
    """
    wanted = QUANTITIES[kind]
    example = example or wanted.example
    try:
        return _parse(text, wanted)
    except _Refusal as refusal:
        raise InputError(
            f'{refusal}; write for example "{example}"', source=source, key=key, value=text
        ) from None


def parse_unit(
    text: str,
    kind: str,
    *,
    example: str | None = None,
    key: str | None = None,
    source: str | None = None,
) -> tuple[float, float]:
    """Read a unit that stands alone, in a table's header for example.

    text, kind, key, source : As in `parse_quantity`.
    example : Valid unit to show in messages; by default the kind's SI unit.
    Returns offset, factor : SI value = offset + factor * number; the offset is 0 but for
        temperatures.
    Raises InputError: Not a unit of that kind.

    Examples
    --------
    >>> parse_unit("N/µm", "stiffness")
    (0.0, 1000000.0)
    """
    wanted = QUANTITIES[kind]
    try:
        if not text.strip() or len(text) > _MAX_TEXT:
            raise _Refusal(f"must be a unit of {kind}")
        return _conversion(text.strip(), wanted)
    except _Refusal as refusal:
        raise InputError(
            f'{refusal}; write for example "{example or wanted.unit}"',
            source=source, key=key, value=text[:_MAX_TEXT],
        ) from None  # fmt: skip


class _Refusal(Exception):
    """Reason for which a text is not the quantity wanted."""


def _one(kind: _Kind) -> str:
    """Return the kind with its article: a length, an angle."""
    return f"{'an' if kind.name[0] in 'aeiou' else 'a'} {kind.name}"


def _parse(text: object, kind: _Kind) -> float:
    if isinstance(text, bool) or not isinstance(text, str | int | float):
        raise _Refusal(f"must be one {kind.name} with its unit, in quotes")
    if not isinstance(text, str):
        raise _Refusal(f"is a bare number: {_one(kind)} needs its unit, in quotes")
    if len(text) > _MAX_TEXT:
        raise _Refusal(f"is too long to be {_one(kind)} ({len(text)} characters)")
    number = _NUMBER.match(text)
    if number is None:
        point = (
            ", with a point for the decimals and nothing between thousands"
            if _COMMA.match(text)
            else ""
        )
        raise _Refusal(f"must be {_one(kind)}: a finite decimal number{point}, then its unit")
    unit = text[number.end() :].strip()
    if not unit:
        raise _Refusal(f"lacks its unit: {_one(kind)} is needed")
    offset, factor = _conversion(unit, kind)
    value = offset + factor * float(number.group(1))
    if not math.isfinite(value):
        raise _Refusal("must be finite")
    short = float(f"{value:.12g}")  # "100 um" is 0.0001, not 9.999999999999999e-05
    value = short if abs(short - value) <= 4.0 * math.ulp(value) else value
    if kind.name == "temperature" and value <= 0.0:
        raise _Refusal("must be above absolute zero")
    if value != 0.0 and not kind.smallest <= abs(value) <= kind.largest:
        raise _Refusal(
            f"is beyond every sensible {kind.name} ({kind.smallest:g} to {kind.largest:g} "
            f"{kind.unit})"
        )
    return value


@lru_cache(maxsize=512)
def _conversion(text: str, kind: _Kind) -> tuple[float, float]:
    """Return ``(offset, factor)``: SI value = offset + factor * number."""
    if text in _COMMON.get(kind.name, {}):
        return (ZERO_CELSIUS if text == "degC" else 0.0), _COMMON[kind.name][text]
    refusals: list[_Refusal] = []
    found: list[tuple[float, float]] = []
    for reading in readings(text, kind.name):
        try:
            found.append(_converted(reading, text, kind))
        except _Refusal as refusal:
            refusals.append(refusal)
    if not found:
        raise refusals[0]
    offset, factor = found[0]
    if any(not math.isclose(factor, other, rel_tol=1e-12) for _, other in found):
        raise _Refusal(f'"{text}" can be read in two ways, set brackets')
    return offset, factor


def _converted(reading: str, text: str, kind: _Kind) -> tuple[float, float]:
    """Return the conversion of one `reading` of the unit written as `text`."""
    registry = _registry()
    try:
        unit = registry.parse_units(_checked_unit_text(reading, text), as_delta=True)
        given = registry.Quantity(1.0, unit)
        if given.dimensionality != _dimensionality(kind):
            raise _Refusal(f'"{text}" is not a unit of {kind.name}{_hint(text, kind)}')
        _check_meaning(unit, text, kind)
        zero, one, two = (_to_si(number, unit, kind) for number in (0.0, 1.0, 2.0))
        if not math.isclose(two - one, one - zero, rel_tol=1e-6):
            raise _Refusal(f'"{text}" is a logarithmic scale, not a unit of {kind.name}')
        return zero, (_to_si(1e3, unit, kind) - zero) / 1e3
    except (
        _pint_error(),
        tokenize.TokenError,
        ArithmeticError,
        AssertionError,
        AttributeError,
        LookupError,
        SyntaxError,
        TypeError,
        ValueError,
    ) as error:
        raise _Refusal(_unknown_unit(text, error) + _hint(text, kind)) from None


def _to_si(number: float, unit: pint.Unit, kind: _Kind) -> float:
    return float(_registry().Quantity(number, unit).to(kind.unit).magnitude)


def _checked_unit_text(reading: str, text: str) -> str:
    """Return `reading` if it holds names, products, quotients and one-digit powers only."""
    refusal = _Refusal(f'does not hold a readable unit ("{text}")')
    tokens = _TOKEN.findall(reading)
    if "".join(tokens) != re.sub(r"\s+", "", reading) or tokens.count("(") != tokens.count(")"):
        raise refusal
    for before, token, after in zip(["", *tokens], tokens, [*tokens[1:], ""], strict=False):
        if token[-1].isdigit() and not token[0].isalpha():
            is_power = before == "^" and len(token.lstrip("+-")) == 1 and after != "^"
            if not (is_power or (token == "1" and before == "" and after == "/")):
                raise refusal
        elif token == "^" and not (after and after[-1].isdigit() and not after[0].isalpha()):
            raise refusal
        elif token[0].isalpha():
            _check_name(token)
    return reading


def _check_name(name: str) -> None:
    """Refuse tons of two sizes, and a symbol with a plural s, which Pint takes Ns for."""
    if name == "u":  # Pint's atomic mass unit
        raise _Refusal('holds no known unit ("u")')
    if name in ("ton", "tons"):
        raise _Refusal(f'"{name}" may be 1000 kg ("t") or 2000 lb ("short_ton")')
    for _, unit, suffix in _registry().parse_unit_name(name):
        if suffix and not name.removesuffix(suffix).endswith(unit):
            raise _Refusal(f'holds no known unit ("{name}")')


def _check_meaning(unit: pint.Unit, text: str, kind: _Kind) -> None:
    """Refuse what has the right dimension and still another meaning."""
    if kind.name == "temperature" and "delta" in str(unit):
        raise _Refusal(f'"{text}" is a temperature difference, a temperature is needed')
    if kind.name == "temperature difference" and _to_si(0.0, unit, kind) != 0.0:
        raise _Refusal(f'"{text}" is a temperature, a difference is needed (K, delta_degC)')
    if kind.name == "slope":  # radians and ratios of lengths say the same
        return
    registry = _registry()
    root = registry.Quantity(0.0, unit).to_root_units().units
    if root != registry.Quantity(1.0, kind.unit).to_root_units().units:
        hint = ' (say "rpm", "rev/s" or "rad/s")' if kind.name == "speed" else ""
        raise _Refusal(f'"{text}" does not say of what: it is not a unit of {kind.name}{hint}')


def _unknown_unit(text: str, error: Exception) -> str:
    name = getattr(error, "unit_names", None)
    return f'holds no known unit ("{name if isinstance(name, str) else text}")'


def _hint(text: str, kind: _Kind) -> str:
    hint = _HINTS.get((text, kind.name))
    force = as_force(text)
    if hint is None and force != text and _is_unit(force, kind):
        hint = f'kg is a mass; write "{force}"'
    pressure = _GAUGE.fullmatch(text) if kind.name == "pressure" else None
    if pressure is not None:
        hint = f'pressures are gauge pressures, above the ambient; write "{pressure["unit"]}"'
        if pressure["zero"].lower().startswith("a"):
            hint += " and subtract the ambient pressure"
    return f" ({hint})" if hint else ""


def _is_unit(text: str, kind: _Kind) -> bool:
    try:
        _conversion(text, kind)
    except _Refusal:
        return False
    return True


@cache
def _dimensionality(kind: _Kind) -> object:
    return _registry().Quantity(1.0, kind.unit).dimensionality


def _pint_error() -> type[Exception]:
    import pint

    return pint.PintError


@cache
def _registry() -> pint.UnitRegistry:
    """Return pint's registry, built when first needed (it takes a tenth of a second)."""
    import pint

    return pint.UnitRegistry()
