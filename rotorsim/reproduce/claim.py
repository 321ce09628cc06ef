"""A claim of the paper, the evidence for it, and the verdict that follows from both."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING

from .results import NotComputed

if TYPE_CHECKING:
    from .results import PaperResults


class Verdict(StrEnum):
    """What the numbers say of a claim."""

    AGREES = "agrees"
    TREND = "agrees in trend"
    CONTRADICTS = "contradicts"
    UNDECIDED = "cannot be decided"


class Kind(StrEnum):
    """What a row compares."""

    PRINTED = "as printed"
    """The paper's words against our numbers."""
    READING = "other reading"
    """Another meaning of the same words against our numbers."""
    INTERNAL = "paper against itself"
    """One statement of the paper against what another one implies; none of our numbers."""


@dataclass(frozen=True)
class Tolerance:
    """How far apart two numbers may lie and still agree: fixed by kind of quantity.

    Attributes
    ----------
    size : float
        Absolute in the claim's unit, or a fraction of the paper's value.
    relative : bool
    trend : bool
        Whether right sign and less than a factor of two apart counts as a trend.
    reason : str
    """

    size: float
    relative: bool
    trend: bool
    reason: str

    def absolute(self, paper: float) -> float:
        """In the claim's unit."""
        return self.size * abs(paper) if self.relative else self.size

    def __str__(self) -> str:
        return f"{100.0 * self.size:g} % of it" if self.relative else f"{self.size:g}"


PERCENT = Tolerance(
    5.0, False, True, "percentages read off curves and printed in two digits; frame, node count "
    "and the count of the ruptured sector are not stated",
)  # fmt: skip
FORCE = Tolerance(0.10, True, False, "one or two digits, read off a curve")
TEMPERATURE = Tolerance(5.0, False, False, "read off a curve over some 50 degrees")
FACTOR = Tolerance(0.10, True, True, "two digits, read off curves")
STRAIGHT = Tolerance(
    2.0, False, False, "what the eye takes for straight or constant, in percent of the range"
)
NEARLY = Tolerance(0.10, True, False, "'nearly the same': a tenth")
SIMILAR = Tolerance(0.05, False, False, "correlation of curves that look alike")
AROUND = Tolerance(45.0, False, False, "'around': an eighth of a turn")
MESH = Tolerance(2.0, False, False, "a mesh study is passed at a percent or two")
EXACT = Tolerance(0.06, True, False, "the paper's own rounding to two digits")
SHARE = Tolerance(
    0.0, False, True, "every comparison must hold; three quarters of them make a trend"
)
NONE = Tolerance(0.0, False, False, "nothing to compare")

TREND_SHARE = 0.75
TREND_FACTOR = 2.0


@dataclass(frozen=True)
class Evidence:
    """What a claim is judged by.

    Attributes
    ----------
    value : float
        In the claim's unit; for statements the share of comparisons that hold. NaN: not known.
    detail : str
        What lies behind the value, in words and numbers.
    """

    value: float
    detail: str = ""


@dataclass(frozen=True)
class Claim:
    """One sentence, number or table cell of the paper.

    Attributes
    ----------
    key : str
        Unique name.
    where : str
        Place in the paper.
    quote : str
        Its words.
    quantity : str
        What is compared.
    unit : str
        Empty for ratios; ``share`` for statements.
    paper : float or None
        Number claimed; None where it is a statement.
    tolerance : Tolerance
    evaluate : callable or None
        From the results to the evidence; None: nothing can be compared.
    kind : Kind
    note : str
        What the reader should know about the comparison, whatever its outcome.
    """

    key: str
    where: str
    quote: str
    quantity: str
    unit: str
    paper: float | None
    tolerance: Tolerance
    evaluate: Callable[[PaperResults], Evidence] | None
    kind: Kind = Kind.PRINTED
    note: str = ""


@dataclass(frozen=True)
class Row:
    """A claim with its verdict."""

    claim: Claim
    evidence: Evidence
    verdict: Verdict
    reason: str


