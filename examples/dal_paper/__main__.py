"""Compute the paper again and judge its claims: ``python examples/dal_paper --output reproduced``.

Writes ``dal.html``, and as CSV the claims with their verdicts, the curves, the walls and the
sensitivity; with ``--docs`` the documentation's page as well. Ends with 0, or with 1 if a point did
not converge.
"""

from __future__ import annotations

import argparse
import csv
import io
import math
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

if not __package__:  # run as a folder: its modules are those of the package dal_paper
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from dal_paper.claims import Judged, assess
from dal_paper.figures import draw
from dal_paper.page import count, html, markdown
from dal_paper.study import Results, compute, paper_mesh, scaled
from dal_paper.tables import sensitivity, wall_rows

IMAGES = "images/paper"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return its exit code."""
    options = _parser().parse_args(arguments)
    mesh = scaled(paper_mesh(), 0.5) if options.coarse else paper_mesh()
    results = compute(mesh, options.workers, _progress)
    rows = assess(results)
    files = write(results, rows, options.output, options.docs)
    for kind, numbers in count(rows).items():
        print(f"{kind}: " + ", ".join(f"{n} {verdict}" for verdict, n in numbers.items()))
    print("\n".join(f"wrote {path}" for path in files))
    lost = results.not_converged()
    for text in lost:
        print(f"not converged: {text}", file=sys.stderr)
    return 1 if lost else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python examples/dal_paper",
        description="Compute the figures and tables of A. Dal's paper; judge every claim.",
    )
    option = parser.add_argument
    option("--output", type=Path, default=Path(), metavar="DIR",
           help="folder of dal.html and the CSV files (default: this one)")  # fmt: skip
    option("--coarse", action="store_true", help="half the mesh: for a quick look")
    option("--docs", type=Path, metavar="DIR",
           help="write the documentation's page in this folder as well")  # fmt: skip
    option("--workers", type=_positive, default=os.cpu_count() or 1, metavar="N",
           help="number of processes (default: one for each core)")  # fmt: skip
    return parser


def _positive(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"must be 1 or more, not {text}")
    return number


def _progress(done: int, total: int) -> None:
    if done == total or done % 10 == 0:
        print(f"{done} of {total} parts computed", file=sys.stderr, flush=True)


def write(
    results: Results, rows: Sequence[Judged], output: Path, docs: Path | None = None
) -> list[Path]:
    """Write all files; return their paths."""
    text = markdown(results, rows, IMAGES)
    pictures = draw(results)
    claims = csv_text(map(claim_record, rows))
    files: dict[Path, str | bytes] = {
        output / "dal.html": html(text, pictures),
        output / "dal_claims.csv": claims,
        output / "dal_curves.csv": results.curves.to_dataframe()
        .dropna(subset=["status"])
        .to_csv(float_format="%.6g", lineterminator="\n"),
        output / "dal_walls.csv": csv_text(wall_rows(results)),
        output / "dal_sensitivity.csv": csv_text(sensitivity(results)),
    }
    if docs is not None:
        files |= {docs / "paper.md": text, docs / "data" / "paper_claims.csv": claims}
        files |= {docs / IMAGES / f"{name}.png": data for name, data in pictures.items()}
    for path, content in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    return list(files)


def claim_record(row: Judged) -> dict[str, Any]:
    """Return a claim and its verdict as a row of the CSV file."""
    claim = row.claim
    return {
        "key": claim.key,
        "where": claim.where,
        "quote": claim.quote,
        "compared": claim.kind,
        "quantity": claim.quantity,
        "unit": claim.unit,
        "paper": claim.paper,
        "computed": row.evidence.value,
        "tolerance": None if claim.paper is None else claim.tolerance.absolute(claim.paper),
        "tolerance_reason": claim.tolerance.reason,
        "verdict": row.verdict,
        "reason": row.reason,
    }


def csv_text(records: Iterable[Mapping[str, Any]]) -> str:
    """Return records as CSV: numbers with six digits, rounding errors as zero, NaN empty."""
    rows = [{name: _rounded(value) for name, value in record.items()} for record in records]
    stream = io.StringIO()
    writer = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()


def _rounded(value: Any) -> Any:
    if not isinstance(value, float):
        return value
    if not math.isfinite(value):
        return None
    return 0.0 if abs(value) < 1e-9 else float(f"{value:.6g}")


if __name__ == "__main__":
    sys.exit(main())
