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
import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arguments import file_path
from ..arrays import Array
from ..atomic import write_text
from ..bearing.table import CoefficientTable
from ..bearing.table_data import COEFFICIENTS, LARGEST, SIGNS
from ..errors import InputError, TableError
from ..file_kinds import read_bytes
from ..units import parse_quantity

if TYPE_CHECKING:
    from ..bearing.table import CoefficientTable


_WEIGHT = -0.5 * math.pi
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


def _frame_of_ross(load_direction: float = _WEIGHT) -> tuple[str, ...]:
    """Return lines that say what coefficients in the frame of ROSS mean.

    load_direction : Where the static load points [rad], from x of ROSS towards its y.
    """
    degrees = _in_degrees(load_direction)
    if degrees == _in_degrees(_WEIGHT):
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


def _to_ross(matrices: Array, load_direction: float = _WEIGHT) -> Array:
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


def _from_ross(matrices: Array, load_direction: float = _WEIGHT) -> Array:
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
_BEARING_KEYS = {"kxx", "cxx"}
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


def write(curve: Curve, path: Path, load_direction: float = _WEIGHT, *, version: int = 3) -> Path:
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
    if degrees != _in_degrees(_WEIGHT):  # after the bearing: ROSS loads the first table
        lines += ["", f"[{_OWN}]", f'{_DIRECTION} = "{degrees:.13g} deg"']
    write_text(path, "\n".join(lines) + "\n")
    return path


def is_saved_by_ross(path: Path) -> bool:
    """Return whether a file is TOML or JSON with a bearing in it."""
    try:
        return _is_ross(_entries(path))
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
        if isinstance(entry, dict) and set(entry) >= _BEARING_KEYS
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
    entries = _entries(source)
    if not _is_ross(entries):
        raise TableError("not a bearing that ROSS saved: no entry has kxx and cxx", source=source)
    chosen = _chosen(_bearings(entries), bearing, source)
    ross3 = "interpolation" in chosen or str(entries.get("ross_version", "2"))[:1] >= "3"
    return _table(chosen, ross3, _direction(entries, load_direction, source), source)


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
        return _WEIGHT if given is None else given
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


def _entries(source: Path) -> Any:
    suffix = source.suffix.lower()
    data = read_bytes(source, _MAX_BYTES.get(suffix, _MAX_BYTES[".toml"]), TableError)
    try:
        text = data.decode("utf-8-sig")
        return json.loads(text) if suffix == ".json" else tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise TableError(f"not a TOML or JSON file: {error}", source=source) from None


def _table(
    bearing: dict[str, Any], ross3: bool, load_direction: float, source: Path
) -> CoefficientTable:
    from ..bearing.table_data import (
        CONSTANT,
        CONSTANT_SPEEDS,
        NOTES,
        build,
        check,
        without_standstill,
    )

    axis = _axis(bearing, source)
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
    speeds = np.array(CONSTANT_SPEEDS) if axis is None else _column(bearing, axis, None, source)
    if not speeds.size or speeds[0] < 0.0 or np.any(np.diff(speeds) <= 0.0):
        raise TableError("must be 0 or more and ascend", source=source, key=axis)
    # As in ROSS: the second direct coefficient defaults to the first, the cross ones to zero.
    given = {"kyy": bearing["kxx"], "cyy": bearing["cxx"]} | bearing
    count = 1 if axis is None else speeds.size
    columns = [_column(given, name, count, source) for name in (*COEFFICIENTS, *_INERTIA)]
    for name, column in zip(_INERTIA, columns[8:], strict=True):
        if np.any(column):
            raise TableError(
                "added mass is not known here: K and C alone would give another verdict",
                source=source, key=name, value=float(column[column != 0.0][0]),
            )  # fmt: skip
    values = np.stack(np.broadcast_arrays(*columns[:8], speeds)[:8], axis=-1)
    turned = _from_ross(values.reshape(1, 1, -1, 2, 2, 2), load_direction).reshape(1, 1, -1, 8)
    variables: dict[str, Any] = {n: turned[..., i] for i, n in enumerate(COEFFICIENTS)}
    variables["status"] = np.full(turned.shape[:-1], "converged", dtype=object)
    coordinates = {"thermal_model": ["given"], "radial_clearance": [np.nan], "speed": speeds}
    attributes: dict[str, Any] = {"title": f"Coefficients from {source.name}"}
    attributes |= {CONSTANT: 1} if axis is None else {}
    attributes |= {NOTES: "\n".join(notes)} if notes else {}
    found = without_standstill(build(coordinates, variables, attributes), source)
    check(found, source)
    return CoefficientTable(found)


