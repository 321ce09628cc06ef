"""Tables of the page beside the claims: axes of the coefficients, walls, sensitivity."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import rotorsim as rs

from .claims import Claim, Judged, judge, read_claims, verdict
from .study import (
    CLEARANCES,
    DAMPING,
    ISOTHERMAL,
    STIFFNESS,
    THD,
    TOP_SPEED,
    WALL_NAMES,
    WALLS,
    Results,
    reduction,
    variants,
)

Matrix = NDArray[np.float64]

# Axes. The text does not say along what its x and y lie: the load, the line of centres, or neither.
# Each candidate is asked what section 4.2 says of K and C. No verdict rests on the axes found.

_MIRROR = np.diag([1.0, -1.0])
_TRANSPOSED = "first index read as that of the motion"
_SEARCH_STEP = 2
"""[deg]"""


@dataclass(frozen=True)
class Axes:
    """Axes in which K and C are written.

    Attributes
    ----------
    label : str
    along_centers : bool
        Whether `turn` starts from the line of centres, or from the load.
    turn : (2, 2) array
        Its rows are the axes.
    transposed : bool
        Whether k_ij is read as force j by motion i.
    """

    label: str
    along_centers: bool
    turn: Matrix
    transposed: bool = False


def _candidates() -> list[Axes]:
    same, exchange = np.eye(2), np.array([[0.0, 1.0], [1.0, 0.0]])
    return [
        Axes("x along the load, y ahead of it (load frame)", False, same),
        Axes("load frame, y reversed", False, _MIRROR),
        Axes("load frame turned by 90 deg: y against the load", False,
             np.array([[0.0, 1.0], [-1.0, 0.0]])),
        Axes("load frame, x and y exchanged", False, exchange),
        Axes(f"load frame, x and y exchanged, {_TRANSPOSED}", False, exchange, True),
        Axes("x along the line of centres", True, same),
        Axes("line of centres, y reversed", True, _MIRROR),
        Axes("line of centres, x and y exchanged", True, exchange),
    ]  # fmt: skip


def _orientations(as_printed: bool) -> list[Axes]:
    """Every direction of x; both hands and both orders of the indices, or as printed."""
    other = (False,) if as_printed else (False, True)
    found = []
    # A half turn changes no coefficient.
    for degrees in range(0, 180, _SEARCH_STEP):
        cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        turn = np.array([[cos, sin], [-sin, cos]])
        for along_centers in (False, True):
            start = "line of centres" if along_centers else "load"
            for mirrored in other:
                for transposed in other:
                    label = f"x {degrees} deg ahead of the {start}"
                    label += ", y reversed" if mirrored else ""
                    label += f", {_TRANSPOSED}" if transposed else ""
                    axes = _MIRROR @ turn if mirrored else turn
                    found.append(Axes(label, along_centers, axes, transposed))
    return found


@dataclass(frozen=True)
class AxesScore:
    """How far candidate axes meet the paper.

    Attributes
    ----------
    axes : Axes
    statements : dict
        Each qualitative statement and whether it holds (c = 100 µm, 15 000 rpm).
    table_2, table_3 : float
        Root mean square distance from the tables' twelve cells [points].
    """

    axes: Axes
    statements: dict[str, bool]
    table_2: float
    table_3: float

    @property
    def held(self) -> int:
        """Number of statements that hold."""
        return sum(self.statements.values())


@dataclass(frozen=True)
class AxesStudy:
    """Scores of the candidates, and of the best axes that a search over all directions finds."""

    candidates: list[AxesScore]
    best_as_printed: AxesScore
    best: AxesScore


def axes_study(r: Results) -> AxesStudy:
    """Compare the candidates, and search for better ones; ties go to Table 2."""
    cells = [
        (name, int(clearance), claim.paper)
        for claim in read_claims()
        if claim.where in ("Table 2", "Table 3") and claim.paper is not None
        for name, clearance in (claim.key.split("-")[-2:],)
    ]
    matrices = {
        (model, clearance): _matrices(r, model, clearance)
        for model in (ISOTHERMAL, THD)
        for clearance in CLEARANCES
    }

    def score(axes: Axes) -> AxesScore:
        found = {place: _written_in(axes, *of) for place, of in matrices.items()}
        gaps: dict[str, list[float]] = {"k": [], "c": []}
        for name, clearance, paper in cells:
            fall = reduction(found[ISOTHERMAL, clearance][name], found[THD, clearance][name])
            gaps[name[0]].append(fall - paper)
        distances = (float(np.sqrt(np.mean(np.square(gap)))) for gap in gaps.values())
        return AxesScore(axes, _statements(found[ISOTHERMAL, 100], found[THD, 100]), *distances)

    def best(as_printed: bool) -> AxesScore:
        scores = map(score, _orientations(as_printed))
        return max(scores, key=lambda s: (s.held, -s.table_2))

    return AxesStudy([score(axes) for axes in _candidates()], best(True), best(False))


def _matrices(r: Results, model: str, clearance: int) -> tuple[Matrix, Matrix, float]:
    """K and C at the top speed, load frame, and the attitude angle."""
    values = {
        name: r.value(name, model, clearance) for name in (*STIFFNESS, *DAMPING, "attitude_angle")
    }
    k, c = (np.array([[values[x + i + j] for j in "xy"] for i in "xy"]) for x in "kc")
    return k, c, values["attitude_angle"]


def _written_in(axes: Axes, k: Matrix, c: Matrix, attitude: float) -> dict[str, float]:
    turn = axes.turn
    if axes.along_centers:
        cos, sin = math.cos(attitude), math.sin(attitude)
        turn = turn @ np.array([[cos, sin], [-sin, cos]])
    found: dict[str, float] = {}
    for letter, matrix in (("k", k), ("c", c)):
        turned = turn @ matrix @ turn.T
        (xx, xy), (yx, yy) = (turned.T if axes.transposed else turned).tolist()
        found |= {f"{letter}xx": xx, f"{letter}xy": xy, f"{letter}yx": yx, f"{letter}yy": yy}
    return found


def _statements(cold: dict[str, float], warm: dict[str, float]) -> dict[str, bool]:
    fall = {name: reduction(cold[name], warm[name]) for name in cold}
    positive = [name for name in STIFFNESS if cold[name] > 0.0]
    return {
        "kxy is the highest": max(STIFFNESS, key=cold.__getitem__) == "kxy",
        "kyx is negative": cold["kyx"] < 0.0,
        "kyy is the lowest positive one": min(positive, key=cold.__getitem__) == "kyy",
        "heat lowers kyy most": max(STIFFNESS, key=fall.__getitem__) == "kyy",
        "heat lowers kyx least": min(STIFFNESS, key=fall.__getitem__) == "kyx",
        "cxx and cyy exceed cxy and cyx": min(cold["cxx"], cold["cyy"])
        > max(cold["cxy"], cold["cyx"]),
        "isothermal cxx and cyy within 10 %": abs(cold["cyy"] / cold["cxx"] - 1.0) <= 0.1,
        "thermal cxx above cyy": warm["cxx"] > warm["cyy"],
        "heat lowers cxx least": min(DAMPING, key=fall.__getitem__) == "cxx",
    }


# Walls

WALL_CLAIMS = (
    "fig3b-2500", "fig3b-15000", "fig3a-growth-thd", "fig4a-reduction-36",
    "fig4a-reduction-33", "fig4a-reduction-23", "force-33", "force-20-half",
    "friction-45-liquid", "friction-20-liquid", "k-maximum", "c-maximum",
)  # fmt: skip
"""Numbers that the walls decide, besides the cells of Tables 2 and 3."""


def wall_rows(r: Results) -> list[dict[str, Any]]:
    """Return one row for each clearance and thermal condition of the walls, 15 000 rpm.

    Clearance in µm, temperature in degC, load in kN, critical mass in kg, reductions in percent,
    friction power and heat in kW.
    """
    rows = []
    for clearance in CLEARANCES:
        for walls, label in WALL_NAMES.items():
            heat = r.films[THD, walls, clearance, TOP_SPEED].heat_balance
            value, fall = (
                partial(function, clearance=clearance, walls=walls)
                for function in (r.value, r.reduction)
            )
            rows.append(
                {
                    "walls": walls,
                    "label": label,
                    "clearance": clearance,
                    "temperature": value("temperature", THD),
                    "load": value("load", THD) / 1e3,
                    "load_reduction": fall("load"),
                    "friction_reduction": fall("friction_force"),
                    "pressure_reduction": fall("max_pressure"),
                    "critical_mass": value("critical_mass", THD),
                    "critical_mass_reduction": fall("critical_mass"),
                    "friction_power": heat.dissipation / 1e3 if heat else math.nan,
                    "to_bush": heat.to_bush / 1e3 if heat else math.nan,
                    "to_shaft": heat.to_shaft / 1e3 if heat else math.nan,
                }
            )
    return rows


def wall_verdicts(r: Results) -> list[tuple[Claim, dict[str, Judged]]]:
    """Judge the paper's heated numbers under each thermal condition of the walls."""
    views = {walls: replace(r, walls=walls) for walls in WALLS}
    claims = read_claims()
    by_key = {claim.key: claim for claim in claims}
    chosen = [by_key[key] for key in WALL_CLAIMS]
    chosen += [claim for claim in claims if claim.where.startswith("Table")]
    return [
        (claim, {walls: judge(claim, view) for walls, view in views.items()}) for claim in chosen
    ]


