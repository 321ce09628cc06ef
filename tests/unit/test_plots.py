"""Figures: drawn without a screen, with units on their axes, the numbers where they belong."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree

import matplotlib.colors
import numpy as np
import pytest
from matplotlib.text import Text
from sample_results import campbell_of, chart_of, orbit_of, point_of

from rotorsim import rows
from rotorsim.bearing.table import CoefficientTable
from rotorsim.machine.uncertainty import Propagation
from rotorsim.orbit.analysis import speed_cascade
from rotorsim.rotor import Rotor
from rotorsim.show import figures as plots
from rotorsim.show.figures.style import MODEL_STYLES
from rotorsim.study.stability import stability_curves
from rotorsim.study.tolerances import ToleranceStudy

SPEED = np.linspace(100.0, 1500.0, 40)
MASS = np.linspace(10.0, 500.0, 30)
# Rigid-rotor-like: stable below a critical mass that falls with speed.
COLD = 0.15 * SPEED[:, None] + 0.2 * MASS - 300.0
HOT = COLD + 0.08 * SPEED[:, None]


def film(name="thd", warm=True):
    theta = 2.0 + (np.arange(60) + 0.5) * 2 * np.pi / 60
    y = (np.arange(10) - 4.5) * 8e-3
    bump = np.clip(np.cos(theta), 0, None)[:, None] * (1 - (y / 0.045) ** 2)
    heat = 313.15 + 40 * bump * warm
    return point_of(theta, y, 3e6 * bump, heat, thermal_model=name)


def table():
    """K and C of both models at three speeds."""
    head = "thermal_model,radial_clearance [um],speed [rad/s],status,load [kN]," + ",".join(
        f"{c}{i}{j} [{unit}]" for c, unit in (("k", "MN/m"), ("c", "kN s/m")) for i in "xy"
        for j in "xy"
    )  # fmt: skip
    rows = [
        f"{model},100,{speed},converged,10,{100 - soft},200,-50,80,300,90,90,200"
        for model, soft in (("isothermal", 0), ("thd", 10))
        for speed in (500, 800, 1200)
    ]
    return "\n".join([head, *rows])


@pytest.fixture
def coefficients(tmp_path):
    (tmp_path / "t.csv").write_text(table())
    return CoefficientTable.from_csv(tmp_path / "t.csv")


def eigenvalue_curve(name="thd", **more):
    values = np.stack([SPEED * 0.1 - 90.0 + 0.48j * SPEED, SPEED * 0.1 - 90.0 - 0.48j * SPEED], 1)
    return campbell_of(SPEED, values, name, **more)


def orbit(name="thd"):
    t = np.linspace(0.0, 0.5, 4001)
    x, y = 1e-5 * np.cos(400.0 * t), 1e-5 * np.sin(400.0 * t)
    return orbit_of(t, x, y, 800.0, thermal_model=name)


def chart(cold=COLD, hot=HOT, speed=SPEED, mass=MASS):
    rates = {"isothermal": cold} if hot is None else {"isothermal": cold, "thd": hot}
    return chart_of(speed, mass, rates, ("speed", "mass"))


def run_up():
    t = np.linspace(0.0, 2.0, 16001)
    speed = np.linspace(400.0, 1200.0, t.size)
    return orbit_of(t, 1e-5 * np.cos(500.0 * t), 1e-5 * np.sin(500.0 * t), speed)


FIGURES = {
    "film_maps": lambda: plots.film_maps([film("isothermal", warm=False), film()]),
    "film_profiles": lambda: plots.film_profiles([film("isothermal", warm=False), film()]),
    "map": lambda: plots.stability_map(chart(), marks={"highest speed": (1000.0, 300.0)}),
    "eigenvalues": lambda: plots.eigenvalue_plot([eigenvalue_curve()]),
    "campbell": lambda: plots.campbell_diagram([eigenvalue_curve()]),
    "orbits": lambda: plots.orbit_plot([orbit("isothermal"), orbit()]),
    "spectrum": lambda: plots.spectrum_plot([orbit("isothermal"), orbit()]),
    "cascade": lambda: plots.spectrum_cascade(speed_cascade(run_up())),
    "bode": lambda: plots.bode_plot(SPEED, [("thd", 1.0 / (1e4 - SPEED**2 + 50j * SPEED))]),
}


def test_coefficients_and_thresholds_over_speed(coefficients):
    first = plots.coefficients_over_speed(coefficients)
    for ax, (unit, row) in zip(
        first.axes, ((u, r) for u, r in (("MN/m", "K"), ("kN s/m", "C")) for _ in range(4)),
        strict=True,
    ):  # fmt: skip
        assert unit in ax.get_title()
        assert row in ax.get_title()
        assert len(ax.lines) == 3  # zero, and the two models
    assert first.axes[0].lines[2].get_ydata().tolist() == [90.0, 90.0, 90.0]
    curves = stability_curves(coefficients, 300.0)
    second = plots.thresholds_over_speed(curves, 300.0)
    line = second.axes[0].lines[1]
    assert line.get_ydata() == pytest.approx(curves[1].critical_mass)
    assert line.get_label() == "THD, c = 100 µm"


@pytest.mark.slow
@pytest.mark.parametrize("name", FIGURES)
def test_every_figure_is_saved_with_named_axes(name, tmp_path):
    figure = FIGURES[name]()
    labels = [a.get_xlabel() + a.get_ylabel() + a.get_title() for a in figure.axes]
    assert any("[" in label for label in labels), "no unit on any axis"
    png, svg = plots.save_figure(figure, tmp_path / "deep" / name)
    assert png.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert ElementTree.parse(svg).getroot().tag.endswith("svg")
    assert sorted(p.name for p in (tmp_path / "deep").iterdir()) == [f"{name}.png", f"{name}.svg"]


_SI = re.compile(r"\[(µm|mm|N|kN|MPa|kPa|°C|kg|MN/m|N/m|kN s/m|kW)\]|\d (µm|mm|kN|kg|°C|MPa)\b")


@pytest.mark.parametrize("name", [name for name in FIGURES if name != "bode"])
def test_figures_follow_the_units_shown(name, monkeypatch):
    monkeypatch.setattr(rows, "_shown_in", ["us"])
    figure = FIGURES[name]()
    texts = [one.get_text() for one in figure.findobj(Text)]
    assert [one for one in texts if _SI.search(one)] == []


def test_an_orbit_in_mil_is_the_one_in_micrometres(monkeypatch):
    x = [line.get_xdata() for line in FIGURES["orbits"]().axes[0].lines]
    monkeypatch.setattr(rows, "_shown_in", ["us"])
    for one, mil in zip(x, FIGURES["orbits"]().axes[0].lines, strict=True):
        np.testing.assert_allclose(25.4 * np.asarray(mil.get_xdata()), one)


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


def test_map_regions_stand_where_the_growth_rates_say_and_differ_in_grey():
    figure = plots.stability_map(chart())
    rpm = SPEED * 30 / np.pi
    margin = 15.0
    regions = {
        "stable": (-margin > HOT),
        "heating": (-margin > COLD) & (margin < HOT),
        "unstable": (margin < COLD),
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


def _grey_cells(figure):
    """Pixels inside the axes in the colour of what was not computed."""
    figure.canvas.draw()
    picture = np.asarray(figure.canvas.buffer_rgba())[..., :3].astype(int)
    box = figure.axes[0].get_window_extent()
    height = picture.shape[0]
    inside = picture[
        height - int(box.y1) + 2 : height - int(box.y0) - 2, int(box.x0) + 3 : int(box.x1) - 2
    ]
    return (np.abs(inside - 0xBB).max(axis=-1) < 3).mean()


def test_regions_of_a_coarse_map_meet_and_only_unknown_cells_are_grey():
    speed, mass = np.linspace(300.0, 1500.0, 5), np.linspace(100.0, 3000.0, 30)
    hot = 1e-9 * speed[:, None] ** 2 * mass * 60.0 - 100.0
    cold = 1e-9 * speed[:, None] ** 2 * mass * 35.0 - 100.0
    figure = plots.stability_map(chart(cold, hot, speed, mass))
    assert _grey_cells(figure) == 0.0
    assert "not computed" not in [text.get_text() for text in figure.legends[0].get_texts()]
    hot[2, 10] = np.nan
    # Two of four intervals in speed, two of 29 in mass.
    unknown = _grey_cells(plots.stability_map(chart(cold, hot, speed, mass)))
    assert unknown == pytest.approx(0.5 * 2 / 29, rel=0.1)


def test_map_of_one_model_knows_no_heating():
    labels = [t.get_text() for t in plots.stability_map(chart(hot=None)).legends[0].get_texts()]
    assert labels[:2] == ["stable", "unstable"]


def test_unknown_cells_are_named():
    holes = COLD.copy()
    holes[5] = np.nan
    figure = plots.stability_map(chart(cold=holes))
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


def grey(figure):
    """Lightness of the figure's pixels as a printer without colour gives them."""
    canvas = figure.canvas
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3] / 255.0
    return pixels @ [0.299, 0.587, 0.114]


