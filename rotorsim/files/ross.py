"""Bearings as ROSS saves them: ``BearingElement.load`` reads the files, and its own are read here.

A file is TOML, which allows comments, or on reading JSON; a table for each element, whose keys are
the arguments of its class. Where the static load is not the weight, a further table, which ROSS
does not look at, says where it points: ``[rotorsim]`` with ``load_direction = "45 deg"``.

The key of the shaft's speed differs: ROSS 2 calls it ``frequency``. ROSS 3 calls it ``speed``, and
``frequency`` is the frequency of the whirl; it takes a file of ROSS 2 without a word. What ROSS 3
saves has the key ``interpolation`` in the bearing or ``ross_version`` in the file, except for a few
classes (its squeeze film damper), whose files look like those of ROSS 2.
"""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from ..arguments import file_path
from ..arrays import Array
from ..atomic import write_text
from ..bearing.table import CoefficientTable
from ..bearing.table_format import COEFFICIENTS, LARGEST, SIGNS
from ..errors import InputError, TableError
from ..file_kinds import read_bytes
from ..units import parse_quantity
from .curves import Curve

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


def _frame_of_ross(load_direction: float = WEIGHT) -> tuple[str, ...]:
    """Return lines that say what coefficients in the frame of ROSS mean.

    load_direction : Where the static load points [rad], from x of ROSS towards its y.
    """
    degrees = _in_degrees(load_direction)
    if degrees == _in_degrees(WEIGHT):
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


def _in_degrees(load_direction: float) -> float:
    """Return the direction in degrees, from -180 to 180.

    Rounded to 1e-10, so that what a file says of it is what its numbers were turned by.

    Raises TableError: Not finite.

    Examples
    --------
    >>> _in_degrees(1.5 * math.pi)
    -90.0
    """
    if not math.isfinite(load_direction):
        raise TableError("must be a finite angle", key="load_direction", value=load_direction)
    return round(math.remainder(math.degrees(load_direction), 360.0), 10)


def _to_ross(matrices: Array, load_direction: float = WEIGHT) -> Array:
    """Turn (..., 2, 2) matrices from the load frame to the frame of ROSS.

    matrices : (..., 2, 2) array. Stiffness or damping.
    load_direction : Where the static load points [rad], from x of ROSS towards its y.

    Examples
    --------
    >>> _to_ross(np.array([[1.0, 2.0], [3.0, 4.0]])).tolist()
    [[4.0, -3.0], [-2.0, 1.0]]
    """
    turn = _turn(load_direction)
    return turn @ matrices @ turn.T


def from_ross(matrices: Array, load_direction: float = WEIGHT) -> Array:
    """Return the inverse of `_to_ross`."""
    turn = _turn(load_direction)
    return turn.T @ matrices @ turn


def _turn(load_direction: float) -> Array:
    """Return (2, 2): components in the frame of ROSS from those in the load frame."""
    degrees = _in_degrees(load_direction)
    cosine, sine = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    if degrees % 90.0 == 0.0:  # numbers only change places and signs, to the last digit
        cosine, sine = round(cosine), round(sine)
    return np.array([[cosine, -sine], [sine, cosine]], dtype=float)


_MAX_BYTES = {".json": 50_000_000, ".toml": 5_000_000}
"""TOML is read slowly."""
_OWN, _DIRECTION = "rotorsim", "load_direction"
BEARING_KEYS = {"kxx", "cxx"}
_INERTIA = ("mxx", "mxy", "myx", "myy")
_AXES = {
    3: (
        "speed",
        "For ROSS 3 (speed: the shaft's, in rad/s). ROSS 2 refuses this file; rotorsim export",
        "--to ross2 writes one for it.",
    ),
    2: (
        "frequency",
        "For ROSS 2, where frequency is the shaft's speed in rad/s. ROSS 3 takes it for that of",
        "the whirl, without a word; rotorsim export --to ross writes a file for it.",
    ),
}
"""Key of the shaft's speed by version of ROSS, and what the file says of it."""


