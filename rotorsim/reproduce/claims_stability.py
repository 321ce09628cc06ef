"""Claims of section 4.3, the front page and the conclusion: stability, and the whole."""

from __future__ import annotations

import numpy as np

from .claim import NEARLY, STRAIGHT, Evidence, Kind, internal, number, statement
from .evidence import (
    effect_falls_with_clearance,
    effect_grows_with_speed,
    lowered_by_heat,
    ordered_by_clearance,
    rises,
    share,
    spread,
)
from .paper import CLEARANCES
from .results import DAMPING, ISOTHERMAL, STIFFNESS, THD, PaperResults, Run

STATIC = ("load", "friction_force", "power_loss", "max_pressure")
DIMENSIONLESS = "critical_mass_dimensionless"
IN_KG = "In kilograms; the isothermal statements fix M c omega^2/W as what Fig. 8a shows"
PLACE = "Sect. 4.3, Fig. 8a"


def low_speed_spread(r: PaperResults) -> Evidence:
    """Largest relative difference between clearances below 5000 rpm, whirl ratio, THD [%]."""
    rows, speed = _whirl(r)
    slow = rows[:, speed < 5000.0]
    return Evidence(float(100.0 * np.max(np.ptp(slow, axis=0) / slow.mean(axis=0))))


def separates(r: PaperResults) -> Evidence:
    """Whether the whirl ratios part above 5000 rpm, the narrow clearance on top."""
    rows, speed = _whirl(r)
    fast = rows[:, speed > 5000.0]
    return share(list((np.diff(fast, axis=0) < 0.0).flat), "comparisons of neighbouring clearances")


def _whirl(r: PaperResults) -> tuple[np.ndarray, np.ndarray]:
    runs = [Run(THD, c) for c in CLEARANCES]
    return np.array([r.values("whirl_frequency_ratio", run) for run in runs]), r.speeds(runs[0])


def window(r: PaperResults) -> Evidence:
    """Whether some mass is stable without heating and unstable with it, at the top speed."""
    pairs = [
        tuple(r.at("critical_mass", model, c) for model in (THD, ISOTHERMAL)) for c in CLEARANCES
    ]
    text = ", ".join(f"{low:.0f} to {high:.0f} kg" for low, high in pairs)
    more = f"at 15 000 rpm rotors of {text} per bearing (100, 125, 150 um)"
    return share([low < high for low, high in pairs], "clearances", more)


MASS = (
    number(
        "mass-coincide", PLACE,
        "In the isothermal cases, the critical mass curves of the radial clearances are almost "
        "same",
        "spread of M c omega^2/W over clearance and speed, isothermal", "%", 0.0, STRAIGHT,
        spread(DIMENSIONLESS, ISOTHERMAL),
    ),
    number(
        "mass-coincide-kg", PLACE,
        "the radial clearance, as well as the shaft speed, has little influence on the stability, "
        "when the thermal effects are neglected",
        "spread of the critical mass in kg over clearance and speed, isothermal", "%", 0.0,
        STRAIGHT, spread("critical_mass", ISOTHERMAL), Kind.READING,
        f"{IN_KG}. A designer's rotor has kilograms",
    ),
    statement(
        "mass-falls", f"{PLACE}; Sect. 5", "the critical mass decreases as the shaft speed rises "
        "up", "M c omega^2/W falls with speed, THD", rises(DIMENSIONLESS, models=(THD,), sign=-1.0),
    ),
    statement(
        "mass-falls-kg", f"{PLACE}; Sect. 5", "the critical mass decreases as the shaft speed "
        "rises up", "critical mass in kg falls with speed, THD",
        rises("critical_mass", models=(THD,), sign=-1.0), Kind.READING, IN_KG,
    ),
    statement(
        "mass-slow", PLACE,
        "at low speed (n<5000 rpm), the critical mass is high for big radial clearance",
        "M c omega^2/W rises with clearance below 5000 rpm, THD",
        ordered_by_clearance(
            DIMENSIONLESS, models=(THD,), smaller_is_higher=False, highest_rpm=4999.0
        ),
        note="The curves lie within a fraction of a percent there",
    ),
    statement(
        "mass-fast", PLACE,
        "when the shaft speed exceeds 5000 rpm, the critical mass also increases with decrease "
        "the radial clearance",
        "M c omega^2/W falls with clearance above 5000 rpm, THD",
        ordered_by_clearance(
            DIMENSIONLESS, models=(THD,), smaller_is_higher=True, lowest_rpm=5001.0
        ),
    ),
    statement(
        "mass-fast-kg", PLACE,
        "when the shaft speed exceeds 5000 rpm, the critical mass also increases with decrease "
        "the radial clearance",
        "critical mass in kg falls with clearance above 5000 rpm, THD",
        ordered_by_clearance(
            "critical_mass", models=(THD,), smaller_is_higher=True, lowest_rpm=5001.0
        ),
        Kind.READING, IN_KG,
    ),
    statement(
        "mass-narrow", PLACE,
        "the stable regions of the isothermal cases are wider than the stable regions of the "
        "thermal cases",
        "M c omega^2/W and critical mass in kg lowered by heating",
        lowered_by_heat(DIMENSIONLESS, "critical_mass"),
    ),
    statement(
        "mass-wide", PLACE, "the stable region becomes wide when the radial clearance increases",
        "M c omega^2/W rises with clearance above 5000 rpm, THD",
        ordered_by_clearance(
            DIMENSIONLESS, models=(THD,), smaller_is_higher=False, lowest_rpm=5001.0
        ),
    ),
    internal(
        "mass-twice", PLACE,
        "when the shaft speed exceeds 5000 rpm, the critical mass also increases with decrease "
        "the radial clearance; the stable region becomes wide when the radial clearance increases",
        "sign of the change of the critical mass with clearance", "", 1.0, NEARLY, -1.0,
        "The stable region lies below the critical mass: both cannot hold",
    ),
    statement(
        "mass-effect", "Sect. 5",
        "the thermal effects have more obvious influence on the stability ... with small radial "
        "clearance",
        "reduction of M c omega^2/W and of the critical mass falls with clearance",
        effect_falls_with_clearance(DIMENSIONLESS, "critical_mass"),
    ),
)  # fmt: skip

