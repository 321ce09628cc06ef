"""Stability maps: verdict and growth rate over everything in a table, times mass."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arguments import refuse_other
from ..arrays import Array, Booleans
from ..bearing.dynamics import FilmDynamics, rigid_growth_rates
from ..bearing.table import CoefficientTable
from ..bearing.whirl import rigid_thresholds, routh_coefficients
from ..errors import InputError
from ..rows import result_html, table_html
from .matrices import state_matrix
from .rates import growth_rate_map
from .spectrum import all_eigenmodes
from .support import MatrixTable

if TYPE_CHECKING:
    import xarray as xr

UNKNOWN, UNSTABLE, STABLE, UNDAMPED = -1, 0, 1, 2
"""Values of a map's ``verdict``; unknown where the table has no converged coefficients."""
_VERDICTS = {"stable": STABLE, "unstable": UNSTABLE, "undamped": UNDAMPED, "unknown": UNKNOWN}
_DOUBTFUL = 1e-6
"""Growth rate over the fastest motion's that may be a rounding error (of a double eigenvalue)."""


@dataclass(frozen=True, eq=False)
class StabilityMap:
    """Verdicts of the rigid rotor over the table's dimensions and mass.

    Between tilting pads, of rotor and pads together.

    dataset : xarray.Dataset. Over the table's dimensions and ``mass``: ``growth_rate`` [1/s]
        (largest real part of the eigenvalues, without those below their own accuracy),
        ``verdict`` (1 stable, 0 unstable, 2 undamped, -1 unknown),
        ``mass_margin`` (1 - mass over critical mass, NaN without a threshold). Without ``mass``:
        ``critical_mass`` [kg], ``whirl_frequency_ratio``, ``stability``. Without ``thermal_model``,
        where the table has both models: ``destabilised_by_heating``, stable isothermally and
        unstable with THD.
    """

    dataset: xr.Dataset

    @property
    def destabilised_by_heating(self) -> xr.DataArray | None:
        """True where only heating makes the rotor unstable; None without both models."""
        return self.dataset.get("destabilised_by_heating")

    def plane(self, first: str, second: str, **fixed: object) -> xr.Dataset:
        """Cut the map to two of its dimensions (and the thermal models).

        first, second : Any two of ``speed``, ``mass``, ``radial_clearance`` and the table's further
            ones.
        **fixed : Where the other dimensions are held; the nearest tabulated value is taken. A
            dimension with one value need not be named.
        Raises InputError: A dimension is unknown, or one with several values is not fixed.
        """
        dataset = self.dataset
        for name in (first, second, *fixed):
            if name not in dataset.sizes:
                known = ", ".join(str(d) for d in dataset.sizes)
                raise InputError(f"no such dimension; the map has {known}", key=name)
        for name in dataset.sizes:
            if name in (first, second, "thermal_model") and name not in fixed:
                continue
            if name not in fixed and dataset.sizes[name] > 1:
                raise InputError("has several values: say which", key=str(name))
            if name in fixed:
                method = None if name == "thermal_model" else "nearest"
                dataset = dataset.sel({name: fixed[str(name)]}, method=method)
            else:
                dataset = dataset.isel({name: 0})
        return dataset

    def __repr__(self) -> str:
        sizes = ", ".join(f"{size} {name}" for name, size in self.dataset.sizes.items())
        return f"<StabilityMap: {sizes}>"

    def _repr_html_(self) -> str:
        sizes = ", ".join(f"{size} × {name}" for name, size in self.dataset.sizes.items())
        verdict = self.dataset["verdict"]
        rows = []
        for model in verdict["thermal_model"].values:
            part = verdict.sel(thermal_model=model).values
            shares = (100.0 * float(np.mean(part == code)) for code in _VERDICTS.values())
            rows.append([str(model), *(f"{share:.1f} %" for share in shares)])
        head = ("model", *_VERDICTS)
        return result_html("Stability map", f"<p>{sizes}</p>", table_html(head, rows))

    def save(self, path: str | Path) -> Path:
        """Write the map as netCDF 4."""
        from ..bearing.netcdf import write

        return write(self.dataset, path)


