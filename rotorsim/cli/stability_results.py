"""Results of the stability analyses: as plain data and as tables."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..rows import QUANTITIES, RPM, number
from ..study.stability import verdict_word
from .tables import grid

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table

    from ..machine.branches import Modes
    from ..study.planes import Plane
    from ..study.stability import Campbell, StabilityCurve
    from ..study.tolerances import ToleranceStudy

_QUANTILES = (0.05, 0.5, 0.95)


def curve_row(curve: StabilityCurve, modes: Campbell | None) -> dict[str, Any]:
    """Return one curve for JSON."""
    row = {
        **curve.choices,
        **{
            field.name: getattr(curve, field.name)
            for field in dataclasses.fields(curve)
            if field.name not in ("choices", "rotor", "mass")
        },
        "growth_rate": curve.growth_rate,
    }
    if modes is not None:
        row["thresholds"] = [dataclasses.asdict(one) for one in modes.thresholds]
        row["modes"] = modes.as_dict()
    return row


def modes_table(curve: StabilityCurve, modes: Campbell) -> Table:
    """Return the least stable oscillating mode over speed."""
    found, head = modes.branches, ["rpm", *_MODE_HEADS]
    head.insert(-1, "growth 1/s")
    rows = []
    for i, speed in enumerate(found.parameter if found.eigenvalues.shape[1] else ()):
        cells = _mode_cells(found, i, k := int(found.least_stable[i]))
        cells.insert(-1, number(float(found.growth_rate[i, k])))
        rows.append([f"{speed * RPM:.0f}", *cells])
    return grid(f"Least stable mode: {curve.title}", *head, rows=rows)


_MODE_HEADS = ("mode", "Hz", "f/rev", "damping ratio", "log decrement", "whirl")


def _mode_cells(found: Modes, i: int, k: int) -> list[str]:
    """Return the cells of branch k at speed i."""
    frequency = float(found.damped_frequency[i, k])
    return [
        str(k + 1), number(frequency / (2.0 * math.pi)),
        number(frequency / float(found.parameter[i]), 3),
        number(float(found.damping_ratio[i, k]), 3),
        number(float(found.logarithmic_decrement[i, k]), 3), str(found.whirl[i, k]),
    ]  # fmt: skip


def branches_table(curve: StabilityCurve, modes: Campbell) -> Table:
    """Return every branch at the highest speed."""
    found = modes.branches
    rows = [_mode_cells(found, -1, k) for k in range(found.eigenvalues.shape[1])]
    title = f"Modes at {found.parameter[-1] * RPM:.0f} rpm: {curve.title}"
    return grid(title, *_MODE_HEADS, rows=rows)


def threshold_table(curves: Sequence[StabilityCurve], modes: Sequence[Campbell]) -> Table:
    """Return the threshold speeds of all curves, with the whirl ratio at each."""
    table = grid("Threshold speeds", "bearing", "rpm", "whirl Hz", "whirl ratio", "above it")
    for curve, found in zip(curves, modes, strict=True):
        if not found.thresholds:
            words = {verdict_word(rate) for rate in found.growth[np.isfinite(found.growth)]}
            verdict = f"{words.pop()} throughout" if len(words) == 1 else "-"
            table.add_row(curve.title, "none", "", "", verdict)
        for one in found.thresholds:
            table.add_row(
                curve.title,
                f"{one.speed * RPM:.0f}",
                number(one.whirl_frequency / (2.0 * math.pi)),
                number(one.whirl_frequency_ratio, 3),
                "unstable" if one.becomes_unstable else "stable",
            )
    return table


def plane_document(plane: Plane) -> dict[str, Any]:
    """Return a map for JSON."""
    names = ("mass_margin", "critical_mass", "whirl_frequency_ratio", "damped_frequency")
    error = plane.dataset["growth_rate"].attrs.get("interpolation_error")
    models = {
        model: {
            "growth_rate": plane.growth(model),
            "verdict": plane.values("verdict", model),
            **{
                name: plane.values(name, model)
                for name in names
                if name in plane.dataset and {plane.x, plane.y} <= set(plane.dataset[name].dims)
            },
        }
        for model in plane.models
    }
    return {
        "x": plane.names[0],
        "y": plane.names[1],
        "x_values": plane.dataset[plane.x].values,
        "y_values": plane.dataset[plane.y].values,
        "held": dict(plane.held),
        "verdicts": {"stable": 1, "unstable": 0, "unknown": -1, "undamped": 2},
        "interpolation_error": None
        if error is None
        else dict(zip(plane.models, error, strict=True)),
        "models": models,
        "destabilised_by_heating": plane.destabilised_by_heating,
    }


def plane_table(plane: Plane) -> list[RenderableType]:
    """Return how much of the map is stable, and its border at some places."""
    from ..study.planes import held_text

    head = f"Stability over {_name(plane.names[0])} and {_name(plane.names[1])}"
    held = held_text(plane.held)
    table = grid(head, "model", "stable", "unstable", "unknown")
    for model in plane.models:
        verdict = plane.values("verdict", model)
        shares = [100.0 * float(np.mean(verdict == code)) for code in (1, 0, -1)]
        table.add_row(model, *(f"{share:.1f} %" for share in shares))
    heated = plane.destabilised_by_heating
    if heated is not None:
        table.add_row(
            "made unstable by heating alone", "", f"{100.0 * float(heated.mean()):.1f} %", ""
        )
    lines = [f"held: {held}"] if held else []
    errors = plane.dataset["growth_rate"].attrs.get("interpolation_error")
    if errors is not None and np.isfinite(errors).any():
        said = ", ".join(
            f"{number(e, 2)} 1/s ({m})" for m, e in zip(plane.models, errors, strict=True)
        )
        lines.append(
            f"coefficients between solved films are interpolated; without every second film the "
            f"growth rate changes by at most {said}"
        )
    return [table, *lines, _border_table(plane)]


def _name(dimension: str) -> str:
    owner, _, word = dimension.rpartition(".")
    word = {"radial_clearance": "clearance", "applied_load": "load"}.get(word, word)
    return f"{owner} {word.replace('_', ' ')}".strip()


def _border_table(plane: Plane) -> Table:
    """Return the y at which the verdict changes for some x, linear in the growth rate."""
    across, upwards = plane.quantities
    first, second = map(_name, plane.names)
    x, y = (np.asarray(plane.dataset[name].values, dtype=float) for name in (plane.x, plane.y))
    names = [f"{model}: {second} {upwards.unit}" for model in plane.models]
    table = grid("Border between stable and unstable", f"{first} {across.unit}", *names)
    for i in np.unique(np.linspace(0, x.size - 1, min(x.size, 8)).round().astype(int)):
        cells = []
        for model in plane.models:
            growth = plane.growth(model)[i]
            at = np.flatnonzero(growth[:-1] * growth[1:] < 0.0)
            border = [
                y[j] + (y[j + 1] - y[j]) * growth[j] / (growth[j] - growth[j + 1]) for j in at
            ]
            known = growth[np.isfinite(growth)]
            all_of_it = "stable" if known.size and known.max() < 0.0 else "unstable"
            words = [_short(upwards.shown(value)) for value in border]
            cells.append(", ".join(words) if words else all_of_it if known.size else "-")
        table.add_row(_short(across.shown(float(x[i]))), *cells)
    return table


def _short(value: float) -> str:
    """Return a number with four digits, and all before the decimal point."""
    return f"{value:.0f}" if abs(value) >= 1e3 else f"{value:.4g}"


def study_document(study: ToleranceStudy) -> dict[str, Any]:
    """Return a tolerance study for JSON."""
    outputs = study.samples.outputs
    return {
        "thermal_model": study.thermal_model,
        "radial_clearance": study.radial_clearance,
        "operating_speed": study.operating_speed,
        "tolerances": {name: dataclasses.asdict(one) for name, one in study.tolerances.items()},
        "samples": next(iter(study.samples.inputs.values())).size,
        "failed": [{"sample": i, "message": text} for i, text in study.samples.failures],
        "nominal": dict(study.nominal),
        "probability_of_instability": study.probability_of_instability,
        "standard_error": study.standard_error,
        "quantiles": {
            name: dict(
                zip(map(str, _QUANTILES), study.samples.quantile(name, _QUANTILES), strict=True)
            )
            for name in ("threshold_speed", "critical_mass", "growth_rate")
            if name in outputs
        },
        "stable_throughout": float(np.nanmean(outputs["stable_throughout"])),
        "unstable_throughout": float(np.nanmean(outputs["unstable_throughout"])),
        "most_important_input": study.most_important,
        "rank_correlation": dict(study.importance),
        "share_of_variance": dict(study.share_of_variance),
        "explained_variance": study.explained_variance,
        "inputs": dict(study.samples.inputs),
        "outputs": dict(outputs),
    }


def study_tables(study: ToleranceStudy) -> list[RenderableType]:
    """Return distribution, probability, and the inputs that matter."""
    said = [study.thermal_model]
    if study.radial_clearance is not None:
        said.append(QUANTITIES["radial_clearance"].said(study.radial_clearance))
    said.append(f"{next(iter(study.samples.inputs.values())).size} samples")
    title = f"Tolerances: {', '.join(said)}"
    table = grid(title, "", "nominal", *(f"{100 * q:.0f} %" for q in _QUANTILES))
    rows = (
        ("threshold speed", "threshold_speed"),
        ("critical mass", "critical_mass"),
        ("growth rate", "growth_rate"),
    )
    for text, name in rows:
        if name not in study.nominal:
            continue
        found = [study.nominal[name], *map(float, study.samples.quantile(name, _QUANTILES))]
        one = QUANTITIES[name]
        cells = [
            "-" if value is None or not math.isfinite(value) else _short(one.shown(value))
            for value in found
        ]
        table.add_row(f"{text} {one.unit}", *cells)
    inputs = grid(
        "What matters (for the growth rate)", "input", "rank correlation", "share of variance"
    )
    for name, value in study.importance.items():
        share = study.share_of_variance[name]
        said = f"{100.0 * share:.0f} %" if math.isfinite(share) else "-"
        inputs.add_row(name.replace("_", " ").replace(".", ": "), f"{value:+.2f}", said)
    p, error = 100.0 * study.probability_of_instability, 100.0 * study.standard_error
    outputs = study.samples.outputs
    stable = 100.0 * float(np.nanmean(outputs["stable_throughout"]))
    unstable = 100.0 * float(np.nanmean(outputs["unstable_throughout"]))
    lines = [
        f"probability of instability at {study.operating_speed * RPM:.0f} rpm: {p:.1f} % "
        f"(+- {error:.1f} %)"
    ]
    lines += [
        f"no threshold within the speeds: {share:.1f} % of the samples are {word} throughout"
        for share, word in ((stable, "stable"), (unstable, "unstable"))
        if share > 0.0
    ]
    failed = len(study.samples.failures)
    lines += [f"left out everywhere: {failed} samples whose film did not converge"] * bool(failed)
    shares = "share of variance: too few samples to tell, or nothing varies"
    if math.isfinite(study.explained_variance):
        shares = (
            "share of variance: of this input alone (first-order Sobol' index), by a regression "
            f"that\nexplains {100.0 * study.explained_variance:.1f} % (adjusted R2); the shares "
            "need not add up to 100 %"
        )
    return [table, "\n".join(lines), inputs, shares]
