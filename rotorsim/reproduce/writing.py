"""Files: one HTML page and CSV for a reader, the same as a documentation page."""

from __future__ import annotations

import csv
import io
import math
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from ..atomic import replacing, write_text
from ..bearing.operating_point import plain
from .assessment import Assessment
from .blocks import to_html, to_markdown
from .claim import Row
from .figures import WALL_NAMES, NamedFigure, paper_figures
from .frames import score_frames
from .page import TITLE, page
from .paper import RAD_PER_RPM
from .results import DAMPING, STIFFNESS, PaperResults, quantity
from .tables import HEADLINES, sensitivity, wall_rows

DPI = 90
CURVE_QUANTITIES = (
    "load", "friction_force", "power_loss", "max_pressure", "temperature", "attitude_angle",
    *STIFFNESS, *DAMPING, "critical_mass", "critical_mass_dimensionless", "whirl_frequency_ratio",
)  # fmt: skip


def write_page(r: PaperResults, assessment: Assessment, folder: Path) -> list[Path]:
    """Write ``dal.html``, ``dal_claims.csv``, ``dal_curves.csv`` and ``dal_sensitivity.csv``."""
    figures = paper_figures(r)
    blocks = page(r, assessment, [(f.name, f.caption) for f in figures])
    pictures = {figure.name: png(figure) for figure in figures}
    texts = {
        "dal.html": to_html(TITLE, blocks, pictures),
        "dal_claims.csv": claims_csv(assessment),
        "dal_curves.csv": curves_csv(r),
        "dal_sensitivity.csv": sensitivity_csv(r),
    }
    for name, text in texts.items():
        write_text(folder / name, text)
    return [folder / name for name in texts]


def write_docs(r: PaperResults, assessment: Assessment, folder: Path) -> list[Path]:
    """Write ``paper.md``, its figures and ``data/paper_claims.csv`` into a docs folder."""
    figures = paper_figures(r)
    blocks = page(r, assessment, [(f.name, f.caption) for f in figures])
    written = [folder / "paper.md", folder / "data" / "paper_claims.csv"]
    write_text(written[0], to_markdown(blocks, "images/paper"))
    write_text(written[1], claims_csv(assessment))
    for figure in figures:
        path = folder / "images" / "paper" / f"{figure.name}.png"
        with replacing(path) as temporary:
            temporary.write_bytes(png(figure))
        written.append(path)
    return written


def png(figure: NamedFigure) -> bytes:
    """A figure as PNG."""
    from ..show.figures import save_figure

    with tempfile.TemporaryDirectory() as folder:
        (path,) = save_figure(figure.figure, Path(folder) / figure.name, ("png",), dpi=DPI)
        return path.read_bytes()


def claim_record(row: Row) -> dict[str, Any]:
    """One claim as a flat record; numbers with six digits, rounding errors as zero."""
    claim = row.claim
    return {
        "key": claim.key,
        "where": claim.where,
        "quote": claim.quote,
        "compared": claim.kind.value,
        "quantity": claim.quantity,
        "unit": claim.unit,
        "paper": _number(claim.paper),
        "computed": _number(row.evidence.value),
        "tolerance": None
        if claim.paper is None
        else _number(claim.tolerance.absolute(claim.paper)),
        "tolerance_reason": claim.tolerance.reason,
        "verdict": row.verdict.value,
        "reason": row.reason,
    }


def _number(value: float | None) -> float | None:
    if value is None or not math.isfinite(value):
        return None
    return 0.0 if abs(value) < 1e-9 else float(f"{value:.6g}")


def claims_csv(assessment: Assessment) -> str:
    """Every claim and verdict."""
    return _csv([claim_record(row) for row in assessment.rows])


def curves_csv(r: PaperResults) -> str:
    """Every curve of figures 4 to 8 and of the walls (SI; temperature in degC, speed in rpm)."""
    return _csv(
        {
            "thermal_model": run.thermal_model,
            "walls": run.walls.value,
            "friction": run.friction,
            "radial_clearance": run.radial_clearance,
            "speed_rpm": _number(point.speed / RAD_PER_RPM),
            "status": point.status.value,
            **{name: _number(quantity(point, name)) for name in CURVE_QUANTITIES},
        }
        for run, points in r.curves.items()
        for point in points
    )


def sensitivity_records(r: PaperResults) -> list[dict[str, Any]]:
    """Headline numbers of every variant."""
    return [
        {
            "variant": row.variant.key,
            "label": row.variant.label,
            "status": row.status,
            "quantity": line.key,
            "unit": line.unit,
            "value": _number(row.cells[line.key].value),
            "change": _number(row.cells[line.key].change),
            "verdict": plain(row.cells[line.key].verdict),
        }
        for row in sensitivity(r)
        for line in HEADLINES
    ]


def sensitivity_csv(r: PaperResults) -> str:
    """The sensitivity table, one number a line."""
    return _csv(sensitivity_records(r))


def document(r: PaperResults, assessment: Assessment, files: Sequence[Path]) -> dict[str, Any]:
    """Everything for programs."""
    return {
        "paper": TITLE,
        "mesh": vars(r.mesh),
        "counts": assessment.count(),
        "claims": [claim_record(row) for row in assessment.rows],
        "walls": [vars(row) | {"label": WALL_NAMES[row.walls]} for row in wall_rows(r)],
        "sensitivity": sensitivity_records(r),
        "frames": [
            {"axes": s.frame.label, "statements": s.statements, "table_2": s.table_2,
             "table_3": s.table_3}
            for s in score_frames(r)
        ],
        "files": list(files),
    }  # fmt: skip


def _csv(records: Iterable[dict[str, Any]]) -> str:
    rows = list(records)
    stream = io.StringIO()
    writer = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()
