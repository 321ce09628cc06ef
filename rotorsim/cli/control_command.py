"""The command `control`: an actuator that holds a rotor past its threshold."""

from __future__ import annotations

import dataclasses
import math
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError
from ..rows import RPM, heads, number, shown, with_unit
from .options import (
    ClearanceOption,
    FolderOption,
    MassOption,
    ModelOption,
    ScenarioArgument,
    SpeedOption,
    WorkersOption,
    option,
    positive,
    wanted_clearance,
)
from .output import DONE, INCOMPLETE, Output

if TYPE_CHECKING:
    from ..study.control import ControlStudy
    from ..study.machine_control import MachineControlStudy


_REACH = 3.0
"""Multiple of the speed: bending modes far above it decay slowly and hide those below."""


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
        _DesignChoice | None,
        typer.Option(
            "--design", help="Full state feedback, or PD for each axis.",
            show_default="lqr, or the machine's",
        ),
    ] = None,
    actuator: Annotated[
        list[str] | None,
        typer.Option(
            "--actuator", metavar="PLACE", show_default="the file's",
            help='Of a machine: "250 mm" from the left end, or a name in it; may be repeated.',
        ),
    ] = None,
    sensor: Annotated[
        list[str] | None,
        typer.Option(
            "--sensor", metavar="PLACE", show_default="the file's, or at the actuators",
            help="Of a machine: likewise.",
        ),
    ] = None,
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
    workers: WorkersOption = None,
) -> int:  # fmt: skip
    """Design a magnetic actuator's feedback, and try it in time on the nonlinear film.

    Example: rotorsim control scenarios/quick.toml --speed "15000 rpm" --max-force "2 kN"

    A table of coefficients has no film to try it on: design on it from Python (design_lqr).

    On a machine, its films linear, with actuators and sensors anywhere on the shaft:
    rotorsim control scenarios/machines/plain_rotor.toml --actuator "250 mm" --max-force "2 kN"
    """
    from .machine_commands import is_machine

    if is_machine(scenario):
        for key, text in (("--mass", mass), ("--clearance", clearance)):
            if text is not None:
                raise InputError(f"is that of the machine file {scenario}", key=key, value=text)
        wishes = {
            "design": None if design is None else design.value,
            "max_force": positive(max_force, "force", "--max-force", "2 kN"),
            "speed": positive(speed, "speed", "--speed", "15000 rpm"),
            "actuator": tuple(actuator) if actuator else None,
            "sensor": tuple(sensor) if sensor else None,
        }
        run = {
            "disturbance": positive(disturbance, "length", "--disturbance", "2 um"),
            "revolutions": revolutions,
        }
        return _machine_control(output, scenario, model, wishes, run, folder, workers)
    for key, places in (("--actuator", actuator), ("--sensor", sensor)):
        if places:
            raise InputError("goes with a machine: here it acts on the journal", key=key)
    design = design or _DesignChoice.LQR
    from ..files.scenario import load_scenario
    from ..model import preferred_model
    from ..model.orbit import ActuatorSettings, Design
    from ..study.control import study_control

    loaded = load_scenario(scenario)
    limit = positive(max_force, "force", "--max-force", "2 kN")
    settings = ActuatorSettings(Design(design.value), math.inf if limit is None else limit)
    start = positive(disturbance, "length", "--disturbance", "2 um")
    at = positive(speed, "speed", "--speed", "15000 rpm") or float(loaded.speeds[-1])
    own = None if loaded.rotor is None else loaded.rotor.rigid_mass
    carried = positive(mass, "mass", "--mass", "1200 kg") or own
    if carried is None:
        raise InputError('is missing: a rigid rotor, e.g. "900 kg"', key="--mass")
    case = loaded.case(
        None if clearance is None else wanted_clearance(loaded, clearance),
        model or preferred_model(loaded.thermal_models),
    )
    study = study_control(case, at, carried, settings, disturbance=start, revolutions=revolutions)
    document = _study_document(study)
    if folder is not None:
        from ..show.job import save_figures
        from ..show.study_figures import control_figures

        document["files"] = save_figures(control_figures(study, loaded.title), folder)
    output.results(document, lambda: _study_tables(study))
    if study.holds:
        return DONE
    run = document["controlled"]
    output.warn(f"the actuator does not hold the rotor: {run['status']}, {run['message']}")
    return INCOMPLETE