def write(curve: Curve, path: Path, load_direction: float = WEIGHT, *, version: int = 3) -> Path:
    """Write one curve as a file for ``ross.BearingElement.load``.

    load_direction : That of the static load in the frame of ROSS [rad], from x towards y.
    version : Of the ROSS that will read the file.
    """
    axis, *said = _AXES[version]
    head = [
        *curve.facts,
        f'Read it with: bearing = ross.BearingElement.load("{path.name}"), then set bearing.n',
        "(the node; the file says 0), and another bearing.tag for each use.",
        *(said if not curve.constant else ()),
        *_frame_of_ross(load_direction),
    ]
    stem = path.stem.removesuffix(".ross").removesuffix(".ross2")
    tag = "".join(letter for letter in stem if letter.isprintable())
    stiffness = _to_ross(curve.stiffness, load_direction).reshape(-1, 4)
    damping = _to_ross(curve.damping, load_direction).reshape(-1, 4)
    lines = [f"# {line}" for fact in head for line in fact.splitlines()]
    # The dots and quotes a name may hold would end a bare key.
    lines += ["", f"[{json.dumps('BearingElement_' + tag)}]", "n = 0", f"tag = {json.dumps(tag)}"]
    table = np.hstack([stiffness, damping])
    columns = dict(zip(COEFFICIENTS, (table[:1] if curve.constant else table).T, strict=True))
    if not curve.constant:
        lines += ['interpolation = "pchip"'] if version == 3 else []
        columns = {axis: curve.speed, **columns}
    # Adding 0.0 turns the negative zeros that turning makes into zeros.
    lines += [
        f"{name} = [{', '.join(repr(float(value) + 0.0) for value in column)}]"
        for name, column in columns.items()
    ]
    degrees = _in_degrees(load_direction)
    if degrees != _in_degrees(WEIGHT):  # after the bearing: ROSS loads the first table
        lines += ["", f"[{_OWN}]", f'{_DIRECTION} = "{degrees:.13g} deg"']
    write_text(path, "\n".join(lines) + "\n")
    return path


def is_saved_by_ross(path: Path) -> bool:
    """Return whether a file is TOML or JSON with a bearing in it."""
    try:
        return _is_ross(entries_of(path))
    except TableError:
        return False


def _is_ross(entries: Any) -> bool:
    """Return whether a file's entries are elements that ROSS saved."""
    return isinstance(entries, dict) and bool(_bearings(entries))


