"""Campbell branches of a flexible rotor with a disc against ROSS, matrix by matrix the same rotor.

The stored results say which version made them; where ROSS is installed they are made anew.
"""

import importlib.util
import json
import warnings
from pathlib import Path

import numpy as np
import pytest

from rotorsim.bearing.table import CoefficientTable
from rotorsim.machine.machine import Machine
from rotorsim.machine.modes import modes
from rotorsim.machine.support import TableSupport
from rotorsim.machine.thresholds import threshold_speeds
from rotorsim.rotor import Rotor

ROOT = Path(__file__).parents[2]
DATA = ROOT / "tests" / "data"
TOLERANCE = 1e-3
"""Of frequencies and, relative to the eigenvalue's size, of real parts."""


def read_reference() -> dict:
    return json.loads((DATA / "ross_campbell.json").read_text(encoding="utf-8"))


def make_reference() -> dict:
    """The data file's contents, computed by the ROSS that is installed."""
    path = ROOT / "benchmarks" / "ross_campbell.py"
    spec = importlib.util.spec_from_file_location("ross_campbell", path)
    assert spec is not None
    assert spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # ROSS and what it imports warn about their own affairs
        spec.loader.exec_module(script)
        return script.compute(DATA / "ross_bearing.csv")


def rotor_of(reference: dict) -> Rotor:
    return Rotor.from_matrices(
        reference["mass"], reference["stiffness"], reference["damping"], reference["gyroscopic"],
        bearing_nodes=tuple(reference["bearing_nodes"]),
        unknowns_per_node=reference["dofs_per_node"],
    )  # fmt: skip


def machine_of(reference: dict) -> Machine:
    table = CoefficientTable.from_csv(DATA / "ross_bearing.csv")
    return Machine.on_identical(rotor_of(reference), TableSupport(table.interpolator()))


def check_against(reference: dict) -> None:
    table = CoefficientTable.from_csv(DATA / "ross_bearing.csv")
    assert np.allclose(table.speeds, reference["speed"], rtol=1e-12)
    branches = modes(machine_of(reference)).oscillating()
    assert branches.smooth.all()
    for row, listed in zip(branches.eigenvalues, reference["eigenvalues"], strict=True):
        theirs = np.array([complex(*pair) for pair in listed])
        assert theirs.size >= 30
        nearest = np.abs(row[None, :] - theirs[:, None]).min(axis=1)
        assert np.all(nearest < TOLERANCE * np.abs(theirs))
    # As branches: theirs cross one another, and ours must do so at the same places.
    theirs = np.array(reference["damped_frequency"])
    decrement = np.array(reference["log_decrement"])
    assert np.any(np.diff(np.argsort(theirs, axis=1), axis=0) != 0)
    for k in range(theirs.shape[1]):
        apart = np.abs(branches.damped_frequency - theirs[:, [k]]).max(axis=0)
        found = int(apart.argmin())
        assert np.allclose(branches.damped_frequency[:, found], theirs[:, k], rtol=TOLERANCE)
        assert np.allclose(
            branches.logarithmic_decrement[:, found], decrement[:, k], rtol=TOLERANCE, atol=1e-4
        )


def test_against_stored_results_of_ross():
    reference = read_reference()
    assert reference["source"].startswith("ross-rotordynamics 2.")
    check_against(reference)


def test_whirl_sense_against_ross():
    reference = read_reference()
    branches = modes(machine_of(reference)).oscillating()
    sense = branches.whirl_sense
    theirs, whirl = np.array(reference["damped_frequency"]), np.array(reference["whirl"])
    for k in range(theirs.shape[1]):
        found = int(np.abs(branches.damped_frequency - theirs[:, [k]]).max(axis=0).argmin())
        clear = np.abs(sense[:, found]) > 0.3
        forward = whirl[:, k] == 0.0  # ROSS: 0 forward, 1 backward, 0.5 mixed along the shaft
        backward = whirl[:, k] == 1.0
        assert np.all(sense[clear & forward, found] > 0.0)
        assert np.all(sense[clear & backward, found] < 0.0)


def test_threshold_lies_where_the_real_part_of_ross_changes_sign():
    reference = read_reference()
    (threshold,) = threshold_speeds(machine_of(reference))
    largest = [max(pair[0] for pair in row) for row in reference["eigenvalues"]]
    after = int(np.argmax(np.array(largest) > 0.0))
    assert reference["speed"][after - 1] < threshold.speed < reference["speed"][after]
    assert threshold.becomes_unstable
    assert 0.4 < threshold.whirl_frequency_ratio < 0.6
    values = np.linalg.eigvals(machine_of(reference).state_matrix(threshold.speed))
    assert abs(values.real.max()) < 1e-8 * threshold.whirl_frequency


@pytest.mark.skipif(importlib.util.find_spec("ross") is None, reason="needs the extra ross")
def test_against_ross_that_is_installed():
    made = make_reference()
    check_against(made)
    stored = read_reference()
    for name in ("mass", "stiffness", "gyroscopic", "damping"):
        scale = np.abs(stored[name]).max() or 1.0
        assert np.allclose(made[name], stored[name], rtol=1e-9, atol=1e-12 * scale)
