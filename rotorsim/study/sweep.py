"""Operating points over cases and speeds, on any `concurrent.futures` executor."""

from __future__ import annotations

import socket
from collections import deque
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    wait,
)
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..arguments import refuse_path
from ..bearing.operating_point import OperatingPoint, failed_point
from ..compiled import is_kept
from ..errors import InputError, interruption
from ..film.rupture.reynolds import active_set
from ..model import Case
from .finished import Journal, PointStore, model_digest
from .processes import available_cores, processes

if TYPE_CHECKING:
    from ..bearing.operating_point import OperatingPoint
    from ..bearing.table import CoefficientTable
    from ..files.scenario import Scenario

    Points = tuple[OperatingPoint, ...]


@dataclass(frozen=True)
class _Chunk:
    """Consecutive speeds [rad/s] of one case: what one worker does at a time."""

    number: int
    """Place of the case in the sweep."""
    case: Case
    speeds: tuple[float, ...]
    model: str = ""
    """`model_digest` of the program that wants the points; empty within one process."""


def _solve_chunk(
    chunk: _Chunk, solve_case: Callable[..., Any] | None = None
) -> tuple[OperatingPoint, ...]:
    """Return points of one chunk; this is what travels to the workers.

    Raises InputError: The chunk was made by another program than the one that is installed here.
    """
    if chunk.model:
        refuse_other_sources(chunk.model)
    return tuple(_along_speed(chunk, solve_case))


def _along_speed(chunk: _Chunk, solve_case: Callable[..., Any] | None) -> Iterator[OperatingPoint]:
    """Solve each speed from the last converged one; a failure costs its own point alone."""
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
            if stop := interruption(error):
                raise stop from None
            # Whatever a solver may raise: the sweep goes on, the message travels with the point.
            point = failed_point(chunk.case, speed, f"{type(error).__name__}: {error}")
            initial = None
        yield point


def _result_or_failure(
    future: Future[tuple[OperatingPoint, ...]], chunk: _Chunk
) -> tuple[OperatingPoint, ...]:
    """Return points of a finished future; failed ones where its worker was lost."""
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
    """Return the table of `points` with the provenance of `scenario`."""
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
    """Return operating points of `cases` x `speeds`, case by case, each in the order of `speeds`.

    Parameters are those of `tabulate`; `solve_case` stands in for
    `rotorsim.bearing.solve.solve_case` (importable by name where the executor is another process).
    """
    if workers is not None and (workers < 1 or executor is not None):
        raise InputError("must be 1 or more, and not given with an executor", value=workers)
    stores: list[Journal | PointStore] = [] if resume is None else [Journal(resume)]
    done: dict[tuple[int, float], OperatingPoint] = {}
    total = len(cases) * len(speeds)

    def finish(place: int, speed: float, point: OperatingPoint) -> None:
        done[place, speed] = point
        if progress is not None:
            progress(len(done), total, point)

    with ExitStack() as stack:
        if solve_case is None:
            stores.append(stack.enter_context(PointStore()))
        for index, case in enumerate(cases):
            for speed in speeds:
                point = next(filter(None, (one.find(case, speed) for one in stores)), None)
                if point is not None:
                    finish(index, speed, point)
        # Closed by name: an error in here must stop the workers now, not when it is freed.
        computed = _computed(_chunks(cases, speeds, done), executor, workers, solve_case)
        for chunk, points in stack.enter_context(closing(computed)):
            for one in stores:
                one.add(chunk.case, points)
            for speed, point in zip(chunk.speeds, points, strict=True):
                finish(chunk.number, speed, point)
    return [done[index, speed] for index in range(len(cases)) for speed in speeds]


def _chunks(
    cases: Sequence[Case], speeds: Sequence[float], done: Mapping[tuple[int, float], object]
) -> list[_Chunk]:
    chunks = []
    for index, case in enumerate(cases):
        missing = [speed for speed in speeds if (index, speed) not in done]
        chunks += [
            _Chunk(index, case, tuple(missing[first : first + CHUNK]))
            for first in range(0, len(missing), CHUNK)
        ]
    # Heavy cases first: what starts last should be short, or one worker ends alone.
    return sorted(chunks, key=lambda chunk: chunk.case.thermal.model.value == "isothermal")


