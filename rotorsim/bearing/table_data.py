"""From operating points to a dataset, and what every table must satisfy."""

from __future__ import annotations

import datetime
import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import TableError
from ..status import SolveStatus
from .operating_point import kept_throughout
from .table_format import (
    ATTRIBUTES,
    COEFFICIENTS,
    CONSTANT,
    CONVENTIONS,
    DIMENSIONS,
    FASTEST,
    FREQUENCY,
    FULL_COEFFICIENTS,
    JOURNAL_UNKNOWNS,
    LARGEST,
    NOTES,
    PAD_MATRICES,
    SCALARS,
    SLOWEST,
    TABLE_VERSION,
    TEXTS,
    UNKNOWNS,
    cf_attributes,
)

if TYPE_CHECKING:
    import xarray as xr

    from .operating_point import FullCoefficients, OperatingPoint


def from_points(points: Sequence[OperatingPoint], attributes: dict[str, Any]) -> xr.Dataset:
    """Return dataset over thermal model, clearance and speed, both ascending."""
    if not points:
        raise TableError("a table needs at least one operating point", key="points")
    models = list(dict.fromkeys(str(p.thermal_model) for p in points))
    clearances = sorted({float(p.radial_clearance) for p in points})
    speeds = sorted({float(p.speed) for p in points})
    shape = (len(models), len(clearances), len(speeds))
    row: dict[tuple[int, int, int], OperatingPoint] = {}
    places = [{v: i for i, v in enumerate(axis)} for axis in (models, clearances, speeds)]
    for point in points:
        key = (str(point.thermal_model), float(point.radial_clearance), float(point.speed))
        index = (places[0][key[0]], places[1][key[1]], places[2][key[2]])
        if index in row:
            raise TableError(f"{_describe(key)} occurs twice", key="points")
        row[index] = point
    for index in np.ndindex(shape):
        if index not in row:
            key = (models[index[0]], clearances[index[1]], speeds[index[2]])
            raise TableError(f"{_describe(key)} is missing", key="points")
    ordered = [row[index] for index in np.ndindex(shape)]
    columns = _columns(ordered)
    variables = {name: values.reshape(shape) for name, values in columns.items()}
    dataset = build(
        dict(zip(DIMENSIONS, (models, clearances, speeds), strict=True)), variables, attributes
    )
    return _with_pads(_with_frequency(dataset, ordered, shape), ordered, shape)


def _with_pads(
    dataset: xr.Dataset, points: Sequence[OperatingPoint], shape: tuple[int, ...]
) -> xr.Dataset:
    """Add K, C and M over journal and pads, where there are pads.

    NaN in the rows and columns of pads without load, and where a point did not converge.
    """
    names = list(
        dict.fromkeys(
            name
            for point in points
            if point.pads and point.coefficients_full is not None
            for name in point.coefficients_full.names
        )
    )
    if not names:
        return dataset
    names.sort(key=lambda name: (name.partition("_")[2].isdigit(), _pad_number(name)))
    values = np.full((3, len(points), len(names), len(names)), np.nan)
    for number, point in enumerate(points):
        full = point.coefficients_full
        if full is None:
            continue
        at = np.array([names.index(name) for name in full.names])
        for kind, matrix in enumerate((full.stiffness, full.damping, full.mass)):
            values[kind, number, at[:, None], at] = matrix
    dimensions = (*DIMENSIONS, *UNKNOWNS)
    size = len(names)
    variables: dict[str, Any] = {
        name: (dimensions, values[kind].reshape(*shape, size, size), cf_attributes(name))
        for kind, name in enumerate(PAD_MATRICES)
    }
    synchronous = [p.critical_mass_synchronous for p in points]
    column = np.array([np.nan if value is None else value for value in synchronous])
    name = "critical_mass_synchronous"
    variables[name] = (DIMENSIONS, column.reshape(shape), cf_attributes(name))
    text = _text(names)
    return dataset.assign(variables).assign_coords(
        {name: (name, text, cf_attributes(name)) for name in UNKNOWNS}
    )


def common_unknowns(dataset: xr.Dataset) -> tuple[list[str], np.ndarray]:
    """Return names and K, C, M (3, ..., k, k) over journal and pads, of pads that all points load.

    Others are eliminated at the shaft's frequency; NaN where a point did not converge.
    """
    dims = dataset["kxx"].dims
    given = np.stack([dataset[name].transpose(*dims, *UNKNOWNS).values for name in PAD_MATRICES])
    good = dataset["status"].values == str(SolveStatus.CONVERGED)
    speeds = dataset["speed"].broadcast_like(dataset["kxx"]).transpose(*dims).values
    names = [str(name) for name in dataset["unknown"].values]
    own, kept = kept_throughout(speeds[good], given[:, good])
    values = np.full((3, *good.shape, own.size, own.size), np.nan)
    values[:, good] = kept
    return [names[place] for place in own], values


def _pad_number(name: str) -> int:
    number = name.rpartition("_")[2]
    return int(number) if number.isdigit() else 0