def _axis(bearing: dict[str, Any], source: Path) -> str | None:
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


def _column(bearing: dict[str, Any], name: str, count: int | None, source: Path) -> Array:
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


RPM = 30.0 / np.pi


@dataclass(frozen=True)
class Curve:
    """Converged coefficients of one bearing over speed (SI, load frame).

    name : For a file's name: what tells this curve from the others of its table; empty if it is
        alone.
    facts : The same in words, for the file's head.
    speed : (n,) array [rad/s]
    stiffness, damping : (n, 2, 2) arrays [N/m], [N s/m]
    constant : They hold at any speed.
    """

    name: str
    facts: tuple[str, ...]
    speed: Array
    stiffness: Array
    damping: Array
    constant: bool = False


def curves(table: CoefficientTable) -> Iterator[Curve]:
    """Return every curve of `table` that has a converged point.

    Raises TableError: No point of the table converged.
    """
    values = {name: table.dataset[name].values for name in table.choices}
    title = str(table.dataset.attrs.get("title", ""))
    found = False
    for index in np.ndindex(table.converged.shape[:-1]):
        usable = table.converged[index]
        if not usable.any():
            continue
        found = True
        chosen = {n: column[i] for (n, column), i in zip(values.items(), index, strict=True)}
        left_out = table.speeds[~usable] * RPM
        facts = [title] if title else []
        facts += [_words(name, value) for name, value in chosen.items() if _known(value)]
        if table.constant:
            facts.append("Constant: the same at any speed")
        if left_out.size:
            facts.append(
                "Left out, not converged, rpm: " + ", ".join(f"{rpm:.6g}" for rpm in left_out)
            )
        yield Curve(
            name="_".join(_short(n, v) for n, v in chosen.items() if len(values[n]) > 1),
            facts=tuple(facts),
            speed=table.speeds[usable],
            stiffness=table.stiffness[index][usable],
            damping=table.damping[index][usable],
            constant=table.constant,
        )
    if not found:
        raise TableError("no point of the table converged: nothing to write", key="status")


def _known(value: Any) -> bool:
    return isinstance(value, str) or bool(np.isfinite(value))


def _words(name: str, value: Any) -> str:
    if name == "radial_clearance":
        return f"radial clearance {float(value) * 1e6:.6g} µm"
    shown = value if isinstance(value, str) else f"{float(value):.6g}"
    return f"{name.replace('_', ' ')} {shown}"


def _short(name: str, value: Any) -> str:
    if name == "radial_clearance":
        return f"{float(value) * 1e6:.6g}um"
    shown = str(value) if isinstance(value, str) else f"{name}{float(value):.6g}"
    return re.sub(r"[^A-Za-z0-9.]+", "-", shown)


UNITS = {
    "length": "m", "at": "m", "outer_diameter": "m", "inner_diameter": "m",
    "outer_diameter_right": "m", "inner_diameter_right": "m", "mass": "kg",
    "polar_inertia": "kg*m^2", "transverse_inertia": "kg*m^2", "youngs_modulus": "Pa",
    "shear_modulus": "Pa", "density": "kg/m^3", "stiffness": "N/m", "damping": "N*s/m",
    "angular_stiffness": "N*m", "axial_force": "N",
}  # fmt: skip
"""Of a machine file's keys, as `Drawing` has their numbers."""
_Table = dict[str, Any]


@dataclass
class Drawing:
    """A rotor on its supports as the tables of a machine file, SI numbers in place of texts.

    tables : Coefficients, by the name of the file that a support or seal gives.
    speeds : Range that the tables know [rad/s].
    """

    sections: list[_Table]
    discs: list[_Table]
    supports: list[_Table] = field(default_factory=list)
    seals: list[_Table] = field(default_factory=list)
    couplings: list[_Table] = field(default_factory=list)
    rotor: _Table = field(default_factory=dict)
    tables: dict[str, CoefficientTable] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    speeds: tuple[float, float] | None = None


_MATRICES = {"stiffness": "k", "damping": "c", "mass": "m"}
_UNUSUAL = {
    "torque": 0.0, "rotary_inertia": True, "gyroscopic": True, "alpha": 0.0, "beta": 0.0,
    "shear_method_calc": "cowper",
}  # fmt: skip
"""Keys of a shaft element that a machine file has nothing for, and what they may be."""


