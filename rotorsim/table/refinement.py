"""More values along a dimension between those for which the film was solved."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import OutOfRangeError, TableError
from ..status import SolveStatus
from .assembly import build
from .variables import COEFFICIENTS

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

_SLACK = 1e-9


def refine(dataset: xr.Dataset, dimension: str, values: Array) -> xr.Dataset:
    """Interpolate K, C and the load along `dimension`; other variables are left out.

    A monotone cubic (PCHIP) over the logarithm of the coordinate. A value between two points of
    which one did not converge has not converged either.
    """
    from scipy.interpolate import PchipInterpolator

    known = np.asarray(dataset[dimension].values, dtype=float)
    low, high = known[0], known[-1]
    wanted = np.asarray(values, dtype=float)
    outside = (wanted < low * (1.0 - _SLACK)) | (wanted > high * (1.0 + _SLACK))
    if outside.any():
        raise OutOfRangeError(
            f"the table goes from {low:.6g} to {high:.6g}",
            key=dimension,
            value=float(wanted[outside][0]),
        )
    if known.size < 2:
        raise TableError("one value cannot be interpolated", key=dimension)
    wanted = np.clip(wanted, low, high)
    dims = dataset["kxx"].dims
    axis = dims.index(dimension)
    names = [name for name in (*COEFFICIENTS, "load") if name in dataset]
    columns = np.stack([np.moveaxis(dataset[name].values, axis, 0) for name in names], axis=-1)
    good = np.moveaxis(dataset["status"].values == str(SolveStatus.CONVERGED), axis, 0)
    shape = columns.shape
    flat, flat_good = columns.reshape(known.size, -1, len(names)), good.reshape(known.size, -1)
    result = np.full((wanted.size, *flat.shape[1:]), np.nan)
    fine = np.zeros((wanted.size, flat.shape[1]), dtype=bool)
    x, at = np.log(known), np.log(wanted)
    below = np.clip(np.searchsorted(known, wanted, side="right") - 1, 0, known.size - 2)
    for column in range(flat.shape[1]):
        usable = flat_good[:, column]
        if usable.sum() < 2:
            continue
        fit = PchipInterpolator(x[usable], flat[usable, column], axis=0, extrapolate=False)
        result[:, column] = fit(at)
        fine[:, column] = _between_good(usable, below, known, wanted)
    result[~fine] = np.nan
    moved = np.moveaxis(result.reshape(wanted.size, *shape[1:]), 0, axis)
    variables = {name: moved[..., i] for i, name in enumerate(names)}
    status = np.where(fine, str(SolveStatus.CONVERGED), str(SolveStatus.NOT_CONVERGED))
    status = np.moveaxis(status.reshape(wanted.size, *shape[1:-1]), 0, axis).astype(object)
    return _dataset(dataset, dimension, values, {**variables, "status": status})


def _between_good(
    usable: NDArray[np.bool_], below: NDArray[np.intp], known: Array, wanted: Array
) -> NDArray[np.bool_]:
    """Whether both neighbours of each value converged, or the one that it falls on."""
    on_low = np.abs(wanted - known[below]) <= _SLACK * known[below]
    on_high = np.abs(wanted - known[below + 1]) <= _SLACK * known[below + 1]
    both = usable[below] & usable[below + 1]
    return both | (on_low & usable[below]) | (on_high & usable[below + 1])


def _dataset(
    dataset: xr.Dataset, dimension: str, values: Array, variables: dict[str, NDArray]
) -> xr.Dataset:
    """`build`, with the coordinates that it does not know."""
    dims = [str(d) for d in dataset["kxx"].dims]
    coordinates = {d: values if d == dimension else dataset[d].values for d in dims}
    return build(coordinates, variables, dict(dataset.attrs), dataset)
