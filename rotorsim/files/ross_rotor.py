"""Rotors as ROSS saves them, as the tables of a machine file."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..arguments import file_path
from ..bearing.table import CoefficientTable
from ..errors import TableError
from .ross import BEARING_KEYS, WEIGHT, entries_of, from_ross, numbers_of, speed_axis, table_of

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
    entries = entries_of(source)
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
            if set(entry) >= BEARING_KEYS
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
                numbers_of(entry | {"default": default}, part if part in entry else "default", 1,
                        self.source)
                for part, default in (
                    (f"{letter}xx", 0.0), (f"{letter}xy", 0.0), (f"{letter}yx", 0.0),
                    (f"{letter}yy", direct),
                )
            ]  # fmt: skip
            matrix = from_ross(np.array(values, dtype=float).reshape(2, 2), WEIGHT) + 0.0
            if matrix.any() or key == "stiffness":
                found[key] = matrix.tolist()
        del name
        return found

    def _support(
        self, name: str, entry: _Table, carriers: dict[str, _Table], masses: dict[int, _Table]
    ) -> _Table:
        tag = str(entry.get("tag") or name.partition("_")[2])
        support: _Table = {"at": self._place(name, entry), "name": tag}
        axis = speed_axis(entry, self.source)
        if axis is None:
            support |= self._constants(name, entry)
        else:
            table = table_of({**entry, "n_link": None}, self.ross3 or "interpolation" in entry,
                           WEIGHT, self.source)  # fmt: skip
            file = "".join(c if c.isalnum() else "_" for c in tag) + ".csv"
            support["coefficients"] = file
            self.tables[file] = table
            self.notes += [f"{tag}: {note}" for note in table.notes]
        link = entry.get("n_link")
        if link is None:
            return support
        below = [one for one in carriers.items() if int(one[1]["n"]) == int(link)]
        if len(below) != 1 or speed_axis(below[0][1], self.source) is not None:
            raise TableError(
                "what carries this node must be one bearing of constant coefficients (a pedestal)",
                source=self.source, key=f"{name}.n_link", value=link,
            )  # fmt: skip
        stand = self._constants(*below[0])
        x, y = self._mass(masses.get(int(link), {}))
        own = np.array(stand.pop("mass", [[0.0, 0.0], [0.0, 0.0]])) + np.diag([y, x])
        support["pedestal"] = {"mass": own.tolist(), **stand}
        return support
