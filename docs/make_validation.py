"""Run the validation against published numbers; write its tables and figures into the site.

``python docs/make_validation.py`` writes (two or three minutes) ``docs/validation/*.md`` and
``docs/images/validation/*.png``. ``tests/validation`` has the bounds. Orbits have a module of their
own, ``orbit_validation``.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]
mpl.use("agg")

import film_cases as cases  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402

from rotorsim.bearing.operating_point import OperatingPoint  # noqa: E402
from rotorsim.bearing.solve import solve_case  # noqa: E402

IMAGES = ROOT / "docs" / "images" / "validation"
MESH = (320, 96)
RATIOS = (1.0, 0.5, 0.25)
NAMES = ("Kxx", "Kxy", "Kyx", "Kyy", "Bxx", "Bxy", "Byx", "Byy")
Row = dict[str, float]


def solved(eccentricity: float, ratio: float, **more) -> OperatingPoint:
    """Isoviscous film of the tests' bearing."""
    mesh = more.pop("mesh", MESH)
    case = cases.isothermal_case(eccentricity, length_to_diameter=ratio, mesh=mesh, **more)
    point, _ = solve_case(case, cases.SPEED)
    if not point.converged:
        raise RuntimeError(f"eps {eccentricity}, L/D {ratio}: {point.status} {point.message}")
    return point


def table(head: Sequence[str], rows: Iterable[Sequence[str]], words: int = 0) -> str:
    """Markdown table, numbers to the right; the first `words` columns are text."""
    lines = [
        "| " + " | ".join(head) + " |",
        "|" + " --- |" * words + " ---: |" * (len(head) - words),
    ]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows), ""])


def percent(found: float, listed: float) -> str:
    """Relative difference in per cent."""
    return apart(100.0 * found / listed, 100.0)


def apart(found: float, listed: float, digits: int = 2) -> str:
    """Difference, without a negative zero."""
    return f"{round(found - listed, digits) + 0.0:+.{digits}f}"


def write(name: str, text: str) -> None:
    """Write one table of the page `validation`."""
    (ROOT / "docs" / "validation" / f"{name}.md").write_text(text, encoding="utf-8")


def picture(name: str, figure) -> None:
    """Write one figure."""
    figure.savefig(IMAGES / f"{name}.png", dpi=90)
    plt.close(figure)


def butenschoen() -> None:
    """Load, attitude and side flow of the full bearing."""
    rows = [
        r for r in cases.reference_rows("butenschoen1976_full360.csv")
        if r["B_over_D"] in RATIOS and r["epsilon"] <= 0.98
    ]  # fmt: skip
    found, lines = [], []
    for row in rows:
        point = solved(row["epsilon"], row["B_over_D"])
        so = 1.0 / (2.0 * math.pi * point.sommerfeld_number)
        attitude = math.degrees(point.attitude_angle)
        flow = point.side_flow / (cases.RADIUS**2 * cases.CLEARANCE * cases.SPEED)
        found.append((so, attitude, flow))
        lines.append(
            (
                f"{row['B_over_D']:g}", f"{row['epsilon']:g}", f"{row['So']:g}", f"{so:.4f}",
                percent(so, row["So"]), f"{row['beta_deg']:g}", f"{attitude:.2f}",
                apart(attitude, row["beta_deg"]), percent(flow, row["Q_star"]),
            )
        )  # fmt: skip
    head = ("B/D", "ε", "So", "computed", "%", "β °", "computed", "° apart", "side flow %")
    write("butenschoen", table(head, lines))
    figure, axes = plt.subplots(1, 2, figsize=(9.0, 3.4), layout="constrained")
    for ratio in RATIOS:
        chosen = [k for k, row in enumerate(rows) if row["B_over_D"] == ratio]
        eps = [rows[k]["epsilon"] for k in chosen]
        for ax, at, name in ((axes[0], 0, "So"), (axes[1], 1, "beta_deg")):
            line = ax.plot(eps, [found[k][at] for k in chosen], label=f"B/D = {ratio:g}")
            ax.plot(
                eps, [rows[k][name] for k in chosen], "o", mfc="none", color=line[0].get_color()
            )
    axes[0].set(yscale="log", xlabel="eccentricity ratio", ylabel="So")
    axes[1].set(xlabel="eccentricity ratio", ylabel="attitude angle [°]")
    axes[0].legend(title="lines: rotorsim, circles: table")
    picture("butenschoen", figure)


