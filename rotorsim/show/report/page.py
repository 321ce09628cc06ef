"""The report: one page with everything in it, for a browser, a printer and a design review."""

from __future__ import annotations

import base64
import datetime
import hashlib
from collections.abc import Iterator
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from ...atomic import write_text
from ...bearing.description import grouped_warnings, point_title
from ...bearing.table_format import CONVENTIONS
from ...rows import RPM, facts_html
from ...study.inputs import input_rows
from . import html, results
from .compare import comparison
from .verdict import headline

if TYPE_CHECKING:
    from ...files.scenario import Scenario
    from ...study.main_job import Results

_CAPTIONS = {
    "coefficients": "Stiffness and damping against speed, load frame.",
    "critical_mass": "Critical mass and whirl frequency ratio of a rigid rotor against speed.",
    "stability_map": "Where a rigid rotor is stable: shaft speed and rotor mass.",
    "eigenvalues": "Eigenvalues of the rotor on its bearing over speed.",
    "film": "Film pressure and temperature at the highest speed.",
    "film_profiles": "Pressure and temperature around the bearing at the highest speed.",
    "transient": "Thermal transient: temperatures, clearance, operation, stability over time.",
    "cascade": "Spectra of the journal's motion over shaft speed.",
    "measured": "Measured points and the computed curves.",
    "orbits": "Journal orbits in the clearance circle; ○ start, ● end, + equilibrium.",
}
_PLACES = {
    "measured": "measured", "film": "static", "film_profiles": "static",
    "coefficients": "coefficients",
    "cascade": "orbits", "orbits": "orbits",
}  # fmt: skip
_FLOWS = {
    "laminar": "laminar",
    "turbulent": "turbulent by Reichardt's eddy viscosity",
    "ng_pan": "turbulent by the law of Ng & Pan",
    "constantinescu": "turbulent by Constantinescu's law",
    "hirs": "turbulent by Hirs' law",
}
_MODEL_LIMITS = (
    "Shaft and bush keep their shape, and without an expansion their size.",
    "K and C are those of small motions about the equilibrium; a growing motion soon leaves them.",
    "The critical mass and the map hold for a rigid rotor on two like bearings.",
)


def write_report(found: Results, path: str | Path, against: Results | None = None) -> Path:
    """Write the report of a scenario's results, whole or not at all.

    against : Those of another scenario, to compare with.
    """
    target = Path(path)
    write_text(target, report_page(found, against=against))
    return target


def report_page(
    found: Results, when: datetime.datetime | None = None, against: Results | None = None
) -> str:
    """Give the report as HTML that needs no other file and no network.

    found : What `rotorsim.study.main_job.compute` gives.
    when : Date of the report; now by default.
    against : Results to compare with.
    """
    body = "\n".join(part for part in _parts(found, when, against) if part)
    return document(found.scenario.title, body)


def document(title: str, body: str) -> str:
    """Return the whole page of HTML from its title and what it holds."""
    said = escape(title)
    style, script = (
        (files("rotorsim.show.report") / name).read_text(encoding="utf-8")
        for name in ("style.css", "figures.js")
    )
    # The policy forbids whatever would have to be fetched, and any other script.
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")
    policy = (
        "default-src 'none'; style-src 'unsafe-inline'; img-src data:; "
        f"script-src 'sha256-{digest}'"
    )
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<link rel="icon" href="data:,">\n<title>{said}</title>\n<style>\n{style}</style>\n'
        f"</head>\n<body>\n{body}\n<script>{script}</script>\n</body>\n</html>\n"
    )


def _parts(
    found: Results, when: datetime.datetime | None, against: Results | None
) -> Iterator[str]:
    scenario = found.scenario
    figures = _figures(found)
    yield f"<header>\n<h1>{escape(scenario.title)}</h1>\n{_origin(found, when)}\n</header>"
    yield headline(found)
    yield html.section("Warnings", html.listing(_warnings(found), "warnings") or _no_warnings())
    if against is not None:
        yield comparison(found, against)
    yield html.section("Inputs", _inputs(scenario))
    yield html.section(
        "Margins",
        results.margins(found.curves),
        _not_rigid(found),
        _tolerances(found),
        *figures.pop("stability"),
    )
    yield html.section("Static results", results.top_points(found.points), *figures.pop("static"))
    yield html.section("Measured and computed", results.measured(found), *figures.pop("measured"))
    yield html.section("Stiffness and damping", *figures.pop("coefficients"))
    yield html.section("Orbits", results.orbits(found.orbits), *figures.pop("orbits"))
    yield html.section("Conventions and limits", _conventions(found))
    yield '<div class="appendix">'
    yield html.section("Appendix A: operating points", results.all_points(found.points))
    yield html.section("Appendix B: stiffness and damping", results.coefficients(found.table))
    yield html.section("Appendix C: the scenario", f"<pre>{escape(scenario.text)}</pre>")
    yield "</div>"


