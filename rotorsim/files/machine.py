"""Machine files: a rotor from its drawing on several supports (TOML with units).

Each bearing keeps its own scenario file, which the machine's file names; its load and speed come
from the machine.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any

from ..arguments import above_zero, file_path
from ..bearing.table import CoefficientTable
from ..errors import InputError, ScenarioError, TableError
from ..file_kinds import is_missing
from ..model.entries import NOT_IN_FILES, Example, Made, Number, Quantity, one_of
from ..model.machine import (
    Clearance,
    HotSpotSettings,
    LateralSettings,
    MachineControl,
    MachineOperating,
    MachineTolerances,
    MapEntry,
    Probe,
    StaticForce,
    UnbalanceEntry,
    distinct_names,
)
from ..model.machine_orbit import MachineOrbit
from ..model.shaft import (
    STEEL,
    Bore,
    Coupling,
    Density,
    Diameter,
    Disc,
    DiscMass,
    Inertia,
    Material,
    Modulus,
    Place,
    Poisson,
    Section,
)
from ..model.supports import SealEntry, SupportEntry
from ..rotor import Beam, Rotor, beam_rotor, with_unbalance
from ..rotor.beam import buckling_load
from ..shipped import shipped_machines
from ..text import printable
from .formats import is_table, read_table
from .parameters import held_values, parameter, place_named, spreads
from .scenario import Scenario, load_scenario
from .scenario.document import parse_toml, read_text
from .scenario.reader import Reader
from .scenario.scenario import TitleEntry

_ROTATIONS = ("clockwise", "counterclockwise")


_ELEVATION = 0.01
"""Largest elevation of a support, relative to the shaft's length."""


@dataclass(frozen=True)
class _RotorDrawing:
    """A shaft from its drawing, with the unbalances that it is given."""

    beam: Beam
    unbalance: tuple[UnbalanceEntry, ...] = ()


def _disc(
    at: Annotated[Place, Example("620 mm")],
    name: str = "",
    mass: DiscMass | None = None,
    polar_inertia: Inertia | None = None,
    transverse_inertia: Inertia | None = None,
    outer_diameter: Diameter | None = None,
    inner_diameter: Bore = 0.0,
    width: Diameter | None = None,
    density: Density = STEEL.density,
) -> Disc:
    """Make a disc from its mass and inertias, or from its dimensions; mass alone is added mass."""
    if (mass is None) == (outer_diameter is None):
        raise InputError(
            "needs mass (with polar_inertia and transverse_inertia), or outer_diameter and width",
            key="mass",
        )
    if mass is None:
        if width is None or outer_diameter is None:
            raise InputError("is missing: a disc from its dimensions needs it", key="width")
        return Disc.from_dimensions(at, outer_diameter, width, density, inner_diameter, name)
    if (polar_inertia is None) != (transverse_inertia is None):
        raise InputError("goes with polar_inertia: give both, or none", key="transverse_inertia")
    return Disc(at, mass, polar_inertia or 0.0, transverse_inertia or 0.0, name)


def _beam(
    section: Annotated[
        tuple[Section, ...], Example([{"length": "180 mm", "outer_diameter": "100 mm"}])
    ],
    disc: tuple[Annotated[Disc, Made(_disc)], ...] = (),
    unbalance: tuple[UnbalanceEntry, ...] = (),
    youngs_modulus: Modulus = STEEL.youngs_modulus,
    density: Density = STEEL.density,
    poisson_ratio: Poisson = STEEL.poisson_ratio,
    shear_modulus: Modulus | None = None,
    internal_damping: Annotated[float, Quantity("time", "1e-5 s", "not_negative")] = 0.0,
    rotation: str = _ROTATIONS[0],
    shear: bool = True,
    axial_force: Annotated[float, Quantity("force", "0 N", "any")] = 0.0,
    modal_damping: Annotated[float, Number(least=0.0, most=0.999)] = 0.0,
) -> _RotorDrawing:
    """Make a shaft from its sections and discs."""
    try:
        one_of(_ROTATIONS, rotation)
    except InputError as error:
        raise InputError(error.message, key="rotation", value=rotation) from None
    beam = Beam(
        section, disc, Material(youngs_modulus, density, poisson_ratio, shear_modulus), shear,
        axial_force, internal_damping, rotation == _ROTATIONS[0], modal_damping=modal_damping,
    )  # fmt: skip
    for i, entry in enumerate(unbalance):
        beam.check_place(entry.at, f"rotor.unbalance[{i}].at")
    return _RotorDrawing(beam, unbalance)