def _computed(
    chunks: Sequence[_Chunk],
    executor: Executor | None,
    workers: int | None,
    solve_case: Callable[..., Any] | None,
) -> Generator[tuple[_Chunk, tuple[OperatingPoint, ...]], None, None]:
    """Return pairs of (part of) a chunk and its points, as they finish."""
    workers = min(workers or available_cores(), max(len(chunks), 1))
    if executor is not None:
        yield from _on_executor(chunks, executor, solve_case)
    elif workers == 1:
        for chunk in chunks:
            for speed, point in zip(chunk.speeds, _along_speed(chunk, solve_case), strict=True):
                yield _Chunk(chunk.number, chunk.case, (speed,)), (point,)
    else:
        yield from _on_processes(chunks, workers, solve_case)


def _on_executor(
    chunks: Sequence[_Chunk], executor: Executor, solve_case: Callable[..., Any] | None
) -> Iterator[tuple[_Chunk, tuple[OperatingPoint, ...]]]:
    digest = model_digest()  # elsewhere the program may be another one
    running = {
        executor.submit(_solve_chunk, replace(chunk, model=digest), solve_case): chunk
        for chunk in chunks
    }
    try:
        while running:
            finished, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in finished:
                chunk = running.pop(future)
                yield chunk, _result_or_failure(future, chunk)
    finally:
        for future in running:
            future.cancel()


def refuse_other_sources(wanted: str) -> None:
    """Refuse to compute for a program of another `model_digest`: its numbers might differ.

    Raises InputError: It is another one than this.
    """
    if wanted != model_digest():
        raise InputError(
            "a worker has other sources of rotorsim than this computer, so its results might "
            "differ; install the same there and start it anew",
            key="--scheduler", value=f"{socket.gethostname()}: {model_digest()}",
        )  # fmt: skip


def _on_processes(
    chunks: Sequence[_Chunk], workers: int, solve_case: Callable[..., Any] | None
) -> Iterator[tuple[_Chunk, Points]]:
    """Return points of `chunks` as they finish, computed by `workers` processes.

    A process that dies (out of memory, say) takes the pool with it. What was in work is then done
    again speed by speed, one process at a time, so that only the point that kills its process is
    lost; the rest goes on in a new pool.
    """
    waiting = deque(chunks)
    while waiting:
        running: dict[Future[Points], _Chunk] = {}
        try:
            with processes(workers) as pool:
                yield from _drain(pool, waiting, running, workers, solve_case)
        except BrokenExecutor:
            for chunk in list(running.values()):
                yield from _one_by_one(chunk, solve_case)


def _drain(
    pool: Executor,
    waiting: deque[_Chunk],
    running: dict[Future[Points], _Chunk],
    workers: int,
    solve_case: Callable[..., Any] | None,
) -> Iterator[tuple[_Chunk, Points]]:
    """Keep the pool busy and no more: what it holds when it breaks must be done again."""
    # In a first run one process compiles for all.
    limit = 2 * workers if is_kept(active_set) else 1
    while waiting or running:
        while waiting and len(running) < limit:
            running[pool.submit(_solve_chunk, waiting[0], solve_case)] = waiting[0]
            waiting.popleft()
        finished, _ = wait(running, return_when=FIRST_COMPLETED)
        for future in finished:
            if isinstance(future.exception(), BrokenExecutor):
                future.result()  # raises: the pool is lost, and what is running with it
            chunk = running.pop(future)
            yield chunk, _result_or_failure(future, chunk)
        limit = 2 * workers


def _one_by_one(
    chunk: _Chunk, solve_case: Callable[..., Any] | None
) -> Iterator[tuple[_Chunk, Points]]:
    for speed in chunk.speeds:
        single = _Chunk(chunk.number, chunk.case, (speed,))
        with processes(1) as pool:
            yield single, _result_or_failure(pool.submit(_solve_chunk, single, solve_case), single)
