"""Which axes the paper's coefficients belong to: candidates against its qualitative statements.

The text does not say along what its x and y lie: the load, the line of centres, or neither. Each
candidate frame is asked what section 4.2 says of K and C. No verdict rests on the frame found.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .claims_tables import TABLE_2, TABLE_3
from .paper import CLEARANCES
from .results import DAMPING, ISOTHERMAL, STIFFNESS, THD, Array, PaperResults, Run, reduction

EXCHANGE = np.array([[0.0, 1.0], [1.0, 0.0]])
QUARTER_TURN = np.array([[0.0, 1.0], [-1.0, 0.0]])
MIRROR = np.diag([1.0, -1.0])
STEP = 2
"""Of the search over orientations [deg]."""


@dataclass(frozen=True)
class Frame:
    """Axes in which K and C are written: rows of `axes` in the load or line-of-centres frame."""

    label: str
    along_centers: bool
    axes: Array
    transposed: bool = False


FRAMES = (
    Frame("x along the load, y ahead of it (load frame)", False, np.eye(2)),
    Frame("load frame, y reversed", False, MIRROR),
    Frame("load frame turned by 90 deg: y against the load", False, QUARTER_TURN),
    Frame("load frame, x and y exchanged", False, EXCHANGE),
    Frame("load frame, x and y exchanged, k_ij read as force j by motion i", False, EXCHANGE, True),
    Frame("x along the line of centres", True, np.eye(2)),
    Frame("line of centres, y reversed", True, MIRROR),
    Frame("line of centres, x and y exchanged", True, EXCHANGE),
)


@dataclass(frozen=True)
class FrameScore:
    """How a frame does.

    Attributes
    ----------
    frame : Frame
    statements : dict
        Each qualitative statement and whether it holds (c = 100 um, 15 000 rpm).
    table_2, table_3 : float
        Root mean square distance from the tables' twelve cells [points].
    """

    frame: Frame
    statements: dict[str, bool]
    table_2: float
    table_3: float

    @property
    def held(self) -> int:
        """Statements that hold."""
        return sum(self.statements.values())


def score_frames(r: PaperResults) -> list[FrameScore]:
    """Every candidate against the statements of section 4.2."""
    return [score(r, frame) for frame in FRAMES]


def best_orientation(r: PaperResults, *, as_printed: bool = False) -> FrameScore:
    """Of every direction of x, the frame that meets most statements; ties go to Table 2.

    Parameters
    ----------
    r : PaperResults
    as_printed : bool
        Only right-handed axes with the indices as printed; otherwise both hands and both orders.
    """
    other = (False,) if as_printed else (False, True)
    found = [
        score(r, _turned(degrees, along_centers, mirrored, transposed))
        # A half turn changes no coefficient.
        for degrees in range(0, 180, STEP)
        for along_centers in (False, True)
        for mirrored in other
        for transposed in other
    ]
    return max(found, key=lambda s: (s.held, -s.table_2))


def _turned(degrees: float, along_centers: bool, mirrored: bool, transposed: bool) -> Frame:
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    axes = np.array([[cos, sin], [-sin, cos]])
    label = f"x {degrees:g} deg ahead of the {'line of centres' if along_centers else 'load'}"
    label += ", y reversed" if mirrored else ""
    label += ", k_ij read as force j by motion i" if transposed else ""
    return Frame(label, along_centers, MIRROR @ axes if mirrored else axes, transposed)


def score(r: PaperResults, frame: Frame) -> FrameScore:
    """One candidate."""
    cold, warm = (_matrices(r, frame, model, CLEARANCES[0]) for model in (ISOTHERMAL, THD))
    k, c, fall = cold, cold, {n: reduction(cold[n], warm[n]) for n in (*STIFFNESS, *DAMPING)}
    stiff, damp = [{n: fall[n] for n in names} for names in (STIFFNESS, DAMPING)]
    statements = {
        "kxy is the highest": max(STIFFNESS, key=k.__getitem__) == "kxy",
        "kyx is negative": k["kyx"] < 0.0,
        "kyy is the lowest positive one": min(
            (n for n in STIFFNESS if k[n] > 0.0), key=k.__getitem__
        )
        == "kyy",
        "heat lowers kyy most": max(stiff, key=stiff.__getitem__) == "kyy",
        "heat lowers kyx least": min(stiff, key=stiff.__getitem__) == "kyx",
        "cxx and cyy exceed cxy and cyx": min(c["cxx"], c["cyy"]) > max(c["cxy"], c["cyx"]),
        "isothermal cxx and cyy within 10 %": abs(c["cyy"] / c["cxx"] - 1.0) <= 0.1,
        "thermal cxx above cyy": warm["cxx"] > warm["cyy"],
        "heat lowers cxx least": min(damp, key=damp.__getitem__) == "cxx",
    }
    return FrameScore(frame, statements, _distance(r, frame, TABLE_2), _distance(r, frame, TABLE_3))


def _matrices(r: PaperResults, frame: Frame, model: str, clearance: float) -> dict[str, float]:
    """All eight coefficients at the top speed."""
    run = Run(model, clearance)
    point = r.curves[run][-1]
    axes = frame.axes
    if frame.along_centers:
        cos, sin = np.cos(point.attitude_angle), np.sin(point.attitude_angle)
        axes = axes @ np.array([[cos, sin], [-sin, cos]])
    found: dict[str, float] = {}
    for letter, matrix in (("k", point.stiffness), ("c", point.damping)):
        turned = axes @ matrix @ axes.T
        turned = turned.T if frame.transposed else turned
        for i in (0, 1):
            for j in (0, 1):
                found[f"{letter}{'xy'[i]}{'xy'[j]}"] = float(turned[i, j])
    return found


def _distance(r: PaperResults, frame: Frame, table: dict[float, dict[str, float]]) -> float:
    gaps = []
    for clearance, row in table.items():
        cold, warm = (_matrices(r, frame, model, clearance) for model in (ISOTHERMAL, THD))
        gaps += [reduction(cold[name], warm[name]) - paper for name, paper in row.items()]
    return float(np.sqrt(np.mean(np.square(gaps))))