def _machine_control(
    output: Output, path: Path, model: str | None, wishes: dict[str, Any], run: dict[str, Any],
    folder: Path | None, workers: int | None,
) -> int:  # fmt: skip
    """Control of a machine: design, run on the whole linear machine, figures."""
    from ..files.machine import load_machine
    from ..model.machine import MachineControl
    from ..model.orbit import Design
    from ..study.machine_control import study_machine_control
    from .machine_commands import analysed

    loaded = load_machine(path)
    wishes = {key: value for key, value in wishes.items() if value is not None}
    if "design" in wishes:
        wishes["design"] = Design(wishes["design"])
    if loaded.control is None and "actuator" not in wishes:
        raise InputError(
            'says not where: --actuator "250 mm", or [control] actuator = ["250 mm"] in the file',
            key="--actuator",
        )
    settings = dataclasses.replace(loaded.control or MachineControl(()), **wishes)
    loaded = loaded.with_parts(control=settings)
    loaded.check_files()
    if settings.design is Design.LQR:
        settings.large_force()  # before the films are solved
    speed = settings.speed or max(loaded.operating.speeds)
    operating = dataclasses.replace(loaded.operating, speed=(speed,))
    names = None if model is None else [model]
    results = analysed(output, loaded.with_parts(operating=operating), workers, names)
    result = results[next(reversed(results))]
    run = {key: value for key, value in run.items() if value is not None}
    study = study_machine_control(loaded, result.machine, settings, **run)
    document = _machine_document(study, result.thermal_model)
    if folder is not None:
        from ..show.job import save_figures
        from ..show.study_figures import machine_control_figures

        document["files"] = save_figures(machine_control_figures(study, loaded.title), folder)
    output.results(document, lambda: _machine_tables(study))
    if not result.converged:
        output.warn("a film or the static equilibrium did not converge")
    elif study.holds:
        return DONE
    growth = float(study.controlled_eigenvalues[0].real)
    if growth >= 0.0:
        word = f"unstable: growth rate {growth:.4g} 1/s" if growth else "undamped"
        unsampled = study.unsampled_growth_rate
        if unsampled is not None and unsampled < 0.0:
            word += f", but not before it is sampled ({unsampled:.4g} 1/s): shorten sample_time"
            word += " or delay"
        output.warn(f"the whole machine stays {word}")
    elif not study.holds:
        output.warn(
            f"stable in the small, but its run at {speed * RPM:.0f} rpm does not come to rest"
            + ": the actuators saturate" * study.saturates
        )
    return INCOMPLETE


def _machine_document(study: MachineControlStudy, model: str) -> dict[str, Any]:
    """Control of a machine for JSON."""
    reduction, feedback = study.reduction, study.feedback

    def motion(run: Any, values: Any) -> dict[str, Any]:
        sizes = (None, None) if run is None else (float(run.size.max()), float(run.size[-1]))
        return {
            "eigenvalues": values[:12],
            "growth_rate": float(values[0].real),
            "largest_displacement": sizes[0],
            "final_displacement": sizes[1],
        }

    return {
        "speed": study.speed,
        "thermal_model": model,
        "design": study.design.value,
        "actuators": study.actuators,
        "sensors": study.sensors,
        "states": study.system.nstates,
        "reduced": {
            "states": reduction.system.nstates,
            "kept_exactly": reduction.kept_exactly,
            "largest_gain": reduction.scale,
            "error_bound": reduction.bound,
            "error_found": reduction.error,
            "hankel_singular_values": reduction.hankel[:40],
        },
        "feedback": {name: getattr(feedback, name) for name in ("a", "b", "c", "d", "w")},
        "sample_time": feedback.sample_time or None,
        "delay": feedback.delay,
        "max_force": feedback.max_force,
        "largest_force": study.largest_force,
        "saturates": study.saturates,
        "modulus_margin": study.margin,
        "disturbance": study.disturbance,
        "passive": motion(study.passive, study.passive_eigenvalues),
        "controlled": motion(study.controlled, study.controlled_eigenvalues),
        "holds": study.holds,
    }


