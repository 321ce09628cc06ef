"""The coefficient table: a checked xarray dataset with look-up by speed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import finite_number
from ..errors import TableError
from ..status import SolveStatus
from . import delimited, netcdf
from . import table_data as assembly
from .interpolation import CoefficientInterpolator, Coefficients
from .table_format import COEFFICIENTS

if TYPE_CHECKING:
    import xarray as xr

    from .operating_point import OperatingPoint

_MATCH = 1e-6
"""Relative distance within which a value selects a tabulated one."""
_SAME = 1e-5
"""Of a variable's largest magnitude: what processors and libraries may change in its numbers."""
_DIAGNOSTICS = ("residual", "iterations", "heat_imbalance")


@dataclass(frozen=True, eq=False)
class CoefficientTable:
    """K, C and operating data over thermal model, clearance and speed.

    Attributes
    ----------
    dataset : xarray.Dataset
        Dimensions ``thermal_model``, ``radial_clearance``, any further ones made by `stack`, and
        ``speed`` last; variables kxx ... cyy [N/m, N s/m], ``status``, and the scalars of the
        operating points where they are known.

    Raises
    ------
    TableError
        A variable is missing, speeds are out of order, or a number is NaN at a converged point.
    """

    dataset: xr.Dataset

    def __post_init__(self) -> None:
        assembly.check(self.dataset)

    @classmethod
    def from_points(
        cls, points: Iterable[Any], attributes: Mapping[str, Any] | None = None
    ) -> CoefficientTable:
        """Collect operating points, in any order and however nested.

        Parameters
        ----------
        points : nested iterables of OperatingPoint
            Every combination of the thermal models, clearances and speeds that occur, once.
        attributes : mapping, optional
            Provenance: ``scenario`` (its text; the SHA-256 is added), ``mesh``, and whatever else.

        Raises
        ------
        TableError
            A combination is missing or occurs twice.
        """
        return cls(assembly.from_points(list(_flatten(points)), dict(attributes or {})))

    @classmethod
    def stack(
        cls,
        tables: Sequence[CoefficientTable],
        dimension: str,
        values: Sequence[float],
        units: str = "1",
    ) -> CoefficientTable:
        """Join tables of the same speeds along a further dimension.

        Parameters
        ----------
        tables : sequence of CoefficientTable
        dimension : str
            For example ``applied_load`` or ``supply_temperature``.
        values : sequence of float
            One for each table, ascending.
        units : str
            Of `values`.
        """
        return cls(assembly.stack([t.dataset for t in tables], dimension, list(values), units))

    @classmethod
    def load(cls, path: str | Path) -> CoefficientTable:
        """Read a netCDF table; a damaged, foreign or newer file raises `TableError`."""
        dataset = netcdf.read(path)
        assembly.check(dataset, source=path)
        return cls(dataset)

    @classmethod
    def from_csv(cls, path: str | Path) -> CoefficientTable:
        """Read speed, K and C from a CSV file (see `rotorsim.bearing.delimited`)."""
        dataset = delimited.read(path)
        assembly.check(dataset, source=path)
        return cls(dataset)

    def save(self, path: str | Path) -> Path:
        """Write netCDF 4 with provenance; an old file is replaced only by a complete new one."""
        return netcdf.write(assembly.with_provenance(self.dataset), path)

    def to_csv(self, path: str | Path) -> Path:
        """Write a CSV file that `from_csv` reads back (without further dimensions)."""
        return delimited.write(self.dataset, path)

    def agrees_with(self, other: CoefficientTable) -> bool:
        """Return whether scenario, mesh, variables, verdicts and (to a tolerance) numbers do.

        How the solver got there (residuals, iterations) does not count.
        """
        mine, others = self.dataset, other.dataset
        if any(mine.attrs.get(key) != others.attrs.get(key) for key in ("scenario", "mesh")):
            return False
        if {n: v.dims for n, v in mine.variables.items()} != {
            n: v.dims for n, v in others.variables.items()
        }:
            return False
        return all(
            name in _DIAGNOSTICS or _alike(mine[name].values, others[name].values)
            for name in mine.variables
        )

    def __repr__(self) -> str:
        models = ", ".join(map(str, self.dataset["thermal_model"].values))
        clearances = self.dataset["radial_clearance"].values.astype(float) * 1e6
        shown = ", ".join(f"{one:.4g}" for one in clearances)
        low, high = self.speeds[[0, -1]] * 30.0 / np.pi
        return (
            f"<CoefficientTable: {models}; c = {shown} µm; {self.speeds.size} speeds, "
            f"{low:.0f} to {high:.0f} rpm>"
        )

    def _repr_html_(self) -> str:
        from .description import table_html_of

        return table_html_of(self)

    @property
    def choices(self) -> tuple[str, ...]:
        """All dimensions but the speed, in the order of the arrays."""
        return tuple(str(d) for d in self.dataset["kxx"].dims if d != "speed")

    @property
    def speeds(self) -> np.ndarray:
        """Tabulated speeds [rad/s]."""
        return np.asarray(self.dataset["speed"].values, dtype=float)

    @property
    def constant(self) -> bool:
        """Return whether the coefficients hold at any speed, the tabulated ones being examples."""
        return assembly.CONSTANT in self.dataset.attrs

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences on what the reader of another program's file left out or took for granted."""
        return tuple(str(self.dataset.attrs.get(assembly.NOTES, "")).splitlines())

    def with_speeds(self, speeds: ArrayLike) -> CoefficientTable:
        """Tabulate constant coefficients at other speeds [rad/s], ascending.

        Raises
        ------
        TableError
            The coefficients are not constant, or the speeds do not ascend.
        """
        if not self.constant:
            raise TableError(
                f"the table has its own speeds, {self.speeds[0]:.6g} to {self.speeds[-1]:.6g} "
                "rad/s; others are for constant coefficients", key="speeds",
            )  # fmt: skip
        wanted = np.atleast_1d(np.asarray(speeds, dtype=float))
        places = np.zeros(wanted.size, dtype=int)
        return CoefficientTable(
            self.dataset.isel(speed=places).assign_coords(
                speed=("speed", wanted, assembly.cf_attributes("speed"))
            )
        )

    @property
    def stiffness(self) -> np.ndarray:
        """(..., n_speed, 2, 2) stiffness [N/m] in the order of the dataset's dimensions."""
        return self._matrices("k")

    @property
    def damping(self) -> np.ndarray:
        """(..., n_speed, 2, 2) damping [N s/m]."""
        return self._matrices("c")

    @property
    def converged(self) -> np.ndarray:
        """Return whether each point may be used, shape (..., n_speed)."""
        return np.asarray(self.dataset["status"].values == str(SolveStatus.CONVERGED), dtype=bool)

    def _matrices(self, kind: str) -> np.ndarray:
        columns = [self.dataset[name].values for name in COEFFICIENTS if name[0] == kind]
        return np.stack(columns, axis=-1).reshape(*columns[0].shape, 2, 2)

    def select(self, **choices: Any) -> CoefficientTable:
        """Take the part of the table at given coordinates; the dimensions stay, with length 1.

        Parameters
        ----------
        **choices
            ``thermal_model="thd"``, ``radial_clearance=100e-6`` [m], and the further dimensions'
            values. None leaves a dimension alone. A number must match a tabulated one closely:
            nothing is interpolated here.

        Raises
        ------
        TableError
            No such coordinate; the message lists what exists.
        """
        dataset = self.dataset
        for name, wanted in choices.items():
            if wanted is None:
                continue
            if name not in self.choices:
                raise TableError(
                    f"no such dimension; the table has {', '.join(self.choices)}", key=name
                )
            dataset = dataset.isel({name: [_position(dataset[name].values, wanted, name)]})
        return CoefficientTable(dataset)

    def refine(self, dimension: str, values: ArrayLike) -> CoefficientTable:
        """Interpolate K, C and the load at further values of a dimension other than the speed.

        Parameters
        ----------
        dimension : str
            With two values or more: ``radial_clearance``, or one made by `stack`.
        values : (n,) array
            Ascending, within the tabulated ones.

        Raises
        ------
        OutOfRangeError
            A value lies outside the table.
        TableError
            No such dimension, or only one value along it.

        Notes
        -----
        A monotone cubic over the logarithm of the coordinate: for maps, which want many more
        values than films should be solved for.
        """
        from .interpolation import refine

        numeric = [name for name in self.choices if name != "thermal_model"]
        if dimension not in numeric:
            raise TableError(f"must be one of {', '.join(numeric)}", key=dimension)
        at = np.atleast_1d(np.asarray(values, dtype=float))
        if at.ndim != 1 or not at.size or np.any(np.diff(at) <= 0.0):
            raise TableError("values must ascend", key=dimension, value=values)
        return CoefficientTable(refine(self.dataset, dimension, at))

    def interpolator(self, **choices: Any) -> CoefficientInterpolator:
        """Make a fast callable from speed [rad/s] to (K, C), for integrators and root searches.

        Raises
        ------
        TableError
            `choices` (see `select`) leave more than one curve over speed.
        """
        one = self.select(**choices)
        for name in one.choices:
            values = one.dataset[name].values
            if values.size > 1:
                raise TableError(f"say which; the table has {_listing(values)}", key=name)
        names = [*COEFFICIENTS, "load"]
        shape = one.speeds.shape
        columns = [
            one.dataset[name].values.reshape(shape)
            if name in one.dataset
            else np.full(shape, np.nan)
            for name in names
        ]
        return CoefficientInterpolator.from_columns(
            one.speeds, one.converged.reshape(shape), np.stack(columns, axis=-1), one.constant
        )

    def at(self, speed: float, **choices: Any) -> Coefficients:
        """Return coefficients at one speed [rad/s].

        Exact at tabulated speeds, monotone between them.

        Raises
        ------
        OutOfRangeError
            The speed lies outside the table; the message gives the bounds.
        TableError
            `choices` (see `select`) do not single out one curve, or a neighbour in speed did not
            converge.
        """
        one = self.select(**choices)
        speed = finite_number(speed, "speed", "rad/s")
        values = one.interpolator().columns(speed)
        clearance = float(one.dataset["radial_clearance"].values[0])
        return Coefficients(
            stiffness=values[:4].reshape(2, 2),
            damping=values[4:8].reshape(2, 2),
            speed=speed,
            load=float(values[8]) if np.isfinite(values[8]) else None,
            radial_clearance=clearance if np.isfinite(clearance) else None,
            thermal_model=str(one.dataset["thermal_model"].values[0]),
        )


