"""The report of a machine: its drawing, bearings at load, modes, response, checks, verdicts."""

from __future__ import annotations

import datetime
import math
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...atomic import write_text
from ...rows import RPM, Row, facts_html, heads, number, shown, table_html, with_unit
from ...study import machine_tables as tables
from . import html
from .compare import machine_comparison

if TYPE_CHECKING:
    from ...study.hot_spot import HotSpotStudy
    from ...study.lateral import LateralStudy
    from ...study.machine import MachineResult
    from ...study.sensitivity import Sensitivity

_CAPTIONS = {
    "rotor": "The rotor to scale: sections, discs, bearings, probes.",
    "campbell": "Campbell diagram: damped natural frequencies over speed, and critical speeds.",
    "growth_rate": "Growth rates over speed: unstable above 0.",
    "mode_shapes": "Mode shapes at the highest speed: orbits, and the centre line at one instant.",
    "critical_speed_map": "Undamped critical speeds over support stiffness, and the bearings' own.",
    "unbalance_response": "Response at the probes to the unbalances of the file.",
    "destabilising": "Logarithmic decrement over destabilising stiffness.",
    "hot_spot": "Gain of the loop of orbit, heat and bend; temperature differences; lag.",
}
_MOVING = html.paragraph(
    "Each parameter changed alone, by the amount given and in proportion; static loads held."
)
_SPOTS = html.paragraph(
    "The side of a journal that always meets the thin film is warmer; the shaft bends and turns "
    "with it. Temperatures under the file's unbalance, settled; they grow without limit where the "
    "real part of the loop's gain exceeds 1."
)
_PLACES = {
    "rotor": "rotor", "campbell": "modes", "growth_rate": "verdict", "mode_shapes": "modes",
    "critical_speed_map": "critical", "unbalance_response": "response",
    "destabilising": "sensitivity", "hot_spot": "spots",
}  # fmt: skip


def write_machine_report(
    results: dict[str, MachineResult], study: LateralStudy, path: str | Path,
    moving: Sequence[Sensitivity] = (), when: datetime.datetime | None = None,
    spots: HotSpotStudy | None = None, against: dict[str, MachineResult] | None = None,
) -> Path:  # fmt: skip
    """Write the report of a machine's results, whole or not at all.

    results : By thermal model; modes, response and checks are those of the last.
    moving : Sensitivities of its threshold.
    spots : Its hot spots.
    against : Results of another machine, to compare with.
    """
    from .page import document

    last = results[next(reversed(results))]
    title = last.description.title
    target = Path(path)
    parts = _parts(results, study, moving, when, spots, against)
    write_text(target, document(title, "\n".join(part for part in parts if part)))
    return target


