"""What a recording shows: results, SI, in the load frame; units change where a value is written."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from ...orbit import Orbit
from ...study.orbits import FilmFrame
from ...study.stability import Campbell
from .charts import Chart, cascade_charts, eigenvalue_chart, map_chart, spectrum_chart
from .runs import Run, runs_of

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class RecordingContents:
    """Everything that one recording shows; what is empty leaves its view out.

    title, summary : The summary in Markdown.
    kind : Of the scenario's orbit (``run_up``, ``step``, ...): decides what the overview shows.
        Empty: the whole job, from film to map.
    films : Frames of one thermal model form one animation.
    modes : Of the rotor over speed.
    maps : tuple of xarray.Dataset. Stability maps over speed and mass (see
        `rotorsim.machine.map.StabilityMap.plane`).
    rotor_mass : Per bearing [kg]: height of the moving point on the maps.
    """

    title: str
    summary: str = ""
    kind: str = ""
    orbits: tuple[Orbit, ...] = ()
    films: tuple[FilmFrame, ...] = ()
    modes: tuple[Campbell, ...] = ()
    maps: tuple[xr.Dataset, ...] = ()
    rotor_mass: float | None = None

    @cached_property
    def runs(self) -> list[Run]:
        """Orbits with their names."""
        return runs_of(self.orbits)

    @cached_property
    def map_charts(self) -> list[Chart]:
        """One for each map."""
        return [map_chart(plane, number) for number, plane in enumerate(self.maps)]

    @cached_property
    def eigenvalue_chart(self) -> Chart | None:
        """Complex plane; None without modes."""
        return eigenvalue_chart(self.modes) if self.modes else None

    @cached_property
    def spectrum_chart(self) -> Chart | None:
        """Spectra of runs at constant speed; None without any."""
        return spectrum_chart(self.runs)

    @cached_property
    def cascade_charts(self) -> list[Chart]:
        """Spectra over speed of each run through the speeds."""
        return cascade_charts(self.runs)