def test_plane_of_any_two_inputs_has_its_regions_and_units():
    load, supply = np.linspace(5e3, 20e3, 30), np.linspace(303.15, 333.15, 20)
    cold = (20.0 - load[:, None] / 1e3) - 10.0 - 0 * supply
    names = ("applied_load", "supply_temperature")
    figure = plots.stability_map(
        chart_of(load, supply, {"isothermal": cold, "thd": cold + 3.0}, names), *names,
        marks={"pump": (15e3, 318.15), "spare": (12e3, 318.15)},
    )  # fmt: skip
    (axes,) = figure.axes
    assert axes.get_xlabel() == "load per bearing [kN]"
    assert axes.get_ylabel() == "supply temperature [°C]"
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "stable if heating is neglected, unstable with it" in labels
    assert "threshold, THD" in labels
    assert {"pump", "spare"} <= set(labels)
    # The three regions differ without colour: least at the left, most at the right.
    shade = grey(figure)
    height = shade.shape[0]

    def lightness(xy):
        column, row = axes.transData.transform(xy)
        patch = shade[
            height - int(row) - 3 : height - int(row) + 3, int(column) - 3 : int(column) + 3
        ]
        return float(patch.mean())

    assert lightness((19.0, 33.0)) > 0.9
    assert lightness((6.0, 33.0)) < 0.5
    assert 0.4 < lightness((11.5, 33.0)) < 0.9


