"""The command `control`: an actuator that holds a rotor past its threshold."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError
from .options import (
    ClearanceOption,
    FolderOption,
    MassOption,
    ModelOption,
    ScenarioArgument,
    SpeedOption,
    option,
    positive,
    wanted_clearance,
)
from .output import DONE, INCOMPLETE, Output

if TYPE_CHECKING:
    from ..files.scenario import Scenario
    from ..model import Case
    from ..study.control import ControlStudy


class _DesignChoice(StrEnum):
    """Kinds of feedback."""

    LQR = "lqr"
    PD = "pd"


def control(
    output: Output,
    scenario: ScenarioArgument,
    speed: SpeedOption = None,
    mass: MassOption = None,
    clearance: ClearanceOption = None,
    model: ModelOption = None,
    design: Annotated[
        _DesignChoice, typer.Option("--design", help="Full state feedback, or PD for each axis.")
    ] = _DesignChoice.LQR,
    max_force: Annotated[
        str | None,
        option("--max-force", "FORCE", 'Where each axis saturates, e.g. "2 kN".', "never"),
    ] = None,
    disturbance: Annotated[
        str | None,
        option("--disturbance", "LENGTH", "From rest, at the start of the run in time.",
               "a fiftieth of the clearance"),
    ] = None,
    revolutions: Annotated[
        int | None,
        option("--revolutions", "N", "Of that run; 0: none.",
               "20 where the film is solved at every step, else 100", min=0, max=100_000),
    ] = None,
    folder: FolderOption = None,
) -> int:  # fmt: skip
    """Design a magnetic actuator's feedback, and try it in time on the nonlinear film.

    Example: rotorsim control scenarios/quick.toml --speed "15000 rpm" --max-force "2 kN"

    A table of coefficients has no film to try it on: design on it from Python (design_lqr).
    """
    from ..files.scenario import load_scenario
    from ..study.control import ControlWishes, Design, study_control

    loaded = load_scenario(scenario)
    force = positive(max_force, "force", "--max-force", "2 kN")
    wishes = ControlWishes(
        design=Design(design.value),
        disturbance=positive(disturbance, "length", "--disturbance", "2 um"),
        revolutions=revolutions,
        **({} if force is None else {"max_force": force}),
    )
    at = positive(speed, "speed", "--speed", "15000 rpm") or float(loaded.speeds[-1])
    study = study_control(_case(loaded, clearance, model), at, _mass(loaded, mass), wishes)
    document = _study_document(study)
    if folder is not None:
        from ..show.job import control_figures, save_figures

        document["files"] = save_figures(control_figures(study, loaded.title), folder)
    output.document(document)
    if not (output.json or output.quiet):
        output.show(*_study_tables(study))
        output.show(*map(str, document.get("files", [])))
    if study.holds:
        return DONE
    run = document["controlled"]
    output.warn(f"the actuator does not hold the rotor: {run['status']}, {run['message']}")
    return INCOMPLETE


def _mass(scenario: Scenario, text: str | None) -> float:
    own = None if scenario.rotor is None else scenario.rotor.rigid_mass
    mass = positive(text, "mass", "--mass", "1200 kg") or own
    if mass is None:
        raise InputError('is missing: a rigid rotor, e.g. "900 kg"', key="--mass")
    return mass


def _case(scenario: Scenario, clearance: str | None, model: str | None) -> Case:
    names = [str(name) for name in scenario.thermal_models]
    chosen = model or ("thd" if "thd" in names else names[0])
    wanted = None if clearance is None else wanted_clearance(scenario, clearance)
    return scenario.case(wanted, chosen)


def _study_document(study: ControlStudy) -> dict[str, Any]:
    """A control study for JSON."""
    import dataclasses

    def motion(orbit: Any, values: Any) -> dict[str, Any]:
        return {
            "eigenvalues": values,
            "growth_rate": float(values[0].real),
            "status": None if orbit is None else orbit.status.value,
            "message": "" if orbit is None else orbit.message,
            "max_eccentricity_ratio": (
                None if orbit is None else float(orbit.eccentricity_ratio.max())
            ),
        }

    return {
        "speed": study.speed,
        "mass": study.mass,
        "load": study.load,
        "disturbance": study.disturbance,
        "critical_mass": study.passive.critical_mass,
        "gain": study.feedback.gain,
        "max_force": study.feedback.max_force,
        "largest_force": study.largest_force,
        "saturates": _saturates(study),
        "margins": {
            axis: dataclasses.asdict(one) for axis, one in zip("xy", study.margins, strict=True)
        },
        "passive": motion(study.passive_orbit, study.passive_eigenvalues),
        "controlled": motion(study.controlled_orbit, study.controlled_eigenvalues),
        "holds": study.holds,
        "note": study.note,
    }


def _study_tables(study: ControlStudy) -> list[Any]:
    """A control study for people."""
    from ..rows import RPM, number
    from .tables import grid

    said = _study_document(study)
    title = f"{study.speed * RPM:.0f} rpm, {number(study.mass)} kg per bearing"
    table = grid(title, "", "growth 1/s", "run in time", "max eps")
    for name in ("passive", "controlled"):
        row = said[name]
        status = "-" if row["status"] is None else row["status"].replace("_", " ")
        eps = number(row["max_eccentricity_ratio"], 3)
        table.add_row(name, number(row["growth_rate"]), status, eps)
    heads = ("", "x kN/mm", "y kN/mm", "vx kN s/m", "vy kN s/m")
    gains = grid("Force = - gain (x, y, vx, vy)", *heads)
    for axis, row in zip("xy", study.feedback.gain, strict=True):
        cells = (*(number(v / 1e6) for v in row[:2]), *(number(v / 1e3) for v in row[2:]))
        gains.add_row(f"F{axis}", *cells)
    margins = grid("Margins of the loops", "axis", "gain up", "gain down", "phase deg", "modulus")
    for axis, one in zip("xy", study.margins, strict=True):
        margins.add_row(
            axis, *(_factor(v) for v in (one.gain_increase, one.gain_reduction)),
            _factor(one.phase_margin * 57.29577951308232), number(one.modulus_margin, 3),
        )  # fmt: skip
    lines = [] if study.largest_force is None else [_force_words(study)]
    return [table, gains, margins, *lines, *([study.note] if study.note else [])]


def _saturates(study: ControlStudy) -> bool:
    """Whether the actuator reached its limit in the run in time."""
    force = study.largest_force
    return force is not None and force >= (1.0 - 1e-9) * study.feedback.max_force


def _force_words(study: ControlStudy) -> str:
    """The actuator's force in the run in time, and what it had to do."""
    from ..rows import number

    limit = study.feedback.max_force
    of = "unlimited" if limit == float("inf") else f"of {number(limit)} N"
    said = f"largest actuator force {number(study.largest_force)} N, {of}"
    if _saturates(study):
        said = f"the actuator saturates at {number(limit)} N"
    start = f"from {number(study.disturbance * 1e6)} µm beside rest"
    return f"{said}; {start}, load {number(study.load)} N"


def _factor(value: float) -> str:
    import math

    return f"{value:.3g}" if math.isfinite(value) else "unlimited"
