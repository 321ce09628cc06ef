"""Orbits as plain data and as text: what terminal, report, recording and notebooks say of a run."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from ..rows import QUANTITIES, RPM, Row, facts_html, number, result_html
from .analysis import WHIRLING, analyse
from .orbit import Orbit
from .spectrum import Ellipse

_SMALL = QUANTITIES["radial_clearance"]
"""Unit in which small lengths are shown."""


def describe_orbit(orbit: Orbit) -> dict[str, Any]:
    """Run and outcome of one orbit: status, extent, growth, whirl (SI).

    ``growth_rate`` is that of small motions at the start. ``amplitude``, ``whirl`` (ellipse at the
    whirl's frequency) and ``synchronous`` (at the shaft's) are those of the steady part; without
    one, ``amplitude`` is that of the whole run. ``whirl_range`` says where a run through the speeds
    whirls.
    """
    found = analyse(orbit)
    growth, recognised = found.growth, found.recognition
    ratio = None if growth is None else growth.whirl_frequency_ratio
    if recognised is not None and recognised.whirl_frequency_ratio is not None:
        ratio = recognised.whirl_frequency_ratio
    steady = None if recognised is None else recognised.steady_from
    return {
        "thermal_model": orbit.thermal_model,
        "kind": _kind(orbit),
        "radial_clearance": orbit.radial_clearance,
        "speed": [float(orbit.speed[0]), float(orbit.speed[-1])],
        "duration": float(orbit.t[-1]),
        "revolutions": float(orbit.revolutions[-1]),
        "status": orbit.status,
        "message": orbit.message,
        "max_eccentricity_ratio": float(orbit.eccentricity_ratio.max()),
        "growth_rate": None if growth is None else growth.rate,
        "whirl_frequency_ratio": ratio,
        "orbit_kind": orbit.kind,
        "force": orbit.force_model,
        "note": orbit.note,
        "steady_from": None if steady is None else float(orbit.t[min(steady, orbit.t.size - 1)]),
        "period": None if recognised is None else recognised.period,
        "amplitude": found.amplitude,
        "whirl": _ellipse(found.whirl),
        "synchronous": _ellipse(found.synchronous),
        "min_film": found.min_film,
        "min_film_time": found.min_film_time,
        "whirl_range": None if found.whirl_range is None else asdict(found.whirl_range),
        "events": [
            {"name": event.name, "time": event.time, "x": event.x, "y": event.y}
            for event in orbit.events
        ],
    }


def _kind(orbit: Orbit) -> str:
    if orbit.constant_speed:
        return "constant speed"
    return "run-up" if orbit.speed[-1] > orbit.speed[0] else "coast-down"


def _ellipse(ellipse: Ellipse | None) -> dict[str, Any] | None:
    if ellipse is None:
        return None
    return {
        "order": ellipse.order,
        "semi_major": ellipse.semi_major,
        "semi_minor": abs(ellipse.semi_minor),
        "inclination": ellipse.inclination,
        "direction": "forward" if ellipse.semi_minor >= 0.0 else "backward",
        "center": list(ellipse.center),
    }


def run_names(orbits: Sequence[Orbit]) -> list[str]:
    """Name `orbits` by thermal model and run, and number them where that is not enough."""
    names: list[str] = []
    for orbit in orbits:
        run = "run_up" if orbit.speed[-1] > orbit.speed[0] else "coast_down"
        base = orbit.thermal_model if orbit.constant_speed else f"{orbit.thermal_model}_{run}"
        name, number = base, 2
        while name in names:
            name, number = f"{base}_{number}", number + 1
        names.append(name)
    return names


def run_title(name: str) -> str:
    """Write a run's name for people."""
    words = name.replace("_", " ").replace("run up", "run-up").replace("coast down", "coast-down")
    return words.replace("thd", "THD")


ORBIT_HEADS = {
    "model": "model",
    "run": "run",
    "clearance": "c",
    "speed": "rpm",
    "turns": "turns",
    "eccentricity": "max ε",
    "growth": "growth 1/s",
    "expected": "expected",
    "outcome": "outcome",
}
"""Heads of the columns of tables of orbits, see `orbit_texts`."""


def orbit_texts(said: Mapping[str, Any]) -> dict[str, str]:
    """Return what `describe_orbit` gives as short texts, by the keys of `ORBIT_HEADS`."""
    first, last = (speed * RPM for speed in said["speed"])
    steady = math.isclose(first, last)
    return {
        "model": said["thermal_model"],
        "run": said["kind"],
        "clearance": _SMALL.text(said["radial_clearance"], 4) + f" {_SMALL.unit}",
        "speed": f"{last:.0f}" if steady else f"{first:.0f} to {last:.0f}",
        "turns": number(said["revolutions"]),
        "eccentricity": number(said["max_eccentricity_ratio"], 3),
        "growth": number(said["growth_rate"]),
        "expected": number(said.get("eigenvalue_growth_rate")),
        "outcome": said["status"].value.replace("_", " "),
    }


def _orbit_rows(said: Mapping[str, Any]) -> list[Row]:
    """Return what an orbit comes to, row by row, from what `describe_orbit` gives."""
    texts = orbit_texts(said)
    rows = [
        Row("run", f"{texts['run']}, {said['force']} film force"),
        Row("shaft speed", texts["speed"], "rpm"),
        Row("turns of the shaft", texts["turns"]),
        Row("largest eccentricity ratio", texts["eccentricity"]),
        Row("growth rate of small motions", texts["growth"], "1/s"),
        Row("whirl frequency ratio", number(said["whirl_frequency_ratio"])),
        Row("amplitude", _SMALL.text(said["amplitude"], 4), _SMALL.unit),
        Row("whirl ellipse", ellipse_text(said["whirl"] or said["synchronous"])),
        Row("thinnest film", _SMALL.text(said["min_film"], 4), _SMALL.unit),
        Row("outcome", texts["outcome"]),
    ]
    return [row for row in rows if row.value != "-"]


def ellipse_text(ellipse: Mapping[str, Any] | None) -> str:
    """Return the half axes in the unit shown and the sense; a dash without an ellipse."""
    if ellipse is None:
        return "-"
    axes = (_SMALL.text(ellipse[key], 3) for key in ("semi_major", "semi_minor"))
    return f"{' x '.join(axes)} {ellipse['direction']}"


def whirl_range_text(found: Mapping[str, Any]) -> str:
    """Describe the speeds between which a run through the speeds whirls, and where most."""
    first, last, most = (
        QUANTITIES["speed"].text(found[key])
        for key in ("first_speed", "last_speed", "strongest_speed")
    )
    return (
        f"whirls by more than {100.0 * WHIRLING:.0f} % of the clearance from {first} to {last} rpm,"
        f" most at {most} rpm: "
        f"{_SMALL.text(found['amplitude'], 3)} {_SMALL.unit} at "
        f"{number(found['frequency'] / (2.0 * math.pi))} Hz"
    )


def orbit_html(orbit: Orbit) -> str:
    """Return the orbit for notebooks; `rotorsim.show.figures.orbits.orbit_plot` draws it."""
    said = describe_orbit(orbit)
    (name,) = run_names([orbit])
    notes = (orbit.message, orbit.note)
    return result_html(f"Orbit: {run_title(name)}", facts_html(_orbit_rows(said)), notes=notes)
