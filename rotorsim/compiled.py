"""Compiled functions and their cache on disk, which follows the sources.

Numba's own cache asks whether the file of a function has changed; what the function calls, and the
constants that are compiled into it, may stand in other files. Here machine code belongs to the
function's byte code, that of all compiled functions that it calls, and the constants of either.
"""

from __future__ import annotations

import hashlib
import pickle
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any, TypeVar

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.core.caching import FunctionCache, IndexDataCacheFile, NullCache
from numba.core.ccallback import CFunc
from numba.core.runtime.nrt import rtsys
from numba.extending import intrinsic

Function = TypeVar("Function", bound=Callable[..., Any])
_PLAIN = (bool, int, float, complex, str, bytes, type(None), np.generic)
_DIGEST = hashlib.sha256().digest_size
_told = False


def compiled(**options: Any) -> Callable[[Function], Function]:
    """Decorate a function: compile it on first use and keep the machine code on disk.

    **options : Those of `numba.njit` but ``cache``.

    Where no folder can be written to, the function is compiled in every process; that is said once.
    A damaged file of the cache counts as missing.
    """

    def decorate(function: Function) -> Function:
        dispatcher: Any = numba.njit(**options)(function)
        dispatcher._cache = _cache_of(dispatcher)
        return dispatcher

    return decorate


def is_kept(function: Callable[..., Any]) -> bool:
    """Return whether machine code of a compiled function is on disk.

    True where none can be: no process then compiles for others.
    """
    cache = getattr(function, "_cache", None)
    if not isinstance(cache, _SourceCache):
        return True
    cache._stamp()
    try:
        return bool(cache._cache_file._load_index())
    except Exception:  # unpickling what is damaged may raise anything
        return False


def address_of(function: Callable[..., Any], **options: Any) -> int:
    """Return the address of a compiled function of four pointers to floats, for `call_address`.

    Whoever calls a function by its address is compiled without it: of a large one with many callers
    that saves a minute. An address is good in one process only.

    options : Those of `numba.njit` but ``cache``.
    """
    if function not in _called:
        signature = (types.CPointer(types.float64),) * 4, types.void
        callback: Any = CFunc(function, signature, {}, options)
        callback._cache = _cache_of(function)
        callback.compile()
        _called[function] = callback
    return _called[function].address


_called: dict[Callable[..., Any], Any] = {}


def _call_address(
    _context: Any, address: Any, first: Any, second: Any, third: Any, fourth: Any
) -> Any:
    """Call the function of `address_of` with pointers (``array.ctypes``) to its arguments."""
    del address, first, second, third, fourth
    signature = types.void(types.intp, *[types.voidptr] * 4)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        pointer = ir.IntType(8).as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [pointer] * 4)
        builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), arguments[1:])
        return context.get_dummy_value()

    return signature, generate


call_address: Any = intrinsic(_call_address)


class _CheckedFile(IndexDataCacheFile):
    """Numba's files with a checksum after the pickled data, which unpickling does not look at."""

    def _dump(self, obj: Any) -> bytes:
        data = super()._dump(obj)
        return data + hashlib.sha256(data).digest()

    def _load_data(self, name: str) -> Any:
        data = Path(self._data_path(name)).read_bytes()
        if hashlib.sha256(data[:-_DIGEST]).digest() != data[-_DIGEST:]:
            return None  # damaged machine code would end the process
        return pickle.loads(data)


class _SourceCache(FunctionCache):
    """Numba's cache, valid for `_fingerprint` of a function; no fault of a disk is passed on."""

    def __init__(self, dispatcher: Any) -> None:
        super().__init__(getattr(dispatcher, "py_func", dispatcher))
        self._dispatcher = dispatcher
        self._cache_file = _CheckedFile(
            cache_path=self._cache_path, filename_base=self._impl.filename_base, source_stamp=None
        )

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the stored machine code; None where there is none, or a damaged one."""
        self._stamp()
        try:
            # Numba's own method loads all registries of the compiler first, a quarter of a second:
            # what is stored needs the runtime alone. Compilation loads them itself.
            rtsys.initialize(target_context)
            return self._load_overload(sig, target_context)
        except Exception:  # unpickling what is damaged may raise anything
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Store machine code, if the disk takes it."""
        self._stamp()
        try:
            super().save_overload(sig, data)
        except OSError:
            _tell_once()

    def _stamp(self) -> None:
        # Late: a function may be decorated before those that it calls.
        self._cache_file._source_stamp = _fingerprint(self._dispatcher)


def _cache_of(function: Any) -> Any:
    try:
        return _SourceCache(function)
    except RuntimeError:  # Numba's word for "no folder"
        _tell_once()
        return NullCache()


def _tell_once() -> None:
    global _told
    if not _told:
        _told = True
        warnings.warn(
            "compiled code cannot be kept here and is made anew each time, which takes a minute; "
            "name a folder for it in the environment: NUMBA_CACHE_DIR",
            RuntimeWarning, stacklevel=3,
        )  # fmt: skip


def _fingerprint(function: Callable[..., Any]) -> str:
    """Return SHA-256 of everything of this package that is compiled into a function.

    Examples
    --------
    >>> def double(x): return 2 * x
    >>> def twice(x): return 2 * x
    >>> def triple(x): return 3 * x
    >>> _fingerprint(double) == _fingerprint(twice) != _fingerprint(triple)
    True
    """
    digest = hashlib.sha256()
    for part in _parts(function, set()):
        digest.update(part)
        digest.update(b"\0")
    return digest.hexdigest()


def _parts(function: Any, seen: set[int]) -> Iterator[bytes]:
    """Return byte code, options and constants of a function and of the functions that it calls."""
    yield from _value(getattr(function, "targetoptions", None), seen)
    function = getattr(function, "py_func", function)
    if not isinstance(function, FunctionType) or id(function) in seen:
        return
    seen.add(id(function))
    for code in _codes(function.__code__):
        yield code.co_code
        yield from _value(code.co_varnames, seen)
        yield from _value(tuple(c for c in code.co_consts if not isinstance(c, CodeType)), seen)
        for name in code.co_names:
            yield name.encode()
            yield from _value(function.__globals__.get(name), seen)
    for cell in function.__closure__ or ():
        yield from _value(cell.cell_contents, seen)


def _codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)


def _value(value: Any, seen: set[int]) -> Iterator[bytes]:
    """Return what a constant or a global name stands for, as far as it is compiled in."""
    if isinstance(value, np.ndarray):
        yield f"{value.dtype}{value.shape}".encode() + value.tobytes()
    elif isinstance(value, _PLAIN):
        yield repr(value).encode()
    elif isinstance(value, tuple | list):
        for entry in value:
            yield from _value(entry, seen)
    elif isinstance(value, set | frozenset):
        yield repr(sorted(value, key=repr)).encode()
    elif isinstance(value, dict):
        for key in sorted(value, key=repr):
            yield from _value((key, value[key]), seen)
    elif hasattr(value, "py_func"):
        yield from _parts(value, seen)