def test_campbell_marks_senses_and_thresholds():
    values = np.stack([-5 + 0.5j * SPEED, 300j - 4 + 0 * SPEED], axis=1)
    curve = campbell_of(SPEED, values, sense=(1.0, -1.0), thresholds=((900.0, 450.0),))
    (axes,) = plots.campbell_diagram([curve]).axes
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert {"whirls forward", "whirls backward", "threshold"} <= set(labels)
    crosses = [line for line in axes.lines if line.get_marker() == "x" and line.get_xdata().size]
    assert crosses[0].get_xdata()[0] == pytest.approx(900.0 * 30 / np.pi)
    assert crosses[0].get_ydata()[0] == pytest.approx(450.0 / (2 * np.pi))


def test_growth_in_a_campbell_diagram_begins_at_the_threshold():
    speed = np.array([800.0, 1000.0])
    values = np.stack([[-4.0 + 400j, 4.0 + 480j], [-9.0 + 900j, 3.0 + 900j]], axis=1)
    curve = campbell_of(speed, values, thresholds=((930.0, 455.0),))
    (axes,) = plots.campbell_diagram([curve]).axes
    thick = [line for line in axes.lines if line.get_linewidth() == 4.5 and line.get_xdata().size]
    starts = []
    for line in thick:
        data = line.get_xydata()
        starts.append(data[np.isfinite(data[:, 1])][0])
    # The first branch at the threshold marked; the second, which crosses later, interpolated.
    assert starts[0] == pytest.approx([930.0 * 30 / np.pi, 455.0 / (2 * np.pi)])
    assert starts[1] == pytest.approx([950.0 * 30 / np.pi, 900.0 / (2 * np.pi)])


