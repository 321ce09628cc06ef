"""Files broken at random go through the whole command line: read, or refused with a reason.

Every mutation has a number and comes again from it. A process of its own takes them one by one, so
that a crash of a compiled library, a hang or a hunger for memory is seen as such.
"""

from __future__ import annotations

import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy.io import savemat
from scipy.sparse import csc_matrix

import rotorsim
from rotorsim.bearing.table import CoefficientTable
from rotorsim.bearing.table_data import with_provenance

CASES = Path(__file__).parents[1] / "data" / "cases"
PACKAGE = Path(rotorsim.__file__).parents[1]
SECONDS, MEGABYTES = 20, 2000
KINDS = ("csv", "sheet.csv", "ross2.toml", "ross3.toml", "json", "nc", "bytes.nc", "npz", "mat")

RUNNER = """
import contextlib, io, json, resource, signal, sys, time
from pathlib import Path
from rotorsim.cli.app import app
resource.setrlimit(resource.RLIMIT_AS, (8_000_000_000, 8_000_000_000))
for path in sorted(Path("in").iterdir()):
    rotor = path.suffix in (".npz", ".mat")
    for words in (
        ["stability", "good.csv", "--rotor", str(path), "--json"] if rotor else
        ["stability", str(path), "--mass", "500 kg", "--json"],
        ["export", str(path), "--to", "csv,ross,mat,nc,txt", "-o", "out", "--json"],
    ):
        print(json.dumps([str(path), words[0]]), flush=True)
        said, answer = io.StringIO(), io.StringIO()
        start, code = time.monotonic(), None
        signal.alarm({seconds})
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(answer):
            try:
                app(words, prog_name="rotorsim")
            except SystemExit as end:
                code = end.code
            except BaseException as error:
                code = repr(error)
        signal.alarm(0)
        answered = True
        try:
            json.loads(answer.getvalue(), parse_constant=lambda name: 1 / 0)
        except Exception:
            answered = False
        print(json.dumps([code, said.getvalue()[-3000:], answered, time.monotonic() - start,
                          resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3]), flush=True)
"""


def originals() -> dict[str, bytes]:
    """A good file of every kind."""
    csv = (CASES / "07-opposite-sign-convention-not-doubted" / "ok.csv").read_bytes()
    head = b"radial_clearance [um],load [N],thermal_model,status," + csv.splitlines()[0]
    rows = [b"100,5000,thd,converged," + row for row in csv.splitlines()[1:]]
    ross3 = (CASES / "01-ross3-speed-axis-not-read" / "saved31_speed.toml").read_bytes()
    two = (CASES / "11-several-bearings" / "two.toml").read_bytes()
    element = {"n": 0, "tag": "b", "frequency": [100.0, 200.0], "kxx": [1e8, 2e8],
               "kxy": [5e7, 5e7], "kyx": [-5e7, -5e7], "cxx": [1e5, 1e5]}  # fmt: skip
    rotor = {"M": np.diag([10.0, 10.0, 1.0, 1.0] * 2), "K": np.zeros((8, 8)),
             "G": np.zeros((8, 8)), "bearing_nodes": np.array([0.0, 1.0])}  # fmt: skip
    npz, mat = io.BytesIO(), io.BytesIO()
    np.savez(npz, **rotor)
    savemat(mat, {**rotor, "K": csc_matrix(np.eye(8))}, do_compression=True)
    return {
        "csv": b"\n".join([head, *rows]),
        "sheet.csv": (CASES / "08-spreadsheet-units-row" / "table.csv").read_bytes(),
        "ross2.toml": two.split(b"[BearingElement_b]")[0],
        "ross3.toml": ross3,
        "json": json.dumps({"BearingElement_b": element}).encode(),
        "nc": netcdf(table()),
        "bytes.nc": netcdf(table()),
        "npz": npz.getvalue(),
        "mat": mat.getvalue(),
    }


def table() -> xr.Dataset:
    path = CASES / "02-ross3-export-on-wrong-axis" / "pump.csv"
    return with_provenance(CoefficientTable.from_csv(path).dataset)


def netcdf(dataset: xr.Dataset) -> bytes:
    """Without the checksum of all bytes, which would refuse every mutation."""
    stream = io.BytesIO()
    dataset.to_netcdf(stream, engine="h5netcdf")
    return stream.getvalue()


