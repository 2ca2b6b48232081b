"""Choice of the mesh from which the compliance of the rail is condensed."""

from types import SimpleNamespace

import numpy as np
import pytest

from tipoff import calibration
from tipoff.calibration import rail_compliance
from tipoff.highfi import compliance as statics
from tipoff.scenes import load

REFERENCE = 2e-3


@pytest.mark.parametrize("slope, expected", [(1.0, 4e-3), (30.0, REFERENCE)])
def test_the_coarsest_mesh_within_one_per_cent(monkeypatch, slope, expected):
    """C(h) = C - slope h: at 4 mm a slope of 1/m leaves 0.2 % to 2 mm, one of 30/m leaves 6 %."""
    seen = []

    def direct(scene, size):
        seen.append(size)
        return np.full((4, 16), 1.0 - slope * size)

    monkeypatch.setattr(rail_compliance, "direct", direct)
    assert rail_compliance.fine_enough(load("reference"), REFERENCE) == expected
    assert seen == [8e-3, 4e-3]  # the reference's own mesh is not needed to choose


@pytest.mark.slow
def test_the_estimate_agrees_with_the_mesh_of_the_reference():
    """The rail of the reference scene at 8 and 4 mm: the predicted change to 2 mm is right to a
    quarter, and above 1 %."""
    scene = load("reference")
    coarsest, coarse, own = (rail_compliance.direct(scene, size) for size in (8e-3, 4e-3, 2e-3))
    foreseen = 0.5 * np.abs(coarse - coarsest) / coarse
    assert np.median(foreseen) == pytest.approx(np.median(np.abs(own - coarse) / own), rel=0.25)
    assert rail_compliance.fine_enough(scene) == REFERENCE


def test_a_given_size_is_used(monkeypatch):
    monkeypatch.setattr(rail_compliance, "fine_enough", lambda *_: pytest.fail("chose a mesh"))
    monkeypatch.setattr(rail_compliance.statics, "condense", lambda scene, size: size)
    assert calibration.compliance(load("tiny"), 8e-3) == 8e-3


def _said(monkeypatch, tmp_path, seconds: float) -> list[str]:
    """What is said while four equal parts of the loads take ``seconds`` each."""
    now = 0.0

    def condense(scene, size):
        nonlocal now
        report = statics.reported()
        for part in range(4):
            now += seconds
            report(0.25 * (part + 1))
        return SimpleNamespace(save=lambda path: None)

    monkeypatch.setattr(rail_compliance.time, "perf_counter", lambda: now)
    monkeypatch.setattr(rail_compliance.statics, "condense", condense)
    lines = []
    rail_compliance.kept(load("tiny"), tmp_path, 8e-3, lines.append)
    return lines


def test_a_long_wait_says_how_long_it_takes(monkeypatch, tmp_path):
    """Four minutes; control: four seconds say nothing."""
    first, *left, last = _said(monkeypatch, tmp_path, 60.0)
    assert "rail compliance, once" in first and "found in 240 s" in last
    assert left == [
        "  50 %, about 2 min left; coarser elements take less",
        "  75 %, about 60 s left",
    ]
    assert len(_said(monkeypatch, tmp_path, 1.0)) == 2


def test_the_loads_solved_for_are_reported(monkeypatch):
    """Every batch of a rail, up to all of it."""
    monkeypatch.setattr(statics, "BATCH", 2)
    seen = []
    with statics.progress_to(seen.append):
        rail_compliance.direct(load("tiny"), 16e-3)
    assert seen == sorted(seen) and seen[-1] == 1.0 and len(seen) > 3
    rail_compliance.direct(load("tiny"), 16e-3)
    assert seen[-1] == 1.0 and seen.count(1.0) == 1


def test_threads_do_not_change_a_bit(monkeypatch):
    """Batches that are solved for side by side, and one after another."""
    monkeypatch.setattr(statics, "BATCH", 2)
    found = []
    for cores in (1, 4):
        monkeypatch.setattr(statics, "processors", lambda cores=cores: cores)
        found.append(statics.condense(load("tiny"), 16e-3).hash)
    assert found[0] == found[1]
