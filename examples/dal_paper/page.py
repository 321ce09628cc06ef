"""The page: the template ``page.md`` filled with verdicts, tables and numbers.

Every number in its sentences is computed.
"""

from __future__ import annotations

import base64
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from .claims import (
    TREND_FACTOR,
    Claim,
    Judged,
    Kind,
    Tolerance,
    Verdict,
    read_claims,
    read_tolerances,
    shown,
)
from .figures import CAPTIONS
from .study import AMBIENT, ISOTHERMAL, THD, WALL_NAMES, WALLS, WHOLE, Results, paper_mesh
from .tables import (
    HEADLINES,
    AxesScore,
    axes_study,
    bush_cooling_area,
    sensitivity,
    wall_rows,
    wall_verdicts,
)

TEMPLATE = Path(__file__).with_name("page.md")
MARKS = {Verdict.AGREES: "✓", Verdict.TREND: "~", Verdict.CONTRADICTS: "✗", Verdict.UNDECIDED: "?"}
LEGEND = ", ".join(f"{mark} {verdict}" for verdict, mark in MARKS.items())


def markdown(r: Results, rows: Sequence[Judged], images: str) -> str:
    """Return the page.

    Parameters
    ----------
    r : Results
    rows : sequence of Judged
        All claims.
    images : str
        Folder of the figures, relative to the page.
    """
    values = {
        "legend": LEGEND,
        "trend_factor": TREND_FACTOR,
        "mesh": " x ".join(str(r.mesh[n]) for n in ("circumferential", "axial", "cross_film")),
        "coarse": "" if r.mesh == paper_mesh() else " (coarse: for a quick look)",
        "counts": _counts(rows),
        "figures": "\n\n".join(
            f"![{caption.partition(':')[0]}]({images}/{name}.png)\n\n*{plain(caption)}*"
            for name, caption in CAPTIONS.items()
        ),
        "claims": _claims(rows),
        "tolerances": _tolerances(),
        **_force_and_friction(r),
        **_axes(r),
        **_walls(r),
        **_sensitivity(r),
    }
    return TEMPLATE.read_text(encoding="utf-8").format(**values)


def html(text: str, pictures: Mapping[str, bytes]) -> str:
    """Return a page of `markdown` as one self-contained file, figures embedded.

    Parameters
    ----------
    text : str
    pictures : mapping
        PNG data by figure name.
    """
    from markdown_it import MarkdownIt  # comes with rich

    body = MarkdownIt("commonmark", {"html": False}).enable("table").render(text)
    body = body.replace("<table>", '<div class="scroll"><table>')
    body = body.replace("</table>", "</table></div>")
    for verdict, mark in MARKS.items():
        cell = re.compile(rf"<td>({re.escape(verdict)}|[^<]* {re.escape(mark)})</td>")
        body = cell.sub(rf'<td class="{verdict.name.lower()}">\1</td>', body)
    for name, data in pictures.items():
        encoded = base64.b64encode(data).decode("ascii")
        body = re.sub(rf'src="[^"]*/{name}\.png"', f'src="data:image/png;base64,{encoded}"', body)
    title = text.partition("\n")[0].removeprefix("# ")
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{title}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n{body}</body>\n</html>\n"
    )


_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 1180px; margin: 2em auto; padding: 0 1em;
  color: #1b1f24; background: #fff; }
