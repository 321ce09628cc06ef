"""Design studies: a scenario's entries drawn between ends, every design solved and written at once.

The results are one CSV file, to which rows are added in the order in which designs finish: other
programs read it, a kill costs the rows in work and no others, and no more of it is held than is
being solved.
"""

from __future__ import annotations

import csv
import hashlib
import json
import math
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import closing
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array, Booleans
from ..atomic import write_text
from ..errors import InputError, RotorsimError
from ..file_kinds import is_missing
from ..files.scenario.scenario import entry_kind
from ..model import ThermalModel, preferred_model
from ..model.entries import choice
from ..units import QUANTITIES, parse_quantity
from .changes import OTHERWISE
from .finished import model_digest
from .processes import stream
from .stability import stability_curves
from .sweep import as_table, refuse_other_sources, sweep_points

if TYPE_CHECKING:
    import pandas as pd

    from ..bearing.operating_point import OperatingPoint
    from ..files.scenario import Scenario
    from ..model.study import Range

_RESULTS = (
    "threshold_speed", "growth_rate", "critical_mass", "eccentricity_ratio", "load",
    "min_film_thickness", "max_pressure", "max_temperature", "power_loss", "side_flow",
)  # fmt: skip
"""Results of a design in SI, at its highest speed but for the threshold."""
_BATCH = 4
"""Designs that travel to a worker together."""
_HEADER = "# rotorsim study"


@dataclass(frozen=True)
class _Variable:
    """An entry that varies, its ends in SI.

    unit : SI unit; empty for pure numbers.
    """

    name: str
    low: float
    high: float
    unit: str
    logarithmic: bool

    def values(self, unit_interval: Array) -> Array:
        """Return values for numbers from 0 to 1."""
        if self.logarithmic:
            return np.asarray(self.low * (self.high / self.low) ** unit_interval)
        return self.low + (self.high - self.low) * unit_interval


@dataclass(frozen=True, eq=False)
class Study:
    """Designs and what they come to.

    designs : One row each: ``sample``, the variables by their names, ``status``, the `_RESULTS` in
        SI. ``threshold_speed`` is the lowest at which the rotor loses its stability: infinite where
        it is stable at all speeds, 0 where it never is, NaN without a rotor or where a speed is not
        known.
    seconds : Computing time of the designs solved now; 0 where all were there already.
    solved : How many those are.
    points : Operating points of one design.
    """

    title: str
    variables: tuple[_Variable, ...]
    thermal_model: str
    speeds: tuple[float, ...]
    designs: pd.DataFrame
    path: Path
    seconds: float
    solved: int
    points: int

    @cached_property
    def converged(self) -> pd.DataFrame:
        """Designs all of whose points converged."""
        return self.designs.loc[self.designs["status"] == "converged"]

    @cached_property
    def front(self) -> pd.DataFrame:
        """Designs that no other beats in threshold speed, power loss and temperature at once."""
        found = self.converged
        goals = np.column_stack(
            [-found["threshold_speed"].fillna(0.0), found["power_loss"], found["max_temperature"]]
        )
        return found.loc[_undominated(goals)].sort_values(by="power_loss")


def _undominated(goals: Array) -> Booleans:
    """Return whether no other row is as low in every column and lower in one, (n,)."""
    order = np.lexsort(goals.T[::-1])
    kept = np.zeros(len(goals), dtype=bool)
    front = np.empty((0, goals.shape[1]))
    for row in order:  # a row can only be beaten by one before it
        beaten = (front <= goals[row]).all(axis=1) & (front < goals[row]).any(axis=1)
        if not beaten.any():
            kept[row] = True
            front = np.vstack([front, goals[row]])
    return kept


