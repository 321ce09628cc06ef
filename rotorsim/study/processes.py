"""Work on several processes of this machine: their start, and their end with this one."""

from __future__ import annotations

import itertools
import multiprocessing
import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager, nullcontext
from multiprocessing.connection import Connection
from multiprocessing.connection import wait as wait_for_any
from types import ModuleType
from typing import Any, TypeVar

_Item = TypeVar("_Item")
_Result = TypeVar("_Result")
_THREAD_LIMITS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def available_cores() -> int:
    """Return cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def map_on_processes(
    function: Callable[[_Item], _Result],
    items: Iterable[_Item],
    workers: int,
    done: Callable[[int], None] | None = None,
) -> list[_Result]:
    """Return results of `function` on every item, in their order, computed by `workers` processes.

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
    with processes(workers) as pool:
        futures = [pool.submit(function, item) for item in items]
        for future in futures:
            results.append(future.result())
            report(len(results))
    return results


def stream(
    function: Callable[[_Item], _Result],
    items: Iterable[_Item],
    executor: Executor | None = None,
    workers: int | None = None,
) -> Generator[_Result, None, None]:
    """Return results of `function` on every item as they come; few items are in work at a time.

    executor, workers : As for `tabulate`.
    Raises Exception: What `function` raised, and `BrokenExecutor` where a process was lost.
    """
    workers = workers or available_cores()
    if executor is None and workers == 1:
        yield from map(function, items)
        return
    waiting = iter(items)
    with nullcontext(executor) if executor else processes(workers) as pool:
        running: set[Future[_Result]] = set()
        try:
            while True:
                for item in itertools.islice(waiting, 4 * workers - len(running)):
                    running.add(pool.submit(function, item))
                if not running:
                    return
                finished, running = wait(running, return_when=FIRST_COMPLETED)
                for future in finished:
                    yield future.result()
        finally:
            for future in running:
                future.cancel()


@contextmanager
def processes(workers: int) -> Iterator[Executor]:
    """Start processes that end with the block, at once if it raises, or with this process.

    Each worker holds the reading end of a pipe that nobody writes to: it closes when the block
    ends, or when this process is killed. Libraries that a worker loads are limited to one thread by
    environment variables, which they read as they are loaded.
    """
    # "spawn" everywhere: forking a process that has threads (BLAS, a viewer) can hang.
    context = multiprocessing.get_context("spawn")
    leash, hand = context.Pipe(duplex=False)
    added = [name for name in _THREAD_LIMITS if name not in os.environ]
    os.environ.update(dict.fromkeys(added, "1"))
    pool = _Pool(workers, mp_context=context, initializer=_start_worker, initargs=(leash,))
    try:
        yield pool
        pool.shutdown(wait=True)
    finally:
        hand.close()
        pool.shutdown(wait=True, cancel_futures=True)
        leash.close()
        for name in added:
            os.environ.pop(name, None)


class _Pool(ProcessPoolExecutor):
    """Processes that do not run the user's script again.

    A spawned process imports the parent's main module first, which is why multiprocessing wants
    ``if __name__ == "__main__"`` in every script. The workers need nothing from there: their work
    is in this package. An empty main module leaves them nothing to import, and starts them faster.
    """

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Schedule a call; a process that it needs is started with an empty main module."""
        main = sys.modules["__main__"]
        sys.modules["__main__"] = ModuleType("__main__")
        try:
            return super().submit(fn, *args, **kwargs)
        finally:
            sys.modules["__main__"] = main


def _start_worker(leash: Connection) -> None:
    # The parent decides what an interruption means; the worker would only add a traceback.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Said by the parent already.
    warnings.filterwarnings("ignore", message="compiled code cannot be kept")
    threading.Thread(target=_end_with_parent, args=(leash,), daemon=True).start()


def _end_with_parent(leash: Connection) -> None:
    """End with the parent: the workers of a killed one would wait for work for ever."""
    wait_for_any([leash])
    os._exit(1)
