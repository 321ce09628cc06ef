"""Discretisation error of thermal results against the mesh, by Richardson extrapolation.

    python benchmarks/mesh_convergence.py [--plot FILE.png]

Two cases: Dal's bearing (c = 100 µm, 15 000 rpm, eccentricity ratio 0.5, walls at ambient), and a
two-groove bearing under 10 kN with bush conduction and mixing grooves. Every mesh is the default
one, 156 x 48 x 24, times a factor in all directions. The errors are against the extrapolation of
the two finest meshes with second order.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from rotorsim.bearing.solve import solve_case
from rotorsim.model import (
    Bearing,
    BushModel,
    Case,
    EccentricityTarget,
    ExponentialViscosity,
    FilmSettings,
    Groove,
    InletModel,
    LoadTarget,
    Lubricant,
    MeshSize,
    ShaftModel,
    ThermalSettings,
)

FACTORS = (0.25, 0.5, 1.0, 2.0, 3.0)
OIL = Lubricant(ExponentialViscosity(0.0277, 313.15, 0.034), 860.0, 2000.0, 0.13)
DEGREE = math.pi / 180.0


def mesh(factor: float) -> MeshSize:
    """The default mesh times `factor`."""
    return MeshSize(
        circumferential=round(156 * factor),
        axial=2 * round(24 * factor),
        cross_film=round(24 * factor),
        bush_radial=round(24 * factor),
    )


def dal(factor: float) -> tuple[Case, float]:
    """Dal's case and its speed [rad/s]."""
    settings = FilmSettings(mesh=mesh(factor))
    bearing = Bearing(0.05, 0.08, 1e-4)
    case = Case(bearing, OIL, settings, ThermalSettings(), EccentricityTarget(0.5))
    return case, 15000.0 * math.pi / 30.0


def two_groove(factor: float) -> tuple[Case, float]:
    """The grooved case and its speed [rad/s]."""
    case, _ = dal(factor)
    grooves = (Groove(90 * DEGREE, 18 * DEGREE), Groove(270 * DEGREE, 18 * DEGREE))
    thermal = ThermalSettings(
        inlet=InletModel.MIXING, shaft=ShaftModel.INSULATED, bush=BushModel.CONDUCTION
    )
    bearing = replace(case.bearing, grooves=grooves, bush_outer_radius=0.075)
    case = replace(case, bearing=bearing, thermal=thermal, target=LoadTarget(10e3))
    return case, 5000.0 * math.pi / 30.0


def results(case: Case, speed: float) -> dict[str, float]:
    """What is compared."""
    point, _ = solve_case(case, speed)
    if not point.converged:
        raise SystemExit(f"{case.film.mesh}: {point.status}: {point.message}")
    return {
        "load [N]": point.load,
        "eccentricity ratio": point.eccentricity_ratio,
        "attitude [rad]": point.attitude_angle,
        "peak pressure [MPa]": point.max_pressure / 1e6,
        "peak temperature rise [K]": point.max_temperature - 313.15,
        "friction [N]": point.friction_force,
        "kxx [MN/m]": point.stiffness[0, 0] / 1e6,
        "kxy [MN/m]": point.stiffness[0, 1] / 1e6,
        "kyx [MN/m]": point.stiffness[1, 0] / 1e6,
        "kyy [MN/m]": point.stiffness[1, 1] / 1e6,
        "cxx [kNs/m]": point.damping[0, 0] / 1e3,
        "cxy [kNs/m]": point.damping[0, 1] / 1e3,
        "cyy [kNs/m]": point.damping[1, 1] / 1e3,
        "critical mass [kg]": point.critical_mass or math.nan,
    }


def main() -> None:
    """Print a table for each case, in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plot", type=Path)
    options = parser.parse_args()
    curves = {}
    for name, build in (("Dal, c = 100 µm, 15 000 rpm", dal), ("two grooves, 10 kN", two_groove)):
        found = [results(*build(factor)) for factor in FACTORS]
        fine, finest = FACTORS[-2], FACTORS[-1]
        weight = finest**2 / (finest**2 - fine**2)
        print(f"\n**{name}**\n")
        sizes = [
            f"{mesh(f).circumferential} x {mesh(f).axial} x {mesh(f).cross_film}" for f in FACTORS
        ]
        print("| quantity | extrapolated | " + " | ".join(sizes) + " |")
        print("| --- | --- | " + " | ".join("---" for _ in sizes) + " |")
        errors = {}
        for key in found[0]:
            values = np.array([f[key] for f in found])
            exact = values[-2] + weight * (values[-1] - values[-2])
            errors[key] = values / exact - 1.0
            cells = " | ".join(f"{100.0 * e:+.2f} %" for e in errors[key])
            print(f"| {key} | {exact:.5g} | {cells} |")
        curves[name] = errors
    if options.plot:
        plot(options.plot, curves)


def plot(path: Path, curves: dict[str, dict[str, np.ndarray]]) -> None:
    """Errors against the mesh factor."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 3.6), layout="constrained")
    styles = {"load [N]": "k-o", "peak temperature rise [K]": "k--s", "kxx [MN/m]": "k:^",
              "friction [N]": "k-.x", "critical mass [kg]": "k-d"}  # fmt: skip
    for axes, (name, errors) in zip(figure.subplots(1, 2), curves.items(), strict=True):
        for key, style in styles.items():
            size = np.abs(errors[key]) * 100.0
            if size.max() > 1e-4:
                axes.loglog(FACTORS, np.maximum(size, 1e-4), style, ms=4, label=key)
        axes.loglog(FACTORS, [0.3 / f**2 for f in FACTORS], color="0.6", lw=1, label="second order")
        axes.set_xticks(FACTORS, [f"{f:g}" for f in FACTORS])
        axes.minorticks_off()
        axes.set(title=name, xlabel="mesh relative to 156 x 48 x 24", ylabel="error [%]")
        axes.legend(fontsize=7)
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main()
