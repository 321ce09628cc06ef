"""Files that come with the program, in the source tree and in the installed package."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).parent
_TABLES = ("dal",)
"""A source tree's folder of tables holds the user's own as well."""


def shipped_scenarios() -> dict[str, Path]:
    """Return files of the shipped scenarios by name.

    Examples
    --------
    >>> shipped_scenarios()["dal"].name
    'dal.toml'
    """
    return {path.stem: path for path in sorted(_folder("scenarios").glob("*.toml"))}


def shipped_machines() -> dict[str, Path]:
    """Return files of the shipped machines by name.

    Those of their bearings lie in a folder beside them.

    Examples
    --------
    >>> shipped_machines()["machines/friswell"].name
    'friswell.toml'
    """
    folder = _folder("scenarios") / "machines"
    return {f"machines/{path.stem}": path for path in sorted(folder.glob("*.toml"))}


def shipped_tables() -> dict[str, Path]:
    """Return files of the shipped coefficient tables by name.

    Examples
    --------
    >>> shipped_tables()["dal"].name
    'dal.nc'
    """
    folder = _folder("coefficients")
    return {name: folder / f"{name}.nc" for name in _TABLES if (folder / f"{name}.nc").is_file()}


def shipped_file(name: str) -> Path | None:
    """Return the file of a name: ``dal`` (scenario), ``dal.nc`` (table), ``machines/train``."""
    if name.endswith(".nc"):
        return shipped_tables().get(name.removesuffix(".nc"))
    return shipped_scenarios().get(name) or shipped_machines().get(name)


def _folder(name: str) -> Path:
    # The build copies it into the package; in the source tree it lies beside it.
    inside = _PACKAGE / "data" / name
    return inside if inside.is_dir() else _PACKAGE.parent / name