NUMBERS = [
    "1e308", "-1e308", "1e-308", "5e-324", "0", "-1", "nan", "inf", "-inf", "1e999", "1e19", "1e20",
    "9" * 400, "0x10", "1_000", "1,5", "", "true", "[1]", '"x"', "-0.0", "1e-20",
]  # fmt: skip
PIECES = [
    b",", b";", b"\n", b'"', b"#", b"[", b"]", b"=", b"\x00", b"\xff", b"\xc2\xb5", b"\t",
    b"'", b"{", b"}", b"[[", b"\r", b" " * 5000, b"kxx = ", b"frequency", b"speed", b"1/min",
    b"interpolation = 'x'\n", b"MN/m", b"lb/in", b"(", b"a" * 200_000,
]  # fmt: skip


def mutate_text(data: bytes, dice: np.random.Generator) -> bytes:
    for _ in range(dice.integers(1, 4)):
        how = dice.integers(6)
        numbers = list(re.finditer(rb"[-+]?\d+\.?\d*(e[-+]?\d+)?", data))
        if how <= 1 and numbers:
            found = numbers[dice.integers(len(numbers))]
            data = data[: found.start()] + dice.choice(NUMBERS).encode() + data[found.end() :]
        elif how == 2:
            lines = data.split(b"\n")
            one, other = dice.integers(len(lines), size=2)
            lines[one], lines[other] = lines[other], lines[one]
            del lines[dice.integers(len(lines)) :: 7]
            data = b"\n".join(lines)
        elif how == 3:
            place = dice.integers(len(data) + 1)
            data = data[:place] + PIECES[dice.integers(len(PIECES))] + data[place:]
        elif how == 4:
            start = dice.integers(len(data) + 1)
            data = data[:start] + data[start + dice.integers(1, 30) :]
        else:
            data = mutate_bytes(data, dice)
    return data


def mutate_bytes(data: bytes, dice: np.random.Generator) -> bytes:
    changed = bytearray(data)
    for _ in range(dice.integers(1, 8)):
        how = dice.integers(5)
        place = int(dice.integers(max(len(changed), 1)))
        if how <= 2 and changed:
            changed[place] ^= 1 << int(dice.integers(8))
        elif how == 3:
            changed[place : place + 4] = dice.bytes(4)
        elif dice.random() < 0.2:
            del changed[place:]
    return bytes(changed)


VALUES = [np.nan, np.inf, -np.inf, 1e308, -1e308, 1e-308, 0.0, -1.0, 1e19, 1e20, 1e-20]
ODD = [np.int8(3), 1.5, "text", b"bytes", np.arange(3), np.array([]), np.array(["a", "b"]), True]


def mutate_dataset(dice: np.random.Generator) -> bytes:
    """A table whose numbers, attributes, types and sizes are odd, well packed."""
    dataset = table().copy(deep=True)
    for _ in range(dice.integers(1, 4)):
        names = list(dataset.variables)
        name = str(names[dice.integers(len(names))])
        how = dice.integers(6)
        if how <= 1 and dataset[name].dtype.kind == "f" and dataset[name].size:
            values = dataset[name].values.copy()
            values.flat[dice.integers(values.size)] = VALUES[dice.integers(len(VALUES))]
            dataset[name] = (dataset[name].dims, values)
        elif how == 2:
            key = str(dice.choice([*dataset.attrs, "scenario", "scenario_sha256", "constant"]))
            dataset.attrs[key] = ODD[dice.integers(len(ODD))]
        elif how == 3:
            key = str(dice.choice(["units", "long_name", "scale_factor", "calendar"]))
            dataset[name].attrs[key] = ODD[dice.integers(len(ODD))]
        elif how == 4 and dataset[name].dtype.kind == "f":
            kind = str(dice.choice(["int8", "float32", "complex128", "str", "bool"]))
            with np.errstate(all="ignore"):
                try:
                    dataset[name] = (dataset[name].dims, dataset[name].values.astype(kind))
                except (TypeError, ValueError):
                    continue
        elif how == 5 and name in dataset.data_vars:
            dataset = dataset.drop_vars(name)
    try:
        return netcdf(dataset)
    except Exception:  # not every odd thing can be packed
        return mutate_bytes(netcdf(table()), dice)


