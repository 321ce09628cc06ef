"""Claims of sections 3 and 4 up to Fig. 4: verification, pressure, temperature."""

from __future__ import annotations

import math

from .claim import (
    AROUND,
    EXACT,
    FACTOR,
    MESH,
    PERCENT,
    SIMILAR,
    STRAIGHT,
    TEMPERATURE,
    Evidence,
    Kind,
    internal,
    number,
    statement,
    undecidable,
)
from .evidence import (
    bend,
    decelerates,
    effect_grows_with_speed,
    falls_with_clearance,
    growth,
    reduced,
    relative_gap,
    rise,
    rises,
    share,
    value,
)
from .fields import (
    gap_with_speed,
    highest_mean_temperature,
    hot_side,
    hotter_with_speed,
    peak_angle,
    pressure_likeness,
    pressure_with_speed,
    temperature_likeness,
)
from .paper import CLEARANCES
from .results import ISOTHERMAL, THD, PaperResults
from .variants import DOUBLE_MESH, LITERAL

C100, C125, C150 = CLEARANCES
AS_TEMPERATURE = "As printed the sentence speaks of temperature; its context is pressure"
OF_END = "Percent of the value at 15 000 rpm instead of that at 7500 rpm"


def literal_mesh(r: PaperResults) -> float:
    """Film force on the paper's node counts against the doubled mesh [%]."""
    return relative_gap(r.variants[DOUBLE_MESH][1].load, r.variants[LITERAL][1].load)


def order_of_temperatures(r: PaperResults) -> Evidence:
    """Whether the relative growth of temperature rises with clearance."""
    found = [rise("temperature", THD, c, 7500.0, of_end=False)(r) for c in CLEARANCES]
    more = "computed " + ", ".join(f"{x:.1f} %" for x in found)
    return share([found[0] < found[1], found[1] < found[2]], "steps of clearance", more)


VERIFICATION = (
    undecidable(
        "fig2-pressure", "Sect. 3, Fig. 2a",
        "closer to both experimental and numerical data, and the results show a good agreement",
        "peak pressure against eccentricity ratio, c = 145 um",
        "The data of its Refs. 16 and 28 are shown as points only, and neither speed nor inlet is "
        "stated; our curve is drawn in Fig. 2",
    ),
    undecidable(
        "fig2-temperature", "Sect. 3, Fig. 2b",
        "when the eccentricity ratio is lower than 0.7, a deviation between test data and "
        "numerical results are occurred",
        "peak temperature against eccentricity ratio, c = 145 um",
        "No test data are printed; our curves in Fig. 2 show how much walls and speed matter",
    ),
    number(
        "mesh", "Sect. 3",
        "a mesh independency study was performed ... M, N, Z, are preferred as 48, 156, and 24",
        "change of THD film force from 48 x 156 x 24 to the doubled mesh", "%", 0.0, MESH,
        literal_mesh,
    ),
    internal(
        "eta", "Eq. 15", "a coefficient, and it equals 0.034",
        "fall of viscosity from 40 to 90 degC that heating needs to lower the film force by 33 %",
        "%", 33.0, PERCENT, 100.0 * (1.0 - math.exp(-0.034 * (90.0 / 40.0 - 1.0))),
        "Eq. 15 as printed, with temperatures in multiples of T_0 (here even in degC, which makes "
        "the fall largest), leaves the oil almost unchanged; 0.034 per kelvin is used instead",
    ),
)  # fmt: skip

