"""Tilting pads beside ROSS's, the same bearing, oil and load, in one run.

ROSS is not a dependency: give the Python of an environment that has it,

    python benchmarks/pads_against_ross.py --ross PATH_TO_ITS_PYTHON

ROSS's own example (`tilting_pad_adiabatic_example`): five 60 degree pads on a 101.6 mm journal,
load near a pivot, ISO VG 32, 3000 rpm; 30 x 30 elements on each pad, 16 through it, the position
found for the load. Laminar, all hot oil but a fifth carried over (its default). Its adiabatic point
takes minutes: `--rows` chooses. ROSS's energy equation is averaged across the film.
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import subprocess
import sys
import time
import warnings

ROWS = ("isothermal", "adiabatic", "conducting")
SPEED = 3000.0 * math.pi / 30.0
RADIUS, LENGTH, THICKNESS, ASSEMBLED, PRELOAD = 50.8e-3, 50.8e-3, 12.7e-3, 74.9e-6, 0.5
PIVOTS = (18.0, 90.0, 162.0, 234.0, 306.0)
LOAD = (884.05, -2670.4)
SUPPLY, CARRY_OVER = 313.15, 0.8
REYN = 6894.757293168361
VISCOSITY, HOT = 4.05640e-06 * REYN, 6.76911e-07 * REYN
DENSITY, HEAT, CONDUCTIVITY = 873.99629, 1948.7995685758851, 0.13126
PAD_CONDUCTIVITY, CONVECTION, SURROUNDINGS = 45.0, 735.9, 294.261
NAMES = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")


def ours(row: str, repeats: int) -> dict[str, float]:
    """This program's point: median time [s] of a cold start, and its numbers."""
    from rotorsim.bearing.solve import solve_case
    from rotorsim.model import (
        Bearing,
        Case,
        ExponentialViscosity,
        FilmSettings,
        LoadTarget,
        Lubricant,
        MeshSize,
        Pad,
        ThermalSettings,
    )

    towards = math.atan2(LOAD[1], LOAD[0])
    pads = tuple(
        Pad(math.radians(angle) - towards, math.radians(60.0), THICKNESS, preload=PRELOAD)
        for angle in PIVOTS
    )
    thermal = ThermalSettings(
        "isothermal" if row == "isothermal" else "thd", SURROUNDINGS, SUPPLY, inlet="mixing",
        shaft="insulated", bush="conduction" if row == "conducting" else "insulated",
        bush_conductivity=PAD_CONDUCTIVITY, bush_heat_transfer=CONVECTION,
        hot_oil_carry_over=CARRY_OVER,
    )  # fmt: skip
    law = ExponentialViscosity(VISCOSITY, SUPPLY, math.log(VISCOSITY / HOT) / 60.0)
    case = Case(
        Bearing(RADIUS, LENGTH, ASSEMBLED / (1.0 - PRELOAD), pads=pads),
        Lubricant(law, DENSITY, HEAT, CONDUCTIVITY),
        FilmSettings(mesh=MeshSize(150, 30, 16, 16)),
        thermal,
        LoadTarget(math.hypot(*LOAD)),
    )
    point, _ = solve_case(case, SPEED)
    if not point.converged:
        sys.exit(f"{row}: {point.message}")
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        solve_case(case, SPEED)
        times.append(time.perf_counter() - start)
    values = [*point.stiffness.ravel() / 1e6, *point.damping.ravel() / 1e3]
    return {
        "seconds": statistics.median(times),
        "eccentricity um": point.eccentricity_ratio * point.radial_clearance * 1e6,
        "T_max degC": point.max_temperature - 273.15,
        **{f"pad {k} degC": p.max_temperature - 273.15 for k, p in enumerate(point.pads, 1)},
        **dict(zip(NAMES, map(float, values), strict=True)),
    }


def theirs(row: str) -> dict[str, float]:
    """ROSS's; runs in its environment."""
    import numpy as np
    from ross.bearings.tilting_pad import TiltingPad

    def bearing(**mesh):
        return TiltingPad(
            n=0, speed=[SPEED], equilibrium_type="match_load",
            thermal_type={"isothermal": None, "adiabatic": "adiabatic", "conducting": "full"}[row],
            journal_diameter=2.0 * RADIUS, radial_clearance=ASSEMBLED, pad_thickness=THICKNESS,
            pivot_angle=np.radians(PIVOTS), pad_arc=np.radians([60.0] * 5),
            pad_axial_length=[LENGTH] * 5, preload=[PRELOAD] * 5, offset=[0.5] * 5,
            lubricant="ISOVG32", oil_supply_temperature=SUPPLY, oil_flow_v=1e-2,
            fxs_load=LOAD[0], fys_load=LOAD[1], pad_conductivity=PAD_CONDUCTIVITY,
            edges_convection=CONVECTION, pad_convection=CONVECTION,
            environment_temperature=SURROUNDINGS, hot_oil_lambda=CARRY_OVER,
            temp_j_type="no_heat_flux_into_journal", re_laminar=1e5, re_turbulent=2e5, **mesh,
        )  # fmt: skip

    small = {"total_ex_film": 8, "total_ez_film": 4, "total_ey_pad": 4, "total_ey_film": 4}
    bearing(**small)  # compile
    start = time.perf_counter()
    element = bearing(total_ex_film=30, total_ez_film=30, total_ey_pad=16, total_ey_film=16)
    seconds = time.perf_counter() - start
    output = element._results.outputs[0]
    angle = math.atan2(LOAD[1], LOAD[0])
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    k, c = (
        np.array([[getattr(element, f"{kind}{i}{j}")[0] for j in "xy"] for i in "xy"])
        for kind in "kc"
    )
    values = [*(turn @ k @ turn.T).ravel() / 1e6, *(turn @ c @ turn.T).ravel() / 1e3]
    return {
        "seconds": seconds,
        "eccentricity um": float(output["eccentricity"][0]) * ASSEMBLED * 1e6,
        "T_max degC": float(output["y_max_t"][0]) - 273.15 if row != "isothermal" else math.nan,
        **dict(zip(NAMES, map(float, values), strict=True)),
    }


def main() -> None:
    """Print both sides."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ross", help="python of an environment with ross-rotordynamics")
    parser.add_argument("--rows", nargs="+", choices=ROWS, default=list(ROWS))
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--their-side", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.their_side:
        warnings.simplefilter("ignore")
        print(json.dumps(theirs(options.rows[0])))
        return
    for row in options.rows:
        own, other = ours(row, options.repeats), {}
        if options.ross:
            command = [options.ross, __file__, "--their-side", "--rows", row]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if done.returncode:
                sys.exit(f"ROSS failed:\n{done.stderr[-2000:]}")
            other = json.loads(done.stdout.strip().splitlines()[-1])
        print(f"{row}\n{'':18}{'rotorsim':>12}{'ROSS':>12}")
        for name, value in own.items():
            print(f"{name:18}{value:12.4g}{other.get(name, math.nan):12.4g}")
        if other:
            print(f"{other['seconds'] / own['seconds']:.0f} times as fast")
        print(flush=True)


if __name__ == "__main__":
    main()