def test_eigenvalues_explain_their_open_and_filled_ends_beside_the_axes():
    figure = plots.eigenvalue_plot([eigenvalue_curve()], "pump")
    (axes,) = figure.axes
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    ends = [f"at {speed * 30 / np.pi:.0f} rpm" for speed in (SPEED[0], SPEED[-1])]
    assert labels == ["THD", *ends]
    figure.canvas.draw()
    assert axes.get_legend() is None
    assert not figure.legends[0].get_window_extent().overlaps(axes.get_window_extent())


def test_root_locus_says_where_it_crosses():
    mass = np.linspace(100.0, 300.0, 21)
    branch = (mass - 205.0) + 400j
    values = np.stack([branch, branch.conj()], axis=1)
    (axes,) = plots.root_locus(campbell_of(mass, values).branches, "mass per bearing [kg]").axes
    assert "mass per bearing [kg] from 100 (open) to 300 (filled)" in axes.get_title()
    assert "205" in [text.get_text() for text in axes.texts]
    assert axes.get_ylim()[0] < 0.0 < 400.0 < axes.get_ylim()[1]


def study(speeds, masses, importance, nominal=(None, None), failed=0):
    """A tolerance study of a rotor of 310 kg with these thresholds, and some samples failed."""
    lost = np.full(failed, np.nan)
    outputs = {
        "threshold_speed": np.concatenate([speeds, lost]),
        "critical_mass": np.concatenate([masses, lost]),
    }
    samples = Propagation({}, outputs, tuple((len(speeds) + i, "") for i in range(failed)))
    names = ("threshold_speed", "critical_mass")
    return ToleranceStudy(
        "thd", 1e-4, Rotor.rigid(310.0), 1050.0, {}, dict(zip(names, nominal, strict=True)),
        samples, 0.1, 0.01, importance, importance, 0.9,
    )  # fmt: skip


def test_tolerance_panels_without_a_value_say_so_and_failed_samples_are_apart():
    nothing, mass = np.full(60, np.nan), np.linspace(200.0, 300.0, 60)
    figure = plots.tolerance_histograms(study(nothing, mass, {"load": 0.4}, failed=4), "pump")
    first, second, _ = figure.axes
    assert not first.axison
    assert [text.get_text().split("\n")[0] for text in first.texts] == [
        "no sample has a threshold speed"
    ]
    assert second.axison
    assert second.get_title() == ""
    assert figure.get_suptitle() == "pump\n60 samples; 4 more did not converge"


def test_tolerance_histograms_show_shares_and_what_is_missing():
    rng = np.random.default_rng(1)
    speeds = 1000.0 + 50.0 * rng.standard_normal(256)
    speeds[:64] = np.nan
    masses = 300.0 + 10.0 * rng.standard_normal(256)
    figure = plots.tolerance_histograms(
        study(speeds, masses, {"radial_clearance": -0.8, "load": 0.4}, (1000.0, 300.0))
    )
    first, second, third = figure.axes
    assert first.get_title() == "25 % of samples have none"
    assert sum(patch.get_height() for patch in first.patches) == pytest.approx(75.0)
    assert sum(patch.get_height() for patch in second.patches) == pytest.approx(100.0)
    assert [patch.get_width() for patch in third.patches] == [0.4, -0.8]
    for axes in figure.axes:
        assert "[" in axes.get_xlabel()


def test_figures_are_written_as_asked(tmp_path, monkeypatch):
    from rotorsim.show.figures import style

    figure, _ = style.new_axes(1, 1, (6.0, 3.0), "title")
    monkeypatch.setattr(style, "_asked", [style.FigureFiles(("pdf", "svg"), 3.5, 7.0)])
    written = style.save_figure(figure, tmp_path / "one")
    assert [path.suffix for path in written] == [".pdf", ".svg"]
    assert figure.get_size_inches() == pytest.approx([3.5, 1.75])
