"""Results to stdout, progress and complaints to stderr; and the exit codes."""

from __future__ import annotations

import functools
import os
import shlex
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, nullcontext
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import typer

from ..errors import InputError, RotorsimError, interruption
from ..rows import show_units

if TYPE_CHECKING:
    from pathlib import Path

    from rich.console import Console, RenderableType

    from ..bearing.operating_point import OperatingPoint


DONE = 0
"""Everything asked for was computed."""
INCOMPLETE = 1
"""Ran, but something did not converge or left its range; the rest is kept."""
WRONG_INPUT = 2
"""Nothing was computed: the input must be changed first."""
_INTERRUPTED = 130
"""Stopped by the user (the shells' code for it)."""
_TABLE_WIDTH = 100
_DRAWING = ("run", "stability", "orbit", "control", "transient", "study")
"""Commands that write figures."""
_SOLVING = ("solve", "table", "run", "report", "stability", "orbit", "control", "study", "explore")
"""Commands that take film points from each other."""


def as_typed(path: Path) -> str:
    """Return a path as it is typed after a command: in quotes where it holds spaces."""
    return subprocess.list2cmdline([str(path)]) if os.name == "nt" else shlex.quote(str(path))


@dataclass
class Output:
    """One command's way to talk.

    json : One JSON document on stdout and nothing else there.
    quiet : Neither progress nor tables; errors still show.
    kept : What an interruption would leave behind, for the farewell.
    """

    json: bool = False
    quiet: bool = False
    kept: list[str] = field(default_factory=list)

    def show(self, *parts: RenderableType) -> None:
        """Show results for people on stdout."""
        if not (self.json or self.quiet):
            with _on_stdout():
                for part in parts:
                    self._print_whole(part)
                    self.people.print()

    def _print_whole(self, part: RenderableType) -> None:
        """Print a part; where the terminal is too narrow it breaks lines, and no number is cut."""
        from rich.measure import Measurement
        from rich.table import Table

        console, width = self.people, self.people.width
        wide = console.options.update(max_width=_TABLE_WIDTH)
        for column in part.columns if isinstance(part, Table) else ():
            if column.no_wrap and column.overflow == "ellipsis":
                cells = [column.header, *column.cells]
                column.min_width = max(Measurement.get(console, wide, one).maximum for one in cells)
        console.width = max(width, Measurement.get(console, wide, part).minimum)
        console.print(part)
        console.width = width

    def results(
        self, document: dict[str, Any], parts: Callable[[], Iterable[RenderableType]]
    ) -> None:
        """Print the document, or for people `parts()` and the files that the document names."""
        self.document(document)
        if not (self.json or self.quiet):
            self.show(*parts(), *map(str, document.get("files", ())))

    def document(self, value: Any) -> None:
        """Print results for programs: the one JSON document."""
        if self.json:
            from ..bearing.operating_point import strict_json

            with _on_stdout():
                print(strict_json(value))

    def note(self, text: str) -> None:
        """Print what goes on, on stderr."""
        if not self.quiet:
            self.errors.print(text)

    def warn(self, text: str) -> None:
        """Print what the user should know, on stderr, quiet or not."""
        self.errors.print(f"warning: {text}", style="yellow")

    def complain(self, text: str) -> None:
        """Print what is wrong, on stderr."""
        self.errors.print(f"error: {text}", style="bold red")

    @functools.cached_property
    def people(self) -> Console:
        """Console on stdout."""
        from rich.console import Console

        console = Console()
        # Piped output has no width of its own; a table cut at 80 would lose columns.
        width = min(console.width, _TABLE_WIDTH) if console.is_terminal else _TABLE_WIDTH
        return Console(width=width, highlight=False, markup=False)

    @functools.cached_property
    def errors(self) -> Console:
        """Console on stderr."""
        from rich.console import Console

        return Console(stderr=True, soft_wrap=True, highlight=False, markup=False)


@contextmanager
def _on_stdout() -> Iterator[None]:
    """Name standard output in what goes wrong with it, and throw away what is still to come."""
    try:
        yield
        sys.stdout.flush()
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise type(error)(error.errno, error.strerror, "standard output") from None


