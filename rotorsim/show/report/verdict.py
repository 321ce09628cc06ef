"""Verdict at the head of the report: stability, highest temperature, thinnest film."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...bearing.description import point_title
from ...rows import QUANTITIES, RPM
from . import html

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...bearing.operating_point import OperatingPoint
    from ...study.main_job import Results
    from ...study.stability import StabilityCurve


def headline(found: Results) -> str:
    """Return verdict on the rotor at the highest speed and over all, then the film's extremes."""
    counted = [point for point in found.points if not point.converged]
    gaps = f" {len(counted)} of {len(found.points)} points did not converge." if counted else ""
    text, kind = _verdict(found.curves)
    if gaps and kind == "good":
        kind = ""
    return html.paragraph(
        f"{text}{gaps}{_extremes(found.points)}", f'"verdict {kind}"' if kind else "verdict"
    )


def _verdict(curves: Sequence[StabilityCurve]) -> tuple[str, str]:
    """Return sentences, and the class of their colour."""
    rotor = curves[0].rotor if curves else ""
    if not rotor:
        return "No rotor given: no verdict on it.", ""
    said = {curve.title: curve.verdict or "-" for curve in curves}
    unstable = [name for name, verdict in said.items() if verdict == "unstable"]
    at = f"at {curves[0].speed[-1] * RPM:.0f} rpm with the {rotor}"
    if unstable:
        return f"Unstable {at}: {'; '.join(unstable)}.{_range(curves)}", "bad"
    if "-" in said.values():
        return f"No verdict {at} on every bearing.{_range(curves)}", ""
    overall = {curve.verdict_over_range for curve in curves}
    # Stable at the top and unstable below is no clean bill.
    kind = "good" if overall == {"stable throughout"} else ""
    return f"Stable {at} in every case computed.{_range(curves)}", kind


def _range(curves: Sequence[StabilityCurve]) -> str:
    """Return what happens between the lowest speed and the highest."""
    if len(curves[0].speed) < 2:
        return ""
    span = f"{curves[0].speed[0] * RPM:.0f} to {curves[0].speed[-1] * RPM:.0f} rpm"
    said = [curve.verdict_over_range for curve in curves]
    if set(said) in ({"stable throughout"}, {"unstable throughout"}):
        return f" So it is throughout {span}."
    changes = [
        f"{curve.title} at {', '.join(f'{s * RPM:.0f}' for s in curve.threshold_speeds)} rpm"
        for curve in curves
        if curve.threshold_speeds
    ]
    return f" Over {span} this changes: {'; '.join(changes)}." if changes else ""


def _extremes(points: Sequence[OperatingPoint]) -> str:
    """Return the thinnest film and hottest oil of all converged points, with where they are."""
    known = [point for point in points if point.converged]
    if not known:
        return ""
    thin = min(known, key=lambda point: point.min_film_thickness)
    thinnest, hottest = QUANTITIES["min_film_thickness"], QUANTITIES["max_temperature"]
    text = f" Thinnest film {thinnest.with_unit(thin.min_film_thickness, 3)} ({point_title(thin)})"
    heated = [point for point in known if point.heat_balance is not None]
    if not heated:
        return f"{text}; heating was not computed."
    hot = max(heated, key=lambda point: point.max_temperature)
    return f"{text}, hottest oil {hottest.with_unit(hot.max_temperature, 3)} ({point_title(hot)})."