def _bearings(entries: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Return bearings (and seals) of a file, by the names of their tables."""
    return {
        name: entry
        for name, entry in entries.items()
        if isinstance(entry, dict) and set(entry) >= BEARING_KEYS
    }


def read(
    path: str | Path, load_direction: float | None = None, bearing: str | None = None
) -> CoefficientTable:
    """Return the table of a bearing that ROSS, or `write`, saved to `path` (TOML or JSON).

    path : str or Path
    load_direction : Where the static load points in the frame of ROSS [rad], from x towards y; by
        default what the file says, and if it says nothing along -y.
    bearing : Its tag, or the name of its table, in a file of several.
    Raises TableError: Not such a file, several bearings and none chosen, coefficients over both
        speed and frequency of the whirl, or that are no numbers, or a file that says another
        `load_direction`.
    """
    source = file_path(path)
    entries = entries_of(source)
    if not _is_ross(entries):
        raise TableError("not a bearing that ROSS saved: no entry has kxx and cxx", source=source)
    chosen = _chosen(_bearings(entries), bearing, source)
    ross3 = "interpolation" in chosen or str(entries.get("ross_version", "2"))[:1] >= "3"
    return table_of(chosen, ross3, _direction(entries, load_direction, source), source)


def _chosen(found: dict[str, dict[str, Any]], wanted: str | None, source: Path) -> dict[str, Any]:
    """Return the bearing of that tag or table name; the only one where none is named."""
    tags = [
        str(entry.get("tag") or name.partition("_")[2] or name) for name, entry in found.items()
    ]
    called = tags if len(set(tags)) == len(tags) else list(found)
    listed = ", ".join(
        f"{name} (node {entry.get('n', '?')})"
        for name, entry in list(zip(called, found.values(), strict=True))[:30]
    )
    if wanted is None and len(found) == 1:
        return next(iter(found.values()))
    if wanted is None:
        same = all(_numbers(one) == _numbers(next(iter(found.values()))) for one in found.values())
        raise TableError(
            f"holds several bearings: {listed}; choose one with --bearing NAME"
            + (" (their coefficients are the same)" if same else ""),
            source=source, key="--bearing",
        )  # fmt: skip
    matches = [
        entry
        for name, tag, entry in zip(found, tags, found.values(), strict=True)
        if wanted in (name, tag)
    ]
    if len(matches) != 1:
        message = "no bearing has that name" if not matches else "several bearings have that name"
        raise TableError(
            f"{message}; the file holds {listed}", source=source, key="--bearing", value=wanted
        )
    return matches[0]


def _numbers(entry: dict[str, Any]) -> dict[str, Any]:
    """Return what makes two bearings the same."""
    return {name: value for name, value in entry.items() if name not in ("n", "tag", "color")}


def _direction(entries: dict[str, Any], given: float | None, source: Path) -> float:
    """Return direction of the static load [rad]: the file's, or `given`, or that of the weight."""
    if _OWN not in entries:
        return WEIGHT if given is None else given
    own, key = entries[_OWN], f"{_OWN}.{_DIRECTION}"
    if not isinstance(own, dict) or set(own) != {_DIRECTION}:
        raise TableError(f"must hold {_DIRECTION} and nothing else", source=source, key=_OWN)
    try:
        stated = parse_quantity(own[_DIRECTION], "angle")
    except InputError as error:
        raise TableError(error.message, source=source, key=key, value=error.value) from None
    if given is not None and _in_degrees(given) != _in_degrees(stated):
        message = f"another direction was given ({_in_degrees(given):.13g} deg); leave it away"
        raise TableError(message, source=source, key=key, value=own[_DIRECTION])
    return stated


def entries_of(source: Path) -> Any:
    """Return the entries of a TOML or JSON file."""
    suffix = source.suffix.lower()
    data = read_bytes(source, _MAX_BYTES.get(suffix, _MAX_BYTES[".toml"]), TableError)
    try:
        text = data.decode("utf-8-sig")
        return json.loads(text) if suffix == ".json" else tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise TableError(f"not a TOML or JSON file: {error}", source=source) from None


def table_of(
    bearing: dict[str, Any], ross3: bool, load_direction: float, source: Path
) -> CoefficientTable:
    """Return the table of a bearing's entries."""
    from ..bearing.table_data import build, check, without_standstill
    from ..bearing.table_format import CONSTANT, CONSTANT_SPEEDS, NOTES

    axis = speed_axis(bearing, source)
    notes = []
    if axis == "frequency" and ross3:
        notes.append(
            "frequency is the frequency of the whirl (ROSS 3); each row is taken for a whirl at "
            "the shaft's speed, which is wrong for a whirl at any other frequency"
        )
    elif axis == "frequency":
        notes.append("frequency is taken for the shaft's speed, as in ROSS 2")
    if bearing.get("n_link") is not None:
        notes.append(
            f"the bearing stands on node {bearing['n_link']}: what carries that is left out"
        )
    speeds = np.array(CONSTANT_SPEEDS) if axis is None else numbers_of(bearing, axis, None, source)
    if not speeds.size or speeds[0] < 0.0 or np.any(np.diff(speeds) <= 0.0):
        raise TableError("must be 0 or more and ascend", source=source, key=axis)
    # As in ROSS: the second direct coefficient defaults to the first, the cross ones to zero.
    given = {"kyy": bearing["kxx"], "cyy": bearing["cxx"]} | bearing
    count = 1 if axis is None else speeds.size
    columns = [numbers_of(given, name, count, source) for name in (*COEFFICIENTS, *_INERTIA)]
    for name, column in zip(_INERTIA, columns[8:], strict=True):
        if np.any(column):
            raise TableError(
                "added mass is not known here: K and C alone would give another verdict",
                source=source, key=name, value=float(column[column != 0.0][0]),
            )  # fmt: skip
    values = np.stack(np.broadcast_arrays(*columns[:8], speeds)[:8], axis=-1)
    turned = from_ross(values.reshape(1, 1, -1, 2, 2, 2), load_direction).reshape(1, 1, -1, 8)
    variables: dict[str, Any] = {n: turned[..., i] for i, n in enumerate(COEFFICIENTS)}
    variables["status"] = np.full(turned.shape[:-1], "converged", dtype=object)
    coordinates = {"thermal_model": ["given"], "radial_clearance": [np.nan], "speed": speeds}
    attributes: dict[str, Any] = {"title": f"Coefficients from {source.name}"}
    attributes |= {CONSTANT: 1} if axis is None else {}
    attributes |= {NOTES: "\n".join(notes)} if notes else {}
    found = without_standstill(build(coordinates, variables, attributes), source)
    check(found, source)
    return CoefficientTable(found)


def speed_axis(bearing: dict[str, Any], source: Path) -> str | None:
    """Return the key of the speeds or frequencies; None for constant coefficients.

    Raises TableError: The coefficients depend on both.
    """
    speed, frequency = (bearing.get(name) is not None for name in ("speed", "frequency"))
    if speed and frequency:
        raise TableError(
            "a table over speed and whirl frequency (ROSS 3); coefficients here depend on the "
            "speed alone: save those for one whirl frequency, such as the shaft's, over speed",
            source=source, key="speed, frequency",
        )  # fmt: skip
    return "speed" if speed else "frequency" if frequency else None


def numbers_of(bearing: dict[str, Any], name: str, count: int | None, source: Path) -> Array:
    """Return numbers of a key: `count`, or one that holds for all."""
    value = bearing.get(name, 0.0)
    numbers = value if isinstance(value, list) else [value]
    if count is not None and len(numbers) not in (1, count):
        speeds = f"{count} speeds" if count > 1 else "one speed, or none"
        raise TableError(f"has {len(numbers)} values for {speeds}", source=source, key=name)
    for number in numbers:
        if isinstance(number, bool) or not isinstance(number, (int, float)):
            raise TableError("must be finite numbers", source=source, key=name)
        if not abs(number) <= LARGEST:
            raise TableError(
                f"must be finite numbers, at most {LARGEST:g}", source=source, key=name
            )
    return np.array(numbers, dtype=float)