def stability_map(
    table: CoefficientTable, mass: ArrayLike, speed: ArrayLike | None = None
) -> StabilityMap:
    """Return the growth rate and verdict over everything in the table times mass.

    Parameters
    ----------
    table : CoefficientTable
        With any further dimensions (load, supply temperature), which the map keeps.
    mass : (n_mass,) array
        Per bearing [kg], ascending.
    speed : (n_speed,) array, optional
        [rad/s], ascending; by default the tabulated speeds.

    Raises
    ------
    InputError
        A mass is not above zero, or values do not ascend.
    OutOfRangeError
        A speed lies outside the table.
    """
    refuse_other(table, CoefficientTable, "table", "a CoefficientTable, as tabulate returns one")
    masses = _axis(mass, "mass")
    speeds = table.speeds if speed is None else _axis(speed, "speed")
    stiffness, damping, load = _coefficients(table, None if speed is None else speeds)
    dataset = _dataset(table, speeds, masses, stiffness, damping, load)
    models = [str(m) for m in table.dataset["thermal_model"].values]
    if {"isothermal", "thd"} <= set(models):
        cold, hot = models.index("isothermal"), models.index("thd")
        verdict = dataset["verdict"]
        heated = verdict[cold].isin([STABLE]) & verdict[hot].isin([UNSTABLE])
        heated = heated.drop_vars("thermal_model", errors="ignore")
        dataset["destabilised_by_heating"] = heated.astype(np.int8)
        dataset["destabilised_by_heating"].attrs = {
            "units": "1",
            "long_name": "stable if heating is neglected, unstable with it",
            "flag_values": np.array([0, 1], dtype=np.int8),
            "flag_meanings": "no yes",
        }
    return StabilityMap(dataset)


def _axis(values: ArrayLike, name: str) -> Array:
    try:
        axis = np.atleast_1d(np.asarray(values, dtype=float))
    except (TypeError, ValueError):
        axis = np.zeros(0)
    if axis.ndim != 1 or not axis.size or not np.all(np.isfinite(axis)) or not np.all(axis > 0.0):
        raise InputError("must be one or more numbers above 0", key=name, value=values)
    if np.any(np.diff(axis) <= 0.0):
        raise InputError("must ascend", key=name, value=values)
    return axis


def _coefficients(table: CoefficientTable, speeds: Array | None) -> tuple[Array, Array, Array]:
    """Return K, C (..., n_speed, 2, 2) and load (..., n_speed); NaN where nothing converged."""
    shape = tuple(table.dataset.sizes[d] for d in table.choices)
    at = table.speeds if speeds is None else speeds
    values = np.empty((*shape, at.size, 9))
    for index in np.ndindex(shape):
        part = table.dataset.isel(
            {d: slice(i, i + 1) for d, i in zip(table.choices, index, strict=True)}
        )
        values[index] = CoefficientTable(part).interpolator().columns(at, gaps="nan")
    matrices = (*shape, at.size, 2, 2)
    return values[..., :4].reshape(matrices), values[..., 4:8].reshape(matrices), values[..., 8]


def _dataset(
    table: CoefficientTable,
    speeds: Array,
    masses: Array,
    stiffness: Array,
    damping: Array,
    load: Array,
) -> xr.Dataset:
    import xarray as xr

    dims = (*table.choices, "speed")
    clearance = table.dataset["radial_clearance"].values
    axis = dims.index("radial_clearance")
    clearance = clearance.reshape([-1 if i == axis else 1 for i in range(len(dims))])
    found = rigid_thresholds(stiffness, damping, speeds, load=load, radial_clearance=clearance)
    stable = routh_coefficients(stiffness[..., None, :, :], damping[..., None, :, :]).stable(masses)
    rates, by_sign = _driven_rates(stiffness, damping, masses)
    verdict = np.where(by_sign, _sign_verdict(rates), stable)
    known = np.asarray(np.isfinite(stiffness).all(axis=(-2, -1)))[..., None]
    with np.errstate(invalid="ignore"):
        margin = 1.0 - masses / found.critical_mass[..., None]
    flags = {
        "flag_values": np.array([-1, 0, 1, 2], dtype=np.int8),
        "flag_meanings": "unknown unstable stable undamped",
    }
    over_mass = (*dims, "mass")
    per_point = {
        "critical_mass": (found.critical_mass, "kg", "critical mass per bearing"),
        "critical_mass_dimensionless": (
            found.critical_mass_dimensionless, "1", "critical mass M c omega^2/W",
        ),
        "whirl_frequency_ratio": (
            found.whirl_frequency_ratio, "1", "whirl frequency at the threshold over shaft speed",
        ),
        "stability": (found.stability.astype(object), "1", "verdict on the critical mass"),
    }  # fmt: skip
    data: dict[str, tuple[tuple[str, ...], NDArray, dict]] = {
        name: (dims, value, {"units": units, "long_name": text})
        for name, (value, units, text) in per_point.items()
    }
    data["growth_rate"] = (
        over_mass,
        rates,
        {"units": "s-1", "long_name": "largest real part of the eigenvalues"},
    )
    data["verdict"] = (
        over_mass,
        np.where(known, verdict, UNKNOWN).astype(np.int8),
        {"units": "1", "long_name": "verdict", **flags},
    )
    data["mass_margin"] = (
        over_mass,
        margin,
        {"units": "1", "long_name": "1 - mass over critical mass"},
    )
    if "full_stiffness" in table.dataset:
        _put_full(table, speeds, masses, known[..., 0], load, data)
    coords = {d: table.dataset[d].variable for d in table.choices}
    coords["speed"] = xr.Variable("speed", speeds, {"units": "rad s-1", "long_name": "shaft speed"})
    coords["mass"] = xr.Variable("mass", masses, {"units": "kg", "long_name": "mass per bearing"})
    return xr.Dataset(data, coords, dict(table.dataset.attrs))


