"""Orbits shown while they are integrated."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from .recordings import orbit_tracks

if TYPE_CHECKING:
    from ..orbit import Orbit


@contextmanager
def live_view(title: str) -> Iterator[Callable[[Orbit], None]]:
    """Give the function that shows one piece of an orbit in a viewer."""
    from ..recording.live import LiveView

    with LiveView(title) as view:

        def show(piece: Orbit) -> None:
            if piece.t.size > 1:
                view.show(orbit_tracks([piece])[0])

        yield show
