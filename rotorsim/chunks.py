"""The sweep's unit of work: consecutive speeds of one case, solved one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Future
from dataclasses import dataclass
from typing import Any

from .errors import InputError
from .model import Case
from .operating_point import OperatingPoint
from .records import failed_point


@dataclass(frozen=True)
class Chunk:
    """Consecutive speeds [rad/s] of one case: what one worker does at a time."""

    number: int
    """Place of the case in the sweep."""
    case: Case
    speeds: tuple[float, ...]


def solve_chunk(
    chunk: Chunk, solve_case: Callable[..., Any] | None = None
) -> tuple[OperatingPoint, ...]:
    """Points of one chunk; this is what travels to the workers."""
    return tuple(along_speed(chunk, solve_case))


def along_speed(chunk: Chunk, solve_case: Callable[..., Any] | None) -> Iterator[OperatingPoint]:
    """Each speed starts from the last converged one; a failure costs its own point alone."""
    if solve_case is None:
        from .solver import solve_case as film_solver

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
    except BrokenExecutor as error:
        message = f"the worker process was lost ({error})"
    except Exception as error:
        message = f"the executor failed: {type(error).__name__}: {error}"
    return tuple(failed_point(chunk.case, speed, message) for speed in chunk.speeds)
