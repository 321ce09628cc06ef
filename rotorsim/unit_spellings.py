"""Unit texts as people write them, rewritten for Pint.

Data sheets, drawings and spreadsheets write the same unit in many ways: N*s/m, N-s/m, N.s/m, N·s/m,
Ns/m. Where a text can be read in two ways, every reading is returned: `rotorsim.units` keeps those
of the dimension that is wanted, and refuses the text if two of them differ.
"""

from __future__ import annotations

import re
import unicodedata

_BEFORE = str.maketrans({"º": "°", "˚": "°", "℃": "°C", "℉": "°F"})
_SIGNS = str.maketrans(
    dict.fromkeys("·⋅∙•×", "*") | dict.fromkeys("‐‑‒–−", "-") | {"µ": "u", "μ": "u"}
)
_DEGREES = re.compile(r"(?:°|\bdeg\.?)\s*([CFK])(?![A-Za-z])")
_POWER = re.compile(r"(?<=[A-Za-z])([+-]?[0-9])")
_PRODUCT_SIGN = re.compile(r"(?<=[A-Za-z0-9)])\s*[.-]\s*(?=[A-Za-z(])")
_NAME = re.compile(r"[A-Za-z_]+")
_NAMES = {
    "mil": "thou",
    "mils": "thou",
    "Hz": "revolutions_per_second",
    "hertz": "revolutions_per_second",
    "rev": "revolution",
    "revs": "revolution",
    "cycles": "revolution",
    "degK": "K",
    "lbs": "lb",
    "lbm": "lb",
    "lb_m": "lb",
    "lb_f": "lbf",
    "lbsf": "lbf",
    "kp": "kgf",
    "S": "s",
    "secs": "second",
    "mins": "minute",
    "hrs": "hour",
    "ins": "inch",
    "kgK": "kg*K",
    "kgC": "kg*degC",
    "gmm": "g*mm",
    "gcm": "g*cm",
    "gm": "g*m",
    "kgmm": "kg*mm",
    "kgm": "kg*m",
    "ozin": "oz*in",
    **{f"{prefix}Pas": f"{prefix}Pa*s" for prefix in ("", "m", "u", "k", "M")},
    **{f"{prefix}Ns": f"{prefix}N*s" for prefix in ("", "m", "k", "M")},
}
"""Names that Pint lacks, or takes for something else than a bearing's drawing does."""
_ANY_CASE = {
    name.casefold(): name
    for name in (
        "rpm", "cpm", "psi", "ksi", "lbf", "lb", "lbs", "lbm", "kgf", "kp", "in", "ft", "Hz", "rad",
        "deg", "mil", "mils", "rev", "sec", "min", "cSt", "Btu", "degC", "degF", "kelvin", "slug",
    )
}  # fmt: skip
"""Names without an SI prefix that small and capital letters could tell apart."""
_TURNS = dict.fromkeys(("r", "U", "u", "tr", "giri", "cycle", "c"), "revolution")
_WARMTH = {"C": "degC", "F": "degF", "celsius": "degC", "fahrenheit": "degF"}
_OF_KIND = {
    "speed": _TURNS | {"cpm": "revolution/minute", "cps": "revolution/second"},
    "temperature": _WARMTH,
    "temperature difference": _WARMTH,
    "temperature coefficient": _WARMTH,
    "specific heat": _WARMTH,
    "thermal conductivity": _WARMTH,
    "heat transfer coefficient": _WARMTH,
    "dynamic viscosity": {"cp": "cP", "cps": "cP", "cPs": "cP", "CP": "cP"},
    "acceleration": {"g": "standard_gravity", "G": "standard_gravity"},
}
"""Names that mean something for one kind of quantity only."""
_BELOW = re.compile(r"/[^/()]*[A-Za-z0-9]\s*[-\s]\s*[A-Za-z]")
"""A stroke, and behind it a product without a sign or with a hyphen: all of it is below."""
_PER_MINUTE = re.compile(r"(1\s*)?/\s*min(ute)?|min\^-1", re.IGNORECASE)
_POUNDS = re.compile(r"\b(lb|pounds?)\b")
_KILOGRAM = re.compile(r"\bkg\b")
_MILLIKELVIN = re.compile(r"\bmK\b")


def readings(text: str, kind: str) -> list[str]:
    """Return the ways to read a unit, as text for Pint, the literal one first.

    text : The unit alone.
    kind : Name of the kind of quantity, see `rotorsim.units.QUANTITIES`.

    Examples
    --------
    >>> readings("lb-s/in", "damping")
    ['lb*s/in', 'lbf*s/in']
    >>> readings("U/min", "speed")
    ['revolution/min']
    """
    plain = _rewritten(text, kind)
    found = [plain]
    if _POUNDS.search(plain):
        found.append(_POUNDS.sub("lbf", plain))
    for one in tuple(found):
        if _MILLIKELVIN.search(one):  # "W/mK"
            found.append(_MILLIKELVIN.sub("m*K", one))
    # "W/m·K": all that follows the stroke may be meant to stand under it
    below = [_under_one_stroke(one) for one in found if _has_open_denominator(one)]
    return below if below and _BELOW.search(_plain_signs(text)) else found + below


def as_force(text: str) -> str:
    """Return the unit with kilogram-force in place of kilogram."""
    return _KILOGRAM.sub("kgf", text)


def _plain_signs(text: str) -> str:
    return unicodedata.normalize("NFKC", text.translate(_BEFORE)).translate(_SIGNS)


def _rewritten(text: str, kind: str) -> str:
    text = _plain_signs(text)
    text = _DEGREES.sub(r" deg\1", text.replace("**", "^")).replace("°", "deg").strip()
    if kind == "speed" and _PER_MINUTE.fullmatch(_POWER.sub(r"^\1", text)):
        return "revolution/minute"
    text = _POWER.sub(r"^\1", _PRODUCT_SIGN.sub("*", text))
    text = re.sub(r"(\^[+-]?[0-9])\s*(?=[A-Za-z])", r"\1*", text)  # "m^2K"
    text = re.sub(r"(?<=[A-Za-z0-9)])\s+(?=[A-Za-z(])", "*", text)
    return _NAME.sub(lambda name: _named(name[0], kind), "1" + text if text[:1] == "/" else text)


def _named(name: str, kind: str) -> str:
    meant = _OF_KIND.get(kind, {})
    other_case = name.lower() if name.isupper() or name.istitle() else name
    for one in (name, other_case):
        if one in meant:
            return meant[one]
    name = _ANY_CASE.get(name.casefold(), name)
    return meant.get(name) or _NAMES.get(name, name)


def _has_open_denominator(text: str) -> bool:
    above, _, below = text.partition("/")
    return bool(above) and "*" in below and not re.search(r"[/()]", below)


def _under_one_stroke(text: str) -> str:
    above, _, below = text.partition("/")
    return f"{above}/({below})"
