"""The film points behind the paper's figures and tables, as changes of ``scenarios/dal.toml``."""

from __future__ import annotations

import json
import math
import multiprocessing
import tomllib
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

import rotorsim as rs

ISOTHERMAL, THD = "isothermal", "thd"
CLEARANCES = (100, 125, 150)
"""Radial clearances of section 4 [µm]."""
SPEEDS = tuple(range(500, 15001, 500))
"""[rpm]"""
TOP_SPEED = 15000
WALL_SPEEDS = (500, 2500, 5000, 7500, 10000, 12500, 15000)
FILM_SPEEDS = (2500, 5000, 7500, 10000, 12500, 15000)
VALIDATION_SPEEDS = (2000, 4000)
"""The paper names no speed for Fig. 2: two that are common in such tests [rpm]."""
VALIDATION_ECCENTRICITIES = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
STIFFNESS = ("kxx", "kyy", "kxy", "kyx")
"""In the order of Table 2."""
DAMPING = ("cxx", "cyy", "cxy", "cyx")
"""In the order of Table 3."""
QUANTITIES = (
    "load", "friction_force", "power_loss", "max_pressure", "temperature", "attitude_angle",
    *STIFFNESS, *DAMPING, "critical_mass", "critical_mass_dimensionless", "whirl_frequency_ratio",
)  # fmt: skip
"""SI units; ``temperature`` is the highest one of the film [degC]."""
ZERO_CELSIUS = 273.15

Changes = Mapping[str, Any]
"""Scenario entries by their dotted keys."""
Mesh = dict[str, int]

AMBIENT = "ambient"
WALLS: dict[str, Changes] = {
    AMBIENT: {},
    "conduction": {"thermal.bush": "conduction"},
    "conduction_free_shaft": {"thermal.bush": "conduction", "thermal.shaft": "insulated"},
    "insulated": {"thermal.bush": "insulated", "thermal.shaft": "insulated"},
}
"""Thermal conditions of bush and shaft: what the paper leaves open, or describes and did not do."""
EXPANSION: Changes = {
    "thermal.expansion.shaft": "11.7e-6 / delta_degC",
    "thermal.expansion.bush": "11.7e-6 / delta_degC",
    "thermal.expansion.reference_temperature": "40 degC",
}
"""Steel shaft and bush; the clearances are measured at the paper's ambient temperature."""
WALL_NAMES = {
    AMBIENT: "walls at ambient temperature",
    "conduction": "bush conduction, shaft ambient",
    "conduction_free_shaft": "bush conduction, shaft without net heat",
    "insulated": "both walls insulated",
}
WHOLE = "whole"
"""Setting of curves whose friction counts the whole ruptured sector."""


def base_entries() -> dict[str, Any]:
    """Return the entries of the shipped scenario by dotted key, without speeds, rotor and orbit."""
    tables = tomllib.loads(rs.shipped_scenarios()["dal"].read_text(encoding="utf-8"))
    entries = _flat({key: tables[key] for key in ("bearing", "lubricant", "film", "thermal")})
    return {**entries, "operating.eccentricity_ratio": tables["operating"]["eccentricity_ratio"]}


