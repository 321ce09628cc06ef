"""Eigenvalues over speed, Campbell diagrams, root loci, and what tolerances do to thresholds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ...machine.branches import FORWARD, Modes
from ...machine.thresholds import ThresholdSpeed
from ...rows import RPM
from ...study.stability import Campbell
from ...study.tolerances import ToleranceStudy
from ...text import caption
from .style import MARKERS, axes_or_new, figure_of, model_label, model_style, new_axes

Array = NDArray[np.float64]


def eigenvalue_plot(curves: Sequence[Campbell], title: str = "", ax: Axes | None = None) -> Figure:
    """Return upper half of the complex plane.

    Branches over speed, open at first, filled at last.
    """
    ax = axes_or_new(ax, (6.2, 4.6))
    every = [values[np.isfinite(values)] for values in (c.branches.eigenvalues for c in curves)]
    highest = max(float(np.abs(values.imag).max(initial=1e-3)) for values in every)
    right = max(float(values.real.max(initial=0.0)) for values in every)
    ax.axvspan(0.0, max(1.4 * right, 0.12 * highest), color="#f2d7d9", zorder=0)
    ax.axvline(0.0, color="#8c1d2f", linewidth=1.0)
    ax.text(
        0.99, 0.97, "unstable", transform=ax.transAxes, ha="right", va="top", color="#8c1d2f",
        rotation=90,
    )  # fmt: skip
    for number, curve in enumerate(curves):
        model = curve.choices["thermal_model"]
        look = model_style(model)
        for k, branch in enumerate(curve.branches.eigenvalues.T):
            shown = branch.imag >= 0.0
            real = np.where(shown, branch.real, np.nan)
            imaginary = np.where(shown, branch.imag, np.nan)
            label = _threshold_label(curve) if k == 0 else None
            ax.plot(real, imaginary, **look, label=label)
            ax.plot(real[-1], imaginary[-1], MARKERS[number], color=look["color"])
            ax.plot(real[:1], imaginary[:1], MARKERS[number], color=look["color"], mfc="w")
        for one in curve.thresholds[:1]:
            ax.plot(0.0, one.whirl_frequency, "x", color="#8c1d2f", ms=8, mew=2, zorder=6)
    left = max(min(float(values.real.min(initial=0.0)) for values in every), -highest)
    ax.set_xlim(1.08 * min(left, -0.2 * highest), max(1.4 * right, 0.12 * highest))
    ax.set_ylim(0.0, 1.08 * highest)
    low, high = curves[0].branches.parameter[[0, -1]] * RPM
    for speed, face in ((low, "w"), (high, "k")):
        ax.plot([], [], MARKERS[0], color="k", mfc=face, ls="", label=f"at {speed:.0f} rpm")
    ax.set(
        xlabel="real part: growth rate [1/s]",
        ylabel="imaginary part: damped frequency [rad/s]",
        title=caption(title) or "eigenvalues over speed",
    )
    figure = figure_of(ax)
    if len(figure.axes) == 1:
        # Below: within the axes it would cover eigenvalues.
        figure.legend(loc="outside lower center", ncols=2)
    else:
        ax.legend(loc="best")
    return figure


def _threshold_label(curve: Campbell) -> str:
    """Return the model, and at which speed the first of its modes turns unstable."""
    label = model_label(curve.choices["thermal_model"])
    if not curve.thresholds:
        return label
    first = curve.thresholds[0]
    said = f"{label}: threshold {first.speed * RPM:.0f} rpm"
    ratio = first.whirl_frequency_ratio
    return said if ratio is None else f"{said}, whirl ratio {ratio:.3f}"


def campbell_diagram(
    curves: Sequence[Campbell],
    orders: Sequence[float] = (1.0, 0.5),
    title: str = "",
    ax: Axes | None = None,
) -> Figure:
    """Return the damped frequency against speed with lines of synchronous and half-frequency whirl.

    Where a branch grows (positive real part) it is drawn thick.
    """
    ax = axes_or_new(ax, (6.2, 4.4))
    grows = False
    for curve in curves:
        model, branches = curve.choices["thermal_model"], curve.branches
        look = model_style(model)
        for k in range(branches.eigenvalues.shape[1]):
            label = model_label(model) if k == 0 else None
            speed, values = _with_crossings(
                branches.parameter, branches.eigenvalues[:, k], curve.thresholds
            )
            hertz = np.where(values.imag > 0.0, values.imag, np.nan) / (2 * np.pi)
            ax.plot(speed * RPM, hertz, **look, label=label)
            unstable = np.where(values.real >= 0.0, hertz, np.nan)
            grows = grows or bool(np.isfinite(unstable).any())
            ax.plot(speed * RPM, unstable, color=look["color"], linewidth=4.5, alpha=0.45)
        _mark_whirl(ax, curve)
    ends = np.array([0.0, max(float(curve.branches.parameter[-1]) for curve in curves)])
    for order in orders:
        ax.plot(ends * RPM, order * ends / (2 * np.pi), color="0.35", linewidth=0.8)
        place = (ends[1] * RPM, order * ends[1] / (2 * np.pi))
        ax.annotate(f"{order:g}x", place, xytext=(3, -3), textcoords="offset points", fontsize=8)
    for marker, text, sign in _SENSES:
        if any(np.any(sign * curve.branches.whirl_sense > FORWARD) for curve in curves):
            ax.plot([], [], marker, color="k", mfc="w", ms=5, ls="", label=text)
    if any(curve.thresholds for curve in curves):
        ax.plot([], [], "x", color="k", ms=8, mew=2, ls="", label="threshold")
    if grows:
        ax.plot([], [], color="0.4", linewidth=4.5, alpha=0.45, label="grows (unstable)")
    ax.set(xlabel="shaft speed [rpm]", ylabel="damped frequency [Hz]", title=caption(title))
    ax.set_ylim(bottom=0.0)
    ax.legend(loc="upper left")
    return figure_of(ax)


def _with_crossings(
    speed: Array, branch: NDArray[np.complex128], thresholds: Sequence[ThresholdSpeed]
) -> tuple[Array, NDArray[np.complex128]]:
    """Return a branch with points where it turns unstable or back.

    Growth begins there, not at a knot.

    A threshold at about the branch's frequency is taken as it is; a branch that crosses elsewhere
    (another one is unstable already) is interpolated.
    """
    speeds: list[float] = []
    values: list[complex] = []
    for i, value in enumerate(branch):
        if i and branch[i - 1].real * value.real < 0.0:
            before = complex(branch[i - 1])
            t = before.real / (before.real - value.real)
            at = float(speed[i - 1] + t * (speed[i] - speed[i - 1]))
            whirl = before.imag + t * (complex(value).imag - before.imag)
            for threshold in thresholds:
                place, frequency = threshold.speed, threshold.whirl_frequency
                inside = speed[i - 1] <= place <= speed[i]
                if inside and abs(frequency - abs(whirl)) < 0.1 * abs(whirl):
                    at, whirl = place, frequency if whirl > 0.0 else -frequency
            speeds.append(at)
            values.append(complex(0.0, whirl))
        speeds.append(float(speed[i]))
        values.append(complex(value))
    return np.array(speeds), np.array(values)


_SENSES = (("^", "whirls forward", 1.0), ("v", "whirls backward", -1.0))


def _mark_whirl(ax: Axes, curve: Campbell) -> None:
    """Draw triangles along the branches for the sense of whirl, crosses at the thresholds."""
    colour = model_style(curve.choices["thermal_model"])["color"]
    values, rpm = curve.branches.eigenvalues, curve.branches.parameter * RPM
    hertz = np.where(values.imag > 0.0, values.imag, np.nan) / (2 * np.pi)
    sense, step = curve.branches.whirl_sense, max(1, rpm.size // 8)
    shown = np.zeros(rpm.shape, dtype=bool)
    shown[step // 2 :: step] = True
    for marker, _, sign in _SENSES:
        for k in range(hertz.shape[1]):
            here = shown & (sign * sense[:, k] > FORWARD)
            ax.plot(rpm[here], hertz[here, k], marker, color=colour, mfc="w", ms=5)
    for one in curve.thresholds:
        place = (one.speed * RPM, one.whirl_frequency / (2 * np.pi))
        ax.plot(*place, "x", color="k", ms=8, mew=2, zorder=6)


def root_locus(branches: Modes, quantity: str, title: str = "", ax: Axes | None = None) -> Figure:
    """Return eigenvalues over a parameter.

    Open at its first value, filled at its last, numbers between.

    branches : Over a parameter in the unit that `quantity` names.
    quantity : The parameter with its unit, for example ``"mass per bearing [kg]"``.
    """
    parameter, eigenvalues = branches.parameter, branches.eigenvalues
    ax = axes_or_new(ax, (6.2, 4.8))
    upper = eigenvalues.imag >= -1e-9 * np.abs(eigenvalues)
    values = np.asarray(np.where(upper, eigenvalues, np.nan), dtype=complex)
    known: NDArray[np.complex128] = values[np.isfinite(values)]
    highest = max(float(known.imag.max(initial=0.0)), 1e-3)
    low, high = _window(values, highest)
    ax.axvspan(0.0, high, color="#f2d7d9", zorder=0)
    ax.axvline(0.0, color="#8c1d2f", linewidth=1.0)
    ax.annotate(
        "unstable", (high, 0.0), xytext=(-4, 6), textcoords="offset points", ha="right",
        color="#8c1d2f", rotation=90,
    )  # fmt: skip
    for k, branch in enumerate(values.T):
        ax.plot(branch.real, branch.imag, color="#0072B2", zorder=2)
        for index, face in ((0, "w"), (-1, "#0072B2")):
            if np.isfinite(branch[index]):
                point = complex(branch[index])
                ax.plot(point.real, point.imag, "o", color="#0072B2", mfc=face, ms=5, zorder=3)
        _number_branch(ax, parameter, branch, (low, high), 0.06 * highest, k)
    first, last = f"{parameter[0]:.4g}", f"{parameter[-1]:.4g}"
    ax.set_xlim(low, high)
    ax.set_ylim(-0.02 * highest, 1.08 * highest)
    ax.set(
        xlabel="real part: growth rate [1/s]",
        ylabel="imaginary part: damped frequency [rad/s]",
        title=f"{caption(title)}\n{quantity} from {first} (open) to {last} (filled)".strip(),
    )
    return figure_of(ax)


def _window(values: NDArray[np.complex128], highest: float) -> tuple[float, float]:
    """Return the growth rates to show: those of the branch nearest to instability, well inside."""
    rates = np.where(np.isfinite(values), values.real, -np.inf)
    nearest = rates[:, int(np.argmax(rates.max(axis=0)))]
    nearest = nearest[np.isfinite(nearest)]
    left, right = min(float(nearest.min()), 0.0), max(float(nearest.max()), 0.0)
    width = max(right - left, 0.05 * highest)
    return left - 0.5 * width, right + 0.2 * width


def _number_branch(
    ax: Axes,
    parameter: Array,
    branch: NDArray[np.complex128],
    limits: tuple[float, float],
    spacing: float,
    k: int,
) -> None:
    """Write values of the parameter along a branch, and where it crosses into instability."""
    crossed = np.flatnonzero(np.sign(branch.real[:-1]) * np.sign(branch.real[1:]) < 0.0)
    for i in crossed:
        t = branch.real[i] / (branch.real[i] - branch.real[i + 1])
        value = parameter[i] + t * (parameter[i + 1] - parameter[i])
        height = branch.imag[i] + t * (branch.imag[i + 1] - branch.imag[i])
        ax.plot(0.0, height, "x", color="k", ms=8, mew=2, zorder=4)
        ax.annotate(
            f"{value:.4g}", (0.0, height), xytext=(7, 4), textcoords="offset points", fontsize=8,
            fontweight="bold",
        )  # fmt: skip
    last = None
    for i in range(1, parameter.size - 1):
        point = complex(branch[i])
        if not (np.isfinite(point) and limits[0] < point.real < limits[1]):
            continue
        near_crossing = crossed.size and abs(point.real) < spacing
        if near_crossing or (last is not None and abs(point - last) < 3.0 * spacing):
            continue
        if last is None and abs(point - branch[0]) < 2.0 * spacing:
            continue
        last = point
        ax.plot(point.real, point.imag, ".", color="#0072B2", ms=5)
        ax.annotate(
            f"{parameter[i]:.3g}", (point.real, point.imag), xytext=(4, 3 if k % 2 == 0 else -9),
            textcoords="offset points", fontsize=7, color="0.25",
        )  # fmt: skip


_NAMES = {"radial_clearance": "clearance", "supply_temperature": "supply temperature"}


def tolerance_histograms(study: ToleranceStudy, title: str = "") -> Figure:
    """Return histograms of threshold speed and critical mass, and the inputs' importance.

    Of a machine the growth rate takes the place of the critical mass. Samples whose film did not
    converge are in none of them, and said.
    """
    failures = [sample for sample, _ in study.samples.failures]
    failed = len(failures)
    second = "critical_mass" if "critical_mass" in study.nominal else "growth_rate"
    threshold_speed, other = (
        np.delete(study.samples.outputs[name], failures) for name in ("threshold_speed", second)
    )
    nominal, importance = study.nominal, study.importance
    mass = study.rotor.rigid_mass
    if failed:
        title += f"\n{threshold_speed.size} samples; {failed} more did not converge"
    figure, axes = new_axes(1, 3, (9.6, 3.4), title.strip())
    speed, mass_axes, bars = axes[0]
    at = None if nominal["threshold_speed"] is None else nominal["threshold_speed"] * RPM
    mark = (study.operating_speed * RPM, "operating speed")
    _histogram(speed, threshold_speed * RPM, "threshold speed [rpm]", at, mark)
    label = "critical mass at operating speed [kg]"
    border = None if mass is None else (mass, "rotor mass")
    if second == "growth_rate":
        label, border = "growth rate at operating speed [1/s]", (0.0, "unstable above")
    _histogram(mass_axes, other, label, nominal[second], border)
    names = list(importance)[::-1]
    values = np.array([importance[name] for name in names])
    bars.barh(
        [_NAMES.get(name, name.replace("_", " ").replace(".", ": ")) for name in names],
        values,
        color="#c9d8e4",
        edgecolor="k",
        height=0.6,
    )
    bars.axvline(0.0, color="k", linewidth=0.8)
    bars.set(xlim=(-1.05, 1.05), xlabel="rank correlation with growth rate [-]")
    bars.grid(visible=False, axis="y")
    return figure


def _histogram(
    ax: Axes, values: Array, label: str, nominal: float | None, mark: tuple[float, str] | None
) -> None:
    known = values[np.isfinite(values)]
    name = label.split(" at ")[0].split(" [")[0]
    if not known.size:
        # An axis without a value would show numbers that nobody computed.
        ax.set_axis_off()
        where = "\nwithin the speeds looked at" if "speed [" in label else ""
        ax.text(
            0.5, 0.5, f"no sample has a {name}{where}", transform=ax.transAxes, ha="center",
            va="center",
        )  # fmt: skip
        return
    edges = np.histogram_bin_edges(known, "auto")
    share = np.full(known.size, 100.0 / values.size)
    ax.hist(known, edges.tolist(), weights=share, color="#c9d8e4", edgecolor="k", linewidth=0.7)
    missing = values.size - known.size
    if missing:
        ax.set_title(f"{100.0 * missing / values.size:.3g} % of samples have none")
    if mark is not None:
        ax.axvline(mark[0], color="#8c1d2f", linewidth=1.8, label=mark[1])
    if nominal is not None:
        ax.axvline(nominal, color="k", linewidth=1.3, linestyle="--", label="nominal")
    ax.margins(y=0.3)
    ax.set(xlabel=label, ylabel="share of samples [%]")
    if mark is not None or nominal is not None:
        ax.legend(loc="upper right")