PROFILES = (
    number(
        "fig3a-centre", "Sect. 4, Fig. 3a",
        "pressure values around the bearing center (θ=180°) are higher than other region",
        "angle of peak pressure from maximum film thickness", "deg", 180.0, AROUND, peak_angle,
    ),
    number(
        "fig3a-similar", "Sect. 4, Fig. 3a",
        "this variation profile of the pressure are similar for each cases",
        "least correlation of two pressure profiles", "", 1.0, SIMILAR, pressure_likeness,
    ),
    statement(
        "fig3a-speed", "Sect. 4, Fig. 3a",
        "when the rotating speed increases, the pressure values around the bearing center grow up",
        "mid-plane pressure rises with speed", pressure_with_speed,
    ),
    number(
        "fig3a-low-speed", "Sect. 4, Fig. 3a",
        "the peak pressure values are almost same for lower rotating speed under both",
        "reduction of peak pressure, 100 um, 2500 rpm", "%", 0.0, PERCENT,
        reduced("max_pressure", C100, 2500.0),
        note="Of the speeds in Fig. 3, 2500 rpm is the lowest",
    ),
    statement(
        "fig3a-difference", "Sect. 4, Fig. 3a",
        "when the rotating speed grows up, the differences between the pressure values increase",
        "isothermal less THD peak pressure rises with speed", gap_with_speed,
    ),
    number(
        "fig3a-growth-thd", "Sect. 4", "the peak pressure grows up 5.5 times for thermal cases",
        "peak pressure at 15 000 over 2500 rpm, THD, 100 um", "", 5.5, FACTOR,
        growth("max_pressure", THD, C100, 2500.0),
    ),
    number(
        "fig3a-growth-isothermal", "Sect. 4", "it grows up 6 times for the isothermal cases",
        "peak pressure at 15 000 over 2500 rpm, isothermal, 100 um", "", 6.0, FACTOR,
        growth("max_pressure", ISOTHERMAL, C100, 2500.0),
    ),
    internal(
        "growth-against-reduction", "Sect. 4",
        "5.5 times ... 6 times; almost same for lower rotating speed; diminish by 36%",
        "thermal growth of peak pressure from 2500 to 15 000 rpm", "", 5.5, FACTOR,
        6.0 * (1.0 - 0.36),
        "Six-fold isothermal growth from the same start, less 36 %, is what remains",
    ),
    statement(
        "fig3b-hot-side", "Sect. 4, Fig. 3b",
        "temperature values in a range of circumferential direction between θ=180° and θ=360° "
        "are high",
        "mid-plane temperature after minimum film thickness above that before it", hot_side,
    ),
    number(
        "fig3b-similar", "Sect. 4, Fig. 3b",
        "this temperature profile is similar for different rotating speeds",
        "least correlation of two temperature profiles", "", 1.0, SIMILAR, temperature_likeness,
    ),
    statement(
        "fig3b-speed", "Sect. 4, Fig. 3b",
        "the temperature values are higher for high rotating speeds",
        "mid-plane temperature rises with speed at every angle", hotter_with_speed,
    ),
    number(
        "fig3b-2500", "Sect. 4, Fig. 3b", "reaches 45 °C ... under rotating speed of 2500 rpm",
        "peak temperature, 100 um, 2500 rpm", "degC", 45.0, TEMPERATURE,
        value("temperature", THD, C100, 2500.0),
    ),
    number(
        "fig3b-15000", "Sect. 4, Fig. 3b",
        "it exceeds 90 °C, when the rotating speed reaches 15000 rpm",
        "peak temperature, 100 um, 15 000 rpm", "degC", 90.0, TEMPERATURE,
        value("temperature", THD, C100),
    ),
)  # fmt: skip

