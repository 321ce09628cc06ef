"""Force map of the finite-length film, solved once for its L/D and rupture condition and kept.

In the frame of the impedance (see `force_map`) the film is squeezed and nothing else, so the film
solver is called with a shaft at rest. Its error falls with the square of the cell size in smooth
flow, the rupture edge included; two meshes and Richardson's extrapolation leave a few parts in ten
thousand, up to an eccentricity ratio of 0.9995. There the pressure falls to nothing at the ends
over a length of some sqrt(2 (1 - eps)) radii: cells are crowded towards the ends.

A map's file is named after all that its numbers depend on, the text of the modules that solve it
included, and holds a checksum: a damaged or altered file is solved again.

What a map can hold: a plain, aligned, isoviscous film with ambient supply whose beginning is
``free``. With ``max_film`` a line p = 0 stands still in the bush: the film then depends on where
that line lies as well, and must be solved directly (`film_force`).
"""

from __future__ import annotations

import hashlib
import math
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Booleans
from ..atomic import replacing
from ..errors import InputError
from ..film.geometry import film_geometry
from ..film.layers import isoviscous_layers
from ..film.operator import NORTH, SOUTH, face_topology
from ..film.problem import FilmProblem, film_problem, film_state
from ..model import (
    Bearing,
    Case,
    Cavitation,
    EccentricityTarget,
    ExponentialViscosity,
    FilmSettings,
    Inception,
    Lubricant,
    MeshSize,
    ThermalModel,
    ThermalSettings,
)
from .force_map import FilmMapForce, ForceMap

Progress = Callable[[int, int], None]

MAPPED = (Cavitation.REYNOLDS, Cavitation.HALF_SOMMERFELD, Cavitation.FULL_SOMMERFELD)
"""Rupture conditions that are homogeneous of first degree in pressure and know no history."""
_ROWS, _COLUMNS, _MAX_ECCENTRICITY_RATIO = 44, 112, 0.9995
_MESH, _THIN_MESH = (256, 24), (192, 36)
_THIN = 0.8
"""Eccentricity ratio above which the pressure's boundary layers at the ends need `_THIN_MESH`."""
_CROWDING = 2.5
"""Cells of `_THIN_MESH` along the axis: distance from the end as this power of their number."""
_CLEARANCE = 1e-3


def film_force_map(
    length_to_diameter: float,
    cavitation: Cavitation | str = Cavitation.REYNOLDS,
    *,
    leakage: float | None = None,
    cache: Path | None = None,
    progress: Progress | None = None,
) -> ForceMap:
    """Return map of a plain bearing's film; read from the cache where it has been solved before.

    length_to_diameter : L/D [-]; maps are kept for L/D rounded to six digits.
    cavitation : ``reynolds``, ``half_sommerfeld`` or ``full_sommerfeld``.
    leakage : Of seals at the ends: their conductance for each length of the rim, times 12 mu L/c^3
        [-]. Default: open ends.
    cache : Folder of the kept maps. Default: `cache_folder()`.
    progress : Called with rows done and rows in all while the map is solved (some ten seconds).

    Raises InputError: A rupture condition that no map can hold.
    """
    kind = Cavitation(cavitation)
    if kind not in MAPPED:
        raise InputError(
            f"no map holds this film; it needs {', '.join(MAPPED)}",
            key="film.cavitation",
            value=kind.value,
        )
    ratio = float(f"{length_to_diameter:.6g}")
    if leakage is not None and not 1e-6 < leakage < 1e6:
        raise InputError(
            "the end seals' conductance is out of range", key="end_seal", value=leakage
        )
    film = SqueezeFilm(ratio, kind, leakage=leakage)
    return _kept_map(film, cache or cache_folder(), progress)


def cache_folder() -> Path:
    """Return folder for what can be computed again: ROTORSIM_CACHE, or the system's usual place."""
    chosen = os.environ.get("ROTORSIM_CACHE")
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local"
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "rotorsim"


def map_path(
    length_to_diameter: float, cavitation: Cavitation, folder: Path, leakage: float | None = None
) -> Path:
    """Return the file of one map; its name holds everything that the numbers depend on."""
    settings = (
        sources_digest(), length_to_diameter, cavitation.value, _ROWS, _COLUMNS,
        _MAX_ECCENTRICITY_RATIO, _MESH, _THIN_MESH, _THIN, _CROWDING, leakage,
    )  # fmt: skip
    key = hashlib.sha256(repr(settings).encode()).hexdigest()[:12]
    return folder / f"force_map_{cavitation.value}_{length_to_diameter:g}_{key}.npz"


