"""Tables on disk: netCDF 4, written in one stroke, refused when damaged."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..atomic import replacing
from ..errors import TableError
from ..file_kinds import FileKind, kind_of, sentence
from .table_data import TABLE_VERSION, scenario_digest

if TYPE_CHECKING:
    import xarray as xr


def write(dataset: xr.Dataset, path: str | Path) -> Path:
    """Write `dataset`; an existing file is replaced only by a complete one.

    Raises
    ------
    TableError
        The file cannot be written.
    """
    target = Path(path)
    # The checksum lets a reader notice a damaged block; it needs chunked storage.
    encoding: dict[str, dict[str, Any]] = {
        str(name): {"fletcher32": True, "chunksizes": variable.shape}
        for name, variable in dataset.data_vars.items()
        if variable.dtype.kind in "fi" and variable.size
    }
    try:
        with replacing(target) as temporary:
            dataset.to_netcdf(temporary, engine="h5netcdf", format="NETCDF4", encoding=encoding)
    except OSError as error:
        raise TableError(f"cannot be written: {error}", source=target) from error
    return target


def read(path: str | Path) -> xr.Dataset:
    """Read a table's dataset into memory.

    Raises
    ------
    TableError
        The file is missing, damaged, not a table, or of a newer format.
    """
    import xarray as xr

    source = Path(path)
    if not source.is_file():
        raise TableError("no such file; `rotorsim table SCENARIO` makes one", source=source)
    kind = kind_of(source)
    if kind not in (None, FileKind.NETCDF):
        reader = "; CoefficientTable.from_csv reads one" if kind is FileKind.CSV else ""
        raise TableError(f"{sentence(kind)}{reader}; here a netCDF table is needed", source=source)
    try:
        with xr.open_dataset(source, engine="h5netcdf") as opened:
            dataset = opened.load()
    except (OSError, ValueError, KeyError, RuntimeError, TypeError) as error:
        raise TableError(
            f"not a readable netCDF file, it may be truncated or damaged ({error}); "
            "make it again with `rotorsim table`",
            source=source,
        ) from error
    _check_provenance(dataset, source)
    for variable in dataset.variables.values():
        variable.encoding = {}
    return dataset


def _check_provenance(dataset: xr.Dataset, source: Path) -> None:
    if "decay_rate" in dataset:
        raise TableError(
            "decay_rate was the largest real part of the eigenvalues in maps and its negative in "
            "JSON; both are now growth_rate, positive when unstable: make this file again with "
            "`rotorsim stability`",
            source=source,
            key="decay_rate",
        )
    version = dataset.attrs.get("rotorsim_table_version")
    if version is None:
        raise TableError(
            "not a coefficient table: the attribute rotorsim_table_version is missing",
            source=source,
        )
    if int(version) > TABLE_VERSION:
        raise TableError(
            f"written in table format {int(version)}, this program reads up to {TABLE_VERSION}; "
            "use a newer rotorsim",
            source=source,
        )
    text, digest = dataset.attrs.get("scenario"), dataset.attrs.get("scenario_sha256")
    if (text is None) != (digest is None) or (text is not None and scenario_digest(text) != digest):
        raise TableError(
            "the scenario's text does not match its SHA-256: the file was changed after it was "
            "written; make it again with `rotorsim table`",
            source=source,
            key="scenario_sha256",
        )
