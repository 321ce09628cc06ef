"""Results of a machine's motion in time: plain data, orbits of its stations, films."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ..arrays import Array
from ..film.geometry import pad_unknowns
from ..model import Bearing
from ..orbit.analysis import recognise
from ..orbit.description import describe_orbit
from ..orbit.film_force import SolvedFilmForce
from ..orbit.film_map import squeezed_film
from ..orbit.force_map import FilmMapForce
from ..orbit.forces import ShortBearingForce
from ..orbit.motion import Motion
from ..orbit.orbit import Orbit, OrbitStatus
from ..orbit.system import Link
from .orbits import FilmFrame

_SHOWN_TURNS, _SHOWN_FRAMES = 8, 40
"""Turns at the end whose films are shown eight times each, and moments over the whole run."""


def labelled(motion: Motion, name: str) -> Orbit:
    """Return the orbit of a station, which figures and recordings call by the station's name."""
    orbit = motion.orbit(name)
    if orbit.constant_speed and orbit.status is OrbitStatus.COMPLETED:
        found = recognise(orbit)
        orbit = replace(orbit, status=found.status, message=found.message)
    return replace(orbit, thermal_model="_".join(name.split()))


def motion_document(motion: Motion) -> dict[str, Any]:
    """Return motion of a machine as plain data (SI); its stations as `describe_orbit` has them."""
    problem = motion.problem
    rows = []
    for one in motion.stations:
        row = describe_orbit(labelled(motion, one.name))
        row["thermal_model"] = problem.thermal_model
        if one.link is None:
            # a free shaft has no clearance
            row |= dict.fromkeys(("max_eccentricity_ratio", "radial_clearance", "min_film"))
        position = one.position if math.isfinite(one.position) else None
        rows.append({"station": one.name, "position": position, "film": one.link is not None} | row)
    rings = {
        link.name: float(motion.v[-1, link.ring])
        for link in problem.system.links
        if link.ring >= 0 and link.side > 0.0 and motion.t.size
    }
    return {
        "kind": problem.kind,
        "speed": [float(motion.speed[0]), float(motion.speed[-1])],
        "duration": float(motion.t[-1]),
        "revolutions": float(motion.revolutions[-1]),
        "status": motion.status,
        "message": motion.message,
        "note": problem.note,
        "unknowns": problem.system.size,
        "reduction_error": problem.reduction_error,
        "ring_speeds": rings,
        "actuators": _actuators(motion),
        "stations": rows,
    }


def _actuators(motion: Motion) -> list[dict[str, Any]]:
    """Return each actuator's largest force and the share of the run in which it saturates."""
    loop = motion.problem.loop
    if loop is None or not motion.t.size:
        return []
    size = np.abs(motion.actuator_force)
    full = size >= (1.0 - 1e-9) * loop.feedback.max_force
    return [
        {"signal": name, "largest_force": float(size[:, k].max()),
         "saturated": float(full[:, k].mean())}
        for k, name in enumerate(loop.feedback.actuators)
    ]  # fmt: skip


def films_in_motion(motion: Motion) -> list[FilmFrame]:
    """Return the pressure of each nonlinear film along the run, some moments of it.

    Of closed forms and maps the pressure is that of a film of the same length solved for the
    journal's position and velocity.
    """
    frames = []
    for k, link in enumerate(motion.problem.system.links):
        if link.film:
            name = motion.stations_of(k)
            frames += _film_frames(motion, link, "_".join(name.split()))
    return frames


def _film_frames(motion: Motion, link: Link, name: str) -> list[FilmFrame]:
    force = link.force
    turn, count = motion.problem.samples_per_revolution, motion.t.size
    last = np.arange(max(count - _SHOWN_TURNS * turn, 0), count, max(1, turn // 8))
    rows = np.unique(np.concatenate([np.linspace(0, count - 1, _SHOWN_FRAMES).astype(int), last]))
    path, frames = link.motion(motion.q[rows], motion.v[rows], motion.speed[rows]), []
    theta, stand = 2.0 * np.pi * (np.arange(96) + 0.5) / 96, {}
    for row, (x, y, vx, vy, speed) in zip(rows, path, strict=True):
        if isinstance(force, ShortBearingForce):
            half = 0.5 * force.length
            along = half * ((np.arange(16) + 0.5) / 8.0 - 1.0)
            h = force.radial_clearance - x * np.cos(theta) - y * np.sin(theta)
            rate = (0.5 * speed * y + vx) * np.cos(theta) + (vy - 0.5 * speed * x) * np.sin(theta)
            line = 6.0 * force.viscosity * rate / h**3
            pressure = np.maximum(line[:, None] * (half**2 - along[None] ** 2),
                                  0.0 if force.ruptured else -math.inf)  # fmt: skip
            radius = force.radius
        elif isinstance(force, FilmMapForce):
            solved = squeezed_film(force, x, y, vx + 0.5 * speed * y, vy - 0.5 * speed * x)
            if solved is None:
                continue
            theta, along, pressure = solved
            radius = force.radius
        elif isinstance(force, SolvedFilmForce):
            own = np.array([x, y, *motion.q[row, list(link.pads)]])
            rate = np.array([vx, vy, *motion.v[row, list(link.pads)]])
            try:
                state = force.film(own, rate, float(speed))
            except ArithmeticError:
                continue
            mesh = state.problem.mesh
            theta = mesh.theta + force.frame
            along, pressure = mesh.whole_y, mesh.whole(state.solution.pressure)
            radius = force.bearing.journal_radius
            if force.pads:
                stand = _pads_of(force.bearing, own)
        else:
            return []
        frames.append(
            FilmFrame(
                thermal_model=name, speed=float(motion.speed[row]), theta=theta,
                y=np.asarray(along, dtype=float),
                pressure=pressure, temperature=None, max_temperature=None, journal_radius=radius,
                radial_clearance=force.radial_clearance, centre=np.array([x, y]),
                time=float(motion.t[row]), **stand,
            )
        )  # fmt: skip
    return frames


def _pads_of(bearing: Bearing, q: Array) -> dict[str, Any]:
    """Return what a `FilmFrame` shows of pads, from the displacements of journal and pads."""
    places = pad_unknowns(bearing)[1]
    pivots = tuple(0.0 if one.pivot is None else float(q[one.pivot]) for one in places)
    return {"bearing": bearing, "tilts": tuple(float(q[one.tilt]) for one in places),
            "pivots": pivots}  # fmt: skip
