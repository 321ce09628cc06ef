"""Claims of section 4.1: film force, friction, power."""

from __future__ import annotations

from collections.abc import Callable

from .claim import (
    EXACT,
    FACTOR,
    FORCE,
    PERCENT,
    STRAIGHT,
    TEMPERATURE,
    Evidence,
    Kind,
    internal,
    number,
    statement,
)
from .evidence import (
    BOTH,
    bend,
    decelerates,
    effect_falls_with_clearance,
    falls_with_clearance,
    lowered_by_heat,
    reduced,
    rises,
    share,
    value,
)
from .paper import CLEARANCES
from .results import ISOTHERMAL, LIQUID, THD, WHOLE, PaperResults, Run, reduction

C100, C125, C150 = CLEARANCES
HALF = "Half of the integral of the pressure over the film, as if one axial half were integrated"
LIQUID_NOTE = "Friction of the oil alone: the ruptured sector counts with its liquid fraction"
WHOLE_NOTE = "Friction over the whole sector, as in the paper's Eq. 17"


def widening(model: str, friction: str) -> Callable[[PaperResults], Evidence]:
    """Reduction of friction from 100 to 150 um [%], the largest over speed."""

    def percent(r: PaperResults) -> Evidence:
        narrow, wide = (
            r.values("friction_force", Run(model, c, friction=friction)) for c in (C100, C150)
        )
        return Evidence(reduction(narrow[-1], wide[-1]))

    return percent


def largest_friction(r: PaperResults) -> Evidence:
    """Whether friction peaks at the top speed and the narrowest clearance."""
    outcomes = []
    for model in BOTH:
        rows = {c: r.values("friction_force", Run(model, c)) for c in CLEARANCES}
        outcomes.append(max(row.max() for row in rows.values()) == rows[C100][-1])
    return share(outcomes, "thermal models")


def friction_coefficient(part: float) -> Callable[[PaperResults], float]:
    """Friction of the whole sector over `part` of the film force."""

    def ratio(r: PaperResults) -> float:
        friction = r.at("friction_force", ISOTHERMAL, C100, friction=WHOLE)
        return friction / (part * r.at("load", ISOTHERMAL, C100))

    return ratio


FORCES = (
    statement(
        "force-speed", "Sect. 4.1, Fig. 5a",
        "when the shaft speed rises up, the film force increases for both",
        "film force rises with speed", rises("load"),
    ),
    statement(
        "force-clearance", "Sect. 4.1, Fig. 5a",
        "the lubrication film forces grow up, as the radial clearance becomes small",
        "film force falls with clearance", falls_with_clearance("load"),
    ),
    number(
        "force-linear", "Sect. 4.1, Fig. 5a",
        "the film forces almost linearly increase for isothermal cases",
        "distance from a straight line, isothermal, 100 um", "%", 0.0, STRAIGHT,
        bend("load", models=(ISOTHERMAL,)),
    ),
    statement(
        "force-slows", "Sect. 4.1, Fig. 5a", "the increase in the forces starts to be slowdown",
        "slope of THD film force falls", decelerates("load", models=(THD,)),
    ),
    number(
        "force-30", "Sect. 4.1, Fig. 5a",
        "reaches to a maximum value of 30 kN for isothermal case and radial clearance of 100 µm",
        "film force, isothermal, 100 um, 15 000 rpm", "kN", 30.0, FORCE,
        value("load", ISOTHERMAL, C100, scale=1e-3),
    ),
    number(
        "force-30-half", "Sect. 4.1, Fig. 5a",
        "reaches to a maximum value of 30 kN for isothermal case and radial clearance of 100 µm",
        "half the film force, isothermal, 100 um, 15 000 rpm", "kN", 30.0, FORCE,
        value("load", ISOTHERMAL, C100, scale=0.5e-3), Kind.READING, HALF,
    ),
    number(
        "force-33", "Sect. 4.1, Fig. 5a", "the force decreases by 33%",
        "reduction of film force, 100 um, 15 000 rpm", "%", 33.0, PERCENT, reduced("load", C100),
    ),
    number(
        "force-20", "Sect. 4.1, Fig. 5a", "it nearly equals to 20 kN",
        "film force, THD, 100 um, 15 000 rpm", "kN", 20.0, FORCE,
        value("load", THD, C100, scale=1e-3),
    ),
    number(
        "force-20-half", "Sect. 4.1, Fig. 5a", "it nearly equals to 20 kN",
        "half the film force, THD, 100 um, 15 000 rpm", "kN", 20.0, FORCE,
        value("load", THD, C100, scale=0.5e-3), Kind.READING, HALF,
    ),
    internal(
        "30-less-33", "Sect. 4.1", "30 kN ... decreases by 33%, and it nearly equals to 20 kN",
        "film force, THD", "kN", 20.0, EXACT, 30.0 * 0.67, "The three numbers fit one another",
    ),
    statement(
        "force-effect", "Sect. 4.1; Sect. 5",
        "the difference between the thermal and isothermal cases decreases as the radial "
        "clearance increases",
        "reduction of film force falls with clearance", effect_falls_with_clearance("load"),
    ),
)  # fmt: skip

