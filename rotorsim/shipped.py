"""The scenarios that come with the program, in the source tree and in the installed package."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).parent


def shipped_scenarios() -> dict[str, Path]:
    """Files of the shipped scenarios by name.

    Examples
    --------
    >>> shipped_scenarios()["dal"].name
    'dal.toml'
    """
    # The build copies them into the package; in the source tree they lie beside it.
    for folder in (_PACKAGE / "data" / "scenarios", _PACKAGE.parent / "scenarios"):
        if folder.is_dir():
            return {path.stem: path for path in sorted(folder.glob("*.toml"))}
    return {}