@dataclass(frozen=True, eq=False)
class MachineFile:
    """A machine as its file describes it (SI).

    Attributes
    ----------
    rotor : RotorDrawing
    operating : MachineOperating
    title : str
    support : tuple of SupportEntry
    seal : tuple of SealEntry
    probe : tuple of Probe
    load : tuple of StaticForce
    clearance : tuple of Clearance
    lateral : LateralSettings
    hot_spot : HotSpotSettings or None
    map : tuple of MapEntry
    tolerances : MachineTolerances or None
    control : MachineControl or None
    orbit : MachineOrbit or None
        What is simulated in time.
    source : Path or None
        The file.
    text : str
        Its TOML text.

    Raises
    ------
    InputError
        A place is off the shaft, or two supports stand at one place or have one name.
    """

    rotor: Annotated[_RotorDrawing, Made({"beam": _beam})]
    operating: MachineOperating
    title: Annotated[str, TitleEntry()] = ""
    support: tuple[SupportEntry, ...] = ()
    seal: tuple[SealEntry, ...] = ()
    coupling: tuple[Coupling, ...] = ()
    probe: tuple[Probe, ...] = ()
    load: tuple[StaticForce, ...] = ()
    clearance: tuple[Clearance, ...] = ()
    lateral: LateralSettings = field(default_factory=LateralSettings)
    hot_spot: HotSpotSettings | None = None
    map: tuple[MapEntry, ...] = ()
    tolerances: MachineTolerances | None = None
    control: MachineControl | None = None
    orbit: MachineOrbit | None = None
    source: Annotated[Path | None, NOT_IN_FILES] = None
    text: Annotated[str, NOT_IN_FILES] = field(default="", repr=False)

    def __post_init__(self) -> None:
        beam = replace(self.rotor.beam, couplings=self.coupling)
        object.__setattr__(self, "rotor", replace(self.rotor, beam=beam))
        for word in ("support", "seal", "probe", "load", "clearance"):
            for i, entry in enumerate(getattr(self, word)):
                beam.check_place(entry.at, f"{word}[{i}].at")
        for i, entry in enumerate(self.lateral.destabilising_stiffness):
            beam.check_place(entry.at, f"lateral.destabilising_stiffness[{i}].at")
        for word in ("step", "harmonic", "blade_loss", "rub") if self.orbit is not None else ():
            for i, entry in enumerate(getattr(self.orbit, word)):
                beam.check_place(entry.at, f"orbit.{word}[{i}].at")
        distinct_names(self.support, "support")
        distinct_names(self.seal, "seal")
        places = [entry.at for entry in self.support]
        for i, at in enumerate(places):
            if any(abs(at - other) < 1e-6 * beam.length for other in places[:i]):
                raise InputError(
                    "another support stands at this place; what acts beside it is a [[seal]]",
                    key=f"support[{i}].at",
                )
        most = _ELEVATION * beam.length
        for i, entry in enumerate(self.support):
            if abs(entry.elevation) > most:
                raise InputError(
                    f"must be at most a hundredth of the shaft's length, {most * 1e3:.3g} mm: a "
                    "shaft bends linearly no further",
                    key=f"support[{i}].elevation", value=entry.elevation,
                )  # fmt: skip
        if beam.axial_force < 0.0:
            limit = buckling_load(beam, places)
            if -beam.axial_force >= limit:
                raise InputError(
                    f"the shaft buckles at {-limit / 1e3:.4g} kN, its supports rigid",
                    key="rotor.axial_force",
                )

    def __repr__(self) -> str:
        beam, supports = self.rotor.beam, ", ".join(self.support_names) or "none"
        return (
            f"<MachineFile: {self.title}; shaft of {beam.length * 1e3:.4g} mm, {len(beam.discs)} "
            f"discs; supports: {supports}>"
        )

    @classmethod
    def from_text(cls, text: str, source: str | Path | None = None) -> MachineFile:
        """Read a machine from TOML text.

        Parameters
        ----------
        text : str
        source : str or Path, optional
            Where the text came from; the files that it names are found beside it.

        Raises
        ------
        ScenarioError
            With file, key, value and what is allowed.
        """
        path = None if source is None else Path(source)
        name = "machine text" if path is None else str(path)
        reader = Reader(parse_toml(text, name), cls, name)
        arguments = reader.arguments()
        try:
            title = arguments.pop("title", "") or (
                "untitled" if path is None else printable(path.stem)
            )
            machine = cls(**arguments, title=title, source=path, text=text)
            machine.check_files()
            return machine
        except InputError as error:
            if isinstance(error, ScenarioError):
                raise
            raise reader.error(error) from None

    @property
    def support_names(self) -> tuple[str, ...]:
        """Names of the supports, those without one numbered."""
        return distinct_names(self.support, "support")

    @property
    def seal_names(self) -> tuple[str, ...]:
        """Names of the seals, those without one numbered."""
        return distinct_names(self.seal, "seal")

    def check_files(self) -> None:
        """Read the files of bearings and coefficients, and check names of parameters and places."""
        _ = self.bearings, self.tables
        for i, entry in enumerate(self.map):
            for axis in ("x", "y"):
                key = f"map[{i}].{axis}"
                found = parameter(self, getattr(entry, axis), key)
                given = getattr(entry, f"{axis}_values")
                if given is not None:
                    found.values(given, f"{key}_values")
            held_values(self, entry.hold or {}, f"map[{i}].hold")
        heated = [
            name for name, one in self.bearings.items() if "thd" in map(str, one.thermal_models)
        ]
        if self.hot_spot is not None and not heated:
            raise InputError(
                'needs a support with bearing = "file.toml", whose file has thermal.models = '
                '["thd"]', key="hot_spot",
            )  # fmt: skip
        for i, name in enumerate(self.hot_spot.support if self.hot_spot is not None else ()):
            try:
                one_of(heated, name)
            except InputError as error:
                said = f"{error.message}: the supports on heated films"
                key = f"hot_spot.support[{i}]"
                raise InputError(said, key=key, value=name) from None
        if self.tolerances is not None:
            spreads(self, self.tolerances.spread, "tolerances.spread")
        if self.control is not None:
            for word in ("actuator", "sensor"):
                for i, place in enumerate(getattr(self.control, word)):
                    place_named(self, place, f"control.{word}[{i}]")
        elif self.orbit is not None and self.orbit.control:
            raise InputError('is missing: actuator = ["250 mm"], for orbit.control', key="control")

    def with_parts(self, **parts: Any) -> MachineFile:
        """Return the machine with some parts replaced; bearings and tables are not read again."""
        bearings = parts.pop("bearings", self.bearings)
        other = replace(self, **parts)
        other.__dict__.update(bearings=bearings, tables=self.tables)
        return other

    @cached_property
    def bearings(self) -> dict[str, Scenario]:
        """Bearing scenarios by the support's name.

        Raises
        ------
        InputError
            A file is missing or wrong, or leaves the choice between several clearances.
        """
        found = {}
        for i, (name, entry) in enumerate(zip(self.support_names, self.support, strict=True)):
            if entry.bearing is None:
                continue
            path = self._beside(entry.bearing, f"support[{i}].bearing")
            scenario = load_scenario(path)
            if len(scenario.radial_clearances) > 1:
                raise InputError(
                    f"{path} lists {len(scenario.radial_clearances)} clearances; a machine's "
                    "bearing has one", key=f"support[{i}].bearing", value=entry.bearing,
                )  # fmt: skip
            found[name] = scenario
        return found

    @cached_property
    def tables(self) -> dict[str, CoefficientTable]:
        """Coefficient tables by the name of the support or seal.

        Raises
        ------
        InputError
            A file is missing or wrong, or holds more than one curve over speed.
        """
        found = {}
        for word, names in (("support", self.support_names), ("seal", self.seal_names)):
            for i, (name, entry) in enumerate(zip(names, getattr(self, word), strict=True)):
                if entry.coefficients is None:
                    continue
                key = f"{word}[{i}].coefficients"
                path = self._beside(entry.coefficients, key)
                if not is_table(path):
                    raise InputError(
                        "must be a coefficient table: netCDF, CSV, or a bearing saved by ROSS",
                        key=key, value=entry.coefficients,
                    )  # fmt: skip
                found[name] = _table(path, entry.coefficients_bearing, f"{key}_bearing")
                found[name].interpolator()
        return found

    def _beside(self, name: str, key: str) -> Path:
        folder = Path() if self.source is None else self.source.parent
        path = folder / name
        if is_missing(path):
            raise InputError(f"no such file beside the machine's: {path}", key=key, value=name)
        if not os.path.isfile(path):
            raise InputError(f"{path} is no ordinary file", key=key, value=name)
        return path

    def rotor_with_unbalance(self, refinement: int = 1, more: Sequence[float] = ()) -> Rotor:
        """Assemble the rotor, with a node at every place that the file names.

        Parameters
        ----------
        refinement : int
            See `Beam.mesh`.
        more : sequence of float
            Further places [m].
        """
        groups = (self.support, self.seal, self.probe, self.load, self.clearance)
        places = [entry.at for group in groups for entry in group]
        places += [entry.at for entry in self.rotor.unbalance]
        places += [entry.at for entry in self.lateral.destabilising_stiffness]
        if self.control is not None:
            named = (*self.control.actuator, *self.control.sensor)
            places += [place_named(self, text, "control.actuator") for text in named]
        places += [entry.at for entry in (self.orbit.placed if self.orbit else ())]
        rotor = beam_rotor(self.rotor.beam, [*places, *more], refinement)
        top = max(self.operating.speeds)
        above_zero("operating", speed=top)
        graded = [entry for entry in self.rotor.unbalance if entry.grade is not None]
        planes = [
            (
                entry.at,
                entry.amount
                if entry.amount is not None
                else entry.velocity / top * rotor.total_mass / len(graded),
                entry.phase,
            )
            for entry in self.rotor.unbalance
        ]
        return with_unbalance(rotor, planes)


