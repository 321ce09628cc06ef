"""The page: verdicts, figures, walls, sensitivity, and what to believe."""

from __future__ import annotations

from collections.abc import Sequence

from .assessment import Assessment
from .blocks import MARKS, Block, Grid, Heading, Items, Paragraph, Picture
from .claim import SHARE, TREND_FACTOR, Claim, Kind, Row, Tolerance, Verdict, shown
from .claims import CLAIMS
from .figures import WALL_NAMES
from .frames import best_orientation, score_frames
from .paper import COARSE_MESH, Walls
from .remarks import designer_remarks, force_and_friction, frame_remark, sensitivity_remark
from .results import PaperResults
from .tables import HEADLINES, Cell, sensitivity, wall_rows, wall_verdicts

TITLE = "The paper, line by line: journal bearing with variable viscosity (Dal)"
LEGEND = "✓ agrees, ~ agrees in trend, ✗ contradicts, ? cannot be decided"


def page(
    r: PaperResults, assessment: Assessment, pictures: Sequence[tuple[str, str]]
) -> list[Block]:
    """Everything that the page says; `pictures` are (name, caption)."""
    return [
        Heading(1, TITLE),
        *_summary(r, assessment),
        Heading(2, "Figures"),
        Paragraph("Black crosses are numbers printed in the paper's text; its curves are not in "
                  "the text and are not redrawn."),
        *(Picture(name, caption) for name, caption in pictures),
        Heading(2, "Every claim"),
        Paragraph("In the paper's order; tolerances and verdicts are explained in the last "
                  "section. The computed value of a statement is the share of comparisons that "
                  "hold."),
        claim_grid(assessment.rows),
        *_remarks(r),
        *_frames(r),
        *_walls(r),
        *_sensitivity(r),
        *_tolerances(),
    ]  # fmt: skip


def _summary(r: PaperResults, assessment: Assessment) -> list[Block]:
    mesh = r.mesh
    counts = [
        [kind.value, *(str(assessment.count(kind)[verdict]) for verdict in Verdict)]
        for kind in Kind
    ]
    against = [
        f"{row.claim.where}: “{row.claim.quote}” - {row.claim.quantity}: {_computed(row)}"
        f"{_rescued(row, assessment)}"
        for row in assessment.of_kind(Kind.PRINTED)
        if row.verdict is Verdict.CONTRADICTS
    ]
    coarse = " (coarse: for a quick look)" if mesh == COARSE_MESH else ""
    return [
        Paragraph(
            "A. Dal, “Effects of the shaft speed on stiffness and damping coefficients of "
            "hydrodynamic bearing-shaft system under variable viscosity”, recomputed with "
            "rotorsim reproduce dal. Every figure, table cell, number and statement is compared "
            "with a computed value. Tolerances belong to the kind of quantity, not to the row; "
            "nothing is tuned to make a row agree."
        ),
        Paragraph(
            "Base model: Reynolds rupture, film begun at maximum thickness with fresh oil at "
            "ambient temperature, both walls at ambient temperature, viscosity falling with 0.034 "
            f"per kelvin, eccentricity ratio 0.5; mesh {mesh.circumferential} x {mesh.axial} x "
            f"{mesh.cross_film} cells around, along and across the film{coarse}."
        ),
        Grid(["rows", *(verdict.value for verdict in Verdict)], counts),
        Paragraph("Contradicted as printed:"),
        Items(against),
    ]


def _rescued(row: Row, assessment: Assessment) -> str:
    """Say under which other reading the same words agree."""
    found = [
        other.claim.quantity
        for other in assessment.of_kind(Kind.READING)
        if other.claim.where == row.claim.where
        and other.claim.paper == row.claim.paper
        and (other.claim.quote in row.claim.quote or row.claim.quote in other.claim.quote)
        and other.verdict is Verdict.AGREES
    ]
    return f"; agrees if read as: {found[0]}" if found else ""


def claim_grid(rows: Sequence[Row]) -> Grid:
    """The claims as a table."""
    columns = (
        "where", "claim", "compared", "quantity", "paper", "computed", "tolerance", "verdict",
        "reason",
    )  # fmt: skip
    return Grid(
        columns,
        [
            [
                row.claim.where, row.claim.quote, row.claim.kind.value, row.claim.quantity,
                _paper(row.claim), _computed(row), _tolerance(row.claim), row.verdict.value,
                row.reason,
            ]
            for row in rows
        ],
    )  # fmt: skip


def _paper(claim: Claim) -> str:
    return "-" if claim.paper is None else f"{claim.paper:.4g} {claim.unit}".strip()


def _computed(row: Row) -> str:
    value = row.evidence.value
    if row.claim.unit == "share":
        return "-" if value != value else f"{100.0 * value:.0f} % hold"
    return f"{shown(value)} {row.claim.unit}".strip() if value == value else "-"


def _tolerance(claim: Claim) -> str:
    if claim.paper is None:
        return "all" if claim.tolerance is SHARE else "-"
    return f"{shown(claim.tolerance.absolute(claim.paper))} {claim.unit}".strip()


def _remarks(r: PaperResults) -> list[Block]:
    return [
        Heading(2, "Film force and friction: which part of the film was counted"),
        *(Paragraph(text) for text in force_and_friction(r)),
    ]


