"""Tables 2 and 3 of the paper, cell by cell."""

from __future__ import annotations

from .claim import PERCENT, Claim, number
from .evidence import reduced

TABLE_2 = {
    100e-6: {"kxx": 33.3, "kyy": 42.1, "kxy": 38.0, "kyx": 17.6},
    125e-6: {"kxx": 28.2, "kyy": 40.0, "kxy": 30.0, "kyx": 14.2},
    150e-6: {"kxx": 24.0, "kyy": 28.5, "kxy": 26.6, "kyx": 12.0},
}
"""Reduction of stiffness by heating at 15 000 rpm [%]."""
TABLE_3 = {
    # The first cyy is printed "53.9.1"; 53.9 is read.
    100e-6: {"cxx": 43.2, "cyy": 53.9, "cxy": 55.8, "cyx": 56.2},
    125e-6: {"cxx": 31.2, "cyy": 38.7, "cxy": 38.0, "cyx": 34.0},
    150e-6: {"cxx": 29.3, "cyy": 38.5, "cxy": 37.5, "cyx": 33.3},
}
"""Reduction of damping by heating at 15 000 rpm [%]."""


def _cells(table: dict[float, dict[str, float]], where: str) -> list[Claim]:
    cells = []
    for clearance, row in table.items():
        for name, paper in row.items():
            misprint = name == "cyy" and clearance == 100e-6
            micrometres = round(clearance * 1e6)
            cells.append(
                number(
                    f"{where.lower().replace(' ', '-')}-{name}-{micrometres}", where,
                    "53.9.1" if misprint else f"{paper:g}",
                    f"reduction of {name}, c = {micrometres} um, 15 000 rpm, load frame", "%",
                    paper, PERCENT, reduced(name, clearance),
                    note="Misprinted; 53.9 is read" if misprint else "",
                )
            )  # fmt: skip
    return cells


CLAIMS = (*_cells(TABLE_2, "Table 2"), *_cells(TABLE_3, "Table 3"))
