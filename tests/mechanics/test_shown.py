"""Objects as people see them: one line each, a summary, a card, a plot, a table."""

import math

import numpy as np
import pytest

from tests.studies.synthetic import flight
from tipoff import lowfi
from tipoff.mechanics.trajectory import Trajectory
from tipoff.scenes import load

NOTEBOOK = "_repr_html_"  # the method that notebooks call


@pytest.fixture(scope="module")
def run():
    return lowfi.run(load("tiny").replace({"contact": None, "friction": None}))


def test_one_line(run, tmp_path):
    rates = ", ".join(f"{math.degrees(rate):.3f}" for rate in run.outcome.rate)
    assert repr(run).startswith("Trajectory(compliant, exited, ") and f"{rates} deg/s" in repr(run)
    run.save(tmp_path / "run.nc")
    assert repr(Trajectory.load(tmp_path / "run.nc")) == repr(run)
    scene = load("reference")
    assert repr(scene) == str(scene) and repr(scene).startswith("Scene('reference', 9.9 kg, 8 pads")
    for shown in (repr(run), repr(scene)):
        assert len(shown) < 160 and "\n" not in shown


def test_summary_has_rates_in_degrees_and_by_hand(run):
    lines = dict(line.split(None, 1) for line in run.summary().splitlines())
    assert lines["status"] == "exited" and lines["scene"] == "tiny"
    assert lines["rate"].endswith("deg/s (x, y, z)")
    assert "moment impulse over inertia, no pad touches" in run.summary()


def test_summary_says_what_would_help():
    early = lowfi.run(load("tiny").replace({"contact": None, "friction": None, "duration": "6 ms"}))
    assert "still on the rail" in early.summary() and "rate " not in early.summary()
    unknown = flight(scene={})
    assert "by hand" not in unknown.summary()


def test_a_card_is_escaped(run):
    from dataclasses import replace

    shown = getattr(replace(run, message="<b>odd</b>"), NOTEBOOK)()
    assert "&lt;b&gt;odd" in shown and "<b>odd" not in shown
    assert "<td" in shown and "deg/s" in shown


def test_a_plot_has_degrees_per_second(run):
    from matplotlib.figure import Figure

    axes = Figure().add_subplot()
    lines = run.plot(ax=axes)
    assert len(lines) == 3
    assert lines[2].get_ydata() == pytest.approx(np.degrees(run.rate[:, 2]))
    assert lines[2].get_xdata() == pytest.approx(1e3 * run.time)
    assert "deg/s" in axes.get_ylabel() and "ms" in axes.get_xlabel()


def test_a_table_is_one_that_calibration_reads(run, tmp_path):
    from tipoff.calibration.curves import Curves

    path = tmp_path / "run.csv"
    run.to_csv(path)
    found = Curves.read_csv(path, run.outcome.window_start)
    kept = found.time.size
    assert kept > 0.9 * run.time.size
    assert found.time == pytest.approx(run.time[:kept], rel=1e-12)
    assert found.velocity == pytest.approx(run.velocity[:kept, 0], rel=1e-12)
    assert found.rate == pytest.approx(run.rate[:kept], rel=1e-9, abs=1e-15)
