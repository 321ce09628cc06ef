"""Figures of a machine's modes: over speed, in space, critical speeds, growth, decrement."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ...machine.branches import Modes
from ...machine.critical_map import CriticalSpeedMap
from ...machine.destabilising import DecrementCurve
from ...machine.thresholds import CRITICAL_DAMPING, CriticalSpeed, ThresholdSpeed
from ...rotor import Rotor
from ...rows import RPM, axis_title, in_shown_unit, quantity, with_unit
from ...text import caption
from .style import (
    SETTINGS,
    axes_or_new,
    figure_of,
    mark_range,
    model_label,
    model_style,
    new_figure,
    series_style,
)

Array = NDArray[np.float64]
_WHIRLS = {
    "forward": {"color": "#0072B2", "linestyle": "-"},
    "backward": {"color": "#D55E00", "linestyle": (0, (5, 2))},
    "mixed": {"color": "#009E73", "linestyle": "-."},
}
_SHOWN = 2.0
"""Frequencies up to this multiple of the highest speed are drawn."""
_LENGTH = quantity("length", "m")


def machine_campbell(
    found: Modes,
    critical: Sequence[CriticalSpeed] = (),
    continuous: tuple[float, float] | None = None,
    title: str = "",
    ax: Axes | None = None,
) -> Figure:
    """Return the damped frequencies over speed by sense of whirl, with the synchronous line.

    Modes with a damping ratio above 0.707 are left out; where a mode grows it is drawn thick.
    """
    ax = axes_or_new(ax, (6.4, 4.6))
    branches = found.oscillating()
    speed = branches.parameter * RPM
    limit = _SHOWN * speed[-1]
    whirl, seen, grows = branches.whirl, set(), False
    for k in range(branches.eigenvalues.shape[1]):
        frequency = branches.damped_frequency[:, k] * RPM
        drawn = (branches.damping_ratio[:, k] < CRITICAL_DAMPING) & (frequency > 0.0)
        if not (drawn & (frequency < limit)).any():
            continue
        for word, look in _WHIRLS.items():
            here = drawn & (whirl[:, k] == word)
            # To the next point as well, so that a change of the sense leaves no gap.
            here[1:] |= (drawn & (whirl[:, k] == word))[:-1] & drawn[1:]
            if not here.any():
                continue
            label = None if word in seen else word
            seen.add(word)
            single = here.sum() == 1
            ax.plot(
                speed, np.where(here, frequency, np.nan), label=label, marker="." if single else "",
                **look,  # type: ignore[arg-type]
            )  # fmt: skip
        unstable = (branches.growth_rate[:, k] > 0.0) & ~branches.undamped[:, k]
        grows = grows or bool(unstable.any())
        ax.plot(speed, np.where(unstable, frequency, np.nan), color="0.4", lw=5.0, alpha=0.45)
    ends = np.array([0.0, speed[-1]])
    ax.plot(ends, ends, color="0.35", linewidth=0.8)
    ax.annotate("1x", (ends[1], ends[1]), xytext=(3, -3), textcoords="offset points", fontsize=8)
    for number, one in enumerate(critical):
        label = "critical speed" if number == 0 else None
        place = one.speed * RPM
        ax.plot(place, place, "o", color="k", mfc="w", ms=5.5, ls="", label=label, zorder=6)
    if grows:
        ax.plot([], [], color="0.4", lw=5.0, alpha=0.45, label="grows (unstable)")
    mark_range(ax, continuous)
    ax.set(
        xlabel="shaft speed [rpm]", ylabel="damped frequency [cycles per minute]",
        title=caption(title),
    )  # fmt: skip
    ax.set_ylim(0.0, limit)
    ax.legend(loc="upper left")
    return figure_of(ax)


def mode_shapes(
    rotor: Rotor, found: Modes, speed: float, count: int = 6, title: str = ""
) -> Figure:
    """Return lowest modes in space at the speed nearest to `speed` [rad/s]: orbits and centre line.

    Modes with a damping ratio above 0.707 are left out.
    """
    branches = found.oscillating()
    i = int(np.abs(branches.parameter - speed).argmin())
    order = np.argsort(branches.undamped_frequency[i])
    order = [int(k) for k in order if branches.damping_ratio[i, k] < CRITICAL_DAMPING][:count]
    columns = min(3, max(1, len(order)))
    rows = max(1, -(-len(order) // columns))
    heading = f"{title}\n{branches.parameter[i] * RPM:.0f} rpm".strip()
    with mpl.rc_context(SETTINGS):
        figure = new_figure(3.4 * columns, 2.9 * rows, heading)
        for number, k in enumerate(order, start=1):
            ax: Any = figure.add_subplot(rows, columns, number, projection="3d")
            mode_shape(rotor, branches, i, k, ax=ax)
    return figure


def mode_shape(
    rotor: Rotor, found: Modes, index: int, branch: int, title: str = "", ax: Any = None
) -> Figure:
    """Return one mode in space: the orbits of the nodes and the centre line at one instant.

    rotor : With positions of its nodes.
    index, branch : Of the speed and of the mode in `found`.
    """
    if ax is None:
        with mpl.rc_context(SETTINGS):
            ax = new_figure(4.4, 3.6).add_subplot(projection="3d")
    shape = found.shapes[index, branch]
    z = np.array([node.position for node in rotor.nodes]) * _LENGTH.factor
    motion = np.array([shape[[x, y]] for x, y in rotor.planes])
    largest = motion[np.abs(motion).max(axis=1).argmax()]
    # Turned to the instant of the largest deflection.
    motion = motion * np.exp(-0.5j * np.angle(np.sum(largest**2)))
    motion = motion / np.abs(motion).max()
    turn = np.exp(
        1j * np.linspace(0.0, 2.0 * np.pi, 49) * np.sign(found.eigenvalues[index, branch].imag)
    )
    whirl = str(found.whirl[index, branch])
    color = _WHIRLS.get(whirl, {"color": "0.3"})["color"]
    for place, (x, y) in zip(z, motion, strict=True):
        ax.plot(np.full(turn.size, place), (y * turn).real, (-x * turn).real, color=color, lw=0.6)
    ax.plot(z, motion[:, 1].real, -motion[:, 0].real, color="k", lw=1.6)
    ax.plot(z, 0.0 * z, 0.0 * z, color="0.5", lw=0.6, ls=(0, (8, 2, 2, 2)))
    frequency = found.damped_frequency[index, branch] * RPM
    decrement = found.logarithmic_decrement[index, branch]
    text = f"{frequency:.0f} cpm, {whirl}, decrement {decrement:.3f}"
    ax.set_title(caption(title) or text, fontsize=8.5)
    ax.set_box_aspect((2.6, 1.0, 1.0), zoom=1.1)
    ax.set(xlim=(z.min(), z.max()), ylim=(-1, 1), zlim=(-1, 1))
    ax.set_yticks([])
    ax.set_zticks([])
    ax.tick_params(labelsize=7)
    ax.set_xlabel(axis_title("from the left end", "mm"), fontsize=7.5)
    return figure_of(ax)


def critical_speed_chart(
    chart: CriticalSpeedMap,
    principal: Mapping[str, Array] | None = None,
    speeds: Array | None = None,
    continuous: tuple[float, float] | None = None,
    title: str = "",
    ax: Axes | None = None,
) -> Figure:
    """Return the undamped critical speeds over support stiffness, with the bearings' own stiffness.

    principal : mapping of str to (n, 2) array. Principal stiffnesses of each support over `speeds`
        [N/m].
    speeds : (n,) array [rad/s]
    """
    ax = axes_or_new(ax, (6.4, 4.8))
    for k in range(chart.speed.shape[1]):
        label = "critical speeds on rising stiffness" if k == 0 else None
        stiffness = in_shown_unit(chart.stiffness, "N/m")
        ax.plot(stiffness, chart.speed[:, k] * RPM, color="k", label=label)
    if principal is not None and speeds is not None:
        for number, (name, values) in enumerate(principal.items()):
            look = dict(series_style("", number + 1), linewidth=1.2)
            for axis in (0, 1):
                positive = in_shown_unit(
                    np.where(values[:, axis] > 0.0, values[:, axis], np.nan), "N/m"
                )
                label = caption(name) if axis == 0 else None
                ax.plot(positive, speeds * RPM, label=label, **look)
    if continuous is not None:
        low, high = (one * RPM for one in continuous)
        ax.axhspan(low, high, color="#009E73", alpha=0.10, zorder=0, label="continuous speeds")
    ax.set(
        xscale="log", yscale="log", xlabel=axis_title("support stiffness", "N/m"),
        ylabel="critical speed [rpm]", title=caption(title),
    )  # fmt: skip
    ax.set_xlim(*in_shown_unit(chart.stiffness[[0, -1]], "N/m"))
    ax.legend(loc="best")
    return figure_of(ax)


def growth_over_speed(
    found: Mapping[str, Modes],
    thresholds: Mapping[str, Sequence[ThresholdSpeed]] | None = None,
    title: str = "",
    ax: Axes | None = None,
) -> Figure:
    """Return growth rates of the oscillating modes over speed, one colour for each thermal model.

    Modes of frequencies up to twice the highest speed; the least stable one is drawn thick.
    """
    ax = axes_or_new(ax, (6.4, 4.2))
    least = []
    for name, every in found.items():
        look = dict(model_style(name) if len(found) > 1 else _WHIRLS["forward"])
        branches = every.oscillating()
        speed = branches.parameter * RPM
        near = branches.damped_frequency.min(axis=0) < _SHOWN * branches.parameter[-1]
        rates = np.where(branches.damping_ratio < CRITICAL_DAMPING, branches.growth_rate, np.nan)[
            :, near
        ]
        for rate in rates.T:
            ax.plot(speed, rate, **{**look, "linewidth": 0.7}, alpha=0.6)
        if not rates.size:
            continue
        top = np.where(np.isfinite(rates), rates, -np.inf).max(axis=1)
        top = np.where(np.isfinite(top), top, np.nan)
        least.append(top)
        label = "least stable mode" if len(found) == 1 else model_label(name)
        first = list((thresholds or {}).get(name, ()))
        if first:
            label += f": threshold {first[0].speed * RPM:.0f} rpm"
        ax.plot(speed, top, **{**look, "linewidth": 2.2}, label=label)
        for one in first:
            ax.plot(one.speed * RPM, 0.0, "x", color="#8c1d2f", ms=8, mew=2, zorder=6)
    values = np.concatenate(least) if least else np.zeros(1)
    reach = max(float(np.nanmax(np.abs(values), initial=0.0)), 1e-3)
    ax.set_ylim(-1.6 * reach, max(0.25 * reach, 1.3 * float(np.nanmax(values, initial=0.0))))
    ax.axhspan(0.0, 10.0 * reach, color="#f2d7d9", zorder=0)
    ax.axhline(0.0, color="#8c1d2f", linewidth=1.0)
    ax.set(xlabel="shaft speed [rpm]", ylabel="growth rate [1/s]", title=caption(title))
    ax.legend(loc="lower left")
    return figure_of(ax)


def decrement_over_stiffness(
    curves: Sequence[DecrementCurve], title: str = "", ax: Axes | None = None
) -> Figure:
    """Draw logarithmic decrement over destabilising stiffness, Q_A, Q0, limit of level I."""
    ax = axes_or_new(ax, (6.2, 3.8))
    for number, one in enumerate(curves):
        look = series_style("", number)
        label = f"{one.speed * RPM:.0f} rpm"
        if one.threshold is not None:
            label += f", Q0 {with_unit(one.threshold * 1e-6, 'MN/m')}"
        ax.plot(in_shown_unit(one.stiffness * 1e-6, "MN/m"), one.decrement, label=label, **look)
        at = in_shown_unit(one.anticipated * 1e-6, "MN/m")
        ax.plot(at, one.anticipated_decrement, "o", color=look["color"], mfc="w", zorder=5)
        ax.annotate("Q_A", (at, one.anticipated_decrement), xytext=(6, 6), fontsize=8,
                    textcoords="offset points")  # fmt: skip
    ax.axhline(0.1, color="#009E73", lw=1.0, ls="--", label="limit at Q_A: 0.1")
    ax.axhline(0.0, color="#8c1d2f", lw=1.0)
    ax.set(
        xlabel=axis_title("destabilising stiffness", "MN/m"), ylabel="logarithmic decrement [-]",
        title=caption(title),
    )  # fmt: skip
    ax.legend(loc="best")
    return figure_of(ax)
