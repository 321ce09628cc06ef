"""Orbits in the line of contact, spectrum cascades, frequency responses."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch
from numpy.typing import NDArray

from ...atomic import replacing
from ...errors import InputError
from ...orbit import Orbit
from ...orbit.analysis import once_per_turn, recognise, steady_spectrum
from ...orbit.continuation import Branch
from ...orbit.description import run_names, run_title
from ...orbit.motion import Motion
from ...orbit.spectrum import Cascade
from ...rotor import Rotor
from ...rows import QUANTITIES, axis_title, quantity
from ...text import caption
from .style import (
    MODEL_STYLES,
    RPM,
    SETTINGS,
    axes_or_new,
    figure_of,
    model_label,
    model_style,
    new_axes,
    series_style,
)

Array = NDArray[np.float64]
_SMALL = QUANTITIES["radial_clearance"]
_LENGTH = quantity("length", "m")
_LINES = ("#0072B2", "#009E73", "#CC79A7")


def orbit_plot(
    orbits: Sequence[Orbit],
    title: str = "",
    steady_only: bool = False,
    names: Sequence[str] | None = None,
) -> Figure:
    """Draw runs side by side, each in the line of contact, and its close-up below.

    steady_only : Leave out what comes before the steady part.
    names : Of the runs, in place of `rotorsim.orbit.description.run_names`.
    """
    count, names = len(orbits), run_names(orbits) if names is None else names
    figure, axes = new_axes(2, count, (3.4 * count + 0.6, 7.0), title)
    for column, (orbit, name) in enumerate(zip(orbits, names, strict=True)):
        above, below = axes[:, column]
        reach, middle = 1.1 * _draw_contact(above, orbit), np.array(orbit.centre) * _SMALL.factor
        for ax in (above, below):
            _draw(ax, orbit, name, steady_only)
        above.set_aspect("equal", adjustable="box")
        (left, low), (right, high) = middle - reach, middle + reach
        above.set(xlim=(left, right), ylim=(low, high))
        said = f"clearance {_SMALL.said(orbit.radial_clearance)}"
        if not orbit.has_film:
            said = f"no film; circle of {_SMALL.with_unit(orbit.radial_clearance)}"
        above.set_title(f"{caption(run_title(name))}\n{said}")
        below.set_aspect("equal", adjustable="datalim")
        below.set_title("close-up")
        below.locator_params(nbins=5)
    for ax in axes.flat:
        ax.set_xlabel(axis_title("x (along the load)", "µm"))
    for ax in axes[:, 0]:
        ax.set_ylabel(axis_title("y", "µm"))
    return figure


def orbit_path(orbit: Orbit, title: str = "", ax: Axes | None = None) -> Figure:
    """Draw one run in its line of contact."""
    ax = axes_or_new(ax, (4.2, 4.4))
    reach = 1.1 * _draw_contact(ax, orbit)
    _draw(ax, orbit, run_names([orbit])[0], steady_only=False)
    ax.set_aspect("equal", adjustable="box")
    ax.set(
        xlim=(-reach, reach), ylim=(-reach, reach), title=caption(title),
        xlabel=axis_title("x (along the load)", "µm"), ylabel=axis_title("y", "µm"),
    )  # fmt: skip
    return figure_of(ax)


def spectrum_cascade(
    cascade: Cascade,
    title: str = "",
    ax: Axes | None = None,
    most: int = 40,
    lines: Mapping[str, tuple[Array, Array]] | None = None,
) -> Figure:
    """Return the spectra stacked by speed, at most about `most` of them.

    lines : Names of frequencies to compare with, their shaft speeds and themselves [rad/s].
    """
    order = np.argsort(cascade.speed)
    speed, frequency, amplitude = (
        values[order] for values in (cascade.speed, cascade.frequency, cascade.amplitude)
    )
    ax = axes_or_new(ax, (6.4, 5.2))
    rows = np.arange(0, speed.size, max(1, -(-speed.size // most)))
    hertz = frequency / (2.0 * np.pi)
    rpm = speed * RPM
    spacing = float(np.ptp(rpm)) / max(rows.size - 1, 1)
    largest = float(np.nanmax(amplitude))
    scale = 4.0 * spacing / max(largest, 1e-30)
    for order, row in enumerate(rows[::-1]):
        base, top = rpm[row], rpm[row] + amplitude[row] * scale
        ax.fill_between(hertz[row], base, top, color="white", zorder=order)
        ax.plot(hertz[row], top, color="#0b3c5d", linewidth=0.8, zorder=order)
    ends = np.array([rpm[0], rpm[-1]])
    # the orders go on to above all spectra, where their labels hide nothing
    above = np.array([rpm[0], float(np.nanmax(rpm[rows] + amplitude[rows].max(axis=1) * scale))])
    for times, style in ((1.0, "-"), (0.5, "--")):
        ax.plot(times * above / 60.0, above, style, color="#D55E00", lw=0.9, zorder=rows.size + 1)
        ax.annotate(
            f"{times:g}x", (times * above[1] / 60.0, above[1]), xytext=(0, 2), ha="center",
            textcoords="offset points", fontsize=8, color="#8a3c00", zorder=rows.size + 2,
        )  # fmt: skip
    ax.set_ylim(top=above[1] + 0.06 * float(np.ptp(above)))
    for (name, (at, expected)), colour in zip((lines or {}).items(), _LINES, strict=False):
        inside = (at * RPM >= ends[0]) & (at * RPM <= ends[1])
        ax.plot(
            expected[inside] / (2.0 * np.pi), at[inside] * RPM, ":", color=colour, lw=1.4,
            label=name, zorder=rows.size + 1,
        )  # fmt: skip
    if lines:
        legend = ax.legend(loc="lower right", fontsize=8, framealpha=1.0)
        legend.set_zorder(rows.size + 3)
    right = hertz[:, -1].max()
    ax.set_xlim(0.0, min(right, 2.0 * rpm[-1] / 60.0))
    words = [caption(title), f"highest peak {_SMALL.with_unit(largest, 3)}"]
    ax.set(
        xlabel="frequency [Hz]", ylabel="shaft speed [rpm]", title="\n".join(filter(None, words))
    )
    ax.grid(visible=False)
    return figure_of(ax)


def spectrum_plot(orbits: Sequence[Orbit], title: str = "") -> Figure | None:
    """Return the spectra of runs at constant speed, the shaft's frequency and half of it marked.

    None where no run has one: each comes to rest, passes through the speeds, or is too short.
    """
    found = []
    for orbit, name in zip(orbits, run_names(orbits), strict=True):
        one = steady_spectrum(orbit)
        if one is not None:
            found.append((name, float(orbit.speed[0]), one, one.forward + one.backward))
    if not found:
        return None
    ax = axes_or_new(None, (6.4, 4.4))
    shaft = max(speed for _, speed, _, _ in found) / (2.0 * np.pi)
    for number, (name, speed, one, amplitude) in enumerate(found):
        peak = int(np.argmax(amplitude))
        label = (
            f"{run_title(name)}: {_SMALL.with_unit(amplitude[peak], 3)} at "
            f"{one.frequency[peak] / (2.0 * np.pi):.4g} Hz, {one.frequency[peak] / speed:.3f}x"
        )
        look: dict[str, Any] = series_style(_model(name), number) | {"label": label}
        ax.plot(one.frequency / (2.0 * np.pi), amplitude * _SMALL.factor, **look)
    for order in (1.0, 0.5):
        ax.axvline(order * shaft, color="0.4", linewidth=0.8, zorder=0)
        ax.annotate(
            f"{order:g}x", (order * shaft, 1.0), xycoords=("data", "axes fraction"),
            xytext=(3, -10), textcoords="offset points", fontsize=8,
        )  # fmt: skip
    ax.set(xlabel="frequency [Hz]", ylabel=axis_title("amplitude", "µm"), title=caption(title))
    ax.set_xlim(0.0, 2.5 * shaft)
    ax.set_ylim(bottom=0.0)
    figure = figure_of(ax)
    figure.legend(loc="outside lower center")
    return figure


def bode_plot(
    frequency: Array,
    responses: Sequence[tuple[str, NDArray[np.complex128]]],
    quantity: str = "receptance [m/N]",
    title: str = "",
) -> Figure:
    """Return the magnitude and phase against frequency.

    frequency : (n,) array [rad/s]
    responses : sequence of (name, (n,) complex array)
    quantity : What the magnitude is, with its unit.
    """
    figure, axes = new_axes(2, 1, (6.2, 5.0), title, sharex=True)
    for number, (name, response) in enumerate(responses):
        look = series_style(name, number) | {"label": model_label(name)}
        axes[0, 0].loglog(frequency / (2 * np.pi), np.abs(response), **look)
        phase = np.degrees(np.unwrap(np.angle(response)))
        axes[1, 0].semilogx(frequency / (2 * np.pi), phase, **look)
    axes[0, 0].set_ylabel(quantity)
    axes[1, 0].set_ylabel("phase [deg]")
    axes[1, 0].set_xlabel("frequency [Hz]")
    axes[0, 0].legend()
    return figure


def _draw_contact(ax: Axes, orbit: Orbit) -> float:
    """Draw the line on which journal and bush touch; give how far it reaches [µm]."""
    line = orbit.boundary * _SMALL.factor
    shown = line + np.array(orbit.centre) * _SMALL.factor
    ax.plot(*shown.T, color="k" if orbit.has_film else "0.6", linewidth=1.2)
    return float(np.hypot(*line.T).max())


def _draw(ax: Axes, orbit: Orbit, name: str, steady_only: bool) -> None:
    """Draw the path, its steady part strong, and its points at whole turns."""
    x, y = orbit.x * _SMALL.factor, orbit.y * _SMALL.factor
    start = (recognise(orbit).steady_from if orbit.constant_speed else None) or 0
    if start and not steady_only:
        ax.plot(x[: start + 1], y[: start + 1], color="0.7", linewidth=0.6)
    ax.plot(x[start:], y[start:], color=model_style(_model(name))["color"], linewidth=0.9)
    points = once_per_turn(orbit)
    if points is not None:
        ax.plot(*(points.T * _SMALL.factor), ".", color="#D55E00", ms=2)
    first = start if steady_only else 0
    ax.plot(x[first], y[first], "o", color="k", mfc="w", ms=4)
    ax.plot(x[-1], y[-1], "o", color="k", ms=4)
    ax.plot(*(np.asarray(orbit.equilibrium) * _SMALL.factor), "+", color="k", ms=8)


def _model(name: str) -> str:
    """Return the thermal model of a run, by which it is coloured."""
    return next((model for model in MODEL_STYLES if name.startswith(model)), name)


def branch_plot(branch: Branch, title: str = "", ax: Axes | None = None) -> Figure:
    """Draw amplitude of periodic motions over speed, threshold and folds."""
    ax = axes_or_new(ax, (6.4, 4.4))
    rpm = branch.speed * RPM
    for column, name in enumerate(branch.names):
        amplitude = branch.amplitude[:, column] * _SMALL.factor
        colour = f"C{column}"
        for word, shown, style in (
            ("stable", branch.stable, "-"), ("unstable", ~branch.stable, "--")
        ):  # fmt: skip
            # to the next point as well, so that a change of stability leaves no gap
            line = np.where(shown | np.roll(shown, 1), amplitude, np.nan)
            if shown.any():
                ax.plot(rpm, line, style, color=colour, label=f"{name}, {word}")
    if branch.threshold is not None:
        ax.axvline(branch.threshold * RPM, color="#999999", lw=0.8)
        ax.annotate(
            "threshold", (branch.threshold * RPM, 0.02), xycoords=("data", "axes fraction"),
            rotation=90, fontsize=8, ha="right",
        )  # fmt: skip
    for fold in branch.folds:
        ax.axvline(fold * RPM, color="#D55E00", lw=0.8, ls=":")
    ax.set(xlabel="shaft speed [rpm]", ylabel=axis_title("amplitude", "µm"), title=caption(title))
    ax.set_ylim(bottom=0.0)
    ax.legend(fontsize=8)
    return figure_of(ax)


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


def animate_machine(
    motion: Motion, rotor: Rotor, path: str | Path, title: str = "", slow_only: bool = False
) -> Path:
    """Write a machine's shaft, whirling in space, as ``.gif`` or ``.mp4``.

    Acts as in `animate_orbits`; displacements are magnified to a tenth of the shaft's length.
    """
    target = Path(path)
    writer = _writer(target)
    z = np.array([node.position for node in rotor.nodes]) * _LENGTH.factor
    turns = motion.revolutions
    wanted = np.linspace(
        max(float(turns[-1]) - _SLOW_FRAMES / _SLOW_FRAMES_PER_REVOLUTION, 0.0), float(turns[-1]),
        _SLOW_FRAMES,
    )  # fmt: skip
    frames = np.clip(np.searchsorted(turns, wanted), 0, turns.size - 1)
    if not slow_only:
        whole = np.linspace(0, turns.size - 1, _RUN_FRAMES).round().astype(np.intp)
        frames = np.concatenate([whole, frames])
    system, first = motion.problem.system, rotor.first_unknown

    def shaft(rows: NDArray[np.intp]) -> tuple[Array, Array]:
        x, y = (motion.q[rows] @ system.basis[first + a].T + system.offset[first + a]
                for a in (0, 1))  # fmt: skip
        return np.asarray(x), np.asarray(y)

    x, y = shaft(frames)
    largest = float(np.hypot(x - x.mean(axis=0), y - y.mean(axis=0)).max())
    scale = 0.1 * float(np.ptp(z)) / max(largest, 1e-12)
    figure = Figure(figsize=(8.0, 4.2))
    ax: Any = figure.add_subplot(projection="3d")
    (line,) = ax.plot([], [], [], color="0.35", linewidth=5, solid_capstyle="round")
    nodes = [int(np.argmin(np.abs(z - _LENGTH.factor * s.position))) for s in motion.stations
             if np.isfinite(s.position)]  # fmt: skip
    paths = [ax.plot([], [], [], color="#D55E00", linewidth=1.2)[0] for _ in nodes]
    (marks,) = ax.plot([], [], [], "o", color="#0b3c5d", markersize=5)
    reach = 0.2 * float(np.ptp(z))
    middle_x, middle_y = scale * float(x.mean()), scale * float(y.mean())
    ax.set(
        xlim=(z[0], z[-1]), ylim=(middle_y - reach, middle_y + reach),
        zlim=(-middle_x - reach, -middle_x + reach), xlabel=axis_title("along the shaft", "mm"),
    )  # fmt: skip
    ax.set_box_aspect((2.4, 1.0, 1.0))
    ax.set_yticklabels([])
    ax.set_zticklabels([])
    turn = motion.problem.samples_per_revolution
    with replacing(target) as temporary, writer.saving(figure, str(temporary), dpi=80):
        for k, at in enumerate(frames):
            line.set_data_3d(z, scale * y[k], -scale * x[k])
            marks.set_data_3d(z[nodes], scale * y[k, nodes], -scale * x[k, nodes])
            last_x, last_y = shaft(np.arange(max(at - turn, 0), at + 1))
            for node, one in zip(nodes, paths, strict=True):
                one.set_data_3d(
                    np.full(len(last_x), z[node]), scale * last_y[:, node], -scale * last_x[:, node]
                )
            ax.set_title(
                f"{caption(title)}\n{motion.speed[at] * RPM:.0f} rpm, turn {turns[at]:.1f}, "
                f"displacements {scale / _LENGTH.factor:.3g} times", fontsize=9,
            )  # fmt: skip
            writer.grab_frame()
    return target


def can_write_mp4() -> bool:
    """Return whether ffmpeg is there."""
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
        self.x, self.y = orbit.x * _SMALL.factor, orbit.y * _SMALL.factor
        self.colour = model_style(orbit.thermal_model)["color"]
        force = np.column_stack([orbit.fx, orbit.fy])
        size = np.hypot(*force.T)
        middle = max(float(np.median(size)), 1e-30)
        limit = np.minimum(1.0, 2.0 * middle / np.maximum(size, 1e-30))
        scale = _FORCE_LENGTH * orbit.radial_clearance * _SMALL.factor / middle
        self.arrows = force * (limit * scale)[:, None]
        self._above(above)
        self._below(below)

    def frames(self, slow_only: bool) -> NDArray[np.intp]:
        """Return the sample shown in each frame."""
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
        reach = _draw_contact(ax, self.orbit)
        (self.past,) = ax.plot([], [], color="0.8", linewidth=0.6)
        (self.trail,) = ax.plot([], [], color=self.colour, linewidth=1.3)
        ax.plot(*(np.asarray(self.orbit.equilibrium) * _SMALL.factor), "+", color="k", ms=8)
        self.force = FancyArrowPatch(
            (0.0, 0.0), (1.0, 0.0), arrowstyle="-|>", mutation_scale=9, color="#009E73", lw=1.2
        )
        ax.add_patch(self.force)
        (self.journal,) = ax.plot([], [], "o", color="k", mfc="w", ms=7)
        ax.set_aspect("equal", adjustable="box")
        ax.set_xlim(-1.12 * reach, 1.12 * reach)
        ax.set_ylim(-1.12 * reach, 1.12 * reach)
        ax.set(xlabel=axis_title("x (along the load)", "µm"), ylabel=axis_title("y", "µm"))
        self.words = ax.set_title("turn")
        ax.text(
            0.02, 0.98, f"{caption(self.title)}\n{_SMALL.said(self.orbit.radial_clearance)}",
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
        ax.set(
            xlabel="turns of the shaft", ylabel=axis_title("x, y", "µm"), xlim=(turns[0], turns[-1])
        )
        ax.locator_params(axis="x", nbins=6, prune="upper")
        ax.legend(loc="upper left", ncols=2)
