"""Results made up for tests of what shows them: orbits, films, modes, maps."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from rotorsim.bearing.operating_point import FilmFields, OperatingPoint
from rotorsim.machine.branches import Modes
from rotorsim.machine.thresholds import ThresholdSpeed
from rotorsim.orbit import Orbit
from rotorsim.orbit.orbit import OrbitStatus
from rotorsim.status import SolveStatus
from rotorsim.study.stability import Campbell

CLEARANCE = 1e-4


def orbit_of(
    t: np.ndarray, x: np.ndarray, y: np.ndarray, speed: np.ndarray | float, **more: Any
) -> Orbit:
    """An orbit in a plain bearing of `CLEARANCE`; what is not given is zero, or follows."""
    clearance = more.pop("radial_clearance", CLEARANCE)
    speed = np.broadcast_to(np.asarray(speed, dtype=float), t.shape).copy()
    turned = 0.5 * (speed[1:] + speed[:-1]) * np.diff(t)
    zero, turn = np.zeros_like(t), np.linspace(0.0, 2.0 * np.pi, 361)
    given: dict[str, Any] = {
        "t": t, "x": x, "y": y, "vx": zero, "vy": zero, "speed": speed,
        "angle": np.concatenate([[0.0], np.cumsum(turned)]), "fx": zero, "fy": zero,
        "load": np.zeros((t.size, 2)), "actuator_force": np.zeros((t.size, 2)),
        "displacements": np.column_stack([x, y]), "min_film": clearance - np.hypot(x, y),
        "boundary": clearance * np.column_stack([np.cos(turn), np.sin(turn)]),
        "samples_per_revolution": 64, "radial_clearance": clearance, "equilibrium": (0.0, 0.0),
        "force_model": "linear", "thermal_model": "thd", "status": OrbitStatus.COMPLETED,
    }  # fmt: skip
    return Orbit(**{**given, **more})


def point_of(
    theta: np.ndarray, y: np.ndarray, pressure: np.ndarray, temperature: np.ndarray, **more: Any
) -> OperatingPoint:
    """An operating point with a film of (n, m) pressure [Pa] and temperature [K]."""
    across = np.repeat(np.broadcast_to(temperature, pressure.shape)[..., None], 3, axis=2)
    fields = FilmFields(
        theta, y, np.array([0.25, 0.5, 0.75]), np.full(pressure.shape, 5e-5), pressure,
        np.ones(pressure.shape), across, np.full(across.shape, 0.02), across[..., 0], 313.15,
        np.zeros(pressure.shape),
    )  # fmt: skip
    given: dict[str, Any] = {
        "status": SolveStatus.CONVERGED, "message": "", "thermal_model": "thd",
        "cavitation": "reynolds", "speed": 800.0, "radial_clearance": CLEARANCE,
        "eccentricity_ratio": 0.5, "attitude_angle": 0.9, "load": 1e4, "sommerfeld_number": 0.1,
        "max_pressure": float(pressure.max()), "max_temperature": float(across.max()),
        "mean_temperature": float(across.mean()), "friction_force": 50.0, "power_loss": 1e3,
        "side_flow": 1e-5, "min_film_thickness": 5e-5, "stiffness": 1e8 * np.eye(2),
        "damping": 1e5 * np.eye(2), "critical_mass": 900.0, "critical_mass_dimensionless": 5.0,
        "whirl_frequency_ratio": 0.48, "stability": None, "iterations": 9, "residual": 1e-9,
        "fields": fields,
    }  # fmt: skip
    return OperatingPoint(**{**given, **more})


def campbell_of(
    speed: np.ndarray,
    eigenvalues: np.ndarray,
    thermal_model: str = "thd",
    sense: tuple[float, ...] | None = None,
    thresholds: tuple[tuple[float, float], ...] = (),
) -> Campbell:
    """Modes over speed.

    `sense`: 1 for a branch of forward circles, -1 backward, 0 straight. `thresholds`: speed and
    whirl frequency of each [rad/s].
    """
    count = eigenvalues.shape[1]
    shapes = np.zeros((speed.size, count, 2), dtype=complex)
    for k, way in enumerate((0.0,) * count if sense is None else sense):
        shapes[:, k] = np.array([1.0, -1j * way]) / np.hypot(1.0, way)
    modes = Modes(
        speed, eigenvalues, np.zeros(eigenvalues.shape), shapes, np.ones(speed.size, dtype=bool)
    )
    crossings = tuple(
        ThresholdSpeed(at, frequency, frequency / at, True) for at, frequency in thresholds
    )
    choices = {"thermal_model": thermal_model, "radial_clearance": CLEARANCE}
    return Campbell(choices, modes, eigenvalues.real.max(axis=1), crossings)


def chart_of(
    x: np.ndarray, y: np.ndarray, rates: dict[str, np.ndarray], names: tuple[str, str]
) -> xr.Dataset:
    """Growth rates of thermal models over two inputs."""
    values = np.stack(list(rates.values()))
    coordinates = {"thermal_model": list(rates), names[0]: x, names[1]: y}
    return xr.Dataset({"growth_rate": (("thermal_model", *names), values)}, coordinates)
