"""The command `study`: designs between ends, and what each costs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from ..rows import QUANTITIES, Quantity, number, quantity
from .options import (
    ModelOption,
    ScenarioArgument,
    SchedulerOption,
    WorkersOption,
    check_file,
    check_workers,
    cluster,
    option,
)
from .output import DONE, INCOMPLETE, Output, film_progress

_VISCOSITY = Quantity("", "viscosity", "mPa s", 1e3)

if TYPE_CHECKING:
    from ..study.designs import Study

_MOST_ROWS = 12


def study(
    output: Output,
    scenario: ScenarioArgument,
    samples: Annotated[
        int | None, option("--samples -n", "N", "Number of designs.", "the scenario's")
    ] = None,
    model: ModelOption = None,
    file: Annotated[
        Path | None, option("--output -o", "FILE", "The designs (CSV).", "studies/NAME.csv")
    ] = None,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
) -> int:
    r"""Solve many designs between the ends that \[study] gives: threshold, loss, temperature.

    Every design is written as it is finished; interrupted, the same command goes on. More samples
    add to those that are there.

    Example: rotorsim study scenarios/study.toml --samples 64
    """
    from ..errors import InputError
    from ..files.scenario import load_scenario
    from ..model.study import MAX_SAMPLES
    from ..show.figures import study_plot
    from ..show.job import save_figures
    from ..study.designs import described, run_study

    loaded = load_scenario(scenario)
    path = file or Path("studies") / f"{scenario.stem}.csv"
    check_workers(workers)
    check_file(path, ".csv", loaded.source)
    if samples is not None and not 1 <= samples <= MAX_SAMPLES:
        raise InputError(f"must lie from 1 to {MAX_SAMPLES}", key="--samples", value=samples)
    output.kept.append(f"finished designs are in {path}; the same command goes on from there")
    with (
        cluster(scheduler, output) as executor,
        film_progress(output, samples or 0, "designs") as progress,
    ):
        found = run_study(
            loaded, path, samples=samples, thermal_model=model, executor=executor,
            workers=workers, progress=progress,
        )  # fmt: skip
    files: list[Path] = []
    if len(found.converged):
        files = save_figures([("study", study_plot(found))], Path("figures") / path.stem)
    output.results(described(found) | {"files": files}, lambda: [*_parts(found), str(path)])
    bad = len(found.designs) - len(found.converged)
    if bad:
        words = found.designs["status"].value_counts().drop("converged", errors="ignore")
        said = ", ".join(f"{count} {name}" for name, count in words.items())
        output.warn(f"{bad} of {len(found.designs)} designs have no result: {said}")
    return INCOMPLETE if bad else DONE


def _parts(found: Study) -> list[Any]:
    """Return the designs that no other beats, and what the study cost."""
    from .tables import grid

    inputs = [
        _VISCOSITY
        if one.name == "lubricant.viscosity"
        else quantity(one.name.partition(".")[2], one.unit)
        for one in found.variables
    ]
    columns = ("threshold_speed", "power_loss", "max_temperature", "min_film_thickness")
    speed, top = QUANTITIES["speed"], found.speeds[-1]
    heads = [f"threshold {speed.unit}", *(QUANTITIES[name].head for name in columns[1:])]
    table = grid(
        f"{found.title}: designs that no other beats in threshold, loss and temperature at once",
        "design", *(entry.head for entry in inputs),
        *heads,
    )  # fmt: skip
    front = found.front
    step = max(1, -(-len(front) // _MOST_ROWS))
    for _, row in front.iloc[::step].iterrows():
        cells = [str(row["sample"])]
        for variable, entry in zip(found.variables, inputs, strict=True):
            cells.append(entry.text(float(row[variable.name])))
        threshold = float(row["threshold_speed"])
        cells.append(f"> {speed.text(top)}" if threshold > top else speed.text(threshold))
        cells += [QUANTITIES[name].text(float(row[name])) for name in columns[1:]]
        table.add_row(*cells)
    words = [f"{len(found.designs)} designs, {len(found.converged)} converged, "
             f"{len(front)} on the front"]  # fmt: skip
    if found.solved:
        each = 1e3 * found.seconds / (found.solved * found.points)
        words.append(
            f"{found.solved} solved now in {number(found.seconds)} s: {number(each)} ms a point"
        )
    return [table, "; ".join(words)]