def _machine_tables(study: MachineControlStudy) -> list[Any]:
    """Control of a machine for people."""
    from .tables import grid

    said = _machine_document(study, "")
    title = f"{study.speed * RPM:.0f} rpm, {study.design.name}"
    table = grid(title, "", "growth 1/s", "whirl Hz", *heads("largest µm", "at the end µm"))
    for name, values in (
        ("passive", study.passive_eigenvalues), ("controlled", study.controlled_eigenvalues),
    ):  # fmt: skip
        row = said[name]
        lengths = (row["largest_displacement"], row["final_displacement"])
        table.add_row(
            name, number(row["growth_rate"]) if row["growth_rate"] else "undamped",
            number(abs(values[0].imag) / (2.0 * math.pi)),
            *(shown(None if one is None else one * 1e6, "µm") for one in lengths),
        )  # fmt: skip
        low = values[abs(values.imag) <= _REACH * study.speed]
        # of a sampled loop no frequency is known, only its rest by the sampling frequency
        known = not (name == "controlled" and study.feedback.sample_time)
        if known and low.size and low[0] != values[0] and row["growth_rate"] < 0.0:
            reach = number(_REACH * study.speed / (2.0 * math.pi), 3)
            table.add_row(
                f"  up to {reach} Hz", number(float(low[0].real)),
                number(abs(low[0].imag) / (2.0 * math.pi)), "", "",
            )  # fmt: skip
    reduction = study.reduction
    facts = grid("Design", "", "")
    for label, places in (("actuators at", study.actuators), ("sensors at", study.sensors)):
        facts.add_row(label, ", ".join(with_unit(at * 1e3, "mm") for at in places))
    facts.add_row("states", f"{study.system.nstates}, reduced to {reduction.system.nstates}")
    facts.add_row("kept exactly", f"{reduction.kept_exactly} states that do not decay")
    facts.add_row(
        "error of the reduction",
        f"{number(100 * reduction.error / reduction.scale, 2)} % of the largest gain, "
        f"bound {number(100 * reduction.bound / reduction.scale, 2)} %",
    )
    feedback = study.feedback
    if feedback.sample_time:
        late = f", forces {number(feedback.delay * 1e6)} µs later" if feedback.delay else ""
        facts.add_row("sampled", f"each {number(feedback.sample_time * 1e6)} µs{late}")
    stable = complex(study.controlled_eigenvalues[0]).real < 0.0
    facts.add_row("modulus margin", number(study.margin if stable else None, 3))
    if study.largest_force is not None:
        of = ", saturates" if study.saturates else ""
        facts.add_row("largest force", f"{with_unit(study.largest_force, 'N')}{of}")
    return [table, facts]


def _study_document(study: ControlStudy) -> dict[str, Any]:
    """Return a control study for JSON."""

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
        "saturates": study.saturates,
        "margins": {
            axis: dataclasses.asdict(one) for axis, one in zip("xy", study.margins, strict=True)
        },
        "passive": motion(study.passive_orbit, study.passive_eigenvalues),
        "controlled": motion(study.controlled_orbit, study.controlled_eigenvalues),
        "holds": study.holds,
        "note": study.note,
    }


def _study_tables(study: ControlStudy) -> list[Any]:
    """Return the tables of a control study."""
    from .tables import grid

    said = _study_document(study)
    title = f"{study.speed * RPM:.0f} rpm, {with_unit(study.mass, 'kg')} per bearing"
    table = grid(title, "", "growth 1/s", "run in time", "max eps")
    for name in ("passive", "controlled"):
        row = said[name]
        status = "-" if row["status"] is None else row["status"].replace("_", " ")
        eps = number(row["max_eccentricity_ratio"], 3)
        table.add_row(name, number(row["growth_rate"]), status, eps)
    columns = heads("", "x kN/mm", "y kN/mm", "vx kN s/m", "vy kN s/m")
    gains = grid("Force = - gain (x, y, vx, vy)", *columns)
    for axis, row in zip("xy", study.feedback.gain, strict=True):
        cells = [shown(v / 1e6, "kN/mm") for v in row[:2]]
        cells += [shown(v / 1e3, "kN s/m") for v in row[2:]]
        gains.add_row(f"F{axis}", *cells)
    margins = grid("Margins of the loops", "axis", "gain up", "gain down", "phase deg", "modulus")
    for axis, one in zip("xy", study.margins, strict=True):
        margins.add_row(
            axis, *(_factor(v) for v in (one.gain_increase, one.gain_reduction)),
            _factor(math.degrees(one.phase_margin)), number(one.modulus_margin, 3),
        )  # fmt: skip
    lines = [] if study.largest_force is None else [_force_words(study)]
    return [table, gains, margins, *lines, *([study.note] if study.note else [])]


def _force_words(study: ControlStudy) -> str:
    """Describe the actuator's force in the run in time, and what it had to do."""
    limit = study.feedback.max_force
    of = "unlimited" if limit == float("inf") else f"of {with_unit(limit, 'N')}"
    said = f"largest actuator force {with_unit(study.largest_force, 'N')}, {of}"
    if study.saturates:
        said = f"the actuator saturates at {with_unit(limit, 'N')}"
    start = f"from {with_unit(study.disturbance * 1e6, 'µm')} beside rest"
    return f"{said}; {start}, load {with_unit(study.load, 'N')}"


def _factor(value: float) -> str:
    return f"{value:.3g}" if math.isfinite(value) else "unlimited"
