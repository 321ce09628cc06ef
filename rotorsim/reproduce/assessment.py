"""All verdicts on one set of results."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from .claim import Claim, Kind, Row, Verdict, judge
from .claims import CLAIMS
from .results import PaperResults


@dataclass(frozen=True)
class Assessment:
    """Rows in the paper's order."""

    rows: tuple[Row, ...]

    def count(self, kind: Kind | None = None) -> dict[Verdict, int]:
        """Rows of each verdict."""
        found = Counter(row.verdict for row in self.rows if kind in (None, row.claim.kind))
        return {verdict: found[verdict] for verdict in Verdict}

    def of_kind(self, kind: Kind) -> list[Row]:
        """Rows of one kind."""
        return [row for row in self.rows if row.claim.kind is kind]


def assess(results: PaperResults, claims: Sequence[Claim] = CLAIMS) -> Assessment:
    """Judge every claim."""
    return Assessment(tuple(judge(claim, results) for claim in claims))