def _with_frequency(
    dataset: xr.Dataset, points: Sequence[OperatingPoint], shape: tuple[int, ...]
) -> xr.Dataset:
    """Add K and C over the whirl frequency, where points hold them; NaN where one does not."""
    given = [p.frequency_coefficients for p in points]
    first = next((one for one in given if one is not None), None)
    if first is None:
        return dataset
    ratios = first.frequency_ratio
    gap = np.full((ratios.size, 8), np.nan)
    values = np.array(
        [
            gap
            if one is None
            else np.hstack([one.stiffness.reshape(-1, 4), one.damping.reshape(-1, 4)])
            for one in given
        ]
    )
    values = np.moveaxis(values.reshape(*shape, ratios.size, 8), -2, -3)
    dimensions = (*DIMENSIONS[:-1], FREQUENCY, DIMENSIONS[-1])
    names = [f"{name}_of_frequency" for name in COEFFICIENTS]
    variables = {
        name: (dimensions, values[..., i], cf_attributes(name)) for i, name in enumerate(names)
    }
    return dataset.assign(variables).assign_coords(
        {FREQUENCY: (FREQUENCY, ratios, cf_attributes(FREQUENCY))}
    )


def build(
    coordinates: dict[str, Any],
    variables: dict[str, np.ndarray],
    attributes: dict[str, Any],
    like: xr.Dataset | None = None,
) -> xr.Dataset:
    """Return dataset with CF attributes from coordinates (in order) and arrays over all of them.

    Dimensions made by `stack` have the attributes that they have in `like`.
    """
    import xarray as xr

    def attributes_of(name: str) -> dict[str, str]:
        if name not in ATTRIBUTES and like is not None:
            return dict(like[name].attrs)
        return cf_attributes(name)

    dimensions = tuple(coordinates)
    coords = {
        name: (
            name,
            _text(values) if name == "thermal_model" else np.asarray(values, dtype=float),
            attributes_of(name),
        )
        for name, values in coordinates.items()
    }
    data = {name: (dimensions, values, cf_attributes(name)) for name, values in variables.items()}
    return xr.Dataset(data, coords, attributes)


def _describe(key: tuple[str, float, float]) -> str:
    return f"the point ({key[0]}, clearance {key[1]:.6g} m, {key[2]:.6g} rad/s)"


def _text(values: Sequence[Any]) -> np.ndarray:
    result = np.empty(len(values), dtype=object)
    result[:] = [str(v) for v in values]
    return result


def _columns(points: Sequence[OperatingPoint]) -> dict[str, np.ndarray]:
    stiffness = np.array([np.asarray(p.stiffness, dtype=float).ravel() for p in points])
    damping = np.array([np.asarray(p.damping, dtype=float).ravel() for p in points])
    values = np.hstack([stiffness, damping])
    columns: dict[str, np.ndarray] = {name: values[:, i] for i, name in enumerate(COEFFICIENTS)}
    moments = np.array([np.asarray(p.moment, dtype=float) for p in points])
    columns["moment_x"], columns["moment_y"] = moments[:, 0], moments[:, 1]
    if any(_is_journal_only(p.coefficients_full) for p in points):
        full = np.array([_full_row(p) for p in points])
        columns.update(zip(FULL_COEFFICIENTS, full.T, strict=True))
    for name in SCALARS:
        column = [getattr(p, name) for p in points]
        columns[name] = np.array([np.nan if v is None else float(v) for v in column])
    columns["iterations"] = np.array([int(p.iterations) for p in points])
    for name in TEXTS:
        column = [getattr(p, name) for p in points]
        columns[name] = _text(["" if v is None else v for v in column])
    return columns


def _is_journal_only(full: FullCoefficients | None) -> bool:
    """Return whether there are displacements and rotations of the journal, and no pads."""
    return full is not None and full.names == JOURNAL_UNKNOWNS


def _full_row(point: OperatingPoint) -> np.ndarray:
    """Return the full K and C, row by row; NaN where the point has none."""
    full = point.coefficients_full
    if full is None:
        return np.full(len(FULL_COEFFICIENTS), np.nan)
    return np.concatenate([full.stiffness.ravel(), full.damping.ravel()])


def stack(
    datasets: Sequence[xr.Dataset], dimension: str, values: Sequence[float], units: str
) -> xr.Dataset:
    """Join datasets along a new dimension, put before the speed."""
    import xarray as xr

    if len(datasets) != len(values) or not datasets:
        raise TableError("one value for each table is needed", key=dimension, value=values)
    if dimension in datasets[0].variables:
        raise TableError("the name is taken; choose another", key=dimension)
    if np.any(np.diff(np.asarray(values, dtype=float)) <= 0.0):
        raise TableError("values must ascend", key=dimension, value=values)
    axis = xr.Variable(dimension, np.asarray(values, dtype=float), {"units": units})
    try:
        joined = xr.concat(
            datasets,
            dim=xr.DataArray(axis),
            join="exact",
            combine_attrs="drop_conflicts",
            data_vars="all",
            coords="minimal",
            compat="equals",
        )
    except ValueError as error:
        raise TableError(
            f"the tables do not share their other coordinates ({error})", key=dimension
        ) from error
    order = [d for d in joined["kxx"].dims if d not in (dimension, "speed")]
    return joined.transpose(*order, dimension, "speed")


