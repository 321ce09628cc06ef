"""Orbits in time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import InputError
from .film_commands import computed_table
from .options import (
    BearingOption,
    ModelOption,
    ScenarioArgument,
    WorkersOption,
    check_file,
    given_table,
    option,
    table_path,
)
from .output import DONE, INCOMPLETE, Output, as_typed, late_progress, progress_bar

if TYPE_CHECKING:
    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario
    from ..orbit import Orbit


def orbit(
    output: Output,
    scenario: ScenarioArgument,
    table: Annotated[
        Path | None, option("--table -t", "FILE", "Use this table.", "computed")
    ] = None,
    bearing: BearingOption = None,
    model: ModelOption = None,
    recording: Annotated[
        Path | None, option("--output -o", "FILE", "The recording.", "logs/NAME.rrd")
    ] = None,
    figures: Annotated[
        bool, typer.Option("--figures", help="Write orbits and cascades to figures/NAME too.")
    ] = False,
    gif: Annotated[
        bool, typer.Option("--gif", help="Write the animation figures/NAME/orbit.gif too.")
    ] = False,
    mp4: Annotated[
        bool, typer.Option("--mp4", help="Write it as orbit.mp4 (needs the program ffmpeg).")
    ] = False,
    steady: Annotated[
        bool, typer.Option("--steady", help="Figures and animation without the transient.")
    ] = False,
    live: Annotated[
        bool, typer.Option("--live", help="Show the run in the viewer while it is integrated.")
    ] = False,
    limit_cycles: Annotated[
        bool, typer.Option("--limit-cycles", help="Of a machine: follow its whirl over speed.")
    ] = False,
    workers: WorkersOption = None,
) -> int:
    """Simulate the scenario's orbit, or a machine's motion, in time and record it.

    With force = "linear" in the scenario the coefficient table is used, with "film" the nonlinear
    film itself.

    Example: rotorsim orbit scenarios/orbit_limit_cycle.toml --gif
    """
    from .machine_commands import is_machine, machine_limit_cycles, machine_orbit

    if limit_cycles and not is_machine(scenario):
        raise InputError("goes with a machine file", key="--limit-cycles", value=scenario)
    if is_machine(scenario):
        for key, value in (("--table", table), ("--bearing", bearing), ("--live", live or None)):
            if value is not None:
                raise InputError("goes with a bearing's scenario, not with a machine", key=key)
        if limit_cycles:
            return machine_limit_cycles(output, scenario)
        check_file(recording or Path("logs") / f"{scenario.stem}.rrd", ".rrd", scenario)
        _check_mp4(mp4)
        suffixes = [suffix for wanted, suffix in ((gif, ".gif"), (mp4, ".mp4")) if wanted]
        return machine_orbit(output, scenario, recording, figures, suffixes, steady, model)
    from ..files.scenario import load_scenario
    from ..orbit.description import describe_orbit
    from ..show.job import orbit_figures, record_scenario, save_figures
    from ..study.orbits import orbit_settings

    loaded = load_scenario(scenario)
    settings, _ = orbit_settings(loaded)  # what is missing should be said before the work
    path = recording or Path("logs") / f"{scenario.stem}.rrd"
    check_file(path, ".rrd", scenario)
    _check_mp4(mp4)
    coefficients = _coefficients(output, loaded, scenario, table, bearing, workers)
    orbits = _simulate(output, loaded, coefficients, _models(loaded, coefficients, model), live)
    folder = Path("figures") / scenario.stem
    steady = steady or settings.steady_only
    _, missing = record_scenario(
        loaded, orbits, path, table=coefficients, announce=output.note, workers=workers
    )
    for reason in missing:
        output.warn(f"left out of the recording: {reason}")
    written: list[Path] = []
    if figures:
        written += save_figures(orbit_figures(orbits, loaded.title, steady), folder, ("png",))
    for wanted, suffix in ((gif, ".gif"), (mp4, ".mp4")):
        if wanted:
            from ..show.figures import animate_orbits

            output.note(f"drawing orbit{suffix}")
            target = folder / f"orbit{suffix}"
            written.append(animate_orbits(orbits, target, loaded.title, steady))
    rows = [describe_orbit(one) for one in orbits]
    output.document({"recording": path, "figures": written, "orbits": rows})
    if not (output.json or output.quiet):
        from .tables import orbit_details, orbit_table

        output.show(orbit_table(rows), *orbit_details(rows))
        output.show(*(str(file) for file in written))
        output.show(f"recorded in {path}; look at it: rotorsim view {as_typed(path)}")
    failed = [one for one in orbits if one.status.value == "integration_failed"]
    for one in failed:
        output.warn(f"orbit {one.thermal_model}: {one.message}")
    return INCOMPLETE if failed else DONE


def _check_mp4(wanted: bool) -> None:
    from ..show.figures.orbits import can_write_mp4

    if wanted and not can_write_mp4():
        raise InputError(
            "needs the program ffmpeg, which is not installed; --gif needs nothing", key="--mp4"
        )


def _coefficients(
    output: Output,
    loaded: Scenario,
    scenario: Path,
    table: Path | None,
    bearing: str | None,
    workers: int | None,
) -> CoefficientTable | None:
    """Return the table for linear coefficients; a nonlinear film needs none."""
    from ..model.orbit import OrbitForce
    from ..study.inputs import differences

    if loaded.orbit is not None and loaded.orbit.force is not OrbitForce.LINEAR:
        if table is not None:
            raise InputError(
                'has no use: the scenario\'s orbit has force = "film"', key="--table", value=table
            )
        return None
    if table is not None:
        found = given_table(output, table, bearing)
        differing = differences(loaded, found)
        if differing:
            output.warn(f"{table} was computed for another scenario: {', '.join(differing)} differ")
        return found
    return computed_table(output, loaded, table_path(scenario, Path()), workers)[1]


def _models(
    loaded: Scenario, coefficients: CoefficientTable | None, wanted: str | None
) -> list[str]:
    if wanted is not None:
        return [wanted]
    if coefficients is not None:
        return [str(name) for name in coefficients.dataset["thermal_model"].values]
    return [model.value for model in loaded.thermal_models]


def _simulate(
    output: Output,
    loaded: Scenario,
    coefficients: CoefficientTable | None,
    models: Sequence[str],
    live: bool,
) -> list[Orbit]:
    from ..study.orbits import orbit_settings, prepare_film, scenario_schedule, simulate_orbit

    total = scenario_schedule(orbit_settings(loaded)[0]).revolutions
    orbits = []
    with ExitStack() as stack:
        show: Callable[[Orbit], None] | None = None
        if live:
            from ..show.recording.live import LiveView

            show = stack.enter_context(LiveView(loaded.title)).show
        for name in models:
            with late_progress(output, "force map, kept for later runs") as prepared:
                prepare_film(loaded, name, prepared)
            with progress_bar(output, f"orbit {name}", total) as progress:

                def consume(piece: Orbit, progress: Callable[[float], None] = progress) -> None:
                    if show is not None:
                        show(piece)
                    if piece.t.size:
                        progress(float(piece.revolutions[-1]))

                orbits.append(
                    simulate_orbit(loaded, coefficients, thermal_model=name, consume=consume)
                )
    return orbits
