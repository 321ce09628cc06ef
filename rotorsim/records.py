"""Operating points without numbers, and as plain JSON-ready dictionaries and back."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Mapping
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from .model import Case, EccentricityTarget, LoadTarget
from .operating_point import HeatBalance, OperatingPoint
from .status import SolveStatus, Stability


def point_to_dict(point: OperatingPoint) -> dict[str, Any]:
    """Every scalar and coefficient of `point` (SI); the fields are left out.

    Returns
    -------
    dict
        Keys are the attribute names of `OperatingPoint`; enumerations as their values, arrays as
        nested lists.
    """
    record: dict[str, Any] = {}
    for entry in dataclasses.fields(point):
        if entry.name == "fields":
            continue
        value = getattr(point, entry.name)
        if entry.name == "heat_balance" and value is not None:
            value = dataclasses.asdict(value)
        record[entry.name] = plain(value)
    return record


def point_from_dict(record: Mapping[str, Any]) -> OperatingPoint:
    """Inverse of `point_to_dict`.

    Raises
    ------
    KeyError, TypeError, ValueError
        If `record` was not made by `point_to_dict`.
    """
    values = dict(record)
    values["status"] = SolveStatus(values["status"])
    values["stability"] = None if values["stability"] is None else Stability(values["stability"])
    for name in ("stiffness", "damping"):
        values[name] = np.array(values[name], dtype=float).reshape(2, 2)
    values["warnings"] = tuple(values["warnings"])
    if values["heat_balance"] is not None:
        values["heat_balance"] = HeatBalance(**values["heat_balance"])
    return OperatingPoint(**values)


def failed_point(
    case: Case, speed: float, message: str, status: SolveStatus = SolveStatus.FAILED
) -> OperatingPoint:
    """Point without numbers: all that the case does not give is NaN."""
    nan, target = math.nan, case.target
    given = target.eccentricity_ratio if isinstance(target, EccentricityTarget) else nan
    return OperatingPoint(
        status=status,
        message=message,
        thermal_model=case.thermal.model.value,
        cavitation=case.film.cavitation.value,
        speed=speed,
        radial_clearance=case.bearing.radial_clearance,
        eccentricity_ratio=given,
        attitude_angle=nan,
        load=target.load if isinstance(target, LoadTarget) else nan,
        sommerfeld_number=nan,
        max_pressure=nan,
        max_temperature=nan,
        mean_temperature=nan,
        friction_force=nan,
        power_loss=nan,
        side_flow=nan,
        min_film_thickness=nan,
        stiffness=np.full((2, 2), nan),
        damping=np.full((2, 2), nan),
        critical_mass=None,
        critical_mass_dimensionless=None,
        whirl_frequency_ratio=None,
        stability=None,
        iterations=0,
        residual=nan,
    )


def plain(value: Any) -> Any:
    """`value` made of what JSON knows: numpy, enumerations, paths and tuples are converted."""
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, Mapping):
        return {str(plain(key)): plain(entry) for key, entry in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, complex):
        return [plain(value.real), plain(value.imag)]
    if isinstance(value, (list, tuple)):
        return [plain(entry) for entry in value]
    return str(value) if isinstance(value, Path) else value


def strict_json(value: Any, *, indent: int | None = 2) -> str:
    """JSON text of `value`; numbers that JSON cannot hold (NaN, infinities) become null.

    Examples
    --------
    >>> strict_json({"a": (1.5, float("nan"))}, indent=None)
    '{"a": [1.5, null]}'
    """
    return json.dumps(_finite(plain(value)), indent=indent, allow_nan=False, ensure_ascii=False)


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _finite(entry) for key, entry in value.items()}
    return [_finite(entry) for entry in value] if isinstance(value, list) else value
