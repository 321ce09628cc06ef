"""The paper's figures, drawn from our results."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..model.lubricant import ZERO_CELSIUS
from .fields import profile
from .paper import CLEARANCES, OIL, Walls
from .results import ISOTHERMAL, LIQUID, THD, WHOLE, PaperResults, Run, quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..show.figures.paper import Line, Panel

SPEED = "shaft speed [rpm]"
NAMES = {ISOTHERMAL: "isothermal", THD: "THD"}
WALL_NAMES = {
    Walls.AMBIENT: "walls at ambient temperature",
    Walls.CONDUCTION: "bush conduction, shaft ambient",
    Walls.CONDUCTION_SHAFT: "bush conduction, shaft without net heat",
    Walls.INSULATED: "both walls insulated",
}


@dataclass(frozen=True)
class NamedFigure:
    """A figure with its file name and caption."""

    name: str
    caption: str
    figure: Figure


def paper_figures(r: PaperResults) -> list[NamedFigure]:
    """Figures 2 to 8, and one of the walls."""
    from ..show.figures.paper import panels

    content = (
        ("fig2", _figure_2(r), 2, "Fig. 2: peak pressure and temperature against eccentricity "
         "ratio, c = 145 um. The paper states no speed; two are drawn, with both kinds of wall."),
        ("fig3", _figure_3(r), 3, "Fig. 3: mid-plane pressure and temperature (hottest layer) "
         "from maximum film thickness in the direction of rotation, c = 100 um; viscosity."),
        ("fig4", _figure_4(r), 2, "Fig. 4: peak pressure and temperature."),
        ("fig5", _figure_5(r), 3, "Fig. 5: film force, friction (whole: over the whole ruptured "
         "sector; otherwise over its oil) and power loss."),
        ("fig6", _coefficients(r, "k"), 2, "Fig. 6: stiffness in the load frame."),
        ("fig7", _coefficients(r, "c"), 2, "Fig. 7: damping in the load frame."),
        ("fig8", _figure_8(r), 3, "Fig. 8: critical mass, dimensionless and in kilograms, and "
         "whirl frequency ratio."),
        ("walls", _figure_walls(r), 3, "Both readings of the walls, c = 100 um."),
    )  # fmt: skip
    return [
        NamedFigure(name, caption, panels(found, columns))
        for name, found, columns, caption in content
    ]


def _curve(r: PaperResults, name: str, scale: float = 1.0, friction: str = LIQUID) -> list[Line]:
    """One line for each model and clearance."""
    from ..show.figures.paper import Line

    lines = []
    for colour, model in enumerate((ISOTHERMAL, THD)):
        for place, clearance in enumerate(CLEARANCES):
            run = Run(model, clearance, friction=friction)
            label = f"{NAMES[model]}, c = {clearance * 1e6:.0f} um"
            lines.append(
                Line(
                    r.speeds(run), scale * r.values(name, run), label, colour,
                    dashes=1 - colour, marker=place, strength=1.0 - 0.25 * place,
                )
            )  # fmt: skip
    return lines


def _panel(title: str, label: str, lines: list[Line], **options) -> Panel:
    from ..show.figures.paper import Panel

    return Panel(title, SPEED, label, lines, tick=5000.0, **options)


def _figure_2(r: PaperResults) -> list[Panel]:
    from ..show.figures.paper import Line, Panel

    found = []
    for title, label, name, scale in (
        ("a) peak pressure", "peak pressure [MPa]", "max_pressure", 1e-6),
        ("b) peak temperature", "peak temperature [°C]", "temperature", 1.0),
    ):
        lines = []
        for (walls, rpm), points in r.validation.items():
            eps = np.array([point.eccentricity_ratio for point in points])
            values = [scale * quantity(point, name) for point in points]
            lines.append(
                Line(
                    eps, np.array(values), f"{rpm:.0f} rpm, {WALL_NAMES[walls]}",
                    colour=int(walls is not Walls.AMBIENT), dashes=int(rpm < 3000.0),
                    marker=int(rpm < 3000.0),
                )
            )  # fmt: skip
        log = name == "max_pressure"
        found.append(Panel(title, "eccentricity ratio [-]", label, lines, logarithmic=log))
    return found


def _figure_3(r: PaperResults) -> list[Panel]:
    from ..show.figures.paper import Line, Panel

    speeds = sorted({rpm for _, rpm in r.films})
    pressure, heat = [], []
    for number, rpm in enumerate(speeds):
        for model in (ISOTHERMAL, THD):
            if not r.films[model, rpm].converged:
                continue
            angle, p, _, hottest = profile(r, model, rpm)
            dashes = int(model == ISOTHERMAL)
            label = f"{NAMES[model]}, {rpm:.0f} rpm"
            line = Line(angle, p * 1e-6, label, number, dashes)
            pressure.append(line)
            if model == THD:
                heat.append(Line(angle, hottest, label, number, dashes))
    kelvin = np.linspace(40.0, 100.0, 61) + ZERO_CELSIUS
    oil = [
        Line(kelvin - ZERO_CELSIUS, 1e3 * OIL.viscosity(kelvin), "0.034 per kelvin (used)", 0),
        Line(
            kelvin - ZERO_CELSIUS,
            1e3 * 0.0277 * np.exp(-0.034 * ((kelvin - ZERO_CELSIUS) / 40.0 - 1.0)),
            "Eq. 15 as printed, degC", 0, 2,
        ),
    ]  # fmt: skip
    theta = "angle from maximum film thickness [deg]"
    # The text gives two temperatures without their angle: marked where it says that it is hot.
    printed = [(270.0, 45.0), (270.0, 90.0)]
    return [
        Panel("a) pressure", theta, "mid-plane pressure [MPa]", pressure, tick=90.0),
        Panel("b) temperature", theta, "hottest layer [°C]", heat, printed, tick=90.0),
        Panel(
            "c) viscosity",
            "temperature [°C]",
            "viscosity [mPa s]",
            oil,
            from_zero=True,
            own_legend=True,
        ),
    ]


def _figure_4(r: PaperResults) -> list[Panel]:
    return [
        _panel(
            "a) peak pressure", "peak pressure [MPa]", _curve(r, "max_pressure", 1e-6),
            from_zero=True,
        ),
        _panel(
            "b) peak temperature", "peak temperature [°C]", _curve(r, "temperature")[3:],
            printed=[(15000.0, 72.0)],
        ),
    ]  # fmt: skip


def _figure_5(r: PaperResults) -> list[Panel]:
    whole = [
        replace(line, dashes=2, marker=-1, label=f"{NAMES[model]}, c = 100 um, whole sector")
        for line, model in zip(
            _curve(r, "friction_force", friction=WHOLE)[::3], (ISOTHERMAL, THD), strict=True
        )
    ]
    return [
        _panel(
            "a) film force", "film force [kN]", _curve(r, "load", 1e-3),
            printed=[(15000.0, 30.0), (15000.0, 20.0)], from_zero=True,
        ),
        _panel(
            "b) friction", "friction [N]", [*_curve(r, "friction_force"), *whole],
            printed=[(15000.0, 640.0), (15000.0, 640.0 * 0.55)], from_zero=True,
        ),
        _panel("c) power loss", "power loss [kW]", _curve(r, "power_loss", 1e-3), from_zero=True),
    ]  # fmt: skip


def _coefficients(r: PaperResults, letter: str) -> list[Panel]:
    scale, unit = (1e-9, "GN/m") if letter == "k" else (1e-6, "MN s/m")
    found = []
    for order, pair in zip("abcd", ("xx", "xy", "yx", "yy"), strict=True):
        symbol = f"{letter}$_{{{pair}}}$"
        lines = _curve(r, letter + pair, scale)
        found.append(_panel(f"{order}) {symbol}", f"{symbol} [{unit}]", lines))
    return found


def _figure_8(r: PaperResults) -> list[Panel]:
    return [
        _panel("a) critical mass", "M c ω²/W [-]", _curve(r, "critical_mass_dimensionless")),
        _panel("a') the same in kg", "critical mass [kg]", _curve(r, "critical_mass"),
               logarithmic=True),
        _panel("b) whirl", "whirl frequency ratio [-]", _curve(r, "whirl_frequency_ratio")),
    ]  # fmt: skip


def _figure_walls(r: PaperResults) -> list[Panel]:
    from ..show.figures.paper import Line

    runs = {
        "isothermal": Run(ISOTHERMAL, CLEARANCES[0]),
        **{name: Run(THD, CLEARANCES[0], wall) for wall, name in WALL_NAMES.items()},
    }
    found = []
    for title, label, name, scale in (
        ("peak temperature", "peak temperature [°C]", "temperature", 1.0),
        ("film force", "film force [kN]", "load", 1e-3),
        ("critical mass", "critical mass [kg]", "critical_mass", 1.0),
    ):
        lines = [
            Line(r.speeds(run), scale * r.values(name, run), text, colour, int(colour == 0), colour)
            for colour, (text, run) in enumerate(runs.items())
        ]
        found.append(_panel(title, label, lines, logarithmic=name == "critical_mass"))
    return found