def _parts(
    results: dict[str, MachineResult], study: LateralStudy, moving: Sequence[Sensitivity],
    when: datetime.datetime | None, spots: HotSpotStudy | None,
    against: dict[str, MachineResult] | None,
) -> Iterator[str]:  # fmt: skip
    last = results[next(reversed(results))]
    machine = last.description
    figures = _figures(results, study, spots)
    title = escape(machine.title)
    yield f"<header>\n<h1>{title}</h1>\n{_origin(machine, when)}\n</header>"
    yield _headline(results)
    warnings = [*tables.failure_lines(results), *study.notes]
    none = html.paragraph("None: every film and every static equilibrium converged.")
    yield html.section("Warnings", html.listing(warnings, "warnings") or none)
    if against is not None:
        yield machine_comparison(results, against)
    yield html.section("Rotor", *figures["rotor"], _rotor(last), _shaft_tables(last))
    yield html.section("Bearings at their load", _bearings(results), _statics(last))
    yield html.section(
        "Isothermal against thermal" if len(results) > 1 else "Stability over speed",
        _comparison(results), html.listing(map(_sentence, tables.heating_lines(results))),
        *figures["verdict"],
    )  # fmt: skip
    yield html.section("Modes", _table(tables.mode_rows(last)), *figures["modes"])
    critical = [_table(one) for one in tables.critical_rows(results)]
    yield html.section("Critical speeds", *critical, *figures["critical"])
    response = [_table(one) for one in tables.peak_rows(study)]
    checks = [_table(one) for one in tables.check_rows(study)]
    yield html.section("Unbalance response and margins", *response, *checks, *figures["response"])
    yield html.section(
        "Sensitivity to destabilising stiffness (level I)",
        *(_table(one) for one in tables.sensitivity_rows(study)), *figures["sensitivity"],
    )  # fmt: skip
    yield html.section(
        "Synchronous hot spots (Morton effect)",
        html.listing(map(_sentence, tables.spot_lines(spots))),
        *map(_table, tables.spot_rows(spots)), _SPOTS if spots is not None else "",
        *figures["spots"],
    )  # fmt: skip
    found = [_table(one) for one in tables.moving_rows(moving)]
    yield html.section("What moves the stability threshold", *found, _MOVING if found else "")
    yield html.section("What was computed", html.listing(_statements(results, study)))
    yield '<div class="appendix">'
    least = [_table(one) for one in tables.least_stable_rows(results, every=True)]
    yield html.section("Appendix A: least stable mode over speed", *least)
    films = [_table(one) for one in tables.support_rows(results, every=True)]
    yield html.section("Appendix B: bearings over speed", *films)
    texts = [f"<pre>{escape(machine.text)}</pre>"]
    texts += [
        f"<h3>{escape(name)}</h3>\n<pre>{escape(one.text)}</pre>"
        for name, one in machine.bearings.items()
    ]
    yield html.section("Appendix C: the machine's file and its bearings'", *texts)
    yield "</div>"


def _table(rows: tables.Rows) -> str:
    if not rows.rows:
        return ""
    texts = {"check": 1, "name": 1, "bearing or place": 2}.get(rows.head[0], 0)
    return f'<div class="wide">{table_html(rows.head, rows.rows, rows.title, texts=texts)}</div>'


def _sentence(text: str) -> str:
    first = "THD" if text.startswith("thd") else text[0].upper()
    return f"{first}{text[len(first) :]}."


def _origin(machine: object, when: datetime.datetime | None) -> str:
    import hashlib

    from ... import __version__

    source, text = getattr(machine, "source", None), str(getattr(machine, "text", ""))
    date = (when or datetime.datetime.now().astimezone()).strftime("%Y-%m-%d %H:%M %Z").strip()
    name = "" if source is None else f"{source.name}, "
    digest = hashlib.sha256(text.encode()).hexdigest()
    said = f"Machine report, {date}. File {name}SHA-256 {digest}. rotorsim {__version__}."
    return html.paragraph(said, "origin")


def _headline(results: dict[str, MachineResult]) -> str:
    said = [_sentence(text) for text in tables.verdict_lines(results)]
    for model, result in results.items():
        lost = [one for one in result.thresholds if one.becomes_unstable]
        if lost:
            name = "THD" if model == "thd" else model.capitalize()
            word = f"{name}: unstable" if len(results) > 1 else "Unstable"
            said.append(
                f"{word} from {lost[0].speed * RPM:.0f} rpm, whirling at "
                f"{number(lost[0].whirl_frequency_ratio, 3)} of the speed."
            )
    verdicts = [str(result.verdict) for result in results.values()]
    kind = '"verdict bad"' if "unstable" in verdicts else '"verdict good"'
    kind = kind if set(verdicts) <= {"stable", "unstable"} else "verdict"
    return html.paragraph(" ".join(said) or "No verdict: no speed at which all is known.", kind)


