"""ROSS's side of `rotor_against_ross.py`; runs in an environment with ross-rotordynamics >= 3.

Reads the rotor as JSON from its standard input and writes eigenvalues, response and
times on the last line of its output.
"""

from __future__ import annotations

import json
import sys
import time
import warnings
from importlib.metadata import version

import numpy as np

warnings.simplefilter("ignore")


def main() -> None:
    import ross

    given = json.load(sys.stdin)

    steel = ross.Material("given", rho=given["density"], E=given["E"], Poisson=given["poisson"])
    step, count = given["length"] / given["elements"], given["elements"]
    shaft = [ross.ShaftElement(step, 0.0, given["diameter"], material=steel) for _ in range(count)]
    discs = [ross.DiskElement(node, m, it, ip) for node, m, ip, it in given["discs"]]
    bearings = [
        ross.BearingElement(node, speed=given["table_speeds"], **given["coefficients"])
        for node in (0, count)
    ]
    rotor = ross.Rotor(shaft, discs, bearings)
    speeds = np.array(given["campbell_speeds"])
    rotor.run_campbell(speeds[:2], frequencies=given["modes"])
    start = time.perf_counter()
    rotor.run_campbell(speeds, frequencies=given["modes"])
    campbell = time.perf_counter() - start
    values = [rotor.run_modal(speed, sparse=False).evalues for speed in given["checked_speeds"]]
    node, amount = given["unbalance"]
    speeds = np.array(given["response_speeds"])
    rotor.run_unbalance_response([node], [amount], [0.0], speeds[:2])
    start = time.perf_counter()
    response = rotor.run_unbalance_response([node], [amount], [0.0], speeds)
    unbalance = time.perf_counter() - start
    amplitude = np.asarray(response.forced_resp)[[6 * node, 6 * node + 1]]
    result = {
        "version": version("ross-rotordynamics"),
        "campbell": campbell,
        "unbalance": unbalance,
        "eigenvalues": [[[v.real, v.imag] for v in row] for row in values],
        "amplitude": [[[v.real, v.imag] for v in row] for row in amplitude],
    }
    print("\n" + json.dumps(result))


if __name__ == "__main__":
    main()
