"""Force map of the finite-length film, solved once for its L/D and rupture condition and kept.

In the frame of the impedance (see `force_map`) the film is squeezed and nothing else, so the film
solver is called with a shaft at rest. Its error falls with the square of the cell size in smooth
flow, the rupture edge included; two meshes and Richardson's extrapolation leave a few parts in ten
thousand.

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
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from .. import __version__
from ..atomic import replacing
from ..errors import InputError
from ..film.layers import isoviscous_layers
from ..film.problem import film_problem, film_state
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
from .force_map import ForceMap

Array = NDArray[np.float64]
Progress = Callable[[int, int], None]

MAP_VERSION = 1
"""Raise it whenever the map's numbers change within a version: older files are passed over."""
MAPPED = (Cavitation.REYNOLDS, Cavitation.HALF_SOMMERFELD)
"""Rupture conditions that are homogeneous of first degree in pressure and know no history."""
_ROWS, _COLUMNS, _MAX_ECCENTRICITY_RATIO = 41, 96, 0.98
_MESH, _THIN_MESH = (256, 24), (256, 48)
_THIN = 0.8
"""Eccentricity ratio above which the pressure's boundary layers at the ends need `_THIN_MESH`."""
_CLEARANCE = 1e-3


def film_force_map(
    length_to_diameter: float,
    cavitation: Cavitation | str = Cavitation.REYNOLDS,
    *,
    cache: Path | None = None,
    progress: Progress | None = None,
) -> ForceMap:
    """Map of a plain bearing's film; read from the cache where it has been solved before.

    Parameters
    ----------
    length_to_diameter : float
        L/D [-]; maps are kept for L/D rounded to six digits.
    cavitation : Cavitation
        ``reynolds`` or ``half_sommerfeld``.
    cache : Path, optional
        Folder of the kept maps. Default: `cache_folder()`.
    progress : callable, optional
        Called with rows done and rows in all while the map is solved (some ten seconds).

    Raises
    ------
    InputError
        A rupture condition that no map can hold.
    """
    kind = Cavitation(cavitation)
    if kind not in MAPPED:
        raise InputError(
            'no map holds this film; it needs "reynolds" or "half_sommerfeld"',
            key="film.cavitation",
            value=kind.value,
        )
    ratio = float(f"{length_to_diameter:.6g}")
    return _kept_map(ratio, kind, cache or cache_folder(), progress)


def cache_folder() -> Path:
    """Folder for what can be computed again: ROTORSIM_CACHE, or the system's usual place."""
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


def map_path(length_to_diameter: float, cavitation: Cavitation, folder: Path) -> Path:
    """File of one map; its name holds everything that the numbers depend on."""
    settings = (
        __version__, MAP_VERSION, length_to_diameter, cavitation.value, _ROWS, _COLUMNS,
        _MAX_ECCENTRICITY_RATIO, _MESH, _THIN_MESH, _THIN,
    )  # fmt: skip
    key = hashlib.sha256(repr(settings).encode()).hexdigest()[:12]
    return folder / f"force_map_{cavitation.value}_{length_to_diameter:g}_{key}.npz"


@lru_cache(maxsize=16)
def _in_memory(path: Path, _changed: int) -> ForceMap | None:
    return read_map(path)


def _kept_map(
    ratio: float, cavitation: Cavitation, folder: Path, progress: Progress | None
) -> ForceMap:
    path = map_path(ratio, cavitation, folder)
    try:
        found = _in_memory(path, path.stat().st_mtime_ns)
    except OSError:
        found = None
    if found is not None:
        return found
    made = ForceMap.build(
        SqueezeFilm(ratio, cavitation).impedance,
        max_eccentricity_ratio=_MAX_ECCENTRICITY_RATIO,
        rows=_ROWS,
        columns=_COLUMNS,
        progress=progress,
    )
    # a folder that cannot be written costs time at the next run, nothing else
    with suppress(OSError):
        write_map(path, made)
    return made


def write_map(path: Path, force_map: ForceMap) -> None:
    """Write a map, whole or not at all."""
    with replacing(path) as temporary:
        np.savez(temporary, coefficients=force_map.coefficients, numbers=force_map.numbers)


def read_map(path: Path) -> ForceMap | None:
    """Read a map; None where the file is missing, damaged or of another kind."""
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            coefficients, numbers = file["coefficients"], file["numbers"]
    except (OSError, ValueError, KeyError, EOFError, TypeError, AttributeError, BadZipFile):
        return None
    shape_right = coefficients.ndim == 3 and coefficients.shape[0] == 2 and numbers.shape == (4,)
    if not shape_right or coefficients.dtype != float or numbers.dtype != float:
        return None
    if not (np.isfinite(coefficients).all() and np.isfinite(numbers).all()):
        return None
    return ForceMap(np.ascontiguousarray(coefficients), *map(float, numbers))


@dataclass
class SqueezeFilm:
    """Impedance of the finite film from the film solver, extrapolated from two meshes.

    Parameters
    ----------
    length_to_diameter : float
    cavitation : Cavitation
    mesh : (int, int), optional
        Cells around and along; default: as fine as the maps need.
    """

    length_to_diameter: float
    cavitation: Cavitation
    mesh: tuple[int, int] | None = None
    _films: tuple[_RestingFilm, ...] = field(default=(), init=False, repr=False)

    def impedance(self, eccentricity_ratio: float, angle: float) -> tuple[float, float]:
        """Radial and tangential impedance (see `force_map.Impedance`)."""
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

    def __init__(self, case: Case, eccentricity_ratio: float) -> None:
        self.eccentricity_ratio = eccentricity_ratio
        self.position = (eccentricity_ratio * _CLEARANCE, 0.0)
        self.problem = film_problem(case, 0.0, case.bearing, self.position)
        self.layers = isoviscous_layers(self.problem.mesh.shape, 1.0)
        # F = 2 mu |v_s| L (R/c)^3 W with mu = |v_s| = R = 1
        self.scale = 2.0 * case.bearing.length / _CLEARANCE**3
        self.full: NDArray[np.bool_] | None = None

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
        return cls(case, eccentricity_ratio)

    def impedance(self, angle: float) -> Array:
        velocity = (math.cos(angle), math.sin(angle))
        state = film_state(
            self.problem, self.position, self.layers, velocity=velocity, start=self.full
        )
        self.full = state.solution.full
        return state.force / self.scale
