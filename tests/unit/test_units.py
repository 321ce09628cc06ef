"""The unit edge: values against hand conversions, refusals, and no way to blow up."""

from __future__ import annotations

import contextlib
import math
import subprocess
import sys
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotorsim import units
from rotorsim.errors import InputError
from rotorsim.units import QUANTITIES, parse_quantity

INCH, POUND_FORCE, POUND = 0.0254, 4.4482216152605, 0.45359237

GOOD = [
    ("100 um", "length", 100e-6),
    ("100 µm", "length", 100e-6),
    ("100um", "length", 100e-6),
    ("+1.5e-1 mm", "length", 150e-6),
    (".5 in", "length", 0.5 * INCH),
    ("4 mil", "length", 4e-3 * INCH),
    ("4 thou", "length", 4e-3 * INCH),
    ("40 degC", "temperature", 313.15),
    ("40 °C", "temperature", 313.15),
    ("104 degF", "temperature", 313.15),
    ("313.15 K", "temperature", 313.15),
    ("-10 degC", "temperature", 263.15),
    ("2.9e-6 reyn", "dynamic viscosity", 2.9e-6 * POUND_FORCE / INCH**2),
    ("2.9e-6 lbf*s/in^2", "dynamic viscosity", 2.9e-6 * POUND_FORCE / INCH**2),
    ("2.9e-6 lbf s / in**2", "dynamic viscosity", 2.9e-6 * POUND_FORCE / INCH**2),
    ("27.7 cP", "dynamic viscosity", 0.0277),
    ("27.7 mPa*s", "dynamic viscosity", 0.0277),
    ("15 cSt", "kinematic viscosity", 15e-6),
    ("15 mm²/s", "kinematic viscosity", 15e-6),
    ("0.034 / delta_degC", "temperature coefficient", 0.034),
    ("0.034/degC", "temperature coefficient", 0.034),
    ("0.034 / K", "temperature coefficient", 0.034),
    ("0.034 1/K", "temperature coefficient", 0.034),
    ("0.018 / delta_degF", "temperature coefficient", 0.018 * 1.8),
    ("2000 J/(kg*delta_degC)", "specific heat", 2000.0),
    ("2000 J/kg/K", "specific heat", 2000.0),
    ("2 kJ/(kg*degC)", "specific heat", 2000.0),
    ("0.13 W/(m*K)", "thermal conductivity", 0.13),
    ("80 W/(m^2*delta_degC)", "heat transfer coefficient", 80.0),
    ("80 W/(m2*K)", "heat transfer coefficient", 80.0),
    ("860 kg/m^3", "density", 860.0),
    ("0.86 g/cm3", "density", 860.0),
    ("500 g*mm", "unbalance", 5e-4),
    ("1 lb*in", "unbalance", POUND * INCH),
    ("10 kN", "force", 1e4),
    ("100 lbf", "force", 100 * POUND_FORCE),
    ("70 psi", "pressure", 70 * POUND_FORCE / INCH**2),
    ("1.5 bar", "pressure", 1.5e5),
    ("60 rpm", "speed", 2 * math.pi),
    ("1 Hz", "speed", 2 * math.pi),
    ("1 rev/s", "speed", 2 * math.pi),
    ("100 rad/s", "speed", 100.0),
    ("90 deg", "angle", math.pi / 2),
    ("90°", "angle", math.pi / 2),
    ("-0.25 turn", "angle", -math.pi / 2),
    ("0.1 mm/m", "slope", 1e-4),
    ("0.1 mrad", "slope", 1e-4),
    ("0 um", "length", 0.0),
    ("-5 mm/s", "velocity", -5e-3),
]


@pytest.mark.parametrize(("text", "kind", "value"), GOOD)
def test_value(text: str, kind: str, value: float) -> None:
    assert parse_quantity(text, kind) == pytest.approx(value, rel=1e-14, abs=0.0)


@pytest.mark.parametrize("kind", sorted(QUANTITIES))
def test_own_examples_are_valid(kind: str) -> None:
    assert parse_quantity(QUANTITIES[kind].example, kind) > 0.0


def test_decimal_text_gives_the_decimal_number() -> None:
    assert parse_quantity("100 um", "length") == 100e-6
    assert parse_quantity("104 degF", "temperature") == 313.15
    assert parse_quantity("90 deg", "angle") == math.pi / 2


