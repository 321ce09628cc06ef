"""Small matrices on one thread: more threads make them slower, much so where cores are shared."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import cache, wraps
from typing import TYPE_CHECKING, ParamSpec, TypeVar

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

P = ParamSpec("P")
_Result = TypeVar("_Result")


@cache
def _controller() -> ThreadpoolController:
    import scipy.linalg  # noqa: F401 - it brings a BLAS of its own, which must be loaded by now
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


def one_blas_thread() -> AbstractContextManager[object]:
    """Return the context in which the BLAS is held to one thread."""
    return _controller().limit(limits=1, user_api="blas")


def on_one_blas_thread(function: Callable[P, _Result]) -> Callable[P, _Result]:
    """Run a function with the BLAS held to one thread."""

    @wraps(function)
    def held(*args: P.args, **kwargs: P.kwargs) -> _Result:
        with one_blas_thread():
            return function(*args, **kwargs)

    return held
