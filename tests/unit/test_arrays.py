"""Arrays from files of others: read to the last digit, or refused before they do harm."""

from __future__ import annotations

import io
import pickle
import resource
import zipfile
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csc_matrix

from rotorsim.errors import InputError
from rotorsim.files.rotors import _read_arrays

CASES = Path(__file__).parents[1] / "data" / "cases"
GOOD = {
    "M": np.arange(16.0).reshape(4, 4),
    "K": np.asfortranarray(np.arange(16.0).reshape(4, 4)) * (1.0 + 2.0j),
    "nodes": np.array([0, 3]),
}


@pytest.mark.parametrize("how", ["npz", "compressed npz", "mat", "compressed mat"])
def test_arrays_come_back_to_the_last_digit(how, tmp_path):
    path = tmp_path / f"a.{how.split()[-1]}"
    if "npz" in how:
        (np.savez if how == "npz" else np.savez_compressed)(path, **GOOD)
    else:
        savemat(path, {**GOOD, "S": csc_matrix(GOOD["M"])}, do_compression=" " in how)
    found = _read_arrays(path)
    for name, value in GOOD.items():
        assert np.array_equal(found[name].reshape(value.shape), value)
    if "mat" in how:
        assert np.array_equal(found["S"], GOOD["M"])


def archive(**members: bytes) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as file:
        for name, data in members.items():
            file.writestr(f"{name}.npy", data)
    return stream.getvalue()


def npy(array: np.ndarray, claimed: tuple[int, ...] | None = None) -> bytes:
    stream = io.BytesIO()
    np.lib.format.write_array(stream, array)
    data = stream.getvalue()
    return data if claimed is None else data.replace(b"(2, 3), ", f"{claimed}, ".encode())


def objects() -> bytes:
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.array([print]), allow_pickle=True)
    return stream.getvalue()


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        (b"", "no .npz file of plain arrays"),
        (b"PK\x03\x04" + bytes(100), "no .npz file of plain arrays"),
        (archive(a=npy(np.ones((2, 3)))[:-8]), "no plain numbers, or cut off"),
        (archive(a=npy(np.ones((2, 3)), (2**40, 3))), "no plain numbers, or cut off|plain arrays"),
        (archive(a=npy(np.full((2, 3), 1e31))), "a holds numbers beyond 1e[+]30"),
        (archive(a=npy(np.array(["x"]))), "a holds no numbers"),
        (archive(a=objects()), "no plain numbers"),
        (archive(a=pickle.dumps(print)), "no .npz file of plain arrays"),
    ],
)
def test_what_is_no_plain_array_is_refused(contents, message, tmp_path):
    path = tmp_path / "a.npz"
    path.write_bytes(contents)
    with pytest.raises(InputError, match=message) as caught:
        _read_arrays(path)
    assert str(caught.value).startswith(f"{path}: cannot be read: ")


@pytest.mark.parametrize("suffix", ["npz", "mat"])
def test_a_file_that_unpacks_to_more_than_the_limit_is_not_unpacked(suffix, tmp_path, monkeypatch):
    monkeypatch.setattr("rotorsim.files.rotors._MAX_UNPACKED", 30_000_000)
    path = tmp_path / f"bomb.{suffix}"
    if suffix == "npz":
        np.savez_compressed(path, M=np.zeros((2500, 2500)))
    else:
        savemat(path, {"M": np.zeros((2500, 2500))}, do_compression=True)
    assert path.stat().st_size < 100_000
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(InputError, match=r"(50|3\d) MB or more, at most 30 MB"):
        _read_arrays(path)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 40_000  # kB


def test_a_sparse_matrix_of_any_size_is_not_made_full(tmp_path):
    path = tmp_path / "wide.mat"
    savemat(path, {"M": csc_matrix((1_000_000, 1_000_000))})
    with pytest.raises(InputError, match="MB or more"):
        _read_arrays(path)


def test_sparse_indices_are_checked_before_they_are_followed():
    with pytest.raises(InputError, match="lie outside of it"):
        _read_arrays(CASES / "30-robust" / "sparse_index_out_of_bounds.mat")