def bush_cooling_area() -> float:
    """Return the surface of the bush that convection reaches: outside and both ends [m2]."""
    bearing = rs.load_scenario(rs.shipped_scenarios()["dal"]).bearing
    outer = bearing.bush_outer_radius
    assert outer is not None
    return 2.0 * math.pi * (outer * bearing.length + outer**2 - bearing.journal_radius**2)


# Sensitivity


@dataclass(frozen=True)
class Headline:
    """A headline number at c = 100 µm and 15 000 rpm.

    Attributes
    ----------
    key, label, unit : str
    evaluate : callable
        Of a function that gives a quantity of a thermal model.
    claim : str
        Key of the claim whose paper value and tolerance give a verdict; empty: none.
    """

    key: str
    label: str
    unit: str
    evaluate: Callable[[Callable[[str, str], float]], float]
    claim: str = ""


def _fall(name: str) -> Callable[[Callable[[str, str], float]], float]:
    return lambda value: reduction(value(name, ISOTHERMAL), value(name, THD))


HEADLINES = (
    Headline("force", "film force, isothermal", "kN", lambda value: value("load", ISOTHERMAL) / 1e3,
             "force-30"),
    Headline("friction", "friction, isothermal", "N",
             lambda value: value("friction_force", ISOTHERMAL), "friction-640-whole"),
    Headline("temperature", "peak temperature", "degC", lambda value: value("temperature", THD),
             "fig3b-15000"),
    Headline("force_reduction", "film force lowered by", "%", _fall("load"), "force-33"),
    Headline("friction_reduction", "friction lowered by", "%", _fall("friction_force"),
             "friction-45-whole"),
    Headline("pressure_reduction", "peak pressure lowered by", "%", _fall("max_pressure"),
             "fig4a-reduction-36"),
    Headline("kxx_reduction", "kxx lowered by", "%", _fall("kxx"), "table-2-kxx-100"),
    Headline("cxx_reduction", "cxx lowered by", "%", _fall("cxx"), "table-3-cxx-100"),
    Headline("mass_reduction", "critical mass [kg] lowered by", "%", _fall("critical_mass")),
    Headline("mass", "critical mass, THD", "kg", lambda value: value("critical_mass", THD)),
)  # fmt: skip


def sensitivity(r: Results) -> list[dict[str, Any]]:
    """Return one row for each variant and headline number: value, change, verdict.

    ``status`` says how the variant's two points ended; ``verdict`` is None where the paper claims
    no such number.
    """
    by_key = {claim.key: claim for claim in read_claims()}

    def values(key: str) -> dict[str, float]:
        def value(name: str, model: str) -> float:
            return float(r.variants[name].sel(variant=key, thermal_model=model))

        return {line.key: line.evaluate(value) for line in HEADLINES}

    base = values("base")
    rows = []
    for key, (label, _) in variants(r.mesh).items():
        status = r.variants["status"].sel(variant=key)
        ends = {model: str(status.sel(thermal_model=model).item()) for model in (ISOTHERMAL, THD)}
        lost = [f"{model} {end}" for model, end in ends.items() if end != "converged"]
        found = values(key)
        for line in HEADLINES:
            number = found[line.key]
            rows.append(
                {
                    "variant": key,
                    "label": label,
                    "status": "; ".join(lost) or "converged",
                    "quantity": line.key,
                    "unit": line.unit,
                    "value": number,
                    "change": number - base[line.key],
                    "verdict": verdict(by_key[line.claim], number) if line.claim else None,
                }
            )
    return rows
