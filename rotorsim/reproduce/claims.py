"""Every claim of the paper, in its order."""

from __future__ import annotations

from . import claims_dynamics, claims_film, claims_performance, claims_stability, claims_tables
from .claim import Claim

CLAIMS: tuple[Claim, ...] = (
    *claims_film.CLAIMS,
    *claims_performance.CLAIMS,
    *claims_dynamics.CLAIMS,
    *claims_tables.CLAIMS,
    *claims_stability.CLAIMS,
)
