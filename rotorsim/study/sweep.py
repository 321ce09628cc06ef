"""Operating points over cases and speeds, on any `concurrent.futures` executor."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    wait,
)
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..arguments import refuse_path
from ..bearing.operating_point import OperatingPoint, failed_point
from ..errors import InputError
from ..model import Case
from .journal import Journal, model_digest, refuse_other_sources

if TYPE_CHECKING:
    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario


@dataclass(frozen=True)
class Chunk:
    """Consecutive speeds [rad/s] of one case: what one worker does at a time."""

    number: int
    """Place of the case in the sweep."""
    case: Case
    speeds: tuple[float, ...]
    model: str = ""
    """`model_digest` of the program that wants the points; empty within one process."""


def solve_chunk(
    chunk: Chunk, solve_case: Callable[..., Any] | None = None
) -> tuple[OperatingPoint, ...]:
    """Points of one chunk; this is what travels to the workers.

    Raises InputError: The chunk was made by another program than the one that is installed here.
    """
    if chunk.model:
        refuse_other_sources(chunk.model)
    return tuple(_along_speed(chunk, solve_case))


def _along_speed(chunk: Chunk, solve_case: Callable[..., Any] | None) -> Iterator[OperatingPoint]:
    """Each speed starts from the last converged one; a failure costs its own point alone."""
    if solve_case is None:
        from ..bearing.solve import solve_case as film_solver

        solve_case = film_solver
    initial = None
    for speed in chunk.speeds:
        try:
            point, warm = solve_case(chunk.case, speed, initial=initial)
            initial = warm if point.converged else None
        except InputError:
            raise  # true of the whole case: to be told, not to be tabulated
        except Exception as error:
            # Whatever a solver may raise: the sweep goes on, the message travels with the point.
            point = failed_point(chunk.case, speed, f"{type(error).__name__}: {error}")
            initial = None
        yield point


def result_or_failure(
    future: Future[tuple[OperatingPoint, ...]], chunk: Chunk
) -> tuple[OperatingPoint, ...]:
    """Points of a finished future; failed ones where its worker was lost."""
    try:
        return future.result()
    except InputError:
        raise
    except CancelledError:
        message = "the executor gave it up: is the scheduler still there?"
    except BrokenExecutor as error:
        message = f"the worker process was lost ({error})"
    except Exception as error:
        message = f"the executor failed: {type(error).__name__}: {error}"
    return tuple(failed_point(chunk.case, speed, message) for speed in chunk.speeds)


Progress = Callable[[int, int, OperatingPoint], None]
"""Called with the number of points done, the number in all, and the point just finished."""

CHUNK = 5
"""Speeds solved one after the other by one worker: long enough for warm starts to pay, short enough
for the work to spread evenly and for progress to move."""


def tabulate(
    scenario: Scenario,
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
    resume: str | Path | None = None,
) -> CoefficientTable:
    """Solve every case of `scenario` at every speed.

    Parameters
    ----------
    scenario : Scenario
    executor : Executor, optional
        Where to compute; anything with the `concurrent.futures` interface, a Dask client's
        ``get_executor()`` included. It stays open. Default: processes on this machine.
    workers : int, optional
        Number of processes; 1 computes in this one. Default: one for each core, as far as there is
        work for them. Not together with `executor`.
    progress : callable, optional
        ``progress(done, total, point)``, called in this thread after each point.
    resume : str or Path, optional
        Journal file. What it already holds is not computed again; what finishes is added at once,
        so that a killed sweep loses the points in work and no others. Delete it when the table is
        saved.

    Returns
    -------
    CoefficientTable
        A point that did not converge carries a status that says so; it costs no other point.

    Raises
    ------
    InputError
        `workers` below 1, a `resume` file of another kind, a case that cannot be meshed, or a
        file's name in place of the scenario.
    """
    refuse_path(scenario)
    cases, speeds = list(scenario.cases()), [float(speed) for speed in scenario.speeds]
    points = sweep_points(
        cases, speeds, executor=executor, workers=workers, progress=progress, resume=resume
    )
    return as_table(points, scenario)


def as_table(points: Sequence[OperatingPoint], scenario: Scenario) -> CoefficientTable:
    """Table of `points` with the provenance of `scenario`."""
    from ..bearing.table import CoefficientTable

    mesh = scenario.film.mesh
    attributes = {
        "title": scenario.title,
        "scenario": scenario.text,
        "mesh": f"circumferential {mesh.circumferential}, axial {mesh.axial}, "
        f"cross_film {mesh.cross_film}, bush_radial {mesh.bush_radial}",
    }
    return CoefficientTable.from_points(points, attributes)


def sweep_points(
    cases: Sequence[Case],
    speeds: Sequence[float],
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
    resume: str | Path | None = None,
    solve_case: Callable[..., Any] | None = None,
) -> list[OperatingPoint]:
    """Operating points of `cases` x `speeds`, case by case, each in the order of `speeds`.

    Parameters are those of `tabulate`; `solve_case` stands in for
    `rotorsim.bearing.solve.solve_case` (importable by name where the executor is another process).
    """
    if workers is not None and (workers < 1 or executor is not None):
        raise InputError("must be 1 or more, and not given with an executor", value=workers)
    journal = None if resume is None else Journal(resume)
    done = _from_journal(journal, cases, speeds)
    total = len(cases) * len(speeds)
    reported = 0
    for point in done.values():
        reported += 1
        if progress is not None:
            progress(reported, total, point)
    chunks = _chunks(cases, speeds, done)
    # Closed by name: an error in here must stop the workers now, not when the generator is freed.
    with closing(_computed(chunks, executor, workers, solve_case)) as computed:
        for chunk, points in computed:
            if journal is not None:
                journal.append(chunk.case, points)
            for speed, point in zip(chunk.speeds, points, strict=True):
                done[chunk.number, speed] = point
                reported += 1
                if progress is not None:
                    progress(reported, total, point)
    return [done[index, speed] for index in range(len(cases)) for speed in speeds]


def _from_journal(
    journal: Journal | None, cases: Sequence[Case], speeds: Sequence[float]
) -> dict[tuple[int, float], OperatingPoint]:
    if journal is None or not len(journal):
        return {}
    found = {
        (index, speed): journal.find(case, speed)
        for index, case in enumerate(cases)
        for speed in speeds
    }
    return {key: point for key, point in found.items() if point is not None}


def _chunks(
    cases: Sequence[Case], speeds: Sequence[float], done: Mapping[tuple[int, float], object]
) -> list[Chunk]:
    chunks = []
    for index, case in enumerate(cases):
        missing = [speed for speed in speeds if (index, speed) not in done]
        chunks += [
            Chunk(index, case, tuple(missing[first : first + CHUNK]))
            for first in range(0, len(missing), CHUNK)
        ]
    # Heavy cases first: what starts last should be short, or one worker ends alone.
    return sorted(chunks, key=lambda chunk: chunk.case.thermal.model.value == "isothermal")


def _computed(
    chunks: Sequence[Chunk],
    executor: Executor | None,
    workers: int | None,
    solve_case: Callable[..., Any] | None,
) -> Generator[tuple[Chunk, tuple[OperatingPoint, ...]], None, None]:
    """Pairs of (part of) a chunk and its points, as they finish."""
    workers = min(workers or available_cores(), max(len(chunks), 1))
    if executor is not None:
        yield from _on_executor(chunks, executor, solve_case)
    elif workers == 1:
        for chunk in chunks:
            for speed, point in zip(chunk.speeds, _along_speed(chunk, solve_case), strict=True):
                yield Chunk(chunk.number, chunk.case, (speed,)), (point,)
    else:
        from .processes import on_processes

        yield from on_processes(chunks, workers, solve_case)


def _on_executor(
    chunks: Sequence[Chunk], executor: Executor, solve_case: Callable[..., Any] | None
) -> Iterator[tuple[Chunk, tuple[OperatingPoint, ...]]]:
    digest = model_digest()  # elsewhere the program may be another one
    running = {
        executor.submit(solve_chunk, replace(chunk, model=digest), solve_case): chunk
        for chunk in chunks
    }
    try:
        while running:
            finished, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in finished:
                chunk = running.pop(future)
                yield chunk, result_or_failure(future, chunk)
    finally:
        for future in running:
            future.cancel()


def available_cores() -> int:
    """Cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