def _flat(table: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    entries: dict[str, Any] = {}
    for key, value in table.items():
        nested = isinstance(value, dict)
        entries |= _flat(value, f"{prefix}{key}.") if nested else {prefix + key: value}
    return entries


def paper_mesh() -> Mesh:
    """Return the cell counts of the shipped scenario, the paper's finer one around the bearing."""
    start = "film.mesh."
    return {k.removeprefix(start): n for k, n in base_entries().items() if k.startswith(start)}


def scaled(mesh: Mesh, factor: float) -> Mesh:
    """Return even cell counts, `factor` times those of `mesh`."""
    return {name: max(4, 2 * round(factor * count / 2)) for name, count in mesh.items()}


def _mesh_entries(mesh: Mesh) -> Changes:
    return {f"film.mesh.{name}": count for name, count in mesh.items()}


def variants(mesh: Mesh) -> dict[str, tuple[str, Changes]]:
    """Return label and changes, by key, of each choice whose weight the sensitivity table shows."""
    literal = {"circumferential": 48, "axial": 156, "cross_film": 24, "bush_radial": 24}
    free_shaft, mixing = WALLS["conduction_free_shaft"], {"thermal.inlet": "mixing"}
    return {
        "base": ("base: the choices that give the paper's numbers", {}),
        "mesh_half": ("mesh halved in every direction", _mesh_entries(scaled(mesh, 0.5))),
        "mesh_double": ("mesh doubled in every direction", _mesh_entries(scaled(mesh, 2.0))),
        "mesh_as_printed": ("mesh as printed: 48 around, 156 along, 24 across",
                            _mesh_entries(literal)),
        "half_sommerfeld": ("cavitation: half Sommerfeld", {"film.cavitation": "half_sommerfeld"}),
        "full_sommerfeld": ("cavitation: none (full Sommerfeld)",
                            {"film.cavitation": "full_sommerfeld"}),
        "jfo": ("cavitation: mass-conserving (JFO)", {"film.cavitation": "jfo"}),
        "free_inception": ("inception free, not at maximum thickness", {"film.inception": "free"}),
        "inlet_mixing": ("inlet: recirculated and fresh oil mixed", mixing),
        "inlet_periodic": ("inlet: none, the oil goes round", {"thermal.inlet": "periodic"}),
        "friction_whole": ("friction counts the whole ruptured sector",
                           {"film.ruptured_friction": "whole"}),
        "bush_conduction": ("bush: conduction, 250 W/mK and 80 W/m2K", WALLS["conduction"]),
        "bush_conduction_free_shaft": ("the same bush, shaft without net heat", free_shaft),
        "bush_conduction_free_shaft_mixing": ("that bush and shaft, and the mixing inlet",
                                              {**free_shaft, **mixing}),
        "insulated": ("both walls insulated", WALLS["insulated"]),
        **{
            f"hot_{fit}": (
                f"the same bush and shaft, grown when hot ({said})",
                {**free_shaft, **EXPANSION, "thermal.expansion.bush_fit": fit},
            )
            for fit, said in (("free", "free bush"), ("rigid_housing", "bush in a rigid housing"))
        },
    }  # fmt: skip


@dataclass(frozen=True)
class Job:
    """One bearing at some speeds.

    Attributes
    ----------
    group : str
        ``curves``, ``validation``, ``variants``, or ``films``: one point with its fields.
    labels : dict
        What tells the job apart within its group.
    model : str
    clearance : int
        [µm]
    speeds : sequence of int
        [rpm]
    changes : mapping
        Of the base scenario.
    """

    group: str
    labels: dict[str, Any]
    model: str
    clearance: int
    speeds: Sequence[int]
    changes: Changes

    @property
    def scenario(self) -> rs.Scenario:
        """The scenario of the job."""
        entries = {
            **base_entries(),
            "bearing.radial_clearance": f"{self.clearance} um",
            "thermal.models": [self.model],
            "operating.speed": [f"{rpm} rpm" for rpm in self.speeds],
            **self.changes,
        }
        # Strings, numbers and lists of them are written alike in JSON and TOML.
        lines = [f"{key} = {json.dumps(value)}" for key, value in entries.items()]
        return rs.Scenario.from_text("\n".join(lines))


def jobs(mesh: Mesh) -> list[Job]:
    """Return everything to be computed on `mesh`: figures 2 to 8, tables, walls and variants."""
    size = _mesh_entries(mesh)
    settings = {AMBIENT: size, WHOLE: {**size, "film.ruptured_friction": "whole"}}
    found = [
        Job("variants", {"variant": key}, model, 100, (TOP_SPEED,), {**size, **changes})
        for key, (_, changes) in variants(mesh).items()
        for model in (THD, ISOTHERMAL)
    ]
    found += [
        Job("curves", {"setting": setting}, model, clearance, SPEEDS, changes)
        for model in (THD, ISOTHERMAL)
        for setting, changes in settings.items()
        for clearance in CLEARANCES
    ]
    for walls, entries in WALLS.items():
        changes = {**size, **entries}
        for clearance in CLEARANCES:
            if walls != AMBIENT:
                labels = {"setting": walls}
                found.append(Job("curves", labels, THD, clearance, WALL_SPEEDS, changes))
            found.append(Job("films", {"walls": walls}, THD, clearance, (TOP_SPEED,), changes))
    found += [
        Job("films", {"walls": AMBIENT}, model, 100, (rpm,), size)
        for model in (THD, ISOTHERMAL)
        for rpm in FILM_SPEEDS
        if (model, rpm) != (THD, TOP_SPEED)
    ]
    found += [
        Job("validation", {"walls": walls, "eccentricity": eccentricity}, THD, 145,
            VALIDATION_SPEEDS,
            {**size, **WALLS[walls], "operating.eccentricity_ratio": eccentricity})
        for walls in (AMBIENT, "conduction")
        for eccentricity in VALIDATION_ECCENTRICITIES
    ]  # fmt: skip
    return found


@dataclass(frozen=True)
class Results:
    """Everything computed for the paper; numbers of points that did not converge are NaN.

    Attributes
    ----------
    mesh : dict
        Cell counts.
    curves : xarray.Dataset
        `QUANTITIES` and ``status`` over setting (the `WALLS`, and `WHOLE`), thermal_model,
        clearance [µm] and rpm; NaN where a setting was not computed.
    validation : xarray.Dataset
        Fig. 2: over walls, eccentricity and rpm.
    variants : xarray.Dataset
        Over variant and thermal_model, at 100 µm and the top speed.
    films : dict
        ``(thermal model, walls, clearance, rpm)`` to the operating point with its fields.
    walls : str
        Setting from which THD values are taken where none is named.
    """

    mesh: Mesh
    curves: xr.Dataset
    validation: xr.Dataset
    variants: xr.Dataset
    films: Mapping[tuple[str, str, int, int], rs.OperatingPoint]
    walls: str = AMBIENT

    def value(
        self,
        name: str,
        model: str,
        clearance: int = 100,
        rpm: int = TOP_SPEED,
        friction: str = "liquid",
        walls: str | None = None,
    ) -> float:
        """Return one of `QUANTITIES` at one point; NaN if it did not converge.

        The isothermal film does not depend on the walls. Raises KeyError if there is no such point.
        """
        setting = (walls or self.walls) if model == THD else AMBIENT
        setting = WHOLE if friction == WHOLE else setting
        place = {"setting": setting, "thermal_model": model, "clearance": clearance, "rpm": rpm}
        return float(self.curves[name].sel(place))

    def reduction(
        self,
        name: str,
        clearance: int = 100,
        rpm: int = TOP_SPEED,
        friction: str = "liquid",
        walls: str | None = None,
    ) -> float:
        """Return by how much heating lowers a quantity, in percent of the isothermal value."""
        cold, warm = (
            self.value(name, model, clearance, rpm, friction, walls) for model in (ISOTHERMAL, THD)
        )
        return reduction(cold, warm)

    def profile(self, model: str, rpm: int) -> tuple[np.ndarray, ...]:
        """Return mid-plane profiles of the film at c = 100 µm over the paper's angle.

        Returns
        -------
        angle : (n,) array
            From maximum film thickness in the direction of rotation [deg], ascending: the paper's
            theta (its film is 1 + eps cos(theta - theta_a)).
        pressure : (n,) array
            [Pa]
        mean, hottest : (n,) arrays
            Temperature across the film [degC].

        All NaN if the film did not converge.
        """
        point = self.films[model, AMBIENT, 100, rpm]
        fields = point.fields
        if fields is None or not point.converged:
            return tuple(np.full((4, self.mesh["circumferential"]), math.nan))
        angle = np.mod(fields.theta - point.attitude_angle - math.pi, 2.0 * math.pi)
        order = np.argsort(angle)
        middle = fields.y.size // 2
        temperature = fields.temperature[order, middle] - ZERO_CELSIUS
        return (
            np.degrees(angle[order]),
            fields.pressure[order, middle],
            temperature.mean(axis=1),
            temperature.max(axis=1),
        )

    def not_converged(self) -> list[str]:
        """Return the points of figures and tables that did not converge, without the variants."""
        lost = [f"film {key}: {p.status.value}" for key, p in self.films.items() if not p.converged]
        for name, group in (("curve", self.curves), ("Fig. 2", self.validation)):
            status: pd.Series = group["status"].to_series().dropna()
            lost += [f"{name} {key}: {end}" for key, end in status.items() if end != "converged"]
        return lost


def reduction(before: float, after: float) -> float:
    """Return the fall in percent; NaN where `before` is zero but for rounding."""
    if abs(before) <= 1e-9 * abs(after):
        return math.nan
    return 100.0 * (1.0 - after / before)


def gather(frames: Sequence[pd.DataFrame], *dimensions: str) -> xr.Dataset:
    """Return tables of points as one dataset over `dimensions`."""
    frame = pd.concat(frames, ignore_index=True)
    frame.loc[frame["status"] != "converged", list(QUANTITIES)] = math.nan
    return frame.set_index(list(dimensions))[[*QUANTITIES, "status"]].to_xarray()


def solve_job(job: Job) -> pd.DataFrame | rs.OperatingPoint:
    """Return the points of a job, one per row, or the film point with its fields."""
    if job.group == "films":
        return rs.solve(job.scenario)
    frame = rs.tabulate(job.scenario, workers=1).dataset.to_dataframe().reset_index()
    return frame.assign(
        temperature=frame["max_temperature"] - ZERO_CELSIUS,
        clearance=job.clearance,
        rpm=(frame["speed"] * 30.0 / math.pi).round().astype(int),
        **job.labels,
    )


def compute(
    mesh: Mesh, workers: int, progress: Callable[[int, int], None] | None = None
) -> Results:
    """Solve everything on `workers` processes.

    Parameters
    ----------
    mesh : dict
        Cell counts.
    workers : int
    progress : callable, optional
        ``progress(done, total)`` after each job.
    """
    todo = jobs(mesh)
    found: dict[int, Any] = {}
    # "spawn": forking a process that has threads (BLAS) can hang.
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=spawn) as pool:
        futures = {pool.submit(solve_job, job): number for number, job in enumerate(todo)}
        for done, future in enumerate(as_completed(futures), start=1):
            found[futures[future]] = future.result()
            if progress is not None:
                progress(done, len(todo))
    return collect(mesh, todo, [found[number] for number in range(len(todo))])


def collect(mesh: Mesh, todo: Sequence[Job], found: Sequence[Any]) -> Results:
    """Return the results of jobs, given in the same order, as `Results`."""
    done = list(zip(todo, found, strict=True))

    def gathered(group: str, *dimensions: str) -> xr.Dataset:
        return gather([result for job, result in done if job.group == group], *dimensions)

    return Results(
        mesh=mesh,
        curves=gathered("curves", "setting", "thermal_model", "clearance", "rpm"),
        validation=gathered("validation", "walls", "eccentricity", "rpm"),
        variants=gathered("variants", "variant", "thermal_model"),
        films={
            (job.model, job.labels["walls"], job.clearance, job.speeds[0]): result
            for job, result in done
            if job.group == "films"
        },
    )
