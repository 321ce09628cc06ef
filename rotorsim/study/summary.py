"""What the closing words say, as plain data (SI)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..bearing.operating_point import OperatingPoint
    from ..bearing.table import CoefficientTable
    from ..orbit import Orbit
    from .stability import StabilityCurve


def expected_growth(table: CoefficientTable, orbit: Orbit, mass: float) -> float | None:
    """Growth rate that the eigenvalues give for the orbit's last speed [1/s]."""
    from ..errors import InputError
    from ..machine.rates import eigenvalues
    from .orbits import curve_of

    try:
        one = curve_of(table, orbit.thermal_model, orbit.radial_clearance)
        film = one.at(float(orbit.speed[-1]))
    except InputError:
        return None
    return float(eigenvalues(film.stiffness, film.damping, mass).real.max())


def heating_effect(
    points: Sequence[OperatingPoint], curves: Sequence[StabilityCurve]
) -> list[dict[str, Any]]:
    """Isothermal against THD at the highest speed, clearance by clearance.

    Returns: ``radial_clearance``, ``speed``, and for each model's name what the film carries and
        costs there, the critical mass, and of the scenario's rotor its ``verdict`` (``stable``,
        ``unstable`` or None), ``verdict_over_range`` (``stable throughout``, ``unstable
        throughout``, ``changes`` or None) and ``threshold_speeds``; ``threshold_speed`` is the
        first of them.
    """
    top = max((point.speed for point in points), default=0.0)
    known = {
        (curve.choices["thermal_model"], curve.choices["radial_clearance"]): curve
        for curve in curves
    }
    rows: dict[float, dict[str, Any]] = {}
    for point in points:
        if point.speed != top:
            continue
        row = rows.setdefault(
            point.radial_clearance, {"radial_clearance": point.radial_clearance, "speed": top}
        )
        curve = known.get((point.thermal_model, point.radial_clearance))
        found = () if curve is None else curve.threshold_speeds
        heat = point.heat_balance
        row[point.thermal_model] = {
            "status": point.status,
            "load": point.load,
            "friction_force": point.friction_force,
            "power_loss": point.power_loss,
            "side_flow": point.side_flow,
            "max_pressure": point.max_pressure,
            "max_temperature": point.max_temperature,
            "outlet_temperature": point.outlet_temperature,
            "wall_heat_share": None if heat is None else heat.wall_share,
            "min_film_thickness": point.min_film_thickness,
            "critical_mass": point.critical_mass,
            "stability": point.stability,
            "verdict": None if curve is None else curve.verdict,
            "verdict_over_range": None if curve is None else curve.verdict_over_range,
            "threshold_speeds": list(found),
            "threshold_speed": found[0] if found else None,
        }
    return list(rows.values())
