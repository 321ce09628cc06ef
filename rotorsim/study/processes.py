"""The sweep's own process pool: no guard in user scripts, no orphans, lost workers survived."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from multiprocessing.connection import Connection
from multiprocessing.connection import wait as wait_for_any
from types import ModuleType
from typing import TYPE_CHECKING, Any, TypeVar

from .sweep import Chunk, result_or_failure, solve_chunk

if TYPE_CHECKING:
    from ..bearing.operating_point import OperatingPoint

    Points = tuple[OperatingPoint, ...]

_Item = TypeVar("_Item")
_Result = TypeVar("_Result")
_THREAD_LIMITS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def on_processes(
    chunks: Sequence[Chunk], workers: int, solve_case: Callable[..., Any] | None
) -> Iterator[tuple[Chunk, Points]]:
    """Points of `chunks` as they finish, computed by `workers` processes.

    A process that dies (out of memory, say) takes the pool with it. What was in work is then done
    again speed by speed, one process at a time, so that only the point that kills its process is
    lost; the rest goes on in a new pool.
    """
    waiting = deque(chunks)
    with _one_thread_each():
        while waiting:
            running: dict[Future[Points], Chunk] = {}
            try:
                with _pool(workers) as pool:
                    yield from _drain(pool, waiting, running, workers, solve_case)
            except BrokenExecutor:
                for chunk in list(running.values()):
                    yield from _one_by_one(chunk, solve_case)


def map_on_processes(
    function: Callable[[_Item], _Result],
    items: Iterable[_Item],
    workers: int,
    done: Callable[[int], None] | None = None,
) -> list[_Result]:
    """Results of `function` on every item, in their order, computed by `workers` processes.

    function : It and what it returns must be picklable.
    workers : 1 computes in this process.
    done : Called with the number of items done.
    Raises Exception: What `function` raised, and `BrokenExecutor` where a process was lost.
    """
    report = done or (lambda _count: None)
    results: list[_Result] = []
    if workers == 1:
        for item in items:
            results.append(function(item))
            report(len(results))
        return results
    with _one_thread_each(), _pool(workers) as pool:
        with _anonymous_main():
            futures = [pool.submit(function, item) for item in items]
        for future in futures:
            results.append(future.result())
            report(len(results))
    return results


def _drain(
    pool: ProcessPoolExecutor,
    waiting: deque[Chunk],
    running: dict[Future[Points], Chunk],
    workers: int,
    solve_case: Callable[..., Any] | None,
) -> Iterator[tuple[Chunk, Points]]:
    """Keep the pool busy and no more: what it holds when it breaks must be done again."""
    while waiting or running:
        while waiting and len(running) < 2 * workers:
            with _anonymous_main():
                future = pool.submit(solve_chunk, waiting[0], solve_case)
            running[future] = waiting.popleft()
        finished, _ = wait(running, return_when=FIRST_COMPLETED)
        for future in finished:
            if isinstance(future.exception(), BrokenExecutor):
                future.result()  # raises: the pool is lost, and what is running with it
            chunk = running.pop(future)
            yield chunk, result_or_failure(future, chunk)


def _one_by_one(
    chunk: Chunk, solve_case: Callable[..., Any] | None
) -> Iterator[tuple[Chunk, Points]]:
    for speed in chunk.speeds:
        single = Chunk(chunk.number, chunk.case, (speed,))
        with _pool(1) as pool:
            with _anonymous_main():
                future = pool.submit(solve_chunk, single, solve_case)
            yield single, result_or_failure(future, single)


@contextmanager
def _pool(workers: int) -> Iterator[ProcessPoolExecutor]:
    """Start processes that end with the block, at once if it raises, or with this process.

    Each worker holds the reading end of a pipe that nobody writes to: it closes when the block
    ends, or when this process is killed.
    """
    # "spawn" everywhere: forking a process that has threads (BLAS, a viewer) can hang.
    context = multiprocessing.get_context("spawn")
    leash, hand = context.Pipe(duplex=False)
    pool = ProcessPoolExecutor(
        workers, mp_context=context, initializer=_start_worker, initargs=(leash,)
    )
    try:
        yield pool
        pool.shutdown(wait=True)
    finally:
        hand.close()
        pool.shutdown(wait=True, cancel_futures=True)
        leash.close()


def _start_worker(leash: Connection) -> None:
    # The parent decides what an interruption means; the worker would only add a traceback.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Said by the parent already.
    warnings.filterwarnings("ignore", message="compiled code cannot be kept")
    threading.Thread(target=_end_with_parent, args=(leash,), daemon=True).start()


def _end_with_parent(leash: Connection) -> None:
    """Without this, the workers of a killed parent would wait for work for ever."""
    wait_for_any([leash])
    os._exit(1)


@contextmanager
def _anonymous_main() -> Iterator[None]:
    """Keep a new worker from running the user's script again.

    A spawned process imports the parent's main module first, which is why multiprocessing wants
    ``if __name__ == "__main__"`` in every script. The workers need nothing from there: their work
    is in this package. An empty main module leaves them nothing to import, and starts them faster.
    """
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Libraries that start threads read their number when a worker loads them: one is enough."""
    added = [name for name in _THREAD_LIMITS if name not in os.environ]
    os.environ.update(dict.fromkeys(added, "1"))
    try:
        yield
    finally:
        for name in added:
            os.environ.pop(name, None)
