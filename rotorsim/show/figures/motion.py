"""Orbits in the clearance circle, spectrum cascade, frequency response."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import NDArray

from ...text import caption
from .style import (
    MICRO,
    RPM,
    axes_or_new,
    figure_of,
    model_label,
    model_style,
    new_axes,
    series_style,
)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class OrbitPicture:
    """Journal centre over one run.

    Attributes
    ----------
    name, title : str
        Thermal model; words above the picture.
    x, y : (n,) arrays
        From the bearing's centre [m].
    radial_clearance : float
        [m]
    equilibrium : (2,) array, optional
        [m]
    steady_from : int, optional
        First sample of the steady part, drawn strong over the faint transient.
    boundary : (m, 2) array, optional
        Closed line on which journal and bush touch [m]. Default: the clearance circle.
    once_per_turn : (k, 2) array, optional
        Positions at whole turns of the shaft in the steady part (Poincare points) [m].
    """

    name: str
    title: str
    x: Array
    y: Array
    radial_clearance: float
    equilibrium: Array | None = None
    steady_from: int | None = None
    boundary: Array | None = None
    once_per_turn: Array | None = None


def orbit_plot(
    orbits: Sequence[OrbitPicture], title: str = "", steady_only: bool = False
) -> Figure:
    """Draw runs side by side, each in its clearance circle, and its close-up below.

    Parameters
    ----------
    steady_only : bool
        Leave out what comes before `steady_from`.
    """
    count = len(orbits)
    figure, axes = new_axes(2, count, (3.4 * count + 0.6, 7.0), title)
    for column, orbit in enumerate(orbits):
        _whole(axes[0, column], orbit, steady_only)
        _close_up(axes[1, column], orbit, steady_only)
    for ax in axes.flat:
        ax.set_xlabel("x (along the load) [µm]")
    for ax in axes[:, 0]:
        ax.set_ylabel("y [µm]")
    return figure


def spectrum_cascade(
    speed: Array,
    frequency: Array,
    amplitude: Array,
    title: str = "",
    ax: Axes | None = None,
    most: int = 40,
) -> Figure:
    """Spectra stacked by speed.

    Parameters
    ----------
    speed : (n,) array
        Ascending [rad/s].
    frequency : (m,) or (n, m) array
        [rad/s]
    amplitude : (n, m) array
        [m]
    most : int
        At most about this many spectra are drawn.
    """
    ax = axes_or_new(ax, (6.4, 5.2))
    rows = np.arange(0, speed.size, max(1, -(-speed.size // most)))
    hertz = np.broadcast_to(frequency, amplitude.shape) / (2.0 * np.pi)
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
    reach = f"highest peak {largest * MICRO:.3g} µm"
    ax.set(xlabel="frequency [Hz]", ylabel="shaft speed [rpm]", title=caption(title) or reach)
    ax.grid(visible=False)
    return figure_of(ax)


def bode_plot(
    frequency: Array,
    responses: Sequence[tuple[str, NDArray[np.complex128]]],
    quantity: str = "receptance [m/N]",
    title: str = "",
) -> Figure:
    """Magnitude and phase against frequency.

    Parameters
    ----------
    frequency : (n,) array
        [rad/s]
    responses : sequence of (name, (n,) complex array)
    quantity : str
        What the magnitude is, with its unit.
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


def _whole(ax: Axes, orbit: OrbitPicture, steady_only: bool) -> None:
    clearance = orbit.radial_clearance * MICRO
    reach = 1.1 * draw_contact(ax, orbit.boundary, orbit.radial_clearance)
    _draw(ax, orbit, steady_only)
    ax.set_aspect("equal", adjustable="box")
    ax.set_xlim(-reach, reach)
    ax.set_ylim(-reach, reach)
    ax.set_title(f"{caption(orbit.title)}\nclearance c = {clearance:.4g} µm")


def draw_contact(ax: Axes, boundary: Array | None, radial_clearance: float) -> float:
    """Draw the line on which journal and bush touch; give how far it reaches [um]."""
    if boundary is None:
        clearance = radial_clearance * MICRO
        ax.add_patch(Circle((0.0, 0.0), clearance, fill=False, linewidth=1.2, color="k"))
        return clearance
    ax.plot(*(boundary.T * MICRO), color="k", linewidth=1.2)
    return float(np.hypot(*boundary.T).max()) * MICRO


def _close_up(ax: Axes, orbit: OrbitPicture, steady_only: bool) -> None:
    _draw(ax, orbit, steady_only)
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_title("close-up")
    ax.locator_params(nbins=5)


def _draw(ax: Axes, orbit: OrbitPicture, steady_only: bool) -> None:
    colour = model_style(orbit.name)["color"]
    x, y = orbit.x * MICRO, orbit.y * MICRO
    start = 0 if orbit.steady_from is None else orbit.steady_from
    if start and not steady_only:
        ax.plot(x[: start + 1], y[: start + 1], color="0.7", linewidth=0.6)
    ax.plot(x[start:], y[start:], color=colour, linewidth=0.9)
    if orbit.once_per_turn is not None:
        ax.plot(*(orbit.once_per_turn.T * MICRO), ".", color="#D55E00", ms=2)
    first = start if steady_only else 0
    ax.plot(x[first], y[first], "o", color="k", mfc="w", ms=4)
    ax.plot(x[-1], y[-1], "o", color="k", ms=4)
    if orbit.equilibrium is not None:
        ax.plot(*(np.asarray(orbit.equilibrium) * MICRO), "+", color="k", ms=8)