h1 { font-size: 1.7em; } h2 { margin-top: 2em; border-bottom: 1px solid #ccc; }
table { border-collapse: collapse; font-size: 13px; margin: 1em 0; }
.scroll { overflow-x: auto; }
th, td { border: 1px solid #d5d9de; padding: 3px 7px; text-align: left; vertical-align: top; }
th { background: #f0f2f4; position: sticky; top: 0; }
img { max-width: 100%; height: auto; }
.agrees { background: #d9f0dd; } .trend { background: #fdf0c8; }
.contradicts { background: #f9d6d2; } .undecided { background: #e4e4ea; }
@media print { body { max-width: none; } th { position: static; } }
"""


def plain(text: str) -> str:
    """Escape what Markdown would take for markup."""
    return re.sub(r"([\\|*_<])", r"\\\1", text)


def table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table."""
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(map(plain, line)) + " |" for line in lines)


def _with_unit(value: float, unit: str) -> str:
    return f"{shown(value)} {unit}".strip() if math.isfinite(value) else "-"


def _computed(row: Judged) -> str:
    value, unit = row.evidence.value, row.claim.unit
    if unit == "share" and math.isfinite(value):
        return f"{100.0 * value:.0f} % hold"
    return _with_unit(value, unit)


def _paper(claim: Claim) -> str:
    return "-" if claim.paper is None else f"{claim.paper:.4g} {claim.unit}".strip()


def count(rows: Sequence[Judged]) -> dict[Kind, dict[Verdict, int]]:
    """Return the number of claims by what is compared and by verdict."""
    found = [(row.claim.kind, row.verdict) for row in rows]
    return {kind: {verdict: found.count((kind, verdict)) for verdict in Verdict} for kind in Kind}


def _counts(rows: Sequence[Judged]) -> str:
    lines = [[kind, *map(str, numbers.values())] for kind, numbers in count(rows).items()]
    return table(["rows", *Verdict], lines)


def _other_reading(row: Judged, rows: Sequence[Judged]) -> str:
    """Say under which other reading the words agree, or why nothing can be decided."""
    if row.verdict is Verdict.UNDECIDED:
        return f"; {row.reason}"
    if row.claim.kind is not Kind.PRINTED or row.verdict is not Verdict.CONTRADICTS:
        return ""
    for other in rows:
        claim = other.claim
        if (
            claim.kind is Kind.READING
            and (claim.where, claim.paper) == (row.claim.where, row.claim.paper)
            and (claim.quote in row.claim.quote or row.claim.quote in claim.quote)
            and other.verdict is Verdict.AGREES
        ):
            return f"; agrees if read as: {claim.quantity}"
    return ""


def _claims(rows: Sequence[Judged]) -> str:
    columns = ("where", "claim", "compared", "quantity", "paper", "computed", "verdict")
    lines = [
        (row.claim.where, row.claim.quote, row.claim.kind,
         f"{row.claim.quantity}{_other_reading(row, rows)}", _paper(row.claim), _computed(row),
         row.verdict)
        for row in rows
    ]  # fmt: skip
    return table(columns, lines)


def _force_and_friction(r: Results) -> dict[str, Any]:
    """Return the halved force, and the friction under both counts of the ruptured sector."""
    force, force_thd = (r.value("load", model) / 1e3 for model in (ISOTHERMAL, THD))
    found = {
        "force": force,
        "force_thd": force_thd,
        "part": 30.0 / force,
        "part_thd": 20.0 / force_thd,
    }
    for friction in (WHOLE, "liquid"):
        cold = r.value("friction_force", ISOTHERMAL, friction=friction)
        fall = r.reduction("friction_force", friction=friction)
        found |= {
            friction: cold,
            f"{friction}_fall": fall,
            f"{friction}_off": abs(cold - 640.0),
            f"{friction}_fall_off": abs(fall - 45.0),
        }
    return found


def _axes(r: Results) -> dict[str, Any]:
    study = axes_study(r)
    scores, best, printed = study.candidates, study.best, study.best_as_printed
    most = max(s.held for s in scores)
    names = list(best.statements)
    return {
        "statements": len(names),
        "sign_axes": "; ".join(
            s.axes.label for s in scores if all(s.statements[name] for name in names[:3])
        )
        or "none",
        "most": most,
        "leaders": "; ".join(s.axes.label for s in scores if s.held == most),
        "most_centers": max(s.held for s in scores if s.axes.along_centers),
        "nearest": min(scores, key=lambda s: s.table_2),
        "load_frame": scores[0],
        "best": best,
        "printed": printed,
        "together": "So the statements can hold together, in axes that the paper does not name"
        if best.held == len(names)
        else "So no choice of axes makes all of them hold together",
        "axes": table(
            ["axes", *names, "hold", "Table 2 [points]", "Table 3 [points]"],
            [_axes_row(score) for score in (*scores, printed, best)],
        ),
    }


def _axes_row(score: AxesScore) -> list[str]:
    marks = ["✓" if held else "✗" for held in score.statements.values()]
    held = f"{score.held} of {len(marks)}"
    return [score.axes.label, *marks, held, shown(score.table_2), shown(score.table_3)]


def _walls(r: Results) -> dict[str, Any]:
    rows = wall_rows(r)
    cold, bush, free = (
        next(row for row in rows if row["walls"] == walls and row["clearance"] == 100)
        for walls in (AMBIENT, "conduction", "conduction_free_shaft")
    )
    judged = wall_verdicts(r)
    agreeing = {
        walls: sum(row[walls].verdict is Verdict.AGREES for _, row in judged) for walls in WALLS
    }
    masses = [row["critical_mass"] for row in (bush, free)]
    return {
        "cold": cold,
        "bush": bush,
        "free": free,
        "heated": len(judged),
        "agreeing": ", ".join(f"{n} with {WALL_NAMES[walls]}" for walls, n in agreeing.items()),
        "wall_share": 100.0 * (cold["to_bush"] + cold["to_shaft"]) / cold["friction_power"],
        "area": bush_cooling_area(),
        "superheat": 1e3 * cold["to_bush"] / (80.0 * bush_cooling_area()),
        "isothermal_mass": r.value("critical_mass", ISOTHERMAL),
        "low_mass": min(masses),
        "high_mass": max(masses),
        "walls": _wall_table(rows),
    }


def _wall_table(rows: Sequence[Mapping[str, Any]]) -> str:
    columns = (
        "clearance", "walls", "peak temperature [degC]", "film force [kN]", "force lowered by [%]",
        "friction lowered by [%]", "peak pressure lowered by [%]", "critical mass [kg]",
        "critical mass lowered by [%]", "friction power [kW]", "heat to bush [kW]",
        "heat to shaft [kW]",
    )  # fmt: skip
    lines = [
        (
            f"{row['clearance']} µm", row["label"], f"{row['temperature']:.0f}",
            f"{row['load']:.1f}", f"{row['load_reduction']:.0f}",
            f"{row['friction_reduction']:.0f}", f"{row['pressure_reduction']:.0f}",
            shown(row["critical_mass"]), f"{row['critical_mass_reduction']:.0f}",
            f"{row['friction_power']:.1f}", f"{row['to_bush']:.2f}", f"{row['to_shaft']:z.2f}",
        )
        for row in rows
    ]  # fmt: skip
    return table(columns, lines)


def _growth(number: Mapping[tuple[str, str], Mapping[str, Any]]) -> str:
    """Say how far the critical mass and the film force move with a hot clearance."""
    kept = "bush_conduction_free_shaft"

    def of(variant: str) -> str:
        mass, fall = number[variant, "mass"]["value"], number[variant, "force_reduction"]["value"]
        if not math.isfinite(mass):
            return "has no steady state: hot shaft and bush close the clearance"
        return (
            f"heating lowers the film force by {fall:.0f} % and the critical mass to {mass:.0f} kg"
        )

    cold = number[kept, "mass"]["value"], number[kept, "force_reduction"]["value"]
    return (
        f"a free bush, hotter than the shaft, opens the clearance: {of('hot_free')}, against "
        f"{cold[1]:.0f} % and {cold[0]:.0f} kg in the clearance of the drawing. In a rigid "
        f"housing the hot bush closes on the shaft: {of('hot_rigid_housing')}"
    )


def _sensitivity(r: Results) -> dict[str, Any]:
    """Return what numerics and model move."""
    rows = sensitivity(r)
    number = {(row["variant"], row["quantity"]): row for row in rows}
    lowered = [line.key for line in HEADLINES if line.key.endswith("_reduction")]

    def largest(*variants: str) -> float:
        changes = [abs(number[variant, key]["change"]) for variant in variants for key in lowered]
        return max((c for c in changes if math.isfinite(c)), default=math.nan)

    def points(*variants: str) -> str:
        change = largest(*variants)
        known = f"{change:.1f} points"
        return known if math.isfinite(change) else "an unknown number of points (not converged)"

    percent = read_tolerances()["percent"].size
    lost = dict.fromkeys(row["label"] for row in rows if row["status"] != "converged")
    mixing = "bush_conduction_free_shaft_mixing"
    return {
        "mixing_fall": number[mixing, "force_reduction"]["value"],
        "mixing_mass": number[mixing, "mass"]["value"],
        "growth": _growth(number),
        "half_mesh": points("mesh_half"),
        "double_mesh": points("mesh_double"),
        "cavitation": points("half_sommerfeld", "full_sommerfeld", "jfo"),
        "inception": points("free_inception"),
        "inlet": points("inlet_mixing", "inlet_periodic"),
        "ruptured": points("friction_whole"),
        "wall_choice": points("bush_conduction", "bush_conduction_free_shaft", "insulated"),
        "mesh_verdict": f"An agreement within {percent:g} points is not an accident of the mesh; "
        "it is one with the walls and the inlet chosen."
        if largest("mesh_half", "mesh_double") < percent
        else "The mesh alone can make or break an agreement.",
        "lost": f" Left out where it did not converge: {'; '.join(lost)}." if lost else "",
        "sensitivity": _sensitivity_table(rows),
    }


def _sensitivity_table(rows: Sequence[Mapping[str, Any]]) -> str:
    papers = {claim.key: claim.paper for claim in read_claims()}
    claimed = (papers.get(line.claim) for line in HEADLINES)
    lines = [["the paper", *("-" if paper is None else f"{paper:g}" for paper in claimed)]]
    for first in range(0, len(rows), len(HEADLINES)):
        cells = rows[first : first + len(HEADLINES)]
        status = cells[0]["status"]
        ended = "" if status == "converged" else f" ({status})"
        lines.append([cells[0]["label"] + ended, *map(_moved, cells)])
    columns = ["c = 100 µm, 15 000 rpm", *(f"{line.label} [{line.unit}]" for line in HEADLINES)]
    return table(columns, lines)


def _moved(cell: Mapping[str, Any]) -> str:
    value, change, verdict = cell["value"], cell["change"], cell["verdict"]
    if not math.isfinite(value):
        return "-"
    sign = "+" if change >= 0.0 else "-"
    moved = f" ({sign}{shown(abs(change))})" if abs(change) > 1e-9 else ""
    mark = f" {MARKS[verdict]}" if verdict else ""
    return f"{shown(value)}{moved}{mark}"


def _tolerances() -> str:
    used: dict[Tolerance, set[str]] = {}
    for claim in read_claims():
        if claim.measure:
            used.setdefault(claim.tolerance, set()).add(claim.unit or "ratio")
    lines = []
    for tolerance, units in used.items():
        size = (
            f"{100.0 * tolerance.size:g} % of it" if tolerance.relative else f"{tolerance.size:g}"
        )
        size = "all" if tolerance.name == "share" else size
        trend = "yes" if tolerance.trend else "no"
        lines.append([size, ", ".join(sorted(units)), trend, tolerance.reason])
    return table(["tolerance", "of quantities in", "trend counts", "reason"], lines)
