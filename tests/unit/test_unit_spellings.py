"""Units as people write them: each spelling has the value of the unit that is meant."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotorsim.errors import InputError
from rotorsim.units import QUANTITIES, parse_quantity, parse_unit

INCH, FOOT, POUND, GRAVITY = 0.0254, 0.3048, 0.45359237, 9.80665
LBF, KGF = POUND * GRAVITY, GRAVITY
BTU = 1055.056  # ISO 31-4
FAHRENHEIT = 5.0 / 9.0

SPELLINGS: dict[str, dict[float, str]] = {
    "speed": {
        math.pi / 30: "rpm RPM Rpm cpm CPM U/min u/min 1/min /min min-1 min^-1 min⁻¹ r/min tr/min "
        "rev/min cycles/min 1/MIN",
        2 * math.pi: "Hz hz rps cps rev/s rev/sec U/s",
        1.0: "rad/s rad/sec rad·s⁻¹ rad.s-1",
        100 * math.pi / 3: "krpm",
    },
    "dynamic viscosity": {
        1.0: "Pa*s Pa.s Pa·s Pa⋅s Pa∙s Pa-s Pa–s Pa‑s Pas N*s/m^2 N.s/m2 N·s/m² Ns/m² kg/(m*s) "
        "kg.m-1.s-1 kg·m⁻¹·s⁻¹",
        1e-3: "mPa*s mPa.s mPa·s mPa-s mPas cP cp cps cPs CP",
        LBF / INCH**2: "reyn lbf*s/in^2 lbf-s/in2 lb-s/in² lb.s/in**2 lbf-sec/in^2 psi*s",
        POUND / FOOT: "lb/ft-s lbm/(ft·s) lb/(ft*s)",
    },
    "kinematic viscosity": {1e-6: "cSt cst CST mm²/s mm2/s mm^2/sec"},
    "force": {
        1.0: "N newton newtons",
        1e3: "kN",
        10.0: "daN",
        KGF: "kgf kp KP kilogram_force",
        LBF: "lbf LBF lb LB lbs Lbs lb_f pound pounds force_pound",
        1e3 * LBF: "kip kips",
    },
    "mass": {
        POUND: "lb lbs LB lbm lb_m pound pounds",
        1.0: "kg N-s²/m N*s^2/m",
        1e3: "t",
        LBF / INCH: "lb-s**2/in lbf-s^2/in lb-s2/in lb-sec²/in LBF-S2/IN",
    },
    "stiffness": {
        1.0: "N/m",
        1e6: "N/um N/µm N/μm kN/mm MN/m",
        1e3: "N/mm kN/m",
        LBF / INCH: "lbf/in lb/in LB/IN lbs/in lbf/inch lb_f/in",
        1e3 * KGF: "kp/mm kgf/mm",
    },
    "damping": {
        1.0: "N*s/m N·s/m N-s/m N.s/m Ns/m N⋅s/m N-sec/m N·s·m⁻¹ N*s*m^-1 N–s/m kg/s",
        1e3: "kN*s/m kN-s/m kNs/m N·s/mm Ns/mm",
        LBF / INCH: "lbf*s/in lbf-s/in lb-s/in LBF-S/IN lb·s/in lb.s/in lbf.s/in lb-sec/in",
    },
    "pressure": {
        LBF / INCH**2: "psi PSI lbf/in^2 lb/in2 lb/in² lbf/in**2",
        1e5 * KGF / 10: "kgf/cm2 kp/cm² kgf/cm^2",
        1e6: "MPa N/mm2 N/mm² MN/m²",
        1e5: "bar",
    },
    "thermal conductivity": {
        1.0: "W/(m*K) W/mK W/m·K W/m-K W/(m·°C) W/(m°C) W/m-C W/(m*degC) W/(m*delta_degC) W/m/K",
        BTU / 3600 / FOOT / FAHRENHEIT: "Btu/hr-ft-F BTU/(h*ft*°F) Btu/(h*ft*delta_degF) "
        "btu/hr/ft/F",
    },
    "heat transfer coefficient": {1.0: "W/(m^2*K) W/m2K W/m²K W/(m²·K) W/m2-C W/(m2K) W·m⁻²·K⁻¹"},
    "specific heat": {
        1e3: "kJ/kgK kJ/(kg*K) kJ/kg·K kJ/kg/K J/g/C J·g⁻¹·K⁻¹ kJ/(kg°C) kJ/kg-C",
        BTU / POUND / FAHRENHEIT: "Btu/lb-F BTU/(lbm·°F) Btu/(lb*delta_degF) btu/lb/F",
    },
    "temperature coefficient": {1.0: "1/K 1/C 1/°C K-1 K⁻¹ /degC /delta_degC", 1.8: "1/F /°F"},
    "density": {
        1.0: "kg/m3 kg/m³ kg/m^3 kg·m⁻³ kg.m-3",
        1e3: "g/cm3 g/cc kg/l kg/dm³ t/m³",
        POUND / FOOT**3: "lb/ft3 lbm/ft^3 lb/ft³",
    },
    "unbalance": {1e-6: "g*mm g·mm g-mm g.mm gmm", POUND * INCH: "lb*in lb-in lb·in"},
    "acceleration": {GRAVITY: "g G", 1.0: "m/s^2 m/s² m/s2 m.s-2"},
    "length": {1e-6: "um µm μm micron microns", 25.4e-6: "mil mils thou", INCH: "in IN inch"},
}
CASES = [
    (spelling, kind, value)
    for kind, values in SPELLINGS.items()
    for value, spellings in values.items()
    for spelling in spellings.split()
]


@pytest.mark.parametrize(("spelling", "kind", "value"), CASES)
def test_spelling_has_the_value_that_is_meant(spelling: str, kind: str, value: float) -> None:
    assert parse_unit(spelling, kind) == (0.0, pytest.approx(value, rel=1e-9))
    assert parse_quantity(f"2 {spelling}", kind) == pytest.approx(2 * value, rel=1e-9)
    if not spelling.startswith("1"):
        assert parse_quantity(f"2{spelling}", kind) == pytest.approx(2 * value, rel=1e-9)


@pytest.mark.parametrize(
    "text",
    ["104 F", "104 °F", "104°F", "104 degF", "104 deg F", "104 ºF", "40 C", "40 ℃", "40degc"],
)
def test_temperature_spelling(text: str) -> None:
    assert parse_quantity(text, "temperature") == pytest.approx(313.15, rel=1e-12)


PREFIXES = {"": 1.0, "k": 1e3, "M": 1e6, "m": 1e-3}
SIGNS = ["*", "·", "-", ".", " ", "⋅", " * ", "‑"]


@given(
    st.sampled_from(sorted(PREFIXES)),
    st.sampled_from(SIGNS),
    st.sampled_from(["m", "mm"]),
    st.sampled_from(["/{}", " / {}", "{sign}{}^-1", "{sign}{}-1", "{sign}{}⁻¹"]),
)
def test_composed_damping_is_the_product_of_its_factors(
    prefix: str, sign: str, length: str, below: str
) -> None:
    unit = f"{prefix}N{sign}s" + below.format(length, sign=sign)
    value = PREFIXES[prefix] * {"m": 1.0, "mm": 1e3}[length]
    assert parse_unit(unit, "damping")[1] == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize("text", ["lb/ft-s", "lb/ft s", "N/m-s", "N/m s"])
def test_what_follows_a_stroke_without_a_sign_stands_under_it(text: str) -> None:
    with pytest.raises(InputError, match="not a unit of damping"):
        parse_unit(text, "damping")


ALIKE = (
    {"mass", "force"},
    {"mass", "acceleration"},
    {"unbalance", "torque"},  # a pound is a mass in the one, a force in the other
    {"temperature", "temperature difference"},
    {"temperature coefficient", "thermal expansion"},
    {"pressure", "modulus"},
)
"""Kinds that share spellings."""


@pytest.mark.parametrize("kind", QUANTITIES)
def test_spelling_of_another_kind_is_refused_with_a_valid_one(kind: str) -> None:
    for spelling, own, _ in CASES:
        if spelling == "cps" or kind == own or {kind, own} in ALIKE:
            continue
        with pytest.raises(InputError) as refused:
            parse_unit(spelling, kind)
        assert f'"{QUANTITIES[kind].unit}"' in str(refused.value), (spelling, own)


@pytest.mark.parametrize("text", ["", " ", "1/s", "ton", "m", "no", "x" * 200])
def test_refused_unit_names_a_valid_one(text: str) -> None:
    with pytest.raises(InputError, match='write for example "rad/s"'):
        parse_unit(text, "speed")