def guarded(command: Callable[..., int]) -> Callable[..., None]:
    """Make a command that returns its exit code safe to call: no traceback for what can go wrong.

    The command's first parameter is the `Output`; it is made from the options ``--json`` and
    ``--quiet`` that `command` need not declare; ``--units`` sets what results are shown in,
    ``--format``, ``--width`` and ``--font`` how figures are written, where the command draws some,
    and ``--fresh`` that no finished points are taken from earlier commands.
    """
    import inspect

    from .options import (
        FontOption,
        FormatOption,
        FreshOption,
        JsonOption,
        QuietOption,
        UnitsOption,
        WidthOption,
        ask_figure_files,
    )

    draws, solves = command.__name__ in _DRAWING, command.__name__ in _SOLVING

    @functools.wraps(command)
    def run(*, json_output: bool, quiet: bool, units: str | None, **options: Any) -> None:
        output = Output(json=json_output, quiet=quiet)
        try:
            show_units(units or _usual_units())
            if draws:
                ask_figure_files(*(options.pop(name) for name in ("formats", "width", "font")))
            with _reusing(output, options.pop("fresh")) if solves else nullcontext():
                code = command(output, **options)
        except Exception as error:
            if stop := interruption(error):
                code = _interrupted(stop, output)
            else:
                code = _explain(_naming_machine(error, options), output)
        except KeyboardInterrupt as stop:
            code = _interrupted(stop, output)
        raise typer.Exit(code)

    signature = inspect.signature(command, eval_str=True)
    keyword = inspect.Parameter.KEYWORD_ONLY
    own = [entry.replace(kind=keyword) for entry in list(signature.parameters.values())[1:]]
    common = [
        *(
            inspect.Parameter(name, keyword, default=None, annotation=annotation)
            for name, annotation in (
                ("formats", FormatOption),
                ("width", WidthOption),
                ("font", FontOption),
            )
            if draws
        ),
        *([inspect.Parameter("fresh", keyword, default=False, annotation=FreshOption)] * solves),
        inspect.Parameter("json_output", keyword, default=False, annotation=JsonOption),
        inspect.Parameter("quiet", keyword, default=False, annotation=QuietOption),
        inspect.Parameter("units", keyword, default=None, annotation=UnitsOption),
    ]
    del run.__wrapped__  # type: ignore[attr-defined]
    run.__signature__ = signature.replace(parameters=own + common)  # type: ignore[attr-defined]
    run.__annotations__ = {entry.name: entry.annotation for entry in own + common}
    return run


@contextmanager
def _reusing(output: Output, fresh: bool) -> Iterator[None]:
    """Take finished film points from earlier commands, unless `fresh`, and say how many were."""
    from ..study.finished import FRESH, asked, store_path

    before = os.environ.get(FRESH)
    if fresh:
        os.environ[FRESH] = "1"  # for worker processes too
    asked.clear()
    try:
        yield
    finally:
        if fresh:
            os.environ.pop(FRESH)
            os.environ.update({} if before is None else {FRESH: before})
    if asked["found"]:
        output.note(
            f"{asked['found']} of {asked['wanted']} film points reused from {store_path()} "
            "(--fresh solves them again)"
        )


def _usual_units() -> str:
    """Return the units of the user's configuration; SI where there is none.

    Raises InputError: The file is no TOML, or names something else.
    """
    import tomllib
    from pathlib import Path

    folder = os.environ.get("XDG_CONFIG_HOME") or os.path.expanduser("~/.config")
    path = Path(folder) / "rotorsim" / "config.toml"
    try:
        text = path.read_text(encoding="utf-8")
    except OSError:
        return "si"
    try:
        settings = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"is no TOML: {error}", source=str(path)) from None
    units = settings.pop("units", "si")
    if settings:
        raise InputError(
            "is unknown; the file may set units", source=str(path), key=next(iter(settings))
        )
    if units not in ("si", "us"):
        raise InputError('must be "si" or "us"', source=str(path), key="units", value=units)
    return units


def _naming_machine(error: Exception, options: dict[str, Any]) -> Exception:
    """Return the error with the machine file of the command, where a key is all it names."""
    from pathlib import Path

    if not isinstance(error, InputError) or error.source or str(error.key or "-").startswith("-"):
        return error
    from ..files.machine import is_machine

    path = next(
        (one for one in options.values() if isinstance(one, Path) and is_machine(one)), None
    )
    if path is None:
        return error
    return InputError(error.message, source=path, key=error.key, value=error.value)


