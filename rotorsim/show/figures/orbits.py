"""Orbits in the line of contact, spectrum cascades, frequency responses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ...orbit import Orbit
from ...orbit.analysis import once_per_turn, recognise, steady_spectrum
from ...orbit.description import run_names, run_title
from ...orbit.spectrum import Cascade
from ...rows import QUANTITIES
from ...text import caption
from .style import (
    MICRO,
    MODEL_STYLES,
    RPM,
    axes_or_new,
    figure_of,
    model_label,
    model_style,
    new_axes,
    series_style,
)

Array = NDArray[np.float64]


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
        reach = 1.1 * draw_contact(above, orbit)
        for ax in (above, below):
            _draw(ax, orbit, name, steady_only)
        above.set_aspect("equal", adjustable="box")
        above.set(xlim=(-reach, reach), ylim=(-reach, reach))
        clearance = QUANTITIES["radial_clearance"].said(orbit.radial_clearance)
        above.set_title(f"{caption(run_title(name))}\nclearance {clearance}")
        below.set_aspect("equal", adjustable="datalim")
        below.set_title("close-up")
        below.locator_params(nbins=5)
    for ax in axes.flat:
        ax.set_xlabel("x (along the load) [µm]")
    for ax in axes[:, 0]:
        ax.set_ylabel("y [µm]")
    return figure


def spectrum_cascade(
    cascade: Cascade, title: str = "", ax: Axes | None = None, most: int = 40
) -> Figure:
    """Spectra stacked by speed, at most about `most` of them."""
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
    for times, style in ((1.0, "-"), (0.5, "--")):
        ax.plot(times * ends / 60.0, ends, style, color="#D55E00", lw=0.9, zorder=rows.size + 1)
        ax.annotate(
            f"{times:g}x", (times * ends[1] / 60.0, ends[1]), xytext=(2, 12),
            textcoords="offset points", fontsize=8, color="#8a3c00", zorder=rows.size + 2,
        )  # fmt: skip
    right = hertz[:, -1].max()
    ax.set_xlim(0.0, min(right, 2.0 * rpm[-1] / 60.0))
    words = [caption(title), f"highest peak {largest * MICRO:.3g} µm"]
    ax.set(
        xlabel="frequency [Hz]", ylabel="shaft speed [rpm]", title="\n".join(filter(None, words))
    )
    ax.grid(visible=False)
    return figure_of(ax)


def spectrum_plot(orbits: Sequence[Orbit], title: str = "") -> Figure | None:
    """Spectra of runs at constant speed, the shaft's frequency and half of it marked.

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
            f"{run_title(name)}: {amplitude[peak] * MICRO:.3g} µm at "
            f"{one.frequency[peak] / (2.0 * np.pi):.4g} Hz, {one.frequency[peak] / speed:.3f}x"
        )
        look: dict[str, Any] = series_style(_model(name), number) | {"label": label}
        ax.plot(one.frequency / (2.0 * np.pi), amplitude * MICRO, **look)
    for order in (1.0, 0.5):
        ax.axvline(order * shaft, color="0.4", linewidth=0.8, zorder=0)
        ax.annotate(
            f"{order:g}x", (order * shaft, 1.0), xycoords=("data", "axes fraction"),
            xytext=(3, -10), textcoords="offset points", fontsize=8,
        )  # fmt: skip
    ax.set(xlabel="frequency [Hz]", ylabel="amplitude [µm]", title=caption(title))
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
    """Magnitude and phase against frequency.

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


def draw_contact(ax: Axes, orbit: Orbit) -> float:
    """Draw the line on which journal and bush touch; give how far it reaches [µm]."""
    line = orbit.boundary * MICRO
    ax.plot(*line.T, color="k", linewidth=1.2)
    return float(np.hypot(*line.T).max())


def _draw(ax: Axes, orbit: Orbit, name: str, steady_only: bool) -> None:
    """Trajectory, the steady part strong over the transient, and its points at whole turns."""
    x, y = orbit.x * MICRO, orbit.y * MICRO
    start = (recognise(orbit).steady_from if orbit.constant_speed else None) or 0
    if start and not steady_only:
        ax.plot(x[: start + 1], y[: start + 1], color="0.7", linewidth=0.6)
    ax.plot(x[start:], y[start:], color=model_style(_model(name))["color"], linewidth=0.9)
    points = once_per_turn(orbit)
    if points is not None:
        ax.plot(*(points.T * MICRO), ".", color="#D55E00", ms=2)
    first = start if steady_only else 0
    ax.plot(x[first], y[first], "o", color="k", mfc="w", ms=4)
    ax.plot(x[-1], y[-1], "o", color="k", ms=4)
    ax.plot(*(np.asarray(orbit.equilibrium) * MICRO), "+", color="k", ms=8)


def _model(name: str) -> str:
    """Thermal model of a run, by which it is coloured."""
    return next((model for model in MODEL_STYLES if name.startswith(model)), name)
