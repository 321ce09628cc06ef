"""An actuator's feedback, designed on the film linearised about its equilibrium."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from ..bearing.interpolation import Coefficients
from ..errors import InputError
from ..model.orbit import ActuatorSettings, Design

if TYPE_CHECKING:
    from ..machine.control import StateFeedback
    from ..orbit import OrbitProblem


def design_feedback(
    settings: ActuatorSettings,
    linear: Coefficients,
    mass: float,
    radial_clearance: float,
    load: float | None,
) -> StateFeedback:
    """Feedback for a rigid rotor [kg] on its linearised film, at the coefficients' speed.

    mass, radial_clearance : Per bearing [kg], [m].
    load : The static one [N]: a tenth of it is the force that counts as large where none is given.
    Raises InputError: The design reaches its aim with no gain, or nothing says which force is
        large.
    """
    from ..machine.control import design_lqr, design_pd, proportional_derivative
    from ..machine.statespace import state_space

    limit = settings.force_limit
    if settings.design is Design.LQR:
        large = settings.force_scale or (limit if math.isfinite(limit) else 0.1 * (load or 0.0))
        if not large > 0.0:
            raise InputError("is missing: the load is not known", key="orbit.actuator.force_scale")
        scale = settings.displacement_scale or 0.01 * radial_clearance
        return design_lqr(state_space(linear, mass), scale, large, max_force=limit)
    if settings.damping is not None:
        return proportional_derivative(settings.stiffness, settings.damping, limit)
    ratio = 0.02 if settings.decay_ratio is None else settings.decay_ratio
    return design_pd(linear, mass, -ratio * linear.speed, settings.stiffness, limit)


def with_actuator(
    problem: OrbitProblem, settings: ActuatorSettings, mass: float, load: float | None
) -> OrbitProblem:
    """The problem with an actuator beside its film, at constant speed.

    Raises InputError: The speed changes, or as `design_feedback`.
    """
    from ..machine.actuator import ActuatedForce
    from ..orbit import LinearForce
    from ..orbit.forces import find_equilibrium, linearize_force

    if not problem.schedule.is_constant:
        raise InputError("needs one speed, not a ramp", key="orbit.actuator")
    film, speed = problem.force, problem.schedule.speeds[0]
    if isinstance(film, LinearForce):
        rest = film.position(speed)
    else:
        rest = find_equilibrium(film, problem.static_load, speed)
    linear = Coefficients(*linearize_force(film, *rest, speed), speed)
    feedback = design_feedback(settings, linear, mass, film.radial_clearance, load)
    limit = settings.force_limit
    limited = f"limited to {limit:g} N per axis" if math.isfinite(limit) else "without limit"
    return replace(
        problem,
        force=ActuatedForce(film, feedback, rest),
        equilibrium=rest,
        # as accurate as with the film alone
        relative_tolerance=problem.tolerance,
        note="; ".join(filter(None, (problem.note, f"{settings.design.name} actuator {limited}"))),
    )