WHIRL = (
    number(
        "whirl-constant", "Sect. 4.3, Fig. 8b",
        "in the isothermal cases, the whirl frequency ratio curves ... are approximately "
        "coincident, and ... almost constant in the shaft speeds",
        "spread of the whirl ratio over clearance and speed, isothermal", "%", 0.0, STRAIGHT,
        spread("whirl_frequency_ratio", ISOTHERMAL),
    ),
    statement(
        "whirl-rises", "Sect. 4.3, Fig. 8b; Sect. 5",
        "the whirl frequency ratio values in the thermal cases rise up as the shaft speed "
        "increases",
        "whirl ratio rises with speed, THD", rises("whirl_frequency_ratio", models=(THD,)),
    ),
    number(
        "whirl-slow", "Sect. 4.3, Fig. 8b",
        "the whirl frequency ratios of the radial clearances are nearly the same for low speed "
        "(n<5000 rpm)",
        "largest difference between clearances below 5000 rpm, THD", "%", 0.0, STRAIGHT,
        low_speed_spread,
    ),
    statement(
        "whirl-fast", "Sect. 4.3, Fig. 8b",
        "when the shaft speed exceeds 5000 rpm ... small radial clearance has high whirl "
        "frequency ratio",
        "whirl ratio falls with clearance above 5000 rpm, THD", separates,
    ),
)  # fmt: skip

WHOLE_PAPER = (
    statement(
        "abstract-lowered", "Abstract; Sect. 5",
        "the film forces, friction forces, and power consumption of the bearing decrease",
        "force, friction, power and peak pressure lowered by heating", lowered_by_heat(*STATIC),
    ),
    statement(
        "abstract-clearance", "Abstract; Sect. 5",
        "this effect is more dominant for the smaller radial clearance",
        "reductions of static and dynamic characteristics fall with clearance",
        effect_falls_with_clearance(*STATIC, *STIFFNESS, *DAMPING),
    ),
    statement(
        "conclusion-slow", "Sect. 5",
        "the thermal effects on the stability, as well as the dynamic characteristics become weak "
        "when the shaft speed runs down",
        "reductions at 500 rpm below those at 15 000 rpm",
        effect_grows_with_speed(*STIFFNESS, *DAMPING, "critical_mass", DIMENSIONLESS),
    ),
    statement(
        "conclusion-window", "Front page; Sect. 5",
        "although, the system operates in a stable region when the thermal effects are neglected, "
        "however, instability will cause trouble in the same speed due to rising temperatures",
        "a mass is stable without heating and unstable with it", window,
    ),
)  # fmt: skip

CLAIMS = (*MASS, *WHIRL, *WHOLE_PAPER)
