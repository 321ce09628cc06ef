"""Plain columns: speed, four stiffnesses, four dampings, as many rotor programs import."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..atomic import write_text
from ..table.variables import COEFFICIENTS, CONVENTIONS
from .curves import RPM, Curve

_WIDTH = 16


def write(curve: Curve, path: Path) -> Path:
    """Write one curve; lines beginning with ``#`` say what the numbers mean."""
    names = ["rpm", *COEFFICIENTS]
    units = ["1/min", *["N/m"] * 4, *["N*s/m"] * 4]
    head = [
        *(line for fact in curve.facts for line in fact.splitlines()),
        *CONVENTIONS,
        "".join(f"{name:>{_WIDTH}}" for name in names)[2:],
        "".join(f"{unit:>{_WIDTH}}" for unit in units)[2:],
    ]
    values = np.column_stack(
        [curve.speed * RPM, curve.stiffness.reshape(-1, 4), curve.damping.reshape(-1, 4)]
    )
    rows = ["".join(f"{value:{_WIDTH}.8e}" for value in row) for row in values]
    write_text(path, "\n".join([*(f"# {line}" for line in head), *rows]) + "\n")
    return path
