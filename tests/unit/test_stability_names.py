"""The package's names are found lazily, and every one is there."""

import subprocess
import sys

import pytest

from rotorsim import stability


def test_every_public_name_is_there():
    for name in stability.__all__:
        assert getattr(stability, name).__name__ == name
    with pytest.raises(AttributeError, match="nonsense"):
        _ = stability.nonsense  # type: ignore[attr-defined]


def test_the_closed_form_imports_numpy_alone():
    code = "import sys; from rotorsim.stability import rigid_threshold; print(*sys.modules)"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"scipy", "control", "numba", "xarray"} & set(out.stdout.split())