def judge(claim: Claim, results: PaperResults) -> Row:
    """Compare a claim with the results."""
    if claim.evaluate is None:
        return Row(claim, Evidence(math.nan), Verdict.UNDECIDED, claim.note)
    try:
        evidence = claim.evaluate(replace(results, strict=True))
    except NotComputed:
        evidence = Evidence(math.nan)
    verdict = _verdict(claim, evidence.value)
    words = [_comparison(claim, evidence, verdict), evidence.detail, claim.note]
    return Row(claim, evidence, verdict, " ".join(f"{w.rstrip('.')}." for w in words if w))


def _verdict(claim: Claim, value: float) -> Verdict:
    if not math.isfinite(value):
        return Verdict.UNDECIDED
    if claim.paper is None:
        if value == 1.0:
            return Verdict.AGREES
        return Verdict.TREND if value >= TREND_SHARE else Verdict.CONTRADICTS
    if abs(value - claim.paper) <= claim.tolerance.absolute(claim.paper):
        return Verdict.AGREES
    # Two numbers of one text either fit each other or they do not.
    if claim.kind is not Kind.INTERNAL and claim.tolerance.trend and _same_size(value, claim.paper):
        return Verdict.TREND
    return Verdict.CONTRADICTS


def _same_size(value: float, paper: float) -> bool:
    # The margin keeps an exact factor of two, which similar films have, on one side of the line.
    limit = TREND_FACTOR * (1.0 - 1e-6)
    return paper != 0.0 and 1.0 / limit < value / paper < limit


def _comparison(claim: Claim, evidence: Evidence, verdict: Verdict) -> str:
    if not math.isfinite(evidence.value):
        return "a point that is needed did not converge, or has no such value"
    if claim.paper is None:
        return ""
    gap = abs(evidence.value - claim.paper)
    allowed = claim.tolerance.absolute(claim.paper)
    unit = f" {claim.unit}" if claim.unit else ""
    other = "the paper's other statement gives" if claim.kind is Kind.INTERNAL else "computed"
    text = f"{other} {shown(evidence.value)}{unit}, {shown(gap)} from {claim.paper:g}"
    if verdict is Verdict.AGREES:
        return f"{text}: within {shown(allowed)}"
    if verdict is Verdict.TREND:
        return f"{text}: beyond {shown(allowed)}, but of the same sign and size"
    return f"{text}: beyond {shown(allowed)}"


def shown(value: float) -> str:
    """Three digits; rounding errors are zero.

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


def number(
    key: str, where: str, quote: str, quantity: str, unit: str, paper: float,
    tolerance: Tolerance, evaluate: Callable[[PaperResults], Evidence | float],
    kind: Kind = Kind.PRINTED, note: str = "",
) -> Claim:  # fmt: skip
    """A claim with a number."""

    def evidence(results: PaperResults) -> Evidence:
        found = evaluate(results)
        return found if isinstance(found, Evidence) else Evidence(float(found))

    return Claim(key, where, quote, quantity, unit, paper, tolerance, evidence, kind, note)


def statement(
    key: str, where: str, quote: str, quantity: str,
    evaluate: Callable[[PaperResults], Evidence], kind: Kind = Kind.PRINTED, note: str = "",
) -> Claim:  # fmt: skip
    """A claim in words."""
    return Claim(key, where, quote, quantity, "share", None, SHARE, evaluate, kind, note)


def internal(
    key: str, where: str, quote: str, quantity: str, unit: str, paper: float,
    tolerance: Tolerance, implied: float, note: str,
) -> Claim:  # fmt: skip
    """Two statements of the paper, one against what the other implies."""
    return number(
        key, where, quote, quantity, unit, paper, tolerance, lambda _: implied, Kind.INTERNAL, note
    )


def undecidable(key: str, where: str, quote: str, quantity: str, reason: str) -> Claim:
    """A claim that nothing printed allows to check."""
    return Claim(key, where, quote, quantity, "", None, NONE, None, Kind.PRINTED, reason)