def _rotor(last: MachineResult) -> str:
    machine, rotor = last.description, last.machine.rotor
    beam = machine.rotor.beam
    speeds = machine.operating.speeds
    rows = [
        Row("length", with_unit(beam.length * 1e3, "mm")),
        Row("mass", with_unit(rotor.total_mass, "kg")),
        Row("elements", f"{len(rotor.nodes) - 1}, {'Timoshenko' if beam.shear else 'Rayleigh'}"),
        Row("Young's modulus", with_unit(beam.material.youngs_modulus / 1e9, "GPa")),
        Row("density", with_unit(beam.material.density, "kg/m³")),
        Row("rotation from the left", "clockwise" if beam.clockwise else "counterclockwise"),
        Row("internal damping", f"{number(beam.internal_damping * 1e6)} µs"),
        Row("axial force", with_unit(beam.axial_force / 1e3, "kN")),
        Row("speeds", f"{speeds[0] * RPM:.0f} to {speeds[-1] * RPM:.0f} rpm, {len(speeds)}"),
    ]
    continuous = machine.operating.continuous
    if continuous is not None:
        rows.append(
            Row("continuous speeds", f"{continuous[0] * RPM:.0f} to {continuous[1] * RPM:.0f} rpm")
        )
    return facts_html(rows)


def _shaft_tables(last: MachineResult) -> str:
    beam = last.description.rotor.beam
    sections = [
        (str(number_), shown(beam.span(one)[0] * 1e3, "mm"), shown(one.length * 1e3, "mm"),
         _taper(one.outer_diameter, one.outer_right), _taper(one.inner_diameter, one.inner_right),
         str(one.layer) + ("" if one.stiffness else ", mass alone"))
        for number_, one in enumerate(beam.sections, start=1)
    ]  # fmt: skip
    head = heads("section", "from mm", "length mm", "outer mm", "inner mm", "layer")
    discs = [
        (one.name or "-", shown(one.at * 1e3, "mm"), shown(one.mass, "kg"),
         shown(one.polar_inertia, "kg m²"), shown(one.transverse_inertia, "kg m²"))
        for one in beam.discs
    ]  # fmt: skip
    wide = [table_html(head, sections, "Sections", texts=0)]
    if discs:
        head = heads("disc", "at mm", "mass kg", "polar kg m²", "transverse kg m²")
        wide.append(table_html(head, discs, "Discs and added masses"))
    return "\n".join(f'<div class="wide">{one}</div>' for one in wide)


def _taper(left: float, right: float) -> str:
    text = shown(left * 1e3, "mm")
    return text if left == right else f"{text} to {shown(right * 1e3, 'mm')}"


def _bearings(results: dict[str, MachineResult]) -> str:
    """Return every bearing at the highest speed, with each thermal model."""
    rows, top = [], 0.0
    for model, result in results.items():
        for state, entry in zip(result.supports, result.description.support, strict=True):
            top = float(result.speeds[-1])
            load = float(np.hypot(*state.load[-1]))
            row = [state.name, shown(entry.at * 1e3, "mm"), model, shown(load / 1e3, "kN")]
            row.append(number(math.degrees(float(state.direction[-1])), 3))
            if state.points:
                point = state.points[-1]
                k, c = point.stiffness / 1e6, point.damping / 1e3
                row += [
                    number(point.eccentricity_ratio, 3),
                    shown(point.min_film_thickness * 1e6, "µm", 3),
                    shown(point.max_pressure / 1e6, "MPa", 3),
                    shown(point.max_temperature - 273.15, "°C", 3),
                    shown(point.power_loss / 1e3, "kW", 3),
                    _four(k, "MN/m"), _four(c, "kN s/m"), point.status.value,
                ]  # fmt: skip
            elif entry.stiffness is not None:
                k, c = (
                    np.array(one or np.zeros((2, 2))) for one in (entry.stiffness, entry.damping)
                )
                row += [*["-"] * 5, _four(k / 1e6, "MN/m"), _four(c / 1e3, "kN s/m"), "constants"]
            else:
                row += [*["-"] * 7, "table" if entry.ring is None else "floating ring"]
            rows.append(row)
    head = heads(
        "name", "at mm", "model", "load kN", "direction °", "e/c", "h_min µm", "p_max MPa",
        "T_max °C", "loss kW", "K xx/xy/yx/yy MN/m", "C xx/xy/yx/yy kN s/m", "status",
    )  # fmt: skip
    note = html.paragraph(
        "Loads from statics; directions from x (down) in the direction of rotation; K and C in the "
        "frame of each bearing's load."
    )
    return note + f'<div class="wide">{table_html(head, rows, f"At {top * RPM:.0f} rpm")}</div>'


