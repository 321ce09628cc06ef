"""Campbell diagram of a simple rotor by ROSS, as reference data for the tests.

Needs ROSS (``pip install "rotorsim[ross]"``). Run::

    python benchmarks/ross_campbell.py tests/data/ross_bearing.csv tests/data/ross_campbell.json

The rotor's matrices without bearings, the coefficients and what ROSS makes of them go into the
file; rotorsim is not needed here and must find the same branches from the same numbers.
"""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

LENGTH, DIAMETER, ELEMENTS = 1.2, 0.1, 8  # of the shaft, m
DISC_WIDTH, DISC_DIAMETER, DISC_NODE = 0.12, 0.5, 3  # off the middle: gyroscopic terms count
BEARING_NODES = (1, 7)
KEPT = (0, 1, 3, 4)
"""Of the six degrees of freedom of a ROSS node: x, y and the two slopes."""
NAMES = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")
FREQUENCIES = 6


def read_coefficients(path: str | Path) -> dict[str, np.ndarray]:
    """Columns of a coefficient table in SI units, as `rotorsim export --to csv` writes it."""
    lines = Path(path).read_text(encoding="utf-8").splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    columns = {name.split(" ")[0]: name for name in rows[0]}
    return {
        name: np.array([float(row[columns[name]]) for row in rows]) for name in ("speed", *NAMES)
    }


def build_rotor(coefficients: dict[str, np.ndarray] | None) -> Any:
    """ROSS rotor on two like bearings; without coefficients, on bearings that do nothing."""
    import ross

    steel = ross.Material(name="Steel", rho=7850.0, E=210e9, Poisson=0.3)
    step = LENGTH / ELEMENTS
    shaft = [ross.ShaftElement(step, 0.0, DIAMETER, material=steel) for _ in range(ELEMENTS)]
    disc = ross.DiskElement.from_geometry(DISC_NODE, steel, DISC_WIDTH, DIAMETER, DISC_DIAMETER)
    if coefficients is None:
        bearings = [ross.BearingElement(node, kxx=0.0, cxx=0.0) for node in BEARING_NODES]
    else:
        given = {name: coefficients[name] for name in NAMES}
        speeds = coefficients["speed"]
        bearings = [ross.BearingElement(node, frequency=speeds, **given) for node in BEARING_NODES]
    return ross.Rotor(shaft, [disc], bearings)


def lateral(matrix: np.ndarray) -> list[list[float]]:
    """Rows and columns of the lateral degrees of freedom; the others do not couple with them."""
    kept = [6 * node + dof for node in range(matrix.shape[0] // 6) for dof in KEPT]
    return np.asarray(matrix, dtype=float)[np.ix_(kept, kept)].tolist()


def compute(path: str | Path) -> dict[str, Any]:
    """Everything for the data file."""
    import ross

    coefficients = read_coefficients(path)
    rotor, bare = build_rotor(coefficients), build_rotor(None)
    speeds = coefficients["speed"]
    found = rotor.run_campbell(speeds, frequencies=FREQUENCIES)
    eigenvalues = [rotor.run_modal(speed, sparse=False).evalues for speed in speeds]
    # Positive frequencies of lateral modes only: torsion and the axial mode are undamped.
    kept = [
        [[v.real, v.imag] for v in row if v.imag > 1.0 and abs(v.real) > 1e-6 * abs(v)]
        for row in eigenvalues
    ]
    return {
        "source": f"ross-rotordynamics {ross.__version__}, numpy {np.__version__}",
        "made_by": "benchmarks/ross_campbell.py",
        "units": "SI; speeds, frequencies and eigenvalues in rad/s",
        "coefficients_file": Path(path).name,
        "bearing_nodes": list(BEARING_NODES),
        "dofs_per_node": len(KEPT),
        "mass": lateral(bare.M()),
        "damping": lateral(bare.C(0.0)),
        "gyroscopic": lateral(bare.G()),
        "stiffness": lateral(bare.K(0.0)),
        "speed": speeds.tolist(),
        "damped_frequency": np.asarray(found.wd).tolist(),
        "log_decrement": np.asarray(found.log_dec).tolist(),
        "whirl": np.asarray(found.whirl_values).tolist(),
        "eigenvalues": kept,
    }


def main() -> None:
    source, target = sys.argv[1:]
    Path(target).write_text(json.dumps(compute(source)) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