def run_study(
    scenario: Scenario,
    path: str | Path,
    *,
    samples: int | None = None,
    thermal_model: str | None = None,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Study:
    """Solve the designs of the scenario's ``[study]`` that `path` does not hold yet.

    path : CSV file of the results. Made, or added to.
    samples : In place of the scenario's.
    thermal_model : By default ``thd`` where there is a choice.
    executor, workers : As for `rotorsim.tabulate`.
    progress : ``progress(done, total)`` in designs.
    Raises InputError: No ``[study]``, a key that no scenario has or whose ends are refused, or a
        file that holds something else.
    """
    settings = scenario.study
    if settings is None:
        raise InputError(
            'is missing: write for example [study] with vary = { "bearing.radial_clearance" = '
            '["80 um", "120 um"] }',
            key="study",
        )
    model = choice(ThermalModel, thermal_model or preferred_model(scenario.thermal_models))
    base = scenario.replace(**OTHERWISE, thermal_model=str(model))
    variables = tuple(_variable(base, one) for one in settings.vary)
    design = _Design(base.text, scenario.source, tuple(v.name for v in variables), model_digest())
    count, path = samples or settings.samples, Path(path)
    log = _Log(path, design, variables, settings.seed)
    there = frozenset(number for number in log.done if number < count)
    begun, done = time.perf_counter(), len(there)
    batches = _batches(variables, settings.seed, count, there)
    with log, closing(stream(design.rows, batches, executor, workers)) as rows:
        for batch in rows:
            log.add(batch)
            done += len(batch)
            if progress is not None:
                progress(done, count)
    solved = count - len(there)
    seconds = time.perf_counter() - begun if solved else 0.0
    designs = _read(path)
    designs = designs.loc[designs["sample"] < count].sort_values(by="sample", ignore_index=True)
    return Study(
        scenario.title, variables, str(model), tuple(map(float, scenario.speeds)), designs, path,
        seconds, solved, len(scenario.speeds),
    )  # fmt: skip


def _variable(base: Scenario, given: Range) -> _Variable:
    """Check both ends of a range by the scenario they make."""
    key = f"study.vary.{given.name}"
    try:
        name, kind = entry_kind(type(base), given.name)
        ends = [_number(end, kind) for end in (given.low, given.high)]
        for end in ends:
            base.replace(**{name: end})
    except InputError as error:
        raise InputError(error.message, key=key, value=f"{given.low}, {given.high}") from None
    low, high = ends
    if not low < high or (given.logarithmic and not low > 0.0):
        said = "must ascend" if not low < high else "must begin above 0 for logarithmic spacing"
        raise InputError(said, key=key, value=f"{given.low}, {given.high}")
    unit = "" if kind is None else QUANTITIES[kind].unit
    return _Variable(name, low, high, unit, given.logarithmic)


def _number(end: Any, kind: str | None) -> float:
    if kind is not None:
        return parse_quantity(end, kind)
    if isinstance(end, bool) or not isinstance(end, (int, float)) or not math.isfinite(end):
        raise InputError("must have two plain numbers as its ends")
    return float(end)


def _batches(
    variables: Sequence[_Variable], seed: int, count: int, there: frozenset[int]
) -> Iterator[list[tuple[int, tuple[float, ...]]]]:
    """Return numbers of the designs that are not `there` and their values, a few at a time."""
    from scipy.stats import qmc

    sobol = qmc.Sobol(len(variables), rng=seed)
    for first in range(0, count, _BATCH):
        drawn = sobol.random(_BATCH)
        values = np.column_stack([one.values(drawn[:, k]) for k, one in enumerate(variables)])
        batch = [
            (first + k, tuple(map(float, row)))
            for k, row in enumerate(values[: count - first])
            if first + k not in there
        ]
        if batch:
            yield batch


@dataclass(frozen=True)
class _Design:
    """From values to a row of results; this travels to the workers.

    model : `model_digest` of the program that asks.
    """

    text: str
    source: Path | None
    names: tuple[str, ...]
    model: str

    def rows(self, batch: Sequence[tuple[int, tuple[float, ...]]]) -> list[list[Any]]:
        """Return rows of some designs."""
        from ..files.scenario import Scenario

        refuse_other_sources(self.model)
        base = Scenario.from_text(self.text, self.source)
        return [[number, *values, *self._results(base, values)] for number, values in batch]

    def _results(self, base: Scenario, values: Sequence[float]) -> list[Any]:
        try:
            scenario = base.replace(**dict(zip(self.names, values, strict=True)))
            points = sweep_points(list(scenario.cases()), list(scenario.speeds), workers=1)
        except RotorsimError as error:
            return ["refused", *[math.nan] * len(_RESULTS), str(error)]
        return self._described(scenario, points)

    @staticmethod
    def _described(scenario: Scenario, points: Sequence[OperatingPoint]) -> list[Any]:
        (curve,) = stability_curves(as_table(points, scenario), scenario.rotor)
        last, rates = points[-1], curve.growth_rate
        threshold = math.nan
        if rates is not None and np.isfinite(rates).all():
            unstable = [s for s in curve.threshold_speeds if s > curve.speed[0]]
            threshold = 0.0 if rates[0] > 0.0 else min(unstable, default=math.inf)
        found = {
            "threshold_speed": threshold,
            "growth_rate": math.nan if rates is None else float(rates[-1]),
            "critical_mass": math.nan if last.critical_mass is None else last.critical_mass,
        }
        bad = next((point for point in points if not point.converged), None)
        numbers = [found.get(name, getattr(last, name, math.nan)) for name in _RESULTS]
        status, message = (bad.status.value, bad.message) if bad else ("converged", "")
        return [status, *numbers, message]


class _Log:
    """The file of a study: a line that says what it is, column names, one row for each design."""

    def __init__(
        self, path: Path, design: _Design, variables: Sequence[_Variable], seed: int
    ) -> None:
        digest = hashlib.sha256(repr((design, variables, seed)).encode()).hexdigest()[:24]
        units = {one.name: one.unit for one in variables if one.unit}
        self.path = path
        self._head = [
            f"{_HEADER} {digest}; SI units {json.dumps(units)}",
            ",".join(["sample", *design.names, "status", *_RESULTS, "message"]),
        ]
        self._rows = self._kept()
        self.done = {int(row.split(",", 1)[0]) for row in self._rows}

    def _kept(self) -> list[str]:
        """Return whole rows that are there already."""
        if is_missing(self.path):
            return []
        lines = self.path.read_text(encoding="utf-8", errors="replace").splitlines(keepends=True)
        first = lines[0].rstrip("\n") if lines else ""
        if not first.startswith(_HEADER):
            raise InputError("is not the file of a study; choose another name", source=self.path)
        if first != self._head[0]:
            raise InputError(
                "holds another study (other ranges, entries or sources of the program); remove it "
                "or choose another name", source=self.path,
            )  # fmt: skip
        commas = self._head[1].count(",")
        whole = (row for row in lines[2:] if row.endswith("\n") and row.count(",") >= commas)
        return [row for row in whole if row.split(",", 1)[0].isdigit()]

    def __enter__(self) -> _Log:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        # What a kill left half written is cut off, or the next row would join it.
        write_text(self.path, "".join([*(f"{line}\n" for line in self._head), *self._rows]))
        self._rows.clear()
        self._stream = self.path.open("a", encoding="utf-8", newline="\n")
        self._writer = csv.writer(self._stream, lineterminator="\n")
        return self

    def __exit__(self, *_: object) -> None:
        self._stream.close()

    def add(self, rows: Sequence[Sequence[Any]]) -> None:
        """Write rows and hand them to the system."""
        for row in rows:
            self._writer.writerow(
                [f"{x:.9g}" if isinstance(x, float) else str(x).replace("\n", " ") for x in row]
            )
        self._stream.flush()


def _read(path: Path) -> pd.DataFrame:
    import pandas as pd

    found = pd.read_csv(path, skiprows=1, dtype={"message": str})
    return found.assign(message=found["message"].fillna(""))


def described(study: Study) -> dict[str, Any]:
    """Return what a study comes to, for `rotorsim study --json`."""
    counts = study.designs["status"].value_counts()
    return {
        "title": study.title,
        "thermal_model": study.thermal_model,
        "speeds": study.speeds,
        "variables": [asdict(one) for one in study.variables],
        "samples": len(study.designs),
        "status": {str(name): int(count) for name, count in counts.items()},
        "solved_now": study.solved,
        "seconds": study.seconds,
        "points_per_design": study.points,
        "table": study.path,
        "front": study.front.drop(columns="message").to_dict("records"),
    }