def _four(matrix: np.ndarray, unit: str) -> str:
    return " / ".join(shown(float(one), unit, 3) for one in matrix.ravel())


def _statics(last: MachineResult) -> str:
    if not last.statics:
        return ""
    one, rotor = last.statics[-1], last.machine.rotor
    sag = np.array([one.displacement[x] for x, _ in rotor.planes])
    place = int(np.abs(sag).argmax())
    at = rotor.nodes[place].position
    return html.paragraph(
        f"Largest static displacement of the shaft along x at the highest speed: "
        f"{with_unit(float(sag[place]) * 1e6, 'µm')}, {with_unit(at * 1e3, 'mm')} from the left "
        "end."
    )


def _comparison(results: dict[str, MachineResult]) -> str:
    rows = []
    for model, result in results.items():
        found = result.modes
        if found is None:
            continue
        k = int(tables.least_stable_below(found)[-1])
        lost = [f"{one.speed * RPM:.0f}" for one in result.thresholds]
        rows.append((
            model, str(result.verdict), ", ".join(lost) or "none",
            number(float(found.growth_rate[-1, k])),
            number(float(found.logarithmic_decrement[-1, k]), 3),
            number(float(found.damped_frequency[-1, k]) / (2.0 * math.pi)),
        ))  # fmt: skip
    head = ("model", "verdict", "thresholds rpm", "growth 1/s", "log decrement", "Hz")
    return table_html(head, rows, "Least stable mode at the highest speed") if rows else ""


def _statements(results: dict[str, MachineResult], study: LateralStudy) -> Iterator[str]:
    last = results[next(reversed(results))]
    machine, rotor = last.description, last.machine.rotor
    yield (
        f"Rotor: {len(rotor.nodes) - 1} beam elements with rotary inertia and gyroscopic moments; "
        f"{last.machine.size} unknowns, pads and housings included."
    )
    yield _sentence(tables.mesh_line(last))
    for name, one in machine.bearings.items():
        mesh = one.film.mesh
        yield (
            f"{name}: film solved at its static load on {mesh.circumferential} × {mesh.axial} × "
            f"{mesh.cross_film} cells, {', '.join(str(m) for m in one.thermal_models)}; "
            f"{one.film.cavitation.value.replace('_', ' ')} cavitation."
        )
    yield (
        "Coefficients are those of small motions about the static equilibrium; between the speeds "
        "they are interpolated (monotone cubic)."
    )
    yield (
        "Growth rate: real part of a mode's eigenvalue, positive when unstable; logarithmic "
        "decrement −2π times growth rate over damped frequency. A real part below its own accuracy "
        "counts as undamped, neither stable nor unstable."
    )
    yield f"Modes, critical speeds, response and checks: {last.thermal_model}."
    for check in {one.formula: one for one in study.checks}.values():
        yield f"{check.name}: {check.formula}."
    if study.checks:
        yield (
            f"Edition as the file states it: {study.checks[0].edition}. The program does not "
            "verify an edition: its limits are inputs."
        )


def _figures(
    results: dict[str, MachineResult], study: LateralStudy, spots: HotSpotStudy | None
) -> dict[str, list[str]]:
    """Return figures by the section they belong to."""
    from ..machine_job import machine_figures

    placed: dict[str, list[str]] = {name: [] for name in dict.fromkeys(_PLACES.values())}
    for name, drawn in machine_figures(results, study, spots):
        placed.setdefault(_PLACES.get(name, "modes"), []).append(
            html.figure(drawn, _CAPTIONS.get(name, name.replace("_", " ")))
        )
    return placed