def read_rotor(path: str | Path) -> Drawing:
    """Return the drawing of a rotor that ROSS (2.x or 3.x) saved with ``Rotor.save``, TOML or JSON.

    The machine's x points down, y along the x of ROSS; the shaft turns clockwise seen from the left
    end. An element of ROSS becomes a section of one element, elements beside each other layers, a
    bearing on a node of its own with a bearing below a pedestal.
    Raises TableError: No such file, or it holds what a machine file has nothing for.
    """
    source = file_path(path)
    entries = _entries(source)
    kinds: dict[str, dict[str, _Table]] = {}
    for name, entry in entries.items() if isinstance(entries, dict) else ():
        if isinstance(entry, dict) and name.partition("_")[1]:
            kinds.setdefault(name.partition("_")[0], {})[name] = entry
    if not kinds.get("ShaftElement"):
        raise TableError("not a rotor that ROSS saved: it has no ShaftElement", source=source)
    for key in ("alpha", "beta", "default_damping_ratio", "modal_damping_ratio"):
        if (entries.get("parameters") or {}).get(key):
            raise TableError(
                "damping of the whole rotor is not taken over: set it to 0, and use modal_damping "
                "of the machine file", source=source, key=f"parameters.{key}",
            )  # fmt: skip
    try:
        return _Imported(source, kinds, str(entries.get("ross_version", "2"))[:1] >= "3").drawing()
    except (KeyError, TypeError, ValueError) as error:
        raise TableError(f"not a rotor that ROSS saved: {error!r}", source=source) from None


