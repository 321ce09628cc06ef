"""ROSS's side of `against_ross.py`; runs in an environment with ross-rotordynamics >= 3."""

from __future__ import annotations

import json
import math
import time
import warnings
from importlib.metadata import version

import numpy as np

warnings.simplefilter("ignore")
SPEED = 5000.0 * math.pi / 30.0
MU, T0, BETA = 0.0277, 313.15, 0.034
OIL = {
    "liquid_viscosity1": MU,
    "temperature1": T0,
    "liquid_viscosity2": MU * math.exp(-BETA * 60.0),
    "temperature2": T0 + 60.0,
    "liquid_density": 860.0,
    "liquid_specific_heat": 2000.0,
    "liquid_thermal_conductivity": 0.13,
}
THERMAL = {
    "isothermal point": None,
    "THD point, adiabatic walls": "adiabatic",
    "THD point, bush conduction": "full",
}


def bearing(thermal, speeds, **mesh):
    from ross.bearings.plain_journal import PlainJournal

    size = {"total_ex_film": 80, "total_ez_film": 30, "total_ey_film": 20, "total_ey_pad": 20}
    return PlainJournal(
        n=0,
        pad_axial_length=0.08,
        journal_diameter=0.1,
        radial_clearance=1e-4,
        n_pads=2,
        pad_arc=math.radians(162.0),
        oil_supply_temperature=T0,
        speed=list(speeds),
        fys_load=-10e3,
        lubricant=OIL,
        oil_flow_v=1e-2,
        pad_thickness=0.025,
        thermal_type=thermal,
        pad_conductivity=250.0,
        pad_convection=80.0,
        edges_convection=80.0,
        environment_temperature=T0,
        re_laminar=1e5,
        re_turbulent=2e5,
        temp_j_type="no_heat_flux_into_journal",
        **{**size, **mesh},
    )


def in_load_frame(element) -> dict[str, float]:
    """Its load points along -y and its shaft turns from x to y: x_load = -y, y_load = x."""
    k = np.array([[element.kxx[0], element.kxy[0]], [element.kyx[0], element.kyy[0]]])
    c = np.array([[element.cxx[0], element.cxy[0]], [element.cyx[0], element.cyy[0]]])
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    k, c = turn @ k @ turn.T / 1e6, turn @ c @ turn.T / 1e3
    trace = c[0, 0] + c[1, 1]
    stiff = k[0, 0] * c[1, 1] + k[1, 1] * c[0, 0] - k[0, 1] * c[1, 0] - k[1, 0] * c[0, 1]
    equivalent = stiff / trace
    shifted = (equivalent - k[0, 0]) * (equivalent - k[1, 1]) - k[0, 1] * k[1, 0]
    whirl = shifted / np.linalg.det(c) * 1e6
    return {
        "kxx": k[0, 0], "kxy": k[0, 1], "kyx": k[1, 0], "kyy": k[1, 1],
        "cxx": c[0, 0], "cxy": c[0, 1], "cyx": c[1, 0], "cyy": c[1, 1],
        "M_crit": equivalent * 1e6 / whirl if whirl > 0.0 else math.nan,
    }  # fmt: skip


def main() -> None:
    results: dict[str, object] = {"version": version("ross-rotordynamics")}
    coarse = {"total_ex_film": 8, "total_ez_film": 4, "total_ey_film": 4, "total_ey_pad": 4}
    for row, thermal in THERMAL.items():
        bearing(thermal, [SPEED], **coarse)  # compile
        start = time.perf_counter()
        element = bearing(thermal, [SPEED])
        seconds = time.perf_counter() - start
        output = element._results.outputs[0]
        hottest = float(output["y_max_t"][0]) - 273.15 if thermal else 40.0
        results[row] = {
            "seconds": seconds,
            "eps": float(output["eccentricity"][0]),
            "attitude": math.degrees(float(output["attitude"][0])),
            "T_max": hottest,
            **{name: float(value) for name, value in in_load_frame(element).items()},
        }
    start = time.perf_counter()
    bearing("full", np.linspace(2500.0, 15000.0, 10) * math.pi / 30.0, num_processes=2)
    results["sweep"] = time.perf_counter() - start
    print(json.dumps(results))


if __name__ == "__main__":
    main()
