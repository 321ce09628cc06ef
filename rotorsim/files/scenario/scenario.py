"""A scenario: what a file describes, as frozen model objects."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from ...arguments import check_number
from ...errors import InputError, ScenarioError
from ...model import Bearing, Case, FilmSettings, Lubricant, Target, ThermalModel, ThermalSettings
from ...rotor import Rotor
from ...shipped import shipped_scenarios
from ...text import printable
from . import build
from .document import parse_toml, read_text
from .messages import as_written, dotted, location, scenario_error, shown
from .oil import lubricant
from .orbit import orbit_settings
from .schema import ScenarioTables
from .settings import OrbitSettings, StabilitySettings
from .tolerances import ToleranceSettings


@dataclass(frozen=True, eq=False)
class Scenario:
    """A validated scenario (SI units).

    Attributes
    ----------
    title : str
    source : Path or None
        The file it came from.
    text : str
        The TOML text, lines ended by a line feed.
    sha256 : str
        Of the text in UTF-8.
    bearing : Bearing
        With the first clearance, angles as given in the file (before the load is turned to x).
    radial_clearances : tuple of float
        [m]
    load_direction : float
        Angle of the load in the frame in which the bearing is given [rad].
    lubricant : Lubricant
    film : FilmSettings
    thermal : ThermalSettings
        With the first thermal model.
    thermal_models : tuple of ThermalModel
    speeds : (n,) array
        Ascending [rad/s], read-only.
    target : EccentricityTarget or LoadTarget
    rotor : Rotor or None
    orbit : OrbitSettings or None
    stability : StabilitySettings or None
    tolerances : ToleranceSettings or None
    """

    title: str
    source: Path | None
    text: str = field(repr=False)
    sha256: str
    bearing: Bearing
    radial_clearances: tuple[float, ...]
    load_direction: float
    lubricant: Lubricant
    film: FilmSettings
    thermal: ThermalSettings
    thermal_models: tuple[ThermalModel, ...]
    speeds: NDArray[np.float64]
    target: Target
    rotor: Rotor | None = None
    orbit: OrbitSettings | None = None
    stability: StabilitySettings | None = None
    tolerances: ToleranceSettings | None = None

    @classmethod
    def from_text(cls, text: str, source: str | Path | None = None) -> Scenario:
        """Read a scenario from TOML text.

        Parameters
        ----------
        text : str
        source : str or Path, optional
            Where the text came from, for messages.

        Raises
        ------
        ScenarioError
            With file, key, value and what is allowed.

        Examples
        --------
        >>> scenario = Scenario.from_text('''
        ... [bearing]
        ... journal_radius = "50 mm"
        ... length = "80 mm"
        ... radial_clearance = "4 mil"
        ... [lubricant]
        ... viscosity = "4e-6 reyn"
        ... [operating]
        ... speed = "3000 rpm"
        ... load = "10 kN"
        ... ''')
        >>> scenario.radial_clearances
        (0.0001016,)
        """
        path = None if source is None else Path(source)
        name = "scenario text" if path is None else str(path)
        entries = parse_toml(text, name)
        try:
            tables = ScenarioTables.model_validate(entries)
        except ValidationError as error:
            raise scenario_error(error, entries, name) from None
        try:
            return cls(text=text, source=path, **_parts(tables, text, path))
        except InputError as error:
            path_to, value = as_written(location(error.key or ""), entries)
            raise ScenarioError(
                error.message, source=name, key=dotted(path_to), value=shown(value)
            ) from None

    def case(
        self,
        radial_clearance: float | None = None,
        thermal_model: ThermalModel | str | None = None,
    ) -> Case:
        """One bearing with one thermal model; what leaves no choice may be omitted.

        Parameters
        ----------
        radial_clearance : float, optional
            One of `radial_clearances` [m].
        thermal_model : ThermalModel or str, optional
            One of `thermal_models`.

        Raises
        ------
        ScenarioError
            Not in the scenario, or omitted where there is a choice.
        """
        clearance = self._clearance(radial_clearance)
        model = self._thermal_model(thermal_model)
        bearing = replace(self.bearing, radial_clearance=clearance)
        return Case(
            bearing=bearing.turned(-self.load_direction),
            lubricant=self.lubricant,
            film=self.film,
            thermal=replace(self.thermal, model=model),
            target=self.target,
        )

    def cases(self) -> Iterator[Case]:
        """Every case: thermal model by thermal model, each with all clearances."""
        for model in self.thermal_models:
            for clearance in self.radial_clearances:
                yield self.case(clearance, model)

    def _clearance(self, wanted: float | None) -> float:
        if wanted is None and len(self.radial_clearances) == 1:
            return self.radial_clearances[0]
        if wanted is not None:
            check_number(wanted, "radial_clearance", "m")
        for clearance in self.radial_clearances:
            if wanted is not None and math.isclose(clearance, wanted, rel_tol=1e-6):
                return clearance
        allowed, said = (
            ", ".join(f"{one * factor:g}" for one in self.radial_clearances) for factor in (1, 1e6)
        )
        raise ScenarioError(
            f"must be one of the clearances that the scenario lists: {allowed} m ({said} µm)",
            source=self.source,
            key="radial_clearance",
            value=wanted,
        )

    def _thermal_model(self, wanted: ThermalModel | str | None) -> ThermalModel:
        if wanted is None and len(self.thermal_models) == 1:
            return self.thermal_models[0]
        for model in self.thermal_models:
            if model == wanted:
                return model
        allowed = ", ".join(self.thermal_models)
        raise ScenarioError(
            f"must be one of the scenario's models: {allowed}",
            source=self.source,
            key="thermal_model",
            value=wanted,
        )


def load_scenario(path: str | Path) -> Scenario:
    """Read and validate a scenario file.

    Parameters
    ----------
    path : str or Path
        A file, or, where there is none of that name, the name of a shipped scenario (see
        `rotorsim.shipped_scenarios`), as on the command line.

    Raises
    ------
    ScenarioError
        The file cannot be read or an entry is wrong: file, key, value and what is allowed.

    Examples
    --------
    >>> load_scenario("quick").source.name
    'quick.toml'
    """
    shipped = shipped_scenarios().get(str(path))
    if shipped is not None and not Path(path).exists():
        path = shipped
    return Scenario.from_text(read_text(path), source=path)


def _parts(tables: ScenarioTables, text: str, path: Path | None) -> dict[str, Any]:
    """Everything that the tables say, as model objects."""
    heated = ThermalModel.THD in tables.thermal.models
    oil = lubricant(tables.lubricant, heated=heated)
    film = build.film_settings(tables.film)
    bearings = build.bearings(tables.bearing, film.mesh, tables.operating.eccentricity_ratio)
    clearances = tuple(bearing.radial_clearance for bearing in bearings)
    speeds = build.speeds(tables.operating)
    return {
        "title": build.title(tables.title)
        or ("untitled" if path is None else printable(path.stem)),
        "sha256": hashlib.sha256(text.encode()).hexdigest(),
        "bearing": bearings[0],
        "radial_clearances": clearances,
        "load_direction": tables.operating.load_direction,
        "lubricant": oil,
        "film": film,
        "thermal": build.thermal_settings(tables, oil),
        "thermal_models": tuple(tables.thermal.models),
        "speeds": speeds,
        "target": build.target(tables.operating),
        "rotor": build.rotor(tables),
        "orbit": orbit_settings(tables, bearings[0], clearances, speeds),
        "stability": build.stability_settings(tables),
        "tolerances": build.tolerance_settings(tables),
    }