class _Imported:
    """Tables of a file by the kind of element."""

    def __init__(self, source: Path, kinds: dict[str, dict[str, _Table]], ross3: bool) -> None:
        self.source, self.kinds, self.ross3 = source, kinds, ross3
        self.places: dict[int, float] = {}
        self.tables: dict[str, CoefficientTable] = {}
        self.notes: list[str] = []

    def drawing(self) -> Drawing:
        """Return the whole drawing."""
        sections, rotor = self._sections()
        discs = [
            {
                "at": self._place(name, entry), "name": str(entry.get("tag") or ""),
                "mass": float(entry["m"]), "polar_inertia": float(entry["Ip"]),
                "transverse_inertia": float(entry["Id"]),
            }
            for name, entry in self.kinds.get("DiskElement", {}).items()
        ]  # fmt: skip
        masses = {int(entry["n"]): entry for entry in self.kinds.get("PointMass", {}).values()}
        on_shaft = [node for node in masses if node in self.places]
        for node in on_shaft:
            x, y = self._mass(masses[node])
            if x != y:
                raise TableError(
                    "a mass on the shaft has one value for both directions", source=self.source,
                    key=f"PointMass at node {node}",
                )  # fmt: skip
            discs.append({"at": self.places[node], "mass": x})
        carriers = {
            name: entry
            for kind, found in self.kinds.items()
            if kind not in ("ShaftElement", "DiskElement", "PointMass", "CouplingElement")
            for name, entry in found.items()
            if set(entry) >= _BEARING_KEYS
        }
        supports, seals = [], []
        for name, entry in carriers.items():
            if int(entry["n"]) in self.places:
                into = seals if "Seal" in name.partition("_")[0] else supports
                into.append(self._support(name, entry, carriers, masses))
        ranges = [table.dataset["speed"].values for table in self.tables.values()]
        known = (max(r[0] for r in ranges), min(r[-1] for r in ranges)) if ranges else None
        return Drawing(
            sections, discs, supports, seals, [], rotor, self.tables, self.notes,
            None if known is None else (float(known[0]), float(known[1])),
        )  # fmt: skip

    def _sections(self) -> tuple[list[_Table], _Table]:
        if self.kinds.get("CouplingElement"):
            raise TableError(
                "couplings are not taken over; a machine file's [[coupling]] joins two ends at one "
                "place", source=self.source, key=next(iter(self.kinds["CouplingElement"])),
            )  # fmt: skip
        named = sorted(self.kinds["ShaftElement"].items(), key=lambda one: int(one[1]["n"]))
        sections: list[_Table] = []
        for name, entry in named:
            for key, allowed in _UNUSUAL.items():
                if entry.get(key, allowed) != allowed:
                    raise TableError(
                        f"a machine file has nothing for it; it must be {allowed}",
                        source=self.source, key=f"{name}.{key}", value=entry[key],
                    )  # fmt: skip
            node, length = int(entry["n"]), float(entry["L"])
            if self.places and node not in self.places:
                raise TableError(
                    "the shaft has a gap before this node", source=self.source, key=f"{name}.n",
                    value=node,
                )  # fmt: skip
            start = self.places.setdefault(node, 0.0)
            layer = sum(int(other["n"]) == node for _, other in named[: named.index((name, entry))])
            section: _Table = {
                "length": length, "outer_diameter": float(entry["odl"]),
                "inner_diameter": float(entry["idl"]), "elements": 1,
            }  # fmt: skip
            for side, key in (("outer_diameter", "od"), ("inner_diameter", "id")):
                if entry.get(f"{key}r", entry[f"{key}l"]) != entry[f"{key}l"]:
                    section[f"{side}_right"] = float(entry[f"{key}r"])
            material = entry["material"]
            section["material"] = {
                "youngs_modulus": float(material["E"]), "density": float(material["rho"]),
                "shear_modulus": float(material["G_s"]),
            }  # fmt: skip
            if layer:
                section |= {"at": start, "layer": layer + 1}
            else:
                self.places[node + 1] = start + length
            sections.append(section)
        rotor: _Table = {}
        for key, ours in (("axial_force", "axial_force"), ("shear_effects", "shear")):
            values = {entry.get(key, {"shear_effects": True}.get(key, 0.0)) for _, entry in named}
            if len(values) > 1:
                raise TableError(
                    "must be the same for all shaft elements", source=self.source, key=key
                )
            value = values.pop()
            rotor[ours] = bool(value) if key == "shear_effects" else float(value)
        if any("layer" in section for section in sections):
            self.notes.append(
                "Layers share one shear deflection here; in ROSS each has its own (finer elements "
                "bring the two together)."
            )
        return sections, rotor

    def _place(self, name: str, entry: _Table) -> float:
        node = int(entry["n"])
        if node not in self.places:
            raise TableError("is no node of the shaft", source=self.source, key=f"{name}.n",
                             value=node)  # fmt: skip
        return self.places[node]

    def _mass(self, entry: _Table) -> tuple[float, float]:
        """Return the parts along x and y of ROSS."""
        both = entry.get("m")
        x, y = (both if entry.get(key) is None else entry[key] for key in ("mx", "my"))
        return float(x or 0.0), float(y or 0.0)

    def _constants(self, name: str, entry: _Table) -> _Table:
        """Return the constant matrices in the machine's frame."""
        found: _Table = {}
        for key, letter in _MATRICES.items():
            direct = entry.get(f"{letter}xx", 0.0)
            values = [
                _column(entry | {"default": default}, part if part in entry else "default", 1,
                        self.source)
                for part, default in (
                    (f"{letter}xx", 0.0), (f"{letter}xy", 0.0), (f"{letter}yx", 0.0),
                    (f"{letter}yy", direct),
                )
            ]  # fmt: skip
            matrix = _from_ross(np.array(values, dtype=float).reshape(2, 2), _WEIGHT) + 0.0
            if matrix.any() or key == "stiffness":
                found[key] = matrix.tolist()
        del name
        return found

    def _support(
        self, name: str, entry: _Table, carriers: dict[str, _Table], masses: dict[int, _Table]
    ) -> _Table:
        tag = str(entry.get("tag") or name.partition("_")[2])
        support: _Table = {"at": self._place(name, entry), "name": tag}
        axis = _axis(entry, self.source)
        if axis is None:
            support |= self._constants(name, entry)
        else:
            table = _table({**entry, "n_link": None}, self.ross3 or "interpolation" in entry,
                           _WEIGHT, self.source)  # fmt: skip
            file = "".join(c if c.isalnum() else "_" for c in tag) + ".csv"
            support["coefficients"] = file
            self.tables[file] = table
            self.notes += [f"{tag}: {note}" for note in table.notes]
        link = entry.get("n_link")
        if link is None:
            return support
        below = [one for one in carriers.items() if int(one[1]["n"]) == int(link)]
        if len(below) != 1 or _axis(below[0][1], self.source) is not None:
            raise TableError(
                "what carries this node must be one bearing of constant coefficients (a pedestal)",
                source=self.source, key=f"{name}.n_link", value=link,
            )  # fmt: skip
        stand = self._constants(*below[0])
        x, y = self._mass(masses.get(int(link), {}))
        own = np.array(stand.pop("mass", [[0.0, 0.0], [0.0, 0.0]])) + np.diag([y, x])
        support["pedestal"] = {"mass": own.tolist(), **stand}
        return support
