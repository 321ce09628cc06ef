"""The notebooks of the documentation: executed here, and stored with what they show."""

from __future__ import annotations

from pathlib import Path

import pytest

nbformat = pytest.importorskip("nbformat", reason="needs the extra docs")
nbclient = pytest.importorskip("nbclient", reason="needs the extra docs")

FOLDER = Path(__file__).parents[2] / "docs" / "notebooks"
NAMES = sorted(path.stem for path in FOLDER.glob("*.ipynb"))


def said(book) -> list[str]:
    """Return the texts that a notebook's cells print."""
    cells = (cell for cell in book.cells if cell.cell_type == "code")
    return [
        "".join(one["text"] for one in cell.outputs if one.get("name") == "stdout")
        for cell in cells
    ]


def test_there_are_three():
    assert NAMES == ["bearing", "control", "machine"]


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # those of the notebook's own machinery
@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_shows_what_it_computes(name):
    stored = nbformat.read(FOLDER / f"{name}.ipynb", 4)
    fresh = nbformat.read(FOLDER / f"{name}.ipynb", 4)
    nbclient.NotebookClient(fresh, timeout=300, kernel_name="python3").execute()
    assert said(fresh) == said(stored)
    pictures = [
        one for cell in stored.cells if cell.cell_type == "code" for one in cell.outputs
        if "image/png" in one.get("data", {})
    ]  # fmt: skip
    assert name == "control" or len(pictures) >= 3
