"""Building cases and reading references, for the film's tests."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from tolerances import COEFFICIENT_DIFFERENCES

from rotorsim.bearing.operating_point import OperatingPoint
from rotorsim.film.layers import isoviscous_layers
from rotorsim.film.linearization import linearize
from rotorsim.film.problem import FilmState, film_problem, film_state
from rotorsim.model import (
    Arc,
    Bearing,
    Case,
    Cavitation,
    EccentricityTarget,
    ExponentialViscosity,
    FilmSettings,
    Groove,
    Inception,
    LoadTarget,
    Lubricant,
    MeshSize,
    RupturedFriction,
    ThermalModel,
    ThermalSettings,
)

DATA = Path(__file__).parent / "data"
STEP = 1e-5
"""Of the displacements' scales, in differences."""
RADIUS, CLEARANCE, VISCOSITY, SPEED = 0.05, 100e-6, 0.02, 100.0
DAL_OIL = Lubricant(ExponentialViscosity(0.0277, 313.15, 0.034), 860.0, 2000.0, 0.13)


def reference_rows(name: str) -> list[dict[str, float]]:
    """Rows of a file of tests/data; lines that begin with # are its header notes."""
    with (DATA / name).open(encoding="utf-8") as file:
        lines = [line for line in file if not line.startswith("#")]
    return [
        {k: float(v) if v else math.nan for k, v in row.items()} for row in csv.DictReader(lines)
    ]


def isothermal_case(
    target: float | LoadTarget = 0.5,
    *,
    length_to_diameter: float = 1.0,
    mesh: tuple[int, int] = (160, 48),
    cavitation: str = "reynolds",
    inception: str = "max_film",
    radius: float = RADIUS,
    clearance: float = CLEARANCE,
    viscosity: float = VISCOSITY,
    ruptured_friction: str = "whole",
    grooves: tuple[Groove, ...] = (),
    arcs: tuple[Arc, ...] = (),
    misalignment: tuple[float, float] = (0.0, 0.0),
) -> Case:
    """Isoviscous film; `target` is an eccentricity ratio or a load."""
    bearing = Bearing(
        radius,
        2.0 * radius * length_to_diameter,
        clearance,
        grooves=grooves,
        arcs=arcs,
        misalignment=misalignment,
    )
    return Case(
        bearing=bearing,
        lubricant=Lubricant(ExponentialViscosity(viscosity, 313.15, 0.0), 860.0, 2000.0, 0.13),
        film=FilmSettings(
            cavitation=Cavitation(cavitation),
            inception=Inception(inception),
            mesh=MeshSize(mesh[0], mesh[1], 8, 4),
            ruptured_friction=RupturedFriction(ruptured_friction),
        ),
        thermal=ThermalSettings(model=ThermalModel.ISOTHERMAL),
        target=EccentricityTarget(target) if isinstance(target, float) else target,
    )


def thermal_case(
    target: float | LoadTarget = 0.5,
    *,
    mesh: tuple[int, int, int] = (48, 12, 10),
    bearing: Bearing | None = None,
    oil: Lubricant = DAL_OIL,
    cavitation: str = "reynolds",
    inception: str = "max_film",
    ruptured_friction: str = "liquid",
    **thermal,
) -> Case:
    """Thermohydrodynamic film; the plain bearing of Dal's Table 1 unless another is given."""
    return Case(
        bearing=bearing or Bearing(0.05, 0.08, 100e-6),
        lubricant=oil,
        film=FilmSettings(
            cavitation=Cavitation(cavitation),
            inception=Inception(inception),
            mesh=MeshSize(*mesh, 4),
            ruptured_friction=RupturedFriction(ruptured_friction),
        ),
        thermal=ThermalSettings(model=ThermalModel.THD, **thermal),
        target=EccentricityTarget(target) if isinstance(target, float) else target,
    )


def split_grooves(extent_deg: float = 20.0) -> tuple[Groove, Groove]:
    """Two axial grooves at the horizontal split, the load between them."""
    extent = math.radians(extent_deg)
    return Groove(0.5 * math.pi, extent), Groove(-0.5 * math.pi, extent)


def elliptical_arcs(preload: float = 0.5) -> tuple[Arc, Arc]:
    """Lemon bore, split at 90 degrees from the load."""
    half = 0.5 * math.pi
    return Arc(-half, half, preload), Arc(half, 3.0 * half, preload)


def dimensionless(point: OperatingPoint) -> tuple[np.ndarray, np.ndarray]:
    """K c/W and C c omega/W."""
    scale = point.radial_clearance / point.load
    return point.stiffness * scale, point.damping * scale * point.speed


def film_at(case: Case, position: Sequence[float], speed: float = 100.0) -> FilmState:
    """Return the film of oil of one viscosity at `position` (2,) [m]; `speed` [rad/s]."""
    problem = film_problem(case, speed, case.bearing, position)
    mu = float(case.lubricant.viscosity(case.thermal.supply_temperature))
    return film_state(problem, np.asarray(position), isoviscous_layers(problem.mesh.shape, mu))


def assert_derivatives(state: FilmState) -> None:
    """Compare K and C of the film with central differences of its forces, as energies.

    They are taken where no cell ruptures or fills: one that is near it shortens the step.
    """
    scales = state.problem.geometry.displacements.scales

    def force(q, velocity=None):
        start = state.solution.full
        moved = film_state(state.problem, q, state.layers, velocity=velocity, start=start)
        same = np.array_equal(moved.solution.carrying, state.solution.carrying)
        return moved.force if same else np.full(scales.size, np.nan)

    def columns(axis, size):
        step = size * scales[axis] * np.eye(scales.size)[axis]
        q, rate = state.displacement, step * state.problem.speed
        return np.array([
            (force(q - step) - force(q + step)) / (2.0 * step[axis]),
            (force(q, -rate) - force(q, rate)) / (2.0 * rate[axis]),
        ])  # fmt: skip

    k, c = np.empty((2, scales.size, scales.size))
    for axis in range(scales.size):
        for size in (STEP, STEP / 4.0, STEP / 16.0, STEP / 64.0):
            k[:, axis], c[:, axis] = columns(axis, size)
            if np.isfinite(k[:, axis]).all() and np.isfinite(c[:, axis]).all():
                break
    weights = np.outer(scales, scales)
    for found, wanted in zip(linearize(state), (k, c), strict=True):
        np.testing.assert_allclose(
            found * weights, wanted * weights,
            atol=COEFFICIENT_DIFFERENCES * np.abs(wanted * weights).max(), rtol=0.0,
        )  # fmt: skip
