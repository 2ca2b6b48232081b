"""Figures show cases outside a calibration by markers without a filling."""

import math
from dataclasses import replace

import numpy as np
import pytest

from studies.report import outside
from studies.report.chart import Chart, Line, Panel, to_files, to_html

FLAGS = [False, False, True, True, True, False]


def test_points_outside_are_hollow_and_no_point_is_lost():
    line = Line(np.arange(6.0), np.arange(6.0) ** 2, "a case", dash="", marker="o", opacity=0.4)
    inside, beyond = outside.points(line, FLAGS)
    assert inside.x.tolist() == [0.0, 1.0, 5.0] and beyond.x.tolist() == [2.0, 3.0, 4.0] and beyond.y.tolist() == [4.0, 9.0, 16.0]
    assert not inside.hollow and beyond.hollow and not beyond.legend and outside.key(FLAGS)[0].name == beyond.name
    whole, marked_ = outside.over(line, FLAGS)
    assert whole is line and marked_.x.tolist() == beyond.x.tolist() and marked_.dash == ""
    nothing = [False] * 6
    assert outside.points(line, nothing) == outside.over(line, nothing) == [line] and outside.key(nothing) == []
    rest, every = outside.points(line, [True] * 6)
    assert len(every.x) == 6 and math.isnan(rest.x[0]) and rest.name == "a case"


def test_the_page_thins_cases_inside_and_outside_alike():
    """Of 4,000 cases, an eighth inside: what is drawn has that share too. Control: lines thinned each by itself do not."""
    many = Line(np.arange(4000.0), np.zeros(4000), "a case", dash="", marker="o")
    flags = np.arange(4000) % 8 != 0

    def shown(lines):
        drawn = to_html(Chart("many", [Panel("", "x", "y", lines)]))
        return [part.split('"x":[')[1].split("]")[0].count(",") + 1 for part in drawn.split('"mode":')[1:]]

    share = np.divide(*shown(outside.points(many, flags)))
    assert share == pytest.approx(1.0 / 7.0, rel=0.2)
    assert np.divide(*shown([replace(item, kept=500) for item in outside.points(many, flags)])) > 0.5


def test_hollow_is_seen_without_colour(tmp_path):
    """Half of the ink of a filled marker, whatever its colour; on the page the filling is white."""
    from matplotlib.image import imread

    ink = {}
    for hollow in (False, True):
        chart = Chart(f"marker-{hollow}", [Panel("", "", "", [Line([0.5], [0.5], "a", dash="", marker="o", hollow=hollow)])])
        picture = imread(to_files(chart, tmp_path)[0])[:, :, :3].mean(axis=2)
        ink[hollow] = (picture < 0.5).sum()
        assert ('"marker":{"color":"white"' in to_html(chart)) == hollow
    assert ink[True] < ink[False] - 30


def test_a_line_without_points_is_drawn_on_the_page():
    """As the bounds of a quantile are that no number of cases had."""
    assert "chart-none" in to_html(Chart("none", [Panel("", "x", "y", [Line([], [], "bounds")])]))