def _driven_rates(stiffness: Array, damping: Array, masses: Array) -> tuple[Array, Booleans]:
    """Return growth rates (..., n_mass) without undamped modes, and where there are such.

    As `Eigenmodes.leading` has it: 0 where no mode is damped or driven.
    """
    rates = growth_rate_map(stiffness, damping, masses)
    size_k, size_c = (
        np.linalg.norm(part, axis=(-2, -1))[..., None] for part in (stiffness, damping)
    )
    fastest = np.sqrt(size_k / masses) + size_c / masses
    undamped = np.zeros(rates.shape, dtype=bool)
    for index in zip(*np.nonzero(np.abs(rates) <= _DOUBTFUL * fastest), strict=True):
        k, c = stiffness[index[:-1]], damping[index[:-1]]
        found = all_eigenmodes(state_matrix(k, c, masses[index[-1]]), 2)
        undamped[index] = np.any(np.abs(found.values.real) <= found.accuracy)
        if undamped[index]:
            rates[index] = found.leading.real
    return rates, undamped


def _sign_verdict(rates: Array) -> NDArray[np.int_]:
    return np.select([rates < 0.0, rates > 0.0], [STABLE, UNSTABLE], UNDAMPED)


def _put_full(
    table: CoefficientTable,
    speeds: Array,
    masses: Array,
    known: Booleans,
    load: Array,
    data: dict[str, tuple[tuple[str, ...], NDArray, dict]],
) -> None:
    """Put in the verdicts on rotor and pads together, in place of those on the rotor alone."""
    clearance = table.dataset["radial_clearance"].values
    for name, (dims, value, attributes) in data.items():
        data[name] = dims, np.array(value), attributes
    values = {name: entry[1] for name, entry in data.items()}
    for index in np.ndindex(tuple(table.dataset.sizes[d] for d in table.choices)):
        slices = {d: slice(i, i + 1) for d, i in zip(table.choices, index, strict=True)}
        good = table.converged[index]
        if not good.any():
            continue
        part = CoefficientTable(table.dataset.isel({**slices, "speed": good}))
        support = MatrixTable.of_pads(part)
        where = dict(zip(table.choices, index, strict=True))["radial_clearance"]
        for place in np.flatnonzero(known[index]):
            at, speed = (*index, int(place)), float(speeds[place])
            k, c, m = support.matrices(speed)
            film = FilmDynamics(np.eye(len(k)), speed, k, c, mass=m, names=support.unknowns)
            found = film.threshold(load=float(load[at]), radial_clearance=float(clearance[where]))
            for name in (
                "critical_mass", "critical_mass_dimensionless", "whirl_frequency_ratio",
            ):  # fmt: skip
                value = getattr(found, name)
                values[name][at] = np.nan if value is None else value
            values["stability"][at] = str(found.stability)
            rates = rigid_growth_rates(film, masses)
            values["growth_rate"][at] = rates
            values["verdict"][at] = _sign_verdict(rates)
            values["mass_margin"][at] = 1.0 - masses / values["critical_mass"][at]
