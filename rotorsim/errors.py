"""Exceptions: one small family, every message saying what to do.

Bad input raises; a numerical failure does not: it is a `SolveStatus` that travels with the result
(see `rotorsim.status`).
"""

from __future__ import annotations

from datetime import date, time
from pathlib import Path

from .text import printable


class RotorsimError(Exception):
    """Base of everything that rotorsim raises on purpose."""


class InputError(RotorsimError, ValueError):
    """The input is wrong: where, what was found, what is allowed.

    Parameters
    ----------
    message : str
        What is wrong and what is allowed, in one sentence.
    source : str or Path, optional
        The file (or other origin) of the value.
    key : str, optional
        Dotted name of the offending entry, for example ``bearing.radial_clearance``.
    value : object, optional
        What was found there.
    """

    def __init__(
        self,
        message: str,
        *,
        source: str | Path | None = None,
        key: str | None = None,
        value: object = None,
    ) -> None:
        self.message = message
        self.source: str | None = None if source is None else str(source)
        self.key = key
        self.value = value
        where = [printable(part) for part in (self.source, key) if part]
        shown = str(value) if isinstance(value, Path | date | time) else value
        found = "" if value is None else f" (found: {shown!r})"
        super().__init__(": ".join([*where, message + found]))


class ScenarioError(InputError):
    """A scenario file cannot be used.

    Parameters
    ----------
    others : tuple of str, optional
        Further errors found in the same file, one line each; shown after the first.
    """

    def __init__(
        self,
        message: str,
        *,
        source: str | Path | None = None,
        key: str | None = None,
        value: object = None,
        others: tuple[str, ...] = (),
    ) -> None:
        super().__init__(message, source=source, key=key, value=value)
        self.others = others

    def __str__(self) -> str:
        """Give the first error, then one line for each further one."""
        return "\n".join([super().__str__(), *(f"  also: {line}" for line in self.others)])


class TableError(InputError):
    """A coefficient table cannot be used."""


class OutOfRangeError(InputError):
    """A look-up outside the tabulated range; the message gives the bounds."""


def interruption(error: BaseException) -> KeyboardInterrupt | None:
    """Return the interruption that `error` hides, if it does.

    A signal that arrives while compiled code hands its result over comes out as a chain of
    `SystemError` that ends in the interruption.
    """
    hidden: BaseException | None = error
    while isinstance(hidden, SystemError):
        hidden = hidden.__cause__ or hidden.__context__
    return hidden if isinstance(hidden, KeyboardInterrupt) else None