@lru_cache(maxsize=1)
def sources_digest() -> str:
    """Return SHA-256 of the modules that a map's numbers come from.

    The film, the model and the map.
    """
    package = Path(__file__).parents[1]
    files = [*package.glob("film/**/*.py"), *package.glob("model/*.py")]
    files += [package / "orbit" / name for name in ("film_map.py", "force_map.py", "kernels.py")]
    digest = hashlib.sha256()
    for file in sorted(files):
        digest.update(file.relative_to(package).as_posix().encode())
        digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()


_in_memory: dict[Path, tuple[int, ForceMap]] = {}
"""Maps of this process with the time at which their file was written."""


def _kept_map(film: SqueezeFilm, folder: Path, progress: Progress | None) -> ForceMap:
    path = map_path(film.length_to_diameter, film.cavitation, folder, film.leakage)
    written = _written(path)
    if written is not None:
        held = _in_memory.get(path)
        found = held[1] if held is not None and held[0] == written else read_map(path)
        if found is not None:
            _in_memory[path] = written, found
            return found
    made = ForceMap.build(
        film.impedance,
        max_eccentricity_ratio=_MAX_ECCENTRICITY_RATIO,
        rows=_ROWS,
        columns=_COLUMNS,
        progress=progress,
    )
    if written is not None:
        made = replace(made, note=f"the map kept in {path.name} was damaged and is solved again")
    # a folder that cannot be written costs time at the next run, nothing else
    with suppress(OSError):
        write_map(path, made)
        _in_memory[path] = path.stat().st_mtime_ns, made
    return made


def _written(path: Path) -> int | None:
    """Return the time of a file's last change [ns]; None where there is none."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return None


def write_map(path: Path, force_map: ForceMap) -> None:
    """Write a map, whole or not at all."""
    with replacing(path) as temporary:
        np.savez(
            temporary,
            coefficients=force_map.coefficients,
            numbers=force_map.numbers,
            checksum=_checksum(force_map.coefficients, force_map.numbers),
        )


def _checksum(coefficients: Array, numbers: Array) -> NDArray[np.uint8]:
    """Return SHA-256 of a map's arrays, shapes included, as 32 bytes."""
    digest = hashlib.sha256(repr((coefficients.shape, numbers.shape)).encode())
    for values in (coefficients, numbers):
        digest.update(np.ascontiguousarray(values, dtype="<f8").tobytes())
    return np.frombuffer(digest.digest(), dtype=np.uint8)


def read_map(path: Path) -> ForceMap | None:
    """Read a map; None where the file is missing, damaged, altered or of another kind."""
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            coefficients, numbers, checksum = (
                file[name] for name in ("coefficients", "numbers", "checksum")
            )
    except (OSError, ValueError, KeyError, EOFError, TypeError, AttributeError, BadZipFile):
        return None
    shape_right = coefficients.ndim == 3 and coefficients.shape[0] == 2 and numbers.shape == (4,)
    if not shape_right or coefficients.dtype != float or numbers.dtype != float:
        return None
    if not (np.isfinite(coefficients).all() and np.isfinite(numbers).all()):
        return None
    if not np.array_equal(checksum, _checksum(coefficients, numbers)):
        return None
    first, step, last, central = map(float, numbers)
    return ForceMap(np.ascontiguousarray(coefficients), first, step, last, central)


