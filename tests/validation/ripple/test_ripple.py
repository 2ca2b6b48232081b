"""Ripple of a constant contact force: what the measure finds in a force that is known, and on the
reference's own rails."""

import numpy as np
import pytest

from tipoff import highfi, scenes
from tipoff.highfi import Numerics
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study
from validation.ripple import page
from validation.ripple import stage as ripple

FREQUENCY, FACETS, SAMPLES = 1500.0, 11, 367  # 44 mm at 6 m/s, every 0.02 ms


def force(size: float, multiple: float) -> np.ndarray:
    """150 N on one face, swelling slowly by a fifth, with a ripple of ``size`` at a multiple of the
    frequency; 1 N on another."""
    time = 2e-5 * np.arange(SAMPLES)
    found = np.zeros((SAMPLES, 3, 3))
    swell, ripples = (
        np.sin(2.0 * np.pi * 90.0 * time),
        np.cos(2.0 * np.pi * multiple * FREQUENCY * time),
    )
    found[:, 1, 2] = -150.0 * (1.0 + 0.2 * swell + size * ripples)
    found[:, 2, 1] = np.sin(2.0 * np.pi * FREQUENCY * time)
    return found


@pytest.mark.parametrize("multiple", [1, 2, 3])
def test_ripple_of_a_known_force(multiple):
    """A slow swell of twenty times its size does not hide it, and a face that hardly touches does
    not count."""
    found = ripple.judge(force(0.01, multiple), FREQUENCY, FACETS)
    assert found.ripple == pytest.approx(0.01, rel=0.1)
    assert found.background < 1e-3 and found.load == pytest.approx(150.0, rel=0.2)


def test_oscillation_at_another_frequency_is_background():
    found = ripple.judge(force(0.01, 1.5), FREQUENCY, FACETS)
    assert found.ripple < 1e-3 and found.background == pytest.approx(0.01, rel=0.1)


@pytest.mark.parametrize(
    "size, heavier, bound",
    [
        (0.004, 16.0, 0.002),
        pytest.param(0.004, 1.0, 0.002, marks=pytest.mark.slow),
        pytest.param(0.002, 1.0, 0.001, marks=pytest.mark.slow),
    ],
)
def test_facet_boundaries_leave_no_ripple(size, heavier, bound):
    """Measured: 0.1 % at 4 mm, 0.05 % at 2 mm. Control: with three cells an edge of a pad, 2.8 and 2.3
    %. Rails of sixteen times the density (0.1 %, control 1.8 %) have steps four times as long."""
    scene = scenes.load("clamped")
    density = heavier * scene.rail.material.density
    scene = scene.replace({"rail.material.density": density})
    found = ripple.measure(scene, Numerics(element_size=size))
    few = ripple.measure(scene, Numerics(element_size=size, cells=3))
    assert found.frequency == pytest.approx(6.0 / size) and found.facets == round(0.044 / size)
    assert found.load > 100.0
    assert found.ripple <= bound
    assert few.ripple > 10.0 * found.ripple


def test_nothing_is_told_where_there_is_nothing_to_tell(monkeypatch):
    """Without contact, on a rail of too few facets, and where facets differ in length."""
    scene = scenes.load("tiny")
    assert ripple.measure(scene.replace({"contact": None, "friction": None}), Numerics()) is None
    assert ripple.facet_length(
        highfi.prepare(scene, Numerics(element_size=0.008))
    ) == pytest.approx(0.008)
    assert ripple.facet_length(highfi.prepare(scene, Numerics(element_size=0.016))) is None
    assert ripple.measure(scene, Numerics(element_size=0.016)) is None
    monkeypatch.setattr(ripple, "LEAST_FACETS", 7)  # the pads cross six
    assert ripple.measure(scene, Numerics(element_size=0.008)) is None


def test_ripple_of_both_meshes_beside_that_of_few_cells(tmp_path, monkeypatch):
    """A ripple that falls with the cells of a pad."""

    def measure(scene, numerics):
        cells = numerics.cells or 16
        return ripple.Ripple(0.04 / cells, 1e-3, 750.0, 6, 200.0, cells)

    monkeypatch.setattr(ripple, "measure", measure)
    study = Study(scenes.load("tiny"), tmp_path / "tiny", defaults("tiny"))
    found = ripple.run(study).result
    assert [(row.element_size_m, row.cells_per_edge, row.ripple) for row in found.rows] == [
        (0.016, 3, 0.04 / 3),
        (0.016, 16, 0.0025),
        (0.008, 16, 0.0025),
    ]
    (line,) = page.sentences(found)
    assert line.startswith("ripple") and "750 Hz, facets of 8 mm: 0.25 %" in line
    (table,) = page.draw(found)
    assert "ripple (%)" in table.heads


def test_a_scene_without_contact_has_no_ripple(tmp_path):
    """Control: above, where pads slide."""
    free = scenes.load("tiny").replace({"contact": None, "friction": None})
    found = ripple.run(Study(free, tmp_path / "tiny", defaults("tiny"))).result
    assert found.rows == () and page.sentences(found) == [] and page.draw(found)[0].rows == []