def _table(path: Path, bearing: str | None, key: str) -> CoefficientTable:
    """Return the table of one bearing in a file; `key` is the machine file's that names it."""
    try:
        return read_table(path, bearing=bearing)
    except TableError as error:
        if error.key != "--bearing":
            raise
        message = error.message.replace("--bearing NAME", 'coefficients_bearing = "NAME"')
        raise InputError(f"{path}: {message}", key=key, value=bearing) from None


def load_machine(path: str | Path) -> MachineFile:
    """Read and validate a machine file.

    Parameters
    ----------
    path : str or Path
        A file, or the name of a shipped machine, ``machines/compressor`` (see
        `rotorsim.shipped`).

    Raises
    ------
    ScenarioError
        The file, or one that it names, cannot be read, or an entry is wrong: file, key, value and
        what is allowed.
    """
    file_path(path)
    found = path if os.path.lexists(path) else shipped_machines().get(str(path), path)
    return MachineFile.from_text(read_text(found), source=found)


def is_machine(path: str | Path) -> bool:
    """Return whether a file describes a machine: it has supports, or a rotor of sections.

    A file that cannot be read is none; whoever reads it as something else says why.
    """
    import tomllib

    if Path(path).suffix.lower() != ".toml":
        return False
    try:
        tables: dict[str, Any] = tomllib.loads(read_text(path))
    except (InputError, ValueError):
        return False
    rotor = tables.get("rotor")
    return "support" in tables or (isinstance(rotor, dict) and "section" in rotor)
