"""Bearings as ROSS saves them: ``BearingElement.load`` reads the files, and its own are read here.

A file is TOML, which allows comments, or on reading JSON; one table whose keys are the arguments of
ROSS's ``BearingElement``. Where the static load is not the weight, a second table, which ROSS does
not look at, says where it points: ``[rotorsim]`` with ``load_direction = "45 deg"``.
"""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..atomic import write_text
from ..bearing.table import CoefficientTable
from ..bearing.table_data import COEFFICIENTS, SIGNS
from ..errors import InputError, TableError
from ..units import parse_quantity
from .curves import Curve

if TYPE_CHECKING:
    from numpy.typing import NDArray

WEIGHT = -0.5 * math.pi
"""Direction of the weight in the frame of ROSS [rad]: along -y."""

_WEIGHT_FRAME = (
    "Frame of ROSS: z along the shaft, the shaft turning from x to y, y up; the static load is",
    "the weight, along -y.",
    *SIGNS,
    "From rotorsim's load frame (x_l along the load, y_l 90 degrees ahead of it with the",
    "rotation): x = y_l, y = -x_l, so that kxx = k_yy, kxy = -k_yx, kyx = -k_xy, kyy = k_xx",
    "(on the right in the load frame), and the same for c. Where the load points elsewhere in your",
    "model, turn the coefficients to it first.",
)


def frame_of_ross(load_direction: float = WEIGHT) -> tuple[str, ...]:
    """Lines that say what coefficients in the frame of ROSS mean.

    Parameters
    ----------
    load_direction : float
        Where the static load points [rad], from x of ROSS towards its y.
    """
    degrees = in_degrees(load_direction)
    if degrees == in_degrees(WEIGHT):
        return _WEIGHT_FRAME
    return (
        "Frame of ROSS: z along the shaft, the shaft turning from x to y, y up; the static load",
        f"points {degrees:.13g} degrees from x towards y.",
        *SIGNS,
        "From rotorsim's load frame (x_l along the load, y_l 90 degrees ahead of it with the",
        "rotation): x = cos x_l - sin y_l, y = sin x_l + cos y_l, with cos and sin of",
        f"{degrees:.13g} degrees, so that",
        "kxx = cos^2 k_xx - sin cos (k_xy + k_yx) + sin^2 k_yy",
        "kxy = cos^2 k_xy + sin cos (k_xx - k_yy) - sin^2 k_yx",
        "kyx = cos^2 k_yx + sin cos (k_xx - k_yy) - sin^2 k_xy",
        "kyy = cos^2 k_yy + sin cos (k_xy + k_yx) + sin^2 k_xx",
        "(on the right in the load frame), and the same for c.",
    )


def in_degrees(load_direction: float) -> float:
    """Direction in degrees, from -180 to 180.

    Rounded to 1e-10, so that what a file says of it is what its numbers were turned by.

    Raises
    ------
    TableError
        Not finite.

    Examples
    --------
    >>> in_degrees(1.5 * math.pi)
    -90.0
    """
    if not math.isfinite(load_direction):
        raise TableError("must be a finite angle", key="load_direction", value=load_direction)
    return round(math.remainder(math.degrees(load_direction), 360.0), 10)


def to_ross(matrices: NDArray[np.float64], load_direction: float = WEIGHT) -> NDArray[np.float64]:
    """Turn (..., 2, 2) matrices from the load frame to the frame of ROSS.

    Parameters
    ----------
    matrices : (..., 2, 2) array
        Stiffness or damping.
    load_direction : float
        Where the static load points [rad], from x of ROSS towards its y.

    Examples
    --------
    >>> to_ross(np.array([[1.0, 2.0], [3.0, 4.0]])).tolist()
    [[4.0, -3.0], [-2.0, 1.0]]
    """
    turn = _turn(load_direction)
    return turn @ matrices @ turn.T


def from_ross(matrices: NDArray[np.float64], load_direction: float = WEIGHT) -> NDArray[np.float64]:
    """Inverse of `to_ross`."""
    turn = _turn(load_direction)
    return turn.T @ matrices @ turn


def _turn(load_direction: float) -> NDArray[np.float64]:
    """(2, 2): components in the frame of ROSS from those in the load frame."""
    degrees = in_degrees(load_direction)
    cosine, sine = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    if degrees % 90.0 == 0.0:  # numbers only change places and signs, to the last digit
        cosine, sine = round(cosine), round(sine)
    return np.array([[cosine, -sine], [sine, cosine]], dtype=float)


_MAX_BYTES = 50_000_000
_OWN, _DIRECTION = "rotorsim", "load_direction"


def write(curve: Curve, path: Path, load_direction: float = WEIGHT) -> Path:
    """Write one curve as a file for ``ross.BearingElement.load``.

    ``load_direction`` is that of the static load in the frame of ROSS [rad], from x towards y.
    """
    head = [
        *curve.facts,
        f'Read it with: bearing = ross.BearingElement.load("{path.name}"), then set bearing.n',
        "(the node; the file says 0), and another bearing.tag for each use. Speeds (frequency) in",
        "rad/s, the shaft's.",
        *frame_of_ross(load_direction),
    ]
    tag = "".join(letter for letter in path.stem.removesuffix(".ross") if letter.isprintable())
    stiffness = to_ross(curve.stiffness, load_direction).reshape(-1, 4)
    damping = to_ross(curve.damping, load_direction).reshape(-1, 4)
    lines = [f"# {line}" for fact in head for line in fact.splitlines()]
    # The dots and quotes a name may hold would end a bare key.
    lines += ["", f"[{json.dumps('BearingElement_' + tag)}]", "n = 0", f"tag = {json.dumps(tag)}"]
    columns = {
        "frequency": curve.speed,
        **dict(zip(COEFFICIENTS, np.hstack([stiffness, damping]).T, strict=True)),
    }
    # Adding 0.0 turns the negative zeros that turning makes into zeros.
    lines += [
        f"{name} = [{', '.join(repr(float(value) + 0.0) for value in column)}]"
        for name, column in columns.items()
    ]
    degrees = in_degrees(load_direction)
    if degrees != in_degrees(WEIGHT):  # after the bearing: ROSS loads the first table
        lines += ["", f"[{_OWN}]", f'{_DIRECTION} = "{degrees:.13g} deg"']
    write_text(path, "\n".join(lines) + "\n")
    return path