def _origin(found: Results, when: datetime.datetime | None) -> str:
    from ... import __version__

    scenario = found.scenario
    date = (when or datetime.datetime.now().astimezone()).strftime("%Y-%m-%d %H:%M %Z").strip()
    source = "" if scenario.source is None else f"{scenario.source.name}, "
    text = f"Journal bearing report, {date}. Scenario {source}SHA-256 {scenario.sha256}. "
    return html.paragraph(f"{text}rotorsim {__version__}.", "origin")


def _warnings(found: Results) -> list[str]:
    from ...bearing.checks import regime_warnings
    from ...bearing.drawing import drawing_warnings

    scenario = found.scenario
    top = float(scenario.speeds[-1])
    mass = None if scenario.rotor is None else scenario.rotor.total_mass
    lines = list(found.problems)
    lines += [
        f"{point_title(point)}. {point.message}" for point in found.points if not point.converged
    ]
    lines += grouped_warnings(found.points)
    already = " ".join(lines)
    for case in scenario.cases():
        said = (*drawing_warnings(case, mass), *regime_warnings(case, top))
        lines += [text for text in said if text not in already and text not in lines]
    return lines


def _flow(found: Results) -> str:
    """Return the film's flow law, and which part of it flows how at the highest speed."""
    film = next(iter(found.scenario.cases())).film
    text = f"The film is {_FLOWS[film.flow]}"
    if film.flow == "laminar":
        return f"{text}."
    span = film.transition
    limits = "Taylor's criterion" if isinstance(span, str) else f"Re {span[0]:g} to {span[1]:g}"
    top = [point for point in found.points if point.laminar_share >= 0.0]
    if top:
        last = max(top, key=lambda point: point.speed)
        parts = (last.laminar_share, last.transitional_share, last.turbulent_share)
        said = " %, ".join(f"{100.0 * part:.0f}" for part in parts)
        limits += f"; laminar, in transition, turbulent at {last.speed * RPM:.0f} rpm: {said} %"
    return f"{text} (transition by {limits})."


def _not_rigid(found: Results) -> str:
    """Describe whose critical mass and map are shown, where the scenario's rotor is another one."""
    if not found.curves or not found.curves[0].rotor or found.curves[0].mass is not None:
        return ""
    return html.paragraph(
        "M crit, its whirl ratio and the map over mass are those of a rigid rotor, for comparison: "
        f"they do not hold for the {found.curves[0].rotor} of this scenario. Verdict, threshold, "
        "growth rate and decrement are the scenario's rotor's."
    )


def _tolerances(found: Results) -> str:
    """Return a sentence on a study that is not on this page."""
    given = found.scenario.tolerances
    if given is None:
        return ""
    name = "SCENARIO" if found.scenario.source is None else found.scenario.source.name
    inputs_given = ", ".join(word.replace("_", " ") for word in given.spreads)
    return html.paragraph(
        f"The scenario gives tolerances ({inputs_given}); all numbers here are for the nominal "
        f"values. What the tolerances make of the threshold: rotorsim stability {name} --tolerances"
    )


def _inputs(scenario: Scenario) -> str:
    blocks = map(facts_html, input_rows(scenario).values())
    return f'<div class="columns">{"".join(blocks)}</div>'


def _no_warnings() -> str:
    return html.paragraph("None: every point converged within the model's range.")


def _conventions(found: Results) -> str:
    return html.listing(
        [
            " ".join(CONVENTIONS),
            "ε: eccentricity over radial clearance; φ: from the load line to the journal's centre, "
            "with the rotation; S = μ N L D (R/c)²/W, N in revolutions per second.",
            "Mass margin: 1 − mass over critical mass. Logarithmic decrement: −2π times growth "
            "rate over damped frequency, of the slowest mode.",
            "T out: supply temperature plus the heat that the oil carries off over ρ c_p times the "
            "side flow, where warm and supplied oil mix. To walls: part of the heat that leaves "
            "through bush and shaft.",
            _flow(found),
            *_MODEL_LIMITS,
        ]
    )


def _figures(found: Results) -> dict[str, list[str]]:
    """Return figures by the section they belong to."""
    from ..job import figures

    placed: dict[str, list[str]] = {
        name: [] for name in ("stability", "static", "measured", "coefficients", "orbits")
    }
    for name, drawn in figures(found):
        known = max((key for key in _CAPTIONS if name.startswith(key)), key=len, default=name)
        caption = _CAPTIONS.get(known, name.replace("_", " "))
        placed[_PLACES.get(known, "stability")].append(html.figure(drawn, caption))
    return placed
