"""Figures: drawn without a screen, with units on their axes, the numbers where they belong."""

from __future__ import annotations

import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import matplotlib.colors
import numpy as np
import pytest

from rotorsim import plots
from rotorsim.plots.style import MODEL_STYLES

SPEED = np.linspace(100.0, 1500.0, 40)
MASS = np.linspace(10.0, 500.0, 30)
# Rigid-rotor-like: stable below a critical mass that falls with speed.
COLD = 300.0 - 0.15 * SPEED[:, None] - 0.2 * MASS
HOT = COLD - 0.08 * SPEED[:, None]


def film(name="thd", warm=True):
    theta = 2.0 + (np.arange(60) + 0.5) * 2 * np.pi / 60
    y = (np.arange(10) - 4.5) * 8e-3
    bump = np.clip(np.cos(theta), 0, None)[:, None] * (1 - (y / 0.045) ** 2)
    return plots.FilmPicture(name, theta, y, 3e6 * bump, 313.15 + 40 * bump if warm else None)


def curve(name, clearance):
    ones = np.ones((SPEED.size, 2, 2))
    return plots.SpeedCurve(
        name, clearance, SPEED, 1e8 * ones, 1e5 * ones, 1e5 / SPEED, np.full(SPEED.size, 0.48)
    )


def eigenvalue_curve(name="thd"):
    values = np.stack([SPEED * 0.1 - 90.0 + 0.48j * SPEED, SPEED * 0.1 - 90.0 - 0.48j * SPEED], 1)
    return plots.EigenvalueCurve(name, SPEED, values)


def orbit(name="thd"):
    t = np.linspace(0, 60, 2000)
    return plots.OrbitPicture(
        name, name, 1e-5 * np.cos(t), 1e-5 * np.sin(t), 1e-4, np.zeros(2), steady_from=500
    )


FIGURES = {
    "film_maps": lambda: plots.film_maps([film("isothermal", warm=False), film()]),
    "film_profiles": lambda: plots.film_profiles([film("isothermal", warm=False), film()]),
    "coefficients": lambda: plots.coefficients_over_speed(
        [curve("isothermal", 1e-4), curve("thd", 1e-4)]
    ),
    "thresholds": lambda: plots.thresholds_over_speed([curve("thd", 1e-4)], 300.0),
    "map": lambda: plots.stability_map(SPEED, MASS, COLD, HOT, (1000.0, 300.0)),
    "eigenvalues": lambda: plots.eigenvalue_plot([eigenvalue_curve()]),
    "campbell": lambda: plots.campbell_diagram([eigenvalue_curve()]),
    "orbits": lambda: plots.orbit_plot([orbit("isothermal"), orbit()]),
    "cascade": lambda: plots.spectrum_cascade(
        SPEED, np.linspace(0, 2000, 50), np.ones((SPEED.size, 50)) * 1e-6
    ),
    "bode": lambda: plots.bode_plot(SPEED, [("thd", 1.0 / (1e4 - SPEED**2 + 50j * SPEED))]),
}


@pytest.mark.parametrize("name", FIGURES)
def test_every_figure_is_saved_with_named_axes(name, tmp_path):
    figure = FIGURES[name]()
    labels = [a.get_xlabel() + a.get_ylabel() + a.get_title() for a in figure.axes]
    assert any("[" in label for label in labels), "no unit on any axis"
    png, svg = plots.save_figure(figure, tmp_path / "deep" / name)
    assert png.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert ElementTree.parse(svg).getroot().tag.endswith("svg")
    assert sorted(p.name for p in (tmp_path / "deep").iterdir()) == [f"{name}.png", f"{name}.svg"]


def test_a_figure_saved_twice_is_the_same_file(tmp_path):
    first = plots.save_figure(FIGURES["map"](), tmp_path / "a", formats=("svg",))[0]
    second = plots.save_figure(FIGURES["map"](), tmp_path / "b", formats=("svg",))[0]
    assert first.read_bytes() == second.read_bytes()


def _grey(figure, place):
    """Grey level of the map at data coordinates, averaged over the hatching."""
    figure.canvas.draw()
    picture = np.asarray(figure.canvas.buffer_rgba())[..., :3].astype(float)
    column, row = figure.axes[0].transData.transform(place)
    row = picture.shape[0] - row
    patch = picture[int(row) - 6 : int(row) + 7, int(column) - 6 : int(column) + 7]
    grey = patch @ (0.299, 0.587, 0.114)
    return grey.mean(), grey.std()


def test_map_regions_stand_where_the_decay_rates_say_and_differ_in_grey():
    figure = plots.stability_map(SPEED, MASS, COLD, HOT)
    rpm = SPEED * 30 / np.pi
    margin = 15.0
    regions = {
        "stable": (margin < HOT),
        "heating": (margin < COLD) & (-margin > HOT),
        "unstable": (-margin > COLD),
    }
    levels = {}
    for name, cells in regions.items():
        i, j = (index[len(index) // 2] for index in np.nonzero(cells))
        levels[name] = _grey(figure, (rpm[i], MASS[j]))
    greys = sorted(level for level, _ in levels.values())
    assert np.diff(greys).min() > 25.0
    assert levels["heating"][1] > 20.0  # hatched
    assert levels["stable"][1] < 1.0
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "stable if heating is neglected, unstable with it" in labels


def test_map_of_one_model_knows_no_heating():
    labels = [t.get_text() for t in plots.stability_map(SPEED, MASS, COLD).legends[0].get_texts()]
    assert labels[:2] == ["stable", "unstable"]


def test_unknown_cells_are_named():
    holes = COLD.copy()
    holes[5] = np.nan
    figure = plots.stability_map(SPEED, MASS, holes, HOT)
    assert "not computed" in [t.get_text() for t in figure.legends[0].get_texts()]


def test_plots_go_into_given_axes():
    figure = plots.eigenvalue_plot([eigenvalue_curve()])
    assert plots.campbell_diagram([eigenvalue_curve()], ax=figure.axes[0]) is figure


def test_models_differ_in_grey_and_in_dashes():
    styles = list(MODEL_STYLES.values())
    greys = [np.dot(matplotlib.colors.to_rgb(s["color"]), (0.299, 0.587, 0.114)) for s in styles]
    assert abs(greys[0] - greys[1]) > 0.1
    assert styles[0]["linestyle"] != styles[1]["linestyle"]


def test_profile_is_drawn_in_megapascal_over_degrees():
    line = plots.film_profiles([film()]).axes[0].lines[0]
    assert line.get_ydata().max() == pytest.approx(3.0, rel=0.02)
    assert abs(line.get_xdata()[np.argmax(line.get_ydata())]) < 4.0


def test_importing_plots_leaves_matplotlib_alone():
    code = "import sys, rotorsim.plots; assert 'matplotlib' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)
    with pytest.raises(AttributeError, match="no_such_plot"):
        _ = plots.no_such_plot