def _frames(r: PaperResults) -> list[Block]:
    scores = [*score_frames(r), best_orientation(r, as_printed=True), best_orientation(r)]
    names = list(scores[0].statements)
    rows = [
        [
            score.frame.label,
            *(MARKS[Verdict.AGREES if held else Verdict.CONTRADICTS]
              for held in score.statements.values()),
            f"{score.held} of {len(names)}", shown(score.table_2), shown(score.table_3),
        ]
        for score in scores
    ]  # fmt: skip
    columns = ["axes", *names, "hold", "Table 2 [points]", "Table 3 [points]"]
    return [
        Heading(2, "Which axes the coefficients belong to"),
        *(Paragraph(text) for text in frame_remark(r)),
        Grid(columns, rows),
        Paragraph("At c = 100 um and 15 000 rpm. The last two rows come from the search; the last "
                  "columns are root mean square distances from the twelve cells of each table."),
    ]  # fmt: skip


def _walls(r: PaperResults) -> list[Block]:
    rows = [
        [
            f"{row.radial_clearance * 1e6:.0f} um", WALL_NAMES[row.walls],
            f"{row.temperature:.0f}", f"{row.load / 1e3:.1f}", f"{row.force_reduction:.0f}",
            f"{row.friction_reduction:.0f}", f"{row.pressure_reduction:.0f}",
            shown(row.critical_mass), f"{row.mass_reduction:.0f}",
            f"{row.friction_power / 1e3:.1f}", f"{row.to_bush / 1e3:.2f}",
            f"{row.to_shaft / 1e3:z.2f}",
        ]
        for row in wall_rows(r)
    ]  # fmt: skip
    columns = (
        "clearance", "walls", "peak temperature [degC]", "film force [kN]", "force lowered by [%]",
        "friction lowered by [%]", "peak pressure lowered by [%]", "critical mass [kg]",
        "critical mass lowered by [%]", "friction power [kW]", "heat to bush [kW]",
        "heat to shaft [kW]",
    )  # fmt: skip
    verdicts = [
        [
            f"{claim.where}: {claim.quantity}", _paper(claim),
            *(f"{shown(judged[walls].evidence.value)} {MARKS[judged[walls].verdict]}"
              for walls in Walls),
        ]
        for claim, judged in wall_verdicts(r)
    ]  # fmt: skip
    return [
        Heading(2, "Both readings of the walls"),
        *(Paragraph(text) for text in designer_remarks(r)),
        Grid(columns, rows),
        Paragraph(f"All at 15 000 rpm. The paper's heated numbers under each reading: {LEGEND}."),
        Grid(["claim", "paper", *(WALL_NAMES[walls] for walls in Walls)], verdicts),
    ]


def _sensitivity(r: PaperResults) -> list[Block]:
    rows = []
    for row in sensitivity(r):
        cells = [_moved(row.cells[line.key]) for line in HEADLINES]
        ended = "" if row.status == "converged" else f" ({row.status})"
        rows.append([row.variant.label + ended, *cells])
    claimed = [
        "-" if line.claim is None or line.claim.paper is None else f"{line.claim.paper:g}"
        for line in HEADLINES
    ]
    columns = ["c = 100 um, 15 000 rpm", *(f"{line.label} [{line.unit}]" for line in HEADLINES)]
    return [
        Heading(2, "How much each choice matters"),
        Paragraph(sensitivity_remark(r)),
        Grid(columns, [["the paper", *claimed], *rows]),
        Paragraph(f"In brackets the change against the base. {LEGEND}; both frictions are judged "
                  "against the paper's, whichever part of the ruptured sector they count."),
    ]  # fmt: skip


def _moved(cell: Cell) -> str:
    if cell.value != cell.value:
        return "-"
    sign = "+" if cell.change >= 0.0 else "-"
    change = f" ({sign}{shown(abs(cell.change))})" if abs(cell.change) > 1e-9 else ""
    mark = f" {MARKS[cell.verdict]}" if cell.verdict else ""
    return f"{shown(cell.value)}{change}{mark}"


def _tolerances() -> list[Block]:
    used: dict[Tolerance, set[str]] = {}
    for claim in CLAIMS:
        if claim.evaluate is not None:
            used.setdefault(claim.tolerance, set()).add(claim.unit or "ratio")
    rows = [
        ["all" if tolerance is SHARE else str(tolerance), ", ".join(sorted(units)),
         "yes" if tolerance.trend else "no", tolerance.reason]
        for tolerance, units in used.items()
    ]  # fmt: skip
    return [
        Heading(2, "Tolerances and verdicts"),
        Paragraph(
            "A number agrees within its tolerance. Where a trend counts, a number of the same sign "
            f"and less than {TREND_FACTOR:g} times apart agrees in trend; a statement does so when "
            "three quarters of its comparisons hold. Anything else contradicts. What rests on data "
            "that the paper does not print, or on a point that did not converge, cannot be "
            "decided. Numbers of the paper held against one another either agree or contradict."
        ),
        Grid(["tolerance", "of quantities in", "trend counts", "reason"], rows),
    ]
