"""Coefficients between the tabulated speeds: a monotone cubic through the converged points."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array, Booleans, Indices
from ..errors import InputError, OutOfRangeError, TableError
from ..status import SolveStatus
from .table_data import build, common_unknowns
from .table_format import COEFFICIENTS, PAD_MATRICES, UNKNOWNS

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False)
class Coefficients:
    """Linearised film (SI, load frame).

    stiffness : (2, 2) array. K_ij = -dF_i/dx_j [N/m].
    damping : (2, 2) array. C_ij = -dF_i/dv_j [N s/m].
    speed : Of the shaft [rad/s].
    load : Static load [N].
    radial_clearance : [m]
    Raises InputError: A matrix is not 2 x 2 or not finite, or the speed is below zero.
    """

    stiffness: Array
    damping: Array
    speed: float
    load: float | None = None
    radial_clearance: float | None = None
    thermal_model: str | None = None

    def __post_init__(self) -> None:
        for name in ("stiffness", "damping"):
            value = np.array(getattr(self, name), dtype=float)
            if value.shape != (2, 2) or not np.all(np.isfinite(value)):
                raise InputError("must be a 2 x 2 matrix of finite numbers", key=name, value=value)
            value.setflags(write=False)
            object.__setattr__(self, name, value)
        if not (np.isfinite(self.speed) and self.speed >= 0.0):
            raise InputError("must be 0 or more (rad/s)", key="speed", value=self.speed)

    def dimensionless(self) -> Coefficients:
        """Return K c/W and C c omega/W, with unit load, clearance and speed.

        Raises InputError: The load or the clearance is not known.

        Examples
        --------
        >>> film = Coefficients(2e8 * np.eye(2), 1e5 * np.eye(2), 1000.0, 1e4, 1e-4)
        >>> float(film.dimensionless().stiffness[0, 0]), float(film.dimensionless().damping[0, 0])
        (2.0, 1.0)
        """
        if self.load is None or self.radial_clearance is None:
            raise InputError("dimensionless coefficients need a load and a clearance", key="load")
        scale = self.radial_clearance / self.load
        return replace(
            self,
            stiffness=self.stiffness * scale,
            damping=self.damping * (scale * self.speed),
            speed=1.0,
            load=1.0,
            radial_clearance=1.0,
        )


_SPEED_TOLERANCE = 1e-9
"""Relative; two speeds nearer than this are the same one written in different units."""


@dataclass(frozen=True, eq=False)
class CoefficientInterpolator:
    """Speed to (K, C), vectorised; exact at the tabulated speeds, never beyond them.

    speeds : (n,) array. Tabulated speeds [rad/s], ascending.
    converged : (n,) bool array. Which of them may be used.
    cubic : (4, n, 9) array. Coefficients, highest power first, of the cubic in ``speed -
        speeds[i]`` for the interval above speed i (constant for the last): kxx kxy kyx kyy cxx cxy
        cyx cyy load. A compiled integrator can evaluate these itself.
    constant : The coefficients hold at any speed.

    PCHIP (Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5, 1984) overshoots nowhere, so it makes
    no stiffness or damping that its neighbours do not have. A point that did not converge cuts the
    curve: nothing is interpolated across it.
    """

    speeds: Array
    converged: Booleans
    cubic: Array
    constant: bool = False

    @classmethod
    def from_columns(
        cls, speeds: Array, converged: Booleans, columns: Array, constant: bool = False
    ) -> CoefficientInterpolator:
        """Fit (n, 9) `columns` over ascending `speeds` [rad/s]."""
        from scipy.interpolate import PchipInterpolator

        cubic = np.zeros((4, *columns.shape))
        cubic[3] = columns
        edges = np.flatnonzero(np.diff(np.concatenate([[0], converged.astype(int), [0]])))
        for start, stop in edges.reshape(-1, 2):
            if stop - start > 1:
                known = np.isfinite(columns[start:stop]).all(axis=0)
                run = columns[start:stop][:, known]
                fit = PchipInterpolator(speeds[start:stop], run, axis=0)
                cubic[:, start : stop - 1, known] = fit.c
        return cls(speeds, converged, cubic, constant)

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest speed at which coefficients are known [rad/s]."""
        return (0.0, np.inf) if self.constant else (float(self.speeds[0]), float(self.speeds[-1]))

    def columns(self, speed: ArrayLike, gaps: Literal["raise", "nan"] = "raise") -> Array:
        """Evaluate the (..., 9) columns at `speed` [rad/s]; see `__call__`."""
        omega = np.asarray(speed, dtype=float)
        low, high = self.bounds
        slack_low, slack_high = low * _SPEED_TOLERANCE, high * _SPEED_TOLERANCE
        inside = (omega >= low - slack_low) & (omega <= high + slack_high)
        if not inside.all():
            raise OutOfRangeError(
                f"the table holds speeds from {low:.6g} to {high:.6g} rad/s",
                key="speed",
                value=float(omega[~inside].flat[0]) if omega.ndim else float(omega),
            )
        i = np.clip(np.searchsorted(self.speeds, omega, side="right") - 1, 0, None)
        d = (omega - self.speeds[i])[..., None]
        c = self.cubic
        result = ((c[0][i] * d + c[1][i]) * d + c[2][i]) * d + c[3][i]
        if self.converged.all():
            return result
        return self._mask_gaps(result, omega, i, gaps)

    def _mask_gaps(
        self, result: Array, omega: Array, i: Indices, gaps: Literal["raise", "nan"]
    ) -> Array:
        above = np.append(self.converged[1:], True)
        on_knot = np.abs(omega - self.speeds[i]) <= _SPEED_TOLERANCE * self.speeds[i]
        bad = ~(self.converged[i] & (on_knot | above[i]))
        if not bad.any():
            return result
        if gaps == "nan":
            return np.where(bad[..., None], np.nan, result)
        k = int(np.atleast_1d(i)[np.atleast_1d(bad)][0])
        around = self.speeds[k : k + 2]
        failed = [f"{s:.6g}" for s in around if not self.converged[self.speeds == s][0]]
        raise TableError(
            f"the operating point at {' and '.join(failed)} rad/s did not converge, so the table "
            "knows no coefficients next to it; solve it again or choose another speed",
            key="speed",
            value=float(np.atleast_1d(omega)[np.atleast_1d(bad)][0]),
        )

    def __call__(
        self, speed: ArrayLike, gaps: Literal["raise", "nan"] = "raise"
    ) -> tuple[Array, Array]:
        """Return the stiffness [N/m] and damping [N s/m] at `speed` [rad/s].

        gaps : {"raise", "nan"}. What to do next to points that did not converge.
        Returns stiffness, damping : speed.shape + (2, 2) arrays
        Raises OutOfRangeError: A speed lies outside the tabulated ones.
        Raises TableError: A neighbour did not converge and `gaps` is "raise".
        """
        values = self.columns(speed, gaps)
        shape = (*values.shape[:-1], 2, 2)
        return values[..., :4].reshape(shape), values[..., 4:8].reshape(shape)