def mutate_arrays(kind: str, dice: np.random.Generator) -> bytes:
    """A rotor whose matrices are odd, well packed."""
    arrays = {
        "M": np.diag([10.0, 10.0, 1.0, 1.0] * 2), "K": np.zeros((8, 8)), "G": np.zeros((8, 8)),
        "D": np.zeros((8, 8)), "bearing_nodes": np.array([0.0, 1.0]), "dofs_per_node": np.array(4),
    }  # fmt: skip
    for _ in range(dice.integers(1, 4)):
        name = str(dice.choice(list(arrays)))
        array = np.atleast_1d(arrays[name]).astype(float)
        how = dice.integers(6)
        if how <= 1 and array.size:
            array.flat[dice.integers(array.size)] = VALUES[dice.integers(len(VALUES))]
        elif how == 2:
            array = array[: dice.integers(len(array) + 1)]
        elif how == 3:
            array = array.astype(str(dice.choice(["complex128", "int8", "bool", "U3", "float32"])))
        elif how == 4:
            array = array[None]
        else:
            array = array * VALUES[dice.integers(len(VALUES))]
        arrays[name] = array
    stream = io.BytesIO()
    if kind == "npz":
        np.savez(stream, **arrays)
    else:
        savemat(stream, arrays)
    return stream.getvalue()


def mutation(number: int, good: dict[str, bytes]) -> tuple[str, bytes]:
    """Name and contents of a mutated file."""
    dice = np.random.default_rng([20261126, number])
    kind = KINDS[number % len(KINDS)]
    with np.errstate(all="ignore"):
        if kind == "nc":
            data = mutate_dataset(dice)
        elif kind in ("npz", "mat") and dice.random() < 0.6:
            data = mutate_arrays(kind, dice)
        elif kind in ("bytes.nc", "npz", "mat"):
            data = mutate_bytes(good[kind], dice)
        else:
            data = mutate_text(good[kind], dice)
    return f"{number:06d}.{kind}", data


def run(folder: Path, names: dict[str, bytes]) -> list[tuple[str, str, list]]:
    """File, command and result of every call; stops with the process."""
    (folder / "in").mkdir()
    (folder / "good.csv").write_bytes(originals()["csv"])
    for name, data in names.items():
        (folder / "in" / name).write_bytes(data)
    (folder / "run.py").write_text(RUNNER.replace("{seconds}", str(SECONDS)))
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "run.py"], cwd=folder, capture_output=True, text=True,
        env={**os.environ, "PYTHONPATH": str(PACKAGE)},
    )  # fmt: skip
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(lines) % 2 == 0, f"{lines[-1]} ended the process: {done.returncode}, {done.stderr}"
    assert done.returncode == 0, done.stderr
    return [(*call, result) for call, result in zip(lines[::2], lines[1::2], strict=True)]


def faults(results: list[tuple[str, str, list]]) -> list[str]:
    found = []
    for name, command, (code, said, answered, seconds, megabytes) in results:
        bad = code not in (0, 1, 2) or "Traceback" in said or "fault of the program" in said
        if bad or not answered or seconds > SECONDS or megabytes > MEGABYTES:
            found.append(f"{name} {command}: {code}, {seconds:.1f} s, {megabytes:.0f} MB: {said}")
        elif code == 2 and "error: " not in said:
            found.append(f"{name} {command}: no reason is given: {said}")
    return found


@pytest.mark.slow
def test_the_originals_are_good(tmp_path):
    good = {f"{kind}": data for kind, data in originals().items()}
    results = run(tmp_path, {f"good.{kind}": data for kind, data in good.items()})
    assert {
        (name.removeprefix("in/good."), command, result[0]) for name, command, result in results
    } == {(kind, "stability", 0) for kind in KINDS} | {
        (kind, "export", 2 if kind in ("npz", "mat") else 0) for kind in KINDS
    }
    assert not faults(results)


_BLOCKS = 8 if os.environ.get("HYPOTHESIS_PROFILE") == "nightly" else 1
"""Of 250 files each, a minute of one core."""


@pytest.mark.parametrize(
    ("first", "count"),
    [
        (0, 5),
        pytest.param(5, 85, marks=pytest.mark.slow),
        *(pytest.param(1000 + 250 * n, 250, marks=pytest.mark.slow) for n in range(_BLOCKS)),
    ],
)
def test_broken_files_are_read_or_refused(first, count, tmp_path):
    good = originals()
    results = run(tmp_path, dict(mutation(number, good) for number in range(first, first + count)))
    assert len(results) == 2 * count
    found = faults(results)
    assert not found, "\n\n".join(found[:20])
