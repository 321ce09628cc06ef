"""Operating points of a scenario, at any clearance, load, speed and oil temperature."""

from __future__ import annotations

from dataclasses import replace
from math import isclose
from typing import TYPE_CHECKING, Any, TypeVar

from ..arguments import finite_number, refuse_path
from ..bearing.solve import solve_case
from ..errors import InputError
from ..model import ThermalModel
from ..model.entries import choice

if TYPE_CHECKING:
    from ..bearing.operating_point import OperatingPoint
    from ..files.scenario import Scenario

_Choice = TypeVar("_Choice")
_ALONE = {"orbit": None, "stability": None, "tolerances": None}
"""Tables that say nothing of an operating point, and need not fit the changed entries."""


def solve(
    scenario: Scenario,
    *,
    speed: float | None = None,
    radial_clearance: float | None = None,
    thermal_model: str | None = None,
    load: float | None = None,
    eccentricity_ratio: float | None = None,
    supply_temperature: float | None = None,
    rotations: bool | None = None,
) -> OperatingPoint:
    """Return one operating point of a scenario, its fields included.

    Parameters
    ----------
    scenario : Scenario
    speed : float, optional
        [rad/s]; any positive value. May be omitted if the scenario has one speed only.
    radial_clearance : float, optional
        [m]; likewise.
    thermal_model : str, optional
        ``isothermal`` or ``thd``; likewise.
    load, eccentricity_ratio : float, optional
        One of them, in place of what the scenario fixes the journal by [N], [-].
    supply_temperature : float, optional
        In place of the scenario's [K].
    rotations : bool, optional
        Give K and C over the journal's rotations as well (`OperatingPoint.coefficients_full`).
        Default: as the scenario says (``film.rotations``).

    Raises
    ------
    InputError
        Something is left open, out of bounds, or no number; or `scenario` is a file's name.

    See Also
    --------
    Scenario.replace : Changes any other entry.
    """
    refuse_path(scenario)
    asked: dict[str, Any] = {"load": load, "eccentricity_ratio": eccentricity_ratio}
    asked["supply_temperature"] = supply_temperature
    changes = {name: value for name, value in asked.items() if value is not None}
    clearance = _only("radial_clearance", radial_clearance, scenario.radial_clearances)
    finite_number(clearance, "radial_clearance", "m")
    if not any(isclose(clearance, one, rel_tol=1e-6) for one in scenario.radial_clearances):
        changes["radial_clearance"] = clearance
    model = _only("thermal_model", thermal_model, scenario.thermal_models)
    try:
        model = choice(ThermalModel, model)
    except InputError as error:
        raise InputError(error.message, key="thermal_model", value=str(model)) from None
    if model not in scenario.thermal_models:
        changes["thermal_model"] = model.value
    omega = finite_number(_only("speed", speed, scenario.operating.speeds), "speed", "rad/s")
    if changes:
        scenario = scenario.replace(**changes, **_ALONE)
    case = scenario.case(clearance, model)
    if rotations is not None:
        case = replace(case, film=replace(case.film, rotations=rotations))
    return solve_case(case, omega, keep_fields=True)[0]


def _only(name: str, value: _Choice | None, choices: tuple[_Choice, ...]) -> _Choice:
    if value is not None:
        return value
    if len(choices) != 1:
        raise InputError(
            f"must be given: the scenario leaves the choice between {len(choices)} values", key=name
        )
    return choices[0]
