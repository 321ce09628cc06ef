"""Tables as MATLAB files (version 5, which MATLAB, Octave and SciPy read)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..atomic import replacing
from ..bearing.table_data import ATTRIBUTES, COEFFICIENTS, CONVENTIONS, SCALARS

if TYPE_CHECKING:
    from ..bearing.table import CoefficientTable


def write(table: CoefficientTable, path: Path) -> Path:
    """Write everything: ``K(:,:,i,j,k)`` and ``C`` are 2 x 2 matrices.

    The indices after the first two are speed, clearance (and any further dimension), thermal model:
    the dimensions of the table, last to first. ``dimensions`` in the file lists them.
    """
    from scipy.io import savemat

    dataset = table.dataset
    order = [str(name) for name in dataset["kxx"].dims][::-1]
    contents: dict[str, Any] = {
        "conventions": "\n".join(CONVENTIONS),
        "title": str(dataset.attrs.get("title", "")),
        "dimensions": _cells(order),
        "K": _matrices(table.stiffness),
        "C": _matrices(table.damping),
        "status": _cells(dataset["status"].values.T),
    }
    for name in order:
        values = dataset[name].values
        contents[name] = values.astype(float) if values.dtype.kind in "fi" else _cells(values)
    scalars = [n for n in SCALARS if n in dataset.data_vars]
    contents |= {name: np.asarray(dataset[name].values, dtype=float).T for name in scalars}
    contents["units"] = {n: ATTRIBUTES[n][0] for n in [*order, *scalars] if n in ATTRIBUTES} | {
        letter: ATTRIBUTES[f"{letter.lower()}xx"][0] for letter in "KC"
    }
    contents["coefficient_names"] = _cells(COEFFICIENTS)
    with replacing(path) as temporary, temporary.open("wb") as stream:
        savemat(stream, contents, oned_as="row")
    return path


def _matrices(values: np.ndarray) -> np.ndarray:
    """From (..., speed, 2, 2) to (2, 2, speed, ...)."""
    return np.moveaxis(values, (-2, -1), (0, 1)).transpose(0, 1, *range(values.ndim - 1, 1, -1))


def _cells(texts: Any) -> np.ndarray:
    """Cell array of texts."""
    source = np.asarray(texts, dtype=object)
    cells = np.empty(source.shape, dtype=object)
    for index in np.ndindex(source.shape):
        cells[index] = str(source[index])
    return cells