def _flatten(points: Iterable[Any]) -> Iterator[OperatingPoint]:
    for item in points:
        if isinstance(item, Iterable):
            yield from _flatten(item)
        else:
            yield item


def _alike(one: np.ndarray, other: np.ndarray) -> bool:
    if one.shape != other.shape:
        return False
    if one.dtype.kind not in "fiu" or other.dtype.kind not in "fiu":
        return bool((one.astype(str) == other.astype(str)).all())
    size = float(np.abs(other[np.isfinite(other)]).max(initial=0.0))
    return bool(np.isclose(one, other, rtol=0.0, atol=_SAME * size, equal_nan=True).all())


def _listing(values: np.ndarray) -> str:
    return ", ".join(f"{v:.6g}" if isinstance(v, (float, np.floating)) else str(v) for v in values)


def _position(values: np.ndarray, wanted: Any, name: str) -> int:
    """Return the index of `wanted` among a coordinate's values."""
    if values.dtype.kind == "f":
        try:
            distance = np.abs(values - float(wanted))
        except (TypeError, ValueError):
            distance = np.full(values.shape, np.inf)
        found = np.flatnonzero(distance <= _MATCH * np.abs(values))
        if isinstance(wanted, float) and np.isnan(wanted):  # an unknown clearance
            found = np.flatnonzero(np.isnan(values))
        found = found[np.argsort(distance[found])]
    else:
        found = np.flatnonzero(values.astype(str) == str(wanted))
    if not found.size:
        raise TableError(f"not in the table, which has {_listing(values)}", key=name, value=wanted)
    return int(found[0])