BAD = [
    (100e-6, "length", "bare number"),
    (100, "length", "bare number"),
    (math.nan, "length", "bare number"),
    (True, "length", "in quotes"),
    (None, "length", "in quotes"),
    (["1 m"], "length", "in quotes"),
    ("", "length", "number"),
    ("mm", "length", "number"),
    ("100", "length", "lacks its unit"),
    ("nan m", "length", "finite"),
    ("inf m", "length", "finite"),
    ("-inf m", "length", "finite"),
    ("1e400 m", "length", "finite"),
    ("1e999 m", "length", "finite"),
    ("1,5 mm", "length", "a point for the decimals"),
    ("1,500 rpm", "speed", "nothing between thousands"),
    ("90", "angle", ": an angle is needed"),
    (90, "angle", ": an angle needs"),
    ("x", "unbalance", "must be an unbalance"),
    ("18 t", "force", "mass; its weight is 9.81 kN"),
    ("2 barg", "pressure", 'gauge pressures, above the ambient; write "bar"'),
    ("2 bar g", "pressure", 'write "bar"'),
    ("2 bar(g)", "pressure", 'write "bar"'),
    ("30 psig", "pressure", 'write "psi"'),
    ("200 kPa abs", "pressure", 'write "kPa" and subtract the ambient pressure'),
    ("30 psia", "pressure", 'write "psi" and subtract'),
    ("1_000 mm", "length", "number"),
    ("１ mm", "length", "number"),
    ("15 000 rpm", "speed", "readable unit"),
    ("100 kg", "length", "not a unit of length"),
    ("100 kg", "force", "mass"),
    ("5 wobbles", "length", "no known unit"),
    ("5 m*wobbles", "length", "no known unit"),
    ("40 coulomb", "temperature", "degC"),
    ("1 ton", "mass", '2000 lb ("short_ton")'),
    ("5 kg/cm²", "pressure", 'write "kgf/cm²"'),
    ("200 Ns/m", "stiffness", "not a unit of stiffness"),
    ("30 mPas", "pressure", "not a unit of pressure"),
    ("2 Ks", "temperature", "no known unit"),
    ("40 delta_degC", "temperature", "difference"),
    ("72 delta_degF", "temperature", "difference"),
    ("0 K", "temperature", "absolute zero"),
    ("-300 degC", "temperature", "absolute zero"),
    ("50 1/s", "speed", "rpm"),
    ("50 / s", "speed", "rpm"),
    ("5 dimensionless", "angle", "angle"),
    ("5 m*rad", "length", "length"),
    ("-20 dB", "slope", "logarithmic"),
    ("1 octave", "slope", "logarithmic"),
    ("1 lightyear", "length", "sensible"),
    ("1e-30 m", "length", "sensible"),
    ("1 m^m", "length", "unit"),
    ("1 m^", "length", "unit"),
    ("1 m/", "length", "unit"),
    ("1 m/0", "length", "unit"),
    ("1 2*m", "length", "unit"),
    ("1 m)(", "length", "unit"),
    ("1 m**1.5", "length", "unit"),
    ("1 per m", "length", "unit"),
    ("1 __class__", "length", "unit"),
    ("1 __import__('os').getcwd()", "length", "unit"),
    ("1 m; import os", "length", "unit"),
    ("1\x00m", "length", "unit"),
]


@pytest.mark.parametrize(("text", "kind", "said"), BAD, ids=[repr(bad[0])[:30] for bad in BAD])
def test_refusal(text: object, kind: str, said: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_quantity(text, kind, key="a.b", source="f.toml")
    message = str(caught.value)
    assert message.startswith("f.toml: a.b: ")
    assert said in message
    assert QUANTITIES[kind].example in message


@pytest.mark.parametrize(
    "text",
    [
        "1e9**1e9 m",
        "9**9**9**9 m",
        "9 m**9**9**9",
        "1 m^999999999",
        "1 ((((((km^9)^9)^9)^9)^9)^9)^9",
        "1 " + "(" * 95,
        "1 " + "(" * 45 + "m" + ")" * 45,
        "1 " + "m*" * 48 + "m",
        "9" * 10_000 + " m",
        "1 " + "m" * 10_000,
        "1e" + "9" * 50 + " m",
    ],
    ids=range(11),
)
def test_nothing_blows_up(text: str) -> None:
    parse_quantity("1 m", "length")  # Pint's registry is built
    begin = time.perf_counter()
    try:
        value = parse_quantity(text, "length")
    except InputError:
        value = 1.0
    assert value == 1.0
    assert time.perf_counter() - begin < 0.5


@given(st.text(max_size=40), st.sampled_from(sorted(QUANTITIES)))
def test_any_text_is_a_finite_number_or_an_input_error(text: str, kind: str) -> None:
    with contextlib.suppress(InputError):
        assert math.isfinite(parse_quantity(text, kind))


UNIT_PIECES = [
    "m",
    "s",
    "kg",
    "degC",
    "K",
    "rad",
    "dB",
    "1",
    "2",
    "-",
    "*",
    "/",
    "^",
    "**",
    "(",
    ")",
]


@given(
    st.sampled_from(["1 ", "0 ", "-1e300 ", "1e-300"]),
    st.lists(st.sampled_from([*UNIT_PIECES, " "]), max_size=12).map("".join),
    st.sampled_from(sorted(QUANTITIES)),
)
def test_any_unit_expression_is_answered(number: str, unit: str, kind: str) -> None:
    with contextlib.suppress(InputError):
        assert math.isfinite(parse_quantity(number + unit, kind))


@given(st.floats(min_value=1e-3, max_value=1e3))
def test_feet_and_metres_agree(value: float) -> None:
    feet = parse_quantity(f"{value:.17g} ft", "length")
    assert feet == pytest.approx(0.3048 * value, rel=1e-13)


def test_usual_units_are_what_pint_makes_of_them(monkeypatch: pytest.MonkeyPatch) -> None:
    numbers = ("1", "0.1", "3", "12.7", "40", "97.3", "128")
    texts = [
        (f"{number} {unit}", kind)
        for kind, factors in units._COMMON.items()
        for unit in factors
        for number in numbers
        if abs(float(number) * factors[unit]) < 0.5 * units.QUANTITIES[kind].largest
    ]
    usual = [parse_or_message(*one) for one in texts]
    monkeypatch.setattr(units, "_COMMON", {})
    units._conversion.cache_clear()
    assert usual == [parse_or_message(*one) for one in texts]
    units._conversion.cache_clear()
    assert sum(isinstance(value, float) for value in usual) > 300


def parse_or_message(text: str, kind: str) -> float | str:
    try:
        return parse_quantity(text, kind)
    except InputError as error:
        return str(error)


def test_a_file_of_usual_units_needs_no_pint() -> None:
    code = "import sys, rotorsim; rotorsim.load_scenario('dal'); sys.exit('pint' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_importing_the_module_leaves_pint_alone() -> None:
    code = "import sys, rotorsim.units; sys.exit('pint' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
