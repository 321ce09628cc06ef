"""The paper's claims, read from ``claims.csv``, and the verdict on each."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from . import measures
from .measures import Evidence, NotComputedError
from .study import DAMPING, STIFFNESS, Results

FOLDER = Path(__file__).parent
GROUPS = {
    "stiffness": STIFFNESS,
    "damping": DAMPING,
    "static": ("load", "friction_force", "power_loss", "max_pressure"),
}
"""Words of the column ``measure`` that stand for several quantities."""
TREND_SHARE = 0.75
TREND_FACTOR = 2.0


class Verdict(StrEnum):
    """What the numbers say of a claim."""

    AGREES = "agrees"
    TREND = "agrees in trend"
    CONTRADICTS = "contradicts"
    UNDECIDED = "cannot be decided"


class Kind(StrEnum):
    """What is compared."""

    PRINTED = "as printed"
    """The paper's words with our numbers."""
    READING = "other reading"
    """Another meaning of the same words with our numbers."""
    INTERNAL = "paper against itself"
    """One statement of the paper with what another one implies; none of our numbers."""


@dataclass(frozen=True)
class Tolerance:
    """How far apart two numbers may lie and still agree: one for each kind of quantity.

    Attributes
    ----------
    name : str
    size : float
        Absolute in the claim's unit, or a fraction of the paper's value.
    relative : bool
    trend : bool
        Whether right sign and less than a factor of two apart counts as a trend.
    reason : str
    """

    name: str
    size: float
    relative: bool
    trend: bool
    reason: str

    def absolute(self, paper: float) -> float:
        """Return the tolerance in the claim's unit."""
        return self.size * abs(paper) if self.relative else self.size


@dataclass(frozen=True)
class Claim:
    """One sentence, number or table cell of the paper: a row of ``claims.csv``.

    Attributes
    ----------
    key : str
    where, quote : str
        Place in the paper, and its words.
    kind : Kind
    quantity : str
        What is compared.
    unit : str
        Empty for ratios; ``share`` for statements.
    paper : float or None
        Number claimed; None for statements.
    tolerance : Tolerance
    measure : str
        See `measures`; empty where nothing can be compared.
    remark : str
        What the reader should know about the comparison, whatever its outcome.
    """

    key: str
    where: str
    quote: str
    kind: Kind
    quantity: str
    unit: str
    paper: float | None
    tolerance: Tolerance
    measure: str
    remark: str

    def evaluate(self, results: Results) -> Evidence:
        """Return what the measure gives; NaN where a point that it needs did not converge."""
        name, *words = self.measure.split()
        names: list[str] = []
        options: dict[str, Any] = {}
        for word in words:
            option, equals, text = word.partition("=")
            if equals:
                options[option] = _number(text)
            else:
                names += GROUPS.get(word, (word,))
        try:
            found = getattr(measures, name)(results, *names, **options)
        except NotComputedError:
            found = math.nan
        return found if isinstance(found, Evidence) else Evidence(float(found))


def _number(text: str) -> int | float | str:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def _rows(name: str) -> list[dict[str, str]]:
    with (FOLDER / name).open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def read_tolerances() -> dict[str, Tolerance]:
    """Return the rows of ``tolerances.csv`` by name."""
    return {
        row["name"]: Tolerance(
            row["name"],
            float(row["size"]),
            row["relative"] == "yes",
            row["trend"] == "yes",
            row["reason"],
        )
        for row in _rows("tolerances.csv")
    }


def read_claims() -> list[Claim]:
    """Return the rows of ``claims.csv``, in the paper's order."""
    tolerances = read_tolerances()
    return [
        Claim(
            **{name: row[name] for name in ("key", "where", "quote", "quantity", "unit")},
            kind=Kind(row["compared"]),
            paper=float(row["paper"]) if row["paper"] else None,
            tolerance=tolerances[row["tolerance"]],
            measure=row["measure"],
            remark=row["remark"],
        )
        for row in _rows("claims.csv")
    ]


@dataclass(frozen=True)
class Judged:
    """A claim with its evidence and verdict."""

    claim: Claim
    evidence: Evidence
    verdict: Verdict
    reason: str


def assess(results: Results, claims: Sequence[Claim] | None = None) -> list[Judged]:
    """Judge every claim."""
    return [judge(claim, results) for claim in (read_claims() if claims is None else claims)]


def judge(claim: Claim, results: Results) -> Judged:
    """Compare a claim with the results."""
    if not claim.measure:
        return Judged(claim, Evidence(math.nan), Verdict.UNDECIDED, claim.remark)
    evidence = claim.evaluate(results)
    found = verdict(claim, evidence.value)
    words = [_comparison(claim, evidence.value, found), evidence.detail, claim.remark]
    return Judged(claim, evidence, found, " ".join(f"{w.rstrip('.')}." for w in words if w))


def verdict(claim: Claim, value: float) -> Verdict:
    """Return the verdict on a claim for which `value` was computed."""
    if not math.isfinite(value):
        return Verdict.UNDECIDED
    if claim.paper is None:
        if value == 1.0:
            return Verdict.AGREES
        return Verdict.TREND if value >= TREND_SHARE else Verdict.CONTRADICTS
    if abs(value - claim.paper) <= claim.tolerance.absolute(claim.paper):
        return Verdict.AGREES
    # Two numbers of one text either fit each other or they do not.
    internal = claim.kind is Kind.INTERNAL
    if not internal and claim.tolerance.trend and _same_size(value, claim.paper):
        return Verdict.TREND
    return Verdict.CONTRADICTS


def _same_size(value: float, paper: float) -> bool:
    # The margin keeps an exact factor of two, which similar films have, on one side of the line.
    limit = TREND_FACTOR * (1.0 - 1e-6)
    return paper != 0.0 and 1.0 / limit < value / paper < limit


def _comparison(claim: Claim, value: float, found: Verdict) -> str:
    if not math.isfinite(value):
        return "a point that is needed did not converge, or has no such value"
    if claim.paper is None:
        return ""
    allowed = shown(claim.tolerance.absolute(claim.paper))
    other = "the paper's other statement gives" if claim.kind is Kind.INTERNAL else "computed"
    number = f"{shown(value)} {claim.unit}".strip()
    text = f"{other} {number}, {shown(abs(value - claim.paper))} from {claim.paper:g}"
    if found is Verdict.AGREES:
        return f"{text}: within {allowed}"
    trend = ", but of the same sign and size" if found is Verdict.TREND else ""
    return f"{text}: beyond {allowed}{trend}"


def shown(value: float) -> str:
    """Return three digits; rounding errors as zero.

    Examples
    --------
    >>> shown(34.128), shown(1e-13), shown(1233.5), shown(0.482)
    ('34.1', '0', '1234', '0.482')
    """
    if not math.isfinite(value):
        return "-"
    if abs(value) < 1e-9:
        return "0"
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"