@dataclass
class SqueezeFilm:
    """Impedance of the finite film from the film solver, extrapolated from two meshes.

    mesh : (int, int), optional. Cells around and along; default: as fine as the maps need.
    leakage : See `film_force_map`.
    """

    length_to_diameter: float
    cavitation: Cavitation
    mesh: tuple[int, int] | None = None
    leakage: float | None = None
    _films: tuple[_RestingFilm, ...] = field(default=(), init=False, repr=False)

    def impedance(self, eccentricity_ratio: float, angle: float) -> tuple[float, float]:
        """Return the radial and tangential impedance (see `rotorsim.orbit.force_map`)."""
        if not self._films or self._films[0].eccentricity_ratio != eccentricity_ratio:
            thin = eccentricity_ratio > _THIN
            around, along = self.mesh or (_THIN_MESH if thin else _MESH)
            self._films = tuple(
                _RestingFilm.of(self, eccentricity_ratio, (around // k, along // k)) for k in (1, 2)
            )
        fine, coarse = (film.impedance(angle) for film in self._films)
        radial, tangential = (4.0 * fine - coarse) / 3.0
        return float(radial), float(tangential)


class _RestingFilm:
    """One mesh at one eccentricity; each call starts from the full cells of the one before."""

    def __init__(self, case: Case, eccentricity_ratio: float, leakage: float | None) -> None:
        self.eccentricity_ratio = eccentricity_ratio
        self.position = (eccentricity_ratio * _CLEARANCE, 0.0)
        self.problem = film_problem(case, 0.0, case.bearing, self.position)
        if eccentricity_ratio > _THIN:
            self.problem = _crowded(self.problem)
        if leakage is not None:
            self.problem = _sealed(self.problem, self.position, leakage)
        self.layers = isoviscous_layers(self.problem.mesh.shape, 1.0)
        # F = 2 mu |v_s| L (R/c)^3 W with mu = |v_s| = R = 1
        self.scale = 2.0 * case.bearing.length / _CLEARANCE**3
        self.full: Booleans | None = None

    @classmethod
    def of(
        cls, film: SqueezeFilm, eccentricity_ratio: float, mesh: tuple[int, int]
    ) -> _RestingFilm:
        case = Case(
            bearing=Bearing(1.0, 2.0 * film.length_to_diameter, _CLEARANCE),
            lubricant=Lubricant(ExponentialViscosity(1.0, 313.15, 0.0), 1.0, 1.0, 1.0),
            film=FilmSettings(film.cavitation, Inception.FREE, MeshSize(*mesh)),
            thermal=ThermalSettings(model=ThermalModel.ISOTHERMAL),
            target=EccentricityTarget(0.5),
        )
        return cls(case, eccentricity_ratio, film.leakage)

    def impedance(self, angle: float) -> Array:
        velocity = (math.cos(angle), math.sin(angle))
        state = film_state(
            self.problem, self.position, self.layers, velocity=velocity, start=self.full
        )
        self.full = state.solution.full
        return state.force / self.scale


def squeezed_film(
    force: FilmMapForce, x: float, y: float, vx: float, vy: float
) -> tuple[Array, Array, Array] | None:
    """Return angles (n,) [rad], places along (m,) [m] and pressure (n, m) [Pa] of a mapped film.

    x, y, vx, vy : Position and squeeze velocity of the journal [m, m/s].

    On a coarse mesh with open ends, for pictures; None where the film cannot be solved.
    """
    eccentricity = min(math.hypot(x, y) / force.radial_clearance, 0.99)
    angle = math.atan2(y, x)
    ratio = 0.5 * force.length / force.radius
    film = _RestingFilm.of(SqueezeFilm(ratio, Cavitation.REYNOLDS), eccentricity, (96, 16))
    cos, sin = math.cos(angle), math.sin(angle)
    try:
        state = film_state(
            film.problem, film.position, film.layers,
            velocity=(vx * cos + vy * sin, vy * cos - vx * sin),
        )  # fmt: skip
    except ArithmeticError:
        return None
    mesh = film.problem.mesh
    scale = force.viscosity * (force.radius**2 / force.radial_clearance**3) * _CLEARANCE**3
    pressure = mesh.whole(state.solution.pressure) * scale
    return mesh.theta + angle, mesh.whole_y * force.radius, pressure


def _sealed(problem: FilmProblem, position: tuple[float, float], leakage: float) -> FilmProblem:
    """Return the film with seals at its ends: in series with the last half cells, as a length more.

    A length s of film lets h^3/(12 mu s) pass, the seal leakage c^3/(12 mu L).
    """
    height = problem.geometry.thickness(np.array(position))[1 + NORTH, :, -1]
    bearing, spacing = problem.bearing, problem.topology.spacing.copy()
    longer = (height / bearing.radial_clearance) ** 3 * bearing.length / leakage
    spacing[NORTH, :, -1] += longer
    if not problem.mesh.half:
        spacing[SOUTH, :, 0] += longer
    return replace(problem, topology=replace(problem.topology, spacing=spacing))


def _crowded(problem: FilmProblem) -> FilmProblem:
    """Return the film on a mesh whose cells crowd towards the bearing's end, p = 0 all round it."""
    mesh = problem.mesh
    half = float(mesh.y_faces[-1])
    mesh = replace(mesh, y_faces=half * (1.0 - (1.0 - mesh.y_faces / half) ** _CROWDING))
    return replace(
        problem,
        mesh=mesh,
        topology=face_topology(mesh, np.zeros(1)),
        geometry=film_geometry(problem.bearing, mesh),
    )
