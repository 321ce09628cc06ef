"""A rotor of 40 elements beside ROSS: eigenvalues, unbalance response, and times, in one run.

ROSS is not a dependency: give the Python of an environment that has it,

    python benchmarks/rotor_against_ross.py --ross PATH_TO_ITS_PYTHON

or name it in the environment variable ROSS_PYTHON. Two discs, coefficient tables at both ends;
Campbell diagram over 100 speeds with 12 modes, unbalance response over 500. Both programs get the
same numbers; tables are compared at their own speeds only, between them each interpolates its way
(the Campbell diagram and the response use tabulated speeds).
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from rotorsim.machine.machine import Machine
from rotorsim.machine.modes import modes
from rotorsim.machine.response import unbalance_response
from rotorsim.machine.support import MatrixTable
from rotorsim.model.shaft import Disc, Material, Section
from rotorsim.rotor import Beam, beam_rotor, with_unbalance

ELEMENTS, LENGTH, DIAMETER = 40, 1.5, 0.05
DISC_NODES, DISC = (13, 27), (30.0, 0.30, 0.18)  # mass, polar, transverse inertia
UNBALANCE = (13, 2e-4)
MODES = 12
SPEEDS = np.linspace(50.0, 1000.0, 500)
NAMES = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")


def coefficients() -> np.ndarray:
    """Stiffness and damping over SPEEDS, (500, 8), in both programs' order."""
    s = SPEEDS / 1000.0
    k = np.stack([1e7 * (1 + s), 4e6 * s, -6e6 * s, 1.5e7 * (1 + 0.5 * s)], axis=-1)
    c = np.stack([3e4 / (1 + s), 2e3 * s, 2e3 * s, 4e4 / (1 + s)], axis=-1)
    return np.concatenate([k, c], axis=-1)


def machine() -> Machine:
    """This program's rotor."""
    step = LENGTH / ELEMENTS
    beam = Beam(
        tuple(Section(step, DIAMETER, elements=1) for _ in range(ELEMENTS)),
        tuple(Disc(node * step, *DISC) for node in DISC_NODES),
        Material(211e9, 7810.0, 0.3),
    )
    node, amount = UNBALANCE
    rotor = with_unbalance(beam_rotor(beam, [0.0, LENGTH]), [(node * step, amount, 0.0)])
    table = coefficients().reshape(-1, 2, 2, 2)
    support = MatrixTable(SPEEDS, table[:, 0], table[:, 1])
    return Machine(rotor, [(0, support), (ELEMENTS, support)])


def compare(python: str, repeats: int = 3) -> dict[str, Any]:
    """Largest relative differences, and seconds of both programs."""
    campbell_speeds, checked = SPEEDS[::5], SPEEDS[::125]
    request = {
        "length": LENGTH, "elements": ELEMENTS, "diameter": DIAMETER,
        "density": 7810.0, "E": 211e9, "poisson": 0.3,
        "discs": [(node, *DISC) for node in DISC_NODES], "modes": MODES,
        "table_speeds": SPEEDS.tolist(), "unbalance": UNBALANCE,
        "coefficients": dict(zip(NAMES, coefficients().T.tolist(), strict=True)),
        "campbell_speeds": campbell_speeds.tolist(), "checked_speeds": checked.tolist(),
        "response_speeds": SPEEDS.tolist(),
    }  # fmt: skip
    side = Path(__file__).with_name("ross_rotor_side.py")
    answer = subprocess.run(
        [python, str(side)], input=json.dumps(request), capture_output=True, text=True, check=True,
        env={key: value for key, value in os.environ.items() if key != "PYTHONPATH"},
    )  # fmt: skip
    theirs = json.loads(answer.stdout.splitlines()[-1])  # what it imports talks
    whole = machine()
    campbell, unbalance = [], []
    for _ in range(repeats):
        start = time.perf_counter()
        modes(whole, campbell_speeds, count=MODES)
        campbell.append(time.perf_counter() - start)
        start = time.perf_counter()
        response = unbalance_response(whole, SPEEDS)
        unbalance.append(time.perf_counter() - start)
    apart = 0.0
    for speed, pairs in zip(checked, theirs["eigenvalues"], strict=True):
        every = np.array([complex(*pair) for pair in pairs])
        own = modes(whole, float(speed), count=MODES).eigenvalues[0]
        near = np.abs(every[None, :] - own[:, None]).min(axis=1)
        apart = max(apart, float((near / np.abs(own)).max()))
    amplitude = np.array([[complex(*pair) for pair in row] for row in theirs["amplitude"]])
    own = np.asarray(response.at(UNBALANCE[0])).T  # type: ignore[possibly-unbound]
    off = np.abs(np.abs(own) - np.abs(amplitude)) / np.abs(amplitude)
    return {
        "version": theirs["version"], "eigenvalues": apart, "response": float(off.max()),
        "campbell": (min(campbell), theirs["campbell"]),
        "unbalance": (min(unbalance), theirs["unbalance"]),
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ross", default=os.environ.get("ROSS_PYTHON"), metavar="PYTHON")
    python = parser.parse_args().ross
    if not python or not Path(python).exists():
        sys.exit("skipped: name the Python of an environment with ROSS (--ross, or ROSS_PYTHON)")
    found = compare(python)
    print(f"ROSS {found['version']}, {ELEMENTS} elements, {MODES} modes, largest differences:")
    print(f"  eigenvalues {found['eigenvalues']:.1e}, unbalance response {found['response']:.1e}")
    for name, count in (("campbell", 100), ("unbalance", SPEEDS.size)):
        own, theirs = found[name]
        print(f"  {name}, {count} speeds: {own:.3f} s, ROSS {theirs:.2f} s: {theirs / own:.0f} x")


if __name__ == "__main__":
    main()