FRICTION = (
    number(
        "friction-linear", "Sect. 4.1, Fig. 5b",
        "the friction forces nearly linear increase with shaft speeds for isothermal cases",
        "distance from a straight line, isothermal, 100 um", "%", 0.0, STRAIGHT,
        bend("friction_force", models=(ISOTHERMAL,)),
    ),
    statement(
        "friction-exponential", "Sect. 4.1, Fig. 5b",
        "they exponentially vary with shaft speed for the thermal cases",
        "slope of THD friction rises, as an exponential's does",
        decelerates("friction_force", models=(THD,), sign=-1.0),
        note="Were a curve that levels off meant, its slope would fall",
    ),
    statement(
        "friction-clearance", "Sect. 4.1, Fig. 5b",
        "the friction force is higher for small radial clearance",
        "friction falls with clearance", falls_with_clearance("friction_force"),
    ),
    *(
        number(
            f"friction-{percent:g}-{friction}", "Sect. 4.1, Fig. 5b",
            "from 100 μm to 150 μm, the friction force decreases by maximum of 34% in the "
            "isothermal case, while it decreases by 20% in the thermal case",
            f"reduction of friction from 100 to 150 um, {model}, {friction} friction", "%", percent,
            PERCENT, widening(model, friction), kind, note,
        )
        for friction, kind, note in (
            (WHOLE, Kind.PRINTED, WHOLE_NOTE),
            (LIQUID, Kind.READING, LIQUID_NOTE),
        )
        for model, percent in ((ISOTHERMAL, 34.0), (THD, 20.0))
    ),
    statement(
        "friction-largest", "Sect. 4.1, Fig. 5b",
        "the friction force is maximum for 15000 rpm and radial clearance of 100 µm for each case",
        "largest friction at 15 000 rpm and 100 um", largest_friction,
    ),
    *(
        number(
            f"friction-{key}-{friction}", "Sect. 4.1, Fig. 5b", quote, f"{label}, {friction}", unit,
            paper, tolerance, evaluate(friction), kind, note,
        )
        for friction, kind, note in (
            (WHOLE, Kind.PRINTED, WHOLE_NOTE),
            (LIQUID, Kind.READING, LIQUID_NOTE),
        )
        for key, quote, label, unit, paper, tolerance, evaluate in (
            (
                "640", "it reaches to 640 N for isothermal cases",
                "friction, isothermal, 100 um, 15 000 rpm", "N", 640.0, FORCE,
                lambda f: value("friction_force", ISOTHERMAL, C100, friction=f),
            ),
            (
                "45", "the friction force decreases by 45%, when the thermal effects take into "
                "account", "reduction of friction, 100 um, 15 000 rpm", "%", 45.0, PERCENT,
                lambda f: reduced("friction_force", C100, friction=f),
            ),
        )
    ),
)  # fmt: skip

POWER = (
    statement(
        "power-isothermal", "Sect. 4.1, Fig. 5c",
        "the power consumption is higher for isothermal cases",
        "THD power loss below the isothermal one", lowered_by_heat("power_loss"),
    ),
    statement(
        "power-speed", "Sect. 4.1, Fig. 5c", "it increases when the shaft speed increases",
        "power loss rises with speed", rises("power_loss", "friction_force"),
        note="Friction force included: the text says it of both",
    ),
    statement(
        "power-clearance", "Sect. 4.1, Fig. 5c",
        "the power consumption is high for small radial clearance",
        "power loss falls with clearance", falls_with_clearance("power_loss"),
    ),
    statement(
        "power-effect", "Sect. 4.1, Fig. 5c",
        "for the radial clearance of 100 µm ... the decreasing in the power consumption is maximum",
        "reduction of power loss falls with clearance", effect_falls_with_clearance("power_loss"),
    ),
    *(
        number(
            f"power-45-{friction}", "Sect. 4.1, Fig. 5c", "it is nearly to be 45%",
            f"reduction of power loss, 100 um, 15 000 rpm, {friction} friction", "%", 45.0, PERCENT,
            reduced("power_loss", C100, friction=friction), kind, note,
        )
        for friction, kind, note in (
            (WHOLE, Kind.PRINTED, WHOLE_NOTE),
            (LIQUID, Kind.READING, LIQUID_NOTE),
        )
    ),
    number(
        "friction-over-force", "Sect. 4.1, Fig. 5", "30 kN ... 640 N",
        "friction over film force, isothermal, 100 um, 15 000 rpm, whole friction", "",
        640.0 / 30e3, FACTOR, friction_coefficient(1.0), Kind.READING, WHOLE_NOTE,
    ),
    number(
        "friction-over-half-force", "Sect. 4.1, Fig. 5", "30 kN ... 640 N",
        "friction over half the film force, isothermal, 100 um, 15 000 rpm, whole friction", "",
        640.0 / 30e3, FACTOR, friction_coefficient(0.5), Kind.READING,
        "Only the force would be halved: the two numbers belong to different parts of the film",
    ),
    number(
        "temperature-70", "Sect. 4.1",
        "the temperature of the lubricant rises up to 70 °C (see Fig. 4b)",
        "peak temperature, 100 um, 15 000 rpm", "degC", 70.0, TEMPERATURE,
        value("temperature", THD, C100),
    ),
)  # fmt: skip

CLAIMS = (*FORCES, *FRICTION, *POWER)
