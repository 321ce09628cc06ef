"""Progress on stderr: a bar with the remaining time on a terminal, a few lines elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..bearing.operating_point import OperatingPoint
    from ..study.sweep import Progress
    from .output import Output

_QUIET_SECONDS = 10.0
"""Between two lines where no bar can be drawn (a log file, a pipe)."""


@contextmanager
def film_progress(output: Output, total: int) -> Iterator[Progress | None]:
    """Give the callback for a sweep of `total` points."""
    if output.quiet:
        yield None
    elif output.errors.is_terminal:
        with _bar(output, total) as progress:
            yield progress
    else:
        yield _Lines(output)


@contextmanager
def _bar(output: Output, total: int) -> Iterator[Progress]:
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    from ..bearing.description import point_title

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(elapsed_when_finished=True),
        TextColumn("{task.fields[last]}", style="dim"),
    )
    with Bar(*columns, console=output.errors, transient=False) as bar:
        task = bar.add_task("film points", total=total, last="")

        def report(done: int, _total: int, point: OperatingPoint) -> None:
            bar.update(task, completed=done, last=point_title(point))

        yield report
        bar.update(task, last="")


@contextmanager
def progress_bar(output: Output, label: str, total: float) -> Iterator[Callable[[float], None]]:
    """Give the callback for how much of `total` is done; a bar, on a terminal only."""
    if output.quiet or not output.errors.is_terminal:
        yield lambda _done: None
        return
    from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeRemainingColumn(elapsed_when_finished=True),
    )
    with Bar(*columns, console=output.errors) as bar:
        task = bar.add_task(label, total=total)
        yield lambda done: bar.update(task, completed=done)


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
    def __init__(self, output: Output) -> None:
        self.output = output
        self.start = self.last = time.monotonic()

    def __call__(self, done: int, total: int, _point: OperatingPoint) -> None:
        now = time.monotonic()
        if now - self.last < _QUIET_SECONDS and done < total:
            return
        self.last = now
        spent = now - self.start
        # The first points wait for the workers and for compilation: no measure of the rest.
        known = 10 * done >= total and done < total
        left = f", about {spent / done * (total - done):.0f} s left" if known else ""
        self.output.note(f"film points {done}/{total} after {spent:.0f} s{left}")
