"""Measured points: how they are read, and what computed curves are off from them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import rotorsim as rs
from rotorsim.errors import TableError
from rotorsim.study.measured import curves, deviation_rows, deviations, read_measured

SCENARIO = Path(__file__).parents[2] / "scenarios" / "quick.toml"
RPM = math.pi / 30.0


@pytest.fixture(scope="module")
def table():
    scenario = rs.load_scenario(SCENARIO).replace(orbit=None, stability=None)
    return rs.tabulate(scenario.replace(thermal_model="thd"), workers=1)


@pytest.mark.parametrize(
    "text",
    [
        "speed [rpm],T_max [degC],loss [kW]\n3000,45,2\n6000,,5.5\n",
        "Test of 3 May\nrpm;temperature;power_loss\n;°C;kW\n3000;45,0;2\n6000;;5,5\n",
        "speed (rpm)\tmax_temperature (K)\tpower_loss (W)\tnote\n"
        "3000\t318.15\t2000\tx\n6000\t\t5500\ty\n",
    ],
)
def test_points_are_read_as_people_write_them(tmp_path, text):
    path = tmp_path / "points.csv"
    path.write_text(text, encoding="utf-8")
    temperature, loss = read_measured(path)
    assert (temperature.name, loss.name) == ("max_temperature", "power_loss")
    np.testing.assert_allclose(temperature.speed, [3000.0 * RPM])
    np.testing.assert_allclose(temperature.value, [318.15])
    np.testing.assert_allclose(loss.speed, np.array([3000.0, 6000.0]) * RPM)
    np.testing.assert_allclose(loss.value, [2000.0, 5500.0])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a,b\n1,2\n", "needs a header with speed"),
        ("speed [rpm],colour\n3000,red\n", "no column is called like a result"),
        ("speed,load [kN]\n3000,4\n", "line 2, column speed: lacks its unit"),
        ("speed [rpm],load [kN]\n3000,much\n", "line 2, column load"),
        ("speed [rpm],load [degC]\n3000,4\n", "line 2, column load"),
    ],
)
def test_bad_points_name_their_cell(tmp_path, text, said):
    path = tmp_path / "points.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(TableError) as refused:
        read_measured(path)
    assert said in str(refused.value)


def test_deviations_are_those_of_the_curve_between_its_speeds(tmp_path, table):
    ((_, _, values),) = curves(table, "power_loss")
    speeds = table.speeds
    middle = 0.5 * (values[0] + values[1])
    rows = [(speeds[0], values[0] - 10.0), (speeds[:2].mean(), middle + 30.0), (1e4, 1.0)]
    path = tmp_path / "points.csv"
    lines = "".join(f"{float(speed)!r},{float(value)!r}\n" for speed, value in rows)
    path.write_text("speed [rad/s],power_loss [W]\n" + lines)
    (found,) = deviations(table, read_measured(path))
    assert found.points == 2  # the third lies beyond the table
    assert found.mean == pytest.approx(-10.0)
    assert found.largest == pytest.approx(-30.0)
    _, ((label, curve, points, mean, largest, unit),) = deviation_rows([found])
    assert (label, curve, points) == ("power loss", "thd, c = 100 µm", "2")
    assert (mean, largest, unit) == ("-0.01", "-0.03", "kW")


def test_they_are_drawn(table, tmp_path):
    from rotorsim.show.figures import measured_points

    path = tmp_path / "points.csv"
    path.write_text("speed [rpm],T_max [degC],kxx [MN/m]\n3000,45,240\n6000,60,\n")
    figure = measured_points(table, read_measured(path))
    labels = [line.get_label() for line in figure.axes[0].lines]
    assert "measured" in labels
    assert figure.axes[0].get_ylabel() == "maximum temperature [°C]"
    assert figure.axes[1].get_ylabel() == "kxx [MN/m]"
