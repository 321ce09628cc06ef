"""A paper's figures, tables and sentences computed again, each with a verdict.

Modules are imported when first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .assessment import Assessment, assess
    from .claim import Claim, Evidence, Tolerance, Verdict
    from .claims import CLAIMS
    from .results import PaperResults
    from .study import Study, compute, paper_study
    from .writing import write_docs, write_page

_HOMES = {
    "Assessment": "assessment",
    "CLAIMS": "claims",
    "Claim": "claim",
    "Evidence": "claim",
    "PaperResults": "results",
    "Study": "study",
    "Tolerance": "claim",
    "Verdict": "claim",
    "assess": "assessment",
    "compute": "study",
    "paper_study": "study",
    "write_docs": "writing",
    "write_page": "writing",
}

__all__ = [
    "CLAIMS",
    "Assessment",
    "Claim",
    "Evidence",
    "PaperResults",
    "Study",
    "Tolerance",
    "Verdict",
    "assess",
    "compute",
    "paper_study",
    "write_docs",
    "write_page",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
