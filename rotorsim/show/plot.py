"""One way to draw any result: `plot`."""

from __future__ import annotations

from functools import singledispatch
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..bearing.operating_point import OperatingPoint
from ..bearing.table import CoefficientTable
from ..errors import InputError
from ..files.machine import MachineFile
from ..machine.branches import Modes
from ..machine.map import StabilityMap
from ..orbit.motion import Motion
from ..orbit.orbit import Orbit
from ..study.hot_spot import HotSpotStudy
from ..study.machine import MachineResult
from ..study.transient import Transient
from . import figures
from .figures.machine_response import hot_spot_loop
from .figures.orbits import orbit_path


@singledispatch
def plot(result: Any, title: str = "", ax: Axes | None = None) -> Figure:
    """Draw a result as its figure among those of `rotorsim run`.

    An operating point: its film's pressure and temperature; a table: the coefficients; an orbit or
    a machine's motion; modes over speed; a stability map; a machine's file: the rotor to scale, its
    result: growth rates; a thermal transient; hot spots.

    Parameters
    ----------
    result : OperatingPoint, CoefficientTable, Orbit, Modes, StabilityMap, ...
    title : str, optional
    ax : matplotlib Axes, optional
        To draw into, where the figure has one axes alone.

    Raises
    ------
    InputError
        Nothing is drawn of such an object, or its figure has several axes and `ax` is given.
    """
    del title, ax
    raise InputError(
        f"must be one of {', '.join(sorted(kind.__name__ for kind in _KINDS))}",
        key="result", value=type(result).__name__,
    )  # fmt: skip


def _alone(ax: Axes | None) -> None:
    if ax is not None:
        raise InputError("does not go with this result: its figure has several axes", key="ax")


@plot.register
def _(result: OperatingPoint, title: str = "", ax: Axes | None = None) -> Figure:
    _alone(ax)
    if result.fields is None:
        raise InputError("has no fields: rotorsim.solve keeps them, tables do not", key="result")
    return figures.film_maps([result], title)


@plot.register
def _(result: CoefficientTable, title: str = "", ax: Axes | None = None) -> Figure:
    _alone(ax)
    return figures.coefficients_over_speed(result, title)


@plot.register
def _(result: Orbit, title: str = "", ax: Axes | None = None) -> Figure:
    if ax is not None:
        return orbit_path(result, title, ax)
    return figures.orbit_plot([result], title)


@plot.register
def _(result: Motion, title: str = "", ax: Axes | None = None) -> Figure:
    _alone(ax)
    names = [one.name for one in result.stations]
    return figures.orbit_plot([result.orbit(name) for name in names], title, names=names)


@plot.register
def _(result: Modes, title: str = "", ax: Axes | None = None) -> Figure:
    return figures.machine_campbell(result, title=title, ax=ax)


@plot.register
def _(result: StabilityMap, title: str = "", ax: Axes | None = None) -> Figure:
    return figures.stability_map(result.plane("speed", "mass"), title=title, ax=ax)


@plot.register
def _(result: MachineFile, title: str = "", ax: Axes | None = None) -> Figure:
    return figures.rotor_drawing(result, title or result.title, ax)


@plot.register
def _(result: MachineResult, title: str = "", ax: Axes | None = None) -> Figure:
    if result.modes is None:
        raise InputError("has no speed at which all supports are known", key="result")
    name = result.thermal_model
    return figures.growth_over_speed({name: result.modes}, {name: result.thresholds}, title, ax)


@plot.register
def _(result: Transient, title: str = "", ax: Axes | None = None) -> Figure:
    _alone(ax)
    return figures.transient_plot(result, title)


@plot.register
def _(result: HotSpotStudy, title: str = "", ax: Axes | None = None) -> Figure:
    _alone(ax)
    return hot_spot_loop(result, title)


_KINDS = [kind for kind in plot.registry if kind is not object]