_SLACK = 1e-9


def refine(dataset: xr.Dataset, dimension: str, values: Array) -> xr.Dataset:
    """Interpolate K, C and the load along `dimension`; other variables are left out.

    With tilting pads also K, C and M over journal and pads.

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
    columns = np.stack([dataset[name].values for name in names], axis=-1)
    unknowns: list[str] = []
    if "full_stiffness" in dataset:
        unknowns, full = common_unknowns(dataset)
        full = np.moveaxis(full, 0, -3)
        columns = np.concatenate([columns, full.reshape(*columns.shape[:-1], -1)], axis=-1)
    columns = np.moveaxis(columns, axis, 0)
    good = np.moveaxis(dataset["status"].values == str(SolveStatus.CONVERGED), axis, 0)
    shape = columns.shape
    flat, flat_good = columns.reshape(known.size, -1, shape[-1]), good.reshape(known.size, -1)
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
    refined = _dataset(dataset, dimension, values, {**variables, "status": status})
    if not unknowns:
        return refined
    size = len(unknowns)
    full = moved[..., len(names) :].reshape(*moved.shape[:-1], 3, size, size)
    return refined.assign(
        {name: ((*dims, *UNKNOWNS), full[..., i, :, :]) for i, name in enumerate(PAD_MATRICES)}
    ).assign_coords(dict.fromkeys(UNKNOWNS, unknowns))


def _between_good(usable: Booleans, below: Indices, known: Array, wanted: Array) -> Booleans:
    """Return whether both neighbours of each value converged, or the one that it falls on."""
    on_low = np.abs(wanted - known[below]) <= _SLACK * known[below]
    on_high = np.abs(wanted - known[below + 1]) <= _SLACK * known[below + 1]
    both = usable[below] & usable[below + 1]
    return both | (on_low & usable[below]) | (on_high & usable[below + 1])


def _dataset(
    dataset: xr.Dataset, dimension: str, values: Array, variables: dict[str, NDArray]
) -> xr.Dataset:
    """Return `build`, with the coordinates that it does not know."""
    dims = [str(d) for d in dataset["kxx"].dims]
    coordinates = {d: values if d == dimension else dataset[d].values for d in dims}
    return build(coordinates, variables, dict(dataset.attrs), dataset)
