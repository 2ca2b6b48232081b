"""Objects as people see them: one line each, a summary, a card, a plot, a table."""

import math
import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from tests.studies.synthetic import flight
from tipoff import lowfi
from tipoff.comparison import metrics
from tipoff.mechanics.rail_compliance import PATTERNS, RailCompliance
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import Calibration, load

NOTEBOOK, PICTURE = "_repr_html_", "_repr_png_"  # the methods that notebooks call


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
    assert "deg/s (x, y, z), " in lines["rate"]
    assert "moment impulse over inertia, no pad touches" in run.summary()


def test_summary_says_what_would_help():
    early = lowfi.run(load("tiny").replace({"contact": None, "friction": None, "duration": "6 ms"}))
    assert "still on the rail" in early.summary() and "rate " not in early.summary()
    unknown = flight(scene={})
    assert "by hand" not in unknown.summary()


def test_a_card_is_escaped(run):
    shown = getattr(replace(run, message="<b>odd</b>"), NOTEBOOK)()
    assert "&lt;b&gt;odd" in shown and "<b>odd" not in shown
    assert "<td" in shown and "deg/s" in shown


def _walls() -> RailCompliance:
    """Four faces at three stations, each as stiff as its number says."""
    faces = 4
    own = np.zeros((3, faces, 1, PATTERNS, PATTERNS))
    for face in range(faces):
        own[:, face, 0, 0, 0] = 1e-9 * (1 + face) * np.array([1.0, 2.0, 3.0])
    return RailCompliance(
        travel=np.array([0.0, 0.01, 0.02]),
        flexibility=own,
        rail=np.arange(faces),
        half=np.full((faces, 2), 8e-3),
        frequency=np.full((faces, 1), 2.0e3 * np.pi),
        shape=np.zeros((3, faces, PATTERNS, 1)),
        made_for="",
    )


def _shown_objects(run) -> list:
    unknown = np.zeros((0, 0))
    fitted = Calibration(
        *({}, ["<mu>"], [0.2], ["1"], [0.0], [1.0], [""], unknown, ["<i>"], {}, ["phi15"], 0.0),
        intervals=[[0.1, 0.3]],
    )
    return [run, load("tiny"), _walls(), _walls().rigid(), fitted, metrics.compare(run, run)]


COLOUR = re.compile(r"#[0-9a-f]{3,8}\b|\b(rgb|hsl)a?\(|\b(black|white|grey|gray)\b", re.IGNORECASE)


def test_every_object_is_one_line_a_summary_and_a_card(run):
    for item in _shown_objects(run):
        assert "\n" not in repr(item) and len(repr(item)) < 200
        card, lines = getattr(item, NOTEBOOK)(), item.summary().splitlines()
        assert card.count("<tr") == len(lines) > 2
        assert "<mu>" not in card and "<i>" not in card
        tree = ElementTree.fromstring(card)  # well-formed
        assert tree.find("caption/b").text == type(item).__name__
        words = [cell.text for cell in tree.iter("td")]
        assert all(line.endswith(found) for line, found in zip(lines, words, strict=True))


def test_a_card_has_the_colours_of_the_page_around_it(run):
    """So it is legible on a light page and on a dark one."""
    for item in _shown_objects(run):
        card = getattr(item, NOTEBOOK)()
        assert not COLOUR.search(card)
        for cell in ElementTree.fromstring(card).iter():
            if cell.tag in ("table", "th", "td", "caption"):
                assert "color:inherit;background:transparent" in cell.attrib["style"]
    assert COLOUR.search("color:#222") and COLOUR.search("background:white")  # the control


def test_plots_have_units_and_leave_no_global_state(run):
    from matplotlib import pyplot
    from matplotlib.figure import Figure

    before = pyplot.get_fignums()
    figure = run.plot()
    axes = figure.axes[0]
    lines = axes.get_lines()[:3]
    assert lines[2].get_ydata() == pytest.approx(np.degrees(run.rate[:, 2]))
    assert lines[2].get_xdata() == pytest.approx(1e3 * run.time)
    assert axes.get_ylabel() == "rate (deg/s)" and "(ms)" in axes.get_xlabel()
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["x", "y", "z"]
    velocity = run.plot("velocity").axes[0]
    assert velocity.get_lines()[0].get_ydata() == pytest.approx(run.velocity[:, 0])
    assert velocity.get_ylabel() == "velocity (m/s)"
    own = Figure().add_subplot()
    assert run.plot(axes=own) is own.figure
    assert pyplot.get_fignums() == before
    assert getattr(figure, PICTURE)().startswith(b"\x89PNG")
    with pytest.raises(ValueError, match="'speed', expected rate or velocity or position"):
        run.plot("speed")


def test_the_plot_of_a_scene_is_its_thrust():
    scene = load("tiny")
    line = scene.plot("thrust").axes[0].get_lines()[0]
    force, time = line.get_ydata(), line.get_xdata()
    peak, width, centre = scene.thrust.peak, scene.thrust.width, scene.thrust.centre
    expected = peak * np.exp(-0.5 * ((1e-3 * time - centre) / width) ** 2)
    assert force == pytest.approx(expected, rel=1e-9, abs=1e-6 * peak)


def test_walls_are_drawn_and_written_with_units(tmp_path):
    walls = _walls()
    line = walls.plot().axes[0].get_lines()[3]
    assert line.get_ydata() == pytest.approx([4.0, 8.0, 12.0])  # nm/N
    assert line.get_xdata() == pytest.approx([0.0, 10.0, 20.0])  # mm
    walls.to_csv(tmp_path / "walls.csv")
    head, *rows = (tmp_path / "walls.csv").read_text().splitlines()
    assert head.split(",")[:2] == ["travel [m]", "compliance_0 [m/N]"]
    assert [float(cell) for cell in rows[2].split(",")] == pytest.approx(
        [0.02, 3e-9, 6e-9, 9e-9, 12e-9]
    )
    for draw in (walls.rigid().plot, lambda: walls.rigid().to_csv(tmp_path / "no.csv")):
        with pytest.raises(ValueError, match="rigid walls have none"):
            draw()
    assert not (tmp_path / "no.csv").exists()


def test_a_table_is_one_that_calibration_reads(run, tmp_path):
    from tipoff.comparison.curves import Curves

    path = tmp_path / "run.csv"
    run.to_csv(path)
    found = Curves.read(path, run.outcome.window_start)
    kept = found.time.size
    assert kept > 0.9 * run.time.size
    assert found.time == pytest.approx(run.time[:kept], rel=1e-12)
    assert found.velocity == pytest.approx(run.velocity[:kept, 0], rel=1e-12)
    assert found.rate == pytest.approx(run.rate[:kept], rel=1e-9, abs=1e-15)