PEAKS = (
    statement(
        "fig4a-speed", "Sect. 4, Fig. 4a",
        "In both cases, the maximum pressure values grow up as shaft speed increases",
        "peak pressure rises with speed", rises("max_pressure"),
    ),
    statement(
        "fig4a-clearance", "Sect. 4, Fig. 4a; Sect. 4.2",
        "the maximum pressure values are high for small radial clearance at each case",
        "peak pressure falls with clearance", falls_with_clearance("max_pressure"),
    ),
    number(
        "fig4a-linear", "Sect. 4, Fig. 4a", "behaves linear increasing for isothermal cases",
        "distance from a straight line, isothermal, 100 um", "%", 0.0, STRAIGHT,
        bend("max_pressure", models=(ISOTHERMAL,)),
    ),
    statement(
        "fig4a-decelerates", "Sect. 4, Fig. 4a",
        "the increasing in the maximum pressure in the thermal cases decelerates",
        "slope of THD peak pressure falls", decelerates("max_pressure", models=(THD,)),
    ),
    *(
        number(
            f"fig4a-{percent:g}{'-of-end' if of_end else ''}", "Sect. 4, Fig. 4a",
            "from 7500 rpm to 15000 rpm ... isothermal cases grow up 50%, 48%, and 46%",
            f"growth of isothermal peak pressure, {clearance * 1e6:.0f} um"
            f"{', in percent of its end' if of_end else ''}",
            "%", percent, PERCENT,
            rise("max_pressure", ISOTHERMAL, clearance, 7500.0, of_end=of_end), kind,
            OF_END if of_end else "",
        )
        for of_end, kind in ((False, Kind.PRINTED), (True, Kind.READING))
        for clearance, percent in zip(CLEARANCES, (50.0, 48.0, 46.0), strict=True)
    ),
    internal(
        "linear-against-growth", "Sect. 4, Fig. 4a", "behaves linear increasing ... grow up 50%",
        "growth of isothermal peak pressure from 7500 to 15 000 rpm", "%", 50.0, PERCENT, 100.0,
        "A straight line through no pressure at no speed doubles with the speed, for every "
        "clearance alike",
    ),
    *(
        number(
            f"fig4b-{percent:g}-as-{'temperature' if name == 'temperature' else 'pressure'}"
            f"{'-of-end' if of_end else ''}",
            "Sect. 4, Fig. 4",
            "whereas the temperature values under thermal cases increase by 36%, 40%, and 45%",
            f"growth of THD {label}, {clearance * 1e6:.0f} um, 7500 to 15 000 rpm"
            f"{', in percent of its end' if of_end else ''}",
            "%", percent, PERCENT, rise(name, THD, clearance, 7500.0, of_end=of_end), kind, note,
        )
        for name, label, of_end, kind, note in (
            ("temperature", "peak temperature in degC", False, Kind.PRINTED, ""),
            ("max_pressure", "peak pressure", False, Kind.READING, AS_TEMPERATURE),
            ("max_pressure", "peak pressure", True, Kind.READING, f"{AS_TEMPERATURE}. {OF_END}"),
        )
        for clearance, percent in zip(CLEARANCES, (36.0, 40.0, 45.0), strict=True)
    ),
    statement(
        "fig4b-order", "Sect. 4, Fig. 4",
        "the temperature values under thermal cases increase by 36%, 40%, and 45%, respectively",
        "relative growth of peak temperature rises with clearance", order_of_temperatures,
    ),
    number(
        "fig4b-slow", "Sect. 4, Fig. 4b",
        "the lubricant temperature values are nearly constant for slow rotational speed",
        "rise of peak temperature above ambient, 100 um, 2500 rpm", "K", 0.0, TEMPERATURE,
        lambda r: r.at("temperature", THD, C100, 2500.0) - 40.0,
    ),
    statement(
        "fig4b-speed", "Sect. 4, Fig. 4b; abstract; Sect. 5",
        "the temperature values increase when the shaft speed rises by exceeding 2500 rpm",
        "peak temperature rises with speed above 2500 rpm",
        rises("temperature", models=(THD,), above=2500.0),
    ),
    statement(
        "fig4-lowered", "Sect. 4, Fig. 4",
        "the maximum pressure values decrease due to the viscosity-temperature relation when the "
        "shaft speed increases",
        "reduction of peak pressure by heating at 500 rpm below that at 15 000 rpm",
        effect_grows_with_speed("max_pressure"),
        note="Read as a fall against the isothermal case: with speed the peak rises (Fig. 4a)",
    ),
    number(
        "fig4b-72", "Sect. 4, Fig. 4b",
        "maximum temperature of the radial clearance of 100 µm rises to 72 °C",
        "peak temperature, 100 um, 15 000 rpm", "degC", 72.0, TEMPERATURE,
        value("temperature", THD, C100),
    ),
    number(
        "fig4b-72-mean", "Sect. 4, Fig. 4b",
        "maximum temperature of the radial clearance of 100 µm rises to 72 °C",
        "highest mean across the film at mid-plane, 100 um, 15 000 rpm", "degC", 72.0, TEMPERATURE,
        highest_mean_temperature, Kind.READING,
        "Fig. 4b would show the mean across the film where Fig. 3b shows the hottest layer",
    ),
    internal(
        "72-against-90", "Fig. 4b; Fig. 3b", "rises to 72 °C ... it exceeds 90 °C",
        "peak temperature, 100 um, 15 000 rpm", "degC", 72.0, TEMPERATURE, 90.0,
        "Same bearing, same speed, two temperatures",
    ),
    internal(
        "70-against-72", "Sect. 4.1; Sect. 4",
        "temperature of the lubricant rises up to 70 °C (see Fig. 4b)",
        "peak temperature in Fig. 4b", "degC", 70.0, EXACT, 72.0, "Rounded",
    ),
    *(
        number(
            f"fig4a-reduction-{percent:g}", "Sect. 4, Fig. 4a",
            "the maximum pressures diminish by 36%, 33%, and 23%",
            f"reduction of peak pressure, {clearance * 1e6:.0f} um, 15 000 rpm", "%", percent,
            PERCENT, reduced("max_pressure", clearance),
        )
        for clearance, percent in zip(CLEARANCES, (36.0, 33.0, 23.0), strict=True)
    ),
)  # fmt: skip

CLAIMS = (*VERIFICATION, *PROFILES, *PEAKS)