def with_provenance(dataset: xr.Dataset) -> xr.Dataset:
    """Add what every file states: format, frame, program version, date, scenario digest."""
    attributes = {
        key: value if isinstance(value, (str, int, float)) else str(value)
        for key, value in dataset.attrs.items()
        if value is not None
    }
    attributes.setdefault("Conventions", "CF-1.11")
    attributes.setdefault("title", "Journal bearing coefficients over speed")
    attributes.setdefault("rotorsim_version", _program_version())
    now = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
    attributes.setdefault("date", now)
    if NOTES in attributes:  # were said when the other program's file was read
        attributes["history"] = attributes.pop(NOTES)
    attributes["rotorsim_table_version"] = TABLE_VERSION
    attributes["frame"] = " ".join(CONVENTIONS)
    if "scenario" in attributes:
        attributes["scenario_sha256"] = scenario_digest(str(attributes["scenario"]))
    return dataset.assign_attrs(attributes)


def _program_version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("rotorsim")
    except PackageNotFoundError:
        return "unknown"


def check(dataset: xr.Dataset, source: str | Path | None = None) -> None:
    """Raise `TableError` unless the dataset is a usable table."""
    missing = [n for n in (*DIMENSIONS, *COEFFICIENTS, "status") if n not in dataset.variables]
    if missing:
        raise TableError(f"variables are missing: {', '.join(missing)}", source=source)
    dims = dataset["kxx"].dims
    if not set(DIMENSIONS) <= set(dims) or dims[-1] != "speed":
        raise TableError(
            f"dimensions must be thermal_model, radial_clearance and, last, speed, not {dims}",
            source=source,
        )
    if any(dataset[name].dims != dims for name in (*COEFFICIENTS, "status")):
        raise TableError("kxx ... cyy and status must share their dimensions", source=source)
    if any(dataset[name].dims != (name,) for name in DIMENSIONS):
        raise TableError("coordinates must have one dimension, their own", source=source)
    _check_numbers(dataset, source)
    converged = np.asarray(dataset["status"].values == str(SolveStatus.CONVERGED))
    for name in COEFFICIENTS:
        values = dataset[name].values
        for bad, words in (
            (converged & ~np.isfinite(values), "not a number at a converged point"),
            (np.abs(values) > LARGEST, f"is beyond every sensible coefficient ({LARGEST:g})"),
        ):
            if bad.any():
                place = np.argwhere(bad)[0]
                at = ", ".join(
                    f"{d}={dataset[d].values[i]}" for d, i in zip(dims, place, strict=True)
                )
                raise TableError(f"{words} ({at})", source=source, key=name)


def _check_numbers(dataset: xr.Dataset, source: str | Path | None) -> None:
    """Raise `TableError` unless numbers are real numbers, and speeds and clearances sensible."""
    numeric = ("speed", "radial_clearance", *COEFFICIENTS, *SCALARS)
    for name in (n for n in numeric if n in dataset.variables):
        if dataset[name].dtype.kind not in "fiu":
            raise TableError("must be real numbers", source=source, key=name)
    if CONSTANT in dataset.attrs and not all(
        np.array_equal(values, np.broadcast_to(values[..., :1], values.shape), equal_nan=True)
        for values in (dataset[name].values for name in COEFFICIENTS)
    ):
        raise TableError("constant coefficients differ between speeds", source=source, key=CONSTANT)
    speed = np.asarray(dataset["speed"].values, dtype=float)
    if not speed.size or not np.all(np.isfinite(speed)) or np.any(np.diff(speed) <= 0.0):
        raise TableError("speeds must be finite and ascend", source=source, key="speed")
    if speed[0] < SLOWEST or speed[-1] > FASTEST:
        raise TableError(
            f"speeds must be {SLOWEST:g} to {FASTEST:g} rad/s", source=source, key="speed",
            value=float(speed[0] if speed[0] < SLOWEST else speed[-1]),
        )  # fmt: skip
    clearance = np.asarray(dataset["radial_clearance"].values, dtype=float)
    unknown = clearance.size == 1 and np.isnan(clearance[0])
    if not unknown and not np.all((clearance > 0.0) & (clearance < 1.0)):
        raise TableError("must be between 0 and 1 m", source=source, key="radial_clearance")


def without_standstill(dataset: xr.Dataset, source: str | Path) -> xr.Dataset:
    """Leave out the speed 0, at which nothing whirls, and note it; other tables as they are."""
    if dataset["speed"].values[0] != 0.0:
        return dataset
    if dataset.sizes["speed"] == 1:
        raise TableError("holds the speed 0 only", source=source, key="speed")
    notes = [*filter(None, [dataset.attrs.get(NOTES)]), "the row at speed 0 is left out"]
    return dataset.isel(speed=slice(1, None)).assign_attrs({NOTES: "\n".join(notes)})


def scenario_digest(text: str) -> str:
    """Return SHA-256 of a scenario's text (UTF-8), hexadecimal."""
    return hashlib.sha256(text.encode()).hexdigest()