def raimondi_boyd() -> None:
    """The five quantities of their charts."""
    rows = [
        row for row in cases.reference_rows("raimondi_boyd1958_full360.csv")
        if math.isfinite(row["L_over_D"]) and row["eps"] > 0.0
    ]  # fmt: skip
    lines = []
    for row in rows:
        point = solved(row["eps"], row["L_over_D"])
        length = 2.0 * cases.RADIUS * row["L_over_D"]
        inflow = row["Q_RcNL"] * cases.RADIUS * cases.CLEARANCE * cases.SPEED / (2.0 * math.pi)
        pressure = point.load / (length * 2.0 * cases.RADIUS) / point.max_pressure
        friction = cases.RADIUS / cases.CLEARANCE * point.friction_force / point.load
        lines.append(
            (
                f"{row['L_over_D']:g}", f"{row['eps']:g}", f"{row['S']:g}",
                f"{point.sommerfeld_number:.4g}", percent(point.sommerfeld_number, row["S"]),
                apart(math.degrees(point.attitude_angle), row["phi_deg"]),
                percent(friction, row["Rf_over_c"]),
                percent(point.side_flow / (inflow * length), row["Qs_over_Q"]),
                percent(pressure, row["P_over_pmax"]),
            )
        )  # fmt: skip
    head = ("L/D", "ε", "S", "computed", "%", "attitude °", "friction %", "Qs/Q %", "P/p_max %")
    write("raimondi_boyd", table(head, lines))


def lund_thomsen() -> None:
    """Coefficients of the two-groove bearing."""
    rows = cases.reference_rows("lund_thomsen1978_two_axial_groove.csv")
    computed, lines = [], []
    for row in rows:
        point = solved(row["eps"], 0.5, mesh=(240, 64), grooves=cases.split_grooves())
        stiffness, damping = cases.dimensionless(point)
        values = dict(zip(NAMES, np.concatenate([stiffness.ravel(), damping.ravel()]), strict=True))
        computed.append(values)
        worst = max(NAMES, key=lambda n: abs(values[n] - row[n]) / max(abs(row[n]), 3.0))
        mass = point.critical_mass_dimensionless
        lines.append(
            (
                f"{row['eps']:g}", percent(point.sommerfeld_number, row["S"]),
                apart(math.degrees(point.attitude_angle), row["phi_deg"]), worst,
                f"{row[worst]:g}", f"{values[worst]:.3f}",
                "stable" if math.isnan(row["mc"]) else f"{row['mc']:.2f}",
                "stable" if mass is None else f"{mass:.2f}",
            )
        )  # fmt: skip
    head = ("ε", "S %", "attitude °", "worst entry", "table", "computed", "M_cr table", "computed")
    write("lund_thomsen", table(head, lines))
    figure, axes = plt.subplots(1, 2, figsize=(9.0, 3.6), layout="constrained")
    eps = [row["eps"] for row in rows]
    for k, name in enumerate(NAMES):
        line = axes[k // 4].plot(eps, [v[name] for v in computed], label=name)
        axes[k // 4].plot(eps, [r[name] for r in rows], "o", mfc="none", color=line[0].get_color())
    for ax, label in zip(axes, ("K c/W", "C c ω/W"), strict=True):
        ax.set(xlabel="eccentricity ratio", ylabel=label, yscale="symlog")
        ax.legend(ncols=2)
    picture("lund_thomsen", figure)


def ocvirk() -> None:
    """The short-bearing limit."""
    wanted = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8)
    rows = [r for r in cases.reference_rows("ocvirk_short_bearing.csv") if r["eps"] in wanted]
    lines = []
    for row in rows:
        point = solved(
            row["eps"], 0.02, mesh=(240, 32), cavitation="half_sommerfeld", inception="free"
        )
        stiffness, damping = cases.dimensionless(point)
        k = np.array([[row["avv"], -row["avu"]], [-row["auv"], row["auu"]]])
        b = np.array([[row["bvv"], -row["buv"]], [-row["buv"], row["buu"]]])
        short = (
            cases.VISCOSITY * 2.0 * cases.RADIUS * cases.SPEED * (0.04 * cases.RADIUS) ** 3
            / (8.0 * cases.CLEARANCE**2 * point.load)
        )  # fmt: skip
        mass = point.critical_mass_dimensionless
        lines.append(
            (
                f"{row['eps']:g}", percent(short, row["Ss"]),
                apart(math.degrees(point.attitude_angle), row["phi_deg"], 3),
                f"{100.0 * np.abs(stiffness - k).max() / np.abs(k).max():.2f}",
                f"{100.0 * np.abs(damping - b).max() / np.abs(b).max():.2f}",
                "stable" if math.isnan(row["mc"]) else f"{row['mc']:.3f}",
                "stable" if mass is None else f"{mass:.3f}",
            )
        )  # fmt: skip
    head = ("ε", "Ss %", "attitude °", "K, worst %", "C, worst %", "M_cr closed form", "computed")
    write("ocvirk", table(head, lines))


if __name__ == "__main__":
    IMAGES.mkdir(parents=True, exist_ok=True)
    (ROOT / "docs" / "validation").mkdir(exist_ok=True)
    from orbit_validation import force_map, orbits

    for part in (butenschoen, raimondi_boyd, lund_thomsen, ocvirk, force_map, orbits):
        part()
        print(part.__name__, "done")