def is_saved_by_ross(path: Path) -> bool:
    """Whether a file is TOML or JSON with a bearing in it."""
    try:
        return _is_ross(_entries(path))
    except TableError:
        return False


def _is_ross(entries: Any) -> bool:
    """Whether a file's entries are elements that ROSS saved."""
    return isinstance(entries, dict) and any(
        isinstance(entry, dict) and {"kxx", "cxx"} <= set(entry) for entry in entries.values()
    )


def read(path: str | Path, load_direction: float | None = None) -> CoefficientTable:
    """Table of the one bearing that ROSS, or `write`, saved to `path` (TOML or JSON).

    Parameters
    ----------
    path : str or Path
    load_direction : float, optional
        Where the static load points in the frame of ROSS [rad], from x towards y; by default what
        the file says, and if it says nothing along -y.

    Raises
    ------
    TableError
        Not such a file, several bearings, no speeds, coefficients that are no numbers, or a file
        that says another `load_direction`.
    """
    source = Path(path)
    entries = _entries(source)
    if not _is_ross(entries):
        raise TableError("not a bearing that ROSS saved: no entry has kxx and cxx", source=source)
    bearings = [e for e in entries.values() if isinstance(e, dict) and {"kxx", "cxx"} <= set(e)]
    if len(bearings) > 1:
        raise TableError("holds several bearings; save each to a file of its own", source=source)
    return _table(bearings[0], _direction(entries, load_direction, source), source)


def _direction(entries: dict[str, Any], given: float | None, source: Path) -> float:
    """Direction of the static load [rad]: the file's, or `given`, or that of the weight."""
    if _OWN not in entries:
        return WEIGHT if given is None else given
    own, key = entries[_OWN], f"{_OWN}.{_DIRECTION}"
    if not isinstance(own, dict) or set(own) != {_DIRECTION}:
        raise TableError(f"must hold {_DIRECTION} and nothing else", source=source, key=_OWN)
    try:
        stated = parse_quantity(own[_DIRECTION], "angle")
    except InputError as error:
        raise TableError(error.message, source=source, key=key, value=error.value) from None
    if given is not None and in_degrees(given) != in_degrees(stated):
        message = f"another direction was given ({in_degrees(given):.13g} deg); leave it away"
        raise TableError(message, source=source, key=key, value=own[_DIRECTION])
    return stated


def _entries(source: Path) -> Any:
    try:
        if source.stat().st_size > _MAX_BYTES:
            raise TableError("too large to be a bearing", source=source)
        text = source.read_text(encoding="utf-8-sig")
        return json.loads(text) if source.suffix.lower() == ".json" else tomllib.loads(text)
    except OSError as error:
        raise TableError(f"cannot be read: {error.strerror}", source=source) from None
    except (ValueError, RecursionError) as error:
        raise TableError(f"not a TOML or JSON file: {error}", source=source) from None


def _table(bearing: dict[str, Any], load_direction: float, source: Path) -> CoefficientTable:
    from ..bearing.table_data import build

    if bearing.get("frequency") is None:
        raise TableError(
            "has constant coefficients; give their speed in rad/s as a list frequency = [...]",
            source=source,
            key="frequency",
        )
    speeds = _column(bearing, "frequency", None, source)
    if not speeds.size or speeds[0] <= 0.0 or np.any(np.diff(speeds) <= 0.0):
        raise TableError("must be above 0 and ascend", source=source, key="frequency")
    # As in ROSS: the second direct coefficient defaults to the first, the cross ones to zero.
    given = {"kyy": bearing["kxx"], "cyy": bearing["cxx"]} | bearing
    columns = [_column(given, name, speeds.size, source) for name in COEFFICIENTS]
    inertia = [n for n in ("mxx", "mxy", "myx", "myy") if np.any(np.asarray(given.get(n, 0.0)))]
    if inertia:
        raise TableError("added mass is not known here", source=source, key=inertia[0])
    values = np.stack(columns, axis=-1).reshape(1, 1, -1, 2, 2, 2)
    turned = from_ross(values, load_direction).reshape(1, 1, -1, 8)
    variables: dict[str, Any] = {n: turned[..., i] for i, n in enumerate(COEFFICIENTS)}
    variables["status"] = np.full(turned.shape[:-1], "converged", dtype=object)
    coordinates = {"thermal_model": ["given"], "radial_clearance": [np.nan], "speed": speeds}
    title = f"Coefficients from {source.name}"
    return CoefficientTable(build(coordinates, variables, {"title": title}))


def _column(
    bearing: dict[str, Any], name: str, count: int | None, source: Path
) -> NDArray[np.float64]:
    value = bearing.get(name, 0.0)
    numbers = value if isinstance(value, list) else [value] * (count or 1)
    if count is not None and len(numbers) != count:
        raise TableError(f"has {len(numbers)} values for {count} speeds", source=source, key=name)
    if not all(isinstance(n, (int, float)) and abs(n) < 1e300 for n in numbers):
        raise TableError("must be finite numbers", source=source, key=name)
    return np.array(numbers, dtype=float)
