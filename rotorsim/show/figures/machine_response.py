"""Figures of a machine's response: at probes, with control in time, to hot spots."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from ...machine.output_feedback import LinearMotion
from ...machine.peaks import ProbeResponse
from ...rows import RPM, axis_title, in_shown_unit
from ...study.hot_spot import HotSpotStudy
from ...text import caption
from .style import MICRO, figure_of, mark_range, new_axes, series_style


def bode_at_probes(
    responses: Sequence[ProbeResponse],
    continuous: tuple[float, float] | None = None,
    title: str = "",
    ax: tuple[Axes, Axes] | None = None,
) -> Figure:
    """Return amplitude and phase lag at probes over speed, with the peaks' amplification factors.

    ax : (Axes, Axes). For the amplitude and for the phase.
    """
    upper, lower = new_axes(2, 1, (6.6, 5.4), sharex=True)[1][:, 0] if ax is None else ax
    for number, one in enumerate(responses):
        look = series_style("", number)
        speed = one.speed * RPM
        upper.plot(
            speed, in_shown_unit(one.amplitude * MICRO, "µm"), label=caption(one.name), **look
        )
        lag = np.full(one.phase.shape, np.nan)
        known = np.isfinite(one.phase)
        lag[known] = np.unwrap(one.phase[known])
        lower.plot(speed, np.degrees(lag), **look)
        for peak in one.peaks:
            factor = peak.amplification_factor
            place = (peak.speed * RPM, in_shown_unit(peak.amplitude * MICRO, "µm"))
            upper.plot(*place, "o", color=look["color"], mfc="w", ms=4.5, zorder=5)
            if factor is not None and factor >= 2.5:
                upper.annotate(
                    f"{place[0]:.0f} rpm\nAF {factor:.1f}", place, xytext=(0, 4), fontsize=7,
                    textcoords="offset points", color=look["color"], va="bottom", ha="center",
                    bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 0.5},
                )  # fmt: skip
    for axes in (upper, lower):
        mark_range(axes, continuous)
    upper.set(ylabel=axis_title("amplitude, zero to peak", "µm"), title=caption(title))
    upper.set_ylim(0.0, 1.15 * upper.get_ylim()[1])  # room for what stands above the peaks
    lower.set(xlabel="shaft speed [rpm]", ylabel="phase lag [deg]")
    step = 30.0 if np.ptp(lower.get_ylim()) < 240.0 else 90.0
    lower.yaxis.set_major_locator(MultipleLocator(step))
    upper.legend(loc="best")
    return figure_of(upper)


def control_traces(passive: LinearMotion, controlled: LinearMotion, title: str = "") -> Figure:
    """Draw displacement at the first sensor without and with control, and the force."""
    figure, axes = new_axes(2, 1, (6.6, 5.0), title, sharex=True)
    upper, lower = axes[:, 0]
    reach = 1.3 * in_shown_unit(np.abs(controlled.displacement[:, 0]).max() * MICRO, "µm")
    for name, run, look in (
        ("without control", passive, {"color": "0.55", "lw": 0.8}),
        ("with control", controlled, {"color": "#0072B2", "lw": 1.1}),
    ):
        shown = in_shown_unit(run.displacement[:, 0] * MICRO, "µm")
        upper.plot(run.t * 1e3, shown, label=name, **look)
        reach = max(reach, min(1.1 * float(np.abs(shown).max()), 3.0 * reach))
    upper.set(ylabel=axis_title("x at the sensor", "µm"), ylim=(-reach, reach))
    upper.legend(loc="upper right")
    for number, word in enumerate("xy"):
        lower.plot(
            controlled.t * 1e3, in_shown_unit(controlled.force[:, number], "N"), label=word,
            **dict(series_style("", number), linewidth=1.0),
        )  # fmt: skip
    lower.set(xlabel="time [ms]", ylabel=axis_title("force at the actuator", "N"))
    lower.legend(loc="upper right")
    return figure


def hot_spot_loop(study: HotSpotStudy, title: str = "") -> Figure:
    """Draw the loop's gain over speed, and each journal's temperature difference and lag."""
    figure, axes = new_axes(3, 1, (6.4, 6.6), sharex=True)
    above, middle, below = np.ravel(axes)
    loop = study.loop
    speed = loop.speed * RPM
    above.plot(speed, loop.gain[:, 0].real, color="#D55E00", label="real part")
    above.plot(speed, np.abs(loop.gain[:, 0]), color="#555555", ls="--", label="modulus")
    above.axhline(1.0, color="#8c1d2f", lw=1.0, label="limit of the real part")
    above.set(ylabel="gain [-]", title=caption(title))
    for number, name in enumerate(study.names):
        look = series_style("", number)
        middle.plot(
            speed, in_shown_unit(2.0 * np.abs(loop.temperature[:, number]), "K"), label=name, **look
        )
        below.plot(study.films.speed * RPM, np.degrees(study.lag[:, number]), label=name, **look)
    middle.set(ylabel=axis_title("warm less cold side", "K"), ylim=(0.0, None))
    below.set(ylabel="hot behind high spot [°]", xlabel="speed [rpm]")
    for ax in (above, middle):
        ax.legend(loc="best")
    return figure
