"""Parameters of a machine, by name: for maps, tolerances and sensitivities.

``speed``, ``drive end.radial_clearance``, ``impeller.destabilising_stiffness``: a word of
`PARAMETERS`, and before a dot whose it is.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arguments import ascending_values
from ..errors import InputError
from ..model.entries import Quantity, nearest
from ..model.tolerances import Spread, parse_spread
from ..units import parse_quantity

if TYPE_CHECKING:
    from .machine import MachineFile


@dataclass(frozen=True)
class _Kind:
    """A parameter's quantity, and what it changes.

    quantity : Name in `rotorsim.units.QUANTITIES`; None: a plain factor.
    owner : ``film`` (a support with a bearing file; without a name all of them), ``support``,
        ``disc``, ``place`` or nothing.
    sign : See `rotorsim.model.entries.Quantity`.
    films : When the films must be solved again: ``always``, ``never``, or ``shared`` where more
        than two supports share the static load.
    """

    quantity: str | None
    example: str
    owner: str = ""
    sign: str = "positive"
    films: str = "never"


PARAMETERS = {
    "speed": _Kind("speed", "6000 rpm"),
    "radial_clearance": _Kind("length", "100 um", "film", films="always"),
    "supply_temperature": _Kind("temperature", "40 degC", "film", films="always"),
    "viscosity": _Kind(None, "1.1", "film", films="always"),
    "load": _Kind("force", "5 kN", "film", films="always"),
    "elevation": _Kind("length", "50 um", "support", "any", "always"),
    "stiffness": _Kind("stiffness", "10 MN/m", "support", films="shared"),
    "damping": _Kind("damping", "20 kN*s/m", "support", "not_negative"),
    "pedestal_stiffness": _Kind("stiffness", "400 MN/m", "support"),
    "pedestal_damping": _Kind("damping", "20 kN*s/m", "support", "not_negative"),
    "pedestal_mass": _Kind("mass", "60 kg", "support"),
    "mass": _Kind("mass", "20 kg", "disc", "not_negative", "always"),
    "destabilising_stiffness": _Kind("stiffness", "5 MN/m", "place", "any"),
    "internal_damping": _Kind("time", "1e-5 s", sign="not_negative"),
    "axial_force": _Kind("force", "10 kN", sign="any", films="shared"),
    "youngs_modulus": _Kind("modulus", "207 GPa", films="shared"),
}
_SHORT = {"clearance": "radial_clearance", "temperature": "supply_temperature"}


@dataclass(frozen=True, eq=False)
class Variant:
    """A machine with some parameters changed.

    films : Changes of each support's film, see `rotorsim.study.changes.changed`; ``applied_load``
        replaces the magnitude of its static load.
    cross_stiffness : Destabilising stiffness [N/m] by place [m].
    """

    machine: MachineFile
    films: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    cross_stiffness: Mapping[float, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Parameter:
    """One value of a machine; `parameter` finds it by its name.

    kind : Of `PARAMETERS`.
    owner : Name of the support or disc, or the place; empty: all films, the rotor, the file's
        places.
    films : Whether films must be solved again.
    places : Of a destabilising stiffness: each place's share.
    """

    kind: str
    owner: str = ""
    films: bool = False
    places: Mapping[float, float] = field(default_factory=dict, hash=False)

    @property
    def name(self) -> str:
        """As it is written: ``drive end.radial_clearance``."""
        return f"{self.owner}.{self.kind}" if self.owner else self.kind

    @property
    def sign(self) -> str:
        """Sign of its values; see `rotorsim.model.entries.Quantity`."""
        return PARAMETERS[self.kind].sign

    def read(self, text: object, key: str) -> float:
        """Return the value [SI] of a text with its unit; of a factor a plain number."""
        kind = PARAMETERS[self.kind]
        if kind.quantity is None:
            try:
                value = float(str(text))
            except ValueError:
                value = math.nan
            if not 0.0 < value < math.inf:
                raise InputError(f"must be a factor, {kind.example} say", key=key, value=text)
            return value
        try:
            return Quantity(kind.quantity, kind.example, kind.sign).read(text)
        except InputError as error:
            raise InputError(error.message, key=key, value=text) from None

    def values(self, given: object, key: str) -> list[float]:
        """Return ascending values [SI]: of texts, ``"a, b"``, or ``"start : stop : count"``."""
        if isinstance(given, Mapping):
            given = " : ".join(str(given.get(part, "")) for part in ("start", "stop", "count"))
        example = PARAMETERS[self.kind].example
        return ascending_values(given, lambda text: self.read(text, key), key, example)

    def spread(self, text: object, key: str) -> Spread:
        """Return tolerance about the nominal value: ``"5 um"``, ``"10 %"``; see `parse_spread`."""
        kind = PARAMETERS[self.kind]
        quantity = kind.quantity
        if quantity == "temperature":
            quantity = "temperature difference"
        example = "3 K" if quantity == "temperature difference" else kind.example
        known = {self.name: (quantity, example if quantity else "10 %")}
        try:
            return parse_spread(text, self.name, known)
        except InputError as error:
            raise InputError(error.message, key=key, value=text) from None

    def nominal(self, machine: MachineFile) -> float | None:
        """Return the value that the file gives; None where it gives none, or several."""
        beam = machine.rotor.beam
        match self.kind:
            case "radial_clearance":
                return _same([one.radial_clearances[0] for one in self._scenarios(machine)])
            case "supply_temperature":
                return _same([s.thermal.supply_temperature for s in self._scenarios(machine)])
            case "viscosity":
                return 1.0
            case "destabilising_stiffness":
                anticipated = machine.lateral.destabilising_stiffness
                return sum(one.anticipated for one in anticipated) if not self.owner else None
            case "mass":
                return next(disc.mass for disc in beam.discs if disc.name == self.owner)
            case "youngs_modulus":
                return beam.material.youngs_modulus
            case "internal_damping" | "axial_force":
                return float(getattr(beam, self.kind))
            case "elevation":
                return self._entry(machine).elevation
            case "speed" | "load":
                return None
        holder, word = self._entry(machine), self.kind
        if word.startswith("pedestal_"):
            holder, word = holder.pedestal, word.removeprefix("pedestal_")
        matrix = np.array(getattr(holder, word) or np.zeros((2, 2)))
        return float(matrix[0, 0]) if np.array_equal(matrix, matrix[0, 0] * np.eye(2)) else None

    def _scenarios(self, machine: MachineFile) -> list[Any]:
        every = machine.bearings
        return [every[self.owner]] if self.owner else list(every.values())

    def _entry(self, machine: MachineFile) -> Any:
        return machine.support[machine.support_names.index(self.owner)]

    def applied(self, variant: Variant, value: float) -> Variant:
        """Return the variant with this value [SI]; the speed is none of its."""
        machine = variant.machine
        beam = machine.rotor.beam
        match self.kind:
            case "speed":
                return variant
            case "radial_clearance" | "supply_temperature" | "viscosity" | "load":
                word = "applied_load" if self.kind == "load" else self.kind
                films = {name: dict(changes) for name, changes in variant.films.items()}
                for name in [self.owner] if self.owner else machine.bearings:
                    films.setdefault(name, {})[word] = value
                return replace(variant, films=films)
            case "destabilising_stiffness":
                more = {at: share * value for at, share in self.places.items()}
                return replace(variant, cross_stiffness={**variant.cross_stiffness, **more})
            case "mass":
                discs = tuple(
                    _scaled(one, value) if one.name == self.owner else one for one in beam.discs
                )
                beam = replace(beam, discs=discs)
            case "youngs_modulus":
                beam = replace(beam, material=replace(beam.material, youngs_modulus=value))
            case "internal_damping" | "axial_force":
                beam = replace(beam, **{self.kind: value})
            case _:
                entries = list(machine.support)
                place = machine.support_names.index(self.owner)
                entries[place] = self._changed_entry(entries[place], value)
                return replace(variant, machine=machine.with_parts(support=tuple(entries)))
        rotor = replace(machine.rotor, beam=beam)
        return replace(variant, machine=machine.with_parts(rotor=rotor))

    def _changed_entry(self, entry: Any, value: float) -> Any:
        if self.kind == "elevation":
            return replace(entry, elevation=value)
        isotropic = ((value, 0.0), (0.0, value))
        if self.kind.startswith("pedestal_"):
            word = self.kind.removeprefix("pedestal_")
            return replace(entry, pedestal=replace(entry.pedestal, **{word: isotropic}))
        return replace(entry, **{self.kind: isotropic})


def _same(values: Sequence[float]) -> float | None:
    """Return the value that all have; None where they differ, or there are none."""
    return values[0] if values and all(one == values[0] for one in values) else None


def _scaled(disc: Any, mass: float) -> Any:
    """Return the disc of another mass: its inertias follow, as for another density."""
    ratio = mass / disc.mass if disc.mass else 0.0
    return replace(
        disc, mass=mass, polar_inertia=ratio * disc.polar_inertia,
        transverse_inertia=ratio * disc.transverse_inertia,
    )  # fmt: skip


def parameter(machine: MachineFile, name: str, key: str) -> Parameter:
    """Return the parameter of a machine by its name.

    name : A word of `PARAMETERS`; before a dot the support, disc or place it belongs to.
    key : Where the name stands, for messages.
    Raises InputError: The name means nothing in this machine, with what is allowed.
    """
    owner, _, word = str(name).strip().rpartition(".")
    owner, word = owner.strip(), word.strip().lower().replace("-", "_").replace(" ", "_")
    word = _SHORT.get(word, word)
    if word not in PARAMETERS:
        near = nearest(word, list(PARAMETERS))
        raise InputError(
            f"must be one of {', '.join(PARAMETERS)}, before a dot whose: "
            f'"{_example(machine)}"{near}', key=key, value=name,
        )  # fmt: skip
    kind = PARAMETERS[word]
    owners = _owners(machine, word)
    places: Mapping[float, float] = {}
    if kind.owner == "place":
        places = _places(machine, owner, key, name)
    elif not kind.owner and owner:
        raise InputError(f'is the whole machine\'s: write "{word}"', key=key, value=name)
    elif kind.owner and not owners:
        raise InputError(f"has no meaning here: {_NEEDS[word]}", key=key, value=name)
    elif kind.owner and owner not in owners and not (kind.owner == "film" and not owner):
        listed = ", ".join(f'"{one}.{word}"' for one in owners)
        raise InputError(f"must be one of {listed}", key=key, value=name)
    if word == "load":
        if len(machine.support) != 2:
            raise InputError(
                f"with {len(machine.support)} supports the loads follow from rotor and films "
                'together: vary an elevation, "NAME.elevation"', key=key, value=name,
            )  # fmt: skip
        if not owner:
            raise InputError(f'says not whose: "{owners[0]}.load"', key=key, value=name)
    shared = len(machine.support) > 2 and bool(machine.bearings)
    films = kind.films == "always" or (kind.films == "shared" and shared)
    return Parameter(word, owner, films and bool(machine.bearings), places)


_NEEDS = {
    **dict.fromkeys(("radial_clearance", "supply_temperature", "viscosity", "load"),
                    "no support has a bearing file"),
    **dict.fromkeys(("stiffness", "damping"), "no support has constants"),
    **dict.fromkeys(("pedestal_stiffness", "pedestal_damping", "pedestal_mass"),
                    "no support has a pedestal"),
    "elevation": "there is no support",
    "mass": "no disc has a name of its own",
}  # fmt: skip


def _example(machine: MachineFile) -> str:
    films = list(machine.bearings)
    return f"{films[0]}.radial_clearance" if films else "internal_damping"


def _owners(machine: MachineFile, word: str) -> list[str]:
    """Return names that a parameter of a kind may have before its dot."""
    if PARAMETERS[word].owner == "film":
        return list(machine.bearings)
    if PARAMETERS[word].owner == "disc":
        names = [disc.name for disc in machine.rotor.beam.discs if disc.name]
        return [name for name in names if names.count(name) == 1]
    if PARAMETERS[word].owner != "support":
        return []
    return [
        name
        for name, entry in zip(machine.support_names, machine.support, strict=True)
        if word == "elevation"
        or (word.startswith("pedestal_") and entry.pedestal is not None)
        or (word in ("stiffness", "damping") and entry.stiffness is not None)
    ]


def place_named(machine: MachineFile, text: str, key: str) -> float:
    """Return place on the shaft [m]: of a disc, support, seal, probe or clearance, or a length."""
    known = dict(zip(machine.support_names, (one.at for one in machine.support), strict=True))
    for entries in (machine.rotor.beam.discs, machine.seal, machine.probe, machine.clearance):
        for entry in entries:
            if entry.name:
                known.setdefault(entry.name, entry.at)
    if text in known:
        return known[text]
    try:
        at = parse_quantity(text, "length")
    except InputError:
        listed = ", ".join(f'"{name}"' for name in known) or "none has a name"
        raise InputError(
            f'must be a length from the left end, "250 mm" say, or a name: {listed}', key=key,
            value=text,
        ) from None  # fmt: skip
    machine.rotor.beam.check_place(at, key)
    return at


def _places(machine: MachineFile, owner: str, key: str, name: str) -> dict[float, float]:
    """Return places of a destabilising stiffness and their shares."""
    if owner:
        return {place_named(machine, owner, key): 1.0}
    anticipated = machine.lateral.destabilising_stiffness
    total = sum(one.anticipated for one in anticipated)
    if not total:
        raise InputError(
            'says not where: "impeller.destabilising_stiffness", "715 mm.destabilising_stiffness", '
            "or lateral.destabilising_stiffness in the file", key=key, value=name,
        )  # fmt: skip
    shares: dict[float, float] = {}
    for one in anticipated:
        shares[one.at] = shares.get(one.at, 0.0) + one.anticipated / total
    return shares


def held_values(machine: MachineFile, texts: object, key: str) -> dict[Parameter, float]:
    """Return parameters that are held at values, from a table of texts by name."""
    if not isinstance(texts, Mapping):
        raise InputError('must be a table: { "left.radial_clearance" = "80 um" }', key=key)
    found = {}
    for name, text in texts.items():
        one = parameter(machine, name, key)
        found[one] = one.read(text, f"{key}.{name}")
    return found


def spreads(machine: MachineFile, texts: object, key: str) -> dict[Parameter, Spread]:
    """Return tolerances by parameter, from a table of texts by name."""
    if not isinstance(texts, Mapping) or not texts:
        raise InputError(
            f'must be a table: spread = {{ "{_example(machine)}" = "5 %" }}', key=key, value=texts
        )
    found = {}
    for name, text in texts.items():
        one = parameter(machine, name, key)
        if one.kind == "speed":
            raise InputError("has no tolerance here", key=f"{key}.{name}")
        found[one] = one.spread(text, f"{key}.{name}")
    return found
