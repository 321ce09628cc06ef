"""LAPACK's band Cholesky for compiled code.

SciPy keeps the addresses of its LAPACK functions for compiled callers (scipy.linalg.cython_lapack).
Here they get names that compiled code refers to, so that it can be kept on disk; an address would
be good for one process only.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import binding
from numba import types
from numba.extending import get_cython_function_address

from ..arrays import Array
from .kernels import kernel


def _named(function: str, arguments: int) -> Any:
    """Name a LAPACK function; its arguments are pointers, as all of Fortran's."""
    name = f"rotorsim_{function}"
    binding.add_symbol(name, get_cython_function_address("scipy.linalg.cython_lapack", function))
    return types.ExternalFunction(name, types.void(*[types.voidptr] * arguments))


_dpbtrf = _named("dpbtrf", 6)
_dpbtrs = _named("dpbtrs", 9)
_LOWER = ord("L")


@kernel
def factor_band(band: Array) -> int:
    """Factor a symmetric band (size, width + 1) in place; 0 where it is positive definite.

    Row k holds column k of the matrix from its diagonal down.
    """
    size, stored = band.shape
    numbers = np.empty(5, dtype=np.int32)
    numbers[0], numbers[1], numbers[2], numbers[3] = _LOWER, size, stored - 1, stored
    _dpbtrf(
        numbers.ctypes, numbers[1:].ctypes, numbers[2:].ctypes, band.ctypes, numbers[3:].ctypes,
        numbers[4:].ctypes,
    )  # fmt: skip
    return numbers[4]


@kernel
def solve_band(band: Array, right: Array) -> None:
    """Solve for right-hand sides (count, size) in place with the factor of `factor_band`."""
    count, size = right.shape
    stored = band.shape[1]
    numbers = np.empty(6, dtype=np.int32)
    numbers[0], numbers[1], numbers[2] = _LOWER, size, stored - 1
    numbers[3], numbers[4] = count, stored
    _dpbtrs(
        numbers.ctypes, numbers[1:].ctypes, numbers[2:].ctypes, numbers[3:].ctypes, band.ctypes,
        numbers[4:].ctypes, right.ctypes, numbers[1:].ctypes, numbers[5:].ctypes,
    )  # fmt: skip