def _interrupted(stop: KeyboardInterrupt, output: Output) -> int:
    kept = "; ".join(output.kept) or "nothing was changed"
    output.errors.print(f"interrupted: {kept}")
    return getattr(stop, "exit_code", _INTERRUPTED)


def _explain(error: Exception, output: Output) -> int:
    if isinstance(error, typer.Exit):
        raise error
    if isinstance(error, BrokenPipeError):
        return DONE  # the reader of a pipe left (``| head``): nobody listens, and that is no error
    if os.environ.get("ROTORSIM_DEBUG"):
        raise error
    details: dict[str, Any] = {"message": str(error)}
    if isinstance(error, RotorsimError):
        code, text = WRONG_INPUT, str(error)
        if isinstance(error, InputError):
            details |= {"source": error.source, "key": error.key, "value": error.value}
    elif isinstance(error, OSError):
        code, text = WRONG_INPUT, f"{error.filename or 'file'}: {error.strerror or error}"
    else:
        code = INCOMPLETE
        text = (
            f"unexpected {type(error).__name__}: {error}\n"
            "This is a fault of the program. Please report it with the scenario and what "
            "ROTORSIM_DEBUG=1 in the environment prints."
        )
    for part in output.kept:
        output.note(f"kept: {part}")
    output.complain(text)
    output.document({"error": details})
    return code


_QUIET_SECONDS = 10.0
"""Between two lines where no bar can be drawn (a log file, a pipe)."""


@contextmanager
def film_progress(output: Output, total: int, label: str = "film points") -> Iterator[Any]:
    """Give the callback for a sweep of `total` points, or samples; None where nothing is said."""
    if output.quiet:
        yield None
    elif output.errors.is_terminal:
        from rich.progress import MofNCompleteColumn

        from ..bearing.description import point_title

        with _bar(output, label, total, MofNCompleteColumn()) as update:

            def report(done: int, total: int, point: OperatingPoint | None = None) -> None:
                last = "" if point is None else point_title(point)
                update(completed=done, total=total, last=last)

            yield report
            update(last="")
    else:
        yield _Lines(output, label)


@contextmanager
def progress_bar(output: Output, label: str, total: float) -> Iterator[Callable[[float], None]]:
    """Give the callback for how much of `total` is done; a bar, on a terminal only."""
    if output.quiet or not output.errors.is_terminal:
        yield lambda _done: None
        return
    from rich.progress import TaskProgressColumn

    with _bar(output, label, total, TaskProgressColumn()) as update:
        yield lambda done: update(completed=done)


@contextmanager
def _bar(output: Output, label: str, total: float, count: Any) -> Iterator[Callable[..., None]]:
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}"), BarColumn(), count,
        TimeRemainingColumn(elapsed_when_finished=True),
        TextColumn("{task.fields[last]}", style="dim"),
    )  # fmt: skip
    with Progress(*columns, console=output.errors) as bar:
        yield functools.partial(bar.update, bar.add_task(label, total=total, last=""))


@contextmanager
def late_progress(output: Output, label: str) -> Iterator[Callable[[int, int], None]]:
    """Give the callback for parts done and parts in all; nothing is shown before it is called."""
    with ExitStack() as stack:
        shown: list[Callable[[float], None]] = []

        def report(done: int, total: int) -> None:
            if not shown:
                if not output.errors.is_terminal:
                    output.note(label)
                shown.append(stack.enter_context(progress_bar(output, label, total)))
            shown[0](done)

        yield report


class _Lines:
    def __init__(self, output: Output, label: str) -> None:
        self.output, self.label = output, label
        self.start = self.last = time.monotonic()

    def __call__(self, done: int, total: int, _point: OperatingPoint | None = None) -> None:
        now = time.monotonic()
        if now - self.last < _QUIET_SECONDS and done < total:
            return
        self.last = now
        spent = now - self.start
        # The first points wait for the workers and for compilation: no measure of the rest.
        known = 10 * done >= total and done < total
        left = f", about {spent / done * (total - done):.0f} s left" if known else ""
        self.output.note(f"{self.label} {done}/{total} after {spent:.0f} s{left}")
