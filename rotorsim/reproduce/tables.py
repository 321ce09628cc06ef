"""The walls and the sensitivity of the verdicts, as rows of numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from ..bearing.operating_point import OperatingPoint
from .claim import Claim, Evidence, Row, Verdict, judge
from .claims import CLAIMS
from .claims_tables import CLAIMS as TABLE_CLAIMS
from .paper import CLEARANCES, TOP_RPM, Walls, bush_cooling_area
from .results import ISOTHERMAL, THD, PaperResults, Run, quantity, reduction
from .variants import BASE, VARIANTS, Variant

_BY_KEY = {claim.key: claim for claim in CLAIMS}
WALL_CLAIMS = tuple(
    _BY_KEY[key]
    for key in (
        "fig3b-2500", "fig3b-15000", "fig3a-growth-thd", "fig4a-reduction-36",
        "fig4a-reduction-33", "fig4a-reduction-23", "force-33", "force-20-half",
        "friction-45-liquid", "friction-20-liquid", "k-maximum", "c-maximum",
    )
)  # fmt: skip
"""Numbers that the walls decide, besides the cells of Tables 2 and 3."""


@dataclass(frozen=True)
class Headline:
    """A headline number at c = 100 um and 15 000 rpm.

    Attributes
    ----------
    key, label, unit : str
    evaluate : callable
        From the isothermal and the THD point.
    claim : Claim or None
        Whose paper value and tolerance give a verdict.
    """

    key: str
    label: str
    unit: str
    evaluate: Callable[[OperatingPoint, OperatingPoint], float]
    claim: Claim | None


def _fall(name: str) -> Callable[[OperatingPoint, OperatingPoint], float]:
    return lambda cold, warm: reduction(quantity(cold, name), quantity(warm, name))


HEADLINES = (
    Headline("force", "film force, isothermal", "kN", lambda c, _: quantity(c, "load") / 1e3,
             _BY_KEY["force-30"]),
    Headline("friction", "friction, isothermal", "N", lambda c, _: quantity(c, "friction_force"),
             _BY_KEY["friction-640-whole"]),
    Headline("temperature", "peak temperature", "degC", lambda _, w: quantity(w, "temperature"),
             _BY_KEY["fig3b-15000"]),
    Headline("force_reduction", "film force lowered by", "%", _fall("load"), _BY_KEY["force-33"]),
    Headline("friction_reduction", "friction lowered by", "%", _fall("friction_force"),
             _BY_KEY["friction-45-whole"]),
    Headline("pressure_reduction", "peak pressure lowered by", "%", _fall("max_pressure"),
             _BY_KEY["fig4a-reduction-36"]),
    Headline("kxx_reduction", "kxx lowered by", "%", _fall("kxx"), _BY_KEY["table-2-kxx-100"]),
    Headline("cxx_reduction", "cxx lowered by", "%", _fall("cxx"), _BY_KEY["table-3-cxx-100"]),
    Headline("mass_reduction", "critical mass [kg] lowered by", "%", _fall("critical_mass"), None),
    Headline("mass", "critical mass, THD", "kg", lambda _, w: quantity(w, "critical_mass"), None),
)  # fmt: skip


@dataclass(frozen=True)
class Cell:
    """A headline number under one variant; `verdict` is None where the paper gives none."""

    value: float
    change: float
    verdict: Verdict | None


@dataclass(frozen=True)
class SensitivityRow:
    """All headline numbers under one variant; `status` says how its points ended."""

    variant: Variant
    status: str
    cells: dict[str, Cell]


def sensitivity(r: PaperResults) -> list[SensitivityRow]:
    """How far each choice moves the headline numbers, and the verdicts with it."""
    base = r.variants[BASE]
    rows = []
    for variant in VARIANTS:
        pair = r.variants[variant.key]
        cells = {}
        for line in HEADLINES:
            value = line.evaluate(*pair)
            cells[line.key] = Cell(value, value - line.evaluate(*base), _verdict(line, value, r))
        lost = [f"{p.thermal_model} {p.status.value}" for p in pair if not p.converged]
        status = "; ".join(lost) or "converged"
        rows.append(SensitivityRow(variant, status, cells))
    return rows


def _verdict(line: Headline, value: float, r: PaperResults) -> Verdict | None:
    if line.claim is None:
        return None
    return judge(replace(line.claim, evaluate=lambda _: Evidence(value)), r).verdict


@dataclass(frozen=True)
class WallRow:
    """One reading of the walls, one clearance, 15 000 rpm (SI, temperatures in degC)."""

    walls: Walls
    radial_clearance: float
    temperature: float
    load: float
    force_reduction: float
    friction_reduction: float
    pressure_reduction: float
    critical_mass: float
    mass_reduction: float
    friction_power: float
    to_bush: float
    to_shaft: float


def wall_rows(r: PaperResults) -> list[WallRow]:
    """Every reading of the walls for every clearance."""
    return [_wall_row(r, walls, clearance) for clearance in CLEARANCES for walls in Walls]


def _wall_row(r: PaperResults, walls: Walls, clearance: float) -> WallRow:
    point = r.curves[Run(THD, clearance, walls)][-1]
    heat = point.heat_balance
    nan = float("nan")

    def fall(name: str) -> float:
        return r.reduction(name, clearance, TOP_RPM, walls=walls)

    return WallRow(
        walls=walls,
        radial_clearance=clearance,
        temperature=quantity(point, "temperature"),
        load=quantity(point, "load"),
        force_reduction=fall("load"),
        friction_reduction=fall("friction_force"),
        pressure_reduction=fall("max_pressure"),
        critical_mass=quantity(point, "critical_mass"),
        mass_reduction=fall("critical_mass"),
        friction_power=heat.dissipation if heat else nan,
        to_bush=heat.to_bush if heat else nan,
        to_shaft=heat.to_shaft if heat else nan,
    )


def with_walls(r: PaperResults, walls: Walls) -> PaperResults:
    """The results as if `walls` were the base: THD curves exchanged."""
    curves = {
        run: points
        for run, points in r.curves.items()
        if run.thermal_model == ISOTHERMAL and run.walls is Walls.AMBIENT
    }
    for run, points in r.curves.items():
        if run.thermal_model == THD and run.walls is walls:
            curves[replace(run, walls=Walls.AMBIENT)] = points
    return replace(r, curves=curves)


def wall_verdicts(r: PaperResults) -> list[tuple[Claim, dict[Walls, Row]]]:
    """The paper's heated numbers, judged under each reading of the walls."""
    views = {walls: with_walls(r, walls) for walls in Walls}
    return [
        (claim, {walls: judge(claim, view) for walls, view in views.items()})
        for claim in (*WALL_CLAIMS, *TABLE_CLAIMS)
    ]


def wall_superheat(row: WallRow) -> float:
    """How far above the air the bush would stand to give off what cold walls take [K]."""
    return row.to_bush / (80.0 * bush_cooling_area())
