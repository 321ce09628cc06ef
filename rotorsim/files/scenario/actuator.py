"""The orbit's actuator, checked against the rest of the scenario."""

from __future__ import annotations

import math

from ...errors import InputError
from ...model import Bearing, Cavitation, Inception, ThermalModel
from .schema import ActuatorTable, ScenarioTables, SpeedRampTable
from .settings import ActuatorSettings, Design, OrbitForce, RotorKind

_KEYS = {
    Design.LQR: ("displacement_scale", "force_scale"),
    Design.PD: ("stiffness", "damping", "decay_ratio"),
}


def actuator_settings(tables: ScenarioTables, bearing: Bearing) -> ActuatorSettings | None:
    """Read ``[orbit.actuator]``; None without one, or with one that is switched off.

    Raises
    ------
    InputError
        Keys of another design, or a run in which the feedback has no fixed equilibrium.
    """
    table = None if tables.orbit is None else tables.orbit.actuator
    if table is None:
        return None
    _check_keys(table)
    if not table.on:
        return None
    _check_run(tables, bearing)
    return ActuatorSettings(
        design=table.design,
        force_limit=math.inf if table.force_limit is None else table.force_limit,
        displacement_scale=table.displacement_scale,
        force_scale=table.force_scale,
        stiffness=table.stiffness or 0.0,
        damping=table.damping,
        decay_ratio=table.decay_ratio,
    )


def _check_keys(table: ActuatorTable) -> None:
    for design, keys in _KEYS.items():
        for key in keys:
            if design is not table.design and getattr(table, key) is not None:
                raise InputError(
                    f'goes with design = "{design.value}", not "{table.design.value}"',
                    key=f"orbit.actuator.{key}",
                )
    if table.damping is not None and table.decay_ratio is not None:
        raise InputError(
            "goes without damping: it is what the damping is found from; remove one of them",
            key="orbit.actuator.decay_ratio",
        )


def _check_run(tables: ScenarioTables, bearing: Bearing) -> None:
    """Refuse what the feedback, designed about one equilibrium at one speed, does not fit."""
    orbit, rotor = tables.orbit, tables.rotor
    assert orbit is not None
    if isinstance(orbit.speed, SpeedRampTable):
        _refuse('needs one speed, not a ramp; write for example speed = "15000 rpm" in [orbit]')
    if rotor is not None and rotor.kind is not RotorKind.RIGID:
        _refuse('needs a rotor of kind = "rigid"')
    if not orbit.static_load:
        _refuse("needs the static load, about whose equilibrium it acts; remove static_load")
    if orbit.force is OrbitForce.LINEAR:
        return
    # what `rotorsim.orbit.can_be_mapped` asks of a film
    film = tables.film
    kept = 'with force = "film" needs a film whose force comes from a map: '
    if film.inception is not Inception.FREE:
        _refuse(f'{kept}inception = "free" in [film]; or take force = "linear"')
    if film.cavitation not in (Cavitation.REYNOLDS, Cavitation.HALF_SOMMERFELD):
        _refuse(f'{kept}cavitation = "reynolds" or "half_sommerfeld"; or take force = "linear"')
    if any(model is not ThermalModel.ISOTHERMAL for model in tables.thermal.models):
        _refuse(f'{kept}models = ["isothermal"] in [thermal]; or take force = "linear"')
    if not (bearing.is_plain and bearing.is_symmetric):
        _refuse(f'{kept}a plain bore without grooves, lobes and tilt; or take force = "linear"')


def _refuse(message: str) -> None:
    raise InputError(message, key="orbit.actuator")
