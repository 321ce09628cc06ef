"""Claims of section 4.2: stiffness and damping, in the load frame (see `frames`)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .claim import NEARLY, PERCENT, STRAIGHT, Evidence, Kind, internal, number, statement
from .claims_tables import TABLE_2, TABLE_3
from .evidence import (
    BOTH,
    bend,
    bends,
    compare,
    effect_falls_with_clearance,
    extreme,
    falls_with_clearance,
    lowered_by_heat,
    reductions,
    rises,
    share,
    spread_over_speed,
)
from .paper import CLEARANCES
from .results import DAMPING, ISOTHERMAL, STIFFNESS, THD, PaperResults

C100, C125, C150 = CLEARANCES
AXES = "Depends on the axes, which the paper does not name: see there"


def ratio(above: str, below: str, model: str) -> Callable[[PaperResults], Evidence]:
    """Ratio of two coefficients, the one farthest from 1 over clearances at 15 000 rpm."""

    def check(r: PaperResults) -> Evidence:
        found = [r.at(above, model, c) / r.at(below, model, c) for c in CLEARANCES]
        return Evidence(float(max(found, key=lambda x: abs(x - 1.0))))

    return check


def largest_reduction(names: tuple[str, ...]) -> Callable[[PaperResults], Evidence]:
    """Largest reduction among coefficients and clearances at 15 000 rpm [%]."""

    def check(r: PaperResults) -> Evidence:
        found = {(n, c): r.reduction(n, c) for n in names for c in CLEARANCES}
        name, clearance = max(found, key=lambda key: found[key])
        return Evidence(max(found.values()), f"it is {name} at {clearance * 1e6:.0f} um")

    return check


def cross_damping_leads(r: PaperResults) -> Evidence:
    """Whether heat lowers each cross damping more than each direct one, c = 100 um."""
    fall = reductions(r, DAMPING, C100)
    pairs = [(cross, direct) for cross in ("cxy", "cyx") for direct in ("cxx", "cyy")]
    more = ", ".join(f"{name} {x:.1f} %" for name, x in fall.items())
    return share([fall[a] > fall[b] for a, b in pairs], "comparisons", more)


def cooler_with_clearance(r: PaperResults) -> Evidence:
    """Whether the film is cooler in the wider clearance, 15 000 rpm."""
    found = [r.at("temperature", THD, c) for c in CLEARANCES]
    more = ", ".join(f"{t:.0f}" for t in found) + " degC at 100, 125, 150 um"
    return share(list(np.diff(found) < 0.0), "steps of clearance", more)


def warmer_with_clearance(r: PaperResults) -> Evidence:
    """The opposite of `cooler_with_clearance`."""
    found = [r.at("temperature", THD, c) for c in CLEARANCES]
    more = ", ".join(f"{t:.0f}" for t in found) + " degC at 100, 125, 150 um"
    return share(list(np.diff(found) > 0.0), "steps of clearance", more)


def all_apart(r: PaperResults) -> Evidence:
    """Whether reductions of different coefficients, and of one over clearance, differ."""
    rows = [sorted(reductions(r, STIFFNESS, c).values()) for c in CLEARANCES]
    ends = [abs(r.reduction(n, C100) - r.reduction(n, C150)) for n in STIFFNESS]
    gaps = [gap for row in rows for gap in np.diff(row)]
    return share([gap > 1.0 for gap in (*gaps, *ends)], "neighbouring reductions")


STIFF = (
    statement(
        "k-lowered", "Sect. 4.2, Fig. 6; abstract; Sect. 5",
        "When the thermal effects are taken into account, the stiffness coefficients decrease",
        "THD magnitude below the isothermal one", lowered_by_heat(*STIFFNESS),
    ),
    statement(
        "k-clearance", "Sect. 4.2, Fig. 6",
        "bearings whose small radial clearance have high stiffness coefficients in both cases",
        "magnitude falls with clearance", falls_with_clearance(*STIFFNESS),
    ),
    statement(
        "k-positive", "Sect. 4.2, Fig. 6; Sect. 5",
        "when the shaft speed increases, the stiffness coefficients, kxx, kyy, and kyx "
        "positively grows up",
        "kxx, kyy and kyx rise with speed", rises("kxx", "kyy", "kyx"),
    ),
    statement(
        "k-positive-kxy", "Sect. 4.2, Fig. 6; Sect. 5",
        "the stiffness coefficients, kxx, kyy, and kyx positively grows up",
        "kxx, kyy and kxy rise with speed", rises("kxx", "kyy", "kxy"), Kind.READING,
        "kyx stands twice in the sentence; the first is read as kxy",
    ),
    statement(
        "k-negative", "Sect. 4.2, Fig. 6",
        "whereas the stiffness coefficient, kyx increases negatively",
        "kyx falls with speed", rises("kyx", sign=-1.0),
    ),
    internal(
        "kyx-twice", "Sect. 4.2", "kxx, kyy, and kyx positively grows up, whereas ... kyx "
        "increases negatively", "sign of the growth of kyx", "", 1.0, NEARLY, -1.0,
        "One of the two is a misprint for kxy",
    ),
    number(
        "k-linear", "Sect. 4.2, Fig. 6",
        "for isothermal cases, the coefficient variations are almost linear",
        "largest distance from a straight line, isothermal, 100 um", "%", 0.0, STRAIGHT,
        bend(*STIFFNESS, models=(ISOTHERMAL,)),
    ),
    statement(
        "k-nonlinear", "Sect. 4.2, Fig. 6", "whereas the variations are non-linear for thermal "
        "cases", "THD curves leave a straight line by more than 5 %", bends(*STIFFNESS, least=5.0),
    ),
    statement(
        "kxy-highest", "Sect. 4.2, Fig. 6",
        "the cross stiffness coefficients, kxy are the highest due to eccentricity direction",
        "kxy above kxx, kyy and kyx",
        compare(
            lambda k: k["kxy"] > np.maximum(np.maximum(k["kxx"], k["kyy"]), k["kyx"]),
            STIFFNESS, BOTH,
        ),
    ),
    statement(
        "kyy-lowest", "Sect. 4.2, Fig. 6", "the lowest stiffness coefficients are kyy",
        "kyy below kxx, kxy and kyx",
        compare(
            lambda k: k["kyy"] < np.minimum(np.minimum(k["kxx"], k["kxy"]), k["kyx"]),
            STIFFNESS, BOTH,
        ),
        note="With kyx negative kyy cannot be the lowest of the four",
    ),
    statement(
        "kyy-lowest-positive", "Sect. 4.2, Fig. 6", "the lowest stiffness coefficients are kyy",
        "kyy below kxx and kxy", compare(
            lambda k: k["kyy"] < np.minimum(k["kxx"], k["kxy"]), STIFFNESS, BOTH
        ),
        Kind.READING, "Among the positive ones",
    ),
    statement(
        "k-most", "Sect. 4.2, Table 2",
        "The thermal effect on the stiffness coefficient is more dominant for kyy",
        "kyy has the largest reduction", extreme(STIFFNESS, "kyy", max),
        note=AXES,
    ),
    statement(
        "k-least", "Sect. 4.2, Table 2",
        "while this effect is least for kyx among the stiffness coefficients",
        "kyx has the smallest reduction", extreme(STIFFNESS, "kyx", min), note=AXES,
    ),
    statement(
        "k-effect", "Sect. 4.2, Table 2; Sect. 5",
        "the thermal effect on the stiffness coefficient becomes weak when the radial clearance "
        "grows up",
        "reductions fall with clearance", effect_falls_with_clearance(*STIFFNESS),
    ),
    statement(
        "k-varies", "Sect. 4.2, Fig. 6",
        "the difference between thermal and isothermal cases varies for each coefficient, as well "
        "as the radial clearance",
        "reductions more than a point apart", all_apart,
    ),
    statement(
        "cooler", "Sect. 4.2",
        "the rise in the temperature of the lubricant becomes low for high radial clearance values",
        "peak temperature falls with clearance", cooler_with_clearance,
    ),
    number(
        "k-maximum", "Sect. 5", "the stiffness and damping coefficients decrease maximum 40% and "
        "56%, respectively", "largest reduction of stiffness, 15 000 rpm", "%", 40.0, PERCENT,
        largest_reduction(STIFFNESS),
    ),
    internal(
        "40-against-table-2", "Sect. 5; Table 2",
        "stiffness and damping coefficients decrease maximum 40%",
        "largest cell of Table 2", "%", 40.0, PERCENT,
        max(max(row.values()) for row in TABLE_2.values()), "Rounded down",
    ),
)  # fmt: skip

DAMP = (
    number(
        "c-constant", "Sect. 4.2, Fig. 7; Sect. 5",
        "the damping coefficients are almost constant in isothermal cases",
        "largest difference over speed, isothermal", "%", 0.0, STRAIGHT,
        spread_over_speed(*DAMPING, model=ISOTHERMAL),
    ),
    statement(
        "c-falls", "Sect. 4.2, Fig. 7; Sect. 5",
        "whereas the damping coefficients decrease for thermal cases",
        "THD damping falls with speed", rises(*DAMPING, models=(THD,), sign=-1.0),
    ),
    statement(
        "c-lowered", "Abstract; Sect. 5", "the dynamic coefficients in the thermal cases are lower",
        "THD damping below the isothermal one", lowered_by_heat(*DAMPING),
    ),
    statement(
        "c-direct", "Sect. 4.2, Fig. 7",
        "the direct damping coefficients, cxx and cyy are higher than the cross damping "
        "coefficients, cxy and cyx",
        "lower direct one above the higher cross one",
        compare(
            lambda c: np.minimum(c["cxx"], c["cyy"]) > np.maximum(c["cxy"], c["cyx"]),
            DAMPING, BOTH,
        ),
    ),
    number(
        "c-equal", "Sect. 4.2, Fig. 7",
        "cxx and cyy almost equal in the same parameters due to the symmetric structure of the "
        "bearing in isothermal cases",
        "cyy over cxx, isothermal", "", 1.0, NEARLY, ratio("cyy", "cxx", ISOTHERMAL),
        note=AXES,
    ),
    number(
        "c-cross-equal", "Sect. 4.2, Fig. 7",
        "the cross damping coefficients, cxy and cyx are nearly the same, also",
        "cyx over cxy, isothermal", "", 1.0, NEARLY, ratio("cyx", "cxy", ISOTHERMAL),
    ),
    statement(
        "cxx-higher", "Sect. 4.2, Fig. 7",
        "as the thermal effects are taken into account, although the cxx is higher than cyy",
        "THD cxx above cyy", compare(lambda c: c["cxx"] > c["cyy"], DAMPING, (THD,)), note=AXES,
    ),
    number(
        "cxy-cyy", "Sect. 4.2, Fig. 7", "cxy and cyy approximately equal",
        "cxy over cyy, THD", "", 1.0, NEARLY, ratio("cxy", "cyy", THD),
    ),
    number(
        "cxy-cyx", "Sect. 4.2, Fig. 7", "cxy and cyy approximately equal",
        "cyx over cxy, THD", "", 1.0, NEARLY, ratio("cyx", "cxy", THD), Kind.READING,
        "cyy taken for a misprint of cyx",
    ),
    internal(
        "cxy-against-direct", "Sect. 4.2", "cxx and cyy are higher than ... cxy and cyx for each "
        "radial clearance in both cases; cxy and cyy approximately equal",
        "share of statements that hold together", "", 1.0, NEARLY, 0.5,
        "If cyy is higher than cxy in both cases, the two are not equal in one of them",
    ),
    statement(
        "c-most", "Sect. 4.2, Table 3",
        "more dominant for cross damping coefficients in low radial clearance",
        "cross damping reduced more than direct, 100 um", cross_damping_leads,
        note=AXES,
    ),
    statement(
        "c-least", "Sect. 4.2, Table 3", "while this effect is least for cxx",
        "cxx has the smallest reduction", extreme(DAMPING, "cxx", min), note=AXES,
    ),
    statement(
        "c-effect", "Sect. 4.2, Table 3; Sect. 5",
        "the thermal effect on the damping coefficient becomes weak as the clearance grows up",
        "reductions fall with clearance", effect_falls_with_clearance(*DAMPING),
    ),
    statement(
        "c-reason", "Sect. 4.2",
        "because the temperature is low for small radial clearance (see Fig. 4b)",
        "peak temperature rises with clearance", warmer_with_clearance,
    ),
    internal(
        "cool-twice", "Sect. 4.2", "the rise in the temperature ... becomes low for high radial "
        "clearance; the temperature is low for small radial clearance",
        "sign of the change of temperature with clearance", "", 1.0, NEARLY, -1.0,
        "Both cannot hold",
    ),
    number(
        "c-maximum", "Sect. 5", "the stiffness and damping coefficients decrease maximum 40% and "
        "56%, respectively", "largest reduction of damping, 15 000 rpm", "%", 56.0, PERCENT,
        largest_reduction(DAMPING),
    ),
    internal(
        "56-against-table-3", "Sect. 5; Table 3",
        "damping coefficients decrease maximum 40% and 56%",
        "largest cell of Table 3", "%", 56.0, PERCENT,
        max(max(row.values()) for row in TABLE_3.values()), "",
    ),
)  # fmt: skip

CLAIMS = (*STIFF, *DAMP)
