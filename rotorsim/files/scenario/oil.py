"""The oil: exactly one description of its viscosity, and no property left to a guess."""

from __future__ import annotations

from ...errors import InputError
from ...model import ExponentialViscosity, Lubricant, ViscosityLaw, WaltherViscosity
from .schema import LubricantTable

DESCRIPTIONS = ("viscosity", "iso_vg", "viscosity_points")
TYPICAL = {"density": 860.0, "specific_heat": 2000.0, "thermal_conductivity": 0.13}
"""Of a mineral oil, SI: used where they do not enter (an isothermal film's forces)."""
_EXAMPLES = {
    "density": "860 kg/m^3",
    "specific_heat": "2000 J/(kg*delta_degC)",
    "thermal_conductivity": "0.13 W/(m*delta_degC)",
    "reference_temperature": "40 degC",
    "viscosity_temperature_coefficient": "0.034 / delta_degC",
}
_COMPANIONS = {
    "viscosity_index": "iso_vg",
    "reference_temperature": "viscosity",
    "viscosity_temperature_coefficient": "viscosity",
}
LEAST_KINEMATIC = 0.35e-6
"""Below this [m2/s] the Walther law means nothing."""


def lubricant(table: LubricantTable, *, heated: bool) -> Lubricant:
    """Oil of a scenario; `heated`: a thermal model needs all of its properties."""
    given = [name for name in DESCRIPTIONS if getattr(table, name) is not None]
    if len(given) != 1:
        found = "none is given" if not given else f"given are {' and '.join(given)}"
        raise InputError(
            "needs exactly one description of the viscosity: viscosity (with "
            "reference_temperature and viscosity_temperature_coefficient), iso_vg or "
            f"viscosity_points; {found}; for example iso_vg = 32",
            key="lubricant" if not given else f"lubricant.{given[1]}",
        )
    for name, partner in _COMPANIONS.items():
        if getattr(table, name) is not None and partner != given[0]:
            raise InputError(
                f"goes with lubricant.{partner}, not with lubricant.{given[0]}; remove it",
                key=f"lubricant.{name}",
            )
    if heated:
        for name in TYPICAL:
            _required(table, name, "a thd model needs it")
    return Lubricant(
        law=_law(table, given[0], heated=heated),
        density=_or(table.density, TYPICAL["density"]),
        specific_heat=_or(table.specific_heat, TYPICAL["specific_heat"]),
        thermal_conductivity=_or(table.thermal_conductivity, TYPICAL["thermal_conductivity"]),
    )


def _law(table: LubricantTable, description: str, *, heated: bool) -> ViscosityLaw:
    if table.viscosity is not None and description == "viscosity":
        return _exponential(table, heated=heated)
    density = _required(table, "density", f"{description} needs it")
    if table.iso_vg is not None:
        return WaltherViscosity.from_iso_vg(
            table.iso_vg, density, _or(table.viscosity_index, 100.0)
        )
    points = [
        (temperature, mu.dynamic(density)) for temperature, mu in table.viscosity_points or []
    ]
    for index, (_, mu) in enumerate(points):
        if mu / density < LEAST_KINEMATIC:
            raise InputError(
                f"is too thin for the Walther law (kinematic viscosity {mu / density * 1e6:.3g} "
                f"mm2/s, at least {LEAST_KINEMATIC * 1e6:g} is needed)",
                key=f"lubricant.viscosity_points[{index}]",
            )
    try:
        return WaltherViscosity.from_points(points[0], points[1], density)
    except InputError as error:
        raise InputError(error.message, key="lubricant.viscosity_points") from None


def _exponential(table: LubricantTable, *, heated: bool) -> ExponentialViscosity:
    assert table.viscosity is not None
    mu = table.viscosity.value
    if table.viscosity.is_kinematic:
        mu = table.viscosity.dynamic(_required(table, "density", "a kinematic viscosity needs it"))
    coefficient = table.viscosity_temperature_coefficient
    if heated:
        coefficient = _required(
            table, "viscosity_temperature_coefficient", "a thd model needs it (or give iso_vg)"
        )
    if coefficient:
        reference = _required(table, "reference_temperature", "the coefficient starts from it")
    else:
        reference = _or(
            table.reference_temperature, 313.15
        )  # a constant viscosity has no use of it
    return ExponentialViscosity(mu, reference, coefficient or 0.0)


def _required(table: LubricantTable, name: str, reason: str) -> float:
    value = getattr(table, name)
    if value is None:
        raise InputError(
            f'is missing: {reason}; write for example {name} = "{_EXAMPLES[name]}"',
            key=f"lubricant.{name}",
        )
    return value


def _or(value: float | None, default: float) -> float:
    return default if value is None else value


def varies_with_temperature(oil: Lubricant) -> bool:
    """Whether the film's temperature matters to its viscosity."""
    law = oil.law
    return not (isinstance(law, ExponentialViscosity) and law.temperature_coefficient == 0.0)
