"""Mutated tables of other programs are read or refused by name; nothing else happens."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from rotorsim.bearing.table import CoefficientTable
from rotorsim.errors import TableError
from rotorsim.files.formats import read_table, write_table

CSV = """\
# speed, K and C
thermal_model,radial_clearance [um],speed [rpm],status,kxx [N/m],kxy [N/m],kyx [N/m],kyy [N/m],\
cxx [N s/m],cxy [N s/m],cyx [N s/m],cyy [N s/m],load [N]
thd,100,1000,converged,1,2,-3,4,5,6,6,7,10
thd,100,2000,converged,1,2,-3,4,5,6,6,7,10
thd,150,1000,converged,1,2,-3,4,5,6,6,7,10
thd,150,2000,not_converged,nan,nan,nan,nan,nan,nan,nan,nan,10
"""
ROSS = """\
[BearingElement_a]
n = 0
tag = "a"
frequency = [100.0, 200.0, 300.0]
kxx = [1.0, 2.0, 3.0]
kxy = [1.0, 2.0, 3.0]
kyx = [-1.0, -2.0, -3.0]
cxx = [1.0, 2.0, 3.0]
cxy = 0.5
"""
PIECES = [
    "nan",
    "inf",
    "-1",
    "0",
    "1e400",
    "x",
    "",
    ",",
    "[",
    "]",
    '"',
    "\n",
    "#",
    "[N/m]",
    "µ",
    "[",
]


@st.composite
def mutated(draw: st.DrawFn, text: str) -> str:
    for _ in range(draw(st.integers(1, 4))):
        start = draw(st.integers(0, len(text)))
        length = draw(st.sampled_from([0, 1, 1, 3, 20]))
        piece = draw(st.sampled_from(PIECES) | st.text(max_size=3))
        text = text[:start] + piece + text[start + length :]
    return text


def read(text: str, name: str) -> CoefficientTable | None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_bytes(text.encode("utf-8", errors="surrogatepass"))
        try:
            return read_table(path)
        except TableError as error:
            message = str(error)
    assert name in message
    assert len(message) < 5000
    return None


def check(table: CoefficientTable | None) -> None:
    if table is not None:
        assert np.isfinite(table.stiffness[table.converged]).all()
        assert np.isfinite(table.damping[table.converged]).all()
        assert (np.diff(table.speeds) > 0.0).all()


@given(mutated(CSV))
def test_a_mutated_csv_table_is_read_or_refused(text: str) -> None:
    check(read(text, "fuzz.csv"))


@given(mutated(ROSS))
def test_a_mutated_bearing_of_ross_is_read_or_refused(text: str) -> None:
    check(read(text, "fuzz.toml"))


def test_the_mutations_start_from_good_texts() -> None:
    table = read(CSV, "good.csv")
    assert table is not None
    assert table.converged.sum() == 3
    bearing = read(ROSS, "good.toml")
    assert bearing is not None
    with tempfile.TemporaryDirectory() as folder:
        (path,) = write_table(bearing, "ross", folder, "again")
        assert np.array_equal(read_table(path).damping, bearing.damping)
