"""Orbits as moving pictures for slides: GIF everywhere, MP4 where ffmpeg is installed."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch
from numpy.typing import NDArray

from ...atomic import replacing
from ...errors import InputError
from ...orbit import Orbit
from ...orbit.description import run_names, run_title
from ...rows import RPM
from ...text import caption
from .orbits import draw_contact
from .style import MICRO, SETTINGS, model_style, new_axes

_FRAMES_PER_SECOND = 12
_RUN_FRAMES = 50
"""Of the first act, the whole run."""
_SLOW_FRAMES, _SLOW_FRAMES_PER_REVOLUTION = 72, 16
"""Of the second act, the last turns in slow motion."""
_TRAIL_REVOLUTIONS = 3.0
_FORCE_LENGTH = 0.45
"""Arrow of the median film force, in clearances; longer ones stop at twice that."""
_PATH_POINTS = 4000


def animate_orbits(
    orbits: Sequence[Orbit], path: str | Path, title: str = "", slow_only: bool = False
) -> Path:
    """Write runs side by side as ``.gif`` or ``.mp4``.

    First the whole run in a few seconds, each picture with the turns since the one before; then
    the last turns in slow motion, so that the whirl itself is seen and not its stroboscopic image.

    path : str or Path. Its suffix decides the format.
    slow_only : Leave the first act out.
    Raises InputError: Another suffix, or ``.mp4`` without ffmpeg.
    """
    target = Path(path)
    writer = _writer(target)
    figure, axes = new_axes(
        2, len(orbits), (4.4 * len(orbits) + 0.4, 6.4), title, height_ratios=(3, 1)
    )
    with mpl.rc_context(SETTINGS):
        named = zip(orbits, run_names(orbits), strict=True)
        scenes = [
            _Scene(axes[0, k], axes[1, k], orbit, name) for k, (orbit, name) in enumerate(named)
        ]
        # Laid out once: doing it anew for every picture takes most of the time.
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
        counts = {scene.frames(slow_only).size for scene in scenes}
        with replacing(target) as temporary, writer.saving(figure, str(temporary), dpi=80):
            for frame in range(max(counts)):
                for scene in scenes:
                    scene.show(frame, slow_only)
                writer.grab_frame()
    return target


def can_write_mp4() -> bool:
    """Whether ffmpeg is there."""
    return shutil.which("ffmpeg") is not None


def _writer(target: Path) -> AbstractMovieWriter:
    if target.suffix == ".gif":
        return PillowWriter(fps=_FRAMES_PER_SECOND)
    if target.suffix != ".mp4":
        raise InputError("must end in .gif or .mp4", key="animation", value=str(target))
    if not can_write_mp4():
        raise InputError(
            "needs the program ffmpeg, which is not installed; .gif needs nothing more",
            key="animation",
            value=str(target),
        )
    return FFMpegWriter(fps=_FRAMES_PER_SECOND)


class _Scene:
    """One run's pictures: the clearance circle above, displacement over turns below."""

    def __init__(self, above: Axes, below: Axes, orbit: Orbit, name: str) -> None:
        self.orbit, self.title = orbit, run_title(name)
        self.x, self.y = orbit.x * MICRO, orbit.y * MICRO
        self.colour = model_style(orbit.thermal_model)["color"]
        force = np.column_stack([orbit.fx, orbit.fy])
        size = np.hypot(*force.T)
        middle = max(float(np.median(size)), 1e-30)
        limit = np.minimum(1.0, 2.0 * middle / np.maximum(size, 1e-30))
        scale = _FORCE_LENGTH * orbit.radial_clearance * MICRO / middle
        self.arrows = force * (limit * scale)[:, None]
        self._above(above)
        self._below(below)

    def frames(self, slow_only: bool) -> NDArray[np.intp]:
        """Sample shown in each frame."""
        count = self.orbit.t.size
        turns = _SLOW_FRAMES / _SLOW_FRAMES_PER_REVOLUTION
        first = max(float(self.orbit.revolutions[-1]) - turns, float(self.orbit.revolutions[0]))
        wanted = np.linspace(first, float(self.orbit.revolutions[-1]), _SLOW_FRAMES)
        slow = np.clip(np.searchsorted(self.orbit.revolutions, wanted), 0, count - 1)
        if slow_only:
            return slow
        whole = np.linspace(0, count - 1, _RUN_FRAMES).round().astype(np.intp)
        return np.concatenate([whole, slow])

    def show(self, frame: int, slow_only: bool) -> None:
        """Move everything to one frame."""
        frames = self.frames(slow_only)
        at = int(frames[min(frame, frames.size - 1)])
        act_one = not slow_only and frame < _RUN_FRAMES
        turns = self.orbit.revolutions
        since = turns[at] - _TRAIL_REVOLUTIONS
        if act_one and frame:
            since = min(since, turns[frames[frame - 1]])
        start = int(np.searchsorted(turns, since))
        before = np.arange(0, start + 1, max(1, start // _PATH_POINTS + 1))
        self.past.set_data(self.x[before], self.y[before])
        trail = slice(start, at + 1)
        self.trail.set_data(self.x[trail], self.y[trail])
        self.journal.set_data([self.x[at]], [self.y[at]])
        self.force.set_positions(
            (self.x[at], self.y[at]),
            (self.x[at] + self.arrows[at, 0], self.y[at] + self.arrows[at, 1]),
        )
        self.cursor.set_xdata([turns[at], turns[at]])
        if frame == (0 if slow_only else _RUN_FRAMES):
            self.below.set_xlim(float(turns[frames[-_SLOW_FRAMES]]), float(turns[-1]))
        pace = "" if act_one else ", slow motion"
        self.words.set_text(
            f"turn {turns[at]:.1f}, {self.orbit.t[at]:.3f} s, "
            f"{self.orbit.speed[at] * RPM:.0f} rpm{pace}"
        )

    def _above(self, ax: Axes) -> None:
        clearance = self.orbit.radial_clearance * MICRO
        reach = draw_contact(ax, self.orbit)
        (self.past,) = ax.plot([], [], color="0.8", linewidth=0.6)
        (self.trail,) = ax.plot([], [], color=self.colour, linewidth=1.3)
        ax.plot(*(np.asarray(self.orbit.equilibrium) * MICRO), "+", color="k", ms=8)
        self.force = FancyArrowPatch(
            (0.0, 0.0), (1.0, 0.0), arrowstyle="-|>", mutation_scale=9, color="#009E73", lw=1.2
        )
        ax.add_patch(self.force)
        (self.journal,) = ax.plot([], [], "o", color="k", mfc="w", ms=7)
        ax.set_aspect("equal", adjustable="box")
        ax.set_xlim(-1.12 * reach, 1.12 * reach)
        ax.set_ylim(-1.12 * reach, 1.12 * reach)
        ax.set(xlabel="x (along the load) [µm]", ylabel="y [µm]")
        self.words = ax.set_title("turn")
        ax.text(
            0.02, 0.98, f"{caption(self.title)}\nc = {clearance:.4g} µm",
            transform=ax.transAxes, va="top", fontsize=8,
        )  # fmt: skip
        ax.plot([], [], color="#009E73", label="film force")
        ax.legend(loc="lower right")

    def _below(self, ax: Axes) -> None:
        self.below = ax
        rows = np.arange(0, self.x.size, max(1, self.x.size // (5 * _PATH_POINTS)))
        turns = self.orbit.revolutions
        ax.plot(turns[rows], self.x[rows], color=self.colour, linewidth=0.6, label="x")
        ax.plot(turns[rows], self.y[rows], color="0.55", linewidth=0.6, label="y")
        self.cursor = ax.axvline(turns[0], color="k", linewidth=0.9)
        ax.set(xlabel="turns of the shaft", ylabel="x, y [µm]", xlim=(turns[0], turns[-1]))
        ax.legend(loc="upper left", ncols=2)
