"""One place that says how the compiled kernels are compiled."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from ..compiled import compiled

KERNEL: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract", "reassoc"}}

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile `function` on first use and keep the machine code on disk.

    Division follows numpy (no exception); sums may be reordered and fused, nothing else is relaxed,
    so that NaN and infinities still behave.
    """
    return compiled(**KERNEL, nogil=True)(function)
